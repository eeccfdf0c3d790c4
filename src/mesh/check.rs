//! The judge of meshes: is this the boundary of a solid, and if not, where
//! and why not.
//!
//! The clauses are those of [`Report::is_watertight`]. Everything that decides
//! a clause is exact on the given coordinates; sizes and angles are floating
//! point. The running time is near-linear for meshes whose faces do not crowd,
//! and the report does not depend on the number of threads.

use super::crossing::{coincidences, crossings, flat, Crossings, Field, Kind};
use super::frame::Frame;
use super::measure::{finite_bounds, middle, shape, sizes, Size};
use super::nesting;
use super::report::{Counts, Finding, Report, Shell};
use super::soup::{Faces, Fault, Triangles};
use super::topology::{EdgeFault, Topology};
use super::PolygonMesh;
use crate::context::{Cancelled, Context, Stage};
use crate::geom::Point;
use rayon::prelude::*;

/// What to check, and how much to tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CheckOptions {
    /// Test whether faces cross or touch; most of the time goes there.
    pub intersections: bool,
    /// Findings listed of each kind; counts are always complete.
    pub max_findings: usize,
    /// Judge the coordinates rounded to single precision, as files of that
    /// precision hold them.
    pub f32: bool,
}

impl Default for CheckOptions {
    /// Everything on the coordinates as they are; 100 findings of a kind.
    fn default() -> CheckOptions {
        CheckOptions {
            intersections: true,
            max_findings: 100,
            f32: false,
        }
    }
}

/// Judges a mesh. Any mesh will do, also one whose indices are out of range.
///
/// ```
/// use powercrust::mesh::{check, CheckOptions, Finding, PolygonMesh};
/// # use powercrust::Context;
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let mut mesh = PolygonMesh::with_vertices(corners);
/// for face in [[0, 2, 1], [0, 1, 3], [1, 2, 3]] {
///     mesh.push_face(&face);
/// }
/// let report = check(&mesh, &CheckOptions::default(), &Context::default())?;
/// assert_eq!(report.counts.open_edge, 3);
/// assert!(report.findings.contains(&Finding::OpenEdge { edge: [0, 2], face: 0 }));
/// mesh.push_face(&[2, 0, 3]);
/// let report = check(&mesh, &CheckOptions::default(), &Context::default())?;
/// assert!(report.is_watertight());
/// # Ok::<(), powercrust::Cancelled>(())
/// ```
pub fn check(mesh: &PolygonMesh, o: &CheckOptions, cx: &Context) -> Result<Report, Cancelled> {
    cx.install(|| match o.f32 {
        true => {
            let rounded = |p: &Point| p.map(|x| f64::from(x as f32));
            let vertices: Vec<Point> = mesh.vertices.iter().map(rounded).collect();
            judge(&vertices, mesh, o, cx)
        }
        false => judge(&mesh.vertices, mesh, o, cx),
    })
}

/// Counts all findings and keeps the first of each kind.
struct Ledger {
    max: usize,
    counts: Counts,
    findings: Vec<Finding>,
}

impl Ledger {
    fn add(&mut self, count: fn(&mut Counts) -> &mut u64, finding: impl FnOnce() -> Finding) {
        let count = count(&mut self.counts);
        *count += 1;
        if *count <= self.max as u64 {
            self.findings.push(finding());
        }
    }
}

