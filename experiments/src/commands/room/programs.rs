//! What became of the programs that mapped a room.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write as _;

use crate::failure::Failure;
use crate::output::folder::Staging;
use crate::worlds::run::{Run, Stage, Trial};

/// The file for what a program wrote to standard error.
pub(super) fn stderr_file(mapper: &str) -> String {
    format!("{mapper}-stderr.txt")
}

/// Keeps what programs wrote to standard error; nothing of those that wrote nothing.
pub(super) fn save_stderr(staging: &mut Staging, trials: &[Trial], stages: &[Stage]) -> Result<(), Failure> {
    let mut said: BTreeMap<&str, String> = BTreeMap::new();
    for trial in trials {
        for run in &trial.runs {
            let parts = run.program.iter().flat_map(|program| stages.iter().zip(&program.stderr));
            for (stage, text) in parts.filter(|(_, text)| !text.is_empty()) {
                let all = said.entry(run.mapper).or_default();
                let _ = writeln!(all, "== seed {}, stage {}\n{}", trial.seed, stage.name, text.trim_end());
            }
        }
    }
    said.iter().try_for_each(|(mapper, text)| staging.write(&stderr_file(mapper), |out| out.write_all(text.as_bytes())))
}

/// Maps that programs did not give, in one line for each stage and seed.
pub(super) fn faults(trials: &[Trial], stages: &[Stage]) -> Vec<String> {
    let of_run = |seed: u64, run: &Run| -> Vec<String> {
        let maps = stages.iter().zip(&run.stages);
        maps.filter_map(|(stage, map)| {
            Some(format!("{}: seed {seed}, stage {}: {}", run.mapper, stage.name, map.fault.as_ref()?))
        })
        .collect()
    };
    trials.iter().flat_map(|trial| trial.runs.iter().flat_map(move |run| of_run(trial.seed, run))).collect()
}
