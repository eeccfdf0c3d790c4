//! Fewer triangles: edge collapses in the order of the quadric error, each one
//! made only if the surface stays what it is.
//!
//! A vertex is drawn along an edge onto a neighbour, so every vertex of the
//! result is one of the vertices given, at the same place. That costs some
//! accuracy over free placement and buys three things. Samples stay samples,
//! with all that is attached to them, and so do the faces that are left. No
//! coordinate is ever made, so what was true of the coordinates (rounded to 32
//! bits, say) stays true. And every question about faces that cross is a
//! question about given points, which [`super::clash`] answers exactly.
//!
//! A collapse is refused where it would
//! * join what was not joined: the ends must have just the two vertices
//!   opposite the edge as common neighbours;
//! * turn a face by more than [`TURN`], flatten it, or make a sliver;
//! * make any two faces of the mesh meet where they share nothing, or draw the
//!   surface over another shell.
//!
//! So a mesh without crossings stays without, at every step: nothing has to be
//! undone at the end, and where no collapse is left that is allowed, that is
//! how far this mesh can be reduced. A library (meshopt, C++) would collapse
//! without the last of the three.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::bvh::Cuboid;
use super::clash::{Clash, Reach};
use super::corners::{centred, holds, incidences, next, previous, GONE};
use super::moving::Moving;
use super::quadric::Quadric;
use super::PolygonMesh;
use crate::context::{Cancelled, Context, Stage};
use crate::geom::vec3::{cross, dot, norm, norm_sq, sub};
use crate::geom::Point;

/// Least cosine of the angle by which one collapse may turn a face.
const TURN: f64 = 0.3;
/// Faces with less of the area that an equilateral triangle of the same sides
/// would have are slivers.
const SLIVER: f64 = 0.02;
/// What an edge costs by its length alone: in flat places short edges go
/// first, and triangles stay fat.
const LENGTH: f64 = 1e-6;
/// Removed triangles between two looks at cancellation.
const TICK: usize = 4096;
/// A mesh with fewer triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decimated {
    /// The mesh.
    pub mesh: PolygonMesh,
    /// For each of its vertices the vertex given.
    pub vertices: Vec<u32>,
    /// For each of its faces the face given that it grew out of.
    pub faces: Vec<u32>,
    /// Collapses not made because faces would have met.
    pub refused: u64,
}

/// Why a mesh cannot be reduced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DecimateError {
    /// A face is no triangle of three different vertices that exist.
    #[error("face {face} is no triangle")]
    NoTriangle {
        /// Its number.
        face: u32,
    },
    /// The mesh is not a closed, oriented manifold.
    #[error("the mesh is not a closed manifold at vertex {vertex}")]
    NotManifold {
        /// A vertex where it is not.
        vertex: u32,
    },
    /// The caller's progress handler stopped the work.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for DecimateError {
    fn from(_: Cancelled) -> DecimateError {
        DecimateError::Cancelled
    }
}

/// Reduces a closed manifold of triangles to `faces` triangles, or as near to
/// that as can be without harm. The result is closed and manifold, and free of
/// crossings if the mesh given is.
///
/// # Errors
/// [`DecimateError`]: other meshes, cancellation.
///
/// ```
/// use powercrust::mesh::{check, decimate, CheckOptions, PolygonMesh};
/// use powercrust::Context;
/// // A sheet of 32 by 32 squares, front and back, closed along its rim.
/// let mut mesh = PolygonMesh::default();
/// # let n = 32u32;
/// # for side in [0.0, 1.0] { for y in 0..=n { for x in 0..=n {
/// #     mesh.vertices.push([x as f64, y as f64, side]); } } }
/// # let at = |x: u32, y: u32, s: u32| s * (n + 1) * (n + 1) + y * (n + 1) + x;
/// # let mut square = |a: u32, b: u32, c: u32, d: u32| {
/// #     mesh.push_face(&[a, b, c]); mesh.push_face(&[a, c, d]); };
/// # for y in 0..n { for x in 0..n {
/// #     square(at(x, y, 1), at(x + 1, y, 1), at(x + 1, y + 1, 1), at(x, y + 1, 1));
/// #     square(at(x, y, 0), at(x, y + 1, 0), at(x + 1, y + 1, 0), at(x + 1, y, 0)); } }
/// # for k in 0..n {
/// #     square(at(k, 0, 0), at(k + 1, 0, 0), at(k + 1, 0, 1), at(k, 0, 1));
/// #     square(at(k + 1, n, 0), at(k, n, 0), at(k, n, 1), at(k + 1, n, 1));
/// #     square(at(0, k + 1, 0), at(0, k, 0), at(0, k, 1), at(0, k + 1, 1));
/// #     square(at(n, k, 0), at(n, k + 1, 0), at(n, k + 1, 1), at(n, k, 1)); }
/// let fewer = decimate(&mesh, 12, &Context::default())?;
/// assert!(fewer.mesh.face_count() < 40);
/// assert!((fewer.mesh.volume() - 1024.0).abs() < 1e-9);
/// let report = check(&fewer.mesh, &CheckOptions::default(), &Context::default())?;
/// assert!(report.is_watertight());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn decimate(
    mesh: &PolygonMesh,
    faces: usize,
    cx: &Context,
) -> Result<Decimated, DecimateError> {
    let mut work = Work::new(mesh)?;
    cx.install(|| work.reduce(faces, cx))?;
    Ok(work.result(mesh))
}

