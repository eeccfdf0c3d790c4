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

use std::cmp::Reverse;
use std::hash::{BuildHasherDefault, Hasher};

use priority_queue::PriorityQueue;

use super::{Evidence, LabelOptions, Labels, Neighbours, Partners};
use crate::context::{Cancelled, Context, Stage};
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
/// };
/// let neighbours = Neighbours::of(&diagram);
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
    let partners = Partners::of(count, evidence.opposites);
    let mut belief = vec![[0.0f64; 2]; count];
    for (b, &outer) in evidence.outer.iter().enumerate() {
        if outer {
            belief[b][Side::Outer as usize] = 1.0;
        }
    }
    let mut queue: Queue = (0..count as u32)
        .map(|b| (b, Priority::of(belief[b as usize], b)))
        .collect();
    let mut sides: Vec<Option<Side>> = vec![None; count];
    let mut unreached = 0;
    let mut done = 0u64;
    while let Some((p, _)) = queue.pop() {
        if done.is_multiple_of(4096) {
            context.advance(Stage::Labels, done, count as u64)?;
        }
        done += 1;
        let [inner, outer] = belief[p as usize];
        let (side, value) = if inner == 0.0 && outer == 0.0 {
            unreached += 1;
            (by_neighbours(p, evidence, neighbours, &sides), 0.0)
        } else if inner > outer {
            (Side::Inner, inner)
        } else {
            (Side::Outer, outer)
        };
        sides[p as usize] = Some(side);
        if value == 0.0 {
            continue;
        }
        let mut raise = |q: u32, side: Side, to: f64| {
            let held = &mut belief[q as usize][side as usize];
            if to > *held {
                *held = to;
                queue.change_priority(&q, Priority::of(belief[q as usize], q));
            }
        };
        for &(q, weight) in partners.at(p) {
            if sides[q as usize].is_none() {
                raise(q, side.opposite(), value * weight);
            }
        }
        let ball = &evidence.balls[p as usize];
        for &q in neighbours.at(p) {
            if sides[q as usize].is_none() {
                if let Some(depth) = ball.depth(&evidence.balls[q as usize]) {
                    if depth > options.deep {
                        raise(q, side, value * depth);
                    }
                }
            }
        }
    }
    context.advance(Stage::Labels, count as u64, count as u64)?;
    Ok(Labels {
        sides: sides
            .into_iter()
            .map(|s| s.unwrap_or(Side::Outer))
            .collect(),
        unreached,
    })
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

/// A priority with ties broken towards the smaller ball id.
#[derive(Clone, Copy, PartialEq)]
struct Priority(f64, Reverse<u32>);

impl Priority {
    fn of([inner, outer]: [f64; 2], ball: u32) -> Priority {
        let value = if inner > 0.0 && outer > 0.0 {
            (inner - outer).abs() - 1.0
        } else {
            inner.max(outer)
        };
        Priority(value, Reverse(ball))
    }
}

impl Eq for Priority {}

impl PartialOrd for Priority {
    fn partial_cmp(&self, other: &Priority) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Priority {
    fn cmp(&self, other: &Priority) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0).then(self.1.cmp(&other.1))
    }
}

/// Ball ids are dense: spreading their bits is hash enough.
#[derive(Default)]
struct Spread(u64);

impl Hasher for Spread {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        for &b in bytes {
            self.0 = (self.0 << 8 | b as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        }
    }
    fn write_u32(&mut self, v: u32) {
        self.0 = (v as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}

type Queue = PriorityQueue<u32, Priority, BuildHasherDefault<Spread>>;
