//! `ray` against the definitions, taken literally: the sum over all 2^N states of files drawn at random. Nothing here uses the crates.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

use crate::checked::checked;

fn run(folder: &Path, code: i32, args: &[&str]) -> (String, String) {
    let mut command = Command::cargo_bin("experiments").expect("built");
    let output = command.current_dir(folder).args(args).output().expect("runs");
    checked(code, &args, &output)
}

fn place() -> TempDir {
    tempfile::tempdir().expect("temporary folder")
}

/// A ray as its file says it.
#[derive(Debug, Clone)]
struct Ray {
    cell_size: f64,
    observation: f64,
    prior: Vec<f64>,
    correlation: Vec<f64>,
    no_hit: Option<f64>,
    /// Focal length times baseline, standard deviation, correct matches, search range.
    sensor: [f64; 4],
}

impl Ray {
    fn toml(&self) -> String {
        let Self { cell_size, observation, prior, correlation, no_hit, sensor: [fb, sigma, correct, search] } = self;
        let no_hit = no_hit.map_or_else(String::new, |l| format!("no_hit_likelihood = {l:?}\n"));
        format!(
            "cells = {}\ncell_size = {cell_size:?}\nobservation = {observation:?}\nprior = {prior:?}\n\
             correlation = {correlation:?}\n{no_hit}[sensor]\nfocal_baseline = {fb:?}\ndisparity_sigma = {sigma:?}\n\
             correct_match = {correct:?}\nmax_disparity = {search:?}\n",
            prior.len()
        )
    }

    /// `P(o | F_k)`, Eq. (21), as design and README define it; `k` may lie beyond the last cell.
    fn likelihood(&self, k: usize) -> f64 {
        let [fb, sigma, correct, search] = self.sensor;
        let floor = (1.0 - correct) / search;
        if k == 0 {
            return floor; // from the sensor itself all disparities are spanned
        }
        let [near, far] = [k, k + 1].map(|k| fb / (k as f64 * self.cell_size));
        let phi = |x: f64| 0.5 * libm::erfc(-x / 2f64.sqrt());
        let (high, low) = ((near - self.observation) / sigma, (far - self.observation) / sigma);
        let gaussian = if high - low > 1e-4 {
            // From the upper tail where both are in it: there Phi would round to one.
            let inside = if low > 0.0 { phi(-low) - phi(-high) } else { phi(high) - phi(low) };
            inside / (near - far)
        } else {
            let middle = 0.5 * (high + low);
            (-0.5 * middle * middle).exp() / (sigma * (2.0 * std::f64::consts::PI).sqrt())
        };
        correct * gaussian + floor
    }

    fn both(p: f64, q: f64, c: f64) -> f64 {
        let joint = p * q + c * (p * (1.0 - p) * q * (1.0 - q)).sqrt();
        joint.max((p + q - 1.0).max(0.0)).min(p.min(q))
    }

    /// The sum over the cells past the end, until a mass of 1e-9 is left.
    fn none(&self) -> f64 {
        if let Some(given) = self.no_hit {
            return given;
        }
        let p = self.prior[self.prior.len() - 1];
        let c = self.correlation.last().copied().unwrap_or(0.0);
        let onset = if p < 1.0 { (p - Self::both(p, p, c)) / (1.0 - p) } else { 1.0 };
        assert!(onset > 1e-5, "a sum that ends");
        let (mut sum, mut mass, mut k) = (0.0, 1.0, self.prior.len());
        while mass >= 1e-9 {
            sum += mass * onset * self.likelihood(k);
            mass *= 1.0 - onset;
            k += 1;
        }
        sum
    }

