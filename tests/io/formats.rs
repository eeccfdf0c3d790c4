//! Small OBJ, OFF, STL and NPY files, good and bad.

use super::{message, PLAIN};
use powercrust::io::*;

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

pub fn npy(dict: &str, data: &[u8]) -> Vec<u8> {
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
