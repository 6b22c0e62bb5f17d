//! The table of the benchmark's results.

use super::run::Outcome;
use crate::measure::percentile;
use serde_json::{Value, json};
use std::fmt::Write;

/// A run that failed: set, preset, reason.
pub type Failure = (String, String, String);

const HEAD: &str = "| set | preset | good | contour px, mean / 95 % | point px, mean / 95 % | edits | good after | first track s | again s | peak MB |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
";

/// Median seconds of a track after corrections; `None` if there are none.
pub fn again(outcome: &Outcome) -> Option<f64> {
    (!outcome.again.is_empty()).then(|| percentile(outcome.again.clone(), 0.5))
}

/// The table as Markdown: a row for each outcome, then a row of means for each preset with more than one set.
pub fn markdown(outcomes: &[Outcome], failures: &[Failure]) -> String {
    let mut text = HEAD.to_owned();
    for outcome in outcomes {
        text += &row(outcome);
    }
    for preset in in_order(outcomes.iter().map(|o| o.preset.as_str())) {
        let own: Vec<&Outcome> = outcomes.iter().filter(|o| o.preset == preset).collect();
        if own.len() > 1 {
            text += &mean_row(preset, &own);
        }
    }
    for (set, preset, reason) in failures {
        // Writing to a string does not fail.
        let _ = writeln!(text, "\n{set}, {preset}: failed: {reason}");
    }
    text + "\n" + NOTES
}

const NOTES: &str = "\
Good: share of the visible control points of the frames between keys that are within 2 px of the true contour and within
10 px of their true position, at 540 lines. Edits: corrections by a simulated artist until 95 % are good, as a share of all
control points of the frames between keys; no new round begins beyond 10 %. First track: time from opening the document,
with pictures read from files. Again: median time of the tracks after a round of corrections, with the same tracker. Peak:
largest resident memory of the process up to the end of the first track.
";

/// The outcomes and the failures as JSON, for other programs.
pub fn json(outcomes: &[Outcome], failures: &[Failure]) -> Value {
    let failed = failures.iter().map(|(set, preset, reason)| json!({"set": set, "preset": preset, "failed": reason}));
    json!({"outcomes": outcomes, "failures": failed.collect::<Vec<_>>()})
}

/// The distinct names in the order of their first appearance.
pub fn in_order<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    for name in names {
        if !found.contains(&name) {
            found.push(name);
        }
    }
    found
}

fn row(o: &Outcome) -> String {
    let f = &o.work.first;
    let edits = match o.corrected {
        true => format!("{}/{} = {:.1} %", o.work.edits(), o.work.total, 100.0 * o.work.share()),
        false => String::new(),
    };
    let after = if o.corrected { percent(o.work.last.good) } else { String::new() };
    format!(
        "| {} | {} | {} | {:.2} / {:.1} | {:.2} / {:.1} | {edits} | {after} | {:.2} | {} | {} |\n",
        o.set,
        o.preset,
        percent(f.good),
        f.contour_mean,
        f.contour_p95,
        f.point_mean,
        f.point_p95,
        o.seconds,
        again(o).map_or(String::new(), |s| format!("{s:.3}")),
        o.peak_mb.map_or("–".into(), |mb| format!("{mb:.0}")),
    )
}

fn mean_row(preset: &str, own: &[&Outcome]) -> String {
    let mean = |value: &dyn Fn(&Outcome) -> f64| own.iter().map(|o| value(o)).sum::<f64>() / own.len() as f64;
    let corrected = own.iter().all(|o| o.corrected);
    let edits = if corrected { format!("{:.2} %", 100.0 * mean(&|o| o.work.share())) } else { String::new() };
    let after = if corrected { percent(mean(&|o| o.work.last.good)) } else { String::new() };
    format!(
        "| **mean of {}** | {preset} | {} | {:.2} | {:.2} | {edits} | {after} | {:.2} | | |\n",
        own.len(),
        percent(mean(&|o| o.work.first.good)),
        mean(&|o| o.work.first.contour_mean),
        mean(&|o| o.work.first.point_mean),
        mean(&|o| o.seconds),
    )
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::artist::Work;
    use crate::benchmark::run::FrameErrors;
    use crate::measure::Figures;

    pub fn outcome(set: &str, preset: &str, good: f64) -> Outcome {
        let first = Figures { points: 40, good, contour_mean: 1.0, contour_p95: 4.0, point_mean: 2.0, point_p95: 8.0 };
        let frame = |frame: i32| FrameErrors { frame, points: 8, median: 0.5, p90: 3.0, good };
        Outcome {
            set: set.into(),
            preset: preset.into(),
            threads: 2,
            work: Work { centers: 1, pins: 3, total: 80, rounds: 3, first, last: Figures { good: 0.96, ..first } },
            corrected: true,
            seconds: 1.234,
            again: vec![0.3, 0.1, 0.2],
            peak_mb: Some(123.4),
            peak_all_mb: None,
            frames: [1, 2, 4, 5].map(frame).to_vec(),
            keys: vec![(0, 1.0), (3, 0.5), (6, 1.0)],
        }
    }

    #[test]
    fn a_row_has_the_figures() {
        let text = markdown(&[outcome("a", "x", 0.5)], &[]);
        let line = text.lines().nth(2).unwrap();
        let expected = "| a | x | 50.0 % | 1.00 / 4.0 | 2.00 / 8.0 | 4/80 = 5.0 % | 96.0 % | 1.23 | 0.200 | 123 |";
        assert_eq!(line, expected);
        assert!(!text.contains("mean of"));
    }

    #[test]
    fn means_are_by_preset() {
        let outcomes = [outcome("a", "x", 0.5), outcome("a", "y", 0.1), outcome("b", "x", 1.0)];
        let text = markdown(&outcomes, &[("b".into(), "y".into(), "no file".into())]);
        assert!(text.contains("| **mean of 2** | x | 75.0 % | 1.00 | 2.00 | 5.00 % | 96.0 % | 1.23 | | |"), "{text}");
        assert!(!text.contains("| y | 10.0 % | 1.00 | 2.00 |"));
        assert!(text.contains("b, y: failed: no file"));
    }

    #[test]
    fn without_corrections_their_columns_are_empty() {
        let mut one = outcome("a", "x", 0.5);
        (one.corrected, one.again, one.peak_mb) = (false, vec![], None);
        let text = markdown(&[one], &[]);
        assert_eq!(text.lines().nth(2).unwrap(), "| a | x | 50.0 % | 1.00 / 4.0 | 2.00 / 8.0 |  |  | 1.23 |  | – |");
    }

    #[test]
    fn json_can_be_read_back() {
        let outcomes = vec![outcome("a", "x", 0.5)];
        let value = json(&outcomes, &[("b".into(), "y".into(), "no file".into())]);
        assert_eq!(serde_json::from_value::<Vec<Outcome>>(value["outcomes"].clone()).unwrap(), outcomes);
        assert_eq!(value["failures"][0]["failed"], "no file");
    }
}
