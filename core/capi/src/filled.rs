//! Clicks of a painter, painted regions in flat arrays, and the options of painting. [`crate::filled_abi`] documents all.

use crate::status::Failure;
use crate::traced::{SENSITIVITY, colours, within};
use rototoon::geometry::Point;
use rototoon::lines::{Options, Style};
use rototoon::pipeline::{DOUBT, FillOptions, FillReport, LeakingClick, MissedClick};
use rototoon::project::fills::{FillClick, FillClicks, FilledDrawing, FilledRegion};
use rototoon::project::recolours::Recolour;
use rototoon::scene::{Colour, FrameNumber};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Largest absolute coordinate of a click, in pixels. A larger one is a mistake of the caller.
const MAX_COORDINATE: f64 = 1e6;

/// The painted regions of a document, frame by frame.
#[derive(Default)]
pub struct RototoonFilled {
    /// Frame numbers in rising order.
    pub frames: Vec<i32>,
    /// Frame `f` has the regions `region_offsets[f]` to `region_offsets[f + 1]` (excluded).
    pub region_offsets: Vec<i32>,
    /// The number of each region, the same on all frames.
    pub tracks: Vec<i32>,
    /// For each region the name of its colour.
    pub names: Vec<Option<String>>,
    /// Three numbers for each region, sRGB from 0 to 1.
    pub colours: Vec<f64>,
    /// For each region the probability that its colour is right.
    pub confidence: Vec<f64>,
    /// For each region 1 if its colour is probably wrong, otherwise 0.
    pub doubtful: Vec<i32>,
    /// Region `i` has the outlines `outline_offsets[i]` to `outline_offsets[i + 1]` (excluded): its own, then those of its holes.
    pub outline_offsets: Vec<i32>,
    /// Outline `k` has the points `point_offsets[k]` to `point_offsets[k + 1]` (excluded).
    pub point_offsets: Vec<i32>,
    /// x and y in pixels.
    pub points: Vec<f64>,
}

impl RototoonFilled {
    /// Joins drawings, one after the other, into flat arrays.
    ///
    /// # Errors
    ///
    /// More regions, outlines, points or numbers of regions than 32 bits can count.
    pub fn of(drawings: &[FilledDrawing]) -> Result<Self, Failure> {
        let mut arrays =
            Self { region_offsets: vec![0], outline_offsets: vec![0], point_offsets: vec![0], ..Self::default() };
        for drawing in drawings {
            for region in &drawing.regions {
                arrays.push(region, drawing.frame)?;
            }
            arrays.frames.push(drawing.frame);
            arrays.region_offsets.push(counted(arrays.tracks.len(), "regions up to here,", drawing.frame)?);
        }
        Ok(arrays)
    }

    fn push(&mut self, region: &FilledRegion, frame: FrameNumber) -> Result<(), Failure> {
        self.tracks.push(counted(region.track, "track", frame)?);
        self.names.push(region.name.clone());
        self.colours.extend(region.colour.map(f64::from));
        self.confidence.push(region.confidence);
        self.doubtful.push((region.confidence < DOUBT).into());
        for outline in [&region.outline].into_iter().chain(&region.holes) {
            self.points.extend(outline.iter().flat_map(|p| p.to_array()));
            self.point_offsets.push(counted(self.points.len() / 2, "points up to here,", frame)?);
        }
        self.outline_offsets.push(counted(self.point_offsets.len() - 1, "outlines up to here,", frame)?);
        Ok(())
    }
}

fn counted(number: usize, what: &str, frame: FrameNumber) -> Result<i32, Failure> {
    i32::try_from(number)
        .map_err(|_| Failure::Error(format!("frame {frame}: {what} {number}: expected at most {}", i32::MAX)))
}

/// Sorts clicks by frame. On a frame they keep their order. `places` has two numbers for each click, `colours` three, or three NaN for a region without
/// paint.
///
/// # Errors
///
/// A place that is not finite or very large, or a colour outside of 0 to 1: with the number of the click.
pub fn clicks_by_frame(frames: &[i32], places: &[f64], colours: &[f64]) -> Result<Vec<FillClicks>, Failure> {
    let mut found: BTreeMap<FrameNumber, Vec<FillClick>> = BTreeMap::new();
    let rows = frames.iter().zip(places.as_chunks::<2>().0).zip(colours.as_chunks::<3>().0);
    for (k, ((&frame, &[x, y]), colour)) in rows.enumerate() {
        let wrong = |text: String| Failure::Error(format!("click {k} (frame {frame}): {text}"));
        // The comparisons are false for NaN, so NaN is refused too.
        if !(x.abs() <= MAX_COORDINATE && y.abs() <= MAX_COORDINATE) {
            return Err(wrong(format!("place: found ({x}, {y}), expected pixels within ±{MAX_COORDINATE}")));
        }
        let is_bare = colour.iter().all(|value| value.is_nan());
        if let Some(value) = colour.iter().find(|value| !is_bare && !(0.0..=1.0).contains(*value)) {
            return Err(wrong(format!(
                "colour: found {value}, expected numbers from 0 to 1, or three NaN for no paint"
            )));
        }
        let colour = (!is_bare).then(|| colour.map(|value| value as f32));
        found.entry(frame).or_default().push(FillClick { at: Point::new(x, y), colour, name: None });
    }
    Ok(found.into_iter().map(|(frame, clicks)| FillClicks { frame, clicks }).collect())
}

