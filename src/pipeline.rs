//! Points in, surface and medial axis out: the stages in order.

use std::time::Instant;

use rayon::prelude::*;

use crate::context::{Context, Stage};
use crate::delaunay::Lattice;
use crate::error::Error;
use crate::geom::{Ball, Point, Side};
use crate::label::{hold, MOST_UNHELD};
use crate::memory;
use crate::noise::{corners, Stray};
use crate::options::{Faces, Options, SharpOption};
use crate::poles::{poles, BallLattice, Bound, DroppedPole, PoleOptions};
use crate::power::{power_diagram, PowerDiagram};
use crate::simplify::{merge_redundant, Contact, Touching};
use crate::stats::Stats;
use crate::surface::stage::Job;
use crate::surface::{drop_strays, power_shape, Crust, PowerShape, FEWEST, FEWEST_AMID_NOISE};
use crate::tetra::Complex;

mod labelling;
mod sampling;

use labelling::Labelling;
use sampling::{of_samples, sampled, Sampled};

/// A polar ball with what the pipeline found out about it.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarBall {
    /// Centre and radius.
    pub ball: Ball,
    /// Its label.
    pub side: Side,
    /// One sample it touches (the smallest sample id).
    pub sample: u32,
}

/// The result: everything owned, nothing borrowed.
#[derive(Clone, Debug)]
pub struct Reconstruction {
    /// The watertight surface.
    pub crust: Crust,
    /// All polar balls of the power diagram with their labels.
    pub balls: Vec<PolarBall>,
    /// The share of the evidence on each ball that its label goes against, in
    /// [0, 1]: see [`mod@crate::label`].
    pub doubt: Vec<f32>,
    /// For each sample id (the `vertex_samples` of the crust) the index of
    /// the first input point at that place.
    pub sample_source: Vec<u32>,
    /// Where each sample lies, if samples amid noise were moved
    /// ([`Options::noise`]); empty if all lie where they were given.
    pub moved: Vec<Point>,
    /// The samples left out because they lie on no surface
    /// ([`Options::outliers`]): an input point at each, ascending, and why.
    pub outliers: Vec<(u32, Stray)>,
    /// The poles dropped (section 6), by sample, in the units of the input.
    pub dropped: Vec<DroppedPole>,
    /// The power diagram of the balls; its sites are in steps of the lattice
    /// of balls.
    pub power: PowerDiagram,
    /// The samples that each ball touches, or stands for.
    pub touching: Touching,
    /// The spacing of the samples at each sample, in the units of the input.
    pub spacing: Vec<f64>,
    /// The lattice of the samples.
    pub lattice: Lattice,
    /// The lattice of the balls, so much coarser.
    pub ball_lattice: BallLattice,
    /// Counts and timings.
    pub stats: Stats,
}

impl Reconstruction {
    /// The power shape of one side: the approximate medial axis (section 3.4).
    pub fn power_shape(&self, side: Side) -> PowerShape {
        let balls: Vec<Ball> = self.balls.iter().map(|b| b.ball).collect();
        let sides: Vec<Side> = self.balls.iter().map(|b| b.side).collect();
        power_shape(&self.power, &balls, &sides, side)
    }

    /// The power shape of one side with all that is known of its balls, and the
    /// balls of the other side; `points` are those that were given to
    /// [`reconstruct`].
    pub fn axis(&self, side: Side, points: &[Point]) -> PowerShape {
        let mut shape = self.power_shape(side);
        let contacts = self.contacts(points);
        shape.contacts = shape.ids.iter().map(|&b| contacts[b as usize]).collect();
        shape.touching.starts.push(0);
        for &b in &shape.ids {
            let samples = self.touching.at(b).iter();
            let source = |&s: &u32| self.sample_source[s as usize];
            shape.touching.samples.extend(samples.map(source));
            shape
                .touching
                .starts
                .push(shape.touching.samples.len() as u32);
        }
        for (ball, contact) in self.balls.iter().zip(contacts) {
            if ball.side != side {
                shape.others.push(ball.ball);
                shape.other_contacts.push(contact);
            }
        }
        shape
    }

