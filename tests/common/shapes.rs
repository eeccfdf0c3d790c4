//! Shapes whose surface, topology, volume and (mostly) medial axis are known
//! exactly, each with a sampler that is uniform by area.

use super::random::Random;
use powercrust::geom::vec3::{add, cross, dot, norm, scale, sub};
use powercrust::Point;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// What is true of the solid's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Number of connected surfaces.
    pub components: usize,
    /// Sum of their genera.
    pub genus: i64,
    /// Volume of the solid.
    pub volume: f64,
}

/// A solid with a known boundary.
pub trait Shape: Sync {
    fn name(&self) -> &'static str;

    fn truth(&self) -> Truth;

    /// Appends random surface points, uniform by area: one, several or none.
    fn draw(&self, random: &mut Random, into: &mut Vec<Point>);

    /// The distance to the surface, negative inside. Exact, unless the shape
    /// says that it is exact near its surface only.
    fn signed_distance(&self, p: Point) -> f64;

    /// The distance to the inner medial axis, where that is known.
    fn axis_distance(&self, _: Point) -> Option<f64> {
        None
    }

    /// A random point on a sharp edge, for shapes that have some.
    fn edge_point(&self, _: &mut Random) -> Option<Point> {
        None
    }

    /// The first `count` random samples of a seed.
    fn samples(&self, count: usize, seed: u64) -> Vec<Point> {
        let mut random = Random::new(seed);
        let mut points = Vec::with_capacity(count + 8);
        while points.len() < count {
            self.draw(&mut random, &mut points);
        }
        points.truncate(count);
        points
    }

    /// `count` random samples no nearer to each other than `spacing`, or as
    /// many as find room (darts, thrown until 5,000 in a row miss): the even
    /// sampling of the baseline in medial-axis-specs 2.11.
    fn spaced_samples(&self, count: usize, spacing: f64, seed: u64) -> Vec<Point> {
        let mut random = Random::new(seed);
        let (mut points, mut darts) = (Vec::new(), Vec::new());
        let mut near = HashMap::<[i64; 3], Vec<Point>>::new();
        let mut misses = 0;
        while points.len() < count && misses < 5_000 {
            self.draw(&mut random, &mut darts);
            for dart in darts.drain(..) {
                let [i, j, k] = dart.map(|x| (x / spacing).floor() as i64);
                let mut around = (0..27).flat_map(|n| {
                    near.get(&[i + n % 3 - 1, j + n / 3 % 3 - 1, k + n / 9 - 1])
                        .into_iter()
                        .flatten()
                });
                if around.any(|&other| norm(sub(other, dart)) < spacing) {
                    misses += 1;
                } else {
                    misses = 0;
                    near.entry([i, j, k]).or_default().push(dart);
                    points.push(dart);
                }
            }
        }
        points.truncate(count);
        points
    }
}

/// Every shape of the quick set.
pub fn all() -> Vec<Box<dyn Shape>> {
    vec![
        Box::new(UNIT_SPHERE),
        Box::new(Ellipsoid([1.0, 2.0, 3.0])),
        Box::new(Ellipsoid([3.0, 2.0, 1.0])),
        Box::new(TORUS),
        Box::new(DOUBLE_TORUS),
        Box::new(SHELL),
        Box::new(TOUCHING),
        Box::new(CAPSULE),
        Box::new(ROUNDED_PLATE),
        Box::new(THIN_PLATE),
        Box::new(CYLINDER),
        Box::new(CUBE),
        Box::new(CAD_BLOCK),
    ]
}

