//! What was said on the command line, recorded and not yet judged: see
//! [`super::plan`] for what it means.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{ArgAction, Args, CommandFactory, Parser, Subcommand, ValueEnum};
use powercrust::io::{AxisFormat, CloudFormat, MeshFormat};
use powercrust::surface::{Keep, MinVolume};
use powercrust::{LabelOption, LambdaOption, NoiseOption, Options, OutlierOption, Point};

use super::formats::dotted;
use super::from_mat_args::{self, FromMat};
use super::query_args::{self, Query};
use super::simplify_args::{self, SimplifyMat};
use super::wanted::{self, Distance, Distances, HoleWidth, Holes, Normals, Sharp, Wanted};

const EXAMPLES: &str = "\
Examples:
  powercrust points.ply -o crust.ply            a watertight mesh
  powercrust points.ply --sharp -o part.ply     a machine part with sharp edges
  powercrust points.ply --report-outliers wild.ply -o crust.ply
                                                which samples lie on no surface
  powercrust points.xyz --mat axis.ma           the medial axis alone
  powercrust simplify-mat axis.ma --eps 1% -o simple.ma
                                                its stable part
  powercrust from-mat simple.ma -o crust.ply    and back to the surface
  cat points.xyz | powercrust - -o - --output-format obj > crust.obj
  powercrust check crust.ply                    is a mesh fit for use?";

const EXIT_CODES: &str = "\
Exit codes:
  0    done (check: the mesh is sound)
  1    the input cannot be reconstructed: bad data, or no solid (check: the
       mesh is not sound)
  2    wrong usage
  3    a file cannot be read or written, or is truncated or malformed
  101  a bug in powercrust
  130  interrupted";

fn formats_help() -> String {
    format!(
        "\
Formats:
  points       {}
               (other names: by the first bytes)
  mesh         {}
  medial axis  {}
  poles        .ply",
        dotted(CloudFormat::extensions()),
        dotted(MeshFormat::extensions()),
        dotted(AxisFormat::extensions()),
    )
}

const CHECK_EXAMPLES: &str = "\
Examples:
  powercrust check crust.ply
  powercrust check crust.ply --json | jq .genus";

const OFFSET_EXAMPLES: &str = "\
Examples:
  powercrust offset points.ply --distance 0.5 -o larger.ply
  powercrust offset points.ply --distance 0.5,-0.5,1% -o 'part_{d}.ply'
                                         three surfaces from one reconstruction
  powercrust offset points.ply --shell 2 -o hollow.ply
                                         a wall 2 thick, inside the surface
  powercrust offset points.ply --distance 3 --shell 3 -o mould.ply
                                         a wall 3 thick, outside the surface";

/// Watertight surface and medial axis of a point cloud.
///
/// Points go in, a closed and oriented mesh comes out. No normals are needed
/// and no option is required.
#[derive(Debug, Parser)]
#[command(
    name = "powercrust",
    version,
    max_term_width = 100,
    args_conflicts_with_subcommands = true,
    arg_required_else_help = true,
    disable_help_subcommand = true,
    after_help = "See --help for examples, file formats and exit codes.",
    after_long_help = format!("{EXAMPLES}\n\n{}\n\n{EXIT_CODES}", formats_help()),
)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub reconstruct: Reconstruct,
    /// Print a man page or shell completions and exit.
    #[arg(long, value_enum, value_name = "WHAT", exclusive = true, help_heading = REPORTING)]
    pub generate: Option<Generate>,
}

