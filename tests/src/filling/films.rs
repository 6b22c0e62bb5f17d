//! The films that this package draws for the fit of the confidence, and to check it.
//!
//! The fit wants mistakes of many kinds. So each film of [figures](super::figures) has its own figures, scenery and colours, and what makes
//! films hard in another mixture: long steps, limbs that cross, figures that cross, turns, leaps, a camera that moves, lines with gaps, and lines that are
//! drawn anew each time. Scenery stands still, and figures pass in front of it.
//!
//! The boy's film ([`super::own`]) is among them, and backwards: then the first drawing shows him from the other side.

use super::figures::{Figure, Pose, between, colour, happens};
use super::own;
use super::shapes::{Picture, Shape, disc};
use crate::sample::outline::Outline;
use crate::sample::{HEIGHT, WIDTH};
use crate::tweening::matching::Chance;
use rototoon::geometry::Point;

/// What a film of figures is like. Lengths are in pixels at 540 lines, and change from each drawing to the next.
#[derive(Clone, Copy, Debug)]
struct Traits {
    seed: u64,
    figures: usize,
    /// Pairs of limbs of a figure.
    pairs: usize,
    /// How far a figure walks.
    stride: f64,
    /// How far it goes on in its step, in radians.
    pace: f64,
    /// How high it leaps.
    leap: f64,
    /// How far it leans further, in radians.
    lean: f64,
    /// How far it turns, in radians.
    turn: f64,
    /// By how much it grows, as a share.
    growth: f64,
    /// How far the camera moves.
    pan: f64,
    /// Gaps in the lines of a drawing.
    gaps: usize,
    /// How far lines move because they are drawn anew.
    wobble: f64,
}

const PLAIN: Traits = Traits {
    seed: 0,
    figures: 1,
    pairs: 2,
    stride: 30.0,
    pace: 0.9,
    leap: 0.0,
    lean: 0.0,
    turn: 0.0,
    growth: 0.0,
    pan: 0.0,
    gaps: 0,
    wobble: 0.7,
};

/// The films of figures.
const FILMS: [(&str, Traits); 8] = [
    ("walk", Traits { seed: 1, figures: 2, ..PLAIN }),
    ("cross", Traits { seed: 2, figures: 3, stride: 55.0, ..PLAIN }),
    ("spider", Traits { seed: 3, pairs: 4, stride: 12.0, pace: 1.3, ..PLAIN }),
    ("leap", Traits { seed: 4, figures: 2, leap: 130.0, stride: 45.0, lean: 0.15, ..PLAIN }),
    ("turn", Traits { seed: 5, figures: 2, turn: 0.45, stride: 8.0, wobble: 1.2, ..PLAIN }),
    ("pan", Traits { seed: 6, figures: 2, pairs: 3, pan: -35.0, ..PLAIN }),
    ("gaps", Traits { seed: 7, figures: 2, gaps: 5, pace: 0.6, stride: 18.0, ..PLAIN }),
    ("near", Traits { seed: 8, figures: 1, pairs: 3, growth: 0.09, gaps: 2, wobble: 1.5, ..PLAIN }),
];

/// Drawings of a film of figures.
const COUNT: usize = 10;
/// Shortest and longest gap.
const GAP: [f64; 2] = [3.0, 8.0];

/// A film with its name. Films whose names begin alike up to the first dot show the same figures.
pub type Film = (String, Vec<Picture>);

/// All films.
pub fn all() -> Vec<Film> {
    let boy = own::drawings(own::COUNT);
    let backwards = boy.iter().rev().cloned().collect();
    let mut films = vec![("boy".to_owned(), boy), ("boy.backwards".to_owned(), backwards)];
    films.extend(FILMS.iter().map(|(name, traits)| ((*name).to_owned(), drawings(traits))));
    films
}

