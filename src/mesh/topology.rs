//! How the faces of a mesh hang together: edges, fans of faces about a
//! vertex, shells, borders.
//!
//! Two corners at one vertex belong to one fan when a chain of faces about
//! the vertex, each sharing an edge with the next, joins them. Faces joined
//! by shared edges form a shell.

use super::soup::Faces;
use crate::geom::Sets;

/// Faces at an edge that are not two of opposite direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EdgeFault {
    /// One face.
    Open,
    /// Two faces that run along it in the same direction.
    Misoriented,
    /// More than two faces.
    Crowded,
}

/// An edge at fault, by its vertices and its corners in `Topology::at_edges`.
#[derive(Clone, Copy, Debug)]
pub(super) struct BadEdge {
    pub fault: EdgeFault,
    /// Vertices, the smaller first.
    pub ends: [u32; 2],
    /// Range of `Topology::bad_corners`: the corners that start the edge.
    pub corners: (u32, u32),
}

/// The incidences of a mesh.
pub(super) struct Topology {
    /// Number of edges (pairs of different vertices next to each other).
    pub edges: u64,
    /// Edges at fault, by their vertices.
    pub bad: Vec<BadEdge>,
    /// Corners at those edges.
    pub bad_corners: Vec<u32>,
    /// For each corner a corner that stands for its fan.
    pub fan: Vec<u32>,
    /// Number of fans at each vertex.
    pub fans: Vec<u32>,
    /// The shell of each face, numbered by first face.
    pub shell: Vec<u32>,
    /// Number of edges of each shell; its length is the number of shells.
    pub shell_edges: Vec<u64>,
    /// Number of components by shared vertices.
    pub components: u32,
    /// For each corner the one whose half-edge runs the other way, where every
    /// edge has two.
    pub twins: Option<Vec<u32>>,
}

/// Labels `0..count` in order of first appearance, from representatives that
/// are smallest members.
fn number(representatives: &mut [u32]) -> u32 {
    let mut count = 0;
    for x in 0..representatives.len() {
        let r = representatives[x] as usize;
        representatives[x] = match r == x {
            true => {
                count += 1;
                count - 1
            }
            false => representatives[r],
        };
    }
    count
}

impl Topology {
    pub fn of(vertices: usize, faces: &Faces) -> Topology {
        match twins(vertices, faces) {
            Some(twins) => Topology::closed(vertices, faces, twins),
            None => Topology::general(vertices, faces),
        }
    }

    /// Where each edge has two half-edges of opposite direction.
    fn closed(vertices: usize, faces: &Faces, twins: Vec<u32>) -> Topology {
        let corners = &faces.corners;
        let next = faces.next();
        let mut fan = vec![u32::MAX; corners.len()];
        let mut fans = vec![0u32; vertices];
        for first in 0..corners.len() {
            let mut c = first;
            while fan[c] == u32::MAX {
                fan[c] = first as u32;
                c = next[twins[c] as usize] as usize;
            }
            fans[corners[first] as usize] += (fan[first] as usize == first) as u32;
        }
        let joined = joined(vertices, faces);
        let components = (0..vertices).filter(|&v| fans[v] > 0 && joined[v] as usize == v);
        let components = components.count() as u32;
        let mut shell: Vec<u32>;
        let count;
        if fans.iter().all(|&n| n < 2) {
            // Faces that share a vertex are joined by edges around it.
            shell = faces.iter().map(|face| joined[face[0] as usize]).collect();
            count = number_by_first(&mut shell, vertices);
        } else {
            let face_of = face_of(faces);
            let mut shells = Sets::new(faces.len());
            for (c, &t) in twins.iter().enumerate() {
                shells.join(face_of[c], face_of[t as usize]);
            }
            shell = shells.flatten();
            count = number(&mut shell);
        }
        let mut shell_edges = vec![0u64; count as usize];
        for (face, &s) in faces.iter().zip(&shell) {
            shell_edges[s as usize] += face.len() as u64;
        }
        shell_edges.iter_mut().for_each(|n| *n /= 2);
        Topology {
            edges: corners.len() as u64 / 2,
            bad: Vec::new(),
            bad_corners: Vec::new(),
            fan,
            fans,
            shell,
            shell_edges,
            components,
            twins: Some(twins),
        }
    }

