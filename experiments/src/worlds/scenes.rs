//! Scene, family and sweep files by the names that a user gives.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser};
use scene::Family;

use crate::failure::Failure;
use crate::output::args::{FormatOption, positive};

/// The families of generated scenes that come with the program.
pub const FAMILIES: &str = "clutter,corridors,halls,two-rooms";

/// Folder of scenes and families.
pub const SCENES: &str = "scenes";

/// Folder of sweeps.
pub const SWEEPS: &str = "experiments/sweeps";

/// The scene of `estimate`.
#[derive(Debug, Args)]
pub struct SceneOptions {
    /// Scene or family of scenes: a name of `list`, or a file
    #[arg(value_name = "SCENE", value_parser = scene())]
    pub scene: PathBuf,
    /// Which scene of the family [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub layout: Option<u64>,
    /// Side of a cell in metres, instead of the scene's
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub grid: Option<f64>,
    /// How the table is printed
    #[command(flatten)]
    pub print: FormatOption,
}

/// The file of a family or scene by what a file calls it: a bare name is `scenes/NAME.toml`.
pub fn path_of(name: &str) -> PathBuf {
    if bare(name) { Path::new(SCENES).join(format!("{name}.toml")) } else { PathBuf::from(name) }
}

/// A scene or family of the command line, as a value of clap: a file of the working folder, with or without `.toml`, goes before
/// `scenes/NAME.toml`.
pub(crate) fn scene() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().map(|path| named(path, SCENES))
}

/// A sweep of the command line, as [`scene`] from the folder of sweeps.
pub(crate) fn sweep() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().map(|path| named(path, SWEEPS))
}

/// A scene or family as [`scene`]; where there is none of the name, a sweep as [`sweep`].
pub(crate) fn described() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().map(|path| {
        let [scene, sweep] = [SCENES, SWEEPS].map(|folder| named(path.clone(), folder));
        if !strict::is_file(&scene) && strict::is_file(&sweep) { sweep } else { scene }
    })
}

/// A file of the command line that may be a scene, as [`scene`], or any other file; true for a scene.
pub fn or_file(path: &Path) -> (PathBuf, bool) {
    if path.extension().is_some_and(|extension| extension == "toml") {
        return (path.to_owned(), true);
    }
    let scene = named(path.to_owned(), SCENES);
    let known = !path.exists() && scene != path && strict::is_file(&scene);
    if known { (scene, true) } else { (path.to_owned(), false) }
}

fn named(path: PathBuf, folder: &str) -> PathBuf {
    // Names of a list may have blanks about them.
    let Some(name) = path.to_str().map(str::trim) else { return path };
    let file = format!("{name}.toml");
    if !bare(name) || Path::new(name).exists() {
        PathBuf::from(name)
    } else if Path::new(&file).is_file() {
        PathBuf::from(file)
    } else {
        Path::new(folder).join(file)
    }
}

fn bare(name: &str) -> bool {
    !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_')
}

/// The families of the given files.
///
/// # Errors
/// A family that cannot be read, or two of a name.
pub fn families(paths: &[PathBuf]) -> Result<Vec<Family>, Failure> {
    let mut families: Vec<Family> = Vec::new();
    for path in paths {
        let family = Family::load(path)?;
        if families.iter().any(|other| other.name == family.name) {
            let name = &family.name;
            let message =
                format!("--families: {}: a family named {name:?} is among them; name each once", path.display());
            return Err(Failure::BadInput(message));
        }
        families.push(family);
    }
    Ok(families)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bare_name_is_one_of_the_scenes() {
        assert_eq!(path_of("two-rooms"), Path::new("scenes/two-rooms.toml"));
        assert_eq!(path_of("my/halls.toml"), Path::new("my/halls.toml"));
        assert_eq!(path_of("halls.toml"), Path::new("halls.toml"));
        assert_eq!(named("two-rooms".into(), SCENES), Path::new("scenes/two-rooms.toml"));
        assert_eq!(named(" cell-size".into(), SWEEPS), Path::new("experiments/sweeps/cell-size.toml"));
        assert_eq!(named("./two-rooms".into(), SCENES), Path::new("./two-rooms"));
        assert_eq!(named("Cargo".into(), SCENES), Path::new("Cargo.toml"), "one of the working folder goes before");
        assert_eq!(named("src".into(), SCENES), Path::new("src"), "a folder is named, and refused as one");
    }

    #[test]
    fn what_is_no_scene_is_a_file() {
        let is_scene = |path: &str| or_file(Path::new(path)).1;
        assert!(is_scene("mine.toml") && !is_scene("robot.log") && !is_scene("robot"));
        assert!(!is_scene("scenes/logs/aces.clf.bz2"), "a log that comes with the program");
    }
}
