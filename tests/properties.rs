//! Families of awkward clouds, by proptest: whatever comes, a typed error or a
//! surface without fault, and every stage on the way keeps what it promises.
//! A failing cloud is shrunk before it is shown.
//!
//! The same clouds come every time; `POWERCRUST_CASES=500` makes more of each
//! family, `POWERCRUST_SALT=7` others.

use powercrust::delaunay::{self, delaunay, samples};
use powercrust::label::{self, label, opposites, refine, Evidence, LabelOptions, Neighbours};
use powercrust::mesh::{check, CheckOptions};
use powercrust::poles::{self, poles, Bound, PoleOptions};
use powercrust::power::{self, power_diagram};
use powercrust::simplify::merge_redundant;
use powercrust::surface::{clean, power_shape, raw_crust, triangulate, CleanOptions, Placement};
use powercrust::{
    reconstruct, Context, Error, Faces, LambdaOption, Options, Point, SharpOption, Side,
};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner};
use std::cell::Cell;
use std::f64::consts::TAU;

fn setting(name: &str) -> Option<u32> {
    std::env::var(name).ok()?.parse().ok()
}

/// Options that change the surface, the default most often.
fn options() -> impl Strategy<Value = Options> {
    let lambda = prop_oneof![
        3 => Just(LambdaOption::Auto),
        1 => Just(LambdaOption::Value(0.2)),
        1 => Just(LambdaOption::Value(0.5)),
    ];
    let flags = (any::<bool>(), any::<bool>(), any::<bool>(), any::<bool>());
    let shares = (prop_oneof![3 => Just(0.5), 1 => Just(0.0)], 2.0..8.0);
    (lambda, flags, shares).prop_map(
        |(lambda, (sharp, single, polygons, plain), (merge, frame))| Options {
            lambda,
            sharp: match (sharp, lambda.is_given()) {
                (true, true) => SharpOption::Skinny,
                (true, false) => SharpOption::Auto,
                _ => SharpOption::Off,
            },
            single: single && !polygons,
            faces: if polygons {
                Faces::Polygons
            } else {
                Faces::Triangles
            },
            flatness: if plain { 0.35 } else { 0.0 },
            merge,
            box_factor: frame,
            ..Options::default()
        },
    )
}

/// A typed error, or a surface that is closed, manifold, outward and touches
/// itself nowhere, judged by exact arithmetic. Whether there was a surface.
fn surface_or_error(points: &[Point], options: &Options) -> Result<bool, TestCaseError> {
    let result = match reconstruct(points, options, &Context::default()) {
        Ok(result) => result,
        Err(Error::Samples(_) | Error::NothingInside { .. } | Error::Single { .. }) => {
            return Ok(false)
        }
        Err(other) => return Err(TestCaseError::fail(other.to_string())),
    };
    let judge = CheckOptions {
        f32: options.single,
        ..CheckOptions::default()
    };
    let mesh = &result.crust.mesh;
    let report = check(mesh, &judge, &Context::default()).expect("nobody cancelled");
    prop_assert!(
        report.is_embedded(),
        "{:?} volume {}",
        report.counts,
        report.volume
    );
    prop_assert_eq!(result.stats.crossings_left, 0);
    Ok(true)
}

