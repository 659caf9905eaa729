//! The files that the program brings with it, so that every documented command runs in any folder.

use strict::Brought;

/// Path, from the root of the repository, and content.
macro_rules! files {
    ($($path:literal),* $(,)?) => { &[$(($path, include_bytes!(concat!("../../../", $path)))),*] };
}

/// Scenes, families, a map, a plan, a log, sweeps and gates. A file of the same path in the working folder goes before.
pub const FILES: Brought = files![
    "scenes/closets.toml",
    "scenes/clutter.toml",
    "scenes/corridor-people.toml",
    "scenes/corridors.toml",
    "scenes/halls.toml",
    "scenes/office-glass.toml",
    "scenes/office-visits.toml",
    "scenes/room.toml",
    "scenes/sonar-ring.toml",
    "scenes/two-rooms.toml",
    "scenes/uma.toml",
    "scenes/waiting-people.toml",
    "scenes/logs/aces.clf.bz2",
    "scenes/logs/aces.relations",
    "scenes/maps/UMA_236_237.pgm",
    "scenes/maps/UMA_236_237.yaml",
    "scenes/plans/flat.json",
    "experiments/gates/moving.toml",
    "experiments/gates/poses.toml",
    "experiments/gates/sensors.toml",
    "experiments/sweeps/camera.toml",
    "experiments/sweeps/cell-size.toml",
    "experiments/sweeps/lateral.toml",
    "experiments/sweeps/obstacle-size.toml",
    "experiments/sweeps/people.toml",
    "experiments/sweeps/poses.toml",
    "experiments/sweeps/range-cut.toml",
    "experiments/sweeps/range-looks.toml",
    "results/gates-baseline.csv",
    "results/gates.toml",
];

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::{Path, PathBuf};

    use super::*;

    /// Files of a folder and the folders in it, but what people alone read.
    fn below(folder: &Path, found: &mut BTreeSet<PathBuf>) {
        for path in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("readable").path()) {
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            if path.is_dir() {
                below(&path, found);
            } else if !name.starts_with("LICENSE") && name != "README.md" {
                found.insert(path);
            }
        }
    }

    #[test]
    fn every_scene_sweep_and_gate_is_brought() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the repository");
        let mut expected =
            BTreeSet::from(["results/gates-baseline.csv", "results/gates.toml"].map(|name| root.join(name)));
        ["scenes", "experiments/gates", "experiments/sweeps"]
            .iter()
            .for_each(|folder| below(&root.join(folder), &mut expected));
        assert_eq!(FILES.iter().map(|(path, _)| root.join(path)).collect::<BTreeSet<_>>(), expected);
        for (path, content) in FILES {
            assert_eq!(fs::read(root.join(path)).expect("there"), *content, "{path}");
        }
        assert!(FILES.iter().map(|(_, content)| content.len()).sum::<usize>() < 300_000);
    }
}
