//! Strokes followed through all drawings.
//!
//! The pairs of neighbouring drawings are chained into tracks. A track follows the points of its stroke on the first
//! drawing that has it. If the next drawing has a stroke in pieces, each piece becomes a track of its own. It begins on
//! the part of the complete stroke from which it comes. If pieces join into one stroke, their tracks end on parts of
//! it. Lines in pieces on both drawings are followed by stretches ([`mod@chained`]).

use super::super::matching::{InPieces, Matching, Pair};
use super::super::stroke::Stroke;
use super::Key;
use super::chained;
use super::correspond::Places;
use rototoon_base::geometry::Point;

/// A stroke, or a part of one, on a key.
#[derive(Clone, Debug, PartialEq)]
pub struct Stand {
    /// Index of the stroke in the drawing.
    pub stroke: usize,
    /// Whether the track is only a part of the stroke on this key.
    pub part: bool,
    /// The places that are followed.
    pub places: Places,
}

/// A stroke followed through neighbouring drawings.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Index of the first key that has it.
    pub first: usize,
    /// One entry for that key and each following key that has it.
    pub stands: Vec<Stand>,
    /// Whether the last place joins the first.
    pub closed: bool,
}

impl Track {
    fn new(first: usize, stroke: usize, of: &Stroke) -> Self {
        let stand = Stand { stroke, part: false, places: Places::all(of) };
        Self { first, stands: vec![stand], closed: of.closed }
    }

    /// Index of the last key that has it.
    pub fn last(&self) -> usize {
        self.first + self.stands.len() - 1
    }

    /// Its stroke and places on a key; `None` where the key does not have it.
    pub fn at(&self, key: usize) -> Option<&Stand> {
        self.stands.get(key.checked_sub(self.first)?)
    }

    /// Its points on a key, in pixels.
    pub(super) fn points(&self, key: usize) -> Option<&Vec<Point>> {
        self.at(key).map(|stand| &stand.places.points)
    }
}

/// The tracks through drawings. `matchings[k]` pairs drawing k with the next one.
pub(super) fn chained(keys: &[Key], matchings: &[Matching]) -> Vec<Track> {
    let Some(first) = keys.first() else { return Vec::new() };
    let start = |k: usize, i: usize, key: &Key| Track::new(k, i, &key.strokes[i]);
    let mut tracks: Vec<Track> = (0..first.strokes.len()).map(|i| start(0, i, first)).collect();
    // The track of each stroke of the present drawing.
    let mut of: Vec<usize> = (0..tracks.len()).collect();
    for (k, matching) in matchings.iter().enumerate() {
        let (here, next) = (&keys[k], &keys[k + 1]);
        let mut of_next = vec![usize::MAX; next.strokes.len()];
        for pair in &matching.pairs {
            let track = of[pair.from];
            let Some(stand) = tracks[track].at(k) else { continue };
            let places = stand.places.on(&here.strokes[pair.from], &next.strokes[pair.to], pair);
            tracks[track].stands.push(Stand { stroke: pair.to, part: false, places });
            of_next[pair.to] = track;
        }
        for split in &matching.split {
            for (piece, places) in parts(&here.strokes[split.whole], split, &next.strokes) {
                let whole = Stand { stroke: split.whole, part: true, places: places.0 };
                let piece_stand = Stand { stroke: piece, part: false, places: places.1 };
                of_next[piece] = tracks.len();
                tracks.push(Track { first: k, stands: vec![whole, piece_stand], closed: false });
            }
        }
        for joined in &matching.joined {
            for (piece, places) in parts(&next.strokes[joined.whole], joined, &here.strokes) {
                let track = of[piece];
                let Some(stand) = tracks[track].at(k) else { continue };
                let places = on_part(stand, &here.strokes[piece], places.0);
                tracks[track].stands.push(Stand { stroke: joined.whole, part: true, places });
            }
        }
        for line in &matching.chained {
            let stretches = chained::stretches(&here.strokes, &next.strokes, line);
            let track = |stands: [Stand; 2]| Track { first: k, stands: stands.into(), closed: false };
            tracks.extend(stretches.into_iter().map(track));
        }
        for (j, track) in of_next.iter_mut().enumerate().filter(|(_, track)| **track == usize::MAX) {
            *track = tracks.len();
            tracks.push(start(k + 1, j, next));
        }
        of = of_next;
    }
    tracks
}

