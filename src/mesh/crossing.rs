//! All pairs of triangles of a mesh that meet where they share nothing.

use super::bvh::{Bvh, Cuboid};
use super::frame::{Frame, Kernel};
use super::intersect::{contact, Contact, Twins};
use super::soup::{place, Triangles};
use crate::context::{Cancelled, Context, Stage};
use rayon::prelude::*;
use std::cmp::Ordering;
use std::sync::atomic::AtomicU8;
use std::sync::atomic::Ordering::Relaxed;

/// How two faces meet beyond the vertices they share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// Interiors meet.
    Crossing,
    /// Borders or corners touch.
    Touching,
    /// Different vertices at one position, and nothing else.
    Coincident,
}

const KINDS: usize = 3;

/// What was found, by [`Kind`].
pub(super) struct Crossings {
    /// Pairs of triangles.
    pub pairs: [u64; KINDS],
    /// Faces that take part.
    pub faces: [u64; KINDS],
    /// The first pairs of faces in order, each once.
    pub found: [Vec<(u32, u32)>; KINDS],
}

/// What one task of the join found.
#[derive(Default)]
struct Part {
    pairs: [u64; KINDS],
    found: [Vec<(u32, u32)>; KINDS],
}

/// Sorts pairs, drops doubles, keeps the first `max`.
fn keep(found: &mut Vec<(u32, u32)>, max: usize) {
    found.sort_unstable();
    found.dedup();
    found.truncate(max);
}

/// The triangles of a mesh in a tree.
pub(super) struct Field<'a> {
    pub frame: &'a Frame,
    pub triangles: &'a Triangles,
    pub bvh: Bvh,
    /// By slot of the tree, so that neighbours in space are neighbours in
    /// memory: the triangle, and for each of its corners the first vertex at
    /// that position.
    pub slots: Vec<(u32, [u32; 3])>,
}

impl<'a> Field<'a> {
    /// Takes the triangles that are not to be skipped: those of positive area
    /// whose corners are finite. `canonical` maps a vertex to the first
    /// vertex at its position.
    pub fn new(
        frame: &'a Frame,
        canonical: &[u32],
        triangles: &'a Triangles,
        skip: &[bool],
    ) -> Field<'a> {
        let listed: Vec<u32> = (0..skip.len() as u32)
            .filter(|&t| !skip[t as usize])
            .collect();
        let corners = |t: u32| triangles.corners[t as usize];
        let boxes: Vec<Cuboid> = listed
            .par_iter()
            .map(|&t| Cuboid::of(&place(&frame.points, corners(t))))
            .collect();
        let bvh = Bvh::new(&boxes);
        let slots = (bvh.order.par_iter())
            .map(|&k| {
                let t = listed[k as usize];
                (t, corners(t).map(|v| canonical[v as usize]))
            })
            .collect();
        Field {
            frame,
            triangles,
            bvh,
            slots,
        }
    }
}

/// Tests all pairs of triangles; `faces` is the number of faces.
pub(super) fn crossings(
    field: &Field,
    faces: usize,
    max: usize,
    cx: &Context,
) -> Result<Crossings, Cancelled> {
    let (frame, triangles, slots) = (field.frame, field.triangles, &field.slots);
    let corners = |t: u32| triangles.corners[t as usize];
    let marks: Vec<AtomicU8> = (0..faces).map(|_| AtomicU8::new(0)).collect();
    let parts = field.bvh.self_join(
        |part: &mut Part, i, j| {
            let ((s, a), (t, b)) = (slots[i as usize], slots[j as usize]);
            let Some(kind) = judge(frame, a, b, || (corners(s), corners(t))) else {
                return;
            };
            let (f, g) = (triangles.face[s as usize], triangles.face[t as usize]);
            let k = kind as usize;
            part.pairs[k] += 1;
            for face in [f, g] {
                marks[face as usize].fetch_or(1 << k, Relaxed);
            }
            part.found[k].push((f.min(g), f.max(g)));
            if part.found[k].len() > max.saturating_mul(2).saturating_add(64) {
                keep(&mut part.found[k], max);
            }
        },
        |done, total| cx.advance(Stage::Check, done, total),
    )?;
    let mut all = Crossings {
        pairs: [0; KINDS],
        faces: [0; KINDS],
        found: Default::default(),
    };
    for part in parts {
        for k in 0..KINDS {
            all.pairs[k] += part.pairs[k];
            all.found[k].extend_from_slice(&part.found[k]);
        }
    }
    for k in 0..KINDS {
        keep(&mut all.found[k], max);
        let marked = |m: &&AtomicU8| m.load(Relaxed) & (1 << k) != 0;
        all.faces[k] = marks.iter().filter(marked).count() as u64;
    }
    Ok(all)
}

