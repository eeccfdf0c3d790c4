//! What was said to `powercrust from-mat`, recorded and not yet judged.

use std::path::PathBuf;

use clap::Args;

use super::args::Reporting;
use super::wanted::{distance, Distance, Wanted};

pub const EXAMPLES: &str = "\
Examples:
  powercrust from-mat axis.ma -o crust.ply
                                     the surface that an axis stands for
  powercrust from-mat balls.ma --union -o union.ply
                                     the surface of the union of its balls
  powercrust from-mat simple.ma -o crust.ply --compare original.ply -v
                                     and how far it is from another mesh";

const FILES: &str = "Input and output";

#[derive(Debug, Args)]
pub struct FromMat {
    /// Balls: a medial axis (.ma, .ply, .json) or poles (.ply); `-` for standard
    /// input.
    ///
    /// Where the file has balls of both sides, as those of this program have,
    /// the surface lies between them. Where it has inner ones only, outer ones
    /// are made from the complement of their union.
    #[arg(value_name = "AXIS")]
    pub input: PathBuf,

    /// Mesh to write; `-` for standard output.
    ///
    /// It is closed, manifold, outward and free of crossings, or nothing is
    /// written and the exit code is 1.
    #[arg(short, long, value_name = "MESH", help_heading = FILES)]
    pub output: Option<PathBuf>,

    /// Make the surface of the union of the inner balls, fitted to them up to
    /// the tolerance, with creases where balls meet.
    #[arg(long)]
    pub union: bool,

    /// How far faces may move to lose a vertex and, with --union, how far they
    /// should be off the union: a length, or a share of the diagonal of the
    /// inner balls, above 0. By default 0.02%. What they are is said.
    #[arg(long, value_name = "X", value_parser = distance, allow_hyphen_values = true)]
    pub tolerance: Option<Distance>,

    /// Say how far the surface is from this mesh, both ways.
    #[arg(long, value_name = "MESH")]
    pub compare: Option<PathBuf>,

    /// Values to write with the faces: thickness (the diameter of the inner
    /// ball), gap (that of the outer one, -1 for none), `all` or `none` (the
    /// default).
    #[arg(long, value_name = "LIST", value_parser = Wanted::parse, help_heading = FILES)]
    pub attributes: Option<Wanted>,

    /// Format of the input, whatever its name: ma, ply, json.
    #[arg(long, value_name = "FORMAT", help_heading = FILES)]
    pub input_format: Option<String>,

    /// Format of the mesh, whatever its name.
    #[arg(long, value_name = "FORMAT", help_heading = FILES)]
    pub output_format: Option<String>,

    /// Write PLY and STL as text.
    #[arg(long, help_heading = FILES)]
    pub ascii: bool,

    /// Round coordinates to 32 bits, and make sure of the surface on those.
    #[arg(long, help_heading = FILES)]
    pub f32: bool,

    /// Significant digits of reals in text formats, 1 to 17.
    #[arg(long, value_name = "DIGITS", value_parser = clap::value_parser!(u8).range(1..=17), help_heading = FILES)]
    pub precision: Option<u8>,

    /// Write what `--json` prints into a file.
    #[arg(long, value_name = "FILE", help_heading = FILES)]
    pub stats: Option<PathBuf>,

    #[command(flatten)]
    pub reporting: Reporting,
}
