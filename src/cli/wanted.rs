//! What the user says in words that are no plain numbers: which values the
//! mesh carries, which parts it keeps, sizes with units.

use powercrust::holes::{HoleSize, GROWN};
use powercrust::io::MeshFormat;
use powercrust::surface::{Keep, MinVolume};
use powercrust::{LabelOption, LambdaOption, NoiseOption, OutlierOption, Point, SharpOption};

/// The names of `--attributes` that are not columns of the input.
pub const OWN: [&str; 9] = [
    "sample",
    "normals",
    "colours",
    "thickness",
    "gap",
    "polar_radii",
    "doubt",
    "component",
    "hole",
];

/// Which values go into the mesh file.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Wanted {
    /// What the input had, and the samples.
    #[default]
    Given,
    /// Everything there is.
    All,
    /// None.
    Bare,
    /// These.
    List(Vec<String>),
}

impl Wanted {
    /// Reads `all`, `none` or names between commas.
    pub fn parse(text: &str) -> Result<Wanted, String> {
        match text {
            "all" => Ok(Wanted::All),
            "none" => Ok(Wanted::Bare),
            _ => {
                let names: Vec<String> = text.split(',').map(|n| n.trim().to_owned()).collect();
                match names.iter().any(String::is_empty) {
                    true => Err("expected all, none or names between commas".to_owned()),
                    false => Ok(Wanted::List(names)),
                }
            }
        }
    }

    /// Whether a value is named.
    pub fn names(&self, name: &str) -> bool {
        matches!(self, Wanted::List(names) if names.iter().any(|n| n == name))
    }

    /// Whether a value is wanted; `given` tells if it is so by default.
    pub fn wants(&self, name: &str, given: bool) -> bool {
        match self {
            Wanted::Given => given,
            Wanted::All => true,
            Wanted::Bare => false,
            Wanted::List(_) => self.names(name),
        }
    }

    /// A value named that files of this format cannot hold.
    pub fn beyond(&self, format: MeshFormat) -> Option<&str> {
        let Wanted::List(names) = self else {
            return None;
        };
        let holds = |name: &str| match format {
            MeshFormat::Stl => false,
            MeshFormat::Obj | MeshFormat::Off | MeshFormat::Glb => {
                matches!(name, "normals" | "colours")
            }
            _ => true,
        };
        names.iter().map(String::as_str).find(|name| !holds(name))
    }
}

/// Reads `all`, `largest` or a number of parts.
pub fn keep(text: &str) -> Result<Keep, String> {
    match text {
        "all" => Ok(Keep::All),
        "largest" => Ok(Keep::Largest(1)),
        _ => match text.parse::<usize>() {
            Ok(count) if count > 0 => Ok(Keep::Largest(count)),
            _ => Err("expected all, largest or a number of parts".to_owned()),
        },
    }
}

/// Reads a volume, or a share of the total with `%`.
pub fn min_volume(text: &str) -> Result<MinVolume, String> {
    let (number, share) = match text.strip_suffix('%') {
        Some(number) => (number, true),
        None => (text, false),
    };
    match number.trim().parse::<f64>() {
        Ok(v) if share && (0.0..=100.0).contains(&v) => Ok(MinVolume::Share(v / 100.0)),
        Ok(v) if !share && v >= 0.0 && v.is_finite() => Ok(MinVolume::Absolute(v)),
        _ => Err("expected a volume, or a share of the total such as 1%".to_owned()),
    }
}

/// A length, in the input's unit or as a share of the diagonal of its box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// In the unit of the input.
    Absolute(f64),
    /// In hundredths of the diagonal.
    Percent(f64),
}

impl Length {
    /// The length in the unit of an input of this diagonal.
    pub fn of(self, diagonal: f64) -> f64 {
        match self {
            Length::Absolute(length) => length,
            Length::Percent(percent) => percent / 100.0 * diagonal,
        }
    }
}

/// Reads a length of at least 0, or a share of the diagonal with `%`.
pub fn length(text: &str) -> Result<Length, String> {
    let (number, share) = match text.strip_suffix('%') {
        Some(number) => (number, true),
        None => (text, false),
    };
    match number.trim().parse::<f64>() {
        Ok(v) if v >= 0.0 && v.is_finite() && share => Ok(Length::Percent(v)),
        Ok(v) if v >= 0.0 && v.is_finite() => Ok(Length::Absolute(v)),
        _ => Err("expected a length, or a share of the diagonal such as 1%".to_owned()),
    }
}

/// What becomes of places where nothing was sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Holes {
    /// They are bridged: the mesh is closed.
    #[default]
    Keep,
    /// They are left out: the mesh has a border.
    Open,
    /// They are bridged, and the bridges drawn taut, as flat as their border
    /// allows.
    Fill,
}

