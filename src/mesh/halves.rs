//! The half-edges of a mesh of any faces, closed or with borders: half-edge
//! `h` starts at corner `h` and runs to the next corner of its face.

use super::PolygonMesh;

/// 'No such half-edge'.
const NONE: u32 = u32::MAX;

/// Who lies across each edge, and which half-edges start at each vertex.
pub(crate) struct Halves<'a> {
    mesh: &'a PolygonMesh,
    /// The face of each half-edge.
    pub face: Vec<u32>,
    /// The half-edge that runs the other way; at a border `u32::MAX`.
    pub twin: Vec<u32>,
    starts: Vec<u32>,
    out: Vec<u32>,
}

impl<'a> Halves<'a> {
    /// Of an oriented mesh whose edges have at most two faces.
    pub fn of(mesh: &'a PolygonMesh) -> Halves<'a> {
        let count = mesh.corners.len();
        let mut face = Vec::with_capacity(count);
        for f in 0..mesh.face_count() {
            face.resize(mesh.starts[f + 1] as usize, f as u32);
        }
        let mut starts = vec![0u32; mesh.vertices.len() + 2];
        for &v in &mesh.corners {
            starts[v as usize + 2] += 1;
        }
        for v in 2..starts.len() {
            starts[v] += starts[v - 1];
        }
        let mut out = vec![0; count];
        for (h, &v) in mesh.corners.iter().enumerate() {
            let at = &mut starts[v as usize + 1];
            out[*at as usize] = h as u32;
            *at += 1;
        }
        let mut halves = Halves {
            mesh,
            face,
            twin: vec![NONE; count],
            starts,
            out,
        };
        for h in 0..count as u32 {
            if halves.twin[h as usize] == NONE {
                let (a, b) = (halves.tail(h), halves.head(h));
                let back = (halves.leaving(b).iter().copied())
                    .find(|&t| halves.head(t) == a && halves.twin[t as usize] == NONE && t != h);
                if let Some(t) = back {
                    halves.twin[h as usize] = t;
                    halves.twin[t as usize] = h;
                }
            }
        }
        halves
    }

    /// The half-edge after `h` in its face.
    pub fn next(&self, h: u32) -> u32 {
        let f = self.face[h as usize] as usize;
        match h + 1 == self.mesh.starts[f + 1] {
            true => self.mesh.starts[f],
            false => h + 1,
        }
    }

    /// The vertex where `h` starts.
    pub fn tail(&self, h: u32) -> u32 {
        self.mesh.corners[h as usize]
    }

    /// The vertex where `h` ends.
    pub fn head(&self, h: u32) -> u32 {
        self.tail(self.next(h))
    }

    /// The half-edges that start at a vertex.
    pub fn leaving(&self, v: u32) -> &[u32] {
        let v = v as usize;
        &self.out[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    /// The half-edges of a face.
    pub fn of_face(&self, f: u32) -> std::ops::Range<u32> {
        let f = f as usize;
        self.mesh.starts[f]..self.mesh.starts[f + 1]
    }

    /// The face across a half-edge.
    pub fn across(&self, h: u32) -> Option<u32> {
        let twin = self.twin[h as usize];
        self.face.get(twin as usize).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_share_an_edge() {
        let mut mesh = PolygonMesh::with_vertices(vec![[0.0; 3]; 4]);
        mesh.push_face(&[0, 1, 2]);
        mesh.push_face(&[0, 2, 3]);
        let halves = Halves::of(&mesh);
        assert_eq!(halves.twin, [NONE, NONE, 3, 2, NONE, NONE]);
        assert_eq!(halves.across(2), Some(1));
        assert_eq!(halves.across(0), None);
        assert_eq!(halves.leaving(0), [0, 3]);
        assert_eq!((halves.next(2), halves.head(5)), (0, 0));
        assert_eq!(halves.of_face(1), 3..6);
    }
}
