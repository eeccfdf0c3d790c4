//! Files in and out.

mod damage;
mod formats;
mod ply;
mod public;
mod round_trip;
mod scanners;
mod text;

use powercrust::io::*;

const PLAIN: ReadOptions = ReadOptions {
    skip_invalid: false,
};
const SKIP: ReadOptions = ReadOptions { skip_invalid: true };
/// Formats of meshes that are both read and written.
const MESHES: [MeshFormat; 5] = [
    MeshFormat::Ply,
    MeshFormat::Obj,
    MeshFormat::Off,
    MeshFormat::Stl,
    MeshFormat::Json,
];
const AXES: [AxisFormat; 3] = [AxisFormat::Ma, AxisFormat::Ply, AxisFormat::Json];

fn text(bytes: &str) -> Result<Cloud, ReadError> {
    read_cloud(bytes.as_bytes(), CloudFormat::Text, &PLAIN)
}

/// The message of a failure, which must be one.
fn message(result: Result<Cloud, ReadError>) -> String {
    result.expect_err("should be refused").to_string()
}
