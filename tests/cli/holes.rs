//! Places where nothing was sampled: bridged, marked, left open.

use super::*;

/// A unit sphere up to the height 0.8; `rim` samples lie on its edge.
fn cup(count: usize, rim: usize) -> String {
    let line = |z: f64, a: f64| {
        let r = (1.0 - z * z).sqrt();
        format!("{} {} {}\n", r * a.cos(), r * a.sin(), z)
    };
    let spiral = |k: usize| {
        let z = -1.0 + 1.8 * (k as f64 + 0.5) / count as f64;
        line(z, k as f64 * 2.399_963_229_728_653)
    };
    let round = |k: usize| line(0.8, std::f64::consts::TAU * k as f64 / rim as f64);
    (0..count).map(spiral).chain((0..rim).map(round)).collect()
}

fn near(found: &serde_json::Value, truth: f64, share: f64) {
    let found = found.as_f64().unwrap();
    assert!((found / truth - 1.0).abs() < share, "{found}, not {truth}");
}

#[test]
fn a_hole_is_bridged_and_said() {
    let place = Place::new();
    place.put("cup.xyz", cup(2000, 60));
    let ran = place.run("cup.xyz -o cup.ply --verify --json").code(DONE);
    ran.says("1 hole bridged (").says("--holes open");
    let ran = place.run("cup.xyz -o cup.ply --json").code(DONE);
    let told = ran.json();
    assert_eq!(told["mesh"]["closed"], true);
    assert_eq!(told["holes"]["how"], "keep");
    assert_eq!(told["holes"]["surrounded"], true);
    near(&told["holes"]["share"], 0.1, 0.15);
    near(&told["holes"]["patches"][0]["width"], 1.2, 0.1);
    assert!(told["holes"].get("loops").is_none());
    // Marked without being asked for.
    let head = place.get("cup.ply");
    let head = String::from_utf8_lossy(&head[..1000]).into_owned();
    assert!(head.contains("property uchar hole\n"), "{head}");
    // A gap of 1.2 is none for those who look for wider ones.
    let ran = place
        .run("cup.xyz -o cup.ply --hole-size 1.5 --json")
        .code(DONE);
    assert_eq!(ran.json()["holes"]["patches"], serde_json::json!([]));
    assert!(!ran.stderr.contains("bridged"), "{}", ran.stderr);
}

#[test]
fn a_hole_is_left_open() {
    let place = Place::new();
    place.put("cup.xyz", cup(2000, 60));
    for name in ["cup.ply", "cup.stl", "cup.obj", "cup.glb", "cup.json"] {
        place
            .run(&format!("cup.xyz -o {name} --holes open --verify"))
            .code(DONE)
            .says("1 hole left open (")
            .says("1 border loop")
            .says("verified");
    }
    for name in ["cup.ply", "cup.stl", "cup.obj", "cup.json"] {
        place.run(&format!("check {name} --border -q")).code(DONE);
        let ran = place.run(&format!("check {name}")).code(UNFIT);
        let text = String::from_utf8(ran.stdout).unwrap();
        assert!(text.contains("1 border loop"), "{text}");
        assert!(text.contains("--border allows open edges"), "{text}");
    }
    let ran = place.run("check cup.ply --border").code(DONE);
    let text = String::from_utf8(ran.stdout).unwrap();
    assert!(text.contains("sound with a border"), "{text}");
    let ran = place
        .run("cup.xyz -o cup.ply --holes open --json -v")
        .code(DONE)
        .says("border loop 0 of hole 0: length 3.7");
    let told = ran.json();
    assert_eq!(told["mesh"]["closed"], false);
    assert_eq!(told["mesh"]["manifold"], true);
    assert_eq!(told["mesh"]["components"], 1);
    assert_eq!(told["mesh"]["volume"], serde_json::Value::Null);
    let border = &told["holes"]["loops"][0];
    near(&border["length"], std::f64::consts::TAU * 0.6, 0.03);
    near(&border["opening"], std::f64::consts::PI * 0.36, 0.03);
    near(&border["area"], std::f64::consts::PI * 0.4, 0.15);
}

