//! Planes that meet beside a sample.

use super::{Corner, Foot};
use crate::geom::vec3::{add, cross, dist_sq, dot, norm, norm_sq, scale, sub};
use crate::geom::Point;
use crate::noise::fit::Fit;
use crate::noise::level::{quantile, spacing};
use crate::noise::near::Near;
use crate::noise::plane::Plane;

/// Samples looked at around each.
const AROUND: usize = 24;

/// Samples that make a plane to try.
const WINDOW: usize = 8;

/// A quadric that misses by less than this share of the spacing fits.
const FITS: f64 = 0.04;

/// Planes must miss by less than this share of what the quadric misses.
const BETTER: f64 = 0.7;

/// A sample is on a plane when it is off by less than this share of the
/// spacing, or this many times what a good plane around misses.
const ON: f64 = 0.15;
const ON_NOISE: f64 = 2.5;

/// A plane around is good that misses by less than all but this share: at an
/// edge most windows reach across it.
const GOOD: f64 = 0.3;

/// The least angle between two planes, in degrees.
const ANGLE: f64 = 25.0;

/// The fewest samples on a plane.
const FEWEST: usize = 4;

/// The largest share of samples on none.
const LOOSE: f64 = 0.25;

/// How far from an edge samples count as beside it, and how far from its foot
/// on the edge the nearest sample of either plane may be, in spacings.
const BESIDE: f64 = 1.5;
const SUPPORT: f64 = 1.3;

/// The largest ball, in spacings: farther away the samples say nothing of the
/// plane, and a larger one would hardly be flatter.
const LARGEST: f64 = 8.0;

/// The least ball worth having, in spacings. Smaller ones stand on samples
/// as near to the edge as noise may put them on the wrong plane: the surface
/// gets tiny handles.
const LEAST: f64 = 0.2;

/// The plane through the samples nearest to one.
pub(super) fn window(near: &Near, s: usize) -> Option<Plane> {
    let found = near.nearest(near.places[s], WINDOW);
    let here: Vec<Point> = found.iter().map(|n| near.places[n.1 as usize]).collect();
    Plane::through(&here)
}

/// What is asked of samples.
pub(super) struct Around<'a> {
    /// All samples.
    pub near: &'a Near<'a>,
    /// The plane through those nearest to each.
    pub windows: Vec<Option<Plane>>,
    /// Whether samples amid noise were moved.
    pub treated: bool,
    /// A radius no ball may pass, for the lattice has an end.
    pub most: f64,
}

impl Around<'_> {
    /// The sample as one at an edge, if it is.
    pub fn corner(&self, s: usize) -> Option<Corner> {
        let at = self.near.places[s];
        let found = self.near.nearest(at, AROUND);
        if found.len() < AROUND {
            return None;
        }
        let half = AROUND / 2;
        let spacing = spacing(found[half - 1].0.sqrt(), half);
        let places: Vec<Point> = (found.iter().map(|n| self.near.places[n.1 as usize])).collect();
        let ids: Vec<u32> = found.iter().map(|n| n.1).collect();
        let sheets = self.sheets(at, &places, &ids, spacing)?;
        let (own, others) = sheets.split_first()?;
        let feet: Vec<Foot> = (others.iter())
            .filter_map(|other| foot(at, own, other, &places, spacing))
            .collect();
        if feet.is_empty() {
            return None;
        }
        let normal = own.plane.normal;
        let at = match self.treated {
            true => sub(at, scale(normal, own.plane.height(at))),
            false => at,
        };
        // Samples on these planes are no obstacles: noise may have put them there.
        let on_planes: Vec<u32> = (sheets.iter().flat_map(|s| &s.on))
            .map(|&k| ids[k])
            .collect();
        let radii = [1.0, -1.0].map(|way| {
            let way = scale(normal, way);
            let most = (others.iter())
                .filter_map(|other| within(at, way, other, &places))
                .fold(self.most.min(LARGEST * spacing), f64::min);
            empty(self.near, at, way, most, &on_planes)
        });
        Some(Corner {
            sample: s as u32,
            at,
            normal,
            radii: (radii.iter().all(|&r| r >= LEAST * spacing)).then_some(radii),
            feet,
            spacing,
        })
    }

    /// The planes the samples around one are on, if these are two or three and
    /// fit much better than a quadric; its own is the first.
    fn sheets(&self, at: Point, places: &[Point], ids: &[u32], spacing: f64) -> Option<Vec<Sheet>> {
        let offsets: Vec<Point> = places.iter().map(|&p| sub(p, at)).collect();
        let reach = norm(*offsets.last()?);
        let quadric = Fit::of(at, &offsets, &[1.0; AROUND], reach)?.residual(AROUND);
        if quadric < FITS * spacing {
            return None;
        }
        let tries: Vec<Plane> = (ids.iter().filter_map(|&s| self.windows[s as usize])).collect();
        let mut misses: Vec<f64> = tries.iter().map(|p| p.missed).collect();
        let on = (ON * spacing).max(ON_NOISE * quantile(&mut misses, GOOD));
        let sheets = cover(at, places, &tries, on)?;
        let nearest = |&p: &Point| {
            let heights = sheets.iter().map(|s| s.plane.height(p).abs());
            heights.fold(f64::INFINITY, f64::min)
        };
        let squares: f64 = places.iter().map(|p| nearest(p).powi(2)).sum();
        // Three numbers were fitted for each plane.
        let missed = (squares / (AROUND - 3 * sheets.len()) as f64).sqrt();
        (missed <= BETTER * quadric).then_some(sheets)
    }
}

