//! Maps of single sensors, put together: what is done where every sensor has its own map.
//!
//! The mappers of this crate take the readings of all sensors into one map. The rivals here keep a map of each sensor by itself, made by the
//! same rule, and combine the probabilities cell by cell when the map is asked for.

use std::cell::OnceCell;

use grid::Raster;
use sensor::{Scan, SensorModel};

use crate::belief::probability::{bounded, from_log_odds, log_odds};
use crate::mapper::{Mapper, Work};
use crate::memory::Held as _;
use crate::model::Model;

/// A map that differs from the prior by no more than this, in probability, says nothing of a cell.
const KNOWN: f64 = 1e-6;

/// How the probabilities of one cell in the maps of several sensors become one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fusion {
    /// The independent opinion pool: what every map adds to the log odds of the prior is added,
    /// `ln(p / (1 - p)) = ln(p0 / (1 - p0)) + sum over sensors of (ln(p_s / (1 - p_s)) - ln(p0 / (1 - p0)))` (Berger, "Statistical Decision Theory and Bayesian
    /// Analysis", 1985, 4.11; for sonar and stereo Matthies and Elfes, ICRA 1988).
    Pool,
    /// The greatest probability of those maps that know anything of the cell, as costmaps take the maximum over their layers and pass over
    /// those without information (`CostmapLayer::updateWithMax` of `costmap_2d` 1.17).
    Maximum,
    /// Obstacles of either sensor, and free where the laser says so: the integration of Miura, Negishi and Shirai, "Mobile robot map generation by
    /// integrating omnidirectional stereo and laser range finder", IROS 2002, as far as public material tells it.
    ///
    /// Assumed are: a map says *occupied* above one half and *free* below the prior; what any map calls occupied is (the greatest probability); else what a
    /// laser calls free is free (its probability); else the maps are pooled.
    Miura,
}

/// One map for each sensor of a model, all made by the same rule. What several sensors read at one time stays apart.
pub struct PerSensor {
    maps: Vec<Box<dyn Mapper>>,
    /// Which sensors are lasers.
    lasers: Vec<bool>,
    fusion: Fusion,
    /// Probability of an unseen cell.
    prior: f64,
    fused: OnceCell<Raster<f64>>,
}

impl PerSensor {
    /// A map of every sensor by the rule that `build` makes, put together by `fusion`.
    pub fn new(model: &Model, fusion: Fusion, build: &dyn Fn(&Model) -> Box<dyn Mapper>) -> Self {
        Self {
            maps: model.sensors.iter().map(|_| build(model)).collect(),
            lasers: model.sensors.iter().map(|sensor| is_laser(&**sensor)).collect(),
            fusion,
            prior: model.prior.marginal(),
            fused: OnceCell::new(),
        }
    }

    /// The probability of a cell from those of the single maps, in the order of the sensors. A map that knows nothing of it has no say.
    fn fuse(&self, of_maps: &[f64]) -> f64 {
        let mut known = of_maps.iter().copied().filter(|p| knows(self.prior, *p));
        match (known.next(), known.next()) {
            (None, _) => of_maps[0],
            (Some(one), None) => one,
            _ => match self.fusion {
                Fusion::Pool => pool(self.prior, of_maps),
                Fusion::Maximum => maximum(self.prior, of_maps),
                Fusion::Miura => of_miura(self.prior, of_maps, &self.lasers),
            },
        }
    }
}

/// Whether a map with this probability of a cell knows anything of it.
fn knows(prior: f64, p: f64) -> bool {
    (p - prior).abs() > KNOWN
}

fn is_laser(sensor: &dyn SensorModel) -> bool {
    sensor.parameters().is_some_and(|parameters| parameters.kernel == "laser")
}

/// The independent opinion pool of one cell, see [`Fusion::Pool`]; probabilities, 0 to 1.
fn pool(prior: f64, of_maps: &[f64]) -> f64 {
    let before = log_odds(prior);
    let known = of_maps.iter().filter(|p| knows(prior, **p));
    from_log_odds(before + known.map(|p| log_odds(*p) - before).sum::<f64>())
}

/// The greatest of those that differ from the prior; the prior where none does.
fn maximum(prior: f64, of_maps: &[f64]) -> f64 {
    let known = of_maps.iter().copied().filter(|p| knows(prior, *p));
    known.reduce(f64::max).unwrap_or(bounded(prior))
}

/// The rule of Miura et al. (2002) for one cell.
///
/// Public material tells that both sensors have a probabilistic map of their own, since what they see of one obstacle differs, and that the maps
/// are put together by a rule for what each says of a cell. Assumed are the rest: a map says *occupied* above one half and *free* below the
/// prior, and
///
/// 1. a cell that any map calls occupied is occupied: the greatest probability;
/// 2. else a cell that a laser calls free is free: the laser's probability, whatever a camera without a decision makes of it;
/// 3. else no laser knows the cell, and the maps are pooled.
fn of_miura(prior: f64, of_maps: &[f64], lasers: &[bool]) -> f64 {
    let greatest = of_maps.iter().copied().fold(0.0, f64::max);
    if greatest > 0.5 {
        return greatest;
    }
    let of_lasers = of_maps.iter().zip(lasers).filter(|(_, laser)| **laser).map(|(p, _)| *p);
    let free = of_lasers.filter(|p| *p < prior - KNOWN).reduce(f64::min);
    free.unwrap_or_else(|| pool(prior, of_maps))
}

impl Mapper for PerSensor {
    fn integrate(&mut self, scan: &Scan) {
        self.fused.take();
        let (sensor, sensors) = (scan.sensor, self.maps.len());
        let map = self.maps.get_mut(sensor);
        map.unwrap_or_else(|| panic!("a scan of sensor {sensor}: the model has {sensors}, numbered from 0"))
            .integrate(scan);
    }

    fn settle(&mut self) {
        self.fused.take();
        self.maps.iter_mut().for_each(|map| map.settle());
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.fused.get_or_init(|| {
            let maps: Vec<&Raster<f64>> = self.maps.iter().map(|map| map.occupancy()).collect();
            let mut of_maps = vec![0.0; maps.len()];
            let spec = *maps[0].spec();
            let fused = (0..spec.cells()).map(|cell| {
                of_maps.iter_mut().zip(&maps).for_each(|(p, map)| *p = map[cell]);
                self.fuse(&of_maps)
            });
            Raster::new(spec, fused.collect())
        })
    }

    fn occupied(&self, cell: usize) -> f64 {
        self.fuse(&self.maps.iter().map(|map| map.occupied(cell)).collect::<Vec<_>>())
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        let maps = self.maps.iter().map(|map| map.fork()).collect::<Option<_>>()?;
        let (lasers, fused) = (self.lasers.clone(), OnceCell::new());
        Some(Box::new(Self { maps, lasers, fusion: self.fusion, prior: self.prior, fused }))
    }

    fn work(&self) -> Work {
        let all = self.maps.iter().map(|map| map.work());
        let of_maps = all
            .fold(Work::default(), |sum, work| Work { cells: sum.cells + work.cells, bytes: sum.bytes + work.bytes });
        Work { bytes: of_maps.bytes + self.fused.held(), ..of_maps }
    }

    fn skipped(&self) -> u64 {
        self.maps.iter().map(|map| map.skipped()).sum()
    }

    fn leaves_out(&self) -> bool {
        self.maps.iter().any(|map| map.leaves_out())
    }
}

#[cfg(test)]
mod tests;
