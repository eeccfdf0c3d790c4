//! Which triangles of a changing mesh meet where they share nothing: the
//! exact tests of [`super::check()`] for those who mend meshes.

use super::bvh::{Bvh, Cuboid};
use super::frame::Frame;
use super::intersect::{contact, Contact, Twins};
use super::nesting;
use super::soup::place;
use crate::context::{Cancelled, Context, Stage};
use crate::geom::Point;
use rayon::prelude::*;

/// Exact signs for one set of points. Everything below takes points in the
/// units of the frame, see [`Clash::new`].
pub(crate) struct Clash {
    frame: Frame,
}

/// Triangles in a tree; those that change are to be placed anew.
pub(crate) struct Tree {
    bvh: Bvh,
    /// The triangle in each slot.
    listed: Vec<u32>,
    /// The slot of each triangle, known once one was placed anew.
    slots: Vec<u32>,
}

/// The box of a triangle.
pub(crate) struct Reach(Cuboid);

impl Reach {
    pub fn of(t: &[Point; 3]) -> Reach {
        Reach(Cuboid::of(t))
    }

    pub fn meets(&self, other: &Reach) -> bool {
        self.0.meets(&other.0)
    }
}

impl Clash {
    /// The frame of the given points, and the points in its units: a power of
    /// two apart from those given.
    pub fn new(points: &[Point]) -> (Clash, Vec<Point>) {
        let mut frame = Frame::new(points);
        let scaled = std::mem::take(&mut frame.points);
        (Clash { frame }, scaled)
    }

    /// A point of the frame in the units of the points given.
    pub fn leave(&self, p: Point) -> Point {
        p.map(|x| self.frame.leave(x))
    }

    /// A point in the units of the points given, in those of the frame.
    pub fn enter(&self, p: Point) -> Point {
        self.frame.enter(p)
    }

    /// Whether a triangle has exactly no area.
    pub fn is_flat(&self, t: &[Point; 3]) -> bool {
        self.frame.kernel.projection(t).is_none()
    }

    /// Whether two triangles of positive area, given by vertices, meet in
    /// anything but the vertices and the edge they share.
    pub fn meet(&self, points: &[Point], a: [u32; 3], b: [u32; 3]) -> bool {
        let (pa, pb) = (place(points, a), place(points, b));
        let mut twins: Twins = [None; 3];
        for (k, twin) in twins.iter_mut().enumerate() {
            *twin = (0..3).find(|&j| pa[k] == pb[j]).map(|j| j as u8);
        }
        match contact(self.frame.kernel, &pa, &pb, &twins) {
            Contact::Disjoint => false,
            Contact::Crossing | Contact::Touching => true,
            Contact::Shared => {
                let at_one_place = twins.iter().flatten().count();
                a.iter().filter(|v| b.contains(v)).count() != at_one_place
            }
        }
    }

    /// A tree of the triangles that are alive (first corner in range).
    pub fn tree(&self, points: &[Point], triangles: &[[u32; 3]]) -> Tree {
        let listed: Vec<u32> = (0..triangles.len() as u32)
            .filter(|&t| (triangles[t as usize][0] as usize) < points.len())
            .collect();
        let boxes: Vec<Cuboid> = listed
            .par_iter()
            .map(|&t| Cuboid::of(&place(points, triangles[t as usize])))
            .collect();
        let bvh = Bvh::new(&boxes);
        let listed = bvh.order.iter().map(|&k| listed[k as usize]).collect();
        Tree {
            bvh,
            listed,
            slots: Vec::new(),
        }
    }

