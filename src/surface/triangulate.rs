//! Triangles for all faces of a crust: closed and manifold like the crust.
//!
//! Triangles stay. Other faces are triangulated on their own (`polygon`), in
//! parallel; what they must not do together is to draw the same diagonal
//! twice, or one that is an edge elsewhere, for that edge would have four
//! triangles. Few do: two faces must have two vertices in common that are not
//! side by side in both. So the pairs are looked for afterwards, and the faces
//! that drew a pair that was taken are done again, one after the other and
//! without it; a face that cannot do without becomes a star around a new
//! vertex, which is joined to nothing else. That also serves vertices of two
//! faces only: just one of the faces can cut them off.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::flat::{collinear, vector_area};
use super::polygon::PolygonTriangulator;
use super::raw::{Crust, NONE};
use crate::geom::vec3::{add, norm, scale};
use crate::geom::Point;
use crate::mesh::PolygonMesh;

/// A crust of triangles that knows the faces they come from.
pub(crate) struct Triangles {
    pub crust: Crust,
    /// Those of face `f` are `starts[f]..starts[f + 1]`.
    pub starts: Vec<u32>,
}

/// The same surface in triangles. Every triangle has the balls of the face it
/// comes from; new vertices lie at no sample.
pub fn triangulate(crust: &Crust) -> Crust {
    triangulate_faces(crust.clone()).crust
}

/// The same, and where the triangles of each face are.
pub(crate) fn triangulate_faces(polygons: Crust) -> Triangles {
    let mesh = &polygons.mesh;
    let mut starts = Vec::with_capacity(mesh.face_count() + 1);
    let mut count = 0;
    starts.push(0);
    for face in mesh.faces() {
        count += face.len().saturating_sub(2) as u32;
        starts.push(count);
    }
    let mut corners = vec![0; 3 * count as usize];
    let mut again = BTreeSet::from_iter(fill(mesh, &starts, &mut corners));
    let pairs = Pairs::of(&corners, mesh.vertices.len());
    let draft = Draft {
        mesh,
        starts: &starts,
        corners: &corners,
        pairs: &pairs,
    };
    again.extend(draft.clashes());
    if !again.is_empty() {
        let redone = draft.redo(&again);
        return with(polygons, &starts, &corners, redone);
    }
    drop(pairs);
    finish(polygons, starts, corners)
}

/// Faces that one task triangulates.
const BLOCK: usize = 1024;

/// Triangulates every face on its own into its part of the corners; those that
/// need a new vertex are listed and have a fan, so that their sides are there.
fn fill(mesh: &PolygonMesh, starts: &[u32], corners: &mut [u32]) -> Vec<u32> {
    let faces = mesh.face_count();
    let mut parts = Vec::with_capacity(faces / BLOCK + 1);
    let mut rest = corners;
    for from in (0..faces).step_by(BLOCK) {
        let to = (from + BLOCK).min(faces);
        let (part, others) = rest.split_at_mut(3 * (starts[to] - starts[from]) as usize);
        parts.push((from..to, part));
        rest = others;
    }
    let failed: Vec<Vec<u32>> = parts
        .into_par_iter()
        .map_init(Scratch::default, |scratch, (faces, part)| {
            let mut failed = Vec::new();
            let mut triangles = part.chunks_exact_mut(3);
            for f in faces {
                let face = mesh.face(f);
                let done = scratch.run(mesh, face, |_, _| true);
                if !done {
                    failed.push(f as u32);
                    scratch.polygon.fan_of(face.len());
                }
                for (t, into) in scratch.polygon.triangles.iter().zip(&mut triangles) {
                    into.copy_from_slice(&t.map(|c| face[c as usize]));
                }
            }
            failed
        })
        .collect();
    failed.concat()
}

/// What triangulating one face after the other needs.
#[derive(Default)]
struct Scratch {
    polygon: PolygonTriangulator,
    points: Vec<Point>,
}

