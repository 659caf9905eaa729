//! A job: one drive through one world, mapped by all mappers with the same settings. It holds all that decides its
//! rows, so that it can run anywhere and in any order.

use std::panic::{AssertUnwindSafe, catch_unwind};

use mapper::catalogue::{Entry, find};
use mapper::{CorrelationLaw, Model, Prior, Reconciliation, Tuning, estimate};
use sensor::Stereo;
use serde::{Deserialize, Serialize};

use super::parameters::{Parameter, Settings, number_of, parameter, word_of, wrong_poses};
use super::row::{SweepRow, rows};
use super::source::{SourceFile, SourceText};
use crate::failure::{Failure, panic_text};
use crate::output::digest;
use crate::programs::options::ProgramRecord;
use crate::worlds::aligned::{ALIGNED, aligned};
use crate::worlds::condition::AS_BELIEVED;
use crate::worlds::drives;
use crate::worlds::ground::Ground;
use crate::worlds::run::{Keep, Trial};
use crate::worlds::site::{Assumptions, Site};

/// A job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Job {
    /// Scene or family file.
    pub file: String,
    /// Digest of its content, see [`SourceFile`].
    pub digest: String,
    /// Whether it is a family, of which the seed is also the layout.
    pub family: bool,
    /// Seed.
    pub seed: u64,
    /// Parameters that are not as in the file or by default.
    pub settings: Settings,
    /// Names of the mappers.
    pub mappers: Vec<String>,
    /// The programs among them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub programs: Vec<ProgramRecord>,
    /// Names of the regions.
    pub regions: Vec<String>,
}

/// The part of a job that decides the readings.
#[derive(Serialize)]
struct Readings<'a> {
    digest: &'a str,
    seed: u64,
    settings: Settings,
}