impl Cli {
    /// The command as clap knows it, for man page and completions.
    pub fn definition() -> clap::Command {
        Cli::command()
    }
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Say whether a mesh is closed, manifold, oriented and free of crossings.
    #[command(after_help = CHECK_EXAMPLES, after_long_help = format!("{CHECK_EXAMPLES}\n\n{EXIT_CODES}"))]
    Check(Check),
    /// The surface that a medial axis stands for, or that of the union of its
    /// balls.
    #[command(after_help = from_mat_args::EXAMPLES, after_long_help = format!("{}\n\n{EXIT_CODES}", from_mat_args::EXAMPLES))]
    FromMat(FromMat),
    /// Surfaces at a distance outside or inside, and shells.
    #[command(after_help = OFFSET_EXAMPLES, after_long_help = format!("{OFFSET_EXAMPLES}\n\n{EXIT_CODES}"))]
    Offset(Box<Offset>),
    /// What a medial axis says of points: inside or outside, how far, how thick.
    #[command(after_help = query_args::EXAMPLES, after_long_help = format!("{}\n\n{EXIT_CODES}", query_args::EXAMPLES))]
    Query(Query),
    /// Simplify a medial axis.
    #[command(after_help = simplify_args::EXAMPLES, after_long_help = format!("{}\n\n{EXIT_CODES}", simplify_args::EXAMPLES))]
    SimplifyMat(SimplifyMat),
}

const FILES: &str = "Input and output";
const METHOD: &str = "Reconstruction";
const SURFACE: &str = "Surface";
const EXTRA: &str = "More results";
const REPORTING: &str = "Running and reporting";

#[derive(Debug, Default, Args)]
pub struct Reconstruct {
    /// Points to read; `-` for standard input.
    ///
    /// A mesh file is taken as its vertices. The format follows from the
    /// extension, for standard input from the first bytes.
    #[arg(value_name = "POINTS")]
    pub input: Option<PathBuf>,

    /// Mesh to write; `-` for standard output.
    ///
    /// The format follows from the extension. The file appears whole or not
    /// at all: an older file of that name stays until the new one is complete.
    #[arg(short, long, value_name = "MESH", help_heading = FILES)]
    pub output: Option<PathBuf>,

    /// Format of the input, whatever its name.
    #[arg(long, value_name = "FORMAT", help_heading = FILES)]
    pub input_format: Option<String>,

    /// Format of the mesh, whatever its name.
    #[arg(long, value_name = "FORMAT", help_heading = FILES)]
    pub output_format: Option<String>,

    /// Write PLY as text.
    #[arg(long, help_heading = FILES)]
    pub ascii: bool,

    /// Round coordinates to 32 bits, and make sure of the surface on those.
    ///
    /// PLY then has 32-bit coordinates; STL and GLB always do.
    #[arg(long, help_heading = FILES)]
    pub f32: bool,

    /// Significant digits of reals in text formats, 1 to 17.
    ///
    /// By default as many as it takes to read the same number back.
    #[arg(long, value_name = "DIGITS", value_parser = clap::value_parser!(u8).range(1..=17), help_heading = FILES)]
    pub precision: Option<u8>,

    /// Drop points that are NaN or infinite instead of refusing the input.
    #[arg(long, help_heading = FILES)]
    pub skip_invalid: bool,

    /// Ignore poles of samples whose Voronoi cell is too fat: auto, off, or
    /// 0 < L <= 1.
    ///
    /// L is your estimate of how densely the surface is sampled, as the
    /// distance between samples over the distance to the medial axis. Helps
    /// with noise and sharp edges. `auto` takes 0.4 for samples amid noise of
    /// more than twice their spacing, and keeps every pole of the others;
    /// `off` keeps every pole. By default auto; -v tells what was taken.
    #[arg(long, value_name = "L", value_parser = wanted::lambda, allow_hyphen_values = true, help_heading = METHOD)]
    pub lambda: Option<LambdaOption>,

    /// Extend faces to sharp edges and corners, for machine parts.
    ///
    /// Plain --sharp drops both poles of samples whose cell is too fat, as the
    /// paper does, with --lambda 0.4 unless you say otherwise. `--sharp auto`
    /// looks for samples whose neighbours lie on two or three planes that meet
    /// there, and gives them other poles: it needs no lambda, bears a little
    /// noise and leaves smooth surfaces as they are.
    #[arg(long, value_name = "HOW", value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "skinny", help_heading = METHOD)]
    pub sharp: Option<Sharp>,

    /// What to take for noise: auto, off, or its standard deviation in the
    /// input's unit.
    ///
    /// Samples amid noise are moved onto a smooth surface fitted to those
    /// around them before anything else. `auto` measures noise and moves
    /// nothing where it is less than a twentieth of the spacing between
    /// samples: clean input comes out as with `off`. By default auto.
    #[arg(long, value_name = "NOISE", value_parser = wanted::noise, allow_hyphen_values = true, help_heading = METHOD)]
    pub noise: Option<NoiseOption>,

