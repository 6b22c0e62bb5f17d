//! A tracker with a cache finds what one without finds, and solves only what the cache does not know.

use super::scene::{Drawn, Shape, points};
use crate::contract::cache::{Cache, Mark};
use crate::rototoon::Rototoon;
use crate::{Mechanisms, SceneSolver, TrackOptions, Tracker, Tracking};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, FrameError, FrameNumber, FrameSource, Part, Raster, Scene, Silent};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex};

const KEYS: [FrameNumber; 4] = [0, 4, 8, 12];

/// Entries in memory.
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

/// Pictures with marks. It notes which were asked for.
struct Film {
    drawn: Drawn,
    /// A frame whose picture is a little darker.
    darker: Option<FrameNumber>,
    read: Mutex<BTreeSet<FrameNumber>>,
}

impl Film {
    fn bare(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        let picture = self.drawn.picture(frame)?;
        Ok(if self.darker == Some(frame) { Arc::new(picture.map(|c| c.map(|x| 0.97 * x))) } else { picture })
    }
}

impl FrameSource for Film {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        self.read.lock().unwrap().insert(frame);
        self.bare(frame)
    }

    fn mark(&self, frame: FrameNumber) -> Result<Option<Mark>, FrameError> {
        let mut hasher = blake3::Hasher::new();
        for value in self.bare(frame)?.data().iter().flatten() {
            hasher.update(&value.to_le_bytes());
        }
        Ok(Some(*hasher.finalize().as_bytes()))
    }
}

/// A limb that swings, and a ball that passes in front of it and comes back: three spans.
fn film() -> (Film, Scene) {
    let limb = Shape {
        rest: points(&[(-30.0, -8.0), (0.0, -10.0), (34.0, -6.0), (36.0, 8.0), (0.0, 9.0), (-30.0, 8.0)]),
        colour: [0.85, 0.3, 0.2],
        motion: |t| (Point::new(110.0 + 24.0 * (0.35 * t).sin(), 90.0 - 2.0 * t), 40.0 * (0.4 * t).sin()),
    };
    let ball = Shape {
        rest: (0..10).map(|k| Point::from_angle(f64::from(k) * 0.628) * Point::new(14.0, 11.0)).collect(),
        colour: [0.2, 0.4, 0.8],
        motion: |t| (Point::new(120.0 + 80.0 * (0.3 * t).cos(), 70.0 + 2.0 * t), 0.0),
    };
    let drawn = Drawn(vec![limb, ball]);
    let part = |k: usize, name: &str| {
        let keys = KEYS.map(|frame| (frame, drawn.0[k].contour(frame)));
        Part { name: name.into(), closed: true, depth: k as f64, keys: keys.into(), ..Part::default() }
    };
    let mut scene = drawn.scene(vec![part(0, "limb"), part(1, "ball")]);
    scene.footage.last = KEYS[3];
    (Film { drawn, darker: None, read: Mutex::default() }, scene)
}

/// What a tracker without a cache finds. The tests share what was found for the same scene.
fn bare(film: &Film, scene: &Scene) -> Arc<Tracking> {
    type Found = (Scene, Option<FrameNumber>, Arc<Tracking>);
    static FOUND: Mutex<Vec<Found>> = Mutex::new(Vec::new());
    let same = |(of, darker, _): &&Found| of == scene && *darker == film.darker;
    if let Some((_, _, tracking)) = FOUND.lock().unwrap().iter().find(same) {
        return tracking.clone();
    }
    let tracking = Arc::new(Tracker::new(TrackOptions::default()).track(scene, film, &Silent).unwrap());
    FOUND.lock().unwrap().push((scene.clone(), film.darker, tracking.clone()));
    tracking
}

/// Tracks with a new tracker that has this cache, and compares with one that has none. The first frames of the spans that it solved, by part, and the
/// tracks.
fn solved(film: &Film, scene: &Scene, shelf: &Arc<Shelf>) -> (Vec<[FrameNumber; 2]>, Tracking) {
    let tracking = Tracker::with_cache(TrackOptions::default(), shelf.clone()).track(scene, film, &Silent).unwrap();
    let bare = bare(film, scene);
    assert!(tracking.parts == bare.parts && tracking.exchanges == bare.exchanges);
    let spans = tracking.jobs.iter().filter(|job| job.solved).map(|job| [job.part as FrameNumber, job.span.first]);
    (spans.collect(), tracking)
}

