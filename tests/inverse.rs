//! From balls back to the surface.

mod common;

use std::f64::consts::PI;

use common::judge::topology;
use common::random::Random;
use common::shapes::{Shape, TORUS};
use common::threads;
use powercrust::axis::{simplify, LabelledBalls, SimplifyOptions};
use powercrust::inverse::{crust_of_balls, Inverse, InverseOptions};
use powercrust::mesh::{check, deviation, CheckOptions, Report};
use powercrust::{
    reconstruct, Ball, Context, Error, Options, Point, PolygonMesh, PowerShape, Reconstruction,
    Side,
};

fn context() -> Context<'static> {
    Context::default()
}

/// Sound before this project's judge and the tests' own.
#[track_caller]
fn sound(mesh: &PolygonMesh) -> Report {
    let report = check(mesh, &CheckOptions::default(), &context()).unwrap();
    assert!(report.is_watertight(), "{:?}", report.counts);
    assert!(topology(mesh).sound());
    report
}

fn of_inner(balls: &[Ball]) -> LabelledBalls {
    let shape = PowerShape {
        balls: balls.to_vec(),
        ..PowerShape::default()
    };
    LabelledBalls::of_shape(&shape, &context()).unwrap()
}

#[track_caller]
fn surface(balls: &LabelledBalls, union: bool) -> Inverse {
    let options = InverseOptions {
        union,
        ..InverseOptions::default()
    };
    let made = crust_of_balls(balls, &options, &context()).unwrap();
    assert_eq!(made.crossings_left, 0);
    made
}

fn torus() -> (Vec<Point>, Reconstruction) {
    let points = TORUS.spaced_samples(1500, 0.15, 5);
    let result = reconstruct(&points, &Options::default(), &context()).unwrap();
    (points, result)
}

#[test]
fn the_balls_of_a_crust_give_it_back() {
    let (points, result) = torus();
    let crust = result.crust.mesh.clone();
    let shape = result.axis(Side::Inner, &points);
    let near = |balls: &LabelledBalls, most: f64| {
        let made = surface(balls, false);
        let report = sound(&made.crust.mesh);
        assert_eq!((report.components, report.genus), (1, Some(1)));
        assert_eq!(made.outer_made, 0);
        let off = deviation(&crust, &made.crust.mesh, &context()).unwrap();
        assert!(off.max_of_diagonal < most, "{off:?}");
        let faces = made.crust.face_balls.iter();
        assert!(faces
            .clone()
            .all(|f| made.balls.sides[f[0] as usize] == Side::Inner));
    };
    near(&LabelledBalls::of(result.clone(), &points), 5e-3);
    // As a file would hold them.
    near(&LabelledBalls::of_shape(&shape, &context()).unwrap(), 5e-3);
    let balls = LabelledBalls::of(result, &points);
    let options = SimplifyOptions {
        eps: Some(0.6),
        delta: Some(0.1),
        ..SimplifyOptions::default()
    };
    let simple = simplify(&balls, &options, Side::Inner, &context()).unwrap();
    assert!(simple.report.after < simple.report.before);
    near(&simple.balls, 2e-2);
}

#[test]
fn inner_balls_alone_are_enough() {
    let (points, result) = torus();
    let crust = result.crust.mesh.clone();
    let shape = PowerShape {
        others: Vec::new(),
        other_contacts: Vec::new(),
        ..result.axis(Side::Inner, &points)
    };
    let balls = LabelledBalls::of_shape(&shape, &context()).unwrap();
    assert!(!balls.has_both_sides());
    for union in [false, true] {
        let made = surface(&balls, union);
        let report = sound(&made.crust.mesh);
        assert_eq!((report.components, report.genus), (1, Some(1)));
        assert!(made.outer_made > 0 && made.betti == made.union_betti);
        let off = deviation(&crust, &made.crust.mesh, &context()).unwrap();
        assert!(off.mean_of_diagonal < 2e-3, "{union}: {off:?}");
    }
}

