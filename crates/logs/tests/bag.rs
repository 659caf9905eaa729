//! Bags as logs: which topics are taken, where scans stand, what readings say, and what is said of all that is doubtful.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::bag_writer::message::{self, FORMS, Form, S, flat};
use crate::bag_writer::{Message, Packing, bag1, db3, mcap};
use logs::bag::{BagOptions, Drive, PoseSource};
use logs::{Body, Event, Log, LogError, Options, Report, Sensor, Trajectory};
use sensor::Pose;

const LASER: &str = "sensor_msgs/msg/LaserScan";
const ODOMETRY: &str = "nav_msgs/msg/Odometry";
const TF: &str = "tf2_msgs/msg/TFMessage";

const START: u64 = 1_700_000_000;

fn at(topic: &'static str, kind: &'static str, tenth: u64, bytes: Vec<u8>) -> Message {
    Message { topic, kind, time_ns: stamp(tenth), bytes }
}

/// Tenths of a second since the start.
fn stamp(tenth: u64) -> u64 {
    START * S + tenth * S / 10
}

/// Where the robot is: it drives along x and turns.
fn robot(tenth: u64) -> [f64; 3] {
    [0.1 * tenth as f64, 1.0, 0.02 * tenth as f64]
}

const MOUNT: [f64; 3] = [0.5, 0.0, PI / 2.0];

fn scan(form: Form, tenth: u64, ranges: &[f32]) -> Message {
    at("/scan", LASER, tenth, message::laser(form, stamp(tenth), "laser", 0.5, ranges))
}

fn odometry(form: Form, tenth: u64) -> Message {
    at("/odom", ODOMETRY, tenth, message::odometry(form, stamp(tenth), "base_link", robot(tenth)))
}

fn tf(form: Form, tenth: u64, all: &[(&str, &str, [f64; 7])]) -> Message {
    at("/tf", TF, tenth, message::transforms(form, stamp(tenth), all))
}

fn mounted(form: Form, mount: [f64; 7]) -> Message {
    at("/tf_static", TF, 0, message::transforms(form, 0, &[("base_link", "laser", mount)]))
}

/// Odometry every tenth of a second from 0 to 20, scans between from the tenth `from` on.
fn drive(form: Form, from: u64) -> Vec<Message> {
    let odometry = (0..=20).map(|tenth| odometry(form, tenth));
    let scans = (from..=20).step_by(2).map(|tenth| scan(form, tenth, &[2.0, 3.0, f32::INFINITY]));
    [mounted(form, flat(MOUNT))].into_iter().chain(odometry).chain(scans).collect()
}

fn open(messages: &[Message], options: &BagOptions) -> Result<Arc<Drive>, LogError> {
    Drive::read(mcap::file(messages, Packing::None, 7, "cdr"), "a.mcap", options)
}

fn all(log: Result<Log<'static>, LogError>) -> (Vec<Event>, Report) {
    let mut log = log.expect("a log");
    let mut events = Vec::new();
    while let Some(event) = log.next_event() {
        events.push(event.expect("a scan"));
    }
    (events, log.report().clone())
}

fn read_by(messages: &[Message], options: &BagOptions) -> (Vec<Event>, Report) {
    all(Log::of_drive(&open(messages, options).expect("a drive"), &Options::default()))
}

fn read(messages: &[Message]) -> (Vec<Event>, Report) {
    read_by(messages, &BagOptions::default())
}

fn pose(source: &str) -> BagOptions {
    let pose = PoseSource::named(source);
    BagOptions { pose, ..BagOptions::default() }
}

fn refused(messages: &[Message], options: &BagOptions) -> String {
    let message = open(messages, options).err().expect("refused").to_string();
    assert!(message.starts_with("a.mcap: ") && !message.contains('\n'), "{message}");
    message
}

fn warnings(report: &Report) -> Vec<String> {
    let all = report.findings().into_iter().filter(logs::Finding::is_warning);
    all.map(|finding| finding.text(report.unit)).collect()
}

fn near(pose: Pose, [x, y, theta]: [f64; 3]) -> bool {
    (pose.x_m - x).abs() < 1e-9 && (pose.y_m - y).abs() < 1e-9 && (pose.theta_rad - theta).abs() < 1e-9
}

