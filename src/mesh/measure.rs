//! Sizes of a mesh in floating point: volumes, areas, angles.

use super::frame::Frame;
use super::soup::{place, Faces, Triangles};
use super::topology::Topology;
use super::wide::Sum;
use super::PolygonMesh;
use crate::geom::vec3::plain::{dot, larger, norm, norm_sq};
use crate::geom::vec3::{cross, sub};
use crate::geom::{Bounds, Point};
use rayon::prelude::*;

/// Volume and area of a set of faces.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Size {
    pub volume: f64,
    pub area: f64,
}

/// The shape of triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Shape {
    /// The smallest angle of a triangle, in degrees; `None` for no triangles.
    pub smallest_angle: Option<f64>,
    /// Triangles by longest side over height (1.15 for equilateral ones): up
    /// to 2, 4, 10, 100, 1000, 10 000, and the rest.
    pub aspects: [u64; 7],
}

/// The largest aspect of each class but the last.
const ASPECTS: [f64; 6] = [2.0, 4.0, 10.0, 100.0, 1e3, 1e4];

/// Volume and area of each of `count` sets of faces, `label` telling the set
/// of a face, in the units of [`Frame::enter_sizes`]: in the mesh's a volume
/// may be out of range and lose its sign. Volumes are taken about `origin`.
pub(super) fn sizes(
    points: &[Point],
    origin: Point,
    frame: &Frame,
    triangles: &Triangles,
    label: &[u32],
    count: usize,
) -> Vec<Size> {
    let mut sizes = vec![Size::default(); count];
    // Bounds of what the terms of each volume may be off by, over epsilon.
    let mut doubts = vec![(0.0, 0.0); count];
    let origin = frame.enter_sizes(origin);
    for (&t, &f) in triangles.corners.iter().zip(&triangles.face) {
        let [a, b, c] = place(points, t).map(|p| sub(frame.enter_sizes(p), origin));
        let normal = cross(sub(b, a), sub(c, a));
        let size = &mut sizes[label[f as usize] as usize];
        size.volume += dot(a, normal) / 6.0;
        size.area += norm(normal) / 2.0;
        let (terms, count) = &mut doubts[label[f as usize] as usize];
        *terms += norm(a) * norm(sub(b, a)) * norm(sub(c, a));
        *count += 1.0;
    }
    settle(points, frame, triangles, label, &doubts, &mut sizes);
    sizes
}

/// Sums volumes again, exactly, that are not far larger than what they may be
/// off by: their terms cancel in thin and in tiny shells.
fn settle(
    points: &[Point],
    frame: &Frame,
    triangles: &Triangles,
    label: &[u32],
    doubts: &[(f64, f64)],
    sizes: &mut [Size],
) {
    let doubtful: Vec<bool> = (sizes.iter().zip(doubts))
        .map(|(size, &(terms, count))| {
            let bound = (count + 16.0) * f64::EPSILON * terms;
            // Fewer than four triangles enclose nothing.
            count > 3.0 && size.volume.is_finite() && size.volume.abs() <= 1e3 * bound
        })
        .collect();
    let shell = |t: u32| label[triangles.face[t as usize] as usize];
    let mut some: Vec<u32> = (0..triangles.corners.len() as u32)
        .filter(|&t| doubtful[shell(t) as usize])
        .collect();
    some.sort_by_key(|&t| shell(t));
    for run in some.chunk_by(|&t, &u| shell(t) == shell(u)) {
        let mut sum = Sum::new();
        for &t in run {
            sum.add_det(place(points, triangles.corners[t as usize]));
        }
        let volume = sum.value(frame.volume_unit()) / 6.0;
        // A sixth of the smallest number there is would be zero.
        sizes[shell(run[0]) as usize].volume = match (volume, sum.sign()) {
            (0.0, sign @ (-1 | 1)) => f64::from_bits(1).copysign(f64::from(sign)),
            _ => volume,
        };
    }
}

/// Smallest angle and the histogram of aspects of all triangles.
pub(super) fn shape(points: &[Point], frame: &Frame, triangles: &Triangles) -> Shape {
    let place = |t: &[u32; 3]| place(points, *t).map(|p| frame.enter_sizes(p));
    (triangles.corners.par_iter())
        .fold(Shape::default, |shape, t| shape.and(place(t)))
        .reduce(Shape::default, Shape::or)
}

impl Shape {
    /// The shape of the triangles of a mesh that has no other faces and lies
    /// where squares of lengths are in the range of doubles.
    pub(crate) fn of_triangles(mesh: &PolygonMesh) -> Shape {
        let at = |v: u32| mesh.vertices[v as usize];
        (mesh.corners.par_chunks_exact(3))
            .fold(Shape::default, |shape, t| {
                shape.and([at(t[0]), at(t[1]), at(t[2])])
            })
            .reduce(Shape::default, Shape::or)
    }

