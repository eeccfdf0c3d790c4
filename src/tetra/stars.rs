//! The cells at each vertex, as a compressed table.
//!
//! Made by parts of the vertices, without locks: a part reads all cells and
//! takes note of its own vertices only.

use rayon::prelude::*;

use super::complex::Complex;
use crate::context::{Cancelled, Portion};

/// Cells read between two reports of progress.
const BLOCK: usize = 1 << 20;

/// Parts of the work at most: each reads all cells.
const MOST_PARTS: usize = 16;

/// The cells at each of the first vertices of a complex.
#[derive(Clone, Debug)]
pub struct Stars {
    starts: Vec<u32>,
    cells: Vec<u32>,
}

impl Stars {
    /// The stars of the vertices `0..vertices`.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn of(complex: &Complex, vertices: usize, progress: &Portion) -> Result<Stars, Cancelled> {
        let size = vertices
            .div_ceil(rayon::current_num_threads().min(MOST_PARTS))
            .max(1);
        let mut starts = vec![0u32; vertices + 1];
        let parts = starts[1..].par_chunks_mut(size).enumerate();
        parts.try_for_each(|(part, counts)| {
            let first = (part * size) as u32;
            for (k, block) in complex.cells.chunks(BLOCK).enumerate() {
                progress.advance(k * BLOCK / 2, complex.len())?;
                for v in block.iter().flatten() {
                    // Vertices before the first wrap round beyond the last.
                    if let Some(count) = counts.get_mut(v.wrapping_sub(first) as usize) {
                        *count += 1;
                    }
                }
            }
            Ok(())
        })?;
        for v in 0..vertices {
            starts[v + 1] += starts[v];
        }
        let mut cells = vec![0u32; starts[vertices] as usize];
        let mut parts = Vec::new();
        let mut rest = &mut cells[..];
        for first in (0..vertices).step_by(size) {
            let own = &starts[first..=(first + size).min(vertices)];
            let (part, after) = rest.split_at_mut((own[own.len() - 1] - own[0]) as usize);
            parts.push((first as u32, own, part));
            rest = after;
        }
        parts.into_par_iter().try_for_each(|(first, own, part)| {
            let mut next: Vec<u32> = own[..own.len() - 1].iter().map(|s| s - own[0]).collect();
            for (k, block) in complex.cells.chunks(BLOCK).enumerate() {
                progress.advance((complex.len() + k * BLOCK) / 2, complex.len())?;
                for (c, cell) in (k * BLOCK..).zip(block) {
                    for v in cell {
                        if let Some(at) = next.get_mut(v.wrapping_sub(first) as usize) {
                            part[*at as usize] = c as u32;
                            *at += 1;
                        }
                    }
                }
            }
            Ok(())
        })?;
        Ok(Stars { starts, cells })
    }

    /// The cells at a vertex, ascending.
    #[inline]
    pub fn at(&self, vertex: u32) -> &[u32] {
        let v = vertex as usize;
        &self.cells[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}
