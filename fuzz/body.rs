//! What every fuzz target does with its bytes. `tests/fuzz_corpus.rs` includes
//! this file too and runs it on the files that are kept.

use powercrust::io::{
    read_axis, read_balls, read_cloud, read_mesh, write_mesh, AxisFormat, CloudFormat,
    MeshAttributes, MeshFormat, ReadOptions, WriteOptions,
};
use powercrust::mesh::{check, CheckOptions, PolygonMesh};
use powercrust::{reconstruct, Context, Error, Faces, LambdaOption, Options, Point, SharpOption};

/// Names of the targets; seeds lie in folders of these names.
#[allow(dead_code)]
pub const TARGETS: [&str; 11] = [
    "cloud_ply",
    "cloud_obj",
    "cloud_off",
    "cloud_text",
    "cloud_stl",
    "cloud_npy",
    "cloud_pcd",
    "cloud_las",
    "mesh",
    "axis",
    "pipeline",
];

/// Runs a target. Panics where a promise is broken.
pub fn run(target: &str, bytes: &[u8]) {
    match target {
        "cloud_ply" => cloud(bytes, CloudFormat::Ply),
        "cloud_obj" => cloud(bytes, CloudFormat::Obj),
        "cloud_off" => cloud(bytes, CloudFormat::Off),
        "cloud_text" => cloud(bytes, CloudFormat::Text),
        "cloud_stl" => cloud(bytes, CloudFormat::Stl),
        "cloud_npy" => cloud(bytes, CloudFormat::Npy),
        "cloud_pcd" => cloud(bytes, CloudFormat::Pcd),
        "cloud_las" => cloud(bytes, CloudFormat::Las),
        "mesh" => meshes(bytes),
        "axis" => axes(bytes),
        "pipeline" => pipeline(bytes),
        other => panic!("no fuzz target is called {other}"),
    }
}

/// Points are finite and all columns as long as they are; or an error says why
/// not.
fn cloud(bytes: &[u8], format: CloudFormat) {
    CloudFormat::sniff(bytes);
    let mut counts = Vec::new();
    for skip_invalid in [false, true] {
        let options = ReadOptions { skip_invalid };
        match read_cloud(bytes, format, &options) {
            Ok(cloud) => {
                let n = cloud.points.len();
                assert!(n > 0);
                assert!(cloud.points.iter().flatten().all(|c| c.is_finite()));
                assert!(cloud.normals.is_none_or(|v| v.len() == n));
                assert!(cloud.colours.is_none_or(|v| v.len() == n));
                assert!(cloud.scalars.iter().all(|s| s.values.len() == n));
                counts.push(n);
            }
            Err(error) => {
                assert!(!error.to_string().is_empty());
                // What is read without leave to skip is read with it.
                assert!(counts.is_empty(), "skipping fails: {error}");
            }
        }
    }
    assert!(counts.len() < 2 || counts[0] == counts[1]);
}

/// Indices are in range; small meshes can be judged whatever they are, and
/// come back from a file as they went.
fn meshes(bytes: &[u8]) {
    MeshFormat::sniff(bytes);
    for format in [
        MeshFormat::Ply,
        MeshFormat::Obj,
        MeshFormat::Off,
        MeshFormat::Stl,
        MeshFormat::Json,
        MeshFormat::Glb,
    ] {
        match read_mesh(bytes, format) {
            Ok(mesh) => mesh_is_sound(&mesh),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
}

fn mesh_is_sound(mesh: &PolygonMesh) {
    let vertices = mesh.vertices.len();
    assert!(mesh.vertices.iter().flatten().all(|c| c.is_finite()));
    assert!(mesh.corners.iter().all(|&v| (v as usize) < vertices));
    assert!(mesh.faces().all(|f| f.len() >= 3));
    if vertices > 60 || mesh.corners.len() > 120 {
        return;
    }
    let report = check(mesh, &CheckOptions::default(), &Context::default());
    let report = report.expect("nobody cancelled");
    assert!(!report.is_embedded() || report.is_watertight());
    for format in [MeshFormat::Ply, MeshFormat::Off, MeshFormat::Json] {
        let mut file = Vec::new();
        let (attributes, options) = (MeshAttributes::default(), WriteOptions::default());
        write_mesh(&mut file, format, mesh, &attributes, &options).expect("what was read");
        if vertices > 0 {
            let again = read_mesh(&file, format).expect("what was written");
            assert!(again.vertices == mesh.vertices && again.corners == mesh.corners);
        }
    }
}

fn axes(bytes: &[u8]) {
    for format in [AxisFormat::Ma, AxisFormat::Ply, AxisFormat::Json] {
        match read_axis(bytes, format) {
            Ok(shape) => {
                let n = shape.balls.len();
                assert_eq!(shape.ids.len(), n);
                assert!(shape.edges.iter().flatten().all(|&b| (b as usize) < n));
                assert!(shape.triangles.iter().flatten().all(|&b| (b as usize) < n));
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
    if let Err(error) = read_balls(bytes) {
        assert!(!error.to_string().is_empty());
    }
}

/// The first three bytes choose options, coarseness and scale; each three bytes
/// after them are a point on a grid, 60 points at most.
fn pipeline(bytes: &[u8]) {
    let [choice, coarse, scale, rest @ ..] = bytes else {
        return;
    };
    let grid = [2, 3, 4, 5, 7, 11, 17, 64][usize::from(coarse % 8)];
    let unit = [1.0, 1.0, 0.1, 1e-9, 1e12, 1e-300, 1.0 / 3.0, 1e100][usize::from(scale % 8)];
    // Far away from the origin only few bits are left for the point.
    let offset = [0.0, 0.0, 0.5, 1e6][usize::from(scale / 8 % 4)] * unit;
    let points: Vec<Point> = (rest.chunks_exact(3).take(60))
        .map(|p| [0, 1, 2].map(|k| f64::from(p[k] % grid) * unit + offset))
        .collect();
    let mut options = Options {
        lambda: match choice % 4 {
            2 => LambdaOption::Value(0.3),
            3 => LambdaOption::Value(0.9),
            _ => LambdaOption::Auto,
        },
        single: choice & 8 != 0 && unit > 1e-20 && unit < 1e20,
        ..Options::default()
    };
    options.sharp = match (choice & 4 != 0, options.lambda.is_given()) {
        (true, true) => SharpOption::Skinny,
        (true, false) => SharpOption::Auto,
        _ => SharpOption::Off,
    };
    if choice & 16 != 0 {
        options.faces = Faces::Polygons;
    }
    if choice & 32 != 0 {
        options.flatness = 0.0;
    }
    if choice & 64 != 0 {
        options.merge = 0.0;
    }
    if choice & 128 != 0 {
        options.interpolate = Some(true);
    }
    let result = match reconstruct(&points, &options, &Context::default()) {
        Ok(result) => result,
        Err(Error::Samples(_) | Error::NothingInside { .. } | Error::Single { .. }) => return,
        Err(other) => panic!("{other}"),
    };
    let judge = CheckOptions {
        f32: options.single,
        ..CheckOptions::default()
    };
    let mesh = &result.crust.mesh;
    let report = check(mesh, &judge, &Context::default()).expect("nobody cancelled");
    assert!(
        report.is_embedded() && result.stats.crossings_left == 0,
        "{points:?} {options:?}: {:?} volume {}",
        report.counts,
        report.volume
    );
}
