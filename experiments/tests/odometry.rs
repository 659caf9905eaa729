//! Odometry beside the true pose, from `room` to `replay`.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::nook::FAMILY;
use logs::{Log, Options};

use crate::checked::checked;
use crate::closet::SCENE;

fn room(folder: &Path, scene: &str, more: &[&str]) -> Vec<csv::StringRecord> {
    let args = [&["room", "--scene", scene, "--mappers", "visibility", "--out", "out"], more].concat();
    let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
    checked(0, &args, &command.current_dir(folder).args(&args).output().expect("runs"));
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).from_path(folder.join("out/scans.csv")).expect("readable");
    reader.records().collect::<Result<_, _>>().expect("rows")
}

#[test]
fn a_scene_with_odometry_has_it_beside_the_true_pose_and_all_else_is_the_same() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path();
    fs::write(path.join("without.toml"), SCENE).expect("writable");
    fs::write(path.join("with.toml"), format!("{SCENE}[odometry]\nslips_per_m = 0.5\n")).expect("writable");
    let without = room(path, "without.toml", &[]);
    let metrics = fs::read(path.join("out/metrics.csv")).expect("readable");
    fs::remove_dir_all(path.join("out")).expect("removable");
    let with = room(path, "with.toml", &[]);
    assert_eq!(metrics, fs::read(path.join("out/metrics.csv")).expect("readable"), "mappers see the recorded poses");
    assert_eq!(with.len(), without.len());
    let columns = without[0].len();
    assert_eq!(with[0].iter().skip(columns).collect::<Vec<_>>(), ["odom_x_m", "odom_y_m", "odom_theta_rad"]);
    for (with, without) in with.iter().zip(&without) {
        assert!(with.iter().take(columns).eq(without.iter()));
    }

    let mut log = Log::open(&path.join("out/scans.csv"), &Options::default()).expect("a log");
    let (mut scans, mut first, mut last) = (0, None, None);
    while let Some(event) = log.next_event() {
        let event = event.expect("a scan");
        let odometry = event.odometry.expect("beside the pose");
        first = first.or(Some((odometry, event.scan.pose)));
        last = Some((odometry, event.scan.pose));
        scans += 1;
    }
    let ((odometry, pose), (measured, driven)) = (first.expect("scans"), last.expect("scans"));
    assert!(scans > 10 && odometry == pose, "it begins where the robot stands");
    let off_m = (measured.x_m - driven.x_m).hypot(measured.y_m - driven.y_m);
    assert!(off_m > 1e-3 && off_m < 1.0, "{off_m}");
}

#[test]
fn families_hand_their_odometry_to_their_scenes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("nook.toml"), format!("{FAMILY}[odometry]\nm_per_m = 0.2\n")).expect("writable");
    let scans = room(folder.path(), "nook.toml", &["--layout", "3"]);
    assert!(scans[0].iter().any(|name| name == "odom_x_m"));
}
