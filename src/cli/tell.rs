//! What was decided without being told, in words.

use powercrust::io::Cloud;
use powercrust::label::Agreement;
use powercrust::noise::{NoiseReport, OutlierReport};
use powercrust::poles::LOUD;
use powercrust::{SharpOption, Stats};

use super::plan::Plan;
use super::show::{counted, Talk};

/// Says how the surface agrees with what normals or the scanner say.
pub fn outward(plan: &Plan, cloud: &Cloud, found: &Agreement) {
    if found.samples == 0 {
        return;
    }
    let what = match (plan.sensor, &cloud.normals) {
        (Some(_), _) => "the way to --sensor",
        (None, Some(_)) => "the normals",
        (None, None) => "the way to the viewpoint",
    };
    let verdict = match (found.believed, found.turned) {
        (true, false) => "taken as evidence",
        (true, true) => "turned around and taken as evidence",
        (false, _) => "left alone",
    };
    // Who names a scanner wants to know.
    let talk = match plan.sensor.is_some() && !found.believed {
        true => Talk::Plain,
        false => Talk::Verbose,
    };
    let percent = 100.0 * found.share;
    plan.talk.at(
        talk,
        format_args!(
            "note: {percent:.1} % of {what} at {} agree with the surface found without: {verdict}",
            counted(found.samples, "sample", "samples"),
        ),
    );
}

/// Says that samples were left out.
pub fn outliers(talk: Talk, found: &OutlierReport) {
    if found.left_out > 0 {
        talk.at(
            Talk::Plain,
            format_args!(
                "note: {} left out as outliers, {} floating in {} and {} beside the surface; --outliers keep keeps them",
                counted(found.left_out, "sample", "samples"),
                found.floating,
                counted(found.groups, "group", "groups"),
                found.beside
            ),
        );
    }
}

/// Says which lambda was taken, and why.
pub fn lambda(plan: &Plan, stats: &Stats) {
    let found = &stats.lambda;
    let line = match (found.lambda, found.chosen) {
        (Some(lambda), true) => format!(
            "--lambda auto: {lambda} for {} amid noise of more than {LOUD} spacings: {} dropped",
            counted(found.asked, "sample", "samples"),
            counted(stats.poles_dropped as usize, "pole", "poles"),
        ),
        (Some(lambda), false) => format!(
            "--lambda {lambda}: {} of {} dropped",
            counted(stats.poles_dropped as usize, "pole", "poles"),
            counted(stats.skinny_samples as usize, "sample", "samples"),
        ),
        (None, true) => "--lambda auto: every pole kept, for want of so much noise".to_owned(),
        (None, false) => return,
    };
    plan.talk.at(Talk::Verbose, line);
}

/// Says how many handles amid noise were cut, and how many specks taken out.
pub fn cut(plan: &Plan, stats: &Stats) {
    if stats.handles_cut + stats.specks > 0 {
        let line = format!(
            "{} thinner than the noise cut, {} taken out",
            counted(stats.handles_cut, "handle", "handles"),
            counted(stats.specks, "speck", "specks"),
        );
        plan.talk.at(Talk::Verbose, line);
    }
}

/// Says how many samples lie at sharp edges, where that was asked of their
/// neighbours.
pub fn edges(plan: &Plan, stats: &Stats) {
    if stats.options.sharp != SharpOption::Auto {
        return;
    }
    let found = &stats.corners;
    let line = format!(
        "--sharp auto: {} at edges, {} at corners; {} drawn back from edges",
        counted(found.edges, "sample", "samples"),
        found.corners,
        counted(found.drawn_back, "pole", "poles"),
    );
    plan.talk.at(Talk::Verbose, line);
}

/// Says how long each stage took.
pub fn stages(plan: &Plan, stages: &[(String, f64)]) {
    for (stage, seconds) in stages {
        let line = format_args!("{stage:>10} {seconds:8.3} s");
        plan.talk.at(Talk::Verbose, line);
    }
}

/// Says that samples were moved, and why or why not.
pub fn noise(plan: &Plan, noise: &NoiseReport) {
    if let Some(level) = &noise.level {
        plan.talk.at(
            Talk::Verbose,
            format_args!(
                "--noise auto: quadrics through 12 samples miss them by {:.3} of the spacing, those through 24 by {:.2} times as much, through 48 by {:.2} times more; neighbours differ by {:.2} of what is missed: {}",
                level.share,
                level.growth,
                level.further_growth,
                level.independence,
                if level.noisy { "noise" } else { "no noise" }
            ),
        );
    }
    if noise.treated {
        plan.talk.at(
            Talk::Plain,
            format_args!(
                "note: noise of {:.3e}, {:.2} of the spacing: {} moved onto a surface through {} neighbours{}, by {:.3e} on average; --noise off keeps them",
                noise.scale,
                noise.share,
                counted(noise.moved, "sample", "samples"),
                noise.neighbours,
                match noise.sheets_told {
                    true => " on its side by the normals",
                    false => "",
                },
                noise.mean_move
            ),
        );
    }
}