    /// With one more triangle.
    fn and(mut self, [a, b, c]: [Point; 3]) -> Shape {
        let sides = [sub(c, b), sub(a, c), sub(b, a)];
        let squares = sides.map(norm_sq);
        let doubled = norm(cross(sides[1], sides[2]));
        let aspect = larger(larger(squares[0], squares[1]), squares[2]) / doubled;
        let class = ASPECTS.iter().position(|&most| aspect <= most);
        self.aspects[class.unwrap_or(ASPECTS.len())] += 1;
        // The smallest angle lies between the two longer sides.
        let shortest = (1..3).fold(0, |k, j| if squares[j] < squares[k] { j } else { k });
        let cosine = dot(sides[(shortest + 1) % 3], sides[(shortest + 2) % 3]).abs();
        let angle = doubled.atan2(cosine).to_degrees();
        let least = self.smallest_angle.map_or(angle, |least| least.min(angle));
        self.smallest_angle = Some(least);
        self
    }

    /// Of both together.
    fn or(mut self, other: Shape) -> Shape {
        let angles = [self.smallest_angle, other.smallest_angle];
        self.smallest_angle = angles.into_iter().flatten().reduce(f64::min);
        for (count, more) in self.aspects.iter_mut().zip(other.aspects) {
            *count += more;
        }
        self
    }
}

/// The middle of the box of the vertices that are finite.
pub(super) fn middle(bounds: &Option<Bounds>) -> Point {
    match bounds {
        Some(b) => std::array::from_fn(|k| b.min[k] / 2.0 + b.max[k] / 2.0),
        None => [0.0; 3],
    }
}

/// The box of the finite ones among some points.
pub(super) fn finite_bounds<'a>(points: impl Iterator<Item = &'a Point>) -> Option<Bounds> {
    let mut bounds: Option<Bounds> = None;
    for &p in points.filter(|p| p.iter().all(|x| x.is_finite())) {
        let b = bounds.get_or_insert(Bounds { min: p, max: p });
        for (k, x) in p.into_iter().enumerate() {
            b.min[k] = b.min[k].min(x);
            b.max[k] = b.max[k].max(x);
        }
    }
    bounds
}

/// The shells of a mesh, faces joined by shared edges: a label for each face,
/// numbered by first face, and the number of shells. Faces that cannot be
/// walked (see [`super::Finding::IndexOutOfRange`]) have the label `u32::MAX`.
///
/// ```
/// use powercrust::mesh::{components, PolygonMesh};
/// let mut mesh = PolygonMesh::with_vertices(vec![[0.0; 3]; 6]);
/// mesh.push_face(&[0, 1, 2]);
/// mesh.push_face(&[3, 4, 5]);
/// mesh.push_face(&[2, 1, 0]);
/// assert_eq!(components(&mesh), (vec![0, 1, 0], 2));
/// ```
pub fn components(mesh: &PolygonMesh) -> (Vec<u32>, usize) {
    let faces = Faces::of(mesh, |_, _| ());
    let topology = Topology::of(mesh.vertices.len(), &faces);
    (labels(mesh, &faces, &topology), topology.shell_edges.len())
}

/// The shell of each face, `u32::MAX` for those that cannot be walked.
pub(super) fn labels(mesh: &PolygonMesh, faces: &Faces, topology: &Topology) -> Vec<u32> {
    let mut labels = vec![u32::MAX; mesh.face_count()];
    for (&number, &shell) in faces.number.iter().zip(&topology.shell) {
        labels[number as usize] = shell;
    }
    labels
}

/// The signed volume that each shell of [`components`] encloses, in cubed
/// units of the mesh: negative for shells that look inward, such as the walls
/// of cavities; meaningless for open shells.
pub fn component_volumes(mesh: &PolygonMesh) -> Vec<f64> {
    let faces = Faces::of(mesh, |_, _| ());
    let topology = Topology::of(mesh.vertices.len(), &faces);
    let frame = Frame::new(&mesh.vertices);
    let triangles = faces.triangles(&frame);
    volumes(mesh, &topology, &frame, &triangles)
}

/// The signed volume of each shell.
pub(super) fn volumes(
    mesh: &PolygonMesh,
    topology: &Topology,
    frame: &Frame,
    triangles: &Triangles,
) -> Vec<f64> {
    let origin = middle(&finite_bounds(mesh.vertices.iter()));
    sizes(
        &mesh.vertices,
        origin,
        frame,
        triangles,
        &topology.shell,
        topology.shell_edges.len(),
    )
    .iter()
    .map(|s| frame.leave_size(s.volume, 3))
    .collect()
}
