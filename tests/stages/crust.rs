//! The raw crust and the power shape, for the labels found and for any.

use crate::common::random::Random;
use crate::common::shapes::{self, Shape};
use crate::run::{position, Run};
use powercrust::geom::vec3::{cross, dist_sq, dot};
use powercrust::surface::{power_shape, PowerShape, RawCrust, NONE};
use powercrust::{Point, Side};
use std::collections::BTreeSet;

fn clouds() -> Vec<(&'static str, Vec<Point>)> {
    let grid = (0..216).map(|n| [n % 6, n / 6 % 6, n / 36].map(f64::from));
    vec![
        ("torus", shapes::TORUS.samples(1_500, 61)),
        ("sphere", shapes::UNIT_SPHERE.samples(800, 62)),
        ("block", shapes::CAD_BLOCK.samples(800, 63)),
        ("grid", grid.collect()),
    ]
}

/// The labels found, all inner, none inner, and random ones.
fn labellings(run: &Run, seed: u64) -> Vec<Vec<Side>> {
    let mut random = Random::new(seed);
    let n = run.balls.len();
    let mut all = vec![
        run.labels.sides.clone(),
        vec![Side::Inner; n],
        vec![Side::Outer; n],
    ];
    for share in [0.1, 0.5, 0.9] {
        let side = |inner| if inner { Side::Inner } else { Side::Outer };
        all.push((0..n).map(|_| side(random.unit() < share)).collect());
    }
    all
}

/// Vertices - edges + faces of the crust, all components together.
fn euler(raw: &RawCrust) -> i64 {
    let sizes = [
        raw.positions.len(),
        raw.corners.len() / 2,
        raw.faces().len(),
    ];
    let [v, e, f] = sizes.map(|n| n as i64);
    v - e + f
}

/// Successors are a permutation and twins an involution; twins run the other
/// way and lie on different faces, which share one of their balls.
#[track_caller]
fn assert_law(name: &str, raw: &RawCrust) {
    let n = raw.next.len();
    for table in [raw.twins.len(), raw.corners.len(), raw.balls.len()] {
        assert_eq!(table, n, "{name}");
    }
    assert_eq!(raw.samples.len(), raw.positions.len(), "{name}");
    let mut followed = vec![false; n];
    for h in 0..n {
        let (next, t) = (raw.next[h] as usize, raw.twins[h] as usize);
        assert!(!std::mem::replace(&mut followed[next], true), "{name}");
        assert_eq!(raw.balls[next], raw.balls[h], "{name}: {h}");
        assert!(t != h && raw.twins[t] as usize == h, "{name}: {h}");
        let (tail, head) = (raw.corners[h], raw.corners[next]);
        assert!(tail != head, "{name}: {h} has no length");
        assert_eq!(raw.corners[t], head, "{name}: twin of {h}");
        assert_eq!(raw.corners[raw.next[t] as usize], tail, "{name}: {h}");
        let [a, b] = [raw.balls[h], raw.balls[t]];
        assert!((a[0] == b[0]) != (a[1] == b[1]), "{name}: {a:?} {b:?}");
    }
}

/// A closed 2-manifold, whatever the labels: the crust with all power
/// vertices apart.
#[track_caller]
pub fn assert_closed(name: &str, run: &Run, sides: &[Side], raw: &RawCrust) {
    assert_law(name, raw);
    let n = raw.next.len();
    let mut corners_at = vec![0u32; raw.positions.len()];
    for &v in &raw.corners {
        corners_at[v as usize] += 1;
    }
    let faces = raw.faces();
    for face in &faces {
        assert!(face.len() >= 3, "{name}: a face of {} corners", face.len());
    }
    // Each vertex has one fan: going round from one corner meets all.
    let mut seen = vec![false; n];
    let mut fans = vec![0; raw.positions.len()];
    for start in 0..n {
        if seen[start] {
            continue;
        }
        fans[raw.corners[start] as usize] += 1;
        let mut at = start;
        while !seen[at] {
            seen[at] = true;
            at = raw.next[raw.twins[at] as usize] as usize;
        }
    }
    assert!(fans.iter().all(|&f| f == 1), "{name}: pinched");
    assert!(corners_at.iter().all(|&c| c == 3 || c == 4), "{name}");

    // The faces are the edges between unlike balls, each once.
    let side = |v: u32| match run.power.is_sentinel(v) {
        true => Side::Outer,
        false => sides[v as usize],
    };
    let mut wanted = BTreeSet::new();
    for cell in &run.power.complex.cells {
        for &a in cell {
            for &b in cell {
                if (side(a), side(b)) == (Side::Inner, Side::Outer) {
                    wanted.insert([a, b]);
                }
            }
        }
    }
    let got: BTreeSet<[u32; 2]> = raw.balls.iter().copied().collect();
    assert_eq!(got.len(), faces.len(), "{name}: a face twice");
    assert!(
        got == wanted,
        "{name}: {} faces of {}",
        got.len(),
        wanted.len()
    );
}

