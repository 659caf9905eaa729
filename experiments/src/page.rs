//! The report: one HTML page that needs nothing else.
//!
//! A [`Page`] is a plain value: claims, a [`Viewer`] of the maps, and sections of tables and pictures.
//! Every command that leaves a report fills one in and hands it to [`page`].

pub mod cloud;
mod command;
mod encoding;
mod folder;
mod glossary;
pub mod kept;
mod part;
pub mod scans;
mod viewer;

use std::collections::BTreeSet;

use askama::Template;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;

pub use cloud::Cloud;
pub use command::command_line;
pub use encoding::{DecodedMapper, DecodedWorld, decoded};
pub use folder::Folder;
pub use part::{Cell, Part, Picture, Section, Sheet, Tone};
pub use viewer::{FRAMES, Mapped, Moment, ViewedWorld, Viewer, every_moment, moments};

use self::glossary::Term;
use crate::failure::Failure;
use crate::worlds::claims::Claim;

/// Most that the maps of a [`Viewer`] may add to the page of one world, bytes: with pictures and tables it is to stay below
/// 3 MB. What would be larger shows fewer moments, with a note.
pub const WORLD_BYTES: usize = 2_300_000;

/// The same of the page of several worlds, which is to stay below 10 MB.
pub const WORLDS_BYTES: usize = 7_000_000;

/// Everything a page shows.
#[derive(Debug, Default)]
pub struct Page {
    /// What the page is about: its heading, and its title in the browser.
    pub title: String,
    /// A sentence or two.
    pub lead: String,
    /// Seeds, scans, cells: a line that steps back.
    pub facts: String,
    /// What was found, in a sentence or two, where a page is to begin with it.
    pub answer: Vec<String>,
    /// What was claimed and found; empty if nothing was.
    pub claims: Vec<Claim>,
    /// Maps to look into.
    pub viewer: Option<Viewer>,
    /// The same as [`viewed`] gives it, of a page that has no viewer of its own.
    pub viewed: Option<String>,
    /// Particles to follow.
    pub cloud: Option<Cloud>,
    /// Pictures and tables.
    pub sections: Vec<Section>,
    /// What to type to run it again; empty where that is not known.
    pub command: String,
    /// What the numbers were made from, as text.
    pub configuration: String,
    /// Names of the files beside the page.
    pub files: Vec<String>,
}

/// Sorts tables.
const TABLES: &str = include_str!("../templates/tables.js");

/// How every page looks.
const STYLE: &str = include_str!("../templates/report.css");

/// What following particles looks like besides.
const CLOUD_STYLE: &str = include_str!("../templates/cloud.css");

/// Follows particles.
const CLOUD: &str = include_str!("../templates/cloud.js");

/// Looks into maps ...
const VIEWER: &str = concat!(
    include_str!("../templates/viewer/decode.js"),
    include_str!("../templates/viewer/world.js"),
    include_str!("../templates/viewer/scan.js"),
    include_str!("../templates/viewer/metrics.js"),
    include_str!("../templates/viewer/colours.js"),
    include_str!("../templates/viewer/paint.js"),
    include_str!("../templates/viewer/view.js"),
    include_str!("../templates/viewer/curve.js"),
    include_str!("../templates/viewer/choices.js"),
    include_str!("../templates/viewer/show.js"),
);

/// ... with several sensors, of pages that have them alone, so that others stay the same to the byte ...
const SENSORS: &str = concat!(
    include_str!("../templates/viewer/sensors.js"),
    include_str!("../templates/viewer/cones.js"),
    include_str!("../templates/viewer/switches.js"),
);

/// ... and starts.
const CONTROLS: &str = include_str!("../templates/viewer/controls.js");

/// The script of a viewer with these worlds.
fn script(viewer: &str) -> String {
    let several = if encoding::has_sensors(viewer) { SENSORS } else { "" };
    [VIEWER, several, CONTROLS].concat()
}

#[derive(Template)]
#[template(path = "report.html")]
struct Filled<'a> {
    page: &'a Page,
    style: String,
    script: String,
    viewer: Option<String>,
    cloud: Option<String>,
    glossary: Vec<Term>,
    version: &'static str,
    left_out: bool,
    failed: usize,
}

