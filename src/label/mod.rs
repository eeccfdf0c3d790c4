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
mod doubt;
mod energy;
mod hold;
mod outward;
mod propagate;
mod queue;
mod refine;
mod wind;
mod winding;

pub use check::{check, Finding};
pub use doubt::{doubt, TORN};
pub use energy::{energy, Energy};
pub use hold::{hold, Held, MOST_UNHELD};
pub use outward::{Agreement, Seen};
pub use propagate::label;
pub use refine::refine;
pub use wind::{wind, Wound};

use rayon::prelude::*;

use crate::context::{Cancelled, Context, Portion, Stage};
use crate::geom::{Ball, Side};
use crate::poles::NO_POLE;
use crate::power::PowerDiagram;
use crate::predicates::Site;
use crate::tetra::Edges;

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
    /// What normals say of each ball ([`Seen`]): outer where positive. Empty
    /// where nobody says anything.
    pub outward: &'a [f32],
}

impl Evidence<'_> {
    /// What normals say for a side of a ball, if anything.
    #[inline]
    fn said(&self, ball: u32, side: Side) -> f64 {
        let outward = self.outward.get(ball as usize).copied().unwrap_or(0.0);
        match side {
            Side::Outer => f64::from(outward),
            Side::Inner => -f64::from(outward),
        }
    }

    /// How deeply two balls intersect, if they do.
    #[inline]
    fn depth(&self, p: u32, q: u32, options: &LabelOptions) -> Option<f64> {
        let depth = self.balls[p as usize].depth(&self.balls[q as usize])?;
        (depth > options.deep).then_some(depth)
    }
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
pub fn opposites(of_sample: &[[u32; 2]], sites: &[Site], balls: &[Ball]) -> Vec<Opposite> {
    use crate::geom::vec3::{dot, norm, sub};
    let pair = |(poles, s): (&[u32; 2], &Site)| {
        if poles.contains(&NO_POLE) || poles[0] == poles[1] {
            return None;
        }
        let at = [s[0], s[1], s[2]];
        let [p, q] = poles.map(|b| sub(balls[b as usize].centre, at));
        let lengths = norm(p) * norm(q);
        let weight = if lengths > 0.0 {
            (-dot(p, q) / lengths).min(1.0)
        } else {
            0.0
        };
        (weight > 0.0).then_some(Opposite {
            poles: *poles,
            weight,
        })
    };
    let samples = of_sample.par_iter().zip(sites);
    samples.filter_map(pair).collect()
}

/// The neighbours of each ball in the power diagram, sentinels left out.
pub struct Neighbours(Edges);

impl Neighbours {
    /// Collects the edges of the regular triangulation.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn of(power: &PowerDiagram, context: &Context) -> Result<Neighbours, Cancelled> {
        let progress = Portion {
            context,
            stage: Stage::Labels,
            percent: [0, 40],
        };
        Edges::of(&power.complex, power.balls, &progress).map(Neighbours)
    }

    /// The neighbours of a ball, ascending.
    #[inline]
    pub fn at(&self, ball: u32) -> &[u32] {
        self.0.at(ball)
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
        &self.items[self.range(ball)]
    }

    pub(crate) fn range(&self, ball: u32) -> std::ops::Range<usize> {
        let b = ball as usize;
        self.starts[b] as usize..self.starts[b + 1] as usize
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
