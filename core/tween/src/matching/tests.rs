use super::*;
use proptest::prelude::*;
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::Silent;

fn run(a: &[Stroke], b: &[Stroke]) -> Matching {
    match_strokes(a, b, &[], &Options::default(), &Silent).unwrap()
}

fn arc(centre: (f64, f64), radius: f64, from: f64, to: f64, count: usize) -> Vec<Point> {
    let at = |k: usize| from + (to - from) * k as f64 / (count - 1) as f64;
    (0..count).map(|k| Point::from(centre) + Point::from_angle(at(k)) * radius).collect()
}

/// A figure of a body, a head, two equal arms and two equal legs of two bones each.
fn figure(shift: Point, turn: f64, arms: f64, legs: f64) -> Vec<Stroke> {
    let mut strokes = vec![
        Stroke::new(
            vec![(-30.0, -50.0), (30.0, -50.0), (25.0, 50.0), (-25.0, 50.0)].into_iter().map(Point::from).collect(),
            true,
        ),
        Stroke::new(arc((0.0, -80.0), 28.0, 0.0, 6.0, 20), true),
    ];
    let bone = |from: Point, angle: f64| {
        let to = from + Point::from_angle(angle) * 40.0;
        let bulge = from.lerp(to, 0.5) + Point::from_angle(angle + 1.57) * 8.0;
        (Stroke::new(polyline::resample(&[from, bulge, to], false, 9), false), to)
    };
    for (x, y, angle) in
        [(-30.0, -45.0, 2.4 + arms), (30.0, -45.0, 0.7 - arms), (-15.0, 50.0, 1.8 + legs), (15.0, 50.0, 1.3 - legs)]
    {
        let (upper, joint) = bone(Point::new(x, y), angle);
        let (lower, _) = bone(joint, angle + 0.4);
        strokes.extend([upper, lower]);
    }
    let turned = Point::from_angle(turn);
    for p in strokes.iter_mut().flat_map(|s| &mut s.points) {
        *p = turned.rotate(*p) + shift;
    }
    strokes
}

/// The strokes of a drawing in another order, with other directions, starts and numbers of points. `order[k]` is the
/// old index of stroke `k`.
fn redrawn(strokes: &[Stroke], order: &[usize]) -> Vec<Stroke> {
    let again = |(k, &i): (usize, &usize)| {
        let mut points = polyline::resample(&strokes[i].points, strokes[i].closed, 17 + 5 * (k % 4));
        if k % 2 == 0 {
            points.reverse();
        }
        if strokes[i].closed {
            points.rotate_left(k % 11);
        }
        Stroke { points, ..strokes[i].clone() }
    };
    order.iter().enumerate().map(again).collect()
}

#[test]
fn a_figure_that_moved_and_bent_is_found_again() {
    let first = figure(Point::new(200.0, 200.0), 0.0, 0.0, 0.0);
    let second = figure(Point::new(330.0, 180.0), 0.5, 0.5, -0.4);
    let order = [7, 3, 9, 0, 5, 1, 8, 2, 4, 6];
    let found = run(&first, &redrawn(&second, &order));
    assert!(found.vanished.is_empty() && found.appeared.is_empty(), "{found:?}");
    for pair in &found.pairs {
        assert_eq!(order[pair.to], pair.from, "{found:?}");
        assert_eq!(pair.reversed, pair.to % 2 == 0, "{pair:?}");
    }
}

#[test]
fn the_start_of_a_closed_curve_is_found() {
    let points: Vec<Point> = [(0.0, 0.0), (60.0, 0.0), (60.0, 20.0), (10.0, 40.0)].map(Point::from).into();
    let a = polyline::resample(&points, true, 64);
    for reversed in [false, true] {
        let mut b = a.clone();
        b.rotate_left(16);
        if reversed {
            b.reverse();
        }
        let pair = run(&[Stroke::new(a.clone(), true)], &[Stroke::new(b.clone(), true)]).pairs[0];
        assert_eq!(pair.reversed, reversed);
        let at = (pair.start * 64.0).round() as usize % 64;
        assert!(b[at].distance(a[0]) < 8.0, "{pair:?}");
    }
}

