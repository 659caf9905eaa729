//! Which file of a crate imports which, re-exports resolved.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The files that each file imports, by their module paths (`a::b`; the root is `lib`).
pub(crate) type Arrows = BTreeMap<String, BTreeSet<String>>;

/// Names from the root of the crate.
type Names = Vec<String>;

/// A file that is a module.
struct Module {
    /// Every path in it, as it stands there.
    paths: Vec<Names>,
    /// What local names stand for: a path as it stands in the file.
    names: BTreeMap<String, Names>,
}

/// Draws the arrows of the sources below a folder. Neither the declaration of a child nor the publication of what a
/// child holds is an import; tests do not count.
pub(crate) fn arrows(src: &Path) -> Arrows {
    let mut modules = BTreeMap::new();
    collect(src, &mut Vec::new(), &mut modules);
    let targets = |place: &Names, module: &Module| {
        let files = module.paths.iter().filter_map(|path| resolve(&modules, place, path, 0));
        files.filter(|file| file != place).map(|file| name(&file)).collect()
    };
    modules.iter().map(|(place, module)| (name(place), targets(place, module))).collect()
}

fn name(place: &[String]) -> String {
    if place.is_empty() { "lib".to_owned() } else { place.join("::") }
}

fn collect(folder: &Path, place: &mut Names, modules: &mut BTreeMap<Names, Module>) {
    for entry in fs::read_dir(folder).expect("a folder of sources").map(|entry| entry.expect("an entry").path()) {
        let stem = entry.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if entry.is_dir() {
            place.push(stem);
            collect(&entry, place, modules);
            place.pop();
        } else if entry.extension().is_some_and(|e| e == "rs") && stem != "tests" && stem != "main" {
            let own = if matches!(stem.as_str(), "lib" | "mod") { None } else { Some(stem) };
            let text = fs::read_to_string(&entry).expect("UTF-8");
            modules.insert(place.iter().cloned().chain(own).collect(), Module::of(&without_tests(&tokens(&text))));
        }
    }
}

/// The file in which a path ends that stands in the file at `place`; none of another crate's.
fn resolve(modules: &BTreeMap<Names, Module>, place: &Names, path: &[String], depth: usize) -> Option<Names> {
    let (first, rest) = path.split_first()?;
    let (mut file, mut rest) = match first.as_str() {
        "crate" => (Names::new(), rest),
        "self" => (place.clone(), rest),
        "super" => (place[..place.len().checked_sub(1)?].to_vec(), rest),
        _ => (place.clone(), path),
    };
    let started_here = file == *place && rest.len() == path.len();
    while let Some((next, after)) = rest.split_first() {
        let child: Names = file.iter().chain([next]).cloned().collect();
        let known = modules.get(&file).and_then(|module| module.names.get(next)).filter(|_| depth < 20);
        if next == "super" {
            file.pop()?;
        } else if modules.contains_key(&child) {
            file = child;
        } else if let Some(known) = known.filter(|known| known.as_slice() != path) {
            let long: Names = known.iter().chain(after).cloned().collect();
            return resolve(modules, &file, &long, depth + 1);
        } else {
            return (!started_here || file != *place).then_some(file);
        }
        rest = after;
    }
    Some(file)
}

