//! The labelling stage of the pipeline: greedy labels, what normals say, then
//! refined ones, and the doubt that is left.

use crate::context::Context;
use crate::delaunay::Delaunay;
use crate::error::Error;
use crate::geom::Point;
use crate::label::{
    doubt, energy, label, opposites, refine, wind, Evidence, LabelOptions, Labels, Neighbours,
    Seen, TORN,
};
use crate::options::{LabelOption, Options};
use crate::poles::Poles;
use crate::power::PowerDiagram;
use crate::stats::Stats;

/// What labels are found from.
pub(super) struct Labelling<'a> {
    pub(super) poles: &'a Poles,
    pub(super) delaunay: &'a Delaunay,
    pub(super) power: &'a PowerDiagram,
    /// The spacing at each sample, in lattice steps.
    pub(super) spacing: &'a [f64],
    pub(super) options: &'a Options,
}

impl Labelling<'_> {
    /// Labels of the balls and the doubt about each, by the geometry on the lattice: no
    /// overflow at any scale. `ways` has a vector out of the solid for each sample, or
    /// is empty.
    pub(super) fn run(
        &self,
        ways: Vec<Point>,
        stats: &mut Stats,
        context: &Context,
    ) -> Result<(Labels, Vec<f32>), Error> {
        let (of_sample, sites) = (&self.poles.of_sample, &self.delaunay.sites);
        let balls = self.poles.balls.on_lattice();
        let pairs = opposites(of_sample, sites, &balls);
        let evidence = Evidence {
            balls: &balls,
            outer: &self.poles.balls.touches_frame,
            opposites: &pairs,
            outward: &[],
        };
        let neighbours = Neighbours::of(self.power, context)?;
        let how = LabelOptions {
            deep: -self.options.deep_angle.to_radians().cos(),
        };
        let mut labels = label(&evidence, &neighbours, &how, context)?;
        let mut seen = None;
        if !ways.is_empty() {
            (stats.outward, seen) = Seen::of(&evidence, of_sample, sites, ways, &labels.sides);
        }
        let (said, ways) = match &seen {
            Some(seen) => (&seen.said[..], &seen.ways[..]),
            None => (&[][..], &[][..]),
        };
        let evidence = Evidence {
            outward: said,
            ..evidence
        };
        if seen.is_some() {
            labels = Seen::label_again(&evidence, &neighbours, labels, &how, context)?;
        }
        let refined = self.options.label == LabelOption::Refined;
        let greedy = refined.then(|| labels.sides.clone());
        if refined {
            stats.flips = refine(&evidence, &neighbours, &mut labels, &how);
        }
        if refined && stats.noise.treated {
            let found = wind(
                &evidence,
                of_sample,
                sites,
                self.spacing,
                ways,
                &mut labels,
                context,
            );
            stats.wound = found?;
        }
        stats.unreached_balls = labels.unreached;
        let (left, doubt) = doubt(&evidence, &neighbours, &labels.sides, &how);
        stats.label_energy = left;
        stats.greedy_energy = match greedy.filter(|_| stats.flips + stats.wound.changed > 0) {
            Some(greedy) => energy(&evidence, &neighbours, &greedy, &how),
            None => left,
        };
        stats.torn_balls = doubt.iter().filter(|&&d| d >= TORN).count();
        Ok((labels, doubt))
    }
}
