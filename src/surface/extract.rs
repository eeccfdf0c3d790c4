//! The crust between unlike cells of a power diagram, by corners.
//!
//! A cell of the regular triangulation is a power vertex; each of its edges
//! between an inner and an outer ball is a **corner**: the power vertex as
//! part of that edge's dual face. Going round the edge through the cell's two facets at
//! it gives the next corner of the face; the same facet seen as part of the
//! other crust face it lies on gives the twin. Everything is local: no edge
//! table, no hashing.

use rayon::prelude::*;

use super::raw::{RawCrust, NONE};
use crate::geom::{vec3::dist_sq, Point, Side};
use crate::power::PowerDiagram;
use crate::tetra::unpack;

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

/// Corners of a cell by the number of its inner balls.
const CORNERS: [u32; 5] = [0, 3, 4, 3, 0];

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
/// assert_eq!(crust.balls.len(), 6);
/// assert!(crust.positions.iter().flatten().all(|v| v.abs() == 4.0));
/// # Ok::<(), powercrust::Error>(())
/// ```
pub fn raw_crust(power: &PowerDiagram, sides: &[Side], place: &Placement) -> RawCrust {
    let cells = &power.complex.cells;
    // Which vertices of each cell are inner, as bits.
    let inside: Vec<u8> = cells
        .par_iter()
        .map(|cell| {
            (0..4).fold(0, |bits, k| {
                let v = cell[k];
                let inner = !power.is_sentinel(v) && sides[v as usize] == Side::Inner;
                bits | (inner as u8) << k
            })
        })
        .collect();
    // Power vertices of the crust and their corners, cell after cell.
    let mut vertex = vec![NONE; cells.len()];
    let mut first = Vec::new();
    let mut mixed = Vec::new();
    let mut count = 0;
    for (c, bits) in inside.iter().enumerate() {
        let corners = CORNERS[bits.count_ones() as usize];
        if corners > 0 {
            vertex[c] = mixed.len() as u32;
            mixed.push(c as u32);
            first.push(count);
            count += corners;
        }
    }
    let view = View {
        power,
        inside: &inside,
        vertex: &vertex,
        first: &first,
    };
    let steps: Vec<Step> = mixed.par_iter().flat_map_iter(|&c| view.steps(c)).collect();

    // Following the corners round each face.
    let mut raw = RawCrust {
        corners: Vec::with_capacity(steps.len()),
        twins: Vec::with_capacity(steps.len()),
        starts: vec![0],
        ..RawCrust::default()
    };
    let mut place_of = vec![NONE; steps.len()];
    for start in 0..steps.len() as u32 {
        if place_of[start as usize] != NONE {
            continue;
        }
        raw.balls.push(steps[start as usize].balls);
        let mut at = start;
        while place_of[at as usize] == NONE {
            let step = &steps[at as usize];
            place_of[at as usize] = raw.corners.len() as u32;
            raw.corners.push(step.vertex);
            raw.twins.push(step.twin);
            at = step.next;
        }
        raw.starts.push(raw.corners.len() as u32);
    }
    drop(steps);
    raw.twins
        .par_iter_mut()
        .for_each(|t| *t = place_of[*t as usize]);
    let placed: Vec<(Point, u32)> = mixed
        .par_iter()
        .map(|&c| place_vertex(power, cells[c as usize], place))
        .collect();
    raw.positions = placed.iter().map(|p| p.0).collect();
    raw.samples = placed.iter().map(|p| p.1).collect();
    raw
}

/// A corner with its successor on the face and the twin of the half-edge
/// between them, all as corner numbers.
struct Step {
    vertex: u32,
    next: u32,
    twin: u32,
    balls: [u32; 2],
}

/// What finding corners needs.
struct View<'a> {
    power: &'a PowerDiagram,
    inside: &'a [u8],
    vertex: &'a [u32],
    first: &'a [u32],
}

impl View<'_> {
    /// The corners of a cell.
    fn steps(&self, c: u32) -> impl Iterator<Item = Step> + '_ {
        let bits = self.inside[c as usize];
        let inner = move |k: usize| bits >> k & 1 == 1;
        EDGES
            .iter()
            .filter(move |e| inner(e[0]) != inner(e[1]))
            .map(move |&[i, j, k, l]| {
                let cell = &self.power.complex.cells[c as usize];
                // Outward is from the inner to the outer ball: counterclockwise
                // about it is k -> l when that is i -> j, else l -> k. Leave
                // the cell through the facet opposite the first of them.
                let (from, to, balls) = if inner(i) {
                    (k, l, [cell[i], cell[j]])
                } else {
                    (l, k, [cell[j], cell[i]])
                };
                let (next, _) = unpack(self.power.complex.neighbours[c as usize][from]);
                // The facet's other crust face, by the third ball's label.
                let third = cell[to];
                let other = if inner(to) {
                    [third, balls[1]]
                } else {
                    [balls[0], third]
                };
                Step {
                    vertex: self.vertex[c as usize],
                    next: self.corner_at(next, balls),
                    twin: self.corner_at(next, other),
                    balls,
                }
            })
    }

    /// The corner of a cell at the edge between two of its vertices.
    fn corner_at(&self, c: u32, [a, b]: [u32; 2]) -> u32 {
        let cell = &self.power.complex.cells[c as usize];
        let bits = self.inside[c as usize];
        let mut id = self.first[self.vertex[c as usize] as usize];
        for [i, j, _, _] in EDGES {
            if (bits >> i ^ bits >> j) & 1 == 0 {
                continue;
            }
            if (cell[i] == a && cell[j] == b) || (cell[i] == b && cell[j] == a) {
                break;
            }
            id += 1;
        }
        id
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
