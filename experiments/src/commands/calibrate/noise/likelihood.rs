//! Sigma from differences: the largest likelihood, and the interval of its score.

use score::Interval;

use super::Difference;

/// Standard normal density at 0.
const AT_ZERO: f64 = 0.398_942_280_401_432_7;

/// Fewer differences than this say too little.
const FEWEST: usize = 300;

/// What differences say of the noise.
#[derive(Debug, Clone)]
pub struct Noise {
    /// Standard deviation of a reading, in its unit.
    pub sigma: f64,
    /// Where it lies with 95 % coverage.
    pub interval: Interval,
    /// Readings that lie on a piece of surface.
    pub readings: usize,
    /// Values of sigma, and by how much their loss is larger, nats per reading.
    pub profile: Vec<(f64, f64)>,
    /// Share of them that belong to it.
    pub share: f64,
}

/// Fits `share N(0, sigma^2 (1 + spread)) + (1 - share) / (2 window)` to the differences of scans in their order; None where there are
/// too few.
pub fn fit(scans: &[Vec<Difference>], guess: f64, window: f64) -> Option<Noise> {
    let readings: usize = scans.iter().map(Vec::len).sum();
    if readings < FEWEST {
        return None;
    }
    let (mut sigma, mut share) = (guess, 0.9);
    for _ in 0..500 {
        let (mut mine, mut square) = (0.0, 0.0);
        for difference in scans.iter().flatten() {
            let Difference { error, spread } = difference;
            let weight = density(difference, sigma, share, window).1;
            mine += weight;
            square += weight * error * error / (1.0 + spread);
        }
        let next = libm::sqrt(square / mine);
        let done = (next / sigma - 1.0).abs() < 1e-7;
        (sigma, share) = (next, (mine / readings as f64).clamp(0.01, 0.999_99));
        if done {
            break;
        }
    }
    let spread = relative_error(scans, sigma, share, window);
    let interval = Interval { low: sigma * libm::exp(-spread), high: sigma * libm::exp(spread) };
    let loss = |sigma: f64| {
        let density = |d: &Difference| density(d, sigma, share, window).0;
        -scans.iter().flatten().map(|d| libm::log(density(d))).sum::<f64>() / readings as f64
    };
    let least = loss(sigma);
    let profile =
        (-10..=10).map(|k| sigma * libm::exp(0.2 * f64::from(k) * spread)).map(|s| (s, loss(s) - least)).collect();
    (sigma.is_finite() && sigma > 0.0 && spread.is_finite()).then_some(Noise {
        sigma,
        interval,
        readings,
        profile,
        share,
    })
}

/// Density of a difference, and the probability that it is one of a surface.
fn density(difference: &Difference, sigma: f64, share: f64, window: f64) -> (f64, f64) {
    let scale = sigma * libm::sqrt(1.0 + difference.spread);
    let z = difference.error / scale;
    let here = share * AT_ZERO / scale * libm::exp(-0.5 * z * z);
    let all = here + (1.0 - share) / (2.0 * window);
    (all, here / all)
}

/// Half the interval of `ln sigma`. The score of a difference is `belongs (z^2 - 1)` for `ln sigma` and `belongs / share - (1 - belongs) /
/// (1 - share)` for the share; the bread is the outer product of scores, the meat that of their sums over blocks.
fn relative_error(scans: &[Vec<Difference>], sigma: f64, share: f64, window: f64) -> f64 {
    let block = libm::sqrt(scans.len() as f64).round() as usize;
    let (mut bread, mut meat) = ([0.0; 3], [0.0; 3]);
    let mut blocks = 0.0;
    let add = |to: &mut [f64; 3], s: [f64; 2]| {
        (to[0], to[1], to[2]) = (to[0] + s[0] * s[0], to[1] + s[0] * s[1], to[2] + s[1] * s[1]);
    };
    for members in scans.chunks(block.max(1)) {
        let mut sum = [0.0; 2];
        for difference in members.iter().flatten() {
            let Difference { error, spread } = difference;
            let weight = density(difference, sigma, share, window).1;
            let z2 = error * error / (sigma * sigma * (1.0 + spread));
            let score = [weight * (z2 - 1.0), weight / share - (1.0 - weight) / (1.0 - share)];
            add(&mut bread, score);
            sum = [sum[0] + score[0], sum[1] + score[1]];
        }
        add(&mut meat, sum);
        blocks += 1.0;
    }
    let determinant = bread[0] * bread[2] - bread[1] * bread[1];
    let row = [bread[2] / determinant, -bread[1] / determinant];
    let variance = row[0] * row[0] * meat[0] + 2.0 * row[0] * row[1] * meat[1] + row[1] * row[1] * meat[2];
    // Student's 97.5 % point of so few blocks, to a percent from 5 on (Peizer and Pratt 1968, first terms).
    let freedom: f64 = (blocks - 1.0_f64).max(2.0);
    let z = 1.959_964;
    let student = z
        + (z * z * z + z) / (4.0 * freedom)
        + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * freedom * freedom);
    student * libm::sqrt(variance * blocks / (blocks - 1.0).max(1.0))
}
