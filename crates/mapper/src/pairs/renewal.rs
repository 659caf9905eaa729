//! Neighbours after some time: what becomes of their joint probability where places are drawn again.

use crate::pairs::joint::Joint;

/// `P(E_i, E_j)` of neighbours after a time that occupied and free ones survive with the probabilities `survival` of each, where what
/// is drawn again is occupied with probability `prior`, and both of two with `prior_both`.
///
/// The slower of two neighbours is renewed only together with the faster: what covers both comes and goes at once. Every term is the
/// joint of a valid distribution, and the marginals are those of [`Elapsed::place`](crate::belief::renewal::Elapsed::place).
pub(crate) fn both_after(joint: &Joint, survival: [[f64; 2]; 2], prior: f64, prior_both: f64) -> f64 {
    let [first, second] = survival;
    let states = [(joint.ee, 0, 0), (joint.ef, 0, 1), (joint.fe, 1, 0), (joint.ff, 1, 1)];
    let mut both = joint.ee * first[0].min(second[0]);
    for (p, x, y) in states {
        let (a, b) = (first[x], second[y]);
        let only_second = if x == 0 { (a - b).max(0.0) } else { 0.0 };
        let only_first = if y == 0 { (b - a).max(0.0) } else { 0.0 };
        both += p * (prior * (only_first + only_second) + prior_both * (1.0 - a.max(b)));
    }
    both
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::renewal::{Place, Renewal};
    use proptest::prelude::*;

    type Kinds = [f64; 3];

    fn kinds() -> impl Strategy<Value = Kinds> {
        prop::array::uniform3(1e-6f64..1.0).prop_map(|kinds| kinds.map(|kind| kind / kinds.iter().sum::<f64>()))
    }

    fn place() -> impl Strategy<Value = Place> {
        (1e-6f64..0.999_999, kinds(), kinds()).prop_map(|(occupied, e, f)| Place { occupied, kinds: [e, f] })
    }

    proptest! {
        #[test]
        fn joints_stay_joints(
            rates_per_s in prop::array::uniform3(0.0f64..3.0), shares in kinds(), turnover_per_s in 0.0f64..0.5,
            first in place(), second in place(), both in 0.0f64..=1.0, prior in 0.01f64..0.9, seconds in 0.0f64..20.0,
            prior_both in 0.0f64..=1.0, stale: bool,
        ) {
            let renewal = Renewal { rates_per_s, shares, turnover_per_s, step_s: 0.0 };
            let within = |p: f64, q: f64, share: f64| {
                let low = (p + q - 1.0).max(0.0);
                low + share * (p.min(q) - low)
            };
            let joint = Joint::new(first.occupied, second.occupied, within(first.occupied, second.occupied, both));
            let (elapsed, still) = (renewal.over(seconds), renewal.over(0.0));
            let of_second = if stale { &still } else { &elapsed };
            let survival = [first.kinds.map(|k| elapsed.survival(&k)), second.kinds.map(|k| of_second.survival(&k))];
            let after = both_after(&joint, survival, prior, within(prior, prior, prior_both));
            let [p, q] = [elapsed.place(&first, prior).occupied, of_second.place(&second, prior).occupied];
            prop_assert!(after >= (p + q - 1.0).max(0.0) - 1e-12 && after <= p.min(q) + 1e-12, "{after} of {p} and {q}");
        }
    }

    /// The events by which two neighbours are renewed, one by one: neither, one alone, or both.
    #[test]
    fn a_joint_is_the_sum_over_what_is_renewed() {
        let (joint, prior, prior_both) = (Joint::new(0.7, 0.4, 0.35), 0.1, 0.08);
        let survival = [[0.9, 0.5], [0.6, 0.8]];
        let mut both = 0.0;
        for (p, x, y) in [(joint.ee, 0, 0), (joint.ef, 0, 1), (joint.fe, 1, 0), (joint.ff, 1, 1)] {
            let [lost, other] = [1.0 - survival[0][x], 1.0 - survival[1][y]];
            let together = f64::min(lost, other);
            let [here, there] = [x == 0, y == 0].map(|occupied| if occupied { 1.0 } else { 0.0 });
            let events = [
                (1.0 - lost - other + together, here * there),
                (lost - together, prior * there),
                (other - together, here * prior),
                (together, prior_both),
            ];
            assert!((events.iter().map(|event| event.0).sum::<f64>() - 1.0).abs() < 1e-15);
            both += events.iter().map(|(event, occupied)| p * event * occupied).sum::<f64>();
        }
        assert!((both_after(&joint, survival, prior, prior_both) - both).abs() < 1e-15);
    }
}