#[test]
fn a_hole_is_filled() {
    let place = Place::new();
    place.put("cup.xyz", cup(2000, 60));
    for options in [
        "-o a.ply",
        "-o a.stl",
        "-o a.ply --f32",
        "-o a.ply --faces 500",
        "-o a.ply --attributes all",
    ] {
        let ran = place
            .run(&format!("cup.xyz {options} --holes fill --verify"))
            .code(DONE);
        ran.says("1 hole filled (").says("verified");
    }
    // Across a wavy rim the crust bulges.
    let wavy = cup(2000, 0);
    let wavy = wavy.lines().filter(|line| {
        let p: Vec<f64> = line.split(' ').map(|w| w.parse().unwrap()).collect();
        p[2] < 0.5 + 0.2 * (2.0 * p[1].atan2(p[0])).cos()
    });
    let wavy: String = wavy.map(|line| format!("{line}\n")).collect();
    place.put("cup.xyz", wavy);
    let told = |how: &str| {
        let ran = place.run(&format!("cup.xyz -o b.ply --holes {how} --json -v"));
        let ran = ran.code(DONE);
        if how == "fill" {
            return ran.says("hole 0 filled: 100 % of the way").json();
        }
        ran.json()
    };
    let (keep, fill) = (told("keep"), told("fill"));
    assert_eq!(fill["mesh"]["closed"], true);
    assert_eq!(fill["holes"]["filled"], serde_json::json!([1.0]));
    // Taut faces have less area.
    let area = |told: &serde_json::Value| told["mesh"]["area"].as_f64().unwrap();
    assert!(
        area(&fill) < area(&keep) - 1e-4,
        "{} {}",
        area(&fill),
        area(&keep)
    );
    place
        .run("cup.xyz -o c.ply --holes fill --polygons")
        .fails(USAGE, "--polygons");
    // Nothing to fill: as ever.
    let place = Place::with_torus();
    place.run("torus.xyz -o a.ply --holes fill").code(DONE);
    place.run("torus.xyz -o b.ply").code(DONE);
    assert_eq!(place.get("a.ply"), place.get("b.ply"));
}

#[test]
fn open_meshes_take_the_other_options() {
    let place = Place::new();
    place.put("cup.xyz", cup(1500, 50));
    for options in [
        "--polygons",
        "--f32",
        "--faces 500",
        "--keep largest",
        "--attributes all",
        "--mat axis.ma --poles poles.ply --stats stats.json",
    ] {
        place
            .run(&format!(
                "cup.xyz -o cup.ply --holes open --verify {options}"
            ))
            .code(DONE)
            .says("1 border loop");
        place.run("check cup.ply --border -q").code(DONE);
    }
    place
        .run("cup.xyz -o thin.ply --holes open --hole-size 10x --threads 1")
        .code(DONE);
    place
        .run("cup.xyz -o more.ply --holes open --hole-size 10x --threads 3")
        .code(DONE);
    assert_eq!(place.get("thin.ply"), place.get("more.ply"));
}

#[test]
fn sheets_are_said_to_be_sheets() {
    let place = Place::new();
    let square = |k: usize| {
        let (x, y) = ((k % 40) as f64 / 40.0, (k / 40) as f64 / 40.0);
        format!("{x} {y} {}\n", 0.4 * (x * x + y * y))
    };
    place.put("sheet.xyz", (0..1600).map(square).collect::<String>());
    place
        .run("sheet.xyz -o sheet.ply")
        .code(DONE)
        .says("the samples do not surround a solid: ");
    place
        .run("sheet.xyz -o sheet.ply --holes open --verify")
        .code(DONE)
        .says("border loop");
    place.run("check sheet.ply --border -q").code(DONE);
}

#[test]
fn hole_sizes_that_make_no_sense() {
    let place = Place::with_torus();
    for size in ["0", "-1", "2x", "wide", "0%"] {
        place
            .run(&format!("torus.xyz -o t.ply --hole-size {size}"))
            .fails(USAGE, "--hole-size");
    }
    place
        .run("torus.xyz -o t.ply --holes shut")
        .fails(USAGE, "--holes");
    // A torus has none: it stays closed.
    place
        .run("torus.xyz -o t.ply --holes open")
        .code(DONE)
        .says("0 holes left open");
    place.run("check t.ply -q").code(DONE);
}
