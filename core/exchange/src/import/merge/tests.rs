use super::*;
use crate::import::Extent;
use rototoon_base::geometry::polyline;

fn footage() -> Footage {
    Footage { pattern: "%d".into(), first: 1, last: 12, fps: 1.0, width: 90, height: 90, held: false }
}

fn at(frame: FrameNumber) -> Vec<Point> {
    let x = f64::from(frame);
    vec![Point::new(x, 1.0), Point::new(x + 9.0, 2.0 + 0.1 * x * x), Point::new(4.0, 20.0)]
}

/// A part with two keys, tracked between them.
fn tracked() -> Part {
    Part {
        name: "arm".into(),
        closed: true,
        depth: 3.5,
        keys: [2, 9].map(|frame| (frame, at(frame))).into(),
        tracks: (2..=9).map(|frame| (frame, at(frame))).collect(),
        confidence: (2..=9).map(|frame| (frame, vec![0.5; 3])).collect(),
        pins: [(4, [(1, at(4)[1])].into()), (6, [(0, at(6)[0])].into())].into(),
        feather: vec![1.0, 2.0, 3.0],
        falloff: Falloff { rate: 2.0, ..Falloff::default() },
        ..Part::default()
    }
}

fn extent(keys: [FrameNumber; 2], hidden: &[[f64; 2]]) -> Extent {
    Extent::new(keys, hidden, &footage())
}

/// The shape that such a part is in a file: a key on every frame.
fn written(part: &Part) -> Shape {
    Shape {
        name: part.name.clone(),
        closed: part.closed,
        keys: part.tracks.iter().map(|(frame, points)| (*frame, points.iter().map(|p| *p + 1e-3).collect())).collect(),
        absent: Vec::new(),
        falloff: None,
        extent: extent([2, 9], &[]),
    }
}

fn put(part: Part, shape: Shape) -> (Part, Change) {
    let mut scene = Scene { footage: footage(), parts: vec![part] };
    let mut merged = into_scene(&mut scene, vec![shape]).unwrap();
    assert_eq!(scene.parts.len(), 1);
    (scene.parts.remove(0), merged.taken.remove(0).change)
}

#[test]
fn what_comes_back_unchanged_changes_nothing() {
    let part = tracked();
    assert_eq!(put(part.clone(), written(&part)), (part.clone(), Change::Nothing));
    let untracked = Part { tracks: BTreeMap::new(), confidence: BTreeMap::new(), pins: BTreeMap::new(), ..part };
    let mut shape = written(&tracked());
    shape.keys.retain(|frame, _| untracked.keys.contains_key(frame));
    assert_eq!(put(untracked.clone(), shape), (untracked, Change::Nothing));
}

#[test]
fn an_edited_frame_becomes_a_key_and_all_else_stays() {
    let part = tracked();
    let mut shape = written(&part);
    shape.keys.get_mut(&4).unwrap()[1].x += 2.0;
    let (found, change) = put(part.clone(), shape.clone());
    assert_eq!(change, Change::Frames(vec![4]));
    assert_eq!(found.keys.keys().copied().collect::<Vec<_>>(), [2, 4, 9]);
    assert_eq!((&found.keys[&4], &found.tracks[&4]), (&shape.keys[&4], &shape.keys[&4]));
    assert!(found.outdated().next().is_none() && !found.confidence.contains_key(&4));
    assert_eq!(found.pins.keys().copied().collect::<Vec<_>>(), [6], "the edit is newer than the pin");
    assert_eq!((&found.tracks[&5], &found.confidence[&5]), (&part.tracks[&5], &part.confidence[&5]));
    assert_eq!((&found.feather, found.falloff), (&part.feather, part.falloff));
}

#[test]
fn frames_between_the_keys_of_the_file_are_as_it_shows_them() {
    let part = tracked();
    let mut shape = written(&part);
    // The artist has deleted the keys on 4 to 6, so the shape goes straight there.
    shape.keys.retain(|frame, _| !(4..=6).contains(frame));
    let (found, change) = put(part.clone(), shape);
    assert_eq!(change, Change::Frames(vec![4, 5, 6]));
    assert_eq!(found.keys, part.keys);
    let y = |frame: FrameNumber| found.tracks[&frame][1].y;
    assert!((y(5) - 0.5 * (y(3) + y(7))).abs() < 2e-3, "half way");
}

