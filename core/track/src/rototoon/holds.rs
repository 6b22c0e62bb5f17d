//! Gives a part one contour on all frames that show one drawing of it, where the pictures as a whole are others.
//!
//! **Why.** Frames that show one drawing are tracked once ([`drawings`](crate::shared::drawings)). But over a background that pans on ones no two
//! pictures are the same, so a drawing that is held on twos is tracked twice, with two contours. Mattes boil then, and an artist corrects twice.
//!
//! **How.** When all parts are tracked, each part is compared from frame to frame inside its contour ([`within`](crate::shared::within)), where it stands and
//! where the picture around the parts goes (the *pan*). Two frames are held for the part if its surer
//! contour, or the one that the artist made, encloses the same picture on both: then what is known of this contour on its own frame is just as true on the other
//! one. So the other frame takes it, moved with the picture, with its confidence. Frames held one after the other take the contour of the artist that
//! is nearest in time, or else the surest one, if it encloses the same picture there too. So slow movement does not add up.
//!
//! Contours that the artist made stay.
//!
//! What a part takes depends on its own contours and on the pictures alone. So a correction of another part changes nothing here. The pan is rounded to
//! whole working pixels for the same reason: it depends on where the parts are.
//!
//! **Memory.** What a contour was asked in the last run, and where the picture goes around the same contours, is kept ([`Memory`]). So after a pin
//! only the contours that it moved are compared again.
//!
//! **Limits.** The contours are known only when all is tracked, so the search for poses gains nothing. A part that is held behind one that moves is not found. A part that stands still and turns about itself without
//! any drawn sign of it is held.

use super::confidence::HELD;
use super::facts::Pair;
use super::stage::Kit;
use crate::contract::error::TrackError;
use crate::contract::tracking::{PartTrack, Tracking};
use crate::shared::features::{Features, LEVELS, working_scale};
use crate::shared::store::FLOW_LEVEL;
use crate::shared::within::Region;
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{FrameNumber, Scene, Span};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Share of the places whose flow must be as near to the pan, in working pixels.
const MOST: f64 = 0.6;
const WITH_IT: f64 = 1.5;
/// Of each so many columns and rows of the flow one is looked at, and so many places say something.
const EACH: usize = 2;
const FEW: usize = 64;

/// How a part's contour on a frame was made: the higher, the more it is worth.
type Rank = (u8, f64);

/// Contours and confidences that frames take from others.
type Taken = Vec<(FrameNumber, Vec<Point>, Vec<f64>)>;

/// What was found in the last run. It holds as long as the pictures are the same.
#[derive(Default)]
pub(super) struct Memory {
    /// By the part's name.
    asked: BTreeMap<String, Asked>,
    pans: Pans,
}

/// By the frame of a contour and the one that it was compared with: the answers for each shift.
type Asked = BTreeMap<Pair, Vec<Answer>>;

/// The answers for the contours of a part, by its name and the frames.
pub(super) type Said = (String, Pair, Vec<Answer>);

/// What was asked for a contour.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Answer {
    contour: Vec<Point>,
    shift: Point,
    found: Option<Point>,
}

/// By frame the pan to the next one, as far as a part has asked for it, and the contours around which it was measured.
type Pans = BTreeMap<FrameNumber, Pan>;
/// Contours, and the pan around them.
pub(super) type Pan = (Vec<Vec<Point>>, Option<Point>);

impl Memory {
    /// Whether nothing was asked yet.
    pub fn is_empty(&self) -> bool {
        self.asked.is_empty() && self.pans.is_empty()
    }

    /// What was found between the frames of a span: answers by name and pair of frames, and pans by frame.
    pub fn within(&self, span: Span) -> (Vec<Said>, Vec<(FrameNumber, Pan)>) {
        let is_in = |frame: FrameNumber| span.first <= frame && frame <= span.last;
        let of_part = |(name, asked): (&String, &Asked)| {
            let own = asked.iter().filter(|((a, b), _)| is_in(*a) && is_in(*b));
            own.map(|(pair, answers)| (name.clone(), *pair, answers.clone())).collect::<Vec<_>>()
        };
        let pans = self.pans.iter().filter(|(before, _)| is_in(**before) && is_in(**before + 1));
        (self.asked.iter().flat_map(of_part).collect(), pans.map(|(frame, pan)| (*frame, pan.clone())).collect())
    }

