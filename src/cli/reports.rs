//! What a run left out, as PLY files of points: samples that are outliers, poles
//! that were dropped.

use std::io::Write;

use powercrust::io::{
    write_mesh, Attribute, AttributeValues, Cloud, MeshAttributes, MeshFormat, WriteError,
    WriteOptions,
};
use powercrust::mesh::PolygonMesh;
use powercrust::noise::Stray;
use powercrust::poles::{DroppedPole, Reason};
use powercrust::{Point, Reconstruction};

/// The samples left out, with the number of each in the input and why.
pub fn outliers(
    out: &mut dyn Write,
    result: &Reconstruction,
    cloud: &Cloud,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    let places = result.outliers.iter().map(|o| cloud.points[o.0 as usize]);
    let points: Vec<i32> = result.outliers.iter().map(|o| o.0 as i32).collect();
    let reason = |why: Stray| match why {
        Stray::Floating => 0,
        Stray::Beside => 1,
    };
    let reasons: Vec<u8> = result.outliers.iter().map(|o| reason(o.1)).collect();
    let values = vec![
        ("point", AttributeValues::Int(&points)),
        ("reason", AttributeValues::Byte(&reasons)),
    ];
    write(out, places.collect(), values, options)
}

/// The poles dropped: where they lie, of which input points they were, and why they went.
pub fn dropped(
    out: &mut dyn Write,
    poles: &[DroppedPole],
    source: &[u32],
    options: &WriteOptions,
) -> Result<(), WriteError> {
    let points: Vec<i32> = (poles.iter())
        .map(|p| source[p.sample as usize] as i32)
        .collect();
    let which: Vec<u8> = poles.iter().map(|p| p.pole).collect();
    let radii: Vec<f64> = poles.iter().map(|p| p.radius).collect();
    let bounds: Vec<f64> = poles.iter().map(|p| p.bound).collect();
    let reason = |why: Reason| match why {
        Reason::Skinny => 0,
        Reason::Sharp => 1,
        Reason::Corner => 2,
    };
    let reasons: Vec<u8> = poles.iter().map(|p| reason(p.reason)).collect();
    let values = vec![
        ("point", AttributeValues::Int(&points)),
        ("pole", AttributeValues::Byte(&which)),
        ("radius", AttributeValues::Float(&radii)),
        ("bound", AttributeValues::Float(&bounds)),
        ("reason", AttributeValues::Byte(&reasons)),
    ];
    write(
        out,
        poles.iter().map(|p| p.centre).collect(),
        values,
        options,
    )
}

/// Points with a value of each kind, as PLY without faces.
fn write(
    mut out: &mut dyn Write,
    vertices: Vec<Point>,
    values: Vec<(&str, AttributeValues)>,
    options: &WriteOptions,
) -> Result<(), WriteError> {
    let points = PolygonMesh {
        vertices,
        ..PolygonMesh::default()
    };
    let named = values.into_iter();
    let values = MeshAttributes {
        vertices: named
            .map(|(name, values)| Attribute { name, values })
            .collect(),
        ..MeshAttributes::default()
    };
    write_mesh(&mut out, MeshFormat::Ply, &points, &values, options)
}
