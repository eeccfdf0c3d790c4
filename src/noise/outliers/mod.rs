//! Outliers: samples that lie on no surface. A step beyond the paper, which
//! takes every sample for a point of the surface.
//!
//! Scanners see dust, reflections and the edge between two things at once.
//! Each such sample makes a spike or a shell of its own. They are recognised by
//! what tells a stray from a surface of any spacing:
//!
//! 1. **Floating** (`floating.rs`). Samples are joined along Delaunay edges no
//!    longer than twice the spacing at either end, where the spacing must not grow
//!    faster than a fifth of the way. What hangs together so with a
//!    twentieth of the cloud is surface. Other groups of at most twelve samples are
//!    outliers, larger ones only if they are sparse beside the surface
//!    next to them and fill space instead of lying on a sheet: small parts and
//!    coarsely sampled ones stay. Among thousands of samples strewn evenly some few stand
//!    alone as well: where less than one in 500 floats, only those five spacings away count. And a group
//!    denser than the surface next to it must be two spacings of that away, lest it be a
//!    detail of it. Since the Delaunay edges hold the shortest
//!    tree through all samples, no pair that counts is missed.
//! 2. **Doubtful** (`doubtful.rs`). Chains of outliers join to the surface. The number found, in the box
//!    of the cloud, tells how near the sixth neighbour of one comes by chance: less than one of all is
//!    expected to have it nearer (Poisson). Samples with it farther off are doubtful; groups of them are
//!    outliers if sparse beside the surface next to them and no sheet. Not asked where less than one in 500 floats.
//! 3. **Beside the surface** (`beside.rs`). If there were some, samples are looked for that
//!    stand off the plane of their neighbours, far more than those do and by more
//!    than the spacing. Without floating ones nobody would be there.
//!
//! What is left may show more, so this is done again, at most four times.
//! Clean clouds pay for one look along the edges. `docs/noise.md` has what was
//! measured.

mod beside;
mod doubtful;
mod floating;

use crate::delaunay::Samples;
use crate::geom::vec3::dist_sq;
use crate::geom::Point;
use crate::tetra::Edges;

/// Clouds smaller than this have no outliers: each sample may matter.
const FEWEST: usize = 200;

/// The share of the samples that must float before lone ones close by are
/// outliers, and doubtful ones and those beside the surface are looked for.
const MANY: f64 = 0.002;

/// Why a sample was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Stray {
    /// Alone or in a small or sparse group, away from every surface.
    Floating,
    /// Near a surface, but off it by far more than its neighbours.
    Beside,
}

/// What was found.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct OutlierReport {
    /// Samples left out.
    pub left_out: usize,
    /// Those of them that float.
    pub floating: usize,
    /// Those beside the surface.
    pub beside: usize,
    /// Groups that float, samples alone included.
    pub groups: usize,
}

/// Looks for outliers; nothing where every sample belongs to a surface. For each
/// sample why it should be left out. `graph` has the Delaunay edges, `room` the sides of the box of
/// all samples before the first call, in the user's units; the report counts what was found
/// in earlier calls too.
pub fn outliers(
    samples: &Samples,
    graph: &Edges,
    room: [f64; 3],
    report: &mut OutlierReport,
) -> Option<Vec<Option<Stray>>> {
    let count = samples.len();
    if count < FEWEST {
        return None;
    }
    let places: Vec<Point> = (samples.sites.iter()).map(|s| [s[0], s[1], s[2]]).collect();
    let cloud = Cloud {
        places: &places,
        graph,
    };
    let step = samples.lattice.length_to_user(1.0);
    let room = room.map(|side| side / step);
    let room = room[0] * room[1] * room[2];
    let (mut strays, groups) = floating::floating(&cloud, room, report.left_out)?;
    let floating = strays.iter().flatten().count();
    // What is left must bound a solid.
    if count - floating < FEWEST {
        return None;
    }
    report.floating += floating;
    report.groups += groups;
    let seen = report.left_out + floating;
    if seen as f64 >= MANY * count as f64 {
        report.beside += beside::beside(&cloud, &mut strays);
    }
    report.left_out = report.floating + report.beside;
    Some(strays)
}

