//! The likelihood of the reading where the ray hits none of its cells.

use mapper::past_the_map::{self, PastTheMap};
use sensor::Kernel as _;

use super::ViewingRay;

/// The chain is followed until this probability mass is left.
const REST: f64 = 1e-9;

/// So many cells at most are taken one by one: a tenth of a second. With fewer obstacles than that, see below.
const ONE_BY_ONE: f64 = 1e7;

const BLOCK: usize = 256;

/// `P(o | no cell of the ray is occupied)`, 1/px: the value given, or the sum over the cells past the end, the m-th of which is hit
/// with probability `u0 (1 - u0)^m`, until a mass of 1e-9 is left.
///
/// [`past_the_map::likelihood`] of the mappers takes longer steps in the far tail, good to 1e-5 of the value. Here every cell counts,
/// but for a world with an obstacle in less than 2e-6 of its cells. A world without any is seen as one whose obstacles are infinitely far.
pub(super) fn likelihood(ray: &ViewingRay) -> f64 {
    if let Some(given) = ray.no_hit_likelihood {
        return given;
    }
    let onset = ray.onset();
    let mut likelihood = [0.0; BLOCK];
    if onset <= 0.0 {
        let far = &mut likelihood[..1];
        ray.stereo.likelihood(ray.observation_px, 0.0, &[f64::INFINITY; 2], far);
        return far[0];
    }
    if libm::log(REST) / libm::log1p(-onset) > ONE_BY_ONE {
        let beyond = PastTheMap { from_m: ray.enters_m(ray.cells()), chord_m: ray.cell_size_m, onset };
        return past_the_map::likelihood(&ray.stereo, ray.observation_px, 0.0, &beyond);
    }
    let mut ranges = [0.0; BLOCK + 1];
    let (mut mass, mut sum, mut first) = (1.0, 0.0, ray.cells());
    loop {
        for (k, range) in ranges.iter_mut().enumerate() {
            *range = ray.enters_m(first + k);
        }
        ray.stereo.likelihood(ray.observation_px, 0.0, &ranges, &mut likelihood);
        for l in likelihood {
            if mass < REST {
                return sum;
            }
            sum += mass * onset * l;
            mass *= 1.0 - onset;
        }
        first += BLOCK;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(observation_px: f64, prior: f64, correlation: f64) -> ViewingRay {
        ViewingRay::new(observation_px, vec![prior; 12], correlation)
    }

    #[test]
    fn agrees_with_what_the_mappers_use() {
        for observation in [0.5, 1.0, 3.0, 20.0] {
            let ray = ray(observation, 0.1, 0.871);
            let beyond = PastTheMap { from_m: ray.enters_m(12), chord_m: 0.05, onset: 0.0129 };
            let mappers = past_the_map::likelihood(&ray.stereo, observation, 0.0, &beyond);
            // They follow the last 1e-9 too, which is where a reading of half a pixel is likely.
            assert!((likelihood(&ray) / mappers - 1.0).abs() < 1e-7, "{observation}");
        }
    }

    #[test]
    fn has_no_seam_where_obstacles_become_rare() {
        for observation in [0.0, 1.0, 10.0] {
            let [dense, sparse] = [2.0724e-6, 2.0722e-6].map(|prior| likelihood(&ray(observation, prior, 0.0)));
            assert!((dense / sparse - 1.0).abs() < 1e-4, "{observation}: {dense} {sparse}");
            let [none, few] = [0.0, 1e-13].map(|prior| likelihood(&ray(observation, prior, 0.0)));
            assert!((none / few - 1.0).abs() < 1e-5, "{observation}: {none} {few}");
        }
    }

    #[test]
    fn a_value_given_is_the_value() {
        let ray = ViewingRay { no_hit_likelihood: Some(0.004), ..ray(10.0, 0.1, 0.5) };
        assert!((likelihood(&ray) - 0.004).abs() < 1e-18);
    }
}
