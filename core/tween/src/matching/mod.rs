//! Correspondence: which stroke of one drawing is which of another.
//!
//! The method assumes nothing about the order, direction, starting point or number of points of the strokes. Many
//! strokes look alike (arms, eyes, hatching), and the drawing has moved. A stroke alone therefore does not show its
//! counterpart. All pairs are found together:
//!
//! 1. `outline` measures how well one shape can be laid on another, and in which ways.
//! 2. `movement` proposes movements of the complete drawing and tries them on its largest strokes.
//! 3. `costs` lists the likely counterparts of each stroke under the movement expected around it, with their costs.
//! 4. `relaxation` prefers choices that keep neighbouring strokes together. It is graduated assignment (Gold &
//!    Rangarajan 1996): every choice keeps a weight, each choice supports the choices of its neighbours that fit it,
//!    and the weights sharpen from round to round.
//! 5. An exact assignment ([`rototoon_base::numeric::sparse_assignment`]) takes the resulting costs. A stroke may stay without
//!    counterpart at a price. The pairs give a new movement around each stroke. Steps 3 to 5 run up to three times. `squash`
//!    tells shapes that are squashed from shapes that turn ([`crate::affine`]), `turns` settles how strokes turn whose shape does not show it,
//!    and `direction` lets lines that lie where they lay run as they ran.
//! 6. `pieces` examines the strokes that are left over. Such a stroke may be a piece of a stroke that was drawn in one
//!    go on the other drawing.
//! 7. Where much of the ink is without a sure counterpart, the drawings may be cut into pieces in different ways.
//!    `fragments` puts pieces that continue each other together, on both drawings (`joins`), and matches the chains. What
//!    is surer is kept.
//!
//! Pairs made by hand stay as they are, and so do strokes that are on both drawings point by point (`unchanged`) or stand
//! together where they stood (`standing`). They also count as
//! neighbours of the other strokes. Strokes of different pegs are never pairs.
//!
//! Strokes that are drawn twice (`twins`) are no reason for doubt.
//!
//! Limits: two equal limbs that have changed places can only be told apart by the strokes attached to them, by their
//! layers and by their colours. A disc does not show its turn. It is assumed to turn with its surroundings.
//!
//! Source: S. Gold and A. Rangarajan, "A graduated assignment algorithm for graph matching", IEEE PAMI 1996, for step
//! 4.

mod costs;
mod direction;
mod doubt;
mod fragments;
mod joins;
mod movement;
mod outline;
mod pieces;
mod relaxation;
mod setting;
mod similarity;
mod squash;
mod standing;
mod start;
mod torn;
mod turns;
mod twins;
mod unchanged;

pub use super::chain::Chain;
use super::stroke::{BadPoint, Stroke, checked};
use costs::{Figure, Rows, Ways};
use outline::Way;
use relaxation::Chosen;
use rototoon_base::scene::{Cancelled, Progress};
use similarity::Movement;
use unchanged::Unchanged;

/// Rounds of matching. After each round the movement around each stroke is fitted anew.
const ROUNDS: usize = 3;

/// Limits of the matching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Cost above which a stroke stays without counterpart. It has no unit. Each of these costs about 1: different
    /// shapes, a place wrong by 0.7 of the drawing's radius, a size wrong by a factor of 2.7, neighbours that went
    /// elsewhere.
    pub max_cost: f64,
    /// Largest turn of the complete drawing, in radians.
    pub max_turn: f64,
    /// Largest growth of the complete drawing. Its inverse limits the shrinking. At least 1.
    pub max_scale: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { max_cost: 6.0, max_turn: std::f64::consts::PI, max_scale: 2.0 }
    }
}

/// A pair made by hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HandPair {
    /// Index of the stroke of the first drawing.
    pub from: usize,
    /// Index of its counterpart in the second drawing; `None` for a stroke that must not have one.
    pub to: Option<usize>,
}

/// A stroke and its counterpart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Index of the stroke of the first drawing.
    pub from: usize,
    /// Index of its counterpart in the second drawing.
    pub to: usize,
    /// Whether the counterpart runs in the opposite direction.
    pub reversed: bool,
    /// For two closed strokes: the position of the first stroke's first point on the counterpart, as a share of the
    /// counterpart's length from its first point forwards. 0 for open strokes.
    pub start: f64,
    /// How sure the pair is, 0 to 1. A pair made by hand has 1.
    pub confidence: f64,
    /// Whether it was made by hand.
    pub by_hand: bool,
}

/// A stroke that was drawn in one go on one drawing and in pieces on the other.
#[derive(Clone, Debug, PartialEq)]
pub struct InPieces {
    /// Index of the stroke drawn in one go.
    pub whole: usize,
    /// Indices of its pieces in their order along the stroke, each with whether it runs in the opposite direction.
    pub pieces: Vec<(usize, bool)>,
}

