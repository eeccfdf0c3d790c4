//! Points on the boundary of a union of balls.
//!
//! A point of a ball's sphere lies on the boundary if no neighbour of the ball
//! in the power diagram holds it: others cannot (the sphere's part of the
//! boundary lies in the ball's power cell). Points are taken
//!
//! - on the spheres, spread evenly (a Fibonacci lattice);
//! - for the boundary itself, also where two spheres meet in a circle and
//!   three in a corner: those are the creases;
//! - for a smooth surface in the middle of what is left of each sphere
//!   instead. There the balls of a medial axis touch the solid they were made
//!   of; the creases between them lie inside of it. Small pieces, which an even
//!   spread may miss, are found by their corners.
//!
//! - where the outside is narrower than points are apart: between two balls,
//!   in the opening between three and the hollow between four, on each towards
//!   the place from which all are as far. Those are simplices that the dual
//!   complex does not have.
//!
//! These decisions are made in floats: a point more or less is no harm.

use std::f64::consts::TAU;

use rayon::prelude::*;

use crate::axis::LabelledBalls;
use crate::context::{Context, Portion, Stage};
use crate::error::Error;
use crate::geom::vec3::plain::{dist_sq, dot, norm};
use crate::geom::vec3::{add, cross, scale, sub};
use crate::geom::{Ball, Point};
use crate::tetra::{Edges, FACETS};

/// The least and the largest spacing of points on the sphere of a ball for a
/// smooth surface, as shares of its radius: at most 2,300 points.
const APART: [f64; 2] = [0.08, 0.25];
/// A point in the middle stands for all within this many times the distance
/// from it to the crease.
const STANDS_FOR: f64 = 1.5;
/// Points on a sphere: at least and at most.
const LEAST: f64 = 32.0;
const MOST: f64 = 65_536.0;
/// Corners seen from the centre within this cosine belong to one piece.
const PIECE: f64 = 0.97;

/// A point on the boundary with the direction out of the union.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    pub at: Point,
    pub normal: Point,
    /// Whether the outside or the inside is narrow here.
    pub narrow: bool,
}

/// How many points are taken.
#[derive(Clone, Copy, Debug)]
pub(super) enum Spread {
    /// In the middle of what is left of each sphere, and where much is left so
    /// that faces between them are off it by no more than this.
    Middles(f64),
    /// So that faces between them are off the spheres by no more than this.
    Within(f64),
}

impl Spread {
    fn spacing(self, radius: f64) -> f64 {
        match self {
            // Of a triangle of side s the middle is s / √3 from the corners.
            Spread::Middles(off) => {
                let [least, most] = APART.map(|share| share * radius);
                (6.0 * radius * off).sqrt().clamp(least, most)
            }
            Spread::Within(off) => (6.0 * radius * off).sqrt().min(radius),
        }
    }
}

/// Points on the boundary of the union of all balls.
pub(super) fn touches(
    balls: &LabelledBalls,
    spread: Spread,
    context: &Context,
) -> Result<Vec<Touch>, Error> {
    let progress = Portion {
        context,
        stage: Stage::Samples,
        percent: [0, 50],
    };
    let graph = balls.neighbours(&progress)?;
    let seen = balls.visible();
    let union = Union {
        balls: &balls.balls,
        graph: &graph,
    };
    let corners = union.corners(balls);
    let count = balls.balls.len();
    let found: Vec<Vec<Touch>> = (0..count as u32)
        .into_par_iter()
        .map(|b| match seen[b as usize] {
            false => Vec::new(),
            true => match spread {
                Spread::Middles(_) => union.middles(b, spread, &corners),
                Spread::Within(_) => union.everywhere(b, spread, &corners),
            },
        })
        .collect();
    let mut found: Vec<Touch> = found.into_iter().flatten().collect();
    let narrow = union.narrow(balls, spread);
    found.extend(narrow.into_iter().map(|t| Touch { narrow: true, ..t }));
    Ok(found)
}

