//! Cells, sensors and prior in JSON, for programs.

use mapper::Model;
use sensor::{Parameters, SensorModel};
use serde_json::{Value, json};

/// Version of all messages. It is raised when a reader of the former ones would be wrong, not when keys are added.
pub(super) const SCHEMA_VERSION: u32 = 1;

/// The cells: `grid.json`.
pub(super) fn grid(model: &Model) -> Value {
    let grid = model.grid;
    json!({
        "schema_version": SCHEMA_VERSION,
        "cell_m": grid.cell_m,
        "origin_m": grid.origin_m,
        "width": grid.width,
        "height": grid.height,
    })
}

/// The sensors in the order of their numbers, each with what is assumed before its first reading: `sensors.json`.
pub(super) fn sensors(model: &Model) -> Value {
    let prior = json!({
        "occupancy": model.prior.occupancy,
        "correlation": model.prior.correlation,
        "correlation_law": model.prior.correlation_law,
        "neighbour_correlation": model.prior.neighbour_correlation(model.grid.cell_m),
    });
    let sensor = |(number, sensor): (usize, &std::sync::Arc<dyn SensorModel>)| {
        let (kernel, noise): (Value, Value) = match sensor.parameters() {
            Some(Parameters { kernel, noise, .. }) => {
                let noise: serde_json::Map<_, _> =
                    noise.iter().map(|(key, value)| ((*key).to_owned(), json!(value))).collect();
                (json!(kernel), Value::Object(noise))
            }
            None => (Value::Null, Value::Null),
        };
        json!({
            "schema_version": SCHEMA_VERSION,
            "sensor": number,
            "kernel": kernel,
            "reading": reading(&**sensor),
            "noise": noise,
            "prior": prior,
        })
    };
    model.sensors.iter().enumerate().map(sensor).collect()
}

/// What the readings of a sensor are called, with their unit.
pub(super) fn reading(sensor: &dyn SensorModel) -> &'static str {
    sensor.parameters().map_or("reading", |parameters| parameters.reading)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use grid::GridSpec;
    use mapper::Sensors;
    use sensor::{Laser, Stereo};

    use super::*;

    #[test]
    fn what_a_program_is_told() {
        let cells = GridSpec { cell_m: 0.1, origin_m: [-1.0, 2.5], width: 30, height: 20 };
        let mut model = Model::new(cells, Arc::new(Stereo::default()));
        model.sensors = Sensors::new(vec![Arc::new(Stereo::default()), Arc::new(Laser::default())]);
        let expected = r#"{"schema_version":1,"cell_m":0.1,"origin_m":[-1.0,2.5],"width":30,"height":20}"#;
        assert_eq!(grid(&model), serde_json::from_str::<Value>(expected).expect("JSON"));
        let told = sensors(&model);
        let of = |number: usize, key: &str| &told[number][key];
        assert_eq!((of(0, "kernel"), of(0, "reading")), (&json!("stereo"), &json!("disparity_px")));
        assert_eq!((of(1, "kernel"), of(1, "reading")), (&json!("laser"), &json!("range_m")));
        assert_eq!(of(0, "noise")["focal_baseline"], json!(15.0));
        assert_eq!(of(1, "noise")["max_range_m"], json!(80.0));
        assert_eq!(of(1, "prior")["occupancy"], json!(0.1));
        // 0.871 over 5 cm is its square over 10 cm.
        let neighbours = of(0, "prior")["neighbour_correlation"].as_f64().expect("a number");
        assert!((neighbours - 0.871 * 0.871).abs() < 1e-12, "{neighbours}");
    }
}
