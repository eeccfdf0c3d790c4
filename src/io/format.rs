//! The file formats by name: from an extension, or from the bytes themselves.

use super::scan;

/// A format points can be read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum CloudFormat {
    /// Stanford PLY, text or binary.
    Ply,
    /// Wavefront OBJ: its `v` lines.
    Obj,
    /// Geomview OFF: its vertices.
    Off,
    /// Lines of numbers: XYZ, TXT, CSV, PTS, ASC, PWN, XYZN.
    Text,
    /// STL, text or binary: the distinct corners of its triangles.
    Stl,
    /// A NumPy array of shape (n, 3) or wider.
    Npy,
    /// Point Cloud Library: text, binary, or binary compressed.
    Pcd,
    /// Laser scans, uncompressed.
    Las,
}

const CLOUD: &[(&str, CloudFormat)] = &[
    ("ply", CloudFormat::Ply),
    ("obj", CloudFormat::Obj),
    ("off", CloudFormat::Off),
    ("coff", CloudFormat::Off),
    ("noff", CloudFormat::Off),
    ("xyz", CloudFormat::Text),
    ("xyzn", CloudFormat::Text),
    ("txt", CloudFormat::Text),
    ("csv", CloudFormat::Text),
    ("tsv", CloudFormat::Text),
    ("pts", CloudFormat::Text),
    ("asc", CloudFormat::Text),
    ("pwn", CloudFormat::Text),
    ("stl", CloudFormat::Stl),
    ("npy", CloudFormat::Npy),
    ("pcd", CloudFormat::Pcd),
    ("las", CloudFormat::Las),
];

fn by_extension<F: Copy>(table: &[(&str, F)], extension: &str) -> Option<F> {
    let extension = extension.trim_start_matches('.');
    table
        .iter()
        .find(|(e, _)| e.eq_ignore_ascii_case(extension))
        .map(|&(_, f)| f)
}

impl CloudFormat {
    /// The format of files with this extension (`"ply"` or `".PLY"`); `None`
    /// for extensions no reader claims.
    pub fn from_extension(extension: &str) -> Option<CloudFormat> {
        by_extension(CLOUD, extension)
    }

    /// Every extension that [`CloudFormat::from_extension`] knows, lower case,
    /// without the dot.
    pub fn extensions() -> impl Iterator<Item = &'static str> {
        CLOUD.iter().map(|&(e, _)| e)
    }

    /// The format a file without a name most likely has, judged by its first
    /// kilobytes. Never fails: what nothing else claims is
    /// [`CloudFormat::Text`], whose reader then says what it cannot read.
    pub fn sniff(bytes: &[u8]) -> CloudFormat {
        let bytes = scan::without_bom(bytes);
        let head = &bytes[..bytes.len().min(8192)];
        let word = scan::first_word(head);
        if word.eq_ignore_ascii_case(b"ply") {
            return CloudFormat::Ply;
        }
        if bytes.starts_with(b"\x93NUMPY") {
            return CloudFormat::Npy;
        }
        if super::las::looks_like(bytes) {
            return CloudFormat::Las;
        }
        if super::pcd::looks_like(head) {
            return CloudFormat::Pcd;
        }
        if super::stl::looks_binary(bytes) || word.eq_ignore_ascii_case(b"solid") {
            return CloudFormat::Stl;
        }
        let lines = || head.split(|&b| b == b'\n' || b == b'\r');
        let data = |l: &&[u8]| !matches!(l.trim_ascii_start().first(), None | Some(b'#'));
        if let Some(first) = lines().find(data) {
            if super::off::keyword(scan::first_word(first)).is_some() {
                return CloudFormat::Off;
            }
        }
        let vertex = |l: &[u8]| {
            let word = scan::first_word(l);
            word == b"v" || word == b"vn"
        };
        if lines().any(vertex) {
            return CloudFormat::Obj;
        }
        CloudFormat::Text
    }

    /// A name for people, in capitals as usual: `PLY`, `text`, ...
    pub fn name(self) -> &'static str {
        match self {
            CloudFormat::Ply => "PLY",
            CloudFormat::Obj => "OBJ",
            CloudFormat::Off => "OFF",
            CloudFormat::Text => "text",
            CloudFormat::Stl => "STL",
            CloudFormat::Npy => "NPY",
            CloudFormat::Pcd => "PCD",
            CloudFormat::Las => "LAS",
        }
    }
}

/// A format meshes are written to and read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum MeshFormat {
    /// Stanford PLY: keeps every attribute.
    Ply,
    /// Wavefront OBJ: keeps normals and colours.
    Obj,
    /// Geomview OFF: keeps colours.
    Off,
    /// STL: triangles in 32-bit floats, no shared vertices, no attributes.
    Stl,
    /// One JSON object: `vertices`, `faces` and the attributes by name.
    Json,
    /// glTF 2.0 in one binary file: triangles in 32-bit floats about their
    /// middle, normals and colours. Written, not read.
    Glb,
}

