//! Triangulation of single polygons.

use super::polygon::PolygonTriangulator;
use crate::geom::vec3::{cross, norm, sub};
use crate::geom::Point;

/// The triangles of a polygon, each from its lowest corner, sorted.
fn run(points: &[Point], allowed: impl Fn(u32, u32) -> bool) -> Option<Vec<[u32; 3]>> {
    let mut polygon = PolygonTriangulator::default();
    if !polygon.run(points, allowed) {
        return None;
    }
    assert_eq!(polygon.triangles.len(), points.len() - 2);
    let first = |t: &[u32; 3]| (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
    let turned = |t: &[u32; 3]| [0, 1, 2].map(|k| t[(k + first(t)) % 3]);
    let mut triangles: Vec<_> = polygon.triangles.iter().map(turned).collect();
    triangles.sort_unstable();
    Some(triangles)
}

fn all(_: u32, _: u32) -> bool {
    true
}

fn area(points: &[Point], t: &[u32; 3]) -> f64 {
    let [a, b, c] = t.map(|c| points[c as usize]);
    norm(cross(sub(b, a), sub(c, a))) / 2.0
}

/// On a tilted plane.
fn lift(flat: &[(f64, f64)]) -> Vec<Point> {
    flat.iter().map(|&(x, y)| [x, y, 2.0 * x - y]).collect()
}

fn total(points: &[Point]) -> f64 {
    let triangles = run(points, all).unwrap_or_default();
    triangles.iter().map(|t| area(points, t)).sum::<f64>() / 6f64.sqrt()
}

#[test]
fn corners_in_a_row_are_no_problem() {
    // A triangle with corners along all three sides.
    let row = [
        (0.0, 0.0),
        (1.0, 0.0),
        (2.0, 0.0),
        (3.0, 0.0),
        (2.0, 1.0),
        (1.0, 2.0),
        (0.0, 3.0),
        (0.0, 1.5),
    ];
    assert!((total(&lift(&row)) - 4.5).abs() < 1e-12);
    // All corners but one on a line.
    let fan = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (5.0, 0.0), (1.0, 1.0)];
    assert!((total(&lift(&fan)) - 2.5).abs() < 1e-12);
}

#[test]
fn dents_are_respected() {
    let arrow = [(0.0, 0.0), (2.0, -1.0), (0.5, 0.0), (2.0, 1.0)];
    assert_eq!(run(&lift(&arrow), all), Some(vec![[0, 1, 2], [0, 2, 3]]));
    let comb: Vec<_> = (0..6)
        .flat_map(|k| [(f64::from(k), 0.0), (f64::from(k) + 0.5, 3.0)])
        .chain([(6.0, 0.0), (6.0, 4.0), (0.0, 4.0)])
        .collect();
    // Six teeth of base 1 and height 3 are missing from 6 by 4.
    assert!((total(&lift(&comb)) - 15.0).abs() < 1e-12);
}

#[test]
fn the_first_corner_does_not_matter() {
    let shape = [
        (0.0, 0.0),
        (3.1, -0.3),
        (5.0, 1.0),
        (5.2, 2.9),
        (3.0, 4.2),
        (0.4, 3.0),
        (-0.6, 1.1),
    ];
    for n in 4..=7u32 {
        let points = lift(&shape[..n as usize]);
        let want = run(&points, all);
        for shift in 1..n {
            let turned: Vec<Point> = (0..n).map(|k| points[((k + shift) % n) as usize]).collect();
            let got = run(&turned, all).map(|triangles| {
                let mut back: Vec<[u32; 3]> = triangles
                    .iter()
                    .map(|t| {
                        let t = t.map(|c| (c + shift) % n);
                        let low = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
                        [0, 1, 2].map(|k| t[(k + low) % 3])
                    })
                    .collect();
                back.sort_unstable();
                back
            });
            assert_eq!(got, want, "{n} corners turned by {shift}");
        }
    }
}

#[test]
fn forbidden_diagonals_are_avoided() {
    let square = lift(&[(0.0, 0.0), (1.0, 0.0), (1.1, 1.0), (0.0, 1.0)]);
    let without = |u: u32, v: u32| move |a: u32, b: u32| (a.min(b), a.max(b)) != (u, v);
    assert_eq!(
        run(&square, without(0, 2)),
        Some(vec![[0, 1, 3], [1, 2, 3]])
    );
    assert_eq!(
        run(&square, without(1, 3)),
        Some(vec![[0, 1, 2], [0, 2, 3]])
    );
    assert_eq!(run(&square, |_, _| false), None);
    let five = lift(&[(0.0, 0.0), (1.0, 0.0), (1.5, 1.0), (0.5, 1.6), (-0.5, 1.0)]);
    for (u, v) in [(0, 2), (0, 3), (1, 3), (1, 4), (2, 4)] {
        let triangles = run(&five, without(u, v)).unwrap_or_default();
        assert_eq!(triangles.len(), 3);
        assert!(!triangles.iter().any(|t| t.contains(&u) && t.contains(&v)));
    }
}

/// Large polygons go through spade; a small one of the same kind does not.
#[test]
fn large_polygons_have_the_right_area() {
    for n in [12u32, 60, 500] {
        for dent in [1.0, 0.6] {
            let star: Vec<_> = (0..n)
                .map(|k| {
                    let angle = f64::from(k) * std::f64::consts::TAU / f64::from(n);
                    let r = if k % 2 == 0 { 1.0 } else { dent };
                    (r * angle.cos(), r * angle.sin())
                })
                .collect();
            let wedge = (std::f64::consts::TAU / f64::from(n)).sin() / 2.0;
            let want = f64::from(n) * wedge * dent;
            assert!((total(&lift(&star)) - want).abs() < 1e-9, "{n} {dent}");
        }
    }
}

/// A corner pulled past its neighbour: no simple projection, yet an answer.
#[test]
fn a_folded_polygon_is_triangulated() {
    let shape = [(0.0, 0.0), (2.0, 0.0), (1.9, -0.01), (2.2, 2.0), (0.1, 2.0)];
    let mut points = lift(&shape);
    points[2][2] += 1e-3;
    assert!(run(&points, all).is_some());
}
