//! The keys of a YAML file, each value with its place.

use std::collections::HashMap;

use granit_parser::{ErrorKind, Event, Parser, ScalarStyle, ScanError, Span};
use strict::{LONGEST_REPORT, LONGEST_VALUE, excerpt};

/// A value as it stands in the file: numbers too, so that an error can quote them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Text {
    pub(super) value: String,
    /// Line and column, each from 1.
    pub(super) at: (usize, usize),
    /// In double quotes, where a backslash begins an escape.
    pub(super) escaped: bool,
}

/// What stands under a key.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Node {
    Text(Text),
    /// Nothing, or `null`.
    Nothing,
    List {
        items: Vec<Node>,
        at: (usize, usize),
    },
    Table {
        at: (usize, usize),
    },
}

impl Node {
    pub(super) fn at(&self) -> (usize, usize) {
        match self {
            Self::Text(text) => text.at,
            Self::List { at, .. } | Self::Table { at } => *at,
            Self::Nothing => (1, 1),
        }
    }
}

/// Why a text has no keys.
#[derive(Debug, PartialEq)]
pub(super) struct Fault {
    /// Line and column, each from 1.
    pub(super) at: (usize, usize),
    pub(super) problem: String,
    pub(super) remedy: &'static str,
}

/// How a map's file looks.
pub(super) const FORM: &str = "write one `key: value` per line, as map_server does";

const SLASHES: &str = "write file names with forward slashes, or in single quotes";

/// The keys of the text, with their values, in its order.
pub(super) fn keys(text: &str) -> Result<HashMap<String, Node>, Fault> {
    let mut reader = Reader { events: Parser::new_from_str(text), anchors: HashMap::new() };
    let mut keys = HashMap::new();
    let (first, span) = reader.content()?;
    match first {
        Event::MappingStart(..) => {}
        Event::StreamEnd => return Ok(keys),
        Event::Scalar(value, ScalarStyle::Plain, ..) if nothing(&value) => return Ok(keys),
        _ => return Err(fault(&span, "keys and values are needed here")),
    }
    loop {
        let (event, span) = reader.next()?;
        if event == Event::MappingEnd {
            break;
        }
        let (key, value) = (reader.node(event, &span)?, reader.following()?);
        if let Node::Text(Text { value: key, .. }) = key
            && keys.insert(key.clone(), value).is_some()
        {
            return Err(fault(&span, &format!("the key `{}` stands here a second time", excerpt(&key, LONGEST_VALUE))));
        }
    }
    match reader.content()? {
        (Event::StreamEnd, _) => Ok(keys),
        (Event::Scalar(value, ScalarStyle::Plain, ..), _) if nothing(&value) => Ok(keys),
        (_, span) => Err(fault(&span, "a second YAML document begins here")),
    }
}

/// Reads nodes out of events.
struct Reader<'a> {
    events: Parser<'a, granit_parser::StrInput<'a>>,
    /// Values with a name that others refer to.
    anchors: HashMap<usize, Node>,
}

impl<'a> Reader<'a> {
    fn next(&mut self) -> Result<(Event<'a>, Span), Fault> {
        match self.events.next_event() {
            Some(Ok(next)) => Ok(next),
            Some(Err(error)) => Err(syntax(&error)),
            None => Ok((Event::StreamEnd, Span::default())),
        }
    }

    /// The next event that is content, or the end.
    fn content(&mut self) -> Result<(Event<'a>, Span), Fault> {
        loop {
            match self.next()? {
                (Event::StreamStart | Event::DocumentStart(..) | Event::DocumentEnd, _) => {}
                content => return Ok(content),
            }
        }
    }

    fn following(&mut self) -> Result<Node, Fault> {
        let (event, span) = self.next()?;
        self.node(event, &span)
    }

