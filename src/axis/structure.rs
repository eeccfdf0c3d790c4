//! The parts of a thin medial axis, named and numbered (section 0 of the
//! specification of medial axes that the project follows): sheets, seams where three or
//! more of them meet, junctions where seams meet, rims where sheets end, and
//! curves, which are edges without triangles.
//!
//! All follows from how many triangles an edge has. Sheets are numbered by
//! area, largest first, seams, rims and curves by length, junctions by their
//! balls.

use crate::geom::vec3::{cross, dist_sq, norm, sub};
use crate::geom::Sets;
use crate::surface::PowerShape;

/// 'None' among the numbers of parts.
pub const NO_PART: u32 = u32::MAX;

/// A maximal set of triangles joined along edges that only two of them have.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Sheet {
    /// Triangles.
    pub triangles: usize,
    /// Their area.
    pub area: f64,
    /// The diameters of the balls at its triangles: smallest, mean by area, largest.
    pub thickness: [f64; 3],
}

/// A chain of edges: of a seam, of a rim, or of edges without triangles.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Curve {
    /// Edges.
    pub edges: usize,
    /// Their length.
    pub length: f64,
    /// The sheets at it, ascending.
    pub sheets: Vec<u32>,
}

/// A ball where seams meet.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Junction {
    /// The ball.
    pub ball: u32,
    /// The seams at it, ascending.
    pub seams: Vec<u32>,
}

/// The parts of a thin medial axis.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Structure {
    /// Sheets, the largest first.
    pub sheets: Vec<Sheet>,
    /// Seams, the longest first.
    pub seams: Vec<Curve>,
    /// Balls where the ends of more than two seams meet.
    pub junctions: Vec<Junction>,
    /// Rims, the longest first.
    pub rims: Vec<Curve>,
    /// Chains of edges without triangles, the longest first.
    pub curves: Vec<Curve>,
    /// The sheet of each triangle.
    #[serde(skip)]
    pub sheet_of: Vec<u32>,
    /// The seam of each edge, [`NO_PART`] for none.
    #[serde(skip)]
    pub seam_of: Vec<u32>,
    /// The rim of each edge.
    #[serde(skip)]
    pub rim_of: Vec<u32>,
    /// The curve of each edge.
    #[serde(skip)]
    pub curve_of: Vec<u32>,
    /// The junction at each ball.
    #[serde(skip)]
    pub junction_of: Vec<u32>,
}

/// Finds the parts of a shape without tetrahedra, as [`PowerShape::thin`]
/// leaves it; tetrahedra are passed over.
///
/// ```
/// use powercrust::{axis::structure, Ball, PowerShape};
/// // Three pages of a book.
/// let at = |x, y, z| Ball::new([x, y, z], 0.5);
/// let shape = PowerShape {
///     balls: vec![at(0., 0., 0.), at(0., 0., 1.), at(1., 0., 0.), at(0., 1., 0.), at(-1., 0., 0.)],
///     edges: vec![[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [1, 3], [1, 4]],
///     triangles: vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]],
///     ..PowerShape::default()
/// };
/// let parts = structure(&shape);
/// assert_eq!((parts.sheets.len(), parts.seams.len(), parts.rims.len()), (3, 1, 3));
/// assert_eq!(parts.seams[0].sheets, [0, 1, 2]);
/// ```
pub fn structure(shape: &PowerShape) -> Structure {
    let at_edge = triangles_at_edges(shape);
    let mut out = Structure::default();
    sheets(shape, &at_edge, &mut out);
    let is_seam = |e: usize| at_edge[e].len() > 2;
    let is_rim = |e: usize| at_edge[e].len() == 1;
    let is_bare = |e: usize| at_edge[e].is_empty();
    let ends = seam_ends(shape, &is_seam);
    // Chains run through balls with two edges of their kind; where seams end
    // or pass, rims end too.
    let through_seams = |v: u32| ends[v as usize] == 2;
    let mut rim_ends = vec![0usize; shape.balls.len()];
    let mut bare_ends = vec![0usize; shape.balls.len()];
    for (e, edge) in shape.edges.iter().enumerate() {
        for &v in edge {
            rim_ends[v as usize] += usize::from(is_rim(e));
            bare_ends[v as usize] += usize::from(is_bare(e));
        }
    }
    let through_rims = |v: u32| rim_ends[v as usize] == 2 && ends[v as usize] == 0;
    let through_bare =
        |v: u32| bare_ends[v as usize] == 2 && ends[v as usize] == 0 && rim_ends[v as usize] == 0;
    let sheet_of = std::mem::take(&mut out.sheet_of);
    let chains = Chains {
        shape,
        at_edge: &at_edge,
        sheet_of: &sheet_of,
    };
    (out.seams, out.seam_of) = chains.of(&is_seam, &through_seams);
    (out.rims, out.rim_of) = chains.of(&is_rim, &through_rims);
    (out.curves, out.curve_of) = chains.of(&is_bare, &through_bare);
    out.sheet_of = sheet_of;
    junctions(shape, &ends, &mut out);
    out
}

fn triangles_at_edges(shape: &PowerShape) -> Vec<Vec<u32>> {
    let mut at_edge = vec![Vec::new(); shape.edges.len()];
    for (t, &[a, b, c]) in shape.triangles.iter().enumerate() {
        for edge in [[a, b], [a, c], [b, c]] {
            if let Ok(e) = shape.edges.binary_search(&edge) {
                at_edge[e].push(t as u32);
            }
        }
    }
    at_edge
}

