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
use crate::geom::vec3::{dist_sq, dot, norm};

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
            || turns_a_face_over(surface, places, h, tolerance)
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

/// Whether moving the tail of `h` to its head turns a face over that is wider
/// than the tolerance; narrower ones may have been upside down by rounding.
fn turns_a_face_over(surface: &HalfEdges, places: &Places, h: u32, tolerance: f64) -> bool {
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
        let before = area(g, false);
        if !dies && dot(before, area(g, true)) <= 0.0 {
            let (mut longest, mut f) = (0.0, g);
            loop {
                longest =
                    dist_sq(places.at(surface.tail(f)), places.at(surface.head(f))).max(longest);
                f = surface.next(f);
                if f == g {
                    break;
                }
            }
            if norm(before) > tolerance * longest.sqrt() {
                return true;
            }
        }
        g = surface.around(g);
        if g == h {
            return false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::pinch::Fans;
    use super::super::raw::RawCrust;
    use super::*;

    /// A 4 by 4 torus of quadrilaterals is too coarse to lose many edges: all
    /// that may go are gone without a change of its Euler characteristic.
    #[test]
    fn topology_stays_whatever_the_tolerance() {
        let mut raw = RawCrust::default();
        let id = |i: u32, j: u32| (i % 4) * 4 + j % 4;
        for i in 0..4 {
            for j in 0..4 {
                raw.positions
                    .push([f64::from(i), f64::from(j), f64::from(i * j)]);
                raw.corners
                    .extend([id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)]);
                let first = 4 * id(i, j);
                raw.next.extend([1, 2, 3, 0].map(|k| first + k));
                raw.balls.extend([[0, 1]; 4]);
                // The sides look down, right, up and left.
                let side = |i: u32, j: u32, k: u32| 4 * id(i, j) + k;
                raw.twins.extend([
                    side(i, j + 3, 2),
                    side(i + 1, j, 3),
                    side(i, j + 1, 0),
                    side(i + 3, j, 1),
                ]);
            }
        }
        raw.samples = vec![NONE; 16];
        let (places, mut surface) = Places::of(raw);
        let mut cutter = super::super::contract::Cutter::new(16);
        let contracted = contract_short_edges(&mut surface, &places, 1e9, |surface, h| {
            cutter.cut(surface, h);
        });
        assert!(contracted > 0);
        let edges = (0..surface.len() as u32)
            .filter(|&h| surface.alive(h))
            .count()
            / 2;
        let fans = Fans::of(&surface, 16);
        let (vertices, faces) = (fans.firsts.len(), surface.faces().len());
        assert_eq!(vertices + faces, edges);
        assert_eq!(vertices, 16 - contracted);
    }
}
