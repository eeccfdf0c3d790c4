//! What a run found, told in one line, in JSON, or at length.

use std::time::Instant;

use powercrust::io::ReadReport;
use powercrust::mesh::{check, CheckOptions, Report as Findings};
use powercrust::{Cancelled, Context, Faces, PowerShape, Reconstruction, Side};
use serde_json::{json, Value};

use super::fail::name;
use super::output::Target;
use super::plan::Plan;
use super::show::{counted, grouped, Talk};

/// What the run found, for the summary, `--json` and `--stats`.
pub struct Report {
    findings: Findings,
    samples: usize,
    stages: Vec<(String, f64)>,
    pub inner_axis: Option<PowerShape>,
    pub outer_axis: Option<PowerShape>,
    /// For `--json`.
    summary: Value,
    /// For `--stats`.
    pub stats: Value,
}

impl Report {
    /// Judges the mesh and gathers what else there is to tell.
    pub fn new(
        plan: &Plan,
        result: &Reconstruction,
        input: ReadReport,
        context: &Context,
    ) -> Result<Report, Cancelled> {
        // Closed, manifold, oriented: cheap and always looked at. The search
        // for crossing faces would be a quarter of the run (12,745 samples:
        // 0.13 of 0.52 s), so it waits to be asked for.
        let options = CheckOptions {
            intersections: plan.check,
            max_findings: 0,
            ..CheckOptions::default()
        };
        let findings = check(&result.crust.mesh, &options, context)?;
        let shape = |wanted: bool, side| wanted.then(|| result.power_shape(side));
        let inner_axis = shape(plan.inner_axis.is_some(), Side::Inner);
        let outer_axis = shape(plan.outer_axis.is_some(), Side::Outer);
        let mut head = json!({
            "powercrust": env!("CARGO_PKG_VERSION"),
            "input": { "file": name(&plan.input), "read": input },
            "mesh": {
                "vertices": findings.vertices,
                "faces": findings.faces,
                "closed": findings.is_closed(),
                "manifold": findings.counts.non_manifold_edge + findings.counts.pinched_vertex == 0,
                "components": findings.components,
                "genus": findings.genus,
                "cavities": findings.cavities,
                "volume": findings.volume,
                "area": findings.area,
            },
        });
        if plan.check {
            head["mesh"]["sound"] = json!(findings.is_watertight());
            head["mesh"]["crossing"] = json!(findings.counts.crossing);
            head["mesh"]["touching"] = json!(findings.counts.touching);
        }
        let mut stats = head.clone();
        stats["stats"] = json!(result.stats);
        let mut summary = head;
        summary["ok"] = json!(true);
        summary["options"] = json!(plan.options);
        summary["samples"] = json!(result.stats.samples);
        summary["duplicates"] = json!(result.stats.duplicates);
        for (key, shape) in [("inner_axis", &inner_axis), ("outer_axis", &outer_axis)] {
            if let Some(shape) = shape {
                summary[key] = json!({
                    "balls": shape.balls.len(),
                    "edges": shape.edges.len(),
                    "triangles": shape.triangles.len(),
                    "tetrahedra": shape.tetrahedra.len(),
                });
            }
        }
        Ok(Report {
            findings,
            samples: result.stats.samples,
            stages: result.stats.seconds.clone(),
            inner_axis,
            outer_axis,
            summary,
            stats,
        })
    }

    /// The summary, on the streams that the plan allows.
    pub fn tell(mut self, plan: &Plan, start: Instant) {
        let seconds = start.elapsed().as_secs_f64();
        for (stage, seconds) in &self.stages {
            let line = format_args!("{stage:>10} {seconds:8.3} s");
            plan.talk.at(Talk::Verbose, line);
        }
        plan.talk.at(Talk::Debug, format_args!("{:#}", self.stats));
        plan.talk.at(Talk::Plain, self.line(plan, seconds));
        if plan.json {
            self.summary["seconds"] = json!(seconds);
            let text = format!("{:#}\n", self.summary);
            let _ = Target::Stdout.stage(|out| out.write_all(text.as_bytes()));
        }
    }

    fn line(&self, plan: &Plan, seconds: f64) -> String {
        let place = match &plan.mesh {
            Some(out) if out.target == Target::Stdout => "standard output".to_owned(),
            Some(out) => out.path.display().to_string(),
            None => name(&plan.input),
        };
        let (one, many) = match plan.options.faces {
            Faces::Triangles => ("triangle", "triangles"),
            Faces::Polygons => ("polygon", "polygons"),
        };
        let found = &self.findings;
        let mut parts = vec![
            format!("{} samples", grouped(self.samples)),
            counted(found.faces as usize, one, many),
            counted(found.components as usize, "component", "components"),
        ];
        if let Some(genus) = found.genus {
            parts.push(format!("genus {genus}"));
        }
        if !found.is_closed() {
            parts.push("not closed (a bug: please report it)".to_owned());
        }
        if plan.check {
            let pairs = found.counts.crossing + found.counts.touching;
            parts.push(match pairs {
                0 => "no faces cross".to_owned(),
                _ => format!(
                    "{} of faces cross or touch",
                    counted(pairs as usize, "pair", "pairs")
                ),
            });
        }
        parts.push(format!("{seconds:.2} s"));
        format!("{place}: {}", parts.join(", "))
    }
}
