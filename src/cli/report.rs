//! What a run found, told in one line, in JSON, or at length.

use std::time::Instant;

use powercrust::holes::{Filled, Holes, Loop};
use powercrust::io::{as_written, Cloud, MeshFormat};
use powercrust::mesh::{check, CheckOptions, Report as Findings};
use powercrust::surface::ShellFilter;
use powercrust::{Cancelled, Context, Faces, PowerShape, Reconstruction};
use serde_json::{json, Value};

use super::axes::Axes;
use super::check::faults_in_words;
use super::fail::{name, Code, Failure};
use super::holes;
use super::output::Target;
use super::plan::Plan;
use super::product::{Product, Reduced};
use super::show::{counted, grouped, Talk};
use super::tell;
use super::wanted;

/// What the run found, for the summary, `--json` and `--stats`.
pub struct Report {
    findings: Findings,
    /// Rounding by the file spoils the mesh.
    rounded: bool,
    reduced: Option<Reduced>,
    holes: Holes,
    border: Option<Vec<Loop>>,
    filled: Option<Filled>,
    parts: usize,
    cavities: usize,
    samples: usize,
    stages: Vec<(String, f64)>,
    /// For `--json`.
    summary: Value,
    /// For `--stats`.
    pub stats: Value,
}

/// Whether the file rounds coordinates more than the surface was made for:
/// fewer digits than asked of it, or 32 bits about the middle of the mesh.
fn rounds_later(plan: &Plan, result: &Reconstruction) -> bool {
    let Some(out) = &plan.mesh else { return false };
    match out.format {
        MeshFormat::Glb => !result.stats.options.single,
        _ => plan.write.digits.is_some(),
    }
}

/// What is wrong with a mesh that could not be made sound.
fn known_faults(crossings_left: usize, closed: bool) -> Option<String> {
    let mut faults = Vec::new();
    if crossings_left > 0 {
        let pairs = counted(crossings_left, "pair", "pairs");
        faults.push(format!("{pairs} of faces cross, which could not be mended"));
    }
    if !closed {
        faults.push("the mesh is not closed".to_owned());
    }
    (!faults.is_empty()).then(|| faults.join("; "))
}

/// A medial axis as counts.
pub fn in_numbers(shape: &PowerShape) -> Value {
    json!({
        "balls": shape.balls.len(),
        "edges": shape.edges.len(),
        "triangles": shape.triangles.len(),
        "tetrahedra": shape.tetrahedra.len(),
        "betti": shape.betti(),
    })
}

/// Whether a mesh is what the plan asks for, by exact judgement.
fn is_sound(findings: &Findings, plan: &Plan) -> bool {
    match plan.holes {
        wanted::Holes::Keep | wanted::Holes::Fill => findings.is_watertight(),
        wanted::Holes::Open => findings.is_bordered(),
    }
}

impl Report {
    /// Judges the mesh and gathers what else there is to tell.
    pub fn new(
        plan: &Plan,
        result: &Reconstruction,
        product: &Product,
        axes: &Axes,
        cloud: &Cloud,
        context: &Context,
    ) -> Result<Report, Cancelled> {
        // Closed, manifold, oriented: cheap and always looked at. The search
        // for crossing faces would be a quarter of the run (12,745 samples:
        // 0.13 of 0.52 s), so it waits to be asked for.
        let rounded = rounds_later(plan, result);
        let options = CheckOptions {
            intersections: plan.verify || rounded,
            max_findings: 1,
            ..CheckOptions::default()
        };
        let findings = match plan.mesh.as_ref().filter(|_| options.intersections) {
            None => check(&result.crust.mesh, &options, context)?,
            Some(out) => {
                let mut written = result.crust.mesh.clone();
                written.vertices = as_written(out.format, &written.vertices, &plan.write);
                check(&written, &options, context)?
            }
        };
        let mut head = json!({
            "powercrust": env!("CARGO_PKG_VERSION"),
            "input": { "file": name(&plan.input), "read": cloud.report },
            "mesh": {
                "vertices": findings.vertices,
                "faces": findings.faces,
                "closed": findings.is_closed(),
                "manifold": findings.counts.non_manifold_edge + findings.counts.pinched_vertex == 0,
                "components": product.shells.part_volumes.len(),
                "shells": findings.shells.len(),
                "genus": findings.genus,
                "cavities": product.shells.cavities.len(),
                "largest_volumes": &product.shells.part_volumes[..product.shells.part_volumes.len().min(20)],
                "volume": findings.volume,
                "area": findings.area,
                "smallest_angle": findings.smallest_angle,
                "aspects": findings.aspects,
            },
        });
        if plan.verify {
            head["mesh"]["sound"] = json!(is_sound(&findings, plan));
            head["mesh"]["crossing"] = json!(findings.counts.crossing);
            head["mesh"]["touching"] = json!(findings.counts.touching);
        }
        head["holes"] = holes::in_full(plan, product);
        if product.border.is_some() {
            // Those of the solid before it was opened tell nothing of the mesh.
            head["mesh"]["components"] = json!(findings.shells.len());
            for of_solid in ["cavities", "largest_volumes", "volume"] {
                head["mesh"][of_solid] = Value::Null;
            }
        }
        let (kept, all) = (&product.shells, &product.before);
        if plan.shells != ShellFilter::default() {
            head["dropped"] = json!({
                "components": all.part_volumes.len() - kept.part_volumes.len(),
                "cavities": all.cavities.len() - kept.cavities.len(),
            });
        }
        if let Some(reduced) = &product.reduced {
            head["reduced"] = json!(reduced);
        }
        head["peak_memory_bytes"] = json!(powercrust::memory::peak());
        // Betti numbers take time, so they are found where they are told.
        for (key, shape) in [("inner_axis", &axes.inner), ("outer_axis", &axes.outer)] {
            if let Some(shape) = shape.as_ref().filter(|_| plan.json || plan.stats.is_some()) {
                head[key] = in_numbers(shape);
            }
        }
        let mut stats = head.clone();
        stats["stats"] = json!(result.stats);
        let mut summary = head;
        summary["ok"] = json!(true);
        summary["options"] = json!(plan.options);
        summary["samples"] = json!(result.stats.samples);
        summary["outliers"] = json!(result.stats.outliers);
        summary["noise"] = json!(result.stats.noise);
        summary["duplicates"] = json!(result.stats.duplicates);
        Ok(Report {
            rounded: rounded && !is_sound(&findings, plan),
            reduced: product.reduced,
            parts: match product.border {
                None => kept.part_volumes.len(),
                Some(_) => findings.shells.len(),
            },
            cavities: match product.border {
                None => kept.cavities.len(),
                Some(_) => 0,
            },
            findings,
            holes: product.holes.clone(),
            border: product.border.clone(),
            filled: product.filled.clone(),
            samples: result.stats.samples,
            stages: result.stats.seconds.clone(),
            summary,
            stats,
        })
    }