fn judge(
    points: &[Point],
    mesh: &PolygonMesh,
    o: &CheckOptions,
    cx: &Context,
) -> Result<Report, Cancelled> {
    let mut ledger = Ledger {
        max: o.max_findings,
        counts: Counts::default(),
        findings: Vec::new(),
    };
    cx.advance(Stage::Check, 0, 1)?;
    let mut faulty = Vec::new();
    let faces = Faces::of(mesh, |face, fault| faulty.push((face, fault)));
    for fault in [Fault::OutOfRange, Fault::TooSmall] {
        for &(face, _) in faulty.iter().filter(|f| f.1 == fault) {
            match fault {
                Fault::OutOfRange => ledger.add(
                    |c| &mut c.index_out_of_range,
                    || Finding::IndexOutOfRange { face },
                ),
                Fault::TooSmall => {
                    ledger.add(|c| &mut c.face_too_small, || Finding::FaceTooSmall { face })
                }
            }
        }
    }
    let finite: Vec<bool> = (points.iter())
        .map(|p| p.iter().all(|x| x.is_finite()))
        .collect();
    for vertex in (0..points.len()).filter(|&v| !finite[v]) {
        let vertex = vertex as u32;
        ledger.add(|c| &mut c.not_finite, || Finding::NotFinite { vertex });
    }
    repeated_vertices(&faces, &mut ledger);

    let topology = Topology::of(points.len(), &faces);
    cx.advance(Stage::Check, 0, 1)?;
    for (vertex, _) in topology.fans.iter().enumerate().filter(|&(_, &n)| n == 0) {
        let vertex = vertex as u32;
        ledger.add(
            |c| &mut c.unused_vertex,
            || Finding::UnusedVertex { vertex },
        );
    }
    edge_findings(&faces, &topology, &mut ledger);
    for (vertex, &fans) in topology.fans.iter().enumerate().filter(|&(_, &n)| n > 1) {
        let vertex = vertex as u32;
        ledger.add(
            |c| &mut c.pinched_vertex,
            || Finding::PinchedVertex { vertex, fans },
        );
    }

    let frame = Frame::new(points);
    let triangles = faces.triangles(&frame);
    let mut skip = flat(&frame, &triangles);
    zero_areas(&faces, &triangles, &skip, &finite, &mut ledger);
    for (skip, t) in skip.iter_mut().zip(&triangles.corners) {
        *skip |= !t.iter().all(|&v| finite[v as usize]);
    }
    duplicate_faces(&faces, &topology, &mut ledger);
    let (canonical, duplicate_positions) = coincidences(&frame, &finite);
    cx.advance(Stage::Check, 0, 1)?;
    let used = (0..points.len()).filter(|&v| topology.fans[v] > 0);
    let used_count = used.clone().count();
    let bounds = finite_bounds(used.map(|v| &points[v]));
    let sizes = sizes(
        points,
        middle(&bounds),
        &frame,
        &triangles,
        &topology.shell,
        topology.shell_edges.len(),
    );
    let mut shells = shells(&sizes, &faces, &topology);
    let shape = shape(points, &frame, &triangles);
    let volume: f64 = shells.iter().map(|s| s.volume).sum();
    let mut depths = None;
    if o.intersections {
        let field = Field::new(&frame, &canonical, &triangles, &skip);
        let found = crossings(&field, faces.len(), o.max_findings, cx)?;
        let apart = found.pairs[Kind::Crossing as usize] + found.pairs[Kind::Touching as usize];
        enter_crossings(&faces, found, &mut ledger);
        if apart == 0 && shells.len() > 1 {
            let closed: Vec<bool> = shells.iter().map(|s| s.closed).collect();
            depths = Some(nesting::depths(&field, &topology.shell, &closed));
        }
    }
    inside_out(&shells, volume, depths, &mut ledger);
    for shell in &mut shells {
        shell.volume = frame.leave_size(shell.volume, 3);
        shell.area = frame.leave_size(shell.area, 2);
    }
    Ok(Report {
        vertices: points.len() as u64,
        faces: mesh.face_count() as u64,
        triangles: triangles.corners.len() as u64,
        edges: topology.edges,
        counts: ledger.counts,
        findings: ledger.findings,
        duplicate_positions,
        intersections_tested: o.intersections,
        components: u64::from(topology.components),
        euler: used_count as i64 - topology.edges as i64 + faces.len() as i64,
        genus: shells.iter().map(|s| s.genus).sum(),
        volume: frame.leave_size(volume, 3),
        area: frame.leave_size(sizes.iter().map(|s| s.area).sum(), 2),
        cavities: shells.iter().filter(|s| s.closed && s.volume < 0.0).count() as u64,
        shells,
        bounds,
        smallest_angle: shape.smallest_angle,
        aspects: shape.aspects,
    })
}

