//! Which encoding a file has that is not UTF-8, so that a message can say how to save it.

/// The encoding that a file names at its beginning, by a mark or in the header of XML; `None` if it names none, or UTF-8.
pub(super) fn foreign_encoding(bytes: &[u8]) -> Option<String> {
    const HEADER: usize = 200;
    match bytes {
        [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] => return Some("UTF-16".to_owned()),
        // XML and JSON without a mark.
        [b'<' | b'{' | b'[', 0, ..] | [0, b'<' | b'{' | b'[', ..] => return Some("UTF-16".to_owned()),
        _ => {}
    }
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEADER)]);
    let header = head.trim_start_matches('\u{feff}').strip_prefix("<?xml")?.split("?>").next()?;
    let value = header.split_once("encoding")?.1.trim_start().strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|c| "'\"".contains(*c))?;
    let (name, _) = value[1..].split_once(quote)?;
    let is_name = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || "._-:".contains(c));
    (is_name && !name.eq_ignore_ascii_case("utf-8")).then(|| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_names_its_encoding() {
        let named = |bytes: &[u8]| foreign_encoding(bytes);
        assert_eq!(
            named(b"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><svg id=\"\xFC\"/>").as_deref(),
            Some("ISO-8859-1")
        );
        assert_eq!(named(b"<?xml version='1.0' encoding = 'windows-1252' ?>").as_deref(), Some("windows-1252"));
        for utf16 in [&[0xFF, 0xFE, b'<', 0][..], &[0xFE, 0xFF, 0, b'<'], b"<\0?\0", b"\0<\0?", b"{\0\"\0", b"\0["] {
            assert_eq!(named(utf16).as_deref(), Some("UTF-16"));
        }
        for none in [
            &b""[..],
            b"<",
            b"<?xml encoding=\"UTF-8\"?>",
            b"<?xml?> encoding='a'",
            b"<?xml encoding='\xFF'?>",
            b"Roto {",
            b"<?xml encoding=",
        ] {
            assert_eq!(named(none), None, "{none:?}");
        }
    }
}