/// Names, and signs one by one but for `::`; without comments and without what stands in quotes.
fn tokens(text: &str) -> Vec<String> {
    let (mut tokens, mut rest) = (Vec::new(), text);
    while let Some(next) = rest.chars().next() {
        let raw = rest.strip_prefix('r').map(|rest| rest.trim_start_matches('#')).filter(|rest| rest.starts_with('"'));
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if let Some(quoted) = raw {
            let hashes = rest.len() - quoted.len() - 1;
            let end = format!("\"{}", "#".repeat(hashes));
            2 + hashes + quoted[1..].find(&end).map_or(0, |at| at + end.len())
        } else if next == '"' {
            let mut escaped = false;
            let end = rest.bytes().skip(1).position(|byte| {
                let ends = byte == b'"' && !escaped;
                escaped = byte == b'\\' && !escaped;
                ends
            });
            end.map_or(rest.len(), |end| end + 2)
        } else if let Some(sign) = ["'\"'", "'\\\"'", "'{'", "'}'", "'/'"].iter().find(|sign| rest.starts_with(**sign))
        {
            sign.len()
        } else if next.is_alphanumeric() || next == '_' {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            tokens.push(rest[..end].to_owned());
            end
        } else {
            let sign = if rest.starts_with("::") { "::" } else { &rest[..next.len_utf8()] };
            if !next.is_whitespace() {
                tokens.push(sign.to_owned());
            }
            sign.len()
        };
        rest = &rest[length..];
    }
    tokens
}

/// The tokens without the items that only tests have.
fn without_tests(tokens: &[String]) -> Vec<String> {
    let mark = ["#", "[", "cfg", "(", "test", ")", "]"];
    let (mut kept, mut at) = (Vec::new(), 0);
    while at < tokens.len() {
        if !tokens[at..].iter().take(mark.len()).eq(mark) {
            kept.push(tokens[at].clone());
            at += 1;
            continue;
        }
        let mut depth = 0;
        let end = tokens[at + mark.len()..].iter().position(|token| {
            depth += i32::from(token == "{") - i32::from(token == "}");
            depth == 0 && (token == "}" || token == ";")
        });
        at += mark.len() + end.map_or(tokens.len(), |end| end + 1);
    }
    kept
}

impl Module {
    fn of(tokens: &[String]) -> Self {
        let mut module = Self { paths: Vec::new(), names: BTreeMap::new() };
        let mut at = 0;
        while at < tokens.len() {
            let before = at.checked_sub(1).map(|at| tokens[at].as_str());
            if tokens[at] == "use" {
                let published = matches!(before, Some("pub" | ")"));
                let end = tokens[at..].iter().position(|token| token == ";").map_or(tokens.len(), |end| at + end);
                module.tree(&tokens[at + 1..end], &[], published);
                at = end;
            } else if tokens.get(at + 1).is_some_and(|next| next == "::") && !matches!(before, Some("::" | ".")) {
                let mut path = vec![tokens[at].clone()];
                while tokens.get(at + 1).is_some_and(|next| next == "::") {
                    path.extend(tokens.get(at + 2).filter(|token| token.starts_with(char::is_alphabetic)).cloned());
                    at += 2;
                }
                module.paths.push(path);
            }
            at += 1;
        }
        module
    }

    /// Takes in what a statement `use` names after `before`. What is published of a child is no import.
    fn tree(&mut self, tokens: &[String], before: &[String], published: bool) {
        let mut path = before.to_vec();
        let mut rest = tokens;
        while let Some((token, after)) = rest.split_first() {
            match token.as_str() {
                "{" => return parts(after).into_iter().for_each(|part| self.tree(part, &path, published)),
                "as" | "*" => break,
                "::" => {}
                _ => path.push(token.clone()),
            }
            rest = after;
        }
        if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
            path.pop();
        }
        let Some(last) = path.last() else { return };
        let local = rest.get(1).filter(|_| rest[0] == "as").unwrap_or(last).clone();
        if !published || matches!(path[0].as_str(), "crate" | "super") {
            self.paths.push(path.clone());
        }
        if rest.first().is_none_or(|token| token != "*") {
            self.names.insert(local, path);
        }
    }
}

/// The parts of a list, up to the brace that closes it.
fn parts(tokens: &[String]) -> Vec<&[String]> {
    let (mut parts, mut depth, mut start) = (Vec::new(), 0, 0);
    for (at, token) in tokens.iter().enumerate() {
        if depth == 0 && (token == "," || token == "}") {
            parts.push(&tokens[start..at]);
            start = at + 1;
        }
        depth += i32::from(token == "{") - i32::from(token == "}");
        if depth < 0 {
            break;
        }
    }
    parts
}
