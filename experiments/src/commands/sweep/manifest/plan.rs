//! Making a manifest.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

use super::{Head, Line, MANIFEST, Manifest, shard_of};
use crate::commands::sweep::file::Sweep;
use crate::commands::sweep::job::Job;
use crate::commands::sweep::parameters::{Of, Value, parameter};
use crate::commands::sweep::regions::of_movement;
use crate::commands::sweep::source::SourceFile;
use crate::failure::Failure;
use crate::output::digest::{Running, build};
use crate::output::single::Temporary;

/// A shard has about so many jobs where nobody says how many shards there are to be ...
const JOBS_PER_SHARD: u64 = 100;

/// ... and there are at least so many shards, so that many workers have something to do.
const FEWEST_SHARDS: u64 = 64;

/// So many combinations of settings are tried in every place before the sweep is planned; others are rows with an error.
const MOST_CHECKED: u64 = 10_000;

/// When a manifest takes the place of another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Replace {
    /// Never.
    Never,
    /// If it is of the same sweep, planned by another build.
    OtherBuild,
    /// Whatever it is.
    Always,
}

/// Where a job of the product is, for sorting: 16 bytes for each of millions.
struct Place {
    id: u64,
    number: u64,
}

/// The manifest of a sweep in a folder; what is there already is kept if it is the same.
///
/// # Errors
/// A file of the sweep that cannot be read; another manifest in the folder, unless `replace`; I/O.
pub fn plan(sweep: &Sweep, folder: &Path, shards: Option<u32>, replace: Replace) -> Result<Manifest, Failure> {
    let families = sweep.of_families;
    let sites: Vec<SourceFile> =
        sweep.sites.iter().map(|path| site(sweep, path, families)).collect::<Result<_, _>>()?;
    let settings_count = sweep.settings_count().unwrap_or(0);
    let jobs = sweep.jobs().unwrap_or(0);
    let job = |number: u64| {
        let (settings, rest) = (number % settings_count, number / settings_count);
        let site = &sites[(rest / sweep.seeds) as usize];
        Job {
            file: site.file.clone(),
            digest: site.digest.clone(),
            family: site.family,
            seed: sweep.first_seed + rest % sweep.seeds,
            settings: sweep.settings(settings),
            mappers: sweep.mappers.clone(),
            programs: sweep.programs.clone(),
            regions: sweep.regions.clone(),
        }
    };
    let mut places: Vec<Place> = (0..jobs).map(|number| Place { id: job(number).id(), number }).collect();
    places.sort_unstable_by_key(|place| place.id);
    if let Some(pair) = places.windows(2).find(|pair| pair[0].id == pair[1].id) {
        let same = job(pair[0].number).json() == job(pair[1].number).json();
        let why =
            if same { "two jobs are the same" } else { "two jobs have one id by chance; change any value a little" };
        return Err(Failure::BadInput(format!("the sweep: {why}: {}", job(pair[0].number).json())));
    }
    let usual = jobs.div_ceil(JOBS_PER_SHARD).max(FEWEST_SHARDS);
    let shards = shards.map_or(usual, u64::from).clamp(1, jobs.max(1)) as u32;
    let mut head = Head {
        schema_version: 1,
        sweep: String::new(),
        jobs,
        shards,
        keys: sweep.keys().into_iter().map(str::to_owned).collect(),
        of_movement: of_movement(&sweep.regions),
        build: build()?.to_owned(),
        sites: sites.clone(),
    };

    head.sweep = head.sweep_digest(places.iter().map(|place| format!("{:016x}", place.id)));

    fs::create_dir_all(folder).map_err(|e| Failure::write(folder, &e))?;
    let path = folder.join(MANIFEST);
    let partial = Temporary::beside(&path);
    let write = || -> io::Result<String> {
        let mut digest = Running::default();
        let mut out = BufWriter::new(File::create(partial.path())?);
        let mut put = |line: String| {
            digest.add(line.as_bytes());
            out.write_all(line.as_bytes())
        };
        put(serde_json::to_string(&head)? + "\n")?;
        for (at, place) in places.iter().enumerate() {
            let shard = shard_of(at as u64, jobs, shards);
            let line = Line { id: format!("{:016x}", place.id), shard, job: job(place.number) };
            put(serde_json::to_string(&line)? + "\n")?;
        }
        out.flush()?;
        out.get_ref().sync_all()?;
        Ok(digest.hex())
    };
    let digest = write().map_err(|e| Failure::write(&path, &e))?;
    let stays = path.exists()
        && match (Manifest::open(folder), replace) {
            (_, Replace::Always) => !Manifest::begins(&path),
            (Ok(former), Replace::OtherBuild) => former.head.sweep != head.sweep,
            (Ok(former), Replace::Never) => former.digest != digest,
            (Err(_), _) => true,
        };
    if stays {
        return Err(Failure::BadInput(format!(
            "{}: is the manifest of another sweep, or was planned by another build; choose another folder with --out, or give --replace",
            path.display()
        )));
    }
    partial.publish(&path).map_err(|e| Failure::write(&path, &e))?;
    Manifest::open(folder)
}

/// A place of the sweep, in which all of the sweep's settings are possible.
fn site(sweep: &Sweep, path: &Path, families: bool) -> Result<SourceFile, Failure> {
    let (site, source) = SourceFile::open(path, families)?;
    let of_file = |key: &str| parameter(key).is_some_and(|parameter| matches!(parameter.of, Of::File(_)));
    let axes = sweep.axes.iter().filter(|axis| axis.keys.iter().any(|key| of_file(key))).cloned().collect();
    let mut narrowed = Sweep { axes, ..sweep.clone() };
    narrowed.set.retain(|key, _| of_file(key));
    if narrowed.axes.is_empty() && narrowed.set.is_empty() {
        return Ok(site);
    }
    for number in 0..narrowed.settings_count().unwrap_or(u64::MAX).min(MOST_CHECKED) {
        let settings = narrowed.settings(number);
        source.check(&settings).map_err(|error| {
            let given = settings.iter().map(|(key, value)| match value {
                Value::Number(number) => format!("{key} = {number}"),
                Value::Word(word) => format!("{key} = \"{word}\""),
            });
            Failure::BadInput(format!("the sweep sets {}: {error}", given.collect::<Vec<_>>().join(", ")))
        })?;
    }
    Ok(site)
}
