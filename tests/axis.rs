//! Simplified medial axes: what section 7.3 promises, and what files keep.

mod common;

use common::shapes::{Cuboid, Shape, TORUS, UNIT_SPHERE};
use powercrust::axis::{simplify, skeleton, structure, LabelledBalls, Simplified, SimplifyOptions};
use powercrust::geom::vec3::dist_sq;
use powercrust::io::{read_axis, write_axis, AxisFormat, WriteOptions};
use powercrust::{reconstruct, Ball, Context, Faces, Options, Point, PowerShape, Side};

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
        // Outer balls that touch few samples still bound what is convex.
        let inner = balls.sides[b] == Side::Inner;
        let unstable = inner && balls.contacts[b].diameter <= eps;
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

/// A filter alone, without regard to topology.
fn filter(set: impl Fn(&mut SimplifyOptions)) -> SimplifyOptions {
    let mut options = SimplifyOptions {
        keep_topology: false,
        ..SimplifyOptions::default()
    };
    set(&mut options);
    options
}

#[test]
fn filters_do_what_their_papers_say() {
    let points = PLATE.spaced_samples(1500, 0.05, 1);
    let balls = balls_of(&points);
    let of = |b: &LabelledBalls, id: u32| b.ids.iter().position(|&i| i == id);
    type Rule = Box<dyn Fn(&LabelledBalls, usize) -> bool>;
    let rules: [(SimplifyOptions, Rule); 3] = [
        (
            filter(|o| o.lambda = Some(0.1)),
            Box::new(|b, k| b.contacts[k].circumradius >= 0.1),
        ),
        (
            filter(|o| o.angle = Some(100.0)),
            Box::new(|b, k| b.contacts[k].angle(b.balls[k].radius) >= 100.0),
        ),
        (
            filter(|o| o.dey_zhao = Some([40.0, 3.0])),
            Box::new(|b, k| {
                let c = b.contacts[k];
                c.angle(b.balls[k].radius) > 80.0 || c.diameter > 3.0 * c.spacing
            }),
        ),
    ];
    for (options, stays) in rules {
        let kept = simplified(&balls, &options).balls;
        assert!(kept.balls.len() < balls.balls.len());
        for b in 0..balls.balls.len() {
            let there = of(&kept, balls.ids[b]).is_some();
            let outer = balls.sides[b] == Side::Outer;
            assert_eq!(there, outer || stays(&balls, b), "{options:?}: ball {b}");
        }
    }
}

#[test]
fn the_scale_axis_loses_what_larger_balls_cover() {
    // Balls along a line, and small ones that peep out of the large.
    let mut shape = ring(2, 1.0);
    shape.edges.clear();
    shape.balls = vec![
        Ball::new([0.0, 0.0, 0.0], 1.0),
        Ball::new([1.0, 0.0, 0.0], 1.0),
        Ball::new([0.0, 0.95, 0.0], 0.1),
        Ball::new([5.0, 0.0, 0.0], 0.1),
    ];
    let balls = LabelledBalls::of_shape(&shape, &Context::default()).unwrap();
    let ids = |scale: f64| {
        let kept = simplified(&balls, &filter(|o| o.scale = Some(scale)));
        let mut ids = kept.balls.ids;
        ids.sort_unstable();
        ids
    };
    assert_eq!(ids(1.0), [0, 1, 2, 3]);
    // 0.95 + 0.1 s <= s from s = 1.056 on.
    assert_eq!(ids(1.04), [0, 1, 2, 3]);
    assert_eq!(ids(1.07), [0, 1, 3]);
}

#[test]
fn so_many_balls_and_no_more() {
    let points = torus(2000);
    let balls = balls_of(&points);
    for most in [25, 60] {
        let options = SimplifyOptions {
            most: Some(most),
            ..SimplifyOptions::default()
        };
        let simple = simplified(&balls, &options);
        let after = simple.report.after;
        assert!(after <= most && after * 2 > most, "{after} of {most}");
        assert_eq!(simple.report.betti_after.unwrap().tunnels, 1);
        assert!(simple.report.moved > 0);
        let inner = |b: usize| simple.balls.sides[b] == Side::Inner;
        for b in (0..simple.balls.balls.len()).filter(|&b| inner(b)) {
            let ball = &simple.balls.balls[b];
            let off = (ball.centre[0].hypot(ball.centre[1]) - 1.0).hypot(ball.centre[2]);
            assert!(off < 0.05 && (ball.radius - 0.4).abs() < 0.05, "{ball:?}");
        }
    }
}

