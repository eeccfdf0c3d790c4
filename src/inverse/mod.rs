//! Back from balls to the surface: the inverse transform (sections 3.4 and 7.3
//! of the paper).
//!
//! Balls of both sides have a power diagram, and between unlike cells lies
//! their crust, whether they come from points, from a simplified axis or from
//! a file. It is cleaned, cut into triangles and mended like any other
//! (`crate::fit`), so it is closed, manifold and free of crossings.
//!
//! Files of other programs hold inner balls only. Outer ones are then made
//! from the complement of their union (`complement`): points on the boundary of
//! the union (`boundary`) have outer poles. For a smooth surface these points
//! lie in the middle of what is left of each sphere, where the balls touched
//! the solid they stand for; the crust then bridges the creases between balls,
//! as the solid did. Where few balls are left that comes nearer to the solid
//! than their union. For the surface of the union itself the points
//! lie all over the boundary, and the crust is fitted to the spheres.
//!
//! Either may come out with other parts, holes or cavities than the union if
//! the points are too few: the exact Betti numbers of the power shape and of
//! the dual complex of the union tell, and more points are taken.

mod boundary;
mod complement;
mod union;

use crate::axis::LabelledBalls;
use crate::context::Context;
use crate::delaunay::times_power;
use crate::error::Error;
use crate::fit::{solid, Cells, Field};
use crate::geom::{Ball, Bounds, Point, Side};
use crate::simplify::{betti, Betti};
use crate::surface::{drop_inverted, Crust, PowerShape, NONE};
use boundary::Spread;
use union::Union;

/// The tolerance taken where none is given, as a share of the diagonal of the
/// inner balls.
pub const TOLERANCE: f64 = 2e-4;
/// Edges up to this share of the size come by rounding.
const ROUNDING: f64 = 1e-8;
/// Of the tolerance of a union, edges of faces take so much: the middles of
/// faces on a sphere are off by 4/3 of what the middles of edges are.
const FIT: f64 = 0.6;
/// And losing vertices half of so much.
const COARSEN: f64 = 0.3;
/// Times points are taken on the boundary, each time closer together.
const TRIES: usize = 3;

/// How balls become a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct InverseOptions {
    /// How far faces may move to lose a vertex and, with `union`, how far they
    /// should be off the union of the balls, as [`Inverse::from_union`] tells: a positive length in the units of the
    /// input. `None` takes [`TOLERANCE`] of the diagonal.
    pub tolerance: Option<f64>,
    /// Make the surface of the union of the inner balls, whatever others there
    /// are.
    pub union: bool,
    /// Round coordinates to single precision, and make sure of the surface on
    /// those.
    pub single: bool,
}

/// A surface made of balls.
#[derive(Clone, Debug)]
pub struct Inverse {
    /// The surface, closed and oriented; no vertex is a sample. The balls of
    /// its faces are those of [`Inverse::balls`].
    pub crust: Crust,
    /// The balls it lies between.
    pub balls: LabelledBalls,
    /// How many outer balls were made.
    pub outer_made: usize,
    /// The Betti numbers of the union of the inner balls, where outer ones
    /// were made.
    pub union_betti: Option<Betti>,
    /// Those of the solid that came out; the same but where no number of
    /// points was enough.
    pub betti: Option<Betti>,
    /// How far faces may be off, in the units of the input.
    pub tolerance: f64,
    /// Whether faces were fitted to the union.
    pub fitted: bool,
    /// Balls whose faces were not, because the surface would have crossed
    /// itself.
    pub unfitted: usize,
    /// Inner balls that had to turn outer because the surface crossed itself.
    pub turned: usize,
    /// Pairs of faces that cross and could not be mended: 0 but for a fault.
    pub crossings_left: usize,
    /// The largest and the mean distance of the vertices and middles of the
    /// faces from the boundary of the union of the inner balls, in the units
    /// of the input.
    pub from_union: [f64; 2],
}

