//! Incremental construction: walk to the site, replace what conflicts.

use std::ops::Range;

use super::cavity::Workspace;
use super::complex::{unpack, Complex, NONE};
use super::{frame, Conflict};
use crate::context::{Cancelled, Context, Stage};
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
pub fn triangulate<C: Conflict>(
    test: &C,
    count: u32,
    stage: Stage,
    context: &Context,
) -> Result<Triangulation, Cancelled> {
    let mut counts = Counts::default();
    let start = frame::frame(test, count, &mut counts);
    let work = Workspace::new(count as usize + 8, start.cells, start.neighbours);
    insert(test, work, 0..count, counts, stage, context)
}

/// Inserts the sites `more` of `test` into a complex of other sites of it.
pub fn extend<C: Conflict>(
    test: &C,
    complex: Complex,
    more: Range<u32>,
    stage: Stage,
    context: &Context,
) -> Result<Triangulation, Cancelled> {
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
) -> Result<Triangulation, Cancelled> {
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
        hint = work.insert(test, p, cell, &mut counts).unwrap_or(cell);
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
