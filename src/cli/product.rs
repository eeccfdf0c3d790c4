//! From the reconstruction to the mesh that is written: shells dropped,
//! triangles reduced, values attached.

use powercrust::geom::vec3::{add, cross, norm, scale, sub};
use powercrust::holes::{Filled, Holes, Loop};
use powercrust::io::{Attribute, AttributeValues, Cloud, MeshAttributes};
use powercrust::mesh::{decimate, deviation, DecimateError, Deviation};
use powercrust::surface::{filter_shells, Selection, Shells, NONE};
use powercrust::{Bounds, Context, Crust, Reconstruction};

use super::fail::{Code, Failure};
use super::plan::Plan;
use super::wanted::{self, Wanted, OWN};

/// Values of a column, owned.
enum Column {
    Byte(Vec<u8>),
    Int(Vec<i32>),
    Float(Vec<f64>),
}

impl Column {
    /// Whole numbers stay whole.
    fn of_numbers(values: Vec<f64>) -> Column {
        let whole = |v: &f64| *v == f64::from(*v as i32) && !(*v == 0.0 && v.is_sign_negative());
        match values.iter().all(whole) {
            true => Column::Int(values.iter().map(|&v| v as i32).collect()),
            false => Column::Float(values),
        }
    }

    fn select(&mut self, numbers: &[u32]) {
        fn pick<T: Copy>(values: &mut Vec<T>, numbers: &[u32]) {
            *values = numbers.iter().map(|&n| values[n as usize]).collect();
        }
        match self {
            Column::Byte(v) => pick(v, numbers),
            Column::Int(v) => pick(v, numbers),
            Column::Float(v) => pick(v, numbers),
        }
    }

    fn values(&self) -> AttributeValues<'_> {
        match self {
            Column::Byte(v) => AttributeValues::Byte(v),
            Column::Int(v) => AttributeValues::Int(v),
            Column::Float(v) => AttributeValues::Float(v),
        }
    }
}

/// What the mesh carries.
#[derive(Default)]
pub struct Carried {
    normals: Option<Vec<[f32; 3]>>,
    colours: Option<Vec<[u8; 4]>>,
    samples: Option<Vec<u32>>,
    vertices: Vec<(String, Column)>,
    faces: Vec<(String, Column)>,
}

impl Carried {
    /// The values that `wanted` asks for, at the vertices and faces of the
    /// whole crust.
    fn of(
        wanted: &Wanted,
        cloud: &Cloud,
        result: &Reconstruction,
        shells: &Shells,
    ) -> Result<Carried, Failure> {
        let mut out = Carried::default();
        if let Wanted::List(names) = wanted {
            let known =
                |name: &&String| OWN.contains(&name.as_str()) || scalar(cloud, name).is_some();
            if let Some(name) = names.iter().find(|n| !known(n)) {
                let columns = cloud.scalars.iter().map(|c| format!(", {}", c.name));
                return Err(Failure::usage(format!(
                    "--attributes {name}: the input has no such column"
                ))
                .hint(format!(
                    "known: {}{}",
                    OWN.join(", "),
                    columns.collect::<String>()
                )));
            }
            let missing = wanted.names("colours") && cloud.colours.is_none();
            if missing {
                return Err(
                    Failure::usage("--attributes colours: the input has no colours")
                        .hint("leave colours out"),
                );
            }
        }
        if wanted.wants("sample", true) {
            let point = |&s: &u32| match s {
                NONE => NONE,
                sample => result.sample_source[sample as usize],
            };
            out.samples = Some(result.crust.vertex_samples.iter().map(point).collect());
        }
        let scalars: Vec<_> = (cloud.scalars.iter())
            .filter(|c| !OWN.contains(&c.name.as_str()) && wanted.wants(&c.name, true))
            .collect();
        let normals = wanted.wants("normals", cloud.normals.is_some());
        let colours = (cloud.colours.as_ref()).filter(|_| wanted.wants("colours", true));
        if normals || colours.is_some() || !scalars.is_empty() {
            let sources = result.vertex_sources();
            out.colours = colours.map(|c| sources.colours(c));
            if normals {
                let own = result.vertex_normals();
                out.normals = Some(match &cloud.normals {
                    Some(given) => sources.normals(given, &own),
                    None => own,
                });
            }
            for column in scalars {
                let values = Column::of_numbers(sources.numbers(&column.values));
                out.vertices.push((column.name.clone(), values));
            }
        }
        if wanted.wants("thickness", false) {
            let column = Column::Float(result.vertex_thickness());
            out.vertices.push(("thickness".to_owned(), column));
        }
        let mut face = |name: &str, column: &dyn Fn() -> Column| {
            if wanted.wants(name, false) {
                out.faces.push((name.to_owned(), column()));
            }
        };
        face("thickness", &|| Column::Float(result.face_thickness()));
        face("gap", &|| Column::Float(result.face_gap()));
        face("polar_radii", &|| Column::Float(result.face_polar_radii()));
        face("doubt", &|| Column::Float(result.face_doubt()));
        face("component", &|| {
            Column::Int(shells.part_of_face.iter().map(|&p| p as i32).collect())
        });
        Ok(out)
    }