/// Makes the surface of balls.
///
/// # Errors
/// [`Error::Option`] for a tolerance that is no positive length,
/// [`Error::NoInnerBalls`] where there is nothing to be inside of,
/// [`Error::Samples`], [`Error::TooLarge`] and [`Error::Cancelled`].
///
/// ```
/// use powercrust::axis::LabelledBalls;
/// use powercrust::inverse::{crust_of_balls, InverseOptions};
/// use powercrust::{Ball, Context, PowerShape};
/// // Two inner balls that meet.
/// let shape = PowerShape {
///     balls: vec![Ball::new([0.0; 3], 1.0), Ball::new([1.0, 0.0, 0.0], 0.8)],
///     ..PowerShape::default()
/// };
/// let context = Context::default();
/// let balls = LabelledBalls::of_shape(&shape, &context)?;
/// let options = InverseOptions { union: true, ..InverseOptions::default() };
/// let made = crust_of_balls(&balls, &options, &context)?;
/// // Of the union: 4/3 π (1 + 0.512) less the lens.
/// assert!((made.crust.mesh.volume() / 5.5829 - 1.0).abs() < 2e-3);
/// # Ok::<(), powercrust::Error>(())
/// ```
pub fn crust_of_balls(
    balls: &LabelledBalls,
    options: &InverseOptions,
    context: &Context,
) -> Result<Inverse, Error> {
    if let Some(given) = options.tolerance.filter(|t| !(*t > 0.0 && t.is_finite())) {
        return Err(Error::Option {
            name: "tolerance",
            value: given,
            expected: "a positive length",
        });
    }
    context.install(|| run(balls, options, context))
}

fn run(
    balls: &LabelledBalls,
    options: &InverseOptions,
    context: &Context,
) -> Result<Inverse, Error> {
    let bounds = balls.bounds(Side::Inner).ok_or(Error::NoInnerBalls)?;
    let diagonal = balls.inner_diagonal();
    let tolerance = options.tolerance.unwrap_or(TOLERANCE * diagonal);
    let whole = balls.has_both_sides() && !options.union;
    let mut done = Inverse {
        crust: Crust::default(),
        balls: balls.clone(),
        outer_made: 0,
        union_betti: None,
        betti: None,
        tolerance,
        fitted: false,
        unfitted: 0,
        turned: 0,
        crossings_left: 0,
        from_union: [0.0; 2],
    };
    if !whole {
        complete(&mut done, options.union, unit_exponent(&bounds), context)?;
    }
    let own = &done.balls;
    let unit = unit_exponent(&bounds);
    let at_unit = |b: &Ball| {
        Ball::new(
            b.centre.map(|x| times_power(x, unit)),
            times_power(b.radius, unit),
        )
    };
    let inner: Vec<Ball> = (own.balls.iter().zip(&own.sides))
        .filter(|(b, &s)| s == Side::Inner && b.radius > 0.0)
        .map(|(b, _)| at_unit(b))
        .collect();
    let union = Union::new(inner, FIT * times_power(tolerance, unit));
    let grid = own.grid();
    let cells = Cells {
        power: own.power(),
        to_unit: &|p| rounded(grid.to_user(p), options.single).map(|x| times_power(x, unit)),
        tolerance: times_power(
            if options.union {
                COARSEN * tolerance
            } else {
                tolerance
            },
            unit,
        ),
        shortest: times_power(ROUNDING * diagonal, unit),
        single: options.single,
    };
    let field = options.union.then_some(&union as &dyn Field);
    let made = solid(&cells, own.sides.clone(), field, context)?.ok_or(Error::NoInnerBalls)?;
    done.fitted = made.fitted;
    done.unfitted = made.unfitted;
    done.turned = made.turned;
    done.crossings_left = made.crossings_left;
    done.crust = made.crust;
    drop_inverted(&mut done.crust);
    if done.crust.mesh.face_count() == 0 {
        return Err(Error::NoInnerBalls);
    }
    done.from_union = union
        .distances(&done.crust.mesh)
        .map(|e| times_power(e, -unit));
    for p in &mut done.crust.mesh.vertices {
        *p = p.map(|x| times_power(x, -unit));
    }
    let last = done.balls.balls.len() as u32;
    for b in done.crust.face_balls.iter_mut().flatten() {
        *b = if *b < last { *b } else { NONE };
    }
    Ok(done)
}

