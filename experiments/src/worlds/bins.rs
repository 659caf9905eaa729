//! Bins of what is known of a cell, in words.

/// A bin from its lower edge, included, to its upper one, not included: `1-1.5`, or `8-` of an open one.
pub fn ends(edges: [f64; 2]) -> String {
    if edges[1].is_finite() { format!("{}-{}", edges[0], edges[1]) } else { format!("{}-", edges[0]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_open_bin_has_no_upper_end() {
        assert_eq!([[1.0, 1.5], [8.0, f64::INFINITY]].map(ends), ["1-1.5", "8-"]);
    }
}
