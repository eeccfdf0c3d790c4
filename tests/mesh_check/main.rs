//! The mesh checker against hand-made meshes (here), oracles (`pairs.rs`), and public meshes whose facts
//! are known (`public.rs`).

mod pairs;
mod public;

use powercrust::context::{Progress, Stage};
use powercrust::mesh::{
    check, component_volumes, components, CheckOptions, Counts, Finding, PolygonMesh, Report,
    Surface,
};
use powercrust::{Cancelled, Context, Point};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

fn mesh(points: &[[i32; 3]], faces: &[&[u32]]) -> PolygonMesh {
    let mut mesh = PolygonMesh::with_vertices(points.iter().map(|p| p.map(f64::from)).collect());
    faces.iter().for_each(|f| mesh.push_face(f));
    mesh
}

fn judge(mesh: &PolygonMesh) -> Report {
    check(mesh, &CheckOptions::default(), &Context::default()).unwrap()
}

const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
const CORNER: [[i32; 3]; 4] = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
const CUBE: [[u32; 4]; 6] = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
];

fn tetrahedron() -> PolygonMesh {
    mesh(&CORNER, &TETRAHEDRON.each_ref().map(|f| &f[..]))
}

/// A cube of the given size with its least corner at `at`.
fn cube(at: i32, size: i32) -> PolygonMesh {
    let corner = |k: i32| [k & 1, k >> 1 & 1, k >> 2].map(|b| at + b * size);
    let points: Vec<_> = (0..8).map(corner).collect();
    mesh(&points, &CUBE.each_ref().map(|f| &f[..]))
}

fn flipped(mesh: &PolygonMesh) -> PolygonMesh {
    let mut flipped = PolygonMesh::with_vertices(mesh.vertices.clone());
    for face in mesh.faces() {
        flipped.push_face(&face.iter().rev().copied().collect::<Vec<_>>());
    }
    flipped
}

/// Both meshes in one.
fn join(a: &PolygonMesh, b: &PolygonMesh) -> PolygonMesh {
    let mut both = a.clone();
    let shift = a.vertices.len() as u32;
    both.vertices.extend_from_slice(&b.vertices);
    for face in b.faces() {
        both.push_face(&face.iter().map(|v| v + shift).collect::<Vec<_>>());
    }
    both
}

#[test]
fn tetrahedron_and_cube_are_watertight() {
    let report = judge(&tetrahedron());
    assert!(report.is_watertight() && report.is_embedded());
    assert_eq!(report.counts, Counts::default());
    assert_eq!((report.edges, report.euler, report.genus), (6, 2, Some(0)));
    assert!((report.volume - 1.0 / 6.0).abs() < 1e-15);
    let report = judge(&cube(0, 2));
    assert!(report.is_embedded() && report.findings.is_empty());
    assert_eq!((report.triangles, report.edges), (12, 12));
    assert_eq!((report.volume, report.area), (8.0, 24.0));
    assert_eq!(report.smallest_angle, Some(45.0));
    assert_eq!(report.aspects[0], 12);
    assert_eq!(report.bounds.unwrap().max, [2.0; 3]);
}

#[test]
fn open_mesh() {
    let mut open = tetrahedron();
    open.starts.pop();
    open.corners.truncate(9);
    let report = judge(&open);
    assert!(!report.is_closed());
    assert_eq!(report.counts.open_edge, 3);
    assert_eq!(report.shells[0].loops, 1);
    assert_eq!(report.genus, Some(0));
}

#[test]
fn inside_out_and_cavity() {
    let report = judge(&flipped(&cube(0, 1)));
    assert!(report.is_closed() && !report.is_watertight());
    assert_eq!(report.findings, [Finding::InsideOut { shell: 0 }]);
    let hollow = join(&cube(0, 3), &flipped(&cube(1, 1)));
    let report = judge(&hollow);
    assert!(report.is_embedded());
    assert_eq!((report.volume, report.cavities), (26.0, 1));
    assert_eq!(component_volumes(&hollow), [27.0, -1.0]);
    assert_eq!(components(&hollow).1, 2);
}