#[test]
fn hand_made_pairs_are_kept_and_lead_the_others() {
    // Two equal dots are side by side, each with an equal line. Without a hint they stay; with a hint they cross.
    let line = |x: f64| Stroke::new(vec![Point::new(x, 0.0), Point::new(x, 30.0)], false);
    let dot = |x: f64| Stroke::new(arc((x, 36.0), 5.0, 0.0, 6.0, 12), true);
    let frame = Stroke::new(arc((20.0, 20.0), 150.0, 0.0, 6.0, 60), true);
    let strokes = [line(0.0), line(40.0), dot(0.0), dot(40.0), frame];
    let to = |m: &Matching| m.pairs.iter().map(|p| p.to).collect::<Vec<_>>();
    assert_eq!(to(&run(&strokes, &strokes)), [0, 1, 2, 3, 4]);
    let hands = [HandPair { from: 0, to: Some(1) }, HandPair { from: 1, to: Some(0) }];
    let found = match_strokes(&strokes, &strokes, &hands, &Options::default(), &Silent).unwrap();
    assert_eq!(to(&found), [1, 0, 3, 2, 4]);
    assert!(found.pairs[0].by_hand && found.pairs[0].confidence == 1.0 && !found.pairs[2].by_hand);
    let alone = [HandPair { from: 3, to: None }];
    let found = match_strokes(&strokes, &strokes, &alone, &Options::default(), &Silent).unwrap();
    assert_eq!((found.vanished, found.appeared), (vec![3], vec![3]));
}

#[test]
fn wrong_hand_made_pairs_are_named() {
    let strokes = [Stroke::new(vec![Point::ZERO, Point::X], false)];
    let said = |hands: &[HandPair]| {
        match_strokes(&strokes, &strokes, hands, &Options::default(), &Silent).unwrap_err().to_string()
    };
    let pair = |from, to| HandPair { from, to };
    assert_eq!(said(&[pair(2, None)]), "pair 0: found stroke 2 of the first drawing, expected a number below 1");
    assert_eq!(said(&[pair(0, Some(4))]), "pair 0: found stroke 4 of the second drawing, expected a number below 1");
    assert_eq!(
        said(&[pair(0, Some(0)), pair(0, None)]),
        "pair 1: stroke 0 of the first drawing has a pair made by hand already"
    );
}

#[test]
fn colour_and_layer_tell_equal_strokes_apart() {
    let line = |x: f64, layer| Stroke {
        layer: Some(layer),
        ..Stroke::new(vec![Point::new(x, 0.0), Point::new(x + 5.0, 30.0)], false)
    };
    let found = run(&[line(0.0, 1), line(10.0, 2)], &[line(0.0, 2), line(10.0, 1)]);
    assert_eq!(found.pairs.iter().map(|p| p.to).collect::<Vec<_>>(), [1, 0]);
}

#[test]
fn pieces_with_gaps_between_them_are_put_together() {
    // A brow of 40 points of which the second drawing lacks 5, and a mouth in three pieces.
    let brow = |count: std::ops::Range<usize>| {
        let all = arc((-35.0, -88.0), 22.0, 3.6, 5.6, 40);
        Stroke::new(all[count].to_vec(), false)
    };
    let mouth = |part: std::ops::Range<usize>| Stroke::new(arc((0.0, -78.0), 16.0, 0.3, 2.8, 30)[part].to_vec(), false);
    let (mut a, mut b) = (figure(Point::ZERO, 0.0, 0.0, 0.0), figure(Point::new(14.0, 5.0), 0.0, 0.2, -0.1));
    let first = a.len();
    a.extend([brow(0..40), mouth(0..30)]);
    let shifted = |mut stroke: Stroke| {
        stroke.points.iter_mut().for_each(|p| *p += Point::new(14.0, 5.0));
        stroke
    };
    b.extend([brow(0..18), brow(23..40), mouth(0..8), mouth(11..20), mouth(23..30)].map(shifted));
    let found = run(&a, &b);
    let split: Vec<(usize, usize)> = found.split.iter().map(|s| (s.whole, s.pieces.len())).collect();
    assert_eq!(split, [(first, 2), (first + 1, 3)], "{found:?}");
    assert_eq!((found.pairs.len(), found.vanished.len(), found.appeared.len()), (first, 0, 0), "{found:?}");
    let back = run(&b, &a);
    let joined: Vec<(usize, usize)> = back.joined.iter().map(|s| (s.whole, s.pieces.len())).collect();
    assert_eq!(joined, [(first, 2), (first + 1, 3)], "{back:?}");
}

