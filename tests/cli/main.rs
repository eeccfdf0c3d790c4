//! The command as users meet it: the real binary, each test in a directory of
//! its own.

mod axes;
mod check;
mod done;
mod from_mat;
mod help;
mod holes;
mod interrupted;
mod offset;
mod outward;
mod query;
mod refused;
mod sharp;

use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const DONE: i32 = 0;
const UNFIT: i32 = 1;
const USAGE: i32 = 2;
const FILE: i32 = 3;
#[cfg(unix)]
const INTERRUPTED: i32 = 130;

// ---------------------------------------------------------------- harness

/// A directory with input files in it.
struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Place {
        Place(tempfile::tempdir().unwrap())
    }

    /// With `torus.xyz`, a cloud that reconstructs.
    fn with_torus() -> Place {
        let place = Place::new();
        place.put("torus.xyz", torus(600));
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn put(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).unwrap();
    }

    fn get(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(self.0.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_powercrust"));
        command
            .current_dir(self.0.path())
            .args(arguments.split_whitespace())
            .stdin(Stdio::null());
        command
    }

    fn run(&self, arguments: &str) -> Ran {
        Ran::new(arguments, self.command(arguments).output().unwrap())
    }

    /// With bytes on standard input.
    fn feed(&self, arguments: &str, bytes: &[u8]) -> Ran {
        let mut child = self
            .command(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stdin = child.stdin.take().unwrap();
        let bytes = bytes.to_vec();
        let feeder = std::thread::spawn(move || {
            let _ = stdin.write_all(&bytes);
        });
        let output = child.wait_with_output().unwrap();
        feeder.join().unwrap();
        Ran::new(arguments, output)
    }
}

/// What a run gave.
#[derive(Debug)]
struct Ran {
    arguments: String,
    code: Option<i32>,
    stdout: Vec<u8>,
    stderr: String,
}

impl Ran {
    fn new(arguments: &str, output: Output) -> Ran {
        Ran {
            arguments: arguments.to_owned(),
            code: output.status.code(),
            stdout: output.stdout,
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    #[track_caller]
    fn code(self, code: i32) -> Ran {
        assert_eq!(self.code, Some(code), "{}\n{}", self.arguments, self.stderr);
        self
    }

    #[track_caller]
    fn says(self, text: &str) -> Ran {
        assert!(
            self.stderr.contains(text),
            "no `{text}` in\n{}",
            self.stderr
        );
        self
    }

    /// An error by the house's form, which left nothing on standard output.
    #[track_caller]
    fn fails(self, code: i32, what: &str) -> Ran {
        let ran = self.code(code).says("powercrust: error: ").says(what);
        assert!(ran.stdout.is_empty(), "{}: wrote to stdout", ran.arguments);
        assert!(!ran.stderr.contains("panicked"), "{}", ran.stderr);
        ran
    }

    fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.stdout).unwrap_or_else(|e| panic!("{e}: {self:?}"))
    }
}

// ------------------------------------------------------------------ shapes

/// A torus of radii 1 and 0.4, about evenly sampled.
fn torus(count: usize) -> String {
    (1..=count)
        .map(|i| {
            let u = std::f64::consts::TAU * (i as f64 * 0.754_877_666_246_692_7).fract();
            let v = std::f64::consts::TAU * (i as f64 * 0.569_840_290_998_053_3).fract();
            // Angles that are even by area, to first order.
            let v = v - 0.4 * v.sin();
            let ring = 1.0 + 0.4 * v.cos();
            format!("{} {} {}\n", ring * u.cos(), ring * u.sin(), 0.4 * v.sin())
        })
        .collect()
}

/// Points in a cube that take a while.
#[cfg(unix)]
fn many(count: usize) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {count}\n\
         property double x\nproperty double y\nproperty double z\nend_header\n"
    )
    .into_bytes();
    let mut state = 1_u64;
    for _ in 0..3 * count {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        bytes.extend_from_slice(&((state >> 11) as f64 / (1_u64 << 53) as f64).to_le_bytes());
    }
    bytes
}

/// Vertex and face counts from the head of a PLY file.
fn ply_counts(bytes: &[u8]) -> [usize; 2] {
    let head = String::from_utf8_lossy(bytes);
    ["vertex", "face"].map(|element| {
        let line = format!("element {element} ");
        let rest = head.split_once(&line).expect("a PLY header").1;
        rest.split_whitespace().next().unwrap().parse().unwrap()
    })
}
