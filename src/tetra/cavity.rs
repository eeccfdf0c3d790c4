//! Replacing the cells that conflict with a site by the star of the site: the
//! only place where the complex changes.
//!
//! The cavity is found depth first over neighbours. Each of its boundary
//! facets becomes a cell with the new site; two of these meet in a facet for
//! every edge of the boundary, found through a small table over the boundary's
//! vertices numbered locally (Marot, Pellerin, Remacle 2019), or by sorting
//! the edges where the boundary is large.

use super::complex::{pack, unpack, FACETS, MOST_CELLS, NONE};
use super::Conflict;
use crate::error::Error;
use crate::predicates::Counts;

/// Boundary vertices up to which the table serves.
const TABLE: usize = 64;

/// The growing complex and the scratch memory of insertions.
pub(super) struct Workspace {
    pub cells: Vec<[u32; 4]>,
    pub neighbours: Vec<[u32; 4]>,
    /// `tick` on cells found in conflict, `tick + 1` on cells found clear.
    stamps: Vec<u32>,
    tick: u32,
    free: Vec<u32>,
    stack: Vec<u32>,
    cavity: Vec<u32>,
    /// Packed facets of conflicting cells that face clear ones.
    boundary: Vec<u32>,
    /// Local number of each boundary vertex, [`NONE`] elsewhere.
    local: Vec<u32>,
    numbered: Vec<u32>,
    table: Vec<u32>,
    edges: Vec<(u64, u32)>,
    /// Vertices that lost all their cells (regular triangulations only).
    pub hidden: Vec<u32>,
    /// Cells there may be: [`MOST_CELLS`], fewer in tests.
    pub most: usize,
}

impl Workspace {
    pub fn new(vertices: usize, cells: Vec<[u32; 4]>, neighbours: Vec<[u32; 4]>) -> Workspace {
        Workspace {
            stamps: vec![0; cells.len()],
            cells,
            neighbours,
            tick: 2,
            free: Vec::new(),
            stack: Vec::new(),
            cavity: Vec::new(),
            boundary: Vec::new(),
            local: vec![NONE; vertices],
            numbered: Vec::new(),
            table: vec![NONE; TABLE * TABLE],
            edges: Vec::new(),
            hidden: Vec::new(),
            most: MOST_CELLS,
        }
    }

    /// Whether a cell slot is unused.
    pub fn free_slots(&self) -> &[u32] {
        &self.free
    }

    /// Inserts site `p`, which lies in cell `start` (its boundary included);
    /// returns a cell at `p`, or `None` if `p` is hidden.
    ///
    /// # Errors
    /// [`Error::TooLarge`] when the star of `p` would not fit; nothing has
    /// changed then.
    #[inline]
    pub fn insert<C: Conflict>(
        &mut self,
        test: &C,
        p: u32,
        start: u32,
        counts: &mut Counts,
    ) -> Result<Option<u32>, Error> {
        if !test.conflicts(self.cells[start as usize], p, counts) {
            debug_assert!(C::WEIGHTED, "a point in a cell lies in its sphere");
            self.hidden.push(p);
            return Ok(None);
        }
        self.dig(test, p, start, counts);
        self.has_room()?;
        self.number();
        if C::WEIGHTED {
            self.bury();
        }
        let last = self.fill(p);
        for &v in &self.numbered {
            self.local[v as usize] = NONE;
        }
        self.free.extend_from_slice(&self.cavity);
        Ok(Some(last))
    }

    /// Whether a cell for each facet of the boundary fits.
    #[inline]
    fn has_room(&self) -> Result<(), Error> {
        let slots = self
            .cells
            .len()
            .max((self.cells.len() + self.boundary.len()).saturating_sub(self.free.len()));
        if slots > self.most {
            return Err(Error::TooLarge {
                what: "the triangulation (its cells)",
                count: slots as u64,
                limit: self.most as u64,
            });
        }
        Ok(())
    }

