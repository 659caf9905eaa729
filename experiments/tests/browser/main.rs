//! The report in a real browser, opened from the file system: `cargo test --workspace --test browser -- --ignored`.

mod axe;
mod driver;

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use driver::{Browser, DOWN, ESCAPE, LEFT, RIGHT, UP};
use experiments::page::{self, Page, ViewedWorld, Viewer};
use experiments::worlds::film;
use experiments::worlds::ground::Ground;
use experiments::worlds::run::Keep;
use mapper::catalogue;
use serde_json::{Value, json};
use tempfile::TempDir;

/// Columns and rows of the closet.
const SIZE: [usize; 2] = [30, 20];

/// A folder with the results of the closet.
struct Results {
    folder: TempDir,
}

impl Results {
    fn new() -> Self {
        Self::of(include_str!("closet.toml"))
    }

    /// The results of a scene.
    fn of(text: &str) -> Self {
        let folder = tempfile::tempdir().expect("temporary folder");
        let scene = folder.path().join("closet.toml");
        fs::write(&scene, text).expect("writable");
        let mut command = Command::cargo_bin("experiments").expect("built");
        command.current_dir(folder.path()).args(["room", "--scene", "closet.toml", "--out", "o"]).assert().success();
        Self { folder }
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join("o").join(name)
    }

    fn page(&self) -> PathBuf {
        self.file("report.html")
    }

    fn npy(&self, name: &str) -> Vec<f32> {
        let bytes = fs::read(self.file(name)).expect("readable");
        // Format 1.0: magic, version, length of the header, header, float32.
        let header = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        bytes[10 + header..].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
    }

    /// Value of every metric by mapper, stage, region and name.
    fn metrics(&self) -> HashMap<[String; 4], Option<f64>> {
        let mut csv = csv::Reader::from_path(self.file("metrics.csv")).expect("readable");
        let rows = csv.records().map(|row| row.expect("a row"));
        rows.map(|row| ([2, 3, 4, 5].map(|i| row[i].to_owned()), row[6].parse().ok())).collect()
    }

    fn ground(&self) -> Ground {
        let scene = scene::Scene::load(&self.folder.path().join("closet.toml"), None).expect("valid");
        Ground::new(scene, 0.1).expect("a free route")
    }
}

/// Something that tells any two pictures apart.
fn pixels(browser: &Browser, canvas: &str) -> String {
    browser.get(&format!("document.getElementById('{canvas}').toDataURL()")).to_string()
}

