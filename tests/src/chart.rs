//! Line charts: one or more panels with a shared x axis, linear or logarithmic, and a legend.

use crate::drawing::{Anchor, Drawing, Ink, Mark};
use crate::lettering;

/// Colours of series that differ for any kind of colour vision (Okabe & Ito 2008, without yellow).
pub const INKS: [Ink; 7] =
    [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [230, 159, 0], [0, 0, 0]];

const WIDTH: f32 = 900.0;
const LEFT: f32 = 64.0;
const RIGHT: f32 = 20.0;
const TOP: f32 = 62.0;
const BOTTOM: f32 = 46.0;
/// Space between panels.
const GAP: f32 = 22.0;
/// Height of capital letters.
const LETTERS: f32 = 8.0;
const GREY: Ink = [110, 110, 116];
const GRID: Ink = [228, 228, 232];
const BLACK: Ink = [20, 20, 24];

/// An axis from `low` to `high`.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The quantity and its unit.
    pub label: String,
    /// Value at the left or lower end; above 0 on a logarithmic axis.
    pub low: f64,
    /// Value at the right or upper end, larger than `low`.
    pub high: f64,
    /// Whether the scale is logarithmic.
    pub logarithmic: bool,
}

/// A line of a panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend. Of series with the same name the legend shows the first one; an empty name is not shown.
    pub name: String,
    /// Colour.
    pub ink: Ink,
    /// Whether the line is dashed and without dots.
    pub dashed: bool,
    /// Points (x, y) in order. Each run is a line of its own.
    pub runs: Vec<Vec<(f64, f64)>>,
}

/// Series with one y axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Its y axis.
    pub y: Axis,
    /// Height of its field.
    pub height: f32,
    /// The series. Later ones cover earlier ones.
    pub series: Vec<Series>,
}

/// Panels with one x axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// The title above the panels.
    pub title: String,
    /// A note at the end of the legend.
    pub note: String,
    /// The x axis of all panels.
    pub x: Axis,
    /// The panels from the top.
    pub panels: Vec<Panel>,
    /// Values of x that are marked in all panels, each with whether the mark is strong.
    pub marked: Vec<(f64, bool)>,
}

impl Axis {
    /// The position of a value on the axis, 0 to 1. Values beyond an end are at the end.
    pub fn place(&self, value: f64) -> f64 {
        let scale = |v: f64| if self.logarithmic { v.max(f64::MIN_POSITIVE).ln() } else { v };
        ((scale(value) - scale(self.low)) / (scale(self.high) - scale(self.low))).clamp(0.0, 1.0)
    }

    /// About `count` round values between the ends: 1, 2 or 5 times powers of ten.
    pub fn ticks(&self, count: usize) -> Vec<f64> {
        if self.logarithmic {
            let powers = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
            let decades = f64::from(powers.end() - powers.start());
            let steps: &[f64] = if decades > 4.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
            let all = powers.flat_map(|power| steps.iter().map(move |step| step * 10f64.powi(power)));
            let within = self.low * (1.0 - 1e-9)..=self.high * (1.0 + 1e-9);
            return all.filter(|value| within.contains(value)).collect();
        }
        let raw = (self.high - self.low) / count.max(1) as f64;
        let power = 10f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|step| *step >= raw * 0.999);
        let step = step.unwrap_or(power);
        let first = (self.low / step - 1e-9).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        (first..=last).map(|k| k as f64 * step).collect()
    }
}

impl Chart {
    /// Draws the chart.
    pub fn draw(&self) -> Drawing {
        let fields: f32 = self.panels.iter().map(|panel| panel.height + GAP).sum::<f32>() - GAP;
        let mut drawing = Drawing { size: [WIDTH, TOP + fields + BOTTOM], marks: Vec::new() };
        let marks = &mut drawing.marks;
        text(marks, [LEFT, 22.0], LETTERS * 1.4, BLACK, Anchor::Start, &self.title);
        self.legend(marks);
        let mut top = TOP;
        for (index, panel) in self.panels.iter().enumerate() {
            self.field(marks, panel, top, index + 1 == self.panels.len());
            top += panel.height + GAP;
        }
        let middle = (LEFT + WIDTH - RIGHT) / 2.0;
        text(marks, [middle, TOP + fields + 38.0], LETTERS, BLACK, Anchor::Middle, &self.x.label);
        drawing
    }

    fn legend(&self, marks: &mut Vec<Mark>) {
        let mut shown: Vec<&str> = Vec::new();
        let mut left = LEFT;
        for series in self.panels.iter().flat_map(|panel| &panel.series) {
            if series.name.is_empty() || shown.contains(&series.name.as_str()) {
                continue;
            }
            shown.push(&series.name);
            let dash = series.dashed.then_some([5.0, 3.0]);
            marks.push(line(vec![[left, 42.0], [left + 22.0, 42.0]], series.ink, 2.2, dash));
            text(marks, [left + 28.0, 46.0], LETTERS, BLACK, Anchor::Start, &series.name);
            left += 28.0 + lettering::width(&series.name, LETTERS) + 26.0;
        }
        text(marks, [left, 46.0], LETTERS, GREY, Anchor::Start, &self.note);
    }

