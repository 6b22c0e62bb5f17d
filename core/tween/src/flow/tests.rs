use super::field::Field;
use super::partners::Pair;
use super::*;
use proptest::prelude::*;
use rototoon_base::geometry::polyline;
use rototoon_base::geometry::similarity::Similarity;

/// The lines of a figure of 200 px: head, body and two arms. One arm is raised by an angle.
pub(crate) fn figure(raised: f64) -> Vec<(Vec<Point>, bool)> {
    let ellipse = |center: Point, radii: Point| -> Vec<Point> {
        (0..60).map(|k| center + radii * Point::from_angle(f64::from(k) * std::f64::consts::TAU / 60.0)).collect()
    };
    let arm = |shoulder: Point, angle: f64| -> Vec<Point> {
        let turn = Point::from_angle(angle);
        let outline = [(0.0, -6.0), (60.0, -4.0), (66.0, 0.0), (60.0, 4.0), (0.0, 6.0)];
        polyline::resample(&outline.map(|(x, y)| shoulder + turn.rotate(Point::new(x, y))), false, 40)
    };
    vec![
        (ellipse(Point::new(0.0, -70.0), Point::new(26.0, 30.0)), true),
        (ellipse(Point::new(0.0, 20.0), Point::new(34.0, 60.0)), true),
        (arm(Point::new(32.0, -10.0), 0.4 - raised), false),
        (arm(Point::new(-32.0, -10.0), 2.7), false),
    ]
}

/// The lines as strokes: moved, and cut into pieces of about a length, every other one reversed.
pub(crate) fn cut(lines: &[(Vec<Point>, bool)], length: f64, by: &Similarity) -> Vec<Stroke> {
    let pieces = |(points, closed): &(Vec<Point>, bool)| {
        let step = 2.0;
        let count = (polyline::length(points, *closed) / step) as usize;
        let mut dense: Vec<Point> =
            polyline::resample(points, *closed, count).into_iter().map(|p| by.apply(p)).collect();
        dense.rotate_left(if *closed { (length as usize) % count } else { 0 });
        let piece = |(k, points): (usize, &[Point])| {
            let mut points = points.to_vec();
            if k % 2 == 1 {
                points.reverse();
            }
            Stroke::new(points, false)
        };
        dense
            .chunks((length / step) as usize)
            .filter(|piece| piece.len() > 1)
            .enumerate()
            .map(piece)
            .collect::<Vec<_>>()
    };
    lines.iter().flat_map(pieces).collect()
}

pub(crate) fn moved(turn: f64, shift: Point) -> Similarity {
    Similarity { factor: Point::from_angle(turn), source: Point::ZERO, target: shift }
}

#[test]
fn ink_that_is_cut_anew_meets_wherever_it_is_cut() {
    let by = moved(0.25, Point::new(70.0, -20.0));
    let first = cut(&figure(0.0), 47.0, &Similarity::IDENTITY);
    let second = cut(&figure(0.0), 31.0, &by);
    let flow = Flow::find(&first, &second, &[]).unwrap();
    assert!(flow.meets > 0.95, "{}", flow.meets);
    let points: Vec<Point> = first.iter().flat_map(|s| s.points.clone()).collect();
    let half = moved(0.125, Point::new(35.0, -10.0));
    for (share, truth) in [(1.0, by), (0.5, half)] {
        let off = |(p, q): (&Point, &Point)| truth.apply(*p).distance(*q);
        let mean = points.iter().zip(&flow.ahead(&points, share)).map(off).sum::<f64>() / points.len() as f64;
        assert!(mean < 2.0, "at {share} the ink is {mean} px off");
    }
    let there = flow.back(&flow.ahead(&points, 1.0), 0.0);
    let off = there.iter().zip(&points).map(|(p, q)| p.distance(*q)).sum::<f64>() / points.len() as f64;
    assert!(off < 1.5, "the way back ends {off} px off");
}

#[test]
fn a_limb_turns_while_the_body_stays() {
    let first = cut(&figure(0.0), 47.0, &Similarity::IDENTITY);
    let second = cut(&figure(0.5), 31.0, &Similarity::IDENTITY);
    let flow = Flow::find(&first, &second, &[]).unwrap();
    assert!(flow.meets > 0.9, "{}", flow.meets);
    let hand = Point::new(32.0, -10.0) + Point::from_angle(0.4) * 66.0;
    let raised = Point::new(32.0, -10.0) + Point::from_angle(-0.1) * 66.0;
    let [hand, head] = [hand, Point::new(0.0, -100.0)].map(|p| (p, flow.ahead(&[p], 1.0)[0]));
    assert!(hand.1.distance(raised) < 0.25 * hand.0.distance(raised), "the hand goes to {}, not to {raised}", hand.1);
    assert!(head.1.distance(head.0) < 1.0, "the head goes to {}", head.1);
}

#[test]
fn without_ink_nothing_flows_and_ink_that_stays_stays() {
    let drawing = cut(&figure(0.0), 40.0, &Similarity::IDENTITY);
    let dots = vec![Stroke::new(vec![Point::ONE], false), Stroke::default()];
    assert!(Flow::find(&drawing, &[], &[]).is_none() && Flow::find(&dots, &dots, &[]).is_none());
    let flow = Flow::find(&drawing, &drawing, &[]).unwrap();
    assert_eq!(flow.meets, 1.0);
    let points = &drawing[3].points;
    assert!(flow.ahead(points, 0.7).iter().zip(points).all(|(p, q)| p.distance(*q) < 1e-6));
}

#[test]
fn the_flow_is_the_same_on_any_number_of_threads() {
    let (first, second) =
        (cut(&figure(0.0), 47.0, &Similarity::IDENTITY), cut(&figure(0.8), 31.0, &moved(0.1, Point::X)));
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Flow::find(&first, &second, &[(Point::ZERO, Point::X)]))
    };
    assert_eq!(on(1), on(4));
}

proptest! {
    #[test]
    fn a_similarity_is_met_at_both_ends_of_the_way(
        turn in -1.0f64..1.0, scale in 0.7f64..1.4, x in -50.0f64..50.0, y in -50.0f64..50.0,
        places in prop::collection::vec((-100.0f64..100.0, -100.0f64..100.0), 12..40),
    ) {
        let map = Similarity { factor: Point::from_angle(turn) * scale, source: Point::ZERO, target: Point::new(x, y) };
        let pair = |&(x, y): &(f64, f64)| Pair { from: Point::new(x, y), to: map.apply(Point::new(x, y)), weight: 0.5 };
        let pairs: Vec<Pair> = places.iter().map(pair).collect();
        let field = Field::fit(&pairs, 400.0);
        for pair in &pairs {
            prop_assert!(field.at(pair.from, 1.0).distance(pair.to) < 1e-6);
            prop_assert!(field.at(pair.from, 0.0).distance(pair.from) < 1e-9);
        }
    }
}
