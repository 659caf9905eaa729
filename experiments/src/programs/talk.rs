//! Talking to a program that takes scans one by one: a line is said within a time, and a map is heard within a time.

use std::io::{self, BufRead, BufReader, Read, Write as _};
use std::process::{ChildStdin, ChildStdout};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, TryRecvError, channel, sync_channel};
use std::thread;
use std::time::Duration;

use grid::GridSpec;
use serde::Deserialize;
use serde_json::{Value, json};

use super::described::SCHEMA_VERSION;
use super::fault::Fault;
use super::process::{Pipes, Process};

/// Bytes of the line before a map, at most.
const LONGEST_LINE: u64 = 4096;

/// How long a program that has closed an output is waited for, so that its exit code can be told.
const LAST: Duration = Duration::from_millis(500);

/// A conversation with a program. Dropped, it closes the program's standard input, and ends it soon after.
pub(super) struct Talk {
    process: Process,
    longest: Duration,
    /// Lines to write; none once the conversation is over.
    lines: Option<Sender<Vec<u8>>>,
    /// Told after every line that is written, or why it is not.
    written: Receiver<io::Result<()>>,
    maps: Receiver<Result<Vec<f64>, Fault>>,
}

/// The line before a map.
#[derive(Deserialize)]
struct Header {
    schema_version: u32,
    height: u64,
    width: u64,
    dtype: String,
}

impl Talk {
    /// Starts the program.
    ///
    /// # Errors
    /// A program that cannot be started.
    pub(super) fn start(words: &[String], grid: GridSpec, longest: Duration) -> Result<Self, Fault> {
        let (process, Pipes { stdin, stdout }) = Process::talk(words)?;
        let (lines, to_write) = channel();
        let (tell, written) = channel();
        let (hear, maps) = sync_channel(1);
        let threads = [
            thread::Builder::new().name("say".to_owned()).spawn(move || write(stdin, &to_write, &tell)),
            thread::Builder::new().name("hear".to_owned()).spawn(move || read(stdout, &grid, &hear)),
        ];
        for thread in threads {
            thread.map_err(|source| Fault::Start { program: words[0].clone(), source })?;
        }
        Ok(Self { process, longest, lines: Some(lines), written, maps })
    }

    /// Says a line.
    ///
    /// # Errors
    /// A program that does not read it in time, or has closed its standard input.
    pub(super) fn say(&mut self, message: &Value) -> Result<(), Fault> {
        let Some(lines) = &self.lines else { return Err(Fault::Deaf) };
        lines.send(format!("{message}\n").into_bytes()).map_err(|_| Fault::Deaf)?;
        match self.written.recv_timeout(self.longest) {
            Ok(Ok(())) => Ok(()),
            Ok(Err(_)) | Err(RecvTimeoutError::Disconnected) => Err(Fault::Deaf),
            Err(RecvTimeoutError::Timeout) => {
                Err(Fault::TimeOut { what: "scan was read from standard input", seconds: self.longest.as_secs_f64() })
            }
        }
    }

    /// Asks for the map: one value per cell, row 0 the lowest; NaN or from 0 to 1.
    ///
    /// # Errors
    /// Anything but a map of the grid, in time.
    pub(super) fn map(&mut self) -> Result<Vec<f64>, Fault> {
        match self.maps.try_recv() {
            Ok(Ok(_)) => return Err(Fault::Unasked),
            Ok(Err(fault)) => return Err(fault),
            Err(TryRecvError::Disconnected) => return Err(Fault::Closed),
            Err(TryRecvError::Empty) => {}
        }
        self.say(&json!({ "type": "map", "schema_version": SCHEMA_VERSION }))?;
        match self.maps.recv_timeout(self.longest) {
            Ok(map) => map,
            Err(RecvTimeoutError::Disconnected) => Err(Fault::Closed),
            Err(RecvTimeoutError::Timeout) => Err(Fault::TimeOut { what: "map", seconds: self.longest.as_secs_f64() }),
        }
    }

    /// Ends the program after a fault. Of one that ended by itself before it should, what it had answered, or how it ended, is
    /// the fault.
    pub(super) fn end(&self, fault: Fault) -> Fault {
        let fault = match (fault, self.maps.try_recv()) {
            (Fault::Deaf, Ok(Err(answered))) => answered,
            (fault, _) => fault,
        };
        let fault = match fault {
            Fault::Closed | Fault::Deaf => match self.process.wait("end", LAST, || Ok(())) {
                Err(ended @ (Fault::Exit(_) | Fault::Signal(_))) => ended,
                _ => fault,
            },
            other => other,
        };
        self.process.end();
        fault
    }

    /// What the program has written to standard error so far.
    pub(super) fn stderr(&self) -> String {
        self.process.stderr()
    }
}

impl Drop for Talk {
    fn drop(&mut self) {
        self.lines = None; // the thread that writes closes standard input
        let _ = self.process.wait("end", LAST, || Ok(()));
    }
}

fn write(mut stdin: ChildStdin, lines: &Receiver<Vec<u8>>, tell: &Sender<io::Result<()>>) {
    for line in lines {
        let written = stdin.write_all(&line).and_then(|()| stdin.flush());
        let ended = written.is_err();
        if tell.send(written).is_err() || ended {
            return;
        }
    }
}