/// The stages one after the other, each asked for all it promises. Clouds that
/// are no samples have no stages.
fn stages_keep_their_word(points: &[Point], options: &Options) -> Result<(), TestCaseError> {
    let context = Context::default();
    let Ok(samples) = samples(points, options.box_factor) else {
        return Ok(());
    };
    // Samples: finite, distinct, in the lattice, each the image of a point.
    let mut sites: Vec<_> = (samples.sites.iter().map(|s| [s[0], s[1], s[2]])).collect();
    let at = sites.clone();
    sites.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    prop_assert!(sites.windows(2).all(|two| two[0] != two[1]));
    prop_assert!(sites.iter().flatten().all(|x| x.fract() == 0.0));
    for (sample, &source) in samples.points.iter().zip(&samples.source) {
        prop_assert_eq!(sample, &points[source as usize]);
    }
    let delaunay = delaunay(&samples, &context).expect("nobody cancelled");
    prop_assert_eq!(delaunay::check(&delaunay), vec![]);
    let chosen = PoleOptions {
        bound: Bound::choose(options.lambda, samples.len(), &[]).0,
        sharp: options.sharp == SharpOption::Skinny,
    };
    let poles = poles(&samples, &delaunay, &chosen, &context).expect("nobody cancelled");
    if !options.lambda.is_given() {
        prop_assert_eq!(poles::check(&samples, &poles), vec![]);
    }
    let (poles, spacing) = merge_redundant(
        &samples,
        &delaunay.edges(&context).unwrap(),
        poles,
        options.merge,
        &context,
    )
    .expect("nobody cancelled");
    prop_assert_eq!(spacing.len(), samples.len());
    prop_assert!(spacing.iter().all(|s| *s > 0.0));
    let step = poles.balls.lattice.step();
    let power = power_diagram(&poles.balls.sites, step, &context).expect("few balls");
    prop_assert_eq!(power::check(&power), vec![]);
    let balls = poles.balls.on_lattice();
    let pairs = opposites(&poles.of_sample, &samples.sites, &balls);
    let evidence = Evidence {
        balls: &balls,
        outer: &poles.balls.touches_frame,
        opposites: &pairs,
        outward: &[],
    };
    let neighbours = Neighbours::of(&power, &context).expect("nobody cancelled");
    let how = LabelOptions::default();
    let mut labels = label(&evidence, &neighbours, &how, &context).expect("nobody cancelled");
    let before = label::energy(&evidence, &neighbours, &labels.sides, &how).total();
    refine(&evidence, &neighbours, &mut labels, &how);
    let after = label::energy(&evidence, &neighbours, &labels.sides, &how).total();
    prop_assert!(after <= before * (1.0 + 1e-12), "{before} to {after}");
    let faults = label::check(&evidence, &neighbours, &how, &labels);
    let fault = |f: &label::Finding| {
        matches!(
            f,
            label::Finding::Count { .. } | label::Finding::InnerAtFrame { .. }
        )
    };
    prop_assert!(!faults.iter().any(fault), "{faults:?}");
    // Whatever the labels: those found, and all at odds with their neighbours.
    let odd = |b: usize| match b.is_multiple_of(2) && !poles.balls.touches_frame[b] {
        true => Side::Inner,
        false => Side::Outer,
    };
    for sides in [labels.sides, (0..balls.len()).map(odd).collect()] {
        let place = Placement {
            touching: &|b| poles.balls.touching(b),
            sample: &|s| at[s as usize],
            to_user: &|p| p.map(|x| x * step),
        };
        let raw = raw_crust(&power, &sides, &place);
        let mut after: Vec<u32> = raw.next.clone();
        after.sort_unstable();
        prop_assert!(after.iter().copied().eq(0..raw.next.len() as u32), "next");
        for (h, &twin) in (0u32..).zip(&raw.twins) {
            let next = raw.next[h as usize];
            prop_assert!(twin != h && raw.twins[twin as usize] == h, "an open edge");
            prop_assert_eq!(raw.corners[next as usize], raw.corners[twin as usize]);
        }
        let none = raw.balls.is_empty();
        let polygons = clean(raw, &CleanOptions::default());
        for crust in [&polygons, &triangulate(&polygons)] {
            let judge = CheckOptions {
                intersections: false,
                ..CheckOptions::default()
            };
            let report = check(&crust.mesh, &judge, &context).expect("nobody cancelled");
            let c = report.counts;
            prop_assert!(
                none || crust.mesh.face_count() == 0 || report.is_closed(),
                "{c:?}"
            );
            prop_assert_eq!(c.pinched_vertex + c.unused_vertex + c.repeated_vertex, 0);
        }
        for side in [Side::Inner, Side::Outer] {
            let shape = power_shape(&power, &balls, &sides, side);
            let n = shape.balls.len() as u32;
            let corners = shape.edges.iter().flatten();
            prop_assert!(corners
                .chain(shape.triangles.iter().flatten())
                .all(|&b| b < n));
        }
    }
    Ok(())
}