struct Union<'a> {
    balls: &'a [Ball],
    graph: &'a Edges,
}

impl Union<'_> {
    fn ball(&self, b: u32) -> &Ball {
        &self.balls[b as usize]
    }

    /// Whether no neighbour of a ball but `except` holds a point of its
    /// sphere. `last` is who held the last one.
    fn is_free(&self, b: u32, p: Point, except: &[u32], last: &mut u32) -> bool {
        let holds = |k: u32| {
            let ball = self.ball(k);
            dist_sq(p, ball.centre) < ball.radius * ball.radius
        };
        if *last != b && !except.contains(last) && holds(*last) {
            return false;
        }
        let holder = (self.graph.at(b).iter()).find(|k| !except.contains(k) && holds(**k));
        if let Some(&k) = holder {
            *last = k;
        }
        holder.is_none()
    }

    /// How far a point of a ball's sphere is from the nearest crease, about.
    fn clearance(&self, b: u32, p: Point) -> f64 {
        let own = self.ball(b);
        let far = |&k: &u32| {
            let ball = self.ball(k);
            let both = own.radius + ball.radius;
            if dist_sq(own.centre, ball.centre) >= both * both {
                return f64::INFINITY;
            }
            let power = dist_sq(p, ball.centre) - ball.radius * ball.radius;
            power / (2.0 * dist_sq(own.centre, ball.centre).sqrt())
        };
        let all = self.graph.at(b).iter().map(far);
        all.fold(own.radius, f64::min)
    }

    fn on_sphere(&self, b: u32, direction: Point) -> Touch {
        let ball = self.ball(b);
        Touch {
            at: add(ball.centre, scale(direction, ball.radius)),
            normal: direction,
            narrow: false,
        }
    }

    /// Points spread over what is left of a sphere.
    fn spread(&self, b: u32, spacing: f64) -> Vec<Touch> {
        let radius = self.ball(b).radius;
        // Points of a triangular pattern have so much room each.
        let room = 0.866 * spacing * spacing;
        let count = 2.0 * TAU * radius * radius / room;
        let count = count.clamp(LEAST, MOST) as usize;
        let mut last = b;
        (0..count)
            .map(|k| self.on_sphere(b, fibonacci(k, count)))
            .filter(|t| self.is_free(b, t.at, &[], &mut last))
            .collect()
    }

    /// Points in the middle of what is left of a sphere.
    fn middles(&self, b: u32, spread: Spread, corners: &Corners) -> Vec<Touch> {
        let ball = self.ball(b);
        let spacing = spread.spacing(ball.radius);
        let mut found = self.spread(b, spacing);
        let mut rest: Vec<Point> = (corners.at(b).iter())
            .map(|c| scale(sub(c.at, ball.centre), 1.0 / ball.radius))
            .collect();
        let mut last = b;
        while let Some(&first) = rest.first() {
            let sum =
                (rest.iter().filter(|d| dot(**d, first) > PIECE)).fold([0.0; 3], |s, &d| add(s, d));
            rest.retain(|d| dot(*d, first) <= PIECE && *d != first);
            let size = norm(sum);
            if size > 0.0 {
                let touch = self.on_sphere(b, scale(sum, 1.0 / size));
                if self.is_free(b, touch.at, &[], &mut last) {
                    found.push(touch);
                }
            }
        }
        let mut clear: Vec<(f64, Touch)> = (found.into_iter())
            .map(|t| (self.clearance(b, t.at), t))
            .collect();
        clear.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut kept: Vec<(f64, Touch)> = Vec::new();
        for (clearance, touch) in clear {
            // Beside a crease points count for less: it is to be bridged.
            let beside = 2.0 * clearance < spacing;
            let stood_for = |&(reach, by): &(f64, Touch)| {
                let reach = if beside {
                    reach
                } else {
                    reach.min(0.99 * spacing)
                };
                dist_sq(by.at, touch.at) < reach * reach
            };
            if !kept.iter().any(stood_for) {
                kept.push(((STANDS_FOR * clearance).max(0.1 * spacing), touch));
            }
        }
        let mut found: Vec<Touch> = kept.into_iter().map(|(_, touch)| touch).collect();
        // Thin places are not to be bridged: their creases count.
        let thin = |c: &&Corner| c.apart < spacing;
        found.extend(
            corners
                .at(b)
                .iter()
                .filter(thin)
                .map(|c| self.crease(c.at, &c.balls)),
        );
        let later = self.graph.at(b).iter().filter(|&&k| k > b);
        for &other in later {
            found.extend(self.ring(b, other, |radius| (2.0 * radius < spacing).then_some(6.0)));
        }
        found
    }

    /// Points on what is left of a sphere and on the creases where it meets
    /// those of later balls.
    fn everywhere(&self, b: u32, spread: Spread, corners: &Corners) -> Vec<Touch> {
        let ball = self.ball(b);
        let spacing = spread.spacing(ball.radius);
        let mut found = self.spread(b, spacing);
        for &other in self.graph.at(b).iter().filter(|&&k| k > b) {
            let step = spacing.min(spread.spacing(self.ball(other).radius));
            found.extend(self.ring(b, other, |radius| Some(TAU * radius / step)));
        }
        found.extend(
            corners
                .at(b)
                .iter()
                .filter(|c| c.balls[0] == b)
                .map(|c| self.crease(c.at, &c.balls)),
        );
        found
    }

    /// Points on the circle in which two spheres meet, as many as its radius
    /// asks for.
    fn ring(&self, b: u32, other: u32, count: impl Fn(f64) -> Option<f64>) -> Vec<Touch> {
        let circle = circle(self.ball(b), self.ball(other));
        let counted = circle.and_then(|circle| Some((circle, count(circle.2)?)));
        let Some(((middle, along, radius), count)) = counted else {
            return Vec::new();
        };
        let (u, v) = across(along);
        let count = count.clamp(6.0, MOST) as usize;
        let mut last = b;
        (0..count)
            .map(|k| {
                let (sine, cosine) = (TAU * k as f64 / count as f64).sin_cos();
                let off = add(scale(u, radius * cosine), scale(v, radius * sine));
                add(middle, off)
            })
            .filter(|&at| self.is_free(b, at, &[other], &mut last))
            .map(|at| self.crease(at, &[b, other]))
            .collect()
    }

    /// Points where the outside is narrow.
    fn narrow(&self, of: &LabelledBalls, spread: Spread) -> Vec<Touch> {
        let power = of.power();
        let mut simplices: Vec<([u32; 4], usize)> = (power.complex.cells.par_iter())
            .flat_map_iter(|cell| {
                let mut own = *cell;
                own.sort_unstable();
                let real = own.iter().filter(|&&v| !power.is_sentinel(v)).count();
                (1u32..1 << real).filter_map(move |bits| {
                    let mut simplex = [0; 4];
                    let mut size = 0;
                    for k in (0..real).filter(|k| bits >> k & 1 == 1) {
                        simplex[size] = own[k];
                        size += 1;
                    }
                    (size > 1).then_some((simplex, size))
                })
            })
            .filter(|(simplex, size)| self.place_between(&simplex[..*size], spread).is_some())
            .collect();
        simplices.par_sort_unstable();
        simplices.dedup();
        let towards = |(simplex, size): &([u32; 4], usize)| {
            let simplex = &simplex[..*size];
            let place = self.place_between(simplex, spread);
            let found: Vec<Touch> = (simplex.iter())
                .filter_map(|&b| {
                    let to = sub(place?, self.ball(b).centre);
                    let touch = self.on_sphere(b, scale(to, 1.0 / norm(to)));
                    self.is_free(b, touch.at, &[], &mut { b }).then_some(touch)
                })
                .collect();
            found
        };
        simplices.par_iter().flat_map_iter(towards).collect()
    }

    /// The place from which the spheres of two to four balls are as far, in
    /// power, if it lies outside of them and nearer than points on them are
    /// apart.
    fn place_between(&self, simplex: &[u32], spread: Spread) -> Option<Point> {
        let ball = |k: usize| self.ball(simplex[k]);
        let a = ball(0);
        let to = match simplex.len() {
            2 => {
                let (u, value) = equal(a, ball(1));
                scale(u, value / dot(u, u))
            }
            3 => axis(a, ball(1), ball(2)).0,
            _ => {
                let ((u, p), (v, q), (w, r)) =
                    (equal(a, ball(1)), equal(a, ball(2)), equal(a, ball(3)));
                let (vw, wu, uv) = (cross(v, w), cross(w, u), cross(u, v));
                let volume = dot(u, vw);
                [0, 1, 2].map(|k| (vw[k] * p + wu[k] * q + uv[k] * r) / volume)
            }
        };
        let power = dot(to, to) - a.radius * a.radius;
        let least = simplex.iter().map(|&b| spread.spacing(self.ball(b).radius));
        let near = least.fold(f64::INFINITY, f64::min);
        (power > 0.0 && power < 4.0 * near * near).then(|| add(a.centre, to))
    }

    /// A point where spheres meet.
    fn crease(&self, at: Point, balls: &[u32]) -> Touch {
        let out = balls.iter().fold([0.0; 3], |sum, &b| {
            let ball = self.ball(b);
            add(sum, scale(sub(at, ball.centre), 1.0 / ball.radius))
        });
        let size = norm(out);
        Touch {
            at,
            normal: scale(out, if size > 0.0 { 1.0 / size } else { 0.0 }),
            narrow: false,
        }
    }

    /// All corners of the boundary.
    fn corners(&self, of: &LabelledBalls) -> Corners {
        let power = of.power();
        let mut triples: Vec<[u32; 3]> = (power.complex.cells.par_iter())
            .flat_map_iter(|cell| {
                FACETS.into_iter().filter_map(move |facet| {
                    let mut triple = facet.map(|k| cell[k]);
                    triple.sort_unstable();
                    (!power.is_sentinel(triple[2])).then_some(triple)
                })
            })
            .collect();
        triples.par_sort_unstable();
        triples.dedup();
        let found: Vec<Corner> = (triples.par_iter())
            .flat_map_iter(|&balls| {
                let [a, b, c] = balls.map(|k| self.ball(k));
                let mut last = balls[0];
                let both = meeting(a, b, c);
                let apart = both.map_or(0.0, |[p, q]| dist_sq(p, q).sqrt());
                let corner = |at| Corner { at, balls, apart };
                let free = |c: &Corner| self.is_free(balls[0], c.at, &balls[1..], &mut last);
                let two: Vec<Corner> = both
                    .into_iter()
                    .flatten()
                    .map(corner)
                    .filter(free)
                    .collect();
                two
            })
            .collect();
        Corners::of(found, self.balls.len())
    }
}

