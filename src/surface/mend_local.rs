//! Mending one place after the other, every step proved.
//!
//! For a pair of triangles that meet where they must not, small changes near
//! them are tried: to draw a vertex into a neighbour, to turn an edge, to move
//! a vertex that is no sample. A change stays only if the triangles it touches
//! then have fewer bad contacts than before, counted exactly against all
//! triangles near, so their number falls with every change and the search
//! ends. It widens from the pair to its neighbours, and in the end lets
//! samples go that lie in a tangle nothing else undoes.

use super::mend_coarsen::{area, point_triangle_sq};
use super::mend_mesh::{prev, TriMesh};
use super::mend_shell::is_thin;
use super::raw::NONE;
use crate::context::{Cancelled, Context, Stage};
use crate::geom::vec3::{add, cross, dot, norm, scale, sub};
use crate::geom::Point;
use crate::mesh::clash::{Clash, Reach, Tree};
use std::collections::BTreeSet;

/// How wide the search goes, in steps of escalation.
pub(crate) const LEVELS: usize = 4;

/// What mending did.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mended {
    /// Changes made.
    pub changes: usize,
    /// Samples that are no vertices any more.
    pub samples_lost: usize,
    pub rounds: usize,
}

/// What a length along the surface costs beside one off it.
const EVEN: f64 = 1e-3;

/// A change that can be tried.
#[derive(Clone, Copy, Debug)]
enum Change {
    Collapse(u32),
    Flip(u32),
    Shift(u32, Point),
}

/// Mends `mesh`, whose bad pairs are `pairs`; `tree` holds its triangles, and
/// follows them.
/// `round` rounds a new position as the file will hold it. Triangles count as
/// bad whose vector area is not above `thin`; with 0 those that have exactly
/// none. With fewer `levels` than [`LEVELS`] no sample goes. Tells the pairs
/// that are left.
// Each is a different thing; a struct would only be taken apart again.
#[allow(clippy::too_many_arguments)]
pub(crate) fn mend(
    mesh: &mut TriMesh,
    clash: &Clash,
    tree: &mut Tree,
    pairs: Vec<(u32, u32)>,
    thin: f64,
    levels: usize,
    round: &dyn Fn(Point) -> Point,
    cx: &Context,
) -> Result<(Mended, Vec<(u32, u32)>), Cancelled> {
    let mut done = Mended::default();
    if pairs.is_empty() {
        return Ok((done, pairs));
    }
    let mut work = Work {
        tree,
        mesh,
        clash,
        thin,
        round,
        fan: Vec::new(),
        near: Vec::new(),
        known: BTreeSet::new(),
    };
    work.learn(&pairs);
    let mut queue = pairs;
    for level in 0..levels {
        done.rounds += 1;
        let mut stuck = Vec::new();
        // Last in, first out: what a change leaves is seen to at once.
        queue.reverse();
        let mut steps = 0u64;
        while let Some((s, t)) = queue.pop() {
            steps += 1;
            if steps.is_multiple_of(256) {
                cx.advance(Stage::Crust, 2, 3)?;
            }
            if !work.bad(s, t) {
                continue;
            }
            match work.improve(s, t, level, &mut done) {
                Some(new) => {
                    queue.push((s, t));
                    queue.extend(new);
                }
                None => stuck.push((s, t)),
            }
        }
        stuck.sort_unstable();
        stuck.dedup();
        stuck.retain(|&(s, t)| work.bad(s, t));
        queue = stuck;
        if queue.is_empty() {
            break;
        }
    }
    Ok((done, queue))
}

struct Work<'a> {
    mesh: &'a mut TriMesh,
    clash: &'a Clash,
    thin: f64,
    round: &'a dyn Fn(Point) -> Point,
    tree: &'a mut Tree,
    fan: Vec<u32>,
    near: Vec<u32>,
    /// All bad pairs there are, both ways round.
    known: BTreeSet<(u32, u32)>,
}

