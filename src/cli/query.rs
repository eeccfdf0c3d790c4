//! `powercrust query`: what a medial axis says of points.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use powercrust::axis::{Answer, LabelledBalls, MedialAxis, NO_BALL};
use powercrust::io::{
    read_axis, read_cloud, write_mesh, Attribute, AttributeValues, AxisFormat, Cloud, CloudFormat,
    MeshAttributes, MeshFormat, ReadOptions, WriteOptions,
};
use powercrust::memory::{estimate, of_machine};
use powercrust::{Context, Error, Faces, LambdaOption, Options, Point, PolygonMesh, Side};
use serde_json::json;

use super::balls::{judged, named, Input};
use super::fail::{name, Code, Failure};
use super::formats::{extension, input_format};
use super::output::Target;
use super::plan::{apart, check_input, out, Out};
use super::query_args::Query;
use super::run::{self, enough_memory, misread, read_bytes, stage, unsolved, usual_outliers};
use super::show::{counted, Bar, Talk};
use super::stop;
use super::tell;
use super::wanted::Normals;

/// How the table is written.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Format {
    Csv,
    Ply,
}

pub fn query(args: &Query) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    let talk = Talk::new(args.reporting.quiet, args.reporting.verbose);
    let said = args.input_format.as_deref().map(named).transpose()?;
    check_input(&args.input)?;
    check_input(&args.at)?;
    let target = place(args)?;
    let bytes = read_bytes(&args.input)?;
    let input = said.unwrap_or_else(|| judged(&args.input, &bytes));
    let read = ReadOptions {
        skip_invalid: args.skip_invalid,
    };
    let asked = {
        let bytes = read_bytes(&args.at)?;
        let format = input_format(&args.at, None)?.unwrap_or_else(|| CloudFormat::sniff(&bytes));
        points(&args.at, &bytes, format, &ReadOptions::default())?
    };
    let bar = Bar::new(talk);
    let context = Context {
        threads: args.reporting.threads,
        progress: &bar,
    };
    let outcome = axis(args, input, &bytes, &read, &context, talk).and_then(|axis| {
        let failed = |error| refused(&args.at, false, error);
        Ok((
            axis.ask(&asked.points, &context).map_err(failed)?,
            axis.has_both_sides(),
        ))
    });
    bar.clear();
    drop(bytes);
    let (answers, both) = outcome?;
    if let Some(out) = &target {
        let write = WriteOptions {
            ascii: args.ascii,
            comments: vec![format!("made by powercrust {}", env!("CARGO_PKG_VERSION"))],
            ..WriteOptions::default()
        };
        let staged = match out.format {
            Format::Csv => out.target.stage(|w| write_csv(w, &asked.points, &answers)),
            Format::Ply => stage(&out.target, &out.path, |mut w| {
                let mesh = PolygonMesh::with_vertices(asked.points.clone());
                let columns = Columns::of(&answers);
                write_mesh(
                    &mut w,
                    MeshFormat::Ply,
                    &mesh,
                    &columns.attributes(),
                    &write,
                )
            }),
        };
        staged?.publish()?;
    }
    let inside = answers.iter().filter(|a| a.side == Side::Inner).count();
    let range = |of: fn(&Answer) -> f64| {
        let all = answers.iter().map(of);
        let least = all.clone().fold(f64::INFINITY, f64::min);
        [least, all.fold(f64::NEG_INFINITY, f64::max)]
    };
    let (distance, thickness) = (range(|a| a.distance), range(|a| a.thickness));
    let seconds = start.elapsed().as_secs_f64();
    let at = match &target {
        Some(out) if out.target != Target::Stdout => out.path.display().to_string(),
        Some(_) => "standard output".to_owned(),
        None => name(&args.at),
    };
    talk.at(
        Talk::Plain,
        format_args!(
            "{at}: {}, {inside} inside, distances {:.3e} to {:.3e}, {seconds:.2} s",
            counted(answers.len(), "point", "points"),
            distance[0],
            distance[1]
        ),
    );
    if args.reporting.json {
        let object = json!({
            "ok": true,
            "powercrust": env!("CARGO_PKG_VERSION"),
            "input": { "file": name(&args.input) },
            "at": { "file": name(&args.at), "read": asked.report },
            "both_sides": both,
            "points": answers.len(),
            "inside": inside,
            "distance": distance,
            "thickness": thickness,
            "seconds": seconds,
        });
        let text = format!("{object:#}\n");
        Target::Stdout.stage(|w| w.write_all(text.as_bytes()))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Where the table goes.
fn place(args: &Query) -> Result<Option<Out<Format>>, Failure> {
    if args.output.is_none() && !args.reporting.json {
        return Err(Failure::usage("nowhere to write the answers: -o is missing").hint(
            "powercrust query points.ply --at places.xyz -o values.csv (see powercrust query --help)",
        ));
    }
    if args.input.as_os_str() == "-" && args.at.as_os_str() == "-" {
        return Err(Failure::usage("both inputs would come from standard input")
            .hint("name a file for one of them"));
    }
    let target = out(&args.output, |path| {
        let said = args.output_format.as_deref();
        let by_name = said.or_else(|| extension(path));
        match by_name.map(str::to_ascii_lowercase).as_deref() {
            Some("csv") => Ok(Format::Csv),
            Some("ply") => Ok(Format::Ply),
            None if path.as_os_str() == "-" => Ok(Format::Csv),
            _ => Err(
                Failure::usage(format!("{}: no format of tables", path.display()))
                    .hint("known: .csv .ply; or say --output-format csv"),
            ),
        }
    })?;
    let ply = target.as_ref().is_some_and(|out| out.format == Format::Ply);
    let idle = match &target {
        None if args.output_format.is_some() => {
            Some(("--output-format", "the table, which needs -o"))
        }
        _ if args.ascii && !ply => Some(("--ascii", "PLY files")),
        _ => None,
    };
    if let Some((flag, to)) = idle {
        return Err(
            Failure::usage(format!("{flag} would have no effect: it applies to {to}"))
                .hint(format!("leave {flag} out")),
        );
    }
    let Some(out) = target else { return Ok(None) };
    if out.target == Target::Stdout && args.reporting.json {
        return Err(
            Failure::usage("more than one result would go to standard output")
                .hint("send one of -o - and --json to a file, or leave it out"),
        );
    }
    for input in [&args.input, &args.at] {
        apart(input, &[(out.path.as_path(), &out.target)])
            .map_err(|failure| failure.hint("give another name"))?;
    }
    Ok(Some(out))
}

fn points(
    path: &Path,
    bytes: &[u8],
    format: CloudFormat,
    read: &ReadOptions,
) -> Result<Cloud, Failure> {
    let cloud = read_cloud(bytes, format, read);
    cloud.map_err(|error| misread(path, &error, CloudFormat::extensions()))
}

/// The axis to ask.
fn axis(
    args: &Query,
    input: Input,
    bytes: &[u8],
    read: &ReadOptions,
    context: &Context,
    talk: Talk,
) -> Result<MedialAxis, Failure> {
    let failed = |error| refused(&args.input, args.lambda.is_some(), error);
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
            let balls = LabelledBalls::of_shape(&shape, context).map_err(failed)?;
            if !balls.has_both_sides() {
                talk.at(
                    Talk::Plain,
                    "note: the file has balls of one side only: inside is what their union holds",
                );
            }
            Ok(MedialAxis::of(&balls))
        }
        Input::Points(format) => {
            let options = Options {
                lambda: args.lambda.unwrap_or(LambdaOption::Auto),
                ..Options::default()
            };
            options.validate().map_err(failed)?;
            let cloud = points(&args.input, bytes, format, read)?;
            stop::orderly();
            for note in &cloud.report.notes {
                talk.at(Talk::Plain, format_args!("note: {note}"));
            }
            let limit = (of_machine(), "the memory of this machine,");
            enough_memory(&args.input, &estimate(cloud.points.len()), limit)?;
            let options = Options {
                outliers: usual_outliers(&cloud),
                faces: Faces::None,
                ..options
            };
            let result = run::reconstruct(&cloud, (None, Normals::Auto), &options, context);
            let result = result.map_err(failed)?;
            tell::outliers(talk, &result.stats.outliers);
            Ok(result.medial_axis())
        }
    }
}

