//! From points to samples: finite, distinct, on a lattice, in an order of
//! their own.
//!
//! Points are centred and rounded once to a lattice whose step is about 2^-42
//! of the bounding box (2.3e-13: a tenth of a nanometre on a building). The lattice is what makes every later
//! decision exact in fixed width, whatever the scale: coordinates of 1e300 and
//! of 1e-300 look alike to it. Points that meet on one lattice point are one
//! sample. Output coordinates of samples are the given ones, bit for bit, but
//! for those in planes (`unlevel` in `surface/mend_place.rs`).

use std::cmp::Ordering;

use rayon::prelude::*;

use crate::error::SampleError;
use crate::geom::{Bounds, Point};
use crate::predicates::{orient, Counts, Sign, Site};
use crate::tetra::order;

/// Largest half-side of the frame: lattice coordinates of samples and frame
/// stay within it, centres of balls below half [`crate::predicates::LIMIT`].
const FRAME_HALF: f64 = 10_995_116_277_760.0; // 5 * 2^41

/// Samples closer to a common plane or line than this many lattice steps are
/// taken to lie on it. Far off the origin, a few steps between floats are
/// added, up to `FLAT_SHARE` of the cloud: a tilted plane there is one only
/// but for the rounding of its points.
const FLAT: f64 = 8.0;
const FLAT_ULPS: f64 = 4.0;
const FLAT_SHARE: f64 = 0.001;

/// The map between the user's coordinates and the lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// The user's coordinates of the lattice's origin.
    pub centre: Point,
    /// A lattice step is `2^-exponent` of the user's unit.
    pub exponent: i32,
    /// Half-side of the frame, in lattice steps.
    pub frame_half: f64,
    /// Half the largest side of the bounding box, in lattice steps.
    pub sample_half: f64,
}

impl Lattice {
    /// Lattice coordinates of a point, not rounded.
    pub fn to_lattice(&self, p: Point) -> Point {
        [0, 1, 2].map(|k| times_power(p[k] - self.centre[k], self.exponent))
    }

    /// The user's coordinates of a lattice position.
    pub fn to_user(&self, p: Point) -> Point {
        [0, 1, 2].map(|k| self.centre[k] + times_power(p[k], -self.exponent))
    }

    /// The power of two that brings the user's coordinates to about 1 in size
    /// (its binary exponent): scaling by it is exact, and products of scaled
    /// coordinates neither overflow nor vanish.
    pub fn unit_exponent(&self) -> i32 {
        let reach = self.length_to_user(self.sample_half);
        let largest = self.centre.iter().fold(reach, |m, v| m.max(v.abs()));
        -exponent(largest)
    }

    /// A length in lattice steps, in the user's units.
    pub fn length_to_user(&self, length: f64) -> f64 {
        times_power(length, -self.exponent)
    }
}

/// `v * 2^e` without overflow on the way.
pub(crate) fn times_power(v: f64, e: i32) -> f64 {
    let step = |e: i32| f64::from_bits(((e + 1023) as u64) << 52);
    let (mut v, mut e) = (v, e);
    while e > 1000 {
        v *= step(1000);
        e -= 1000;
    }
    while e < -1000 {
        v *= step(-1000);
        e += 1000;
    }
    v * step(e)
}

/// The sample of an input point that was left out.
pub const NO_SAMPLE: u32 = u32::MAX;

/// The samples: distinct points in spatial order.
#[derive(Clone, Debug)]
pub struct Samples {
    /// The given coordinates of each sample.
    pub points: Vec<Point>,
    /// Its lattice site.
    pub sites: Vec<Site>,
    /// The input point it stands for: of those at its place the first, in
    /// lexicographic order of coordinates where these differ by less than the
    /// lattice shows.
    pub source: Vec<u32>,
    /// How many input points it stands for.
    pub multiplicity: Vec<u32>,
    /// The sample of each input point, [`NO_SAMPLE`] where it was left out.
    pub of_input: Vec<u32>,
    /// The lattice.
    pub lattice: Lattice,
}

impl Samples {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// The samples at other places, one for each, in the user's coordinates.
    ///
    /// # Errors
    /// [`SampleError`], as [`samples`].
    pub fn moved(&self, points: &[Point], box_factor: f64) -> Result<Samples, SampleError> {
        let all: Vec<u32> = (0..self.len() as u32).collect();
        self.with(&all, points, box_factor)
    }

