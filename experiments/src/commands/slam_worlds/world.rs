//! One world: driven with odometry that drifts, mapped and scored.

use std::sync::Arc;

use mapper::Model;
use mapper::catalogue::Entry;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use scene::{Family, Odometry, SimulatedScan};
use score::trajectory::{Believed, Pair, absolute, aligned, nees};
use score::{Region, Scorer, Sightings};
use sensor::{Laser, Pose, Scan, wrapped_rad};
use slam::Slam;

use super::options::{Sensing, SlamWorldsOptions, Weighed};
use crate::failure::Failure;
use crate::worlds::condition::AS_BELIEVED;
use crate::worlds::site::{Assumptions, Site, WorldId};
use crate::worlds::track::plain;
use crate::worlds::witness::Witness;

/// Random stream of a laser's readings, far from those of the camera.
const LASER: u64 = 1 << 40;

/// Beams of the laser, a degree apart.
const BEAMS: u32 = 181;

/// How a world went.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outcome {
    pub(super) family: String,
    pub(super) seed: u64,
    pub(super) sensor: Sensing,
    pub(super) weighed: Weighed,
    /// Root mean square error of the places after alignment, m: found, and by the odometry.
    pub(super) ate_m: f64,
    pub(super) odometry_ate_m: f64,
    /// Log loss of the map, nats per cell: from the poses found, aligned with the true ones as a rigid body, and from the true poses.
    pub(super) log_loss: f64,
    pub(super) true_log_loss: f64,
    /// Mean of `N_eff`, and how often particles were drawn anew.
    pub(super) effective: f64,
    pub(super) resampled: usize,
    /// Normalised squared error of the last pose by the spread of the particles; none where they do not spread in all of x, y and heading.
    pub(super) nees: Option<f64>,
}

/// A world with its readings, before any filter.
pub(super) struct Drive {
    family: String,
    seed: u64,
    sensing: Sensing,
    site: Site,
    scans: Vec<SimulatedScan>,
    odometry: Vec<Pose>,
    /// What its rays can see.
    seen: Sightings,
}

impl Drive {
    /// Drives through a world of a family.
    pub(super) fn of(family: &Family, seed: u64, sensing: Sensing) -> Result<Self, Failure> {
        let condition = AS_BELIEVED.name.to_owned();
        let world = WorldId { family: family.name.clone(), condition, cell_um: None, seed };
        let mut site = Site::of_family(family, &world, &Assumptions::default())?;
        if site.ground.moves() {
            return Err(Failure::BadInput(format!(
                "--families: {}: things move in it, and slam takes worlds at rest",
                family.name
            )));
        }
        let driven: Vec<Pose> = site.ground.drive.poses.iter().map(|timed| timed.pose).collect();
        let odometry = Odometry { noise: SlamWorldsOptions::NOISE, ..Odometry::default() }.measure(&driven, seed);
        let mut scans = scene::simulate(&site.ground.scene, &site.ground.world, &site.ground.drive, seed).scans;
        if sensing == Sensing::Laser {
            let laser = Laser::default();
            site.setup = Model { prior: site.setup.prior, ..Model::new(site.setup.grid, Arc::new(laser)) };
            scans.iter_mut().enumerate().for_each(|(number, scan)| look(&site, &laser, (seed, number), scan));
        }
        let mut witness = Witness::new(&site.ground);
        scans.iter().enumerate().try_for_each(|(number, scan)| witness.look(&site.ground, number, scan))?;
        Ok(Self { family: family.name.clone(), seed, sensing, site, scans, odometry, seen: witness.seen })
    }

    /// How it goes by every weight; what does not depend on it is found once.
    pub(super) fn outcomes(
        &self,
        entry: &Entry,
        weighed: &[Weighed],
        options: &SlamWorldsOptions,
    ) -> Result<Vec<Outcome>, Failure> {
        let (odometry_ate_m, _) = self.aligned(&self.odometry)?;
        let driven: Vec<Pose> = self.site.ground.drive.poses.iter().map(|timed| timed.pose).collect();
        let true_log_loss = self.log_loss(entry, &driven)?;
        weighed.iter().map(|weighed| self.slam(entry, *weighed, options, (odometry_ate_m, true_log_loss))).collect()
    }

    /// Finds the way and the map by one weight.
    fn slam(
        &self,
        entry: &Entry,
        weighed: Weighed,
        options: &SlamWorldsOptions,
        (odometry_ate_m, true_log_loss): (f64, f64),
    ) -> Result<Outcome, Failure> {
        let Site { ground, setup } = &self.site;
        let options = options.filter(self.seed, weighed.weight);
        let noise = Arc::new(SlamWorldsOptions::NOISE);
        let mut filter = Slam::new(entry.mapper(setup), setup, noise, options)
            .map_err(|error| Failure::BadInput(format!("--mapper {}: {error}", entry.name)))?;
        for (scan, odometry) in self.scans.iter().zip(&self.odometry) {
            filter.take(&scan.scan, *odometry);
        }
        let last = ground.drive.poses.last().map(|timed| timed.pose);
        let nees = last.and_then(|last| consistency(&filter.particles(), last));
        let outcome = filter.finish();
        let found: Vec<Pose> = outcome.trajectory.iter().map(|(_, pose)| *pose).collect();
        let (ate_m, aligned) = self.aligned(&found)?;
        let updates = &outcome.updates;
        Ok(Outcome {
            family: self.family.clone(),
            seed: self.seed,
            sensor: self.sensing,
            weighed,
            ate_m,
            odometry_ate_m,
            log_loss: self.log_loss(entry, &aligned)?,
            true_log_loss,
            effective: updates.iter().map(|update| update.effective).sum::<f64>() / updates.len() as f64,
            resampled: updates.iter().filter(|update| update.resampled).count(),
            nees,
        })
    }

