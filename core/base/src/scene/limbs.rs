//! Limbs of a drawn character: the points of its contours that determine its key points.
//!
//! A limb leads from one key point of a skeleton template to another. At either end two calibration points are on
//! tracked contours, and the key point is between them: p_j = (1 − ω_j) p₁ + ω_j p₂, p_{j+1} = (1 − ω_{j+1}) p₃ +
//! ω_{j+1} p₄ (Liang et al. 2012, eqs. 2, 3).
//!
//! Calibration points are bound to parameters of a contour: 2.25 is a quarter of the way from control point 2 to the
//! next one. They therefore follow the tracked contour, and one or two keys are enough to draw them on. If they are
//! drawn on several keys, their parameter is interpolated between these.
//!
//! Points are in pixels of the footage, x right and y down.

use super::{FrameNumber, Part, Template};
use crate::geometry::{Point, polyline};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Greatest distance of a drawn point from its contour, as a share of the contour's length.
const REACH: f64 = 0.1;

/// The binding of a calibration point to its contour.
#[derive(Clone, Debug, PartialEq)]
pub enum Binding {
    /// A parameter of the contour, the same on all frames.
    Place(f64),
    /// Points drawn on frames. Each is bound to the nearest point of the contour on its frame.
    Drawn(BTreeMap<FrameNumber, Point>),
}

/// A calibration point.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Name of the part whose contour carries the point.
    pub part: String,
    /// Its position on the contour.
    pub binding: Binding,
}

/// One end of a limb: a key point between two calibration points.
#[derive(Clone, Debug, PartialEq)]
pub struct LimbEnd {
    /// p₁ and p₂ (or p₃ and p₄).
    pub points: [Calibration; 2],
    /// ω: 0 at the first of these points, 1 at the second.
    pub share: f64,
}

/// A part that a limb carries.
#[derive(Clone, Debug, PartialEq)]
pub struct Carried {
    /// Name of the part.
    pub part: String,
    /// Share of the limb's rotation that a rigid part on the limb's end takes: 1 takes all, 0 keeps the angle in the
    /// picture.
    pub turn: f64,
}

/// A limb.
#[derive(Clone, Debug, PartialEq)]
pub struct Limb {
    /// Index of the key point where the limb begins, in the order of the set's template.
    pub from: usize,
    /// Index of the key point where it ends.
    pub to: usize,
    /// Its beginning.
    pub start: LimbEnd,
    /// Its end.
    pub end: LimbEnd,
    /// The parts that it carries when a drawing is reshaped.
    pub carries: Vec<Carried>,
    /// Control points of its Bézier spline by frame, in pixels.
    pub bends: BTreeMap<FrameNumber, Point>,
    /// Weight of the triangles around it. If two triangles cannot both stay rigid, the heavier one bends less.
    pub rigidity: f64,
}

/// A mark "in front" or "behind", for a range of frames.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthMark {
    /// Name of the part in front.
    pub front: String,
    /// Name of the part behind it.
    pub behind: String,
    /// First frame.
    pub first: FrameNumber,
    /// Last frame.
    pub last: FrameNumber,
}

/// What a part follows that no limb carries.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Follow {
    /// Another part, by name: it moves as what carries that part.
    Part(String),
    /// The way of the pelvis: it moves without turning.
    Root,
    /// The contact with the ground: it goes along the ground with the pelvis, as a cast shadow does.
    Contact,
    /// Nothing: it stays where it is drawn.
    Nothing,
}

/// The limbs of a character, and the marks needed to read its drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LimbSet {
    /// The body's template.
    pub template: Arc<Template>,
    /// The limbs. A key point that several limbs determine is the mean of their points.
    pub limbs: Vec<Limb>,
    /// Ranges of frames, first and last included, on which the contours show the other side: left and right change
    /// places.
    pub swaps: Vec<(FrameNumber, FrameNumber)>,
    /// Marks of the order in depth.
    pub marks: Vec<DepthMark>,
    /// By name what parts follow that no limb carries.
    pub follows: Vec<(String, Follow)>,
}