/// What tells samples at sharp edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Sharp {
    /// Their cell is too fat, as in the paper; needs lambda.
    Skinny,
    /// Their neighbours lie on two or three planes that meet there.
    Auto,
}

impl From<Sharp> for SharpOption {
    fn from(said: Sharp) -> SharpOption {
        match said {
            Sharp::Skinny => SharpOption::Skinny,
            Sharp::Auto => SharpOption::Auto,
        }
    }
}

/// From which width on a gap is a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HoleWidth {
    /// In spacings of the samples around.
    Spacings(f64),
    /// In the input's unit, or a share of the diagonal.
    Length(Length),
}

impl HoleWidth {
    /// The size, of an input of this diagonal.
    pub fn of(self, diagonal: f64) -> HoleSize {
        match self {
            HoleWidth::Spacings(spacings) => HoleSize::Spacings(spacings),
            HoleWidth::Length(length) => HoleSize::Length(length.of(diagonal)),
        }
    }
}

/// Reads a width: a length, a share of the diagonal with `%`, or a multiple of
/// the sample spacing with `x`.
pub fn hole_width(text: &str) -> Result<HoleWidth, String> {
    let wrong = "expected a length above 0, a share of the diagonal such as 1%, or a multiple of the spacing such as 10x, at least 3.5x";
    let width = match text.strip_suffix('x') {
        Some(number) => match number.trim().parse::<f64>() {
            Ok(v) if v >= GROWN && v.is_finite() => Some(HoleWidth::Spacings(v)),
            _ => None,
        },
        None => match length(text) {
            Ok(Length::Absolute(v) | Length::Percent(v)) if v <= 0.0 => None,
            other => other.ok().map(HoleWidth::Length),
        },
    };
    width.ok_or_else(|| wrong.to_owned())
}

/// A length of either sign in the unit of the points, or a share of the diagonal of their
/// box, with the words it was given in.
#[derive(Clone, Debug, PartialEq)]
pub struct Distance {
    pub said: String,
    value: f64,
    share: bool,
}

impl Distance {
    /// The length, where the diagonal is so long.
    pub fn of(&self, diagonal: f64) -> f64 {
        match self.share {
            true => self.value * diagonal,
            false => self.value,
        }
    }

    pub fn is_positive(&self) -> bool {
        self.value > 0.0
    }
}

/// Several lengths.
#[derive(Clone, Debug, PartialEq)]
pub struct Distances(pub Vec<Distance>);

/// Reads a length, or a share of the diagonal with `%`.
pub fn distance(text: &str) -> Result<Distance, String> {
    let said = text.trim();
    let (number, share) = match said.strip_suffix('%') {
        Some(number) => (number, true),
        None => (said, false),
    };
    match number.trim().parse::<f64>() {
        Ok(v) if v.is_finite() => Ok(Distance {
            said: said.to_owned(),
            value: if share { v / 100.0 } else { v },
            share,
        }),
        _ => Err("expected a length, or a share of the diagonal such as 1%".to_owned()),
    }
}

/// Reads lengths between commas.
pub fn distances(text: &str) -> Result<Distances, String> {
    text.split(',')
        .map(distance)
        .collect::<Result<_, _>>()
        .map(Distances)
}

/// Reads `auto`, `off` or a length.
pub fn noise(text: &str) -> Result<NoiseOption, String> {
    match text {
        "auto" => Ok(NoiseOption::Auto),
        "off" => Ok(NoiseOption::Off),
        _ => match text.parse::<f64>() {
            Ok(scale) if scale > 0.0 && scale.is_finite() => Ok(NoiseOption::Scale(scale)),
            _ => Err("expected auto, off or a length above 0".to_owned()),
        },
    }
}

/// Reads `auto`, `off` or a number, which is looked at later.
pub fn lambda(text: &str) -> Result<LambdaOption, String> {
    match text {
        "auto" => Ok(LambdaOption::Auto),
        "off" => Ok(LambdaOption::Off),
        _ => match text.parse::<f64>() {
            Ok(lambda) if lambda.is_finite() => Ok(LambdaOption::Value(lambda)),
            _ => Err("expected auto, off or a number in (0, 1]".to_owned()),
        },
    }
}

/// Reads a place: three numbers between commas.
pub fn place(text: &str) -> Result<Point, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map_while(|w| w.trim().parse().ok())
        .collect();
    let place = <[f64; 3]>::try_from(numbers).ok();
    place
        .filter(|p| text.matches(',').count() == 2 && p.iter().all(|c| c.is_finite()))
        .ok_or_else(|| "expected three numbers between commas, such as 0,0,1.5".to_owned())
}

/// Whether the normals of the input are asked which side is which.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Normals {
    /// Where they agree with the surface, mostly.
    #[default]
    Auto,
    /// They are carried to the vertices, no more.
    Ignore,
}

