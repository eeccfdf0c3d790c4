//! The command as users meet it: the real binary, each test in a directory of
//! its own.

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

// ----------------------------------------------------- exit code 2: usage

#[test]
fn no_argument_shows_help() {
    Place::new().run("").code(USAGE).says("Usage: powercrust");
}

#[test]
fn missing_output_names_the_full_command() {
    let place = Place::with_torus();
    place
        .run("torus.xyz --sharp")
        .fails(USAGE, "-o is missing")
        .says("hint: powercrust torus.xyz -o torus-crust.ply");
    let spaced = place.path("my torus.xyz");
    fs::copy(place.path("torus.xyz"), &spaced).unwrap();
    let output = place.command("").arg("my torus.xyz").output().unwrap();
    Ran::new("'my torus.xyz'", output)
        .fails(USAGE, "-o is missing")
        .says("hint: powercrust 'my torus.xyz' -o 'my torus-crust.ply'");
}

#[test]
fn unknown_option() {
    Place::with_torus()
        .run("torus.xyz -o crust.ply --frobnicate")
        .fails(USAGE, "--frobnicate");
}

#[test]
fn reals_out_of_range() {
    let place = Place::with_torus();
    for (flag, said) in [
        ("--lambda 0", "--lambda is 0: expected a number in (0, 1]"),
        ("--lambda 1.5", "--lambda is 1.5"),
        ("--lambda -.5", "--lambda is -0.5"),
        ("--lambda -1e-3", "--lambda is -0.001"),
        ("--lambda=-1e-3", "--lambda is -0.001"),
        ("--lambda nan", "expected a number"),
        ("--lambda inf", "expected a number"),
        ("--lambda x", "expected a number"),
        ("--deep-angle 90", "--deep-angle is 90"),
        ("--deep-angle 180", "--deep-angle is 180"),
        ("--box-factor 1.4", "--box-factor is 1.4"),
        ("--merge -1e-9", "--merge is -0.000000001"),
        ("--merge 2", "--merge is 2"),
        ("--flatness 11", "--flatness is 11"),
        ("--interpolate maybe", "expected yes or no"),
        ("--threads 0", "--threads"),
        ("--precision 0", "--precision"),
        ("--precision 18", "--precision"),
    ] {
        place
            .run(&format!("torus.xyz -o crust.ply {flag}"))
            .fails(USAGE, said);
    }
    assert_eq!(place.names(), ["torus.xyz"]);
}

#[test]
fn unknown_output_extension() {
    let place = Place::with_torus();
    place
        .run("torus.xyz -o crust.xyz")
        .fails(USAGE, "crust.xyz: .xyz is no mesh format")
        .says("hint: known: .ply .obj");
    place.run("torus.xyz -o crust").fails(USAGE, "no extension");
    place
        .run("torus.xyz -o crust.ma")
        .fails(USAGE, ".ma is no mesh format")
        .says("hint: for a medial axis: --mat crust.ma");
    place.run("torus.xyz --mat a.stl").fails(USAGE, "a.stl");
    place.run("torus.xyz --poles a.obj").fails(USAGE, "a.obj");
    place
        .run("torus.xyz -o crust.x --output-format x")
        .fails(USAGE, "--output-format x: unknown format");
    place
        .run("torus.xyz -o crust.ply --input-format x")
        .fails(USAGE, "--input-format x: unknown format");
}

#[test]
fn input_is_never_overwritten() {
    let place = Place::new();
    place.put(
        "points.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\n",
    );
    fs::create_dir(place.path("sub")).unwrap();
    let before = place.get("points.obj");
    for output in [
        "-o points.obj",
        "-o ./points.obj",
        "-o sub/../points.obj",
        "--mat points.obj",
    ] {
        place
            .run(&format!("points.obj {output}"))
            .fails(USAGE, "would be overwritten");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(place.path("points.obj"), place.path("link.obj")).unwrap();
        place
            .run("points.obj -o link.obj")
            .fails(USAGE, "would be overwritten");
    }
    assert_eq!(place.get("points.obj"), before);
}

#[test]
fn two_results_in_one_place() {
    let place = Place::with_torus();
    place
        .run("torus.xyz -o a.ply --mat ./a.ply")
        .fails(USAGE, "two results");
    place
        .run("torus.xyz -o - --stats -")
        .fails(USAGE, "more than one result would go to standard output");
    let ran = place.run("torus.xyz -o - --json").code(USAGE);
    assert_eq!(ran.json()["ok"], false);
    assert_eq!(ran.json()["error"]["code"], USAGE);
}

#[test]
fn flags_without_effect() {
    let place = Place::with_torus();
    for arguments in [
        "-o a.obj --ascii",
        "-o a.obj --f32",
        "-o a.ply --precision 5",
        "--mat a.ma --output-format ply",
    ] {
        place
            .run(&format!("torus.xyz {arguments}"))
            .fails(USAGE, "would have no effect");
    }
}

#[test]
fn quiet_and_verbose_exclude_each_other() {
    Place::with_torus()
        .run("torus.xyz -o a.ply -q -v")
        .fails(USAGE, "--quiet");
}

