//! Triangles that can be changed: the closed manifold that mending works on.
//!
//! Triangle `t` has the half-edges `3 t`, `3 t + 1`, `3 t + 2`, each starting
//! at its corner; a half-edge knows its twin and a vertex one half-edge that
//! starts there. Two operations mend the mesh, [`TriMesh::collapse`] and
//! [`TriMesh::flip`]; both keep it a closed manifold without double edges as
//! long as their `can_` says so. Their changes go through a journal while it is
//! open, so that a change can be tried and taken back. Cutting handles (`handles.rs`) adds vertices
//! and triangles, many at once, and goes back to a snapshot.

use super::raw::{Crust, NONE};
use crate::geom::{Bounds, Point};
use crate::mesh::PolygonMesh;
use rayon::prelude::*;
use std::ops::Range;

/// A closed triangle mesh under repair. Positions are those of a
/// [`crate::mesh::clash::Clash`].
pub(crate) struct TriMesh {
    pub points: Vec<Point>,
    /// The sample each vertex lies at, or [`NONE`].
    pub samples: Vec<u32>,
    /// The corners of each triangle; the first is [`NONE`] once it is gone.
    pub tris: Vec<[u32; 3]>,
    pub twin: Vec<u32>,
    /// A half-edge that starts at the vertex, [`NONE`] once it is gone.
    pub out: Vec<u32>,
    /// The face each triangle comes from.
    pub source: Vec<u32>,
    /// Vertices that may move: those at no sample, and all but one of those
    /// at the same.
    pub movable: Vec<bool>,
    journal: Vec<Change>,
    recording: bool,
}

/// A mesh as it was.
pub(crate) struct Snapshot {
    points: Vec<Point>,
    tris: Vec<[u32; 3]>,
    twin: Vec<u32>,
    out: Vec<u32>,
}

/// What was there before.
enum Change {
    Corner(u32, u32),
    Twin(u32, u32),
    Out(u32, u32),
    Point(u32, Point),
}

#[inline]
pub(crate) fn next(h: u32) -> u32 {
    if h % 3 == 2 {
        h - 2
    } else {
        h + 1
    }
}

#[inline]
pub(crate) fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) {
        h + 2
    } else {
        h - 1
    }
}

impl TriMesh {
    /// The triangles of a crust, which must be closed and manifold, with
    /// `points` for its positions. Vertices are numbered along a space-filling
    /// curve and triangles by their least vertices, so that neighbours on the
    /// surface are neighbours in memory.
    pub fn new(crust: &Crust, points: &[Point]) -> TriMesh {
        let order = along_curve(points);
        let mut number = vec![NONE; points.len()];
        for (new, &old) in order.iter().enumerate() {
            number[old as usize] = new as u32;
        }
        let renumbered = |t: &[u32]| [t[0], t[1], t[2]].map(|v| number[v as usize]);
        let least = |t: &[u32]| {
            let [a, b, c] = renumbered(t);
            a.min(b).min(c)
        };
        let corners = &crust.mesh.corners;
        let source = by_bucket(points.len(), corners.chunks_exact(3).map(least));
        let tris: Vec<[u32; 3]> = (source.iter())
            .map(|&f| renumbered(&corners[3 * f as usize..]))
            .collect();
        let samples: Vec<u32> = (order.iter())
            .map(|&v| crust.vertex_samples[v as usize])
            .collect();
        let mut mesh = TriMesh {
            twin: twins(&tris, points.len()),
            points: order.iter().map(|&v| points[v as usize]).collect(),
            movable: samples.iter().map(|&s| s == NONE).collect(),
            samples,
            tris,
            out: Vec::new(),
            source,
            journal: Vec::new(),
            recording: false,
        };
        mesh.find_out();
        mesh
    }

