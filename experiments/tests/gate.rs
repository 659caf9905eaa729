//! `gate` as a build meets it: verdicts, baselines, exit codes, files for other machines, and messages.

use crate::counting;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use experiments::gate::{self, Format, FormatOption, GateOptions, ProgramOptions, ThreadsOption};
use mapper::catalogue::{Entry, Kind};
use quick_xml::Reader;
use quick_xml::events::Event;
use tempfile::TempDir;

use crate::checked::checked;
use crate::nook::FAMILY;

/// One gate of every kind.
const GATES: &str = r#"
[[gate]]
name = "not-worse"
mapper = "visibility"
metric = "log_loss"
families = ["nook.toml"]
seeds = 6
not_worse_than_baseline_by = 0.002

[[gate]]
name = "bounded"
mapper = "visibility"
metric = "retention"
region = "visible"
families = ["nook.toml"]
seeds = 2
at_least = 0.5

[[gate]]
name = "small"
mapper = "prior"
metric = "brier"
families = ["nook.toml"]
seeds = 2
grid = 0.2
at_most = 0.5

[[gate]]
name = "better"
mapper = "visibility"
metric = "log_loss"
families = ["nook.toml"]
seeds = 6
better_than = "prior"
by = 0.01
"#;

struct Place {
    folder: TempDir,
}

impl Place {
    fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().expect("temporary folder") };
        place.put("nook.toml", FAMILY);
        place.put("gates.toml", GATES);
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn put(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).expect("writable");
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).expect("readable")
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
        command.current_dir(self.folder.path()).args(["gate", "--gates", "gates.toml"]).args(args);
        command
    }

    /// Runs and expects an exit code; gives stdout and stderr.
    fn expect(&self, code: i32, args: &[&str]) -> (String, String) {
        checked(code, &args, &self.command(args).output().expect("runs"))
    }

    /// The gates with one mapper or number for another.
    fn edit(&self, from: &str, to: &str) {
        assert!(self.text("gates.toml").contains(from), "{from}");
        self.put("gates.toml", &self.text("gates.toml").replacen(from, to, 1));
    }
}

fn narrow(text: &str) {
    let wide: Vec<&str> = text.lines().filter(|line| line.chars().count() > 80).collect();
    assert!(wide.is_empty(), "{wide:#?}");
}

/// Elements of an XML text with their attributes, and its text; it must be well-formed.
fn elements(xml: &str) -> Vec<String> {
    let mut reader = Reader::from_str(xml);
    let mut found = Vec::new();
    loop {
        match reader.read_event().expect("well-formed") {
            Event::Start(tag) | Event::Empty(tag) => {
                tag.attributes().for_each(|attribute| drop(attribute.expect("well-formed")));
                found.push((*tag).to_owned());
            }
            Event::Eof => return found,
            _ => {}
        }
    }
}

#[test]
fn a_baseline_is_demanded_made_and_kept_to() {
    let place = Place::new();
    let (_, err) = place.expect(2, &[]);
    assert!(err.contains("gates-baseline.csv: is not there, and gate not-worse needs it"), "{err}");
    assert!(err.contains("make it with `gate --update`"), "{err}");
    place.expect(0, &["--only", "bounded,better"]);

    let (out, err) = place.expect(0, &["--update"]);
    assert!(out.lines().any(|line| line.starts_with("not-worse") && line.ends_with("6 of 6  new")), "{out}");
    assert!(err.contains("gates-baseline.csv: 6 values, 0 gone"), "{err}");
    let baseline = place.text("gates-baseline.csv");
    let lines: Vec<&str> = baseline.lines().collect();
    assert_eq!((lines.len(), lines[0]), (7, "mapper,metric,region,family,condition,grid,seed,value"));
    assert!(lines[1].starts_with("visibility,log_loss,observable,nook,as-believed,,1,0."), "{baseline}");

    let (out, _) = place.expect(0, &[]);
    narrow(&out);
    assert!(out.contains("gates.toml: 4 gates on 8 worlds"), "{out}");
    let row = out.lines().find(|line| line.starts_with("not-worse")).expect("a row");
    assert!(row.contains(" 0.0000 [0.0000, 0.0000]  <= +0.002  pass"), "{row}");
    assert_eq!(out.matches("pass").count(), 4, "{out}");
    let (out, _) = place.expect(0, &["--update"]);
    assert!(out.lines().any(|line| line.contains(" 0  0 of 6  same")), "{out}");
    assert_eq!(place.text("gates-baseline.csv"), baseline);
}

