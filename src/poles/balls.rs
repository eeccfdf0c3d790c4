//! The polar balls as sites of the power diagram.

use std::cmp::Ordering;

use rayon::prelude::*;

use super::NO_POLE;
use crate::context::{Cancelled, Portion};
use crate::delaunay::Delaunay;
use crate::geom::{vec3::dist_sq, Ball, Point};
use crate::predicates::Site;
use crate::tetra::order;

/// The coarser lattice of the balls: its step is `2^shift` lattice steps of
/// the samples.
///
/// A centre on it is off by at most half a step in each coordinate, so a ball
/// of radius r misses its own samples by about `r` steps in power. That noise
/// decides the degenerate tests around every sample (fact F1); the coarser
/// the lattice, the farther it stands above the rounding of floats and the rarer the integer stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BallLattice {
    /// log2 of the step, in steps of the sample lattice.
    pub shift: i32,
}

impl BallLattice {
    /// 2^-32 of the bounding box.
    pub const DEFAULT: BallLattice = BallLattice { shift: 10 };

    /// The step, in steps of the sample lattice.
    pub fn step(self) -> f64 {
        2f64.powi(self.shift)
    }
}

/// Balls on the ball lattice, with the samples they touch.
#[derive(Clone, Debug)]
pub struct Balls {
    /// Centre and squared radius of each ball, in steps of the ball lattice.
    pub sites: Vec<Site>,
    /// The lattice.
    pub lattice: BallLattice,
    /// Ball `b` touches the samples
    /// `touched[touch_starts[b]..touch_starts[b + 1]]`, ascending.
    pub touch_starts: Vec<u32>,
    /// Samples touched, ball after ball.
    pub touched: Vec<u32>,
    /// Whether the ball touches a corner of the frame: it is outside.
    pub touches_frame: Vec<bool>,
}

impl Balls {
    /// Number of balls.
    pub fn len(&self) -> usize {
        self.sites.len()
    }

    /// Whether there is no ball.
    pub fn is_empty(&self) -> bool {
        self.sites.is_empty()
    }

    /// The balls in lattice steps of the samples.
    pub fn on_lattice(&self) -> Vec<Ball> {
        let step = self.lattice.step();
        let ball = |s: &Site| Ball::new([s[0], s[1], s[2]].map(|v| v * step), s[3].sqrt() * step);
        self.sites.par_iter().map(ball).collect()
    }

    /// Appends a ball that touches the given samples, ascending.
    pub fn push(&mut self, site: Site, touched: &[u32]) {
        self.sites.push(site);
        self.touched.extend_from_slice(touched);
        self.touch_starts.push(self.touched.len() as u32);
        self.touches_frame.push(false);
    }

    /// Adds samples to those the last ball touches.
    pub fn touch_last(&mut self, touched: &[u32]) {
        let Some(last) = self.len().checked_sub(1) else {
            return;
        };
        let from = self.touch_starts[last] as usize;
        let mut all = self.touched.split_off(from);
        all.extend_from_slice(touched);
        all.sort_unstable();
        all.dedup();
        self.touched.extend_from_slice(&all);
        self.touch_starts[last + 1] = self.touched.len() as u32;
    }

    /// The samples ball `b` touches, ascending.
    pub fn touching(&self, b: u32) -> &[u32] {
        let b = b as usize;
        &self.touched[self.touch_starts[b] as usize..self.touch_starts[b + 1] as usize]
    }
}

