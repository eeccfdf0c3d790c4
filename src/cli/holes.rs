//! What is said of places where nothing was sampled.

use powercrust::holes::{Filled, Holes, Loop};
use serde_json::{json, Value};

use super::plan::Plan;
use super::product::Product;
use super::show::{counted, Talk};
use super::wanted;

/// Holes are worth a word in the summary from this share of the surface on.
const WORTH_SAYING: f64 = 0.01;
/// From this share on the samples cannot be said to surround a solid: an open
/// sheet closed over has at least about half of its surface from nowhere.
const NO_SOLID: f64 = 0.3;
/// Holes and loops told one by one.
const MOST: usize = 10;

/// For `--json` and `--stats`: all there is to know.
pub fn in_full(plan: &Plan, product: &Product) -> Value {
    let holes = &product.holes;
    let mut object = json!({
        "how": plan.holes,
        "share": holes.share,
        "surrounded": holes.share < NO_SOLID,
        "patches": holes.patches,
    });
    if let Some(loops) = &product.border {
        let with_area = |l: &Loop| {
            let mut object = json!(l);
            object["area"] = json!(holes.patches.get(l.patch as usize).map(|p| p.area));
            object
        };
        object["loops"] = loops.iter().map(with_area).collect();
    }
    if let Some(filled) = &product.filled {
        object["filled"] = json!(filled.shares);
        object["farthest"] = json!(filled.farthest);
    }
    object
}

/// For the summary line.
pub fn in_short(holes: &Holes, border: Option<&[Loop]>, filled: Option<&Filled>) -> Option<String> {
    let percent = 100.0 * holes.share;
    let many = counted(holes.patches.len(), "hole", "holes");
    match border {
        Some(loops) => Some(format!(
            "{many} left open ({percent:.1} % of the surface), {}",
            counted(loops.len(), "border loop", "border loops")
        )),
        None if filled.is_some() => {
            let short = filled.map_or(0, |f| f.shares.iter().filter(|&&s| s < 1.0).count());
            let not_all = match short {
                0 => String::new(),
                _ => format!("; {short} not all the way, faces would cross"),
            };
            let sheet = match holes.share >= NO_SOLID {
                true => "the samples do not surround a solid: ",
                false => "",
            };
            Some(format!(
                "{sheet}{many} filled ({percent:.1} % of the surface{not_all})"
            ))
        }
        None if holes.share >= NO_SOLID => Some(format!(
            "the samples do not surround a solid: {percent:.0} % of the surface bridges missing data, --holes open leaves it out"
        )),
        None if holes.share >= WORTH_SAYING => Some(format!(
            "{many} bridged ({percent:.1} % of the surface; --holes open leaves them out)"
        )),
        None => None,
    }
}

/// The largest holes and longest loops, for `-v`.
pub fn tell(plan: &Plan, holes: &Holes, border: Option<&[Loop]>, filled: Option<&Filled>) {
    let say = |text: String| plan.talk.at(Talk::Verbose, text);
    let place = |p: [f64; 3]| format!("({:.4}, {:.4}, {:.4})", p[0], p[1], p[2]);
    for (k, patch) in holes.patches.iter().enumerate().take(MOST) {
        say(format!(
            "hole {k}: {:.4} wide, {:.1} spacings; area {:.4} of {} at {}",
            patch.width,
            patch.spacings,
            patch.area,
            counted(patch.faces, "face", "faces"),
            place(patch.centre)
        ));
    }
    if let Some(filled) = filled {
        for (k, share) in filled.shares.iter().enumerate().take(MOST) {
            say(format!(
                "hole {k} filled: {:.0} % of the way to a membrane",
                100.0 * share
            ));
        }
        say(format!(
            "filling moved {}, the farthest by {:.4}",
            counted(filled.vertices.len(), "vertex", "vertices"),
            filled.farthest
        ));
    }
    if holes.patches.len() > MOST {
        say(format!(
            "and {} more, see --json",
            holes.patches.len() - MOST
        ));
    }
    let loops = border.unwrap_or_default();
    for (k, l) in loops.iter().enumerate().take(MOST) {
        let area = holes.patches.get(l.patch as usize).map_or(0.0, |p| p.area);
        say(format!(
            "border loop {k} of hole {}: length {:.4}, opening {:.4}, area left out {area:.4}, at {}",
            l.patch,
            l.length,
            l.opening,
            place(l.centre)
        ));
    }
    if loops.len() > MOST {
        say(format!("and {} more, see --json", loops.len() - MOST));
    }
    if plan.holes == wanted::Holes::Keep && !holes.patches.is_empty() {
        say(
            "the faces of holes are marked by the attribute hole; --holes open leaves them out"
                .to_owned(),
        );
    }
}