#[test]
fn the_raw_crust_is_a_closed_manifold_whatever_the_labels() {
    for (name, points) in clouds() {
        for merge in [0.0, 0.5] {
            let run = Run::of(&points, merge);
            for (k, sides) in labellings(&run, 64).iter().enumerate() {
                let name = format!("{name}, merge {merge}, labels {k}");
                let raw = run.apart(sides);
                assert_closed(&name, &run, sides, &raw);
                assert_law(&name, &run.raw(sides));
                // The surface of the solid of inner cells, to which the inner
                // shape is dual: twice its Euler number.
                let shape = power_shape(&run.power, &run.balls, sides, Side::Inner);
                assert_eq!(euler(&raw), 2 * shape_euler(&shape), "{name}");
            }
        }
    }
}

/// Fact F2: vertices whose four balls touch a sample lie at it, bit for bit,
/// and are one.
/// A sample that four balls or more touch, of both sides, is nearly always
/// one; with fewer it lies within a face or an edge.
#[test]
fn the_crust_passes_through_the_samples() {
    // On a sphere inner poles crowd about the centre: merging first.
    for ((name, points), merge) in clouds().into_iter().zip([0.0, 0.5, 0.0, 0.0]) {
        let run = Run::of(&points, merge);
        let raw = run.raw(&run.labels.sides);
        let mut reached = vec![false; run.samples.len()];
        for (p, &s) in raw.positions.iter().zip(&raw.samples) {
            if s != NONE {
                assert_eq!(*p, position(&run.samples.sites[s as usize]), "{name}");
                let again = std::mem::replace(&mut reached[s as usize], true);
                assert!(!again, "{name}: sample {s} twice");
            }
        }
        let mut touched = vec![[0, 0]; run.samples.len()];
        for (b, &side) in (0u32..).zip(&run.labels.sides) {
            for &s in run.poles.balls.touching(b) {
                touched[s as usize][side as usize] += 1;
            }
        }
        let due = |s: &usize| touched[*s][0] + touched[*s][1] >= 4 && !touched[*s].contains(&0);
        let due: Vec<usize> = (0..run.samples.len()).filter(due).collect();
        let hit = due.iter().filter(|&&s| reached[s]).count();
        // On a grid the balls at a sample may all lie in a plane.
        let least = if name == "grid" { 50 } else { 98 };
        assert!(due.len() * 2 > run.samples.len(), "{name}: {}", due.len());
        assert!(
            hit * 100 >= due.len() * least,
            "{name}: {hit} of {}",
            due.len()
        );
    }
}

fn volume(raw: &RawCrust) -> f64 {
    let mut six = 0.0;
    for face in raw.faces() {
        let at = |k: usize| raw.positions[raw.corners[face[k] as usize] as usize];
        for k in 1..face.len() - 1 {
            six += dot(at(0), cross(at(k), at(k + 1)));
        }
    }
    six / 6.0
}

