//! Complete scenes: exact cases, a comparison with a raster at 16 times the resolution, and scenes that move.

use super::*;
use proptest::prelude::*;
use rototoon_base::curve::Spline;
use rototoon_base::geometry::Point;
use std::f64::consts::TAU;

fn polyline(points: &[(f64, f64)], closed: bool) -> Path {
    Path::of_polyline(&points.iter().copied().map(Point::from).collect::<Vec<_>>(), closed).unwrap()
}

fn smooth(guides: Vec<Point>, closed: bool) -> Path {
    Path::of_spline(&Spline::new(guides, closed).unwrap()).unwrap()
}

fn disc(centre: Point, radius: f64) -> Path {
    smooth((0..16).map(|k| centre + Point::from_angle(TAU * k as f64 / 16.0) * radius).collect(), true)
}

fn line(path: Path) -> Line {
    Line { path, depth: Depth { layer: 0, stroke: 0 } }
}

fn cover(outlines: Vec<Path>, layer: i32) -> Cover {
    Cover { outlines, rule: FillRule::NonZero, depth: Depth { layer, stroke: 0 } }
}

fn seen(path: &Path, covers: &[Cover]) -> Visibility {
    hidden_lines(&[line(path.clone())], covers, &Options::default()).unwrap().remove(0)
}

fn square(low: f64, high: f64) -> Path {
    polyline(&[(low, low), (high, low), (high, high), (low, high)], true)
}

#[test]
fn a_line_behind_a_square_is_cut_at_its_edges() {
    let path = polyline(&[(0.0, 5.0), (16.0, 5.0)], false);
    let found = seen(&path, &[cover(vec![square(4.0, 8.0)], 1)]);
    assert_eq!(found.hidden, [(0.25, 0.5)]);
    assert_eq!(found.visible, [(0.0, 0.25), (0.5, 1.0)]);
    for layer in [0, -1] {
        assert_eq!(seen(&path, &[cover(vec![square(4.0, 8.0)], layer)]).hidden, []);
    }
}

#[test]
fn a_closed_line_is_cut_over_its_seam() {
    let found = seen(&square(0.0, 8.0), &[cover(vec![square(4.0, 12.0)], 1)]);
    assert_eq!(found.hidden, [(1.5, 2.5)]);
    assert_eq!(found.visible, [(2.5, 5.5)]);
    let found = seen(&square(0.0, 8.0), &[cover(vec![square(-4.0, 4.0)], 1)]);
    assert_eq!((found.hidden, found.visible), (vec![(3.5, 4.5)], vec![(0.5, 3.5)]));
    let found = seen(&square(0.0, 8.0), &[cover(vec![square(-4.0, 14.0)], 1)]);
    assert_eq!((found.hidden, found.visible), (vec![(0.0, 4.0)], vec![]));
}

#[test]
fn an_outline_is_visible_on_its_own_border_and_hidden_between_two_shapes() {
    let edge = polyline(&[(8.0, 0.0), (8.0, 16.0)], false);
    let left = polyline(&[(0.0, 0.0), (8.0, 0.0), (8.0, 16.0), (0.0, 16.0)], true);
    let right = polyline(&[(8.0, 4.0), (16.0, 4.0), (16.0, 12.0), (8.0, 12.0)], true);
    assert_eq!(seen(&edge, &[cover(vec![left.clone()], 1)]).hidden, []);
    let found = seen(&edge, &[cover(vec![left.clone()], 1), cover(vec![right], 2)]);
    assert_eq!(found.hidden, [(0.25, 0.75)]);
    // A line that enters the shape from its border is hidden from there.
    let enters = polyline(&[(8.0, 0.0), (8.0, 8.0), (2.0, 8.0)], false);
    assert_eq!(seen(&enters, &[cover(vec![left], 1)]).hidden, [(1.0, 2.0)]);
}

