//! Offset surfaces against closed forms.

mod common;

use std::f64::consts::PI;

use common::judge::topology;
use common::random::Random;
use common::shapes::{Cuboid, Shape, TORUS, UNIT_SPHERE};
use common::threads;
use powercrust::mesh::{check, CheckOptions, Report, Surface};
use powercrust::offset::{Offset, OffsetOptions, Offsets};
use powercrust::{reconstruct, Context, Error, Options, Point, PolygonMesh, Reconstruction};

fn crust(points: &[Point]) -> Reconstruction {
    let options = Options {
        box_factor: 8.0,
        ..Options::default()
    };
    reconstruct(points, &options, &Context::default()).unwrap()
}

fn offset(of: &Reconstruction, distance: f64) -> Offset {
    let offsets = Offsets::new(of, OffsetOptions::default()).unwrap();
    offsets.at(distance, &Context::default()).unwrap()
}

/// Sound before this project's judge and the tests' own.
#[track_caller]
fn sound(mesh: &PolygonMesh) -> Report {
    let report = check(mesh, &CheckOptions::default(), &Context::default()).unwrap();
    assert!(report.is_watertight(), "{:?}", report.counts);
    assert!(topology(mesh).sound());
    report
}

/// A box with samples along its edges and, at random, on its faces.
fn box_samples(half: Point, spacing: f64, count: usize) -> Vec<Point> {
    let shape = Cuboid { name: "box", half };
    let mut points = shape.spaced_samples(count, 0.8 * spacing, 7);
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let steps = (2.0 * half[axis] / spacing).round() as i32;
        for k in 0..=steps {
            for corner in 0..4 {
                let mut p = [0.0; 3];
                p[axis] = half[axis] * (2.0 * f64::from(k) / f64::from(steps) - 1.0);
                p[u] = if corner & 1 == 0 { half[u] } else { -half[u] };
                p[v] = if corner & 2 == 0 { half[v] } else { -half[v] };
                points.push(p);
            }
        }
    }
    points
}

#[test]
fn spheres_at_a_distance_are_spheres() {
    let ball = crust(&UNIT_SPHERE.spaced_samples(1200, 0.08, 3));
    for distance in [-0.6, 0.3, 1.0] {
        let made = offset(&ball, distance);
        let report = sound(&made.crust.mesh);
        assert_eq!((report.components, report.genus), (1, Some(0)));
        assert!(made.fitted && made.crossings_left == 0);
        let radius = 1.0 + distance;
        let error = made.crust.mesh.volume() / (4.0 / 3.0 * PI * radius.powi(3)) - 1.0;
        assert!(error.abs() < 0.03 / radius, "{distance}: {error}");
        // Where samples leave gaps of 0.4 the crust is off by 0.02, and an offset
        // inside ends at its planes.
        for p in &made.crust.mesh.vertices {
            let off = UNIT_SPHERE.signed_distance(*p) - distance;
            assert!(off.abs() < 0.03, "{distance}: {off}");
        }
    }
    // At no distance it is the crust.
    assert_eq!(offset(&ball, 0.0).crust.mesh, ball.crust.mesh);
}

#[test]
fn flat_parts_stay_flat() {
    let half = [1.0, 0.75, 0.5];
    let solid = crust(&box_samples(half, 0.1, 800));
    // How far vertices lie off the faces, away from the creases.
    let off = |fit: bool, distance: f64| {
        let options = OffsetOptions {
            fit,
            ..OffsetOptions::default()
        };
        let offsets = Offsets::new(&solid, options).unwrap();
        let made = offsets.at(distance, &Context::default()).unwrap();
        sound(&made.crust.mesh);
        let mut most = 0.0f64;
        for p in &made.crust.mesh.vertices {
            for k in 0..3 {
                let inside = (0..3).all(|j| j == k || p[j].abs() < half[j] - 0.4);
                if inside {
                    most = most.max((p[k].abs() - half[k] - distance).abs());
                }
            }
        }
        (most, made.crust.mesh.volume())
    };
    for distance in [-0.2, 0.2] {
        let (fitted, volume) = off(true, distance);
        let (plain, _) = off(false, distance);
        // Not to the last bit: at some vertices too few samples tell of the plane.
        assert!(fitted < 3e-5, "{distance}: {fitted}");
        assert!(plain > 20.0 * fitted, "{distance}: {plain} {fitted}");
        if distance < 0.0 {
            let truth: f64 = half.iter().map(|h| 2.0 * (h + distance)).product();
            assert!((volume / truth - 1.0).abs() < 2e-3, "{volume} {truth}");
        }
    }
}

#[test]
fn curved_parts_are_as_good_as_the_crust() {
    let ring = crust(&TORUS.samples(3000, 1));
    let mesh = &ring.crust.mesh;
    let middles = mesh.faces().map(|f| {
        let corner = |k: usize| mesh.vertices[f[k] as usize];
        [0, 1, 2].map(|j| (corner(0)[j] + corner(1)[j] + corner(2)[j]) / 3.0)
    });
    let own = (middles.chain(mesh.vertices.iter().copied()))
        .map(|p| TORUS.signed_distance(p).abs())
        .fold(0.0, f64::max);
    for distance in [-0.1, 0.1] {
        let made = offset(&ring, distance);
        sound(&made.crust.mesh);
        for p in &made.crust.mesh.vertices {
            let off = TORUS.signed_distance(*p) - distance;
            assert!(off.abs() < 1.5 * own, "{distance}: {off} {own}");
        }
    }
}