/// Why a calibration point cannot be bound.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BindingError {
    /// No part has this name.
    #[error("part: found {found:?}, expected one of {known}")]
    Part {
        /// The name in the document.
        found: String,
        /// The names of all parts.
        known: String,
    },
    /// The contour has no such parameter.
    #[error("at: found {found}, expected 0 to {last} on {part:?}")]
    Place {
        /// The part.
        part: String,
        /// The parameter.
        found: f64,
        /// The last parameter of the contour.
        last: f64,
    },
    /// The part has no contour on the frame of a drawn point.
    #[error("drawn, frame {frame}: found no contour of {part:?}, expected a frame with one")]
    NoContour {
        /// The part.
        part: String,
        /// The frame.
        frame: FrameNumber,
    },
    /// A drawn point is too far from the contour.
    #[error(
        "drawn, frame {frame}: found a point {distance:.1} px from the contour of {part:?}, expected at most {reach:.1}"
    )]
    Off {
        /// The part.
        part: String,
        /// The frame.
        frame: FrameNumber,
        /// Its distance from the contour in pixels.
        distance: f64,
        /// The greatest allowed distance in pixels.
        reach: f64,
    },
    /// The binding contains no drawn point.
    #[error("drawn: found no point, expected one on at least one frame")]
    Nothing,
}

/// A bound calibration point: parameters by frame, in ascending order, at least one.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// Index of the part.
    pub part: usize,
    places: Vec<(FrameNumber, f64)>,
}

impl Calibration {
    /// Finds the part, and the parameters of the drawn points on its contour.
    ///
    /// # Errors
    ///
    /// A [`BindingError`].
    pub fn bind(&self, parts: &[Part]) -> Result<Bound, BindingError> {
        let Some(index) = parts.iter().position(|part| part.name == self.part) else {
            let known: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
            return Err(BindingError::Part { found: self.part.clone(), known: known.join(", ") });
        };
        let part = &parts[index];
        let last = if part.closed { part.point_count() } else { part.point_count().saturating_sub(1) } as f64;
        let places = match &self.binding {
            Binding::Place(place) if (0.0..=last).contains(place) && last > 0.0 => vec![(0, *place)],
            Binding::Place(found) => {
                return Err(BindingError::Place { part: self.part.clone(), found: *found, last });
            }
            Binding::Drawn(points) => {
                points.iter().map(|(&frame, &p)| place_of(part, frame, p)).collect::<Result<_, _>>()?
            }
        };
        if places.is_empty() { Err(BindingError::Nothing) } else { Ok(Bound { part: index, places }) }
    }
}

/// The parameter of the contour's point nearest to a drawn point.
fn place_of(part: &Part, frame: FrameNumber, p: Point) -> Result<(FrameNumber, f64), BindingError> {
    let none = || BindingError::NoContour { part: part.name.clone(), frame };
    let points = part.points_at(frame).filter(|points| points.len() > 1).ok_or_else(none)?;
    let reach = REACH * polyline::length(points, part.closed);
    let mut best = (f64::INFINITY, 0.0);
    for (segment, (a, b)) in polyline::segments(points, part.closed).enumerate() {
        let on = polyline::nearest_on_segment(p, a, b);
        let distance = p.distance(on);
        if distance < best.0 {
            let length = a.distance(b);
            best = (distance, segment as f64 + if length > 0.0 { a.distance(on) / length } else { 0.0 });
        }
    }
    if best.0 <= reach {
        Ok((frame, best.1))
    } else {
        Err(BindingError::Off { part: part.name.clone(), frame, distance: best.0, reach })
    }
}

impl Bound {
    /// The point on a frame in pixels; `None` if the part has no contour there.
    pub fn at(&self, parts: &[Part], frame: FrameNumber) -> Option<Point> {
        let part = &parts[self.part];
        let points = part.points_at(frame).filter(|points| !points.is_empty())?;
        let place = self.place(frame, if part.closed { Some(points.len() as f64) } else { None });
        let n = points.len();
        let before = place.floor() as usize;
        let (a, b) =
            if part.closed { (before % n, (before + 1) % n) } else { (before.min(n - 1), (before + 1).min(n - 1)) };
        Some(points[a].lerp(points[b], place - place.floor()))
    }

