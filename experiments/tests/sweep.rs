//! `sweep`: whatever happens to those who run its shards, the table is the same to the byte.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use tempfile::TempDir;

use crate::attic::FAMILY;
use crate::checked::checked;

const SWEEP: &str = r#"
families = ["attics.toml"]
mappers = ["visibility", "conventional"]
seeds = { first = 1, count = 12 }
[set]
prior = 0.12
[vary]
grid = [0.03, 0.1]
correlation = { from = 0.0, to = 0.8, steps = 3 }
[paired]
disparity_sigma = [0.5, 1.0]
believed_sigma = [0.5, 0.7]
"#;

fn place() -> TempDir {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("attics.toml"), FAMILY).expect("writable");
    fs::write(folder.path().join("sweep.toml"), SWEEP).expect("writable");
    folder
}

fn command(place: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
    command.current_dir(place).arg("sweep").args(args);
    command
}

/// Runs `sweep` and expects an exit code; gives stdout and stderr.
fn sweep(place: &Path, code: i32, args: &[&str]) -> (String, String) {
    checked(code, &args, &command(place, args).output().expect("runs"))
}

fn start(place: &Path, args: &[&str]) -> Child {
    command(place, args).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("runs")
}

fn table(place: &Path, out: &str) -> Vec<u8> {
    fs::read(place.join(out).join("table.csv")).expect("merged")
}

fn shard(place: &Path, out: &str, number: u32) -> PathBuf {
    place.join(out).join(format!("shards/{number:06}.csv"))
}

/// The table of an undisturbed run with one thread.
fn undisturbed(place: &Path) -> Vec<u8> {
    sweep(place, 0, &["sweep.toml", "--out", "one", "--threads", "1"]);
    table(place, "one")
}

fn temporary_files(folder: &Path) -> usize {
    let files = fs::read_dir(folder).into_iter().flatten().flatten();
    files.filter(|entry| entry.file_name().to_string_lossy().starts_with('.')).count()
}

#[test]
fn threads_shards_and_their_order_do_not_matter() {
    let place = place();
    let place = place.path();
    let expected = undisturbed(place);
    assert_eq!(expected.iter().filter(|byte| **byte == b'\n').count(), 1 + 144 * 2 * 3);
    sweep(place, 0, &["sweep.toml", "--out", "two", "--threads", "2", "--shards", "7"]);
    assert!(table(place, "two") == expected);

    let mut parts: Vec<&str> = SWEEP.trim().split("\n[").collect();
    let head: Vec<&str> = parts.remove(0).lines().rev().collect();
    let sections: Vec<String> = parts.iter().rev().map(|part| format!("[{part}")).collect();
    fs::write(place.join("turned.toml"), format!("{}\n{}", head.join("\n"), sections.join("\n"))).expect("writable");
    sweep(place, 0, &["plan", "turned.toml", "--out", "by-shard", "--shards", "5"]);
    for number in ["3", "0", "4", "1"] {
        sweep(place, 0, &["run", "by-shard", "--shard", number]);
    }
    assert_eq!(sweep(place, 0, &["missing", "by-shard"]).0, "2\n");
    let (_, err) = sweep(place, 2, &["merge", "by-shard"]);
    assert!(err.contains("1 of 5 shards are missing") && err.contains(": 2; run them"), "{err}");
    sweep(place, 0, &["run", "by-shard", "--shard", "2", "--shard", "3"]);
    sweep(place, 0, &["merge", "by-shard"]);
    assert!(table(place, "by-shard") == expected);
    assert_eq!(sweep(place, 0, &["missing", "by-shard"]).0, "");
}

#[test]
fn killed_at_any_moment_any_number_of_times() {
    let place = place();
    let place = place.path();
    let expected = undisturbed(place);
    sweep(place, 0, &["plan", "sweep.toml", "--out", "killed"]);
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let (mut kills, mut hit) = (0, 0);
    while hit < 50 {
        assert!(kills < 500, "only {hit} of {kills} were still at work");
        let mut child = start(place, &["run", "killed", "--threads", "2"]);
        std::thread::sleep(Duration::from_micros(rng.random_range(5_000..250_000)));
        child.kill().expect("killed"); // SIGKILL
        let ended = child.wait().expect("ended");
        kills += 1;
        hit += u32::from(ended.code().is_none());
        if sweep(place, 0, &["missing", "killed"]).0.is_empty() {
            // All is done: some of it is to be done again, so that there is something to be killed at.
            for number in 0..64 {
                if rng.random_bool(0.8) {
                    let _ = fs::remove_file(shard(place, "killed", number));
                }
            }
        }
    }
    sweep(place, 0, &["sweep.toml", "--out", "killed"]);
    assert!(table(place, "killed") == expected);
    assert_eq!(temporary_files(&place.join("killed/shards")), 0, "what killed runs left behind is gone");
}

