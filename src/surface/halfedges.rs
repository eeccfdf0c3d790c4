//! A closed surface as a permutation: half-edges, each with a successor in
//! its face and a twin on the neighbouring face.
//!
//! Nothing else is stored, so nothing else can go wrong. Faces are the cycles
//! of `next`, edges the pairs of `twin`, vertices the cycles of `around`
//! (next of twin): whatever `next` and `twin` are, as long as they are a
//! permutation and an involution without fixed points, the faces glued along
//! the edges are a closed oriented surface on which every vertex has one fan.
//! Clean-up only ever exchanges successors and twins. It can therefore change
//! the topology, which is its job where the solid has no thickness, but it
//! cannot open the surface, turn a face over or make a vertex with two fans.
//!
//! Geometry enters as the *place* at which a half-edge starts. Every operation
//! keeps the law that a twin starts where its half-edge ends.

use super::raw::NONE;

/// The half-edges of a closed surface, in flat tables.
pub(crate) struct HalfEdges {
    /// The next half-edge of the same face, or [`NONE`] once removed.
    pub next: Vec<u32>,
    /// The half-edge that runs the other way.
    pub twin: Vec<u32>,
    /// The place where it starts.
    pub place: Vec<u32>,
    /// The inner and the outer ball of its face.
    pub balls: Vec<[u32; 2]>,
}

impl HalfEdges {
    /// Number of half-edges ever made, the removed ones included.
    pub fn len(&self) -> usize {
        self.next.len()
    }

    /// Whether `h` still bounds a face.
    #[inline]
    pub fn alive(&self, h: u32) -> bool {
        self.next[h as usize] != NONE
    }

    /// The half-edge after `h` in its face.
    #[inline]
    pub fn next(&self, h: u32) -> u32 {
        self.next[h as usize]
    }

    /// The half-edge that runs the other way along the edge of `h`.
    #[inline]
    pub fn twin(&self, h: u32) -> u32 {
        self.twin[h as usize]
    }

    /// The place where `h` starts.
    #[inline]
    pub fn tail(&self, h: u32) -> u32 {
        self.place[h as usize]
    }

    /// The place where `h` ends.
    #[inline]
    pub fn head(&self, h: u32) -> u32 {
        self.place[self.next[h as usize] as usize]
    }

    /// The next half-edge that starts at the same vertex.
    #[inline]
    pub fn around(&self, h: u32) -> u32 {
        self.next[self.twin[h as usize] as usize]
    }

    /// Takes `h` out; its neighbours must have been joined before.
    pub fn remove(&mut self, h: u32) {
        self.next[h as usize] = NONE;
    }

    /// Makes `a` and `b` the two sides of one edge.
    pub fn pair(&mut self, a: u32, b: u32) {
        self.twin[a as usize] = b;
        self.twin[b as usize] = a;
    }

    /// Puts a vertex at `place` on the edge of `h`. Afterwards `h` ends there;
    /// the half-edge that goes on to where `h` ended is returned.
    pub fn subdivide(&mut self, h: u32, place: u32) -> u32 {
        let t = self.twin(h);
        let h2 = self.push(self.next(h), place, self.balls[h as usize]);
        let t2 = self.push(self.next(t), place, self.balls[t as usize]);
        self.next[h as usize] = h2;
        self.next[t as usize] = t2;
        self.pair(h, t2);
        self.pair(h2, t);
        h2
    }

    /// Cuts a face by an edge from the tail of `a` to the tail of `b`, both
    /// half-edges of it, `before_a` and `before_b` those before them.
    pub fn chord(&mut self, before_a: u32, before_b: u32) {
        let (a, b) = (self.next(before_a), self.next(before_b));
        let balls = self.balls[a as usize];
        let ab = self.push(b, self.tail(a), balls);
        let ba = self.push(a, self.tail(b), balls);
        self.next[before_a as usize] = ab;
        self.next[before_b as usize] = ba;
        self.pair(ab, ba);
    }

    fn push(&mut self, next: u32, place: u32, balls: [u32; 2]) -> u32 {
        let h = self.next.len() as u32;
        self.next.push(next);
        self.twin.push(NONE);
        self.place.push(place);
        self.balls.push(balls);
        h
    }

    /// Removes a face of two edges by gluing its neighbours to each other.
    /// If they are the face itself, the surface was a sphere of zero volume.
    pub fn zip(&mut self, a: u32, b: u32) {
        let (s, t) = (self.twin(a), self.twin(b));
        self.remove(a);
        self.remove(b);
        if s != b {
            self.pair(s, t);
        }
    }

    /// Whether `a` and `b` start at the same vertex: one fan holds both.
    pub fn same_fan(&self, a: u32, b: u32) -> bool {
        let mut h = a;
        loop {
            if h == b {
                return true;
            }
            h = self.around(h);
            if h == a {
                return false;
            }
        }
    }

    /// The first half-edge of each face.
    pub fn faces(&self) -> Vec<u32> {
        let mut firsts = Vec::new();
        let mut seen = vec![false; self.len()];
        for first in 0..self.len() as u32 {
            if self.alive(first) && !seen[first as usize] {
                firsts.push(first);
                let mut h = first;
                while !seen[h as usize] {
                    seen[h as usize] = true;
                    h = self.next(h);
                }
            }
        }
        firsts
    }
}
