//! The harness under test: a judge that errs, or samples off their surface,
//! would make every other test here worthless.

mod common;

use common::judge::{deviation, distance_to_triangle, topology};
use common::random::Random;
use common::shapes::{self, Shape, Sphere};
use powercrust::geom::vec3::{add, dot, norm, scale, sub};
use powercrust::{Point, PolygonMesh};

#[test]
fn splitmix_follows_the_reference() {
    // The first outputs of the authors' C code for the seed 1234567.
    let mut random = Random::new(1234567);
    assert_eq!(random.bits(), 6457827717110365317);
    assert_eq!(random.bits(), 3203168211198807973);
}

#[test]
fn directions_have_length_one_and_no_bias() {
    let mut random = Random::new(1);
    let mut sum = [0.0; 3];
    for _ in 0..10_000 {
        let d = random.direction();
        assert!((norm(d) - 1.0).abs() < 1e-15);
        sum = add(sum, d);
    }
    assert!(sum.iter().all(|s| s.abs() < 300.0), "{sum:?}"); // 5 sigma
}

fn mesh(vertices: &[Point], faces: &[&[u32]]) -> PolygonMesh {
    let mut mesh = PolygonMesh::with_vertices(vertices.to_vec());
    faces.iter().for_each(|face| mesh.push_face(face));
    mesh
}

const CORNERS: [Point; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
];
const FACES: [&[u32]; 4] = [&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]];

#[test]
fn tetrahedron_is_sound_and_its_spoilt_copies_are_not() {
    let whole = topology(&mesh(&CORNERS, &FACES));
    assert!(whole.sound(), "{whole:?}");
    assert_eq!((whole.genus(), whole.components, whole.edges), (0, 1, 6));

    assert_eq!(topology(&mesh(&CORNERS, &FACES[..3])).border, 3);
    let mut turned = FACES;
    turned[0] = &[0, 1, 2];
    assert_eq!(topology(&mesh(&CORNERS, &turned)).repeated, 3);
    let mut flat = CORNERS;
    flat[3] = [0.5, 0.5, 0.0];
    assert_eq!(topology(&mesh(&flat, &FACES)).flat, 1);
    assert_eq!(topology(&mesh(&CORNERS, &[&[0, 1, 1]])).broken, 1);
    let five = [&CORNERS[..], &[[9.0; 3]]].concat();
    assert_eq!(topology(&mesh(&five, &FACES)).unused, 1);
}

#[test]
fn two_tetrahedra_at_one_vertex_are_pinched() {
    let vertices: Vec<Point> = CORNERS
        .into_iter()
        .chain(CORNERS[1..].iter().map(|&p| scale(p, -1.0)))
        .collect();
    let faces: Vec<Vec<u32>> = FACES
        .iter()
        .map(|face| face.to_vec())
        .chain(FACES.iter().map(|face| {
            let far = |&v: &u32| if v == 0 { 0 } else { v + 3 };
            face.iter().rev().map(far).collect()
        }))
        .collect();
    let faces: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
    let pair = topology(&mesh(&vertices, &faces));
    assert_eq!((pair.pinched, pair.components, pair.border), (1, 1, 0));
}

#[test]
fn octahedron_strays_from_the_sphere_by_what_it_must() {
    let vertices: Vec<Point> = (0..6)
        .map(|i| {
            let mut p = [0.0; 3];
            p[i / 2] = if i % 2 == 0 { 1.0 } else { -1.0 };
            p
        })
        .collect();
    let faces: [&[u32]; 8] = [
        &[0, 2, 4],
        &[2, 1, 4],
        &[1, 3, 4],
        &[3, 0, 4],
        &[2, 0, 5],
        &[1, 2, 5],
        &[3, 1, 5],
        &[0, 3, 5],
    ];
    let octahedron = mesh(&vertices, &faces);
    assert!(topology(&octahedron).sound());
    let sphere = Sphere {
        centre: [0.0; 3],
        radius: 1.0,
    };
    let found = deviation(&octahedron, &sphere);
    assert!((found.max - (1.0 - (1.0f64 / 3.0).sqrt())).abs() < 1e-15);
    assert!(found.mean < found.max && found.mean > 0.25);
}

#[test]
fn distance_to_triangle_covers_its_regions() {
    let triangle = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
    let close = |p: Point, d: f64| (distance_to_triangle(p, triangle) - d).abs() < 1e-15;
    assert!(close([0.5, 0.5, -3.0], 3.0)); // face
    assert!(close([1.0, -2.0, 0.0], 2.0)); // edge
    assert!(close([2.0, 2.0, 0.0], 2.0f64.sqrt())); // slanted edge
    assert!(close([5.0, -4.0, 0.0], 5.0)); // corner
}

#[test]
fn samples_lie_on_their_surface() {
    for shape in shapes::all() {
        for p in shape.samples(2_000, 7) {
            let distance = shape.signed_distance(p);
            assert!(
                distance.abs() < 1e-12,
                "{}: {p:?} is {distance:e} off the surface",
                shape.name()
            );
        }
        let mut random = Random::new(8);
        for p in (0..200).filter_map(|_| shape.edge_point(&mut random)) {
            assert!(shape.signed_distance(p).abs() < 1e-12, "{}", shape.name());
        }
    }
}

