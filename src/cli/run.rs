//! One reconstruction: read, compute, write, report.

use std::fs;
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use powercrust::geom::vec3::sub;
use powercrust::io::{self as format, Cloud, CloudFormat, MeshFormat, ReadError, WriteError};
use powercrust::memory::{estimate, of_machine, Estimate};
use powercrust::{
    Bounds, Context, Error, Faces, Options, OutlierOption, Point, Reconstruction, SampleError,
};
use serde_json::json;

use super::axes::Axes;
use super::fail::{name, reason, Code, Failure};
use super::formats::dotted;
use super::output::{Staged, Target};
use super::plan::{out_of_range, Plan};
use super::product;
use super::report::Report;
use super::reports;
use super::show::{counted, Bar, Talk};
use super::stop;
use super::tell;
use super::wanted::Normals;

pub fn run(plan: &Plan) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    let cloud = read(plan)?;
    let estimate = estimate(cloud.points.len());
    plan.talk.at(
        Talk::Verbose,
        format_args!("this will take {}", in_words(&estimate)),
    );
    let limit = match plan.max_memory {
        Some(limit) => (Some(limit), "--max-memory"),
        None if plan.dry_run => (None, ""),
        None => (of_machine(), "the memory of this machine,"),
    };
    enough_memory(&plan.input, &estimate, limit)?;
    if plan.dry_run {
        tell_estimate(plan, &cloud, &estimate)?;
        return Ok(ExitCode::SUCCESS);
    }

    let bar = Bar::new(plan.talk);
    let context = Context {
        threads: plan.threads,
        progress: &bar,
    };
    let options = Options {
        outliers: match plan.outliers_told {
            true => plan.options.outliers,
            false => usual_outliers(&cloud),
        },
        single: plan.options.single || holds_single(plan, &cloud.points),
        faces: match plan.no_surface() {
            true => Faces::None,
            false => plan.options.faces,
        },
        // Only medial axes are made of the cells.
        cells: plan.inner_axis.is_some() || plan.outer_axis.is_some(),
        ..plan.options.clone()
    };
    let outcome = reconstruct(&cloud, (plan.sensor, plan.normals), &options, &context);
    let outcome = outcome
        .map_err(|error| unsolved(&plan.input, plan.options.lambda.is_given(), error))
        .and_then(|mut result| {
            let axes = Axes::of(plan, &result, &cloud);
            if plan.no_surface() {
                return Ok((result, axes, None));
            }
            let product = product::make(plan, &cloud, &mut result, options.single, &context)?;
            let report = Report::new(plan, &result, &product, &axes, &cloud, &context)
                .map_err(|_| Failure::interrupted())?;
            Ok((result, axes, Some((product, report))))
        });
    bar.clear();
    let (result, axes, surface) = outcome?;
    if result.stats.duplicates > 0 {
        plan.talk.at(
            Talk::Plain,
            format_args!(
                "note: {} merged",
                counted(
                    result.stats.duplicates,
                    "duplicate point",
                    "duplicate points"
                )
            ),
        );
    }
    tell::outliers(plan.talk, &result.stats.outliers);
    tell::noise(plan, &result.stats.noise);
    tell::lambda(plan, &result.stats);
    tell::cut(plan, &result.stats);
    tell::edges(plan, &result.stats);
    tell::outward(plan, &cloud, &result.stats.outward);

    let Some((product, report)) = surface else {
        let staged = stage_others(plan, &result, &axes, &cloud)?;
        staged.into_iter().try_for_each(Staged::publish)?;
        axes.tell(plan, &result.stats, start);
        return Ok(ExitCode::SUCCESS);
    };
    report.verdict(plan)?;
    let mut staged = Vec::new();
    if let Some(out) = &plan.mesh {
        let attributes = product.carried.attributes();
        let mesh = &result.crust.mesh;
        staged.push(stage(&out.target, &out.path, |mut w| {
            format::write_mesh(&mut w, out.format, mesh, &attributes, &plan.write)
        })?);
    }
    staged.extend(stage_others(plan, &result, &axes, &cloud)?);
    if let Some(out) = &plan.stats {
        let text = format!("{:#}\n", report.stats);
        staged.push(out.target.stage(|w| w.write_all(text.as_bytes()))?);
    }
    // Every file is staged, then all become visible.
    staged.into_iter().try_for_each(Staged::publish)?;
    report.admit(plan, result.stats.crossings_left)?;
    report.tell(plan, start);
    Ok(ExitCode::SUCCESS)
}

/// The points, with what there is to say of them.
pub fn read(plan: &Plan) -> Result<Cloud, Failure> {
    for decision in &plan.decisions {
        plan.talk.at(Talk::Verbose, decision);
    }
    let cloud = {
        let bytes = read_bytes(&plan.input)?;
        let format = cloud_format(plan, &bytes)?;
        format::read_cloud(&bytes, format, &plan.read)
            .map_err(|error| misread(&plan.input, &error, CloudFormat::extensions()))?
    };
    stop::orderly();
    plan.talk.at(
        Talk::Verbose,
        format_args!(
            "{}: {}, {}",
            name(&plan.input),
            cloud.report.format.name(),
            counted(cloud.points.len(), "point", "points")
        ),
    );
    for note in &cloud.report.notes {
        plan.talk.at(Talk::Plain, format_args!("note: {note}"));
    }
    plan.talk.at(
        Talk::Verbose,
        format_args!("options {}", json!(plan.options)),
    );
    Ok(cloud)
}