    /// Evidence, marginals and joints by enumeration.
    fn enumerate(&self) -> (f64, Vec<f64>, Vec<[f64; 4]>) {
        let n = self.prior.len();
        let likelihood: Vec<f64> = (0..n).map(|k| self.likelihood(k)).collect();
        let none = self.none();
        let (mut evidence, mut marginals, mut joints) = (0.0, vec![0.0; n], vec![[0.0; 4]; n - 1]);
        for states in 0..1usize << n {
            let occupied = |j: usize| states >> j & 1 == 1;
            let single = |j: usize| if occupied(j) { self.prior[j] } else { 1.0 - self.prior[j] };
            let mut weight = single(0);
            for j in 0..n - 1 {
                if single(j) <= 0.0 || single(j + 1) <= 0.0 {
                    weight = 0.0; // a state that never occurs, whatever rounding says of its pair
                    break;
                }
                let (p, q) = (self.prior[j], self.prior[j + 1]);
                let r = Self::both(p, q, self.correlation[j]);
                let joint = match (occupied(j), occupied(j + 1)) {
                    (true, true) => r,
                    (true, false) => p - r,
                    (false, true) => q - r,
                    (false, false) => 1.0 - p - q + r,
                };
                weight *= joint.max(0.0) / single(j);
            }
            weight *= (0..n).find(|&j| occupied(j)).map_or(none, |first| likelihood[first]);
            evidence += weight;
            for (j, marginal) in marginals.iter_mut().enumerate() {
                *marginal += if occupied(j) { weight } else { 0.0 };
            }
            for (j, joint) in joints.iter_mut().enumerate() {
                joint[2 * usize::from(!occupied(j)) + usize::from(!occupied(j + 1))] += weight;
            }
        }
        marginals.iter_mut().for_each(|m| *m /= evidence);
        joints.iter_mut().flatten().for_each(|entry| *entry /= evidence);
        (evidence, marginals, joints)
    }
}

/// Numbers without a pattern (SplitMix64).
struct Draw(u64);

impl Draw {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn of<T: Copy>(&mut self, values: &[T]) -> T {
        values[(self.unit() * values.len() as f64) as usize]
    }

    fn ray(&mut self) -> Ray {
        let cells = 1 + (self.unit() * 14.0) as usize;
        let mut prior: Vec<f64> = (0..cells)
            .map(|_| match self.of(&[0, 0, 0, 1, 1, 2]) {
                0 => self.between(0.001, 0.999),
                1 => 0.1,
                _ => self.of(&[0.0, 1.0, 1e-7, 1.0 - 1e-9]),
            })
            .collect();
        let uniform = self.unit() < 0.3;
        let correlation: Vec<f64> = (1..cells).map(|_| if uniform { 0.871 } else { self.between(-1.0, 1.0) }).collect();
        let no_hit = (self.unit() < 0.5).then(|| self.of(&[0.0, 0.004, 0.3]));
        if no_hit.is_none() {
            // The literal sum must end.
            prior[cells - 1] = self.of(&[0.1, 0.01, 0.5, 0.9, 1.0]);
        }
        let sensor = self.of(&[
            [15.0, 0.5, 0.8, 60.0],
            [15.0, 0.5, 0.8, 60.0],
            [40.0, 1.5, 0.6, 128.0],
            [4.0, 0.2, 0.95, 30.0],
            // No match is false, or hardly any: what is far from the reading still explains it.
            [15.0, 0.7, 1.0, 60.0],
            [15.0, 0.4, 1.0 - 1e-9, 60.0],
        ]);
        let cell_size = self.of(&[0.05, 0.02, 0.1, 0.4]);
        // Near, inside and behind the cells.
        let at = self.between(0.3, 1.5) * cells as f64 * cell_size;
        let observation =
            if self.unit() < 0.8 { (sensor[0] / at).min(sensor[3]) } else { self.between(0.0, sensor[3]) };
        let mut ray = Ray { cell_size, observation, prior, correlation, no_hit, sensor };
        if ray.sensor[2] > 0.99 {
            // A reading that next to nothing explains must not hang on the rounding of a pair that cannot be.
            ray.prior.iter_mut().for_each(|p| *p = p.clamp(0.001, 0.999));
            ray.correlation.iter_mut().for_each(|c| *c = c.abs());
        }
        if let Some(last) = ray.correlation.last_mut().filter(|_| ray.no_hit.is_none()) {
            *last = last.min(0.99);
        }
        ray
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|v| v.as_f64().expect("a number")).collect()
}

