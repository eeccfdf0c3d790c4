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
//!
//! Nearly all faces have an area and visit no place twice, nearly all fans
//! are alone at their place and meet each neighbour once. One pass over the
//! faces and one over the fans see that; what fails is rare and goes the
//! general way.

use super::contract::Places;
use super::flat::{has_area, Tailor};
use super::halfedges::HalfEdges;
use super::pinch::{remove_opposite_faces, repeats, separate, split_double_edges, Fans};
use super::raw::{Crust, RawCrust};
use super::short::contract_short_edges;
use crate::geom::Point;
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

/// Cleans up a raw crust. The faces come in the order of their first
/// half-edges.
pub fn clean(raw: RawCrust, options: &CleanOptions) -> Crust {
    clean_counted(raw, options).0
}

/// The same, and the number of raw faces.
pub(crate) fn clean_counted(raw: RawCrust, options: &CleanOptions) -> (Crust, usize) {
    let (places, mut surface) = Places::of(raw);
    let (odd, count) = odd_faces(&mut surface, &places);
    if !odd.is_empty() || options.tolerance > 0.0 {
        let mut tailor = Tailor::new(&places, 0.0, &surface);
        for h in odd {
            tailor.settle(&mut surface, h);
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
    }
    let mut fans = Fans::of(&surface, places.positions.len());
    if remove_opposite_faces(&mut surface, &fans) > 0 {
        fans = Fans::of(&surface, places.positions.len());
    }
    if split_double_edges(&mut surface, &fans) > 0 {
        fans = Fans::of(&surface, places.positions.len());
    }
    (finish(&surface, &places, fans, options.gap), count)
}

/// Removes faces of two edges and lists those, by a half-edge, that return to
/// a place or may have no area; also how many faces there were.
fn odd_faces(surface: &mut HalfEdges, places: &Places) -> (Vec<u32>, usize) {
    let (mut odd, mut count) = (Vec::new(), 0);
    let mut seen = vec![false; surface.len()];
    let mut ring: Vec<u32> = Vec::new();
    let mut points: Vec<Point> = Vec::new();
    for first in 0..surface.len() as u32 {
        if seen[first as usize] || !surface.alive(first) {
            continue;
        }
        count += 1;
        ring.clear();
        points.clear();
        let mut h = first;
        while !std::mem::replace(&mut seen[h as usize], true) {
            let place = surface.tail(h);
            ring.push(place);
            points.push(places.at(place));
            h = surface.next(h);
        }
        if let [a, b] = ring[..] {
            if a != b {
                surface.zip(first, surface.next(first));
                continue;
            }
        }
        if !has_area(&points) || repeats(&mut ring) {
            odd.push(first);
        }
    }
    (odd, count)
}

fn finish(surface: &HalfEdges, places: &Places, fans: Fans, gap: f64) -> Crust {
    let Fans { fan, firsts, .. } = fans;
    let sample = |&h: &u32| places.samples[surface.tail(h) as usize];
    let vertex_samples = firsts.iter().map(sample).collect();
    let mut mesh = PolygonMesh::with_vertices(separate(surface, places, &firsts, gap));
    mesh.corners.reserve(surface.len());
    let mut face_balls = Vec::new();
    let mut seen = vec![false; surface.len()];
    for first in 0..surface.len() as u32 {
        if seen[first as usize] || !surface.alive(first) {
            continue;
        }
        let mut h = first;
        while !std::mem::replace(&mut seen[h as usize], true) {
            mesh.corners.push(fan[h as usize]);
            h = surface.next(h);
        }
        mesh.starts.push(mesh.corners.len() as u32);
        face_balls.push(surface.balls[first as usize]);
    }
    Crust {
        mesh,
        vertex_samples,
        face_balls,
    }
}