#[test]
fn a_gate_that_fails_says_which_metric_where_and_by_how_much() {
    let place = Place::new();
    place.expect(0, &["--update"]);
    // As if the maps had been better once.
    let better = |line: &str| match line.rsplit_once(',') {
        Some((key, value)) if value != "value" => format!("{key},{}\n", value.parse::<f64>().expect("a number") - 0.01),
        _ => format!("{line}\n"),
    };
    let baseline = place.text("gates-baseline.csv");
    place.put("gates-baseline.csv", &baseline.lines().map(better).collect::<String>());
    place.edit("at_least = 0.5", "at_least = 1.5");
    place.edit("by = 0.01", "by = 5.0");
    let (out, err) = place.expect(3, &["--junit", "junit.xml", "--summary", "summary.md"]);
    narrow(&out);
    assert!(err.contains("error: 3 of 4 gates fail: not-worse, bounded, better"), "{err}");
    let (table, again) = out.split_once("\nFAIL not-worse\n").expect("once more at the end");
    assert_eq!(table.matches("FAIL").count(), 3, "{table}");
    assert!(again.contains("log loss of visibility, observable cells, 6 worlds: nook"), "{again}");
    let again = again.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        again.contains(": +0.0100 [+0.0100, +0.0100]; must not be higher than the baseline by more than 0.002"),
        "{again}"
    );
    assert!(again.contains("; must be at least 1.5"), "{again}");
    assert!(again.contains("lower than prior by more than 5, with all of"), "{again}");

    let junit = elements(&place.text("junit.xml"));
    assert!(junit[0].starts_with("testsuites tests=\"4\" failures=\"3\" errors=\"0\""), "{junit:?}");
    assert_eq!(junit.iter().filter(|tag| tag.starts_with("failure")).count(), 3);
    let case = "testcase classname=\"gate.visibility\" name=\"not-worse\"";
    assert!(junit.iter().any(|tag| tag == case), "{junit:?}");
    let summary = place.text("summary.md");
    assert!(summary.starts_with("### Maps: 3 of 4 gates fail\n"), "{summary}");
    assert_eq!(summary.lines().filter(|line| line.starts_with("| ")).count(), 5, "{summary}");

    let (told, err) = place.expect(0, &["--report-only"]);
    assert_eq!(told, out, "it says the same ...");
    assert!(
        err.contains("warning: 3 of 4 gates fail") && err.contains("lets the build go on"),
        "... and ends well: {err}"
    );

    let (csv, _) = place.expect(3, &["--format", "csv"]);
    assert!(csv.starts_with("gate,mapper,metric,unit,region,worlds,value,demand,bound,"), "{csv}");
    assert!(
        csv.lines()
            .any(|l| l.starts_with("not-worse,visibility,log_loss,nats/cell,observable,6,") && l.contains(",FAIL,"))
    );
    let (json, _) = place.expect(3, &["--format", "json"]);
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["rows"].as_array().map(Vec::len), Some(4));
    assert_eq!(json["rows"][1]["verdict"], "FAIL");
}

#[test]
fn maps_that_got_better_pass_and_say_so() {
    let place = Place::new();
    place.expect(0, &["--update"]);
    let worse = |line: &str| match line.rsplit_once(',') {
        Some((key, value)) if value != "value" => format!("{key},{}\n", value.parse::<f64>().expect("a number") + 0.01),
        _ => format!("{line}\n"),
    };
    let baseline = place.text("gates-baseline.csv");
    place.put("gates-baseline.csv", &baseline.lines().map(worse).collect::<String>());
    let (out, _) = place.expect(0, &[]);
    assert!(
        out.contains("Better than the baseline by more than the margin; `gate --update` holds it:\n  not-worse\n"),
        "{out}"
    );
}