fn close(a: f64, b: f64, bound: f64) -> bool {
    (a - b).abs() <= bound
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn it_opens_without_an_error_or_a_request_and_is_small() {
    let results = Results::new();
    let browser = Browser::start();
    // What the browser does on its own account when it starts is not the page's.
    browser.post("/url", &json!({ "url": "about:blank" }));
    browser.notes("performance");
    browser.open(&results.page(), "");
    for view in ["truth", "error", "looks"] {
        browser.click(&format!("input[value={view}]"));
    }
    browser.choose("mapper", "conventional");
    let complaints = browser.notes("browser");
    assert!(complaints.is_empty(), "{complaints:?}");
    let mut opened = 0;
    for note in browser.notes("performance") {
        let event: Value = serde_json::from_str(note["message"].as_str().unwrap_or_default()).expect("JSON");
        if event["message"]["method"] == "Network.requestWillBeSent" {
            let url = event["message"]["params"]["request"]["url"].as_str().unwrap_or_default().to_owned();
            opened += usize::from(url.starts_with("file:") && url.contains("report.html"));
            assert!(["file:", "data:", "blob:"].iter().any(|local| url.starts_with(local)), "{url}");
        }
    }
    assert!(opened > 0, "the page itself is noted, so others would be");
    assert!(fs::metadata(results.page()).expect("there").len() < 3_000_000);
    assert_eq!(browser.get("document.getElementById('viewer').hidden"), json!(false));
}

/// Somebody who walks along the far wall of the closet.
const WALKER: &str =
    "[[mover]]\nradius = 0.15\nroute = [[0.7, 1.65], [2.4, 1.65]]\nspeed_m_s = 0.4\nrepeat = \"back_and_forth\"\n";

#[test]
#[ignore = "needs chromium and chromedriver"]
fn what_moves_is_drawn_where_it_is_and_true_there() {
    let results = Results::of(&(include_str!("closet.toml").to_owned() + WALKER));
    let browser = Browser::start();
    browser.open(&results.page(), "");
    let legend = browser.get("document.getElementById('viewer-legend').textContent").to_string();
    assert!(legend.contains("what moves, where it is now"), "{legend}");
    // Place of the walker, and the truth of the cell under it.
    let walker = "(() => {
        const [x, y] = shown.ground.things[chosen.moment][0], { origin_m, cell_m, width } = shown.world;
        const [column, row] = [(x - origin_m[0]) / cell_m, (y - origin_m[1]) / cell_m].map(Math.floor);
        return [x, y, shown.ground.truth[row * width + column]];
    })()";
    let to = |moment: usize| {
        browser.get(&format!(
            "(() => {{ const slider = document.getElementById('viewer-time'); slider.value = {moment};
                slider.dispatchEvent(new Event('input')); return chosen.moment; }})()"
        ))
    };
    let mut former = None;
    for moment in [0, 5, 10] {
        assert_eq!(to(moment), json!(moment));
        let at = browser.get(walker);
        assert_eq!(at[2], json!(1), "somebody stands there: {at}");
        let now = (at[0].to_string(), pixels(&browser, "viewer-first"));
        assert!(
            former.replace(now.clone()).is_none_or(|former: (String, String)| former.0 != now.0 && former.1 != now.1)
        );
    }
    assert!(browser.notes("browser").is_empty());
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn its_metrics_are_those_of_the_tables() {
    let results = Results::new();
    let metrics = results.metrics();
    let browser = Browser::start();
    browser.open(&results.page(), "");
    let read = "Object.fromEntries([...document.querySelectorAll('#viewer-metrics tbody tr')].map((row) =>
        [row.dataset.metric, [row.querySelector('td').textContent, row.querySelector('td').dataset.own]]))";
    let mut compared = 0;
    for (stage, name) in ["there", "back"].iter().enumerate() {
        browser.click(&format!("#viewer-stages button:nth-child({})", stage + 1));
        assert_eq!(
            browser.get("document.querySelector('#viewer-stages [aria-pressed=true]').textContent.split(':')[0]"),
            *name
        );
        for mapper in ["visibility", "visibility-printed", "conventional"] {
            browser.choose("mapper", mapper);
            for region in ["observable", "X", "visible", "surface", "shell", "hidden", "all"] {
                browser.choose("region", region);
                let shown = browser.get(read);
                assert_eq!(shown.as_object().map(serde_json::Map::len), Some(15), "{shown}");
                for (metric, cell) in shown.as_object().expect("rows") {
                    let key = [mapper, name, region, metric].map(str::to_owned);
                    let value = metrics[&key];
                    let text = value.map_or_else(|| "–".to_owned(), |v| format!("{v:.4}"));
                    assert_eq!(cell[0], text, "{key:?}");
                    // What the page shows between the stages, where it is as good as the tables or is not shown.
                    let own: Option<f64> = cell[1].as_str().and_then(|own| own.parse().ok());
                    match metric.as_str() {
                        "ece" | "auc" => assert_eq!(own, None, "{key:?}"),
                        _ => {
                            let agrees = match (own, value) {
                                (Some(own), Some(value)) => close(own, value, 1e-5 * value.max(1.0)),
                                (own, value) => own.is_none() && value.is_none(),
                            };
                            assert!(agrees, "{key:?}: {own:?} on the page, {value:?} in the table");
                            compared += 1;
                        }
                    }
                }
            }
        }
    }
    assert_eq!(compared, 2 * 3 * 7 * 13);
}