#[test]
fn names_that_differ_in_blanks_alone_are_not_swapped() {
    let named = |name: &str| Part { name: name.into(), ..tracked() };
    let taken = |parts: &[&str], shapes: &[&str]| -> Vec<(String, bool)> {
        let mut scene = Scene { footage: footage(), parts: parts.iter().map(|name| named(name)).collect() };
        let shapes = shapes.iter().map(|name| Shape { name: (*name).into(), ..written(&tracked()) }).collect();
        into_scene(&mut scene, shapes)
            .unwrap()
            .taken
            .into_iter()
            .map(|taken| (taken.name, taken.change == Change::New))
            .collect()
    };
    let found = |all: &[(&str, bool)]| all.iter().map(|(name, new)| ((*name).to_owned(), *new)).collect::<Vec<_>>();
    assert_eq!(taken(&["Arm", "Arm "], &["Arm ", "Arm"]), found(&[("Arm ", false), ("Arm", false)]));
    assert_eq!(taken(&[], &["leg "]), found(&[("leg", true)]));
    assert_eq!(taken(&["Arm "], &["Arm"]), found(&[("Arm ", false)]));
    assert_eq!(taken(&["Arm"], &[" Arm\n"]), found(&[("Arm", false)]));
    // The exact name goes first, and what is not clear is new.
    assert_eq!(taken(&["Arm"], &["Arm ", "Arm"]), found(&[("Arm ", true), ("Arm", false)]));
    assert_eq!(taken(&["Arm ", " Arm"], &["Arm"]), found(&[("Arm", true)]));
    assert_eq!(taken(&["Arm "], &["Arm", " Arm"]), found(&[("Arm", true), (" Arm", true)]));
    assert_eq!(taken(&[], &["leg ", "leg"]), found(&[("leg ", true), ("leg", true)]));
}

#[test]
fn a_part_is_hidden_and_shown_as_in_the_file() {
    let part = tracked();
    let mut shape = written(&part);
    shape.keys.retain(|frame, _| !(6..=7).contains(frame));
    (shape.absent, shape.extent) = (vec![[6, 7]], extent([2, 9], &[[6.0, 7.0]]));
    let (hidden, change) = put(part.clone(), shape);
    assert_eq!((change, &hidden.absent[..]), (Change::Frames(vec![6, 7]), &[[6, 7]][..]));
    assert!(hidden.points_at(6).is_none() && hidden.points_at(5).is_some());
    let (shown, change) = put(hidden, written(&part));
    assert_eq!((change, shown.absent.len()), (Change::Frames(vec![6, 7]), 0));
    assert!(shown.points_at(6).is_some());
}

