//! The report: one HTML page that needs nothing else.
//!
//! A [`Page`] is a plain value: claims, a [`Viewer`] of the maps, and sections of tables and pictures.
//! Every command that leaves a report fills one in and hands it to [`page`].

mod encoding;
mod folder;
pub mod kept;
mod part;
mod viewer;

use askama::Template;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;

pub use folder::Folder;
pub use part::{Cell, Part, Picture, Section, Sheet, Tone};
pub use viewer::{FRAMES, Mapped, Moment, ViewedWorld, Viewer, moments};

use crate::failure::Failure;
use crate::worlds::claims::Claim;

/// Most that the maps of a [`Viewer`] may add to a page, bytes: a page is to stay below 10 MB, and
/// pictures and tables need room too. What would be larger shows fewer moments, with a note.
pub const VIEWER_BYTES: usize = 7_000_000;

/// Everything a page shows.
#[derive(Debug, Default)]
pub struct Page {
    /// What the page is about: its heading, and its title in the browser.
    pub title: String,
    /// A sentence or two.
    pub lead: String,
    /// Seeds, scans, cells: a line that steps back.
    pub facts: String,
    /// What was claimed and found; empty if nothing was.
    pub claims: Vec<Claim>,
    /// Maps to look into.
    pub viewer: Option<Viewer>,
    /// Pictures and tables.
    pub sections: Vec<Section>,
    /// What the numbers were made from, as text.
    pub configuration: String,
    /// Names of the files beside the page.
    pub files: Vec<String>,
}

#[derive(Template)]
#[template(path = "report.html")]
struct Filled<'a> {
    page: &'a Page,
    style: &'static str,
    script: &'static str,
    viewer: Option<String>,
    left_out: bool,
    failed: usize,
}

impl Filled<'_> {
    fn base64(&self, bytes: &[u8]) -> String {
        BASE64_STANDARD.encode(bytes)
    }
}

/// Renders the page. The same page gives the same bytes.
///
/// # Errors
/// A template that cannot be filled.
pub fn page(page: &Page) -> Result<String, Failure> {
    let viewer = page.viewer.as_ref().and_then(|viewer| encoding::json(viewer, VIEWER_BYTES));
    let filled = Filled {
        left_out: page.viewer.is_some() && viewer.is_none(),
        failed: page.claims.iter().filter(|claim| !claim.holds).count(),
        page,
        style: include_str!("../templates/report.css"),
        script: concat!(
            include_str!("../templates/viewer/decode.js"),
            include_str!("../templates/viewer/metrics.js"),
            include_str!("../templates/viewer/colours.js"),
            include_str!("../templates/viewer/paint.js"),
            include_str!("../templates/viewer/choices.js"),
            include_str!("../templates/viewer/show.js"),
            include_str!("../templates/viewer/controls.js"),
        ),
        viewer,
    };
    filled.render().map_err(Failure::internal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_come_in_order_verdicts_have_a_class_and_text_is_escaped() {
        let verdict = |text: &str, tone| Cell { text: text.to_owned(), tone };
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
            "<h2>Results</h2>",
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
        assert!(!html.contains("<script"), "without maps there is nothing to run");
    }
}
