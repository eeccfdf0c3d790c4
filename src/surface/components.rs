//! Parts of a solid, the cavities in them, and which of them to keep.
//!
//! A shell is a set of faces joined by edges. The crust bounds a solid and
//! looks outward, so a shell of positive volume is the outside of a **part**
//! and a shell of negative volume the wall of a **cavity**. A cavity belongs
//! to the smallest part around it and goes where that goes. What lies free
//! within a cavity is a part of its own: it goes when the cavity is filled.

use crate::geom::{Bounds, Sets};
use crate::mesh::{Anatomy, PolygonMesh};

use super::raw::{Crust, NONE};

/// Which parts to keep, by size.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Keep {
    /// All of them.
    #[default]
    All,
    /// So many of the largest.
    Largest(usize),
}

/// The volume below which parts are dropped and cavities filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MinVolume {
    /// In the cube of the input's unit.
    Absolute(f64),
    /// As a share of the solid's volume before anything is dropped, 0.01 for
    /// one in a hundred.
    Share(f64),
}

/// What to keep of a surface. The default keeps everything.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShellFilter {
    /// Which parts.
    pub keep: Keep,
    /// Parts smaller than this are dropped and cavities smaller than this
    /// filled. The size of a part is what its outer shell encloses.
    pub min_volume: Option<MinVolume>,
    /// Whether all cavities are filled.
    pub drop_cavities: bool,
}

/// The shells of a surface: parts by size, and cavities.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shells {
    /// The part of each face, 0 the largest; cavities have the number of the
    /// part they are in.
    pub part_of_face: Vec<u32>,
    /// What the outer shell of each part encloses, the largest first.
    pub part_volumes: Vec<f64>,
    /// The size of each cavity (positive), with its part.
    pub cavities: Vec<(f64, u32)>,
}

/// Some of the vertices and faces of a mesh, by the numbers they had there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// In the order of the new mesh.
    pub vertices: Vec<u32>,
    /// In the order of the new mesh.
    pub faces: Vec<u32>,
}

impl Selection {
    /// The values at the vertices selected.
    pub fn of_vertices<T: Copy>(&self, values: &[T]) -> Vec<T> {
        self.vertices.iter().map(|&v| values[v as usize]).collect()
    }

    /// The values at the faces selected.
    pub fn of_faces<T: Copy>(&self, values: &[T]) -> Vec<T> {
        self.faces.iter().map(|&f| values[f as usize]).collect()
    }
}

impl Anatomy {
    fn len(&self) -> usize {
        self.volumes.len()
    }

    fn is_cavity(&self, shell: usize) -> bool {
        self.volumes[shell] < 0.0
    }

