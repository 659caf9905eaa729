//! A program as tests need them, well-behaved and hostile: the first argument says which.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "its outputs are what is tested")]

use std::fs;
use std::io::{self, BufRead as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::Duration;

use serde_json::Value;

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let folder = args.last().map(PathBuf::from).unwrap_or_default();
    if let [serves, mapper] = args.as_slice()
        && serves == "serves"
    {
        return experiments::program(mapper::catalogue::find(mapper).expect("known"));
    }
    match args.first().map_or("", String::as_str) {
        "prior" => write(&folder, &npy(&folder, "<f8", |_, prior| prior)),
        "prior-f4" => write(&folder, &npy(&folder, "<f4", |_, prior| prior)),
        "unseen" => write(&folder, &npy(&folder, "<f8", |_, _| f64::NAN)),
        "infinite" => write(&folder, &npy(&folder, "<f8", |cell, prior| if cell == 7 { f64::INFINITY } else { prior })),
        "above" => write(&folder, &npy(&folder, "<f4", |cell, prior| if cell == 7 { 1.5 } else { prior })),
        "partial" => {
            let bytes = npy(&folder, "<f8", |_, prior| prior);
            write(&folder, &bytes[..bytes.len() / 2]);
        }
        "turned" => {
            let text = fs::read_to_string(folder.join("grid.json")).expect("given");
            let grid: Value = serde_json::from_str(&text).expect("JSON");
            write(&folder, &array(&grid["width"], &grid["height"], "<f8", |_| 0.5));
        }
        "nothing" => {}
        "pipe" => {
            let made = Command::new("mkfifo").arg(folder.join("occupancy.npy")).status().expect("mkfifo");
            assert!(made.success());
        }
        "fails" => {
            eprintln!("reading scans\nno memory for them");
            std::process::exit(3);
        }
        "fails-once" => {
            // The first stage has fewer scans than the others.
            let rows = fs::read_to_string(folder.join("scans.csv")).expect("given").lines().count();
            if rows < args[1].parse().expect("a number") {
                std::process::exit(4);
            }
            write(&folder, &npy(&folder, "<f8", |_, prior| prior));
        }
        "aborts" => std::process::abort(),
        "sleeps" => std::thread::sleep(Duration::from_secs(1000)),
        "forks" => {
            leave_behind(&args[1], &[]);
            write(&folder, &npy(&folder, "<f8", |_, prior| prior));
        }
        // In a session of its own, out of reach of what is sent to our process group.
        "escapes" => {
            leave_behind(&args[1], &["setsid"]);
            write(&folder, &npy(&folder, "<f8", |_, prior| prior));
        }
        // The same, and nothing in its environment tells where it comes from.
        "disguises" => {
            leave_behind(&args[1], &["setsid", "env", "-i"]);
            write(&folder, &npy(&folder, "<f8", |_, prior| prior));
        }
        "forks-and-sleeps" => {
            leave_behind(&args[1], &[]);
            std::thread::sleep(Duration::from_secs(1000));
        }
        // A child beyond the group, that heeds nothing that asks it to end.
        "stays" => {
            leave_behind(&args[1], &["setsid", "nohup"]);
            std::thread::sleep(Duration::from_secs(1000));
        }
        "online-leaves-and-stays" => {
            leave_behind(&args[1], &["setsid", "nohup"]);
            online(|_, _| Answer::Nothing);
            std::thread::sleep(Duration::from_secs(1000));
        }
        "sleeper" => {
            fs::write(&args[1], std::process::id().to_string()).expect("writable");
            std::thread::sleep(Duration::from_secs(1000));
        }
        "floods-stdout" => flood(io::stdout().lock()),
        "floods-stderr" => flood(io::stderr().lock()),
        "floods-a-little" => {
            let mut out = io::stderr().lock();
            let _ = out.write_all(b"the beginning\n");
            (0..200_000).for_each(|k| drop(writeln!(out, "{k}: on and on and on")));
            let _ = out.write_all(b"the end\n");
            write(&folder, &npy(&folder, "<f8", |_, prior| prior));
        }
        "fills-the-disk" => {
            let file = fs::File::create(folder.join("cache")).expect("writable");
            file.set_len(1 << 40).expect("sparse");
            std::thread::sleep(Duration::from_secs(1000));
        }
        "online" => online(|_, _| Answer::Map),
        "online-dies" => online(|maps, _| if maps == 5 { Answer::Exit } else { Answer::Map }),
        "online-silent" => online(|maps, _| if maps == 5 { Answer::Nothing } else { Answer::Map }),
        "online-short" => online(|maps, _| if maps == 5 { Answer::Half } else { Answer::Map }),
        "online-twice" => online(|maps, _| if maps == 5 { Answer::Twice } else { Answer::Map }),
        "online-stays" => {
            online(|_, _| Answer::Map);
            std::thread::sleep(Duration::from_secs(1000));
        }
        "online-babbles" => {
            println!("loading the model ...");
            online(|_, _| Answer::Map);
        }
        other => panic!("there is no behaviour {other:?}"),
    }
    ExitCode::SUCCESS
}