fn repeated_vertices(faces: &Faces, ledger: &mut Ledger) {
    let mut sorted = Vec::new();
    for (f, face) in faces.iter().enumerate() {
        if let &[a, b, c] = face {
            if a != b && b != c && c != a {
                continue;
            }
        }
        sorted.clear();
        sorted.extend_from_slice(face);
        sorted.sort_unstable();
        for group in sorted.chunk_by(|a, b| a == b).filter(|g| g.len() > 1) {
            let (face, vertex) = (faces.number[f], group[0]);
            ledger.add(
                |c| &mut c.repeated_vertex,
                || Finding::RepeatedVertex { face, vertex },
            );
        }
    }
}

fn edge_findings(faces: &Faces, topology: &Topology, ledger: &mut Ledger) {
    let face_at = |corner: u32| faces.number[faces.starts.partition_point(|&s| s <= corner) - 1];
    for fault in [EdgeFault::Open, EdgeFault::Misoriented, EdgeFault::Crowded] {
        for bad in topology.bad.iter().filter(|b| b.fault == fault) {
            let edge = bad.ends;
            let corners = &topology.bad_corners[bad.corners.0 as usize..bad.corners.1 as usize];
            let face = |k: usize| face_at(corners[k]);
            match fault {
                EdgeFault::Open => ledger.add(
                    |c| &mut c.open_edge,
                    || Finding::OpenEdge {
                        edge,
                        face: face(0),
                    },
                ),
                EdgeFault::Misoriented => ledger.add(
                    |c| &mut c.misoriented_edge,
                    || Finding::MisorientedEdge {
                        edge,
                        faces: [face(0), face(1)],
                    },
                ),
                EdgeFault::Crowded => ledger.add(
                    |c| &mut c.non_manifold_edge,
                    || Finding::NonManifoldEdge {
                        edge,
                        faces: corners.iter().map(|&c| face_at(c)).collect(),
                    },
                ),
            }
        }
    }
}

/// A face has no area when none of its triangles has.
fn zero_areas(
    faces: &Faces,
    triangles: &Triangles,
    flat: &[bool],
    finite: &[bool],
    ledger: &mut Ledger,
) {
    let runs = triangles.face.chunk_by(|a, b| a == b);
    let mut from = 0;
    for run in runs {
        let all_flat = flat[from..from + run.len()].iter().all(|&f| f);
        from += run.len();
        let f = run[0] as usize;
        if all_flat && faces.face(f).iter().all(|&v| finite[v as usize]) {
            let face = faces.number[f];
            ledger.add(|c| &mut c.zero_area, || Finding::ZeroArea { face });
        }
    }
}

fn duplicate_faces(faces: &Faces, topology: &Topology, ledger: &mut Ledger) {
    let triangular = 3 * faces.len() == faces.corners.len();
    let pairs = match &topology.twins {
        Some(twins) if triangular => back_to_back(faces, twins),
        _ => alike(faces),
    };
    for (a, b) in pairs {
        let (a, b) = (faces.number[a as usize], faces.number[b as usize]);
        ledger.add(
            |c| &mut c.duplicate_face,
            || Finding::DuplicateFace { a, b },
        );
    }
}

/// Triangles of the same vertices, where every edge has two: they have the
/// same neighbours.
fn back_to_back(faces: &Faces, twins: &[u32]) -> Vec<(u32, u32)> {
    let sorted = |f: u32| {
        let mut corners = [0, 1, 2].map(|k| faces.corners[3 * f as usize + k]);
        corners.sort_unstable();
        corners
    };
    (0..faces.len() as u32)
        .map(|f| (f, twins[3 * f as usize] / 3))
        .filter(|&(f, g)| f < g && sorted(f) == sorted(g))
        .collect()
}