/// Reads `greedy` or `refined`.
pub fn label(text: &str) -> Result<LabelOption, String> {
    match text {
        "greedy" => Ok(LabelOption::Greedy),
        "refined" => Ok(LabelOption::Refined),
        _ => Err("expected greedy or refined".to_owned()),
    }
}

/// Reads `auto` or `keep`.
pub fn outliers(text: &str) -> Result<OutlierOption, String> {
    match text {
        "auto" => Ok(OutlierOption::Auto),
        "keep" => Ok(OutlierOption::Keep),
        _ => Err("expected auto or keep".to_owned()),
    }
}

/// Reads a factor above 1.
pub fn reduce(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(factor) if factor > 1.0 && factor.is_finite() => Ok(factor),
        _ => Err("expected a number above 1".to_owned()),
    }
}

/// How many triangles to reduce to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fewer {
    /// So many.
    Faces(usize),
    /// One in so many.
    OneIn(f64),
}

impl Fewer {
    /// The number, of a mesh of so many triangles.
    pub fn of(self, faces: usize) -> usize {
        match self {
            Fewer::Faces(n) => n,
            Fewer::OneIn(factor) => ((faces as f64 / factor) as usize).max(4),
        }
    }
}

/// Reads a number of bytes with a unit of 1024: `800M`, `2G`, `1.5GiB`.
pub fn size(text: &str) -> Result<u64, String> {
    let at = text
        .find(|c: char| c.is_ascii_alphabetic())
        .unwrap_or(text.len());
    let (number, unit) = text.split_at(at);
    let power = match unit.to_ascii_lowercase().as_str() {
        "" | "b" => Some(0),
        "k" | "kb" | "kib" => Some(1),
        "m" | "mb" | "mib" => Some(2),
        "g" | "gb" | "gib" => Some(3),
        "t" | "tb" | "tib" => Some(4),
        _ => None,
    };
    match (number.trim().parse::<f64>(), power) {
        (Ok(n), Some(power)) if n > 0.0 && n.is_finite() => Ok((n * 1024f64.powi(power)) as u64),
        _ => Err("expected a size such as 800M or 2G".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read() {
        assert_eq!(Wanted::parse("all"), Ok(Wanted::All));
        assert!(Wanted::parse("hole, sample").unwrap().names("sample"));
        assert!(Wanted::parse("hole,").is_err());
        let list = Wanted::parse("normals,hole").unwrap();
        assert_eq!(list.beyond(MeshFormat::Obj), Some("hole"));
        assert_eq!(list.beyond(MeshFormat::Ply), None);
        assert_eq!(keep("largest"), Ok(Keep::Largest(1)));
        assert_eq!(keep("3"), Ok(Keep::Largest(3)));
        assert!(keep("0").is_err() && keep("some").is_err());
        assert_eq!(min_volume("1%"), Ok(MinVolume::Share(0.01)));
        assert_eq!(min_volume("2.5"), Ok(MinVolume::Absolute(2.5)));
        assert_eq!(noise("auto"), Ok(NoiseOption::Auto));
        assert_eq!(noise("0.5"), Ok(NoiseOption::Scale(0.5)));
        assert!(noise("0").is_err() && noise("-1").is_err() && noise("some").is_err());
        assert!(min_volume("-1").is_err() && min_volume("101%").is_err());
        assert_eq!(length("0.5"), Ok(Length::Absolute(0.5)));
        assert_eq!(length("2%").map(|l| l.of(50.0)), Ok(1.0));
        assert!(length("-1").is_err() && length("x%").is_err() && length("inf").is_err());
        assert_eq!(hole_width("10x"), Ok(HoleWidth::Spacings(10.0)));
        assert_eq!(
            hole_width("2%").map(|w| w.of(50.0)),
            Ok(HoleSize::Length(1.0))
        );
        assert_eq!(
            hole_width("0.5").map(|w| w.of(50.0)),
            Ok(HoleSize::Length(0.5))
        );
        assert_eq!(place("0, -1,2.5"), Ok([0.0, -1.0, 2.5]));
        assert!(place("0,1").is_err() && place("0,1,x").is_err() && place("0,1,2,3").is_err());
        assert!(place("0,1,nan").is_err() && place("0,1,2,x").is_err());
        assert!(hole_width("3x").is_err() && hole_width("0").is_err() && hole_width("x").is_err());
        let list = distances("0.5,-1%, 2").unwrap().0;
        let found: Vec<f64> = list.iter().map(|l| l.of(10.0)).collect();
        assert_eq!(found, [0.5, -0.1, 2.0]);
        assert_eq!(list[1].said, "-1%");
        assert!(distances("1,").is_err() && distance("inf").is_err());
        assert_eq!(size("2G"), Ok(2 << 30));
        assert_eq!(size("1.5k"), Ok(1536));
        assert_eq!(size("100"), Ok(100));
        assert!(size("2X").is_err() && size("-1G").is_err() && size("").is_err());
    }
}
