//! A mapper that is shown some of the readings.

use grid::Raster;
use sensor::{Scan, SensorModel};

use crate::mapper::{Mapper, Mixing, Outside, Work};
use crate::memory::Held as _;
use crate::model::{Model, Sensors};
use crate::pairs::grid::PairwiseGrid;

/// Which readings of a scan are shown.
pub trait Choice: Clone + Send {
    /// Puts the readings of the scan into `readings`, which is empty, with `None` in the place of those that are not shown.
    fn choose(&mut self, sensor: &dyn SensorModel, scan: &Scan, readings: &mut Vec<Option<f64>>);

    /// Whether readings are left out that would be news to the mapper.
    fn leaves_out(&self) -> bool;

    /// Memory that it holds, bytes.
    fn held(&self) -> usize {
        0
    }
}

/// Any mapper, shown the readings that a choice leaves. O(rays) per scan besides what the mapper does.
pub struct Shown<C> {
    inner: Box<dyn Mapper>,
    sensors: Sensors,
    choice: C,
    /// The last scans as they were shown.
    shown: Vec<Scan>,
}

impl<C: Choice> Shown<C> {
    /// A mapper of the model's sensors.
    pub(crate) fn of(inner: Box<dyn Mapper>, model: &Model, choice: C) -> Self {
        Self { inner, sensors: model.sensors.clone(), choice, shown: Vec::new() }
    }
}

impl<C: Choice + 'static> Mapper for Shown<C> {
    fn integrate(&mut self, scan: &Scan) {
        self.integrate_together(std::slice::from_ref(scan));
    }

    fn integrate_together(&mut self, scans: &[Scan]) {
        let Self { inner, sensors, choice, shown } = self;
        shown.resize_with(scans.len(), Scan::default);
        for (scan, shown) in scans.iter().zip(&mut *shown) {
            (shown.sensor, shown.time_s, shown.pose) = (scan.sensor, scan.time_s, scan.pose);
            shown.bearings_rad.clone_from(&scan.bearings_rad);
            shown.readings.clear();
            choice.choose(&**sensors.of(scan), scan, &mut shown.readings);
        }
        inner.integrate_together(shown);
    }

    fn settle(&mut self) {
        self.inner.settle();
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.inner.occupancy()
    }

    fn occupied(&self, cell: usize) -> f64 {
        self.inner.occupied(cell)
    }

    fn pairwise(&self) -> Option<PairwiseGrid> {
        self.inner.pairwise()
    }

    /// Of all readings: what is shown is a rule for mapping, and no excuse from predicting.
    fn evidence(&self, scan: &Scan) -> Option<f64> {
        self.inner.evidence(scan)
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        let inner = self.inner.fork()?;
        let (sensors, choice) = (self.sensors.clone(), self.choice.clone());
        Some(Box::new(Self { inner, sensors, choice, shown: Vec::new() }))
    }

    fn work(&self) -> Work {
        let scan = self.shown.iter().map(|scan| scan.readings.held() + scan.bearings_rad.held()).sum::<usize>();
        let Work { cells, bytes } = self.inner.work();
        Work { cells, bytes: bytes + scan + self.choice.held() }
    }

    fn skipped(&self) -> u64 {
        self.inner.skipped()
    }

    fn leaves_out(&self) -> bool {
        self.choice.leaves_out() || self.inner.leaves_out()
    }

    fn mixing(&self) -> Option<&Mixing> {
        self.inner.mixing()
    }

    fn fault(&self) -> Option<String> {
        self.inner.fault()
    }

    fn outside(&self) -> Option<&Outside> {
        self.inner.outside()
    }
}
