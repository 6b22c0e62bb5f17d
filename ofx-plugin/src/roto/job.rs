//! What is tracked, and how the core's tracker runs on the source's frames.
//!
//! The tracker runs on threads of its own. Only the thread of the action calls the host: it fetches frames, reports progress
//! and checks whether the user has cancelled. Hosts do not allow these calls on other threads.

use super::fetching::{Clerk, HostFrames};
use super::film::{Kept, Terms};
use super::reach::{Reach, widen_to_tracks};
use super::shot;
use crate::ofx::progress::Bar;
use crate::ofx::{Clip, Effect, Failure};
use crate::parameters::shared;
use rototoon::pipeline;
use rototoon::project::Document;
use rototoon::scene::{Cancelled, Colour, FrameNumber, Progress, Scene};
use rototoon::track::{Preset, TrackError, TrackOptions, Tracker, Tracking};
use std::cell::Cell;
use std::ops::RangeInclusive;
use std::sync::mpsc::channel;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Time between two checks whether the user has cancelled.
const PACE: Duration = Duration::from_millis(40);
/// Fewest frames that are kept while the tracker runs, however large they are. It goes back to the last ones often.
const FEWEST: usize = 4;
/// Bytes of a GB, in which the memory of *Live* is given. So much is used for frames while the tracker runs, or more with *Live*.
const GIGABYTE: f64 = (1 << 30) as f64;

/// What is tracked.
pub struct Job {
    /// The parts, with only the keys and corrections in the range.
    scene: Scene,
    range: RangeInclusive<FrameNumber>,
    /// The footage's frames that the source has.
    frames: RangeInclusive<FrameNumber>,
    /// Whether the user has left out frames of the source.
    is_limited: bool,
    offset: i32,
    /// The frames of the source.
    reach: Reach,
    options: TrackOptions,
    live: bool,
    /// Most bytes of frames that stay in memory.
    memory: f64,
}

/// What was tracked.
#[derive(Clone, Debug)]
pub struct Tracked {
    /// The document with its new tracks.
    pub document: Document,
    /// The parts that were tracked.
    pub parts: Vec<usize>,
    /// The frames on which they were.
    pub range: RangeInclusive<FrameNumber>,
    /// Whether the user has left out frames of the source.
    pub is_limited: bool,
}

impl Tracked {
    /// Whether all frames of a span were tracked. The source may have fewer frames than the document.
    pub fn has(&self, [first, last]: &[FrameNumber; 2]) -> bool {
        !self.is_limited || self.range.contains(first) && self.range.contains(last)
    }
}

impl Job {
    /// The tracking of a document with the values of the parameters at a time.
    pub fn of(effect: &Effect, document: &Document, time: f64) -> Result<Self, Failure> {
        let parameters = effect.parameters()?;
        let clip_range = shot::of_source(effect)?;
        let clip_range =
            clip_range.ok_or_else(|| Failure::Told("connect the footage to the input Source first".into()))?;
        let offset = parameters.int(c"frameOffset", time)?;
        let chosen = [parameters.int(c"firstFrame", time)?, parameters.int(c"lastFrame", time)?];
        let footage = &document.scene.footage;
        // A source without end is tracked as far as the document goes.
        let own = [footage.first, footage.last].map(|frame| f64::from(frame) + f64::from(offset));
        let clip_range = clip_range.unwrap_or(own);
        let all = range(clip_range, [0; 2], offset);
        let range = range(clip_range, chosen, offset);
        let is_limited = range != all;
        let frames = footage.first.max(*all.start())..=footage.last.min(*all.end());
        let scene = within(&document.scene, range.clone());
        if scene.parts.iter().all(|part| part.keys.is_empty()) {
            let (first, last) = (range.start(), range.end());
            return Err(Failure::Told(format!("no part has a key in the project's frames {first} to {last}")));
        }
        let known = shared("preset").0;
        let preset = known.get(parameters.int(c"preset", time)?.max(0) as usize);
        let preset = preset.and_then(|(id, _)| Preset::from_id(id));
        let options = TrackOptions { preset: preset.unwrap_or_default(), ..TrackOptions::default() };
        let live = parameters.int(c"live", time)? != 0;
        let memory = parameters.double(c"liveMemory", time)? * GIGABYTE;
        let reach = Reach::of(effect)?;
        Ok(Self { scene, range, frames, is_limited, offset, reach, options, live, memory })
    }