/// Random lines hit any surface uniformly by area. Each half-space must hold
/// the same share of their hits as of the sampler's points.
#[test]
fn samplers_agree_with_random_lines() {
    for shape in shapes::all() {
        let samples = shape.samples(20_000, 3);
        let mut hits = Vec::new();
        let mut random = Random::new(4);
        while hits.len() < 3_000 {
            let value = |p| shape.signed_distance(p);
            shapes::line_hits(&value, 3.7, &mut random, &mut hits);
        }
        for _ in 0..40 {
            let (normal, anchor) = (random.direction(), samples[random.below(samples.len())]);
            let share = |points: &[Point]| {
                let inside = points
                    .iter()
                    .filter(|&&p| dot(sub(p, anchor), normal) > 0.0);
                inside.count() as f64 / points.len() as f64
            };
            let difference = (share(&samples) - share(&hits)).abs();
            // Hits come in pairs: 4.6 sigma of 1,500 draws.
            assert!(difference < 0.06, "{}: {difference}", shape.name());
        }
    }
}

/// The distance never exceeds the distance to a sample, comes close to it
/// when samples are many, and has the sign of inside and outside.
#[test]
fn distances_agree_with_the_nearest_of_many_samples() {
    for shape in shapes::all() {
        let samples = shape.samples(40_000, 5);
        let mut random = Random::new(6);
        for _ in 0..60 {
            let around = samples[random.below(samples.len())];
            let p = add(around, scale(random.direction(), random.within(0.0, 0.2)));
            let distance = shape.signed_distance(p).abs();
            let nearest = samples
                .iter()
                .map(|&s| norm(sub(s, p)))
                .fold(f64::INFINITY, f64::min);
            let name = shape.name();
            assert!(distance <= nearest + 1e-12, "{name}: {p:?}");
            assert!(
                (nearest * nearest - distance * distance).sqrt() < 0.12,
                "{name}: {p:?}: {distance} {nearest}"
            );
        }
        assert!(shape.signed_distance([9.0; 3]) > 0.0);
    }
    let middle = [0.0, 0.0, 0.0];
    assert_eq!(shapes::CUBE.signed_distance(middle), -1.0);
    assert_eq!(shapes::CAD_BLOCK.signed_distance(middle), 0.5);
    assert_eq!(shapes::CAD_BLOCK.signed_distance([1.0, 0.0, 0.0]), -0.5);
    assert!(shapes::DOUBLE_TORUS.value(middle) < 0.0);
    assert_eq!(shapes::TORUS.signed_distance([1.0, 0.0, 0.0]), -0.4);
    assert_eq!(shapes::SHELL.signed_distance(middle), 0.5);
}

/// Monte Carlo in the box [-3.2, 3.2]^3.
#[test]
fn volumes_agree_with_counting() {
    for shape in shapes::all() {
        let mut random = Random::new(9);
        let reach = 3.2;
        let inside = (0..50_000)
            .filter(|_| {
                let p = [(); 3].map(|()| random.within(-reach, reach));
                shape.signed_distance(p) < 0.0
            })
            .count();
        let share = inside as f64 / 5e4;
        let sigma = (share * (1.0 - share) / 5e4).sqrt();
        let expected = shape.truth().volume / (2.0 * reach).powi(3);
        assert!(
            (share - expected).abs() < 5.0 * sigma,
            "{}: {share} {expected}",
            shape.name()
        );
    }
}

/// A point of the axis is a centre of a ball that touches the surface but
/// does not cross it; one beside the axis is at the right distance from it.
#[test]
fn medial_axes_hold_up() {
    let ellipsoid = shapes::Ellipsoid([3.0, 2.0, 1.0]);
    assert_eq!(ellipsoid.disc(), [3.0 - 1.0 / 3.0, 1.5]);
    // The closed form of medial-axis-specs 3.12 for the radius.
    for p in ellipsoid.axis_points(200, 1) {
        let (x, y) = (p[0] / (1.0 - 1.0 / 9.0), p[1] / (1.0 - 1.0 / 4.0));
        let radius_sq = x * x / 81.0 + y * y / 16.0 + (1.0 - x * x / 9.0 - y * y / 4.0);
        let distance = ellipsoid.signed_distance(p);
        assert!((distance + radius_sq.sqrt()).abs() < 1e-9, "{p:?}");
        assert_eq!(ellipsoid.axis_distance(p), Some(0.0));
        assert_eq!(ellipsoid.axis_distance([p[0], p[1], 0.25]), Some(0.25));
    }
    assert!((ellipsoid.axis_distance([3.0, 0.0, 0.0]).unwrap() - 1.0 / 3.0).abs() < 1e-15);

    let cylinder = shapes::CYLINDER;
    for (p, distance) in [
        ([0.0, 0.0, 0.7], 0.0),
        ([0.0, 0.25, 1.25], 0.0),
        ([0.3, 0.0, 0.0], 0.3),
        ([0.0, 0.0, 1.5], 0.125f64.sqrt()),
    ] {
        assert!((cylinder.axis_distance(p).unwrap() - distance).abs() < 1e-15);
    }
    let plate = shapes::ROUNDED_PLATE;
    assert_eq!(plate.axis_distance([0.9, -0.7, 0.05]), Some(0.05));
}

#[test]
fn darts_keep_their_distance() {
    let spacing = 0.113;
    let points = shapes::Ellipsoid([3.0, 2.0, 1.0]).spaced_samples(2_086, spacing, 1);
    assert_eq!(points.len(), 2_086); // medial-axis-specs 2.11
    for (i, &p) in points.iter().enumerate() {
        let close = points[..i].iter().find(|&&q| norm(sub(p, q)) < spacing);
        assert!(close.is_none(), "{p:?} and {close:?}");
    }
}
