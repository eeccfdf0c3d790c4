//! Incremental construction in passes, each on as many threads as pay.
//!
//! Sites are inserted in rounds of growing size, each along the curve
//! (BRIO: [`super::order`]). Small rounds take one thread. A large round is a
//! **pass** of all threads: the curve is cut into stretches of equally many
//! sites, one for each thread, which leaves for later
//! what would touch the cells another one holds ([`super::region`]). What was left joins the
//! next round; after the last, further passes take most of it, and
//! one thread the rest. The triangulation is unique and its cells are
//! numbered by what they are ([`super::number`]), so nothing of this shows.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use super::cavity::{Outcome, Worker};
use super::complex::{Complex, MOST_CELLS, NONE};
use super::number::number;
use super::order;
use super::region::{Hold, Regions};
use super::store::{Cell, Store};
use super::walk::walk;
use super::{frame, Conflict};
use crate::context::{Cancelled, Context, Stage};
use crate::error::Error;
use crate::predicates::{Counts, Site};

/// Sites inserted between two reports of progress.
const REPORT: usize = 4096;

/// Sites to come for each thread from which a pass is shared.
const SHARE: usize = 2048;

/// Slots for each thread beyond those that its sites should take.
const SLACK: usize = 1024;

/// Slots that a site should take where nothing is known yet.
const FIRST: usize = 8;

/// Walks on which a thread looks for a cell to start from.
const TRIES: usize = 8;

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
/// `count..count + 8`. Any numbering gives the same cells; number the sites
/// along a space-filling curve ([`super::order`]) for speed.
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
    grow(test, count, MOST_CELLS, SHARE, stage, context)
}

/// [`triangulate`] within a number of cells, sharing passes of so many sites
/// a thread.
fn grow<C: Conflict>(
    test: &C,
    count: u32,
    most: usize,
    share: usize,
    stage: Stage,
    context: &Context,
) -> Result<Triangulation, Error> {
    let mut counts = Counts::default();
    let start = frame::frame(test, count, &mut counts);
    let mut growth = Growth::new(test, &start, most, count, stage, context);
    let threads = rayon::current_num_threads();
    let shared = |sites: &[u32]| threads > 1 && sites.len() >= share * threads;
    let mut left = Vec::new();
    for round in by_round(&test.sites()[..count as usize]) {
        left.extend(round);
        let sites = std::mem::take(&mut left);
        if shared(&sites) {
            left = growth.pass(sites, threads)?;
        } else {
            growth.alone(&sites)?;
        }
    }
    while shared(&left) {
        left = growth.pass(left, threads)?;
    }
    growth.alone(&left)?;
    growth.finish(counts)
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
    let mut growth = Growth::new(
        test,
        &complex,
        MOST_CELLS,
        more.len() as u32,
        stage,
        context,
    );
    drop(complex);
    growth.alone(&more.collect::<Vec<u32>>())?;
    growth.finish(Counts::default())
}

/// Ids by round, each round ascending.
fn by_round(sites: &[Site]) -> Vec<Vec<u32>> {
    let rounds = order::rounds(sites.len());
    let of: Vec<u32> = sites.par_iter().map(|s| order::round(s, rounds)).collect();
    let mut by_round = vec![Vec::new(); rounds as usize];
    for (id, &round) in (0u32..).zip(&of) {
        by_round[round as usize].push(id);
    }
    by_round
}

/// The state between passes.
struct Growth<'a, C: Conflict> {
    test: &'a C,
    store: Store,
    /// The first serves alone, too.
    workers: Vec<Worker>,
    /// A cell in use.
    hint: u32,
    /// Sites to insert.
    count: u32,
    report: Report<'a>,
}

