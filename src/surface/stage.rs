//! The crust stage of the pipeline: extract, clean, cut into triangles, mend;
//! and, where a crossing resists, let a ball change sides and start over.

use std::time::Instant;

use super::mend::{mend_crust, MendOptions};
use super::{
    clean_counted, raw_crust, triangulate_faces, CleanOptions, Crust, Placement, Triangles, NONE,
};
use crate::context::{Context, Stage};
use crate::delaunay::{times_power, Samples};
use crate::error::Error;
use crate::geom::{Ball, Point, Side};
use crate::mesh::polygon::start_fans;
use crate::mesh::{check, CheckOptions, Finding, PolygonMesh, Shape};
use crate::options::{Faces, Options};
use crate::poles::Balls;
use crate::power::{power_diagram, PowerDiagram};
use crate::stats::Stats;
use crate::tetra::Complex;

/// Times a crust is made; in the second half balls only turn outward, which
/// comes to an end.
const TRIES: usize = 24;

/// Handles amid noise are cut where a loop around them is no longer than so many times the noise.
///
/// Of 24 surfaces of 10,000 samples with noise of 0.25, 0.5 and 1 % of the diagonal, 23, 22 and 21 have the right
/// topology with 3, 23, 22 and 20 with 4.5, where true handles go, and 23, 18 and 15 without.
const HANDLE: f64 = 3.0;

/// What the stage works on.
pub(crate) struct Job<'a> {
    pub samples: &'a Samples,
    /// The spacing at each sample, in lattice steps.
    pub spacing: &'a [f64],
    /// The noise that was at each sample, in lattice steps; empty where there was none.
    pub noise: &'a [f64],
    pub balls: &'a Balls,
    pub power: &'a mut PowerDiagram,
    pub options: &'a Options,
}

