//! The clouds, the same in every run.

use crate::common::random::Random;
use crate::common::shapes::{self, Ellipsoid, Shape};
use crate::run::Run;
use powercrust::Point;
use std::sync::LazyLock;

/// Points of a cloud, about: enough that no cache holds a triangulation.
const POINTS: usize = 20_000;

#[derive(Clone, Copy, Debug)]
pub enum Cloud {
    /// Random in a cube: no surface, every cell in general position.
    Uniform,
    /// Random on an ellipsoid of axes 1, 2, 3.
    Ellipsoid,
    /// Random on a torus, whose axis is a curve (fact F6).
    Torus,
    /// Random on a block with a hole, whose edges leave samples off the surface.
    Block,
    /// A cubic grid of integers.
    Grid,
    /// All integer points of one sphere: every in-sphere test is zero.
    Cospherical,
    /// Random on a sphere, rounded to integers.
    Rounded,
}

impl Cloud {
    pub fn points(self) -> Vec<Point> {
        let mut random = Random::new(1);
        match self {
            Cloud::Uniform => (0..POINTS)
                .map(|_| std::array::from_fn(|_| random.unit()))
                .collect(),
            Cloud::Ellipsoid => Ellipsoid([1.0, 2.0, 3.0]).samples(POINTS, 1),
            Cloud::Torus => shapes::TORUS.samples(POINTS, 1),
            Cloud::Block => shapes::CAD_BLOCK.samples(POINTS, 1),
            Cloud::Grid => (0..27 * 27 * 27)
                .map(|n| [n % 27, n / 27 % 27, n / 729].map(f64::from))
                .collect(),
            Cloud::Cospherical => cospherical(4_849_845),
            Cloud::Rounded => (0..POINTS)
                .map(|_| random.direction().map(|x| (1000.0 * x).round()))
                .collect(),
        }
    }
}

/// The integer solutions of x² + y² + z² = n.
fn cospherical(n: i64) -> Vec<Point> {
    let half = n.isqrt();
    let mut points = Vec::new();
    for x in -half..=half {
        let rest = (n - x * x).isqrt();
        for y in -rest..=rest {
            let square = n - x * x - y * y;
            let z = square.isqrt();
            if z * z == square {
                points.push([x, y, z].map(|v| v as f64));
                if z > 0 {
                    points.push([x, y, -z].map(|v| v as f64));
                }
            }
        }
    }
    points
}

/// The stages of one cloud with merged balls, everything kept.
pub fn stages(cloud: Cloud) -> &'static Run {
    static ELLIPSOID: LazyLock<Run> = LazyLock::new(|| Run::of(&Cloud::Ellipsoid.points(), 0.5));
    static TORUS: LazyLock<Run> = LazyLock::new(|| Run::of(&Cloud::Torus.points(), 0.5));
    static BLOCK: LazyLock<Run> = LazyLock::new(|| Run::of(&Cloud::Block.points(), 0.5));
    match cloud {
        Cloud::Ellipsoid => &ELLIPSOID,
        Cloud::Torus => &TORUS,
        Cloud::Block => &BLOCK,
        _ => panic!("{cloud:?} has no surface"),
    }
}