    /// All pairs of triangles that meet so, and a triangle paired with itself
    /// where it has no area; in order.
    pub fn pairs(
        &self,
        tree: &Tree,
        points: &[Point],
        triangles: &[[u32; 3]],
        cx: &Context,
    ) -> Result<Vec<(u32, u32)>, Cancelled> {
        let mut flat = vec![false; triangles.len()];
        let mut found = Vec::new();
        for (&t, is_flat) in tree.listed.iter().zip(self.flats(tree, points, triangles)) {
            if is_flat {
                flat[t as usize] = true;
                found.push((t, t));
            }
        }
        let by_slot: Vec<[u32; 3]> = (tree.listed.iter())
            .map(|&t| triangles[t as usize])
            .collect();
        let parts = tree.bvh.self_join(
            |part: &mut Vec<(u32, u32)>, i, j| {
                let (s, t) = (tree.listed[i as usize], tree.listed[j as usize]);
                if flat[s as usize] || flat[t as usize] {
                    return;
                }
                if self.meet(points, by_slot[i as usize], by_slot[j as usize]) {
                    part.push((s.min(t), s.max(t)));
                }
            },
            |done, total| cx.advance(Stage::Crust, done, total),
        )?;
        found.extend(parts.into_iter().flatten());
        found.sort_unstable();
        Ok(found)
    }

    /// Those of [`Clash::pairs`] of which one is among `some`.
    pub fn pairs_of(
        &self,
        tree: &Tree,
        points: &[Point],
        triangles: &[[u32; 3]],
        some: &[u32],
    ) -> Vec<(u32, u32)> {
        let corners =
            |t: u32| Some(triangles[t as usize]).filter(|c| (c[0] as usize) < points.len());
        let is_flat = |c: [u32; 3]| self.is_flat(&place(points, c));
        let mut found = Vec::new();
        for &s in some {
            match corners(s) {
                None => {}
                Some(a) if is_flat(a) => found.push((s, s)),
                Some(a) => tree.near(&Reach::of(&place(points, a)), |t| {
                    let other = corners(t).filter(|&b| t != s && !is_flat(b));
                    if other.is_some_and(|b| self.meet(points, a, b)) {
                        found.push((s.min(t), s.max(t)));
                    }
                }),
            }
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// For each of `count` closed shells, no two of which meet, the number of others around
    /// it; `shells` tells the shell of each triangle. Triangles that are gone
    /// count for nothing.
    pub fn depths(
        &self,
        tree: &Tree,
        points: &[Point],
        triangles: &[[u32; 3]],
        shells: &[u32],
        count: usize,
    ) -> Vec<Option<u32>> {
        let alive = |t: u32| (triangles[t as usize][0] as usize) < points.len();
        let mut witnesses = vec![None; count];
        for t in (0..triangles.len() as u32).filter(|&t| alive(t)) {
            witnesses[shells[t as usize] as usize].get_or_insert(triangles[t as usize][0]);
        }
        let depth = |(own, witness): (usize, &Option<u32>)| {
            let p = points[(*witness)? as usize];
            let mut hit = Vec::new();
            tree.bvh.query(&nesting::ray(p), |slot| {
                let t = tree.listed[slot as usize];
                let shell = shells[t as usize];
                let other = shell as usize != own && alive(t);
                if other
                    && nesting::hits(self.frame.kernel, p, &place(points, triangles[t as usize]))
                {
                    hit.push(shell);
                }
            });
            Some(nesting::odd(hit).len() as u32)
        };
        witnesses.par_iter().enumerate().map(depth).collect()
    }

    fn flats(&self, tree: &Tree, points: &[Point], triangles: &[[u32; 3]]) -> Vec<bool> {
        (tree.listed.par_iter())
            .map(|&t| self.is_flat(&place(points, triangles[t as usize])))
            .collect()
    }
}

impl Tree {
    /// A triangle that was alive when the tree was made has these corners now,
    /// or is gone.
    pub fn place(&mut self, triangle: u32, corners: Option<&[Point; 3]>) {
        if self.slots.is_empty() {
            let most = self.listed.iter().max().map_or(0, |&t| t as usize + 1);
            self.slots = vec![0; most];
            for (slot, &t) in self.listed.iter().enumerate() {
                self.slots[t as usize] = slot as u32;
            }
        }
        let cuboid = corners.map_or(Cuboid::NOWHERE, Cuboid::of);
        self.bvh.replace(self.slots[triangle as usize], cuboid);
    }

    /// Calls `visit` with every triangle whose box meets the given one.
    pub fn near(&self, reach: &Reach, mut visit: impl FnMut(u32)) {
        let cuboid = &reach.0;
        self.bvh
            .query(cuboid, |slot| visit(self.listed[slot as usize]));
    }
}
