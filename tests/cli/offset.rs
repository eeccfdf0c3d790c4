//! `powercrust offset`.

use super::*;

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
