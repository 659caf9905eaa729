//! The schemas of the sensors beside the camera, and of what they see.

use ::scene::reader::limits::{
    ALL_ROUND, ANGLE, BEAMS, EARLY, EVERY, FIELD_OF_VIEW, GRAZING, INVERSE_SIGMA, MOUNT, PROBABILITY, RANGE,
    RANGE_SIGMA, SHARE, WIDTH,
};
use sensor::SensorKind;
use serde_json::{Value, json};

use super::{list, name, number, table, whole};

/// What one kind of sensor has of its own.
fn own(kind: SensorKind, noise: &[(&'static str, Value)]) -> Vec<(&'static str, Value)> {
    let echo = || {
        vec![
            ("range_sigma", number("Standard deviation of the range of a surface", &RANGE_SIGMA)),
            ("max_range", number("Largest range measured", &RANGE)),
            ("hit", number("Probability that a pulse comes back from the first thing in its way", &PROBABILITY)),
            ("no_echo", number("Probability that a pulse is lost", &PROBABILITY)),
            ("early_per_m", number("Things on no map that stand in a metre of beam", &EARLY)),
        ]
    };
    match kind {
        SensorKind::Laser => [vec![("beams", whole("Number of beams", &BEAMS))], echo()].concat(),
        SensorKind::Sonar => {
            let cones = [
                ("cones", whole("Number of cones", &BEAMS)),
                ("width_deg", number("Angle between the edges of a cone", &WIDTH)),
            ];
            [cones.to_vec(), echo()].concat()
        }
        SensorKind::Stereo => [&[("columns", whole("Number of columns", &BEAMS))], noise].concat(),
        SensorKind::Depth => vec![
            ("columns", whole("Number of columns", &BEAMS)),
            ("inverse_sigma_per_m", number("Standard deviation of the inverse range", &INVERSE_SIGMA)),
            ("max_range", number("Largest range measured", &RANGE)),
            ("hit", number("Probability that a reading is of the first surface", &PROBABILITY)),
            ("detection_rate", number("Share of the columns that give a reading", &PROBABILITY)),
            ("grazing_deg", number("Least angle between a ray and a surface that is seen", &GRAZING)),
        ],
    }
}

/// `sensor`: the camera's noise, or a list of sensors beside the camera.
pub(super) fn sensor(noise: &[(&'static str, Value)]) -> Value {
    let of_kind = |kind: SensorKind| {
        let view = if kind == SensorKind::Depth { &FIELD_OF_VIEW } else { &ALL_ROUND };
        let common = [
            ("kind", json!({ "const": kind.name() })),
            ("name", name("Its name, another one than those of the others", 32)),
            ("x", number("Its place on the robot, ahead of the middle", &MOUNT)),
            ("y", number("Its place on the robot, to the left of the middle", &MOUNT)),
            ("yaw_deg", number("Where it looks, counter-clockwise from ahead", &ANGLE)),
            ("field_of_view_deg", number("Field of view", view)),
            ("every", whole("It reads at every so manyth scan of the drive", &EVERY)),
        ];
        let about = format!("A sensor of the kind {}", kind.name());
        table(&about, &[&common[..], &own(kind, noise)].concat(), &["kind"])
    };
    let kinds = SensorKind::ALL.map(of_kind).to_vec();
    let mut several = list("Sensors beside the camera", json!({ "oneOf": kinds }), 0);
    several["maxItems"] = json!(64);
    json!({ "anyOf": [table("The camera's noise, unless it stands in [camera]", noise, &[]), several] })
}

/// Shares of the readings that end on an obstacle.
pub(super) fn seen_by() -> (&'static str, Value) {
    let share = |kind: SensorKind| (kind.name(), number("Share of the readings that end on it", &SHARE));
    let about = "How many of the readings of each kind of sensor end on it; the others pass through";
    ("seen_by", table(about, &SensorKind::ALL.map(share), &[]))
}