/// The surface of points, with what their normals or the scanner say.
pub fn reconstruct(
    cloud: &Cloud,
    seen: (Option<Point>, Normals),
    options: &Options,
    context: &Context,
) -> Result<Reconstruction, Error> {
    powercrust::reconstruct_seen(&cloud.points, &outward(seen, cloud), options, context)
}

/// Which way is out at each point: towards the scanner, or along its normal. Empty where nothing
/// tells.
fn outward(seen: (Option<Point>, Normals), cloud: &Cloud) -> Vec<Point> {
    let to = |sensor: Point| cloud.points.iter().map(|p| sub(sensor, *p)).collect();
    match (seen, &cloud.normals, cloud.viewpoint) {
        ((Some(sensor), _), ..) => to(sensor),
        ((None, Normals::Ignore), ..) => Vec::new(),
        (_, Some(normals), _) => normals.iter().map(|n| n.map(f64::from)).collect(),
        (_, None, Some(viewpoint)) => to(viewpoint),
        (_, None, None) => Vec::new(),
    }
}

/// What is done about outliers unless the user says: the vertices of a mesh
/// lie on its surface.
pub fn usual_outliers(cloud: &Cloud) -> OutlierOption {
    match cloud.report.faces_ignored {
        Some(faces) if faces > 0 => OutlierOption::Keep,
        _ => OutlierOption::Auto,
    }
}

/// An error rather than a process that the system ends: what a run is likely
/// to need must not be more than was allowed, or than the machine has.
pub fn enough_memory(
    input: &Path,
    estimate: &Estimate,
    (limit, whose): (Option<u64>, &str),
) -> Result<(), Failure> {
    match limit.filter(|&limit| estimate.memory_bytes > limit) {
        None => Ok(()),
        Some(limit) => Err(Failure::new(
            Code::Unfit,
            format!(
                "{}: this would take {}, more than {whose} {}",
                name(input),
                in_words(estimate),
                bytes(limit)
            ),
        )
        .hint("thin the points out, or allow more by --max-memory")),
    }
}

/// The answer to `--dry-run`.
fn tell_estimate(plan: &Plan, cloud: &Cloud, estimate: &Estimate) -> Result<(), Failure> {
    let text = if plan.json {
        let object = json!({
            "ok": true,
            "dry_run": true,
            "input": { "file": name(&plan.input), "read": cloud.report },
            "points": cloud.points.len(),
            "estimate": estimate,
        });
        format!("{object:#}\n")
    } else {
        format!(
            "{}: {}: {}\n",
            name(&plan.input),
            counted(cloud.points.len(), "point", "points"),
            in_words(estimate)
        )
    };
    Target::Stdout.stage(|out| out.write_all(text.as_bytes()))?;
    Ok(())
}

fn in_words(estimate: &Estimate) -> String {
    let seconds = estimate.seconds;
    let time = match seconds {
        s if s < 1.0 => "a second".to_owned(),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} minutes", s / 60.0),
        s => format!("{:.0} hours", s / 3600.0),
    };
    format!(
        "about {} of memory and {time}",
        bytes(estimate.memory_bytes)
    )
}

/// `1.5 GiB`.
fn bytes(count: u64) -> String {
    let count = count as f64;
    match [("GiB", 30), ("MiB", 20), ("KiB", 10)]
        .into_iter()
        .find(|&(_, power)| count >= 2f64.powi(power))
    {
        Some((unit, power)) => {
            let number = count / 2f64.powi(power);
            match number < 10.0 {
                true => format!("{number:.1} {unit}"),
                false => format!("{number:.0} {unit}"),
            }
        }
        None => format!("{count:.0} bytes"),
    }
}

/// Whether the mesh file holds 32-bit coordinates, so that the surface must
/// be made sure of on those. GLB counts them from the middle of the mesh; for
/// points that lie far from the origin, rounding them as they are would lose
/// detail that the file can hold.
fn holds_single(plan: &Plan, points: &[Point]) -> bool {
    match plan.mesh.as_ref().map(|out| out.format) {
        Some(MeshFormat::Stl) => true,
        Some(MeshFormat::Glb) => Bounds::of(points).is_some_and(|b| {
            let far = |k: usize| b.min[k].abs().max(b.max[k].abs());
            far(0).max(far(1)).max(far(2)) < 8.0 * b.diagonal()
        }),
        _ => false,
    }
}

/// The whole input.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    let bytes = if path.as_os_str() == "-" {
        let mut bytes = Vec::new();
        io::stdin().lock().read_to_end(&mut bytes).map(|_| bytes)
    } else {
        fs::read(path)
    };
    bytes.map_err(|error| Failure::file(path, format!("cannot read: {}", reason(&error))))
}

