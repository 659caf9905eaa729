//! Trajectories as programs write them: read as what they are, or refused by name.

use logs::{Finding, Trajectory};
use proptest::prelude::*;
use sensor::Pose;

/// A pose of a drive round a bend, every tenth of a second.
fn pose(k: i32) -> (f64, Pose) {
    let k = f64::from(k);
    (1000.0 + 0.1 * k, Pose { x_m: 0.1 * k, y_m: 0.002 * k * k, theta_rad: 0.04 * k })
}

fn line(k: i32) -> String {
    let (time, pose) = pose(k);
    let (sin, cos) = (0.5 * pose.theta_rad).sin_cos();
    format!("{time:.3} {} {} 0.3 0 0 {sin} {cos}\n", pose.x_m, pose.y_m)
}

fn lines(numbers: impl IntoIterator<Item = i32>) -> String {
    numbers.into_iter().map(line).collect()
}

fn read(text: &str) -> Result<Trajectory, String> {
    Trajectory::read(text.as_bytes(), "a.tum").map_err(|error| error.to_string())
}

/// Each line's fields, joined anew.
fn changed(change: impl Fn(Vec<&str>) -> String) -> String {
    lines(0..40).lines().map(|line| change(line.split(' ').collect()) + "\n").collect()
}

/// Whether the poses are those of the drive.
fn is_the_drive(text: &str, most: f64) -> Vec<Finding> {
    let found = read(text).expect("is read");
    for k in 0..40 {
        let (time, expected) = pose(k);
        let near =
            found.pose(time).or_else(|| found.pose(time + 1e-6)).or_else(|| found.pose(time - 1e-6)).expect("within");
        let apart = (near.x_m - expected.x_m).hypot(near.y_m - expected.y_m);
        let turn =
            (near.theta_rad - expected.theta_rad).sin().abs() + 1.0 - (near.theta_rad - expected.theta_rad).cos();
        assert!(apart < most && turn < most, "{k}: {near:?} {expected:?}");
    }
    found.findings().to_vec()
}

#[test]
fn every_form_gives_the_same_poses() {
    let euroc = |head: &str| {
        head.to_owned()
            + &changed(|f| {
                let time: f64 = f[0].parse().expect("a number");
                format!("{:.0}000000,{},{},{},{},{},{},{}", 1e3 * time, f[1], f[2], f[3], f[7], f[4], f[5], f[6])
            })
    };
    let named = "#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w [],q_x [],q_y [],q_z []\n";
    let shuffled = lines((0..40).step_by(2).chain((1..40).step_by(2)));
    let twice: String = (0..40).map(|k| if k % 7 == 0 { line(k) + &line(k) } else { line(k) }).collect();
    for (name, text, most, expected) in
        [
            ("plain", lines(0..40), 1e-9, ""),
            ("commas", lines(0..40).replace(' ', ","), 1e-9, ""),
            (
                "a head without a sign",
                format!("timestamp,tx,ty,tz,qx,qy,qz,qw\n{}", lines(0..40).replace(' ', ",")),
                1e-9,
                "",
            ),
            ("semicolons and tabs", lines(0..40).replace(' ', ";\t"), 1e-9, ""),
            ("trailing blanks", lines(0..40).replace('\n', "  \t\r\n"), 1e-9, ""),
            (
                "nanoseconds",
                changed(|f| format!("{}000000 {}", f[0].replace('.', ""), f[1..].join(" "))),
                1e-4,
                "nanoseconds",
            ),
            ("EuRoC", euroc(named), 1e-4, "w x y z, as its columns are named"),
            ("w first", changed(|f| format!("{} {} {}", f[..4].join(" "), f[7], f[4..7].join(" "))), 1e-9, "w x y z"),
            ("shuffled", shuffled, 1e-9, "sorted by time"),
            ("twice", twice, 1e-9, "6 poses of the trajectory come twice"),
            (
                "few digits",
                changed(|f| {
                    f.iter()
                        .enumerate()
                        .map(|(k, v)| {
                            if k < 4 { (*v).to_owned() } else { format!("{:.2} ", v.parse::<f64>().expect("a number")) }
                        })
                        .collect::<Vec<_>>()
                        .join(" ")
                }),
                2e-2,
                "few digits",
            ),
        ]
    {
        let findings = is_the_drive(&text, most);
        assert!(findings.iter().all(|finding| !finding.is_warning()), "{name}: {findings:?}");
        let said = findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ");
        assert!(said.contains(expected) && said.is_empty() == expected.is_empty(), "{name}: {said}");
    }
}

