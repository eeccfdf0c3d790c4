//! Fewer and better triangles: vertices that are no samples go where the
//! surface hardly moves, and edges are turned where that makes better angles.
//!
//! Most vertices of the power crust are no samples but power vertices, a hair
//! from a sample or from each other, and no measurement of the surface. One
//! goes, drawn into the neighbour that leaves the best triangles, if it lies
//! within a tolerance of the triangles that take its place and no triangle
//! turns by much. Along an edge of the solid that is all that may happen: its
//! vertices are drawn along it and never off it, so edges that the power
//! faces found between samples stay. The distances add up in the vertices
//! around, so that many small moves do not make a large one.

use super::mend_mesh::{next, prev, TriMesh};
use super::raw::NONE;
use crate::context::{Cancelled, Context, Stage};
use crate::geom::vec3::plain::{dist_sq, dot, larger, norm, norm_sq, smaller};
use crate::geom::vec3::{add, cross, scale, sub};
use crate::geom::Point;
use rayon::prelude::*;

/// The least cosine of the angle by which a triangle may turn.
const TURN: f64 = 0.7;
/// The same against the mean normal, for needles, whose own says nothing.
const NEEDLE_TURN: f64 = 0.3;
/// Triangles this good (height over longest side) need not be kept as good.
const GOOD: f64 = 0.2;
/// Edges of triangles this good stay.
const FINE: f64 = 0.5;
/// Rounds of collapsing and turning.
const ROUNDS: usize = 3;

/// What coarsening did.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Coarsened {
    pub collapsed: usize,
    pub flipped: usize,
}

impl std::ops::AddAssign for Coarsened {
    fn add_assign(&mut self, more: Coarsened) {
        self.collapsed += more.collapsed;
        self.flipped += more.flipped;
    }
}

/// Coarsens `mesh`; `tolerance` says how far the surface may move at each
/// vertex.
pub(super) fn coarsen(
    mesh: &mut TriMesh,
    tolerance: &[f64],
    cx: &Context,
) -> Result<Coarsened, Cancelled> {
    Work::new(mesh, tolerance).run(cx)
}

/// [`coarsen`] where the tolerance is not zero, and nowhere else.
pub(super) fn coarsen_some(
    mesh: &mut TriMesh,
    tolerance: &[f64],
    cx: &Context,
) -> Result<Coarsened, Cancelled> {
    let mut work = Work::new(mesh, tolerance);
    for (v, &tolerance) in tolerance.iter().enumerate() {
        work.todo[v] &= tolerance > 0.0;
        work.fresh[v] = u8::from(tolerance > 0.0);
    }
    work.run(cx)
}

/// Coarsening under way.
pub(super) struct Work<'a> {
    mesh: &'a mut TriMesh,
    tolerance: &'a [f64],
    /// Vertices all of whose triangles are in the mesh: the others and their neighbours stay.
    pub whole: Vec<bool>,
    /// How far the surface has moved at each vertex.
    pub moved: Vec<f64>,
    /// Vertices to look at.
    pub todo: Vec<bool>,
    /// Vertices to look at that stayed for their neighbours.
    pub put_off: Vec<u32>,
    round: u8,
    /// The last round that changed triangles at each vertex, one more where
    /// edges were turned: the next looks at them too. The first looks where this is 1 or more.
    pub fresh: Vec<u8>,
    fan: Vec<u32>,
    ring: Ring,
}

