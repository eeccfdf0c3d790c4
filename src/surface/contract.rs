//! Contraction: raw vertices that are one point become one place (fact F2).
//!
//! All raw vertices of a sample lie at that sample, and others can coincide
//! after rounding. Each distinct position is a *place*; a face is then a
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
    /// The places of `raw`, in the order in which its vertices name them, and
    /// the place of each raw vertex.
    pub fn of(raw: &RawCrust) -> (Places, Vec<u32>) {
        let n = raw.positions.len();
        let mut places = Places {
            positions: Vec::with_capacity(n),
            samples: Vec::with_capacity(n),
        };
        let samples = raw.samples.iter().filter(|&&s| s != NONE);
        let mut of_sample = vec![NONE; samples.max().map_or(0, |&s| s as usize + 1)];
        // Open addressing, a power of two at most half full; only looked up,
        // never enumerated, so hashing decides no order.
        let mask = (2 * n + 2).next_power_of_two() - 1;
        let mut slots = vec![NONE; mask + 1];
        let mut place_of = Vec::with_capacity(n);
        for (v, &p) in raw.positions.iter().enumerate() {
            let sample = raw.samples.get(v).copied().unwrap_or(NONE);
            if sample != NONE && of_sample[sample as usize] != NONE {
                place_of.push(of_sample[sample as usize]);
                continue;
            }
            // Adding zero turns -0 into 0.
            let p = p.map(|x| x + 0.0);
            let mut slot = hash(p) as usize & mask;
            while slots[slot] != NONE && places.positions[slots[slot] as usize] != p {
                slot = (slot + 1) & mask;
            }
            if slots[slot] == NONE {
                slots[slot] = places.positions.len() as u32;
                places.positions.push(p);
                places.samples.push(NONE);
            }
            let place = slots[slot];
            place_of.push(place);
            if sample != NONE {
                of_sample[sample as usize] = place;
                if places.samples[place as usize] == NONE {
                    places.samples[place as usize] = sample;
                }
            }
        }
        (places, place_of)
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

/// The raw half-edges over places; nothing contracted yet.
pub(crate) fn half_edges(raw: &RawCrust, place_of: &[u32]) -> HalfEdges {
    let n = raw.corners.len();
    let mut next: Vec<u32> = (1..=n as u32).collect();
    let mut face = vec![0; n];
    for (f, ends) in raw.starts.windows(2).enumerate() {
        let (start, end) = (ends[0] as usize, ends[1] as usize);
        face[start..end].fill(f as u32);
        if end > start {
            next[end - 1] = ends[0];
        }
    }
    HalfEdges {
        next,
        twin: raw.twins.clone(),
        place: raw.corners.iter().map(|&v| place_of[v as usize]).collect(),
        face,
    }
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