#[test]
fn as_few_balls_as_the_topology_allows() {
    let balls = balls_of(&torus(900));
    let options = SimplifyOptions {
        most: Some(1),
        ..SimplifyOptions::default()
    };
    let report = simplified(&balls, &options).report;
    assert_eq!(report.betti_after.unwrap().tunnels, 1);
    assert!(report.after > 2 && report.after < 7, "{report:?}");
    assert_eq!(report.refused, report.after - 1);
}

const PLATE: Cuboid = Cuboid {
    name: "plate",
    half: [1.0, 0.7, 0.2],
};

#[test]
fn parts_of_a_plate_close_up() {
    let points = PLATE.spaced_samples(1500, 0.05, 1);
    let simple = simplified(&balls_of(&points), &lengths(0.12, 0.02));
    let mut axis = simple.balls.shape(Side::Inner);
    axis.thin();
    let parts = structure(&axis);
    // The middle sheet is the largest; balls on it are as wide as the plate.
    assert!(parts.sheets[0].area > 1.0, "{:?}", parts.sheets[0]);
    let [_, mean, most] = parts.sheets[0].thickness;
    assert!(
        mean > 0.3 && mean < 0.42 && most < 0.6,
        "{:?}",
        parts.sheets[0]
    );
    let sum: usize = parts.sheets.iter().map(|s| s.triangles).sum();
    assert_eq!(sum, axis.triangles.len());
    // Every edge is in a seam, a rim, a curve, or within a sheet.
    let simplices = axis.simplices();
    for (e, edge) in simplices.edges.iter().enumerate() {
        let at = |t: &&[u32; 3]| edge.iter().all(|v| t.contains(v));
        let triangles = axis.triangles.iter().filter(at).count();
        let numbers = [parts.curve_of[e], parts.rim_of[e], parts.seam_of[e]];
        let given: Vec<bool> = numbers.iter().map(|&n| n != u32::MAX).collect();
        let expected = [triangles == 0, triangles == 1, triangles > 2];
        assert_eq!(given, expected);
    }
    let file = |parts| {
        let mut out = Vec::new();
        let options = WriteOptions::default();
        powercrust::io::write_axis_parts(&mut out, AxisFormat::Ply, &axis, parts, &options)
            .unwrap();
        out
    };
    let read = |bytes: &[u8]| read_axis(bytes, AxisFormat::Ply).unwrap();
    assert_eq!(read(&file(Some(&parts))), read(&file(None)));
}

#[test]
fn skeletons_are_curves_of_the_same_topology() {
    for (points, tunnels) in [(torus(900), 1), (PLATE.spaced_samples(1500, 0.05, 1), 0)] {
        let mut axis = balls_of(&points).shape(Side::Inner);
        axis.thin();
        let line = skeleton(&axis);
        assert_eq!(line.triangles_left, 0);
        let betti = line.shape.betti();
        assert_eq!((betti.parts, betti.tunnels), (1, tunnels));
        let (edges, balls) = (line.shape.edges.len(), line.shape.balls.len());
        assert!(edges <= axis.edges.len(), "{edges} of {}", axis.edges.len());
        // A graph in one piece.
        assert_eq!(edges + 1, balls + tunnels as usize);
    }
}

/// The balls are the same whether a surface is made or not.
#[test]
fn balls_need_no_surface() {
    let points = torus(900);
    let none = Options {
        faces: Faces::None,
        ..Options::default()
    };
    let with = reconstruct(&points, &Options::default(), &Context::default()).unwrap();
    let without = reconstruct(&points, &none, &Context::default()).unwrap();
    assert_eq!(without.crust.mesh.face_count(), 0);
    assert_eq!(with.stats.relabelled, 0);
    assert_eq!(with.balls, without.balls);
    let axis = |result| LabelledBalls::of(result, &points).shape(Side::Inner);
    assert_eq!(axis(with), axis(without));
    // A surface with nothing inside is none either way.
    let flat: Vec<Point> = (0..64)
        .map(|k| [f64::from(k % 8), f64::from(k / 8), 0.0])
        .collect();
    for options in [Options::default(), none] {
        let error = reconstruct(&flat, &options, &Context::default()).unwrap_err();
        let said = error.to_string();
        let plain = reconstruct(&flat, &Options::default(), &Context::default()).unwrap_err();
        assert_eq!(said, plain.to_string());
    }
}
