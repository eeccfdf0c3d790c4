//! Files in and out: public files by table, small files as literals, round
//! trips, and damage of every kind.

use powercrust::io::*;
use powercrust::surface::NONE;
use powercrust::{Ball, PolarBall, PolygonMesh, PowerShape, Side};
use std::path::{Path, PathBuf};

const PLAIN: ReadOptions = ReadOptions {
    skip_invalid: false,
};
const SKIP: ReadOptions = ReadOptions { skip_invalid: true };

fn text(bytes: &str) -> Result<Cloud, ReadError> {
    read_cloud(bytes.as_bytes(), CloudFormat::Text, &PLAIN)
}

/// The message of a failure, which must be one.
fn message(result: Result<Cloud, ReadError>) -> String {
    result.expect_err("should be refused").to_string()
}

// ---- public files -------------------------------------------------------

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
        clouds >= 29 && meshes >= 50,
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

// ---- text ---------------------------------------------------------------

#[test]
fn delimiters_comments_and_line_ends() {
    let square = [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [0.0, 1e300, 1e-300]];
    for file in [
        "0 0 0.5\n1 0 .5\n0 1e300 1e-300\n",
        "0\t0\t0.5\r\n1\t0\t.5\r\n0\t1e300\t1e-300",
        "0,0,0.5\n1, 0, 5e-1\n0 ,1e300,1e-300,\n",
        "0;0;0.5;\n1;0;0.5;\n0;1e300;1e-300;\n",
        "\u{feff}# comment\n// more\n\n  0 0 0.5 # here too\n% and\n1 0 0.5\n; or\n0 1e300 1e-300\n",
        "3\n0 0 0.5\n1 0 0.5\n0 1e300 1e-300\n",
        "2\n0 0 0.5\n1 0 0.5\n1\n0 1e300 1e-300\n",
        "0 0 0.5\r1 0 0.5\r0 1e300 1e-300\r",
        "d 0 0 0\np 0 0 0.5\np 1 0 0.5\ns 1\np 0 1e300 1e-300\n",
        "\"0\",\"0\",\"0.5\"\n\"1\",\"0\",\"0.5\"\n\"0\",\"1e300\",\"1e-300\"\n",
        "z y x\n0.5 0 0\n.5 0 1\n1e-300 1e300 0\n",
        "'X (m)';'Y (m)';'Z (m)'\n0;0;0.5\n1;0;0.5\n0;1e300;1e-300\n",
    ] {
        let cloud = text(file).unwrap_or_else(|e| panic!("{e}\n{file}"));
        assert_eq!(cloud.points, square, "{file}");
        assert_eq!(cloud.scalars, [], "{file}");
    }
}

#[test]
fn meanings_of_columns() {
    let normals = text("0 0 0 0 0 1\n1 1 1 0.6 0 -0.8\n").unwrap();
    assert_eq!(normals.normals.unwrap()[1], [0.6, 0.0, -0.8]);
    let colours = text("0 0 0 255 0 1\n1 1 1 6 0 8\n").unwrap();
    assert_eq!(colours.colours.unwrap(), [[255, 0, 1, 255], [6, 0, 8, 255]]);
    let neither = text("0 0 0 0.5 0 1\n1 1 1 6 0 8\n").unwrap();
    assert_eq!(neither.scalars.len(), 3);
    assert_eq!(neither.scalars[2].name, "column 6");
    assert!(neither.report.notes[0].contains("neither normals"));
    let both = text("0 0 0 0 0 1 9 8 7 0.5\n").unwrap();
    assert!(both.normals.is_some() && both.colours.is_some());
    assert_eq!(both.scalars[0].name, "column 10");
    // Names win over looks.
    let named = text("x,y,z,nx,ny,nz,quality\n0,0,0,3,4,0,\n1,1,1,6,0,8,2\n").unwrap();
    assert_eq!(named.normals.unwrap()[0], [3.0, 4.0, 0.0]);
    assert_eq!(named.scalars[0].name, "quality");
    assert!(named.scalars[0].values[0].is_nan() && named.scalars[0].values[1] == 2.0);
    let commented = text("//X Y Z R G B scalar\n1 2 3 0 128 255 0.5\n").unwrap();
    assert_eq!(commented.colours.unwrap(), [[0, 128, 255, 255]]);
    assert_eq!(commented.scalars[0].name, "scalar");
    let unnamed = text("lon lat height\n1 2 3\n").unwrap();
    assert!(unnamed.report.notes[0].contains("lon, lat, height"));
    // Points first, their normals after them.
    let pwn = text("2\n0 0 0\n5 5 5\n0 0 1\n0 1 0\n").unwrap();
    assert_eq!(pwn.points.len(), 2);
    assert_eq!(pwn.normals.unwrap(), [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]);
    let pts = text("1\n1 2 3 9\n").unwrap();
    assert_eq!(pts.scalars[0].name, "intensity");
    let more = text("1\n1 2 3\n4 5 6\n").unwrap();
    assert!(more.report.notes[0].contains("announces 1 points, but there are 2"));
}

