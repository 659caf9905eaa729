//! The noise of readings about surfaces whose place is known better than to a cell.
//!
//! A map knows a wall to a cell. The reading `o` of a wall at range `r` is then, for the map, `o = r_c + u + e` with `r_c` the middle of
//! the chord through the wall's cell, `u` the wall's place in it, and `e` the noise. What predictions show of the noise is the spread of
//! `u + e`, from which the kernel, Eq. (21), takes the `w^2 / 12` of a wall that may be anywhere in a chord of length `w`. But `u` is
//! the same for all readings of that wall: a wall on a line of the grid, as most drawn ones are, is at one end of its chord, and where
//! the map holds both cells beside the line for possible, `w^2 / 3` are taken off. So a sigma of 6 cm by cells of 5 cm comes out as
//! `sqrt(6^2 - 5^2 / 3) = 5.3` to `sqrt(6^2 - 5^2 / 12) = 5.8` cm, and what is below half a cell cannot be told at all. More readings do not
//! help, since all share their `u`.
//!
//! So sigma is not asked of the cells. Each half of the scans gives pieces of straight surface (`Piece`): a line with normal `n` and offset
//! `c`, fitted to the readings about a place by least squares along their rays,
//!
//! ```text
//! r_k = (c - n.o_k) / (n.d_k) + e_k,      weight 1 / var(e_k), and Tukey's biweight against outliers
//! ```
//!
//! (a ray is known and only its range is noisy, so that no error in variables flattens the line). A piece that is bent, such as a corner, is
//! left out by the readings it is made of alone, which the readings of the other half do not know of. A reading `o` of the other half on that
//! piece differs from what the line predicts by `N(0, sigma^2 (1 + v))`, where `sigma^2 v` is the variance of the prediction, from the least
//! squares; or it has nothing to do with the piece, uniformly within the window. Sigma is the value of the largest likelihood of these
//! differences, and its interval is that of the score summed over blocks of neighbouring scans (the sandwich of Huber 1967).

mod likelihood;
mod line;
mod piece;

use rayon::prelude::*;
use sensor::{Ray, Scan, Stereo};

pub use likelihood::{Noise, fit};
use piece::{Piece, Point};

/// Differences beyond so many sigma of the last guess belong to something else.
const WINDOW: f64 = 8.0;

/// Guesses, at most.
const ROUNDS: usize = 8;

/// Readings less sure of their range than this, m, make no pieces ...
const SURE_M: f64 = 0.15;

/// ... and less than this, are not predicted by them: too much may stand within their window.
const PREDICTED_M: f64 = 0.3;

/// A ray that meets a piece at a smaller sine than this is not predicted: the piece's error is multiplied by its inverse.
const SLANT: f64 = 0.35;

/// A ray that meets a piece at a smaller sine than this runs along it.
const GRAZING: f64 = 0.02;

/// What a reading says of a range.
#[derive(Debug, Clone, Copy)]
pub enum Instrument {
    /// A reading is a range, m.
    Laser,
    /// A reading is a disparity, px.
    Stereo(Stereo),
    /// The same, of a camera that looks all round: of the range, whatever the bearing.
    Omnidirectional(Stereo),
    /// A reading is a range, m, whose inverse has the same noise at any range; sigma is of that, 1/m.
    Depth,
}

impl Instrument {
    /// A reading as that whose noise is the same at any range: of a depth camera its inverse.
    pub(super) fn value(&self, reading: f64) -> f64 {
        if matches!(self, Self::Depth) { 1.0 / reading } else { reading }
    }

    /// Range of a reading, m, and how much its value changes with it.
    fn range(&self, ray: &Ray) -> Option<(f64, f64)> {
        let reading = ray.reading.filter(|reading| reading.is_finite() && *reading > 0.0)?;
        let of_disparity = |range_m: f64| range_m.is_finite().then(|| (range_m, reading / range_m));
        match self {
            Self::Laser => Some((reading, 1.0)),
            Self::Stereo(stereo) => of_disparity(stereo.range(reading, ray.bearing_rad)),
            Self::Omnidirectional(stereo) => of_disparity(stereo.range(reading, 0.0)),
            Self::Depth => Some((reading, 1.0 / (reading * reading))),
        }
    }

    /// Value of the reading of a range, and how much it changes with it.
    fn reading(&self, range_m: f64, bearing_rad: f64) -> (f64, f64) {
        let of_disparity = |disparity: f64| (disparity, disparity / range_m);
        match self {
            Self::Laser => (range_m, 1.0),
            Self::Stereo(stereo) => of_disparity(stereo.disparity(range_m, bearing_rad)),
            Self::Omnidirectional(stereo) => of_disparity(stereo.disparity(range_m, 0.0)),
            Self::Depth => (1.0 / range_m, 1.0 / (range_m * range_m)),
        }
    }
}

/// A reading less what a piece of surface predicts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// In the unit of readings.
    pub error: f64,
    /// Variance of the prediction, in those of a reading.
    pub spread: f64,
}