#[test]
fn an_update_of_some_gates_keeps_the_rest_and_drops_what_no_gate_needs() {
    let place = Place::new();
    let second = "\n[[gate]]\nname = \"second\"\nmapper = \"conventional\"\nmetric = \"brier\"\nfamilies = [\"nook.toml\"]\nseeds = 6\nnot_worse_than_baseline_by = 0\n";
    place.put("gates.toml", &format!("{GATES}{second}"));
    place.expect(0, &["--update"]);
    let both = place.text("gates-baseline.csv");
    let spoilt = both.replace(
        "visibility,log_loss,observable,nook,as-believed,,3,0",
        "visibility,log_loss,observable,nook,as-believed,,3,1",
    );
    let spoilt = spoilt.replace(
        "conventional,brier,observable,nook,as-believed,,2,0",
        "conventional,brier,observable,nook,as-believed,,2,1",
    );
    assert_ne!(both, spoilt);
    place.put("gates-baseline.csv", &format!("{spoilt}gone,brier,observable,nook,as-believed,,2,0.5\n"));
    let (out, err) = place.expect(0, &["--update", "--only", "second"]);
    assert!(out.contains("1 of 6  changed") && !out.contains("not-worse"), "{out}");
    assert!(err.contains("12 values, 1 gone"), "{err}");
    let after = place.text("gates-baseline.csv");
    assert_ne!(after, both, "the other gate's baseline is as spoilt as it was");
    place.expect(0, &["--update"]);
    assert_eq!(place.text("gates-baseline.csv"), both);
    // One row less.
    place.put(
        "gates-baseline.csv",
        &both
            .lines()
            .filter(|l| !l.contains("log_loss,observable,nook,as-believed,,4,"))
            .map(|l| format!("{l}\n"))
            .collect::<String>(),
    );
    let (_, err) = place.expect(2, &[]);
    assert!(
        err.contains(
            "gate not-worse: no row of visibility log_loss observable on nook as-believed seed 4, 1 of 6 are missing"
        ),
        "{err}"
    );
    assert!(err.contains("`gate --update --only not-worse`"), "{err}");
}

#[test]
fn an_update_that_cannot_be_written_leaves_the_former_file() {
    let place = Place::new();
    place.expect(0, &["--update"]);
    fs::create_dir(place.path("dir.csv")).expect("writable");
    let (_, err) = place.expect(2, &["--update", "--baseline", "dir.csv"]);
    assert!(err.contains("dir.csv: is no file of baselines"), "{err}");
    let (_, err) = place.expect(1, &["--update", "--baseline", "nowhere/b.csv"]);
    assert!(err.contains("nowhere/b.csv: cannot be written"), "{err}");
    let names: Vec<_> =
        fs::read_dir(place.folder.path()).expect("there").map(|e| e.expect("entry").file_name()).collect();
    assert!(names.iter().all(|name| !name.to_string_lossy().starts_with('.')), "{names:?}");
}

#[test]
fn the_same_bytes_with_any_number_of_threads() {
    let place = Place::new();
    place.expect(0, &["--update", "--threads", "1"]);
    let one = place.text("gates-baseline.csv");
    place.expect(0, &["--update", "--threads", "3", "--baseline", "three.csv"]);
    assert_eq!(one, place.text("three.csv"));
    let (first, _) = place.expect(0, &["--format", "csv", "--threads", "1", "--junit", "1.xml"]);
    let (second, _) = place.expect(0, &["--format", "csv", "--threads", "3", "--junit", "3.xml"]);
    assert_eq!((first, place.text("1.xml")), (second, place.text("3.xml")));
    let (other, _) = place.expect(0, &["--only", "better", "--format", "csv", "--stream", "1"]);
    let (same, _) = place.expect(0, &["--only", "better", "--format", "csv"]);
    assert_ne!(other, same, "another stream gives other readings");
}

#[test]
fn the_summary_of_a_step_is_added_to_and_one_that_gate_wrote_replaced() {
    let place = Place::new();
    for (shared, heads) in [(true, 2), (false, 1)] {
        place.put("s.md", "### Maps: before\n");
        let mut command = place.command(&["--only", "bounded", "--summary", "s.md"]);
        command.env("GITHUB_STEP_SUMMARY", if shared { "s.md" } else { "t.md" });
        checked(0, &["s.md"], &command.output().expect("runs"));
        assert_eq!(place.text("s.md").matches("###").count(), heads, "{}", place.text("s.md"));
    }
    let (_, err) = place.expect(2, &["--junit", "nowhere/junit.xml", "--only", "bounded"]);
    assert!(err.contains("nowhere/junit.xml: cannot be written"), "{err}");
}