fn drawings(traits: &Traits) -> Vec<Picture> {
    let mut chance = Chance(traits.seed);
    let scenery = scenery(&mut chance);
    let paper = colour(&mut chance);
    let cast: Vec<(Figure, Pose, f64)> = (0..traits.figures)
        .map(|k| {
            let figure = Figure::new(traits.pairs, &mut chance);
            // The first one goes to the right, the next one to the left, and they meet.
            let way = if k % 2 == 0 { 1.0 } else { -1.0 };
            let middle = 480.0 - way * (60.0 + 4.0 * traits.stride) + between(&mut chance, -60.0, 60.0);
            let at = Point::new(middle, between(&mut chance, 290.0, 360.0));
            let scale = between(&mut chance, 0.8, 1.15);
            let phase = between(&mut chance, 0.0, 6.0);
            (figure, Pose { at, lean: 0.0, scale, phase, facing: 0.8 * way }, way)
        })
        .collect();
    (0..COUNT)
        .map(|k| {
            let t = k as f64;
            let mut shapes: Vec<Shape> = scenery.clone();
            shapes.iter_mut().for_each(|shape| shift(shape, Point::new(traits.pan * t, 0.0)));
            for (figure, start, way) in &cast {
                shapes.extend(redrawn(figure.shapes(&posed(traits, start, *way, t)), traits.wobble, &mut chance));
            }
            for _ in 0..traits.gaps {
                let own = chance.below(shapes.len());
                let gap = (chance.below(shapes[own].outline.points.len()), between(&mut chance, GAP[0], GAP[1]));
                shapes[own].gaps.push(gap);
            }
            Picture { shapes, paper, size: [WIDTH, HEIGHT] }
        })
        .collect()
}

/// The pose after `t` drawings.
fn posed(traits: &Traits, start: &Pose, way: f64, t: f64) -> Pose {
    let rise = traits.leap * (0.7 * t).sin().abs() + 6.0 * (traits.pace * t).sin();
    Pose {
        at: start.at + Point::new(way * traits.stride * t, -rise),
        lean: 0.08 * (start.phase + traits.pace * t).sin() + way * traits.lean * t,
        scale: start.scale * (1.0 + traits.growth).powf(t),
        phase: start.phase + traits.pace * t,
        facing: way * (0.6 + traits.turn * t).cos(),
    }
}

fn shift(shape: &mut Shape, by: Point) {
    shape.outline.points.iter_mut().for_each(|point| *point += by);
}

/// Shapes whose control points are off by up to `wobble`.
fn redrawn(mut shapes: Vec<Shape>, wobble: f64, chance: &mut Chance) -> Vec<Shape> {
    for point in shapes.iter_mut().flat_map(|shape| &mut shape.outline.points) {
        *point += Point::new(between(chance, -wobble, wobble), between(chance, -wobble, wobble));
    }
    shapes
}

/// Sun, hills, a house and a fence or trees, the farthest first.
fn scenery(chance: &mut Chance) -> Vec<Shape> {
    let (w, h) = (f64::from(WIDTH), f64::from(HEIGHT));
    let sun =
        disc(Point::new(between(chance, 100.0, 860.0), between(chance, 60.0, 110.0)), between(chance, 30.0, 55.0));
    let mut shapes = vec![Shape::new(sun, colour(chance))];
    for level in [0.6, 0.8] {
        let mut points: Vec<Point> = (0..6)
            .map(|k| Point::new(-400.0 + 352.0 * f64::from(k), h * level + between(chance, -30.0, 30.0)))
            .collect();
        points.extend([Point::new(w + 400.0, h + 40.0), Point::new(-400.0, h + 40.0)]);
        shapes.push(Shape::new(Outline::closed(points).with_corners(&[0, 5, 6, 7]), colour(chance)));
    }
    let left = between(chance, 60.0, 700.0);
    shapes.extend(house(Point::new(left, 440.0), chance));
    if happens(chance, 50) {
        let tone = colour(chance);
        shapes.extend((0..9).map(|k| Shape::new(block([20.0 + 112.0 * f64::from(k), 430.0, 26.0, 70.0]), tone)));
    } else {
        for _ in 0..2 {
            let x = between(chance, 60.0, 900.0);
            shapes.push(Shape::new(block([x - 14.0, 330.0, 28.0, 130.0]), colour(chance)));
            shapes.push(Shape::new(disc(Point::new(x, 280.0), between(chance, 50.0, 85.0)), colour(chance)));
        }
    }
    shapes
}

