//! The four phases of a scan: select -> update_rays -> add_passing -> reconcile.
//!
//! 1. [`select`]: which rays are taken, and by which thread.
//! 2. [`Workspace::update_rays`]: the posterior of every pair on every ray, summed over rays, as far as a reading moves its
//!    ray's cells. Eqs. (1)-(7), (21).
//! 3. [`Workspace::add_passing`]: rays past that, where other rays move cells. Eq. (20).
//! 4. [`Workspace::reconcile`]: the map that agrees best with all of them. Eqs. (18)-(20).

use grid::GridSpec;
use rayon::prelude::*;
use sensor::lanes::LANES;
use sensor::{Ray, SensorModel};

use crate::belief::lateral::Lateral;
use crate::belief::prior::Continuity;
use crate::fast::bundle::{Bundle, Outcome, Predicted};
use crate::fast::inputs::Inputs;
use crate::fast::lateral::Layers;
use crate::fast::map::{Map, summarise};
use crate::fast::passage::{Passage, Reach};
use crate::fast::reconcile::Moved;
use crate::fast::slowly::Slowly;
use crate::fast::sums::Sums;
use crate::fast::tiles::Numbering;
use crate::fast::{lateral, passing, reconcile, touched};
use crate::memory::Held;
use crate::pairs::reconcile::Reconciliation;

/// The rays that are taken of one sensor, in the order and the shares in which threads take them.
pub(super) struct Selection {
    rays: Vec<Ray>,
    threads: usize,
    /// Rays per thread.
    share: usize,
}

/// Phase 1: rays with readings, from one place. None where there are none, or where they start outside the map.
pub(super) fn select(
    spec: &GridSpec,
    sensor: &dyn SensorModel,
    mut rays: Vec<Ray>,
    threads: usize,
) -> Option<Selection> {
    rays.first().and_then(|ray| spec.locate(ray.origin_m))?;
    // Rays that can be cut soon are taken together.
    let far =
        |ray: &Ray| ray.reading.is_none_or(|reading| sensor.constant_from(reading, ray.bearing_rad).is_infinite());
    rays.sort_by_key(far);
    let bundles = rays.len().div_ceil(LANES);
    let threads = threads.clamp(1, bundles);
    Some(Selection { rays: dealt(&rays, threads), threads, share: bundles.div_ceil(threads) * LANES })
}

/// The rays in an order in which equal shares of them are equal work: bundle by bundle to every thread in turn. Bundles
/// stay together, the one that is not full at the end.
fn dealt(rays: &[Ray], threads: usize) -> Vec<Ray> {
    let (bundles, rest) = rays.as_chunks::<LANES>();
    let turns = (0..threads).flat_map(|k| bundles.iter().skip(k).step_by(threads));
    turns.flatten().chain(rest).copied().collect()
}

impl Selection {
    /// All rays.
    pub(super) fn rays(&self) -> &[Ray] {
        &self.rays
    }

    /// What a thread takes of one value per ray.
    fn share_of<'a, T>(&self, values: &'a [T], thread: usize) -> &'a [T] {
        values.chunks(self.share).nth(thread).unwrap_or_default()
    }
}

/// What a sensor adds to a scan.
pub(super) struct Group<'a> {
    pub(super) inputs: Inputs<'a>,
    pub(super) selection: &'a Selection,
}

/// Working memory, kept from one scan to the next.
pub(super) struct Workspace {
    numbering: Numbering,
    /// One for every thread. After each phase, the sums over all rays are in the first.
    workers: Vec<Worker>,
    /// What became of the rays, by sensor and thread.
    parts: Vec<Vec<Part>>,
    moved: Vec<Moved>,
    layers: Layers,
}

/// What one thread needs.
struct Worker {
    bundle: Bundle,
    sums: Sums,
    slowly: Slowly,
}

/// What became of the rays of one sensor that one thread took.
#[derive(Default)]
struct Part {
    /// How far each of them moves cells.
    reach: Vec<Reach>,
    /// The cells that they have leapt over.
    passages: Vec<Passage>,
}

impl Workspace {
    pub(super) fn new(numbering: Numbering) -> Self {
        let workers = vec![Worker::new(numbering)];
        Self { numbering, workers, parts: Vec::new(), moved: Vec::new(), layers: Layers::default() }
    }

