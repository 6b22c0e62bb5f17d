//! The joint choice on made-up hypotheses.

use super::companion::{self, Companions};
use super::lead::{Lead, leads};
use super::margin::LARGEST;
use super::shadow::{Memory, Shadows};
use super::{Bonds, Contender, choose, jumps, margins, tie};
use crate::rototoon::lattice::align::Aligner;
use crate::rototoon::lattice::mesh::Mesh;
use crate::rototoon::lattice::necks::Necks;
use crate::rototoon::lattice::texture::{Cover, Texture};
use crate::rototoon::pool::{Hypothesis, Pools};
use crate::rototoon::propagate::{Model, Pose};
use crate::rototoon::select::Smoothness;
use crate::shared::drawings::Drawing;
use crate::shared::features::Features;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, Raster, Span};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A bar of 20 × 80 working pixels. The origin is the middle of its upper end.
pub fn bar() -> Vec<Point> {
    [(-10.0, 0.0), (10.0, 0.0), (10.0, 80.0), (-10.0, 80.0)].map(|(x, y)| Point::new(x, y)).to_vec()
}

pub fn turned(shape: &[Point], degrees: f64, to: Point) -> Vec<Point> {
    let turn = Point::from_angle(f64::to_radians(degrees));
    shape.iter().map(|&p| turn.rotate(p) + to).collect()
}

/// No depths on single frames.
pub static NO_DEPTHS: BTreeMap<FrameNumber, f64> = BTreeMap::new();

/// A model of a shape on plain paper. `there` is its rotation and shift to the other key.
pub fn model(shape: &[Point], there: (f64, Point)) -> Model {
    let paper = Features::new(&Raster::new(540, 540, [0.5f32; 3]));
    let mesh = Mesh::new(shape, true);
    let rest = mesh.rest.clone();
    let cover = Cover::none(540.0);
    let texture = Texture::new(mesh, &paper, &cover, 540.0);
    let there = turned(&rest, there.0, there.1);
    Model {
        aligner: Aligner::new(&texture.mesh),
        texture,
        cover,
        there,
        bent: rest,
        limb: None,
        necks: Necks::default(),
    }
}

pub fn hypothesis(model: &Model, degrees: f64, to: Point, look: f32) -> Hypothesis {
    let nodes = turned(&model.texture.mesh.rest, degrees, to);
    let points = model.texture.mesh.control_points(&nodes);
    let differences = vec![look; model.texture.measured().len()];
    Hypothesis::new(0, Pose { nodes, energy: f64::from(look) }, points, differences)
}

pub fn three_drawings() -> Vec<Drawing> {
    (0..3).map(|i| Drawing { first: i, last: i }).collect()
}

#[test]
fn two_parts_do_not_take_the_same_place() {
    let at = |x: f64| turned(&bar(), 0.0, Point::new(x, 200.0));
    let still = (0.0, Point::ZERO);
    let far_models = [model(&at(240.0), still), model(&at(240.0), still)];
    let near_models = [model(&at(200.0), still), model(&at(200.0), still)];
    let drawings = three_drawings();
    let key = |models: &[Model; 2]| vec![hypothesis(&models[0], 0.0, Point::ZERO, 0.0)];
    // On the middle drawing the far part fits at the near one's place so well that alone it would go there.
    let aside = hypothesis(&far_models[0], 0.0, Point::new(-40.0, 0.0), 0.0005);
    let home = hypothesis(&far_models[0], 0.0, Point::ZERO, 0.02);
    let far: Arc<Pools> = Arc::new(vec![key(&far_models), vec![aside, home], key(&far_models)]);
    let near: Arc<Pools> = Arc::new(vec![key(&near_models), key(&near_models), key(&near_models)]);
    let span = Span { first: 0, last: 2 };
    let mut memory = Memory::default();
    let chosen = |depth: f64, memory: &mut Memory| {
        let contender = |part, pools, models, depth| Contender {
            part,
            span,
            depth,
            depths: &NO_DEPTHS,
            hides: true,
            drawings: &drawings,
            pools,
            models,
        };
        let both = [contender(0, &far, &far_models, 0.0), contender(1, &near, &near_models, depth)];
        choose(
            &both,
            &Bonds { ties: tie::find(&both), companions: Vec::new(), canvas: None },
            0.0,
            (vec![vec![0, 0, 0]; 2], &[true; 2]),
            memory,
        )
    };
    // Parts of the same depth do not hide each other.
    assert_eq!(chosen(0.0, &mut memory), [[0, 0, 0], [0, 0, 0]]);
    assert_eq!(chosen(1.0, &mut memory), [[0, 1, 0], [0, 0, 0]]);
    // Remembered shadows equal the computed ones, and depths may change.
    memory.keep_only([&far, &near].into_iter());
    assert_eq!(chosen(1.0, &mut memory), [[0, 1, 0], [0, 0, 0]]);
    assert_eq!(chosen(-1.0, &mut memory), [[0, 1, 0], [0, 0, 0]]);
}

