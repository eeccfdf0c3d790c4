//! What the vertices and faces of a crust inherit from the points and balls
//! that made it.
//!
//! **Vertices.** A vertex at a sample has the values of its input point; where
//! several points of the input lie at one place, those of the first of them.
//! Any other vertex is blended from the samples next to it along mesh edges,
//! by the inverse of their distances; where none is next to it, from its
//! neighbours that have values already, breadth first from the samples. At
//! most [`MOST`] points are blended. A column that holds nothing but integers
//! (classes, scan numbers, counts) is not blended: the heaviest point decides.
//!
//! **Faces.** The plane between two power cells is at right angles to the line
//! of their centres, so inner to outer centre is the face's outward normal.
//! The inner ball tells how thick the solid is there. Which faces span places
//! that were not sampled, [`crate::holes`] says.

use crate::geom::vec3::{add, cross, dist_sq, norm, scale, sub};
use crate::geom::{Ball, Point};
use crate::mesh::PolygonMesh;
use crate::pipeline::{PolarBall, Reconstruction};

use crate::surface::raw::{Crust, NONE};

/// The most input points that one vertex is blended from.
pub const MOST: usize = 8;

/// For each vertex of a mesh the input points it has its values from, with
/// weights that sum up to one.
///
/// ```
/// use powercrust::{reconstruct, Context, Options};
/// # let mut points = vec![];
/// # for x in -1..=1 { for y in -1..=1 { for z in -1..=1 {
/// #     if [x, y, z] != [0, 0, 0] { points.push([x as f64, y as f64, z as f64]); }
/// # }}}
/// let result = reconstruct(&points, &Options::default(), &Context::default())?;
/// let heights: Vec<f64> = points.iter().map(|p| p[2]).collect();
/// let at_vertices = result.vertex_sources().numbers(&heights);
/// assert_eq!(at_vertices.len(), result.crust.mesh.vertices.len());
/// # Ok::<(), powercrust::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VertexSources {
    /// Vertex `v` owns the entries `starts[v]..starts[v + 1]`.
    starts: Vec<u32>,
    /// Index of the input point and its weight, the heaviest first.
    entries: Vec<(u32, f32)>,
}

impl VertexSources {
    /// The sources of the vertices of `crust`; `sample_source` and `balls` as
    /// in [`Reconstruction`].
    pub fn of(crust: &Crust, sample_source: &[u32], balls: &[PolarBall]) -> VertexSources {
        let mesh = &crust.mesh;
        let count = mesh.vertices.len();
        let source = |s: u32| sample_source.get(s as usize).copied();
        let mut lists: Vec<Vec<(u32, f32)>> = vec![Vec::new(); count];
        for (list, &sample) in lists.iter_mut().zip(&crust.vertex_samples) {
            list.extend(source(sample).map(|point| (point, 1.0)));
        }
        let ring = Rings::of(mesh);
        let mut reached: Vec<u32> = (0..count as u32)
            .filter(|&v| !lists[v as usize].is_empty())
            .collect();
        spread(mesh, &ring, &mut lists, &mut reached);
        // A component without samples has those that its inner balls touch.
        for (face, pair) in mesh.faces().zip(&crust.face_balls) {
            if face.iter().any(|&v| !lists[v as usize].is_empty()) {
                continue;
            }
            let ball = balls.get(pair[0] as usize);
            if let Some(point) = ball.and_then(|b| source(b.sample)) {
                lists[face[0] as usize].push((point, 1.0));
                reached = vec![face[0]];
                spread(mesh, &ring, &mut lists, &mut reached);
            }
        }
        let mut out = VertexSources::default();
        out.starts.push(0);
        for list in lists {
            out.push(&list);
        }
        out
    }

