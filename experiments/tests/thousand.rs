//! A thousand scans of the room: the fast mapper's scores are those of its reference.

use std::fs;
use std::process::Command;

use crate::checked::checked;

/// A scan every 58 ms of the drive of 58 s.
const SWEEP: &str = r#"
scene = "room.toml"
mappers = ["visibility", "visibility-reference"]
regions = ["observable", "visible", "surface", "shell", "hidden"]
[set]
scan_interval = 0.058
"#;

#[test]
fn after_a_thousand_scans_every_metric_is_that_of_the_reference() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let room = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/room.toml");
    fs::copy(room, folder.path().join("room.toml")).expect("copied");
    fs::write(folder.path().join("s.toml"), SWEEP).expect("writable");
    let args = ["sweep", "s.toml", "--out", "o"];
    let output = Command::new(env!("CARGO_BIN_EXE_experiments")).current_dir(folder.path()).args(args).output();
    checked(0, &args, &output.expect("runs"));
    let mut table = csv::Reader::from_path(folder.path().join("o/table.csv")).expect("merged");
    let heads = table.headers().expect("heads").clone();
    let rows: Vec<csv::StringRecord> = table.records().collect::<Result<_, _>>().expect("rows");
    let of = |mapper: &str| rows.iter().filter(|row| row.iter().any(|field| field == mapper)).collect::<Vec<_>>();
    let (fast, reference) = (of("visibility"), of("visibility-reference"));
    assert_eq!((fast.len(), reference.len()), (5, 5));
    let mut metrics = 0;
    for (fast, reference) in fast.iter().zip(&reference) {
        let region = &fast[heads.iter().position(|head| head == "region").expect("there")];
        for (head, (a, b)) in heads.iter().zip(fast.iter().zip(reference.iter())).skip(7) {
            let (Ok(x), Ok(y)) = (a.parse::<f64>(), b.parse::<f64>()) else {
                assert_eq!(a, b, "{region} {head}");
                continue;
            };
            assert!((x - y).abs() <= 5e-4 * y.abs().max(1e-3), "{region} {head}: {x}, and {y} by the reference");
            metrics += 1;
        }
    }
    assert!(metrics > 40, "{metrics} metrics");
}
