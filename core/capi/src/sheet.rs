//! Stroke matching and in-betweens of drawings in flat arrays. `rototoon_match_strokes` and `rototoon_draw_in_betweens`
//! document the arrays.

use crate::asked::Asked;
use crate::status::Failure;
use crate::strokes::Strokes;
use crate::work::{GoOn, run};
use rototoon::memory;
use rototoon::pipeline::spans::{Drawn, DrawnSpan, Sheet, Wanted};
use rototoon::pipeline::{PipelineError, pegs_of, spacing_of};
use rototoon::scene::Progress;
use rototoon::tween::Stroke;
use rototoon::tween::between::{GivenPegs, Key};
use rototoon::tween::matching::{HandPair, InPieces, Matching};
use std::ops::Range;

/// The strokes of several drawings, one drawing after the other, and the pairs made by hand.
pub struct Drawings<'a> {
    /// The strokes of all drawings.
    pub strokes: Strokes<'a>,
    /// Three numbers per stroke, sRGB from 0 to 1, NaN if it has no colour; or empty.
    pub colours: &'a [f64],
    /// Material and layer of each stroke, -1 if it has none; or empty.
    pub labels: &'a [i32],
    /// Drawing `d` has the strokes `drawings[d]` to `drawings[d + 1]` (excluded).
    pub drawings: &'a [i32],
    /// The frame of each drawing; or empty.
    pub frames: &'a [i32],
    /// Pairs made by hand: a stroke and its counterpart in the next drawing. -1 in place of one: the other has none.
    pub by_hand: &'a [i32],
}

/// The matches of the strokes of each drawing with those of the next one.
#[derive(Default)]
pub struct RototoonMatches {
    /// Drawing `d` and the next one have the rows `offsets[d]` to `offsets[d + 1]` (excluded).
    pub offsets: Vec<i32>,
    /// Four numbers per row: kind, stroke of the earlier drawing, stroke of the later drawing, flags.
    pub rows: Vec<i32>,
    /// Two numbers per row: start and confidence.
    pub values: Vec<f64>,
}

/// In-betweens of several spans.
#[derive(Default)]
pub struct RototoonInBetweens {
    /// Span `s` has the frames `frame_offsets[s]` to `frame_offsets[s + 1]` (excluded).
    pub frame_offsets: Vec<i32>,
    /// By span: 1 if the earlier key is held because no movement can be believed, else 0.
    pub held: Vec<u8>,
    /// For each frame the share of the way between the keys, 0 to 1.
    pub shares: Vec<f64>,
    /// Span `s` has the strokes `stroke_offsets[s]` to `stroke_offsets[s + 1]` (excluded).
    pub stroke_offsets: Vec<i32>,
    /// For each stroke: the stroke of the earlier key, the stroke of the later key, and flags.
    pub strokes: Vec<i32>,
    /// Stroke `i` has the points `point_offsets[i]` to `point_offsets[i + 1]` (excluded).
    pub point_offsets: Vec<i32>,
    /// For each point and key, the two points of the key between which it comes from.
    pub indices: Vec<i32>,
    /// For each point and key, the weight of the second of these points.
    pub weights: Vec<f64>,
    /// x and y in pixels, by span, frame, stroke and point.
    pub points: Vec<f64>,
    /// Opacities, by span, frame and stroke.
    pub opacities: Vec<f64>,
}

/// The kinds of rows of [`RototoonMatches`].
pub mod kind {
    /// The two strokes correspond to each other.
    pub const ROTOTOON_PAIR: i32 = 0;
    /// The later stroke is a piece of the earlier one.
    pub const ROTOTOON_SPLIT: i32 = 1;
    /// The earlier stroke is a piece of the later one.
    pub const ROTOTOON_JOINED: i32 = 2;
    /// The earlier stroke has no counterpart.
    pub const ROTOTOON_VANISHED: i32 = 3;
    /// The later stroke has no counterpart.
    pub const ROTOTOON_APPEARED: i32 = 4;
    /// The two strokes are pieces of one line and share a stretch of it.
    pub const ROTOTOON_CHAINED: i32 = 5;
}

const REVERSED: i32 = 1;
const BY_HAND: i32 = 2;