    /// The circumstances.
    pub fn terms(&self) -> Terms {
        let footage = &self.scene.footage;
        Terms { offset: self.offset, size: [footage.width, footage.height], options: self.options }
    }

    /// Bytes of a frame.
    fn bytes(&self) -> f64 {
        let footage = &self.scene.footage;
        footage.width as f64 * footage.height as f64 * size_of::<Colour>() as f64
    }

    /// Whether these frames stay in memory for *Live*.
    pub fn stays(&self, kept: &Kept) -> bool {
        self.live && !kept.dropped && kept.frames.len() as f64 * self.bytes() <= self.memory
    }

    /// Most frames that are kept while the tracker runs.
    pub fn most(&self) -> usize {
        let memory = if self.live { self.memory.max(GIGABYTE) } else { GIGABYTE };
        ((memory / self.bytes().max(1.0)) as usize).max(FEWEST)
    }

    /// The document with its new tracks.
    pub fn merged(&self, document: &Document, tracking: Tracking) -> Result<Tracked, Failure> {
        let mut document = document.clone();
        merge(&mut document.scene, tracking, &self.range);
        self.reach.widen_own(&mut document.scene.footage);
        widen_to_tracks(&mut document.scene);
        let problems = document.problems();
        if problems.error_count() > 0 {
            return Err(Failure::Told(problems.to_string()));
        }
        let parts = (0..self.scene.parts.len()).filter(|&part| !self.scene.parts[part].keys.is_empty()).collect();
        Ok(Tracked { document, parts, range: self.range.clone(), is_limited: self.is_limited })
    }
}

/// The document's frames to track: those of the source, limited to the frames that the user has chosen.
fn range(clip: [f64; 2], chosen: [i32; 2], offset: i32) -> RangeInclusive<FrameNumber> {
    let (first, last) = (clip[0].ceil() as i32, clip[1].floor() as i32);
    let wanted = if chosen[0] < chosen[1] { chosen } else { [first, last] };
    let (first, last) = (first.max(wanted[0]), last.min(wanted[1]));
    first.saturating_sub(offset)..=last.saturating_sub(offset)
}

/// The scene with only these frames and their keys and corrections.
fn within(scene: &Scene, range: RangeInclusive<FrameNumber>) -> Scene {
    let mut scene = scene.clone();
    (scene.footage.first, scene.footage.last) = (*range.start(), *range.end());
    for part in &mut scene.parts {
        part.keys.retain(|frame, _| range.contains(frame));
        part.pins.retain(|frame, _| range.contains(frame));
        part.centers.retain(|frame, _| range.contains(frame));
    }
    pipeline::in_effect(&scene)
}

/// Stores new tracks in the scene. The scene keeps its tracks on frames outside the range, and the frames outside of it on which parts
/// were lost.
fn merge(scene: &mut Scene, mut tracking: Tracking, range: &RangeInclusive<FrameNumber>) {
    let mut wanted: Vec<Vec<FrameNumber>> = Vec::new();
    for (part, found) in scene.parts.iter().zip(&mut tracking.parts) {
        // A part without keys in the range was not tracked.
        let untouched = found.tracks.is_empty();
        let kept = |frame: &FrameNumber| untouched || !range.contains(frame);
        found
            .tracks
            .extend(part.tracks.iter().filter(|(frame, _)| kept(frame)).map(|(f, points)| (*f, points.clone())));
        let confidence = part.confidence.iter().filter(|(frame, _)| kept(frame));
        found.confidence.extend(confidence.map(|(frame, values)| (*frame, values.clone())));
        wanted.push(part.wants_key.iter().copied().filter(kept).collect());
    }
    pipeline::store(scene, &tracking);
    for (part, kept) in scene.parts.iter_mut().zip(wanted) {
        // A part is lost once on a side of its keys. What was found now counts.
        let is_new = |frame: &FrameNumber| {
            let between = |other: &FrameNumber| *frame.min(other)..=*frame.max(other);
            part.wants_key.iter().all(|other| part.keys.range(between(other)).next().is_some())
        };
        let kept: Vec<FrameNumber> = kept.into_iter().filter(is_new).collect();
        part.wants_key.extend(kept);
        part.wants_key.sort_unstable();
    }
}

