//! A curve skeleton: edges only, of the same homotopy type.
//!
//! Sheets are burned from their rims, a layer of triangles at a time, each
//! triangle with a free edge of it. Edges that have no triangle any more and end in
//! nothing burn too, but where an edge has lasted long between losing its
//! last triangle and its end being reached: that is where a sheet was narrow and the
//! shape long (Liu, Chambers, Letscher and Ju 2010: A simple and robust
//! thinning algorithm on cell complexes, whose medial persistence this is).
//! Every step is an elementary collapse. Sheets that enclose a void have no rim: they stay,
//! and are counted.

use crate::surface::PowerShape;

/// An edge lasts if this share of its age went by since it was isolated.
const SHARE: f64 = 0.5;

/// The fewest layers an edge must last.
const LAYERS: u32 = 3;

/// A curve skeleton.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skeleton {
    /// The shape with the edges of the skeleton and the balls on them.
    pub shape: PowerShape,
    /// Triangles that could not be burned, since they enclose a void.
    pub triangles_left: usize,
}

/// The curve skeleton of a thin shape ([`PowerShape::thin`]).
///
/// ```
/// use powercrust::{axis::skeleton, Ball, PowerShape};
/// // A long strip of triangles burns to a line.
/// let at = |k: u32| Ball::new([f64::from(k / 2), f64::from(k % 2), 0.0], 1.0);
/// let shape = PowerShape {
///     balls: (0..40).map(at).collect(),
///     triangles: (0..38).map(|k| [k, k + 1, k + 2]).collect(),
///     ..PowerShape::default()
/// };
/// let line = skeleton(&shape).shape;
/// assert_eq!((line.triangles.len(), line.betti().parts), (0, 1));
/// ```
pub fn skeleton(shape: &PowerShape) -> Skeleton {
    let complex = shape.simplices();
    let mut fire = Fire::new(&complex.edges, &complex.triangles, complex.vertices);
    while fire.layer() {}
    let mut out = shape.clone();
    out.edges = kept(&complex.edges, &fire.edges);
    out.triangles = kept(&complex.triangles, &fire.triangles);
    out.tetrahedra = complex.tetrahedra;
    let triangles_left = out.triangles.len();
    out.keep_balls(&fire.vertices);
    Skeleton {
        shape: out,
        triangles_left,
    }
}

fn kept<const N: usize>(list: &[[u32; N]], there: &[bool]) -> Vec<[u32; N]> {
    let both = list.iter().zip(there);
    both.filter(|(_, &there)| there).map(|(s, _)| *s).collect()
}

struct Fire<'a> {
    ends: &'a [[u32; 2]],
    sides: Vec<[u32; 3]>,
    edges: Vec<bool>,
    triangles: Vec<bool>,
    vertices: Vec<bool>,
    /// Triangles at each edge, edges at each vertex: how many, and their
    /// numbers combined by exclusive or.
    at_edge: Vec<(u32, u32)>,
    at_vertex: Vec<(u32, u32)>,
    /// The layer in which an edge lost its last triangle.
    isolated: Vec<u32>,
    lasting: Vec<bool>,
    layers: u32,
}

impl<'a> Fire<'a> {
    fn new(ends: &'a [[u32; 2]], triangles: &[[u32; 3]], vertices: usize) -> Fire<'a> {
        let place = |edge: [u32; 2]| ends.binary_search(&edge).expect("closed") as u32;
        let side = |&[a, b, c]: &[u32; 3]| [[a, b], [a, c], [b, c]].map(place);
        let sides: Vec<[u32; 3]> = triangles.iter().map(side).collect();
        let mut at_edge = vec![(0, 0); ends.len()];
        for (t, side) in sides.iter().enumerate() {
            for &e in side {
                toggle(&mut at_edge[e as usize], t as u32, 1);
            }
        }
        let mut at_vertex = vec![(0, 0); vertices];
        for (e, edge) in ends.iter().enumerate() {
            for &v in edge {
                toggle(&mut at_vertex[v as usize], e as u32, 1);
            }
        }
        Fire {
            ends,
            sides,
            edges: vec![true; ends.len()],
            triangles: vec![true; triangles.len()],
            vertices: vec![true; vertices],
            at_edge,
            at_vertex,
            isolated: vec![0; ends.len()],
            lasting: vec![false; ends.len()],
            layers: 0,
        }
    }

    /// Burns a layer; whether anything did.
    fn layer(&mut self) -> bool {
        self.layers += 1;
        // What is free now, not what becomes so meanwhile.
        let free: Vec<u32> = (0..self.edges.len() as u32)
            .filter(|&e| self.edges[e as usize] && self.at_edge[e as usize].0 == 1)
            .collect();
        let tips: Vec<u32> = (0..self.vertices.len() as u32)
            .filter(|&v| self.vertices[v as usize] && self.at_vertex[v as usize].0 == 1)
            .collect();
        let mut burned = false;
        for e in free {
            let (count, t) = self.at_edge[e as usize];
            if !self.edges[e as usize] || count != 1 {
                continue;
            }
            self.triangles[t as usize] = false;
            for s in self.sides[t as usize] {
                toggle(&mut self.at_edge[s as usize], t, u32::MAX);
                if self.at_edge[s as usize].0 == 0 {
                    self.isolated[s as usize] = self.layers;
                }
            }
            self.remove_edge(e);
            burned = true;
        }
        for v in tips {
            let (count, e) = self.at_vertex[v as usize];
            if !self.vertices[v as usize] || count != 1 || self.at_edge[e as usize].0 > 0 {
                continue;
            }
            let since = self.layers - self.isolated[e as usize];
            // Edges that never had a triangle are curves already.
            let born = self.isolated[e as usize] == 0;
            let old = since > LAYERS && f64::from(since) > SHARE * f64::from(self.layers);
            if self.lasting[e as usize] || born || old {
                self.lasting[e as usize] = true;
                continue;
            }
            self.vertices[v as usize] = false;
            self.remove_edge(e);
            burned = true;
        }
        burned
    }

    fn remove_edge(&mut self, e: u32) {
        self.edges[e as usize] = false;
        for v in self.ends[e as usize] {
            toggle(&mut self.at_vertex[v as usize], e, u32::MAX);
        }
    }
}

/// Adds or takes away one of those counted.
fn toggle(counted: &mut (u32, u32), item: u32, by: u32) {
    counted.0 = counted.0.wrapping_add(by);
    counted.1 ^= item;
}
