//! Draws a mesh, a medial axis or a point cloud into a PNG, without a GPU.
//!
//! ```sh
//! cargo run --release --example render -- crust.ply crust.png
//! cargo run --release --example render -- crust.ply axis.png --axis axis.ma
//! cargo run --release --example render -- points.xyz points.png
//! ```
//!
//! The camera follows from the shape: its longest principal axis lies across
//! the picture, the next one upward, and the viewer looks from the right and
//! above, in parallel projection. A file without faces is drawn as dots. With
//! `--axis` the surface becomes a translucent shell around the axis; with
//! `--like FILE` the camera is the one that FILE would have. Surface seen from
//! behind is drawn red, so that a hole or a flipped face shows. The same input
//! gives the same bytes.

use std::error::Error;
use std::path::{Path, PathBuf};

use powercrust::io::{read_axis, read_cloud, AxisFormat, CloudFormat, MeshFormat, ReadOptions};
use powercrust::{Point, PolygonMesh};

/// Samples per pixel in each direction.
const FINE: usize = 2;
/// Faces meeting at less than this angle look smooth.
const CREASE_COS: f64 = 0.8;

type Colour = [f64; 3];
const PAPER: Colour = [1.0, 1.0, 1.0];
const FRONT: Colour = [0.42, 0.55, 0.68];
const BACK: Colour = [0.75, 0.16, 0.10];
const AXIS: Colour = [0.85, 0.42, 0.08];
const DOT: Colour = [0.16, 0.25, 0.36];

struct Arguments {
    mesh: PathBuf,
    picture: PathBuf,
    axis: Option<PathBuf>,
    like: Option<PathBuf>,
    size: [usize; 2],
    flat: bool,
    turn: f64,
    tilt: f64,
}

const USAGE: &str =
    "usage: render MESH PICTURE.png [--axis FILE] [--like FILE] [--size WIDTHxHEIGHT] [--flat] \
                     [--turn DEGREES] [--tilt DEGREES]";

fn arguments() -> Result<Arguments, Box<dyn Error>> {
    let mut found = Arguments {
        mesh: PathBuf::new(),
        picture: PathBuf::new(),
        axis: None,
        like: None,
        size: [1200, 900],
        flat: false,
        turn: 35.0,
        tilt: 25.0,
    };
    let mut places = Vec::new();
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value\n{USAGE}"));
        match word.as_str() {
            "--axis" => found.axis = Some(value()?.into()),
            "--like" => found.like = Some(value()?.into()),
            "--size" => {
                let text = value()?;
                let (w, h) = text.split_once('x').ok_or("--size is WIDTHxHEIGHT")?;
                found.size = [w.parse()?, h.parse()?];
                if found.size.iter().any(|&s| s == 0 || s > 10_000) {
                    return Err("--size: 1 to 10000 each way".into());
                }
            }
            "--flat" => found.flat = true,
            "--turn" => found.turn = value()?.parse()?,
            "--tilt" => found.tilt = value()?.parse()?,
            _ if word.starts_with("--") => return Err(format!("unknown {word}\n{USAGE}").into()),
            _ => places.push(word),
        }
    }
    match <[String; 2]>::try_from(places) {
        Ok([mesh, picture]) => {
            found.mesh = mesh.into();
            found.picture = picture.into();
            Ok(found)
        }
        Err(_) => Err(USAGE.into()),
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = arguments()?;
    let mesh = read_mesh(&arguments.mesh)?;
    let camera = match &arguments.like {
        Some(path) => Camera::new(&read_mesh(path)?.vertices, &arguments)?,
        None => Camera::new(&mesh.vertices, &arguments)?,
    };
    let mut picture = Layer::new(arguments.size);
    match &arguments.axis {
        Some(path) => {
            draw_axis(&mut picture, &camera, path)?;
            let mut shell = Layer::new(arguments.size);
            draw_surface(&mut shell, &camera, &mesh, arguments.flat, [FRONT, FRONT]);
            picture.cover(&shell, 0.25);
        }
        None if mesh.face_count() == 0 => {
            for &vertex in &mesh.vertices {
                picture.dot(camera.project(vertex), 2.2, DOT);
            }
        }
        None => draw_surface(&mut picture, &camera, &mesh, arguments.flat, [FRONT, BACK]),
    }
    picture.save(&arguments.picture)
}

// ---------------------------------------------------------------- vectors

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn unit(a: Point) -> Point {
    let length = dot(a, a).sqrt();
    if length > 0.0 {
        a.map(|x| x / length)
    } else {
        a
    }
}

