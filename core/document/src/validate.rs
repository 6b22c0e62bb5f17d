//! Conditions for a document beyond its syntax.
//!
//! Errors make a document unusable. Warnings name data without effect (corrections outside of the keys) and probable
//! mistakes (contours without area). Such data stay in the document, since the artist made them.

use super::direction::reversed;
use super::problem::Problems;
use super::schema::{HELD, MAX_COORDINATE, MAX_FEATHER, MAX_FPS, MAX_FRAME_NUMBER, MAX_FRAMES, MAX_SIZE, MIN_FPS};
use super::shape::part_place;
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{Falloff, Footage, FrameNumber, FramePattern, Part, Scene};
use std::collections::{BTreeMap, BTreeSet};

/// All problems of a scene.
pub fn problems(scene: &Scene) -> Problems {
    let footage = &scene.footage;
    let raw = RawFootage {
        pattern: Some(footage.pattern.clone()),
        first: Some(footage.first.into()),
        last: Some(footage.last.into()),
        fps: Some(footage.fps),
        width: i64::try_from(footage.width).ok(),
        height: i64::try_from(footage.height).ok(),
        gaps: footage.held.then(|| HELD.to_owned()),
    };
    let mut problems = Problems::default();
    raw.checked(|field, message| problems.error(format!("footage.{field}"), message));
    problems.append(parts_problems(&scene.parts, Some(footage)));
    problems
}

/// The fields of a footage before they are checked.
pub(super) struct RawFootage {
    pub pattern: Option<String>,
    pub first: Option<i64>,
    pub last: Option<i64>,
    pub fps: Option<f64>,
    pub width: Option<i64>,
    pub height: Option<i64>,
    pub gaps: Option<String>,
}

impl RawFootage {
    /// The footage, if all fields are valid. Calls `error(field, message)` for each invalid field.
    pub fn checked(self, mut error: impl FnMut(&'static str, String)) -> Option<Footage> {
        let pattern = self.pattern.filter(|pattern| {
            let parsed = FramePattern::parse(pattern);
            if let Err(problem) = &parsed {
                error("pattern", problem.to_string());
            }
            parsed.is_ok()
        });
        let mut whole = |field, value: Option<i64>, low: i64, high: i64| {
            value.filter(|value| {
                let fits = (low..=high).contains(value);
                if !fits {
                    error(field, format!("found {value}, expected {low} to {high}"));
                }
                fits
            })
        };
        let first = whole("first", self.first, -MAX_FRAME_NUMBER, MAX_FRAME_NUMBER);
        let last = whole("last", self.last, -MAX_FRAME_NUMBER, MAX_FRAME_NUMBER);
        let width = whole("width", self.width, 1, MAX_SIZE as i64);
        let height = whole("height", self.height, 1, MAX_SIZE as i64);
        let fps = self.fps.filter(|fps| {
            let fits = (MIN_FPS..=MAX_FPS).contains(fps);
            if !fits {
                error("fps", format!("found {fps:?}, expected {MIN_FPS} to {MAX_FPS}"));
            }
            fits
        });
        let gaps = self.gaps.as_deref();
        if let Some(found) = gaps.filter(|gaps| *gaps != HELD) {
            error("gaps", format!("found {found:?}, expected {HELD:?}, or no such field"));
        }
        if let (Some(first), Some(last)) = (first, last) {
            if last < first {
                error("last", format!("found {last}, expected at least the first frame, {first}"));
                return None;
            }
            if last - first >= MAX_FRAMES {
                error("last", format!("found {} frames, expected at most {MAX_FRAMES}", last - first + 1));
                return None;
            }
        }
        Some(Footage {
            pattern: pattern?,
            first: FrameNumber::try_from(first?).ok()?,
            last: FrameNumber::try_from(last?).ok()?,
            fps: fps?,
            width: usize::try_from(width?).ok()?,
            height: usize::try_from(height?).ok()?,
            held: gaps == Some(HELD),
        })
    }
}

/// All problems of the parts of a document.
pub(super) fn parts_problems(parts: &[Part], footage: Option<&Footage>) -> Problems {
    let mut problems = Problems::default();
    if parts.is_empty() {
        problems.warning("parts", "there is no part, so there is nothing to track");
    }
    let mut first_of = BTreeMap::new();
    for (index, part) in parts.iter().enumerate() {
        let place = part_place(index, Some(&part.name));
        if part.name.is_empty() {
            problems.error(format!("{place}.name"), "found no name, expected a unique one");
        } else if let Some(first) = first_of.get(&part.name) {
            problems.error(format!("{place}.name"), format!("found the name of parts[{first}], expected a unique one"));
        } else {
            first_of.insert(&part.name, index);
        }
        PartCheck { part, place, footage, problems: &mut problems }.run();
    }
    problems
}

/// The check of one part.
struct PartCheck<'a> {
    part: &'a Part,
    place: String,
    footage: Option<&'a Footage>,
    problems: &'a mut Problems,
}

