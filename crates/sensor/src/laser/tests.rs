//! The kernel against sums over many surfaces and many readings.

use proptest::prelude::*;

use super::*;
use crate::fast_kernel::one_by_one;
use crate::lanes::LANES;

const NOTHING: f64 = f64::INFINITY;

/// A short beam, so that both of its ends are in reach of a test.
const LASER: Laser = Laser { range_sigma_m: 0.03, max_range_m: 8.0, hit: 0.9, no_echo: 0.06, early_per_m: 0.02 };

fn likelihood(laser: &Laser, reading: f64, enter: f64, exit: f64) -> f64 {
    let mut out = [0.0];
    laser.likelihood(reading, 0.0, &[enter, exit], &mut out);
    out[0]
}

/// `Phi` without its tail's relative precision.
fn cumulative(x: f64) -> f64 {
    0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}

/// The definition, for a surface at one range.
fn point(laser: &Laser, reading: f64, range: f64) -> f64 {
    let Laser { range_sigma_m: s, max_range_m, hit, no_echo, early_per_m } = *laser;
    let pass = |m: f64| libm::exp(-early_per_m * m);
    if reading.is_infinite() {
        let beyond = cumulative((range - max_range_m) / s) + cumulative((-range - max_range_m) / s);
        return hit * pass(max_range_m) * beyond + no_echo;
    }
    let image = |range: f64| {
        let z = (range - reading) / s;
        let density = libm::exp(-0.5 * z * z) / (s * libm::sqrt(2.0 * std::f64::consts::PI));
        density + early_per_m * cumulative(z)
    };
    hit * pass(reading) * (image(range) + image(-range)) + (1.0 - hit - no_echo) / max_range_m
}

/// Simpson's rule with steps of at most 0.02 sigma.
fn averaged(laser: &Laser, reading: f64, enter: f64, exit: f64) -> f64 {
    let parts = ((exit - enter) / (0.02 * laser.range_sigma_m)).ceil().max(1.0);
    let at = |k: f64| point(laser, reading, enter + (exit - enter) * k / parts);
    let simpson = |k: f64| at(k) + 4.0 * at(k + 0.5) + at(k + 1.0);
    (0..parts as u32).map(|k| simpson(f64::from(k))).sum::<f64>() / (6.0 * parts)
}

fn lasers() -> impl Strategy<Value = Laser> {
    let share = prop_oneof![6 => 0.01f64..1.0, 1 => Just(0.0)];
    (0.005f64..0.3, 2.0f64..90.0, 0.05f64..0.99, share, prop_oneof![4 => 0.0f64..0.3, 1 => Just(0.0)]).prop_map(
        |(range_sigma_m, max_range_m, hit, share, early_per_m)| {
            // At least a hundredth of the pulses are outliers.
            let no_echo = (0.99 - hit) * share;
            Laser { range_sigma_m, max_range_m, hit, no_echo, early_per_m }
        },
    )
}

/// Readings of a laser, those at its ends and no echo included.
fn readings(max_range_m: f64) -> impl Strategy<Value = f64> {
    prop_oneof![6 => 0.0f64..max_range_m, 1 => Just(0.0), 1 => Just(max_range_m), 2 => Just(NOTHING)]
}

fn lasers_and_readings() -> impl Strategy<Value = (Laser, f64)> {
    lasers().prop_flat_map(|laser| (Just(laser), readings(laser.max_range_m)))
}

