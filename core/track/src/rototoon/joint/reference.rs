//! A joint choice that adds up its costs plainly and keeps nothing, beside the one with tables.

use super::companion::{self, Companions};
use super::contender::{Contender, Paths, State};
use super::cost::Scene;
use super::moves::{Changes, LEAST_GAIN, Move};
use super::shadow::{Memory, Shadows};
use super::tests::{bar, hypothesis, model, turned};
use super::{Bonds, ROUNDS, choose, tie};
use crate::rototoon::pool::Pools;
use crate::rototoon::propagate::Model;
use crate::shared::drawings::Drawing;
use proptest::prelude::*;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, Span};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A part: its drawings on five frames, its models, and its hypotheses.
struct Cast {
    drawings: Vec<Drawing>,
    models: [Model; 2],
    pools: Arc<Pools>,
    depths: BTreeMap<FrameNumber, f64>,
}

/// Shift and look of each hypothesis on a drawing.
type Places = Vec<(f64, f64)>;

/// A bar near the others. Some parts hold a drawing for two frames, and some have another depth from a frame on.
fn cast((x, held, from): (f64, bool, FrameNumber), places: &[Places; 3]) -> Cast {
    let shape = turned(&bar(), 0.0, Point::new(200.0 + x, 200.0));
    let models = [0, 1].map(|_| model(&shape, (0.0, Point::new(3.0, 0.0))));
    let frames = if held { vec![(0, 0), (1, 2), (3, 3), (4, 4)] } else { (0..5).map(|i| (i, i)).collect() };
    let drawings: Vec<Drawing> = frames.into_iter().map(|(first, last)| Drawing { first, last }).collect();
    let at = |x: f64, look: f64| hypothesis(&models[0], 0.2 * x, Point::new(x, 0.3 * x), look as f32);
    let last = drawings.len() - 1;
    let pool = |d: usize| match d {
        d if d == 0 || d == last => vec![at(0.0, 0.0)],
        d => places[d % 3].iter().map(|&(x, look)| at(x, look)).collect(),
    };
    let pools = Arc::new((0..=last).map(pool).collect());
    let depths = (from..12).map(|frame| (frame, 1.5 - 0.1 * x)).collect();
    Cast { drawings, models, pools, depths }
}

fn contenders(casts: &[Cast]) -> Vec<Contender<'_>> {
    let mut all = Vec::new();
    for (part, Cast { drawings, models, pools, depths }) in casts.iter().enumerate() {
        let (span, depth) = (Span { first: 7, last: 11 }, part as f64);
        all.push(Contender { part, span, depth, depths, hides: true, drawings, pools, models });
    }
    all
}

/// The paths with another choice.
fn with(paths: &Paths, (c, (d, h)): (usize, State)) -> Vec<Vec<usize>> {
    let mut other = paths.to_vec();
    other[c][d] = h;
    other
}

/// Cost of a state without motion: its own fit, and the fit and the bonds of the others that depend on it, but for one.
fn alone(scene: &Scene, c: usize, state: State, paths: &Paths, but: Option<usize>) -> f64 {
    let paths = with(paths, (c, state));
    let mut cost = scene.look(c, state, &paths);
    for (far, own) in scene.contenders.iter().enumerate().filter(|(far, _)| Some(*far) != but) {
        for (e, &h) in paths[far].iter().enumerate() {
            let shown = scene.contenders[c].drawing_at(own.frame_of(e)) == Some(state.0);
            if shown && scene.shadows.in_front_of(far).contains(&c) {
                cost += scene.look(far, (e, h), &paths);
            }
        }
        for tie in scene.ties.iter().filter(|tie| tie.other(c).is_some_and(|(other, _)| other == far)) {
            let near = own.drawing_at(scene.contenders[c].frame_of(state.0));
            cost += near.map_or(0.0, |near| scene.joint(tie, (c, state), (far, (near, paths[far][near]))));
        }
        for (k, pair) in scene.companions.pairs.iter().enumerate().filter(|(_, pair)| pair.other(c) == Some(far)) {
            let Some(near) = own.drawing_at(scene.contenders[c].frame_of(state.0)) else { continue };
            let there = (near, paths[far][near]);
            let [part, body] = if pair.parts[0] == c { [state, there] } else { [there, state] };
            cost += scene.companions.cost(k, part, body);
        }
    }
    cost
}

/// Cost of the states of two contenders with the same drawings, without motion. For the others, each of them is beside the other one's
/// place on the paths.
fn both(scene: &Scene, [a, b]: [(usize, State); 2], paths: &Paths) -> f64 {
    let places = with(&with(paths, a), b);
    let rest = |(c, state): (usize, State), other: usize| {
        alone(scene, c, state, paths, Some(other)) - scene.look(c, state, &with(paths, (c, state)))
    };
    let between = scene.bonds_between((a.0, a.1.0), &[a.1.1], (b.0, b.1.0), &[b.1.1]);
    let looks = [a, b].map(|(c, state)| scene.look(c, state, &places));
    looks.iter().sum::<f64>() + rest(a, b.0) + rest(b, a.0) + between[0]
}