#[test]
fn workers_that_race_for_the_same_shards_write_the_same() {
    let place = place();
    let place = place.path();
    let expected = undisturbed(place);
    sweep(place, 0, &["plan", "sweep.toml", "--out", "race", "--shards", "2"]);
    for args in [&["run", "race", "--shard", "1"][..], &["run", "race"]] {
        let mut workers: Vec<Child> = (0..3).map(|_| start(place, args)).collect();
        assert!(workers.iter_mut().all(|worker| worker.wait().expect("ended").success()));
    }
    sweep(place, 0, &["merge", "race"]);
    assert!(table(place, "race") == expected);
    assert_eq!(temporary_files(&place.join("race/shards")), 0);
}

#[test]
fn what_is_not_whole_does_not_count() {
    let place = place();
    let place = place.path();
    let expected = undisturbed(place);
    let good = fs::read(shard(place, "one", 3)).expect("written");
    let other = fs::read(shard(place, "one", 4)).expect("written");
    let flipped = |at: usize| {
        let mut bytes = good.clone();
        bytes[at] ^= 1;
        bytes
    };
    let mut twice = good.clone();
    twice.extend(&good);
    let wrong = [
        (Vec::new(), "empty"),
        (good[..good.len() - 1].to_vec(), "without its last byte"),
        (good[..good.len() - 30].to_vec(), "cut in the last line"),
        (good[..good.len() / 3].to_vec(), "cut in a row"),
        (flipped(20), "a bit flipped in a row"),
        (flipped(good.len() - 20), "a bit flipped in the last line"),
        (other, "another shard's"),
        (twice, "twice over"),
    ];
    for (bytes, why) in wrong {
        fs::write(shard(place, "one", 3), &bytes).expect("writable");
        assert_eq!(sweep(place, 0, &["missing", "one"]).0, "3\n", "{why}");
        sweep(place, 2, &["merge", "one"]);
        assert!(table(place, "one") == expected, "{why}: the former table stays");
        let (csv, _) = sweep(place, 0, &["status", "one", "--format", "csv"]);
        assert!(csv.contains("\"shards not whole, or of another manifest\",1,64"), "{csv}");
        sweep(place, 0, &["run", "one"]);
        sweep(place, 0, &["merge", "one"]);
        assert!(table(place, "one") == expected, "{why}");
        assert_eq!(fs::read(shard(place, "one", 3)).expect("written"), good);
    }
}

#[test]
fn another_manifest_is_not_taken_for_this_one() {
    let place = place();
    let place = place.path();
    let expected = undisturbed(place);
    fs::write(place.join("less.toml"), SWEEP.replace("steps = 3", "steps = 2")).expect("writable");
    let (_, err) = sweep(place, 2, &["plan", "less.toml", "--out", "one"]);
    assert!(err.contains("another sweep") && err.contains("--replace"), "{err}");
    sweep(place, 0, &["plan", "sweep.toml", "--out", "one"]);
    sweep(place, 0, &["plan", "less.toml", "--out", "one", "--replace"]);
    let (_, err) = sweep(place, 2, &["merge", "one"]);
    assert!(err.contains("64 of 64 shards"), "results of the former manifest do not count: {err}");
    let (_, err) = sweep(place, 2, &["sweep.toml", "--out", "one"]);
    assert!(err.contains("another sweep") && err.contains("--replace"), "{err}");
    sweep(place, 0, &["sweep.toml", "--out", "one", "--replace"]);
    assert!(table(place, "one") == expected);

    fs::write(place.join("attics.toml"), FAMILY.replace("0.02", "0.03")).expect("writable");
    let (_, err) = sweep(place, 2, &["run", "one"]);
    assert!(err.contains("attics.toml: has changed since the sweep was planned"), "{err}");

    let manifest = place.join("one/manifest.jsonl");
    let text = fs::read_to_string(&manifest).expect("there");
    fs::write(&manifest, text.replacen("\"build\":\"", "\"build\":\"x", 1)).expect("writable");
    let (_, err) = sweep(place, 2, &["run", "one"]);
    assert!(err.contains("was planned by build x") && err.contains("--replace"), "{err}");
    for (from, to) in
        [("\"keys\":[\"", "\"keys\":[\"x"), ("\"jobs\":144", "\"jobs\":0"), ("\"shards\":64", "\"shards\":63")]
    {
        fs::write(&manifest, text.replacen(from, to, 1)).expect("writable");
        let (_, err) = sweep(place, 2, &["status", "one"]);
        assert!(err.contains("manifest.jsonl: line 1 "), "{err}");
    }
    fs::write(&manifest, &text[..text.len() / 2]).expect("writable");
    let (_, err) = sweep(place, 2, &["status", "one"]);
    assert!(err.contains("line 1 says 144 jobs"), "{err}");
    fs::write(&manifest, "nothing of the kind").expect("writable");
    let (_, err) = sweep(place, 2, &["status", "one"]);
    assert!(err.contains("line 1 is no manifest's"), "{err}");
}