/// What is done when a map is asked for.
enum Answer {
    Map,
    Nothing,
    Half,
    Twice,
    Exit,
}

/// Answers with the prior; `answer` is told how many maps were asked for before, and the number of scans.
fn online(answer: impl Fn(usize, usize) -> Answer) {
    let mut start = Value::Null;
    let (mut maps, mut scans) = (0, 0);
    let mut out = io::stdout().lock();
    for line in io::stdin().lock().lines() {
        let message: Value = serde_json::from_str(&line.expect("text")).expect("JSON");
        assert_eq!(message["schema_version"], 1);
        match message["type"].as_str() {
            Some("start") => start = message,
            Some("scan") => {
                assert_eq!(message["scan"], scans);
                let beams = message["bearing_rad"].as_array().map(Vec::len);
                assert_eq!(message["disparity_px"].as_array().map(Vec::len), beams);
                scans += 1;
            }
            Some("map") => {
                let (width, height) = (number(&start["grid"]["width"]), number(&start["grid"]["height"]));
                let prior = start["sensors"][0]["prior"]["occupancy"].as_f64().expect("a number");
                let header =
                    format!("{{\"schema_version\":1,\"height\":{height},\"width\":{width},\"dtype\":\"<f8\"}}\n");
                let values = prior.to_le_bytes().repeat(width * height);
                let map = [header.as_bytes(), &values].concat();
                let told = match answer(maps, scans) {
                    Answer::Map => map,
                    Answer::Nothing => Vec::new(),
                    Answer::Half => {
                        out.write_all(&map[..map.len() / 2]).expect("heard");
                        return;
                    }
                    Answer::Twice => map.repeat(2),
                    Answer::Exit => std::process::exit(5),
                };
                maps += 1;
                out.write_all(&told).and_then(|()| out.flush()).expect("heard");
            }
            other => panic!("{other:?}"),
        }
    }
}

fn number(value: &Value) -> usize {
    value.as_u64().expect("a whole number") as usize
}

fn write(folder: &Path, bytes: &[u8]) {
    fs::write(folder.join("occupancy.npy"), bytes).expect("writable");
}

/// A map of the grid that was given; `value` is told the number of the cell and the prior.
fn npy(folder: &Path, descr: &str, value: impl Fn(usize, f64) -> f64) -> Vec<u8> {
    let read = |name: &str| -> Value {
        serde_json::from_str(&fs::read_to_string(folder.join(name)).expect("given")).expect("JSON")
    };
    let (grid, sensors) = (read("grid.json"), read("sensors.json"));
    let prior = sensors[0]["prior"]["occupancy"].as_f64().expect("a number");
    array(&grid["height"], &grid["width"], descr, |cell| value(cell, prior))
}

fn array(height: &Value, width: &Value, descr: &str, value: impl Fn(usize) -> f64) -> Vec<u8> {
    let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({height}, {width}), }}");
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(format!("{text:<117}\n").bytes());
    for cell in 0..number(height) * number(width) {
        match descr {
            "<f4" => bytes.extend((value(cell) as f32).to_le_bytes()),
            _ => bytes.extend(value(cell).to_le_bytes()),
        }
    }
    bytes
}

/// Starts a process that outlives this one, and waits until it runs.
#[expect(clippy::zombie_processes, reason = "it is left behind on purpose")]
fn leave_behind(pid_file: &str, through: &[&str]) {
    let own = std::env::current_exe().expect("known").display().to_string();
    let words = [through, &[own.as_str(), "sleeper", pid_file]].concat();
    Command::new(words[0]).args(&words[1..]).stdin(Stdio::null()).spawn().expect("started");
    while fs::read_to_string(pid_file).unwrap_or_default().is_empty() {
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn flood(mut out: impl io::Write) {
    let bytes = vec![b'x'; 1 << 16];
    while out.write_all(&bytes).is_ok() {}
}
