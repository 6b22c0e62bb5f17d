//! A fit of a section with a given number of nodes.
//!
//! The parameters come from the profile's cuts. One linear solve for these parameters gives the nodes. A few
//! Gauss–Newton steps on the squared distances follow, then steps on the excess over the tolerance. The fit ends as
//! soon as every point is within the limit, or when further steps do not help.

use super::feet::wrapped;
use super::profile::Profile;
use super::section::{Arc, End, Ends, Slot};
use super::solve::{Errors, Goal, Step, Track, arcs};
use rototoon_base::geometry::Point;
use rototoon_base::geometry::polyline::nearest_on_segment;

/// Weight along the curve in the first step after the linear one.
const FIRST_SLIDE: f64 = 0.2;
/// Weight along the curve in the later least-squares steps.
const SLIDE: f64 = 0.02;
/// Share of the limit at which excess begins.
const THRESHOLD: f64 = 0.8;
/// A fit is given up if its largest error is above this multiple of the limit after the least-squares steps.
const HOPELESS: f64 = 3.5;
/// With each step, the tolerated excess over the limit shrinks by this factor.
const PATIENCE: f64 = 0.8;

/// Number of points per piece used by the least-squares steps.
const SAMPLES: usize = 12;
/// Number of least-squares steps that estimate whether a start is promising.
const PROMISE: usize = 2;
/// Number of pieces on each side of a change that these steps move.
const NEAR: usize = 3;
/// One in this many steps on the excess uses all points.
const FULL_EVERY: usize = 4;
/// A point is in danger if its error is above this share of the limit.
const DANGER: f64 = 0.45;

/// Between the feet of neighbouring points, the curve may be this multiple of the limit away from their segment. It may
/// still be near the next segment; the final measurement decides.
const STRAY: f64 = 1.25;

/// The amount of work of a trial.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// Least-squares steps.
    pub squares: usize,
    /// Steps on the excess.
    pub excess: usize,
}

/// The points of a section in order, with their arc lengths. A closed section does not repeat its first point.
#[derive(Clone, Debug)]
pub(super) struct Given<'a> {
    pub points: &'a [Point],
    pub lengths: &'a [f64],
    /// Arc length of the complete section, including the closing stretch.
    pub total: f64,
    pub ends: Ends,
    /// Given nodes: the first two and the last two. `ends` decides which of them count.
    pub held: [Point; 4],
    /// Largest distance allowed, in pixels.
    pub limit: f64,
    /// A limit below this follows the noise of the points, in pixels.
    pub floor: f64,
}

/// A fitted section.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    pub nodes: Vec<Point>,
    pub slots: Vec<Slot>,
    pub parameters: Vec<f64>,
    pub errors: Errors,
}

