//! Stub.
use super::*;
pub fn read(_: &[u8], _: AxisFormat) -> Result<PowerShape, ReadError> {
    Err(ReadError::Empty)
}
pub fn write<W: Write>(
    _: &mut W,
    _: AxisFormat,
    _: &PowerShape,
    _: &WriteOptions,
) -> Result<(), WriteError> {
    Ok(())
}
