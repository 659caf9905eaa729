//! The table of speeds.

use grid::GridSpec;
use score::Better::{Higher, Lower};
use serde_json::json;

use super::measure::Speed;
use super::scans::Visited;
use super::world::Known;
use crate::output::table::{Table, aligned, optional, rounded};
use crate::worlds::ranked::{Head, SortOption, legend};

/// What was mapped, on what.
#[derive(Debug, Clone)]
pub struct Conditions {
    /// Where the scans are from.
    pub source: String,
    /// Number of scans.
    pub scans: usize,
    /// What their rays ask of every mapper.
    pub visited: Visited,
    /// The cells of the maps.
    pub grid: GridSpec,
    /// Times that every mapper mapped them.
    pub repeats: u32,
    /// What mappers knew of the world before.
    pub world: Known,
    /// Name of the processor.
    pub processor: String,
}

/// Nanoseconds per cell visited.
fn ns_per_cell(seconds: f64, visited: &Visited) -> f64 {
    1e9 * seconds / visited.cells as f64
}

/// One row per mapper, in the order asked for. `cells_updated` is null of a mapper that does not count. Where programs take part,
/// `process_s` is the time in the process of one in its last repeat, and `error` why one has no times.
pub fn table(speeds: &[Speed], conditions: &Conditions) -> Table {
    let Conditions { scans, visited, grid, .. } = conditions;
    let best = Speed::best_s;
    let table = Table::of(
        speeds,
        &[
            ("mapper", &|speed| json!(speed.mapper)),
            ("cells_visited", &|_| json!(visited.cells)),
            ("ns_per_cell", &|speed| rounded(ns_per_cell(best(speed), visited))),
            ("rays_per_s", &|speed| rounded(visited.rays as f64 / best(speed))),
            ("scans_per_s", &|speed| rounded(*scans as f64 / best(speed))),
            ("bytes_per_cell", &|speed| rounded(speed.work.bytes as f64 / grid.cells() as f64)),
            ("cells_updated", &|speed| json!(Some(speed.work.cells).filter(|cells| *cells > 0))),
            ("cells_skipped", &|speed| json!(speed.skipped)),
            ("ns_per_cell_median", &|speed| rounded(ns_per_cell(speed.median_s(), visited))),
            ("scans", &|_| json!(scans)),
            ("rays", &|_| json!(visited.rays)),
            ("map_cells", &|_| json!(grid.cells())),
            ("cell_m", &|_| json!(grid.cell_m)),
            ("repeats", &|_| json!(conditions.repeats)),
            ("world", &|_| json!(conditions.world.name())),
            ("processor", &|_| json!(conditions.processor)),
        ],
    );
    debug_assert_eq!(table.columns(), COLUMNS);
    if speeds.iter().all(|speed| speed.outside.is_none()) {
        return table;
    }
    let process = |speed: &Speed| optional(speed.outside.as_ref().map(|outside| outside.seconds));
    table.and(speeds, &[("process_s", &process), ("error", &|speed| json!(speed.fault()))])
}

/// The columns of [`table`] where no program takes part.
pub const COLUMNS: [&str; 16] = [
    "mapper",
    "cells_visited",
    "ns_per_cell",
    "rays_per_s",
    "scans_per_s",
    "bytes_per_cell",
    "cells_updated",
    "cells_skipped",
    "ns_per_cell_median",
    "scans",
    "rays",
    "map_cells",
    "cell_m",
    "repeats",
    "world",
    "processor",
];

/// The speeds of the scans of one of several sensors, mapped without the others.
#[derive(Debug, Clone)]
pub struct Alone {
    /// What the sensor is called.
    pub sensor: String,
    /// Number of its scans, and what their rays ask of every mapper.
    pub scans: usize,
    pub visited: Visited,
    /// Every mapper, as those of all sensors.
    pub speeds: Vec<Speed>,
}