    /// What the samples on each ball span (section 7.3); `points` are those
    /// that were given to [`reconstruct`].
    pub fn contacts(&self, points: &[Point]) -> Vec<Contact> {
        let of_ball = |b: u32| {
            let samples = self.touching.at(b);
            let place = |&s: &u32| match self.moved.get(s as usize) {
                Some(&moved) => moved,
                None => points[self.sample_source[s as usize] as usize],
            };
            let places: Vec<Point> = samples.iter().map(place).collect();
            let wider = |most: f64, &s: &u32| most.max(self.spacing[s as usize]);
            Contact::of(&places, samples.iter().fold(0.0, wider))
        };
        let count = self.balls.len() as u32;
        (0..count).into_par_iter().map(of_ball).collect()
    }
}

/// Points in, watertight crust and medial axis out (section 5).
///
/// # Errors
/// [`Error`]: points that bound no solid, options out of range, cancellation.
///
/// ```
/// use powercrust::{reconstruct, Context, Options};
/// // The corners and face centres of a cube.
/// let mut points = vec![];
/// for x in -1..=1 { for y in -1..=1 { for z in -1..=1 {
///     if [x, y, z] != [0, 0, 0] { points.push([x as f64, y as f64, z as f64]); }
/// }}}
/// let result = reconstruct(&points, &Options::default(), &Context::default())?;
/// assert!((result.crust.mesh.volume() - 8.0).abs() < 1.5);
/// # Ok::<(), powercrust::Error>(())
/// ```
pub fn reconstruct(
    points: &[Point],
    options: &Options,
    context: &Context,
) -> Result<Reconstruction, Error> {
    reconstruct_seen(points, &[], options, context)
}

/// [`reconstruct`] with a vector out of the solid at each point, where one is
/// known: its normal, or the way to the scanner that saw it; of any length, zero where nothing
/// is known. They are evidence for the labels, beside all other, if they agree with
/// most labels found without them, or all point inwards ([`label::Agreement`]).
///
/// # Errors
/// As [`reconstruct`]; [`Error::Option`] if there are vectors, but not one for
/// each point.
///
/// [`label::Agreement`]: crate::label::Agreement
pub fn reconstruct_seen(
    points: &[Point],
    outward: &[Point],
    options: &Options,
    context: &Context,
) -> Result<Reconstruction, Error> {
    options.validate()?;
    if !outward.is_empty() && outward.len() != points.len() {
        return Err(Error::Option {
            name: "outward",
            value: outward.len() as f64,
            expected: "a vector for each point, or none",
        });
    }
    context.install(|| run(points, outward, options, context))
}

