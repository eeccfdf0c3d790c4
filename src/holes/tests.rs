//! Spheres of which parts were not seen, where all is known.

use std::f64::consts::PI;

use super::{HoleSize, Holes, Opened, Patch};
use crate::context::Context;
use crate::geom::Point;
use crate::mesh::{check, CheckOptions, PolygonMesh, Report};
use crate::options::Options;
use crate::pipeline::{reconstruct, Reconstruction};
use crate::surface::{Crust, NONE};

/// A unit sphere between two heights, the rims sampled.
fn zone(low: f64, high: f64, count: usize) -> Vec<Point> {
    let at = |z: f64, a: f64| {
        let r = (1.0 - z * z).max(0.0).sqrt();
        [r * a.cos(), r * a.sin(), z]
    };
    let mut points: Vec<Point> = (0..count)
        .map(|k| {
            let t = (k as f64 + 0.5) / count as f64;
            at(low + t * (high - low), k as f64 * 2.399_963_229_728_653)
        })
        .collect();
    let spacing = (2.0 * PI * (high - low) / count as f64).sqrt();
    for z in [low, high] {
        let round = (2.0 * PI * (1.0 - z * z).max(0.0).sqrt() / spacing) as usize;
        points.extend((0..round).map(|k| at(z, 2.0 * PI * k as f64 / round as f64)));
    }
    points
}

fn made(points: &[Point]) -> Reconstruction {
    reconstruct(points, &Options::default(), &Context::default()).unwrap()
}

fn judged(opened: &Opened) -> Report {
    let mesh = &opened.crust.mesh;
    check(mesh, &CheckOptions::default(), &Context::default()).unwrap()
}

fn near(found: f64, truth: f64, share: f64) {
    assert!((found / truth - 1.0).abs() < share, "{found}, not {truth}");
}

#[test]
fn a_whole_sphere_has_no_holes() {
    let result = made(&zone(-1.0, 1.0, 2000));
    let holes = result.holes(HoleSize::default());
    assert_eq!((holes.patches.len(), holes.share), (0, 0.0));
    let opened = holes.open(&result.crust);
    assert!(opened.loops.is_empty());
    assert_eq!(opened.crust.mesh, result.crust.mesh);
}

/// The paper's angle is shallow here: a large flat gap.
#[test]
fn a_cap_that_is_missing_is_one_loop() {
    let result = made(&zone(-1.0, 0.8, 3000));
    let holes = result.holes(HoleSize::default());
    let [patch] = &holes.patches[..] else {
        panic!("{:?}", holes.patches)
    };
    near(patch.width, 1.2, 0.07);
    near(patch.centre[2], 0.8, 0.01);
    near(patch.area, PI * 0.36, 0.03);
    near(holes.share, 0.36 / (0.36 + 3.6), 0.03);
    let opened = holes.open(&result.crust);
    let [border] = &opened.loops[..] else {
        panic!("{:?}", opened.loops)
    };
    near(border.length, 2.0 * PI * 0.6, 0.02);
    near(border.opening, PI * 0.36, 0.02);
    near(border.centre[2], 0.8, 0.01);
    assert_eq!(border.patch, 0);
    let report = judged(&opened);
    assert!(report.is_bordered() && !report.is_closed());
    assert_eq!(report.counts.open_edge, border.edges as u64);
    assert_eq!((report.shells[0].loops, report.genus), (1, Some(0)));
    near(report.area, 2.0 * PI * 1.8, 0.01);
}

#[test]
fn the_size_decides() {
    let result = made(&zone(-0.95, 0.8, 3000));
    let count = |size| result.holes(size).patches.len();
    assert_eq!(count(HoleSize::default()), 2);
    assert_eq!(count(HoleSize::Length(0.7)), 1);
    assert_eq!(count(HoleSize::Length(1.3)), 0);
    assert_eq!(count(HoleSize::Spacings(60.0)), 0);
    let opened = result.holes(HoleSize::default()).open(&result.crust);
    let patches: Vec<u32> = opened.loops.iter().map(|l| l.patch).collect();
    assert_eq!(patches, [0, 1]);
    near(opened.loops[1].length, 2.0 * PI * 0.312, 0.03);
}

