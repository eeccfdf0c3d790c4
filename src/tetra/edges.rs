//! The edges of a complex, as a compressed table.
//!
//! Every cell names its six edges at their earlier vertices: those rows are
//! sorted, stripped of what they hold twice and then entered at both ends.
//! The rows are made by parts of the vertices, without locks: a part reads all
//! cells and takes note of its own vertices only. Going through the cells at
//! each vertex instead, by a table of them, takes three times as long: there
//! the cells are read in no order.

use rayon::prelude::*;

use super::complex::{Complex, NONE};
use crate::context::{Cancelled, Portion};

/// Cells read between two reports of progress.
const BLOCK: usize = 1 << 20;

/// Parts of the work at least (rows of a part stay in the cache, and what a
/// part needs beside them is gone when it is done), and at most: each reads
/// all cells.
const PARTS: [usize; 2] = [4, 16];

/// The edges among the first vertices of a complex, from both ends.
#[derive(Clone, Debug)]
pub struct Edges {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Edges {
    /// The edges among the vertices `0..vertices`.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn of(complex: &Complex, vertices: usize, progress: &Portion) -> Result<Edges, Cancelled> {
        let parts = rayon::current_num_threads().clamp(PARTS[0], PARTS[1]);
        let size = vertices.div_ceil(parts).max(1);
        let later: Vec<Rows> = (0..vertices)
            .step_by(size)
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|first| {
                later(
                    complex,
                    first..(first + size).min(vertices),
                    vertices,
                    progress,
                )
            })
            .collect::<Result<_, _>>()?;
        Ok(both_ways(&later, vertices))
    }

    /// The vertices joined to a vertex, ascending.
    #[inline]
    pub fn at(&self, vertex: u32) -> &[u32] {
        let v = vertex as usize;
        &self.items[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}

/// Rows of vertices, one after the other.
struct Rows {
    ends: Vec<u32>,
    items: Vec<u32>,
}

impl Rows {
    fn iter(&self) -> impl Iterator<Item = &[u32]> + '_ {
        let starts = std::iter::once(&0).chain(&self.ends);
        let row = |(from, to): (&u32, &u32)| &self.items[*from as usize..*to as usize];
        starts.zip(&self.ends).map(row)
    }
}

/// For each vertex of a part the later vertices among the first `vertices`
/// that it is joined to, ascending.
fn later(
    complex: &Complex,
    part: std::ops::Range<usize>,
    vertices: usize,
    progress: &Portion,
) -> Result<Rows, Cancelled> {
    let first = part.start as u32;
    let cells = || complex.cells.chunks(BLOCK).enumerate();
    let joined = |v: u32, w: u32| w > v && (w as usize) < vertices;
    // Where each row ends if nothing were held twice; filled from the end.
    let mut places = vec![0u32; part.len()];
    for (k, block) in cells() {
        progress.advance(k * BLOCK / 2, complex.len())?;
        for cell in block {
            for &v in cell {
                // Vertices before the first wrap round beyond the last.
                if let Some(count) = places.get_mut(v.wrapping_sub(first) as usize) {
                    *count += cell.iter().map(|&w| u32::from(joined(v, w))).sum::<u32>();
                }
            }
        }
    }
    let mut total = 0;
    for place in &mut places {
        total += *place;
        *place = total;
    }
    let mut items = vec![0u32; total as usize];
    for (k, block) in cells() {
        progress.advance((complex.len() + k * BLOCK) / 2, complex.len())?;
        for cell in block {
            for &v in cell {
                if let Some(place) = places.get_mut(v.wrapping_sub(first) as usize) {
                    for &w in cell {
                        if joined(v, w) {
                            *place -= 1;
                            items[*place as usize] = w;
                        }
                    }
                }
            }
        }
    }
    let mut met = vec![NONE; vertices];
    let mut ends = Vec::with_capacity(part.len());
    let mut kept = 0;
    for (k, v) in part.enumerate() {
        let to = places.get(k + 1).copied().unwrap_or(total) as usize;
        let from = kept;
        for at in places[k] as usize..to {
            let w = items[at];
            if std::mem::replace(&mut met[w as usize], v as u32) != v as u32 {
                items[kept] = w;
                kept += 1;
            }
        }
        items[from..kept].sort_unstable();
        ends.push(kept as u32);
    }
    items.truncate(kept);
    items.shrink_to_fit();
    Ok(Rows { ends, items })
}

/// Enters the rows of later vertices at both ends of each edge.
fn both_ways(later: &[Rows], vertices: usize) -> Edges {
    let rows = || (0..).zip(later.iter().flat_map(Rows::iter));
    let mut starts = vec![0u32; vertices + 1];
    for (v, row) in rows() {
        starts[v + 1] += row.len() as u32;
        for &w in row {
            starts[w as usize + 1] += 1;
        }
    }
    for v in 0..vertices {
        starts[v + 1] += starts[v];
    }
    let mut items = vec![0u32; starts[vertices] as usize];
    let mut next: Vec<u32> = starts[..vertices].to_vec();
    for (v, row) in rows() {
        // All earlier vertices are entered: what follows them is the row.
        let from = next[v] as usize;
        items[from..from + row.len()].copy_from_slice(row);
        for &w in row {
            items[next[w as usize] as usize] = v as u32;
            next[w as usize] += 1;
        }
    }
    Edges { starts, items }
}

#[cfg(test)]
mod tests {
    use super::super::Stars;
    use super::*;
    use crate::context::{Context, Stage};

    /// Cells over few vertices, as no triangulation has them.
    fn cells(count: u32, vertices: u32) -> Vec<[u32; 4]> {
        let mut state = 1u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state >> 8
        };
        let distinct = |mut v: [u32; 4]| {
            for k in 1..4 {
                while v[..k].contains(&v[k]) {
                    v[k] = (v[k] + 1) % vertices;
                }
            }
            v
        };
        (0..count)
            .map(|_| distinct([0; 4].map(|_| next() % vertices)))
            .collect()
    }

    #[test]
    fn stars_and_edges_are_those_of_a_search() {
        let complex = Complex {
            cells: cells(9_000, 6_000),
            neighbours: Vec::new(),
        };
        let context = Context::default();
        let progress = Portion {
            context: &context,
            stage: Stage::Poles,
            percent: [0, 100],
        };
        for (vertices, threads) in [(6_000usize, 1), (5_990, 5), (1, 2), (0, 2)] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().unwrap();
            let (stars, edges) = pool.install(|| {
                let stars = Stars::of(&complex, vertices, &progress).unwrap();
                (stars, Edges::of(&complex, vertices, &progress).unwrap())
            });
            for v in (0..vertices as u32).step_by(37) {
                let at = |c: &u32| complex.cells[*c as usize].contains(&v);
                let star: Vec<u32> = (0..complex.len() as u32).filter(at).collect();
                assert_eq!(stars.at(v), star, "{v}");
                let round = star.iter().flat_map(|&c| complex.cells[c as usize]);
                let mut joined: Vec<u32> = round
                    .filter(|&w| w != v && (w as usize) < vertices)
                    .collect();
                joined.sort_unstable();
                joined.dedup();
                assert_eq!(edges.at(v), joined, "{v}");
            }
        }
    }
}
