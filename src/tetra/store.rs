//! The growing complex, shared by the threads that insert.
//!
//! Vertices and neighbours of a cell lie side by side in half a cache line.
//! They are atomics, read and written without any order among them: plain
//! moves on today's processors. Which thread may touch what is the business
//! of [`super::region`].

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use super::complex::{Complex, NONE};
use crate::error::Error;

/// Where a vertex word holds the mark of the cell under work; see
/// [`super::cavity`]. Vertex ids stay below it.
pub(super) const MARKS: u32 = 3 << 30;

/// A cell; the mark lives in the top bits of its first vertex.
#[repr(align(32))]
pub(super) struct Cell {
    vertices: [AtomicU32; 4],
    neighbours: [AtomicU32; 4],
}

impl Cell {
    fn new(v: [u32; 4], n: [u32; 4]) -> Cell {
        Cell {
            vertices: v.map(AtomicU32::new),
            neighbours: n.map(AtomicU32::new),
        }
    }

    /// The first vertex together with the mark.
    #[inline]
    pub fn marked(&self) -> u32 {
        self.vertices[0].load(Relaxed)
    }

    /// Replaces the first vertex and the mark.
    #[inline]
    pub fn mark(&self, marked: u32) {
        self.vertices[0].store(marked, Relaxed);
    }

    /// The vertices, without the mark.
    #[inline]
    pub fn vertices(&self) -> [u32; 4] {
        let [a, b, c, d] = &self.vertices;
        [
            a.load(Relaxed) & !MARKS,
            b.load(Relaxed),
            c.load(Relaxed),
            d.load(Relaxed),
        ]
    }

    /// Vertex `k`, without the mark.
    #[inline]
    pub fn vertex(&self, k: usize) -> u32 {
        let v = self.vertices[k].load(Relaxed);
        if k == 0 {
            v & !MARKS
        } else {
            v
        }
    }

    /// The packed facets behind its facets.
    #[inline]
    pub fn neighbours(&self) -> [u32; 4] {
        let [a, b, c, d] = &self.neighbours;
        [
            a.load(Relaxed),
            b.load(Relaxed),
            c.load(Relaxed),
            d.load(Relaxed),
        ]
    }

    /// What lies behind facet `i`.
    #[inline]
    pub fn neighbour(&self, i: usize) -> u32 {
        self.neighbours[i].load(Relaxed)
    }

    /// Replaces the vertices and takes the mark off.
    #[inline]
    pub fn set_vertices(&self, v: [u32; 4]) {
        for k in 0..4 {
            self.vertices[k].store(v[k], Relaxed);
        }
    }

    /// Sets what lies behind facet `i`.
    #[inline]
    pub fn set_neighbour(&self, i: usize, packed: u32) {
        self.neighbours[i].store(packed, Relaxed);
    }
}

/// All cell slots, and which of them are unused.
pub(super) struct Store {
    /// The slots.
    pub cells: Vec<Cell>,
    /// Unused ones; the last is taken first.
    pub free: Vec<u32>,
    /// Slots there may be.
    pub most: usize,
}

impl Store {
    /// A store of the cells of a complex.
    pub fn of(complex: &Complex, most: usize) -> Store {
        let pairs = complex.cells.iter().zip(&complex.neighbours);
        Store {
            cells: pairs.map(|(&v, &n)| Cell::new(v, n)).collect(),
            free: Vec::new(),
            most,
        }
    }

    /// Cells in use.
    pub fn live(&self) -> usize {
        self.cells.len() - self.free.len()
    }

    /// Makes room for so many slots to come without taking it into use: growing a table of
    /// aligned cells copies it. Where there is no such room, it will grow.
    pub fn reserve(&mut self, slots: usize) {
        let wanted = slots.saturating_sub(self.free.len());
        let room = wanted.min(self.most.saturating_sub(self.cells.len()));
        let _ = self.cells.try_reserve_exact(room);
    }

    /// Sees to it that `wanted` slots are unused.
    ///
    /// # Errors
    /// [`Error::TooLarge`] where [`Store::most`] is in the way; there are as many as
    /// it allows then.
    pub fn provide(&mut self, wanted: usize) -> Result<(), Error> {
        let old = self.cells.len();
        let asked = old + wanted.saturating_sub(self.free.len());
        let new = asked.min(self.most).max(old);
        if new > self.cells.capacity() {
            let quarter = (self.cells.capacity() / 4).min(self.most - new);
            self.cells.reserve_exact(new - old + quarter);
        }
        self.cells
            .resize_with(new, || Cell::new([NONE; 4], [NONE; 4]));
        self.free.splice(0..0, (old as u32..new as u32).rev());
        if asked > new {
            return Err(Error::TooLarge {
                what: "the triangulation (its cells)",
                count: asked as u64,
                limit: self.most as u64,
            });
        }
        Ok(())
    }
}
