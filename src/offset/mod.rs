//! Offset surfaces (section 7.2 of the paper): everything at a distance
//! outside or inside the crust, from one reconstruction.
//!
//! Outward by `d` every inner ball grows by `d` and every outer ball shrinks
//! by it, inward the reverse; balls of no radius go, the others keep their
//! labels. The faces between unlike cells of their power diagram are again
//! the boundary of a solid, whatever the distance, so parts may come apart or
//! grow together.
//!
//! # What the paper leaves out
//! The balls of the crust meet at samples, those of an offset nowhere: four
//! balls of one sample share no point once their radii change. The surface is
//! therefore extracted without samples. That is also where offset crusts are
//! known to fail, their vertices are **misaligned**: an inner and an outer
//! ball that touch the same samples of a plane have a power face parallel to
//! it at the exact distance (up to second order of the spacing over the
//! radii), but a face between balls that touch different ones is tilted, and
//! at edges, where few outer balls stand for a whole fan of directions, the
//! faces are chamfers. So the power diagram says what the offset is (its
//! parts, holes and cavities) and where, and the exact distance to the
//! crust says how far: every vertex is moved to it, and faces
//! that are off it between their vertices are cut, at creases
//! where the two sides meet (`crate::fit`).
//! Planes of the crust are made exact first, where enough samples tell of
//! them (`level`); their offsets are then planes at any distance.
//!
//! Where the fitted surface crosses itself and mending cannot help, faces stay
//! as the paper has them (see `crate::fit`).

mod distance;
mod level;
mod shell;

use crate::context::Context;
use crate::delaunay::times_power;
use crate::error::Error;
use crate::fit::{solid, Cells, Field};
use crate::geom::{Bounds, Point, Side};
use crate::mesh::{PolygonMesh, Surface};
use crate::pipeline::Reconstruction;
use crate::power::power_diagram;
use crate::predicates::Site;
use crate::surface::{drop_inverted, triangulate, Crust, NONE};
use distance::Distance;

/// The least tolerance that is taken where none is given, as a share of the
/// diagonal.
pub const TOLERANCE: f64 = 1e-4;
/// Where the crust itself is coarser, its sagitta is taken: that of this share
/// of its edges is less. Finer faces would show its triangles, not the solid.
const SAGITTAS: f64 = 0.75;

/// How offsets are made.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct OffsetOptions {
    /// How far faces may lie off the exact offset of the crust between their
    /// vertices, in the units of the input. Positive. `None` takes
    /// [`TOLERANCE`] of the diagonal of the crust, or what the crust itself is
    /// off a smooth surface through its vertices, if that is more.
    pub tolerance: Option<f64>,
    /// Move the vertices of the power diagram to the exact distance and cut
    /// faces that are off it. Without, the surface is that of the paper.
    pub fit: bool,
    /// Round coordinates to single precision, and make sure of the surface on
    /// those.
    pub single: bool,
}

impl Default for OffsetOptions {
    fn default() -> OffsetOptions {
        OffsetOptions {
            tolerance: None,
            fit: true,
            single: false,
        }
    }
}

/// An offset surface.
#[derive(Clone, Debug)]
pub struct Offset {
    /// The surface, closed and oriented; no vertex is a sample. The balls of
    /// its faces are those of the reconstruction.
    pub crust: Crust,
    /// The distance, positive outside.
    pub distance: f64,
    /// The thickness of the wall, for a shell.
    pub thickness: Option<f64>,
    /// Balls of the reconstruction that have no radius left: inner and outer.
    pub vanished: [usize; 2],
    /// Whether the vertices were moved to the exact distance.
    pub fitted: bool,
    /// Balls whose faces were not, because the surface would have crossed
    /// itself.
    pub unfitted: usize,
    /// Inner balls that had to turn outer because the surface crossed itself.
    pub turned: usize,
    /// Pairs of faces that cross and could not be mended: 0 but for a fault.
    pub crossings_left: usize,
    /// The largest and the mean difference between the distance asked for and
    /// that of the vertices and middles of the faces from the crust, in the
    /// units of the input.
    pub error: [f64; 2],
}