    fn select(&mut self, selection: &Selection) {
        if let Some(normals) = &mut self.normals {
            *normals = selection.of_vertices(normals);
        }
        if let Some(colours) = &mut self.colours {
            *colours = selection.of_vertices(colours);
        }
        if let Some(samples) = &mut self.samples {
            *samples = selection.of_vertices(samples);
        }
        for (_, column) in &mut self.vertices {
            column.select(&selection.vertices);
        }
        for (_, column) in &mut self.faces {
            column.select(&selection.faces);
        }
    }

    /// Takes the normals of these vertices, which moved, from the faces around.
    fn turn(&mut self, moved: &[u32], crust: &Crust) {
        let (Some(normals), false) = (&mut self.normals, moved.is_empty()) else {
            return;
        };
        let mut sums = vec![[0.0; 3]; moved.len()];
        for face in crust.mesh.faces() {
            let corners = face.iter().filter_map(|v| moved.binary_search(v).ok());
            let [a, b, c] = [0, 1, 2].map(|k| crust.mesh.vertices[face[k] as usize]);
            let area = cross(sub(b, a), sub(c, a));
            corners.for_each(|k| sums[k] = add(sums[k], area));
        }
        for (&v, sum) in moved.iter().zip(sums) {
            let length = norm(sum);
            if length > 0.0 && length.is_finite() {
                normals[v as usize] = scale(sum, 1.0 / length).map(|c| c as f32);
            }
        }
    }

    /// For the writers.
    pub fn attributes(&self) -> MeshAttributes<'_> {
        fn list(columns: &[(String, Column)]) -> Vec<Attribute<'_>> {
            columns
                .iter()
                .map(|(name, column)| Attribute {
                    name,
                    values: column.values(),
                })
                .collect()
        }
        MeshAttributes {
            normals: self.normals.as_deref(),
            colours: self.colours.as_deref(),
            samples: self.samples.as_deref(),
            vertices: list(&self.vertices),
            faces: list(&self.faces),
        }
    }
}

fn scalar<'a>(cloud: &'a Cloud, name: &str) -> Option<&'a str> {
    let column = cloud.scalars.iter().find(|c| c.name == name);
    column.map(|c| c.name.as_str())
}

/// What is written and what was done to it.
pub struct Product {
    pub carried: Carried,
    /// Parts and cavities before any were dropped.
    pub before: Shells,
    /// Parts and cavities written.
    pub shells: Shells,
    pub reduced: Option<Reduced>,
    /// Where nothing was sampled.
    pub holes: Holes,
    /// The border, if holes were left open.
    pub border: Option<Vec<Loop>>,
    /// What filling them came to, if they were to be filled.
    pub filled: Option<Filled>,
}

