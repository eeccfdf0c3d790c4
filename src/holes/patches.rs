//! Faces of holes in patches, and how large each is.

use std::f64::consts::PI;

use super::width::Widths;
use super::{HoleSize, GROWN};
use crate::geom::vec3::{add, cross, norm, scale, sub};
use crate::geom::{Bounds, Point};
use crate::mesh::halves::Halves;
use crate::mesh::PolygonMesh;
use crate::pipeline::Reconstruction;
use crate::surface::{Crust, Selection, NONE};

/// Pieces of surface within a hole that pass through fewer samples than this
/// go with it.
const FEWEST: usize = 10;

/// A place without samples.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Patch {
    /// How wide it is, in the input's unit: the width of its widest face, but
    /// no more than the diameter of a disc of its area.
    pub width: f64,
    /// The same in spacings of the samples around.
    pub spacings: f64,
    /// Area of its faces, in the square of the input's unit.
    pub area: f64,
    /// Number of its faces; counted anew when faces are selected.
    pub faces: usize,
    /// The mean of the places of its faces, weighted by area.
    pub centre: Point,
}

impl Patch {
    /// The width of a run of faces; nothing else is known yet.
    fn of(run: &[u32], widths: &Widths, sizes: &[(f64, Point)], unit: f64) -> Patch {
        let area: f64 = run.iter().map(|&f| sizes[f as usize].0).sum();
        let disc = 2.0 * unit * (area / PI).sqrt();
        let mut patch = Patch {
            width: 0.0,
            spacings: 0.0,
            area: 0.0,
            faces: 0,
            centre: [0.0; 3],
        };
        for &f in run {
            let f = f as usize;
            let width = widths.width[f].min(disc);
            patch.width = patch.width.max(width);
            patch.spacings = patch.spacings.max(width / widths.spacing[f]);
        }
        patch
    }
}

/// The places without samples on a crust.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Holes {
    /// They, the largest area first.
    pub patches: Vec<Patch>,
    /// The patch of each face of the crust, or [`NONE`].
    pub patch_of_face: Vec<u32>,
    /// Their area over that of the whole surface.
    pub share: f64,
}

impl Holes {
    /// The holes of a crust, closed as it comes from
    /// [`reconstruct`](crate::reconstruct).
    pub fn of(result: &Reconstruction, size: HoleSize) -> Holes {
        let crust = &result.crust;
        let halves = Halves::of(&crust.mesh);
        let widths = Widths::of(result, &halves);
        let count = crust.mesh.face_count();
        let wide = |f: u32| widths.spacings(f as usize) > GROWN;
        let mesh = &crust.mesh;
        let unit = Bounds::of(&mesh.vertices).map_or(1.0, |b| b.diagonal());
        let sizes: Vec<(f64, Point)> = (0..count)
            .map(|f| area_and_middle(mesh, f, mesh.vertices[0], unit))
            .collect();
        let mut of_face = vec![NONE; count];
        let mut patches = Vec::new();
        for run in runs(count, &halves, wide) {
            let patch = Patch::of(&run, &widths, &sizes, unit);
            let large = match size {
                HoleSize::Spacings(least) => patch.spacings >= least,
                HoleSize::Length(least) => patch.width >= least,
            };
            if large {
                let number = patches.len() as u32;
                run.iter().for_each(|&f| of_face[f as usize] = number);
                patches.push(patch);
            }
        }
        if !patches.is_empty() {
            drown(crust, &halves, &mut of_face);
        }
        Holes::measured(of_face, patches, &sizes, mesh, unit)
    }

    /// Areas and middles of patches, and their order. Sizes are in units of
    /// the diagonal, about the first vertex.
    fn measured(
        mut of_face: Vec<u32>,
        mut patches: Vec<Patch>,
        sizes: &[(f64, Point)],
        mesh: &PolygonMesh,
        unit: f64,
    ) -> Holes {
        let (mut whole, mut bridged) = (0.0, 0.0);
        for (&patch, &(area, middle)) in of_face.iter().zip(sizes) {
            whole += area;
            if let Some(patch) = patches.get_mut(patch as usize) {
                bridged += area;
                patch.area += area;
                patch.faces += 1;
                patch.centre = add(patch.centre, scale(middle, area));
            }
        }
        for patch in &mut patches {
            let middle = scale(patch.centre, 1.0 / patch.area.max(f64::MIN_POSITIVE));
            patch.centre = add(mesh.vertices[0], scale(middle, unit));
            patch.area *= unit * unit;
        }
        let mut order: Vec<usize> = (0..patches.len()).collect();
        order.sort_by(|&a, &b| patches[b].area.total_cmp(&patches[a].area).then(a.cmp(&b)));
        let mut rank = vec![0; patches.len()];
        for (new, &old) in order.iter().enumerate() {
            rank[old] = new as u32;
        }
        for patch in of_face.iter_mut().filter(|p| **p != NONE) {
            *patch = rank[*patch as usize];
        }
        Holes {
            patches: order.into_iter().map(|p| patches[p].clone()).collect(),
            patch_of_face: of_face,
            share: bridged / whole.max(f64::MIN_POSITIVE),
        }
    }