#[test]
fn mistakes_in_the_file_have_line_column_and_remedy() {
    let place = Place::new();
    let refused = |from: &str, to: &str, messages: &[&str]| {
        place.put("gates.toml", GATES);
        place.edit(from, to);
        let (_, err) = place.expect(2, &[]);
        for message in messages {
            assert!(err.contains(message), "{to}: {err}");
        }
    };
    refused(
        "metric = \"log_loss\"",
        "metric = \"logloss\"",
        &[
            "gates.toml:5:10: gate 1: metric = \"logloss\": must be one of log_loss, brier",
            "the nearest is \"log_loss\"",
        ],
    );
    refused(
        "mapper = \"visibility\"",
        "mapper = \"visibilty\"",
        &["gates.toml:4:10: ", "the nearest is \"visibility\""],
    );
    refused("region = \"visible\"", "region = \"X\"", &["gates.toml:14:10: ", "must be one of visible, surface"]);
    refused(
        "metric = \"retention\"",
        "metric = \"colliding\"",
        &["gates.toml:14:10: ", "left out or \"all\" with colliding, which is of the whole world"],
    );
    refused("name = \"bounded\"", "name = \"not-worse\"", &["gates.toml:11:8: ", "no gate above has"]);
    refused("name = \"bounded\"", "nam = \"bounded\"", &["gates.toml:11:1: ", "did you mean `name`?"]);
    refused("at_least = 0.5", "", &["gates.toml:10:1: gate 2: `at_most` is missing; add one of at_most, at_least"]);
    refused(
        "at_least = 0.5",
        "at_least = 0.5\nat_most = 1",
        &["the only one of at_most, at_least", "make a gate of each"],
    );
    refused("at_least = 0.5", "at_least = 0.5\nby = 1", &["gates.toml:18:6: ", "left out without better_than"]);
    refused("at_least = 0.5", "at_least = \"much\"", &["gates.toml:17:12: ", "a number in the unit of the metric"]);
    refused("= 0.002", "= -0.002", &["gates.toml:8:30: ", "must be a difference in the unit of the metric, 0 to"]);
    refused("seeds = 6", "seeds = 5", &["gates.toml:7:9: gate 1: seeds = 5: must be at least 6 worlds to pair, not 5"]);
    refused("seeds = 6", "seeds = 6.5", &["gates.toml:7:9: ", "a whole number from 1 to 1000"]);
    refused("seeds = 6", "seeds = 6\nset = \"tests\"", &["gates.toml:8:7: ", "one of test, robustness, tuning"]);
    refused("grid = 0.2", "grid = 0", &["gates.toml:25:8: ", "must be a cell size in m, 0.01 to 10"]);
    refused(
        "better_than = \"prior\"",
        "better_than = \"visibility\"",
        &["gates.toml:34:15: ", "must be one of visibility-lateral"],
    );
    refused("\"nook.toml\"", "\"nowhere\"", &["gates.toml:6:13: ", "scenes/nowhere.toml: cannot be read"]);
    refused("[\"nook.toml\"]", "[]", &["gates.toml:6:12: ", "a list of at least one family"]);
    refused("families = [", "scene = \"nook.toml\"\nfamilies = [", &["gates.toml:7:12: ", "left out beside `scene`"]);
    refused(
        "metric = \"log_loss\"",
        "metric = \"decided\"",
        &["gates.toml:8:30: ", "of which neither more nor less is better"],
    );
    place.put("gates.toml", "");
    assert!(place.expect(2, &[]).1.contains("gates.toml:1:1: the gates: `[[gate]]` is missing"));
    place.put("gates.toml", GATES);
    let (_, err) = place.expect(2, &["--only", "bound"]);
    assert!(err.contains("has no gate \"bound\"; all are: not-worse, bounded, small, better"), "{err}");
    let (_, err) = place.expect(2, &["--update", "--only", "bounded"]);
    assert!(err.contains("none of the gates asked for has a baseline"), "{err}");
    place.expect(2, &["--update", "--stream", "1"]);
}

#[test]
fn drives_are_gated_in_the_whole_world() {
    let place = Place::new();
    place.edit("metric = \"retention\"\nregion = \"visible\"", "metric = \"reached\"");
    place.edit("at_least = 0.5", "at_least = 1.1");
    let (out, _) = place.expect(3, &["--only", "bounded", "--format", "json"]);
    let rows: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    let row = &rows["rows"][0];
    assert_eq!((&row["region"], &row["defined"], &row["verdict"]), (&"all".into(), &2.into(), &"FAIL".into()), "{row}");
    assert!(row["value"].as_f64().is_some_and(|reached| reached > 0.0 && reached <= 1.0), "{row}");
    place.edit("at_least = 1.1", "at_least = 0.0");
    place.expect(0, &["--only", "bounded"]);
}

