//! How two pieces meet, and from what distance on they do.

/// How two pieces meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meeting {
    /// At a point.
    Point {
        /// Parameter on the first.
        first: f64,
        /// Parameter on the second.
        second: f64,
    },
    /// Along a stretch; the parameters of its start and end, on the second falling where it runs the other way.
    Overlap {
        /// Parameters on the first, rising.
        first: (f64, f64),
        /// The parameters of the same points on the second.
        second: (f64, f64),
    },
}

/// A distance below this share of the pieces' size counts as none.
pub(super) const SAME: f64 = 1e-10;
/// Meetings that are closer in both parameters are one.
pub(super) const MERGE: f64 = 1e-6;

impl Meeting {
    pub(super) fn start(&self) -> f64 {
        match *self {
            Self::Point { first, .. } => first,
            Self::Overlap { first, .. } => first.0,
        }
    }

    /// The meeting as the other piece sees it.
    pub(super) fn swapped(self) -> Self {
        match self {
            Self::Point { first, second } => Self::Point { first: second, second: first },
            Self::Overlap { first, second } if second.0 <= second.1 => Self::Overlap { first: second, second: first },
            Self::Overlap { first, second } => {
                Self::Overlap { first: (second.1, second.0), second: (first.1, first.0) }
            }
        }
    }
}
