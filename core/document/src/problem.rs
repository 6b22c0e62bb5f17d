//! Problems of a document, with their places.

use std::fmt;

/// At most this many problems of each severity are listed; the others are only counted.
pub const LISTED: usize = 100;

/// Severity of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The document cannot be used.
    Error,
    /// The document can be used, but a part of it has no effect or is probably a mistake.
    Warning,
}

/// A problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Its severity.
    pub severity: Severity,
    /// JSON path, such as `parts[3] "near arm".keys."11"[5]`.
    pub place: String,
    /// The found and the expected value.
    pub message: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.place.is_empty() {
            out.write_str(&self.message)
        } else {
            write!(out, "{}: {}", self.place, self.message)
        }
    }
}

/// All problems in the order of the document. At most [`LISTED`] errors and as many warnings are listed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Problems {
    listed: Vec<Problem>,
    errors: usize,
    warnings: usize,
}

impl Problems {
    /// Adds an error.
    pub fn error(&mut self, place: impl Into<String>, message: impl Into<String>) {
        self.add(Problem { severity: Severity::Error, place: place.into(), message: message.into() });
    }

    /// Adds a warning.
    pub fn warning(&mut self, place: impl Into<String>, message: impl Into<String>) {
        self.add(Problem { severity: Severity::Warning, place: place.into(), message: message.into() });
    }

    /// Adds a problem.
    pub fn add(&mut self, problem: Problem) {
        let count = match problem.severity {
            Severity::Error => &mut self.errors,
            Severity::Warning => &mut self.warnings,
        };
        *count += 1;
        if *count <= LISTED {
            self.listed.push(problem);
        }
    }

    /// Adds all problems of `other` after the present ones.
    pub fn append(&mut self, other: Problems) {
        let (errors, warnings) = (self.errors + other.errors, self.warnings + other.warnings);
        for problem in other.listed {
            self.add(problem);
        }
        (self.errors, self.warnings) = (errors, warnings);
    }

    /// Number of errors, including those not listed.
    pub fn error_count(&self) -> usize {
        self.errors
    }

    /// Number of warnings, including those not listed.
    pub fn warning_count(&self) -> usize {
        self.warnings
    }

    /// Whether there is no problem.
    pub fn is_empty(&self) -> bool {
        self.errors + self.warnings == 0
    }

    /// The listed problems.
    pub fn iter(&self) -> impl Iterator<Item = &Problem> {
        self.listed.iter()
    }

    /// The listed errors.
    pub fn errors(&self) -> impl Iterator<Item = &Problem> {
        self.listed.iter().filter(|problem| problem.severity == Severity::Error)
    }

    /// The listed warnings.
    pub fn warnings(&self) -> impl Iterator<Item = &Problem> {
        self.listed.iter().filter(|problem| problem.severity == Severity::Warning)
    }

    /// Numbers of errors and warnings that are not listed.
    pub fn left_off(&self) -> (usize, usize) {
        (self.errors.saturating_sub(LISTED), self.warnings.saturating_sub(LISTED))
    }
}

impl fmt::Display for Problems {
    /// The errors, one in each line, and the number of errors not listed.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.errors().enumerate() {
            write!(out, "{}{problem}", if i > 0 { "\n" } else { "" })?;
        }
        match self.left_off().0 {
            0 => Ok(()),
            more => write!(out, "\n… and {more} more errors"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_is_bounded_and_the_rest_is_counted() {
        let mut problems = Problems::default();
        for i in 0..LISTED + 5 {
            problems.error(format!("parts[{i}]"), "bad");
        }
        problems.warning("footage", "odd");
        assert_eq!((problems.error_count(), problems.warning_count()), (LISTED + 5, 1));
        assert_eq!(problems.errors().count(), LISTED);
        assert_eq!(problems.left_off(), (5, 0));
        let mut all = Problems::default();
        all.error("", "first");
        all.append(problems);
        assert_eq!((all.error_count(), all.errors().count()), (LISTED + 6, LISTED));
        assert!(all.to_string().ends_with("… and 6 more errors"));
    }
}