/// The divergence theorem against counting: of random points in the box, the
/// share whose ball of least power is inner.
#[test]
fn the_volume_is_that_of_the_inner_cells() {
    let mut random = Random::new(65);
    for (name, points) in [
        ("sphere", shapes::UNIT_SPHERE.samples(300, 66)),
        ("torus", shapes::TORUS.samples(500, 67)),
        ("block", shapes::CAD_BLOCK.samples(400, 68)),
    ] {
        let run = Run::of(&points, 0.5);
        let half = run.samples.lattice.sample_half;
        for turned in [0.0, 0.2] {
            // Some inner cells outer: still inside the box.
            let mut sides = run.labels.sides.clone();
            for side in &mut sides {
                if random.unit() < turned {
                    *side = Side::Outer;
                }
            }
            let raw = run.raw(&sides);
            let exact = volume(&raw);
            let reach = 1.2 * half;
            let inside_box = |p: &Point| p.iter().all(|v| v.abs() < reach);
            assert!(raw.positions.iter().all(inside_box), "{name}");
            let tries = 40_000;
            let mut inner = 0;
            for _ in 0..tries {
                let x = [0; 3].map(|_| random.within(-reach, reach));
                let mut least = (f64::INFINITY, Side::Outer);
                for (ball, &side) in run.balls.iter().zip(&sides) {
                    let power = dist_sq(x, ball.centre) - ball.radius * ball.radius;
                    if power < least.0 {
                        least = (power, side);
                    }
                }
                inner += u32::from(least.1 == Side::Inner);
            }
            let share = f64::from(inner) / f64::from(tries);
            let counted = share * (2.0 * reach).powi(3);
            // Four standard deviations.
            let slack = 4.0 * ((1.0 - share) / (share * f64::from(tries))).sqrt();
            let ratio = exact / counted;
            assert!((ratio - 1.0).abs() < slack, "{name}: {ratio}, {slack}");
        }
    }
}

#[test]
fn crusts_have_the_topology_of_their_surfaces() {
    for (name, points, wanted) in [
        ("sphere", shapes::UNIT_SPHERE.samples(1_000, 69), 2),
        ("torus", shapes::TORUS.samples(3_000, 70), 0),
        ("double torus", shapes::DOUBLE_TORUS.samples(6_000, 71), -2),
        ("shell", shapes::SHELL.samples(4_000, 72), 4),
    ] {
        for merge in [0.0, 0.5] {
            let run = Run::of(&points, merge);
            let raw = run.apart(&run.labels.sides);
            assert_eq!(euler(&raw), wanted, "{name}, merge {merge}");
            // Inside and outside: a solid has half its surface's number.
            let shape = power_shape(&run.power, &run.balls, &run.labels.sides, Side::Inner);
            assert_eq!(2 * shape_euler(&shape), wanted, "{name}, merge {merge}");
        }
    }
}

fn shape_euler(shape: &PowerShape) -> i64 {
    let sizes = [
        shape.balls.len(),
        shape.edges.len(),
        shape.triangles.len(),
        shape.tetrahedra.len(),
    ];
    let [v, e, t, c] = sizes.map(|n| n as i64);
    v - e + t - c
}

/// Simplices closed under taking faces, all corners of the side asked for,
/// and every ball of that side with a cell in it.
#[test]
fn shapes_are_complexes_of_one_side() {
    for (name, points) in clouds() {
        let run = Run::of(&points, 0.5);
        for sides in labellings(&run, 73) {
            for side in [Side::Inner, Side::Outer] {
                let shape = power_shape(&run.power, &run.balls, &sides, side);
                let wanted: Vec<u32> = (0..run.balls.len() as u32)
                    .filter(|&b| sides[b as usize] == side)
                    .filter(|b| run.power.hidden.binary_search(b).is_err())
                    .collect();
                assert!(shape.ids == wanted, "{name}");
                for (ball, &id) in shape.balls.iter().zip(&shape.ids) {
                    assert_eq!(*ball, run.balls[id as usize]);
                }
                let n = shape.balls.len() as u32;
                assert!(shape.edges.iter().all(|e| e[0] < e[1] && e[1] < n));
                let ascending = |w: &[[u32; 2]]| w[0] < w[1];
                assert!(shape.edges.windows(2).all(ascending), "{name}");
                assert!(shape.triangles.windows(2).all(|w| w[0] < w[1]), "{name}");
                assert!(shape.tetrahedra.windows(2).all(|w| w[0] < w[1]), "{name}");
                for [a, b, c] in &shape.triangles {
                    for edge in [[*a, *b], [*a, *c], [*b, *c]] {
                        assert!(shape.edges.binary_search(&edge).is_ok(), "{name}");
                    }
                }
                for [a, b, c, d] in &shape.tetrahedra {
                    for t in [[*a, *b, *c], [*a, *b, *d], [*a, *c, *d], [*b, *c, *d]] {
                        assert!(shape.triangles.binary_search(&t).is_ok(), "{name}");
                    }
                }
            }
        }
    }
}
