//! After an edit, tracing with a memory gives what tracing anew gives, and works only where the edit matters.

use super::super::keeping::Earlier;
use super::super::keeping::tests::Store;
use super::kept::Span;
use super::{Drawn, Holds, Kept, TraceMemory, Tracing, beside, is_own, looked_at};
use crate::geometry::Point;
use crate::lines::{Options, Style};
use crate::pictures::sequence::mark;
use crate::project::drawings::DrawnStroke;
use crate::project::traced::TracedDrawing;
use crate::scene::{Colour, FrameError, FrameNumber, FrameSource, Mark, Raster, Silent};
use crate::track::Cache;
use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use std::sync::{Arc, Mutex};

const LAST: FrameNumber = 9;

/// Three bars that move to the right. The third one begins on frame 2 and is not drawn by the artist.
struct Film;

impl FrameSource for Film {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        let ink = |x: f64, y: f64| {
            bars(frame).iter().any(|&[left, top]| x >= left && x < left + 40.0 && (y - top).abs() < 1.5)
        };
        let colour = |x: usize, y: usize| if ink(x as f64 + 0.5, y as f64 + 0.5) { [0.1; 3] } else { [1.0; 3] };
        Ok(Arc::new(Raster::from_fn(120, 90, colour)))
    }

    fn mark(&self, frame: FrameNumber) -> Result<Option<Mark>, FrameError> {
        Ok(Some(mark(&*self.picture(frame)?)))
    }
}

/// The left ends of the bars.
fn bars(frame: FrameNumber) -> Vec<[f64; 2]> {
    let x = 15.0 + 3.0 * f64::from(frame);
    let mut all = vec![[x, 20.0], [x, 45.0]];
    if frame >= 2 {
        all.push([x + 10.0, 70.0]);
    }
    all
}

/// The first two bars as the artist draws them, `raised` by some pixels.
fn drawn(frame: FrameNumber, raised: f64) -> Drawn {
    let stroke = |[x, y]: [f64; 2]| {
        let points = (0..=8).map(|k| Point::new(x + 5.0 * f64::from(k), y - raised)).collect();
        DrawnStroke { points, ..DrawnStroke::default() }
    };
    let strokes = bars(frame)[..2].iter().map(|&bar| stroke(bar)).collect();
    Drawn { frame, strokes, ..Drawn::default() }
}

fn traced(drawings: &[Drawn], memory: Option<&mut TraceMemory>) -> Vec<TracedDrawing> {
    within(0..=LAST, drawings, &[], memory)
}

/// The film on twos, on paper whose grain is new on each frame.
struct OnTwos;

impl FrameSource for OnTwos {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        let mut picture = Film.picture(frame / 2 * 2)?.as_ref().clone();
        let mut state = 0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(frame as u64 + 1);
        for y in 0..picture.height() {
            for colour in picture.row_mut(y) {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let grain = (state >> 40) as f32 / (1u64 << 24) as f32 - 0.5;
                *colour = colour.map(|value| (value + 0.06 * grain).clamp(0.0, 1.0));
            }
        }
        Ok(Arc::new(picture))
    }

    fn mark(&self, frame: FrameNumber) -> Result<Option<Mark>, FrameError> {
        Ok(Some(mark(&*self.picture(frame)?)))
    }
}

/// Traces the frames of a range, beside what an earlier run traced outside of it.
fn within(
    range: RangeInclusive<FrameNumber>,
    drawings: &[Drawn],
    earlier: &[TracedDrawing],
    memory: Option<&mut TraceMemory>,
) -> Vec<TracedDrawing> {
    of(&Holds::none(&Film), range, drawings, earlier, memory)
}

/// Traces frames of the film on twos.
fn on_twos(range: RangeInclusive<FrameNumber>, drawings: &[Drawn], earlier: &[TracedDrawing]) -> Vec<TracedDrawing> {
    let looked = looked_at(&beside(drawings, earlier, &range), &range);
    let holds = Holds::of(&OnTwos, 0, &looked, None, &Silent).unwrap();
    let found = of(&holds, range.clone(), drawings, earlier, None);
    let again = of(&holds, range, drawings, earlier, Some(&mut TraceMemory::default()));
    assert_eq!(found, again, "with a memory");
    found
}

