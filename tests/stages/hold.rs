//! What follows the greedy labels: flips, and more balls for samples that lie
//! off the crust.

use crate::common::random::Random;
use crate::common::shapes::{self, Shape};
use crate::run::{position, Run};
use powercrust::geom::vec3::dist_sq;
use powercrust::label::{energy, hold, refine, Evidence, LabelOptions};
use powercrust::power::{self, power_diagram};
use powercrust::predicates::Site;
use powercrust::{Context, Point, Side};
use std::collections::BTreeSet;

fn clouds() -> Vec<(&'static str, Vec<Point>)> {
    let grid = |n: i32| [n % 8, n / 8 % 8, n / 64].map(f64::from);
    let outermost = |p: &Point| p.iter().any(|&v| v == 0.0 || v == 7.0);
    vec![
        ("block", shapes::CAD_BLOCK.samples(1_500, 81)),
        ("cube", shapes::CUBE.samples(1_000, 82)),
        ("torus", shapes::TORUS.samples(1_000, 83)),
        ("grid", (0..512).map(grid).collect()),
        (
            "hollow grid",
            (0..512).map(grid).filter(outermost).collect(),
        ),
    ]
}

/// A diagram does not depend on which balls came first.
#[test]
fn a_diagram_extended_is_the_diagram_of_all() {
    let mut random = Random::new(84);
    for (name, points) in clouds() {
        let run = Run::of(&points, 0.5);
        let mut sites = run.poles.balls.sites.clone();
        random.shuffle(&mut sites);
        let context = Context::default();
        let whole = power_diagram(&sites, run.step(), &context).unwrap();
        let cells = |power: &power::PowerDiagram| -> BTreeSet<[u32; 4]> {
            let mut cells = BTreeSet::new();
            for mut cell in power.complex.cells.iter().copied() {
                cell.sort_unstable();
                cells.insert(cell);
            }
            cells
        };
        for first in [0, 1, sites.len() / 2, sites.len() - 1, sites.len()] {
            let (some, more) = sites.split_at(first);
            let mut grown = power_diagram(some, run.step(), &context).unwrap();
            grown.extend(more, &context).unwrap();
            assert_eq!(power::check(&grown), [], "{name}, {first} first");
            assert!(grown.sites == whole.sites, "{name}, {first} first");
            assert_eq!(grown.balls, whole.balls);
            assert_eq!(grown.hidden, whole.hidden, "{name}, {first} first");
            assert!(cells(&grown) == cells(&whole), "{name}, {first} first");
        }
    }
}

#[test]
fn the_owner_is_the_ball_of_least_power() {
    let mut random = Random::new(85);
    for (name, points) in clouds() {
        let run = Run::of(&points, 0.5);
        let power = &run.power;
        let reach = run.samples.lattice.sample_half / run.step();
        for _ in 0..300 {
            let at = [0; 3].map(|_| random.within(-2.0 * reach, 2.0 * reach).round());
            let site: Site = [at[0], at[1], at[2], 0.0];
            let pow = |v: u32| {
                dist_sq(at, position(&power.sites[v as usize])) - power.sites[v as usize][3]
            };
            let hint = random.below(power.complex.len()) as u32;
            let owner = power.owner(&site, hint).unwrap();
            let least = (0..power.sites.len() as u32)
                .map(pow)
                .fold(f64::INFINITY, f64::min);
            let scale = dist_sq(at, [0.0; 3]) + power.sites[owner as usize][3];
            assert!(pow(owner) - least <= 1e-12 * scale, "{name}: {at:?}");
        }
        // Beyond all balls the sentinels own.
        let corner = power.sites[power.balls][0].abs() - 1.0;
        assert_eq!(power.owner(&[corner, corner, corner, 0.0], 0), None);
    }
}