    fn push(&mut self, list: &[(u32, f32)]) {
        self.entries.extend_from_slice(list);
        self.starts.push(self.entries.len() as u32);
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Whether there are no vertices.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The input points and weights of a vertex, the heaviest first; empty for
    /// a vertex that no sample reaches.
    pub fn of_vertex(&self, v: usize) -> &[(u32, f32)] {
        &self.entries[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    /// The sources of some of the vertices, in the order given.
    pub fn select(&self, vertices: &[u32]) -> VertexSources {
        let mut out = VertexSources::default();
        out.starts.push(0);
        for &v in vertices {
            out.push(self.of_vertex(v as usize));
        }
        out
    }

    fn all(&self) -> impl Iterator<Item = &[(u32, f32)]> {
        (0..self.len()).map(|v| self.of_vertex(v))
    }

    /// A number of each input point, at the vertices. NaN says that a point
    /// has no value; so it does of a vertex none of whose points has one.
    pub fn numbers(&self, values: &[f64]) -> Vec<f64> {
        let value = |p: u32| values.get(p as usize).copied().unwrap_or(f64::NAN);
        let whole = |v: &f64| v.is_nan() || (v.is_finite() && v.fract() == 0.0);
        let classes = values.iter().all(whole);
        let blend = |list: &[(u32, f32)]| {
            let known = list.iter().filter(|e| !value(e.0).is_nan());
            if classes {
                return known.map(|e| value(e.0)).next().unwrap_or(f64::NAN);
            }
            let (mut sum, mut weights) = (0.0, 0.0);
            for e in known {
                sum += value(e.0) * f64::from(e.1);
                weights += f64::from(e.1);
            }
            sum / weights
        };
        self.all()
            .map(|list| match list {
                [(point, _)] => value(*point),
                _ => blend(list),
            })
            .collect()
    }

    /// A colour of each input point, at the vertices.
    pub fn colours(&self, values: &[[u8; 4]]) -> Vec<[u8; 4]> {
        let black = [0, 0, 0, 255];
        let value = |p: u32| values.get(p as usize).copied().unwrap_or(black);
        self.all()
            .map(|list| {
                let mut sum = [0.0f32; 4];
                for &(point, weight) in list {
                    for (s, c) in sum.iter_mut().zip(value(point)) {
                        *s += weight * f32::from(c);
                    }
                }
                match list {
                    [] => black,
                    _ => sum.map(|s| s.round() as u8),
                }
            })
            .collect()
    }

    /// A normal of each input point, at the vertices: as given where one point
    /// decides, else blended and of length 1. Where there is none, or they
    /// cancel out, the one in `otherwise` for the vertex.
    pub fn normals(&self, values: &[[f32; 3]], otherwise: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let value = |p: u32| values.get(p as usize).copied().unwrap_or([0.0; 3]);
        let usable = |n: &[f32; 3]| {
            let length = norm(n.map(f64::from));
            length.is_finite() && length > 0.0
        };
        self.all()
            .zip(otherwise)
            .map(|(list, &otherwise)| {
                if let [(point, _)] = list {
                    return Some(value(*point)).filter(usable).unwrap_or(otherwise);
                }
                let mut sum = [0.0; 3];
                for &(point, weight) in list {
                    let n = value(point);
                    if usable(&n) {
                        let n = n.map(f64::from);
                        sum = add(sum, scale(n, f64::from(weight) / norm(n)));
                    }
                }
                let length = norm(sum);
                match length > 0.1 {
                    true => scale(sum, 1.0 / length).map(|c| c as f32),
                    false => otherwise,
                }
            })
            .collect()
    }
}

/// The vertices next to each vertex along edges.
struct Rings {
    starts: Vec<u32>,
    near: Vec<u32>,
}

impl Rings {
    /// Of a closed oriented mesh: every edge runs both ways, so the next
    /// corners are all neighbours.
    fn of(mesh: &PolygonMesh) -> Rings {
        let mut starts = vec![0u32; mesh.vertices.len() + 2];
        for &v in &mesh.corners {
            starts[v as usize + 2] += 1;
        }
        for v in 2..starts.len() {
            starts[v] += starts[v - 1];
        }
        let mut near = vec![0; mesh.corners.len()];
        for face in mesh.faces() {
            for (k, &v) in face.iter().enumerate() {
                let at = &mut starts[v as usize + 1];
                near[*at as usize] = face[(k + 1) % face.len()];
                *at += 1;
            }
        }
        Rings { starts, near }
    }

    fn of_vertex(&self, v: u32) -> &[u32] {
        let v = v as usize;
        &self.near[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}

/// Gives lists to all vertices that edges join to `reached`, ring by ring.
fn spread(
    mesh: &PolygonMesh,
    rings: &Rings,
    lists: &mut [Vec<(u32, f32)>],
    reached: &mut Vec<u32>,
) {
    while !reached.is_empty() {
        let mut next: Vec<u32> = (reached.iter())
            .flat_map(|&v| rings.of_vertex(v))
            .copied()
            .filter(|&w| lists[w as usize].is_empty())
            .collect();
        next.sort_unstable();
        next.dedup();
        let blended: Vec<_> = (next.iter())
            .map(|&v| blend(mesh, v, rings.of_vertex(v), lists))
            .collect();
        for (&v, list) in next.iter().zip(blended) {
            lists[v as usize] = list;
        }
        *reached = next;
    }
}

/// The list of a vertex from those of its neighbours that have one.
fn blend(mesh: &PolygonMesh, v: u32, near: &[u32], lists: &[Vec<(u32, f32)>]) -> Vec<(u32, f32)> {
    let p = mesh.vertices[v as usize];
    let known = near.iter().filter(|&&w| !lists[w as usize].is_empty());
    let distance = |w: u32| dist_sq(p, mesh.vertices[w as usize]).sqrt();
    let least = known.clone().map(|&w| distance(w)).fold(f64::MAX, f64::min);
    let mut list: Vec<(u32, f32)> = Vec::new();
    for &w in known {
        // Relative to the nearest, so that nothing overflows; a neighbour at
        // the same place decides alone.
        let d = distance(w);
        let share = match (least > 0.0, d > 0.0) {
            (true, _) => least / d,
            (false, at_distance) => f64::from(u8::from(!at_distance)),
        };
        for &(point, weight) in &lists[w as usize] {
            let weight = weight * share as f32;
            match list.iter_mut().find(|e| e.0 == point) {
                Some(entry) => entry.1 += weight,
                None => list.push((point, weight)),
            }
        }
    }
    list.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    list.truncate(MOST);
    let sum: f32 = list.iter().map(|e| e.1).sum();
    list.iter_mut().for_each(|e| e.1 /= sum);
    list
}

/// The unit vector from inner to outer centre; `None` where they coincide.
fn across(inner: &Ball, outer: &Ball) -> Option<Point> {
    let way = sub(outer.centre, inner.centre);
    let length = norm(way);
    (length > 0.0 && length.is_finite()).then(|| scale(way, 1.0 / length))
}

/// The area vector of a face, after division by `unit` per length.
fn area(mesh: &PolygonMesh, face: &[u32], unit: f64) -> Point {
    let at = |k: usize| scale(mesh.vertices[face[k] as usize], 1.0 / unit);
    let origin = at(0);
    (1..face.len().saturating_sub(1)).fold([0.0; 3], |sum, k| {
        add(sum, cross(sub(at(k), origin), sub(at(k + 1), origin)))
    })
}

impl Reconstruction {
    /// Which input points each vertex has its values from: see
    /// [`VertexSources`].
    pub fn vertex_sources(&self) -> VertexSources {
        VertexSources::of(&self.crust, &self.sample_source, &self.balls)
    }

    fn pair(&self, face: usize) -> Option<(&Ball, &Ball)> {
        let [inner, outer] = *self.crust.face_balls.get(face)?;
        let ball = |b: u32| self.balls.get(b as usize).map(|b| &b.ball);
        Some((ball(inner)?, ball(outer)?))
    }

    /// A unit normal at each vertex: the mean of the directions from inner to
    /// outer ball of the faces around, weighted by their areas.
    pub fn vertex_normals(&self) -> Vec<[f32; 3]> {
        let mesh = &self.crust.mesh;
        let reach = |m: f64, p: &Point| p.iter().fold(m, |m, x| m.max(x.abs()));
        let unit = mesh.vertices.iter().fold(f64::MIN_POSITIVE, reach);
        let mut sums = vec![[0.0; 3]; mesh.vertices.len()];
        for (f, face) in mesh.faces().enumerate() {
            let area = area(mesh, face, unit);
            let way = self.pair(f).and_then(|(inner, outer)| across(inner, outer));
            let share = way.map_or(area, |way| scale(way, norm(area)));
            for &v in face {
                sums[v as usize] = add(sums[v as usize], share);
            }
        }
        sums.into_iter()
            .map(|sum| {
                let length = norm(sum);
                match length > 0.0 && length.is_finite() {
                    true => scale(sum, 1.0 / length).map(|c| c as f32),
                    false => [0.0, 0.0, 1.0],
                }
            })
            .collect()
    }

    /// For each face how thick the solid is there: the diameter of its inner
    /// ball, which is as large as fits in between.
    pub fn face_thickness(&self) -> Vec<f64> {
        (0..self.crust.mesh.face_count())
            .map(|f| {
                self.pair(f)
                    .map_or(f64::NAN, |(inner, _)| 2.0 * inner.radius)
            })
            .collect()
    }

    /// For each vertex how thick the solid is there: the diameter of the
    /// smallest inner ball of the faces around; NaN for a vertex without any.
    pub fn vertex_thickness(&self) -> Vec<f64> {
        let mesh = &self.crust.mesh;
        let mut least = vec![f64::NAN; mesh.vertices.len()];
        for (face, thickness) in mesh.faces().zip(self.face_thickness()) {
            for &v in face {
                // The smaller of two numbers, whichever is NaN.
                least[v as usize] = least[v as usize].min(thickness);
            }
        }
        least
    }

    /// For each face how wide the space before it is: the diameter of its
    /// outer ball. On convex parts this only tells the size of the frame.
    pub fn face_gap(&self) -> Vec<f64> {
        (0..self.crust.mesh.face_count())
            .map(|f| {
                self.pair(f)
                    .map_or(f64::NAN, |(_, outer)| 2.0 * outer.radius)
            })
            .collect()
    }

    /// For each face the sum of the radii of its two polar balls: how far
    /// apart the two sheets of the medial axis are there, as far as they are
    /// seen from one sample. Outer balls of convex parts reach the frame, so
    /// this is no measure of the solid: see [`Reconstruction::face_thickness`].
    pub fn face_polar_radii(&self) -> Vec<f64> {
        (0..self.crust.mesh.face_count())
            .map(|f| {
                self.pair(f)
                    .map_or(f64::NAN, |(inner, outer)| inner.radius + outer.radius)
            })
            .collect()
    }

    /// For each face how much its place is to be doubted: the larger of what the
    /// evidence says against the labels of its two polar balls
    /// ([`Reconstruction::doubt`]), in [0, 1]. 0 almost everywhere on clean samples.
    pub fn face_doubt(&self) -> Vec<f64> {
        let doubt = |b: u32| self.doubt.get(b as usize).copied().unwrap_or(0.0);
        let pairs = self.crust.face_balls.iter();
        pairs
            .map(|pair| f64::from(doubt(pair[0]).max(doubt(pair[1]))))
            .collect()
    }

    /// For each vertex how far apart samples are there: the distance from a
    /// sample to the nearest one next to it on the surface, blended at other
    /// vertices like every number.
    pub fn vertex_spacing(&self) -> Vec<f64> {
        self.spacing(&self.vertex_sources())
    }

    fn spacing(&self, sources: &VertexSources) -> Vec<f64> {
        let mesh = &self.crust.mesh;
        let mut nearest = vec![f64::NAN; self.sample_source.len()];
        let mut near = |a: u32, b: u32, distance: f64| {
            if let (true, Some(least)) = (a != b, nearest.get_mut(a as usize)) {
                *least = least.min(distance);
            }
        };
        let sample = |v: u32| self.crust.vertex_samples[v as usize];
        let rings = Rings::of(mesh);
        for v in (0..mesh.vertices.len() as u32).filter(|&v| sample(v) != NONE) {
            let p = mesh.vertices[v as usize];
            // Past vertices that are no samples, one step.
            for &w in rings.of_vertex(v) {
                let further: &[u32] = match sample(w) {
                    NONE => rings.of_vertex(w),
                    _ => &[w],
                };
                for &x in further.iter().filter(|&&x| sample(x) != NONE) {
                    let distance = dist_sq(p, mesh.vertices[x as usize]).sqrt();
                    near(sample(v), sample(x), distance);
                }
            }
        }
        // By input point, as sources count.
        let points = self
            .sample_source
            .iter()
            .max()
            .map_or(0, |&m| m as usize + 1);
        let mut by_point = vec![f64::NAN; points];
        for (&point, &distance) in self.sample_source.iter().zip(&nearest) {
            by_point[point as usize] = distance;
        }
        sources.numbers(&by_point)
    }
}
