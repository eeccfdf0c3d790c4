//! `powercrust check`: is a mesh fit for use?

use std::path::Path;
use std::process::ExitCode;

use powercrust::io::{read_mesh, MeshFormat};
use powercrust::mesh::{check as judge, CheckOptions, Finding, Report};
use powercrust::Context;
use serde_json::json;

use super::args::Check;
use super::fail::{name, Code, Failure};
use super::formats::{dotted, extension, named_mesh_format};
use super::output::Target;
use super::plan::check_input;
use super::run::{misread, read_bytes};
use super::show::{counted, Bar, Talk};
use super::stop;

pub fn check(args: &Check) -> Result<ExitCode, Failure> {
    let said = args.input_format.as_deref();
    let said = said
        .map(|said| named_mesh_format("--input-format", said))
        .transpose()?;
    check_input(&args.mesh)?;
    let bytes = read_bytes(&args.mesh)?;
    let by_name = || extension(&args.mesh).and_then(MeshFormat::from_extension);
    let format = said.or_else(by_name).or_else(|| MeshFormat::sniff(&bytes));
    let Some(format) = format else {
        return Err(
            Failure::file(&args.mesh, "not a mesh format that can be read")
                .hint(format!("known: {}", dotted(MeshFormat::extensions()))),
        );
    };
    let mesh = read_mesh(&bytes, format)
        .map_err(|error| misread(&args.mesh, &error, MeshFormat::extensions()))?;
    drop(bytes);
    stop::orderly();
    let bar = Bar::new(if args.quiet { Talk::Quiet } else { Talk::Plain });
    let context = Context {
        threads: args.threads,
        progress: &bar,
    };
    let report = judge(&mesh, &CheckOptions::default(), &context);
    bar.clear();
    let report = report.map_err(|_| Failure::interrupted())?;
    let sound = match args.border {
        true => report.is_bordered(),
        false => report.is_watertight(),
    };
    let text = if args.json {
        let mut object = json!(report);
        object["ok"] = json!(sound);
        object["file"] = json!(name(&args.mesh));
        object["format"] = json!(format);
        format!("{object:#}\n")
    } else {
        describe(&args.mesh, &report, sound, args.border)
    };
    if !args.quiet {
        Target::Stdout.stage(|out| out.write_all(text.as_bytes()))?;
    }
    Ok(if sound {
        ExitCode::SUCCESS
    } else {
        Code::Unfit.into()
    })
}

fn describe(path: &Path, report: &Report, sound: bool, border: bool) -> String {
    let mut lines = Vec::new();
    lines.push(format!(
        "{}: {}",
        name(path),
        match (sound, report.is_closed()) {
            (true, true) => "sound: closed, manifold, oriented, no crossing faces",
            (true, false) => "sound with a border: manifold, oriented, no crossing faces",
            (false, _) => "not sound",
        }
    ));
    let number = |count: u64, one, many| counted(count as usize, one, many);
    let mut size = vec![
        number(report.vertices, "vertex", "vertices"),
        number(report.faces, "face", "faces"),
        number(report.components, "component", "components"),
    ];
    if let Some(genus) = report.genus {
        size.push(format!("genus {genus}"));
    }
    if report.cavities > 0 && report.counts.open_edge == 0 {
        size.push(number(report.cavities, "cavity", "cavities"));
    }
    let loops: u64 = report.shells.iter().map(|s| s.loops).sum();
    if loops > 0 {
        size.push(number(loops, "border loop", "border loops"));
    }
    lines.push(size.join(", "));
    lines.push(match report.counts.open_edge == 0 {
        true => format!("volume {}, area {}", report.volume, report.area),
        false => format!("area {}", report.area),
    });
    lines.extend(faults_in_words(report, border));
    if report.counts.open_edge > 0 && !border && report.is_bordered() {
        lines.push(
            "else sound: manifold, oriented, no crossing faces; --border allows open edges"
                .to_owned(),
        );
    }
    let mut text = lines.join("\n  ");
    text.push('\n');
    text
}

/// What is wrong with a mesh, a line for each kind of fault. With `border`
/// open edges are no fault, and what volumes tell of open shells neither.
pub fn faults_in_words(report: &Report, border: bool) -> Vec<String> {
    let mut lines = Vec::new();
    if report.faces == 0 {
        lines.push("no faces".to_owned());
    }
    let closed = report.counts.open_edge + report.counts.misoriented_edge == 0;
    if report.faces > 0 && closed && report.volume <= 0.0 {
        lines.push("the volume is not positive: is the mesh inside out?".to_owned());
    }
    let allowed = |f: &Finding| matches!(f, Finding::OpenEdge { .. } | Finding::InsideOut { .. });
    let border = border && report.counts.open_edge > 0;
    for (count, what, is_of_kind) in faults(report) {
        let first = report.findings.iter().find(|f| is_of_kind(f));
        if border && first.is_some_and(allowed) {
            continue;
        }
        if count > 0 {
            let place = first.map(|f| format!(", first: {}", place(f)));
            lines.push(format!(
                "{}{}",
                counted(count as usize, what.0, what.1),
                place.unwrap_or_default()
            ));
        }
    }
    lines
}

