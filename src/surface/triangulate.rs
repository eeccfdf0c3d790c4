//! Triangles for all faces of a crust: closed and manifold like the crust.
//!
//! Triangles stay. Other faces are triangulated on their own (`polygon`);
//! what they must not do together is to draw the same diagonal twice, or one
//! that is an edge elsewhere, for that edge would have four triangles. So a
//! table holds all pairs of vertices that are joined, and a face that cannot
//! do without a pair that is taken becomes a star around a new vertex, which
//! is joined to nothing else. That also serves vertices of two faces only:
//! just one of the faces can cut them off.

use super::flat::{collinear, vector_area};
use super::polygon::PolygonTriangulator;
use super::raw::{Crust, NONE};
use crate::geom::vec3::{add, norm, scale};
use crate::geom::Point;
use crate::mesh::PolygonMesh;

/// The same surface in triangles. Every triangle has the balls of the face it
/// comes from; new vertices lie at no sample.
pub fn triangulate(crust: &Crust) -> Crust {
    triangulate_from(crust).0
}

/// The same, and the face that each triangle comes from.
pub(crate) fn triangulate_from(crust: &Crust) -> (Crust, Vec<u32>) {
    let mut faces = Vec::new();
    let mesh = &crust.mesh;
    let mut joined = Joined::new(mesh);
    let corners = mesh.corners.len();
    let mut out = Crust {
        mesh: PolygonMesh::with_vertices(mesh.vertices.clone()),
        vertex_samples: crust.vertex_samples.clone(),
        face_balls: Vec::with_capacity(corners - corners.min(2 * mesh.face_count())),
    };
    let mut polygon = PolygonTriangulator::default();
    let mut points = Vec::new();
    for (f, face) in mesh.faces().enumerate() {
        let balls = crust.face_balls.get(f).copied().unwrap_or([NONE; 2]);
        let mut push = |out: &mut Crust, triangle: [u32; 3]| {
            out.mesh.push_face(&triangle);
            out.face_balls.push(balls);
            faces.push(f as u32);
        };
        if let [a, b, c] = *face {
            push(&mut out, [a, b, c]);
            continue;
        }
        points.clear();
        points.extend(face.iter().map(|&v| mesh.vertices[v as usize]));
        let free = |a: u32, b: u32| !joined.contains(face[a as usize], face[b as usize]);
        if polygon.run(&points, free) {
            for t in &polygon.triangles {
                let t = t.map(|c| face[c as usize]);
                for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                    // Most are sides of the face, known already.
                    if a < b {
                        joined.insert(a, b);
                    }
                }
                push(&mut out, t);
            }
        } else {
            let centre = out.mesh.vertices.len() as u32;
            out.mesh.vertices.push(star_centre(&points));
            out.vertex_samples.push(NONE);
            for (k, &v) in face.iter().enumerate() {
                push(&mut out, [centre, v, face[(k + 1) % face.len()]]);
            }
        }
    }
    (out, faces)
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

/// The pairs of vertices that are joined by an edge: a hash table that is only
/// looked up.
struct Joined {
    slots: Vec<u64>,
    len: usize,
}

const FREE: u64 = u64::MAX;

impl Joined {
    /// The edges of a mesh, with room for the diagonals of its faces.
    fn new(mesh: &PolygonMesh) -> Joined {
        let diagonals: usize = mesh.faces().map(|face| face.len().saturating_sub(3)).sum();
        let room = mesh.corners.len() / 2 + diagonals + 8;
        let mut joined = Joined {
            slots: vec![FREE; (room + room / 2).next_power_of_two()],
            len: 0,
        };
        for face in mesh.faces() {
            for (k, &v) in face.iter().enumerate() {
                joined.insert(v, face[(k + 1) % face.len()]);
            }
        }
        joined
    }

    fn slot(&self, a: u32, b: u32) -> (usize, u64) {
        let key = u64::from(a.min(b)) << 32 | u64::from(a.max(b));
        let mask = self.slots.len() - 1;
        let mut slot = (key.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 20) as usize & mask;
        while self.slots[slot] != FREE && self.slots[slot] != key {
            slot = (slot + 1) & mask;
        }
        (slot, key)
    }

    fn contains(&self, a: u32, b: u32) -> bool {
        let (slot, key) = self.slot(a, b);
        self.slots[slot] == key
    }

    fn insert(&mut self, a: u32, b: u32) {
        let (slot, key) = self.slot(a, b);
        if self.slots[slot] == key {
            return;
        }
        self.slots[slot] = key;
        self.len += 1;
        if 8 * self.len > 7 * self.slots.len() {
            let old = std::mem::take(&mut self.slots);
            self.slots = vec![FREE; 2 * old.len()];
            for key in old.into_iter().filter(|&key| key != FREE) {
                let (slot, _) = self.slot((key >> 32) as u32, key as u32);
                self.slots[slot] = key;
            }
        }
    }
}