    /// What to do with samples that lie on no surface: auto, keep.
    ///
    /// `auto` leaves out samples alone or in small or sparse groups away from
    /// every surface, and, where there are such, those that stand off a surface
    /// by far more than their neighbours. How many is said, and
    /// --report-outliers tells which. `keep` keeps every sample. By default
    /// auto, but keep where the input is a mesh, whose vertices lie on its
    /// surface.
    #[arg(long, value_name = "WHAT", value_parser = wanted::outliers, help_heading = METHOD)]
    pub outliers: Option<OutlierOption>,

    /// Where the scanner stood, in the input's unit: what it saw is outside.
    ///
    /// Evidence for which side of a sample is outside, instead of normals in
    /// the input. Believed if the surface found without it agrees with four
    /// fifths of it, or with a fifth at most: then the scanner stood in a room
    /// or a hollow, and what it saw is inside.
    #[arg(long, value_name = "X,Y,Z", value_parser = wanted::place, allow_hyphen_values = true, help_heading = METHOD)]
    pub sensor: Option<Point>,

    /// Whether normals of the input say which side is outside: auto, ignore.
    ///
    /// `auto` takes them as evidence where the surface found without them
    /// agrees with four fifths of them, or of them turned around; so does the
    /// viewpoint of PCD files without normals. `ignore` only carries them to
    /// the mesh. By default auto; -v tells how they agree.
    #[arg(long, value_name = "HOW", value_enum, hide_possible_values = true, help_heading = METHOD)]
    pub normals: Option<Normals>,

    /// How far to work on the labels inner and outer: greedy, refined.
    ///
    /// `greedy` leaves them as the paper's queue gives them; `refined` flips
    /// those that the evidence is against, and asks winding numbers amid noise. By
    /// default refined.
    #[arg(long, value_name = "HOW", value_parser = wanted::label, help_heading = METHOD)]
    pub label: Option<LabelOption>,

    #[arg(long, help = deep_angle_help(), value_name = "DEG", value_parser = real, allow_hyphen_values = true, help_heading = METHOD)]
    pub deep_angle: Option<f64>,

    #[arg(long, help = box_factor_help(), value_name = "X", value_parser = real, allow_hyphen_values = true, help_heading = METHOD)]
    pub box_factor: Option<f64>,

    #[arg(long, help = merge_help(), value_name = "X", value_parser = real, allow_hyphen_values = true, help_heading = METHOD)]
    pub merge: Option<f64>,

    #[arg(long, help = flatness_help(), value_name = "X", value_parser = real, allow_hyphen_values = true, help_heading = METHOD)]
    pub flatness: Option<f64>,

    /// Whether the surface must pass through every sample: yes, no.
    ///
    /// At edges the poles of a sample can leave it off the surface; `yes`
    /// adds balls that bring it back. By default that is done unless more
    /// than 5 % of the samples are off, which is taken for noise, and not
    /// with plain --sharp. `yes` also keeps the coordinates of samples in planes
    /// to the last bit; else they may leave them by 2^-42 of the size.
    #[arg(long, value_name = "WHETHER", value_parser = yes_or_no, help_heading = METHOD)]
    pub interpolate: Option<bool>,

    /// Write triangles (this is the default).
    #[arg(long, overrides_with = "polygons", help_heading = METHOD)]
    pub triangulate: bool,

    /// Write the polygons of the power diagram instead of triangles.
    #[arg(long, overrides_with = "triangulate", help_heading = METHOD)]
    pub polygons: bool,

    /// Keep the largest parts only: `largest`, a number of parts, or `all`.
    ///
    /// The size of a part is the volume its outer shell encloses; cavities go
    /// with the part they are in.
    #[arg(long, value_name = "WHICH", value_parser = wanted::keep, help_heading = SURFACE)]
    pub keep: Option<Keep>,

