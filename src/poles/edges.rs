//! Poles for samples at edges, and poles drawn back from edges: what
//! [`crate::noise::corners`] found, turned into balls.

use super::{Poles, Tangent, NO_POLE};
use crate::geom::vec3::{add, dist_sq, dot, norm_sq, scale, sub};
use crate::geom::Point;
use crate::noise::{Corner, CornerReport, Corners, Near};

impl Poles {
    /// Gives the samples at edges other poles, and draws back those of other
    /// samples that hold a place on an edge (section 6.2).
    pub fn extended(self, corners: &Corners) -> (Poles, CornerReport) {
        let found = &corners.found;
        let meet = found.iter().filter(|c| c.feet.len() > 1).count();
        let mut report = CornerReport {
            edges: found.len() - meet,
            corners: meet,
            drawn_back: 0,
        };
        if found.is_empty() {
            return (self, report);
        }
        let feet = found.iter().flat_map(|c| &c.feet);
        let feet: Vec<Point> = feet.map(|f| f.at).collect();
        let near = Near::of(&feet);
        let mut tangents = Vec::new();
        let mut at_edges = Vec::new();
        let mut next = found.iter().peekable();
        for (s, &at) in (0u32..).zip(&corners.places) {
            match next.next_if(|c| c.sample == s) {
                Some(corner) => {
                    at_edges.push(s);
                    tangents.extend(of_corner(&near, corner));
                }
                None => {
                    let before = tangents.len();
                    tangents.extend(smaller(&near, &self, s, at));
                    report.drawn_back += tangents.len() - before;
                }
            }
        }
        (self.replace(&at_edges, &tangents), report)
    }
}

/// The poles of a sample at an edge.
fn of_corner(near: &Near, corner: &Corner) -> Vec<Tangent> {
    let Some(radii) = corner.radii else {
        return Vec::new();
    };
    let tangent = |slot: usize, way: f64| {
        let centre = add(corner.at, scale(corner.normal, way * radii[slot]));
        Tangent {
            sample: corner.sample,
            slot,
            at: corner.at,
            centre: drawn_back(near, corner.at, centre).unwrap_or(centre),
        }
    };
    vec![tangent(0, 1.0), tangent(1, -1.0)]
}

/// The poles of another sample, `s` at `at`, that must be smaller.
fn smaller(near: &Near, poles: &Poles, s: u32, at: Point) -> Vec<Tangent> {
    let step = poles.balls.lattice.step();
    let slots = poles.of_sample[s as usize].into_iter().enumerate();
    slots
        .filter(|&(_, ball)| ball != NO_POLE)
        .filter_map(|(slot, ball)| {
            let site = &poles.balls.sites[ball as usize];
            let centre = [site[0], site[1], site[2]].map(|v| v * step);
            drawn_back(near, at, centre).map(|centre| Tangent {
                sample: s,
                slot,
                at,
                centre,
            })
        })
        .collect()
}

/// The centre of the largest ball on the same side of `at` that touches
/// there and holds no foot; `None` where the ball itself holds none.
fn drawn_back(feet: &Near, at: Point, centre: Point) -> Option<Point> {
    /// Each step shrinks the ball to the foot nearest its centre; a few are
    /// enough nearly always, and a ball still too large does no harm.
    const STEPS: usize = 20;
    /// A foot this little inside, by the radius, is on the sphere but for rounding.
    const ROUNDING: f64 = 1e-3;
    let radius = dist_sq(at, centre).sqrt();
    if radius == 0.0 {
        return None;
    }
    let way = scale(sub(centre, at), 1.0 / radius);
    let mut smaller = radius;
    for _ in 0..STEPS {
        let centre = add(at, scale(way, smaller));
        let &(distance, foot) = feet.nearest(centre, 1).first()?;
        if distance.sqrt() >= smaller * (1.0 - ROUNDING) {
            break;
        }
        let to = sub(feet.places[foot as usize], at);
        let next = norm_sq(to) / (2.0 * dot(to, way));
        if !(next > 0.0 && next < smaller) {
            break;
        }
        smaller = next;
    }
    (smaller < radius).then(|| add(at, scale(way, smaller)))
}
