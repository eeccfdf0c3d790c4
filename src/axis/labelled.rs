//! Balls with their labels and their power diagram.

use rayon::prelude::*;

use super::{dual, estimate};
use crate::context::{Context, Portion};
use crate::delaunay::times_power;
use crate::error::{Error, SampleError};
use crate::geom::vec3::norm;
use crate::geom::{Ball, Bounds, Point, Side};
use crate::pipeline::Reconstruction;
use crate::power::{power_diagram, PowerDiagram};
use crate::predicates::Site;
use crate::simplify::{Contact, Touching};
use crate::surface::{power_shape, PowerShape};
use crate::tetra::{order, Edges};

/// A step of the balls' lattice in steps of the samples' (see
/// [`crate::poles::BallLattice`]).
pub(super) const STEP: f64 = 1024.0;

/// Balls read from a file reach no farther than `2^REACH` steps of the
/// balls' lattice from its origin.
const REACH: i32 = 34;

/// The map between the user's coordinates and the sites of the diagram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid {
    /// The user's coordinates of the origin.
    pub centre: Point,
    /// A step is `2^-exponent` of the user's unit.
    pub exponent: i32,
}

impl Grid {
    /// The user's coordinates of a place among the sites.
    pub fn to_user(self, p: Point) -> Point {
        [0, 1, 2].map(|k| self.centre[k] + times_power(p[k], -self.exponent))
    }

    /// The place among the sites, not rounded.
    pub fn to_sites(self, p: Point) -> Point {
        [0, 1, 2].map(|k| times_power(p[k] - self.centre[k], self.exponent))
    }

    /// A length in steps, in the user's unit.
    pub fn length_to_user(self, length: f64) -> f64 {
        times_power(length, -self.exponent)
    }
}

/// Balls of a medial axis, inner and outer, with their power diagram.
#[derive(Clone, Debug)]
pub struct LabelledBalls {
    /// The balls, in the units of the input.
    pub balls: Vec<Ball>,
    /// Their labels.
    pub sides: Vec<Side>,
    /// What the samples on them span.
    pub contacts: Vec<Contact>,
    /// Whether the contacts are an estimate ([`LabelledBalls::of_shape`]).
    pub estimated: bool,
    /// The index each ball had where it came from.
    pub ids: Vec<u32>,
    /// The input points they touch, where known.
    pub touching: Touching,
    /// The places of the input points, where they are known.
    pub places: Vec<Point>,
    /// The diagonal of the bounding box of the points or, for balls from a
    /// file, of the balls of the file's axis.
    pub diagonal: f64,
    /// The power diagram; its sites are those of the balls.
    power: PowerDiagram,
    /// Where the sites of the diagram lie.
    lattice: Grid,
    /// Whether the balls of both sides are there, so that the diagram tells
    /// which of them are joined.
    both: bool,
}

impl LabelledBalls {
    /// The balls of a reconstruction; `points` are those that were given to
    /// [`crate::reconstruct`].
    pub fn of(result: Reconstruction, points: &[Point]) -> LabelledBalls {
        let contacts = result.contacts(points);
        let source = |&s: &u32| result.sample_source[s as usize];
        LabelledBalls {
            balls: result.balls.iter().map(|b| b.ball).collect(),
            sides: result.balls.iter().map(|b| b.side).collect(),
            contacts,
            estimated: false,
            ids: (0..result.balls.len() as u32).collect(),
            touching: Touching {
                samples: result.touching.samples.iter().map(source).collect(),
                starts: result.touching.starts,
            },
            places: points.to_vec(),
            diagonal: Bounds::of(points).map_or(0.0, |b| b.diagonal()),
            power: result.power,
            lattice: Grid {
                centre: result.lattice.centre,
                exponent: result.lattice.exponent - result.ball_lattice.shift,
            },
            both: true,
        }
    }

