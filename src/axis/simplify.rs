//! Simplification of a medial axis (section 7.3 of the paper): unstable balls
//! go, then redundant ones, then the power diagram of those that stay is made
//! with the old labels.
//!
//! With [`SimplifyOptions::keep_topology`] what goes is checked by the exact
//! Betti numbers of the shape before and after. Where they differ, the balls
//! that were to go are tried by halves, along the curve on which they are
//! numbered and so by places, until the part that makes the difference is small; the balls of that
//! part stay.

use super::{cover, scale, LabelledBalls, SimplifyOptions};
use crate::context::{Context, Portion, Stage};
use crate::error::Error;
use crate::geom::Side;
use crate::simplify::{betti, contained_balls, Betti};
use crate::tetra::Edges;

/// The most power diagrams that are made to find out which balls must stay.
const TRIES: usize = 40;

/// Halvings between a number of balls that are too few for the topology and one of enough.
const NARROWINGS: usize = 3;

/// A simplified medial axis.
#[derive(Clone, Debug)]
pub struct Simplified {
    /// The balls that stay, with their power diagram.
    pub balls: LabelledBalls,
    /// What was done.
    pub report: SimplifyReport,
}

/// What simplifying a medial axis did.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct SimplifyReport {
    /// Balls of the wanted side before.
    pub before: usize,
    /// Those that went as unstable, by whichever of the filters.
    pub unstable: usize,
    /// Those that went as redundant, or to leave no more than asked for.
    pub redundant: usize,
    /// Those that stay.
    pub after: usize,
    /// Balls of both sides that were to go and stay, since without them the
    /// Betti numbers would change.
    pub refused: usize,
    /// Balls that were moved to fit what they stand for.
    pub moved: usize,
    /// The Betti numbers of the shape before; none where they were not asked
    /// for.
    pub betti_before: Option<Betti>,
    /// The Betti numbers of the shape that stays.
    pub betti_after: Option<Betti>,
}

/// Simplifies a medial axis: that of `side`. Unstable balls go on that side
/// only, redundant ones on both: the balls about a convex part touch few
/// samples close together and are still what bounds it.
///
/// # Errors
/// [`Error::Option`] for options out of range, [`Error::Cancelled`].
///
/// ```
/// use powercrust::{axis::{simplify, LabelledBalls, SimplifyOptions}, reconstruct, Context, Options, Side};
/// # let points: Vec<[f64; 3]> = (0..600).map(|k| {
/// #     let (u, v) = (k as f64 * 0.0105, k as f64 * 2.4);
/// #     let rho = 3.0 + v.cos();
/// #     [rho * u.cos(), rho * u.sin(), v.sin()]
/// # }).collect();
/// let context = Context::default();
/// let result = reconstruct(&points, &Options::default(), &context)?;
/// let balls = LabelledBalls::of(result, &points);
/// let options = SimplifyOptions { eps: Some(0.1), delta: Some(0.05), ..Default::default() };
/// let simple = simplify(&balls, &options, Side::Inner, &context)?;
/// assert!(simple.report.after < simple.report.before);
/// assert_eq!(simple.report.betti_after, simple.report.betti_before);
/// let shape = simple.balls.shape(Side::Inner);
/// # assert_eq!(shape.balls.len(), simple.report.after);
/// # Ok::<(), powercrust::Error>(())
/// ```
pub fn simplify(
    balls: &LabelledBalls,
    options: &SimplifyOptions,
    side: Side,
    context: &Context,
) -> Result<Simplified, Error> {
    options.validate()?;
    context.install(|| run(balls, options, side, context))
}

