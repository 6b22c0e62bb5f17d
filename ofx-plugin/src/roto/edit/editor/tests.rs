//! Scripted and random pens.

use super::*;
use proptest::prelude::*;
use rototoon::scene::{Footage, Part, Scene};

const FRAME: FrameNumber = 2;

fn p(x: f64, y: f64) -> Point {
    Point::new(x, y)
}

fn square(x: f64, y: f64) -> Vec<Point> {
    vec![p(x, y), p(x + 20.0, y), p(x + 20.0, y + 20.0), p(x, y + 20.0)]
}

/// A tracked square with keys on frames 0 and 4, and a still open line in front of it.
fn document() -> Document {
    let footage =
        Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 24.0, width: 200, height: 100, held: false };
    let at = |frame: i32| square(20.0 + 5.0 * f64::from(frame), 30.0);
    let square = Part {
        name: "square".into(),
        closed: true,
        keys: [0, 4].map(|frame| (frame, at(frame))).into(),
        tracks: (0..=4).map(|frame| (frame, at(frame))).collect(),
        confidence: (0..=4).map(|frame| (frame, vec![0.5; 4])).collect(),
        ..Part::default()
    };
    let line = vec![p(100.0, 10.0), p(150.0, 10.0)];
    let line = Part { name: "line".into(), depth: 1.0, keys: [(FRAME, line)].into(), ..Part::default() };
    Document::new(Scene { footage, parts: vec![square, line] })
}

fn work(document: &Document) -> Work<'_> {
    let lens = Lens::new(p(1.0, 1.0));
    Work {
        document,
        frame: FRAME,
        parts: &[0, 1],
        lens,
        tool: Tool::Select,
        closed: true,
        name: "",
        reach: Reach::default(),
    }
}

fn drag(editor: &mut Editor, work: &Work, from: Point, to: Point) -> Outcome {
    editor.down(work, from);
    editor.move_to(work, from.lerp(to, 0.5));
    editor.up(work, to)
}

