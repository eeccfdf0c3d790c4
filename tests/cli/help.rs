//! Help, and what the README says.

use super::*;

#[test]
fn help_states_the_contract() {
    let place = Place::new();
    let help = place.run("--help").code(DONE);
    let text = String::from_utf8(help.stdout).unwrap();
    for code in ["0 ", "1 ", "2 ", "3 ", "101 ", "130 "] {
        assert!(text.contains(&format!("\n  {code}")), "exit code {code}");
    }
    for part in [
        "Examples:",
        "Formats:",
        "Exit codes:",
        ".xyz",
        "medial axis",
    ] {
        assert!(text.contains(part), "{part}");
    }
    assert!(text.contains("simplify-mat"));
    let short = place.run("-h").code(DONE);
    assert!(short.stdout.len() < text.len());
    let version = place.run("--version").code(DONE);
    let expected = format!("powercrust {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(String::from_utf8(version.stdout).unwrap(), expected);
}

#[test]
fn readme_and_help_agree() {
    let readme = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md"));
    let readme = readme.unwrap();
    let help = Place::new().run("--help").code(DONE).stdout;
    let help = String::from_utf8(help).unwrap();
    let mut options = 0;
    for line in help
        .lines()
        .filter(|line| line.trim_start().starts_with('-'))
    {
        let words = line.split([' ', ',']).filter(|word| word.starts_with("--"));
        // `--sharp[=<HOW>]` may stand alone.
        for word in words.filter_map(|word| word.trim_end_matches('.').split('[').next()) {
            assert!(readme.contains(word), "README.md does not mention {word}");
            options += 1;
        }
    }
    assert!(options > 20, "{options}");
    // The defaults stated are those of the library.
    let plain = powercrust::Options::default();
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    for default in [
        format!("by default {}", plain.merge),
        format!("by default {}", plain.flatness),
        format!("by default {}", plain.box_factor),
        format!("default {:.2}", plain.deep_angle),
    ] {
        assert!(words(&help).contains(&default), "--help: {default}");
        assert!(readme.contains(&default), "README.md: {default}");
    }
}

#[test]
fn man_page_and_completions() {
    let place = Place::new();
    for (what, part) in [
        ("man", ".TH powercrust"),
        ("complete-bash", "--lambda"),
        ("complete-zsh", "#compdef powercrust"),
        ("complete-fish", "complete -c powercrust"),
    ] {
        let ran = place.run(&format!("--generate {what}")).code(DONE);
        let text = String::from_utf8(ran.stdout).unwrap();
        assert!(text.contains(part), "{what}: no {part}");
    }
}
