//! A section fitted with a given number of nodes.
//!
//! Parameters come from the profile's cuts, nodes from one linear solve for these parameters; then a few Gauss–Newton
//! steps on the squared distances, then steps on the excess over the tolerance. It ends as soon as every point is
//! within the limit, or when steps no longer help.

use super::feet::wrapped;
use super::profile::Profile;
use super::section::{Arc, End, Ends, Slot};
use super::solve::{Errors, Goal, Step, Track, arcs};
use rototoon_base::geometry::Point;
use rototoon_base::geometry::polyline::nearest_on_segment;

/// Weight along the curve in the first steps after the linear one.
const FIRST_SLIDE: f64 = 0.2;
/// Weight along the curve in the later least-squares steps.
const SLIDE: f64 = 0.02;
/// Share of the limit at which excess begins.
const THRESHOLD: f64 = 0.8;
/// A fit whose largest error is above this multiple of the limit after the least-squares steps is given up.
const HOPELESS: f64 = 3.5;
/// With each step, what is left to that multiple must fall to this share.
const PATIENCE: f64 = 0.8;

/// Points a piece that the least-squares steps look at.
const SAMPLES: usize = 12;
/// Least-squares steps that tell whether a start is promising.
const PROMISE: usize = 2;
/// Pieces on each side of a change that such steps move.
const NEAR: usize = 3;
/// Of so many steps on the excess one looks at all points.
const FULL_EVERY: usize = 4;
/// A point is in danger if its error is above this share of the limit.
const DANGER: f64 = 0.45;

/// Between the feet of neighbours the curve may be off their segment by this multiple of the limit: it may still be
/// near the next segment, which the final measure knows.
const STRAY: f64 = 1.25;

/// How much work a trial may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// Least-squares steps.
    pub squares: usize,
    /// Steps on the excess.
    pub excess: usize,
}

/// The points of a section, in order, with their arc lengths; of a closed section the first is not repeated.
#[derive(Clone, Debug)]
pub(super) struct Given<'a> {
    pub points: &'a [Point],
    pub lengths: &'a [f64],
    /// Arc length of the whole, the closing stretch included.
    pub total: f64,
    pub ends: Ends,
    /// Nodes that are given: first two, last two, as far as `ends` holds them.
    pub held: [Point; 4],
    /// Largest distance allowed.
    pub limit: f64,
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
    /// Nodes and parameters for these cuts between pieces.
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

    /// Puts the given nodes, and free ends, in their places.
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

    /// Fits from a start. `linear` begins with the linear solve for the start's parameters.
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

    /// Points enough to tell the shape of so many pieces.
    pub fn strided(&self, pieces: usize) -> Vec<usize> {
        let all = self.points.len();
        let stride = (all / (SAMPLES * pieces).max(1)).max(1);
        let mut strided: Vec<usize> = (0..all).step_by(stride).collect();
        if strided.last().is_some_and(|&last| last + 1 < all) {
            strided.push(all - 1);
        }
        strided
    }

    /// How promising a start is that differs from a good fit about piece `at`: the largest error near there, on some of
    /// the points, after a few least-squares steps of the nodes near there. Only the parameters of the strided points
    /// count.
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

    /// The first point after which the curve does not keep near the points' line: it might turn off and come back
    /// between the feet of two neighbours. Looks at the middle of each such stretch. Else the point with the largest
    /// error, if that is above the limit.
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
            // Joints inside a stretch are where it bends: their sides are looked at one by one.
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

    /// Cuts between the pieces of a fit by arc length of the points, and the largest error of each piece.
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
        // A piece without points takes an even share between its neighbours; cuts never fall.
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

/// A running trial.
struct Work<'a, 'b> {
    given: &'a Given<'a>,
    track: Track<'a>,
    step: Step<'b>,
    nodes: Vec<Point>,
    best: Option<(Vec<Point>, Vec<f64>, Errors)>,
    /// Points enough to tell the shape.
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

    /// Parameters of the points between those of the least-squares steps.
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

    /// Steps on the excess: all points now and then (but those that are sure to be within the limit), in between those
    /// that are in danger of it.
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
                    // Perhaps done: the others have a say before the next step.
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
