//! Wrong poses, as the commands meet them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::checked::checked;
use crate::closet::SCENE;
use crate::nook::FAMILY;

fn run(folder: &Path, code: i32, args: &[&str]) -> (String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
    checked(code, &args, &command.current_dir(folder).args(args).output().expect("runs"))
}

fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("closet.toml"), SCENE).expect("writable");
    fs::write(folder.path().join("nook.toml"), FAMILY).expect("writable");
    folder
}

/// Log loss by pose error, mapper and region.
fn swept(folder: &Path, text: &str, key: &str) -> BTreeMap<[String; 3], String> {
    fs::write(folder.join("sweep.toml"), text).expect("writable");
    run(folder, 0, &["sweep", "sweep.toml", "--out", "o"]);
    let mut reader = csv::Reader::from_path(folder.join("o/table.csv")).expect("a table");
    let heads = reader.headers().expect("heads").clone();
    let column = |name: &str| heads.iter().position(|head| head == name).expect("a column");
    let (at, loss, error) = ([key, "mapper", "region"].map(column), column("log_loss"), column("error"));
    let row = |row: csv::StringRecord| {
        assert_eq!(&row[error], "", "{row:?}");
        (at.map(|k| row[k].to_owned()), row[loss].to_owned())
    };
    reader.records().map(|record| row(record.expect("a row"))).collect()
}

#[test]
fn sweeps_tell_mappers_wrong_poses_and_score_maps_that_are_aligned() {
    let folder = place();
    let common =
        "scene = \"closet.toml\"\nmappers = [\"visibility\", \"prior\"]\nregions = [\"observable\", \"aligned\"]\n";
    let none = swept(folder.path(), &format!("{common}[vary]\npose_drift = [0.0]\n"), "pose_drift");
    fs::remove_dir_all(folder.path().join("o")).expect("removable");
    let wrong = format!(
        "{common}[paired]\npose_sigma_m = [0.0, 0.2]\npose_sigma_rad = [0.0, 0.1]\n[vary]\npose_drift = [0.0]\n"
    );
    let wrong = swept(folder.path(), &wrong, "pose_sigma_m");
    assert_eq!((none.len(), wrong.len()), (4, 8));
    let of = |table: &BTreeMap<[String; 3], String>, error: &str, mapper: &str, region: &str| -> f64 {
        table[&[error, mapper, region].map(str::to_owned)].parse().expect("a number")
    };
    let observable = of(&none, "0.0", "visibility", "observable");
    let same = of(&wrong, "0.0", "visibility", "observable");
    assert!((observable - same).abs() < 1e-12, "without an error the readings and poses are those of any sweep");
    assert!(of(&wrong, "0.2", "visibility", "observable") > same + 0.02);
    // What has no obstacles lies nowhere better, and has no poses to be wrong.
    let prior = |error, region| of(&wrong, error, "prior", region);
    assert!((prior("0.0", "observable") - prior("0.2", "aligned")).abs() < 1e-12);
    let names: Vec<String> = fs::read_dir(folder.path().join("o"))
        .expect("a folder")
        .map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned())
        .collect();
    assert!(names.iter().any(|name| name == "all-mappers.png"), "{names:?}");
}

#[test]
fn compare_tells_all_mappers_the_same_wrong_poses() {
    let folder = place();
    let mappers = "visibility,conventional,prior";
    let common = ["compare", "--set", "robustness", "--families", "nook.toml", "--seeds", "2", "--mappers", mappers];
    let scores = |conditions: &str| {
        let out = conditions.replace(',', "-");
        run(folder.path(), 0, &[&common[..], &["--conditions", conditions, "--out", &out]].concat());
        let read = |mapper: &str| {
            let text =
                fs::read_to_string(folder.path().join(&out).join(format!("scores-{mapper}.csv"))).expect("a table");
            text.lines().filter(|line| line.contains(",observable,")).map(str::to_owned).collect::<Vec<_>>()
        };
        (read("visibility"), read("prior"))
    };
    let (visibility, prior) = scores("poses,drift");
    assert_eq!((visibility.len(), prior.len()), (4, 4));
    for condition in ["poses", "drift"] {
        assert_eq!(visibility.iter().filter(|line| line.starts_with(&format!("{condition},nook,2000"))).count(), 2);
    }
    let numbers = |line: &String| line.split_once(",nook,").expect("a family").1.to_owned();
    let by = |condition: &str, lines: &[String]| -> Vec<String> {
        lines.iter().filter(|line| line.starts_with(condition)).map(numbers).collect()
    };
    assert_ne!(by("poses", &visibility), by("drift", &visibility), "poses differ, and maps with them");
    assert_eq!(by("poses", &prior), by("drift", &prior), "the worlds are the same");
    let (alone, _) = scores("drift");
    assert_eq!(
        by("drift", &alone),
        by("drift", &visibility),
        "a condition does not depend on what is asked for beside it"
    );
    let text = fs::read_to_string(folder.path().join("poses-drift/summary.md")).expect("a summary");
    assert!(text.contains("told the same wrong poses") && text.contains("those of odometry"), "{text}");
}

#[test]
fn gates_judge_maps_under_a_condition_and_aligned() {
    let folder = place();
    let judged_on = |seeds: u8, code, more: &str| {
        let text = format!(
            "[[gate]]\nname = \"g\"\nmapper = \"visibility\"\nmetric = \"log_loss\"\nseeds = {seeds}\n{more}\n"
        );
        fs::write(folder.path().join("gates.toml"), text).expect("writable");
        run(folder.path(), code, &["gate", "--gates", "gates.toml"])
    };
    let judged = |code, more: &str| judged_on(1, code, more);
    let value = |more: &str| -> f64 {
        let (out, _) = judged_on(4, 3, &format!("{more}\nat_least = 99.0"));
        let line = out.lines().find(|line| line.starts_with("g ")).unwrap_or_else(|| panic!("{out}"));
        line.split_whitespace().nth(1).and_then(|word| word.parse().ok()).unwrap_or_else(|| panic!("{out}"))
    };
    let family = "families = [\"nook.toml\"]\nset = \"robustness\"\n";
    let [believed, drift, aligned] =
        ["condition = \"as-believed\"", "condition = \"drift\"", "condition = \"drift\"\nregion = \"aligned\""]
            .map(|more| value(&format!("{family}{more}")));
    assert!(believed < aligned && aligned + 0.01 < drift, "{believed} {aligned} {drift}");
    judged(0, "scene = \"closet.toml\"\ncondition = \"poses\"\nregion = \"aligned\"\nat_most = 9.0");
    for (more, said) in [
        ("families = [\"nook.toml\"]\ncondition = \"pose\"\nat_most = 1.0", "condition = \"pose\""),
        ("scene = \"closet.toml\"\ncondition = \"people\"\nat_most = 1.0", "gates.toml:7:13"),
        ("scene = \"closet.toml\"\ncondition = \"size-2\"\nat_most = 1.0", "which a scene has of its own"),
        ("scene = \"closet.toml\"\ncondition = 3\nat_most = 1.0", "gates.toml:7:13"),
    ] {
        let (_, err) = judged(2, more);
        assert!(err.contains(said), "{err}");
    }
    // People of a condition move, as those of a family do.
    let crowded = FAMILY
        .replace("width = [4.0, 4.5]", "width = [6.0, 6.5]")
        .replace("height = [3.5, 4.0]", "height = [6.0, 6.5]");
    fs::write(folder.path().join("nook.toml"), crowded).expect("writable");
    judged(0, "families = [\"nook.toml\"]\ncondition = \"people\"\nregion = \"static\"\nat_most = 9.0");
}