impl Drawings<'_> {
    /// The range of each drawing's strokes. It is an error if the lengths of the arrays do not fit together.
    pub fn checked(&self) -> Result<Vec<Range<usize>>, Failure> {
        let count = self.strokes.checked()?;
        let wrong = |text: String| Err(Failure::Error(text));
        let rising = self.drawings.windows(2).all(|pair| pair[0] <= pair[1]);
        if self.drawings.first() != Some(&0) || !rising || self.drawings.last() != Some(&(count as i32)) {
            return wrong(format!("drawings: expected numbers from 0 to {count} that never fall"));
        }
        let drawings = self.drawings.len() - 1;
        for (name, found, expected) in [
            ("colours", self.colours.len(), 3 * count),
            ("labels", self.labels.len(), 2 * count),
            ("frames", self.frames.len(), drawings),
        ] {
            if found != 0 && found != expected {
                return wrong(format!("{name}: {found} values, expected {expected}"));
            }
        }
        Ok(self.drawings.windows(2).map(|pair| pair[0] as usize..pair[1] as usize).collect())
    }

    /// How many points the requested in-betweens have, or a few more.
    fn points_between(&self, asked: &Asked, ranges: &[Range<usize>]) -> u64 {
        let offsets = self.strokes.offsets;
        let of_drawing = |d: usize| ranges.get(d).map_or(0, |own| offsets[own.end].abs_diff(offsets[own.start]));
        let of_pair = |key: usize| u64::from(of_drawing(key).max(of_drawing(key.saturating_add(1))));
        asked.spans.iter().map(|span| span.frames.len() as u64 * of_pair(span.key)).sum()
    }

    fn stroke(&self, i: usize) -> Stroke {
        let colour = self.colours.get(3 * i..3 * i + 3).filter(|c| c.iter().all(|v| v.is_finite()));
        let label = |k: usize| self.labels.get(2 * i + k).and_then(|&label| u32::try_from(label).ok());
        Stroke {
            points: self.strokes.points_of(i),
            closed: self.strokes.closed[i] != 0,
            colour: colour.map(|c| [c[0] as f32, c[1] as f32, c[2] as f32]),
            fill: false,
            fill_colour: None,
            widths: Vec::new(),
            material: label(0),
            layer: label(1),
            peg: None,
        }
    }

    fn sheet(&self, asked: &Asked, ranges: &[Range<usize>]) -> Result<Sheet, Failure> {
        let spans = ranges.len().saturating_sub(1);
        let mut keys = Vec::with_capacity(ranges.len());
        for (d, range) in ranges.iter().enumerate() {
            let spacing = match asked.spacing.get(d) {
                Some(value) => spacing_of(value, &format!("spacing[{d}]")).map_err(failure)?,
                None => Default::default(),
            };
            keys.push(Key {
                frame: self.frames.get(d).copied().unwrap_or(d as i32),
                strokes: range.clone().map(|i| self.stroke(i)).collect(),
                spacing,
                corner: asked.corners.contains(&d),
            });
        }
        let mut sheet =
            Sheet { keys, by_hand: vec![Vec::new(); spans], alone: vec![Vec::new(); spans], ..Sheet::default() };
        for (k, pair) in self.by_hand.chunks(2).enumerate() {
            self.decide(&mut sheet, ranges, k, pair)?;
        }
        sheet.pegs = self.pegs(asked, ranges)?;
        sheet.captured = asked.captured()?;
        Ok(sheet)
    }

    fn decide(&self, sheet: &mut Sheet, ranges: &[Range<usize>], k: usize, pair: &[i32]) -> Result<(), Failure> {
        let drawing = |stroke: i32| {
            let stroke = usize::try_from(stroke).ok()?;
            let d = ranges.iter().position(|range| range.contains(&stroke))?;
            Some((d, stroke - ranges[d].start))
        };
        let spans = sheet.by_hand.len();
        match (pair[0], pair[1], drawing(pair[0]), drawing(pair[1])) {
            (_, -1, Some((d, from)), _) if d < spans => sheet.by_hand[d].push(HandPair { from, to: None }),
            (-1, _, _, Some((d, to))) if d > 0 => sheet.alone[d - 1].push(to),
            (_, _, Some((d, from)), Some((e, to))) if d + 1 == e => {
                sheet.by_hand[d].push(HandPair { from, to: Some(to) })
            }
            (from, to, ..) => {
                let expected = "a stroke and one of the next drawing, or -1 in the place of one of them";
                return Err(Failure::Error(format!("by_hand: pair {k} is ({from}, {to}), expected {expected}")));
            }
        }
        Ok(())
    }

    fn pegs(&self, asked: &Asked, ranges: &[Range<usize>]) -> Result<GivenPegs, Failure> {
        if asked.pegs.is_empty() && asked.hung.is_empty() {
            return Ok(GivenPegs::default());
        }
        let tree = pegs_of(&asked.pegs).map_err(failure)?;
        let total = ranges.last().map_or(0, |range| range.end);
        if asked.hung.len() != total {
            return Err(Failure::Error(format!("hung: {} names, expected {total}", asked.hung.len())));
        }
        let of = |i: usize| {
            let Some(name) = &asked.hung[i] else { return Ok(None) };
            let found = tree.pegs().iter().position(|peg| peg.name == *name);
            found
                .map(Some)
                .ok_or_else(|| Failure::Error(format!("hung[{i}]: found {name:?}, expected the name of a peg")))
        };
        let of = ranges.iter().map(|range| range.clone().map(of).collect()).collect::<Result<_, _>>()?;
        Ok(GivenPegs { tree, of })
    }
}

