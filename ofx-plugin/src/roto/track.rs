//! Runs the core's tracker on the source's frames.
//!
//! The tracker runs on threads of its own. Only the thread of the action calls the host: it fetches frames, reports progress
//! and checks whether the user has cancelled. Hosts do not allow these calls on other threads.

use super::placement::Placement;
use super::{edits, instance};
use crate::description::SOURCE;
use crate::encoding::Encoding;
use crate::ofx::progress::Bar;
use crate::ofx::{Clip, Effect, Failure, Image};
use crate::parameters::shared;
use crate::pixels::{CLEAR, Pixel};
use rototoon::geometry::Point;
use rototoon::pipeline;
use rototoon::project::Document;
use rototoon::scene::{Cancelled, Colour, FrameError, FrameNumber, FrameSource, Progress, Raster, Scene};
use rototoon::track::{Preset, TrackError, TrackOptions, Tracker, Tracking};
use std::collections::VecDeque;
use std::ops::RangeInclusive;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Time between two checks whether the user has cancelled.
const PACE: Duration = Duration::from_millis(40);
/// Most bytes of frames that are kept.
const KEPT: usize = 1 << 30;
type Picture = Arc<Raster<Colour>>;

/// Tracks the document's parts through the source's frames and stores the result in the document.
///
/// With *Live* the frames stay in memory, for [`follow`].
pub fn track(effect: &Effect, time: f64) -> Result<(), Failure> {
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    let document = instance.document(&parameters)?;
    let document = document.ok_or_else(|| Failure::Told("found no shapes to track: load a project first".into()))?;
    let job = Job::of(effect, &document, time)?;
    instance.keep_film(None);
    let (tracking, kept) = run(effect, Some(effect.clip(SOURCE)?), &job, VecDeque::new())?;
    if parameters.int(c"live", time)? != 0 && kept.len() < kept_frames(&job.scene) {
        instance.keep_film(Some(Arc::new(Film { offset: job.offset, size: size(&job.scene), pictures: kept })));
    }
    let (document, tracked) = job.merged(&document, tracking)?;
    edits::store_tracked(effect, &document, &tracked)
}

/// Tracks an edited document again on the frames that the last Track has left in memory, without a call for images: the
/// actions of the pen must not make one. Returns the tracked document and the parts that were tracked.
///
/// `None` if *Live* is off, a frame is not in memory, the host has no progress display to cancel in, or the user cancels.
/// The tracks then stay old, and the overlay says so.
pub fn follow(effect: &Effect, document: &Document, time: f64) -> Option<(Document, Vec<usize>)> {
    let (instance, parameters) = (instance(effect).ok()?, effect.parameters().ok()?);
    if parameters.int(c"live", time).ok()? == 0 || !Bar::exists(effect) {
        return None;
    }
    let film = instance.film()?;
    let job = Job::of(effect, document, time).ok()?;
    if (film.offset, film.size) != (job.offset, size(&job.scene)) {
        return None;
    }
    let busy = instance.begin_following()?;
    let result = run(effect, None, &job, film.pictures.clone());
    drop(busy);
    job.merged(document, result.ok()?.0).ok()
}

/// Frames of the source that stay in memory after a Track.
#[derive(Debug)]
pub struct Film {
    offset: i32,
    size: [usize; 2],
    pictures: Kept,
}

fn size(scene: &Scene) -> [usize; 2] {
    [scene.footage.width, scene.footage.height]
}

/// What is tracked.
struct Job {
    /// The parts, with only the keys and corrections in the range.
    scene: Scene,
    range: RangeInclusive<FrameNumber>,
    offset: i32,
    options: TrackOptions,
}

impl Job {
    fn of(effect: &Effect, document: &Document, time: f64) -> Result<Self, Failure> {
        let parameters = effect.parameters()?;
        let source = effect.clip(SOURCE)?;
        let clip_range = source.connected().then(|| source.frame_range()).flatten();
        let clip_range =
            clip_range.ok_or_else(|| Failure::Told("connect the footage to the input Source first".into()))?;
        let offset = parameters.int(c"frameOffset", time)?;
        let chosen = [parameters.int(c"firstFrame", time)?, parameters.int(c"lastFrame", time)?];
        let range = range(clip_range, chosen, offset);
        let scene = within(&document.scene, range.clone());
        if scene.parts.iter().all(|part| part.keys.is_empty()) {
            let (first, last) = (range.start(), range.end());
            return Err(Failure::Told(format!("no part has a key in the project's frames {first} to {last}")));
        }
        let known = shared("preset").0;
        let preset = known.get(parameters.int(c"preset", time)?.max(0) as usize);
        let preset = preset.and_then(|(id, _)| Preset::from_id(id));
        let options = TrackOptions { preset: preset.unwrap_or_default(), ..TrackOptions::default() };
        Ok(Self { scene, range, offset, options })
    }

