//! Shells that came out inside out, and triangles too thin to be told.
//!
//! A shell is a component of the surface. None of the changes of mending join
//! or part shells, so each can be compared with itself before: where the
//! volume is of the same sign and size and not within rounding of nothing, it
//! looks the right way. Any other is judged by the shells around it. One that
//! looks the wrong way has folded over, which happens to specks of hardly any
//! volume only, and is taken out.

use super::mend_mesh::TriMesh;
use super::raw::NONE;
use crate::geom::vec3::{add, cross, dot, scale, sub};
use crate::geom::Point;
use crate::mesh::clash::Clash;

/// Volumes below this share of the cube about all are not trusted.
const SPECK: f64 = 1e-13;

/// The shell of each triangle, and the signed volumes.
pub(crate) struct Shells {
    pub of: Vec<u32>,
    before: Vec<f64>,
}

impl Shells {
    pub fn of(mesh: &TriMesh) -> Shells {
        let mut of = vec![NONE; mesh.tris.len()];
        let mut count = 0;
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
        let mut shells = Shells {
            of,
            before: vec![0.0; count as usize],
        };
        shells.before = shells.volumes(mesh).0;
        shells
    }

    /// Six times the volume of each shell about a corner of its own, and
    /// whether it has triangles.
    fn volumes(&self, mesh: &TriMesh) -> (Vec<f64>, Vec<bool>) {
        let mut origin: Vec<Option<Point>> = vec![None; self.before.len()];
        let mut volumes = vec![0.0; self.before.len()];
        for (t, &shell) in self.of.iter().enumerate() {
            if mesh.alive(t as u32) {
                let [a, b, c] = mesh.place(t as u32);
                let o = *origin[shell as usize].get_or_insert(a);
                volumes[shell as usize] += dot(sub(a, o), cross(sub(b, o), sub(c, o)));
            }
        }
        (volumes, origin.iter().map(Option::is_some).collect())
    }

    /// Takes out shells that look the wrong way; returns how many samples
    /// went with them.
    pub fn take_out_reversed(&self, mesh: &mut TriMesh, clash: &Clash) -> usize {
        let mut lost = 0;
        loop {
            let (now, here) = self.volumes(mesh);
            let trusted = |s: usize| {
                now[s].abs() > SPECK && now[s] * self.before[s] > 0.0 && {
                    let share = now[s] / self.before[s];
                    (0.5..2.0).contains(&share)
                }
            };
            if (0..now.len()).all(|s| !here[s] || trusted(s)) {
                return lost;
            }
            let depths = clash.depths(&mesh.points, &mesh.tris, &self.of, now.len());
            let wrong: Vec<bool> = (0..now.len())
                .map(|s| {
                    let outward = depths[s].unwrap_or(0) % 2 == 0;
                    here[s] && (now[s] == 0.0 || (now[s] > 0.0) != outward)
                })
                .collect();
            if !wrong.contains(&true) {
                return lost;
            }
            // What lies within a shell that goes is judged without it.
            let least = depths.iter().zip(&wrong).filter(|(_, &w)| w);
            let least = least.map(|(d, _)| d.unwrap_or(0)).min().unwrap_or(0);
            for t in 0..mesh.tris.len() as u32 {
                let shell = self.of[t as usize] as usize;
                if mesh.alive(t) && wrong[shell] && depths[shell].unwrap_or(0) == least {
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
    let used = || {
        let all = mesh.out.iter().enumerate();
        all.filter(|(_, &h)| h != NONE).map(|(v, _)| mesh.points[v])
    };
    let count = used().count().max(1) as f64;
    let middle = scale(used().fold([0.0; 3], add), 1.0 / count);
    let reach = used().fold(0.0f64, |r, p| {
        sub(p, middle).iter().fold(r, |r, x| r.max(x.abs()))
    });
    4e-16 * reach * reach
}

/// Triangles whose vector area is not above `least`, paired with themselves.
pub(crate) fn thin(mesh: &TriMesh, least: f64) -> Vec<(u32, u32)> {
    (0..mesh.tris.len() as u32)
        .filter(|&t| mesh.alive(t) && is_thin(&mesh.place(t), least))
        .map(|t| (t, t))
        .collect()
}

/// Whether the vector area of a triangle is not above `least`.
pub(crate) fn is_thin(t: &[Point; 3], least: f64) -> bool {
    let n = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    n.iter().all(|x| x.abs() <= least)
}