fn of(
    frames: &Holds,
    range: RangeInclusive<FrameNumber>,
    drawings: &[Drawn],
    earlier: &[TracedDrawing],
    memory: Option<&mut TraceMemory>,
) -> Vec<TracedDrawing> {
    kept(frames, range, (drawings, earlier), (&Options::default(), Kept { memory, cache: None })).0
}

/// Traces with these options and with what is kept. Returns how much an earlier run has done, too.
fn kept(
    frames: &Holds,
    range: RangeInclusive<FrameNumber>,
    (drawings, earlier): (&[Drawn], &[TracedDrawing]),
    (options, kept): (&Options, Kept),
) -> (Vec<TracedDrawing>, Earlier) {
    let used = earlier.iter().flat_map(|drawing| &drawing.strokes).map(|stroke| stroke.track + 1).max();
    let mut tracing = Tracing {
        frames,
        drawn: drawings.iter().filter(|drawing| range.contains(&drawing.frame)).collect(),
        options,
        keep_first: is_own(earlier, *range.start()),
        kept,
        earlier: Earlier::default(),
        progress: &Silent,
        all: 1,
        done: 0,
        next: used.unwrap_or(0),
        unit: 90.0 / 540.0,
    };
    let mut found = tracing.all(&range, &beside(drawings, earlier, &range)).unwrap();
    found.sort_by_key(|drawing| drawing.frame);
    (found, tracing.earlier)
}

#[test]
fn a_second_run_takes_every_span_from_memory() {
    for drawings in [vec![], vec![drawn(3, 0.0)], vec![drawn(1, 0.0), drawn(4, 0.0), drawn(7, 0.0)]] {
        let mut memory = TraceMemory::default();
        let anew = traced(&drawings, None);
        assert_eq!(traced(&drawings, Some(&mut memory)), anew);
        let spans = memory.spans();
        assert_eq!(traced(&drawings, Some(&mut memory)), anew);
        assert_eq!(memory.spans(), spans, "nothing is traced again");
        assert!(anew.iter().any(|drawing| drawing.strokes.len() == 3), "a stroke begins on the way");
    }
}

#[test]
fn a_fill_under_a_line_goes_with_its_stroke() {
    let mut drawing = drawn(3, 0.0);
    drawing.strokes[1].fill_colour = Some([0.25, 0.5, 1.0]);
    let mut memory = TraceMemory::default();
    let plain = traced(&[drawn(3, 0.0)], Some(&mut memory));
    let found = traced(std::slice::from_ref(&drawing), Some(&mut memory));
    assert_eq!(found, traced(&[drawing], None), "what was traced without the fill is not taken for it");
    assert_eq!(tracks(&found), tracks(&plain));
    for stroke in found.iter().flat_map(|drawing| &drawing.strokes) {
        assert_eq!(stroke.fill_colour, (stroke.track == 1).then_some([0.25, 0.5, 1.0]));
    }
}

#[test]
fn stages_give_what_one_run_gives() {
    let whole = traced(&[], None);
    assert!(whole[2].strokes.len() == 3, "a stroke begins in the first stage");
    for end in [1, 4] {
        let first = within(0..=end, &[], &[], None);
        let mut memory = TraceMemory::default();
        let second = within(end + 1..=LAST, &[], &first, None);
        assert_eq!([first.clone(), second.clone()].concat(), whole, "cut behind frame {end}");
        assert_eq!(within(end + 1..=LAST, &[], &first, Some(&mut memory)), second);
        assert_eq!(within(end + 1..=LAST, &[], &first, Some(&mut memory)), second, "from memory");
    }
}

#[test]
fn frames_that_are_traced_once_more_keep_the_numbers() {
    for drawings in [vec![], vec![drawn(1, 0.0), drawn(7, 0.0)], vec![drawn(5, 0.0)]] {
        let whole = traced(&drawings, None);
        // Behind the last drawing the third bar begins anew.
        let last = drawings.last().map_or(LAST, |drawing| drawing.frame);
        for range in [0..=2, 0..=5, 3..=3, 4..=6, 8..=LAST].into_iter().filter(|range| *range.start() <= last) {
            let outside: Vec<TracedDrawing> =
                whole.iter().filter(|drawing| !range.contains(&drawing.frame)).cloned().collect();
            let known: BTreeSet<usize> = tracks(&outside).into_iter().flatten().collect();
            // A stroke that no frame outside has may have another number.
            let of = |drawings: &[TracedDrawing]| -> Vec<(usize, Vec<usize>)> {
                let kept =
                    |all: Vec<usize>| (all.len(), all.into_iter().filter(|track| known.contains(track)).collect());
                tracks(drawings).into_iter().map(kept).collect()
            };
            let again = within(range.clone(), &drawings, &outside, None);
            let before = &whole[*range.start() as usize..=*range.end() as usize];
            assert_eq!(of(&again), of(before), "{} drawings, frames {range:?}", drawings.len());
        }
    }
}

