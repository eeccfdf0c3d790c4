//! The faces of holes drawn taut, like a membrane over the border: a step
//! beyond the paper, which keeps them as they are.
//!
//! Where nothing was sampled the crust lies between balls that know nothing of each
//! other, and bulges. Here vertices within a hole that are no samples move to where each is
//! the mean of its neighbours, weighted by mean value coordinates (Floater
//! 2003) on the crust as it was; the weights of both directions of an edge are
//! added, so that the system is symmetric, and stay positive: within a convex flat
//! border the faces come to lie side by side. Nothing is joined anew, so parts and
//! handles stay. Elsewhere faces may come to cross: the exact judge looks
//! ([`crate::mesh::check()`]), and a patch with faulty faces goes back half the way it came, at
//! last the whole.

use super::Holes;
use crate::context::{Cancelled, Context};
use crate::geom::vec3::{add, cross, dot, norm, scale, sub};
use crate::geom::{Bounds, Point};
use crate::mesh::halves::Halves;
use crate::mesh::{check, CheckOptions, Finding, PolygonMesh, Report};
use crate::surface::{Crust, NONE};

/// How often a patch goes back half the way before it goes back the whole.
const HALVINGS: i32 = 4;

/// Iterations of the solver at most, and the residual it stops at, as a share
/// of the first.
const ITERATIONS: usize = 2000;
const PRECISION: f64 = 1e-10;

/// What filling came to.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Filled {
    /// Vertices that moved, ascending.
    #[serde(skip)]
    pub vertices: Vec<u32>,
    /// The way that each of [`Holes::patches`] went towards the membrane, as a
    /// share, from 0 to 1.
    pub shares: Vec<f64>,
    /// How far the vertex that moved farthest did, in the input's unit.
    pub farthest: f64,
}

impl Holes {
    /// Draws the faces of holes taut. The crust consists of triangles and is closed, and stays
    /// closed, manifold and free of crossings if it was; with `single` on coordinates
    /// rounded to 32 bits, which those of its vertices must be. Samples stay where they
    /// are.
    ///
    /// # Errors
    /// [`Cancelled`]; the crust is as it was then.
    ///
    /// ```
    /// use powercrust::{holes::HoleSize, reconstruct, Context, Options};
    /// // Half a sphere.
    /// let points: Vec<[f64; 3]> = (0..2000).map(|k| {
    ///     let (z, a) = (k as f64 / 2000.0, k as f64 * 2.399963);
    ///     let r = (1.0f64 - z * z).sqrt();
    ///     [r * a.cos(), r * a.sin(), z]
    /// }).collect();
    /// let mut result = reconstruct(&points, &Options::default(), &Context::default())?;
    /// let holes = result.holes(HoleSize::default());
    /// let filled = holes.fill(&mut result.crust, false, &Context::default())?;
    /// assert_eq!(filled.shares, [1.0]);
    /// let half = 2.0 / 3.0 * std::f64::consts::PI;
    /// assert!((result.crust.mesh.volume() / half - 1.0).abs() < 0.03);
    /// # Ok::<(), powercrust::Error>(())
    /// ```
    pub fn fill(
        &self,
        crust: &mut Crust,
        single: bool,
        context: &Context,
    ) -> Result<Filled, Cancelled> {
        let halves = Halves::of(&crust.mesh);
        let free = self.free(crust, &halves);
        let taut = taut(&crust.mesh, &halves, &free);
        // A vertex between two patches goes with one of them.
        let mut patch_of = vec![NONE; crust.mesh.vertices.len()];
        for &v in &free {
            let face = halves.face[halves.leaving(v)[0] as usize];
            patch_of[v as usize] = self.patch_of_face[face as usize];
        }
        drop(halves);
        let mut mesh = crust.mesh.clone();
        let mut tries = vec![0; self.patches.len()];
        let share = |tries: i32| match tries {
            0..HALVINGS => 0.5f64.powi(tries),
            _ => 0.0,
        };
        loop {
            for (&v, &to) in free.iter().zip(&taut) {
                let from = crust.mesh.vertices[v as usize];
                let share = share(tries[patch_of[v as usize] as usize]);
                let there = add(from, scale(sub(to, from), share));
                mesh.vertices[v as usize] = match (share > 0.0, single) {
                    (false, _) => from,
                    (true, false) => there,
                    (true, true) => there.map(|c| f64::from(c as f32)),
                };
            }
            let all = CheckOptions {
                max_findings: usize::MAX,
                f32: single,
                ..CheckOptions::default()
            };
            let report = check(&mesh, &all, context)?;
            if !self.send_back(&mesh, &report, &patch_of, &mut tries) {
                break;
            }
        }
        let unit = unit_of(&mesh);
        let [old, new] = [&crust.mesh, &mesh].map(|m| &m.vertices);
        let moved = |v: &u32| {
            let way = sub(new[*v as usize], old[*v as usize]);
            norm(way.map(|c| c / unit))
        };
        let filled = Filled {
            shares: tries.into_iter().map(share).collect(),
            farthest: unit * free.iter().map(moved).fold(0.0, f64::max),
            vertices: (free.iter().copied())
                .filter(|&v| new[v as usize] != old[v as usize])
                .collect(),
        };
        crust.mesh = mesh;
        Ok(filled)
    }

