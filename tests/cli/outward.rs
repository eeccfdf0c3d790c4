//! Normals, `--sensor` and the viewpoint of PCD files.

use super::*;

/// The torus as a scanner above it sees it, about: points that look upwards.
fn from_above(place: &Place) -> Vec<[f64; 3]> {
    let text = String::from_utf8(place.get("torus.xyz")).unwrap();
    let points = text.lines().map(|line| {
        let mut words = line.split_whitespace().map(|w| w.parse().unwrap());
        [0; 3].map(|_| words.next().unwrap())
    });
    points.filter(|p: &[f64; 3]| p[2] > 0.05).collect()
}

fn text(points: &[[f64; 3]]) -> String {
    let lines = points.iter().map(|[x, y, z]| format!("{x} {y} {z}\n"));
    lines.collect()
}

#[test]
fn a_scanner_is_believed_where_it_can_be() {
    let place = Place::with_torus();
    place.put("above.xyz", text(&from_above(&place)));
    place
        .run("above.xyz -o a.ply --sensor 0,0,50 -v --stats s.json")
        .code(DONE)
        .says(" % of the way to --sensor at ")
        .says(" agree with the surface found without: taken as evidence");
    let stats = String::from_utf8(place.get("s.json")).unwrap();
    assert!(stats.contains("\"believed\": true"), "{stats}");
    // From above one sees no more than half of it: that is worth a line.
    place
        .run("torus.xyz -o b.ply --sensor 0,0,50")
        .code(DONE)
        .says("left alone");
    place.run("torus.xyz -o c.ply").code(DONE);
    assert_eq!(place.get("b.ply"), place.get("c.ply"));
    for wrong in ["0,0", "0,0,x", "1,2,3,4", "0,0,inf"] {
        place
            .run(&format!("torus.xyz -o d.ply --sensor {wrong}"))
            .code(USAGE)
            .says("expected three numbers between commas, such as 0,0,1.5");
    }
}

#[test]
fn normals_in_the_input_are_asked_unless_ignored() {
    let place = Place::with_torus();
    let text = String::from_utf8(place.get("torus.xyz")).unwrap();
    let mut with = String::new();
    for line in text.lines() {
        let p: Vec<f64> = line
            .split_whitespace()
            .map(|w| w.parse().unwrap())
            .collect();
        let around = p[0].hypot(p[1]);
        let way = [p[0] - p[0] / around, p[1] - p[1] / around, p[2]].map(|c| c / 0.4);
        with += &format!("{line} {} {} {}\n", way[0], way[1], way[2]);
    }
    place.put("with.xyz", with);
    place
        .run("with.xyz -o a.ply -v")
        .code(DONE)
        .says("of the normals at ")
        .says("taken as evidence");
    let ran = place
        .run("with.xyz -o b.ply --normals ignore -v")
        .code(DONE);
    assert!(!ran.stderr.contains("of the normals"), "{}", ran.stderr);
}

#[test]
fn the_viewpoint_of_a_file_is_a_scanner() {
    let place = Place::with_torus();
    let points = from_above(&place);
    let count = points.len();
    let header = format!(
        "VERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {count}\n\
         HEIGHT 1\nVIEWPOINT 0 0 50 1 0 0 0\nPOINTS {count}\nDATA ascii\n"
    );
    place.put("above.pcd", header + &text(&points));
    place
        .run("above.pcd -o a.ply -v")
        .code(DONE)
        .says("of the way to the viewpoint at ")
        .says("taken as evidence");
    let ran = place
        .run("above.pcd -o b.ply --normals ignore -v")
        .code(DONE);
    assert!(!ran.stderr.contains("viewpoint"), "{}", ran.stderr);
}
