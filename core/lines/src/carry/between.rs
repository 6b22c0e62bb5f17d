//! Strokes between two drawings of the artist, which bind the drawings between them from both sides.
//!
//! 1. The strokes of the first key are carried forwards up to the second key. The strokes drawn there get their numbers
//!    from those that came ([`identify`]).
//! 2. The strokes of the second key are carried backwards.
//! 3. Each drawing between is [bound](bind()): the nearer key knows better how the drawing looks, so its strokes come
//!    first. Those that only the farther key has come next, and then those that neither key has: they began on the way.
//!
//! A stroke may be lost on the way to the second key. The stroke drawn there then has another number, until it meets the
//! lost one on its way back. There it takes that number, on all drawings
//! that do not have it already.
//!
//! What began on the way gets its number forwards only, so a line that neither key has is one stroke on all drawings. It
//! also goes on behind the second key. A stroke that the first key has and the second one lacks has ended there.
//!
//! Where the two sides put a stroke on different lines, it was taken for another one on the way or on a key. The line that [lost](bind()) the
//! number has a new one there. Ink that nobody explains in the end begins new strokes. Both are followed backwards, as long as nobody else
//! explains their ink.
//!
//! Pictures are looked at twice, in order and back, so that no more than two are in memory. The time is twice that of
//! carrying from one side.

use super::bind::{Bound, bind};
use super::identify::{identify, identify_seen};
use super::shown::{Shown, is_same};
use super::{EXPLAINS, carry, carry_known, covered, of_stroke, rest};
use crate::drawing::Drawing;
use crate::stroke::{Stroke, Tracked};
use std::collections::{BTreeMap, BTreeSet};

/// Length of the shortest line that begins between two keys where neither side explains it, at 540 lines, added to the width.
const LONG: f64 = 12.0;

/// A drawing with its strokes.
pub struct Key {
    /// The drawing.
    pub drawing: Drawing,
    /// The strokes that the artist drew.
    pub drawn: Vec<Tracked>,
    /// Strokes that began on the way here and that the artist did not draw. They are not on this drawing, but go on behind it.
    pub beside: Vec<Tracked>,
    /// The numbers of strokes that an artist drew here or on a key before.
    pub by_hand: BTreeSet<usize>,
}

impl Key {
    /// All strokes that go on from here.
    pub fn all(&self) -> Vec<Tracked> {
        self.drawn.iter().chain(&self.beside).cloned().collect()
    }
}

/// Carries strokes from the key `first` to a second key, on which `drawn` were drawn, with `count` drawings between them.
/// `look` gives a drawing by its place, 1 to `count`, and `count` + 1 for the second key. Returns the strokes of the
/// drawings between, in order, and the second key. New strokes get numbers from `next` on, which is raised.
///
/// # Errors
///
/// The first error of `look`.
pub fn between<E>(
    first: &Key,
    count: usize,
    look: &mut dyn FnMut(usize) -> Result<Drawing, E>,
    drawn: Vec<Stroke>,
    next: &mut usize,
) -> Result<(Vec<Vec<Tracked>>, Key), E> {
    let mut forwards: Vec<Vec<Tracked>> = Vec::with_capacity(count);
    // The last drawing that shows any strokes, and these.
    let mut before: Option<Drawing> = None;
    let mut last = first.all();
    for place in 1..=count {
        let drawing = look(place)?;
        let carried = carry(before.as_ref().unwrap_or(&first.drawing), &last, &drawing, next);
        if !carried.is_empty() {
            (before, last) = (Some(drawing), carried.clone());
        }
        forwards.push(carried);
    }
    let drawing = look(count + 1)?;
    let came = carry(before.as_ref().unwrap_or(&first.drawing), &last, &drawing, next);
    drop(before);
    bound(first, (forwards, came), look, (drawing, drawn), next)
}

/// The way back of [`between()`], for who has carried all strokes of the key `first` [forwards](carry): to the drawings between, and to the second key, on
/// whose `drawing` `drawn` were drawn. It looks at the drawings between once.
///
/// # Errors
///
/// The first error of `look`.
pub fn bound<E>(
    first: &Key,
    (forwards, came): (Vec<Vec<Tracked>>, Vec<Tracked>),
    look: &mut dyn FnMut(usize) -> Result<Drawing, E>,
    (drawing, drawn): (Drawing, Vec<Stroke>),
    next: &mut usize,
) -> Result<(Vec<Vec<Tracked>>, Key), E> {
    let known: BTreeSet<usize> = first.drawn.iter().map(|s| s.track).collect();
    let mut shown = Shown::default();
    shown.learn(&first.drawn, &first.drawing);
    shown.learn_drawn(first.by_hand.iter().copied());
    let drawn = identify_seen(&shown.of(&came, &drawing), &came, drawn, drawing.unit, next);
    shown.learn(&drawn, &drawing);
    shown.learn_drawn(drawn.iter().map(|s| s.track));
    let began = came.into_iter().filter(|s| !known.contains(&s.track)).collect();
    let beside = bind([drawn.clone(), began], &drawing).strokes.split_off(drawn.len());
    let by_hand = first.by_hand.iter().copied().chain(drawn.iter().map(|s| s.track)).collect();
    let second = Key { drawing, drawn, beside, by_hand };
    let late = Late { next, numbers: BTreeSet::new(), lost: BTreeMap::new(), strokes: Vec::new() };
    let found = Vec::with_capacity(forwards.len());
    let mut back = Backwards { known: &known, first: &first.drawing, second, found, shown, seen: Vec::new(), late };
    back.run(forwards, look)?;
    Ok((back.seen(), back.second))
}