    /// The node that begins with an event.
    fn node(&mut self, event: Event<'a>, span: &Span) -> Result<Node, Fault> {
        let at = at(span);
        let anchor = event.anchor_id();
        let node = match event {
            Event::Scalar(value, style, ..) => {
                if nothing(&value) && style == ScalarStyle::Plain {
                    Node::Nothing
                } else {
                    let escaped = style == ScalarStyle::DoubleQuoted;
                    Node::Text(Text { value: value.into_owned(), at, escaped })
                }
            }
            Event::SequenceStart(..) => {
                let mut items = Vec::new();
                loop {
                    let (event, span) = self.next()?;
                    if event == Event::SequenceEnd {
                        break Node::List { items, at };
                    }
                    // Lists in lists are not looked into: a value that names itself over and over would take all memory.
                    items.push(match self.node(event, &span)? {
                        Node::List { at, .. } => Node::Table { at },
                        item => item,
                    });
                }
            }
            Event::MappingStart(..) => loop {
                let (event, span) = self.next()?;
                if event == Event::MappingEnd {
                    break Node::Table { at };
                }
                self.node(event, &span)?;
            },
            Event::Alias(id) => self.anchors.get(&id).cloned().unwrap_or(Node::Nothing),
            _ => Node::Nothing,
        };
        if let Some(id) = anchor {
            self.anchors.insert(id, node.clone());
        }
        Ok(node)
    }
}

/// Whether a plain value stands for none.
fn nothing(value: &str) -> bool {
    ["", "~", "null", "Null", "NULL"].contains(&value)
}

fn at(span: &Span) -> (usize, usize) {
    (span.start.line().max(1), span.start.col() + 1)
}

fn fault(span: &Span, problem: &str) -> Fault {
    Fault { at: at(span), problem: problem.to_owned(), remedy: FORM }
}

fn syntax(error: &ScanError) -> Fault {
    let mark = error.marker();
    let remedy = match error.kind() {
        ErrorKind::UnknownQuotedScalarEscape | ErrorKind::InvalidQuotedScalarHexEscape => SLASHES,
        _ => FORM,
    };
    let problem = match remedy {
        SLASHES => "a backslash in double quotes begins an escape, and this one is none".to_owned(),
        _ => excerpt(&error.info(), LONGEST_REPORT),
    };
    Fault { at: (mark.line().max(1), mark.col() + 1), problem, remedy }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(value: &str, at: (usize, usize)) -> Node {
        Node::Text(Text { value: value.to_owned(), at, escaped: false })
    }

    #[test]
    fn values_stand_where_they_stand() {
        let keys = keys("# a map\n---\na: 1e3\nb: [x, 'y z', {q: 1}]\nc: &n 7\nd: *n\ne:\n  - 1\n  - [2]\nf:\ng: ~\n")
            .expect("YAML");
        assert_eq!(keys["a"], text("1e3", (3, 4)));
        let items = vec![text("x", (4, 5)), text("y z", (4, 8)), Node::Table { at: (4, 15) }];
        assert_eq!(keys["b"], Node::List { items, at: (4, 4) });
        assert_eq!(keys["d"], text("7", (5, 7)));
        let items = vec![text("1", (8, 5)), Node::Table { at: (9, 5) }];
        assert!(matches!(&keys["e"], Node::List { items: found, .. } if *found == items), "{:?}", keys["e"]);
        assert_eq!((&keys["f"], &keys["g"]), (&Node::Nothing, &Node::Nothing));
    }

    #[test]
    fn what_names_itself_takes_no_memory() {
        let deep = "[".repeat(100_000);
        keys(&deep).expect_err("too deep");
        let bomb: String = (1..40).map(|k| format!("k{k}: &a{k} [*a{0}, *a{0}, *a{0}]\n", k - 1)).collect();
        keys(&format!("k0: &a0 x\n{bomb}")).expect("YAML");
        let keys = keys("a: &a [*a, 1]\n");
        assert!(keys.is_err() || keys.is_ok_and(|keys| matches!(keys["a"], Node::List { .. })));
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "[-a:#\\[\\]{}&*'\"\\\\ \t\n,?|>!%0-9]{0,60}") {
            if let Err(fault) = keys(&text) {
                prop_assert!(fault.at.0 >= 1 && fault.at.1 >= 1 && !fault.problem.contains('\n'));
            }
        }
    }
}
