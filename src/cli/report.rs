//! What a run found, told in one line, in JSON, or at length.

use std::time::Instant;

use powercrust::io::ReadReport;
use powercrust::{Faces, PowerShape, Reconstruction, Side};
use serde_json::{json, Value};

use super::fail::name;
use super::output::Target;
use super::plan::Plan;
use super::show::{counted, grouped, Talk};
use super::topology::Topology;

/// What the run found, for the summary, `--json` and `--stats`.
pub struct Report {
    topology: Topology,
    pub inner_axis: Option<PowerShape>,
    pub outer_axis: Option<PowerShape>,
    /// For `--json`.
    summary: Value,
    /// For `--stats`.
    pub stats: Value,
}

impl Report {
    pub fn new(plan: &Plan, result: &Reconstruction, input: ReadReport, start: Instant) -> Report {
        let mesh = &result.crust.mesh;
        let topology = Topology::of(mesh);
        let shape = |wanted: bool, side| wanted.then(|| result.power_shape(side));
        let inner_axis = shape(plan.inner_axis.is_some(), Side::Inner);
        let outer_axis = shape(plan.outer_axis.is_some(), Side::Outer);
        let head = json!({
            "powercrust": env!("CARGO_PKG_VERSION"),
            "input": { "file": name(&plan.input), "read": input },
            "mesh": {
                "vertices": mesh.vertices.len(),
                "faces": mesh.face_count(),
                "components": topology.components,
                "genus": topology.genus,
                "volume": result.stats.volume,
            },
        });
        let mut stats = head.clone();
        stats["stats"] = json!(result.stats);
        let mut summary = head;
        summary["ok"] = json!(true);
        summary["options"] = json!(plan.options);
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
        summary["samples"] = json!(result.stats.samples);
        summary["duplicates"] = json!(result.stats.duplicates);
        summary["seconds"] = json!(start.elapsed().as_secs_f64());
        Report {
            topology,
            inner_axis,
            outer_axis,
            summary,
            stats,
        }
    }

    /// The summary, on the streams that the plan allows.
    pub fn tell(&self, plan: &Plan, start: Instant) {
        if let Some(stages) = self.stats["stats"]["seconds"].as_array() {
            for stage in stages {
                if let (Some(stage), Some(seconds)) = (stage[0].as_str(), stage[1].as_f64()) {
                    plan.talk
                        .at(Talk::Verbose, format_args!("{stage:>10} {seconds:8.3} s"));
                }
            }
        }
        plan.talk.at(Talk::Debug, format_args!("{:#}", self.stats));
        let place = plan.mesh.as_ref().map_or("crust".to_owned(), |out| {
            if out.target == Target::Stdout {
                "standard output".to_owned()
            } else {
                out.path.display().to_string()
            }
        });
        let (one, many) = match plan.options.faces {
            Faces::Triangles => ("triangle", "triangles"),
            Faces::Polygons => ("polygon", "polygons"),
        };
        let count = |value: &Value| value.as_u64().unwrap_or(0) as usize;
        plan.talk.at(
            Talk::Plain,
            format_args!(
                "{place}: {} samples, {}, {}, genus {}, {:.2} s",
                grouped(count(&self.summary["samples"])),
                counted(count(&self.summary["mesh"]["faces"]), one, many),
                counted(self.topology.components, "component", "components"),
                self.topology.genus,
                start.elapsed().as_secs_f64(),
            ),
        );
        if plan.json {
            let text = format!("{:#}\n", self.summary);
            let _ = Target::Stdout.stage(|w| w.write_all(text.as_bytes()));
        }
    }
}
