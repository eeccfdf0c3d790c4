//! Handles thinner than the noise are cut: a step beyond the paper.
//!
//! Amid noise single power cells touch across a gap, or through a wall, and make a
//! handle or a tunnel that the solid does not have. Around it runs a loop that is short and parts nothing: the surface
//! hangs together without it. The surface is cut along such loops, the shortest first, and both
//! ends are closed (as Guskov and Wood, 2001, do with scanned volumes). A neck
//! between two parts stays: its loop parts them.
//!
//! The two ends lie at one place, so one draws back a little along its own
//! side. Where an end then crosses anything, the handle stays.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use rayon::prelude::*;

use super::mend_mesh::{next, prev, TriMesh};
use super::raw::NONE;
use crate::context::{Cancelled, Context, Stage};
use crate::geom::vec3::{add, dist_sq, scale, sub};
use crate::geom::{Point, Sets};
use crate::mesh::clash::Clash;

/// How far an end draws back, as a share of the way to its neighbours.
const BACK: f64 = 0.2;

/// Vertices looked at around one at most.
const MOST_AROUND: usize = 400;

/// Times that cuts are tried at most: each time those that make crossings are left out.
const TRIES: usize = 16;

/// Cuts handles around which a loop runs that is no longer than `most` at one of its vertices;
/// returns how many were cut. `most` grows with the vertices; `round` gives positions that can be
/// written.
///
/// # Errors
/// [`Cancelled`].
pub(super) fn cut_handles(
    mesh: &mut TriMesh,
    most: &mut Vec<f64>,
    clash: &Clash,
    round: &dyn Fn(Point) -> Point,
    cx: &Context,
) -> Result<usize, Cancelled> {
    let mut total = 0;
    // Vertices of loops along which a cut made a crossing.
    let mut refused: BTreeSet<u32> = BTreeSet::new();
    // Cutting makes no handles: later only where there were some.
    let mut starts: Vec<u32> = (0..mesh.points.len() as u32)
        .filter(|&v| most[v as usize] > 0.0 && mesh.out[v as usize] != NONE)
        .collect();
    for _ in 0..TRIES {
        cx.advance(Stage::Crust, 1, 3)?;
        let mut loops = short_loops(mesh, most, &starts);
        starts = loops.iter().map(|l| mesh.tail(l[0])).collect();
        starts.sort_unstable();
        loops.retain(|l| !l.iter().any(|&h| refused.contains(&mesh.tail(h))));
        if loops.is_empty() {
            break;
        }
        let (before, values) = (mesh.snapshot(), most.len());
        let made = cut_all(mesh, most, &loops, round);
        let tree = clash.tree(&mesh.points, &mesh.tris);
        let touched: Vec<u32> = made.keys().copied().collect();
        let pairs = clash.pairs_of(&tree, &mesh.points, &mesh.tris, &touched);
        let bad = (pairs.iter()).flat_map(|&(s, t)| [s, t]);
        let bad: BTreeSet<usize> = bad.filter_map(|t| made.get(&t).copied()).collect();
        if bad.is_empty() {
            total += made.values().collect::<BTreeSet<_>>().len();
        } else {
            mesh.restore(&before);
            most.truncate(values);
            let edges = bad.iter().flat_map(|&k| &loops[k]);
            refused.extend(edges.map(|&h| mesh.tail(h)));
        }
    }
    Ok(total)
}

/// Cuts along loops that still part nothing when it is their turn. The triangles that are
/// new or changed, with the number of the loop.
fn cut_all(
    mesh: &mut TriMesh,
    most: &mut Vec<f64>,
    loops: &[Vec<u32>],
    round: &dyn Fn(Point) -> Point,
) -> BTreeMap<u32, usize> {
    let mut flood = Flood::new(mesh);
    let mut made = BTreeMap::new();
    for (k, around) in loops.iter().enumerate() {
        let next = |i: usize| around[(i + 1) % around.len()];
        let mut edges = around.iter().enumerate();
        let whole = edges.all(|(i, &h)| mesh.head(h) == mesh.tail(next(i)));
        if whole && flood.hangs_together(mesh, around) {
            made.extend(cut(mesh, most, around, round).into_iter().map(|t| (t, k)));
        }
    }
    made
}

/// Loops of half-edges that are short, bound no disc and part nothing: the shortest through each
/// of some vertices, the shortest first.
fn short_loops(mesh: &TriMesh, most: &[f64], starts: &[u32]) -> Vec<Vec<u32>> {
    let mut found: Vec<(f64, Vec<u32>)> = (starts.par_iter())
        .with_min_len(1024)
        .map_init(
            || (Around::new(mesh), Flood::new(mesh)),
            |(around, flood), &v| around.shortest(mesh, v, most[v as usize], flood),
        )
        .flatten()
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
    found.into_iter().map(|(_, l)| l).collect()
}

