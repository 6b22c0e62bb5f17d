//! Which stroke of one drawing is which of another.
//!
//! Nothing is assumed of the order, direction, starting point or number of points. Strokes look alike (arms, eyes,
//! lines of a shade), and the drawing has moved; therefore the pairs are found together:
//!
//! 1. `outline`: how well two shapes can be laid upon each other, and how.
//! 2. `movement`: movements of the whole drawing are proposed and tried on its largest strokes.
//! 3. `costs`: for each stroke the likely counterparts under the movement expected around it, and what each would cost.
//! 4. `relaxation`: strokes that lie close together stay so. Graduated assignment (Gold & Rangarajan 1996): all choices
//!    are kept, weighted, and each supports the choices of its neighbours that fit to it, while the weights sharpen.
//! 5. An exact assignment ([`rototoon_base::numeric::sparse_assignment`]) on the costs that result, in which a stroke may stay
//!    without counterpart at a price; from its pairs the movement around each stroke is fitted anew, and 3 to 5
//!    repeated.
//! 6. `pieces`: what is left over may be a piece of a stroke that was drawn in one go on the other drawing.
//!
//! Pairs made by hand are kept as they are, and count as neighbours for the others.
//!
//! Limits: two equal limbs that have changed places are told apart by what hangs on them, their layers and colours
//! only. A disc does not show its turn: it is taken to have turned as what is around it.

mod costs;
mod movement;
mod outline;
mod pieces;
mod relaxation;
mod similarity;
mod start;

use super::stroke::{BadPoint, Stroke, checked};
use costs::{Figure, Rows, Ways};
use outline::Way;
use relaxation::Chosen;
use rototoon_base::scene::{Cancelled, Progress};
use similarity::Movement;

/// Rounds of matching and fitting of the movement around each stroke.
const ROUNDS: usize = 3;

/// How to match.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Cost from which on a stroke stays without counterpart. It has no unit: unequal shapes, a place wrong by 0.7 of
    /// the drawing's radius, a size wrong by 2.7, and neighbours that went elsewhere cost about 1 each.
    pub max_cost: f64,
    /// Farthest turn of the whole drawing, in radians.
    pub max_turn: f64,
    /// Greatest growth of the whole drawing, and 1 over its greatest shrinking; at least 1.
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
    /// Index of its counterpart in the second; `None` for a stroke that is to have none.
    pub to: Option<usize>,
}

/// Two strokes that are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Index of the stroke of the first drawing.
    pub from: usize,
    /// Index of its counterpart.
    pub to: usize,
    /// Whether the counterpart is walked backwards.
    pub reversed: bool,
    /// Of closed strokes the share of the counterpart's length, walked forwards from its first point, at which the
    /// first point of the other lies; 0 for open ones.
    pub start: f64,
    /// How sure the pair is, 0 to 1; 1 for those made by hand.
    pub confidence: f64,
    /// Whether it was made by hand.
    pub by_hand: bool,
}

/// A stroke that was drawn in pieces on the other drawing. Its pair is that with the longest piece.
#[derive(Clone, Debug, PartialEq)]
pub struct InPieces {
    /// Index of the whole stroke.
    pub whole: usize,
    /// Indices of its pieces in the order along the whole, each with whether it is walked backwards.
    pub pieces: Vec<(usize, bool)>,
}

/// The strokes of two drawings side by side. Every stroke of the first stands in exactly one of `pairs`, `vanished` and
/// `split` or is a piece in `joined`; every stroke of the second in one of `pairs`, `appeared` and `joined`, or is a
/// piece in `split`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matching {
    /// One to one, by the index in the first drawing.
    pub pairs: Vec<Pair>,
    /// Strokes of the first drawing that are several in the second.
    pub split: Vec<InPieces>,
    /// Strokes of the second drawing that were several in the first.
    pub joined: Vec<InPieces>,
    /// Strokes of the first drawing without counterpart.
    pub vanished: Vec<usize>,
    /// Strokes of the second drawing without counterpart.
    pub appeared: Vec<usize>,
}

/// Why drawings were not matched.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MatchingError {
    /// A point of the first drawing is no place.
    #[error("first drawing: {0}")]
    First(BadPoint),
    /// A point of the second drawing is no place.
    #[error("second drawing: {0}")]
    Second(BadPoint),
    /// A pair made by hand names a stroke that is not there.
    #[error("pair {pair}: found stroke {found} of the {drawing} drawing, expected less than {count}")]
    Missing {
        /// Index of the pair made by hand.
        pair: usize,
        /// "first" or "second".
        drawing: &'static str,
        /// The stroke.
        found: usize,
        /// Strokes of the drawing.
        count: usize,
    },
    /// Two pairs made by hand name the same stroke.
    #[error("pair {pair}: stroke {stroke} of the {drawing} drawing has a pair made by hand already")]
    Twice {
        /// Index of the second of them.
        pair: usize,
        /// "first" or "second".
        drawing: &'static str,
        /// The stroke.
        stroke: usize,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Finds which stroke of `first` is which of `second`. Pairs in `by_hand` are kept.
///
/// Strokes without points have no counterpart.
///
/// # Errors
///
/// The first point that is no place; pairs made by hand of strokes that are not there, or of one stroke twice.
pub fn match_strokes(
    first: &[Stroke],
    second: &[Stroke],
    by_hand: &[HandPair],
    options: &Options,
    progress: &dyn Progress,
) -> Result<Matching, MatchingError> {
    checked(first).map_err(MatchingError::First)?;
    checked(second).map_err(MatchingError::Second)?;
    let fixed = fixed(first.len(), second.len(), by_hand)?;
    let (a, b) = (Figure::new(first), Figure::new(second));
    progress.report("matching strokes", 0.1)?;
    let (found, around) = chosen(&a, &b, &fixed, options, progress)?;
    progress.report("matching strokes", 0.9)?;
    let mut matching = laid_out(first, second, &found, &fixed);
    pieces::find(first, second, &around, &fixed, &mut matching);
    progress.report("matching strokes", 1.0)?;
    Ok(matching)
}

/// Of each stroke its counterpart, if it has one, and how its surroundings move: found from each other in turn.
fn chosen(
    a: &Figure,
    b: &Figure,
    fixed: &[Fixed],
    options: &Options,
    progress: &dyn Progress,
) -> Result<(Vec<Option<Chosen>>, Vec<Movement>), MatchingError> {
    let ways = Ways::new(a, b);
    let whole = movement::of_whole(a, b, &ways, fixed, options);
    let held = whole.movement;
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
        // The same pairs move their surroundings the same way again.
        if round > 0 && found == last {
            break;
        }
        around = movement::around_each(a, b, &found, &held);
    }
    Ok((found, around))
}

/// The pairs, and the strokes that have none.
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

/// Where a stroke's first point lies on its counterpart.
fn started(stroke: &Stroke, other: &Stroke, way: &Way) -> f64 {
    if stroke.closed && other.closed { start::refined(stroke, other, way.start, way.reversed) } else { 0.0 }
}

/// What is decided by hand of a stroke of the first drawing.
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
