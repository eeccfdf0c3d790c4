//! The first stage of the pipeline: samples, without outliers, and amid noise on the
//! surface, and their Delaunay triangulation.

use super::Clock;
use crate::context::{Context, Stage};
use crate::delaunay::{delaunay, samples, Delaunay, Lattice, Samples};
use crate::error::Error;
use crate::geom::Point;
use crate::noise::{outliers, treat, Stray};
use crate::options::{NoiseOption, Options, OutlierOption};
use crate::stats::Stats;
use crate::tetra::Edges;

/// What the first stage comes to.
pub(super) struct Sampled {
    pub(super) samples: Samples,
    pub(super) delaunay: Delaunay,
    /// The edges of the triangulation.
    pub(super) graph: Edges,
    /// The noise at each sample as a share of the spacing; empty where there is none.
    pub(super) noise: Vec<f32>,
    /// Outliers, by their number in the input.
    pub(super) left_out: Vec<(u32, Stray)>,
}

/// Samples without outliers, moved where they lie amid noise, and their Delaunay
/// triangulation.
pub(super) fn sampled(
    points: &[Point],
    ways: &[Point],
    options: &Options,
    stats: &mut Stats,
    clock: &mut Clock,
    context: &Context,
) -> Result<Sampled, Error> {
    context.advance(Stage::Samples, 0, points.len() as u64)?;
    let mut samples = samples(points, options.box_factor)?;
    stats.points = points.len();
    stats.samples = samples.len();
    stats.duplicates = points.len() - samples.len();
    if options.single {
        resolves(&samples.lattice)?;
    }
    noise_fits(options, &samples.lattice)?;
    clock.lap(Stage::Samples, stats);

    let mut left_out = Vec::new();
    let (mut delaunay, mut graph) = triangulated(&samples, clock, stats, context)?;
    if options.outliers == OutlierOption::Auto {
        let room = samples.sides();
        for _ in 0..OUTLIER_ROUNDS {
            let Some(found) = outliers(&samples, &graph, room, &mut stats.outliers) else {
                break;
            };
            for (s, why) in found.iter().enumerate() {
                left_out.extend(why.map(|why| (samples.source[s], why)));
            }
            let keep: Vec<bool> = found.iter().map(Option::is_none).collect();
            samples = samples.without(&keep, options.box_factor)?;
            clock.lap(Stage::Noise, stats);
            (delaunay, graph) = triangulated(&samples, clock, stats, context)?;
        }
        clock.lap(Stage::Noise, stats);
    }

    let mut noise = Vec::new();
    let outward = of_samples(ways, &samples);
    match treat(&samples, &outward, options.noise, context)? {
        Ok(treated) => {
            stats.noise = treated.report;
            noise = treated.shares;
            samples = samples.moved(&treated.points, options.box_factor)?;
            clock.lap(Stage::Noise, stats);
            (delaunay, graph) = triangulated(&samples, clock, stats, context)?;
        }
        Err(report) => {
            stats.noise = report;
            clock.lap(Stage::Noise, stats);
        }
    }
    stats.delaunay_cells = delaunay.complex.len();
    stats.delaunay_predicates = delaunay.counts;
    // What no later stage reads makes room. The triangulation has the sites.
    delaunay.complex.neighbours = Vec::new();
    Ok(Sampled {
        samples,
        delaunay,
        graph,
        noise,
        left_out,
    })
}

/// The vectors at the samples, of those at the points, if there are any.
pub(super) fn of_samples(ways: &[Point], samples: &Samples) -> Vec<Point> {
    match ways {
        [] => Vec::new(),
        ways => (samples.source.iter()).map(|&p| ways[p as usize]).collect(),
    }
}

/// Times that outliers are looked for at most: those left out hide others.
const OUTLIER_ROUNDS: usize = 4;

/// The Delaunay triangulation of the samples, and its edges.
fn triangulated(
    samples: &Samples,
    clock: &mut Clock,
    stats: &mut Stats,
    context: &Context,
) -> Result<(Delaunay, Edges), Error> {
    let built = delaunay(samples, context)?;
    let graph = built.edges(context)?;
    clock.lap(Stage::Delaunay, stats);
    Ok((built, graph))
}

/// Whether noise of the scale told, if any, leaves something to see.
fn noise_fits(options: &Options, lattice: &Lattice) -> Result<(), Error> {
    match options.noise {
        NoiseOption::Scale(value) if value > lattice.length_to_user(lattice.sample_half) => {
            Err(Error::Option {
                name: "noise",
                value,
                expected: "less than half the largest side of the points' box",
            })
        }
        _ => Ok(()),
    }
}

/// Whether 32-bit coordinates tell a hundred places apart across the samples.
fn resolves(lattice: &Lattice) -> Result<(), Error> {
    let half = lattice.length_to_user(lattice.sample_half);
    let extent = 2.0 * half;
    let farthest = lattice.centre.iter().fold(half, |m, v| m.max(v.abs()));
    let step = match farthest <= f64::from(f32::MAX) / 2.0 {
        true => (farthest * f64::from(f32::EPSILON)).max(f64::from(f32::from_bits(1))),
        false => f64::INFINITY,
    };
    if step * 100.0 > extent {
        return Err(Error::Single { step, extent });
    }
    Ok(())
}
