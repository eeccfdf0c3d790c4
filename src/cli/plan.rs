//! What the arguments mean, and whether it can be done: everything that can be
//! refused is refused here, before points are read.

use std::fs;
use std::io::IsTerminal;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use powercrust::holes::DEFAULT_SPACINGS;
use powercrust::io::{AxisFormat, CloudFormat, MeshFormat, ReadOptions, WriteOptions};
use powercrust::surface::ShellFilter;
use powercrust::{Error, Faces, LambdaOption, Options, Point, SharpOption};

use super::args::Reconstruct;
use super::fail::{name, reason, Failure};
use super::formats::{
    axis_format, dropped_format, extension, input_format, mesh_format, outliers_format,
    poles_format,
};
use super::output::Target;
use super::show::Talk;
use super::wanted::{Fewer, HoleWidth, Holes, Normals, Wanted};

/// The skinniness bound `--sharp` takes when none is given: near it the error
/// at edges is least (a cube of 10,000 random samples: 0.0005 with 0.4, 0.015
/// with 0.5, 0.0008 with 0.3).
const SHARP_LAMBDA: f64 = 0.4;

/// A run to be made.
#[derive(Debug)]
pub struct Plan {
    pub input: PathBuf,
    /// `None`: judged by the bytes.
    pub input_format: Option<CloudFormat>,
    pub read: ReadOptions,
    pub options: Options,
    pub threads: Option<NonZeroUsize>,
    /// Which parts to keep.
    pub shells: ShellFilter,
    /// What becomes of places where nothing was sampled.
    pub holes: Holes,
    /// Which places these are.
    pub hole_size: HoleWidth,
    /// How many triangles to reduce to.
    pub fewer: Option<Fewer>,
    /// Which values the mesh carries.
    pub attributes: Wanted,
    pub write: WriteOptions,
    pub mesh: Option<Out<MeshFormat>>,
    pub inner_axis: Option<Out<AxisFormat>>,
    pub outer_axis: Option<Out<AxisFormat>>,
    /// Collapse the flat tetrahedra of the axes.
    pub thin: bool,
    pub poles: Option<Out<()>>,
    pub outliers: Option<Out<()>>,
    /// The poles dropped.
    pub dropped: Option<Out<()>>,
    /// Where the scanner stood.
    pub sensor: Option<Point>,
    /// Whether normals tell what is outside.
    pub normals: Normals,
    /// Whether outliers were spoken of on the command line.
    pub outliers_told: bool,
    pub stats: Option<Out<()>>,
    pub json: bool,
    /// Judge the mesh as written; write it only if it is sound.
    pub verify: bool,
    /// Only say what the run would take.
    pub dry_run: bool,
    /// The most memory the run may be likely to need, in bytes.
    pub max_memory: Option<u64>,
    pub talk: Talk,
    /// What was decided for the user, for `-v`.
    pub decisions: Vec<String>,
}

/// A result to be written.
#[derive(Debug)]
pub struct Out<F> {
    pub path: PathBuf,
    pub target: Target,
    pub format: F,
}

impl Plan {
    pub fn new(args: Reconstruct) -> Result<Plan, Failure> {
        let Some(input) = args.input.clone() else {
            return Err(Failure::usage("no points given")
                .hint("powercrust points.ply -o crust.ply (see powercrust --help)"));
        };
        let plan = Plan::read(&args, &input)?;
        let results = [
            &args.output,
            &args.mat,
            &args.outer_mat,
            &args.poles,
            &args.report_outliers,
            &args.report_poles,
            &args.stats,
        ];
        if !args.reporting.json && !args.dry_run && results.iter().all(|path| path.is_none()) {
            return Err(
                Failure::usage("nowhere to write the mesh: -o is missing").hint(suggestion(&input))
            );
        }
        let plan = Plan {
            mesh: out(&args.output, |path| {
                mesh_format(path, args.output_format.as_deref())
            })?,
            inner_axis: out(&args.mat, |path| axis_format(path, "--mat"))?,
            outer_axis: out(&args.outer_mat, |path| axis_format(path, "--outer-mat"))?,
            thin: args.thin,
            poles: out(&args.poles, poles_format)?,
            outliers: out(&args.report_outliers, outliers_format)?,
            dropped: out(&args.report_poles, dropped_format)?,
            stats: out(&args.stats, |_| Ok(()))?,
            ..plan
        };
        if plan.holes == Holes::Fill && plan.options.faces == Faces::Polygons {
            return Err(Failure::usage(
                "--holes fill and --polygons: polygons would not stay flat",
            )
            .hint("leave --polygons out"));
        }
        plan.check_places()?;
        plan.check_idle_flags(&args)?;
        Ok(plan)
    }

