use super::*;
use crate::matching::{self, Pair, match_strokes};
use proptest::prelude::*;
use rototoon_base::geometry::polygon;
use rototoon_base::scene::Silent;

fn key(frame: i32, strokes: Vec<Stroke>) -> Key {
    Key { frame, strokes, ..Key::default() }
}

fn by_index(count: usize) -> Matching {
    let pair = |i| Pair { from: i, to: i, reversed: false, start: 0.0, confidence: 1.0, by_hand: false };
    Matching { pairs: (0..count).map(pair).collect(), ..Matching::default() }
}

fn sequence(keys: Vec<Key>, options: &Options) -> Sequence {
    let found: Vec<Matching> = keys
        .windows(2)
        .map(|k| match_strokes(&k[0].strokes, &k[1].strokes, &[], &matching::Options::default(), &Silent).unwrap())
        .collect();
    Sequence::new(keys, &found, &GivenPegs::default(), options).unwrap()
}

fn circle(centre: Point, radius: f64, turn: f64) -> Stroke {
    let at = |k: usize| turn + std::f64::consts::TAU * k as f64 / 48.0;
    Stroke::new((0..48).map(|k| centre + Point::from_angle(at(k)) * radius).collect(), true)
}

#[test]
fn a_circle_turned_by_half_a_turn_keeps_its_radius() {
    let centre = Point::new(40.0, 70.0);
    let keys = vec![key(1, vec![circle(centre, 30.0, 0.0)]), key(9, vec![circle(centre, 30.0, std::f64::consts::PI)])];
    let sequence = Sequence::new(keys, &[by_index(1)], &GivenPegs::default(), &Options::default()).unwrap();
    for frame in 2..9 {
        for p in &sequence.at(frame)[0].stroke.points {
            assert!((p.distance(centre) - 30.0).abs() < 0.3, "{frame}: {p}");
        }
    }
}

#[test]
fn a_bar_that_turns_about_its_end_moves_along_an_arc() {
    let bar = |angle: f64| Stroke::new((0..9).map(|k| Point::from_angle(angle) * (k as f64 * 10.0)).collect(), false);
    let keys = vec![key(0, vec![bar(0.0)]), key(10, vec![bar(1.5)])];
    let options = Options { arcs: 1.0, rest: false, ..Options::default() };
    let middle = &sequence(keys, &options).at(5)[0].stroke.points;
    for (p, q) in middle.iter().zip(&bar(0.75).points) {
        assert!(p.distance(*q) < 1e-6, "{p} {q}");
    }
}

#[test]
fn given_pegs_carry_their_strokes() {
    let tree = |name: &str| {
        use crate::peg::{Peg, PegKey};
        let keys = vec![PegKey::rest(0), PegKey { turn: std::f64::consts::TAU, ..PegKey::rest(8) }];
        PegTree::new(vec![Peg { name: name.into(), parent: None, pivot: Point::ZERO, keys }]).unwrap()
    };
    let dot = circle(Point::new(20.0, 0.0), 3.0, 0.0);
    let pegs = GivenPegs { tree: tree("wheel"), of: vec![vec![Some(0)]] };
    let keys = vec![key(0, vec![dot.clone()]), key(8, vec![dot])];
    let half = &Sequence::new(keys, &[by_index(1)], &pegs, &Options::default()).unwrap().at(4)[0].stroke;
    assert!(polygon::center(&half.points).distance(Point::new(-20.0, 0.0)) < 1e-9);
}

#[test]
fn keys_are_drawn_as_they_are_and_other_frames_are_empty() {
    let (a, b) = (circle(Point::ZERO, 5.0, 0.0), circle(Point::new(9.0, 0.0), 6.0, 0.2));
    let sequence = sequence(vec![key(3, vec![a.clone()]), key(5, vec![b.clone()])], &Options::default());
    assert_eq!(sequence.at(3)[0].stroke, a);
    assert_eq!(sequence.at(5)[0].stroke, b);
    assert!(sequence.at(2).is_empty() && sequence.at(6).is_empty());
    assert_eq!(sequence.at(4).len(), 1);
}

