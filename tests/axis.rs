//! Simplified medial axes: what section 7.3 promises, and what files keep.

mod common;

use common::shapes::{Shape, TORUS, UNIT_SPHERE};
use powercrust::axis::{simplify, LabelledBalls, Simplified, SimplifyOptions};
use powercrust::geom::vec3::dist_sq;
use powercrust::io::{read_axis, write_axis, AxisFormat, WriteOptions};
use powercrust::{reconstruct, Ball, Context, Options, Point, PowerShape, Side};

/// About evenly spread over the torus of radii 1 and 0.4.
fn torus(count: usize) -> Vec<Point> {
    TORUS.spaced_samples(count, 2.6 / (count as f64).sqrt(), 1)
}

fn balls_of(points: &[Point]) -> LabelledBalls {
    let result = reconstruct(points, &Options::default(), &Context::default()).unwrap();
    LabelledBalls::of(result, points)
}

fn lengths(eps: f64, delta: f64) -> SimplifyOptions {
    SimplifyOptions {
        eps: Some(eps),
        delta: Some(delta),
        ..SimplifyOptions::default()
    }
}

fn simplified(balls: &LabelledBalls, options: &SimplifyOptions) -> Simplified {
    simplify(balls, options, Side::Inner, &Context::default()).unwrap()
}

#[test]
fn nothing_said_changes_nothing() {
    let points = torus(900);
    let result = reconstruct(&points, &Options::default(), &Context::default()).unwrap();
    for side in [Side::Inner, Side::Outer] {
        let axis = result.axis(side, &points);
        let balls = LabelledBalls::of(result.clone(), &points);
        let kept = simplified(&balls, &SimplifyOptions::default());
        assert_eq!(kept.balls.shape(side), axis);
    }
}

#[test]
fn unstable_and_redundant_balls_go_and_no_others() {
    let points = torus(2000);
    let balls = balls_of(&points);
    let (eps, delta) = (0.1, 0.02);
    let options = SimplifyOptions {
        keep_topology: false,
        ..lengths(eps, delta)
    };
    let simple = simplified(&balls, &options);
    let kept: Vec<u32> = simple.balls.ids.clone();
    let contained = |p: usize, c: usize| {
        let (p, c) = (&balls.balls[p], &balls.balls[c]);
        dist_sq(p.centre, c.centre).sqrt() + p.radius <= c.radius + delta * (1.0 + 1e-9)
    };
    let mut redundant = 0;
    for b in 0..balls.balls.len() {
        let unstable = balls.contacts[b].diameter <= eps;
        if kept.contains(&(b as u32)) {
            assert!(!unstable, "ball {b}");
        } else if !unstable {
            redundant += 1;
            let by =
                |&c: &u32| balls.sides[c as usize] == balls.sides[b] && contained(b, c as usize);
            assert!(kept.iter().any(by), "ball {b} is in none that stays");
        }
    }
    assert!(redundant > 100, "{redundant}");
    let report = &simple.report;
    assert_eq!(
        report.before - report.unstable - report.redundant,
        report.after
    );
    assert_eq!(simple.balls.shape(Side::Inner).balls.len(), report.after);
}

#[test]
fn diameters_are_those_of_the_touching_samples() {
    let points = torus(600);
    let balls = balls_of(&points);
    for b in 0..balls.balls.len() as u32 {
        let touched = balls.touching.at(b);
        let mut most = 0.0f64;
        for &s in touched {
            for &t in touched {
                most = most.max(dist_sq(points[s as usize], points[t as usize]).sqrt());
            }
        }
        let contact = &balls.contacts[b as usize];
        assert!((contact.diameter - most).abs() <= 1e-3 * most);
        // Jung's bounds in space.
        assert!(contact.circumradius >= contact.diameter / 2.0);
        assert!(contact.circumradius <= contact.diameter * 0.375f64.sqrt() * (1.0 + 1e-9));
    }
}

#[test]
fn topology_is_kept_or_not_as_asked() {
    let points = torus(900);
    let balls = balls_of(&points);
    // Balls grown by this hold the whole torus.
    let far = lengths(0.0, 100.0);
    let kept = simplified(&balls, &far);
    let betti = kept.report.betti_before.unwrap();
    assert_eq!((betti.parts, betti.tunnels, betti.voids), (1, 1, 0));
    assert_eq!(kept.report.betti_after, Some(betti));
    assert!(kept.report.refused > 0);
    assert_eq!(kept.balls.shape(Side::Inner).betti(), betti);
    let free = SimplifyOptions {
        keep_topology: false,
        ..far
    };
    let free = simplified(&balls, &free);
    assert_eq!(free.report.after, 1);
    assert_eq!(free.balls.shape(Side::Inner).betti().tunnels, 0);
}

