//! Scans of a robot that stands: what does not move gives the same image again.

use std::collections::HashMap;
use std::ops::Range;

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use rand_distr::StandardNormal;
use rayon::prelude::*;

use super::beside::Images;
use super::{End, Eye, SimulatedScan, WORDS_PER_RAY};
use crate::Drive;

/// Whether the robot ever stands from one scan to the next.
pub(super) fn any(drive: &Drive) -> bool {
    drive.poses.windows(2).any(|pair| pair[0].pose == pair[1].pose)
}

/// Scans made from one pose one after the other; a single scan where the robot is under way.
fn stands(drive: &Drive) -> Vec<Range<usize>> {
    let mut first = 0;
    let groups = drive.poses.chunk_by(|a, b| a.pose == b.pose).map(|group| {
        first += group.len();
        first - group.len()..first
    });
    groups.collect()
}

/// The scans of a drive on which the robot stands at times.
pub(super) fn scans(eye: &Eye) -> Vec<SimulatedScan> {
    let of_stand = |stand: Range<usize>| -> Vec<SimulatedScan> {
        let ends: Vec<Vec<End>> = stand.clone().into_par_iter().map(|scan| eye.look(scan)).collect();
        let images = images(&ends, stand.start);
        let beside = Images::of_stand(eye, stand.clone());
        let numbered = stand.clone().into_par_iter().zip(&ends).zip(&images);
        let scans = numbered.map(|((scan, ends), images)| {
            let mut read = eye.scan(scan, ends, |ray| images[ray], Some(&beside));
            if stand.len() > 1 {
                jitter(eye, scan, &mut read);
            }
            read
        });
        scans.collect()
    };
    let stands = stands(eye.drive).into_par_iter().map(of_stand).collect::<Vec<_>>();
    stands.into_iter().flatten().collect()
}

/// For every scan of a stand and every ray, the first scan in which the ray ended on the same.
pub(super) fn images(ends: &[Vec<End>], first: usize) -> Vec<Vec<usize>> {
    let rays = ends.first().map_or(0, Vec::len);
    let mut seen: Vec<HashMap<Option<[u64; 2]>, usize>> = vec![HashMap::new(); rays];
    let of_scan = |(k, ends): (usize, &Vec<End>)| -> Vec<usize> {
        let key = |end: &End| end.map(|surface| [surface.range_m.to_bits(), surface.texture.to_bits()]);
        ends.iter().zip(&mut seen).map(|(end, seen)| *seen.entry(key(end)).or_insert(first + k)).collect()
    };
    ends.iter().enumerate().map(of_scan).collect()
}

/// Moves the recorded pose by what the robot's odometry jitters while it stands: drawn behind the rays' places in the
/// stream of the scan.
fn jitter(eye: &Eye, scan: usize, read: &mut SimulatedScan) {
    let robot = &eye.scene.robot;
    if robot.jitter_m <= 0.0 && robot.jitter_rad <= 0.0 {
        return;
    }
    let mut rng = ChaCha8Rng::seed_from_u64(eye.seed);
    rng.set_stream(scan as u64);
    rng.set_word_pos(eye.bearings_rad.len() as u128 * WORDS_PER_RAY);
    let mut by = |deviation: f64| -> f64 { deviation * rng.sample::<f64, _>(StandardNormal) };
    let mut pose = read.scan.pose;
    (pose.x_m, pose.y_m) = (pose.x_m + by(robot.jitter_m), pose.y_m + by(robot.jitter_m));
    pose.theta_rad += by(robot.jitter_rad);
    read.move_to(pose);
}
