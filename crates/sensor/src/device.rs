//! A sensor of a simulated robot, of any kind: how it is sampled, and the model by which mappers know it.

use std::sync::Arc;

use rand::{Rng, RngExt as _};

use crate::{Depth, Laser, Matcher, Omnidirectional, SensorModel, Sonar, Stereo, Surface};

/// Kinds of sensors, as scene files name them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SensorKind {
    /// A laser range finder.
    Laser,
    /// Sonars.
    Sonar,
    /// A stereo camera.
    Stereo,
    /// A depth camera.
    Depth,
}

impl SensorKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Laser, Self::Sonar, Self::Stereo, Self::Depth];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Laser => "laser",
            Self::Sonar => "sonar",
            Self::Stereo => "stereo",
            Self::Depth => "depth",
        }
    }

    /// The kind of the given name.
    pub fn of(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// A sensor as it is simulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Device {
    /// A laser range finder.
    Laser(Laser),
    /// Sonars; a ray is the axis of a cone, and what it ends on the nearest surface in the cone.
    Sonar(Sonar),
    /// A stereo camera with an image plane.
    Stereo(Matcher),
    /// A stereo camera that looks all round.
    Omnidirectional(Matcher),
    /// A depth camera, and the share of its pixels that give a reading, 0 to 1.
    Depth(Depth, f64),
}

/// Of a sensor without noise, as nearly as a mapper can assume it: so likely is a reading right.
const SURE: f64 = 0.99;

/// ... and so far is it off, m.
const SHARP_M: f64 = 0.005;

impl Device {
    /// Its kind.
    pub fn kind(&self) -> SensorKind {
        match self {
            Self::Laser(_) => SensorKind::Laser,
            Self::Sonar(_) => SensorKind::Sonar,
            Self::Stereo(_) | Self::Omnidirectional(_) => SensorKind::Stereo,
            Self::Depth(..) => SensorKind::Depth,
        }
    }

    /// The model by which mappers know it.
    pub fn model(&self) -> Arc<dyn SensorModel> {
        match *self {
            Self::Laser(laser) => Arc::new(laser),
            Self::Sonar(sonar) => Arc::new(sonar),
            Self::Stereo(matcher) => Arc::new(matcher.stereo),
            Self::Omnidirectional(matcher) => Arc::new(Omnidirectional(matcher.stereo)),
            Self::Depth(depth, _) => Arc::new(depth),
        }
    }

    /// The range beyond which it measures nothing, m; infinite of a stereo camera.
    pub fn max_range_m(&self) -> f64 {
        match self {
            Self::Laser(laser) => laser.max_range_m,
            Self::Sonar(sonar) => sonar.max_range_m,
            Self::Stereo(_) | Self::Omnidirectional(_) => f64::INFINITY,
            Self::Depth(depth, _) => depth.max_range_m,
        }
    }

    /// Angle between the edges of the cone of a reading, rad; 0 of all but sonars.
    pub fn width_rad(&self) -> f64 {
        if let Self::Sonar(sonar) = self { sonar.width_rad } else { 0.0 }
    }

    /// The readings of a scan: one per bearing (rad), from what each ray ends on. `stream(ray)` gives the random numbers of a ray.
    ///
    /// # Panics
    /// Unless there are as many ends as bearings.
    pub fn read<R: Rng>(
        &self,
        bearings_rad: &[f64],
        ends: &[Option<Surface>],
        stream: impl FnMut(usize) -> R,
    ) -> Vec<Option<f64>> {
        self.read_again(bearings_rad, ends, stream, |_| None)
    }

    /// As [`read`](Self::read), of what was looked at before: of a stereo camera, `noise(ray)` gives the Gaussian part of a reading, where there is
    /// any, and `stream(ray)` all else ([`Matcher::scan_again`]). What others read is fresh: `noise(ray)` where there is any.
    ///
    /// # Panics
    /// Unless there are as many ends as bearings.
    pub fn read_again<R: Rng>(
        &self,
        bearings_rad: &[f64],
        ends: &[Option<Surface>],
        mut stream: impl FnMut(usize) -> R,
        mut noise: impl FnMut(usize) -> Option<R>,
    ) -> Vec<Option<f64>> {
        let ranges = || ends.iter().map(|end| end.map(|surface| surface.range_m)).enumerate();
        let mut fresh = |ray: usize| noise(ray).unwrap_or_else(|| stream(ray));
        match self {
            Self::Laser(laser) => ranges().map(|(ray, range_m)| Some(laser.sample(range_m, &mut fresh(ray)))).collect(),
            Self::Sonar(sonar) => ranges().map(|(ray, range_m)| Some(sonar.sample(range_m, &mut fresh(ray)))).collect(),
            Self::Stereo(matcher) => matcher.scan_again(bearings_rad, ends, stream, noise),
            Self::Omnidirectional(matcher) => matcher.scan_again(&vec![0.0; bearings_rad.len()], ends, stream, noise),
            Self::Depth(depth, detection_rate) => {
                let pixel = |(ray, end): (usize, &Option<Surface>)| {
                    let (surface, mut rng) = ((*end)?, fresh(ray));
                    let is_read = rng.random::<f64>() < detection_rate * surface.texture;
                    is_read.then(|| depth.sample(surface.range_m, &mut rng)).flatten()
                };
                ends.iter().enumerate().map(pixel).collect()
            }
        }
    }

