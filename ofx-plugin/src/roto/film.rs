//! What a Track leaves in memory, so that edits can be followed without images: the frames, and what the tracker has computed.

use super::sums::Sums;
use rototoon::scene::{Colour, FrameNumber, Raster};
use rototoon::track::{TrackOptions, Tracker};
use std::collections::VecDeque;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A picture of the footage's size, in display colours.
pub type Picture = Arc<Raster<Colour>>;

/// A frame of the source.
#[derive(Clone)]
pub struct Frame {
    /// Its number in the document.
    pub number: FrameNumber,
    /// Its picture.
    pub picture: Picture,
    /// The sums of the host's pixels; `None` if nobody will compare them.
    pub sums: Option<Arc<Sums>>,
}

/// The last frames that the tracker asked for, the oldest first.
#[derive(Clone)]
pub struct Kept {
    /// The frames.
    pub frames: VecDeque<Frame>,
    /// Most frames that are kept.
    pub most: usize,
    /// Whether a frame was dropped because there were more.
    pub dropped: bool,
}

impl Kept {
    /// No frames yet, and at most so many later.
    pub fn new(most: usize) -> Self {
        Self { frames: VecDeque::new(), most, dropped: false }
    }

    /// The picture of a frame, if it is kept.
    pub fn picture(&self, number: FrameNumber) -> Option<Picture> {
        self.frames.iter().find(|frame| frame.number == number).map(|frame| frame.picture.clone())
    }

    /// Keeps a frame. If there are too many, the oldest one is dropped.
    pub fn keep(&mut self, frame: Frame) {
        // Two threads may have asked for the same frame.
        if self.picture(frame.number).is_some() {
            return;
        }
        if self.frames.len() >= self.most {
            self.frames.pop_front();
            self.dropped = true;
        }
        self.frames.push_back(frame);
    }
}

/// The circumstances of a Track that must be the same for an edit to be followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms {
    /// The composition's frame on which the document's frame 0 lies.
    pub offset: i32,
    /// Width and height of the footage.
    pub size: [usize; 2],
    /// Method and mechanisms.
    pub options: TrackOptions,
}

/// What a Track leaves in memory.
pub struct Film {
    /// Its circumstances.
    pub terms: Terms,
    /// Every frame that the tracker asked for.
    pub kept: Kept,
    tracker: Mutex<Tracker>,
}

impl Film {
    /// The film of a Track.
    pub fn new(terms: Terms, kept: Kept, tracker: Tracker) -> Self {
        Self { terms, kept, tracker: Mutex::new(tracker) }
    }

    /// The tracker with its results, so that only the spans that an edit touches are tracked again.
    pub fn tracker(&self) -> MutexGuard<'_, Tracker> {
        self.tracker.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The sums of the frame at a time of the composition.
    pub fn sums(&self, time: f64) -> Option<Arc<Sums>> {
        let number = time - f64::from(self.terms.offset);
        self.kept.frames.iter().find(|frame| f64::from(frame.number) == number)?.sums.clone()
    }
}

impl fmt::Debug for Film {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "Film of {} frames, {:?}", self.kept.frames.len(), self.terms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_frame_is_dropped_where_there_are_too_many() {
        let frame = |number| Frame { number, picture: Arc::new(Raster::new(1, 1, [0.0; 3])), sums: None };
        let mut kept = Kept::new(3);
        [4, 5, 4, 6].into_iter().for_each(|number| kept.keep(frame(number)));
        assert!(!kept.dropped && kept.picture(4).is_some());
        kept.keep(frame(7));
        assert!(kept.dropped && kept.picture(4).is_none() && kept.picture(5).is_some());
    }
}
