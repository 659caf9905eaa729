//! `--at-most`: what the errors of ways and landmarks must not exceed.

use crate::failure::Failure;

/// What the mean of a metric must not exceed.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// Name of the metric.
    pub metric: String,
    /// In the unit of the metric.
    pub most: f64,
}

/// Reads `METRIC=BOUND`, the metric being one of those given.
///
/// # Errors
/// What it must be.
pub fn bound(text: &str, metrics: &[&str]) -> Result<Bound, String> {
    let parts = text.split_once('=').and_then(|(metric, most)| Some((metric.trim(), most.trim().parse().ok()?)));
    match parts {
        Some((metric, most)) if metrics.contains(&metric) && f64::is_finite(most) && most >= 0.0 => {
            Ok(Bound { metric: metric.to_owned(), most })
        }
        _ => Err(format!(
            "must be a metric and a number, 0 or more, such as ate=0.05; metrics are {}",
            metrics.join(", ")
        )),
    }
}

/// Whether all bounds hold. `found` gives mean and unit of a metric that there is, `needed` says what one takes that there is not.
///
/// # Errors
/// A bound on a metric that there is not, or that does not hold.
pub fn hold<'a>(
    bounds: &[Bound],
    found: impl Fn(&str) -> Option<(f64, &'a str)>,
    needed: impl Fn(&str) -> &'static str,
) -> Result<(), Failure> {
    let mut broken = Vec::new();
    for Bound { metric, most } in bounds {
        let Some((mean, unit)) = found(metric) else {
            let needed = needed(metric);
            return Err(Failure::BadInput(format!(
                "--at-most {metric}={most}: there is no {metric} here, which needs {needed}"
            )));
        };
        // What is no number does not hold.
        if mean.is_nan() || mean > *most {
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            broken.push(format!("{metric} is {mean:.4}{unit} on average, above {most}"));
        }
    }
    if broken.is_empty() { Ok(()) } else { Err(Failure::Claim(broken.join("; "))) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_name_a_metric_and_a_number() {
        let bound = |text| bound(text, &["ate"]);
        assert!(bound("ate = 0.5").is_ok_and(|bound| bound.metric == "ate" && bound.most.total_cmp(&0.5).is_eq()));
        assert!(["ate", "ate=", "ate=-1", "ate=inf", "eta=1", "=1"].iter().all(|text| bound(text).is_err()));
    }

    #[test]
    fn bounds_hold_are_broken_or_cannot_be_judged() {
        let of = |metric: &str, most| Bound { metric: metric.to_owned(), most };
        let found = |metric: &str| (metric == "ate").then_some((0.2, "m"));
        let judge = |bounds: &[Bound]| hold(bounds, found, |_| "a scene");
        assert!(judge(&[of("ate", 0.2)]).is_ok());
        assert!(
            matches!(judge(&[of("ate", 0.1)]), Err(Failure::Claim(text)) if text == "ate is 0.2000 m on average, above 0.1")
        );
        assert!(matches!(judge(&[of("rpe", 0.1)]), Err(Failure::BadInput(text)) if text.ends_with("needs a scene")));
        assert!(hold(&[of("ate", 9.0)], |_| Some((f64::NAN, "")), |_| "").is_err());
    }
}
