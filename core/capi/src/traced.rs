//! Traced strokes in flat arrays, and the options of tracing. `rototoon_session_trace` documents both.

use crate::status::Failure;
use rototoon::lines::{Options, Style, ink};
use rototoon::pipeline::TraceOptions;
use rototoon::project::traced::TracedDrawing;
use rototoon::scene::{Colour, FrameNumber};
use serde::Deserialize;
use std::ops::RangeInclusive;

/// Least and greatest sensitivity to faint ink.
pub(crate) const SENSITIVITY: RangeInclusive<f64> = 0.1..=10.0;

/// The traced strokes of a document, frame by frame.
pub struct RototoonTraced {
    /// Frame numbers in rising order.
    pub frames: Vec<i32>,
    /// Frame `f` has the strokes `stroke_offsets[f]` to `stroke_offsets[f + 1]` (excluded).
    pub stroke_offsets: Vec<i32>,
    /// The number of each stroke, the same on all frames.
    pub tracks: Vec<i32>,
    /// For each stroke 1 if its last point joins its first, otherwise 0.
    pub closed: Vec<i32>,
    /// Three numbers for each stroke, sRGB from 0 to 1; NaN if it has no colour.
    pub colours: Vec<f64>,
    /// Stroke `i` has the points `point_offsets[i]` to `point_offsets[i + 1]` (excluded).
    pub point_offsets: Vec<i32>,
    /// x and y in pixels.
    pub points: Vec<f64>,
    /// The width at each point in pixels; NaN if the stroke has no widths.
    pub widths: Vec<f64>,
    /// For each stroke the probability that it is the stroke of its number; 1 if that is beyond doubt.
    pub confidence: Vec<f64>,
    /// For each stroke 1 if what is inside is filled, otherwise 0.
    pub fills: Vec<i32>,
    /// Three numbers for each stroke, sRGB from 0 to 1: the colour of the fill below its line; NaN if there is none.
    pub fill_colours: Vec<f64>,
}

impl RototoonTraced {
    /// Joins drawings, one after the other, into flat arrays.
    ///
    /// # Errors
    ///
    /// More strokes, points or numbers of strokes than 32 bits can count.
    pub fn of(drawings: &[TracedDrawing]) -> Result<Self, Failure> {
        let mut arrays = Self {
            frames: Vec::with_capacity(drawings.len()),
            stroke_offsets: vec![0],
            tracks: Vec::new(),
            closed: Vec::new(),
            colours: Vec::new(),
            point_offsets: vec![0],
            points: Vec::new(),
            widths: Vec::new(),
            confidence: Vec::new(),
            fills: Vec::new(),
            fill_colours: Vec::new(),
        };
        for drawing in drawings {
            arrays.push(drawing)?;
        }
        Ok(arrays)
    }

    fn push(&mut self, drawing: &TracedDrawing) -> Result<(), Failure> {
        let counted = |number: usize, what: &str| {
            i32::try_from(number).map_err(|_| {
                Failure::Error(format!("frame {}: {what} {number}: expected at most {}", drawing.frame, i32::MAX))
            })
        };
        for stroke in &drawing.strokes {
            self.tracks.push(counted(stroke.track, "track")?);
            self.closed.push(stroke.closed.into());
            self.fills.push(stroke.fill.into());
            self.confidence.push(stroke.confidence.unwrap_or(1.0));
            self.colours.extend(numbers(stroke.colour));
            self.fill_colours.extend(numbers(stroke.fill_colour));
            self.points.extend(stroke.points.iter().flat_map(|p| p.to_array()));
            match stroke.widths.is_empty() {
                true => self.widths.extend(std::iter::repeat_n(f64::NAN, stroke.points.len())),
                false => self.widths.extend(&stroke.widths),
            }
            self.point_offsets.push(counted(self.widths.len(), "points up to here,")?);
        }
        self.frames.push(drawing.frame);
        self.stroke_offsets.push(counted(self.tracks.len(), "strokes up to here,")?);
        Ok(())
    }
}

/// The three numbers of a colour; NaN if there is none.
fn numbers(colour: Option<[f32; 3]>) -> [f64; 3] {
    colour.map_or([f64::NAN; 3], |colour| colour.map(f64::from))
}

/// Refuses an option that is outside of its range, or no number.
pub(crate) fn within(name: &str, found: f64, range: RangeInclusive<f64>) -> Result<(), Failure> {
    if range.contains(&found) {
        return Ok(());
    }
    let (least, most) = (range.start(), range.end());
    Err(Failure::Error(format!("options: {name}: found {found}, expected a number from {least} to {most}")))
}

/// Refuses colours of pencils that cannot be left out.
pub(crate) fn colours(leave_out: &[Colour]) -> Result<(), Failure> {
    let is_wrong =
        |colour: &&Colour| !colour.iter().all(|value| (0.0..=1.0).contains(value)) || !ink::can_leave_out(**colour);
    match leave_out.iter().find(is_wrong) {
        None => Ok(()),
        Some(found) => Err(Failure::Error(format!(
            "options: leave_out: found {found:?}, expected a colour with a hue, such as [0.64, 0.87, 0.93] for light blue: three numbers from 0 to 1"
        ))),
    }
}

