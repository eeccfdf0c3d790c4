//! Points as lines of numbers: XYZ, TXT, CSV, PTS, ASC, PWN, XYZN.
//!
//! There is no standard, so the reader looks: at the first line for the
//! delimiter (semicolon, comma or blank) and for names or a count, at the
//! columns for their meaning ([`super::columns`]). What it finds then holds
//! for the whole file: a line that disagrees is an error, not a guess.

mod preamble;

use super::cloud::{Cloud, Parts, ReadOptions};
use super::columns::{self, Table};
use super::error::{Place, ReadError};
use super::format::CloudFormat;
use super::scan::{self, Lines, Words};
use super::sink::check_count;
use preamble::{decimal_commas, first_data, is_comment, position_columns, Delimiter, Preamble};
use std::collections::BTreeMap;

/// How the lines of this file are to be read.
struct Layout {
    delimiter: Delimiter,
    columns: usize,
    /// For each column 0, 1, 2 for x, y, z, and 3 for others.
    targets: Vec<u8>,
    /// Points are the lines that begin with the letter `p` or `v`.
    letters: bool,
    /// The line that set the number of columns.
    model: u64,
}

struct Reader {
    layout: Layout,
    table: Table,
    /// The sum of the count lines.
    announced: Option<u64>,
    first_invalid: Option<u64>,
    passed_over: usize,
    letters: BTreeMap<String, usize>,
}

pub fn read_cloud(bytes: &[u8], options: &ReadOptions) -> Result<Cloud, ReadError> {
    let text = scan::without_bom(bytes);
    if let Some(at) = text.iter().take(4096).position(|&b| b == 0) {
        return Err(ReadError::Malformed {
            place: Place::Byte(at as u64),
            what: "a zero byte: this is binary data, not text".into(),
        });
    }
    let mut lines = Lines::new(text);
    let mut preamble = Preamble::default();
    let nothing = ReadError::Nothing {
        what: "points",
        format: "text",
    };
    let Some((number, line)) = first_data(&mut lines, &mut preamble)? else {
        return Err(match preamble.count.filter(|&n| n > 0) {
            Some(expected) => cut(expected, 0),
            None => nothing,
        });
    };
    let mut parts = Parts::new(CloudFormat::Text);
    let mut reader = Reader::new(preamble, number, line, &mut parts)?;
    reader.line(number, line)?;
    for (number, line) in lines {
        reader.line(number, line)?;
    }
    check_count("points", reader.table.points.len() as u64)?;
    reader.finish(&mut parts)?;
    let invalid = reader.first_invalid;
    columns::assign(reader.table, &mut parts);
    parts.report.records_passed_over = reader.passed_over;
    parts.finish(options, "points", |_| Place::Line(invalid.unwrap_or(0)))
}

fn cut(expected: u64, found: u64) -> ReadError {
    ReadError::Truncated {
        what: "points".into(),
        expected,
        found,
    }
}

