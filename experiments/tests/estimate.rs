//! `estimate` on a world made to have the paper's prior.

use crate::mosaic;
use std::fs;
use std::path::Path;

use assert_cmd::Command;
use grid::GridSpec;
use serde_json::Value;

/// A robot's map of a mosaic of 60 m x 40 m, and a scene around it.
fn mosaic_scene(folder: &Path) {
    let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 1200, height: 800 };
    let world = mosaic::mosaic(spec, 0.1, 0.871, 4);
    let mut pgm = format!("P5\n{} {}\n255\n", spec.width, spec.height).into_bytes();
    for row in (0..spec.height).rev() {
        pgm.extend((0..spec.width).map(|column| if world[spec.index(column, row)] == Some(true) { 0 } else { 254 }));
    }
    fs::write(folder.join("m.pgm"), pgm).expect("written");
    let yaml = "image: m.pgm\nresolution: 0.05\norigin: [0.0, 0.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    fs::write(folder.join("m.yaml"), yaml).expect("written");
    // The robot only has to stand somewhere.
    let clear = |at: usize| {
        let [column, row] = [at % (spec.width - 40) + 20, at / (spec.width - 40) + 20];
        (row - 6..row + 6).all(|r| (column - 6..column + 12).all(|c| world[spec.index(c, r)] == Some(false)))
    };
    let at = (0..(spec.width - 40) * (spec.height - 40)).find(|at| clear(*at)).expect("a free place");
    let [x, y] = [at % (spec.width - 40) + 20, at / (spec.width - 40) + 20].map(|cells| cells as f64 * 0.05);
    let text = format!(
        "name = \"mosaic\"\nwaypoints = {{ A = [{x}, {y}], B = [{}, {y}] }}\nroute.stops = [\"A\", \"B\"]\nmap.file = \"m.yaml\"\nrobot.radius = 0.1\n",
        x + 0.2
    );
    fs::write(folder.join("mosaic.toml"), text).expect("written");
}

fn estimate(folder: &Path, args: &[&str]) -> String {
    let mut command = Command::cargo_bin("experiments").expect("built");
    let output = command.current_dir(folder).arg("estimate").args(args).output().expect("runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

#[test]
fn a_world_made_to_have_the_papers_prior_gives_it_back() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    mosaic_scene(folder.path());
    let table: Value =
        serde_json::from_str(&estimate(folder.path(), &["mosaic.toml", "--format", "json"])).expect("JSON");
    let rows = table["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 8, "four cell sizes, two truths");
    for row in rows.iter().filter(|row| row["truth"] == "world") {
        let value = |column: &str| row[column].as_f64().expect("a number");
        let cell_m = value("cell_m");
        // Some 150 and 100 lines: an error of 6 % in how far they lie apart, and of 5 % in the share.
        assert!((value("occupancy") - 0.1).abs() < 0.02, "{row}");
        assert!((value("predicted") - 0.871f64.powf(cell_m / 0.05)).abs() < 0.03 * cell_m / 0.05, "{row}");
        assert!((value("correlation_5cm") - 0.871).abs() < 0.02, "{row}");
        assert!((value("length_m") / 0.402 - 1.0).abs() < 0.15, "{row}");
    }
    // On the map's own cells what is covered is the world.
    let at_5cm: Vec<&Value> = rows.iter().filter(|row| row["cell_m"] == 0.05).collect();
    assert_eq!(at_5cm[0]["occupancy"], at_5cm[1]["occupancy"]);
}

#[test]
fn text_names_the_options_and_csv_the_columns() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let text = estimate(&root, &["scenes/clutter.toml", "--layout", "2"]);
    assert!(text.starts_with("scenes/clutter.toml, layout 2: at 0.05 m\n"), "{text}");
    assert!(text.contains("--prior 0.") && text.contains("--correlation 0."), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    let csv = estimate(&root, &["scenes/room.toml", "--grid", "0.1", "--format", "csv"]);
    let lines: Vec<&str> = csv.lines().collect();
    assert!(lines[0].starts_with("cell_m,truth,occupancy,correlation,predicted,"), "{csv}");
    assert!(lines.len() == 9 && lines[1].starts_with("0.05,world,") && lines[8].starts_with("0.4,cells,"), "{csv}");
}
