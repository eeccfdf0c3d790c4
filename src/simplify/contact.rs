//! What the samples on a ball span (section 7.3 of the paper: `S_p` and
//! `d_p`), the measure behind every filter of a medial axis.
//!
//! A ball is told by the samples it touches: how far apart they are, how
//! large the smallest ball around them is, how densely the surface is sampled
//! there. Three numbers a ball are all the filters need, so they go into files
//! and the samples need not.

use crate::geom::vec3::{add, cross, dist_sq, dot, scale, sub};
use crate::geom::Point;

/// The samples that each ball touches, ball after ball.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Touching {
    /// Ball `b` touches `samples[starts[b]..starts[b + 1]]`, ascending.
    pub starts: Vec<u32>,
    /// Sample ids.
    pub samples: Vec<u32>,
}

impl Touching {
    /// The samples that ball `b` touches, ascending; none for a ball beyond
    /// those listed.
    pub fn at(&self, b: u32) -> &[u32] {
        let b = b as usize;
        match (self.starts.get(b), self.starts.get(b + 1)) {
            (Some(&from), Some(&to)) => &self.samples[from as usize..to as usize],
            _ => &[],
        }
    }
}

/// What the samples on one ball span, in the units of the ball.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Contact {
    /// The largest distance between two of them: `d_p` of section 7.3.
    pub diameter: f64,
    /// The radius of the smallest ball around them: what the lambda-medial
    /// axis (Chazal and Lieutier 2005) compares with lambda.
    pub circumradius: f64,
    /// The spacing of the samples there, the largest of those at the samples;
    /// 0 where it is not known.
    pub spacing: f64,
}

impl Contact {
    /// Measures the samples of a ball at the given places. Of more than 256
    /// samples the diameter may be too small by a thousandth.
    ///
    /// ```
    /// use powercrust::simplify::Contact;
    /// let places = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let contact = Contact::of(&places, 0.5);
    /// assert_eq!((contact.diameter, contact.circumradius), (2.0, 1.0));
    /// ```
    pub fn of(places: &[Point], spacing: f64) -> Contact {
        let diameter = diameter(places);
        // With two samples the smallest ball is known.
        let circumradius = match places.len() {
            0..=2 => diameter / 2.0,
            _ => smallest_ball(places).1.max(0.0).sqrt().max(diameter / 2.0),
        };
        Contact {
            diameter,
            circumradius,
            spacing,
        }
    }

    /// The angle in degrees under which the centre of a ball of this radius
    /// sees the two samples farthest apart: 180 where they are opposite.
    pub fn angle(&self, radius: f64) -> f64 {
        if radius <= 0.0 {
            return 0.0;
        }
        let sine = (self.diameter / (2.0 * radius)).clamp(0.0, 1.0);
        2.0 * sine.asin().to_degrees()
    }
}

/// Sets up to this size are searched pair by pair.
const FEW: usize = 256;

/// The largest distance between two points.
fn diameter(places: &[Point]) -> f64 {
    if places.len() > FEW {
        return far_apart(places);
    }
    let mut most = 0.0f64;
    for (k, &p) in places.iter().enumerate() {
        for &q in &places[..k] {
            most = most.max(dist_sq(p, q));
        }
    }
    most.sqrt()
}

/// The same for many points: from point to farthest point until no farther
/// one is found, from a start in each of several directions. Where that
/// reaches a bound from above, the search ends.
fn far_apart(places: &[Point]) -> f64 {
    let (_, around) = smallest_ball(places);
    let bound = 4.0 * around;
    let farthest = |from: Point| {
        let far = |best: (f64, Point), &p: &Point| {
            let d = dist_sq(from, p);
            if d > best.0 {
                (d, p)
            } else {
                best
            }
        };
        places.iter().fold((0.0, from), far)
    };
    const DIRECTIONS: [Point; 7] = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [1.0, 1.0, -1.0],
        [1.0, -1.0, 1.0],
        [-1.0, 1.0, 1.0],
    ];
    let mut most = 0.0f64;
    for direction in DIRECTIONS {
        let along = |p: &Point| dot(*p, direction);
        let highest = |a: &Point, b: &Point| along(a).total_cmp(&along(b));
        let Some(&start) = places.iter().max_by(|a, b| highest(a, b)) else {
            break;
        };
        let (mut here, mut reached) = (start, 0.0);
        loop {
            let (d, p) = farthest(here);
            if d <= reached {
                break;
            }
            (reached, here) = (d, p);
        }
        most = most.max(reached);
        if most >= bound * 0.999 {
            break;
        }
    }
    most.sqrt()
}

