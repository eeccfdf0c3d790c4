//! What was said to `powercrust query`, recorded and not yet judged.

use std::path::PathBuf;

use clap::Args;

use powercrust::LambdaOption;

use super::args::Reporting;
use super::wanted;

pub const EXAMPLES: &str = "\
Examples:
  powercrust query points.ply --at places.xyz -o values.csv
                                     inside or outside, how far, how thick
  powercrust query axis.ma --at places.ply -o values.ply
                                     the same of an axis that is there";

const FILES: &str = "Input and output";
const POINTS: &str = "Where the input is points";

#[derive(Debug, Args)]
pub struct Query {
    /// A medial axis (.ma, .ply, .json) or points; `-` for standard input.
    ///
    /// Of points the medial axis is made first, as `powercrust --mat` does.
    #[arg(value_name = "INPUT")]
    pub input: PathBuf,

    /// Points at which to ask, in any format of points; `-` for standard input.
    #[arg(long, value_name = "PLACES", help_heading = FILES)]
    pub at: PathBuf,

    /// Table to write, as .csv or .ply; `-` for CSV on standard output.
    ///
    /// For each place in turn: side (0 inner, 1 outer), distance from the
    /// surface (negative inside; an estimate), the bounds lower and upper on it,
    /// thickness (the diameter of the nearest inner ball), ball (the nearest one by power
    /// distance, by its number in the axis file or in --poles; -1 for none) and
    /// inner_ball. Lengths are in the unit of the input.
    #[arg(short, long, value_name = "FILE", help_heading = FILES)]
    pub output: Option<PathBuf>,

    /// Format of the input, whatever its name: ma, or any of points.
    #[arg(long, value_name = "FORMAT", help_heading = FILES)]
    pub input_format: Option<String>,

    /// Format of the table, whatever its name: csv, ply.
    #[arg(long, value_name = "FORMAT", help_heading = FILES)]
    pub output_format: Option<String>,

    /// Write PLY as text.
    #[arg(long, help_heading = FILES)]
    pub ascii: bool,

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