#[test]
fn axes_are_simplified() {
    let place = Place::with_torus();
    place.run("torus.xyz --mat axis.ma").code(DONE);
    let example = place.run("simplify-mat axis.ma --eps 0.01 -o simple.ma");
    example
        .code(DONE)
        .says("simple.ma: ")
        .says("Betti numbers 1, 1, 0");
    let ran = place.run("simplify-mat axis.ma --eps 10% --delta 3% --thin --json -q");
    let told = ran.code(DONE).json();
    assert_eq!(told["side"], "inner");
    assert_eq!(told["axis"]["tetrahedra"], 0);
    assert_eq!(told["axis"]["betti"]["tunnels"], 1);
    assert_eq!(told["axis"]["balls"], told["simplified"]["after"]);
    // The points themselves, and every format.
    for (input, output) in [
        ("torus.xyz", "a.ma"),
        ("a.ma", "b.ply"),
        ("b.ply", "c.json"),
        ("c.json", "d.obj"),
    ] {
        let ran = place.run(&format!("simplify-mat {input} --eps 1% -o {output}"));
        ran.code(DONE).says("Betti numbers 1, 1, 0");
    }
    let outer = place.run("simplify-mat a.ma --side outer -o outer.ma --eps 1%");
    outer.code(DONE);
    let text = String::from_utf8(place.get("outer.ma")).unwrap();
    assert!(text.contains("\nside outer\n"));
    // Filters, parts, skeleton.
    for filter in [
        "--lambda-medial 5%",
        "--angle 60",
        "--scale 1.1",
        "--dey-zhao",
        "--dey-zhao=30,10",
        "--balls 30",
    ] {
        let ran = place.run(&format!("simplify-mat torus.xyz {filter} -o f.ma"));
        ran.code(DONE).says("Betti numbers 1, 1, 0");
    }
    let ran = place.run("simplify-mat torus.xyz --structure -o parts.ply --ascii --json -q");
    let told = ran.code(DONE).json();
    assert!(told["structure"]["sheets"].is_array());
    let text = String::from_utf8(place.get("parts.ply")).unwrap();
    for property in ["sheet", "seam", "rim", "junction", "thickness"] {
        assert!(text.contains(&format!(" {property}\n")), "{property}");
    }
    place
        .run("simplify-mat torus.xyz --structure -o parts.json")
        .code(DONE);
    let parts: serde_json::Value = serde_json::from_slice(&place.get("parts.json")).unwrap();
    let sheets = parts["structure"]["sheet_of_triangle"].as_array().unwrap();
    assert_eq!(sheets.len(), parts["triangles"].as_array().unwrap().len());
    place
        .run("simplify-mat torus.xyz --skeleton -o line.ma")
        .code(DONE);
    let text = String::from_utf8(place.get("line.ma")).unwrap();
    assert!(text.lines().next().unwrap().ends_with(" 0"));
    // What other programs write, and what they read.
    place
        .run("simplify-mat a.ma -o bare.ma --bare --eps 0 --delta 0")
        .code(DONE);
    let text = String::from_utf8(place.get("bare.ma")).unwrap();
    let known = |line: &str| ["v ", "e ", "f ", "# "].iter().any(|w| line.starts_with(w));
    assert!(text.lines().skip(1).all(known));
    let note = place.run("simplify-mat bare.ma -o again.ma --eps 1%");
    note.code(DONE)
        .says("estimated from the radii")
        .says("one side only");
    let stream = place.feed("simplify-mat - -o - --eps 1%", &place.get("a.ma"));
    let text = String::from_utf8(stream.code(DONE).stdout).unwrap();
    assert!(text.lines().nth(1).unwrap().starts_with("v "));
}

#[test]
fn axes_that_cannot_be_simplified() {
    let place = Place::with_torus();
    place.put("a.ma", "2 1 0\nv 0 0 0 1\nv 1 0 0 1\ne 0 1\n");
    place.put("bad.ma", "2 1 0\nv 0 0 0 1\nv 1 0 0 -1\ne 0 1\n");
    place.put("none.ma", "0 0 0\n");
    let usage = [
        ("a.ma", "nowhere to write"),
        ("a.ma -o a.ma", "would be overwritten"),
        ("a.ma -o b.stl", "no medial axis format"),
        ("a.ma -o b.ma --eps -1", "expected a length"),
        ("a.ma -o b.ma --eps x", "expected a length"),
        ("a.ma -o b.ma --ascii", "would have no effect"),
        ("a.ma -o b.ma --lambda 0.3", "would have no effect"),
        ("a.ma --json --bare", "would have no effect"),
        ("a.ma -o - --json", "more than one result"),
        ("a.ma -o b.ma --angle 200", "--angle is 200"),
        ("a.ma -o b.ma --scale 0.5", "--scale is 0.5"),
        ("a.ma -o b.ma --dey-zhao=1", "22.5,8"),
        ("a.ma -o b.ma --structure", "would have no effect"),
        ("torus.xyz -o b.ma --lambda 3", "--lambda is 3"),
    ];
    for (arguments, what) in usage {
        let ran = place.run(&format!("simplify-mat {arguments}")).code(USAGE);
        ran.says(what);
    }
    place
        .run("simplify-mat bad.ma -o b.ma")
        .fails(FILE, "bad.ma: line 3: the radius -1");
    place
        .run("simplify-mat none.ma -o b.ma")
        .fails(UNFIT, "no balls");
    place
        .run("simplify-mat gone.ma -o b.ma")
        .fails(FILE, "gone.ma: cannot read");
    place
        .run("torus.xyz -o crust.ply --thin")
        .fails(USAGE, "--thin would have no effect");
    assert!(!place.path("b.ma").exists());
    let help = place.run("simplify-mat --help").code(DONE);
    let text = String::from_utf8(help.stdout).unwrap();
    assert!(text.contains("--eps <E>") && text.contains("Examples:"));
}

#[test]
fn input_that_cannot_be_read() {
    let place = Place::with_torus();
    place
        .run("nothing.ply -o crust.ply")
        .fails(FILE, "nothing.ply: cannot read: no such file");
    fs::create_dir(place.path("dir.ply")).unwrap();
    place
        .run("dir.ply -o crust.ply")
        .fails(FILE, "dir.ply: cannot read: this is a directory");
    place.put("scan.e57", "LASF");
    place
        .run("scan.e57 -o crust.ply")
        .fails(FILE, ".e57 files cannot be read")
        .says("hint: convert");
    place.put("unknown.bin", [1, 0, 2, 0, 255, 9]);
    place
        .run("unknown.bin -o crust.ply")
        .fails(FILE, "not a format that can be read");
}