/// A row for every sensor and mapper.
pub fn by_sensor(alone: &[Alone]) -> Table {
    let rows: Vec<(&Alone, &Speed)> =
        alone.iter().flat_map(|alone| alone.speeds.iter().map(move |speed| (alone, speed))).collect();
    Table::of(
        &rows,
        &[
            ("sensor", &|(alone, _)| json!(alone.sensor)),
            ("mapper", &|(_, speed)| json!(speed.mapper)),
            ("cells_visited", &|(alone, _)| json!(alone.visited.cells)),
            ("ns_per_cell", &|(alone, speed)| rounded(ns_per_cell(speed.best_s(), &alone.visited))),
            ("rays_per_s", &|(alone, speed)| rounded(alone.visited.rays as f64 / speed.best_s())),
            ("scans_per_s", &|(alone, speed)| rounded(alone.scans as f64 / speed.best_s())),
            ("cells_updated", &|(_, speed)| json!(Some(speed.work.cells).filter(|cells| *cells > 0))),
            ("cells_skipped", &|(_, speed)| json!(speed.skipped)),
            ("ns_per_cell_median", &|(alone, speed)| rounded(ns_per_cell(speed.median_s(), &alone.visited))),
            ("scans", &|(alone, _)| json!(alone.scans)),
            ("rays", &|(alone, _)| json!(alone.visited.rays)),
        ],
    )
}

/// The same for reading: of every sensor alone, nanoseconds per cell visited and rays per second.
pub fn sensors_text(alone: &[Alone]) -> String {
    let rows = alone.iter().flat_map(|alone| {
        alone.speeds.iter().enumerate().map(move |(place, speed)| {
            let name = if place == 0 { shortened(&alone.sensor, 24) } else { String::new() };
            let [ns, rays] = match speed.seconds.is_empty() {
                true => ["-".to_owned(), "-".to_owned()],
                false => [
                    format!("{:.1}", ns_per_cell(speed.best_s(), &alone.visited)),
                    short((alone.visited.rays as f64 / speed.best_s()).round() as u64),
                ],
            };
            vec![name, speed.mapper.to_owned(), ns, rays, short(alone.visited.rays)]
        })
    });
    let rows: Vec<Vec<String>> = rows.collect();
    format!(
        "\nThe scans of each sensor without the others; of a cone, the cells along its axis\ncount as visited:\n\n{}",
        aligned(&["sensor", "mapper", "ns/cell", "rays/s", "rays"], &rows)
    )
}

/// The heads of the table for reading.
pub const HEADS: [Head; 7] = [
    Head::plain("mapper"),
    Head::of("ns/cell", "ns_per_cell", Lower),
    Head::of("median", "ns_per_cell_median", Lower),
    Head::of("rays/s", "rays_per_s", Higher),
    Head::of("scans/s", "scans_per_s", Higher),
    Head { title: "updated", name: "cells_updated", judged: None },
    Head::of("B/cell", "bytes_per_cell", Lower),
];

/// The table for reading, at most 80 columns wide.
pub fn text(speeds: &[Speed], conditions: &Conditions, order: &SortOption) -> String {
    let Conditions { source, scans, visited, grid, repeats, world, processor } = conditions;
    let rows: Vec<Vec<String>> = speeds
        .iter()
        .map(|speed| {
            let best = speed.best_s();
            if speed.seconds.is_empty() {
                return [speed.mapper].into_iter().chain(["-"; 6]).map(str::to_owned).collect();
            }
            vec![
                speed.mapper.to_owned(),
                format!("{:.1}", ns_per_cell(best, visited)),
                format!("{:.1}", ns_per_cell(speed.median_s(), visited)),
                short((visited.rays as f64 / best).round() as u64),
                short((*scans as f64 / best).round() as u64),
                if speed.work.cells == 0 { "-".to_owned() } else { short(speed.work.cells) },
                format!("{:.0}", speed.work.bytes as f64 / grid.cells() as f64),
            ]
        })
        .collect();
    let ranked = order.ranked(&HEADS, &rows);
    let times = if *repeats == 1 { "mapped once".to_owned() } else { format!("best and median of {repeats} times") };
    let leaps = speeds.iter().filter(|speed| speed.skipped > 0).map(|speed| {
        let share = 100.0 * speed.skipped as f64 / speed.work.cells as f64;
        format!("{} leapt over {share:.0} % of its cells, in settled patches.\n", speed.mapper)
    });
    let known = match world {
        Known::Mixed => "",
        Known::Settled => "All scans were mapped twice before the clock started.\n",
        Known::Unknown => "Every scan was mapped alone, on a map that knew nothing.\n",
    };
    format!(
        "speed: {}\n{} scans, {} rays with a reading, {} cells visited\nA map of {} x {} cells of {} m\n\
         One thread of {}; {times}\n{known}\n{}{}\n\
         A cell visited lies between the sensor and the end of a ray's range, both\nincluded, in four-connected steps: \
         the same number for every mapper. A mapper\nhas updated more where it goes on behind the range. B: bytes of map and \
         working\nstate, per cell of the map.\n{}",
        shortened(source, 73),
        short(*scans as u64),
        short(visited.rays),
        short(visited.cells),
        grid.width,
        grid.height,
        grid.cell_m,
        shortened(processor, 64 - times.len()),
        ranked,
        leaps.collect::<String>(),
        legend(&ranked),
    )
}