/// The surface near a vertex.
struct Around {
    /// Vertices in the order of their distance along edges, with it and the half-edge from the
    /// one before.
    list: Vec<(f64, u32, u32)>,
    open: BinaryHeap<Reverse<(u64, u32, u32)>>,
    /// Where each vertex of the mesh stands in the list.
    place: Vec<u32>,
    /// The set of each triangle, if all its corners are in the list.
    face: Vec<u32>,
    faces: Vec<u32>,
    sets: Sets,
}

impl Around {
    fn new(mesh: &TriMesh) -> Around {
        Around {
            list: Vec::new(),
            open: BinaryHeap::new(),
            place: vec![NONE; mesh.points.len()],
            face: vec![NONE; mesh.tris.len()],
            faces: Vec::new(),
            sets: Sets::default(),
        }
    }

    /// The shortest loop through a vertex, up to a length, that parts nothing.
    fn shortest(
        &mut self,
        mesh: &TriMesh,
        v: u32,
        most: f64,
        flood: &mut Flood,
    ) -> Option<(f64, Vec<u32>)> {
        self.grow(mesh, v, most / 2.0);
        let loops = self.loops(mesh, most);
        let found = loops.into_iter().find_map(|(length, h)| {
            let around = self.closed(mesh, h)?;
            let together = flood.hangs_together(mesh, &around);
            together.then_some((length, around))
        });
        for &(_, v, _) in &self.list {
            self.place[v as usize] = NONE;
        }
        for &t in &self.faces {
            self.face[t as usize] = NONE;
        }
        found
    }

    /// The vertices within `reach` of `v`, by Dijkstra's algorithm.
    fn grow(&mut self, mesh: &TriMesh, v: u32, reach: f64) {
        self.list.clear();
        self.open.clear();
        // Lengths are positive: their bits are in their order.
        self.open.push(Reverse((0, v, NONE)));
        while let Some(Reverse((bits, at, by))) = self.open.pop() {
            if self.place[at as usize] != NONE {
                continue;
            }
            let d = f64::from_bits(bits);
            self.place[at as usize] = self.list.len() as u32;
            self.list.push((d, at, by));
            if self.list.len() == MOST_AROUND {
                return;
            }
            each_around(mesh, at, |h| {
                let to = mesh.head(h);
                if self.place[to as usize] == NONE {
                    let far = d + dist_sq(mesh.at(at), mesh.at(to)).sqrt();
                    if far <= reach {
                        self.open.push(Reverse((far.to_bits(), to, h)));
                    }
                }
            });
        }
    }

    /// Loops of a shortest basis of those in the triangles between these vertices, by the half-edges that close
    /// them, the shortest first: none where the triangles form a disc. The longest closing edges are what
    /// triangles can be joined across without a loop (Erickson and Whittlesey, 2005).
    fn loops(&mut self, mesh: &TriMesh, most: f64) -> Vec<(f64, u32)> {
        self.faces.clear();
        let mut closing: Vec<(f64, u32)> = Vec::new();
        for k in 0..self.list.len() {
            let (d, v, by) = self.list[k];
            each_around(mesh, v, |h| {
                let (to, third) = (mesh.head(h), mesh.tail(prev(h)));
                let other = self.place[to as usize];
                if other == NONE {
                    return;
                }
                if self.place[third as usize] != NONE && self.face[h as usize / 3] == NONE {
                    self.face[h as usize / 3] = self.faces.len() as u32;
                    self.faces.push(h / 3);
                }
                let (e, _, towards) = self.list[other as usize];
                let tree = towards == h || by != NONE && by == mesh.twin(h);
                if v < to && !tree {
                    let length = d + e + dist_sq(mesh.at(v), mesh.at(to)).sqrt();
                    closing.push((length, h));
                }
            });
        }
        let outside = self.faces.len() as u32;
        self.sets.reset(self.faces.len() + 1);
        closing.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
        closing.retain(|&(_, h)| {
            let [a, b] = [h, mesh.twin(h)].map(|h| match self.face[h as usize / 3] {
                NONE => outside,
                set => set,
            });
            !self.sets.join(a, b)
        });
        closing.retain(|&(length, _)| length <= most);
        closing.reverse();
        closing
    }

