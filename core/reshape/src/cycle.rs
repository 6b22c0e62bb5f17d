//! Clips that go round: the last posture is the first, apart from the way along the ground.
//!
//! A cycle has no ends. What stands, fades and is interpolated beside a frame needs what comes before and after it, and of a cycle that
//! is known: the same again. So a cycle is repeated before and after, the work is done on all of it, and the middle is taken. The result
//! then goes round as well, and a standing foot does not know where the clip begins.
//!
//! Limits: a cycle without its last frame (the first again) is not known as one.

use rototoon_base::geometry::Point;
use rototoon_base::scene::Template;

/// Two postures are one if their key points are this near, as a root mean square in torso lengths.
const ONE_POSTURE: f64 = 0.01;
/// Fewest frames of a cycle.
const LEAST: usize = 4;
/// Frames before and after the middle, at least. Corrections fade over fewer.
const BESIDE: usize = 12;

/// A clip that goes round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cycle {
    /// Frames after which it is the same again.
    period: usize,
    /// How often it is repeated before the middle, and after.
    times: usize,
    /// Its way.
    step: Point,
}

impl Cycle {
    /// The cycle of postures; `None` if they do not go round.
    pub fn of(template: &Template, postures: &[Vec<Point>]) -> Option<Self> {
        let (first, last) = (postures.first()?, postures.last()?);
        let period = postures.len() - 1;
        let step = Point::new(last[0].x - first[0].x, 0.0);
        let square: f64 = first.iter().zip(last).map(|(a, b)| (*a + step).distance_squared(*b)).sum();
        let off = (square / first.len().max(1) as f64).sqrt();
        let goes_round = period >= LEAST && off <= ONE_POSTURE * template.torso_length(first);
        goes_round.then(|| Self { period, times: BESIDE.div_ceil(period), step })
    }

    /// The frame of the middle's first posture.
    fn start(&self) -> usize {
        self.period * self.times
    }

    /// The frame of the cycle that a frame of the repeated clip shows.
    fn frame(&self, repeated: usize) -> usize {
        repeated % self.period
    }

    /// Number of frames of the repeated clip. It ends as it begins.
    fn len(&self) -> usize {
        self.period * (2 * self.times + 1) + 1
    }

    /// Values of the cycle on every frame of the repeated clip.
    pub fn repeated<T: Clone>(&self, values: &[T]) -> Vec<T> {
        (0..self.len()).map(|t| values[self.frame(t)].clone()).collect()
    }

    /// Postures of the cycle on every frame of the repeated clip, in a unit of `size` of the postures that the cycle was found in.
    pub fn walked(&self, postures: &[Vec<Point>], size: f64) -> Vec<Vec<Point>> {
        let way = |t: usize| self.step * (size * ((t / self.period) as f64 - self.times as f64));
        (0..self.len()).map(|t| postures[self.frame(t)].iter().map(|p| *p + way(t)).collect()).collect()
    }

    /// Times of the cycle's postures, for every posture of the repeated clip.
    pub fn timed(&self, times: &[f64]) -> Vec<f64> {
        let round = times[self.period] - times[0];
        (0..self.len()).map(|t| times[self.frame(t)] + round * (t / self.period) as f64).collect()
    }

    /// The middle of values on every frame of the repeated clip.
    pub fn middle<'a, T>(&self, values: &'a [T]) -> &'a [T] {
        &values[self.start()..=self.start() + self.period]
    }
}

#[cfg(test)]
mod tests {
    use super::super::contacts::tests::walk;
    use super::*;

    #[test]
    fn a_cycle_is_known_by_its_ends_and_walks_on() {
        let human = Template::human();
        let clip = walk(25, true);
        let cycle = Cycle::of(&human, &clip).unwrap();
        assert_eq!((cycle.period, cycle.times), (24, 1));
        let long = cycle.walked(&clip, 1.0);
        let truth = walk(73, true);
        for (t, (made, wanted)) in long.iter().zip(&truth).enumerate() {
            let way = Point::new(24.0 * 4.0, 0.0);
            assert!(made.iter().zip(wanted).all(|(a, b)| (*a + way).distance(*b) < 1e-9), "frame {t}");
        }
        assert_eq!((long.len(), cycle.middle(&long).len()), (73, 25));
        assert_eq!(cycle.repeated(&[7; 25]).len(), 73);
        assert_eq!(Cycle::of(&human, &walk(20, true)), None, "it ends in another posture");
        assert_eq!(Cycle::of(&human, &clip[..3]), None);
        assert_eq!(Cycle::of(&human, &[]), None);
    }
}
