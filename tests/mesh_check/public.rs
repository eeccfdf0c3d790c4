//! Public meshes whose facts are known.

use super::*;

/// The folder of public scans, if this machine has one.
fn shared() -> Option<PathBuf> {
    let root = match std::env::var_os("POWERCRUST_SHARED") {
        Some(path) => PathBuf::from(path),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"),
    };
    root.join("scans/meshes").is_dir().then_some(root)
}

/// A plain reader of OFF files.
fn read_off(path: &Path) -> PolygonMesh {
    let text = std::fs::read_to_string(path).unwrap();
    let mut numbers = (text.lines())
        .map(|line| line.split('#').next().unwrap_or(""))
        .flat_map(str::split_whitespace)
        .filter_map(|word| word.parse::<f64>().ok());
    let mut number = || numbers.next().unwrap();
    let (vertices, faces, _) = (number() as usize, number() as usize, number());
    let mut mesh = PolygonMesh::with_vertices(
        (0..vertices)
            .map(|_| [number(), number(), number()])
            .collect(),
    );
    for _ in 0..faces {
        let corners: Vec<u32> = (0..number() as usize).map(|_| number() as u32).collect();
        mesh.push_face(&corners);
    }
    mesh
}

/// A plain reader of binary little-endian PLY triangles whose vertices begin
/// with three floats and have nothing else.
fn read_ply(path: &Path) -> Option<PolygonMesh> {
    let bytes = std::fs::read(path).unwrap();
    let mark = b"end_header\n";
    let end = bytes.windows(mark.len()).position(|w| w == mark)? + mark.len();
    let header = std::str::from_utf8(&bytes[..end]).ok()?;
    let count = |what: &str| -> Option<usize> {
        let line = header.lines().find(|l| l.starts_with(what))?;
        line.rsplit(' ').next()?.parse().ok()
    };
    let (vertices, faces) = (count("element vertex")?, count("element face")?);
    let rest = &bytes[end..];
    if !header.contains("binary_little_endian") || rest.len() != 12 * vertices + 13 * faces {
        return None;
    }
    let word = |k: usize| rest[k..k + 4].try_into().unwrap();
    let mut mesh = PolygonMesh::with_vertices(
        (0..vertices)
            .map(|v| [0, 4, 8].map(|k| f64::from(f32::from_le_bytes(word(12 * v + k)))))
            .collect(),
    );
    for f in 0..faces {
        let at = 12 * vertices + 13 * f + 1;
        mesh.push_face(&[0, 4, 8].map(|k| u32::from_le_bytes(word(at + k))));
    }
    Some(mesh)
}

#[test]
fn public_meshes_have_their_known_facts() {
    let Some(root) = shared() else {
        eprintln!("skipped: no folder of public scans");
        return;
    };
    let truth = std::fs::read_to_string(root.join("scans/TRUTH.csv")).unwrap();
    let mut lines = truth.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| names.iter().position(|n| *n == name).unwrap();
    let mut read = 0;
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        let file = fields[0];
        let path = root.join("scans").join(file);
        let mesh = match path.extension().and_then(|e| e.to_str()) {
            _ if !file.starts_with("meshes/") => continue,
            Some("off") => read_off(&path),
            Some("ply") => match read_ply(&path) {
                Some(mesh) => mesh,
                None => continue,
            },
            _ => continue,
        };
        read += 1;
        let start = std::time::Instant::now();
        let report = judge(&mesh);
        let fact = |name: &str| fields[column(name)].parse::<f64>().ok();
        eprintln!(
            "{file}: {} faces in {:?}, {:?} cross, {:?} touch",
            report.faces,
            start.elapsed(),
            report.counts.crossing_faces,
            report.counts.touching_faces,
        );
        assert_eq!(
            report.is_closed() as u8 as f64,
            fact("closed").unwrap(),
            "{file}"
        );
        assert_eq!(
            report.components as f64,
            fact("components").unwrap(),
            "{file}"
        );
        if let Some(bad) = fact("nonmanifold_edges") {
            assert_eq!(report.counts.non_manifold_edge as f64, bad, "{file}");
        }
        if let Some(loops) = fact("loops") {
            let found: u64 = report.shells.iter().map(|s| s.loops).sum();
            assert_eq!(found as f64, loops, "{file}");
        }
        if let Some(genus) = fact("genus") {
            assert_eq!(report.genus.map(|g| g as f64), Some(genus), "{file}");
        }
        if let Some(volume) = fact("volume") {
            let error = (report.volume - volume).abs() / volume.abs();
            // Polygons that are not planar leave some choice.
            assert!(error < 1e-5, "{file}: {} not {volume}", report.volume);
        }
        let backwards = fact("volume").is_some_and(|v| v < 0.0);
        assert_eq!(report.counts.inside_out > 0, backwards, "{file}");
        // MeshLab finds the same numbers.
        match file {
            "meshes/venus_100000.ply" => assert_eq!(report.counts.crossing_faces, 45),
            "meshes/block.off" => assert_eq!(report.counts.crossing_faces, 43),
            _ => {}
        }
    }
    assert!(read >= 45, "{read} meshes read");
}
