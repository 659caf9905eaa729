//! The mapper `visibility`, and its variants, fast.

use std::borrow::Cow;
use std::cell::OnceCell;
use std::sync::Arc;

use grid::Raster;
use sensor::{Ray, Scan, SensorModel};

use crate::belief::lateral::Lateral;
use crate::belief::prior::{Continuity, Prior};
use crate::belief::renewal::Renewal;
use crate::fast::inputs::Inputs;
use crate::fast::map::Map;
use crate::fast::pool::Pool;
use crate::fast::renewal::Changes;
use crate::fast::scan::{Group, Selection, select};
use crate::fast::squares::Squares;
use crate::mapper::{Mapper, Work};
use crate::memory::Held;
use crate::model::{Model, Sensors};
use crate::pairs::grid::PairwiseGrid;
use crate::pairs::reconcile::Reconciliation;
use crate::ray::bearing_chain::{BearingChain, Surfaces};
use crate::ray::cone;

/// Scans of fewer rays are not worth waking other threads for.
const FEW_RAYS: usize = 1024;

/// The mapper of the paper, and the same without continuity, several rays at a time. O(cells on the ray) per ray.
///
/// 12 bytes per cell of the tiles that readings have moved; 8 per cell of the grid once
/// [`occupancy`](Mapper::occupancy) is asked for; working memory for what one scan touches. One scan on the same map
/// differs from the reference, [`crate::Visibility`], by less than 1e-5 in any marginal or joint.
pub struct FastVisibility {
    map: Map,
    /// What is known of its squares; none of a world that changes.
    squares: Option<Squares>,
    continuity: Continuity,
    sensors: Sensors,
    onset: f64,
    reconciliation: Reconciliation,
    lateral: Option<(Lateral, Surfaces)>,
    /// How places change; none of a world at rest.
    changes: Option<Changes>,
    /// The map as others see it, made when it is asked for.
    occupancy: OnceCell<Raster<f64>>,
    cells: u64,
    skipped: u64,
    pool: Pool,
}

impl FastVisibility {
    /// Readings up to which the sums over the rays of a scan are exact: so many, twice in a cell, and 2^-36 are the 53 bits
    /// of a double. A count has 20 bits.
    pub const MOST_RAYS: usize = 1 << 16;

    /// The paper's method.
    pub fn visibility(model: &Model) -> Self {
        Self::new(model, Continuity::Kept)
    }

    /// Every cell independent of the others, as [`crate::Visibility::independent`].
    pub fn independent(model: &Model) -> Self {
        let prior = Prior { correlation: 0.0, ..model.prior };
        Self::new(&Model { prior, ..model.clone() }, Continuity::Ignored)
    }

    /// The paper's method with continuity across rays.
    pub fn lateral(model: &Model, lateral: Lateral) -> Self {
        let cell_m = model.grid.cell_m;
        let prior = lateral.prior(&model.prior, cell_m);
        let surfaces = Surfaces::new(&model.prior, prior.onset(cell_m), cell_m);
        Self { lateral: Some((lateral, surfaces)), ..Self::new(&Model { prior, ..model.clone() }, Continuity::Kept) }
    }

    /// The paper's method in a world that changes: the time between scans passes for the places that they look at.
    pub fn dynamic(model: &Model, renewal: Renewal) -> Self {
        let visibility = Self::visibility(model);
        Self { changes: Some(Changes::new(&visibility.map, renewal)), squares: None, ..visibility }
    }

    fn new(model: &Model, continuity: Continuity) -> Self {
        let map = Map::unseen(model);
        Self {
            pool: Pool::new(map.numbering),
            squares: Some(Squares::unseen(&map)),
            map,
            continuity,
            sensors: model.sensors.clone(),
            onset: model.prior.onset(model.grid.cell_m),
            reconciliation: model.reconciliation,
            lateral: None,
            changes: None,
            occupancy: OnceCell::new(),
            cells: 0,
            skipped: 0,
        }
    }

    /// The map in double precision.
    ///
    /// # Panics
    /// If a joint is farther than 1e-6 from what its marginals allow: a defect, never a consequence of the readings.
    pub fn pairs(&self) -> PairwiseGrid {
        self.now().pairs(self.continuity)
    }