/// Where the sensor is at a tenth of a second.
fn seat(tenth: f64, mount: [f64; 3]) -> [f64; 3] {
    let [x, y, theta] = [0.1 * tenth, 1.0, 0.02 * tenth];
    let (sin, cos) = theta.sin_cos();
    [x + cos * mount[0] - sin * mount[1], y + sin * mount[0] + cos * mount[1], theta + mount[2]]
}

#[test]
fn every_container_and_encoding_is_the_same_drive() {
    let options = BagOptions::default();
    let (expected, _) = read(&drive(Form::Little, 0));
    assert_eq!(expected.len(), 11);
    for (k, event) in expected.iter().enumerate() {
        assert!(near(event.scan.pose, seat(2.0 * k as f64, MOUNT)), "{:?}", event.scan.pose);
        assert!((event.scan.time_s - 0.2 * k as f64).abs() < 1e-6);
    }
    for form in FORMS {
        let messages = drive(form, 0);
        let files = match form {
            Form::Ros1 => vec![bag1::file(&messages, Packing::Bz2, 5), mcap::file(&messages, Packing::Zstd, 5, "ros1")],
            _ => vec![db3::file(&messages), mcap::file(&messages, Packing::Lz4, 5, "cdr")],
        };
        for file in files {
            let drive = Drive::read(file, "a.bag", &options).expect("a drive");
            assert!(all(Log::of_drive(&drive, &Options::default())).0.iter().eq(&expected), "{form:?}");
        }
    }
}

#[test]
fn readings_are_echoes_no_echo_or_nothing() {
    let mut messages = drive(Form::Little, 30);
    let ranges = [2.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 0.15, 0.2, 10.0, 10.5, 0.0, -1.0, 65.5];
    messages.push(at("/scan", LASER, 5, message::laser(Form::Little, stamp(5), "laser", 0.1, &ranges)));
    let (events, report) = read(&messages);
    let none = Some(f64::INFINITY);
    let least = Some(f64::from(0.2f32));
    let expected = [Some(2.0), none, None, None, None, least, none, None, None, None, None];
    assert_eq!(events[0].scan.readings, expected);
    assert_eq!(events[0].kind, Sensor::Laser { max_range_m: 10.0, beams: 11 });
    assert_eq!(report.beyond_maximum, 2);
    let said: Vec<String> = warnings(&report);
    assert!(
        said.iter().any(|line| line.contains("2 ranges, 18.2 % of all readings, lie beyond the range_max")),
        "{said:?}"
    );
    // An option says what no echo is.
    let drive = open(&messages, &BagOptions::default()).expect("a drive");
    let (events, report) = all(Log::of_drive(&drive, &Options { max_range_m: Some(10.2), ..Options::default() }));
    assert_eq!(events[0].scan.readings[6..8], [Some(10.0), none]);
    assert_eq!((events[0].scan.readings[10], report.beyond_maximum), (none, 0));
}

#[test]
fn poses_are_interpolated_and_never_guessed() {
    let mut messages: Vec<Message> = drive(Form::Little, 30);
    messages.retain(|message| message.topic != "/odom" || (stamp(5)..=stamp(15)).contains(&message.time_ns));
    for tenth in [0, 4, 6, 15, 16] {
        messages.push(scan(Form::Little, tenth, &[2.0]));
    }
    // Between two stamps.
    let bytes = message::laser(Form::Little, stamp(7) + S / 20, "laser", 0.5, &[2.0]);
    messages.push(at("/scan", LASER, 7, bytes));
    let (events, report) = read(&messages);
    assert_eq!((events.len(), report.unplaced, report.in_gaps), (3, 3, 0));
    // Seconds since 1970 have six digits behind the point.
    let Pose { x_m, theta_rad, .. } = events[2].scan.pose;
    let [x, _, theta] = seat(7.5, MOUNT);
    assert!((x_m - x).abs() < 1e-6 && (theta_rad - theta).abs() < 1e-6, "{:?}", events[2].scan.pose);
    let said: Vec<String> = report.findings().iter().map(ToString::to_string).collect();
    assert!(
        said.iter()
            .any(|line| line.contains("3 scans are left out: there is no pose before and after them from /odom")),
        "{said:?}"
    );
    // A gap of two seconds is not bridged, unless it is allowed.
    let mut messages = drive(Form::Little, 0);
    messages.retain(|message| message.topic != "/odom" || [stamp(0), stamp(20)].contains(&message.time_ns));
    let drive = open(&messages, &BagOptions::default()).expect("a drive");
    let (events, report) = all(Log::of_drive(&drive, &Options::default()));
    assert_eq!((events.len(), report.in_gaps), (2, 9));
    let (events, _) = all(Log::of_drive(&drive, &Options { max_gap_s: 3.0, ..Options::default() }));
    assert_eq!(events.len(), 11);
}

