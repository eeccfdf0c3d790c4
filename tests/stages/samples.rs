//! From points to samples.

use crate::common::random::Random;
use crate::common::shapes::{self, Shape};
use powercrust::delaunay::{self, samples, Samples};
use powercrust::tetra::order;
use powercrust::{Context, Point, SampleError};
use std::collections::HashMap;

fn made(points: &[Point]) -> Samples {
    samples(points, 5.0).unwrap()
}

fn cloud() -> Vec<Point> {
    let mut random = Random::new(11);
    let mut points = shapes::TORUS.samples(600, 11);
    for k in 0..100 {
        points.push(points[random.below(500 + k)]);
    }
    // Too close to tell apart on the lattice, far enough for floats.
    for k in 0..50 {
        let mut near = points[k];
        near[k % 3] += 4e-15;
        points.push(near);
    }
    random.shuffle(&mut points);
    points
}

#[test]
fn points_and_samples_name_each_other() {
    let points = cloud();
    let s = made(&points);
    assert_eq!(s.len(), 600);
    let mut group: HashMap<[u64; 3], Vec<u32>> = HashMap::new();
    for (i, p) in (0u32..).zip(&points) {
        let q = s.lattice.to_lattice(*p).map(|v| v.round_ties_even() + 0.0);
        group.entry(q.map(f64::to_bits)).or_default().push(i);
    }
    assert_eq!(group.len(), s.len());
    for id in 0..s.len() {
        let site = s.sites[id];
        let members = &group[&[0, 1, 2].map(|k| site[k].to_bits())];
        assert_eq!(members.len(), s.multiplicity[id] as usize);
        assert!(members.iter().all(|&i| s.of_input[i as usize] == id as u32));
        let least = members.iter().min_by(|&&a, &&b| {
            let (p, q) = (points[a as usize], points[b as usize]);
            p.partial_cmp(&q).unwrap().then(a.cmp(&b))
        });
        assert_eq!(least, Some(&s.source[id]));
        assert_eq!(s.points[id], points[s.source[id] as usize]);
        assert!(site[..3].iter().all(|v| v.abs() <= s.lattice.sample_half));
        assert_eq!(site[3], 0.0);
    }
    assert_eq!(s.multiplicity.iter().sum::<u32>() as usize, points.len());
    let distinct: std::collections::BTreeSet<_> =
        s.sites.iter().map(|s| s.map(|v| v as i64)).collect();
    assert_eq!(distinct.len(), s.len());
}

#[test]
fn ids_and_coordinates_do_not_depend_on_the_order_of_the_input() {
    let mut points = cloud();
    let first = made(&points);
    let mut random = Random::new(12);
    for _ in 0..5 {
        random.shuffle(&mut points);
        let again = made(&points);
        assert_eq!(again.sites, first.sites);
        assert_eq!(again.points, first.points);
        assert_eq!(again.multiplicity, first.multiplicity);
        assert_eq!(again.lattice, first.lattice);
    }
}

#[test]
fn powers_of_two_leave_the_lattice_alone() {
    let points = cloud();
    let first = made(&points);
    for exponent in [-900, -200, -1, 1, 63, 900] {
        let factor = 2f64.powi(exponent);
        let scaled: Vec<Point> = points.iter().map(|p| p.map(|v| v * factor)).collect();
        let s = made(&scaled);
        assert_eq!(s.sites, first.sites, "2^{exponent}");
        assert_eq!(s.of_input, first.of_input, "2^{exponent}");
        assert_eq!(s.lattice.exponent, first.lattice.exponent - exponent);
        let (ours, theirs) = (s.lattice.frame_half, first.lattice.frame_half);
        assert_eq!(ours, theirs);
        for (p, q) in s.points.iter().zip(&first.points) {
            assert_eq!(*p, q.map(|v| v * factor));
        }
    }
}

#[test]
fn the_lattice_and_back_is_within_half_a_step() {
    let points = cloud();
    let s = made(&points);
    for (p, site) in s.points.iter().zip(&s.sites) {
        let back = s.lattice.to_user([site[0], site[1], site[2]]);
        let tolerance = s.lattice.length_to_user(0.5) * 1.001 + 4e-16;
        assert!((0..3).all(|k| (back[k] - p[k]).abs() <= tolerance));
    }
}

/// Ids follow the curve: what is near in space is near in memory.
#[test]
fn samples_follow_the_curve() {
    let s = made(&shapes::UNIT_SPHERE.samples(3_000, 13));
    let keys: Vec<u64> = s
        .sites
        .iter()
        .map(|p| order::key(p, s.lattice.sample_half))
        .collect();
    assert!(keys.windows(2).all(|two| two[0] <= two[1]));
}

#[track_caller]
fn refused(points: &[Point]) -> SampleError {
    match samples(points, 5.0) {
        Ok(made) => panic!("{} samples", made.len()),
        Err(error) => error,
    }
}

#[test]
fn numbers_that_are_none_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let mut points = shapes::UNIT_SPHERE.samples(20, 14);
            points[7][axis] = bad;
            match refused(&points) {
                SampleError::NotFinite { index: 7, point } => {
                    assert_eq!(point.map(f64::to_bits), points[7].map(f64::to_bits));
                }
                other => panic!("{other}"),
            }
        }
    }
    let text = refused(&[[f64::NAN, 1.0, 2.5]]).to_string();
    let wanted = "point 0 (counting from 0) has the coordinates (NaN, 1, 2.5): all must be finite";
    assert_eq!(text, wanted);
}