fn cloud_format(plan: &Plan, bytes: &[u8]) -> Result<CloudFormat, Failure> {
    if let Some(format) = plan.input_format {
        return Ok(format);
    }
    let format = CloudFormat::sniff(bytes);
    let head = &bytes[..bytes.len().min(4096)];
    if format == CloudFormat::Text && head.contains(&0) && !head.starts_with(&[0xff, 0xfe]) {
        return Err(
            Failure::file(&plan.input, "not a format that can be read").hint(format!(
                "known: {}; or name it by --input-format",
                dotted(CloudFormat::extensions())
            )),
        );
    }
    Ok(format)
}

/// An error of a reader, with the exit code it calls for.
pub fn misread(
    path: &Path,
    error: &ReadError,
    known: impl Iterator<Item = &'static str>,
) -> Failure {
    let mut failure = Failure::file(path, error);
    match error {
        ReadError::NotFinite { .. } => {
            failure.code = Code::Unfit;
            failure.hint("correct the point, or drop all such points with --skip-invalid")
        }
        ReadError::Nothing { .. } | ReadError::NothingFinite { .. } => {
            failure.code = Code::Unfit;
            failure.hint("give a file with points in it")
        }
        ReadError::Empty => failure.hint("give a file with points in it"),
        ReadError::TooMany { .. } => {
            failure.code = Code::Unfit;
            failure.hint("thin the points out")
        }
        ReadError::Truncated { .. } => {
            failure.hint("fetch or export the file again; what there is was not used")
        }
        ReadError::DecimalComma { .. } => failure.hint("sed 's/,/./g' turns commas into points"),
        ReadError::NotANumber { .. } | ReadError::Malformed { .. } | ReadError::Columns { .. } => {
            failure.hint(format!(
                "if the file is of another format, name it by --input-format ({})",
                dotted(known)
            ))
        }
        _ => failure,
    }
}

/// An error of the library, with the exit code it calls for; `filtered` says
/// whether poles were dropped.
pub fn unsolved(input: &Path, filtered: bool, error: Error) -> Failure {
    let unfit = Failure::new(Code::Unfit, format!("{}: {error}", name(input)));
    match error {
        Error::Cancelled => Failure::interrupted(),
        Error::Option {
            name,
            value,
            expected,
        } => out_of_range(name, value, expected),
        Error::NothingInside { .. } if filtered => {
            unfit.hint("the sampling may be too sparse for --lambda and --sharp: try without")
        }
        Error::NothingInside { .. } => {
            unfit.hint("sample the surface all around, and more densely where it is thin")
        }
        Error::Samples(SampleError::TooFew { .. }) => {
            unfit.hint("give points from all sides of a solid")
        }
        Error::Samples(SampleError::Coplanar { .. } | SampleError::Collinear { .. }) => {
            unfit.hint("give points from all sides of a solid; is a coordinate missing?")
        }
        Error::Samples(SampleError::TooWide { .. }) => {
            unfit.hint("scale the points, or remove those that lie far off")
        }
        Error::Samples(SampleError::TooMany { .. }) | Error::TooLarge { .. } => {
            unfit.hint("thin the points out")
        }
        _ => unfit,
    }
}

/// Stages the files that need no surface.
fn stage_others(
    plan: &Plan,
    result: &Reconstruction,
    axes: &Axes,
    cloud: &Cloud,
) -> Result<Vec<Staged>, Failure> {
    let mut staged: Vec<Staged> = Vec::new();
    let axes = [
        (&plan.inner_axis, &axes.inner),
        (&plan.outer_axis, &axes.outer),
    ];
    for (out, shape) in axes {
        if let (Some(out), Some(shape)) = (out, shape) {
            staged.push(stage(&out.target, &out.path, |mut w| {
                format::write_axis(&mut w, out.format, shape, &plan.write)
            })?);
        }
    }
    if let Some(out) = &plan.poles {
        staged.push(stage(&out.target, &out.path, |mut w| {
            format::write_balls(&mut w, &result.balls, &plan.write)
        })?);
    }
    if let Some(out) = &plan.outliers {
        staged.push(stage(&out.target, &out.path, |mut w| {
            reports::outliers(&mut w, result, cloud, &plan.write)
        })?);
    }
    if let Some(out) = &plan.dropped {
        staged.push(stage(&out.target, &out.path, |mut w| {
            reports::dropped(&mut w, &result.dropped, &result.sample_source, &plan.write)
        })?);
    }
    Ok(staged)
}

/// Stages one file; what is no error of the disk is one of ours or of the
/// format's limits.
pub fn stage(
    target: &Target,
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<Staged, Failure> {
    let mut refused = None;
    let outcome = target.stage(|w| match write(w) {
        Ok(()) => Ok(()),
        Err(WriteError::Io(error)) => Err(error),
        Err(other) => {
            refused = Some(other);
            Err(io::Error::other("refused"))
        }
    });
    match refused {
        Some(error) => Err(Failure::file(path, format!("cannot write: {error}"))),
        None => outcome,
    }
}