    /// The shells around one, as far as that can be told.
    fn around(&self, shell: usize) -> impl Iterator<Item = usize> + '_ {
        let list = self.around[shell].as_deref().unwrap_or(&[]);
        list.iter().map(|&s| s as usize)
    }

    /// The part that a cavity is in.
    fn host(&self, cavity: usize) -> Option<usize> {
        let parts = self.around(cavity).filter(|&s| !self.is_cavity(s));
        parts.min_by(|&a, &b| self.volumes[a].total_cmp(&self.volumes[b]))
    }

    /// Whether a shell looks the wrong way for where it lies: no solid has it
    /// on its boundary. Rounding does that to shells next to nothing in size.
    fn is_inverted(&self, shell: usize) -> bool {
        let depth = self.around[shell].as_ref().map(Vec::len);
        depth.is_some_and(|depth| self.is_cavity(shell) != (depth % 2 == 1))
    }

    /// Parts from the largest to the smallest.
    fn by_size(&self) -> Vec<usize> {
        let mut parts: Vec<usize> = (0..self.len()).filter(|&s| !self.is_cavity(s)).collect();
        parts.sort_by(|&a, &b| self.volumes[b].total_cmp(&self.volumes[a]).then(a.cmp(&b)));
        parts
    }

    fn shells(&self) -> Shells {
        let parts = self.by_size();
        let mut number = vec![0; self.len()];
        for (n, &part) in parts.iter().enumerate() {
            number[part] = n as u32;
        }
        let cavities: Vec<usize> = (0..self.len()).filter(|&s| self.is_cavity(s)).collect();
        for &cavity in &cavities {
            number[cavity] = self.host(cavity).map_or(0, |part| number[part]);
        }
        let part = |&s: &u32| number.get(s as usize).copied().unwrap_or(0);
        Shells {
            part_of_face: self.shell_of_face.iter().map(part).collect(),
            part_volumes: parts.iter().map(|&s| self.volumes[s]).collect(),
            cavities: (cavities.iter())
                .map(|&s| (-self.volumes[s], number[s]))
                .collect(),
        }
    }

    /// Which shells stay.
    fn kept(&self, filter: &ShellFilter) -> Vec<bool> {
        let total: f64 = self.volumes.iter().sum();
        let least = match filter.min_volume {
            None => 0.0,
            Some(MinVolume::Absolute(v)) => v,
            Some(MinVolume::Share(s)) => s * total,
        };
        let mut kept: Vec<bool> = self.volumes.iter().map(|v| v.abs() >= least).collect();
        for cavity in (0..self.len()).filter(|&s| self.is_cavity(s)) {
            kept[cavity] &= !filter.drop_cavities;
            kept[cavity] &= self.host(cavity).is_none_or(|part| kept[part]);
        }
        // Before parts are counted: none within a cavity that is filled. A
        // cavity whose part goes is not filled, it becomes open space.
        let filled = |cavity: usize, kept: &[bool]| {
            self.is_cavity(cavity) && !kept[cavity] && self.host(cavity).is_none_or(|p| kept[p])
        };
        let sunk: Vec<bool> = (0..self.len())
            .map(|s| self.around(s).any(|a| filled(a, &kept)))
            .collect();
        for (kept, sunk) in kept.iter_mut().zip(sunk) {
            *kept &= !sunk;
        }
        if let Keep::Largest(most) = filter.keep {
            let staying = self.by_size().into_iter().filter(|&s| kept[s]);
            let extra: Vec<usize> = staying.skip(most).collect();
            for part in extra {
                kept[part] = false;
            }
            for cavity in (0..self.len()).filter(|&s| self.is_cavity(s)) {
                kept[cavity] &= self.host(cavity).is_none_or(|part| kept[part]);
            }
        }
        kept
    }

    /// The surface of the shells kept.
    fn select(&self, crust: &Crust, kept: &[bool]) -> (Crust, Selection) {
        let faces = (self.shell_of_face.iter().enumerate())
            .filter(|(_, &s)| kept.get(s as usize).copied().unwrap_or(false))
            .map(|(f, _)| f as u32);
        crust.select_faces(faces.collect())
    }
}

impl Shells {
    /// Parts and cavities of a closed surface.
    pub fn of(mesh: &PolygonMesh) -> Shells {
        Anatomy::of(mesh).shells()
    }
}

/// The surface without the shells that `filter` drops, and what was selected.
/// It has no vertices but those of its faces; it may have no face at all.
///
/// ```
/// use powercrust::surface::{filter_shells, Keep, ShellFilter};
/// # use powercrust::{Crust, PolygonMesh};
/// # let mut mesh = PolygonMesh::default();
/// # for size in [1.0, 2.0] {
/// #     let base = mesh.vertices.len() as u32;
/// #     mesh.vertices.extend([[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]]
/// #         .map(|p: [f64; 3]| p.map(|c| size * c + 10.0 * size)));
/// #     for f in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] { mesh.push_face(&f.map(|v| v + base)); }
/// # }
/// # let two = Crust { mesh, vertex_samples: vec![0; 8], face_balls: vec![[0, 1]; 8] };
/// // Two tetrahedra, the second one larger.
/// let filter = ShellFilter { keep: Keep::Largest(1), ..ShellFilter::default() };
/// let (one, selection) = filter_shells(&two, &filter);
/// assert_eq!(one.mesh.vertices.len(), 4);
/// assert_eq!(selection.faces, [4, 5, 6, 7]);
/// ```
pub fn filter_shells(crust: &Crust, filter: &ShellFilter) -> (Crust, Selection) {
    let anatomy = Anatomy::of(&crust.mesh);
    anatomy.select(crust, &anatomy.kept(filter))
}

/// Takes out shells that are inside out for where they lie, and says how many
/// there were.
pub(crate) fn drop_inverted(crust: &mut Crust) -> usize {
    drop_shells(crust, 0).inverted
}

/// Shells that were taken out because no solid has them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Strays {
    /// Those that were inside out for where they lay.
    pub inverted: usize,
    /// Those that passed through fewer samples than were asked for.
    pub specks: usize,
}

/// The fewest samples that bound a solid, or a cavity.
pub(crate) const FEWEST: u32 = 4;

/// The same amid noise: noise was measured by quadrics through so many, and fewer say nothing
/// about it.
pub(crate) const FEWEST_AMID_NOISE: u32 = 24;

