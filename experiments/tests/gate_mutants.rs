//! The shipped gates catch what makes `visibility` worse, and nothing else: each mutant is put in its place.

mod mutants;

use std::path::Path;

use experiments::gate::{self, Format, FormatOption, GateOptions, Outcome, ProgramOptions, ThreadsOption, Verdict};
use mapper::catalogue::Entry;

use mutants::MUTANTS;

/// The outcome of shipped gates of the given names, in the readings of a stream.
fn outcomes(only: &[&str], stream: u32, own: &[Entry]) -> Vec<Outcome> {
    // Scenes are named from the folder of the workspace; every test here goes there.
    std::env::set_current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("..")).expect("there");
    let options = GateOptions {
        gates: "results/gates.toml".into(),
        baseline: None,
        only: only.iter().map(|name| (*name).to_owned()).collect(),
        update: false,
        stream,
        report_only: false,
        junit: None,
        summary: None,
        print: FormatOption { format: Format::Csv },
        programs: ProgramOptions::default(),
        threads: ThreadsOption::default(),
    };
    gate::judge(&options, own).expect("judged")
}

fn mutant(name: &str) -> Entry {
    MUTANTS.iter().find(|(called, _)| *called == name).expect("there").1
}

fn caught(name: &str, gates: &[&str]) {
    for outcome in outcomes(gates, 0, &[mutant(name)]) {
        let (worse, interval) = (outcome.difference, outcome.interval);
        assert_eq!(outcome.verdict, Verdict::Fail, "{name}, {}: {worse:?} {interval:?}", outcome.gate.name);
    }
}

#[test]
fn a_correlation_forced_to_0_is_caught() {
    caught("correlation forced to 0", &["near", "coarse"]);
}

#[test]
fn a_tail_dropped_beyond_the_map_is_caught() {
    caught("tail beyond the map dropped", &["log-loss", "brier", "free-space", "phantom-area"]);
}

#[test]
fn a_reconciliation_left_out_is_caught() {
    caught("reconciliation left out", &["near", "coarse"]);
}

#[test]
fn a_kernel_sampled_at_cell_centres_is_caught() {
    caught("kernel sampled at cell centres", &["near"]);
}

/// Other random numbers for the same worlds. All gates pass with each of the streams 1 to 5: `gate --stream N`.
#[test]
fn a_change_of_the_random_stream_alone_is_not() {
    for (only, streams) in [("near", 1..=5), ("coarse", 1..=2)] {
        for stream in streams {
            for outcome in outcomes(&[only], stream, &[]) {
                let (worse, interval) = (outcome.difference, outcome.interval);
                assert_ne!(worse, Some(0.0), "{only}: stream {stream} has the same readings");
                assert_eq!(outcome.verdict, Verdict::Pass, "{only}, stream {stream}: {worse:?} {interval:?}");
            }
        }
    }
}