/// Reads out the cell under the cursor: column, row, truth, rays, and p of the map on the left.
fn readout(browser: &Browser) -> (String, String, u32, f64) {
    let p = browser.text("#viewer-values tr:first-child td").parse().expect("a probability");
    let rays = browser.text("#viewer-rays").parse().expect("a number");
    (browser.text("#viewer-index"), browser.text("#viewer-truth"), rays, p)
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn the_readout_of_a_cell_is_what_the_files_hold() {
    let results = Results::new();
    let ground = results.ground();
    let truth = results.npy("truth.npy");
    let browser = Browser::start();
    browser.open(&results.page(), "");
    browser.choose("mapper", "conventional");
    for (stage, (name, scans)) in ground.drive.stage_ends.iter().enumerate() {
        browser.click(&format!("#viewer-stages button:nth-child({})", stage + 1));
        let map = results.npy(&format!("conventional-{name}.npy"));
        let looks = looks(&ground, *scans);
        let spread: Vec<usize> = (0..12).map(|k| (k * 53 + 31) % (SIZE[0] * SIZE[1])).collect();
        for cell in spread {
            let [column, row] = [cell % SIZE[0], cell / SIZE[0]];
            browser.post("/execute/sync", &json!({"script": "document.getElementById('viewer-left').scrollIntoView({block: 'center'})", "args": []}));
            let size = browser.get("(({width, height}) => [width, height])(document.getElementById('viewer-left').getBoundingClientRect())");
            let [width, height] = [0, 1].map(|i| size[i].as_f64().expect("px"));
            let x = (column as f64 + 0.5) / SIZE[0] as f64 * width - width / 2.0;
            let y = height / 2.0 - (row as f64 + 0.5) / SIZE[1] as f64 * height;
            browser.hover("#viewer-left", x as i64, y as i64);
            let (index, said, rays, p) = readout(&browser);
            assert_eq!(index, format!("{column}, {row}"));
            assert_eq!(said, if truth[cell] > 0.5 { "occupied" } else { "free" });
            assert_eq!(rays, looks[cell], "cell {cell} at {name}");
            // The file has no number where no ray has looked; the page says what is scored there.
            let file = f64::from(map[cell]);
            assert_eq!(file.is_nan(), rays == 0, "cell {cell} at {name}: {file}");
            assert!(file.is_nan() || close(p, file, 3.5e-4), "cell {cell}: {p} on the page, {file} in the file");
            assert_eq!(browser.text("#viewer-x"), format!("{:.3} m", (column as f64 + 0.5) * 0.1));
        }
    }
}

/// How many rays looked at each cell in the first scans, without the report's help.
fn looks(ground: &Ground, scans: usize) -> Vec<u32> {
    let mut seen = score::Sightings::new(&ground.truth);
    for timed in &ground.drive.poses[..scans] {
        for bearing in ground.scene.camera.bearings_rad() {
            let (origin_m, direction) = (timed.pose.position_m(), timed.pose.direction(bearing));
            let range_m = ground.world.cast(origin_m, direction).map(|hit| hit.range_m);
            seen.add(&score::Sight { origin_m, direction, range_m });
        }
    }
    seen.looks().values().to_vec()
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn the_keyboard_moves_time_and_the_cell() {
    let results = Results::new();
    let browser = Browser::start();
    browser.open(&results.page(), "");
    let (end, last) = (browser.text("#viewer-moment"), pixels(&browser, "viewer-left"));
    browser.press("#viewer-time", LEFT);
    browser.press("#viewer-time", LEFT);
    assert_ne!(browser.text("#viewer-moment"), end);
    assert_ne!(pixels(&browser, "viewer-left"), last, "an earlier map is another map");
    browser.press("#viewer-time", &RIGHT.repeat(2));
    assert_eq!((browser.text("#viewer-moment"), pixels(&browser, "viewer-left")), (end.clone(), last.clone()));

    browser.press("#viewer-time", "[");
    assert_eq!(browser.get("document.querySelector('#viewer-stages [aria-pressed=true]').textContent"), "there: at B");
    browser.press("#viewer-time", ",");
    assert_eq!(browser.get("document.querySelector('#viewer-stages [aria-pressed=true]')"), Value::Null);
    browser.press("#viewer-time", "]]");
    assert_eq!(browser.text("#viewer-moment"), end);

    // At the end, play begins anew, and stops at the end by itself; a second press pauses.
    browser.press("#viewer-time", " ");
    browser.wait("document.getElementById('viewer-play').getAttribute('aria-pressed') === 'true'");
    browser.wait("document.getElementById('viewer-time').value === '2'");
    browser.press("#viewer-time", " ");
    assert_eq!(browser.get("document.getElementById('viewer-play').getAttribute('aria-pressed')"), "false");
    browser.press("#viewer-time", "]]");

    // The cursor starts in the middle.
    browser.press("#viewer-left", RIGHT);
    assert_eq!(browser.text("#viewer-index"), "15, 10");
    browser.press("#viewer-left", &[RIGHT, UP, UP, LEFT, LEFT, DOWN].concat());
    assert_eq!(browser.text("#viewer-index"), "14, 11");
    assert!(
        browser.text("#viewer-said").starts_with("Column 14, row 11: visibility 0."),
        "{}",
        browser.text("#viewer-said")
    );
    browser.press("#viewer-left", &RIGHT.repeat(40));
    assert_eq!(browser.text("#viewer-index"), "29, 11", "it stays on the map");
    browser.press("#viewer-left", ESCAPE);
    assert_eq!(browser.text("#viewer-index"), "–");

    // Zoomed to the region X around 1.2, 1.0 m, the middle of the map is the middle of X; the cell moves the part shown.
    browser.choose("region", "X");
    browser.press("#viewer-left", "z");
    assert_eq!(browser.get("document.getElementById('viewer-zoom').getAttribute('aria-pressed')"), "true");
    browser.hover("#viewer-left", 0, 0);
    let middle: Vec<f64> =
        ["x", "y"].map(|axis| browser.text(&format!("#viewer-{axis}"))[..5].parse().expect("m")).to_vec();
    assert!(close(middle[0], 1.2, 0.35) && close(middle[1], 1.0, 0.35), "{middle:?}");
    let near = pixels(&browser, "viewer-left");
    browser.press("#viewer-left", &RIGHT.repeat(12));
    assert_ne!(pixels(&browser, "viewer-left"), near);
    browser.click("#viewer-zoom");
    assert_eq!(browser.get("document.getElementById('viewer-zoom').getAttribute('aria-pressed')"), "false");

    browser.press("#viewer-left", "3");
    assert_eq!(browser.get("document.querySelector('input[value=error]').checked"), json!(true));
    // Everything that can be operated is reached by Tab and has a name.
    let nameless = browser.get(
        "[...document.querySelectorAll('#viewer :is(select, input, button, canvas)')].filter((e) => e.tabIndex < 0 ||
            !(e.ariaLabel || e.labels?.length || e.textContent.trim())).length",
    );
    assert_eq!(nameless, 0);
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn views_and_regions_change_the_picture_and_the_address_keeps_them() {
    let results = Results::new();
    let browser = Browser::start();
    browser.open(&results.page(), "");
    let mut seen = vec![pixels(&browser, "viewer-left")];
    for view in ["truth", "error"] {
        browser.click(&format!("input[value={view}]"));
        let now = pixels(&browser, "viewer-left");
        assert!(!seen.contains(&now), "{view} looks like another view");
        seen.push(now);
    }
    let truth = pixels(&browser, "viewer-first");
    browser.click("input[value=looks]");
    assert_ne!(pixels(&browser, "viewer-first"), truth, "looks stand where the truth stood");
    assert_eq!(pixels(&browser, "viewer-left"), seen[0], "the maps stay beside them");
    browser.click("input[value=error]");
    for region in ["X", "hidden", "all"] {
        browser.choose("region", region);
        let now = pixels(&browser, "viewer-left");
        assert!(!seen.contains(&now), "{region} looks like another region");
        seen.push(now);
    }
    browser.choose("mapper", "conventional");
    let now = pixels(&browser, "viewer-left");
    assert!(!seen.contains(&now), "another mapper has another map");
    let address = browser.get("location.hash");
    browser.post("/url", &json!({ "url": "about:blank" }));
    browser.open(&results.page(), address.as_str().expect("text"));
    assert_eq!(browser.get("document.getElementById('viewer-mapper').value"), "conventional");
    assert_eq!(pixels(&browser, "viewer-left"), now);
}

/// Red, green and blue in the middle of every cell of the map on the left, in index order.
fn colours(browser: &Browser) -> Vec<[i64; 3]> {
    let [width, height] = SIZE;
    let script = format!(
        "(() => {{ const map = document.getElementById('viewer-left'), all = map.getContext('2d').getImageData(0, 0, map.width, map.height).data;
            return [...Array({width} * {height}).keys()].map((cell) => {{
                const x = Math.floor((cell % {width} + 0.5) * map.width / {width});
                const y = map.height - 1 - Math.floor((Math.floor(cell / {width}) + 0.5) * map.height / {height});
                return [...all.slice(4 * (y * map.width + x), 4 * (y * map.width + x) + 3)];
            }}); }})()"
    );
    serde_json::from_value(browser.get(&script)).expect("three numbers per cell")
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn colours_say_what_the_files_hold() {
    let results = Results::new();
    let (truth, map) = (results.npy("truth.npy"), results.npy("conventional-back.npy"));
    let browser = Browser::start();
    browser.open(&results.page(), "");
    browser.choose("mapper", "conventional");
    browser.choose("region", "all");
    browser.click("#viewer-scan");
    // Lines are drawn over the way of the robot and around X, and a bar in the corner: other cells are free of them.
    let clear = |cell: &usize| {
        let (column, row) = (cell % SIZE[0], cell / SIZE[0]);
        !(6..15).contains(&row) && (row >= 3 || column >= 12)
    };
    let cells: Vec<usize> = (0..SIZE[0] * SIZE[1]).filter(clear).collect();
    let mut checked = [0; 5];
    let mut check = |what: usize, holds: bool, cell: usize| {
        checked[what] += 1;
        assert!(holds, "case {what}, cell {cell}: p {}, truth {}", map[cell], truth[cell]);
    };
    let grey = colours(&browser);
    browser.click("input[value=truth]");
    let overlay = colours(&browser);
    browser.click("input[value=error]");
    let error = colours(&browser);
    for &cell in &cells {
        let [red, _, blue] = error[cell];
        match map[cell] {
            p if p > 0.95 => check(0, grey[cell][0] < 80, cell),
            p if p < 0.02 => check(1, grey[cell][0] > 235, cell),
            _ => {}
        }
        match map[cell] - truth[cell] {
            e if e > 0.3 => check(2, red > blue + 30, cell),
            e if e < -0.3 => check(3, blue > red + 30, cell),
            _ => {}
        }
        check(4, (overlay[cell][2] > overlay[cell][0] + 50) == (truth[cell] > 0.5), cell);
    }
    assert!(checked.iter().all(|count| *count > 5), "every case occurs: {checked:?}");
}