fn failure(error: PipelineError) -> Failure {
    match error {
        PipelineError::Cancelled(cancelled) => cancelled.into(),
        other => Failure::error(other),
    }
}

/// Matches each drawing with the next one.
pub fn matches(drawings: &Drawings, options: &str, go_on: GoOn<'_>) -> Result<RototoonMatches, Failure> {
    let (ranges, asked) = (drawings.checked()?, Asked::parse(options)?);
    let sheet = drawings.sheet(&asked, &ranges)?;
    let spans = sheet.by_hand.len();
    let work = |progress: &dyn Progress| {
        let one = |k: usize| {
            let part = Part { progress, from: k as f64 / spans as f64, share: 1.0 / spans as f64 };
            sheet.matching(k, &asked.matching(), &part).map(Some).map_err(failure)
        };
        (0..spans).map(one).collect::<Result<Vec<_>, _>>()
    };
    Ok(RototoonMatches::new(&run(asked.threads, go_on, work)?, &ranges))
}

/// Draws the requested spans. Also returns the matches of the drawings that had to be matched for it.
pub fn in_betweens(
    drawings: &Drawings,
    options: &str,
    go_on: GoOn<'_>,
) -> Result<(RototoonInBetweens, RototoonMatches), Failure> {
    let (ranges, asked) = (drawings.checked()?, Asked::parse(options)?);
    room(drawings.points_between(&asked, &ranges))?;
    let sheet = drawings.sheet(&asked, &ranges)?;
    let wanted: Vec<Wanted> = asked.spans.iter().map(|s| Wanted { key: s.key, frames: s.frames.clone() }).collect();
    let work =
        |progress: &dyn Progress| sheet.draw(&wanted, &asked.between(), &asked.matching(), progress).map_err(failure);
    let (drawn, found) = run(asked.threads, go_on, work)?;
    let mut result = RototoonInBetweens::default();
    for offsets in [&mut result.frame_offsets, &mut result.stroke_offsets, &mut result.point_offsets] {
        offsets.push(0);
    }
    for span in &drawn {
        result.push(span, drawings, &ranges);
    }
    Ok((result, RototoonMatches::new(&found, &ranges)))
}

/// Asks for the memory of so many points of in-betweens: a failed allocation would end the host.
fn room(points: u64) -> Result<(), Failure> {
    /// Bytes of a point here, in Python and in the host's drawings.
    const POINT: u64 = 64;
    memory::ask(points.saturating_mul(POINT)).map_err(|error| {
        Failure::Error(format!("spans: found {points} points of in-betweens: {error}: ask for fewer frames at a time"))
    })
}

/// Reports a part of the work as progress of all of it.
struct Part<'a> {
    progress: &'a dyn Progress,
    from: f64,
    share: f64,
}

impl Progress for Part<'_> {
    fn report(&self, step: &str, done: f64) -> Result<(), rototoon::scene::Cancelled> {
        self.progress.report(step, self.from + self.share * done)
    }
}

impl RototoonMatches {
    fn new(matchings: &[Option<Matching>], ranges: &[Range<usize>]) -> Self {
        let mut result = Self { offsets: vec![0], ..Self::default() };
        for (k, matching) in matchings.iter().enumerate() {
            if let Some(matching) = matching {
                result.push(matching, ranges[k].start as i32, ranges[k + 1].start as i32);
            }
            result.offsets.push((result.values.len() / 2) as i32);
        }
        result
    }

