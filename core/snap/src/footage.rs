//! Snaps all parts of a scene on all of their frames.
//!
//! The frames are independent except for one decision: whether a part follows ink centres or edges is decided by all of
//! its frames together, so that it does not flicker. With [`Follow::Auto`] each frame is therefore snapped in both
//! ways, and the sum of the frames' votes chooses at the end. Each picture is read only once.
//!
//! Cartoons hold each drawing for two or three frames. A contour that lies where it lay on the frame before, on the same
//! picture, has the same path, so that it is not sought again. On footage drawn on twos this halves the work.
//!
//! Where nearer parts hide a segment, its path is not sought in their ink ([`hidden`](super::hidden)).
//!
//! Limits: a held drawing under noise or after lossy compression is another picture and is snapped anew. At most one
//! frame more than there are threads is in memory at a time.

use super::cost::Follow;
use super::hidden::form_hidden;
use super::snapper::{InkVote, SnapOptions, Snapper};
use rayon::iter::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Cancelled, Colour, FrameError, FrameNumber, FrameSource, Part, Progress, Raster, Scene};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Snapped paths of one part: for each frame one path per segment, in pixels of the picture.
pub type PartCurves = BTreeMap<FrameNumber, Vec<Vec<Point>>>;

/// Why snapping failed. The scene is not changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SnapError {
    /// A picture could not be read.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The parts that have a contour on a frame, with the contour, in the order of the scene.
type Contours<'a> = Vec<(usize, &'a [Point])>;

/// A frame whose picture has been read.
struct Drawing<'a> {
    picture: Arc<Raster<Colour>>,
    contours: &'a [(usize, &'a [Point])],
}

/// One part on one frame.
#[derive(Clone)]
struct Found {
    part: usize,
    vote: InkVote,
    /// Paths along edges and along lines. One of them is missing if the options fix the kind.
    paths: [Option<Vec<Vec<Point>>>; 2],
}

/// Snaps every part on every frame of its tracks, or of its keys where it has no tracks. The result has one entry per
/// part, in the order of the scene. Coordinates are pixels of the picture.
///
/// Each picture is requested once, and the result does not depend on the number of threads. The calling thread reports
/// progress after each batch of as many frames as there are threads. A run can be cancelled at these reports.
///
/// # Errors
///
/// The error of the first frame, in time order, whose picture cannot be read; [`SnapError::Cancelled`] if the progress
/// listener asks to stop.
pub fn snap_scene(
    scene: &Scene,
    frames: &dyn FrameSource,
    options: &SnapOptions,
    progress: &dyn Progress,
) -> Result<Vec<PartCurves>, SnapError> {
    let work = contours_by_frame(scene);
    let numbers: Vec<FrameNumber> = work.keys().copied().collect();
    progress.report("snap", 0.0)?;
    let mut found: Vec<(FrameNumber, Vec<Found>)> = Vec::with_capacity(numbers.len());
    let mut last: Option<Drawing> = None;
    for batch in numbers.chunks(rayon::current_num_threads().max(1)) {
        let pictures: Vec<_> = batch.par_iter().map(|&frame| frames.picture(frame)).collect();
        let mut drawings: Vec<Drawing> = last.take().into_iter().collect();
        let first = drawings.len();
        for (picture, frame) in pictures.into_iter().zip(batch) {
            drawings.push(Drawing { picture: picture?, contours: &work[frame] });
        }
        for (&frame, fresh) in batch.iter().zip(snap_drawings(scene, &drawings, first, options)) {
            let before = found.last().map(|(_, before)| before.as_slice()).unwrap_or_default();
            let merged = merge(&work[&frame], fresh, before);
            found.push((frame, merged));
        }
        last = drawings.pop();
        progress.report("snap", found.len() as f64 / numbers.len() as f64)?;
    }
    let mut curves = choose(scene.parts.len(), found);
    form_hidden(scene, &mut curves);
    Ok(curves)
}

/// For each frame of the footage, the parts that have a contour on it, with the contour. Contours beyond it or where the part is absent have no picture to look
/// at.
fn contours_by_frame(scene: &Scene) -> BTreeMap<FrameNumber, Contours<'_>> {
    let mut work: BTreeMap<FrameNumber, Contours> = BTreeMap::new();
    for (index, part) in scene.parts.iter().enumerate() {
        let within = contours(part).range(scene.footage.first..=scene.footage.last);
        for (&frame, points) in within.filter(|(frame, _)| !part.is_absent(**frame)) {
            work.entry(frame).or_default().push((index, points));
        }
    }
    work
}