/// What scans say of the noise of their readings, if enough of them lie on straight surfaces; `guess` is where to begin.
pub fn of(scans: &[Scan], instrument: Instrument, guess: f64) -> Option<Noise> {
    let mut sigma = guess;
    let mut found = None;
    for _ in 0..ROUNDS {
        let noise = fit(&differences(scans, instrument, sigma), sigma, WINDOW * sigma)?;
        let done = (noise.sigma / sigma - 1.0).abs() < 0.02;
        sigma = noise.sigma;
        found = Some(noise);
        if done {
            break;
        }
    }
    found
}

/// The differences of every scan within the window about a guess of sigma: each half of the scans, taken in turns, predicts the other.
pub fn differences(scans: &[Scan], instrument: Instrument, sigma: f64) -> Vec<Vec<Difference>> {
    let pieces: Vec<Vec<Piece>> = [0, 1]
        .into_par_iter()
        .map(|half| piece::pieces(&points(scans.iter().skip(half).step_by(2), instrument, sigma)))
        .collect();
    scans
        .par_iter()
        .enumerate()
        .map(|(number, scan)| {
            let pieces = &pieces[(number + 1) % 2];
            scan.rays().filter_map(|ray| difference(&ray, pieces, instrument, sigma)).collect()
        })
        .collect()
}

/// Straight pieces of what scans have seen, and readings held against them.
pub struct Surfaces {
    pieces: Vec<Piece>,
    instrument: Instrument,
    sigma: f64,
}

impl Surfaces {
    /// The pieces of these scans, whose readings scatter by sigma.
    pub fn of(scans: &[Scan], instrument: Instrument, sigma: f64) -> Self {
        Self { pieces: piece::pieces(&points(scans.iter(), instrument, sigma)), instrument, sigma }
    }

    /// A reading as that whose noise is the same at any range.
    pub fn value(&self, reading: f64) -> f64 {
        self.instrument.value(reading)
    }

    /// Range (m) of the nearest piece that a ray crosses, whatever it reads, and the angle between ray and piece, rad.
    pub fn first_crossed(&self, ray: &Ray) -> Option<(f64, f64)> {
        let crossed =
            self.pieces.iter().filter_map(|piece| Some((piece.crossing(ray, GRAZING)?.range_m, piece.angle(ray))));
        crossed.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Whether a reading is of none of the pieces that its ray crosses; none where it crosses none whose reading is known well, and of no reading.
    pub fn is_astray(&self, ray: &Ray) -> Option<bool> {
        let reading = self.value(ray.reading.filter(|reading| reading.is_finite() && *reading > 0.0)?);
        let mut is_astray = None;
        for crossing in self.pieces.iter().filter_map(|piece| piece.crossing(ray, SLANT)) {
            let (expected, slope) = self.instrument.reading(crossing.range_m, ray.bearing_rad);
            if (reading - expected).abs() <= WINDOW * self.sigma {
                return Some(false);
            }
            if self.sigma / slope <= PREDICTED_M {
                is_astray = Some(true);
            }
        }
        is_astray
    }
}

fn points<'a>(scans: impl Iterator<Item = &'a Scan>, instrument: Instrument, sigma: f64) -> Vec<Point> {
    let point = |ray: Ray| {
        let (range_m, slope) = instrument.range(&ray)?;
        let sigma_m = sigma / slope;
        (sigma_m <= SURE_M).then_some(Point { origin_m: ray.origin_m, direction: ray.direction, range_m, sigma_m })
    };
    scans.flat_map(Scan::rays).filter_map(point).collect()
}

/// Of the pieces near a reading that with the middle nearest to where the ray crosses it, which the reading itself does not choose.
fn difference(ray: &Ray, pieces: &[Piece], instrument: Instrument, sigma: f64) -> Option<Difference> {
    let reading = instrument.value(ray.reading?);
    let (range_m, slope) = instrument.range(ray)?;
    let far_m = WINDOW * sigma / slope;
    let end = [0, 1].map(|k| ray.origin_m[k] + range_m * ray.direction[k]);
    let mut best: Option<(f64, Difference)> = None;
    for piece in pieces {
        let reach_m = 4.0 * far_m + piece.half_m;
        if (piece.centre_m[0] - end[0]).abs() > reach_m || (piece.centre_m[1] - end[1]).abs() > reach_m {
            continue;
        }
        let Some(crossing) = piece.crossing(ray, SLANT) else { continue };
        let (expected, slope) = instrument.reading(crossing.range_m, ray.bearing_rad);
        let sure = sigma / slope <= PREDICTED_M;
        if sure && (reading - expected).abs() <= WINDOW * sigma && best.is_none_or(|(off, _)| crossing.off_m < off) {
            let spread = slope * slope * crossing.variance_m2 / (sigma * sigma);
            best = Some((crossing.off_m, Difference { error: reading - expected, spread }));
        }
    }
    best.map(|(_, difference)| difference)
}
