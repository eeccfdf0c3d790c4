//! Groups of samples that hang together with no surface.

use rayon::prelude::*;

use super::doubtful::{chance_spacing, Doubtful};
use super::{Cloud, Stray};
use crate::geom::Sets;
use crate::noise::plane::Plane;

/// Edges longer than this many spacings, at either end, join nothing.
pub(super) const REACH: f64 = 2.0;

/// Where hardly a sample floats, it must be so many spacings away: among
/// thousands strewn evenly over a surface some few stand alone.
const FAR: f64 = 5.0;

/// The spacing grows by no more than this share of the way.
const GROWTH: f64 = 0.2;

/// Rounds in which it is held to that.
const ROUNDS: usize = 3;

/// The spacing at a sample: the length of so manieth shortest of its edges.
pub(super) const RANK: usize = 6;

/// Groups that hold more than one in so many samples of the cloud are surface.
const SURFACE: usize = 20;

/// Groups of so many samples at most are too small to be a part.
const SMALL: usize = 12;

/// What neighbours are off their plane, over their spacing, where they fill space:
/// about 0.45 where they are strewn at random.
pub(super) const SHEET: f64 = 0.35;

/// Members of a group looked at.
const LOOKED_AT: usize = 40;

/// The samples that float, and in how many groups; `None` if there are none.
/// So many outliers were `found_before`, in a box of this volume.
pub(super) fn floating(
    cloud: &Cloud,
    room: f64,
    found_before: usize,
) -> Option<(Vec<Option<Stray>>, usize)> {
    let count = cloud.len() as u32;
    let shortest: Vec<[(f64, u32); RANK]> = (0..count)
        .into_par_iter()
        .map(|s| shortest(cloud, s))
        .collect();
    let raw: Vec<f64> = shortest.par_iter().map(|edges| edges[RANK - 1].0).collect();
    let mut spacing = raw.clone();
    for _ in 0..ROUNDS {
        spacing = (shortest.par_iter().zip(&spacing))
            .map(|(edges, &own)| {
                let bounds = edges.iter().map(|e| spacing[e.1 as usize] + GROWTH * e.0);
                bounds.fold(own, f64::min)
            })
            .collect();
    }
    drop(shortest);

    let mut groups = Sets::new(cloud.len());
    for s in 0..count {
        for &v in cloud.graph.at(s).iter().filter(|&&v| v > s) {
            let reach = REACH * spacing[s as usize].min(spacing[v as usize]);
            if cloud.dist_sq(s, v) <= reach * reach {
                groups.join(s, v);
            }
        }
    }
    let most = SMALL.max(cloud.len() / SURFACE);
    let root = groups.flatten();
    let mut size = vec![0usize; cloud.len()];
    root.iter().for_each(|&r| size[r as usize] += 1);
    let surface = |s: u32| size[root[s as usize] as usize] > most;
    let mut others: Vec<(u32, u32)> = (0..count)
        .filter(|&s| !surface(s))
        .map(|s| (root[s as usize], s))
        .collect();
    if (others.is_empty() && found_before == 0) || others.len() == cloud.len() {
        return None;
    }
    others.sort_unstable();

    let few = ((found_before + others.len()) as f64) < super::MANY * cloud.len() as f64;
    let mut strays = vec![None; cloud.len()];
    let mut found = 0;
    for group in others.chunk_by(|a, b| a.0 == b.0) {
        let members: Vec<u32> = group.iter().map(|m| m.1).collect();
        if members.len() > SMALL && !sparse(cloud, &members, &raw, &spacing, &surface) {
            continue;
        }
        if !is_away(cloud, &members, [&raw, &spacing], &surface, few) {
            continue;
        }
        found += 1;
        for m in members {
            strays[m as usize] = Some(Stray::Floating);
        }
    }
    let strewn = found_before + strays.iter().flatten().count();
    if strewn > 0 && room > 0.0 {
        let doubtful = Doubtful {
            cloud,
            raw: &raw,
            spacing: &spacing,
            limit: chance_spacing(strewn, room),
            most,
        };
        found += doubtful.mark(&mut strays);
    }
    (found > 0).then_some((strays, found))
}

