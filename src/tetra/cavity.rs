//! One insertion: walk to the site, find what conflicts with it, put the star
//! of the site in its place. The only place where the complex changes.
//!
//! The cavity is found breadth first over neighbours; a mark on each cell says
//! what its test gave. Every facet of the cavity's boundary becomes a cell
//! with the new site; two of these meet in a facet for
//! every edge of the boundary, found through a small table over the boundary's
//! vertices numbered locally (Marot, Pellerin, Remacle 2019), or by sorting
//! the edges where the boundary is large.

use super::complex::{pack, unpack, FACETS, NONE};
use super::region::Hold;
use super::store::{Cell, MARKS};
use super::walk::walk;
use super::Conflict;
use crate::predicates::{distance_sq, Counts, Site};

/// Local numbers that are none: not on the boundary; on a large one.
const OFF: u8 = 255;
const ON: u8 = 254;

/// Boundary vertices up to which the table serves.
const TABLE: usize = ON as usize;

/// Marks of cells.
const CONFLICTING: u32 = 1 << 30;
const CLEAR: u32 = 2 << 30;

/// What came of an insertion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// The site has a star.
    Placed,
    /// No cell conflicts with the site.
    Hidden,
    /// Another thread is at work there; nothing has changed.
    GivenUp,
    /// So many slots are wanted and not there; nothing has changed.
    Starved(usize),
}

/// A facet of the boundary of a cavity.
struct Facet {
    /// The packed facet outside, or [`NONE`].
    outer: u32,
    /// Its corners, counterclockwise seen from inside the cavity reversed.
    corners: [u32; 3],
    /// Their local numbers.
    local: [u8; 3],
}

/// What one thread needs for insertions.
pub(super) struct Worker {
    /// Slots it may use.
    pub free: Vec<u32>,
    /// Where its next walk starts.
    pub hint: u32,
    /// Vertices that have no cells (regular triangulations only).
    pub hidden: Vec<u32>,
    /// Sites it gave up or did not come to.
    pub left: Vec<u32>,
    /// Slots it stopped for want of.
    pub wanted: usize,
    /// How its decisions were taken.
    pub counts: Counts,
    cavity: Vec<u32>,
    boundary: Vec<Facet>,
    /// Local number of each boundary vertex, [`OFF`] elsewhere.
    local: Vec<u8>,
    numbered: Vec<u32>,
    table: Vec<u32>,
    /// How far the numbered vertices are from the next site, squared.
    distances: Vec<f64>,
    edges: Vec<(u64, u32)>,
}

impl Worker {
    pub fn new(vertices: usize) -> Worker {
        Worker {
            free: Vec::new(),
            hint: 0,
            hidden: Vec::new(),
            left: Vec::new(),
            wanted: 0,
            counts: Counts::default(),
            cavity: Vec::new(),
            boundary: Vec::new(),
            local: vec![OFF; vertices],
            numbered: Vec::new(),
            table: vec![NONE; TABLE.next_power_of_two().pow(2)],
            distances: Vec::new(),
            edges: Vec::new(),
        }
    }

