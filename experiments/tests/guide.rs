//! README and guide: short enough to be read, no link leads nowhere, and what is quoted from `results/` is what stands there.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Most lines, and most columns, of the front page.
const FRONT: [usize; 2] = [120, 120];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The Markdown of a folder.
fn pages(folder: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join(folder)).expect("a folder").map(|entry| entry.expect("readable").path());
    let mut pages: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|e| e == "md")).collect();
    pages.sort();
    pages
}

/// Everything that is written for people.
fn documents() -> Vec<PathBuf> {
    let crates = fs::read_dir(root().join("crates")).expect("a folder").map(|entry| entry.expect("readable").path());
    let readmes = crates.map(|folder| folder.join("README.md")).filter(|path| path.exists());
    ["README.md", "scenes/README.md", "scenes/logs/README.md", "scenes/maps/README.md", "experiments/MAPPERS.md"]
        .map(|name| root().join(name))
        .into_iter()
        .chain(pages("experiments/guide"))
        .chain(readmes)
        .collect()
}

/// A document without its code blocks and code spans.
fn prose(text: &str) -> String {
    let (mut prose, mut fenced) = (String::new(), false);
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !fenced && !line.starts_with("    ") {
            // Between the backquotes every second piece is code.
            line.split('`').step_by(2).for_each(|piece| prose.push_str(piece));
            prose.push('\n');
        }
    }
    prose
}

/// The targets of links and pictures, and those that stand on a line of their own, as `[name]: target`.
fn links(prose: &str) -> Vec<String> {
    let after = prose.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    let named = prose.lines().filter_map(|line| line.strip_prefix('[')?.split_once("]: "));
    after.map(|(target, _)| target).chain(named.map(|(_, target)| target)).map(str::to_owned).collect()
}

/// The anchors of a document, as GitHub and mdBook make them of headings.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut fenced = false;
    let mut heads = Vec::new();
    for line in text.lines() {
        fenced ^= line.starts_with("```");
        heads.extend((!fenced && line.starts_with('#')).then(|| line.trim_start_matches('#').trim()));
    }
    let letter = |c: char| match c {
        ' ' => Some('-'),
        c if c.is_alphanumeric() || c == '-' || c == '_' => Some(c),
        _ => None,
    };
    heads.iter().map(|head| head.to_lowercase().chars().filter_map(letter).collect()).collect()
}

#[test]
fn the_front_page_is_short() {
    let text = read(&root().join("README.md"));
    assert!(text.lines().count() <= FRONT[0], "{} lines", text.lines().count());
    for (number, line) in text.lines().enumerate() {
        assert!(line.chars().count() <= FRONT[1], "README.md:{}: {} columns", number + 1, line.chars().count());
    }
}

/// Tables and pictures are lines of their own, whatever their length.
#[test]
fn no_line_of_the_guide_is_too_long() {
    for page in pages("experiments/guide") {
        for (number, line) in read(&page).lines().enumerate() {
            let whole = line.starts_with('|') || line.starts_with("![") || line.chars().count() <= FRONT[1];
            assert!(whole, "{}:{}: {} columns", page.display(), number + 1, line.chars().count());
        }
    }
}

/// What the guide shows of the example is what the example says, which is tested.
#[test]
fn the_sensor_of_the_guide_is_that_of_the_example() {
    let page = read(&root().join("experiments/guide/own-sensor.md"));
    let example = read(&root().join("crates/mapper/examples/own_sensor.rs"));
    let lines: Vec<&str> = example.lines().map(str::trim).collect();
    let code: Vec<&str> = page.lines().filter(|line| line.starts_with("    ")).map(str::trim).collect();
    assert!(code.len() > 20, "{}", code.len());
    code.iter().for_each(|line| assert!(lines.contains(line), "{line}"));
}

#[test]
fn no_link_leads_nowhere() {
    let mut checked = 0;
    for document in documents() {
        let text = read(&document);
        for link in links(&prose(&text)).iter().filter(|link| !link.contains("://")) {
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => document.clone(),
                file => document.parent().expect("a folder").join(file),
            };
            assert!(target.exists(), "{}: nothing is at {link}", document.display());
            if !anchor.is_empty() {
                assert!(anchors(&read(&target)).contains(anchor), "{}: no heading for {link}", document.display());
            }
            checked += 1;
        }
    }
    assert!(checked > 60, "{checked}");
}

