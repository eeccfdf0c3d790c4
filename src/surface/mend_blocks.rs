//! Coarsening a large mesh piece by piece, the pieces side by side.
//!
//! A piece is the triangles whose least vertices lie in one stretch of the
//! curve along which vertices are numbered. A change by [`Work`] at vertices all of whose
//! triangles are in the piece reads and writes nothing outside it, so pieces do not
//! know of each other. What was put off at their borders is done afterwards, in the whole mesh.
//!
//! The stretches have a fixed length: the result does not depend on the number
//! of threads. It is also faster on one, as a piece stays in the caches for all its rounds.

use std::ops::Range;

use rayon::prelude::*;

use super::mend_coarsen::{coarsen, Coarsened, Work};
use super::mend_mesh::TriMesh;
use super::raw::NONE;
use crate::context::{Cancelled, Context};

/// Vertices of a stretch.
const STRETCH: usize = 1 << 15;

/// [`coarsen`] for a mesh just made: its triangles must be sorted by their least vertices.
pub(super) fn coarsen_new(
    mesh: &mut TriMesh,
    tolerance: &[f64],
    cx: &Context,
) -> Result<Coarsened, Cancelled> {
    match mesh.points.len() > 2 * STRETCH {
        true => by_pieces(mesh, tolerance, STRETCH, cx),
        false => coarsen(mesh, tolerance, cx),
    }
}

/// A piece as it came out.
struct Piece {
    triangles: Range<usize>,
    mesh: TriMesh,
    /// The numbers of its vertices in the whole mesh.
    vertices: Vec<u32>,
    whole: Vec<bool>,
    moved: Vec<f64>,
    put_off: Vec<u32>,
    done: Coarsened,
}

fn by_pieces(
    mesh: &mut TriMesh,
    tolerance: &[f64],
    stretch: usize,
    cx: &Context,
) -> Result<Coarsened, Cancelled> {
    let mut done = Coarsened::default();
    let mut moved = vec![0.0; tolerance.len()];
    let mut todo = vec![false; tolerance.len()];
    let mut border = vec![false; tolerance.len()];
    let pieces = pieces(mesh, stretch);
    // As many at a time as keep all threads at work: they take memory.
    for some in pieces.chunks(4 * rayon::current_num_threads()) {
        let coarse: Vec<Piece> = (some.par_iter())
            .map(|(triangles, own)| {
                coarse_piece(mesh, triangles.clone(), own.clone(), tolerance, cx)
            })
            .collect::<Result<_, Cancelled>>()?;
        for piece in coarse {
            piece.put_back(mesh, &mut moved);
            for (&v, &whole) in piece.vertices.iter().zip(&piece.whole) {
                border[v as usize] |= !whole;
            }
            for &v in &piece.put_off {
                todo[piece.vertices[v as usize] as usize] = true;
            }
            done += piece.done;
        }
    }
    // Edges near the borders have not been looked at.
    let mut fresh = vec![0; tolerance.len()];
    for t in mesh.tris.iter().filter(|t| t[0] != NONE) {
        if t.iter().any(|&v| border[v as usize]) {
            t.iter().for_each(|&v| fresh[v as usize] = 1);
        }
    }
    drop(border);
    let mut work = Work::new(mesh, tolerance);
    (work.moved, work.todo, work.fresh) = (moved, todo, fresh);
    done += work.run(cx)?;
    Ok(done)
}

/// The triangles of the pieces, and the stretches.
fn pieces(mesh: &TriMesh, stretch: usize) -> Vec<(Range<usize>, Range<u32>)> {
    let least = |t: &[u32; 3]| t[0].min(t[1]).min(t[2]);
    debug_assert!(mesh.tris.is_sorted_by_key(least));
    let start = |v: usize| mesh.tris.partition_point(|t| (least(t) as usize) < v);
    let all = mesh.points.len();
    (0..all.div_ceil(stretch))
        .map(|k| k * stretch..all.min((k + 1) * stretch))
        .map(|own| {
            (
                start(own.start)..start(own.end),
                own.start as u32..own.end as u32,
            )
        })
        .filter(|(triangles, _)| !triangles.is_empty())
        .collect()
}