/// Runs a family; at least a share of its clouds, in percent, must have a
/// surface, lest a family of nothing but errors passes for a test.
fn family(name: &str, percent: u32, points: impl Strategy<Value = Vec<Point>>) {
    let config = Config {
        cases: setting("POWERCRUST_CASES").unwrap_or(40),
        failure_persistence: None,
        max_shrink_iters: 2000,
        ..Config::default()
    };
    let cases = config.cases;
    let mut seed = [0; 32];
    seed[..4].copy_from_slice(&setting("POWERCRUST_SALT").unwrap_or(0).to_le_bytes());
    let random = TestRng::from_seed(RngAlgorithm::ChaCha, &seed);
    let mut runner = TestRunner::new_with_rng(config, random);
    let surfaces = Cell::new(0);
    let outcome = runner.run(&(points, options()), |(points, options)| {
        surfaces.set(surfaces.get() + u32::from(surface_or_error(&points, &options)?));
        stages_keep_their_word(&points, &options)?;
        Ok(())
    });
    match outcome {
        Ok(()) => {}
        Err(TestError::Fail(why, (points, options))) => {
            panic!("{name}: {why}\n{options:?}\nlet points = {points:?};")
        }
        Err(TestError::Abort(why)) => panic!("{name}: {why}"),
    }
    let surfaces = surfaces.get();
    assert!(
        surfaces * 100 >= cases * percent,
        "{name}: {surfaces} surfaces of {cases} clouds"
    );
}

fn unit() -> impl Strategy<Value = f64> {
    -1.0..1.0f64
}

fn point() -> impl Strategy<Value = Point> {
    [unit(), unit(), unit()]
}

/// By height and angle: all on the unit sphere but for rounding.
fn on_sphere() -> impl Strategy<Value = Point> {
    (unit(), 0.0..TAU).prop_map(|(z, angle)| {
        let r = (1.0 - z * z).sqrt();
        [r * angle.cos(), r * angle.sin(), z]
    })
}

#[test]
fn grids() {
    // Whole, with holes, and with steps of other lengths along each axis.
    let step = prop_oneof![Just(1.0), Just(0.1), Just(1.0 / 3.0), Just(1e-5)];
    let sides = (2usize..5, 2usize..5, 2usize..5);
    let grid = (
        sides,
        [step.clone(), step.clone(), step],
        vec(any::<u8>(), 125),
    );
    family(
        "grids",
        50,
        grid.prop_map(|((a, b, c), step, holes)| {
            let mut points = Vec::new();
            for k in 0..a * b * c {
                let at = [k % a, k / a % b, k / a / b];
                if holes[k] >= 40 {
                    points.push([0, 1, 2].map(|k| at[k] as f64 * step[k]));
                }
            }
            points
        }),
    );
}

#[test]
fn integer_clouds() {
    let coordinate = || (0..7i32).prop_map(f64::from);
    let cloud = vec([coordinate(), coordinate(), coordinate()], 4..80);
    family("integer clouds", 50, cloud);
}

#[test]
fn spheres() {
    // Many points on one sphere: all of one Delaunay cell, but for rounding.
    family("spheres", 60, vec(on_sphere(), 6..120));
}

#[test]
fn nested_spheres() {
    let radius = prop_oneof![Just(1.0), Just(0.5), Just(0.999), Just(1.0 + 1e-12)];
    let cloud = vec((on_sphere(), radius), 6..120)
        .prop_map(|some| some.iter().map(|(p, r)| p.map(|x| x * r)).collect());
    family("nested spheres", 60, cloud);
}

#[test]
fn cylinders() {
    // Rings of equal points at equal angles: cocircular and cospherical.
    let cloud = (3usize..14, 2usize..6, 0.05..2.0f64, any::<bool>()).prop_map(
        |(around, rings, height, capped)| {
            let mut points = Vec::new();
            for ring in 0..rings {
                for k in 0..around {
                    let angle = TAU * k as f64 / around as f64;
                    points.push([angle.cos(), angle.sin(), ring as f64 * height]);
                }
            }
            if capped {
                points.push([0.0; 3]);
                points.push([0.0, 0.0, (rings - 1) as f64 * height]);
            }
            points
        },
    );
    family("cylinders", 60, cloud);
}

