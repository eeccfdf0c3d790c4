//! Which closed shells enclose which, decided exactly.
//!
//! From a vertex of a shell a ray runs along the x axis. A shell that it
//! leaves an odd number of times encloses the vertex, and with it the whole
//! shell, provided that shells do not cross or touch. The ray is moved aside
//! by a symbolic amount, `e` in y and `e^2` in z, so that it meets no edge.

use super::bvh::Cuboid;
use super::crossing::{coincidences, flat, Field};
use super::frame::{Frame, Kernel};
use super::measure::{labels, volumes};
use super::soup::{place, Faces, Triangles};
use super::topology::Topology;
use super::PolygonMesh;
use crate::geom::Point;
use rayon::prelude::*;

/// For each shell the number of closed shells around it; `None` for shells
/// that are not closed or have all their corners at corners of other shells.
/// `shells` tells the shell of each face.
pub(super) fn depths(field: &Field, shells: &[u32], closed: &[bool]) -> Vec<Option<u32>> {
    let around = around(field, shells, closed);
    around
        .iter()
        .map(|a| Some(a.as_ref()?.len() as u32))
        .collect()
}

/// For each shell the closed shells around it; `None` as in [`depths`].
fn around(field: &Field, shells: &[u32], closed: &[bool]) -> Vec<Option<Vec<u32>>> {
    let witnesses = witnesses(field, shells, closed.len());
    (0..closed.len())
        .into_par_iter()
        .map(|s| match (closed[s], witnesses[s]) {
            (true, Some(v)) => Some(around_vertex(field, shells, closed, s as u32, v)),
            _ => None,
        })
        .collect()
}

/// For each shell of [`super::components`] the numbers of the closed shells
/// around it, in order: none for a solid that lies free, one for the wall of a
/// cavity in it, two for what lies in that cavity. `None` for shells that are
/// not closed, or that touch other shells at every corner. Shells that cross
/// give no sensible answer.
pub fn enclosing(mesh: &PolygonMesh) -> Vec<Option<Vec<u32>>> {
    let faces = Faces::of(mesh, |_, _| ());
    let topology = Topology::of(mesh.vertices.len(), &faces);
    let frame = Frame::new(&mesh.vertices);
    let triangles = faces.triangles(&frame);
    enclosing_of(mesh, &faces, &topology, &frame, &triangles)
}

/// The same for a mesh taken apart.
fn enclosing_of(
    mesh: &PolygonMesh,
    faces: &Faces,
    topology: &Topology,
    frame: &Frame,
    triangles: &Triangles,
) -> Vec<Option<Vec<u32>>> {
    let mut closed = vec![true; topology.shell_edges.len()];
    for bad in &topology.bad {
        let corner = topology.bad_corners[bad.corners.0 as usize];
        let face = faces.starts.partition_point(|&s| s <= corner) - 1;
        closed[topology.shell[face] as usize] = false;
    }
    if closed.len() < 2 {
        return closed.iter().map(|&c| c.then(Vec::new)).collect();
    }
    let finite: Vec<bool> = (mesh.vertices.iter())
        .map(|p| p.iter().all(|x| x.is_finite()))
        .collect();
    let mut skip = flat(frame, triangles);
    for (skip, t) in skip.iter_mut().zip(&triangles.corners) {
        *skip |= !t.iter().all(|&v| finite[v as usize]);
    }
    let (canonical, _) = coincidences(frame, &finite);
    let field = Field::new(frame, &canonical, triangles, &skip);
    around(&field, &topology.shell, &closed)
}

/// A mesh taken apart, by [`super::components`],
/// [`super::component_volumes`] and [`enclosing`] at once.
pub(crate) struct Anatomy {
    pub shell_of_face: Vec<u32>,
    pub volumes: Vec<f64>,
    pub around: Vec<Option<Vec<u32>>>,
}

impl Anatomy {
    pub fn of(mesh: &PolygonMesh) -> Anatomy {
        let faces = Faces::of(mesh, |_, _| ());
        let topology = Topology::of(mesh.vertices.len(), &faces);
        let frame = Frame::new(&mesh.vertices);
        let triangles = faces.triangles(&frame);
        Anatomy {
            shell_of_face: labels(mesh, &faces, &topology),
            volumes: volumes(mesh, &topology, &frame, &triangles),
            around: enclosing_of(mesh, &faces, &topology, &frame, &triangles),
        }
    }
}

