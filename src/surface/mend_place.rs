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
//!
//! Normals and radii are held in single precision: they only weigh.

use super::mend_coarsen::area;
use super::mend_mesh::TriMesh;
use super::raw::NONE;
use crate::geom::vec3::plain::{dist_sq, dot, norm};
use crate::geom::vec3::{add, scale, sub};
use crate::geom::{Ball, Point};
use rayon::prelude::*;

/// The least cosine between normals that agree.
const AGREE: f64 = 0.9;

/// Triangles less high than this share of their longest side are needles,
/// whose own normals say nothing.
const NEEDLE: f64 = 0.1;

/// Samples leave planes by this share of the size of the mesh: the step of the
/// lattice that tells samples apart, far above rounding.
const HAIR: f64 = 1.0 / (1u64 << 42) as f64;

/// Vertices that one task deals with.
const CHUNK: usize = 8192;

/// What the balls say at each vertex.
pub(crate) struct Sides {
    /// The mean direction from the inner to the outer balls; zero where those
    /// of the triangles do not agree with it.
    normals: Vec<[f32; 3]>,
    /// The least radius of a ball.
    pub radii: Vec<f32>,
}

impl Sides {
    /// `balls` tells the inner and the outer ball of a triangle.
    pub fn of(mesh: &TriMesh, balls: &(dyn Fn(u32) -> [Option<Ball>; 2] + Sync)) -> Sides {
        let facets: Vec<([f32; 3], f32)> = (0..mesh.tris.len() as u32)
            .into_par_iter()
            .map(|t| facet(&mesh.place(t), balls(t)))
            .collect();
        let at = |fan: &mut Vec<u32>, v: u32| {
            mesh.fan(v, fan);
            let (mut sum, mut radius) = ([0.0; 3], f32::INFINITY);
            for h in fan.iter() {
                let (across, least) = facets[*h as usize / 3];
                sum = add(sum, across.map(f64::from));
                radius = radius.min(least);
            }
            let normal = unit(sum).map(|x| x as f32);
            let smooth = (fan.iter()).all(|&h| cosine(facets[h as usize / 3].0, normal) >= AGREE);
            (if smooth { normal } else { [0.0; 3] }, radius)
        };
        let (normals, radii) = (0..mesh.points.len() as u32)
            .into_par_iter()
            .with_min_len(CHUNK)
            .map_init(Vec::new, at)
            .unzip();
        Sides { normals, radii }
    }

    /// Whether the surface is smooth at two vertices and looks the same way.
    fn agree(&self, v: u32, w: u32) -> bool {
        cosine(self.normals[v as usize], self.normals[w as usize]) >= AGREE
    }
}

/// The direction across a triangle, zero where it has none or looks another
/// way, and the lesser radius.
fn facet(place: &[Point; 3], balls: [Option<Ball>; 2]) -> ([f32; 3], f32) {
    let radii = balls.iter().flatten().map(|b| b.radius as f32);
    let radius = radii.fold(f32::INFINITY, f32::min);
    let [Some(inner), Some(outer)] = balls else {
        return ([0.0; 3], radius);
    };
    let across = unit(sub(outer.centre, inner.centre));
    let (own, longest) = area(place);
    let size = norm(own);
    let looks = size < NEEDLE * longest || dot(own, across) >= AGREE * size;
    let across = across.map(|x| x as f32);
    (if looks { across } else { [0.0; 3] }, radius)
}