    /// Phase 2; gives the numbers of cells that rays were updated over, and that they leapt over.
    pub(super) fn update_rays(&mut self, groups: &[Group]) -> [u64; 2] {
        if self.parts.len() < groups.len() {
            self.parts.resize_with(groups.len(), Vec::new);
        }
        for (Group { inputs, selection }, parts) in groups.iter().zip(&mut self.parts) {
            parts.resize_with(selection.threads, Part::default);
            while self.workers.len() < selection.threads {
                self.workers.push(Worker::new(self.numbering));
            }
            together(&mut self.workers, parts, |thread, worker, part| {
                worker.update(inputs, thread * selection.share, selection.share_of(&selection.rays, thread), part);
            });
        }
        merge(&mut self.workers);
        self.workers.iter_mut().fold([0; 2], |[cells, skipped], Worker { bundle, .. }| {
            [cells + std::mem::take(&mut bundle.cells), skipped + std::mem::take(&mut bundle.skipped)]
        })
    }

    /// `ln P(readings | map)` of rays, each by itself, nats: what phase 2 divides by, in the same precision.
    pub(super) fn evidence(&mut self, inputs: &Inputs, rays: &[Ray]) -> f64 {
        if inputs.sensor.width_rad() > 0.0 {
            let slowly = &mut self.workers[0].slowly;
            return rays.iter().map(|ray| libm::log(slowly.cone_evidence(inputs, ray).max(f64::MIN_POSITIVE))).sum();
        }
        rays.chunks(LANES).map(|rays| self.workers[0].evidence(inputs, rays, true)).sum()
    }

    /// Phase 3.
    pub(super) fn add_passing(&mut self, groups: &[Group]) {
        let Some(Group { inputs: Inputs { map, hops, .. }, .. }) = groups.first() else { return };
        if *hops > 0 {
            lateral::open(map, &mut self.workers[0].sums, *hops);
        }
        let spec = self.numbering.spec();
        // Where rays begin, and how far those of each sensor move cells.
        let reaches: Vec<Vec<Reach>> = self.parts.iter().zip(groups).map(|(parts, _)| reaches(parts)).collect();
        let begins: Vec<[f64; 2]> = groups.iter().map(|group| group.selection.rays[0].origin_m).collect();
        let ends = |group: usize| reaches[group].iter().map(|reach| reach.end_m).fold(0.0, f64::max);
        // Several threads read what one of them alone can add to meanwhile.
        let several = groups.iter().any(|group| group.selection.threads > 1);
        let before = several.then(|| std::mem::replace(&mut self.workers[0].sums, Sums::new(self.numbering)));
        for (number, (Group { inputs, selection }, parts)) in groups.iter().zip(&mut self.parts).enumerate() {
            let apart =
                |other: usize| libm::hypot(begins[other][0] - begins[number][0], begins[other][1] - begins[number][1]);
            let others = (0..groups.len()).filter(|other| *other != number);
            let others_m = others.map(|other| apart(other) + ends(other)).fold(0.0, f64::max);
            let until_m = passing::farthest(spec, (&selection.rays, &reaches[number]), others_m, 1 + hops);
            together(&mut self.workers, parts, |thread, Worker { sums, .. }, Part { reach, passages }| {
                let (rays, until_m) =
                    (selection.share_of(&selection.rays, thread), selection.share_of(&until_m, thread));
                passages.extend(passing::behind(reach, until_m));
                passing::add(inputs, rays, passages, (before.as_ref(), sums));
            });
        }
        if let Some(before) = before {
            let mut added = std::mem::replace(&mut self.workers[0].sums, before);
            self.workers[0].sums.absorb(&mut added);
            merge(&mut self.workers);
        }
    }

    /// The squares in which cells may move in phase 4.
    pub(super) fn touched(&self) -> Vec<u32> {
        self.workers[0].sums.squares().to_vec()
    }

    /// Phase 4.
    pub(super) fn reconcile(&mut self, map: &mut Map, continuity: Continuity, rule: Reconciliation) {
        let sums = &mut self.workers[0].sums;
        match rule {
            Reconciliation::AllEdges => reconcile::all_edges(map, continuity, sums, &mut self.moved),
            Reconciliation::Touched => {
                touched::touched(map, continuity, sums);
                summarise(map, sums, continuity);
                sums.clear();
            }
        }
    }

    /// Phase 4 with continuity across rays.
    pub(super) fn reconcile_laterally(&mut self, map: &mut Map, lateral: &Lateral, hops: usize) {
        let sums = &mut self.workers[0].sums;
        lateral::reconcile(map, sums, lateral, hops, &mut self.layers);
        summarise(map, sums, Continuity::Kept);
        sums.clear();
    }
}