impl Job {
    /// The job as JSON, with keys in a fixed order.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default() // plain values under plain keys
    }

    /// What names it: the first 16 digits of the digest of all that it holds, whatever its order or shard. The name
    /// of the file does not count; its content does.
    pub fn id(&self) -> u64 {
        digest::number(Self { file: String::new(), ..self.clone() }.json().as_bytes())
    }

    /// The seed of the readings, from the digest of what decides them: jobs that differ only in what mappers make of
    /// their readings have the same ones, and can be compared in pairs.
    pub fn readings_seed(&self) -> u64 {
        let of_world = |key: &String| parameter(key).is_some_and(Parameter::of_world);
        let settings = self.settings.iter().filter(|(key, _)| of_world(key));
        let settings = settings.map(|(key, value)| (key.clone(), value.clone())).collect();
        let world = Readings { digest: &self.digest, seed: self.seed, settings };
        digest::number(serde_json::to_string(&world).unwrap_or_default().as_bytes())
    }

    /// Runs the job and gives its rows. What goes wrong in a world or a mapper, even a panic, is a row with the error.
    ///
    /// # Errors
    /// A file that cannot be read, or whose content is not what it was when the job was planned: that is no result, and
    /// another time it may be one.
    pub fn run(&self) -> Result<Vec<SweepRow>, Failure> {
        let source =
            SourceFile { file: self.file.clone(), digest: self.digest.clone(), family: self.family }.source()?;
        let rows = |mappers: &[String]| caught(|| self.map(&source, mappers));
        Ok(rows(&self.mappers).unwrap_or_else(|error| match self.mappers.as_slice() {
            [] => Vec::new(),
            [one] => vec![SweepRow::failed(one, &error)],
            // One mapper's failure is not that of the others: they have their rows if they are run alone.
            all => {
                let alone = |name: &String| {
                    rows(std::slice::from_ref(name)).unwrap_or_else(|e| vec![SweepRow::failed(name, &e)])
                };
                all.iter().flat_map(alone).collect()
            }
        }))
    }

    fn map(&self, source: &SourceText, names: &[String]) -> Result<Vec<SweepRow>, Failure> {
        let Site { mut ground, setup } = self.site(source)?;
        if !self.regions.iter().any(|region| region == drives::REGION.name()) {
            ground = ground.without_drives();
        }
        let ground = self.thinned(ground).with_poses(wrong_poses(&self.settings));
        let unknown = |name: &str| Failure::BadInput(format!("there is no mapper {name:?}"));
        let program = |name: &str| self.programs.iter().find(|program| program.name == name);
        let entry = |name: &String| match (find(name), program(name)) {
            (Some(entry), _) => Ok(entry),
            (None, Some(program)) => program.entry(),
            (None, None) => Err(unknown(name)),
        };
        let mappers: Vec<&Entry> = names.iter().map(entry).collect::<Result<_, _>>()?;
        let trial = ground.trial(self.readings_seed(), &mappers, &setup, &Keep::default(), &|_, _| {})?;
        let aligned = self.aligned(&ground, &trial, &mappers, &setup)?;
        rows(self, &ground, &trial, &aligned)
    }

    /// The trials of the mappers from poses that their alignments move, where that is asked for; none of one that gave no map.
    fn aligned(
        &self,
        ground: &Ground,
        trial: &Trial,
        mappers: &[&Entry],
        setup: &Model,
    ) -> Result<Vec<Option<Trial>>, Failure> {
        if !self.regions.iter().any(|region| region == ALIGNED) {
            return Ok(Vec::new());
        }
        let again = |(run, entry): (usize, &&Entry)| match trial.fault(run) {
            Some(_) => Ok(None),
            None => Ok(Some(aligned(ground, (trial, run), entry, setup)?.0)),
        };
        mappers.iter().enumerate().map(again).collect()
    }

    /// The world, and what the mappers assume of it: the camera that is simulated, unless a setting names another.
    fn site(&self, source: &SourceText) -> Result<Site, Failure> {
        let number = |key| number_of(&self.settings, key);
        let scene = source.scene(self.seed, &self.settings)?;
        let simulated = scene.matcher.stereo;
        let camera = Stereo {
            correct_match: number("believed_correct_match").unwrap_or(simulated.correct_match),
            disparity_sigma: number("believed_sigma").unwrap_or(simulated.disparity_sigma),
            ..simulated
        };
        let reconciliation = match word_of(&self.settings, "reconciliation") {
            Some("touched") => Reconciliation::Touched,
            Some(_) => Reconciliation::AllEdges,
            None => Reconciliation::default(),
        };
        let (prior, tuning) = (self.prior(), self.tuning()?);
        Site::of(
            scene,
            &AS_BELIEVED,
            &Assumptions { prior, reconciliation, tuning, max_range_m: number("max_range"), camera: Some(camera) },
        )
    }

    /// Parameters of rules other than the paper's.
    fn tuning(&self) -> Result<Tuning, Failure> {
        let number = |key| number_of(&self.settings, key);
        if let (Some(low), Some(high)) = (number("clamp_low"), number("clamp_high"))
            && low > high
        {
            return Err(Failure::BadInput(format!("clamp_low = {low} is above clamp_high = {high}; exchange them")));
        }
        Ok(Tuning {
            half_width: number("half_width"),
            clamp_low: number("clamp_low"),
            clamp_high: number("clamp_high"),
            hit: number("hit"),
            miss: number("miss"),
            start: number("start"),
            coupling: number("coupling"),
            damping: number("damping"),
            sweeps: number("sweeps").map(|sweeps| sweeps as usize),
        })
    }

    fn prior(&self) -> Prior {
        let number = |key| number_of(&self.settings, key);
        let default = Prior::default();
        let occupancy = number("prior").unwrap_or(default.occupancy);
        let by_length = number("assumed_length").map(|length_m| estimate::law(occupancy, length_m, Prior::REFERENCE_M));
        let correlation_law = match word_of(&self.settings, "correlation_law") {
            Some("fixed") => CorrelationLaw::Fixed,
            Some(_) => CorrelationLaw::Scaled,
            None => default.correlation_law,
        };
        Prior {
            occupancy,
            correlation: number("correlation").or(by_length).unwrap_or(default.correlation),
            correlation_law,
        }
    }

    /// Leaves so many scans in the drive, evenly spread, as one stage.
    fn thinned(&self, ground: Ground) -> Ground {
        let Some(scans) = number_of(&self.settings, "scans") else { return ground };
        let all = ground.scans();
        let kept = (scans as usize).clamp(1, all.max(1));
        // The k-th kept is the last of the k-th of equal parts of the drive.
        let left: Vec<usize> = (0..all).filter(|number| (number + 1) * kept / all > number * kept / all).collect();
        ground.with_scans(&left)
    }
}