/// The numbers on each frame.
fn tracks(drawings: &[TracedDrawing]) -> Vec<Vec<usize>> {
    let of = |drawing: &TracedDrawing| {
        let mut tracks: Vec<usize> = drawing.strokes.iter().map(|stroke| stroke.track).collect();
        tracks.sort_unstable();
        tracks
    };
    drawings.iter().map(of).collect()
}

#[test]
fn drawings_outside_count() {
    let drawings = [drawn(1, 0.0), drawn(7, 0.0)];
    let whole = traced(&drawings, None);
    for range in [2..=4, 3..=6] {
        let part = &whole[*range.start() as usize..=*range.end() as usize];
        assert_eq!(within(range.clone(), &drawings, &[], None), part, "frames {range:?}, between drawings");
    }
    assert_eq!(within(0..=0, &drawings, &[], None), whole[..1], "before all drawings");
    // What the artist draws after a run has its numbers, too.
    let later = [drawn(1, 0.0), drawn(4, 0.0), drawn(7, 0.0)];
    let outside: Vec<TracedDrawing> = whole.iter().filter(|drawing| drawing.frame < 5).cloned().collect();
    let behind = within(5..=LAST, &later, &outside, None);
    for (again, before) in behind.iter().zip(&whole[5..]) {
        let known = |drawing: &TracedDrawing| drawing.strokes.iter().filter(|stroke| stroke.track < 2).count();
        assert_eq!((known(again), known(before)), (2, 2), "frame {}", again.frame);
    }
}

#[test]
fn an_edit_is_traced_again_only_where_it_matters() {
    let before = [drawn(1, 0.0), drawn(4, 0.0), drawn(7, 0.0)];
    let mut memory = TraceMemory::default();
    traced(&before, Some(&mut memory));
    assert_eq!(memory.spans(), 11, "a step to the start, twice three steps on and the way back, two to the end");
    // The last drawing is edited: the way back from it and the steps behind it are new.
    let after = [drawn(1, 0.0), drawn(4, 0.0), drawn(7, 1.0)];
    assert_eq!(traced(&after, Some(&mut memory)), traced(&after, None));
    assert_eq!(memory.spans(), 14);
    // Undone, all is known.
    assert_eq!(traced(&before, Some(&mut memory)), traced(&before, None));
    assert_eq!(memory.spans(), 14);
    // A further drawing cuts a span in two.
    let cut = [drawn(1, 0.0), drawn(4, 0.0), drawn(5, 0.0), drawn(7, 0.0)];
    assert_eq!(traced(&cut, Some(&mut memory)), traced(&cut, None));
    assert!(memory.spans() <= 20, "at most two ways back, two steps on and two behind: {}", memory.spans());
}

#[test]
fn a_held_drawing_has_the_strokes_of_the_frame_before() {
    let found = on_twos(0..=LAST, &[], &[]);
    assert_eq!(found.iter().map(|drawing| drawing.frame).collect::<Vec<_>>(), (0..=LAST).collect::<Vec<_>>());
    let plain = of(&Holds::none(&OnTwos), 0..=LAST, &[], &[], None);
    for frame in (0..LAST as usize).step_by(2) {
        assert_eq!(found[frame].strokes, found[frame + 1].strokes, "frame {}", frame + 1);
        assert_ne!(plain[frame].strokes, plain[frame + 1].strokes, "by itself it would wobble");
        assert!(frame == 0 || found[frame].strokes != found[frame - 1].strokes, "frame {frame} has moved");
    }
    assert!(found[2].strokes.len() >= 3, "a stroke begins on the way");
}