/// Where three spheres meet on the boundary.
#[derive(Clone, Copy, Debug)]
struct Corner {
    at: Point,
    balls: [u32; 3],
    /// How far the other point is where these spheres meet.
    apart: f64,
}

/// Corners by ball.
struct Corners {
    starts: Vec<u32>,
    items: Vec<Corner>,
}

impl Corners {
    fn of(corners: Vec<Corner>, balls: usize) -> Corners {
        let mut all: Vec<(u32, Corner)> = (corners.into_iter())
            .flat_map(|c| c.balls.map(|b| (b, c)))
            .collect();
        all.sort_by_key(|c| c.0);
        let mut starts = vec![0u32; balls + 1];
        for (b, _) in &all {
            starts[*b as usize + 1] += 1;
        }
        for b in 0..balls {
            starts[b + 1] += starts[b];
        }
        Corners {
            starts,
            items: all.into_iter().map(|c| c.1).collect(),
        }
    }

    fn at(&self, b: u32) -> &[Corner] {
        let b = b as usize;
        &self.items[self.starts[b] as usize..self.starts[b + 1] as usize]
    }
}

/// The `k`-th of so many directions, evenly spread.
fn fibonacci(k: usize, count: usize) -> Point {
    // The golden angle.
    const TURN: f64 = 2.399_963_229_728_653;
    let z = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
    let (sine, cosine) = (k as f64 * TURN).sin_cos();
    let rho = (1.0 - z * z).sqrt();
    [rho * cosine, rho * sine, z]
}

