use super::*;

const SMALL: &str = "cells = 3
cell_size = 0.05
observation = 10.0
prior = 0.1
correlation = [0.5, 0.25]
";

fn refusal(out: &str, put: &str) -> String {
    assert!(SMALL.contains(out), "{out}");
    let text = if out.is_empty() { format!("{SMALL}{put}\n") } else { SMALL.replacen(out, put, 1) };
    let message = parse(&text, "r.toml").expect_err(&text).to_string();
    assert!(!message.contains('\n'), "one line: {message}");
    message
}

#[test]
fn numbers_and_lists() {
    let ray = parse(SMALL, "r.toml").expect("valid");
    assert_eq!(ray.prior, [0.1; 3]);
    assert_eq!(ray.correlation, [0.5, 0.25]);
    assert_eq!((ray.onward, ray.no_hit_likelihood, ray.stereo), (0.25, None, sensor::Stereo::default()));
    let one =
        parse("cells = 1\ncell_size = 0.1\nobservation = 3\nprior = [1]\ncorrelation = 0.5", "r.toml").expect("valid");
    assert_eq!((one.prior.len(), one.correlation.len(), one.onward), (1, 0, 0.5));
}

#[test]
fn what_is_written_reads_back_as_the_same_ray() {
    let mut ray = parse(SMALL, "r.toml").expect("valid");
    ray.prior = (0..30).map(|k| 1.0 / f64::from(k + 3)).collect();
    ray.correlation = vec![0.1; 29];
    for (onward, no_hit_likelihood) in [(0.1, Some(1e-7)), (0.1, None)] {
        (ray.onward, ray.no_hit_likelihood) = (onward, no_hit_likelihood);
        assert_eq!(parse(&text(&ray, "a\nb"), "r.toml").expect("valid"), ray);
    }
}