/// Clicks as JSON, in the form of the document.
pub fn fills_to_json(fills: &[FillClicks]) -> String {
    fills.iter().map(FillClicks::to_json).collect::<Value>().to_string()
}

/// Colours that become others as JSON, in the form of the document. Names have their looks beside them.
pub fn recolours_to_json(recolours: &[Recolour]) -> String {
    recolours.iter().map(Recolour::to_json).collect::<Value>().to_string()
}

/// What painting tells, as JSON.
pub fn report_to_json(report: &FillReport) -> String {
    let frames = report.frames.iter().map(
        |own| json!({"frame": own.frame, "regions": own.regions, "doubtful": own.doubtful, "related": own.related, "bare": own.bare}),
    );
    let clicks = |clicks: &[MissedClick]| -> Value {
        clicks.iter().map(|own| json!({"frame": own.frame, "click": own.click})).collect()
    };
    let (missed, overruled) = (clicks(&report.missed), clicks(&report.overruled));
    let leaking: Value = report.leaking.iter().map(leak_to_json).collect();
    json!({"frames": frames.collect::<Value>(), "missed": missed, "overruled": overruled, "leaking": leaking})
        .to_string()
}

fn leak_to_json(leak: &LeakingClick) -> Value {
    let LeakingClick { place, gap, size } = leak;
    let at = gap.at.to_array();
    json!({"frame": place.frame, "click": place.click, "parted": gap.closes, "gap": at, "width": gap.width, "size": size})
}

/// The JSON options of painting.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Asked {
    sensitivity: f64,
    leave_out: Vec<Colour>,
    confidence: f64,
    frames: Option<[FrameNumber; 2]>,
    /// Number of threads; 0 for one per core.
    pub threads: usize,
}

impl Default for Asked {
    fn default() -> Self {
        let FillOptions { lines, confidence } = FillOptions::default();
        Self { sensitivity: lines.sensitivity, leave_out: lines.leave_out, confidence, frames: None, threads: 0 }
    }
}

impl Asked {
    /// Reads and checks a caller's JSON. Options that are left out have their defaults, and so have all in an empty text.
    ///
    /// # Errors
    ///
    /// The option that is wrong.
    pub fn parse(json: &str) -> Result<Self, Failure> {
        let asked: Self = match json {
            "" => Self::default(),
            _ => serde_json::from_str(json).map_err(|error| Failure::Error(format!("options: {error}")))?,
        };
        within("sensitivity", asked.sensitivity, SENSITIVITY)?;
        within("confidence", asked.confidence, 0.0..=1.0)?;
        colours(&asked.leave_out)?;
        Ok(asked)
    }

    /// The options of the painter.
    pub fn options(&self) -> FillOptions {
        let lines = Options { style: Style::Auto, sensitivity: self.sensitivity, leave_out: self.leave_out.clone() };
        FillOptions { lines, confidence: self.confidence }
    }

