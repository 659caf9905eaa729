//! The cells that maps are scored on.

use std::collections::BTreeMap;
use std::path::Path;

use grid::{DigitalLine, Raster};
use logs::{Log, LogError, Options, Sensor};
use scene::World;
use score::{Region, Sight, Sightings};

use super::truth::Truth;
use crate::failure::Failure;
use crate::worlds::kernels::SonarOptions;
use crate::worlds::reading;

/// The regions in the order of tables, and the cells that can be missed.
pub(super) struct Regions {
    pub(super) masks: Vec<(String, Raster<bool>)>,
    pub(super) surface: Raster<bool>,
    /// From where cells were seen; none without scans.
    pub(super) seen: Option<Seen>,
}

/// What the rays of the scans met, without noise.
pub(super) struct Seen {
    /// The cells that could be seen.
    pub(super) observable: Raster<bool>,
    /// The range from which each cell was seen best, m; infinity of a cell that was not seen.
    pub(super) nearest_m: Raster<f64>,
    /// The number of rays that looked at each cell.
    pub(super) looks: Raster<f64>,
}

impl Regions {
    /// The whole known truth, every occupied cell of which can be missed, and what the scene names.
    pub(super) fn whole(truth: &Truth) -> Self {
        let all = truth.cells.map(Option::is_some);
        let surface = truth.cells.map(|cell| *cell == Some(true));
        let masks = std::iter::once((Region::All.name().to_owned(), all)).chain(named(truth)).collect();
        Self { masks, surface, seen: None }
    }

    /// What the rays of a log could see, cast without noise in the truth, and what the scene names.
    ///
    /// # Errors
    /// A log that cannot be read; scans that see nothing of the truth.
    pub(super) fn seen(scans: &Path, truth: &Truth) -> Result<Self, Failure> {
        let refused = |error: LogError| Failure::BadInput(error.to_string());
        let mut log = Log::open(scans, &Options::default()).map_err(refused)?;
        let mut walls = match &truth.scene {
            Some(scene) => Walls::World(Box::new(World::new(scene))),
            None => Walls::Cells(&truth.cells, Box::default()),
        };
        let (origin_m, cell_m) = (truth.frame.spec.origin_m, truth.frame.spec.cell_m);
        let (sin, cos) = libm::sincos(truth.frame.yaw_rad);
        let mut sightings = Sightings::new(&truth.cells);
        let mut reaches: BTreeMap<usize, Cone> = BTreeMap::new();
        while let Some(event) = log.next_event() {
            let event = event.map_err(refused)?;
            let cone = reaches.entry(event.sensor).or_insert_with(|| Cone::of(event.kind, cell_m));
            for ray in event.scan.rays() {
                let [u, v] = truth.frame.to_cells(ray.origin_m);
                let from = [origin_m[0] + u * cell_m, origin_m[1] + v * cell_m];
                let mut hit_m = |offset_rad: &f64| {
                    let [x, y] = event.scan.pose.direction(ray.bearing_rad + offset_rad);
                    let direction = [cos * x + sin * y, -sin * x + cos * y];
                    (direction, walls.hit_m(from, direction).filter(|hit| *hit < cone.most_m))
                };
                let hits: Vec<([f64; 2], Option<f64>)> = cone.offsets_rad.iter().map(&mut hit_m).collect();
                if let [(direction, hit)] = hits[..] {
                    let range_m = hit.or(Some(cone.most_m).filter(|most| most.is_finite()));
                    sightings.add(&Sight { origin_m: from, direction, range_m });
                    continue;
                }
                // A cone tells nothing of what is behind the nearest thing in it.
                let reach_m = hits.iter().filter_map(|(_, hit)| *hit).fold(cone.most_m, f64::min);
                for (direction, range_m) in hits {
                    sightings.add_within(&Sight { origin_m: from, direction, range_m }, reach_m);
                }
            }
        }
        reading::tell(&scans.display().to_string(), log.report());
        let observable = sightings.mask(Region::Observable);
        if !observable.values().contains(&true) {
            return Err(Failure::BadInput(format!(
                "{}: its rays see no known cell of the truth; give scans whose poses are in the frame of the truth",
                scans.display()
            )));
        }
        let by_rays = Region::ALL.map(|region| (region.name().to_owned(), sightings.mask(region)));
        let masks = by_rays.into_iter().chain(named(truth)).collect();
        let (nearest_m, looks) = (sightings.nearest_m().clone(), sightings.looks().map(|looks| f64::from(*looks)));
        let seen = Some(Seen { observable, nearest_m, looks });
        Ok(Self { masks, surface: sightings.surface().clone(), seen })
    }

    /// The cells of the first region that the terminal shows.
    pub(super) fn first(&self) -> &Raster<bool> {
        let first = self.shown().into_iter().next();
        let found = self.masks.iter().find(|(name, _)| Some(name) == first.as_ref());
        found.map_or(&self.surface, |(_, mask)| mask)
    }

    /// The regions that the terminal shows: what could be seen, if that is known, and what the scene names.
    pub(super) fn shown(&self) -> Vec<String> {
        let parts = [Region::Visible, Region::Surface, Region::Shell, Region::Hidden].map(Region::name);
        let names = self.masks.iter().map(|(name, _)| name).filter(|name| !parts.contains(&name.as_str()));
        names.cloned().collect()
    }
}

/// How far a sensor sees, and the rays that stand for one of its readings.
struct Cone {
    most_m: f64,
    /// Angles to the axis, rad; 0 alone of a sensor that has no cones.
    offsets_rad: Vec<f64>,
}

impl Cone {
    /// Of a sensor of a log, over cells of this side, m; what the log does not tell of sonars is as usual.
    fn of(sensor: Sensor, cell_m: f64) -> Self {
        let (most_m, width_rad) = match sensor {
            Sensor::Laser { max_range_m, .. } => (max_range_m, 0.0),
            Sensor::Stereo => (f64::INFINITY, 0.0),
            Sensor::Sonar { max_range_m, width_rad } => {
                let sonar = SonarOptions::default().sonar(max_range_m, width_rad);
                (sonar.max_range_m, sonar.width_rad)
            }
        };
        let halves = libm::ceil(0.5 * width_rad * most_m / cell_m) as i32;
        let offset = |k: i32| 0.5 * width_rad * f64::from(k) / f64::from(halves);
        let offsets_rad = if width_rad > 0.0 { (-halves..=halves).map(offset).collect() } else { vec![0.0] };
        Self { most_m, offsets_rad }
    }
}

/// What ends a ray: the scene's obstacles, or the cells of a map that are not known to be free.
enum Walls<'a> {
    World(Box<World>),
    Cells(&'a Raster<Option<bool>>, Box<DigitalLine>),
}

impl Walls<'_> {
    /// Range of the first hit, m.
    fn hit_m(&mut self, origin_m: [f64; 2], direction: [f64; 2]) -> Option<f64> {
        match self {
            Self::World(world) => world.cast(origin_m, direction).map(|hit| hit.range_m),
            Self::Cells(cells, line) => {
                line.trace(cells.spec(), origin_m, direction, f64::INFINITY);
                let met = line.cells().iter().position(|cell| cells[*cell] != Some(false))?;
                Some(line.ranges()[met])
            }
        }
    }
}

/// The regions that the scene names.
fn named(truth: &Truth) -> Vec<(String, Raster<bool>)> {
    let regions = truth.scene.iter().flat_map(|scene| &scene.regions);
    regions.map(|region| (region.name.clone(), region.mask(truth.cells.spec()))).collect()
}