#[test]
fn a_drawing_of_the_artist_on_a_held_frame_stays() {
    for frame in [4, 5] {
        let mine = Drawn { frame, ..drawn(4, 1.0) };
        for drawings in [vec![mine.clone()], vec![drawn(1, 0.0), mine.clone(), drawn(8, 0.0)]] {
            let found = on_twos(0..=LAST, &drawings, &[]);
            let lines = |frame: usize| -> Vec<Vec<Point>> {
                found[frame].strokes.iter().map(|stroke| stroke.points.clone()).collect()
            };
            let own: Vec<Vec<Point>> = mine.strokes.iter().map(|stroke| stroke.points.clone()).collect();
            assert_eq!(lines(frame as usize), own, "frame {frame}");
            assert_eq!(lines(4) == own, frame == 4, "the frame before a drawing has its own strokes");
            assert_eq!(lines(5), own, "the frame after it shows it");
            assert_eq!(found[6].strokes, found[7].strokes);
        }
    }
}

#[test]
fn stages_give_what_one_run_gives_where_drawings_are_held() {
    let whole = on_twos(0..=LAST, &[], &[]);
    for end in [2, 3, 6] {
        let first = on_twos(0..=end, &[], &[]);
        let second = on_twos(end + 1..=LAST, &[], &first);
        assert_eq!([first, second].concat(), whole, "cut behind frame {end}");
    }
}

#[test]
fn an_edit_of_a_later_drawing_leaves_the_first_frame_as_it_was_traced() {
    let before = traced(&[], None);
    let mut edited = drawn(5, 0.0);
    // The artist deletes the first bar on frame 5, and the third one was never drawn there.
    edited.strokes.remove(0);
    for earlier in [before.clone(), before[..1].to_vec()] {
        let found = within(0..=LAST, std::slice::from_ref(&edited), &earlier, None);
        let lines = |drawing: &TracedDrawing| -> Vec<Vec<Point>> {
            drawing.strokes.iter().map(|stroke| stroke.points.clone()).collect()
        };
        assert_eq!(lines(&found[0]), lines(&before[0]), "the first frame");
        assert!(found[0].strokes.iter().all(|stroke| stroke.confidence.is_none()));
        assert_eq!(lines(&found[5]), [edited.strokes[0].points.clone()], "what was deleted does not come back");
        let second = found[0].strokes.iter().find(|stroke| stroke.points[0].y > 40.0).unwrap().track;
        assert_eq!(tracks(&found)[5], [second], "the drawing has the number of the first frame");
    }
    // Nothing was traced before, so the drawing is the first one.
    let anew = within(0..=LAST, &[edited], &[], None);
    assert!(anew[0].strokes.iter().any(|stroke| stroke.confidence.is_some()));
}

/// The film with one picture that was drawn again: the bars are further.
struct Redrawn(FrameNumber);

impl FrameSource for Redrawn {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        Film.picture(if frame == self.0 { frame + 1 } else { frame })
    }

    fn mark(&self, frame: FrameNumber) -> Result<Option<Mark>, FrameError> {
        Ok(Some(mark(&*self.picture(frame)?)))
    }
}

/// The film with two blank drawings.
struct Blinking;

impl FrameSource for Blinking {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        if (4..=5).contains(&frame) { Ok(Arc::new(Raster::new(120, 90, [1.0; 3]))) } else { Film.picture(frame) }
    }

    fn mark(&self, frame: FrameNumber) -> Result<Option<Mark>, FrameError> {
        Ok(Some(mark(&*self.picture(frame)?)))
    }
}

#[test]
fn what_comes_back_behind_blank_drawings_has_its_numbers() {
    let holds = Holds::none(&Blinking);
    for drawings in
        [vec![], vec![drawn(7, 0.0)], vec![drawn(1, 0.0), drawn(8, 0.0)], vec![drawn(3, 0.0), drawn(6, 0.0)]]
    {
        let anew = of(&holds, 0..=LAST, &drawings, &[], None);
        let numbers = tracks(&anew);
        assert!(numbers[4].is_empty() && numbers[5].is_empty());
        for frame in [2, 3, 6, 7, 8, 9] {
            assert_eq!(numbers[frame][..2], [0, 1], "frame {frame}, {drawings:?}");
        }
        // The artist drew two of the three bars.
        let is_drawn = |frame: FrameNumber| drawings.iter().any(|drawing| drawing.frame == frame);
        assert_eq!(numbers[3].len(), if is_drawn(3) { 2 } else { 3 });
        assert_eq!(numbers[6], numbers[3], "{drawings:?}");
        let mut memory = TraceMemory::default();
        for run in 0..2 {
            assert_eq!(of(&holds, 0..=LAST, &drawings, &[], Some(&mut memory)), anew, "run {run}");
        }
    }
}