/// Makes offsets of one reconstruction.
///
/// ```
/// use powercrust::offset::{OffsetOptions, Offsets};
/// use powercrust::{reconstruct, Context, Options};
/// # let points: Vec<[f64; 3]> = (0..600).map(|k| {
/// #     let (z, a) = ((k as f64 + 0.5) / 300.0 - 1.0, k as f64 * 2.399963);
/// #     let r = (1.0 - z * z).sqrt();
/// #     [r * a.cos(), r * a.sin(), z]
/// # }).collect();
/// let cx = Context::default();
/// let ball = reconstruct(&points, &Options::default(), &cx)?; // a unit ball
/// let offsets = Offsets::new(&ball, OffsetOptions::default())?;
/// for distance in [-0.5, 1.0] {
///     let crust = offsets.at(distance, &cx)?.crust;
///     let radius = (crust.mesh.volume() * 0.75 / std::f64::consts::PI).cbrt();
///     assert!((radius - 1.0 - distance).abs() < 0.02);
/// }
/// assert!(offsets.at(-1.5, &cx).is_err()); // nothing is left
/// # Ok::<(), powercrust::Error>(())
/// ```
pub struct Offsets<'a> {
    of: &'a Reconstruction,
    options: OffsetOptions,
    tolerance: f64,
    /// The crust at a size near 1.
    base: Surface,
    /// Coordinates times two to this are of a size near 1.
    unit: i32,
}

impl<'a> Offsets<'a> {
    /// Prepares a reconstruction.
    ///
    /// # Errors
    /// [`Error::Option`] for a tolerance that is not positive.
    pub fn new(of: &'a Reconstruction, options: OffsetOptions) -> Result<Offsets<'a>, Error> {
        let bounds = Bounds::of(&of.crust.mesh.vertices);
        let diagonal = bounds.map_or(0.0, |b| b.diagonal());
        let own = || level::sagitta(&of.crust.mesh, SAGITTAS).max(TOLERANCE * diagonal);
        let tolerance = options.tolerance.unwrap_or_else(own);
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(Error::Option {
                name: "tolerance",
                value: tolerance,
                expected: "a positive length",
            });
        }
        let unit = of.lattice.unit_exponent();
        let mut scaled = of.crust.mesh.clone();
        scaled.vertices = level::level(&of.crust);
        for p in &mut scaled.vertices {
            *p = p.map(|x| times_power(x, unit));
        }
        Ok(Offsets {
            of,
            options,
            tolerance,
            base: Surface::new(&scaled),
            unit,
        })
    }

    /// How far faces may lie off the exact offset, in the units of the input.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The largest radius of an inner ball: nothing is left as far inside.
    pub fn depth(&self) -> f64 {
        let inner = self.of.balls.iter().filter(|b| b.side == Side::Inner);
        inner.map(|b| b.ball.radius).fold(0.0, f64::max)
    }

    /// The largest distance outside that the frame has room for; a larger
    /// [`crate::Options::box_factor`] makes more.
    pub fn reach(&self) -> f64 {
        let lattice = &self.of.lattice;
        lattice.length_to_user((lattice.frame_half - lattice.sample_half) / 2.0)
    }

    /// The surface at a distance from the crust, positive outside, in the
    /// units of the input. At 0 it is the crust.
    ///
    /// # Errors
    /// [`Error::Vanished`] where nothing is left, [`Error::Option`] for a
    /// distance that is no number or beyond [`Self::reach`],
    /// [`Error::TooLarge`] and [`Error::Cancelled`].
    pub fn at(&self, distance: f64, context: &Context) -> Result<Offset, Error> {
        context.install(|| self.make(distance, context))
    }

