//! Runs every file that fuzzing starts from, and every file that once broke a
//! promise, through the fuzz targets' own code.

#[path = "../fuzz/body.rs"]
mod body;

use std::path::{Path, PathBuf};

fn files(kind: &str, target: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    let Ok(entries) = folder.join(kind).join(target).read_dir() else {
        return Vec::new();
    };
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn kept_files_keep_the_promises() {
    for target in body::TARGETS {
        let seeds = files("seeds", target);
        assert!(!seeds.is_empty(), "{target} has no seeds");
        for file in seeds.into_iter().chain(files("crashes", target)) {
            let bytes = std::fs::read(&file).unwrap();
            if let Err(cause) = std::panic::catch_unwind(|| body::run(target, &bytes)) {
                eprintln!("{target}: {}", file.display());
                std::panic::resume_unwind(cause);
            }
        }
    }
}

/// Seeds cut short and with single bytes changed: a sip of what fuzzing does,
/// where nobody fuzzes.
#[test]
fn files_near_the_seeds_keep_the_promises() {
    for target in body::TARGETS {
        for file in files("seeds", target) {
            let bytes = std::fs::read(&file).unwrap();
            let step = bytes.len() / 24 + 1;
            for at in (0..bytes.len()).step_by(step) {
                body::run(target, &bytes[..at]);
                for change in [0x01, 0x10, 0x80, 0xff] {
                    let mut changed = bytes.clone();
                    changed[at] ^= change;
                    body::run(target, &changed);
                }
            }
        }
    }
}
