//! Values in the place of a rule's own.

use mapper::{ConventionalRule, Field, LogOdds, Tuning};

#[test]
fn nothing_given_changes_nothing() {
    let none = Tuning::default();
    assert_eq!(ConventionalRule::TUNED.tuned(&none), ConventionalRule::TUNED);
    assert_eq!(LogOdds::OCTOMAP.tuned(&none), LogOdds::OCTOMAP);
    assert_eq!(Field::TUNED.tuned(&none), Field::TUNED);
}

#[test]
fn each_value_takes_its_place() {
    let tuning = Tuning {
        half_width: Some(0.7),
        clamp_high: Some(0.002),
        hit: Some(0.9),
        miss: Some(0.3),
        start: Some(0.1),
        coupling: Some(0.3),
        damping: Some(0.0),
        sweeps: Some(7),
        ..Tuning::default()
    };
    let rule = ConventionalRule::TUNED.tuned(&tuning);
    assert_eq!(rule, ConventionalRule { half_width: 0.7, clamp: [0.002, 0.002] });
    let increments = LogOdds::OCTOMAP.tuned(&tuning);
    assert_eq!(increments, LogOdds { hit: 0.9, miss: 0.3, start: 0.1, clamp: [0.002, 0.002], ..LogOdds::OCTOMAP });
    assert_eq!(Field::TUNED.tuned(&tuning), Field { coupling: 0.3, damping: 0.0, sweeps: 7, ..Field::TUNED });
}
