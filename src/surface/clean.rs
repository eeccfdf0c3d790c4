//! From the raw crust to a mesh: closed, oriented, one fan at every vertex,
//! no face that repeats a corner or has no area, no two edges between the
//! same vertices, no unused vertex.
//!
//! The raw crust is a closed 2-manifold, combinatorially, whose vertices
//! coincide a lot (facts F2, F4, F5). Every stage below exchanges successors
//! and twins of half-edges and nothing else, so its result is again a closed
//! oriented 2-manifold (see `halfedges`); what can change is its topology,
//! where the solid is pinched to nothing.
//!
//! 1. Faces are cut where they return to a place; what has one or two edges
//!    goes (`contract`). That contracts every zero-length edge.
//! 2. Faces on a line are sewn up into their neighbours (`flat`).
//! 3. On request, edges that are shorter than a tolerance are contracted
//!    (`short`) and faces narrower than it sewn up.
//! 4. Opposite faces that coincide cancel; double edges are cut (`pinch`).
//! 5. Fans are numbered: they are the vertices.

use super::contract::{half_edges, Places};
use super::flat::Tailor;
use super::halfedges::HalfEdges;
use super::pinch::{remove_opposite_faces, separate, split_double_edges};
use super::raw::{Crust, RawCrust, NONE};
use super::short::contract_short_edges;
use crate::mesh::PolygonMesh;

/// How far clean-up may move the surface; the default not at all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CleanOptions {
    /// Contract edges up to this length and sew up faces up to this width, in
    /// the units of the input. Samples stay where they are.
    pub tolerance: f64,
    /// Where several sheets touch in a point, draw all but one of them back
    /// by this length. With 0 their vertices coincide, and tests that know
    /// vertices only by index report the sheets as crossing. A file of `f32`
    /// must still tell the vertices apart.
    pub gap: f64,
}

/// Cleans up a raw crust. The faces keep the order of the raw faces they
/// come from.
pub fn clean(raw: RawCrust, options: &CleanOptions) -> Crust {
    let (places, place_of) = Places::of(&raw);
    let mut surface = half_edges(&raw, &place_of);
    drop(place_of);
    let RawCrust { starts, balls, .. } = raw;

    let mut tailor = Tailor::new(&places, 0.0, &surface);
    for ends in starts.windows(2).filter(|ends| ends[0] < ends[1]) {
        tailor.settle(&mut surface, ends[0]);
    }
    if options.tolerance > 0.0 {
        contract_short_edges(&mut surface, &places, options.tolerance, |surface, h| {
            tailor.settle(surface, h)
        });
        tailor.tolerance = options.tolerance;
        for h in surface.faces() {
            tailor.settle(&mut surface, h);
        }
    }
    drop(tailor);
    remove_opposite_faces(&mut surface);
    split_double_edges(&mut surface);
    finish(&surface, &places, &balls, options.gap)
}

fn finish(surface: &HalfEdges, places: &Places, balls: &[[u32; 2]], gap: f64) -> Crust {
    let (fan, count) = surface.fans();
    let mut vertex_samples = vec![NONE; count as usize];
    for h in (0..surface.len() as u32).filter(|&h| surface.alive(h)) {
        vertex_samples[fan[h as usize] as usize] = places.samples[surface.tail(h) as usize];
    }
    // Half-edges made late lie behind all others: sort by raw face.
    let mut firsts: Vec<(u32, u32)> = surface
        .faces()
        .iter()
        .map(|&h| (surface.face[h as usize], h))
        .collect();
    firsts.sort_unstable();
    let mut mesh = PolygonMesh::with_vertices(separate(surface, places, &fan, count, gap));
    let mut face_balls = Vec::with_capacity(firsts.len());
    for &(face, first) in &firsts {
        let mut h = first;
        loop {
            mesh.corners.push(fan[h as usize]);
            h = surface.next(h);
            if h == first {
                break;
            }
        }
        mesh.starts.push(mesh.corners.len() as u32);
        face_balls.push(balls.get(face as usize).copied().unwrap_or([NONE; 2]));
    }
    Crust {
        mesh,
        vertex_samples,
        face_balls,
    }
}
