//! Choosing the poles of each sample among its Voronoi vertices.

use rayon::prelude::*;

use super::{skinny, BallLattice, PoleOptions, NO_POLE};
use crate::context::{Cancelled, Portion};
use crate::delaunay::{rounded_circumcentre, Delaunay};
use crate::geom::vec3::{dist_sq, dot, sub};
use crate::geom::Point;
use crate::tetra::Stars;

/// Items done in parallel between two reports of progress.
const BLOCK: usize = 1 << 18;

/// The rounded circumcentre of each cell, in lattice steps of the samples.
pub(super) fn centres(
    delaunay: &Delaunay,
    lattice: BallLattice,
    progress: &Portion,
) -> Result<Vec<Point>, Cancelled> {
    let cells = &delaunay.complex.cells;
    let mut centres = Vec::with_capacity(cells.len());
    for block in cells.chunks(BLOCK) {
        progress.advance(centres.len(), cells.len())?;
        let block = block.par_iter();
        centres.par_extend(block.map(|&cell| centre(delaunay, cell, lattice)));
    }
    Ok(centres)
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
///
/// Going through all cells in their order, each sample keeping the best so
/// far, would save the table of stars; it takes half as long again.
pub(super) fn select(
    delaunay: &Delaunay,
    stars: &Stars,
    centres: &[Point],
    options: &PoleOptions,
    progress: &Portion,
) -> Result<Chosen, Cancelled> {
    let count = delaunay.samples;
    let mut chosen = Chosen {
        cells: Vec::with_capacity(count),
        skinny_samples: 0,
        dropped: 0,
    };
    let (mut cells, mut dropped) = (Vec::new(), Vec::new());
    for from in (0..count).step_by(BLOCK) {
        progress.advance(from, count)?;
        let block = (from..count.min(from + BLOCK)).into_par_iter();
        let poles = block.map_init(Vec::new, |vertices: &mut Vec<Vertex>, s| {
            let site = delaunay.sites[s];
            let at = [site[0], site[1], site[2]];
            vertices.clear();
            let star = stars.at(s as u32).iter();
            vertices.extend(star.map(|&c| (centres[c as usize], c)));
            drop_misshapen(at, vertices, pair(at, vertices), options)
        });
        poles.unzip_into_vecs(&mut cells, &mut dropped);
        chosen.cells.extend_from_slice(&cells);
        chosen.skinny_samples += dropped.iter().filter(|&&n| n > 0).count() as u32;
        chosen.dropped += dropped.iter().sum::<u32>();
    }
    Ok(chosen)
}

/// A Voronoi vertex and its cell.
type Vertex = (Point, u32);

/// The two poles of a sample at `s` among its Voronoi vertices.
fn pair(s: Point, vertices: &[Vertex]) -> [Option<Vertex>; 2] {
    let Some(first) = farthest(s, vertices, |_| true) else {
        return [None; 2];
    };
    let normal = sub(first.0, s);
    let second = farthest(s, vertices, |centre| dot(sub(centre, s), normal) < 0.0);
    [Some(first), second]
}

#[inline]
fn farthest(s: Point, vertices: &[Vertex], ahead: impl Fn(Point) -> bool) -> Option<Vertex> {
    let mut best: Option<Vertex> = None;
    let mut reach = -1.0;
    for &(centre, c) in vertices {
        let distance = dist_sq(centre, s);
        if distance >= reach && ahead(centre) {
            let better = distance > reach || best.is_none_or(|b| centre < b.0);
            if better {
                best = Some((centre, c));
                reach = distance;
            }
        }
    }
    best
}

/// Applies the skinniness test; the second value counts the poles dropped.
fn drop_misshapen(
    s: Point,
    vertices: &[Vertex],
    poles: [Option<Vertex>; 2],
    options: &PoleOptions,
) -> ([u32; 2], u32) {
    let mut kept = poles.map(|p| p.map_or(NO_POLE, |(_, c)| c));
    let (Some(lambda), Some((first, _))) = (options.lambda, poles[0]) else {
        return (kept, 0);
    };
    let all = vertices.iter().map(|v| v.0);
    let bound = skinny::feature_size_bound(s, first, all, lambda);
    let fails = poles.map(|p| p.is_some_and(|(centre, _)| dist_sq(centre, s) < bound * bound));
    let mut dropped = 0;
    for k in 0..2 {
        if fails[k] || (options.sharp && (fails[0] || fails[1])) {
            dropped += u32::from(kept[k] != NO_POLE);
            kept[k] = NO_POLE;
        }
    }
    (kept, dropped)
}
