//! What a program writes to an output, of which the first and the last part are kept.

use std::collections::VecDeque;
use std::io::Read;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use std::{io, thread};

/// Bytes that are kept of the beginning, and as many of the end.
const PART: usize = 32 * 1024;

/// Characters of the end that a message quotes.
const QUOTED: usize = 300;

/// The first and the last part of a stream of bytes.
#[derive(Debug, Default)]
struct Kept {
    first: Vec<u8>,
    last: VecDeque<u8>,
    total: u64,
}

impl Kept {
    fn take(&mut self, bytes: &[u8]) {
        self.total += bytes.len() as u64;
        let (first, rest) = bytes.split_at(bytes.len().min(PART - self.first.len()));
        self.first.extend(first);
        self.last.extend(&rest[rest.len().saturating_sub(PART)..]);
        self.last.drain(..self.last.len().saturating_sub(PART));
    }

    fn text(&self) -> String {
        let left_out = self.total - (self.first.len() + self.last.len()) as u64;
        let mut bytes = self.first.clone();
        if left_out > 0 {
            bytes.extend(format!("\n[... {left_out} bytes left out ...]\n").bytes());
        }
        bytes.extend(&self.last);
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

/// An output that is read by a thread of its own to the end, however much it is.
#[derive(Debug)]
pub(super) struct Drain {
    kept: Arc<Mutex<Kept>>,
    ended: Receiver<()>,
}

impl Drain {
    /// Begins to read.
    ///
    /// # Errors
    /// A thread that the system does not give.
    pub(super) fn of(mut output: impl Read + Send + 'static) -> io::Result<Self> {
        let kept = Arc::new(Mutex::new(Kept::default()));
        let (end, ended) = channel();
        let place = Arc::clone(&kept);
        thread::Builder::new().name("drain".to_owned()).spawn(move || {
            let mut bytes = vec![0; 64 * 1024];
            loop {
                match output.read(&mut bytes) {
                    Ok(0) => break,
                    Ok(read) => place.lock().unwrap_or_else(PoisonError::into_inner).take(&bytes[..read]),
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                    Err(_) => break,
                }
            }
            let _ = end.send(());
        })?;
        Ok(Self { kept, ended })
    }

    /// Waits for the end, but not long: whoever holds the other end open may be out of our reach.
    pub(super) fn finish(&self, longest: Duration) {
        let _ = self.ended.recv_timeout(longest);
    }

    /// What was kept so far.
    pub(super) fn text(&self) -> String {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).text()
    }
}

/// The end of a text as a part of a line; nothing of an empty one.
pub(super) fn last_words(text: &str) -> Option<String> {
    let words: Vec<&str> =
        text.split(|c: char| c.is_whitespace() || c.is_control()).filter(|w| !w.is_empty()).collect();
    let line = words.join(" ");
    let skipped = line.chars().count().saturating_sub(QUOTED);
    let end: String = line.chars().skip(skipped).collect();
    (!end.is_empty()).then(|| if skipped > 0 { format!("...{end}") } else { end })
}

#[cfg(test)]
mod tests {
    use super::*;

    use proptest::prelude::*;

    #[test]
    fn a_text_that_fits_is_kept_as_it_is() {
        let mut kept = Kept::default();
        kept.take(b"one\n");
        kept.take(b"two\n");
        assert_eq!(kept.text(), "one\ntwo\n");
        assert_eq!(last_words("one\n\ttwo\u{1b}[0m\n").as_deref(), Some("one two [0m"));
        assert_eq!(last_words(" \n"), None);
        assert_eq!(last_words(&"x".repeat(1000)).map(|words| words.chars().count()), Some(QUOTED + 3));
    }

    proptest! {
        #[test]
        fn of_more_the_ends_are_kept(parts in prop::collection::vec(1_usize..30_000, 1..12)) {
            let mut kept = Kept::default();
            let all: Vec<u8> = (0..parts.iter().sum::<usize>()).map(|k| b'a' + (k % 23) as u8).collect();
            let mut begin = 0;
            for part in parts {
                kept.take(&all[begin..begin + part]);
                begin += part;
            }
            let text = kept.text();
            let expected = match all.len() {
                length if length <= 2 * PART => String::from_utf8_lossy(&all).into_owned(),
                length => format!(
                    "{}\n[... {} bytes left out ...]\n{}",
                    String::from_utf8_lossy(&all[..PART]),
                    length - 2 * PART,
                    String::from_utf8_lossy(&all[length - PART..])
                ),
            };
            prop_assert!(text == expected, "{} bytes", all.len());
        }
    }
}
