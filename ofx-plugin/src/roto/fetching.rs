//! Fetches the source's frames for the tracker, in display colours and at the footage's size.
//!
//! Transparent pixels are laid over the same ground on all frames, that of the first frame that shows anything, as in the command
//! line: paper that changed would look like motion.
//!
//! The tracker's threads ask for frames, and wait. The thread of the action answers, because hosts do not allow the calls on
//! other threads.

use super::film::{Frame, Kept, Picture};
use super::placement::Placement;
use super::sums::Sums;
use crate::encoding::Encoding;
use crate::ground::{Ground, is_transparent};
use crate::ofx::{Clip, Effect, Image};
use crate::pixels::{CLEAR, Pixel};
use rototoon::geometry::Point;
use rototoon::pictures::backdrop::GREY;
use rototoon::scene::{Footage, FrameError, FrameNumber, FrameSource, Raster};
use std::cell::Cell;
use std::ops::RangeInclusive;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// A request for a frame by a thread of the tracker, which waits for the answer.
pub struct Request {
    number: FrameNumber,
    answer: SyncSender<Result<Frame, FrameError>>,
}

/// The source's frames. They are requested from the thread that may call the host. The last ones are kept.
pub struct HostFrames {
    ask: Mutex<Sender<Request>>,
    kept: Mutex<Kept>,
}

impl HostFrames {
    /// Frames that are kept, and others from the thread that the requests go to.
    pub fn new(kept: Kept, ask: Sender<Request>) -> Self {
        Self { ask: Mutex::new(ask), kept: Mutex::new(kept) }
    }

    /// The frames that were kept.
    pub fn into_kept(self) -> Kept {
        self.kept.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

impl FrameSource for HostFrames {
    fn picture(&self, frame: FrameNumber) -> Result<Picture, FrameError> {
        let kept = || self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(picture) = kept().picture(frame) {
            return Ok(picture);
        }
        let (answer, answered) = sync_channel(1);
        let gone = |_| unreadable(frame, "tracking has ended");
        let request = Request { number: frame, answer };
        self.ask.lock().unwrap_or_else(PoisonError::into_inner).send(request).map_err(|_| gone(()))?;
        let new = answered.recv().map_err(|_| gone(()))??;
        let picture = new.picture.clone();
        kept().keep(new);
        Ok(picture)
    }
}

fn unreadable(frame: FrameNumber, reason: &str) -> FrameError {
    FrameError::Unreadable { frame, path: "Source".into(), reason: reason.into() }
}

/// Answers requests for frames, on the thread that may call the host.
pub struct Clerk<'a> {
    /// The effect.
    pub effect: &'a Effect<'a>,
    /// The input; without it every frame is unreadable.
    pub source: Option<Clip<'a>>,
    /// The composition's frame on which the document's frame 0 lies.
    pub offset: i32,
    /// The footage whose size the pictures get.
    pub footage: &'a Footage,
    /// The footage's frames that the source has. The first of them that shows anything says what lies behind all of them.
    pub frames: RangeInclusive<FrameNumber>,
    /// What lies behind transparent pixels, once it is known.
    pub ground: Cell<Option<Ground>>,
    /// Whether to sum the host's pixels, for later comparisons.
    pub sums: bool,
    /// Whether the user has not cancelled the work.
    pub goes_on: &'a dyn Fn() -> bool,
}

/// A frame of the source at the footage's size: premultiplied pixels with the host's colours.
struct Seen {
    pixels: Raster<Pixel>,
    encoding: Encoding,
    /// Whether nothing of it is transparent.
    is_solid: bool,
}

impl Clerk<'_> {
    /// Answers requests until there are none. Waits for the first one at most for `pace`.
    pub fn serve(&self, asked: &Receiver<Request>, pace: Duration) {
        let mut next = asked.recv_timeout(pace);
        while let Ok(request) = next {
            // The thread that waits may have been cancelled.
            let _ = request.answer.send(self.fetch(request.number));
            next = asked.try_recv().map_err(|_| RecvTimeoutError::Timeout);
        }
    }

