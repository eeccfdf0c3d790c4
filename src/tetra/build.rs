//! Incremental construction: walk to the site, replace what conflicts.

use std::ops::Range;

use super::cavity::Workspace;
use super::complex::{unpack, Complex, MOST_CELLS, NONE};
use super::{frame, Conflict};
use crate::context::{Context, Stage};
use crate::error::Error;
use crate::predicates::{orient, Counts, Sign, Site};

/// Sites inserted between two reports of progress.
const REPORT: u32 = 4096;

/// A finished triangulation.
#[derive(Clone, Debug, Default)]
pub struct Triangulation {
    /// Its cells; vertices are site ids, the frame's among them.
    pub complex: Complex,
    /// Sites without cells, ascending.
    pub hidden: Vec<u32>,
    /// How its decisions were taken.
    pub counts: Counts,
}

/// Triangulates the sites `0..count` of `test` inside the frame of the sites
/// `count..count + 8`. Sites are inserted in the order of their ids: number
/// them along a space-filling curve ([`super::order`]).
///
/// # Errors
/// [`Error::Cancelled`], and [`Error::TooLarge`] beyond [`super::MOST_CELLS`]
/// cells: 160 million sites in general position, 65 thousand on two skew
/// lines.
pub fn triangulate<C: Conflict>(
    test: &C,
    count: u32,
    stage: Stage,
    context: &Context,
) -> Result<Triangulation, Error> {
    grow(test, count, MOST_CELLS, stage, context)
}

/// [`triangulate`] within a number of cells.
fn grow<C: Conflict>(
    test: &C,
    count: u32,
    most: usize,
    stage: Stage,
    context: &Context,
) -> Result<Triangulation, Error> {
    let mut counts = Counts::default();
    let start = frame::frame(test, count, &mut counts);
    let mut work = Workspace::new(count as usize + 8, start.cells, start.neighbours);
    work.most = most;
    insert(test, work, 0..count, counts, stage, context)
}

/// Inserts the sites `more` of `test` into a complex of other sites of it.
///
/// # Errors
/// Those of [`triangulate`].
pub fn extend<C: Conflict>(
    test: &C,
    complex: Complex,
    more: Range<u32>,
    stage: Stage,
    context: &Context,
) -> Result<Triangulation, Error> {
    let work = Workspace::new(test.sites().len(), complex.cells, complex.neighbours);
    insert(test, work, more, Counts::default(), stage, context)
}

fn insert<C: Conflict>(
    test: &C,
    mut work: Workspace,
    sites: Range<u32>,
    mut counts: Counts,
    stage: Stage,
    context: &Context,
) -> Result<Triangulation, Error> {
    let (first, total) = (sites.start, sites.len() as u64);
    let mut hint = 0;
    for p in sites {
        if (p - first).is_multiple_of(REPORT) {
            context.advance(stage, (p - first) as u64, total)?;
        }
        let site = &test.sites()[p as usize];
        let cell = walk(
            test.sites(),
            &work.cells,
            &work.neighbours,
            hint,
            site,
            &mut counts,
        );
        hint = work.insert(test, p, cell, &mut counts)?.unwrap_or(cell);
    }
    context.advance(stage, total, total)?;
    let mut hidden = std::mem::take(&mut work.hidden);
    hidden.sort_unstable();
    Ok(Triangulation {
        complex: compact(work),
        hidden,
        counts,
    })
}

/// The cell of a complex that holds a site (its boundary included); the site
/// must lie inside the frame.
pub fn locate(
    complex: &Complex,
    sites: &[Site],
    site: &Site,
    hint: u32,
    counts: &mut Counts,
) -> u32 {
    walk(
        sites,
        &complex.cells,
        &complex.neighbours,
        hint,
        site,
        counts,
    )
}