/// A line that is in pieces on one drawing, or on both, cut in other places.
#[derive(Clone, Debug, PartialEq)]
pub struct Chained {
    /// The pieces on the first drawing.
    pub first: Chain,
    /// The pieces on the second drawing, along the line of that drawing.
    pub second: Chain,
    /// Whether the line of the second drawing runs in the opposite direction.
    pub reversed: bool,
    /// As [`Pair::start`], on the two lines.
    pub start: f64,
    /// How sure the pair of the two lines is, 0 to 1.
    pub confidence: f64,
    /// Which strokes of the two drawings share a stretch of the line, in the order along the line.
    pub meetings: Vec<(usize, usize)>,
}

/// The correspondence of two drawings. Each stroke of the first drawing is in exactly one of `pairs`, `vanished` and
/// `split`, or is a piece in `joined` or `chained`. Each stroke of the second drawing is in exactly one of `pairs`,
/// `appeared` and `joined`, or is a piece in `split` or `chained`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matching {
    /// Pairs of one stroke with one stroke, ordered by the index in the first drawing.
    pub pairs: Vec<Pair>,
    /// Strokes of the first drawing that are in several pieces in the second.
    pub split: Vec<InPieces>,
    /// Strokes of the second drawing that were in several pieces in the first.
    pub joined: Vec<InPieces>,
    /// Lines in pieces on both drawings.
    pub chained: Vec<Chained>,
    /// Strokes of the first drawing without counterpart.
    pub vanished: Vec<usize>,
    /// Strokes of the second drawing without counterpart.
    pub appeared: Vec<usize>,
    /// Strokes of the first and of the second drawing, rising, that a person left without counterpart. They are in `vanished` and
    /// `appeared` too. Where a person has decided about every stroke of the first drawing, what is left of the second one counts as decided.
    pub alone: [Vec<usize>; 2],
}