#[test]
fn shells_must_face_the_way_their_nesting_asks() {
    // A second solid inside the first one, and a wall of a cavity outside.
    for wrong in [
        join(&cube(0, 3), &cube(1, 1)),
        join(&cube(0, 3), &flipped(&cube(5, 1))),
    ] {
        let report = judge(&wrong);
        assert_eq!(report.findings, [Finding::InsideOut { shell: 1 }]);
    }
    // A solid in a cavity of a solid, and one beside it.
    let island = join(&cube(0, 5), &flipped(&cube(1, 3)));
    let island = join(&join(&island, &cube(2, 1)), &cube(6, 1));
    assert!(judge(&island).is_embedded());
}

#[test]
fn tetrahedra_that_share_a_vertex() {
    let points = [CORNER.as_slice(), &[[-1, 0, 0], [0, -1, 0], [0, 0, -1]]].concat();
    let other: [[u32; 3]; 4] = [[0, 4, 5], [0, 6, 4], [4, 6, 5], [5, 6, 0]];
    let faces: Vec<&[u32]> = TETRAHEDRON.iter().chain(&other).map(|f| &f[..]).collect();
    let report = judge(&mesh(&points, &faces));
    assert!(report.is_closed() && !report.is_watertight());
    assert_eq!(
        report.findings,
        [Finding::PinchedVertex { vertex: 0, fans: 2 }]
    );
    assert_eq!((report.components, report.shells.len()), (1, 2));
    assert_eq!(report.genus, Some(0));
    // The same with the vertex split: a legal pinch.
    let mut split = mesh(&points, &faces);
    split.vertices.push([0.0; 3]);
    for v in &mut split.corners[12..] {
        *v = if *v == 0 { 7 } else { *v };
    }
    let report = judge(&split);
    assert!(report.is_watertight() && !report.is_embedded());
    assert_eq!(report.duplicate_positions, 1);
    assert_eq!(report.counts.coincident, 9);
    assert_eq!(report.components, 2);
}

#[test]
fn tetrahedra_that_share_an_edge() {
    let points = [CORNER.as_slice(), &[[-1, -1, 0], [-1, 1, -1]]].concat();
    let other: [[u32; 3]; 4] = [[0, 4, 3], [0, 3, 5], [3, 4, 5], [4, 0, 5]];
    let faces: Vec<&[u32]> = TETRAHEDRON.iter().chain(&other).map(|f| &f[..]).collect();
    let report = judge(&mesh(&points, &faces));
    assert_eq!(report.counts.non_manifold_edge, 1);
    assert_eq!(report.counts.crossing + report.counts.touching, 0);
    let Finding::NonManifoldEdge { edge, faces } = &report.findings[0] else {
        panic!("{:?}", report.findings);
    };
    assert_eq!((*edge, faces.len()), ([0, 3], 4));
    assert!(!report.is_closed());
    assert_eq!(report.genus, None);
}

#[test]
fn faults_of_single_faces() {
    let mut bad = tetrahedron();
    bad.vertices.push([f64::NAN, 0.0, 0.0]);
    bad.push_face(&[0, 9, 1]);
    bad.push_face(&[0, 1]);
    bad.push_face(&[0, 1, 1]);
    bad.push_face(&[1, 0, 2]);
    let report = judge(&bad);
    let expected = [
        Finding::IndexOutOfRange { face: 4 },
        Finding::FaceTooSmall { face: 5 },
        Finding::NotFinite { vertex: 4 },
        Finding::RepeatedVertex { face: 6, vertex: 1 },
        Finding::UnusedVertex { vertex: 4 },
        Finding::ZeroArea { face: 6 },
        Finding::DuplicateFace { a: 0, b: 7 },
    ];
    for finding in expected {
        assert!(report.findings.contains(&finding), "{finding:?}");
    }
    assert!(!report.is_closed());
}