fn run(
    balls: &LabelledBalls,
    options: &SimplifyOptions,
    side: Side,
    context: &Context,
) -> Result<Simplified, Error> {
    let part = |percent| Portion {
        context,
        stage: Stage::Simplify,
        percent,
    };
    let of_side = |keep: &[bool]| {
        let both = keep.iter().zip(&balls.sides);
        both.filter(|(&keep, &s)| keep && s == side).count()
    };
    let mut keep = balls.visible();
    let mut report = SimplifyReport {
        before: of_side(&keep),
        ..SimplifyReport::default()
    };
    let wanted = options
        .keep_topology
        .then(|| betti(&balls.complex(side).simplices()));
    report.betti_before = wanted;
    let mut guard = Guard {
        balls,
        side,
        wanted,
        tries: TRIES,
        refused: 0,
        context,
    };
    let mut graph = None;
    let all = keep.clone();
    // All at once first: mostly nothing is against it.
    let mut left = guard.unasked().filter(options, &mut keep, &mut graph)?;
    if keep != all && !guard.is_same(&keep)? {
        keep = all;
        left = guard.filter(options, &mut keep, &mut graph)?;
    }
    report.unstable = report.before - left;
    let mut stands_for = Vec::new();
    if let Some(most) = options.most.filter(|&most| of_side(&keep) > most) {
        let graph = match graph {
            Some(graph) => graph,
            None => balls.neighbours(&part([50, 55]))?,
        };
        (keep, stands_for) = guard.cover(&keep, &graph, most, &part([55, 80]))?;
        guard.refused += of_side(&keep).saturating_sub(most);
    }
    report.after = of_side(&keep);
    report.redundant = left - report.after;
    report.refused = guard.refused;
    let mut kept = balls.select(&keep, context)?;
    let found = |b: &LabelledBalls| wanted.map(|_| betti(&b.complex(side).simplices()));
    // The guard let nothing go that would have changed them.
    debug_assert_eq!(found(&kept), wanted);
    report.betti_after = wanted;
    stands_for.retain(|&[gone, by]| !keep[gone as usize] && keep[by as usize]);
    if let Some(moved) = cover::improved(balls, &kept, &stands_for, context)? {
        // A better fit is no reason to change the topology.
        if found(&moved) == report.betti_after && moved.balls.len() == kept.balls.len() {
            report.moved = moved.moved_from(&kept);
            kept = moved;
        }
    }
    Ok(Simplified {
        balls: kept,
        report,
    })
}

/// Whether a ball is to go for what its samples span.
fn goes(balls: &LabelledBalls, options: &SimplifyOptions, b: u32) -> bool {
    let contact = &balls.contacts[b as usize];
    let radius = balls.balls[b as usize].radius;
    options.eps.is_some_and(|eps| contact.diameter <= eps)
        || (options.lambda).is_some_and(|lambda| contact.circumradius < lambda)
        || (options.angle).is_some_and(|angle| contact.angle(radius) < angle)
        || options.dey_zhao.is_some_and(|[angle, ratio]| {
            let steep = contact.angle(radius) > 2.0 * angle;
            let far = contact.spacing > 0.0 && contact.diameter > ratio * contact.spacing;
            !steep && !far
        })
}

/// Which balls stay, and which of those gone each of them stands for.
type Covered = (Vec<bool>, Vec<[u32; 2]>);

/// Takes balls out as long as the Betti numbers stay.
struct Guard<'a> {
    balls: &'a LabelledBalls,
    side: Side,
    /// `None`: whatever they become.
    wanted: Option<Betti>,
    /// Diagrams that may still be made.
    tries: usize,
    refused: usize,
    context: &'a Context<'a>,
}