/// What is wrong with two triangles given by canonical vertices, if anything.
/// `originals` tells their own vertices.
#[inline]
fn judge(
    frame: &Frame,
    a: [u32; 3],
    b: [u32; 3],
    originals: impl FnOnce() -> ([u32; 3], [u32; 3]),
) -> Option<Kind> {
    let mut twins: Twins = [None; 3];
    let mut shared = 0;
    for (twin, v) in twins.iter_mut().zip(a) {
        *twin = b.iter().position(|&w| w == v).map(|j| j as u8);
        shared += twin.is_some() as usize;
    }
    let (pa, pb) = (place(&frame.points, a), place(&frame.points, b));
    match contact(frame.kernel, &pa, &pb, &twins) {
        Contact::Disjoint => None,
        Contact::Crossing => Some(Kind::Crossing),
        Contact::Touching => Some(Kind::Touching),
        Contact::Shared => {
            let (a, b) = originals();
            let same = a.iter().filter(|v| b.contains(v)).count();
            (same != shared).then_some(Kind::Coincident)
        }
    }
}

/// The first vertex at each vertex's position, and how many vertices are not
/// the first at theirs. Vertices that are not finite stand for themselves.
pub(super) fn coincidences(frame: &Frame, finite: &[bool]) -> (Vec<u32>, u64) {
    let points = &frame.points;
    // Adding zero turns -0 into 0.
    let key = |v: u32| points[v as usize].map(|x| x + 0.0);
    let hash = |v: u32| {
        (key(v).iter()).fold(0u64, |h, x| {
            (h ^ x.to_bits())
                .wrapping_mul(0x9e37_79b9_7f4a_7c15)
                .rotate_left(29)
        })
    };
    let mut order: Vec<(u64, u32)> = (0..points.len() as u32)
        .into_par_iter()
        .filter(|&v| finite[v as usize])
        .map(|v| (hash(v), v))
        .collect();
    order.par_sort_unstable();
    let mut canonical: Vec<u32> = (0..points.len() as u32).collect();
    let mut doubles = 0;
    for alike in order
        .chunk_by_mut(|a, b| a.0 == b.0)
        .filter(|g| g.len() > 1)
    {
        // Of one hash, and nearly always at one place.
        alike.sort_by(|&(_, v), &(_, w)| key(v).partial_cmp(&key(w)).unwrap_or(Ordering::Equal));
        for group in alike.chunk_by(|&(_, v), &(_, w)| key(v) == key(w)) {
            for &(_, v) in &group[1..] {
                canonical[v as usize] = group[0].1;
                doubles += 1;
            }
        }
    }
    (canonical, doubles)
}

/// Which triangles have exactly no area, by signs.
pub(super) fn flat(frame: &Frame, triangles: &Triangles) -> Vec<bool> {
    let kernel: Kernel = frame.kernel;
    (triangles.corners.par_iter())
        .map(|&t| {
            let repeated = t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
            repeated || kernel.projection(&place(&frame.points, t)).is_none()
        })
        .collect()
}
