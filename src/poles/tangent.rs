//! Poles put in the place of those that Voronoi cells have.

use std::cmp::Ordering;

use super::{Balls, DroppedPole, Poles, Reason, NO_POLE};
use crate::geom::vec3::{dist_sq, dot, norm_sq, sub};
use crate::geom::Point;
use crate::predicates::Site;

/// A ball that touches a sample and is to be its pole; in lattice steps of
/// the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangent {
    /// The sample.
    pub sample: u32,
    /// Which of its two poles.
    pub slot: usize,
    /// Where the sample is, or would be without noise.
    pub at: Point,
    /// The centre.
    pub centre: Point,
}

/// A new ball, and whether it is known to be outside.
#[derive(Clone, Copy)]
struct New<'a> {
    site: Site,
    outside: bool,
    tangent: &'a Tangent,
}

impl Poles {
    /// Drops both poles of some samples, ascending, and puts others in the
    /// place of poles. Balls that are the pole of no sample any more go; a ball
    /// whose centre a new one has is that one too. A new ball on the side where
    /// an old one of its sample touched the frame is outside.
    pub fn replace(mut self, at_edges: &[u32], tangents: &[Tangent]) -> Poles {
        let mut new: Vec<New> = tangents.iter().map(|t| self.new_ball(t)).collect();
        new.sort_unstable_by(|a, b| {
            let (s, t) = (a.tangent, b.tangent);
            (by_centre(&a.site, &b.site)).then((s.sample, s.slot).cmp(&(t.sample, t.slot)))
        });
        self.drop_both(at_edges);
        for t in tangents {
            self.of_sample[t.sample as usize][t.slot] = NO_POLE;
        }
        // Balls with equal centres are one.
        let same = |a: &New, b: &New| by_centre(&a.site, &b.site).is_eq();
        let groups: Vec<&[New]> = new.chunk_by(same).collect();
        let mut balls = self.only_poles(&groups);
        for (group, ball) in groups.iter().zip(&mut balls) {
            if *ball == NO_POLE {
                *ball = self.balls.len() as u32;
                self.balls.push(group[0].site, &[]);
                add(&mut self.balls, group);
            }
            for n in *group {
                self.of_sample[n.tangent.sample as usize][n.tangent.slot] = *ball;
            }
        }
        self
    }

    /// The ball on the lattice of balls.
    fn new_ball<'a>(&self, tangent: &'a Tangent) -> New<'a> {
        /// The squared cosine of the angle up to which two balls of a sample lie on
        /// one side, about 70 degrees: the pole beside an edge looks across it.
        const ONE_SIDE: f64 = 0.1;
        let step = self.balls.lattice.step();
        let [x, y, z] = tangent.centre.map(|v| (v / step).round() + 0.0);
        let weight = dist_sq([x, y, z], tangent.at.map(|v| v / step)).round();
        let here = sub(tangent.centre, tangent.at);
        let outside = self.of_sample[tangent.sample as usize].iter().any(|&b| {
            b != NO_POLE && self.balls.touches_frame[b as usize] && {
                let site = &self.balls.sites[b as usize];
                let there = sub([site[0], site[1], site[2]].map(|v| v * step), tangent.at);
                let along = dot(there, here);
                along > 0.0 && along * along > ONE_SIDE * norm_sq(there) * norm_sq(here)
            }
        });
        New {
            site: [x, y, z, weight],
            outside,
            tangent,
        }
    }

    /// Drops both poles of some samples, ascending.
    fn drop_both(&mut self, at_edges: &[u32]) {
        let step = self.balls.lattice.step();
        for &sample in at_edges {
            for (slot, ball) in self.of_sample[sample as usize].into_iter().enumerate() {
                if ball == NO_POLE {
                    continue;
                }
                let site = self.balls.sites[ball as usize];
                self.dropped.push(DroppedPole {
                    sample,
                    pole: slot as u8 + 1,
                    centre: [site[0], site[1], site[2]].map(|v| v * step),
                    radius: site[3].sqrt() * step,
                    bound: 0.0,
                    reason: Reason::Corner,
                });
            }
            self.of_sample[sample as usize] = [NO_POLE; 2];
        }
        self.dropped.sort_by_key(|d| (d.sample, d.pole));
    }

    /// Forgets balls that are the pole of no sample; those left that have the
    /// centre of a group of new ones stand for it. Returns the ball of each
    /// group.
    fn only_poles(&mut self, groups: &[&[New]]) -> Vec<u32> {
        let old = &self.balls;
        let mut number = vec![NO_POLE; old.len()];
        for &b in self.of_sample.iter().flatten().filter(|&&b| b != NO_POLE) {
            number[b as usize] = 0;
        }
        let mut balls = Balls {
            sites: Vec::with_capacity(old.len() + groups.len()),
            lattice: old.lattice,
            touch_starts: vec![0],
            touched: Vec::with_capacity(old.touched.len()),
            touches_frame: Vec::with_capacity(old.len() + groups.len()),
        };
        let mut of_group = vec![NO_POLE; groups.len()];
        for (b, number) in number.iter_mut().enumerate().filter(|n| *n.1 != NO_POLE) {
            *number = balls.len() as u32;
            let site = old.sites[b];
            balls.push(site, old.touching(b as u32));
            balls.touches_frame[*number as usize] = old.touches_frame[b];
            if let Ok(g) = groups.binary_search_by(|g| by_centre(&g[0].site, &site)) {
                add(&mut balls, groups[g]);
                of_group[g] = *number;
            }
        }
        for b in self.of_sample.iter_mut().flatten() {
            if *b != NO_POLE {
                *b = number[*b as usize];
            }
        }
        self.balls = balls;
        of_group
    }
}

/// Tells the last ball what is known of new ones with its centre.
fn add(balls: &mut Balls, group: &[New]) {
    let touched: Vec<u32> = group.iter().map(|n| n.tangent.sample).collect();
    balls.touch_last(&touched);
    if let Some(last) = balls.touches_frame.last_mut() {
        *last |= group.iter().any(|n| n.outside);
    }
}

/// The order of sites by centre alone.
fn by_centre(a: &Site, b: &Site) -> Ordering {
    (0..3).fold(Ordering::Equal, |o, k| o.then(a[k].total_cmp(&b[k])))
}
