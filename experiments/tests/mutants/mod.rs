//! `visibility`, made worse on purpose in four ways. Each is a mapper like any other, by the public API of `mapper`.

use std::sync::Arc;

use grid::{DigitalLine, Raster};
use mapper::catalogue::{Build, Entry, Kind};
use mapper::past_the_map::{self, PastTheMap};
use mapper::{
    Chain, Mapper, Model, Moments, PairwiseGrid, Prior, RayPosterior, Reconciliation, Sensors, Visibility, exact,
};
use sensor::{FastKernel, InverseModel, Kernel, Scan, SensorModel};

/// Every mutant, named after what it replaces: gates judge it as they would judge a change of `visibility`.
pub(crate) const MUTANTS: [(&str, Entry); 4] = [
    ("correlation forced to 0", mutant(&|setup| Box::new(Visibility::exact(&without_correlation(setup))))),
    ("tail beyond the map dropped", mutant(&|setup| Box::new(Visibility::new(setup, without_tail)))),
    ("reconciliation left out", mutant(&|setup| Box::new(Unreconciled::new(setup)))),
    ("kernel sampled at cell centres", mutant(&|setup| Box::new(Visibility::exact(&at_centres(setup))))),
];

const fn mutant(build: &'static Build) -> Entry {
    Entry { name: "visibility", summary: "a mutant", source: "tests", kind: Kind::Online, build }
}

fn without_correlation(setup: &Model) -> Model {
    Model { prior: Prior { correlation: 0.0, ..setup.prior }, ..setup.clone() }
}

/// The ray ends with the map: it hits one of its cells, whatever it reads.
fn without_tail(chain: &Chain, likelihood: &[f64], _none: f64, posterior: &mut RayPosterior) {
    exact::posterior(chain, likelihood, 0.0, posterior);
}

fn at_centres(setup: &Model) -> Model {
    let centres = |sensor: &Arc<dyn SensorModel>| Arc::new(AtCentres(Arc::clone(sensor))) as Arc<dyn SensorModel>;
    Model { sensors: Sensors::new(setup.sensors.iter().map(centres).collect()), ..setup.clone() }
}

/// A sensor whose kernel is taken at the middle of a chord instead of averaged over it.
struct AtCentres(Arc<dyn SensorModel>);

impl Kernel for AtCentres {
    fn likelihood(&self, reading: f64, bearing: f64, ranges: &[f64], likelihood: &mut [f64]) {
        for (l, chord) in likelihood.iter_mut().zip(ranges.windows(2)) {
            let middle = 0.5 * (chord[0] + chord[1]);
            self.0.likelihood(reading, bearing, &[middle; 2], std::slice::from_mut(l));
        }
    }
}

impl FastKernel for AtCentres {
    fn constant_from(&self, reading: f64, bearing: f64) -> f64 {
        self.0.constant_from(reading, bearing)
    }
}

/// `visibility` asks nothing of this.
impl InverseModel for AtCentres {}

/// Rays that never agree: each is updated from the map before the scan, and writes what it found over what other rays of the scan did.
struct Unreconciled {
    pairs: PairwiseGrid,
    sensors: Sensors,
    onset: f64,
    moments: Moments,
}

impl Unreconciled {
    fn new(setup: &Model) -> Self {
        let pairs = PairwiseGrid::prior(setup.grid, &setup.prior);
        let unseen = pairs.joint(0, 1);
        let onset = unseen.fe / (1.0 - unseen.first());
        Self { sensors: setup.sensors.clone(), onset, moments: Moments::new(setup.grid), pairs }
    }
}

impl Mapper for Unreconciled {
    fn integrate(&mut self, scan: &Scan) {
        let before = self.pairs.clone();
        let spec = *before.spec();
        let sensor = &**self.sensors.of(scan);
        let (mut line, mut chain, mut posterior) = (DigitalLine::default(), Chain::default(), RayPosterior::default());
        for ray in scan.rays() {
            let Some(reading) = ray.reading else { continue };
            line.trace(&spec, ray.origin_m, ray.direction, f64::INFINITY);
            if line.is_empty() {
                continue;
            }
            chain.gather(&before, line.cells());
            let mut likelihood = vec![0.0; line.len()];
            sensor.likelihood(reading, ray.bearing_rad, line.ranges(), &mut likelihood);
            let beyond = PastTheMap::after(&line, ray.direction, spec.cell_m, self.onset);
            let none = past_the_map::likelihood(sensor, reading, ray.bearing_rad, &beyond);
            exact::posterior(&chain, &likelihood, none, &mut posterior);
            self.moments.add(line.cells(), &posterior);
            self.pairs.reconcile(&mut self.moments, Reconciliation::Touched); // of one ray: its posterior, as it is
        }
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.pairs.marginals()
    }
}