type Fault = (u64, (&'static str, &'static str), fn(&Finding) -> bool);

/// Each kind of fault: how many, its names, and how to find the first.
fn faults(report: &Report) -> [Fault; 14] {
    use Finding as F;
    let c = &report.counts;
    [
        (
            c.index_out_of_range,
            (
                "face with a corner that is no vertex",
                "faces with corners that are no vertices",
            ),
            |f| matches!(f, F::IndexOutOfRange { .. }),
        ),
        (
            c.face_too_small,
            (
                "face of fewer than 3 corners",
                "faces of fewer than 3 corners",
            ),
            |f| matches!(f, F::FaceTooSmall { .. }),
        ),
        (
            c.not_finite,
            ("vertex that is not finite", "vertices that are not finite"),
            |f| matches!(f, F::NotFinite { .. }),
        ),
        (
            c.repeated_vertex,
            (
                "vertex repeated within a face",
                "vertices repeated within a face",
            ),
            |f| matches!(f, F::RepeatedVertex { .. }),
        ),
        (c.unused_vertex, ("unused vertex", "unused vertices"), |f| {
            matches!(f, F::UnusedVertex { .. })
        }),
        (c.open_edge, ("open edge", "open edges"), |f| {
            matches!(f, F::OpenEdge { .. })
        }),
        (
            c.misoriented_edge,
            (
                "edge with faces of different orientation",
                "edges with faces of different orientation",
            ),
            |f| matches!(f, F::MisorientedEdge { .. }),
        ),
        (
            c.non_manifold_edge,
            (
                "edge of more than two faces",
                "edges of more than two faces",
            ),
            |f| matches!(f, F::NonManifoldEdge { .. }),
        ),
        (
            c.pinched_vertex,
            ("pinched vertex", "pinched vertices"),
            |f| matches!(f, F::PinchedVertex { .. }),
        ),
        (
            c.zero_area,
            ("face without area", "faces without area"),
            |f| matches!(f, F::ZeroArea { .. }),
        ),
        (
            c.duplicate_face,
            ("face that is there twice", "faces that are there twice"),
            |f| matches!(f, F::DuplicateFace { .. }),
        ),
        (
            c.crossing,
            ("pair of crossing faces", "pairs of crossing faces"),
            |f| matches!(f, F::Crossing { .. }),
        ),
        (
            c.touching,
            ("pair of touching faces", "pairs of touching faces"),
            |f| matches!(f, F::Touching { .. }),
        ),
        (
            c.inside_out,
            ("shell that is inside out", "shells that are inside out"),
            |f| matches!(f, F::InsideOut { .. }),
        ),
    ]
}

/// Where a fault is, numbers counting from 0 as in the file.
fn place(finding: &Finding) -> String {
    match finding {
        Finding::IndexOutOfRange { face }
        | Finding::FaceTooSmall { face }
        | Finding::ZeroArea { face } => format!("face {face}"),
        Finding::NotFinite { vertex } | Finding::UnusedVertex { vertex } => {
            format!("vertex {vertex}")
        }
        Finding::RepeatedVertex { face, vertex } => format!("vertex {vertex} in face {face}"),
        Finding::OpenEdge { edge, face } => {
            format!(
                "between vertices {} and {} of face {face}",
                edge[0], edge[1]
            )
        }
        Finding::MisorientedEdge { edge, faces } => format!(
            "between vertices {} and {} of faces {} and {}",
            edge[0], edge[1], faces[0], faces[1]
        ),
        Finding::NonManifoldEdge { edge, faces } => format!(
            "between vertices {} and {} of {} faces",
            edge[0],
            edge[1],
            faces.len()
        ),
        Finding::PinchedVertex { vertex, fans } => format!("vertex {vertex}, {fans} fans"),
        Finding::DuplicateFace { a, b }
        | Finding::Crossing { a, b }
        | Finding::Touching { a, b }
        | Finding::Coincident { a, b } => format!("faces {a} and {b}"),
        Finding::InsideOut { shell } => format!("shell {shell}"),
    }
}