#[test]
fn poses_come_from_transforms_poses_or_a_trajectory() {
    let form = Form::Little;
    let mut messages = vec![mounted(form, flat(MOUNT))];
    for tenth in 0..=20 {
        let odom = ("odom", "base_link", flat(robot(tenth)));
        messages.push(tf(form, tenth, &[odom, ("map", "odom", flat([10.0 + 0.01 * tenth as f64, 0.0, 0.0]))]));
        let pose = message::posed(form, stamp(tenth), "map", robot(tenth));
        messages.push(at("/pose", "geometry_msgs/msg/PoseStamped", tenth, pose));
        messages.push(scan(form, tenth, &[2.0]));
    }
    let (events, _) = read_by(&messages, &pose("tf:odom"));
    assert!(events.iter().enumerate().all(|(k, event)| near(event.scan.pose, seat(k as f64, MOUNT))));
    let (events, report) = read_by(&messages, &pose("tf:map"));
    let [x, y, theta] = seat(7.0, MOUNT);
    assert!(near(events[7].scan.pose, [x + 10.07, y, theta]), "{:?}", events[7].scan.pose);
    assert_eq!(report.poses.as_deref(), Some("transforms below the frame map"));
    assert!(
        read_by(&messages, &pose("/pose"))
            .0
            .iter()
            .enumerate()
            .all(|(k, event)| near(event.scan.pose, seat(k as f64, MOUNT)))
    );
    // Without a topic of odometry, `odom` is the frame.
    assert!(read_by(&messages, &pose("odom")).0.len() == 21);
    let text: String =
        (0..=20).map(|tenth| format!("{} {} 1 0 0 0 0 1\n", START as f64 + 0.1 * f64::from(tenth), tenth)).collect();
    for (body, shift) in [(Body::Robot, 0.5), (Body::Sensor, 0.0)] {
        let options = BagOptions { pose: PoseSource::Elsewhere(body), ..BagOptions::default() };
        let trajectory = Trajectory::read(text.as_bytes(), "t.txt").expect("a trajectory");
        let log = Log::of_drive(&open(&messages, &options).expect("a drive"), &Options::default());
        let (events, _) = all(log.expect("a log").along(trajectory, body));
        assert!((events[4].scan.pose.x_m - 4.0 - shift).abs() < 1e-5, "{:?}", events[4].scan.pose);
    }
}

#[test]
fn a_laser_that_hangs_upside_down_is_turned_over_and_one_that_stands_upright_is_refused() {
    let (straight, _) = read(&drive(Form::Little, 0));
    let mut messages = drive(Form::Little, 0);
    messages[0] = mounted(Form::Little, [0.5, 0.0, 0.2, 1.0, 0.0, 0.0, 0.0]);
    let (events, report) = read(&messages);
    assert!(near(events[3].scan.pose, seat(6.0, [0.5, 0.0, 0.0])));
    assert!(events[3].scan.bearings_rad.iter().zip(&straight[3].scan.bearings_rad).all(|(a, b)| (a + b).abs() < 1e-12));
    assert!(warnings(&report).is_empty(), "{report}");
    let half = std::f64::consts::FRAC_1_SQRT_2;
    messages[0] = mounted(Form::Little, [0.0, 0.0, 0.2, half, 0.0, 0.0, half]);
    assert!(refused(&messages, &BagOptions::default()).contains("tilted by 90 degrees"));
    let (sin, cos) = 0.1f64.sin_cos();
    messages[0] = mounted(Form::Little, [0.0, 0.0, 0.2, 0.0, sin, 0.0, cos]);
    let said = warnings(&read(&messages).1);
    assert!(said.len() == 1 && said[0].contains("tilted by 11 degrees"), "{said:?}");
}