/// The visibility walk: cross any facet that separates the site from the
/// cell. In a regular triangulation, with exact signs, it cannot go round in
/// circles (Edelsbrunner 1990).
#[inline]
fn walk(
    sites: &[Site],
    cells: &[[u32; 4]],
    neighbours: &[[u32; 4]],
    hint: u32,
    site: &Site,
    counts: &mut Counts,
) -> u32 {
    let mut at = hint;
    let mut from = NONE;
    'cell: loop {
        let corners = cells[at as usize].map(|v| &sites[v as usize]);
        let behind = neighbours[at as usize];
        for i in 0..4 {
            let next = behind[i];
            if next == NONE || next >> 2 == from {
                continue;
            }
            let mut c = corners;
            c[i] = site;
            if orient(c[0], c[1], c[2], c[3], counts) == Sign::Negative {
                from = at;
                at = unpack(next).0;
                continue 'cell;
            }
        }
        return at;
    }
}

/// Drops unused cell slots.
fn compact(work: Workspace) -> Complex {
    let mut dead = vec![false; work.cells.len()];
    for &c in work.free_slots() {
        dead[c as usize] = true;
    }
    let mut renumbered = vec![NONE; work.cells.len()];
    let mut live = 0;
    for (c, &gone) in dead.iter().enumerate() {
        if !gone {
            renumbered[c] = live;
            live += 1;
        }
    }
    let Workspace {
        mut cells,
        mut neighbours,
        ..
    } = work;
    for c in 0..cells.len() {
        if dead[c] {
            continue;
        }
        let to = renumbered[c] as usize;
        cells[to] = cells[c];
        neighbours[to] = neighbours[c].map(|packed| {
            if packed == NONE {
                NONE
            } else {
                renumbered[(packed >> 2) as usize] << 2 | (packed & 3)
            }
        });
    }
    cells.truncate(live as usize);
    neighbours.truncate(live as usize);
    cells.shrink_to_fit();
    neighbours.shrink_to_fit();
    Complex { cells, neighbours }
}

#[cfg(test)]
mod tests {
    use super::super::InSphere;
    use super::*;
    use crate::predicates::Site;

    /// Two skew lines inside a frame: cells as the square of the sites.
    fn skew_lines(count: i32) -> Vec<Site> {
        let mut sites: Vec<Site> = (0..count)
            .flat_map(|k| [[k, 0, -9, 0], [0, k, 9, 0]])
            .map(|p| p.map(f64::from))
            .collect();
        let side = |k: i32, bit: i32| f64::from((k >> bit & 1) * 200 - 100);
        sites.extend((0..8).map(|k| [side(k, 0), side(k, 1), side(k, 2), 0.0]));
        sites
    }

    fn within(sites: &[Site], most: usize) -> Result<Triangulation, Error> {
        let count = sites.len() as u32 - 8;
        let (stage, context) = (Stage::Delaunay, Context::default());
        grow(&InSphere(sites), count, most, stage, &context)
    }

    #[test]
    fn too_many_cells_are_an_error_before_an_id_wraps() {
        let sites = skew_lines(20);
        let free = within(&sites, MOST_CELLS).unwrap();
        let cells = free.complex.len();
        assert!(cells > 400, "{cells}");
        match within(&sites, cells / 2) {
            Err(Error::TooLarge { count, limit, .. }) => {
                assert_eq!(limit, cells as u64 / 2);
                assert!(count > limit && count < limit + 100, "{count}");
            }
            other => panic!("{other:?}"),
        }
        // Slots in use may outnumber the cells at the end, not by much.
        assert_eq!(
            within(&sites, cells + 50).unwrap().complex.cells,
            free.complex.cells
        );
    }

    #[test]
    fn the_last_facet_fits_and_is_no_sentinel() {
        let last = super::super::pack(MOST_CELLS as u32 - 1, 3);
        assert_eq!(unpack(last), (MOST_CELLS as u32 - 1, 3));
        assert!(last < NONE);
    }

    #[test]
    fn breaking_off_stops_the_work() {
        struct Stop;
        impl crate::context::Progress for Stop {
            fn advance(&self, _: Stage, _: u64, _: u64) -> std::ops::ControlFlow<()> {
                std::ops::ControlFlow::Break(())
            }
        }
        let sites = skew_lines(4);
        let context = Context {
            threads: None,
            progress: &Stop,
        };
        let stopped = triangulate(&InSphere(&sites), 8, Stage::Delaunay, &context);
        assert_eq!(stopped.unwrap_err(), Error::Cancelled);
    }
}