    fn push(&mut self, matching: &Matching, first: i32, second: i32) {
        let mut row = |kind: i32, from: Option<usize>, to: Option<usize>, flags: i32, values: [f64; 2]| {
            let number = |first: i32, stroke: Option<usize>| stroke.map_or(-1, |stroke| first + stroke as i32);
            self.rows.extend([kind, number(first, from), number(second, to), flags]);
            self.values.extend(values);
        };
        for pair in &matching.pairs {
            let flags = REVERSED * i32::from(pair.reversed) + BY_HAND * i32::from(pair.by_hand);
            row(kind::ROTOTOON_PAIR, Some(pair.from), Some(pair.to), flags, [pair.start, pair.confidence]);
        }
        let mut pieces = |kind: i32, list: &[InPieces]| {
            for found in list {
                for &(piece, reversed) in &found.pieces {
                    let (from, to) =
                        if kind == kind::ROTOTOON_SPLIT { (found.whole, piece) } else { (piece, found.whole) };
                    row(kind, Some(from), Some(to), REVERSED * i32::from(reversed), [0.0, 1.0]);
                }
            }
        };
        pieces(kind::ROTOTOON_SPLIT, &matching.split);
        pieces(kind::ROTOTOON_JOINED, &matching.joined);
        for line in &matching.chained {
            for &(from, to) in &line.meetings {
                row(kind::ROTOTOON_CHAINED, Some(from), Some(to), 0, [0.0, line.confidence]);
            }
        }
        matching.vanished.iter().for_each(|&i| row(kind::ROTOTOON_VANISHED, Some(i), None, 0, [0.0, 1.0]));
        matching.appeared.iter().for_each(|&j| row(kind::ROTOTOON_APPEARED, None, Some(j), 0, [0.0, 1.0]));
    }
}

impl RototoonInBetweens {
    fn push(&mut self, span: &DrawnSpan, drawings: &Drawings, ranges: &[Range<usize>]) {
        self.held.push(u8::from(span.held));
        self.shares.extend(&span.shares);
        self.frame_offsets.push(self.shares.len() as i32);
        let firsts = [ranges[span.wanted.key].start, ranges[span.wanted.key + 1].start];
        for drawn in &span.strokes {
            self.push_stroke(drawn, drawings, firsts);
        }
        self.stroke_offsets.push((self.strokes.len() / 3) as i32);
        let points: usize = span.strokes.iter().map(|stroke| stroke.points).sum();
        self.points.reserve(2 * points * span.drawings.len());
        for stroke in span.drawings.iter().flatten() {
            for p in &stroke.stroke.points {
                self.points.extend_from_slice(&[p.x, p.y]);
            }
            self.opacities.push(stroke.opacity);
        }
    }

    fn push_stroke(&mut self, drawn: &Drawn, drawings: &Drawings, firsts: [usize; 2]) {
        let number = |side: usize| drawn.stands[side].as_ref().map_or(-1, |stand| (firsts[side] + stand.stroke) as i32);
        let part = |side: usize| drawn.stands[side].as_ref().is_some_and(|stand| stand.part);
        let flags = i32::from(drawn.closed) + 2 * i32::from(part(0)) + 4 * i32::from(part(1));
        self.strokes.extend([number(0), number(1), flags]);
        for k in 0..drawn.points {
            for side in [0, 1] {
                // A stroke that only one key has takes both places from that key.
                let (stand, first) = match (&drawn.stands[side], &drawn.stands[1 - side]) {
                    (Some(stand), _) => (stand, firsts[side]),
                    (None, Some(stand)) => (stand, firsts[1 - side]),
                    (None, None) => continue,
                };
                let (a, b, weight) = stand.blends[k];
                let start = drawings.strokes.offsets[first + stand.stroke];
                self.indices.extend([start + a as i32, start + b as i32]);
                self.weights.push(weight);
            }
        }
        self.point_offsets.push((self.weights.len() / 2) as i32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [f64; 24] = [
        0.0, 0.0, 10.0, 0.0, 20.0, 0.0, 0.0, 30.0, 0.0, 60.0, // first drawing: across, down
        8.0, 60.0, 8.0, 30.0, 28.0, 0.0, 8.0, 0.0, 3.0, 3.0, 4.0, 4.0, 5.0,
        5.0, // second drawing: down, across, and a third line
    ];

    fn drawings<'a>(by_hand: &'a [i32]) -> Drawings<'a> {
        Drawings {
            strokes: Strokes { offsets: &[0, 3, 5, 7, 9, 12], points: &POINTS, closed: &[0; 5] },
            colours: &[],
            labels: &[0, 0, 1, 0, 1, 0, 0, 0, 2, 5],
            drawings: &[0, 2, 5],
            frames: &[1, 5],
            by_hand,
        }
    }

    #[test]
    fn strokes_are_matched() {
        let found = matches(&drawings(&[]), "", None).unwrap();
        assert_eq!(found.offsets, [0, 3]);
        assert_eq!(found.rows, [0, 0, 3, 1, 0, 1, 2, 1, 4, -1, 4, 0]);
        let by_hand = matches(&drawings(&[0, 2, 1, -1, -1, 3]), "{}", None).unwrap();
        assert_eq!(by_hand.rows[..4], [0, 0, 2, by_hand.rows[3] | 2]);
        assert_eq!(by_hand.rows[4..], [3, 1, -1, 0, 4, -1, 3, 0, 4, -1, 4, 0]);
    }

