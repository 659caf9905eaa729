//! What a page shows of a filter's particles: where they were along the way, to be stepped through.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use sensor::Pose;
use serde_json::{Value, json};
use slam::Moments;

/// Most particles of all moments together: a page is to stay small.
const MOST: usize = 20_000;

/// Square of the Mahalanobis distance that holds 95 % of a Gaussian over two numbers: -2 ln 0.05.
const WITHIN_95: f64 = 5.991_464_547_107_979;

/// Particles along a way, over a map.
#[derive(Debug, Clone)]
pub struct Cloud {
    /// The map as PNG, north up.
    pub map: Vec<u8>,
    /// Its lower left and upper right corners, m.
    pub corners_m: [[f64; 2]; 2],
    /// Ways to be drawn, by name, m.
    pub ways: Vec<(&'static str, Vec<[f64; 2]>)>,
    /// In order of time.
    pub moments: Vec<Moment>,
}

/// The particles after a scan.
#[derive(Debug, Clone)]
pub struct Moment {
    /// Time of the scan, s.
    pub time_s: f64,
    /// Effective number of particles before they were drawn anew.
    pub effective: f64,
    /// Whether they were drawn anew.
    pub resampled: bool,
    /// Whether the robot came back here to where it had been long before.
    pub returned: bool,
    /// Pose of each, and its weight; the weights add up to one.
    pub particles: Vec<(Pose, f64)>,
}

impl Cloud {
    /// As the page's script reads it: lengths of moments in mm, angles in mrad, weights in thousandths of the largest.
    pub(super) fn json(&self) -> String {
        let moments: Vec<Value> = self.shown().map(moment).collect();
        let metres = |value: f64| json!((value * 100.0).round() / 100.0);
        let way = |(name, points): &(&'static str, Vec<[f64; 2]>)| json!({ "name": name, "points": thinned(points).map(|at| at.map(metres)).collect::<Vec<_>>() });
        let ways: Vec<Value> = self.ways.iter().filter(|(_, points)| !points.is_empty()).map(way).collect();
        let map = format!("data:image/png;base64,{}", BASE64_STANDARD.encode(&self.map));
        // No text of a user's is in here; a name of ours has no angle bracket.
        json!({ "map": map, "corners": self.corners_m, "ways": ways, "moments": moments }).to_string()
    }

    /// Evenly as many moments as there is room for, and those at which something happened.
    fn shown(&self) -> impl Iterator<Item = &Moment> {
        let particles = self.moments.iter().map(|moment| moment.particles.len()).max().unwrap_or(1).max(1);
        let step = self.moments.len().div_ceil((MOST / particles).max(2)).max(1);
        let last = self.moments.len().saturating_sub(1);
        self.moments
            .iter()
            .enumerate()
            .filter(move |(k, moment)| k % step == 0 || *k == last || moment.returned)
            .map(|(_, moment)| moment)
    }
}

/// A way with at most some thousand points, its ends among them.
fn thinned(points: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> {
    let step = points.len().div_ceil(2000).max(1);
    let last = points.len().saturating_sub(1);
    points.iter().enumerate().filter(move |(k, _)| k % step == 0 || *k == last).map(|(_, at)| *at)
}

fn moment(moment: &Moment) -> Value {
    let whole = |value: f64, of: f64| (value * of).round() as i64;
    let most = moment.particles.iter().map(|(_, weight)| *weight).fold(f64::MIN_POSITIVE, f64::max);
    let particles: Vec<i64> = moment
        .particles
        .iter()
        .flat_map(|(pose, weight)| {
            [whole(pose.x_m, 1e3), whole(pose.y_m, 1e3), whole(pose.theta_rad, 1e3), whole(weight / most, 1e3)]
        })
        .collect();
    let Ellipse { centre, axes, angle_rad } = ellipse(&moment.particles);
    json!({
        "t": (moment.time_s * 100.0).round() / 100.0,
        "effective": (moment.effective * 10.0).round() / 10.0,
        "resampled": moment.resampled,
        "returned": moment.returned,
        "particles": particles,
        "ellipse": [whole(centre[0], 1e3), whole(centre[1], 1e3), whole(axes[0], 1e3), whole(axes[1], 1e3), whole(angle_rad, 1e3)],
    })
}

/// Where a Gaussian with the particles' mean and covariance has 95 % of its weight.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ellipse {
    centre: [f64; 2],
    /// Half of the longer axis and of the shorter, m.
    axes: [f64; 2],
    /// Direction of the longer one.
    angle_rad: f64,
}

fn ellipse(particles: &[(Pose, f64)]) -> Ellipse {
    let Some(Moments { mean, covariance }) = Moments::of(particles.iter().copied()) else {
        return Ellipse { centre: [0.0; 2], axes: [0.0; 2], angle_rad: 0.0 };
    };
    let [[xx, xy, _], [_, yy, _], _] = covariance;
    // The eigenvalues of a symmetric matrix of two rows.
    let (half, off) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    let axes = [half + off, half - off].map(|value| (WITHIN_95 * value.max(0.0)).sqrt());
    Ellipse { centre: mean.position_m(), axes, angle_rad: 0.5 * libm::atan2(2.0 * xy, xx - yy) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x_m: f64, y_m: f64, weight: f64) -> (Pose, f64) {
        (Pose { x_m, y_m, theta_rad: 0.1 }, weight)
    }

    #[test]
    fn the_ellipse_has_the_axes_of_the_covariance() {
        // Variances of 2 along (1, 1) and of 0.5 across.
        let along = 1.0;
        let across = 0.5;
        let particles = [
            at(5.0 + along, 1.0 + along, 0.25),
            at(5.0 - along, 1.0 - along, 0.25),
            at(5.0 - across, 1.0 + across, 0.25),
            at(5.0 + across, 1.0 - across, 0.25),
        ];
        let found = ellipse(&particles);
        let expected = [1.0, 0.25].map(|variance: f64| (WITHIN_95 * variance).sqrt());
        for (axis, expected) in found.axes.iter().zip(expected) {
            assert!((axis - expected).abs() < 1e-12, "{found:?}");
        }
        assert!((found.centre[0] - 5.0).abs() + (found.centre[1] - 1.0).abs() < 1e-12);
        assert!((found.angle_rad - std::f64::consts::FRAC_PI_4).abs() < 1e-12);
    }

    #[test]
    fn pages_stay_small_and_keep_the_end_and_the_returns() {
        let moment = |k: usize| Moment {
            time_s: k as f64,
            effective: 3.0,
            resampled: false,
            returned: k == 17,
            particles: vec![at(1.0, 2.0, 0.01); 100],
        };
        let cloud = Cloud {
            map: vec![1, 2, 3],
            corners_m: [[0.0; 2], [1.0; 2]],
            ways: vec![("slam", vec![[0.125, 0.25]; 9000]), ("truth", Vec::new())],
            moments: (0..3001).map(moment).collect(),
        };
        let page: Value = serde_json::from_str(&cloud.json()).expect("JSON");
        let moments = page["moments"].as_array().expect("moments");
        assert!(moments.len() <= MOST / 100 + 2, "{}", moments.len());
        assert_eq!(moments[moments.len() - 1]["t"], 3000.0);
        assert!(moments.iter().any(|moment| moment["returned"] == true && moment["t"] == 17.0));
        assert_eq!(page["ways"].as_array().map(Vec::len), Some(1), "ways without a point are left out");
        assert!(page["ways"][0]["points"].as_array().is_some_and(|points| points.len() <= 2001));
        assert_eq!(
            moments[0]["particles"].as_array().map(|all| all[..4].to_vec()),
            Some(vec![json!(1000), json!(2000), json!(100), json!(1000)])
        );
    }
}
