//! From a clean crust to a mesh that bounds a solid and is worth having: few
//! and good triangles, and no two of them cross or touch where they share
//! nothing, decided exactly on the coordinates as written.
//!
//! Exact power faces never cross. What makes them cross, and what is done:
//!
//! - **Rounding of power vertices.** Orthocentres are quotients. Where the
//!   diagram is nearly degenerate, they come out in the wrong order along an
//!   edge by some last bits, and needles fold over their neighbours. Nearly
//!   all of them go when vertices that are no samples are drawn into their
//!   neighbours (`mend_coarsen`): the needles are what goes first.
//! - **Moved vertices.** A ball is rounded to the lattice and may be merged
//!   with others (fact F6), so the power vertex that stands for a sample lies
//!   beside it; putting it there (fact F2) can fold a thin face. The same cure.
//! - **Polygons cut into triangles.** The corners of a power face lie on a
//!   plane but for rounding; two diagonals of neighbours in nearly the same
//!   plane can pass on the wrong sides of each other. Turning one of them is
//!   the cure.
//! - **Pinches.** Where the solid comes to a point or to an edge from two
//!   sides, sheets touch in different vertices at one place. They are drawn
//!   apart into their own insides (`mend_pinch`).
//! - **Thin sheets.** Where two sheets pass closer than the surface moved in
//!   the steps above, they can pierce each other.
//!
//! - **Plane faces.** Pieces of one power face that share no vertex lie in one
//!   plane to the last bit. They do not meet, but tests that are not exact may
//!   say so; vertices leave the plane by a hair (`unlevel`), samples by no more
//!   than what tells two of them apart, and not where all must be met.
//!
//! Before all that, power vertices are moved onto the surface (`mend_place`), and amid noise
//! handles thinner than it are cut (`handles`).
//!
//! What an exact search of all pairs still finds is mended on the spot by
//! small changes that are kept only if the exact count of bad contacts falls
//! (`mend_local`). A last resort is left to the caller, who knows the balls:
//! where a pair resists, a ball changes sides, so that the surface runs
//! elsewhere (see the pipeline). That ends, for at the latest where no
//! cell is inside no surface is left.

use super::handles::cut_handles;
use super::mend_blocks::coarsen_new;
use super::mend_coarsen::{coarsen_some, Coarsened};
use super::mend_local::{mend, Mended, LEVELS};
use super::mend_mesh::TriMesh;
use super::mend_pinch::draw_apart;
use super::mend_place::{settle, unlevel, Near, Sides};
use super::mend_shell::{least_area, thin, Shells};
use super::raw::{Crust, NONE};
use crate::context::{Cancelled, Context, Stage};
use crate::geom::vec3::{norm, sub};
use crate::geom::{Ball, Point};
use crate::mesh::clash::Clash;
use crate::stats::Laps;
use rayon::prelude::*;

/// The surface never moves by more than this share of the spacing, nor of the
/// radius of the balls beside it.
const MOST: f64 = 0.05;
/// Moves by this share of the spacing count for nothing.
const NOTHING: f64 = 0.004;

/// Power vertices leave the planes of their faces by this share of the spacing.
const UNLEVEL: f64 = 1e-6;

/// How to mend.
pub struct MendOptions<'a> {
    /// How far the surface may move to lose a vertex that is no sample, as a
    /// share of the sampling error `h² / 2r`; 0 leaves all that do no harm.
    pub flatness: f64,
    /// How far a surface without samples may move to lose a vertex, in the
    /// units of the mesh; `flatness` says nothing then, and vertices are not
    /// moved onto the surface that the samples tell of.
    pub tolerance: Option<f64>,
    /// New positions are rounded to single precision, as those given are.
    pub single: bool,
    /// Samples stay where they are to the last bit, also in planes.
    pub keep_samples: bool,
    /// The spacing at each sample, in the units of the mesh.
    pub spacing: &'a (dyn Fn(u32) -> f64 + Sync),
    /// How long a loop around a handle may be at each sample for the handle to be cut, in the
    /// units of the mesh; `None` cuts none.
    pub handles: Option<&'a (dyn Fn(u32) -> f64 + Sync)>,
    /// Each ball, in the units of the mesh.
    pub ball: &'a (dyn Fn(u32) -> Option<Ball> + Sync),
}

