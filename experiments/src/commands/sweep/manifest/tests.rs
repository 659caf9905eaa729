use std::fs;

use super::*;
use crate::commands::sweep::file::parse;

/// A manifest of so many jobs, which no test runs.
fn planned(folder: &Path, first_seed: u64, jobs: u64, shards: u32) -> Manifest {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/room.toml");
    let text = format!(
        "scene = {:?}\nmappers = [\"prior\"]\nseeds = {{ first = {first_seed}, count = {jobs} }}",
        scene.display().to_string()
    );
    plan(&parse(&text, "s.toml").expect("valid"), folder, Some(shards), Replace::Always).expect("planned")
}

fn ids(manifest: &Manifest, shard: u32) -> Result<Vec<u64>, Failure> {
    let mut ids = Vec::new();
    manifest.each_job(shard, |id, _| {
        ids.push(id);
        Ok(ControlFlow::Continue(()))
    })?;
    Ok(ids)
}

#[test]
fn shards_are_runs_of_all_jobs_whatever_their_numbers() {
    for jobs in (1..=70).chain([997, 1000, 4096]) {
        for shards in (1..=jobs.min(70) as u32).chain([jobs as u32]) {
            let mut counts = vec![0u64; shards as usize];
            let of: Vec<u32> = (0..jobs).map(|at| shard_of(at, jobs, shards)).collect();
            assert!(of.is_sorted());
            of.iter().for_each(|shard| counts[*shard as usize] += 1);
            let manifest = Manifest {
                folder: PathBuf::new(),
                head: Head {
                    of_movement: false,
                    schema_version: 1,
                    sweep: String::new(),
                    jobs,
                    shards,
                    keys: Vec::new(),
                    build: String::new(),
                    sites: Vec::new(),
                },
                digest: String::new(),
                starts: Vec::new(),
                parts: Vec::new(),
            };
            let said: Vec<u64> = (0..shards).map(|shard| manifest.jobs_of(shard)).collect();
            assert_eq!(said, counts, "{jobs} jobs, {shards} shards");
            assert!(counts.iter().max() <= counts.iter().min().map(|least| least + 1).as_ref());
        }
    }
}

#[test]
fn the_jobs_of_all_shards_are_all_jobs_in_order() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let all = ids(&planned(folder.path(), 1, 97, 1), 0).expect("read");
    assert!(all.len() == 97 && all.is_sorted());
    for shards in [2, 7, 64, 96, 97, 1000] {
        let manifest = planned(folder.path(), 1, 97, shards);
        let joined: Vec<u64> =
            (0..manifest.head.shards).flat_map(|shard| ids(&manifest, shard).expect("read")).collect();
        assert_eq!(joined, all, "{shards}");
    }
}

#[test]
fn a_file_that_is_replaced_or_cut_short_later_is_not_taken_for_the_one_that_was_opened() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let first = planned(folder.path(), 1000, 40, 4);
    let cut = fs::read(folder.path().join(MANIFEST)).expect("there");
    planned(folder.path(), 2000, 40, 4); // as long, line by line
    for shard in 0..4 {
        let failure = ids(&first, shard).expect_err("other jobs").to_string();
        assert!(failure.contains("cut short or replaced"), "{failure}");
    }
    let end = cut[..cut.len() - 1].iter().rposition(|byte| *byte == b'\n').expect("lines") + 1;
    fs::write(folder.path().join(MANIFEST), &cut[..end]).expect("writable");
    assert_eq!(ids(&first, 0).expect("whole").len(), 10);
    assert!(ids(&first, 3).expect_err("a job less").to_string().contains("cut short or replaced"));
}