fn edited(outcome: Outcome) -> Document {
    match outcome {
        Outcome::Edited(edit) => {
            assert_eq!(edit.document.problems().error_count(), 0, "{}", edit.document.problems());
            edit.document
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_point_becomes_a_pin_a_part_a_centre_and_a_key_moves() {
    let document = document();
    let (mut editor, mut work) = (Editor::default(), work(&document));
    let corner = p(30.0, 30.0);
    let pinned = edited(drag(&mut editor, &work, corner, p(25.0, 26.0)));
    let part = &pinned.scene.parts[0];
    assert_eq!(part.pins[&2], [(0, p(25.0, 26.0))].into());
    assert_eq!((part.tracks[&2][0], part.keys.len(), part.centers.len()), (p(25.0, 26.0), 2, 0));
    // The contour between two points picks the part.
    let moved = edited(drag(&mut editor, &work, p(40.0, 30.0), p(43.0, 35.0)));
    let part = &moved.scene.parts[0];
    assert_eq!((part.centers[&2], part.pins.len()), (p(43.0, 45.0), 0));
    assert_eq!(part.tracks[&2], square(33.0, 35.0));
    work.frame = 4;
    editor.selection = Selection::default();
    let keyed = edited(drag(&mut editor, &work, p(60.0, 50.0), p(61.0, 59.0)));
    let part = &keyed.scene.parts[0];
    assert_eq!((part.keys[&4][2], part.tracks[&4][2], part.pins.len()), (p(61.0, 59.0), p(61.0, 59.0), 0));
}

#[test]
fn clicks_select_points_parts_and_boxes() {
    let document = document();
    let (mut editor, work) = (Editor::default(), work(&document));
    let click = |editor: &mut Editor, at: Point| drag(editor, &work, at, at);
    assert!(matches!(click(&mut editor, p(31.0, 31.0)), Outcome::Selected(Some(name)) if name == "square"));
    assert_eq!(editor.selection.len(), 1);
    editor.key(&work, Key::Shift(true));
    click(&mut editor, p(50.0, 30.0));
    assert_eq!(editor.selection.of_part(0), [0, 1].into());
    editor.key(&work, Key::Shift(false));
    editor.key(&work, Key::Escape);
    click(&mut editor, p(40.0, 41.0));
    assert_eq!(editor.selection.len(), 4, "inside the square");
    drag(&mut editor, &work, p(45.0, 1.0), p(130.0, 35.0));
    assert_eq!((editor.selection.of_part(0), editor.selection.of_part(1)), ([1].into(), [0].into()));
    assert!(matches!(click(&mut editor, p(190.0, 90.0)), Outcome::Selected(None)));
    assert!(editor.selection.is_empty());
}

#[test]
fn drawn_contours_are_new_parts_or_keys() {
    let document = document();
    let (mut editor, mut work) = (Editor::default(), work(&document));
    (work.tool, work.frame) = (Tool::Contour, 9);
    for at in [p(100.0, 40.0), p(140.0, 40.0), p(120.0, 80.0)] {
        assert!(matches!(editor.down(&work, at), Outcome::Shown));
        editor.up(&work, at);
    }
    let drawn = edited(editor.down(&work, p(103.0, 42.0)));
    let part = &drawn.scene.parts[2];
    assert_eq!((part.name.as_str(), part.closed, part.depth), ("part 1", true, 2.0));
    assert_eq!(part.keys[&9], [p(100.0, 40.0), p(140.0, 40.0), p(120.0, 80.0)]);
    // The other way round, from another corner: the points are those of the part.
    work.name = "square";
    let turned = [p(80.0, 50.0), p(60.0, 50.0), p(60.0, 30.0), p(80.0, 30.0)];
    turned.iter().for_each(|&at| {
        editor.down(&work, at);
    });
    let keyed = edited(editor.key(&work, Key::Enter));
    assert_eq!(keyed.scene.parts[0].keys[&9], square(60.0, 30.0));
    (work.tool, work.closed, work.name) = (Tool::Freehand, false, "swing");
    editor.down(&work, p(10.0, 10.0));
    for k in 1..60 {
        editor.move_to(&work, p(10.0 + 2.0 * f64::from(k), 10.0 + 20.0 * (0.1 * f64::from(k)).sin()));
    }
    let drawn = edited(editor.up(&work, p(130.0, 10.0)));
    let part = &drawn.scene.parts[2];
    assert!(!part.closed && (6..30).contains(&part.keys[&9].len()), "{:?}", part.keys);
}

#[test]
fn wrong_contours_are_refused_and_stay_until_they_are_finished_or_dropped() {
    let document = document();
    let (mut editor, mut work) = (Editor::default(), work(&document));
    work.tool = Tool::Contour;
    editor.down(&work, p(10.0, 10.0));
    editor.down(&work, p(60.0, 60.0));
    assert!(matches!(editor.key(&work, Key::Enter), Outcome::Refused(text) if text.0.contains("at least 3")));
    assert_eq!(editor.sketch(FRAME).unwrap().points, [p(10.0, 10.0), p(60.0, 60.0)]);
    for _ in 0..2 {
        assert!(matches!(editor.key(&work, Key::Back), Outcome::Shown));
    }
    assert_eq!(editor.sketch(FRAME), None);
    editor.down(&work, p(10.0, 10.0));
    assert!(matches!(editor.key(&work, Key::Escape), Outcome::Shown));
    assert_eq!(editor.sketch(FRAME), None);
    work.frame = 400;
    for at in [p(10.0, 10.0), p(60.0, 60.0), p(90.0, 10.0)] {
        editor.down(&work, at);
    }
    assert!(matches!(editor.key(&work, Key::Enter), Outcome::Refused(text) if text.0.contains("frame 400 is outside")));
    assert_eq!(editor.sketch(400).map(|sketch| sketch.points.len()), Some(3));
    editor.key(&work, Key::Escape);
    (work.frame, work.name, work.closed) = (FRAME, "square", false);
    editor.down(&work, p(10.0, 10.0));
    editor.down(&work, p(60.0, 60.0));
    assert!(matches!(editor.key(&work, Key::Enter), Outcome::Refused(text) if text.0.contains("is closed")));
    work.tool = Tool::Off;
    assert!(matches!(editor.down(&work, p(30.0, 30.0)), Outcome::Ignored));
}

#[test]
fn a_refused_contour_is_finished_when_the_message_is_followed() {
    let document = document();
    let mut work = Work { name: "line", ..work(&document) };
    let corners = [p(100.0, 40.0), p(140.0, 40.0), p(120.0, 80.0)];
    let refused = |outcome| matches!(outcome, Outcome::Refused(text) if text.0.contains("switch Closed off"));
    for tool in [Tool::Contour, Tool::Freehand] {
        let mut editor = Editor::default();
        (work.tool, work.name, work.closed) = (tool, "line", true);
        if tool == Tool::Contour {
            corners.iter().for_each(|&at| drop(editor.down(&work, at)));
            assert!(refused(editor.down(&work, corners[0])));
        } else {
            editor.down(&work, corners[0]);
            (0..60).for_each(|k| {
                drop(editor.move_to(&work, corners[k / 20].lerp(corners[(k / 20 + 1) % 3], (k % 20) as f64 / 20.0)))
            });
            assert!(refused(editor.up(&work, corners[0])));
        }
        // As an open contour it is a key of the line, and with New part a part of its own.
        let mut other = editor.clone();
        work.closed = false;
        assert!(edited(other.key(&work, Key::Enter)).scene.parts[1].keys.contains_key(&FRAME));
        (work.name, work.closed) = ("", true);
        let drawn = edited(editor.key(&work, Key::Enter));
        let part = &drawn.scene.parts[2];
        assert!(part.closed && corners.iter().all(|at| part.keys[&FRAME].iter().any(|p| p.distance(*at) < 12.0)));
        assert_eq!(editor.sketch(FRAME), None, "nothing is left");
    }
    // A click with the freehand tool is no stroke.
    let mut editor = Editor::default();
    assert!(matches!(drag(&mut editor, &work, corners[0], corners[0]), Outcome::Refused(_)));
    assert_eq!(editor.sketch(FRAME), None);
}

#[test]
fn a_new_part_lies_in_front_of_parts_that_are_nearer_on_some_frames() {
    let mut document = document();
    document.scene.parts[0].depths = [(0, 7.5), (3, -2.0)].into();
    let mut work = work(&document);
    (work.tool, work.frame) = (Tool::Contour, 0);
    let mut editor = Editor::default();
    [p(100.0, 40.0), p(140.0, 40.0), p(120.0, 80.0)].iter().for_each(|&at| drop(editor.down(&work, at)));
    assert_eq!(edited(editor.key(&work, Key::Enter)).scene.parts[2].depth, 8.0);
}

#[test]
fn a_new_part_has_a_name_that_lists_can_have() {
    let mut document = document();
    document.scene.parts[1].name = "arm, left".into();
    let (mut editor, mut work) = (Editor::default(), work(&document));
    for name in ["arm, right", "arm*"] {
        for tool in [Tool::Contour, Tool::Freehand] {
            (work.tool, work.name) = (tool, name);
            let refused = editor.down(&work, p(10.0, 10.0));
            assert!(matches!(refused, Outcome::Refused(text) if text.0.starts_with("Part: found")), "{name}");
        }
    }
    // A part that the document has is drawn whatever its name. A contour that is begun stays until the name is another one.
    (work.tool, work.name, work.closed) = (Tool::Contour, "arm, left", false);
    [p(100.0, 40.0), p(140.0, 40.0)].iter().for_each(|&at| drop(editor.down(&work, at)));
    work.name = "arm*";
    assert!(matches!(editor.key(&work, Key::Enter), Outcome::Refused(_)));
    work.name = "arm, left";
    assert_eq!(edited(editor.key(&work, Key::Enter)).scene.parts.len(), 2);
}

#[test]
fn a_key_too_many_while_drawing_deletes_nothing() {
    let document = document();
    let (mut editor, mut work) = (Editor::default(), work(&document));
    work.tool = Tool::Contour;
    for at in [p(100.0, 40.0), p(140.0, 40.0), p(120.0, 80.0)] {
        editor.down(&work, at);
    }
    let drawn = edited(editor.key(&work, Key::Enter));
    let mut next = Work { document: &drawn, parts: &[0, 1, 2], ..work };
    assert_eq!(editor.selection.parts(), [2].into(), "the new part is selected");
    editor.down(&next, p(10.0, 10.0));
    for key in [Key::Back, Key::Back, Key::Delete] {
        assert!(matches!(editor.key(&next, key), Outcome::Shown), "{key:?}");
    }
    next.tool = Tool::Freehand;
    assert!(matches!(editor.key(&next, Key::Back), Outcome::Shown));
    next.tool = Tool::Select;
    assert_eq!(edited(editor.key(&next, Key::Back)).scene.parts.len(), 2);
}

#[test]
fn parts_that_must_not_be_changed_are_neither_drawn_nor_changed() {
    let document = document();
    let mut work = Work { parts: &[1], ..work(&document) };
    let mut editor = Editor::default();
    editor.select(Selection::part(0, &document.scene), &document.scene);
    let protected =
        |outcome| matches!(outcome, Outcome::Refused(text) if text.0 == "\"square\" is locked or not among Parts");
    assert!(protected(editor.insert_between(&work)) && protected(editor.smooth_selected(&work)));
    assert!(protected(editor.delete_selected(&work)) && protected(editor.feather_selected(&work, 3.0)));
    // Of several parts those are changed that may be.
    editor.selection.add(&Selection::part(1, &document.scene));
    let inserted = edited(editor.insert_between(&work));
    assert_eq!([0, 1].map(|part| inserted.scene.parts[part].point_count()), [4, 3]);
    for tool in [Tool::Contour, Tool::Freehand] {
        (work.tool, work.name) = (tool, "square");
        assert!(protected(editor.down(&work, p(10.0, 10.0))) && editor.sketch(FRAME).is_none());
        assert!(matches!(editor.up(&work, p(10.0, 10.0)), Outcome::Shown));
    }
    // A contour that was begun before stays, and is finished when the part may be changed again.
    let open = Work { parts: &[0, 1], tool: Tool::Contour, ..work };
    for at in [p(100.0, 40.0), p(140.0, 40.0), p(120.0, 80.0)] {
        editor.down(&open, at);
    }
    work.tool = Tool::Contour;
    assert!(protected(editor.key(&work, Key::Enter)) && protected(editor.down(&work, p(100.0, 40.0))));
    assert_eq!(edited(editor.key(&open, Key::Enter)).scene.parts[0].keys.len(), 3);
}

#[test]
fn the_selection_stays_with_its_part_when_parts_come_and_go() {
    let document = document();
    let mut fewer = document.clone();
    fewer.scene.parts.remove(0);
    let mut editor = Editor::default();
    editor.select(Selection::part(1, &document.scene), &document.scene);
    editor.follow(&fewer.scene);
    assert_eq!(editor.selection, Selection::part(0, &fewer.scene), "the line has another index");
    editor.follow(&document.scene);
    assert_eq!(editor.selection, Selection::part(1, &document.scene));
    editor.select(Selection::part(0, &document.scene), &document.scene);
    let few = Work { parts: &[0], ..work(&fewer) };
    assert!(matches!(editor.key(&few, Key::Delete), Outcome::Ignored), "the square is gone");
    assert!(editor.selection.is_empty());
    editor.select(Selection::part(0, &fewer.scene), &fewer.scene);
    let mut renamed = fewer.clone();
    renamed.scene.parts[0].name = "ground".into();
    editor.rename("line", "ground");
    editor.follow(&renamed.scene);
    assert_eq!(editor.selection.len(), 2);
}

#[test]
fn points_are_inserted_deleted_and_smoothed() {
    let document = document();
    let (mut editor, work) = (Editor::default(), work(&document));
    editor.key(&work, Key::Control(true));
    let inserted = edited(editor.down(&work, p(40.0, 30.5)));
    let part = &inserted.scene.parts[0];
    assert_eq!((part.keys[&0][1], part.tracks[&4][1], part.confidence[&3].len()), (p(30.0, 30.0), p(50.0, 30.0), 5));
    editor.key(&work, Key::Control(false));
    editor.selection = Selection::of([Place { part: 0, point: 2 }]);
    let fewer = edited(editor.key(&work, Key::Delete));
    assert_eq!(fewer.scene.parts[0].keys[&0], [p(20.0, 30.0), p(40.0, 30.0), p(20.0, 50.0)]);
    editor.selection = Selection::part(1, &document.scene);
    assert_eq!(edited(editor.key(&work, Key::Delete)).scene.parts.len(), 1);
    editor.selection = Selection::of([0, 1].map(|point| Place { part: 0, point }));
    assert!(matches!(editor.key(&work, Key::Back), Outcome::Refused(text) if text.0.contains("at least 3")));
    let more = edited(editor.insert_between(&work));
    assert_eq!(more.scene.parts[0].keys[&4][1], p(50.0, 30.0));
    editor.selection = Selection::of([Place { part: 0, point: 1 }]);
    assert_eq!(edited(editor.smooth_selected(&work)).scene.parts[0].pins[&2][&1], p(45.0, 35.0));
}

#[test]
fn a_drag_with_control_gives_the_selected_points_a_feather() {
    let document = document();
    let (mut editor, work) = (Editor::default(), work(&document));
    editor.key(&work, Key::Control(true));
    // The corner is at (30, 30): its outer edge is dragged 5 pixels away.
    editor.down(&work, p(31.0, 30.0));
    editor.move_to(&work, p(27.0, 26.0));
    assert_eq!(editor.feather(&work, 0), [5.0, 0.0, 0.0, 0.0], "seen while the pen drags");
    let one = edited(editor.up(&work, p(27.0, 26.0)));
    assert_eq!(one.scene.parts[0].feather, [5.0, 0.0, 0.0, 0.0]);
    assert_eq!(one.scene.parts[0].tracks, document.scene.parts[0].tracks, "no point moves");
    let softer = Work { document: &one, ..work };
    editor.selection = Selection::of([0, 1].map(|point| Place { part: 0, point }));
    let two = edited(drag(&mut editor, &softer, p(50.0, 30.0), p(62.34, 30.0)));
    assert_eq!(two.scene.parts[0].feather, [12.3, 12.3, 0.0, 0.0]);
    // Points that come between have what was there; points that go take theirs along.
    editor.key(&softer, Key::Control(false));
    let inserted = edited(editor.insert_between(&Work { document: &two, ..work }));
    assert_eq!(inserted.scene.parts[0].feather, [12.3, 12.3, 12.3, 0.0, 0.0]);
    editor.selection = Selection::of([Place { part: 0, point: 0 }]);
    let fewer = edited(editor.delete_selected(&Work { document: &two, ..work }));
    assert_eq!(fewer.scene.parts[0].feather, [12.3, 0.0, 0.0]);
    // Back at its point the border is sharp again, and a sharp part has no widths.
    editor.key(&work, Key::Control(true));
    let sharp = edited(drag(&mut editor, &softer, p(30.0, 34.0), p(30.0, 30.5)));
    assert!(sharp.scene.parts[0].feather.is_empty());
    editor.selection = Selection::part(1, &document.scene);
    assert!(matches!(editor.feather_selected(&work, 3.0), Outcome::Refused(text) if text.0.contains("is open")));
}

#[test]
fn handles_scale_and_a_drag_over_a_change_of_frame_is_dropped() {
    let document = document();
    let (mut editor, mut work) = (Editor::default(), work(&document));
    editor.select(Selection::part(0, &document.scene), &document.scene);
    let corner = editor.handles(&work).unwrap().corners()[2];
    let scaled = edited(drag(&mut editor, &work, corner, corner + p(34.0, 34.0)));
    // The handle is 14 pixels off the points, 34 from the opposite corner: it doubles the size.
    let points = &scaled.scene.parts[0].tracks[&2];
    assert!(points[2].distance(p(70.0, 70.0)) < 1e-9 && points[0].distance(p(30.0, 30.0)) < 1e-9, "{points:?}");
    assert_eq!(scaled.scene.parts[0].pins[&2].len(), 3, "the corner that stays is not pinned");
    // A click on a handle that trembles is no edit.
    assert!(matches!(drag(&mut editor, &work, corner, corner + p(1.2, 1.2)), Outcome::Shown));
    assert_eq!(editor.selection.len(), 4);
    editor.selection = Selection::default();
    editor.down(&work, p(30.0, 30.0));
    editor.move_to(&work, p(5.0, 5.0));
    work.frame = 3;
    assert!(matches!(editor.up(&work, p(5.0, 5.0)), Outcome::Shown));
}

#[derive(Clone, Debug)]
enum Step {
    Down(f64, f64),
    Move(f64, f64),
    Up(f64, f64),
    Key(Key),
    Tool(Tool),
    Frame(FrameNumber),
    Undo,
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let place = || (-20.0..220.0f64, -20.0..120.0f64);
    let near = prop::sample::select(vec![(30.0, 30.0), (50.0, 30.0), (40.0, 50.0), (100.0, 10.0), (125.0, 10.0)]);
    let keys = vec![Key::Delete, Key::Back, Key::Escape, Key::Enter, Key::Shift(true), Key::Shift(false)];
    let keys = keys.into_iter().chain([Key::Control(true), Key::Control(false)]).collect::<Vec<_>>();
    let step = prop_oneof![
        4 => place().prop_map(|(x, y)| Step::Down(x, y)),
        6 => near.prop_map(|(x, y)| Step::Down(x, y)),
        6 => place().prop_map(|(x, y)| Step::Move(x, y)),
        8 => place().prop_map(|(x, y)| Step::Up(x, y)),
        3 => prop::sample::select(keys).prop_map(Step::Key),
        2 => prop::sample::select(vec![Tool::Select, Tool::Contour, Tool::Freehand, Tool::Off]).prop_map(Step::Tool),
        2 => (-1..11i32).prop_map(Step::Frame),
        1 => Just(Step::Undo),
    ];
    prop::collection::vec(step, 1..60)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever the pen does, documents stay free of errors, keys that were not touched stay, and undo gives back the bytes.
    #[test]
    fn any_pen_leaves_a_sound_document(steps in steps()) {
        let mut history = vec![document()];
        let mut editor = Editor::default();
        let (mut tool, mut frame) = (Tool::Select, FRAME);
        for step in steps {
            let current = history.last().unwrap().clone();
            let before = current.to_json();
            let parts: Vec<usize> = (0..current.scene.parts.len()).collect();
            let work = Work { tool, frame, parts: &parts, ..work(&current) };
            let outcome = match step {
                Step::Down(x, y) => editor.down(&work, p(x, y)),
                Step::Move(x, y) => editor.move_to(&work, p(x, y)),
                Step::Up(x, y) => editor.up(&work, p(x, y)),
                Step::Key(key) => editor.key(&work, key),
                Step::Tool(new) => { tool = new; Outcome::Shown }
                Step::Frame(new) => { frame = new; Outcome::Shown }
                Step::Undo => { if history.len() > 1 { history.pop(); } Outcome::Shown }
            };
            for index in 0..current.scene.parts.len() {
                if let Some(shape) = current.scene.parts[index].points_at(frame) {
                    prop_assert_eq!(editor.shown(&work, index, shape).len(), shape.len());
                }
            }
            if let Outcome::Edited(edit) = outcome {
                let problems = edit.document.problems();
                prop_assert_eq!(problems.error_count(), 0, "{}", problems);
                prop_assert!(edit.document.to_json() != before, "{} changed nothing", edit.label);
                for part in &edit.document.scene.parts {
                    let count = part.point_count();
                    prop_assert!(part.tracks.values().all(|points| points.len() == count));
                }
                history.push(edit.document);
            }
            prop_assert_eq!(current.to_json(), before);
        }
    }
}