    /// The half-edges from the first vertex to the tail of `h`, `h`, and those back; `None`
    /// where the ways there and back share more than that vertex.
    fn closed(&self, mesh: &TriMesh, h: u32) -> Option<Vec<u32>> {
        let way = |mut v: u32| {
            let mut way = Vec::new();
            loop {
                let by = self.list[self.place[v as usize] as usize].2;
                if by == NONE {
                    return way;
                }
                way.push(by);
                v = mesh.tail(by);
            }
        };
        let (there, back) = (way(mesh.tail(h)), way(mesh.head(h)));
        let mut around: Vec<u32> = there.into_iter().rev().collect();
        around.push(h);
        around.extend(back.into_iter().map(|g| mesh.twin(g)));
        let mut ends: Vec<u32> = around.iter().map(|&g| mesh.tail(g)).collect();
        ends.sort_unstable();
        ends.dedup();
        (around.len() > 2 && ends.len() == around.len()).then_some(around)
    }
}

/// Calls for each half-edge that starts at a vertex.
fn each_around(mesh: &TriMesh, v: u32, mut call: impl FnMut(u32)) {
    let first = mesh.out[v as usize];
    let mut h = first;
    loop {
        call(h);
        h = mesh.around(h);
        if h == first {
            return;
        }
    }
}

/// Floods the surface from both sides of a loop.
struct Flood {
    seen: Vec<u32>,
    stamp: u32,
}

impl Flood {
    fn new(mesh: &TriMesh) -> Flood {
        Flood {
            seen: vec![0; mesh.tris.len()],
            stamp: 0,
        }
    }

    /// Whether the surface hangs together without the loop.
    fn hangs_together(&mut self, mesh: &TriMesh, around: &[u32]) -> bool {
        self.seen.resize(mesh.tris.len(), 0);
        self.stamp += 2;
        let mut wall: Vec<u32> = around.iter().flat_map(|&h| [h, mesh.twin(h)]).collect();
        wall.sort_unstable();
        let mut fronts: [Vec<u32>; 2] = [Vec::new(), Vec::new()];
        for &h in around {
            for (side, t) in [h / 3, mesh.twin(h) / 3].into_iter().enumerate() {
                let mark = &mut self.seen[t as usize];
                if *mark == self.stamp + 1 - side as u32 {
                    return true;
                }
                if *mark != self.stamp + side as u32 {
                    *mark = self.stamp + side as u32;
                    fronts[side].push(t);
                }
            }
        }
        loop {
            for side in 0..2 {
                let mut next = Vec::new();
                for &t in &fronts[side] {
                    for h in 3 * t..3 * t + 3 {
                        let other = mesh.twin(h) / 3;
                        let mark = self.seen[other as usize];
                        if mark == self.stamp + side as u32 || wall.binary_search(&h).is_ok() {
                            continue;
                        }
                        if mark == self.stamp + 1 - side as u32 {
                            return true;
                        }
                        self.seen[other as usize] = self.stamp + side as u32;
                        next.push(other);
                    }
                }
                if next.is_empty() {
                    return false;
                }
                fronts[side] = next;
            }
        }
    }
}

