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

use crate::context::{Cancelled, Context, Portion, Stage};
use crate::delaunay::Samples;
use crate::geom::vec3::{dist_sq, dot, norm, sub};
use crate::geom::Point;
use crate::poles::{Balls, Poles, NO_POLE};
use crate::tetra::Edges;

/// Merges redundant balls; `share` is the part of the sampling error by which
/// a ball may miss a sample it stands for, 0 for none. The spacing of the
/// samples, which this needs, comes with the balls, in steps of the lattice.
///
/// # Errors
/// [`Cancelled`].
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
/// let graph = delaunay.edges(&cx)?;
/// let (few, _) = merge_redundant(&samples, &graph, all, 0.5, &cx)?;
/// assert!(few.balls.len() * 5 < before * 4, "{} of {before}", few.balls.len());
/// # Ok::<(), powercrust::Error>(())
/// ```
pub fn merge_redundant(
    samples: &Samples,
    graph: &Edges,
    poles: Poles,
    share: f64,
    context: &Context,
) -> Result<(Poles, Vec<f64>), Cancelled> {
    let part = |percent| Portion {
        context,
        stage: Stage::Poles,
        percent,
    };
    let spacing = spacing(samples, graph);
    if share <= 0.0 {
        return Ok((poles, spacing));
    }
    let cover = Cover {
        samples,
        poles: &poles,
        graph,
        spacing: &spacing,
        share,
    };
    let survivors = cover.greedy(&part([50, 100]))?;
    Ok((renumber(poles, &survivors), spacing))
}

/// The local spacing: the distance to the fourth nearest neighbour in the
/// graph. On a surface that is about the spacing, whatever lies across the
/// object.
fn spacing(samples: &Samples, graph: &Edges) -> Vec<f64> {
    let fourth = |s: u32| {
        let at = position(&samples.sites[s as usize]);
        let mut nearest = [f64::INFINITY; 4];
        for &v in graph.at(s) {
            let mut d = dist_sq(position(&samples.sites[v as usize]), at);
            if d < nearest[3] {
                for slot in &mut nearest {
                    if d < *slot {
                        std::mem::swap(&mut d, slot);
                    }
                }
            }
        }
        let reach = nearest.iter().rev().find(|d| d.is_finite());
        reach.copied().unwrap_or(0.0).sqrt()
    };
    (0..samples.len() as u32)
        .into_par_iter()
        .map(fourth)
        .collect()
}

fn position(site: &[f64; 4]) -> Point {
    [site[0], site[1], site[2]]
}

/// Balls looked at between two reports of progress.
const REPORT: usize = 1 << 12;

/// Which balls cover which samples.
struct Cover<'a> {
    samples: &'a Samples,
    poles: &'a Poles,
    graph: &'a Edges,
    spacing: &'a [f64],
    share: f64,
}

impl Cover<'_> {
    /// For each ball the ball that stands for it: itself if it stays.
    fn greedy(&self, progress: &Portion) -> Result<Vec<u32>, Cancelled> {
        let balls = &self.poles.balls;
        let count = balls.len();
        let weight = |b: u32| balls.sites[b as usize][3];
        let mut order: Vec<u32> = (0..count as u32).collect();
        order.par_sort_unstable_by(|&a, &b| weight(b).total_cmp(&weight(a)).then(a.cmp(&b)));
        let mut stands_for: Vec<u32> = (0..count as u32).collect();
        let mut settled = balls.touches_frame.clone();
        // The ball that met a sample last, and whether it covers it; the ball
        // that met another one last.
        let mut met = vec![(NO_POLE, false); self.samples.len()];
        let mut asked = vec![NO_POLE; count];
        let mut front: Vec<u32> = Vec::new();
        for (done, &c) in order.iter().enumerate() {
            if done.is_multiple_of(REPORT) {
                progress.advance(done, count)?;
            }
            if std::mem::replace(&mut settled[c as usize], true) {
                continue;
            }
            self.spread(c, &mut met, &mut front);
            for &p in front
                .iter()
                .flat_map(|&s| &self.poles.of_sample[s as usize])
            {
                if p == NO_POLE || settled[p as usize] || asked[p as usize] == c {
                    continue;
                }
                asked[p as usize] = c;
                if self.redundant(p, c, &met) {
                    settled[p as usize] = true;
                    stands_for[p as usize] = c;
                }
            }
        }
        Ok(stands_for)
    }

    /// The samples that ball `c` covers, found outward from those it touches.
    fn spread(&self, c: u32, met: &mut [(u32, bool)], front: &mut Vec<u32>) {
        let (middle, radius) = self.ball(c);
        front.clear();
        for &s in self.poles.balls.touching(c) {
            met[s as usize] = (c, true);
            front.push(s);
        }
        let mut at = 0;
        while at < front.len() {
            let s = front[at];
            at += 1;
            for &t in self.graph.at(s) {
                if met[t as usize].0 == c {
                    continue;
                }
                let covers = self.covers(middle, radius, t);
                met[t as usize] = (c, covers);
                if covers {
                    front.push(t);
                }
            }
        }
    }

    /// Centre and radius in steps of the samples' lattice.
    fn ball(&self, b: u32) -> (Point, f64) {
        let balls = &self.poles.balls;
        let site = &balls.sites[b as usize];
        let step = balls.lattice.step();
        (position(site).map(|v| v * step), site[3].sqrt() * step)
    }

    fn site(&self, s: u32) -> Point {
        position(&self.samples.sites[s as usize])
    }

    /// Whether a ball passes by a sample as near as it may.
    fn covers(&self, middle: Point, radius: f64, s: u32) -> bool {
        let h = self.spacing[s as usize];
        if 2.0 * h > radius {
            return false;
        }
        let miss = (dist_sq(self.site(s), middle).sqrt() - radius).abs();
        2.0 * radius * miss <= self.share * h * h
    }

    /// Whether ball `c`, which covers what `met` says, stands for ball `p`.
    fn redundant(&self, p: u32, c: u32, met: &[(u32, bool)]) -> bool {
        let (middle, _) = self.ball(c);
        let (other, small) = self.ball(p);
        self.poles.balls.touching(p).iter().all(|&t| {
            met[t as usize] == (c, true) && 2.0 * self.spacing[t as usize] <= small && {
                let (a, b) = (sub(middle, self.site(t)), sub(other, self.site(t)));
                dot(a, b) > 0.5 * norm(a) * norm(b)
            }
        })
    }
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