    /// Finds the conflicting cells and their boundary.
    #[inline]
    fn dig<C: Conflict>(&mut self, test: &C, p: u32, start: u32, counts: &mut Counts) {
        if self.tick > u32::MAX - 4 {
            self.stamps.fill(0);
            self.tick = 0;
        }
        self.tick += 2;
        let tick = self.tick;
        self.cavity.clear();
        self.boundary.clear();
        self.stack.clear();
        self.stack.push(start);
        self.stamps[start as usize] = tick;
        while let Some(c) = self.stack.pop() {
            self.cavity.push(c);
            let behind = self.neighbours[c as usize];
            for (i, &packed) in behind.iter().enumerate() {
                if packed == NONE {
                    self.boundary.push(pack(c, i));
                    continue;
                }
                let (d, _) = unpack(packed);
                let stamp = &mut self.stamps[d as usize];
                if *stamp == tick {
                    continue;
                }
                if *stamp != tick + 1 {
                    if test.conflicts(self.cells[d as usize], p, counts) {
                        *stamp = tick;
                        self.stack.push(d);
                        continue;
                    }
                    *stamp = tick + 1;
                }
                self.boundary.push(pack(c, i));
            }
        }
    }

    /// Numbers the vertices of the boundary.
    #[inline]
    fn number(&mut self) {
        self.numbered.clear();
        for &packed in &self.boundary {
            let (c, i) = unpack(packed);
            let cell = self.cells[c as usize];
            for k in FACETS[i] {
                let local = &mut self.local[cell[k] as usize];
                if *local == NONE {
                    *local = self.numbered.len() as u32;
                    self.numbered.push(cell[k]);
                }
            }
        }
    }

    /// Records the vertices inside the cavity: their cells are all gone.
    #[inline]
    fn bury(&mut self) {
        // A cavity with b boundary facets, all of whose vertices are on the
        // boundary, has no fixed number of cells in three dimensions: look.
        let before = self.numbered.len();
        for &c in &self.cavity {
            for v in self.cells[c as usize] {
                if self.local[v as usize] == NONE {
                    self.local[v as usize] = 0;
                    self.numbered.push(v);
                    self.hidden.push(v);
                }
            }
        }
        for &v in &self.numbered[before..] {
            self.local[v as usize] = NONE;
        }
        self.numbered.truncate(before);
    }

    /// Makes the star of `p`; returns its last cell.
    #[inline]
    fn fill(&mut self, p: u32) -> u32 {
        let small = self.numbered.len() <= TABLE;
        self.edges.clear();
        let mut last = NONE;
        // The boundary list is reused for the packed new facets.
        for at in 0..self.boundary.len() {
            let (c, i) = unpack(self.boundary[at]);
            let mut cell = self.cells[c as usize];
            let corners = FACETS[i];
            let locals = corners.map(|k| self.local[cell[k] as usize]);
            let outer = self.neighbours[c as usize][i];
            cell[i] = p;
            let new = match self.free.pop() {
                Some(slot) => slot,
                None => {
                    self.cells.push([NONE; 4]);
                    self.neighbours.push([NONE; 4]);
                    self.stamps.push(0);
                    (self.cells.len() - 1) as u32
                }
            };
            self.cells[new as usize] = cell;
            self.neighbours[new as usize][i] = outer;
            self.stamps[new as usize] = 0;
            if outer != NONE {
                let (d, j) = unpack(outer);
                self.neighbours[d as usize][j] = pack(new, i);
            }
            if small {
                for m in 0..3 {
                    let (u, v) = (locals[(m + 1) % 3], locals[(m + 2) % 3]);
                    self.table[u as usize * TABLE + v as usize] = pack(new, corners[m]);
                }
            } else {
                for m in 0..3 {
                    let (u, v) = (locals[(m + 1) % 3] as u64, locals[(m + 2) % 3] as u64);
                    let key = u.min(v) << 32 | u.max(v);
                    self.edges.push((key, pack(new, corners[m])));
                }
            }
            self.boundary[at] = pack(new, i);
            last = new;
        }
        if small {
            for &packed in &self.boundary {
                let (c, i) = unpack(packed);
                let cell = self.cells[c as usize];
                let corners = FACETS[i];
                let locals = corners.map(|k| self.local[cell[k] as usize]);
                for m in 0..3 {
                    let (u, v) = (locals[(m + 1) % 3], locals[(m + 2) % 3]);
                    self.neighbours[c as usize][corners[m]] =
                        self.table[v as usize * TABLE + u as usize];
                }
            }
        } else {
            self.edges.sort_unstable();
            for pair in self.edges.chunks_exact(2) {
                let (c, i) = unpack(pair[0].1);
                let (d, j) = unpack(pair[1].1);
                self.neighbours[c as usize][i] = pack(d, j);
                self.neighbours[d as usize][j] = pack(c, i);
            }
        }
        last
    }
}