    /// The files that need no surface: axes, balls, poles and outliers.
    fn beside_the_mesh(&self) -> impl Iterator<Item = (&Target, &Path)> {
        let axes = [&self.inner_axis, &self.outer_axis].into_iter().flatten();
        let others = [&self.poles, &self.outliers, &self.dropped]
            .into_iter()
            .flatten();
        let axes = axes.map(|out| (&out.target, out.path.as_path()));
        axes.chain(others.map(|out| (&out.target, out.path.as_path())))
    }

    /// Whether nothing that is wanted needs the surface: it is neither written nor told of.
    pub fn no_surface(&self) -> bool {
        let told = self.stats.is_some() || self.json || self.verify;
        self.mesh.is_none() && !told && self.beside_the_mesh().next().is_some()
    }

    /// The first file that is not the mesh, for messages; the input where there is none.
    pub fn first_result(&self) -> String {
        match self.beside_the_mesh().next() {
            Some((Target::Stdout, _)) => "standard output".to_owned(),
            Some((_, path)) => path.display().to_string(),
            None => name(&self.input),
        }
    }

    /// A run that writes nothing: how points are read and reconstructed.
    pub fn read(args: &Reconstruct, input: &Path) -> Result<Plan, Failure> {
        let mut decisions = Vec::new();
        let options = options(args, &mut decisions)?;
        let input_format = input_format(input, args.input_format.as_deref())?;
        check_input(input)?;
        Ok(Plan {
            mesh: None,
            inner_axis: None,
            outer_axis: None,
            thin: false,
            poles: None,
            outliers: None,
            dropped: None,
            sensor: args.sensor,
            normals: args.normals.unwrap_or_default(),
            stats: None,
            write: WriteOptions {
                ascii: args.ascii,
                float32: args.f32,
                digits: args.precision,
                comments: comments(&options),
            },
            read: ReadOptions {
                skip_invalid: args.skip_invalid,
            },
            input: input.to_owned(),
            input_format,
            options,
            outliers_told: args.outliers.is_some(),
            threads: args.reporting.threads,
            shells: ShellFilter {
                keep: args.keep.unwrap_or_default(),
                min_volume: args.min_volume,
                drop_cavities: args.drop_cavities,
            },
            holes: args.holes.unwrap_or_default(),
            hole_size: (args.hole_size).unwrap_or(HoleWidth::Spacings(DEFAULT_SPACINGS)),
            fewer: (args.faces.map(|n| Fewer::Faces(n as usize))).or(args.reduce.map(Fewer::OneIn)),
            attributes: args.attributes.clone().unwrap_or_default(),
            json: args.reporting.json,
            verify: args.verify,
            dry_run: args.dry_run,
            max_memory: args.max_memory,
            talk: Talk::new(args.reporting.quiet, args.reporting.verbose),
            decisions,
        })
    }