fn run(
    points: &[Point],
    ways: &[Point],
    options: &Options,
    context: &Context,
) -> Result<Reconstruction, Error> {
    let mut stats = Stats::new(options);
    let mut clock = Clock::start();

    // 1. Samples, frame, Delaunay triangulation; outliers and noise seen to.
    let Sampled {
        mut samples,
        delaunay,
        graph,
        noise,
        mut left_out,
    } = sampled(points, ways, options, &mut stats, &mut clock, context)?;

    // Samples at sharp edges, where told by their neighbours.
    let corners = match options.sharp {
        SharpOption::Auto => Some(corners(&samples, stats.noise.treated, context)?),
        _ => None,
    };
    if corners.is_some() {
        clock.lap(Stage::Noise, &mut stats);
    }

    // 2. Poles; balls that say nothing new are merged (fact F6).
    let (bound, bound_report) = Bound::choose(options.lambda, samples.len(), &noise);
    stats.lambda = bound_report;
    let chosen = PoleOptions {
        bound,
        sharp: options.sharp == SharpOption::Skinny,
    };
    let mut poles = poles(&samples, &delaunay, &chosen, context)?;
    stats.skinny_samples = poles.samples_short() as u32;
    stats.poles_dropped = poles.dropped.len() as u32;
    if let Some(corners) = &corners {
        (poles, stats.corners) = poles.extended(corners);
    }
    stats.poles = poles.balls.len();
    let dropped = in_user_units(std::mem::take(&mut poles.dropped), &samples.lattice);
    let (mut poles, spacing) = merge_redundant(&samples, &graph, poles, options.merge, context)?;
    drop(graph);
    stats.balls = poles.balls.len();
    samples.sites = Vec::new();
    clock.lap(Stage::Poles, &mut stats);

    // 3. Power diagram.
    let step = poles.balls.lattice.step();
    let mut power = power_diagram(&poles.balls.sites, step, context)?;
    stats.power_cells = power.complex.len();
    stats.hidden_balls = power.hidden.len();
    stats.power_predicates = power.counts;
    clock.lap(Stage::Power, &mut stats);

    // 4. Labels; samples off the surface between them are held.
    let seen = of_samples(ways, &samples);
    let job = Labelling {
        poles: &poles,
        delaunay: &delaunay,
        power: &power,
        spacing: &spacing,
        options,
    };
    let (mut labels, mut doubt) = job.run(seen, &mut stats, context)?;
    let most = match (options.sharp, options.interpolate) {
        (_, Some(true)) => 1.0,
        (_, Some(false)) | (SharpOption::Skinny, None) => 0.0,
        (_, None) => MOST_UNHELD,
    };
    let balls = &mut poles.balls;
    stats.held = hold(&delaunay, balls, &mut power, &mut labels, most, context)?;
    drop((delaunay, poles.of_sample));
    doubt.resize(labels.sides.len(), 0.0);
    stats.inner_balls = labels.sides.iter().filter(|&&s| s == Side::Inner).count();
    clock.lap(Stage::Labels, &mut stats);

    // 5. Crust.
    let mut sides = labels.sides;
    let scale: Vec<f64> = (noise.iter().zip(&spacing))
        .map(|(&share, h)| f64::from(share) * h)
        .collect();
    let mut job = Job {
        noise: &scale,
        samples: &samples,
        spacing: &spacing,
        balls: &poles.balls,
        power: &mut power,
        options,
    };
    let mut crust = match options.faces {
        Faces::None if stats.inner_balls == 0 => return Err(job.nothing()),
        Faces::None => Crust::default(),
        _ => job.run(&mut sides, &mut stats, context)?,
    };
    if !options.cells {
        power.complex = Complex::default();
    }
    let fewest = match stats.noise.treated {
        true => FEWEST_AMID_NOISE,
        false => FEWEST,
    };
    let strays = drop_strays(&mut crust, fewest);
    (stats.inverted_shells, stats.specks) = (strays.inverted, strays.specks);
    if strays.inverted + strays.specks > 0 {
        stats.vertices = crust.mesh.vertices.len();
        stats.faces = crust.mesh.face_count();
        stats.volume = crust.mesh.volume();
    }
    let moved = match stats.noise.treated {
        true => samples.points,
        false => Vec::new(),
    };
    let lattice = samples.lattice;
    let balls = (poles.balls.on_lattice().iter())
        .zip(&sides)
        .enumerate()
        .map(|(b, (ball, &side))| PolarBall {
            ball: Ball::new(
                lattice.to_user(ball.centre),
                lattice.length_to_user(ball.radius),
            ),
            side,
            sample: poles
                .balls
                .touching(b as u32)
                .first()
                .copied()
                .unwrap_or(u32::MAX),
        })
        .collect();
    let touching = Touching {
        starts: poles.balls.touch_starts,
        samples: poles.balls.touched,
    };
    let spacing = spacing.iter().map(|&h| lattice.length_to_user(h));
    let spacing = spacing.collect();
    left_out.sort_unstable_by_key(|s| s.0);
    clock.lap(Stage::Crust, &mut stats);
    Ok(Reconstruction {
        crust,
        balls,
        doubt,
        sample_source: samples.source,
        moved,
        outliers: left_out,
        dropped,
        power,
        touching,
        spacing,
        lattice,
        ball_lattice: poles.balls.lattice,
        stats,
    })
}

/// Poles as they lie in the input.
fn in_user_units(mut dropped: Vec<DroppedPole>, lattice: &Lattice) -> Vec<DroppedPole> {
    for pole in &mut dropped {
        pole.centre = lattice.to_user(pole.centre);
        pole.radius = lattice.length_to_user(pole.radius);
        pole.bound = lattice.length_to_user(pole.bound);
    }
    dropped
}

