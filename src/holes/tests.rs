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
