//! `--sharp`, plain and `auto`.

use super::*;

/// `--sharp` takes a value or none, apart or joined, and never the input.
#[test]
fn sharp_takes_a_value_or_none() {
    let place = Place::with_torus();
    let options = |sharp: &str| format!("\"sharp\":\"{sharp}\"");
    for (flags, sharp) in [
        ("--sharp torus.xyz", "skinny"),
        ("torus.xyz --sharp", "skinny"),
        ("--sharp skinny torus.xyz", "skinny"),
        ("--sharp auto torus.xyz", "auto"),
        ("--sharp=auto torus.xyz", "auto"),
        ("torus.xyz", "off"),
    ] {
        let ran = place.run(&format!("-o crust.ply -v {flags}")).code(DONE);
        let ran = ran.says(&options(sharp));
        let told = ran
            .stderr
            .contains("--sharp auto: 0 samples at edges, 0 at corners");
        assert_eq!(told, sharp == "auto", "{}", ran.stderr);
    }
    place
        .run("offset torus.xyz --distance 0.1 -o shell.ply --sharp auto")
        .code(DONE);
}

/// How many samples lie at edges is told, and the poles these had are listed.
#[test]
fn samples_at_edges_are_told() {
    let place = Place::new();
    let mut cube = String::new();
    for k in 0..6 * 144 {
        let (side, i, j) = (k / 144, k % 144 / 12, k % 12);
        let at = [
            f64::from(i) + 0.5,
            f64::from(j) + 0.5,
            f64::from(side % 2) * 12.0,
        ];
        let axis = side as usize / 2;
        let p = [0, 1, 2].map(|c| at[(c + axis) % 3]);
        cube += &format!("{} {} {}\n", p[0], p[1], p[2]);
    }
    place.put("cube.xyz", cube);
    let flags = "--sharp auto --stats s.json --report-poles poles.ply --ascii -v";
    let ran = place
        .run(&format!("cube.xyz -o crust.ply {flags}"))
        .code(DONE);
    let stats: serde_json::Value = serde_json::from_slice(&place.get("s.json")).unwrap();
    let found = &stats["stats"]["corners"];
    let (edges, corners) = (
        found["edges"].as_u64().unwrap(),
        found["corners"].as_u64().unwrap(),
    );
    assert!(edges > 100 && corners > 0, "{found}");
    ran.says(&format!(
        "--sharp auto: {edges} samples at edges, {corners} at corners"
    ));
    let poles = String::from_utf8(place.get("poles.ply")).unwrap();
    let mut samples = std::collections::BTreeSet::new();
    for row in poles.split("end_header\n").nth(1).unwrap().lines() {
        let row: Vec<&str> = row.split(' ').collect();
        assert_eq!(row[6..], ["0", "2"], "{row:?}");
        samples.insert(row[3].to_owned());
    }
    assert_eq!(samples.len() as u64, edges + corners);
}