/// Across a wavy rim the crust bulges: samples stay, and the area becomes less.
#[test]
fn a_wavy_hole_is_drawn_taut() {
    let wavy = |p: &Point| p[2] < 0.5 + 0.2 * (2.0 * p[1].atan2(p[0])).cos();
    let points: Vec<Point> = zone(-1.0, 0.8, 3000).into_iter().filter(wavy).collect();
    let mut result = made(&points);
    let holes = result.holes(HoleSize::default());
    let before = result.crust.clone();
    let filled = holes
        .fill(&mut result.crust, false, &Context::default())
        .unwrap();
    assert_eq!(filled.shares, [1.0]);
    assert!(
        !filled.vertices.is_empty() && filled.farthest > 1e-3,
        "{filled:?}"
    );
    let (old, new) = (&before.mesh.vertices, &result.crust.mesh.vertices);
    for (v, (old, new)) in old.iter().zip(new).enumerate() {
        let moved = filled.vertices.binary_search(&(v as u32)).is_ok();
        assert_eq!(moved, old != new);
        assert!(!moved || before.vertex_samples[v] == NONE);
    }
    let judge =
        |mesh: &PolygonMesh| check(mesh, &CheckOptions::default(), &Context::default()).unwrap();
    let area = |report: &Report| report.shells.iter().map(|s| s.area).sum::<f64>();
    let (bulging, taut) = (judge(&before.mesh), judge(&result.crust.mesh));
    assert!(taut.is_watertight());
    assert!(
        area(&taut) < area(&bulging) - 1e-4,
        "{} {}",
        area(&taut),
        area(&bulging)
    );
    // Rounded to 32 bits, on request.
    let round = |p: &Point| p.map(|c| f64::from(c as f32));
    let mut single = before.clone();
    single.mesh.vertices = old.iter().map(round).collect();
    let again = holes.fill(&mut single, true, &Context::default()).unwrap();
    assert_eq!(again.vertices, filled.vertices);
    let rounded: Vec<Point> = single.mesh.vertices.iter().map(round).collect();
    assert_eq!(rounded, single.mesh.vertices);
}

