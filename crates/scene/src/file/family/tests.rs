use std::fs;
use std::path::Path;

use super::*;

/// The smallest family there is.
const SMALL: &str = r#"name = "small"
[generate]
kind = "clutter"
width = [6.0, 8.0]
height = [5.0, 7.0]
obstacle_size = 0.4
covered = 0.08
"#;

fn refusal(text: &str) -> String {
    let error = Family::parse(text, Path::new("f.toml")).map(|_| ()).expect_err(text);
    let message = error.to_string();
    assert!(!message.contains('\n'), "one line: {message}");
    message
}

#[test]
fn every_refusal_says_where_what_and_what_to_do() {
    let golden = include_str!("refusals.txt");
    let mut renewed = String::new();
    for block in golden.trim_end().split("\n\n") {
        let lines = |mark: char| block.lines().filter_map(move |l| l.strip_prefix(mark)).collect::<Vec<_>>();
        let (out, put) = (lines('-').join("\n"), lines('+').join("\n"));
        let kept: Vec<&str> = block.lines().filter(|l| !l.starts_with('>')).collect();
        renewed += &kept.join("\n");
        if !block.starts_with('#') {
            assert!(SMALL.contains(&out), "no such lines: {out}");
            let text = if out.is_empty() { format!("{SMALL}{put}\n") } else { SMALL.replacen(&out, &put, 1) };
            renewed += &format!("\n> {}", refusal(&text));
        }
        renewed += "\n\n";
    }
    let renewed = format!("{}\n", renewed.trim_end());
    if std::env::var_os("RENEW").is_some() {
        fs::write("src/file/family/refusals.txt", &renewed).expect("w");
    }
    assert_eq!(renewed, golden);
}

#[test]
fn the_smallest_family_has_the_documented_defaults() {
    let plan = Family::parse(SMALL, Path::new("f.toml")).expect("valid").plan;
    assert_eq!((plan.kind, plan.size_m), (Kind::Clutter, [[6.0, 8.0], [5.0, 7.0]]));
    assert_eq!((plan.spread, plan.discs, plan.along_walls), (0.5, 0.25, 0.3));
    assert_eq!((plan.clearance_m, plan.wall_m), (0.1, 0.1));
}