const MESH: &[(&str, MeshFormat)] = &[
    ("ply", MeshFormat::Ply),
    ("obj", MeshFormat::Obj),
    ("off", MeshFormat::Off),
    ("stl", MeshFormat::Stl),
    ("json", MeshFormat::Json),
    ("glb", MeshFormat::Glb),
];

impl MeshFormat {
    /// The format of files with this extension (`"ply"` or `".PLY"`).
    pub fn from_extension(extension: &str) -> Option<MeshFormat> {
        by_extension(MESH, extension)
    }

    /// Every extension that [`MeshFormat::from_extension`] knows.
    pub fn extensions() -> impl Iterator<Item = &'static str> {
        MESH.iter().map(|&(e, _)| e)
    }

    /// The mesh format a file without a name most likely has; `None` when it
    /// looks like bare points.
    pub fn sniff(bytes: &[u8]) -> Option<MeshFormat> {
        if bytes.starts_with(b"glTF") {
            return Some(MeshFormat::Glb);
        }
        if scan::without_bom(bytes)
            .trim_ascii_start()
            .starts_with(b"{")
        {
            return Some(MeshFormat::Json);
        }
        match CloudFormat::sniff(bytes) {
            CloudFormat::Ply => Some(MeshFormat::Ply),
            CloudFormat::Obj => Some(MeshFormat::Obj),
            CloudFormat::Off => Some(MeshFormat::Off),
            CloudFormat::Stl => Some(MeshFormat::Stl),
            CloudFormat::Text | CloudFormat::Npy | CloudFormat::Pcd | CloudFormat::Las => None,
        }
    }

    /// A name for people, in capitals.
    pub fn name(self) -> &'static str {
        match self {
            MeshFormat::Ply => "PLY",
            MeshFormat::Obj => "OBJ",
            MeshFormat::Off => "OFF",
            MeshFormat::Stl => "STL",
            MeshFormat::Json => "JSON",
            MeshFormat::Glb => "GLB",
        }
    }
}

/// A format medial axes are written to and read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum AxisFormat {
    /// The text format of the medial mesh papers: `v x y z r`, `e i j`,
    /// `f i j k`.
    Ma,
    /// PLY with a radius at each vertex, edges, faces and tetrahedra.
    Ply,
    /// OBJ for looking at: `v`, `l`, `f`; no radii, so it cannot be read back.
    Obj,
    /// One JSON object: `balls`, `ids`, `edges`, `triangles`, `tetrahedra`.
    Json,
}

const AXIS: &[(&str, AxisFormat)] = &[
    ("ma", AxisFormat::Ma),
    ("ply", AxisFormat::Ply),
    ("obj", AxisFormat::Obj),
    ("json", AxisFormat::Json),
];

impl AxisFormat {
    /// The format of files with this extension (`"ma"` or `".MA"`).
    pub fn from_extension(extension: &str) -> Option<AxisFormat> {
        by_extension(AXIS, extension)
    }

    /// Every extension that [`AxisFormat::from_extension`] knows.
    pub fn extensions() -> impl Iterator<Item = &'static str> {
        AXIS.iter().map(|&(e, _)| e)
    }

    /// The axis format a file without a name has; `None` where nothing in it
    /// says that it holds balls.
    pub fn sniff(bytes: &[u8]) -> Option<AxisFormat> {
        let bytes = scan::without_bom(bytes).trim_ascii_start();
        if bytes.starts_with(b"{") {
            return Some(AxisFormat::Json);
        }
        let head = &bytes[..bytes.len().min(1 << 14)];
        let lines = || head.split(|&b| b == b'\n').map(<[u8]>::trim_ascii);
        let words = |line: &'_ [u8]| -> Vec<Vec<u8>> {
            let blank = |b: &u8| b.is_ascii_whitespace();
            let words = line.split(blank).filter(|w| !w.is_empty());
            words.map(<[u8]>::to_vec).collect()
        };
        if head.starts_with(b"ply") {
            let radius = lines()
                .take_while(|line| *line != b"end_header")
                .any(|line| line.starts_with(b"property") && line.ends_with(b" radius"));
            return radius.then_some(AxisFormat::Ply);
        }
        let mut told = lines().filter(|line| !line.is_empty() && line[0] != b'#');
        let counts = words(told.next()?);
        let first = words(told.next()?);
        let is_count = |w: &Vec<u8>| w.iter().all(u8::is_ascii_digit);
        let ma = counts.len() == 3 && counts.iter().all(is_count);
        (ma && first.first().is_some_and(|w| w == b"v")).then_some(AxisFormat::Ma)
    }

    /// A name for people, in capitals.
    pub fn name(self) -> &'static str {
        match self {
            AxisFormat::Ma => "MA",
            AxisFormat::Ply => "PLY",
            AxisFormat::Obj => "OBJ",
            AxisFormat::Json => "JSON",
        }
    }
}
