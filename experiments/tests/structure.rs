//! The structure of the sources, drawn from their imports: no circles of files, arrows point down, and no command
//! imports another.

use std::collections::BTreeMap;
use std::path::Path;

use crate::imports::{Arrows, arrows};

/// The rooms of this package from the roof to the cellar; a room imports those of its own level and of lower ones.
const LEVELS: [&[&str]; 7] = [
    &["main", "lib"],
    &["cli"],
    &["commands"],
    &["worlds", "figures", "page"],
    &["programs"],
    &["exit", "jobs", "output"],
    &["failure"],
];

/// Crates that still have circles.
const CIRCULAR: [&str; 1] = ["crates/scene"];

/// The arrows of a crate of this repository.
fn of_crate(folder: &str) -> Arrows {
    arrows(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder).join("src"))
}

fn level(file: &str) -> usize {
    let room = file.split("::").next().unwrap_or_default();
    let level = LEVELS.iter().position(|rooms| rooms.contains(&room));
    level.unwrap_or_else(|| panic!("{file} stands in no room that this test knows"))
}

/// The command that a file belongs to.
fn command(file: &str) -> Option<&str> {
    let mut parts = file.split("::");
    (parts.next() == Some("commands")).then(|| parts.next()).flatten()
}

#[test]
fn arrows_point_down_and_commands_stand_alone() {
    let arrows = of_crate("experiments");
    assert!(arrows.values().map(|to| to.len()).sum::<usize>() > 200, "arrows are found: {arrows:?}");
    for (from, targets) in &arrows {
        for to in targets {
            assert!(level(from) <= level(to), "{from} imports {to}, which stands above it");
            if let (Some(own), Some(other)) = (command(from), command(to)) {
                assert_eq!(own, other, "{from} imports {to} of another command");
            }
        }
    }
}

#[test]
fn no_three_files_import_each_other_in_a_circle() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    let entries = std::fs::read_dir(crates).expect("there").map(|entry| entry.expect("an entry").file_name());
    let mut folders: Vec<String> = entries.map(|name| format!("crates/{}", name.to_string_lossy())).collect();
    folders.retain(|folder| !CIRCULAR.contains(&folder.as_str()));
    folders.push("experiments".to_owned());
    for folder in folders {
        let arrows = of_crate(&folder);
        let circles: Vec<_> = circles(&arrows).into_iter().filter(|files| files.len() > 2).collect();
        assert!(circles.is_empty(), "{folder}: files that import each other in a circle: {circles:?}");
    }
}

/// Files of which each leads to every other.
fn circles(arrows: &Arrows) -> Vec<Vec<&str>> {
    let reached: BTreeMap<&str, _> = arrows.keys().map(|file| (file.as_str(), reach(arrows, file))).collect();
    let leads = |from: &str, to: &str| reached.get(from).is_some_and(|files| files.contains(&to));
    let mut found: Vec<Vec<&str>> = Vec::new();
    for &file in reached.keys() {
        if !found.iter().any(|circle| circle.contains(&file)) {
            let mut circle: Vec<&str> = reached[file].iter().copied().filter(|other| leads(other, file)).collect();
            circle.sort_unstable();
            found.push(circle);
        }
    }
    found
}

/// All files that a file leads to.
fn reach<'a>(arrows: &'a Arrows, from: &str) -> Vec<&'a str> {
    let (mut found, mut next): (Vec<&str>, Vec<&str>) = (Vec::new(), vec![from]);
    while let Some(file) = next.pop() {
        for target in arrows.get(file).into_iter().flatten() {
            if !found.contains(&target.as_str()) {
                found.push(target);
                next.push(target);
            }
        }
    }
    found
}

#[test]
fn a_circle_and_a_re_export_are_found() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let put = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("writable");
        std::fs::write(path, text).expect("writable");
    };
    put("lib.rs", "mod a;\nmod b;\nmod c;\npub use b::inner::Deep;\n");
    put("a.rs", "use crate::{Deep, b::Other as _};\nfn f() {}\n#[cfg(test)]\nmod tests {\n    use crate::c::No;\n}\n");
    put("b.rs", "mod inner;\npub struct Other;\n");
    put("b/inner.rs", "//! use crate::c;\npub struct Deep;\nfn g() { super::super::c::h() }\n");
    put("c.rs", "use crate::a;\npub fn h() {}\n");
    let arrows = arrows(folder.path());
    let to = |file: &str| arrows[file].iter().map(String::as_str).collect::<Vec<_>>();
    assert_eq!(to("a"), ["b", "b::inner"], "a re-export leads to what it names");
    assert_eq!(to("b::inner"), ["c"], "paths in the code count, comments and tests do not");
    assert_eq!(to("lib"), [""; 0], "what a root publishes is no import");
    assert_eq!(to("a"), ["b", "b::inner"]);
    let found: Vec<_> = circles(&arrows).into_iter().filter(|files| files.len() > 2).collect();
    assert_eq!(found, [["a", "b::inner", "c"]]);
}
