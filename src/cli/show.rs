//! What people and programs are told: progress, the summary line, notes,
//! errors.

use std::fmt;
use std::io::{self, Write};
use std::ops::ControlFlow;
use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use powercrust::{Progress, Stage};
use serde_json::json;

use super::fail::Failure;
use super::stop;

/// How much to say on standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Talk {
    /// Errors only.
    Quiet,
    /// Progress on a terminal, then one line.
    Plain,
    /// Also what was decided, and times.
    Verbose,
    /// Also everything counted.
    Debug,
}

impl Talk {
    pub fn new(quiet: bool, verbose: u8) -> Talk {
        match (quiet, verbose) {
            (true, _) => Talk::Quiet,
            (false, 0) => Talk::Plain,
            (false, 1) => Talk::Verbose,
            (false, _) => Talk::Debug,
        }
    }

    /// Says something that is worth saying at `level` and above.
    pub fn at(self, level: Talk, text: impl fmt::Display) {
        if self >= level {
            say(format_args!("powercrust: {text}"));
        }
    }
}

/// Writes a line to standard error, closed or not.
pub fn say(text: impl fmt::Display) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Reports a failure to people and, if wanted, to the program that asked.
pub fn failure(failure: &Failure, json: bool) {
    say(failure);
    if json {
        let object = json!({
            "ok": false,
            "error": {
                "code": failure.code as u8,
                "what": failure.what,
                "hint": failure.hint,
            },
        });
        let _ = writeln!(io::stdout(), "{object:#}");
    }
}

/// Shows the running stage on a terminal, and passes Ctrl-C on to the work.
pub struct Bar {
    bar: ProgressBar,
    stage: Mutex<Option<Stage>>,
}

impl Bar {
    pub fn new(talk: Talk) -> Bar {
        let target = if talk >= Talk::Plain {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(None, target);
        let style = ProgressStyle::with_template("{msg:>9} {bar:40} {percent:>3}% {elapsed}");
        bar.set_style(style.expect("the template is right").progress_chars("=> "));
        Bar {
            bar,
            stage: Mutex::new(None),
        }
    }

    /// Takes the bar off the screen.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bar {
    fn advance(&self, stage: Stage, done: u64, total: u64) -> ControlFlow<()> {
        if stop::requested() {
            return ControlFlow::Break(());
        }
        if let Ok(mut shown) = self.stage.lock() {
            if *shown != Some(stage) {
                *shown = Some(stage);
                self.bar.set_message(stage.name());
            }
        }
        self.bar.set_length(total);
        self.bar.set_position(done);
        ControlFlow::Continue(())
    }
}

/// `1234567` as `1,234,567`.
pub fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// `1 component`, `12 components`.
pub fn counted(number: usize, one: &str, many: &str) -> String {
    format!(
        "{} {}",
        grouped(number),
        if number == 1 { one } else { many }
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(1_000), "1,000");
        assert_eq!(grouped(1_234_567), "1,234,567");
        assert_eq!(counted(1, "face", "faces"), "1 face");
    }
}
