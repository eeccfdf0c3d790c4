//! Sheets that touch in a vertex are drawn apart.
//!
//! Where several vertices lie at one place, the solid comes to a point there
//! from several sides: the cones of its sheets have nothing but the place (and
//! perhaps edges from it) in common. A vertex that moves into the kernel of
//! its own cone, so that every triangle at it moves inward, frees its sheet
//! from the others, also along edges at whose other ends the same happens.
//! All but one of the vertices at a place do so; the one that stays, at the
//! sample, is the one whose cone has the least kernel. Whether it helped is
//! for the exact count to say; see `mend_local` for what happens then.

use super::mend_mesh::TriMesh;
use super::raw::NONE;
use crate::geom::vec3::{add, cross, dist_sq, dot, norm, scale, sub};
use crate::geom::Point;

/// How far a vertex moves, in lengths of the shortest edge at it.
const GAP: f64 = 0.02;

/// Draws apart all vertices that lie at one place; the vertices moved.
pub(crate) fn draw_apart(mesh: &mut TriMesh, round: &dyn Fn(Point) -> Point) -> Vec<u32> {
    let mut order: Vec<u32> = (0..mesh.points.len() as u32)
        .filter(|&v| mesh.out[v as usize] != NONE)
        .collect();
    let key = |v: u32| mesh.at(v).map(|x| x + 0.0);
    order.sort_unstable_by(|&v, &w| {
        let (p, q) = (key(v), key(w));
        let place = (0..3).fold(std::cmp::Ordering::Equal, |o, k| {
            o.then(p[k].total_cmp(&q[k]))
        });
        place.then(v.cmp(&w))
    });
    let mut moves: Vec<(u32, Point)> = Vec::new();
    for group in order.chunk_by(|&v, &w| key(v) == key(w)) {
        if group.len() < 2 {
            continue;
        }
        let mut cones: Vec<(f64, u32, Point)> = group
            .iter()
            .map(|&v| {
                let (margin, inward) = kernel(mesh, v);
                (margin, v, inward)
            })
            .collect();
        cones.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for &(_, v, inward) in &cones[1..] {
            let step = GAP * shortest(mesh, v);
            moves.push((v, round(add(mesh.at(v), scale(inward, step)))));
        }
    }
    for &(v, p) in &moves {
        mesh.shift(v, p);
    }
    moves.into_iter().map(|(v, _)| v).collect()
}

/// A direction into the cone at `v` and the least cosine it makes with an
/// inward normal; positive where it lies in the kernel.
pub(crate) fn kernel(mesh: &TriMesh, v: u32) -> (f64, Point) {
    let mut fan = Vec::new();
    mesh.fan(v, &mut fan);
    let mut normals = Vec::with_capacity(fan.len());
    for &h in &fan {
        let [a, b, c] = mesh.place(h / 3);
        let n = cross(sub(b, a), sub(c, a));
        let size = norm(n);
        if size > 0.0 {
            normals.push(scale(n, -1.0 / size));
        }
    }
    let unit = |u: Point| {
        let size = norm(u);
        if size > 0.0 {
            scale(u, 1.0 / size)
        } else {
            u
        }
    };
    let worst = |u: Point| {
        let mut worst = (f64::INFINITY, [0.0; 3]);
        for &n in &normals {
            let d = dot(u, n);
            if d < worst.0 {
                worst = (d, n);
            }
        }
        worst
    };
    let mut u = unit(normals.iter().fold([0.0; 3], |s, &n| add(s, n)));
    let mut best = (f64::NEG_INFINITY, u);
    for k in 0..64 {
        let (margin, n) = worst(u);
        if margin > best.0 {
            best = (margin, u);
        }
        u = unit(add(u, scale(n, 1.0 / (2.0 + f64::from(k)))));
    }
    best
}

/// The length of the shortest edge at `v`.
fn shortest(mesh: &TriMesh, v: u32) -> f64 {
    let mut fan = Vec::new();
    mesh.fan(v, &mut fan);
    let lengths = fan
        .iter()
        .map(|&h| dist_sq(mesh.at(v), mesh.at(mesh.head(h))));
    let least = lengths.filter(|&l| l > 0.0).fold(f64::INFINITY, f64::min);
    if least.is_finite() {
        least.sqrt()
    } else {
        0.0
    }
}