    fn fetch(&self, number: FrameNumber) -> Result<Frame, FrameError> {
        let image = self.image(number)?;
        let seen = self.seen(number, &image)?;
        let sums = self.sums.then(|| Arc::new(Sums::of(&image)));
        drop(image);
        let ground = if seen.is_solid { Ground::Unused } else { self.ground(number, &seen) };
        let picture = seen.pixels.map(|pixel| ground.colour(pixel, seen.encoding));
        Ok(Frame { number, picture: Arc::new(picture), sums })
    }

    fn image(&self, number: FrameNumber) -> Result<Image<'_>, FrameError> {
        let source = self.source.as_ref().ok_or_else(|| unreadable(number, "it is not in memory"))?;
        let image = source.image(self.time(number)).map_err(|failure| unreadable(number, &failure.to_string()))?;
        image.ok_or_else(|| unreadable(number, "the host has no image of this frame"))
    }

    fn time(&self, number: FrameNumber) -> f64 {
        f64::from(number) + f64::from(self.offset)
    }

    /// What lies behind the transparent pixels of all frames. `at` is a frame that was seen.
    fn ground(&self, at: FrameNumber, seen: &Seen) -> Ground {
        if let Some(known) = self.ground.get() {
            return known;
        }
        let of = |seen: &Seen| Ground::of(&seen.pixels, seen.encoding);
        let other = |frame| of(&self.seen(frame, &self.image(frame).ok()?).ok()?);
        let (first, last) = (*self.frames.start(), *self.frames.end());
        let before = (first..=last).take_while(|frame| *frame < at && (self.goes_on)()).find_map(other);
        let after = || (first..=last).filter(|frame| *frame > at).take_while(|_| (self.goes_on)()).find_map(other);
        let found = before.or_else(|| of(seen)).or_else(after);
        let found = found.unwrap_or(Ground::Grey(GREY));
        self.ground.set(Some(found));
        found
    }

    /// Samples the image at the footage's size. It is transparent outside of its bounds, unless it is opaque everywhere: then
    /// its border goes on.
    fn seen(&self, number: FrameNumber, image: &Image) -> Result<Seen, FrameError> {
        let placement = Placement::of(self.effect, self.footage, self.time(number), [1.0; 2]);
        let placement = placement.map_err(|failure| unreadable(number, &failure.to_string()))?;
        let bounds = image.bounds;
        let mut rows = Raster::new(bounds.width(), (bounds.y2 - bounds.y1) as usize, CLEAR);
        for (row, y) in (bounds.y1..bounds.y2).rev().enumerate() {
            if let Some(bytes) = image.row(y, bounds.x1, bounds.x2) {
                image.format.read(bytes, rows.row_mut(row));
            }
        }
        let is_solid = !rows.data().iter().any(is_transparent);
        let corner = Point::new(f64::from(bounds.x1), f64::from(-bounds.y2));
        let most = Point::new(rows.width() as f64, rows.height() as f64) - Point::splat(0.5);
        let is_inside = |p: Point| p.min_element() >= -0.5 && (most - p).min_element() >= 0.0;
        let pixels = Raster::from_fn(self.footage.width, self.footage.height, |x, y| {
            let p = placement.place(Point::new(x as f64 + 0.5, y as f64 + 0.5)) - corner - Point::splat(0.5);
            if is_solid || is_inside(p) { sample(&rows, p) } else { CLEAR }
        });
        Ok(Seen { pixels, encoding: Encoding::of(&image.format), is_solid })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_interpolated_between_pixels() {
        let picture = Raster::from_fn(3, 2, |x, y| [x as f32, y as f32, 0.0, 1.0]);
        assert_eq!(sample(&picture, Point::new(1.0, 1.0)), [1.0, 1.0, 0.0, 1.0]);
        assert_eq!(sample(&picture, Point::new(0.5, 0.25)), [0.5, 0.25, 0.0, 1.0]);
        assert_eq!(sample(&picture, Point::new(-5.0, 9.0)), [0.0, 1.0, 0.0, 1.0]);
    }
}
