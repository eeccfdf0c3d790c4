//! What a finished crust must satisfy, checked the slow and plain way: from
//! vertex indices alone, by sorting. Used by the tests of clean-up.

use super::flat::{collinear, vector_area};
use super::raw::Crust;

/// One thing that is wrong with a crust.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Finding {
    Sizes,
    OutOfRange { corner: usize },
    FewCorners { face: usize },
    Repeats { face: usize, vertex: u32 },
    NoArea { face: usize },
    Repeated { from: u32, to: u32 },
    Open { from: u32, to: u32 },
    Pinched { vertex: u32, fans: u32 },
    Unused { vertex: u32 },
}

/// All that is wrong with `crust`.
pub(crate) fn check(crust: &Crust) -> Vec<Finding> {
    let mesh = &crust.mesh;
    let mut found = Vec::new();
    let n = mesh.vertices.len();
    if crust.vertex_samples.len() != n || crust.face_balls.len() != mesh.face_count() {
        found.push(Finding::Sizes);
    }
    if let Some(corner) = mesh.corners.iter().position(|&v| v as usize >= n) {
        return vec![Finding::OutOfRange { corner }];
    }
    // Directed edges with the corner where they start and the next corner.
    let mut edges = Vec::new();
    for (f, face) in mesh.faces().enumerate() {
        if face.len() < 3 {
            found.push(Finding::FewCorners { face: f });
            continue;
        }
        let mut sorted = face.to_vec();
        sorted.sort_unstable();
        if let Some(two) = sorted.windows(2).find(|two| two[0] == two[1]) {
            let vertex = two[0];
            found.push(Finding::Repeats { face: f, vertex });
        }
        let at = |k: usize| mesh.vertices[face[k % face.len()] as usize];
        let line = (0..face.len()).all(|i| (0..i).all(|j| collinear(at(0), at(i), at(j))));
        if line || vector_area((0..face.len()).map(at)) == [0.0; 3] {
            found.push(Finding::NoArea { face: f });
        }
        let start = mesh.starts[f];
        for k in 0..face.len() {
            let next = (k + 1) % face.len();
            edges.push((face[k], face[next], start + k as u32, start + next as u32));
        }
    }
    edges.sort_unstable();
    for two in edges.windows(2) {
        if (two[0].0, two[0].1) == (two[1].0, two[1].1) {
            let (from, to, ..) = two[0];
            found.push(Finding::Repeated { from, to });
        }
    }
    // Corners of one fan, joined across edges.
    let mut leader: Vec<u32> = (0..mesh.corners.len() as u32).collect();
    fn find(leader: &mut [u32], mut c: u32) -> u32 {
        while leader[c as usize] != c {
            leader[c as usize] = leader[leader[c as usize] as usize];
            c = leader[c as usize];
        }
        c
    }
    for &(from, to, here, _) in &edges {
        let mate = edges.partition_point(|e| (e.0, e.1) < (to, from));
        match edges.get(mate) {
            Some(&(a, b, _, there)) if (a, b) == (to, from) => {
                let (here, there) = (find(&mut leader, here), find(&mut leader, there));
                leader[here as usize] = there;
            }
            _ => found.push(Finding::Open { from, to }),
        }
    }
    let mut fans = vec![0; n];
    for c in 0..mesh.corners.len() as u32 {
        if find(&mut leader, c) == c {
            fans[mesh.corners[c as usize] as usize] += 1;
        }
    }
    for (vertex, &fans) in (0u32..).zip(&fans) {
        match fans {
            0 => found.push(Finding::Unused { vertex }),
            1 => {}
            _ => found.push(Finding::Pinched { vertex, fans }),
        }
    }
    found
}
