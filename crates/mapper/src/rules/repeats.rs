//! Readings that repeat: a robot that stands still learns little from looking again.
//!
//! The error of a reading has two parts. One depends on the view: from the same place, a surface without texture is matched to the same
//! wrong one again and again, and a surface that a laser measures too short stays too short. The other is drawn afresh. A map that takes
//! all readings for independent counts the first part as often as it looks.
//!
//! Let views from poses apart by `d` (m) and `a` (rad) share that first part with probability `exp(-(d/D)^2/2 - (a/A)^2/2)`. While they do,
//! readings along a ray form runs: each is like the one that the run began with up to what is drawn afresh. As long as a run goes
//! on, its `n` readings are worth `n / (1 + (n - 1) s)` of independent ones, where `s` is near one: about as much as one (Kish, "Survey
//! Sampling", 1965: the effective size of a sample that is correlated). Where a run ends, something has changed, and its
//! successor is news: nothing that stays wrong ever ends a run.
//!
//! Instead of raising likelihoods to a power below one, a reading is taken or left out, which is the same on average and keeps the
//! posterior of every ray exact. A run counts up to [`Repeats::looks`] times rather than once, since what appears or goes would
//! else have to be believed at one look.

use sensor::{Pose, Scan, SensorModel};

use crate::mapper::Mapper;
use crate::memory::Held as _;
use crate::model::Model;
use crate::rules::shown::{Choice, Shown};

/// Any mapper, shown readings up to some times from the same view.
pub type OnlyNews = Shown<News>;

/// When a reading is taken for a repetition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeats {
    /// Distance over which views share their errors, m; above 0.
    pub distance_m: f64,
    /// Angle over which they do, rad; above 0.
    pub angle_rad: f64,
    /// Probability that what a ray ends on changes from one scan to the next, 0 to 1.
    pub change: f64,
    /// How often readings that repeat are taken; at least 1.
    pub looks: u32,
}

impl Repeats {
    /// Chosen by hand: less than a robot moves from scan to scan, more than one that stands jitters; and the looks after which the log
    /// loss of a robot that stands was least.
    pub const CHOSEN: Self = Self { distance_m: 0.03, angle_rad: 0.015, change: 0.01, looks: 3 };

    /// Whether two poses share their view.
    fn is_same_view(&self, a: Pose, b: Pose) -> bool {
        let apart = libm::hypot(a.x_m - b.x_m, a.y_m - b.y_m) / self.distance_m;
        let turned = libm::remainder(a.theta_rad - b.theta_rad, std::f64::consts::TAU) / self.angle_rad;
        // The exponent of one half.
        apart * apart + turned * turned < 2.0 * std::f64::consts::LN_2
    }

    /// Whether a reading is like the one that its run began with.
    ///
    /// Both scatter about what the surface would give, so that they differ by `sqrt(2)` as much as one does: of a Gaussian, the
    /// likelihood of one reading about the other is the square of what it is worth. It is weighed against a
    /// change, after which any reading may come.
    fn is_like(&self, sensor: &dyn SensorModel, bearing: f64, reading: f64, first: f64) -> bool {
        let Some(range_m) = sensor.range_of(first, bearing) else {
            return sensor.range_of(reading, bearing).is_none();
        };
        let likelihood = |reading: f64, range_m: f64| {
            let mut likelihood = [0.0];
            sensor.likelihood(reading, bearing, &[range_m, range_m], &mut likelihood);
            likelihood[0]
        };
        // What comes of things in front, or of false matches, whatever stands there.
        let stray = likelihood(reading, FAR_M);
        let like = (likelihood(reading, range_m) - stray).max(0.0);
        let most = likelihood(first, range_m) - likelihood(first, FAR_M);
        let share = if most > 0.0 { libm::sqrt(like / most) } else { 0.0 };
        (1.0 - self.change) * share * most > self.change * stray
    }
}

/// A surface so far away gives no reading of its own, m.
const FAR_M: f64 = 1e6;

/// Readings that are news.
#[derive(Debug, Clone)]
pub struct News {
    repeats: Repeats,
    /// Of each sensor, what it looks at.
    views: Vec<View>,
}

/// What a sensor has read since it has this view.
#[derive(Debug, Clone, Default)]
struct View {
    /// The pose at which the view began.
    pose: Pose,
    bearings_rad: Vec<f64>,
    /// The first reading of the run of every ray, and how often it was taken.
    runs: Vec<Option<(f64, u32)>>,
}

impl OnlyNews {
    /// A mapper of the model's sensors, which is not shown repetitions.
    pub fn new(inner: Box<dyn Mapper>, model: &Model, repeats: Repeats) -> Self {
        Self::of(inner, model, News { repeats, views: vec![View::default(); model.sensors.iter().len()] })
    }
}

impl Choice for News {
    fn choose(&mut self, sensor: &dyn SensorModel, scan: &Scan, readings: &mut Vec<Option<f64>>) {
        let (repeats, view) = (self.repeats, &mut self.views[scan.sensor]);
        if view.bearings_rad != scan.bearings_rad || !repeats.is_same_view(view.pose, scan.pose) {
            view.pose = scan.pose;
            view.bearings_rad.clone_from(&scan.bearings_rad);
            view.runs.clear();
            view.runs.resize(scan.readings.len(), None);
        }
        let rays = view.runs.iter_mut().zip(&scan.readings).zip(&scan.bearings_rad);
        readings.extend(rays.map(|((run, reading), &bearing)| {
            let reading = (*reading)?;
            let last = run.filter(|(first, _)| repeats.is_like(sensor, bearing, reading, *first));
            let (first, taken) = last.unwrap_or((reading, 0));
            let is_news = taken < repeats.looks;
            *run = Some((first, taken + u32::from(is_news)));
            is_news.then_some(reading)
        }));
    }

    /// What is left out was taken before.
    fn leaves_out(&self) -> bool {
        true
    }

    fn held(&self) -> usize {
        self.views.iter().map(|view| view.bearings_rad.held() + view.runs.held()).sum()
    }
}

#[cfg(test)]
mod tests;