/// The way back from the second key.
struct Backwards<'a> {
    /// The numbers of the first key.
    known: &'a BTreeSet<usize>,
    first: &'a Drawing,
    second: Key,
    /// The strokes of the drawings between, from the last one on.
    found: Vec<Vec<Tracked>>,
    shown: Shown,
    /// As far as the drawings show them, with their places.
    seen: Vec<Vec<(usize, Tracked)>>,
    late: Late<'a>,
}

/// Strokes that neither key has and that did not come from the first one.
struct Late<'a> {
    /// The next new number.
    next: &'a mut usize,
    /// Their numbers.
    numbers: BTreeSet<usize>,
    /// The numbers of lines that lost theirs: by whether they came from the second key, and by the lost number.
    lost: BTreeMap<(bool, usize), usize>,
    /// Those on the last drawing that was bound.
    strokes: Vec<Tracked>,
}

impl Backwards<'_> {
    /// Carries the strokes of the second key back, and binds the drawings between. `forwards` has what came there from the
    /// first key.
    fn run<E>(
        &mut self,
        mut forwards: Vec<Vec<Tracked>>,
        look: &mut dyn FnMut(usize) -> Result<Drawing, E>,
    ) -> Result<(), E> {
        let count = forwards.len();
        let mut after: Option<Drawing> = None;
        let mut back = self.second.drawn.clone();
        while let Some(there) = forwards.pop() {
            // Where nothing comes from behind, as before a cut, what came from the front is all.
            let place = forwards.len() + 1;
            let drawing = look(place)?;
            if back.is_empty() {
                self.add(there, &drawing);
                continue;
            }
            let all = [&back[..], &self.late.strokes].concat();
            let come = carry_known(after.as_ref().unwrap_or(&self.second.drawing), &all, &drawing);
            if come.is_empty() && there.is_empty() {
                // A blank drawing. What is seen before it again has its numbers.
                self.seen.push(Vec::new());
                self.found.push(Vec::new());
                continue;
            }
            let late: Vec<Tracked>;
            (late, back) = come.into_iter().partition(|s| self.late.numbers.contains(&s.track));
            let renamed = self.met(&back, &there, &drawing);
            let mut there = vec![there];
            for strokes in forwards.iter_mut().chain(&mut self.found).chain(&mut there) {
                rename(strokes, &renamed);
            }
            for strokes in [&mut back, &mut self.second.drawn, &mut self.second.beside] {
                rename(strokes, &renamed);
            }
            let (there, began) = there.into_iter().flatten().partition(|s| self.known.contains(&s.track));
            let nearer_first = 2 * place <= count + 1;
            let [near, far] = if nearer_first { [there, back.clone()] } else { [back.clone(), there] };
            let bound = bind([near, far, began, late], &drawing);
            let bound = self.late.add(bound, !nearer_first, &drawing);
            self.add(bound, &drawing);
            after = Some(drawing);
        }
        Ok(())
    }

    /// Adds the strokes of a drawing.
    fn add(&mut self, mut strokes: Vec<Tracked>, drawing: &Drawing) {
        // What is the picture of a key has its strokes, which may lie off the ink.
        let is_key = is_same(drawing, self.first) || is_same(drawing, &self.second.drawing);
        self.seen.push(match is_key {
            true => strokes.iter().cloned().enumerate().collect(),
            false => self.late.own(&self.shown, &mut strokes, drawing),
        });
        self.found.push(strokes);
    }

    /// What the drawings between show, in order, with the numbers that were found in the end.
    fn seen(&mut self) -> Vec<Vec<Tracked>> {
        let all = self.found.iter().zip(std::mem::take(&mut self.seen)).rev();
        let of = |(strokes, seen): (&Vec<Tracked>, Vec<(usize, Tracked)>)| -> Vec<Tracked> {
            seen.into_iter().map(|(k, shown)| Tracked { track: strokes[k].track, ..shown }).collect()
        };
        all.map(of).collect()
    }

    /// The strokes of the second key that meet a lost stroke of the first one: their numbers, and those that they take.
    fn met(&self, back: &[Tracked], there: &[Tracked], drawing: &Drawing) -> BTreeMap<usize, usize> {
        let later = self.found.iter().flatten().chain(&self.second.drawn);
        let later: BTreeSet<usize> = later.map(|s| s.track).collect();
        let is_lost = |s: &&Tracked| self.known.contains(&s.track) && !later.contains(&s.track);
        let lost: Vec<Tracked> = there.iter().filter(is_lost).cloned().collect();
        let (numbers, lines): (Vec<usize>, Vec<Stroke>) =
            back.iter().filter(|s| !self.known.contains(&s.track)).map(|s| (s.track, s.stroke.clone())).unzip();
        let none = usize::MAX - lines.len();
        let found = identify(&lost, lines, drawing.unit, &mut none.clone());
        numbers.into_iter().zip(found).map(|(own, met)| (own, met.track)).filter(|&(_, met)| met < none).collect()
    }
}

