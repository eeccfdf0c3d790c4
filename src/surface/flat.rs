//! Faces without area, and how they go.
//!
//! A face all of whose corners lie on a line has no inside: it is a seam that
//! was not sewn. Sewing it means giving every edge of the face the corners of
//! the face that lie between its ends, so that the walk along the face takes
//! the same short steps out and back; cutting it at repeated places (see
//! `contract`) then leaves only faces of two edges, which vanish. The
//! neighbours gain corners on their straight sides, so they keep their shape,
//! and no T-joint remains.
//!
//! This ends: each step replaces an edge by two shorter ones between places
//! that exist already, and there are finitely many lengths. The lengths are
//! compared where a tolerance makes 'on a line' approximate; on an exact line
//! they need not be.

use super::contract::{Cutter, Places};
use super::halfedges::HalfEdges;
use crate::geom::vec3::{add, cross, dist_sq, norm_sq, sub};
use crate::geom::Point;
use robust::{orient2d, Coord};

/// Whether three points lie on a line, or so nearly that their area comes
/// out as zero in `f64`.
pub(crate) fn collinear(a: Point, b: Point, c: Point) -> bool {
    let (u, v) = (sub(b, a), sub(c, a));
    let n = cross(u, v);
    let size = largest(u) * largest(v);
    // Differences and products are each within 2^-53 of the truth.
    if largest(n) > 1e-15 * size && size > 1e-280 {
        return false;
    }
    n == [0.0; 3] || exactly_collinear(a, b, c)
}

fn exactly_collinear(a: Point, b: Point, c: Point) -> bool {
    [(0, 1), (1, 2), (2, 0)]
        .iter()
        .all(|&(x, y)| orient(a, b, c, x, y) == 0.0)
}

/// The sign of the area of three points projected on the axes `x`, `y`.
pub(crate) fn orient(a: Point, b: Point, c: Point, x: usize, y: usize) -> f64 {
    let flat = |p: Point| Coord { x: p[x], y: p[y] };
    orient2d(flat(a), flat(b), flat(c))
}

fn largest(v: Point) -> f64 {
    v[0].abs().max(v[1].abs()).max(v[2].abs())
}

