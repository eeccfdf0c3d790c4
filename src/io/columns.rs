//! What the columns of a table mean: positions, normals, colours, numbers.

use super::cloud::{colours_of, Parts, ScalarColumn};
use crate::geom::Point;

/// The most columns a table may have: more is surely no table of points.
pub const MOST: usize = 1024;

/// Rows of numbers, the positions told apart from the other columns.
pub struct Table {
    /// One position for each row.
    pub points: Vec<Point>,
    /// The other columns, each with one number for each row.
    pub extra: Vec<Vec<f64>>,
    /// The names of the other columns, where the file names them.
    pub names: Option<Vec<String>>,
    /// The number of each of the other columns in the file, from 1.
    pub numbers: Vec<usize>,
    /// Whether an unnamed fourth column is an intensity, as in PTS files.
    pub intensity: bool,
}

impl Table {
    /// A table of so many columns, the first three being x, y, z.
    pub fn new(columns: usize) -> Table {
        Table {
            points: Vec::new(),
            extra: vec![Vec::new(); columns.saturating_sub(3)],
            names: None,
            numbers: (4..=columns).collect(),
            intensity: false,
        }
    }

    fn triples(&self, at: usize) -> impl Iterator<Item = [f64; 3]> + '_ {
        let column = |k: usize| self.extra[at + k].iter().copied();
        let pairs = column(0).zip(column(1));
        pairs.zip(column(2)).map(|((x, y), z)| [x, y, z])
    }

    /// Whether three columns are vectors of length 1, but for one row in a
    /// hundred.
    fn unit(&self, at: usize) -> bool {
        let (mut seen, mut off) = (0usize, 0usize);
        for v in self.triples(at) {
            let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
            if length.is_finite() {
                seen += 1;
                off += usize::from((length - 1.0).abs() > 0.01);
            }
        }
        seen > 0 && off * 100 <= seen
    }

    /// Whether three columns hold nothing but integers from 0 to 255.
    fn bytes(&self, at: usize) -> bool {
        let byte = |v: f64| (0.0..=255.0).contains(&v) && v.fract() == 0.0;
        !self.points.is_empty() && self.triples(at).all(|v| v.into_iter().all(byte))
    }
}

/// What runs of columns are.
enum Role {
    Normal(usize),
    Colour(usize, Option<usize>),
    Scalar(usize),
}

/// Hands the columns over as what they are. By their names where they have
/// some; else, from left to right: three that are of length 1 are normals,
/// three that are integers from 0 to 255 are colours, all else stays numbers.
pub fn assign(mut table: Table, parts: &mut Parts) {
    let roles = match &table.names {
        Some(names) => by_name(names),
        None => by_look(&table),
    };
    for role in roles {
        match role {
            Role::Normal(at) => {
                let normals = table.triples(at).map(|v| v.map(|c| c as f32));
                parts.normals = Some(normals.collect());
            }
            Role::Colour(at, alpha) => {
                let alphas = alpha.map(|a| &table.extra[a]);
                let colour = |(i, [r, g, b]): (usize, [f64; 3])| {
                    [r, g, b, alphas.map_or(f64::INFINITY, |a| a[i])].map(|c| c as f32)
                };
                let colours: Vec<_> = table.triples(at).enumerate().map(colour).collect();
                // Without names only bytes are taken for colours.
                let bytes = table.names.is_none();
                parts.colours = Some(if bytes {
                    let byte = |c: [f32; 4]| c.map(|v| v.min(255.0) as u8);
                    colours.into_iter().map(byte).collect()
                } else {
                    colours_of(&colours, alpha.is_some())
                });
            }
            Role::Scalar(at) => {
                let name = match &table.names {
                    Some(names) => names[at].clone(),
                    None if at == 0 && table.intensity => "intensity".into(),
                    None => format!("column {}", table.numbers[at]),
                };
                parts.scalars.push(ScalarColumn {
                    name,
                    values: std::mem::take(&mut table.extra[at]),
                });
            }
        }
    }
    if table.names.is_none() && table.extra.len() == 3 && parts.scalars.len() == 3 {
        parts.report.notes.push(
            "The last three of six columns are neither normals of length 1 nor colours from 0 to 255: they are kept as numbers."
                .into(),
        );
    }
    parts.points = table.points;
}

fn by_name(names: &[String]) -> Vec<Role> {
    let is = |at: usize, known: [&str; 3]| {
        names
            .get(at)
            .is_some_and(|n| known.iter().any(|k| n.eq_ignore_ascii_case(k)))
    };
    let mut roles = Vec::new();
    let mut at = 0;
    while at < names.len() {
        let normal = is(at, ["nx", "normal_x", "normalx"])
            && is(at + 1, ["ny", "normal_y", "normaly"])
            && is(at + 2, ["nz", "normal_z", "normalz"]);
        let colour = is(at, ["r", "red", "diffuse_red"])
            && is(at + 1, ["g", "green", "diffuse_green"])
            && is(at + 2, ["b", "blue", "diffuse_blue"]);
        if normal {
            roles.push(Role::Normal(at));
            at += 3;
        } else if colour {
            let alpha = is(at + 3, ["a", "alpha", "diffuse_alpha"]);
            roles.push(Role::Colour(at, alpha.then_some(at + 3)));
            at += 3 + usize::from(alpha);
        } else {
            roles.push(Role::Scalar(at));
            at += 1;
        }
    }
    roles
}

fn by_look(table: &Table) -> Vec<Role> {
    let mut roles = Vec::new();
    let (mut normals, mut colours) = (false, false);
    let mut at = 0;
    while at < table.extra.len() {
        let three = at + 3 <= table.extra.len() && !(table.intensity && at == 0);
        if three && !normals && table.unit(at) {
            normals = true;
            roles.push(Role::Normal(at));
            at += 3;
        } else if three && !colours && table.bytes(at) {
            colours = true;
            roles.push(Role::Colour(at, None));
            at += 3;
        } else {
            roles.push(Role::Scalar(at));
            at += 1;
        }
    }
    roles
}
