//! Fragmented drawings: lines that are cut into strokes in different ways on the two drawings.
//!
//! Stroke by stroke such drawings cannot be matched: the pieces have no counterparts. So the pieces are put together
//! first ([`super::joins`]), on each drawing for itself, and the chains are matched like strokes. Both matchings are made
//! where the one by strokes leaves much ink without a sure counterpart. The one is kept whose counterparts resemble each
//! other more in shape and length. Confidence does not decide that: the pieces of a contour can be surely matched with
//! wrong ones, and whole contours unsurely with the right ones, where two limbs look alike.

use super::super::chain::{Chain, Joined};
use super::super::stroke::Stroke;
use super::outline::Outline;
use super::{Chained, Fixed, InPieces, Matching, MatchingError, Options, Pair, joins, start, stroke_by_stroke};
use rototoon_base::scene::{Progress, Silent};
use std::collections::BTreeSet;

/// A matching with this share of both drawings' ink matched surely is not tried again.
const SURE: f64 = 0.9;
/// Confidence of a stroke that is in pieces on one drawing.
const IN_PIECES: f64 = 0.8;
/// Largest costs of a join that are tried: few joins are wrong where only cheap ones are made, and few lines stay in
/// pieces where dear ones are made too.
const JOINS: [f64; 2] = [1.2, 0.5];
/// The chains must resemble each other this much more.
const GAIN: f64 = 0.02;
/// Cost of a length that differs by the factor e, beside the cost of 1 of an entirely different shape.
const LENGTH: f64 = 0.5;
/// Samples along a line at which the strokes that meet are read.
const SAMPLES: usize = 256;

