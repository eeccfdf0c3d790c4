//! `powercrust simplify-mat`.

use super::*;

/// No surface is made where nothing asks about it; the axis is the same.
#[test]
fn an_axis_alone() {
    let place = Place::with_torus();
    let ran = place.run("torus.xyz --mat alone.ma --outer-mat out.obj --report-poles p.ply");
    ran.code(DONE)
        .says("alone.ma: 600 samples, ")
        .says("inner balls, ")
        .says("outer balls, ")
        .says("no surface made, ");
    place.run("torus.xyz --mat with.ma -o c.ply").code(DONE);
    assert_eq!(place.get("alone.ma"), place.get("with.ma"));
    let ran = place.run("torus.xyz --mat with.ma --json");
    let told = ran.code(DONE).json();
    assert_eq!(told["mesh"]["genus"], 1);
    let ran = place.run("torus.xyz --poles poles.ply --verify");
    ran.code(DONE).says("genus 1");
    // What shapes the surface would do nothing.
    for flag in ["--keep largest", "--holes open", "--reduce 4", "--polygons"] {
        place
            .run(&format!("torus.xyz --mat a.ma {flag}"))
            .fails(USAGE, "would have no effect: it applies to the surface");
    }
    place.put("few.xyz", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
    let before = place.names();
    place.run("few.xyz --mat few.ma").fails(UNFIT, "few.xyz: ");
    assert_eq!(place.names(), before);
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