#[test]
fn points_on_the_path_of_a_snapped_part_are_its_own() {
    let mut part = tracked();
    part.pins.clear();
    let bent = |a: Point, b: Point| vec![a, a.lerp(b, 0.5) + Point::new(0.5, 1.0), b];
    let paths = |p: &Vec<Point>| vec![bent(p[0], p[1]), bent(p[1], p[2]), bent(p[2], p[0])];
    part.curves = part.tracks.iter().map(|(frame, points)| (*frame, paths(points))).collect();
    let drawn = |frame: &FrameNumber| (*frame, polyline::resample(&part.outline(*frame).unwrap(), true, 600));
    let keys: BTreeMap<_, _> = part.tracks.keys().map(drawn).collect();
    let mut shape = Shape { keys, ..written(&part) };
    assert_eq!(put(part.clone(), shape.clone()), (part.clone(), Change::Nothing));
    // One frame is edited: it becomes a key with the control points and the paths of the part.
    let edited = part.outline(5).unwrap()[1];
    let moved =
        shape.keys.get_mut(&5).unwrap().iter_mut().min_by(|a, b| a.distance(edited).total_cmp(&b.distance(edited)));
    *moved.unwrap() += Point::new(0.5, 0.5);
    let (found, change) = put(part.clone(), shape.clone());
    assert_eq!((change, found.keys.keys().copied().collect::<Vec<_>>()), (Change::Frames(vec![5]), vec![2, 5, 9]));
    assert_eq!((&found.keys[&5], &found.curves[&5][1..]), (&part.tracks[&5], &part.curves[&5][1..]));
    assert_ne!(found.curves[&5][0], part.curves[&5][0]);
    let others = |part: &Part| {
        part.curves.iter().filter(|(frame, _)| **frame != 5).map(|(_, paths)| paths.clone()).collect::<Vec<_>>()
    };
    assert_eq!((others(&found), &found.tracks), (others(&part), &part.tracks));
    // One that was drawn anew on all frames replaces the part.
    shape.keys.values_mut().flatten().for_each(|p| *p *= 2.0);
    let (found, change) = put(part, shape.clone());
    assert_eq!((change, found.keys), (Change::Replaced, shape.keys));
    assert_eq!(found.depth, 3.5);
}

#[test]
fn a_new_part_is_shown_as_the_file_shows_it() {
    let keys = [2, 9].map(|frame| (frame, at(frame))).into();
    let shape = Shape { name: "leg".into(), keys, absent: vec![[4, 5]], ..written(&tracked()) };
    let mut scene = Scene { footage: footage(), parts: vec![tracked()] };
    let still = Shape { name: "box".into(), keys: [(3, at(3))].into(), extent: extent([3, 3], &[]), ..shape.clone() };
    let still = Shape { absent: Vec::new(), ..still };
    let taken = into_scene(&mut scene, vec![shape, still]).unwrap().taken;
    assert!(taken.iter().all(|taken| taken.change == Change::New), "{taken:?}");
    let [_, leg, still] = &scene.parts[..] else { panic!("{}", scene.parts.len()) };
    assert_eq!((leg.depth, still.depth), (4.0, 5.0));
    assert_eq!(leg.tracks.keys().copied().collect::<Vec<_>>(), [2, 3, 6, 7, 8, 9]);
    assert!((leg.tracks[&6][0].x - 6.0).abs() < 1e-9);
    assert!((1..=12).all(|frame| still.points_at(frame) == Some(&at(3))) && still.keys.len() == 1);
}

#[test]
fn a_drawing_of_one_frame_changes_that_frame_alone() {
    let part = tracked();
    let shape = Shape { keys: [(6, at(11))].into(), extent: extent([6, 6], &[]).of_drawing(), ..written(&part) };
    let (found, change) = put(part.clone(), shape.clone());
    assert_eq!((change, found.keys.len(), &found.keys[&6]), (Change::Frames(vec![6]), 3, &at(11)));
    assert!(part.tracks.iter().all(|(frame, own)| *frame == 6 || found.tracks[frame] == *own));
    // One that a film shows on all of its frames is on them.
    let still = Shape { extent: extent([6, 6], &[[-9.0, 0.0]]), ..shape.clone() };
    let (found, _) = put(part.clone(), still);
    assert!((2..=9).all(|frame| found.points_at(frame) == Some(&at(11))));
    // A film that does not say so may be a cut of one frame.
    let cut = Shape { extent: extent([6, 6], &[]), ..shape };
    assert_eq!(put(part, cut).1, Change::Frames(vec![6]));
}