    /// Path and target of every result.
    fn outs(&self) -> Vec<(&Path, &Target)> {
        fn of<F>(out: &Option<Out<F>>) -> Option<(&Path, &Target)> {
            out.as_ref().map(|out| (out.path.as_path(), &out.target))
        }
        [
            of(&self.mesh),
            of(&self.inner_axis),
            of(&self.outer_axis),
            of(&self.poles),
            of(&self.outliers),
            of(&self.dropped),
            of(&self.stats),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// No two results in one place, none over the input, no bytes on a screen.
    fn check_places(&self) -> Result<(), Failure> {
        let outs = self.outs();
        if let Some(out) = &self.mesh {
            let binary = match out.format {
                MeshFormat::Ply | MeshFormat::Stl => !self.write.ascii,
                MeshFormat::Glb => true,
                _ => false,
            };
            if binary && out.target == Target::Stdout && std::io::stdout().is_terminal() {
                return Err(Failure::usage("a binary mesh would go to the terminal")
                    .hint("redirect it, or add --ascii or --output-format obj"));
            }
        }
        let streams = outs.iter().filter(|(_, t)| **t == Target::Stdout).count();
        if streams + usize::from(self.json) > 1 {
            return Err(
                Failure::usage("more than one result would go to standard output")
                    .hint("send one of -o -, --stats - and --json to a file, or leave it out"),
            );
        }
        apart(&self.input, &outs).map_err(|failure| match failure.hint {
            None => failure.hint(suggestion(&self.input)),
            Some(_) => failure,
        })
    }

    /// A flag that would change nothing is a misunderstanding.
    fn check_idle_flags(&self, args: &Reconstruct) -> Result<(), Failure> {
        let mesh = self.mesh.as_ref().map(|out| out.format);
        let axes: Vec<AxisFormat> = [&self.inner_axis, &self.outer_axis]
            .into_iter()
            .flatten()
            .map(|out| out.format)
            .collect();
        let any_axis = |formats: &[AxisFormat]| axes.iter().any(|f| formats.contains(f));
        let ply = mesh == Some(MeshFormat::Ply)
            || any_axis(&[AxisFormat::Ply])
            || self.poles.is_some()
            || self.outliers.is_some();
        let stl = mesh == Some(MeshFormat::Stl);
        let text = ((ply || stl) && args.ascii)
            || matches!(
                mesh,
                Some(MeshFormat::Obj | MeshFormat::Off | MeshFormat::Json)
            )
            || any_axis(&[AxisFormat::Ma, AxisFormat::Obj, AxisFormat::Json]);
        let single = ply || matches!(mesh, Some(MeshFormat::Stl | MeshFormat::Glb));
        if let Some(format) = mesh {
            if let Some(name) = self.attributes.beyond(format) {
                return Err(Failure::usage(format!(
                    "--attributes {name} would have no effect: {} files cannot hold it",
                    format.name()
                ))
                .hint("write PLY, or leave it out"));
            }
        }
        let idle = [
            (
                args.attributes.is_some() && mesh.is_none(),
                "--attributes",
                "the mesh, which needs -o",
            ),
            (
                args.thin && axes.is_empty(),
                "--thin",
                "medial axes, which need --mat or --outer-mat",
            ),
            (args.ascii && !ply && !stl, "--ascii", "PLY and STL files"),
            (args.f32 && !single, "--f32", "PLY, STL and GLB files"),
            (
                args.precision.is_some() && !text,
                "--precision",
                "text formats (OBJ, OFF, MA, JSON, and PLY or STL with --ascii)",
            ),
            (
                args.output_format.is_some() && mesh.is_none(),
                "--output-format",
                "the mesh, which needs -o",
            ),
        ];
        let bare = self.no_surface();
        let of_surface = [
            (args.keep.is_some(), "--keep"),
            (args.min_volume.is_some(), "--min-volume"),
            (args.drop_cavities, "--drop-cavities"),
            (args.holes.is_some(), "--holes"),
            (args.hole_size.is_some(), "--hole-size"),
            (args.faces.is_some(), "--faces"),
            (args.reduce.is_some(), "--reduce"),
            (args.polygons, "--polygons"),
            (args.flatness.is_some(), "--flatness"),
        ]
        .map(|(given, flag)| (given && bare, flag, "the surface, which needs -o"));
        let mut idle = idle.iter().chain(&of_surface);
        match idle.find(|(is_idle, ..)| *is_idle) {
            Some((_, flag, where_)) => Err(Failure::usage(format!(
                "{flag} would have no effect: it applies to {where_}"
            ))
            .hint(format!("leave {flag} out"))),
            None => Ok(()),
        }
    }
}

fn options(args: &Reconstruct, decisions: &mut Vec<String>) -> Result<Options, Failure> {
    let plain = Options::default();
    let mut lambda = args.lambda.unwrap_or(plain.lambda);
    let sharp = args.sharp.map_or(plain.sharp, SharpOption::from);
    if sharp == SharpOption::Skinny && args.lambda.is_none() {
        lambda = LambdaOption::Value(SHARP_LAMBDA);
        decisions.push(format!("--sharp without --lambda: taking {SHARP_LAMBDA}"));
    }
    let options = Options {
        lambda,
        sharp,
        noise: args.noise.unwrap_or(plain.noise),
        outliers: args.outliers.unwrap_or(plain.outliers),
        label: args.label.unwrap_or(plain.label),
        deep_angle: args.deep_angle.unwrap_or(plain.deep_angle),
        box_factor: args.box_factor.unwrap_or(plain.box_factor),
        merge: args.merge.unwrap_or(plain.merge),
        flatness: args.flatness.unwrap_or(plain.flatness),
        interpolate: args.interpolate,
        faces: if args.polygons {
            Faces::Polygons
        } else {
            Faces::Triangles
        },
        cells: true,
        single: args.f32,
    };
    match options.validate() {
        Ok(()) => Ok(options),
        Err(Error::Option {
            name,
            value,
            expected,
        }) => Err(out_of_range(name, value, expected)),
        Err(other) => Err(Failure::usage(other.to_string())),
    }
}

/// An option out of range, by the name of its flag.
pub fn out_of_range(name: &str, value: f64, expected: &str) -> Failure {
    let value = match value.abs() {
        0.0 | 1e-5..1e15 => value.to_string(),
        _ => format!("{value:e}"),
    };
    Failure::usage(format!(
        "--{} is {value}: expected {expected}",
        name.replace('_', "-")
    ))
}

/// Lines for the head of the files: enough to make them again.
fn comments(options: &Options) -> Vec<String> {
    let options = serde_json::to_string(options).expect("options are plain values");
    vec![
        format!("made by powercrust {}", env!("CARGO_PKG_VERSION")),
        format!("options {options}"),
    ]
}

/// Results lie in files of their own, none in that of the input.
pub fn apart(input: &Path, outs: &[(&Path, &Target)]) -> Result<(), Failure> {
    let input = identity(input);
    let mut taken: Vec<PathBuf> = Vec::new();
    for (path, target) in outs {
        if !matches!(target, Target::File(_)) {
            continue;
        }
        let place = identity(path);
        if place == input {
            return Err(Failure::usage(format!(
                "{}: this is the input, it would be overwritten",
                path.display()
            )));
        }
        if taken.contains(&place) {
            return Err(Failure::usage(format!(
                "{}: two results would be written to this file",
                path.display()
            ))
            .hint("give each result a file of its own"));
        }
        taken.push(place);
    }
    Ok(())
}

/// Judges where a result goes and in which format.
pub fn out<F>(
    path: &Option<PathBuf>,
    format: impl FnOnce(&Path) -> Result<F, Failure>,
) -> Result<Option<Out<F>>, Failure> {
    let Some(path) = path else {
        return Ok(None);
    };
    if path.is_dir() {
        Target::judge(path)?;
    }
    Ok(Some(Out {
        format: format(path)?,
        target: Target::judge(path)?,
        path: path.clone(),
    }))
}

/// The points are there and can be opened.
pub fn check_input(path: &Path) -> Result<(), Failure> {
    if path.as_os_str() == "-" {
        return Ok(());
    }
    if path.is_dir() {
        return Err(Failure::file(path, "cannot read: this is a directory")
            .hint("name the file with the points"));
    }
    match fs::File::open(path) {
        Ok(_) => Ok(()),
        Err(error) => {
            let failure = Failure::file(path, format!("cannot read: {}", reason(&error)));
            Err(match error.kind() {
                std::io::ErrorKind::NotFound => failure.hint(match extension(path) {
                    None => "see powercrust --help for the commands and options",
                    Some(_) => "check the name and the directory",
                }),
                _ => failure,
            })
        }
    }
}

/// The place a path names, whether or not there is a file yet.
pub fn identity(path: &Path) -> PathBuf {
    if let Ok(place) = fs::canonicalize(path) {
        return place;
    }
    let parent = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    match (fs::canonicalize(parent), path.file_name()) {
        (Ok(parent), Some(file)) => parent.join(file),
        _ => path.to_owned(),
    }
}

/// The full command that would have worked.
fn suggestion(input: &Path) -> String {
    let stem = match input.file_stem() {
        Some(stem) if input.as_os_str() != "-" => format!("{}-crust.ply", stem.to_string_lossy()),
        _ => "crust.ply".to_owned(),
    };
    let quoted = |text: String| {
        let plain = |c: char| c.is_alphanumeric() || "-_./".contains(c);
        if text.chars().all(plain) {
            text
        } else {
            format!("'{}'", text.replace('\'', r"'\''"))
        }
    };
    let input = match name(input) {
        stream if stream == "standard input" => "-".to_owned(),
        path => quoted(path),
    };
    format!("powercrust {input} -o {}", quoted(stem))
}