impl Given<'_> {
    /// A first guess of nodes and parameters from the profile.
    pub fn start(&self, nodes: usize, profile: &Profile) -> Trial {
        let slots = self.ends.slots(nodes);
        let cuts = profile.cut(slots.len());
        let parameters = self.parameters(&slots, &cuts);
        let mut guess = vec![Point::ZERO; nodes];
        let mut j = 0;
        for (slot, cut) in slots.iter().zip(cuts.windows(2)) {
            let middle = 0.5 * (cut[0] + cut[1]);
            while j + 1 < self.points.len() && self.lengths[j] < middle {
                j += 1;
            }
            guess[slot.nodes[1]] = self.points[j];
        }
        self.hold(&mut guess);
        Trial { nodes: guess, slots, parameters, errors: Errors::default() }
    }

    /// Puts the given nodes and the free ends in their places.
    fn hold(&self, nodes: &mut [Point]) {
        let Ends::Open(start, end) = self.ends else { return };
        let n = nodes.len();
        nodes[0] = if start == End::Free { self.points[0] } else { self.held[0] };
        nodes[n - 1] = if end == End::Free { self.points[self.points.len() - 1] } else { self.held[3] };
        if start == End::Joined {
            nodes[1] = self.held[1];
        }
        if end == End::Joined {
            nodes[n - 2] = self.held[2];
        }
    }

    fn parameters(&self, slots: &[Slot], cuts: &[f64]) -> Vec<f64> {
        let mut i = 0;
        let rest = |i: usize| (slots[i].nodes[0] == slots[i].nodes[1], slots[i].nodes[1] == slots[i].nodes[2]);
        let parameter = |&s: &f64| {
            while i + 2 < cuts.len() && cuts[i + 1] <= s {
                i += 1;
            }
            let width = cuts[i + 1] - cuts[i];
            let share = if width > 0.0 { ((s - cuts[i]) / width).clamp(0.0, 1.0) } else { 0.0 };
            i as f64
                + match rest(i) {
                    (true, false) => share.sqrt(),
                    (false, true) => 1.0 - (1.0 - share).sqrt(),
                    _ => share,
                }
        };
        self.lengths.iter().map(parameter).collect()
    }

    /// Fits from a start. With `linear` it begins with the linear solve for the start's parameters.
    pub fn run(&self, start: Trial, effort: Effort, linear: bool) -> Trial {
        let Trial { nodes, slots, parameters, .. } = start;
        let mut work = Work::new(self, &slots, nodes, parameters);
        work.squares(effort.squares, linear);
        work.interpolate();
        work.excess(effort.excess);
        let Work { best, nodes, track, .. } = work;
        let (nodes, parameters, errors) = best.unwrap_or((nodes, track.parameters, Errors::default()));
        Trial { nodes, slots, parameters, errors }
    }

    /// A selection of points that is enough to show the shape of this many pieces.
    pub fn strided(&self, pieces: usize) -> Vec<usize> {
        let all = self.points.len();
        let stride = (all / (SAMPLES * pieces).max(1)).max(1);
        let mut strided: Vec<usize> = (0..all).step_by(stride).collect();
        if strided.last().is_some_and(|&last| last + 1 < all) {
            strided.push(all - 1);
        }
        strided
    }

    /// The promise of a start that differs from a good fit around piece `at`: the largest error near that piece after a
    /// few least-squares steps of the nodes near it. Only strided points are used, and only their parameters matter.
    pub fn promise(&self, start: Trial, at: usize) -> f64 {
        let pieces = start.slots.len();
        let apart = |i: usize| {
            let apart = i.abs_diff(at);
            if self.ends == Ends::Periodic { apart.min(pieces - apart) } else { apart }
        };
        let mut work = Work::new(self, &start.slots, start.nodes, start.parameters);
        work.step.hold_but(|i| apart(i) <= NEAR);
        let parameters = &work.track.parameters;
        work.strided.retain(|&j| apart((parameters[j] as usize).min(pieces - 1)) <= NEAR + 1);
        work.squares(PROMISE, false);
        let chosen = work.strided.iter().copied();
        work.step.gather(&work.nodes, &mut work.track, Goal::Squares(SLIDE), true, chosen).largest
    }

    /// A point where the fit fails: the point with the largest error, if that is above the limit. Otherwise the first
    /// point after which the curve leaves the points' line; it might turn off and come back between the feet of two
    /// neighbours. The middle of each stretch is tested.
    pub fn fault(&self, trial: &Trial) -> Option<usize> {
        if trial.errors.largest > self.limit {
            return Some(trial.errors.at);
        }
        let arcs = arcs(&trial.nodes, &trial.slots);
        let count = arcs.len() as f64;
        let n = self.points.len();
        let pairs = if self.ends == Ends::Periodic { n } else { n - 1 };
        let mut reached = trial.parameters[0];
        (0..pairs).find(|&j| {
            let k = (j + 1) % n;
            let mut next = trial.parameters[k];
            if self.ends == Ends::Periodic {
                next += ((reached - next) / count).round() * count;
            }
            let (from, to) = (reached, next.max(reached));
            reached = to;
            if to <= from {
                return false;
            }
            // A stretch with a joint inside bends there, so both sides are tested.
            let middle = |from: f64, to: f64| {
                let t = 0.5 * (from + to);
                let t = if t >= count && self.ends == Ends::Periodic { t - count } else { t };
                let i = (t.max(0.0) as usize).min(arcs.len() - 1);
                let place = arcs[i].point(t - i as f64);
                place.distance(nearest_on_segment(place, self.points[j], self.points[k])) <= STRAY * self.limit
            };
            let joint = from.floor() + 1.0;
            let near =
                if joint < to { middle(from, joint) && middle(joint, to) && to - from < 2.0 } else { middle(from, to) };
            !near
        })
    }

    /// The cuts between the pieces of a fit, by arc length of the points, and the largest error of each piece.
    pub fn measure(&self, trial: &Trial) -> (Vec<f64>, Vec<f64>) {
        let pieces = trial.slots.len();
        let arcs: Vec<Arc> = arcs(&trial.nodes, &trial.slots);
        let mut errors = vec![0.0f64; pieces];
        let mut cuts = vec![f64::NAN; pieces + 1];
        (cuts[0], cuts[pieces]) = (0.0, self.total);
        for (j, &t) in trial.parameters.iter().enumerate() {
            let i = (t as usize).min(pieces - 1);
            errors[i] = errors[i].max(arcs[i].point(t - i as f64).distance(self.points[j]));
            if i > 0 && cuts[i].is_nan() {
                cuts[i] = self.lengths[j];
            }
        }
        // Pieces without points share the gap between their neighbours evenly. Cuts never fall.
        let mut known = 0;
        for i in 1..=pieces {
            if cuts[i].is_nan() {
                continue;
            }
            cuts[i] = cuts[i].max(cuts[known]);
            for k in known + 1..i {
                cuts[k] = cuts[known] + (cuts[i] - cuts[known]) * (k - known) as f64 / (i - known) as f64;
            }
            known = i;
        }
        (cuts, errors)
    }
}

