//! `powercrust from-mat`: from balls back to the surface.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use powercrust::axis::LabelledBalls;
use powercrust::inverse::{crust_of_balls, Inverse, InverseOptions};
use powercrust::io::{
    as_written, read_axis, read_mesh, write_mesh, Attribute, AttributeValues, AxisFormat,
    MeshAttributes, MeshFormat, WriteOptions,
};
use powercrust::mesh::{check, deviation, CheckOptions, Deviation, Report};
use powercrust::surface::NONE;
use powercrust::{Context, Error, PolygonMesh, Side};
use serde_json::{json, Value};

use super::balls::{judged, named, Input};
use super::check::faults_in_words;
use super::fail::{name, Code, Failure};
use super::formats::{dotted, extension, mesh_format};
use super::from_mat_args::FromMat;
use super::output::{Staged, Target};
use super::plan::{apart, check_input, out, Out};
use super::run::{misread, read_bytes, stage, unsolved};
use super::show::{counted, Bar, Talk};
use super::stop;
use super::wanted::Wanted;

/// The values faces can have.
const VALUES: [&str; 2] = ["thickness", "gap"];

pub fn from_mat(args: &FromMat) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    let talk = Talk::new(args.reporting.quiet, args.reporting.verbose);
    let said = args.input_format.as_deref().map(axis_named).transpose()?;
    check_input(&args.input)?;
    if let Some(other) = &args.compare {
        check_input(other)?;
    }
    let (mesh, stats) = places(args)?;

    let bytes = read_bytes(&args.input)?;
    let format = match said {
        Some(format) => format,
        None => axis_of(&args.input, &bytes)?,
    };
    let shape = read_axis(&bytes, format)
        .map_err(|error| misread(&args.input, &error, AxisFormat::extensions()))?;
    drop(bytes);
    let other = args.compare.as_deref().map(mesh_at).transpose()?;
    stop::orderly();

    let bar = Bar::new(talk);
    let context = Context {
        threads: args.reporting.threads,
        progress: &bar,
    };
    let write = WriteOptions {
        ascii: args.ascii,
        float32: args.f32,
        digits: args.precision,
        comments: vec![format!("made by powercrust {}", env!("CARGO_PKG_VERSION"))],
    };
    let made = (|| {
        let failed = |error| refused(&args.input, error);
        let balls = LabelledBalls::of_shape(&shape, &context).map_err(failed)?;
        let how = InverseOptions {
            tolerance: args
                .tolerance
                .as_ref()
                .map(|t| t.of(balls.inner_diagonal())),
            union: args.union,
            single: args.f32 || mesh.as_ref().is_some_and(|m| m.format == MeshFormat::Stl),
        };
        let made = crust_of_balls(&balls, &how, &context).map_err(failed)?;
        let report = sound(&made, mesh.as_ref(), &write, &context)?;
        let apart = other
            .as_ref()
            .map(|other| deviation(other, &made.crust.mesh, &context));
        let apart = apart.transpose().map_err(|_| Failure::interrupted())?;
        Ok((how, made, report, apart))
    })();
    bar.clear();
    let (how, made, report, apart) = made?;
    tell_notes(&made, talk);

    let seconds = start.elapsed().as_secs_f64();
    let mut object = json!({
        "ok": true,
        "powercrust": env!("CARGO_PKG_VERSION"),
        "input": { "file": name(&args.input), "format": format },
        "options": how,
        "tolerance": made.tolerance,
        "inner_balls": of_side(&made, Side::Inner),
        "outer_balls": of_side(&made, Side::Outer),
        "outer_balls_made": made.outer_made,
        "union_betti": made.union_betti,
        "betti": made.betti,
        "mesh": in_numbers(&made, &report),
        "peak_memory_bytes": powercrust::memory::peak(),
        "seconds": seconds,
    });
    if let (Some(path), Some(apart)) = (&args.compare, &apart) {
        object["compared"] = json!({ "file": name(path), "distance": apart });
    }
    let text = format!("{object:#}\n");
    let mut staged: Vec<Staged> = Vec::new();
    if let Some(out) = &mesh {
        let values = Values::of(args.attributes.as_ref(), &made);
        staged.push(stage(&out.target, &out.path, |mut w| {
            write_mesh(
                &mut w,
                out.format,
                &made.crust.mesh,
                &values.attributes(),
                &write,
            )
        })?);
    }
    if let Some(out) = &stats {
        staged.push(out.target.stage(|w| w.write_all(text.as_bytes()))?);
    }
    staged.into_iter().try_for_each(Staged::publish)?;
    let at = match &mesh {
        Some(out) if out.target != Target::Stdout => out.path.display().to_string(),
        Some(_) => "standard output".to_owned(),
        None => name(&args.input),
    };
    talk.at(
        Talk::Plain,
        line(&at, &made, &report, apart.as_ref(), seconds),
    );
    if args.reporting.json {
        Target::Stdout.stage(|w| w.write_all(text.as_bytes()))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Where results go, and whether all that was said applies.
#[allow(clippy::type_complexity)]
fn places(args: &FromMat) -> Result<(Option<Out<MeshFormat>>, Option<Out<()>>), Failure> {
    if args.output.is_none() && args.stats.is_none() && !args.reporting.json {
        return Err(Failure::usage("nowhere to write the mesh: -o is missing")
            .hint("powercrust from-mat axis.ma -o crust.ply (see powercrust from-mat --help)"));
    }
    if let Some(tolerance) = args.tolerance.as_ref().filter(|t| !t.is_positive()) {
        return Err(Failure::usage(format!(
            "--tolerance is {}: expected a length above 0",
            tolerance.said
        )));
    }
    let format = |path: &Path| mesh_format(path, args.output_format.as_deref());
    let mesh = out(&args.output, format)?;
    let stats = out(&args.stats, |_| Ok(()))?;
    let kind = mesh.as_ref().map(|m| m.format);
    let (ply, stl) = (kind == Some(MeshFormat::Ply), kind == Some(MeshFormat::Stl));
    let text = (ply || stl) && args.ascii
        || matches!(
            kind,
            Some(MeshFormat::Obj | MeshFormat::Off | MeshFormat::Json)
        );
    let idle = [
        (
            args.output_format.is_some() && kind.is_none(),
            "--output-format",
            "the mesh, which needs -o",
        ),
        (
            args.attributes.is_some() && kind.is_none(),
            "--attributes",
            "the mesh, which needs -o",
        ),
        (args.ascii && !ply && !stl, "--ascii", "PLY and STL files"),
        (
            args.f32 && !ply && !stl && kind != Some(MeshFormat::Glb),
            "--f32",
            "PLY, STL and GLB files",
        ),
        (
            args.precision.is_some() && !text,
            "--precision",
            "text formats",
        ),
    ];
    if let Some((_, flag, to)) = idle.iter().find(|(is_idle, ..)| *is_idle) {
        return Err(
            Failure::usage(format!("{flag} would have no effect: it applies to {to}"))
                .hint(format!("leave {flag} out")),
        );
    }
    if let Some(Wanted::List(names)) = &args.attributes {
        if let Some(unknown) = names.iter().find(|n| !VALUES.contains(&n.as_str())) {
            return Err(
                Failure::usage(format!("--attributes {unknown}: not known here"))
                    .hint(format!("known: {}", VALUES.join(", "))),
            );
        }
    }
    if let (Some(wanted), Some(kind)) = (&args.attributes, kind) {
        if let Some(value) = wanted.beyond(kind) {
            return Err(Failure::usage(format!(
                "--attributes {value} would have no effect: {} files cannot hold it",
                kind.name()
            ))
            .hint("write PLY, or leave it out"));
        }
    }
    let mut all: Vec<(&Path, &Target)> = Vec::new();
    all.extend(mesh.as_ref().map(|o| (o.path.as_path(), &o.target)));
    all.extend(stats.as_ref().map(|o| (o.path.as_path(), &o.target)));
    let streams = all.iter().filter(|(_, t)| **t == Target::Stdout).count();
    if streams + usize::from(args.reporting.json) > 1 {
        return Err(
            Failure::usage("more than one result would go to standard output")
                .hint("send one of -o -, --stats - and --json to a file, or leave it out"),
        );
    }
    let named = |failure: Failure| match failure.hint {
        None => failure.hint("give another name"),
        Some(_) => failure,
    };
    apart(&args.input, &all).map_err(named)?;
    if let Some(other) = &args.compare {
        apart(other, &all).map_err(named)?;
    }
    Ok((mesh, stats))
}

fn axis_named(said: &str) -> Result<AxisFormat, Failure> {
    match AxisFormat::from_extension(said) {
        Some(format) if format != AxisFormat::Obj => Ok(format),
        _ => match named(said)? {
            Input::Axis(format) => Ok(format),
            Input::Points(_) => Err(Failure::usage(format!(
                "--input-format {said}: such files hold no balls"
            ))
            .hint("known: .ma .ply .json")),
        },
    }
}

/// The format of an input that must hold balls.
fn axis_of(path: &Path, bytes: &[u8]) -> Result<AxisFormat, Failure> {
    match judged(path, bytes) {
        Input::Axis(format) => Ok(format),
        Input::Points(_) => Err(Failure::file(path, "this holds no balls with radii").hint(
            "powercrust POINTS -o crust.ply makes the surface of points, simplify-mat their axis",
        )),
    }
}

fn mesh_at(path: &Path) -> Result<PolygonMesh, Failure> {
    let bytes = read_bytes(path)?;
    let format = extension(path).and_then(MeshFormat::from_extension);
    let Some(format) = format.or_else(|| MeshFormat::sniff(&bytes)) else {
        return Err(Failure::file(path, "not a mesh format that can be read")
            .hint(format!("known: {}", dotted(MeshFormat::extensions()))));
    };
    let mesh =
        read_mesh(&bytes, format).map_err(|e| misread(path, &e, MeshFormat::extensions()))?;
    match mesh.face_count() {
        0 => Err(Failure::new(
            Code::Unfit,
            format!("{}: no faces to compare with", name(path)),
        )),
        _ => Ok(mesh),
    }
}

/// The verdict on the mesh as it will be written; an error where it has a
/// fault, and then nothing is written.
fn sound(
    made: &Inverse,
    out: Option<&Out<MeshFormat>>,
    write: &WriteOptions,
    context: &Context,
) -> Result<Report, Failure> {
    let mut mesh = made.crust.mesh.clone();
    if let Some(out) = out {
        mesh.vertices = as_written(out.format, &mesh.vertices, write);
    }
    let report = check(&mesh, &CheckOptions::default(), context);
    let report = report.map_err(|_| Failure::interrupted())?;
    if report.is_watertight() && made.crossings_left == 0 {
        return Ok(report);
    }
    let mut what = faults_in_words(&report, false);
    if what.is_empty() {
        what.push("faces cross".to_owned());
    }
    let path = out.map_or(PathBuf::from("the mesh"), |out| out.path.clone());
    let failure = Failure::new(
        Code::Unfit,
        format!(
            "{}: it would not be sound: {}",
            name(&path),
            what.join("; ")
        ),
    );
    Err(failure.hint("nothing was written; take another --tolerance, more digits, or PLY"))
}

fn refused(input: &Path, error: Error) -> Failure {
    let hint = match &error {
        Error::NoInnerBalls => "give the axis of the inside, or a file with balls of both sides",
        _ => return unsolved(input, false, error),
    };
    Failure::new(Code::Unfit, format!("{}: {error}", name(input))).hint(hint)
}

fn tell_notes(made: &Inverse, talk: Talk) {
    if made.outer_made > 0 && talk >= Talk::Verbose {
        let balls = counted(made.outer_made, "outer ball", "outer balls");
        talk.at(
            Talk::Verbose,
            format_args!("{balls} made from the complement"),
        );
    }
    if let (Some(union), Some(found)) = (made.union_betti, made.betti) {
        if union != found {
            talk.at(
                Talk::Plain,
                format_args!(
                    "note: the union of the balls has the Betti numbers {union}, the solid {found}"
                ),
            );
        }
    }
    if made.turned > 0 {
        let balls = counted(made.turned, "inner ball", "inner balls");
        talk.at(
            Talk::Plain,
            format_args!("note: {balls} left out where the surface crossed itself"),
        );
    }
}

fn of_side(made: &Inverse, side: Side) -> usize {
    made.balls.sides.iter().filter(|&&s| s == side).count()
}

fn in_numbers(made: &Inverse, report: &Report) -> Value {
    json!({
        "vertices": report.vertices,
        "faces": report.faces,
        "components": report.components,
        "genus": report.genus,
        "cavities": report.cavities,
        "volume": report.volume,
        "area": report.area,
        "fitted": made.fitted,
        "unfitted_balls": made.unfitted,
        "turned_balls": made.turned,
        "largest_distance_from_union": made.from_union[0],
        "mean_distance_from_union": made.from_union[1],
    })
}

/// One line for people.
fn line(
    at: &str,
    made: &Inverse,
    report: &Report,
    apart: Option<&Deviation>,
    seconds: f64,
) -> String {
    let mut parts = vec![
        counted(report.faces as usize, "triangle", "triangles"),
        counted(report.components as usize, "component", "components"),
    ];
    if report.cavities > 0 {
        parts.push(counted(report.cavities as usize, "cavity", "cavities"));
    }
    if let Some(genus) = report.genus {
        parts.push(format!("genus {genus}"));
    }
    let [most, mean] = made.from_union;
    parts.push(format!("off the union by {mean:.1e}, at most {most:.1e}"));
    if let Some(apart) = apart {
        parts.push(format!(
            "{:.1e} apart, at most {:.1e}",
            apart.mean, apart.max
        ));
    }
    parts.push(format!("{seconds:.2} s"));
    format!("{at}: {}", parts.join(", "))
}

/// Values of the faces.
#[derive(Default)]
struct Values(Vec<(&'static str, Vec<f64>)>);

impl Values {
    fn of(wanted: Option<&Wanted>, made: &Inverse) -> Values {
        let diameter = |b: u32| match b {
            NONE => -1.0,
            b => 2.0 * made.balls.balls[b as usize].radius,
        };
        let column = |k: usize| {
            made.crust
                .face_balls
                .iter()
                .map(|f| diameter(f[k]))
                .collect()
        };
        let wanted = |value: &str| wanted.is_some_and(|w| w.wants(value, false));
        let all = VALUES.into_iter().enumerate();
        Values(
            all.filter(|(_, v)| wanted(v))
                .map(|(k, v)| (v, column(k)))
                .collect(),
        )
    }

    fn attributes(&self) -> MeshAttributes<'_> {
        let faces = self.0.iter().map(|(name, values)| Attribute {
            name,
            values: AttributeValues::Float(values),
        });
        MeshAttributes {
            faces: faces.collect(),
            ..MeshAttributes::default()
        }
    }
}