fn agree(name: &str, answer: &Value, ray: &Ray) {
    let (evidence, marginals, joints) = ray.enumerate();
    let z = answer["evidence"].as_f64().expect("evidence");
    assert!((z / evidence - 1.0).abs() < 1e-10, "{name}: evidence {z} {evidence}\n{}", ray.toml());
    let posterior = numbers(&answer["posterior"]);
    assert_eq!(posterior.len(), marginals.len());
    for (k, (p, expected)) in posterior.iter().zip(&marginals).enumerate() {
        assert!((p - expected).abs() < 1e-10, "{name}, cell {k}: {p} {expected}\n{}", ray.toml());
        let ratio = &answer["likelihood_ratio"][k];
        let prior = ray.prior[k];
        if prior <= 0.0 || prior >= 1.0 {
            assert!(ratio.is_null(), "{name}, cell {k}: {ratio}");
        } else if let Some(ratio) = ratio.as_f64() {
            // Next to 1 the last digit of the posterior is much of its odds.
            let odds = p / (1.0 - p) / (prior / (1.0 - prior));
            assert!((ratio - odds).abs() <= (1e-12 + 1e-15 / (1.0 - p)) * odds, "{name}, cell {k}: {ratio} {odds}");
        } else {
            assert!(*p >= 1.0, "{name}, cell {k}: undefined although the posterior is {p}");
        }
    }
    let found: Vec<Vec<f64>> = answer["joint"].as_array().expect("joints").iter().map(numbers).collect();
    assert_eq!(found.len(), joints.len());
    for (j, (pair, expected)) in found.iter().zip(&joints).enumerate() {
        for (entry, expected) in pair.iter().zip(expected) {
            assert!((entry - expected).abs() < 1e-10, "{name}, pair {j}: {pair:?} {expected:?}\n{}", ray.toml());
        }
    }
}

#[test]
fn visibility_and_independent_are_the_sum_over_all_states() {
    let place = place();
    let mut draw = Draw(1);
    let mut rays = 0;
    while rays < 120 {
        let ray = draw.ray();
        let independent = Ray { correlation: vec![0.0; ray.correlation.len()], ..ray.clone() };
        if [&ray, &independent].iter().any(|r| r.enumerate().0 < 1e-200) {
            continue; // no state explains the reading: there is no posterior
        }
        rays += 1;
        fs::write(place.path().join("r.toml"), ray.toml()).expect("writable");
        let (out, _) = run(place.path(), 0, &["ray", "r.toml", "--format", "json"]);
        let answers: Value = serde_json::from_str(&out).expect("JSON");
        assert_eq!(answers["schema_version"], 1);
        agree("visibility", &answers["mappers"]["visibility"], &ray);
        agree("independent", &answers["mappers"]["independent"], &independent);
    }
}

const FILE: &str = "cells = 12
cell_size = 0.05            # m
observation = 24.0          # px
prior = 0.1                 # number, or a list with one per cell
correlation = 0.871         # number, or a list with one per neighbouring pair
no_hit_likelihood = 0.004   # optional, 1/px; default as in 3.4
[sensor]
focal_baseline = 15.0       # px·m
disparity_sigma = 0.5       # px
correct_match = 0.8
max_disparity = 60.0        # px
";

#[test]
fn every_form_says_the_same() {
    let place = place();
    fs::write(place.path().join("r.toml"), FILE).expect("writable");
    let of = |format: &str| run(place.path(), 0, &["ray", "r.toml", "--format", format]).0;
    let answers: Value = serde_json::from_str(&of("json")).expect("JSON");
    let mappers = answers["mappers"].as_object().expect("mappers");
    assert_eq!(mappers.len(), 4);
    assert!(mappers["conventional"]["evidence"].is_null() && mappers["conventional"]["joint"].is_null());
    let csv = of("csv");
    assert!(csv.starts_with(
        "mapper,cell,enter_m,exit_m,prior,posterior,likelihood_ratio,joint_ee,joint_ef,joint_fe,joint_ff,evidence\n"
    ));
    assert_eq!(csv.lines().count(), 4 * 12 + 1);
    for line in csv.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let (answer, k) = (&mappers[fields[0]], fields[1].parse::<usize>().expect("cell"));
        let same = |field: &str, value: &Value| match value.as_f64() {
            // The reader of the JSON rounds to the last digit but one.
            Some(number) => assert!((field.parse::<f64>().expect("number") - number).abs() <= 4e-16 * number, "{line}"),
            None => assert_eq!(field, "", "{line}"),
        };
        same(fields[5], &answer["posterior"][k]);
        same(fields[6], &answer["likelihood_ratio"][k]);
        (0..4).for_each(|i| same(fields[7 + i], &answer["joint"][k][i]));
        same(fields[11], &answer["evidence"]);
    }
    let text = of("text");
    let row = text.lines().find(|line| line.starts_with("9 ")).expect("cell 9");
    let shown: Vec<&str> = row.split_whitespace().collect();
    for (column, mapper) in [(3, "visibility"), (4, "visibility-printed"), (5, "conventional"), (6, "independent")] {
        assert_eq!(shown[column], format!("{:.4}", mappers[mapper]["posterior"][9].as_f64().expect("number")));
    }
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    insta::assert_snapshot!(text);
    assert_eq!(fs::read_dir(place.path()).expect("there").count(), 1, "nothing is written unless asked for");
}