#[test]
fn text_that_is_refused() {
    for (file, part) in [
        ("", "empty"),
        ("\n\n  \n", "no points"),
        ("# only\n", "no points"),
        ("x y z\n", "no points"),
        ("1 2\n3 4\n", "line 1: 2 values"),
        ("1 2 3\n4 5\n", "line 2: 2 values where line 1 has 3"),
        ("1 2 3\n4 5 6 7\n", "line 2: 4 values where line 1 has 3"),
        (
            "1 2 3\n4 five 6\n",
            "line 2, column 3: expected a number, found `five`",
        ),
        (
            "1 2 3\nx y z\n",
            "line 2, column 1: expected a number, found `x`",
        ),
        ("x,y\n1,2\n", "one column z"),
        ("x,y,z\n1,2,3,4\n", "line 1 names 3 columns"),
        (
            "1,2,3\n4,,6\n",
            "line 2, column 3: expected a number, found ``",
        ),
        (
            "1,5 2,5 3,5\n",
            "line 1, column 1: `1,5` looks like a number with a decimal comma",
        ),
        ("1,5;2,5;3,5\n", "decimal comma"),
        ("x;y;z\n1,5;2;3\n", "decimal comma"),
        (
            "1.5 2 3\n1,5 2 3\n",
            "line 2, column 1: `1,5` looks like a number with a decimal comma",
        ),
        ("5\n1 2 3\n4 5 6\n", "5 points announced, 2 found"),
        ("5\n", "5 points announced, 0 found"),
        (
            "p 1 2 3\n4 5 6\n",
            "line 2, column 1: expected a record letter",
        ),
        ("d 1 2 3\n", "no points"),
        (
            "1 2 3\nnan 1 2\n",
            "line 2: the point (NaN, 1, 2) is not finite",
        ),
        ("1 2 1e999\n", "(1, 2, inf) is not finite"),
        ("1 2 3\0\n", "binary data"),
        ("\u{1b}[31m 1 2\n", "column 1"),
    ] {
        let message = message(text(file));
        assert!(message.contains(part), "{file:?}: {message}");
    }
    assert!(message(text("1 2 3\nnan 1 2\n")).contains("--skip-invalid"));
}