#[test]
fn a_line_that_touches_from_outside_stays_visible() {
    let ball = disc(Point::new(20.0, 20.0), 10.0);
    let low = ball.pieces().iter().map(|p| p.bounds().1.y).fold(0.0, f64::max);
    let tangent = polyline(&[(0.0, low), (40.0, low)], false);
    assert_eq!(seen(&tangent, &[cover(vec![ball.clone()], 1)]).hidden, []);
    let within = polyline(&[(20.0, 20.0), (20.0, low)], false);
    assert_eq!(seen(&within, &[cover(vec![ball.clone()], 1)]).visible, []);
    let ends_there = polyline(&[(20.0, 40.0), (20.0, low)], false);
    assert_eq!(seen(&ends_there, &[cover(vec![ball], 1)]).hidden, []);
}

#[test]
fn holes_and_figures_of_eight() {
    let path = polyline(&[(0.0, 8.0), (16.0, 8.0)], false);
    let ring = |rule| Cover { rule, ..cover(vec![square(0.0, 16.0), square(4.0, 12.0)], 1) };
    assert_eq!(seen(&path, &[ring(FillRule::EvenOdd)]).visible, [(0.25, 0.75)]);
    assert_eq!(seen(&path, &[ring(FillRule::NonZero)]).visible, []);
    let eight = polyline(&[(0.0, 4.0), (16.0, 12.0), (16.0, 4.0), (0.0, 12.0)], true);
    let across = polyline(&[(8.0, 0.0), (8.0, 16.0)], false);
    assert_eq!(seen(&across, &[cover(vec![eight.clone()], 1)]).hidden, []);
    assert_eq!(seen(&path, &[cover(vec![eight], 1)]).visible, []);
}

#[test]
fn points_lines_and_empty_covers() {
    let dot = polyline(&[(5.0, 5.0)], false);
    assert_eq!(seen(&dot, &[cover(vec![square(4.0, 8.0)], 1)]).visible, []);
    assert_eq!(seen(&dot, &[cover(vec![square(6.0, 8.0)], 1)]).hidden, []);
    assert_eq!(seen(&dot, &[cover(vec![dot.clone()], 1)]).hidden, []);
    assert_eq!(seen(&dot, &[cover(vec![], 1)]).hidden, []);
    let same = polyline(&[(2.0, 2.0); 4], true);
    assert_eq!(seen(&same, &[cover(vec![square(0.0, 8.0)], 1)]).visible, []);
    let short = polyline(&[(5.0, 5.0), (5.02, 5.0)], false);
    assert_eq!(seen(&short, &[cover(vec![square(4.0, 8.0)], 1)]).visible, []);
    assert_eq!(hidden_lines(&[], &[], &Options::default()), Ok(vec![]));
}

#[test]
fn a_line_that_turns_back_just_inside_stays_visible() {
    let edge = square(4.0, 8.0);
    let turns = |depth: f64| polyline(&[(0.0, 6.0), (4.0 + depth, 6.0)], true);
    let hidden = |depth: f64, sliver: f64| {
        let options = Options { sliver, ..Options::default() };
        let found = hidden_lines(&[line(turns(depth))], &[cover(vec![edge.clone()], 1)], &options).unwrap().remove(0);
        found.hidden.iter().map(|&(a, b)| turns(depth).length_between(a, b)).sum::<f64>()
    };
    // It is inside by 0.04 px on its way there and by as much on its way back.
    assert_eq!(hidden(0.04, 0.1), 0.0);
    assert!((hidden(0.04, 0.0) - 0.08).abs() < 1e-6);
    assert!((hidden(0.06, 0.1) - 0.12).abs() < 1e-6);
}

#[test]
fn options_that_are_no_distances_are_refused() {
    let options = Options { border: -1.0, ..Options::default() };
    let error = hidden_lines(&[], &[], &options).unwrap_err();
    assert_eq!(error.to_string(), "border of -1 px, expected a number that is not negative");
    assert!(hidden_lines(&[], &[], &Options { sliver: f64::NAN, ..Options::default() }).is_err());
    assert!(hidden_lines(&[], &[], &Options { border: 0.0, sliver: 0.0 }).is_ok());
}

