//! Merging redundant balls (fact F6) and the identity round trip (fact F12).

use crate::common::shapes::{self, Shape};
use crate::run::{position, Run};
use powercrust::geom::vec3::{dist_sq, dot, norm, sub};
use powercrust::poles::{Poles, NO_POLE};
use powercrust::power::power_diagram;
use powercrust::simplify::merge_redundant;
use powercrust::surface::{power_shape, raw_crust, Placement, RawCrust};
use powercrust::{Context, Point, Side};

fn clouds() -> Vec<(&'static str, Vec<Point>)> {
    vec![
        ("torus", shapes::TORUS.samples(1_500, 51)),
        ("sphere", shapes::UNIT_SPHERE.samples(800, 52)),
        (
            "ellipsoid",
            shapes::Ellipsoid([1.0, 2.0, 3.0]).samples(1_000, 53),
        ),
        ("cylinder", shapes::CYLINDER.samples(1_000, 54)),
        ("block", shapes::CAD_BLOCK.samples(1_000, 55)),
    ]
}

/// Merged by no share at all.
fn unmerged(run: &Run) -> (Poles, Vec<f64>) {
    let (poles, context) = (run.poles.clone(), Context::default());
    merge_redundant(
        &run.samples,
        &run.delaunay.edges(&Context::default()).unwrap(),
        poles,
        0.0,
        &context,
    )
    .unwrap()
}

#[test]
fn no_share_changes_nothing() {
    for (name, points) in clouds() {
        let run = Run::of(&points, 0.0);
        let (same, _) = unmerged(&run);
        assert!(same.balls.sites == run.poles.balls.sites, "{name}");
        assert!(same.balls.touched == run.poles.balls.touched, "{name}");
        assert!(same.of_sample == run.poles.of_sample, "{name}");
    }
}

/// Distance to the fourth nearest Delaunay neighbour, or the last of fewer.
fn spacing(run: &Run, s: u32) -> f64 {
    let at = position(&run.samples.sites[s as usize]);
    let mut near: Vec<u32> = (run.delaunay.complex.cells.iter())
        .filter(|cell| cell.contains(&s))
        .flatten()
        .copied()
        .filter(|&v| v != s && !run.delaunay.is_frame(v))
        .collect();
    near.sort_unstable();
    near.dedup();
    let distance = |&v: &u32| dist_sq(position(&run.samples.sites[v as usize]), at).sqrt();
    let mut reach: Vec<f64> = near.iter().map(distance).collect();
    reach.sort_unstable_by(f64::total_cmp);
    reach.get(3).or(reach.last()).copied().unwrap_or(0.0)
}

#[test]
fn balls_that_stay_stand_for_those_that_go() {
    for (name, points) in clouds() {
        let full = Run::of(&points, 0.0);
        let spacing: Vec<f64> = (0..full.samples.len() as u32)
            .map(|s| spacing(&full, s))
            .collect();
        let mut fewest = full.balls.len();
        for share in [0.1, 0.5, 1.0] {
            let run = Run::of(&points, share);
            let few = run.balls.len();
            assert!(few <= fewest, "{name}: {few} balls at {share}");
            fewest = few;
            assert!(run.spacing == spacing, "{name}: spacing");
            let step = run.step();
            for s in 0..run.samples.len() {
                for k in 0..2 {
                    let (before, after) = (full.poles.of_sample[s][k], run.poles.of_sample[s][k]);
                    assert_eq!(before == NO_POLE, after == NO_POLE, "{name} {s}");
                    if before == NO_POLE {
                        continue;
                    }
                    // The pole is the old one, or one on the same side that
                    // passes within its share of the sampling error.
                    let touches = run.poles.balls.touching(after);
                    assert!(touches.contains(&(s as u32)), "{name} {s}");
                    let at = position(&run.samples.sites[s]);
                    let old = sub(full.balls[before as usize].centre, at);
                    let ball = run.balls[after as usize];
                    let new = sub(ball.centre, at);
                    assert!(dot(old, new) > 0.0, "{name} {s}: other side");
                    let miss = (norm(new) - ball.radius).abs();
                    let allowed = share * spacing[s] * spacing[s] / (2.0 * ball.radius);
                    assert!(miss <= allowed + 2.0 * step, "{name} {s}: {miss} {allowed}");
                }
            }
            // Balls at the frame stay.
            let at_frame = |run: &Run| run.poles.balls.touches_frame.iter().filter(|&&t| t).count();
            assert_eq!(at_frame(&run), at_frame(&full), "{name}");
        }
        assert!(fewest < full.balls.len(), "{name}: none merged");
    }
}