#[test]
fn output_that_cannot_be_written_is_refused_before_reading() {
    let place = Place::with_torus();
    // Malformed input: an error about it would mean that it was read first.
    place.put("bad.xyz", "0 0\n");
    place
        .run("bad.xyz -o nowhere/crust.ply")
        .fails(FILE, "there is no directory nowhere");
    fs::create_dir(place.path("dir")).unwrap();
    place
        .run("bad.xyz -o dir")
        .fails(FILE, "dir: cannot write: this is a directory")
        .says("dir/crust.ply");
    place.put("kept.ply", "precious");
    let mut permissions = fs::metadata(place.path("kept.ply")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(place.path("kept.ply"), permissions).unwrap();
    place
        .run("bad.xyz -o kept.ply")
        .fails(FILE, "kept.ply: cannot write: the file is read-only");
    assert_eq!(place.get("kept.ply"), b"precious");
    #[cfg(target_os = "linux")]
    place
        .run("bad.xyz -o /proc/crust.ply")
        .fails(FILE, "cannot write into /proc");
}

#[test]
fn malformed_input_names_file_and_place() {
    let place = Place::new();
    place.put("empty.ply", "");
    place
        .run("empty.ply -o crust.ply")
        .fails(FILE, "empty.ply: the file is empty");
    place.put("word.xyz", "0 0 0\n1 0 0\n0 one 0\n");
    place
        .run("word.xyz -o crust.ply")
        .fails(FILE, "word.xyz: line 3")
        .says("hint: ");
    let head = "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\n\
                property float y\nproperty float z\nend_header\n";
    place.put("short.ply", format!("{head}0 0 0\n1 0 0\n"));
    place
        .run("short.ply -o crust.ply")
        .fails(FILE, "short.ply: truncated: 9 vertices announced, 2 found");
    assert_eq!(place.names(), ["empty.ply", "short.ply", "word.xyz"]);
}

#[test]
fn lying_header_costs_nothing() {
    let place = Place::new();
    place.put(
        "huge.ply",
        "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n\
         property float x\nproperty float y\nproperty float z\nend_header\nabc",
    );
    let start = Instant::now();
    place
        .run("huge.ply -o crust.ply")
        .fails(FILE, "huge.ply: truncated");
    assert!(start.elapsed() < Duration::from_secs(5));
}

#[cfg(target_os = "linux")]
#[test]
fn full_disk() {
    let place = Place::with_torus();
    let full = || Stdio::from(fs::File::options().write(true).open("/dev/full").unwrap());
    let arguments = "torus.xyz -o -";
    let output = place.command(arguments).stdout(full()).output().unwrap();
    Ran::new(arguments, output).fails(FILE, "standard output: cannot write: no space left");
    place
        .run("torus.xyz -o /dev/full --output-format ply")
        .fails(FILE, "/dev/full: cannot write: no space left");
    // With nowhere to complain to, the exit code still tells.
    let arguments = "nothing.ply -o crust.ply";
    let output = place.command(arguments).stderr(full()).output().unwrap();
    assert_eq!(output.status.code(), Some(FILE));
}

// ------------------------------------- exit code 1: no solid in this input

#[test]
fn data_that_is_no_solid() {
    let place = Place::new();
    for (name, points, said) in [
        ("few.xyz", "0 0 0\n1 0 0\n0 1 0\n", "at least 4"),
        (
            "same.xyz",
            "1 2 3\n1 2 3\n1 2 3\n1 2 3\n1 2 3\n",
            "at least 4",
        ),
        ("line.xyz", "0 0 0\n1 1 1\n2 2 2\n3 3 3\n4 4 4\n", "line"),
        ("plane.xyz", "0 0 5\n1 0 5\n0 1 5\n1 1 5\n3 4 5\n", "plane"),
    ] {
        place.put(name, points);
        place
            .run(&format!("{name} -o crust.ply"))
            .fails(UNFIT, &format!("{name}: "))
            .says(said)
            .says("hint: ");
    }
    place.put(
        "none.ply",
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\n\
         property float y\nproperty float z\nend_header\n",
    );
    place
        .run("none.ply -o crust.ply")
        .fails(UNFIT, "none.ply: no ");
    assert!(!place.path("crust.ply").exists());
}

#[test]
fn invalid_points_are_refused_or_dropped() {
    let place = Place::new();
    place.put("torus.xyz", format!("{}nan 0 0\n0 inf 1\n", torus(600)));
    place.put("crust.ply", "old");
    place
        .run("torus.xyz -o crust.ply")
        .fails(UNFIT, "torus.xyz: line 601")
        .says("hint: correct the point, or drop all such points with --skip-invalid");
    assert_eq!(place.get("crust.ply"), b"old");
    place
        .run("torus.xyz -o crust.ply --skip-invalid")
        .code(DONE)
        .says("note: 2 of 602 points have NaN");
    assert_ne!(place.get("crust.ply"), b"old");
}

// ------------------------------------------------------ exit code 0: done

#[test]
fn one_line_does_it() {
    let place = Place::with_torus();
    let ran = place
        .run("torus.xyz -o crust.ply")
        .code(DONE)
        .says("powercrust: crust.ply: 600 samples, ")
        .says(" 1 component, genus 1, ");
    assert!(ran.stdout.is_empty());
    // Not a terminal: no progress bar, one line.
    assert_eq!(ran.stderr.lines().count(), 1, "{}", ran.stderr);
    let [vertices, faces] = ply_counts(&place.get("crust.ply"));
    // A triangulated torus has Euler characteristic 0: V = F / 2.
    assert_eq!(2 * vertices, faces);
    assert_eq!(place.names(), ["crust.ply", "torus.xyz"]);
}

#[test]
fn quiet_says_nothing() {
    let ran = Place::with_torus()
        .run("torus.xyz -o crust.ply -q")
        .code(DONE);
    assert_eq!(ran.stderr, "");
    assert!(ran.stdout.is_empty());
}

#[test]
fn verbose_says_what_was_decided() {
    let place = Place::with_torus();
    place
        .run("torus.xyz -o crust.ply --sharp -v")
        .code(DONE)
        .says("--sharp without --lambda: taking 0.4")
        .says("torus.xyz: text, 600 points")
        .says("\"lambda\":0.4");
    place
        .run("torus.xyz -o crust.ply --sharp --lambda 0.7 -vv")
        .code(DONE)
        .says("\"lambda\":0.7")
        .says("\"samples\": 600");
}

#[test]
fn every_mesh_format() {
    let place = Place::with_torus();
    for (extension, start) in [
        ("ply", "ply\nformat binary_little_endian"),
        ("obj", ""),
        ("off", "OFF"),
        ("stl", ""),
        ("json", "{"),
        ("glb", "glTF"),
        ("PLY", "ply\n"),
    ] {
        let name = format!("crust.{extension}");
        place.run(&format!("torus.xyz -o {name} -q")).code(DONE);
        let bytes = place.get(&name);
        assert!(bytes.starts_with(start.as_bytes()), "{name}");
        assert!(bytes.len() > 10_000, "{name}");
    }
    place
        .run("torus.xyz -o crust.dat --output-format off -q")
        .code(DONE);
    assert_eq!(place.get("crust.dat"), place.get("crust.off"));
}

#[test]
fn ply_variants() {
    let place = Place::with_torus();
    place.run("torus.xyz -o double.ply").code(DONE);
    place.run("torus.xyz -o float.ply --f32").code(DONE);
    place
        .run("torus.xyz -o text.ply --ascii --precision 6")
        .code(DONE);
    let [double, float, text] = ["double.ply", "float.ply", "text.ply"].map(|n| place.get(n));
    assert!(float.len() < double.len());
    assert!(text.starts_with(b"ply\nformat ascii"));
    assert_eq!(ply_counts(&text), ply_counts(&double));
}

#[test]
fn polygons_are_larger_than_triangles() {
    let place = Place::with_torus();
    place
        .run("torus.xyz -o t.ply --polygons --triangulate")
        .code(DONE);
    place
        .run("torus.xyz -o p.ply --triangulate --polygons")
        .code(DONE)
        .says("polygons");
    // On a torus V - E + F = 0: triangles are two a vertex, polygons fewer.
    let [triangles, polygons] = ["t.ply", "p.ply"].map(|name| {
        let counts = ply_counts(&place.get(name));
        counts[1] as f64 / counts[0] as f64
    });
    assert_eq!(triangles, 2.0);
    assert!(polygons < 1.5, "{polygons} polygons a vertex");
}

#[test]
fn all_results_at_once() {
    let place = Place::with_torus();
    place
        .run(
            "torus.xyz -o crust.ply --mat inner.ma --outer-mat outer.json --poles poles.ply \
             --stats stats.json",
        )
        .code(DONE);
    let lines = String::from_utf8(place.get("inner.ma")).unwrap();
    assert!(lines.lines().any(|line| line.starts_with("v ")));
    let outer: serde_json::Value = serde_json::from_slice(&place.get("outer.json")).unwrap();
    assert!(!outer["balls"].as_array().unwrap().is_empty());
    assert!(place.get("poles.ply").starts_with(b"ply"));
    let stats: serde_json::Value = serde_json::from_slice(&place.get("stats.json")).unwrap();
    assert_eq!(stats["stats"]["samples"], 600);
    assert_eq!(stats["mesh"]["genus"], 1);
    assert_eq!(stats["input"]["read"]["format"], "text");
}

#[test]
fn axis_alone() {
    let place = Place::with_torus();
    place.run("torus.xyz --mat axis.ply").code(DONE);
    assert_eq!(place.names(), ["axis.ply", "torus.xyz"]);
}

#[test]
fn json_summary() {
    let place = Place::with_torus();
    let ran = place.run("torus.xyz -o crust.ply --json -q").code(DONE);
    let summary = ran.json();
    assert_eq!(summary["ok"], true);
    assert_eq!(summary["mesh"]["components"], 1);
    assert_eq!(summary["mesh"]["genus"], 1);
    let [vertices, faces] = ply_counts(&place.get("crust.ply"));
    assert_eq!(summary["mesh"]["vertices"], vertices);
    assert_eq!(summary["mesh"]["faces"], faces);
    // 2 pi² R r², less what flat faces cut off.
    let volume = summary["mesh"]["volume"].as_f64().unwrap();
    assert!((2.7..3.3).contains(&volume), "{volume}");
    let ran = place.run("nothing.ply -o crust.ply --json").code(FILE);
    assert_eq!(ran.json()["error"]["code"], FILE);
    let ran = place.run("torus.xyz --stats - -q").code(DONE);
    assert_eq!(ran.json()["stats"]["samples"], 600);
}

#[test]
fn crossing_faces_are_counted_on_request() {
    let place = Place::with_torus();
    let plain = place.run("torus.xyz -o crust.ply --json").code(DONE);
    assert!(!plain.stderr.contains("cross"));
    assert_eq!(plain.json()["mesh"]["closed"], true);
    let checked = place
        .run("torus.xyz -o crust.ply --json --verify")
        .code(DONE);
    let crossing = &checked.json()["mesh"]["crossing"];
    let judged = place.run("check crust.ply --json").json();
    assert_eq!(*crossing, judged["counts"]["crossing"]);
    assert_eq!(checked.json()["mesh"]["sound"], judged["ok"]);
    checked.says("verified");
}

/// The torus with a small sphere beside it: colours, normals, a class and a
/// column of reals, as PLY.
fn rich() -> String {
    let torus = torus(600);
    let ball = (0..120).map(|i| {
        let z = 1.0 - (2 * i + 1) as f64 / 120.0;
        let (ring, turn) = ((1.0 - z * z).sqrt(), 2.399_963_229_728_653 * f64::from(i));
        let [x, y, z] = [ring * turn.cos(), ring * turn.sin(), z].map(|c| 0.2 * c);
        format!("{} {y} {z}", x + 3.0)
    });
    let lines: Vec<String> = (torus.lines().map(str::to_owned))
        .chain(ball)
        .enumerate()
        .map(|(i, p)| format!("{p} 0 0 1 {} 10 20 7 {}.5", i % 256, i % 9))
        .collect();
    format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\n\
         property double z\nproperty float nx\nproperty float ny\nproperty float nz\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int class\n\
         property float quality\nend_header\n{}\n",
        lines.len(),
        lines.join("\n")
    )
}