/// Contrast of text with what is behind it (WCAG 2.2), the least over the page.
const LEAST_CONTRAST: &str = "(() => {
    const rgb = (text) => text.match(/[\\d.]+/g).map(Number);
    const light = (c) => c.slice(0, 3).map((v) => v / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
        .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
    const behind = (e) => { for (; e; e = e.parentElement) { const c = rgb(getComputedStyle(e).backgroundColor); if (c[3] !== 0) return c; } return [255, 255, 255]; };
    let least = 99;
    for (const e of document.querySelectorAll('h1, h2, h3, p, td, th, label, button, select, figcaption, legend, dt, dd, summary, pre, output, .faint')) {
        if (!e.getClientRects().length) continue;
        const [a, b] = [light(rgb(getComputedStyle(e).color)), light(behind(e))].sort((x, y) => y - x);
        least = Math.min(least, (a + 0.05) / (b + 0.05));
    }
    return least;
})()";

#[test]
#[ignore = "needs chromium and chromedriver"]
fn text_is_readable_in_light_and_in_dark_and_nothing_overflows_a_telephone() {
    let results = Results::new();
    let browser = Browser::start();
    let mut papers = Vec::new();
    for scheme in ["light", "dark"] {
        let media = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        browser.devtools("Emulation.setEmulatedMedia", &media);
        browser.open(&results.page(), "");
        let least = browser.get(LEAST_CONTRAST).as_f64().expect("a number");
        assert!(least >= 4.5, "{scheme}: contrast {least}");
        papers.push(browser.get("getComputedStyle(document.body).backgroundColor"));
    }
    assert_ne!(papers[0], papers[1]);
    for width in [1280, 420] {
        let size = json!({ "width": width, "height": 900, "deviceScaleFactor": 2, "mobile": width < 600 });
        browser.devtools("Emulation.setDeviceMetricsOverride", &size);
        browser.open(&results.page(), "");
        assert_eq!(browser.get("document.documentElement.scrollWidth <= innerWidth"), json!(true), "{width} px");
        assert_eq!(browser.get("innerWidth"), width);
    }
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn without_scripts_pictures_and_tables_remain() {
    let results = Results::new();
    let browser = Browser::start();
    browser.devtools("Emulation.setScriptExecutionDisabled", &json!({ "value": true }));
    browser.post("/url", &json!({ "url": format!("file://{}", results.page().display()) }));
    let state = browser.get(
        "[document.getElementById('viewer').getClientRects().length, document.querySelectorAll('figure img').length,
        document.querySelectorAll('details table').length]",
    );
    assert_eq!(state, json!([0, 4, 14]));
}