    /// The frames to paint; `None` for all.
    pub fn frames(&self) -> Option<RangeInclusive<FrameNumber>> {
        self.frames.map(|[first, last]| first..=last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::fill::Gap;
    use rototoon::pipeline::FilledFrame;

    #[test]
    fn regions_become_flat_arrays() {
        let triangle = |at: f64| vec![Point::new(at, 0.0), Point::new(at + 1.0, 0.0), Point::new(at, 1.0)];
        let ring = FilledRegion {
            outline: triangle(1.0),
            holes: vec![triangle(5.0), vec![Point::ONE; 4]],
            colour: [0.0, 0.5, 1.0],
            name: Some("coat".into()),
            track: 7,
            confidence: 0.25,
        };
        let plain = FilledRegion { holes: Vec::new(), name: None, track: 2, confidence: 1.0, ..ring.clone() };
        let drawings =
            [FilledDrawing { frame: -1, regions: Vec::new() }, FilledDrawing { frame: 7, regions: vec![ring, plain] }];
        let found = RototoonFilled::of(&drawings).unwrap();
        assert_eq!((&found.frames[..], &found.region_offsets[..]), (&[-1, 7][..], &[0, 0, 2][..]));
        assert_eq!((&found.tracks[..], &found.doubtful[..]), (&[7, 2][..], &[1, 0][..]));
        assert_eq!((&found.confidence[..], &found.colours[..3]), (&[0.25, 1.0][..], &[0.0, 0.5, 1.0][..]));
        assert_eq!((&found.outline_offsets[..], &found.point_offsets[..]), (&[0, 3, 4][..], &[0, 3, 6, 10, 13][..]));
        assert_eq!(found.names, [Some("coat".to_owned()), None]);
        assert_eq!((found.points.len(), &found.points[6..8]), (26, &[5.0, 0.0][..]));
    }

    #[test]
    fn clicks_are_sorted_by_frame() {
        let places = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let colours = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.5];
        let found = clicks_by_frame(&[4, -2, 4], &places, &colours).unwrap();
        let at = |own: &FillClicks| (own.frame, own.clicks.iter().map(|click| click.at.x).collect::<Vec<_>>());
        assert_eq!(found.iter().map(at).collect::<Vec<_>>(), [(-2, vec![3.0]), (4, vec![1.0, 5.0])]);
        assert!(clicks_by_frame(&[], &[], &[]).unwrap().is_empty());
        let read: Value = serde_json::from_str(&fills_to_json(&found)).unwrap();
        assert_eq!(read[0], json!({"frame": -2, "regions": [{"at": [3.0, 4.0], "colour": [1.0, 1.0, 1.0]}]}));
    }

    #[test]
    fn wrong_clicks_are_named() {
        let said = |place: [f64; 2], colour: [f64; 3]| clicks_by_frame(&[3], &place, &colour).unwrap_err().to_string();
        assert_eq!(
            said([f64::NAN, 0.0], [0.0; 3]),
            "click 0 (frame 3): place: found (NaN, 0), expected pixels within ±1000000"
        );
        assert_eq!(
            said([1.0; 2], [0.0, 2.0, 0.0]),
            "click 0 (frame 3): colour: found 2, expected numbers from 0 to 1, or three NaN for no paint"
        );
        assert!(said([1.0; 2], [f64::NAN, 0.0, f64::NAN]).contains("colour: found NaN"));
        let bare = clicks_by_frame(&[3], &[1.0; 2], &[f64::NAN; 3]).unwrap();
        assert_eq!(bare[0].clicks[0].colour, None);
    }

    #[test]
    fn options_are_read_and_checked() {
        let asked = Asked::parse(r#"{"sensitivity": 2, "confidence": 0.5, "frames": [3, 5], "threads": 2}"#).unwrap();
        assert_eq!((asked.options().lines.sensitivity, asked.options().confidence), (2.0, 0.5));
        assert_eq!((asked.frames(), asked.threads), (Some(3..=5), 2));
        assert_eq!(Asked::parse("").unwrap().options(), FillOptions::default());
        let said = |json: &str| Asked::parse(json).unwrap_err().to_string();
        assert_eq!(said(r#"{"sensitivity": 0}"#), "options: sensitivity: found 0, expected a number from 0.1 to 10");
        assert_eq!(said(r#"{"confidence": 2}"#), "options: confidence: found 2, expected a number from 0 to 1");
        assert!(said(r#"{"style": "auto"}"#).starts_with("options: unknown field `style`"));
    }

    #[test]
    fn the_report_names_frames_and_clicks() {
        let frames = vec![FilledFrame { frame: 2, regions: 3, doubtful: 1, related: true, found: 3, bare: true }];
        let click = |click: usize| vec![MissedClick { frame: 2, at: Point::ONE, entry: 1, click }];
        let report = FillReport { frames, missed: click(4), overruled: click(5), ..FillReport::default() };
        let told: Value = serde_json::from_str(&report_to_json(&report)).unwrap();
        let frame = json!({"frame": 2, "regions": 3, "doubtful": 1, "related": true, "bare": true});
        let clicks = [4, 5].map(|click| json!([{"frame": 2, "click": click}]));
        assert_eq!(told, json!({"frames": [frame], "missed": clicks[0], "overruled": clicks[1], "leaking": []}));
        let gap = Gap { at: Point::new(3.5, 2.0), width: 4.0, beyond: Point::ONE, closes: true };
        let leaking = vec![LeakingClick { place: click(6)[0], gap, size: [20, 30] }];
        let told: Value = serde_json::from_str(&report_to_json(&FillReport { leaking, ..report })).unwrap();
        let leak = json!({"frame": 2, "click": 6, "parted": true, "gap": [3.5, 2.0], "width": 4.0, "size": [20, 30]});
        assert_eq!(told["leaking"], json!([leak]));
    }
}
