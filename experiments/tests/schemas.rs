//! The JSON schemas say what the readers do: the same keys at every table, the same shipped files, the same mutants refused.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use boon::{Compiler, SchemaIndex, Schemas};
use experiments::commands::{gate, sweep};
use experiments::worlds::{schema, shipped};
use mapper::catalogue::MAPPERS;
use scene::{Family, Scene};
use sensor::SensorKind;
use serde_json::Value;

const KINDS: [&str; 4] = ["scene", "family", "sweep", "gate"];

fn schema_of(kind: &str) -> Value {
    match kind {
        "scene" => schema::scene(),
        "family" => schema::family(),
        "sweep" => sweep::schema(),
        _ => gate::schema(),
    }
}

/// A schema that is ready to judge.
struct Judge {
    schemas: Schemas,
    index: SchemaIndex,
}

impl Judge {
    fn of(kind: &str) -> Self {
        let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
        compiler.add_resource("schema.json", schema_of(kind)).expect("a resource");
        let index = compiler.compile("schema.json", &mut schemas).expect("a valid schema");
        Self { schemas, index }
    }

    fn accepts(&self, text: &str) -> Result<(), String> {
        let table: toml::Table = text.parse().expect("TOML");
        let json = serde_json::to_value(table).expect("JSON");
        self.schemas.validate(&json, self.index).map_err(|error| format!("{error:#}"))
    }
}