/// Samples and the Delaunay edges among them.
struct Cloud<'a> {
    /// In steps of the lattice.
    places: &'a [Point],
    graph: &'a Edges,
}

impl Cloud<'_> {
    fn len(&self) -> usize {
        self.places.len()
    }

    /// The squared distance of two samples.
    fn dist_sq(&self, a: u32, b: u32) -> f64 {
        dist_sq(self.places[a as usize], self.places[b as usize])
    }

    /// Of `some` of the samples those near one, itself left out: of those two edges
    /// away the nearest.
    fn around<const MOST: usize>(&self, s: u32, some: impl Fn(u32) -> bool) -> Nearest<MOST> {
        const EACH: usize = 8;
        let shortest = |s: u32| {
            let edges = self.graph.at(s).iter().filter(|&&v| some(v));
            Nearest::<EACH>::of(edges.map(|&v| (self.dist_sq(s, v), v)))
        };
        let mut all = [0; EACH * (EACH + 1)];
        let mut count = 0;
        let mut add = |near: &Nearest<EACH>| {
            for &(_, v) in near.found() {
                all[count] = v;
                count += 1;
            }
        };
        let first = shortest(s);
        add(&first);
        for &(_, v) in first.found() {
            add(&shortest(v));
        }
        let all = &mut all[..count];
        all.sort_unstable();
        let others = all.chunk_by(|a, b| a == b).map(|same| same[0]);
        Nearest::of(others.filter(|&v| v != s).map(|v| (self.dist_sq(s, v), v)))
    }
}

/// The nearest of some samples, nearest first, with squared distances.
struct Nearest<const MOST: usize> {
    count: usize,
    all: [(f64, u32); MOST],
}

impl<const MOST: usize> Nearest<MOST> {
    fn of(samples: impl Iterator<Item = (f64, u32)>) -> Nearest<MOST> {
        let mut near = Nearest {
            count: 0,
            all: [(f64::INFINITY, u32::MAX); MOST],
        };
        for sample in samples {
            let after = |other: &(f64, u32)| {
                let order = other.0.total_cmp(&sample.0).then(other.1.cmp(&sample.1));
                order.is_gt()
            };
            let mut at = near.count;
            while at > 0 && after(&near.all[at - 1]) {
                if at < MOST {
                    near.all[at] = near.all[at - 1];
                }
                at -= 1;
            }
            if at < MOST {
                near.all[at] = sample;
                near.count = MOST.min(near.count + 1);
            }
        }
        near
    }

