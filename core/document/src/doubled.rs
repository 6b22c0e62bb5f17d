//! Fields that are given twice within fields that are kept as text: drawings, clicks, strokes.
//!
//! The reader of their values takes the last of two fields of one name. In a file that a person edits the other one was meant as often, and
//! what it held is gone with the next save.
//!
//! The text is known to be JSON. So a walk over its marks is enough: it keeps the names of the objects around a place, and passes over points, of
//! which a film has millions.

use std::collections::HashSet;

/// What is around a place of the text.
enum Around {
    /// A list, with the index of the present element.
    List(usize),
    /// An object, with the names that it has had, the last of them, and whether a name comes next.
    Object { names: HashSet<String>, last: String, expects_name: bool },
}

/// The first field that an object in the text of a JSON value has twice: its JSON path from the value on, such as `[3].strokes[0]`, and its name.
pub(super) fn first(json: &str) -> Option<(String, String)> {
    let bytes = json.as_bytes();
    let (mut around, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        match bytes[at] {
            b'[' => around.push(Around::List(0)),
            b'{' => {
                around.push(Around::Object { names: HashSet::new(), last: String::new(), expects_name: true });
            }
            b']' | b'}' => drop(around.pop()),
            b',' => match around.last_mut() {
                Some(Around::List(index)) => *index += 1,
                Some(Around::Object { expects_name, .. }) => *expects_name = true,
                None => {}
            },
            b'"' => {
                let end = end_of_text(bytes, at);
                if let Some(Around::Object { names, last, expects_name }) = around.last_mut()
                    && std::mem::take(expects_name)
                {
                    *last = serde_json::from_str(json.get(at..end)?).ok()?;
                    if !names.insert(last.clone()) {
                        let name = last.clone();
                        around.pop();
                        return Some((path(&around), name));
                    }
                }
                at = end;
                continue;
            }
            _ => {}
        }
        at += 1;
    }
    None
}

/// The byte after a text in quotation marks.
fn end_of_text(bytes: &[u8], start: usize) -> usize {
    let mut at = start + 1;
    while at < bytes.len() && bytes[at] != b'"' {
        at += if bytes[at] == b'\\' { 2 } else { 1 };
    }
    at + 1
}

fn path(around: &[Around]) -> String {
    let step = |around: &Around| match around {
        Around::List(index) => format!("[{index}]"),
        Around::Object { last, .. } => format!(".{last}"),
    };
    around.iter().map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_doubled_field_is_found_with_its_place() {
        for plain in ["[]", "3", r#"[{"a": "a"}, {"a": {"a": [1, "a", "b,"]}, "b\"": "{\"a\":", "b": null}]"#] {
            assert_eq!(first(plain), None, "{plain}");
        }
        let found = |json| first(json).unwrap();
        let pair = |place: &str, name: &str| (place.to_owned(), name.to_owned());
        assert_eq!(found(r#"{"a": 1, "b": 2, "a": 3}"#), pair("", "a"));
        assert_eq!(
            found(r#"[{}, {"strokes": [{"points": [[1, 2]], "points": []}]}]"#),
            pair("[1].strokes[0]", "points")
        );
        assert_eq!(found(r#"{"x": {"\u0061\\": {}, "a\\": "]"}}"#), pair(".x", "a\\"));
    }

    #[test]
    fn documents_with_doubled_fields_are_refused() {
        let read = |other: &str| {
            let footage = r#"{"pattern": "%d.png", "first": 0, "last": 4, "fps": 24, "width": 8, "height": 8}"#;
            let json = format!(r#"{{"rototoon": 1, "footage": {footage}, "parts": [], {other}}}"#);
            crate::Document::parse(&json, "p.json").map(drop).map_err(|error| error.lines())
        };
        for (other, place) in [
            (r#""drawings": [{"frame": 1, "strokes": [], "strokes": []}]"#, "drawings[0]: found the field \"strokes\""),
            (r#""palette": {"red": [1, 0, 0], "red": [0, 1, 0]}"#, "palette: found the field \"red\""),
            (
                r#""fills": [{"frame": 1, "regions": [{"at": [1, 1], "at": [2, 2]}]}]"#,
                "fills[0].regions[0]: found the field \"at\"",
            ),
            (r#""traced": [{"frame": 1, "frame": 2}]"#, "traced[0]: found the field \"frame\""),
        ] {
            assert_eq!(read(other), Err(vec![format!("p.json: {place} twice, expected it once")]), "{other}");
        }
        assert_eq!(read(r#""notes of others": {"a": 1, "a": 2}, "limbs": []"#), Ok(()), "nobody reads it");
    }
}
