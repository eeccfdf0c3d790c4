//! Outer balls for inner ones: from the complement of their union.
//!
//! Points on the boundary of the union are samples of it, and of each the side
//! on which the outside lies is known. As with samples of any solid, the
//! farthest Voronoi vertices on that side are the outer poles, and their balls
//! fill the outside (section 3.1 of the paper). No label has to be found: a
//! Delaunay cell lies outside where all its samples look towards its centre.
//! Where the outside is narrow, as between two balls that nearly touch, poles
//! may lie beside; there all cells outside give a ball.
//!
//! Tried on paper and left: the power vertices of the inner balls that lie
//! outside of the union. There are few of them where the solid is convex, none
//! around a ball alone, and their balls cut through the union where inner
//! balls meet at a blunt angle.

use rayon::prelude::*;

use super::boundary::Touch;
use crate::context::{Context, Portion, Stage};
use crate::delaunay::{circumcentre, delaunay, samples};
use crate::error::Error;
use crate::geom::vec3::plain::{dist_sq, dot, norm};
use crate::geom::vec3::sub;
use crate::geom::{Ball, Point};
use crate::tetra::Stars;

/// The frame about the points: as that of a reconstruction.
const FRAME: f64 = 5.0;
/// A sample looks towards a centre if it sees it above its horizon, by this
/// sine.
const AHEAD: f64 = 1e-3;

/// The outer poles of points on the boundary of a solid.
pub(super) fn outer_balls(touches: &[Touch], context: &Context) -> Result<Vec<Ball>, Error> {
    let points: Vec<Point> = touches.iter().map(|t| t.at).collect();
    let samples = samples(&points, FRAME)?;
    let delaunay = delaunay(&samples, context)?;
    let count = samples.len();
    let cells = &delaunay.complex.cells;
    let normal = |s: u32| touches[samples.source[s as usize] as usize].normal;
    let site = |v: u32| {
        let s = &delaunay.sites[v as usize];
        [s[0], s[1], s[2]]
    };
    let centres: Vec<Option<Point>> = (cells.par_iter())
        .map(|cell| {
            let mut corners = *cell;
            corners.sort_unstable();
            let sites = corners.map(|v| &delaunay.sites[v as usize]);
            let centre = circumcentre(sites, 1.0).position;
            let ahead = |&&v: &&u32| {
                let to = sub(centre, site(v));
                dot(to, normal(v)) > AHEAD * norm(to)
            };
            let own = || cell.iter().filter(|v| !delaunay.is_frame(**v));
            (own().count() > 0 && own().all(|v| ahead(&v))).then_some(centre)
        })
        .collect();
    let progress = Portion {
        context,
        stage: Stage::Poles,
        percent: [0, 100],
    };
    let stars = Stars::of(&delaunay.complex, count, &progress)?;
    let mut poles: Vec<u32> = (0..count as u32)
        .into_par_iter()
        .flat_map_iter(|s| {
            let at = site(s);
            let outside = |c: &&u32| centres[**c as usize].is_some();
            if touches[samples.source[s as usize] as usize].narrow {
                return stars.at(s).iter().filter(outside).copied().collect();
            }
            let far = |c: u32| centres[c as usize].map(|centre| (dist_sq(centre, at), c));
            let best = stars.at(s).iter().filter_map(|&c| far(c));
            let farthest = |a: &(f64, u32), b: &(f64, u32)| {
                let by_place = centres[a.1 as usize].partial_cmp(&centres[b.1 as usize]);
                a.0.total_cmp(&b.0)
                    .then(by_place.unwrap_or(std::cmp::Ordering::Equal))
            };
            let best: Vec<u32> = best.max_by(farthest).map(|(_, c)| c).into_iter().collect();
            best
        })
        .collect();
    poles.sort_unstable();
    poles.dedup();
    let lattice = &samples.lattice;
    let ball = |&c: &u32| {
        let centre = centres[c as usize]?;
        let own = cells[c as usize].iter().find(|v| !delaunay.is_frame(**v))?;
        let radius = lattice.length_to_user(dist_sq(centre, site(*own)).sqrt());
        Some(Ball::new(lattice.to_user(centre), radius))
    };
    Ok(poles.iter().filter_map(ball).collect())
}