#[test]
fn who_hides_whom_is_asked_on_each_drawing() {
    let at = |x: f64| turned(&bar(), 0.0, Point::new(x, 200.0));
    let still = (0.0, Point::ZERO);
    let models = [240.0, 200.0].map(|x| [model(&at(x), still), model(&at(x), still)]);
    let drawings: Vec<Drawing> = (0..4).map(|i| Drawing { first: i, last: i }).collect();
    let key = |k: usize| vec![hypothesis(&models[k][0], 0.0, Point::ZERO, 0.0)];
    // On both drawings between the keys nothing is seen of the first part at its place.
    let unseen = || vec![hypothesis(&models[0][0], 0.0, Point::new(-40.0, 0.0), 0.2)];
    let pools: [Arc<Pools>; 2] =
        [Arc::new(vec![key(0), unseen(), unseen(), key(0)]), Arc::new(vec![key(1), key(1), key(1), key(1)])];
    let mut memory = Memory::default();
    let mut looks = |depths: &BTreeMap<FrameNumber, f64>| {
        let contender = |part: usize, depths| Contender {
            part,
            span: Span { first: 10, last: 13 },
            depth: part as f64,
            depths,
            hides: true,
            drawings: &drawings,
            pools: &pools[part],
            models: &models[part],
        };
        let both = [contender(0, depths), contender(1, &NO_DEPTHS)];
        let shadows = Shadows::cast(&both, &mut memory);
        let hidden = |far: usize, d: usize| shadows.mask((far, 1 - far), (d, 0), 0).is_some();
        ([0, 1].map(|far| [1, 2].map(|d| hidden(far, d))), shadows.pairs())
    };
    let always = ([[true, true], [false, false]], vec![(0, 1)]);
    assert_eq!(looks(&NO_DEPTHS), always);
    // From frame 12 on, which is the third drawing, the first part is in front.
    let later = ([[true, false], [false, true]], vec![(0, 1)]);
    assert_eq!(looks(&(12..14).map(|frame| (frame, 2.0)).collect()), later);
    assert_eq!(looks(&NO_DEPTHS), always, "what is remembered is not taken for another order");
}