#[test]
fn invalid_points_are_dropped_on_request() {
    let file = "1 2 3 0.5\nnan 1 2 1.5\n4 5 6 2.5\n-nan(ind) 1.#QNAN 1.#INF 7\n";
    let cloud = read_cloud(file.as_bytes(), CloudFormat::Text, &SKIP).unwrap();
    assert_eq!(cloud.points, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    assert_eq!(cloud.scalars[0].values, [0.5, 2.5]);
    let report = &cloud.report;
    assert_eq!((report.points_in_file, report.invalid_dropped), (4, 2));
    assert_eq!(report.first_invalid.as_deref(), Some("line 2"));
    assert!(
        report.notes[0].starts_with("2 of 4 points"),
        "{:?}",
        report.notes
    );
    let all = read_cloud(b"nan 0 0\n", CloudFormat::Text, &SKIP);
    assert!(message(all).contains("all 1 points"));
}

// ---- PLY ----------------------------------------------------------------

fn ply(header: &str, body: &[u8]) -> Vec<u8> {
    [b"ply\n", header.as_bytes(), b"end_header\n", body].concat()
}

#[test]
fn ply_types_orders_and_extras() {
    let header = "element vertex 2\nproperty uchar RED\nproperty short x\nproperty list uchar float w\nproperty double y\nproperty int8 z\nproperty uchar green\nproperty uchar blue\nproperty ushort q\n";
    let mut little = Vec::new();
    let mut big = Vec::new();
    for (x, y, z) in [(-300i16, 0.1f64, -5i8), (7, 1e300, 6)] {
        for (out, le) in [(&mut little, true), (&mut big, false)] {
            let pick = |l: &[u8]| {
                let mut l = l.to_vec();
                if !le {
                    l.reverse();
                }
                l
            };
            out.push(9);
            out.extend(pick(&x.to_le_bytes()));
            out.push(1);
            out.extend([0; 4]);
            out.extend(pick(&y.to_le_bytes()));
            out.push(z as u8);
            out.extend([8, 7]);
            out.extend(pick(&600u16.to_le_bytes()));
        }
    }
    let ascii = b"9 -300 1 0 0.1 -5 8 7 600\r\n  9 7 2 0 0 1e300 6 8 7 600 ".to_vec();
    for (name, body) in [
        ("binary_little_endian", little),
        ("binary_big_endian", big),
        ("ascii", ascii),
    ] {
        let file = ply(&format!("format {name} 1.0\ncomment x\n{header}"), &body);
        let cloud = read_cloud(&file, CloudFormat::Ply, &PLAIN).unwrap();
        assert_eq!(
            cloud.points,
            [[-300.0, 0.1, -5.0], [7.0, 1e300, 6.0]],
            "{name}"
        );
        assert_eq!(cloud.colours.unwrap()[1], [9, 8, 7, 255]);
        assert_eq!(cloud.scalars[0].values, [600.0, 600.0]);
        let crlf = String::from_utf8_lossy(&file[..file.len() - body.len()]).replace('\n', "\r\n");
        let crlf = [crlf.replace("ply", "ply ").as_bytes(), &body[..]].concat();
        let cloud = read_cloud(&crlf, CloudFormat::Ply, &PLAIN).unwrap();
        assert_eq!(cloud.points[1], [7.0, 1e300, 6.0], "{name} CRLF");
    }
}

#[test]
fn ply_colours_as_floats() {
    let header = "format ascii 1.0\nelement vertex 2\nproperty int x\nproperty int y\nproperty int z\nproperty float diffuse_red\nproperty float diffuse_green\nproperty float diffuse_blue\n";
    let cloud = read_cloud(
        &ply(header, b"0 0 0 0 0.5 1\n0 0 1 0 nan 0\n"),
        CloudFormat::Ply,
        &PLAIN,
    );
    assert_eq!(
        cloud.unwrap().colours.unwrap(),
        [[0, 128, 255, 255], [0, 0, 0, 255]]
    );
}

#[test]
fn ply_that_is_refused() {
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    let binary = "format binary_little_endian 1.0\n";
    let ascii = "format ascii 1.0\n";
    for (header, body, part) in [
        (format!("{binary}element vertex 4000000000\n{xyz}"), &[0u8; 30][..], "4000000000 vertices announced, 2 found"),
        (format!("{binary}element vertex 99999999999999\n{xyz}"), &[0; 30], "99999999999999 vertices: at most"),
        (format!("{ascii}element vertex 3\n{xyz}"), b"1 2 3\n4 5 6\n", "3 vertices announced, 2 found"),
        (format!("{ascii}element vertex 1\n{xyz}"), b"1 2\n", "line 8: the line ends before property z"),
        (format!("{ascii}element vertex 1\n{xyz}"), b"1 2 3 4\n", "line 8, column 7: more values"),
        (format!("{ascii}element vertex 1\n{xyz}"), b"1 two 3\n", "line 8, column 3: expected a number, found `two`"),
        (format!("{ascii}element vertex 1\n{xyz}"), b"1 nan 3\n", "line 8: the point"),
        (format!("{binary}element vertex 2\n{xyz}"), &[255; 24], "record 0 (counting from 0)"),
        (format!("{binary}element vertex 1\n{xyz}element face 2\nproperty list int int vertex_indices\n"), &[1; 24], "faces announced"),
        (format!("{binary}element vertex 1\n{xyz}element face 1\nproperty list char int vertex_indices\n"), &[255; 13], "a list of length -1"),
        (format!("element vertex 1\n{xyz}"), b"1 2 3\n", "`format` line"),
        ("format ascii 2.0\n".into(), b"", "line 2: expected `format ascii 1.0`"),
        (format!("{ascii}property float x\n"), b"", "line 3: a property before any element"),
        (format!("{ascii}element vertex -1\n"), b"", "line 3: expected `element NAME COUNT`"),
        (format!("{ascii}element vertex 1\nproperty real x\n"), b"", "line 4: expected `property TYPE NAME`"),
        (format!("{ascii}element vertex 1\n{xyz}property int x\n"), b"1 2 3 4\n", "two vertex properties named x"),
        (format!("{ascii}element nothing 4000000000\nelement vertex 1\nproperty int x\n"), b"1\n", "property y"),
        (format!("{ascii}what\n"), b"", "line 3: unknown header keyword `what`"),
    ] {
        let message = message(read_cloud(&ply(&header, body), CloudFormat::Ply, &PLAIN));
        assert!(message.contains(part), "{header}: {message}");
    }
    let cut = read_cloud(
        b"ply\nformat ascii 1.0\nelement vertex 1\n",
        CloudFormat::Ply,
        &PLAIN,
    );
    assert!(message(cut).contains("no end_header"));
}

// ---- OBJ, OFF, STL, NPY -------------------------------------------------

#[test]
fn obj_in_small() {
    let read = |s: &str| read_cloud(s.as_bytes(), CloudFormat::Obj, &PLAIN);
    let cloud =
        read("# c\r\nv 1 2 \\\r\n 3 0.5 0 1\r\nv 4 5 6 1 1 1\r\nl 1 2\r\nf 1 2 -1").unwrap();
    assert_eq!(cloud.points, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    assert_eq!(cloud.colours.unwrap()[0], [128, 0, 255, 255]);
    assert_eq!(cloud.report.faces_ignored, Some(1));
    assert_eq!(cloud.report.records_passed_over, 2);
    assert!(cloud.report.notes[0].contains("mesh of 1 faces"));
    for (file, part) in [
        ("f 1 2 3\n", "no vertices"),
        ("v 1 2\n", "line 1: the line ends"),
        (
            "v 1 2 x\n",
            "line 1, column 7: expected a coordinate, found `x`",
        ),
        (
            "v 1 2 3\nf 1 1 2\n",
            "line 2, column 7: index 2, but there are 1 vertices",
        ),
        ("v 1 2 3\nf 1 1 0\n", "index 0"),
        ("v 1 2 3\nf 1 1 -2\n", "index -2"),
        ("1 2 3\n", "starts no OBJ statement"),
        ("v nan 2 3\n", "line 1: the point"),
    ] {
        let message = message(read(file));
        assert!(message.contains(part), "{file:?}: {message}");
    }
    let short = read_mesh(b"v 0 0 0\nv 1 0 0\nf 1 2\n", MeshFormat::Obj).unwrap_err();
    assert!(
        short.to_string().contains("line 3: a face of 2 corners"),
        "{short}"
    );
}

#[test]
fn off_in_small() {
    let read = |s: &str| read_cloud(s.as_bytes(), CloudFormat::Off, &PLAIN);
    let same = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for file in [
        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0",
        "# c\n\tOFF3 1 # or so\n\n0 0\n0\n1 0 0\r\n0 1 0 # last\n3 0 1 2",
        "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "NOFF\n3 0 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n",
        "STCNOFF\n3 0\n0 0 0 0 0 1 1 0 0 1 .5 .5\n1 0 0 0 0 1 1 0 0 1 0 0\n0 1 0 0 0 1 0 0 0 1 1 1\n",
        "COFF\n3 0 0\n0 0 0 255 0 0 255\n1 0 0 2 0 1 255\n0 1 0 0 0 1 255\n",
    ] {
        let cloud = read(file).unwrap_or_else(|e| panic!("{e}\n{file}"));
        assert_eq!(cloud.points, same, "{file}");
        assert_eq!(cloud.normals.is_some(), file.contains('N'), "{file}");
        assert_eq!(cloud.colours.is_some(), file.contains('C'), "{file}");
    }
    for (file, part) in [
        ("OFF\n", "no counts"),
        ("OFF\n0 0 0\n", "no vertices"),
        ("OFF BINARY\n3 1 0\n", "binary OFF"),
        ("4OFF\n3 1 0\n", "another dimension"),
        ("COFF\n1 0 0\n1 2 3\n", "COFF has 3 or 4"),
        (
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n",
            "1 faces announced, 0 found",
        ),
        (
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
            "index 3, but there are 3",
        ),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n", "3 vertices announced"),
        ("OFF\n1 0 0\n1 two 3\n", "line 3, column 3"),
        ("PLY\n1 0 0\n", "expected the keyword OFF, found `PLY`"),
    ] {
        let message = message(read(file));
        assert!(message.contains(part), "{file:?}: {message}");
    }
}

#[test]
fn stl_in_small() {
    let read = |b: &[u8]| read_cloud(b, CloudFormat::Stl, &PLAIN);
    let ascii = "SOLID a name\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 -0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\nsolid b\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid b\n";
    let cloud = read(ascii.as_bytes()).unwrap();
    assert_eq!(
        (cloud.points.len(), cloud.report.faces_ignored),
        (4, Some(2))
    );
    // A binary file that begins with `solid`.
    let mut binary = [b' '; 84];
    binary[..5].copy_from_slice(b"solid");
    binary[80..].copy_from_slice(&1u32.to_le_bytes());
    let mut file = binary.to_vec();
    file.extend([0; 12]);
    for c in [0f32, 0.0, 0.0, 1.0, 0.0, -0.0, 0.0, 1.0, 0.0] {
        file.extend(c.to_le_bytes());
    }
    file.extend([0; 2]);
    assert_eq!(CloudFormat::sniff(&file), CloudFormat::Stl);
    assert_eq!(read(&file).unwrap().points.len(), 3);
    let mut lying = file.clone();
    lying[80] = 200;
    lying[0] = b'x';
    assert!(message(read(&lying)).contains("200 triangles announced, 1 found"));
    for (file, part) in [
        (&ascii[..ascii.len() - 11], "cut off"),
        (&ascii[..100], "cut off"),
        (
            "solid\nfacet\nouter loop\nvertex 1 2 3\nendloop\nendfacet\nendsolid\n",
            "a facet of 1 vertices",
        ),
        (
            "solid\nwhat\nendsolid\n",
            "line 2, column 1: expected a keyword of STL",
        ),
        (
            "solid\nfacet\nvertex 1 nan 2\nvertex 1 2 3\nvertex 3 2 1\nendfacet\nendsolid",
            "line 3: the point",
        ),
        ("hello", "not an STL file"),
    ] {
        let message = message(read(file.as_bytes()));
        assert!(message.contains(part), "{file:?}: {message}");
    }
}

fn npy(dict: &str, data: &[u8]) -> Vec<u8> {
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((dict.len() as u16).to_le_bytes());
    file.extend(dict.as_bytes());
    file.extend(data);
    file
}

#[test]
fn npy_in_small() {
    let read = |b: &[u8]| read_cloud(b, CloudFormat::Npy, &PLAIN);
    let dict = |descr: &str, order: &str, shape: &str| {
        format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}   \n")
    };
    let points = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
    let c = [1, 2, 3, 4, 5, 6];
    let f = [1, 4, 2, 5, 3, 6];
    for (descr, order, data) in [
        (
            "<f4",
            "False",
            c.iter()
                .flat_map(|&v| (v as f32).to_le_bytes())
                .collect::<Vec<u8>>(),
        ),
        (
            ">f8",
            "False",
            c.iter().flat_map(|&v| f64::from(v).to_be_bytes()).collect(),
        ),
        (
            "<f8",
            "True",
            f.iter().flat_map(|&v| f64::from(v).to_le_bytes()).collect(),
        ),
        ("|u1", "True", f.iter().map(|&v| v as u8).collect()),
        (
            "<i8",
            "False",
            c.iter().flat_map(|&v| i64::from(v).to_le_bytes()).collect(),
        ),
    ] {
        let cloud = read(&npy(&dict(descr, order, "(2, 3)"), &data)).unwrap();
        assert_eq!(cloud.points, points, "{descr} {order}");
    }
    let wide: Vec<u8> = [0f32, 0.0, 0.0, 0.0, 0.0, 1.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    assert!(read(&npy(&dict("<f4", "False", "(1, 6)"), &wide))
        .unwrap()
        .normals
        .is_some());
    for (dict, part) in [
        (
            dict("<f4", "False", "(9, 3)"),
            "9 points announced, 2 found",
        ),
        (dict("<f4", "False", "(6,)"), "an array of shape [6]"),
        (dict("<f4", "False", "(3, 2)"), "an array of shape [3, 2]"),
        (dict("<f4", "False", "(0, 3)"), "no points"),
        (dict("<f4", "False", "(1, 99999999999999999)"), "1024"),
        (dict("<c8", "False", "(2, 3)"), "`<c8`"),
        (dict("<f2", "False", "(2, 3)"), "`f2`"),
        ("{}".into(), "lacks descr"),
    ] {
        let message = message(read(&npy(&dict, &[0; 24])));
        assert!(message.contains(part), "{dict}: {message}");
    }
    assert!(message(read(b"\x93NUMPY\x01\x00\xff\xff")).contains("within the NPY header"));
}

// ---- writing and reading back -------------------------------------------

/// A cube with one quadrilateral and awkward numbers.
fn solid() -> PolygonMesh {
    let mut vertices = Vec::new();
    for k in 0..8u8 {
        let bit = |n: u8| f64::from(k >> n & 1);
        vertices.push([bit(0) * 0.1, bit(1) / 3.0, bit(2) * 1e-7 - 12345.678]);
    }
    let mut mesh = PolygonMesh::with_vertices(vertices);
    mesh.push_face(&[0, 2, 3, 1]);
    for f in [
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
    ] {
        mesh.push_face(&f);
    }
    for f in [[0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]] {
        mesh.push_face(&f);
    }
    mesh
}

fn written(
    format: MeshFormat,
    mesh: &PolygonMesh,
    attributes: &MeshAttributes,
    options: &WriteOptions,
) -> Vec<u8> {
    let mut out = Vec::new();
    write_mesh(&mut out, format, mesh, attributes, options).unwrap();
    out
}

fn ascii() -> WriteOptions {
    WriteOptions {
        ascii: true,
        comments: vec!["made by a test\nelement vertex 3\\".into()],
        ..WriteOptions::default()
    }
}

#[test]
fn meshes_come_back_the_same() {
    let mesh = solid();
    let normals = vec![[0.0, 0.6, -0.8]; 8];
    let colours = vec![[1, 2, 3, 255]; 8];
    let samples = [0, 1, 2, NONE, 4, 5, 6, 7];
    let thickness = [0.1, f64::NAN, 1e300, -1.0, 0.0, 1.0, 2.0, 3.0];
    let flags = [1u8, 0, 1, 0, 0, 0, 0, 0, 0, 0, 1];
    let parts: Vec<i32> = (0..11).map(|k| k - 5).collect();
    let attributes = MeshAttributes {
        normals: Some(&normals),
        colours: Some(&colours),
        samples: Some(&samples),
        vertices: vec![Attribute {
            name: "local thickness",
            values: AttributeValues::Float(&thickness),
        }],
        faces: vec![
            Attribute {
                name: "hole",
                values: AttributeValues::Byte(&flags),
            },
            Attribute {
                name: "component",
                values: AttributeValues::Int(&parts),
            },
        ],
    };
    for options in [WriteOptions::default(), ascii()] {
        for format in [
            MeshFormat::Ply,
            MeshFormat::Obj,
            MeshFormat::Off,
            MeshFormat::Json,
        ] {
            for with in [&MeshAttributes::default(), &attributes] {
                let file = written(format, &mesh, with, &options);
                assert_eq!(MeshFormat::sniff(&file), Some(format));
                let back = read_mesh(&file, format).unwrap();
                assert_eq!(back, mesh, "{format:?} {options:?}");
            }
        }
        let file = written(MeshFormat::Ply, &mesh, &attributes, &options);
        let cloud = read_cloud(&file, CloudFormat::Ply, &PLAIN).unwrap();
        assert_eq!(cloud.points, mesh.vertices);
        assert_eq!(cloud.normals.as_ref(), Some(&normals));
        assert_eq!(cloud.colours.as_ref(), Some(&colours));
        assert_eq!(cloud.scalars[0].values[3], -1.0);
        assert_eq!(cloud.scalars[1].name, "local_thickness");
        let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&cloud.scalars[1].values), bits(&thickness));
        for format in [CloudFormat::Obj, CloudFormat::Off] {
            let name = if format == CloudFormat::Obj {
                MeshFormat::Obj
            } else {
                MeshFormat::Off
            };
            let file = written(name, &mesh, &attributes, &options);
            let cloud = read_cloud(&file, format, &PLAIN).unwrap();
            assert_eq!(cloud.normals.as_ref(), Some(&normals), "{format:?}");
            assert_eq!(cloud.colours.as_ref(), Some(&colours), "{format:?}");
        }
        // STL: triangles in 32 bits (here exact), vertices in another order.
        let mut exact = mesh.clone();
        for v in exact.vertices.iter_mut().flatten() {
            *v = (*v * 4.0).round();
        }
        exact
            .vertices
            .iter_mut()
            .enumerate()
            .for_each(|(k, v)| v[0] = k as f64);
        let file = written(
            MeshFormat::Stl,
            &exact,
            &MeshAttributes::default(),
            &options,
        );
        assert_eq!(MeshFormat::sniff(&file), Some(MeshFormat::Stl));
        let back = read_mesh(&file, MeshFormat::Stl).unwrap();
        assert_eq!((back.vertices.len(), back.face_count()), (8, 12));
        assert!((back.volume() - exact.volume()).abs() < 1e-9);
    }
}