pub const UNIT_SPHERE: Sphere = Sphere {
    centre: [0.0; 3],
    radius: 1.0,
};
pub const TORUS: Torus = Torus {
    centre_x: 0.0,
    major: 1.0,
    minor: 0.4,
};
pub const DOUBLE_TORUS: DoubleTorus = DoubleTorus {
    major: 1.0,
    minor: 0.3,
    blend: 0.08,
};
pub const SHELL: Shell = Shell {
    outer: 1.0,
    inner: 0.5,
};
pub const TOUCHING: TouchingSpheres = TouchingSpheres { radii: [1.0, 0.75] };
pub const CAPSULE: Rounded = Rounded {
    half: [0.0, 0.0, 1.0],
    radius: 0.5,
};
pub const ROUNDED_PLATE: Rounded = Rounded {
    half: [1.0, 0.75, 0.0],
    radius: 0.1,
};
pub const THIN_PLATE: Cuboid = Cuboid {
    name: "thin plate",
    half: [1.0, 0.75, 0.06],
};
pub const CUBE: Cuboid = Cuboid {
    name: "cube",
    half: [1.0; 3],
};
pub const CYLINDER: Cylinder = Cylinder {
    radius: 0.5,
    half_height: 1.5,
};
pub const CAD_BLOCK: Block = Block {
    half: [2.0, 1.0, 0.75],
    hole: 0.5,
};

/// A ball.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    pub centre: Point,
    pub radius: f64,
}

impl Shape for Sphere {
    fn name(&self) -> &'static str {
        "sphere"
    }

    fn truth(&self) -> Truth {
        Truth {
            components: 1,
            genus: 0,
            volume: ball_volume(self.radius),
        }
    }

    fn draw(&self, random: &mut Random, into: &mut Vec<Point>) {
        into.push(add(self.centre, scale(random.direction(), self.radius)));
    }

    fn signed_distance(&self, p: Point) -> f64 {
        norm(sub(p, self.centre)) - self.radius
    }

    fn axis_distance(&self, p: Point) -> Option<f64> {
        Some(norm(sub(p, self.centre)))
    }
}

fn ball_volume(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

/// An ellipsoid by its semi-axes along x, y and z.
#[derive(Clone, Copy, Debug)]
pub struct Ellipsoid(pub [f64; 3]);

impl Ellipsoid {
    /// The indices of the semi-axes from the longest to the shortest.
    fn order(&self) -> [usize; 3] {
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| self.0[j].total_cmp(&self.0[i]));
        order
    }

    /// The semi-axes of the flat elliptic disc that is the medial axis
    /// (medial-axis-specs 3.12), for the two longer semi-axes.
    pub fn disc(&self) -> [f64; 2] {
        let [a, b, c] = self.order().map(|i| self.0[i]);
        [a - c * c / a, b - c * c / b]
    }

    /// Points spread over that disc, for one-sided distances from it.
    pub fn axis_points(&self, count: usize, seed: u64) -> Vec<Point> {
        let (order, disc) = (self.order(), self.disc());
        let mut random = Random::new(seed);
        (0..count)
            .map(|_| {
                let (sin, cos) = random.angle().sin_cos();
                let rho = random.unit().sqrt();
                let mut p = [0.0; 3];
                p[order[0]] = disc[0] * rho * cos;
                p[order[1]] = disc[1] * rho * sin;
                p
            })
            .collect()
    }
}

impl Shape for Ellipsoid {
    fn name(&self) -> &'static str {
        "ellipsoid"
    }

    fn truth(&self) -> Truth {
        Truth {
            components: 1,
            genus: 0,
            volume: ball_volume(1.0) * self.0.iter().product::<f64>(),
        }
    }

    /// A direction u goes to (a ux, b uy, c uz); the area grows there by abc
    /// times the length of (ux/a, uy/b, uz/c).
    fn draw(&self, random: &mut Random, into: &mut Vec<Point>) {
        let u = random.direction();
        let shortest = self.0.into_iter().fold(f64::INFINITY, f64::min);
        let growth = norm([u[0] / self.0[0], u[1] / self.0[1], u[2] / self.0[2]]);
        if random.unit() < growth * shortest {
            into.push([u[0] * self.0[0], u[1] * self.0[1], u[2] * self.0[2]]);
        }
    }

    fn signed_distance(&self, p: Point) -> f64 {
        let inside = (0..3).map(|k| (p[k] / self.0[k]).powi(2)).sum::<f64>() < 1.0;
        let distance = distance_to_ellipsoid(p, self.0);
        if inside {
            -distance
        } else {
            distance
        }
    }

    fn axis_distance(&self, p: Point) -> Option<f64> {
        let [i, j, k] = self.order();
        let disc = self.disc();
        let inside = (p[i] / disc[0]).powi(2) + (p[j] / disc[1]).powi(2) <= 1.0;
        let in_plane = if inside {
            0.0
        } else {
            distance_to_ellipsoid([p[i], p[j]], disc)
        };
        Some(in_plane.hypot(p[k]))
    }
}