#[test]
fn neighbours_that_fold_over_each_other() {
    let points = [[0, 0, 0], [2, 0, 0], [1, 2, 0], [1, 1, 0], [1, -1, 0]];
    let report = judge(&mesh(&points, &[&[0, 1, 2], &[1, 0, 3]]));
    assert!(report.findings.contains(&Finding::Crossing { a: 0, b: 1 }));
    let report = judge(&mesh(&points, &[&[0, 1, 2], &[1, 0, 4]]));
    assert_eq!(report.counts.crossing + report.counts.touching, 0);
    // Two faces with the same corners cross as well as being doubles.
    let report = judge(&mesh(&points, &[&[0, 1, 2], &[2, 1, 0]]));
    assert_eq!(
        (report.counts.crossing, report.counts.duplicate_face),
        (1, 1)
    );
}

#[test]
fn misoriented_pair() {
    let points = [[0, 0, 0], [2, 0, 0], [1, 2, 0], [1, -1, 0]];
    let report = judge(&mesh(&points, &[&[0, 1, 2], &[0, 1, 3]]));
    assert!(report.findings.contains(&Finding::MisorientedEdge {
        edge: [0, 1],
        faces: [0, 1]
    }));
    assert_eq!(report.counts.open_edge, 4);
}

#[test]
fn nothing_panics_on_broken_arrays() {
    let good = tetrahedron();
    let broken = |f: &dyn Fn(&mut PolygonMesh)| {
        let mut mesh = good.clone();
        f(&mut mesh);
        let report = judge(&mesh);
        components(&mesh);
        component_volumes(&mesh);
        Surface::new(&mesh).distance([0.5; 3]);
        serde_json::to_string(&report).unwrap();
        assert!(!report.is_watertight());
    };
    broken(&|m| *m = PolygonMesh::default());
    broken(&|m| *m = PolygonMesh::with_vertices(vec![[0.0; 3]]));
    broken(&|m| m.starts[2] = 99);
    broken(&|m| m.starts[1] = u32::MAX);
    broken(&|m| m.starts.reverse());
    broken(&|m| m.corners.clear());
    broken(&|m| m.corners.fill(0));
    broken(&|m| m.corners[3] = u32::MAX);
    broken(&|m| m.vertices.clear());
    broken(&|m| m.vertices[1] = [f64::INFINITY, f64::NAN, -0.0]);
    broken(&|m| m.vertices.fill([f64::MAX; 3]));
    broken(&|m| m.vertices[3] = [f64::MAX, -f64::MAX, -f64::MIN_POSITIVE]);
}

#[test]
fn the_whole_range_of_doubles_is_exact() {
    // The unit tetrahedra overlap by one last bit, or touch, or are apart,
    // at any scale; the smallest coordinate may be far below the largest.
    for scale in [1.0, 2f64.powi(900), 2f64.powi(-900)] {
        for tiny in [0.0, scale * 2f64.powi(-52), scale * 1e-120] {
            for (gap, crosses) in [(-1.0, true), (1.0, false)] {
                let mut a = tetrahedron();
                a.vertices.iter_mut().flatten().for_each(|x| *x *= scale);
                let mut b = flipped(&a);
                for p in &mut b.vertices {
                    p[2] = -p[2] - gap * tiny;
                }
                let report = judge(&join(&a, &b));
                let c = report.counts;
                let moved = tiny > 0.0 && a.vertices[3][2] + tiny > tiny;
                let expected = match (moved, crosses) {
                    (false, _) => (true, false, true),
                    (true, true) => (true, false, false),
                    (true, false) => (false, false, false),
                };
                let found = (c.crossing > 0, c.touching > 0 && c.crossing == 0, {
                    report.duplicate_positions == 3
                });
                assert_eq!(found, expected, "{scale:e} {tiny:e} {gap}");
            }
        }
    }
}

