//! The crust between unlike cells of a power diagram, as half-edges.
//!
//! A cell of the regular triangulation is a power vertex, a facet a power
//! edge; a facet between unlike balls lies on exactly two crust faces, and
//! runs along the one as it leads out of its cell, along the other as it leads
//! in. So **a half-edge of the crust is a facet of a cell**: its twin is the
//! same facet of the neighbour, and its successor leaves that neighbour by the
//! facet that the labels of the four balls and the facet of entry say
//! ([`TURNS`]). The crust is there before anything is computed.
//!
//! What is computed is a part of it. All cells at a sample are one vertex
//! (fact F2), and a facet between two of them an edge of no length: it is left
//! out, and successors pass over it. That is contraction, see `contract`, of
//! all that lies at samples, before it takes any memory.

use rayon::prelude::*;

use super::raw::{RawCrust, NONE};
use crate::geom::{vec3::dist_sq, Point, Side};
use crate::power::PowerDiagram;

/// Where the power vertices go and which samples they are.
pub struct Placement<'a> {
    /// The samples each ball touches, ascending.
    pub touching: &'a (dyn Fn(u32) -> &'a [u32] + Sync),
    /// The position of a sample.
    pub sample: &'a (dyn Fn(u32) -> Point + Sync),
    /// The user's position of a point in the units of the diagram's sites.
    pub to_user: &'a (dyn Fn(Point) -> Point + Sync),
}

/// The half-edges of a cell whose inner balls are given.
#[derive(Clone, Copy)]
struct Turn {
    /// By the facet a walk along a face enters: the one by which it leaves.
    leave: [u8; 4],
    /// The corners with the inner and the outer ball of the face along which
    /// it leaves by each facet.
    balls: [[u8; 2]; 4],
    /// The facets by which it leaves, as bits.
    facets: u8,
}

/// By the inner balls of a cell, as bits.
const TURNS: [Turn; 16] = turns();

const fn turns() -> [Turn; 16] {
    // Even permutations (i, j, k, l): going round i -> j counterclockwise,
    // seen with j towards the eye, leads from k to l.
    const EDGES: [[u8; 4]; 6] = [
        [0, 1, 2, 3],
        [0, 2, 3, 1],
        [0, 3, 1, 2],
        [1, 2, 0, 3],
        [1, 3, 2, 0],
        [2, 3, 0, 1],
    ];
    let none = Turn {
        leave: [0; 4],
        balls: [[0; 2]; 4],
        facets: 0,
    };
    let mut turns = [none; 16];
    let mut bits = 0;
    while bits < 16 {
        let mut edge = 0;
        while edge < 6 {
            let [i, j, k, l] = EDGES[edge];
            let inner = [bits >> i & 1 == 1, bits >> j & 1 == 1];
            if inner[0] != inner[1] {
                // Outward is from the inner to the outer ball. The facet of
                // exit lies opposite the corner that the walk comes from.
                let (from, to, balls) = if inner[0] {
                    (k, l, [i, j])
                } else {
                    (l, k, [j, i])
                };
                turns[bits].leave[to as usize] = from;
                turns[bits].balls[from as usize] = balls;
                turns[bits].facets |= 1 << from;
            }
            edge += 1;
        }
        bits += 1;
    }
    turns
}

