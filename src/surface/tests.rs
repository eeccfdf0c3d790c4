//! Clean-up and triangulation of hand-made and of random raw crusts.

use super::check::check;
use super::raw::{Crust, RawCrust, NONE};
use super::{clean, triangulate, CleanOptions};
use crate::geom::Point;
use std::collections::BTreeMap;

/// splitmix64.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % n as u64) as usize
    }

    fn real(&mut self) -> f64 {
        self.below(1 << 40) as f64 / (1u64 << 40) as f64
    }
}

/// A raw crust of faces by vertex index; twins by directed edge.
fn raw(positions: &[Point], samples: &[u32], faces: &[Vec<u32>]) -> RawCrust {
    let mut crust = RawCrust {
        positions: positions.to_vec(),
        samples: samples.to_vec(),
        ..RawCrust::default()
    };
    let mut by_ends = BTreeMap::new();
    for (f, face) in faces.iter().enumerate() {
        let first = crust.corners.len() as u32;
        for (k, &v) in face.iter().enumerate() {
            let c = crust.corners.len() as u32;
            let old = by_ends.insert((v, face[(k + 1) % face.len()]), c);
            assert_eq!(old, None, "the input is no manifold");
            crust.corners.push(v);
            crust.next.push(first + (k as u32 + 1) % face.len() as u32);
            crust.balls.push([f as u32, 1000 + f as u32]);
        }
    }
    crust.twins = vec![NONE; crust.corners.len()];
    for (&(a, b), &c) in &by_ends {
        crust.twins[c as usize] = by_ends[&(b, a)];
    }
    crust
}

fn exact() -> CleanOptions {
    CleanOptions::default()
}

/// Cleans, checks, triangulates, checks.
fn both(raw: RawCrust, options: &CleanOptions) -> (Crust, Crust) {
    let polygons = clean(raw, options);
    assert_eq!(check(&polygons), []);
    let triangles = triangulate(&polygons);
    assert_eq!(check(&triangles), []);
    assert!(triangles.mesh.faces().all(|face| face.len() == 3));
    (polygons, triangles)
}

fn euler(crust: &Crust) -> i64 {
    let mesh = &crust.mesh;
    mesh.vertices.len() as i64 - mesh.corners.len() as i64 / 2 + mesh.face_count() as i64
}

const CUBE: [[u32; 4]; 6] = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
];

fn corner(k: u32) -> Point {
    [0, 1, 2].map(|axis| f64::from(k >> axis & 1))
}

fn cube() -> (Vec<Point>, Vec<Vec<u32>>) {
    let faces = CUBE.iter().map(|f| f.to_vec()).collect();
    ((0..8).map(corner).collect(), faces)
}

#[test]
fn a_cube_stays_a_cube() {
    let (positions, faces) = cube();
    let (polygons, triangles) = both(raw(&positions, &[NONE; 8], &faces), &exact());
    assert_eq!(polygons.mesh.face_count(), 6);
    assert_eq!(polygons.mesh.vertices.len(), 8);
    assert_eq!(triangles.mesh.face_count(), 12);
    assert_eq!(triangles.mesh.volume(), 1.0);
}

/// Each corner of the cube replaced by a triangle, all at the corner.
#[test]
fn split_corners_are_contracted() {
    let (_, cube_faces) = cube();
    let id = |v: u32, toward: u32| v * 3 + (v ^ toward).trailing_zeros();
    let mut faces: Vec<Vec<u32>> = Vec::new();
    for face in &cube_faces {
        let mut big = Vec::new();
        for k in 0..4 {
            big.extend([
                id(face[k], face[(k + 3) % 4]),
                id(face[k], face[(k + 1) % 4]),
            ]);
        }
        faces.push(big);
    }
    for v in 0..8u32 {
        let odd = v.count_ones() % 2 == 1;
        let [a, b, c] = [v * 3, v * 3 + 1, v * 3 + 2];
        faces.push(if odd { vec![a, b, c] } else { vec![a, c, b] });
    }
    let positions: Vec<Point> = (0..24).map(|v| corner(v / 3)).collect();
    for known in [true, false] {
        let samples: Vec<u32> = (0..24)
            .map(|v| if known { v / 3 + 5 } else { NONE })
            .collect();
        let (polygons, _) = both(raw(&positions, &samples, &faces), &exact());
        assert_eq!(polygons.mesh.face_count(), 6);
        assert_eq!(polygons.mesh.vertices.len(), 8);
        assert_eq!(polygons.mesh.volume(), 1.0);
        assert_eq!(polygons.vertex_samples[0] != NONE, known);
        assert_eq!(polygons.face_balls[5], [5, 1005]);
    }
}

