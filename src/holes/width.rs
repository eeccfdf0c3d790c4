//! How wide the gap is that each face spans, beside the spacing of the
//! samples there.
//!
//! The spacing at a sample is the distance to the fourth nearest next to it
//! ([`Reconstruction::spacing`]). One sample says little, so medians are taken
//! twice over the vertices around, and pass on to vertices that are no
//! samples. Scan lines are dense along and sparse across: every face there is
//! as wide as the lines are apart. So the smallest width at a sample counts as
//! spacing too, by medians likewise: beside a hole there are narrow faces.

use rayon::prelude::*;

use crate::geom::vec3::{add, scale, sub};
use crate::geom::{Ball, Bounds, Point};
use crate::mesh::halves::Halves;
use crate::pipeline::Reconstruction;
use crate::surface::NONE;

/// By face.
pub(super) struct Widths {
    /// The width of the gap, a length.
    pub width: Vec<f64>,
    /// The spacing of the samples around, a length.
    pub spacing: Vec<f64>,
}

impl Widths {
    pub fn of(result: &Reconstruction, halves: &Halves) -> Widths {
        let crust = &result.crust;
        let mesh = &crust.mesh;
        let unit = Bounds::of(&mesh.vertices).map_or(1.0, |b| b.diagonal());
        let ball = |b: u32| result.balls.get(b as usize).map(|b| &b.ball);
        let width: Vec<f64> = (0..mesh.face_count())
            .into_par_iter()
            .map(|f| {
                let [inner, outer] = crust.face_balls[f];
                let (Some(inner), Some(outer)) = (ball(inner), ball(outer)) else {
                    return 0.0;
                };
                let face = mesh.face(f);
                let share = 1.0 / face.len() as f64;
                let middle = (face.iter()).fold([0.0; 3], |sum, &v| {
                    add(sum, scale(mesh.vertices[v as usize], share))
                });
                let power = |ball: &Ball| power(ball, middle, unit);
                let depth = -0.5 * (power(inner) + power(outer));
                2.0 * unit * depth.max(0.0).sqrt()
            })
            .collect();
        let sample = |v: u32| crust.vertex_samples[v as usize];
        let vertices = 0..mesh.vertices.len() as u32;
        let spacing: Vec<f64> = (vertices.clone())
            .map(|v| result.spacing.get(sample(v) as usize))
            .map(|s| s.copied().unwrap_or(f64::NAN))
            .collect();
        let narrowest: Vec<f64> = vertices
            .map(|v| match sample(v) {
                NONE => f64::NAN,
                _ => (halves.leaving(v).iter())
                    .map(|&h| width[halves.face[h as usize] as usize])
                    .fold(f64::NAN, f64::min),
            })
            .collect();
        let around = [smooth(spacing, halves), smooth(narrowest, halves)];
        let spacing = (0..mesh.face_count())
            .map(|f| {
                let corners = mesh.face(f).iter().flat_map(|&v| {
                    let v = v as usize;
                    [around[0][v], around[1][v]]
                });
                corners.fold(f64::NAN, f64::max)
            })
            .collect();
        Widths { width, spacing }
    }

    /// The width of a face in spacings.
    pub fn spacings(&self, face: usize) -> f64 {
        self.width[face] / self.spacing[face]
    }
}

/// The power of a point after division of all lengths by `unit`.
fn power(ball: &Ball, p: Point, unit: f64) -> f64 {
    let d = scale(sub(p, ball.centre), 1.0 / unit);
    let r = ball.radius / unit;
    d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - r * r
}

/// Medians over the vertices around, twice, and then for vertices that have
/// none yet, ring by ring. NaN is no value.
fn smooth(values: Vec<f64>, halves: &Halves) -> Vec<f64> {
    let mut values = values;
    for _ in 0..2 {
        values = (0..values.len() as u32)
            .into_par_iter()
            .map_init(Vec::new, |room, v| median(&values, v, halves, room))
            .collect();
    }
    let mut room = Vec::new();
    loop {
        let missing = |&v: &u32| values[v as usize].is_nan();
        let found: Vec<(u32, f64)> = (0..values.len() as u32)
            .filter(missing)
            .map(|v| (v, median(&values, v, halves, &mut room)))
            .filter(|(_, value)| !value.is_nan())
            .collect();
        if found.is_empty() {
            return values;
        }
        for (v, value) in found {
            values[v as usize] = value;
        }
    }
}

/// The lower median of the values at a vertex and around it.
fn median(values: &[f64], v: u32, halves: &Halves, room: &mut Vec<f64>) -> f64 {
    room.clear();
    let near = halves.leaving(v).iter().map(|&h| halves.head(h));
    for w in near.chain([v]) {
        let value = values[w as usize];
        if !value.is_nan() {
            // Few, so in order at once.
            let at = room.partition_point(|&x| x < value);
            room.insert(at, value);
        }
    }
    match room.len() {
        0 => f64::NAN,
        known => room[(known - 1) / 2],
    }
}
