//! Worlds read back from a page, as its script reads them: for tests of what a page shows.

use std::collections::HashMap;

use grid::{GridSpec, Raster};
use score::Region;
use serde::Deserialize;

use super::coder::Decoder;
use super::number::{Numbers, Series};
use super::{BASE64_STANDARD, MOVING, Shape, film, of_level};
use crate::worlds::film::PARTS;
use crate::worlds::levels::{FINE, levels};
use base64::Engine as _;

/// A world of a page.
pub struct DecodedWorld {
    /// Its name.
    pub name: String,
    /// The truth.
    pub truth: Option<Raster<Option<bool>>>,
    /// The truth at every moment, of a world that moves; else nothing.
    pub truths: Vec<Raster<Option<bool>>>,
    /// Numbers of scans after which it can be looked at.
    pub moments: Vec<usize>,
    /// Names of the stages, with the numbers of their moments.
    pub stages: Vec<(String, usize)>,
    /// The part of every cell at every moment.
    pub parts: Vec<Raster<Option<Region>>>,
    /// The regions of a world that moves at every moment, bit k for the k-th of [`score::MovingRegion::ALL`]; else nothing.
    pub moving: Vec<Raster<u8>>,
    /// The regions that the scene names.
    pub regions: Vec<(String, Raster<bool>)>,
    /// Readings, scan after scan, px or m.
    pub readings: Vec<Option<f64>>,
    /// The sensors of several by name, with their readings as above.
    pub sensors: Vec<(String, Vec<Option<f64>>)>,
    /// The mappers.
    pub mappers: Vec<DecodedMapper>,
}

/// A mapper of a page.
pub struct DecodedMapper {
    /// Its name.
    pub name: String,
    /// The moments that it has maps at.
    pub moments: Vec<usize>,
    /// Occupancy at each of them.
    pub maps: Vec<Raster<f64>>,
    /// Metrics at each of them, by region and name.
    pub exact: HashMap<(String, String), Vec<Option<f64>>>,
}

#[derive(Deserialize)]
struct Data {
    scale: Scale,
    worlds: Vec<World>,
}

#[derive(Deserialize)]
struct Scale {
    exact: Vec<String>,
    exact_step: f64,
}

#[derive(Deserialize)]
struct World {
    name: String,
    cell_m: f64,
    origin_m: [f64; 2],
    width: usize,
    height: usize,
    prior: f64,
    scans: Option<Scans>,
    moments: Vec<usize>,
    stages: Vec<Stage>,
    regions: Vec<Named>,
    region_names: Vec<String>,
    truth: Option<String>,
    #[serde(default)]
    truths: Option<String>,
    #[serde(default)]
    moving: Option<String>,
    parts: String,
    #[serde(default)]
    sensors: Vec<Sensor>,
    mappers: Vec<Mapper>,
}

#[derive(Deserialize)]
struct Sensor {
    name: String,
    scans: Scans,
}

#[derive(Deserialize)]
struct Scans {
    step: f64,
    fans: Vec<Vec<f64>>,
    fan: Vec<usize>,
    readings: String,
}

#[derive(Deserialize)]
struct Stage {
    name: String,
    moment: usize,
}

#[derive(Deserialize)]
struct Named {
    name: String,
    cells: String,
}

#[derive(Deserialize)]
struct Mapper {
    name: String,
    moments: Vec<usize>,
    levels: String,
    fine_moments: Vec<usize>,
    fine: String,
    exact: Option<String>,
}

fn bytes(text: &str) -> Option<Vec<u8>> {
    BASE64_STANDARD.decode(text).ok()
}

/// The worlds of a page; nothing of a page that has none, or is damaged.
pub fn decoded(html: &str) -> Option<Vec<DecodedWorld>> {
    let (_, data) = html.split_once("id=\"viewer-data\">")?;
    let data: Data = serde_json::from_str(data.split_once("</script>")?.0).ok()?;
    data.worlds.iter().map(|world| world.decoded(&data.scale)).collect()
}

impl World {
    fn shape(&self, values: usize, start: u8) -> Shape {
        Shape { width: self.width, cells: self.width * self.height, values, start }
    }