#[test]
fn the_margin_is_what_another_place_would_cost_more() {
    let models = [model(&bar(), (0.0, Point::ZERO)), model(&bar(), (0.0, Point::ZERO))];
    let drawings = three_drawings();
    let at = |x: f64, look: f32| hypothesis(&models[0], 0.0, Point::new(x, 0.0), look);
    // On the middle drawing there is the home, a place beside it that is no other place, and two other places.
    let middle = vec![at(0.0, 0.01), at(2.0, 0.011), at(60.0, 0.04), at(-60.0, 0.09)];
    let pools: Arc<Pools> = Arc::new(vec![vec![at(0.0, 0.0)], middle, vec![at(0.0, 0.0)]]);
    let contender = Contender {
        part: 0,
        span: Span { first: 0, last: 2 },
        depth: 0.0,
        depths: &NO_DEPTHS,
        hides: true,
        drawings: &drawings,
        pools: &pools,
        models: &models,
    };
    let smoothness = Smoothness::new(models[0].texture.mesh.size);
    let places = [0, 2, 0].map(|h| &pools[1][h].points[..]);
    let still = smoothness.of_path(&[places[0]; 3], &[]);
    let swung = smoothness.of_path(&[places[0], places[1], places[2]], &[]);
    let found = margins(&[contender], &Bonds::default(), 0.0, (&[vec![0, 0, 0]], &[true]), &mut Memory::default());
    let expected = 0.04f64.sqrt() - 0.01f64.sqrt() + swung - still;
    assert_eq!((found[0][0], found[0][2]), (LARGEST, LARGEST), "a key has no other place");
    assert!((found[0][1] - expected).abs() < 1e-6, "{} and {expected}", found[0][1]);
}

/// The pivot of the limb and the body below.
const PIVOT: Point = Point::new(250.0, 150.0);

/// A body about the pivot, and a limb that hangs on it.
fn body_and_limb() -> [Vec<Point>; 2] {
    let body = [(-60.0, -80.0), (60.0, -80.0), (60.0, 25.0), (-60.0, 25.0)].map(|(x, y)| Point::new(x, y) + PIVOT);
    [body.to_vec(), turned(&bar(), 0.0, PIVOT - Point::new(0.0, 8.0))]
}

/// A turn about the pivot by degrees, as a model's movement.
fn about(degrees: f64) -> (f64, Point) {
    (degrees, PIVOT - Point::from_angle(degrees.to_radians()).rotate(PIVOT))
}

/// A shape turned about the pivot by degrees.
fn swung(shape: &[Point], degrees: f64) -> Vec<Point> {
    let swing = Point::from_angle(degrees.to_radians());
    shape.iter().map(|&p| swing.rotate(p - PIVOT) + PIVOT).collect()
}

/// One hypothesis on each of `count` drawings: the first model's on all but the last, the second one's there.
fn still_pools(models: &[Model; 2], count: usize) -> Arc<Pools> {
    let still = |m: usize| vec![hypothesis(&models[m], 0.0, Point::ZERO, 0.0)];
    Arc::new((0..count).map(|d| still(usize::from(d + 1 == count))).collect())
}

#[test]
fn the_hinge_of_a_swinging_limb_is_its_pivot() {
    let [body, limb] = body_and_limb();
    // The limb swings by 50° about the pivot, the body stays.
    let limb_models = [model(&limb, about(50.0)), model(&swung(&limb, 50.0), about(-50.0))];
    let body_models = [model(&body, (0.0, Point::ZERO)), model(&body, (0.0, Point::ZERO))];
    let drawings = three_drawings();
    let (limb_pools, body_pools) = (still_pools(&limb_models, 3), still_pools(&body_models, 3));
    let contender = |part: usize, pools, models| Contender {
        part,
        span: Span { first: 0, last: 2 },
        depth: part as f64,
        depths: &NO_DEPTHS,
        hides: true,
        drawings: &drawings,
        pools,
        models,
    };
    let ties = tie::find(&[contender(0, &limb_pools, &limb_models), contender(1, &body_pools, &body_models)]);
    assert_eq!(ties.len(), 1);
    let place = ties[0].place(0, 0, &limb_models[0].texture.mesh.rest).unwrap();
    assert!(place.distance(PIVOT) < 8.0, "{place}");
}

