//! Inner or outer? The labelling of section 5.2.
//!
//! Belief spreads from the balls at the frame, which are outer, strongest
//! first: between the two poles of a sample (they should differ) and between
//! power-diagram neighbours that intersect deeply (they should agree). A label once
//! given stays. Every ball gets one (fact F7): balls no evidence reaches are
//! labelled last, by what their neighbours say, and outer if they say nothing.
//!
//! Equal priorities are told apart by ball id, which is itself a function of
//! the geometry; so the labels depend on neither threads nor hashing.

mod check;
mod energy;
mod hold;
mod propagate;
mod refine;

pub use check::{check, Finding};
pub use energy::{energy, Energy};
pub use hold::{hold, Held, MOST_UNHELD};
pub use propagate::label;
pub use refine::refine;

use crate::geom::{Ball, Side};
use crate::poles::NO_POLE;
use crate::power::PowerDiagram;

/// How to label.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelOptions {
    /// Neighbours share belief when `-cos alpha` of the angle at which they
    /// intersect is above this; 0.4 is alpha = 113.6 degrees.
    pub deep: f64,
}

impl Default for LabelOptions {
    fn default() -> LabelOptions {
        LabelOptions { deep: 0.4 }
    }
}

/// What is known about the balls before labelling.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    /// The balls of the power diagram.
    pub balls: &'a [Ball],
    /// Balls known to be outer: those at the frame.
    pub outer: &'a [bool],
    /// Pairs of poles of one sample with the weight `-cos angle(p s q)` in
    /// (0, 1]: they should differ.
    pub opposites: &'a [Opposite],
}

/// The two poles of a sample and how surely they lie on different sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opposite {
    /// The poles.
    pub poles: [u32; 2],
    /// `-cos` of the angle between them at the sample.
    pub weight: f64,
}

/// The opposite pairs of all samples with two poles.
pub fn opposites(
    of_sample: &[[u32; 2]],
    points: &[crate::geom::Point],
    balls: &[Ball],
) -> Vec<Opposite> {
    use crate::geom::vec3::{dot, norm, sub};
    let mut out = Vec::with_capacity(of_sample.len());
    for (s, poles) in of_sample.iter().enumerate() {
        if poles.contains(&NO_POLE) || poles[0] == poles[1] {
            continue;
        }
        let [p, q] = poles.map(|b| sub(balls[b as usize].centre, points[s]));
        let lengths = norm(p) * norm(q);
        let weight = if lengths > 0.0 {
            (-dot(p, q) / lengths).min(1.0)
        } else {
            0.0
        };
        if weight > 0.0 {
            out.push(Opposite {
                poles: *poles,
                weight,
            });
        }
    }
    out
}

/// The neighbours of each ball in the power diagram, sentinels left out, as a
/// compressed table.
pub struct Neighbours {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Neighbours {
    /// Collects the edges of the regular triangulation.
    pub fn of(power: &PowerDiagram) -> Neighbours {
        let vertices = power.sites.len();
        let (cell_starts, cells) = power.complex.cells_by_vertex(vertices);
        let mut seen = vec![u32::MAX; vertices];
        let mut starts = Vec::with_capacity(power.balls + 1);
        let mut items = Vec::new();
        starts.push(0);
        for b in 0..power.balls {
            seen[b] = b as u32;
            let from = items.len();
            for &c in &cells[cell_starts[b] as usize..cell_starts[b + 1] as usize] {
                for &v in &power.complex.cells[c as usize] {
                    if seen[v as usize] != b as u32 && !power.is_sentinel(v) {
                        seen[v as usize] = b as u32;
                        items.push(v);
                    }
                }
            }
            items[from..].sort_unstable();
            starts.push(items.len() as u32);
        }
        Neighbours { starts, items }
    }

    /// The neighbours of a ball, ascending.
    pub fn at(&self, ball: u32) -> &[u32] {
        let b = ball as usize;
        &self.items[self.starts[b] as usize..self.starts[b + 1] as usize]
    }
}

/// The opposite pairs, by ball.
pub(crate) struct Partners {
    starts: Vec<u32>,
    items: Vec<(u32, f64)>,
}

impl Partners {
    pub(crate) fn of(balls: usize, opposites: &[Opposite]) -> Partners {
        let mut starts = vec![0u32; balls + 1];
        for pair in opposites {
            for p in pair.poles {
                starts[p as usize + 1] += 1;
            }
        }
        for b in 0..balls {
            starts[b + 1] += starts[b];
        }
        let mut next = starts.clone();
        let mut items = vec![(0, 0.0); opposites.len() * 2];
        for pair in opposites {
            for (p, q) in [
                (pair.poles[0], pair.poles[1]),
                (pair.poles[1], pair.poles[0]),
            ] {
                items[next[p as usize] as usize] = (q, pair.weight);
                next[p as usize] += 1;
            }
        }
        Partners { starts, items }
    }

    pub(crate) fn at(&self, ball: u32) -> &[(u32, f64)] {
        let b = ball as usize;
        &self.items[self.starts[b] as usize..self.starts[b + 1] as usize]
    }
}

/// The labels, by ball.
#[derive(Clone, Debug, Default)]
pub struct Labels {
    /// The side of each ball.
    pub sides: Vec<Side>,
    /// Balls that no evidence reached before they were labelled.
    pub unreached: u32,
}