#[test]
fn large_polygons_and_32_bit_floats() {
    let vertices = (0..300).map(|k| [f64::from(k), 0.5, -1.0]).collect();
    let mut mesh = PolygonMesh::with_vertices(vertices);
    let all: Vec<u32> = (0..300).collect();
    mesh.push_face(&all);
    for options in [
        WriteOptions {
            float32: true,
            ..WriteOptions::default()
        },
        WriteOptions {
            float32: true,
            ..ascii()
        },
    ] {
        let file = written(MeshFormat::Ply, &mesh, &MeshAttributes::default(), &options);
        assert!(String::from_utf8_lossy(&file).contains("property list uint int vertex_indices"));
        assert!(String::from_utf8_lossy(&file).contains("property float x"));
        assert_eq!(read_mesh(&file, MeshFormat::Ply).unwrap(), mesh);
    }
    mesh.vertices[7][0] = 1e300;
    let options = WriteOptions {
        float32: true,
        ..WriteOptions::default()
    };
    for format in [MeshFormat::Ply, MeshFormat::Stl] {
        let mut out = Vec::new();
        let with = MeshAttributes::default();
        let error = write_mesh(&mut out, format, &mesh, &with, &options).unwrap_err();
        assert!(error.to_string().contains("vertex 7"), "{error}");
    }
}