#[test]
fn limits() {
    let floor = 0.04 / 8.0;
    assert!((likelihood(&LASER, 5.0, 2.0, 2.05) - floor).abs() < 1e-15, "in front only outliers");
    let early = 0.9 * (-0.1f64).exp() * 0.02 + floor;
    assert!((likelihood(&LASER, 5.0, 7.0, 7.05) - early).abs() < 1e-15, "behind also what stands in the way");
    assert!((likelihood(&LASER, 5.0, 1e9, 2e9) - early).abs() < 1e-15, "however far");
    assert!((likelihood(&LASER, 5.0, 1e9, f64::INFINITY) - early).abs() < 1e-15);
    let peak = 0.9 * (-0.1f64).exp() * (1.0 / (0.03 * (2.0 * std::f64::consts::PI).sqrt()) + 0.01) + floor;
    assert!((likelihood(&LASER, 5.0, 5.0, 5.0) - peak).abs() < 1e-12, "a chord without length");
    let wide = likelihood(&LASER, 5.0, 0.0, 10.0);
    assert!((wide - (0.9 * (-0.1f64).exp() * 0.1 * 1.1 + floor)).abs() < 1e-12, "all ranges up to 10 m: {wide}");

    assert!((likelihood(&LASER, NOTHING, 2.0, 2.05) - 0.06).abs() < 1e-15, "lost");
    let free = 0.9 * (-0.16f64).exp() + 0.06;
    assert!((likelihood(&LASER, NOTHING, 9.0, 9.05) - free).abs() < 1e-15, "nothing in reach");
    let half = likelihood(&LASER, NOTHING, 7.5, 8.5);
    assert!((half - 0.5 * (0.06 + free)).abs() < 1e-12, "half of a chord in reach: {half}");
    assert!((likelihood(&LASER, NOTHING, 0.0, 0.0) - 0.06).abs() < 1e-15, "a surface at the lens is no free beam");
    let lens = likelihood(&LASER, 0.0, 0.0, 0.0);
    let twice = 2.0 / (0.03 * (2.0 * std::f64::consts::PI).sqrt());
    assert!((lens - (0.9 * (twice + 0.02) + floor)).abs() < 1e-12, "its ranges are never negative: {lens}");
}

/// Without outliers the tails count; against the asymptotic series of the upper tail.
#[test]
fn without_outliers_the_tails_count() {
    let sure = Laser { no_echo: 0.1, early_per_m: 0.0, ..LASER };
    for sigmas in [12.0_f64, 30.0] {
        let density = (-0.5 * sigmas * sigmas).exp() / (2.0 * std::f64::consts::PI).sqrt();
        let at = 5.0 - 0.03 * sigmas;
        let found = likelihood(&sure, 5.0, at, at);
        assert!((found / (0.9 * density / 0.03) - 1.0).abs() < 1e-9, "{sigmas}: {found}");
        let certain = Laser { hit: 1.0, no_echo: 0.0, ..sure };
        let at = 8.0 - 0.03 * sigmas;
        let z2 = sigmas * sigmas;
        let tail = density / sigmas * (1.0 - 1.0 / z2 + 3.0 / (z2 * z2) - 15.0 / (z2 * z2 * z2));
        let found = likelihood(&certain, NOTHING, at, at);
        assert!((found / tail - 1.0).abs() < 1e-4, "{sigmas}: {found} {tail}");
    }
}

/// Found by chance: 38 standard deviations from the largest range, what rounding left was -1.6e-322.
#[test]
fn likelihoods_are_never_negative() {
    let (range_sigma_m, max_range_m, early_per_m) =
        (0.198_412_989_802_784_85, 7.930_855_447_354_196, 0.009_537_773_586_698_384);
    let laser = Laser { range_sigma_m, max_range_m, hit: 1.0, no_echo: 0.0, early_per_m };
    let enter = 0.286_554_441_211_254_54;
    for k in 0..1000 {
        let found = likelihood(
            &laser,
            NOTHING,
            enter + 1e-3 * f64::from(k),
            enter + 1e-3 * f64::from(k) + 0.022_346_782_990_343_973,
        );
        assert!(found >= 0.0, "{k}: {found}");
    }
}

#[test]
fn an_echo_is_a_point_and_no_echo_is_none() {
    assert_eq!(LASER.range_of(3.0, 0.4), Some(3.0), "a range is a range at any bearing");
    assert_eq!(LASER.range_of(NOTHING, 0.0), None);
    assert_eq!(LASER.range_of(-0.1, 0.0), None);
}

#[test]
fn a_bin_is_a_sigma_or_half_a_cell() {
    assert!((LASER.half_bin(0.01) - 0.03).abs() < 1e-15 && (LASER.half_bin(0.2) - 0.1).abs() < 1e-15);
    // Whatever the cells, one that was read is more likely to have been read than not.
    for cell_m in [0.01, 0.05, 0.2, 1.0] {
        for at in [0.0, 0.25, 0.5, 0.75, 1.0] {
            let enter = 3.0 - at * cell_m;
            let bin = LASER.bin_probability(3.0, LASER.half_bin(cell_m), 0.0, enter, enter + cell_m);
            assert!(bin > 0.4, "{cell_m} {at}: {bin}");
        }
    }
}

