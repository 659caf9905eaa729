use super::*;
use crate::commands::sweep::parameters::ParameterKind;

fn axes(text: &str) -> Result<Sweep, Error> {
    parse(&format!("scene = \"a.toml\"\nmappers = [\"prior\"]\n{text}"), "s.toml")
}

fn numbers(axis: &Axis) -> Vec<f64> {
    let number = |step: &Vec<Value>| match step.as_slice() {
        [Value::Number(number)] => *number,
        other => panic!("{other:?}"),
    };
    axis.steps.iter().map(number).collect()
}

#[test]
fn ranges_hold_both_ends_and_the_numbers_that_were_meant() {
    let sweep = axes("[vary]\ngrid = { from = 0.1, to = 0.5, steps = 5 }").expect("valid");
    assert_eq!(format!("{:?}", numbers(&sweep.axes[0])), "[0.1, 0.2, 0.3, 0.4, 0.5]");
    let sweep = axes("[vary]\ngrid = { from = 0.01, to = 10.0, steps = 4, log = true }").expect("valid");
    assert_eq!(format!("{:?}", numbers(&sweep.axes[0])), "[0.01, 0.1, 1.0, 10.0]");
}

#[test]
fn every_combination_once_and_pairs_together() {
    let text = "[set]\nprior = 0.2\n[vary]\ngrid = [0.1, 0.2, 0.5]\nmismatches = [\"independent\", \"clustered\"]\n\
                [paired]\ndisparity_sigma = [0.5, 1.0]\nbelieved_sigma = [0.6, 0.7]";
    let sweep = axes(text).expect("valid");
    assert_eq!((sweep.settings_count(), sweep.jobs()), (Some(12), Some(12)));
    let all: Vec<Settings> = (0..12).map(|number| sweep.settings(number)).collect();
    for (k, settings) in all.iter().enumerate() {
        assert!(!all[..k].contains(settings), "{settings:?} twice");
        assert_eq!(settings.len(), 5);
        assert_eq!(settings["prior"], Value::Number(0.2));
        let first = settings["disparity_sigma"] == Value::Number(0.5);
        assert_eq!(settings["believed_sigma"], Value::Number(if first { 0.6 } else { 0.7 }));
    }
    assert_eq!(sweep.keys(), ["disparity_sigma", "mismatches", "grid", "prior", "believed_sigma"]);
}

#[test]
fn every_parameter_is_refused_beyond_its_bounds_with_its_place() {
    for parameter in &PARAMETERS {
        let (wrong, bound) = match &parameter.kind {
            ParameterKind::Number(limit) | ParameterKind::Both(limit) | ParameterKind::Whole(limit) => {
                (vec!["-1.0", "1e9", "nan", "\"x\"", "true"], limit.bound)
            }
            ParameterKind::Word(_) => (vec!["1", "\"x\"", "[]"], "one of "),
        };
        for value in wrong {
            for (section, given) in [("set", value.to_owned()), ("vary", format!("[{value}]"))] {
                let key = parameter.key;
                let text = format!("[{section}]\n{key} = {given}");
                let error = axes(&text).expect_err(&text).to_string();
                let column = key.len() + if section == "set" { 4 } else { 5 };
                assert!(error.contains(&format!("s.toml:4:{column}: [{section}]: {key} = ")), "{text}: {error}");
                assert!(error.contains(bound), "{text}: {error}");
            }
        }
    }
}

#[test]
fn ranges_that_cannot_be() {
    for (range, expected) in [
        ("{ from = 0.1, to = 0.1, steps = 3 }", "to above from"),
        ("{ from = 0.1, to = 1.0, steps = 1 }", "steps = 1"),
        ("{ from = 0.1, to = 1.0, steps = 2.5 }", "steps = 2.5"),
        ("{ from = 0.1, to = 1.0, steps = 3, log = 1 }", "true or false"),
        ("{ from = 0.1, to = 1.0, step = 3 }", "unknown key `step`"),
        ("{ to = 1.0, steps = 3 }", "`from` is missing"),
        ("{ from = 0.1, to = 99.0, steps = 3 }", "to = 99"),
        ("[]", "a list of at least one value"),
    ] {
        let error = axes(&format!("[vary]\ngrid = {range}")).expect_err(range).to_string();
        assert!(error.contains(expected) && error.contains("s.toml:4:"), "{range}: {error}");
    }
    let words = axes("[vary]\nmismatches = { from = 0.0, to = 1.0, steps = 2 }").expect_err("words").to_string();
    assert!(words.contains("a range is for numbers"), "{words}");
    let zero = axes("[vary]\nprior = { from = 0.0, to = 1.0, steps = 3, log = true }").expect_err("zero").to_string();
    assert!(zero.contains("from above 0"), "{zero}");
}
