//! Strokes put together end to end: the pieces of a line that was drawn, or traced, in several goes.

use super::line::vertex_shares;
use super::stroke::Stroke;
use rototoon_base::geometry::Point;

/// The pieces of a line, in their order along it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chain {
    /// Index of each piece's stroke in the drawing, and whether the stroke runs against the line.
    pub pieces: Vec<(usize, bool)>,
    /// Whether the end of the last piece leads to the beginning of the first one.
    pub closed: bool,
}

/// A chain as one line, with the places where its pieces are on it.
pub(super) struct Joined {
    /// The line. Gaps between pieces are straight. It has the attributes of the first piece, but no widths.
    pub line: Stroke,
    /// The share of the line's length at each point; one entry more where it is closed.
    pub shares: Vec<f64>,
    /// For each piece the index of its first point and that of its last point on the line.
    pub ranges: Vec<(usize, usize)>,
    /// Whether its only piece is a closed stroke.
    ring: bool,
}

impl Chain {
    /// A stroke alone.
    pub(super) fn single(stroke: usize, closed: bool) -> Self {
        Self { pieces: vec![(stroke, false)], closed }
    }

    /// The pieces of an open line.
    pub(super) fn open(pieces: &[(usize, bool)]) -> Self {
        Self { pieces: pieces.into(), closed: false }
    }

    /// The pieces as one line. Every piece must have points.
    pub(super) fn joined(&self, strokes: &[Stroke]) -> Joined {
        let mut points: Vec<Point> = Vec::new();
        let mut ranges = Vec::with_capacity(self.pieces.len());
        for &(stroke, reversed) in &self.pieces {
            let own = &strokes[stroke].points;
            let start = points.len();
            if reversed {
                points.extend(own.iter().rev());
            } else {
                points.extend(own);
            }
            ranges.push((start, points.len().max(start + 1) - 1));
        }
        let bare = |stroke: &Stroke| Stroke { points: Vec::new(), widths: Vec::new(), ..stroke.clone() };
        let attributes = self.pieces.first().map(|piece| bare(&strokes[piece.0]));
        let line = Stroke { points, closed: self.closed, ..attributes.unwrap_or_default() };
        let ring = self.closed && self.pieces.len() == 1 && strokes[self.pieces[0].0].closed;
        Joined { shares: vertex_shares(&line), line, ranges, ring }
    }
}

impl Joined {
    /// Whether the line is a closed stroke in one piece.
    pub fn is_one_ring(&self) -> bool {
        self.ring
    }

    /// The shares of the line's length at which a piece begins and ends.
    pub fn extent(&self, piece: usize) -> (f64, f64) {
        let (first, last) = self.ranges[piece];
        if self.ring {
            return (0.0, 1.0);
        }
        (self.shares[first], self.shares[last])
    }

    /// The shares, rising, at which one piece gives way to the next: in the middle of the gaps. The last one leads from
    /// the last piece to the first one; it is 1 or more where the line is closed, and infinite where it is open.
    pub fn cuts(&self) -> Vec<f64> {
        let count = self.ranges.len();
        let cut = |k: usize| {
            let (_, end) = self.extent(k);
            if k + 1 < count {
                0.5 * (end + self.extent(k + 1).0)
            } else if self.line.closed {
                0.5 * (end + 1.0 + self.extent(0).0)
            } else {
                f64::INFINITY
            }
        };
        (0..count).map(cut).collect()
    }

    /// The piece at a share of the line. Each gap belongs half to the piece before and half to the piece behind.
    pub fn piece_at(&self, share: f64) -> usize {
        let cuts = self.cuts();
        let last = cuts.len() - 1;
        // The last piece of a closed line may reach beyond the line's beginning.
        if self.line.closed && share < cuts[last] - 1.0 {
            return last;
        }
        // The first piece of a closed line may begin before the line's end.
        let first = if self.line.closed { 0 } else { last };
        cuts.iter().position(|&cut| share < cut).unwrap_or(first)
    }

    /// The share of a piece's own stroke at a share of the line. Places in a gap are at the nearer end.
    pub fn on_piece(&self, piece: usize, reversed: bool, share: f64) -> f64 {
        let (from, to) = self.extent(piece);
        let off = |share: f64| (from - share).max(share - to).max(0.0);
        // On a closed line a place just before its beginning is also one just beyond its end.
        let near = |a: f64, b: f64| if off(b) < off(a) { b } else { a };
        let share = if self.line.closed { near(near(share, share - 1.0), share + 1.0) } else { share };
        let along = if to > from { ((share - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        if reversed { 1.0 - along } else { along }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(from: f64, to: f64) -> Stroke {
        Stroke::new(vec![Point::new(from, 0.0), Point::new(0.5 * (from + to), 0.0), Point::new(to, 0.0)], false)
    }

    #[test]
    fn places_on_the_line_are_places_on_the_pieces() {
        let strokes = [bar(0.0, 40.0), bar(100.0, 60.0)];
        let chain = Chain { pieces: vec![(0, false), (1, true)], closed: false };
        let joined = chain.joined(&strokes);
        assert_eq!(joined.line.points.len(), 6);
        assert_eq!((joined.extent(0), joined.extent(1)), ((0.0, 0.4), (0.6, 1.0)));
        assert_eq!(joined.cuts(), [0.5, f64::INFINITY]);
        assert_eq!(joined.on_piece(0, false, 0.1), 0.25);
        assert!((joined.on_piece(1, true, 0.7) - 0.75).abs() < 1e-12);
        assert_eq!(joined.on_piece(0, false, 0.48), 1.0);
        assert_eq!(joined.on_piece(1, true, 0.55), 1.0);
    }

    #[test]
    fn a_closed_line_leads_back() {
        let side = |a: (f64, f64), b: (f64, f64)| Stroke::new(vec![Point::from(a), Point::from(b)], false);
        let strokes = [side((0.0, 0.0), (8.0, 0.0)), side((10.0, 0.0), (4.0, 9.0))];
        let chain = Chain { pieces: vec![(0, false), (1, false)], closed: true };
        let joined = chain.joined(&strokes);
        let cuts = joined.cuts();
        assert!(cuts[0] < cuts[1] && cuts[1] < 1.0, "{cuts:?}");
        assert_eq!(joined.on_piece(0, false, 0.999), 0.0);
        assert_eq!(joined.on_piece(0, false, 1.0), 0.0);
    }
}