    /// Adds what was found in the same pictures.
    pub fn add(&mut self, asked: Vec<Said>, pans: Vec<(FrameNumber, Pan)>) {
        for (name, pair, answers) in asked {
            self.asked.entry(name).or_default().entry(pair).or_default().extend(answers);
        }
        self.pans.extend(pans);
    }
}

struct View<'a> {
    kit: Kit<'a>,
    scene: &'a Scene,
    tracking: &'a Tracking,
    /// Pixels of the picture per working pixel.
    scale: f64,
    memory: &'a Memory,
    /// Shared, because the pan is the same for all parts.
    pans: Mutex<Pans>,
}

/// A part whose frames are compared, with what was asked in this run.
struct Subject {
    part: usize,
    asked: Asked,
}

/// Looks at a window of a film before [`unite`] does, and remembers what it found. Of a film of which the store keeps only a part, each part would go through all frames, and
/// find none of them kept. All parts look at one window of frames together.
///
/// # Errors
///
/// As for [`unite`].
pub(super) fn look_at(
    window: Span,
    kit: Kit,
    (scene, tracking): (&Scene, &Tracking),
    memory: &mut Memory,
) -> Result<(), TrackError> {
    let view = View::new(kit, scene, tracking, memory);
    let parts = closed(scene);
    let of_part = |&part: &usize| {
        let mut of = Subject { part, asked: Asked::new() };
        let tracks = &tracking.parts[part].tracks;
        for before in (window.first..window.last).filter(|f| tracks.contains_key(f) && tracks.contains_key(&(f + 1))) {
            view.shift(&mut of, before, before + 1)?;
        }
        Ok(of.asked)
    };
    let asked: Vec<Result<Asked, TrackError>> = parts.par_iter().with_max_len(1).map(of_part).collect();
    let asked = asked.into_iter().collect::<Result<Vec<Asked>, TrackError>>()?;
    let pans = std::mem::take(&mut *view.pans());
    memory.pans.extend(pans);
    for (p, asked) in parts.into_iter().zip(asked) {
        memory.asked.entry(scene.parts[p].name.clone()).or_default().extend(asked);
    }
    Ok(())
}

/// The parts whose contours enclose something.
fn closed(scene: &Scene) -> Vec<usize> {
    (0..scene.parts.len()).filter(|&p| scene.parts[p].closed).collect()
}

/// Gives each closed part of a tracked scene one contour on the frames that show one drawing of it.
///
/// # Errors
///
/// The error of a picture that cannot be read, or the cancellation by the listener of `kit`.
pub(super) fn unite(kit: Kit, scene: &Scene, tracking: &mut Tracking, memory: &Memory) -> Result<Memory, TrackError> {
    let view = View::new(kit, scene, tracking, memory);
    let parts = closed(scene);
    let taken: Vec<Result<(Taken, Asked), TrackError>> =
        parts.par_iter().with_max_len(1).map(|&part| view.taken(Subject { part, asked: Asked::new() })).collect();
    let taken = taken.into_iter().collect::<Result<Vec<(Taken, Asked)>, TrackError>>()?;
    let mut found = Memory { pans: std::mem::take(&mut *view.pans()), ..Memory::default() };
    for (p, (taken, asked)) in parts.into_iter().zip(taken) {
        found.asked.insert(scene.parts[p].name.clone(), asked);
        let PartTrack { tracks, confidence, .. } = &mut tracking.parts[p];
        for (frame, points, sure) in taken {
            tracks.insert(frame, points);
            confidence.insert(frame, sure);
        }
    }
    Ok(found)
}

impl<'a> View<'a> {
    fn new(kit: Kit<'a>, scene: &'a Scene, tracking: &'a Tracking, memory: &'a Memory) -> Self {
        Self { kit, scene, tracking, scale: working_scale(scene.footage.height), memory, pans: Mutex::default() }
    }

    /// The contours that frames of a part take from others, and what was asked for them.
    fn taken(&self, mut of: Subject) -> Result<(Taken, Asked), TrackError> {
        let (part, track) = (&self.scene.parts[of.part], &self.tracking.parts[of.part]);
        let mut taken = Taken::new();
        let mut run: Vec<(FrameNumber, Point)> = Vec::new();
        for &frame in track.tracks.keys().filter(|frame| !part.is_absent(**frame)) {
            let next = match run.last() {
                Some(&(before, at)) if before + 1 == frame => {
                    self.kit.progress.report("Tracking", 1.0)?;
                    self.shift(&mut of, before, frame)?.map(|shift| at + shift)
                }
                _ => None,
            };
            if next.is_none() {
                self.settle(&mut of, &run, &mut taken)?;
                run.clear();
            }
            run.push((frame, next.unwrap_or_default()));
        }
        self.settle(&mut of, &run, &mut taken)?;
        Ok((taken, of.asked))
    }