    #[test]
    fn one_call_draws_all_frames() {
        let options = r#"{"spans": [{"key": 0, "frames": [2, 3, 4]}], "spacing": ["linear"], "arcs": 0}"#;
        let (found, pairs) = in_betweens(&drawings(&[]), options, None).unwrap();
        assert_eq!(pairs.rows.len(), 12);
        assert_eq!((&found.frame_offsets[..], &found.shares[..]), (&[0, 3][..], &[0.25, 0.5, 0.75][..]));
        assert_eq!(found.stroke_offsets, [0, 3]);
        // The stroke that appears keeps its place in the later drawing's order: after the stroke behind it.
        assert_eq!(found.strokes, [0, 3, 0, -1, 4, 0, 1, 2, 0]);
        assert_eq!(found.point_offsets, [0, 3, 6, 8]);
        // The middle point of the first stroke comes from halfway between the two points of its counterpart.
        assert_eq!((&found.indices[4..8], &found.weights[2..4]), (&[1, 1, 7, 8][..], &[0.0, 0.5][..]));
        assert_eq!(found.points.len(), 3 * 8 * 2);
        assert!((found.points[16] - 4.0).abs() < 1e-6, "{:?}", &found.points[16..22]);
        assert_eq!(found.opacities.len(), 9);
    }

    #[test]
    fn too_many_points_are_refused_before_the_work() {
        let asked = Asked::parse(r#"{"spans": [{"key": 0, "frames": [2, 3, 4]}, {"key": 9, "frames": [7]}]}"#).unwrap();
        let drawings = drawings(&[]);
        // The later drawing has more points: two, two and three.
        assert_eq!(drawings.points_between(&asked, &drawings.checked().unwrap()), 3 * 7);
        assert!(room(1000).is_ok());
        let said = room(1 << 57).unwrap_err().to_string();
        assert!(said.contains("points of in-betweens") && said.contains("of memory are needed"), "{said}");
    }

    #[test]
    fn errors_name_the_wrong_argument() {
        let said = |drawings: &Drawings, options: &str| in_betweens(drawings, options, None).err().unwrap().to_string();
        let fine = drawings(&[]);
        assert!(said(&fine, r#"{"colour": 1}"#).starts_with("options: unknown field `colour`"));
        assert!(said(&fine, r#"{"spacing": ["fast"]}"#).contains("spacing[0]: found \"fast\""));
        assert!(
            said(&fine, r#"{"spans": [{"key": 1, "frames": []}]}"#).contains("found span 1, expected a number below 1")
        );
        assert!(said(&drawings(&[0, 1]), "").starts_with("by_hand: pair 0 is (0, 1)"));
        assert!(said(&drawings(&[2, -1]), "").starts_with("by_hand: pair 0 is (2, -1)"));
        assert!(said(&drawings(&[9, 9]), "").starts_with("by_hand: pair 0 is (9, 9)"));
        assert!(said(&Drawings { drawings: &[0, 2], ..drawings(&[]) }, "").starts_with("drawings: expected"));
        assert!(said(&Drawings { labels: &[1], ..drawings(&[]) }, "").starts_with("labels: 1 values"));
        assert!(said(&fine, r#"{"hung": [null]}"#).starts_with("hung: 1 names, expected 5"));
        let two = Drawings { frames: &[4, 4], ..drawings(&[]) };
        assert!(said(&two, r#"{"spans": [{"key": 0, "frames": []}]}"#).contains("after one on frame 4"));
    }

    #[test]
    fn work_can_be_cancelled() {
        let answer = matches(&drawings(&[]), "", Some(&mut |_, _| false));
        assert_eq!(answer.err(), Some(Failure::Cancelled));
    }

    #[test]
    fn given_pegs_carry_their_strokes() {
        let options = r#"{"spans": [{"key": 0, "frames": [3]}], "pegs": [{"name": "arm", "pivot": [0, 0], "keys":
            [{"frame": 1}, {"frame": 5, "turn": 360}]}], "hung": ["arm", null, null, null, null], "arcs": 0}"#;
        let (found, _) = in_betweens(&drawings(&[]), options, None).unwrap();
        // Halfway: (0, 0) to (8, 0) and (20, 0) to (28, 0) in the peg's frame, turned by half a turn.
        assert!(
            (found.points[0] + 4.0).abs() < 1e-6 && (found.points[4] + 24.0).abs() < 1e-6,
            "{:?}",
            &found.points[..6]
        );
    }
}
