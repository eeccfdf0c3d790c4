//! What [`super::check()`] returns.

use crate::geom::Bounds;
use serde::Serialize;

/// Something wrong with a mesh, by the numbers of its vertices and faces.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Finding {
    /// The face has a corner that is no vertex, or its run of corners is not
    /// there. It is left out of all other checks.
    IndexOutOfRange { face: u32 },
    /// The face has fewer than three corners; left out of all other checks.
    FaceTooSmall { face: u32 },
    /// A coordinate is infinite or not a number. Faces at the vertex are left
    /// out of the tests for area and crossing.
    NotFinite { vertex: u32 },
    /// The face visits the vertex more than once.
    RepeatedVertex { face: u32, vertex: u32 },
    /// No face uses the vertex.
    UnusedVertex { vertex: u32 },
    /// The edge has one face.
    OpenEdge { edge: [u32; 2], face: u32 },
    /// The two faces of the edge run along it in the same direction.
    MisorientedEdge { edge: [u32; 2], faces: [u32; 2] },
    /// The edge has more than two faces.
    NonManifoldEdge { edge: [u32; 2], faces: Vec<u32> },
    /// The faces at the vertex form several fans that share no edge there.
    PinchedVertex { vertex: u32, fans: u32 },
    /// The face has exactly no area: all its corners lie on one line.
    ZeroArea { face: u32 },
    /// Face `b` has the same vertices as face `a`, which comes first.
    DuplicateFace { a: u32, b: u32 },
    /// The interiors of the faces meet: they pierce each other or overlap.
    /// For `a == b` the triangles of one polygon do.
    Crossing { a: u32, b: u32 },
    /// The faces touch at other places than common vertices and edges: a
    /// corner in a face or an edge, edges that cross or overlap in part.
    Touching { a: u32, b: u32 },
    /// The faces have corners at equal positions that are different vertices,
    /// and meet nowhere else but there and in what they share. A solid pinched
    /// along vertices or edges looks like this.
    Coincident { a: u32, b: u32 },
    /// The closed shell faces the wrong way: a shell that encloses solid must
    /// have positive volume, the wall of a cavity negative.
    InsideOut { shell: u32 },
}

/// How many findings there are of each kind, whether listed or not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// [`Finding::IndexOutOfRange`]
    pub index_out_of_range: u64,
    /// [`Finding::FaceTooSmall`]
    pub face_too_small: u64,
    /// [`Finding::NotFinite`]
    pub not_finite: u64,
    /// [`Finding::RepeatedVertex`]
    pub repeated_vertex: u64,
    /// [`Finding::UnusedVertex`]
    pub unused_vertex: u64,
    /// [`Finding::OpenEdge`]
    pub open_edge: u64,
    /// [`Finding::MisorientedEdge`]
    pub misoriented_edge: u64,
    /// [`Finding::NonManifoldEdge`]
    pub non_manifold_edge: u64,
    /// [`Finding::PinchedVertex`]
    pub pinched_vertex: u64,
    /// [`Finding::ZeroArea`]
    pub zero_area: u64,
    /// [`Finding::DuplicateFace`]
    pub duplicate_face: u64,
    /// [`Finding::Crossing`], counted by pairs of triangles.
    pub crossing: u64,
    /// Faces that cross some face.
    pub crossing_faces: u64,
    /// [`Finding::Touching`], counted by pairs of triangles.
    pub touching: u64,
    /// Faces that touch some face.
    pub touching_faces: u64,
    /// [`Finding::Coincident`], counted by pairs of triangles.
    pub coincident: u64,
    /// [`Finding::InsideOut`]
    pub inside_out: u64,
}

/// Faces joined by shared edges.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shell {
    /// Its face of the smallest number.
    pub first_face: u32,
    /// Number of faces.
    pub faces: u64,
    /// Whether every edge has two faces of opposite direction.
    pub closed: bool,
    /// Border loops, which lie along open edges.
    pub loops: u64,
    /// Vertices less edges plus faces; a pinched vertex counts once for each
    /// fan of this shell.
    pub euler: i64,
    /// Handles; `None` where faces disagree or more than two meet at an edge.
    pub genus: Option<u64>,
    /// Signed volume, positive for shells that look outward, in cubed units;
    /// meaningless for open shells.
    pub volume: f64,
    /// Surface area, in squared units.
    pub area: f64,
}