    /// The samples without some, of which `keep` is false. Input points that
    /// these stood for have [`NO_SAMPLE`].
    ///
    /// # Errors
    /// [`SampleError`], as [`samples`].
    pub fn without(&self, keep: &[bool], box_factor: f64) -> Result<Samples, SampleError> {
        let all = 0..self.len() as u32;
        let kept: Vec<u32> = all.filter(|&s| keep[s as usize]).collect();
        let points: Vec<Point> = kept.iter().map(|&s| self.points[s as usize]).collect();
        self.with(&kept, &points, box_factor)
    }

    /// Some of the samples at these places, with the input points they stand
    /// for.
    fn with(&self, some: &[u32], at: &[Point], box_factor: f64) -> Result<Samples, SampleError> {
        let mut made = samples(at, box_factor)?;
        let mut now = vec![NO_SAMPLE; self.len()];
        for (&s, &id) in some.iter().zip(&made.of_input) {
            now[s as usize] = id;
        }
        let then = self.of_input.iter();
        made.of_input = then
            .map(|&s| now.get(s as usize).copied().unwrap_or(NO_SAMPLE))
            .collect();
        for s in &mut made.source {
            *s = self.source[some[*s as usize] as usize];
        }
        made.multiplicity = vec![0; made.len()];
        for &s in made.of_input.iter().filter(|&&s| s != NO_SAMPLE) {
            made.multiplicity[s as usize] += 1;
        }
        Ok(made)
    }

    /// The sides of their box, in the user's units.
    pub fn sides(&self) -> Point {
        Bounds::of(&self.points).map_or([0.0; 3], |b| [0, 1, 2].map(|k| b.max[k] - b.min[k]))
    }

    /// Whether there are no samples (never, once made).
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }
}

/// Makes samples of points.
///
/// # Errors
/// See [`SampleError`]: not finite, too few, on one line, in one plane.
///
/// ```
/// use powercrust::{delaunay::samples, SampleError};
/// let flat: Vec<[f64; 3]> = (0..9).map(|k| [(k % 3) as f64, (k / 3) as f64, 7.0]).collect();
/// let error = samples(&flat, 5.0).unwrap_err();
/// assert_eq!(error.to_string(), "all 9 points lie in one plane: there is no solid");
/// ```
pub fn samples(points: &[Point], box_factor: f64) -> Result<Samples, SampleError> {
    let given = points.len();
    const MOST: usize = 1 << 28;
    if given > MOST {
        return Err(SampleError::TooMany { given, limit: MOST });
    }
    if let Some(index) = points.iter().position(|p| !p.iter().all(|v| v.is_finite())) {
        return Err(SampleError::NotFinite {
            index,
            point: points[index],
        });
    }
    let lattice = lattice(points, box_factor)?;
    let mut keyed: Vec<(u64, u32, Site)> = points
        .par_iter()
        .enumerate()
        .map(|(index, p)| {
            let q = lattice.to_lattice(*p).map(|v| v.round_ties_even() + 0.0);
            let site = [q[0], q[1], q[2], 0.0];
            (order::key(&site, lattice.sample_half), index as u32, site)
        })
        .collect();
    let along_curve = |a: &(u64, u32, Site), b: &(u64, u32, Site)| {
        let by_place = (0..3).fold(a.0.cmp(&b.0), |o, k| o.then(a.2[k].total_cmp(&b.2[k])));
        let given = |at: u32| &points[at as usize];
        let by_coordinates = || {
            (0..3).fold(Ordering::Equal, |o, k| {
                o.then(given(a.1)[k].total_cmp(&given(b.1)[k]))
            })
        };
        by_place.then_with(by_coordinates).then(a.1.cmp(&b.1))
    };
    keyed.par_sort_unstable_by(along_curve);

    // Runs of equal sites are one sample.
    let starts: Vec<usize> = (0..given)
        .filter(|&k| k == 0 || keyed[k].2 != keyed[k - 1].2)
        .collect();
    let distinct = starts.len();
    if distinct < 4 {
        return Err(SampleError::TooFew { given, distinct });
    }
    let mut made = Samples {
        points: Vec::with_capacity(distinct),
        sites: Vec::with_capacity(distinct),
        source: Vec::with_capacity(distinct),
        multiplicity: Vec::with_capacity(distinct),
        of_input: vec![0; given],
        lattice,
    };
    let ends = starts[1..].iter().copied().chain([given]);
    for (&from, to) in starts.iter().zip(ends) {
        let id = made.sites.len() as u32;
        for (_, index, _) in &keyed[from..to] {
            made.of_input[*index as usize] = id;
        }
        made.points.push(points[keyed[from].1 as usize]);
        made.sites.push(keyed[from].2);
        made.source.push(keyed[from].1);
        made.multiplicity.push((to - from) as u32);
    }
    spans_space(&made, given)?;
    Ok(made)
}

