//! Stub.
use super::*;
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
