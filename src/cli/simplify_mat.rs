//! `powercrust simplify-mat`: the stable part of a medial axis.

use std::io::IsTerminal;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use powercrust::axis::{
    simplify, skeleton, structure, LabelledBalls, SimplifyOptions, SimplifyReport,
};
use powercrust::io::{
    read_axis, read_cloud, write_axis_parts, AxisFormat, CloudFormat, ReadOptions, WriteOptions,
};
use powercrust::memory::{estimate, of_machine};
use powercrust::{Context, Error, Faces, LambdaOption, Options, PowerShape, Side};
use serde_json::json;

use super::balls::{judged, named, Input};
use super::fail::{name, Failure};
use super::formats::{axis_format, dotted};
use super::output::Target;
use super::plan::{check_input, identity, out, out_of_range, Out};
use super::report::in_numbers;
use super::run::{self, enough_memory, misread, read_bytes, stage, unsolved, usual_outliers};
use super::show::{counted, Bar, Talk};
use super::simplify_args::{SimplifyMat, WhichSide, DELTA_OF_EPS, EPS_PERCENT};
use super::stop;
use super::tell;
use super::wanted::{Length, Normals};

pub fn simplify_mat(args: &SimplifyMat) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    let talk = Talk::new(args.reporting.quiet, args.reporting.verbose);
    let said = args.input_format.as_deref().map(named).transpose()?;
    check_input(&args.input)?;
    let target = place(args)?;
    let options = pipeline_options(args)?;

    let bytes = read_bytes(&args.input)?;
    let input = said.unwrap_or_else(|| judged(&args.input, &bytes));
    let bar = Bar::new(talk);
    let context = Context {
        threads: args.reporting.threads,
        progress: &bar,
    };
    let outcome = balls(args, input, &bytes, &options, &context, talk).and_then(|(balls, side)| {
        let how = lengths(args, balls.diagonal);
        talk.at(Talk::Verbose, format_args!("options {}", json!(how)));
        let simple = simplify(&balls, &how, side, &context)
            .map_err(|error| unfit(&args.input, options.lambda.is_given(), error))?;
        let mut shape = simple.balls.shape(side);
        let thin = args.thin || args.structure || args.skeleton;
        let thinned = if thin { shape.thin() } else { 0 };
        if args.skeleton {
            let burned = skeleton(&shape);
            shape = burned.shape;
            if burned.triangles_left > 0 {
                talk.at(
                    Talk::Plain,
                    format_args!(
                        "note: {} stayed in the skeleton: they enclose a void",
                        counted(burned.triangles_left, "triangle", "triangles")
                    ),
                );
            }
        }
        Ok((how, side, simple.report, shape, thinned))
    });
    bar.clear();
    drop(bytes);
    let (how, side, report, mut shape, thinned) = outcome?;

    if report.refused > 0 {
        talk.at(
            Talk::Plain,
            format_args!(
                "note: {} stayed that should go: without them the axis would have other parts, \
                 tunnels or voids (--no-keep-topology takes them out)",
                counted(report.refused, "ball", "balls")
            ),
        );
    }
    let parts = args.structure.then(|| structure(&shape));
    if let Some(out) = &target {
        if args.bare {
            shape = bare(shape);
        }
        let write = WriteOptions {
            ascii: args.ascii,
            digits: args.precision,
            comments: vec![
                format!("made by powercrust {}", env!("CARGO_PKG_VERSION")),
                format!("options {}", json!(how)),
            ],
            ..WriteOptions::default()
        };
        stage(&out.target, &out.path, |mut w| {
            write_axis_parts(&mut w, out.format, &shape, parts.as_ref(), &write)
        })?
        .publish()?;
    }
    let seconds = start.elapsed().as_secs_f64();
    let at = match &target {
        Some(out) if out.target != Target::Stdout => out.path.display().to_string(),
        Some(_) => "standard output".to_owned(),
        None => name(&args.input),
    };
    talk.at(Talk::Plain, line(&at, &report, &shape, seconds));
    if args.reporting.json {
        let mut object = json!({
            "ok": true,
            "powercrust": env!("CARGO_PKG_VERSION"),
            "input": { "file": name(&args.input) },
            "side": if side == Side::Inner { "inner" } else { "outer" },
            "options": how,
            "simplified": report,
            "thinned": thinned,
            "axis": in_numbers(&shape),
            "peak_memory_bytes": powercrust::memory::peak(),
            "seconds": seconds,
        });
        if let Some(parts) = &parts {
            object["structure"] = json!(parts);
        }
        let text = format!("{object:#}\n");
        Target::Stdout.stage(|w| w.write_all(text.as_bytes()))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn line(at: &str, report: &SimplifyReport, shape: &PowerShape, seconds: f64) -> String {
    let mut parts = vec![
        format!(
            "{} of {}",
            counted(report.after, "ball", "balls"),
            counted(report.before, "ball", "balls")
        ),
        format!("{} unstable", counted(report.unstable, "ball", "balls")),
        format!("{} redundant", counted(report.redundant, "ball", "balls")),
        counted(shape.triangles.len(), "triangle", "triangles"),
    ];
    if let Some(betti) = report.betti_after {
        parts.push(format!("Betti numbers {betti}"));
    }
    parts.push(format!("{seconds:.2} s"));
    format!("{at}: {}", parts.join(", "))
}

/// Where the axis goes; not over the input, no two results on one stream.
fn place(args: &SimplifyMat) -> Result<Option<Out<AxisFormat>>, Failure> {
    if args.output.is_none() && !args.reporting.json {
        return Err(Failure::usage("nowhere to write the axis: -o is missing").hint(
            "powercrust simplify-mat axis.ma --eps 1% -o simple.ma (see powercrust simplify-mat --help)",
        ));
    }
    let target = out(&args.output, |path| match args.output_format.as_deref() {
        Some(said) => AxisFormat::from_extension(said).ok_or_else(|| {
            Failure::usage(format!("--output-format {said}: unknown format"))
                .hint(format!("known: {}", dotted(AxisFormat::extensions())))
        }),
        None if path.as_os_str() == "-" => Ok(AxisFormat::Ma),
        None => axis_format(path, "-o"),
    })?;
    let idle = |flag: &str, to: &str| {
        Failure::usage(format!("{flag} would have no effect: it applies to {to}"))
            .hint(format!("leave {flag} out"))
    };
    let Some(out) = &target else {
        return match (args.output_format.is_some(), args.bare) {
            (true, _) => Err(idle("--output-format", "the axis, which needs -o")),
            (_, true) => Err(idle("--bare", "the axis, which needs -o")),
            _ => Ok(None),
        };
    };
    let ply = out.format == AxisFormat::Ply;
    if args.ascii && !ply {
        return Err(idle("--ascii", "PLY files"));
    }
    let numbered = ply || out.format == AxisFormat::Json || args.reporting.json;
    if args.structure && !numbered {
        return Err(idle("--structure", "PLY and JSON files and --json"));
    }
    if args.precision.is_some() && ply && !args.ascii {
        return Err(idle("--precision", "text formats"));
    }
    if out.target == Target::Stdout {
        if args.reporting.json {
            return Err(
                Failure::usage("more than one result would go to standard output")
                    .hint("send one of -o - and --json to a file, or leave it out"),
            );
        }
        if ply && !args.ascii && std::io::stdout().is_terminal() {
            return Err(Failure::usage("a binary file would go to the terminal")
                .hint("redirect it, or add --ascii"));
        }
    }
    let is_input =
        matches!(out.target, Target::File(_)) && identity(&out.path) == identity(&args.input);
    if is_input {
        return Err(Failure::usage(format!(
            "{}: this is the input, it would be overwritten",
            out.path.display()
        ))
        .hint("give the simplified axis a name of its own"));
    }
    Ok(target)
}

/// The balls of the input, and the side whose axis is wanted.
fn balls(
    args: &SimplifyMat,
    input: Input,
    bytes: &[u8],
    options: &Options,
    context: &Context,
    talk: Talk,
) -> Result<(LabelledBalls, Side), Failure> {
    let side = match args.side {
        WhichSide::Inner => Side::Inner,
        WhichSide::Outer => Side::Outer,
    };
    let failed = |error| unfit(&args.input, options.lambda.is_given(), error);
    match input {
        Input::Axis(format) => {
            if args.lambda.is_some() || args.skip_invalid {
                return Err(Failure::usage(format!(
                    "--lambda and --skip-invalid would have no effect: {} is a medial axis",
                    name(&args.input)
                ))
                .hint("leave them out"));
            }
            let shape = read_axis(bytes, format)
                .map_err(|error| misread(&args.input, &error, AxisFormat::extensions()))?;
            stop::orderly();
            let own = shape.sides.first().copied().unwrap_or(Side::Inner);
            let side = if shape.others.is_empty() { own } else { side };
            let balls = LabelledBalls::of_shape(&shape, context).map_err(failed)?;
            if balls.estimated {
                talk.at(
                    Talk::Plain,
                    "note: the file does not say what the samples on the balls span: estimated from the radii",
                );
            }
            if !balls.has_both_sides() {
                talk.at(
                    Talk::Plain,
                    "note: the file has balls of one side only: those are joined that meet within their union",
                );
            }
            Ok((balls, side))
        }
        Input::Points(format) => {
            let read = ReadOptions {
                skip_invalid: args.skip_invalid,
            };
            let cloud = read_cloud(bytes, format, &read)
                .map_err(|error| misread(&args.input, &error, CloudFormat::extensions()))?;
            stop::orderly();
            for note in &cloud.report.notes {
                talk.at(Talk::Plain, format_args!("note: {note}"));
            }
            let limit = (of_machine(), "the memory of this machine,");
            enough_memory(&args.input, &estimate(cloud.points.len()), limit)?;
            let options = Options {
                outliers: usual_outliers(&cloud),
                faces: Faces::None,
                ..options.clone()
            };
            let result = run::reconstruct(&cloud, (None, Normals::Auto), &options, context)
                .map_err(failed)?;
            tell::outliers(talk, &result.stats.outliers);
            Ok((LabelledBalls::of(result, &cloud.points), side))
        }
    }
}

fn pipeline_options(args: &SimplifyMat) -> Result<Options, Failure> {
    let options = Options {
        lambda: args.lambda.unwrap_or(LambdaOption::Auto),
        ..Options::default()
    };
    match options.validate() {
        Ok(()) => Ok(options),
        Err(error) => Err(unfit(&args.input, true, error)),
    }
}

/// The lengths in the unit of the input.
fn lengths(args: &SimplifyMat, diagonal: f64) -> SimplifyOptions {
    let said = args.delta.is_some()
        || args.lambda_medial.is_some()
        || args.angle.is_some()
        || args.scale.is_some()
        || args.dey_zhao.is_some()
        || args.balls.is_some();
    let eps = args.eps.or((!said).then_some(Length::Percent(EPS_PERCENT)));
    let eps = eps.map(|l| l.of(diagonal));
    let delta = args.delta.map(|l| l.of(diagonal));
    SimplifyOptions {
        eps,
        delta: delta
            .or(eps.map(|eps| DELTA_OF_EPS * eps))
            .filter(|&d| d > 0.0),
        lambda: args.lambda_medial.map(|l| l.of(diagonal)),
        angle: args.angle,
        scale: args.scale,
        dey_zhao: args.dey_zhao,
        most: args.balls.map(|n| n as usize),
        keep_topology: !args.no_keep_topology,
    }
}

fn unfit(input: &Path, filtered: bool, error: Error) -> Failure {
    match error {
        Error::Option {
            name,
            value,
            expected,
        } => out_of_range(name, value, expected),
        other => unsolved(input, filtered, other),
    }
}

/// Balls and simplices without what else is known.
fn bare(shape: PowerShape) -> PowerShape {
    PowerShape {
        balls: shape.balls,
        ids: shape.ids,
        edges: shape.edges,
        triangles: shape.triangles,
        ..PowerShape::default()
    }
}