#[test]
fn what_is_not_connected_is_refused_or_mounted_by_option() {
    let mut messages = drive(Form::Little, 0);
    messages[0] =
        at("/tf_static", TF, 0, message::transforms(Form::Little, 0, &[("base_link", "camera", flat(MOUNT))]));
    let message = refused(&messages, &BagOptions::default());
    assert!(message.contains("the frame \"laser\" of /scan is not connected to \"base_link\""), "{message}");
    assert!(message.contains("base_link > camera") && message.contains("--mount X,Y,DEGREES"), "{message}");
    let mount = Some(Pose { x_m: 0.5, y_m: 0.0, theta_rad: PI / 2.0 });
    let (events, report) = read_by(&messages, &BagOptions { mount, ..BagOptions::default() });
    assert!(near(events[2].scan.pose, seat(4.0, MOUNT)) && warnings(&report).is_empty());
    // Without any transform, the sensor is taken to stand where the robot does, which is said.
    let (events, report) = read(&messages[1..]);
    assert!(near(events[2].scan.pose, seat(4.0, [0.0; 3])));
    assert!(warnings(&report)[0].contains("no transform says where the frame \"laser\" of /scan stands"), "{report}");
}

#[test]
fn stamps_that_cannot_be_give_way_to_the_time_of_recording() {
    let mut messages = drive(Form::Little, 0);
    let zero = message::laser(Form::Little, 0, "laser", 0.5, &[2.0]);
    let jumps = message::laser(Form::Little, stamp(90_000), "laser", 0.5, &[2.0]);
    messages.push(at("/scan", LASER, 3, zero));
    messages.push(at("/scan", LASER, 5, jumps));
    let (events, report) = read(&messages);
    assert_eq!(events.len(), 13);
    assert!(near(events[11].scan.pose, seat(3.0, MOUNT)) && near(events[12].scan.pose, seat(5.0, MOUNT)));
    let said = warnings(&report);
    let expected =
        "of 13 messages of /scan, 1 have no stamp, and 1 have a stamp that is far from when they were recorded";
    assert!(said.iter().any(|line| line.contains(expected)), "{said:?}");
}

#[test]
fn the_clock_of_a_simulation_may_be_another_than_the_recorders() {
    let mut messages = drive(Form::Little, 0);
    messages.iter_mut().for_each(|message| message.time_ns += 5_000_000 * S);
    let (events, report) = read(&messages);
    assert!(near(events[4].scan.pose, seat(8.0, MOUNT)) && warnings(&report).is_empty(), "{report}");
}

#[test]
fn damaged_scans_are_counted_and_named_by_their_message() {
    let mut messages = drive(Form::Little, 0);
    messages.push(at("/scan", LASER, 3, message::laser(Form::Little, stamp(3), "laser", 0.0, &[2.0, 2.0])));
    let (events, report) = read(&messages);
    assert_eq!((events.len(), report.damaged, report.problems[0].line), (11, 1, 34));
    assert!(report.problems[0].reason.contains("/scan: angle_min is -1 and angle_increment 0"), "{report}");
    for (bytes, expected) in [
        (message::laser(Form::Little, stamp(5), "laser", 90.0, &[2.0, 2.0]), "are its angles in degrees?"),
        (message::laser(Form::Little, stamp(5), "laser", 0.1, &[]), "a scan of 0 ranges"),
        (message::laser(Form::Little, stamp(5), "laser", 0.1, &[2000.0, 2100.0, 2200.0]), "are they in mm or cm?"),
    ] {
        let drive =
            open(&[&messages[..], &[at("/scan", LASER, 5, bytes)]].concat(), &BagOptions::default()).expect("a drive");
        let mut log =
            Log::of_drive(&drive, &Options { max_range_m: Some(1e9), damaged_share: 0.1, ..Options::default() })
                .expect("a log");
        let last = log.by_ref().last().expect("an end");
        assert!(log.report().problems[1].reason.contains(expected), "{}", log.report());
        assert!(last.is_ok(), "two of 36 messages are damaged");
    }
    let damaged = messages[33].clone();
    messages.extend(std::iter::repeat_n(damaged, 4));
    let drive = open(&messages, &BagOptions::default()).expect("a drive");
    let end = Log::of_drive(&drive, &Options::default()).expect("a log").last().expect("an end").expect_err("5 of 38");
    assert!(end.to_string().starts_with("a.mcap, message 34: /scan: angle_min"), "{end}");
    assert!(end.to_string().contains("5 of 38 messages are damaged"), "{end}");
}