    /// Drop parts and fill cavities smaller than this: a volume in the cube of
    /// the input's unit, or a share of the total such as 1%.
    #[arg(long, value_name = "V", value_parser = wanted::min_volume, allow_hyphen_values = true, help_heading = SURFACE)]
    pub min_volume: Option<MinVolume>,

    /// Fill all cavities, with what lies in them.
    #[arg(long, help_heading = SURFACE)]
    pub drop_cavities: bool,

    /// What becomes of places where nothing was sampled: `keep` bridges them
    /// (the default), `open` leaves them out, `fill` bridges them as flat as
    /// their border allows.
    ///
    /// With `open` the mesh is manifold and oriented, and has a border. Every
    /// loop of it is told by -v, --stats and --json with its length and area.
    /// Scans of one side, terrain and rooms, which bound no solid, come out as
    /// what was seen. With `fill` vertices that are no samples move onto a
    /// membrane across the border; where its faces would cross others they stop on
    /// the way, and the summary says so.
    #[arg(long, value_name = "HOW", value_enum, help_heading = SURFACE)]
    pub holes: Option<Holes>,

    /// How wide a gap must be to be a hole: a length in the input's unit, a
    /// share of the diagonal such as 1%, or a multiple of the spacing of the
    /// samples around such as 10x; by default 5x.
    ///
    /// The width is the diameter of the largest disc on the surface that no
    /// sample touches. Gaps below 3.5 spacings are none whatever is said. The
    /// attribute `hole` marks the faces.
    #[arg(long, value_name = "SIZE", value_parser = wanted::hole_width, allow_hyphen_values = true, help_heading = SURFACE)]
    pub hole_size: Option<HoleWidth>,

    /// Reduce the mesh to so many triangles.
    ///
    /// Vertices that stay are where they were; those whose loss moves the
    /// surface least go first. The mesh stays closed, manifold and free of
    /// crossings; where that allows no further step, the run ends with more
    /// triangles than asked for and says so.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..), conflicts_with_all = ["polygons", "reduce"], help_heading = SURFACE)]
    pub faces: Option<u32>,

    /// Reduce the mesh to one R-th of its triangles, R > 1: see --faces.
    #[arg(long, value_name = "R", value_parser = wanted::reduce, conflicts_with = "polygons", help_heading = SURFACE)]
    pub reduce: Option<f64>,

    /// Values to write with the mesh: `all`, `none`, or names between commas.
    ///
    /// Names: sample (the input point at each vertex, -1 for none), normals,
    /// colours, columns of the input; and of faces thickness, gap (how thick
    /// the solid and the space before it are), polar_radii (the sum of the
    /// radii of the two polar balls), doubt (the share of the evidence that
    /// the labels of the two balls go against, 0 to 1), component (0 the
    /// largest part), hole (1 where nothing was sampled). By default sample, hole and what the input
    /// has. Vertices that are no input points are blended from those next to
    /// them. PLY and JSON hold all of it, OBJ, OFF and GLB normals and colours,
    /// STL nothing.
    #[arg(long, value_name = "LIST", value_parser = Wanted::parse, help_heading = SURFACE)]
    pub attributes: Option<Wanted>,

    /// Write the inner medial axis.
    ///
    /// Without `-o`, and where nothing is to be told of the mesh (`--json`, `--stats`,
    /// `--verify`), no surface is made, which takes half the time.
    #[arg(long, value_name = "FILE", help_heading = EXTRA)]
    pub mat: Option<PathBuf>,

    /// Write the outer medial axis.
    #[arg(long, value_name = "FILE", help_heading = EXTRA)]
    pub outer_mat: Option<PathBuf>,

    /// Collapse the flat tetrahedra of the medial axes.
    ///
    /// What is left has balls, edges and triangles, and the same parts,
    /// tunnels and voids.
    #[arg(long, help_heading = EXTRA)]
    pub thin: bool,

    /// Write all polar balls with radius and side, as PLY.
    #[arg(long, value_name = "FILE", help_heading = EXTRA)]
    pub poles: Option<PathBuf>,

    /// Write the samples left out by --outliers, as PLY, with the number of
    /// each in the input and why: reason 0 floating, 1 beside the surface.
    #[arg(long, value_name = "FILE", help_heading = EXTRA)]
    pub report_outliers: Option<PathBuf>,