#[test]
fn a_further_key_of_a_part_keeps_its_joints() {
    let [body, limb] = body_and_limb();
    // The limb swings by 25° to its further key, and by as much again to the last one.
    let limb_models = [0.0, 25.0]
        .map(|from| [model(&swung(&limb, from), about(25.0)), model(&swung(&limb, from + 25.0), about(-25.0))]);
    let body_models = [model(&body, (0.0, Point::ZERO)), model(&body, (0.0, Point::ZERO))];
    let [three, five] =
        [3, 5].map(|count| -> Vec<Drawing> { (0..count).map(|i| Drawing { first: i, last: i }).collect() });
    let limb_pools = [0, 1].map(|k| still_pools(&limb_models[k], 3));
    let body_pools = still_pools(&body_models, 5);
    let span_of = |k: usize| Contender {
        part: 0,
        span: Span { first: 2 * k as i32, last: 2 * k as i32 + 2 },
        depth: 0.0,
        depths: &NO_DEPTHS,
        hides: true,
        drawings: &three,
        pools: &limb_pools[k],
        models: &limb_models[k],
    };
    let whole = Contender {
        part: 1,
        span: Span { first: 0, last: 4 },
        depth: 1.0,
        depths: &NO_DEPTHS,
        hides: true,
        drawings: &five,
        pools: &body_pools,
        models: &body_models,
    };
    let ties = tie::find(&[span_of(0), span_of(1), whole]);
    let mut joined: Vec<[usize; 2]> = ties.iter().map(|tie| tie.parts).collect();
    joined.sort_unstable();
    assert_eq!(joined, [[0, 2], [1, 2]]);
    for tie in &ties {
        let place = tie.place(tie.parts[0], 0, &limb_models[tie.parts[0]][0].texture.mesh.rest).unwrap();
        assert!(place.distance(PIVOT) < 8.0, "{place}");
    }
}

#[test]
fn the_jump_of_a_stretch_is_measured_on_the_best_hypotheses() {
    let models = [model(&bar(), (0.0, Point::ZERO)), model(&bar(), (0.0, Point::ZERO))];
    let drawings: Vec<Drawing> = (0..5).map(|i| Drawing { first: i, last: i }).collect();
    let jump = |places: [f64; 5]| {
        let pool = |x: f64| {
            let wrong = hypothesis(&models[0], 0.0, Point::new(x + 77.0, 9.0), 0.02);
            vec![wrong, hypothesis(&models[0], 0.0, Point::new(x, 0.0), 0.001)]
        };
        let pools: Arc<Pools> = Arc::new(places.map(pool).to_vec());
        let span = Span { first: 0, last: 4 };
        let alone = Contender {
            part: 0,
            span,
            depth: 0.0,
            depths: &NO_DEPTHS,
            hides: true,
            drawings: &drawings,
            pools: &pools,
            models: &models,
        };
        jumps::measured(&[alone])
    };
    assert!(jump([0.0, 10.0, 20.0, 30.0, 40.0]) < 1e-9, "even motion has none");
    let uneven = jump([0.0, 60.0, 0.0, 60.0, 0.0]);
    assert!(uneven > 120.0, "{uneven}");
}

/// A head of 120 × 120 and an eye of 20 × 20 working pixels in it, which both move by `step` from key to key; the eye by `more`
/// in addition. On the middle drawing the head is 80 px lower, and the eye is either there or where even motion has it.
fn with_head_and_eye<T>(step: Point, more: Point, then: impl Fn(&[Contender]) -> T) -> T {
    let square = |middle: Point, half: f64| -> Vec<Point> {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| middle + Point::new(x, y) * half).to_vec()
    };
    let middle = Point::new(200.0, 200.0);
    let models =
        |half: f64, to: Point| [model(&square(middle, half), (0.0, to)), model(&square(middle + to, half), (0.0, -to))];
    let (head, eye) = (models(60.0, step), models(10.0, step + more));
    let key = |models: &[Model; 2], k: usize| vec![hypothesis(&models[k], 0.0, Point::ZERO, 0.0)];
    let low = step * 0.5 + Point::new(0.0, 80.0);
    let head_there = vec![hypothesis(&head[0], 0.0, low, 0.0)];
    let eye_there = vec![hypothesis(&eye[0], 0.0, step * 0.5, 0.0225), hypothesis(&eye[0], 0.0, low, 0.0)];
    let head_pools = Arc::new(vec![key(&head, 0), head_there, key(&head, 1)]);
    let eye_pools = Arc::new(vec![key(&eye, 0), eye_there, key(&eye, 1)]);
    let (drawings, span) = (three_drawings(), Span { first: 0, last: 2 });
    let contender = |part, pools, models| Contender {
        part,
        span,
        depth: 0.0,
        depths: &NO_DEPTHS,
        hides: true,
        drawings: &drawings,
        pools,
        models,
    };
    then(&[contender(0, &head_pools, &head), contender(1, &eye_pools, &eye)])
}