/// Faces of the same vertices, by the first of them.
fn alike(faces: &Faces) -> Vec<(u32, u32)> {
    // A hash that does not depend on the order of the corners; fixed, so that
    // runs are alike. Faces of one hash are compared in full.
    let mix = |v: u32| {
        let x = (u64::from(v) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let x = (x ^ (x >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x ^ (x >> 32)
    };
    let hash = |f: usize| (faces.face(f).iter()).fold(0u64, |sum, &v| sum.wrapping_add(mix(v)));
    let mut keys: Vec<(u64, u32)> = (0..faces.len())
        .into_par_iter()
        .map(|f| (hash(f), f as u32))
        .collect();
    keys.par_sort_unstable();
    let mut pairs = Vec::new();
    for group in keys.chunk_by(|a, b| a.0 == b.0).filter(|g| g.len() > 1) {
        let sorted = |f: u32| {
            let mut corners = faces.face(f as usize).to_vec();
            corners.sort_unstable();
            corners
        };
        let mut alike: Vec<(Vec<u32>, u32)> = group.iter().map(|k| (sorted(k.1), k.1)).collect();
        alike.sort_unstable();
        for same in alike.chunk_by(|a, b| a.0 == b.0) {
            pairs.extend(same[1..].iter().map(|b| (same[0].1, b.1)));
        }
    }
    pairs.sort_unstable();
    pairs
}

fn enter_crossings(faces: &Faces, found: Crossings, ledger: &mut Ledger) {
    let counts = &mut ledger.counts;
    [counts.crossing, counts.touching, counts.coincident] = found.pairs;
    counts.crossing_faces = found.faces[Kind::Crossing as usize];
    counts.touching_faces = found.faces[Kind::Touching as usize];
    for kind in [Kind::Crossing, Kind::Touching, Kind::Coincident] {
        for &(a, b) in &found.found[kind as usize] {
            let (a, b) = (faces.number[a as usize], faces.number[b as usize]);
            ledger.findings.push(match kind {
                Kind::Crossing => Finding::Crossing { a, b },
                Kind::Touching => Finding::Touching { a, b },
                Kind::Coincident => Finding::Coincident { a, b },
            });
        }
    }
}

/// The shells, their sizes still in the frame's units.
fn shells(sizes: &[Size], faces: &Faces, topology: &Topology) -> Vec<Shell> {
    let count = topology.shell_edges.len();
    let loops = topology.loops(faces);
    let mut shells: Vec<Shell> = (0..count)
        .map(|s| Shell {
            first_face: u32::MAX,
            faces: 0,
            closed: true,
            loops: loops[s],
            euler: -(topology.shell_edges[s] as i64),
            genus: None,
            volume: sizes[s].volume,
            area: sizes[s].area,
        })
        .collect();
    for (f, &s) in topology.shell.iter().enumerate() {
        let shell = &mut shells[s as usize];
        shell.first_face = shell.first_face.min(faces.number[f]);
        shell.faces += 1;
        shell.euler += 1;
        for c in faces.starts[f]..faces.starts[f + 1] {
            shell.euler += (topology.fan[c as usize] == c) as i64;
        }
    }
    let mut oriented = vec![true; count];
    for bad in &topology.bad {
        let corner = topology.bad_corners[bad.corners.0 as usize];
        let f = faces.starts.partition_point(|&s| s <= corner) - 1;
        let s = topology.shell[f] as usize;
        shells[s].closed = false;
        oriented[s] &= bad.fault == EdgeFault::Open;
    }
    for (shell, oriented) in shells.iter_mut().zip(oriented) {
        let doubled = 2 - shell.euler - shell.loops as i64;
        if oriented && doubled >= 0 && doubled % 2 == 0 {
            shell.genus = Some(doubled as u64 / 2);
        }
    }
    shells
}

/// Shells at an even depth enclose solid, those at an odd depth are walls of
/// cavities. Where depths are not to be told, only the total volume judges.
fn inside_out(
    shells: &[Shell],
    volume: f64,
    depths: Option<Vec<Option<u32>>>,
    ledger: &mut Ledger,
) {
    for (s, shell) in shells.iter().enumerate().filter(|(_, s)| s.closed) {
        let wrong = match depths.as_ref().map(|d| d[s]) {
            Some(Some(depth)) => (shell.volume > 0.0) != (depth % 2 == 0),
            Some(None) => false,
            None => volume <= 0.0 && shell.volume <= 0.0,
        };
        if wrong {
            let shell = s as u32;
            ledger.add(|c| &mut c.inside_out, || Finding::InsideOut { shell });
        }
    }
}