fn refused(input: &Path, filtered: bool, error: Error) -> Failure {
    match error {
        Error::NoInnerBalls => Failure::new(Code::Unfit, format!("{}: {error}", name(input)))
            .hint("give the axis of the inside, or a file with balls of both sides"),
        other => unsolved(input, filtered, other),
    }
}

/// A ball as a number in a file.
fn number(ball: u32) -> i32 {
    match ball {
        NO_BALL => -1,
        ball => ball as i32,
    }
}

fn write_csv(writer: &mut dyn Write, points: &[Point], answers: &[Answer]) -> io::Result<()> {
    writeln!(
        writer,
        "x,y,z,side,distance,lower,upper,thickness,ball,inner_ball"
    )?;
    for ([x, y, z], a) in points.iter().zip(answers) {
        let [low, high] = a.bounds;
        writeln!(
            writer,
            "{x},{y},{z},{},{},{low},{high},{},{},{}",
            a.side as u8,
            a.distance,
            a.thickness,
            number(a.ball),
            number(a.inner)
        )?;
    }
    Ok(())
}

/// The answers, column by column.
struct Columns {
    side: Vec<u8>,
    lengths: [(&'static str, Vec<f64>); 4],
    balls: [(&'static str, Vec<i32>); 2],
}

impl Columns {
    fn of(answers: &[Answer]) -> Columns {
        let lengths = |of: fn(&Answer) -> f64| answers.iter().map(of).collect();
        let balls = |of: fn(&Answer) -> u32| answers.iter().map(|a| number(of(a))).collect();
        Columns {
            side: answers.iter().map(|a| a.side as u8).collect(),
            lengths: [
                ("distance", lengths(|a| a.distance)),
                ("lower", lengths(|a| a.bounds[0])),
                ("upper", lengths(|a| a.bounds[1])),
                ("thickness", lengths(|a| a.thickness)),
            ],
            balls: [
                ("ball", balls(|a| a.ball)),
                ("inner_ball", balls(|a| a.inner)),
            ],
        }
    }

    fn attributes(&self) -> MeshAttributes<'_> {
        let mut vertices = vec![Attribute {
            name: "side",
            values: AttributeValues::Byte(&self.side),
        }];
        vertices.extend(self.lengths.iter().map(|(name, values)| Attribute {
            name,
            values: AttributeValues::Float(values),
        }));
        vertices.extend(self.balls.iter().map(|(name, values)| Attribute {
            name,
            values: AttributeValues::Int(values),
        }));
        MeshAttributes {
            vertices,
            ..MeshAttributes::default()
        }
    }
}
