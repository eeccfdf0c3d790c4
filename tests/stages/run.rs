//! The stages one after the other, everything kept.

use powercrust::delaunay::{delaunay, samples, Delaunay, Samples};
use powercrust::label::{label, opposites, Evidence, LabelOptions, Labels, Neighbours, Opposite};
use powercrust::poles::{poles, PoleOptions, Poles};
use powercrust::power::{power_diagram, PowerDiagram};
use powercrust::simplify::merge_redundant;
use powercrust::surface::{raw_crust, Placement, RawCrust};
use powercrust::{Ball, Context, Point, Side};

pub struct Run {
    pub samples: Samples,
    pub delaunay: Delaunay,
    /// The spacing at each sample, in lattice steps.
    pub spacing: Vec<f64>,
    pub poles: Poles,
    /// The balls in steps of the samples' lattice.
    pub balls: Vec<Ball>,
    pub power: PowerDiagram,
    pub neighbours: Neighbours,
    pub opposites: Vec<Opposite>,
    pub labels: Labels,
}

impl Run {
    pub fn of(points: &[Point], merge: f64) -> Run {
        let context = Context::default();
        let samples = samples(points, 5.0).unwrap();
        let delaunay = delaunay(&samples, &context).unwrap();
        let poles = poles(&samples, &delaunay, &PoleOptions::default(), &context).unwrap();
        let (poles, spacing) = merge_redundant(
            &samples,
            &delaunay.edges(&context).unwrap(),
            poles,
            merge,
            &context,
        )
        .unwrap();
        let step = poles.balls.lattice.step();
        let power = power_diagram(&poles.balls.sites, step, &context).unwrap();
        let balls = poles.balls.on_lattice();
        let opposites = opposites(&poles.of_sample, &samples.sites, &balls);
        let neighbours = Neighbours::of(&power, &context).unwrap();
        let evidence = Evidence {
            balls: &balls,
            outer: &poles.balls.touches_frame,
            opposites: &opposites,
            outward: &[],
        };
        let labels = label(&evidence, &neighbours, &LabelOptions::default(), &context).unwrap();
        Run {
            samples,
            delaunay,
            spacing,
            poles,
            balls,
            power,
            neighbours,
            opposites,
            labels,
        }
    }

    pub fn evidence(&self) -> Evidence<'_> {
        Evidence {
            balls: &self.balls,
            outer: &self.poles.balls.touches_frame,
            opposites: &self.opposites,
            outward: &[],
        }
    }

    /// The raw crust for any labels, positions in lattice steps.
    pub fn raw(&self, sides: &[Side]) -> RawCrust {
        self.crust(sides, |b| self.poles.balls.touching(b))
    }

    /// The same, no power vertices drawn together at samples.
    pub fn apart(&self, sides: &[Side]) -> RawCrust {
        self.crust(sides, |_| &[])
    }

    fn crust<'a>(&'a self, sides: &[Side], touching: impl Fn(u32) -> &'a [u32] + Sync) -> RawCrust {
        let step = self.step();
        let place = Placement {
            touching: &|b| touching(b),
            sample: &|s| position(&self.samples.sites[s as usize]),
            to_user: &|p| p.map(|v| v * step),
        };
        raw_crust(&self.power, sides, &place)
    }

    pub fn step(&self) -> f64 {
        self.poles.balls.lattice.step()
    }
}

pub fn position(site: &[f64; 4]) -> Point {
    [site[0], site[1], site[2]]
}