/// Reads maps until one is none, and no farther: what follows is not to be trusted, and is not to fill the memory.
fn read(stdout: ChildStdout, grid: &GridSpec, hear: &SyncSender<Result<Vec<f64>, Fault>>) {
    let mut stdout = BufReader::new(stdout);
    loop {
        let map = read_map(&mut stdout, grid);
        let ended = map.is_err();
        if hear.send(map).is_err() || ended {
            return;
        }
    }
}

/// A line such as `{"schema_version":1,"height":2,"width":3,"dtype":"<f4"}`, then so many values, row 0 the lowest.
fn read_map(stdout: &mut impl BufRead, grid: &GridSpec) -> Result<Vec<f64>, Fault> {
    let mut line = Vec::new();
    stdout.take(LONGEST_LINE).read_until(b'\n', &mut line).map_err(|_| Fault::Closed)?;
    let shown = || strict::excerpt(&String::from_utf8_lossy(&line), strict::LONGEST_VALUE);
    let refuse = |problem: String| Fault::Header { line: shown(), problem };
    if line.last() != Some(&b'\n') {
        return Err(match line.len() as u64 {
            LONGEST_LINE => refuse(format!("must end within {LONGEST_LINE} bytes")),
            _ => Fault::Closed,
        });
    }
    let header: Header = serde_json::from_slice(&line).map_err(|error| {
        refuse(format!(
            "must be JSON with schema_version, height, width and dtype ({error}); print nothing else to standard output"
        ))
    })?;
    if header.schema_version != SCHEMA_VERSION {
        return Err(refuse(format!("schema_version must be {SCHEMA_VERSION}")));
    }
    if (header.width, header.height) != (grid.width as u64, grid.height as u64) {
        return Err(Fault::Shape { found_height: header.height, found_width: header.width, grid: *grid });
    }
    match header.dtype.as_str() {
        "<f4" => values(stdout, grid, |bytes| f64::from(f32::from_le_bytes(bytes))),
        "<f8" => values(stdout, grid, f64::from_le_bytes),
        _ => Err(refuse("dtype must be \"<f4\" or \"<f8\", little-endian floats of 4 or 8 bytes".to_owned())),
    }
}

fn values<const N: usize>(
    stdout: &mut impl Read,
    grid: &GridSpec,
    number: impl Fn([u8; N]) -> f64,
) -> Result<Vec<f64>, Fault> {
    let mut values = Vec::with_capacity(grid.cells());
    let mut bytes = [0; N];
    for cell in 0..grid.cells() {
        stdout.read_exact(&mut bytes).map_err(|_| Fault::Closed)?;
        let value = number(bytes);
        if !value.is_nan() && !(0.0..=1.0).contains(&value) {
            return Err(Fault::Value { row: cell / grid.width, column: cell % grid.width, value });
        }
        values.push(value);
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const GRID: GridSpec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 3, height: 2 };

    fn answer(line: &str, bytes: &[u8]) -> Result<Vec<f64>, String> {
        let text = [line.as_bytes(), b"\n", bytes].concat();
        read_map(&mut text.as_slice(), &GRID).map_err(|fault| fault.to_string())
    }

    #[test]
    fn what_is_no_answer_is_said_in_a_line() {
        let header = r#"{"schema_version":1,"height":2,"width":3,"dtype":"<f8"}"#;
        let doubles = |last: f64| [0.0, 1.0, 0.5, f64::NAN, 0.25, last].iter().flat_map(|v| v.to_le_bytes()).collect();
        let (good, infinite): (Vec<u8>, Vec<u8>) = (doubles(0.125), doubles(f64::INFINITY));
        let map = answer(header, &good).expect("a map");
        assert!(map[3].is_nan() && map[5].to_bits() == 0.125_f64.to_bits());
        let cases = [
            (header.to_owned(), &good[..47], "ended before a whole map"),
            (header.to_owned(), &infinite, "value [1, 2] = inf: must be from 0 to 1, or NaN"),
            (header.replace('2', "4"), &good, "the map is 4 x 3: must be 2 x 3"),
            (header.replace("f8", "i4"), &good, "dtype must be"),
            (header.replace("\":1,", "\":2,"), &good, "schema_version must be 1"),
            ("loading...".to_owned(), &good, "must be JSON"),
            ("x".repeat(5000), &good, "must end within 4096 bytes"),
        ];
        for (line, bytes, part) in cases {
            let message = answer(&line, bytes).expect_err(part);
            assert!(message.contains(part) && !message.contains('\n') && message.len() < 400, "{part}: {message}");
        }
    }

    proptest! {
        #[test]
        fn any_bytes_are_a_map_or_a_fault(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let header = r#"{"schema_version":1,"height":2,"width":3,"dtype":"<f4"}"#;
            for line in [header, ""] {
                if let Ok(map) = answer(line, &bytes) {
                    prop_assert!(map.len() == 6 && map.iter().all(|v| v.is_nan() || (0.0..=1.0).contains(v)));
                }
            }
        }
    }
}