    /// The document with its new tracks, and the parts that were tracked.
    fn merged(&self, document: &Document, tracking: Tracking) -> Result<(Document, Vec<usize>), Failure> {
        let mut document = document.clone();
        merge(&mut document.scene, tracking, &self.range);
        let problems = document.problems();
        if problems.error_count() > 0 {
            return Err(Failure::Told(problems.to_string()));
        }
        let parts = &self.scene.parts;
        Ok((document, (0..parts.len()).filter(|&part| !parts[part].keys.is_empty()).collect()))
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

/// Stores new tracks in the scene. The scene keeps its tracks on frames outside the range.
fn merge(scene: &mut Scene, mut tracking: Tracking, range: &RangeInclusive<FrameNumber>) {
    for (part, found) in scene.parts.iter().zip(&mut tracking.parts) {
        // A part without keys in the range was not tracked.
        let untouched = found.tracks.is_empty();
        let kept = |frame: &FrameNumber| untouched || !range.contains(frame);
        found
            .tracks
            .extend(part.tracks.iter().filter(|(frame, _)| kept(frame)).map(|(f, points)| (*f, points.clone())));
        let confidence = part.confidence.iter().filter(|(frame, _)| kept(frame));
        found.confidence.extend(confidence.map(|(frame, values)| (*frame, values.clone())));
    }
    pipeline::store(scene, &tracking);
}

/// Frames in memory, the oldest first.
type Kept = VecDeque<(FrameNumber, Picture)>;

/// Runs the tracker. Frames that are not among the kept ones come from the source; without a source they are an error.
fn run(effect: &Effect, source: Option<Clip>, job: &Job, kept: Kept) -> Result<(Tracking, Kept), Failure> {
    let (ask, asked) = channel();
    let scene = &job.scene;
    let frames = HostFrames { ask: Mutex::new(ask), kept: Mutex::new(kept), most: kept_frames(scene) };
    let board = Board::default();
    let pool = rayon::ThreadPoolBuilder::new().thread_name(|index| format!("rototoon-{index}")).build();
    let pool = pool.map_err(|error| Failure::Told(format!("cannot start threads to track on: {error}")))?;
    let bar = Bar::new(*effect, "Rototoon: tracking");
    let clerk = Clerk { effect, source, offset: job.offset, scene };
    let result = std::thread::scope(|scope| {
        let worker = scope.spawn(|| pool.install(|| Tracker::new(job.options).track(scene, &frames, &board)));
        while !worker.is_finished() {
            clerk.serve(&asked);
            if !board.cancelled() && !bar.update(board.done()) {
                board.cancel();
            }
        }
        worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    });
    if board.cancelled() {
        return Err(Failure::Aborted);
    }
    let tracking = result.map_err(|error| match error {
        TrackError::Cancelled(_) => Failure::Aborted,
        other => Failure::Told(other.to_string()),
    })?;
    Ok((tracking, frames.kept.into_inner().unwrap_or_else(PoisonError::into_inner)))
}

fn kept_frames(scene: &Scene) -> usize {
    let size = scene.footage.width * scene.footage.height * size_of::<Colour>();
    (KEPT / size.max(1)).max(4)
}

/// A request for a frame by a thread of the tracker, which waits for the answer.
struct Request {
    frame: FrameNumber,
    answer: SyncSender<Result<Picture, FrameError>>,
}

/// The source's frames. They are requested from the thread that may call the host. The last ones are kept.
struct HostFrames {
    ask: Mutex<Sender<Request>>,
    kept: Mutex<Kept>,
    most: usize,
}

impl FrameSource for HostFrames {
    fn picture(&self, frame: FrameNumber) -> Result<Picture, FrameError> {
        let kept = || self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, picture)) = kept().iter().find(|(known, _)| *known == frame) {
            return Ok(picture.clone());
        }
        let (answer, answered) = sync_channel(1);
        let gone = |_| unreadable(frame, "tracking has ended");
        let request = Request { frame, answer };
        self.ask.lock().unwrap_or_else(PoisonError::into_inner).send(request).map_err(|_| gone(()))?;
        let picture = answered.recv().map_err(|_| gone(()))??;
        let mut kept = kept();
        if kept.len() >= self.most {
            kept.pop_front();
        }
        kept.push_back((frame, picture.clone()));
        Ok(picture)
    }
}