#[test]
fn strokes_appear_and_vanish_as_the_options_say() {
    let (body, dot) = (circle(Point::new(50.0, 50.0), 30.0, 0.0), circle(Point::new(90.0, 50.0), 4.0, 0.0));
    let keys = || vec![key(0, vec![dot.clone(), body.clone()]), key(2, vec![body.clone()])];
    let at = |leaving| {
        let drawn = sequence(keys(), &Options { leaving, ..Options::default() }).at(1);
        assert_eq!(drawn.len(), 2);
        drawn[0].clone()
    };
    let grown = at(Leaving::Grow);
    assert!((grown.stroke.points[0].distance(Point::new(90.0, 50.0)) - 2.0).abs() < 0.01, "{grown:?}");
    let faded = at(Leaving::Fade);
    assert_eq!((faded.opacity, faded.stroke.points[0].round()), (0.5, dot.points[0].round()));
    let size = Point::new(100.0, 100.0);
    let gone = at(Leaving::Leave { size });
    assert!((polygon::center(&gone.stroke.points).x - 97.0).abs() < 0.01, "{gone:?}");
}

#[test]
fn charts_and_holds_set_the_progress() {
    let at = |x: f64| vec![circle(Point::new(x, 0.0), 5.0, 0.0)];
    let with = |spacing| {
        let keys = vec![Key { spacing, ..key(0, at(0.0)) }, key(4, at(100.0))];
        let sequence = sequence(keys, &Options::default());
        [1, 2, 3].map(|f| polygon::center(&sequence.at(f)[0].stroke.points).x.round())
    };
    assert_eq!(with(Spacing::Chart(vec![0.1, 0.5, 1.2])), [10.0, 50.0, 120.0]);
    assert_eq!(with(Spacing::Timing(Timing::Linear)), [25.0, 50.0, 75.0]);
    assert_eq!(with(Spacing::Timing(Timing::Constant)), [0.0, 0.0, 0.0]);
    assert_eq!(with(Spacing::Smooth), [16.0, 50.0, 84.0]);
}

#[test]
fn a_ball_that_comes_near_grows() {
    let ball = |radius: f64| vec![circle(Point::new(200.0, 200.0), radius, 0.0)];
    for radius in [20.0, 50.0, 140.0, 180.0] {
        let keys = vec![Key { spacing: Spacing::Timing(Timing::Linear), ..key(0, ball(10.0)) }, key(4, ball(radius))];
        let sequence = sequence(keys, &Options::default());
        let radius_on = |frame: i32| sequence.at(frame)[0].stroke.length() / std::f64::consts::TAU;
        let radii = [1, 2, 3].map(radius_on);
        assert!(!sequence.is_held(0), "{radius}");
        let rises = radii.windows(2).all(|pair| pair[0] + 1.0 < pair[1]);
        assert!(rises && radii[0] > 10.5 && radii[2] < radius, "{radius}: {radii:?}");
    }
}

#[test]
fn several_keys_in_a_row_join_smoothly() {
    let at = |frame: i32, x: f64, y: f64, turn: f64| key(frame, vec![circle(Point::new(x, y), 20.0, turn)]);
    let keys = vec![at(0, 0.0, 0.0, 0.0), at(100, 50.0, 10.0, 0.4), at(200, 80.0, 60.0, 1.1), at(300, 20.0, 60.0, 0.9)];
    let matchings = [by_index(1), by_index(1), by_index(1)];
    let sequence = Sequence::new(keys, &matchings, &GivenPegs::default(), &Options::default()).unwrap();
    let place = |frame: i32| sequence.at(frame)[0].stroke.points[5];
    for f in [100, 200] {
        let (before, after) = (place(f) - place(f - 1), place(f + 1) - place(f));
        assert!(before.distance(after) < 0.06, "{f}: {before} {after}");
    }
}

#[test]
fn a_stroke_that_splits_moves_as_its_pieces_do() {
    let line = |y: f64, from: usize, to: usize| (from..=to).map(|k| Point::new(k as f64 * 10.0, y)).collect::<Vec<_>>();
    let marks = |y: f64| circle(Point::new(50.0, y + 60.0), 25.0, 0.0);
    let first = vec![Stroke::new(line(0.0, 0, 10), false), marks(0.0)];
    let second = vec![Stroke::new(line(20.0, 0, 4), false), marks(20.0), Stroke::new(line(20.0, 4, 10), false)];
    for (a, b, wholes) in [(first.clone(), second.clone(), 1), (second, first, 1)] {
        let sequence = sequence(vec![key(0, a), key(2, b)], &Options::default());
        let drawn = sequence.at(1);
        assert_eq!(drawn.iter().filter(|d| d.stroke.closed).count(), wholes);
        assert_eq!(drawn.len(), 3, "{drawn:?}");
        let total: f64 = drawn.iter().filter(|d| !d.stroke.closed).map(|d| d.stroke.length()).sum();
        assert!((total - 100.0).abs() < 1.0, "{total}");
        let flat = drawn.iter().filter(|d| !d.stroke.closed).flat_map(|d| &d.stroke.points);
        assert!(flat.clone().all(|p| (p.y - 10.0).abs() < 1.0), "{drawn:?}");
    }
}