/// Two directions at right angles to one and to each other.
fn across(along: Point) -> (Point, Point) {
    let least = (1..3).fold(0, |k, j| {
        if along[j].abs() < along[k].abs() {
            j
        } else {
            k
        }
    });
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let u = cross(along, axis);
    let u = scale(u, 1.0 / norm(u));
    (u, cross(along, u))
}

/// The circle in which two spheres meet: middle, axis and radius.
fn circle(a: &Ball, b: &Ball) -> Option<(Point, Point, f64)> {
    let between = sub(b.centre, a.centre);
    let far = norm(between);
    let along = scale(between, 1.0 / far);
    let t = (far * far + a.radius * a.radius - b.radius * b.radius) / (2.0 * far);
    let radius_sq = a.radius * a.radius - t * t;
    (radius_sq > 0.0).then(|| (add(a.centre, scale(along, t)), along, radius_sq.sqrt()))
}

/// What the plane of equal power of two balls says, seen from the first:
/// `u x = value`.
fn equal(a: &Ball, b: &Ball) -> (Point, f64) {
    let u = sub(b.centre, a.centre);
    let squares = a.radius * a.radius - b.radius * b.radius;
    (u, (dot(u, u) + squares) / 2.0)
}

/// The line of equal power of three balls: its point in the plane of their
/// centres, seen from the first; its direction; and minus the power there.
fn axis(a: &Ball, b: &Ball, c: &Ball) -> (Point, Point, f64) {
    let ((u, p), (v, q)) = (equal(a, b), equal(a, c));
    let normal = cross(u, v);
    let area = dot(normal, normal);
    let (to_u, to_v) = (cross(v, normal), cross(normal, u));
    let middle = [0, 1, 2].map(|k| (to_u[k] * p + to_v[k] * q) / area);
    (middle, normal, a.radius * a.radius - dot(middle, middle))
}

