use super::*;
use crate::worlds::criteria::criterion;

const SEEDS: u64 = 8;

fn gate(metric: &str, demand: Demand) -> Gate {
    let world =
        |seed| WorldId { family: format!("f{}", seed % 2), condition: "as-believed".to_owned(), cell_um: None, seed };
    Gate {
        name: "g".to_owned(),
        mapper: "ours".to_owned(),
        criterion: criterion(metric).expect("a metric"),
        region: "observable".to_owned(),
        worlds: (0..SEEDS).map(world).collect(),
        demand,
    }
}

fn values(gate: &Gate, mapper: &str, value: impl Fn(u64) -> Option<f64>) -> Values {
    gate.keys(mapper).map(|key| (key.clone(), value(key.world.seed))).collect()
}

/// The outcome where ours is the baseline of 0.5, and so much more.
fn against_baseline(metric: &str, margin: f64, more: impl Fn(u64) -> Option<f64>) -> Outcome {
    let gate = gate(metric, Demand::NotWorseThanBaselineBy(margin));
    let ours = values(&gate, "ours", |seed| more(seed).map(|more| 0.5 + more));
    let measured = Measured { values: ours, failures: BTreeMap::new() };
    let baseline = values(&gate, "ours", |_| Some(0.5));
    judge(&[gate], &measured, &baseline).expect("judged").remove(0)
}

#[test]
fn worse_than_the_baseline_needs_the_margin_and_the_interval() {
    let verdict =
        |metric, margin, more: fn(u64) -> f64| against_baseline(metric, margin, |seed| Some(more(seed))).verdict;
    let steady = |seed: u64| 0.01 + 0.0001 * seed as f64;
    assert_eq!(verdict("log_loss", 0.005, steady), Verdict::Fail);
    assert_eq!(verdict("log_loss", 0.02, steady), Verdict::Pass, "within the margin, however sure");
    assert_eq!(verdict("retention", 0.005, steady), Verdict::Pass, "more is better");
    assert_eq!(verdict("retention", 0.005, |seed| -0.01 - 0.0001 * seed as f64), Verdict::Fail);
    let wild = |seed: u64| if seed == 0 { 0.5 } else { -0.02 };
    assert!(against_baseline("log_loss", 0.005, |seed| Some(wild(seed))).difference.expect("paired") > 0.04);
    assert_eq!(verdict("log_loss", 0.005, wild), Verdict::Pass, "one world of eight is not sure");
    assert_eq!(verdict("log_loss", 0.0, |_| 0.0), Verdict::Pass, "the same is not worse, without any margin");
    assert_eq!(verdict("log_loss", 0.0, |_| 1e-6), Verdict::Fail, "the least is, without any margin");
}

#[test]
fn better_by_more_than_the_margin_is_worth_a_word() {
    assert!(against_baseline("log_loss", 0.005, |seed| Some(-0.01 - 0.0001 * seed as f64)).outgrown());
    assert!(!against_baseline("log_loss", 0.02, |seed| Some(-0.01 - 0.0001 * seed as f64)).outgrown());
    assert!(!against_baseline("log_loss", 0.005, |seed| Some(0.01 + 0.0001 * seed as f64)).outgrown());
}

#[test]
fn a_value_that_is_lost_is_an_error_and_one_that_is_found_is_not() {
    let lost = against_baseline("iou", 0.1, |seed| Some(0.0).filter(|_| seed != 3));
    assert_eq!(lost.verdict, Verdict::Error);
    let cause = lost.cause.expect("a cause");
    assert_eq!(cause, "the metric has lost its value on 1 of 8 worlds, first on f1 as-believed seed 3");
    assert_eq!(against_baseline("iou", 0.1, |_| None).cause.as_deref(), Some("the metric has no value on any world"));

    let gate = gate("iou", Demand::NotWorseThanBaselineBy(0.1));
    let measured = Measured { values: values(&gate, "ours", |_| Some(0.5)), failures: BTreeMap::new() };
    let baseline = values(&gate, "ours", |seed| Some(0.5).filter(|_| seed != 3));
    let found = judge(&[gate], &measured, &baseline).expect("judged").remove(0);
    assert_eq!((found.verdict, found.defined), (Verdict::Pass, 8));
}

#[test]
fn bounds_include_themselves() {
    for (demand, expected) in [
        (Demand::AtMost(0.25), Verdict::Pass),
        (Demand::AtMost(0.2499), Verdict::Fail),
        (Demand::AtLeast(0.25), Verdict::Pass),
        (Demand::AtLeast(0.2501), Verdict::Fail),
    ] {
        let gate = gate("decided", demand.clone());
        // Half of the worlds have a value: their mean is judged, and their number kept.
        let ours = values(&gate, "ours", |seed| Some(0.25).filter(|_| seed % 2 == 0));
        let measured = Measured { values: ours, failures: BTreeMap::new() };
        let outcome = judge(&[gate], &measured, &Values::new()).expect("judged").remove(0);
        assert_eq!((outcome.verdict, outcome.defined), (expected, 4), "{demand:?}");
    }
}

#[test]
fn better_than_another_needs_all_of_the_interval_beyond_the_difference() {
    for (metric, sign) in [("log_loss", -1.0), ("auc", 1.0)] {
        for (by, expected) in
            [(0.0, Verdict::Pass), (0.099, Verdict::Pass), (0.103, Verdict::Fail), (0.2, Verdict::Fail)]
        {
            let gate = gate(metric, Demand::BetterThan { mapper: "theirs".to_owned(), by });
            let mut measured = Measured::default();
            measured.values.extend(values(&gate, "theirs", |_| Some(0.5)));
            measured.values.extend(values(&gate, "ours", |seed| Some(0.5 + sign * (0.1 + 0.001 * seed as f64))));
            let outcome = judge(&[gate], &measured, &Values::new()).expect("judged").remove(0);
            assert_eq!(outcome.verdict, expected, "{metric} {by}: {:?}", outcome.interval);
        }
    }
}

#[test]
fn families_come_the_worst_first() {
    let outcome = against_baseline("retention", 0.001, |seed| Some(if seed % 2 == 0 { -0.02 } else { -0.01 }));
    let names: Vec<&str> = outcome.families.iter().map(|(family, _)| family.as_str()).collect();
    assert_eq!(names, ["f0", "f1"]);
    assert!((outcome.families[0].1 + 0.02).abs() < 1e-12);
}
