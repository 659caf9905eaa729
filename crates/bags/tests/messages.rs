//! Messages of every type in every encoding say the same.

mod writer;

use bags::Encoding;
use bags::messages::{CameraInfo, DisparityImage, Header, Image, LaserScan, Odometry, PoseStamped, Transforms};
use proptest::prelude::*;
use writer::message::{self, FORMS, Form, S};

fn encoding(form: Form) -> Encoding {
    if form == Form::Ros1 { Encoding::Ros1 } else { Encoding::Cdr }
}

/// To the bit.
fn same<const N: usize>(found: [f64; N], expected: [f64; N]) -> bool {
    found.map(f64::to_bits) == expected.map(f64::to_bits)
}

const STAMP: u64 = 12 * S + 345;

#[test]
fn a_laser_scan_is_its_numbers() {
    for form in FORMS {
        let bytes = message::laser(form, STAMP, "/laser", 0.25, &[1.5, f32::INFINITY, 2.5]);
        let scan = LaserScan::read(encoding(form), &bytes).expect("whole");
        assert_eq!(scan.header, Header { stamp_ns: STAMP as i64, frame: "laser".to_owned() }, "{form:?}");
        assert!(same([scan.first_rad, scan.step_rad, scan.last_rad, scan.max_m], [-1.0, 0.25, -0.5, 10.0]));
        assert_eq!(scan.ranges_m, [1.5, f64::INFINITY, 2.5]);
    }
}

#[test]
fn poses_and_transforms_are_read() {
    for form in FORMS {
        let odometry = message::odometry(form, STAMP, "base_link", [1.0, 2.0, 0.0]);
        let odometry = Odometry::read(encoding(form), &odometry).expect("whole");
        assert_eq!((odometry.child.as_str(), odometry.pose.at_m), ("base_link", [1.0, 2.0, 0.3]), "{form:?}");
        let posed =
            PoseStamped::read(encoding(form), &message::posed(form, STAMP, "map", [1.0, 2.0, 0.0])).expect("whole");
        assert_eq!((posed.header.frame.as_str(), posed.pose.turn), ("map", [0.0, 0.0, 0.0, 1.0]));
        let all =
            [("odom", "base", message::flat([3.0, 4.0, 0.0])), ("base", "a longer name", message::flat([0.0; 3]))];
        let all = Transforms::read(encoding(form), &message::transforms(form, STAMP, &all)).expect("whole").0;
        assert!(same(all[0].pose.at_m, [3.0, 4.0, 0.0]));
        assert_eq!((all[1].header.frame.as_str(), all[1].child.as_str()), ("base", "a longer name"));
    }
}

#[test]
fn images_are_read_row_by_row() {
    for form in FORMS {
        let mm = message::depths_mm(form, STAMP, "camera", &[[0, 1, 2, 3, 4], [1000, 0, 2500, 65535, 1], [9; 5]]);
        let image = Image::read(encoding(form), &mm).expect("whole");
        let rows = image.depths_m(1..2).expect("there");
        assert!(rows[0][1].is_nan(), "0 mm is no depth");
        assert!(same([rows[0][0], rows[0][2], rows[0][3]], [1.0, 2.5, 65.535]));
        assert!(image.depths_m(2..4).is_err(), "there are three rows");
        let m = message::depths_m(form, STAMP, "camera", &[[1.0; 5], [2.5; 5], [f32::NAN; 5]]);
        assert_eq!(Image::read(encoding(form), &m).expect("whole").depths_m(1..2), Ok(vec![vec![2.5; 5]]));
        let px =
            message::disparities(form, STAMP, "camera", &[[0.5; 5], [f32::INFINITY, 3.0, 1.0, 0.0, -1.0], [2.0; 5]]);
        let image = DisparityImage::read(encoding(form), &px).expect("whole");
        assert!((image.focal_px * image.baseline_m - 15.0).abs() < 1e-6 && image.max_px > 63.0);
        let rows = image.disparities_px(0..2).expect("there");
        assert!(rows[0].iter().all(|disparity| disparity.is_nan()), "below the least");
        assert_eq!(rows[1][..3], [f64::INFINITY, 3.0, 1.0]);
        let camera = message::camera(form, STAMP, "camera", 50.0, [2.25, 1.0]);
        let camera = CameraInfo::read(encoding(form), &camera).expect("whole");
        assert_eq!((camera.focal_px, camera.centre_px), (50.0, [2.25, 1.0]), "{form:?}");
    }
}

#[test]
fn lengths_are_claims() {
    for form in FORMS {
        let mut bytes = message::laser(form, STAMP, "laser", 0.25, &[]);
        let at = bytes.len() - 8;
        bytes[at..at + 4].copy_from_slice(&[0xff; 4]);
        let reason = LaserScan::read(encoding(form), &bytes).expect_err("four thousand million ranges");
        assert!(reason.contains("fewer than the 17179869180 more"), "{reason}");
        let transforms = message::transforms(form, STAMP, &[]);
        let claim = [&transforms[..transforms.len() - 4], &[0xff; 4]].concat();
        assert!(Transforms::read(encoding(form), &claim).is_err());
    }
    assert!(Header::read(Encoding::Cdr, &[0, 3, 0, 0, 0]).expect_err("a list of parameters").contains("00 03"));
    assert!(Header::read(Encoding::Other, &[]).is_err());
}

proptest! {
    #[test]
    fn cut_messages_are_errors(form in prop::sample::select(&FORMS[..]), ranges in prop::collection::vec(0.0f32..9.0, 1..9), cut in 0.0..1.0f64) {
        let bytes = message::laser(form, STAMP, "laser", 0.1, &ranges);
        let whole = LaserScan::read(encoding(form), &bytes).expect("whole");
        prop_assert_eq!(whole.ranges_m.len(), ranges.len());
        // The list of intensities behind is not read.
        let cut = (cut * (bytes.len() - 4) as f64) as usize;
        prop_assert!(LaserScan::read(encoding(form), &bytes[..cut]).is_err());
    }

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..200), is_cdr in any::<bool>()) {
        let form = if is_cdr { Encoding::Cdr } else { Encoding::Ros1 };
        let _ = (Odometry::read(form, &bytes), PoseStamped::read(form, &bytes), Transforms::read(form, &bytes));
        if let Ok(image) = Image::read(form, &bytes) {
            let _ = (image.depths_m(0..1), image.depths_m(0..image.height.min(9)));
        }
        if let Ok(image) = DisparityImage::read(form, &bytes) {
            let _ = image.disparities_px(0..1);
        }
        let _ = (CameraInfo::read(form, &bytes), LaserScan::read(form, &bytes));
    }
}