#[test]
fn unions_of_balls_have_the_right_size() {
    let two = |apart: f64| [Ball::new([0.0; 3], 1.0), Ball::new([apart, 0.0, 0.0], 1.0)];
    let lens = |d: f64| PI * (2.0 - d).powi(2) * (d * d + 4.0 * d) / (12.0 * d);
    for (apart, volume, parts) in [
        (1.0, 8.0 / 3.0 * PI - lens(1.0), 1),
        // They hardly meet, and hardly do not.
        (1.99, 8.0 / 3.0 * PI - lens(1.99), 1),
        (2.001, 8.0 / 3.0 * PI, 2),
        (9.0, 8.0 / 3.0 * PI, 2),
    ] {
        let made = surface(&of_inner(&two(apart)), true);
        let report = sound(&made.crust.mesh);
        assert_eq!(report.components, parts, "{apart}");
        assert_eq!(made.unfitted, 0);
        // Within the tolerance everywhere: area times that is the most.
        let most = 8.0 * PI * made.tolerance;
        assert!(
            (report.volume - volume).abs() < most,
            "{apart}: {}",
            report.volume
        );
        let smooth = surface(&of_inner(&two(apart)), false);
        let report = sound(&smooth.crust.mesh);
        assert_eq!(report.components, parts, "{apart}");
        assert!((report.volume / volume - 1.0).abs() < 0.02);
    }
    // A ball alone, at any size.
    for size in [1.0, 1e-200, 1e200] {
        let made = surface(&of_inner(&[Ball::new([3.0 * size, 0.0, 0.0], size)]), true);
        let p = made.crust.mesh.vertices[7];
        let from = [p[0] / size - 3.0, p[1] / size, p[2] / size];
        assert!((from.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-2);
    }
}

#[test]
fn parts_tunnels_and_voids_of_the_union_are_there() {
    // A ring of balls, and a hollow shell of them.
    let ring: Vec<Ball> = (0..12)
        .map(|k| f64::from(k) * PI / 6.0)
        .map(|a| Ball::new([a.cos(), a.sin(), 0.0], 0.35))
        .collect();
    let made = surface(&of_inner(&ring), false);
    assert_eq!(sound(&made.crust.mesh).genus, Some(1));
    let shell: Vec<Ball> = (0..120)
        .map(|k| ((f64::from(k) + 0.5) / 60.0 - 1.0, f64::from(k) * 2.399963))
        .map(|(z, a)| {
            let rho = (1.0 - z * z).sqrt();
            Ball::new([rho * a.cos(), rho * a.sin(), z], 0.25)
        })
        .collect();
    for union in [false, true] {
        let made = surface(&of_inner(&shell), union);
        let report = sound(&made.crust.mesh);
        assert_eq!((report.components, report.cavities), (2, 1), "{union}");
    }
    // At random: as the dual complex of the union has them.
    let mut random = Random::new(8);
    for _ in 0..3 {
        let balls: Vec<Ball> = (0..20)
            .map(|_| {
                let centre = [(); 3].map(|()| random.unit());
                Ball::new(centre, 0.05 + 0.2 * random.unit())
            })
            .collect();
        let made = surface(&of_inner(&balls), false);
        let report = sound(&made.crust.mesh);
        let union = made.union_betti.unwrap();
        assert_eq!(made.betti, made.union_betti);
        assert_eq!(report.components, union.parts + union.voids);
        assert_eq!(report.cavities, union.voids);
        assert_eq!(report.genus, Some(union.tunnels));
    }
}

#[test]
fn the_same_whatever_the_threads() {
    let balls = of_inner(&[
        Ball::new([0.0; 3], 1.0),
        Ball::new([1.0, 0.2, 0.0], 0.8),
        Ball::new([0.4, 1.0, 0.3], 0.6),
    ]);
    for union in [false, true] {
        let options = InverseOptions {
            union,
            ..InverseOptions::default()
        };
        let by = |n| {
            let made = crust_of_balls(&balls, &options, &threads(n)).unwrap();
            made.crust.mesh
        };
        assert_eq!(by(1), by(4));
    }
}

#[test]
fn nothing_inside_is_refused() {
    let refuse = |shape: &PowerShape| {
        let balls = LabelledBalls::of_shape(shape, &context()).unwrap();
        crust_of_balls(&balls, &InverseOptions::default(), &context()).unwrap_err()
    };
    let mut shape = PowerShape {
        balls: vec![Ball::new([0.0; 3], 1.0), Ball::new([1.0, 0.0, 0.0], 1.0)],
        sides: vec![Side::Outer; 2],
        ..PowerShape::default()
    };
    assert_eq!(refuse(&shape), Error::NoInnerBalls);
    shape.sides = vec![Side::Inner; 2];
    shape.balls.iter_mut().for_each(|b| b.radius = 0.0);
    assert_eq!(refuse(&shape), Error::NoInnerBalls);
    assert_eq!(refuse(&PowerShape::default()), Error::NoInnerBalls);
    let options = InverseOptions {
        tolerance: Some(-1.0),
        ..InverseOptions::default()
    };
    let ball = of_inner(&[Ball::new([0.0; 3], 1.0)]);
    let error = crust_of_balls(&ball, &options, &context()).unwrap_err();
    assert!(matches!(
        error,
        Error::Option {
            name: "tolerance",
            ..
        }
    ));
}
