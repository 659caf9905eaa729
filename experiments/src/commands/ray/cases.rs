//! The paper's three viewing rays (Section 3.2) and what it claims about them.
//!
//! The paper numbers cells by their place on the ray: "the 30th" is cell 30 here, which begins at 1.5 m, where the disparity is
//! 10 px. It gives no priors but that of Figure 8; those chosen here stand in [`Case::about`].

use super::{Answers, ViewingRay};
use crate::worlds::claims::Claim;

/// The paper's prior and correlation for cells of 5 cm.
const UNSEEN: f64 = 0.1;
const CORRELATION: f64 = 0.871;

/// Cells of an obstacle of 40 cm, the paper's mean.
pub(super) const OBSTACLE: usize = 8;

/// First cell of the obstacle that hides the rest in `occluded`, "about the 100th".
pub(super) const OBVIOUS_AT: usize = 100;

/// How certain the obstacle of `occluded` is, in each of its cells.
pub(super) const OBVIOUS: f64 = 0.999;

/// "Unchanged" in `occluded` is less than this. The curve of `certainty.csv` shows how certain the obstacle must be for it.
pub(super) const UNCHANGED: f64 = 0.01;

/// "Does not change" in `distant` is less than this, "rises" more.
const KEPT: f64 = 0.05;

/// One of the paper's rays.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name on the command line.
    pub name: &'static str,
    /// The paper's figure.
    pub figure: &'static str,
    /// What was chosen, and where the paper is silent.
    pub about: String,
    /// The ray.
    pub ray: ViewingRay,
}

/// Names of the cases.
pub const NAMES: [&str; 3] = ["near", "distant", "occluded"];

/// The case of a name.
pub fn find(name: &str) -> Option<Case> {
    match name {
        "near" => Some(Case {
            name: "near",
            figure: "Figure 8",
            about: format!("an unseen world (prior {UNSEEN}, correlation {CORRELATION}) and a reading of 10 px."),
            ray: ViewingRay::new(10.0, vec![UNSEEN; 60], CORRELATION),
        }),
        "distant" => Some(Case {
            name: "distant",
            figure: "Figure 9",
            about: format!(
                "cells 95 to 110 were found occupied with {PLATEAU}, falling to {UNSEEN} over\n\
                 {RAMP} cells on either side; the rest is unseen (prior {UNSEEN}, correlation {CORRELATION}\n\
                 throughout). A reading of 3 px with a standard deviation of 0.5 px, which is\n\
                 4.3 to 6 m, cells 86 to 120: wider than the obstacle."
            ),
            ray: ViewingRay::new(3.0, (0..160).map(found).collect(), CORRELATION),
        }),
        "occluded" => Some(Case {
            name: "occluded",
            figure: "Figure 10",
            about: format!(
                "an obstacle of 40 cm, cells {OBVIOUS_AT} to {}, each occupied with {OBVIOUS};\n\
                 the rest is unseen (prior {UNSEEN}, correlation {CORRELATION} throughout). A reading of\n\
                 1 px, which is 10 to 30 m, cells 200 to 600.",
                OBVIOUS_AT + OBSTACLE - 1
            ),
            ray: hidden(OBVIOUS, UNSEEN),
        }),
        _ => None,
    }
}

/// Prior of the cells that earlier readings found occupied in `distant` ...
const PLATEAU: f64 = 0.9;

/// ... and so many cells on either side over which it falls to that of the unseen world.
const RAMP: usize = 4;

fn found(cell: usize) -> f64 {
    let outside = 95usize.saturating_sub(cell).max(cell.saturating_sub(110));
    UNSEEN + (PLATEAU - UNSEEN) * (1.0 - outside as f64 / (RAMP + 1) as f64).max(0.0)
}

/// A ray with an obstacle of the given certainty, the cells in front of which have the prior `before`.
pub(super) fn hidden(certainty: f64, before: f64) -> ViewingRay {
    let prior = |cell: usize| match cell {
        c if c < OBVIOUS_AT => before,
        c if c < OBVIOUS_AT + OBSTACLE => certainty,
        _ => UNSEEN,
    };
    ViewingRay::new(1.0, (0..600).map(prior).collect(), CORRELATION)
}