impl Job<'_> {
    /// Makes the crust. Labels change where the surface crosses itself and
    /// nothing else helps.
    pub fn run(
        &mut self,
        sides: &mut [Side],
        stats: &mut Stats,
        context: &Context,
    ) -> Result<Crust, Error> {
        let mut turned = vec![false; sides.len()];
        for attempt in 0.. {
            let (crust, left) = self.make(sides, attempt == 0, stats, context)?;
            if left.is_empty() || attempt + 1 == TRIES {
                stats.crossings_left = left.len();
                return Ok(crust);
            }
            let before = stats.relabelled;
            for pair in left {
                self.turn(pair, sides, &mut turned, attempt, stats);
            }
            if stats.relabelled == before {
                stats.crossings_left = 1;
                return Ok(crust);
            }
        }
        Err(self.nothing())
    }

    /// Makes the cells of the power diagram again if they were dropped: to the bit
    /// the same, as it is unique.
    fn provide_cells(&mut self, context: &Context) -> Result<(), Error> {
        if self.power.complex.is_empty() {
            let balls = &self.power.sites[..self.power.balls];
            let again = power_diagram(balls, self.balls.lattice.step(), context)?;
            self.power.complex = again.complex;
        }
        Ok(())
    }

    /// That there is no inner ball.
    pub fn nothing(&self) -> Error {
        Error::NothingInside {
            samples: self.samples.len(),
        }
    }

    /// Lets a ball at two faces, given by their balls, change sides.
    fn turn(
        &self,
        faces: [[u32; 2]; 2],
        sides: &mut [Side],
        turned: &mut [bool],
        attempt: usize,
        stats: &mut Stats,
    ) {
        let balls = faces.iter().flatten().copied();
        let able = balls.filter(|&b| {
            b != NONE
                && (b as usize) < sides.len()
                && (!turned[b as usize] || attempt >= TRIES / 2 && sides[b as usize] == Side::Inner)
                && !(sides[b as usize] == Side::Outer
                    && (attempt >= TRIES / 2 || self.balls.touches_frame[b as usize]))
        });
        let weight = |b: &u32| self.balls.sites[*b as usize][3];
        let smallest = able.min_by(|a, b| weight(a).total_cmp(&weight(b)).then(a.cmp(b)));
        if let Some(b) = smallest {
            let side = &mut sides[b as usize];
            *side = side.opposite();
            turned[b as usize] = true;
            stats.relabelled += 1;
        }
    }

    /// Makes a crust by the labels; what could not be mended comes as pairs
    /// of faces by their balls.
    #[allow(clippy::type_complexity)]
    fn make(
        &mut self,
        sides: &[Side],
        first: bool,
        stats: &mut Stats,
        context: &Context,
    ) -> Result<(Crust, Vec<[[u32; 2]; 2]>), Error> {
        self.provide_cells(context)?;
        let options = self.options;
        context.advance(Stage::Crust, 0, 3)?;
        let lattice = self.samples.lattice;
        let step = self.balls.lattice.step();
        let single = |p: Point| match options.single {
            true => p.map(|x| f64::from(x as f32)),
            false => p,
        };
        // Surfaces are made at a size near 1, exactly scaled, so that areas of
        // tiny or huge inputs are numbers.
        let unit = lattice.unit_exponent();
        let resized = |p: Point, e: i32| p.map(|x| times_power(x, e));
        let place = Placement {
            touching: &|b| self.balls.touching(b),
            sample: &|s| resized(single(self.samples.points[s as usize]), unit),
            to_user: &|p| resized(single(lattice.to_user(p.map(|x| x * step))), unit),
        };
        let mut clock = Instant::now();
        let raw = raw_crust(self.power, sides, &place);
        if !options.cells {
            self.power.complex = Complex::default();
        }
        stats.part("crust: extract", &mut clock);
        if raw.next.is_empty() {
            return Err(self.nothing());
        }
        context.advance(Stage::Crust, 1, 3)?;
        let (polygons, faces) = clean_counted(raw, &CleanOptions::default());
        if first {
            stats.power_faces = faces;
        }
        stats.polygons = polygons.mesh.face_count();
        stats.part("crust: clean", &mut clock);
        context.advance(Stage::Crust, 2, 3)?;
        // Polygons are asked for again only where they are written.
        let kept = (options.faces == Faces::Polygons).then(|| polygons.clone());
        let Triangles {
            crust: triangles,
            starts,
        } = triangulate_faces(polygons);
        if triangles.mesh.face_count() == 0 {
            return Err(self.nothing());
        }
        stats.part("crust: triangulate", &mut clock);
        if first {
            stats.shape_before = Shape::of_triangles(&triangles.mesh);
        }
        let handle = |s: u32| {
            let most = HANDLE * self.noise[s as usize];
            times_power(lattice.length_to_user(most), unit)
        };
        let how = MendOptions {
            handles: (!self.noise.is_empty()).then_some(&handle),
            flatness: match options.faces {
                Faces::Triangles | Faces::None => options.flatness,
                Faces::Polygons => 0.0,
            },
            tolerance: None,
            single: options.single,
            keep_samples: options.interpolate == Some(true),
            ball: &|b| {
                let site = self.balls.sites.get(b as usize)?;
                let centre = [site[0] * step, site[1] * step, site[2] * step];
                let radius = lattice.length_to_user(site[3].sqrt() * step);
                Some(Ball::new(
                    resized(lattice.to_user(centre), unit),
                    times_power(radius, unit),
                ))
            },
            spacing: &|s| {
                let user = lattice.length_to_user(self.spacing[s as usize]);
                times_power(user, unit)
            },
        };
        let mended = mend_crust(triangles, &how, context)?;
        stats.part("crust: mend", &mut clock);
        for &(part, seconds) in &mended.seconds {
            stats.add_part(&format!("crust: mend: {part}"), seconds);
        }
        if first {
            stats.crossings_found = mended.found;
        }
        stats.shape_after = Shape::of_triangles(&mended.crust.mesh);
        stats.mend_rounds += mended.rounds;
        stats.mended_faces += mended.changes;
        stats.drawn_apart = mended.drawn_apart;
        stats.handles_cut = mended.handles_cut;
        stats.flattened = mended.collapsed;
        stats.samples_lost = mended.samples_lost;
        let left = mended.left;
        let mut crust = mended.crust;
        if let Some(polygons) = &kept {
            let of: Vec<u32> = (mended.source.iter())
                .map(|t| starts.partition_point(|start| start <= t) as u32 - 1)
                .collect();
            crust = regroup(crust, polygons, &of, context)?;
        }
        if crust.mesh.face_count() == 0 {
            return Err(self.nothing());
        }
        for v in &mut crust.mesh.vertices {
            *v = resized(*v, -unit);
        }
        stats.vertices = crust.mesh.vertices.len();
        stats.faces = crust.mesh.face_count();
        stats.volume = crust.mesh.volume();
        context.advance(Stage::Crust, 3, 3)?;
        Ok((crust, left))
    }
}

