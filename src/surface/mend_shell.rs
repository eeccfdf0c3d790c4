//! Shells that came out inside out, and triangles too thin to be told.
//!
//! A shell is a component of the surface; no change of mending joins or parts
//! shells. Rounding can turn one over that is hardly thicker than it, and a
//! surface that moves a little can jump over one. So each is judged by the
//! shells around it: one that looks the wrong way, or whose volume is lost in
//! rounding, is a speck and is taken out.

use super::mend_coarsen::area;
use super::mend_mesh::TriMesh;
use super::raw::NONE;
use crate::geom::vec3::plain::{dot, norm_sq};
use crate::geom::vec3::{add, cross, scale, sub};
use crate::geom::Point;
use crate::mesh::clash::{Clash, Tree};

/// A volume below this share of the squared sides times the extent of
/// everything is lost in rounding: others may well find it negative.
const LOST: f64 = 1e-15;
/// The shell of each triangle.
pub(crate) struct Shells {
    of: Vec<u32>,
    count: usize,
}

impl Shells {
    pub fn of(mesh: &TriMesh) -> Shells {
        let mut of = vec![NONE; mesh.tris.len()];
        let mut count = 0u32;
        let mut open = Vec::new();
        for first in 0..of.len() {
            if of[first] != NONE {
                continue;
            }
            of[first] = count;
            open.push(first as u32);
            while let Some(t) = open.pop() {
                for h in [3 * t, 3 * t + 1, 3 * t + 2] {
                    let other = mesh.twin(h) / 3;
                    if std::mem::replace(&mut of[other as usize], count) == NONE {
                        open.push(other);
                    }
                }
            }
            count += 1;
        }
        Shells {
            of,
            count: count as usize,
        }
    }

    /// Six times the volume of each shell about a corner of its own, and the
    /// sum of its squared sides, zero if it is gone.
    fn volumes(&self, mesh: &TriMesh) -> (Vec<f64>, Vec<f64>) {
        let mut origin: Vec<Option<Point>> = vec![None; self.count];
        let mut volumes = vec![0.0; self.count];
        let mut sides = vec![0.0; self.count];
        for (t, &shell) in self.of.iter().enumerate() {
            if mesh.alive(t as u32) {
                let [a, b, c] = mesh.place(t as u32);
                let o = *origin[shell as usize].get_or_insert(a);
                let normal = cross(sub(b, a), sub(c, a));
                volumes[shell as usize] += dot(sub(a, o), normal);
                sides[shell as usize] += area(&[a, b, c]).1;
            }
        }
        (volumes, sides)
    }

    /// Takes out shells that look the wrong way; returns how many samples
    /// went with them. The tree holds the triangles.
    pub fn take_out_reversed(&self, mesh: &mut TriMesh, clash: &Clash, tree: &Tree) -> usize {
        let mut lost = 0;
        let extent = reach(mesh);
        loop {
            let (now, sides) = self.volumes(mesh);
            let depths = match sides.iter().filter(|&&a| a > 0.0).count() {
                0 | 1 => vec![Some(0); now.len()],
                _ => clash.depths(tree, &mesh.points, &mesh.tris, &self.of, now.len()),
            };
            let wrong: Vec<bool> = (0..now.len())
                .map(|s| {
                    let outward = depths[s].unwrap_or(0) % 2 == 0;
                    sides[s] > 0.0
                        && (now[s].abs() <= LOST * extent * sides[s] || (now[s] > 0.0) != outward)
                })
                .collect();
            if !wrong.contains(&true) {
                return lost;
            }
            // What lies within a shell that goes is judged without it.
            let depth = |s: usize| depths[s].unwrap_or(0);
            let least = (0..now.len()).filter(|&s| wrong[s]).map(depth).min();
            for t in 0..mesh.tris.len() as u32 {
                let shell = self.of[t as usize] as usize;
                if mesh.alive(t) && wrong[shell] && Some(depth(shell)) == least {
                    for h in 3 * t..3 * t + 3 {
                        let v = mesh.tail(h) as usize;
                        if mesh.out[v] != NONE && mesh.samples[v] != NONE {
                            lost += 1;
                        }
                        mesh.out[v] = NONE;
                    }
                    mesh.tris[t as usize] = [NONE; 3];
                }
            }
        }
    }
}

