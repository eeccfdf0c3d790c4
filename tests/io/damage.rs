//! Truncated and damaged files of every kind: errors, never a panic.

use super::formats::npy;
use super::round_trip::{ascii, axis, polar_balls, solid, written, written_axis};
use super::scanners::{las, lzf, pcd, XYZ};
use super::{AXES, MESHES, PLAIN, SKIP};
use powercrust::io::*;

/// Small valid files of every kind.
fn seeds() -> Vec<Vec<u8>> {
    let mesh = solid();
    let mut files = Vec::new();
    for options in [WriteOptions::default(), ascii()] {
        for format in MESHES {
            let colours = [[1, 2, 3, 4]; 8];
            let with = MeshAttributes {
                colours: Some(&colours),
                ..MeshAttributes::default()
            };
            files.push(written(format, &mesh, &with, &options));
        }
        for format in AXES {
            files.push(written_axis(format, &axis(), &options));
        }
        let mut balls = Vec::new();
        write_balls(&mut balls, &polar_balls(), &options).unwrap();
        files.push(balls);
    }
    let dict = "{'descr': '<f4', 'fortran_order': True, 'shape': (3, 4), }\n";
    files.push(npy(dict, &[7; 48]));
    files.push(pcd(XYZ, 2, "ascii", b"1 2 3\n4 5 6\n"));
    files.push(pcd(XYZ, 3, "binary", &[7; 36]));
    files.push(pcd(XYZ, 3, "binary_compressed", &lzf(&[7; 36])));
    files.push(las(2, 3, 34, &[[1, 2, 3], [4, 5, 6]]));
    files.push(las(4, 7, 36, &[[1, 2, 3]]));
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
        CloudFormat::Pcd,
        CloudFormat::Las,
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
    for format in MESHES {
        if let Ok(mesh) = read_mesh(bytes, format) {
            assert!(mesh
                .corners
                .iter()
                .all(|&v| (v as usize) < mesh.vertices.len()));
            assert!(mesh.faces().all(|f| f.len() >= 3));
        }
    }
    for format in AXES {
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
