//! Ctrl-C: stop at the next safe place, at once when asked twice.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Mutex;

use super::fail::{Code, Failure};

static REQUESTED: AtomicBool = AtomicBool::new(false);
/// Whether someone looks at [`REQUESTED`] now and then.
static ORDERLY: AtomicBool = AtomicBool::new(false);
/// Files half written, to be removed by a hard exit.
static PARTIAL: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Takes over the signals that ask a program to end.
pub fn install() {
    // Without a handler the system ends the process: then nothing is lost but
    // a half-written file under a temporary name.
    let _ = ctrlc::set_handler(|| {
        let again = REQUESTED.swap(true, Ordering::SeqCst);
        if again || !ORDERLY.load(Ordering::SeqCst) {
            if let Ok(partial) = PARTIAL.lock() {
                for path in partial.iter() {
                    let _ = std::fs::remove_file(path);
                }
            }
            eprintln!("\n{}", Failure::interrupted());
            std::process::exit(Code::Interrupted as i32);
        }
    });
}

/// From here on the first Ctrl-C is only noted: the caller looks at
/// [`requested`] or passes it on. Before, while input is read, it ends the
/// process at once, since a read from a terminal or pipe cannot be woken.
pub fn orderly() {
    ORDERLY.store(true, Ordering::SeqCst);
}

/// Whether Ctrl-C was pressed.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// Remembers a file under way until the guard is dropped.
pub struct Partial(PathBuf);

impl Partial {
    pub fn new(path: &Path) -> Partial {
        PARTIAL.lock().unwrap().push(path.to_owned());
        Partial(path.to_owned())
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        if let Ok(mut partial) = PARTIAL.lock() {
            partial.retain(|path| *path != self.0);
        }
    }
}