/// Two scenes, and a mapper that has a map at the ends of stages only.
fn two_worlds(results: &Results, folder: &Path) -> PathBuf {
    let ground = results.ground();
    let moments = page::moments(&ground, page::FRAMES);
    let setup = mapper::Model::new(ground.scene.grid, std::sync::Arc::new(ground.scene.matcher.stereo));
    let entries: Vec<_> = ["visibility", "conventional"].iter().filter_map(|name| catalogue::find(name)).collect();
    let keep = Keep { timeline: false, frames: moments.clone() };
    let worlds = [1, 2].map(|seed| {
        let trial = ground.trial(seed, &entries, &setup, &keep, &|_, _| ()).expect("maps");
        let stage = |s: &scene::Stage| experiments::worlds::run::Stage {
            name: s.name.clone(),
            label: s.name.clone(),
            scans: s.scans,
        };
        let stages: Vec<_> = trial.simulation.stages.iter().map(stage).collect();
        let mut world = ViewedWorld::new(&ground, &trial, &stages, &moments).expect("of this ground");
        assert_eq!(world.moments.last().and_then(|moment| moment.parts.clone()), Some(film::parts(&trial.seen)));
        world.name = format!("closet <{seed}>");
        world.mappers[1].frames.retain(|frame| stages.iter().any(|stage| stage.scans == frame.scans));
        world
    });
    let page = Page {
        title: "Two".to_owned(),
        viewer: Some(Viewer { worlds: worlds.to_vec(), budget: page::WORLDS_BYTES }),
        ..Page::default()
    };
    let path = folder.join("two.html");
    fs::write(&path, page::page(&page).expect("rendered")).expect("writable");
    path
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn another_scene_is_picked_and_a_batch_map_says_when_it_was_solved() {
    let results = Results::new();
    let browser = Browser::start();
    browser.open(&two_worlds(&results, results.folder.path()), "");
    assert_eq!(browser.get("document.getElementById('viewer-scene').options.length"), 2);
    let first = pixels(&browser, "viewer-left");
    browser.choose("scene", "closet <2>");
    assert_ne!(pixels(&browser, "viewer-left"), first);
    assert_eq!(browser.get("document.getElementById('viewer-mapper').value"), "visibility");

    let caption = || browser.text("figure:has(#viewer-right) figcaption");
    let there = results.ground().drive.stage_ends[0].1;
    browser.press("#viewer-time", "[");
    assert_eq!(caption(), format!("conventional: as solved after scan {there}"));
    let solved = pixels(&browser, "viewer-right");
    browser.press("#viewer-time", ",");
    assert_eq!(caption(), "conventional: solved at the ends of stages, none yet");
    browser.press("#viewer-left", RIGHT);
    assert_eq!(browser.text("#viewer-values tr:last-child td"), "≈ 0.10", "until then it is the prior");
    assert_ne!(pixels(&browser, "viewer-right"), solved);
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn the_scan_is_drawn_and_the_curves_hang_on_the_slider() {
    let results = Results::new();
    let browser = Browser::start();
    browser.open(&results.page(), "");
    let [truth, left] = ["viewer-first", "viewer-left"].map(|canvas| pixels(&browser, canvas));
    browser.click("#viewer-scan");
    assert_ne!(pixels(&browser, "viewer-first"), truth, "rays and readings are drawn in the truth");
    assert_ne!(pixels(&browser, "viewer-left"), left, "readings are drawn in the maps");
    let drawn = |selector: &str| browser.get(&format!("document.querySelector('{selector}').getAttribute('d')"));
    let strip = drawn("#viewer-strip .reading");
    let now = drawn("#viewer-curve-log_loss .now");
    assert_ne!(drawn("#viewer-curve-log_loss .line.left"), drawn("#viewer-curve-log_loss .line.right"));
    assert!(drawn("#viewer-curve-retention .line.left").as_str().is_some_and(|d| d.len() > 100));
    browser.press("#viewer-time", ",,,");
    assert_ne!(drawn("#viewer-strip .reading"), strip, "every scan has its own readings");
    assert_ne!(drawn("#viewer-curve-log_loss .now"), now);
    assert!(browser.text("#viewer-strip-said").contains("median residual"), "{}", browser.text("#viewer-strip-said"));
    // A click in the middle of a curve goes to the middle of the drive.
    browser.click("#viewer-curve-log_loss");
    let scans = results.ground().scans();
    let value =
        browser.get("Number(document.getElementById('viewer-time').value)").as_u64().expect("a number") as usize;
    assert!(value.abs_diff(scans / 2) <= scans / 8, "{value} of {scans}");
    assert_eq!(browser.get("Number(document.getElementById('viewer-time').max)"), json!(scans - 1));
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn nothing_jumps_while_one_steps_and_points() {
    let results = Results::new();
    let browser = Browser::start();
    browser.open(&results.page(), "");
    let places = "[...document.querySelectorAll('#viewer :is(canvas, svg, h3, button, table, dl, #viewer-legend)')].map((e) =>
        (({ left, top, width, height }) => [left, top, width, height])(e.getBoundingClientRect()).map(Math.round).join()).join(' ')";
    let before = browser.get(places);
    for key in [",", ",", "[", "[", ".", "]"] {
        browser.press("#viewer-time", key);
        assert_eq!(browser.get(places), before, "after {key}");
    }
    browser.press("#viewer-left", RIGHT);
    assert_eq!(browser.get(places), before, "with a cell pointed at");
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn keys_work_from_the_start_and_wheel_and_drag_move_the_part_shown() {
    let results = Results::new();
    let browser = Browser::start();
    browser.open(&results.page(), "");
    let moment = || browser.text("#viewer-moment");
    let end = moment();
    for (key, back) in [(",", "."), (LEFT, RIGHT)] {
        browser.type_keys(key);
        assert_ne!(moment(), end, "nothing has the focus yet");
        browser.type_keys(back);
        assert_eq!(moment(), end);
    }
    let whole = pixels(&browser, "viewer-right");
    let turn = |by: i32| {
        browser.get(&format!(
            "(() => {{ const map = document.getElementById('viewer-left'), {{ left, top }} = map.getBoundingClientRect();
            return map.dispatchEvent(new WheelEvent('wheel', {{ deltaY: {by}, clientX: left + 40, clientY: top + 40, cancelable: true }})); }})()"
        ))
    };
    assert_eq!(turn(300), json!(true), "outwards from the whole map the page scrolls");
    assert_eq!(turn(-600), json!(false));
    let near = pixels(&browser, "viewer-right");
    assert_ne!(near, whole, "all maps show the same part");
    browser.drag("#viewer-left", [0, 0], [-60, 30]);
    assert_ne!(pixels(&browser, "viewer-right"), near);
    let address = browser.get("location.hash");
    browser.type_keys("0");
    browser.type_keys(ESCAPE);
    assert_eq!(pixels(&browser, "viewer-right"), whole);
    browser.post("/url", &json!({ "url": "about:blank" }));
    browser.open(&results.page(), address.as_str().expect("text"));
    assert_eq!(browser.get("document.getElementById('viewer-zoom').getAttribute('aria-pressed')"), "true");
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn tables_are_sorted_by_their_heads_and_files_are_links() {
    let results = Results::new();
    let browser = Browser::start();
    browser.open(&results.page(), "");
    let sheet = "document.querySelector('details[open] table.sheet')";
    let column = format!("[...{sheet}.tBodies[0].rows].map((row) => Number(row.cells[1].textContent))");
    browser.click("details[open] table.sheet th:nth-child(2) button");
    let rising: Vec<f64> = serde_json::from_value(browser.get(&column)).expect("numbers");
    assert!(rising.is_sorted() && rising.len() > 1 && rising[0] < rising[rising.len() - 1], "{rising:?}");
    browser.click("details[open] table.sheet th:nth-child(2) button");
    let falling: Vec<f64> = serde_json::from_value(browser.get(&column)).expect("numbers");
    assert!(falling.iter().rev().is_sorted());
    assert_eq!(browser.get(&format!("{sheet}.tHead.rows[0].cells[1].getAttribute('aria-sort')")), "descending");
    let about = browser.get(&format!("{sheet}.tHead.rows[0].cells[1].querySelector('button').title"));
    assert!(about.as_str().is_some_and(|about| about.contains("ln p(truth)")), "{about}");
    let links = browser.get("[...document.querySelectorAll('.files a')].map((a) => a.getAttribute('href'))");
    let links: Vec<String> = serde_json::from_value(links).expect("names");
    assert!(links.len() > 10 && links.iter().all(|name| results.file(name).is_file()), "{links:?}");
    assert_eq!(
        browser.text(".command").split(' ').take(4).collect::<Vec<_>>(),
        ["sightgrid", "room", "--scene", "closet.toml"]
    );
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn the_chosen_view_is_marked_where_colours_are_forced() {
    let results = Results::new();
    let browser = Browser::start();
    let media = json!({ "features": [{ "name": "forced-colors", "value": "active" }] });
    browser.devtools("Emulation.setEmulatedMedia", &media);
    browser.open(&results.page(), "");
    let ground =
        |what: &str| browser.get(&format!("getComputedStyle(document.querySelector('{what}')).backgroundColor"));
    assert_ne!(ground(".views label:has(:checked)"), ground(".views label:has(:not(:checked))"));
    assert_ne!(ground("#viewer-stages [aria-pressed=true]"), ground("#viewer-stages [aria-pressed=false]"));
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn axe_finds_nothing() {
    let Some(axe) = axe::source() else { return };
    let results = Results::new();
    let browser = Browser::start();
    let media = |features: Value| browser.devtools("Emulation.setEmulatedMedia", &json!({ "features": features }));
    for (mode, width, features) in [
        ("light", 1280, json!([{ "name": "prefers-color-scheme", "value": "light" }])),
        ("dark", 1280, json!([{ "name": "prefers-color-scheme", "value": "dark" }])),
        ("telephone", 390, json!([{ "name": "prefers-color-scheme", "value": "light" }])),
        ("forced colours", 1280, json!([{ "name": "forced-colors", "value": "active" }])),
    ] {
        media(features);
        let size = json!({ "width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600 });
        browser.devtools("Emulation.setDeviceMetricsOverride", &size);
        for page in [results.page(), two_worlds(&results, results.folder.path())] {
            browser.open(&page, "");
            let found = browser.findings(&axe);
            assert!(found.is_empty(), "{mode}: {found:#?}");
        }
    }
}
