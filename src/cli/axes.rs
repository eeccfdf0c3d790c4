//! The medial axes of a run, and what is told of a run that makes no surface.

use std::time::Instant;

use powercrust::io::Cloud;
use powercrust::stats::Stats;
use powercrust::{PowerShape, Reconstruction, Side};

use super::plan::Plan;
use super::show::{counted, grouped, Talk};
use super::tell;

/// The medial axes that are wanted.
pub struct Axes {
    pub inner: Option<PowerShape>,
    pub outer: Option<PowerShape>,
}

impl Axes {
    pub fn of(plan: &Plan, result: &Reconstruction, cloud: &Cloud) -> Axes {
        let shape = |wanted: bool, side| {
            wanted.then(|| {
                let mut shape = result.axis(side, &cloud.points);
                if plan.thin {
                    shape.thin();
                }
                shape
            })
        };
        Axes {
            inner: shape(plan.inner_axis.is_some(), Side::Inner),
            outer: shape(plan.outer_axis.is_some(), Side::Outer),
        }
    }

    /// The summary of a run without a surface.
    pub fn tell(&self, plan: &Plan, stats: &Stats, start: Instant) {
        tell::stages(plan, &stats.seconds);
        let mut parts = vec![format!("{} samples", grouped(stats.samples))];
        for (shape, which) in [(&self.inner, "inner"), (&self.outer, "outer")] {
            if let Some(shape) = shape {
                let (one, many) = (format!("{which} ball"), format!("{which} balls"));
                parts.push(counted(shape.balls.len(), &one, &many));
                parts.push(counted(shape.triangles.len(), "triangle", "triangles"));
            }
        }
        parts.push("no surface made".to_owned());
        parts.push(format!("{:.2} s", start.elapsed().as_secs_f64()));
        let place = plan.first_result();
        plan.talk
            .at(Talk::Plain, format_args!("{place}: {}", parts.join(", ")));
    }
}