/// Extracts the crust. Sentinels count as outer.
///
/// ```
/// use powercrust::surface::{raw_crust, Placement};
/// use powercrust::{power, Context, Side};
/// // One inner ball among six outer ones: its cell is a cube.
/// let mut balls = vec![[0.0, 0.0, 0.0, 1.0]];
/// for axis in 0..3 { for side in [-8.0, 8.0] {
///     let mut ball = [0.0, 0.0, 0.0, 1.0];
///     ball[axis] = side;
///     balls.push(ball);
/// }}
/// let diagram = power::power_diagram(&balls, 1024.0, &Context::default())?;
/// let mut sides = vec![Side::Outer; 7];
/// sides[0] = Side::Inner;
/// let place = Placement { touching: &|_| &[], sample: &|_| [0.0; 3], to_user: &|p| p };
/// let crust = raw_crust(&diagram, &sides, &place);
/// assert_eq!(crust.faces().len(), 6);
/// assert!(crust.positions.iter().flatten().all(|v| v.abs() == 4.0));
/// # Ok::<(), powercrust::Error>(())
/// ```
pub fn raw_crust(power: &PowerDiagram, sides: &[Side], place: &Placement) -> RawCrust {
    let mut walker = Walker::new(power, sides);
    let (positions, samples) = walker.place(place);
    let counts = walker.select();
    let total = counts.iter().sum();
    let mut raw = RawCrust {
        positions,
        samples,
        next: vec![0; total],
        twins: vec![0; total],
        corners: vec![0; total],
        balls: vec![[0; 2]; total],
    };
    let blocks = walker.mixed.par_chunks(BLOCK);
    blocks
        .zip(split(&mut raw.next, &counts))
        .zip(split(&mut raw.twins, &counts))
        .zip(split(&mut raw.corners, &counts))
        .zip(split(&mut raw.balls, &counts))
        .for_each(|((((cells, next), twins), corners), balls)| {
            let facets = cells.iter().flat_map(|&c| walker.facets(c));
            for (h, (c, facet)) in facets.enumerate() {
                let back = power.complex.neighbours[c as usize][facet];
                next[h] = walker.after(back);
                twins[h] = walker.number(back);
                corners[h] = walker.vertex[c as usize];
                balls[h] = walker.balls(c, facet);
            }
        });
    raw
}

/// Cells that one task works on.
const BLOCK: usize = 4096;

/// Cuts a table into parts of the given lengths.
fn split<'a, T>(mut all: &'a mut [T], lengths: &[usize]) -> Vec<&'a mut [T]> {
    let mut parts = Vec::with_capacity(lengths.len());
    for &length in lengths {
        let (part, rest) = all.split_at_mut(length);
        parts.push(part);
        all = rest;
    }
    parts
}

/// Walks along the faces of the crust, from facet to facet.
struct Walker<'a> {
    power: &'a PowerDiagram,
    /// By cell: its inner balls, and, four bits up, the facets that are
    /// half-edges.
    state: Vec<u8>,
    /// By cell: its vertex.
    vertex: Vec<u32>,
    /// By cell: the number of its first half-edge.
    first: Vec<u32>,
    /// The cells at the crust.
    mixed: Vec<u32>,
}