proptest! {
    #[test]
    fn likelihoods_beyond_differ_by_no_more_than_the_spread(
        (laser, reading) in lasers_and_readings(), from in 0.0f64..1.5, further in prop::array::uniform2(0.0f64..100.0),
    ) {
        let from = from * laser.max_range_m;
        let [a, b] = further.map(|further| likelihood(&laser, reading, from + further, from + further + 0.05));
        prop_assert!((a - b).abs() <= laser.spread_from(reading, 0.0, from), "{a} {b}");
        prop_assert!(laser.spread_from(reading, 0.0, 2.0 * laser.max_range_m) <= 1.0);
    }

    #[test]
    fn equals_the_average_over_the_chord(
        (laser, reading) in lasers_and_readings(), enter in 0.0f64..1.2, width in prop_oneof![0.0f64..0.1, Just(0.0), 0.0f64..3.0],
        near: bool, sigmas in -9.0f64..9.0,
    ) {
        let centre = reading.min(laser.max_range_m);
        let enter = if near { (centre + sigmas * laser.range_sigma_m).max(0.0) } else { enter * laser.max_range_m };
        let expected = averaged(&laser, reading, enter, enter + width);
        let found = likelihood(&laser, reading, enter, enter + width);
        prop_assert!((found - expected).abs() <= 1e-7 * expected + 1e-17, "{found} {expected}");
    }

    /// Echoes and no echo, of a surface at any range, at the sensor and out of reach too.
    #[test]
    fn readings_add_up_to_one(laser in lasers(), share in 0.0f64..1.5, width in 0.0f64..0.3) {
        let enter = share * laser.max_range_m;
        let at = |reading: f64| likelihood(&laser, reading, enter, enter + width);
        // Simpson's rule, finely where the surface is.
        let integral = |from: f64, until: f64, parts: u32| {
            let at = |k: f64| at(from + (until - from) * k / f64::from(parts));
            let simpson = |k: f64| at(k) + 4.0 * at(k + 0.5) + at(k + 1.0);
            (0..parts).map(|k| simpson(f64::from(k))).sum::<f64>() * (until - from) / (6.0 * f64::from(parts))
        };
        let [low, high] = [enter - 9.0 * laser.range_sigma_m, enter + width + 9.0 * laser.range_sigma_m]
            .map(|edge| edge.clamp(0.0, laser.max_range_m));
        let echoes = integral(0.0, low, 1000) + integral(low, high, 4000) + integral(high, laser.max_range_m, 1000);
        let sum = echoes + at(NOTHING);
        prop_assert!((sum - 1.0).abs() < 1e-8, "{sum}");
    }

    /// From there on it is one value, to the bit, and just before it is not yet.
    #[test]
    fn settles_where_it_says((laser, reading) in lasers_and_readings(), further in 0.0f64..100.0) {
        let from = laser.constant_from(reading, 0.0);
        let there = from * (1.0 + 1e-9) + further;
        let settled = likelihood(&laser, reading, 1e6, 1e6);
        prop_assert_eq!(likelihood(&laser, reading, there, there + 0.05).to_bits(), settled.to_bits());
        let before = reading.min(laser.max_range_m) + 4.0 * laser.range_sigma_m;
        // Where hardly a beam gets through, the surface is beyond the last digit.
        prop_assume!(laser.early_per_m * before < 9.0);
        prop_assert!(before < from && likelihood(&laser, reading, before, before).to_bits() != settled.to_bits());
    }

    #[test]
    fn is_steady_where_it_says((laser, reading) in lasers_and_readings(), a in 0.0f64..1.0, b in 0.0f64..1.0, c in 0.0f64..1.0) {
        let [from, until] = laser.constant_between(reading, 0.0);
        let within = |share: f64| from + share * (until - from) * (1.0 - 1e-12);
        if from < until {
            let level = likelihood(&laser, reading, within(a), within(a));
            let chord = likelihood(&laser, reading, within(b.min(c)), within(b.max(c)));
            prop_assert!((chord - level).abs() <= 1e-10 * level, "{level} {chord}");
        }
        let after = reading.min(laser.max_range_m) - 4.0 * laser.range_sigma_m;
        let floor = likelihood(&laser, reading, from, from);
        // Where hardly a beam gets through, the surface is beyond the last digit.
        prop_assume!(laser.early_per_m * after < 9.0);
        prop_assert!(after < from || (after > until && likelihood(&laser, reading, after, after) > floor));
    }

    #[test]
    fn the_bin_is_the_integral_of_the_density(
        laser in lasers(), share in 0.0f64..1.0, half_width in 0.01f64..2.0, sigmas in -12.0f64..12.0, width in 0.0f64..0.3,
    ) {
        let reading = share * laser.max_range_m;
        let enter = (reading + sigmas * laser.range_sigma_m).max(0.0);
        let floor = laser.outlier() / laser.max_range_m;
        let density = |o: f64| (likelihood(&laser, o, enter, enter + width) - floor) / laser.hit;
        let [low, high] = [(reading - half_width).max(0.0), reading + half_width];
        let at = |k: f64| density(low + (high - low) * k / 4000.0);
        let sum: f64 = (0..4000).map(f64::from).map(|k| at(k) + 4.0 * at(k + 0.5) + at(k + 1.0)).sum();
        let bin = laser.bin_probability(reading, half_width, 0.0, enter, enter + width);
        prop_assert!((sum * (high - low) / 24_000.0 - bin).abs() < 1e-6, "{} {bin}", sum * (high - low) / 24_000.0);
    }

    /// Correct and false matches together are all there is: Eqs. (21) and (23).
    #[test]
    fn no_echo_is_an_event_of_the_conventional_rule(laser in lasers(), share in 0.0f64..1.5, width in 0.0f64..0.3, w in 0.01f64..1.0) {
        let enter = share * laser.max_range_m;
        let correct = laser.hit * laser.bin_probability(NOTHING, w, 0.0, enter, enter + width);
        let lost = (1.0 - laser.hit) * laser.false_match_probability(NOTHING, w);
        prop_assert!((correct + lost - likelihood(&laser, NOTHING, enter, enter + width)).abs() < 1e-12);
        let outlier = (1.0 - laser.hit) * laser.false_match_probability(1.0, 0.5);
        prop_assert!((outlier - laser.outlier() / laser.max_range_m).abs() < 1e-12);
        let expected = if enter + width <= laser.max_range_m { Placement::Nearer } else { Placement::Behind };
        prop_assert_eq!(laser.placement(NOTHING, w, 0.0, enter, enter + width), expected);
    }

    #[test]
    fn what_is_clear_or_behind_needs_no_asking(
        (laser, reading) in lasers_and_readings(), w in 0.01f64..2.0, share in 0.0f64..1.0, part in 0.0f64..1.0,
    ) {
        let clear_m = laser.clear_until(reading, w, 0.0);
        let near_m = if reading.is_finite() { reading - w } else { laser.max_range_m };
        prop_assert!(clear_m >= near_m - 8.6 * laser.range_sigma_m, "{clear_m}: all that could be");
        if clear_m > 0.0 {
            let enter = share * clear_m;
            let exit = enter + part * (clear_m - enter);
            prop_assert_eq!(laser.placement(reading, w, 0.0, enter, exit), Placement::Nearer);
            prop_assert_eq!(laser.bin_probability(reading, w, 0.0, enter, exit).to_bits(), 0.0f64.to_bits());
        }
        let behind_m = laser.behind_from(reading, w, 0.0);
        let from = behind_m * (1.0 + 1e-12) + share;
        prop_assert_eq!(laser.placement(reading, w, 0.0, from, from + part), Placement::Behind);
        let end_m = if reading.is_finite() { reading + w } else { laser.max_range_m };
        prop_assert!(behind_m <= end_m * (1.0 + 1e-8), "{behind_m}: no farther than need be");
    }

    #[test]
    fn lanes_are_the_rays_one_by_one(
        laser in lasers(), share in prop::array::uniform8(prop_oneof![4 => 0.0f64..1.0, 1 => Just(NOTHING)]),
        first in prop::array::uniform8(-1.0f64..1.0), step in prop_oneof![0.001f64..0.3, Just(0.0), Just(1e-6), Just(9.0)],
    ) {
        let beams = Beams { reading: share.map(|share| share * laser.max_range_m), bearing_rad: [0.3; LANES] };
        // Some begin at the sensor, the others next to the reading.
        let ranges: Vec<Lanes<f64>> = (0..100)
            .map(|k| std::array::from_fn(|l| {
                let centre = beams.reading[l].min(laser.max_range_m);
                let begin = if l % 3 == 0 { 0.0 } else { (centre + 20.0 * first[l] * step).max(0.0) };
                begin + step * f64::from(k)
            }))
            .collect();
        let mut expected = vec![[0.0; LANES]; 99];
        one_by_one(&laser, &beams, &ranges, &mut expected);
        let mut found = vec![[0.0; LANES]; 99];
        laser.likelihood_lanes(&beams, &ranges, &mut found);
        for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
            for l in 0..LANES {
                let error = (found[l] - expected[l]).abs();
                prop_assert!(error <= 5e-6 * expected[l], "chord {k} lane {l}: {} {}", found[l], expected[l]);
            }
        }
    }
}