impl Scratch {
    /// Triangulates a face without joining vertices that are not `free`.
    fn run(&mut self, mesh: &PolygonMesh, face: &[u32], free: impl Fn(u32, u32) -> bool) -> bool {
        if face.len() == 3 {
            self.polygon.fan_of(3);
            return true;
        }
        self.points.clear();
        let at = |&v: &u32| mesh.vertices[v as usize];
        self.points.extend(face.iter().map(at));
        let free = |a: u32, b: u32| free(face[a as usize], face[b as usize]);
        self.polygon.run(&self.points, free)
    }
}

/// The half-edges of triangles that run from a lower vertex to a higher, by
/// the lower one: each edge of a closed surface once.
struct Pairs {
    starts: Vec<u32>,
    half_edges: Vec<u32>,
}

impl Pairs {
    fn of(corners: &[u32], vertices: usize) -> Pairs {
        let rising = || {
            (0u32..)
                .step_by(3)
                .zip(corners.chunks_exact(3))
                .flat_map(|(h, t)| {
                    let ends = [(t[0], t[1], h), (t[1], t[2], h + 1), (t[2], t[0], h + 2)];
                    ends.into_iter().filter(|(a, b, _)| a < b)
                })
        };
        let mut starts = vec![0u32; vertices + 2];
        for (a, _, _) in rising() {
            starts[a as usize + 2] += 1;
        }
        for v in 2..starts.len() {
            starts[v] += starts[v - 1];
        }
        let mut half_edges = vec![0; starts[vertices + 1] as usize];
        for (a, _, h) in rising() {
            let slot = &mut starts[a as usize + 1];
            half_edges[*slot as usize] = h;
            *slot += 1;
        }
        Pairs { starts, half_edges }
    }

    /// The half-edges that rise from `v`, ascending.
    fn from(&self, v: u32) -> &[u32] {
        let v = v as usize;
        &self.half_edges[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}

/// Faces triangulated without regard to each other.
struct Draft<'a> {
    mesh: &'a PolygonMesh,
    starts: &'a [u32],
    corners: &'a [u32],
    pairs: &'a Pairs,
}

impl Draft<'_> {
    fn head(&self, h: u32) -> u32 {
        self.corners[if h % 3 == 2 { h - 2 } else { h + 1 } as usize]
    }

    fn face(&self, h: u32) -> u32 {
        self.starts.partition_point(|&start| start <= h / 3) as u32 - 1
    }

    /// Whether a half-edge is a side of its face.
    fn is_side(&self, h: u32) -> bool {
        let face = self.mesh.face(self.face(h) as usize);
        let (a, b) = (self.corners[h as usize], self.head(h));
        (0..face.len()).any(|k| face[k] == a && face[(k + 1) % face.len()] == b)
    }

    /// The faces with diagonals that are edges already, by sides or by the
    /// diagonals of earlier faces.
    fn clashes(&self) -> Vec<u32> {
        let blocks = (0..self.mesh.vertices.len() as u32).into_par_iter();
        let doubles = |v: u32| {
            let rising = self.pairs.from(v);
            let double = move |&k: &usize| {
                let head = self.head(rising[k]);
                (0..rising.len()).any(|other| other != k && self.head(rising[other]) == head)
            };
            (0..rising.len()).filter(double).map(move |k| rising[k])
        };
        let doubles: Vec<u32> = blocks.flat_map_iter(doubles).collect();
        let ends = |h: u32| (self.corners[h as usize], self.head(h));
        let loses = |&h: &u32| {
            let mut rivals = doubles.iter().filter(|&&g| g != h && ends(g) == ends(h));
            !self.is_side(h) && rivals.any(|&g| g < h || self.is_side(g))
        };
        doubles
            .iter()
            .filter(|h| loses(h))
            .map(|&h| self.face(h))
            .collect()
    }