impl Work<'_> {
    pub fn new<'a>(mesh: &'a mut TriMesh, tolerance: &'a [f64]) -> Work<'a> {
        let todo = mesh.samples.iter().map(|&s| s == NONE).collect();
        Work {
            mesh,
            tolerance,
            whole: vec![true; tolerance.len()],
            moved: vec![0.0; tolerance.len()],
            todo,
            put_off: Vec::new(),
            round: 1,
            fresh: vec![1; tolerance.len()],
            fan: Vec::new(),
            ring: Ring::default(),
        }
    }

    pub fn run(&mut self, cx: &Context) -> Result<Coarsened, Cancelled> {
        let mut done = Coarsened::default();
        for round in 1..=ROUNDS {
            self.round = round as u8;
            let mut collapsed = 0;
            for v in 0..self.todo.len() as u32 {
                if v % 65536 == 0 {
                    cx.advance(Stage::Crust, 1, 3)?;
                }
                if std::mem::take(&mut self.todo[v as usize]) && self.collapse(v) {
                    collapsed += 1;
                    for &w in &self.ring.vertices {
                        self.todo[w as usize] = self.mesh.samples[w as usize] == NONE;
                    }
                }
            }
            cx.advance(Stage::Crust, 1, 3)?;
            let flipped = self.flips();
            done += Coarsened { collapsed, flipped };
            if collapsed == 0 {
                break;
            }
        }
        Ok(done)
    }

    /// Draws `v` into the best of its neighbours, if there is one.
    fn collapse(&mut self, v: u32) -> bool {
        let limit = self.tolerance[v as usize] - self.moved[v as usize];
        if limit <= 0.0 {
            return false;
        }
        if !self.whole[v as usize] {
            self.put_off.push(v);
            return false;
        }
        self.mesh.fan(v, &mut self.fan);
        if self.fan.len() < 3 {
            return false;
        }
        let inside = |&h: &u32| self.whole[self.mesh.head(h) as usize];
        if !self.fan.iter().all(inside) {
            self.put_off.push(v);
            return false;
        }
        self.ring.gather(self.mesh, v, &self.fan, limit);
        let mut best = (self.ring.worst.min(GOOD * GOOD), 0.0, NONE);
        for (j, &h) in self.fan.iter().enumerate() {
            let Some((quality, distance_sq)) = self.ring.try_collapse(j, best.0, limit) else {
                continue;
            };
            if self.mesh.can_collapse(h, &self.ring.vertices) {
                best = (quality, distance_sq, h);
            }
        }
        let (_, distance_sq, h) = best;
        if h == NONE {
            return false;
        }
        let total = self.moved[v as usize] + distance_sq.sqrt();
        self.mesh.collapse(h, &self.fan);
        for &w in &self.ring.vertices {
            let moved = &mut self.moved[w as usize];
            *moved = moved.max(total);
            self.fresh[w as usize] = self.round;
        }
        true
    }

    /// Turns edges of triangles that are new if that makes better ones;
    /// returns how many.
    fn flips(&mut self) -> usize {
        let mut flipped = 0;
        let mesh = &*self.mesh;
        let mut qualities: Vec<f32> = (0..mesh.tris.len() as u32)
            .into_par_iter()
            .map(|t| match mesh.alive(t) {
                true => quality(&mesh.place(t)) as f32,
                false => f32::INFINITY,
            })
            .collect();
        for h in 0..self.mesh.twin.len() as u32 {
            let t = self.mesh.twin(h);
            if h > t || t == NONE || !self.mesh.alive(h / 3) {
                continue;
            }
            let before = f64::from(qualities[h as usize / 3].min(qualities[t as usize / 3]));
            if before > FINE * FINE
                || !(self.is_new(h / 3) || self.is_new(t / 3))
                || ![h, t, prev(h), prev(t)]
                    .iter()
                    .all(|&g| self.whole[self.mesh.tail(g) as usize])
                || !self.flip_helps(h, before)
                || !self.mesh.can_flip(h)
            {
                continue;
            }
            for g in [h, next(h), prev(h), prev(t)] {
                let v = self.mesh.tail(g);
                self.todo[v as usize] |= self.mesh.samples[v as usize] == NONE;
                self.fresh[v as usize] = self.round + 1;
            }
            self.mesh.flip(h);
            for t in [h / 3, t / 3] {
                qualities[t as usize] = quality(&self.mesh.place(t)) as f32;
            }
            flipped += 1;
        }
        flipped
    }

    /// Whether a triangle may have changed since edges were last turned.
    fn is_new(&self, t: u32) -> bool {
        let corners = self.mesh.tris[t as usize];
        corners
            .iter()
            .all(|&v| self.fresh[v as usize] >= self.round)
    }

    /// Whether turning the edge of `h` is within the tolerance and makes
    /// triangles better than the squared quality `before`.
    fn flip_helps(&self, h: u32, before: f64) -> bool {
        let mesh = &*self.mesh;
        let t = mesh.twin(h);
        let ids = [
            mesh.tail(h),
            mesh.head(h),
            mesh.tail(prev(h)),
            mesh.tail(prev(t)),
        ];
        let [u, v, a, b] = ids.map(|v| mesh.at(v));
        let helps = |t: &[Point; 3]| quality(t) > 1.2 * before;
        if !helps(&[b, a, u]) || !helps(&[a, b, v]) {
            return false;
        }
        let tolerance = ids
            .iter()
            .map(|&v| self.tolerance[v as usize] - self.moved[v as usize]);
        let tolerance = tolerance.fold(f64::INFINITY, f64::min);
        // The distance between the lines of the two diagonals.
        let normal = cross(sub(v, u), sub(a, b));
        let size = norm(normal);
        if size <= 0.0 || dot(sub(a, u), normal).abs() > tolerance * size {
            return false;
        }
        let mean = add(area(&[u, v, a]).0, area(&[v, u, b]).0);
        [[b, a, u], [a, b, v]].iter().all(|t| {
            let normal = area(t).0;
            !turns(dot(normal, mean), TURN, norm_sq(normal) * norm_sq(mean))
        })
    }
}

