//! The crust without the faces of its holes: an oriented manifold with a
//! border.
//!
//! The crust is closed and manifold, so what is left of it has at most two
//! faces at an edge, of opposite direction. At a vertex several fans of faces
//! may be left that share no edge there: each gets a vertex of its own, at the
//! same place. Then every vertex of the border has one border edge that
//! arrives and one that leaves, and the border is loops without branches.

use super::Holes;
use crate::geom::vec3::{add, cross, norm, scale, sub};
use crate::geom::{Bounds, Point};
use crate::mesh::halves::Halves;
use crate::mesh::PolygonMesh;
use crate::surface::{Crust, Selection, NONE};

/// A loop of the border.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Loop {
    /// Its patch in [`Holes::patches`]: of several the one it runs along
    /// farthest.
    pub patch: u32,
    /// Its length, in the input's unit.
    pub length: f64,
    /// The area that it encloses seen from the front (the length of its vector
    /// area), in the square of the input's unit. What was left out bulges and
    /// has more: see [`Patch::area`](super::Patch::area).
    pub opening: f64,
    /// The middle of the loop.
    pub centre: Point,
    /// Number of its edges.
    pub edges: usize,
}

/// A crust without its holes.
#[derive(Clone, Debug, Default)]
pub struct Opened {
    /// What is left; it may have no face.
    pub crust: Crust,
    /// The vertices and faces it had in the crust given; a vertex may be there
    /// more than once.
    pub selection: Selection,
    /// Its border, the longest loop first.
    pub loops: Vec<Loop>,
}

impl Holes {
    /// The crust without the faces of holes; `crust` is closed and has the
    /// faces that `patch_of_face` tells of.
    ///
    /// ```
    /// use powercrust::{holes::HoleSize, reconstruct, Context, Options};
    /// // Most of a sphere: the top was not seen.
    /// let points: Vec<[f64; 3]> = (0..2000).map(|k| {
    ///     let (z, a) = (0.8 - k as f64 * 0.0009, k as f64 * 2.399963);
    ///     let r = (1.0f64 - z * z).sqrt();
    ///     [r * a.cos(), r * a.sin(), z]
    /// }).collect();
    /// let result = reconstruct(&points, &Options::default(), &Context::default())?;
    /// let holes = result.holes(HoleSize::default());
    /// assert_eq!(holes.patches.len(), 1);
    /// let opened = holes.open(&result.crust);
    /// assert_eq!(opened.loops.len(), 1);
    /// assert!(opened.crust.mesh.face_count() < result.crust.mesh.face_count());
    /// # Ok::<(), powercrust::Error>(())
    /// ```
    pub fn open(&self, crust: &Crust) -> Opened {
        let mesh = &crust.mesh;
        let stays = |f: u32| self.patch_of_face[f as usize] == NONE;
        let faces: Vec<u32> = (0..mesh.face_count() as u32)
            .filter(|&f| stays(f))
            .collect();
        let halves = Halves::of(mesh);
        // A half-edge whose other side stays as well.
        let inward = |h: u32| halves.across(h).is_some_and(stays);
        let (vertices, at_corner) = fans(mesh, &halves, &stays, &inward);
        let selection = Selection { vertices, faces };
        let mut left = PolygonMesh::with_vertices(selection.of_vertices(&mesh.vertices));
        for &f in &selection.faces {
            let corners: Vec<u32> = (halves.of_face(f)).map(|h| at_corner[h as usize]).collect();
            left.push_face(&corners);
        }
        let loops = self.loops(mesh, &halves, &selection, &at_corner, &inward);
        Opened {
            crust: Crust {
                vertex_samples: selection.of_vertices(&crust.vertex_samples),
                face_balls: selection.of_faces(&crust.face_balls),
                mesh: left,
            },
            selection,
            loops,
        }
    }