    /// The balls of a medial axis read from a file, with those of the other
    /// side if it has them. Of balls at one place the largest is taken. Where
    /// the file does not say what the samples on the balls span, that is
    /// estimated from how the radii change along the edges of the shape.
    ///
    /// # Errors
    /// [`Error::Samples`] for balls too far apart, [`Error::Cancelled`].
    pub fn of_shape(shape: &PowerShape, context: &Context) -> Result<LabelledBalls, Error> {
        context.install(|| of_shape(shape, context))
    }

    /// The balls that `keep` says, their power diagram made anew.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn select(&self, keep: &[bool], context: &Context) -> Result<LabelledBalls, Error> {
        let kept: Vec<u32> = (0..keep.len() as u32)
            .filter(|&b| keep[b as usize])
            .collect();
        let power = self.diagram_of(&kept, context)?;
        let pick = |b: &u32| *b as usize;
        let mut touching = Touching::default();
        if !self.touching.starts.is_empty() {
            touching.starts.push(0);
            for &b in &kept {
                touching.samples.extend_from_slice(self.touching.at(b));
                touching.starts.push(touching.samples.len() as u32);
            }
        }
        Ok(LabelledBalls {
            balls: kept.iter().map(|b| self.balls[pick(b)]).collect(),
            sides: kept.iter().map(|b| self.sides[pick(b)]).collect(),
            contacts: kept.iter().map(|b| self.contacts[pick(b)]).collect(),
            ids: kept.iter().map(|b| self.ids[pick(b)]).collect(),
            touching,
            places: self.places.clone(),
            power,
            ..*self
        })
    }

    /// The same balls at other places and of other sizes.
    pub(super) fn moved(
        &self,
        balls: Vec<Ball>,
        context: &Context,
    ) -> Result<LabelledBalls, Error> {
        let own: Vec<usize> = (0..balls.len())
            .filter(|&b| self.sides[b] == Side::Inner)
            .collect();
        let others: Vec<usize> = (0..balls.len())
            .filter(|&b| self.sides[b] == Side::Outer)
            .collect();
        let shape = PowerShape {
            balls: own.iter().map(|&b| balls[b]).collect(),
            sides: vec![Side::Inner; own.len()],
            contacts: own.iter().map(|&b| self.contacts[b]).collect(),
            others: others.iter().map(|&b| balls[b]).collect(),
            other_contacts: others.iter().map(|&b| self.contacts[b]).collect(),
            ids: own.iter().chain(&others).map(|&b| self.ids[b]).collect(),
            ..PowerShape::default()
        };
        let made = of_shape(&shape, context)?;
        Ok(LabelledBalls {
            diagonal: self.diagonal,
            estimated: self.estimated,
            ..made
        })
    }

    /// How many balls are not where they were.
    pub(super) fn moved_from(&self, before: &LabelledBalls) -> usize {
        let mut old: Vec<(u32, Ball)> = (before.ids.iter().copied())
            .zip(before.balls.iter().copied())
            .collect();
        old.sort_unstable_by_key(|b| b.0);
        let stays = |(id, ball): (&u32, &Ball)| {
            let at = old.binary_search_by_key(id, |b| b.0);
            at.is_ok_and(|at| old[at].1 == *ball)
        };
        self.ids
            .iter()
            .zip(&self.balls)
            .filter(|b| !stays(*b))
            .count()
    }

    /// The power diagram.
    pub(crate) fn power(&self) -> &PowerDiagram {
        &self.power
    }

    /// Where the sites of the diagram lie.
    pub(crate) fn grid(&self) -> Grid {
        self.lattice
    }

    /// The diagonal of the box of the inner balls, 0 if there are none.
    pub fn inner_diagonal(&self) -> f64 {
        let Some(bounds) = self.bounds(Side::Inner) else {
            return 0.0;
        };
        // At a size near 1: squares of tiny and huge lengths are no numbers.
        let sides = [0, 1, 2].map(|k| bounds.max[k] / 2.0 - bounds.min[k] / 2.0);
        let longest = sides.into_iter().fold(0.0, f64::max);
        match longest > 0.0 {
            true => 2.0 * longest * norm(sides.map(|s| s / longest)),
            false => 0.0,
        }
    }

    /// The box of the balls of one side.
    pub(crate) fn bounds(&self, side: Side) -> Option<Bounds> {
        let own = self.balls.iter().zip(&self.sides);
        reach(own.filter(|(_, &s)| s == side).map(|(b, _)| b))
    }

    /// Centre and squared radius of each ball on the lattice of the diagram.
    pub(super) fn sites(&self) -> &[Site] {
        &self.power.sites[..self.balls.len()]
    }

    fn diagram_of(&self, kept: &[u32], context: &Context) -> Result<PowerDiagram, Error> {
        let sites: Vec<Site> = (kept.iter())
            .map(|&b| self.power.sites[b as usize])
            .collect();
        power_diagram(&sites, STEP, context)
    }

    /// Whether there are balls of both sides, so that the power diagram tells
    /// which of them are joined; else it is the union of the balls that does.
    pub fn has_both_sides(&self) -> bool {
        self.both
    }

    /// The power shape of one side.
    pub fn shape(&self, side: Side) -> PowerShape {
        let mut shape = self.complex(side);
        let ids = std::mem::take(&mut shape.ids);
        let pick = |b: &u32| *b as usize;
        shape.contacts = ids.iter().map(|b| self.contacts[pick(b)]).collect();
        if !self.touching.starts.is_empty() {
            shape.touching.starts.push(0);
            for &b in &ids {
                let samples = &mut shape.touching.samples;
                samples.extend_from_slice(self.touching.at(b));
                shape.touching.starts.push(samples.len() as u32);
            }
        }
        let other = |b: &u32| self.sides[pick(b)] != side;
        let others: Vec<u32> = (0..self.balls.len() as u32).filter(other).collect();
        shape.others = others.iter().map(|b| self.balls[pick(b)]).collect();
        shape.other_contacts = others.iter().map(|b| self.contacts[pick(b)]).collect();
        shape.ids = ids.iter().map(|b| self.ids[pick(b)]).collect();
        shape
    }

    /// The balls and simplices of one side, with our ids.
    pub(crate) fn complex(&self, side: Side) -> PowerShape {
        if self.both {
            power_shape(&self.power, &self.balls, &self.sides, side)
        } else {
            dual::complex(&self.power, &self.balls, &self.sides, side)
        }
    }

    /// The same for a part of the balls; ids count among these.
    pub(super) fn complex_of(
        &self,
        keep: &[bool],
        side: Side,
        context: &Context,
    ) -> Result<PowerShape, Error> {
        let kept: Vec<u32> = (0..keep.len() as u32)
            .filter(|&b| keep[b as usize])
            .collect();
        let power = self.diagram_of(&kept, context)?;
        let balls: Vec<Ball> = kept.iter().map(|&b| self.balls[b as usize]).collect();
        let sides: Vec<Side> = kept.iter().map(|&b| self.sides[b as usize]).collect();
        Ok(if self.both {
            power_shape(&power, &balls, &sides, side)
        } else {
            dual::complex(&power, &balls, &sides, side)
        })
    }

    /// Which balls have a cell in the diagram.
    pub(crate) fn visible(&self) -> Vec<bool> {
        let mut visible = vec![true; self.balls.len()];
        for &b in &self.power.hidden {
            visible[b as usize] = false;
        }
        visible
    }

    /// Which balls have cells side by side.
    pub(crate) fn neighbours(&self, progress: &Portion) -> Result<Edges, Error> {
        Ok(Edges::of(&self.power.complex, self.balls.len(), progress)?)
    }
}