/// A vertex, its neighbours and the triangles between them, the vertex at the
/// origin. All lists but the first hold everything twice, so that indices may
/// run on.
#[derive(Default)]
struct Ring {
    vertices: Vec<u32>,
    /// Where the neighbours are.
    spokes: Vec<Point>,
    /// Triangle `k` lies between neighbours `k` and `k + 1`.
    facets: Vec<Facet>,
    /// Sum of the vector areas.
    mean: Point,
    /// The least squared quality of a triangle.
    worst: f64,
    /// The axis that the mean is closest to, and which way along it.
    axis: usize,
    way: f64,
    /// Seen along that axis all triangles turn the same way.
    star: bool,
}

#[derive(Clone, Copy)]
struct Facet {
    /// Vector area and its squared size.
    normal: Point,
    size: f64,
    /// Squared length of the side opposite the vertex.
    side: f64,
    /// Whether the normal says which way the surface looks.
    fat: bool,
}

impl Ring {
    /// The ring of `v`, whose half-edges are `fan`.
    fn gather(&mut self, mesh: &TriMesh, v: u32, fan: &[u32], limit: f64) {
        let p = mesh.at(v);
        let n = fan.len();
        self.vertices.clear();
        self.vertices.extend(fan.iter().map(|&h| mesh.head(h)));
        self.spokes.clear();
        let spokes = self.vertices.iter().map(|&w| sub(mesh.at(w), p));
        self.spokes.extend(spokes);
        self.spokes.extend_from_within(..);
        self.facets.clear();
        (self.mean, self.worst) = ([0.0; 3], f64::INFINITY);
        let mut length = norm_sq(self.spokes[0]);
        for k in 0..n {
            let (a, b) = (self.spokes[k], self.spokes[k + 1]);
            let normal = cross(a, b);
            let (side, next) = (dist_sq(a, b), norm_sq(b));
            let longest = longest(length, next, side);
            let size = norm_sq(normal);
            self.worst = smaller(self.worst, size / (longest * longest));
            self.mean = add(self.mean, normal);
            // The height over the longest side tells needles.
            let fat = size > limit * limit * longest;
            self.facets.push(Facet {
                normal,
                size,
                side,
                fat,
            });
            length = next;
        }
        let axis = (1..3).fold(0, |best, k| {
            if self.mean[k].abs() > self.mean[best].abs() {
                k
            } else {
                best
            }
        });
        (self.axis, self.way) = (axis, 1f64.copysign(self.mean[axis]));
        self.star = self.facets.iter().all(|f| f.normal[axis] * self.way > 0.0);
        self.facets.extend_from_within(..);
    }

    /// Twice the area of the triangle at the origin seen along the axis.
    #[inline]
    fn turn(&self, a: Point, b: Point) -> f64 {
        let (i, j) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        (a[i] * b[j] - a[j] * b[i]) * self.way
    }

    /// The squared quality of the triangles if the vertex is drawn into
    /// neighbour `j`, and how far the surface moves, squared; `None` if some
    /// are no better than `least` or turn over, or if it moves beyond the
    /// limit.
    fn try_collapse(&self, j: usize, least: f64, limit: f64) -> Option<(f64, f64)> {
        let n = self.vertices.len();
        let to = self.spokes[j];
        let mut quality = f64::INFINITY;
        // Of the new triangle that holds the vertex, seen along the axis.
        let mut below = norm_sq(to);
        let mut star = self.star;
        let mut a = sub(self.spokes[j + 1], to);
        let (mut length, mut left) = (norm_sq(a), self.turn(to, self.spokes[j + 1]));
        for k in j + 1..j + n - 1 {
            let old = &self.facets[k];
            let b = sub(self.spokes[k + 1], to);
            let normal = cross(a, b);
            let (next, after) = (norm_sq(b), self.turn(to, self.spokes[k + 1]));
            let longest = longest(length, next, old.side);
            let size = norm_sq(normal);
            quality = smaller(quality, size / (longest * longest));
            if quality <= least {
                return None;
            }
            let turned = if old.fat {
                turns(dot(normal, old.normal), TURN, size * old.size)
            } else {
                let mean = self.mean;
                turns(dot(normal, mean), NEEDLE_TURN, size * norm_sq(mean))
            };
            if turned {
                return None;
            }
            star &= normal[self.axis] * self.way > 0.0;
            if left >= 0.0 && after <= 0.0 {
                let off = dot(to, normal);
                below = off * off / size;
            }
            (a, length, left) = (b, next, after);
        }
        let moved = match star {
            true => self.moves(j, below, limit * limit),
            false => self.moves_folded(j, limit * limit),
        };
        Some((quality, moved?))
    }