/// A house with its lower left corner at a place.
fn house(at: Point, chance: &mut Chance) -> Vec<Shape> {
    let (wide, high) = (between(chance, 130.0, 220.0), between(chance, 90.0, 150.0));
    let wall = Shape::new(block([at.x, at.y - high, wide, high]), colour(chance));
    let roof = [(-16.0, -high), (0.5 * wide, -high - 80.0), (wide + 16.0, -high)];
    let roof = Outline::closed(roof.map(|(x, y)| at + Point::new(x, y)).to_vec()).with_corners(&[0, 1, 2]);
    let mut shapes = vec![wall, Shape::new(roof, colour(chance))];
    let pane = colour(chance);
    for k in 0..3 {
        shapes.push(Shape::new(block([at.x + 14.0 + 0.33 * wide * f64::from(k), at.y - 0.8 * high, 24.0, 28.0]), pane));
    }
    shapes.push(Shape::new(block([at.x + 0.4 * wide, at.y - 0.4 * high, 30.0, 0.4 * high]), colour(chance)));
    shapes
}

/// A box: left, top, width and height.
fn block([left, top, width, height]: [f64; 4]) -> Outline {
    let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)];
    Outline::closed(corners.map(|(x, y)| Point::new(left + x, top + y)).to_vec()).with_corners(&[0, 1, 2, 3])
}

#[cfg(test)]
mod tests {
    use super::super::set::Set;
    use super::super::shapes::{LINES, write};
    use super::super::truth::Truth;
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn films_are_the_same_each_time_and_differ_from_each_other() {
        let (one, two) = (all(), all());
        let shown = |film: &Film| format!("{:?}", film.1);
        assert!(one.iter().zip(&two).all(|(a, b)| a.0 == b.0 && shown(a) == shown(b)));
        let different: BTreeSet<String> = one.iter().map(shown).collect();
        assert_eq!(different.len(), FILMS.len() + 2);
        assert_eq!(one.iter().map(|film| film.1.len()).collect::<BTreeSet<_>>(), BTreeSet::from([COUNT, own::COUNT]));
    }

    #[test]
    fn scenery_stands_still_unless_the_camera_moves() {
        let first = |film: &Film, k: usize| film.1[k].shapes[0].outline.points[0];
        for film in all().iter().filter(|film| !film.0.starts_with("boy")) {
            assert_eq!(first(film, 0) == first(film, 5), film.0 != "pan", "{}", film.0);
        }
    }

    #[test]
    fn drawings_have_regions_of_many_colours_and_gaps_join_some() {
        let folder = tempfile::tempdir().unwrap();
        let film = drawings(&FILMS[6].1);
        let closed = drawings(&Traits { gaps: 0, ..FILMS[6].1 });
        let mut counts = Vec::new();
        for (name, drawings) in [("gaps", &film), ("closed", &closed)] {
            let path = folder.path().join(name);
            write(&path, LINES, &drawings[..3]).unwrap();
            let set = Set::find(&path).unwrap();
            let truth: Vec<Truth> = (0..3).map(|k| Truth::of(&set.drawing(k).unwrap())).collect();
            let colours: BTreeSet<_> = truth[0].regions.iter().map(|region| region.colour).collect();
            assert!(colours.len() >= 8, "{name}: {} colours", colours.len());
            counts.push(truth.iter().map(|own| own.regions.len()).sum::<usize>());
        }
        assert!(counts[0] >= 90 && counts[0] < counts[1], "{counts:?}");
    }
}
