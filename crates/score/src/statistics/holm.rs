//! Many tests at once: what a p-value is worth among others.

use crate::StatisticsError;

/// Adjusts the p-values of a family of tests by Holm's step-down method (Holm 1979), in the order
/// given: calling those at most α significant wrongly calls any with probability at most α, however
/// the tests hang together.
///
/// # Errors
/// A value that is not within 0 to 1.
pub fn holm(p: &[f64]) -> Result<Vec<f64>, StatisticsError> {
    if let Some((at, &value)) = p.iter().enumerate().find(|(_, p)| !is_probability(**p)) {
        return Err(StatisticsError::PValue { value, place: format!("position {at}") });
    }
    Ok(adjusted(p))
}

/// The same for a table of tests, such as mappers by metrics, all of which are one family. `None`, a
/// test that could not be made, stays `None` and does not count.
///
/// # Errors
/// A value that is not within 0 to 1.
pub fn holm_table(p: &[Vec<Option<f64>>]) -> Result<Vec<Vec<Option<f64>>>, StatisticsError> {
    for (row, values) in p.iter().enumerate() {
        for (column, value) in values.iter().enumerate() {
            if let Some(value) = value.filter(|p| !is_probability(*p)) {
                return Err(StatisticsError::PValue { value, place: format!("row {row}, column {column}") });
            }
        }
    }
    let made: Vec<f64> = p.iter().flatten().flatten().copied().collect();
    let mut adjusted = adjusted(&made).into_iter();
    Ok(p.iter().map(|row| row.iter().map(|p| p.and_then(|_| adjusted.next())).collect()).collect())
}

fn is_probability(p: f64) -> bool {
    (0.0..=1.0).contains(&p)
}

/// The k-th smallest of m (k from 0) is multiplied by m - k; none may fall below one before it.
fn adjusted(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|&a, &b| p[a].total_cmp(&p[b]));
    let mut adjusted = vec![0.0; p.len()];
    let mut least = 0.0f64;
    for (k, &at) in order.iter().enumerate() {
        least = least.max((p.len() - k) as f64 * p[at]).min(1.0);
        adjusted[at] = least;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn close(found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len());
        assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-15), "{found:?} and not {expected:?}");
    }

    #[test]
    fn by_hand() {
        // Sorted 0.005, 0.01, 0.03, 0.04, times 4, 3, 2, 1: 0.02, 0.03, 0.06, and 0.04 held up to 0.06.
        close(&holm(&[0.01, 0.04, 0.03, 0.005]).expect("valid"), &[0.03, 0.06, 0.06, 0.02]);
        close(&holm(&[0.4, 0.7, 0.5]).expect("valid"), &[1.0, 1.0, 1.0]);
        close(&holm(&[0.03]).expect("valid"), &[0.03]);
        close(&holm(&[]).expect("valid"), &[]);
        close(&holm(&[0.02, 0.02]).expect("valid"), &[0.04, 0.04]);
    }

    #[test]
    fn a_table_is_one_family_and_its_gaps_do_not_count() {
        let table = [vec![Some(0.01), None, Some(0.04)], vec![], vec![Some(0.03), Some(0.005)]];
        let found = holm_table(&table).expect("valid");
        assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [3, 0, 2]);
        assert_eq!(found[0][1], None);
        let flat: Vec<f64> = found.into_iter().flatten().flatten().collect();
        close(&flat, &[0.03, 0.06, 0.06, 0.02]);
    }

    #[test]
    fn what_is_no_p_value_is_refused_with_its_place() {
        for bad in [f64::NAN, -0.1, 1.1, f64::INFINITY] {
            let message = holm(&[0.5, bad]).expect_err("refused").to_string();
            assert!(message.starts_with(&format!("p-value {bad} at position 1 is not")), "{message}");
            let message = holm_table(&[vec![None], vec![None, Some(bad)]]).expect_err("refused").to_string();
            assert!(message.starts_with(&format!("p-value {bad} at row 1, column 1 is not")), "{message}");
        }
    }

    proptest! {
        /// Holm's own words: reject the smallest while each is at most α over the number of those left.
        #[test]
        fn rejects_what_the_procedure_rejects(
            p in prop::collection::vec(prop::sample::select(vec![0.0f64, 0.001, 0.004, 0.01, 0.012, 0.02, 0.03, 0.2, 1.0]), 0..12),
            alpha in 0.0005f64..0.2,
        ) {
            let mut left: Vec<usize> = (0..p.len()).collect();
            left.sort_by(|&a, &b| p[b].total_cmp(&p[a]));
            let mut rejected = vec![false; p.len()];
            while let Some(&at) = left.last() {
                if left.len() as f64 * p[at] > alpha {
                    break;
                }
                rejected[at] = true;
                left.pop();
            }
            let adjusted: Vec<bool> = holm(&p).expect("valid").iter().map(|p| *p <= alpha).collect();
            prop_assert_eq!(adjusted, rejected);
        }
    }
}
