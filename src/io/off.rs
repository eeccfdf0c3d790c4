//! Stub.
use super::*;
pub fn read_cloud(_: &[u8], _: &ReadOptions) -> Result<Cloud, ReadError> {
    Err(ReadError::Empty)
}
pub fn read_mesh(_: &[u8]) -> Result<PolygonMesh, ReadError> {
    Err(ReadError::Empty)
}
pub fn write_mesh<W: Write>(
    _: &mut W,
    _: &PolygonMesh,
    _: &MeshAttributes,
    _: &WriteOptions,
) -> Result<(), WriteError> {
    Ok(())
}
pub fn keyword(_: &[u8]) -> Option<()> {
    None
}
