//! All Delaunay balls at chosen samples, as balls of the power diagram.

use super::{select, BallLattice, Balls};
use crate::delaunay::Delaunay;
use crate::geom::Side;
use crate::predicates::Site;

/// The Delaunay balls at some samples.
pub struct Candidates {
    starts: Vec<usize>,
    sites: Vec<Site>,
    corners: Vec<[u32; 4]>,
    frame: Vec<bool>,
}

impl Candidates {
    /// Collects the balls at the given samples.
    pub fn of(delaunay: &Delaunay, samples: &[u32], lattice: BallLattice) -> Candidates {
        let mut slot = vec![u32::MAX; delaunay.sites.len()];
        for (k, &s) in samples.iter().enumerate() {
            slot[s as usize] = k as u32;
        }
        let mut found: Vec<(u32, u32)> = Vec::new();
        for (c, cell) in delaunay.complex.cells.iter().enumerate() {
            for &v in cell {
                if slot[v as usize] != u32::MAX {
                    found.push((slot[v as usize], c as u32));
                }
            }
        }
        found.sort_unstable();
        let mut made = Candidates {
            starts: vec![0],
            sites: Vec::with_capacity(found.len()),
            corners: Vec::with_capacity(found.len()),
            frame: Vec::with_capacity(found.len()),
        };
        let mut at = 0;
        for k in 0..samples.len() as u32 {
            while at < found.len() && found[at].0 == k {
                let cell = delaunay.complex.cells[found[at].1 as usize];
                let centre = select::centre(delaunay, cell, lattice);
                made.sites
                    .push(super::balls::site(delaunay, centre, &cell, lattice));
                made.frame.push(cell.iter().any(|&v| delaunay.is_frame(v)));
                made.corners.push(cell);
                at += 1;
            }
            made.starts.push(made.sites.len());
        }
        made
    }

    /// The candidates at the `k`-th sample, without those at the frame.
    pub fn at(&self, k: usize) -> impl Iterator<Item = usize> + '_ {
        (self.starts[k]..self.starts[k + 1]).filter(|&c| !self.frame[c])
    }

    /// A candidate as a site of the power diagram.
    pub fn site(&self, c: usize) -> &Site {
        &self.sites[c]
    }

    /// Appends chosen candidates to the balls, equal centres once; returns
    /// the sides of those appended.
    pub fn append(
        &self,
        balls: &mut Balls,
        chosen: impl Iterator<Item = (usize, Side)>,
    ) -> Vec<Side> {
        let mut chosen: Vec<(usize, Side)> = chosen.collect();
        let place = |c: usize| [0, 1, 2].map(|k| self.sites[c][k]);
        chosen.sort_by(|a, b| {
            let by_place = place(a.0).partial_cmp(&place(b.0));
            by_place
                .unwrap_or(std::cmp::Ordering::Equal)
                .then(a.0.cmp(&b.0))
        });
        let mut sides = Vec::new();
        for (k, &(c, side)) in chosen.iter().enumerate() {
            let mut touched = self.corners[c];
            touched.sort_unstable();
            if k > 0 && place(chosen[k - 1].0) == place(c) {
                balls.touch_last(&touched);
                continue;
            }
            balls.push(self.sites[c], &touched);
            sides.push(side);
        }
        sides
    }
}