/// The distance from a point to an ellipse or ellipsoid (after Eberly): the
/// nearest point is `e² y / (u + e² - m²)`, m the shortest semi-axis, at the
/// only root u >= 0 of the equation of the ellipsoid.
pub fn distance_to_ellipsoid<const N: usize>(point: [f64; N], axes: [f64; N]) -> f64 {
    let y = point.map(f64::abs);
    let shortest = (0..N).fold(0, |s, i| if axes[i] < axes[s] { i } else { s });
    let m = axes[shortest];
    let over = |i: usize, u: f64| u + (axes[i] - m) * (axes[i] + m);
    let nearest = |u: f64| -> [f64; N] {
        std::array::from_fn(|i| axes[i] * axes[i] * y[i] / over(i, u).max(f64::MIN_POSITIVE))
    };
    let equation = |u: f64| {
        let sum: f64 = (0..N)
            .filter(|&i| y[i] > 0.0)
            .map(|i| (axes[i] * y[i] / over(i, u)).powi(2))
            .sum();
        sum - 1.0
    };
    let mut low = m * y[shortest];
    let mut high = (0..N).map(|i| (axes[i] * y[i]).powi(2)).sum::<f64>().sqrt();
    let mut foot;
    if low == 0.0 && equation(0.0) <= 0.0 {
        // Straight above the medial axis: the foot is off the point's plane.
        foot = nearest(0.0);
        foot[shortest] = 0.0;
        let used: f64 = (0..N).map(|i| (foot[i] / axes[i]).powi(2)).sum();
        foot[shortest] = m * (1.0 - used).max(0.0).sqrt();
    } else {
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if equation(middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        foot = nearest(high);
    }
    (0..N).map(|i| (foot[i] - y[i]).powi(2)).sum::<f64>().sqrt()
}

/// A torus about the z direction through `(centre_x, 0, 0)`.
#[derive(Clone, Copy, Debug)]
pub struct Torus {
    pub centre_x: f64,
    pub major: f64,
    pub minor: f64,
}

impl Torus {
    fn core_distance(&self, p: Point) -> f64 {
        ((p[0] - self.centre_x).hypot(p[1]) - self.major).hypot(p[2])
    }

    /// The unit vector away from the core circle.
    fn outward(&self, p: Point) -> Point {
        let (x, y) = (p[0] - self.centre_x, p[1]);
        let rho = x.hypot(y);
        let (along, up) = (rho - self.major, p[2]);
        let length = along.hypot(up);
        [
            along / length * x / rho,
            along / length * y / rho,
            up / length,
        ]
    }
}

impl Shape for Torus {
    fn name(&self) -> &'static str {
        "torus"
    }

    fn truth(&self) -> Truth {
        Truth {
            components: 1,
            genus: 1,
            volume: PI * self.minor.powi(2) * TAU * self.major,
        }
    }

    fn draw(&self, random: &mut Random, into: &mut Vec<Point>) {
        let (sin_u, cos_u) = random.angle().sin_cos();
        let (sin_v, cos_v) = random.angle().sin_cos();
        let rho = self.major + self.minor * cos_v;
        if random.within(0.0, self.major + self.minor) < rho {
            into.push([self.centre_x + rho * cos_u, rho * sin_u, self.minor * sin_v]);
        }
    }

    fn signed_distance(&self, p: Point) -> f64 {
        self.core_distance(p) - self.minor
    }

    fn axis_distance(&self, p: Point) -> Option<f64> {
        Some(self.core_distance(p))
    }
}