#[test]
fn a_range_of_frames_says_nothing_of_others() {
    let part = tracked();
    let mut cut = Shape { extent: extent([4, 6], &[[-9.0, 3.0], [7.0, 99.0]]), ..written(&part) };
    cut.keys.retain(|frame, _| (4..=6).contains(frame));
    let merged = |shape: Shape| {
        let mut scene = Scene { footage: footage(), parts: vec![part.clone()] };
        let merged = into_scene(&mut scene, vec![shape]).unwrap();
        (scene.parts, merged)
    };
    let (parts, told) = merged(cut.clone());
    assert_eq!((&parts[0], &told.taken[0].change), (&part, &Change::Nothing));
    assert_eq!(told.kept, [("arm".into(), vec![2, 3, 7, 8, 9])]);
    // An edit within it.
    cut.keys.insert(5, at(11));
    let (parts, told) = merged(cut.clone());
    assert_eq!(told.taken[0].change, Change::Frames(vec![5]));
    let kept =
        |frame: FrameNumber| (parts[0].points_at(frame), parts[0].keys.get(&frame), parts[0].confidence.get(&frame));
    let own = |frame: FrameNumber| (part.points_at(frame), part.keys.get(&frame), part.confidence.get(&frame));
    assert!([2, 3, 4, 6, 7, 8, 9].into_iter().all(|frame| kept(frame) == own(frame)));
    // One with more points than the part, or one that is open now.
    let more = |points: &Vec<Point>| polyline::resample(points, true, 30);
    let finer = Shape { keys: cut.keys.iter().map(|(frame, points)| (*frame, more(points))).collect(), ..cut.clone() };
    let (parts, told) = merged(finer);
    assert_eq!((&told.taken[0].change, parts[0].keys[&5].len()), (&Change::Frames(vec![5]), 3));
    let (parts, told) = merged(Shape { closed: false, ..cut.clone() });
    assert_eq!((parts.len(), &parts[0], parts[1].name.as_str()), (2, &part, "arm 2"));
    assert_eq!(told.taken[0], Taken { name: "arm 2".into(), change: Change::Beside("arm".into()) });
}

#[test]
fn a_part_beside_another_one_takes_no_name_of_the_file() {
    let mut scene = Scene { footage: footage(), parts: vec![tracked()] };
    let open = Shape { keys: [(5, at(5))].into(), closed: false, extent: extent([5, 5], &[]), ..written(&tracked()) };
    let other = Shape { name: "arm 2".into(), ..open.clone() };
    let names: Vec<_> =
        into_scene(&mut scene, vec![open, other]).unwrap().taken.into_iter().map(|taken| taken.name).collect();
    assert_eq!(names, ["arm 3", "arm 2"]);
}

#[test]
fn a_part_that_is_not_tracked_is_hidden_as_in_the_file() {
    let part =
        Part { keys: [2, 9].map(|frame| (frame, at(frame))).into(), ..Part { tracks: BTreeMap::new(), ..tracked() } };
    let part = Part { confidence: BTreeMap::new(), pins: BTreeMap::new(), ..part };
    let mut shape = Shape { keys: part.keys.clone(), ..written(&tracked()) };
    assert_eq!(put(part.clone(), shape.clone()).1, Change::Nothing);
    for frame in [4, 7] {
        shape.keys.insert(frame, form(&part.keys, frame));
    }
    (shape.absent, shape.extent) = (vec![[5, 6]], extent([2, 9], &[[5.0, 6.0]]));
    let (found, change) = put(part.clone(), shape.clone());
    assert_eq!((&found.absent[..], change), (&[[5, 6]][..], Change::Frames(vec![5, 6])));
    assert_eq!(found.keys, part.keys);
    assert_eq!(put(found.clone(), shape), (found, Change::Nothing));
}

#[test]
fn parts_that_lie_in_another_order_in_the_file_move() {
    let part = |name: &str, depth| Part { name: name.into(), depth, ..tracked() };
    let mut scene = Scene { footage: footage(), parts: vec![part("arm", 0.0), part("leg", 1.0), part("head", 2.0)] };
    let shapes = [1, 0, 2].map(|k| written(&scene.parts[k])).into();
    let merged = into_scene(&mut scene, shapes).unwrap();
    assert_eq!(merged.moved, ["arm"]);
    assert!(merged.taken.iter().all(|taken| taken.change == Change::Nothing));
    let depths: Vec<_> = scene.parts.iter().map(|part| part.depth).collect();
    assert_eq!(depths, [1.5, 1.0, 2.0]);
}