#[test]
fn a_stroke_drawn_in_pieces_is_put_together() {
    let whole = |shift: f64| arc((shift, 0.0), 60.0, 0.2, 3.0, 57);
    let other = Stroke::new(arc((0.0, 90.0), 25.0, 0.0, 6.0, 30), true);
    let first = [Stroke::new(whole(0.0), false), other.clone()];
    let (a, b) = (whole(12.0)[..25].to_vec(), whole(12.0)[25..].to_vec());
    let b = b.into_iter().rev().collect();
    let second = [Stroke::new(b, false), other, Stroke::new(a, false)];
    let found = run(&first, &second);
    assert_eq!(found.split, [InPieces { whole: 0, pieces: vec![(2, false), (0, true)] }], "{found:?}");
    assert!(found.appeared.is_empty() && found.vanished.is_empty());
    let back = run(&second, &first);
    assert_eq!(back.joined, [InPieces { whole: 0, pieces: vec![(2, false), (0, true)] }], "{back:?}");
    assert!(back.split.is_empty() && back.vanished.is_empty() && back.appeared.is_empty());
}

/// A figure of closed lines that are cut into pieces in other places on each drawing: each by the shares of its length
/// at which it is cut.
fn cut(lines: &[Vec<Point>], cuts: &[&[f64]]) -> Vec<Stroke> {
    let pieces = |(line, cuts): (&Vec<Point>, &&[f64])| -> Vec<Stroke> {
        let n = line.len();
        let at = |share: f64| (share * n as f64) as usize;
        let piece = |k: usize| {
            let (from, to) = (at(cuts[k]), at(if k + 1 < cuts.len() { cuts[k + 1] } else { cuts[0] + 1.0 }));
            // Two points are missing at each cut.
            let mut points: Vec<Point> = (from..to - 2).map(|i| line[i % n]).collect();
            if k % 2 == 1 {
                points.reverse();
            }
            Stroke::new(points, false)
        };
        (0..cuts.len()).map(piece).collect()
    };
    lines.iter().zip(cuts).flat_map(pieces).collect()
}

/// The outlines of a body, a head and two different limbs.
fn outlines(shift: Point, turn: f64) -> Vec<Vec<Point>> {
    let around = |centre: (f64, f64), radii: (f64, f64), bump: f64| -> Vec<Point> {
        let at = |k: usize| std::f64::consts::TAU * k as f64 / 120.0;
        let place = |t: f64| {
            let r = 1.0 + bump * (2.0 * t + 0.6).cos() + 0.5 * bump * (3.0 * t).sin();
            Point::from(centre) + Point::new(radii.0 * t.cos(), radii.1 * t.sin()) * r
        };
        (0..120).map(|k| Point::from_angle(turn).rotate(place(at(k))) + shift).collect()
    };
    vec![
        around((0.0, 0.0), (40.0, 60.0), 0.2),
        around((0.0, -110.0), (30.0, 30.0), 0.1),
        around((-90.0, -10.0), (35.0, 12.0), 0.15),
        around((100.0, 10.0), (14.0, 55.0), 0.25),
    ]
}

#[test]
fn lines_cut_in_other_places_are_put_together_on_both_drawings() {
    let first = cut(&outlines(Point::ZERO, 0.0), &[&[0.1, 0.4, 0.8], &[0.3, 0.7], &[0.0, 0.2, 0.6], &[0.5, 0.9]]);
    let second =
        cut(&outlines(Point::new(30.0, 8.0), 0.25), &[&[0.2, 0.6], &[0.05, 0.35, 0.65], &[0.4, 0.8], &[0.0, 0.4, 0.7]]);
    let found = run(&first, &second);
    let pieces = |chain: &Chain| {
        let mut numbers: Vec<usize> = chain.pieces.iter().map(|piece| piece.0).collect();
        numbers.sort_unstable();
        numbers
    };
    let mut lines: Vec<_> = found.chained.iter().map(|line| (pieces(&line.first), pieces(&line.second))).collect();
    lines.sort();
    let expected = [
        (vec![0, 1, 2], vec![0, 1]),
        (vec![3, 4], vec![2, 3, 4]),
        (vec![5, 6, 7], vec![5, 6]),
        (vec![8, 9], vec![7, 8, 9]),
    ];
    assert_eq!(lines, expected, "{found:?}");
    assert!(found.pairs.is_empty() && found.vanished.is_empty() && found.appeared.is_empty());
    let all = found.chained.iter().all(|line| line.first.closed && line.second.closed && line.confidence > 0.5);
    assert!(all && found.sureness(&first, &second) > 0.8, "{found:?}");
    // Neighbouring meetings share a piece, so that all pieces of a line are known as one.
    for line in &found.chained {
        assert!(line.meetings.windows(2).all(|m| m[0].0 == m[1].0 || m[0].1 == m[1].1), "{:?}", line.meetings);
    }
}

