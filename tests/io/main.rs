//! Files in and out.

mod damage;
mod formats;
mod ply;
mod public;
mod round_trip;
mod text;

use powercrust::io::*;

const PLAIN: ReadOptions = ReadOptions {
    skip_invalid: false,
};
const SKIP: ReadOptions = ReadOptions { skip_invalid: true };

fn text(bytes: &str) -> Result<Cloud, ReadError> {
    read_cloud(bytes.as_bytes(), CloudFormat::Text, &PLAIN)
}

/// The message of a failure, which must be one.
fn message(result: Result<Cloud, ReadError>) -> String {
    result.expect_err("should be refused").to_string()
}
