use super::raw::{Crust, RawCrust};
pub fn clean(raw: RawCrust) -> Crust {
    let mut mesh = crate::PolygonMesh::with_vertices(raw.positions);
    mesh.starts = raw.starts;
    mesh.corners = raw.corners;
    Crust {
        mesh,
        vertex_samples: raw.samples,
        face_balls: raw.balls,
    }
}
pub fn triangulate(c: &Crust) -> Crust {
    c.clone()
}