#[test]
fn the_summary_names_every_page_once() {
    let summary = links(&prose(&read(&root().join("experiments/guide/SUMMARY.md"))));
    let pages = pages("experiments/guide").into_iter().filter_map(|path| Some(path.file_name()?.to_str()?.to_owned()));
    let pages: BTreeSet<String> = pages.filter(|name| name != "SUMMARY.md").collect();
    assert_eq!(summary.len(), pages.len());
    assert_eq!(summary.into_iter().collect::<BTreeSet<_>>(), pages);
}

/// The mean of a metric over the 120 worlds, as the committed scores have it.
fn mean(mapper: &str, region: &str, metric: &str, decimals: usize) -> String {
    mean_of("compare", 100, mapper, (region, metric), decimals)
}

/// The mean of a metric over the worlds of a comparison, of which more than so many have it.
fn mean_of(folder: &str, worlds: usize, mapper: &str, (region, metric): (&str, &str), decimals: usize) -> String {
    let path = root().join(format!("results/{folder}/scores-{mapper}.csv"));
    let mut table = csv::Reader::from_path(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let heads = table.headers().expect("heads").clone();
    let column = |name: &str| heads.iter().position(|head| head == name).expect("a column");
    let (at, value) = (column("region"), column(metric));
    let rows = table.records().map(|row| row.expect("a row")).filter(|row| &row[at] == region);
    let values: Vec<f64> = rows.filter_map(|row| row[value].parse().ok()).collect();
    assert!(values.len() > worlds, "{mapper} {metric}: {}", values.len());
    format!("{:.decimals$}", values.iter().sum::<f64>() / values.len() as f64)
}

/// The rows of a table that follows a heading row, as cells.
fn table(text: &str, heads: &str) -> Vec<Vec<String>> {
    let rows =
        text.lines().skip_while(|line| !line.starts_with(heads)).skip(2).take_while(|line| line.starts_with('|'));
    rows.map(|row| row.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()).collect()
}

/// The name in backquotes that a cell begins with.
fn name(cell: &str) -> &str {
    cell.split('`').nth(1).expect("a name in backquotes")
}

#[test]
fn the_numbers_of_the_front_page_are_those_of_the_committed_results() {
    let rows = table(&read(&root().join("README.md")), "| rule | log loss |");
    assert_eq!(rows.len(), 6);
    let columns = [
        ("observable", "log_loss", 3),
        ("observable", "phantom_area", 2),
        ("observable", "missed_area", 2),
        ("observable", "retention", 3),
        ("all", "footprint_reached", 3),
        ("all", "footprint_colliding", 3),
    ];
    for row in rows {
        let expected = columns.map(|(region, metric, decimals)| mean(name(&row[0]), region, metric, decimals));
        assert_eq!(row[1..], expected, "{}", row[0]);
    }
}

#[test]
fn the_numbers_of_the_guide_are_those_of_the_committed_results() {
    let compare = table(&read(&root().join("experiments/guide/compare.md")), "| mapper | log loss |");
    let means = compare.iter().filter(|row| !row[1].is_empty() && !row[0].contains("`prior`"));
    let mut checked = 0;
    for row in means {
        let [loss, brier] =
            [("log_loss", 3), ("brier", 4)].map(|(m, decimals)| mean(name(&row[0]), "observable", m, decimals));
        assert_eq!([&row[1], &row[3]], [&loss, &brier], "{}", row[0]);
        assert!(row[5].starts_with(&mean(name(&row[0]), "observable", "retention", 3)), "{row:?}");
        checked += 1;
    }
    assert!(checked >= 15, "{checked}");
    let drives =
        table(&read(&root().join("experiments/guide/drives.md")), "| mapper | reached | colliding | by footprint");
    assert_eq!(drives.len(), 7);
    for row in drives {
        let metrics = ["reached", "colliding", "footprint_reached", "footprint_colliding"];
        assert_eq!(row[1..], metrics.map(|metric| mean(name(&row[0]), "all", metric, 3)), "{}", row[0]);
    }
}

#[test]
fn the_worlds_that_move_of_the_guide_are_those_of_the_committed_comparison() {
    let page = read(&root().join("experiments/guide/moving.md"));
    let people = table(&page, "| mapper | log loss | static |");
    assert_eq!(people.len(), 7);
    let columns = [
        (("observable", "log_loss"), 3),
        (("static", "static_accuracy"), 3),
        (("swept", "dynamic_accuracy"), 3),
        (("swept", "harmonic_accuracy"), 3),
        (("swept", "trail_area"), 2),
        (("changed", "lag_looks"), 1),
    ];
    for row in people {
        let of = |(column, decimals)| mean_of("compare-people", 29, name(&row[0]), column, decimals);
        assert_eq!(row[1..], columns.map(of), "{}", row[0]);
    }
    let path = root().join("results/compare/repeats.csv");
    let mut repeats = csv::Reader::from_path(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let heads = repeats.headers().expect("heads").clone();
    let column = |name: &str| heads.iter().position(|head| head == name).expect("a column");
    let at = ["readings", "mapper", "repeats", "log_loss"].map(column);
    let records: Vec<csv::StringRecord> = repeats.records().map(|row| row.expect("a row")).collect();
    let standing = table(&page, "| readings | mapper | 1 |");
    assert_eq!(standing.len(), 6);
    for row in standing {
        let mean = |repeats: &str| {
            let asked = [row[0].as_str(), name(&row[1]), repeats];
            let rows = records.iter().filter(|r| (0..3).all(|k| &r[at[k]] == asked[k]));
            let losses: Vec<f64> = rows.map(|r| r[at[3]].parse().expect("a number")).collect();
            format!("{:.3}", losses.iter().sum::<f64>() / losses.len() as f64)
        };
        assert_eq!(row[2..], ["1", "10", "100", "1000"].map(mean), "{} {}", row[0], row[1]);
    }
}

/// Wrong poses: means over the worlds of the committed sweep, of maps as they are and aligned.
#[test]
fn the_wrong_poses_of_the_guide_are_those_of_the_committed_sweep() {
    let page = read(&root().join("experiments/guide/poses.md"));
    let mut sweep = csv::Reader::from_path(root().join("results/sweep-poses/table.csv")).expect("committed");
    let heads = sweep.headers().expect("heads").clone();
    let column = |name: &str| heads.iter().position(|head| head == name).expect("a column");
    let at = ["mapper", "region", "pose_sigma_m", "pose_drift"].map(column);
    let records: Vec<csv::StringRecord> = sweep.records().map(|row| row.expect("a row")).collect();
    let errors = [("0.0", "0.0"), ("0.02", "0.0"), ("0.05", "0.0"), ("0.1", "0.0"), ("0.0", "0.5"), ("0.0", "1.0")];
    for metric in ["log_loss", "retention"] {
        let rows = table(&page, &format!("| {}: as it is, aligned |", metric.replace('_', " ")));
        assert_eq!(rows.len(), 10, "{metric}");
        for row in rows {
            let mean = |region: &str, (sigma, drift): (&str, &str)| {
                let asked = [name(&row[0]), region, sigma, drift];
                let here = records.iter().filter(|record| (0..4).all(|k| &record[at[k]] == asked[k]));
                let values: Vec<f64> = here.map(|r| r[column(metric)].parse().expect("a number")).collect();
                assert_eq!(values.len(), 6, "{asked:?}");
                format!("{:.3}", values.iter().sum::<f64>() / values.len() as f64)
            };
            let both = errors.map(|error| format!("{}, {}", mean("observable", error), mean("aligned", error)));
            assert_eq!(row[1..], both, "{metric} {}", row[0]);
        }
    }
}

/// The cut of the range: means over the seeds of the committed sweep.
#[test]
fn the_range_cut_of_the_guide_is_that_of_the_committed_sweep() {
    let text = read(&root().join("experiments/guide/compare.md"));
    let rows = table(&text, "| readings used |");
    assert_eq!(rows.len(), 5);
    let mappers = ["visibility", "visibility-lateral", "conventional", "log-odds-octomap", "log-odds-cartographer"];
    let mut sweep = csv::Reader::from_path(root().join("results/sweep-range-cut/table.csv")).expect("committed");
    let heads = sweep.headers().expect("heads").clone();
    let column = |name: &str| heads.iter().position(|head| head == name).expect("a column");
    let [range, mapper, region, loss] = ["max_range", "mapper", "region", "log_loss"].map(column);
    let table: Vec<csv::StringRecord> = sweep.records().map(|row| row.expect("a row")).collect();
    for row in rows {
        let up_to: f64 = row[0].split(' ').find_map(|word| word.parse().ok()).unwrap_or(1000.0);
        for (cell, own) in row[1..].iter().zip(mappers) {
            let here = |row: &&csv::StringRecord| {
                row[range].parse().is_ok_and(|range: f64| (range - up_to).abs() < 1e-9)
                    && &row[mapper] == own
                    && &row[region] == "observable"
            };
            let values: Vec<f64> = table.iter().filter(here).map(|row| row[loss].parse().expect("a number")).collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            assert_eq!(values.len(), 4);
            assert_eq!(cell, &format!("{mean:.3}"), "{own} {}", row[0]);
        }
    }
}

/// The numbers in a text that stand in a column of the committed table of a sweep, as means over its rows.
fn sweep_mean(sweep: &str, metric: &str, wanted: &[(&str, &str)]) -> f64 {
    let path = root().join(format!("results/sweep-{sweep}/table.csv"));
    let mut table = csv::Reader::from_path(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let heads = table.headers().expect("heads").clone();
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap_or_else(|| panic!("no column {name}"));
    let (of, at) = (column(metric), wanted.iter().map(|(name, _)| column(name)).collect::<Vec<_>>());
    let rows = table.records().map(|row| row.expect("a row"));
    let rows = rows.filter(|row| at.iter().zip(wanted).all(|(at, (_, value))| &row[*at] == *value));
    let values: Vec<f64> = rows.map(|row| row[of].parse().expect("a number")).collect();
    assert!(!values.is_empty(), "{sweep}: {wanted:?}");
    values.iter().sum::<f64>() / values.len() as f64
}

/// Cell size and correlation: log loss, and the geometric mean of the probability that free cells are free.
#[test]
fn the_cell_sizes_of_the_guide_are_those_of_the_committed_sweep() {
    let page = read(&root().join("experiments/guide/sweep.md")).split_whitespace().collect::<Vec<_>>().join(" ");
    let cells = ["0.025", "0.05", "0.1", "0.2"];
    let mean = |law: &str, grid: &str, region: &str| {
        let wanted = [("correlation_law", law), ("grid", grid), ("region", region), ("correlation", "0.871")];
        sweep_mean("cell-size", "log_loss", &[&wanted[..], &[("mapper", "visibility")]].concat())
    };
    let free = |law: &str, grid: &str| format!("{:.3}", (-mean(law, grid, "visible")).exp());
    let all = |of: &dyn Fn(&str) -> String| cells.map(of).join(", ");
    assert!(page.contains(&all(&|grid| free("scaled", grid))), "{}", all(&|grid| free("scaled", grid)));
    let loss = |grid: &str| format!("{:.3}", mean("scaled", grid, "observable"));
    assert!(page.contains(&all(&loss)), "{}", all(&loss));
    let fixed = format!("from {} to {}", free("fixed", cells[0]), free("fixed", cells[3]));
    assert!(page.contains(&fixed), "{fixed}");
}

#[test]
fn the_drives_of_the_guide_are_those_of_the_committed_room() {
    let rows =
        table(&read(&root().join("experiments/guide/drives.md")), "| mapper | reached | colliding | recall > 0.5");
    let metrics = read(&root().join("results/room/metrics.csv"));
    let value = |mapper: &str, region: &str, metric: &str| {
        let start = format!("room,1,{mapper},c,{region},{metric},");
        let line = metrics.lines().find(|line| line.starts_with(&start))?;
        line[start.len()..].split(',').next()?.parse::<f64>().ok().map(|value| format!("{value:.3}"))
    };
    let mut checked = 0;
    for row in rows {
        // The room maps with four rules; those of the table that are not among them were measured beside it.
        let columns = [("all", "reached"), ("all", "colliding"), ("all", "recall_50")];
        let Some(expected) = columns.iter().map(|(region, metric)| value(name(&row[0]), region, metric)).collect()
        else {
            continue;
        };
        let expected: Vec<String> = expected;
        assert_eq!(row[1..], expected, "{}", row[0]);
        checked += 1;
    }
    assert!(checked >= 3, "{checked}");
}

#[test]
fn the_density_of_the_guide_is_that_of_the_committed_sensor() {
    let page = read(&root().join("experiments/guide/sensor.md"));
    let mut density = csv::Reader::from_path(root().join("results/sensor/density.csv")).expect("committed");
    let rows: Vec<csv::StringRecord> = density.records().map(|row| row.expect("a row")).collect();
    let at = |disparity: f64| {
        let row = rows.iter().find(|row| row[0].parse().is_ok_and(|read: f64| (read - disparity).abs() < 1e-9));
        row.expect("a row")[1].parse::<f64>().expect("a number")
    };
    for number in [format!("{:.4} per px", at(10.0)), format!("{:.4} per px", at(40.0))] {
        assert!(page.contains(&number), "{number}");
    }
}
