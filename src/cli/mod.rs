//! The command line: [`args`] records what was said, [`plan`] judges it before
//! any work is done, [`run`] does the work through the public library, [`show`]
//! and [`output`] tell and write. [`fail`] holds the exit codes, [`stop`] the
//! way Ctrl-C takes.

mod args;
mod axes;
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

use std::ffi::OsString;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::path::Path;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Parser, ValueEnum};

use args::{Cli, Command};
use fail::Code;
use wanted::Sharp;

/// Everything between the arguments and the exit code.
pub fn main() -> ExitCode {
    guarded(
        || match Cli::try_parse_from(joined(std::env::args_os(), Path::exists)) {
            Ok(cli) => dispatch(cli),
            Err(error) => misread(&error),
        },
    )
}

/// `--sharp auto` as the one word `--sharp=auto`: clap reads the value of an
/// option that may stand alone from one word only, lest `--sharp points.ply`
/// lose its input. A word of letters that names no file is taken for a value,
/// so that a wrong one is called wrong.
fn joined(
    words: impl IntoIterator<Item = OsString>,
    exists: impl Fn(&Path) -> bool,
) -> Vec<OsString> {
    let is_value = |word: &OsString| {
        let named = |how: &Sharp| {
            how.to_possible_value()
                .is_some_and(|v| word == v.get_name())
        };
        let letters = |w: &str| !w.is_empty() && w.chars().all(|c| c.is_ascii_alphabetic());
        Sharp::value_variants().iter().any(named)
            || word.to_str().is_some_and(letters) && !exists(Path::new(word))
    };
    let mut joined: Vec<OsString> = Vec::new();
    let mut only_files = false;
    for word in words {
        match joined.last_mut() {
            Some(last) if !only_files && last == "--sharp" && is_value(&word) => {
                last.push("=");
                last.push(word);
            }
            _ => {
                only_files |= word == "--";
                joined.push(word);
            }
        }
    }
    joined
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
    fn a_value_of_sharp_may_stand_apart() {
        let words = |text: &str| text.split(' ').map(OsString::from).collect::<Vec<_>>();
        for (said, read) in [
            ("p --sharp auto a.ply", "p --sharp=auto a.ply"),
            ("p --sharp skinny", "p --sharp=skinny"),
            ("p --sharp a.ply auto", "p --sharp a.ply auto"),
            ("p --sharp soft a.ply", "p --sharp=soft a.ply"),
            ("p --sharp cloud", "p --sharp cloud"),
            ("p --sharp - -o a.ply", "p --sharp - -o a.ply"),
            ("p --sharp --f32 auto", "p --sharp --f32 auto"),
            ("p --sharp=auto auto", "p --sharp=auto auto"),
            ("p -- --sharp auto", "p -- --sharp auto"),
            ("auto --sharp", "auto --sharp"),
        ] {
            let there = |path: &Path| path == Path::new("cloud");
            assert_eq!(joined(words(said), there), words(read));
        }
    }

    #[test]
    fn a_panic_becomes_an_exit_code() {
        let hook = std::panic::take_hook();
        let code = guarded(|| panic!("on purpose, for a test"));
        std::panic::set_hook(hook);
        let expected = ExitCode::from(Code::Internal);
        assert_eq!(format!("{code:?}"), format!("{expected:?}"));
    }
}