/// Two tori side by side, melted into one surface of genus 2 by the smooth
/// minimum `-k log(exp(-a/k) + exp(-b/k))` of their distances.
#[derive(Clone, Copy, Debug)]
pub struct DoubleTorus {
    pub major: f64,
    pub minor: f64,
    /// k.
    pub blend: f64,
}

impl DoubleTorus {
    fn tori(&self) -> [Torus; 2] {
        [-1.0, 1.0].map(|side| Torus {
            centre_x: side * self.major,
            major: self.major,
            minor: self.minor,
        })
    }

    /// The smooth minimum: zero on the surface, of slope at most 1.
    pub fn value(&self, p: Point) -> f64 {
        let [a, b] = self.tori().map(|torus| torus.signed_distance(p));
        a.min(b) - self.blend * (-(a - b).abs() / self.blend).exp().ln_1p()
    }

    fn gradient(&self, p: Point) -> Point {
        let tori = self.tori();
        let [a, b] = tori.map(|torus| torus.signed_distance(p));
        let share = 1.0 / (1.0 + ((a - b) / self.blend).exp());
        add(
            scale(tori[0].outward(p), share),
            scale(tori[1].outward(p), 1.0 - share),
        )
    }

    fn project(&self, mut p: Point) -> Point {
        for _ in 0..8 {
            let slope = self.gradient(p);
            p = sub(p, scale(slope, self.value(p) / dot(slope, slope)));
        }
        p
    }
}

impl Shape for DoubleTorus {
    fn name(&self) -> &'static str {
        "double torus"
    }

    /// The volume by columns of small cubes, each counted by the share of it
    /// that a plane at its distance cuts off.
    fn truth(&self) -> Truth {
        let step = 0.025;
        let side = self.minor + 2.0 * self.blend;
        let steps = |half: f64| (half / step).ceil() as usize;
        let at = |i: usize| (i as f64 + 0.5) * step;
        let mut volume = 0.0;
        for x in 0..steps(2.0 * self.major + side) {
            for y in 0..steps(self.major + side) {
                for z in 0..steps(side) {
                    let p = [at(x), at(y), at(z)];
                    let slope = norm(self.gradient(p)).max(0.1);
                    volume += (0.5 - self.value(p) / (slope * step)).clamp(0.0, 1.0);
                }
            }
        }
        Truth {
            components: 1,
            genus: 2,
            volume: 8.0 * volume * step.powi(3),
        }
    }

    fn draw(&self, random: &mut Random, into: &mut Vec<Point>) {
        let reach = 2.0 * self.major + self.minor + self.blend;
        let start = into.len();
        line_hits(&|p| self.value(p), reach, random, into);
        for hit in &mut into[start..] {
            *hit = self.project(*hit);
        }
    }

    /// Exact near the surface: walks from the foot of the gradient to the
    /// nearest surface point.
    fn signed_distance(&self, p: Point) -> f64 {
        let mut foot = self.project(p);
        for _ in 0..20 {
            let slope = self.gradient(foot);
            let normal = scale(slope, 1.0 / norm(slope));
            let away = sub(p, foot);
            let along = sub(away, scale(normal, dot(away, normal)));
            if norm(along) < 1e-15 {
                break;
            }
            foot = self.project(add(foot, along));
        }
        norm(sub(p, foot)).copysign(self.value(p))
    }
}