/// A point is outside a ball, as centre and squared radius, and not by
/// rounding alone.
fn outside(ball: (Point, f64), p: Point) -> bool {
    dist_sq(ball.0, p) > ball.1 * (1.0 + 1e-12)
}

/// The smallest ball around points, as centre and squared radius: the ball of
/// a few, then of those on its border and the point farthest outside, until
/// none is outside (Gärtner 1999). It grows each time.
fn smallest_ball(places: &[Point]) -> (Point, f64) {
    let Some(&first) = places.first() else {
        return ([0.0; 3], 0.0);
    };
    let mut border = vec![first];
    let mut ball = (first, 0.0);
    loop {
        let far = |best: (f64, Point), &p: &Point| {
            let d = dist_sq(ball.0, p);
            if d > best.0 {
                (d, p)
            } else {
                best
            }
        };
        let (_, p) = places.iter().fold((0.0, ball.0), far);
        if !outside(ball, p) {
            return ball;
        }
        border.push(p);
        let larger = smallest_ball_of_few(&border);
        if larger.1 <= ball.1 {
            return ball;
        }
        ball = larger;
        border.retain(|&p| dist_sq(ball.0, p) >= ball.1 * (1.0 - 1e-9));
    }
}

/// The same for a few points, which are taken in turn: one that is outside is
/// on the border of the ball of all so far (Welzl 1991, without recursion).
fn smallest_ball_of_few(places: &[Point]) -> (Point, f64) {
    let mut ball = (places[0], 0.0);
    for i in 1..places.len() {
        if !outside(ball, places[i]) {
            continue;
        }
        ball = (places[i], 0.0);
        for j in 0..i {
            if !outside(ball, places[j]) {
                continue;
            }
            ball = of_two(places[i], places[j]);
            for k in 0..j {
                if !outside(ball, places[k]) {
                    continue;
                }
                ball = of_three(places[i], places[j], places[k]);
                for l in 0..k {
                    if outside(ball, places[l]) {
                        let four = [places[i], places[j], places[k], places[l]];
                        ball = of_four(four).unwrap_or((ball.0, dist_sq(ball.0, places[l])));
                    }
                }
            }
        }
    }
    ball
}

fn of_two(a: Point, b: Point) -> (Point, f64) {
    (scale(add(a, b), 0.5), dist_sq(a, b) / 4.0)
}

/// The smallest ball through three points; of nearly collinear ones that of
/// the two farthest apart.
fn of_three(a: Point, b: Point, c: Point) -> (Point, f64) {
    let (u, v) = (sub(b, a), sub(c, a));
    let normal = cross(u, v);
    let (area, uu, vv) = (dot(normal, normal), dot(u, u), dot(v, v));
    if area <= 1e-24 * uu * vv {
        let pairs = [of_two(a, b), of_two(b, c), of_two(c, a)];
        return pairs
            .into_iter()
            .fold(pairs[0], |m, p| if p.1 > m.1 { p } else { m });
    }
    let to = scale(
        add(scale(cross(v, normal), uu), scale(cross(normal, u), vv)),
        0.5 / area,
    );
    (add(a, to), dot(to, to))
}

