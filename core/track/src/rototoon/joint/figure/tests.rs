//! What is unexplained, on made-up figures.

use super::super::tests::{NO_DEPTHS, bar, hypothesis, model, three_drawings, turned};
use super::super::{Bonds, Contender, choose};
use super::*;
use crate::rototoon::pool::Pools;
use crate::rototoon::propagate::Model;
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::Span;

const SIZE: (usize, usize) = (135, 135);
const LEFT: Point = Point::new(100.0, 200.0);
const RIGHT: Point = Point::new(300.0, 200.0);

fn bar_at(place: Point) -> Vec<Point> {
    turned(&bar(), 0.0, place)
}

/// Blocks inside bars at some places.
fn figure_at(places: &[Point]) -> Blocks {
    let center = |x: usize, y: usize| Point::new(x as f64 + 0.5, y as f64 + 0.5) * BLOCK;
    Blocks::where_true(SIZE, |x, y| places.iter().any(|&place| polygon::contains(&bar_at(place), center(x, y))))
}

/// Two legs that look alike, one on the left and one on the right at the keys. Between them both fit much better on the left, by
/// more than the motion there costs.
struct Legs {
    models: [[Model; 2]; 2],
    pools: [Arc<Pools>; 2],
}

impl Legs {
    fn new() -> Self {
        let models = [LEFT, RIGHT].map(|place| [(); 2].map(|()| model(&bar_at(place), (0.0, Point::ZERO))));
        let pools = std::array::from_fn(|k: usize| {
            let own = [LEFT, RIGHT][k];
            let at = |place: Point, look: f32| hypothesis(&models[k][0], 0.0, place - own, look);
            let key = || vec![at(own, 0.0)];
            Arc::new(vec![key(), vec![at(LEFT, 0.002), at(RIGHT, 0.06)], key()])
        });
        Self { models, pools }
    }

    /// The choice on the drawing between the keys, with the figure at `places`, and at `at_keys` on the keys.
    fn chosen(&self, places: &[Point], at_keys: &[Point]) -> [usize; 2] {
        let drawings = three_drawings();
        let leg = |k: usize| Contender {
            part: k,
            span: Span { first: 0, last: 2 },
            depth: 0.0,
            depths: &NO_DEPTHS,
            hides: true,
            drawings: &drawings,
            pools: &self.pools[k],
            models: &self.models[k],
        };
        let frames = [at_keys, places, at_keys].map(figure_at).into_iter().enumerate();
        let canvas = Canvas::made(SIZE, frames.map(|(frame, blocks)| (frame as FrameNumber, blocks)).collect());
        let bonds = Bonds { canvas: Some(Arc::new(canvas)), ..Bonds::default() };
        let start = (vec![vec![0, 0, 0]; 2], &[true; 2][..]);
        let paths = choose(&[leg(0), leg(1)], &bonds, 0.0, start, &mut Memory::default());
        [paths[0][1], paths[1][1]]
    }
}

#[test]
fn a_leg_that_nobody_explains_is_worth_a_worse_fit() {
    let legs = Legs::new();
    let both = [LEFT, RIGHT];
    assert_eq!(legs.chosen(&both, &both), [0, 1], "one leg each");
    assert_eq!(legs.chosen(&[LEFT], &both), [0, 0], "there is one leg in the picture");
}

#[test]
fn what_is_unexplained_at_the_keys_draws_nobody() {
    let legs = Legs::new();
    let more = [LEFT, RIGHT, Point::new(200.0, 200.0)];
    assert_eq!(legs.chosen(&[LEFT, RIGHT], &more), [0, 0], "as much was left at the keys");
    assert_eq!(legs.chosen(&more, &more), [0, 1]);
}

#[test]
fn unclaimed_is_what_other_parts_leave() {
    let canvas = Arc::new(Canvas::made(SIZE, BTreeMap::from([(7, figure_at(&[LEFT, RIGHT]))])));
    let on = |place: Point| BTreeMap::from([(7, Blocks::inside(&bar_at(place), SIZE))]);
    let parts = BTreeMap::from([("near".to_owned(), on(LEFT)), ("far".to_owned(), on(LEFT))]);
    let claims = Claims { canvas, parts };
    let (area, all) = (20.0 * 80.0, (Point::ZERO, Point::splat(540.0)));
    let unclaimed = claims.unclaimed("near", 7, all).unwrap();
    assert!(unclaimed.share(&bar_at(LEFT), area) < 1e-9, "the far leg has it");
    assert!((unclaimed.share(&bar_at(RIGHT), area) - 1.0).abs() < 0.1);
    assert!((unclaimed.share(&bar_at(RIGHT + Point::new(0.0, 40.0)), area) - 0.5).abs() < 0.1);
    let beside = claims.unclaimed("near", 7, (Point::ZERO, Point::new(200.0, 540.0))).unwrap();
    assert!(beside.share(&bar_at(RIGHT), area) < 1e-9, "it is outside of the box");
    assert!(claims.unclaimed("near", 8, all).is_none());
    let other = claims.unclaimed("third", 7, all).unwrap();
    assert!(other.share(&bar_at(LEFT), area) < 1e-9 && other.share(&bar_at(RIGHT), area) > 0.9);
}