    fn loops(
        &self,
        mesh: &PolygonMesh,
        halves: &Halves,
        selection: &Selection,
        at_corner: &[u32],
        inward: &dyn Fn(u32) -> bool,
    ) -> Vec<Loop> {
        let mut leaving = vec![NONE; selection.vertices.len()];
        let mut border = Vec::new();
        for h in selection.faces.iter().flat_map(|&f| halves.of_face(f)) {
            if !inward(h) {
                leaving[at_corner[h as usize] as usize] = h;
                border.push(h);
            }
        }
        let unit = Bounds::of(&mesh.vertices).map_or(1.0, |b| b.diagonal());
        let mut loops = Vec::new();
        for first in border {
            let mut run = Vec::new();
            let mut h = first;
            loop {
                let at = &mut leaving[at_corner[h as usize] as usize];
                if *at == NONE {
                    break;
                }
                *at = NONE;
                run.push(h);
                h = match leaving[at_corner[halves.next(h) as usize] as usize] {
                    NONE => break,
                    after => after,
                };
            }
            if !run.is_empty() {
                loops.push(self.measure(mesh, halves, &run, unit));
            }
        }
        loops.sort_by(|a, b| b.length.total_cmp(&a.length));
        loops
    }

    fn measure(&self, mesh: &PolygonMesh, halves: &Halves, run: &[u32], unit: f64) -> Loop {
        let origin = mesh.vertices[halves.tail(run[0]) as usize];
        let at = |v: u32| scale(sub(mesh.vertices[v as usize], origin), 1.0 / unit);
        let (mut length, mut twice, mut centre) = (0.0, [0.0; 3], [0.0; 3]);
        let mut along: Vec<(u32, f64)> = Vec::new();
        for &h in run {
            let (a, b) = (at(halves.tail(h)), at(halves.head(h)));
            let step = norm(sub(a, b));
            length += step;
            twice = add(twice, cross(a, b));
            centre = add(centre, scale(add(a, b), 0.5 * step));
            let patch = halves
                .across(h)
                .map_or(NONE, |f| self.patch_of_face[f as usize]);
            match along.iter_mut().find(|e| e.0 == patch) {
                Some(entry) => entry.1 += step,
                None => along.push((patch, step)),
            }
        }
        let farthest = along
            .iter()
            .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
        let middle = scale(centre, unit / length.max(f64::MIN_POSITIVE));
        Loop {
            patch: farthest.map_or(NONE, |e| e.0),
            length: length * unit,
            opening: 0.5 * norm(twice) * unit * unit,
            centre: add(origin, middle),
            edges: run.len(),
        }
    }
}

/// A vertex for each fan of the faces that stay: which vertex of the mesh it
/// was, and the one at each corner.
fn fans(
    mesh: &PolygonMesh,
    halves: &Halves,
    stays: &dyn Fn(u32) -> bool,
    inward: &dyn Fn(u32) -> bool,
) -> (Vec<u32>, Vec<u32>) {
    let mut vertices = Vec::new();
    let mut at_corner = vec![NONE; mesh.corners.len()];
    let mut fan = Vec::new();
    for v in 0..mesh.vertices.len() as u32 {
        for &start in halves.leaving(v) {
            if !stays(halves.face[start as usize]) || at_corner[start as usize] != NONE {
                continue;
            }
            let new = vertices.len() as u32;
            vertices.push(v);
            fan.clear();
            fan.push(start);
            at_corner[start as usize] = new;
            while let Some(h) = fan.pop() {
                // Across the edge that leaves, and the one that arrives.
                let mut beside = Vec::with_capacity(2);
                if inward(h) {
                    beside.push(halves.next(halves.twin[h as usize]));
                }
                let arrives = previous(halves, h);
                if inward(arrives) {
                    beside.push(halves.twin[arrives as usize]);
                }
                for c in beside {
                    if at_corner[c as usize] == NONE {
                        at_corner[c as usize] = new;
                        fan.push(c);
                    }
                }
            }
        }
    }
    (vertices, at_corner)
}

/// The half-edge before `h` in its face.
fn previous(halves: &Halves, h: u32) -> u32 {
    let face = halves.of_face(halves.face[h as usize]);
    match h == face.start {
        true => face.end - 1,
        false => h - 1,
    }
}