/// A plane and which samples are on it, of those around.
struct Sheet {
    plane: Plane,
    on: Vec<usize>,
}

/// Two or three planes on which nearly all samples are, the first of them
/// through `at`: each the one that most of those left are on.
fn cover(at: Point, places: &[Point], tries: &[Plane], on: f64) -> Option<Vec<Sheet>> {
    let mut left: Vec<usize> = (0..places.len()).collect();
    let mut sheets: Vec<Sheet> = Vec::new();
    let alike = ANGLE.to_radians().cos();
    while sheets.len() < 3 && !left.is_empty() {
        let fits = |p: &&Plane| {
            let mut cosines = sheets.iter().map(|s| dot(s.plane.normal, p.normal).abs());
            cosines.all(|c| c <= alike) && (!sheets.is_empty() || p.height(at).abs() <= on)
        };
        let Some(plane) = fullest(places, &left, tries.iter().filter(fits), on) else {
            break;
        };
        let (here, others) = (left.iter()).partition(|&&k| plane.height(places[k]).abs() <= on);
        left = others;
        sheets.push(Sheet { plane, on: here });
    }
    let loose = left.len() as f64 > LOOSE * places.len() as f64;
    (sheets.len() > 1 && !loose).then_some(sheets)
}

/// The plane that most of the samples left are on, of several that the best;
/// fitted to these, twice.
fn fullest<'a>(
    places: &[Point],
    left: &[usize],
    tries: impl Iterator<Item = &'a Plane>,
    on: f64,
) -> Option<Plane> {
    let mut best: Option<(usize, f64, Plane)> = None;
    for p in tries {
        let heights = left.iter().map(|&k| p.height(places[k]).abs());
        let (count, sum) = (heights.filter(|&h| h <= on))
            .fold((0, 0.0), |(count, sum), h| (count + 1, sum + h * h));
        if best.is_none_or(|b| count > b.0 || count == b.0 && sum < b.1) {
            best = Some((count, sum, *p));
        }
    }
    let (.., mut plane) = best.filter(|b| b.0 >= FEWEST)?;
    for _ in 0..2 {
        let here: Vec<Point> = (left.iter().map(|&k| places[k]))
            .filter(|&p| plane.height(p).abs() <= on)
            .collect();
        match Plane::through(&here) {
            Some(better) if here.len() >= FEWEST => plane = better,
            _ => break,
        }
    }
    Some(plane)
}

/// The place nearest to `at` where two planes meet, if that is beside it and
/// beside samples of both.
fn foot(at: Point, own: &Sheet, other: &Sheet, places: &[Point], spacing: f64) -> Option<Foot> {
    let normals = [own.plane.normal, other.plane.normal];
    let along = cross(normals[0], normals[1]);
    let sine = norm(along);
    if sine == 0.0 || other.plane.height(at).abs() > BESIDE * spacing * sine {
        return None;
    }
    let base = sub(at, scale(normals[0], own.plane.height(at)));
    let across = cross(along, normals[0]);
    let way = -other.plane.height(base) / dot(across, normals[1]);
    let foot = add(base, scale(across, way));
    let supported = [own, other].iter().all(|sheet| {
        let mut distances = sheet.on.iter().map(|&k| dist_sq(places[k], foot));
        distances.any(|d| d < (SUPPORT * spacing).powi(2))
    });
    supported.then(|| Foot {
        at: foot,
        along: scale(along, 1.0 / sine),
        normals,
    })
}

/// The radius of the ball that touches at `at`, its centre that way, and the
/// other plane too; `None` where that lies on the other side.
fn within(at: Point, way: Point, other: &Sheet, places: &[Point]) -> Option<f64> {
    let side: f64 = (other.on.iter())
        .map(|&k| dot(sub(places[k], at), way))
        .sum();
    let height = other.plane.height(at);
    let cosine = dot(other.plane.normal, way) * height.signum();
    // Planes nearly alike: as large as you please.
    const FLAT: f64 = 1e-3;
    (side > 0.0).then(|| height.abs() / (1.0 - cosine).max(FLAT))
}

/// The radius of the largest empty ball that touches at `at`, its centre that
/// way: a ball that shrinks from sample to sample (Ma, Bae and Choi, 2012).
fn empty(near: &Near, at: Point, way: Point, most: f64, but: &[u32]) -> f64 {
    // A few steps are enough nearly always, and a ball still too large does no harm.
    const STEPS: usize = 20;
    // A sample this little inside, by the squared radius, is on the sphere but for rounding.
    const ROUNDING: f64 = 1e-6;
    // Samples that may be in the way besides those on the planes.
    const MORE: usize = 6;
    let mut radius = most;
    for _ in 0..STEPS {
        let centre = add(at, scale(way, radius));
        let nearest = near.nearest(centre, AROUND + MORE);
        let inside = nearest.iter().find(|n| {
            let ahead = dot(sub(near.places[n.1 as usize], at), way) > 0.0;
            ahead && !but.contains(&n.1)
        });
        let Some(n) = inside.filter(|n| n.0 < radius * radius * (1.0 - ROUNDING)) else {
            break;
        };
        let to = sub(near.places[n.1 as usize], at);
        radius = radius.min(norm_sq(to) / (2.0 * dot(to, way)));
    }
    radius
}