#[test]
fn every_refusal_says_where_what_and_what_to_do() {
    let known = "known keys: cells, cell_size, observation, prior, correlation, no_hit_likelihood, sensor";
    let cases = [
        (
            "prior = 0.1",
            "prio = 0.1",
            &*format!("r.toml:4:1: the ray: unknown key `prio` (did you mean `prior`?); {known}"),
        ),
        (
            "cells = 3\n",
            "",
            "r.toml:1:1: the ray: `cells` is missing; add `cells = ...`, a whole number from 1 to 100000",
        ),
        (
            "cell_size = 0.05\n",
            "",
            "r.toml:1:1: the ray: `cell_size` is missing; add `cell_size = ...`, a cell size in m, 0.0001 to 1000",
        ),
        (
            "observation = 10.0\n",
            "",
            "r.toml:1:1: the ray: `observation` is missing; add `observation = ...`, a disparity in px, 0 to 1000000",
        ),
        ("prior = 0.1\n", "", "r.toml:1:1: the ray: `prior` is missing; add `prior = ...`, a probability, 0 to 1"),
        (
            "correlation = [0.5, 0.25]\n",
            "",
            "r.toml:1:1: the ray: `correlation` is missing; add `correlation = ...`, a correlation, -1 to 1",
        ),
        (
            "cells = 3",
            "cells = 2.5",
            "r.toml:1:9: the ray: cells = 2.5: must be a whole number from 1 to 100000; give the number of cells, such as 60",
        ),
        (
            "cells = 3",
            "cells = 100001",
            "r.toml:1:9: the ray: cells = 100001: must be a whole number from 1 to 100000; give the number of cells, such as 60",
        ),
        (
            "cells = 3",
            "cells = 0",
            "r.toml:1:9: the ray: cells = 0: must be a whole number from 1 to 100000; give the number of cells, such as 60",
        ),
        (
            "0.05",
            "-0.05",
            "r.toml:2:13: the ray: cell_size = -0.05: must be a cell size in m, 0.0001 to 1000; give the length of the ray in a cell, such as 0.05",
        ),
        (
            "10.0",
            "\"far\"",
            "r.toml:3:15: the ray: observation = \"far\": must be a disparity in px, 0 to 1000000; give the reading, such as 10.0",
        ),
        (
            "10.0",
            "61.0",
            "r.toml:3:15: the ray: observation = 61.0: must be at most max_disparity = 60 px; the matcher searches no further; lower the reading, or raise max_disparity in [sensor]",
        ),
        (
            "prior = 0.1",
            "prior = 1.1",
            "r.toml:4:9: the ray: prior = 1.1: must be a probability, 0 to 1; give one number such as 0.1, or a list with one per cell",
        ),
        (
            "prior = 0.1",
            "prior = nan",
            "r.toml:4:9: the ray: prior = nan: must be a probability, 0 to 1; give one number such as 0.1, or a list with one per cell",
        ),
        (
            "prior = 0.1",
            "prior = [0.1, -0.2, 0.3]",
            "r.toml:4:15: the ray: prior = -0.2: must be a probability, 0 to 1; give one number such as 0.1, or a list with one per cell",
        ),
        (
            "prior = 0.1",
            "prior = [0.1, 0.2]",
            "r.toml:4:9: the ray: prior = [0.1, 0.2]: must be one number, or a list of 3, one per cell; this list has 2; give one number such as 0.1, or a list with one per cell",
        ),
        (
            "[0.5, 0.25]",
            "[0.5]",
            "r.toml:5:15: the ray: correlation = [0.5]: must be one number, or a list of 2, one per pair of neighbours; this list has 1; give one number such as 0.871, or a list with one per pair of neighbouring cells",
        ),
        (
            "[0.5, 0.25]",
            "-1.5",
            "r.toml:5:15: the ray: correlation = -1.5: must be a correlation, -1 to 1; give one number such as 0.871, or a list with one per pair of neighbouring cells",
        ),
        (
            "[0.5, 0.25]",
            "[0.5, inf]",
            "r.toml:5:21: the ray: correlation = inf: must be a correlation, -1 to 1; give one number such as 0.871, or a list with one per pair of neighbouring cells",
        ),
        (
            "",
            "no_hit_likelihood = -1",
            "r.toml:6:21: the ray: no_hit_likelihood = -1: must be a density in 1/px, 0 to 1000000; give the likelihood of the reading if no cell is occupied, or leave it out to let the prior go on past the last cell",
        ),
        ("", "sensor = 3", "r.toml:6:10: the ray: sensor = 3: must be a table; write [sensor] and its keys below"),
        (
            "",
            "[sensor]\nfocal_base = 1",
            "r.toml:7:1: [sensor]: unknown key `focal_base` (did you mean `focal_baseline`?); known keys: focal_baseline, disparity_sigma, correct_match, max_disparity",
        ),
        (
            "",
            "[sensor]\nfocal_baseline = 0",
            "r.toml:7:18: [sensor]: focal_baseline = 0: must be a positive number in px·m, 0.000001 to 1000000; give focal length times baseline, such as 15",
        ),
        (
            "",
            "[sensor]\ndisparity_sigma = -1.0",
            "r.toml:7:19: [sensor]: disparity_sigma = -1.0: must be a positive number in px, 0.000001 to 1000; give a standard deviation such as 0.5",
        ),
        (
            "",
            "[sensor]\ncorrect_match = 1.5",
            "r.toml:7:17: [sensor]: correct_match = 1.5: must be a probability, 0 to 1; give a number such as 0.8",
        ),
        (
            "",
            "[sensor]\nmax_disparity = 0",
            "r.toml:7:17: [sensor]: max_disparity = 0: must be a positive number in px, 0.001 to 1000000; give the largest disparity searched, such as 60",
        ),
        ("", "cells = 4", "r.toml:6:1: no valid TOML: duplicate key"),
    ];
    for (out, put, message) in cases {
        assert_eq!(refusal(out, put), message);
    }
}