    /// Inserts site `p`, which must lie inside the frame; `next` comes after. If `SHARED`, other
    /// threads are at work too: the regions of the hint's vertices are held,
    /// before and after.
    #[inline]
    pub fn insert<C: Conflict, const SHARED: bool>(
        &mut self,
        test: &C,
        cells: &[Cell],
        hold: &mut Hold,
        p: u32,
        next: u32,
    ) -> Outcome {
        if SHARED && !hold.take(p) {
            return Outcome::GivenUp;
        }
        let found = walk(
            test.sites(),
            &test.sites()[p as usize],
            self.hint,
            |c| cells[c as usize].vertices(),
            |c, i| cells[c as usize].neighbour(i),
            |v, i, packed| !SHARED || enter(cells, hold, v, i, packed),
            &mut self.counts,
        );
        let (Ok(start) | Err(start)) = found;
        self.hint = start;
        if found.is_err() {
            return Outcome::GivenUp;
        }
        let at = cells[start as usize].vertices();
        // A point in a cell lies in its sphere.
        if C::WEIGHTED && !test.conflicts(at, p, &mut self.counts) {
            self.hidden.push(p);
            return Outcome::Hidden;
        }
        if !self.dig::<C, SHARED>(test, cells, hold, p, start) {
            self.fill_in(cells);
            return Outcome::GivenUp;
        }
        let wanted = self.boundary.len();
        if wanted > self.cavity.len() + self.free.len() {
            let missing = wanted - self.cavity.len();
            self.fill_in(cells);
            return Outcome::Starved(missing);
        }
        self.number();
        self.measure(test.sites(), next);
        let vertices = self.numbered.len();
        if C::WEIGHTED {
            self.bury(cells);
        }
        self.build(cells, p, vertices);
        for v in self.numbered.drain(..) {
            self.local[v as usize] = OFF;
        }
        Outcome::Placed
    }

    /// Finds the conflicting cells and their boundary; `false` if another
    /// thread is at work there. Leaves marks in either case.
    #[inline]
    fn dig<C: Conflict, const SHARED: bool>(
        &mut self,
        test: &C,
        cells: &[Cell],
        hold: &mut Hold,
        p: u32,
        start: u32,
    ) -> bool {
        self.cavity.clear();
        self.boundary.clear();
        let first = &cells[start as usize];
        first.mark(first.marked() | CONFLICTING);
        self.cavity.push(start);
        let mut at = 0;
        while at < self.cavity.len() {
            let cell = &cells[self.cavity[at] as usize];
            at += 1;
            let (vertices, behind) = (cell.vertices(), cell.neighbours());
            for i in 0..4 {
                let packed = behind[i];
                if packed != NONE {
                    let d = packed >> 2;
                    let next = &cells[d as usize];
                    if SHARED && !enter(cells, hold, vertices, i, packed) {
                        return false;
                    }
                    let marked = next.marked();
                    if marked & MARKS == CONFLICTING {
                        continue;
                    }
                    if marked & MARKS == 0 {
                        if test.conflicts(next.vertices(), p, &mut self.counts) {
                            next.mark(marked | CONFLICTING);
                            self.cavity.push(d);
                            approach(cells, next);
                            continue;
                        }
                        next.mark(marked | CLEAR);
                    }
                }
                let [a, b, c] = FACETS[i];
                self.boundary.push(Facet {
                    outer: packed,
                    corners: [vertices[a], vertices[b], vertices[c]],
                    local: [OFF; 3],
                });
            }
        }
        true
    }

    /// Takes all marks off again.
    #[cold]
    fn fill_in(&mut self, cells: &[Cell]) {
        for &c in &self.cavity {
            unmark(&cells[c as usize]);
        }
        for facet in self.boundary.iter().filter(|f| f.outer != NONE) {
            unmark(&cells[facet.outer as usize >> 2]);
        }
    }

    /// Numbers the vertices of the boundary.
    #[inline]
    fn number(&mut self) {
        for facet in &mut self.boundary {
            for k in 0..3 {
                let v = facet.corners[k];
                let local = &mut self.local[v as usize];
                if *local == OFF {
                    *local = self.numbered.len().min(ON as usize) as u8;
                    self.numbered.push(v);
                }
                facet.local[k] = *local;
            }
        }
    }

    /// Measures how far the numbered vertices are from the next site.
    #[inline]
    fn measure(&mut self, sites: &[Site], next: u32) {
        let next = &sites[next as usize];
        let squared = |&v: &u32| distance_sq(&sites[v as usize], next);
        self.distances.clear();
        self.distances.extend(self.numbered.iter().map(squared));
    }

    /// Records the vertices inside the cavity: their cells are all gone.
    #[inline]
    fn bury(&mut self, cells: &[Cell]) {
        // A cavity with b boundary facets, all of whose vertices are on the
        // boundary, has no fixed number of cells in three dimensions: look.
        for &c in &self.cavity {
            for v in cells[c as usize].vertices() {
                if self.local[v as usize] == OFF {
                    self.local[v as usize] = ON;
                    self.numbered.push(v);
                    self.hidden.push(v);
                }
            }
        }
    }

