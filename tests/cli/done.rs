//! What works: exit code 0.

use super::*;

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
        .says("\"lambda\":{\"value\":0.4}");
    place
        .run("torus.xyz -o crust.ply --sharp --lambda 0.7 -vv")
        .code(DONE)
        .says("\"lambda\":{\"value\":0.7}")
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

/// Two strays far from a torus: left out, said and listed; kept on request.
#[test]
fn outliers_are_reported() {
    let place = Place::new();
    let stray = "9 9 0.25\n-9 0 3\n";
    place.put("wild.xyz", [torus(600), stray.into()].concat());
    let ran =
        place.run("wild.xyz -o crust.ply --report-outliers strays.ply --ascii --stats s.json");
    ran.code(DONE).says("2 samples left out as outliers");
    let strays = String::from_utf8(place.get("strays.ply")).unwrap();
    assert!(strays.contains("element vertex 2"), "{strays}");
    assert!(
        strays.contains("\n9 9 0.25 600 0\n-9 0 3 601 0\n"),
        "{strays}"
    );
    let stats: serde_json::Value = serde_json::from_slice(&place.get("s.json")).unwrap();
    assert_eq!(stats["stats"]["outliers"]["left_out"], 2);
    assert_eq!(stats["stats"]["outliers"]["groups"], 2);
    assert_eq!(stats["mesh"]["components"], 1);

    place
        .run("wild.xyz -o crust.ply --outliers keep --stats s.json")
        .code(DONE);
    let stats: serde_json::Value = serde_json::from_slice(&place.get("s.json")).unwrap();
    assert_eq!(stats["stats"]["outliers"]["left_out"], 0);
    place
        .run("wild.xyz -o crust.ply --outliers all")
        .code(USAGE);
    place
        .run("wild.xyz -o crust.ply --report-outliers strays.xyz")
        .fails(USAGE, "strays.xyz: .xyz is no outliers format");
}

/// The poles dropped are listed with their samples and bounds.
#[test]
fn dropped_poles_are_reported() {
    let place = Place::new();
    place.put("torus.xyz", torus(600));
    let flags = "--lambda 0.3 --label greedy --report-poles poles.ply --ascii --stats s.json -v";
    let ran = place.run(&format!("torus.xyz -o crust.ply {flags}"));
    ran.code(DONE).says("--lambda 0.3: ").says(" dropped");
    let stats: serde_json::Value = serde_json::from_slice(&place.get("s.json")).unwrap();
    let dropped = stats["stats"]["poles_dropped"].as_u64().unwrap();
    assert!(dropped > 0);
    assert_eq!(stats["stats"]["options"]["label"], "greedy");
    assert_eq!(stats["stats"]["flips"], 0);
    let poles = String::from_utf8(place.get("poles.ply")).unwrap();
    assert!(
        poles.contains(&format!("element vertex {dropped}\n")),
        "{poles}"
    );
    let rows = poles.split("end_header\n").nth(1).unwrap().lines();
    let mut count = 0;
    for row in rows {
        let row: Vec<f64> = row.split(' ').map(|w| w.parse().unwrap()).collect();
        let [_, _, _, point, pole, radius, bound, reason] = row[..] else {
            panic!("{row:?}");
        };
        assert!(point < 600.0 && (pole == 1.0 || pole == 2.0));
        assert!(radius < bound && reason == 0.0);
        count += 1;
    }
    assert_eq!(count, dropped);

    // Without noise none is dropped, and the file says so.
    let ran = place.run("torus.xyz -o crust.ply --report-poles poles.ply --ascii -v");
    ran.code(DONE).says("every pole kept");
    let poles = String::from_utf8(place.get("poles.ply")).unwrap();
    assert!(poles.contains("element vertex 0\n"), "{poles}");
    let ran = place.run("torus.xyz -o crust.ply --report-poles poles.xyz");
    ran.fails(USAGE, "poles.xyz: .xyz is no poles format");
    place.run("torus.xyz -o crust.ply --label some").code(USAGE);
}
