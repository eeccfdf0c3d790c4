//! `powercrust from-mat`.

use super::*;

#[test]
fn an_axis_becomes_a_surface_again() {
    let place = Place::with_torus();
    place
        .run("torus.xyz -o crust.ply --mat axis.ma --poles poles.ply")
        .code(DONE);
    for input in ["axis.ma", "poles.ply"] {
        place
            .run(&format!(
                "from-mat {input} -o again.ply --compare crust.ply"
            ))
            .code(DONE)
            .says("again.ply: ")
            .says("genus 1")
            .says("apart");
        place.run("check again.ply").code(DONE);
    }
    // Inner balls alone, as other programs write them.
    place
        .run("simplify-mat axis.ma --eps 2% -o bare.ma --bare")
        .code(DONE);
    let ran = place.run("from-mat bare.ma -o a.ply --ascii --attributes all --json -q");
    let told = ran.code(DONE).json();
    assert_eq!(told["mesh"]["genus"], 1);
    assert_eq!(told["betti"], told["union_betti"]);
    assert!(told["outer_balls_made"].as_u64().unwrap() > 10);
    let text = String::from_utf8(place.get("a.ply")).unwrap();
    assert!(text.contains("property double thickness") && text.contains("property double gap"));
    let ran = place.run("from-mat bare.ma --union --tolerance 0.5% -o u.stl --stats s.json -v");
    ran.code(DONE).says("outer balls made from the complement");
    place.run("check u.stl").code(DONE);
    let told: serde_json::Value = serde_json::from_slice(&place.get("s.json")).unwrap();
    assert_eq!(told["options"]["union"], true);
    assert_eq!(told["mesh"]["unfitted_balls"], 0);
    let off = told["mesh"]["largest_distance_from_union"]
        .as_f64()
        .unwrap();
    assert!(off < 2.0 * told["tolerance"].as_f64().unwrap(), "{off}");
    let stream = place.feed("from-mat - -o - --output-format obj", &place.get("bare.ma"));
    let text = String::from_utf8(stream.code(DONE).stdout).unwrap();
    assert!(text.contains("\nf "));
}

#[test]
fn balls_that_bound_nothing_are_refused() {
    let place = Place::with_torus();
    place.put("a.ma", "2 1 0\nv 0 0 0 1\nv 1 0 0 1\ne 0 1\n");
    place.put("outer.ma", "2 0 0\nv 0 0 0 1\nv 1 0 0 1\nside outer\n");
    place.put(
        "points.ply",
        "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n",
    );
    let before = place.names();
    for (arguments, code, says) in [
        ("a.ma", USAGE, "nowhere to write"),
        ("a.ma -o a.ma", USAGE, "for a medial axis"),
        ("a.ma -o a.ma --output-format ply", USAGE, "overwritten"),
        ("a.ma -o b.ply --tolerance 0", USAGE, "above 0"),
        ("a.ma -o b.ply --attributes hole", USAGE, "not known here"),
        ("a.ma -o b.stl --attributes gap", USAGE, "cannot hold it"),
        ("a.ma -o b.ply --precision 5", USAGE, "would have no effect"),
        ("a.ma -o b.obj --f32", USAGE, "would have no effect"),
        ("a.ma -o - --json", USAGE, "more than one result"),
        ("a.ma -o b.ply --compare gone.ply", FILE, "gone.ply"),
        ("a.ma -o b.ply --compare torus.xyz", FILE, "torus.xyz"),
        ("gone.ma -o b.ply", FILE, "gone.ma: cannot read"),
        ("torus.xyz -o b.ply", FILE, "holds no balls"),
        ("outer.ma -o b.ply", UNFIT, "no inner ball"),
    ] {
        let ran = place.run(&format!("from-mat {arguments}")).code(code);
        ran.says(says);
        assert_eq!(place.names(), before, "{arguments}");
    }
}