/// The two points in which three spheres meet.
fn meeting(a: &Ball, b: &Ball, c: &Ball) -> Option<[Point; 2]> {
    let (middle, normal, left) = axis(a, b, c);
    let half = left.sqrt() / norm(normal);
    let at = |side: f64| add(a.centre, add(middle, scale(normal, side * half)));
    (left > 0.0 && half.is_finite()).then(|| [at(1.0), at(-1.0)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_spheres_meet_where_they_must() {
        let ball = |x: f64, y: f64| Ball::new([x, y, 0.0], 2f64.sqrt());
        let [p, q] = meeting(
            &ball(1.0, 0.0),
            &ball(-0.5, 0.75f64.sqrt()),
            &ball(-0.5, -(0.75f64.sqrt())),
        )
        .unwrap();
        assert!((p[2].abs() - 1.0).abs() < 1e-12 && p[0].abs() < 1e-12 && p[1].abs() < 1e-12);
        assert!((p[2] + q[2]).abs() < 1e-12);
        assert!(meeting(&ball(9.0, 0.0), &ball(0.0, 0.0), &ball(0.0, 1.0)).is_none());
        let (middle, along, radius) = circle(&ball(1.0, 0.0), &ball(-1.0, 0.0)).unwrap();
        assert!(norm(middle) < 1e-12 && along == [-1.0, 0.0, 0.0]);
        assert!((radius - 1.0).abs() < 1e-12);
    }
}
