//! `--at-most`: what the errors of a way must not exceed.

/// Every metric there is.
const METRICS: [&str; 10] = [
    "ate",
    "ate_rotation",
    "rpe_1m",
    "rpe_1m_rotation",
    "relations",
    "relations_rotation",
    "relations_loops",
    "relations_loops_rotation",
    "relations_others",
    "relations_others_rotation",
];

/// What the mean of a metric must not exceed.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// Name of the metric.
    pub metric: String,
    /// In the unit of the metric.
    pub most: f64,
}

pub(super) fn bound(text: &str) -> Result<Bound, String> {
    let parts = text.split_once('=').and_then(|(metric, most)| Some((metric.trim(), most.trim().parse().ok()?)));
    match parts {
        Some((metric, most)) if METRICS.contains(&metric) && f64::is_finite(most) && most >= 0.0 => {
            Ok(Bound { metric: metric.to_owned(), most })
        }
        _ => Err(format!(
            "must be a metric and a number, 0 or more, such as ate=0.05; metrics are {}",
            METRICS.join(", ")
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_name_a_metric_and_a_number() {
        assert!(bound("ate = 0.5").is_ok_and(|bound| bound.metric == "ate" && bound.most.total_cmp(&0.5).is_eq()));
        assert!(["ate", "ate=", "ate=-1", "ate=inf", "eta=1", "=1"].iter().all(|text| bound(text).is_err()));
    }
}