#[test]
fn holes_close_and_parts_join() {
    let ring = crust(&TORUS.spaced_samples(800, 0.11, 5));
    assert_eq!(sound(&ring.crust.mesh).genus, Some(1));
    assert_eq!(sound(&offset(&ring, -0.2).crust.mesh).genus, Some(1));
    assert_eq!(sound(&offset(&ring, 0.2).crust.mesh).genus, Some(1));
    let full = offset(&ring, 0.8);
    assert_eq!(sound(&full.crust.mesh).genus, Some(0));
    assert!(full.vanished[1] > 0);

    let mut two = UNIT_SPHERE.spaced_samples(400, 0.13, 1);
    let other: Vec<Point> = two.iter().map(|p| [p[0] + 2.5, p[1], p[2]]).collect();
    two.extend(other);
    let apart = crust(&two);
    for (distance, parts) in [(-0.3, 2), (0.1, 2), (0.4, 1)] {
        let made = offset(&apart, distance);
        assert_eq!(sound(&made.crust.mesh).components, parts, "{distance}");
    }
}

#[test]
fn a_shell_is_one_closed_solid() {
    let ball = crust(&UNIT_SPHERE.spaced_samples(500, 0.12, 2));
    let offsets = Offsets::new(&ball, OffsetOptions::default()).unwrap();
    let cx = Context::default();
    for (distance, thickness) in [(0.0, 0.2), (0.3, 0.3), (-0.1, 0.05)] {
        let made = offsets.shell(distance, thickness, &cx).unwrap();
        let report = sound(&made.crust.mesh);
        assert_eq!((report.components, report.cavities), (2, 1));
        let cube = |r: f64| 4.0 / 3.0 * PI * r.powi(3);
        let truth = cube(1.0 + distance) - cube(1.0 + distance - thickness);
        let error = made.crust.mesh.volume() / truth - 1.0;
        assert!(error.abs() < 0.03, "{distance} {thickness}: {error}");
    }
    assert!(matches!(
        offsets.shell(0.0, 1.2, &cx),
        Err(Error::Vanished { .. })
    ));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let ball = crust(&UNIT_SPHERE.spaced_samples(200, 0.2, 2));
    let cx = Context::default();
    let offsets = Offsets::new(&ball, OffsetOptions::default()).unwrap();
    assert!(offsets.depth() > 0.9 && offsets.depth() < 1.1);
    let error = offsets.at(-1.1, &cx).unwrap_err();
    assert!(error.to_string().contains("nothing is left"), "{error}");
    for distance in [f64::NAN, f64::NEG_INFINITY, 1.01 * offsets.reach()] {
        let error = offsets.at(distance, &cx).unwrap_err();
        assert!(matches!(error, Error::Option { .. }), "{error}");
    }
    sound(&offsets.at(0.99 * offsets.reach(), &cx).unwrap().crust.mesh);
    for thickness in [0.0, -1.0, f64::NAN] {
        assert!(offsets.shell(0.0, thickness, &cx).is_err());
    }
    let none = OffsetOptions {
        tolerance: Some(0.0),
        ..OffsetOptions::default()
    };
    assert!(Offsets::new(&ball, none).is_err());
}

#[test]
fn threads_and_scale_change_nothing() {
    let points = TORUS.spaced_samples(400, 0.15, 9);
    let mesh = |points: &[Point], distance: f64, cx: &Context| {
        let ring = reconstruct(points, &Options::default(), cx).unwrap();
        let offsets = Offsets::new(&ring, OffsetOptions::default()).unwrap();
        offsets.at(distance, cx).unwrap().crust.mesh
    };
    let one = mesh(&points, 0.15, &threads(1));
    assert_eq!(one, mesh(&points, 0.15, &threads(3)));
    let large: Vec<Point> = points.iter().map(|p| p.map(|x| x * 1024.0)).collect();
    let mut scaled = mesh(&large, 0.15 * 1024.0, &threads(1));
    for p in &mut scaled.vertices {
        *p = p.map(|x| x / 1024.0);
    }
    assert_eq!(one, scaled);
}

#[test]
fn nearest_points_are_as_far_as_distances_say() {
    let ring = crust(&TORUS.samples(300, 4));
    let surface = Surface::new(&ring.crust.mesh);
    let (mut random, mut scratch) = (Random::new(3), Vec::new());
    for _ in 0..500 {
        let p = [0; 3].map(|_| 4.0 * random.unit() - 2.0);
        let q = surface.nearest(p, &mut scratch).unwrap();
        let far = (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt();
        assert!((far - surface.distance(p)).abs() < 1e-12);
        assert!(surface.distance(q) < 1e-12);
    }
    assert_eq!(surface.nearest([f64::NAN; 3], &mut scratch), None);
}