impl<'a, C: Conflict> Growth<'a, C> {
    fn new(
        test: &'a C,
        start: &Complex,
        most: usize,
        count: u32,
        stage: Stage,
        context: &'a Context,
    ) -> Growth<'a, C> {
        Growth {
            test,
            store: Store::of(start, most),
            workers: vec![Worker::new(test.sites().len())],
            hint: 0,
            count,
            report: Report {
                done: AtomicU64::new(0),
                total: u64::from(count),
                stopped: AtomicBool::new(false),
                stage,
                context,
            },
        }
    }

    /// Inserts sites on one thread.
    fn alone(&mut self, sites: &[u32]) -> Result<(), Error> {
        self.store.reserve(sites.len().saturating_mul(self.each()));
        let mut from = 0;
        while from < sites.len() {
            let worker = &mut self.workers[0];
            worker.hint = self.hint;
            worker.free = std::mem::take(&mut self.store.free);
            let cells = &self.store.cells;
            let regions = Regions::new(0);
            let hold = &mut Hold::new(&regions, 0);
            from += run::<C, false>(self.test, cells, worker, hold, &sites[from..], &self.report)?;
            self.hint = worker.hint;
            self.store.free = std::mem::take(&mut worker.free);
            let wanted = std::mem::take(&mut worker.wanted);
            if wanted > 0 {
                // More than that if there may be more.
                let _ = self.store.provide(self.store.cells.len() / 16);
                self.store.provide(wanted)?;
            }
        }
        Ok(())
    }

    /// Slots that a site to come should take: as many as up to now, and a quarter more.
    fn each(&self) -> usize {
        match self.report.done.load(Relaxed) as usize {
            0 => FIRST,
            done => (self.store.live() / done + 1) * 5 / 4,
        }
    }

    /// Inserts sites on several threads; returns those left, at most half of
    /// them.
    fn pass(&mut self, mut sites: Vec<u32>, threads: usize) -> Result<Vec<u32>, Error> {
        // Those left before come first: two runs.
        sites.sort();
        while self.workers.len() < threads {
            self.workers.push(Worker::new(self.test.sites().len()));
        }
        let _ = (self.store).provide(sites.len() * self.each() + threads * SLACK);
        let share = self.store.free.len() / threads;
        let regions = Regions::new(self.count);
        let mut jobs = Vec::new();
        for (k, worker) in self.workers.iter_mut().enumerate() {
            let sites = &sites[sites.len() * k / threads..sites.len() * (k + 1) / threads];
            let mut hold = Hold::new(&regions, k);
            let (test, cells) = (self.test, &self.store.cells);
            worker.hint = enter(test, cells, &mut hold, sites, &mut self.hint, worker);
            let kept = self.store.free.len() - share;
            worker.free = self.store.free.split_off(kept);
            jobs.push((sites, worker, hold));
        }
        let (test, cells, report) = (self.test, &self.store.cells, &self.report);
        let work = |(sites, worker, mut hold): (&[u32], &mut Worker, Hold)| {
            let done = match worker.hint {
                NONE => 0,
                _ => run::<C, true>(test, cells, worker, &mut hold, sites, report)?,
            };
            worker.left.extend_from_slice(&sites[done..]);
            // The others have moved on since.
            let mut before = sites.len();
            while !worker.left.is_empty() && worker.left.len() <= before / 2 && worker.wanted == 0 {
                let again = std::mem::take(&mut worker.left);
                let done = run::<C, true>(test, cells, worker, &mut hold, &again, report)?;
                worker.left.extend_from_slice(&again[done..]);
                before = again.len();
            }
            hold.release(&[]);
            Ok(())
        };
        jobs.into_par_iter()
            .with_max_len(1)
            .map(work)
            .collect::<Result<(), Cancelled>>()?;
        let mut left = Vec::new();
        for worker in &mut self.workers {
            if worker.hint != NONE {
                self.hint = worker.hint;
            }
            worker.wanted = 0;
            left.append(&mut worker.left);
            self.store.free.append(&mut worker.free);
        }
        if left.len() > sites.len() / 2 {
            self.alone(&std::mem::take(&mut left))?;
        }
        Ok(left)
    }

    fn finish(mut self, mut counts: Counts) -> Result<Triangulation, Error> {
        self.report.at_end()?;
        let mut hidden = Vec::new();
        for worker in &mut self.workers {
            hidden.append(&mut worker.hidden);
            counts += worker.counts;
        }
        hidden.sort_unstable();
        drop(self.workers);
        Ok(Triangulation {
            complex: number(self.store, self.test.sites().len()),
            hidden,
            counts,
        })
    }
}

/// A cell for a worker to start from, with the regions of its vertices, or
/// [`NONE`]. Moves the hint to where the search ended.
fn enter<C: Conflict>(
    test: &C,
    cells: &[Cell],
    hold: &mut Hold,
    sites: &[u32],
    hint: &mut u32,
    worker: &mut Worker,
) -> u32 {
    for &p in sites.iter().step_by(sites.len() / TRIES + 1) {
        let found = walk(
            test.sites(),
            &test.sites()[p as usize],
            *hint,
            |c| cells[c as usize].vertices(),
            |c, i| cells[c as usize].neighbour(i),
            |_, _, _| true,
            &mut worker.counts,
        );
        let (Ok(cell) | Err(cell)) = found;
        *hint = cell;
        if cells[cell as usize]
            .vertices()
            .iter()
            .all(|&v| hold.take(v))
        {
            return cell;
        }
        hold.release(&[]);
    }
    NONE
}

/// Inserts sites one after the other; returns how many it came to before it
/// wanted more slots.
fn run<C: Conflict, const SHARED: bool>(
    test: &C,
    cells: &[Cell],
    worker: &mut Worker,
    hold: &mut Hold,
    sites: &[u32],
    report: &Report,
) -> Result<usize, Cancelled> {
    let mut dealt_with = 0;
    for (k, &p) in sites.iter().enumerate() {
        if k.is_multiple_of(REPORT) {
            report.add(std::mem::take(&mut dealt_with))?;
        }
        let next = sites.get(k + 1).copied().unwrap_or(p);
        let outcome = worker.insert::<C, SHARED>(test, cells, hold, p, next);
        let needed = |worker: &Worker| cells[worker.hint as usize].vertices();
        match outcome {
            Outcome::Placed | Outcome::Hidden => {
                dealt_with += 1;
                if SHARED {
                    hold.release_many(|| needed(worker));
                }
            }
            Outcome::GivenUp => {
                worker.left.push(p);
                hold.release(&needed(worker));
                // Whoever holds the region may wait for this very core.
                std::thread::yield_now();
            }
            Outcome::Starved(wanted) => {
                worker.wanted = wanted;
                report.add(dealt_with)?;
                return Ok(k);
            }
        }
    }
    report.add(dealt_with)?;
    Ok(sites.len())
}

/// Progress of all threads together.
struct Report<'a> {
    done: AtomicU64,
    total: u64,
    stopped: AtomicBool,
    stage: Stage,
    context: &'a Context<'a>,
}

impl Report<'_> {
    /// So many sites more; an error once anyone has been told to stop.
    fn add(&self, sites: u64) -> Result<(), Cancelled> {
        let done = self.done.fetch_add(sites, Relaxed) + sites;
        let told = self.context.advance(self.stage, done, self.total);
        if told.is_err() {
            self.stopped.store(true, Relaxed);
        }
        if self.stopped.load(Relaxed) {
            return Err(Cancelled);
        }
        Ok(())
    }

    fn at_end(&self) -> Result<(), Cancelled> {
        self.context.advance(self.stage, self.total, self.total)
    }
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
        grow(&InSphere(sites), count, most, SHARE, stage, &context)
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
        assert_eq!(super::super::unpack(last), (MOST_CELLS as u32 - 1, 3));
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
