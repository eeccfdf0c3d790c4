//! The front of a text file: delimiter, comments, names of columns, a count.

use super::super::columns;
use super::super::error::ReadError;
use super::super::scan::{self, Lines, Words};

#[derive(Clone, Copy, PartialEq)]
pub enum Delimiter {
    Blank,
    Byte(u8),
}

impl Delimiter {
    pub fn of(line: &[u8]) -> Delimiter {
        match [b';', b','].into_iter().find(|d| line.contains(d)) {
            Some(d) => Delimiter::Byte(d),
            None => Delimiter::Blank,
        }
    }

    /// The fields of a line with their offsets, without blanks and quotes.
    pub fn fields(self, line: &[u8]) -> Fields<'_> {
        Fields {
            line,
            at: 0,
            delimiter: self,
        }
    }
}

/// See [`Delimiter::fields`].
#[derive(Clone)]
pub struct Fields<'a> {
    line: &'a [u8],
    at: usize,
    delimiter: Delimiter,
}

impl<'a> Iterator for Fields<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<(usize, &'a [u8])> {
        let rest = self.line.get(self.at..)?;
        let start = self.at;
        match self.delimiter {
            Delimiter::Blank => {
                let (at, word) = Words::new(rest).next()?;
                self.at += at + word.len();
                Some((start + at, unquoted(word)))
            }
            Delimiter::Byte(d) => {
                let end = rest.iter().position(|&b| b == d);
                let field = &rest[..end.unwrap_or(rest.len())];
                self.at += field.len() + 1;
                Some((start, unquoted(field.trim_ascii())))
            }
        }
    }
}

pub fn unquoted(field: &[u8]) -> &[u8] {
    let quoted = |q: u8| field.strip_prefix(&[q])?.strip_suffix(&[q]);
    quoted(b'"').or_else(|| quoted(b'\'')).unwrap_or(field)
}

/// Whether a word starts a comment.
#[inline]
pub fn is_comment(word: &[u8]) -> bool {
    matches!(word.first(), Some(b'#' | b'%' | b';' | b'!')) || word.starts_with(b"//")
}

/// What the lines before the first point say.
#[derive(Default)]
pub struct Preamble {
    pub count: Option<u64>,
    pub names: Option<(u64, Vec<String>)>,
    /// Names in a comment: used only if they fit the columns.
    pub commented: Option<Vec<String>>,
    pub passed_over: usize,
}

/// Reads comments, names and a count, up to the first line of data.
pub fn first_data<'a>(
    lines: &mut Lines<'a>,
    preamble: &mut Preamble,
) -> Result<Option<(u64, &'a [u8])>, ReadError> {
    for (number, line) in lines {
        let first = scan::first_word(line);
        if first.is_empty() {
            continue;
        }
        if is_comment(first) {
            preamble.passed_over += 1;
            let text = line.trim_ascii_start();
            let start = text.iter().position(|b| !b"#%;!/ \t".contains(b));
            let text = &text[start.unwrap_or(text.len())..];
            let names = names_of(Delimiter::of(text), text);
            if position_columns(&names).is_ok_and(|found| found.is_some()) {
                preamble.commented = Some(names);
            }
            continue;
        }
        let fields: Vec<_> = Delimiter::of(line).fields(line).collect();
        let numeric = |f: &&(usize, &[u8])| scan::number(f.1).is_some();
        let numbers = fields.iter().filter(numeric).count();
        let whole = |f: &[u8]| f.iter().all(u8::is_ascii_digit) && !f.is_empty();
        if fields.len() == 1 && whole(fields[0].1) && preamble.count.is_none() {
            preamble.count = scan::integer(fields[0].1).map(|n| n.unsigned_abs());
            preamble.passed_over += 1;
        } else if numbers == 0 && !decimal_commas(line) && preamble.names.is_none() {
            let names = names_of(Delimiter::of(line), line);
            preamble.names = Some((number, names));
            preamble.passed_over += 1;
        } else {
            return Ok(Some((number, line)));
        }
    }
    Ok(None)
}

pub fn names_of(delimiter: Delimiter, line: &[u8]) -> Vec<String> {
    let fields = delimiter.fields(line).take(columns::MOST + 1);
    let name = |(_, f): (usize, &[u8])| String::from_utf8_lossy(f).trim().to_string();
    let mut names: Vec<String> = fields.map(name).collect();
    while names.last().is_some_and(|n| n.is_empty()) {
        names.pop();
    }
    names
}

/// The columns named x, y and z: `Ok(None)` if none is, an error (the letter)
/// if one is missing or named twice.
pub fn position_columns(names: &[String]) -> Result<Option<[usize; 3]>, &'static str> {
    let find = |letter: &'static str, other: &str| {
        // `X (m)`, `x[mm]`: without the unit.
        let bare = |n: &str| n.split(['(', '[']).next().unwrap_or(n).trim().to_string();
        let known = |n: &str| bare(n).eq_ignore_ascii_case(letter) || n.eq_ignore_ascii_case(other);
        let mut found = (0..names.len()).filter(|&i| known(&names[i]));
        (found.next(), found.next().is_some(), letter)
    };
    let all = [
        find("x", "Points:0"),
        find("y", "Points:1"),
        find("z", "Points:2"),
    ];
    if all.iter().all(|f| f.0.is_none()) {
        return Ok(None);
    }
    if let Some(&(_, _, letter)) = all.iter().find(|f| f.1 || f.0.is_none()) {
        return Err(letter);
    }
    Ok(Some(all.map(|f| f.0.unwrap_or(0))))
}

/// Whether a line of data seems to be written with decimal commas.
pub fn decimal_commas(line: &[u8]) -> bool {
    if line.contains(&b';') {
        let mut fields = line.split(|&b| b == b';');
        return fields.any(|f| scan::decimal_comma(f.trim_ascii()));
    }
    let words: Vec<&[u8]> = Words::new(line).map(|(_, w)| w).take(16).collect();
    if words.len() < 3 {
        return false;
    }
    let stripped = |w: &&[u8]| scan::decimal_comma(w.strip_suffix(b",").unwrap_or(w));
    words.iter().all(stripped)
        || words.iter().any(|w| scan::decimal_comma(w))
            && words
                .iter()
                .all(|w| !w.ends_with(b",") && !w.starts_with(b","))
}