    fn found(&self) -> &[(f64, u32)] {
        &self.all[..self.count]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::{Context, Portion, Stage};
    use crate::delaunay::{delaunay, samples};

    fn look(points: &[Point]) -> (Vec<Option<Stray>>, OutlierReport) {
        let context = Context::default();
        let mut samples = samples(points, 5.0).unwrap();
        let room = samples.sides();
        let progress = Portion {
            context: &context,
            stage: Stage::Delaunay,
            percent: [0, 100],
        };
        let mut report = OutlierReport::default();
        let mut of_point = vec![None; points.len()];
        for _ in 0..4 {
            let delaunay = delaunay(&samples, &context).unwrap();
            let graph = Edges::of(&delaunay.complex, samples.len(), &progress).unwrap();
            let Some(found) = outliers(&samples, &graph, room, &mut report) else {
                break;
            };
            for (&point, &why) in samples.source.iter().zip(&found) {
                of_point[point as usize] = why;
            }
            let keep: Vec<bool> = found.iter().map(Option::is_none).collect();
            samples = samples.without(&keep, 5.0).unwrap();
        }
        (of_point, report)
    }

    fn ball(count: u32, radius: f64, centre: f64) -> Vec<Point> {
        let golden = |k: u32| {
            let z = (f64::from(k) + 0.5) * 2.0 / f64::from(count) - 1.0;
            let (r, a) = ((1.0 - z * z).sqrt(), f64::from(k) * 2.399_963_229_728_653);
            [r * a.cos(), r * a.sin(), z].map(|x| x * radius)
        };
        let moved = |p: Point| [p[0] + centre, p[1], p[2]];
        (0..count).map(golden).map(moved).collect()
    }

    #[test]
    fn a_clean_sphere_has_none() {
        let (found, report) = look(&ball(2000, 1.0, 0.0));
        assert!(found.iter().all(Option::is_none));
        assert_eq!(report, OutlierReport::default());
    }

    #[test]
    fn strays_are_found_alone_in_groups_and_beside_the_surface() {
        let mut points = ball(2000, 1.0, 0.0);
        // Alone, outside and in the middle; a group; and one 3 spacings off.
        points.extend([[1.5, 0.3, 0.2], [-1.4, -0.8, 0.6], [0.1, 0.0, 0.0]]);
        points.extend([[0.0, 1.6, 0.0], [0.01, 1.6, 0.0], [0.0, 1.6, 0.02]]);
        points.push([0.0, 0.0, 1.09]);
        let (found, report) = look(&points);
        assert!(found[..2000].iter().all(Option::is_none));
        assert!(found[2000..2006]
            .iter()
            .all(|&f| f == Some(Stray::Floating)));
        assert_eq!(found[2006], Some(Stray::Beside));
        assert_eq!((report.floating, report.groups, report.beside), (6, 4, 1));
    }

    /// So many samples strewn evenly over the box made larger by a fifth.
    fn strewn(count: u32) -> Vec<Point> {
        let mut state = 7_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005);
            state = state.wrapping_add(1_442_695_040_888_963_407);
            2.4 * ((state >> 11) as f64 / (1_u64 << 53) as f64) - 1.2
        };
        (0..count).map(|_| [next(), next(), next()]).collect()
    }

    /// Chains of them reach the ball: 52 stay if nobody asks how near chance brings them.
    #[test]
    fn most_chains_of_strewn_samples_are_found() {
        let mut points = ball(4000, 1.0, 0.0);
        points.extend(strewn(400));
        let (found, _) = look(&points);
        assert!(found[..4000].iter().all(Option::is_none));
        // More than four spacings off it.
        let far = |p: &Point| (dist_sq(*p, [0.0; 3]).sqrt() - 1.0).abs() > 0.224;
        let missed = (points.iter().zip(&found)).filter(|(p, f)| f.is_none() && far(p));
        let missed = missed.count();
        assert!(missed <= 15, "{missed}");
    }

    /// Half of the ball is as sparse as the strewn samples are.
    #[test]
    fn sparse_sheets_amid_strewn_samples_stay() {
        let half = |p: &Point, k: usize| p[2] > 0.0 || k.is_multiple_of(16);
        let points = ball(8000, 1.0, 0.0).into_iter().enumerate();
        let mut points: Vec<Point> = points.filter(|(k, p)| half(p, *k)).map(|p| p.1).collect();
        let own = points.len();
        points.extend(strewn(150));
        let (found, report) = look(&points);
        assert!(report.floating > 50);
        let lost = found[..own].iter().flatten().count();
        assert!(lost == 0, "{lost}");
    }

    /// Twelve vertices of a detail beside a coarse surface, as in
    /// `footbones_verts.ply`: far away by their own spacing, not by the surface's.
    #[test]
    fn dense_details_of_a_coarse_surface_are_no_outliers() {
        let mut points = ball(2000, 1.0, 0.0);
        let detail = ball(12, 0.01, 0.0).into_iter();
        points.extend(detail.map(|p| [p[0], p[1], p[2] + 1.12]));
        let (found, _) = look(&points);
        assert!(found.iter().all(Option::is_none));
    }

    #[test]
    fn small_and_coarse_parts_are_no_outliers() {
        // A twentieth as many samples on a ball four times as far apart.
        let mut points = ball(4000, 1.0, 0.0);
        points.extend(ball(60, 0.7, 2.5));
        points.extend(ball(40, 0.1, -1.5));
        let (found, _) = look(&points);
        assert!(found.iter().all(Option::is_none));
    }
}
