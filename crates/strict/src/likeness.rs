//! The known name that is most like a wrong one.

/// No known name is longer: the time and the memory that likeness takes grow with the length, in characters.
const LONGEST: usize = 64;

/// The known name that is most like what was written; nothing if none is known.
pub fn nearest<'k>(name: &str, known: impl IntoIterator<Item = &'k str>) -> &'k str {
    let name: String = name.chars().take(LONGEST).collect();
    let likeness = |known: &str| strsim::normalized_damerau_levenshtein(known, &name);
    known.into_iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b))).unwrap_or_default()
}

/// ` (did you mean ...?)` where a known name is near.
pub fn hint(name: &str, known: &[&str]) -> String {
    near(name, known).map(|near| format!(" (did you mean `{near}`?)")).unwrap_or_default()
}

/// The known name that is most like what was written, where it is near.
pub(crate) fn near<'k>(name: &str, known: &[&'k str]) -> Option<&'k str> {
    let letters = name.chars().take(LONGEST + 1).count();
    if letters > LONGEST {
        return None;
    }
    let away = |candidate: &str| strsim::damerau_levenshtein(&name.to_lowercase(), &candidate.to_lowercase());
    // A third of the letters may be wrong; of one or two letters, none or one.
    let most = (1 + letters / 3).min(letters.saturating_sub(1));
    let known = known.iter().copied().filter(|c| letters > 0 && c.len() <= 4 * LONGEST);
    known.map(|c| (away(c), c)).filter(|(away, _)| *away <= most).min().map(|(_, c)| c)
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOWN: [&str; 3] = ["width", "height", "x"];

    #[test]
    fn the_nearest_name_wins_and_what_is_unlike_all_gets_no_hint() {
        assert_eq!(nearest("widht", KNOWN), "width");
        assert_eq!(nearest("anything", []), "");
        assert_eq!(hint("Widht", &KNOWN), " (did you mean `width`?)");
        assert_eq!(hint("colour", &KNOWN), "");
        assert_eq!((hint("", &KNOWN), hint("y", &KNOWN)), (String::new(), String::new()));
        assert_eq!(hint(&"width".repeat(20_000), &KNOWN), "", "likeness to a long name is not measured");
    }
}