    /// Write the poles dropped by --lambda and --sharp, as PLY: where each
    /// lies, its sample's number in the input (point), 1 or 2 for the first
    /// or second pole of it (pole), its distance from the sample (radius), the
    /// bound that is held against (bound), and why: reason 0 nearer than the
    /// bound, 1 the other pole of the sample is, 2 the sample lies at an edge
    /// (--sharp auto).
    #[arg(long, value_name = "FILE", help_heading = EXTRA)]
    pub report_poles: Option<PathBuf>,

    /// Write counts, timings and options as JSON; `-` for standard output.
    #[arg(long, value_name = "FILE", help_heading = EXTRA)]
    pub stats: Option<PathBuf>,

    /// Judge the mesh as it will be written, crossing faces included; if
    /// anything is wrong, say what, write nothing and exit with 1.
    ///
    /// That it is closed and manifold is always looked at. `powercrust check`
    /// judges files.
    #[arg(long, help_heading = REPORTING)]
    pub verify: bool,

    /// Read the points, say how much memory and time the run would take, and
    /// do no more.
    #[arg(long, help_heading = REPORTING)]
    pub dry_run: bool,

    /// Refuse to start (exit code 1) where the run is likely to need more
    /// memory than this: 800M, 2G. By default what the machine has.
    #[arg(long, value_name = "SIZE", value_parser = wanted::size, help_heading = REPORTING)]
    pub max_memory: Option<u64>,

    #[command(flatten)]
    pub reporting: Reporting,
}

/// What commands that make something have in common.
#[derive(Clone, Debug, Default, Args)]
pub struct Reporting {
    /// Print a summary of the run as one JSON object on standard output,
    /// errors included.
    #[arg(long, help_heading = REPORTING)]
    pub json: bool,

    /// Threads to use, by default all, at most 256. The result does not depend
    /// on it.
    #[arg(long, value_name = "N", help_heading = REPORTING)]
    pub threads: Option<NonZeroUsize>,

    /// Print nothing but errors.
    #[arg(short, long, conflicts_with = "verbose", help_heading = REPORTING)]
    pub quiet: bool,

    /// Say more: -v options in effect and times, -vv everything counted.
    #[arg(short, long, action = ArgAction::Count, help_heading = REPORTING)]
    pub verbose: u8,
}

#[derive(Debug, Args)]
pub struct Check {
    /// Mesh to read; `-` for standard input.
    #[arg(value_name = "MESH")]
    pub mesh: PathBuf,

    /// Format of the mesh, whatever its name.
    #[arg(long, value_name = "FORMAT")]
    pub input_format: Option<String>,

    /// Allow a border: edges with one face are no fault.
    #[arg(long)]
    pub border: bool,

    /// Print the findings as one JSON object on standard output.
    #[arg(long)]
    pub json: bool,

    /// Threads to use, by default all.
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,

    /// Print nothing; only the exit code tells.
    #[arg(short, long, conflicts_with = "json")]
    pub quiet: bool,
}

/// `powercrust offset`.
#[derive(Debug, Args)]
pub struct Offset {
    /// Points to read; `-` for standard input.
    #[arg(value_name = "POINTS")]
    pub input: PathBuf,

    /// Distances between commas, positive outside, negative inside: lengths in
    /// the unit of the points, or shares of the diagonal of their box such as
    /// 1%. By default 0, which --shell needs no more than.
    #[arg(long, value_name = "LIST", value_parser = wanted::distances, allow_hyphen_values = true)]
    pub distance: Option<Distances>,

    /// Make a wall of this thickness instead of a full solid: from the surface
    /// at each distance inward. A length or a share of the diagonal, above 0.
    #[arg(long, value_name = "T", value_parser = wanted::distance, allow_hyphen_values = true)]
    pub shell: Option<Distance>,

    /// Mesh to write; `-` for standard output.
    ///
    /// `{d}` stands for the distance as it was given; with several distances
    /// it must be there. All files appear, or none.
    #[arg(short, long, value_name = "MESH")]
    pub output: PathBuf,