    /// A mesh of some of the triangles, which were taken out of this one: `tris` and their
    /// twins, the first half-edge being `first`. None has a vertex before `own`; those
    /// vertices, and the others that the triangles have, are numbered in the same order.
    /// Half-edges at the border have no twin. Also the numbers of the vertices in this mesh.
    pub fn piece(
        &self,
        tris: &[[u32; 3]],
        twin: &[u32],
        first: usize,
        own: Range<u32>,
    ) -> (TriMesh, Vec<u32>) {
        let corners = tris.as_flattened().iter().copied();
        let mut others: Vec<u32> = corners.filter(|&v| v >= own.end).collect();
        others.sort_unstable();
        others.dedup();
        let number = |v: u32| match v < own.end {
            true => v - own.start,
            false => own.len() as u32 + others.partition_point(|&w| w < v) as u32,
        };
        let edges = first..first + twin.len();
        let inside = |t: u32| match edges.contains(&(t as usize)) {
            true => t - first as u32,
            false => NONE,
        };
        let vertices: Vec<u32> = own.clone().chain(others.iter().copied()).collect();
        let mut piece = TriMesh {
            points: vertices.iter().map(|&v| self.at(v)).collect(),
            samples: (vertices.iter())
                .map(|&v| self.samples[v as usize])
                .collect(),
            movable: Vec::new(),
            tris: tris.iter().map(|t| t.map(number)).collect(),
            twin: twin.iter().map(|&t| inside(t)).collect(),
            out: Vec::new(),
            source: Vec::new(),
            journal: Vec::new(),
            recording: false,
        };
        piece.find_out();
        (piece, vertices)
    }

    /// A half-edge at each vertex.
    fn find_out(&mut self) {
        self.out.clear();
        self.out.resize(self.points.len(), NONE);
        for (t, tri) in self.tris.iter().enumerate() {
            for (k, &v) in tri.iter().enumerate() {
                self.out[v as usize] = (3 * t + k) as u32;
            }
        }
    }

    /// Lets go of what is gone. Vertices and triangles keep their order;
    /// `values` at the vertices go with them.
    pub fn compact(&mut self, values: &mut Vec<f64>) {
        let mut number = vec![NONE; self.points.len()];
        let mut count = 0;
        for v in 0..self.points.len() {
            if self.out[v] != NONE {
                number[v] = count as u32;
                self.points[count] = self.points[v];
                self.samples[count] = self.samples[v];
                self.movable[count] = self.movable[v];
                values[count] = values[v];
                count += 1;
            }
        }
        self.points.truncate(count);
        self.samples.truncate(count);
        self.movable.truncate(count);
        values.truncate(count);
        let mut half = vec![NONE; self.twin.len()];
        let mut count = 0;
        for t in 0..self.tris.len() {
            if self.tris[t][0] != NONE {
                for k in 0..3 {
                    half[3 * t + k] = (3 * count + k) as u32;
                }
                self.tris[count] = self.tris[t].map(|v| number[v as usize]);
                self.source[count] = self.source[t];
                count += 1;
            }
        }
        self.tris.truncate(count);
        self.source.truncate(count);
        let alive = (0..half.len()).filter(|&h| half[h] != NONE);
        self.twin = alive.map(|h| half[self.twin[h] as usize]).collect();
        self.find_out();
    }

    #[inline]
    pub fn tail(&self, h: u32) -> u32 {
        self.tris[h as usize / 3][h as usize % 3]
    }

    #[inline]
    pub fn head(&self, h: u32) -> u32 {
        self.tail(next(h))
    }

    #[inline]
    pub fn twin(&self, h: u32) -> u32 {
        self.twin[h as usize]
    }

    /// The next half-edge that starts at the same vertex.
    #[inline]
    pub fn around(&self, h: u32) -> u32 {
        self.twin(prev(h))
    }

    #[inline]
    pub fn alive(&self, t: u32) -> bool {
        self.tris[t as usize][0] != NONE
    }

    #[inline]
    pub fn at(&self, v: u32) -> Point {
        self.points[v as usize]
    }

