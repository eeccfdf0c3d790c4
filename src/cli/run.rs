//! One reconstruction: read, compute, write, report.

use std::fs;
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use powercrust::io::{self as format, CloudFormat, MeshAttributes, ReadError, WriteError};
use powercrust::surface::NONE;
use powercrust::{Context, Error, Reconstruction, SampleError};
use serde_json::json;

use super::fail::{name, reason, Code, Failure};
use super::formats::dotted;
use super::output::{Staged, Target};
use super::plan::{out_of_range, Plan};
use super::report::Report;
use super::show::{counted, Bar, Talk};
use super::stop;

pub fn run(plan: &Plan) -> Result<ExitCode, Failure> {
    let start = Instant::now();
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

    let bar = Bar::new(plan.talk);
    let context = Context {
        threads: plan.threads,
        progress: &bar,
    };
    let outcome =
        powercrust::reconstruct(&cloud.points, &plan.options, &context).and_then(|result| {
            let report = Report::new(plan, &result, cloud.report, &context)?;
            Ok((result, report))
        });
    bar.clear();
    let (result, report) = outcome.map_err(|error| unsolved(plan, error))?;
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

    write_results(plan, &result, &report)?;
    report.tell(plan, start);
    Ok(ExitCode::SUCCESS)
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

/// An error of the library, with the exit code it calls for.
fn unsolved(plan: &Plan, error: Error) -> Failure {
    let unfit = Failure::new(Code::Unfit, format!("{}: {error}", name(&plan.input)));
    match error {
        Error::Cancelled => Failure::interrupted(),
        Error::Option {
            name,
            value,
            expected,
        } => out_of_range(name, value, expected),
        Error::NothingInside { .. } if plan.options.lambda.is_some() => {
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

/// Stages every file and then makes all of them visible.
fn write_results(plan: &Plan, result: &Reconstruction, report: &Report) -> Result<(), Failure> {
    let mut staged: Vec<Staged> = Vec::new();
    if let Some(out) = &plan.mesh {
        let samples: Vec<u32> = result
            .crust
            .vertex_samples
            .iter()
            .map(|&sample| match sample {
                NONE => NONE,
                sample => result.sample_source[sample as usize],
            })
            .collect();
        let attributes = MeshAttributes {
            samples: Some(&samples),
            ..MeshAttributes::default()
        };
        staged.push(stage(&out.target, &out.path, |mut w| {
            format::write_mesh(
                &mut w,
                out.format,
                &result.crust.mesh,
                &attributes,
                &plan.write,
            )
        })?);
    }
    let axes = [
        (&plan.inner_axis, &report.inner_axis),
        (&plan.outer_axis, &report.outer_axis),
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
    if let Some(out) = &plan.stats {
        let text = format!("{:#}\n", report.stats);
        staged.push(out.target.stage(|w| w.write_all(text.as_bytes()))?);
    }
    staged.into_iter().try_for_each(Staged::publish)
}

/// Stages one file; what is no error of the disk is one of ours or of the
/// format's limits.
fn stage(
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