/// The hits of a random line with the surface `value = 0` of slope at most 1
/// within `reach` of the origin. Lines uniform in direction and offset hit a
/// surface uniformly by area (Cauchy and Crofton), whatever its shape.
pub fn line_hits(
    value: &dyn Fn(Point) -> f64,
    reach: f64,
    random: &mut Random,
    into: &mut Vec<Point>,
) {
    let along = random.direction();
    let helper = if along[0].abs() < 0.6 {
        [1.0, 0.0, 0.0]
    } else {
        [0.0, 1.0, 0.0]
    };
    let side = cross(along, helper);
    let side = scale(side, reach / norm(side));
    let (sin, cos) = random.angle().sin_cos();
    let rho = random.unit().sqrt();
    let offset = add(scale(side, rho * cos), scale(cross(along, side), rho * sin));
    let at = |t: f64| add(offset, scale(along, t));
    let least = 1e-3 * reach;
    let mut t = -reach;
    let mut here = value(at(t));
    while t < reach {
        let ahead = t + here.abs().max(least);
        let there = value(at(ahead));
        if (here < 0.0) != (there < 0.0) {
            let (mut low, mut high) = (t, ahead);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if (value(at(middle)) < 0.0) == (here < 0.0) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            into.push(at(high));
        }
        (t, here) = (ahead, there);
    }
}

/// The solid between two concentric spheres.
#[derive(Clone, Copy, Debug)]
pub struct Shell {
    pub outer: f64,
    pub inner: f64,
}

impl Shape for Shell {
    fn name(&self) -> &'static str {
        "nested spheres"
    }

    fn truth(&self) -> Truth {
        Truth {
            components: 2,
            genus: 0,
            volume: ball_volume(self.outer) - ball_volume(self.inner),
        }
    }

    fn draw(&self, random: &mut Random, into: &mut Vec<Point>) {
        let share = self.outer.powi(2) / (self.outer.powi(2) + self.inner.powi(2));
        let radius = if random.unit() < share {
            self.outer
        } else {
            self.inner
        };
        into.push(scale(random.direction(), radius));
    }

    fn signed_distance(&self, p: Point) -> f64 {
        (norm(p) - self.outer).max(self.inner - norm(p))
    }

    fn axis_distance(&self, p: Point) -> Option<f64> {
        Some((norm(p) - 0.5 * (self.outer + self.inner)).abs())
    }
}

/// Two balls that touch at the origin, their centres on the x axis. At the
/// touching point the feature size is zero and no sampling is dense enough:
/// one component or two are both right there.
#[derive(Clone, Copy, Debug)]
pub struct TouchingSpheres {
    pub radii: [f64; 2],
}

impl TouchingSpheres {
    fn spheres(&self) -> [Sphere; 2] {
        let sphere = |radius: f64, side: f64| Sphere {
            centre: [side * radius, 0.0, 0.0],
            radius,
        };
        [sphere(self.radii[0], -1.0), sphere(self.radii[1], 1.0)]
    }
}

impl Shape for TouchingSpheres {
    fn name(&self) -> &'static str {
        "touching spheres"
    }

    fn truth(&self) -> Truth {
        Truth {
            components: 2,
            genus: 0,
            volume: self.radii.into_iter().map(ball_volume).sum(),
        }
    }

    fn draw(&self, random: &mut Random, into: &mut Vec<Point>) {
        let [a, b] = self.spheres();
        let share = a.radius.powi(2) / (a.radius.powi(2) + b.radius.powi(2));
        let sphere = if random.unit() < share { a } else { b };
        sphere.draw(random, into);
    }

    fn signed_distance(&self, p: Point) -> f64 {
        let [a, b] = self.spheres().map(|sphere| sphere.signed_distance(p));
        a.min(b)
    }

    fn axis_distance(&self, p: Point) -> Option<f64> {
        let [a, b] = self.spheres().map(|sphere| norm(sub(p, sphere.centre)));
        Some(a.min(b))
    }
}

/// All points within `radius` of a rectangle in the plane z = 0 or of a
/// segment on the z axis: a plate with a round rim, or a capsule. What it is
/// about is its medial axis.
#[derive(Clone, Copy, Debug)]
pub struct Rounded {
    /// Half sides of the rectangle (z 0) or of the segment (x and y 0).
    pub half: [f64; 3],
    pub radius: f64,
}

impl Rounded {
    fn core_distance(&self, p: Point) -> f64 {
        norm(std::array::from_fn(|k| {
            (p[k].abs() - self.half[k]).max(0.0)
        }))
    }
}

