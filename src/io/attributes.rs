//! What a mesh file can carry besides vertices and faces, and how to write it.

/// One number for each vertex or face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attribute<'a> {
    /// Its name in the file. Blanks become `_` in PLY.
    pub name: &'a str,
    /// The numbers.
    pub values: AttributeValues<'a>,
}

/// The numbers of an [`Attribute`], by the type they have in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AttributeValues<'a> {
    /// Flags and small classes: `uchar` in PLY.
    Byte(&'a [u8]),
    /// Numbers of components, of holes, ...: `int` in PLY.
    Int(&'a [i32]),
    /// Measures: `double` in PLY (`float` with
    /// [`WriteOptions::float32`]).
    Float(&'a [f64]),
}

impl AttributeValues<'_> {
    /// How many values there are.
    pub fn len(&self) -> usize {
        match self {
            AttributeValues::Byte(v) => v.len(),
            AttributeValues::Int(v) => v.len(),
            AttributeValues::Float(v) => v.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// What goes into a mesh file besides the mesh. Formats write what they can
/// hold (see [`crate::io::MeshFormat`]) and leave out the rest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshAttributes<'a> {
    /// Vertex normals.
    pub normals: Option<&'a [[f32; 3]]>,
    /// Vertex colours: red, green, blue, alpha.
    pub colours: Option<&'a [[u8; 4]]>,
    /// The sample each vertex lies at; [`crate::surface::NONE`] becomes -1.
    /// `int sample` in PLY.
    pub samples: Option<&'a [u32]>,
    /// Further numbers at vertices.
    pub vertices: Vec<Attribute<'a>>,
    /// Numbers at faces.
    pub faces: Vec<Attribute<'a>>,
}

/// How to write.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// Text where the format has both (PLY, STL); the default is binary.
    pub ascii: bool,
    /// Coordinates and measures as 32-bit floats in PLY; the default is
    /// 64 bits, so that nothing is rounded.
    pub float32: bool,
    /// Significant digits in text formats, 1 to 17; the default is as many as
    /// needed to read back the same number.
    pub digits: Option<u8>,
    /// Comment lines for formats that have them (PLY, OBJ, OFF, MA).
    pub comments: Vec<String>,
}