/// The JSON options of tracing.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Asked {
    style: AskedStyle,
    sensitivity: f64,
    leave_out: Vec<Colour>,
    frames: Option<[FrameNumber; 2]>,
    keep_first: bool,
    /// Number of threads; 0 for one per core.
    pub threads: usize,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum AskedStyle {
    Auto,
    Clean,
    Rough,
}

impl Default for Asked {
    fn default() -> Self {
        Self {
            style: AskedStyle::Auto,
            sensitivity: 1.0,
            leave_out: Vec::new(),
            frames: None,
            keep_first: false,
            threads: 0,
        }
    }
}

impl Asked {
    /// Reads and checks a caller's JSON. Options that are left out have their defaults, and so have all in an empty text.
    pub fn parse(json: &str) -> Result<Self, Failure> {
        let asked: Self = match json {
            "" => Self::default(),
            _ => serde_json::from_str(json).map_err(|error| Failure::Error(format!("options: {error}")))?,
        };
        within("sensitivity", asked.sensitivity, SENSITIVITY)?;
        colours(&asked.leave_out)?;
        Ok(asked)
    }

    /// The options of the tracer.
    pub fn options(&self) -> TraceOptions {
        let style = match self.style {
            AskedStyle::Auto => Style::Auto,
            AskedStyle::Clean => Style::Clean,
            AskedStyle::Rough => Style::Rough,
        };
        let leave_out = self.leave_out.clone();
        TraceOptions { lines: Options { style, sensitivity: self.sensitivity, leave_out }, keep_first: self.keep_first }
    }

    /// The frames to trace; `None` for all.
    pub fn frames(&self) -> Option<RangeInclusive<FrameNumber>> {
        self.frames.map(|[first, last]| first..=last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::geometry::Point;
    use rototoon::project::traced::TracedStroke;

    #[test]
    fn drawings_become_flat_arrays() {
        let line = TracedStroke {
            track: 4,
            points: vec![Point::new(1.0, 2.0), Point::new(3.0, 4.0)],
            closed: false,
            widths: vec![2.0, 2.5],
            colour: Some([0.0, 0.5, 1.0]),
            confidence: Some(0.75),
            ..TracedStroke::default()
        };
        let ring = TracedStroke {
            track: 1,
            points: vec![Point::ONE; 3],
            closed: true,
            fill: true,
            fill_colour: Some([0.25, 1.0, 0.0]),
            ..TracedStroke::default()
        };
        let drawings =
            [TracedDrawing { frame: -1, strokes: Vec::new() }, TracedDrawing { frame: 7, strokes: vec![line, ring] }];
        let found = RototoonTraced::of(&drawings).unwrap();
        assert_eq!((&found.frames[..], &found.stroke_offsets[..]), (&[-1, 7][..], &[0, 0, 2][..]));
        assert_eq!((&found.tracks[..], &found.closed[..]), (&[4, 1][..], &[0, 1][..]));
        assert_eq!((&found.confidence[..], &found.fills[..]), (&[0.75, 1.0][..], &[0, 1][..]));
        assert_eq!((&found.point_offsets[..], found.points.len()), (&[0, 2, 5][..], 10));
        assert_eq!((&found.widths[..2], &found.colours[..3]), (&[2.0, 2.5][..], &[0.0, 0.5, 1.0][..]));
        assert!(found.widths[2..].iter().chain(&found.colours[3..]).all(|value| value.is_nan()));
        assert_eq!((found.fill_colours.len(), &found.fill_colours[3..]), (6, &[0.25, 1.0, 0.0][..]));
        assert!(found.fill_colours[..3].iter().all(|value| value.is_nan()));
    }

    #[test]
    fn options_are_read_and_checked() {
        let asked = Asked::parse(r#"{"style": "rough", "frames": [3, 5], "threads": 2, "keep_first": true}"#).unwrap();
        assert_eq!((asked.options().lines.style, asked.frames(), asked.threads), (Style::Rough, Some(3..=5), 2));
        assert!(asked.options().keep_first);
        assert_eq!(Asked::parse("").unwrap().options(), TraceOptions::default());
        let said = |json: &str| Asked::parse(json).unwrap_err().to_string();
        assert_eq!(said(r#"{"sensitivity": 0}"#), "options: sensitivity: found 0, expected a number from 0.1 to 10");
        assert!(said(r#"{"style": "neat"}"#).starts_with("options: unknown variant `neat`"));
        assert!(said(r#"{"leave_out": [[0.5, 0.5, 0.5]]}"#).starts_with("options: leave_out: found [0.5, 0.5, 0.5]"));
        let blue = Asked::parse(r#"{"leave_out": [[0.5, 0.75, 1.0]]}"#).unwrap();
        assert_eq!(blue.options().lines.leave_out, [[0.5, 0.75, 1.0]]);
        assert!(said(r#"{"colour": 1}"#).starts_with("options: unknown field `colour`"));
    }
}