#[test]
fn only_spans_with_another_input_are_solved_again() {
    let (mut film, mut scene) = film();
    let shelf = Arc::new(Shelf::default());
    let all = [[0, 0], [0, 4], [0, 8], [1, 0], [1, 4], [1, 8]];
    assert_eq!(solved(&film, &scene, &shelf).0, all);
    assert_eq!(solved(&film, &scene, &shelf).0, [[0; 2]; 0], "nothing is new");
    let first = scene.clone();
    scene.parts[0].keys.get_mut(&12).unwrap()[2] += Point::new(1.5, -1.0);
    assert_eq!(solved(&film, &scene, &shelf).0, [[0, 8], [1, 8]], "a key is in one span of each part");
    scene.parts[1].keys.get_mut(&4).unwrap()[0] += Point::new(0.5, 0.0);
    assert_eq!(solved(&film, &scene, &shelf).0, [[0, 0], [0, 4], [1, 0], [1, 4]], "a key is between two spans");
    assert_eq!(solved(&film, &first, &shelf).0, [[0; 2]; 0], "earlier input is known");
    film.darker = Some(6);
    assert_eq!(solved(&film, &first, &shelf).0, [[0, 4], [1, 4]], "a picture is another one");
}

#[test]
fn corrections_and_absences_are_input() {
    let (film, scene) = film();
    let shelf = Arc::new(Shelf::default());
    let bare = solved(&film, &scene, &shelf).1;
    let mut pinned = scene.clone();
    let place = film.drawn.0[1].contour(6)[3] + Point::new(3.0, 2.0);
    pinned.parts[1].pins.entry(6).or_default().insert(3, place);
    let (spans, tracking) = solved(&film, &pinned, &shelf);
    assert!(!spans.is_empty() && spans.iter().all(|span| span[1] == 4), "{spans:?}");
    assert_eq!(tracking.parts[1].tracks[&6][3], place);
    assert_eq!(tracking.parts[0].tracks[&2], bare.parts[0].tracks[&2]);
    assert_eq!(solved(&film, &pinned, &shelf).0, [[0; 2]; 0]);
    // Pinned as a whole, the contour is a key for its own part.
    let whole: BTreeMap<usize, Point> = film.drawn.0[1].contour(6).into_iter().enumerate().collect();
    pinned.parts[1].pins.insert(6, whole);
    assert!(!solved(&film, &pinned, &shelf).0.is_empty());
    assert_eq!(solved(&film, &pinned, &shelf).0, [[0; 2]; 0]);
    let mut away = scene.clone();
    away.parts[1].absent.push([9, 10]);
    assert_eq!(solved(&film, &away, &shelf).0, [[0, 8], [1, 8]]);
}

#[test]
fn a_key_of_one_part_joins_the_spans_of_the_others() {
    let (film, mut scene) = film();
    let shelf = Arc::new(Shelf::default());
    solved(&film, &scene, &shelf);
    // A limb without its key on frame 4: the two first spans of the ball are one stretch with the limb's.
    scene.parts[0].keys.remove(&4);
    assert_eq!(solved(&film, &scene, &shelf).0, [[0, 0], [1, 0], [1, 4]]);
    scene.parts[1].keys.insert(6, film.drawn.0[1].contour(6));
    assert!(solved(&film, &scene, &shelf).0.iter().all(|span| span[1] < 8));
    assert_eq!(solved(&film, &scene, &shelf).0, [[0; 2]; 0]);
}

#[test]
fn what_is_damaged_is_solved_again() {
    let (film, scene) = film();
    let shelf = Arc::new(Shelf::default());
    solved(&film, &scene, &shelf);
    for damage in [|bytes: &mut Vec<u8>| bytes.truncate(bytes.len() / 2), |bytes: &mut Vec<u8>| bytes.clear()] {
        shelf.0.lock().unwrap().values_mut().for_each(damage);
        assert_eq!(solved(&film, &scene, &shelf).0.len(), 6);
        assert_eq!(solved(&film, &scene, &shelf).0.len(), 0);
    }
}

#[test]
fn pictures_whose_tracks_are_known_are_not_compared_again() {
    let (film, mut scene) = film();
    let shelf = Arc::new(Shelf::default());
    solved(&film, &scene, &shelf);
    scene.parts[0].keys.get_mut(&12).unwrap()[2] += Point::new(1.5, -1.0);
    film.read.lock().unwrap().clear();
    Tracker::with_cache(TrackOptions::default(), shelf).track(&scene, &film, &Silent).unwrap();
    let read = film.read.lock().unwrap();
    assert!((8..=12).all(|frame| read.contains(&frame)), "{read:?}");
    // Keys are read to decide what kind of drawing it is.
    assert!((0..8).all(|frame| KEYS.contains(&frame) || !read.contains(&frame)), "{read:?}");
}

#[test]
fn a_film_that_is_too_long_for_the_store_has_the_same_tracks() {
    let (film, mut scene) = film();
    scene.parts[1].pins.entry(6).or_default().insert(3, film.drawn.0[1].contour(6)[3] + Point::new(3.0, 2.0));
    let with_room = |room: Option<usize>| {
        let mut solver = Rototoon::new(Mechanisms::default(), None);
        solver.room = room;
        let first = solver.track(&scene, &film, &Silent).unwrap();
        assert!(solver.track(&scene, &film, &Silent).unwrap().parts == first.parts, "again with room {room:?}");
        first
    };
    let all = with_room(None);
    for room in [1, 5, 9] {
        assert!(with_room(Some(room)) == all, "room for {room} frames");
    }
}
