//! Poles and polar balls, by looking at every cell for every sample.

use crate::common::shapes::{self, Shape};
use crate::run::{position, Run};
use powercrust::delaunay::circumcentre;
use powercrust::geom::vec3::{dist_sq, dot, norm, sub};
use powercrust::poles::{self, poles, Bound, PoleOptions, Reason, NO_POLE};
use powercrust::{Context, Point};

fn clouds() -> Vec<(&'static str, Vec<Point>)> {
    let grid = (0..125).map(|n| [n % 5, n / 5 % 5, n / 25].map(f64::from));
    vec![
        ("torus", shapes::TORUS.samples(500, 21)),
        (
            "ellipsoid",
            shapes::Ellipsoid([1.0, 2.0, 3.0]).samples(500, 22),
        ),
        ("sphere", shapes::UNIT_SPHERE.samples(400, 23)),
        ("block", shapes::CAD_BLOCK.samples(500, 24)),
        ("grid", grid.collect()),
    ]
}

/// The exact centres of all cells, to a step of the samples' lattice.
fn voronoi_vertices(run: &Run) -> Vec<Point> {
    let d = &run.delaunay;
    d.complex
        .cells
        .iter()
        .map(|cell| {
            // Corners in order of id, the tolerance of the stage: the same floats.
            let mut cell = *cell;
            cell.sort_unstable();
            let sites = cell.map(|v| &d.sites[v as usize]);
            circumcentre(sites, run.step() / 64.0).position
        })
        .collect()
}

#[test]
fn poles_are_the_farthest_voronoi_vertices_on_either_side() {
    for (name, points) in clouds() {
        let run = Run::of(&points, 0.0);
        assert_eq!(poles::check(&run.samples, &run.poles), [], "{name}");
        let vertices = voronoi_vertices(&run);
        let tolerance = 4.0 * run.step();
        for s in 0..run.samples.len() {
            let at = position(&run.samples.sites[s]);
            let mine: Vec<Point> = (run.delaunay.complex.cells.iter().zip(&vertices))
                .filter(|(cell, _)| cell.contains(&(s as u32)))
                .map(|(_, &v)| v)
                .collect();
            let [first, second] = run.poles.of_sample[s];
            let reach = |b: u32| norm(sub(run.balls[b as usize].centre, at));
            let farthest = |of: &dyn Fn(&Point) -> bool| {
                let far = mine.iter().filter(|v| of(v)).map(|&v| norm(sub(v, at)));
                far.fold(0.0, f64::max)
            };
            let longest = farthest(&|_| true);
            assert!((reach(first) - longest).abs() <= tolerance, "{name} {s}");
            // Vertices square to the first pole may count or not.
            let normal = sub(run.balls[first as usize].centre, at);
            let ahead = |v: &Point| dot(sub(*v, at), normal) / norm(normal);
            let (least, most) = (
                farthest(&|v| ahead(v) < -tolerance),
                farthest(&|v| ahead(v) < tolerance),
            );
            let second = if second == NO_POLE {
                0.0
            } else {
                reach(second)
            };
            assert!(second >= least - tolerance, "{name} {s}: {second} {least}");
            assert!(second <= most + tolerance, "{name} {s}: {second} {most}");
        }
    }
}

#[test]
fn no_sample_lies_inside_a_polar_ball() {
    for (name, points) in clouds() {
        let run = Run::of(&points, 0.0);
        let step = run.step();
        for (b, ball) in run.balls.iter().enumerate() {
            for (s, site) in run.samples.sites.iter().enumerate() {
                let gap = dist_sq(position(site), ball.centre).sqrt() - ball.radius;
                assert!(gap > -2.0 * step, "{name}: ball {b}, sample {s}: {gap}");
                let touches = run.poles.balls.touching(b as u32).contains(&(s as u32));
                assert!(!touches || gap < 2.0 * step, "{name}: {b}, {s}: {gap}");
            }
        }
    }
}

/// Cells with one centre are one ball, whether they are poles or not: in a
/// grid eight samples share it.
#[test]
fn balls_touch_the_samples_of_all_cells_with_their_centre() {
    for (name, points) in clouds() {
        let run = Run::of(&points, 0.0);
        let step = run.step();
        for (cell, centre) in run
            .delaunay
            .complex
            .cells
            .iter()
            .zip(voronoi_vertices(&run))
        {
            let centre = centre.map(|v| (v / step).round_ties_even() * step);
            let Some(b) = run.balls.iter().position(|b| b.centre == centre) else {
                continue;
            };
            for v in cell {
                let touches = run.poles.balls.touching(b as u32).contains(v);
                let frame = run.delaunay.is_frame(*v);
                assert!(touches || frame, "{name}: ball {b}, sample {v}");
                assert!(!frame || run.poles.balls.touches_frame[b], "{name}: {b}");
            }
        }
    }
}

