//! Contraction: raw vertices that are one point become one place (fact F2).
//!
//! All power vertices of a sample lie at that sample and come as one vertex
//! (see `extract`); others can coincide after rounding. Each distinct position
//! is a *place*; a face is then a
//! closed walk over places. The whole of contraction is to cut every walk
//! where it returns to a place it has visited: a piece of one half-edge has
//! zero length and goes, a piece of two goes by gluing its neighbours to each
//! other, longer pieces are faces. Since vertices are not stored (see
//! `halfedges`), a cluster of raw vertices that is a disc becomes one vertex;
//! one that is an annulus becomes two, one on either side, and so pinches the
//! surface into two fans without anyone deciding it.
//!
//! Cutting a face at a repeated place exchanges two successors. That splits
//! a fan in two or merges two fans of the same place: both are valid.

use super::halfedges::HalfEdges;
use super::raw::{RawCrust, NONE};
use crate::geom::Point;

/// The distinct positions of a raw crust.
pub(crate) struct Places {
    pub positions: Vec<Point>,
    /// The sample that lies there, or [`NONE`].
    pub samples: Vec<u32>,
}

impl Places {
    /// The places of a raw crust, in the order in which its vertices name
    /// them, and its half-edges over them; nothing cut yet.
    pub fn of(raw: RawCrust) -> (Places, HalfEdges) {
        let mut places = Places {
            positions: raw.positions,
            samples: raw.samples,
        };
        let mut surface = HalfEdges {
            next: raw.next,
            twin: raw.twins,
            place: raw.corners,
            balls: raw.balls,
        };
        if let Some(place_of) = places.unite() {
            for place in &mut surface.place {
                *place = place_of[*place as usize];
            }
        }
        (places, surface)
    }

    /// Makes equal positions one place; where each place went, if any did.
    fn unite(&mut self) -> Option<Vec<u32>> {
        let n = self.positions.len();
        // Open addressing, a power of two at most half full; only looked up,
        // never enumerated, so hashing decides no order.
        let mask = (2 * n + 2).next_power_of_two() - 1;
        let mut slots = vec![NONE; mask + 1];
        let mut place_of = Vec::with_capacity(n);
        let mut count = 0;
        for v in 0..n {
            // Adding zero turns -0 into 0.
            let p = self.positions[v].map(|x| x + 0.0);
            let mut slot = hash(p) as usize & mask;
            while slots[slot] != NONE && self.positions[slots[slot] as usize] != p {
                slot = (slot + 1) & mask;
            }
            if slots[slot] == NONE {
                slots[slot] = count as u32;
                self.positions[count] = p;
                self.samples[count] = self.samples[v];
                count += 1;
            }
            let place = slots[slot];
            place_of.push(place);
            if self.samples[place as usize] == NONE {
                self.samples[place as usize] = self.samples[v];
            }
        }
        self.positions.truncate(count);
        self.samples.truncate(count);
        (count < n).then_some(place_of)
    }

    /// The position of a place.
    #[inline]
    pub fn at(&self, place: u32) -> Point {
        self.positions[place as usize]
    }
}

fn hash(p: Point) -> u64 {
    p.iter().fold(0, |h: u64, x| {
        let h = (h ^ x.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        h ^ (h >> 29)
    })
}

/// Cuts faces where they return to a place; keeps its scratch tables.
pub(crate) struct Cutter {
    /// Where on the path each place was visited; all [`NONE`] between calls.
    visit: Vec<u32>,
    path: Vec<u32>,
    /// One half-edge of each face that the last cut left.
    pub pieces: Vec<u32>,
}

impl Cutter {
    pub fn new(places: usize) -> Cutter {
        Cutter {
            visit: vec![NONE; places],
            path: Vec::new(),
            pieces: Vec::new(),
        }
    }

    /// Cuts the face of `h` into pieces that visit no place twice, removes
    /// those of one or two half-edges, and lists the others in `pieces`.
    pub fn cut(&mut self, surface: &mut HalfEdges, h: u32) {
        self.pieces.clear();
        self.path.clear();
        let mut at = h;
        loop {
            let next = surface.next(at);
            let place = surface.tail(at) as usize;
            if self.visit[place] != NONE {
                self.close(surface, self.visit[place] as usize);
            }
            if let Some(&before) = self.path.last() {
                surface.next[before as usize] = at;
            }
            self.visit[place] = self.path.len() as u32;
            self.path.push(at);
            at = next;
            if at == h {
                break;
            }
        }
        self.close(surface, 0);
    }

    /// Makes the path from `start` on a face of its own.
    fn close(&mut self, surface: &mut HalfEdges, start: usize) {
        for &h in &self.path[start..] {
            self.visit[surface.tail(h) as usize] = NONE;
        }
        match self.path[start..] {
            [] => {}
            [h] => surface.remove(h),
            [a, b] => surface.zip(a, b),
            [first, .., last] => {
                surface.next[last as usize] = first;
                self.pieces.push(first);
            }
        }
        self.path.truncate(start);
    }
}