/// Why drawings were not matched.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MatchingError {
    /// A point of the first drawing cannot be used.
    #[error("first drawing: {0}")]
    First(BadPoint),
    /// A point of the second drawing cannot be used.
    #[error("second drawing: {0}")]
    Second(BadPoint),
    /// A pair made by hand names a stroke that does not exist.
    #[error("pair {pair}: found stroke {found} of the {drawing} drawing, expected a number below {count}")]
    Missing {
        /// Index of the pair made by hand.
        pair: usize,
        /// "first" or "second".
        drawing: &'static str,
        /// Index of the stroke that was named.
        found: usize,
        /// Number of strokes of the drawing.
        count: usize,
    },
    /// Two pairs made by hand name the same stroke.
    #[error("pair {pair}: stroke {stroke} of the {drawing} drawing has a pair made by hand already")]
    Twice {
        /// Index of the second of the two pairs.
        pair: usize,
        /// "first" or "second".
        drawing: &'static str,
        /// Index of the stroke.
        stroke: usize,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Finds the counterpart in `second` of each stroke of `first`. Pairs in `by_hand` are kept.
///
/// Points are in pixels; both drawings use the same coordinate frame. Strokes without points have no counterpart.
///
/// # Errors
///
/// A point that cannot be used; a pair made by hand that names a stroke that does not exist; two pairs made by hand
/// that name the same stroke; cancellation by `progress`.
pub fn match_strokes(
    first: &[Stroke],
    second: &[Stroke],
    by_hand: &[HandPair],
    options: &Options,
    progress: &dyn Progress,
) -> Result<Matching, MatchingError> {
    checked(first).map_err(MatchingError::First)?;
    checked(second).map_err(MatchingError::Second)?;
    let mut fixed = fixed(first.len(), second.len(), by_hand)?;
    let decided = !fixed.is_empty() && fixed.iter().all(|fixed| *fixed != Fixed::Free);
    let unchanged = still(first, second, &mut fixed);
    let matching = stroke_by_stroke(first, second, &fixed, options, progress)?;
    let mut matching = fragments::surer(first, second, &fixed, matching, options, progress)?;
    unchanged::found(&mut matching, &unchanged);
    matching.alone[0] = (0..first.len()).filter(|&i| fixed[i] == Fixed::Alone).collect();
    if decided {
        matching.alone[1].clone_from(&matching.appeared);
    }
    progress.report("matching strokes", 1.0)?;
    Ok(matching)
}

/// Fixes the strokes that stand where they stood. Returns them by their index on the first drawing.
fn still(first: &[Stroke], second: &[Stroke], fixed: &mut [Fixed]) -> Vec<Unchanged> {
    let Some(mut found) = unchanged::fix(first, second, fixed) else { return Vec::new() };
    found.extend(standing::fix(first, second, fixed, &found));
    found.sort_unstable_by_key(|found| found.from);
    found
}

/// Matches the strokes as they are.
fn stroke_by_stroke(
    first: &[Stroke],
    second: &[Stroke],
    fixed: &[Fixed],
    options: &Options,
    progress: &dyn Progress,
) -> Result<Matching, MatchingError> {
    let (a, b) = (Figure::new(first), Figure::new(second));
    progress.report("matching strokes", 0.1)?;
    let (found, around) = chosen(&a, &b, fixed, options, progress)?;
    progress.report("matching strokes", 0.9)?;
    let mut matching = laid_out(first, second, &found, fixed);
    pieces::find(first, second, &around, fixed, &mut matching);
    Ok(matching)
}

/// The counterpart of each stroke, if it has one, and the movement around each stroke. Each is found from the other in
/// turn.
fn chosen(
    a: &Figure,
    b: &Figure,
    fixed: &[Fixed],
    options: &Options,
    progress: &dyn Progress,
) -> Result<(Vec<Option<Chosen>>, Vec<Movement>), MatchingError> {
    let ways = Ways::new(a, b);
    let whole = movement::of_whole(a, b, &ways, fixed, options);
    let (held, others) = (whole.movement, whole.others);
    let neighbours = relaxation::Neighbours::new(a);
    let mut around = vec![held; fixed.len()];
    let mut found = Vec::new();
    let mut known = whole.found.into_iter().flatten();
    for round in 0..ROUNDS {
        progress.report("matching strokes", 0.3 + 0.2 * round as f64)?;
        let next = known.next().unwrap_or_else(|| {
            let rows = Rows::new((a, b), &ways, &around, fixed, options);
            relaxation::relaxed(&neighbours, b, &rows, options).chosen
        });
        let last = std::mem::replace(&mut found, next);
        // Equal pairs would give equal movements again, so the loop has converged.
        if round > 0 && found == last {
            break;
        }
        around = movement::around_each(a, b, &found, &held);
    }
    squash::settle(a, b, &mut found);
    // First, so that no stroke in its place speaks for a turn.
    direction::settle(a, b, &mut found);
    turns::settle((a, b), &ways, &mut found);
    direction::settle(a, b, &mut found);
    doubt::lower(&mut found, &others, &b.firsts);
    Ok((found, around))
}

/// Sorts the strokes into pairs, vanished and appeared strokes.
fn laid_out(first: &[Stroke], second: &[Stroke], found: &[Option<Chosen>], fixed: &[Fixed]) -> Matching {
    let mut matching = Matching::default();
    let mut taken = vec![false; second.len()];
    for (from, choice) in found.iter().enumerate() {
        let Some(choice) = choice else {
            matching.vanished.push(from);
            continue;
        };
        taken[choice.to] = true;
        let by_hand = fixed[from] == Fixed::To(choice.to);
        matching.pairs.push(Pair {
            from,
            to: choice.to,
            reversed: choice.way.reversed,
            start: started(&first[from], &second[choice.to], &choice.way),
            confidence: if by_hand { 1.0 } else { choice.confidence },
            by_hand,
        });
    }
    matching.appeared = (0..second.len()).filter(|&j| !taken[j]).collect();
    matching
}

/// The position of a stroke's first point on its counterpart, as [`Pair::start`] has it.
fn started(stroke: &Stroke, other: &Stroke, way: &Way) -> f64 {
    match stroke.closed && other.closed {
        true if way.exact => way.start,
        true => start::refined(stroke, other, way.start, way.reversed),
        false => 0.0,
    }
}

/// The user's decision about a stroke of the first drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fixed {
    Free,
    To(usize),
    Alone,
}

fn fixed(first: usize, second: usize, by_hand: &[HandPair]) -> Result<Vec<Fixed>, MatchingError> {
    let mut result = vec![Fixed::Free; first];
    let mut taken = vec![false; second];
    for (pair, made) in by_hand.iter().enumerate() {
        let missing = |drawing, found, count| MatchingError::Missing { pair, drawing, found, count };
        if made.from >= first {
            return Err(missing("first", made.from, first));
        }
        if result[made.from] != Fixed::Free {
            return Err(MatchingError::Twice { pair, drawing: "first", stroke: made.from });
        }
        result[made.from] = Fixed::Alone;
        if let Some(to) = made.to {
            if to >= second {
                return Err(missing("second", to, second));
            }
            if std::mem::replace(&mut taken[to], true) {
                return Err(MatchingError::Twice { pair, drawing: "second", stroke: to });
            }
            result[made.from] = Fixed::To(to);
        }
    }
    Ok(result)
}

#[cfg(test)]
mod tests;
