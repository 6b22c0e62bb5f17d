//! The words and signs of a Rust source: comments, texts and tests left out.

/// The tokens of a source: identifiers, numbers, `::`, and every other sign by itself. Comments are left out, a text is one
/// `"`, and a lifetime is its name.
pub fn tokens(source: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut rest = source;
    while let Some(first) = rest.chars().next() {
        let length = passed_over(rest).unwrap_or_else(|| {
            let length = token_length(rest, first);
            let text = if quoted(rest).is_some() { "\"" } else { &rest[..length] };
            found.push(text.to_owned());
            length
        });
        rest = &rest[length..];
    }
    found
}

/// Bytes of the space, the comment or the sign of a lifetime at the start; none where there is none.
fn passed_over(rest: &str) -> Option<usize> {
    if rest.starts_with("//") {
        return Some(rest.find('\n').unwrap_or(rest.len()));
    }
    if rest.starts_with("/*") {
        return Some(block_comment(rest));
    }
    let first = rest.chars().next()?;
    (first.is_whitespace() || first == '\'' && quoted(rest).is_none()).then(|| first.len_utf8())
}

fn token_length(rest: &str, first: char) -> usize {
    if let Some(length) = quoted(rest) {
        return length;
    }
    if rest.starts_with("::") {
        return 2;
    }
    let word = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
    word.max(first.len_utf8())
}

/// Bytes of a block comment, which may hold others.
fn block_comment(rest: &str) -> usize {
    let (mut depth, mut at) = (0, 0);
    loop {
        let next = |sign: &str| rest[at..].find(sign).map(|offset| at + offset);
        match (next("/*"), next("*/")) {
            (Some(opens), Some(closes)) if opens < closes => (depth, at) = (depth + 1, opens + 2),
            (_, Some(closes)) => (depth, at) = (depth - 1, closes + 2),
            (_, None) => return rest.len(),
        }
        if depth == 0 {
            return at;
        }
    }
}

/// Bytes of the text or character at the start; none where there is none.
fn quoted(rest: &str) -> Option<usize> {
    let body = rest.trim_start_matches(['b', 'c']);
    let prefix = rest.len() - body.len();
    if prefix > 1 {
        return None;
    }
    if let Some(raw) = body.strip_prefix('r') {
        let hashes = raw.len() - raw.trim_start_matches('#').len();
        let inner = raw[hashes..].strip_prefix('"')?;
        let end = format!("\"{}", "#".repeat(hashes));
        return Some(prefix + 2 + hashes + inner.find(&end)? + end.len());
    }
    let quote = body.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    let mut escaped = false;
    for (at, c) in body.char_indices().skip(1) {
        // A lifetime has no second quote behind its first character.
        if quote == '\'' && !escaped && c != quote && at > 1 && !body[1..].starts_with('\\') {
            return None;
        }
        if c == quote && !escaped {
            return Some(prefix + at + 1);
        }
        escaped = c == '\\' && !escaped;
    }
    None
}

/// The tokens without the items that are compiled for tests only.
pub fn without_tests(tokens: Vec<String>) -> Vec<String> {
    const MARK: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let mut kept = Vec::with_capacity(tokens.len());
    let mut at = 0;
    while at < tokens.len() {
        let marked = tokens[at..].iter().zip(MARK).filter(|(token, mark)| token == mark).count() == MARK.len();
        if marked {
            at = end_of_item(&tokens, at + MARK.len());
        } else {
            kept.push(tokens[at].clone());
            at += 1;
        }
    }
    kept
}

/// The place behind the item that starts at `at`: behind its `;` or its last brace.
fn end_of_item(tokens: &[String], mut at: usize) -> usize {
    let mut depth = 0;
    while at < tokens.len() {
        match tokens[at].as_str() {
            "{" | "(" | "[" => depth += 1,
            ")" | "]" => depth -= 1,
            "}" if depth == 1 => return at + 1,
            "}" => depth -= 1,
            ";" if depth == 0 => return at + 1,
            _ => {}
        }
        at += 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_texts_and_lifetimes_are_recognised() {
        let of = |source: &str| tokens(source).join(" ");
        assert_eq!(of("use a::b; // c::d\n/* e /* f */ g */ h"), "use a :: b ; h");
        assert_eq!(of(r##"f("a::\"b", r#"c"d"#, b"e", '"', '\'', x)"##), "f ( \" , \" , \" , \" , \" , x )");
        assert_eq!(of("fn f<'a>(x: &'a str, y: &'static T)"), "fn f < a > ( x : & a str , y : & static T )");
        assert_eq!(of("branch(crate::r) b c"), "branch ( crate :: r ) b c");
    }

    #[test]
    fn tests_are_left_out() {
        let of = |source: &str| without_tests(tokens(source)).join(" ");
        assert_eq!(of("a; #[cfg(test)] mod tests { use super::*; fn f() { x(); } } b"), "a ; b");
        assert_eq!(of("#[cfg(test)] mod tests; fn b() {}"), "fn b ( ) { }");
        assert_eq!(of("#[cfg(test)] #[derive(A)] struct B(C); d"), "d");
    }
}
