//! Power diagrams of polar balls: the ball of least power, by looking at all.

use crate::common::random::Random;
use crate::common::shapes::{self, Shape};
use crate::run::{position, Run};
use powercrust::geom::vec3::{dist_sq, norm, sub};
use powercrust::power::{self, power_diagram, PowerDiagram};
use powercrust::{Context, Point};

fn clouds() -> Vec<(&'static str, Vec<Point>)> {
    let grid = (0..216).map(|n| [n % 6, n / 6 % 6, n / 36].map(f64::from));
    vec![
        ("torus", shapes::TORUS.samples(500, 41)),
        ("sphere", shapes::UNIT_SPHERE.samples(500, 42)),
        ("block", shapes::CAD_BLOCK.samples(500, 43)),
        ("grid", grid.collect()),
    ]
}

fn pow(power: &PowerDiagram, v: u32, x: Point) -> f64 {
    let site = &power.sites[v as usize];
    dist_sq(x, position(site)) - site[3]
}

#[test]
fn diagrams_pass_their_check() {
    for (name, points) in clouds() {
        for merge in [0.0, 0.5, 1.0] {
            let run = Run::of(&points, merge);
            assert_eq!(power::check(&run.power), [], "{name}, merge {merge}");
        }
    }
}

/// From any ball, going to the neighbour of least power ends at the ball of
/// least power: the cells found by adjacency are the cells by definition.
#[test]
fn the_ball_of_least_power_owns_the_cell() {
    let mut random = Random::new(44);
    for (name, points) in clouds() {
        let run = Run::of(&points, 0.0);
        let power = &run.power;
        let mut near = vec![Vec::new(); power.sites.len()];
        for cell in &power.complex.cells {
            for &v in cell {
                near[v as usize].extend_from_slice(cell);
            }
        }
        for b in 0..power.balls as u32 {
            let mut own = near[b as usize].clone();
            own.sort_unstable();
            own.dedup();
            own.retain(|&v| v != b && !power.is_sentinel(v));
            assert_eq!(run.neighbours.at(b), own, "{name}: neighbours of {b}");
        }
        let reach = run.samples.lattice.sample_half / run.step();
        for _ in 0..500 {
            let x = [0; 3].map(|_| random.within(-2.0 * reach, 2.0 * reach));
            let mut at = loop {
                let b = random.below(power.balls) as u32;
                if power.hidden.binary_search(&b).is_err() {
                    break b;
                }
            };
            loop {
                let next = near[at as usize].iter().copied().min_by(|&a, &b| {
                    let (a, b) = (pow(power, a, x), pow(power, b, x));
                    a.total_cmp(&b)
                });
                match next {
                    Some(b) if pow(power, b, x) < pow(power, at, x) => at = b,
                    _ => break,
                }
            }
            let least = (0..power.sites.len() as u32)
                .map(|b| pow(power, b, x))
                .fold(f64::INFINITY, f64::min);
            let scale = norm(x).powi(2) + power.sites[at as usize][3];
            let gap = pow(power, at, x) - least;
            assert!(gap <= 1e-12 * scale, "{name}: {x:?} is {gap} from its ball");
        }
    }
}

#[test]
fn power_vertices_have_equal_power_to_four_balls_and_no_ball_less() {
    for (name, points) in clouds() {
        let run = Run::of(&points, 0.0);
        let power = &run.power;
        for cell in &power.complex.cells {
            let centre = power.vertex(*cell, 2f64.powi(-20));
            let x = centre.position;
            let common = pow(power, cell[0], x);
            for v in 0..power.sites.len() as u32 {
                let site = &power.sites[v as usize];
                let distance = norm(sub(x, position(site)));
                let first = norm(sub(x, position(&power.sites[cell[0] as usize])));
                // Twice the slope of the power times the error of the vertex,
                // and the rounding of the squares themselves.
                let slack = 4.0 * (distance + first) * (centre.error + 1e-9)
                    + 1e-14 * (distance * distance + first * first + site[3]);
                let gap = pow(power, v, x) - common;
                assert!(gap >= -slack, "{name}: {cell:?}, {v}: {gap}, {slack}");
                let own = cell.contains(&v);
                assert!(
                    !own || gap <= slack,
                    "{name}: {cell:?}, {v}: {gap}, {slack}"
                );
            }
        }
    }
}

#[test]
fn the_checker_finds_what_is_broken() {
    use power::Finding;
    let run = Run::of(&shapes::TORUS.samples(200, 45), 0.0);
    let find = |break_it: &dyn Fn(&mut PowerDiagram)| {
        let mut power = run.power.clone();
        break_it(&mut power);
        power::check(&power)
    };
    let found = find(&|p| p.sites.truncate(p.balls));
    assert_eq!(found, [Finding::NoSentinels]);
    let found = find(&|p| p.sites[3][0] = 1e12);
    assert_eq!(found[0], Finding::OutsideSentinels { ball: 3 });
    let found = find(&|p| p.sites[9] = p.sites[4]);
    assert!(found.contains(&Finding::SameCentre { balls: [4, 9] }));
    let found = find(&|p| p.sites[5][3] += 1e16);
    assert!(found.iter().all(|f| matches!(f, Finding::Complex(_))));
    assert!(!found.is_empty());
}

#[test]
fn no_balls_leave_the_sentinels() {
    let empty = power_diagram(&[], 1024.0, &Context::default()).unwrap();
    assert_eq!(power::check(&empty), []);
    assert!(empty.complex.len() >= 5 && empty.hidden.is_empty());
    assert!(empty.is_sentinel(0));
}