/// No flip of one ball lowers the energy any more, and the energy fell.
#[test]
fn flips_end_where_none_helps() {
    let options = LabelOptions::default();
    let mut random = Random::new(86);
    for (name, points) in clouds() {
        let run = Run::of(&points, 0.5);
        let evidence = run.evidence();
        let mut labels = run.labels.clone();
        for (side, &outer) in labels.sides.iter_mut().zip(evidence.outer) {
            if !outer && random.below(10) == 0 {
                *side = side.opposite();
            }
        }
        let total = |sides: &[Side]| energy(&evidence, &run.neighbours, sides, &options).total();
        let before = total(&labels.sides);
        let flips = refine(&evidence, &run.neighbours, &mut labels, &options);
        let after = total(&labels.sides);
        assert!(flips > 0 && after < before, "{name}: {before} to {after}");
        for b in 0..labels.sides.len() {
            if evidence.outer[b] {
                assert_eq!(labels.sides[b], Side::Outer, "{name}: ball {b}");
            } else if b % 11 == 0 {
                let mut flipped = labels.sides.clone();
                flipped[b] = flipped[b].opposite();
                assert!(total(&flipped) >= after - 1e-6, "{name}: ball {b}");
            }
        }
        assert_eq!(refine(&evidence, &run.neighbours, &mut labels, &options), 0);
    }
}

/// Samples without balls of both sides, counted the plain way.
fn unheld(run: &Run, sides: &[Side]) -> usize {
    let mut touched = vec![[false; 2]; run.samples.len()];
    for (b, &side) in (0u32..).zip(sides) {
        for &s in run.poles.balls.touching(b) {
            touched[s as usize][side as usize] = true;
        }
    }
    let one = |t: &&[bool; 2]| t[0] != t[1];
    touched.iter().filter(one).count()
}

#[test]
fn balls_are_added_for_samples_off_the_crust_and_the_diagram_stays_sound() {
    let mut added = 0;
    for (name, points) in clouds() {
        for merge in [0.0, 0.5] {
            let mut run = Run::of(&points, merge);
            let before = unheld(&run, &run.labels.sides);
            let count = run.balls.len();
            let context = Context::default();
            let mut labels = run.labels.clone();
            let (balls, power) = (&mut run.poles.balls, &mut run.power);
            let held = hold(&run.delaunay, balls, power, &mut labels, 1.0, &context).unwrap();
            let name = format!("{name}, merge {merge}");
            assert_eq!(held.unheld as usize, before, "{name}");
            assert_eq!(run.power.balls, count + held.added as usize, "{name}");
            assert_eq!(labels.sides.len(), run.power.balls, "{name}");
            assert_eq!(run.poles.balls.len(), run.power.balls, "{name}");
            assert!(labels.sides[..count] == run.labels.sides[..], "{name}");
            assert_eq!(power::check(&run.power), [], "{name}");
            let after = unheld(&run, &labels.sides);
            assert!(
                after <= held.left as usize,
                "{name}: {after} of {}",
                held.left
            );
            added += held.added;
            // Still the same promises of the crust.
            run.balls = run.poles.balls.on_lattice();
            let evidence = Evidence {
                balls: &run.balls,
                outer: &run.poles.balls.touches_frame,
                opposites: &[],
                outward: &[],
            };
            assert_eq!(evidence.outer.len(), run.balls.len(), "{name}");
            crate::crust::assert_closed(&name, &run, &labels.sides, &run.apart(&labels.sides));
        }
    }
    assert!(added > 20, "only {added} balls added");
}

/// A sample off the crust whose ball is hidden: there is no cell to walk from.
#[test]
fn hidden_balls_do_not_stop_the_search() {
    let points = shapes::CUBE.samples(1_000, 87);
    let mut run = Run::of(&points, 0.5);
    let sides = run.labels.sides.clone();
    for b in 0..run.balls.len() as u32 {
        let touching = run.poles.balls.touching(b);
        let alone = |&s: &u32| {
            let poles = run.poles.of_sample[s as usize];
            poles
                .iter()
                .all(|&p| p == u32::MAX || sides[p as usize] == sides[b as usize])
        };
        if touching.iter().any(alone) {
            run.poles.balls.sites[b as usize][3] = 0.0;
        }
    }
    let context = Context::default();
    let step = run.step();
    run.power = power_diagram(&run.poles.balls.sites, step, &context).unwrap();
    assert!(!run.power.hidden.is_empty());
    let (balls, power) = (&mut run.poles.balls, &mut run.power);
    let mut labels = run.labels.clone();
    let held = hold(&run.delaunay, balls, power, &mut labels, 1.0, &context).unwrap();
    assert!(held.unheld > 0);
    assert_eq!(power::check(power), []);
}