#[test]
fn damage_of_the_file_is_a_warning_and_the_rest_is_read() {
    let messages = drive(Form::Little, 0);
    let whole = mcap::file(&messages, Packing::None, 3, "cdr");
    let cut = Drive::read(whole[..whole.len() - 800].to_vec(), "a.mcap", &BagOptions::default()).expect("a drive");
    let (events, report) = all(Log::of_drive(&cut, &Options::default()));
    assert!(events.len() < 11 && !events.is_empty());
    assert!(warnings(&report)[0].contains("the file ends within"), "{report}");
    let mut flipped = whole;
    let at = flipped.len() - 900;
    flipped[at] ^= 1;
    let drive = Drive::read(flipped, "a.mcap", &BagOptions::default()).expect("a drive");
    let (_, report) = all(Log::of_drive(&drive, &Options::default()));
    assert!(warnings(&report)[0].contains("its CRC-32 is"), "{report}");
}

/// A camera that looks ahead, 1 m above the ground: z forward, x to the right.
const OPTICAL: [f64; 7] = [0.0, 0.0, 1.0, -0.5, 0.5, -0.5, 0.5];

fn camera_drive(kind: &'static str, image: &dyn Fn(u64) -> Vec<u8>) -> Vec<Message> {
    let form = Form::Little;
    let mount = message::transforms(form, 0, &[("base_link", "camera", OPTICAL)]);
    let mut messages = vec![at("/tf_static", TF, 0, mount)];
    let info = message::camera(form, stamp(0), "camera", 50.0, [2.0, 1.0]);
    messages.push(at("/camera/camera_info", "sensor_msgs/msg/CameraInfo", 0, info));
    for tenth in 0..=4 {
        messages.push(odometry(form, tenth));
        messages.push(at("/camera/image", kind, tenth, image(stamp(tenth))));
    }
    messages
}

#[test]
fn images_become_a_row_of_disparities() {
    let form = Form::Little;
    let bearings: Vec<f64> = [2.0f64, 1.0, 0.0, -1.0, -2.0].map(|column| (column / 50.0).atan()).to_vec();
    let mm = |stamp| message::depths_mm(form, stamp, "camera", &[[500; 5], [1000, 2000, 0, 3000, 100], [1500; 5]]);
    let m = |stamp| {
        message::depths_m(form, stamp, "camera", &[[0.5; 5], [1.0, 2.0, f32::NAN, 3.0, 0.1], [f32::INFINITY; 5]])
    };
    let images: [&dyn Fn(u64) -> Vec<u8>; 2] = [&mm, &m];
    for image in images {
        let (events, report) = read(&camera_drive("sensor_msgs/msg/Image", image));
        assert_eq!((events.len(), events[0].kind), (5, Sensor::Stereo));
        assert!(near(events[3].scan.pose, robot(3)), "{:?}", events[3].scan.pose);
        assert!(events[0].scan.bearings_rad.iter().zip(&bearings).all(|(a, b)| (a - b).abs() < 1e-12));
        let found = &events[0].scan.readings;
        let expected = [Some(15.0), Some(7.5), None, Some(5.0), Some(150.0)];
        assert!(
            found
                .iter()
                .zip(expected)
                .all(|(a, b)| a.is_some() == b.is_some() && (a.unwrap_or(0.0) - b.unwrap_or(0.0)).abs() < 1e-4),
            "{found:?}"
        );
        assert!(warnings(&report).is_empty(), "{report}");
        // The nearest of all rows.
        let (events, _) =
            read_by(&camera_drive("sensor_msgs/msg/Image", image), &BagOptions { rows: 3, ..BagOptions::default() });
        assert_eq!(events[0].scan.readings[..3], [Some(30.0); 3]);
    }
    let px =
        |stamp| message::disparities(form, stamp, "camera", &[[40.0; 5], [8.0, 0.5, f32::NAN, 16.0, 70.0], [1.0; 5]]);
    let messages = camera_drive("stereo_msgs/msg/DisparityImage", &px);
    let drive = open(&messages, &BagOptions::default()).expect("a drive");
    let camera = drive.camera().expect("a camera");
    assert!((camera.focal_baseline - 15.0).abs() < 1e-5 && camera.max_disparity_px == Some(64.0));
    let (events, report) = all(Log::of_drive(&drive, &Options { max_disparity_px: Some(64.0), ..Options::default() }));
    assert_eq!(events[0].scan.readings, [Some(8.0), None, None, Some(16.0), None]);
    assert_eq!(report.codes.large, 5);
}