    /// The map at the time of the last scan.
    fn now(&self) -> Cow<'_, Map> {
        let Some(changes) = &self.changes else { return Cow::Borrowed(&self.map) };
        let (mut map, mut changes) = (self.map.clone(), changes.clone());
        changes.pass_everywhere(&mut map);
        Cow::Owned(map)
    }

    /// The part of the map that readings have moved, as [`occupancy`](Mapper::occupancy) has it, up to a tile
    /// more on every side; none before the first. A world may be far larger than what is ever seen of it.
    pub fn seen(&self) -> Option<Raster<f64>> {
        let (from, window) = self.map.seen()?;
        Some(match &self.changes {
            None => self.map.raster(from, window, |tile, place| f64::from(tile.occupied[place])),
            Some(changes) => changes.marginals(&self.map, from, window),
        })
    }

    /// Takes a scan's rays on so many threads; the map does not depend on how many.
    ///
    /// A scan of more than [`MOST_RAYS`](Self::MOST_RAYS) readings is taken as so many scans as it needs, each of every n-th ray.
    pub fn integrate_on(&mut self, scan: &Scan, threads: usize) {
        self.integrate_together_on(std::slice::from_ref(scan), threads);
    }

    /// Takes the scans of several sensors as one, as [`integrate_together`](Mapper::integrate_together) has it, on so many threads.
    pub fn integrate_together_on(&mut self, scans: &[Scan], threads: usize) {
        if let Some(changes) = &mut self.changes {
            scans.iter().for_each(|scan| changes.go_on(scan.time_s));
            self.occupancy.take();
        }
        let of_sensor = |scan: &Scan| {
            let rays: Vec<Ray> = scan.rays().filter(|ray| ray.reading.is_some()).collect();
            (Arc::clone(self.sensors.of(scan)), rays)
        };
        let sensors: Vec<(Arc<dyn SensorModel>, Vec<Ray>)> = scans.iter().map(of_sensor).collect();
        // A cone is many rays.
        let chains = |sensor: &dyn SensorModel| if sensor.width_rad() > 0.0 { cone::MOST_CHAINS } else { 1 };
        let all = sensors.iter().map(|(sensor, rays)| chains(&**sensor) * rays.len());
        let passes = all.sum::<usize>().div_ceil(Self::MOST_RAYS);
        for pass in 0..passes {
            let select = |(sensor, rays): &(Arc<dyn SensorModel>, Vec<Ray>)| {
                let rays = rays.iter().skip(pass).step_by(passes).copied().collect();
                Some((Arc::clone(sensor), select(self.map.numbering.spec(), &**sensor, rays, threads)?))
            };
            let selections: Vec<(Arc<dyn SensorModel>, Selection)> = sensors.iter().filter_map(select).collect();
            if !selections.is_empty() {
                self.update(&selections);
            }
        }
    }

    /// One scan.
    fn update(&mut self, selections: &[(Arc<dyn SensorModel>, Selection)]) {
        if let Some(changes) = &mut self.changes {
            let spec = *self.map.numbering.spec();
            let fan = |(sensor, selection): &(Arc<dyn SensorModel>, Selection)| {
                selection.rays().iter().flat_map(|ray| cone::fan(ray, &**sensor, &spec)).collect::<Vec<Ray>>()
            };
            changes.pass(&mut self.map, selections.iter().flat_map(fan));
        }
        let spec = self.map.numbering.spec();
        let others = |(sensor, selection): &(Arc<dyn SensorModel>, Selection)| {
            let (_, surfaces) = self.lateral.as_ref().filter(|(lateral, _)| lateral.rays)?;
            Some(BearingChain::new(&**sensor, selection.rays(), spec, surfaces))
        };
        let others: Vec<Option<BearingChain>> = selections.iter().map(others).collect();
        let edges = self.lateral.as_ref().map(|(lateral, _)| lateral).filter(|lateral| lateral.edges);
        let hops = edges.map_or(0, |lateral| lateral.hops(spec.cell_m));
        let groups: Vec<Group> = selections
            .iter()
            .zip(&others)
            .map(|((sensor, selection), others)| {
                let inputs = inputs((&self.map, self.squares.as_ref()), self.continuity, self.onset, &**sensor);
                Group { inputs: Inputs { others: others.as_ref(), hops, ..inputs }, selection }
            })
            .collect();
        let mut workspace = self.pool.take();
        let [cells, skipped] = workspace.update_rays(&groups); // Eqs. (1)-(7), (21)
        workspace.add_passing(&groups); // Eq. (20): rays past what they move
        let touched = workspace.touched();
        match edges {
            Some(lateral) => workspace.reconcile_laterally(&mut self.map, lateral, hops),
            None => workspace.reconcile(&mut self.map, self.continuity, self.reconciliation), // Eqs. (18)-(20)
        }
        if let Some(squares) = &mut self.squares {
            squares.summarise(&self.map, &touched);
        }
        self.pool.give_back(workspace);
        (self.cells, self.skipped) = (self.cells + cells, self.skipped + skipped);
        if let Some(changes) = &mut self.changes {
            changes.adopt(&self.map);
        }
        self.occupancy.take();
    }
}

/// What rays that are taken one by one read.
fn inputs<'a>(
    (map, squares): (&'a Map, Option<&'a Squares>),
    continuity: Continuity,
    onset: f64,
    sensor: &'a dyn SensorModel,
) -> Inputs<'a> {
    Inputs { map, squares, continuity, sensor, onset, others: None, hops: 0 }
}

impl Mapper for FastVisibility {
    fn integrate(&mut self, scan: &Scan) {
        self.integrate_together(std::slice::from_ref(scan));
    }

