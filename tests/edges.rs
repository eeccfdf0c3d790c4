//! `SharpOption::Auto`: edges that have no samples are found again, with and
//! without noise; smooth surfaces stay as they are; whatever comes, the
//! surface is closed.
//!
//! `cargo test --test edges -- --nocapture` prints what was measured.

mod common;

use common::judge::{distance_to_triangle, topology, triangles};
use common::random::Random;
use common::shapes::{self, Shape};
use common::{crust, threads};
use powercrust::geom::vec3::dist_sq;
use powercrust::noise::CornerReport;
use powercrust::poles::Reason;
use powercrust::{reconstruct, Context, Options, Point, Reconstruction, SharpOption};

fn auto() -> Options {
    Options {
        sharp: SharpOption::Auto,
        ..Options::default()
    }
}

/// A Gaussian vector of this deviation, by Box and Muller.
fn gauss(random: &mut Random, deviation: f64) -> Point {
    [0; 3].map(|_| {
        let (u, angle) = (1.0 - random.unit(), random.angle());
        deviation * (-2.0 * u.ln()).sqrt() * angle.cos()
    })
}

fn noisy(points: &[Point], deviation: f64, seed: u64) -> Vec<Point> {
    let mut random = Random::new(seed);
    let mut moved = |p: &Point| {
        let by = gauss(&mut random, deviation);
        [0, 1, 2].map(|k| p[k] + by[k])
    };
    points.iter().map(&mut moved).collect()
}

/// The side of the cubes here, from -1 to 1, and the spacing of 3,000 samples.
const SPACING: f64 = 0.09;

/// Even samples of a cube, none nearer to an edge than a quarter of the spacing.
fn cube_without_edges() -> Vec<Point> {
    let mut points = shapes::CUBE.spaced_samples(3_000, 0.75 * SPACING, 5);
    points.retain(|p| {
        let mut from_sides = p.map(|v| 1.0 - v.abs());
        from_sides.sort_by(f64::total_cmp);
        from_sides[1] > 0.25 * SPACING
    });
    points
}

/// The mean distance of places on the edges of the cube from a surface.
fn edge_distance(result: &Reconstruction) -> f64 {
    const PLACES: usize = 500;
    let mut random = Random::new(9);
    let all: Vec<[Point; 3]> = triangles(&result.crust.mesh).collect();
    let distance = |p: Point| {
        let near = all.iter().filter(|t| dist_sq(t[0], p) < 1.0);
        near.map(|&t| distance_to_triangle(p, t))
            .fold(1.0, f64::min)
    };
    let places = (0..PLACES).filter_map(|_| shapes::CUBE.edge_point(&mut random));
    places.map(distance).sum::<f64>() / PLACES as f64
}

fn assert_closed(name: &str, result: &Reconstruction) {
    let found = topology(&result.crust.mesh);
    assert!(found.sound(), "{name}: {found:?}");
    assert_eq!(result.stats.crossings_left, 0, "{name}");
}

#[test]
fn edges_without_samples_are_found_again() {
    let clean = cube_without_edges();
    // 0.1 % of the diagonal.
    let deviation = 0.001 * 12f64.sqrt();
    for (name, points, share) in [
        ("clean", clean.clone(), 0.25),
        ("noisy", noisy(&clean, deviation, 3), 0.5),
    ] {
        let plain = crust(name, &points, &Options::default());
        let sharp = crust(name, &points, &auto());
        for result in [&plain, &sharp] {
            assert_closed(name, result);
            let found = topology(&result.crust.mesh);
            assert_eq!((found.components, found.genus()), (1, 0), "{name}");
        }
        assert_eq!(plain.stats.corners, CornerReport::default());
        let found = sharp.stats.corners;
        assert!(found.edges > 500 && found.corners > 0, "{found:?}");
        let [plain, sharp] = [&plain, &sharp].map(edge_distance);
        println!("{name}: edges off by {plain:.5} plain, {sharp:.5} auto");
        assert!(sharp < share * plain, "{name}: {plain}, {sharp}");
        assert!(sharp < 0.1 * SPACING, "{name}: {sharp}");
    }
}