/// A trial in progress.
struct Work<'a, 'b> {
    given: &'a Given<'a>,
    track: Track<'a>,
    step: Step<'b>,
    nodes: Vec<Point>,
    best: Option<(Vec<Point>, Vec<f64>, Errors)>,
    /// Indices of the points that are enough to show the shape.
    strided: Vec<usize>,
}

impl<'a, 'b> Work<'a, 'b> {
    fn new(given: &'a Given<'a>, slots: &'b [Slot], nodes: Vec<Point>, parameters: Vec<f64>) -> Self {
        let all = given.points.len();
        Self {
            given,
            track: Track { points: given.points, parameters },
            step: Step::new(given.ends, slots, nodes.len(), all),
            nodes,
            best: None,
            strided: given.strided(slots.len()),
        }
    }

    /// Least-squares steps, on as many points as the shape needs.
    fn squares(&mut self, steps: usize, linear: bool) {
        for k in 0..steps + usize::from(linear) {
            let slide = match k {
                0 if linear => 1.0,
                1 if linear => FIRST_SLIDE,
                _ => SLIDE,
            };
            let follow = k > 0 || !linear;
            let chosen = self.strided.iter().copied();
            self.step.gather(&self.nodes, &mut self.track, Goal::Squares(slide), follow, chosen);
            if !self.advance() {
                break;
            }
        }
    }

    /// Interpolates the parameters of the points between those used by the least-squares steps.
    fn interpolate(&mut self) {
        let count = self.step.pieces() as f64;
        let periodic = self.given.ends == Ends::Periodic;
        for pair in self.strided.windows(2) {
            let (from, mut to) = (self.track.parameters[pair[0]], self.track.parameters[pair[1]]);
            if periodic && (to - from).abs() > 0.5 * count {
                to += if to < from { count } else { -count };
            }
            for j in pair[0] + 1..pair[1] {
                let t = from + (to - from) * (j - pair[0]) as f64 / (pair[1] - pair[0]) as f64;
                self.track.parameters[j] = if periodic { wrapped(t, count) } else { t };
            }
        }
    }

    /// Steps on the excess. From time to time a step uses all points, except those that are certainly within the limit.
    /// The steps between use only the points in danger.
    fn excess(&mut self, steps: usize) {
        let goal = Goal::Within(THRESHOLD * self.given.limit);
        let limit = self.given.limit;
        let mut danger: Vec<usize> = Vec::new();
        let mut bearable = (HOPELESS - 1.0) * limit;
        let mut since = FULL_EVERY;
        let mut taken = 0;
        loop {
            if since >= FULL_EVERY || taken == steps {
                let errors = self.look_at_all(goal);
                if errors.largest <= limit || errors.largest > limit + bearable || taken == steps {
                    return;
                }
                bearable *= PATIENCE.powi(since as i32);
                since = 0;
                danger.clear();
                danger.extend((0..self.given.points.len()).filter(|&j| self.step.distance(j) > DANGER * limit));
            } else {
                let chosen = danger.iter().copied();
                let errors = self.step.gather(&self.nodes, &mut self.track, goal, true, chosen);
                if errors.largest <= limit {
                    // The fit may be complete. The next pass tests the other points too.
                    since = FULL_EVERY;
                    continue;
                }
            }
            if !self.advance() {
                return;
            }
            taken += 1;
            since += 1;
        }
    }

    fn look_at_all(&mut self, goal: Goal) -> Errors {
        let unsure: Vec<usize> =
            (0..self.given.points.len()).filter(|&j| !self.step.is_sure(j, self.given.limit)).collect();
        let errors = self.step.gather(&self.nodes, &mut self.track, goal, true, unsure.into_iter());
        if self.best.as_ref().is_none_or(|(.., old)| errors.largest < old.largest) {
            self.best = Some((self.nodes.clone(), self.track.parameters.clone(), errors));
        }
        errors
    }

    fn advance(&mut self) -> bool {
        let Some(moves) = self.step.solve() else { return false };
        for (node, by) in self.nodes.iter_mut().zip(moves) {
            *node += by;
        }
        true
    }
}
