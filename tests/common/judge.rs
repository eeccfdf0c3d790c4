//! A judge of meshes by their indices and by a known true surface. It shares
//! no code with the crate's own checker, so that neither can hide a fault of
//! the other.

use super::shapes::Shape;
use powercrust::geom::vec3::{add, cross, dist_sq, dot, norm, norm_sq, scale, sub};
use powercrust::{Bounds, Point, PolygonMesh, Reconstruction};

/// What the indices of a mesh say.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    pub vertices: usize,
    pub edges: usize,
    pub faces: usize,
    pub components: usize,
    /// Directed edges without a partner in the other direction.
    pub border: usize,
    /// Directed edges used more than once.
    pub repeated: usize,
    /// Vertices whose faces form more than one fan.
    pub pinched: usize,
    /// Vertices in no face.
    pub unused: usize,
    /// Faces of fewer than three corners or that repeat a vertex.
    pub broken: usize,
    /// Faces whose vector area is exactly zero.
    pub flat: usize,
}

impl Topology {
    /// Closed, manifold, oriented, without rubbish.
    pub fn sound(&self) -> bool {
        self.faces > 0
            && self.border == 0
            && self.repeated == 0
            && self.pinched == 0
            && self.unused == 0
            && self.broken == 0
            && self.flat == 0
    }

    /// The sum of the components' genera; for closed meshes only.
    pub fn genus(&self) -> i64 {
        let euler = self.vertices as i64 - self.edges as i64 + self.faces as i64;
        assert_eq!(euler % 2, 0, "a closed surface has an even characteristic");
        self.components as i64 - euler / 2
    }
}

/// Counts everything in [`Topology`]. The mesh may be as broken as it likes,
/// as long as its indices are in range.
pub fn topology(mesh: &PolygonMesh) -> Topology {
    let corner_count = mesh.corners.len();
    let vertex_count = mesh.vertices.len();
    let mut found = Topology {
        faces: mesh.face_count(),
        ..Topology::default()
    };
    let mut next = vec![0u32; corner_count];
    for face in 0..mesh.face_count() {
        let (from, to) = (mesh.starts[face], mesh.starts[face + 1]);
        for corner in from..to {
            next[corner as usize] = if corner + 1 == to { from } else { corner + 1 };
        }
        let mut corners = mesh.face(face).to_vec();
        let area = vector_area(mesh, face);
        found.flat += usize::from(area == [0.0; 3]);
        corners.sort_unstable();
        corners.dedup();
        found.broken += usize::from(corners.len() < 3 || corners.len() < (to - from) as usize);
    }
    let key = |a: u32, b: u32| u64::from(a) << 32 | u64::from(b);
    let mut directed: Vec<(u64, u32)> = (0..corner_count as u32)
        .map(|c| {
            let end = mesh.corners[next[c as usize] as usize];
            (key(mesh.corners[c as usize], end), c)
        })
        .collect();
    directed.sort_unstable();
    found.repeated = directed.windows(2).filter(|w| w[0].0 == w[1].0).count();

    let mut fans = Groups::new(corner_count);
    let mut parts = Groups::new(vertex_count);
    let mut undirected = std::collections::HashSet::new();
    for &(edge, corner) in &directed {
        let (from, to) = ((edge >> 32) as u32, edge as u32);
        parts.join(from, to);
        undirected.insert(key(from.min(to), from.max(to)));
        let reverse = key(to, from);
        let at = directed.partition_point(|d| d.0 < reverse);
        match directed.get(at) {
            Some(&(edge, mate)) if edge == reverse => fans.join(corner, next[mate as usize]),
            _ => found.border += 1,
        }
    }
    found.edges = undirected.len();
    let mut fans_at = vec![0u32; vertex_count];
    let mut is_used = vec![false; vertex_count];
    for corner in 0..corner_count as u32 {
        let vertex = mesh.corners[corner as usize] as usize;
        is_used[vertex] = true;
        fans_at[vertex] += u32::from(fans.find(corner) == corner);
    }
    found.pinched = fans_at.iter().filter(|&&fans| fans > 1).count();
    found.unused = is_used.iter().filter(|&&used| !used).count();
    found.vertices = vertex_count - found.unused;
    found.components = (0..vertex_count as u32)
        .filter(|&v| is_used[v as usize] && parts.find(v) == v)
        .count();
    found
}

/// Union-find.
struct Groups(Vec<u32>);

impl Groups {
    fn new(count: usize) -> Groups {
        Groups((0..count as u32).collect())
    }

    fn find(&mut self, mut item: u32) -> u32 {
        while self.0[item as usize] != item {
            self.0[item as usize] = self.0[self.0[item as usize] as usize];
            item = self.0[item as usize];
        }
        item
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

fn vector_area(mesh: &PolygonMesh, face: usize) -> Point {
    let corners = mesh.face(face);
    let mut twice = [0.0; 3];
    for [p, q, r] in fan(mesh, corners) {
        // Scaled by a power of two: areas in extreme units are numbers too.
        let (u, v) = (sub(q, p), sub(r, p));
        let size = u.iter().chain(&v).fold(0.0f64, |m, x| m.max(x.abs()));
        let factor = match size {
            s if s < 1e-100 => 2f64.powi(900),
            s if s > 1e100 => 2f64.powi(-900),
            _ => 1.0,
        };
        let large = |w: Point| w.map(|x| x * factor);
        twice = add(twice, cross(large(u), large(v)));
    }
    twice
}

fn fan<'a>(mesh: &'a PolygonMesh, corners: &'a [u32]) -> impl Iterator<Item = [Point; 3]> + 'a {
    let at = |i: usize| mesh.vertices[corners[i] as usize];
    (1..corners.len().saturating_sub(1)).map(move |k| [at(0), at(k), at(k + 1)])
}

/// The triangles of a mesh, polygons fanned from their first corner.
pub fn triangles(mesh: &PolygonMesh) -> impl Iterator<Item = [Point; 3]> + '_ {
    mesh.faces().flat_map(|corners| fan(mesh, corners))
}

/// Distances to a true surface.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deviation {
    /// Mean over the area.
    pub mean: f64,
    /// Largest found.
    pub max: f64,
}

