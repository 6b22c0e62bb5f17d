//! What was found out about the pictures of a stretch after it was tracked, kept in the [cache](super::cached).
//!
//! Parts that stand still are looked for when all parts are tracked ([`holds`](super::holds)): which frames show the same drawing, where the picture goes around
//! the parts, and whether it is the same inside a contour. All that needs the pictures, and would be the most work where the tracks come from the cache. Each answer
//! is true of these pictures, whatever the tracks are: it has its contour with it. So the answers of a stretch are kept by the marks of its pictures and by how they are looked at, which
//! the kind of drawing decides: where a picture goes is not the same in colours and in tones. Answers for contours that are others now are not found.

use super::cached::{Stretch, Stretches};
use super::holds::{Pan, Said};
use super::{Looks, Rototoon};
use rototoon_base::scene::FrameNumber;
use serde::{Deserialize, Serialize};

/// Two frames.
pub(super) type Pair = (FrameNumber, FrameNumber);

/// The facts of a stretch.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Facts {
    /// Whether two frames show the same drawing.
    same: Vec<(Pair, bool)>,
    asked: Vec<Said>,
    pans: Vec<(FrameNumber, Pan)>,
}

impl Rototoon {
    /// Takes what the cache knows of the pictures of a run's stretches, if there was none before. Returns of which stretches it knows nothing.
    pub(super) fn recall(&mut self, stretches: &Stretches) -> Vec<bool> {
        if !self.holds.is_empty() {
            return vec![false; stretches.of.len()];
        }
        let of_stretch = |stretch: &Stretch| {
            let Some(Facts { same, asked, pans }) = stretches.facts(stretch) else { return true };
            self.store.know_same(same);
            self.holds.add(asked, pans);
            false
        };
        stretches.of.iter().map(of_stretch).collect()
    }

    /// Keeps what is known of the pictures of stretches with new tracks, and of those of which the cache knew nothing.
    pub(super) fn note(&self, stretches: &Stretches, unknown: &[bool], frames: &Looks) {
        for (stretch, _) in stretches.of.iter().zip(unknown).filter(|(stretch, unknown)| stretch.is_new || **unknown) {
            let (asked, pans) = self.holds.within(stretch.range);
            let facts = Facts { same: self.store.known_same(stretch.range), asked, pans };
            stretches.keep_facts(stretch, &facts, frames);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mechanisms;
    use crate::contract::cache::{Cache, Mark};
    use crate::contract::tasks::tasks;
    use crate::shared::look::Kind;
    use rototoon_base::geometry::Point;
    use rototoon_base::scene::{Colour, Footage, FrameError, FrameSource, Part, Raster, Scene, Silent, Span};
    use std::collections::BTreeMap;
    use std::sync::{Arc, Mutex};

    #[derive(Default)]
    struct Shelf(Mutex<BTreeMap<Mark, Vec<u8>>>);

    impl Cache for Shelf {
        fn get(&self, mark: &Mark) -> Option<Vec<u8>> {
            self.0.lock().unwrap().get(mark).cloned()
        }

        fn put(&self, mark: &Mark, bytes: &[u8]) {
            self.0.lock().unwrap().insert(*mark, bytes.to_vec());
        }
    }

    /// Pictures of which only the marks are asked for.
    struct Marked(u8);

    impl FrameSource for Marked {
        fn picture(&self, _: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
            Ok(Arc::new(Raster::new(8, 6, [0.0; 3])))
        }

        fn mark(&self, frame: FrameNumber) -> Result<Option<Mark>, FrameError> {
            Ok(Some([self.0 + frame as u8; 32]))
        }
    }

    const SPAN: Span = Span { first: 0, last: 3 };

    /// A tracker with this shelf, and the stretch of a part between its keys in pictures of a kind.
    fn tracker(shelf: &Arc<Shelf>, looks: &Looks) -> (Rototoon, Stretches) {
        let keys = [SPAN.first, SPAN.last].map(|frame| (frame, vec![Point::ZERO, Point::X, Point::ONE]));
        let part = Part { name: "part".into(), closed: true, keys: keys.into(), ..Part::default() };
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 3, fps: 12.0, width: 8, height: 6, held: false };
        let scene = Scene { footage, parts: vec![part] };
        let tracker = Rototoon::new(Mechanisms::default(), Some(shelf.clone()));
        let cached = tracker.cached((&scene, None), (&tasks(&scene), &[vec![0]]), looks, &Silent).unwrap();
        let stretches = cached.unwrap().done([(SPAN, true)].into_iter());
        (tracker, stretches)
    }

    #[test]
    fn where_a_picture_goes_is_known_for_the_same_kind_of_drawing_alone() {
        let shelf = Arc::new(Shelf::default());
        let (frames, others) = (Marked(0), Marked(1));
        let looks = |frames, kind| Looks { frames, kind };
        let painted = looks(&frames, Kind::Painted);
        let pans = vec![(1, (vec![vec![Point::ONE]], Some(Point::new(3.0, 0.0))))];
        let (mut first, stretches) = tracker(&shelf, &painted);
        first.holds.add(Vec::new(), pans.clone());
        first.note(&stretches, &[true], &painted);
        let recalled = |looks: &Looks| {
            let (mut tracker, stretches) = tracker(&shelf, looks);
            let unknown = tracker.recall(&stretches);
            (tracker.holds.within(SPAN).1, unknown)
        };
        assert_eq!(recalled(&painted), (pans, vec![false]));
        for other in [looks(&frames, Kind::Lines), looks(&frames, Kind::Shaded), looks(&others, Kind::Painted)] {
            assert_eq!(recalled(&other), (Vec::new(), vec![true]), "{:?}", other.kind);
        }
    }
}
