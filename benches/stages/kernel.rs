//! From points to the power diagram.

use crate::clouds::{stages, Cloud};
use divan::counter::ItemsCount;
use divan::Bencher;
use powercrust::poles::{PoleOptions, Poles};
use powercrust::{delaunay, poles, power, simplify, Context};

#[divan::bench(args = [Cloud::Ellipsoid, Cloud::Grid])]
fn samples(bencher: Bencher, cloud: Cloud) {
    let points = cloud.points();
    bencher
        .counter(ItemsCount::new(points.len()))
        .bench_local(|| delaunay::samples(&points, 5.0).unwrap());
}

#[divan::bench(args = [
    Cloud::Uniform, Cloud::Ellipsoid, Cloud::Torus, Cloud::Grid, Cloud::Cospherical, Cloud::Rounded,
])]
fn delaunay(bencher: Bencher, cloud: Cloud) {
    let samples = delaunay::samples(&cloud.points(), 5.0).unwrap();
    bencher
        .counter(ItemsCount::new(samples.len()))
        .bench_local(|| delaunay::delaunay(&samples, &Context::default()).unwrap());
}

#[divan::bench(args = [Cloud::Ellipsoid, Cloud::Torus])]
fn poles(bencher: Bencher, cloud: Cloud) {
    bencher
        .counter(ItemsCount::new(stages(cloud).samples.len()))
        .bench_local(|| all_poles(cloud));
}

#[divan::bench(args = [Cloud::Ellipsoid, Cloud::Torus])]
fn merge(bencher: Bencher, cloud: Cloud) {
    let (run, poles) = (stages(cloud), all_poles(cloud));
    bencher
        .with_inputs(|| poles.clone())
        .input_counter(|poles| ItemsCount::new(poles.balls.len()))
        .bench_local_values(|poles| {
            simplify::merge_redundant(
                &run.samples,
                &run.delaunay.edges(&Context::default()).unwrap(),
                poles,
                0.5,
                &Context::default(),
            )
        });
}

#[divan::bench(args = [Cloud::Ellipsoid, Cloud::Torus])]
fn power_merged(bencher: Bencher, cloud: Cloud) {
    power(bencher, &stages(cloud).poles);
}

/// About eight balls through every sample, as the paper has them (fact F1).
#[divan::bench]
fn power_unmerged(bencher: Bencher) {
    power(bencher, &all_poles(Cloud::Ellipsoid));
}

fn power(bencher: Bencher, poles: &Poles) {
    let balls = &poles.balls;
    let step = balls.lattice.step();
    bencher
        .counter(ItemsCount::new(balls.len()))
        .bench_local(|| power::power_diagram(&balls.sites, step, &Context::default()).unwrap());
}

fn all_poles(cloud: Cloud) -> Poles {
    let run = stages(cloud);
    let (options, context) = (PoleOptions::default(), Context::default());
    poles::poles(&run.samples, &run.delaunay, &options, &context).unwrap()
}