impl Work<'_> {
    fn flat(&self, t: u32) -> bool {
        self.clash.is_flat(&self.mesh.place(t))
    }

    /// Whether a pair is still to be mended; a triangle paired with itself
    /// has no area.
    fn bad(&self, s: u32, t: u32) -> bool {
        let mesh = &*self.mesh;
        if !mesh.alive(s) || !mesh.alive(t) {
            return false;
        }
        if s == t {
            return self.flat(s) || is_thin(mesh, s, self.thin);
        }
        !self.flat(s)
            && !self.flat(t)
            && self
                .clash
                .meet(&mesh.points, mesh.tris[s as usize], mesh.tris[t as usize])
    }

    fn learn(&mut self, pairs: &[(u32, u32)]) {
        for &(s, t) in pairs {
            self.known.extend([(s, t), (t, s)]);
        }
    }

    /// The number of bad pairs known of which one is among `touched` (sorted).
    fn known(&self, touched: &[u32]) -> usize {
        let of = |&s: &u32| {
            let pairs = self.known.range((s, 0)..=(s, u32::MAX));
            let once = |&&(_, t): &&(u32, u32)| t >= s || touched.binary_search(&t).is_err();
            pairs.filter(once).count()
        };
        touched.iter().map(of).sum()
    }

    /// The bad pairs of which one is among `touched` (sorted); gives up when
    /// there are `most`.
    fn count(&mut self, touched: &[u32], most: usize, found: &mut Vec<(u32, u32)>) {
        found.clear();
        let mesh = &*self.mesh;
        for &s in touched.iter().filter(|&&s| mesh.alive(s)) {
            if found.len() >= most {
                return;
            }
            let place = mesh.place(s);
            if self.clash.is_flat(&place) {
                found.push((s, s));
                continue;
            }
            let first = found.len();
            if self.thin > 0.0 && is_thin(mesh, s, self.thin) {
                found.push((s, s));
            }
            let reach = Reach::of(&place);
            self.near.clear();
            let near = &mut self.near;
            self.tree.near(&reach, |t| near.push(t));
            // A change that is only tried is not in the tree.
            near.retain(|t| touched.binary_search(t).is_err());
            let later = touched.iter().filter(|&&t| t > s);
            for &t in self.near.iter().chain(later) {
                if !mesh.alive(t) {
                    continue;
                }
                let place = mesh.place(t);
                if reach.meets(&Reach::of(&place))
                    && !self.clash.is_flat(&place)
                    && self
                        .clash
                        .meet(&mesh.points, mesh.tris[s as usize], mesh.tris[t as usize])
                {
                    found.push((s.min(t), s.max(t)));
                    if found.len() >= most {
                        return;
                    }
                }
            }
            found[first..].sort_unstable();
        }
    }

    /// Makes the change that helps most; the bad pairs its triangles have
    /// left, or `None` if none helps.
    fn improve(
        &mut self,
        s: u32,
        t: u32,
        level: usize,
        done: &mut Mended,
    ) -> Option<Vec<(u32, u32)>> {
        let mut changes: Vec<(f64, Change, Vec<u32>, usize)> = Vec::new();
        for change in self.candidates(s, t, level) {
            if let Some((touched, cost)) = self.touched(change) {
                let before = self.known(&touched);
                if before > 0 {
                    changes.push((cost, change, touched, before));
                }
            }
        }
        changes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best: Option<(usize, usize)> = None;
        let mut after = Vec::new();
        for (k, (_, change, touched, before)) in changes.iter().enumerate() {
            // What helps no more than the best so far is not counted to its end.
            let least = best.map_or(0, |(gain, _)| gain);
            let most = before.saturating_sub(least).max(1);
            self.mesh.begin();
            self.apply(*change);
            self.count(touched, most, &mut after);
            self.mesh.take_back();
            if after.len() < most && *before > least {
                best = Some((before - after.len(), k));
            }
            // The cheapest that leaves nothing behind will do.
            if after.is_empty() {
                break;
            }
        }
        let (_, change, touched, _) = changes.swap_remove(best?.1);
        if let Change::Collapse(h) = change {
            let (from, to) = (self.mesh.tail(h), self.mesh.head(h));
            let sample = self.mesh.samples[from as usize];
            done.samples_lost +=
                usize::from(sample != NONE && sample != self.mesh.samples[to as usize]);
        }
        self.apply(change);
        done.changes += 1;
        for &t in &touched {
            let place = self.mesh.alive(t).then(|| self.mesh.place(t));
            self.tree.place(t, place.as_ref());
        }
        self.count(&touched, usize::MAX, &mut after);
        for &s in &touched {
            let pairs = self.known.range((s, 0)..=(s, u32::MAX));
            for (s, t) in pairs.copied().collect::<Vec<_>>() {
                self.known.remove(&(s, t));
                self.known.remove(&(t, s));
            }
        }
        self.learn(&after);
        Some(after)
    }

    /// The triangles a change touches, sorted, and what it costs (the more
    /// the worse); `None` if it cannot be made.
    fn touched(&mut self, change: Change) -> Option<(Vec<u32>, f64)> {
        let mut touched: Vec<u32>;
        let cost;
        match change {
            Change::Collapse(h) => {
                let (from, to) = (self.mesh.tail(h), self.mesh.head(h));
                self.mesh.fan(from, &mut self.fan);
                self.near.clear();
                self.near
                    .extend(self.fan.iter().map(|&h| self.mesh.head(h)));
                if !self.mesh.can_collapse(h, &self.near) {
                    return None;
                }
                touched = self.fan.iter().map(|h| h / 3).collect();
                let p = self.mesh.at(from);
                let off = self.fan.iter().map(|h| {
                    let corners = self.mesh.tris[*h as usize / 3];
                    let ends = corners.map(|v| if v == from { to } else { v });
                    match ends.iter().filter(|&&v| v == to).count() {
                        1 => point_triangle_sq(p, &ends.map(|v| self.mesh.at(v))),
                        _ => f64::INFINITY,
                    }
                });
                let off = off.fold(f64::INFINITY, f64::min).sqrt();
                cost = off + EVEN * norm(sub(p, self.mesh.at(to)));
            }
            Change::Flip(h) => {
                if !self.mesh.can_flip(h) {
                    return None;
                }
                let twin = self.mesh.twin(h);
                let ends = [prev(h), prev(twin)].map(|g| self.mesh.at(self.mesh.tail(g)));
                touched = vec![h / 3, twin / 3];
                let [u, v] = [h, twin].map(|g| self.mesh.at(self.mesh.tail(g)));
                let across = sub(ends[0], ends[1]);
                let normal = cross(sub(v, u), across);
                let size = norm(normal).max(f64::MIN_POSITIVE);
                cost = dot(sub(ends[0], u), normal).abs() / size + EVEN * norm(across);
            }
            Change::Shift(v, p) => {
                self.mesh.fan(v, &mut self.fan);
                touched = self.fan.iter().map(|h| h / 3).collect();
                cost = norm(sub(self.mesh.at(v), p));
            }
        }
        touched.sort_unstable();
        touched.dedup();
        Some((touched, cost))
    }

    fn apply(&mut self, change: Change) {
        match change {
            Change::Collapse(h) => {
                let from = self.mesh.tail(h);
                self.mesh.fan(from, &mut self.fan);
                let fan = std::mem::take(&mut self.fan);
                self.mesh.collapse(h, &fan);
                self.fan = fan;
            }
            Change::Flip(h) => self.mesh.flip(h),
            Change::Shift(v, p) => self.mesh.shift(v, p),
        }
    }

    /// What to try, in an order of its own.
    fn candidates(&mut self, s: u32, t: u32, level: usize) -> Vec<Change> {
        let mesh = &*self.mesh;
        let mut vertices: Vec<u32> = [s, t].iter().flat_map(|&t| mesh.tris[t as usize]).collect();
        let mut fan = Vec::new();
        let widen = |vertices: &mut Vec<u32>, fan: &mut Vec<u32>| {
            for k in 0..vertices.len() {
                mesh.fan(vertices[k], fan);
                vertices.extend(fan.iter().map(|&h| mesh.head(h)));
            }
            vertices.sort_unstable();
            vertices.dedup();
        };
        vertices.sort_unstable();
        vertices.dedup();
        for _ in 0..level.min(2) {
            widen(&mut vertices, &mut fan);
        }
        let mut changes = Vec::new();
        for &v in &vertices {
            mesh.fan(v, &mut fan);
            let free = mesh.samples[v as usize] == NONE;
            let movable = mesh.movable[v as usize];
            for &h in &fan {
                if free || level == LEVELS - 1 || mesh.at(v) == mesh.at(mesh.head(h)) {
                    changes.push(Change::Collapse(h));
                }
                if v < mesh.head(h) {
                    changes.push(Change::Flip(h));
                }
            }
            if movable {
                self.shifts(v, &fan, level, &mut changes);
            }
        }
        changes
    }

    /// Places where a vertex could go: toward the middle of its neighbours,
    /// and to either side of its triangles.
    fn shifts(&self, v: u32, fan: &[u32], level: usize, changes: &mut Vec<Change>) {
        let mesh = &*self.mesh;
        let p = mesh.at(v);
        let share = 1.0 / fan.len() as f64;
        let (mut middle, mut normal, mut height) = ([0.0; 3], [0.0; 3], f64::INFINITY);
        for &h in fan {
            middle = add(middle, scale(mesh.at(mesh.head(h)), share));
            let (n, longest) = area(&mesh.place(h / 3));
            normal = add(normal, n);
            height = height.min(longest);
        }
        let mut push = |q: Point| {
            let q = (self.round)(q);
            if q != p {
                changes.push(Change::Shift(v, q));
            }
        };
        let toward = sub(middle, p);
        let steps: &[f64] = if level == 0 {
            &[1.0, 0.3]
        } else {
            &[1.0, 0.5, 0.2, 0.05, 0.01]
        };
        for &k in steps {
            push(add(p, scale(toward, k)));
        }
        let size = norm(normal);
        if size > 0.0 && height.is_finite() {
            let reach = height.sqrt() / size;
            for &k in steps {
                for side in [-0.3, 0.3] {
                    push(add(p, scale(normal, side * k * reach)));
                }
            }
        }
    }
}