/// A cube with a tent on it, the apex to be drawn down, and a cavity that
/// reaches up into the tent: half the way is free.
#[test]
fn filling_stops_before_faces_cross() {
    let mut mesh = PolygonMesh::with_vertices(vec![
        [-1.0, -1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ]);
    for k in 0..4 {
        mesh.push_face(&[k, (k + 1) % 4, 4]);
        mesh.push_face(&[(k + 1) % 4, k, 5]);
    }
    let tent = PolygonMesh {
        vertices: [
            mesh.vertices.clone(),
            vec![
                [0.1, 0.0, -0.1],
                [-0.1, 0.1, -0.1],
                [-0.1, -0.1, -0.1],
                [0.0, 0.0, 0.3],
            ],
        ]
        .concat(),
        ..mesh.clone()
    };
    let crust = |mut mesh: PolygonMesh, cavity: bool| {
        if cavity {
            for face in [[6, 7, 8], [6, 9, 7], [7, 9, 8], [8, 9, 6]] {
                mesh.push_face(&face);
            }
        }
        let mut vertex_samples: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
        vertex_samples[4] = NONE;
        Crust {
            vertex_samples,
            face_balls: vec![[0, 1]; mesh.face_count()],
            mesh,
        }
    };
    let fill = |mut crust: Crust, patch: &dyn Fn(usize) -> u32| {
        let mut patch_of_face = vec![NONE; crust.mesh.face_count()];
        (0..4).for_each(|k| patch_of_face[2 * k] = patch(k));
        let holes = Holes {
            patches: vec![
                Patch {
                    width: 1.0,
                    spacings: 10.0,
                    area: 1.0,
                    faces: 4,
                    centre: [0.0; 3],
                };
                1 + (0..4).map(patch).max().unwrap() as usize
            ],
            patch_of_face,
            share: 0.25,
        };
        let filled = holes.fill(&mut crust, false, &Context::default()).unwrap();
        (filled, crust.mesh.vertices[4])
    };
    // At any size: squares of such lengths vanish or overflow.
    for size in [1.0, 1e-300, 1e290] {
        let sized = |mesh: &PolygonMesh| PolygonMesh {
            vertices: (mesh.vertices.iter().map(|p| p.map(|c| c * size))).collect(),
            ..mesh.clone()
        };
        let (filled, apex) = fill(crust(sized(&mesh), false), &|_| 0);
        assert_eq!((&filled.shares[..], apex[2]), (&[1.0][..], 0.0));
        let (filled, apex) = fill(crust(sized(&tent), true), &|_| 0);
        assert_eq!(
            (&filled.shares[..], &filled.vertices[..]),
            (&[0.5][..], &[4][..])
        );
        near(apex[2], 0.5 * size, 1e-9);
        near(filled.farthest, 0.5 * size, 1e-9);
    }
    // The apex between two patches, and crossed by a face of the other one only: it stops as well.
    let mut aside = tent;
    for v in 6..10 {
        let [x, y, z] = aside.vertices[v];
        aside.vertices[v] = [0.2 * x - 0.1, 0.2 * y + 0.02, z];
    }
    let halves: [&dyn Fn(usize) -> u32; 2] = [&|k| u32::from(k > 1), &|k| u32::from(k < 1)];
    for patch in halves {
        let (_, apex) = fill(crust(aside.clone(), true), patch);
        assert_eq!(apex[2], 0.5);
    }
}

/// A third of a sphere, seen from one side: what comes out is the sheet.
#[test]
fn a_sheet_stays_a_sheet() {
    let result = made(&zone(0.4, 1.0, 1500));
    let holes = result.holes(HoleSize::default());
    assert!(holes.share > 0.35, "{}", holes.share);
    let opened = holes.open(&result.crust);
    let report = judged(&opened);
    assert!(report.is_bordered(), "{:?}", report.findings.first());
    assert_eq!(opened.loops.len(), 1);
    near(
        opened.loops[0].length,
        2.0 * PI * (1.0f64 - 0.16).sqrt(),
        0.03,
    );
    near(report.area, 2.0 * PI * 0.6, 0.03);
}

/// Two faces of an octahedron that meet in a vertex only are left out.
#[test]
fn fans_at_a_vertex_come_apart() {
    let mut mesh = PolygonMesh::with_vertices(vec![
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ]);
    for k in 0..4 {
        mesh.push_face(&[k, (k + 1) % 4, 4]);
        mesh.push_face(&[(k + 1) % 4, k, 5]);
    }
    let crust = Crust {
        vertex_samples: (0..6).collect(),
        face_balls: vec![[0, 1]; 8],
        mesh,
    };
    let mut patch_of_face = vec![NONE; 8];
    patch_of_face[0] = 0;
    patch_of_face[4] = 1;
    let patch = Patch {
        width: 1.0,
        spacings: 10.0,
        area: 1.0,
        faces: 1,
        centre: [0.0; 3],
    };
    let holes = Holes {
        patches: vec![patch.clone(), patch],
        patch_of_face,
        share: 0.25,
    };
    let opened = holes.open(&crust);
    assert_eq!(opened.crust.mesh.vertices.len(), 7);
    assert_eq!(opened.selection.vertices, [0, 1, 2, 3, 4, 4, 5]);
    let report = judged(&opened);
    assert_eq!(report.counts.pinched_vertex, 0);
    assert_eq!(report.counts.open_edge, 6);
    assert!(report.is_bordered(), "{:?}", report.findings);
    // One loop, which passes the top twice.
    assert_eq!(opened.loops.len(), 1);
    assert_eq!((opened.loops[0].edges, opened.loops[0].patch), (6, 0));
}