#[test]
fn unusable_input_is_reported() {
    let line = |x: f64| Stroke::new(vec![Point::ZERO, Point::new(x, 0.0)], false);
    let run = |keys: Vec<Key>, matchings: &[Matching]| {
        Sequence::new(keys, matchings, &GivenPegs::default(), &Options::default()).map(|_| ()).unwrap_err().to_string()
    };
    let two = |a: i32, b: i32| vec![key(a, vec![line(1.0)]), key(b, vec![line(2.0)])];
    assert_eq!(run(two(4, 4), &[by_index(1)]), "found a key on frame 4 after one on frame 4, expected a later frame");
    assert!(run(two(1, 4), &[]).starts_with("found 0 matchings, expected one for each of 1 spans"));
    assert!(run(two(1, 4), &[by_index(2)]).contains("found stroke 1, expected a number below 1"));
    let nan = vec![key(1, vec![line(f64::NAN)]), key(2, vec![])];
    assert!(run(nan, &[Matching::default()]).starts_with("frame 1: stroke 0: point 1 is (NaN, 0)"));
    let mut chart = two(1, 4);
    chart[0].spacing = Spacing::Chart(vec![0.5]);
    assert!(run(chart, &[by_index(1)]).contains("has 1 shares, expected one for each of 2 frames"));
    let mut chart = two(1, 3);
    chart[0].spacing = Spacing::Chart(vec![f64::INFINITY]);
    assert!(run(chart, &[by_index(1)]).contains("share 0 of the spacing chart is inf"));
    let options = Options { arcs: f64::NAN, ..Options::default() };
    let error = Sequence::new(vec![], &[], &GivenPegs::default(), &options).unwrap_err();
    assert_eq!(error.to_string(), "arcs: found NaN, expected a number from 0 to 1");
    let pegs = GivenPegs { of: vec![vec![Some(3)]], ..GivenPegs::default() };
    let error = Sequence::new(two(1, 4), &[by_index(1)], &pegs, &Options::default()).unwrap_err();
    assert_eq!(error.to_string(), "frame 1, stroke 0: found peg 3, expected a number below 0");
    assert!(Sequence::new(vec![], &[], &GivenPegs::default(), &Options::default()).unwrap().at(0).is_empty());
}

#[test]
fn many_strokes_and_many_points() {
    let strokes = |x: f64| -> Vec<Stroke> {
        let at = |k: usize| Point::new((k % 100) as f64 * 12.0 + x * (1.0 + (k % 3) as f64), (k / 100) as f64 * 12.0);
        (0..4_000)
            .map(|k| Stroke::new((0..4).map(|j| at(k) + Point::from_angle(j as f64) * 4.0).collect(), false))
            .collect()
    };
    let keys = vec![key(0, strokes(0.0)), key(2, strokes(3.0))];
    let many = Sequence::new(keys, &[by_index(4_000)], &GivenPegs::default(), &Options::default()).unwrap();
    assert_eq!(many.at(1).len(), 4_000);
    let long = |turn: f64, radius: f64| {
        let points = (0..100_000).map(|k| Point::from_angle(turn + k as f64 * 6e-5) * (radius + (k % 7) as f64 * 0.01));
        Stroke::new(points.collect(), false)
    };
    let keys = vec![key(0, vec![long(0.0, 90.0), long(0.0, 90.2)]), key(2, vec![long(0.4, 90.0), long(0.4, 90.2)])];
    let drawn = sequence(keys, &Options::default()).at(1);
    assert!(drawn[0].stroke.points.iter().all(|p| (p.length() - 90.0).abs() < 1.0));
}