/// The head of a PLY file.
fn ply_head(bytes: &[u8]) -> String {
    let head = String::from_utf8_lossy(bytes);
    head.split_once("end_header")
        .expect("a PLY header")
        .0
        .to_owned()
}

#[test]
fn values_of_the_input_are_kept() {
    let place = Place::new();
    place.put("rich.ply", rich());
    place.run("rich.ply -o crust.ply").code(DONE);
    let head = ply_head(&place.get("crust.ply"));
    for property in [
        "float nx",
        "uchar red",
        "int class",
        "double quality",
        "int sample",
    ] {
        assert!(
            head.contains(&format!("property {property}\n")),
            "{property}"
        );
    }
    assert!(!head.contains("thickness"));
    place
        .run("rich.ply -o all.ply --attributes all --ascii")
        .code(DONE);
    let all = String::from_utf8(place.get("all.ply")).unwrap();
    for property in [
        "double thickness",
        "double gap",
        "double polar_radii",
        "int component",
        "uchar hole",
    ] {
        assert!(
            all.contains(&format!("property {property}\n")),
            "{property}"
        );
    }
    let second: Vec<&str> = all.split_once("end_header\n").unwrap().1.lines().collect();
    assert!(second[0].contains(" 0 0 1 "), "{}", second[0]);
    place
        .run("rich.ply -o bare.ply --attributes none")
        .code(DONE);
    assert!(!ply_head(&place.get("bare.ply")).contains("sample"));
    place
        .run("rich.ply -o some.ply --attributes quality,hole")
        .code(DONE);
    let head = ply_head(&place.get("some.ply"));
    assert!(head.contains("quality") && head.contains("hole") && !head.contains("red"));
    // A surface is taken again as points, with all it carries.
    place.run("crust.ply -o again.ply").code(DONE);
    assert_eq!(
        ply_head(&place.get("again.ply"))
            .matches("int sample")
            .count(),
        1
    );

    place.run("rich.ply -o crust.obj").code(DONE);
    let obj = String::from_utf8(place.get("crust.obj")).unwrap();
    let vertex = obj.lines().find(|l| l.starts_with("v ")).unwrap();
    assert_eq!(vertex.split_whitespace().count(), 7, "{vertex}");
    assert!(obj.contains("\nvn ") && obj.contains("//"));
    place.run("rich.ply -o crust.glb").code(DONE);
    let glb = place.get("crust.glb");
    let glb = String::from_utf8_lossy(&glb);
    assert!(glb.starts_with("glTF") && glb.contains("COLOR_0") && glb.contains("NORMAL"));

    place
        .run("rich.ply -o crust.ply --attributes colour")
        .fails(USAGE, "--attributes colour: the input has no such column")
        .says("colours, thickness");
    place
        .run("rich.ply -o crust.obj --attributes hole")
        .fails(USAGE, "OBJ files cannot hold it");
    place
        .run("rich.ply --mat a.ma --attributes all")
        .fails(USAGE, "no effect");
}

