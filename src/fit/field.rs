//! Vertices where they belong.
//!
//! A [`Field`] says of a point which way the surface is and how far. A vertex
//! goes there; where it then is nearer to another part it goes on from there:
//! at a crease, which is as near to two parts, it ends on the crease.

use rayon::prelude::*;

use crate::geom::vec3::plain::{dot, norm};
use crate::geom::vec3::{add, cross, scale, sub};
use crate::geom::Point;
use crate::mesh::PolygonMesh;
use crate::surface::Crust;

/// Steps that a vertex takes, at most.
const STEPS: usize = 20;
/// Steps after which it may be going to and fro.
const PATIENCE: usize = 4;
/// A vertex is at its distance when it is off by this share of the tolerance.
const FINE: f64 = 1e-3;

/// Where the surface is to be, as seen from a point.
#[derive(Clone, Copy)]
pub(crate) struct Foot {
    /// The direction in which the distance grows.
    pub normal: Point,
    /// How far the point is outside of the surface.
    pub off: f64,
}

/// What the surface is to be.
pub(crate) trait Field: Sync {
    /// The surface as seen from a point where the present one looks `outward`.
    /// `scratch` is memory that many calls may share.
    fn foot(&self, at: Point, outward: Point, scratch: &mut Vec<(f64, u32)>) -> Option<Foot>;

    /// How far faces may be off.
    fn tolerance(&self) -> f64;

    /// How far a vertex may go, though its edges are shorter.
    fn reach(&self) -> f64;
}

/// Where a point goes, with the direction in which the distance grows there;
/// `None` if it finds no place.
pub(super) fn project(
    field: &dyn Field,
    at: Point,
    outward: Point,
    scratch: &mut Vec<(f64, u32)>,
) -> Option<(Point, Point)> {
    let mut p = at;
    let mut last: Option<(Point, Foot)> = None;
    for step in 0.. {
        let foot = field.foot(p, outward, scratch)?;
        let good = if step < STEPS { FINE } else { 0.5 };
        if foot.off.abs() <= good * field.tolerance() {
            return Some((p, foot.normal));
        }
        if step == STEPS {
            return None;
        }
        let plain = sub(p, scale(foot.normal, foot.off));
        // Going to and fro in a crease: straight to where its sides meet.
        let between = last.filter(|_| step >= PATIENCE).and_then(|(q, before)| {
            let place = |p: Point, foot: &Foot| (sub(p, scale(foot.normal, foot.off)), foot.normal);
            meeting([place(q, &before), (plain, foot.normal)], p)
        });
        last = Some((p, foot));
        p = between.unwrap_or(plain);
    }
    None
}

/// The point nearest to one where two planes meet, each given by a point and
/// its unit normal; `None` if they are nearly the same.
pub(super) fn meeting([(a, m), (b, n)]: [(Point, Point); 2], near: Point) -> Option<Point> {
    let cosine = dot(m, n);
    let sine = 1.0 - cosine * cosine;
    if sine < 1e-3 {
        return None;
    }
    let offs = [dot(m, sub(a, near)), dot(n, sub(b, near))];
    let along = [
        (offs[0] - cosine * offs[1]) / sine,
        (offs[1] - cosine * offs[0]) / sine,
    ];
    Some(add(near, add(scale(m, along[0]), scale(n, along[1]))))
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

/// Moves the vertices of a triangle mesh onto the surface, none by more than
/// its longest edge or the reach of the field; those at faces whose balls are
/// held stay.
pub(super) fn fit(crust: &mut Crust, field: &dyn Field, held: &dyn Fn([u32; 2]) -> bool) {
    let mesh = &mut crust.mesh;
    let (outward, longest) = looks(mesh);
    let far = |l: f64| l.max(field.reach());
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
            let found = project(field, p, outward[v], scratch);
            match found {
                Some((q, _)) if norm(sub(q, p)) <= most[v] => q,
                _ => p,
            }
        })
        .collect();
    mesh.vertices = moved;
}