/// The matching, or the one of the chains if that is surer.
pub(super) fn surer(
    first: &[Stroke],
    second: &[Stroke],
    fixed: &[Fixed],
    matching: Matching,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Matching, MatchingError> {
    let matching = with_rings(matching, (first, second));
    let sure = matching.sureness(first, second);
    if sure >= SURE {
        return Ok(matching);
    }
    let taken: BTreeSet<usize> =
        fixed.iter().filter_map(|fixed| if let Fixed::To(j) = fixed { Some(*j) } else { None }).collect();
    let mut best = (matching.likeness(first, second) + GAIN, matching);
    for most in JOINS {
        let a = joins::chains(first, &|i| fixed[i] == Fixed::Free, most);
        let b = joins::chains(second, &|j| !taken.contains(&j), most);
        if a.len() == first.len() && b.len() == second.len() {
            continue;
        }
        progress.report("matching strokes", 0.95)?;
        let found = by_chains((first, &a), (second, &b), fixed, options)?;
        let likeness = found.likeness(first, second);
        if likeness > best.0 {
            best = (likeness, found);
        }
    }
    Ok(best.1)
}

/// The matching of two drawings' chains, as one of their strokes.
fn by_chains(
    (first, a): (&[Stroke], &[Chain]),
    (second, b): (&[Stroke], &[Chain]),
    fixed: &[Fixed],
    options: &Options,
) -> Result<Matching, MatchingError> {
    let of = |chains: &[Chain], strokes: &[Stroke]| chains.iter().map(|c| c.joined(strokes)).collect::<Vec<_>>();
    let (on_a, on_b) = (of(a, first), of(b, second));
    let fixed: Vec<Fixed> = a.iter().map(|chain| of_chain(chain, fixed, b)).collect();
    let lines = |joined: &[Joined]| joined.iter().map(|j| j.line.clone()).collect::<Vec<_>>();
    let found = stroke_by_stroke(&lines(&on_a), &lines(&on_b), &fixed, options, &Silent)?;
    Ok(unfolded(&found, (a, &on_a), (b, &on_b), (first, second)))
}

/// The matching with closed strokes that are in pieces as pairs of lines: these know where the first piece begins.
fn with_rings(mut matching: Matching, (first, second): (&[Stroke], &[Stroke])) -> Matching {
    let pair = Pair { from: 0, to: 0, reversed: false, start: 0.0, confidence: IN_PIECES, by_hand: false };
    let ring = |whole: usize| Chain::single(whole, true);
    let line = |part: &InPieces| Chain::open(&part.pieces);
    let lines = |a: Chain, b: Chain| {
        let joined = (a.joined(first), b.joined(second));
        chained((&a, &joined.0), (&b, &joined.1), &pair, (first, second))
    };
    for part in matching.split.extract_if(.., |part| first[part.whole].closed) {
        matching.chained.push(lines(ring(part.whole), line(&part)));
    }
    for part in matching.joined.extract_if(.., |part| second[part.whole].closed) {
        matching.chained.push(lines(line(&part), ring(part.whole)));
    }
    matching
}

/// The user's decision about a chain: only chains of one stroke have one.
fn of_chain(chain: &Chain, fixed: &[Fixed], others: &[Chain]) -> Fixed {
    match fixed[chain.pieces[0].0] {
        Fixed::To(j) => others.iter().position(|other| other.pieces[0].0 == j).map_or(Fixed::Free, Fixed::To),
        decision => decision,
    }
}

/// The matching of chains as one of their strokes.
fn unfolded(
    found: &Matching,
    (a, on_a): (&[Chain], &[Joined]),
    (b, on_b): (&[Chain], &[Joined]),
    strokes: (&[Stroke], &[Stroke]),
) -> Matching {
    let mut result = Matching::default();
    let lone = |chain: &Chain| (chain.pieces.len() == 1).then(|| chain.pieces[0].0);
    let alike = |pair: &Pair| a[pair.from].closed == b[pair.to].closed;
    let both_open = |pair: &Pair| !a[pair.from].closed && !b[pair.to].closed;
    for pair in &found.pairs {
        match (lone(&a[pair.from]), lone(&b[pair.to])) {
            (Some(from), Some(to)) if pair.by_hand || alike(pair) => result.pairs.push(Pair { from, to, ..*pair }),
            (Some(whole), None) if both_open(pair) => result.split.push(in_pieces(whole, &b[pair.to], pair.reversed)),
            (None, Some(whole)) if both_open(pair) => {
                result.joined.push(in_pieces(whole, &a[pair.from], pair.reversed))
            }
            _ => {
                let lines = ((&a[pair.from], &on_a[pair.from]), (&b[pair.to], &on_b[pair.to]));
                result.chained.push(chained(lines.0, lines.1, pair, strokes));
            }
        }
    }
    let whole = |chains: &[Chain], pieces: &[Chain], part: &InPieces| -> Option<InPieces> {
        let whole = lone(&chains[part.whole])?;
        let along = part.pieces.iter().map(|&(piece, against)| Some((lone(&pieces[piece])?, against)));
        Some(InPieces { whole, pieces: along.collect::<Option<_>>()? })
    };
    result.split.extend(found.split.iter().filter_map(|part| whole(a, b, part)));
    result.joined.extend(found.joined.iter().filter_map(|part| whole(b, a, part)));
    let [first, second] = result.named();
    let left = |chains: &[Chain], named: Vec<usize>| -> Vec<usize> {
        let named: BTreeSet<usize> = named.into_iter().collect();
        let all: BTreeSet<usize> = chains.iter().flat_map(|chain| &chain.pieces).map(|piece| piece.0).collect();
        all.difference(&named).copied().collect()
    };
    (result.vanished, result.appeared) = (left(a, first), left(b, second));
    result.pairs.sort_by_key(|pair| pair.from);
    result.split.sort_by_key(|part| part.whole);
    result.joined.sort_by_key(|part| part.whole);
    result
}

/// The pieces of a chain in the order and direction of the stroke that is whole.
fn in_pieces(whole: usize, chain: &Chain, reversed: bool) -> InPieces {
    let mut pieces = chain.pieces.clone();
    if reversed {
        pieces.reverse();
        pieces.iter_mut().for_each(|piece| piece.1 = !piece.1);
    }
    InPieces { whole, pieces }
}

/// The pair of two chains. If only one of the lines is closed, the other one was compared as a closed line too, and is
/// taken as one.
fn chained(a: (&Chain, &Joined), b: (&Chain, &Joined), pair: &Pair, strokes: (&[Stroke], &[Stroke])) -> Chained {
    let (line_a, line_b) = (&a.1.line, &b.1.line);
    let (mut first, mut second) = (a.0.clone(), b.0.clone());
    let (mut reversed, mut start) = (pair.reversed, pair.start);
    if line_a.closed != line_b.closed {
        (first.closed, second.closed) = (true, true);
        let ring = |line: &Stroke| Stroke { closed: true, ..line.clone() };
        let (one, other) = (ring(line_a), ring(line_b));
        let outlines = (Outline::new(&one, true), Outline::new(&other, true));
        if let (Some(p), Some(q)) = outlines
            && let Some(way) = p.ways(&q, 0.0, 0.1).first()
        {
            (reversed, start) = (way.reversed, start::refined(&one, &other, way.start, way.reversed));
        }
    }
    let meetings = meetings(&first.joined(strokes.0), &second.joined(strokes.1), reversed, start);
    let meetings = meetings.into_iter().map(|(m, n)| (first.pieces[m].0, second.pieces[n].0)).collect();
    Chained { first, second, reversed, start, confidence: pair.confidence, meetings }
}

/// Which pieces of two lines share a stretch, along the first line.
fn meetings(a: &Joined, b: &Joined, reversed: bool, start: f64) -> Vec<(usize, usize)> {
    let meet = |k: usize| {
        let share = (k as f64 + 0.5) / SAMPLES as f64;
        let along = match (a.line.closed, reversed) {
            (true, false) => (start + share).rem_euclid(1.0),
            (true, true) => (start - share).rem_euclid(1.0),
            (false, true) => 1.0 - share,
            (false, false) => share,
        };
        (a.piece_at(share), b.piece_at(along))
    };
    let mut seen = BTreeSet::new();
    (0..SAMPLES).map(meet).filter(|met| seen.insert(*met)).collect()
}

impl Matching {
    /// The strokes of both drawings that are matched.
    pub(crate) fn named(&self) -> [Vec<usize>; 2] {
        let wholes = |list: &[InPieces]| list.iter().map(|s| s.whole).collect::<Vec<_>>();
        let pieces = |list: &[InPieces]| list.iter().flat_map(|s| s.pieces.iter().map(|p| p.0)).collect::<Vec<_>>();
        let links = |side: fn(&Chained) -> &Chain| {
            self.chained.iter().flat_map(move |c| side(c).pieces.iter().map(|p| p.0)).collect::<Vec<_>>()
        };
        let first = self.pairs.iter().map(|p| p.from).chain(wholes(&self.split)).chain(pieces(&self.joined));
        let second = self.pairs.iter().map(|p| p.to).chain(wholes(&self.joined)).chain(pieces(&self.split));
        [first.chain(links(|c| &c.first)).collect(), second.chain(links(|c| &c.second)).collect()]
    }

    /// The share of both drawings' ink that is matched, weighted by confidence, 0 to 1. A drawing without ink counts as
    /// matched, and so does ink that a person left without counterpart.
    pub fn sureness(&self, first: &[Stroke], second: &[Stroke]) -> f64 {
        let (mut a, mut b) = (vec![0.0f64; first.len()], vec![0.0f64; second.len()]);
        for pair in &self.pairs {
            let sure = if pair.by_hand { 1.0 } else { pair.confidence };
            (a[pair.from], b[pair.to]) = (sure, sure);
        }
        for part in &self.split {
            a[part.whole] = IN_PIECES;
            part.pieces.iter().for_each(|piece| b[piece.0] = IN_PIECES);
        }
        for part in &self.joined {
            b[part.whole] = IN_PIECES;
            part.pieces.iter().for_each(|piece| a[piece.0] = IN_PIECES);
        }
        for line in &self.chained {
            line.first.pieces.iter().for_each(|piece| a[piece.0] = line.confidence);
            line.second.pieces.iter().for_each(|piece| b[piece.0] = line.confidence);
        }
        self.alone[0].iter().for_each(|&i| a[i] = 1.0);
        self.alone[1].iter().for_each(|&j| b[j] = 1.0);
        0.5 * (weighted(first, &a) + weighted(second, &b))
    }
}

impl Matching {
    /// How much counterparts resemble each other in shape and length, 0 to 1, weighted by their ink. Ink without a
    /// counterpart counts 0.
    pub(crate) fn likeness(&self, first: &[Stroke], second: &[Stroke]) -> f64 {
        let single = |stroke: usize, strokes: &[Stroke]| Chain::single(stroke, strokes[stroke].closed);
        let line = |part: &InPieces| Chain::open(&part.pieces);
        let pairs = self.pairs.iter().map(|p| (single(p.from, first), single(p.to, second)));
        let split = self.split.iter().map(|part| (single(part.whole, first), line(part)));
        let joined = self.joined.iter().map(|part| (line(part), single(part.whole, second)));
        let chained = self.chained.iter().map(|c| (c.first.clone(), c.second.clone()));
        let ink = |chain: &Chain, strokes: &[Stroke]| chain.pieces.iter().map(|p| strokes[p.0].length()).sum::<f64>();
        let total = |strokes: &[Stroke]| strokes.iter().map(Stroke::length).sum::<f64>().max(f64::MIN_POSITIVE);
        let (total_a, total_b) = (total(first), total(second));
        let of = |(a, b): (Chain, Chain)| {
            let share = 0.5 * (ink(&a, first) / total_a + ink(&b, second) / total_b);
            share * alike(&a.joined(first).line, &b.joined(second).line)
        };
        pairs.chain(split).chain(joined).chain(chained).map(of).sum()
    }
}

/// How much two lines resemble each other in shape and length, 0 to 1.
fn alike(a: &Stroke, b: &Stroke) -> f64 {
    let closed = a.closed || b.closed;
    let (Some(p), Some(q)) = (Outline::new(a, closed), Outline::new(b, closed)) else { return 0.0 };
    let Some(way) = p.ways(&q, 0.0, 0.0).into_iter().next() else { return 0.0 };
    let length = (p.length.max(1.0) / q.length.max(1.0)).ln().abs();
    (1.0 - way.residual.sqrt() - LENGTH * length).max(0.0)
}

fn weighted(strokes: &[Stroke], sure: &[f64]) -> f64 {
    let lengths: Vec<f64> = strokes.iter().map(Stroke::length).collect();
    let total: f64 = lengths.iter().sum();
    if total > 0.0 { lengths.iter().zip(sure).map(|(length, sure)| length * sure).sum::<f64>() / total } else { 1.0 }
}