#[test]
fn parts_are_chosen_by_size() {
    let place = Place::new();
    place.put("rich.ply", rich());
    let all = place.run("rich.ply -o crust.ply --json").code(DONE).json();
    assert_eq!(all["mesh"]["components"], 2);
    assert_eq!(all["mesh"]["cavities"], 0);
    for filter in [
        "--keep largest",
        "--keep 1",
        "--min-volume 5%",
        "--min-volume 0.1",
    ] {
        let one = place
            .run(&format!("rich.ply -o one.ply --json --verify {filter}"))
            .code(DONE)
            .json();
        assert_eq!(one["mesh"]["components"], 1, "{filter}");
        assert_eq!(one["dropped"]["components"], 1, "{filter}");
        assert_eq!(one["mesh"]["genus"], 1, "{filter}");
    }
    place
        .run("rich.ply -o one.ply --keep all --drop-cavities")
        .code(DONE)
        .says("2 components");
    place
        .run("rich.ply -o none.ply --min-volume 1000")
        .fails(UNFIT, "nothing is left")
        .says("the largest part encloses 3.");
    for filter in [
        "--keep 0",
        "--keep few",
        "--min-volume 101%",
        "--min-volume -1",
    ] {
        place
            .run(&format!("rich.ply -o none.ply {filter}"))
            .fails(USAGE, filter.split(' ').next().unwrap());
    }
}