    /// Makes the star of `p`, in the slots of the cavity first. The next walk starts
    /// in the cell whose corners are nearest to the next site: stars may be large and
    /// their cells long.
    #[inline]
    fn build(&mut self, cells: &[Cell], p: u32, vertices: usize) {
        let small = vertices <= TABLE;
        let stride = vertices.next_power_of_two().max(16);
        let mut least = f64::INFINITY;
        self.edges.clear();
        // The list of the cavity becomes that of the star.
        let (dead, wanted) = (self.cavity.len(), self.boundary.len());
        if dead < wanted {
            let left = self.free.len() - (wanted - dead);
            self.cavity.extend(self.free.drain(left..).rev());
        } else {
            self.free.extend(self.cavity.drain(wanted..));
        }
        for (facet, &new) in self.boundary.iter().zip(&self.cavity) {
            let far = facet.local.map(|k| self.distances[k as usize]);
            let far = far[0] + far[1] + far[2];
            if far < least {
                least = far;
                self.hint = new;
            }
            let [a, b, c] = facet.corners;
            let cell = &cells[new as usize];
            cell.set_vertices([p, a, b, c]);
            cell.set_neighbour(0, facet.outer);
            if facet.outer != NONE {
                let (d, j) = unpack(facet.outer);
                let outer = &cells[d as usize];
                unmark(outer);
                outer.set_neighbour(j, pack(new, 0));
            }
            if small {
                let [a, b, c] = facet.local;
                let (a, b, c) = (a as usize, b as usize, c as usize);
                self.table[b * stride + c] = pack(new, 1);
                self.table[c * stride + a] = pack(new, 2);
                self.table[a * stride + b] = pack(new, 3);
            } else {
                for (i, (u, v)) in [(b, c), (c, a), (a, b)].into_iter().enumerate() {
                    let key = (u.min(v) as u64) << 32 | u.max(v) as u64;
                    self.edges.push((key, pack(new, i + 1)));
                }
            }
        }
        if small {
            for (facet, &new) in self.boundary.iter().zip(&self.cavity) {
                let [a, b, c] = facet.local;
                let (a, b, c) = (a as usize, b as usize, c as usize);
                let cell = &cells[new as usize];
                cell.set_neighbour(1, self.table[c * stride + b]);
                cell.set_neighbour(2, self.table[a * stride + c]);
                cell.set_neighbour(3, self.table[b * stride + a]);
            }
        } else {
            self.edges.sort_unstable();
            for pair in self.edges.chunks_exact(2) {
                let ((c, i), (d, j)) = (unpack(pair[0].1), unpack(pair[1].1));
                cells[c as usize].set_neighbour(i, pair[1].1);
                cells[d as usize].set_neighbour(j, pair[0].1);
            }
        }
    }
}

/// Reads ahead what lies behind a cell: it is looked at soon, and what takes
/// time in an insertion is waiting for memory.
#[inline]
fn approach(cells: &[Cell], cell: &Cell) {
    let mut read = 0;
    for packed in cell.neighbours() {
        if packed != NONE {
            read ^= cells[packed as usize >> 2].marked();
        }
    }
    std::hint::black_box(read);
}

/// Takes what it needs to read the cell behind a facet of a held one.
#[inline]
fn enter(cells: &[Cell], hold: &mut Hold, v: [u32; 4], i: usize, packed: u32) -> bool {
    // Behind a facet of the frame's corners alone lies another thread's cell.
    if FACETS[i].iter().all(|&k| hold.is_frame(v[k])) {
        return false;
    }
    let (d, j) = unpack(packed);
    hold.take(cells[d as usize].vertex(j))
}

/// Takes the mark off.
#[inline]
fn unmark(cell: &Cell) {
    cell.mark(cell.marked() & !MARKS);
}