impl Case {
    /// Cells that the claims are about, to point out in the picture.
    pub fn bands(&self) -> &'static [((usize, usize), &'static str)] {
        match self.name {
            "near" => &[((30, 37), "40 cm")],
            "distant" => &[((90, 120), "90 to 120")],
            _ => &[((100, 107), ""), ((200, 560), "200 to 560")],
        }
    }

    /// The paper's claims about this ray.
    pub fn claims(&self, answers: &Answers) -> Vec<Claim> {
        let of = |posterior: &[f64]| Changes(posterior.iter().zip(&self.ray.prior).map(|(p, q)| p - q).collect());
        let visibility = of(&answers.visibility.posterior);
        let conventional = of(&answers.conventional.posterior);
        match self.name {
            "near" => near(answers),
            "distant" => distant(&visibility, &conventional),
            _ => occluded(&visibility, &conventional),
        }
    }
}

/// Posterior less prior of every cell.
struct Changes(Vec<f64>);

impl Changes {
    fn least(&self, first: usize, last: usize) -> f64 {
        self.0[first..=last].iter().copied().fold(f64::INFINITY, f64::min)
    }

    fn most(&self, first: usize, last: usize) -> f64 {
        self.0[first..=last].iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    fn stays(&self, rule: &str, (first, last): (usize, usize), within: f64) -> Claim {
        let (least, most) = (self.least(first, last), self.most(first, last));
        Claim {
            claim: format!("{rule}: cells {first} to {last} stay at their prior"),
            measured: format!("changes from {least:+.4} to {most:+.4}, at most {within} either way"),
            holds: least.abs().max(most.abs()) <= within,
        }
    }

    fn rises(&self, rule: &str, (first, last): (usize, usize), by: f64) -> Claim {
        let least = self.least(first, last);
        Claim {
            claim: format!("{rule}: every cell from {first} to {last} rises"),
            measured: format!("least change {least:+.4}, at least {by:+}"),
            holds: least >= by,
        }
    }

    fn falls(&self, rule: &str, (first, last): (usize, usize), by: f64) -> Claim {
        let most = self.most(first, last);
        Claim {
            claim: format!("{rule}: every cell from {first} to {last} falls"),
            measured: format!("least fall {most:+.4}, at least {:+}", -by),
            holds: most <= -by,
        }
    }
}

/// Section 3.2.1: behind the 30th cell, as far as a mean obstacle reaches.
fn near(answers: &Answers) -> Vec<Claim> {
    let behind = 31..=30 + OBSTACLE;
    let ours = &answers.visibility.posterior;
    let theirs = &answers.conventional.posterior;
    let least = behind.clone().map(|k| ours[k] - theirs[k]).fold(f64::INFINITY, f64::min);
    vec![Claim {
        claim: format!(
            "just behind cell 30, cells {} to {}: visibility is above conventional",
            behind.start(),
            behind.end()
        ),
        measured: format!("by {least:+.4} at least"),
        holds: least > 0.0,
    }]
}

/// Section 3.2.2. The obstacle and what is behind it stay closest; the cells just in front of it fall a little, since the reading
/// rather comes from the obstacle.
fn distant(visibility: &Changes, conventional: &Changes) -> Vec<Claim> {
    vec![
        visibility.stays("visibility", (90, 120), KEPT),
        visibility.stays("visibility", (95, 120), 0.02),
        conventional.rises("conventional", (90, 120), KEPT),
        visibility.falls("visibility", (0, 75), KEPT),
        conventional.falls("conventional", (0, 75), KEPT),
    ]
}

/// Section 3.2.3.
fn occluded(visibility: &Changes, conventional: &Changes) -> Vec<Claim> {
    vec![
        visibility.stays("visibility", (200, 560), UNCHANGED),
        visibility.stays("visibility, the obstacle", (OBVIOUS_AT, OBVIOUS_AT + OBSTACLE - 1), UNCHANGED),
        conventional.rises("conventional", (200, 560), KEPT),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_claims_hold_and_would_not_with_the_rules_exchanged() {
        for name in NAMES {
            let case = find(name).expect("a case");
            let answers = Answers::of(&case.ray);
            assert!(case.claims(&answers).iter().all(|claim| claim.holds), "{name}");
            let exchanged = Answers {
                visibility: answers.conventional.clone(),
                conventional: answers.visibility.clone(),
                ..answers
            };
            assert!(case.claims(&exchanged).iter().any(|claim| !claim.holds), "{name}");
        }
    }

    #[test]
    fn the_prior_of_distant_is_high_where_the_paper_says() {
        for (cell, expected) in [(0, 0.1), (90, 0.1), (91, 0.26), (95, 0.9), (110, 0.9), (114, 0.26), (115, 0.1)] {
            assert!((found(cell) - expected).abs() < 1e-12, "cell {cell}");
        }
    }
}