#[test]
fn triangles_are_reduced() {
    let place = Place::with_torus();
    let full = place.run("torus.xyz -o full.ply --json").code(DONE).json();
    let from = full["mesh"]["faces"].as_u64().unwrap();
    let ran = place
        .run("torus.xyz -o less.ply --json --verify --reduce 2")
        .code(DONE);
    let less = ran.json();
    assert_eq!(less["reduced"]["from"], from);
    assert_eq!(less["reduced"]["faces"], less["mesh"]["faces"]);
    assert!(less["mesh"]["faces"].as_u64().unwrap() <= from / 2);
    assert_eq!(less["mesh"]["genus"], 1);
    let moved = less["reduced"]["moved"]["mean_of_diagonal"]
        .as_f64()
        .unwrap();
    assert!(moved < 0.005, "{moved}");
    ran.says("% of the diagonal");
    place.run("torus.xyz -o some.ply --faces 300 -q").code(DONE);
    assert_eq!(ply_counts(&place.get("some.ply"))[1], 300);
    // As far as it goes, and said so: a torus needs 14.
    place
        .run("torus.xyz -o least.ply --faces 4")
        .code(DONE)
        .says("not fewer (4 asked for)");
    for flags in [
        "--reduce 1",
        "--faces 3",
        "--faces 9 --reduce 2",
        "--faces 9 --polygons",
    ] {
        place
            .run(&format!("torus.xyz -o some.ply {flags}"))
            .fails(USAGE, "--");
    }
}

#[test]
fn what_a_run_takes_is_told_and_limited() {
    let place = Place::with_torus();
    let told = place.run("torus.xyz --dry-run").code(DONE);
    let text = String::from_utf8(told.stdout).unwrap();
    assert!(text.starts_with("torus.xyz: 600 points: about "), "{text}");
    assert!(text.contains("MiB of memory"), "{text}");
    let told = place
        .run("torus.xyz -o crust.ply --dry-run --json --max-memory 1G")
        .code(DONE)
        .json();
    assert_eq!(told["points"], 600);
    assert!(told["estimate"]["memory_bytes"].as_u64().unwrap() > 1_000_000);
    for also in ["", " --dry-run"] {
        place
            .run(&format!("torus.xyz -o crust.ply --max-memory 1M{also}"))
            .fails(UNFIT, "more than --max-memory 1.0 MiB");
    }
    assert_eq!(place.names(), ["torus.xyz"]);
    place
        .run("torus.xyz -o crust.ply --max-memory much")
        .fails(USAGE, "expected a size");
    let stats = place.run("torus.xyz --stats - -q").code(DONE).json();
    if cfg!(target_os = "linux") {
        assert!(stats["peak_memory_bytes"].as_u64().unwrap() > 1_000_000);
    }
}

#[test]
fn what_is_written_is_verified() {
    let place = Place::with_torus();
    for name in ["crust.ply", "crust.stl", "crust.glb", "crust.obj"] {
        place
            .run(&format!("torus.xyz -o {name} --verify"))
            .code(DONE)
            .says("verified");
    }
    place.run("torus.xyz -o f.ply --f32 --verify").code(DONE);
    place.run("check f.ply").code(DONE);
    place.run("check crust.stl").code(DONE);
    // One digit is too few for this surface.
    place
        .run("torus.xyz -o coarse.obj --precision 1 --verify")
        .fails(UNFIT, "not sound as it would be written")
        .says("nothing was written");
    assert!(!place.names().contains(&"coarse.obj".to_owned()));
    // Not asked, it is written, and said.
    place
        .run("torus.xyz -o coarse.obj --precision 1")
        .code(DONE)
        .says("not sound as rounded in the file: ");
    let fine = place.run("torus.xyz -o fine.obj --precision 12").code(DONE);
    assert!(!fine.stderr.contains("not sound"), "{}", fine.stderr);
    place
        .run("check crust.glb")
        .fails(FILE, "GLB cannot be read");
}

#[test]
fn streams_give_the_bytes_of_files() {
    let place = Place::with_torus();
    place.run("torus.xyz -o crust.ply").code(DONE);
    let points = place.get("torus.xyz");
    let piped = place.feed("- -o -", &points).code(DONE);
    assert_eq!(piped.stdout, place.get("crust.ply"));
    place
        .feed("- -o again.ply --input-format xyz", &points)
        .code(DONE);
    assert_eq!(place.get("again.ply"), place.get("crust.ply"));
    // The format of a stream is seen from its bytes: a mesh by its vertices.
    place
        .feed("- -o second.off", &place.get("crust.ply"))
        .code(DONE)
        .says("note: This is a mesh of");
    place
        .feed("- -o crust.ply", b"")
        .fails(FILE, "standard input: the file is empty");
}

#[test]
fn threads_do_not_change_a_byte() {
    let place = Place::with_torus();
    for threads in [1, 2] {
        place
            .run(&format!(
                "torus.xyz -o {threads}.ply --mat {threads}.ma --threads {threads}"
            ))
            .code(DONE);
    }
    assert_eq!(place.get("1.ply"), place.get("2.ply"));
    assert_eq!(place.get("1.ma"), place.get("2.ma"));
}

#[test]
fn more_threads_than_any_machine_has() {
    let place = Place::with_torus();
    place.run("torus.xyz -o one.ply --threads 1").code(DONE);
    place
        .run("torus.xyz -o many.ply --threads 100000")
        .code(DONE);
    assert_eq!(place.get("one.ply"), place.get("many.ply"));
}

#[test]
fn duplicates_are_merged_and_counted() {
    let place = Place::new();
    place.put("torus.xyz", torus(600) + &torus(3));
    place
        .run("torus.xyz -o crust.ply")
        .code(DONE)
        .says("note: 3 duplicate points merged");
}