impl Reader {
    /// Settles the layout by the first line of data.
    fn new(
        preamble: Preamble,
        number: u64,
        line: &[u8],
        parts: &mut Parts,
    ) -> Result<Reader, ReadError> {
        if decimal_commas(line) {
            let comma = line.iter().position(|&b| b == b',').unwrap_or(0);
            let mut words = Words::new(line);
            let word = words.find(|(at, w)| *at <= comma && comma < at + w.len());
            let (at, word) = word.unwrap_or((0, line));
            let word = word.split(|&b| b == b';').find(|w| w.contains(&b','));
            return Err(ReadError::DecimalComma {
                place: scan::column(number, at),
                token: scan::shown(word.unwrap_or(line)),
            });
        }
        let first = scan::first_word(line);
        let letters = first.len() == 1 && first[0].is_ascii_alphabetic();
        let delimiter = Delimiter::of(line);
        let words = delimiter.fields(line).take_while(|(_, w)| !is_comment(w));
        let mut fields: Vec<&[u8]> = words.map(|(_, w)| w).collect();
        let most = fields.len();
        while fields.last().is_some_and(|w| w.is_empty()) {
            fields.pop();
        }
        let mut count = fields.len();
        if letters {
            // How many columns the points have is not known yet.
            count = 0;
        }
        let mut names = None;
        let mut model = number;
        if let Some((at, found)) = preamble.names.filter(|_| !letters) {
            // Values may be missing at the end, their delimiters not.
            if !(count..=most).contains(&found.len()) {
                return Err(ReadError::Columns {
                    line: number,
                    found: count,
                    expected: format!("line {at} names {} columns", found.len()),
                });
            }
            count = found.len();
            model = at;
            names = Some(found);
        }
        names = names.or(preamble.commented.filter(|c| c.len() == count));
        let mut xyz = [0, 1, 2];
        if let Some(names) = &names {
            xyz = match position_columns(names) {
                Ok(Some(found)) => found,
                Ok(None) => {
                    parts.report.notes.push(format!(
                        "No column is named x, y or z: the first three ({}) are taken.",
                        names[..names.len().min(3)].join(", ")
                    ));
                    [0, 1, 2]
                }
                Err(letter) => {
                    return Err(ReadError::Malformed {
                        place: Place::Line(model),
                        what: format!("the header must name one column {letter}, not none or two"),
                    });
                }
            };
        }
        let mut reader = Reader {
            layout: Layout {
                delimiter,
                columns: 0,
                targets: Vec::new(),
                letters,
                model,
            },
            table: Table::new(3),
            announced: preamble.count,
            first_invalid: None,
            passed_over: preamble.passed_over,
            letters: BTreeMap::new(),
        };
        if !letters {
            reader.settle(number, count, xyz, names)?;
        }
        Ok(reader)
    }

    /// Fixes the number of columns and which of them are x, y, z.
    fn settle(
        &mut self,
        line: u64,
        count: usize,
        xyz: [usize; 3],
        names: Option<Vec<String>>,
    ) -> Result<(), ReadError> {
        if !(3..=columns::MOST).contains(&count) {
            return Err(ReadError::Columns {
                line,
                found: count,
                expected: format!("a point has at least 3 (and at most {})", columns::MOST),
            });
        }
        self.layout.columns = count;
        self.layout.targets = vec![3; count];
        for (k, &c) in xyz.iter().enumerate() {
            self.layout.targets[c] = k as u8;
        }
        let mut table = Table::new(count);
        let others = || (0..count).filter(|c| !xyz.contains(c));
        table.numbers = others().map(|c| c + 1).collect();
        table.names = names.map(|n| others().map(|c| n[c].clone()).collect());
        table.intensity = self.announced.is_some() && matches!(count, 4 | 7);
        self.table = table;
        Ok(())
    }

    /// Takes one line.
    #[inline]
    fn line(&mut self, number: u64, line: &[u8]) -> Result<(), ReadError> {
        let mut start = 0;
        if self.layout.letters {
            let Some((at, letter)) = Words::new(line).next() else {
                return Ok(());
            };
            if !self.is_point(number, at, letter)? {
                return Ok(());
            }
            start = at + letter.len();
            if self.layout.columns == 0 {
                let count = Words::new(&line[start..])
                    .take_while(|(_, w)| !is_comment(w))
                    .count();
                self.layout.delimiter = Delimiter::Blank;
                self.layout.model = number;
                self.settle(number, count, [0, 1, 2], None)?;
            }
        }
        match self.layout.delimiter {
            Delimiter::Blank => {
                let words = Words::new(&line[start..]).map(|(at, w)| (at + start, w));
                self.fields(number, words)
            }
            Delimiter::Byte(_) if scan::first_word(line).is_empty() => Ok(()),
            delimiter => self.fields(number, delimiter.fields(line)),
        }
    }