#[test]
fn a_spoilt_baseline_is_refused_with_its_line() {
    let place = Place::new();
    place.expect(0, &["--update"]);
    let good = place.text("gates-baseline.csv");
    let line = good.lines().nth(3).expect("a row");
    for (spoilt, at) in [
        (good.replacen("seed", "sead", 1), "gates-baseline.csv:1: must be mapper,metric"),
        (good.replacen(line, "<<<<<<< HEAD", 1), "gates-baseline.csv:4: must be one value for each of"),
        (format!("{good}{line}\n"), "gates-baseline.csv:8: is there twice"),
        (good.replacen("as-believed", "as-dreamt", 1), "gates-baseline.csv:2: must be"),
        (good.replacen(",0.", ",x0.", 1), "gates-baseline.csv:2: must be"),
    ] {
        place.put("gates-baseline.csv", &spoilt);
        let (_, err) = place.expect(2, &[]);
        assert!(err.contains(at) && err.contains("make it anew with `gate --update`"), "{err}");
    }
    let (_, err) = place.expect(0, &["--update"]);
    assert!(err.contains("warning: "), "{err}");
    assert_eq!(place.text("gates-baseline.csv"), good);
}

const fn own(name: &'static str, build: &'static mapper::catalogue::Build) -> Entry {
    Entry { name, summary: "of this test", source: "here", kind: Kind::Online, build }
}

/// A crate outside the workspace: its own mapper, judged by name beside the built-in ones.
#[test]
fn a_mapper_of_your_own_is_gated_like_any_other() {
    let place = Place::new();
    let families = format!("families = [\"{}\"]", place.path("nook.toml").display());
    let gates = GATES.replace("families = [\"nook.toml\"]", &families);
    let gates = gates.replace("mapper = \"visibility\"", "mapper = \"counting\"").replace("by = 0.01", "by = 0.0");
    place.put("gates.toml", &gates);
    let options = |update| GateOptions { update, ..options(&place) };
    gate::run_with(&options(true), &[counting::COUNTING]).expect("measured");
    assert!(place.text("gates-baseline.csv").contains("\ncounting,log_loss,"));
    gate::run_with(&options(false), &[counting::COUNTING]).expect("all pass");
    let unknown = gate::run_with(&options(false), &[]).expect_err("no such mapper").to_string();
    assert!(unknown.contains("mapper = \"counting\": must be one of visibility, "), "{unknown}");
    // Called like another, it takes its place, and is judged by its baselines.
    let worse = own("counting", &|setup| Box::new(mapper::Unseen::new(setup)));
    let failed = gate::run_with(&options(false), &[worse]).expect_err("no map at all").to_string();
    assert!(
        failed.starts_with("2 of 4 gates fail: not-worse") || failed.starts_with("3 of 4 gates fail: not-worse"),
        "{failed}"
    );
}

#[test]
fn a_mapper_that_fails_is_an_error_of_its_gates_alone() {
    let place = Place::new();
    let gates =
        GATES.replace("families = [\"nook.toml\"]", &format!("families = [\"{}\"]", place.path("nook.toml").display()));
    place.put("gates.toml", &gates);
    let options = GateOptions { junit: Some(place.path("junit.xml")), ..options(&place) };
    gate::run_with(&GateOptions { update: true, junit: None, ..options.clone() }, &[]).expect("measured");
    let before = place.text("gates-baseline.csv");
    let broken = own("visibility", &|_| panic!("no <map> & no \u{1} luck"));
    let failed = gate::run_with(&options, &[broken]).expect_err("fails");
    assert_eq!(failed.to_string(), "3 of 4 gates fail: not-worse, bounded, better");
    let junit = place.text("junit.xml");
    assert!(elements(&junit)[0].contains("failures=\"0\" errors=\"3\""), "{junit}");
    assert!(junit.contains("it panicked: no &lt;map&gt; &amp; no \u{fffd} luck"), "{junit}");
    assert!(junit.contains("visibility failed on 6 of 6 worlds, first on nook as-believed seed 1"), "{junit}");
    let update = GateOptions { update: true, junit: None, ..options };
    let refused = gate::run_with(&update, &[broken]).expect_err("fails").to_string();
    assert!(refused.contains("the baselines stay as they were"), "{refused}");
    assert_eq!(place.text("gates-baseline.csv"), before);
}

fn options(place: &Place) -> GateOptions {
    GateOptions {
        gates: place.path("gates.toml"),
        baseline: None,
        only: Vec::new(),
        update: false,
        stream: 0,
        report_only: false,
        junit: None,
        summary: None,
        print: FormatOption { format: Format::Csv },
        programs: ProgramOptions::default(),
        threads: ThreadsOption::default(),
    }
}