    /// The positions of a triangle's corners.
    #[inline]
    pub fn place(&self, t: u32) -> [Point; 3] {
        self.tris[t as usize].map(|v| self.at(v))
    }

    /// The half-edges that start at `v`, counterclockwise... in the order of
    /// `around`.
    pub fn fan(&self, v: u32, into: &mut Vec<u32>) {
        into.clear();
        let first = self.out[v as usize];
        if first == NONE {
            return;
        }
        let mut h = first;
        loop {
            into.push(h);
            h = self.around(h);
            if h == first || into.len() > self.twin.len() {
                break;
            }
        }
    }

    /// The half-edge from `a` to `b`, if there is one.
    pub fn find(&self, a: u32, b: u32) -> Option<u32> {
        let first = self.out[a as usize];
        if first == NONE {
            return None;
        }
        let mut h = first;
        loop {
            if self.head(h) == b {
                return Some(h);
            }
            h = self.around(h);
            if h == first {
                return None;
            }
        }
    }

    /// Whether `v` has more than three edges.
    fn has_many(&self, v: u32) -> bool {
        let h = self.out[v as usize];
        self.around(self.around(self.around(h))) != h
    }

    /// Whether the tail of `h`, whose neighbours are `ring`, can be drawn into
    /// its head: they have two neighbours in common and no more (the link
    /// condition), and those keep three edges.
    pub fn can_collapse(&self, h: u32, ring: &[u32]) -> bool {
        let (a, b) = (self.tail(prev(h)), self.tail(prev(self.twin(h))));
        let to = self.head(h);
        let mut common = 0;
        let first = self.twin(h);
        let mut g = self.around(first);
        while g != first {
            let end = self.head(g);
            common += ring.iter().filter(|&&w| w == end).count();
            if common > 2 || end == to {
                return false;
            }
            g = self.around(g);
        }
        common == 2
            && a != b
            && ring.iter().filter(|&&w| w == to).count() == 1
            && self.has_many(a)
            && self.has_many(b)
    }

    /// Draws the tail of `h` into its head; see [`Self::can_collapse`].
    pub fn collapse(&mut self, h: u32, fan: &[u32]) {
        let t = self.twin(h);
        let (from, to) = (self.tail(h), self.head(h));
        let (a, b) = (self.tail(prev(h)), self.tail(prev(t)));
        for &g in fan {
            self.set_corner(g, to);
        }
        let (x, y) = (self.twin(next(h)), self.twin(prev(h)));
        let (p, q) = (self.twin(next(t)), self.twin(prev(t)));
        self.pair(x, y);
        self.pair(p, q);
        // x runs a -> to, y to -> a; p runs b -> to (once from), q to -> b.
        self.set_out(a, x);
        self.set_out(to, y);
        self.set_out(b, p);
        self.set_out(from, NONE);
        for dead in [h, t] {
            for k in 0..3 {
                self.set_corner(dead / 3 * 3 + k, NONE);
            }
        }
    }

    /// Whether the edge of `h` can be turned in its quadrilateral.
    pub fn can_flip(&self, h: u32) -> bool {
        let t = self.twin(h);
        let (a, b) = (self.tail(prev(h)), self.tail(prev(t)));
        a != b
            && self.has_many(self.tail(h))
            && self.has_many(self.head(h))
            && self.find(a, b).is_none()
    }

