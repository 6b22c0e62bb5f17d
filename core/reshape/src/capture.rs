//! From tracked contours to a skeleton clip: all key points of a body's template on every frame (Liang et al. 2012,
//! section 3).
//!
//! The four calibration points of a limb determine its key points ([`rototoon_base::scene::limbs`]). Missing key points are
//! filled in, so every clip is complete:
//!
//! 1. A part is missing on a frame: the offset from the parent key point is interpolated linearly between frames that
//!    have it. Before the first and after the last of them it stays constant.
//! 2. A joint of a leg or limb is defined nowhere, but one beyond it is: it is on the way there, as in the template.
//! 3. A limb is defined nowhere: the offset is copied from the other side of the body, if that is known.
//! 4. Otherwise the template's typical posture serves, in the size of the torso. Legs and limbs hang as they do there;
//!    what else hangs on the torso turns with it.
//!
//! [`Captured::guessed`] counts the filled-in key points, and [`Captured::times`] says on which frames. On frames where the contours show the other side
//! ([`LimbSet::swaps`]) left and right are exchanged before anything is filled in.
//!
//! Coordinates are those of the tracked contours: pixels, x right, y down.

use rototoon_base::geometry::Point;
use rototoon_base::scene::clip::{Guessed, times};
use rototoon_base::scene::limbs::{BindingError, Bound, LimbSet};
use rototoon_base::scene::template::length;
use rototoon_base::scene::{FrameNumber, Part, Template};
use std::ops::RangeInclusive;

/// Key points of a frame that the contours determine; `None` where they do not.
pub type Seen = Vec<Option<Point>>;

/// A clip captured from contours.
#[derive(Clone, Debug, PartialEq)]
pub struct Captured {
    /// The first frame.
    pub first: FrameNumber,
    /// A posture for each frame.
    pub postures: Vec<Vec<Point>>,
    /// For each key point the number of frames on which it was filled in.
    pub guessed: Vec<usize>,
    /// The frames of the clip on which key points were filled in.
    pub times: Guessed,
}

/// Why a capture failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CaptureError {
    /// The document has no limbs.
    #[error("limbs: found none, expected at least the torso ({torso})")]
    NoLimbs {
        /// The names of its key points.
        torso: String,
    },
    /// A calibration point cannot be found on its contour.
    #[error("limbs[{limb}] ({name}).{end}.points[{point}].{source}")]
    Binding {
        /// Index of the limb.
        limb: usize,
        /// The names of its key points, such as `r_hip to r_knee`.
        name: String,
        /// `start` or `end`.
        end: &'static str,
        /// Index of the calibration point, 0 or 1.
        point: usize,
        /// The error of the binding.
        source: BindingError,
    },
    /// No frame shows the torso.
    #[error(
        "frames {first} to {last}: found no frame on which limbs give both {root} and {end}, expected at least one"
    )]
    NoTorso {
        /// Name of the torso's first key point.
        root: String,
        /// Name of its last key point.
        end: String,
        /// First frame requested.
        first: FrameNumber,
        /// Last frame requested.
        last: FrameNumber,
    },
    /// The ends of the torso coincide.
    #[error("frame {frame}: found {root} and {end} at one point, expected a torso with a length")]
    FlatTorso {
        /// Name of the torso's first key point.
        root: String,
        /// Name of its last key point.
        end: String,
        /// The frame.
        frame: FrameNumber,
    },
}

/// Limbs that are bound to contours.
pub struct Bindings<'a> {
    set: &'a LimbSet,
    parts: &'a [Part],
    ends: Vec<[[Bound; 2]; 2]>,
}