impl Shape for Rounded {
    fn name(&self) -> &'static str {
        if self.half[2] > 0.0 {
            "capsule"
        } else {
            "rounded plate"
        }
    }

    /// Steiner's formula.
    fn truth(&self) -> Truth {
        let [x, y, z] = self.half.map(|half| 2.0 * half);
        let r = self.radius;
        Truth {
            components: 1,
            genus: 0,
            volume: 2.0 * r * (x * y) + PI * r * r * (x + y + z) + ball_volume(r),
        }
    }

    /// Flats, half or whole tubes, and round corners, each by its area.
    fn draw(&self, random: &mut Random, into: &mut Vec<Point>) {
        let [x, y, z] = self.half;
        let r = self.radius;
        let areas = [8.0 * x * y, TAU * r * 2.0 * (x + y + z), 4.0 * PI * r * r];
        let mut pick = random.unit() * areas.iter().sum::<f64>();
        if pick < areas[0] {
            into.push([
                random.within(-x, x),
                random.within(-y, y),
                r * random.sign(),
            ]);
            return;
        }
        pick -= areas[0];
        if pick >= areas[1] {
            let u = random.direction();
            into.push(std::array::from_fn(|k| {
                r * u[k] + self.half[k].copysign(u[k])
            }));
            return;
        }
        // A whole tube along one side, its halves moved to the two rims.
        let mut left = pick / (TAU * r * 2.0);
        let along = (0..3)
            .find(|&k| {
                left -= self.half[k];
                left < 0.0
            })
            .unwrap_or(2);
        let (sin, cos) = random.angle().sin_cos();
        let mut p = [0.0; 3];
        p[along] = random.within(-self.half[along], self.half[along]);
        let (a, b) = ((along + 1) % 3, (along + 2) % 3);
        p[a] = r * cos + self.half[a].copysign(cos);
        p[b] = r * sin + self.half[b].copysign(sin);
        into.push(p);
    }

    fn signed_distance(&self, p: Point) -> f64 {
        self.core_distance(p) - self.radius
    }

    fn axis_distance(&self, p: Point) -> Option<f64> {
        Some(self.core_distance(p))
    }
}

/// A box with sharp edges about the origin.
#[derive(Clone, Copy, Debug)]
pub struct Cuboid {
    pub name: &'static str,
    pub half: [f64; 3],
}

impl Shape for Cuboid {
    fn name(&self) -> &'static str {
        self.name
    }

    fn truth(&self) -> Truth {
        Truth {
            components: 1,
            genus: 0,
            volume: 8.0 * self.half.iter().product::<f64>(),
        }
    }

    fn draw(&self, random: &mut Random, into: &mut Vec<Point>) {
        let [x, y, z] = self.half;
        let mut left = random.unit() * (y * z + z * x + x * y);
        let across = [y * z, z * x, x * y]
            .into_iter()
            .position(|area| {
                left -= area;
                left < 0.0
            })
            .unwrap_or(2);
        let mut p = self.half.map(|half| random.within(-half, half));
        p[across] = self.half[across] * random.sign();
        into.push(p);
    }

    fn signed_distance(&self, p: Point) -> f64 {
        let over: Point = std::array::from_fn(|k| p[k].abs() - self.half[k]);
        let outside = norm(over.map(|x| x.max(0.0)));
        let inside = over.into_iter().fold(f64::NEG_INFINITY, f64::max).min(0.0);
        outside + inside
    }

    fn edge_point(&self, random: &mut Random) -> Option<Point> {
        let mut left = random.unit() * self.half.iter().sum::<f64>();
        let along = (0..3)
            .find(|&k| {
                left -= self.half[k];
                left < 0.0
            })
            .unwrap_or(2);
        Some(std::array::from_fn(|k| {
            if k == along {
                random.within(-self.half[k], self.half[k])
            } else {
                self.half[k] * random.sign()
            }
        }))
    }
}

/// A cylinder about the z axis with flat ends, higher than wide.
#[derive(Clone, Copy, Debug)]
pub struct Cylinder {
    pub radius: f64,
    pub half_height: f64,
}