/// Makes balls of the chosen cells: equal centres are one ball, which touches
/// the samples of all cells with that centre, chosen or not.
pub(super) fn gather(
    delaunay: &Delaunay,
    centres: &[Point],
    chosen: &[[u32; 2]],
    lattice: BallLattice,
    progress: &Portion,
) -> Result<(Balls, Vec<[u32; 2]>), Cancelled> {
    let mut is_pole = vec![false; centres.len()];
    for &c in chosen.iter().flatten().filter(|&&c| c != NO_POLE) {
        is_pole[c as usize] = true;
    }
    let cells = along_the_curve(centres, &is_pole);
    progress.advance(1, 3)?;
    // Equal centres are side by side; those of no pole came by chance.
    let mut groups: Vec<[u32; 2]> = Vec::new();
    let mut from = 0;
    let same = |a: &u32, b: &u32| centres[*a as usize] == centres[*b as usize];
    for group in cells.chunk_by(same) {
        let to = from + group.len();
        if group.iter().any(|&c| is_pole[c as usize]) {
            groups.push([from as u32, to as u32]);
        }
        from = to;
    }
    drop(is_pole);
    progress.advance(2, 3)?;

    let count = groups.len();
    let mut balls = Balls {
        sites: Vec::with_capacity(count),
        lattice,
        touch_starts: Vec::with_capacity(count + 1),
        touched: Vec::with_capacity(count * 4),
        touches_frame: Vec::with_capacity(count),
    };
    balls.touch_starts.push(0);
    let mut ball_of_cell = vec![NO_POLE; centres.len()];
    let mut corners: Vec<u32> = Vec::new();
    for group in &groups {
        let id = balls.sites.len() as u32;
        corners.clear();
        for &c in &cells[group[0] as usize..group[1] as usize] {
            ball_of_cell[c as usize] = id;
            corners.extend_from_slice(&delaunay.complex.cells[c as usize]);
        }
        corners.sort_unstable();
        corners.dedup();
        let centre = centres[cells[group[0] as usize] as usize];
        let site = site(delaunay, centre, &corners, lattice);
        balls.sites.push(site);
        let real = corners.partition_point(|&v| !delaunay.is_frame(v));
        balls.touched.extend_from_slice(&corners[..real]);
        balls.touch_starts.push(balls.touched.len() as u32);
        balls.touches_frame.push(real < corners.len());
    }
    let ball = |c: u32| match c {
        NO_POLE => NO_POLE,
        c => ball_of_cell[c as usize],
    };
    let of_sample = chosen.par_iter().map(|pair| pair.map(ball)).collect();
    Ok((balls, of_sample))
}

/// The chosen cells and those that may share a centre with one, sorted along
/// the curve by their centres.
fn along_the_curve(centres: &[Point], chosen: &[bool]) -> Vec<u32> {
    let mut filter = Filter::with_room_for(chosen.iter().filter(|&&c| c).count());
    for (centre, _) in centres.iter().zip(chosen).filter(|(_, &chosen)| chosen) {
        filter.add(centre);
    }
    let half = crate::predicates::LIMIT / 2.0;
    let mut keyed: Vec<(u64, u32)> = (0..centres.len())
        .into_par_iter()
        .filter(|&c| chosen[c] || filter.may_hold(&centres[c]))
        .map(|c| {
            let p = centres[c];
            (order::key(&[p[0], p[1], p[2], 0.0], half / 2.0), c as u32)
        })
        .collect();
    keyed.par_sort_unstable_by(|a, b| {
        let (p, q) = (&centres[a.1 as usize], &centres[b.1 as usize]);
        let by_place = || (0..3).fold(Ordering::Equal, |o, k| o.then(p[k].total_cmp(&q[k])));
        a.0.cmp(&b.0).then_with(by_place).then(a.1.cmp(&b.1))
    });
    keyed.into_iter().map(|(_, c)| c).collect()
}

/// A set of points that is sometimes wrong about one it does not hold: a bit
/// for each point in a table 16 times as large.
struct Filter {
    bits: Vec<u64>,
}

impl Filter {
    fn with_room_for(count: usize) -> Filter {
        Filter {
            bits: vec![0; (count / 4 + 1).next_power_of_two()],
        }
    }

    fn place(&self, point: &Point) -> (usize, u32) {
        let mix =
            |h: u64, v: &f64| (h.rotate_left(29) ^ v.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let h = point.iter().fold(0, mix);
        let h = h ^ h >> 32;
        ((h >> 6) as usize & (self.bits.len() - 1), (h & 63) as u32)
    }

    fn add(&mut self, point: &Point) {
        let (word, bit) = self.place(point);
        self.bits[word] |= 1 << bit;
    }

    fn may_hold(&self, point: &Point) -> bool {
        let (word, bit) = self.place(point);
        self.bits[word] >> bit & 1 == 1
    }
}

/// The ball about a centre (in lattice steps of the samples) that reaches the
/// nearest of its samples, as a site.
pub(super) fn site(
    delaunay: &Delaunay,
    centre: Point,
    corners: &[u32],
    lattice: BallLattice,
) -> Site {
    let step = lattice.step();
    let nearest = corners
        .iter()
        .map(|&v| {
            let s = &delaunay.sites[v as usize];
            dist_sq(centre, [s[0], s[1], s[2]])
        })
        .fold(f64::INFINITY, f64::min);
    let weight = (nearest / (step * step)).round();
    [centre[0] / step, centre[1] / step, centre[2] / step, weight]
}