/// Chooses the lattice: symmetric about the middle of the bounding box, its
/// step a power of two, so that scaling the input by one changes nothing.
fn lattice(points: &[Point], box_factor: f64) -> Result<Lattice, SampleError> {
    let Some(bounds) = Bounds::of(points) else {
        return Err(SampleError::TooFew {
            given: 0,
            distinct: 0,
        });
    };
    // The centre is rounded: where a step between floats is as large as the
    // cloud, it may be a corner of the box.
    let centre = [0, 1, 2].map(|k| bounds.min[k] / 2.0 + bounds.max[k] / 2.0);
    let half = (0..3).fold(0.0f64, |half, k| {
        half.max(bounds.max[k] - centre[k])
            .max(centre[k] - bounds.min[k])
    });
    // The difference of two coordinates must itself be finite.
    const WIDEST: f64 = 2e307;
    if half > WIDEST / 2.0 {
        return Err(SampleError::TooWide {
            extent: 2.0 * half,
            limit: WIDEST,
        });
    }
    let bits = exponent(FRAME_HALF / box_factor);
    // `half` in [2^(e-1), 2^e); zero when all points are one.
    let e = if half > 0.0 { exponent(half) + 1 } else { 0 };
    let exponent = (bits - e).min(2000);
    let sample_half = times_power(half, exponent).ceil().max(1.0);
    Ok(Lattice {
        centre,
        exponent,
        frame_half: (sample_half * box_factor).ceil(),
        sample_half,
    })
}

/// `floor(log2(v))` of a positive number, subnormal ones included.
fn exponent(v: f64) -> i32 {
    if v >= f64::MIN_POSITIVE {
        (v.to_bits() >> 52) as i32 - 1023
    } else {
        exponent(v * 2f64.powi(64)) - 64
    }
}

/// Refuses samples on one line or in one plane, exactly or to within
/// [`FLAT`] lattice steps and the rounding of the input.
fn spans_space(samples: &Samples, given: usize) -> Result<(), SampleError> {
    use crate::geom::vec3::{cross, dist_sq, dot, norm, sub};
    let (sites, lattice) = (&samples.sites, &samples.lattice);
    let largest = lattice.centre.map(f64::abs).into_iter().fold(0.0, f64::max);
    let rounding = times_power(largest * f64::EPSILON, lattice.exponent) * FLAT_ULPS;
    let tolerance = FLAT + rounding.min(lattice.sample_half * FLAT_SHARE);
    let at = |s: &Site| [s[0], s[1], s[2]];
    let farthest = |measure: &dyn Fn(Point) -> f64| {
        let mut best = (0usize, -1.0);
        for (k, s) in sites.iter().enumerate() {
            let m = measure(at(s));
            if m > best.1 {
                best = (k, m);
            }
        }
        best
    };
    let a = at(&sites[0]);
    let (far, _) = farthest(&|p| dist_sq(p, a));
    let b = at(&sites[far]);
    let along = sub(b, a);
    let (off, area) = farthest(&|p| norm(cross(sub(p, a), along)));
    if area <= tolerance * norm(along) {
        return Err(SampleError::Collinear { given });
    }
    let c = at(&sites[off]);
    let normal = cross(along, sub(c, a));
    let (above, volume) = farthest(&|p| dot(sub(p, a), normal).abs());
    let flat = volume <= tolerance * norm(normal);
    let mut counts = Counts::default();
    let corners = [&sites[0], &sites[far], &sites[off], &sites[above]];
    let exact = orient(corners[0], corners[1], corners[2], corners[3], &mut counts);
    if flat || exact == Sign::Zero {
        return Err(SampleError::Coplanar { given });
    }
    Ok(())
}
