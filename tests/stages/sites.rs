//! Sites on small integers, in general position and in every other.

use crate::common::random::Random;
use powercrust::predicates::Site;

/// Half-side of the frame around all of these.
pub const HALF: f64 = 1024.0;

/// Puts the sites without repetition into the frame's keeping: the frame's
/// corners come last.
pub fn framed(sites: &[Site]) -> Vec<Site> {
    let mut all = distinct(sites);
    for k in 0..8u32 {
        all.push([0, 1, 2, 3].map(|axis| match (axis, k >> axis & 1) {
            (3, _) => 0.0,
            (_, 1) => HALF,
            _ => -HALF,
        }));
    }
    all
}

/// The first of all sites with one centre.
fn distinct(sites: &[Site]) -> Vec<Site> {
    let mut kept: Vec<Site> = Vec::new();
    for s in sites {
        if !kept.iter().any(|k| k[..3] == s[..3]) {
            kept.push(*s);
        }
    }
    kept
}

pub fn random(count: usize, reach: i32, random: &mut Random) -> Vec<Site> {
    (0..count)
        .map(|_| {
            let mut v = || whole_within(reach, random);
            [v(), v(), v(), 0.0]
        })
        .collect()
}

fn whole_within(reach: i32, random: &mut Random) -> f64 {
    random.below(2 * reach as usize + 1) as f64 - f64::from(reach)
}

pub fn grid(side: i32) -> Vec<Site> {
    (0..side.pow(3))
        .map(|n| [n % side, n / side % side, n / side / side, 0].map(f64::from))
        .collect()
}

/// All integer points at the distance sqrt(`norm_sq`) from the origin.
pub fn sphere(norm_sq: i32) -> Vec<Site> {
    let reach = f64::from(norm_sq).sqrt() as i32;
    let mut found = Vec::new();
    for x in -reach..=reach {
        for y in -reach..=reach {
            for z in -reach..=reach {
                if x * x + y * y + z * z == norm_sq {
                    found.push([x, y, z, 0].map(f64::from));
                }
            }
        }
    }
    found
}

/// Points on two skew lines: every pair of segments is a cell.
pub fn skew_lines(count: i32) -> Vec<Site> {
    let at = |k: i32| [[k, 0, -20, 0], [0, k, 20, 0]].map(|p| p.map(f64::from));
    (-count / 2..count - count / 2).flat_map(at).collect()
}

/// Random points on three planes.
pub fn planes(count: usize, reach: i32, random: &mut Random) -> Vec<Site> {
    (0..count)
        .map(|k| {
            let (a, b) = (whole_within(reach, random), whole_within(reach, random));
            match k % 3 {
                0 => [a, b, 0.0, 0.0],
                1 => [a, 3.0, b, 0.0],
                _ => [a, b, a + b, 0.0],
            }
        })
        .collect()
}

/// Balls through a few common samples, as polar balls are: fact F1.
pub fn polar(count: usize, reach: i32, random: &mut Random) -> Vec<Site> {
    let samples = self::random(3, 2, random);
    let mut balls = self::random(count, reach, random);
    for ball in &mut balls {
        let s = samples[random.below(samples.len())];
        ball[3] = (0..3).map(|k| (ball[k] - s[k]) * (ball[k] - s[k])).sum();
    }
    balls
}

/// Every family, small enough for the definition by quadruples.
pub fn small() -> Vec<(String, Vec<Site>)> {
    let mut r = Random::new(1);
    let mut all = vec![
        ("one site".into(), vec![[0.0; 4]]),
        ("cube".into(), grid(2)),
        ("octahedron".into(), sphere(1)),
        ("cuboctahedron".into(), sphere(2)),
        ("lines".into(), skew_lines(6)),
    ];
    for k in 0..12 {
        all.push((format!("random {k}"), random(10, 100, &mut r)));
        all.push((format!("crowded {k}"), random(10, 2, &mut r)));
        all.push((format!("flat {k}"), planes(9, 4, &mut r)));
    }
    all
}

/// Larger ones, for everything else.
pub fn large() -> Vec<(String, Vec<Site>)> {
    let mut r = Random::new(2);
    let mut shifted = grid(5);
    for s in &mut shifted {
        s[0] += 0.0_f64.max(s[1]);
    }
    vec![
        ("random".into(), random(300, 500, &mut r)),
        ("crowded".into(), random(300, 6, &mut r)),
        ("grid 3".into(), grid(3)),
        ("grid 4".into(), grid(4)),
        ("grid 5".into(), grid(5)),
        ("sheared grid".into(), shifted),
        ("sphere".into(), sphere(101)),
        ("two spheres".into(), [sphere(50), sphere(65)].concat()),
        ("lines".into(), skew_lines(40)),
        ("planes".into(), planes(200, 30, &mut r)),
    ]
}
