//! The command `powercrust`: see [`cli`] for how it is laid out.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}