fn contours(part: &Part) -> &BTreeMap<FrameNumber, Vec<Point>> {
    if part.tracks.is_empty() { &part.keys } else { &part.tracks }
}

/// Snaps what is new on each of the drawings from the index `first` on: what the drawing before does not have in the same
/// place on the same picture.
fn snap_drawings(scene: &Scene, drawings: &[Drawing], first: usize, options: &SnapOptions) -> Vec<Vec<Found>> {
    let held = |index: usize| index > 0 && drawings[index].picture == drawings[index - 1].picture;
    let held: Vec<bool> = (first..drawings.len()).into_par_iter().map(held).collect();
    let snappers: Vec<Snapper> = drawings[first..].iter().map(|drawing| Snapper::new(&drawing.picture)).collect();
    let fresh = |k: usize| {
        let known = if held[k] { drawings[first + k - 1].contours } else { &[] };
        drawings[first + k].contours.iter().filter(|entry| !known.contains(entry)).map(move |&entry| (k, entry))
    };
    // Frames differ much in what is new on them, so that contours are shared out, not frames.
    let work: Vec<(usize, (usize, &[Point]))> = (0..held.len()).flat_map(fresh).collect();
    let found: Vec<(usize, Found)> =
        work.par_iter().map(|&(k, (part, points))| (k, snap(&snappers[k], scene, part, points, options))).collect();
    let mut result: Vec<Vec<Found>> = (0..held.len()).map(|_| Vec::new()).collect();
    for (k, entry) in found {
        result[k].push(entry);
    }
    result
}

/// All of a frame's parts: those that were snapped on it, and the others as they were on the frame before.
fn merge(contours: &[(usize, &[Point])], fresh: Vec<Found>, before: &[Found]) -> Vec<Found> {
    let mut fresh = fresh.into_iter().peekable();
    let one = |&(part, _): &(usize, &[Point])| {
        let own = fresh.next_if(|found| found.part == part);
        own.or_else(|| before.iter().find(|found| found.part == part).cloned())
    };
    contours.iter().filter_map(one).collect()
}

fn snap(snapper: &Snapper, scene: &Scene, part: usize, points: &[Point], options: &SnapOptions) -> Found {
    let auto = options.follow == Follow::Auto;
    let vote = if auto { snapper.vote(points) } else { InkVote::default() };
    let closed = scene.parts[part].closed;
    let wanted = |follow| {
        (auto || options.follow == follow).then(|| snapper.snap(points, closed, &SnapOptions { follow, ..*options }))
    };
    Found { part, vote, paths: [wanted(Follow::Edge), wanted(Follow::Line)] }
}