#[test]
fn the_number_of_threads_does_not_change_the_result() {
    let strokes = |turn: f64| {
        (0..40)
            .map(|k| circle(Point::from_angle(k as f64 + turn) * (k as f64 * 5.0), 4.0 + turn, k as f64 + turn))
            .collect()
    };
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sequence(vec![key(0, strokes(0.0)), key(6, strokes(0.3))], &Options::default()).at(2))
    };
    assert_eq!(run(1), run(4));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn any_strokes_give_finite_in_betweens(
        sizes in prop::collection::vec((0usize..6, 0usize..6, 0usize..6, any::<bool>()), 0..6),
        values in prop::collection::vec((-20.0f64..20.0, -20.0f64..20.0), 110),
        leaving in 0usize..3,
    ) {
        let mut values = values.into_iter().map(Point::from);
        let leaving = [Leaving::Grow, Leaving::Fade, Leaving::Leave { size: Point::new(30.0, 30.0) }][leaving];
        let mut drawing = |which: usize| -> Vec<Stroke> {
            let count = |s: &(usize, usize, usize, bool)| [s.0, s.1, s.2][which];
            sizes.iter().map(|s| Stroke::new(values.by_ref().take(count(s)).collect(), s.3)).collect()
        };
        let keys = (0..3).map(|k| key(k * 4, drawing(k as usize))).collect();
        let sequence = sequence(keys, &Options { leaving, ..Options::default() });
        for frame in 0..=8 {
            for drawn in sequence.at(frame) {
                prop_assert!(drawn.stroke.points.iter().all(|p| p.is_finite()));
                prop_assert!((0.0..=1.0).contains(&drawn.opacity));
            }
        }
    }
}

/// A line in one go, and the same line in three pieces drawn in different directions.
fn whole_and_pieces() -> (Stroke, Vec<Stroke>) {
    let line = |from: i32, to: i32| {
        let step = if to > from { 1 } else { -1 };
        let at = |k: i32| f64::from(from + step * k);
        Stroke::new((0..=(to - from).abs()).map(|k| Point::new(at(k), (at(k) / 9.0).sin() * 20.0)).collect(), false)
    };
    (line(0, 90), vec![line(30, 0), line(30, 70), line(90, 70)])
}

#[test]
fn pieces_stay_where_nothing_moves() {
    let (whole, pieces) = whole_and_pieces();
    let inside = matching::InPieces { whole: 0, pieces: vec![(0, true), (1, false), (2, true)] };
    let split = Matching { split: vec![inside.clone()], ..Matching::default() };
    let joined = Matching { joined: vec![inside], ..Matching::default() };
    let pieces_key = |frame| key(frame, pieces.clone());
    let whole_key = |frame| key(frame, vec![whole.clone()]);
    let keys = vec![pieces_key(0), whole_key(4), pieces_key(8)];
    let through = [joined.clone(), split.clone()];
    let given = GivenPegs::default();
    let long = Sequence::new(keys, &through, &given, &Options::default()).unwrap();
    let back = vec![whole_key(0), pieces_key(4), pieces_key(8)];
    let around = Sequence::of_span(back, &[split, by_index(3)], &given, &Options::default(), 1).unwrap();
    for (sequence, frame) in [(&long, 2), (&long, 6), (&around, 6)] {
        let drawn = sequence.at(frame);
        assert_eq!(drawn.len(), 3);
        for (between, piece) in drawn.iter().zip(&pieces) {
            for (p, q) in between.stroke.points.iter().zip(&piece.points) {
                assert!(p.distance(*q) < 0.7, "frame {frame}: {p} {q}");
            }
        }
    }
    // The places on the complete stroke are shares of its length.
    let stand = long.tracks()[2].at(1).unwrap();
    let (low, high) = (stand.places.shares[20], stand.places.shares[0]);
    assert!((low - 7.0 / 9.0).abs() < 0.03 && (high - 1.0).abs() < 1e-9, "{low} {high}");
}

#[test]
fn a_held_key_is_drawn_by_its_own_strokes() {
    let (whole, pieces) = whole_and_pieces();
    let inside = matching::InPieces { whole: 0, pieces: vec![(0, true), (1, false), (2, true)] };
    let split = Matching { split: vec![inside.clone()], ..Matching::default() };
    let joined = Matching { joined: vec![inside], ..Matching::default() };
    let other = Stroke::new(vec![Point::new(0.0, 70.0), Point::new(90.0, 75.0)], false);
    let mut first = pieces.clone();
    first.push(other);
    // The last stroke of the first key vanishes, and the whole line of the second one falls into pieces.
    let keys = vec![key(0, first.clone()), key(4, vec![whole.clone()]), key(8, pieces)];
    let mut held = Sequence::new(keys, &[joined, split], &GivenPegs::default(), &Options::default()).unwrap();
    held.ways = vec![Way::Held; 2];
    for (frame, own) in [(2, &first), (6, &vec![whole])] {
        let drawn = held.at(frame);
        let strokes: Vec<&Stroke> = drawn.iter().map(|d| &d.stroke).collect();
        assert_eq!(strokes, own.iter().collect::<Vec<_>>(), "frame {frame}");
        assert!(drawn.iter().all(|d| d.opacity == 1.0));
        assert_eq!(drawn.iter().map(|d| d.track).collect::<Vec<_>>(), held.present(usize::from(frame > 4)));
    }
}

