//! An open field of posts, with a robot that drives round it twice.

use std::fmt::Write as _;
use std::path::Path;

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use scene::{Scene, SceneError};

/// Posts per m².
const DENSITY: f64 = 0.2;

/// Radius of a post, and how far apart posts are at least, m.
const RADIUS_M: f64 = 0.05;
const APART_M: f64 = 0.4;

/// The robot keeps so far off posts, m.
const LANE_M: f64 = 0.5;

/// The way runs so far from the border of the field, share of its side.
const INSET: f64 = 0.25;

/// A random stream of its own.
const POSTS: u64 = u64::MAX - (5 << 32);

/// The field of a seed: `posts` at random places of a square with 0.2 of them per m², none on the way, which is a square of half its side
/// that is driven twice.
///
/// # Errors
/// None but a defect.
pub(super) fn field(posts: u32, seed: u64) -> Result<Scene, SceneError> {
    // The lane takes a part of the square.
    let side = (f64::from(posts) / DENSITY).sqrt() + 2.0 * LANE_M;
    let (low, high) = (INSET * side, (1.0 - INSET) * side);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(POSTS);
    let mut places: Vec<[f64; 2]> = Vec::new();
    while places.len() < posts as usize {
        let at = [0, 1].map(|_| (RADIUS_M + (side - 2.0 * RADIUS_M) * rng.random::<f64>() * 1e3).round() / 1e3);
        let at = at.map(|v: f64| v.clamp(RADIUS_M, side - RADIUS_M));
        let inside = at.iter().all(|v| *v > low - LANE_M && *v < high + LANE_M);
        let within = at.iter().all(|v| *v > low + LANE_M && *v < high - LANE_M);
        let apart = |other: &[f64; 2]| libm::hypot(other[0] - at[0], other[1] - at[1]) > APART_M;
        if (!inside || within) && places.iter().all(apart) {
            places.push(at);
        }
    }
    Scene::parse(&text(&places, side, [low, high]), Path::new("posts.toml"), None)
}

fn text(places: &[[f64; 2]], side: f64, [low, high]: [f64; 2]) -> String {
    let mut text = format!(
        "name = \"posts-{}\"\nbounds = {{ min = [0.0, 0.0], max = [{side:.3}, {side:.3}] }}\ngrid.cell = 0.1\n\
         waypoints = {{ A = [{low:.3}, {low:.3}], B = [{high:.3}, {low:.3}], C = [{high:.3}, {high:.3}], D = [{low:.3}, {high:.3}] }}\n\
         route.stops = [\"A\", \"B\", \"C\", \"D\", \"A\", \"B\", \"C\", \"D\", \"A\"]\n\
         camera = {{ columns = 200, field_of_view_deg = 70.0 }}\nsensor = {{ detection_rate = 0.9 }}\n\
         robot.scan_interval = 0.4\n[odometry]\n",
        places.len(),
    );
    for [x, y] in places {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "[[disc]]\ncenter = [{x:.3}, {y:.3}]\nradius = {RADIUS_M}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_can_be_driven_and_has_its_posts() {
        for (posts, seed) in [(1, 1), (20, 1), (20, 2), (150, 3)] {
            let scene = field(posts, seed).expect("a valid scene");
            assert_eq!(scene::features(&scene).len(), posts as usize);
            let drive = scene::drive(&scene).expect("a free way");
            let [first, last] = [drive.poses[0].pose, drive.poses[drive.poses.len() - 1].pose];
            assert!(libm::hypot(first.x_m - last.x_m, first.y_m - last.y_m) < 1e-6, "it ends where it began");
            assert!(scene.odometry.is_some());
        }
        let places = |seed| field(30, seed).expect("valid").obstacles;
        assert_eq!(places(4), places(4));
        assert_ne!(places(4), places(5));
    }
}
