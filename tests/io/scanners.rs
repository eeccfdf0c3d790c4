//! PCD and LAS in small.

use super::{message, PLAIN, SKIP};
use powercrust::io::*;

/// A PCD file: fields, how the points are written, and those.
pub fn pcd(fields: &str, points: usize, data: &str, body: &[u8]) -> Vec<u8> {
    let mut file = format!("# .PCD v0.7\nVERSION 0.7\n{fields}\nWIDTH {points}\nHEIGHT 1\n");
    file += &format!("VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {data}\n");
    [file.as_bytes(), body].concat()
}

pub const XYZ: &str = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1";
const MANY: &str = "FIELDS x y z _ rgb normal_x normal_y normal_z label fpfh\n\
    SIZE 8 4 4 1 4 4 4 4 2 4\nTYPE F F F U F F F F U F\nCOUNT 1 1 1 3 1 1 1 1 1 2";

/// Bytes in runs of up to 32 as they are: legal LZF without any copy.
pub fn lzf(bytes: &[u8]) -> Vec<u8> {
    let runs = bytes.chunks(32);
    let packed: Vec<u8> = runs
        .flat_map(|r| std::iter::once(r.len() as u8 - 1).chain(r.iter().copied()))
        .collect();
    let sizes = [packed.len() as u32, bytes.len() as u32];
    let sizes = sizes.iter().flat_map(|s| s.to_le_bytes());
    sizes.chain(packed).collect()
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn read_pcd(bytes: &[u8]) -> Result<Cloud, ReadError> {
    read_cloud(bytes, CloudFormat::Pcd, &PLAIN)
}

#[test]
fn pcd_written_three_ways_is_the_same() {
    let points = [[1.0, 2.0, 3.0], [4.5, -5.0, 6e3]];
    let text = pcd(XYZ, 2, "ascii", b"1 2 3\n\n# no point\n4.5 -5 6e3\n");
    let rows = floats(&[1.0, 2.0, 3.0, 4.5, -5.0, 6e3]);
    let runs = floats(&[1.0, 4.5, 2.0, -5.0, 3.0, 6e3]);
    let binary = pcd(XYZ, 2, "binary", &rows);
    let packed = pcd(XYZ, 2, "binary_compressed", &lzf(&runs));
    for file in [text, binary, packed] {
        assert_eq!(CloudFormat::sniff(&file), CloudFormat::Pcd);
        assert_eq!(read_pcd(&file).unwrap().points, points);
    }
}

#[test]
fn pcd_says_where_the_scanner_stood() {
    let plain = pcd(XYZ, 1, "ascii", b"1 2 3\n");
    // What every program writes that knows nothing of it.
    assert_eq!(read_pcd(&plain).unwrap().viewpoint, None);
    let with = |line: &str| {
        let file = String::from_utf8(plain.clone()).unwrap();
        let file = file.replace("VIEWPOINT 0 0 0 1 0 0 0", line);
        read_pcd(file.as_bytes()).unwrap().viewpoint
    };
    assert_eq!(
        with("VIEWPOINT 0 -2.5 1e2 1 0 0 0"),
        Some([0.0, -2.5, 100.0])
    );
    for unclear in [
        "VIEWPOINT",
        "VIEWPOINT 1 2",
        "VIEWPOINT 1 x 2",
        "VIEWPOINT nan 1 2",
    ] {
        assert_eq!(with(unclear), None, "{unclear}");
    }
}

#[test]
fn pcd_fields_by_name() {
    let mut body = Vec::new();
    for k in 0..2 {
        body.extend((0.1 + f64::from(k)).to_le_bytes());
        body.extend(floats(&[2.0, 3.0]));
        body.extend([9, 9, 9, 30, 20, 10, 0]);
        body.extend(floats(&[0.0, 0.0, 1.0]));
        body.extend([7, 1]);
        body.extend(floats(&[8.0, 8.0]));
    }
    let cloud = read_pcd(&pcd(MANY, 2, "binary", &body)).unwrap();
    assert_eq!(cloud.points, [[0.1, 2.0, 3.0], [1.1, 2.0, 3.0]]);
    assert_eq!(cloud.colours.unwrap(), [[10, 20, 30, 255]; 2]);
    assert_eq!(cloud.normals.unwrap(), [[0.0, 0.0, 1.0]; 2]);
    assert_eq!(cloud.scalars.len(), 1);
    assert_eq!(cloud.scalars[0].name, "label");
    assert_eq!(cloud.scalars[0].values, [263.0, 263.0]);
    assert!(cloud.report.notes[0].contains("fpfh"));
    // A colour as the number its bits make, and as three fields.
    let number = f32::from_bits(0x00_0a_14_1e);
    let fields = "FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1";
    let body = format!("0 0 0 {number:e}\n");
    let cloud = read_pcd(&pcd(fields, 1, "ascii", body.as_bytes())).unwrap();
    assert_eq!(cloud.colours.unwrap(), [[10, 20, 30, 255]]);
    let fields = "FIELDS x y z rgba\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1";
    let cloud = read_pcd(&pcd(fields, 1, "ascii", b"0 0 0 2148144158\n")).unwrap();
    assert_eq!(cloud.colours.unwrap(), [[10, 20, 30, 128]]);
    let fields = "FIELDS r g b x y z\nSIZE 1 1 1 4 4 4\nTYPE U U U F F F";
    let cloud = read_pcd(&pcd(fields, 1, "ascii", b"10 20 30 1 2 3\n")).unwrap();
    assert_eq!(cloud.colours.unwrap(), [[10, 20, 30, 255]]);
    assert!(cloud.scalars.is_empty());
}

#[test]
fn pcd_that_is_wrong_is_refused() {
    let twelve = [0; 12];
    let lying = [lzf(&twelve)[..4].to_vec(), vec![255, 255, 0, 0]].concat();
    for (file, part) in [
        (
            pcd(XYZ, 2, "binary", &twelve),
            "2 points announced, 1 found",
        ),
        (
            pcd(XYZ, 2, "ascii", b"1 2 3\n"),
            "2 points announced, 1 found",
        ),
        (pcd(XYZ, 1, "ascii", b"1 2\n"), "line 12: 2 values"),
        (pcd(XYZ, 1, "ascii", b"1 2 3 4\n"), "line 12: 4 values"),
        (pcd(XYZ, 1, "ascii", b"1 2 x\n"), "line 12, column 5"),
        (pcd(XYZ, 1, "ascii", b"1 2 nan\n"), "line 12: the point"),
        (
            pcd(XYZ, 999_999_999, "ascii", b"1 2 3\n"),
            "999999999 points",
        ),
        (pcd(XYZ, 999_999_999, "binary", &twelve), "999999999 points"),
        (pcd(XYZ, 0, "binary", &[]), "no points"),
        (pcd(XYZ, 1, "packed", &twelve), "line 11: expected DATA"),
        (pcd(XYZ, 1, "binary_compressed", &[1]), "sizes"),
        (pcd(XYZ, 1, "binary_compressed", &lying), "compressed bytes"),
        (pcd(XYZ, 2, "binary_compressed", &lzf(&twelve)), "needs 24"),
        (
            pcd("FIELDS x y\nSIZE 4 4\nTYPE F F", 1, "binary", &twelve),
            "field z",
        ),
        (
            pcd("FIELDS x y z\nSIZE 4 4\nTYPE F F F", 1, "binary", &twelve),
            "line 4: 2 values for 3 fields",
        ),
        (
            pcd("FIELDS x y z\nSIZE 4 4 3\nTYPE F F F", 1, "binary", &twelve),
            "F has 4 or 8",
        ),
        (
            pcd("FIELDS x y z\nSIZE 4 4 0\nTYPE F F F", 1, "binary", &twelve),
            "line 4",
        ),
        (b"VERSION 0.7\nPOINTS 3\n".to_vec(), "no DATA line"),
        (b"1 2 3\n".to_vec(), "line 1: `1` is no entry"),
    ] {
        let message = message(read_pcd(&file));
        let file = String::from_utf8_lossy(&file);
        assert!(message.contains(part), "{file}: {message}");
    }
    let two = pcd(
        XYZ,
        2,
        "binary",
        &floats(&[f32::NAN, 0.0, 0.0, 1.0, 2.0, 3.0]),
    );
    let cloud = read_cloud(&two, CloudFormat::Pcd, &SKIP).unwrap();
    assert_eq!(cloud.report.invalid_dropped, 1);
}

/// A LAS file of version 1.`minor` with points of a kind, each of `length` bytes
/// of which the first three integers are the position, in hundredths about
/// (1000, 0, -5).
pub fn las(minor: u8, kind: u8, length: u16, points: &[[i32; 3]]) -> Vec<u8> {
    let size: u16 = if minor == 4 { 375 } else { 227 };
    let mut file = vec![0u8; usize::from(size)];
    file[..4].copy_from_slice(b"LASF");
    file[24] = 1;
    file[25] = minor;
    file[94..96].copy_from_slice(&size.to_le_bytes());
    file[96..98].copy_from_slice(&size.to_le_bytes());
    file[104] = kind;
    file[105..107].copy_from_slice(&length.to_le_bytes());
    let count = points.len() as u32;
    let at = if minor == 4 { 247 } else { 107 };
    file[at..at + 4].copy_from_slice(&count.to_le_bytes());
    for k in 0..3 {
        file[131 + 8 * k..139 + 8 * k].copy_from_slice(&0.01f64.to_le_bytes());
        let offset: f64 = [1000.0, 0.0, -5.0][k];
        file[155 + 8 * k..163 + 8 * k].copy_from_slice(&offset.to_le_bytes());
    }
    for p in points {
        let start = file.len();
        file.extend(p.iter().flat_map(|c| c.to_le_bytes()));
        file.resize(start + usize::from(length), 7);
    }
    file
}

fn read_las(bytes: &[u8]) -> Result<Cloud, ReadError> {
    read_cloud(bytes, CloudFormat::Las, &PLAIN)
}

#[test]
fn las_of_every_kind() {
    let points = [[100, -200, 5], [i32::MIN, i32::MAX, 0]];
    let lengths = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];
    for (kind, &length) in lengths.iter().enumerate() {
        for (minor, longer) in [(2, 0), (4, 0), (4, 5)] {
            let file = las(minor, kind as u8, length + longer, &points);
            assert_eq!(CloudFormat::sniff(&file), CloudFormat::Las);
            let cloud = read_las(&file).unwrap();
            assert_eq!(cloud.points[0], [1001.0, -2.0, 0.05 - 5.0]);
            assert_eq!(cloud.points.len(), 2);
            let coloured = matches!(kind, 2 | 3 | 5 | 7 | 8 | 10);
            // 0x0707 is more than a byte: the upper one counts.
            assert_eq!(cloud.colours, coloured.then(|| vec![[7, 7, 7, 255]; 2]));
            assert_eq!(cloud.scalars[0].name, "intensity");
            assert_eq!(cloud.scalars[0].values, [f64::from(0x0707); 2]);
            assert_eq!(cloud.scalars[1].values, [7.0; 2]);
        }
    }
    let mut eight = las(2, 2, 26, &points);
    for point in 0..2 {
        for channel in 0..3 {
            eight[227 + 26 * point + 21 + 2 * channel] = 0;
        }
    }
    assert_eq!(
        read_las(&eight).unwrap().colours,
        Some(vec![[7, 7, 7, 255]; 2])
    );
}

#[test]
fn las_that_is_wrong_is_refused() {
    let file = || las(2, 0, 20, &[[0; 3]; 3]);
    let with = |at: usize, bytes: &[u8]| {
        let mut file = file();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        file
    };
    for (file, part) in [
        (file()[..200].to_vec(), "within the LAS header"),
        (file()[..280].to_vec(), "3 points announced, 2 found"),
        (with(0, b"LAZF"), "not a LAS file"),
        (with(25, &[9]), "unknown version"),
        (with(104, &[0x83]), "decompress"),
        (with(104, &[11]), "unknown kind"),
        (with(104, &[1]), "shorter than their kind"),
        (with(107, &[0; 4]), "no points"),
        (with(107, &[255; 4]), "supported"),
        (with(96, &[255; 4]), "after the end"),
        (with(131, &[0; 8]), "scale of zero"),
        (with(155, &f64::NAN.to_le_bytes()), "not finite"),
    ] {
        let message = message(read_las(&file));
        assert!(message.contains(part), "{part}: {message}");
    }
    let cloud = read_las(&with(100, &[1])).unwrap();
    assert!(cloud.report.notes[0].contains("1 further records"));
}
