//! Vertices at the exact distance from the crust.
//!
//! A vertex goes along the line to the nearest point of the crust until that
//! is as far away as it must be. Where it then is nearer to another part it
//! goes on from there: at a crease of the offset, where it is as far from two
//! parts, it ends on the crease.

use rayon::prelude::*;

use crate::geom::vec3::plain::{dot, norm};
use crate::geom::vec3::{add, cross, scale, sub};
use crate::geom::Point;
use crate::mesh::{PolygonMesh, Surface};
use crate::surface::Crust;

/// Steps that a vertex takes, at most.
const STEPS: usize = 12;
/// A vertex is at its distance when it is off by this share of the tolerance.
const FINE: f64 = 1e-3;

/// What the surface is to be.
pub(super) struct Target<'a> {
    /// The crust.
    pub base: &'a Surface,
    /// The distance from it, positive outside.
    pub distance: f64,
    /// How far faces may be off.
    pub tolerance: f64,
}

/// The crust as seen from a point.
#[derive(Clone, Copy)]
pub(super) struct Foot {
    /// The direction in which the distance grows.
    pub normal: Point,
    /// By how much it is too large.
    pub off: f64,
}

impl Target<'_> {
    /// The crust as seen from a point where the surface looks `outward`.
    pub fn foot(&self, at: Point, outward: Point, scratch: &mut Vec<(f64, u32)>) -> Option<Foot> {
        let away = sub(at, self.base.nearest(at, scratch)?);
        let far = norm(away);
        // The side is known but near the crust.
        let positive = match 2.0 * far > self.distance.abs() {
            true => self.distance > 0.0,
            false => dot(away, outward) >= 0.0,
        };
        let signed = if positive { far } else { -far };
        let normal = match far > 0.0 {
            true => scale(away, 1.0 / signed),
            false => outward,
        };
        Some(Foot {
            normal,
            off: signed - self.distance,
        })
    }

    /// Where a point goes, with the direction in which the distance grows
    /// there; `None` if it finds no place.
    pub fn project(
        &self,
        at: Point,
        outward: Point,
        scratch: &mut Vec<(f64, u32)>,
    ) -> Option<(Point, Point)> {
        let mut p = at;
        for step in 0.. {
            let foot = self.foot(p, outward, scratch)?;
            let good = if step < STEPS { FINE } else { 0.5 };
            if foot.off.abs() <= good * self.tolerance {
                return Some((p, foot.normal));
            }
            if step == STEPS {
                return None;
            }
            p = sub(p, scale(foot.normal, foot.off));
        }
        None
    }
}

/// The vector areas of the faces at each vertex, as unit vectors, and the
/// longest edge there.
pub(super) fn looks(mesh: &PolygonMesh) -> (Vec<Point>, Vec<f64>) {
    let mut sums = vec![[0.0; 3]; mesh.vertices.len()];
    let mut longest = vec![0.0f64; mesh.vertices.len()];
    for face in mesh.faces() {
        let [a, b, c] = [face[0], face[1], face[2]].map(|v| mesh.vertices[v as usize]);
        let area = cross(sub(b, a), sub(c, a));
        for k in 0..3 {
            let (v, w) = (face[k] as usize, face[(k + 1) % 3] as usize);
            sums[v] = add(sums[v], area);
            let length = norm(sub(mesh.vertices[v], mesh.vertices[w]));
            longest[v] = longest[v].max(length);
            longest[w] = longest[w].max(length);
        }
    }
    for sum in &mut sums {
        let size = norm(*sum);
        if size > 0.0 {
            *sum = scale(*sum, 1.0 / size);
        }
    }
    (sums, longest)
}

/// Moves the vertices of a triangle mesh to the distance, none by more than
/// its longest edge or, for the tips of mitres, the distance itself; those at
/// faces whose balls are held stay.
pub(super) fn fit(crust: &mut Crust, target: &Target, held: &dyn Fn([u32; 2]) -> bool) {
    let mesh = &mut crust.mesh;
    let (outward, longest) = looks(mesh);
    let far = |l: f64| l.max(target.distance.abs());
    let mut most: Vec<f64> = longest.into_iter().map(far).collect();
    for (face, &balls) in mesh.faces().zip(&crust.face_balls) {
        if held(balls) {
            face.iter().for_each(|&v| most[v as usize] = 0.0);
        }
    }
    let moved: Vec<Point> = (mesh.vertices.par_iter().enumerate())
        .map_init(Vec::new, |scratch, (v, &p)| {
            if most[v] == 0.0 {
                return p;
            }
            let found = target.project(p, outward[v], scratch);
            match found {
                Some((q, _)) if norm(sub(q, p)) <= most[v] => q,
                _ => p,
            }
        })
        .collect();
    mesh.vertices = moved;
}