#[test]
fn an_eye_stays_with_the_head_that_jumps() {
    with_head_and_eye(Point::new(30.0, 10.0), Point::ZERO, |both| {
        let pairs = companion::find(both, &[vec![0; 3], vec![0; 3]], &|_, _| false);
        let [pair] = pairs[..] else { panic!("{pairs:?}") };
        assert_eq!(pair.parts, [1, 0], "the eye goes with the head, and not the head with the eye");
        let companions = Companions::new(both, &pairs);
        assert!(companions.apart(0, (1, 1), (1, 0)) < 1e-9);
        assert!((companions.apart(0, (1, 0), (1, 0)) - 80.0).abs() < 1e-9);
        let chosen = |companions: Vec<companion::Pair>| {
            let bonds = Bonds { companions, ..Bonds::default() };
            choose(both, &bonds, 1e-6, (vec![vec![0, 0, 0]; 2], &[true; 2]), &mut Memory::default())
        };
        assert_eq!(chosen(Vec::new()), [[0, 0, 0], [0, 0, 0]], "alone it moves evenly");
        assert_eq!(chosen(pairs), [[0, 0, 0], [0, 1, 0]]);
    });
}

#[test]
fn the_head_leads_an_eye_that_is_elsewhere() {
    with_head_and_eye(Point::new(30.0, 10.0), Point::ZERO, |both| {
        let bonds = Bonds {
            ties: Vec::new(),
            companions: companion::find(both, &[vec![0; 3], vec![0; 3]], &|_, _| false),
            canvas: None,
        };
        let led = leads(both, &bonds, &[vec![0, 0, 0], vec![0, 0, 0]]);
        let [Lead::Body(motions)] = &led[1][..] else { panic!("one lead, {:?}", led[1]) };
        assert!(led[0].is_empty() && motions[0].is_none() && motions[2].is_none());
        let there = &both[1].pools[1][1].points;
        for (motion, key) in motions[1].unwrap().iter().zip(both[1].keys()) {
            assert!(key.iter().zip(there).all(|(&p, q)| motion.apply(p).distance(*q) < 1e-9));
        }
        assert!(
            leads(both, &bonds, &[vec![0, 0, 0], vec![0, 1, 0]])[1].is_empty(),
            "where it is right it needs no lead"
        );
    });
}

#[test]
fn parts_that_come_apart_from_key_to_key_are_no_companions() {
    with_head_and_eye(Point::new(30.0, 10.0), Point::new(15.0, 0.0), |both| {
        assert_eq!(companion::find(both, &[vec![0; 3], vec![0; 3]], &|_, _| false), [] as [companion::Pair; 0]);
    });
}