impl Late<'_> {
    /// The strokes that a drawing shows, as its own lines. Those of nobody are added to `strokes`, and go on.
    fn own(&mut self, shown: &Shown, strokes: &mut Vec<Tracked>, drawing: &Drawing) -> Vec<(usize, Tracked)> {
        let known = strokes.len();
        let seen = shown.traced(strokes, drawing, self.next);
        self.numbers.extend(strokes[known..].iter().map(|stroke| stroke.track));
        self.strokes = strokes.iter().filter(|stroke| self.numbers.contains(&stroke.track)).cloned().collect();
        seen
    }

    /// Adds the lines that lost their numbers, and what nobody explains, to the strokes of a drawing. `second` says whether the first side
    /// came from the second key.
    fn add(&mut self, bound: Bound, second: bool, drawing: &Drawing) -> Vec<Tracked> {
        let Bound { mut strokes, apart } = bound;
        for (first, line) in apart {
            let track = *self.lost.entry((first == second, line.track)).or_insert_with(|| {
                *self.next += 1;
                *self.next - 1
            });
            if strokes.iter().all(|stroke| stroke.track != track) {
                strokes.push(Tracked { track, ..line });
                self.numbers.insert(track);
            }
        }
        let reach = EXPLAINS * drawing.unit + 0.5 * drawing.width;
        let least = LONG * drawing.unit + drawing.width;
        for rest in rest::left(drawing.lines(), &covered(strokes.iter().map(of_stroke), reach), reach, least) {
            strokes.push(Tracked::sure(*self.next, drawing.finished(&rest)));
            self.numbers.insert(*self.next);
            *self.next += 1;
        }
        self.strokes = strokes.iter().filter(|stroke| self.numbers.contains(&stroke.track)).cloned().collect();
        strokes
    }
}

/// Gives strokes other numbers. A stroke of a drawing that has the other number already keeps its own: both lie on ink.
fn rename(strokes: &mut [Tracked], renamed: &BTreeMap<usize, usize>) {
    let there: BTreeSet<usize> = strokes.iter().map(|s| s.track).collect();
    let free = |track: &usize| renamed.get(track).copied().filter(|other| !there.contains(other));
    strokes.iter_mut().for_each(|s| s.track = free(&s.track).unwrap_or(s.track));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;
    use rototoon_base::geometry::Point;
    use rototoon_base::scene::Raster;
    use std::sync::Arc;

    #[test]
    fn what_nobody_explains_is_new_and_a_line_that_lost_its_number_has_one_of_its_own() {
        let heights = [20usize, 50, 80];
        let ink = |x: usize, y: usize| (10..110).contains(&x) && heights.iter().any(|h| y.abs_diff(*h) < 2);
        let picture = Raster::from_fn(120, 100, |x, y| if ink(x, y) { [0.05; 3] } else { [1.0; 3] });
        let drawing = Drawing::new(Arc::new(picture), &Options::default());
        let line = |track: usize, y: f64| {
            let points = (0..34).map(|k| Point::new(10.5 + 3.0 * f64::from(k), y + 0.5)).collect();
            Tracked::sure(track, Stroke { points, ..Stroke::default() })
        };
        let mut next = 7;
        let mut late = Late { next: &mut next, numbers: BTreeSet::new(), lost: BTreeMap::new(), strokes: Vec::new() };
        let bound = || Bound { strokes: vec![line(1, 20.0)], apart: vec![(false, line(1, 50.0))] };
        let named = |strokes: &[Tracked]| -> Vec<(usize, f64)> {
            strokes.iter().map(|s| (s.track, s.stroke.points[0].y.round())).collect()
        };
        let found = named(&late.add(bound(), true, &drawing));
        assert_eq!(found.iter().map(|own| own.0).collect::<Vec<_>>(), [1, 7, 8]);
        assert!((found[1].1 - 50.0).abs() <= 1.0 && (found[2].1 - 80.0).abs() <= 1.0, "{found:?}");
        assert_eq!(late.strokes.len(), 2, "both go on");
        // On the next drawing the line has the same number, and one of the other side has another.
        let again = late.add(bound(), true, &drawing);
        assert_eq!(again[1].track, 7);
        let other = late.add(bound(), false, &drawing);
        assert_eq!(other[1].track, 10);
    }
}