fn torus(m: usize, n: usize) -> (Vec<Point>, Vec<Vec<u32>>) {
    let id = |i: usize, j: usize| ((i % m) * n + j % n) as u32;
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for i in 0..m {
        for j in 0..n {
            let turn = std::f64::consts::TAU;
            let (a, b) = (i as f64 * turn / m as f64, j as f64 * turn / n as f64);
            let r = 3.0 + b.cos();
            positions.push([r * a.cos(), r * a.sin(), b.sin()]);
            faces.push(vec![id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)]);
        }
    }
    (positions, faces)
}

#[test]
fn a_ring_at_one_sample_pinches_a_torus() {
    let (mut positions, faces) = torus(8, 6);
    let mut samples = vec![NONE; 48];
    for v in 0..6 {
        positions[v] = [3.0, 0.0, 0.0];
        samples[v] = 7;
    }
    let (polygons, _) = both(raw(&positions, &samples, &faces), &exact());
    assert_eq!(euler(&polygons), 2);
    let two = polygons.vertex_samples.iter().filter(|&&s| s == 7).count();
    assert_eq!(two, 2);
    let options = CleanOptions {
        gap: 1e-6,
        ..exact()
    };
    let (apart, _) = both(raw(&positions, &samples, &faces), &options);
    let at = |c: &Crust| {
        let at = c.mesh.vertices.iter().filter(|&&p| p == [3.0, 0.0, 0.0]);
        at.count()
    };
    assert_eq!((at(&polygons), at(&apart)), (2, 1));
}

#[test]
fn solids_that_touch_stay_apart() {
    // Two tetrahedra that share a sample, then an edge between samples.
    let tetrahedron = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mut faces: Vec<Vec<u32>> = tetrahedron.iter().map(|f| f.to_vec()).collect();
    faces.extend(
        tetrahedron
            .iter()
            .map(|f| vec![f[0] + 4, f[2] + 4, f[1] + 4]),
    );
    let a = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for shared in [1, 2] {
        let mut positions = a.to_vec();
        positions.extend(a.map(|p| p.map(|x| -x)));
        let mut samples: Vec<u32> = (0..8).collect();
        for v in 0..shared {
            positions[v + 4] = positions[v];
            samples[v + 4] = samples[v];
        }
        let (polygons, _) = both(raw(&positions, &samples, &faces), &exact());
        assert_eq!(polygons.mesh.vertices.len(), 8);
        assert_eq!(euler(&polygons), 4);
    }
}

#[test]
fn a_pillow_vanishes() {
    let (mut positions, faces) = cube();
    for v in 4..8 {
        positions[v] = positions[v - 4];
    }
    let empty = clean(raw(&positions, &[NONE; 8], &faces), &exact());
    assert_eq!(empty.mesh.face_count(), 0);
    assert_eq!(empty.mesh.vertices.len(), 0);
    assert_eq!(triangulate(&empty).mesh.face_count(), 0);
}

/// A block whose top has a T-joint closed by a triangle on a line.
#[test]
fn a_face_on_a_line_is_sewn_up() {
    let (mut positions, mut faces) = cube();
    positions.push([0.5, 0.0, 0.0]);
    faces[2] = vec![0, 8, 1, 5, 4];
    faces.push(vec![0, 1, 8]);
    let (polygons, triangles) = both(raw(&positions, &[NONE; 9], &faces), &exact());
    assert_eq!(polygons.mesh.face_count(), 6);
    assert_eq!(triangles.mesh.face_count(), 14);
    assert_eq!(triangles.mesh.volume(), 1.0);
    // Nearly on a line: only with a tolerance.
    positions[8][2] = 1e-9;
    let near = raw(&positions, &[NONE; 9], &faces);
    assert_eq!(both(near.clone(), &exact()).0.mesh.face_count(), 7);
    let options = CleanOptions {
        tolerance: 1e-8,
        ..exact()
    };
    assert_eq!(both(near, &options).0.mesh.face_count(), 6);
}