/// Takes out shells that bound nothing: those inside out, and, beside others,
/// those through fewer than `fewest` samples. The latter are what is left of a ball or two
/// that were cut off from the part they belong to, at edges or amid noise.
pub(crate) fn drop_strays(crust: &mut Crust, fewest: u32) -> Strays {
    drop_shells(crust, fewest)
}

fn drop_shells(crust: &mut Crust, fewest: u32) -> Strays {
    if is_one_solid(&crust.mesh) {
        return Strays::default();
    }
    let anatomy = Anatomy::of(&crust.mesh);
    let mut kept: Vec<bool> = (0..anatomy.len())
        .map(|s| !anatomy.is_inverted(s))
        .collect();
    let inverted = kept.iter().filter(|&&k| !k).count();
    let mut strays = Strays {
        inverted,
        specks: 0,
    };
    if fewest > 0 && anatomy.len() > 1 {
        let through = samples_by_shell(crust, &anatomy);
        let sound = |s: usize| kept[s] && through[s] >= fewest && !anatomy.is_cavity(s);
        if (0..anatomy.len()).any(sound) {
            for (kept, _) in (kept.iter_mut().zip(&through)).filter(|(_, &n)| n < fewest) {
                strays.specks += usize::from(std::mem::take(kept));
            }
        }
    }
    if strays != Strays::default() {
        *crust = anatomy.select(crust, &kept).0;
    }
    strays
}

/// Whether a closed manifold is one shell that clearly looks outward: so much can be told without
/// taking the mesh apart.
fn is_one_solid(mesh: &PolygonMesh) -> bool {
    const CLEARLY: f64 = 1e-6;
    let Some(bounds) = Bounds::of(&mesh.vertices) else {
        return false;
    };
    let box_volume: f64 = (0..3).map(|k| bounds.max[k] - bounds.min[k]).product();
    if mesh.volume() <= CLEARLY * box_volume {
        return false;
    }
    // Vertices in one set are joined by edges.
    let mut sets = Sets::new(mesh.vertices.len());
    let mut count = mesh.vertices.len();
    for f in 0..mesh.face_count() {
        for pair in mesh.face(f).windows(2) {
            count -= usize::from(sets.join(pair[0], pair[1]));
        }
    }
    count == 1
}

/// How many samples each shell passes through.
fn samples_by_shell(crust: &Crust, anatomy: &Anatomy) -> Vec<u32> {
    let mut through = vec![0; anatomy.len()];
    let mut seen = vec![false; crust.mesh.vertices.len()];
    for (f, &shell) in anatomy.shell_of_face.iter().enumerate() {
        for &v in crust.mesh.face(f) {
            let new = !std::mem::replace(&mut seen[v as usize], true);
            let sample = crust.vertex_samples[v as usize] != NONE;
            if let Some(count) = through.get_mut(shell as usize) {
                *count += u32::from(new && sample);
            }
        }
    }
    through
}

