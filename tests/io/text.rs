//! Lines of numbers: what is read, what they mean, what is refused.

use super::{message, text, SKIP};
use powercrust::io::*;

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
