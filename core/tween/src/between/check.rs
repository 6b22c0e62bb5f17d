//! Checks of the input of the in-betweens: drawings, matchings and options.

use super::super::matching::Matching;
use super::super::peg::TimingError;
use super::super::stroke::{BadPoint, checked};
use super::{GivenPegs, Key, Options, Spacing};
use rototoon_base::scene::FrameNumber;

/// The reason why there are no in-betweens.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BetweenError {
    /// A point of a drawing cannot be used.
    #[error("frame {frame}: {source}")]
    Point {
        /// The drawing's frame.
        frame: FrameNumber,
        /// The point and the numbers found.
        source: BadPoint,
    },
    /// The frames of keys do not rise.
    #[error("found a key on frame {frame} after one on frame {before}, expected a later frame")]
    Order {
        /// Frame of the key.
        frame: FrameNumber,
        /// Frame of the one before it.
        before: FrameNumber,
    },
    /// The number of matchings does not fit the keys.
    #[error("found {found} matchings, expected one for each of {expected} spans between keys")]
    Matchings {
        /// Number of matchings.
        found: usize,
        /// Number of spans.
        expected: usize,
    },
    /// A matching names a stroke that does not exist.
    #[error("matching of frame {frame} and the next key: found stroke {found}, expected a number below {count}")]
    Stroke {
        /// Frame of the earlier key.
        frame: FrameNumber,
        /// Index of the stroke.
        found: usize,
        /// Number of strokes of the drawing.
        count: usize,
    },
    /// A spacing is not valid.
    #[error("frame {frame}: {source}")]
    Spacing {
        /// Frame of the earlier key.
        frame: FrameNumber,
        /// The reason.
        source: SpacingError,
    },
    /// A stroke hangs on a peg that does not exist.
    #[error("frame {frame}, stroke {stroke}: found peg {found}, expected a number below {count}")]
    Peg {
        /// Frame of the key.
        frame: FrameNumber,
        /// Index of the stroke.
        stroke: usize,
        /// Index of the peg found.
        found: usize,
        /// Number of pegs.
        count: usize,
    },
    /// The strength of arcs is outside 0 to 1.
    #[error("arcs: found {found}, expected a number from 0 to 1")]
    Arcs {
        /// The value found.
        found: f64,
    },
}

/// The reason why a spacing is not valid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SpacingError {
    /// A spacing chart does not have one share for each frame between the keys.
    #[error("the spacing chart has {found} shares, expected one for each of {expected} frames to the next key")]
    Chart {
        /// Number of shares found.
        found: usize,
        /// Number of frames between the keys.
        expected: usize,
    },
    /// A share of a spacing chart is outside −10 to 10.
    #[error("share {index} of the spacing chart is {found}, expected a number from -10 to 10")]
    Share {
        /// Index of the share.
        index: usize,
        /// The share found.
        found: f64,
    },
    /// A timing function is not valid.
    #[error(transparent)]
    Timing(#[from] TimingError),
}

impl Spacing {
    /// Checks the spacing for a span between keys on these frames.
    ///
    /// # Errors
    ///
    /// A timing that is not valid; a chart with the wrong number of shares, or with a share outside −10 to 10.
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
        for (named, count) in matching.named().into_iter().zip([pair[0].strokes.len(), pair[1].strokes.len()]) {
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
