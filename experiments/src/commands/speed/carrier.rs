//! A sensor whose scans are mapped, and what it is given for a reading.

use std::fmt;
use std::sync::Arc;

use sensor::{SensorModel, Stereo};

/// A sensor whose scans are mapped.
#[derive(Clone)]
pub struct Carrier {
    pub(super) called: String,
    pub(super) model: Arc<dyn SensorModel>,
    /// The camera that reads disparities of the ranges that it is given; none where readings are given.
    by_ranges: Option<Stereo>,
    /// A reading beyond this is none.
    most: f64,
}

impl fmt::Debug for Carrier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.called)
    }
}

impl Carrier {
    /// A sensor that is given its own readings.
    pub fn new(called: &str, model: Arc<dyn SensorModel>) -> Self {
        Self { called: called.to_owned(), model, by_ranges: None, most: f64::INFINITY }
    }

    /// A camera that is given disparities.
    pub fn camera(called: &str, stereo: Stereo) -> Self {
        Self { most: stereo.max_disparity, ..Self::new(called, Arc::new(stereo)) }
    }

    /// The camera of the paper, which is given ranges and reads their noise-free disparities.
    pub fn by_ranges(called: &str) -> Self {
        let stereo = Stereo::default();
        Self { by_ranges: Some(stereo), ..Self::camera(called, stereo) }
    }

    /// The reading on a ray, and the range that it stands for, m, from what is given.
    pub(super) fn read(&self, bearing_rad: f64, given: Option<f64>) -> (Option<f64>, Option<f64>) {
        match self.by_ranges {
            Some(stereo) => {
                let range_m = given.filter(|range| range.is_finite());
                let reading = range_m.map(|range| stereo.disparity(range, bearing_rad));
                (reading.filter(|disparity| *disparity <= self.most), range_m)
            }
            None => {
                let reading = given.filter(|reading| *reading <= self.most);
                (reading, reading.and_then(|reading| self.model.range_of(reading, bearing_rad)))
            }
        }
    }
}
