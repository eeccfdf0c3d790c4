//! Edges are lines: feet that agree with many others.
//!
//! On curved and noisy surfaces two planes now and then fit better than a
//! quadric, but the lines where they meet lie here and there. Feet agree where
//! one lies on the line of the other, nearly, and the same planes meet. What
//! hangs together by agreement is kept where some feet agree with many.

use rayon::prelude::*;

use super::{Corner, Foot};
use crate::geom::vec3::{dot, norm, scale, sub};
use crate::geom::Point;
use crate::noise::near::Near;

/// Feet asked, and how far away, in spacings: an edge has two or three feet to
/// the spacing.
const ASKED: usize = 25;
const REACH: f64 = 2.5;

/// How far off the line a foot may be, in spacings, and how much farther by
/// the square of the distance along it, for edges that bend.
const OFF: f64 = 0.15;
const BEND: f64 = 0.08;

/// The largest angle between planes that are the same, in degrees.
const TURN: f64 = 25.0;

/// An edge has this many feet that agree with that many others. With fewer,
/// more is found on noisy curved surfaces, and little more on edges.
const SURE: usize = 4;
const MANY: usize = 8;

/// Keeps feet that agree with others, and the samples that have some.
pub(super) fn agreeing(mut found: Vec<Corner>) -> Vec<Corner> {
    let agree = agreement(&found);
    let mut kept = vec![false; agree.len()];
    for part in hanging_together(&agree) {
        let sure = part.iter().filter(|&&f| agree[f as usize].len() >= MANY);
        if sure.count() >= SURE {
            part.iter().for_each(|&f| kept[f as usize] = true);
        }
    }
    let mut kept = kept.into_iter();
    for corner in &mut found {
        corner.feet.retain(|_| kept.next() == Some(true));
    }
    found.retain(|c| !c.feet.is_empty());
    found
}

/// For each foot, those of other samples on its line; feet by sample.
fn agreement(found: &[Corner]) -> Vec<Vec<u32>> {
    let all: Vec<(usize, &Foot)> = (found.iter().enumerate())
        .flat_map(|(k, c)| c.feet.iter().map(move |f| (k, f)))
        .collect();
    let places: Vec<Point> = all.iter().map(|f| f.1.at).collect();
    let near = Near::of(&places);
    let on_line = |&(owner, foot): &(usize, &Foot)| {
        let spacing = found[owner].spacing;
        let asked = near.nearest(foot.at, ASKED).into_iter();
        asked
            .filter(|n| n.0 <= (REACH * spacing).powi(2) && all[n.1 as usize].0 != owner)
            .filter(|n| same_edge(foot, all[n.1 as usize].1, spacing))
            .map(|n| n.1)
            .collect()
    };
    all.par_iter().map(on_line).collect()
}

/// Whether one foot lies on the line of the other, and the same planes meet.
fn same_edge(a: &Foot, b: &Foot, spacing: f64) -> bool {
    let alike = TURN.to_radians().cos();
    let same = |p: Point, q: Point| dot(p, q).abs() > alike;
    let [p, q] = a.normals;
    let [s, t] = b.normals;
    if !(same(p, s) && same(q, t) || same(p, t) && same(q, s)) {
        return false;
    }
    let way = sub(b.at, a.at);
    let along = dot(way, a.along);
    let off = norm(sub(way, scale(a.along, along)));
    off < OFF * spacing + BEND * along * along / spacing
}

/// The parts of a graph; its edges may be given one way only.
fn hanging_together(edges: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut both = edges.to_vec();
    for (f, list) in edges.iter().enumerate() {
        for &g in list {
            both[g as usize].push(f as u32);
        }
    }
    let mut parts = Vec::new();
    let mut met = vec![false; edges.len()];
    for first in 0..edges.len() {
        if std::mem::replace(&mut met[first], true) {
            continue;
        }
        let mut part = vec![first as u32];
        let mut next = 0;
        while let Some(&f) = part.get(next) {
            next += 1;
            for &g in &both[f as usize] {
                if !std::mem::replace(&mut met[g as usize], true) {
                    part.push(g);
                }
            }
        }
        parts.push(part);
    }
    parts
}