    /// What it would read without noise on a ray at `bearing_rad` (rad) that ends at `range_m` (m), if it would read anything.
    pub fn noise_free(&self, range_m: Option<f64>, bearing_rad: f64) -> Option<f64> {
        let within = range_m.filter(|range_m| *range_m <= self.max_range_m());
        match self {
            Self::Laser(_) | Self::Sonar(_) => Some(within.unwrap_or(f64::INFINITY)),
            Self::Stereo(matcher) => matcher.noise_free(range_m?, bearing_rad),
            Self::Omnidirectional(matcher) => matcher.noise_free(range_m?, 0.0),
            Self::Depth(..) => within,
        }
    }

    /// The device that gives noise-free readings, as nearly as a mapper can assume it: not so sharp that a wall on a grid line falls between
    /// two cells.
    pub fn sharp(&self) -> Self {
        let no_echo = 0.5 * (1.0 - SURE);
        let of = |matcher: &Matcher| Matcher {
            stereo: Stereo { disparity_sigma: 0.05, correct_match: SURE, ..matcher.stereo },
            ..*matcher
        };
        match self {
            Self::Laser(laser) => {
                Self::Laser(Laser { range_sigma_m: SHARP_M, hit: SURE, no_echo, early_per_m: 0.0, ..*laser })
            }
            Self::Sonar(sonar) => {
                Self::Sonar(Sonar { range_sigma_m: SHARP_M, hit: SURE, no_echo, early_per_m: 0.0, ..*sonar })
            }
            Self::Stereo(matcher) => Self::Stereo(of(matcher)),
            Self::Omnidirectional(matcher) => Self::Omnidirectional(of(matcher)),
            Self::Depth(depth, detection_rate) => Self::Depth(Depth { hit: SURE, ..*depth }, *detection_rate),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pose;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng as _};

    fn devices() -> [Device; 5] {
        [
            Device::Laser(Laser { max_range_m: 8.0, ..Laser::default() }),
            Device::Sonar(Sonar::default()),
            Device::Stereo(Matcher { detection_rate: 1.0, ..Matcher::default() }),
            Device::Omnidirectional(Matcher { detection_rate: 1.0, ..Matcher::default() }),
            Device::Depth(Depth::default(), 0.9),
        ]
    }

    fn stream(ray: usize) -> ChaCha8Rng {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        rng.set_word_pos(64 * ray as u128);
        rng
    }

    /// By the model that it gives, a device's readings are of the range that they were drawn for.
    #[test]
    fn readings_are_of_the_surface_as_the_model_has_it() {
        for device in devices() {
            let bearings: Vec<f64> = (0..2000).map(|k| 0.0005 * f64::from(k)).collect();
            let ends = vec![Some(Surface { range_m: 2.0, texture: 1.0 }); 2000];
            let (model, readings) = (device.model(), device.read(&bearings, &ends, stream));
            let ranges: Vec<f64> =
                readings.iter().zip(&bearings).filter_map(|(o, b)| model.range_of((*o)?, *b)).collect();
            let right = ranges.iter().filter(|range| (*range - 2.0).abs() < 0.5).count() as f64 / ranges.len() as f64;
            assert!(ranges.len() > 1400 && right > 0.75, "{device:?}: {right} of {}", ranges.len());
            let exact = device.noise_free(Some(2.0), 0.4).and_then(|o| model.range_of(o, 0.4)).expect("in range");
            assert!((exact - 2.0).abs() < 1e-12, "{device:?}");
            assert_eq!(device.sharp().kind(), device.kind());
            assert_eq!(SensorKind::of(device.kind().name()), Some(device.kind()));
        }
        assert_eq!(SensorKind::of("radar"), None);
    }

    #[test]
    fn where_there_is_nothing_echoes_are_missing_and_cameras_are_silent() {
        let nothing = |device: &Device| (device.noise_free(None, 0.0), device.noise_free(Some(9.0), 0.0));
        let [laser, sonar, stereo, all_round, depth] = devices();
        for device in [laser, sonar] {
            assert_eq!(nothing(&device), (Some(f64::INFINITY), Some(f64::INFINITY)));
        }
        for device in [stereo, all_round] {
            assert_eq!(nothing(&device).0, None);
            assert!(device.noise_free(Some(9.0), 0.0).is_some() && device.max_range_m().is_infinite());
        }
        assert_eq!(nothing(&depth), (None, None));
        assert!(sonar.width_rad() > 0.5 && laser.width_rad() <= 0.0);
        // A surface without texture is none for cameras; a laser needs no texture.
        let ends = vec![Some(Surface { range_m: 1.0, texture: 0.0 }); 50];
        let count =
            |device: &Device| device.read(&[Pose::default().theta_rad; 50], &ends, stream).iter().flatten().count();
        assert_eq!([laser, stereo, depth].map(|device| count(&device)), [50, 0, 0]);
    }
}