#[test]
fn old_output_is_replaced_whole() {
    let place = Place::with_torus();
    place.put("crust.ply", vec![b'x'; 5_000_000]);
    place.run("torus.xyz -o crust.ply").code(DONE);
    let bytes = place.get("crust.ply");
    assert!(bytes.starts_with(b"ply") && bytes.len() < 5_000_000);
    assert_eq!(place.names(), ["crust.ply", "torus.xyz"]);
}

#[cfg(unix)]
#[test]
fn devices_are_written_into() {
    Place::with_torus()
        .run("torus.xyz -o /dev/null --output-format ply")
        .code(DONE);
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
}

#[cfg(unix)]
#[test]
fn closed_pipe_is_success() {
    let place = Place::new();
    place.put("torus.xyz", torus(3000));
    let mut child = place
        .command("torus.xyz -o - -q")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut first = [0; 3];
    let mut stdout = child.stdout.take().unwrap();
    stdout.read_exact(&mut first).unwrap();
    drop(stdout);
    assert_eq!(&first, b"ply");
    let ran = Ran::new("head -c 3", child.wait_with_output().unwrap()).code(DONE);
    assert_eq!(ran.stderr, "");
}

#[test]
fn scans_of_this_repository() {
    let scan = Path::new(env!("CARGO_MANIFEST_DIR")).join("scans/cactus.3337.pts");
    let place = Place::new();
    fs::copy(scan, place.path("cactus.pts")).unwrap();
    place
        .run("cactus.pts -o crust.ply")
        .code(DONE)
        .says("note: 57 duplicate points merged")
        .says("3,280 samples");
}

// ------------------------------------------------------------------- check

/// A tetrahedron, outward.
const TETRAHEDRON: &str = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n\
                           3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

#[test]
fn check_finds_a_mesh_sound() {
    let place = Place::with_torus();
    place.put("solid.off", TETRAHEDRON);
    let ran = place.run("check solid.off").code(DONE);
    let text = String::from_utf8(ran.stdout).unwrap();
    assert!(text.starts_with("solid.off: sound"), "{text}");
    assert!(
        text.contains("4 vertices, 4 faces, 1 component, genus 0"),
        "{text}"
    );
    let ran = place.run("check solid.off --json").code(DONE);
    assert_eq!(ran.json()["ok"], true);
    assert_eq!(ran.json()["genus"], 0);
    let ran = place.feed("check - -q", TETRAHEDRON.as_bytes()).code(DONE);
    assert!(ran.stdout.is_empty() && ran.stderr.is_empty());
    for name in ["crust.ply", "crust.obj", "crust.json"] {
        place.run(&format!("torus.xyz -o {name} -q")).code(DONE);
        let ran = place.run(&format!("check {name}")).code(DONE);
        assert!(String::from_utf8(ran.stdout).unwrap().contains("genus 1"));
    }
}

#[test]
fn check_names_what_is_wrong() {
    let place = Place::new();
    place.put(
        "open.off",
        TETRAHEDRON
            .replace("4 4 0", "4 3 0")
            .replace("3 2 0 3\n", ""),
    );
    let ran = place.run("check open.off").code(UNFIT);
    let text = String::from_utf8(ran.stdout).unwrap();
    assert!(text.starts_with("open.off: not sound"), "{text}");
    assert!(
        text.contains("3 open edges, first: between vertices 0 and 2 of face 0"),
        "{text}"
    );
    assert!(ran.stderr.is_empty());
    let ran = place.run("check open.off --json").code(UNFIT);
    assert_eq!(ran.json()["ok"], false);
    assert_eq!(ran.json()["counts"]["open_edge"], 3);
    let ran = place.run("check open.off --quiet").code(UNFIT);
    assert!(ran.stdout.is_empty());

    place.put("turned.off", TETRAHEDRON.replace("3 2 0 3", "3 0 2 3"));
    let ran = place.run("check turned.off").code(UNFIT);
    let text = String::from_utf8(ran.stdout).unwrap();
    assert!(text.contains("different orientation"), "{text}");

    place.put("bare.off", "OFF\n4 0 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
    let ran = place.run("check bare.off").code(UNFIT);
    assert!(String::from_utf8(ran.stdout).unwrap().contains("no faces"));
}

#[test]
fn check_of_what_is_no_mesh() {
    let place = Place::with_torus();
    place
        .run("check torus.xyz")
        .fails(FILE, "torus.xyz: not a mesh format that can be read");
    place.run("check").fails(USAGE, "<MESH>");
    place
        .run("check nothing.ply")
        .fails(FILE, "nothing.ply: cannot read");
    place.put("cut.off", &TETRAHEDRON[..40]);
    place.run("check cut.off").fails(FILE, "cut.off: ");
    place
        .run("check torus.xyz --input-format x")
        .fails(USAGE, "--input-format x: unknown format");
}

// ---------------------------------------------- exit code 130: interrupted

#[cfg(unix)]
fn interrupt(child: &Child) {
    let killed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(killed.success());
}

#[cfg(unix)]
#[test]
fn interrupt_leaves_no_file() {
    let place = Place::new();
    place.put("many.ply", many(300_000));
    place.put("crust.ply", "old");
    let arguments = "many.ply -o crust.ply --mat axis.ma";
    let child = place
        .command(arguments)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(700));
    interrupt(&child);
    let start = Instant::now();
    let ran = Ran::new(arguments, child.wait_with_output().unwrap());
    ran.fails(INTERRUPTED, "interrupted");
    assert!(start.elapsed() < Duration::from_secs(10));
    assert_eq!(place.names(), ["crust.ply", "many.ply"]);
    assert_eq!(place.get("crust.ply"), b"old");
}

