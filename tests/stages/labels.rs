//! The queue of section 5.2 against a loop that looks for the top each time.

use crate::common::shapes::{self, Shape};
use crate::run::Run;
use powercrust::label::{self, energy, label, Evidence, LabelOptions, Labels, Neighbours};
use powercrust::{Ball, Context, Point, Side};

fn clouds() -> Vec<(&'static str, Vec<Point>)> {
    let grid = (0..343).map(|n| [n % 7, n / 7 % 7, n / 49].map(f64::from));
    vec![
        ("torus", shapes::TORUS.samples(800, 31)),
        ("sphere", shapes::UNIT_SPHERE.samples(800, 32)),
        ("block", shapes::CAD_BLOCK.samples(800, 33)),
        ("touching", shapes::TOUCHING.samples(800, 34)),
        ("sparse", shapes::DOUBLE_TORUS.samples(60, 35)),
        ("grid", grid.collect()),
    ]
}

/// Figure 8, without a queue: every round looks at every ball.
fn naive(evidence: &Evidence, neighbours: &Neighbours, deep: f64) -> (Vec<Side>, u32) {
    let n = evidence.balls.len();
    let mut inner = vec![0.0f64; n];
    let mut outer: Vec<f64> = evidence.outer.iter().map(|&o| f64::from(o as u8)).collect();
    let mut sides: Vec<Option<Side>> = vec![None; n];
    let mut unreached = 0;
    for _ in 0..n {
        let priority = |b: usize| {
            if inner[b] > 0.0 && outer[b] > 0.0 {
                (inner[b] - outer[b]).abs() - 1.0
            } else {
                inner[b].max(outer[b])
            }
        };
        let mut top = None;
        for b in (0..n).filter(|&b| sides[b].is_none()) {
            if top.is_none_or(|t| priority(b) > priority(t)) {
                top = Some(b);
            }
        }
        let p = top.unwrap();
        let value = inner[p].max(outer[p]);
        let side = if value > 0.0 {
            match inner[p] > outer[p] {
                true => Side::Inner,
                false => Side::Outer,
            }
        } else {
            unreached += 1;
            let mut votes = 0.0;
            for &q in neighbours.at(p as u32) {
                let depth = evidence.balls[p].depth(&evidence.balls[q as usize]);
                if let (Some(side), Some(depth)) = (sides[q as usize], depth) {
                    let vote = 1.0 + depth;
                    votes += if side == Side::Inner { vote } else { -vote };
                }
            }
            match votes > 0.0 {
                true => Side::Inner,
                false => Side::Outer,
            }
        };
        sides[p] = Some(side);
        for pair in evidence.opposites {
            let q = match pair.poles.map(|b| b as usize) {
                [a, b] if a == p => b,
                [a, b] if b == p => a,
                _ => continue,
            };
            let held = match side {
                Side::Inner => &mut outer[q],
                Side::Outer => &mut inner[q],
            };
            *held = held.max(value * pair.weight);
        }
        for &q in neighbours.at(p as u32) {
            let q = q as usize;
            let depth = evidence.balls[p].depth(&evidence.balls[q]);
            if let Some(depth) = depth.filter(|&d| d > deep) {
                let held = match side {
                    Side::Inner => &mut inner[q],
                    Side::Outer => &mut outer[q],
                };
                *held = held.max(value * depth);
            }
        }
    }
    (sides.into_iter().map(|s| s.unwrap()).collect(), unreached)
}

#[test]
fn labels_are_those_of_the_loop_without_a_queue() {
    for (name, points) in clouds() {
        for merge in [0.0, 0.5] {
            let run = Run::of(&points, merge);
            for deep in [0.1, 0.4, 0.9] {
                let options = LabelOptions { deep };
                let evidence = run.evidence();
                let context = Context::default();
                let ours = label(&evidence, &run.neighbours, &options, &context).unwrap();
                let (sides, unreached) = naive(&evidence, &run.neighbours, deep);
                assert!(ours.sides == sides, "{name}, merge {merge}, deep {deep}");
                assert_eq!(ours.unreached, unreached, "{name}, merge {merge}");
            }
        }
    }
}