/// What fails, or panics, in words.
fn caught(run: impl FnOnce() -> Result<Vec<SweepRow>, Failure>) -> Result<Vec<SweepRow>, String> {
    let run = || run().map_err(|failure| failure.to_string());
    catch_unwind(AssertUnwindSafe(run))
        .unwrap_or_else(|panic| Err(format!("panic: {}", panic_text(&*panic).unwrap_or("without a message"))))
}

#[cfg(test)]
mod tests {
    use super::super::parameters::Value;
    use super::*;

    fn job() -> Job {
        let settings = [("grid", 0.1), ("disparity_sigma", 1.0)];
        Job {
            file: "scenes/room.toml".to_owned(),
            digest: "d".to_owned(),
            family: false,
            seed: 3,
            settings: settings.map(|(key, number)| (key.to_owned(), Value::Number(number))).into(),
            mappers: vec!["visibility".to_owned()],
            programs: Vec::new(),
            regions: vec!["observable".to_owned()],
        }
    }

    fn with(key: &str, value: f64) -> Job {
        let mut job = job();
        job.settings.insert(key.to_owned(), Value::Number(value));
        job
    }

    #[test]
    fn readings_are_shared_where_only_belief_differs() {
        let same = [with("grid", 0.2), with("believed_sigma", 2.0), with("correlation", 0.0), with("scans", 5.0)];
        for other in &same {
            assert_eq!(other.readings_seed(), job().readings_seed());
            assert_ne!(other.id(), job().id());
        }
        let others = [with("disparity_sigma", 2.0), Job { seed: 4, ..job() }, Job { digest: "e".to_owned(), ..job() }];
        for other in &others {
            assert_ne!(other.readings_seed(), job().readings_seed());
            assert_ne!(other.id(), job().id());
        }
    }

    #[test]
    fn an_id_is_of_what_is_done_not_of_names() {
        let elsewhere = Job { file: "/other/place.toml".to_owned(), ..job() };
        assert_eq!(elsewhere.id(), job().id());
        assert_eq!(serde_json::from_str::<Job>(&job().json()).expect("a job"), job());
        assert_eq!(job().id(), 0x0185_5a91_98d6_cc79, "an id that changes makes every result in the world worthless");
    }

    #[test]
    fn a_failure_is_a_row_and_not_that_of_other_mappers() {
        let scene = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/room.toml");
        let mappers = ["prior", "no such mapper"].map(str::to_owned).to_vec();
        let site = SourceFile::load(&scene, false).expect("a scene");
        let mut job = Job { file: site.file, digest: site.digest, mappers, ..job() };
        job.settings.insert("grid".to_owned(), Value::Number(0.5));
        let rows = job.run().expect("the file is as it was");
        assert_eq!(rows.len(), 2);
        assert!(rows[0].mapper == "prior" && rows[0].error.is_empty() && rows[0].values[0].is_some());
        assert!(rows[1].mapper == "no such mapper" && rows[1].error.contains("there is no mapper"));

        let changed = Job { digest: "another".to_owned(), ..job.clone() };
        assert!(changed.run().expect_err("no result").to_string().contains("has changed since the sweep was planned"));
        let away = Job { file: "nowhere.toml".to_owned(), ..job };
        assert!(away.run().expect_err("no result").to_string().contains("nowhere.toml"));
    }

    #[test]
    fn a_panic_is_caught_with_what_it_said() {
        let said = caught(|| -> Result<Vec<SweepRow>, Failure> { panic!("cell {} is lost", 7) });
        assert_eq!(said, Err("panic: cell 7 is lost".to_owned()));
    }
}
