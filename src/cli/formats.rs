//! File formats by the names that options and extensions give them.

use std::ffi::OsStr;
use std::path::Path;

use powercrust::io::{AxisFormat, CloudFormat, MeshFormat};

use super::fail::Failure;

pub fn extension(path: &Path) -> Option<&str> {
    path.extension().and_then(OsStr::to_str)
}

/// `.ply .obj ...`
pub fn dotted(extensions: impl Iterator<Item = &'static str>) -> String {
    extensions
        .map(|e| format!(".{e}"))
        .collect::<Vec<_>>()
        .join(" ")
}

/// The format of the points by option or extension; `None` where the bytes
/// must tell.
pub fn input_format(path: &Path, said: Option<&str>) -> Result<Option<CloudFormat>, Failure> {
    if let Some(said) = said {
        return match CloudFormat::from_extension(said) {
            Some(format) => Ok(Some(format)),
            None => Err(
                Failure::usage(format!("--input-format {said}: unknown format"))
                    .hint(format!("known: {}", dotted(CloudFormat::extensions()))),
            ),
        };
    }
    let Some(extension) = extension(path) else {
        return Ok(None);
    };
    let known_elsewhere = ["laz", "e57", "vtk", "vtp", "vtu", "glb", "gltf", "3mf"];
    if known_elsewhere
        .iter()
        .any(|e| extension.eq_ignore_ascii_case(e))
    {
        return Err(
            Failure::file(path, format!(".{extension} files cannot be read")).hint(format!(
                "convert it to one of {} first",
                dotted(CloudFormat::extensions())
            )),
        );
    }
    Ok(CloudFormat::from_extension(extension))
}

/// A mesh format by the name a flag gives it.
pub fn named_mesh_format(flag: &str, said: &str) -> Result<MeshFormat, Failure> {
    MeshFormat::from_extension(said).ok_or_else(|| {
        Failure::usage(format!("{flag} {said}: unknown format"))
            .hint(format!("known: {}", dotted(MeshFormat::extensions())))
    })
}

/// The format to write the mesh in; PLY for standard output.
pub fn mesh_format(path: &Path, said: Option<&str>) -> Result<MeshFormat, Failure> {
    if let Some(said) = said {
        return named_mesh_format("--output-format", said);
    }
    if path.as_os_str() == "-" {
        return Ok(MeshFormat::Ply);
    }
    if let Some(format) = extension(path).and_then(MeshFormat::from_extension) {
        return Ok(format);
    }
    Err(unknown_extension(path, "mesh").hint(
        if extension(path)
            .and_then(AxisFormat::from_extension)
            .is_some()
        {
            format!("for a medial axis: --mat {}", path.display())
        } else {
            let known = dotted(MeshFormat::extensions());
            format!("known: {known}; or say --output-format ply")
        },
    ))
}

pub fn axis_format(path: &Path, flag: &str) -> Result<AxisFormat, Failure> {
    extension(path)
        .and_then(AxisFormat::from_extension)
        .ok_or_else(|| {
            let known = dotted(AxisFormat::extensions());
            unknown_extension(path, "medial axis").hint(format!("{flag} writes {known}"))
        })
}

pub fn poles_format(path: &Path) -> Result<(), Failure> {
    only_ply(path, "poles", "--poles writes .ply")
}

pub fn outliers_format(path: &Path) -> Result<(), Failure> {
    only_ply(path, "outliers", "--report-outliers writes .ply")
}

pub fn dropped_format(path: &Path) -> Result<(), Failure> {
    only_ply(path, "poles", "--report-poles writes .ply")
}

fn only_ply(path: &Path, what: &str, hint: &str) -> Result<(), Failure> {
    match extension(path) {
        Some(extension) if extension.eq_ignore_ascii_case("ply") => Ok(()),
        _ => Err(unknown_extension(path, what).hint(hint)),
    }
}

fn unknown_extension(path: &Path, what: &str) -> Failure {
    let path_name = path.display();
    Failure::usage(match extension(path) {
        Some(extension) => format!("{path_name}: .{extension} is no {what} format"),
        None => format!("{path_name}: the name has no extension to tell the {what} format"),
    })
}
