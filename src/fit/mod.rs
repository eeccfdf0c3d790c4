//! Solids whose balls share no samples: from labelled cells to a mended
//! surface, moved to where a [`Field`] says it is to be.
//!
//! Offsets (section 7.2 of the paper) and balls from a file (section 3.4 and
//! 7.3) give faces between unlike cells as points do, but nothing says where
//! samples lie. The surface is extracted without them, cleaned, cut into
//! triangles and mended on the way that the crust of points takes.
//!
//! Where the fitted surface crosses itself and mending cannot help, it is made
//! again with the faces of the balls there as the diagram has them; at last
//! all are. Where that crosses itself, inner balls at the crossing turn outer
//! until it does not: at the latest where none is left.

mod field;
mod refine;

pub(crate) use field::{Field, Foot};

use crate::context::{Context, Stage};
use crate::error::Error;
use crate::geom::{Point, Side};
use crate::power::PowerDiagram;
use crate::surface::{
    clean_counted, mend_crust, raw_crust, triangulate_faces, CleanOptions, Crust, MendOptions,
    Mending, Placement,
};

/// Times a surface is made.
const TRIES: usize = 24;
/// Times of these that it is fitted.
const FITTED: usize = 4;

/// Cells of a power diagram, and how their surface is made.
pub(crate) struct Cells<'a> {
    pub power: &'a PowerDiagram,
    /// A point in the units of the diagram's sites at a size near 1, rounded
    /// as it will be written.
    pub to_unit: &'a (dyn Fn(Point) -> Point + Sync),
    /// How far faces may be off, at that size: half of it may be spent on
    /// losing vertices.
    pub tolerance: f64,
    /// Edges up to this length come by rounding and are contracted first, at
    /// that size.
    pub shortest: f64,
    /// Round coordinates to single precision.
    pub single: bool,
}

/// A surface, at a size near 1.
pub(crate) struct Made {
    pub crust: Crust,
    /// Whether it was fitted to the field.
    pub fitted: bool,
    /// Balls whose faces were not.
    pub unfitted: usize,
    /// Inner balls that turned outer.
    pub turned: usize,
    /// Pairs of faces that cross and could not be mended.
    pub crossings_left: usize,
}

/// The surface between unlike cells; `None` if there is none.
pub(crate) fn solid(
    cells: &Cells,
    mut sides: Vec<Side>,
    field: Option<&dyn Field>,
    context: &Context,
) -> Result<Option<Made>, Error> {
    let mut held = vec![false; sides.len()];
    let mut all_turned = 0;
    for attempt in 0.. {
        let field = field.filter(|_| attempt < FITTED);
        let fitted = field.is_some();
        let Some(mended) = cells.surface(&sides, field.map(|f| (f, &held[..])), context)? else {
            return Ok(None);
        };
        let mut turned = 0;
        if fitted {
            for &b in mended.left.iter().flatten().flatten() {
                if let Some(hold) = held.get_mut(b as usize) {
                    *hold = true;
                }
            }
        } else {
            turned = turn(&mended, cells.power, &mut sides);
        }
        all_turned += turned;
        let hopeless = !fitted && turned == 0 || attempt + 1 == TRIES;
        if mended.left.is_empty() || hopeless {
            return Ok(Some(Made {
                fitted,
                unfitted: held.iter().filter(|&&h| h && fitted).count(),
                turned: all_turned,
                crossings_left: mended.left.len(),
                crust: mended.crust,
            }));
        }
    }
    Ok(None)
}

impl Cells<'_> {
    /// The mended surface between unlike cells; `None` if there is none. It is
    /// fitted to the field but at the balls that are held.
    fn surface(
        &self,
        sides: &[Side],
        field: Option<(&dyn Field, &[bool])>,
        context: &Context,
    ) -> Result<Option<Mending>, Error> {
        context.advance(Stage::Crust, 0, 3)?;
        let place = Placement {
            touching: &|_| &[],
            sample: &|_| [0.0; 3],
            to_user: self.to_unit,
        };
        let raw = raw_crust(self.power, sides, &place);
        if raw.next.is_empty() {
            return Ok(None);
        }
        let clean = CleanOptions {
            tolerance: self.shortest,
            ..CleanOptions::default()
        };
        let (polygons, _) = clean_counted(raw, &clean);
        let mut crust = triangulate_faces(polygons).crust;
        if crust.mesh.face_count() == 0 {
            return Ok(None);
        }
        context.advance(Stage::Crust, 1, 3)?;
        if let Some((field, held)) = field {
            let held = |balls: [u32; 2]| balls.iter().any(|&b| held.get(b as usize) == Some(&true));
            field::fit(&mut crust, field, &held);
            refine::refine(&mut crust, field, &held, context)?;
        }
        let how = MendOptions {
            handles: None,
            flatness: 0.0,
            tolerance: Some(0.5 * self.tolerance),
            single: self.single,
            keep_samples: false,
            spacing: &|_| 0.0,
            ball: &|_| None,
        };
        Ok(Some(mend_crust(crust, &how, context)?))
    }
}

/// Lets the smallest inner ball at each crossing turn outer; how many did.
fn turn(mended: &Mending, power: &PowerDiagram, sides: &mut [Side]) -> usize {
    let mut count = 0;
    for faces in &mended.left {
        let balls = faces.iter().flatten().copied();
        let inner = balls.filter(|&b| sides.get(b as usize) == Some(&Side::Inner));
        let weight = |b: &u32| power.sites[*b as usize][3];
        let smallest = inner.min_by(|a, b| weight(a).total_cmp(&weight(b)).then(a.cmp(b)));
        if let Some(b) = smallest {
            sides[b as usize] = Side::Outer;
            count += 1;
        }
    }
    count
}