/// Every sample a survivor inherits is within the share of one ball's touch.
#[test]
fn touched_samples_are_touched_within_the_share() {
    for (name, points) in clouds() {
        let share = 0.5;
        let run = Run::of(&points, share);
        let spacing: Vec<f64> = (0..run.samples.len() as u32)
            .map(|s| spacing(&run, s))
            .collect();
        for (b, ball) in (0u32..).zip(&run.balls) {
            for &s in run.poles.balls.touching(b) {
                let at = position(&run.samples.sites[s as usize]);
                let miss = (dist_sq(at, ball.centre).sqrt() - ball.radius).abs();
                let h = spacing[s as usize];
                let allowed = share * h * h / (2.0 * ball.radius) + 2.0 * run.step();
                assert!(miss <= allowed, "{name}: {b} misses {s} by {miss}");
            }
        }
    }
}

/// The faces as cycles of vertices, whatever their numbers: each vertex by
/// its position, each face from its least corner, sorted.
fn faces(raw: &RawCrust) -> Vec<Vec<[u64; 3]>> {
    let mut faces: Vec<Vec<[u64; 3]>> = (raw.faces().iter())
        .map(|face| {
            let at = |h: &u32| raw.positions[raw.corners[*h as usize] as usize];
            let mut cycle: Vec<[u64; 3]> = face.iter().map(|h| at(h).map(f64::to_bits)).collect();
            let least = (0..cycle.len()).min_by_key(|&k| {
                let mut turned = cycle.clone();
                turned.rotate_left(k);
                turned
            });
            cycle.rotate_left(least.unwrap());
            cycle
        })
        .collect();
    faces.sort_unstable();
    faces
}

/// Balls written out and read in again in any order, with their labels: the
/// same crust. Hidden balls, which have no cells, make no difference.
#[test]
fn balls_and_labels_alone_give_the_crust_again() {
    use crate::common::random::Random;
    for (name, points) in clouds() {
        let run = Run::of(&points, 0.5);
        let count = run.balls.len();
        let mut order: Vec<u32> = (0..count as u32).collect();
        order.retain(|b| run.power.hidden.binary_search(b).is_err());
        Random::new(56).shuffle(&mut order);
        let sites: Vec<_> = order
            .iter()
            .map(|&b| run.poles.balls.sites[b as usize])
            .collect();
        let sides: Vec<Side> = order
            .iter()
            .map(|&b| run.labels.sides[b as usize])
            .collect();
        let step = run.step();
        let power = power_diagram(&sites, step, &Context::default()).unwrap();
        assert!(power.hidden.is_empty(), "{name}");
        let place = Placement {
            touching: &|b| run.poles.balls.touching(order[b as usize]),
            sample: &|s| position(&run.samples.sites[s as usize]),
            to_user: &|p| p.map(|v| v * step),
        };
        let again = raw_crust(&power, &sides, &place);
        let first = run.raw(&run.labels.sides);
        assert_eq!(again.positions.len(), first.positions.len(), "{name}");
        // Vertices off the samples come from the same sites in another
        // order: the same combinatorics, floats within a lattice step.
        let rounded = |raw: &RawCrust| {
            let mut raw = raw.clone();
            for p in &mut raw.positions {
                *p = p.map(|v| (v / 1024.0).round() + 0.0);
            }
            raw
        };
        let (a, b) = (faces(&rounded(&again)), faces(&rounded(&first)));
        assert_eq!(a.len(), b.len(), "{name}");
        let differ = a.iter().zip(&b).filter(|(a, b)| a != b).count();
        assert!(differ == 0, "{name}: {differ} of {} faces differ", a.len());
        let shape = |power, balls: &[_], sides: &[_]| power_shape(power, balls, sides, Side::Inner);
        let ours: Vec<_> = order.iter().map(|&b| run.balls[b as usize]).collect();
        let (a, b) = (
            shape(&power, &ours, &sides),
            shape(&run.power, &run.balls, &run.labels.sides),
        );
        let sizes = |s: &powercrust::PowerShape| {
            [
                s.balls.len(),
                s.edges.len(),
                s.triangles.len(),
                s.tetrahedra.len(),
            ]
        };
        assert_eq!(sizes(&a), sizes(&b), "{name}");
    }
}