/// Traces all frames with and without a cache, which must be the same. Returns how many steps were known.
fn known(frames: &dyn FrameSource, drawings: &[Drawn], options: &Options, store: &Store) -> usize {
    let holds = Holds::none(frames);
    let run =
        |cache: Option<&dyn Cache>| kept(&holds, 0..=LAST, (drawings, &[]), (options, Kept { memory: None, cache }));
    let (found, earlier) = run(Some(store));
    assert_eq!(found, run(None).0, "{} drawings", drawings.len());
    earlier.known
}

#[test]
fn steps_up_to_a_picture_that_was_drawn_again_come_from_the_cache() {
    let (options, store) = (Options::default(), Store::default());
    assert_eq!(known(&Film, &[], &options, &store), 0);
    assert_eq!(known(&Film, &[], &options, &store), LAST as usize + 1);
    assert_eq!(known(&Redrawn(6), &[], &options, &store), 6, "the first picture and the steps to frame 5");
    assert_eq!(known(&Redrawn(0), &[], &options, &store), 0);
    // The artist draws on a frame: the way forwards is known when he draws there again.
    assert_eq!(known(&Film, &[drawn(2, 0.0), drawn(6, 0.0)], &options, &store), 0);
    assert_eq!(
        known(&Film, &[drawn(2, 0.0), drawn(6, 1.0)], &options, &store),
        2 + 4,
        "back to the start, and forwards"
    );
}

#[test]
fn other_options_find_nothing_in_the_cache() {
    let store = Store::default();
    known(&Film, &[], &Options::default(), &store);
    let others = [
        Options { sensitivity: 1.01, ..Options::default() },
        Options { style: Style::Rough, ..Options::default() },
        Options { style: Style::Clean, ..Options::default() },
        Options { leave_out: vec![[0.6, 0.8, 1.0]], ..Options::default() },
    ];
    for options in others {
        assert_eq!(known(&Film, &[], &options, &store), 0, "{options:?}");
    }
}

#[test]
fn entries_that_do_not_fit_count_as_missing() {
    let (options, store) = (Options::default(), Store::default());
    let drawings = [drawn(2, 0.0), drawn(6, 0.0)];
    known(&Film, &drawings, &options, &store);
    let sound = store.0.lock().unwrap().clone();
    let damages: [fn(&mut Span); 5] = [
        |span| span.drawings.push(Vec::new()),
        |span| span.drawings.iter_mut().flatten().for_each(|own| own.track += 1000),
        |span| span.drawings.iter_mut().flatten().for_each(|own| own.confidence = 2.0),
        |span| span.drawings.iter_mut().flatten().for_each(|own| own.stroke.points[0].x = f64::NAN),
        |span| span.new = usize::MAX,
    ];
    for damage in damages {
        let damaged = sound.iter().map(|(mark, bytes)| {
            let mut span: Span = postcard::from_bytes(bytes).unwrap();
            damage(&mut span);
            (*mark, postcard::to_stdvec(&span).unwrap())
        });
        *store.0.lock().unwrap() = damaged.collect();
        assert_eq!(known(&Film, &drawings, &options, &store), 0);
    }
    store.0.lock().unwrap().values_mut().for_each(|bytes| bytes.truncate(9));
    assert_eq!(known(&Film, &drawings, &options, &store), 0);
}

/// The film, whose files change as soon as they are read.
struct Changing(Mutex<usize>);

impl FrameSource for Changing {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        *self.0.lock().unwrap() += 1;
        Film.picture(frame)
    }

    /// As of files that are other ones after they were read.
    fn mark(&self, frame: FrameNumber) -> Result<Option<Mark>, FrameError> {
        if *self.0.lock().unwrap() > 0 { Ok(None) } else { Film.mark(frame) }
    }
}

#[test]
fn of_pictures_that_change_nothing_is_kept() {
    let store = Store::default();
    let holds = Changing(Mutex::default());
    known(&holds, &[], &Options::default(), &store);
    assert!(store.0.lock().unwrap().is_empty());
}