    /// Turns the edge of `h`; afterwards `h` runs from the corner opposite
    /// its twin to the corner that was opposite it.
    pub fn flip(&mut self, h: u32) {
        let t = self.twin(h);
        // h: u -> v, next v -> a, prev a -> u; t: v -> u, next u -> b, prev b -> v.
        let (va, au, ub, bv) = (next(h), prev(h), next(t), prev(t));
        let (u, v, a, b) = (self.tail(h), self.tail(t), self.tail(au), self.tail(bv));
        let outside = [va, au, ub, bv].map(|s| self.twin(s));
        // h: b -> a, next a -> u, prev u -> b; t: a -> b, next b -> v, prev v -> a.
        self.set_corner(h, b);
        self.set_corner(va, a);
        self.set_corner(au, u);
        self.set_corner(t, a);
        self.set_corner(ub, b);
        self.set_corner(bv, v);
        self.pair(va, outside[1]);
        self.pair(au, outside[2]);
        self.pair(ub, outside[3]);
        self.pair(bv, outside[0]);
        self.set_out(u, au);
        self.set_out(v, bv);
        self.set_out(a, va);
        self.set_out(b, ub);
    }

    /// A vertex more, at no sample.
    pub fn add_vertex(&mut self, at: Point) -> u32 {
        self.points.push(at);
        self.samples.push(NONE);
        self.movable.push(true);
        self.out.push(NONE);
        self.points.len() as u32 - 1
    }

    /// A triangle more, whose twins are still to be told.
    pub fn add_triangle(&mut self, corners: [u32; 3], source: u32) {
        self.tris.push(corners);
        self.source.push(source);
        self.twin.extend([NONE; 3]);
    }

    /// Lets these vertices move.
    pub fn free(&mut self, vertices: &[u32]) {
        for &v in vertices {
            self.movable[v as usize] = true;
        }
    }

    /// Moves a vertex.
    pub fn shift(&mut self, v: u32, p: Point) {
        if self.recording {
            self.journal.push(Change::Point(v, self.at(v)));
        }
        self.points[v as usize] = p;
    }

    fn set_corner(&mut self, h: u32, v: u32) {
        let corner = &mut self.tris[h as usize / 3][h as usize % 3];
        if self.recording {
            self.journal.push(Change::Corner(h, *corner));
        }
        *corner = v;
    }

    fn set_out(&mut self, v: u32, h: u32) {
        if self.recording {
            self.journal.push(Change::Out(v, self.out[v as usize]));
        }
        self.out[v as usize] = h;
    }

    fn pair(&mut self, a: u32, b: u32) {
        for (x, y) in [(a, b), (b, a)] {
            if self.recording {
                self.journal.push(Change::Twin(x, self.twin[x as usize]));
            }
            self.twin[x as usize] = y;
        }
    }

    /// All that changes.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            points: self.points.clone(),
            tris: self.tris.clone(),
            twin: self.twin.clone(),
            out: self.out.clone(),
        }
    }

    /// Makes the mesh again what it was: vertices and triangles added since go.
    pub fn restore(&mut self, to: &Snapshot) {
        self.points.clone_from(&to.points);
        self.tris.clone_from(&to.tris);
        self.twin.clone_from(&to.twin);
        self.out.clone_from(&to.out);
        self.samples.truncate(self.points.len());
        self.movable.truncate(self.points.len());
        self.source.truncate(self.tris.len());
    }

    /// From here on changes can be taken back.
    pub fn begin(&mut self) {
        self.journal.clear();
        self.recording = true;
    }

    /// Takes back what was done since [`Self::begin`].
    pub fn take_back(&mut self) {
        self.recording = false;
        while let Some(change) = self.journal.pop() {
            match change {
                Change::Corner(h, v) => self.tris[h as usize / 3][h as usize % 3] = v,
                Change::Twin(h, t) => self.twin[h as usize] = t,
                Change::Out(v, h) => self.out[v as usize] = h,
                Change::Point(v, p) => self.points[v as usize] = p,
            }
        }
    }

    /// The crust, without what is gone; `leave` gives final positions and
    /// `balls` those of the faces the triangles come from. Also the face each
    /// triangle comes from.
    pub fn finish(&self, balls: &[[u32; 2]], leave: impl Fn(Point) -> Point) -> (Crust, Vec<u32>) {
        let mut number = vec![NONE; self.points.len()];
        let mut crust = Crust {
            mesh: PolygonMesh::with_vertices(Vec::new()),
            ..Crust::default()
        };
        for (v, _) in self.out.iter().enumerate().filter(|(_, &h)| h != NONE) {
            number[v] = crust.mesh.vertices.len() as u32;
            crust.mesh.vertices.push(leave(self.points[v]));
            crust.vertex_samples.push(self.samples[v]);
        }
        let mut source = Vec::new();
        for (t, tri) in self.tris.iter().enumerate().filter(|(_, t)| t[0] != NONE) {
            crust.mesh.push_face(&tri.map(|v| number[v as usize]));
            let face = self.source[t];
            let of = balls.get(face as usize);
            crust.face_balls.push(of.copied().unwrap_or([NONE; 2]));
            source.push(face);
        }
        (crust, source)
    }
}