fn coarse_piece(
    of: &TriMesh,
    triangles: Range<usize>,
    own: Range<u32>,
    tolerance: &[f64],
    cx: &Context,
) -> Result<Piece, Cancelled> {
    let (mut mesh, vertices) = of.piece(triangles.clone(), own);
    let tolerance: Vec<f64> = vertices.iter().map(|&v| tolerance[v as usize]).collect();
    let mut whole: Vec<bool> = mesh.out.iter().map(|&h| h != NONE).collect();
    for h in (0..mesh.twin.len() as u32).filter(|&h| mesh.twin(h) == NONE) {
        whole[mesh.tail(h) as usize] = false;
        whole[mesh.head(h) as usize] = false;
    }
    let mut work = Work::new(&mut mesh, &tolerance);
    work.whole = whole;
    let done = work.run(cx)?;
    let (whole, moved, put_off) = (work.whole, work.moved, work.put_off);
    Ok(Piece {
        triangles,
        mesh,
        vertices,
        whole,
        moved,
        put_off,
        done,
    })
}

impl Piece {
    /// Puts what changed into the whole mesh.
    fn put_back(&self, into: &mut TriMesh, moved: &mut [f64]) {
        let first = self.triangles.start;
        let place = |v: u32| match v {
            NONE => NONE,
            v => self.vertices[v as usize],
        };
        let half_edge = |h: u32| match h {
            NONE => NONE,
            h => 3 * first as u32 + h,
        };
        for (into, tri) in into.tris[first..].iter_mut().zip(&self.mesh.tris) {
            *into = tri.map(place);
        }
        for (into, &twin) in into.twin[3 * first..].iter_mut().zip(&self.mesh.twin) {
            if twin != NONE {
                *into = half_edge(twin);
            }
        }
        for (k, &v) in self.vertices.iter().enumerate() {
            if self.whole[k] {
                into.out[v as usize] = half_edge(self.mesh.out[k]);
                moved[v as usize] = self.moved[k];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::PolygonMesh;
    use crate::surface::Crust;

    /// A torus of squares, a little uneven, cut in two.
    fn torus(n: u32) -> Crust {
        let mut mesh = PolygonMesh::with_vertices(Vec::new());
        let turn = std::f64::consts::TAU / f64::from(n);
        for k in 0..n * n {
            let (a, b) = (f64::from(k / n) * turn, f64::from(k % n) * turn);
            let r = 1.0 + 0.4 * (b + 0.3 * (3.0 * a).sin()).cos();
            (mesh.vertices).push([r * a.cos(), r * a.sin(), 0.4 * b.sin()]);
        }
        let at = |i: u32, j: u32| i % n * n + j % n;
        for k in 0..n * n {
            let (i, j) = (k / n, k % n);
            mesh.push_face(&[at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            mesh.push_face(&[at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
        Crust {
            vertex_samples: (0..n * n)
                .map(|v| if v % 7 == 0 { v } else { NONE })
                .collect(),
            face_balls: vec![[0, 1]; mesh.face_count()],
            mesh,
        }
    }

    #[test]
    fn pieces_make_a_closed_manifold_about_as_coarse_as_the_whole() {
        let crust = torus(60);
        let context = Context::default();
        let coarse = |stretch: usize| {
            let mut mesh = TriMesh::new(&crust, &crust.mesh.vertices);
            let tolerance = vec![0.02; mesh.points.len()];
            let done = match stretch {
                0 => coarsen(&mut mesh, &tolerance, &context),
                _ => by_pieces(&mut mesh, &tolerance, stretch, &context),
            };
            let done = done.unwrap();
            let all = mesh.out.len();
            let left = mesh.out.iter().filter(|&&h| h != NONE).count();
            assert_eq!(all - left, done.collapsed);
            for (v, &h) in mesh.out.iter().enumerate() {
                assert!(h == NONE || mesh.tail(h) == v as u32, "{v}");
            }
            for h in 0..mesh.twin.len() as u32 {
                if mesh.alive(h / 3) {
                    let t = mesh.twin(h);
                    assert_eq!((mesh.twin(t), mesh.tail(t)), (h, mesh.head(h)));
                }
            }
            let (crust, _) = mesh.finish(&crust.face_balls, |p| p);
            let report = crate::mesh::check(&crust.mesh, &Default::default(), &context);
            assert_eq!(report.unwrap().findings, []);
            left
        };
        let whole = coarse(0);
        assert!(whole < 2000, "{whole}");
        for stretch in [50, 300, 1000, 4000] {
            let left = coarse(stretch);
            assert!(
                left.abs_diff(whole) * 20 < whole,
                "{stretch}: {left} {whole}"
            );
        }
    }
}