    /// What the frames of a run of held ones, each with the part's place there, take from each other.
    fn settle(&self, of: &mut Subject, run: &[(FrameNumber, Point)], taken: &mut Taken) -> Result<(), TrackError> {
        let p = of.part;
        let track = &self.tracking.parts[p];
        let free = run.iter().filter(|(frame, _)| self.rank(p, *frame).0 == 0);
        for &(frame, at) in free.filter(|_| run.len() > 1) {
            let nearness = |from: FrameNumber| match self.rank(p, from) {
                (0, sure) => (0, sure, -from),
                (made, _) => (made.min(1), -f64::from((from - frame).abs()), -from),
            };
            let best = run.iter().max_by(|a, b| {
                let (a, b) = (nearness(a.0), nearness(b.0));
                a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2))
            });
            let is_other = |from: FrameNumber| from != frame && track.tracks[&from] != track.tracks[&frame];
            let Some(&(from, there)) = best.filter(|best| is_other(best.0)) else { continue };
            let Some(shift) = self.same(of, (from, frame), at - there)? else { continue };
            let points: Vec<Point> = track.tracks[&from].iter().map(|&q| q + shift * self.scale).collect();
            let sure = track.confidence.get(&from).map_or(&[][..], Vec::as_slice);
            taken.push((frame, points, passed_on(self.rank(p, from), sure)));
        }
        Ok(())
    }

    /// How far a part goes from a frame to the next one if both show one drawing of it. `None` if they do not.
    fn shift(&self, of: &mut Subject, before: FrameNumber, frame: FrameNumber) -> Result<Option<Point>, TrackError> {
        let tracks = &self.tracking.parts[of.part].tracks;
        if tracks[&before] == tracks[&frame] {
            return Ok(Some(Point::ZERO));
        }
        // Of one drawing in the same pictures, contours are others only where the artist made them so.
        if self.kit.held(&[before, frame], &|| Ok(()))?.contains(&true) {
            return Ok(None);
        }
        let [a, b] = [before, frame].map(|frame| self.rank(of.part, frame));
        let forwards = a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).is_ge();
        let pair = if forwards { (before, frame) } else { (frame, before) };
        let sign = if forwards { 1.0 } else { -1.0 };
        if let Some(shift) = self.same(of, pair, Point::ZERO)? {
            return Ok(Some(shift * sign));
        }
        let Some(pan) = self.kept_pan(before, frame)? else { return Ok(None) };
        Ok(self.same(of, pair, pan * sign)?.map(|shift| shift * sign))
    }

    /// The [pan](Self::pan), measured once for the same contours.
    fn kept_pan(&self, before: FrameNumber, frame: FrameNumber) -> Result<Option<Point>, TrackError> {
        if let Some(&(_, pan)) = self.pans().get(&before) {
            return Ok(pan);
        }
        let tracked = |track: &PartTrack| track.tracks.get(&before).map(|points| self.working(points));
        let contours: Vec<Vec<Point>> = self.tracking.parts.iter().filter_map(tracked).collect();
        let pan = match self.memory.pans.get(&before) {
            Some((around, pan)) if *around == contours => *pan,
            // Without the lock: two threads may both measure it, and find the same.
            _ => self.pan(&contours, before, frame)?,
        };
        self.pans().insert(before, (contours, pan));
        Ok(pan)
    }

    fn pans(&self) -> MutexGuard<'_, Pans> {
        self.pans.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Where the picture around contours goes from a frame to the next one, in working pixels: the median of the flow. `None` if
    /// it stays, or does not go as one.
    fn pan(
        &self,
        contours: &[Vec<Point>],
        before: FrameNumber,
        frame: FrameNumber,
    ) -> Result<Option<Point>, TrackError> {
        let flow = self.kit.store.flow(self.kit.frames, before, frame)?;
        let pixel = LEVELS[FLOW_LEVEL] as f64;
        let boxed: Vec<(&Vec<Point>, (Point, Point))> =
            contours.iter().filter_map(|contour| Some((contour, polygon::bounds(contour)?))).collect();
        let covers = |p: Point| {
            let within = |(low, high): (Point, Point)| low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y;
            boxed.iter().any(|&(contour, bounds)| within(bounds) && polygon::contains(contour, p))
        };
        let mut along = [Vec::new(), Vec::new()];
        for y in (0..flow.height()).step_by(EACH) {
            for x in (0..flow.width()).step_by(EACH) {
                if !covers(Point::new(x as f64 + 0.5, y as f64 + 0.5) * pixel) {
                    let [u, v] = flow.get(x, y);
                    along[0].push(u);
                    along[1].push(v);
                }
            }
        }
        let median = |values: &mut Vec<f32>| {
            let middle = values.len() / 2;
            f64::from(*values.select_nth_unstable_by(middle, f32::total_cmp).1) * pixel
        };
        let [across, down] = &mut along;
        if across.len() < FEW {
            return Ok(None);
        }
        let flows: Vec<Point> =
            across.iter().zip(&*down).map(|(&u, &v)| Point::new(f64::from(u), f64::from(v)) * pixel).collect();
        let pan = Point::new(median(across), median(down));
        let with_it = flows.iter().filter(|flow| flow.distance(pan) <= WITH_IT).count();
        let pan = pan.round();
        let is_pan = pan != Point::ZERO && with_it as f64 >= MOST * flows.len() as f64;
        Ok(is_pan.then_some(pan))
    }

    /// How far the picture goes within a part's contour from the first frame to the second one, if it is the same there. It is looked
    /// for at a shift, which is made exact unless it is none.
    fn same(
        &self,
        of: &mut Subject,
        frames: (FrameNumber, FrameNumber),
        shift: Point,
    ) -> Result<Option<Point>, TrackError> {
        let contour = self.working(&self.tracking.parts[of.part].tracks[&frames.0]);
        let before = self.memory.asked.get(&self.scene.parts[of.part].name);
        let before = before.and_then(|asked| asked.get(&frames)).map_or(&[][..], Vec::as_slice);
        let is_this = |known: &&Answer| known.shift == shift && known.contour == contour;
        let found = match before.iter().find(is_this) {
            Some(known) => known.found,
            None => {
                let [a, b] = [self.kit.colours(frames.0)?, self.kit.colours(frames.1)?];
                Region::within(&contour, &a).and_then(|region| held(&region, [&a, &b], shift))
            }
        };
        of.asked.entry(frames).or_default().push(Answer { contour, shift, found });
        Ok(found)
    }

    fn working(&self, points: &[Point]) -> Vec<Point> {
        points.iter().map(|&p| p / self.scale).collect()
    }

    /// Keys come before corrected contours, and these before others, which count by their confidence.
    fn rank(&self, p: usize, frame: FrameNumber) -> Rank {
        let part = &self.scene.parts[p];
        if part.keys.contains_key(&frame) {
            return (2, 1.0);
        }
        let corrected = part.pins.contains_key(&frame) || part.centers.contains_key(&frame);
        let sure = self.tracking.parts[p].confidence.get(&frame).map_or(&[][..], Vec::as_slice);
        (u8::from(corrected), sure.iter().sum::<f64>() / sure.len().max(1) as f64)
    }
}

/// The confidence of a contour on another frame of its drawing. What the artist made counts there as a key's drawing. What was only found does not, however sure it is:
/// it says nothing of which of two parts is which.
fn passed_on((made, _): Rank, sure: &[f64]) -> Vec<f64> {
    sure.iter().map(|sure| if made > 0 { sure.min(HELD) } else { *sure }).collect()
}

/// The exact shift at which a region shows the same in both pictures.
fn held(region: &Region, [a, b]: [&Arc<Features>; 2], shift: Point) -> Option<Point> {
    let shift = if shift == Point::ZERO { shift } else { region.settled(a, b, shift)? };
    region.same(a, b, shift).then_some(shift)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_the_artist_made_becomes_a_keys_drawing() {
        let sure = [1.0, 0.998, 0.3];
        assert_eq!(passed_on((2, 1.0), &sure), [HELD, HELD, 0.3], "a key");
        assert_eq!(passed_on((1, 0.8), &sure), [HELD, HELD, 0.3], "a correction");
        assert_eq!(passed_on((0, 0.8), &sure), sure);
        assert_eq!(passed_on((0, HELD), &[HELD; 3]), [HELD; 3], "a frame that holds a key's drawing");
    }
}