// ----------------------------------------------------------------- camera

/// Parallel projection: rows are right, up and toward the viewer.
struct Camera {
    axes: [Point; 3],
    centre: Point,
    scale: f64,
    middle: [f64; 2],
}

impl Camera {
    fn new(points: &[Point], arguments: &Arguments) -> Result<Camera, Box<dyn Error>> {
        if points.is_empty() {
            return Err("nothing to draw: the file has no vertices".into());
        }
        let count = points.len() as f64;
        let centre = [0, 1, 2].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / count);
        let principal = principal_axes(points, centre);
        let (turn, tilt) = (arguments.turn.to_radians(), arguments.tilt.to_radians());
        let blend = |a: f64, x: Point, b: f64, y: Point| [0, 1, 2].map(|k| a * x[k] + b * y[k]);
        let right = blend(turn.cos(), principal[0], -turn.sin(), principal[2]);
        let ahead = blend(turn.sin(), principal[0], turn.cos(), principal[2]);
        let up = blend(tilt.cos(), principal[1], -tilt.sin(), ahead);
        let toward = blend(tilt.sin(), principal[1], tilt.cos(), ahead);
        let mut camera = Camera {
            axes: [right, up, toward],
            centre,
            scale: 1.0,
            middle: [0.0, 0.0],
        };
        // Fill nine tenths of the picture.
        let size = arguments.size.map(|s| (s * FINE) as f64);
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for &point in points {
            let at = camera.project(point);
            for k in 0..2 {
                low[k] = low[k].min(at[k]);
                high[k] = high[k].max(at[k]);
            }
        }
        let span = [0, 1].map(|k| (high[k] - low[k]).max(f64::MIN_POSITIVE));
        camera.scale = (0.9 * size[0] / span[0]).min(0.9 * size[1] / span[1]);
        camera.middle = [0, 1].map(|k| 0.5 * (size[k] - camera.scale * (low[k] + high[k])));
        Ok(camera)
    }

    /// Pixel column, pixel row, and height toward the viewer in pixels.
    fn project(&self, point: Point) -> Point {
        let [x, y, z] = self.axes.map(|axis| dot(axis, sub(point, self.centre)));
        [
            self.middle[0] + self.scale * x,
            self.middle[1] - self.scale * y,
            self.scale * z,
        ]
    }

    /// A direction in the viewer's frame.
    fn turn(&self, direction: Point) -> Point {
        self.axes.map(|axis| dot(axis, direction))
    }
}

