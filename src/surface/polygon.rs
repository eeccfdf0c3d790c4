//! Triangles for one polygon, without new vertices.
//!
//! The polygon is projected along the main axis of its vector area, so that
//! the projected coordinates are coordinates of the corners themselves and
//! `orient2d` decides exactly: a triangle of positive projected area has area
//! in space. Convex polygons start as a fan, others by clipping ears, large
//! ones as spade's constrained Delaunay triangulation; then diagonals are
//! flipped while that enlarges the smaller angle opposite to them, measured
//! in space. For polygons in a plane the result is the constrained Delaunay
//! triangulation, whose smallest angle is the largest possible.
//!
//! Corners are taken from the lexicographically first position on, so the
//! result depends on the shape of the polygon and not on where its list
//! starts.

use super::flat::{collinear, main_axis, orient, vector_area};
use super::unfold::least_folded;
use crate::geom::vec3::{cross, dot, norm, sub};
use crate::geom::Point;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// From this many corners on, polygons that are not convex go to spade:
/// clipping ears takes quadratic time at best.
const LARGE: usize = 48;

/// Triangulates polygons one after the other, keeping its buffers.
#[derive(Default)]
pub(crate) struct PolygonTriangulator {
    /// The triangles of the last polygon, as positions in its list.
    pub triangles: Vec<[u32; 3]>,
    /// Corners in canonical order, as positions in the list.
    ring: Vec<u32>,
    /// Positions of the corners in canonical order.
    points: Vec<Point>,
    left: Vec<u32>,
    edges: Vec<(u32, u32, u32)>,
    twin: Vec<u32>,
    stack: Vec<u32>,
    /// Axes of the projection, such that the polygon turns left.
    axes: (usize, usize),
}