#[test]
fn times_give_their_unit_by_their_size_and_how_far_they_are_apart() {
    // Since 1970, and since a machine started.
    for start_s in [1.4e9, 1000.0] {
        for (scale, unit) in [(1e3, "milliseconds"), (1e6, "microseconds"), (1e9, "nanoseconds")] {
            if start_s < 1e9 && scale < 1e4 {
                continue; // steps of 100 can be seconds
            }
            let text = changed(|f| {
                let time_s = start_s + f[0].parse::<f64>().expect("a number");
                format!("{:.0} {}", time_s * scale, f[1..].join(" "))
            });
            let found = read(&text).expect("is read");
            assert!((found.span_s()[0] - start_s - 1000.0).abs() < 1.0, "{unit}: {:?}", found.span_s());
            assert_eq!(found.findings(), [Finding::TrajectoryUnit { unit }]);
        }
    }
}

#[test]
fn one_bad_pose_is_left_out_and_named() {
    let bad = line(20).replace("1002.000 2 ", "1002.000 588000 ");
    let findings = is_the_drive(&(lines(0..20) + &bad + &lines(21..40)), 1e-2);
    assert!(matches!(findings[..], [Finding::TrajectoryStrays { count: 1, line: 21, .. }]), "{findings:?}");
    assert!(findings[0].is_warning() && findings[0].to_string().contains("588 km"));
}

#[test]
fn what_cannot_be_read_is_refused_with_line_and_remedy() {
    let whole = changed(|f| format!("{:.0} {}", f[0].parse::<f64>().expect("a number"), f[1..].join(" ")));
    let one = changed(|f| format!("1000 {}", f[1..].join(" ")));
    let second_run = lines(0..40)
        .lines()
        .map(|line| {
            let mut fields: Vec<_> = line.split(' ').map(str::to_owned).collect();
            fields[2] = "9".to_owned();
            fields.join(" ") + "\n"
        })
        .collect::<String>();
    let shifted =
        changed(|f| format!("{:.3} {} 9 {}", f[0].parse::<f64>().expect("a number") + 0.05, f[1], f[3..].join(" ")));
    for (text, messages) in [
        (lines(0..40) + &second_run, &["a.tum:41: ", "two runs in one file"][..]),
        (lines(0..40) + &shifted, &["a.tum:41: ", "two runs in one file"]),
        (whole, &["is there twice", "whole seconds: write them with more digits"]),
        (one, &["a.tum:2: time 1000 s: is there twice", "all 40 poses have it"]),
        (lines([0, 1, 2]) + &line(1).replacen(" 0.1 ", " 0.2 ", 1), &["a.tum:4: ", "first in line 2"]),
        ("1 0 0 0 0 1 0 0 0 0 1 0\n".to_owned(), &["a.tum:1: 12 numbers are a matrix", "KITTI", "TUM"]),
        ("1 0 0 0 -0.5 0.5 -0.5 0.5\n".to_owned(), &["a.tum:1: tilted by 90 degrees", "optical frame"]),
        ("VERTEX_SE2 0 0 0 0\n".to_owned(), &["a.tum: is a pose graph"]),
        ("\u{fffd}\n".to_owned(), &["a.tum:1: 1 fields; must be 8"]),
    ] {
        let message = read(&text).expect_err(messages[0]);
        assert!(messages.iter().all(|part| message.contains(part)), "{messages:?}: {message}");
    }
}

proptest! {
    /// Any order of rows gives the same trajectory.
    #[test]
    fn order_makes_no_difference(numbers in Just((0..30).collect::<Vec<i32>>()).prop_shuffle()) {
        let (found, expected) = (read(&lines(numbers)).expect("fine"), read(&lines(0..30)).expect("fine"));
        for k in 0..290 {
            let time = 1000.0 + 0.01 * f64::from(k);
            prop_assert_eq!(found.pose(time), expected.pose(time));
        }
    }

    /// Random bytes, and random numbers: what is read has poses that are numbers in its time span alone, what is not is refused in a line.
    #[test]
    fn random_bytes_are_read_or_refused_in_one_line(
        bytes in prop::collection::vec(any::<u8>(), 0..300),
        words in prop::collection::vec("[01]|-?0\\.[0-9]|nan|1e[0-9]{1,2}|\n|,|#", 0..120),
    ) {
        for text in [bytes, words.join(" ").into_bytes()] {
            match Trajectory::read(text.as_slice(), "noise") {
                Ok(found) => {
                    let [first, last] = found.span_s();
                    prop_assert!(first <= last);
                    let ends = [found.pose(first), found.pose(last)];
                    prop_assert!(ends.iter().flatten().all(|pose| pose.x_m.is_finite() && pose.theta_rad.is_finite()) && ends[0].is_some());
                    prop_assert_eq!((found.pose(first.next_down()), found.pose(last.next_up())), (None, None));
                }
                Err(error) => {
                    let message = error.to_string();
                    prop_assert!(message.starts_with("noise") && !message.contains('\n') && message.len() < 600, "{}", message);
                }
            }
        }
    }
}
