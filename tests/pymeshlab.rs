//! Against the peer that users know: screened Poisson in MeshLab, on the same
//! noise-free samples, with normals that it estimates itself.
//!
//! Needs a Python with pymeshlab, named by `POWERCRUST_PYTHON`; without it the
//! test says that it was skipped. `cargo test --test pymeshlab -- --nocapture`
//! prints the comparison.

mod common;

use common::judge::{deviation, topology};
use common::random::Random;
use common::shapes::{self, Ellipsoid, Shape};
use common::{crust, full};
use powercrust::{Options, Point, PolygonMesh};
use serde_json::Value;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

struct Case {
    name: &'static str,
    shape: &'static dyn Shape,
    edges: bool,
}

/// The first four are the quick set.
const CASES: [Case; 6] = [
    Case {
        name: "cube",
        shape: &shapes::CUBE,
        edges: true,
    },
    Case {
        name: "block",
        shape: &shapes::CAD_BLOCK,
        edges: true,
    },
    Case {
        name: "sphere",
        shape: &shapes::UNIT_SPHERE,
        edges: false,
    },
    Case {
        name: "torus",
        shape: &shapes::TORUS,
        edges: false,
    },
    Case {
        name: "cylinder",
        shape: &shapes::CYLINDER,
        edges: true,
    },
    Case {
        name: "ellipsoid",
        shape: &Ellipsoid([1.0, 2.0, 3.0]),
        edges: false,
    },
];

/// The Python to use, or why there is none.
fn python() -> Result<OsString, String> {
    let python = std::env::var_os("POWERCRUST_PYTHON").ok_or("POWERCRUST_PYTHON is not set")?;
    let probe = Command::new(&python)
        .args(["-c", "import numpy, pymeshlab"])
        .output();
    match probe {
        Ok(output) if output.status.success() => Ok(python),
        Ok(_) => Err(format!("{} lacks numpy or pymeshlab", python.display())),
        Err(error) => Err(format!("{}: {error}", python.display())),
    }
}

