//! What a section of a page is made of.

use serde_json::Value;

use crate::output::table::Table;

/// A heading and what stands below it.
#[derive(Debug, Default)]
pub struct Section {
    /// The heading.
    pub heading: String,
    /// How to read it; may be empty.
    pub lead: String,
    /// In order.
    pub parts: Vec<Part>,
}

impl Section {
    /// Its name in the address of the page.
    pub fn id(&self) -> String {
        let letter = |c: char| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
        self.heading.chars().map(letter).collect()
    }
}

/// Something below a heading.
#[derive(Debug)]
pub enum Part {
    /// A picture.
    Picture(Picture),
    /// A table.
    Sheet(Sheet),
    /// Parts that open and close behind a line of text.
    Fold {
        /// The line.
        summary: String,
        /// Whether it starts open.
        open: bool,
        /// What it hides.
        parts: Vec<Sheet>,
    },
}

/// A picture with its caption.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Its file name.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// The file: PNG, or SVG by its name.
    pub bytes: Vec<u8>,
}

/// Pictures of the world, whose greys mean something: they are the same on a dark page, in a white frame. Others are
/// charts, drawn on the page's own ground.
const MAPS: [&str; 5] = ["errors", "maps", "regions", "scene", "trajectory"];

impl Picture {
    /// How it is styled.
    pub fn class(&self) -> &'static str {
        let stem = self.name.split('.').next().unwrap_or_default();
        if MAPS.contains(&stem) { "map" } else { "chart" }
    }

    /// What kind of file it is.
    pub fn media_type(&self) -> &'static str {
        if self.name.ends_with(".svg") { "image/svg+xml" } else { "image/png" }
    }
}

/// A table for reading: every row has one cell per head. The first column holds names.
#[derive(Debug, Default)]
pub struct Sheet {
    /// Above the table; may be empty.
    pub caption: String,
    /// Beside the caption, stepping back; may be empty.
    pub note: String,
    /// Heads of the columns.
    pub heads: Vec<String>,
    /// The rows.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a [`Sheet`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// Its text.
    pub text: String,
    /// How it is coloured.
    pub tone: Tone,
    /// Where it leads, if anywhere.
    pub link: Option<String>,
}

/// Colour of a cell. The text must say the same: not everybody sees colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tone {
    /// As the text around it.
    #[default]
    Plain,
    /// A verdict in favour.
    Good,
    /// A verdict against.
    Bad,
    /// No difference that matters.
    Even,
}

impl Tone {
    /// Name of the style.
    pub fn class(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Good => "good",
            Self::Bad => "bad",
            Self::Even => "even",
        }
    }
}

impl Cell {
    /// A text in a colour.
    pub fn toned(text: impl Into<String>, tone: Tone) -> Self {
        Self { tone, ..text.into().into() }
    }

    /// A text that leads somewhere.
    pub fn link(text: impl Into<String>, to: impl Into<String>) -> Self {
        Self { link: Some(to.into()), ..text.into().into() }
    }
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self { text: text.into(), tone: Tone::Plain, link: None }
    }
}

impl Sheet {
    /// All rows of a table; a value that does not exist is a dash.
    pub fn of(caption: &str, table: &Table) -> Self {
        let cell = |value: &Value| match value {
            Value::Null => "-".into(),
            Value::String(text) => text.as_str().into(),
            other => other.to_string().into(),
        };
        Self {
            caption: caption.to_owned(),
            note: String::new(),
            heads: table.columns().iter().map(|name| name.replace('_', " ")).collect(),
            rows: table.rows().iter().map(|row| row.iter().map(cell).collect()).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_table_becomes_a_sheet() {
        let rows = [("visibility", Some(0.25)), ("prior", None)];
        let table = Table::of(&rows, &[("mapper", &|row| json!(row.0)), ("log_loss", &|row| json!(row.1))]);
        let sheet = Sheet::of("Losses", &table);
        assert_eq!(sheet.heads, ["mapper", "log loss"]);
        assert_eq!(sheet.rows, [["visibility".into(), "0.25".into()], ["prior".into(), Cell::from("-")]]);
    }
}