/// The ball through four points; none where they are nearly in one plane.
fn of_four([a, b, c, d]: [Point; 4]) -> Option<(Point, f64)> {
    let (u, v, w) = (sub(b, a), sub(c, a), sub(d, a));
    let volume = dot(u, cross(v, w));
    let size = (dot(u, u) * dot(v, v) * dot(w, w)).sqrt();
    if volume.abs() <= 1e-12 * size {
        return None;
    }
    let sum = add(
        add(scale(cross(v, w), dot(u, u)), scale(cross(w, u), dot(v, v))),
        scale(cross(u, v), dot(w, w)),
    );
    let to = scale(sum, 0.5 / volume);
    Some((add(a, to), dot(to, to)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on the unit sphere, evenly spread.
    fn sphere(count: usize) -> Vec<Point> {
        let at = |k: usize| {
            let z = (2.0 * k as f64 + 1.0) / count as f64 - 1.0;
            let (angle, r) = (2.399_963 * k as f64, (1.0 - z * z).sqrt());
            [r * angle.cos(), r * angle.sin(), z]
        };
        (0..count).map(at).collect()
    }

    #[test]
    fn a_few_points() {
        assert_eq!(Contact::of(&[], 0.0), Contact::default());
        assert_eq!(Contact::of(&[[3.0, 1.0, 2.0]], 0.0), Contact::default());
        // An equilateral triangle of side 1: circumradius 1 / sqrt(3).
        let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.75f64.sqrt(), 0.0]];
        let contact = Contact::of(&triangle, 0.0);
        assert!((contact.diameter - 1.0).abs() < 1e-15);
        assert!((contact.circumradius - 1.0 / 3f64.sqrt()).abs() < 1e-15);
        // A regular tetrahedron: circumradius sqrt(3) of edges sqrt(8).
        let corners = [
            [1.0, 1.0, 1.0],
            [1.0, -1.0, -1.0],
            [-1.0, 1.0, -1.0],
            [-1.0, -1.0, 1.0],
        ];
        let contact = Contact::of(&corners, 0.0);
        assert!((contact.diameter - 8f64.sqrt()).abs() < 1e-15);
        assert!((contact.circumradius - 3f64.sqrt()).abs() < 1e-14);
        // Points in one line are spanned by their ends.
        let line: Vec<Point> = (0..5).map(|k| [f64::from(k), 0.0, 0.0]).collect();
        let contact = Contact::of(&line, 0.0);
        assert_eq!((contact.diameter, contact.circumradius), (4.0, 2.0));
    }

    #[test]
    fn the_smallest_ball_holds_all_and_is_held_by_some() {
        for count in [5, 17, 60] {
            let mut places = sphere(count);
            for (k, p) in places.iter_mut().enumerate() {
                *p = scale(*p, 1.0 + 0.3 * ((k * 7919) % 13) as f64);
            }
            let (centre, r2) = smallest_ball(&places);
            let far: Vec<f64> = places.iter().map(|&p| dist_sq(p, centre)).collect();
            assert!(far.iter().all(|&d| d <= r2 * (1.0 + 1e-9)));
            let border = far.iter().filter(|&&d| d >= r2 * (1.0 - 1e-9)).count();
            assert!(border >= 2, "{border}");
        }
    }

    #[test]
    fn many_points_are_measured_to_a_thousandth() {
        let places = sphere(3000);
        let mut most = 0.0f64;
        for (k, &p) in places.iter().enumerate() {
            for &q in &places[..k] {
                most = most.max(dist_sq(p, q).sqrt());
            }
        }
        let found = diameter(&places);
        assert!(found <= most && found >= 0.999 * most, "{found} of {most}");
    }

    #[test]
    fn the_angle_is_seen_from_the_centre() {
        let opposite = Contact {
            diameter: 2.0,
            ..Contact::default()
        };
        assert_eq!(opposite.angle(1.0), 180.0);
        assert!((opposite.angle(2.0) - 60.0).abs() < 1e-12);
        assert_eq!(opposite.angle(0.0), 0.0);
    }
}