impl Guard<'_> {
    /// One that lets all go.
    fn unasked(&self) -> Guard<'_> {
        Guard {
            wanted: None,
            ..*self
        }
    }

    /// Whether the Betti numbers are those wanted.
    fn is_same(&self, keep: &[bool]) -> Result<bool, Error> {
        let Some(wanted) = self.wanted else {
            return Ok(true);
        };
        let shape = self.balls.complex_of(keep, self.side, self.context)?;
        Ok(betti(&shape.simplices()) == wanted)
    }

    /// Takes out unstable balls of the side, then redundant ones of both; how many of the side
    /// were left between.
    fn filter(
        &mut self,
        options: &SimplifyOptions,
        keep: &mut [bool],
        graph: &mut Option<Edges>,
    ) -> Result<usize, Error> {
        let (balls, side, context) = (self.balls, self.side, self.context);
        let part = |percent| Portion {
            context,
            stage: Stage::Simplify,
            percent,
        };
        let unstable: Vec<u32> = (0..keep.len() as u32)
            .filter(|&b| keep[b as usize] && balls.sides[b as usize] == side)
            .filter(|&b| goes(balls, options, b))
            .collect();
        self.take_out(&unstable, keep)?;
        if let Some(factor) = options.scale {
            let covered = scale::covered(balls, keep, side, factor, context)?;
            self.take_out(&covered, keep)?;
        }
        let own = |&b: &usize| keep[b] && balls.sides[b] == side;
        let left = (0..keep.len()).filter(own).count();
        if let Some(delta) = options.delta {
            let graph = match graph {
                Some(graph) => graph,
                None => graph.insert(balls.neighbours(&part([10, 20]))?),
            };
            let alike = |a: u32, b: u32| balls.sides[a as usize] == balls.sides[b as usize];
            let redundant =
                contained_balls(&balls.balls, keep, &alike, graph, delta, &part([20, 50]))?;
            let mut redundant: Vec<u32> = redundant.iter().map(|pair| pair[0]).collect();
            redundant.sort_unstable();
            self.take_out(&redundant, keep)?;
        }
        Ok(left)
    }

    /// The fewest balls found, `most` or more, that stand for all others and leave the topology as
    /// it is, and which stands for which. Fewer than the topology needs are not kept: more are
    /// allowed by quarters until it is the same, then fewer again between the last two numbers.
    fn cover(
        &self,
        keep: &[bool],
        graph: &Edges,
        most: usize,
        progress: &Portion,
    ) -> Result<Covered, Error> {
        let cover = cover::Cover {
            balls: self.balls,
            keep,
            graph,
            side: self.side,
        };
        let with = |allowed: usize| -> Result<Option<Covered>, Error> {
            let stands_for = cover.at_most(allowed, progress)?;
            let mut kept = keep.to_vec();
            for &[gone, _] in &stands_for {
                kept[gone as usize] = false;
            }
            Ok(self.is_same(&kept)?.then_some((kept, stands_for)))
        };
        let own = |&b: &usize| keep[b] && self.balls.sides[b] == self.side;
        let count = (0..keep.len()).filter(own).count();
        let (mut failed, mut allowed) = (0, most);
        let mut best = (keep.to_vec(), Vec::new());
        while allowed < count {
            if let Some(found) = with(allowed)? {
                best = found;
                break;
            }
            failed = allowed;
            allowed += allowed / 4 + 1;
        }
        if failed > 0 {
            let mut fits = allowed.min(count);
            for _ in 0..NARROWINGS {
                let middle = failed + (fits - failed) / 2;
                if middle == failed {
                    break;
                }
                match with(middle)? {
                    Some(found) => (best, fits) = (found, middle),
                    None => failed = middle,
                }
            }
        }
        Ok(best)
    }

    /// Takes balls out, or those whose part, by halves, leaves the Betti numbers as they are.
    fn take_out(&mut self, out: &[u32], keep: &mut [bool]) -> Result<(), Error> {
        if out.is_empty() {
            return Ok(());
        }
        for &b in out {
            keep[b as usize] = false;
        }
        if self.wanted.is_none() {
            return Ok(());
        }
        if self.tries > 0 {
            self.tries -= 1;
            if self.is_same(keep)? {
                return Ok(());
            }
        }
        for &b in out {
            keep[b as usize] = true;
        }
        if out.len() == 1 || self.tries == 0 {
            self.refused += out.len();
            return Ok(());
        }
        let (first, second) = out.split_at(out.len() / 2);
        self.take_out(first, keep)?;
        self.take_out(second, keep)
    }
}