/// Runs a tracker. Frames that are not among the kept ones come from the source; without a source they are an error.
///
/// After an error the tracker still has its earlier results.
pub fn run(
    effect: &Effect,
    source: Option<Clip>,
    job: &Job,
    kept: Kept,
    tracker: &mut Tracker,
) -> Result<(Tracking, Kept), Failure> {
    let (ask, asked) = channel();
    let scene = &job.scene;
    let frames = HostFrames::new(kept, ask);
    let board = Board::default();
    let pool = rayon::ThreadPoolBuilder::new().thread_name(|index| format!("rototoon-{index}")).build();
    let pool = pool.map_err(|error| Failure::Told(format!("cannot start threads to track on: {error}")))?;
    let bar = Bar::new(*effect, "Rototoon: tracking");
    let goes_on = || {
        if !board.cancelled() && !bar.update(board.done()) {
            board.cancel();
        }
        !board.cancelled()
    };
    let clerk = Clerk {
        effect,
        source,
        offset: job.offset,
        footage: &scene.footage,
        frames: job.frames.clone(),
        ground: Cell::new(None),
        sums: job.live,
        goes_on: &goes_on,
    };
    let result = std::thread::scope(|scope| {
        let worker = scope.spawn(|| pool.install(|| tracker.track(scene, &frames, &board)));
        loop {
            clerk.serve(&asked, PACE);
            goes_on();
            if worker.is_finished() {
                break;
            }
        }
        worker.join()
    });
    let Ok(result) = result else {
        // What the tracker keeps may be half-written. The user's edit is stored all the same.
        tracker.forget();
        return Err(Failure::Told("internal error: the tracker has stopped".into()));
    };
    if board.cancelled() {
        return Err(Failure::Aborted);
    }
    let tracking = result.map_err(|error| match error {
        TrackError::Cancelled(_) => Failure::Aborted,
        other => Failure::Told(other.to_string()),
    })?;
    Ok((tracking, frames.into_kept()))
}

/// The finished share of the work, and whether it is cancelled.
#[derive(Default)]
struct Board(Mutex<(f64, bool)>);

impl Board {
    fn with<T>(&self, look: impl FnOnce(&mut (f64, bool)) -> T) -> T {
        look(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn done(&self) -> f64 {
        self.with(|board| board.0)
    }

    fn cancelled(&self) -> bool {
        self.with(|board| board.1)
    }

    fn cancel(&self) {
        self.with(|board| board.1 = true);
    }
}

impl Progress for Board {
    fn report(&self, _step: &str, done: f64) -> Result<(), Cancelled> {
        self.with(|board| {
            board.0 = board.0.max(done.min(1.0));
            if board.1 { Err(Cancelled) } else { Ok(()) }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::geometry::Point;
    use rototoon::scene::{Footage, Part};
    use rototoon::track::{Ending, PartTrack, TrackEnd};

    #[test]
    fn the_range_is_in_the_clip_and_in_the_chosen_frames() {
        assert_eq!(range([1.0, 34.0], [0, 0], 1), 0..=33);
        assert_eq!(range([1.0, 34.0], [5, 80], 0), 5..=34);
        assert_eq!(range([1.5, 9.9], [7, 3], -10), 12..=19);
    }

    #[test]
    fn what_lies_outside_of_the_range_stays_lost() {
        let points = vec![Point::new(1.0, 2.0), Point::new(3.0, 4.0), Point::new(5.0, 1.0)];
        let part = |key: FrameNumber, wants_key: &[FrameNumber]| Part {
            keys: [(key, points.clone())].into(),
            tracks: [(key, points.clone())].into(),
            wants_key: wants_key.into(),
            ..Part::default()
        };
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 20, fps: 24.0, width: 8, height: 8, held: false };
        let parts = vec![part(7, &[5, 9]), part(1, &[2]), part(1, &[0, 9]), part(1, &[9])];
        let mut scene = Scene { footage, parts };
        let track =
            |ends: Vec<TrackEnd>| PartTrack { tracks: [(1, points.clone())].into(), ends, ..PartTrack::default() };
        let lost = || vec![TrackEnd { frame: 3, reason: Ending::Lost }];
        let parts = vec![PartTrack::default(), track(lost()), track(lost()), track(Vec::new())];
        merge(&mut scene, Tracking { parts, ..Tracking::default() }, &(0..=3));
        let wanted = scene.parts.iter().map(|part| part.wants_key.clone()).collect::<Vec<_>>();
        assert_eq!(wanted, [vec![5, 9], vec![3], vec![3], vec![9]]);
        assert_eq!(scene.parts[0].tracks.len(), 1);
    }
}