#[test]
fn a_short_edge_is_contracted_with_a_tolerance() {
    let (mut positions, mut faces) = cube();
    positions.push([1e-9, 0.0, 0.0]);
    faces[0] = vec![0, 2, 3, 1, 8];
    faces[2] = vec![0, 8, 1, 5, 4];
    let near = raw(&positions, &[NONE; 9], &faces);
    assert_eq!(both(near.clone(), &exact()).0.mesh.vertices.len(), 9);
    let options = CleanOptions {
        tolerance: 1e-8,
        ..exact()
    };
    let (polygons, _) = both(near, &options);
    assert_eq!(polygons.mesh.vertices.len(), 8);
    assert_eq!(polygons.mesh.volume(), 1.0);
}

/// Like a power crust: the dual of a triangulation, here of a torus with
/// random flips; so every vertex has three faces.
fn random_dual(random: &mut Random) -> (usize, Vec<Vec<u32>>) {
    let (_, quads) = torus(3 + random.below(4), 3 + random.below(4));
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for q in &quads {
        if random.below(2) == 0 {
            triangles.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
        } else {
            triangles.extend([[q[0], q[1], q[3]], [q[1], q[2], q[3]]]);
        }
    }
    let by_ends = |triangles: &[[u32; 3]]| {
        let mut map = BTreeMap::new();
        for (t, tri) in triangles.iter().enumerate() {
            for k in 0..3 {
                map.insert((tri[k], tri[(k + 1) % 3]), (t, tri[(k + 2) % 3]));
            }
        }
        map
    };
    let mut map = by_ends(&triangles);
    for _ in 0..random.below(3 * quads.len()) {
        let (t, k) = (random.below(triangles.len()), random.below(3));
        let (u, v) = (triangles[t][k], triangles[t][(k + 1) % 3]);
        let ((_, w), (s, x)) = (map[&(u, v)], map[&(v, u)]);
        if w != x && !map.contains_key(&(w, x)) {
            triangles[t] = [u, x, w];
            triangles[s] = [x, v, w];
            map = by_ends(&triangles);
        }
    }
    // Dual: triangles become vertices, vertices become faces.
    let mut faces = Vec::new();
    let mut done = BTreeMap::new();
    for &(v, first) in map.keys() {
        if done.insert(v, ()).is_some() {
            continue;
        }
        let (mut face, mut w) = (Vec::new(), first);
        loop {
            let (t, third) = map[&(v, w)];
            face.push(t as u32);
            w = third;
            if w == first {
                break;
            }
        }
        faces.push(face);
    }
    (triangles.len(), faces)
}

/// Gives random groups of vertices, connected or not, one sample each.
fn group(random: &mut Random, faces: &[Vec<u32>], positions: &mut [Point], samples: &mut [u32]) {
    let n = positions.len();
    for sample in 0..random.below(6) as u32 {
        let mut members = vec![random.below(n) as u32];
        for _ in 0..random.below(12) {
            if random.below(4) == 0 {
                members.push(random.below(n) as u32);
                continue;
            }
            let from = members[random.below(members.len())];
            let near: Vec<u32> = faces
                .iter()
                .filter_map(|f| {
                    f.iter()
                        .position(|&v| v == from)
                        .map(|k| f[(k + 1) % f.len()])
                })
                .collect();
            members.push(near[random.below(near.len())]);
        }
        let place = [random.real(), random.real(), random.real()];
        for v in members {
            positions[v as usize] = place;
            samples[v as usize] = sample;
        }
    }
}

#[test]
fn random_crusts_come_out_closed_and_manifold() {
    for seed in 0..4000 {
        let mut random = Random(seed);
        let (n, faces) = random_dual(&mut random);
        // A coarse grid makes for coincidences, lines and planes.
        let grid = [0, 2, 3, 5, 9, 1000][random.below(6)];
        let mut positions: Vec<Point> = (0..n)
            .map(|_| {
                [(); 3].map(|()| match grid {
                    0 => random.real(),
                    g => random.below(g) as f64,
                })
            })
            .collect();
        let mut samples = vec![NONE; n];
        group(&mut random, &faces, &mut positions, &mut samples);
        let crust = raw(&positions, &samples, &faces);
        let tolerance = [0.0, 0.0, 0.01, 0.3, 1.0][random.below(5)];
        let gap = [0.0, 1e-6][random.below(2)];
        let options = CleanOptions { tolerance, gap };
        let polygons = clean(crust.clone(), &options);
        assert_eq!(check(&polygons), [], "clean, seed {seed}");
        assert_eq!(
            check(&triangulate(&polygons)),
            [],
            "triangulate, seed {seed}"
        );
    }
}