#[test]
fn a_family_that_changes_or_goes_during_a_run_gives_no_results() {
    let place = place();
    let place = place.path();
    let expected = undisturbed(place);
    for now in [Some(FAMILY.replace("0.02", "0.03")), None] {
        sweep(place, 0, &["plan", "sweep.toml", "--out", "o", "--shards", "72"]);
        let mut child = start(place, &["run", "o", "--threads", "1"]);
        while fs::read_dir(place.join("o/shards")).map_or(0, Iterator::count) < 5 {
            std::thread::sleep(Duration::from_millis(2));
        }
        match &now {
            Some(text) => fs::write(place.join("attics.toml"), text).expect("writable"),
            None => fs::remove_file(place.join("attics.toml")).expect("removed"),
        }
        assert!(!child.wait().expect("ended").success());
        fs::write(place.join("attics.toml"), FAMILY).expect("writable");
        sweep(place, 0, &["sweep.toml", "--out", "o", "--shards", "72"]);
        assert!(table(place, "o") == expected);
        fs::remove_dir_all(place.join("o")).expect("removed");
    }
}

#[cfg(unix)]
#[test]
fn an_interruption_keeps_what_is_finished() {
    let place = place();
    let place = place.path();
    let expected = undisturbed(place);
    for signal in ["INT", "TERM"] {
        sweep(place, 0, &["plan", "sweep.toml", "--out", signal, "--shards", "20"]);
        let mut child = start(place, &["run", signal, "--threads", "2"]);
        let shards = place.join(signal).join("shards");
        while fs::read_dir(&shards).map_or(0, Iterator::count) < 3 {
            std::thread::sleep(Duration::from_millis(5));
        }
        let id = child.id().to_string();
        assert!(Command::new("kill").args(["-s", signal, &id]).status().expect("runs").success());
        assert_eq!(child.wait().expect("ended").code(), Some(75));
        assert_eq!(temporary_files(&shards), 0);
        let missing = sweep(place, 0, &["missing", signal]).0;
        assert!(!missing.is_empty() && missing != "0-19\n", "{missing}");
        sweep(place, 0, &["sweep.toml", "--out", signal, "--shards", "20"]);
        assert!(table(place, signal) == expected);
    }
}

#[cfg(unix)]
#[test]
fn a_full_disk_is_an_error_that_leaves_nothing_half_written() {
    let place = place();
    let place = place.path();
    let expected = undisturbed(place);
    sweep(place, 0, &["plan", "sweep.toml", "--out", "full", "--shards", "2"]);
    // A limit on the size of files, in blocks of 512 or 1024 bytes: a shard has some 60 kB.
    let run = format!("ulimit -f 20; trap '' XFSZ; exec '{}' sweep run full", env!("CARGO_BIN_EXE_experiments"));
    let output = Command::new("sh").current_dir(place).args(["-c", &run]).output().expect("runs");
    let err = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert!(err.contains("full/shards/00000") && err.contains("cannot be written"), "{err}");
    assert_eq!(fs::read_dir(place.join("full/shards")).map_or(0, Iterator::count), 0);
    let notes: Vec<String> = fs::read_dir(place.join("full/failures"))
        .expect("there")
        .map(|entry| fs::read_to_string(entry.expect("entry").path()).expect("readable"))
        .collect();
    assert!(!notes.is_empty() && notes.iter().all(|note| note.contains("cannot be written")), "{notes:?}");
    sweep(place, 0, &["sweep.toml", "--out", "full", "--shards", "2"]);
    assert!(table(place, "full") == expected);
}