#[test]
fn rounding_to_single_precision_is_judged_on_demand() {
    let mut thin = tetrahedron();
    thin.vertices[3] = [0.25, 0.25, 1e-50];
    assert!(judge(&thin).is_watertight());
    let options = CheckOptions {
        f32: true,
        ..CheckOptions::default()
    };
    let report = check(&thin, &options, &Context::default()).unwrap();
    assert_eq!(report.volume, 0.0);
    assert!(report.counts.crossing > 0 && !report.is_watertight());
}

#[test]
fn polygons_that_are_not_convex_are_no_fault() {
    // An L-shaped prism; a fan from its first corner would leave the L.
    let outline = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]];
    for turn in 0..6 {
        let at = |k: usize| outline[(k + turn) % 6];
        let points: Vec<[i32; 3]> = (0..12)
            .map(|k| [at(k % 6)[0], at(k % 6)[1], (k / 6) as i32])
            .collect();
        let mut prism = mesh(&points, &[&[5, 4, 3, 2, 1, 0], &[6, 7, 8, 9, 10, 11]]);
        for k in 0..6 {
            let next = (k + 1) % 6;
            prism.push_face(&[k, next, next + 6, k + 6]);
        }
        let report = judge(&prism);
        assert!(report.is_embedded(), "{turn}: {:?}", report.findings);
        assert!((report.volume - 3.0).abs() < 1e-14);
        assert!((report.area - 14.0).abs() < 1e-14);
    }
}

/// Stops after a number of calls.
struct Stop(std::sync::atomic::AtomicU64);

impl Progress for Stop {
    fn advance(&self, stage: Stage, _: u64, _: u64) -> ControlFlow<()> {
        assert_eq!(stage, Stage::Check);
        match self.0.fetch_sub(1, std::sync::atomic::Ordering::Relaxed) {
            0 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    }
}

#[test]
fn cancelling_stops_the_check() {
    let sphere = wavy_sphere(40, 0.0);
    for calls in [0, 2, 5] {
        let stop = Stop(calls.into());
        let cx = Context {
            progress: &stop,
            threads: NonZeroUsize::new(1),
        };
        let report = check(&sphere, &CheckOptions::default(), &cx);
        assert_eq!(report.err(), Some(Cancelled));
    }
}

/// A sphere of `2 n (n - 1)` triangles, its radius disturbed by up to `wave`.
fn wavy_sphere(n: u32, wave: f64) -> PolygonMesh {
    let mut random = Random(12345);
    let mut mesh = PolygonMesh::with_vertices(vec![[0.0, 0.0, -1.0]]);
    for i in 1..n {
        let latitude = std::f64::consts::PI * f64::from(i) / f64::from(n);
        for j in 0..n {
            let longitude = std::f64::consts::TAU * f64::from(j) / f64::from(n);
            let r = 1.0 + wave * (random.next() % 1000) as f64 / 1000.0;
            let (s, c) = latitude.sin_cos();
            mesh.vertices
                .push([r * s * longitude.cos(), r * s * longitude.sin(), r * -c]);
        }
    }
    mesh.vertices.push([0.0, 0.0, 1.0]);
    let last = mesh.vertices.len() as u32 - 1;
    let at = |i: u32, j: u32| 1 + (i - 1) * n + j % n;
    for j in 0..n {
        mesh.push_face(&[0, at(1, j + 1), at(1, j)]);
        for i in 1..n - 1 {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            mesh.push_face(&[a, b, c]);
            mesh.push_face(&[a, c, d]);
        }
        mesh.push_face(&[last, at(n - 1, j), at(n - 1, j + 1)]);
    }
    mesh
}

#[test]
fn reports_do_not_depend_on_threads() {
    let mut waves = wavy_sphere(60, 0.2);
    waves.vertices.iter_mut().flatten().for_each(|x| *x *= 0.9);
    let mesh = join(&wavy_sphere(60, 0.0), &waves);
    let options = CheckOptions {
        max_findings: 50,
        ..CheckOptions::default()
    };
    let with = |n: usize| {
        let cx = Context {
            threads: NonZeroUsize::new(n),
            ..Context::default()
        };
        check(&mesh, &options, &cx).unwrap()
    };
    let report = with(1);
    assert!(report.counts.crossing > 100);
    assert!(report.findings.len() >= 50);
    assert_eq!(report, with(2));
    assert_eq!(report, with(3));
}

struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
}

