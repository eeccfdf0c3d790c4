//! Counts, timings and options of one run: the content of `--stats`.

use std::time::Instant;

use crate::label::{Agreement, Energy, Held, Wound};
use crate::mesh::Shape;
use crate::noise::{CornerReport, NoiseReport, OutlierReport};
use crate::options::Options;
use crate::poles::BoundReport;
use crate::predicates::Counts;

/// What one run did.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Stats {
    /// Points given.
    pub points: usize,
    /// Distinct samples, those left out as outliers among them.
    pub samples: usize,
    /// Points merged into an equal one.
    pub duplicates: usize,
    /// Samples left out because they lie on no surface.
    pub outliers: OutlierReport,
    /// What was found and done about noise.
    pub noise: NoiseReport,
    /// Cells of the Delaunay triangulation, frame included.
    pub delaunay_cells: usize,
    /// What was found and done about sharp edges, with
    /// [`SharpOption::Auto`](crate::options::SharpOption::Auto).
    pub corners: CornerReport,
    /// Distinct polar balls chosen.
    pub poles: usize,
    /// The skinniness bound taken.
    pub lambda: BoundReport,
    /// Samples that failed the skinniness test.
    pub skinny_samples: u32,
    /// Poles dropped by it.
    pub poles_dropped: u32,
    /// Balls of the power diagram, after redundant ones were merged.
    pub balls: usize,
    /// Balls without a cell of their own.
    pub hidden_balls: usize,
    /// Balls labelled inner.
    pub inner_balls: usize,
    /// Balls that no evidence reached.
    pub unreached_balls: u32,
    /// Balls whose label goes against a quarter of the evidence, or more.
    pub torn_balls: usize,
    /// Samples that were off the crust and the balls added for them.
    pub held: Held,
    /// Cells of the regular triangulation, sentinels included.
    pub power_cells: usize,
    /// Power faces between inner and outer cells, but those that lie at one
    /// sample, before clean-up.
    pub power_faces: usize,
    /// Polygons of the crust.
    pub polygons: usize,
    /// Pairs of triangles that crossed or touched where they share nothing,
    /// and triangles of no area, before mending.
    pub crossings_found: usize,
    /// The same in the result: 0 but for a fault.
    pub crossings_left: usize,
    /// Rounds of mending.
    pub mend_rounds: usize,
    /// Changes made to mend.
    pub mended_faces: usize,
    /// Handles thinner than the noise that were cut.
    pub handles_cut: usize,
    /// Vertices drawn apart where sheets of the solid touched.
    pub drawn_apart: usize,
    /// Vertices that are no samples taken out of flat places.
    pub flattened: usize,
    /// Samples taken out of tangles that nothing else undid.
    pub samples_lost: usize,
    /// Balls that changed sides because the surface crossed itself there.
    pub relabelled: usize,
    /// Shells of the size of rounding errors that were inside out: taken out.
    pub inverted_shells: usize,
    /// Shells taken out because they passed through fewer than four samples.
    pub specks: usize,
    /// The shape of the triangles before mending and coarsening.
    pub shape_before: Shape,
    /// Their shape afterwards; the polygons' triangles where there are polygons.
    pub shape_after: Shape,
    /// Faces written (triangles unless polygons were asked for).
    pub faces: usize,
    /// Vertices written.
    pub vertices: usize,
    /// Volume enclosed, in the cube of the input's unit.
    pub volume: f64,
    /// The evidence the labels of the greedy pass go against.
    pub greedy_energy: Energy,
    /// How labels agree with normals or places of scanners given.
    pub outward: Agreement,
    /// Labels changed afterwards to lower it.
    pub flips: u32,
    /// What winding numbers said of the labels; asked only where there was
    /// noise.
    pub wound: Wound,
    /// The evidence the final labels go against.
    pub label_energy: Energy,
    /// Decisions of the Delaunay triangulation by stage.
    pub delaunay_predicates: Counts,
    /// Decisions of the regular triangulation by stage.
    pub power_predicates: Counts,
    /// Seconds by stage, in order.
    pub seconds: Vec<(String, f64)>,
    /// Seconds by part of a stage, `crust: extract` for one, in order. Parts
    /// need not add up to their stage.
    pub part_seconds: Vec<(String, f64)>,
    /// The largest amount of memory that the process had had by the end of
    /// each stage, in bytes; empty where the system does not tell.
    pub peak_bytes: Vec<(String, u64)>,
    /// Every option used.
    pub options: Options,
}

impl Stats {
    /// Nothing counted yet.
    pub fn new(options: &Options) -> Stats {
        Stats {
            points: 0,
            samples: 0,
            duplicates: 0,
            outliers: OutlierReport::default(),
            noise: NoiseReport::default(),
            delaunay_cells: 0,
            corners: CornerReport::default(),
            poles: 0,
            lambda: BoundReport::default(),
            skinny_samples: 0,
            poles_dropped: 0,
            balls: 0,
            hidden_balls: 0,
            inner_balls: 0,
            unreached_balls: 0,
            torn_balls: 0,
            held: Held::default(),
            power_cells: 0,
            power_faces: 0,
            polygons: 0,
            crossings_found: 0,
            crossings_left: 0,
            mend_rounds: 0,
            mended_faces: 0,
            handles_cut: 0,
            drawn_apart: 0,
            flattened: 0,
            samples_lost: 0,
            relabelled: 0,
            inverted_shells: 0,
            specks: 0,
            shape_before: Shape::default(),
            shape_after: Shape::default(),
            faces: 0,
            vertices: 0,
            volume: 0.0,
            greedy_energy: Energy::default(),
            outward: Agreement::default(),
            flips: 0,
            wound: Wound::default(),
            label_energy: Energy::default(),
            delaunay_predicates: Counts::default(),
            power_predicates: Counts::default(),
            seconds: Vec::new(),
            part_seconds: Vec::new(),
            peak_bytes: Vec::new(),
            options: options.clone(),
        }
    }

    /// Counts the time since `clock` for a part of a stage, and starts the
    /// clock again.
    pub(crate) fn part(&mut self, name: &str, clock: &mut Instant) {
        let now = Instant::now();
        let seconds = now.duration_since(*clock).as_secs_f64();
        *clock = now;
        self.add_part(name, seconds);
    }

    /// Adds to the seconds of a part of a stage.
    pub(crate) fn add_part(&mut self, name: &str, seconds: f64) {
        match self.part_seconds.iter_mut().find(|(part, _)| part == name) {
            Some((_, total)) => *total += seconds,
            None => self.part_seconds.push((name.to_string(), seconds)),
        }
    }
}

/// Measures the parts of a step that knows no [`Stats`].
pub(crate) struct Laps {
    last: Instant,
    /// Seconds by part, in order.
    pub seconds: Vec<(&'static str, f64)>,
}

impl Laps {
    /// The first part begins.
    pub fn start() -> Laps {
        Laps {
            last: Instant::now(),
            seconds: Vec::new(),
        }
    }

    /// A part ends, and the next begins.
    pub fn lap(&mut self, part: &'static str) {
        let now = Instant::now();
        let seconds = now.duration_since(self.last).as_secs_f64();
        self.seconds.push((part, seconds));
        self.last = now;
    }
}
