//! Cells and neighbours in flat arrays.
//!
//! Cell `c` has the vertices `cells[c]`, positively oriented. Its facet `i`
//! lies opposite vertex `i`; `neighbours[c][i]` names the same facet from the
//! other side, packed as `cell * 4 + facet`, or [`NONE`] on the hull of the
//! frame. Law: `neighbours` is an involution on packed facets.

/// 'No such thing' among 32-bit ids.
pub const NONE: u32 = u32::MAX;

/// Cells there may be: with one more, a packed facet would wrap or be
/// [`NONE`].
pub const MOST_CELLS: usize = (1 << 30) - 1;

/// The corners of facet `i`, such that `(i, FACETS[i]...)` is an even
/// permutation: counterclockwise seen from vertex `i`'s side reversed, the
/// same for all four.
pub const FACETS: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// Packs a cell and one of its facets into 32 bits.
#[inline]
pub fn pack(cell: u32, facet: usize) -> u32 {
    cell * 4 + facet as u32
}

/// The cell and the facet of a packed facet.
#[inline]
pub fn unpack(packed: u32) -> (u32, usize) {
    (packed >> 2, (packed & 3) as usize)
}

/// The facet of a cell that lies opposite the given vertex.
#[inline]
pub fn facet_of(cell: &[u32; 4], vertex: u32) -> usize {
    if cell[0] == vertex {
        0
    } else if cell[1] == vertex {
        1
    } else if cell[2] == vertex {
        2
    } else {
        debug_assert_eq!(cell[3], vertex);
        3
    }
}

/// A triangulation as cells and neighbours.
#[derive(Clone, Debug, Default)]
pub struct Complex {
    /// The four vertices of each cell.
    pub cells: Vec<[u32; 4]>,
    /// The packed facet behind each facet of each cell.
    pub neighbours: Vec<[u32; 4]>,
}

impl Complex {
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// One cell at each vertex, or [`NONE`] for vertices without cells.
    pub fn cell_at_vertex(&self, vertices: usize) -> Vec<u32> {
        let mut at = vec![NONE; vertices];
        for (c, cell) in self.cells.iter().enumerate() {
            for &v in cell {
                at[v as usize] = c as u32;
            }
        }
        at
    }

    /// Violations of the law of neighbours, as packed facets.
    pub fn check(&self) -> Vec<u32> {
        let mut bad = Vec::new();
        for c in 0..self.cells.len() as u32 {
            for i in 0..4 {
                let behind = self.neighbours[c as usize][i];
                if behind == NONE {
                    continue;
                }
                let (d, j) = unpack(behind);
                let back = self.neighbours.get(d as usize).map(|n| n[j]);
                let mut mine = FACETS[i].map(|k| self.cells[c as usize][k]);
                let mut theirs = FACETS[j].map(|k| self.cells[d as usize][k]);
                mine.sort_unstable();
                theirs.sort_unstable();
                if back != Some(pack(c, i)) || mine != theirs {
                    bad.push(pack(c, i));
                }
            }
        }
        bad
    }
}
