//! Which thread may touch which cell.
//!
//! Ids follow a space-filling curve; short stretches of it are **regions**,
//! and a region belongs to one thread or to none. The corners of the frame belong
//! to everyone. A thread reads or changes a cell only while it holds the
//! regions of all vertices of it. What follows:
//!
//! - no other thread changes a cell with a vertex whose region is held, so
//!   what lies behind a facet of a held cell may be read as soon as one corner of the
//!   facet is none of the frame's, and one region more makes it a held cell;
//! - a thread hands on a region only after its changes are made (release and
//!   acquire), so the words of cells themselves need no order.
//!
//! Nobody waits. A thread that cannot have a region gives up the insertion,
//! for later, and whatever it holds beyond the cell where its next walk
//! starts; else it keeps its regions for the next insertions, which are near.

use std::sync::atomic::{AtomicU32, Ordering::Acquire, Ordering::Relaxed, Ordering::Release};

/// Regions there are at most, and ids in a region at least.
const MOST: u32 = 4096;
const LEAST_SHIFT: u32 = 5;

/// Regions a thread keeps from one insertion to the next.
const KEPT: usize = 48;

/// A region nobody holds.
const NOBODY: u32 = 0;

/// The holders of all regions.
pub(super) struct Regions {
    holders: Vec<AtomicU32>,
    shift: u32,
    /// The first id of the frame.
    frame: u32,
}

impl Regions {
    /// Regions for the ids before the frame's.
    pub fn new(frame: u32) -> Regions {
        let mut shift = LEAST_SHIFT;
        while frame >> shift >= MOST {
            shift += 1;
        }
        Regions {
            holders: (0..=frame >> shift)
                .map(|_| AtomicU32::new(NOBODY))
                .collect(),
            shift,
            frame,
        }
    }
}

/// What one thread holds.
pub(super) struct Hold<'a> {
    regions: &'a Regions,
    me: u32,
    held: Vec<u32>,
}

impl<'a> Hold<'a> {
    /// The hold of the `k`-th thread: nothing.
    pub fn new(regions: &'a Regions, k: usize) -> Hold<'a> {
        Hold {
            regions,
            me: k as u32 + 1,
            held: Vec::new(),
        }
    }

    /// Whether the vertex is the frame's.
    #[inline]
    pub fn is_frame(&self, v: u32) -> bool {
        v >= self.regions.frame
    }

    /// Takes the region of a vertex; `false` if another thread holds it.
    #[inline]
    pub fn take(&mut self, v: u32) -> bool {
        if self.is_frame(v) {
            return true;
        }
        let region = v >> self.regions.shift;
        let holder = &self.regions.holders[region as usize];
        match holder.load(Relaxed) {
            NOBODY => {
                let taken = holder.compare_exchange(NOBODY, self.me, Acquire, Relaxed);
                if taken.is_ok() {
                    self.held.push(region);
                }
                taken.is_ok()
            }
            other => other == self.me,
        }
    }

    /// Lets go of all regions but those of some vertices.
    pub fn release(&mut self, keep: &[u32]) {
        let (regions, frame) = (self.regions, self.regions.frame);
        self.held.retain(|&region| {
            let kept = |&v: &u32| v < frame && v >> regions.shift == region;
            let keep = keep.iter().any(kept);
            if !keep {
                regions.holders[region as usize].store(NOBODY, Release);
            }
            keep
        });
    }

    /// Lets go of them if there are many.
    #[inline]
    pub fn release_many(&mut self, keep: impl FnOnce() -> [u32; 4]) {
        if self.held.len() > KEPT {
            self.release(&keep());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_has_one_holder_and_the_frame_none() {
        let regions = Regions::new(1000);
        let (mut a, mut b) = (Hold::new(&regions, 0), Hold::new(&regions, 1));
        assert!(a.take(0) && a.take(31) && a.take(999));
        assert!(!b.take(1) && b.take(32));
        assert!(!a.take(33));
        assert!(a.take(1000) && b.take(1007));
        a.release(&[995, 1000]);
        assert!(b.take(1) && !b.take(998));
    }

    #[test]
    fn regions_are_few_however_many_ids() {
        for (ids, wanted) in [(1, 1), (1000, 32), (1 << 28, 2049)] {
            assert_eq!(Regions::new(ids).holders.len() as u32, wanted, "{ids}");
        }
    }
}
