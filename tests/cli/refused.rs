//! What is refused: exit codes 1, 2 and 3.

use super::*;

#[test]
fn no_argument_shows_help() {
    Place::new().run("").code(USAGE).says("Usage: powercrust");
}

#[test]
fn a_wrong_value_of_sharp_is_called_wrong() {
    let place = Place::with_torus();
    for flags in ["--sharp=soft torus.xyz", "--sharp soft torus.xyz"] {
        place
            .run(&format!("{flags} -o crust.ply"))
            .fails(USAGE, "invalid value 'soft' for '--sharp")
            .says("skinny, auto");
    }
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
        ("--lambda nan", "expected auto, off or a number in (0, 1]"),
        ("--lambda inf", "expected auto, off or a number in (0, 1]"),
        ("--lambda x", "expected auto, off or a number in (0, 1]"),
        ("--deep-angle 90", "--deep-angle is 90"),
        ("--deep-angle 180", "--deep-angle is 180"),
        ("--box-factor 1.4", "--box-factor is 1.4"),
        ("--merge -1e-9", "--merge is -1e-9"),
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
fn noise_wider_than_the_cloud() {
    Place::with_torus()
        .run("torus.xyz -o a.ply --noise 1e300")
        .fails(
            USAGE,
            "--noise is 1e300: expected less than half the largest side",
        );
}

#[test]
fn two_results_in_one_place() {
    let place = Place::with_torus();
    place
        .run("torus.xyz -o a.ply --mat ./a.ply")
        .fails(USAGE, "two results");
    place
        .run("torus.xyz -o a.ply --report-poles ./a.ply")
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
