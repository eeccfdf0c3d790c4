//! Normals and the places of scanners as evidence for labels.

use powercrust::{reconstruct, reconstruct_seen, Context, Error, Options, Point, Reconstruction};

/// Numbers in [0, 1), the same each time.
fn numbers(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state =
            (state.wrapping_mul(6_364_136_223_846_793_005)).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Directions at random, and for each a point near the sphere of this radius.
fn sphere(count: usize, radius: f64, noise: f64, seed: u64) -> Vec<(Point, Point)> {
    let mut next = numbers(seed);
    let mut gauss = move || {
        let (u, v) = (1.0 - next(), next());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    };
    (0..count)
        .map(|_| {
            let way = [gauss(), gauss(), gauss()];
            let length = way.iter().map(|v| v * v).sum::<f64>().sqrt();
            let way = way.map(|v| v / length);
            (way.map(|v| radius * v + noise * gauss()), way)
        })
        .collect()
}

fn seen(points: &[Point], outward: &[Point]) -> Reconstruction {
    reconstruct_seen(points, outward, &Options::default(), &Context::default()).unwrap()
}

#[test]
fn right_normals_inward_ones_and_wrong_ones() {
    let (points, ways): (Vec<Point>, Vec<Point>) = sphere(1500, 1.0, 0.0, 3).into_iter().unzip();
    let without = reconstruct(&points, &Options::default(), &Context::default()).unwrap();
    assert_eq!(without.stats.outward.samples, 0);
    let scaled = |f: &dyn Fn(usize) -> f64| -> Vec<Point> {
        (ways.iter().enumerate())
            .map(|(k, w)| w.map(|c| c * f(k)))
            .collect()
    };
    let right = seen(&points, &scaled(&|_| 3.0));
    let found = right.stats.outward;
    assert!(
        found.believed && !found.turned && found.share > 0.999,
        "{found:?}"
    );
    assert_eq!(found.samples, right.sample_source.len());
    let inward = seen(&points, &scaled(&|_| -1.0));
    let found = inward.stats.outward;
    assert!(
        found.believed && found.turned && found.share < 0.001,
        "{found:?}"
    );
    let either = seen(&points, &scaled(&|k| [1.0, -1.0][k * 7 / 3 % 2]));
    let found = either.stats.outward;
    assert!(
        !found.believed && (found.share - 0.5).abs() < 0.1,
        "{found:?}"
    );
    // There is nothing to tell about a sphere.
    for other in [right, inward, either] {
        assert_eq!(other.crust.mesh, without.crust.mesh);
    }
    // Half of them without: those say nothing, and vectors that are no numbers neither.
    let half = seen(&points, &scaled(&|k| [1.0, 0.0, f64::NAN][k % 3]));
    assert_eq!(half.crust.mesh, without.crust.mesh);
    assert!(half.stats.outward.believed);
}

#[test]
fn a_vector_for_each_point_or_none() {
    let points: Vec<Point> = sphere(50, 1.0, 0.0, 1).iter().map(|p| p.0).collect();
    let few = reconstruct_seen(
        &points,
        &points[..49],
        &Options::default(),
        &Context::default(),
    );
    match few {
        Err(Error::Option { name, value, .. }) => assert_eq!((name, value), ("outward", 49.0)),
        other => panic!("{:?}", other.map(|r| r.stats)),
    }
}

/// Hollow spheres. A wall five times as thick as the noise is full of holes without normals and has none with
/// them; one three and a half times as thick is lost without, and has its volume with them.
#[test]
fn normals_help_in_thin_walls_amid_noise() {
    let hollow = |inside: f64, count: usize, noise: f64| -> (Vec<Point>, Vec<Point>) {
        let mut both = sphere(4000, 1.0, noise, 5);
        let inside = sphere(count, inside, noise, 6);
        both.extend(inside.into_iter().map(|(p, w)| (p, w.map(|c| -c))));
        both.into_iter().unzip()
    };
    let euler = |r: &Reconstruction| {
        let faces = r.crust.mesh.face_count() as i64;
        r.crust.mesh.vertices.len() as i64 - faces / 2
    };
    // Every hole through the wall takes two from the 4 of two spheres.
    let holes = |r: &Reconstruction| (4 - euler(r)) / 2;

    let (points, ways) = hollow(0.85, 2890, 0.03);
    assert!(holes(&seen(&points, &[])) > 20);
    let with = seen(&points, &ways);
    assert!(with.stats.outward.believed && with.stats.noise.sheets_told);
    assert_eq!(holes(&with), 0);

    let (points, ways) = hollow(0.93, 3460, 0.02);
    let without = seen(&points, &[]);
    assert!(!without.stats.noise.sheets_told);
    assert!(without.stats.volume > 3.5, "{}", without.stats.volume);
    let with = seen(&points, &ways).stats;
    let truth = 4.0 / 3.0 * std::f64::consts::PI * (1.0 - 0.93f64.powi(3));
    assert!((with.volume / truth - 1.0).abs() < 0.1, "{}", with.volume);
    // Vectors at random are no help, and do no harm.
    let random: Vec<Point> = (ways.iter().enumerate())
        .map(|(k, w)| {
            w.map(|c| c * [1.0, -1.0][(k as u32).wrapping_mul(747_796_405) as usize >> 31])
        })
        .collect();
    let with = seen(&points, &random);
    assert!(!with.stats.noise.sheets_told);
    assert_eq!(with.crust.mesh, without.crust.mesh);
}

/// The order of the points and the number of threads do not matter.
#[test]
fn evidence_goes_with_its_point() {
    let (mut points, mut ways): (Vec<Point>, Vec<Point>) =
        sphere(1200, 1.0, 0.05, 9).into_iter().unzip();
    // Any length, and some of none.
    for (k, way) in ways.iter_mut().enumerate() {
        let length = [1.0, 1e-320, 1e300, 0.0, f64::NAN, f64::INFINITY][k % 6];
        *way = way.map(|c| c * length);
    }
    let one = seen(&points, &ways);
    assert!(one.stats.noise.treated);
    points.reverse();
    ways.reverse();
    let context = Context {
        threads: std::num::NonZeroUsize::new(3),
        ..Context::default()
    };
    let other = reconstruct_seen(&points, &ways, &Options::default(), &context).unwrap();
    assert_eq!(one.crust.mesh, other.crust.mesh);
    assert_eq!(one.stats.outward.samples, 600);
    assert!((one.stats.outward.share - other.stats.outward.share).abs() < 1e-9);
}
