//! How wide the reader's screen is, and prose that keeps to it.

use std::io;

/// The columns of whoever reads stdout: of the terminal, else of the variable COLUMNS; none where nobody says.
pub fn width() -> Option<usize> {
    screen(terminal_size::terminal_size_of(io::stdout()))
}

/// As [`width`], of stderr.
pub fn width_of_notes() -> Option<usize> {
    screen(terminal_size::terminal_size_of(io::stderr()))
}

fn screen(terminal: Option<(terminal_size::Width, terminal_size::Height)>) -> Option<usize> {
    let variable = || std::env::var("COLUMNS").ok()?.parse().ok();
    let columns = terminal.map(|(width, _)| usize::from(width.0)).or_else(variable);
    columns.map(|columns: usize| columns.max(NARROWEST))
}

/// No screen is taken to be narrower, in columns.
const NARROWEST: usize = 30;

/// Lines of prose that are longer than the screen end between words, and go on under their first word; what is drawn or aligned,
/// with gaps between words, stays.
pub fn fitted(text: &str, width: Option<usize>) -> String {
    let Some(width) = width else { return text.to_owned() };
    let fitted = |line: &str| {
        let indent = line.chars().take_while(|c| *c == ' ').count();
        let drawn = line.trim_start().contains("  ") || line.contains(['─', '#']);
        if line.chars().count() <= width || drawn || indent * 2 > width {
            return line.to_owned();
        }
        let margin = " ".repeat(indent);
        wrapped(line, width - indent).iter().map(|part| format!("{margin}{part}")).collect::<Vec<_>>().join("\n")
    };
    let end = if text.ends_with('\n') { "\n" } else { "" };
    text.lines().map(fitted).collect::<Vec<_>>().join("\n") + end
}

/// A text in lines of at most so many columns, as far as its words allow.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => *line += &format!(" {word}"),
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
