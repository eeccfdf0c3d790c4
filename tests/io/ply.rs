//! PLY files written out here, good and bad.

use super::{message, PLAIN};
use powercrust::io::*;

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