/// A mended crust of triangles and what was done.
#[derive(Clone, Debug, Default)]
pub struct Mending {
    /// The mended surface.
    pub crust: Crust,
    /// The face of the crust given that each triangle comes from.
    pub source: Vec<u32>,
    /// Vertices that are no samples moved onto the surface.
    pub settled: usize,
    /// Vertices drawn into neighbours to coarsen the mesh.
    pub collapsed: usize,
    /// Edges turned for better angles.
    pub flipped: usize,
    /// Handles thinner than the noise that were cut.
    pub handles_cut: usize,
    /// Vertices drawn apart where sheets touched.
    pub drawn_apart: usize,
    /// Pairs of triangles that crossed or touched, and triangles of no area.
    pub found: usize,
    /// Those of them that are left, by the balls of the faces they lie on.
    pub left: Vec<[[u32; 2]; 2]>,
    /// Changes made to mend them.
    pub changes: usize,
    /// Samples that had to go.
    pub samples_lost: usize,
    /// Rounds of mending.
    pub rounds: usize,
    /// Seconds by step, in order.
    pub seconds: Vec<(&'static str, f64)>,
}

/// Mends a closed manifold crust of triangles.
pub fn mend_crust(crust: Crust, options: &MendOptions, cx: &Context) -> Result<Mending, Cancelled> {
    let mut laps = Laps::start();
    let (clash, mut points) = Clash::new(&crust.mesh.vertices);
    let round = |p: Point| match options.single {
        true => clash.enter(clash.leave(p).map(|x| f64::from(x as f32))),
        false => p,
    };
    if options.single {
        points.iter_mut().for_each(|p| *p = round(*p));
    }
    cx.advance(Stage::Crust, 1, 3)?;
    let mut mesh = TriMesh::new(&crust, &points);
    drop(points);
    let face_balls = crust.face_balls;
    drop(crust.mesh);
    laps.lap("half-edges");
    cx.advance(Stage::Crust, 1, 3)?;
    let mut done = Mending::default();
    let length = |l: f64| clash.enter([l, 0.0, 0.0])[0];
    let near = Near::of(&mesh);
    let mut spacing = near.spread(&mesh, |s| length((options.spacing)(s)));
    laps.lap("spacing");
    if let Some(tolerance) = options.tolerance {
        spacing = longest_edges(&mesh);
        if tolerance > 0.0 {
            let everywhere = vec![length(tolerance); spacing.len()];
            let Coarsened { collapsed, flipped } = coarsen_new(&mut mesh, &everywhere, cx)?;
            (done.collapsed, done.flipped) = (collapsed, flipped);
            mesh.compact(&mut spacing);
            laps.lap("coarsen");
            unlevel(&mut mesh, UNLEVEL, !options.keep_samples, &spacing, &round);
        }
    } else if options.flatness > 0.0 {
        let last = face_balls.iter().flatten().filter(|&&b| b != NONE).max();
        let balls: Vec<Option<Ball>> = (0..last.map_or(0, |b| b + 1))
            .into_par_iter()
            .map(|b| (options.ball)(b))
            .collect();
        let sides = Sides::of(&mesh, &|t| {
            let pair = face_balls[mesh.source[t as usize] as usize];
            pair.map(|b| balls.get(b as usize).copied().flatten())
        });
        drop(balls);
        cx.advance(Stage::Crust, 1, 3)?;
        let error = |h: f64, r: f64| (h * h / (2.0 * r)).min(MOST * h).min(MOST * r);
        let limit: Vec<f64> = (spacing.iter().zip(&sides.radii))
            .map(|(&h, &r)| error(h, length(f64::from(r))))
            .collect();
        laps.lap("limits");
        done.settled = settle(&mut mesh, &sides, &near, &limit, &round);
        drop((sides, near));
        laps.lap("settle");
        let tolerance: Vec<f64> = (limit.iter().zip(&spacing))
            .map(|(e, h)| (options.flatness * e).max(NOTHING * h))
            .collect();
        drop(limit);
        let Coarsened { collapsed, flipped } = coarsen_new(&mut mesh, &tolerance, cx)?;
        (done.collapsed, done.flipped) = (collapsed, flipped);
        cx.advance(Stage::Crust, 1, 3)?;
        mesh.compact(&mut spacing);
        laps.lap("coarsen");
        unlevel(&mut mesh, UNLEVEL, !options.keep_samples, &spacing, &round);
    }
    if let Some(handles) = options.handles {
        let mut most = Near::of(&mesh).spread(&mesh, |s| length(handles(s)));
        done.handles_cut = cut_handles(&mut mesh, &mut most, &clash, &round, cx)?;
        // Vertices of caps stay where they are.
        spacing.resize(mesh.points.len(), 0.0);
        laps.lap("handles");
    }
    let shells = Shells::of(&mesh);
    let moved = draw_apart(&mut mesh, &round);
    done.drawn_apart = moved.len();
    mesh.free(&moved);
    laps.lap("draw apart");
    let mut tree = clash.tree(&mesh.points, &mesh.tris);
    let pairs = clash.pairs(&tree, &mesh.points, &mesh.tris, cx)?;
    done.found = pairs.len();
    laps.lap("search");
    let gentle = LEVELS - 1;
    let (first, mut left) = mend(&mut mesh, &clash, &mut tree, pairs, 0.0, gentle, &round, cx)?;
    let mut more = Mended::default();
    if !left.is_empty() {
        // Around what resists the mesh may be coarser, before samples go.
        let tolerance = around(&mesh, &left, &spacing);
        let before = mesh.tris.clone();
        coarsen_some(&mut mesh, &tolerance, cx)?;
        let mut changed: Vec<u32> = (0..before.len() as u32)
            .filter(|&t| before[t as usize] != mesh.tris[t as usize])
            .collect();
        for &t in &changed {
            tree.place(t, mesh.alive(t).then(|| mesh.place(t)).as_ref());
        }
        changed.extend(left.iter().flat_map(|&(s, t)| [s, t]));
        let pairs = clash.pairs_of(&tree, &mesh.points, &mesh.tris, &changed);
        (more, left) = mend(&mut mesh, &clash, &mut tree, pairs, 0.0, LEVELS, &round, cx)?;
    }
    laps.lap("mend");
    if left.is_empty() {
        let least = least_area(&mesh);
        let pairs = thin(&mesh, least);
        if !pairs.is_empty() {
            let (second, mut rest) = mend(
                &mut mesh, &clash, &mut tree, pairs, least, gentle, &round, cx,
            )?;
            // What is no worse than thin may stay.
            rest.retain(|&(s, t)| s != t || clash.is_flat(&mesh.place(s)));
            left = rest;
            done.changes += second.changes;
        }
        laps.lap("thin");
        done.samples_lost += shells.take_out_reversed(&mut mesh, &clash, &tree);
        laps.lap("shells");
    }
    done.changes += first.changes + more.changes;
    done.samples_lost += more.samples_lost;
    done.rounds = first.rounds + more.rounds;
    let balls_of = |t: u32| face_balls[mesh.source[t as usize] as usize];
    done.left = (left.iter()).map(|&(s, t)| [s, t].map(balls_of)).collect();
    (done.crust, done.source) = mesh.finish(&face_balls, |p| clash.leave(p));
    laps.lap("finish");
    done.seconds = laps.seconds;
    Ok(done)
}

/// The longest edge at each vertex.
fn longest_edges(mesh: &TriMesh) -> Vec<f64> {
    let mut longest = vec![0.0f64; mesh.points.len()];
    for t in &mesh.tris {
        for k in 0..3 {
            let [v, w] = [t[k], t[(k + 1) % 3]].map(|v| v as usize);
            let length = norm(sub(mesh.points[v], mesh.points[w]));
            for end in [v, w] {
                longest[end] = longest[end].max(length);
            }
        }
    }
    longest
}

/// How far the surface may move near triangles that resist: nowhere else.
fn around(mesh: &TriMesh, pairs: &[(u32, u32)], spacing: &[f64]) -> Vec<f64> {
    let mut tolerance = vec![0.0; spacing.len()];
    let mut fan = Vec::new();
    let triangles = pairs.iter().flat_map(|&(s, t)| [s, t]);
    let mut front: Vec<u32> = triangles.flat_map(|t| mesh.tris[t as usize]).collect();
    for _ in 0..3 {
        for k in 0..front.len() {
            mesh.fan(front[k], &mut fan);
            front.extend(fan.iter().map(|&h| mesh.head(h)));
        }
        front.sort_unstable();
        front.dedup();
    }
    for v in front {
        tolerance[v as usize] = MOST * spacing[v as usize];
    }
    tolerance
}
