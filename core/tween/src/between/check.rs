//! What drawings, matchings and options must be to be drawn between.

use super::super::matching::{InPieces, Matching};
use super::super::peg::TimingError;
use super::super::stroke::{BadPoint, checked};
use super::{GivenPegs, Key, Options, Spacing};
use rototoon_base::scene::FrameNumber;

/// Why there are no in-betweens.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BetweenError {
    /// A point of a drawing is no place.
    #[error("frame {frame}: {source}")]
    Point {
        /// The drawing's frame.
        frame: FrameNumber,
        /// The point.
        source: BadPoint,
    },
    /// Keys do not follow each other.
    #[error("found a key on frame {frame} after one on frame {before}, expected a later frame")]
    Order {
        /// Frame of the key.
        frame: FrameNumber,
        /// Frame of the one before it.
        before: FrameNumber,
    },
    /// There are not as many matchings as spans.
    #[error("found {found} matchings, expected one for each of {expected} spans between keys")]
    Matchings {
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A matching names a stroke that is not there.
    #[error("matching of frame {frame} and the next key: found stroke {found}, expected less than {count}")]
    Stroke {
        /// Frame of the earlier key.
        frame: FrameNumber,
        /// The stroke.
        found: usize,
        /// Strokes of the drawing.
        count: usize,
    },
    /// A spacing is none.
    #[error("frame {frame}: {source}")]
    Spacing {
        /// Frame of the earlier key.
        frame: FrameNumber,
        /// What is wrong.
        source: SpacingError,
    },
    /// A stroke hangs on a peg that is not there.
    #[error("frame {frame}, stroke {stroke}: found peg {found}, expected less than {count}")]
    Peg {
        /// Frame of the key.
        frame: FrameNumber,
        /// Index of the stroke.
        stroke: usize,
        /// What was found.
        found: usize,
        /// Number of pegs.
        count: usize,
    },
    /// The strength of arcs is no number.
    #[error("arcs are {found}, expected 0 to 1")]
    Arcs {
        /// What was found.
        found: f64,
    },
}

/// Why a spacing is none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SpacingError {
    /// A spacing chart has not one share for each frame.
    #[error("the spacing chart has {found} shares, expected one for each of {expected} frames to the next key")]
    Chart {
        /// Shares found.
        found: usize,
        /// Frames between the keys.
        expected: usize,
    },
    /// A spacing chart holds what is no number.
    #[error("share {index} of the spacing chart is {found}, expected a number from -10 to 10")]
    Share {
        /// Index of the share.
        index: usize,
        /// What was found.
        found: f64,
    },
    /// A movement function is none.
    #[error(transparent)]
    Timing(#[from] TimingError),
}

impl Spacing {
    /// Whether it is one between keys on these frames.
    pub fn check(&self, frame: FrameNumber, next: FrameNumber) -> Result<(), SpacingError> {
        match self {
            Self::Smooth => Ok(()),
            Self::Timing(timing) => Ok(timing.check()?),
            Self::Chart(shares) => {
                let expected = (next.abs_diff(frame) as usize).saturating_sub(1);
                if shares.len() != expected {
                    return Err(SpacingError::Chart { found: shares.len(), expected });
                }
                match shares.iter().position(|s| !(-10.0..=10.0).contains(s)) {
                    Some(index) => Err(SpacingError::Share { index, found: shares[index] }),
                    None => Ok(()),
                }
            }
        }
    }
}

pub(super) fn check(
    keys: &[Key],
    matchings: &[Matching],
    pegs: &GivenPegs,
    options: &Options,
) -> Result<(), BetweenError> {
    if !(0.0..=1.0).contains(&options.arcs) {
        return Err(BetweenError::Arcs { found: options.arcs });
    }
    let expected = keys.len().saturating_sub(1);
    if matchings.len() != expected {
        return Err(BetweenError::Matchings { found: matchings.len(), expected });
    }
    for key in keys {
        checked(&key.strokes).map_err(|source| BetweenError::Point { frame: key.frame, source })?;
    }
    for (pair, matching) in keys.windows(2).zip(matchings) {
        let (frame, next) = (pair[0].frame, pair[1].frame);
        if next <= frame {
            return Err(BetweenError::Order { frame: next, before: frame });
        }
        pair[0].spacing.check(frame, next).map_err(|source| BetweenError::Spacing { frame, source })?;
        for (named, count) in named(matching).into_iter().zip([pair[0].strokes.len(), pair[1].strokes.len()]) {
            if let Some(&found) = named.iter().find(|&&i| i >= count) {
                return Err(BetweenError::Stroke { frame, found, count });
            }
        }
    }
    let count = pegs.tree.pegs().len();
    for (key, of) in keys.iter().zip(&pegs.of) {
        if let Some((stroke, found)) = of.iter().enumerate().find_map(|(i, p)| Some((i, p.filter(|&p| p >= count)?))) {
            return Err(BetweenError::Peg { frame: key.frame, stroke, found, count });
        }
    }
    Ok(())
}

/// The strokes of both drawings that a matching names.
fn named(matching: &Matching) -> [Vec<usize>; 2] {
    let wholes = |list: &[InPieces]| list.iter().map(|s| s.whole).collect::<Vec<_>>();
    let pieces = |list: &[InPieces]| list.iter().flat_map(|s| s.pieces.iter().map(|p| p.0)).collect::<Vec<_>>();
    let first = matching.pairs.iter().map(|p| p.from).chain(wholes(&matching.split)).chain(pieces(&matching.joined));
    let second = matching.pairs.iter().map(|p| p.to).chain(wholes(&matching.joined)).chain(pieces(&matching.split));
    [first.collect(), second.collect()]
}