#[test]
fn a_depth_that_is_the_same_on_all_frames_counts_as_exports_have_it() {
    let part = |name: &str, depth| Part { name: name.into(), depth, ..tracked() };
    let mut scene = Scene { footage: footage(), parts: vec![part("arm", 0.0), part("leg", 1.0), part("head", 2.0)] };
    scene.parts[0].depths = (1..=12).map(|frame| (frame, 5.0)).collect();
    let before = scene.clone();
    let shapes = |order: [usize; 3]| order.map(|k| written(&before.parts[k])).into();
    assert!(into_scene(&mut scene, shapes([1, 2, 0])).unwrap().moved.is_empty());
    assert_eq!(scene, before);
    assert_eq!(into_scene(&mut scene, shapes([2, 1, 0])).unwrap().moved, ["leg"]);
    let depths: Vec<_> = scene.parts.iter().map(|part| part.depth_at(3)).collect();
    assert_eq!(depths, [5.0, 3.5, 2.0]);
}

#[test]
fn the_rate_of_a_falloff_is_taken_where_it_is_another_one() {
    let part = tracked();
    let border = |rate: f64| Shape { falloff: Some(Falloff { rate, curve: None }), ..written(&part) };
    assert_eq!(put(part.clone(), border(2.0)).1, Change::Nothing);
    let (found, change) = put(part.clone(), border(3.0));
    assert_eq!((found.falloff.rate, change), (3.0, Change::Frames(Vec::new())));
}

#[test]
fn parts_that_are_no_contours_do_no_harm() {
    let points = |count: usize| (0..count).map(|k| Point::new(k as f64, 3.0)).collect::<Vec<_>>();
    for closed in [false, true] {
        for own in 0..4 {
            for tracked in 0..4 {
                for file in 1..4 {
                    let keys = BTreeMap::from([(2, points(own)), (9, points(own))]);
                    let tracks = BTreeMap::from([(5, points(tracked))]);
                    let curves = BTreeMap::from([(2, vec![points(2); own]), (5, vec![points(2); tracked])]);
                    let part = Part { closed, keys, tracks, curves, name: "arm".into(), ..Part::default() };
                    let keys = [4, 5].map(|frame| (frame, points(file))).into();
                    let shape = Shape { keys, closed, extent: extent([4, 5], &[]), ..written(&part) };
                    let mut scene = Scene { footage: footage(), parts: vec![part] };
                    into_scene(&mut scene, vec![shape]).unwrap();
                    let counts: BTreeSet<usize> = scene.parts[0].keys.values().map(Vec::len).collect();
                    assert_eq!(counts.len(), 1, "{closed} {own} {tracked} {file}");
                }
            }
        }
    }
}

#[test]
fn a_small_shape_on_very_many_frames_is_refused() {
    let points = |shift: f64| (0..400).map(|k| Point::new(f64::from(k) + shift, shift)).collect::<Vec<_>>();
    let film = Footage { last: 1_000_000, ..footage() };
    let shape = |closed: bool, keys: &[FrameNumber]| Shape {
        name: "arm".into(),
        closed,
        keys: keys.iter().map(|&frame| (frame, points(f64::from(frame)))).collect(),
        absent: Vec::new(),
        falloff: None,
        extent: Extent::new([keys[0], keys[keys.len() - 1]], &[], &film),
    };
    let own = |closed: bool| Part { closed, tracks: [(5, points(0.0))].into(), ..tracked() };
    let still = shape(true, &[1]);
    let moving = shape(true, &[1, 1_000_000]);
    for (parts, shape) in [
        (Vec::new(), still),
        (Vec::new(), moving.clone()),
        (vec![own(false)], moving.clone()),
        (vec![own(true)], moving.clone()),
        (vec![Part { keys: BTreeMap::new(), ..own(true) }], moving),
    ] {
        let mut scene = Scene { footage: film.clone(), parts };
        let before = scene.clone();
        let error = into_scene(&mut scene, vec![shape]).unwrap_err();
        assert!(error.to_string().starts_with("found more than 20000000 points of shapes on all frames"), "{error}");
        assert_eq!(scene, before);
    }
}