impl Crust {
    /// The crust of some of the faces, with the vertices they use.
    pub fn select_faces(&self, faces: Vec<u32>) -> (Crust, Selection) {
        const UNUSED: u32 = u32::MAX;
        let mesh = &self.mesh;
        let mut number = vec![UNUSED; mesh.vertices.len()];
        for &f in &faces {
            for &v in mesh.face(f as usize) {
                number[v as usize] = 0;
            }
        }
        let vertices: Vec<u32> = (0..number.len() as u32)
            .filter(|&v| number[v as usize] != UNUSED)
            .collect();
        for (new, &old) in vertices.iter().enumerate() {
            number[old as usize] = new as u32;
        }
        let selection = Selection { vertices, faces };
        let mut chosen = PolygonMesh::with_vertices(selection.of_vertices(&mesh.vertices));
        let mut corners = Vec::new();
        for &f in &selection.faces {
            corners.clear();
            corners.extend(mesh.face(f as usize).iter().map(|&v| number[v as usize]));
            chosen.push_face(&corners);
        }
        let crust = Crust {
            mesh: chosen,
            vertex_samples: selection.of_vertices(&self.vertex_samples),
            face_balls: selection.of_faces(&self.face_balls),
        };
        (crust, selection)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes of the given half sizes about the origin, the ones marked turned
    /// inside out.
    fn boxes(list: &[(f64, bool)]) -> Crust {
        let mut mesh = PolygonMesh::with_vertices(vec![]);
        for &(half, inward) in list {
            let base = mesh.vertices.len() as u32;
            for c in 0..8u32 {
                let sign = |k: u32| if c >> k & 1 == 1 { half } else { -half };
                mesh.vertices.push([sign(0), sign(1), sign(2)]);
            }
            let sides = [
                [0, 2, 3, 1],
                [4, 5, 7, 6],
                [0, 1, 5, 4],
                [2, 6, 7, 3],
                [0, 4, 6, 2],
                [1, 3, 7, 5],
            ];
            for mut side in sides {
                if inward {
                    side.reverse();
                }
                mesh.push_face(&side.map(|v| v + base));
            }
        }
        Crust {
            vertex_samples: (0..mesh.vertices.len() as u32).collect(),
            face_balls: vec![[0, 1]; mesh.face_count()],
            mesh,
        }
    }

    fn volume(list: &[(f64, bool)], filter: ShellFilter) -> f64 {
        let (crust, selection) = filter_shells(&boxes(list), &filter);
        assert_eq!(crust.vertex_samples, selection.vertices);
        assert_eq!(crust.face_balls.len(), crust.mesh.face_count());
        crust.mesh.volume().round()
    }

    /// A solid, a cavity, a solid in it, a cavity in that.
    const ONION: [(f64, bool); 4] = [(4.0, false), (3.0, true), (2.0, false), (1.0, true)];

    #[test]
    fn cavities_belong_to_the_part_around() {
        let shells = Shells::of(&boxes(&ONION).mesh);
        let rounded = |v: &f64| v.round();
        let volumes: Vec<f64> = shells.part_volumes.iter().map(rounded).collect();
        assert_eq!(volumes, [512.0, 64.0]);
        let cavities: Vec<(f64, u32)> =
            shells.cavities.iter().map(|c| (c.0.round(), c.1)).collect();
        assert_eq!(cavities, [(216.0, 0), (8.0, 1)]);
        assert_eq!(shells.part_of_face[..12], [0; 12]);
        assert_eq!(shells.part_of_face[12..], [1; 12]);
    }

    #[test]
    fn shells_inside_out_are_taken_out() {
        let mut sound = boxes(&ONION);
        assert_eq!(drop_strays(&mut sound, FEWEST), Strays::default());
        assert_eq!(sound.mesh.face_count(), 24);
        let mut crust = boxes(&[(4.0, false), (3.0, false), (0.5, true)]);
        // The box of 3 and the one in it both contradict the one around.
        let strays = drop_strays(&mut crust, FEWEST);
        assert_eq!((strays.inverted, strays.specks), (2, 0));
        assert_eq!(crust.mesh.vertices.len(), 8);
        assert_eq!(crust.mesh.volume(), 512.0);
    }

    #[test]
    fn shells_through_fewer_than_four_samples_are_taken_out() {
        let mut crust = boxes(&[(4.0, false), (3.0, true)]);
        for v in &mut crust.vertex_samples[8..13] {
            *v = NONE;
        }
        let strays = drop_strays(&mut crust, FEWEST);
        assert_eq!((strays.inverted, strays.specks), (0, 1));
        assert_eq!(crust.mesh.volume(), 512.0);
        // Alone it stays.
        crust.vertex_samples.fill(NONE);
        assert_eq!(drop_strays(&mut crust, FEWEST), Strays::default());
    }

    #[test]
    fn filters_keep_a_solid() {
        let plain = ShellFilter::default();
        assert_eq!(volume(&ONION, plain), 512.0 - 216.0 + 64.0 - 8.0);
        let keep = Keep::Largest(1);
        assert_eq!(volume(&ONION, ShellFilter { keep, ..plain }), 512.0 - 216.0);
        // What lies in a filled cavity goes with it.
        let drop_cavities = true;
        let filled = ShellFilter {
            drop_cavities,
            ..plain
        };
        assert_eq!(volume(&ONION, filled), 512.0);
        let above = |v: f64| ShellFilter {
            min_volume: Some(MinVolume::Absolute(v)),
            ..plain
        };
        assert_eq!(volume(&ONION, above(10.0)), 512.0 - 216.0 + 64.0);
        assert_eq!(volume(&ONION, above(100.0)), 512.0 - 216.0);
        assert_eq!(volume(&ONION, above(300.0)), 512.0);
        assert_eq!(volume(&ONION, above(1000.0)), 0.0);
        let share = ShellFilter {
            min_volume: Some(MinVolume::Share(0.1)),
            ..plain
        };
        assert_eq!(volume(&ONION, share), 512.0 - 216.0 + 64.0);
    }
}
