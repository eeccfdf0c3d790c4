//! Choosing the poles of each sample among its Voronoi vertices.

use rayon::prelude::*;

use super::{skinny, BallLattice, PoleOptions, PolesOfSample, NO_POLE};
use crate::delaunay::{circumcentre, Delaunay};
use crate::geom::vec3::{dist_sq, dot, norm, sub};
use crate::geom::Point;

/// The rounded circumcentre of each cell, in lattice steps of the samples.
pub(super) fn centres(delaunay: &Delaunay, lattice: BallLattice) -> Vec<Point> {
    let step = lattice.step();
    delaunay
        .complex
        .cells
        .par_iter()
        .map(|cell| {
            // Corners in ascending order: the same floats however the cell
            // came about.
            let mut corners = *cell;
            corners.sort_unstable();
            let sites = corners.map(|v| &delaunay.sites[v as usize]);
            let centre = circumcentre(sites, step / 64.0);
            centre
                .position
                .map(|v| (v / step).round_ties_even() * step + 0.0)
        })
        .collect()
}

/// The cells chosen as poles.
pub(super) struct Chosen {
    /// The poles of each sample, as cells.
    pub cells: Vec<PolesOfSample>,
    pub skinny_samples: u32,
    pub dropped: u32,
}

/// First pole: the farthest Voronoi vertex. Second: the farthest with a
/// negative dot product to the first. Equal distances are told apart by the
/// centre's coordinates; equal centres are one ball anyway.
pub(super) fn select(delaunay: &Delaunay, centres: &[Point], options: &PoleOptions) -> Chosen {
    let vertices = delaunay.sites.len();
    let (starts, items) = delaunay.complex.cells_by_vertex(vertices);
    let found: Vec<(PolesOfSample, u8)> = (0..delaunay.samples)
        .into_par_iter()
        .map(|s| {
            let site = delaunay.sites[s];
            let at = [site[0], site[1], site[2]];
            let cells = &items[starts[s] as usize..starts[s + 1] as usize];
            let poles = poles(at, cells, centres);
            drop_misshapen(at, cells, centres, poles, options)
        })
        .collect();
    Chosen {
        skinny_samples: found.iter().filter(|f| f.1 > 0).count() as u32,
        dropped: found.iter().map(|f| f.1 as u32).sum(),
        cells: found.into_iter().map(|f| f.0).collect(),
    }
}

/// Cosine of the angle between first and second pole above which a third is
/// looked for.
const WIDE: f64 = -0.5;

/// The poles of a sample at `s` among its cells.
fn poles(s: Point, cells: &[u32], centres: &[Point]) -> PolesOfSample {
    let farthest = |ahead: &dyn Fn(Point) -> bool| {
        let mut best = NO_POLE;
        let mut reach = -1.0;
        for &c in cells {
            let centre = centres[c as usize];
            if !ahead(centre) {
                continue;
            }
            let distance = dist_sq(centre, s);
            let better =
                distance > reach || (distance == reach && before(centre, centres[best as usize]));
            if better {
                best = c;
                reach = distance;
            }
        }
        best
    };
    let first = farthest(&|_| true);
    if first == NO_POLE {
        return [NO_POLE; 3];
    }
    let normal = sub(centres[first as usize], s);
    let second = farthest(&|centre| dot(sub(centre, s), normal) < 0.0);
    if second == NO_POLE {
        return [first, NO_POLE, NO_POLE];
    }
    let other = sub(centres[second as usize], s);
    let mut third = NO_POLE;
    if dot(normal, other) > WIDE * norm(normal) * norm(other) {
        third = farthest(&|centre| {
            let to = sub(centre, s);
            dot(to, normal) < 0.0 && dot(to, other) < 0.0
        });
    }
    [first, second, third]
}

fn before(a: Point, b: Point) -> bool {
    a.partial_cmp(&b) == Some(std::cmp::Ordering::Less)
}

/// Applies the skinniness test; the second value counts the poles dropped.
fn drop_misshapen(
    s: Point,
    cells: &[u32],
    centres: &[Point],
    poles: PolesOfSample,
    options: &PoleOptions,
) -> (PolesOfSample, u8) {
    let Some(lambda) = options.lambda else {
        return (poles, 0);
    };
    if poles[0] == NO_POLE {
        return (poles, 0);
    }
    let all = cells.iter().map(|&c| centres[c as usize]);
    let bound = skinny::feature_size_bound(s, centres[poles[0] as usize], all, lambda);
    let fails = poles.map(|p| p != NO_POLE && dist_sq(centres[p as usize], s) < bound * bound);
    let mut kept = poles;
    let mut dropped = 0;
    for k in 0..3 {
        if fails[k] || (options.sharp && fails.contains(&true)) {
            dropped += (kept[k] != NO_POLE) as u8;
            kept[k] = NO_POLE;
        }
    }
    (kept, dropped)
}