#[test]
fn a_file_says_as_much_as_the_points() {
    let points = torus(900);
    let result = reconstruct(&points, &Options::default(), &Context::default()).unwrap();
    let axis = result.axis(Side::Inner, &points);
    let options = lengths(0.08, 0.02);
    let direct = simplified(&LabelledBalls::of(result, &points), &options);
    for format in [AxisFormat::Ma, AxisFormat::Ply, AxisFormat::Json] {
        let mut file = Vec::new();
        write_axis(&mut file, format, &axis, &WriteOptions::default()).unwrap();
        let shape = read_axis(&file, format).unwrap();
        let balls = LabelledBalls::of_shape(&shape, &Context::default()).unwrap();
        assert!(!balls.estimated && balls.has_both_sides());
        let again = simplified(&balls, &options);
        let (a, b) = (again.report.after as f64, direct.report.after as f64);
        // The lattice differs, so flat tetrahedra and with them neighbours do.
        assert!((a - b).abs() <= 0.05 * b, "{format:?}: {a} and {b} balls");
        assert_eq!(again.report.betti_after, direct.report.betti_after);
    }
}

/// A closed ring of balls: as other programs write them.
fn ring(count: u32, radius: f64) -> PowerShape {
    let at = |k: u32| {
        let angle = f64::from(k) / f64::from(count) * std::f64::consts::TAU;
        Ball::new([3.0 * angle.cos(), 3.0 * angle.sin(), 0.1], radius)
    };
    PowerShape {
        balls: (0..count).map(at).collect(),
        edges: (0..count).map(|k| [k, (k + 1) % count]).collect(),
        ..PowerShape::default()
    }
}

#[test]
fn balls_of_one_side_are_joined_by_their_union() {
    // Balls that overlap in a ring, that do not reach each other, and that
    // fill the middle.
    for (radius, parts, tunnels) in [(1.0, 1, 1), (0.2, 40, 0), (3.2, 1, 0)] {
        let balls = LabelledBalls::of_shape(&ring(40, radius), &Context::default()).unwrap();
        assert!(balls.estimated && !balls.has_both_sides());
        let betti = balls.shape(Side::Inner).betti();
        assert_eq!(
            (betti.parts, betti.tunnels, betti.voids),
            (parts, tunnels, 0)
        );
    }
    let simple = simplified(
        &LabelledBalls::of_shape(&ring(400, 1.0), &Context::default()).unwrap(),
        &lengths(0.1, 0.1),
    );
    assert!(simple.report.after < 200, "{:?}", simple.report);
    assert_eq!(simple.report.betti_after.unwrap().tunnels, 1);
}

#[test]
fn thin_axes_have_no_tetrahedra_and_the_same_betti_numbers() {
    let two = {
        let mut points = torus(900);
        let sphere = UNIT_SPHERE.spaced_samples(400, 0.1, 1);
        points.extend(sphere.iter().map(|p| [p[0] + 9.0, p[1], p[2]]));
        points
    };
    for (points, expected) in [(torus(900), (1, 1, 0)), (two, (2, 1, 0))] {
        let result = reconstruct(&points, &Options::default(), &Context::default()).unwrap();
        let mut axis = result.axis(Side::Inner, &points);
        let solid = axis.tetrahedra.len();
        let before = axis.betti();
        assert_eq!((before.parts, before.tunnels, before.voids), expected);
        assert_eq!(axis.thin(), solid);
        assert!(solid > 0 && axis.tetrahedra.is_empty());
        assert_eq!(axis.betti(), before);
    }
}

#[test]
fn threads_change_nothing() {
    let points = torus(900);
    let balls = balls_of(&points);
    let options = lengths(0.08, 0.02);
    let one = Context {
        threads: std::num::NonZeroUsize::new(1),
        ..Context::default()
    };
    let alone = simplify(&balls, &options, Side::Inner, &one).unwrap();
    let many = simplified(&balls, &options);
    assert_eq!(alone.report, many.report);
    assert_eq!(
        alone.balls.shape(Side::Inner),
        many.balls.shape(Side::Inner)
    );
}

#[test]
fn lengths_below_zero_are_refused() {
    let balls = LabelledBalls::of_shape(&ring(5, 1.0), &Context::default()).unwrap();
    let error = simplify(
        &balls,
        &lengths(-1.0, 0.0),
        Side::Inner,
        &Context::default(),
    );
    let error = error.unwrap_err().to_string();
    assert!(error.contains("eps is -1: expected a length"), "{error}");
}