    fn field(&self, marks: &mut Vec<Mark>, panel: &Panel, top: f32, last: bool) {
        let (right, bottom) = (WIDTH - RIGHT, top + panel.height);
        let x = |v: f64| LEFT + self.x.place(v) as f32 * (right - LEFT);
        let y = |v: f64| bottom - panel.y.place(v) as f32 * panel.height;
        for value in panel.y.ticks((panel.height / 36.0) as usize) {
            marks.push(line(vec![[LEFT, y(value)], [right, y(value)]], GRID, 1.0, None));
            text(marks, [LEFT - 8.0, y(value) + LETTERS / 2.0], LETTERS, GREY, Anchor::End, &number(value));
        }
        for &(value, strong) in &self.marked {
            let (ink, width) = if strong { ([150, 150, 158], 1.4) } else { ([205, 205, 212], 1.0) };
            marks.push(line(vec![[x(value), top], [x(value), bottom]], ink, width, None));
        }
        if last {
            for value in self.x.ticks(16) {
                marks.push(line(vec![[x(value), bottom], [x(value), bottom + 4.0]], GREY, 1.0, None));
                text(marks, [x(value), bottom + 8.0 + LETTERS], LETTERS, GREY, Anchor::Middle, &number(value));
            }
        }
        marks.push(line(vec![[LEFT, top], [LEFT, bottom], [right, bottom]], GREY, 1.0, None));
        let label = Mark::Text {
            at: [16.0, (top + bottom) / 2.0],
            size: LETTERS,
            ink: BLACK,
            anchor: Anchor::Middle,
            turned: true,
            text: panel.y.label.clone(),
        };
        marks.push(label);
        for series in &panel.series {
            for run in &series.runs {
                let points: Vec<[f32; 2]> = run.iter().map(|&(a, b)| [x(a), y(b)]).collect();
                if !series.dashed {
                    marks.extend(points.iter().map(|&at| Mark::Dot { at, radius: 2.4, ink: series.ink }));
                }
                let (width, dash) = if series.dashed { (1.3, Some([5.0, 3.0])) } else { (2.0, None) };
                marks.push(line(points, series.ink, width, dash));
            }
        }
    }
}

fn line(points: Vec<[f32; 2]>, ink: Ink, width: f32, dash: Option<[f32; 2]>) -> Mark {
    Mark::Line { points, ink, width, dash }
}

fn text(marks: &mut Vec<Mark>, at: [f32; 2], size: f32, ink: Ink, anchor: Anchor, text: &str) {
    marks.push(Mark::Text { at, size, ink, anchor, turned: false, text: text.to_owned() });
}

/// A value without trailing zeros.
fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text.is_empty() || text == "-0" { "0".into() } else { text.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(low: f64, high: f64, logarithmic: bool) -> Axis {
        Axis { label: "px".into(), low, high, logarithmic }
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(axis(0.0, 33.0, false).ticks(8), [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0]);
        assert_eq!(axis(0.0, 100.0, false).ticks(4), [0.0, 50.0, 100.0]);
        assert_eq!(axis(-3.0, 3.0, false).ticks(6), [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0]);
        let near = |found: Vec<f64>, expected: &[f64]| {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            assert!(found.iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-12), "{found:?}");
        };
        near(axis(0.1, 10.0, true).ticks(4), &[0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0]);
        near(axis(0.001, 100.0, true).ticks(4), &[0.001, 0.01, 0.1, 1.0, 10.0, 100.0]);
    }

    #[test]
    fn places_follow_the_scale() {
        assert_eq!(axis(0.0, 8.0, false).place(2.0), 0.25);
        assert!((axis(0.1, 10.0, true).place(1.0) - 0.5).abs() < 1e-12);
        assert_eq!(axis(0.1, 10.0, true).place(0.0), 0.0);
        assert_eq!(axis(0.1, 10.0, true).place(99.0), 1.0);
    }

    #[test]
    fn values_are_written_short() {
        assert_eq!([0.0, -0.0, 0.05, 20.0, 1.5].map(number), ["0", "0", "0.05", "20", "1.5"]);
    }

    #[test]
    fn a_run_goes_from_corner_to_corner() {
        let series = Series {
            name: "s".into(),
            ink: INKS[0],
            dashed: false,
            runs: vec![vec![(0.0, 0.0), (4.0, 1.0)], vec![(2.0, 0.5)]],
        };
        let panel = Panel { y: axis(0.0, 1.0, false), height: 100.0, series: vec![series] };
        let chart = Chart {
            title: "t".into(),
            note: String::new(),
            x: axis(0.0, 4.0, false),
            panels: vec![panel],
            marked: vec![(2.0, true)],
        };
        let marks = chart.draw().marks;
        let long = vec![[LEFT, TOP + 100.0], [WIDTH - RIGHT, TOP]];
        assert!(
            marks.iter().any(|m| matches!(m, Mark::Line { points, ink, .. } if *points == long && *ink == INKS[0]))
        );
        let middle = (LEFT + WIDTH - RIGHT) / 2.0;
        let alone = [middle, TOP + 50.0];
        assert!(marks.iter().any(|m| matches!(m, Mark::Dot { at, .. } if *at == alone)));
        let legend = |m: &&Mark| matches!(m, Mark::Text { text, .. } if text == "s");
        assert_eq!(marks.iter().filter(legend).count(), 1);
    }
}