#[test]
fn nearly_flat() {
    let cloud = (vec(point(), 4..80), 0..17i32, [unit(), unit()]).prop_map(|(some, thin, tilt)| {
        let thin = 10f64.powi(-thin);
        (some.iter())
            .map(|p| [p[0], p[1], tilt[0] * p[0] + tilt[1] * p[1] + thin * p[2]])
            .collect()
    });
    family("nearly flat", 5, cloud);
}

#[test]
fn clusters() {
    // Handfuls of points a billionth apart, some of them at the same place.
    let cloud = (vec(on_sphere(), 4..16), vec((any::<u8>(), point()), 4..80)).prop_map(
        |(centres, near)| {
            let near = near.iter().map(|(which, p)| {
                let c = centres[usize::from(*which) % centres.len()];
                [0, 1, 2].map(|k| c[k] + 1e-9 * (4.0 * p[k]).round())
            });
            near.chain(centres.iter().copied()).collect()
        },
    );
    family("clusters", 50, cloud);
}

#[test]
fn lines_and_spheres() {
    // A ball on a stick, which is thinner than anything.
    let cloud = (vec(on_sphere(), 6..60), vec(-3.0..3.0f64, 3..30), 0..3usize).prop_map(
        |(mut points, line, axis)| {
            points.extend(line.iter().map(|&t| {
                let mut p = [0.0; 3];
                p[axis] = t;
                p
            }));
            points
        },
    );
    family("lines and spheres", 60, cloud);
}

#[test]
fn exact_symmetries() {
    // Each point with its mirror images and turns about the diagonal.
    let cloud = (vec(point(), 1..5), any::<bool>()).prop_map(|(some, turned)| {
        let mut points = Vec::new();
        for p in some {
            for bits in 0..8u32 {
                let q = [0, 1, 2].map(|k| if bits >> k & 1 == 1 { p[k] } else { -p[k] });
                points.push(q);
                if turned {
                    points.push([q[1], q[2], q[0]]);
                    points.push([q[2], q[0], q[1]]);
                }
            }
        }
        points
    });
    family("exact symmetries", 30, cloud);
}

#[test]
fn far_away() {
    // So far from the origin that few or no bits are left for the shape.
    let far = (-1.0..1.0f64, 3..18i32).prop_map(|(x, e)| x * 10f64.powi(e));
    let cloud =
        (vec(on_sphere(), 6..80), [far.clone(), far.clone(), far]).prop_map(|(some, offset)| {
            (some.iter())
                .map(|p| [0, 1, 2].map(|k| p[k] + offset[k]))
                .collect()
        });
    family("far away", 25, cloud);
}

#[test]
fn any_scale() {
    // From denormal numbers to the largest there are.
    let cloud = (vec(on_sphere(), 6..80), -1080..1030i32).prop_map(|(some, e)| {
        let half = e / 2;
        let (a, b) = (2f64.powi(half), 2f64.powi(e - half));
        some.iter().map(|p| p.map(|x| x * a * b)).collect()
    });
    family("any scale", 25, cloud);
}

#[test]
fn denormals() {
    let tiny = || (0..1000u64).prop_map(f64::from_bits);
    family("denormals", 0, vec([tiny(), tiny(), tiny()], 4..60));
}

#[test]
fn mixed_magnitudes() {
    let any = || (unit(), -12..13i32).prop_map(|(x, e)| x * 10f64.powi(e));
    family("mixed magnitudes", 10, vec([any(), any(), any()], 4..60));
}

#[test]
fn any_bits() {
    // NaN and infinities, too: those must be named, not read past.
    let any = || any::<u64>().prop_map(f64::from_bits);
    family("any bits", 0, vec([any(), any(), any()], 0..12));
}