#[test]
fn an_outline_cut_in_other_places_is_drawn_once_and_whole() {
    let ring = |shift: f64, from: i32, to: i32| {
        let at = |k: i32| std::f64::consts::TAU * f64::from(k) / 120.0;
        let place = |t: f64| Point::new(60.0 * t.cos() + shift, 40.0 * t.sin() + 8.0 * (2.0 * t).sin());
        Stroke::new((from..=to).map(|k| place(at(k))).collect(), false)
    };
    let keys = vec![
        key(0, vec![ring(0.0, 0, 39), ring(0.0, 40, 79), ring(0.0, 80, 119)]),
        key(8, vec![ring(30.0, 20, 69), ring(30.0, 70, 139)]),
    ];
    let options = Options { rest: false, ..Options::default() };
    let drawn = sequence(keys, &options).at(4);
    let whole = ring(15.0, 0, 120).points;
    let ink = |points: &[Point], p: Point| points.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min);
    let all: Vec<Point> = drawn.iter().flat_map(|d| d.stroke.points.clone()).collect();
    assert!(drawn.iter().all(|d| d.opacity == 1.0 && d.stroke.points.len() > 1));
    for (from, to) in [(&all, &whole), (&whole, &all)] {
        let farthest = from.iter().map(|p| ink(to, *p)).fold(0.0, f64::max);
        assert!(farthest < 3.5, "{farthest}");
    }
    let length: f64 = drawn.iter().map(|d| d.stroke.length()).sum();
    assert!((length / ring(0.0, 0, 120).length() - 1.0).abs() < 0.05, "{length}");
}

#[test]
fn a_span_alone_follows_its_own_points() {
    let at = |frame: i32, count: usize| {
        let turn = f64::from(frame) * 0.1;
        let place = |k: usize| Point::from_angle(turn) * (100.0 * k as f64 / (count - 1) as f64);
        key(frame, vec![Stroke::new((0..count).map(place).collect(), false)])
    };
    let keys = vec![at(0, 5), at(6, 21), at(12, 9), at(18, 30)];
    let found = vec![by_index(1); 3];
    let given = GivenPegs::default();
    let all = Sequence::new(keys.clone(), &found, &given, &Options::default()).unwrap();
    for (base, count) in [(0, 5), (1, 21), (2, 9)] {
        let one = Sequence::of_span(keys.clone(), &found, &given, &Options::default(), base).unwrap();
        let frame = keys[base].frame + 2;
        let (points, line) = (&one.at(frame)[0].stroke.points, &all.at(frame)[0].stroke.points);
        assert_eq!(points.len(), count);
        assert_eq!(one.present(base), [0]);
        for (p, q) in [(points[0], line[0]), (points[count - 1], line[4])] {
            assert!(p.distance(q) < 0.5, "{base}: {p} {q}");
        }
        let blends = one.tracks()[0].at(base + 1).unwrap().places.blends(&keys[base + 1].strokes[0]);
        assert_eq!(
            (blends.len(), blends[0], blends[count - 1].1),
            (count, (0, 1, 0.0), keys[base + 1].strokes[0].points.len() - 1)
        );
    }
}

#[test]
fn closed_strokes_are_followed_back_from_any_start() {
    let centre = Point::new(5.0, 5.0);
    let blob = |count: usize, start: f64, backwards: bool| {
        let at = |k: usize| {
            let t = std::f64::consts::TAU * (start + k as f64 / count as f64 * if backwards { -1.0 } else { 1.0 });
            centre + Point::from_angle(t) * (40.0 + 9.0 * (2.0 * t).cos() + 5.0 * (3.0 * t).sin())
        };
        Stroke::new((0..count).map(at).collect(), true)
    };
    for backwards in [false, true] {
        let keys = vec![
            key(0, vec![blob(150, 0.3, backwards)]),
            key(5, vec![blob(100, 0.0, false)]),
            key(9, vec![blob(90, 0.6, false)]),
        ];
        let found: Vec<Matching> = keys
            .windows(2)
            .map(|k| match_strokes(&k[0].strokes, &k[1].strokes, &[], &matching::Options::default(), &Silent).unwrap())
            .collect();
        let one = Sequence::of_span(keys, &found, &GivenPegs::default(), &Options::default(), 1).unwrap();
        let track = &one.tracks()[0];
        assert_eq!((track.first, track.last()), (0, 2));
        for (p, q) in track.at(0).unwrap().places.points.iter().zip(&track.at(1).unwrap().places.points) {
            assert!(p.distance(*q) < 2.0, "{backwards}: {p} {q}");
        }
    }
}

