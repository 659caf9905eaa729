//! Job arrays and their scripts.

use std::fmt::Write as _;
use std::path::Path;

use crate::commands::sweep::options::SlurmOptions;
use crate::commands::sweep::shard::ranges;

/// Slurm cuts the text of `--array` near 4,096 characters: so many runs such as `1234567-1234569,` stay well below.
const MOST_RUNS: usize = 200;

/// Shards that are submitted as one array.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Array {
    /// What is added to an index to give a shard: indices must stay below the site's limit, shards need not.
    pub offset: u32,
    /// The indices, rising.
    pub indices: Vec<u32>,
}

/// Shards, rising, in arrays whose indices are below `limit` and whose text is short enough.
pub(super) fn arrays(shards: &[u32], limit: u32) -> Vec<Array> {
    let limit = limit.max(1);
    let mut arrays: Vec<Array> = Vec::new();
    let mut runs = 0;
    for &shard in shards {
        let (offset, index) = (shard / limit * limit, shard % limit);
        let last = arrays.last_mut().filter(|array| array.offset == offset);
        let follows = last.as_ref().is_some_and(|array| array.indices.last().is_some_and(|last| last + 1 == index));
        runs += usize::from(!follows);
        match last.filter(|_| runs <= MOST_RUNS) {
            Some(array) => array.indices.push(index),
            None => {
                arrays.push(Array { offset, indices: vec![index] });
                runs = 1;
            }
        }
    }
    arrays
}

/// The script of an array. Which shard a task runs follows from its index alone: `SLURM_ARRAY_TASK_COUNT` is the number
/// of tasks that were submitted together, not of shards.
pub(super) fn script(executable: &Path, folder: &Path, options: &SlurmOptions, array: &Array) -> String {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let here = std::env::current_dir().unwrap_or_default();
    let folder = absolute(folder);
    let throttle = options.throttle.map_or_else(String::new, |most| format!("%{most}"));
    let mut text = String::from("#!/bin/sh\n");
    let _ = writeln!(text, "#SBATCH --job-name=sweep");
    let _ = writeln!(text, "#SBATCH --array={}{throttle}", ranges(&array.indices));
    let _ = writeln!(text, "#SBATCH --cpus-per-task={}", options.threads);
    let _ = writeln!(text, "#SBATCH --chdir=\"{}\"", here.display());
    let logs = folder.join("logs").display().to_string().replace('%', "%%");
    let _ = writeln!(text, "#SBATCH --output=\"{logs}/%A-%a.txt\"");
    let _ = writeln!(text, "#SBATCH --open-mode=append"); // a task that is requeued has the same log
    let _ = writeln!(
        text,
        "exec {} sweep run {} --shard $(({} + SLURM_ARRAY_TASK_ID)) --threads {}",
        quoted(executable),
        quoted(&folder),
        array.offset,
        options.threads
    );
    text
}

/// A path for the shell.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.display().to_string().replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shard_is_in_one_array_within_the_limits() {
        let every_second: Vec<u32> = (0..6000).map(|k| 2 * k).collect();
        for (shards, limit) in [(every_second, 1001), ((0..5000).collect(), 1001), (vec![7, 4000], 100), (vec![], 1001)]
        {
            let arrays = arrays(&shards, limit);
            let all: Vec<u32> = arrays.iter().flat_map(|a| a.indices.iter().map(|i| a.offset + i)).collect();
            assert_eq!(all, shards);
            for array in &arrays {
                assert!(array.indices.iter().all(|index| *index < limit), "{limit}");
                assert!(ranges(&array.indices).len() <= 3800 && !array.indices.is_empty());
            }
        }
        assert_eq!(arrays(&(0..1001).collect::<Vec<_>>(), 1001).len(), 1);
    }

    #[test]
    fn the_script_of_an_array() {
        let options = SlurmOptions { threads: 2, throttle: Some(8), ..SlurmOptions::default() };
        let array = Array { offset: 1001, indices: vec![0, 1, 5] };
        let text = script(Path::new("/bin/it's"), Path::new("/data/s"), &options, &array);
        let expected = r"exec '/bin/it'\''s' sweep run '/data/s' --shard $((1001 + SLURM_ARRAY_TASK_ID)) --threads 2";
        assert!(text.contains(expected), "{text}");
        assert!(
            text.contains("#SBATCH --array=0-1,5%8\n")
                && text.contains("#SBATCH --output=\"/data/s/logs/%A-%a.txt\"\n")
        );
        assert!(!text.contains("TASK_COUNT"));
    }
}