    /// Vertices that are no samples and have no face outside of holes.
    fn free(&self, crust: &Crust, halves: &Halves) -> Vec<u32> {
        let within = |v: u32| {
            let mut faces = halves.leaving(v).iter().map(|&h| halves.face[h as usize]);
            let at_all = faces.len() > 0;
            at_all && faces.all(|f| self.patch_of_face[f as usize] != NONE)
        };
        let count = crust.mesh.vertices.len() as u32;
        (0..count)
            .filter(|&v| crust.vertex_samples[v as usize] == NONE && within(v))
            .collect()
    }

    /// Patches with vertices of faulty faces go back some way, all of them where no face tells
    /// which. Whether any did.
    fn send_back(
        &self,
        mesh: &PolygonMesh,
        report: &Report,
        patch_of: &[u32],
        tries: &mut [i32],
    ) -> bool {
        let mut faulty: Vec<u32> = Vec::new();
        for finding in &report.findings {
            match *finding {
                Finding::ZeroArea { face } => faulty.push(face),
                Finding::Crossing { a, b }
                | Finding::Touching { a, b }
                | Finding::Coincident { a, b } => faulty.extend([a, b]),
                _ => {}
            }
        }
        // Faces of which other programs compute no area.
        let unit = unit_of(mesh);
        for (f, &patch) in self.patch_of_face.iter().enumerate() {
            if patch != NONE && twice_area(mesh, f, unit) == [0.0; 3] {
                faulty.push(f as u32);
            }
        }
        let mut patches: Vec<u32> = (faulty.iter())
            .flat_map(|&f| mesh.face(f as usize))
            .map(|&v| patch_of[v as usize])
            .filter(|&p| p != NONE && tries[p as usize] < HALVINGS)
            .collect();
        patches.sort_unstable();
        patches.dedup();
        for &patch in &patches {
            tries[patch as usize] += 1;
        }
        let inside_out = report.counts.inside_out > 0 && tries.iter().any(|&t| t < HALVINGS);
        if patches.is_empty() && inside_out {
            tries.fill(HALVINGS);
            return true;
        }
        !patches.is_empty()
    }
}

/// The diagonal: lengths in it neither overflow nor vanish when squared.
fn unit_of(mesh: &PolygonMesh) -> f64 {
    Bounds::of(&mesh.vertices).map_or(1.0, |b| b.diagonal())
}

/// The vector area of a triangle, twice, in squared units.
fn twice_area(mesh: &PolygonMesh, f: usize, unit: f64) -> Point {
    let [a, b, c] = [0, 1, 2].map(|k| mesh.vertices[mesh.face(f)[k] as usize]);
    let side = |to| sub(to, a).map(|c| c / unit);
    cross(side(b), side(c))
}