/// The tracks on drawing `base` and after it. Their places are the points of the strokes there. They are followed back
/// to earlier drawings as long as a stroke has one counterpart or was part of a stroke.
pub(super) fn around(keys: &[Key], matchings: &[Matching], base: usize) -> Vec<Track> {
    let mut tracks = chained(&keys[base..], &matchings[base..]);
    tracks.iter_mut().for_each(|track| track.first += base);
    for k in (0..base).rev() {
        let (before, here) = (&keys[k].strokes, &keys[k + 1].strokes);
        for track in tracks.iter_mut().filter(|track| track.first == k + 1) {
            let Some(stand) = track.stands.first().filter(|stand| !stand.part) else { continue };
            let i = stand.stroke;
            let back = matchings[k].pairs.iter().find(|pair| pair.to == i).map(|pair| Stand {
                stroke: pair.from,
                part: false,
                places: stand.places.on(&here[i], &before[pair.from], &inverse(pair)),
            });
            let whole = || matchings[k].split.iter().find(|split| split.pieces.iter().any(|piece| piece.0 == i));
            let part = || {
                let split = whole()?;
                let (_, (on_whole, _)) =
                    parts(&before[split.whole], split, here).into_iter().find(|part| part.0 == i)?;
                Some(Stand { stroke: split.whole, part: true, places: on_part(stand, &here[i], on_whole) })
            };
            if let Some(stand) = back.or_else(part) {
                track.stands.insert(0, stand);
                track.first = k;
            }
        }
    }
    tracks
}

/// The places of a track on a piece, mapped to the part of the complete stroke that the piece covers. `covered` is that
/// part, in the piece's order.
fn on_part(stand: &Stand, piece: &Stroke, covered: Places) -> Places {
    let ends = (covered.shares.first().copied().unwrap_or(0.0), covered.shares.last().copied().unwrap_or(1.0));
    let part = Stroke::new(covered.points, false);
    let straight = Pair { from: 0, to: 0, reversed: false, start: 0.0, confidence: 1.0, by_hand: false };
    let places = stand.places.on(piece, &part, &straight);
    let shares = places.shares.iter().map(|s| ends.0 + (ends.1 - ends.0) * s).collect();
    Places { points: places.points, shares, own: None }
}

/// The pair seen from the counterpart.
fn inverse(pair: &Pair) -> Pair {
    let start = if pair.reversed { pair.start } else { (1.0 - pair.start).rem_euclid(1.0) };
    Pair { from: pair.to, to: pair.from, start, ..*pair }
}

/// For each piece of a stroke: its index, the places of the complete stroke that it covers, and its own places. The
/// latter are its points, in its own order; the former have the same proportional lengths.
fn parts(whole: &Stroke, pieces: &InPieces, strokes: &[Stroke]) -> Vec<(usize, (Places, Places))> {
    let lengths: Vec<f64> = pieces.pieces.iter().map(|p| strokes[p.0].length()).collect();
    let total = lengths.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let mut walked = 0.0;
    let mut result = Vec::new();
    for (&(piece, reversed), length) in pieces.pieces.iter().zip(&lengths) {
        let (from, to) = (walked / total, (walked + length) / total);
        walked += length;
        let own = Places::all(&strokes[piece]);
        let ends = if reversed { (to, from) } else { (from, to) };
        result.push((piece, (Places::part(whole, ends.0, ends.1, &own.shares), Places { own: None, ..own })));
    }
    result
}
