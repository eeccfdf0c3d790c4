//! PLY files, in memory: the disk is left out.

use crate::clouds::{stages, Cloud};
use divan::counter::BytesCount;
use divan::Bencher;
use powercrust::io::{self, CloudFormat, MeshAttributes, MeshFormat, ReadOptions, WriteOptions};
use powercrust::surface::{clean, triangulate, CleanOptions};
use powercrust::PolygonMesh;

/// Binary and text.
const KINDS: [&str; 2] = ["binary", "text"];

#[divan::bench(args = KINDS)]
fn write_ply(bencher: Bencher, kind: &str) {
    let mesh = mesh();
    let size = file(&mesh, kind).len();
    bencher
        .counter(BytesCount::new(size))
        .bench_local(|| file(&mesh, kind));
}

#[divan::bench(args = KINDS)]
fn read_ply(bencher: Bencher, kind: &str) {
    let bytes = file(&mesh(), kind);
    bencher
        .counter(BytesCount::new(bytes.len()))
        .bench_local(|| io::read_mesh(&bytes, MeshFormat::Ply).unwrap());
}

#[divan::bench(args = KINDS)]
fn read_ply_points(bencher: Bencher, kind: &str) {
    let bytes = file(&PolygonMesh::with_vertices(mesh().vertices), kind);
    let options = ReadOptions::default();
    bencher
        .counter(BytesCount::new(bytes.len()))
        .bench_local(|| io::read_cloud(&bytes, CloudFormat::Ply, &options).unwrap());
}

fn mesh() -> PolygonMesh {
    let run = stages(Cloud::Ellipsoid);
    let raw = run.raw(&run.labels.sides);
    triangulate(&clean(raw, &CleanOptions::default())).mesh
}

fn file(mesh: &PolygonMesh, kind: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    let options = WriteOptions {
        ascii: kind == "text",
        ..WriteOptions::default()
    };
    let attributes = MeshAttributes::default();
    io::write_mesh(&mut bytes, MeshFormat::Ply, mesh, &attributes, &options).unwrap();
    bytes
}