/// What the reader says of a text.
fn read(kind: &str, text: &str) -> Result<(), String> {
    strict::bring(shipped::FILES);
    let root = root();
    let place = root.join("scenes/t.toml");
    match kind {
        "scene" => Scene::parse(text, &place, None).map(drop).map_err(|e| e.to_string()),
        "family" => Family::parse(text, &place).map(drop).map_err(|e| e.to_string()),
        "sweep" => sweep::file::parse(text, "t.toml").map(drop).map_err(|e| e.to_string()),
        _ => gate::file::parse(text, "t.toml", MAPPERS).map(drop).map_err(|e| e.to_string()),
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The files that come with the program, of a kind; with a scene that has everything.
fn shipped(kind: &str) -> Vec<String> {
    let text = |path: &str| fs::read_to_string(root().join(path)).expect("readable");
    let scenes = ["room", "uma", "corridor-people", "office-glass", "office-visits", "sonar-ring", "waiting-people"]
        .map(|name| format!("scenes/{name}.toml"));
    let families = ["closets", "clutter", "corridors", "halls", "two-rooms"].map(|name| format!("scenes/{name}.toml"));
    match kind {
        "scene" => {
            let new = text("experiments/src/commands/scene/new.toml").replace("NAME", "t");
            scenes.iter().map(|path| text(path)).chain([new]).collect()
        }
        "family" => families.iter().map(|path| text(path)).collect(),
        "sweep" => ["camera", "cell-size", "lateral", "obstacle-size", "range-cut", "range-looks"]
            .map(|name| text(&format!("experiments/sweeps/{name}.toml")))
            .into(),
        _ => vec![text("results/gates.toml"), text("experiments/examples/own-gate/gates.toml")],
    }
}

/// The keys of a table that stands at a path of tables and lists.
fn keys_of(schema: &Value, path: &str) -> BTreeSet<String> {
    let at = path.split('.').filter(|part| !part.is_empty()).fold(schema, |table, part| {
        let inner = &table["properties"][part];
        // Of several forms, the first.
        let inner = if inner["anyOf"].is_array() { &inner["anyOf"][0] } else { inner };
        if inner["type"] == "array" { &inner["items"] } else { inner }
    });
    at["properties"].as_object().unwrap_or_else(|| panic!("{path}: no table")).keys().cloned().collect()
}

/// The keys that a reader says it knows, when it is given one that nobody knows.
fn keys_known(kind: &str, text: &str) -> BTreeSet<String> {
    let error = read(kind, text).expect_err(text);
    let (_, known) = error.split_once("known keys: ").unwrap_or_else(|| panic!("{text}: {error}"));
    known.split(", ").map(str::to_owned).collect()
}

#[test]
fn every_file_that_is_shipped_is_accepted() {
    for kind in KINDS {
        let judge = Judge::of(kind);
        for text in shipped(kind).iter().filter(|text| !text.contains("counting")) {
            read(kind, text).unwrap_or_else(|error| panic!("{error}"));
            judge.accepts(text).unwrap_or_else(|error| panic!("{kind}: {error}\n{text}"));
        }
    }
}

#[test]
fn schemas_have_the_keys_that_readers_know() {
    let scene = [
        ("", "zzz = 1\n"),
        ("bounds", "[bounds]\nzzz = 1\n"),
        ("grid", "[grid]\nzzz = 1\n"),
        ("map", "[map]\nzzz = 1\n"),
        ("plan", "[plan]\nzzz = 1\n"),
        ("wall", "[[wall]]\nzzz = 1\n"),
        ("wall.seen_by", "[[wall]]\nseen_by = { zzz = 1 }\n"),
        ("box", "[[box]]\nzzz = 1\n"),
        ("disc", "[[disc]]\nzzz = 1\n"),
        ("polygon", "[[polygon]]\nzzz = 1\n"),
        ("route", "[route]\nzzz = 1\n"),
        ("stage", "[[stage]]\nzzz = 1\n"),
        ("mover", "[[mover]]\nzzz = 1\n"),
        ("door", "[[door]]\nzzz = 1\n"),
        ("chair", "[[chair]]\nzzz = 1\n"),
        ("chair.moves", "[[chair]]\nmoves = [{ zzz = 1 }]\n"),
        ("region", "[[region]]\nzzz = 1\n"),
        ("camera", "[camera]\nzzz = 1\n"),
        ("sensor", "[sensor]\nzzz = 1\n"),
        ("robot", "[robot]\nzzz = 1\n"),
        ("odometry", "[odometry]\nzzz = 1\n"),
    ];
    let mut paths: BTreeSet<String> = keys_of(&schema_of("scene"), "");
    for (path, text) in scene {
        // What is missing beside the unknown key is told after it.
        let errors = Scene::examine(text, Path::new("t.toml"), None).expect_err("unknown key");
        let unknown = errors.iter().map(ToString::to_string).find(|error| error.contains("unknown key `zzz`"));
        let unknown = unknown.unwrap_or_else(|| panic!("{path}"));
        let (_, known) = unknown.split_once("known keys: ").expect("listed");
        let known: BTreeSet<String> = known.split(", ").map(str::to_owned).collect();
        assert_eq!(keys_of(&schema_of("scene"), path), known, "{path}");
        paths.remove(path);
    }
    assert_eq!(
        paths,
        BTreeSet::from(["name", "description", "waypoints", "motion_seed"].map(str::to_owned)),
        "tables not tried"
    );
    for (number, kind) in SensorKind::ALL.iter().enumerate() {
        let text = format!("[[sensor]]\nkind = \"{}\"\nzzz = 1\n", kind.name());
        let errors = Scene::examine(&text, Path::new("t.toml"), None).expect_err("unknown key");
        let unknown = errors.iter().map(ToString::to_string).find(|error| error.contains("unknown key `zzz`"));
        let (_, known) = unknown.as_deref().and_then(|text| text.split_once("known keys: ")).expect("listed");
        let schema = schema_of("scene");
        let of_kind = &schema["properties"]["sensor"]["anyOf"][1]["items"]["oneOf"][number]["properties"];
        let keys: BTreeSet<&str> = of_kind.as_object().expect("a table").keys().map(String::as_str).collect();
        assert_eq!(keys, known.split(", ").collect(), "{kind:?}");
    }
    let text = "name = \"f\"\n[generate]\nzzz = 1\nkind = \"corridor\"\n";
    assert_eq!(keys_of(&schema_of("family"), "generate"), keys_known("family", text));
    assert_eq!(keys_of(&schema_of("family"), ""), keys_known("family", "zzz = 1\n"));
    let base = "scene = \"scenes/room.toml\"\nmappers = [\"visibility\"]\n";
    assert_eq!(keys_of(&schema_of("sweep"), ""), keys_known("sweep", "zzz = 1\n"));
    for table in ["seeds", "set", "vary", "paired"] {
        assert_eq!(keys_of(&schema_of("sweep"), table), keys_known("sweep", &format!("{base}[{table}]\nzzz = 1\n")));
    }
    assert_eq!(keys_of(&schema_of("gate"), ""), keys_known("gate", "zzz = 1\n"));
    assert_eq!(keys_of(&schema_of("gate"), "gate"), keys_known("gate", "[[gate]]\nzzz = 1\n"));
}

/// Every number of a text in the place of another that is far out of range, and every line with a key taken out or renamed: what
/// the schema refuses the reader refuses too, and unknown keys and wrong numbers are refused by both.
#[test]
fn what_a_schema_refuses_the_reader_refuses() {
    for kind in KINDS {
        let judge = Judge::of(kind);
        let (mut refused, mut both) = (0, 0);
        for text in shipped(kind).iter().filter(|text| !text.contains("counting") && !text.contains("UMA")) {
            let lines: Vec<&str> = text.lines().collect();
            for (number, line) in lines.iter().enumerate() {
                let Some((key, value)) = line.split_once(" = ").filter(|(key, _)| !key.starts_with('#')) else {
                    continue;
                };
                let mutants = [
                    format!("zz{key} = {value}"),
                    String::new(),
                    format!("{key} = true"),
                    format!("{key} = -1e9"),
                    format!("{key} = []"),
                    format!("{key} = \"\""),
                ];
                for (which, mutant) in mutants.iter().enumerate() {
                    let mut changed = lines.clone();
                    changed[number] = mutant;
                    let changed = changed.join("\n");
                    if changed.parse::<toml::Table>().is_err() {
                        continue;
                    }
                    let (schema, reader) = (judge.accepts(&changed), read(kind, &changed));
                    if let Err(error) = &schema {
                        assert!(reader.is_err(), "{kind}: `{line}` -> `{mutant}`: only the schema refuses: {error}");
                        refused += 1;
                    }
                    both += usize::from(schema.is_err() && which == 0);
                    // Names of waypoints are free, so that a stop or a stage is at fault, of which the schema knows nothing.
                    let free = key.len() == 1 || which > 0;
                    assert!(free || schema.is_err(), "{kind}: {line} -> {mutant}: {reader:?}");
                }
            }
        }
        assert!(refused > 20 && both > 3, "{kind}: {refused} {both}");
    }
}
