//! What can go wrong with a file: every error names a place and a remedy.

use std::fmt;

/// Where in a file something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of a text file, counting from 1.
    Line(u64),
    /// A byte of a line of a text file, both counting from 1.
    Column {
        /// The line.
        line: u64,
        /// The byte within the line.
        column: u64,
    },
    /// A record (vertex, triangle, row) of a binary file, counting from 0.
    Record(u64),
    /// A byte of a binary file, counting from 0.
    Byte(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line(line) => write!(f, "line {line}"),
            Place::Column { line, column } => write!(f, "line {line}, column {column}"),
            Place::Record(index) => write!(f, "record {index} (counting from 0)"),
            Place::Byte(offset) => write!(f, "byte {offset}"),
        }
    }
}

/// Why a file cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// No bytes at all.
    #[error("the file is empty (0 bytes)")]
    Empty,
    /// A well-formed file in which there is nothing to use.
    #[error("no {what} in this {format} file")]
    Nothing {
        /// What was looked for: `vertices`, `triangles`, `points`, `faces`.
        what: &'static str,
        /// The format's name.
        format: &'static str,
    },
    /// Every point has a coordinate that is NaN or infinite.
    #[error("all {points} points have coordinates that are NaN or infinite: nothing is left")]
    NothingFinite {
        /// Points in the file.
        points: usize,
    },
    /// Something else where a number should be.
    #[error("{place}: expected {expected}, found `{token}`")]
    NotANumber {
        /// Where.
        place: Place,
        /// What should be there.
        expected: &'static str,
        /// What is there, cut to 40 characters.
        token: String,
    },
    /// A coordinate is NaN or infinite.
    #[error("{place}: the point ({}, {}, {}) is not finite: correct it, or let such points be dropped (--skip-invalid)", point[0], point[1], point[2])]
    NotFinite {
        /// The first such point.
        place: Place,
        /// Its coordinates.
        point: [f64; 3],
    },
    /// The numbers seem to have decimal commas.
    #[error("{place}: `{token}` looks like a number with a decimal comma: write decimal points")]
    DecimalComma {
        /// Where.
        place: Place,
        /// What is there.
        token: String,
    },
    /// A line has too few or too many values.
    #[error("line {line}: {found} values where {expected}")]
    Columns {
        /// The line, counting from 1.
        line: u64,
        /// Values found.
        found: usize,
        /// How many there should be and why, in words.
        expected: String,
    },
    /// The file ends before the records it announces.
    #[error("truncated: {expected} {what} announced, {found} found: the file was cut off or its header is wrong")]
    Truncated {
        /// What is missing: `vertices`, `faces`, `triangles`, `points`.
        what: String,
        /// How many the file announces.
        expected: u64,
        /// How many are there (or could be, by the bytes that are there).
        found: u64,
    },
    /// A face, edge or triangle names a vertex that does not exist.
    #[error("{place}: index {index}, but there are {count} {what} ({range})")]
    Index {
        /// Where.
        place: Place,
        /// The index as written.
        index: i64,
        /// How many there are.
        count: u64,
        /// Of what: `vertices`, `balls`.
        what: &'static str,
        /// The legal range, in words.
        range: &'static str,
    },
    /// The file breaks its format's rules.
    #[error("{place}: {what}")]
    Malformed {
        /// Where.
        place: Place,
        /// What is wrong, in words.
        what: String,
    },
    /// A needed part is missing.
    #[error("no {what}")]
    Missing {
        /// The part and where it should be, in words.
        what: String,
    },
    /// A legal file of a kind this reader does not know.
    #[error("{what} cannot be read: {remedy}")]
    Unsupported {
        /// The kind.
        what: String,
        /// What to do instead.
        remedy: &'static str,
    },
    /// More than 32-bit indices can name.
    #[error("{count} {what}: at most {limit} are supported")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many.
        count: u64,
        /// The limit.
        limit: u64,
    },
}

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The writer failed.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// An attribute does not have one value for each vertex or face.
    #[error("attribute {name} has {found} values, expected {expected}")]
    Length {
        /// The attribute.
        name: String,
        /// One for each vertex or face.
        expected: usize,
        /// What it has.
        found: usize,
    },
    /// The mesh or shape contradicts itself (an index out of range, say).
    #[error("inconsistent {what}")]
    Inconsistent {
        /// What and where, in words.
        what: String,
    },
    /// The format cannot hold this.
    #[error("{format} cannot hold {what}: {remedy}")]
    Unsupported {
        /// The format's name.
        format: &'static str,
        /// What does not fit.
        what: String,
        /// What to do instead.
        remedy: &'static str,
    },
}