/// Measures the stages.
struct Clock(Instant);

impl Clock {
    fn start() -> Clock {
        Clock(Instant::now())
    }

    fn lap(&mut self, stage: Stage, stats: &mut Stats) {
        let now = Instant::now();
        let seconds = now.duration_since(self.0).as_secs_f64();
        match stats.seconds.iter_mut().find(|s| s.0 == stage.name()) {
            Some((_, total)) => *total += seconds,
            None => stats.seconds.push((stage.name().to_string(), seconds)),
        }
        if let Some(bytes) = memory::peak() {
            match stats.peak_bytes.iter_mut().find(|s| s.0 == stage.name()) {
                Some((_, most)) => *most = bytes,
                None => stats.peak_bytes.push((stage.name().to_string(), bytes)),
            }
        }
        self.0 = now;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::NoiseOption;

    /// The cells may go: the surface is the same, and they can be made again, those of
    /// balls added later included.
    #[test]
    fn cells_that_were_dropped_can_be_made_again() {
        let share = |k: u32, of: f64| (f64::from(k) * of).fract() * 2.0 - 1.0;
        let on_cube = |k: u32| {
            let mut p = [share(k, 0.618_034), share(k, 0.754_878), share(k, 0.569_84)];
            p[k as usize % 3] = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
            p
        };
        let points: Vec<Point> = (0..3000).map(on_cube).collect();
        let run = |cells| {
            let options = Options {
                cells,
                ..Options::default()
            };
            reconstruct(&points, &options, &Context::default()).unwrap()
        };
        let (with, without) = (run(true), run(false));
        assert!(with.stats.held.added > 0);
        assert!(without.power.complex.is_empty());
        assert_eq!(with.crust.mesh, without.crust.mesh);
        let (power, step) = (&with.power, with.ball_lattice.step());
        let again = power_diagram(&power.sites[..power.balls], step, &Context::default()).unwrap();
        assert_eq!(again.complex.cells, power.complex.cells);
        assert_eq!(again.complex.neighbours, power.complex.neighbours);
    }

    #[test]
    fn noise_wider_than_the_cloud_is_refused() {
        let points: Vec<Point> = (0..27)
            .map(|k| [k % 3, k / 3 % 3, k / 9].map(f64::from))
            .collect();
        let run = |scale| {
            let options = Options {
                noise: NoiseOption::Scale(scale),
                ..Options::default()
            };
            reconstruct(&points, &options, &Context::default())
        };
        for scale in [1.001, 1e300] {
            let error = run(scale).unwrap_err();
            assert!(
                matches!(error, Error::Option { name: "noise", .. }),
                "{error}"
            );
        }
        let stats = run(0.01).unwrap().stats;
        assert!(stats.noise.share.is_finite());
    }

    #[test]
    fn single_precision_far_from_the_origin_is_refused() {
        let far = |k: u32| {
            [
                f64::from(k % 3),
                f64::from(k / 3 % 3),
                9e13 + f64::from(k / 9),
            ]
        };
        let points: Vec<Point> = (0..27).map(far).collect();
        let options = Options {
            single: true,
            ..Options::default()
        };
        let error = reconstruct(&points, &options, &Context::default()).unwrap_err();
        assert!(matches!(error, Error::Single { .. }), "{error}");
    }

    #[test]
    fn what_32_bits_cannot_hold_is_refused() {
        let options = Options {
            single: true,
            ..Options::default()
        };
        for (unit, held) in [(1e300, false), (1e-310, false), (1e36, true), (1e-36, true)] {
            let corner = |k: u32| [k & 1, k >> 1 & 1, k >> 2 & 1].map(|b| f64::from(b) * unit);
            let points: Vec<Point> = (0..8).map(corner).collect();
            let result = reconstruct(&points, &options, &Context::default());
            let refused = matches!(result, Err(Error::Single { .. }));
            assert_eq!(refused, !held, "{unit:e}");
        }
    }
}