/// At most so many letters.
fn shortened(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars().take(most.saturating_sub(3)).chain("...".chars()).collect()
}

/// A whole number, or from a thousand million on, millions.
fn short(number: u64) -> String {
    if number < 1_000_000_000 { grouped(number) } else { grouped(number / 1_000_000) + "M" }
}

/// A whole number with a comma between thousands.
pub(super) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let groups = digits.as_bytes().rchunks(3).rev().map(String::from_utf8_lossy);
    groups.collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;
    use mapper::Work;
    use serde_json::Value;

    fn measured() -> (Vec<Speed>, Conditions) {
        let visited = Visited { cells: 12_345_678_901, owed: 12_345_678_900, rays: 72_000_000 };
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 5000, height: 5000 };
        let conditions = Conditions {
            source: "a-long-folder/".repeat(9),
            scans: 360_000,
            visited,
            grid,
            repeats: 1000,
            world: Known::Settled,
            processor: "Intel(R) Xeon(R) Platinum 8488C with a name that goes on".to_owned(),
        };
        let speed = |mapper, cells| Speed {
            mapper,
            seconds: vec![2.0, 3.0, 4.0],
            work: Work { cells, bytes: 25_000_000 * 72 },
            skipped: cells / 3,
            outside: None,
        };
        (vec![speed("log-odds-cartographer", 12_345_678_901), speed("mrf", 0)], conditions)
    }

    #[test]
    fn rates_are_of_the_best_repeat_and_of_the_cells_visited() {
        let (speeds, conditions) = measured();
        let rows = table(&speeds, &conditions).to_json()["rows"].clone();
        assert_eq!(rows[0]["rays_per_s"], 36e6);
        assert_eq!(rows[0]["scans_per_s"], 180e3);
        assert_eq!(rows[0]["ns_per_cell"], 0.162);
        assert_eq!(rows[0]["ns_per_cell_median"], 0.243);
        assert_eq!(rows[0]["bytes_per_cell"], 72.0);
        assert_eq!(rows[1]["cells_updated"], Value::Null);
    }

    #[test]
    fn it_fits_eighty_columns_whatever_the_numbers() {
        let (speeds, conditions) = measured();
        let text = text(&speeds, &conditions, &SortOption::default());
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
        assert!(text.contains("12,345M cells visited") && text.contains("..."), "{text}");
    }

    #[test]
    fn sensors_stand_apart_and_fit_eighty_columns() {
        let (speeds, conditions) = measured();
        let alone = |sensor: &str, cells| Alone {
            sensor: sensor.to_owned(),
            scans: 36,
            visited: Visited { cells, ..conditions.visited },
            speeds: speeds.clone(),
        };
        let all = [alone("0 stereo", 1_000_000_000), alone(&"a long name of a sensor ".repeat(9), 4_000_000_000)];
        let rows = by_sensor(&all).to_json()["rows"].clone();
        let found: Vec<_> = (0..4).map(|k| (&rows[k]["mapper"], rows[k]["ns_per_cell"].as_f64())).collect();
        let (cartographer, mrf) = (json!("log-odds-cartographer"), json!("mrf"));
        let two = [(&cartographer, Some(2.0)), (&mrf, Some(2.0)), (&cartographer, Some(0.5)), (&mrf, Some(0.5))];
        assert_eq!(found, two);
        let text = sensors_text(&all);
        assert!(text.lines().all(|line| line.chars().count() <= 80) && text.contains("0 stereo"), "{text}");
    }

    #[test]
    fn thousands_are_grouped() {
        assert_eq!([0, 999, 1000, 12_600_000].map(grouped), ["0", "999", "1,000", "12,600,000"]);
    }
}