/// How many edges of seams each ball has.
fn seam_ends(shape: &PowerShape, is_seam: &dyn Fn(usize) -> bool) -> Vec<usize> {
    let mut ends = vec![0; shape.balls.len()];
    for (e, edge) in shape.edges.iter().enumerate() {
        for &v in edge {
            ends[v as usize] += usize::from(is_seam(e));
        }
    }
    ends
}

/// Numbers the classes of items by a size, largest first; items without a
/// class get [`NO_PART`]. Returns the numbers and the sizes in order.
fn number(sets: &mut Sets, size: &[f64], there: &dyn Fn(usize) -> bool) -> (Vec<u32>, usize) {
    let mut total: Vec<f64> = vec![0.0; sets.len()];
    let mut roots: Vec<u32> = Vec::new();
    for i in 0..sets.len() {
        if there(i) {
            let root = sets.find(i as u32);
            if root as usize == i {
                roots.push(root);
            }
            total[root as usize] += size[i];
        }
    }
    roots.sort_by(|&a, &b| {
        total[b as usize]
            .total_cmp(&total[a as usize])
            .then(a.cmp(&b))
    });
    let mut of_root = vec![NO_PART; sets.len()];
    for (n, &root) in roots.iter().enumerate() {
        of_root[root as usize] = n as u32;
    }
    let numbers = (0..sets.len()).map(|i| match there(i) {
        true => of_root[sets.find(i as u32) as usize],
        false => NO_PART,
    });
    (numbers.collect(), roots.len())
}

fn sheets(shape: &PowerShape, at_edge: &[Vec<u32>], out: &mut Structure) {
    let mut sets = Sets::new(shape.triangles.len());
    for triangles in at_edge {
        if let &[a, b] = &triangles[..] {
            sets.join(a, b);
        }
    }
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| shape.balls[v as usize].centre);
        norm(cross(sub(b, a), sub(c, a))) / 2.0
    };
    let areas: Vec<f64> = shape.triangles.iter().map(area).collect();
    let (numbers, count) = number(&mut sets, &areas, &|_| true);
    let mut sheets = vec![
        Sheet {
            thickness: [f64::INFINITY, 0.0, 0.0],
            ..Sheet::default()
        };
        count
    ];
    for (t, corners) in shape.triangles.iter().enumerate() {
        let sheet = &mut sheets[numbers[t] as usize];
        sheet.triangles += 1;
        sheet.area += areas[t];
        let wide = corners.map(|v| 2.0 * shape.balls[v as usize].radius);
        for width in wide {
            sheet.thickness[0] = sheet.thickness[0].min(width);
            sheet.thickness[2] = sheet.thickness[2].max(width);
        }
        sheet.thickness[1] += areas[t] * (wide[0] + wide[1] + wide[2]) / 3.0;
    }
    for sheet in &mut sheets {
        sheet.thickness[1] = match sheet.area > 0.0 {
            true => sheet.thickness[1] / sheet.area,
            false => sheet.thickness[0],
        };
    }
    out.sheets = sheets;
    out.sheet_of = numbers;
}

struct Chains<'a> {
    shape: &'a PowerShape,
    at_edge: &'a [Vec<u32>],
    sheet_of: &'a [u32],
}

impl Chains<'_> {
    /// The chains of the edges that `there` says, joined at balls that
    /// `through` says.
    fn of(
        &self,
        there: &dyn Fn(usize) -> bool,
        through: &dyn Fn(u32) -> bool,
    ) -> (Vec<Curve>, Vec<u32>) {
        let edges = &self.shape.edges;
        let mut sets = Sets::new(edges.len());
        let mut met = vec![NO_PART; self.shape.balls.len()];
        for (e, edge) in edges.iter().enumerate().filter(|(e, _)| there(*e)) {
            for &v in edge.iter().filter(|&&v| through(v)) {
                match std::mem::replace(&mut met[v as usize], e as u32) {
                    NO_PART => {}
                    other => {
                        sets.join(other, e as u32);
                    }
                }
            }
        }
        let length = |&[a, b]: &[u32; 2]| {
            let at = |v: u32| self.shape.balls[v as usize].centre;
            dist_sq(at(a), at(b)).sqrt()
        };
        let lengths: Vec<f64> = edges.iter().map(length).collect();
        let (numbers, count) = number(&mut sets, &lengths, there);
        let mut curves = vec![Curve::default(); count];
        for (e, &n) in numbers.iter().enumerate().filter(|(_, &n)| n != NO_PART) {
            let curve = &mut curves[n as usize];
            curve.edges += 1;
            curve.length += lengths[e];
            let at = self.at_edge[e].iter();
            curve.sheets.extend(at.map(|&t| self.sheet_of[t as usize]));
        }
        for curve in &mut curves {
            curve.sheets.sort_unstable();
            curve.sheets.dedup();
        }
        (curves, numbers)
    }
}

fn junctions(shape: &PowerShape, ends: &[usize], out: &mut Structure) {
    let mut seams: Vec<(u32, u32)> = Vec::new();
    for (edge, &seam) in shape.edges.iter().zip(&out.seam_of) {
        if seam != NO_PART {
            seams.extend(edge.iter().map(|&v| (v, seam)));
        }
    }
    seams.sort_unstable();
    seams.dedup();
    out.junction_of = vec![NO_PART; shape.balls.len()];
    for group in seams.chunk_by(|a, b| a.0 == b.0) {
        let ball = group[0].0;
        if ends[ball as usize] > 2 {
            out.junction_of[ball as usize] = out.junctions.len() as u32;
            out.junctions.push(Junction {
                ball,
                seams: group.iter().map(|pair| pair.1).collect(),
            });
        }
    }
}