#[test]
fn a_world_that_cannot_be_made_is_a_row() {
    let place = place();
    let place = place.path();
    let text = "families = [\"attics.toml\"]\nmappers = [\"visibility\"]\n[vary]\nsize_factor = [1.0, 10.0]\n";
    fs::write(place.join("large.toml"), text).expect("writable");
    let (_, err) = sweep(place, 0, &["large.toml", "--out", "large"]);
    assert!(err.contains("1 row with an error"), "{err}");
    let text = String::from_utf8(table(place, "large")).expect("text");
    let failed: Vec<&str> = text.lines().filter(|line| line.contains(",10.0,")).collect();
    assert!(failed.len() == 1 && failed[0].contains("attics.toml") && failed[0].contains("obstacles"), "{text}");
    assert_eq!(text.lines().count(), 1 + 1 + 3);
}

/// Every parameter with two values that no default is, and the mapper that minds.
const VALUES: [(&str, [&str; 2], &str); 53] = [
    ("size_factor", ["0.8", "1.3"], "visibility"),
    ("width", ["2.5", "3.5"], "visibility"),
    ("height", ["2.5", "3.5"], "visibility"),
    ("passage", ["1.2", "1.6"], "visibility"),
    ("door", ["0.9", "1.3"], "visibility"),
    ("obstacle_size", ["0.2", "0.5"], "visibility"),
    ("obstacle_spread", ["0.0", "0.9"], "visibility"),
    ("covered", ["0.01", "0.05"], "visibility"),
    ("discs", ["0.0", "1.0"], "visibility"),
    ("along_walls", ["0.0", "1.0"], "visibility"),
    ("clearance", ["0.02", "0.5"], "visibility"),
    ("wall_thickness", ["0.2", "0.3"], "visibility"),
    ("people_per_100_m2", ["4.0", "12.0"], "visibility"),
    ("people_speed_m_s", ["0.3", "0.9"], "visibility"),
    ("radius", ["0.1", "0.3"], "visibility"),
    ("speed", ["0.3", "0.7"], "visibility"),
    ("turn_rate_deg", ["20.0", "40.0"], "visibility"),
    ("scan_interval", ["0.7", "1.1"], "visibility"),
    ("columns", ["12", "20"], "visibility"),
    ("field_of_view_deg", ["70.0", "90.0"], "visibility"),
    ("focal_baseline", ["10.0", "20.0"], "visibility"),
    ("max_disparity", ["40.0", "80.0"], "visibility"),
    ("correct_match", ["0.6", "0.9"], "visibility"),
    ("disparity_sigma", ["0.3", "0.8"], "visibility"),
    ("detection_rate", ["0.4", "0.9"], "visibility"),
    ("quantisation", ["0.5", "1.0"], "visibility"),
    ("mismatches", ["\"independent\"", "\"clustered\""], "visibility"),
    ("persistence", ["0.5", "0.9"], "visibility"),
    ("copies", ["0.0", "0.85"], "visibility"),
    ("near_misses", ["0.0", "0.25"], "visibility"),
    ("copy_reach", ["1", "15"], "visibility"),
    ("scans", ["2", "4"], "visibility"),
    ("max_range", ["1.0", "1.5"], "visibility"),
    ("grid", ["0.08", "0.2"], "visibility"),
    ("prior", ["0.05", "0.2"], "visibility"),
    ("correlation", ["0.5", "0.9"], "visibility"),
    ("assumed_length", ["0.2", "0.8"], "visibility"),
    ("correlation_law", ["\"scaled\"", "\"fixed\""], "visibility"),
    ("reconciliation", ["\"all-edges\"", "\"touched\""], "visibility"),
    ("believed_correct_match", ["0.6", "0.9"], "visibility"),
    ("believed_sigma", ["0.3", "0.8"], "visibility"),
    ("half_width", ["0.3", "0.8"], "conventional"),
    ("clamp_low", ["0.01", "0.1"], "log-odds-octomap"),
    ("clamp_high", ["0.7", "0.9"], "conventional-tuned"),
    ("hit", ["0.6", "0.9"], "log-odds-cartographer"),
    ("miss", ["0.3", "0.45"], "log-odds-octomap"),
    ("start", ["0.1", "0.4"], "log-odds-octomap"),
    ("coupling", ["0.1", "0.3"], "mrf"),
    ("damping", ["0.0", "0.9"], "mrf"),
    ("sweeps", ["1", "3"], "mrf"),
    ("pose_sigma_m", ["0.02", "0.1"], "visibility"),
    ("pose_sigma_rad", ["0.01", "0.1"], "visibility"),
    ("pose_drift", ["1.0", "3.0"], "visibility"),
];