#[test]
fn numbers_as_text() {
    let mesh = PolygonMesh::with_vertices(vec![[1.0, 0.1, 1e300], [-2.5e-9, 1.0 / 3.0, 0.0]]);
    let file = written(MeshFormat::Obj, &mesh, &MeshAttributes::default(), &ascii());
    let text = String::from_utf8(file).unwrap();
    assert!(
        text.ends_with("v 1 0.1 1e300\nv -2.5e-9 0.3333333333333333 0\n"),
        "{text}"
    );
    assert!(
        text.starts_with("# made by a test\n# element vertex 3\nv "),
        "{text}"
    );
    let options = WriteOptions {
        digits: Some(4),
        ..WriteOptions::default()
    };
    let file = written(MeshFormat::Obj, &mesh, &MeshAttributes::default(), &options);
    assert_eq!(
        String::from_utf8(file).unwrap(),
        "v 1 0.1 1e300\nv -2.5e-9 0.3333 0\n"
    );
    assert_eq!(
        read_mesh(text.as_bytes(), MeshFormat::Obj)
            .unwrap()
            .vertices,
        mesh.vertices
    );
}

#[test]
fn writers_refuse_contradictions() {
    let mesh = solid();
    let refuse = |mesh: &PolygonMesh, with: &MeshAttributes| {
        let mut out = Vec::new();
        let error = write_mesh(
            &mut out,
            MeshFormat::Ply,
            mesh,
            with,
            &WriteOptions::default(),
        );
        assert!(out.is_empty());
        error.expect_err("should be refused").to_string()
    };
    let short = MeshAttributes {
        samples: Some(&[1, 2]),
        ..MeshAttributes::default()
    };
    assert_eq!(
        refuse(&mesh, &short),
        "attribute samples has 2 values, expected 8"
    );
    let mut bad = mesh.clone();
    bad.corners[3] = 8;
    assert!(refuse(&bad, &MeshAttributes::default()).contains("corner 3 names vertex 8"));
    let mut bad = mesh.clone();
    bad.starts[1] = 99;
    assert!(refuse(&bad, &MeshAttributes::default()).contains("face starts"));
    let huge = MeshAttributes {
        samples: Some(&[3_000_000_000; 8]),
        ..MeshAttributes::default()
    };
    assert!(refuse(&mesh, &huge).contains("3000000000 as int"));
    struct Full;
    impl std::io::Write for Full {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(std::io::ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let with = MeshAttributes::default();
    let error = write_mesh(
        &mut Full,
        MeshFormat::Off,
        &mesh,
        &with,
        &WriteOptions::default(),
    );
    assert!(matches!(error, Err(WriteError::Io(_))));
    // Nothing at all is still a file.
    let empty = PolygonMesh::default();
    for format in [
        MeshFormat::Ply,
        MeshFormat::Obj,
        MeshFormat::Off,
        MeshFormat::Stl,
        MeshFormat::Json,
    ] {
        written(format, &empty, &with, &WriteOptions::default());
    }
}

fn axis() -> PowerShape {
    let ball = |k: u8| Ball::new([f64::from(k) * 0.1, 0.25, -1.0], f64::from(k));
    PowerShape {
        balls: (0..5).map(ball).collect(),
        ids: vec![9, 8, 7, 6, 5],
        edges: vec![[0, 1], [0, 4], [2, 3]],
        triangles: vec![[0, 1, 2], [1, 2, 3]],
        tetrahedra: vec![[0, 1, 2, 3]],
    }
}

fn written_axis(format: AxisFormat, shape: &PowerShape, options: &WriteOptions) -> Vec<u8> {
    let mut out = Vec::new();
    write_axis(&mut out, format, shape, options).unwrap();
    out
}

#[test]
fn axes_come_back_the_same() {
    let shape = axis();
    for options in [WriteOptions::default(), ascii()] {
        for format in [AxisFormat::Ma, AxisFormat::Ply, AxisFormat::Json] {
            let file = written_axis(format, &shape, &options);
            let back = read_axis(&file, format).unwrap();
            assert_eq!(back.balls, shape.balls);
            assert_eq!(back.edges, shape.edges);
            assert_eq!(back.triangles, shape.triangles);
            if format == AxisFormat::Ma {
                assert_eq!(back.ids, [0, 1, 2, 3, 4]);
            } else {
                assert_eq!(back.ids, shape.ids);
                assert_eq!(back.tetrahedra, shape.tetrahedra);
            }
        }
    }
    let file = written_axis(AxisFormat::Obj, &shape, &WriteOptions::default());
    let cloud = read_cloud(&file, CloudFormat::Obj, &PLAIN).unwrap();
    assert_eq!(
        (cloud.points.len(), cloud.report.faces_ignored),
        (5, Some(2))
    );
    assert!(read_axis(&file, AxisFormat::Obj).is_err());
    let mut bad = shape.clone();
    bad.edges[1] = [0, 5];
    let mut out = Vec::new();
    let error = write_axis(&mut out, AxisFormat::Ma, &bad, &WriteOptions::default());
    assert!(error.unwrap_err().to_string().contains("edge 1"));
    for (file, part) in [
        ("", "empty"),
        ("1 0\n", "number of triangles"),
        ("0 0 0\n", "no balls"),
        ("2 0 0\nv 1 2 3 4\n", "2 balls announced, 1 found"),
        ("1 0 0\nv 1 2 3 -4\n", "line 2: the radius -4"),
        ("1 0 0\nv 1 2 3\n", "line 2: a line `v` has 4 numbers"),
        (
            "1 1 0\nv 1 2 3 4\ne 0 1\n",
            "line 3: index 1, but there are 1 balls",
        ),
        ("1 0 0\nx 1 2 3 4\n", "expected v, e or f"),
        ("9999999999999 0 0\n", "at most"),
    ] {
        let error = read_axis(file.as_bytes(), AxisFormat::Ma)
            .unwrap_err()
            .to_string();
        assert!(error.contains(part), "{file:?}: {error}");
    }
    let json = br#"{"balls":[[0,0,0,1]],"edges":[[0,1]]}"#;
    assert!(read_axis(json, AxisFormat::Json)
        .unwrap_err()
        .to_string()
        .contains("edge 0"));
    let error = read_axis(b"{\n\"balls\": 1}", AxisFormat::Json).unwrap_err();
    assert!(error.to_string().starts_with("line 2, column"), "{error}");
}

fn polar_balls() -> Vec<PolarBall> {
    let ball = |k: u32| PolarBall {
        ball: Ball::new([f64::from(k), 0.1, 0.2], f64::from(k)),
        side: if k % 2 == 0 { Side::Inner } else { Side::Outer },
        sample: if k == 2 { NONE } else { k },
    };
    (0..4).map(ball).collect()
}

#[test]
fn balls_come_back_the_same() {
    let balls = polar_balls();
    for options in [WriteOptions::default(), ascii()] {
        let mut file = Vec::new();
        write_balls(&mut file, &balls, &options).unwrap();
        assert_eq!(read_balls(&file).unwrap(), balls);
    }
    let mesh = written(
        MeshFormat::Ply,
        &solid(),
        &MeshAttributes::default(),
        &WriteOptions::default(),
    );
    assert!(read_balls(&mesh)
        .unwrap_err()
        .to_string()
        .contains("property radius"));
}

// ---- damage -------------------------------------------------------------

/// Small valid files of every kind.
fn seeds() -> Vec<Vec<u8>> {
    let mesh = solid();
    let mut files = Vec::new();
    for options in [WriteOptions::default(), ascii()] {
        for format in [
            MeshFormat::Ply,
            MeshFormat::Obj,
            MeshFormat::Off,
            MeshFormat::Stl,
            MeshFormat::Json,
        ] {
            let colours = [[1, 2, 3, 4]; 8];
            let with = MeshAttributes {
                colours: Some(&colours),
                ..MeshAttributes::default()
            };
            files.push(written(format, &mesh, &with, &options));
        }
        for format in [AxisFormat::Ma, AxisFormat::Ply, AxisFormat::Json] {
            files.push(written_axis(format, &axis(), &options));
        }
        let mut balls = Vec::new();
        write_balls(&mut balls, &polar_balls(), &options).unwrap();
        files.push(balls);
    }
    let dict = "{'descr': '<f4', 'fortran_order': True, 'shape': (3, 4), }\n";
    files.push(npy(dict, &[7; 48]));
    for text in [
        "x,y,z,\"nx\",ny,nz\n1,2,3,0,0,1\n4.5,-1e3,.5,0,1,0\n",
        "# c\nd 1 1 1\np 1 2 3\np 4 5 6\n",
        "2\n1 2 3 -7 4 5 6\n1 2 3 8 9 0 1\n1\n7 8 9 1 2 3 4\n",
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty list uchar int l\nproperty float y\nproperty float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n1 2 0 0 2 3\n1 0 2 3\n5 0 1 0 -1 1\n",
        "STCNOFF\n1 0\n0 0 0 0 0 1 1 0 0 1 .5 .5\n",
    ] {
        files.push(text.as_bytes().to_vec());
    }
    files
}

/// Reads as everything: what matters is that it ends, without a panic.
fn read_every_way(bytes: &[u8]) {
    CloudFormat::sniff(bytes);
    MeshFormat::sniff(bytes);
    for format in [
        CloudFormat::Ply,
        CloudFormat::Obj,
        CloudFormat::Off,
        CloudFormat::Text,
        CloudFormat::Stl,
        CloudFormat::Npy,
    ] {
        for options in [PLAIN, SKIP] {
            match read_cloud(bytes, format, &options) {
                Ok(cloud) => {
                    let n = cloud.points.len();
                    assert!(n > 0 && cloud.points.iter().flatten().all(|c| c.is_finite()));
                    assert!(cloud.normals.is_none_or(|v| v.len() == n));
                    assert!(cloud.colours.is_none_or(|v| v.len() == n));
                    assert!(cloud.scalars.iter().all(|s| s.values.len() == n));
                }
                Err(e) => assert!(!e.to_string().is_empty()),
            }
        }
    }
    for format in [
        MeshFormat::Ply,
        MeshFormat::Obj,
        MeshFormat::Off,
        MeshFormat::Stl,
        MeshFormat::Json,
    ] {
        if let Ok(mesh) = read_mesh(bytes, format) {
            assert!(mesh
                .corners
                .iter()
                .all(|&v| (v as usize) < mesh.vertices.len()));
            assert!(mesh.faces().all(|f| f.len() >= 3));
        }
    }
    for format in [AxisFormat::Ma, AxisFormat::Ply, AxisFormat::Json] {
        if let Ok(shape) = read_axis(bytes, format) {
            assert_eq!(shape.ids.len(), shape.balls.len());
        }
    }
    let _ = read_balls(bytes);
}

#[test]
fn every_truncation_ends_well() {
    for file in seeds() {
        for end in 0..=file.len() {
            read_every_way(&file[..end]);
        }
    }
}

#[test]
fn random_damage_ends_well() {
    let mut state = 0x2545_f491_4f6c_dd1du64;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state as usize
    };
    let spice = b"0123456789-+.,; \t\n\r#/\\enai\"'p\x00\xff\x7f(){}[]";
    for file in seeds() {
        for _ in 0..400 {
            let mut damaged = file.clone();
            for _ in 0..1 + random() % 3 {
                let at = random() % damaged.len();
                match random() % 4 {
                    0 => damaged[at] = random() as u8,
                    1 => damaged[at] = spice[random() % spice.len()],
                    2 => drop(damaged.remove(at)),
                    _ => damaged.insert(at, spice[random() % spice.len()]),
                }
                if damaged.is_empty() {
                    break;
                }
            }
            read_every_way(&damaged);
        }
    }
}