/// The lengths and ends of the shortest edges at a sample, in order; the
/// longest again where there are fewer.
fn shortest(cloud: &Cloud, s: u32) -> [(f64, u32); RANK] {
    let mut found = [(f64::INFINITY, s); RANK];
    let mut known = 0;
    for &v in cloud.graph.at(s) {
        let mut edge = (cloud.dist_sq(s, v), v);
        known += 1;
        if edge.0 < found[RANK - 1].0 {
            for slot in &mut found {
                if edge.0 < slot.0 {
                    std::mem::swap(&mut edge, slot);
                }
            }
        }
    }
    for at in known..RANK {
        found[at] = match known {
            0 => (0.0, s),
            _ => found[known - 1],
        };
    }
    found.map(|(square, v)| (square.sqrt(), v))
}

/// Whether a group is away from every surface: by [`FAR`] spacings where `few` float, and where it
/// is denser than all surface next to it, by [`REACH`] of the spacings there. Such a group
/// hangs together with nothing, but may be a detail of a coarser surface.
fn is_away(
    cloud: &Cloud,
    members: &[u32],
    [raw, spacing]: [&[f64]; 2],
    surface: &dyn Fn(u32) -> bool,
    few: bool,
) -> bool {
    let edges = || {
        let at = |&m: &u32| cloud.graph.at(m).iter().map(move |&v| (m, v));
        members.iter().flat_map(at).filter(|e| surface(e.1))
    };
    let beyond = |reach: f64, spacing: &[f64]| {
        edges().all(|(m, v)| cloud.dist_sq(m, v) > (reach * spacing[v as usize]).powi(2))
    };
    let finest = edges()
        .map(|e| raw[e.1 as usize])
        .fold(f64::INFINITY, f64::min);
    let mut own: Vec<f64> = members.iter().map(|&m| raw[m as usize]).collect();
    let dense = median(&mut own) < finest && finest.is_finite();
    (!few || beyond(FAR, spacing)) && (!dense || beyond(REACH, raw))
}

/// Whether a group is sparse beside the surface next to it, and no sheet.
fn sparse(
    cloud: &Cloud,
    members: &[u32],
    raw: &[f64],
    spacing: &[f64],
    surface: &dyn Fn(u32) -> bool,
) -> bool {
    if sparser(cloud, members, [raw, spacing], surface) != Some(true) {
        return false;
    }
    let step = members.len().div_ceil(LOOKED_AT);
    let mut off: Vec<f64> = members
        .iter()
        .step_by(step)
        .map(|&m| roughness(cloud, m, |_| true))
        .collect();
    median(&mut off) > SHEET
}

/// Whether samples are farther apart than [`REACH`] times those of a surface where that is next to them;
/// `None` where it is nowhere.
pub(super) fn sparser(
    cloud: &Cloud,
    members: &[u32],
    [raw, spacing]: [&[f64]; 2],
    surface: &dyn Fn(u32) -> bool,
) -> Option<bool> {
    let edges = (members.iter()).flat_map(|&m| cloud.graph.at(m).iter().map(move |&v| (m, v)));
    let next = edges.filter(|&(_, v)| surface(v)).min_by(|a, b| {
        let [x, y] = [a, b].map(|e| cloud.dist_sq(e.0, e.1));
        x.total_cmp(&y).then(a.1.cmp(&b.1))
    });
    let mut own: Vec<f64> = members.iter().map(|&m| raw[m as usize]).collect();
    next.map(|e| median(&mut own) > REACH * spacing[e.1 as usize])
}

/// How far the twelve of `some` samples around one are off a plane, root mean square,
/// over their spacing.
pub(super) fn roughness(cloud: &Cloud, s: u32, some: impl Fn(u32) -> bool) -> f64 {
    let around = cloud.around::<12>(s, some);
    let around = around.found();
    let Some(far) = around.last() else {
        return 0.0;
    };
    let mut places = vec![cloud.places[s as usize]];
    places.extend(around.iter().map(|n| cloud.places[n.1 as usize]));
    let spacing = (far.0 * std::f64::consts::PI / around.len() as f64).sqrt();
    Plane::through(&places).map_or(0.0, |plane| plane.missed / spacing)
}

/// The median; reorders.
pub(super) fn median(values: &mut [f64]) -> f64 {
    let at = values.len() / 2;
    match values.is_empty() {
        true => 0.0,
        false => *values.select_nth_unstable_by(at, f64::total_cmp).1,
    }
}