#[test]
fn clean_surfaces_leave_no_doubt() {
    for (name, points) in [
        ("sphere", shapes::UNIT_SPHERE.samples(1_500, 36)),
        ("torus", shapes::TORUS.samples(3_000, 37)),
    ] {
        let run = Run::of(&points, 0.0);
        let options = LabelOptions::default();
        let found = label::check(&run.evidence(), &run.neighbours, &options, &run.labels);
        assert_eq!(found, [], "{name}");
        assert_eq!(run.labels.unreached, 0, "{name}");
        let sides = &run.labels.sides;
        let doubt = energy(&run.evidence(), &run.neighbours, sides, &options);
        assert_eq!(doubt.total(), 0.0, "{name}");
    }
}

/// The energy and the findings count the same things.
#[test]
fn energy_and_findings_agree() {
    use label::Finding;
    for (name, points) in clouds() {
        let run = Run::of(&points, 0.5);
        let options = LabelOptions::default();
        let mut labels = run.labels.clone();
        for b in (0..labels.sides.len()).step_by(7) {
            labels.sides[b] = labels.sides[b].opposite();
        }
        let evidence = run.evidence();
        let doubt = energy(&evidence, &run.neighbours, &labels.sides, &options);
        let found = label::check(&evidence, &run.neighbours, &options, &labels);
        let count = |of: &dyn Fn(&Finding) -> bool| found.iter().filter(|f| of(f)).count() as u64;
        let like = count(&|f| matches!(f, Finding::LikeOpposites { .. }));
        let unlike = count(&|f| matches!(f, Finding::UnlikeNeighbours { .. }));
        let inner = count(&|f| matches!(f, Finding::InnerAtFrame { .. }));
        assert_eq!(like, doubt.like_opposites, "{name}");
        assert_eq!(unlike, doubt.unlike_neighbours, "{name}");
        let turned = run.poles.balls.touches_frame.iter().step_by(7);
        assert_eq!(inner, turned.filter(|&&t| t).count() as u64, "{name}");
        assert!(like > 0 && unlike > 0 && inner > 0, "{name}: {found:?}");
        labels.sides.pop();
        let found = label::check(&evidence, &run.neighbours, &options, &labels);
        assert!(matches!(found[..], [Finding::Count { .. }]), "{found:?}");
    }
}

/// Depth by the law of cosines, and that the pairs of poles that count are
/// those at right angles or more.
#[test]
fn evidence_is_that_of_the_paper() {
    let run = Run::of(&shapes::TORUS.samples(400, 38), 0.0);
    for pair in &run.opposites {
        assert!(pair.weight > 0.0 && pair.weight <= 1.0);
    }
    let two = run
        .poles
        .of_sample
        .iter()
        .filter(|p| !p.contains(&u32::MAX));
    let two = two.count();
    assert_eq!(run.opposites.len(), two);
    let a = Ball::new([0.0; 3], 3.0);
    let b = Ball::new([0.0, 5.0, 0.0], 4.0);
    // 3, 4, 5: spheres at right angles.
    assert_eq!(a.depth(&b), Some(0.0));
    let c = Ball::new([0.0, 1.0, 0.0], 2.0);
    assert_eq!(a.depth(&c), Some(1.0));
    assert_eq!(a.depth(&Ball::new([7.0, 0.0, 0.0], 4.0)), None);
}

#[test]
fn no_balls_have_no_labels() {
    let run = Run::of(&shapes::UNIT_SPHERE.samples(50, 39), 0.0);
    let nothing = Evidence {
        balls: &run.balls,
        outer: &vec![false; run.balls.len()],
        opposites: &[],
        outward: &[],
    };
    let options = LabelOptions::default();
    let Labels { sides, unreached } =
        label(&nothing, &run.neighbours, &options, &Context::default()).unwrap();
    // Fact F7: no evidence, and yet a label for every ball.
    assert_eq!(sides, vec![Side::Outer; run.balls.len()]);
    assert_eq!(unreached as usize, run.balls.len());
}