/// Puts outer balls around the inner ones.
fn complete(done: &mut Inverse, union: bool, unit: i32, context: &Context) -> Result<(), Error> {
    let inner: Vec<usize> = (0..done.balls.balls.len())
        .filter(|&b| done.balls.sides[b] == Side::Inner && done.balls.balls[b].radius > 0.0)
        .collect();
    if inner.is_empty() {
        return Err(Error::NoInnerBalls);
    }
    let mut shape = PowerShape {
        balls: inner.iter().map(|&b| done.balls.balls[b]).collect(),
        ids: inner.iter().map(|&b| done.balls.ids[b]).collect(),
        sides: vec![Side::Inner; inner.len()],
        contacts: inner.iter().map(|&b| done.balls.contacts[b]).collect(),
        ..PowerShape::default()
    };
    // Points are sought at a size near 1, where squares are numbers.
    let scaled = |ball: &Ball, e: i32| {
        let to = |x: f64| times_power(x, e);
        Ball::new(ball.centre.map(to), to(ball.radius))
    };
    let at_unit = PowerShape {
        balls: shape.balls.iter().map(|b| scaled(b, unit)).collect(),
        contacts: Vec::new(),
        ..shape.clone()
    };
    let tolerance = times_power(done.tolerance, unit);
    let alone = LabelledBalls::of_shape(&at_unit, context)?;
    let wanted = betti(&alone.complex(Side::Inner).simplices());
    done.union_betti = Some(wanted);
    let mut best: Option<(u64, LabelledBalls, Betti)> = None;
    for attempt in 0..TRIES {
        let denser = 2f64.powi(attempt as i32);
        // Points twice as dense are off by a quarter. Of the union fitting has
        // the last word.
        let off = tolerance / (denser * denser);
        let spread = match union {
            true => Spread::Within(4.0 * off),
            false => Spread::Middles(off),
        };
        let touches = boundary::touches(&alone, spread, context)?;
        let outer = complement::outer_balls(&touches, context)?;
        shape.others = outer.iter().map(|b| scaled(b, -unit)).collect();
        let both = LabelledBalls::of_shape(&shape, context)?;
        let found = betti(&both.complex(Side::Inner).simplices());
        let off = apart(&wanted, &found);
        if best.as_ref().is_none_or(|b| off < b.0) {
            best = Some((off, both, found));
        }
        if off == 0 {
            break;
        }
    }
    if let Some((_, both, found)) = best {
        done.outer_made = both.sides.iter().filter(|&&s| s == Side::Outer).count();
        done.balls = both;
        done.betti = Some(found);
    }
    Ok(())
}

/// By how many parts, tunnels and voids two shapes differ.
fn apart(a: &Betti, b: &Betti) -> u64 {
    a.parts.abs_diff(b.parts) + a.tunnels.abs_diff(b.tunnels) + a.voids.abs_diff(b.voids)
}

/// Coordinates times two to this are of a size near 1.
fn unit_exponent(bounds: &Bounds) -> i32 {
    let all = bounds.min.iter().chain(&bounds.max);
    let largest = all.fold(0.0f64, |m, v| m.max(v.abs()));
    if largest > 0.0 {
        -(largest.log2().floor() as i32)
    } else {
        0
    }
}

fn rounded(p: Point, single: bool) -> Point {
    match single {
        true => p.map(|x| f64::from(x as f32)),
        false => p,
    }
}
