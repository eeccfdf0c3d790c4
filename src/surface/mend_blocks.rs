//! Coarsening a large mesh piece by piece, the pieces side by side.
//!
//! A piece is the triangles whose least vertices lie in one stretch of the
//! curve along which vertices are numbered. A change by [`Work`] at vertices all of whose
//! triangles are in the piece reads and writes nothing outside it, so pieces do not
//! know of each other. What was put off at their borders is done afterwards, in the whole mesh.
//!
//! The stretches have a fixed length: the result does not depend on the number
//! of threads. On one thread it takes as long as in one piece.

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

fn by_pieces(
    mesh: &mut TriMesh,
    tolerance: &[f64],
    stretch: usize,
    cx: &Context,
) -> Result<Coarsened, Cancelled> {
    // Each piece puts its triangles back where they were.
    let mut tris = std::mem::take(&mut mesh.tris);
    let mut twin = std::mem::take(&mut mesh.twin);
    let pieces = pieces(&mut tris, &mut twin, mesh.points.len(), stretch);
    let around = &*mesh;
    let coarse: Vec<Coarse> = (pieces.into_par_iter())
        .with_max_len(1)
        .map(|piece| piece.coarse(around, tolerance, cx))
        .collect::<Result<_, Cancelled>>()?;
    (mesh.tris, mesh.twin) = (tris, twin);
    let mut done = Coarsened::default();
    let mut moved = vec![0.0; tolerance.len()];
    let mut todo = vec![false; tolerance.len()];
    let mut border = vec![false; tolerance.len()];
    for piece in coarse {
        for (v, out, by) in piece.whole {
            mesh.out[v as usize] = out;
            moved[v as usize] = by;
        }
        (piece.border.iter()).for_each(|&v| border[v as usize] = true);
        (piece.put_off.iter()).for_each(|&v| todo[v as usize] = true);
        done += piece.done;
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

/// The triangles of a stretch.
struct Piece<'a> {
    tris: &'a mut [[u32; 3]],
    twin: &'a mut [u32],
    /// The number of its first half-edge.
    first: usize,
    /// The stretch.
    own: Range<u32>,
}

/// What became of a piece, by the numbers of the whole mesh.
struct Coarse {
    /// Its whole vertices: a half-edge at each, and how far it has moved.
    whole: Vec<(u32, u32, f64)>,
    border: Vec<u32>,
    put_off: Vec<u32>,
    done: Coarsened,
}

fn pieces<'a>(
    mut tris: &'a mut [[u32; 3]],
    mut twin: &'a mut [u32],
    vertices: usize,
    stretch: usize,
) -> Vec<Piece<'a>> {
    let least = |t: &[u32; 3]| t[0].min(t[1]).min(t[2]) as usize;
    debug_assert!(tris.is_sorted_by_key(least));
    let mut pieces = Vec::new();
    let mut first = 0;
    for from in (0..vertices).step_by(stretch) {
        let to = vertices.min(from + stretch);
        let count = tris.partition_point(|t| least(t) < to);
        let (of_piece, rest) = tris.split_at_mut(count);
        let (twins_of_piece, twins) = twin.split_at_mut(3 * count);
        (tris, twin) = (rest, twins);
        pieces.push(Piece {
            tris: of_piece,
            twin: twins_of_piece,
            first,
            own: from as u32..to as u32,
        });
        first += 3 * count;
    }
    pieces
}

impl Piece<'_> {
    /// Coarsens all but the border.
    fn coarse(self, of: &TriMesh, tolerance: &[f64], cx: &Context) -> Result<Coarse, Cancelled> {
        let (mut mesh, vertices) = of.piece(self.tris, self.twin, self.first, self.own);
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
        let number = |v: u32| match v {
            NONE => NONE,
            v => vertices[v as usize],
        };
        let half_edge = |h: u32| match h {
            NONE => NONE,
            h => self.first as u32 + h,
        };
        for (into, tri) in self.tris.iter_mut().zip(&mesh.tris) {
            *into = tri.map(number);
        }
        for (into, &twin) in self.twin.iter_mut().zip(&mesh.twin) {
            if twin != NONE {
                *into = half_edge(twin);
            }
        }
        let all = || 0..vertices.len();
        Ok(Coarse {
            whole: (all().filter(|&k| whole[k]))
                .map(|k| (vertices[k], half_edge(mesh.out[k]), moved[k]))
                .collect(),
            border: all().filter(|&k| !whole[k]).map(|k| vertices[k]).collect(),
            put_off: put_off.into_iter().map(number).collect(),
            done,
        })
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
        let by_threads = [1, 3].map(|threads| {
            let context = Context {
                threads: std::num::NonZero::new(threads),
                ..Context::default()
            };
            context.install(|| {
                let mut mesh = TriMesh::new(&crust, &crust.mesh.vertices);
                let tolerance = vec![0.02; mesh.points.len()];
                by_pieces(&mut mesh, &tolerance, 300, &context).map(|_| ())?;
                Ok::<_, Cancelled>((mesh.tris, mesh.twin))
            })
        });
        assert!(by_threads[0] == by_threads[1] && by_threads[0].is_ok());
        for stretch in [50, 300, 1000, 4000] {
            let left = coarse(stretch);
            assert!(
                left.abs_diff(whole) * 20 < whole,
                "{stretch}: {left} {whole}"
            );
        }
    }
}
