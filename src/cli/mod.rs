//! The command line: [`args`] records what was said, [`plan`] judges it before
//! any work is done, [`run`] does the work through the public library, [`show`]
//! and [`output`] tell and write. [`fail`] holds the exit codes, [`stop`] the
//! way Ctrl-C takes.

mod args;
mod balls;
mod check;
mod fail;
mod formats;
mod from_mat;
mod from_mat_args;
mod generate;
mod holes;
mod offset;
mod output;
mod plan;
mod product;
mod query;
mod query_args;
mod report;
mod reports;
mod run;
mod show;
mod simplify_args;
mod simplify_mat;
mod stop;
mod tell;
mod wanted;

use std::panic::{catch_unwind, AssertUnwindSafe};
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::Parser;

use args::{Cli, Command};
use fail::Code;

/// Everything between the arguments and the exit code.
pub fn main() -> ExitCode {
    guarded(|| match Cli::try_parse() {
        Ok(cli) => dispatch(cli),
        Err(error) => misread(&error),
    })
}

fn dispatch(cli: Cli) -> ExitCode {
    stop::install();
    let json = match &cli.command {
        Some(Command::Check(check)) => check.json,
        Some(Command::SimplifyMat(args)) => args.reporting.json,
        Some(Command::FromMat(args)) => args.reporting.json,
        Some(Command::Query(args)) => args.reporting.json,
        Some(Command::Offset(offset)) => offset.reporting.json,
        _ => cli.reconstruct.reporting.json,
    };
    let done = match (cli.command, cli.generate) {
        (Some(Command::Check(args)), _) => check::check(&args),
        (Some(Command::SimplifyMat(args)), _) => simplify_mat::simplify_mat(&args),
        (Some(Command::FromMat(args)), _) => from_mat::from_mat(&args),
        (Some(Command::Query(args)), _) => query::query(&args),
        (Some(Command::Offset(args)), _) => offset::offset(&args),
        (None, Some(what)) => generate::generate(what),
        (None, None) => plan::Plan::new(cli.reconstruct).and_then(|plan| run::run(&plan)),
    };
    match done {
        Ok(code) => code,
        Err(failure) => {
            show::failure(&failure, json);
            failure.code.into()
        }
    }
}

/// Help and version asked for, or arguments that clap refuses.
fn misread(error: &clap::Error) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            // A closed pipe is no error here either.
            let _ = error.print();
            ExitCode::SUCCESS
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let _ = error.print();
            Code::Usage.into()
        }
        _ => {
            show::say(format_args!(
                "powercrust: {}",
                error.render().to_string().trim_end()
            ));
            Code::Usage.into()
        }
    }
}

/// Runs `work`; a panic becomes one line and exit code 101.
fn guarded(work: impl FnOnce() -> ExitCode) -> ExitCode {
    std::panic::set_hook(Box::new(|info| {
        let what = info
            .payload()
            .downcast_ref::<&str>()
            .copied()
            .or_else(|| info.payload().downcast_ref::<String>().map(String::as_str))
            .unwrap_or("panic");
        let place = info
            .location()
            .map(|l| format!(" ({}:{})", l.file(), l.line()));
        show::say(format_args!(
            "powercrust: internal error: {what}{}\nhint: this is a bug: please report it with the input and the options",
            place.unwrap_or_default()
        ));
    }));
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| Code::Internal.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_an_exit_code() {
        let hook = std::panic::take_hook();
        let code = guarded(|| panic!("on purpose, for a test"));
        std::panic::set_hook(hook);
        let expected = ExitCode::from(Code::Internal);
        assert_eq!(format!("{code:?}"), format!("{expected:?}"));
    }
}