impl Shape for Cylinder {
    fn name(&self) -> &'static str {
        "cylinder"
    }

    fn truth(&self) -> Truth {
        Truth {
            components: 1,
            genus: 0,
            volume: PI * self.radius.powi(2) * 2.0 * self.half_height,
        }
    }

    fn draw(&self, random: &mut Random, into: &mut Vec<Point>) {
        let (sin, cos) = random.angle().sin_cos();
        let (r, h) = (self.radius, self.half_height);
        let side = 2.0 * h / (2.0 * h + r);
        if random.unit() < side {
            into.push([r * cos, r * sin, random.within(-h, h)]);
        } else {
            let rho = r * random.unit().sqrt();
            into.push([rho * cos, rho * sin, h * random.sign()]);
        }
    }

    fn signed_distance(&self, p: Point) -> f64 {
        let across = p[0].hypot(p[1]) - self.radius;
        let along = p[2].abs() - self.half_height;
        across.max(0.0).hypot(along.max(0.0)) + across.max(along).min(0.0)
    }

    /// A segment of the axis and two cones of 45 degrees to the rims.
    fn axis_distance(&self, p: Point) -> Option<f64> {
        let (rho, z) = (p[0].hypot(p[1]), p[2].abs());
        let apex = self.half_height - self.radius;
        let to_segment = rho.hypot((z - apex).max(0.0));
        let along = ((rho + z - apex) / 2.0).clamp(0.0, self.radius);
        Some(to_segment.min((rho - along).hypot(z - apex - along)))
    }

    fn edge_point(&self, random: &mut Random) -> Option<Point> {
        let (sin, cos) = random.angle().sin_cos();
        let z = self.half_height * random.sign();
        Some([self.radius * cos, self.radius * sin, z])
    }
}

/// A box about the origin with a round hole along the z axis: the simplest
/// part that a machine shop makes.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    pub half: [f64; 3],
    /// Radius of the hole.
    pub hole: f64,
}

impl Block {
    fn solid(&self) -> Cuboid {
        Cuboid {
            name: "",
            half: self.half,
        }
    }
}

impl Shape for Block {
    fn name(&self) -> &'static str {
        "CAD block"
    }

    fn truth(&self) -> Truth {
        Truth {
            components: 1,
            genus: 1,
            volume: self.solid().truth().volume - PI * self.hole.powi(2) * 2.0 * self.half[2],
        }
    }

    fn draw(&self, random: &mut Random, into: &mut Vec<Point>) {
        let [x, y, z] = self.half;
        let wall = TAU * self.hole * 2.0 * z;
        let sides = 8.0 * (y * z + z * x + x * y);
        if random.unit() * (wall + sides) < wall {
            let (sin, cos) = random.angle().sin_cos();
            into.push([self.hole * cos, self.hole * sin, random.within(-z, z)]);
            return;
        }
        self.solid().draw(random, into);
        let p = into[into.len() - 1];
        if p[2].abs() == z && p[0].hypot(p[1]) < self.hole {
            into.pop();
        }
    }

    fn signed_distance(&self, p: Point) -> f64 {
        let rho = p[0].hypot(p[1]);
        let z = self.half[2];
        let wall = (rho - self.hole).hypot((p[2].abs() - z).max(0.0));
        let solid = self.solid().signed_distance(p);
        if rho >= self.hole {
            // Beside the hole the box's own nearest point is on the part,
            // unless the wall is nearer.
            return if solid < 0.0 { solid.max(-wall) } else { solid };
        }
        // In or above the hole: the wall or its rims.
        wall
    }

    fn edge_point(&self, random: &mut Random) -> Option<Point> {
        let rims = 2.0 * TAU * self.hole;
        let edges = 8.0 * self.half.iter().sum::<f64>();
        if random.unit() * (rims + edges) < rims {
            let (sin, cos) = random.angle().sin_cos();
            let z = self.half[2] * random.sign();
            return Some([self.hole * cos, self.hole * sin, z]);
        }
        self.solid().edge_point(random)
    }
}