/// Cuts the surface along a loop and closes both ends around a vertex in the middle. The triangles that
/// changed or are new; `values` at the vertices grow with them.
fn cut(
    mesh: &mut TriMesh,
    values: &mut Vec<f64>,
    around: &[u32],
    round: &dyn Fn(Point) -> Point,
) -> Vec<u32> {
    let count = around.len();
    let ends: Vec<u32> = around.iter().map(|&h| mesh.tail(h)).collect();
    let twins: Vec<u32> = around.iter().map(|&h| mesh.twin(h)).collect();
    let mut touched = Vec::new();
    // The corners on the right of the loop get vertices of their own.
    let right: Vec<Vec<u32>> = (0..count)
        .map(|k| {
            let (stop, mut h) = (around[k], twins[(k + count - 1) % count]);
            let mut corners = Vec::new();
            while h != stop {
                corners.push(h);
                h = mesh.around(h);
            }
            corners
        })
        .collect();
    let copies: Vec<u32> = (ends.iter())
        .map(|&v| {
            values.push(values[v as usize]);
            mesh.add_vertex(mesh.at(v))
        })
        .collect();
    for (corners, &copy) in right.iter().zip(&copies) {
        for &h in corners {
            mesh.tris[h as usize / 3][h as usize % 3] = copy;
            touched.push(h / 3);
        }
        mesh.out[copy as usize] = corners[0];
    }
    for (k, &v) in ends.iter().enumerate() {
        mesh.out[v as usize] = around[k];
        touched.push(around[k] / 3);
    }
    // They draw back towards their neighbours that were not on the loop.
    let moved: Vec<Point> = (right.iter().zip(&copies))
        .map(|(corners, &copy)| {
            let at = mesh.at(copy);
            let others: Vec<u32> = (corners.iter())
                .map(|&h| mesh.head(h))
                .filter(|w| !copies.contains(w))
                .collect();
            let sum = (others.iter()).fold([0.0; 3], |s, &w| add(s, sub(mesh.at(w), at)));
            round(add(at, scale(sum, BACK / others.len().max(1) as f64)))
        })
        .collect();
    for (&copy, &p) in copies.iter().zip(&moved) {
        mesh.points[copy as usize] = p;
    }
    // Caps.
    let middle = |mesh: &TriMesh, of: &[u32]| {
        let sum = of.iter().fold([0.0; 3], |s, &v| add(s, mesh.at(v)));
        round(scale(sum, 1.0 / of.len() as f64))
    };
    for (edges, of) in [(around, &ends), (&twins, &copies)] {
        values.push(values[of[0] as usize]);
        let centre = mesh.add_vertex(middle(mesh, of));
        let first = mesh.tris.len() as u32;
        // Triangle k lies behind edge k: head, tail, centre.
        for (k, &h) in edges.iter().enumerate() {
            let (tail, head) = (mesh.tail(h), mesh.head(h));
            mesh.add_triangle([head, tail, centre], mesh.source[h as usize / 3]);
            let own = 3 * (first + k as u32);
            mesh.twin[own as usize] = h;
            mesh.twin[h as usize] = own;
            touched.push(first + k as u32);
        }
        mesh.out[centre as usize] = 3 * first + 2;
        // Half-edge 1 runs from a tail to the centre, 2 from the centre to a head.
        for (k, &h) in edges.iter().enumerate() {
            let own = first + k as u32;
            let head = mesh.head(h);
            let other = (edges.iter().position(|&g| mesh.tail(g) == head)).unwrap_or(k);
            let (a, b) = (3 * own + 2, 3 * (first + other as u32) + 1);
            mesh.twin[a as usize] = b;
            mesh.twin[b as usize] = a;
        }
    }
    debug_assert!(touched.iter().all(|&t| (3 * t..3 * t + 3).all(|h| {
        mesh.twin(mesh.twin(h)) == h
            && mesh.tail(mesh.twin(h)) == mesh.head(h)
            && mesh.tail(next(h)) == mesh.head(h)
    })));
    touched.sort_unstable();
    touched.dedup();
    touched
}

#[cfg(test)]
mod tests {
    use super::super::mend::{mend_crust, MendOptions, Mending};
    use super::*;
    use crate::mesh::{check, CheckOptions, PolygonMesh};
    use crate::surface::Crust;

    /// A tube around a circle of radius 1, as thick at each place as `thick` says; `bent` all the way round or,
    /// straight from end to end, with its ends closed.
    fn tube(bent: bool, thick: impl Fn(f64) -> f64) -> Crust {
        const AROUND: u32 = 8;
        let long = 40u32;
        let mut points = Vec::new();
        for i in 0..long {
            let t = f64::from(i) / f64::from(long);
            let r = thick(t);
            for j in 0..AROUND {
                let b = f64::from(j) * std::f64::consts::TAU / f64::from(AROUND);
                let (c, s) = (t * std::f64::consts::TAU).sin_cos();
                points.push(match bent {
                    true => [
                        s * (1.0 + r * b.cos()),
                        c * (1.0 + r * b.cos()),
                        r * b.sin(),
                    ],
                    false => [r * b.cos(), r * b.sin(), 6.0 * t],
                });
            }
        }
        let at = |i: u32, j: u32| i % long * AROUND + j % AROUND;
        let mut crust = Crust {
            vertex_samples: (0..points.len() as u32).collect(),
            mesh: PolygonMesh::with_vertices(points),
            face_balls: Vec::new(),
        };
        for i in 0..long - u32::from(!bent) {
            for j in 0..AROUND {
                let q = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
                crust.mesh.push_face(&[q[0], q[1], q[2]]);
                crust.mesh.push_face(&[q[0], q[2], q[3]]);
            }
        }
        for j in 1..AROUND - 1 {
            if !bent {
                crust.mesh.push_face(&[at(0, 0), at(0, j + 1), at(0, j)]);
                let last = long - 1;
                crust
                    .mesh
                    .push_face(&[at(last, 0), at(last, j), at(last, j + 1)]);
            }
        }
        if crust.mesh.volume() < 0.0 {
            for t in crust.mesh.corners.chunks_exact_mut(3) {
                t.swap(1, 2);
            }
        }
        crust.face_balls = vec![[NONE; 2]; crust.mesh.face_count()];
        crust
    }

