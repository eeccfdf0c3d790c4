//! The crust between unlike cells of a power diagram, by corners.
//!
//! A cell of the regular triangulation is a power vertex; each of its edges
//! between an inner and an outer ball is a **corner**: the power vertex as
//! part of that edge's dual face. Going round the edge through the cell's two facets at
//! it gives the next corner of the face; the same facet seen as part of the
//! other crust face it lies on gives the twin. Everything is local: no edge
//! table, no hashing.

use super::raw::{RawCrust, NONE};
use crate::geom::{Point, Side};
use crate::power::PowerDiagram;
use crate::tetra::{facet_of, unpack};

/// Where the power vertices go and which samples they are.
pub struct Placement<'a> {
    /// The samples each ball touches, ascending.
    pub touching: &'a (dyn Fn(u32) -> &'a [u32] + Sync),
    /// The position of a sample.
    pub sample: &'a (dyn Fn(u32) -> Point + Sync),
    /// The user's position of a point in the units of the diagram's sites.
    pub to_user: &'a (dyn Fn(Point) -> Point + Sync),
}

/// The six edges of a cell as corner pairs, and the two other corners.
const EDGES: [[usize; 4]; 6] = [
    // (i, j, k, l) even permutations: going round i -> j counterclockwise,
    // seen with j towards the eye, leads from k to l.
    [0, 1, 2, 3],
    [0, 2, 3, 1],
    [0, 3, 1, 2],
    [1, 2, 0, 3],
    [1, 3, 2, 0],
    [2, 3, 0, 1],
];

/// Extracts the crust. `side(v)` must call every sentinel outer.
pub fn raw_crust(power: &PowerDiagram, sides: &[Side], place: &Placement) -> RawCrust {
    let inner = |v: u32| !power.is_sentinel(v) && sides[v as usize] == Side::Inner;
    let cells = &power.complex.cells;

    // Corners are numbered cell after cell.
    let mut first = vec![NONE; cells.len()];
    let mut corners: Vec<(u32, u8)> = Vec::new();
    let mut mixed = Vec::new();
    for (c, cell) in cells.iter().enumerate() {
        let inside = cell.map(inner);
        let number = inside.iter().filter(|&&b| b).count();
        if number == 0 || number == 4 {
            continue;
        }
        first[c] = corners.len() as u32;
        mixed.push(c as u32);
        for (e, [i, j, _, _]) in EDGES.iter().enumerate() {
            if inside[*i] != inside[*j] {
                corners.push((c as u32, e as u8));
            }
        }
    }
    // The corner of a cell at the edge between two of its vertices.
    let corner_at = |c: u32, a: u32, b: u32| -> u32 {
        let cell = &cells[c as usize];
        let inside = cell.map(inner);
        let mut id = first[c as usize];
        for [i, j, _, _] in EDGES {
            if inside[i] == inside[j] {
                continue;
            }
            if (cell[i] == a && cell[j] == b) || (cell[i] == b && cell[j] == a) {
                return id;
            }
            id += 1;
        }
        NONE
    };
    let step = |corner: u32| -> Step {
        let (c, e) = corners[corner as usize];
        let cell = &cells[c as usize];
        let [i, j, k, l] = EDGES[e as usize];
        // Outward is from the inner to the outer ball: counterclockwise
        // around it when that is i -> j, clockwise otherwise.
        let (from, to) = if inner(cell[i]) { (k, l) } else { (l, k) };
        let (inner_ball, outer_ball) = if inner(cell[i]) {
            (cell[i], cell[j])
        } else {
            (cell[j], cell[i])
        };
        // Leave the cell through the facet opposite `from`.
        let (next, _) = unpack(power.complex.neighbours[c as usize][from]);
        let third = cell[to];
        let twin = if inner(third) {
            corner_at(next, third, outer_ball)
        } else {
            corner_at(next, inner_ball, third)
        };
        Step {
            next: corner_at(next, inner_ball, outer_ball),
            twin,
            balls: [inner_ball, outer_ball],
        }
    };
    let _ = facet_of;

    let mut raw = RawCrust::default();
    let mut place_of = vec![NONE; corners.len()];
    let mut twins_by_corner = Vec::with_capacity(corners.len());
    raw.starts.push(0);
    let mut vertex_of_cell = vec![NONE; cells.len()];
    for (v, &c) in mixed.iter().enumerate() {
        vertex_of_cell[c as usize] = v as u32;
    }
    for start in 0..corners.len() as u32 {
        if place_of[start as usize] != NONE {
            continue;
        }
        let mut at = start;
        loop {
            let Step { next, twin, balls } = step(at);
            if at == start {
                raw.balls.push(balls);
            }
            place_of[at as usize] = raw.corners.len() as u32;
            raw.corners
                .push(vertex_of_cell[corners[at as usize].0 as usize]);
            twins_by_corner.push(twin);
            at = next;
            if at == start {
                break;
            }
        }
        raw.starts.push(raw.corners.len() as u32);
    }
    raw.twins = twins_by_corner
        .into_iter()
        .map(|t| place_of[t as usize])
        .collect();
    let placed: Vec<(Point, u32)> = {
        use rayon::prelude::*;
        mixed
            .par_iter()
            .map(|&c| place_vertex(power, cells[c as usize], place))
            .collect()
    };
    raw.positions = placed.iter().map(|p| p.0).collect();
    raw.samples = placed.iter().map(|p| p.1).collect();
    raw
}

struct Step {
    next: u32,
    twin: u32,
    balls: [u32; 2],
}

/// Fact F2: a power vertex whose four balls share a sample is that sample.
fn place_vertex(power: &PowerDiagram, cell: [u32; 4], place: &Placement) -> (Point, u32) {
    if !cell.iter().any(|&v| power.is_sentinel(v)) {
        let lists = cell.map(|v| (place.touching)(v));
        if let Some(s) = common(lists) {
            return ((place.sample)(s), s);
        }
    }
    let centre = power.vertex(cell, 2f64.powi(-20));
    ((place.to_user)(centre.position), NONE)
}

/// The smallest element of four ascending lists.
fn common(mut lists: [&[u32]; 4]) -> Option<u32> {
    lists.sort_by_key(|l| l.len());
    lists[0]
        .iter()
        .copied()
        .find(|s| lists[1..].iter().all(|l| l.binary_search(s).is_ok()))
}