    fn decoded(&self, scale: &Scale) -> Option<DecodedWorld> {
        let spec = GridSpec { cell_m: self.cell_m, origin_m: self.origin_m, width: self.width, height: self.height };
        let one = |text: &str, values| {
            Some(Raster::new(spec, film::unpacked(&bytes(text)?, 1, self.shape(values, 0)).remove(0)))
        };
        let known = |cell: &u8| [Some(false), Some(true), None][usize::from(*cell)];
        let truth = |text: &String| Some(one(text, 3)?.map(known));
        let truths = self.truths.as_ref().map_or(Some(Vec::new()), |text| {
            let films = film::unpacked(&bytes(text)?, self.moments.len(), self.shape(3, 0));
            Some(films.into_iter().map(|cells| Raster::new(spec, cells.iter().map(known).collect())).collect())
        })?;
        let moving = self.moving.as_ref().map_or(Some(Vec::new()), |text| {
            let films = film::unpacked(&bytes(text)?, self.moments.len(), self.shape(MOVING, 0));
            Some(films.into_iter().map(|cells| Raster::new(spec, cells)).collect())
        })?;
        let part = |code: &u8| usize::from(*code).checked_sub(1).map(|place| PARTS[place]);
        let parts = film::unpacked(
            &bytes(&self.parts)?,
            if self.truth.is_some() { self.moments.len() } else { 0 },
            self.shape(1 + PARTS.len(), 0),
        );
        let region = |named: &Named| Some((named.name.clone(), one(&named.cells, 2)?.map(|cell| *cell == 1)));
        Some(DecodedWorld {
            name: self.name.clone(),
            truth: self.truth.as_ref().map(truth).map_or(Some(None), |truth| Some(Some(truth?)))?,
            truths,
            moving,
            moments: self.moments.clone(),
            stages: self.stages.iter().map(|stage| (stage.name.clone(), stage.moment)).collect(),
            parts: parts.into_iter().map(|cells| Raster::new(spec, cells.iter().map(part).collect())).collect(),
            regions: self.regions.iter().map(region).collect::<Option<_>>()?,
            readings: self.scans.as_ref().map_or(Some(Vec::new()), Scans::readings)?,
            sensors: self
                .sensors
                .iter()
                .map(|sensor| Some((sensor.name.clone(), sensor.scans.readings()?)))
                .collect::<Option<_>>()?,
            mappers: self.mappers.iter().map(|mapper| mapper.decoded(self, spec, scale)).collect::<Option<_>>()?,
        })
    }
}

impl Scans {
    fn readings(&self) -> Option<Vec<Option<f64>>> {
        let rays = self.fan.iter().map(|fan| self.fans[*fan].len()).sum();
        let text = bytes(&self.readings)?;
        let (mut decoder, mut series) = (Decoder::new(&text), Series::default());
        Some((0..rays).map(|_| Some(f64::from(series.code(&mut decoder, None)?) * self.step)).collect())
    }
}

impl Mapper {
    fn decoded(&self, world: &World, spec: GridSpec, scale: &Scale) -> Option<DecodedMapper> {
        let start = levels().of(world.prior, None);
        let shape = world.shape(levels().log_odds.len(), start);
        let films = film::unpacked(&bytes(&self.levels)?, self.moments.len(), shape);
        let text = bytes(&self.fine)?;
        let (mut decoder, mut numbers) = (Decoder::new(&text), Numbers::default());
        let probability = |log_odds: f64| 1.0 / (1.0 + libm::exp(-log_odds));
        let map = |(moment, film): (&usize, Vec<u8>)| {
            let fine = self.fine_moments.contains(moment);
            let cell = |level: &u8| match fine {
                true => probability(f64::from(of_level(*level) + numbers.code(&mut decoder, 0)) * FINE),
                false => probability(levels().log_odds[usize::from(*level)]),
            };
            Raster::new(spec, film.iter().map(cell).collect())
        };
        Some(DecodedMapper {
            name: self.name.clone(),
            moments: self.moments.clone(),
            maps: self.moments.iter().zip(films).map(map).collect(),
            exact: match &self.exact {
                Some(text) => self.exact(&bytes(text)?, world, scale),
                None => HashMap::new(),
            },
        })
    }

    fn exact(&self, text: &[u8], world: &World, scale: &Scale) -> HashMap<(String, String), Vec<Option<f64>>> {
        let mut decoder = Decoder::new(text);
        let mut rows = HashMap::new();
        for region in &world.region_names {
            for metric in &scale.exact {
                let mut series = Series::default();
                let value = |_| Some(f64::from(series.code(&mut decoder, None)?) * scale.exact_step);
                rows.insert((region.clone(), metric.clone()), (0..self.moments.len()).map(value).collect());
            }
        }
        rows
    }
}
