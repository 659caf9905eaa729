//! A map of every sensor by itself, and the scans that were kept back from it.

use std::collections::BTreeMap;

use grid::Raster;
use mapper::{Belief, FastVisibility, Mapper as _, Model, Predictive};
use rayon::prelude::*;
use score::{SeriesMean, series_mean};
use sensor::{Pose, Ray, Scan, SensorModel};

use super::evidence::{Named, Suspect, Turn, Visit};
use crate::failure::Failure;

/// Scans kept back of each sensor, at most; what sonars that are mounted together read at one time is one ...
const MOST_SCANS: usize = 128;

/// ... and rays of each of them.
const MOST_RAYS: usize = 60;

/// A sensor is turned back by up to so many degrees, either way, degree by degree.
const MOST_DEGREES: i32 = 10;

/// A robot that has gone so far, m, or turned by so much, rad, looks at something else.
const MOVED: f64 = 1.0;

/// The maps and scans of all sensors, each turned back by some angle.
pub(super) struct Panel<'a> {
    setup: &'a Model,
    sensors: &'a [Named],
    maps: Vec<Raster<f64>>,
    /// Of each sensor, what it read at one time.
    kept: Vec<Vec<Vec<Scan>>>,
    poses: Extent,
}

/// A sensor's map in the making, and its scans that are kept back, thinned by halves.
struct Making {
    mapper: FastVisibility,
    hold_out: u64,
    seen: u64,
    every: u64,
    kept: Vec<Vec<Scan>>,
    /// Of one time, until the next begins.
    now: Vec<Scan>,
}

/// What one scan says under a map.
struct Told {
    log: f64,
    explained: f64,
    readings: u64,
}

/// Where the robot has been and looked.
#[derive(Default)]
struct Extent {
    /// By sensor: those of a robot look to all sides while it stands.
    first: BTreeMap<usize, Pose>,
    moved: bool,
}

impl<'a> Panel<'a> {
    /// Maps every sensor by itself, by `visibility`, its scans turned back by an angle of its own, rad.
    pub(super) fn of(
        setup: &'a Model,
        sensors: &'a [Named],
        hold_out: u64,
        back_rad: &[f64],
        visit: &mut Visit<'_>,
    ) -> Result<Self, Failure> {
        let mut all: Vec<Making> = sensors.iter().map(|_| Making::new(setup, hold_out)).collect();
        let mut poses = Extent::default();
        visit(&mut |scan| {
            let Some(number) = sensors.iter().position(|sensor| sensor.numbers.contains(&scan.sensor)) else { return };
            let theta_rad = scan.pose.theta_rad + back_rad[number];
            let scan = Scan { pose: Pose { theta_rad, ..scan.pose }, ..scan.clone() };
            poses.add(&scan);
            all[number].take(scan);
        })?;
        all.iter_mut().for_each(Making::settle);
        let maps = all.iter().map(|making| making.mapper.occupancy().clone()).collect();
        Ok(Self { setup, sensors, maps, kept: all.into_iter().map(|making| making.kept).collect(), poses })
    }

    /// What speaks for every sensor and against it; how its own map takes it to be turned back is not known yet.
    pub(super) fn suspects(&self) -> Vec<Suspect> {
        (0..self.sensors.len()).map(|number| self.suspect(number)).collect()
    }

    fn suspect(&self, number: usize) -> Suspect {
        let sensor = self.sensor(number);
        let others = self.map_of_others(number);
        let unseen = Raster::filled(self.setup.grid, self.setup.prior.marginal());
        let explained = |told: &[Told]| mean(told.iter().map(|told| (told.explained, told.readings)));
        let (own, theirs) = (self.told(number, &self.maps[number], 0.0), self.told(number, &others, 0.0));
        Suspect {
            sensor: self.sensors[number].clone(),
            correct: sensor.correct_match(),
            readings: own.iter().map(|told| told.readings).sum(),
            by_itself: explained(&own),
            by_others: explained(&theirs),
            over_unseen: gain(&self.told(number, &unseen, 0.0), &theirs),
            same: self.same(number),
            turn: self.turn(number, &others, &theirs),
            moved: self.poses.moved,
        }
    }

    fn sensor(&self, number: usize) -> &dyn SensorModel {
        let scan = Scan { sensor: self.sensors[number].number(), ..Scan::default() };
        &**self.setup.sensors.of(&scan)
    }

    /// The maps of the other sensors as one: log odds added, as of an independent opinion pool.
    fn map_of_others(&self, number: usize) -> Raster<f64> {
        let log_odds = |p: f64| (p / (1.0 - p)).ln();
        let before = log_odds(self.setup.prior.marginal());
        let others: Vec<&Raster<f64>> =
            self.maps.iter().enumerate().filter(|(other, _)| *other != number).map(|(_, map)| map).collect();
        let pooled = (0..self.setup.grid.cells()).map(|cell| {
            let odds = before + others.iter().map(|map| log_odds(map[cell]) - before).sum::<f64>();
            (1.0 / (1.0 + (-odds).exp())).clamp(mapper::EPSILON, 1.0 - mapper::EPSILON)
        });
        Raster::new(self.setup.grid, pooled.collect())
    }