    /// Whatever the edges.
    fn general(vertices: usize, faces: &Faces) -> Topology {
        let corners = &faces.corners;
        let next = faces.next();
        let face_of = face_of(faces);
        let ends = |c: usize| {
            let (s, t) = (corners[c], corners[next[c] as usize]);
            (s.min(t), s.max(t))
        };

        // Corners by the smaller end of their edge, then by the larger.
        let mut first = vec![0u32; vertices + 2];
        for c in 0..corners.len() {
            let (low, high) = ends(c);
            first[low as usize + 2] += (low != high) as u32;
        }
        for v in 2..first.len() {
            first[v] += first[v - 1];
        }
        let mut slots = vec![0u64; first[vertices + 1] as usize];
        for c in 0..corners.len() {
            let (low, high) = ends(c);
            if low != high {
                let at = &mut first[low as usize + 1];
                slots[*at as usize] = u64::from(high) << 32 | c as u64;
                *at += 1;
            }
        }

        let mut fans = Sets::new(corners.len());
        let mut shells = Sets::new(faces.len());
        let (mut edges, mut bad, mut bad_corners) = (0u64, Vec::new(), Vec::new());
        let mut edge_face = Vec::with_capacity(corners.len() / 2);
        for v in 0..vertices {
            let bucket = &mut slots[first[v] as usize..first[v + 1] as usize];
            bucket.sort_unstable();
            for group in bucket.chunk_by(|a, b| a >> 32 == b >> 32) {
                let corner = |k: usize| group[k] as u32;
                edges += 1;
                edge_face.push(face_of[corner(0) as usize]);
                let along = |c: u32| corners[c as usize] as usize == v;
                for k in 1..group.len() {
                    let (a, b) = (corner(0), corner(k));
                    shells.join(face_of[a as usize], face_of[b as usize]);
                    let (na, nb) = (next[a as usize], next[b as usize]);
                    match along(a) == along(b) {
                        true => (fans.join(a, b), fans.join(na, nb)),
                        false => (fans.join(a, nb), fans.join(na, b)),
                    };
                }
                let fault = match group.len() {
                    1 => EdgeFault::Open,
                    2 if along(corner(0)) != along(corner(1)) => continue,
                    2 => EdgeFault::Misoriented,
                    _ => EdgeFault::Crowded,
                };
                let from = bad_corners.len() as u32;
                bad_corners.extend(group.iter().map(|&g| g as u32));
                bad.push(BadEdge {
                    fault,
                    ends: [v as u32, (group[0] >> 32) as u32],
                    corners: (from, bad_corners.len() as u32),
                });
            }
        }

        let fan = fans.flatten();
        let mut fans_at = vec![0u32; vertices];
        for (c, &f) in fan.iter().enumerate() {
            fans_at[corners[c] as usize] += (f as usize == c) as u32;
        }
        let mut shell = shells.flatten();
        let mut shell_edges = vec![0u64; number(&mut shell) as usize];
        for f in edge_face {
            shell_edges[shell[f as usize] as usize] += 1;
        }
        Topology {
            edges,
            bad,
            bad_corners,
            fan,
            fans: fans_at,
            shell,
            shell_edges,
            components: by_vertices(vertices, faces),
            twins: None,
        }
    }

    /// Border loops of each shell: chains of open edges, two meeting where
    /// they end in the same fan of a vertex.
    pub fn loops(&self, faces: &Faces) -> Vec<u64> {
        let next = faces.next();
        let open: Vec<u32> = (self.bad.iter())
            .filter(|e| e.fault == EdgeFault::Open)
            .map(|e| self.bad_corners[e.corners.0 as usize])
            .collect();
        let mut at_fan: Vec<(u32, u32)> = Vec::with_capacity(2 * open.len());
        for (k, &c) in open.iter().enumerate() {
            at_fan.push((self.fan[c as usize], k as u32));
            at_fan.push((self.fan[next[c as usize] as usize], k as u32));
        }
        at_fan.sort_unstable();
        let mut chains = Sets::new(open.len());
        for pair in at_fan.windows(2) {
            if pair[0].0 == pair[1].0 {
                chains.join(pair[0].1, pair[1].1);
            }
        }
        let mut loops = vec![0u64; self.shell_edges.len()];
        for (k, &r) in chains.flatten().iter().enumerate() {
            if r as usize == k {
                let f = faces.starts.partition_point(|&s| s <= open[k]) - 1;
                loops[self.shell[f] as usize] += 1;
            }
        }
        loops
    }
}

/// The half-edge that runs the other way along each corner's edge, if every
/// edge has just two. Those that run upward lie in buckets by their tails; the
/// others look theirs up.
fn twins(vertices: usize, faces: &Faces) -> Option<Vec<u32>> {
    let corners = &faces.corners;
    let next = faces.next();
    let ends = |c: usize| (corners[c], corners[next[c] as usize]);
    let mut first = vec![0u32; vertices + 2];
    let mut upward = 0;
    for c in 0..corners.len() {
        let (tail, head) = ends(c);
        first[tail as usize + 2] += (tail < head) as u32;
        upward += (tail < head) as usize;
    }
    if 2 * upward != corners.len() {
        return None;
    }
    for v in 2..first.len() {
        first[v] += first[v - 1];
    }
    let mut slots = vec![(0, 0); upward];
    for c in 0..corners.len() {
        let (tail, head) = ends(c);
        if tail < head {
            let at = &mut first[tail as usize + 1];
            slots[*at as usize] = (head, c as u32);
            *at += 1;
        }
    }
    let mut twins = vec![u32::MAX; corners.len()];
    for c in 0..corners.len() {
        let (tail, head) = ends(c);
        if tail >= head {
            let bucket = first[head as usize] as usize..first[head as usize + 1] as usize;
            let &(_, up) = slots[bucket].iter().find(|(v, _)| *v == tail)?;
            let other = &mut twins[up as usize];
            if *other != u32::MAX {
                return None;
            }
            *other = c as u32;
            twins[c] = up;
        }
    }
    Some(twins)
}

