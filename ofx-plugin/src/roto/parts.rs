//! Selects parts by name.

use rototoon::scene::Part;

/// The indices of the parts that a list of names selects, in the document's order, and the names that select no part.
/// Names are separated by commas, and `*` matches any text. An empty list selects all parts.
pub fn selected<'a>(parts: &[Part], names: &'a str) -> (Vec<usize>, Vec<&'a str>) {
    let patterns = patterns(names);
    if patterns.is_empty() {
        return ((0..parts.len()).collect(), Vec::new());
    }
    let (mut found, mut missing) = (vec![false; parts.len()], Vec::new());
    for pattern in patterns {
        let of = |name: fn(&Part) -> &str| parts.iter().map(|part| matches(pattern, name(part))).collect::<Vec<_>>();
        let mut meant = of(|part| &part.name);
        if !meant.contains(&true) {
            // Lists cannot have blanks at the ends of names, but documents can.
            meant = of(|part| part.name.trim());
        }
        if !meant.contains(&true) {
            missing.push(pattern);
        }
        found.iter_mut().zip(meant).for_each(|(found, meant)| *found |= meant);
    }
    ((0..parts.len()).filter(|&index| found[index]).collect(), missing)
}

/// The name of the part that a field means: the text, or the text without blanks around it, or a name that differs from it
/// only by such blanks. A text that means no part is returned without them.
pub fn meant<'a>(parts: &'a [Part], text: &'a str) -> &'a str {
    let name = text.trim();
    let equal = |wanted: &str| parts.iter().find(|part| part.name == wanted);
    let found = equal(text).or_else(|| equal(name)).or_else(|| parts.iter().find(|part| part.name.trim() == name));
    found.filter(|_| !name.is_empty()).map_or(name, |part| &part.name)
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

    #[test]
    fn names_may_have_blanks_at_their_ends() {
        let part = |name: &str| Part { name: name.into(), ..Part::default() };
        let (one, both) = ([part("arm "), part("leg")], [part("arm"), part("arm ")]);
        assert_eq!(
            ["arm", " arm ", "arm ", " leg", "", " ", " hat"].map(|text| meant(&one, text)),
            ["arm ", "arm ", "arm ", "leg", "", "", "hat"]
        );
        assert_eq!(["arm", "arm ", " arm"].map(|text| meant(&both, text)), ["arm", "arm ", "arm"]);
        assert_eq!((selected(&one, "arm").0, selected(&both, "arm").0), (vec![0], vec![0]));
    }
}
