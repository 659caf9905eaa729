//! Random folders, records, inputs and kills: nothing that is not proved to be a former run's is removed or changed.

use std::collections::BTreeMap;

use proptest::prelude::*;

use super::*;
use crate::output::publication::Hidden;

/// Names that runs and users both like.
const NAMES: [&str; 5] = ["a.csv", "b.csv", "map.pgm", "run.log", "report.html"];
const COMMANDS: [&str; 2] = ["room", "replay"];

/// What happens to a folder, one after the other.
#[derive(Debug, Clone)]
enum Event {
    /// Somebody writes a file: a text under one of the names, the record or a hidden name.
    User { name: usize, text: u8 },
    /// Somebody removes a file.
    Removal { name: usize },
    /// A run, killed before its so-many-th change on disk, if that comes.
    Run { command: usize, writes: u8, reads: Option<usize>, text: u8, others: bool, killed: Option<u8> },
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        2 => (0..NAMES.len() + 3, 0..4u8).prop_map(|(name, text)| Event::User { name, text }),
        1 => (0..NAMES.len() + 1).prop_map(|name| Event::Removal { name }),
        4 => (0..2usize, 1..32u8, proptest::option::of(0..NAMES.len()), 0..4u8, any::<bool>(), proptest::option::of(0..40u8))
            .prop_map(|(command, writes, reads, text, others, killed)| Event::Run { command, writes, reads, text, others, killed }),
    ]
}

fn name(number: usize) -> String {
    match number.checked_sub(NAMES.len()) {
        None => NAMES[number].to_owned(),
        Some(0) => RECORD.to_owned(),
        Some(1) => ".partial-x".to_owned(),
        Some(_) => ".finished-0123456789abcdef".to_owned(),
    }
}

/// Every plain file of the folder, and whose it is known to be.
#[derive(Debug, Default)]
struct Expected {
    /// What users wrote, and nobody but they may touch.
    foreign: BTreeMap<String, String>,
    /// What the last run that was finished left: its command and its files.
    ours: Option<(usize, BTreeMap<String, String>)>,
}

/// A run as the commands make them; `None` where it was refused.
fn attempt(folder: &Path, event: &Event, expected: &Expected) -> Option<BTreeMap<String, String>> {
    let Event::Run { command, writes, reads, text, others, killed } = event else { return None };
    let written: Vec<&str> = (0..NAMES.len()).filter(|k| writes >> k & 1 == 1).map(|k| NAMES[k]).collect();
    let read = reads.map(|k| folder.join(NAMES[k]));
    let reads: Vec<&Path> = read.iter().map(PathBuf::as_path).collect();
    let purpose = purpose(COMMANDS[*command], &reads, &written);
    let opened = if *others { Staging::amend(folder, &purpose) } else { Staging::open(folder, &purpose) };
    let mut staging = match opened {
        Ok(staging) => staging,
        Err(Failure::BadInput(message)) => {
            assert!(message.contains("choose another folder with --out"), "{message}");
            return None;
        }
        Err(other) => panic!("{other}"),
    };
    for name in &written {
        staging.write(name, |out| out.write_all(format!("run {text}").as_bytes())).expect("writable");
    }
    staging.record(&json!({"command": COMMANDS[*command], "text": text})).expect("writable");
    let mut new: BTreeMap<String, String> = match (&expected.ours, *others) {
        (Some((former, files)), true) if former == command => files.clone(),
        _ => BTreeMap::new(),
    };
    new.extend(written.iter().map(|name| ((*name).to_owned(), format!("run {text}"))));
    new.insert(RECORD.to_owned(), super::text(&staging.written(RECORD)));
    match killed {
        None => staging.publish().expect("nobody else writes"),
        Some(after) => staging.killed(usize::from(*after)),
    }
    Some(new)
}

fn files(folder: &Path) -> BTreeMap<String, String> {
    let plain = |name: &String| folder.join(name).is_file();
    names(folder).into_iter().filter(plain).map(|name| (name.clone(), text(&folder.join(&name)))).collect()
}

impl Expected {
    /// What is on the disk, all of it accounted for.
    fn check(&self, folder: &Path) {
        let mut all = self.foreign.clone();
        for (name, text) in self.ours.iter().flat_map(|(_, files)| files) {
            // Where a user has taken the name, or the file away, it is no longer the run's.
            all.entry(name.clone()).or_insert_with(|| text.clone());
        }
        assert_eq!(files(folder), all);
    }

    /// A user's deed.
    fn change(&mut self, folder: &Path, name: String, text: Option<String>) {
        if folder.join(&name).is_dir() {
            return;
        }
        let _ = match &text {
            Some(text) => fs::write(folder.join(&name), text),
            None => fs::remove_file(folder.join(&name)),
        };
        if name == RECORD {
            // Nothing proves any more whose the others are.
            self.foreign.extend(self.ours.take().into_iter().flat_map(|(_, files)| files));
        } else if let Some((_, files)) = &mut self.ours {
            files.remove(&name);
        }
        match text {
            Some(text) => drop(self.foreign.insert(name, text)),
            None => drop(self.foreign.remove(&name)),
        }
    }
}

fn play(events: &[Event]) {
    // In memory where that is to be had: the property is about names, not about disks.
    let memory = Path::new("/dev/shm");
    let place = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() };
    let place = place.expect("temporary folder");
    let folder = place.path();
    let mut expected = Expected::default();
    for event in events {
        match event {
            Event::User { name: number, text } => expected.change(folder, name(*number), Some(format!("user {text}"))),
            Event::Removal { name: number } => expected.change(folder, name(*number), None),
            Event::Run { command, .. } => {
                let Some(new) = attempt(folder, event, &expected) else {
                    expected.check(folder);
                    continue;
                };
                recover(folder).expect("a kill at any moment can be recovered from");
                // Either set whole: which of them, the record says.
                let found = files(folder);
                if new.iter().all(|(name, text)| found.get(name) == Some(text)) {
                    expected.ours = Some((*command, new));
                }
            }
        }
        expected.check(folder);
        assert!(Hidden::orphans(folder).is_empty());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, max_shrink_iters: 2_000, ..ProptestConfig::default() })]

    #[test]
    fn nothing_foreign_is_ever_removed_or_changed(events in proptest::collection::vec(event(), 1..8)) {
        play(&events);
    }
}