    /// How far the surface moves, squared, if that is within the limit: the
    /// vertex lies `below` off the new triangles, and the middles of the new
    /// edges lie off the old ones over or under them.
    fn moves(&self, j: usize, below: f64, limit: f64) -> Option<f64> {
        let n = self.vertices.len();
        let to = self.spokes[j];
        let mut most = below;
        for k in j + 2..j + n - 1 {
            if most > limit {
                return None;
            }
            let middle = scale(add(to, self.spokes[k]), 0.5);
            let between = match self.turn(to, middle) > 0.0 {
                true => j..k,
                false => k..j + n,
            };
            let mut turn = self.turn(self.spokes[between.start], middle);
            for i in between {
                let next = self.turn(self.spokes[(i + 1) % (2 * n)], middle);
                if turn >= 0.0 && next <= 0.0 {
                    let old = &self.facets[i];
                    let off = dot(middle, old.normal);
                    most = most.max(off * off / old.size);
                    break;
                }
                turn = next;
            }
        }
        (most <= limit).then_some(most)
    }

    /// The same where the triangles do not lie side by side.
    fn moves_folded(&self, j: usize, limit: f64) -> Option<f64> {
        let n = self.vertices.len();
        let to = self.spokes[j];
        // The neighbour itself is a point of the triangles.
        let mut most = norm_sq(to);
        for k in j + 1..j + n - 1 {
            let t = [to, self.spokes[k], self.spokes[k + 1]];
            most = most.min(point_triangle_sq([0.0; 3], &t));
        }
        if most > limit {
            return None;
        }
        for k in j + 2..j + n - 1 {
            let middle = scale(add(to, self.spokes[k]), 0.5);
            let mut off = f64::INFINITY;
            for i in 0..n {
                let t = [[0.0; 3], self.spokes[i], self.spokes[i + 1]];
                off = off.min(point_triangle_sq(middle, &t));
                if off <= most {
                    break;
                }
            }
            if off > limit {
                return None;
            }
            most = most.max(off);
        }
        Some(most)
    }
}

/// Whether two vectors make an angle of a smaller cosine than given: `product`
/// is that of their squared lengths.
#[inline]
fn turns(dot: f64, cosine: f64, product: f64) -> bool {
    dot <= 0.0 || dot * dot < cosine * cosine * product
}

/// The squared height over the longest side.
fn quality(t: &[Point; 3]) -> f64 {
    let (normal, longest) = area(t);
    norm_sq(normal) / (longest * longest)
}

/// Twice the vector area, and the square of the longest side.
#[inline]
pub(crate) fn area(t: &[Point; 3]) -> (Point, f64) {
    let (u, v) = (sub(t[1], t[0]), sub(t[2], t[0]));
    let longest = longest(norm_sq(u), norm_sq(v), dist_sq(t[1], t[2]));
    (cross(u, v), longest)
}

/// The largest of three squared lengths, and not zero.
#[inline]
fn longest(a: f64, b: f64, c: f64) -> f64 {
    larger(larger(a, b), larger(c, f64::MIN_POSITIVE))
}

/// The squared distance from a point to a triangle.
pub(crate) fn point_triangle_sq(p: Point, t: &[Point; 3]) -> f64 {
    let normal = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let mut inside = true;
    let mut edges = f64::INFINITY;
    for k in 0..3 {
        let (a, b) = (t[k], t[(k + 1) % 3]);
        let (along, to) = (sub(b, a), sub(p, a));
        if dot(cross(along, to), normal) < 0.0 {
            inside = false;
            let s = (dot(along, to) / norm_sq(along)).clamp(0.0, 1.0);
            edges = edges.min(norm_sq(sub(to, scale(along, s))));
        }
    }
    if inside {
        let off = dot(sub(p, t[0]), normal);
        return off * off / norm_sq(normal).max(f64::MIN_POSITIVE);
    }
    edges
}
