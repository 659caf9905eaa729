//! What every rule makes of the reading.

use mapper::{Chain, ConventionalRule, Joint, RayPosterior, bayes, exact, printed};
use serde::Serialize;

use super::{ViewingRay, no_hit};

/// What one rule makes of the reading.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// `P(o | O)`, 1/px; none for a rule that has no model of the whole ray.
    pub evidence: Option<f64>,
    /// `P(E_k | o, O)` of every cell.
    pub posterior: Vec<f64>,
    /// Posterior odds over prior odds of every cell; none where the prior is 0 or 1, or the posterior is 1.
    pub likelihood_ratio: Vec<Option<f64>>,
    /// Posterior joint of every neighbouring pair, nearer cell first: both occupied, first only, second only, none.
    pub joint: Option<Vec<[f64; 4]>>,
}

/// What all rules make of the reading.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answers {
    /// The paper's method, summed exactly.
    pub visibility: Answer,
    /// The paper's equations as printed.
    #[serde(rename = "visibility-printed")]
    pub printed: Answer,
    /// Every cell for itself.
    pub conventional: Answer,
    /// As `visibility`, with no correlation between cells.
    pub independent: Answer,
}

impl Answers {
    /// Applies every rule.
    pub fn of(ray: &ViewingRay) -> Self {
        Self {
            visibility: along_the_ray(ray, ray.chain(), exact::posterior),
            printed: along_the_ray(ray, off_certainty(ray).chain(), printed::posterior),
            conventional: conventional(ray),
            independent: along_the_ray(&ray.uncorrelated(), ray.uncorrelated().chain(), exact::posterior),
        }
    }

    /// The answers with the names of their mappers.
    pub fn named(&self) -> [(&'static str, &Answer); 4] {
        [
            ("visibility", &self.visibility),
            ("visibility-printed", &self.printed),
            ("conventional", &self.conventional),
            ("independent", &self.independent),
        ]
    }
}

/// The printed equations divide by the probability of either state: there, certain cells are as good as certain.
fn off_certainty(ray: &ViewingRay) -> ViewingRay {
    const NEXT_TO_NOTHING: f64 = 1e-12;
    let prior = ray.prior.iter().map(|p| p.clamp(NEXT_TO_NOTHING, 1.0 - NEXT_TO_NOTHING)).collect();
    ViewingRay { prior, ..ray.clone() }
}

fn along_the_ray(ray: &ViewingRay, chain: Chain, rule: fn(&Chain, &[f64], f64, &mut RayPosterior)) -> Answer {
    let mut out = RayPosterior::default();
    rule(&chain, &ray.likelihood(), no_hit::likelihood(ray), &mut out);
    let entries = |pair: &Joint| [pair.ee, pair.ef, pair.fe, pair.ff];
    let joint = out.pairs.iter().map(entries).collect();
    answer(ray, out.marginals(), Some(out.evidence), Some(joint))
}

/// Eq. (22). The mapper of this name also keeps cells off 0 and 1, for the sake of later readings; here there are none.
fn conventional(ray: &ViewingRay) -> Answer {
    let rule = ConventionalRule::default();
    let update = |(k, &p): (usize, &f64)| {
        let (enter, exit) = (ray.enters_m(k), ray.enters_m(k + 1));
        let likelihoods = rule.likelihoods(&ray.stereo, ray.observation_px, 0.0, enter, exit);
        likelihoods.map_or(p, |likelihoods| bayes(p, likelihoods))
    };
    let posterior = ray.prior.iter().enumerate().map(update).collect();
    answer(ray, posterior, None, None)
}

fn answer(ray: &ViewingRay, posterior: Vec<f64>, evidence: Option<f64>, joint: Option<Vec<[f64; 4]>>) -> Answer {
    // Sums of two entries of a joint can pass 1 by a rounding.
    let posterior: Vec<f64> = posterior.into_iter().map(|p| p.clamp(0.0, 1.0)).collect();
    let ratio = |(&after, &before): (&f64, &f64)| {
        let ratio = (after / (1.0 - after)) / (before / (1.0 - before));
        Some(ratio).filter(|r| r.is_finite() && before > 0.0 && before < 1.0)
    };
    let likelihood_ratio = posterior.iter().zip(&ray.prior).map(ratio).collect();
    Answer { evidence, posterior, likelihood_ratio, joint }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_cell_is_bayes_rule_for_everyone_who_sees_the_ray() {
        let ray = ViewingRay { no_hit_likelihood: Some(0.02), ..ViewingRay::new(10.0, vec![0.1], 0.871) };
        let answers = Answers::of(&ray);
        let floor = 0.2 / 60.0; // the cell begins at the sensor, where nothing is matched
        let expected = 0.1 * floor / (0.1 * floor + 0.9 * 0.02);
        for answer in [&answers.visibility, &answers.printed, &answers.independent] {
            assert!((answer.posterior[0] - expected).abs() < 1e-15);
            assert!((answer.likelihood_ratio[0].expect("defined") - floor / 0.02).abs() < 1e-14);
            assert_eq!(answer.joint.as_deref(), Some(&[][..]));
        }
    }

    #[test]
    fn certain_cells_stay_certain_and_have_no_ratio() {
        let mut ray = ViewingRay::new(10.0, vec![0.1; 40], 0.871);
        (ray.prior[5], ray.prior[35]) = (0.0, 1.0);
        for (name, answer) in Answers::of(&ray).named() {
            assert!(answer.posterior.iter().all(|p| (0.0..=1.0).contains(p)), "{name}");
            assert!(answer.posterior[5] < 1e-11 && answer.posterior[35] > 1.0 - 1e-9, "{name}");
            assert_eq!((answer.likelihood_ratio[5], answer.likelihood_ratio[35]), (None, None), "{name}");
        }
    }
}