/// Where free vertices are the weighted means of their neighbours.
fn taut(mesh: &PolygonMesh, halves: &Halves, free: &[u32]) -> Vec<Point> {
    let unit = unit_of(mesh);
    let origin = mesh.vertices.first().copied().unwrap_or_default();
    let at = |v: u32| sub(mesh.vertices[v as usize], origin).map(|c| c / unit);
    let mut rows = Rows::default();
    let mut right = Vec::with_capacity(free.len());
    for &v in free {
        let (mut known, mut diagonal) = ([0.0; 3], 0.0);
        for &h in halves.leaving(v) {
            let w = halves.head(h);
            let weight = weight(halves, &at, h);
            diagonal += weight;
            match free.binary_search(&w) {
                Ok(k) => rows.entries.push((k as u32, weight)),
                Err(_) => known = add(known, scale(at(w), weight)),
            }
        }
        rows.diagonal.push(diagonal);
        rows.ends.push(rows.entries.len());
        right.push(known);
    }
    let mut places: Vec<Point> = free.iter().map(|&v| at(v)).collect();
    for axis in 0..3 {
        let right: Vec<f64> = right.iter().map(|p| p[axis]).collect();
        let first: Vec<f64> = places.iter().map(|p| p[axis]).collect();
        for (place, x) in places.iter_mut().zip(rows.solve(&right, first)) {
            place[axis] = x;
        }
    }
    let back = |p: Point| add(origin, scale(p, unit));
    places.into_iter().map(back).collect()
}

/// The weight of an edge: of the mean value coordinates of both its ends,
/// positive.
fn weight(halves: &Halves, at: &dyn Fn(u32) -> Point, h: u32) -> f64 {
    /// Lengths and tangents that are out of all proportion are bounded.
    const LEAST: f64 = 1e-9;
    const MOST: f64 = 1e3;
    let twin = halves.twin[h as usize];
    let mut sum = 0.0;
    for side in [h, twin].into_iter().filter(|&s| s != NONE) {
        let apex = at(halves.head(halves.next(side)));
        let [a, b] = [at(halves.tail(side)), at(halves.head(side))];
        for (p, q) in [(a, b), (b, a)] {
            let (u, v) = (sub(q, p), sub(apex, p));
            // tan(x / 2) = sin x / (1 + cos x).
            let (sine, cosine) = (norm(cross(u, v)), dot(u, v));
            let sum_of = norm(u) * norm(v) + cosine;
            sum += match sum_of > 0.0 {
                true => (sine / sum_of).min(MOST),
                false => MOST,
            };
        }
    }
    let length = norm(sub(at(halves.head(h)), at(halves.tail(h))));
    sum.max(LEAST) / length.max(LEAST)
}

/// A symmetric matrix with dominant diagonal: the diagonal, and what is
/// subtracted beside it.
#[derive(Default)]
struct Rows {
    diagonal: Vec<f64>,
    entries: Vec<(u32, f64)>,
    /// Where the entries of each row end.
    ends: Vec<usize>,
}

impl Rows {
    fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut start = 0;
        (self.ends.iter().zip(&self.diagonal).zip(x))
            .map(|((&end, &diagonal), &own)| {
                let row = &self.entries[start..end];
                start = end;
                row.iter()
                    .fold(diagonal * own, |sum, &(k, w)| sum - w * x[k as usize])
            })
            .collect()
    }

    /// Conjugate gradients, preconditioned by the diagonal.
    fn solve(&self, right: &[f64], mut x: Vec<f64>) -> Vec<f64> {
        let inner = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let smooth =
            |r: &[f64]| -> Vec<f64> { r.iter().zip(&self.diagonal).map(|(r, d)| r / d).collect() };
        let ax = self.times(&x);
        let mut r: Vec<f64> = right.iter().zip(&ax).map(|(b, a)| b - a).collect();
        let mut z = smooth(&r);
        let mut way = z.clone();
        let mut size = inner(&r, &z);
        let enough = size * PRECISION * PRECISION;
        for _ in 0..ITERATIONS {
            if size <= enough {
                break;
            }
            let moved = self.times(&way);
            let step = size / inner(&way, &moved);
            if !step.is_finite() {
                break;
            }
            for k in 0..x.len() {
                x[k] += step * way[k];
                r[k] -= step * moved[k];
            }
            z = smooth(&r);
            let next = inner(&r, &z);
            let turn = next / size;
            size = next;
            for (way, z) in way.iter_mut().zip(&z) {
                *way = z + turn * *way;
            }
        }
        x
    }
}
