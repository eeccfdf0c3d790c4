//! Shells: the wall between two offset surfaces, one closed solid.

use super::{Offset, Offsets};
use crate::context::Context;
use crate::delaunay::times_power;
use crate::error::Error;
use crate::surface::{drop_inverted, mend_crust, Crust, MendOptions, NONE};

impl Offsets<'_> {
    /// The wall of a thickness inside the surface at a distance: outside it
    /// ends at `distance`, inside at `distance - thickness`.
    ///
    /// # Errors
    /// As [`Offsets::at`], and [`Error::Option`] for a thickness that is not
    /// positive. [`Error::Vanished`] where the inside has no room: the solid
    /// would be full.
    pub fn shell(&self, distance: f64, thickness: f64, context: &Context) -> Result<Offset, Error> {
        if !(thickness > 0.0 && thickness.is_finite()) {
            return Err(Error::Option {
                name: "shell",
                value: thickness,
                expected: "a positive length",
            });
        }
        let outer = self.at(distance, context)?;
        let inner = self.at(distance - thickness, context)?;
        let crossings = outer.crossings_left + inner.crossings_left;
        let mut joined = joined(&outer.crust, &inner.crust);
        let scaled = |crust: &mut Crust, e: i32| {
            for p in &mut crust.mesh.vertices {
                *p = p.map(|x| times_power(x, e));
            }
        };
        scaled(&mut joined, self.unit);
        let how = MendOptions {
            handles: None,
            flatness: 0.0,
            tolerance: None,
            single: self.options.single,
            keep_samples: true,
            spacing: &|_| 0.0,
            ball: &|_| None,
        };
        let mended = context.install(|| mend_crust(joined, &how, context))?;
        let mut crust = mended.crust;
        drop_inverted(&mut crust);
        scaled(&mut crust, -self.unit);
        Ok(Offset {
            crust,
            distance,
            thickness: Some(thickness),
            vanished: [0, 1].map(|k| outer.vanished[k].max(inner.vanished[k])),
            fitted: outer.fitted && inner.fitted,
            unfitted: outer.unfitted + inner.unfitted,
            turned: outer.turned + inner.turned,
            crossings_left: mended.left.len().max(crossings),
            error: [0, 1].map(|k| outer.error[k].max(inner.error[k])),
        })
    }
}

/// One surface and another one inside out. Samples are triangle vertices that
/// may not move; there are none in a shell.
fn joined(outer: &Crust, inner: &Crust) -> Crust {
    let mut all = outer.clone();
    let base = all.mesh.vertices.len() as u32;
    all.mesh.vertices.extend_from_slice(&inner.mesh.vertices);
    for face in inner.mesh.faces() {
        let turned: Vec<u32> = face.iter().rev().map(|v| v + base).collect();
        all.mesh.push_face(&turned);
    }
    let other = inner.face_balls.iter().map(|&[i, o]| [o, i]);
    all.face_balls.extend(other);
    all.vertex_samples = vec![NONE; all.mesh.vertices.len()];
    all
}