#[test]
fn a_companion_that_drifts_from_key_to_key_costs_less() {
    let cost = |drift: f64| {
        with_head_and_eye(Point::new(30.0, 10.0), Point::new(drift, 0.0), |both| {
            let pairs = companion::find(both, &[vec![0; 3], vec![0; 3]], &|_, _| false);
            let companions = Companions::new(both, &pairs);
            companions.cost(0, (1, 1), (1, 0)) / companions.apart(0, (1, 1), (1, 0))
        })
    };
    // The head's motion leaves the eye 5 px from its second key, and half of that between the keys.
    assert!((cost(5.0) - 0.06 / 30.0).abs() < 1e-9, "{}", cost(5.0));
    assert!((cost(10.0) - 0.06 / 35.0).abs() < 1e-9, "{}", cost(10.0));
}

#[test]
fn a_further_key_of_a_part_keeps_its_companions() {
    let still = |at: &[Point]| [model(at, (0.0, Point::ZERO)), model(at, (0.0, Point::ZERO))];
    let head = still(&turned(&bar(), 0.0, Point::new(200.0, 200.0)));
    let eye =
        still(&[(-4.0, 10.0), (4.0, 10.0), (4.0, 18.0), (-4.0, 18.0)].map(|(x, y)| Point::new(200.0 + x, 200.0 + y)));
    let pools = |models: &[Model; 2], steps: &[f64]| -> Arc<Pools> {
        let at = |&x: &f64| vec![hypothesis(&models[0], 0.0, Point::new(x, 0.0), 0.0)];
        Arc::new(steps.iter().map(at).collect())
    };
    let drawings = |count: usize| -> Vec<Drawing> { (0..count).map(|i| Drawing { first: i, last: i }).collect() };
    let (three, five) = (drawings(3), drawings(5));
    // The head goes 40 px to the right in four drawings. The eye has a further key on the third, and is left behind on the fourth.
    let eyes = [pools(&eye, &[0.0, 10.0, 20.0]), pools(&eye, &[20.0, 20.0, 40.0])];
    let heads = pools(&head, &[0.0, 10.0, 20.0, 30.0, 40.0]);
    let whole = Contender {
        part: 1,
        span: Span { first: 0, last: 4 },
        depth: 0.0,
        depths: &NO_DEPTHS,
        hides: true,
        drawings: &five,
        pools: &heads,
        models: &head,
    };
    let half = |k: usize| {
        let span = Span { first: 2 * k as i32, last: 2 * k as i32 + 2 };
        Contender {
            part: 0,
            span,
            depth: 0.0,
            depths: &NO_DEPTHS,
            hides: true,
            drawings: &three,
            pools: &eyes[k],
            models: &eye,
        }
    };
    let all = [half(0), half(1), whole];
    let bonds = Bonds {
        ties: Vec::new(),
        canvas: None,
        companions: companion::find(&all, &[vec![0; 3], vec![0; 3], vec![0; 5]], &|_, _| false),
    };
    let parts: Vec<[usize; 2]> = bonds.companions.iter().map(|pair| pair.parts).collect();
    assert_eq!(parts, [[0, 2], [1, 2]]);
    let led = leads(&all, &bonds, &[vec![0; 3], vec![0; 3], vec![0; 5]]);
    let [Lead::Body(motions)] = &led[1][..] else { panic!("one lead, {:?}", led[1]) };
    assert!(led[0].is_empty() && motions[0].is_none() && motions[2].is_none());
    let [from_further, from_last] = motions[1].unwrap();
    assert!(from_further.apply(Point::new(220.0, 5.0)).distance(Point::new(230.0, 5.0)) < 1e-9);
    assert!(from_last.apply(Point::new(240.0, 5.0)).distance(Point::new(230.0, 5.0)) < 1e-9);
}

#[test]
fn a_part_that_a_correction_puts_elsewhere_moves_by_itself() {
    with_head_and_eye(Point::new(30.0, 10.0), Point::ZERO, |both| {
        let found = |eye: usize, corrected: bool| {
            companion::find(both, &[vec![0; 3], vec![0, eye, 0]], &|part, d| corrected && (part, d) == (1, 1)).len()
        };
        assert_eq!([found(0, false), found(0, true), found(1, true)], [1, 0, 1]);
    });
}