/// What reducing the triangles came to.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct Reduced {
    /// Triangles before.
    pub from: usize,
    /// Triangles asked for.
    pub asked: usize,
    /// Triangles left.
    pub faces: usize,
    /// Collapses not made because faces would have met.
    pub refused: u64,
    /// How far the surface moved.
    pub moved: Deviation,
}

/// Makes the crust of `result` what the plan asks for.
pub fn make(
    plan: &Plan,
    cloud: &Cloud,
    result: &mut Reconstruction,
    single: bool,
    context: &Context,
) -> Result<Product, Failure> {
    let before = Shells::of(&result.crust.mesh);
    let mut carried = Carried::of(&plan.attributes, cloud, result, &before)?;
    let mut shells = before.clone();
    if plan.shells != Default::default() {
        let (crust, selection) = filter_shells(&result.crust, &plan.shells);
        if crust.mesh.face_count() == 0 {
            let largest = before.part_volumes.first().copied().unwrap_or(0.0);
            return Err(Failure::new(
                Code::Unfit,
                "nothing is left: every part is smaller than --min-volume",
            )
            .hint(format!("the largest part encloses {largest}")));
        }
        carried.select(&selection);
        result.crust = crust;
        shells = Shells::of(&result.crust.mesh);
    }
    let diagonal = Bounds::of(&cloud.points).map_or(1.0, |b| b.diagonal());
    let mut holes = result.holes(plan.hole_size.of(diagonal));
    if plan.attributes.wants("hole", true) {
        carried
            .faces
            .push(("hole".to_owned(), Column::Byte(holes.flags())));
    }
    let reduced = match plan.fewer {
        None => None,
        Some(fewer) => {
            let asked = fewer.of(result.crust.mesh.face_count());
            let (selection, reduced) = reduce(&mut result.crust, asked, context)?;
            carried.select(&selection);
            holes.select(&selection);
            Some(reduced)
        }
    };
    let mut filled = None;
    let border = match plan.holes {
        wanted::Holes::Keep => None,
        wanted::Holes::Fill => {
            let taut = holes.fill(&mut result.crust, single, context);
            let taut = taut.map_err(|_| Failure::interrupted())?;
            carried.turn(&taut.vertices, &result.crust);
            shells = Shells::of(&result.crust.mesh);
            filled = Some(taut);
            None
        }
        wanted::Holes::Open => {
            let opened = holes.open(&result.crust);
            if opened.crust.mesh.face_count() == 0 {
                return Err(Failure::new(
                    Code::Unfit,
                    "nothing is left: every face bridges missing data",
                )
                .hint("raise --hole-size, or leave --holes open out"));
            }
            carried.select(&opened.selection);
            result.crust = opened.crust;
            Some(opened.loops)
        }
    };
    Ok(Product {
        holes,
        border,
        filled,
        carried,
        before,
        shells,
        reduced,
    })
}

/// Reduces the triangles of the crust.
fn reduce(
    crust: &mut Crust,
    asked: usize,
    context: &Context,
) -> Result<(Selection, Reduced), Failure> {
    let fewer = decimate(&crust.mesh, asked, context).map_err(|error| match error {
        DecimateError::Cancelled => Failure::interrupted(),
        other => Failure::new(Code::Unfit, format!("the mesh cannot be reduced: {other}"))
            .hint("leave --faces and --reduce out; please report this with the input"),
    })?;
    let moved = deviation(&crust.mesh, &fewer.mesh, context).map_err(|_| Failure::interrupted())?;
    let reduced = Reduced {
        from: crust.mesh.face_count(),
        asked,
        faces: fewer.mesh.face_count(),
        refused: fewer.refused,
        moved,
    };
    let selection = Selection {
        vertices: fewer.vertices,
        faces: fewer.faces,
    };
    *crust = Crust {
        vertex_samples: selection.of_vertices(&crust.vertex_samples),
        face_balls: selection.of_faces(&crust.face_balls),
        mesh: fewer.mesh,
    };
    Ok((selection, reduced))
}