#[test]
fn nearer_than_poisson_at_edges_and_near_it_elsewhere() {
    let python = match python() {
        Ok(python) => python,
        Err(reason) => {
            eprintln!("skipped the comparison with pymeshlab: {reason}");
            return;
        }
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let count = 10_000;
    let cases = if full() { &CASES[..] } else { &CASES[..4] };
    let crusts: Vec<PolygonMesh> = cases
        .iter()
        .map(|case| prepare(case, count, folder.path()))
        .collect();
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scripts/compare_pymeshlab.py");
    let output = Command::new(python)
        .arg(script)
        .arg(folder.path())
        .args(cases.iter().map(|case| case.name))
        .output()
        .expect("Python starts");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8_lossy(&output.stdout);
    let found: Value = text
        .lines()
        .last()
        .and_then(|line| serde_json::from_str(line).ok())
        .unwrap_or_else(|| panic!("no JSON: {text}"));
    println!("{count} samples; truth and edges to the mesh, and back: mean / max");
    println!("| case | mesh | truth | edges | back | crossing |");
    println!("| --- | --- | --- | --- | --- | --- |");
    for (case, crust) in cases.iter().zip(&crusts) {
        let poisson = read_mesh(folder.path(), &format!("{}.poisson", case.name));
        judge(case, &found[case.name], crust, &poisson);
    }
}

/// Reconstructs one case and writes what the script wants.
fn prepare(case: &Case, count: usize, folder: &Path) -> PolygonMesh {
    let samples = case.shape.samples(count, 31);
    let truth = case.shape.samples(10_000, 32);
    let mut random = Random::new(33);
    let edges: Vec<Point> = (0..2_000)
        .filter_map(|_| case.shape.edge_point(&mut random))
        .collect();
    assert_eq!(edges.is_empty(), !case.edges, "{}", case.name);
    let mesh = crust(case.name, &samples, &Options::default()).crust.mesh;
    assert!(topology(&mesh).sound(), "{}", case.name);
    let write = |part: &str, bytes: Vec<u8>| {
        std::fs::write(folder.join(format!("{}.{part}", case.name)), bytes).expect("it writes");
    };
    let raw = |points: &[Point]| -> Vec<u8> {
        let numbers = points.as_flattened().iter();
        numbers.flat_map(|x| x.to_le_bytes()).collect()
    };
    write("samples.f64", raw(&samples));
    write("truth.f64", raw(&truth));
    write("edges.f64", raw(&edges));
    write("crust.vertices.f64", raw(&mesh.vertices));
    let corners = mesh.corners.iter().flat_map(|c| c.to_le_bytes());
    write("crust.triangles.u32", corners.collect());
    mesh
}

/// Reads the triangles that the script left.
fn read_mesh(folder: &Path, name: &str) -> PolygonMesh {
    let read = |part: &str| std::fs::read(folder.join(format!("{name}.{part}"))).expect(name);
    let numbers: Vec<f64> = read("vertices.f64")
        .chunks_exact(8)
        .map(|bytes| f64::from_le_bytes(bytes.try_into().expect("eight bytes")))
        .collect();
    let vertices = numbers.chunks_exact(3).map(|p| [p[0], p[1], p[2]]);
    let mut mesh = PolygonMesh::with_vertices(vertices.collect());
    let corners: Vec<u32> = read("triangles.u32")
        .chunks_exact(4)
        .map(|bytes| u32::from_le_bytes(bytes.try_into().expect("four bytes")))
        .collect();
    corners.chunks_exact(3).for_each(|t| mesh.push_face(t));
    mesh
}

fn judge(case: &Case, found: &Value, crust: &PolygonMesh, poisson: &PolygonMesh) {
    let name = case.name;
    let number = |mesh: &str, cloud: &str, what: &str| found[mesh][cloud][what].as_f64();
    let show = |mesh: &str, cloud: &str| match number(mesh, cloud, "mean") {
        Some(mean) => format!(
            "{mean:.5} / {:.4}",
            number(mesh, cloud, "max").unwrap_or(-1.0)
        ),
        None => "-".to_owned(),
    };
    let back = [crust, poisson].map(|mesh| deviation(mesh, case.shape));
    for (mesh, back) in ["crust", "poisson"].into_iter().zip(back) {
        println!(
            "| {name} | {mesh} | {} | {} | {:.5} / {:.4} | {} |",
            show(mesh, "truth"),
            show(mesh, "edges"),
            back.mean,
            back.max,
            found[mesh]["crossing"],
        );
    }
    let get = |mesh: &str, cloud: &str, what: &str| {
        number(mesh, cloud, what).unwrap_or_else(|| panic!("{name}: no {what} of {cloud}"))
    };
    // Merging may move the crust by a share of its error; beside an edge a
    // sample may be buried as deep as the edge is blunt, but few are.
    let [off, off_mean] = ["max", "mean"].map(|what| get("crust", "samples", what));
    let share = if case.edges {
        1.0
    } else {
        Options::default().merge
    };
    assert!(off <= share * back[0].max, "{name}: a sample is {off} off");
    assert!(
        off_mean <= 0.5 * share * back[0].mean,
        "{name}: samples are {off_mean} off on average"
    );

    let truth = |mesh| get(mesh, "truth", "mean");
    let (ours, theirs) = (truth("crust"), truth("poisson"));
    // A smooth fit may beat flat facets where all is smooth.
    let factor = if case.edges { 1.0 } else { 2.0 };
    assert!(
        ours < factor * theirs,
        "{name}: mean {ours}, Poisson {theirs}"
    );
    assert!(
        back[0].mean < factor * back[1].mean,
        "{name}: mean back {}, Poisson {}",
        back[0].mean,
        back[1].mean
    );
    if case.edges {
        let at_edges = |mesh| get(mesh, "edges", "mean");
        let (ours, theirs) = (at_edges("crust"), at_edges("poisson"));
        assert!(ours < theirs, "{name}: edges {ours}, Poisson {theirs}");
    }
}
