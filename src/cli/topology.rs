//! The two numbers that say what kind of surface a closed mesh is.

use powercrust::PolygonMesh;

/// Components and genus of a closed manifold mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Topology {
    /// Pieces that share no vertex.
    pub components: usize,
    /// Handles, summed over the components, by Euler's formula.
    pub genus: i64,
}

impl Topology {
    pub fn of(mesh: &PolygonMesh) -> Topology {
        let mut parent: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
        let mut components = mesh.vertices.len();
        for face in mesh.faces() {
            for pair in face.windows(2) {
                let (a, b) = (root(&mut parent, pair[0]), root(&mut parent, pair[1]));
                if a != b {
                    parent[a.max(b) as usize] = a.min(b);
                    components -= 1;
                }
            }
        }
        // Every edge of a closed manifold lies on two faces.
        let edges = mesh.corners.len() as i64 / 2;
        let euler = mesh.vertices.len() as i64 - edges + mesh.face_count() as i64;
        Topology {
            components,
            genus: components as i64 - euler / 2,
        }
    }
}

fn root(parent: &mut [u32], mut x: u32) -> u32 {
    while parent[x as usize] != x {
        parent[x as usize] = parent[parent[x as usize] as usize];
        x = parent[x as usize];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_tetrahedra_and_a_square_torus() {
        let mut mesh = PolygonMesh::with_vertices(vec![[0.0; 3]; 8]);
        for first in [0, 4] {
            for face in [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]] {
                mesh.push_face(&face.map(|v| v + first));
            }
        }
        let expected = Topology {
            components: 2,
            genus: 0,
        };
        assert_eq!(Topology::of(&mesh), expected);

        let mut mesh = PolygonMesh::with_vertices(vec![[0.0; 3]; 9]);
        for i in 0..3 {
            for j in 0..3 {
                let at = |i: u32, j: u32| 3 * (i % 3) + j % 3;
                mesh.push_face(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        let expected = Topology {
            components: 1,
            genus: 1,
        };
        assert_eq!(Topology::of(&mesh), expected);
    }
}
