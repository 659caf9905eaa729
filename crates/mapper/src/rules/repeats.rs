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
//! posterior of every ray exact. A run counts up to [`Repeats::looks`](crate::Repeats::looks) times rather than once, since what appears or goes would
//! else have to be believed at one look.

use sensor::{Pose, Scan, SensorModel};

use crate::belief::repeats::Repeats;
use crate::mapper::Mapper;
use crate::memory::Held as _;
use crate::model::Model;
use crate::rules::shown::{Choice, Shown};

/// Any mapper, shown readings up to some times from the same view.
pub type OnlyNews = Shown<News>;

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
