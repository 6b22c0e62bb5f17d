//! Escaping of text for XML.

/// Escapes text for element contents and attributes. Characters that XML does not allow are left out.
pub fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            // As they are, a reader makes spaces of them in attributes.
            '\t' | '\n' | '\r' => out += &format!("&#{};", u32::from(c)),
            c if is_allowed(c) => out.push(c),
            _ => {}
        }
    }
    out
}

/// Text without the characters that XML does not allow.
pub(super) fn plain(text: &str) -> String {
    text.chars().filter(|c| is_allowed(*c)).collect()
}

fn is_allowed(c: char) -> bool {
    "\t\n\r".contains(c) || (c >= ' ' && c != '\u{fffe}' && c != '\u{ffff}')
}
