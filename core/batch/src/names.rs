//! Names in the folder of the results: those that belong to the batch, and what a name of a shot or of a result may be.
//!
//! A farm's machines are of several systems, so a name must be one on all of them.

/// Name of the page.
pub const PAGE: &str = "index.html";
/// Name of the summary.
pub const SUMMARY: &str = "summary.json";
/// Name of the report, where no other is asked for.
pub const REPORT: &str = "report.jsonl";
/// Names that belong to the batch.
pub const RESERVED: [&str; 3] = [PAGE, SUMMARY, REPORT];
/// Names that stand for devices on Windows, with any ending.
const DEVICES: [&str; 6] = ["CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$"];
/// The same with a digit.
const NUMBERED: [&str; 2] = ["COM", "LPT"];
/// Greatest number of bytes of a name.
const LONGEST: usize = 120;

/// Checks a name that becomes that of a file or folder on any system.
///
/// # Errors
///
/// What was expected.
pub fn safe_name(name: &str) -> Result<(), String> {
    let wrong = |c: char| c.is_control() || "/\\:*?\"<>|".contains(c);
    if name.is_empty() || name.len() > LONGEST {
        return Err(format!("a name of 1 to {LONGEST} bytes"));
    }
    if name.contains(wrong) {
        return Err("a name without / \\ : * ? \" < > |".into());
    }
    if name.starts_with('.') || name.ends_with(['.', ' ']) {
        return Err("a name that does not begin with a dot, nor end with a dot or a blank".into());
    }
    let stem = name.split('.').next().unwrap_or_default().trim_end().to_ascii_uppercase();
    let numbered = |device: &str| {
        // The raised digits of Latin-1 count too.
        let is_number = |digit: char| digit.is_ascii_digit() || "¹²³".contains(digit);
        stem.strip_prefix(device).is_some_and(|rest| rest.chars().count() == 1 && rest.chars().all(is_number))
    };
    if DEVICES.contains(&&*stem) || NUMBERED.into_iter().any(numbered) {
        return Err("a name that is no device of Windows, such as CON, NUL or COM1".into());
    }
    if name.contains(is_loose) {
        return Err(
            "a name without loose accents: its letters in one piece, as \"é\" and not as \"e\" with an accent after it"
                .into(),
        );
    }
    Ok(())
}

/// Whether a sign is put onto the letter before it. A Mac takes such a letter and the same one in one piece for one name, so two shots would have one folder.
fn is_loose(sign: char) -> bool {
    matches!(sign, '\u{300}'..='\u{36f}' | '\u{3099}' | '\u{309a}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_folders_everywhere() {
        for name in ["sh010", "Szene 3", "鳥", "caf\u{e9}", "console", "COM10", "com", "a.con", "ガ"] {
            assert_eq!(safe_name(name), Ok(()), "{name}");
        }
        for name in [
            "",
            "..",
            ".a",
            "a.",
            "a b ",
            "a:b",
            "a\nb",
            "CON",
            "nul.txt",
            "COM¹",
            "lpt³.png",
            "Aux .a.b",
            "lpt1",
            "com0.json",
            "cafe\u{301}",
            &"a".repeat(121),
        ] {
            assert!(safe_name(name).is_err(), "{name}");
        }
    }
}