impl<'a> Bindings<'a> {
    /// Binds all calibration points to their contours.
    ///
    /// # Errors
    ///
    /// [`CaptureError::NoLimbs`] or [`CaptureError::Binding`].
    pub fn new(set: &'a LimbSet, parts: &'a [Part]) -> Result<Self, CaptureError> {
        if set.limbs.is_empty() {
            let named = |k: &usize| set.template.point_name(*k);
            let torso = set.template.torso().iter().map(named).collect::<Vec<_>>().join(", ");
            return Err(CaptureError::NoLimbs { torso });
        }
        let bind = |limb, end, point| bind(set, parts, (limb, end, point));
        let end = |limb, end| Ok([bind(limb, end, 0)?, bind(limb, end, 1)?]);
        let ends = (0..set.limbs.len()).map(|limb| Ok([end(limb, "start")?, end(limb, "end")?]));
        Ok(Self { set, parts, ends: ends.collect::<Result<_, CaptureError>>()? })
    }

    /// All calibration points that cannot be found on their contours, each as its error.
    pub fn problems(set: &LimbSet, parts: &[Part]) -> Vec<CaptureError> {
        let points = ["start", "end"].into_iter().flat_map(|end| [(end, 0), (end, 1)]);
        let all = (0..set.limbs.len()).flat_map(|limb| points.clone().map(move |(end, point)| (limb, end, point)));
        all.filter_map(|place| bind(set, parts, place).err()).collect()
    }

    /// Both key points of a limb on a frame (eqs. 2, 3); `None` for an end whose part is missing there.
    pub fn limb(&self, limb: usize, frame: FrameNumber) -> [Option<Point>; 2] {
        let shares = [self.set.limbs[limb].start.share, self.set.limbs[limb].end.share];
        std::array::from_fn(|end| {
            let [a, b] = &self.ends[limb][end];
            Some(a.at(self.parts, frame)?.lerp(b.at(self.parts, frame)?, shares[end]))
        })
    }

    /// The binding of calibration point `point` at end `end` (0 is the start) of a limb.
    pub fn bound(&self, limb: usize, end: usize, point: usize) -> &Bound {
        &self.ends[limb][end][point]
    }

    /// Key points of a frame from the contours, left and right as drawn. A key point of several limbs gets their mean.
    pub fn drawn(&self, frame: FrameNumber) -> Seen {
        let mut sums = vec![(Point::ZERO, 0.0); self.set.template.len()];
        for (k, limb) in self.set.limbs.iter().enumerate() {
            for (point, found) in [limb.from, limb.to].into_iter().zip(self.limb(k, frame)) {
                if let Some(p) = found {
                    sums[point].0 += p;
                    sums[point].1 += 1.0;
                }
            }
        }
        sums.into_iter().map(|(sum, count)| (count > 0.0).then(|| sum / count)).collect()
    }

    /// Key points of a frame from the contours. Left and right are exchanged on the frames that the document marks as
    /// swapped.
    pub fn seen(&self, frame: FrameNumber) -> Seen {
        let drawn = self.drawn(frame);
        let mirrored = |k: usize| drawn[self.set.template.mirror(k)];
        if self.set.swapped(frame) { (0..drawn.len()).map(mirrored).collect() } else { drawn }
    }
}

