//! From the power diagram to the judged mesh.

use crate::clouds::{stages, Cloud};
use crate::run::Run;
use divan::counter::ItemsCount;
use divan::Bencher;
use powercrust::label::{hold, label, refine, LabelOptions, Neighbours, MOST_UNHELD};
use powercrust::mesh::{check, CheckOptions, Surface};
use powercrust::surface::{self, mend_crust, CleanOptions, Crust, MendOptions};
use powercrust::{reconstruct, Context, Options, Point, PolygonMesh};

const SURFACES: [Cloud; 2] = [Cloud::Ellipsoid, Cloud::Torus];

#[divan::bench(args = SURFACES)]
fn neighbours(bencher: Bencher, cloud: Cloud) {
    let run = stages(cloud);
    bencher
        .counter(balls(run))
        .bench_local(|| Neighbours::of(&run.power, &Context::default()));
}

/// Beliefs by the queue, and the flips after it.
#[divan::bench(args = SURFACES)]
fn labels(bencher: Bencher, cloud: Cloud) {
    let run = stages(cloud);
    let how = LabelOptions::default();
    bencher.counter(balls(run)).bench_local(|| {
        let evidence = run.evidence();
        let mut labels = label(&evidence, &run.neighbours, &how, &Context::default()).unwrap();
        refine(&evidence, &run.neighbours, &mut labels, &how);
        labels
    });
}

#[divan::bench]
fn hold_samples(bencher: Bencher) {
    let run = stages(Cloud::Block);
    bencher
        .counter(balls(run))
        .with_inputs(|| {
            (
                run.poles.balls.clone(),
                run.power.clone(),
                run.labels.clone(),
            )
        })
        .bench_local_values(|(mut balls, mut power, mut labels)| {
            let context = Context::default();
            let most = MOST_UNHELD;
            hold(
                &run.delaunay,
                &mut balls,
                &mut power,
                &mut labels,
                most,
                &context,
            )
            .unwrap();
            (balls, power, labels)
        });
}

#[divan::bench(args = SURFACES)]
fn raw_crust(bencher: Bencher, cloud: Cloud) {
    let run = stages(cloud);
    bencher
        .counter(balls(run))
        .bench_local(|| run.raw(&run.labels.sides));
}

#[divan::bench(args = SURFACES)]
fn clean(bencher: Bencher, cloud: Cloud) {
    let run = stages(cloud);
    let raw = run.raw(&run.labels.sides);
    bencher
        .with_inputs(|| raw.clone())
        .input_counter(|raw| ItemsCount::new(raw.balls.len()))
        .bench_local_values(|raw| surface::clean(raw, &CleanOptions::default()));
}

#[divan::bench(args = SURFACES)]
fn triangulate(bencher: Bencher, cloud: Cloud) {
    let crust = polygons(stages(cloud));
    bencher
        .counter(faces(&crust.mesh))
        .bench_local(|| surface::triangulate(&crust));
}

/// Coarsening, and the search for crossings and what mends them.
#[divan::bench(args = SURFACES)]
fn mend(bencher: Bencher, cloud: Cloud) {
    let run = stages(cloud);
    let crust = surface::triangulate(&polygons(run));
    let how = MendOptions {
        handles: None,
        flatness: Options::default().flatness,
        tolerance: None,
        single: false,
        keep_samples: false,
        spacing: &|s| run.spacing[s as usize],
        ball: &|b| run.balls.get(b as usize).copied(),
    };
    bencher
        .with_inputs(|| crust.clone())
        .input_counter(|crust| faces(&crust.mesh))
        .bench_local_values(|crust| mend_crust(crust, &how, &Context::default()).unwrap());
}

#[divan::bench(args = SURFACES)]
fn check_mesh(bencher: Bencher, cloud: Cloud) {
    let mesh = surface::triangulate(&polygons(stages(cloud))).mesh;
    bencher
        .counter(faces(&mesh))
        .bench_local(|| check(&mesh, &CheckOptions::default(), &Context::default()).unwrap());
}

/// From a point beside each vertex, the tree of the surface included.
#[divan::bench(args = SURFACES)]
fn distances(bencher: Bencher, cloud: Cloud) {
    let mesh = surface::triangulate(&polygons(stages(cloud))).mesh;
    let beside: Vec<Point> = (mesh.vertices.iter())
        .map(|p| p.map(|x| x * 1.01))
        .collect();
    bencher
        .counter(ItemsCount::new(beside.len()))
        .bench_local(|| {
            let surface = Surface::new(&mesh);
            surface.distances(&beside, &Context::default()).unwrap()
        });
}

#[divan::bench(args = SURFACES)]
fn whole(bencher: Bencher, cloud: Cloud) {
    let points = cloud.points();
    bencher
        .counter(ItemsCount::new(points.len()))
        .bench_local(|| reconstruct(&points, &Options::default(), &Context::default()).unwrap());
}

fn polygons(run: &Run) -> Crust {
    surface::clean(run.raw(&run.labels.sides), &CleanOptions::default())
}

fn balls(run: &Run) -> ItemsCount {
    ItemsCount::new(run.balls.len())
}

fn faces(mesh: &PolygonMesh) -> ItemsCount {
    ItemsCount::new(mesh.face_count())
}