#[test]
fn every_parameter_changes_the_scores() {
    let place = place();
    let place = place.path();
    let (help, _) = sweep(place, 0, &["--help"]);
    let (_, listed) = help.split_once("\nParameters").expect("listed");
    let listed = listed.lines().skip(1).take_while(|line| !line.is_empty());
    let listed: Vec<&str> = listed.filter_map(|line| line.strip_prefix("  ")?.split(' ').next()).collect();
    assert_eq!(listed, VALUES.map(|(key, ..)| key));
    let corridor = FAMILY.replace("clutter", "corridor").replace("width = [3.0, 3.0]", "width = [9.0, 9.0]");
    let corridor =
        corridor.replace("height = [3.0, 3.2]", "height = [6.0, 6.0]\npassage = [1.4, 1.4]\ndoor = [1.0, 1.0]");
    fs::write(place.join("corridor.toml"), corridor).expect("writable");
    let clustered = format!("{FAMILY}[sensor]\nmismatches = \"clustered\"\n");
    fs::write(place.join("clustered.toml"), clustered).expect("writable");
    let crowded = FAMILY.replace("width = [3.0, 3.0]", "width = [5.0, 5.0]");
    let crowded = crowded.replace("height = [3.0, 3.2]", "height = [5.0, 5.0]\npeople_per_100_m2 = [8.0, 8.0]");
    fs::write(place.join("crowded.toml"), crowded).expect("writable");
    for (key, [one, other], mapper) in VALUES {
        let family = match key {
            "passage" | "door" => "corridor.toml",
            "people_per_100_m2" | "people_speed_m_s" => "crowded.toml",
            "mismatches" | "persistence" | "copies" | "near_misses" | "copy_reach" => "clustered.toml",
            _ => "attics.toml",
        };
        let text = format!(
            "families = [\"{family}\"]\nmappers = [\"{mapper}\"]\nregions = [\"observable\"]\n[vary]\n{key} = [{one}, {other}]\n"
        );
        fs::write(place.join("s.toml"), text).expect("writable");
        sweep(place, 0, &["s.toml", "--out", key, "--shards", "1"]);
        let mut rows = csv::Reader::from_path(place.join(key).join("table.csv")).expect("merged");
        let heads = rows.headers().expect("heads").clone();
        let loss = heads.iter().position(|head| head == "log_loss").expect("there");
        let rows: Vec<csv::StringRecord> = rows.records().collect::<Result<_, _>>().expect("rows");
        assert!(rows.iter().all(|row| row.iter().next_back() == Some("")), "{key}: {rows:?}");
        assert_eq!(rows.len(), 2, "{key}");
        assert_ne!(rows[0][loss], rows[1][loss], "{key} changes nothing");
    }
}

