//! `powercrust query`.

use super::*;

#[test]
fn an_axis_is_asked_at_places() {
    let place = Place::with_torus();
    place.put("places.xyz", "1 0 0\n0 0 0\n1 0 0.2\n9 9 9\n");
    place.run("torus.xyz --mat axis.ma").code(DONE);
    let table = |name: &str| String::from_utf8(place.get(name)).unwrap();
    for input in ["torus.xyz", "axis.ma"] {
        place
            .run(&format!("query {input} --at places.xyz -o values.csv"))
            .code(DONE)
            .says("values.csv: 4 points, 2 inside");
        let text = table("values.csv");
        let rows: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
        assert_eq!(rows[0][3..6], ["side", "distance", "lower"]);
        let sides: Vec<&str> = rows[1..].iter().map(|r| r[3]).collect();
        assert_eq!(sides, ["0", "1", "0", "1"], "{input}");
        // The torus has the radii 1 and 0.4.
        let number = |r: usize, k: usize| rows[r][k].parse::<f64>().unwrap();
        assert!((number(1, 4) + 0.4).abs() < 0.05 && (number(2, 4) - 0.6).abs() < 0.05);
        assert!((number(1, 7) - 0.8).abs() < 0.05);
    }
    let ran = place.run("query axis.ma --at places.xyz -o values.ply --ascii --json -q");
    let told = ran.code(DONE).json();
    assert_eq!((&told["points"], &told["inside"]), (&4.into(), &2.into()));
    assert!(table("values.ply").contains("property double distance"));
    let stream = place.feed("query axis.ma --at - -o -", &place.get("places.xyz"));
    assert_eq!(stream.code(DONE).stdout, place.get("values.csv"));
    place
        .run("simplify-mat axis.ma -o bare.ma --bare")
        .code(DONE);
    place
        .run("query bare.ma --at places.xyz -o values.csv")
        .code(DONE)
        .says("one side only");
}

#[test]
fn questions_that_make_no_sense() {
    let place = Place::with_torus();
    place.put("places.xyz", "3 0 0\n0 0 0\n");
    place.put("bad.xyz", "3 0 0\n0 nan 0\n");
    let before = place.names();
    for (arguments, code, says) in [
        ("torus.xyz -o a.csv", USAGE, "--at"),
        ("torus.xyz --at places.xyz", USAGE, "nowhere to write"),
        (
            "torus.xyz --at places.xyz -o a.obj",
            USAGE,
            "no format of tables",
        ),
        (
            "torus.xyz --at places.xyz -o a.csv --ascii",
            USAGE,
            "no effect",
        ),
        ("- --at - -o a.csv", USAGE, "standard input"),
        (
            "torus.xyz --at places.xyz -o - --json",
            USAGE,
            "more than one",
        ),
        (
            "torus.xyz --at places.xyz -o places.xyz --output-format csv",
            USAGE,
            "overwritten",
        ),
        (
            "torus.xyz --at places.xyz -o a.csv --lambda 3",
            USAGE,
            "--lambda is 3",
        ),
        ("torus.xyz --at gone.xyz -o a.csv", FILE, "gone.xyz"),
        ("torus.xyz --at bad.xyz -o a.csv", UNFIT, "bad.xyz"),
    ] {
        place
            .run(&format!("query {arguments}"))
            .code(code)
            .says(says);
        assert_eq!(place.names(), before, "{arguments}");
    }
}
