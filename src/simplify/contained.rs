//! Redundant balls of a medial axis (section 7.3 of the paper).
//!
//! Largest first, a ball `B(c, rho)` takes out a neighbour `B(p, mu)` that is
//! contained in `B(c, rho + delta)`, then the neighbours of what it took out,
//! and so on. The paper asks for `mu < rho`; here equal balls have an order
//! too, that of their ids. The walk passes through balls that went before, so
//! that what they were joined to is still near. Every ball that goes lies
//! within `delta` of one that stays.

use crate::context::{Cancelled, Portion};
use crate::geom::vec3::dist_sq;
use crate::geom::Ball;
use crate::tetra::Edges;

/// Balls looked at between two reports of progress.
const REPORT: usize = 1 << 12;

/// The redundant ones among the balls that `alive` says are there, in the
/// order they go, each with the ball that holds it. Balls take out others for which `alike` holds only: those
/// on their side.
///
/// # Errors
/// [`Cancelled`].
pub fn redundant(
    balls: &[Ball],
    alive: &[bool],
    alike: &(dyn Fn(u32, u32) -> bool + Sync),
    graph: &Edges,
    delta: f64,
    progress: &Portion,
) -> Result<Vec<[u32; 2]>, Cancelled> {
    let radius = |b: u32| balls[b as usize].radius;
    let mut order: Vec<u32> = (0..balls.len() as u32)
        .filter(|&b| alive[b as usize])
        .collect();
    order.sort_unstable_by(|&a, &b| radius(b).total_cmp(&radius(a)).then(a.cmp(&b)));
    let mut rank = vec![u32::MAX; balls.len()];
    for (k, &b) in order.iter().enumerate() {
        rank[b as usize] = k as u32;
    }
    let mut there = alive.to_vec();
    let mut gone = Vec::new();
    let mut met = vec![u32::MAX; balls.len()];
    let mut front = Vec::new();
    for (done, &c) in order.iter().enumerate() {
        if done.is_multiple_of(REPORT) {
            progress.advance(done, order.len())?;
        }
        if !there[c as usize] {
            continue;
        }
        met[c as usize] = c;
        front.clear();
        front.push(c);
        while let Some(b) = front.pop() {
            for &p in graph.at(b) {
                if std::mem::replace(&mut met[p as usize], c) == c
                    || !alike(c, p)
                    || !contained(&balls[p as usize], &balls[c as usize], delta)
                {
                    continue;
                }
                if !there[p as usize] {
                    front.push(p);
                } else if rank[p as usize] > done as u32 {
                    there[p as usize] = false;
                    gone.push([p, c]);
                    front.push(p);
                }
            }
        }
    }
    Ok(gone)
}

/// Whether a ball lies in another one whose radius is larger by `delta`.
#[inline]
fn contained(small: &Ball, large: &Ball, delta: f64) -> bool {
    let room = large.radius + delta - small.radius;
    room >= 0.0 && dist_sq(small.centre, large.centre) <= room * room
}
