//! Measures how the time and memory of tracking grow with frames, parts, points and pixels.
//!
//! Starting from a base scene ([`crate::puppet`]), one of the four is doubled repeatedly while the others stay the same.
//! Only frames that show other drawings than the keys are counted. More parts are smaller, and more points are closer
//! together on the same contours. The exponent of the growth is the slope of the least-squares line through the logarithms;
//! 1 is linear.

use crate::chart::{Axis, Chart, INKS, Panel, Series};
use crate::puppet::Puppet;
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// The base scene: the size of a shot at 540 lines, one span.
const BASE: Puppet = Puppet { width: 420, height: 540, frames: 12, step: usize::MAX, parts: 6, points: 8 };
/// Number of frames that show the drawings of the keys, on which nothing is tracked.
const KEYED: usize = 4;
/// How often each quantity is doubled.
const DOUBLINGS: u32 = 3;

/// The scene for measuring memory: a shot in high definition, keyed on its first and last frame only.
pub const SHOT: Puppet = Puppet { width: 1920, height: 1080, frames: 100, step: usize::MAX, parts: 16, points: 12 };
/// The same scene, keyed on five frames.
pub const KEYED_SHOT: Puppet = Puppet { step: 25, ..SHOT };

/// The measurement of one track.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Sample {
    /// Seconds, from opening the document on.
    pub seconds: f64,
    /// Peak memory of the process in MB.
    pub peak_mb: Option<f64>,
}

/// A quantity that is doubled.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Its name.
    pub name: &'static str,
    /// Its values with their scenes, beginning with the base scene.
    pub scenes: Vec<(usize, Puppet)>,
}

/// A quantity's name, and its values with their measurements.
pub type Measured = (&'static str, Vec<(usize, Sample)>);

/// The four quantities.
pub fn quantities() -> Vec<Quantity> {
    let series = |name: &'static str, scene: &dyn Fn(usize) -> (usize, Puppet)| Quantity {
        name,
        scenes: (0..=DOUBLINGS).map(|power| scene(1 << power)).collect(),
    };
    let between = BASE.frames - KEYED;
    let larger = |factor: usize| {
        // The sides grow with the square root of the number of pixels, and are even.
        let side = |base: usize| (base as f64 * (factor as f64).sqrt() / 2.0).round() as usize * 2;
        let puppet = Puppet { width: side(BASE.width), height: side(BASE.height), ..BASE };
        (puppet.width * puppet.height, puppet)
    };
    vec![
        series("frames", &|f| (between * f, Puppet { frames: between * f + KEYED, ..BASE })),
        series("parts", &|f| (BASE.parts * f, Puppet { parts: BASE.parts * f, ..BASE })),
        series("points", &|f| (BASE.parts * BASE.points * f, Puppet { points: BASE.points * f, ..BASE })),
        series("pixels", &larger),
    ]
}

