//! Stub.
use super::*;
pub fn read_cloud(_: &[u8], _: &ReadOptions) -> Result<Cloud, ReadError> {
    Err(ReadError::Empty)
}