    /// How far faces may lie off the exact distance from the crust between
    /// their vertices: a length, or a share of the diagonal, above 0. Larger
    /// ones give fewer triangles. By default 0.01%, or what the crust itself is
    /// off a smooth surface, if that is more.
    #[arg(long, value_name = "X", value_parser = wanted::distance, allow_hyphen_values = true)]
    pub tolerance: Option<Distance>,

    /// Leave the faces as the power diagram has them, as the paper does.
    ///
    /// By default vertices are moved to the exact distance from the crust, and
    /// faces that are off it are cut.
    #[arg(long, conflicts_with = "tolerance")]
    pub plain: bool,

    /// Format of the input, whatever its name.
    #[arg(long, value_name = "FORMAT", help_heading = FILES)]
    pub input_format: Option<String>,

    /// Format of the meshes, whatever their names.
    #[arg(long, value_name = "FORMAT", help_heading = FILES)]
    pub output_format: Option<String>,

    /// Write PLY and STL as text.
    #[arg(long, help_heading = FILES)]
    pub ascii: bool,

    /// Round coordinates to 32 bits, and make sure of the surfaces on those.
    #[arg(long, help_heading = FILES)]
    pub f32: bool,

    /// Drop points that are NaN or infinite instead of refusing the input.
    #[arg(long, help_heading = FILES)]
    pub skip_invalid: bool,

    /// Ignore poles of samples whose Voronoi cell is too fat: auto, off, or
    /// 0 < L <= 1.
    #[arg(long, value_name = "L", value_parser = wanted::lambda, allow_hyphen_values = true, help_heading = METHOD)]
    pub lambda: Option<LambdaOption>,

    /// Extend faces to sharp edges and corners, for machine parts: as the
    /// paper does, or `--sharp auto`.
    #[arg(long, value_name = "HOW", value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "skinny", help_heading = METHOD)]
    pub sharp: Option<Sharp>,

    /// Size of the frame over that of the points' box: 2 to 100, by default
    /// what the largest distance needs, at least 5.
    #[arg(long, value_name = "X", value_parser = real, allow_hyphen_values = true, help_heading = METHOD)]
    pub box_factor: Option<f64>,

    #[arg(long, help = merge_help(), value_name = "X", value_parser = real, allow_hyphen_values = true, help_heading = METHOD)]
    pub merge: Option<f64>,

    /// Refuse to start (exit code 1) where the reconstruction is likely to
    /// need more memory than this: 800M, 2G. By default what the machine has.
    #[arg(long, value_name = "SIZE", value_parser = wanted::size, help_heading = REPORTING)]
    pub max_memory: Option<u64>,

    #[command(flatten)]
    pub reporting: Reporting,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Generate {
    /// A man page in roff.
    Man,
    /// Completions for bash.
    CompleteBash,
    /// Completions for zsh.
    CompleteZsh,
    /// Completions for fish.
    CompleteFish,
}

// The library's defaults are stated from the library, not a second time here.

fn deep_angle_help() -> String {
    let default = Options::default().deep_angle;
    format!("Angle above which two balls are taken to be on one side: 90 < DEG < 180, by default {default:.2}")
}

fn box_factor_help() -> String {
    let default = Options::default().box_factor;
    format!("Size of the frame over that of the points' box: 2 to 100, by default {default}")
}

fn merge_help() -> String {
    let default = Options::default().merge;
    format!("Merge balls when the surface moves by less than this share of the sampling error: 0 to 1, by default {default}")
}

fn flatness_help() -> String {
    let default = Options::default().flatness;
    format!("Drop vertices that are no samples when the surface moves by less than this share of the sampling error: 0 to 10, by default {default}")
}

fn yes_or_no(text: &str) -> Result<bool, String> {
    match text {
        "yes" => Ok(true),
        "no" => Ok(false),
        _ => Err("expected yes or no".to_owned()),
    }
}

/// Reads a finite number. (clap's own reading of negative numbers refuses
/// `-1e-3` and `-.5`, hence `allow_hyphen_values` above.)
pub fn real(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err("expected a number".to_owned()),
    }
}