/// Binds a calibration point: of a limb, at its `start` or `end`, the first (0) or the second (1).
fn bind(
    set: &LimbSet,
    parts: &[Part],
    (limb, end, point): (usize, &'static str, usize),
) -> Result<Bound, CaptureError> {
    let l = &set.limbs[limb];
    let given = if end == "start" { &l.start } else { &l.end };
    given.points[point].bind(parts).map_err(|source| {
        let [from, to] = [l.from, l.to].map(|k| set.template.point_name(k));
        CaptureError::Binding { limb, name: format!("{from} to {to}"), end, point, source }
    })
}

/// Captures a clip. It covers the given frames from the first to the last on which the limbs determine both ends of the
/// torso.
///
/// # Errors
///
/// A [`CaptureError`] if a limb cannot be bound or the torso is missing or has no length.
pub fn capture(set: &LimbSet, parts: &[Part], frames: RangeInclusive<FrameNumber>) -> Result<Captured, CaptureError> {
    let bindings = Bindings::new(set, parts)?;
    let template = set.template.as_ref();
    let mut all: Vec<(FrameNumber, Seen)> = frames.clone().map(|frame| (frame, bindings.seen(frame))).collect();
    all.iter_mut().for_each(|(_, seen)| complete_torso(template, seen));
    let end_of_torso = template.torso()[template.torso().len() - 1];
    let [root, end] = [0, end_of_torso].map(|k| template.point_name(k).to_owned());
    let ends = |seen: &Seen| seen[0].zip(seen[end_of_torso]);
    let told = |(_, seen): &(FrameNumber, Seen)| ends(seen).is_some();
    let (Some(begin), Some(last)) = (all.iter().position(told), all.iter().rposition(told)) else {
        return Err(CaptureError::NoTorso { root, end, first: *frames.start(), last: *frames.end() });
    };
    let all = &all[begin..=last];
    let flat = all.iter().find(|(_, seen)| ends(seen).is_some_and(|(a, b)| a.distance(b) <= 1e-6));
    if let Some((frame, _)) = flat {
        return Err(CaptureError::FlatTorso { root, end, frame: *frame });
    }
    let seen: Vec<Seen> = all.iter().map(|(_, seen)| seen.clone()).collect();
    let guessed = (0..template.len()).map(|k| seen.iter().filter(|frame| frame[k].is_none()).count()).collect();
    let missing = |k: usize| seen.iter().map(|frame| frame[k].is_none()).collect::<Vec<_>>();
    let times = (0..template.len()).map(|k| (k, times(&missing(k)))).filter(|(_, times)| !times.is_empty()).collect();
    Ok(Captured { first: all[0].0, postures: filled(template, &seen), guessed, times })
}

/// Fills in missing points of the torso: its ends from the legs and limbs that hang on them, what is between from the
/// ends.
fn complete_torso(template: &Template, seen: &mut Seen) {
    let (torso, typical) = (template.torso(), template.typical());
    let last = torso[torso.len() - 1];
    for end in [torso[0], last] {
        let hangs = template.hanging().into_iter().map(|chain| chain[0]).filter(|&k| template.parent(k) == end);
        let on: Option<Vec<Point>> = hangs.map(|k| seen[k]).collect();
        let middle = on.filter(|on| on.len() > 1).map(|on| on.iter().copied().sum::<Point>() / on.len() as f64);
        seen[end] = seen[end].or(middle);
    }
    let whole = length(&typical, torso);
    for (k, &point) in torso.iter().enumerate().skip(1).take(torso.len() - 2) {
        let share = length(&typical, &torso[..=k]) / whole;
        seen[point] = seen[point].or(seen[0].zip(seen[last]).map(|(a, b)| a.lerp(b, share)));
    }
}

/// Postures with all missing key points filled in.
fn filled(template: &Template, seen: &[Seen]) -> Vec<Vec<Point>> {
    let mut made = vec![vec![Point::ZERO; template.len()]; seen.len()];
    let root: Vec<Option<Point>> = seen.iter().map(|frame| frame[0]).collect();
    for (posture, p) in made.iter_mut().zip(in_between(&root).unwrap_or_default()) {
        posture[0] = p;
    }
    for k in 1..template.len() {
        let parent = template.parent(k);
        let way = |k: usize| -> Option<Vec<Point>> {
            // The offset from the parent if the contours show it, otherwise from the root.
            let from = template.parent(k);
            let ways: Vec<_> = seen.iter().map(|frame| Some(frame[k]? - frame[from].or(frame[0])?)).collect();
            in_between(&ways)
        };
        let own = way(k);
        let beyond = if own.is_none() { joints_beyond(template, k) } else { Vec::new() };
        let found = own.or_else(|| way(template.mirror(k)));
        for (frame, seen) in seen.iter().enumerate() {
            let from = made[frame][parent];
            let end = beyond.iter().find_map(|&(end, share)| Some((seen[end]?, share)));
            made[frame][k] = match (seen[k], end, &found) {
                (Some(p), ..) => p,
                (None, Some((end, share)), _) => from.lerp(end, share),
                (None, None, Some(ways)) => from + ways[frame],
                (None, None, None) => from + typical_way(template, k, &made[frame]),
            };
        }
    }
    made
}

/// The joints beyond a joint of a leg or limb, the nearest first, each with the share of the way to it, as in the template.
fn joints_beyond(template: &Template, joint: usize) -> Vec<(usize, f64)> {
    let chains = template.hanging();
    let chain = chains.into_iter().find(|chain| chain[1..].contains(&joint)).unwrap_or_default();
    let Some(at) = chain.iter().position(|k| *k == joint) else { return Vec::new() };
    let typical = template.typical();
    let bone = length(&typical, &chain[at - 1..=at]);
    let share = |end: usize| bone / length(&typical, &chain[at - 1..=end]).max(f64::MIN_POSITIVE);
    (at + 1..chain.len()).map(|end| (chain[end], share(end))).collect()
}

/// The offset of a key point from its parent in the typical posture, in the size of a posture whose earlier key points are
/// known. Legs and limbs hang as they do there; the rest turns with the torso.
fn typical_way(template: &Template, k: usize, posture: &[Point]) -> Point {
    let typical = template.typical();
    let torso = template.torso();
    let whole = |posture: &[Point]| posture[torso[torso.len() - 1]] - posture[0];
    let size = template.torso_length(posture) / template.torso_length(&typical);
    let turn = match template.on_limb(k) {
        true => Point::X,
        false => Point::from_angle(whole(&typical).angle_to(whole(posture))),
    };
    turn.rotate(typical[k] - typical[template.parent(k)]) * size
}

/// Values on all frames: linear between the known ones, constant before the first and after the last. `None` if no
/// value is known.
fn in_between(values: &[Option<Point>]) -> Option<Vec<Point>> {
    let known: Vec<(usize, Point)> = values.iter().enumerate().filter_map(|(k, v)| Some((k, (*v)?))).collect();
    let (first, last) = (known.first()?, known.last()?);
    let at = |frame: usize| {
        let after = known.partition_point(|(k, _)| *k < frame);
        match (after.checked_sub(1).map(|k| known[k]), known.get(after)) {
            (Some((a, p)), Some((b, q))) => p.lerp(*q, (frame - a) as f64 / (b - a) as f64),
            (None, _) => first.1,
            (_, None) => last.1,
        }
    };
    Some((0..values.len()).map(at).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::limbs::{Binding, Calibration, Limb, LimbEnd};
    use std::collections::BTreeMap;

    /// A part of four points around each of two ends; on frame f of 0 to 4 it is moved by (f, 0).
    fn part(name: &str, from: Point, to: Point, frames: &[FrameNumber]) -> Part {
        let side = Point::new(0.0, 1.0);
        let at = |frame: &FrameNumber| {
            let shift = Point::new(f64::from(*frame), 0.0);
            (*frame, [from - side, to - side, to + side, from + side].map(|p| p + shift).to_vec())
        };
        Part { name: name.into(), closed: true, keys: frames.iter().map(at).collect(), ..Part::default() }
    }

    fn limb(from: usize, to: usize, part: &str) -> Limb {
        let end = |a: f64, b: f64| LimbEnd {
            points: [a, b].map(|at| Calibration { part: part.into(), binding: Binding::Place(at) }),
            share: 0.5,
        };
        Limb {
            from,
            to,
            start: end(0.0, 3.0),
            end: end(1.0, 2.0),
            carries: Vec::new(),
            bends: BTreeMap::new(),
            rigidity: 1.0,
        }
    }

    const EVERY: [FrameNumber; 5] = [0, 1, 2, 3, 4];

    fn figure() -> (LimbSet, Vec<Part>) {
        let v = Point::new;
        let parts = vec![
            part("torso", v(0.0, 10.0), v(0.0, 0.0), &EVERY),
            part("arm", v(2.0, 0.0), v(6.0, 0.0), &[0, 1, 3, 4]),
            part("leg", v(1.0, 10.0), v(1.0, 20.0), &EVERY),
        ];
        let set =
            LimbSet { limbs: vec![limb(0, 2, "torso"), limb(8, 9, "arm"), limb(14, 15, "leg")], ..LimbSet::default() };
        (set, parts)
    }

    #[test]
    fn key_points_lie_between_their_calibration_points() {
        let (set, parts) = figure();
        let clip = capture(&set, &parts, 0..=4).unwrap();
        assert_eq!((clip.first, clip.postures.len()), (0, 5));
        for (frame, posture) in clip.postures.iter().enumerate() {
            let x = frame as f64;
            assert_eq!(posture[0], Point::new(x, 10.0));
            assert_eq!(posture[2], Point::new(x, 0.0));
            assert_eq!(posture[1], Point::new(x, 4.5));
            assert_eq!(posture[15], Point::new(x + 1.0, 20.0));
        }
    }

    #[test]
    fn what_is_missing_is_filled_in_and_told() {
        let (set, parts) = figure();
        let clip = capture(&set, &parts, 0..=4).unwrap();
        assert_eq!(clip.guessed[9], 1);
        assert_eq!((&clip.times[&9][..], &clip.times[&6][..]), (&[[2, 2]][..], &[[0, 4]][..]));
        assert!(!clip.times.contains_key(&15), "the knee is told on all frames");
        assert!(clip.postures[2][9].distance(Point::new(8.0, 0.0)) < 1e-12, "the arm's part is not there on frame 2");
        // The other arm copies this one, and so does the other leg.
        assert!(clip.postures[1][6].distance(clip.postures[1][9]) < 1e-12);
        assert_eq!(clip.guessed[6], 5);
        // The head stands on the neck; the hand hangs.
        assert!(clip.postures[0][4].y < clip.postures[0][3].y && clip.postures[0][3].y < 0.0);
        assert!(clip.postures[0][10].y > clip.postures[0][9].y);
        assert!(clip.postures.iter().flatten().all(|p| p.is_finite()));
    }

    #[test]
    fn a_knee_that_no_limb_shows_is_on_the_way_to_the_ankle() {
        let (mut set, parts) = figure();
        set.limbs[2].to = 16;
        let clip = capture(&set, &parts, 0..=4).unwrap();
        let [hip, knee, ankle] = [14, 15, 16].map(|k| clip.postures[1][k]);
        assert!(knee.distance(hip.lerp(ankle, 0.8 / 1.55)) < 1e-12, "{hip} {knee} {ankle}");
    }

    #[test]
    fn swapped_sides_are_swapped_back() {
        let (mut set, parts) = figure();
        set.swaps = vec![(3, 4)];
        let clip = capture(&set, &parts, 0..=4).unwrap();
        assert_eq!(clip.postures[1][15], Point::new(2.0, 20.0));
        assert_eq!(clip.postures[4][12], Point::new(5.0, 20.0));
        assert_eq!((clip.guessed[15], clip.guessed[12]), (2, 3));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let (mut set, mut parts) = figure();
        assert_eq!(
            capture(&LimbSet::default(), &parts, 0..=4).unwrap_err().to_string(),
            "limbs: found none, expected at least the torso (pelvis, chest, neck)"
        );
        let error = capture(&set, &parts, 7..=9).unwrap_err().to_string();
        assert_eq!(
            error,
            "frames 7 to 9: found no frame on which limbs give both pelvis and neck, expected at least one"
        );
        set.limbs[1].end.points[1].part = "wing".into();
        let error = capture(&set, &parts, 0..=4).unwrap_err().to_string();
        assert_eq!(
            error,
            "limbs[1] (r_shoulder to r_elbow).end.points[1].part: found \"wing\", expected one of torso, arm, leg"
        );
        set.limbs.truncate(1);
        parts[0].keys.insert(2, vec![Point::ONE; 4]);
        let error = capture(&set, &parts, 0..=4).unwrap_err().to_string();
        assert_eq!(error, "frame 2: found pelvis and neck at one point, expected a torso with a length");
    }
}
