//! The polar balls as sites of the power diagram.

use rayon::prelude::*;

use super::NO_POLE;
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

/// The place of a cell's centre along the curve, the centre, the cell.
type Keyed = (u64, Point, u32);

/// Makes balls of the chosen cells: equal centres are one ball, which touches
/// the samples of all cells with that centre, chosen or not.
pub(super) fn gather(
    delaunay: &Delaunay,
    centres: &[Point],
    chosen: &[[u32; 2]],
    lattice: BallLattice,
) -> (Balls, Vec<[u32; 2]>) {
    let mut used = vec![false; centres.len()];
    for &c in chosen.iter().flatten() {
        if c != NO_POLE {
            used[c as usize] = true;
        }
    }
    // Order along the curve by centre; equal centres end up side by side.
    let half = crate::predicates::LIMIT / 2.0;
    let key = |c: u32| -> Keyed {
        let p = centres[c as usize];
        (order::key(&[p[0], p[1], p[2], 0.0], half / 2.0), p, c)
    };
    let place =
        |a: &Keyed, b: &Keyed| (0..3).fold(a.0.cmp(&b.0), |o, k| o.then(a.1[k].total_cmp(&b.1[k])));
    let cells = 0..centres.len() as u32;
    let (chosen_cells, others): (Vec<u32>, Vec<u32>) = cells.partition(|&c| used[c as usize]);
    let mut keyed: Vec<Keyed> = chosen_cells.into_par_iter().map(key).collect();
    keyed.par_sort_unstable_by(|a, b| place(a, b).then(a.2.cmp(&b.2)));
    let same_centre = |c: &Keyed| keyed.binary_search_by(|k| place(k, c)).is_ok();
    let more: Vec<Keyed> = others
        .into_par_iter()
        .map(key)
        .filter(same_centre)
        .collect();
    if !more.is_empty() {
        keyed.extend(more);
        keyed.par_sort_unstable_by(|a, b| place(a, b).then(a.2.cmp(&b.2)));
    }
    let mut firsts: Vec<u32> = Vec::new();
    for k in 0..keyed.len() {
        if k == 0 || keyed[k].1 != keyed[k - 1].1 {
            firsts.push(k as u32);
        }
    }
    let count = firsts.len();
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
    for (k, &from) in firsts.iter().enumerate() {
        let from = from as usize;
        let to = firsts.get(k + 1).map_or(keyed.len(), |&next| next as usize);
        let id = balls.sites.len() as u32;
        corners.clear();
        for (_, _, c) in &keyed[from..to] {
            ball_of_cell[*c as usize] = id;
            corners.extend_from_slice(&delaunay.complex.cells[*c as usize]);
        }
        corners.sort_unstable();
        corners.dedup();
        let centre = keyed[from].1;
        balls.sites.push(site(delaunay, centre, &corners, lattice));
        let real = corners.iter().filter(|&&v| !delaunay.is_frame(v));
        balls.touched.extend(real);
        balls.touch_starts.push(balls.touched.len() as u32);
        balls
            .touches_frame
            .push(corners.iter().any(|&v| delaunay.is_frame(v)));
    }
    let of_sample = chosen
        .iter()
        .map(|pair| {
            pair.map(|c| {
                if c == NO_POLE {
                    NO_POLE
                } else {
                    ball_of_cell[c as usize]
                }
            })
        })
        .collect();
    (balls, of_sample)
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
