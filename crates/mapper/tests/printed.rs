//! The oracle of the printed equations: the double sums as they stand in the paper, O(N²) and more.

use mapper::{Chain, Joint, RayPosterior, exact, printed};
use proptest::prelude::*;

/// Eqs. (8)-(17), one function per equation, in the paper's names.
struct Paper<'a>(&'a Chain);

impl Paper<'_> {
    fn e(&self, k: usize) -> f64 {
        self.0.occupied(k) // (11)
    }
    fn free_before_occupied(&self, k: usize) -> f64 {
        let Joint { ee, fe, .. } = self.0.joint(k - 1);
        fe / (ee + fe) // (12)
    }
    fn free_before_free(&self, q: usize) -> f64 {
        let Joint { ef, ff, .. } = self.0.joint(q);
        ff / (ff + ef) // (13)
    }
    fn c(&self, q: usize) -> f64 {
        let (p, n) = (self.e(q), self.e(q + 1));
        (self.0.joint(q).ee - p * n) / (p * (1.0 - p) * n * (1.0 - n)).sqrt() // (16)
    }
    fn alpha_c(&self, k: usize, j: usize) -> f64 {
        let (p, n) = (self.e(k), self.e(j));
        (p * (1.0 - p) * n * (1.0 - n)).sqrt() * (k..j).map(|q| self.c(q)).product::<f64>() // (17)
    }
    fn e_given_e(&self, k: usize, j: usize) -> f64 {
        (self.e(k) * self.e(j) + self.alpha_c(k, j)) / self.e(j) // (14)
    }
    fn e_given_free(&self, k: usize, j: usize) -> f64 {
        let free = 1.0 - self.e(j);
        (self.e(k) * free - self.alpha_c(k, j)) / free // (15)
    }
    /// The factors of (8)-(10) in front of the last one.
    fn clear_up_to(&self, k: usize) -> f64 {
        if k == 0 {
            return 1.0;
        }
        (0..k - 1).map(|q| self.free_before_free(q)).product::<f64>() * self.free_before_occupied(k)
    }
    fn f_given_e(&self, k: usize, j: usize) -> f64 {
        self.clear_up_to(k) * self.e_given_e(k, j) // (8)
    }
    fn f_given_free(&self, k: usize, j: usize) -> f64 {
        self.clear_up_to(k) * self.e_given_free(k, j) // (9)
    }
    fn f(&self, k: usize) -> f64 {
        self.clear_up_to(k) * self.e(k) // (10)
    }
    fn all_free(&self) -> f64 {
        let last = self.0.len() - 1;
        (0..last).map(|q| self.free_before_free(q)).product::<f64>() * (1.0 - self.e(last))
    }
}

fn double_sums(chain: &Chain, l: &[f64], none: f64) -> Vec<Joint> {
    let paper = Paper(chain);
    (0..chain.len() - 1)
        .map(|j| {
            let given_e: f64 = (0..=j).map(|k| l[k] * paper.f_given_e(k, j)).sum(); // (4), (5)
            let given_free: f64 = (0..j).map(|k| l[k] * paper.f_given_free(k, j)).sum();
            let beyond: f64 = (j + 1..chain.len()).map(|k| l[k] * paper.f(k)).sum::<f64>() + none * paper.all_free();
            let prior = chain.joint(j);
            let pair = Joint {
                ee: given_e * prior.ee,
                ef: given_e * prior.ef,
                fe: (given_free + l[j + 1] * paper.f(j + 1)) * prior.fe, // (6)
                ff: (given_free + beyond) * prior.ff,                    // (7)
            };
            pair.scaled(1.0 / pair.total()) // (1)
        })
        .collect()
}

prop_compose! {
    fn chains()(n in 2usize..=40)(
        marginal in prop::collection::vec(0.01f64..0.99, n),
        shares in prop::collection::vec(0.0f64..1.0, n - 1),
        likelihood in prop::collection::vec(0.003f64..0.8, n),
    ) -> (Chain, Vec<f64>) {
        let both = |p: f64, q: f64, s: f64| { let low = (p + q - 1.0).max(0.0); low + s * (p.min(q) - low) };
        let pairs = marginal.windows(2).zip(shares).map(|(p, share)| both(p[0], p[1], share)).collect();
        (Chain::new(marginal, pairs), likelihood)
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_running_sums_are_the_double_sums((chain, likelihood) in chains(), none in 0.001f64..0.7) {
        let mut fast = RayPosterior::default();
        printed::posterior(&chain, &likelihood, none, &mut fast);
        for (f, s) in fast.pairs.iter().zip(double_sums(&chain, &likelihood, none)) {
            for (f, s) in [(f.ee, s.ee), (f.ef, s.ef), (f.fe, s.fe), (f.ff, s.ff)] {
                prop_assert!((f - s).abs() < 1e-9, "{f} {s}");
            }
        }
    }
}

#[test]
fn the_printed_equations_are_not_the_posterior() {
    // An obstacle that is almost certain at the third cell, and a reading from far behind it.
    let marginal: Vec<f64> = vec![0.1, 0.1, 0.9, 0.1, 0.1, 0.1];
    let both: Vec<f64> = marginal.windows(2).map(|p| 0.5 * p[0].min(p[1])).collect();
    let chain = Chain::new(marginal, both);
    let likelihood = [0.003, 0.003, 0.003, 0.003, 0.6, 0.6];
    let (mut exact_out, mut printed_out) = (RayPosterior::default(), RayPosterior::default());
    exact::posterior(&chain, &likelihood, 0.01, &mut exact_out);
    printed::posterior(&chain, &likelihood, 0.01, &mut printed_out);
    let gap = exact_out.marginals().iter().zip(printed_out.marginals()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(gap > 0.1, "the largest gap between marginals is {gap}");
}
