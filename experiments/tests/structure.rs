//! Files import from each other without circles, as far as they are drawn: imports with re-exports resolved, tests left out.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// A crate by its folder, and the order of its rooms, lowest first, where it has one: arrows point down.
const CRATES: &[(&str, &[&str])] = &[
    ("crates/grid", &[]),
    ("crates/sensor", &[]),
    (
        "crates/mapper",
        &["memory", "belief", "pairs", "ray", "tuning", "model", "mapper", "fast", "rules", "catalogue", ""],
    ),
    ("crates/logs", &[]),
    ("crates/scene", &[]),
    ("crates/score", &[]),
    ("experiments", &[]),
];

/// Crates that still have circles, until they are rebuilt.
const NOT_YET: &[&str] = &["crates/logs", "experiments"];

/// Number of files from which on a circle is one too large to be read as one piece.
const CIRCLE: usize = 3;

/// The files of a crate by module path, `fast::lines` for `src/fast/lines.rs`; the root is empty.
type Sources = BTreeMap<String, String>;

/// Which module imports which.
type Imports = BTreeMap<String, BTreeSet<String>>;

fn sources(folder: &Path) -> Sources {
    fn collect(folder: &Path, module: &str, found: &mut Sources) {
        for entry in fs::read_dir(folder).expect("a folder of sources") {
            let path = entry.expect("readable").path();
            let stem = path.file_stem().and_then(|stem| stem.to_str()).expect("UTF-8").to_owned();
            let inner = if module.is_empty() { stem.clone() } else { format!("{module}::{stem}") };
            if path.is_dir() {
                collect(&path, &inner, found);
            } else if path.extension().is_some_and(|extension| extension == "rs") && stem != "tests" && stem != "main" {
                let module = if stem == "lib" || stem == "mod" { module.to_owned() } else { inner };
                found.insert(module, fs::read_to_string(&path).expect("readable"));
            }
        }
    }
    let mut found = Sources::new();
    collect(&folder.join("src"), "", &mut found);
    found
}

/// A file without comments, strings of one line, and the tests at its end.
fn code(source: &str) -> String {
    let end = source.find("\n#[cfg(test)]\nmod tests {").unwrap_or(source.len());
    let line = |line: &str| {
        let code = line.split("//").next().unwrap_or_default();
        let parts: Vec<&str> = code.split('"').step_by(2).collect();
        parts.join("\"\"")
    };
    source[..end].lines().map(line).collect::<Vec<_>>().join("\n")
}

/// One path of a `use`, and the name that it has in the file.
#[derive(Debug, Clone, PartialEq)]
struct Use {
    path: Vec<String>,
    name: String,
    public: bool,
}

/// All paths of a tree such as `a::{b, c as d}`.
fn leaves(tree: &str, before: &[String], public: bool, found: &mut Vec<Use>) {
    let tree = tree.trim();
    if let Some((path, inner)) = tree.split_once('{') {
        let mut before = before.to_vec();
        before.extend(path.split("::").map(str::trim).filter(|part| !part.is_empty()).map(str::to_owned));
        let inner = inner.trim_end().strip_suffix('}').unwrap_or(inner);
        let (mut depth, mut from) = (0, 0);
        for (at, letter) in inner.char_indices().chain([(inner.len(), ',')]) {
            match letter {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    if !inner[from..at].trim().is_empty() {
                        leaves(&inner[from..at], &before, public, found);
                    }
                    from = at + 1;
                }
                _ => {}
            }
        }
        return;
    }
    let (path, alias) = tree.split_once(" as ").map_or((tree, None), |(path, alias)| (path, Some(alias.trim())));
    let mut path: Vec<String> =
        before.iter().cloned().chain(path.split("::").map(|part| part.trim().to_owned())).collect();
    if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    let name = alias.map(str::to_owned).or_else(|| path.last().cloned()).unwrap_or_default();
    found.push(Use { path, name, public });
}

/// Every `use`, and every path in the code that begins with `crate`, `super` or `self`.
fn uses(code: &str) -> Vec<Use> {
    let mut found = Vec::new();
    for statement in code.split(['\n', ';']).scan(String::new(), |open, line| {
        // A `use` may go over several lines, up to its semicolon.
        if open.is_empty() && !line.trim_start().starts_with("use ") && !line.contains(" use ") {
            return Some(None);
        }
        open.push_str(line);
        open.push(' ');
        let whole = open.matches('{').count() == open.matches('}').count();
        Some(whole.then(|| std::mem::take(open)))
    }) {
        let Some((visibility, tree)) = statement.as_deref().and_then(|statement| statement.split_once("use ")) else {
            continue;
        };
        leaves(tree, &[], visibility.trim_start().starts_with("pub"), &mut found);
    }
    for start in ["crate::", "super::", "self::"] {
        for (at, _) in code.match_indices(start) {
            if code[..at].ends_with(|letter: char| letter.is_alphanumeric() || letter == '_' || letter == ':') {
                continue;
            }
            let path: String =
                code[at..].chars().take_while(|c| c.is_alphanumeric() || *c == '_' || *c == ':').collect();
            let path: Vec<String> = path.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect();
            // Up to a brace it is part of a `use`, whose leaves are above.
            if !code[at..].starts_with(&format!("{}::{{", path.join("::"))) {
                found.push(Use { name: String::new(), path, public: false });
            }
        }
    }
    found
}

struct Drawing<'a> {
    modules: BTreeSet<&'a str>,
    uses: BTreeMap<&'a str, Vec<Use>>,
    macros: BTreeMap<String, &'a str>,
}

fn join(module: &str, name: &str) -> String {
    if module.is_empty() { name.to_owned() } else { format!("{module}::{name}") }
}

