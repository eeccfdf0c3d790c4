//! The man page and the shell completions, made from the argument definitions.

use std::process::ExitCode;

use clap_complete::Shell;

use super::args::{Cli, Generate};
use super::fail::Failure;
use super::output::Target;

/// Prints one of them on standard output.
pub fn generate(what: Generate) -> Result<ExitCode, Failure> {
    let mut definition = Cli::definition();
    let shell = match what {
        Generate::Man => None,
        Generate::CompleteBash => Some(Shell::Bash),
        Generate::CompleteZsh => Some(Shell::Zsh),
        Generate::CompleteFish => Some(Shell::Fish),
    };
    Target::Stdout.stage(|out| match shell {
        None => clap_mangen::Man::new(definition).render(out),
        Some(shell) => {
            let mut text = Vec::new();
            clap_complete::generate(shell, &mut definition, "powercrust", &mut text);
            out.write_all(&text)
        }
    })?;
    Ok(ExitCode::SUCCESS)
}