impl<'a> Walker<'a> {
    fn new(power: &'a PowerDiagram, sides: &[Side]) -> Walker<'a> {
        let cells = &power.complex.cells;
        let inner = |v: u32| !power.is_sentinel(v) && sides[v as usize] == Side::Inner;
        let state: Vec<u8> = cells
            .par_iter()
            .map(|cell| (0..4).fold(0, |bits, k| bits | (inner(cell[k]) as u8) << k))
            .collect();
        let at_crust = |c: &u32| TURNS[state[*c as usize] as usize].facets != 0;
        let mixed = (0..cells.len() as u32).filter(at_crust).collect();
        Walker {
            power,
            state,
            vertex: vec![NONE; cells.len()],
            first: vec![0; cells.len()],
            mixed,
        }
    }

    /// Numbers the vertices of the crust in the order of their first cells:
    /// their positions and their samples.
    fn place(&mut self, place: &Placement) -> (Vec<Point>, Vec<u32>) {
        let placed: Vec<(Point, u32)> = (self.mixed.par_iter())
            .map(|&c| place_vertex(self.power, self.power.complex.cells[c as usize], place))
            .collect();
        let samples = placed.iter().map(|p| p.1).filter(|&s| s != NONE);
        let mut of_sample = vec![NONE; samples.max().map_or(0, |s| s as usize + 1)];
        let (mut positions, mut samples) = (Vec::new(), Vec::new());
        for (&c, (position, sample)) in self.mixed.iter().zip(placed) {
            let own = positions.len() as u32;
            self.vertex[c as usize] = match of_sample.get_mut(sample as usize) {
                Some(known) if *known != NONE => *known,
                first => {
                    if let Some(known) = first {
                        *known = own;
                    }
                    positions.push(position);
                    samples.push(sample);
                    own
                }
            };
        }
        (positions, samples)
    }

    /// Selects the facets that lead from one vertex to another and numbers
    /// them cell after cell; how many there are in each block of cells.
    fn select(&mut self) -> Vec<usize> {
        let selected: Vec<u8> = (self.mixed.par_iter())
            .map(|&c| {
                let behind = &self.power.complex.neighbours[c as usize];
                let vertex = self.vertex[c as usize];
                let facets = TURNS[self.state[c as usize] as usize].facets;
                (0..4)
                    .filter(|&k| facets >> k & 1 == 1)
                    .filter(|&k| self.vertex[behind[k] as usize >> 2] != vertex)
                    .fold(0, |bits, k| bits | 1 << k)
            })
            .collect();
        let mut counts = Vec::with_capacity(self.mixed.len() / BLOCK + 1);
        let mut number = 0;
        for (cells, selected) in self.mixed.chunks(BLOCK).zip(selected.chunks(BLOCK)) {
            let before = number;
            for (&c, &facets) in cells.iter().zip(selected) {
                self.first[c as usize] = number;
                self.state[c as usize] |= facets << 4;
                number += facets.count_ones();
            }
            counts.push((number - before) as usize);
        }
        counts
    }

    /// The facets of a cell that are half-edges.
    fn facets(&self, c: u32) -> impl Iterator<Item = (u32, usize)> {
        let facets = self.state[c as usize] >> 4;
        (0..4)
            .filter(move |k| facets >> k & 1 == 1)
            .map(move |k| (c, k))
    }

    /// The number of the half-edge that is a packed facet.
    fn number(&self, packed: u32) -> u32 {
        let c = packed as usize >> 2;
        let before = (self.state[c] >> 4) & ((1 << (packed & 3)) - 1);
        self.first[c] + before.count_ones()
    }

    /// The number of the half-edge that follows one which enters a cell by a
    /// packed facet.
    fn after(&self, mut entered: u32) -> u32 {
        loop {
            let c = entered as usize >> 2;
            let state = self.state[c];
            let leave = TURNS[state as usize & 15].leave[entered as usize & 3];
            if state >> 4 >> leave & 1 == 1 {
                return self.number(entered & !3 | u32::from(leave));
            }
            entered = self.power.complex.neighbours[c][leave as usize];
        }
    }

    /// The inner and the outer ball of the face of a half-edge.
    fn balls(&self, c: u32, facet: usize) -> [u32; 2] {
        let corners = TURNS[self.state[c as usize] as usize & 15].balls[facet];
        corners.map(|k| self.power.complex.cells[c as usize][k as usize])
    }
}

/// Fact F2: a power vertex whose four balls share a sample is that sample.
/// Where they share two, their centres are nearly coplanar and the vertex
/// lies on the line between the two: the nearer one takes it.
fn place_vertex(power: &PowerDiagram, cell: [u32; 4], place: &Placement) -> (Point, u32) {
    let vertex = || (place.to_user)(power.vertex(cell, 2f64.powi(-20)).position);
    if cell.iter().any(|&v| power.is_sentinel(v)) {
        return (vertex(), NONE);
    }
    let mut lists = cell.map(|v| (place.touching)(v));
    lists.sort_by_key(|l| l.len());
    let mut shared = (lists[0].iter().copied())
        .filter(|s| lists[1..].iter().all(|l| l.binary_search(s).is_ok()));
    let Some(first) = shared.next() else {
        return (vertex(), NONE);
    };
    let mut best = first;
    if let Some(second) = shared.next() {
        let at = vertex();
        let distance = |s: u32| dist_sq((place.sample)(s), at);
        for s in [second].into_iter().chain(shared) {
            if distance(s) < distance(best) {
                best = s;
            }
        }
    }
    ((place.sample)(best), best)
}