/// Everything [`super::check()`] found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Vertices of the mesh, used or not.
    pub vertices: u64,
    /// Faces of the mesh.
    pub faces: u64,
    /// Triangles the faces fall into.
    pub triangles: u64,
    /// Edges: pairs of vertices next to each other in some face.
    pub edges: u64,
    /// Findings of each kind.
    pub counts: Counts,
    /// The first findings of each kind, in the order of [`Finding`] and then
    /// by number.
    pub findings: Vec<Finding>,
    /// Vertices at the position of an earlier vertex. No fault by itself.
    pub duplicate_positions: u64,
    /// Whether the tests for crossing faces were made.
    pub intersections_tested: bool,
    /// Components of faces that share vertices.
    pub components: u64,
    /// Components of faces that share edges, by first face.
    pub shells: Vec<Shell>,
    /// Used vertices less edges plus faces.
    pub euler: i64,
    /// Handles of all shells; `None` if a shell has none to tell.
    pub genus: Option<u64>,
    /// Sum of the shells' signed volumes, in cubed units.
    pub volume: f64,
    /// Sum of the shells' areas, in squared units.
    pub area: f64,
    /// Closed shells of negative volume.
    pub cavities: u64,
    /// The box of the finite vertices that faces use.
    #[serde(serialize_with = "corners")]
    pub bounds: Option<Bounds>,
    /// Smallest angle of a triangle, in degrees; `None` for no triangles.
    pub smallest_angle: Option<f64>,
    /// Triangles by longest side over height (1.15 for equilateral ones): up
    /// to 2, 4, 10, 100, 1000, 10 000, and the rest.
    pub aspects: [u64; 7],
}

fn corners<S: serde::Serializer>(bounds: &Option<Bounds>, s: S) -> Result<S::Ok, S::Error> {
    bounds.map(|b| [b.min, b.max]).serialize(s)
}

impl Report {
    /// Whether the mesh is a closed, oriented surface: it has faces, all of
    /// them can be walked, and every edge has two faces of opposite direction.
    pub fn is_closed(&self) -> bool {
        let c = &self.counts;
        self.faces > 0
            && c.index_out_of_range == 0
            && c.face_too_small == 0
            && c.open_edge == 0
            && c.misoriented_edge == 0
            && c.non_manifold_edge == 0
    }

    /// Whether the mesh is the boundary of a solid in every clause that can be
    /// judged: closed ([`Self::is_closed`]); faces without repeated vertices,
    /// of positive area, none twice; vertices finite, used and of one fan
    /// each; no faces cross or touch, which must have been tested; the total
    /// volume is positive and no shell is inside out. Vertices at equal
    /// positions are allowed, so a pinched solid passes.
    pub fn is_watertight(&self) -> bool {
        let c = &self.counts;
        self.is_closed()
            && c.not_finite == 0
            && c.repeated_vertex == 0
            && c.unused_vertex == 0
            && c.pinched_vertex == 0
            && c.zero_area == 0
            && c.duplicate_face == 0
            && self.intersections_tested
            && c.crossing == 0
            && c.touching == 0
            && c.inside_out == 0
            && self.volume > 0.0
    }

    /// Whether the mesh is a surface with borders, or closed, in every clause
    /// that can be judged: as [`Self::is_watertight`], but edges with one face
    /// are allowed, and where there are some, volumes tell nothing and are not
    /// looked at.
    pub fn is_bordered(&self) -> bool {
        let c = &self.counts;
        let closed = Report {
            counts: Counts {
                open_edge: 0,
                inside_out: if c.open_edge > 0 { 0 } else { c.inside_out },
                ..*c
            },
            volume: if c.open_edge > 0 { 1.0 } else { self.volume },
            findings: Vec::new(),
            shells: Vec::new(),
            ..self.clone()
        };
        closed.is_watertight()
    }

    /// Whether the mesh is watertight and no two of its faces come together
    /// but in vertices and edges they share.
    pub fn is_embedded(&self) -> bool {
        self.is_watertight() && self.counts.coincident == 0
    }
}
