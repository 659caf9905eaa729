//! How many readings were given to the wrong landmark.

use std::collections::BTreeMap;

/// What became of a reading whose truth is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Associated {
    /// Number of the landmark that it was given to, or that it made; none where it was taken for a failed match.
    pub landmark: Option<u32>,
    /// Whether it made that landmark.
    pub is_first: bool,
    /// The feature that it is of.
    pub feature: u32,
    /// Whether the match is right: the disparity of one that failed is of nothing.
    pub matched: bool,
}

/// Associations counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Associations {
    /// Readings of right matches that were given to a landmark that was there.
    pub given: usize,
    /// Those among them whose landmark is of another feature.
    pub wrong: usize,
    /// Readings of failed matches.
    pub failed: usize,
    /// Those among them that were given to a landmark that was there.
    pub failed_given: usize,
}

/// Counts associations. A landmark is of the feature that most of its right readings are of, the lowest number of several. O(n log n).
pub fn associations(readings: &[Associated]) -> Associations {
    let mut votes: BTreeMap<u32, BTreeMap<u32, usize>> = BTreeMap::new();
    for reading in readings.iter().filter(|reading| reading.matched) {
        if let Some(landmark) = reading.landmark {
            *votes.entry(landmark).or_default().entry(reading.feature).or_default() += 1;
        }
    }
    let feature = |landmark: u32| {
        let votes = votes.get(&landmark)?;
        let most = votes.values().max()?;
        votes.iter().find(|(_, count)| *count == most).map(|(feature, _)| *feature)
    };
    let mut counted = Associations::default();
    for reading in readings {
        let given = reading.landmark.filter(|_| !reading.is_first);
        match (reading.matched, given) {
            (true, Some(landmark)) => {
                counted.given += 1;
                counted.wrong += usize::from(feature(landmark) != Some(reading.feature));
            }
            (true, None) => {}
            (false, given) => {
                counted.failed += 1;
                counted.failed_given += usize::from(given.is_some());
            }
        }
    }
    counted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let reading = |landmark: Option<u32>, is_first: bool, feature: u32, matched: bool| Associated {
            landmark,
            is_first,
            feature,
            matched,
        };
        let readings = [
            reading(Some(0), true, 7, true),
            reading(Some(0), false, 7, true),
            reading(Some(0), false, 7, true),
            reading(Some(0), false, 8, true),
            reading(Some(0), false, 7, false),
            // Made by a failed match, and of feature 9 since.
            reading(Some(1), true, 7, false),
            reading(Some(1), false, 9, true),
            reading(None, false, 9, true),
            reading(None, false, 9, false),
        ];
        let found = associations(&readings);
        assert_eq!(found, Associations { given: 4, wrong: 1, failed: 3, failed_given: 1 });
        assert_eq!(associations(&[]), Associations::default());
    }
}