fn unreadable(frame: FrameNumber, reason: &str) -> FrameError {
    FrameError::Unreadable { frame, path: "Source".into(), reason: reason.into() }
}

/// Answers requests for frames, on the thread that may call the host.
struct Clerk<'a> {
    effect: &'a Effect<'a>,
    source: Option<Clip<'a>>,
    offset: i32,
    scene: &'a Scene,
}

impl Clerk<'_> {
    /// Answers requests until there are none. Waits for the first one at most [`PACE`].
    fn serve(&self, asked: &Receiver<Request>) {
        let mut next = asked.recv_timeout(PACE);
        while let Ok(request) = next {
            // The thread that waits may have been cancelled.
            let _ = request.answer.send(self.fetch(request.frame));
            next = asked.try_recv().map_err(|_| RecvTimeoutError::Timeout);
        }
    }

    fn fetch(&self, frame: FrameNumber) -> Result<Picture, FrameError> {
        let time = f64::from(frame) + f64::from(self.offset);
        let failed = |failure: Failure| unreadable(frame, &failure.to_string());
        let source = self.source.as_ref().ok_or_else(|| unreadable(frame, "it is not in memory"))?;
        let image = source.image(time).map_err(failed)?;
        let image = image.ok_or_else(|| unreadable(frame, "the host has no image of this frame"))?;
        let placement = Placement::of(self.effect, &self.scene.footage, time, [1.0; 2]).map_err(failed)?;
        Ok(Arc::new(self.picture(&image, &placement)))
    }

    /// Converts the image to a picture of the footage's size, in display colours.
    fn picture(&self, image: &Image, placement: &Placement) -> Raster<Colour> {
        let (width, height) = (self.scene.footage.width, self.scene.footage.height);
        let (bounds, encoding) = (image.bounds, Encoding::of(&image.format));
        let mut rows = Raster::new(bounds.width(), (bounds.y2 - bounds.y1) as usize, CLEAR);
        for (row, y) in (bounds.y1..bounds.y2).rev().enumerate() {
            if let Some(bytes) = image.row(y, bounds.x1, bounds.x2) {
                image.format.read(bytes, rows.row_mut(row));
            }
        }
        let corner = Point::new(f64::from(bounds.x1), f64::from(-bounds.y2));
        Raster::from_fn(width, height, |x, y| {
            let p = placement.place(Point::new(x as f64 + 0.5, y as f64 + 0.5)) - corner - Point::splat(0.5);
            let [r, g, b, _] = sample(&rows, p);
            [r, g, b].map(|value| encoding.shown(value))
        })
    }
}

/// Interpolates bilinearly between the four pixels around a point. Pixel centres are at whole numbers.
fn sample(picture: &Raster<Pixel>, p: Point) -> Pixel {
    let (whole, share) = (p.floor(), p - p.floor());
    let at = |dx: isize, dy: isize| picture.clamped(whole.x as isize + dx, whole.y as isize + dy);
    let mut sum = CLEAR;
    for (dx, wx) in [(0, 1.0 - share.x), (1, share.x)] {
        for (dy, wy) in [(0, 1.0 - share.y), (1, share.y)] {
            let weight = (wx * wy) as f32;
            if weight > 0.0 {
                sum.iter_mut().zip(at(dx, dy)).for_each(|(sum, value)| *sum += weight * value);
            }
        }
    }
    sum
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

    #[test]
    fn the_range_is_in_the_clip_and_in_the_chosen_frames() {
        assert_eq!(range([1.0, 34.0], [0, 0], 1), 0..=33);
        assert_eq!(range([1.0, 34.0], [5, 80], 0), 5..=34);
        assert_eq!(range([1.5, 9.9], [7, 3], -10), 12..=19);
    }

    #[test]
    fn samples_are_interpolated_between_pixels() {
        let picture = Raster::from_fn(3, 2, |x, y| [x as f32, y as f32, 0.0, 1.0]);
        assert_eq!(sample(&picture, Point::new(1.0, 1.0)), [1.0, 1.0, 0.0, 1.0]);
        assert_eq!(sample(&picture, Point::new(0.5, 0.25)), [0.5, 0.25, 0.0, 1.0]);
        assert_eq!(sample(&picture, Point::new(-5.0, 9.0)), [0.0, 1.0, 0.0, 1.0]);
    }
}
