//! What is written reads back the same.

use super::{AXES, MESHES, PLAIN};
use powercrust::io::*;
use powercrust::simplify::{Contact, Touching};
use powercrust::surface::NONE;
use powercrust::{Ball, PolarBall, PolygonMesh, PowerShape, Side};

/// A cube with one quadrilateral and awkward numbers.
pub fn solid() -> PolygonMesh {
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

pub fn written(
    format: MeshFormat,
    mesh: &PolygonMesh,
    attributes: &MeshAttributes,
    options: &WriteOptions,
) -> Vec<u8> {
    let mut out = Vec::new();
    write_mesh(&mut out, format, mesh, attributes, options).unwrap();
    out
}

pub fn ascii() -> WriteOptions {
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
    for format in MESHES {
        written(format, &empty, &with, &WriteOptions::default());
    }
}

pub fn axis() -> PowerShape {
    let ball = |k: u8| Ball::new([f64::from(k) * 0.1, 0.25, -1.0], f64::from(k));
    PowerShape {
        balls: (0..5).map(ball).collect(),
        ids: vec![9, 8, 7, 6, 5],
        edges: vec![[0, 1], [0, 4], [2, 3]],
        triangles: vec![[0, 1, 2], [1, 2, 3]],
        tetrahedra: vec![[0, 1, 2, 3]],
        sides: vec![Side::Outer; 5],
        contacts: (0..5).map(|k| contact(f64::from(k) * 0.1)).collect(),
        touching: Touching {
            starts: vec![0, 2, 2, 3, 3, 5],
            samples: vec![4, 8, 15, 16, 23],
        },
        others: (3..6).map(ball).collect(),
        other_contacts: (1..4).map(|k| contact(f64::from(k) / 3.0)).collect(),
    }
}

fn contact(length: f64) -> Contact {
    Contact {
        diameter: length,
        circumradius: 0.5 * length,
        spacing: 0.1,
    }
}

pub fn written_axis(format: AxisFormat, shape: &PowerShape, options: &WriteOptions) -> Vec<u8> {
    let mut out = Vec::new();
    write_axis(&mut out, format, shape, options).unwrap();
    out
}

#[test]
fn axes_come_back_the_same() {
    let shape = axis();
    for options in [WriteOptions::default(), ascii()] {
        for format in AXES {
            let file = written_axis(format, &shape, &options);
            let back = read_axis(&file, format).unwrap();
            let mut expected = shape.clone();
            if format == AxisFormat::Ma {
                expected.ids = vec![0, 1, 2, 3, 4];
            }
            if format != AxisFormat::Json {
                expected.touching = Touching::default();
            }
            assert_eq!(back, expected);
            assert_eq!(AxisFormat::sniff(&file), Some(format));
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
        ("1 0 0\nv 1 2 3 4\nside left\n", "expected inner or outer"),
        ("1 0 0\nv 1 2 3 4\ntet 0 0 0 1\n", "line 3: index 1"),
        ("1 0 0\nv 1 2 3 4\nspan 0 1 -1 0\n", "the length -1"),
        (
            "1 0 0\nv 1 2 3 4\nspan 0 1\n",
            "a line `span` has 4 numbers",
        ),
        ("1 0 0\nv 1 2 3 4\nother 1 2 nan 4\n", "line 3"),
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

pub fn polar_balls() -> Vec<PolarBall> {
    let ball = |k: u32| PolarBall {
        ball: Ball::new([f64::from(k), 0.1, 0.2], f64::from(k)),
        side: if k.is_multiple_of(2) {
            Side::Inner
        } else {
            Side::Outer
        },
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
