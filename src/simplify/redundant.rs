//! Merging balls that say the same, before the power diagram (fact F6).
//!
//! Where the medial axis is a curve or a point, as in pipes, tori, bolts and
//! spheres, poles crowd along it: every one of n thin cells reaches the
//! surface in a ring that crosses the square root of n outer cells. Section 7.3 removes
//! a ball contained in a slightly larger one, `|p - c| + mu <= rho + delta`. That
//! is first order in the distance of the centres, while the union of balls along a curve is
//! already within `d² / 8r` of the tube at spacing d. So the criterion here is what the
//! balls are *for*: a ball goes when another one passes within `delta` of
//! every sample it touches, on the same side, where `delta` is a share of the sampling
//! error `h² / 2r` at the sample (h the local spacing). Balls smaller than twice the
//! spacing, as they occur beside edges and in thin parts, are left alone: there the
//! error is not what that formula says. The ball that stays
//! inherits the samples: by fact F2 the crust still passes through them.
//!
//! Greedy, largest ball first, so the result is unique up to equal radii,
//! which the ball's id settles. Samples near a ball are found by walking the Delaunay
//! graph outward from those it touches.

use rayon::prelude::*;

use crate::delaunay::{Delaunay, Samples};
use crate::geom::vec3::{dist_sq, dot, norm, sub};
use crate::geom::Point;
use crate::poles::{Balls, Poles, NO_POLE};

/// Merges redundant balls; `share` is the part of the sampling error by which
/// a ball may miss a sample it stands for, 0 for none. The spacing of the
/// samples, which this needs, comes with the balls, in steps of the lattice.
///
/// ```
/// use powercrust::{delaunay, poles, simplify::merge_redundant, Context};
/// // A torus: inner poles crowd along a circle.
/// let points: Vec<[f64; 3]> = (0..900).map(|k| {
///     let (u, v) = (f64::from(k) * 0.007, f64::from(k) * 2.4);
///     let rho = 3.0 + v.cos();
///     [rho * u.cos(), rho * u.sin(), v.sin()]
/// }).collect();
/// let cx = Context::default();
/// let samples = delaunay::samples(&points, 5.0)?;
/// let delaunay = delaunay::delaunay(&samples, &cx)?;
/// let all = poles::poles(&samples, &delaunay, &poles::PoleOptions::default(), &cx)?;
/// let before = all.balls.len();
/// let (few, _) = merge_redundant(&samples, &delaunay, all, 0.5);
/// assert!(few.balls.len() * 5 < before * 4, "{} of {before}", few.balls.len());
/// # Ok::<(), powercrust::Error>(())
/// ```
pub fn merge_redundant(
    samples: &Samples,
    delaunay: &Delaunay,
    poles: Poles,
    share: f64,
) -> (Poles, Vec<f64>) {
    let graph = SampleGraph::of(delaunay);
    if share <= 0.0 {
        return (poles, graph.spacing);
    }
    let survivors = greedy(samples, &poles, &graph, share);
    (renumber(poles, &survivors), graph.spacing)
}

/// The samples as a graph, with the local spacing.
struct SampleGraph {
    starts: Vec<u32>,
    items: Vec<u32>,
    /// Distance to the fourth nearest neighbour in the graph: on a surface
    /// about the spacing, whatever lies across the object.
    spacing: Vec<f64>,
}

impl SampleGraph {
    fn of(delaunay: &Delaunay) -> SampleGraph {
        let (starts, cells) = delaunay.complex.cells_by_vertex(delaunay.sites.len());
        let rows: Vec<(Vec<u32>, f64)> = (0..delaunay.samples)
            .into_par_iter()
            .map(|s| {
                let mut near = Vec::with_capacity(64);
                for &c in &cells[starts[s] as usize..starts[s + 1] as usize] {
                    near.extend_from_slice(&delaunay.complex.cells[c as usize]);
                }
                near.sort_unstable();
                near.dedup();
                near.retain(|&v| v as usize != s && !delaunay.is_frame(v));
                let at = position(&delaunay.sites[s]);
                let mut nearest = [f64::INFINITY; 4];
                for &v in &near {
                    let mut d = dist_sq(position(&delaunay.sites[v as usize]), at);
                    for slot in &mut nearest {
                        if d < *slot {
                            std::mem::swap(&mut d, slot);
                        }
                    }
                }
                let reach = nearest.iter().rev().find(|d| d.is_finite());
                near.shrink_to_fit();
                (near, reach.copied().unwrap_or(0.0).sqrt())
            })
            .collect();
        let mut graph = SampleGraph {
            starts: vec![0],
            items: Vec::new(),
            spacing: Vec::with_capacity(rows.len()),
        };
        for (near, spacing) in rows {
            graph.items.extend_from_slice(&near);
            graph.starts.push(graph.items.len() as u32);
            graph.spacing.push(spacing);
        }
        graph
    }