    fn make(&self, distance: f64, context: &Context) -> Result<Offset, Error> {
        if !(distance.is_finite() && distance <= self.reach()) {
            return Err(Error::Option {
                name: "distance",
                value: distance,
                expected: "a length within the frame, which a larger box_factor widens",
            });
        }
        let mut done = Offset {
            crust: Crust::default(),
            distance,
            thickness: None,
            vanished: [0; 2],
            fitted: self.options.fit,
            unfitted: 0,
            turned: 0,
            crossings_left: 0,
            error: [0.0; 2],
        };
        if distance == 0.0 {
            done.crust =
                match self.of.crust.mesh.corners.len() == 3 * self.of.crust.mesh.face_count() {
                    true => self.of.crust.clone(),
                    false => triangulate(&self.of.crust),
                };
            done.crossings_left = self.of.stats.crossings_left;
            return Ok(done);
        }
        let moved = Moved::of(self.of, distance);
        done.vanished = moved.vanished;
        let gone = || Error::Vanished {
            distance,
            depth: self.depth(),
        };
        if !moved.sides.contains(&Side::Inner) {
            return Err(gone());
        }
        let step = self.of.ball_lattice.step();
        let power = power_diagram(&moved.sites, step, context)?;
        let (lattice, unit) = (&self.of.lattice, self.unit);
        let cells = Cells {
            power: &power,
            to_unit: &|p| self.rounded(lattice.to_user(p.map(|x| x * step)), unit),
            tolerance: times_power(self.tolerance, unit),
            shortest: 0.0,
            single: self.options.single,
        };
        let field = Distance {
            base: &self.base,
            distance: times_power(distance, unit),
            tolerance: cells.tolerance,
        };
        let field = self.options.fit.then_some(&field as &dyn Field);
        let Some(made) = solid(&cells, moved.sides.clone(), field, context)? else {
            return Err(gone());
        };
        done.fitted = made.fitted;
        done.unfitted = made.unfitted;
        done.turned = made.turned;
        done.crossings_left = made.crossings_left;
        done.crust = made.crust;
        drop_inverted(&mut done.crust);
        if done.crust.mesh.face_count() == 0 {
            return Err(gone());
        }
        done.error = self.error(&done.crust.mesh, distance, context)?;
        for p in &mut done.crust.mesh.vertices {
            *p = p.map(|x| times_power(x, -self.unit));
        }
        for balls in &mut done.crust.face_balls {
            *balls = balls.map(|b| moved.ids.get(b as usize).copied().unwrap_or(NONE));
        }
        Ok(done)
    }

    /// A point in the units of the input at a size near 1, as it is written.
    fn rounded(&self, p: Point, unit: i32) -> Point {
        p.map(|x| {
            let x = if self.options.single {
                f64::from(x as f32)
            } else {
                x
            };
            times_power(x, unit)
        })
    }

    /// The largest and the mean error of a mesh at a size near 1.
    fn error(
        &self,
        mesh: &PolygonMesh,
        distance: f64,
        context: &Context,
    ) -> Result<[f64; 2], Error> {
        let mut points = mesh.vertices.clone();
        points.extend(mesh.faces().map(|face| {
            let sum = face.iter().fold([0.0; 3], |sum, &v| {
                let p = mesh.vertices[v as usize];
                [sum[0] + p[0], sum[1] + p[1], sum[2] + p[2]]
            });
            sum.map(|x| x / face.len() as f64)
        }));
        let wanted = times_power(distance, self.unit).abs();
        let found = self.base.distances(&points, context)?;
        let off = found.iter().map(|d| (d - wanted).abs());
        let (most, sum) = off.fold((0.0, 0.0), |(m, s), e| (f64::max(m, e), s + e));
        let mean = sum / points.len().max(1) as f64;
        Ok([most, mean].map(|e| times_power(e, -self.unit)))
    }
}

/// The balls of an offset.
struct Moved {
    sites: Vec<Site>,
    sides: Vec<Side>,
    /// The number of each in the reconstruction.
    ids: Vec<u32>,
    vanished: [usize; 2],
}

impl Moved {
    fn of(of: &Reconstruction, distance: f64) -> Moved {
        let change = times_power(distance, of.lattice.exponent) / of.ball_lattice.step();
        let mut moved = Moved {
            sites: Vec::with_capacity(of.balls.len()),
            sides: Vec::with_capacity(of.balls.len()),
            ids: Vec::with_capacity(of.balls.len()),
            vanished: [0; 2],
        };
        for (b, (site, ball)) in of.power.sites.iter().zip(&of.balls).enumerate() {
            let radius = site[3].sqrt()
                + match ball.side {
                    Side::Inner => change,
                    Side::Outer => -change,
                };
            if radius <= 0.0 {
                moved.vanished[ball.side as usize] += 1;
                continue;
            }
            let weight = (radius * radius).round();
            moved.sites.push([site[0], site[1], site[2], weight]);
            moved.sides.push(ball.side);
            moved.ids.push(b as u32);
        }
        moved
    }
}