/// Unit eigenvectors of the covariance, longest first, right-handed; each
/// points to the side where the shape reaches further (by third moments).
fn principal_axes(points: &[Point], centre: Point) -> [Point; 3] {
    let mut m = [[0.0; 3]; 3];
    for &point in points {
        let d = sub(point, centre);
        for i in 0..3 {
            for j in 0..3 {
                m[i][j] += d[i] * d[j];
            }
        }
    }
    // Jacobi rotations; column k of `v` is the k-th eigenvector.
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..30 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if m[p][q] == 0.0 {
                continue;
            }
            let theta: f64 = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for row in &mut m {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            let (old_p, old_q) = (m[p], m[q]);
            m[p] = [0, 1, 2].map(|k| c * old_p[k] - s * old_q[k]);
            m[q] = [0, 1, 2].map(|k| s * old_p[k] + c * old_q[k]);
            for row in &mut v {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| m[b][b].total_cmp(&m[a][a]));
    let column = |k: usize| -> Point {
        let axis = [v[0][k], v[1][k], v[2][k]];
        let skew: f64 = points
            .iter()
            .map(|&p| dot(axis, sub(p, centre)).powi(3))
            .sum();
        if skew < 0.0 {
            axis.map(|x| -x)
        } else {
            axis
        }
    };
    let (first, second) = (column(order[0]), column(order[1]));
    [first, second, cross(first, second)]
}

// ------------------------------------------------------------------ layer

/// Colours in linear light with depth, `FINE` times finer than the picture.
struct Layer {
    size: [usize; 2],
    colours: Vec<[f32; 3]>,
    depths: Vec<f32>,
}

impl Layer {
    fn new(size: [usize; 2]) -> Layer {
        let size = size.map(|s| s * FINE);
        let count = size[0] * size[1];
        Layer {
            size,
            colours: vec![PAPER.map(|c| c as f32); count],
            depths: vec![f32::NEG_INFINITY; count],
        }
    }

    fn set(&mut self, at: usize, depth: f64, colour: Colour) {
        if depth as f32 > self.depths[at] {
            self.depths[at] = depth as f32;
            self.colours[at] = colour.map(|c| c as f32);
        }
    }

    /// Pixels of row or column numbers `low..high` that may be touched.
    fn range(limit: usize, low: f64, high: f64) -> std::ops::Range<usize> {
        let clamp = |x: f64| x.clamp(0.0, limit as f64) as usize;
        clamp(low.floor())..clamp(high.ceil() + 1.0)
    }

    /// A triangle with a normal in the viewer's frame at each corner.
    fn triangle(&mut self, corners: [Point; 3], normals: [Point; 3], sides: [Colour; 2]) {
        let [a, b, c] = corners;
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area == 0.0 {
            return;
        }
        // Rows run downward, so a face seen from the front has area < 0.
        let colour = if area < 0.0 { sides[0] } else { sides[1] };
        let extent = |k: usize| {
            let (low, high) = (a[k].min(b[k]).min(c[k]), a[k].max(b[k]).max(c[k]));
            Layer::range(self.size[k], low, high)
        };
        let columns = extent(0);
        for row in extent(1) {
            let y = row as f64 + 0.5;
            for column in columns.clone() {
                let x = column as f64 + 0.5;
                let u = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / area;
                let v = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / area;
                let w = 1.0 - u - v;
                if u < 0.0 || v < 0.0 || w < 0.0 {
                    continue;
                }
                let depth = u * a[2] + v * b[2] + w * c[2];
                let at = row * self.size[0] + column;
                if depth as f32 > self.depths[at] {
                    let mix = |k: usize| u * normals[0][k] + v * normals[1][k] + w * normals[2][k];
                    let normal = unit([mix(0), mix(1), mix(2)]);
                    self.set(at, depth, shade(normal, colour));
                }
            }
        }
    }

    /// A ball of the given radius in fine pixels.
    fn dot(&mut self, centre: Point, radius: f64, colour: Colour) {
        for row in Layer::range(self.size[1], centre[1] - radius, centre[1] + radius) {
            for column in Layer::range(self.size[0], centre[0] - radius, centre[0] + radius) {
                let x = (column as f64 + 0.5 - centre[0]) / radius;
                let y = (centre[1] - row as f64 - 0.5) / radius;
                let zz = 1.0 - x * x - y * y;
                if zz > 0.0 {
                    let normal = [x, y, zz.sqrt()];
                    let at = row * self.size[0] + column;
                    self.set(at, centre[2] + radius * normal[2], shade(normal, colour));
                }
            }
        }
    }

    /// A line as a row of small balls.
    fn line(&mut self, a: Point, b: Point, colour: Colour) {
        let steps = (a[0] - b[0]).hypot(a[1] - b[1]).ceil().clamp(1.0, 30_000.0);
        for step in 0..=steps as usize {
            let t = step as f64 / steps;
            self.dot([0, 1, 2].map(|k| a[k] + t * (b[k] - a[k])), 1.0, colour);
        }
    }

    /// Lays a translucent layer over this one.
    fn cover(&mut self, shell: &Layer, strength: f32) {
        for (at, colour) in self.colours.iter_mut().enumerate() {
            if shell.depths[at] > f32::NEG_INFINITY {
                for (c, over) in colour.iter_mut().zip(shell.colours[at]) {
                    *c += strength * (over - *c);
                }
            }
        }
    }

    fn save(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        let [width, height] = self.size.map(|s| s / FINE);
        let mut bytes = Vec::with_capacity(3 * width * height);
        for row in 0..height {
            for column in 0..width {
                for k in 0..3 {
                    let mut sum = 0.0;
                    for i in 0..FINE * FINE {
                        let fine =
                            (row * FINE + i / FINE) * self.size[0] + column * FINE + i % FINE;
                        sum += self.colours[fine][k];
                    }
                    let linear = (sum / (FINE * FINE) as f32).clamp(0.0, 1.0);
                    bytes.push((255.0 * linear.powf(1.0 / 2.2)).round() as u8);
                }
            }
        }
        let file = std::io::BufWriter::new(std::fs::File::create(path)?);
        let mut encoder = png::Encoder::new(file, width as u32, height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&bytes)?;
        Ok(writer.finish()?)
    }
}

/// Light from the upper left and a weaker one from the right; either side of
/// a surface is lit.
fn shade(normal: Point, colour: Colour) -> Colour {
    let normal = if normal[2] < 0.0 {
        normal.map(|x| -x)
    } else {
        normal
    };
    let key = dot(normal, [-0.48, 0.64, 0.6]).max(0.0);
    let fill = dot(normal, [0.8, 0.0, 0.6]).max(0.0);
    let shine = dot(normal, [-0.27, 0.36, 0.89]).max(0.0).powi(40);
    let light = 0.10 + 0.80 * key + 0.22 * fill;
    colour.map(|c| c * light + 0.10 * shine)
}

// ------------------------------------------------------------------ scene

/// Faces are fanned from their first corner (those of a crust are convex).
fn draw_surface(
    layer: &mut Layer,
    camera: &Camera,
    mesh: &PolygonMesh,
    flat: bool,
    sides: [Colour; 2],
) {
    let at = |i: u32| mesh.vertices[i as usize];
    // Twice the vector area of each face, about its first corner.
    let areas: Vec<Point> = mesh
        .faces()
        .map(|face| {
            let mut sum = [0.0; 3];
            for pair in face.windows(2).skip(1) {
                let part = cross(sub(at(pair[0]), at(face[0])), sub(at(pair[1]), at(face[0])));
                sum = [0, 1, 2].map(|k| sum[k] + part[k]);
            }
            sum
        })
        .collect();
    let directions: Vec<Point> = areas.iter().map(|&area| unit(area)).collect();
    let mut around = vec![Vec::new(); mesh.vertices.len()];
    for (f, face) in mesh.faces().enumerate() {
        for &vertex in face {
            around[vertex as usize].push(f as u32);
        }
    }
    for (f, face) in mesh.faces().enumerate() {
        let normal = |vertex: u32| -> Point {
            if flat {
                return camera.turn(directions[f]);
            }
            let mut sum = [0.0; 3];
            for &g in &around[vertex as usize] {
                if dot(directions[f], directions[g as usize]) > CREASE_COS {
                    sum = [0, 1, 2].map(|k| sum[k] + areas[g as usize][k]);
                }
            }
            camera.turn(unit(sum))
        };
        for pair in face.windows(2).skip(1) {
            let corners = [face[0], pair[0], pair[1]];
            layer.triangle(
                corners.map(|i| camera.project(at(i))),
                corners.map(normal),
                sides,
            );
        }
    }
}

/// Sheets of the axis as surface, its curves as lines, lone balls as dots.
fn draw_axis(layer: &mut Layer, camera: &Camera, path: &Path) -> Result<(), Box<dyn Error>> {
    let format = AxisFormat::from_extension(extension(path)).ok_or("unknown axis format")?;
    let shape = read_axis(&std::fs::read(path)?, format)?;
    let mut sheets =
        PolygonMesh::with_vertices(shape.balls.iter().map(|ball| ball.centre).collect());
    let mut in_triangle = Vec::with_capacity(3 * shape.triangles.len());
    let mut alone = vec![true; shape.balls.len()];
    for &[a, b, c] in &shape.triangles {
        sheets.push_face(&[a, b, c]);
        in_triangle.extend([[a, b], [b, c], [a, c]]);
    }
    draw_surface(layer, camera, &sheets, true, [AXIS, AXIS]);
    in_triangle.sort_unstable();
    let at = |ball: u32| camera.project(shape.balls[ball as usize].centre);
    for edge in &shape.edges {
        let [a, b] = *edge;
        (alone[a as usize], alone[b as usize]) = (false, false);
        if in_triangle.binary_search(edge).is_err() {
            layer.line(at(a), at(b), AXIS);
        }
    }
    for ball in (0..shape.balls.len() as u32).filter(|&ball| alone[ball as usize]) {
        layer.dot(at(ball), 2.2, AXIS);
    }
    Ok(())
}

fn extension(path: &Path) -> &str {
    path.extension().and_then(|e| e.to_str()).unwrap_or("")
}

/// A mesh, or points as a mesh without faces.
fn read_mesh(path: &Path) -> Result<PolygonMesh, Box<dyn Error>> {
    let bytes = std::fs::read(path)?;
    if let Some(format) = MeshFormat::from_extension(extension(path)) {
        return Ok(powercrust::io::read_mesh(&bytes, format)?);
    }
    let format =
        CloudFormat::from_extension(extension(path)).unwrap_or_else(|| CloudFormat::sniff(&bytes));
    let cloud = read_cloud(&bytes, format, &ReadOptions { skip_invalid: true })?;
    Ok(PolygonMesh::with_vertices(cloud.points))
}