#[test]
fn an_outline_drawn_twice_and_rounded_is_not_torn() {
    let mut state = 7u64;
    let mut noise = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 40) as f64 / (1u64 << 24) as f64 - 0.5
    };
    for frame in 0..30 {
        let place = Point::new(500.0 + frame as f64 * 1.37, 300.0);
        let ideal: Vec<Point> = (0..200)
            .map(|k| TAU * k as f64 / 200.0)
            .map(|a| place + Point::from_angle(a) * (90.0 + 30.0 * (3.0 * a).sin()))
            .collect();
        let mut noisy = || ideal.iter().map(|p| *p + 1e-3 * Point::new(noise(), noise())).collect::<Vec<_>>();
        let (drawn, fill) = (noisy(), noisy());
        let drawn = Path::of_polyline(&drawn, true).unwrap();
        let fill = Path::of_polyline(&fill, true).unwrap();
        assert_eq!(seen(&drawn, &[cover(vec![fill], 1)]).hidden, [], "frame {frame}");
    }
}

/// The inside of a cover at 16 times the resolution: pixel centres, by scan lines over the flattened outlines.
struct Mask {
    inside: Vec<bool>,
}

const SIZE: usize = 64;
const FINE: usize = 16;
const SIDE: usize = SIZE * FINE;

impl Mask {
    fn new(cover: &Cover) -> Self {
        let mut windings = vec![0i32; SIDE * SIDE];
        for outline in &cover.outlines {
            let points: Vec<Point> =
                outline.pieces().iter().flat_map(|q| (0..64).map(|k| q.point(k as f64 / 64.0))).collect();
            for (k, &a) in points.iter().enumerate() {
                let b = points[(k + 1) % points.len()];
                edge(&mut windings, a * FINE as f64, b * FINE as f64);
            }
        }
        let mut inside = vec![false; SIDE * SIDE];
        for (row, wound) in inside.chunks_mut(SIDE).zip(windings.chunks(SIDE)) {
            let mut winding = 0;
            for (pixel, change) in row.iter_mut().zip(wound) {
                winding += change;
                *pixel = match cover.rule {
                    FillRule::NonZero => winding != 0,
                    FillRule::EvenOdd => winding % 2 != 0,
                };
            }
        }
        Self { inside }
    }

    /// The state at a point of the picture, where all pixels around it agree.
    fn at(&self, p: Point) -> Option<bool> {
        let (x, y) = ((p.x * FINE as f64).floor(), (p.y * FINE as f64).floor());
        let last = SIDE as f64 - 1.0;
        if x < 1.0 || y < 1.0 || x >= last || y >= last {
            return None;
        }
        let pixel = |x: f64, y: f64| self.inside[y as usize * SIDE + x as usize];
        let middle = pixel(x, y);
        let agree = (-1..=1).all(|i| (-1..=1).all(|j| pixel(x + f64::from(i), y + f64::from(j)) == middle));
        agree.then_some(middle)
    }
}

/// Marks the first pixel to the right of an edge, on each row of pixel centres that the edge crosses.
fn edge(windings: &mut [i32], a: Point, b: Point) {
    let (top, bottom, sign) = if a.y <= b.y { (a, b, 1) } else { (b, a, -1) };
    let first = (top.y - 0.5).ceil().max(0.0);
    let mut y = first;
    while y + 0.5 < bottom.y && y < SIDE as f64 {
        let x = top.x + (y + 0.5 - top.y) / (bottom.y - top.y) * (bottom.x - top.x);
        let column = (x - 0.5).ceil().max(0.0) as usize;
        if column < SIDE {
            windings[y as usize * SIDE + column] += sign;
        }
        y += 1.0;
    }
}