#[test]
fn depths_without_a_camera_are_refused_and_a_body_frame_is_said() {
    let mm = |stamp| message::depths_mm(Form::Little, stamp, "camera", &[[500; 5]; 3]);
    let mut messages = camera_drive("sensor_msgs/msg/Image", &mm);
    messages[0] =
        at("/tf_static", TF, 0, message::transforms(Form::Little, 0, &[("base_link", "camera", flat([0.0; 3]))]));
    let (events, report) = read(&messages);
    assert!(near(events[2].scan.pose, robot(2)), "{:?}", events[2].scan.pose);
    assert!(warnings(&report)[0].contains("is none of a camera"), "{report}");
    messages.remove(1);
    assert!(refused(&messages, &BagOptions::default()).contains("no CameraInfo"));
}

#[test]
fn a_choice_is_left_to_the_user_with_all_that_there_is() {
    let form = Form::Little;
    let mut messages = drive(form, 0);
    messages.extend((0..=20).map(|tenth| tf(form, tenth, &[("map", "base_link", flat(robot(tenth)))])));
    let Err(LogError::Undecided { reason, contents, .. }) = open(&messages, &BagOptions::default()) else {
        panic!("a choice")
    };
    assert!(reason.contains("has 2 sources of poses, odom, tf:map: choose one by --pose"), "{reason}");
    let listed = contents.to_string();
    assert!(listed.contains("/scan       sensor_msgs/LaserScan        11       0.00       2.00"), "{listed}");
    assert!(
        listed.contains("scans: /scan\n") && listed.contains("tf:map (transforms from map to the sensor)"),
        "{listed}"
    );
    let second = |tenth| at("/rear", LASER, tenth, message::laser(form, stamp(tenth), "base_link", 0.5, &[2.0]));
    messages.extend((0..=20).map(second));
    let message = refused(&messages, &pose("odom"));
    assert!(message.contains("has 2 topics of scans, /rear, /scan: name those to be read by --scan"), "{message}");
    // Both are sensors of one log, in the order in which they were named.
    let both = BagOptions { scans: vec!["scan".to_owned(), "/rear".to_owned()], ..pose("odom") };
    let (events, report) = read_by(&messages, &both);
    let named: Vec<_> = report.sensors.values().map(|sensor| (sensor.name.as_str(), sensor.scans)).collect();
    assert_eq!(named, [("/scan", 11), ("/rear", 21)]);
    let rear = events.iter().rfind(|event| event.sensor == 1).expect("one of the rear");
    assert!(near(rear.scan.pose, robot(20)));
}

#[test]
fn what_is_not_there_is_named_with_what_is() {
    let messages = drive(Form::Little, 0);
    let scans = |name: &str| BagOptions { scans: vec![name.to_owned()], ..BagOptions::default() };
    for (options, expected) in [
        (scans("/front"), "--scan /front: the bag has no such topic; it has /scan"),
        (scans("/odom"), "--scan /odom: is of type nav_msgs/Odometry, and scans are"),
        (BagOptions { scans: vec!["/scan".to_owned(); 2], ..BagOptions::default() }, "is given twice"),
        (
            pose("/amcl_pose"),
            "--pose /amcl_pose: the bag has no such topic, and there is no such file; the bag has odom",
        ),
        (pose("/scan"), "--pose /scan: is of type sensor_msgs/LaserScan, and poses are"),
        (pose("tf:map"), "no transform has the frame map; there are base_link > laser"),
    ] {
        let message = refused(&messages, &options);
        assert!(message.contains(expected), "{message}");
    }
    let only = |topic: &str| messages.iter().filter(|message| message.topic == topic).cloned().collect::<Vec<_>>();
    assert!(refused(&only("/odom"), &BagOptions::default()).contains("has no topic of scans"));
    assert!(refused(&only("/scan"), &BagOptions::default()).contains("has no source of poses"));
    assert!(refused(&only("/scan"), &pose("odom")).contains("neither a topic of nav_msgs/Odometry nor a frame odom"));
    assert!(refused(&[], &BagOptions::default()).contains("it is empty"));
}

#[test]
fn a_path_is_enough_where_there_is_no_choice() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.db3");
    std::fs::write(&path, db3::file(&drive(Form::Big, 0))).expect("writable");
    let (events, report) = all(Log::open(&path, &Options::default()));
    assert_eq!((events.len(), report.skipped["/odom"]), (11, 21));
    // The folder of the recorder as well.
    assert_eq!(all(Log::open(folder.path(), &Options::default())).0.len(), 11);
    let said: Vec<String> = report.findings().iter().map(ToString::to_string).collect();
    assert!(said.iter().any(|line| line.contains("scans are those of /scan, poses come from /odom")), "{said:?}");
}
