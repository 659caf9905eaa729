//! How far odometry is off, as a user says it.

use sensor::OdometryNoise;

/// The four standard deviations of the motion model, as a value parser of clap: rad per rad turned, rad per m, m per m, m per rad.
pub(crate) fn noise(text: &str) -> Result<OdometryNoise, String> {
    let bound = "must be four numbers, 0 or more, such as 0.056,0.017,0.1,0.01";
    let parts: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    match parts.unwrap_or_default()[..] {
        [rad_per_rad, rad_per_m, m_per_m, m_per_rad] => {
            let noise = OdometryNoise { rad_per_rad, rad_per_m, m_per_m, m_per_rad };
            noise.check().map(|()| noise).map_err(|error| format!("{bound}: {error}"))
        }
        _ => Err(bound.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_numbers_that_are_not_below_0_are_a_noise() {
        assert!(noise("0,0,0,0").is_ok_and(|noise| noise == OdometryNoise::NONE));
        assert!(["1,2,3", "1,2,3,-1", "1,2,3,NaN", ""].iter().all(|text| noise(text).is_err()));
    }
}
