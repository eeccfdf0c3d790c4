//! Which balls are joined, when only those of one side are known.
//!
//! The power diagram of inner balls alone joins balls across the outside, say
//! those of two fingers of a hand. The **dual complex** (Edelsbrunner 1995:
//! The union of balls and its dual shape) has the simplices whose cells meet
//! *within* the union of the balls: it has the homotopy type of that union.
//!
//! A simplex of the regular triangulation belongs to it if the smallest sphere
//! orthogonal to its balls has no positive squared radius and no further ball
//! is nearer to its centre, or if a larger simplex it is a face of belongs to it. These
//! are decided in floats: where a sphere's size is 0 but for rounding, balls
//! touch in a point.

use std::collections::HashMap;

use crate::geom::vec3::{cross, dot, sub};
use crate::geom::{Ball, Point, Side};
use crate::power::PowerDiagram;
use crate::predicates::Site;
use crate::surface::PowerShape;

/// The dual complex of the balls of one side, with their ids in `balls`.
pub fn complex(power: &PowerDiagram, balls: &[Ball], sides: &[Side], side: Side) -> PowerShape {
    let own = |v: u32| !power.is_sentinel(v) && sides[v as usize] == side;
    let at = |v: u32| &power.sites[v as usize];
    // Every simplex, whether a ball beside it is nearer, and whether it is in.
    let mut tetrahedra: Vec<[u32; 4]> = Vec::new();
    let mut triangles: HashMap<[u32; 3], bool> = HashMap::new();
    let mut edges: HashMap<[u32; 2], bool> = HashMap::new();
    let mut vertices: HashMap<u32, bool> = HashMap::new();
    for cell in &power.complex.cells {
        let mut cell: Vec<u32> = cell.iter().copied().filter(|&v| own(v)).collect();
        cell.sort_unstable();
        let beside = |simplex: &[u32], sphere: Option<(Point, f64)>| match sphere {
            None => true,
            Some((centre, size)) => (cell.iter())
                .filter(|v| !simplex.contains(v))
                .any(|&v| power_of(at(v), at(simplex[0]), centre) < size),
        };
        for (i, &a) in cell.iter().enumerate() {
            let near = vertices.entry(a).or_insert(false);
            *near |= beside(&[a], Some(([0.0; 3], -at(a)[3])));
            for (j, &b) in cell.iter().enumerate().skip(i + 1) {
                let near = edges.entry([a, b]).or_insert(false);
                *near |= beside(&[a, b], of_two(at(a), at(b)));
                for &c in cell.iter().skip(j + 1) {
                    let near = triangles.entry([a, b, c]).or_insert(false);
                    *near |= beside(&[a, b, c], of_three([at(a), at(b), at(c)]));
                }
            }
        }
        if let &[a, b, c, d] = &cell[..] {
            if of_four([at(a), at(b), at(c), at(d)]).is_some_and(|(_, size)| size <= 0.0) {
                tetrahedra.push([a, b, c, d]);
            }
        }
    }
    let mut in_2: Vec<[u32; 3]> = (triangles.into_iter())
        .filter(|(t, near)| !near && of_three(t.map(at)).is_some_and(|(_, size)| size <= 0.0))
        .map(|(t, _)| t)
        .collect();
    for &[a, b, c, d] in &tetrahedra {
        in_2.extend([[b, c, d], [a, c, d], [a, b, d], [a, b, c]]);
    }
    let mut in_1: Vec<[u32; 2]> = (edges.into_iter())
        .filter(|&([a, b], near)| {
            !near && of_two(at(a), at(b)).is_some_and(|(_, size)| size <= 0.0)
        })
        .map(|(e, _)| e)
        .collect();
    for &[a, b, c] in &in_2 {
        in_1.extend([[b, c], [a, c], [a, b]]);
    }
    let mut in_0: Vec<u32> = (vertices.into_iter())
        .filter(|(_, near)| !near)
        .map(|(v, _)| v)
        .collect();
    in_0.extend(in_1.iter().flatten());
    shape(balls, sides, in_0, in_1, in_2, tetrahedra)
}

/// Numbers the balls of the complex.
fn shape(
    balls: &[Ball],
    sides: &[Side],
    vertices: Vec<u32>,
    edges: Vec<[u32; 2]>,
    triangles: Vec<[u32; 3]>,
    tetrahedra: Vec<[u32; 4]>,
) -> PowerShape {
    let sorted = |mut list: Vec<u32>| {
        list.sort_unstable();
        list.dedup();
        list
    };
    let ids = sorted(vertices);
    let mut number = vec![u32::MAX; balls.len()];
    for (n, &b) in ids.iter().enumerate() {
        number[b as usize] = n as u32;
    }
    fn numbered<const N: usize>(list: Vec<[u32; N]>, number: &[u32]) -> Vec<[u32; N]> {
        let mut list: Vec<[u32; N]> = (list.into_iter())
            .map(|s| s.map(|v| number[v as usize]))
            .collect();
        list.sort_unstable();
        list.dedup();
        list
    }
    PowerShape {
        balls: ids.iter().map(|&b| balls[b as usize]).collect(),
        sides: ids.iter().map(|&b| sides[b as usize]).collect(),
        edges: numbered(edges, &number),
        triangles: numbered(triangles, &number),
        tetrahedra: numbered(tetrahedra, &number),
        ids,
        ..PowerShape::default()
    }
}

/// The centre of a site as seen from another one.
fn from(site: &Site, origin: &Site) -> Point {
    [0, 1, 2].map(|k| site[k] - origin[k])
}

/// The power of a point, given relative to `origin`, with respect to a site.
fn power_of(site: &Site, origin: &Site, point: Point) -> f64 {
    let to = sub(point, from(site, origin));
    dot(to, to) - site[3]
}

/// What a plane of equal power of two sites says: `2 (b - a) x = value`, seen
/// from `a`.
fn equal(a: &Site, b: &Site) -> (Point, f64) {
    let u = from(b, a);
    (u, (dot(u, u) - b[3] + a[3]) / 2.0)
}

/// The smallest sphere orthogonal to two balls: its centre as seen from the
/// first and its squared radius.
fn of_two(a: &Site, b: &Site) -> Option<(Point, f64)> {
    let (u, value) = equal(a, b);
    let t = value / dot(u, u);
    let centre = u.map(|x| x * t);
    t.is_finite().then(|| (centre, dot(centre, centre) - a[3]))
}

/// The smallest sphere orthogonal to three balls; none for centres in line.
fn of_three([a, b, c]: [&Site; 3]) -> Option<(Point, f64)> {
    let ((u, p), (v, q)) = (equal(a, b), equal(a, c));
    let normal = cross(u, v);
    let area = dot(normal, normal);
    let (to_u, to_v) = (cross(v, normal), cross(normal, u));
    let centre = [0, 1, 2].map(|k| (to_u[k] * p + to_v[k] * q) / area);
    let size = dot(centre, centre) - a[3];
    size.is_finite().then_some((centre, size))
}

/// The sphere orthogonal to four balls, as seen from the first; none for
/// centres in a plane.
pub fn of_four([a, b, c, d]: [&Site; 4]) -> Option<(Point, f64)> {
    let ((u, p), (v, q), (w, r)) = (equal(a, b), equal(a, c), equal(a, d));
    let (vw, wu, uv) = (cross(v, w), cross(w, u), cross(u, v));
    let volume = dot(u, vw);
    let centre = [0, 1, 2].map(|k| (vw[k] * p + wu[k] * q + uv[k] * r) / volume);
    let size = dot(centre, centre) - a[3];
    size.is_finite().then_some((centre, size))
}
