//! Where the solid has no thickness: opposite faces that coincide, edges that
//! coincide, and vertices of several fans.
//!
//! **Opposite faces.** Two faces with the same corners in opposite order hold
//! nothing between them. Both go, and what was glued to the one is glued to
//! the other. A component of two such faces vanishes with them.
//!
//! **Double edges.** If two edges join the same two vertices, a mesh of
//! indices has one edge with four faces. The two form a closed curve that
//! goes out and back and encloses nothing, so cutting the surface along it and
//! sewing up both cuts leaves the solid as it is. On half-edges that is to
//! exchange the two twins, which splits the fan at *both* ends: afterwards
//! either end has a vertex for each of the edges. Fans only ever get smaller
//! here, so one pass over each set of equal edges, every pair tested, ends and
//! leaves none. (A midpoint on one of the edges would do as well, but keeps a
//! neck of zero width and adds vertices.)
//!
//! **Fans.** The vertices of several fans at one place stay where they are
//! unless a gap is asked for, see [`separate`].

use super::contract::Places;
use super::halfedges::HalfEdges;
use super::raw::NONE;
use crate::geom::vec3::{add, norm, scale, sub};
use crate::geom::Point;

/// The vertices: at each one fan of half-edges.
pub(crate) struct Fans {
    /// The vertex at which each half-edge starts.
    pub fan: Vec<u32>,
    /// The first half-edge of each vertex; vertices are in this order.
    pub firsts: Vec<u32>,
    /// The first half-edges of fans that share their place with others, reach
    /// a place twice or have two faces only. An edge that is not the only one
    /// between its places has odd fans at both ends, and so have the corners
    /// of faces with the same corners in opposite order: where a fan is alone
    /// at its place, the two have both their edges in it.
    pub odd: Vec<u32>,
}

impl Fans {
    /// Walks round all vertices.
    pub fn of(surface: &HalfEdges, places: usize) -> Fans {
        let mut fans = Fans {
            fan: vec![NONE; surface.len()],
            firsts: Vec::with_capacity(places),
            odd: Vec::new(),
        };
        let mut first_at = vec![NONE; places];
        let mut ends: Vec<u32> = Vec::new();
        for first in 0..surface.len() as u32 {
            if !surface.alive(first) || fans.fan[first as usize] != NONE {
                continue;
            }
            let number = fans.firsts.len() as u32;
            ends.clear();
            let mut h = first;
            while fans.fan[h as usize] == NONE {
                fans.fan[h as usize] = number;
                let twin = surface.twin(h);
                ends.push(surface.tail(twin));
                h = surface.next(twin);
            }
            let before = &mut first_at[surface.tail(first) as usize];
            if *before != NONE {
                fans.odd.extend([*before, first]);
            } else if ends.len() <= 2 || repeats(&mut ends) {
                fans.odd.push(first);
            }
            *before = first;
            fans.firsts.push(first);
        }
        fans
    }
}

/// Whether a number occurs twice.
pub(crate) fn repeats(numbers: &mut [u32]) -> bool {
    const FEW: usize = 16;
    if numbers.len() <= FEW {
        return (1..numbers.len()).any(|k| numbers[..k].contains(&numbers[k]));
    }
    numbers.sort_unstable();
    numbers.windows(2).any(|two| two[0] == two[1])
}

/// Removes pairs of faces with the same corners in opposite order, whose
/// corners all have odd fans.
pub(crate) fn remove_opposite_faces(surface: &mut HalfEdges, fans: &Fans) -> usize {
    let mut odd = vec![false; fans.firsts.len()];
    for &h in &fans.odd {
        odd[fans.fan[h as usize] as usize] = true;
    }
    let is_odd = |h: u32| odd[fans.fan[h as usize] as usize];
    let mut keys: Vec<(u64, u32)> = Vec::new();
    for &start in &fans.odd {
        let mut spoke = start;
        loop {
            keys.extend(key(surface, spoke, is_odd));
            spoke = surface.around(spoke);
            if spoke == start {
                break;
            }
        }
    }
    keys.sort_unstable();
    keys.dedup();
    let mut removed = 0;
    for equal in keys.chunk_by(|a, b| a.0 == b.0) {
        for (i, &(_, a)) in equal.iter().enumerate() {
            for &(_, b) in &equal[i + 1..] {
                if surface.alive(a) && surface.alive(b) && cancel(surface, a, b) {
                    removed += 1;
                }
            }
        }
    }
    removed
}

/// A number that faces with the same corners have in common, and the half-edge
/// of the face that starts at its lowest place; none if a corner is not `odd`.
fn key(surface: &HalfEdges, first: u32, odd: impl Fn(u32) -> bool) -> Option<(u64, u32)> {
    let (mut at, mut key, mut lowest) = (first, 0u64, first);
    loop {
        if !odd(at) {
            return None;
        }
        key = key.wrapping_add(mix(surface.tail(at)));
        if surface.tail(at) < surface.tail(lowest) {
            lowest = at;
        }
        at = surface.next(at);
        if at == first {
            return Some((key, lowest));
        }
    }
}