/// Fact F3: hardly a ball is hidden, and only by rounding.
#[test]
fn polar_balls_have_cells() {
    for (name, points) in clouds() {
        let run = Run::of(&points, 0.0);
        let (hidden, all) = (run.power.hidden.len(), run.balls.len());
        assert!(hidden * 1000 <= all, "{name}: {hidden} of {all} hidden");
    }
}

#[test]
fn the_skinniness_test_is_that_of_section_6() {
    let mut dropped = 0;
    for (name, points) in clouds() {
        let run = Run::of(&points, 0.0);
        let step = run.step();
        let vertices: Vec<Point> = voronoi_vertices(&run)
            .iter()
            .map(|p| p.map(|v| (v / step).round_ties_even() * step))
            .collect();
        for (lambda, sharp) in [(0.1, false), (0.4, false), (0.4, true), (1.0, true)] {
            let options = PoleOptions {
                bound: Bound::All(lambda),
                sharp,
            };
            let d = &run.delaunay;
            let cut = poles(&run.samples, d, &options, &Context::default()).unwrap();
            let (mut lost, mut failed) = (0, 0);
            for s in 0..run.samples.len() {
                let at = position(&run.samples.sites[s]);
                let full = run.poles.of_sample[s];
                let normal = sub(run.balls[full[0] as usize].centre, at);
                let mut bound = 0.0f64;
                for (cell, &x) in d.complex.cells.iter().zip(&vertices) {
                    if cell.contains(&(s as u32)) {
                        let x = sub(x, at);
                        let cosine = dot(x, normal).abs() / (norm(x) * norm(normal));
                        let beta = cosine.min(1.0).acos();
                        if beta > lambda {
                            bound = bound.max(norm(x) * (beta - lambda).sin() / lambda);
                        }
                    }
                }
                let fails = full
                    .map(|b| b != NO_POLE && norm(sub(run.balls[b as usize].centre, at)) < bound);
                for k in 0..2 {
                    let gone = full[k] == NO_POLE || fails[k] || (sharp && fails[1 - k]);
                    let is_gone = cut.of_sample[s][k] == NO_POLE;
                    assert_eq!(is_gone, gone, "{name}, lambda {lambda}, {s}, {k}");
                    lost += (gone && full[k] != NO_POLE) as u32;
                }
                failed += (fails[0] || fails[1]) as u32;
            }
            let counted = (cut.dropped.len() as u32, cut.samples_short() as u32);
            assert_eq!(counted, (lost, failed), "{name}");
            for gone in &cut.dropped {
                let full = run.poles.of_sample[gone.sample as usize];
                let ball = &run.balls[full[gone.pole as usize - 1] as usize];
                assert_eq!(gone.centre, ball.centre, "{name}");
                let skinny = gone.reason == Reason::Skinny;
                assert_eq!(skinny, gone.radius < gone.bound, "{name}");
                assert!(skinny || sharp, "{name}");
            }
            dropped += lost;
        }
    }
    assert!(dropped > 100, "only {dropped} poles dropped");
}

#[test]
fn the_checker_finds_what_is_broken() {
    use poles::Finding;
    let run = Run::of(&shapes::TORUS.samples(200, 25), 0.0);
    let find = |break_it: &dyn Fn(&mut poles::Poles)| {
        let mut poles = run.poles.clone();
        break_it(&mut poles);
        poles::check(&run.samples, &poles)
    };
    let [ball, _] = run.poles.of_sample[0];
    let found = find(&|p| p.of_sample[0][1] = ball);
    assert!(found.contains(&Finding::OneSide { sample: 0 }), "{found:?}");
    let stranger = (0..run.balls.len() as u32)
        .find(|&b| !run.poles.balls.touching(b).contains(&0))
        .unwrap();
    let found = find(&|p| p.of_sample[0][0] = stranger);
    let sample = 0;
    let ball = stranger;
    assert!(
        found.contains(&Finding::NotTouching { sample, ball }),
        "{found:?}"
    );
    let found = find(&|p| p.balls.sites[7][3] *= 0.9);
    assert!(found
        .iter()
        .all(|f| matches!(f, Finding::Misses { ball: 7, .. })));
    assert_eq!(found.len(), run.poles.balls.touching(7).len());
    let found = find(&|p| p.balls.touched.swap(0, 1));
    assert_eq!(found[found.len() - 1], Finding::Unsorted { ball: 0 });
    let found = find(&|p| p.of_sample.iter_mut().for_each(|s| *s = [NO_POLE; 2]));
    assert_eq!(found.len(), run.balls.len());
    assert_eq!(found[0], Finding::NoOnesPole { ball: 0 });
}
