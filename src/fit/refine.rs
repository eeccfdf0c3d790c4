//! Faces that lie off the surface between their vertices are cut.
//!
//! The middle of an edge tells. Where the surface is smooth there, the middle
//! moves onto it. Where the ends of the edge look different
//! ways and the planes there meet near the edge on the surface, it
//! has a crease there, and the new vertex is put on it: both sides
//! then end at the crease, and the edge between two new vertices of one face runs along
//! it.

use rayon::prelude::*;

use super::field::{looks, meeting, project, Field};
use crate::context::{Cancelled, Context, Stage};
use crate::geom::vec3::plain::{dot, norm};
use crate::geom::vec3::{add, scale, sub};
use crate::geom::Point;
use crate::mesh::PolygonMesh;
use crate::surface::{Crust, NONE};

/// Rounds of cutting.
const ROUNDS: u64 = 7;
/// Ends of an edge look different ways below this cosine.
const CREASE: f64 = 0.9;

/// Cuts the triangles of a closed crust without samples, but for edges of
/// faces whose balls are held.
pub(super) fn refine(
    crust: &mut Crust,
    field: &dyn Field,
    held: &dyn Fn([u32; 2]) -> bool,
    cx: &Context,
) -> Result<(), Cancelled> {
    let mesh = &mut crust.mesh;
    let mut triangles: Vec<[u32; 3]> = mesh.faces().map(|f| [f[0], f[1], f[2]]).collect();
    let mut points = std::mem::take(&mut mesh.vertices);
    let mut balls = std::mem::take(&mut crust.face_balls);
    let outward = looks(&as_mesh(&points, &triangles)).0;
    let mut normals: Vec<Point> = (points.par_iter().zip(outward))
        .map_init(Vec::new, |scratch, (&p, outward)| {
            let foot = field.foot(p, outward, scratch);
            foot.map_or(outward, |f| f.normal)
        })
        .collect();
    let mut fresh = vec![true; triangles.len()];
    for round in 0..ROUNDS {
        cx.advance(Stage::Crust, ROUNDS + round, 3 * ROUNDS)?;
        let stays: Vec<bool> = balls.iter().map(|&pair| held(pair)).collect();
        let sides = Sides::of(&triangles, &fresh, &stays);
        let cuts: Vec<Option<(Point, Point)>> = (sides.edges.par_iter())
            .map_init(Vec::new, |scratch, edge| {
                let [a, b] = edge.map(|v| v as usize);
                let ends = [points[a], points[b]];
                cut(ends, [normals[a], normals[b]], field, scratch)
            })
            .collect();
        let mut number = vec![NONE; cuts.len()];
        for (n, cut) in number.iter_mut().zip(&cuts) {
            if let Some((p, normal)) = cut {
                *n = points.len() as u32;
                points.push(*p);
                normals.push(*normal);
            }
        }
        let before = triangles.len();
        let mut changed = vec![false; before];
        for t in 0..before {
            let new = sides.of_triangle(t).map(|e| match e {
                NONE => NONE,
                edge => number[edge as usize],
            });
            if new != [NONE; 3] {
                changed[t] = true;
                let own = balls[t];
                split(triangles[t], new, &points, |first, part| match first {
                    true => triangles[t] = part,
                    false => {
                        triangles.push(part);
                        balls.push(own);
                    }
                });
            }
        }
        changed.resize(triangles.len(), true);
        fresh = changed;
        if triangles.len() == before {
            break;
        }
    }
    *mesh = as_mesh(&points, &triangles);
    crust.vertex_samples = vec![NONE; mesh.vertices.len()];
    crust.face_balls = balls;
    Ok(())
}

fn as_mesh(points: &[Point], triangles: &[[u32; 3]]) -> PolygonMesh {
    PolygonMesh {
        vertices: points.to_vec(),
        starts: (0..=triangles.len() as u32).map(|t| 3 * t).collect(),
        corners: triangles.as_flattened().to_vec(),
    }
}

