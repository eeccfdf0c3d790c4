//! Noise: recognised without a parameter, seen through, and nothing done
//! where there is none.

use powercrust::noise::Stray;
use powercrust::{reconstruct, Context, NoiseOption, Options, OutlierOption, Point};

/// Numbers in [0, 1), the same each time.
fn numbers(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state =
            (state.wrapping_mul(6_364_136_223_846_793_005)).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A point of the unit sphere, and a Gaussian vector of this deviation.
fn noisy_sphere(count: usize, deviation: f64) -> Vec<Point> {
    let mut next = numbers(7);
    (0..count)
        .map(|_| {
            let mut gauss = || {
                let (u, v) = (1.0 - next(), next());
                (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
            };
            let way = [gauss(), gauss(), gauss()];
            let length = way.iter().map(|v| v * v).sum::<f64>().sqrt();
            way.map(|v| v / length + deviation * gauss())
        })
        .collect()
}

fn with(noise: NoiseOption) -> Options {
    Options {
        noise,
        ..Options::default()
    }
}

#[test]
fn clean_samples_are_left_alone() {
    let points = noisy_sphere(1500, 0.0);
    let run = |noise| reconstruct(&points, &with(noise), &Context::default()).unwrap();
    let (auto, off) = (run(NoiseOption::Auto), run(NoiseOption::Off));
    assert_eq!(auto.crust.mesh, off.crust.mesh);
    assert!(!auto.stats.noise.treated);
    assert!(!auto.stats.noise.level.unwrap().noisy);
}

#[test]
fn noise_is_found_and_seen_through() {
    let deviation = 0.03;
    let points = noisy_sphere(4000, deviation);
    let run = |noise| reconstruct(&points, &with(noise), &Context::default()).unwrap();
    let off_by = |result: &powercrust::Reconstruction| {
        let vertices = &result.crust.mesh.vertices;
        let off = |p: &Point| (p.iter().map(|v| v * v).sum::<f64>().sqrt() - 1.0).abs();
        vertices.iter().map(off).sum::<f64>() / vertices.len() as f64
    };
    let auto = run(NoiseOption::Auto);
    let found = &auto.stats.noise;
    assert!(found.treated);
    assert!(
        (found.scale / deviation - 1.0).abs() < 0.15,
        "{}",
        found.scale
    );
    assert!(off_by(&auto) < 0.3 * deviation, "{}", off_by(&auto));
    let findings = powercrust::mesh::check(
        &auto.crust.mesh,
        &powercrust::mesh::CheckOptions::default(),
        &Context::default(),
    )
    .unwrap();
    assert!(findings.is_watertight());
    assert_eq!(findings.genus, Some(0));
    let kept = off_by(&run(NoiseOption::Off));
    assert!(off_by(&auto) < 0.5 * kept, "{} and {kept}", off_by(&auto));
    // The same, told how much noise there is.
    let told = run(NoiseOption::Scale(deviation));
    assert!(off_by(&told) < 0.3 * deviation);
    assert_eq!(told.stats.noise.level, None);
}

#[test]
fn neither_threads_nor_the_order_of_the_input_matter() {
    let points = noisy_sphere(1200, 0.03);
    let one = reconstruct(&points, &Options::default(), &Context::default()).unwrap();
    assert!(one.stats.noise.treated);
    let mut other = points.clone();
    other.reverse();
    let context = Context {
        threads: std::num::NonZeroUsize::new(3),
        ..Context::default()
    };
    let other = reconstruct(&other, &Options::default(), &context).unwrap();
    assert_eq!(one.crust.mesh, other.crust.mesh);
    // Vertices still know the input points that they come from.
    for (v, &s) in one.crust.vertex_samples.iter().enumerate() {
        if s != u32::MAX {
            let from = points[one.sample_source[s as usize] as usize];
            let to = one.crust.mesh.vertices[v];
            let way = (0..3)
                .map(|k| (from[k] - to[k]).powi(2))
                .sum::<f64>()
                .sqrt();
            assert!(way < 0.2, "{way}");
        }
    }
}

/// A sphere with outliers strewn through twice its box: the surface and what is
/// reported are those of the sphere alone.
#[test]
fn outliers_are_left_out_and_reported() {
    const CLEAN: usize = 3000;
    let mut points = noisy_sphere(CLEAN, 0.0);
    let mut next = numbers(3);
    points.extend((0..60).map(|_| [0; 3].map(|_| 4.0 * next() - 2.0)));
    let with = |outliers| Options {
        outliers,
        ..Options::default()
    };
    let run = |points: &[Point], outliers| {
        reconstruct(points, &with(outliers), &Context::default()).unwrap()
    };
    let auto = run(&points, OutlierOption::Auto);
    let found = &auto.outliers;
    assert!(found.iter().all(|&(p, _)| p as usize >= CLEAN), "{found:?}");
    assert!(found.iter().filter(|o| o.1 == Stray::Floating).count() >= 50);
    assert_eq!(found.len(), auto.stats.outliers.left_out);
    assert!(auto
        .sample_source
        .iter()
        .all(|s| found.iter().all(|o| o.0 != *s)));
    // Those left lie within three spacings, 0.2, of the sphere.
    let far = |p: &&Point| (p.iter().map(|v| v * v).sum::<f64>().sqrt() - 1.0).abs() > 0.2;
    assert_eq!(auto.crust.mesh.vertices.iter().filter(far).count(), 0);
    let kept = run(&points, OutlierOption::Keep);
    assert!(kept.outliers.is_empty());
    assert!(kept.crust.mesh.vertices.iter().filter(far).count() > 10);

    // Without outliers nothing changes.
    let clean = &points[..CLEAN];
    let (auto, keep) = (
        run(clean, OutlierOption::Auto),
        run(clean, OutlierOption::Keep),
    );
    assert_eq!(auto.crust.mesh, keep.crust.mesh);
}

/// Two plates of 2 by 2, so far apart, with noise.
fn noisy_plates(apart: f64, deviation: f64) -> Vec<Point> {
    let mut next = numbers(2);
    (0..3000)
        .map(|k| {
            let mut gauss = || {
                let (u, v) = (1.0 - next(), next());
                (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
            };
            let off = [gauss(), gauss(), gauss()].map(|v| deviation * v);
            let height = if k % 2 == 0 { apart } else { 0.0 };
            [
                2.0 * next() + off[0],
                2.0 * next() + off[1],
                height + off[2],
            ]
        })
        .collect()
}

/// Between two plates ten times the noise apart there are pinholes without that.
#[test]
fn handles_thinner_than_the_noise_are_cut() {
    let points = noisy_plates(0.3, 0.03);
    let result = reconstruct(&points, &Options::default(), &Context::default()).unwrap();
    assert!(result.stats.noise.treated && result.stats.handles_cut > 0);
    let check = powercrust::mesh::check;
    let found = check(
        &result.crust.mesh,
        &powercrust::mesh::CheckOptions::default(),
        &Context::default(),
    );
    let found = found.unwrap();
    assert!(found.is_watertight());
    assert_eq!((found.genus, found.components), (Some(0), 1));
    // Nor do threads or the order of the input matter there.
    let context = Context {
        threads: std::num::NonZeroUsize::new(3),
        ..Context::default()
    };
    let reversed: Vec<Point> = points.into_iter().rev().collect();
    let again = reconstruct(&reversed, &Options::default(), &context).unwrap();
    assert_eq!(result.crust.mesh, again.crust.mesh);
}

/// A shell through more than four samples, but fewer than noise is measured by.
#[test]
fn specks_amid_noise_are_taken_out() {
    let points = noisy_plates(0.25, 0.05);
    let result = reconstruct(&points, &Options::default(), &Context::default()).unwrap();
    assert_eq!(result.stats.specks, 1);
    let report = powercrust::mesh::check(
        &result.crust.mesh,
        &powercrust::mesh::CheckOptions::default(),
        &Context::default(),
    );
    assert_eq!(report.unwrap().components, 1);
}
