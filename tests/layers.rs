//! The direction of dependency: a module uses only modules in rows above its
//! own. Reads every `crate::` path in the sources of the library.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The rows, top first, and why each stands where it does.
const ROWS: [(&[&str], &str); 16] = [
    (
        &["geom", "context", "memory"],
        "plain values, what every long call receives, what the system tells",
    ),
    (
        &["error"],
        "what any stage may return; it knows cancellation, no stage",
    ),
    (
        &["predicates", "mesh", "options"],
        "signs of determinants of sites; meshes and what can be asked of them; \
         what the user may say, and errors about it",
    ),
    (
        &["tetra"],
        "cells and neighbours; coordinates only through predicates",
    ),
    (&["delaunay"], "samples, and the triangulation of points"),
    (
        &["noise"],
        "samples onto the surface that noise hides; which lie at edges",
    ),
    (
        &["power"],
        "the triangulation of balls; takes the formula of centres and the \
         corners of a cube from delaunay, knows neither samples nor poles",
    ),
    (&["poles"], "balls out of Delaunay cells"),
    (
        &["label", "simplify"],
        "sides of poles by the diagram; fewer poles by the samples. Neither \
         needs the other",
    ),
    (
        &["stats"],
        "what a run did: options, energies, counts of predicates",
    ),
    (
        &["surface"],
        "labelled cells become faces; its last step (surface::stage) reads \
         options and writes stats",
    ),
    (
        &["fit"],
        "solids without samples: from labelled cells to a mended surface, \
         moved to where a field says",
    ),
    (&["pipeline"], "the stages in order"),
    (
        &["attributes", "axis", "holes", "offset"],
        "what a result's vertices and faces inherit from points and balls; \
         what is left of its medial axis; places without samples; surfaces at \
         a distance. None needs the others",
    ),
    (
        &["inverse"],
        "from labelled balls back to a surface, with outer ones made for \
         those that have none",
    ),
    (
        &["io"],
        "files of what goes in and comes out, polar balls too",
    ),
];

/// Names that the front page re-exports, by the module they belong to.
fn home(name: &str) -> &str {
    match name {
        "Cancelled" | "Context" | "Progress" | "Silent" | "Stage" => "context",
        "Error" | "SampleError" => "error",
        "Ball" | "Bounds" | "Point" | "Side" => "geom",
        "PolygonMesh" => "mesh",
        "Faces" | "LabelOption" | "LambdaOption" | "NoiseOption" | "Options" | "OutlierOption"
        | "SharpOption" => "options",
        "reconstruct" | "reconstruct_seen" | "PolarBall" | "Reconstruction" => "pipeline",
        "Stats" => "stats",
        "Crust" | "PowerShape" => "surface",
        module => module,
    }
}

fn sources() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn rust_files(at: &Path, into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(at).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, into);
        } else if path.extension().is_some_and(|e| e == "rs") {
            into.push(path);
        }
    }
}

/// The part of the crate a file belongs to: `tetra` for `tetra/build.rs`.
fn module_of(file: &Path) -> String {
    let inside = file.strip_prefix(sources()).unwrap();
    let first = inside.components().next().unwrap().as_os_str();
    let first = first.to_str().unwrap();
    first.strip_suffix(".rs").unwrap_or(first).to_string()
}

/// What the paths after `crate::` on a line of code begin with; comments,
/// whose links may point anywhere, do not count.
fn names(line: &str) -> Vec<String> {
    let code = line.split("//").next().unwrap_or("");
    let word = |text: &str| -> String {
        let is_word = |c: &char| c.is_alphanumeric() || *c == '_';
        text.chars().take_while(is_word).collect()
    };
    code.split("crate::")
        .skip(1)
        .flat_map(|rest| match rest.strip_prefix('{') {
            Some(list) => list.split([',', '}']).map(|n| word(n.trim())).collect(),
            None => vec![word(rest)],
        })
        .filter(|name| !name.is_empty())
        .collect()
}

/// Every use of one module by another, with the line it stands on.
fn edges() -> BTreeMap<(String, String), String> {
    let mut files = Vec::new();
    rust_files(&sources(), &mut files);
    let mut edges = BTreeMap::new();
    for file in files {
        let user = module_of(&file);
        // The binary has a `crate` of its own.
        if ["main", "cli", "lib"].contains(&user.as_str()) {
            continue;
        }
        let text = std::fs::read_to_string(&file).unwrap();
        for (number, line) in (1..).zip(text.lines()) {
            for name in names(line) {
                let used = home(&name).to_string();
                if used != user {
                    let place = format!("{}:{number}", file.display());
                    edges.entry((user.clone(), used)).or_insert(place);
                }
            }
        }
    }
    edges
}

fn row(module: &str) -> Option<usize> {
    ROWS.iter().position(|(row, _)| row.contains(&module))
}

#[test]
fn no_module_uses_one_below_or_beside_it() {
    let edges = edges();
    assert!(edges.len() > 30, "only {} uses found", edges.len());
    let mut wrong = Vec::new();
    for ((user, used), place) in &edges {
        match (row(user), row(used)) {
            (Some(below), Some(above)) if above < below => {}
            (Some(_), Some(_)) => wrong.push(format!("{place}: {user} uses {used}")),
            _ => wrong.push(format!("{place}: {user} or {used} has no row")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_module_has_one_row() {
    let mut files = Vec::new();
    rust_files(&sources(), &mut files);
    let mut there: BTreeSet<String> = files.iter().map(|f| module_of(f)).collect();
    for own in ["lib", "main", "cli"] {
        assert!(there.remove(own), "{own} is gone");
    }
    let listed: Vec<&str> = ROWS
        .iter()
        .flat_map(|(row, _)| row.iter().copied())
        .collect();
    let once: BTreeSet<String> = listed.iter().map(|m| m.to_string()).collect();
    assert_eq!(once.len(), listed.len(), "a module twice");
    assert_eq!(there, once);
}

/// The geometry core stands alone: it could be a crate.
#[test]
fn predicates_and_cells_need_no_more_than_errors() {
    let used: BTreeSet<String> = edges()
        .into_keys()
        .filter(|(user, _)| ["predicates", "tetra"].contains(&user.as_str()))
        .map(|(_, used)| used)
        .collect();
    let allowed = ["context", "error", "predicates"].map(String::from);
    assert_eq!(used, BTreeSet::from(allowed));
}

/// The program uses what every user of the library may.
#[test]
fn the_program_uses_the_public_interface_only() {
    let mut files = Vec::new();
    rust_files(&sources().join("cli"), &mut files);
    files.push(sources().join("main.rs"));
    let library: BTreeSet<&str> = ROWS
        .iter()
        .flat_map(|(row, _)| row.iter().copied())
        .collect();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        for line in text.lines() {
            assert!(!line.contains("#[path"), "{}: {line}", file.display());
            for name in names(line) {
                let own = !library.contains(name.as_str());
                assert!(own, "{}: {line}", file.display());
            }
        }
    }
}

#[test]
fn names_are_found_in_lines() {
    assert_eq!(names("use crate::tetra::{order, pack};"), ["tetra"]);
    assert_eq!(names("    points: &[crate::geom::Point],"), ["geom"]);
    assert_eq!(names("use crate::{Ball, mesh::check};"), ["Ball", "mesh"]);
    assert_eq!(names("/// See [`crate::pipeline`]."), [""; 0]);
    assert_eq!(names("let x = 1; // crate::io"), [""; 0]);
    assert_eq!(home("Ball"), "geom");
    assert_eq!(home("mesh"), "mesh");
}