/// For each part, the paths of the kind that wins the vote of all its frames.
fn choose(parts: usize, found: Vec<(FrameNumber, Vec<Found>)>) -> Vec<PartCurves> {
    let mut votes = vec![InkVote::default(); parts];
    for entry in found.iter().flat_map(|(_, entries)| entries) {
        votes[entry.part] = votes[entry.part].and(entry.vote);
    }
    let mut result = vec![PartCurves::new(); parts];
    for (frame, entries) in found {
        for Found { part, paths: [edge, line], .. } in entries {
            let paths = if votes[part].winner() == Follow::Line { line.or(edge) } else { edge.or(line) };
            result[part].insert(frame, paths.unwrap_or_default());
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::{Footage, Silent};
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// A dark disc outline that moves to the right. Frame 7 is missing.
    struct Disc {
        asked: AtomicUsize,
    }

    const SIZE: usize = 60;

    impl FrameSource for Disc {
        fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
            self.asked.fetch_add(1, Ordering::Relaxed);
            if frame == 7 {
                return Err(FrameError::Outside { frame, first: 0, last: 6 });
            }
            let centre = centre(frame);
            Ok(Arc::new(Raster::from_fn(SIZE, SIZE, |x, y| {
                let away = (Point::new(x as f64 + 0.5, y as f64 + 0.5).distance(centre) - 15.0).abs();
                [(away - 1.0).clamp(0.0, 1.0) as f32; 3]
            })))
        }
    }

    fn centre(frame: FrameNumber) -> Point {
        Point::new(25.0 + f64::from(frame), 30.0)
    }

    fn ring(frame: FrameNumber) -> Vec<Point> {
        (0..6).map(|k| centre(frame) + 15.0 * Point::from_angle(f64::from(k))).collect()
    }

    fn scene() -> Scene {
        let tracked = Part {
            name: "ring".into(),
            closed: true,
            keys: [0, 6].map(|f| (f, ring(f))).into(),
            tracks: (0..=6).map(|f| (f, ring(f))).collect(),
            ..Part::default()
        };
        let keyed = Part { name: "arc".into(), keys: [(2, ring(2))].into(), ..Part::default() };
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 6, fps: 24.0, width: SIZE, height: SIZE, held: false };
        Scene { footage, parts: vec![tracked, keyed, Part::default()] }
    }

    #[test]
    fn parts_are_snapped_on_tracks_or_keys_and_pictures_are_read_once() {
        let source = Disc { asked: AtomicUsize::new(0) };
        let curves = snap_scene(&scene(), &source, &SnapOptions::default(), &Silent).unwrap();
        assert_eq!(source.asked.load(Ordering::Relaxed), 7);
        assert_eq!(curves[0].keys().copied().collect::<Vec<_>>(), (0..=6).collect::<Vec<_>>());
        assert_eq!(curves[1].keys().copied().collect::<Vec<_>>(), [2]);
        assert!(curves[2].is_empty());
        assert_eq!((curves[0][&3].len(), curves[1][&2].len()), (6, 5));
        for (&frame, paths) in &curves[0] {
            for p in paths.iter().flatten() {
                assert!((p.distance(centre(frame)) - 15.0).abs() < 0.5, "frame {frame}: {p}");
            }
        }
    }

    #[test]
    fn the_number_of_threads_changes_nothing() {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let source = Disc { asked: AtomicUsize::new(0) };
            pool.install(|| snap_scene(&scene(), &source, &SnapOptions::default(), &Silent).unwrap())
        };
        assert_eq!(on(1), on(3));
    }

    #[test]
    fn what_is_held_is_what_would_be_found() {
        /// Each drawing of the disc for three frames.
        struct Held(Disc);
        impl FrameSource for Held {
            fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
                self.0.picture(frame / 3)
            }
        }
        let mut scene = scene();
        scene.footage.last = 12;
        scene.parts[0].tracks = (0..=12).map(|f| (f, ring(f / 3))).collect();
        scene.parts[0].tracks.insert(4, ring(2));
        scene.parts[1].tracks = [3, 5, 6, 7].map(|f| (f, ring(f / 3))).into();
        let source = Held(Disc { asked: AtomicUsize::new(0) });
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let curves = pool.install(|| snap_scene(&scene, &source, &SnapOptions::default(), &Silent).unwrap());
            for (part, curves) in scene.parts.iter().zip(&curves) {
                assert_eq!(part.tracks.keys().collect::<Vec<_>>(), curves.keys().collect::<Vec<_>>());
                for (&frame, points) in &part.tracks {
                    let picture = source.picture(frame).unwrap();
                    let alone = SnapOptions { follow: Follow::Line, ..SnapOptions::default() };
                    assert_eq!(curves[&frame], Snapper::new(&picture).snap(points, part.closed, &alone), "{frame}");
                }
            }
        }
    }

    #[test]
    fn a_missing_picture_is_named() {
        let mut scene = scene();
        scene.footage.last = 7;
        scene.parts[1].keys.insert(7, ring(7));
        let source = Disc { asked: AtomicUsize::new(0) };
        let error = snap_scene(&scene, &source, &SnapOptions::default(), &Silent).unwrap_err();
        assert_eq!(error.to_string(), "frame 7 is outside the footage, which has frames 0 to 6");
    }

    #[test]
    fn contours_without_a_picture_are_left_out() {
        let mut scene = scene();
        scene.parts[0].tracks.insert(7, ring(7));
        scene.parts[0].set_absent(4, 4);
        let source = Disc { asked: AtomicUsize::new(0) };
        let curves = snap_scene(&scene, &source, &SnapOptions::default(), &Silent).unwrap();
        assert_eq!(curves[0].keys().copied().collect::<Vec<_>>(), [0, 1, 2, 3, 5, 6]);
    }

    #[test]
    fn a_refused_report_cancels() {
        struct Impatient;
        impl Progress for Impatient {
            fn report(&self, _: &str, done: f64) -> Result<(), Cancelled> {
                if done > 0.0 { Err(Cancelled) } else { Ok(()) }
            }
        }
        let source = Disc { asked: AtomicUsize::new(0) };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let result = pool.install(|| snap_scene(&scene(), &source, &SnapOptions::default(), &Impatient));
        assert_eq!(result, Err(SnapError::Cancelled(Cancelled)));
        assert_eq!(source.asked.load(Ordering::Relaxed), 2);
    }
}