/// For each shell a vertex at whose position no other shell has one.
fn witnesses(field: &Field, shells: &[u32], count: usize) -> Vec<Option<u32>> {
    const SEVERAL: u32 = u32::MAX;
    let shell = |t: u32| shells[field.triangles.face[t as usize] as usize];
    let mut owner: Vec<Option<u32>> = vec![None; field.frame.points.len()];
    for &(t, corners) in &field.slots {
        for v in corners {
            let owner = &mut owner[v as usize];
            match *owner {
                Some(s) if s != shell(t) => *owner = Some(SEVERAL),
                Some(_) => {}
                None => *owner = Some(shell(t)),
            }
        }
    }
    let mut witnesses = vec![None; count];
    for (v, owner) in owner.iter().enumerate() {
        if let Some(witness) = owner.and_then(|s| witnesses.get_mut(s as usize)) {
            witness.get_or_insert(v as u32);
        }
    }
    witnesses
}

/// The closed shells but `own` around vertex `v`.
fn around_vertex(field: &Field, shells: &[u32], closed: &[bool], own: u32, v: u32) -> Vec<u32> {
    let p = field.frame.points[v as usize];
    let mut hit = Vec::new();
    field.bvh.query(&ray(p), |slot| {
        let (t, corners) = field.slots[slot as usize];
        let shell = shells[field.triangles.face[t as usize] as usize];
        let other = shell != own && closed[shell as usize];
        if other && hits(field.frame.kernel, p, &place(&field.frame.points, corners)) {
            hit.push(shell);
        }
    });
    odd(hit)
}

/// What a ray from `p` runs through.
pub(super) fn ray(p: Point) -> Cuboid {
    Cuboid {
        min: p,
        max: [f64::INFINITY, p[1], p[2]],
    }
}

/// What was hit an odd number of times, in order.
pub(super) fn odd(mut hit: Vec<u32>) -> Vec<u32> {
    hit.sort_unstable();
    let odd = hit.chunk_by(|a, b| a == b).filter(|g| g.len() % 2 == 1);
    odd.map(|g| g[0]).collect()
}

/// Whether the ray from `p`, which is not on the triangle, meets it.
pub(super) fn hits(kernel: Kernel, p: Point, t: &[Point; 3]) -> bool {
    let flat = |p: Point| [p[1], p[2]];
    let turn = kernel.orient2d(flat(t[0]), flat(t[1]), flat(t[2]));
    let inside = (0..3).all(|i| {
        let (u, v) = (flat(t[i]), flat(t[(i + 1) % 3]));
        let sign = |less: f64, more: f64| (more > less) as i8 - (more < less) as i8;
        let side = match kernel.orient2d(u, v, flat(p)) {
            0 => match -sign(u[1], v[1]) {
                0 => sign(u[0], v[0]),
                side => side,
            },
            side => side,
        };
        side == turn
    });
    // Seen from large x, a triangle of positive turn runs counterclockwise,
    // and a point at smaller x lies below it, where the determinant is
    // positive.
    turn != 0 && inside && kernel.orient3d(t[0], t[1], t[2], p) == turn
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_through_an_edge_or_a_corner_hits_one_of_the_triangles_there() {
        let far = |y: f64, z: f64| [5.0, y, z];
        // A fan of six triangles about the axis, and the ray along it.
        let ring = [
            [2., 0.],
            [1., 2.],
            [-1., 2.],
            [-2., 0.],
            [-1., -2.],
            [1., -2.],
        ];
        let count = |p: Point, reverse: bool| {
            let hits = (0..6).filter(|&k| {
                let [a, b] = [ring[k], ring[(k + 1) % 6]].map(|q| far(q[0], q[1]));
                let t = match reverse {
                    true => [far(0., 0.), b, a],
                    false => [far(0., 0.), a, b],
                };
                hits(Kernel::Lattice, p, &t)
            });
            hits.count()
        };
        for reverse in [false, true] {
            assert_eq!(count([0., 0., 0.], reverse), 1);
            assert_eq!(count([0., 1., 0.], reverse), 1);
            assert_eq!(count([0., 0.5, 1.], reverse), 1);
            assert_eq!(count([6., 0.5, 1.], reverse), 0);
            assert_eq!(count([0., 3., 0.], reverse), 0);
        }
    }
}