fn mix(place: u32) -> u64 {
    let h = (u64::from(place) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let h = (h ^ (h >> 32)).wrapping_mul(0xD6E8_FEB8_6659_FD93);
    h ^ (h >> 29)
}

/// The half-edges of a face, from `first` on.
fn walk(surface: &HalfEdges, first: u32) -> Vec<u32> {
    let mut face = vec![first];
    let mut at = surface.next(first);
    while at != first {
        face.push(at);
        at = surface.next(at);
    }
    face
}

/// Removes the faces of `a` and `b`, which start at their lowest places, if
/// they have the same corners in opposite order.
fn cancel(surface: &mut HalfEdges, a: u32, b: u32) -> bool {
    let (p, mut q) = (walk(surface, a), walk(surface, b));
    // Edge k of the first runs from corner k to k + 1; the other's edge from
    // corner k + 1 to k is the k-th from its end.
    q.reverse();
    let pairs = || p.iter().zip(&q);
    let fits = |(&h, &g): (&u32, &u32)| {
        surface.tail(h) == surface.head(g) && surface.head(h) == surface.tail(g)
    };
    if p.len() != q.len() || !pairs().all(fits) {
        return false;
    }
    for (&h, &g) in pairs() {
        surface.zip(h, g);
    }
    true
}

/// Makes every edge the only one between its vertices.
pub(crate) fn split_double_edges(surface: &mut HalfEdges, fans: &Fans) -> usize {
    let fan = |h: u32| fans.fan[h as usize];
    let mut odd = fans.odd.clone();
    odd.sort_unstable();
    odd.dedup();
    // The vertices of each edge, and its half-edge from the lower one.
    let mut edges: Vec<([u32; 2], u32)> = Vec::new();
    for start in odd {
        let mut h = start;
        loop {
            let ends = [fan(h), fan(surface.twin(h))];
            if ends[0] < ends[1] {
                edges.push((ends, h));
            }
            h = surface.around(h);
            if h == start {
                break;
            }
        }
    }
    edges.sort_unstable();
    let mut split = 0;
    for equal in edges.chunk_by(|a, b| a.0 == b.0) {
        for (i, &(_, a)) in equal.iter().enumerate() {
            for &(_, b) in &equal[i + 1..] {
                let (s, t) = (surface.twin(a), surface.twin(b));
                if surface.same_fan(a, b) && surface.same_fan(s, t) {
                    surface.pair(a, t);
                    surface.pair(b, s);
                    split += 1;
                }
            }
        }
    }
    split
}

/// The position of each vertex, given by its first half-edge.
///
/// With a positive `gap`, all vertices but one at each place of several fans
/// move by that much into their own fan, away from the other sheets. The one
/// that stays, exactly at the sample if there is one, has the widest fan.
pub(crate) fn separate(
    surface: &HalfEdges,
    places: &Places,
    firsts: &[u32],
    gap: f64,
) -> Vec<Point> {
    let at = |vertex: usize| surface.tail(firsts[vertex]);
    let mut positions: Vec<Point> = (0..firsts.len()).map(|v| places.at(at(v))).collect();
    if gap <= 0.0 {
        return positions;
    }
    let mut fans_at = vec![0u32; places.positions.len()];
    for vertex in 0..firsts.len() {
        fans_at[at(vertex) as usize] += 1;
    }
    // Place, width, vertex, mean direction of its edges.
    let mut split: Vec<(u32, f64, u32, Point)> = Vec::new();
    for vertex in 0..firsts.len() {
        if fans_at[at(vertex) as usize] > 1 {
            let mean = mean_direction(surface, places, firsts[vertex]);
            split.push((at(vertex), norm(mean), vertex as u32, mean));
        }
    }
    split.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    for pair in split.windows(2) {
        let (place, length, vertex, mean) = pair[1];
        if pair[0].0 == place && length > 0.0 {
            positions[vertex as usize] = add(places.at(place), scale(mean, gap / length));
        }
    }
    positions
}

/// The mean of the directions of all edges that start where `first` does:
/// the axis of the fan, short if the fan is wide.
fn mean_direction(surface: &HalfEdges, places: &Places, first: u32) -> Point {
    let (mut sum, mut edges, mut h) = ([0.0; 3], 0.0, first);
    loop {
        let step = sub(places.at(surface.head(h)), places.at(surface.tail(h)));
        let length = norm(step);
        if length > 0.0 {
            sum = add(sum, scale(step, 1.0 / length));
        }
        edges += 1.0;
        h = surface.around(h);
        if h == first {
            return scale(sum, 1.0 / edges);
        }
    }
}