    /// The absolute error of poses, m, after alignment with the true ones, and the poses aligned.
    fn aligned(&self, poses: &[Pose]) -> Result<(f64, Vec<Pose>), Failure> {
        let pair = |(pose, timed): (&Pose, &scene::TimedPose)| Pair {
            time_s: timed.time_s,
            estimate: plain(*pose),
            reference: plain(timed.pose),
        };
        let pairs: Vec<Pair> = poses.iter().zip(&self.site.ground.drive.poses).map(pair).collect();
        let moved = aligned(&pairs).map_err(Failure::internal)?;
        let errors = absolute(&moved).map_err(Failure::internal)?;
        let back = |pair: &Pair| {
            let score::trajectory::Pose { x_m, y_m, theta_rad } = pair.estimate;
            Pose { x_m, y_m, theta_rad }
        };
        Ok((errors.translation_m.rmse, moved.iter().map(back).collect()))
    }

    /// Log loss of the map of all scans from poses, nats per cell that could be seen.
    fn log_loss(&self, entry: &Entry, poses: &[Pose]) -> Result<f64, Failure> {
        let Site { ground, setup } = &self.site;
        let mut mapper = entry.mapper(setup);
        for (scan, pose) in self.scans.iter().zip(poses) {
            mapper.integrate(&Scan { pose: *pose, ..scan.scan.clone() });
        }
        mapper.settle();
        let scorer = Scorer::new(&ground.truth, self.seen.surface())?;
        let scores = scorer.scores(mapper.occupancy(), &self.seen.mask(Region::Observable))?;
        let nothing = || Failure::Internal(format!("{} seed {}: nothing could be seen", self.family, self.seed));
        scores.log_loss.value.ok_or_else(nothing)
    }
}

/// Puts what a laser measures in the place of what the camera did.
fn look(site: &Site, laser: &Laser, (seed, number): (u64, usize), scan: &mut SimulatedScan) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(LASER + number as u64);
    let pose = scan.scan.pose;
    scan.scan.bearings_rad = (0..BEAMS).map(|beam| (f64::from(beam) - 90.0).to_radians()).collect();
    let cast =
        |bearing: &f64| site.ground.world.cast(pose.position_m(), pose.direction(*bearing)).map(|hit| hit.range_m);
    scan.true_ranges_m = scan.scan.bearings_rad.iter().map(cast).collect();
    scan.scan.readings = scan.true_ranges_m.iter().map(|range_m| Some(laser.sample(*range_m, &mut random))).collect();
}

/// The squared error of the particles' mean in units of their covariance; none where that is not positive definite.
fn consistency(particles: &[(Pose, f64)], truth: Pose) -> Option<f64> {
    let first = particles.first()?.0;
    let off = |pose: &Pose| [pose.x_m - first.x_m, pose.y_m - first.y_m, wrapped_rad(pose.theta_rad - first.theta_rad)];
    let mean =
        |of: &dyn Fn([f64; 3]) -> f64| particles.iter().map(|(pose, weight)| weight * of(off(pose))).sum::<f64>();
    let middle: [f64; 3] = std::array::from_fn(|k| mean(&|off| off[k]));
    let covariance =
        std::array::from_fn(|r| std::array::from_fn(|c| mean(&|off| (off[r] - middle[r]) * (off[c] - middle[c]))));
    let estimate = score::trajectory::Pose {
        x_m: first.x_m + middle[0],
        y_m: first.y_m + middle[1],
        theta_rad: first.theta_rad + middle[2],
    };
    let reference = plain(truth);
    nees(&[Believed { estimate, covariance, reference }]).ok().map(|nees| nees.mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consistency_is_the_squared_error_in_standard_deviations() {
        // Corners of a box: standard deviations 0.1 m, 0.2 m and 0.05 rad, none correlated.
        let corner = |k: usize| {
            let side = |bit: usize| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
            (Pose { x_m: 2.0 + 0.1 * side(0), y_m: 1.0 + 0.2 * side(1), theta_rad: 3.13 + 0.05 * side(2) }, 0.125)
        };
        let particles: Vec<(Pose, f64)> = (0..8).map(corner).collect();
        // 2, 1 and 1 of them, the heading by the shorter turn.
        let truth = Pose { x_m: 2.2, y_m: 0.8, theta_rad: 3.18 - std::f64::consts::TAU };
        assert!(consistency(&particles, truth).is_some_and(|nees| (nees - 6.0).abs() < 1e-9));
        assert_eq!(consistency(&particles[..1], truth), None);
    }
}