#[test]
fn a_closed_stroke_in_pieces_begins_where_its_first_piece_does() {
    let whole = vec![Stroke::new(outlines(Point::ZERO, 0.0)[0].clone(), true)];
    let pieces = cut(&outlines(Point::new(5.0, 0.0), 0.0)[..1], &[&[0.35, 0.7]]);
    let found = run(&whole, &pieces);
    assert_eq!(found.chained.len(), 1, "{found:?}");
    let line = &found.chained[0];
    assert!(!line.reversed && (line.start - 0.65).abs() < 0.03, "{line:?}");
}

#[test]
fn bad_strokes_are_named_or_left_alone() {
    let p = Point::new;
    let nan = [Stroke::new(vec![p(0.0, 0.0), p(f64::NAN, 1.0)], false)];
    let error = match_strokes(&[], &nan, &[], &Options::default(), &Silent).unwrap_err();
    assert_eq!(
        error.to_string(),
        "second drawing: stroke 0: point 1 is (NaN, 1), expected numbers between -1e9 and 1e9"
    );
    assert_eq!(run(&[], &[]), Matching::default());
    let odd = [
        Stroke::new(vec![], true),
        Stroke::new(vec![p(3.0, 3.0)], false),
        Stroke::new(vec![p(50.0, 3.0); 5], true),
        Stroke::new(vec![p(0.0, 50.0), p(9.0, 50.0)], false),
        Stroke::new([(0.0, 0.0), (9.0, 9.0), (9.0, 0.0), (0.0, 9.0)].map(|(x, y)| p(80.0 + x, y)).into(), true),
    ];
    let found = run(&odd, &odd);
    assert_eq!(found.pairs.iter().map(|p| (p.from, p.to)).collect::<Vec<_>>(), [(1, 1), (2, 2), (3, 3), (4, 4)]);
    assert_eq!((found.vanished, found.appeared), (vec![0], vec![0]));
    assert_eq!(run(&odd, &[]).vanished, [0, 1, 2, 3, 4]);
}

#[test]
fn ten_thousand_strokes_are_matched() {
    let strokes: Vec<Stroke> = (0..10_000)
        .map(|k| {
            let (x, y) = ((k % 100) as f64 * 20.0, (k / 100) as f64 * 20.0);
            let turn = (k * k % 97) as f64;
            Stroke::new(arc((x, y), 6.0 + (k % 7) as f64, turn, turn + 1.0 + (k % 5) as f64, 9), false)
        })
        .collect();
    let moved: Vec<Stroke> = strokes
        .iter()
        .rev()
        .map(|s| Stroke::new(s.points.iter().map(|&p| p * 1.05 + Point::new(30.0, -7.0)).collect(), false))
        .collect();
    let found = run(&strokes, &moved);
    let right = found.pairs.iter().filter(|p| p.to == 9_999 - p.from).count();
    assert!(right > 9_900, "{right}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn every_stroke_has_one_place_in_the_matching(
        sizes in prop::collection::vec((0usize..6, 0usize..6, any::<bool>()), 0..9),
        values in prop::collection::vec((-20.0f64..20.0, -20.0f64..20.0), 110),
    ) {
        let mut values = values.into_iter().map(Point::from);
        let mut drawing = |second: bool| -> Vec<Stroke> {
            let count = |s: &(usize, usize, bool)| if second { s.1 } else { s.0 };
            sizes.iter().map(|s| Stroke::new(values.by_ref().take(count(s)).collect(), s.2)).collect()
        };
        let (a, b) = (drawing(false), drawing(true));
        let found = run(&a, &b);
        let [mut from, mut to] = found.named();
        from.extend(&found.vanished);
        to.extend(&found.appeared);
        for (named, strokes) in [(&mut from, &a), (&mut to, &b)] {
            named.sort_unstable();
            prop_assert_eq!(&named[..], &(0..strokes.len()).collect::<Vec<_>>()[..]);
        }
        prop_assert!((0.0..=1.0).contains(&found.sureness(&a, &b)));
        prop_assert!(found.pairs.iter().all(|p| (0.0..=1.0).contains(&p.confidence)));
    }
}