/// Polygons again where mending changed nothing: `of` names the polygon each
/// triangle was cut from. Those whose triangles do not fill them as they were,
/// that no fan from a corner fills, or that cross others so cut, stay
/// triangles: other programs cut polygons into fans from their first corner.
fn regroup(
    triangles: Crust,
    polygons: &Crust,
    of: &[u32],
    context: &Context,
) -> Result<Crust, Error> {
    let mesh = &triangles.mesh;
    // Where each polygon's triangles lie.
    let mut order: Vec<u32> = (0..of.len() as u32).collect();
    order.sort_by_key(|&t| of[t as usize]);
    let runs: Vec<(u32, Vec<u32>)> = (order.chunk_by(|&s, &t| of[s as usize] == of[t as usize]))
        .map(|run| (of[run[0] as usize], run.to_vec()))
        .collect();
    let mut whole: Vec<bool> = Vec::with_capacity(runs.len());
    let mut rings = Vec::with_capacity(runs.len());
    for (p, run) in &runs {
        let ring = border(mesh, run);
        let face = polygons.mesh.face(*p as usize);
        let same = ring.as_ref().is_some_and(|ring| {
            ring.len() == face.len()
                && run.len() + 2 == face.len()
                && (0..face.len()).any(|shift| {
                    (0..face.len()).all(|k| {
                        let (v, w) = (ring[(k + shift) % face.len()], face[k]);
                        mesh.vertices[v as usize] == polygons.mesh.vertices[w as usize]
                    })
                })
        });
        whole.push(same);
        rings.push(ring.unwrap_or_default());
    }
    let fans = start_fans(&mesh.vertices, &mut rings);
    whole.iter_mut().zip(fans).for_each(|(w, fan)| *w &= fan);
    loop {
        let mut out = Crust {
            mesh: PolygonMesh::with_vertices(mesh.vertices.clone()),
            vertex_samples: triangles.vertex_samples.clone(),
            face_balls: Vec::new(),
        };
        let mut run_of = Vec::new();
        for (k, (_, run)) in runs.iter().enumerate() {
            if whole[k] {
                out.mesh.push_face(&rings[k]);
                out.face_balls.push(triangles.face_balls[run[0] as usize]);
                run_of.push(k);
                continue;
            }
            for &t in run {
                out.mesh.push_face(mesh.face(t as usize));
                out.face_balls.push(triangles.face_balls[t as usize]);
                run_of.push(k);
            }
        }
        let every = CheckOptions {
            max_findings: usize::MAX / 4,
            ..CheckOptions::default()
        };
        let report = check(&out.mesh, &every, context)?;
        let mut split = false;
        for finding in &report.findings {
            let faces = match *finding {
                Finding::Crossing { a, b } | Finding::Touching { a, b } => [a, b],
                Finding::ZeroArea { face } => [face, face],
                _ => continue,
            };
            for f in faces {
                split |= std::mem::take(&mut whole[run_of[f as usize]]);
            }
        }
        if !split {
            return Ok(out);
        }
    }
}

/// The border of triangles that form a disc, as one ring.
fn border(mesh: &PolygonMesh, run: &[u32]) -> Option<Vec<u32>> {
    let mut edges: Vec<(u32, u32)> = Vec::with_capacity(3 * run.len());
    for &t in run {
        let face = mesh.face(t as usize);
        edges.extend((0..3).map(|k| (face[k], face[(k + 1) % 3])));
    }
    edges.sort_unstable();
    let outer: Vec<(u32, u32)> = (edges.iter())
        .filter(|(a, b)| edges.binary_search(&(*b, *a)).is_err())
        .copied()
        .collect();
    let mut ring = Vec::with_capacity(outer.len());
    let (first, _) = *outer.first()?;
    let mut at = first;
    while ring.len() < outer.len() {
        ring.push(at);
        let k = outer.binary_search_by(|e| e.0.cmp(&at)).ok()?;
        at = outer[k].1;
        if at == first {
            break;
        }
    }
    (ring.len() == outer.len() && at == first).then_some(ring)
}
