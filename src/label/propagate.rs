//! The greedy propagation of figure 8 of the paper.
//!
//! ```text
//! in(p) = out(p) = 0 for all poles; out(p) = 1 at the frame
//! pri(p) = |in - out| - 1 if both are positive, else max(in, out)
//! while the queue is not empty:
//!     p = top; label it by the larger value v
//!     for the other pole q of each sample of p:   opposite(q) = max(opposite(q), v * -cos(p s q))
//!     for each deeply intersecting neighbour q:   same(q)     = max(same(q), v * -cos(alpha))
//! ```

use super::queue::Queue;
use super::{Evidence, LabelOptions, Labels, Neighbours, Partners};
use crate::context::{Cancelled, Context, Portion, Stage};
use crate::geom::Side;

/// Labels every ball.
///
/// # Errors
/// [`Cancelled`].
///
/// ```
/// use powercrust::label::{label, Evidence, LabelOptions, Neighbours, Opposite};
/// use powercrust::{power, Ball, Context, Side};
/// // A ball at the frame, its opposite, and a ball deep inside the opposite.
/// let sites = [[0.0, 0.0, 90.0, 1600.0], [0.0, 0.0, 0.0, 2500.0], [3.0, 0.0, 0.0, 2500.0]];
/// let balls = sites.map(|s| Ball::new([s[0], s[1], s[2]], s[3].sqrt()));
/// let diagram = power::power_diagram(&sites, 1024.0, &Context::default())?;
/// let opposites = [Opposite { poles: [0, 1], weight: 1.0 }];
/// let evidence = Evidence {
///     balls: &balls,
///     outer: &[true, false, false],
///     opposites: &opposites,
///     outward: &[],
/// };
/// let neighbours = Neighbours::of(&diagram, &Context::default())?;
/// let labels = label(&evidence, &neighbours, &LabelOptions::default(), &Context::default())?;
/// assert_eq!(labels.sides, [Side::Outer, Side::Inner, Side::Inner]);
/// # Ok::<(), powercrust::Error>(())
/// ```
pub fn label(
    evidence: &Evidence,
    neighbours: &Neighbours,
    options: &LabelOptions,
    context: &Context,
) -> Result<Labels, Cancelled> {
    let count = evidence.balls.len();
    let mut work = Work {
        evidence,
        neighbours,
        options,
        partners: Partners::of(count, evidence.opposites),
        belief: vec![[0.0; 2]; count],
        queue: Queue::new(count),
        sides: vec![None; count],
    };
    for b in (0..count as u32).filter(|&b| evidence.outer[b as usize]) {
        work.raise(b, Side::Outer, 1.0);
    }
    for b in 0..evidence.outward.len() as u32 {
        let outer = evidence.said(b, Side::Outer);
        let side = if outer > 0.0 {
            Side::Outer
        } else {
            Side::Inner
        };
        work.raise(b, side, TRUST * outer.abs().min(1.0));
    }
    let progress = Portion {
        context,
        stage: Stage::Labels,
        percent: [40, 90],
    };
    let mut unreached = None;
    let mut done = 0;
    while let Some((p, priority)) = work.queue.pop() {
        if done % REPORT == 0 {
            progress.advance(done, count)?;
        }
        done += 1;
        // Balls that no evidence has reached have priority 0.
        if priority < 0.0 && unreached.is_none() {
            unreached = Some(work.label_unreached());
        }
        work.label(p);
    }
    let unreached = unreached.unwrap_or_else(|| work.label_unreached());
    progress.advance(count, count)?;
    Ok(Labels {
        sides: (work.sides.into_iter())
            .map(|s| s.unwrap_or(Side::Outer))
            .collect(),
        unreached,
    })
}

/// How much normals are believed; the frame is believed without reserve.
const TRUST: f64 = 0.9;

/// Balls labelled between two reports of progress.
const REPORT: usize = 4096;

/// The state of the propagation.
struct Work<'a> {
    evidence: &'a Evidence<'a>,
    neighbours: &'a Neighbours,
    options: &'a LabelOptions,
    partners: Partners,
    /// in(p) and out(p).
    belief: Vec<[f64; 2]>,
    /// Balls that evidence has reached and that have no label yet.
    queue: Queue,
    sides: Vec<Option<Side>>,
}

impl Work<'_> {
    /// Labels a ball and spreads what it believes.
    fn label(&mut self, p: u32) {
        let [inner, outer] = self.belief[p as usize];
        let (side, value) = if inner > outer {
            (Side::Inner, inner)
        } else {
            (Side::Outer, outer)
        };
        self.sides[p as usize] = Some(side);
        for k in self.partners.range(p) {
            let (q, weight) = self.partners.items[k];
            self.raise(q, side.opposite(), value * weight);
        }
        let (evidence, neighbours) = (self.evidence, self.neighbours);
        for &q in neighbours.at(p) {
            if self.sides[q as usize].is_none() {
                if let Some(depth) = evidence.depth(p, q, self.options) {
                    self.raise(q, side, value * depth);
                }
            }
        }
    }

    /// Raises what is believed of a ball that has no label.
    #[inline]
    fn raise(&mut self, q: u32, side: Side, to: f64) {
        if self.sides[q as usize].is_some() {
            return;
        }
        let belief = &mut self.belief[q as usize];
        if to > belief[side as usize] {
            belief[side as usize] = to;
            self.queue.set(q, priority(*belief));
        }
    }

    /// Labels the balls that no evidence has reached, by what their
    /// neighbours say; returns how many there are.
    fn label_unreached(&mut self) -> u32 {
        let mut count = 0;
        for p in 0..self.sides.len() {
            if self.sides[p].is_none() && self.belief[p] == [0.0; 2] {
                count += 1;
                let side = by_neighbours(p as u32, self.evidence, self.neighbours, &self.sides);
                self.sides[p] = Some(side);
            }
        }
        count
    }
}

/// pri(p).
fn priority([inner, outer]: [f64; 2]) -> f64 {
    if inner > 0.0 && outer > 0.0 {
        (inner - outer).abs() - 1.0
    } else {
        inner.max(outer)
    }
}

/// What the labelled neighbours of a ball say, however shallowly they
/// intersect it: the side with the larger sum of `1 - cos alpha`.
fn by_neighbours(
    p: u32,
    evidence: &Evidence,
    neighbours: &Neighbours,
    sides: &[Option<Side>],
) -> Side {
    let mut votes = [0.0f64; 2];
    for &q in neighbours.at(p) {
        let depth = evidence.balls[p as usize].depth(&evidence.balls[q as usize]);
        if let (Some(side), Some(depth)) = (sides[q as usize], depth) {
            votes[side as usize] += 1.0 + depth;
        }
    }
    if votes[Side::Inner as usize] > votes[Side::Outer as usize] {
        Side::Inner
    } else {
        Side::Outer
    }
}