#[test]
fn a_hundred_thousand_cells() {
    let place = place();
    let file = FILE.replace("cells = 12", "cells = 100000").replace("cell_size = 0.05", "cell_size = 0.001");
    fs::write(place.path().join("r.toml"), file).expect("writable");
    let (out, _) = run(place.path(), 0, &["ray", "r.toml", "--format", "json"]);
    let answers: Value = serde_json::from_str(&out).expect("JSON");
    for (mapper, answer) in answers["mappers"].as_object().expect("mappers") {
        let posterior = numbers(&answer["posterior"]);
        assert_eq!(posterior.len(), 100_000, "{mapper}");
        assert!(posterior.iter().all(|p| (0.0..=1.0).contains(p)), "{mapper}");
    }
    let (text, _) = run(place.path(), 0, &["ray", "r.toml"]);
    assert!(text.lines().count() < 40 && text.lines().all(|line| line.chars().count() <= 80), "{text}");
    run(place.path(), 0, &["ray", "r.toml", "--out", "o"]);
    assert!(place.path().join("o/ray.png").exists());
}

#[test]
fn the_papers_rays_hold_what_it_claims_and_can_be_run_again_from_their_files() {
    let place = place();
    for case in ["near", "distant", "occluded"] {
        let (text, err) = run(place.path(), 0, &["ray", case]);
        assert!(text.contains("holds  ") && !text.contains("FAILS"), "{text}");
        assert!(err.contains("ray.png"));
        let folder = place.path().join(format!("results/ray-{case}"));
        let record: Value = serde_json::from_slice(&fs::read(folder.join("run.json")).expect("there")).expect("JSON");
        assert_eq!((&record["schema_version"], &record["command"]), (&1.into(), &"ray".into()));
        for file in record["files"].as_array().expect("files") {
            assert!(folder.join(file["name"].as_str().expect("name")).exists(), "{file}");
        }
        let (direct, _) = run(place.path(), 0, &["ray", case, "--out", "o", "--format", "json"]);
        let (again, _) = run(place.path(), 0, &["ray", "o/ray.toml", "--format", "json"]);
        assert_eq!(direct, again);
        let bytes = |folder: &Path| fs::read(folder.join("ray.png")).expect("there");
        assert_eq!(bytes(&folder), bytes(&place.path().join("o")), "the same picture every time");
    }
}

/// `--svg`, `--dpi` and `--width`, which all commands with pictures share.
#[test]
fn pictures_for_print_are_as_wide_and_as_fine_as_asked_for() {
    let place = place();
    let path = |name: &str| place.path().join("o").join(name);
    let size = || {
        let bytes = fs::read(path("ray.png")).expect("there");
        [16, 20].map(|at| u32::from_be_bytes(std::array::from_fn(|k| bytes[at + k])))
    };
    run(place.path(), 0, &["ray", "near", "--out", "o"]);
    let [wide, high] = size();
    run(place.path(), 0, &["ray", "near", "--out", "o", "--dpi", "400"]);
    assert_eq!(size(), [2 * wide, 2 * high]);
    run(place.path(), 0, &["ray", "near", "--out", "o", "--width", "85", "--dpi", "300", "--svg"]);
    let [narrow, tall] = size();
    // 85 mm at 300 px per inch; two charts below each other.
    assert!(narrow.abs_diff(1004) <= 1 && tall > narrow, "{narrow} x {tall}");
    let svg = fs::read_to_string(path("ray.svg")).expect("there");
    assert!(svg.starts_with("<svg ") && svg.contains("width=\"84.9") && svg.contains("aria-label=\"visibility\""));
    let record = fs::read_to_string(path("run.json")).expect("there");
    assert!(record.contains("ray.svg"));
    // What only the former run wrote goes.
    run(place.path(), 0, &["ray", "near", "--out", "o"]);
    assert!(!path("ray.svg").exists() && size() == [wide, high]);
    for (option, value, bound) in [
        ("--dpi", "49", "50..=1200"),
        ("--dpi", "1201", "50..=1200"),
        ("--width", "59", "from 60 to 1000"),
        ("--width", "nan", "from 60 to 1000"),
    ] {
        let (_, err) = run(place.path(), 2, &["ray", "near", "--out", "n", option, value]);
        assert!(err.contains(bound), "{err}");
    }
    assert!(!place.path().join("n").exists());
}