impl PartCheck<'_> {
    fn run(mut self) {
        if !self.part.depth.is_finite() {
            self.error("depth", format!("found {}, expected a finite number", self.part.depth));
        }
        self.coordinates();
        self.keys();
        self.pins();
        self.centers();
        self.absence();
        self.feather();
        self.results();
    }

    fn error(&mut self, below: impl AsRef<str>, message: impl Into<String>) {
        self.problems.error(format!("{}.{}", self.place, below.as_ref()), message);
    }

    fn warning(&mut self, below: impl AsRef<str>, message: impl Into<String>) {
        self.problems.warning(format!("{}.{}", self.place, below.as_ref()), message);
    }

    fn coordinates(&mut self) {
        let part = self.part;
        for (field, frames) in [("keys", &part.keys), ("tracks", &part.tracks)] {
            for (frame, points) in frames {
                self.points(points, |index| format!("{field}.\"{frame}\"[{index}]"));
            }
        }
        for (frame, pins) in &part.pins {
            for (index, &point) in pins {
                self.points(&[point], |_| format!("pins.\"{frame}\".\"{index}\""));
            }
        }
        for (frame, &center) in &part.centers {
            self.points(&[center], |_| format!("centers.\"{frame}\""));
        }
        for (frame, paths) in &part.curves {
            for (segment, path) in paths.iter().enumerate() {
                self.points(path, |index| format!("curves.\"{frame}\"[{segment}][{index}]"));
            }
        }
    }

    fn points(&mut self, points: &[Point], place: impl Fn(usize) -> String) {
        for (index, point) in points.iter().enumerate() {
            if !(point.is_finite() && point.abs().max_element() <= MAX_COORDINATE) {
                let found = format!("found [{:?}, {:?}]", point.x, point.y);
                self.error(
                    place(index),
                    format!("{found}, expected coordinates from -{MAX_COORDINATE} to {MAX_COORDINATE}"),
                );
            }
        }
    }

    fn keys(&mut self) {
        let part = self.part;
        if part.keys.is_empty() {
            self.warning("keys", "there is no key, so the part is not tracked");
        }
        let Some((first, points)) = part.keys.first_key_value() else { return };
        match points.len() {
            0 => self.warning("keys", "the part has no points, so there is nothing to track"),
            1 if part.closed => self.warning("keys", "the part is closed but has 1 point, which encloses no area"),
            2 if part.closed => self.warning("keys", "the part is closed but has 2 points, which enclose no area"),
            1 => self.warning("keys", "the part has one point, which makes no contour"),
            _ => {}
        }
        for (frame, key) in &part.keys {
            let place = format!("keys.\"{frame}\"");
            if key.len() != points.len() {
                let expected = format!("expected {} as on the part's first key, frame {first}", points.len());
                self.error(&place, format!("found {}, {expected}", counted(key.len(), "point")));
            }
            self.frame_inside(&place, *frame);
            self.contour(&place, key);
        }
        for [before, frame] in reversed(part) {
            let told = format!("the contour fits that of frame {before} much better in the other direction");
            self.warning(format!("keys.\"{frame}\""), format!("{told}: was it drawn from the other end?"));
        }
    }

    fn frame_inside(&mut self, place: &str, frame: FrameNumber) {
        if let Some(Footage { first, last, .. }) = self.footage
            && !(*first..=*last).contains(&frame)
        {
            self.error(place, format!("found frame {frame}, expected one of the footage, {first} to {last}"));
        }
    }

    fn contour(&mut self, place: &str, points: &[Point]) {
        const LEAST_AREA: f64 = 1e-6;
        if self.part.closed && points.len() > 2 && polygon::signed_area(points).abs() < LEAST_AREA {
            // A figure of eight has an area, but its two halves run in other directions.
            let (a, b) =
                (points[0], points.iter().copied().max_by(|p, q| farther(points[0], p, q)).unwrap_or(points[0]));
            let is_flat = points.iter().all(|p| (b - a).perp_dot(*p - a).abs() < LEAST_AREA);
            let told = if is_flat {
                "the contour encloses no area"
            } else {
                "the contour crosses itself or goes back on itself"
            };
            self.warning(place, told);
        }
        let (Some(footage), Some((low, high))) = (self.footage, polygon::bounds(points)) else { return };
        let size = Point::new(footage.width as f64, footage.height as f64);
        if low.cmpgt(size).any() || high.cmplt(Point::ZERO).any() {
            let picture = format!("{}x{}", footage.width, footage.height);
            self.warning(place, format!("the contour is completely outside of the picture of {picture} pixels"));
        }
    }

    fn pins(&mut self) {
        let part = self.part;
        let count = part.point_count();
        for (frame, pins) in &part.pins {
            let place = format!("pins.\"{frame}\"");
            for index in pins.keys().filter(|index| !part.keys.is_empty() && **index >= count) {
                self.error(
                    format!("{place}.\"{index}\""),
                    format!("found point {index}, expected one of 0 to {}", count.saturating_sub(1)),
                );
            }
            self.correction(&place, *frame);
        }
    }

    fn centers(&mut self) {
        let part = self.part;
        for frame in part.centers.keys() {
            self.correction(&format!("centers.\"{frame}\""), *frame);
        }
    }

    fn absence(&mut self) {
        let part = self.part;
        for (index, &[first, last]) in part.absent.iter().enumerate() {
            if last < first {
                let expected = "expected a first frame that is not after the last";
                self.error(format!("absent[{index}]"), format!("found frames {first} to {last}, {expected}"));
            } else if let Some((frame, _)) = part.keys.range(first..=last).next() {
                let why = "the part has a key there, so it is there on that frame";
                self.warning(
                    format!("absent[{index}]"),
                    format!("found frames {first} to {last}; frame {frame}: {why}"),
                );
            }
        }
        if let Some(frame) = part.tracks.keys().find(|frame| part.is_absent(**frame)) {
            let message = "found a contour where the part is absent, so it has no effect: track again";
            self.warning(format!("tracks.\"{frame}\""), message);
        }
    }

    fn feather(&mut self) {
        let part = self.part;
        for (index, width) in part.feather.iter().enumerate().filter(|(_, w)| !(0.0..=MAX_FEATHER).contains(*w)) {
            self.error(format!("feather[{index}]"), format!("found {width}, expected a width from 0 to {MAX_FEATHER}"));
        }
        let rate = part.falloff.rate;
        if !(Falloff::LEAST..=Falloff::MOST).contains(&rate) {
            let (least, most) = (Falloff::LEAST, Falloff::MOST);
            self.error("falloff", format!("found {rate}, expected a rate from {least} to {most}"));
        }
        let (found, count) = (part.feather.len(), part.point_count());
        if found > 0 && found != count {
            let why =
                format!("but the keys have {}, so the widths are kept but have no effect", counted(count, "point"));
            self.warning("feather", format!("found {}, {why}", counted(found, "width")));
        } else if found > 0 && !part.closed {
            self.warning("feather", "the part is open and has no area, so the widths are kept but have no effect");
        }
    }

    fn correction(&mut self, place: &str, frame: FrameNumber) {
        if !acts(self.part, frame) {
            let why = if self.part.keys.contains_key(&frame) { "on a key" } else { "not between two keys" };
            self.warning(place, format!("frame {frame} is {why}, so the correction is kept but has no effect"));
        }
    }

    fn results(&mut self) {
        let part = self.part;
        let count = part.point_count();
        let stale: BTreeSet<_> =
            part.tracks.iter().filter(|(_, points)| points.len() != count).map(|(f, _)| f).collect();
        if let Some(frame) = stale.first() {
            let found = part.tracks[frame].len();
            self.warning(
                format!("tracks.\"{frame}\""),
                format!("found {}, but the keys have {count}: track again", counted(found, "point")),
            );
        }
        let uneven =
            part.confidence.iter().find(|(f, values)| part.tracks.get(f).is_none_or(|t| t.len() != values.len()));
        if let Some((frame, _)) = uneven {
            self.warning(
                format!("confidence.\"{frame}\""),
                "the number of values is not that of the tracked points: track again",
            );
        }
        for (frame, values) in &part.confidence {
            if let Some(index) = values.iter().position(|value| !(0.0..=1.0).contains(value)) {
                let found = values[index];
                self.warning(format!("confidence.\"{frame}\"[{index}]"), format!("found {found}, expected 0 to 1"));
            }
        }
        let segments = part.segment_count();
        if let Some((frame, paths)) = part.curves.iter().find(|(_, paths)| paths.len() != segments) {
            let found = counted(paths.len(), "path");
            let are = if segments == 1 { "is" } else { "are" };
            self.warning(
                format!("curves.\"{frame}\""),
                format!("found {found}, but there {are} {}: snap again", counted(segments, "segment")),
            );
        }
    }
}

/// A number with its noun.
fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Whether a correction on this frame has an effect: the frame is between two keys, or differs from that of the only
/// key.
pub fn acts(part: &Part, frame: FrameNumber) -> bool {
    let (Some((&first, _)), Some((&last, _))) = (part.keys.first_key_value(), part.keys.last_key_value()) else {
        return false;
    };
    (first == last || first < frame && frame < last) && !part.keys.contains_key(&frame)
}

fn farther(from: Point, p: &Point, q: &Point) -> std::cmp::Ordering {
    from.distance(*p).total_cmp(&from.distance(*q))
}