/// The vertices along a Z-order curve through their box.
fn along_curve(points: &[Point]) -> Vec<u32> {
    let Some(bounds) = Bounds::of(points) else {
        return Vec::new();
    };
    let side = |k: usize| bounds.max[k] - bounds.min[k];
    let most = side(0).max(side(1)).max(side(2)).max(f64::MIN_POSITIVE);
    // Ten bits an axis, spread to every third.
    let key = |p: &Point| {
        let spread = |k: usize| {
            let x = (((p[k] - bounds.min[k]) / most) * 1023.0) as u64;
            let x = (x | x << 16) & 0x0300_00ff;
            let x = (x | x << 8) & 0x0300_f00f;
            let x = (x | x << 4) & 0x030c_30c3;
            (x | x << 2) & 0x0924_9249
        };
        spread(0) << 2 | spread(1) << 1 | spread(2)
    };
    let mut keys: Vec<u64> = (points.par_iter().enumerate())
        .map(|(v, p)| key(p) << 32 | v as u64)
        .collect();
    keys.par_sort_unstable();
    keys.iter().map(|&k| k as u32).collect()
}

/// The numbers of the items, each in a bucket below `buckets`, by bucket and
/// then by number.
fn by_bucket(buckets: usize, items: impl Iterator<Item = u32> + Clone) -> Vec<u32> {
    let mut first = vec![0u32; buckets + 1];
    let mut count = 0;
    for b in items.clone() {
        first[b as usize + 1] += 1;
        count += 1;
    }
    for b in 1..first.len() {
        first[b] += first[b - 1];
    }
    let mut order = vec![0; count];
    for (n, b) in items.enumerate() {
        let at = &mut first[b as usize];
        order[*at as usize] = n as u32;
        *at += 1;
    }
    order
}

/// The half-edge that runs the other way, for each. Those that run upward lie
/// in buckets by their tails; the others look theirs up.
fn twins(tris: &[[u32; 3]], vertices: usize) -> Vec<u32> {
    let corners = tris.as_flattened();
    let ends = |h: usize| (corners[h], corners[next(h as u32) as usize]);
    let mut first = vec![0u32; vertices + 2];
    for h in 0..corners.len() {
        let (tail, head) = ends(h);
        first[tail as usize + 2] += u32::from(tail < head);
    }
    for v in 2..first.len() {
        first[v] += first[v - 1];
    }
    let mut upward = vec![(0, 0); first[vertices + 1] as usize];
    for h in 0..corners.len() {
        let (tail, head) = ends(h);
        if tail < head {
            let slot = &mut first[tail as usize + 1];
            upward[*slot as usize] = (head, h as u32);
            *slot += 1;
        }
    }
    let mut twin = vec![NONE; corners.len()];
    for h in 0..corners.len() {
        let (tail, head) = ends(h);
        if tail > head {
            let bucket = first[head as usize] as usize..first[head as usize + 1] as usize;
            if let Some(&(_, up)) = upward[bucket].iter().find(|(v, _)| *v == tail) {
                twin[h] = up;
                twin[up as usize] = h as u32;
            }
        }
    }
    twin
}
