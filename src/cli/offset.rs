//! `powercrust offset`: surfaces at a distance, from one reconstruction.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use powercrust::io::{as_written, write_mesh, MeshAttributes, MeshFormat};
use powercrust::memory::{estimate, of_machine};
use powercrust::mesh::{check, CheckOptions, Report};
use powercrust::offset::{Offset, OffsetOptions, Offsets};
use powercrust::{Bounds, Context, Error, Options};
use serde_json::{json, Value};

use super::args::{Offset as Args, Reconstruct};
use super::check::faults_in_words;
use super::fail::{name, Code, Failure};
use super::formats::mesh_format;
use super::output::{Staged, Target};
use super::plan::{apart, out, Out, Plan};
use super::run::{self, enough_memory, read, stage, unsolved, usual_outliers};
use super::show::{counted, Bar, Talk};
use super::tell;
use super::wanted::{distance, Distance, Normals};

/// What stands for the distance in the name of a file.
const PLACE: &str = "{d}";

pub fn offset(args: &Args) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    let plan = Plan::read(&reconstruct(args), &args.input)?;
    let wanted = wanted(args)?;
    let outs = outs(args, &wanted)?;
    let cloud = read(&plan)?;
    let limit = match args.max_memory {
        Some(limit) => (Some(limit), "--max-memory"),
        None => (of_machine(), "the memory of this machine,"),
    };
    enough_memory(&args.input, &estimate(cloud.points.len()), limit)?;

    let bounds = Bounds::of(&cloud.points);
    let diagonal = bounds.map_or(0.0, |b| b.diagonal());
    let distances: Vec<f64> = wanted.iter().map(|d| d.of(diagonal)).collect();
    let single = args.f32 || outs.iter().any(|o| o.format == MeshFormat::Stl);
    let options = Options {
        box_factor: args
            .box_factor
            .unwrap_or_else(|| frame_for(bounds, &distances)),
        single,
        outliers: usual_outliers(&cloud),
        cells: false,
        ..plan.options.clone()
    };
    let bar = Bar::new(plan.talk);
    let context = Context {
        threads: plan.threads,
        progress: &bar,
    };
    let made = (|| {
        let failed = |error| refused(&plan, args, error);
        let result =
            run::reconstruct(&cloud, (None, Normals::Auto), &options, &context).map_err(failed)?;
        tell::outliers(plan.talk, &result.stats.outliers);
        let how = OffsetOptions {
            tolerance: args.tolerance.as_ref().map(|t| t.of(diagonal)),
            fit: !args.plain,
            single,
        };
        let base = judge(&result.crust.mesh, &context)?;
        let offsets = Offsets::new(&result, how).map_err(failed)?;
        let mut made = Vec::new();
        for (&distance, out) in distances.iter().zip(&outs) {
            let offset = match &args.shell {
                None => offsets.at(distance, &context),
                Some(shell) => offsets.shell(distance, shell.of(diagonal), &context),
            }
            .map_err(|error| refused(&plan, args, error))?;
            let mut written = offset.crust.mesh.clone();
            written.vertices = as_written(out.format, &written.vertices, &plan.write);
            let report = judge(&written, &context)?;
            sound(&offset, &report, &out.path)?;
            made.push((offset, report));
        }
        Ok((made, base, offsets.tolerance()))
    })();
    bar.clear();
    let (made, base, tolerance) = made?;

    let mut staged: Vec<Staged> = Vec::new();
    for ((offset, _), out) in made.iter().zip(&outs) {
        staged.push(stage(&out.target, &out.path, |mut w| {
            let mesh = &offset.crust.mesh;
            let bare = MeshAttributes::default();
            write_mesh(&mut w, out.format, mesh, &bare, &plan.write)
        })?);
    }
    staged.into_iter().try_for_each(Staged::publish)?;

    let mut list = Vec::new();
    for ((offset, report), out) in made.iter().zip(&outs) {
        plan.talk.at(Talk::Plain, line(offset, report, &base, out));
        list.push(summary(offset, report, out));
    }
    let seconds = start.elapsed().as_secs_f64();
    plan.talk.at(Talk::Verbose, format_args!("{seconds:.2} s"));
    if args.reporting.json {
        let object = json!({
            "ok": true,
            "powercrust": env!("CARGO_PKG_VERSION"),
            "input": { "file": name(&plan.input), "read": cloud.report },
            "options": options,
            "tolerance": tolerance,
            "fit": !args.plain,
            "crust": topology(&base),
            "offsets": list,
            "seconds": seconds,
        });
        let text = format!("{object:#}\n");
        Target::Stdout.stage(|out| out.write_all(text.as_bytes()))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The same as arguments of a plain run.
fn reconstruct(args: &Args) -> Reconstruct {
    Reconstruct {
        input: Some(args.input.clone()),
        input_format: args.input_format.clone(),
        ascii: args.ascii,
        f32: args.f32,
        skip_invalid: args.skip_invalid,
        lambda: args.lambda,
        sharp: args.sharp,
        box_factor: args.box_factor,
        merge: args.merge,
        max_memory: args.max_memory,
        reporting: args.reporting.clone(),
        ..Reconstruct::default()
    }
}

/// The distances; lengths that make no sense are refused.
fn wanted(args: &Args) -> Result<Vec<Distance>, Failure> {
    let positive = [("--shell", &args.shell), ("--tolerance", &args.tolerance)];
    for (flag, length) in positive {
        if let Some(length) = length.as_ref().filter(|l| !l.is_positive()) {
            return Err(Failure::usage(format!(
                "{flag} is {}: expected a length above 0",
                length.said
            )));
        }
    }
    match (&args.distance, &args.shell) {
        (Some(list), _) => Ok(list.0.clone()),
        (None, Some(_)) => Ok(vec![distance("0").expect("a number")]),
        (None, None) => Err(Failure::usage("no distance given")
            .hint("--distance 0.5 for a surface outside, --distance=-0.5 for one inside, --shell 0.5 for a wall")),
    }
}

/// A file for each distance.
fn outs(args: &Args, wanted: &[Distance]) -> Result<Vec<Out<MeshFormat>>, Failure> {
    let text = args.output.to_string_lossy();
    if wanted.len() > 1 && !text.contains(PLACE) {
        return Err(Failure::usage(format!(
            "{}: {} distances would be written to this file",
            name(&args.output),
            wanted.len()
        ))
        .hint("put {d} into the name, which stands for the distance: -o 'part_{d}.ply'"));
    }
    let mut outs = Vec::new();
    for distance in wanted {
        let path = match text.contains(PLACE) {
            true => PathBuf::from(text.replace(PLACE, &distance.said)),
            false => args.output.clone(),
        };
        let format = |path: &Path| mesh_format(path, args.output_format.as_deref());
        outs.extend(out(&Some(path), format)?);
    }
    let places: Vec<(&Path, &Target)> = (outs.iter())
        .map(|out| (out.path.as_path(), &out.target))
        .collect();
    apart(&args.input, &places).map_err(|failure| match failure.hint {
        None => failure.hint("give another name"),
        Some(_) => failure,
    })?;
    if args.reporting.json && places.iter().any(|(_, t)| **t == Target::Stdout) {
        return Err(
            Failure::usage("more than one result would go to standard output")
                .hint("send one of -o - and --json to a file, or leave it out"),
        );
    }
    Ok(outs)
}

/// A frame with room for the largest distance.
fn frame_for(bounds: Option<Bounds>, distances: &[f64]) -> f64 {
    let half = bounds.map_or(0.0, |b| {
        (0..3).fold(0.0, |m: f64, k| m.max(b.max[k] - b.min[k])) / 2.0
    });
    let farthest = distances.iter().fold(0.0, |m: f64, d| m.max(*d));
    let least = Options::default().box_factor;
    // The frame's half side less half the points is to be twice the distance.
    (1.01 + 2.02 * farthest / half.max(f64::MIN_POSITIVE)).clamp(least, 100.0)
}

fn judge(mesh: &powercrust::PolygonMesh, context: &Context) -> Result<Report, Failure> {
    check(mesh, &CheckOptions::default(), context).map_err(|_| Failure::interrupted())
}

/// An error where a surface has a fault: then nothing is written.
fn sound(offset: &Offset, report: &Report, path: &Path) -> Result<(), Failure> {
    if report.is_watertight() && offset.crossings_left == 0 {
        return Ok(());
    }
    let mut what = faults_in_words(report, false);
    if what.is_empty() {
        what.push("faces cross".to_owned());
    }
    Err(Failure::new(
        Code::Unfit,
        format!(
            "{}: the mesh would not be sound: {}",
            name(path),
            what.join("; ")
        ),
    )
    .hint("nothing was written; take another distance, or a larger --shell or --tolerance"))
}

/// An error of the library.
fn refused(plan: &Plan, args: &Args, error: Error) -> Failure {
    let unfit =
        |error: &Error| Failure::new(Code::Unfit, format!("{}: {error}", name(&plan.input)));
    match error {
        Error::Vanished { .. } if args.shell.is_some() => {
            unfit(&error).hint("take a thinner --shell: the solid would be full")
        }
        Error::Vanished { .. } => unfit(&error).hint("take a distance nearer to 0"),
        Error::Option {
            name: "distance", ..
        } => unfit(&error).hint("take a smaller distance, or a larger --box-factor (at most 100)"),
        other => unsolved(&plan.input, plan.options.lambda.is_given(), other),
    }
}

fn topology(report: &Report) -> Value {
    json!({
        "vertices": report.vertices,
        "faces": report.faces,
        "components": report.components,
        "genus": report.genus,
        "cavities": report.cavities,
        "volume": report.volume,
        "area": report.area,
    })
}

fn summary(offset: &Offset, report: &Report, out: &Out<MeshFormat>) -> Value {
    let mut object = topology(report);
    object["file"] = json!(name(&out.path));
    object["distance"] = json!(offset.distance);
    object["thickness"] = json!(offset.thickness);
    object["vanished_inner_balls"] = json!(offset.vanished[0]);
    object["vanished_outer_balls"] = json!(offset.vanished[1]);
    object["fitted"] = json!(offset.fitted);
    object["turned_balls"] = json!(offset.turned);
    object["largest_error"] = json!(offset.error[0]);
    object["mean_error"] = json!(offset.error[1]);
    object
}

/// One line for people.
fn line(offset: &Offset, report: &Report, base: &Report, out: &Out<MeshFormat>) -> String {
    let mut parts = vec![
        format!("at {}", offset.distance),
        counted(report.faces as usize, "triangle", "triangles"),
        counted(report.components as usize, "component", "components"),
    ];
    if report.cavities > 0 {
        parts.push(counted(report.cavities as usize, "cavity", "cavities"));
    }
    if let Some(genus) = report.genus {
        parts.push(format!("genus {genus}"));
    }
    let of = |r: &Report| (r.components, r.cavities, r.genus);
    if offset.thickness.is_none() && of(report) != of(base) {
        let mut was = counted(base.components as usize, "component", "components");
        if base.cavities > 0 {
            was += &format!(
                ", {}",
                counted(base.cavities as usize, "cavity", "cavities")
            );
        }
        if let Some(genus) = base.genus {
            was += &format!(", genus {genus}");
        }
        parts.push(format!("the crust has {was}"));
    }
    let [inner, outer] = offset.vanished;
    for (count, side) in [(inner, "inner"), (outer, "outer")] {
        if count > 0 {
            let balls = counted(count, "ball", "balls");
            parts.push(format!("{side}: {balls} vanished"));
        }
    }
    if !offset.fitted {
        parts.push("as the power diagram has it".to_owned());
    }
    parts.push(format!("off by {:.1e} on average", offset.error[1]));
    format!("{}: {}", name(&out.path), parts.join(", "))
}
