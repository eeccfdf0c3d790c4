//! The surface belongs to the samples, not to their order, their unit, the
//! axes or the threads.

mod common;

use common::judge::{deviation, topology};
use common::random::Random;
use common::shapes::{self, Shape};
use common::{crust, polygons, threads};
use powercrust::surface::NONE;
use powercrust::{reconstruct, Error, Faces, Options, Point, Reconstruction};
use std::collections::HashMap;

/// Clouds in general position and clouds that are anything but.
fn clouds() -> Vec<(&'static str, Vec<Point>)> {
    let mut clouds = general_clouds();
    clouds.push(("integer grid", grid(6)));
    clouds.push(("cospherical integers", integers_on_a_sphere(1_001)));
    clouds.push(("cube of grid points", cube_surface_grid(8)));
    let mut doubled = shapes::UNIT_SPHERE.samples(400, 3);
    doubled.extend_from_within(100..200);
    clouds.push(("sphere with doubles", doubled));
    clouds
}

fn general_clouds() -> Vec<(&'static str, Vec<Point>)> {
    vec![
        ("torus", shapes::TORUS.samples(1_500, 1)),
        (
            "ellipsoid",
            shapes::Ellipsoid([1.0, 2.0, 3.0]).samples(1_500, 2),
        ),
        ("CAD block", shapes::CAD_BLOCK.samples(1_500, 4)),
    ]
}

/// All points of an integer grid.
fn grid(side: i32) -> Vec<Point> {
    let at = move |n: i32| [n % side, n / side % side, n / side / side].map(f64::from);
    (0..side.pow(3)).map(at).collect()
}

/// The points of that grid on the surface of its cube.
fn cube_surface_grid(side: i32) -> Vec<Point> {
    let outermost = |p: &Point| p.iter().any(|&x| x == 0.0 || x == f64::from(side - 1));
    grid(side).into_iter().filter(outermost).collect()
}

/// All integer points at the distance sqrt(`norm_sq`) from the origin.
fn integers_on_a_sphere(norm_sq: i32) -> Vec<Point> {
    let reach = f64::from(norm_sq).sqrt() as i32;
    let side = 2 * reach + 1;
    grid(side)
        .into_iter()
        .map(|p| p.map(|x| x - f64::from(reach)))
        .filter(|p| p.iter().map(|x| x * x).sum::<f64>() == f64::from(norm_sq))
        .collect()
}

/// The two results have the same bytes: vertices, faces, and the places of
/// their samples in the two inputs.
#[track_caller]
fn assert_same(name: &str, a: (&[Point], &Reconstruction), b: (&[Point], &Reconstruction)) {
    let bits = |points: &[Point]| -> Vec<[u64; 3]> {
        points.iter().map(|p| p.map(f64::to_bits)).collect()
    };
    let (left, right) = (&a.1.crust, &b.1.crust);
    assert_eq!(
        left.mesh.face_count(),
        right.mesh.face_count(),
        "{name}: number of faces"
    );
    assert!(
        bits(&left.mesh.vertices) == bits(&right.mesh.vertices),
        "{name}: vertices differ"
    );
    assert!(
        (&left.mesh.starts, &left.mesh.corners) == (&right.mesh.starts, &right.mesh.corners),
        "{name}: faces differ"
    );
    assert!(
        left.face_balls == right.face_balls,
        "{name}: balls of faces differ"
    );
    let places = |points: &[Point], result: &Reconstruction| -> Vec<Option<[u64; 3]>> {
        let of = |&sample: &u32| {
            let source = *result.sample_source.get(sample as usize)?;
            Some(points[source as usize].map(f64::to_bits))
        };
        result.crust.vertex_samples.iter().map(of).collect()
    };
    assert!(
        places(a.0, a.1) == places(b.0, b.1),
        "{name}: samples of vertices differ"
    );
}

/// Both runs succeed, or both fail with the same kind of error.
fn both(
    name: &str,
    a: Result<Reconstruction, Error>,
    b: Result<Reconstruction, Error>,
) -> Option<(Reconstruction, Reconstruction)> {
    match (a, b) {
        (Ok(a), Ok(b)) => Some((a, b)),
        (Err(a), Err(b)) => {
            assert_eq!(
                std::mem::discriminant(&a),
                std::mem::discriminant(&b),
                "{name}"
            );
            println!("{name}: {a}");
            None
        }
        (a, b) => panic!("{name}: {:?} but {:?}", a.err(), b.err()),
    }
}

fn run(points: &[Point], faces: Faces, thread_count: usize) -> Result<Reconstruction, Error> {
    let options = Options {
        faces,
        ..Options::default()
    };
    reconstruct(points, &options, &threads(thread_count))
}

#[test]
fn order_of_the_input_does_not_matter() {
    for (name, points) in clouds() {
        for faces in [Faces::Polygons, Faces::Triangles] {
            let given = run(&points, faces, 1);
            let mut mixed = points.clone();
            Random::new(5).shuffle(&mut mixed);
            if let Some((a, b)) = both(name, given, run(&mixed, faces, 1)) {
                assert_same(name, (&points, &a), (&mixed, &b));
            }
        }
    }
}