    /// An error if the mesh was to be verified and is not sound.
    pub fn verdict(&self, plan: &Plan) -> Result<(), Failure> {
        if !plan.verify || is_sound(&self.findings, plan) {
            return Ok(());
        }
        let what = faults_in_words(&self.findings, self.border.is_some()).join("; ");
        Err(Failure::new(
            Code::Unfit,
            format!(
                "{}: the mesh is not sound as it would be written: {what}",
                self.place(plan)
            ),
        )
        .hint("nothing was written; without --verify it is written as it is"))
    }

    /// An error if what was written has faults that the library knows of.
    pub fn admit(&self, plan: &Plan, crossings_left: usize) -> Result<(), Failure> {
        let closed = self.border.is_some() || self.findings.is_closed();
        match known_faults(crossings_left, closed) {
            None => Ok(()),
            Some(what) => Err(
                Failure::new(Code::Unfit, format!("{}: {what}", self.place(plan)))
                    .hint("the mesh was written as it is; please report this with the input"),
            ),
        }
    }

    fn place(&self, plan: &Plan) -> String {
        match &plan.mesh {
            Some(out) if out.target == Target::Stdout => "standard output".to_owned(),
            Some(out) => out.path.display().to_string(),
            None => name(&plan.input),
        }
    }

    /// The summary, on the streams that the plan allows.
    pub fn tell(mut self, plan: &Plan, start: Instant) {
        let seconds = start.elapsed().as_secs_f64();
        tell::stages(plan, &self.stages);
        holes::tell(
            plan,
            &self.holes,
            self.border.as_deref(),
            self.filled.as_ref(),
        );
        plan.talk.at(Talk::Debug, format_args!("{:#}", self.stats));
        plan.talk.at(Talk::Plain, self.line(plan, seconds));
        if plan.json {
            self.summary["seconds"] = json!(seconds);
            let text = format!("{:#}\n", self.summary);
            let _ = Target::Stdout.stage(|out| out.write_all(text.as_bytes()));
        }
    }

    fn line(&self, plan: &Plan, seconds: f64) -> String {
        let place = self.place(plan);
        let (one, many) = match plan.options.faces {
            Faces::Triangles | Faces::None => ("triangle", "triangles"),
            Faces::Polygons => ("polygon", "polygons"),
        };
        let found = &self.findings;
        let mut parts = vec![
            format!("{} samples", grouped(self.samples)),
            counted(found.faces as usize, one, many),
            counted(self.parts, "component", "components"),
        ];
        if self.cavities > 0 {
            parts.push(counted(self.cavities, "cavity", "cavities"));
        }
        if let Some(genus) = found.genus {
            parts.push(format!("genus {genus}"));
        }
        parts.extend(holes::in_short(
            &self.holes,
            self.border.as_deref(),
            self.filled.as_ref(),
        ));
        if let Some(reduced) = &self.reduced {
            let moved = 100.0 * reduced.moved.mean_of_diagonal;
            parts.push(format!("moved by {moved:.2e} % of the diagonal"));
            if reduced.faces > reduced.asked + 1 {
                parts.push(format!("not fewer ({} asked for)", grouped(reduced.asked)));
            }
        }
        if self.rounded {
            let what = faults_in_words(found, self.border.is_some()).join("; ");
            parts.push(format!("not sound as rounded in the file: {what}"));
        }
        if plan.verify {
            parts.push("verified".to_owned());
        }
        parts.push(format!("{seconds:.2} s"));
        format!("{place}: {}", parts.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::known_faults;

    #[test]
    fn what_could_not_be_mended_is_said() {
        assert_eq!(known_faults(0, true), None);
        let said = known_faults(3, true).unwrap();
        assert!(said.contains("3 pairs of faces cross"), "{said}");
        let said = known_faults(1, false).unwrap();
        assert!(
            said.contains("1 pair of") && said.contains("not closed"),
            "{said}"
        );
    }
}
