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
    /// Those dropped, by sample.
    pub dropped: Vec<DroppedPole>,
}

/// Why a pole was dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Reason {
    /// It is nearer to its sample than the skinniness bound allows (section 6.1).
    Skinny,
    /// The other pole of its sample is, and both go (section 6.2).
    Sharp,
    /// Its sample lies at a sharp edge, as its neighbours tell
    /// ([`crate::options::SharpOption::Auto`]). There is no bound: it is 0.
    Corner,
}

/// A pole that was dropped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DroppedPole {
    /// The sample whose pole it was.
    pub sample: u32,
    /// 1 for the first pole of the sample, 2 for the second.
    pub pole: u8,
    /// Where it lies.
    pub centre: Point,
    /// Its distance from the sample.
    pub radius: f64,
    /// The lower bound on the local feature size that it was held against; 0
    /// where it was against none.
    pub bound: f64,
    /// Why it was dropped.
    pub reason: Reason,
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
        dropped: Vec::new(),
    };
    let mut found = Vec::new();
    for from in (0..count).step_by(BLOCK) {
        progress.advance(from, count)?;
        let block = (from..count.min(from + BLOCK)).into_par_iter();
        let poles = block.map_init(Vec::new, |vertices: &mut Vec<Vertex>, s| {
            let site = delaunay.sites[s];
            let at = [site[0], site[1], site[2]];
            vertices.clear();
            let star = stars.at(s as u32).iter();
            vertices.extend(star.map(|&c| (centres[c as usize], c)));
            let poles = pair(at, vertices);
            let cells = poles.map(|p| p.map_or(NO_POLE, |(_, c)| c));
            match options.bound.of(s) {
                Some(lambda) => held_to(lambda, options.sharp, s as u32, at, vertices, poles),
                None => (cells, None),
            }
        });
        poles.collect_into_vec(&mut found);
        chosen.cells.extend(found.iter().map(|f| f.0));
        let dropped = found.iter().filter_map(|f| f.1.as_deref());
        chosen.dropped.extend(dropped.flatten().flatten());
    }
    Ok(chosen)
}

/// A Voronoi vertex and its cell.
type Vertex = (Point, u32);

/// The poles of one sample that were dropped; few samples have any.
type Gone = Option<Box<[Option<DroppedPole>; 2]>>;

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

/// Applies the skinniness test to the poles of a sample: those that stay, as
/// cells, and those that go.
fn held_to(
    lambda: f64,
    sharp: bool,
    sample: u32,
    s: Point,
    vertices: &[Vertex],
    poles: [Option<Vertex>; 2],
) -> ([u32; 2], Gone) {
    let mut kept = poles.map(|p| p.map_or(NO_POLE, |(_, c)| c));
    let mut dropped = [None; 2];
    let Some((first, _)) = poles[0] else {
        return (kept, None);
    };
    let all = vertices.iter().map(|v| v.0);
    let bound = skinny::feature_size_bound(s, first, all, lambda);
    let fails = poles.map(|p| p.is_some_and(|(centre, _)| dist_sq(centre, s) < bound * bound));
    for k in 0..2 {
        let reason = match fails[k] {
            true => Reason::Skinny,
            false if sharp && fails[1 - k] => Reason::Sharp,
            false => continue,
        };
        dropped[k] = poles[k].map(|(centre, _)| DroppedPole {
            sample,
            pole: k as u8 + 1,
            centre,
            radius: dist_sq(centre, s).sqrt(),
            bound,
            reason,
        });
        kept[k] = NO_POLE;
    }
    let any = dropped.iter().any(Option::is_some);
    (kept, any.then(|| Box::new(dropped)))
}