fn of_shape(shape: &PowerShape, context: &Context) -> Result<LabelledBalls, Error> {
    let first = shape.sides.first().copied().unwrap_or(Side::Inner);
    let side = |b: usize| shape.sides.get(b).copied().unwrap_or(Side::Inner);
    let count = shape.balls.len();
    let balls: Vec<Ball> = shape.balls.iter().chain(&shape.others).copied().collect();
    let sides: Vec<Side> = (0..count)
        .map(side)
        .chain(shape.others.iter().map(|_| first.opposite()))
        .collect();
    let estimated = shape.contacts.len() < count || shape.other_contacts.len() < shape.others.len();
    let contacts = match estimated {
        false => [&shape.contacts[..], &shape.other_contacts[..]].concat(),
        true => estimate::contacts(shape),
    };
    let (sites, lattice) = sites(&balls)?;
    // Along the curve; of balls at one place the largest comes first.
    let half = 2f64.powi(REACH);
    let mut order: Vec<(u64, u32)> = (0..balls.len())
        .into_par_iter()
        .map(|b| (order::key(&sites[b], half), b as u32))
        .collect();
    order.par_sort_unstable_by(|a, b| {
        let (p, q) = (&sites[a.1 as usize], &sites[b.1 as usize]);
        let at = |k: usize| p[k].total_cmp(&q[k]);
        a.0.cmp(&b.0)
            .then_with(|| at(0).then(at(1)).then(at(2)))
            .then_with(|| q[3].total_cmp(&p[3]))
            .then(a.1.cmp(&b.1))
    });
    let same = |a: &mut (u64, u32), b: &mut (u64, u32)| {
        sites[a.1 as usize][..3] == sites[b.1 as usize][..3]
    };
    order.dedup_by(same);
    let pick = |&(_, b): &(u64, u32)| b as usize;
    let sites: Vec<Site> = order.iter().map(|b| sites[pick(b)]).collect();
    let mut touching = Touching::default();
    if !shape.touching.starts.is_empty() {
        touching.starts.push(0);
        for (_, b) in &order {
            touching.samples.extend_from_slice(shape.touching.at(*b));
            touching.starts.push(touching.samples.len() as u32);
        }
    }
    let sides: Vec<Side> = order.iter().map(|b| sides[pick(b)]).collect();
    Ok(LabelledBalls {
        power: power_diagram(&sites, STEP, context)?,
        balls: order.iter().map(|b| balls[pick(b)]).collect(),
        contacts: order.iter().map(|b| contacts[pick(b)]).collect(),
        estimated,
        ids: order
            .iter()
            .map(|b| shape.ids.get(pick(b)).copied().unwrap_or(pick(b) as u32))
            .collect(),
        touching,
        places: Vec::new(),
        diagonal: reach(shape.balls.iter()).map_or(0.0, |b| b.diagonal()),
        both: sides.iter().any(|&s| s != sides[0]),
        lattice,
        sides,
    })
}