/// An entry of the queue: the bits of the cost (not negative, so in order),
/// the half-edge by its ends, and how often the ends had changed.
type Entry = Reverse<(u64, u32, u32, u32, u32)>;

/// A triangle mesh by corners: triangle `t` owns `3t..3t + 3`, half-edge `c`
/// runs from corner `c` to the next one of its triangle.
struct Work {
    /// The vertex of each corner; [`GONE`] in triangles that are gone.
    corners: Vec<u32>,
    twins: Vec<u32>,
    /// A corner at each vertex, [`GONE`] for vertices that are gone.
    corner_at: Vec<u32>,
    /// Positions for exact tests.
    exact: Vec<Point>,
    clash: Clash,
    /// Positions about the middle, of size 1, for measures.
    points: Vec<Point>,
    quadrics: Vec<Quadric>,
    /// How often the quadric of a vertex changed.
    stamps: Vec<u32>,
    /// The shell of each triangle; empty if there is only one.
    shells: Vec<u32>,
    tree: Moving,
    alive: usize,
    refused: u64,
    heap: BinaryHeap<Entry>,
    // Scratch.
    ring: Vec<u32>,
    near: Vec<u32>,
    fan: Vec<[u32; 3]>,
}

impl Work {
    fn new(mesh: &PolygonMesh) -> Result<Work, DecimateError> {
        let count = mesh.vertices.len();
        for (f, face) in mesh.faces().enumerate() {
            let good = match *face {
                [a, b, c] => a != b && b != c && c != a,
                _ => false,
            };
            if !good || face.iter().any(|&v| v as usize >= count) {
                return Err(DecimateError::NoTriangle { face: f as u32 });
            }
        }
        let corners = mesh.corners.clone();
        let (twins, corner_at) = incidences(&corners, count)?;
        let (clash, exact) = Clash::new(&mesh.vertices);
        let points = centred(&mesh.vertices);
        let mut quadrics = vec![Quadric::default(); count];
        let mut boxes = Vec::with_capacity(corners.len() / 3);
        for t in corners.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|v| points[v as usize]);
            let quadric = Quadric::of_plane(a, cross(sub(b, a), sub(c, a)));
            t.iter().for_each(|&v| quadrics[v as usize].add(&quadric));
            boxes.push(Cuboid::of(&[t[0], t[1], t[2]].map(|v| exact[v as usize])));
        }
        let (shells, number) = super::components(mesh);
        Ok(Work {
            alive: corners.len() / 3,
            tree: Moving::new(&boxes),
            shells: if number > 1 { shells } else { Vec::new() },
            stamps: vec![0; count],
            corners,
            twins,
            corner_at,
            exact,
            clash,
            points,
            quadrics,
            refused: 0,
            heap: BinaryHeap::new(),
            ring: Vec::new(),
            near: Vec::new(),
            fan: Vec::new(),
        })
    }

    fn reduce(&mut self, target: usize, cx: &Context) -> Result<(), Cancelled> {
        let given = self.alive;
        let total = given.saturating_sub(target) as u64;
        // What was refused once may be possible when the surface around has
        // changed: start over as long as that gains something.
        let mut before = usize::MAX;
        while self.alive > target && self.alive < before - before / 200 {
            before = self.alive;
            self.fill();
            let mut tick = self.alive;
            while self.alive > target {
                let Some(Reverse((_, u, v, su, sv))) = self.heap.pop() else {
                    break;
                };
                if self.stamps[u as usize] != su || self.stamps[v as usize] != sv {
                    continue;
                }
                if let Some(h) = self.half_edge(u, v) {
                    if self.allowed(h) {
                        self.collapse(h);
                    }
                }
                if tick - self.alive >= TICK {
                    tick = self.alive;
                    cx.advance(Stage::Reduce, (given - self.alive) as u64, total)?;
                }
            }
        }
        cx.advance(Stage::Reduce, total, total)
    }

    fn fill(&mut self) {
        self.heap.clear();
        for c in 0..self.corners.len() as u32 {
            if self.corners[c as usize] != GONE {
                self.push(self.corners[c as usize], self.corners[next(c) as usize]);
            }
        }
    }

    /// Puts the collapse of `u` onto `v` into the queue.
    fn push(&mut self, u: u32, v: u32) {
        let (i, j) = (u as usize, v as usize);
        let mut quadric = self.quadrics[i];
        quadric.add(&self.quadrics[j]);
        let length = norm_sq(sub(self.points[i], self.points[j]));
        let cost = quadric.at(self.points[j]).max(0.0) + LENGTH * length * length;
        let entry = (cost.to_bits(), u, v, self.stamps[i], self.stamps[j]);
        self.heap.push(Reverse(entry));
    }

    /// The corners at the vertex of corner `c`, counterclockwise or not, each
    /// once, `c` first.
    fn star(&self, c: u32) -> impl Iterator<Item = u32> + '_ {
        let mut at = Some(c);
        std::iter::from_fn(move || {
            let now = at?;
            let turned = self.twins[previous(now) as usize];
            at = (turned != c).then_some(turned);
            Some(now)
        })
    }

    /// The half-edge from `u` to `v`.
    fn half_edge(&self, u: u32, v: u32) -> Option<u32> {
        let c = self.corner_at[u as usize];
        if c == GONE {
            return None;
        }
        self.star(c).find(|&c| self.corners[next(c) as usize] == v)
    }

    fn triangle(&self, t: u32) -> [u32; 3] {
        let t = 3 * t as usize;
        [self.corners[t], self.corners[t + 1], self.corners[t + 2]]
    }

    /// Whether half-edge `h` may be collapsed onto its end.
    fn allowed(&mut self, h: u32) -> bool {
        let (u, v) = (self.corners[h as usize], self.corners[next(h) as usize]);
        let twin = self.twins[h as usize];
        let opposite = [h, twin].map(|c| self.corners[previous(c) as usize]);
        if opposite[0] == opposite[1] {
            return false;
        }
        let mut around = std::mem::take(&mut self.ring);
        let ring = |c: u32| self.star(c).map(|c| self.corners[next(c) as usize]);
        around.clear();
        around.extend(ring(h));
        let common = ring(next(h)).filter(|w| around.contains(w)).count();
        self.ring = around;
        if common != 2 {
            return false;
        }
        let mut fan = std::mem::take(&mut self.fan);
        fan.clear();
        let good = self.shapely(h, &mut fan);
        self.fan = fan;
        good && self.free(u, v)
    }

    /// Puts the triangles that the collapse would change, as they would be,
    /// into `fan`; whether they stay in shape.
    fn shapely(&self, h: u32, fan: &mut Vec<[u32; 3]>) -> bool {
        let (u, v) = (self.corners[h as usize], self.corners[next(h) as usize]);
        let at = |w: u32| self.points[w as usize];
        for c in self.star(h) {
            let (a, b) = (
                self.corners[next(c) as usize],
                self.corners[previous(c) as usize],
            );
            if a == v || b == v {
                continue;
            }
            let (old, new) = ([at(u), at(a), at(b)], [at(v), at(a), at(b)]);
            let normal = |t: &[Point; 3]| cross(sub(t[1], t[0]), sub(t[2], t[0]));
            let (before, after) = (normal(&old), normal(&new));
            if dot(before, after) <= TURN * norm(before) * norm(after) {
                return false;
            }
            let shape = |t: &[Point; 3], normal: Point| {
                let sides = (0..3).map(|k| norm_sq(sub(t[k], t[(k + 1) % 3])));
                // 1 for an equilateral triangle.
                2.0 * 3f64.sqrt() * norm(normal) / sides.sum::<f64>()
            };
            let fat = shape(&new, after);
            if fat < SLIVER && fat < shape(&old, before) {
                return false;
            }
            fan.push([v, a, b]);
        }
        true
    }

    /// Whether the triangles of `self.fan`, in place of those at `u`, meet no
    /// other triangle and sweep over none on the way.
    fn free(&mut self, u: u32, v: u32) -> bool {
        let exact = |t: [u32; 3]| t.map(|w| self.exact[w as usize]);
        if self.fan.iter().any(|&t| self.clash.is_flat(&exact(t))) {
            return false;
        }
        for (k, &t) in self.fan.iter().enumerate() {
            let mut others = self.fan[..k].iter();
            if others.any(|&s| self.clash.meet(&self.exact, s, t)) {
                self.refused += 1;
                return false;
            }
        }
        let place = |w: u32| self.exact[w as usize];
        let mut reach = Cuboid::of(&[place(u), place(v), place(v)]);
        for &t in &self.fan {
            let [_, a, b] = exact(t);
            reach = reach.joined(&Cuboid::of(&[a, b, b]));
        }
        self.tree.near(&reach, &mut self.near);
        let changed: Vec<Reach> = self.fan.iter().map(|&t| Reach::of(&exact(t))).collect();
        let own = self.shell(self.corner_at[u as usize] / 3);
        for &n in &self.near {
            let other = self.triangle(n);
            if other.contains(&u) {
                continue;
            }
            let corners = exact(other);
            let box_of_other = Reach::of(&corners);
            let mut touched = changed.iter().zip(&self.fan);
            let meets = touched.any(|(reach, &t)| {
                reach.meets(&box_of_other) && self.clash.meet(&self.exact, t, other)
            });
            let swept = || {
                let tetrahedra = self.fan.iter().map(|&[v, a, b]| [u, v, a, b].map(place));
                self.shell(n) != own && tetrahedra.into_iter().any(|t| holds(&t, corners[0]))
            };
            if meets || swept() {
                self.refused += 1;
                return false;
            }
        }
        true
    }

    fn shell(&self, triangle: u32) -> u32 {
        self.shells.get(triangle as usize).copied().unwrap_or(0)
    }

    fn collapse(&mut self, h: u32) {
        let (u, v) = (self.corners[h as usize], self.corners[next(h) as usize]);
        let twin = self.twins[h as usize];
        let star: Vec<u32> = self.star(h).collect();
        for &c in &star {
            self.corners[c as usize] = v;
        }
        for side in [h, twin] {
            let (x, y) = (
                self.twins[next(side) as usize],
                self.twins[previous(side) as usize],
            );
            self.twins[x as usize] = y;
            self.twins[y as usize] = x;
            for c in [x, y] {
                self.corner_at[self.corners[c as usize] as usize] = c;
            }
        }
        for side in [h, twin] {
            let t = side / 3;
            self.corners[3 * t as usize..3 * t as usize + 3].fill(GONE);
            self.tree.remove(t);
        }
        self.corner_at[u as usize] = GONE;
        self.alive -= 2;
        for c in star
            .into_iter()
            .filter(|&c| self.corners[c as usize] != GONE)
        {
            let t = self.triangle(c / 3).map(|w| self.exact[w as usize]);
            self.tree.place(c / 3, &t);
        }
        let quadric = self.quadrics[u as usize];
        self.quadrics[v as usize].add(&quadric);
        self.stamps[u as usize] += 1;
        self.stamps[v as usize] += 1;
        let mut ring = std::mem::take(&mut self.ring);
        ring.clear();
        let c = self.corner_at[v as usize];
        ring.extend(self.star(c).map(|c| self.corners[next(c) as usize]));
        for &w in &ring {
            self.push(v, w);
            self.push(w, v);
        }
        self.ring = ring;
    }

    fn result(self, given: &PolygonMesh) -> Decimated {
        let mut number = vec![GONE; self.corner_at.len()];
        let mut out = Decimated {
            refused: self.refused,
            ..Decimated::default()
        };
        for (v, _) in (self.corner_at.iter().enumerate()).filter(|(_, &c)| c != GONE) {
            number[v] = out.vertices.len() as u32;
            out.vertices.push(v as u32);
            out.mesh.vertices.push(given.vertices[v]);
        }
        out.mesh.starts.push(0);
        for (f, t) in self.corners.chunks_exact(3).enumerate() {
            if t[0] != GONE {
                let corners = [t[0], t[1], t[2]].map(|v| number[v as usize]);
                out.mesh.push_face(&corners);
                out.faces.push(f as u32);
            }
        }
        out
    }
}