#[test]
fn bad_input_is_one_line_with_its_place() {
    let place = place();
    let place = place.path();
    let refused = |args: &[&str], expected: &str| {
        let (_, err) = sweep(place, 2, args);
        assert!(err.contains(expected), "{args:?}: {err}");
        assert!(!place.join("results").exists());
    };
    refused(&["nowhere.toml"], "nowhere.toml: cannot be read");
    refused(&["plan", "sweep.toml", "--shards", "0"], "--shards");
    refused(&["run", "nowhere"], "manifest.jsonl: cannot be read");
    refused(&["run"], "DIR");
    refused(&[], "<SWEEP>");
    refused(&["sweep.toml", "--threads", "0"], "--threads");
    sweep(place, 0, &["plan", "sweep.toml", "--out", "o"]);
    refused(&["run", "o", "--shard", "64"], "--shard 64: must be 0 to 63");
    refused(&["plot", "o"], "o/table.csv");
    for (bad, expected) in [
        ("mappers = [\"visibility\"]", "s.toml:1:1: the sweep: `scene` is missing"),
        ("scene = \"a.toml\"\nfamilies = [\"b\"]\nmappers = [\"visibility\"]", "s.toml:2:12: the sweep: families"),
        ("scene = 3\nmappers = [\"visibility\"]", "s.toml:1:9: the sweep: scene = 3"),
        ("families = []\nmappers = [\"visibility\"]", "s.toml:1:12: the sweep: families = []"),
        ("scene = \"a.toml\"\nmappers = [\"visibilty\"]", "s.toml:2:12: the sweep: mappers = \"visibilty\""),
        (
            "scene = \"a.toml\"\nmappers = [\"prior\", \"prior\"]",
            "s.toml:2:21: the sweep: mappers = \"prior\": must be a name that is not named before",
        ),
        ("scene = \"a.toml\"\nmappers = [\"prior\"]\nregions = [\"x\"]", "s.toml:3:12: the sweep: regions"),
        ("scene = \"a.toml\"\nmappers = [\"prior\"]\nsedes = 3", "s.toml:3:1: the sweep: unknown key `sedes`"),
        ("scene = \"a.toml\"\nmappers = [\"prior\"]\nseeds = { count = 0 }", "s.toml:3:19: [seeds]: count = 0"),
        ("scene = \"a.toml\"\nmappers = [\"prior\"]\nseeds = { count = 1.5 }", "s.toml:3:19: [seeds]: count = 1.5"),
        ("scene = \"a.toml\"\nmappers = [\"prior\"]\n[vary]\ngrit = [1.0]", "s.toml:4:1: [vary]: unknown key `grit`"),
        (
            "scene = \"a.toml\"\nmappers = [\"prior\"]\n[vary]\ngrid = 0.1",
            "s.toml:4:8: [vary]: grid = 0.1: must be a list",
        ),
        ("scene = \"a.toml\"\nmappers = [\"prior\"]\n[vary]\ngrid = [0.1, nan]", "s.toml:4:14: [vary]: grid = nan"),
        (
            "scene = \"a.toml\"\nmappers = [\"prior\"]\n[vary]\ngrid = [0.1, 0.1]",
            "s.toml:4:14: [vary]: grid = 0.1: must be a value that is not given before",
        ),
        (
            "scene = \"a.toml\"\nmappers = [\"prior\"]\n[vary]\ngrid = { from = 1.0, to = 0.1, steps = 3 }",
            "s.toml:4:8: [vary]: grid",
        ),
        ("scene = \"a.toml\"\nmappers = [\"prior\"]\n[vary]\ngrid = { from = 0.1, to = 1.0 }", "`steps` is missing"),
        ("scene = \"a.toml\"\nmappers = [\"prior\"]\n[vary]\nscans = [1.5]", "s.toml:4:10: [vary]: scans = 1.5"),
        (
            "scene = \"a.toml\"\nmappers = [\"prior\"]\n[vary]\nmismatches = [\"often\"]",
            "s.toml:4:15: [vary]: mismatches",
        ),
        (
            "scene = \"a.toml\"\nmappers = [\"prior\"]\n[paired]\ngrid = [0.1, 0.2]\nprior = [0.1]",
            "s.toml:5:9: [paired]: prior",
        ),
        (
            "scene = \"a.toml\"\nmappers = [\"prior\"]\n[vary]\ngrid = [0.1]\n[set]\ngrid = 0.2",
            "given in one of [set], [vary] and [paired] only",
        ),
        (
            "scene = \"a.toml\"\nmappers = [\"prior\"]\n[set]\ncorrelation = 0.5\nassumed_length = 0.2",
            "s.toml:5:18: [set]: assumed_length",
        ),
        ("scene = \"a.toml\"\nmappers = [\"prior\"]\n[set]\nsize_factor = 2.0", "s.toml:4:15: [set]: size_factor"),
        (
            "scene = \"a.toml\"\nmappers = [\"prior\"]\nseeds = { count = 1000000 }\n[vary]\ngrid = { from = 0.1, to = 1.0, steps = 100 }",
            "at most 10000000 jobs",
        ),
        ("scene = \"attics.toml\"\nmappers = [\"prior\"]", "attics.toml:"),
        (
            "families = [\"attics.toml\"]\nmappers = [\"prior\"]\n[vary]\npersistence = [0.9]",
            "the sweep sets persistence = 0.9: attics.toml:",
        ),
        ("families = [\"attics.toml\"]\nmappers = [\"prior\"]\n[set]\ncovered = 0.1\ndoor = 1.0", "unknown key `door`"),
        (
            "scene = \"a.toml\"\nmappers = [\"prior\"]\n[vary]\ncovered = [0.1]",
            "s.toml:4:11: [vary]: covered = [0.1]: must be left out without families",
        ),
        ("families = [\"nowhere\"]\nmappers = [\"prior\"]", "scenes/nowhere.toml: cannot be read"),
    ] {
        fs::write(place.join("s.toml"), bad).expect("writable");
        refused(&["s.toml"], expected);
    }
}