impl Filled<'_> {
    fn base64(&self, bytes: &[u8]) -> String {
        BASE64_STANDARD.encode(bytes)
    }

    /// What the head of a column means, if it is a metric.
    fn about(&self, head: &str) -> Option<&str> {
        let metric = glossary::metric_of(head);
        Some(self.glossary.iter().find(|term| term.is_of(&metric))?.formula.as_str())
    }
}

/// The metrics that the page has columns, rows or a viewer of.
fn spoken_of(page: &Page) -> Vec<Term> {
    let sheets = page.sections.iter().flat_map(|section| &section.parts).flat_map(|part| match part {
        Part::Picture(_) => &[],
        Part::Sheet(sheet) => std::slice::from_ref(sheet),
        Part::Fold { parts, .. } => parts.as_slice(),
    });
    let heads = sheets.flat_map(|sheet| &sheet.heads).map(|head| glossary::metric_of(head));
    let viewed = page.viewer.iter().flat_map(|viewer| &viewer.worlds).flat_map(|world| &world.metrics);
    let names: BTreeSet<String> = heads.chain(viewed.map(|(name, _)| name.clone())).collect();
    glossary::terms().into_iter().filter(|term| term.names.iter().any(|name| names.contains(name))).collect()
}

/// A viewer as text that can be kept in a file; nothing of one that does not fit its budget.
pub fn viewed(viewer: &Viewer) -> Option<String> {
    encoding::json(viewer)
}

/// Renders the page. The same page gives the same bytes.
///
/// # Errors
/// A template that cannot be filled.
pub fn page(page: &Page) -> Result<String, Failure> {
    let viewer = page.viewer.as_ref().map_or_else(|| page.viewed.clone(), viewed);
    let filled = Filled {
        left_out: page.viewer.is_some() && viewer.is_none(),
        failed: page.claims.iter().filter(|claim| !claim.holds).count(),
        page,
        style: [STYLE, page.cloud.as_ref().map_or("", |_| CLOUD_STYLE)].concat(),
        script: [TABLES, &viewer.as_deref().map(script).unwrap_or_default(), page.cloud.as_ref().map_or("", |_| CLOUD)]
            .concat(),
        glossary: spoken_of(page),
        version: env!("CARGO_PKG_VERSION"),
        viewer,
        cloud: page.cloud.as_ref().map(Cloud::json),
    };
    filled.render().map_err(Failure::internal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_come_in_order_verdicts_have_a_class_and_text_is_escaped() {
        let verdict = |text: &str, tone| Cell::toned(text, tone);
        let sheet = || Sheet {
            caption: "Against <visibility>".to_owned(),
            heads: vec!["mapper".to_owned(), "verdict".to_owned()],
            rows: vec![
                vec!["conventional".into(), verdict("worse", Tone::Bad)],
                vec!["a & b".into(), verdict("equivalent", Tone::Even)],
            ],
            ..Sheet::default()
        };
        let picture = Picture { name: "p.png".to_owned(), caption: "Lines".to_owned(), bytes: vec![1, 2, 3] };
        let claim = |claim: &str, holds| Claim { claim: claim.to_owned(), measured: "1 against 2".to_owned(), holds };
        let filled = Page {
            title: "Comparison".to_owned(),
            claims: vec![claim("first", true), claim("second", false)],
            sections: vec![Section {
                heading: "Results".to_owned(),
                lead: "Read it so.".to_owned(),
                parts: vec![
                    Part::Sheet(sheet()),
                    Part::Picture(picture),
                    Part::Fold { summary: "More".to_owned(), open: false, parts: vec![sheet()] },
                ],
            }],
            ..Page::default()
        };
        let html = page(&filled).expect("rendered");
        let mut rest = html.as_str();
        for expected in [
            "<span class=\"bad\">1 of 2 claims fail</span>",
            "<td class=\"bad\">fails</td>",
            "<h2 id=\"results\">Results</h2>",
            "Read it so.",
            "Against &#60;visibility&#62;",
            "<td class=\"bad\">worse</td>",
            "a &#38; b",
            "<td class=\"even\">equivalent</td>",
            "data:image/png;base64,AQID",
            "<details><summary>More</summary>",
            "<td class=\"bad\">worse</td>",
        ] {
            let at = rest.find(expected).unwrap_or_else(|| panic!("{expected} is missing or out of order"));
            rest = &rest[at + expected.len()..];
        }
        assert!(!html.contains("viewer-data"), "without maps there is nothing to look into");
    }
}
