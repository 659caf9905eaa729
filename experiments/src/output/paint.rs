//! Colour where it carries meaning: what fails is red, what holds green, the best of a column bold. Streams that are no terminal, and NO_COLOR, take it off.

use anstyle::{AnsiColor, Style};

use super::marks::{BEST, is_marked};

const BAD: Style = AnsiColor::Red.on_default().bold();
const GOOD: Style = AnsiColor::Green.on_default();
const FIRST: Style = AnsiColor::Green.on_default().bold();
const DOUBT: Style = AnsiColor::Yellow.on_default();

/// Words that carry meaning where a line begins or ends with them.
const WORDS: [(&str, Style); 10] = [
    ("FAIL", BAD),
    ("FAILS", BAD),
    ("fails", BAD),
    ("worse", BAD),
    ("holds", GOOD),
    ("pass", GOOD),
    ("better", GOOD),
    ("MISSING", BAD),
    ("undecided", DOUBT),
    ("unsure", DOUBT),
];

/// A text with its first and last words of a line in colour, where they stand apart: by a gap of two blanks or alone; and with the
/// best numbers of tables.
pub fn meaning(text: &str) -> String {
    let end = if text.ends_with('\n') { "\n" } else { "" };
    text.lines().map(line).collect::<Vec<_>>().join("\n") + end
}

fn line(line: &str) -> String {
    for (word, style) in WORDS {
        if let Some(before) = line.strip_suffix(word).filter(|before| before.ends_with("  ")) {
            return format!("{before}{}", painted(word, style));
        }
        if let Some(after) = line.strip_prefix(word).filter(|after| after.starts_with(' ')) {
            return format!("{}{after}", painted(word, style));
        }
    }
    line.split(' ')
        .map(|word| if is_marked(word, BEST) { painted(word, FIRST) } else { word.to_owned() })
        .collect::<Vec<_>>()
        .join(" ")
}

/// `error:` and `warning:` before a message.
pub fn heading(word: &str) -> String {
    let style = match word {
        "error" => BAD,
        "warning" => DOUBT,
        _ => Style::new(),
    };
    painted(&format!("{word}:"), style)
}

fn painted(text: &str, style: Style) -> String {
    format!("{style}{text}{style:#}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_that_stand_apart_are_painted_and_no_others() {
        let plain = |text: &str| anstream::adapter::strip_str(text).to_string();
        for text in [
            "near  0.08  pass\n",
            "holds  Figure 6: ok",
            "FAIL near",
            "conventional  +0.2  worse",
            "visibility  0.095* 0.3",
        ] {
            let painted = meaning(text);
            assert_ne!(painted, text);
            assert_eq!(plain(&painted), text);
        }
        for text in ["it gets worse", "holdsworth 1", "by pass", "worse\n"] {
            assert_eq!(meaning(text), text, "{text}");
        }
        assert_eq!(plain(&heading("error")), "error:");
        assert_eq!(heading("note"), "note:");
    }
}