fn ellipse(centre: (f64, f64), radii: (f64, f64), count: usize) -> Stroke {
    let at = |k: usize| Point::from_angle(std::f64::consts::TAU * k as f64 / count as f64);
    let place = |k| Point::from(centre) + at(k) * Point::from(radii);
    Stroke::new((0..count).map(place).collect(), true)
}

/// The turn by which a closed stroke is laid on its counterpart, from the start of the pair.
fn turn_of(a: &Stroke, b: &Stroke, pair: &Pair) -> f64 {
    let (from, to) = (super::super::line::Line::new(a), super::super::line::Line::new(b));
    let sign = if pair.reversed { -1.0 } else { 1.0 };
    let ways = (0..32).map(|k| f64::from(k) / 32.0);
    let along: Vec<_> = ways.map(|s| (from.at(s), to.at((pair.start + sign * s).rem_euclid(1.0)))).collect();
    let centre = |pick: fn(&(Point, Point)) -> Point| along.iter().map(pick).sum::<Point>() / 32.0;
    let (p, q) = (centre(|two| two.0), centre(|two| two.1));
    along
        .iter()
        .map(|two| Point::new((two.0 - p).dot(two.1 - q), (two.0 - p).perp_dot(two.1 - q)))
        .sum::<Point>()
        .to_angle()
}

#[test]
fn a_shadow_does_not_turn_over_when_the_feet_above_it_change_places() {
    let foot = |x: f64| {
        let sole = [(-14.0, 0.0), (16.0, 0.0), (18.0, -7.0), (2.0, -12.0), (-12.0, -10.0)];
        Stroke::new(sole.map(|p| Point::from(p) + Point::new(x, 96.0)).into(), true)
    };
    let leg = |x: f64, hip: f64| {
        Stroke::new(vec![Point::new(hip, 40.0), Point::new(0.5 * (x + hip), 70.0), Point::new(x, 86.0)], false)
    };
    let walker = |left: f64, right: f64, width: f64| {
        vec![ellipse((0.0, 100.0), (width, 6.0), 21), foot(left), foot(right), leg(left, -4.0), leg(right, 4.0)]
    };
    let (a, b) = (walker(-60.0, 55.0, 90.0), walker(40.0, -45.0, 42.0));
    let by_hand: Vec<HandPair> = (0..5).map(|k| HandPair { from: k, to: Some(k) }).collect();
    let found = match_strokes(&a, &b, &by_hand, &Options::default(), &Silent).unwrap();
    let turn = turn_of(&a[0], &b[0], &found.pairs[0]);
    assert!(turn.abs() < 0.3, "{turn}");
}

#[test]
fn limbs_that_look_the_same_after_half_a_turn_turn_with_their_arm() {
    // A doll with an arm of three ellipses, which swings by 140°.
    let doll = |swing: f64| {
        let mut strokes = vec![
            Stroke::new([(-30.0, -60.0), (34.0, -52.0), (25.0, 60.0), (-25.0, 55.0)].map(Point::from).into(), true),
            Stroke::new(arc((0.0, -90.0), 26.0, 0.0, 5.6, 20), true),
        ];
        let along = Point::from_angle(swing);
        for k in 0..3 {
            let centre = Point::new(34.0, -45.0) + along * (22.0 + 44.0 * f64::from(k));
            let mut part = ellipse((0.0, 0.0), (24.0, 8.0), 20);
            part.points.iter_mut().for_each(|p| *p = along.rotate(*p) + centre);
            strokes.push(part);
        }
        strokes
    };
    let (a, b) = (doll(1.4), doll(1.4 - 2.44));
    let by_hand: Vec<HandPair> = (0..5).map(|k| HandPair { from: k, to: Some(k) }).collect();
    let found = match_strokes(&a, &b, &by_hand, &Options::default(), &Silent).unwrap();
    let turns: Vec<f64> = found.pairs[2..].iter().map(|pair| turn_of(&a[pair.from], &b[pair.to], pair)).collect();
    assert!(turns.iter().all(|turn| (turn + 2.44).abs() < 0.2), "{turns:?}");
}