/// The axis along which `v` is longest.
pub(crate) fn main_axis(v: Point) -> usize {
    let size = v.map(f64::abs);
    if size[0] >= size[1] && size[0] >= size[2] {
        0
    } else if size[1] >= size[2] {
        1
    } else {
        2
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Shape {
    Area,
    /// All corners within the tolerance of a line along the axis.
    Seam {
        axis: usize,
        exact: bool,
    },
    /// Not on a line, yet the vector area is exactly zero (a bow-tie).
    Balanced,
}

/// Brings faces into shape: cuts them at repeated places and sews seams.
pub(crate) struct Tailor<'a> {
    pub places: &'a Places,
    /// A face whose corners all lie this near to a line is a seam.
    pub tolerance: f64,
    pub cutter: Cutter,
    queue: Vec<u32>,
    corners: Vec<u32>,
    order: Vec<u32>,
    /// Seams may not add more half-edges than this in all: the argument above
    /// needs no limit, rounding in the comparison of lengths might.
    budget: usize,
}

impl<'a> Tailor<'a> {
    pub fn new(places: &'a Places, tolerance: f64, surface: &HalfEdges) -> Tailor<'a> {
        Tailor {
            places,
            tolerance,
            cutter: Cutter::new(places.positions.len()),
            queue: Vec::new(),
            corners: Vec::new(),
            order: Vec::new(),
            budget: 4 * surface.len() + 64,
        }
    }

    /// Brings the face of `h` into shape, and all that change because of it.
    pub fn settle(&mut self, surface: &mut HalfEdges, h: u32) {
        self.queue.push(h);
        while let Some(h) = self.queue.pop() {
            if !surface.alive(h) {
                continue;
            }
            self.cutter.cut(surface, h);
            for k in 0..self.cutter.pieces.len() {
                let first = self.cutter.pieces[k];
                self.corners.clear();
                let mut at = first;
                while self.corners.is_empty() || at != first {
                    self.corners.push(at);
                    at = surface.next(at);
                }
                match self.shape(surface) {
                    Shape::Area => {}
                    Shape::Seam { axis, exact } => self.sew(surface, axis, exact),
                    Shape::Balanced => self.halve(surface),
                }
            }
        }
    }

    fn shape(&self, surface: &HalfEdges) -> Shape {
        let at = |h: u32| self.places.at(surface.tail(h));
        let origin = at(self.corners[0]);
        let farthest = |from: Point| {
            let mut best = (0.0, from);
            for &h in &self.corners {
                let d = dist_sq(from, at(h));
                if d > best.0 {
                    best = (d, at(h));
                }
            }
            best.1
        };
        let a = farthest(origin);
        let b = farthest(a);
        let along = sub(b, a);
        let limit = self.tolerance * self.tolerance * norm_sq(along);
        let mut exact = true;
        for &h in &self.corners {
            if !collinear(a, b, at(h)) {
                exact = false;
                if norm_sq(cross(along, sub(at(h), a))) > limit {
                    return self.area(surface);
                }
            }
        }
        let axis = main_axis(along);
        Shape::Seam { axis, exact }
    }

    fn area(&self, surface: &HalfEdges) -> Shape {
        if self.corners.len() == 3 {
            return Shape::Area;
        }
        let at = |h: u32| self.places.at(surface.tail(h));
        let points = self.corners.iter().map(|&h| at(h));
        if vector_area(points) == [0.0; 3] {
            Shape::Balanced
        } else {
            Shape::Area
        }
    }

    fn sew(&mut self, surface: &mut HalfEdges, axis: usize, exact: bool) {
        let places = self.places;
        let key = |place: u32| {
            let p = places.at(place);
            [p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]]
        };
        let before = |a: u32, b: u32| key(a) < key(b);
        self.order.clear();
        self.order
            .extend(self.corners.iter().map(|&h| surface.tail(h)));
        self.order
            .sort_unstable_by(|&a, &b| key(a).partial_cmp(&key(b)).unwrap_or(a.cmp(&b)));
        let mut sewn = false;
        for k in 0..self.corners.len() {
            let mut at = self.corners[k];
            let forward = before(surface.tail(at), surface.head(at));
            let mut changed = false;
            for j in 0..self.order.len() {
                let place = match forward {
                    true => self.order[j],
                    false => self.order[self.order.len() - 1 - j],
                };
                let (tail, head) = (surface.tail(at), surface.head(at));
                let between = if forward {
                    before(tail, place) && before(place, head)
                } else {
                    before(place, tail) && before(head, place)
                };
                if !between || self.budget == 0 {
                    continue;
                }
                let (a, b, c) = (places.at(tail), places.at(place), places.at(head));
                let whole = dist_sq(a, c);
                if exact || (dist_sq(a, b) < whole && dist_sq(b, c) < whole) {
                    at = surface.subdivide(at, place);
                    self.budget -= 1;
                    changed = true;
                }
            }
            if changed {
                self.queue.push(surface.twin(at));
                sewn = true;
            }
        }
        if sewn {
            self.queue.push(self.corners[0]);
        }
    }

    /// Cuts a face of zero vector area, which must have four corners or more,
    /// between its first and third corners.
    fn halve(&mut self, surface: &mut HalfEdges) {
        let last = self.corners[self.corners.len() - 1];
        surface.chord(last, self.corners[1]);
        self.queue.push(self.corners[0]);
        self.queue.push(self.corners[2]);
    }
}

/// Whether a closed polygon has a vector area beyond doubt, so its corners are
/// on no line.
pub(crate) fn has_area(points: &[Point]) -> bool {
    let n = points.len();
    if n < 3 {
        return false;
    }
    let origin = points[0];
    let (mut sum, mut before, mut size) = ([0.0; 3], sub(points[1], origin), 0.0f64);
    size = size.max(largest(before));
    for &p in &points[2..] {
        let p = sub(p, origin);
        sum = add(sum, cross(before, p));
        size = size.max(largest(p));
        before = p;
    }
    // Each of the n terms is off by less than 10 size² / 2^53, and adding it
    // rounds a sum of at most 2 n size².
    let n = n as f64;
    largest(sum) > 1e-14 * n * n * size * size && size * size > 1e-280
}

/// Twice the vector area of a closed polygon.
pub(crate) fn vector_area(mut points: impl Iterator<Item = Point>) -> Point {
    let Some(origin) = points.next() else {
        return [0.0; 3];
    };
    let mut sum = [0.0; 3];
    let mut before = [0.0; 3];
    for p in points {
        let p = sub(p, origin);
        let n = cross(before, p);
        sum = [sum[0] + n[0], sum[1] + n[1], sum[2] + n[2]];
        before = p;
    }
    sum
}