#[test]
fn powers_of_two_scale_through() {
    for (name, points) in clouds() {
        let given = run(&points, Faces::Polygons, 1);
        for exponent in [-40, 40] {
            let factor = 2.0f64.powi(exponent);
            let scaled: Vec<Point> = points.iter().map(|p| p.map(|x| x * factor)).collect();
            let mut result = run(&scaled, Faces::Polygons, 1);
            if let Ok(result) = &mut result {
                for vertex in &mut result.crust.mesh.vertices {
                    *vertex = vertex.map(|x| x / factor);
                }
            }
            let name = format!("{name} times 2^{exponent}");
            if let Some((a, b)) = both(&name, given.clone(), result) {
                assert_same(&name, (&points, &a), (&points, &b));
            }
        }
    }
}

#[test]
fn threads_do_not_matter() {
    let mut clouds = clouds();
    clouds.push(("large torus", shapes::TORUS.samples(12_000, 6)));
    for (name, points) in clouds {
        let one = run(&points, Faces::Triangles, 1);
        for count in [2, 5] {
            let many = run(&points, Faces::Triangles, count);
            if let Some((a, b)) = both(name, one.clone(), many) {
                assert_same(name, (&points, &a), (&points, &b));
                let debug = |result: &Reconstruction| format!("{:?}", result.balls);
                assert!(debug(&a) == debug(&b), "{name}: balls differ");
            }
        }
    }
}

#[test]
fn twice_the_same_is_the_same() {
    for (name, points) in clouds() {
        let again = run(&points, Faces::Triangles, 2);
        if let Some((a, b)) = both(name, run(&points, Faces::Triangles, 2), again) {
            assert_same(name, (&points, &a), (&points, &b));
        }
    }
}

/// How often each face occurs, a face being the sorted places (in the input)
/// of its corners at samples and the number of its other corners.
fn face_census(result: &Reconstruction) -> HashMap<(Vec<u32>, usize), usize> {
    let mut census = HashMap::new();
    for face in result.crust.mesh.faces() {
        let mut samples: Vec<u32> = face
            .iter()
            .map(|&v| result.crust.vertex_samples[v as usize])
            .filter(|&s| s != NONE)
            .map(|s| result.sample_source[s as usize])
            .collect();
        let others = face.len() - samples.len();
        samples.sort_unstable();
        *census.entry((samples, others)).or_default() += 1;
    }
    census
}

/// Turned by 90 degrees or mirrored, a cloud in general position gives the
/// same faces, each through the same samples.
#[test]
fn turns_and_mirrors_carry_the_faces_along() {
    type Move = (&'static str, fn(Point) -> Point);
    let moves: [Move; 4] = [
        ("turned about z", |[x, y, z]| [-y, x, z]),
        ("turned about x", |[x, y, z]| [x, -z, y]),
        ("axes permuted", |[x, y, z]| [z, x, y]),
        ("mirrored", |[x, y, z]| [-x, y, z]),
    ];
    // Smooth shapes turn exactly. Planes along the axes are no general
    // position: of many near ties some fall the other way; merging adds more.
    let defaults = polygons();
    let unmerged = Options {
        merge: 0.0,
        ..polygons()
    };
    for options in [unmerged, defaults] {
        for (name, points) in general_clouds() {
            let plain = options.merge == 0.0 && name != "CAD block";
            let most = if plain { 0.0 } else { 0.01 };
            let given = crust(name, &points, &options);
            for (how, map) in moves {
                let name = format!("{name} {how}, merge {}", options.merge);
                let moved: Vec<Point> = points.iter().map(|&p| map(p)).collect();
                let result = crust(&name, &moved, &options);
                assert!(result.crust.mesh.volume() > 0.0, "{name}: inside out");
                let differing = faces_that_differ(&given, &result);
                let share = differing as f64 / given.crust.mesh.face_count() as f64;
                println!("{name}: {differing} faces differ, {:.3}%", 100.0 * share);
                assert!(share <= most, "{name}: {differing} faces differ");
            }
        }
    }
}

/// The number of faces of either that the other lacks.
fn faces_that_differ(a: &Reconstruction, b: &Reconstruction) -> usize {
    let (left, right) = (face_census(a), face_census(b));
    let in_both: usize = left
        .iter()
        .map(|(face, &count)| count.min(right.get(face).copied().unwrap_or(0)))
        .sum();
    a.crust.mesh.face_count() + b.crust.mesh.face_count() - 2 * in_both
}

/// On degenerate clouds the symbolic perturbation is not symmetric, but the
/// surface is what it is.
#[test]
fn turned_degenerate_clouds_keep_their_surface() {
    let side = 9;
    let cube = shapes::Cuboid {
        name: "cube of grid points",
        half: [4.0; 3],
    };
    let centred: Vec<Point> = cube_surface_grid(side)
        .into_iter()
        .map(|p| p.map(|x| x - 4.0))
        .collect();
    let turns: [fn(Point) -> Point; 3] = [|p| p, |[x, y, z]| [-y, x, z], |[x, y, z]| [-x, z, y]];
    for turn in turns {
        let points: Vec<Point> = centred.iter().map(|&p| turn(p)).collect();
        let result = crust(cube.name, &points, &polygons());
        let mesh = &result.crust.mesh;
        let found = topology(mesh);
        assert!(found.sound(), "{found:?}");
        assert_eq!((found.components, found.genus()), (1, 0));
        let volume = mesh.volume();
        println!(
            "{}: volume {volume}, error {:?}",
            cube.name,
            deviation(mesh, &cube)
        );
        assert!((volume / 512.0 - 1.0).abs() < 0.01, "volume {volume}");
    }
}