    fn integrate_together(&mut self, scans: &[Scan]) {
        let rays: usize = scans.iter().map(|scan| scan.readings.len()).sum();
        let threads = if rays < FEW_RAYS { 1 } else { rayon::current_num_threads() };
        self.integrate_together_on(scans, threads);
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.occupancy.get_or_init(|| match &self.changes {
            None => self.map.marginals(),
            Some(changes) => changes.marginals(&self.map, [0, 0], *self.map.numbering.spec()),
        })
    }

    fn occupied(&self, cell: usize) -> f64 {
        match &self.changes {
            None => f64::from(self.map.occupied(self.map.numbering.of(cell))),
            Some(_) => self.occupancy()[cell],
        }
    }

    /// The product of what the chain makes of every ray by itself, `Z` of Eq. (1) for each; of a world that changes, at the time of
    /// its last scan. None of a scan without a ray that starts on the map.
    fn evidence(&self, scan: &Scan) -> Option<f64> {
        let spec = self.map.numbering.spec();
        spec.locate(scan.pose.position_m())?;
        let rays: Vec<Ray> = scan.rays().filter(|ray| ray.reading.is_some()).collect();
        let map = self.now();
        let inputs = inputs((&map, self.squares.as_ref()), self.continuity, self.onset, &**self.sensors.of(scan));
        let mut workspace = self.pool.take();
        let evidence = workspace.evidence(&inputs, &rays);
        self.pool.give_back(workspace);
        Some(evidence)
    }

    fn pairwise(&self) -> Option<PairwiseGrid> {
        (self.continuity == Continuity::Kept).then(|| self.pairs())
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(Self {
            map: self.map.clone(),
            squares: self.squares.clone(),
            sensors: self.sensors.clone(),
            changes: self.changes.clone(),
            occupancy: OnceCell::new(),
            pool: self.pool.clone(),
            ..*self
        }))
    }

    fn work(&self) -> Work {
        Work {
            cells: self.cells + self.skipped,
            bytes: self.map.held()
                + self.squares.as_ref().map_or(0, Held::held)
                + self.changes.as_ref().map_or(0, Held::held)
                + self.occupancy.held()
                + self.pool.held(),
        }
    }

    fn skipped(&self) -> u64 {
        self.skipped
    }

    /// A ray is cut where the rest says nothing. Cells that are independent of each other stop it on an unseen map after some
    /// hundred of them, which may be before its reading.
    fn leaves_out(&self) -> bool {
        self.continuity == Continuity::Ignored
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::GridSpec;
    use sensor::{Pose, Stereo};

    /// A drive through a world that is far larger than what is seen of it.
    fn drive() -> Vec<Scan> {
        let bearings_rad: Vec<f64> = (0..60).map(|k| 0.02 * (f64::from(k) - 29.5)).collect();
        let reading = |number: usize, k: usize| Some(60.0 * (0.618 * (number * 60 + k) as f64).fract().powi(3));
        let scan = |number: usize| Scan {
            sensor: 0,
            time_s: 0.0,
            pose: Pose { x_m: 12.0 + 0.4 * number as f64, y_m: 20.0, theta_rad: 0.03 * number as f64 },
            bearings_rad: bearings_rad.clone(),
            readings: (0..60).map(|k| reading(number, k)).collect(),
        };
        (0..12).map(scan).collect()
    }

    type Unseen = fn(&Model) -> FastVisibility;

    #[test]
    fn a_map_that_grows_is_the_map_that_was_all_there_to_the_bit() {
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 1000, height: 1800 };
        let lateral = |setup: &Model| FastVisibility::lateral(setup, Lateral::default());
        let kinds: [(Unseen, Reconciliation); 5] = [
            (FastVisibility::visibility, Reconciliation::AllEdges),
            (FastVisibility::visibility, Reconciliation::Touched),
            (FastVisibility::independent, Reconciliation::AllEdges),
            (FastVisibility::independent, Reconciliation::Touched),
            (lateral, Reconciliation::AllEdges),
        ];
        for (unseen, reconciliation) in kinds {
            let setup = Model { reconciliation, ..Model::new(grid, Arc::new(Stereo::default())) };
            let (mut grows, mut dense) = (unseen(&setup), unseen(&setup));
            (0..dense.map.numbering.tiles()).for_each(|tile| {
                dense.map.make(tile);
            });
            for scan in drive() {
                grows.integrate_on(&scan, 1);
                dense.integrate_on(&scan, 1);
            }
            let (grown, all) = (grows.pairs(), dense.pairs());
            assert!(grown == all && grown != unseen(&setup).pairs());
            let seen = grows.seen().expect("scans were taken");
            assert!(seen.values().len() < grid.cells() / 2, "{:?}", seen.spec());
            for cell in 0..grid.cells() {
                match seen.spec().locate(grid.centre(cell)) {
                    Some(there) => assert_eq!(seen[there].to_bits(), all.marginal[cell].to_bits()),
                    None => assert_eq!(all.marginal[cell].to_bits(), all.marginal[0].to_bits()),
                }
            }
            assert!(grows.map.held() < dense.map.held() / 2);
        }
    }
}