    /// In a file of lettered records: whether this is a point.
    fn is_point(&mut self, number: u64, at: usize, letter: &[u8]) -> Result<bool, ReadError> {
        if matches!(letter, b"p" | b"v" | b"P" | b"V") {
            return Ok(true);
        }
        if !is_comment(letter) {
            if !letter[0].is_ascii_alphabetic() {
                return Err(scan::not_a(
                    "a record letter as on the lines before",
                    scan::column(number, at),
                    letter,
                ));
            }
            let letter = scan::shown(letter);
            if self.letters.len() < 32 || self.letters.contains_key(&letter) {
                *self.letters.entry(letter).or_default() += 1;
            }
        }
        self.passed_over += 1;
        Ok(false)
    }

    /// Takes the fields of one point.
    #[inline]
    fn fields<'a>(
        &mut self,
        number: u64,
        fields: impl Iterator<Item = (usize, &'a [u8])>,
    ) -> Result<(), ReadError> {
        let mut point = [0.0; 3];
        let mut count = 0;
        let mut others = 0;
        let mut single = None;
        for (at, word) in fields {
            if is_comment(word) {
                break;
            }
            if count == 0 {
                single = Some(word);
            }
            let Some(&target) = self.layout.targets.get(count) else {
                // A delimiter at the end of a line does no harm.
                count += usize::from(!word.is_empty());
                continue;
            };
            let value = match scan::number(word) {
                Some(value) => value,
                None if word.is_empty() && target == 3 => f64::NAN,
                None => return Err(scan::not_a("a number", scan::column(number, at), word)),
            };
            if target < 3 {
                point[usize::from(target)] = value;
            } else {
                self.table.extra[others].push(value);
                others += 1;
            }
            count += 1;
        }
        if count == self.layout.columns {
            if !point.iter().all(|c| c.is_finite()) && self.first_invalid.is_none() {
                self.first_invalid = Some(number);
            }
            self.table.points.push(point);
            return Ok(());
        }
        if count == 0 {
            // A comment or a blank line.
            self.passed_over += usize::from(single.is_some());
            return Ok(());
        }
        self.odd_line(number, count, single)
    }

    /// A line of another number of columns: the count before the next block
    /// of a PTS file, or an error.
    #[cold]
    fn odd_line(
        &mut self,
        number: u64,
        count: usize,
        single: Option<&[u8]>,
    ) -> Result<(), ReadError> {
        let points = self.table.points.len();
        if let (1, Some(announced), Some(word)) = (count, self.announced, single) {
            let next = scan::integer(word).filter(|&n| n >= 0);
            if let Some(next) = next.filter(|_| announced == points as u64) {
                self.announced = Some(announced.saturating_add(next as u64));
                for column in &mut self.table.extra {
                    column.truncate(points);
                }
                self.passed_over += 1;
                return Ok(());
            }
        }
        Err(ReadError::Columns {
            line: number,
            found: count,
            expected: format!("line {} has {}", self.layout.model, self.layout.columns),
        })
    }

    /// Compares the points with their count; says what was passed over.
    fn finish(&mut self, parts: &mut Parts) -> Result<(), ReadError> {
        if !self.letters.is_empty() {
            let list = self.letters.iter().map(|(l, n)| format!("{l} ({n})"));
            let list: Vec<String> = list.collect();
            parts.report.notes.push(format!(
                "Lines that begin with another letter than p or v are no points: {}.",
                list.join(", ")
            ));
        }
        let Some(announced) = self.announced else {
            return Ok(());
        };
        let found = self.table.points.len() as u64;
        if found < announced {
            return Err(cut(announced, found));
        }
        if found == announced {
            return Ok(());
        }
        let unit = |p: &[f64; 3]| (crate::geom::vec3::norm(*p) - 1.0).abs() < 0.01;
        let half = announced as usize;
        if found == 2 * announced
            && self.table.extra.is_empty()
            && self.table.points[half..].iter().all(unit)
        {
            let normals = self.table.points.split_off(half);
            let normals = normals.into_iter().map(|n| n.map(|c| c as f32));
            parts.normals = Some(normals.collect());
            parts.report.notes.push(
                "The second half of the lines are vectors of length 1: the normals of the first half.".into(),
            );
        } else {
            parts.report.notes.push(format!(
                "The first line announces {announced} points, but there are {found}: all are taken."
            ));
        }
        Ok(())
    }
}