/// Found by `scripts/guarantee`: in floating point the volume of a shell that
/// is thin or tiny drowns in rounding, and its sign with it.
#[test]
fn thin_shells_are_told_from_shells_inside_out() {
    let ulp = 2f64.powi(-52);
    for n in 0..60 {
        let at = |k: i32| 1.0 + f64::from(n * 7919 % 61) / 61.0 / f64::from(k);
        // One unit in the last place thick, and flat but for rounding.
        let a = [at(1), at(2), at(3)];
        let b = [at(4), at(5) + 0.25, at(6)];
        let c = [at(7), at(8), at(9) + 0.25];
        let mid: Point = std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0);
        let mut points = vec![
            a,
            b,
            c,
            [mid[0] + ulp * f64::from(n % 5 - 2), mid[1], mid[2]],
        ];
        points.extend(CORNER.map(|p| p.map(|x| f64::from(x) * 1e-17 - 3.0 * f64::from(x))));
        let sign = exact_orientation([points[0], points[1], points[2], points[3]]);
        let mut thin = PolygonMesh::with_vertices(points);
        TETRAHEDRON.iter().for_each(|f| thin.push_face(f));
        TETRAHEDRON
            .iter()
            .for_each(|f| thin.push_face(&f.map(|v| v + 4)));
        let volumes = component_volumes(&thin);
        assert_eq!(sign, volumes[0].partial_cmp(&0.0).unwrap() as i128, "{n}");
    }
}

/// The sign of the volume of a tetrahedron whose coordinates are multiples of
/// 2^-52 below 4, its faces as in [`TETRAHEDRON`].
fn exact_orientation(points: [Point; 4]) -> i128 {
    let whole = points.map(|p| p.map(|x| (x * 2f64.powi(52)) as i128));
    let [u, v, w] = [1, 2, 3].map(|k| [0, 1, 2].map(|i| whole[k][i] - whole[0][i]));
    // Differences have 55 bits: split, so that no product overflows.
    let minors = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| u[i] * v[j] - u[j] * v[i]);
    let (mut high, mut low) = (0, 0);
    for (m, x) in minors.into_iter().zip(w) {
        high += (m >> 60) * x;
        low += (m & ((1 << 60) - 1)) * x;
    }
    let whole = high + (low >> 60);
    let rest = low & ((1 << 60) - 1);
    if whole == 0 {
        i128::from(rest != 0)
    } else {
        whole.signum()
    }
}

/// Found by fuzzing: volumes out of the range of doubles were 0 or NaN, and
/// sound meshes were judged inside out.
#[test]
fn volumes_out_of_range_keep_their_sign() {
    let cavity = join(&cube(0, 9), &flipped(&cube(3, 3)));
    for (scale, judged) in [
        (1e-322, 0.0),
        (1e-300, 0.0),
        (1.0, 702.0),
        (1e120, f64::MAX),
        (1e306, f64::MAX),
    ] {
        let mut scaled = cavity.clone();
        for x in scaled.vertices.iter_mut().flatten() {
            *x *= scale;
        }
        let report = judge(&scaled);
        assert!(report.is_embedded() && report.cavities == 1, "{scale}");
        assert!(
            (report.volume - judged).abs() <= 1e-300 && report.volume > 0.0,
            "{scale}"
        );
        assert_eq!(report.smallest_angle.map(f64::round), Some(45.0));
        let volumes = component_volumes(&scaled);
        assert!(volumes[0] > 0.0 && volumes[1] < 0.0, "{scale}");
        let report = judge(&flipped(&scaled));
        assert!(!report.is_watertight() && report.volume < 0.0, "{scale}");
    }
}
