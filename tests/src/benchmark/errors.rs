//! A plot of errors over the frames of one set, with a line for each preset.

use super::run::{FrameErrors, Outcome};
use crate::chart::{Axis, Chart, INKS, Panel, Series};
use rototoon::scene::FrameNumber;

/// Least distance shown, in pixels. Smaller distances are negligible.
const LEAST: f64 = 0.05;

/// The upper panel shows the distance to the contour: median (solid) and 90th percentile (dashed), logarithmic. The lower
/// panel shows the share of good points. Lines are interrupted at frames on which all parts are keyed. Key frames are
/// marked, and marked strongly if all parts have a key there. `None` if there are no outcomes.
pub fn chart(set: &str, outcomes: &[&Outcome]) -> Option<Chart> {
    let frames = outcomes.iter().flat_map(|o| o.keys.iter().map(|(frame, _)| *frame));
    let (first, last) = (frames.clone().min()?, frames.max()?);
    let largest = outcomes.iter().flat_map(|o| &o.frames).map(|f| f.p90).fold(1.0, f64::max);
    let x = axis("frame", f64::from(first), f64::from(last.max(first + 1)), false);
    let mut distances = Vec::new();
    let mut shares = Vec::new();
    for (outcome, ink) in outcomes.iter().zip(INKS.into_iter().cycle()) {
        let series = |name: &str, dashed: bool, value: fn(&FrameErrors) -> f64| Series {
            name: name.into(),
            ink,
            dashed,
            runs: runs(outcome, value),
        };
        distances.push(series("", true, |f| f.p90.max(LEAST)));
        distances.push(series(&outcome.preset, false, |f| f.median.max(LEAST)));
        shares.push(series("", false, |f| 100.0 * f.good));
    }
    Some(Chart {
        title: format!("{set}: errors over frames"),
        note: "solid: median, dashed: 90th percentile; vertical: key frames".into(),
        x,
        panels: vec![
            Panel { y: axis("distance to contour, px", LEAST, 1.2 * largest, true), height: 250.0, series: distances },
            Panel { y: axis("good points, %", 0.0, 100.0, false), height: 130.0, series: shares },
        ],
        marked: outcomes[0].keys.iter().map(|&(frame, share)| (f64::from(frame), share >= 1.0)).collect(),
    })
}

fn axis(label: &str, low: f64, high: f64, logarithmic: bool) -> Axis {
    Axis { label: label.into(), low, high, logarithmic }
}

/// The values, divided into runs of consecutive frames.
fn runs(outcome: &Outcome, value: fn(&FrameErrors) -> f64) -> Vec<Vec<(f64, f64)>> {
    let mut runs: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut before: Option<FrameNumber> = None;
    for errors in &outcome.frames {
        if before != Some(errors.frame - 1) {
            runs.push(Vec::new());
        }
        if let Some(run) = runs.last_mut() {
            run.push((f64::from(errors.frame), value(errors)));
        }
        before = Some(errors.frame);
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::benchmark::table::tests::outcome;

    #[test]
    fn lines_end_at_keys_and_every_preset_has_its_own() {
        let (a, b) = (outcome("s", "x", 0.5), outcome("s", "y", 0.9));
        let chart = chart("s", &[&a, &b]).unwrap();
        assert_eq!((chart.x.low, chart.x.high), (0.0, 6.0));
        assert_eq!(chart.marked, [(0.0, true), (3.0, false), (6.0, true)]);
        assert_eq!(chart.panels[1].series[0].runs, [[(1.0, 50.0), (2.0, 50.0)], [(4.0, 50.0), (5.0, 50.0)]]);
        let names: Vec<&str> = chart.panels[0].series.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names, ["", "x", "", "y"]);
        assert!(chart.panels[0].y.high > 3.0);
        let svg = chart.draw().svg();
        assert!(svg.contains("s: errors over frames"));
    }

    #[test]
    fn nothing_gives_no_chart() {
        assert!(chart("s", &[]).is_none());
    }
}
