//! Public files, where the machine has them: every malformed one by table, every
//! cloud and mesh by its counts.

use super::{PLAIN, SKIP};
use powercrust::io::*;
use std::path::{Path, PathBuf};

/// The folder of public files, if this machine has it.
fn scans() -> Option<PathBuf> {
    let shared = std::env::var_os("POWERCRUST_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"),
        PathBuf::from,
    );
    let scans = shared.join("scans");
    if scans.is_dir() {
        return Some(scans);
    }
    println!("skipped: no public files at {}", scans.display());
    None
}

fn load(path: &Path) -> (Vec<u8>, CloudFormat) {
    let bytes = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    let format = CloudFormat::from_extension(extension);
    (
        bytes,
        format.unwrap_or_else(|| panic!("{}", path.display())),
    )
}

/// What reading a malformed file must give: points, or a part of the message.
enum Outcome {
    Points(usize),
    Refused(&'static str),
}
use Outcome::{Points, Refused};

const MALFORMED: &[(&str, Outcome)] = &[
    ("assimp_empty.ply", Refused("empty")),
    ("assimp_empty.off", Refused("empty")),
    ("assimp_OutOfMemory.off", Refused("353535235358")),
    (
        "assimp_malformed.obj",
        Refused("line 28, column 3: index 0, but there are 8"),
    ),
    ("assimp_invalid.off", Refused("index 20")),
    (
        "assimp_issue623.ply",
        Refused("line 13: the line ends before property vertex_indices"),
    ),
    ("assimp_box_UTF16BE.obj", Refused("UTF-16")),
    (
        "assimp_number_formats.obj",
        Refused("line 11, column 14: expected a coordinate, found `3.1+e2`"),
    ),
    ("assimp_box_without_lineending.obj", Points(8)),
    ("assimp_point_cloud.obj", Points(3)),
    ("assimp_testmixed.obj", Points(8)),
    ("assimp_triangle_with_empty_solid.stl", Points(3)),
    ("assimp_sphereWithHole.stl", Points(146)),
    ("trimesh_empty.stl", Refused("no triangles")),
    ("trimesh_ply_empty_header.ply", Refused("no vertices")),
    ("trimesh_ply_empty_bin.ply", Refused("no vertices")),
    ("trimesh_ply_points_bin.ply", Points(8)),
    ("trimesh_stl_empty_bin.stl", Refused("no triangles")),
    ("trimesh_face_in_group_name_mid_file.obj", Points(5)),
    ("trimesh_points_ascii_with_lists.ply", Points(5)),
    ("trimesh_whitespace.off", Points(8)),
    ("trimesh_notenoughindices.obj", Points(3)),
    ("trimesh_wallhole.obj", Points(92)),
    ("trimesh_soup.stl", Points(300)),
    ("trimesh_busted.stl", Points(1941)),
    ("trimesh_nancolor.obj", Points(8)),
    ("trimesh_joined_tetrahedra.obj", Points(5)),
    ("trimesh_shared.stl", Points(14)),
    ("trimesh_points_cloudcompare.xyz", Points(101)),
    (
        "plyrs_single_elements_err_ascii.ply",
        Refused("no vertices"),
    ),
    ("plyrs_leading_spaces_ok_ascii.ply", Refused("no vertices")),
    (
        "plyrs_all_atomic_types_ok_ascii.ply",
        Refused("no vertices"),
    ),
    ("plyrs_greg_turk_example2_ok_ascii.ply", Points(8)),
    ("pdal_sized_dims.ply", Refused("property z")),
    ("pdal_text_extradim.ply", Points(1)),
    ("pdal_simple_text.ply", Points(3)),
    ("pdal_issue_2421.ply", Points(1)),
    ("pdal_badheader.txt", Refused("one column x")),
    ("pdal_crlf_test.txt", Points(10)),
    ("pdal_quoted.txt", Points(9)),
    ("pdal_autzen.pts", Points(10)),
    ("easy3d_degenerate.off", Points(8)),
    ("easy3d_fold_tri.obj", Points(3)),
    ("easy3d_complex_face_1.off", Points(10)),
    ("easy3d_2_umbrellas.off", Points(12)),
    ("easy3d_complex_edges_0.off", Points(16)),
    ("easy3d_graph.ply", Points(80)),
    ("cgal_cube-shuffled.off", Points(8)),
    ("cgal_tetra_intersected_by_triangle.off", Points(7)),
    ("cgal_cow.off", Points(2904)),
    ("cgal_cube.xyz", Points(8)),
    ("cgal_sphere966.off", Points(926)),
    ("cgal_circles.ply", Points(1101)),
    ("pcu_bunny_duplicates.ply", Points(2895)),
    ("pdal_missingheader.pcd", Refused("line 1: `289814.15`")),
    (
        "pcdrs_corrupt_compressed.pcd",
        Refused("100 compressed bytes announced, 12 found"),
    ),
    (
        "pcdrs_unsupported_v04.pcd",
        Refused("line 1: this version of PCD is not known"),
    ),
    ("pcdrs_missing_count.pcd", Points(1)),
    ("pcl_octants.pcd", Points(8)),
    ("pdal_no-points.las", Refused("no points")),
    ("pdal_bad_vlr_count.las", Points(10)),
];

#[test]
fn malformed_files_as_documented() {
    let Some(scans) = scans() else { return };
    let folder = scans.join("malformed");
    let mut wrong = Vec::new();
    for (name, expected) in MALFORMED {
        let (bytes, format) = load(&folder.join(name));
        let got = read_cloud(&bytes, format, &PLAIN);
        let fits = match (expected, &got) {
            (Points(n), Ok(cloud)) => cloud.points.len() == *n,
            (Refused(part), Err(e)) => e.to_string().contains(part),
            _ => false,
        };
        if !fits {
            let got = got.map(|c| c.points.len()).map_err(|e| e.to_string());
            wrong.push(format!("{name}: {got:?}"));
        }
    }
    // No file of a format we read may be left out of the table.
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        if CloudFormat::from_extension(extension).is_some()
            && !MALFORMED.iter().any(|(n, _)| *n == name)
        {
            wrong.push(format!("{name}: not in the table"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn clouds_and_meshes_as_counted() {
    let Some(scans) = scans() else { return };
    let truth = std::fs::read_to_string(scans.join("TRUTH.csv")).unwrap();
    let mut clouds = 0;
    let mut meshes = 0;
    for row in truth.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let path = scans.join(cells[0]);
        let number = |k: usize| cells[k].parse::<usize>().unwrap_or(0);
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        if CloudFormat::from_extension(extension).is_none() {
            continue;
        }
        if cells[0].starts_with("clouds/") {
            let (bytes, format) = load(&path);
            assert_eq!(CloudFormat::sniff(&bytes), format, "{}", cells[0]);
            let cloud = read_cloud(&bytes, format, &SKIP);
            let cloud = cloud.unwrap_or_else(|e| panic!("{}: {e}", cells[0]));
            let (points, invalid) = (number(1), number(2));
            assert_eq!(cloud.report.points_in_file, points, "{}", cells[0]);
            assert_eq!(cloud.report.invalid_dropped, invalid, "{}", cells[0]);
            assert_eq!(cloud.points.len(), points - invalid, "{}", cells[0]);
            let plain = read_cloud(&bytes, format, &PLAIN);
            assert_eq!(plain.is_err(), invalid > 0, "{}", cells[0]);
            clouds += 1;
        }
        if cells[0].starts_with("meshes/") {
            let (bytes, _) = load(&path);
            let format = MeshFormat::from_extension(extension).unwrap();
            let mesh = read_mesh(&bytes, format);
            let mesh = mesh.unwrap_or_else(|e| panic!("{}: {e}", cells[0]));
            assert_eq!(mesh.face_count(), number(3), "{}", cells[0]);
            if format != MeshFormat::Stl {
                assert_eq!(mesh.vertices.len(), number(1), "{}", cells[0]);
            }
            let volume: f64 = cells[9].parse().unwrap_or(mesh.volume());
            assert!(
                (mesh.volume() - volume).abs() <= 1e-5 * volume.abs(),
                "{}: {} for {volume}",
                cells[0],
                mesh.volume()
            );
            meshes += 1;
        }
    }
    assert!(
        clouds >= 31 && meshes >= 50,
        "{clouds} clouds, {meshes} meshes"
    );
}

#[test]
fn public_files_in_detail() {
    let Some(scans) = scans() else { return };
    let read = |name: &str| {
        let (bytes, format) = load(&scans.join(name));
        read_cloud(&bytes, format, &PLAIN).unwrap()
    };
    let cap = read("clouds/distcap.pts");
    assert_eq!(cap.report.records_passed_over, 5);
    assert!(
        cap.report.notes[0].contains("d (1), g (1), s (1)"),
        "{:?}",
        cap.report.notes
    );
    assert!(read("clouds/oni.pwn").normals.is_some());
    assert!(read("clouds/kitten.xyz").normals.is_some());
    // Six columns, but the last three are no unit vectors.
    let torus = read("clouds/WS0.25_4000_torus.xyz");
    assert!(torus.normals.is_none() && torus.scalars.len() == 3);
    assert!(read("clouds/gargoyle.ply").normals.is_some());
    let autzen = read("malformed/pdal_autzen.pts");
    assert_eq!(autzen.scalars[0].name, "intensity");
    assert_eq!(autzen.colours.unwrap()[0], [52, 70, 64, 255]);
    let compare = read("malformed/trimesh_points_cloudcompare.xyz");
    assert_eq!(compare.colours.unwrap()[0], [117, 73, 49, 255]);
    assert_eq!(
        read("malformed/assimp_point_cloud.obj")
            .normals
            .unwrap()
            .len(),
        3
    );
    let igea = read("clouds/igea.ply");
    assert_eq!(igea.report.faces_ignored, Some(268_686));
    let far = read("malformed/pdal_issue_2421.ply");
    assert_eq!(far.points[0], [1.23457, 12345.6789, 1234567890.12345]);
    assert_eq!(far.scalars[0].name, "i");
}
