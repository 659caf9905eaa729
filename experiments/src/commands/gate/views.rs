//! The outcome of gates for machines that build: JUnit XML and Markdown.

use std::io;

use quick_xml::Writer;
use quick_xml::events::BytesText;

use super::tables::{account, bound, difference};
use super::verdict::{Outcome, Verdict};
use crate::failure::Failure;

/// The first line of XML.
const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

/// How JUnit files of ours begin ...
pub const JUNIT: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites tests=\"";

/// ... and those in Markdown.
pub const MARKDOWN: &str = "### Maps: ";

/// The outcome as JUnit XML: a test case per gate, its mapper as the class.
///
/// # Errors
/// None but a defect.
pub fn junit(outcomes: &[Outcome], file: &str) -> Result<Vec<u8>, Failure> {
    let count = |verdict| outcomes.iter().filter(|o| o.verdict == verdict).count().to_string();
    let (tests, failures, errors) = (outcomes.len().to_string(), count(Verdict::Fail), count(Verdict::Error));
    let counts = [("tests", tests.as_str()), ("failures", &failures), ("errors", &errors)];
    let mut xml = Writer::new_with_indent(HEAD.as_bytes().to_vec(), b' ', 2);
    let suites = xml.create_element("testsuites").with_attributes(counts);
    let written = suites.write_inner_content(|xml| {
        let suite = xml.create_element("testsuite").with_attribute(("name", printable(file).as_str()));
        suite.with_attributes(counts).write_inner_content(|xml| outcomes.iter().try_for_each(|o| case(xml, o)))?;
        Ok(())
    });
    written.map_err(Failure::internal)?;
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

fn case(xml: &mut Writer<Vec<u8>>, outcome: &Outcome) -> io::Result<()> {
    let class = format!("gate.{}", outcome.gate.mapper);
    let case = xml.create_element("testcase");
    let case = case.with_attributes([("classname", class.as_str()), ("name", &outcome.gate.name)]);
    let account = printable(&account(outcome).join("\n"));
    let element = match outcome.verdict {
        Verdict::Pass => "system-out",
        Verdict::Fail => "failure",
        Verdict::Error => "error",
    };
    case.write_inner_content(|xml| {
        let mut part = xml.create_element(element);
        let message = account.lines().nth(1).unwrap_or_default();
        if outcome.verdict != Verdict::Pass {
            part = part.with_attributes([("type", outcome.gate.criterion.metric), ("message", message)]);
        }
        part.write_text_content(BytesText::new(&account))?;
        Ok(())
    })?;
    Ok(())
}

/// Without the characters that XML 1.0 has no way to write: a mapper's own message may hold any.
fn printable(text: &str) -> String {
    let allowed = |c: char| !c.is_control() || c == '\n' || c == '\t';
    text.chars().map(|c| if allowed(c) && !matches!(c, '\u{fffe}' | '\u{ffff}') { c } else { '\u{fffd}' }).collect()
}

/// The outcome in Markdown: those that fail first in full, then all in a table.
pub fn markdown(outcomes: &[Outcome], heading: &str) -> String {
    let failing: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.verdict != Verdict::Pass).collect();
    let mut text = match failing.len() {
        0 => format!("{MARKDOWN}all {} gates pass\n\n", outcomes.len()),
        n => format!("{MARKDOWN}{n} of {} gates fail\n\n", outcomes.len()),
    };
    text += &format!("{}\n\n", cell(heading));
    for outcome in failing {
        let lines: Vec<String> = account(outcome).iter().map(|line| cell(line)).collect();
        text += &format!("- **{} {}**: {}\n", outcome.verdict.word(), outcome.gate.name, lines.join("; "));
    }
    if !text.ends_with("\n\n") {
        text.push('\n');
    }
    text += "| verdict | gate | mapper | metric | region | value | against | difference, 95 % interval | bound |\n";
    text += "|---|---|---|---|---|--:|--:|--:|--:|\n";
    for outcome in outcomes {
        let gate = &outcome.gate;
        let decimals = gate.criterion.decimals + 1;
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.decimals$}"));
        let against = match (outcome.against(), outcome.reference) {
            (Some(against), Some(value)) => format!("{against} {value:.decimals$}"),
            _ => String::new(),
        };
        let fields = [
            outcome.verdict.word().to_owned(),
            gate.name.clone(),
            cell(&gate.mapper),
            gate.criterion.title.to_owned(),
            cell(&gate.region),
            number(outcome.value),
            against,
            difference(outcome).unwrap_or_default(),
            bound(gate).replace('<', "&lt;").replace('>', "&gt;"),
        ];
        text += &format!("| {} |\n", fields.join(" | "));
    }
    text
}

/// Text that is no mark-up, on one line.
fn cell(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '|' | '*' | '`' | '_' | '[' | ']' | '\\' => out.extend(['\\', c]),
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '&' => out += "&amp;",
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}