    /// Mends it with handles cut around which loops up to this length run; what is left must be sound.
    fn mended(crust: Crust, most: impl Fn(u32) -> f64 + Sync) -> Mending {
        let how = MendOptions {
            handles: Some(&most),
            flatness: 0.0,
            tolerance: None,
            single: false,
            keep_samples: true,
            spacing: &|_| 0.15,
            ball: &|_| None,
        };
        let mended = mend_crust(crust, &how, &Context::default()).unwrap();
        assert!(mended.left.is_empty());
        let mesh = &mended.crust.mesh;
        let report = check(mesh, &CheckOptions::default(), &Context::default()).unwrap();
        assert!(report.findings.is_empty(), "{:?}", report.findings);
        mended
    }

    fn euler(mended: &Mending) -> i64 {
        let mesh = &mended.crust.mesh;
        let edges = mesh.corners.len() as i64 / 2;
        mesh.vertices.len() as i64 - edges + mesh.face_count() as i64
    }

    #[test]
    fn a_thin_handle_is_cut_once_where_it_is_thinnest() {
        // Eight sides of a circle of radius 0.1 are 0.612 long.
        let ring = || tube(true, |t| 0.1 + 0.1 * t * (1.0 - t));
        let cut = mended(ring(), |_| 0.62);
        assert_eq!((cut.handles_cut, euler(&cut)), (1, 2));
        let kept = mended(ring(), |_| 0.6);
        assert_eq!((kept.handles_cut, euler(&kept)), (0, 0));
    }

    #[test]
    fn the_cut_leaves_the_solid_where_it_was() {
        let before = tube(true, |_| 0.1);
        let volume = before.mesh.volume();
        let cut = mended(before, |_| 0.7);
        assert_eq!(cut.handles_cut, 1);
        let lost = 1.0 - cut.crust.mesh.volume() / volume;
        assert!((0.0..0.02).contains(&lost), "{lost}");
    }

    /// A thread within the tube is in the way of every cap.
    #[test]
    fn what_would_cross_is_not_cut() {
        let mut crust = tube(true, |_| 0.1);
        let shift = crust.mesh.vertices.len() as u32;
        let mut thread = tube(true, |_| 0.01);
        for t in thread.mesh.corners.chunks_exact_mut(3) {
            t.swap(1, 2);
        }
        crust.mesh.vertices.extend(&thread.mesh.vertices);
        for t in thread.mesh.corners.chunks_exact(3) {
            crust.mesh.push_face(&[t[0], t[1], t[2]].map(|v| v + shift));
        }
        crust.vertex_samples.extend(shift..2 * shift);
        crust.face_balls = vec![[NONE; 2]; crust.mesh.face_count()];
        let kept = mended(crust, |s| if s < shift { 0.7 } else { 0.0 });
        assert_eq!((kept.handles_cut, euler(&kept)), (0, 0));
    }

    #[test]
    fn a_neck_between_two_parts_stays() {
        let neck = tube(false, |t| 0.05 + (t - 0.5).abs());
        let kept = mended(neck, |_| 2.0);
        assert_eq!((kept.handles_cut, euler(&kept)), (0, 2));
    }

    #[test]
    fn a_tunnel_is_closed() {
        // The inside out ring in a box: a hole through it is a loop within the box.
        let mut crust = tube(true, |t| if (0.4..0.6).contains(&t) { 0.02 } else { 0.1 });
        for t in crust.mesh.corners.chunks_exact_mut(3) {
            t.swap(1, 2);
        }
        let shift = crust.mesh.vertices.len() as u32;
        let corner = |k: u32| [k & 1, k >> 1 & 1, k >> 2 & 1].map(|b| 4.0 * f64::from(b) - 2.0);
        crust.mesh.vertices.extend((0..8).map(corner));
        crust.vertex_samples.extend(shift..shift + 8);
        for q in [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ] {
            for t in [[q[0], q[1], q[2]], [q[0], q[2], q[3]]] {
                crust.mesh.push_face(&t.map(|v| v + shift));
            }
        }
        crust.face_balls = vec![[NONE; 2]; crust.mesh.face_count()];
        let cut = mended(crust, |_| 0.2);
        assert_eq!((cut.handles_cut, euler(&cut)), (1, 4));
    }
}