/// The joint choice, one move after the other.
fn one_by_one(scene: &Scene, moves: &[Vec<usize>], mut paths: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    for _ in 0..ROUNDS {
        let before = paths.clone();
        for who in moves {
            let changes = Changes::none(&paths);
            if let (Some(new), _) = scene.proposal(&Move::new(scene, who.clone()), &paths, &changes) {
                new.into_iter().for_each(|(c, path)| paths[c] = path);
            }
        }
        if paths == before {
            break;
        }
    }
    paths
}

fn places() -> impl Strategy<Value = [Places; 3]> {
    prop::array::uniform3(prop::collection::vec((-60.0f64..60.0, 0.0f64..0.05), 1..8))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn tables_hold_what_each_state_costs(
        parts in prop::collection::vec((-40.0f64..40.0, any::<bool>(), 7i32..16), 3..5),
        all in prop::collection::vec(places(), 5),
        choice in 0usize..100,
    ) {
        let casts: Vec<Cast> = parts.iter().zip(&all).map(|(part, places)| cast(*part, places)).collect();
        let contenders = contenders(&casts);
        let paths: Vec<Vec<usize>> =
            casts.iter().map(|cast| cast.pools.iter().map(|pool| choice % pool.len()).collect()).collect();
        let mut memory = Memory::default();
        let shadows = Shadows::cast(&contenders, &mut memory);
        let pairs = companion::find(&contenders, &paths, &|_, _| false);
        let companions = Companions::new(&contenders, &pairs);
        let (ties, lengths) = (tie::find(&contenders), memory.lengths(&contenders));
        let scene = Scene {
            contenders: &contenders, shadows: &shadows, ties: &ties, companions: &companions,
            jump: 0.0, lengths: &lengths, figure: None,
        };
        for (c, own) in contenders.iter().enumerate() {
            for (d, pool) in own.pools.iter().enumerate() {
                let states: Vec<usize> = (0..pool.len()).collect();
                for but in [None, Some(1)].into_iter().filter(|but| *but != Some(c)) {
                    for (h, cost) in scene.alone((c, d), &states, &paths, but).into_iter().enumerate() {
                        let plain = alone(&scene, c, (d, h), &paths, but);
                        prop_assert!((cost - plain).abs() < 1e-12, "{cost}, plainly {plain}");
                    }
                }
                let near = (c + 1) % contenders.len();
                if contenders[near].drawings == own.drawings && near > c {
                    let others: Vec<usize> = (0..contenders[near].pools[d].len()).collect();
                    let looks = scene.looks_beneath((c, d), &states, (near, &others), &paths);
                    for (k, look) in looks.into_iter().enumerate() {
                        let (h, n) = (k / others.len(), k % others.len());
                        let plain = scene.look(c, (d, h), &with(&paths, (near, (d, n))));
                        prop_assert!((look - plain).abs() < 1e-12);
                    }
                    let pairs = scene.pair_costs([c, near], d, [&states, &others], &paths);
                    for (k, cost) in pairs.into_iter().enumerate() {
                        let plain = both(&scene, [(c, (d, k / others.len())), (near, (d, k % others.len()))], &paths);
                        prop_assert!((cost - plain).abs() < 1e-12, "{cost}, plainly {plain}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_moves_keep_does_not_change_the_choice(
        parts in prop::collection::vec((-40.0f64..40.0, any::<bool>(), 7i32..16), 2..6),
        all in prop::collection::vec(places(), 6),
    ) {
        let casts: Vec<Cast> = parts.iter().zip(&all).map(|(part, places)| cast(*part, places)).collect();
        let contenders = contenders(&casts);
        let paths: Vec<Vec<usize>> = casts.iter().map(|cast| vec![0; cast.pools.len()]).collect();
        let pairs = companion::find(&contenders, &paths, &|_, _| false);
        let bonds = Bonds { ties: tie::find(&contenders), companions: pairs, canvas: None };
        let mut memory = Memory::default();
        let free = vec![true; contenders.len()];
        let chosen = choose(&contenders, &bonds, 1.0, (paths.clone(), &free), &mut memory);
        let again = choose(&contenders, &bonds, 1.0, (paths.clone(), &free), &mut memory);
        prop_assert_eq!(&chosen, &again, "what the memory keeps does not change the choice");
        let shadows = Shadows::cast(&contenders, &mut Memory::default());
        let (companions, lengths) = (Companions::new(&contenders, &bonds.companions), memory.lengths(&contenders));
        let scene = Scene {
            contenders: &contenders, shadows: &shadows, ties: &bonds.ties, companions: &companions,
            jump: 1.0, lengths: &lengths, figure: None,
        };
        let same = |far: usize, near: usize| contenders[far].drawings == contenders[near].drawings;
        let together = shadows.pairs().into_iter().filter(|&(far, near)| same(far, near)).map(|(far, near)| vec![far, near]);
        let moves: Vec<Vec<usize>> = (0..contenders.len()).map(|c| vec![c]).chain(together).collect();
        let mut backwards = moves.clone();
        backwards.reverse();
        backwards.sort_by_key(Vec::len);
        let [first, second] = [moves, backwards].map(|moves| one_by_one(&scene, &moves, paths.clone()));
        let plain = if scene.gain(&first, &second) > LEAST_GAIN { second } else { first };
        prop_assert_eq!(plain, chosen);
    }
}