/// How far the mesh strays from the true surface: largest over corners, edge
/// midpoints and centroids of its triangles; mean over midpoints and
/// centroids by area.
pub fn deviation(mesh: &PolygonMesh, shape: &dyn Shape) -> Deviation {
    let (mut total, mut area_total, mut max) = (0.0, 0.0, 0.0f64);
    for [p, q, r] in triangles(mesh) {
        let area = norm(cross(sub(q, p), sub(r, p))) / 2.0;
        let centroid = scale(add(p, add(q, r)), 1.0 / 3.0);
        let middle = |a, b| scale(add(a, b), 0.5);
        let places = [centroid, middle(p, q), middle(q, r), middle(r, p)];
        let mut sum = 0.0;
        for place in places {
            let distance = shape.signed_distance(place).abs();
            sum += distance;
            max = max.max(distance);
        }
        total += area * sum / 4.0;
        area_total += area;
    }
    for &vertex in &mesh.vertices {
        max = max.max(shape.signed_distance(vertex).abs());
    }
    Deviation {
        mean: total / area_total,
        max,
    }
}

/// The input points that are not on the crust, farthest first, with their
/// distances: no vertex is there, and no triangle within 1e-9 of the diagonal.
pub fn samples_off_the_crust(points: &[Point], result: &Reconstruction) -> Vec<(f64, usize)> {
    let Some(bounds) = Bounds::of(points) else {
        return Vec::new();
    };
    // A sample that is no vertex lies in a face whose plane is as good as its
    // balls' centres: 2^-32 of the box, divided by a small angle.
    let near = 1e-7 * bounds.diagonal();
    let mut is_vertex = vec![false; result.sample_source.len()];
    for (vertex, &sample) in result.crust.vertex_samples.iter().enumerate() {
        if let Some(&source) = result.sample_source.get(sample as usize) {
            let place = result.crust.mesh.vertices[vertex];
            is_vertex[sample as usize] |= dist_sq(place, points[source as usize]) <= near * near;
        }
    }
    let surface = Surface::of(&result.crust.mesh);
    let mut off: Vec<(f64, usize)> = (0..is_vertex.len())
        .filter(|&sample| !is_vertex[sample])
        .map(|sample| {
            let source = result.sample_source[sample] as usize;
            (surface.distance(points[source]), source)
        })
        .filter(|&(distance, _)| distance > near)
        .collect();
    off.sort_by(|a, b| b.0.total_cmp(&a.0));
    off
}

/// Triangles with their boxes, sorted along x, for distances.
struct Surface {
    /// Box and triangle, by the least x.
    triangles: Vec<(Bounds, [Point; 3])>,
    /// The longest box along x.
    widest: f64,
}

impl Surface {
    fn of(mesh: &PolygonMesh) -> Surface {
        let mut boxed: Vec<(Bounds, [Point; 3])> = triangles(mesh)
            .filter_map(|corners| Some((Bounds::of(&corners)?, corners)))
            .collect();
        boxed.sort_by(|a, b| a.0.min[0].total_cmp(&b.0.min[0]));
        let lengths = boxed
            .iter()
            .map(|(bounds, _)| bounds.max[0] - bounds.min[0]);
        Surface {
            widest: lengths.fold(0.0, f64::max),
            triangles: boxed,
        }
    }

    /// The distance to the nearest triangle: outward along x from the point's
    /// place in the order, until no box can be nearer.
    fn distance(&self, p: Point) -> f64 {
        let start = self.triangles.partition_point(|t| t.0.min[0] < p[0]);
        let mut best = f64::INFINITY;
        let look = |bounds: &Bounds, corners: &[Point; 3], best: &mut f64| {
            let gap =
                std::array::from_fn(|k| (bounds.min[k] - p[k]).max(p[k] - bounds.max[k]).max(0.0));
            if norm_sq(gap) < *best * *best {
                *best = best.min(distance_to_triangle(p, *corners));
            }
        };
        for (bounds, corners) in self.triangles[..start].iter().rev() {
            if p[0] - bounds.min[0] - self.widest > best {
                break;
            }
            look(bounds, corners, &mut best);
        }
        for (bounds, corners) in &self.triangles[start..] {
            if bounds.min[0] - p[0] > best {
                break;
            }
            look(bounds, corners, &mut best);
        }
        best
    }
}

/// The distance from a point to a triangle, by its Voronoi regions (Ericson,
/// Real-Time Collision Detection, 5.1.5).
pub fn distance_to_triangle(p: Point, [a, b, c]: [Point; 3]) -> f64 {
    let segment = |a: Point, b: Point| {
        let along = sub(b, a);
        let t = dot(sub(p, a), along) / norm_sq(along).max(f64::MIN_POSITIVE);
        norm(sub(p, add(a, scale(along, t.clamp(0.0, 1.0)))))
    };
    let normal = cross(sub(b, a), sub(c, a));
    let left_of = |a: Point, b: Point| dot(cross(sub(b, a), sub(p, a)), normal) >= 0.0;
    if norm_sq(normal) > 0.0 && left_of(a, b) && left_of(b, c) && left_of(c, a) {
        return (dot(sub(p, a), normal) / norm(normal)).abs();
    }
    segment(a, b).min(segment(b, c)).min(segment(c, a))
}
