//! What fuzzing has found, as tests.

use logs::{Log, Options};

#[test]
fn a_sensor_with_readings_in_two_columns_is_one_damaged_line() {
    let table =
        "scan,sensor,bearing_rad,disparity_px,x_m,y_m,theta_rad,sonar_m\n0,0,0,9,1,2,0,\n2,1,0.2,4,1.2,2,0.1,7\n";
    let mut log = Log::table(table.as_bytes(), "a.csv", &Options::default()).expect("a table");
    assert_eq!(log.by_ref().filter(Result::is_ok).count(), 1);
    let report = log.report();
    assert_eq!((report.lines, report.damaged, report.problems.len()), (3, 1, 1), "{report}");
}