    fn near(&self, s: u32) -> &[u32] {
        let s = s as usize;
        &self.items[self.starts[s] as usize..self.starts[s + 1] as usize]
    }
}

fn position(site: &[f64; 4]) -> Point {
    [site[0], site[1], site[2]]
}

/// For each ball the ball that stands for it: itself if it stays.
fn greedy(samples: &Samples, poles: &Poles, graph: &SampleGraph, share: f64) -> Vec<u32> {
    let balls = &poles.balls;
    let step = balls.lattice.step();
    let count = balls.len();
    let centre = |b: u32| position(&balls.sites[b as usize]).map(|v| v * step);
    let site = |s: u32| position(&samples.sites[s as usize]);
    let mut order: Vec<u32> = (0..count as u32).collect();
    order.par_sort_unstable_by(|&a, &b| {
        let weight = |b: u32| balls.sites[b as usize][3];
        weight(b).total_cmp(&weight(a)).then(a.cmp(&b))
    });
    let mut stands_for: Vec<u32> = (0..count as u32).collect();
    let mut settled = vec![false; count];
    let mut covered = vec![u32::MAX; samples.len()];
    let mut front: Vec<u32> = Vec::new();
    for &c in &order {
        if settled[c as usize] {
            continue;
        }
        settled[c as usize] = true;
        if balls.touches_frame[c as usize] {
            continue;
        }
        let middle = centre(c);
        let radius = balls.sites[c as usize][3].sqrt() * step;
        let covers = |s: u32| {
            let h = graph.spacing[s as usize];
            if 2.0 * h > radius {
                return false;
            }
            let miss = (dist_sq(site(s), middle).sqrt() - radius).abs();
            2.0 * radius * miss <= share * h * h
        };
        front.clear();
        for &s in balls.touching(c) {
            covered[s as usize] = c;
            front.push(s);
        }
        let mut at = 0;
        while at < front.len() {
            let s = front[at];
            at += 1;
            for &t in graph.near(s) {
                if covered[t as usize] != c && covers(t) {
                    covered[t as usize] = c;
                    front.push(t);
                }
            }
        }
        for &s in &front {
            for p in poles.of_sample[s as usize] {
                if p == NO_POLE || settled[p as usize] || balls.touches_frame[p as usize] {
                    continue;
                }
                let other = centre(p);
                let small = balls.sites[p as usize][3].sqrt() * step;
                let same_side = |s: u32| {
                    let (a, b) = (sub(middle, site(s)), sub(other, site(s)));
                    dot(a, b) > 0.5 * norm(a) * norm(b)
                };
                let redundant = balls.touching(p).iter().all(|&t| {
                    covered[t as usize] == c
                        && 2.0 * graph.spacing[t as usize] <= small
                        && same_side(t)
                });
                if redundant {
                    settled[p as usize] = true;
                    stands_for[p as usize] = c;
                }
            }
        }
    }
    stands_for
}

/// Renumbers the balls that stay, in their old order.
fn renumber(poles: Poles, stands_for: &[u32]) -> Poles {
    let old = &poles.balls;
    let mut number = vec![NO_POLE; old.len()];
    let mut kept = Vec::new();
    for (b, &by) in stands_for.iter().enumerate() {
        if by as usize == b {
            number[b] = kept.len() as u32;
            kept.push(b as u32);
        }
    }
    if kept.len() == old.len() {
        return poles;
    }
    let mut inherited: Vec<(u32, u32)> = Vec::new();
    for (b, &by) in stands_for.iter().enumerate() {
        if by as usize != b {
            for &s in old.touching(b as u32) {
                inherited.push((number[by as usize], s));
            }
        }
    }
    inherited.par_sort_unstable();
    let mut balls = Balls {
        sites: Vec::with_capacity(kept.len()),
        lattice: old.lattice,
        touch_starts: vec![0],
        touched: Vec::with_capacity(old.touched.len()),
        touches_frame: Vec::with_capacity(kept.len()),
    };
    let mut next = 0;
    let mut list = Vec::new();
    for (new, &b) in kept.iter().enumerate() {
        list.clear();
        list.extend_from_slice(old.touching(b));
        while next < inherited.len() && inherited[next].0 == new as u32 {
            list.push(inherited[next].1);
            next += 1;
        }
        list.sort_unstable();
        list.dedup();
        balls.sites.push(old.sites[b as usize]);
        balls.touched.extend_from_slice(&list);
        balls.touch_starts.push(balls.touched.len() as u32);
        balls.touches_frame.push(old.touches_frame[b as usize]);
    }
    let of_sample = poles
        .of_sample
        .iter()
        .map(|pair| {
            pair.map(|b| {
                if b == NO_POLE {
                    NO_POLE
                } else {
                    number[stands_for[b as usize] as usize]
                }
            })
        })
        .collect();
    Poles {
        balls,
        of_sample,
        ..poles
    }
}