#[test]
fn a_mouth_goes_round_with_its_head_though_it_is_drawn_a_little_farther_round() {
    let centre = Point::new(200.0, 200.0);
    let head = |turn: f64| {
        let spoke = |k: u32| {
            let way = Point::from_angle(turn + 0.9 * f64::from(k)) * (1.0 + 0.1 * f64::from(k));
            Stroke::new((0..12).map(|i| centre + way * (20.0 + 3.0 * f64::from(i))).collect(), false)
        };
        (0..7).map(spoke).collect::<Vec<Stroke>>()
    };
    // A mouth of its own turn: it is no part of the rigid head.
    let mouth = |turn: f64, own: f64| {
        let middle = centre + Point::from_angle(turn + 1.2).rotate(Point::new(0.0, 30.0));
        let at = |i: i32| Point::new(f64::from(i) - 6.0, 0.15 * f64::from(i * i));
        Stroke::new((0..13).map(|i| middle + Point::from_angle(own).rotate(at(i))).collect(), false)
    };
    let drawn = |turn: f64, own: f64| [head(turn), vec![mouth(turn, own)]].concat();
    let turn = 170f64.to_radians();
    let keys = vec![key(0, drawn(0.0, 0.0)), key(8, drawn(turn, turn + 0.4))];
    let options = Options { arcs: 1.0, ..Options::default() };
    let moving = Sequence::new(keys, &[by_index(8)], &GivenPegs::default(), &options).unwrap();
    for frame in 1..8 {
        let middle = polygon::center(&moving.at(frame)[7].stroke.points);
        let away = middle.distance(centre);
        assert!((away - 30.0).abs() < 6.0, "frame {frame}: {away} px from the head's middle");
    }
}

#[test]
fn strokes_that_a_person_left_without_counterpart_vanish_and_appear_as_asked() {
    let ring = |high: f64| {
        let at = |k: i32| Point::new(60.0, 50.0) + Point::from_angle(0.2 * f64::from(k)) * Point::new(50.0, high);
        Stroke::new((0..31).map(at).collect(), true)
    };
    let line = |from: (f64, f64), to: (f64, f64)| {
        Stroke::new((0..=8).map(|k| Point::from(from).lerp(to.into(), f64::from(k) / 8.0)).collect(), false)
    };
    let first = vec![ring(40.0), line((20.0, 60.0), (100.0, 60.0)), line((25.0, 30.0), (95.0, 35.0))];
    let second = vec![line((30.0, 50.0), (90.0, 50.0)), ring(12.0)];
    let by_hand = [Some(1), None, None].into_iter().enumerate();
    let by_hand: Vec<_> = by_hand.map(|(from, to)| matching::HandPair { from, to }).collect();
    let found = match_strokes(&first, &second, &by_hand, &matching::Options::default(), &Silent).unwrap();
    assert_eq!(found.alone, [vec![1, 2], vec![0]]);
    let spacing = Spacing::Timing(Timing::Linear);
    let keys =
        [(0, first), (8, second)].map(|(frame, strokes)| Key { spacing: spacing.clone(), ..key(frame, strokes) });
    let options = Options { leaving: Leaving::Fade, ..Options::default() };
    let sequence = Sequence::new(keys.into(), &[found], &GivenPegs::default(), &options).unwrap();
    assert_eq!((sequence.is_held(0), sequence.exchanged_strokes(0)), (false, 0), "nothing is in doubt");
    let mut opacities: Vec<_> = sequence.at(2).iter().map(|drawn| (drawn.track, drawn.opacity)).collect();
    opacities.sort_by_key(|drawn| drawn.0);
    assert_eq!(opacities, [(0, 1.0), (1, 0.75), (2, 0.75), (3, 0.25)]);
}
