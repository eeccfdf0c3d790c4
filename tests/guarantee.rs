//! Whatever the points: a typed error, or a mesh that bounds a solid, with no
//! two faces that come together but in what they share.
//!
//! `POWERCRUST_SEEDS=2000` runs more seeds; `POWERCRUST_SEED=17` just one.

use powercrust::mesh::{check, CheckOptions, Report};
use powercrust::{reconstruct, Context, Error, Faces, LambdaOption, Options, Point, SharpOption};
use rayon::prelude::*;

/// splitmix64.
struct Random(u64);

impl Random {
    fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: u64) -> u64 {
        self.word() % n
    }

    /// In [-1, 1).
    fn real(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn point(&mut self) -> Point {
        [self.real(), self.real(), self.real()]
    }

    fn on_sphere(&mut self) -> Point {
        loop {
            let p = self.point();
            let r = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
            if r > 0.1 && r < 1.0 {
                return p.map(|x| x / r);
            }
        }
    }
}

/// A cloud of 4 to 200 points of one of many kinds.
fn cloud(seed: u64) -> (&'static str, Vec<Point>) {
    let mut r = Random(seed.wrapping_mul(0x1234_5677).wrapping_add(seed));
    let n = match r.below(3) {
        0 => 4 + r.below(12),
        1 => 4 + r.below(60),
        _ => 4 + r.below(197),
    } as usize;
    match seed % 12 {
        0 => {
            let k = 2 + r.below(5);
            let grid = |r: &mut Random| r.below(k) as f64;
            (
                "integers",
                (0..n)
                    .map(|_| [grid(&mut r), grid(&mut r), grid(&mut r)])
                    .collect(),
            )
        }
        1 => ("random", (0..n).map(|_| r.point()).collect()),
        2 => {
            let centres: Vec<Point> = (0..1 + n / 8).map(|_| r.point()).collect();
            let tight = 10f64.powi(-(3 + r.below(7) as i32));
            let points = (0..n).map(|_| {
                let c = centres[r.below(centres.len() as u64) as usize];
                let p = r.point();
                [0, 1, 2].map(|k| c[k] + tight * p[k])
            });
            ("clusters", points.collect())
        }
        3 => {
            let mut points = Vec::new();
            for _ in 0..n.div_ceil(8) {
                let p = r.point();
                for bits in 0..8u32 {
                    points.push([0, 1, 2].map(|k| if bits >> k & 1 == 1 { p[k] } else { -p[k] }));
                }
            }
            ("symmetric", points)
        }
        4 => {
            let some: Vec<Point> = (0..n.div_ceil(3)).map(|_| r.point()).collect();
            ("doubled", (0..n).map(|k| some[k % some.len()]).collect())
        }
        5 => {
            let points = (0..n).map(|k| match k % 3 {
                0 => [2.0 * r.real(), 0.0, 0.0],
                _ => r.on_sphere(),
            });
            ("line and sphere", points.collect())
        }
        6 => {
            let points = (0..n).map(|k| match k % 4 {
                0 => r.on_sphere(),
                1 => [r.real(), r.real(), 0.0],
                2 => [r.real(), 0.0, r.real()],
                _ => [0.5, r.real(), r.real()],
            });
            ("planes", points.collect())
        }
        7 => ("sphere", (0..n).map(|_| r.on_sphere()).collect()),
        8 => {
            let thin = 10f64.powi(-(r.below(6) as i32));
            (
                "slab",
                (0..n)
                    .map(|_| [r.real(), r.real(), thin * r.real()])
                    .collect(),
            )
        }
        9 => {
            // Two spheres that touch or nearly touch.
            let gap = [0.0, 1e-3, -1e-3, 0.3][r.below(4) as usize];
            let points = (0..n).map(|k| {
                let p = r.on_sphere();
                let s = if k % 2 == 0 { -1.0 } else { 1.0 };
                [p[0] + s * (1.0 + gap), p[1], p[2]]
            });
            ("two spheres", points.chain([[0.0; 3]]).collect())
        }
        10 => {
            let points = (0..n).map(|_| {
                let axis = r.below(3) as usize;
                let mut p = r.point();
                p[axis] = p[axis].signum();
                p
            });
            ("cube", points.collect())
        }
        _ => {
            let far = r.below(2) as f64 * 1e6;
            let points = (0..n).map(|_| {
                let p = r.on_sphere();
                let q = 1.0 + 0.3 * r.real();
                [p[0] * q + far, p[1] * q, p[2] * q]
            });
            ("noisy sphere", points.collect())
        }
    }
}

fn options(seed: u64) -> Options {
    let mut r = Random(!seed);
    let mut options = Options::default();
    match r.below(8) {
        0 => options.lambda = LambdaOption::Value(0.3),
        1 => (options.lambda, options.sharp) = (LambdaOption::Value(0.4), SharpOption::Skinny),
        2 => options.single = true,
        3 => options.flatness = 0.0,
        4 => options.faces = Faces::Polygons,
        5 => options.sharp = SharpOption::Auto,
        _ => {}
    }
    options
}

fn fault(seed: u64) -> Option<String> {
    let (kind, points) = cloud(seed);
    let options = options(seed);
    let result = match reconstruct(&points, &options, &Context::default()) {
        Ok(result) => result,
        Err(Error::Samples(_) | Error::NothingInside { .. } | Error::Single { .. }) => return None,
        Err(other) => return Some(format!("seed {seed} ({kind}): {other}")),
    };
    let judge = CheckOptions {
        f32: options.single,
        ..CheckOptions::default()
    };
    let report: Report = match check(&result.crust.mesh, &judge, &Context::default()) {
        Ok(report) => report,
        Err(error) => return Some(error.to_string()),
    };
    let left = result.stats.crossings_left;
    if report.is_embedded() && left == 0 {
        return None;
    }
    Some(format!(
        "seed {seed} ({kind}, {} points, {:?} single {} flatness {} lambda {:?} sharp {:?}): left {left} {:?} volume {}",
        points.len(),
        options.faces,
        options.single,
        options.flatness,
        options.lambda,
        options.sharp,
        report.counts,
        report.volume,
    ))
}

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

#[test]
fn any_cloud_gives_an_embedded_surface_or_an_error() {
    let seeds = match number("POWERCRUST_SEED") {
        Some(seed) => seed..seed + 1,
        None => 0..number("POWERCRUST_SEEDS").unwrap_or(300),
    };
    let faults: Vec<String> = seeds.into_par_iter().filter_map(fault).collect();
    let few = &faults[..faults.len().min(30)];
    assert!(
        faults.is_empty(),
        "{} seeds fail:\n{}",
        faults.len(),
        few.join("\n")
    );
}

/// Points in a volume make a tangle of pinched sheets: mending happens, and
/// tells of it.
#[test]
fn stats_tell_of_mending() {
    let (mut found, mut mended, mut apart) = (0, 0, 0);
    for seed in 0..200 {
        let (_, points) = cloud(seed);
        if let Ok(result) = reconstruct(&points, &Options::default(), &Context::default()) {
            found += result.stats.crossings_found;
            mended += result.stats.mended_faces;
            apart += result.stats.drawn_apart;
            assert_eq!(result.stats.crossings_left, 0, "seed {seed}");
        }
    }
    assert!(
        found > 0 && mended > 0 && apart > 0,
        "{found} {mended} {apart}"
    );
}