impl Drawing<'_> {
    /// The module in whose file a path leads to something; none outside the crate.
    fn resolve(&self, from: &str, path: &[String], depth: usize) -> Option<String> {
        let mut rest = path;
        let mut at = from.to_owned();
        let mut rooted = false;
        while let Some((first, after)) = rest.split_first() {
            match first.as_str() {
                "crate" => at.clear(),
                "self" => {}
                "super" => at = at.rsplit_once("::").map_or(String::new(), |(parent, _)| parent.to_owned()),
                _ => break,
            }
            (rest, rooted) = (after, true);
        }
        for (k, name) in rest.iter().enumerate() {
            let inner = join(&at, name);
            if self.modules.contains(inner.as_str()) {
                (at, rooted) = (inner, true);
                continue;
            }
            if !rooted {
                return None;
            }
            if let Some(file) = self.macros.get(name).filter(|_| at.is_empty()) {
                return Some((*file).to_owned());
            }
            let handed_on = self.uses.get(at.as_str()).into_iter().flatten().find(|other| other.name == *name);
            if let Some(other) = handed_on.filter(|_| depth < 8) {
                let path: Vec<String> = other.path.iter().chain(&rest[k + 1..]).cloned().collect();
                return self.resolve(&at, &path, depth + 1);
            }
            return Some(at);
        }
        rooted.then_some(at)
    }
}

fn imports(sources: &Sources) -> Imports {
    let codes: BTreeMap<&str, String> =
        sources.iter().map(|(module, source)| (module.as_str(), code(source))).collect();
    let mut macros = BTreeMap::new();
    for (module, code) in &codes {
        for after in code.split("macro_rules! ").skip(1) {
            macros.insert(after.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect(), *module);
        }
    }
    let drawing = Drawing {
        modules: sources.keys().map(String::as_str).collect(),
        uses: codes.iter().map(|(module, code)| (*module, uses(code))).collect(),
        macros,
    };
    let arrows = |module: &str| -> BTreeSet<String> {
        let own = drawing.uses.get(module).into_iter().flatten().filter(|other| !other.public);
        own.filter_map(|other| drawing.resolve(module, &other.path, 0)).filter(|to| to != module).collect()
    };
    sources.keys().map(|module| (module.clone(), arrows(module))).collect()
}

/// Groups of modules each of which leads to every other, the largest first.
fn circles(imports: &Imports) -> Vec<BTreeSet<&str>> {
    let reached = |from: &str| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from.to_owned()]);
        while let Some(module) = open.pop() {
            for to in imports.get(&module).into_iter().flatten() {
                if seen.insert(to.clone()) {
                    open.push(to.clone());
                }
            }
        }
        seen
    };
    let reached: BTreeMap<&str, BTreeSet<String>> = imports.keys().map(|from| (from.as_str(), reached(from))).collect();
    let circle = |of: &str| -> BTreeSet<&str> {
        let both = |other: &&str| reached[of].contains(*other) && reached[*other].contains(of);
        reached.keys().copied().filter(both).collect()
    };
    let found: BTreeSet<BTreeSet<&str>> = reached.keys().map(|of| circle(of)).filter(|c| c.len() > 1).collect();
    let mut found: Vec<_> = found.into_iter().collect();
    found.sort_by_key(|circle| std::cmp::Reverse(circle.len()));
    found
}

#[test]
fn no_crate_has_a_circle_of_three_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
    for (folder, rooms) in CRATES {
        let imports = imports(&sources(&root.join(folder)));
        assert!(imports.values().any(|to| !to.is_empty()), "{folder}: no import found");
        let large: Vec<_> = circles(&imports).into_iter().filter(|circle| circle.len() >= CIRCLE).collect();
        assert_eq!(!large.is_empty(), NOT_YET.contains(folder), "{folder}: {large:?}");
        let floor = |module: &str| {
            let room = module.split("::").next().unwrap_or_default();
            rooms.iter().position(|other| *other == room).unwrap_or_else(|| panic!("{folder}: {room} has no place"))
        };
        for (from, to) in imports.iter().flat_map(|(from, to)| to.iter().map(move |to| (from, to))) {
            assert!(rooms.is_empty() || floor(to) <= floor(from), "{folder}: {from} imports {to}, which is above it");
        }
    }
}

#[test]
fn circles_are_found_through_re_exports() {
    let files = [
        ("", "mod a;\nmod b;\nmod c;\npub use a::{A, inner::Deep};\npub use c::C as Other;\n"),
        ("a", "mod inner;\nuse crate::b::{self, B};\npub(crate) use inner::Deep as _;\n"),
        ("a::inner", "use super::A; // a circle of two\npub struct Deep;\n"),
        ("b", "fn f() -> usize { crate::Other::number(\"use crate::a::A\") }\n"),
        ("c", "use std::fmt;\n#[cfg(test)]\nmod tests {\n    use crate::b::B;\n}\n"),
    ];
    let sources: Sources = files.iter().map(|(module, source)| ((*module).to_owned(), (*source).to_owned())).collect();
    let open = imports(&sources);
    assert!(open["b"].contains("c") && open["a"].contains("b") && open["c"].is_empty(), "{open:?}");
    assert!(circles(&open).iter().all(|circle| circle.len() < CIRCLE), "{open:?}");
    let closed = Sources::from_iter(sources.into_iter().map(|(module, source)| {
        let more = if module == "c" { "use crate::{\n    Deep,\n};\n" } else { "" };
        (module, format!("{more}{source}"))
    }));
    let closed = imports(&closed);
    let found = circles(&closed);
    assert_eq!(found, [BTreeSet::from(["a", "a::inner", "b", "c"])], "{closed:?}");
}