/// Every pole that a sample at an edge had is told, once.
#[test]
fn poles_of_samples_at_edges_are_told() {
    let result = crust("cube", &cube_without_edges(), &auto());
    let found = result.stats.corners;
    let mut samples: Vec<u32> = result.dropped.iter().map(|d| d.sample).collect();
    let mut each: Vec<(u32, u8)> = (result.dropped.iter())
        .map(|d| (d.sample, d.pole))
        .collect();
    assert!(each.is_sorted());
    each.dedup();
    assert_eq!(each.len(), result.dropped.len());
    samples.dedup();
    assert_eq!(samples.len(), found.edges + found.corners);
    let told = |d: &powercrust::poles::DroppedPole| {
        let at = result.sample_source[d.sample as usize] as usize;
        let distance = dist_sq(d.centre, cube_without_edges()[at]).sqrt();
        d.reason == Reason::Corner && d.bound == 0.0 && (distance / d.radius - 1.0).abs() < 1e-6
    };
    assert!(result.dropped.iter().step_by(97).all(told));
    assert_eq!(result.stats.poles_dropped, 0);
}

#[test]
fn smooth_surfaces_stay_as_they_are() {
    let smooth: [&dyn Shape; 2] = [&shapes::UNIT_SPHERE, &shapes::TORUS];
    for shape in smooth {
        let points = shape.samples(3_000, 11);
        let plain = crust(shape.name(), &points, &Options::default());
        let sharp = crust(shape.name(), &points, &auto());
        assert_eq!(sharp.stats.corners, CornerReport::default());
        assert_eq!(plain.crust.mesh, sharp.crust.mesh, "{}", shape.name());
        assert_eq!(plain.balls, sharp.balls, "{}", shape.name());
        assert!(sharp.dropped.is_empty());
    }
}

#[test]
fn whatever_comes_the_surface_is_closed() {
    let cube = cube_without_edges();
    let mut random = Random::new(17);
    let mut strewn = cube.clone();
    strewn.extend((0..150).map(|_| [0; 3].map(|_| 4.0 * random.unit() - 2.0)));
    let scaled = |by: Point| -> Vec<Point> {
        let scale = |p: &Point| [0, 1, 2].map(|k| p[k] * by[k]);
        cube.iter().map(scale).collect()
    };
    // Thinner than the samples lie apart; a needle; both as flat as a blade.
    let plate = scaled([1.0, 1.0, 0.02]);
    let needle = scaled([1.0, 0.05, 0.03]);
    let wedge = |p: &Point| [p[0], p[1], p[2] * 0.2 * (1.0 + p[0])];
    let cases = [
        ("noise of 1 %", noisy(&cube, 0.035, 1)),
        ("noise of 4 %", noisy(&cube, 0.14, 2)),
        ("outliers", strewn),
        ("noisy plate", noisy(&plate, 0.005, 3)),
        ("plate", plate),
        ("needle", needle),
        ("blade", cube.iter().map(wedge).collect()),
        ("block", shapes::CAD_BLOCK.samples(3_000, 4)),
        // Few samples: balls larger than the cloud.
        ("30 samples", shapes::CUBE.samples(30, 5)),
        ("60 samples", shapes::CUBE.samples(60, 6)),
    ];
    for (name, points) in cases {
        let result = crust(name, &points, &auto());
        println!("{name}: {:?}", result.stats.corners);
        assert_closed(name, &result);
    }
}

#[test]
fn neither_threads_nor_the_order_of_the_input_matter() {
    for points in [cube_without_edges(), noisy(&cube_without_edges(), 0.003, 8)] {
        let one = reconstruct(&points, &auto(), &threads(1)).unwrap();
        assert!(one.stats.corners.edges > 500);
        let mut other = points.clone();
        other.reverse();
        other.rotate_left(points.len() / 3);
        let other = reconstruct(&other, &auto(), &threads(3)).unwrap();
        assert_eq!(one.crust.mesh, other.crust.mesh);
        assert_eq!(one.balls, other.balls);
    }
    let far: Vec<Point> = cube_without_edges()
        .iter()
        .map(|p| p.map(|v| v * 1e200))
        .collect();
    let context = Context::default();
    let result = reconstruct(&far, &auto(), &context).unwrap();
    assert_closed("huge", &result);
}
