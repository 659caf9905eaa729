//! `guide`: the pages of the guide, in the terminal.

use clap::Args;
use strict::nearest;

use crate::failure::Failure;
use crate::output::table::print;

/// Options of `guide`.
#[derive(Debug, Args)]
pub struct GuideOptions {
    /// Page to print [default: which there are]
    #[arg(value_name = "PAGE")]
    pub page: Option<String>,
}

/// Pages by name, in the order of the guide.
macro_rules! pages {
    ($($name:literal),* $(,)?) => { [$(($name, include_str!(concat!("../../guide/", $name, ".md")))),*] };
}

const PAGES: [(&str, &str); 30] = pages![
    "introduction",
    "commands",
    "room",
    "compare",
    "gibbs",
    "drives",
    "ray",
    "sensor",
    "scenes",
    "families",
    "moving",
    "sensors",
    "poses",
    "maps-and-plans",
    "convert",
    "score",
    "own-mapper",
    "own-sensor",
    "python",
    "gate",
    "sweep",
    "logs",
    "slam",
    "features",
    "calibrate",
    "speed",
    "figures",
    "reproducibility",
    "glossary",
    "developing",
];

/// Prints a page, or what pages there are.
///
/// # Errors
/// A page that does not exist, with the nearest that does; a stdout that cannot be written.
pub fn run(options: &GuideOptions) -> Result<(), Failure> {
    let text = match &options.page {
        None => contents(),
        Some(name) => page(name)?.to_owned(),
    };
    print(&text)
}

fn page(name: &str) -> Result<&'static str, Failure> {
    let found = PAGES.iter().find(|(own, _)| *own == name.trim_end_matches(".md"));
    found.map(|(_, text)| *text).ok_or_else(|| {
        let names = PAGES.map(|(name, _)| name);
        Failure::BadInput(format!(
            "there is no page {name:?}; the nearest is '{}', all are: {}",
            nearest(name, names.into_iter()),
            names.join(", ")
        ))
    })
}

/// Names and titles.
fn contents() -> String {
    let title = |text: &'static str| text.lines().next().unwrap_or_default().trim_start_matches("# ");
    PAGES.iter().map(|(name, text)| format!("{name:<16} {}\n", title(text))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pages are those that the summary names, in its order.
    #[test]
    fn every_page_of_the_summary_can_be_printed() {
        let summary = include_str!("../../guide/SUMMARY.md");
        let named: Vec<&str> = summary.split("](").skip(1).filter_map(|rest| rest.split(".md)").next()).collect();
        assert_eq!(PAGES.map(|(name, _)| name).to_vec(), named);
        assert!(PAGES.iter().all(|(_, text)| text.starts_with("# ")));
        assert!(page("compare.md").is_ok_and(|text| text.contains("visibility-lateral")));
    }

    #[test]
    fn a_page_that_does_not_exist_is_answered_with_the_nearest() {
        let error = page("rooms").expect_err("no page").to_string();
        assert!(error.contains("nearest is 'room'") && error.contains("glossary"), "{error}");
    }
}