/// The box of balls.
fn reach<'a>(balls: impl Iterator<Item = &'a Ball>) -> Option<Bounds> {
    let ends = |b: &Ball| {
        let r = b.radius;
        [b.centre.map(|v| v - r), b.centre.map(|v| v + r)]
    };
    let corners: Vec<Point> = balls.flat_map(ends).collect();
    Bounds::of(&corners)
}

/// The balls on a lattice that holds them all.
fn sites(balls: &[Ball]) -> Result<(Vec<Site>, Grid), Error> {
    let bounds = reach(balls.iter()).unwrap_or(Bounds {
        min: [0.0; 3],
        max: [0.0; 3],
    });
    let middle = [0, 1, 2].map(|k| bounds.min[k] / 2.0 + bounds.max[k] / 2.0);
    let half = (0..3).fold(0.0f64, |half, k| half.max(bounds.max[k] - middle[k]));
    const WIDEST: f64 = 1e300;
    if half.is_nan() || half > WIDEST {
        return Err(Error::Samples(SampleError::TooWide {
            extent: 2.0 * half,
            limit: WIDEST,
        }));
    }
    let mut exponent = if half > 0.0 {
        REACH - half.log2().ceil() as i32
    } else {
        0
    };
    exponent = exponent.min(2000);
    let on_lattice = |v: f64| times_power(v, exponent).round() + 0.0;
    let site = |b: &Ball| {
        let c = b.centre;
        let at = [0, 1, 2].map(|k| on_lattice(c[k] - middle[k]));
        let radius = times_power(b.radius, exponent);
        [at[0], at[1], at[2], (radius * radius).round()]
    };
    let lattice = Grid {
        centre: middle,
        exponent,
    };
    Ok((balls.par_iter().map(site).collect(), lattice))
}