impl PolygonTriangulator {
    /// Triangulates the polygon `corners` with the given positions; `allowed`
    /// says whether two corners, by position in the list, may be joined.
    /// False if that cannot be done well without a new vertex.
    pub fn run(&mut self, corners: &[Point], allowed: impl Fn(u32, u32) -> bool) -> bool {
        self.triangles.clear();
        let n = corners.len() as u32;
        let first = (0..n).min_by(|&a, &b| {
            let (a, b) = (corners[a as usize], corners[b as usize]);
            a.partial_cmp(&b).unwrap_or(std::cmp::Ordering::Equal)
        });
        let Some(first) = first.filter(|_| n >= 3) else {
            return false;
        };
        self.ring.clear();
        self.ring.extend((first..n).chain(0..first));
        self.points.clear();
        let ring = self.ring.iter();
        self.points.extend(ring.map(|&c| corners[c as usize]));
        let ring = std::mem::take(&mut self.ring);
        let allowed = |a: u32, b: u32| allowed(ring[a as usize], ring[b as usize]);
        let done = match n {
            3 => self.fan(),
            4 => self.quad(&allowed),
            _ => self.many(&allowed),
        };
        let points = &self.points;
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|c| points[c as usize]);
            !collinear(a, b, c)
        };
        let done = done && self.triangles.iter().all(area);
        for t in &mut self.triangles {
            *t = t.map(|c| ring[c as usize]);
        }
        self.ring = ring;
        done
    }

    /// The fan of a polygon of `n` corners from the first on, seen or not.
    pub fn fan_of(&mut self, n: usize) {
        self.triangles.clear();
        let last = (n as u32).saturating_sub(1);
        self.triangles.extend((1..last).map(|k| [0, k, k + 1]));
    }

    fn at(&self, corner: u32) -> Point {
        self.points[corner as usize]
    }

    fn fan(&mut self) -> bool {
        self.fan_of(self.points.len());
        true
    }

    /// The better of the two diagonals: no fold, then the larger angle.
    fn quad(&mut self, allowed: &impl Fn(u32, u32) -> bool) -> bool {
        let splits = [[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]];
        let mut best: Option<(bool, f64, usize)> = None;
        for (k, (split, ends)) in splits.iter().zip([(0, 2), (1, 3)]).enumerate() {
            let [s, t] = split.map(|t| t.map(|c| self.at(c)));
            let flat = collinear(s[0], s[1], s[2]) || collinear(t[0], t[1], t[2]);
            if flat || !allowed(ends.0, ends.1) {
                continue;
            }
            let smooth = dot(normal(s), normal(t)) > 0.0;
            let quality = sharpness(s).min(sharpness(t));
            if best.is_none_or(|b| (smooth, quality) > (b.0, b.1)) {
                best = Some((smooth, quality, k));
            }
        }
        let Some((_, _, k)) = best else {
            return false;
        };
        self.triangles.extend(splits[k]);
        true
    }

    fn many(&mut self, allowed: &impl Fn(u32, u32) -> bool) -> bool {
        let area = vector_area(self.points.iter().copied());
        let axis = main_axis(area);
        let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
        self.axes = if area[axis] > 0.0 { (x, y) } else { (y, x) };
        let legal = |tri: &[[u32; 3]], n: u32| {
            tri.iter().all(|t| {
                (0..3).all(|k| is_side(t[k], t[(k + 1) % 3], n) || allowed(t[k], t[(k + 1) % 3]))
            })
        };
        let n = self.points.len() as u32;
        if self.convex() {
            self.fan();
            if legal(&self.triangles, n) {
                self.match_fan();
                self.flip(allowed);
                return true;
            }
        } else if n as usize >= LARGE
            && self.delaunay()
            && legal(&self.triangles, n)
            && self.match_twins()
        {
            self.flip(allowed);
            return true;
        }
        // Forbidden diagonals can be in the way of a fan only.
        if n as usize <= 8 * LARGE && self.clip_ears(allowed) && self.match_twins() {
            self.flip(allowed);
            return true;
        }
        self.triangles.clear();
        least_folded(&self.points, allowed, &mut self.triangles)
    }

    fn turn(&self, a: u32, b: u32, c: u32) -> f64 {
        let (x, y) = self.axes;
        orient(self.at(a), self.at(b), self.at(c), x, y)
    }

    /// Whether the projection is convex and a fan from corner 0 has triangles
    /// of positive area only.
    fn convex(&self) -> bool {
        let n = self.points.len() as u32;
        (1..n - 1).all(|k| self.turn(0, k, k + 1) > 0.0)
            && (0..n).all(|k| self.turn(k, (k + 1) % n, (k + 2) % n) >= 0.0)
    }

    fn clip_ears(&mut self, allowed: &impl Fn(u32, u32) -> bool) -> bool {
        self.triangles.clear();
        self.left.clear();
        self.left.extend(0..self.points.len() as u32);
        while self.left.len() > 3 {
            let n = self.left.len();
            let corner = |k: usize| self.left[k % n];
            let ear = (0..n).find(|&k| {
                let (a, b, c) = (corner(k + n - 1), corner(k), corner(k + 1));
                self.turn(a, b, c) > 0.0
                    && allowed(a, c)
                    && self.left.iter().all(|&p| {
                        p == a
                            || p == b
                            || p == c
                            || self.turn(a, b, p) < 0.0
                            || self.turn(b, c, p) < 0.0
                            || self.turn(c, a, p) < 0.0
                    })
            });
            let Some(k) = ear else {
                return false;
            };
            self.triangles
                .push([corner(k + n - 1), corner(k), corner(k + 1)]);
            self.left.remove(k);
        }
        let [a, b, c] = [self.left[0], self.left[1], self.left[2]];
        self.triangles.push([a, b, c]);
        self.turn(a, b, c) > 0.0
    }

    /// spade's constrained triangulation, if the projection is simple.
    fn delaunay(&mut self) -> bool {
        let n = self.points.len();
        let (x, y) = self.axes;
        let flat = self.points.iter().map(|p| Point2::new(p[x], p[y]));
        let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
        let mut handles = Vec::with_capacity(n);
        for p in flat {
            match cdt.insert(p) {
                Ok(handle) if handle.index() == handles.len() => handles.push(handle),
                _ => return false,
            }
        }
        for k in 0..n {
            let (a, b) = (handles[k], handles[(k + 1) % n]);
            cdt.try_add_constraint(a, b);
            if cdt.get_edge_from_neighbors(a, b).is_none() {
                return false;
            }
        }
        // Inside is what lies left of the sides; spread from there.
        let mut inside = vec![false; cdt.num_all_faces()];
        let mut stack = Vec::new();
        for k in 0..n {
            let edge = cdt.get_edge_from_neighbors(handles[k], handles[(k + 1) % n]);
            stack.extend(edge.and_then(|e| e.face().as_inner()));
        }
        self.triangles.clear();
        while let Some(face) = stack.pop() {
            if std::mem::replace(&mut inside[face.fix().index()], true) {
                continue;
            }
            self.triangles
                .push(face.vertices().map(|v| v.index() as u32));
            for edge in face.adjacent_edges() {
                if !edge.is_constraint_edge() {
                    stack.extend(edge.rev().face().as_inner());
                }
            }
        }
        self.triangles.len() == n - 2
    }

    /// Flips diagonals until none is opposite to angles of more than two
    /// right angles in all.
    fn flip(&mut self, allowed: &impl Fn(u32, u32) -> bool) {
        self.stack.clear();
        let twins = self.twin.iter().enumerate();
        self.stack.extend(
            twins
                .filter(|&(h, &t)| t != u32::MAX && (h as u32) < t)
                .map(|(h, _)| h as u32),
        );
        // Flips end by themselves in exact arithmetic; the limit is for the
        // rounding of angles.
        let mut budget = 16 * self.points.len() * self.points.len();
        while let Some(h) = self.stack.pop() {
            let t = self.twin[h as usize];
            if t == u32::MAX || budget == 0 {
                continue;
            }
            budget -= 1;
            let (u, v) = (self.origin(h), self.origin(t));
            let (w, x) = (self.origin(before(h)), self.origin(before(t)));
            if cotangent(self.at(u), self.at(w), self.at(v))
                + cotangent(self.at(v), self.at(x), self.at(u))
                > -1e-9
                || self.turn(u, x, w) <= 0.0
                || self.turn(x, v, w) <= 0.0
                || !allowed(x, w)
            {
                continue;
            }
            // Sides v-w, w-u belong to the triangle of h, u-x, x-v to that of t.
            let (vw, wu, ux, xv) = (after(h), before(h), after(t), before(t));
            let outside = [vw, wu, ux, xv].map(|s| self.twin[s as usize]);
            let (s, t) = (h / 3, t / 3);
            self.triangles[s as usize] = [u, x, w];
            self.triangles[t as usize] = [x, v, w];
            self.link(3 * s, outside[2]);
            self.link(3 * s + 2, outside[1]);
            self.link(3 * t, outside[3]);
            self.link(3 * t + 1, outside[0]);
            self.link(3 * s + 1, 3 * t + 2);
            self.stack
                .extend([3 * s, 3 * s + 2, 3 * t, 3 * t + 1].iter());
        }
    }

    fn origin(&self, h: u32) -> u32 {
        self.triangles[h as usize / 3][h as usize % 3]
    }

    fn link(&mut self, a: u32, b: u32) {
        self.twin[a as usize] = b;
        if b != u32::MAX {
            self.twin[b as usize] = a;
        }
    }

    /// The twins of a fan: the last side of a triangle is the first of the
    /// next.
    fn match_fan(&mut self) {
        let sides = 3 * self.triangles.len() as u32;
        self.twin.clear();
        self.twin.resize(sides as usize, u32::MAX);
        for h in (3..sides).step_by(3) {
            self.link(h - 1, h);
        }
    }

    /// The twins of any triangles; false if they are no triangulation.
    fn match_twins(&mut self) -> bool {
        let n = self.points.len() as u32;
        self.twin.clear();
        self.twin.resize(3 * self.triangles.len(), u32::MAX);
        self.edges.clear();
        for (h, t) in (0..).step_by(3).zip(&self.triangles) {
            for k in 0..3 {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                if !is_side(a, b, n) {
                    self.edges.push((a.min(b), a.max(b), h + k as u32));
                }
            }
        }
        self.edges.sort_unstable();
        for pair in self.edges.chunks(2) {
            match *pair {
                [a, b] if (a.0, a.1) == (b.0, b.1) => {
                    self.twin[a.2 as usize] = b.2;
                    self.twin[b.2 as usize] = a.2;
                }
                _ => return false,
            }
        }
        true
    }
}

/// Half-edge `3 t + k` is side `k` of triangle `t`.
fn after(h: u32) -> u32 {
    h - h % 3 + (h + 1) % 3
}

fn before(h: u32) -> u32 {
    h - h % 3 + (h + 2) % 3
}

fn is_side(a: u32, b: u32, n: u32) -> bool {
    (a + 1) % n == b || (b + 1) % n == a
}

fn normal(t: [Point; 3]) -> Point {
    cross(sub(t[1], t[0]), sub(t[2], t[0]))
}

/// The cotangent of the angle at `b`.
fn cotangent(a: Point, b: Point, c: Point) -> f64 {
    let (u, v) = (sub(a, b), sub(c, b));
    dot(u, v) / norm(cross(u, v))
}

/// Grows with the smallest angle: minus its cotangent.
fn sharpness([a, b, c]: [Point; 3]) -> f64 {
    let (ab, bc, ca) = (sub(b, a), sub(c, b), sub(a, c));
    // Minus the largest dot product of two sides from a corner.
    let most = dot(ca, ab).min(dot(ab, bc)).min(dot(bc, ca));
    most / norm(cross(ab, bc))
}