    /// What the scans kept back of a sensor, turned by an angle (rad), say under a map.
    fn told(&self, number: usize, map: &Raster<f64>, turn_rad: f64) -> Vec<Told> {
        let (sensor, onset) = (self.sensor(number), self.setup.prior.onset(self.setup.grid.cell_m));
        let turned = |scan: &Scan| {
            let theta_rad = scan.pose.theta_rad + turn_rad;
            Scan { pose: Pose { theta_rad, ..scan.pose }, ..scan.clone() }
        };
        let told = |scans: &Vec<Scan>| {
            let mut predictive = Predictive::new(self.setup.grid, sensor, onset);
            let mut told = Told { log: 0.0, explained: 0.0, readings: 0 };
            let rays: Vec<Ray> = scans.iter().flat_map(|scan| turned(scan).rays().collect::<Vec<_>>()).collect();
            for ray in rays.iter().step_by(rays.len().div_ceil(MOST_RAYS).max(1)) {
                if predictive.take(ray) {
                    let loss = predictive.log_loss(Belief::Cells(map));
                    let false_match = ray.reading.map_or(0.0, |reading| false_density(sensor, reading));
                    told.log -= loss;
                    told.explained += (1.0 - false_match * loss.exp()).clamp(0.0, 1.0);
                    told.readings += 1;
                }
            }
            told
        };
        self.kept[number].par_iter().map(told).collect()
    }

    /// By how much a sensor is to be turned back to fit a map best, if it fits better than as it is.
    fn turn(&self, number: usize, others: &Raster<f64>, as_it_is: &[Told]) -> Option<Turn> {
        let likely = |told: &[Told]| told.iter().map(|told| told.log).sum::<f64>();
        let turned = (-MOST_DEGREES..=MOST_DEGREES).filter(|degrees| *degrees != 0).map(|degrees| {
            let back_rad = f64::from(degrees).to_radians();
            (back_rad, self.told(number, others, back_rad))
        });
        let (back_rad, best) = turned.max_by(|a, b| likely(&a.1).total_cmp(&likely(&b.1)))?;
        let by_others = gain(as_it_is, &best)?;
        (by_others.interval.low > 0.0).then_some(Turn { back_rad, by_others, by_itself: None })
    }

    /// How much more likely the scans kept back of a sensor are under its own map where both are turned back, nats per reading.
    pub(super) fn sharper(&self, turned: &Self, number: usize) -> Option<SeriesMean> {
        gain(&self.told(number, &self.maps[number], 0.0), &turned.told(number, &turned.maps[number], 0.0))
    }

    /// The reading about which most of a sensor's lie, up to what the conventional rules take for one reading, and their share. Echoes alone count.
    fn same(&self, number: usize) -> Option<(f64, f64)> {
        let half_bin = self.sensor(number).half_bin(self.setup.grid.cell_m);
        let readings = self.kept[number].iter().flatten().flat_map(|scan| scan.readings.iter().flatten());
        let mut readings: Vec<f64> = readings.copied().filter(|reading| reading.is_finite()).collect();
        readings.sort_by(f64::total_cmp);
        let middle = *readings.get(readings.len() / 2)?;
        let near = readings.iter().filter(|reading| (**reading - middle).abs() <= half_bin).count();
        Some((middle, near as f64 / readings.len() as f64))
    }
}

/// Mean of sums over so many readings each; none without a reading.
fn mean(series: impl Iterator<Item = (f64, u64)>) -> Option<SeriesMean> {
    series_mean(&series.collect::<Vec<_>>()).ok()
}

/// How much more likely each scan is the second time, nats per reading.
fn gain(before: &[Told], after: &[Told]) -> Option<SeriesMean> {
    // A sensor that is turned about itself keeps its rays on the map.
    mean(before.iter().zip(after).map(|(before, after)| (after.log - before.log, before.readings.min(after.readings))))
}

/// `(1 - P(T)) P(o | not T)`: the density (per unit) of a reading that does not come from the first occupied cell; without an echo, the probability.
pub(crate) fn false_density(sensor: &dyn SensorModel, reading: f64) -> f64 {
    const HALF: f64 = 0.5;
    let in_bin = (1.0 - sensor.correct_match()) * sensor.false_match_probability(reading, HALF);
    if reading.is_finite() { in_bin / (2.0 * HALF) } else { in_bin }
}

impl Making {
    fn new(setup: &Model, hold_out: u64) -> Self {
        let mapper = FastVisibility::visibility(setup);
        Self { mapper, hold_out, seen: 0, every: 1, kept: Vec::new(), now: Vec::new() }
    }

    /// Takes a scan; those of one time wait for each other.
    fn take(&mut self, scan: Scan) {
        if !self.now.last().is_some_and(|last| last.is_with(&scan)) {
            self.settle();
        }
        self.now.push(scan);
    }

    /// What was read at one time is kept back, or left out, or goes into the map.
    fn settle(&mut self) {
        if self.now.is_empty() {
            return;
        }
        let now = std::mem::take(&mut self.now);
        self.seen += 1;
        let number = self.seen / self.hold_out;
        if !self.seen.is_multiple_of(self.hold_out) {
            self.mapper.integrate_together(&now);
        } else if number.is_multiple_of(self.every) {
            self.kept.push(now);
            if self.kept.len() == MOST_SCANS {
                let mut number = 0;
                self.kept.retain(|_| {
                    number += 1;
                    number % 2 == 0
                });
                self.every *= 2;
            }
        }
    }
}

impl Extent {
    fn add(&mut self, scan: &Scan) {
        let pose = scan.pose;
        let first = *self.first.entry(scan.sensor).or_insert(pose);
        let far = (pose.x_m - first.x_m).hypot(pose.y_m - first.y_m);
        self.moved |= far > MOVED || (pose.theta_rad - first.theta_rad).abs() > MOVED;
    }
}