/// The edges of triangles that are new, and which of them each triangle has.
struct Sides {
    edges: Vec<[u32; 2]>,
    /// By half-edge: its edge, or `NONE`.
    number: Vec<u32>,
}

impl Sides {
    fn of(triangles: &[[u32; 3]], fresh: &[bool], stays: &[bool]) -> Sides {
        let mut halves: Vec<([u32; 2], u32)> = (triangles.par_iter().enumerate())
            .flat_map_iter(|(t, tri)| {
                (0..3).map(move |k| {
                    let (a, b) = (tri[k], tri[(k + 1) % 3]);
                    ([a.min(b), a.max(b)], (3 * t + k) as u32)
                })
            })
            .collect();
        halves.par_sort_unstable();
        let mut sides = Sides {
            edges: Vec::new(),
            number: vec![NONE; halves.len()],
        };
        for group in halves.chunk_by(|a, b| a.0 == b.0) {
            let any = |of: &[bool]| group.iter().any(|(_, h)| of[*h as usize / 3]);
            if any(fresh) && !any(stays) {
                for (_, h) in group {
                    sides.number[*h as usize] = sides.edges.len() as u32;
                }
                sides.edges.push(group[0].0);
            }
        }
        sides
    }

    /// The edges of a triangle, from its first corner on.
    fn of_triangle(&self, t: usize) -> [u32; 3] {
        [0, 1, 2].map(|k| self.number[3 * t + k])
    }
}

/// Where an edge is cut, with the direction in which the distance grows
/// there; `None` if it lies where it must.
fn cut(
    ends: [Point; 2],
    normals: [Point; 2],
    field: &dyn Field,
    scratch: &mut Vec<(f64, u32)>,
) -> Option<(Point, Point)> {
    let middle = scale(add(ends[0], ends[1]), 0.5);
    let length = norm(sub(ends[0], ends[1]));
    let outward = add(normals[0], normals[1]);
    let foot = field.foot(middle, outward, scratch)?;
    if foot.off.abs() <= field.tolerance() || length <= field.tolerance() {
        return None;
    }
    if let Some(p) = crease(ends, normals, middle) {
        let foot = field.foot(p, outward, scratch)?;
        if norm(sub(p, middle)) < 0.5 * length && foot.off.abs() <= 0.1 * field.tolerance() {
            return Some((p, foot.normal));
        }
    }
    let (p, normal) = project(field, middle, outward, scratch)?;
    (norm(sub(p, middle)) < 0.5 * length).then_some((p, normal))
}

/// The point of the line in which the planes at the ends meet that is
/// nearest to the middle, if they look different ways.
fn crease([a, b]: [Point; 2], [m, n]: [Point; 2], middle: Point) -> Option<Point> {
    match dot(m, n) > CREASE {
        true => None,
        false => meeting([(a, m), (b, n)], middle),
    }
}

/// The triangles that one falls into whose edges have new vertices, where
/// they have any; `each` learns whether it is the first.
fn split(
    [a, b, c]: [u32; 3],
    [ab, bc, ca]: [u32; 3],
    points: &[Point],
    mut each: impl FnMut(bool, [u32; 3]),
) {
    let cut = |v: u32| v != NONE;
    match (cut(ab), cut(bc), cut(ca)) {
        (false, false, false) => each(true, [a, b, c]),
        (true, false, false) => {
            each(true, [a, ab, c]);
            each(false, [ab, b, c]);
        }
        (true, true, true) => {
            each(true, [ab, bc, ca]);
            each(false, [a, ab, ca]);
            each(false, [ab, b, bc]);
            each(false, [ca, bc, c]);
        }
        (true, true, false) => {
            each(true, [ab, b, bc]);
            let length = |v: u32, w: u32| norm(sub(points[v as usize], points[w as usize]));
            if length(a, bc) < length(ab, c) {
                each(false, [a, ab, bc]);
                each(false, [a, bc, c]);
            } else {
                each(false, [a, ab, c]);
                each(false, [ab, bc, c]);
            }
        }
        // Turned until it is one of those above.
        _ => split([b, c, a], [bc, ca, ab], points, each),
    }
}
