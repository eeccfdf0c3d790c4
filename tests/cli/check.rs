//! `powercrust check`.

use super::*;

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
