//! The same strokes on every drawing, measured exactly: drawn characters whose strokes are known.

use super::characters::{Character, Manner, cat, drawn, flower, look, penguin, right, strokes, walker};
use rototoon_lines::{Key, Tracked, between, carry};
use std::convert::Infallible;

/// Asked share of the strokes' length that lies on the stroke with the right number.
const SHARE: f64 = 0.95;
/// Drawings from one key to the next.
const SPAN: u32 = 6;
/// Drawings over which strokes are carried from one key.
const OUTWARD: u32 = 4;

/// Distance at which a line is on its stroke, in pixels: what the lines of these manners wander, and a pixel.
fn reach(manner: Manner) -> f64 {
    if manner == Manner::Clean { 2.0 } else { 3.5 }
}

/// Over four characters, each clean, in pencil and with boil, the least of these shares is 0.960. Half of the twelve are
/// tested, for time.
///
/// From one drawing outward over four; and between two drawn keys, where the strokes of the second key get their numbers
/// from what was carried there, and each drawing is bound to both.
fn check(name: &str, character: Character, manner: Manner) {
    let at = |drawing: u32| character(f64::from(drawing));
    let ink = |drawing: u32| look(&at(drawing), manner, drawing);
    let parts = at(0);
    let known = strokes(&parts);
    let first =
        Key { drawing: ink(0), drawn: drawn(&parts, &known), beside: Vec::new(), by_hand: (0..known.len()).collect() };
    let share = |drawing: u32, now: &[Tracked]| right(now, &at(drawing), &known, reach(manner));

    let (mut from, mut now, mut next) = (ink(0), first.all(), 1000);
    let outward = (1..=OUTWARD).map(|drawing| {
        let to = ink(drawing);
        now = carry(&from, &now, &to, &mut next);
        from = to;
        share(drawing, &now)
    });
    let outward: Vec<f64> = outward.collect();

    let key = at(SPAN);
    let key = drawn(&key, &strokes(&key)).into_iter().map(|tracked| tracked.stroke).collect();
    let mut look = |place: usize| Ok::<_, Infallible>(ink(place as u32));
    let Ok((found, _)) = between(&first, SPAN as usize - 1, &mut look, key, &mut 1000);
    let between: Vec<f64> = (1..SPAN).zip(&found).map(|(drawing, now)| share(drawing, now)).collect();
    println!("{name} {manner:?}: outward {outward:.3?}, between keys {between:.3?}");
    assert!(outward.iter().chain(&between).all(|&s| s >= SHARE), "{name} {manner:?}: {outward:.3?} {between:.3?}");
}

#[test]
fn a_penguin_in_clean_lines() {
    check("penguin", penguin, Manner::Clean);
}

#[test]
fn a_penguin_in_pencil() {
    check("penguin", penguin, Manner::Rough);
}

#[test]
fn a_walker_in_clean_lines() {
    check("walker", walker, Manner::Clean);
}

#[test]
fn a_walker_whose_lines_boil() {
    check("walker", walker, Manner::Boil);
}

#[test]
fn a_cat_whose_lines_boil() {
    check("cat", cat, Manner::Boil);
}

#[test]
fn a_flower_in_pencil() {
    check("flower", flower, Manner::Rough);
}

#[test]
fn drawings_that_have_nothing_to_do_with_each_other_share_no_stroke() {
    let all: [Character; 4] = [penguin, walker, cat, flower];
    for (k, character) in all.into_iter().enumerate() {
        let (parts, other) = (character(0.0), all[(k + 1) % 4](0.0));
        let (from, to) = (look(&parts, Manner::Clean, 0), look(&other, Manner::Clean, 0));
        let mut next = 1000;
        let found = carry(&from, &drawn(&parts, &strokes(&parts)), &to, &mut next);
        assert!(found.iter().all(|s| s.track >= 1000), "{k}: {:?}", found.iter().map(|s| s.track).collect::<Vec<_>>());
        assert!(found.len() > 5, "{k}: the drawing is traced anew");
    }
}
