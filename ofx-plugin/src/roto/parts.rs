//! Selects parts by name.

use rototoon::scene::Part;

/// The indices of the parts that a list of names selects, in the document's order, and the names that select no part.
/// Names are separated by commas, and `*` matches any text. An empty list selects all parts.
pub fn selected<'a>(parts: &[Part], names: &'a str) -> (Vec<usize>, Vec<&'a str>) {
    let patterns = patterns(names);
    if patterns.is_empty() {
        return ((0..parts.len()).collect(), Vec::new());
    }
    let meant = |part: &Part| patterns.iter().any(|pattern| matches(pattern, &part.name));
    let indices = (0..parts.len()).filter(|&index| meant(&parts[index])).collect();
    let missing = patterns.iter().filter(|pattern| !parts.iter().any(|part| matches(pattern, &part.name)));
    (indices, missing.copied().collect())
}

/// The names in a list with commas. They may have `*` for any text.
pub fn patterns(names: &str) -> Vec<&str> {
    names.split(',').map(str::trim).filter(|name| !name.is_empty()).collect()
}

/// Whether a name matches a pattern.
pub fn matches(pattern: &str, name: &str) -> bool {
    let mut pieces = pattern.split('*');
    let first = pieces.next().unwrap_or_default();
    let Some(mut rest) = name.strip_prefix(first) else { return false };
    let Some(last) = pieces.next_back() else { return rest.is_empty() };
    for piece in pieces {
        let Some(at) = rest.find(piece) else { return false };
        rest = &rest[at + piece.len()..];
    }
    rest.ends_with(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_wildcards() {
        let parts: Vec<Part> = ["head", "near arm", "far arm", "größe"]
            .iter()
            .map(|name| Part { name: (*name).into(), ..Part::default() })
            .collect();
        for (names, indices, missing) in [
            ("", vec![0, 1, 2, 3], vec![]),
            (" , ", vec![0, 1, 2, 3], vec![]),
            ("far arm, head", vec![0, 2], vec![]),
            ("*arm", vec![1, 2], vec![]),
            ("*a*", vec![0, 1, 2], vec![]),
            ("n*a*m,gr*e", vec![1, 3], vec![]),
            ("leg, hea", vec![], vec!["leg", "hea"]),
            ("near armx*", vec![], vec!["near armx*"]),
            ("*", vec![0, 1, 2, 3], vec![]),
            ("head*head", vec![], vec!["head*head"]),
        ] {
            assert_eq!(selected(&parts, names), (indices, missing), "{names:?}");
        }
    }
}
