//! Choosing the poles of each sample among its Voronoi vertices.

use rayon::prelude::*;

use super::{skinny, BallLattice, PoleOptions, NO_POLE};
use crate::delaunay::{rounded_circumcentre, Delaunay};
use crate::geom::vec3::{dist_sq, dot, sub};
use crate::geom::Point;

/// The rounded circumcentre of each cell, in lattice steps of the samples.
pub(super) fn centres(delaunay: &Delaunay, lattice: BallLattice) -> Vec<Point> {
    let cells = &delaunay.complex.cells;
    cells
        .par_iter()
        .map(|&cell| centre(delaunay, cell, lattice))
        .collect()
}

/// The rounded circumcentre of one cell.
pub(super) fn centre(delaunay: &Delaunay, cell: [u32; 4], lattice: BallLattice) -> Point {
    let sites = cell.map(|v| &delaunay.sites[v as usize]);
    rounded_circumcentre(sites, lattice.step())
}

/// The cells chosen as poles.
pub(super) struct Chosen {
    /// First and second pole of each sample, as cells.
    pub cells: Vec<[u32; 2]>,
    pub skinny_samples: u32,
    pub dropped: u32,
}

/// First pole: the farthest Voronoi vertex. Second: the farthest with a
/// negative dot product to the first. Equal distances are told apart by the
/// centre's coordinates; equal centres are one ball anyway.
pub(super) fn select(delaunay: &Delaunay, centres: &[Point], options: &PoleOptions) -> Chosen {
    let vertices = delaunay.sites.len();
    let (starts, items) = delaunay.complex.cells_by_vertex(vertices);
    let found: Vec<([u32; 2], u8)> = (0..delaunay.samples)
        .into_par_iter()
        .map(|s| {
            let site = delaunay.sites[s];
            let at = [site[0], site[1], site[2]];
            let cells = &items[starts[s] as usize..starts[s + 1] as usize];
            let poles = pair(at, cells, centres);
            drop_misshapen(at, cells, centres, poles, options)
        })
        .collect();
    Chosen {
        skinny_samples: found.iter().filter(|f| f.1 > 0).count() as u32,
        dropped: found.iter().map(|f| f.1 as u32).sum(),
        cells: found.into_iter().map(|f| f.0).collect(),
    }
}

/// The two poles of a sample at `s` among its cells.
fn pair(s: Point, cells: &[u32], centres: &[Point]) -> [u32; 2] {
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
        return [NO_POLE; 2];
    }
    let normal = sub(centres[first as usize], s);
    let second = farthest(&|centre| dot(sub(centre, s), normal) < 0.0);
    [first, second]
}

fn before(a: Point, b: Point) -> bool {
    a.partial_cmp(&b) == Some(std::cmp::Ordering::Less)
}

/// Applies the skinniness test; the second value counts the poles dropped.
fn drop_misshapen(
    s: Point,
    cells: &[u32],
    centres: &[Point],
    poles: [u32; 2],
    options: &PoleOptions,
) -> ([u32; 2], u8) {
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
    for k in 0..2 {
        if fails[k] || (options.sharp && (fails[0] || fails[1])) {
            dropped += (kept[k] != NO_POLE) as u8;
            kept[k] = NO_POLE;
        }
    }
    (kept, dropped)
}
