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
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_folders_everywhere() {
        for name in ["sh010", "Szene 3", "鳥"] {
            assert_eq!(safe_name(name), Ok(()), "{name}");
        }
        for name in ["", "..", ".a", "a.", "a b ", "a:b", "a\nb", &"a".repeat(121)] {
            assert!(safe_name(name).is_err(), "{name}");
        }
    }
}