/// The vector area below which a sum of products of coordinates about the
/// middle of the mesh can come out as zero: others compute areas so.
pub(crate) fn least_area(mesh: &TriMesh) -> f64 {
    let reach = reach(mesh);
    2e-15 * reach * reach
}

/// The largest coordinate about the middle of the mesh.
fn reach(mesh: &TriMesh) -> f64 {
    let used = || {
        let all = mesh.out.iter().enumerate();
        all.filter(|(_, &h)| h != NONE).map(|(v, _)| mesh.points[v])
    };
    let count = used().count().max(1) as f64;
    let middle = scale(used().fold([0.0; 3], add), 1.0 / count);
    used().fold(0.0f64, |r, p| {
        sub(p, middle).iter().fold(r, |r, x| r.max(x.abs()))
    })
}

/// Triangles whose vector area is not above `least`, paired with themselves.
pub(crate) fn thin(mesh: &TriMesh, least: f64) -> Vec<(u32, u32)> {
    (0..mesh.tris.len() as u32)
        .filter(|&t| mesh.alive(t) && is_thin(mesh, t, least))
        .map(|t| (t, t))
        .collect()
}

/// Whether the vector area of a triangle is not above `least` though it need
/// not be: its sides would allow for more, or a corner is no sample and can go.
pub(crate) fn is_thin(mesh: &TriMesh, t: u32, least: f64) -> bool {
    let place = mesh.place(t);
    let n = cross(sub(place[1], place[0]), sub(place[2], place[0]));
    let side = |k: usize| norm_sq(sub(place[0], place[k]));
    n.iter().all(|x| x.abs() <= least)
        && (side(1).max(side(2)) > 16.0 * least
            || (mesh.tris[t as usize].iter()).any(|&v| mesh.samples[v as usize] == NONE))
}

#[cfg(test)]
mod tests {
    use super::super::mend::{mend_crust, MendOptions};
    use super::super::raw::Crust;
    use super::*;
    use crate::context::Context;
    use crate::mesh::PolygonMesh;

    /// Within a face of a tetrahedron three vertices that are no samples, 1e-8
    /// apart and nearly on a line: other programs take the triangle between
    /// them for one of no area.
    #[test]
    fn tiny_needles_of_free_vertices_go() {
        let mut crust = Crust {
            mesh: PolygonMesh::with_vertices(vec![
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.3, 0.3, -1.0],
                [0.4, 1e-5, 0.0],
                [0.4 + 1e-8, 1e-5, 0.0],
                [0.4 + 5e-9, 1e-5 + 1e-12, 0.0],
            ]),
            vertex_samples: vec![0, 1, 2, 3, NONE, NONE, NONE],
            face_balls: Vec::new(),
        };
        for t in [
            [4, 5, 6],
            [0, 1, 4],
            [1, 5, 4],
            [1, 2, 5],
            [2, 6, 5],
            [2, 0, 6],
            [0, 4, 6],
            [1, 0, 3],
            [2, 1, 3],
            [0, 2, 3],
        ] {
            crust.mesh.push_face(&t);
            crust.face_balls.push([NONE; 2]);
        }
        let how = MendOptions {
            handles: None,
            flatness: 0.0,
            tolerance: None,
            single: false,
            keep_samples: true,
            spacing: &|_| 1.0,
            ball: &|_| None,
        };
        let mended = mend_crust(crust, &how, &Context::default()).unwrap();
        assert!(mended.left.is_empty() && mended.changes > 0);
        let mesh = &mended.crust.mesh;
        assert!(mesh.face_count() >= 4);
        for f in 0..mesh.face_count() {
            let t = mesh.face(f);
            let [a, b, c] = [t[0], t[1], t[2]].map(|v| mesh.vertices[v as usize]);
            let n = cross(sub(b, a), sub(c, a));
            assert!(n.iter().any(|x| x.abs() > 1e-15), "{a:?} {b:?} {c:?}");
        }
    }
}
