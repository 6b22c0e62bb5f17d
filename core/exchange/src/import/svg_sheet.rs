//! Style sheets of SVG documents, as far as they matter for outlines.
//!
//! Rules at the top of a sheet are read, and those of `@media` for all media or for screens. Of a rule only the properties are kept that an
//! import asks for ([`READ`]). What has such properties and is not read is told: selectors of kinds that `svg_selector` lacks, conditions, and sheets
//! in other files.
//!
//! A rule that is wrong ends where its braces do, and a declaration that is wrong at its semicolon, as in browsers. So they take no other ones with them.
//!
//! Source: W3C, CSS Syntax Module Level 3.

use super::svg_selector::Selector;

/// The properties that an import asks for.
pub(super) const READ: [&str; 26] = [
    "display",
    "opacity",
    "visibility",
    "fill",
    "fill-opacity",
    "fill-rule",
    "transform",
    "transform-origin",
    "transform-box",
    "clip-path",
    "mask",
    "x",
    "y",
    "cx",
    "cy",
    "r",
    "rx",
    "ry",
    "width",
    "height",
    "translate",
    "rotate",
    "scale",
    "offset-path",
    "animation",
    "animation-name",
];
/// Rules that say nothing of outlines.
const HARMLESS: [&str; 6] = ["charset", "font-face", "namespace", "page", "font-feature-values", "counter-style"];

/// A declaration of a sheet.
#[derive(Clone, Debug)]
pub(super) struct Rule {
    pub selector: Selector,
    pub property: &'static str,
    pub value: String,
    pub important: bool,
}

/// What a sheet says.
#[derive(Debug, Default)]
pub(super) struct Sheet {
    pub rules: Vec<Rule>,
    /// What is not read and may matter.
    pub unread: Vec<String>,
}

impl Sheet {
    /// Reads the text of a sheet.
    pub fn read(text: &str) -> Self {
        let mut sheet = Self::default();
        sheet.add(&without_comments(text), true);
        sheet
    }

    /// Reads rules. Only those at the `top` may have conditions around them.
    fn add(&mut self, text: &str, top: bool) {
        let mut rest = text;
        loop {
            // What hid a sheet from browsers that had none.
            rest = rest.trim_start_matches(|c: char| c.is_whitespace() || c == '}' || c == ';');
            rest = rest.strip_prefix("<!--").or_else(|| rest.strip_prefix("-->")).unwrap_or(rest).trim_start();
            if rest.is_empty() {
                return;
            }
            let special = rest.starts_with('@');
            let Some(at) = outside(rest, if special { "{;" } else { "{" }) else { return };
            let (head, after) = (rest[..at].trim(), &rest[at + 1..]);
            if rest.as_bytes()[at] == b';' {
                self.special(head, "", top);
                rest = after;
                continue;
            }
            let (body, behind) = block(after);
            if special {
                self.special(head, body, top);
            } else {
                self.rule(head, body);
            }
            rest = behind;
        }
    }

    /// Reads a rule that begins with `@`.
    fn special(&mut self, head: &str, body: &str, top: bool) {
        let end = head[1..].find(|c: char| !(c.is_alphanumeric() || c == '-')).map_or(head.len(), |end| end + 1);
        let (name, condition) = (head[1..end].to_ascii_lowercase(), head[end..].trim().to_ascii_lowercase());
        let is_for_all =
            || condition.split(',').any(|media| ["", "all", "screen", "only screen"].contains(&media.trim()));
        if name == "media" && top && is_for_all() {
            self.add(body, false);
        } else if name == "media" && condition == "print" {
            // It says nothing of what a screen shows.
        } else if name == "import" || matters(body) && !HARMLESS.contains(&name.as_str()) {
            self.unread.push(head.to_owned());
        }
    }

    fn rule(&mut self, head: &str, body: &str) {
        if !matters(body) {
            return;
        }
        for text in split(head, ',') {
            let Some(selector) = Selector::read(text) else {
                self.unread.push(text.trim().to_owned());
                continue;
            };
            for (name, value, important) in declarations(body) {
                let Some(property) = READ.into_iter().find(|read| *read == name) else { continue };
                self.rules.push(Rule { selector: selector.clone(), property, value: value.to_owned(), important });
            }
        }
    }
}

/// Whether a body of rules or declarations has a property that is asked for.
fn matters(body: &str) -> bool {
    let has = |text: &str| declarations(text).any(|(name, ..)| READ.contains(&name.as_str()));
    has(body) || body.split(['{', '}']).any(has)
}