    /// The parameter on a frame. On a closed contour of `around` segments it moves the shorter way round.
    pub fn place(&self, frame: FrameNumber, around: Option<f64>) -> f64 {
        let after = self.places.partition_point(|(key, _)| *key < frame);
        let (before, after) = match (after.checked_sub(1).map(|k| self.places[k]), self.places.get(after)) {
            (Some(before), Some(after)) => (before, *after),
            (Some(only), None) => return only.1,
            (None, only) => return only.map_or(0.0, |only| only.1),
        };
        let share = f64::from(frame - before.0) / f64::from(after.0 - before.0);
        let mut way = after.1 - before.1;
        if let Some(around) = around {
            way -= around * (way / around).round();
        }
        let place = before.1 + share * way;
        around.map_or(place, |around| place.rem_euclid(around))
    }
}

impl LimbSet {
    /// Whether left and right change places on a frame. Two swaps cancel out.
    pub fn swapped(&self, frame: FrameNumber) -> bool {
        self.swaps.iter().filter(|(first, last)| (*first..=*last).contains(&frame)).count() % 2 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Part {
        let at = |shift: f64| {
            [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)].map(|(x, y)| Point::new(x + shift, y)).to_vec()
        };
        Part {
            name: "box".into(),
            closed: true,
            keys: BTreeMap::from([(0, at(0.0)), (4, at(10.0))]),
            ..Part::default()
        }
    }

    fn calibration(binding: Binding) -> Calibration {
        Calibration { part: "box".into(), binding }
    }

    #[test]
    fn a_place_goes_with_the_contour() {
        let parts = [square()];
        let bound = calibration(Binding::Place(3.5)).bind(&parts).unwrap();
        assert_eq!(bound.at(&parts, 0), Some(Point::new(0.0, 2.0)));
        assert_eq!(bound.at(&parts, 4), Some(Point::new(10.0, 2.0)));
        assert_eq!(bound.at(&parts, 2), None);
    }

    #[test]
    fn drawn_points_slide_the_shorter_way() {
        let mut parts = [square()];
        parts[0].tracks.insert(2, parts[0].keys[&0].clone());
        let drawn = BTreeMap::from([(0, Point::new(-0.1, 1.0)), (4, Point::new(11.0, 0.2))]);
        let bound = calibration(Binding::Drawn(drawn)).bind(&parts).unwrap();
        assert_eq!(bound.at(&parts, 0), Some(Point::new(0.0, 1.0)));
        assert_eq!(bound.at(&parts, 2), Some(Point::new(0.0, 0.0)));
        assert_eq!(bound.at(&parts, 4), Some(Point::new(11.0, 0.0)));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let parts = [square()];
        let said = |binding: Binding| calibration(binding).bind(&parts).unwrap_err().to_string();
        assert_eq!(said(Binding::Place(4.5)), "at: found 4.5, expected 0 to 4 on \"box\"");
        assert!(said(Binding::Place(f64::NAN)).starts_with("at: found NaN"));
        assert_eq!(said(Binding::Drawn(BTreeMap::new())), "drawn: found no point, expected one on at least one frame");
        let far = Binding::Drawn(BTreeMap::from([(0, Point::new(8.0, 0.0))]));
        assert_eq!(said(far), "drawn, frame 0: found a point 4.0 px from the contour of \"box\", expected at most 1.6");
        let none = Binding::Drawn(BTreeMap::from([(3, Point::ZERO)]));
        assert_eq!(said(none), "drawn, frame 3: found no contour of \"box\", expected a frame with one");
        let other = Calibration { part: "arm".into(), binding: Binding::Place(0.0) };
        assert_eq!(other.bind(&parts).unwrap_err().to_string(), "part: found \"arm\", expected one of box");
    }

    #[test]
    fn two_swaps_are_none() {
        let set = LimbSet { swaps: vec![(0, 9), (5, 12)], ..LimbSet::default() };
        assert_eq!([-1, 3, 7, 11, 13].map(|frame| set.swapped(frame)), [false, true, false, true, false]);
    }
}
