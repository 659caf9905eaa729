//! From a path to a parsed document.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use toml::Spanned;
use toml::de::DeTable;

use crate::brought::{self, Opened};
use crate::excerpt::{LONGEST_REPORT, excerpt};
use crate::foreign;
use crate::likeness::near;
use crate::place::Place;
use crate::problem::{Error, Problem};
use crate::source::Source;

/// No file is longer; `/dev/zero` is.
const MAX_BYTES: u64 = 16 << 20;

/// Of a folder so many names are compared with a wrong one.
const MOST_NAMES: usize = 10_000;

/// Opens a file to read it; where there is none, the one of its path that the program [brings](crate::bring).
///
/// # Errors
/// As [`File::open`]; of a file that is not there the message names one beside it that is called nearly so.
pub fn opened(path: &Path) -> io::Result<Opened> {
    match (File::open(path), brought::content(brought::brought(), path)) {
        (Ok(file), _) => Ok(Opened::on_disk(file)),
        (Err(error), content) if error.kind() == io::ErrorKind::NotFound => {
            let absent = || io::Error::new(error.kind(), format!("there is no such file{}", beside(path)));
            content.map(Opened::brought).ok_or_else(absent)
        }
        (Err(error), _) => Err(error),
    }
}

/// ` (did you mean ...?)` where a file beside `path` is called nearly so.
fn beside(path: &Path) -> String {
    let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else { return String::new() };
    let entries = std::fs::read_dir(if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
    let names = entries.into_iter().flatten().take(MOST_NAMES);
    let mut names: Vec<String> = names.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    let brought = brought::brought().iter().map(|(path, _)| Path::new(path));
    let brought = brought.filter(|path| path.parent() == Some(folder)).filter_map(Path::file_name);
    names.extend(brought.map(|name| name.to_string_lossy().into_owned()));
    names.sort_unstable();
    names.dedup();
    let known: Vec<&str> = names.iter().map(String::as_str).collect();
    let near = near(&name.to_string_lossy(), &known);
    let shown = near.map(|name| excerpt(&folder.join(name).display().to_string(), LONGEST_REPORT));
    shown.map(|path| format!(" (did you mean `{path}`?)")).unwrap_or_default()
}

/// Reads a file as text, at most 16 MiB of UTF-8.
///
/// # Errors
/// A file that cannot be read, or that is no such text.
pub fn read(path: &Path) -> Result<String, Error> {
    let file = path.display().to_string();
    let mut bytes = Vec::new();
    let opened = opened(path).and_then(|f| f.take(MAX_BYTES + 1).read_to_end(&mut bytes));
    opened.map_err(|source| Error::Unreadable { file: file.clone(), source })?;
    let not_text = |problem: String, line, column| Error::Invalid {
        place: Place { file: file.clone(), line, column },
        problem: Box::new(Problem::NotText(problem)),
    };
    if bytes.len() as u64 > MAX_BYTES {
        return Err(not_text("more than 16 MiB".to_owned(), 1, 1));
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let before = String::from_utf8_lossy(&error.as_bytes()[..good]).into_owned();
        if let Some((what, remedy)) = foreign::named(error.as_bytes()) {
            let place = Place { file: file.clone(), line: 1, column: 1 };
            return Error::Invalid { place, problem: Box::new(Problem::Foreign { what, remedy }) };
        }
        let place = Source::new(&file, &before).place(good);
        not_text(format!("byte {:#04x} is no UTF-8", error.as_bytes()[good]), place.line, place.column)
    })
}

/// Parses a file's text as TOML; a byte order mark before it is skipped.
///
/// # Errors
/// The first thing that is no TOML.
pub fn open<'a>(text: &'a str, file: &'a str) -> Result<(Source<'a>, Spanned<DeTable<'a>>), Error> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let source = Source::new(file, text);
    let document = DeTable::parse(text).map_err(|error| {
        if let Some((what, remedy)) = foreign::named(text.as_bytes()) {
            return source.error(0, Problem::Foreign { what, remedy });
        }
        let offset = error.span().map_or(0, |span| span.start);
        let report = error.message().lines().collect::<Vec<_>>().join("; ");
        source.error(offset, Problem::Syntax(excerpt(&report, LONGEST_REPORT)))
    })?;
    Ok((source, document))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_text_or_no_toml_is_refused_at_its_place() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("f.toml");
        let refusal = |bytes: &[u8]| {
            std::fs::write(&path, bytes).expect("written");
            let text = read(&path);
            let error =
                text.and_then(|text| open(&text, &path.display().to_string()).map(|_| ())).expect_err("refused");
            error.to_string().replace(&format!("{}:", path.display()), "")
        };
        assert_eq!(
            refusal(b"a = 1\n\xc3\xa9 = \xff"),
            "2:5: byte 0xff is no UTF-8; must be a TOML text of at most 16 MiB in UTF-8"
        );
        let long = refusal(&vec![b'#'; 16 << 20 | 1]);
        assert_eq!(long, "1:1: more than 16 MiB; must be a TOML text of at most 16 MiB in UTF-8");
        let cut = refusal("\u{feff}a = 1\nb =\n".as_bytes());
        assert!(cut.starts_with("2:4: no valid TOML: ") && cut.lines().count() == 1, "{cut}");
        let absent = read(&folder.path().join("another-name.toml")).expect_err("no such file");
        assert_eq!(absent.kind(), crate::ErrorKind::BadInput);
        assert!(!absent.to_string().contains("did you mean"), "{absent}");
        let wrong = read(&folder.path().join("ff.tml")).expect_err("no such file").to_string();
        assert!(wrong.contains(&format!("there is no such file (did you mean `{}`?)", path.display())), "{wrong}");
    }
}
