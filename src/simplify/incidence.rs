//! A simplicial complex of dimension at most 3 as lists of corners, and which
//! simplices lie on which.

/// Simplices by their corners, ascending within a simplex, lists sorted and
/// without repeats.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Simplices {
    /// Number of vertices.
    pub vertices: usize,
    /// Edges.
    pub edges: Vec<[u32; 2]>,
    /// Triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Tetrahedra.
    pub tetrahedra: Vec<[u32; 4]>,
}

impl Simplices {
    /// The complex of the given simplices and all their faces. Simplices with
    /// a corner twice, and corners beyond the vertices, are left out.
    ///
    /// ```
    /// use powercrust::simplify::Simplices;
    /// let complex = Simplices::closed(4, &[], &[[2, 0, 1]], &[]);
    /// assert_eq!(complex.edges, [[0, 1], [0, 2], [1, 2]]);
    /// ```
    pub fn closed(
        vertices: usize,
        edges: &[[u32; 2]],
        triangles: &[[u32; 3]],
        tetrahedra: &[[u32; 4]],
    ) -> Simplices {
        let tetrahedra = tidy(tetrahedra.to_vec(), vertices);
        let mut all = triangles.to_vec();
        for &[a, b, c, d] in &tetrahedra {
            all.extend([[b, c, d], [a, c, d], [a, b, d], [a, b, c]]);
        }
        let triangles = tidy(all, vertices);
        let mut all = edges.to_vec();
        for &[a, b, c] in &triangles {
            all.extend([[b, c], [a, c], [a, b]]);
        }
        Simplices {
            vertices,
            edges: tidy(all, vertices),
            triangles,
            tetrahedra,
        }
    }

    /// The facets of triangles and tetrahedra by their places in the lists.
    /// The complex must have all of them, as [`Simplices::closed`] makes it.
    pub(super) fn incidence(&self) -> Incidence {
        let edges = Index::of(&self.edges, self.vertices);
        let triangles = Index::of(&self.triangles, self.vertices);
        let of_triangle =
            |&[a, b, c]: &[u32; 3]| [[b, c], [a, c], [a, b]].map(|e| edges.find(&self.edges, &e));
        let of_tetrahedron = |&[a, b, c, d]: &[u32; 4]| {
            [[b, c, d], [a, c, d], [a, b, d], [a, b, c]]
                .map(|t| triangles.find(&self.triangles, &t))
        };
        Incidence {
            triangle_edges: self.triangles.iter().map(of_triangle).collect(),
            tetrahedron_triangles: self.tetrahedra.iter().map(of_tetrahedron).collect(),
        }
    }
}

/// Sorts corners and simplices.
fn tidy<const N: usize>(mut list: Vec<[u32; N]>, vertices: usize) -> Vec<[u32; N]> {
    for simplex in &mut list {
        simplex.sort_unstable();
    }
    list.retain(|s| s.windows(2).all(|w| w[0] < w[1]) && (s[N - 1] as usize) < vertices);
    list.sort_unstable();
    list.dedup();
    list
}

/// Which simplices bound which.
pub(super) struct Incidence {
    pub triangle_edges: Vec<[u32; 3]>,
    pub tetrahedron_triangles: Vec<[u32; 4]>,
}

/// Where the simplices of each first corner begin in a sorted list.
struct Index(Vec<u32>);

impl Index {
    fn of<const N: usize>(list: &[[u32; N]], vertices: usize) -> Index {
        let mut starts = vec![0u32; vertices + 1];
        for simplex in list {
            starts[simplex[0] as usize + 1] += 1;
        }
        for v in 0..vertices {
            starts[v + 1] += starts[v];
        }
        Index(starts)
    }

    fn find<const N: usize>(&self, list: &[[u32; N]], simplex: &[u32; N]) -> u32 {
        let first = simplex[0] as usize;
        let from = self.0[first] as usize;
        let part = &list[from..self.0[first + 1] as usize];
        let at = part.binary_search(simplex).expect("the complex is closed");
        (from + at) as u32
    }
}

/// How many simplices that are still there have each face, and which one if
/// it is the last.
#[derive(Clone)]
pub(super) struct Cofaces {
    pub count: Vec<u32>,
    /// All their numbers, combined by exclusive or.
    mixed: Vec<u32>,
}

impl Cofaces {
    pub fn of<const N: usize>(faces: usize, boundaries: &[[u32; N]]) -> Cofaces {
        let mut out = Cofaces {
            count: vec![0; faces],
            mixed: vec![0; faces],
        };
        for (s, boundary) in boundaries.iter().enumerate() {
            for &face in boundary {
                out.count[face as usize] += 1;
                out.mixed[face as usize] ^= s as u32;
            }
        }
        out
    }

    /// Takes a simplex away from its faces.
    pub fn remove(&mut self, simplex: u32, boundary: &[u32]) {
        for &face in boundary {
            self.count[face as usize] -= 1;
            self.mixed[face as usize] ^= simplex;
        }
    }

    /// The only simplex left at a face.
    pub fn only(&self, face: u32) -> Option<u32> {
        (self.count[face as usize] == 1).then(|| self.mixed[face as usize])
    }
}