/// The declarations in a text: properties in small letters, values, and whether they are important.
pub(super) fn declarations(text: &str) -> impl Iterator<Item = (String, &str, bool)> {
    split(text, ';').filter_map(|text| {
        let (name, value) = text.split_once(':')?;
        let (value, important) = match value.rsplit_once('!') {
            Some((own, word)) if word.trim().eq_ignore_ascii_case("important") => (own, true),
            _ => (value, false),
        };
        Some((name.trim().to_ascii_lowercase(), value.trim(), important))
    })
}

/// The pieces of a text between separators that are in no quotation and no brackets.
fn split(text: &str, between: char) -> impl Iterator<Item = &str> {
    let mut rest = Some(text);
    std::iter::from_fn(move || {
        let own = rest?;
        let end = outside(own, between.encode_utf8(&mut [0; 4]));
        rest = end.map(|end| &own[end + between.len_utf8()..]);
        Some(end.map_or(own, |end| &own[..end]))
    })
}

/// Where the first of these characters is that is in no quotation and no brackets. They are ASCII.
fn outside(text: &str, wanted: &str) -> Option<usize> {
    let (mut quote, mut brackets, mut escaped) = (None, 0usize, false);
    for (at, c) in text.bytes().enumerate() {
        if std::mem::take(&mut escaped) {
            continue;
        }
        match (quote, c) {
            (_, b'\\') => escaped = true,
            // A quotation ends with its line.
            (Some(_), b'\n') => quote = None,
            (Some(own), _) if own == c => quote = None,
            (Some(_), _) => {}
            (None, b'"' | b'\'') => quote = Some(c),
            (None, b'(' | b'[') => brackets += 1,
            (None, b')' | b']') => brackets = brackets.saturating_sub(1),
            (None, _) if brackets == 0 && wanted.as_bytes().contains(&c) => return Some(at),
            _ => {}
        }
    }
    None
}

/// The text up to the brace that closes a block, and what is behind it.
fn block(text: &str) -> (&str, &str) {
    let (mut depth, mut from) = (0usize, 0);
    while let Some(at) = outside(&text[from..], "{}").map(|at| from + at) {
        match (text.as_bytes()[at], depth) {
            (b'{', _) => depth += 1,
            (_, 0) => return (&text[..at], &text[at + 1..]),
            _ => depth -= 1,
        }
        from = at + 1;
    }
    (text, "")
}

fn without_comments(sheet: &str) -> String {
    let mut pieces = sheet.split("/*");
    let first = pieces.next().unwrap_or("").to_owned();
    pieces.fold(first, |text, piece| text + piece.split_once("*/").map_or("", |(_, after)| after))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Vec<String>, Vec<String>) {
        let Sheet { rules, unread } = Sheet::read(text);
        let rule = |rule: &Rule| format!("{} {}{}", rule.property, rule.value, if rule.important { " !" } else { "" });
        (rules.iter().map(rule).collect(), unread)
    }

    #[test]
    fn rules_are_read_and_wrong_ones_take_no_others_with_them() {
        let (rules, unread) = read(
            "<!-- @charset \"utf-8\"; @font-face{src:url(a;b);transform:none} /* .a{display:none} */ .a , .b{fill:red;x;FILL:none ! Important}\n\
             .c{background:url(data:image/png;base64,AA==);content:\"}{;\";opacity:0} .d{} .e{color:red} @media screen{.f{mask:none}} \
             } .g{display:none} -->",
        );
        let a = ["fill red", "fill none !"];
        assert_eq!(rules, [&a[..], &a, &["opacity 0", "mask none", "display none"]].concat());
        assert!(unread.is_empty(), "{unread:?}");
    }

    #[test]
    fn what_is_not_read_and_may_matter_is_told() {
        let (rules, unread) = read(
            "@import 'a.css'; a + .b, .c{fill:none} .d + .e{color:red} @media (width>9px){.f{display:none}} @media print{.f{fill:none}} @media tv{.g{color:red}} \
             @supports (x:y){.h{opacity:0}} @media all{@media screen{.i{opacity:0}}} .j:not(.k){fill:red}",
        );
        assert_eq!(rules, ["fill none"]);
        let expected =
            ["@import 'a.css'", "a + .b", "@media (width>9px)", "@supports (x:y)", "@media screen", ".j:not(.k)"];
        assert_eq!(unread, expected);
    }
}
