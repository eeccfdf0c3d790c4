//! Power vertices go where the surface is.
//!
//! A vertex that is no sample lies off the surface by about the sampling
//! error `h² / 2r`, for it is made by balls that fit the surface at samples
//! only. The samples know more: each has the direction from the inner to the
//! outer balls at it for a normal. Between a sample `s` and a point `x` of a
//! surface with normals `m` and `n`, `(x - s) · (m + n) / 2` vanishes but for
//! the third order (the trapezoid rule; on circles it is exact), so the mean
//! of it over the samples around says how far off the vertex lies. It moves
//! back along the normal, by at most the sampling error, and only where all
//! normals around agree: at edges of the solid the power vertices are what
//! extends the faces to the edge, and they stay.

use super::mend_coarsen::area;
use super::mend_mesh::TriMesh;
use super::raw::NONE;
use crate::geom::vec3::{add, dist_sq, dot, norm, scale, sub};
use crate::geom::Point;
use rayon::prelude::*;

/// The least cosine between normals that agree.
const AGREE: f64 = 0.9;

/// Triangles less high than this share of their longest side are needles,
/// whose own normals say nothing.
const NEEDLE: f64 = 0.1;

/// Samples leave planes by this share of the size of the mesh: the step of the
/// lattice that tells samples apart, far above rounding.
const HAIR: f64 = 1.0 / (1u64 << 42) as f64;

/// Moves vertices that are no samples by at most `limit`; `outward` tells the
/// direction across each triangle. Returns how many moved.
pub(crate) fn settle(
    mesh: &mut TriMesh,
    outward: &(dyn Fn(u32) -> Option<Point> + Sync),
    limit: &[f64],
    round: &dyn Fn(Point) -> Point,
) -> usize {
    let across: Vec<Option<Point>> = (0..mesh.tris.len() as u32)
        .into_par_iter()
        .map(outward)
        .collect();
    let mut sums = vec![[0.0; 3]; mesh.points.len()];
    for (tri, n) in mesh.tris.iter().zip(&across) {
        for &v in tri {
            let sum = &mut sums[v as usize];
            *sum = add(*sum, n.unwrap_or([0.0; 3]));
        }
    }
    let normals: Vec<Point> = sums.iter().map(|&s| unit(s)).collect();
    let mut smooth = vec![true; normals.len()];
    for (t, (tri, n)) in mesh.tris.iter().zip(&across).enumerate() {
        let (own, longest) = area(&mesh.place(t as u32));
        let size = norm(own);
        for &v in tri {
            let normal = normals[v as usize];
            let agrees = n.is_some_and(|n| dot(n, normal) >= AGREE)
                && (size < NEEDLE * longest || dot(own, normal) >= AGREE * size);
            smooth[v as usize] &= agrees;
        }
    }
    let known = Known {
        mesh,
        normals: &normals,
        smooth: &smooth,
    };
    let moves: Vec<(u32, Point)> = (0..mesh.points.len() as u32)
        .into_par_iter()
        .map_init(<(Vec<u32>, Vec<u32>)>::default, |(fan, near), v| {
            let (off, normal) = known.off(v, fan, near)?;
            let q = sub(mesh.at(v), scale(normal, off));
            (off.abs() <= limit[v as usize]).then_some((v, q))
        })
        .flatten()
        .collect();
    let moves: Vec<(u32, Point)> = moves.into_iter().map(|(v, p)| (v, round(p))).collect();
    for &(v, p) in &moves {
        mesh.shift(v, p);
    }
    moves.len()
}