#[test]
fn too_few_points_are_refused() {
    assert_eq!(
        refused(&[]).to_string(),
        "0 points, 0 of them distinct: a solid needs at least 4"
    );
    let three = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let doubled = [three, three].concat();
    let (given, distinct) = (6, 3);
    assert_eq!(refused(&doubled), SampleError::TooFew { given, distinct });
    let one = refused(&[[3.0; 3]; 1_000]);
    let (given, distinct) = (1_000, 1);
    assert_eq!(one, SampleError::TooFew { given, distinct });
}

#[test]
fn lines_are_refused() {
    for direction in [[1.0, 0.0, 0.0], [0.0, 0.0, -3.0], [1.0, 2.0, -4.0]] {
        for origin in [[0.0; 3], [1e6, -2e5, 7.0]] {
            let at = |k: i32| [0, 1, 2].map(|a| origin[a] + direction[a] * f64::from(k));
            let line: Vec<Point> = (0..50).map(at).collect();
            let error = refused(&line);
            assert_eq!(error, SampleError::Collinear { given: 50 }, "{direction:?}");
        }
    }
}

#[test]
fn planes_are_refused() {
    let mut random = Random::new(15);
    let flat: Vec<Point> = (0..1_204)
        .map(|_| [random.unit(), random.unit(), 0.0])
        .collect();
    let planes: [(&str, [Point; 2]); 4] = [
        ("xy", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
        ("yz", [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        ("tilted", [[1.0, 0.5, 0.1], [-0.3, 1.0, 0.7]]),
        ("steep", [[1.0, 0.0, 300.0], [0.0, 1.0, 0.1]]),
    ];
    for (name, [u, v]) in planes {
        for origin in [
            [0.0; 3],
            [0.25, 17.0, -3.0],
            [499_980.0, 5_123_456.0, 312.0],
        ] {
            let points: Vec<Point> = flat
                .iter()
                .map(|p| [0, 1, 2].map(|k| origin[k] + (p[0] * u[k] + p[1] * v[k])))
                .collect();
            let error = refused(&points);
            assert_eq!(
                error.to_string(),
                "all 1204 points lie in one plane: there is no solid",
                "{name} at {origin:?}"
            );
        }
    }
}

/// A plate a millionth as thick as wide is no plane.
#[test]
fn thin_is_not_flat() {
    let mut random = Random::new(16);
    let points: Vec<Point> = (0..200)
        .map(|k| [random.unit(), random.unit(), f64::from(k % 2) * 1e-6])
        .collect();
    assert_eq!(made(&points).len(), 200);
}

#[test]
fn the_widest_and_the_smallest_numbers() {
    let cube: Vec<Point> = (0..8)
        .map(|k| [k & 1, k >> 1 & 1, k >> 2].map(f64::from))
        .collect();
    let times = |f: f64| -> Vec<Point> { cube.iter().map(|p| p.map(|v| v * f)).collect() };
    let reference = made(&times(1.0));
    // The smallest number is a power of two: a cube of that side is a cube.
    let smallest = made(&times(f64::from_bits(1)));
    assert_eq!(smallest.len(), 8);
    assert_eq!(made(&times(2f64.powi(1000))).sites, reference.sites);
    match refused(&times(f64::MAX)) {
        SampleError::TooWide { extent, limit } => {
            assert_eq!((extent, limit), (f64::MAX, 2e307));
        }
        other => panic!("{other}"),
    }
    let both: Vec<Point> = [times(f64::MAX), times(-f64::MAX)].concat();
    assert!(matches!(refused(&both), SampleError::TooWide { .. }));
}

/// A cloud as small as the step between floats where it lies: the middle of
/// its box is no float, and the lattice must not be centred so badly that
/// samples reach the frame.
#[test]
fn a_cloud_one_float_wide_stays_inside_its_frame() {
    let ulp = 0.125;
    let corner = [1e15, -1e15, 1e15 + 3.0 * ulp];
    let points: Vec<Point> = (0..8)
        .map(|k| [0, 1, 2].map(|a| corner[a] + ulp * f64::from(k >> a & 1)))
        .collect();
    for box_factor in [2.0, 5.0, 100.0] {
        let s = samples(&points, box_factor).unwrap();
        assert_eq!(s.len(), 8);
        let made = delaunay::delaunay(&s, &Context::default()).unwrap();
        assert_eq!(delaunay::check(&made), [], "box factor {box_factor}");
    }
}

/// The triangulation at full size, samples and frame on the lattice.
#[test]
fn triangulated_samples_pass_their_check() {
    let clouds: [(&str, Vec<Point>); 4] = [
        ("torus", shapes::TORUS.samples(2_000, 17)),
        ("block", shapes::CAD_BLOCK.samples(2_000, 18)),
        ("sphere", shapes::UNIT_SPHERE.samples(2_000, 19)),
        ("cube", shapes::CUBE.samples(2_000, 20)),
    ];
    for (name, points) in clouds {
        for box_factor in [2.0, 5.0, 100.0] {
            let s = samples(&points, box_factor).unwrap();
            let made = delaunay::delaunay(&s, &Context::default()).unwrap();
            assert_eq!(delaunay::check(&made), [], "{name}, {box_factor}");
            assert_eq!(made.sites.len(), s.len() + 8);
        }
    }
}