#[test]
fn bad_input_is_one_line_with_its_place_and_leaves_nothing() {
    let place = place();
    fs::write(place.path().join("r.toml"), FILE.replace("prior = 0.1 ", "prior = 1.5 ")).expect("writable");
    let refused = |args: &[&str], message: &str| {
        let (out, err) = run(place.path(), 2, args);
        assert!(err.contains(message), "{args:?}: {err}");
        assert_eq!(out, "");
        assert!(!place.path().join("o").exists() && !place.path().join("results").exists());
    };
    let at = "error: r.toml:4:9: the ray: prior = 1.5: must be a probability, 0 to 1; give one number such as 0.1";
    refused(&["ray", "r.toml", "--out", "o"], at);
    refused(&["ray", "occuded"], "occuded: is neither a case nor a file; the nearest case is 'occluded'");
    refused(&["ray", "nowhere.toml"], "nowhere.toml: cannot be read");
    refused(&["ray"], "CASE|FILE");
    refused(&["ray", "near", "--format", "xml"], "csv");
    let impossible =
        FILE.replace("correct_match = 0.8", "correct_match = 1.0").replace("0.004 ", "0.0 ").replace("24.0", "2.0");
    fs::write(place.path().join("i.toml"), impossible).expect("writable");
    let (text, _) = run(place.path(), 0, &["ray", "i.toml"]);
    assert!(text.contains("no state of the ray explains the reading"), "{text}");
    fs::write(place.path().join("file"), "in the way").expect("writable");
    refused(&["ray", "near", "--out", "file"], "file: the output folder");
    refused(&["sensor", "nowhere.toml"], "nowhere.toml: cannot be read");
    refused(&["sensor", "--range", "0"], "must be a number above 0 and finite");
}

#[test]
fn sensor_shows_the_camera_of_a_scene() {
    let place = place();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/room.toml");
    let scene = fs::read_to_string(root).expect("there");
    fs::write(place.path().join("s.toml"), &scene).expect("writable");
    let (text, _) = run(place.path(), 0, &["sensor", "s.toml", "--out", "o"]);
    assert!(text.contains("holds  Figure 6") && text.contains("holds  Figure 7"), "{text}");
    let read = |name: &str| fs::read_to_string(place.path().join("o").join(name)).expect("there");
    // At 1.5 m the disparity is 10 px: 0.8 of the peak of a Gaussian of 0.5 px, and 0.2 / 60.
    let peak = 0.8 / (0.5 * (2.0 * std::f64::consts::PI).sqrt()) + 0.2 / 60.0;
    let density = read("density.csv");
    let row = density.lines().find(|line| line.starts_with("10.0,")).expect("10 px");
    let shown: f64 = row.split(',').nth(1).expect("density").parse().expect("number");
    assert!((shown - peak).abs() < 1e-5, "{shown} {peak}");
    assert!(read("kernel.csv").starts_with("range_m,disparity_px,density_per_px\n"));
    let pictures =
        ["density.png", "kernel.png"].map(|name| fs::read(place.path().join("o").join(name)).expect("there"));
    assert!(pictures.iter().all(|bytes| bytes.len() > 1000));
    // Other cameras: a coarse one, a fine one, one that is never wrong and one that always is.
    for (from, to) in [
        ("disparity_sigma = 0.5", "disparity_sigma = 4.0"),
        ("disparity_sigma = 0.5", "disparity_sigma = 0.01"),
        ("correct_match = 0.8", "correct_match = 1.0"),
        ("correct_match = 0.8", "correct_match = 0.0"),
        ("focal_baseline = 15.0", "focal_baseline = 400.0"),
    ] {
        assert!(scene.contains(from));
        fs::write(place.path().join("s.toml"), scene.replace(from, to)).expect("writable");
        run(place.path(), 0, &["sensor", "s.toml", "--out", "o", "--range", "3"]);
    }
}