#[cfg(unix)]
#[test]
fn interrupt_while_waiting_for_input() {
    let place = Place::new();
    let child = place
        .command("- -o crust.ply")
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(300));
    interrupt(&child);
    // Nothing is sent and the pipe stays open.
    let mut child = child;
    let stdin = child.stdin.take();
    let output = child.wait_with_output().unwrap();
    drop(stdin);
    Ran::new("-", output).fails(INTERRUPTED, "interrupted");
    assert!(place.names().is_empty());
}

// ------------------------------------------------------------ help and docs

#[test]
fn help_states_the_contract() {
    let place = Place::new();
    let help = place.run("--help").code(DONE);
    let text = String::from_utf8(help.stdout).unwrap();
    for code in ["0 ", "1 ", "2 ", "3 ", "101 ", "130 "] {
        assert!(text.contains(&format!("\n  {code}")), "exit code {code}");
    }
    for part in [
        "Examples:",
        "Formats:",
        "Exit codes:",
        ".xyz",
        "medial axis",
    ] {
        assert!(text.contains(part), "{part}");
    }
    assert!(text.contains("simplify-mat"));
    let short = place.run("-h").code(DONE);
    assert!(short.stdout.len() < text.len());
    let version = place.run("--version").code(DONE);
    let expected = format!("powercrust {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(String::from_utf8(version.stdout).unwrap(), expected);
}

#[test]
fn readme_and_help_agree() {
    let readme = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md"));
    let readme = readme.unwrap();
    let help = Place::new().run("--help").code(DONE).stdout;
    let help = String::from_utf8(help).unwrap();
    let mut options = 0;
    for line in help
        .lines()
        .filter(|line| line.trim_start().starts_with('-'))
    {
        let words = line.split([' ', ',']).filter(|word| word.starts_with("--"));
        for word in words.map(|word| word.trim_end_matches('.')) {
            assert!(readme.contains(word), "README.md does not mention {word}");
            options += 1;
        }
    }
    assert!(options > 20, "{options}");
    // The defaults stated are those of the library.
    let plain = powercrust::Options::default();
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    for default in [
        format!("by default {}", plain.merge),
        format!("by default {}", plain.flatness),
        format!("by default {}", plain.box_factor),
        format!("default {:.2}", plain.deep_angle),
    ] {
        assert!(words(&help).contains(&default), "--help: {default}");
        assert!(readme.contains(&default), "README.md: {default}");
    }
}

#[test]
fn man_page_and_completions() {
    let place = Place::new();
    for (what, part) in [
        ("man", ".TH powercrust"),
        ("complete-bash", "--lambda"),
        ("complete-zsh", "#compdef powercrust"),
        ("complete-fish", "complete -c powercrust"),
    ] {
        let ran = place.run(&format!("--generate {what}")).code(DONE);
        let text = String::from_utf8(ran.stdout).unwrap();
        assert!(text.contains(part), "{what}: no {part}");
    }
}

// ---------------------------------------------------------------- offset

#[test]
fn several_offsets_of_one_run() {
    let place = Place::with_torus();
    place
        .run("offset torus.xyz --distance 0.1,-5% -o part_{d}.ply")
        .code(DONE)
        .says("part_0.1.ply: at 0.1")
        .says("part_-5%.ply");
    assert_eq!(place.names(), ["part_-5%.ply", "part_0.1.ply", "torus.xyz"]);
    for name in ["part_0.1.ply", "part_-5%.ply"] {
        place.run(&format!("check {name}")).code(DONE);
    }
    let ran = place
        .run("offset torus.xyz --distance=-0.1 -o in.obj --json -q")
        .code(DONE);
    let told: serde_json::Value = serde_json::from_slice(&ran.stdout).unwrap();
    assert_eq!(told["offsets"][0]["genus"], 1);
    assert_eq!(told["offsets"][0]["file"], "in.obj");
    assert_eq!(told["offsets"][0]["fitted"], true);
    let volume = |of: &serde_json::Value| of["volume"].as_f64().unwrap();
    assert!(volume(&told["offsets"][0]) < 0.8 * volume(&told["crust"]));
}

#[test]
fn a_shell_by_the_command() {
    let place = Place::with_torus();
    place
        .run("offset torus.xyz --shell 5% -o hollow.stl")
        .code(DONE)
        .says("1 cavity");
    place.run("check hollow.stl").code(DONE);
}

#[test]
fn offsets_that_cannot_be_are_refused() {
    let place = Place::with_torus();
    let before = place.names();
    for (arguments, code, says) in [
        ("-o a.ply", USAGE, "no distance given"),
        ("--distance 1,2 -o a.ply", USAGE, "{d}"),
        ("--distance 1,1 -o a{d}.ply", USAGE, "two results"),
        (
            "--distance 1 -o torus.xyz --output-format ply",
            USAGE,
            "overwritten",
        ),
        ("--distance one -o a.ply", USAGE, "expected a length"),
        ("--distance 1 --shell=-1 -o a.ply", USAGE, "above 0"),
        ("--distance 1 --tolerance 0 -o a.ply", USAGE, "above 0"),
        ("--distance 0.1,-5 -o a{d}.ply", UNFIT, "nothing is left"),
        (
            "--distance 0.1 --shell 5 -o a.ply",
            UNFIT,
            "thinner --shell",
        ),
        ("--distance 1e9 -o a.ply", UNFIT, "--box-factor"),
        ("--distance 0.1 -o - --json", USAGE, "standard output"),
    ] {
        place
            .run(&format!("offset torus.xyz {arguments}"))
            .code(code)
            .says(says);
        assert_eq!(place.names(), before, "{arguments}");
    }
}