    /// 1 for each face of a hole, 0 for the others.
    pub fn flags(&self) -> Vec<u8> {
        let flag = |&p: &u32| u8::from(p != NONE);
        self.patch_of_face.iter().map(flag).collect()
    }

    /// For the faces selected: what patches they were in. Faces are counted
    /// anew; widths and areas stay what was measured on the whole.
    pub fn select(&mut self, selection: &Selection) {
        self.patch_of_face = selection.of_faces(&self.patch_of_face);
        self.patches.iter_mut().for_each(|patch| patch.faces = 0);
        for &patch in &self.patch_of_face {
            if let Some(patch) = self.patches.get_mut(patch as usize) {
                patch.faces += 1;
            }
        }
    }
}

/// The area of a face and the mean of its corners from `origin`, in `unit`s.
fn area_and_middle(mesh: &PolygonMesh, f: usize, origin: Point, unit: f64) -> (f64, Point) {
    let face = mesh.face(f);
    let at = |v: u32| scale(sub(mesh.vertices[v as usize], origin), 1.0 / unit);
    let first = at(face[0]);
    let twice = (1..face.len().saturating_sub(1)).fold([0.0; 3], |sum, k| {
        add(
            sum,
            cross(sub(at(face[k]), first), sub(at(face[k + 1]), first)),
        )
    });
    let sum = face.iter().fold([0.0; 3], |sum, &v| add(sum, at(v)));
    (0.5 * norm(twice), scale(sum, 1.0 / face.len() as f64))
}

/// Runs of faces of a kind that edges join, by first face.
fn runs(count: usize, halves: &Halves, is: impl Fn(u32) -> bool) -> Vec<Vec<u32>> {
    let mut seen = vec![false; count];
    let mut all = Vec::new();
    for first in 0..count as u32 {
        if seen[first as usize] || !is(first) {
            continue;
        }
        seen[first as usize] = true;
        let mut run = vec![first];
        let mut done = 0;
        while let Some(&f) = run.get(done) {
            done += 1;
            for h in halves.of_face(f) {
                if let Some(g) = halves.across(h) {
                    if !seen[g as usize] && is(g) {
                        seen[g as usize] = true;
                        run.push(g);
                    }
                }
            }
        }
        all.push(run);
    }
    all
}

/// Pieces between holes that pass through next to no samples become part of
/// the patch that they have the longest border with.
fn drown(crust: &Crust, halves: &Halves, of_face: &mut [u32]) {
    let mesh = &crust.mesh;
    for run in runs(of_face.len(), halves, |f| of_face[f as usize] == NONE) {
        let mut samples: Vec<u32> = (run.iter())
            .take(4 * FEWEST * FEWEST)
            .flat_map(|&f| mesh.face(f as usize))
            .map(|&v| crust.vertex_samples[v as usize])
            .filter(|&s| s != NONE)
            .collect();
        samples.sort_unstable();
        samples.dedup();
        if samples.len() >= FEWEST {
            continue;
        }
        let mut shared: Vec<(u32, f64)> = Vec::new();
        for h in run.iter().flat_map(|&f| halves.of_face(f)) {
            let Some(patch) = halves.across(h).map(|g| of_face[g as usize]) else {
                continue;
            };
            if patch != NONE {
                let [a, b] = [halves.tail(h), halves.head(h)].map(|v| mesh.vertices[v as usize]);
                shared.push((patch, norm(sub(a, b))));
            }
        }
        shared.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let longest = (shared.chunk_by(|a, b| a.0 == b.0))
            .map(|run| (run[0].0, run.iter().map(|e| e.1).sum::<f64>()))
            .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
        if let Some((patch, _)) = longest {
            run.iter().for_each(|&f| of_face[f as usize] = patch);
        }
    }
}