/// The face of each corner.
fn face_of(faces: &Faces) -> Vec<u32> {
    let mut face_of = vec![0u32; faces.corners.len()];
    for (f, run) in faces.starts.windows(2).enumerate() {
        face_of[run[0] as usize..run[1] as usize].fill(f as u32);
    }
    face_of
}

/// For each vertex the least one that faces join it to.
fn joined(vertices: usize, faces: &Faces) -> Vec<u32> {
    let mut sets = Sets::new(vertices);
    for face in faces.iter() {
        for &v in &face[1..] {
            sets.join(face[0], v);
        }
    }
    sets.flatten()
}

/// Labels `0..count` in order of first appearance, for any below `range`.
fn number_by_first(labels: &mut [u32], range: usize) -> u32 {
    let mut numbers = vec![u32::MAX; range];
    let mut count = 0;
    for label in labels {
        let number = &mut numbers[*label as usize];
        if *number == u32::MAX {
            *number = count;
            count += 1;
        }
        *label = *number;
    }
    count
}

/// The number of components of faces that share vertices.
fn by_vertices(vertices: usize, faces: &Faces) -> u32 {
    let mut used = vec![false; vertices];
    for &v in &faces.corners {
        used[v as usize] = true;
    }
    let roots = joined(vertices, faces);
    let is_root = |&v: &usize| used[v] && roots[v] as usize == v;
    (0..vertices).filter(is_root).count() as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PolygonMesh;

    fn topology(vertices: usize, list: &[&[u32]]) -> (Topology, Faces) {
        let mut mesh = PolygonMesh::with_vertices(vec![[0.0; 3]; vertices]);
        list.iter().for_each(|f| mesh.push_face(f));
        let faces = Faces::of(&mesh, |_, _| panic!("good faces"));
        (Topology::of(vertices, &faces), faces)
    }

    #[test]
    fn two_squares_in_a_strip() {
        let (t, faces) = topology(6, &[&[0, 1, 2, 3], &[1, 4, 5, 2]]);
        assert_eq!((t.edges, t.bad.len(), t.components), (7, 6, 1));
        assert_eq!(t.shell, [0, 0]);
        assert_eq!(t.fans, [1; 6]);
        assert_eq!(t.loops(&faces), [1]);
    }

    #[test]
    fn squares_that_share_a_corner_are_one_component_of_two_shells() {
        let (t, faces) = topology(7, &[&[0, 1, 2, 3], &[2, 4, 5, 6]]);
        assert_eq!((t.components, t.fans[2]), (1, 2));
        assert_eq!(t.shell, [0, 1]);
        assert_eq!(t.shell_edges, [4, 4]);
        assert_eq!(t.loops(&faces), [1, 1]);
    }

    /// Closed meshes, told both ways: two tetrahedra apart, sharing a vertex,
    /// and two triangles back to back.
    #[test]
    fn the_quick_way_tells_the_same_of_closed_meshes() {
        let tetrahedron = |v: [u32; 4]| {
            [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|f| f.map(|k: usize| v[k]))
        };
        let apart = [tetrahedron([1, 2, 3, 4]), tetrahedron([8, 5, 7, 6])].concat();
        let pinched = [tetrahedron([4, 2, 3, 1]), tetrahedron([4, 5, 7, 6])].concat();
        let flat = vec![[0, 1, 2], [2, 1, 0]];
        for (list, fans) in [(apart, 1), (pinched, 2), (flat, 1)] {
            let list: Vec<&[u32]> = list.iter().map(|t| &t[..]).collect();
            let (quick, faces) = topology(9, &list);
            let slow = Topology::general(9, &faces);
            assert!(quick.twins.is_some() && slow.bad.is_empty());
            assert_eq!(quick.fans.iter().max(), Some(&fans));
            assert_eq!(quick.edges, slow.edges);
            assert_eq!(quick.fan, slow.fan);
            assert_eq!(quick.fans, slow.fans);
            assert_eq!(quick.shell, slow.shell);
            assert_eq!(quick.shell_edges, slow.shell_edges);
            assert_eq!(quick.components, slow.components);
        }
    }

    #[test]
    fn four_faces_at_an_edge_are_no_quick_way() {
        let (t, _) = topology(4, &[&[0, 1, 2], &[2, 1, 0], &[0, 1, 3], &[3, 1, 0]]);
        assert!(t.twins.is_none());
        assert_eq!(t.bad.len(), 1);
    }
}
