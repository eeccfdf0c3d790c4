//! What was said to `powercrust simplify-mat`, recorded and not yet judged.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use powercrust::LambdaOption;

use super::args::{real, Reporting};
use super::wanted::{self, length, Length};

pub const EXAMPLES: &str = "\
Examples:
  powercrust simplify-mat axis.ma --eps 0.01 -o simple.ma
                                     without what samples that may be off by
                                     0.01 can make or unmake
  powercrust simplify-mat points.ply --eps 1% --delta 0.2% -o simple.ply --thin
                                     from points, without flat tetrahedra
  powercrust simplify-mat points.ply --balls 200 --structure -o parts.ply
                                     200 balls, with numbered sheets
  powercrust simplify-mat axis.ma --eps 1% --no-keep-topology -o simple.ma
                                     even where tunnels close";

const FILES: &str = "Input and output";
const WHAT: &str = "What goes";
const POINTS: &str = "Where the input is points";

/// The unstable length taken where nothing is said, in hundredths of the
/// diagonal.
pub const EPS_PERCENT: f64 = 1.0;

/// The redundant length taken where nothing is said, as a share of the
/// unstable one: 'usually less', says the paper.
pub const DELTA_OF_EPS: f64 = 0.25;

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum WhichSide {
    /// The balls in the solid.
    Inner,
    /// The balls around it.
    Outer,
}

#[derive(Debug, Args)]
pub struct SimplifyMat {
    /// A medial axis (.ma, .ply, .json) or points; `-` for standard input.
    ///
    /// Of points the medial axis is made first, as `powercrust --mat` does. A
    /// PLY file is an axis if its vertices have a radius.
    #[arg(value_name = "INPUT")]
    pub input: PathBuf,

    /// Medial axis to write, as .ma, .ply, .obj or .json; `-` for standard
    /// output.
    #[arg(short, long, value_name = "FILE", help_heading = FILES)]
    pub output: Option<PathBuf>,

    /// Format of the input, whatever its name: ma, or any of points.
    #[arg(long, value_name = "FORMAT", help_heading = FILES)]
    pub input_format: Option<String>,

    /// Format of the axis, whatever its name: ma, ply, obj, json.
    #[arg(long, value_name = "FORMAT", help_heading = FILES)]
    pub output_format: Option<String>,

    /// Which axis to write, if the input has both. A file is taken as what it
    /// says it is.
    #[arg(long, value_enum, value_name = "SIDE", default_value = "inner", help_heading = FILES)]
    pub side: WhichSide,

    /// Collapse the flat tetrahedra of the axis written.
    #[arg(long, help_heading = FILES)]
    pub thin: bool,

    /// Number the sheets, seams, junctions and rims of the thin axis: in PLY
    /// and JSON files and with --json. Implies --thin.
    #[arg(long, help_heading = FILES)]
    pub structure: bool,

    /// Write the curve skeleton: edges only, with the same parts and tunnels.
    /// Sheets that enclose a void stay.
    #[arg(long, conflicts_with = "structure", help_heading = FILES)]
    pub skeleton: bool,

    /// Write balls, edges and triangles only, for programs that know no more.
    ///
    /// Otherwise the file also says what the samples on each ball span and
    /// holds the balls of the other side: with those it can be simplified
    /// again.
    #[arg(long, help_heading = FILES)]
    pub bare: bool,

    /// Write PLY as text.
    #[arg(long, help_heading = FILES)]
    pub ascii: bool,

    /// Significant digits of reals in text formats, 1 to 17.
    #[arg(long, value_name = "DIGITS", value_parser = clap::value_parser!(u8).range(1..=17), help_heading = FILES)]
    pub precision: Option<u8>,

    /// Take out unstable balls: those whose touching samples are all within
    /// this length of each other.
    ///
    /// Your estimate of how far samples may be off: a length in the input's
    /// unit, or a share of the diagonal of its box such as 1%. By default 1%,
    /// if nothing else is said.
    #[arg(long, value_name = "E", value_parser = length, allow_hyphen_values = true, help_heading = WHAT)]
    pub eps: Option<Length>,

    /// Take out redundant balls: those contained in a larger one that is grown
    /// by this length.
    ///
    /// A length, or a share of the diagonal such as 0.2%; 0 for none. By
    /// default a quarter of E.
    #[arg(long, value_name = "D", value_parser = length, allow_hyphen_values = true, help_heading = WHAT)]
    pub delta: Option<Length>,

    /// Lambda-medial axis: take out balls whose samples fit into a ball of less
    /// than this radius. A length, or a share of the diagonal.
    #[arg(long, value_name = "L", value_parser = length, allow_hyphen_values = true, help_heading = WHAT)]
    pub lambda_medial: Option<Length>,

    /// Take out balls whose samples are seen from the centre under less than
    /// this angle: 0 to 180 degrees.
    #[arg(long, value_name = "DEG", value_parser = real, allow_hyphen_values = true, help_heading = WHAT)]
    pub angle: Option<f64>,

    /// Scale axis: take out balls that the others cover when all are grown by
    /// this factor, 1 to 10.
    #[arg(long, value_name = "S", value_parser = real, allow_hyphen_values = true, help_heading = WHAT)]
    pub scale: Option<f64>,

    /// Take out balls that fail both conditions of Dey and Zhao: an angle of 0
    /// to 90 degrees and a number of sample spacings; by default 22.5,8.
    ///
    /// The second needs points, or a file that says how they are spaced.
    #[arg(long, value_name = "DEG,RATIO", num_args = 0..=1, require_equals = true, default_missing_value = "22.5,8", value_parser = two, help_heading = WHAT)]
    pub dey_zhao: Option<[f64; 2]>,

    /// Keep at most so many balls: those that stand for the others best. Where
    /// the input is points they are then moved to fit the samples.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), help_heading = WHAT)]
    pub balls: Option<u32>,

    /// Refuse what would change the parts, tunnels and voids of the axis
    /// (this is the default).
    #[arg(long, overrides_with = "no_keep_topology", help_heading = WHAT)]
    pub keep_topology: bool,

    /// Take balls out even where parts, tunnels or voids come or go.
    #[arg(long, overrides_with = "keep_topology", help_heading = WHAT)]
    pub no_keep_topology: bool,

    /// Ignore poles of samples whose Voronoi cell is too fat: see powercrust
    /// --help.
    #[arg(long, value_name = "L", value_parser = wanted::lambda, allow_hyphen_values = true, help_heading = POINTS)]
    pub lambda: Option<LambdaOption>,

    /// Drop points that are NaN or infinite instead of refusing the input.
    #[arg(long, help_heading = POINTS)]
    pub skip_invalid: bool,

    #[command(flatten)]
    pub reporting: Reporting,
}

/// Reads two numbers with a comma between.
fn two(text: &str) -> Result<[f64; 2], String> {
    let wrong = || "expected an angle and a ratio such as 22.5,8".to_owned();
    let (first, second) = text.split_once(',').ok_or_else(wrong)?;
    match (real(first.trim()), real(second.trim())) {
        (Ok(first), Ok(second)) => Ok([first, second]),
        _ => Err(wrong()),
    }
}