impl Held for Workspace {
    fn held(&self) -> usize {
        let workers = self.workers.iter().map(|worker| worker.bundle.held() + worker.sums.held());
        workers.sum::<usize>() + self.moved.held() + self.layers.held()
    }
}

/// How far the rays of a sensor move cells, in their order.
fn reaches(parts: &[Part]) -> Vec<Reach> {
    parts.iter().flat_map(|part| part.reach.iter().copied()).collect()
}

/// What every worker does to its part, each with its number; one of them alone wakes no thread.
fn together(workers: &mut [Worker], parts: &mut [Part], work: impl Fn(usize, &mut Worker, &mut Part) + Sync) {
    match parts {
        [only] => work(0, &mut workers[0], only),
        several => {
            let workers = workers.par_iter_mut().zip(several).enumerate();
            workers.for_each(|(number, (worker, part))| work(number, worker, part));
        }
    }
}

/// The sums of all workers, in those of the first.
fn merge(workers: &mut [Worker]) {
    if let Some((first, others)) = workers.split_first_mut() {
        others.iter_mut().for_each(|other| first.sums.absorb(&mut other.sums));
    }
}

impl Worker {
    fn new(numbering: Numbering) -> Self {
        Self { bundle: Bundle::new(numbering), sums: Sums::new(numbering), slowly: Slowly::default() }
    }

    /// Takes rays, the first of which has the given number among those of the scan. Those that should not have leapt are taken
    /// once more, together.
    fn update(
        &mut self,
        inputs: &Inputs,
        first: usize,
        rays: &[Ray],
        Part { reach: reaches, passages: leapt }: &mut Part,
    ) {
        leapt.clear();
        reaches.clear();
        reaches.resize(rays.len(), Reach::NOWHERE);
        if inputs.sensor.width_rad() > 0.0 {
            let cone = |ray| self.slowly.update_cone(inputs, ray, &mut self.sums);
            reaches.iter_mut().zip(rays.iter().map(cone)).for_each(|(reach, of)| *reach = of);
            self.bundle.cells += self.slowly.take_cells();
            return;
        }
        let mut again = Vec::new();
        for (number, rays) in rays.chunks(LANES).enumerate() {
            let number = number * LANES;
            let outcomes = self.bundle.update(inputs, (first + number, rays), true, &mut self.sums);
            for ((k, ray), outcome) in (number..).zip(rays).zip(outcomes) {
                match outcome {
                    Outcome::Added(reach) => reaches[k] = reach,
                    Outcome::Unlikely => reaches[k] = self.slowly.update(inputs, first + k, ray, &mut self.sums),
                    Outcome::Leapt => again.push(k),
                }
            }
            let passages = self.bundle.passages().iter().filter(|(l, _)| outcomes[*l] != Outcome::Leapt);
            leapt.extend(passages.map(|(l, passage)| Passage { ray: (number + l) as u32, ..*passage }));
        }
        for numbers in again.chunks(LANES) {
            let rays: Vec<Ray> = numbers.iter().map(|k| rays[*k]).collect();
            let outcomes = self.bundle.update(inputs, (first, &rays), false, &mut self.sums);
            for ((k, ray), outcome) in numbers.iter().zip(&rays).zip(outcomes) {
                reaches[*k] = match outcome {
                    Outcome::Added(reach) => reach,
                    _ => self.slowly.update(inputs, first + k, ray, &mut self.sums),
                };
            }
        }
    }

    /// `ln P(readings | map)` of up to [`LANES`] rays. Those that should not have leapt are asked about once more, together; of those
    /// that single precision has no evidence for, double precision has some.
    fn evidence(&mut self, inputs: &Inputs, rays: &[Ray], leap: bool) -> f64 {
        let Predicted { evidence, unlikely, leapt } = self.bundle.predict(inputs, (0, rays), leap);
        let (mut sum, mut again) = (0.0, Vec::new());
        for (l, ray) in rays.iter().enumerate() {
            if leapt[l] {
                again.push(*ray);
                continue;
            }
            let evidence = if unlikely[l] { self.slowly.evidence(inputs, 0, ray) } else { f64::from(evidence[l]) };
            sum += libm::log(evidence.max(f64::MIN_POSITIVE));
        }
        if again.is_empty() { sum } else { sum + self.evidence(inputs, &again, false) }
    }
}
