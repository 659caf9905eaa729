//! When a message holds: its stamp, or where that cannot be, when it was recorded.

/// A stamp that is farther from the time of recording than all others are is off, s.
const OFF_S: f64 = 60.0;

/// A clock that has nothing to do with the recorder's, as in a simulation, can also run faster or slower, by at most this.
const RATE: f64 = 10.0;

/// How stamps lie to the times of recording.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Clock {
    /// From the time of recording to the stamp, s, where it is more than what messages take.
    offset_s: f64,
    /// When the recording began, s.
    start_s: f64,
}

/// What a stamp is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stamp {
    /// The time of the message.
    Good,
    /// Not filled in.
    Zero,
    /// Far from when the message was recorded.
    Off,
}

impl Clock {
    /// By stamps and times of recording of some messages, ns; `start_ns` is when the recording began.
    pub(super) fn of(samples: &[(i64, u64)], start_ns: u64) -> Self {
        let mut offsets: Vec<f64> =
            samples.iter().map(|(stamp, recorded)| seconds(*stamp) - since(*recorded)).collect();
        let middle = offsets.len() / 2;
        let median = if offsets.is_empty() { 0.0 } else { *offsets.select_nth_unstable_by(middle, f64::total_cmp).1 };
        Self { offset_s: if median.abs() > OFF_S { median } else { 0.0 }, start_s: since(start_ns) }
    }

    /// The time of a message, s, and what its stamp is.
    pub(super) fn time_s(&self, stamp_ns: i64, recorded_ns: u64) -> (f64, Stamp) {
        let recorded_s = since(recorded_ns);
        let expected_s = recorded_s + self.offset_s;
        if stamp_ns == 0 {
            return (expected_s, Stamp::Zero);
        }
        let stamp_s = seconds(stamp_ns);
        let other = if self.offset_s.abs() > 0.0 { RATE * (recorded_s - self.start_s).max(0.0) } else { 0.0 };
        match (stamp_s - expected_s).abs() <= OFF_S + other {
            true => (stamp_s, Stamp::Good),
            false => (expected_s, Stamp::Off),
        }
    }
}

/// Of a time of recording, s.
fn since(ns: u64) -> f64 {
    ns as f64 / 1e9
}

/// Of a stamp, s.
fn seconds(ns: i64) -> f64 {
    ns as f64 / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;

    const S: u64 = 1_000_000_000;

    #[test]
    fn a_stamp_is_the_time_unless_it_is_missing_or_far_off() {
        let samples: Vec<(i64, u64)> = (100..110).map(|k| ((k * S) as i64 - 50_000_000, k * S)).collect();
        let clock = Clock::of(&samples, 100 * S);
        assert_eq!(clock.time_s(104 * S as i64, 105 * S), (104.0, Stamp::Good));
        assert_eq!(clock.time_s(0, 105 * S), (105.0, Stamp::Zero));
        assert_eq!(clock.time_s(1_104 * S as i64, 105 * S), (105.0, Stamp::Off));
        assert_eq!(clock.time_s(-1, 105 * S), (105.0, Stamp::Off));
    }

    #[test]
    fn the_clock_of_a_simulation_is_kept() {
        // Recorded at half the speed, with one stamp that is off.
        let samples: Vec<(i64, u64)> = (0..9).map(|k| ((k * S / 2) as i64, (1_700_000_000 + k) * S)).collect();
        let clock = Clock::of(&samples, 1_700_000_000 * S);
        let at = |stamp: i64, recorded: u64| clock.time_s(stamp, (1_700_000_000 + recorded) * S);
        assert_eq!(at(500 * S as i64, 1_000), (500.0, Stamp::Good));
        assert_eq!(at(90_000 * S as i64, 8).1, Stamp::Off);
        let (time_s, stamp) = at(0, 8);
        assert!(stamp == Stamp::Zero && (time_s - 6.0).abs() < 3.0, "{time_s}");
    }

    #[test]
    fn without_any_stamp_the_time_of_recording_holds() {
        assert_eq!(Clock::of(&[], 7 * S).time_s(0, 9 * S), (9.0, Stamp::Zero));
    }
}