fn cosine(a: [f32; 3], b: [f32; 3]) -> f64 {
    f64::from(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
}

/// The samples next to each vertex that is none.
pub(crate) struct Near {
    starts: Vec<u32>,
    list: Vec<u32>,
}

impl Near {
    pub fn of(mesh: &TriMesh) -> Near {
        let vertices: Vec<u32> = (0..mesh.points.len() as u32).collect();
        let parts: Vec<(Vec<u32>, Vec<u32>)> = (vertices.par_chunks(CHUNK))
            .map(|part| {
                let (mut fan, mut ends, mut list) = (Vec::new(), Vec::new(), Vec::new());
                for &v in part {
                    if mesh.samples[v as usize] == NONE {
                        mesh.fan(v, &mut fan);
                        let heads = fan.iter().map(|&h| mesh.head(h));
                        list.extend(heads.filter(|&w| mesh.samples[w as usize] != NONE));
                    }
                    ends.push(list.len() as u32);
                }
                (ends, list)
            })
            .collect();
        let mut near = Near {
            starts: Vec::with_capacity(vertices.len() + 1),
            list: Vec::new(),
        };
        near.starts.push(0);
        for (ends, list) in parts {
            let before = near.list.len() as u32;
            near.starts.extend(ends.iter().map(|e| before + e));
            near.list.extend(list);
        }
        near
    }

    fn at(&self, v: u32) -> &[u32] {
        &self.list[self.starts[v as usize] as usize..self.starts[v as usize + 1] as usize]
    }

    /// The spacing at every vertex: that of its sample, else the least of the
    /// nearest along edges; 0 where there are none.
    pub fn spread(&self, mesh: &TriMesh, spacing: impl Fn(u32) -> f64 + Sync) -> Vec<f64> {
        let least = |found: &mut dyn Iterator<Item = f64>| found.fold(f64::INFINITY, f64::min);
        let mut known: Vec<f64> = (0..mesh.points.len() as u32)
            .into_par_iter()
            .map(|v| match mesh.samples[v as usize] {
                NONE => least(&mut (self.at(v).iter()).map(|&w| spacing(mesh.samples[w as usize]))),
                s => spacing(s),
            })
            .collect();
        let mut open: Vec<u32> = (0..known.len() as u32)
            .filter(|&v| known[v as usize] == f64::INFINITY)
            .collect();
        while !open.is_empty() {
            let found: Vec<f64> = (open.par_iter())
                .map_init(Vec::new, |fan, &v| {
                    mesh.fan(v, fan);
                    least(&mut fan.iter().map(|&h| known[mesh.head(h) as usize]))
                })
                .collect();
            for (&v, &l) in open.iter().zip(&found) {
                known[v as usize] = l;
            }
            let before = open.len();
            open.retain(|&v| known[v as usize] == f64::INFINITY);
            if open.len() == before {
                break;
            }
        }
        open.iter().for_each(|&v| known[v as usize] = 0.0);
        known
    }
}

/// Moves vertices that are no samples by at most `limit`. Returns how many
/// moved.
pub(crate) fn settle(
    mesh: &mut TriMesh,
    sides: &Sides,
    near: &Near,
    limit: &[f64],
    round: &(dyn Fn(Point) -> Point + Sync),
) -> usize {
    let even: Vec<bool> = (0..mesh.points.len() as u32)
        .into_par_iter()
        .map_init(Vec::new, |fan, v| {
            mesh.samples[v as usize] == NONE && {
                mesh.fan(v, fan);
                fan.iter().all(|&h| sides.agree(v, mesh.head(h)))
            }
        })
        .collect();
    let known = Known {
        mesh,
        sides,
        near,
        even: &even,
    };
    let moves: Vec<(u32, Point)> = (0..mesh.points.len() as u32)
        .into_par_iter()
        .map_init(Vec::new, |around, v| {
            let (off, normal) = known.off(v, around)?;
            let q = sub(mesh.at(v), scale(normal, off));
            (off.abs() <= limit[v as usize]).then(|| (v, round(q)))
        })
        .filter_map(|moved| moved)
        .collect();
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
    round: &(dyn Fn(Point) -> Point + Sync),
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
    sides: &'a Sides,
    near: &'a Near,
    /// Vertices that are no samples and agree with all next to them.
    even: &'a [bool],
}

impl Known<'_> {
    /// How far off the surface vertex `v` lies along the normal there; `None`
    /// for samples and where the normals around do not agree. `around` is
    /// scratch memory.
    fn off(&self, v: u32, around: &mut Vec<u32>) -> Option<(f64, Point)> {
        let mesh = self.mesh;
        if !self.even[v as usize] {
            return None;
        }
        around.clear();
        around.extend(self.near.at(v));
        let first = mesh.out[v as usize];
        let mut h = first;
        loop {
            let w = mesh.head(h);
            if mesh.samples[w as usize] == NONE {
                if !self.even[w as usize] {
                    return None;
                }
                for s in self.near.at(w) {
                    if !around.contains(s) {
                        around.push(*s);
                    }
                }
            }
            h = mesh.around(h);
            if h == first {
                break;
            }
        }
        if around.len() < 3 || !around.iter().all(|&w| self.sides.agree(v, w)) {
            return None;
        }
        // Along the mean normal: the sum of (p - w) · (mean + normal) / 2.
        let p = mesh.at(v);
        let (mut normal, mut apart) = ([0.0; 3], [0.0; 3]);
        let (mut own, mut weights) = (0.0, 0.0);
        for &w in around.iter() {
            let to = sub(p, mesh.at(w));
            let weight = 1.0 / dot(to, to).max(f64::MIN_POSITIVE);
            let n = self.sides.normals[w as usize].map(f64::from);
            normal = add(normal, scale(n, weight));
            apart = add(apart, scale(to, weight));
            own += weight * dot(to, n);
            weights += weight;
        }
        let normal = unit(normal);
        Some(((dot(apart, normal) + own) / (2.0 * weights), normal))
    }
}

fn unit(v: Point) -> Point {
    let size = norm(v);
    if size > 0.0 && size.is_finite() {
        scale(v, 1.0 / size)
    } else {
        [0.0; 3]
    }
}