    /// Triangulates some faces again, one after the other, so that no pair of
    /// vertices is joined twice. `None` stands for those that need a new
    /// vertex.
    fn redo(&self, again: &BTreeSet<u32>) -> Vec<(u32, Option<Vec<u32>>)> {
        let mut drawn = BTreeSet::new();
        let mut scratch = Scratch::default();
        let mut redone = Vec::with_capacity(again.len());
        for &f in again {
            let face = self.mesh.face(f as usize);
            let stands = |h: u32| !again.contains(&self.face(h)) || self.is_side(h);
            let free = |a: u32, b: u32| {
                let (low, high) = (a.min(b), a.max(b));
                let mut rising = self.pairs.from(low).iter();
                !rising.any(|&h| self.head(h) == high && stands(h)) && !drawn.contains(&(low, high))
            };
            if !scratch.run(self.mesh, face, free) {
                redone.push((f, None));
                continue;
            }
            let named = scratch.polygon.triangles.iter().flatten();
            let corners: Vec<u32> = named.map(|&c| face[c as usize]).collect();
            for t in corners.chunks_exact(3) {
                for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                    drawn.insert((a.min(b), a.max(b)));
                }
            }
            redone.push((f, Some(corners)));
        }
        redone
    }
}

/// The triangles, with those of some faces done again; faces that need a new
/// vertex become stars.
fn with(
    mut polygons: Crust,
    starts: &[u32],
    corners: &[u32],
    redone: Vec<(u32, Option<Vec<u32>>)>,
) -> Triangles {
    let mut all = Vec::with_capacity(corners.len());
    let mut new_starts = Vec::with_capacity(starts.len());
    let mut redone = redone.into_iter().peekable();
    for f in 0..polygons.mesh.face_count() {
        new_starts.push((all.len() / 3) as u32);
        match redone.next_if(|(g, _)| *g as usize == f) {
            None => {
                all.extend_from_slice(&corners[3 * starts[f] as usize..3 * starts[f + 1] as usize])
            }
            Some((_, Some(triangles))) => all.extend(triangles),
            Some((_, None)) => {
                let face = polygons.mesh.face(f);
                let at = |&v: &u32| polygons.mesh.vertices[v as usize];
                let points: Vec<Point> = face.iter().map(at).collect();
                let centre = polygons.mesh.vertices.len() as u32;
                for (k, &v) in face.iter().enumerate() {
                    all.extend([centre, v, face[(k + 1) % face.len()]]);
                }
                polygons.mesh.vertices.push(star_centre(&points));
                polygons.vertex_samples.push(NONE);
            }
        }
    }
    new_starts.push((all.len() / 3) as u32);
    finish(polygons, new_starts, all)
}

fn finish(polygons: Crust, starts: Vec<u32>, corners: Vec<u32>) -> Triangles {
    let mut face_balls = Vec::with_capacity(corners.len() / 3);
    for (f, ends) in starts.windows(2).enumerate() {
        let balls = polygons.face_balls.get(f).copied().unwrap_or([NONE; 2]);
        face_balls.extend((ends[0]..ends[1]).map(|_| balls));
    }
    let crust = Crust {
        mesh: PolygonMesh {
            vertices: polygons.mesh.vertices,
            starts: (0..=corners.len() as u32).step_by(3).collect(),
            corners,
        },
        vertex_samples: polygons.vertex_samples,
        face_balls,
    };
    Triangles { crust, starts }
}

/// A point on no line through a side of the polygon: the mean of its corners
/// or, if need be, points near it.
fn star_centre(points: &[Point]) -> Point {
    let n = points.len();
    let share = 1.0 / n as f64;
    let mean = points
        .iter()
        .fold([0.0; 3], |s, &p| add(s, scale(p, share)));
    let good = |g: Point| (0..n).all(|k| !collinear(g, points[k], points[(k + 1) % n]));
    let toward = |p: Point, t: f64| add(scale(mean, 1.0 - t), scale(p, t));
    let area = vector_area(points.iter().copied());
    let up = scale(area, 1.0 / norm(area).sqrt().max(f64::MIN_POSITIVE));
    let near = points.iter().map(|&p| toward(p, 0.25));
    let above = (1..8).map(|k| add(mean, scale(up, 0.01 * k as f64)));
    let mut choices = std::iter::once(mean).chain(near).chain(above);
    choices.find(|&g| good(g)).unwrap_or(mean)
}