/// Takes vertices a hair off the plane of their triangles: those that are no
/// samples by about `share` of the length at each, and, if `samples` says so,
/// samples in a plane by about [`HAIR`] of the size of the mesh. Power faces are
/// plane to the last bit, samples of plane parts too, and triangles of one plane
/// that share nothing are then told apart by rounding alone in tests that are
/// not exact (MeshLab's finds crossings).
pub(crate) fn unlevel(
    mesh: &mut TriMesh,
    share: f64,
    samples: bool,
    length: &[f64],
    round: &dyn Fn(Point) -> Point,
) {
    let mut sums = vec![[0.0; 3]; mesh.points.len()];
    for t in (0..mesh.tris.len() as u32).filter(|&t| mesh.alive(t)) {
        let (n, _) = area(&mesh.place(t));
        for v in mesh.tris[t as usize] {
            let sum = &mut sums[v as usize];
            *sum = add(*sum, n);
        }
    }
    let hair = HAIR * extent(&mesh.points);
    let mut fan = Vec::new();
    let mut moves = Vec::new();
    for (v, &sum) in sums.iter().enumerate() {
        if mesh.out[v] == NONE {
            continue;
        }
        let (p, n) = (mesh.points[v], unit(sum));
        mesh.fan(v as u32, &mut fan);
        let heads = fan.iter().map(|&h| mesh.head(h) as usize);
        let far = if mesh.samples[v] == NONE {
            // A part without samples has no spacing: the edges tell.
            let longest = || heads.fold(0.0, |m: f64, w| m.max(dist_sq(p, mesh.points[w])));
            share
                * if length[v] > 0.0 {
                    length[v]
                } else {
                    longest().sqrt()
                }
        } else {
            // Samples that share a coordinate lie in a plane to the last bit,
            // and do no harm.
            let known = heads.clone().filter(|&w| mesh.samples[w] != NONE);
            let exact = (0..3).any(|k| known.clone().all(|w| mesh.points[w][k] == p[k]));
            let mut offs = heads.map(|w| (dot(sub(mesh.points[w], p), n).abs(), length[w]));
            let plane = offs.all(|(off, l)| off <= 4.0 * share * l.max(length[v]));
            if exact || !plane || !samples {
                continue;
            }
            hair
        };
        // In [0.5, 1), up or down.
        let h = (v as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let size = 0.5 + (h >> 12) as f64 / (1u64 << 53) as f64;
        let size = if h & 1 == 0 { size } else { -size };
        moves.push((v as u32, round(add(p, scale(n, size * far)))));
    }
    for (v, p) in moves {
        mesh.shift(v, p);
    }
}

/// The longest side of the box of the points.
fn extent(points: &[Point]) -> f64 {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in points {
        low = [0, 1, 2].map(|k| p[k].min(low[k]));
        high = [0, 1, 2].map(|k| p[k].max(high[k]));
    }
    (0..3).fold(0.0, |most, k| f64::max(most, high[k] - low[k]))
}

/// What is known of the surface at the vertices.
struct Known<'a> {
    mesh: &'a TriMesh,
    normals: &'a [Point],
    smooth: &'a [bool],
}

impl Known<'_> {
    /// How far off the surface vertex `v` lies along the normal there; `None`
    /// for samples and where the normals around do not agree.
    fn off(&self, v: u32, fan: &mut Vec<u32>, near: &mut Vec<u32>) -> Option<(f64, Point)> {
        let Known {
            mesh,
            normals,
            smooth,
        } = *self;
        if mesh.samples[v as usize] != NONE || !smooth[v as usize] {
            return None;
        }
        near.clear();
        mesh.fan(v, fan);
        near.extend(fan.iter().map(|&h| mesh.head(h)));
        let agree =
            |w: u32| smooth[w as usize] && dot(normals[w as usize], normals[v as usize]) >= AGREE;
        if !near.iter().all(|&w| agree(w)) {
            return None;
        }
        for k in 0..near.len() {
            if mesh.samples[near[k] as usize] == NONE {
                mesh.fan(near[k], fan);
                near.extend(fan.iter().map(|&h| mesh.head(h)));
            }
        }
        near.sort_unstable();
        near.dedup();
        if !near.iter().all(|&w| agree(w)) {
            return None;
        }
        near.retain(|&w| mesh.samples[w as usize] != NONE);
        if near.len() < 3 {
            return None;
        }
        let p = mesh.at(v);
        let weight = |w: u32| 1.0 / dist_sq(p, mesh.at(w)).max(f64::MIN_POSITIVE);
        let mut normal = [0.0; 3];
        for &w in near.iter() {
            normal = add(normal, scale(normals[w as usize], weight(w)));
        }
        let normal = unit(normal);
        let (mut off, mut weights) = (0.0, 0.0);
        for &w in near.iter() {
            let both = add(normal, normals[w as usize]);
            off += weight(w) * dot(sub(p, mesh.at(w)), both) / 2.0;
            weights += weight(w);
        }
        Some((off / weights, normal))
    }
}

fn unit(v: Point) -> Point {
    let size = norm(v);
    if size > 0.0 {
        scale(v, 1.0 / size)
    } else {
        v
    }
}