fn any_guides(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Point>> {
    let place = -4.0f64..SIZE as f64 + 4.0;
    let guides = prop::collection::vec((place.clone(), place), count);
    (guides, any::<bool>()).prop_map(|(guides, cornered)| {
        let mut guides: Vec<Point> = guides.into_iter().map(Point::from).collect();
        if cornered {
            guides.insert(guides.len() / 2, guides[guides.len() / 2]);
        }
        guides
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    #[test]
    fn visible_parts_agree_with_a_raster(
        outlines in prop::collection::vec(any_guides(1..9), 1..4),
        guides in prop::collection::vec((any_guides(1..9), any::<bool>(), any::<bool>()), 1..6),
        even: bool,
    ) {
        let covers: Vec<Cover> = outlines
            .into_iter()
            .enumerate()
            .map(|(i, guides)| Cover {
                rule: if even { FillRule::EvenOdd } else { FillRule::NonZero },
                ..cover(vec![smooth(guides, true)], i as i32)
            })
            .collect();
        let lines: Vec<Line> = guides
            .into_iter()
            .enumerate()
            .map(|(i, (guides, closed, straight))| Line {
                path: if straight { Path::of_polyline(&guides, closed).unwrap() } else { smooth(guides, closed) },
                depth: Depth { layer: i as i32 % 3 - 1, stroke: 5 },
            })
            .collect();
        let masks: Vec<Mask> = covers.iter().map(Mask::new).collect();
        let found = hidden_lines(&lines, &covers, &Options::default()).unwrap();
        let exact = hidden_lines(&lines, &covers, &Options { sliver: 0.0, ..Options::default() }).unwrap();
        for ((line, seen), exact) in lines.iter().zip(&found).zip(&exact) {
            let end = line.path.end();
            // The options decide about slivers that the raster shows. Each point of a sliver is near one of its ends.
            let cuts: Vec<Point> = [seen, exact]
                .into_iter()
                .flat_map(|seen| seen.hidden.iter().chain(&seen.visible))
                .flat_map(|&(a, b)| [line.path.point(a), line.path.point(b)])
                .collect();
            for k in 0..600 {
                let t = end * (k as f64 + 0.5) / 600.0;
                let p = line.path.point(t);
                let front = covers.iter().zip(&masks).filter(|(cover, _)| cover.depth > line.depth);
                let states: Option<Vec<bool>> = front.map(|(_, mask)| mask.at(p)).collect();
                let Some(states) = states else { continue };
                let within = |set: &[Interval]| set.iter().any(|&(a, b)| (a <= t && t <= b) || (a <= t + end && t + end <= b));
                if cuts.iter().any(|cut| cut.distance(p) < 0.15) {
                    continue;
                }
                prop_assert_eq!(within(&seen.hidden), states.contains(&true), "t {} at {}", t, p);
                prop_assert_eq!(within(&seen.visible), !states.contains(&true));
            }
        }
    }

    #[test]
    fn visible_and_hidden_parts_make_the_complete_line(
        outlines in prop::collection::vec(any_guides(1..9), 0..4), guides in any_guides(1..9), closed: bool,
    ) {
        let covers: Vec<Cover> = outlines.into_iter().map(|guides| cover(vec![smooth(guides, true)], 1)).collect();
        let path = smooth(guides, closed);
        let found = seen(&path, &covers);
        let sum = |set: &[Interval]| set.iter().map(|(a, b)| b - a).sum::<f64>();
        prop_assert!((sum(&found.visible) + sum(&found.hidden) - path.end()).abs() < 1e-9);
        let mut ends: Vec<Interval> = found.visible.iter().chain(&found.hidden).copied().collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        prop_assert!(ends.windows(2).all(|pair| pair[0].1 == pair[1].0), "{:?}", ends);
        // The reversed line gives the same result.
        let back = Path::of_pieces(path.pieces().iter().rev().map(|q| q.reversed()).collect(), closed).unwrap();
        let length = |path: &Path, set: &[Interval]| set.iter().map(|&(a, b)| path.length_between(a, b)).sum::<f64>();
        let (there, again) = (length(&path, &found.hidden), length(&back, &seen(&back, &covers).hidden));
        prop_assert!((there - again).abs() < 0.25, "{} {}", there, again);
    }
}

/// Blobs that drift, turn and change size. `time` is in seconds.
fn moving(time: f64) -> Vec<Cover> {
    (0..4)
        .map(|i| {
            let phase = f64::from(i) * 1.7;
            let centre =
                Point::new(32.0 + 22.0 * (0.9 * time + phase).sin(), 32.0 + 18.0 * (0.7 * time + 2.0 * phase).cos());
            let guides = (0..11)
                .map(|k| {
                    let angle = TAU * f64::from(k) / 11.0 + 0.5 * time;
                    centre + Point::from_angle(angle) * (9.0 + 4.0 * (1.3 * time + phase + 2.0 * f64::from(k)).sin())
                })
                .collect();
            cover(vec![smooth(guides, true)], 1 + i)
        })
        .collect()
}

/// Whether each of 4000 samples of the parameter is hidden.
fn sampled(path: &Path, seen: &Visibility) -> Vec<bool> {
    const COUNT: usize = 4000;
    let end = path.end();
    (0..COUNT)
        .map(|k| end * (k as f64 + 0.5) / COUNT as f64)
        .map(|t| seen.hidden.iter().any(|&(a, b)| (a <= t && t < b) || (a <= t + end && t + end < b)))
        .collect()
}

#[test]
fn visible_parts_move_continuously() {
    let paths = [
        polyline(&[(2.0, 10.0), (62.0, 54.0)], false),
        smooth([(4.0, 4.0), (60.0, 8.0), (30.0, 70.0), (6.0, 40.0)].map(Point::from).into(), true),
        disc(Point::new(32.0, 32.0), 20.0),
    ];
    let lines: Vec<Line> = paths.iter().cloned().map(line).collect();
    let mut jumps = [0.0f64; 2];
    for (jump, (steps, step)) in jumps.iter_mut().zip([(600, 1e-2), (3000, 1e-4)]) {
        let at =
            |frame: i32| hidden_lines(&lines, &moving(0.3 + f64::from(frame) * step), &Options::default()).unwrap();
        let mut before = at(0);
        for frame in 1..steps {
            let now = at(frame);
            for ((path, a), b) in paths.iter().zip(&before).zip(&now) {
                let changed = sampled(path, a).iter().zip(sampled(path, b)).filter(|(x, y)| **x != *y).count();
                *jump = jump.max(changed as f64 / 4000.0 * path.length_between(0.0, path.end()));
            }
            before = now;
        }
    }
    // Nothing moves faster than 60 px a second. Where lines cross at an angle, a step of 1e-2 s moves the cut by 0.6
    // px. A grazed stretch grows with the root of the step: a hundredth of the step gives a tenth of the stretch.
    assert!(jumps[0] < 12.0 && jumps[1] < 1.2 && jumps[0] > jumps[1], "{jumps:?}");
}

#[test]
fn thousands_of_strokes_on_any_number_of_threads() {
    let strokes = 2000;
    let place = |i: usize| {
        Point::new(1900.0 * (i as f64 * 0.618).fract(), 1050.0 * (i as f64 * 0.7549 + 1e-4 * (i * i) as f64).fract())
    };
    let lines: Vec<Line> = (0..strokes)
        .map(|i| Line { path: disc(place(i), 12.0), depth: Depth { layer: 0, stroke: i as i32 } })
        .collect();
    let covers: Vec<Cover> = lines
        .iter()
        .map(|line| Cover { outlines: vec![line.path.clone()], rule: FillRule::NonZero, depth: line.depth })
        .collect();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| hidden_lines(&lines, &covers, &Options::default()).unwrap())
    };
    let found = run(1);
    assert_eq!(found, run(3));
    // The nearest line is completely visible.
    assert_eq!(found[strokes - 1].hidden, []);
    assert!(found.iter().filter(|seen| !seen.hidden.is_empty()).count() > strokes / 4);
}
