//! Edges too short to matter: contracted where that changes no topology.
//!
//! Orthocentres are quotients and come out close together where the power
//! diagram is nearly degenerate away from samples. Contracting such an edge
//! moves the vertex that is no sample to the other end. It is done only if
//! the two vertices share no neighbours but those of triangles at the edge
//! (the link condition) and no face turns over. A vertex to which others came
//! stays, so nothing moves by more than the tolerance.

use super::contract::Places;
use super::flat::vector_area;
use super::halfedges::HalfEdges;
use super::raw::NONE;
use crate::geom::vec3::{dist_sq, dot};

/// Contracts edges not longer than `tolerance`; returns half-edges of all
/// faces that changed, which the caller must cut (see `contract`).
pub(crate) fn contract_short_edges(
    surface: &mut HalfEdges,
    places: &Places,
    tolerance: f64,
    mut settle: impl FnMut(&mut HalfEdges, u32),
) -> usize {
    let mut anchor: Vec<bool> = places.samples.iter().map(|&s| s != NONE).collect();
    let mut fan = Vec::new();
    let mut contracted = 0;
    for h in 0..surface.len() as u32 {
        if !surface.alive(h) || anchor[surface.tail(h) as usize] {
            continue;
        }
        let (from, to) = (surface.tail(h), surface.head(h));
        if dist_sq(places.at(from), places.at(to)) > tolerance * tolerance
            || !links_meet_only_in_triangles(surface, h)
            || turns_a_face_over(surface, places, h)
        {
            continue;
        }
        fan.clear();
        let mut g = h;
        while fan.is_empty() || g != h {
            fan.push(g);
            g = surface.around(g);
        }
        for &g in &fan {
            surface.place[g as usize] = to;
        }
        for &g in &fan {
            if surface.alive(g) {
                settle(surface, g);
            }
        }
        anchor[to as usize] = true;
        contracted += 1;
    }
    contracted
}

fn is_triangle(surface: &HalfEdges, h: u32) -> bool {
    surface.next(surface.next(surface.next(h))) == h
}

/// Whether contracting `h` keeps the topology.
fn links_meet_only_in_triangles(surface: &HalfEdges, h: u32) -> bool {
    let twin = surface.twin(h);
    let to = surface.head(h);
    let triangles = usize::from(is_triangle(surface, h)) + usize::from(is_triangle(surface, twin));
    let mut common = 0;
    let mut g = h;
    loop {
        let end = surface.head(g);
        let mut f = twin;
        loop {
            common += usize::from(surface.head(f) == end && g != h && f != twin);
            f = surface.around(f);
            if f == twin {
                break;
            }
        }
        // The two faces at the edge contain its head; no other may.
        if g != h && g != surface.next(twin) {
            let mut f = surface.next(g);
            while f != g {
                if surface.tail(f) == to {
                    return false;
                }
                f = surface.next(f);
            }
        }
        g = surface.around(g);
        if g == h {
            break;
        }
    }
    common == triangles
}

/// Whether moving the tail of `h` to its head turns a face over.
fn turns_a_face_over(surface: &HalfEdges, places: &Places, h: u32) -> bool {
    let (from, to) = (surface.tail(h), surface.head(h));
    let area = |first: u32, moved: bool| {
        let mut at = first;
        let mut left = true;
        vector_area(std::iter::from_fn(|| {
            if !left {
                return None;
            }
            let place = surface.tail(at);
            at = surface.next(at);
            left = at != first;
            Some(places.at(if moved && place == from { to } else { place }))
        }))
    };
    let twin = surface.twin(h);
    let mut g = h;
    loop {
        let dies = (g == h || g == surface.next(twin)) && is_triangle(surface, g);
        if !dies && dot(area(g, false), area(g, true)) <= 0.0 {
            return true;
        }
        g = surface.around(g);
        if g == h {
            return false;
        }
    }
}