/// The exponent with which the second numbers grow with the first ones. It is NaN for fewer than two samples.
pub fn exponent(samples: &[(usize, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = samples.iter().map(|&(x, y)| ((x as f64).ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let (mx, my) = (logs.iter().map(|l| l.0).sum::<f64>() / n, logs.iter().map(|l| l.1).sum::<f64>() / n);
    let across: f64 = logs.iter().map(|(x, y)| (x - mx) * (y - my)).sum();
    across / logs.iter().map(|(x, _)| (x - mx) * (x - mx)).sum::<f64>()
}

/// The table as Markdown.
pub fn markdown(measured: &[Measured]) -> String {
    let mut text = String::from("| what grows | value | seconds | peak MB |\n| --- | ---: | ---: | ---: |\n");
    for (name, samples) in measured {
        for (value, sample) in samples {
            let peak = sample.peak_mb.map_or("–".into(), |mb| format!("{mb:.0}"));
            // Writing to a string does not fail.
            let _ = writeln!(text, "| {name} | {value} | {:.3} | {peak} |", sample.seconds);
        }
    }
    text += "\nThe seconds grow with the power";
    for (i, (name, samples)) in measured.iter().enumerate() {
        let seconds: Vec<_> = samples.iter().map(|(value, sample)| (*value, sample.seconds)).collect();
        let _ = write!(text, "{} {:.2} of {name}", if i > 0 { "," } else { "" }, exponent(&seconds));
    }
    let Puppet { width, height, frames, parts, points, .. } = BASE;
    let _ = writeln!(
        text,
        ".\n\nThe base is a synthetic scene of {frames} frames of {width}×{height} in one span, with {parts} parts and {} \
         points. Only frames that show other drawings than the keys are counted. More parts are smaller, and more points are \
         closer together.",
        parts * points
    );
    text
}

/// A chart of seconds and memory over the factor by which a quantity has grown, both logarithmic.
pub fn chart(measured: &[Measured]) -> Chart {
    let most = f64::from(1_u32 << DOUBLINGS);
    let panel = |label: &str, named: bool, value: &dyn Fn(&Sample) -> Option<f64>| {
        let mut series: Vec<Series> = measured
            .iter()
            .zip(INKS.into_iter().cycle())
            .map(|((name, samples), ink)| {
                let base = samples.first().map_or(1, |(value, _)| *value) as f64;
                let run = samples.iter().filter_map(|(v, sample)| Some((*v as f64 / base, value(sample)?))).collect();
                let name = if named { (*name).into() } else { String::new() };
                Series { name, ink, dashed: false, runs: vec![run] }
            })
            .collect();
        let values = || series.iter().flat_map(|s| &s.runs).flatten().map(|(_, y)| *y);
        let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
        let (low, high) = if low < high { (low, high) } else { (1.0, 10.0) };
        if named {
            let start = series.iter().flat_map(|s| &s.runs).filter_map(|run| run.first()).map(|(_, y)| *y);
            let start = start.fold(f64::INFINITY, f64::min);
            let linear = vec![vec![(1.0, start), (most, most * start)]];
            series.insert(0, Series { name: "linear".into(), ink: [150; 3], dashed: true, runs: linear });
        }
        let high = if named { high.max(most * low) } else { high };
        Panel { y: axis(label, 0.85 * low, 1.2 * high), height: 240.0, series }
    };
    Chart {
        title: "Time and memory of one track while one quantity grows".into(),
        note: String::new(),
        x: axis("times the base scene", 1.0, most),
        panels: vec![
            panel("seconds", true, &|sample| Some(sample.seconds)),
            panel("peak MB", false, &|sample| sample.peak_mb),
        ],
        marked: Vec::new(),
    }
}

fn axis(label: &str, low: f64, high: f64) -> Axis {
    Axis { label: label.into(), low, high, logarithmic: true }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured() -> Vec<Measured> {
        let sample = |seconds: f64| Sample { seconds, peak_mb: Some(80.0) };
        vec![
            ("frames", vec![(9, sample(0.5)), (18, sample(1.0)), (36, sample(2.0))]),
            ("pixels", vec![(100, sample(0.5))]),
        ]
    }

    #[test]
    fn exponents_of_powers() {
        assert!((exponent(&[(1, 3.0), (2, 6.0), (8, 24.0)]) - 1.0).abs() < 1e-12);
        assert!((exponent(&[(10, 1.0), (20, 4.0)]) - 2.0).abs() < 1e-12);
        assert!(exponent(&[(10, 1.0)]).is_nan());
    }

    #[test]
    fn one_quantity_doubles_and_the_others_stay() {
        for quantity in quantities() {
            assert_eq!(quantity.scenes.len(), 4);
            assert_eq!(quantity.scenes[0].1.parts * quantity.scenes[0].1.points, 48);
            for pair in quantity.scenes.windows(2) {
                let (a, b) = (pair[0].1, pair[1].1);
                let factor = |x: usize, y: usize| y as f64 / x as f64;
                let all = [
                    factor(a.frames - KEYED, b.frames - KEYED),
                    factor(a.parts, b.parts),
                    factor(a.points, b.points),
                    factor(a.width * a.height, b.width * b.height),
                ];
                let doubled = all.iter().filter(|f| (**f - 2.0).abs() < 0.02).count();
                let same = all.iter().filter(|f| (**f - 1.0).abs() < 1e-12).count();
                assert_eq!((doubled, same), (1, 3), "{}: {all:?}", quantity.name);
            }
        }
    }

    #[test]
    fn the_table_names_the_power() {
        let text = markdown(&measured());
        assert!(text.contains("| frames | 18 | 1.000 | 80 |"), "{text}");
        assert!(text.contains("with the power 1.00 of frames, NaN of pixels."), "{text}");
    }

    #[test]
    fn the_chart_starts_at_the_base() {
        let chart = chart(&measured());
        let frames = &chart.panels[0].series[1];
        assert_eq!((frames.name.as_str(), &frames.runs[0]), ("frames", &vec![(1.0, 0.5), (2.0, 1.0), (4.0, 2.0)]));
        assert!(chart.draw().png().is_ok());
    }
}
