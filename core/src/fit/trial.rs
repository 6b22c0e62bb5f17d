//! A section fitted with a given number of nodes.
//!
//! Parameters come from the profile's cuts, nodes from one linear solve for these parameters; then a few Gauss–Newton steps
//! on the squared distances, then steps on the excess over the tolerance. It ends as soon as every point is within the
//! limit, or when steps no longer help.

use super::profile::Profile;
use super::section::{Arc, End, Ends, Slot};
use super::solve::{Errors, Goal, Step, Track, arcs};
use crate::geometry::Point;

/// Weight along the curve in the first steps after the linear one.
const FIRST_SLIDE: f64 = 0.2;
/// Weight along the curve in the later least-squares steps.
const SLIDE: f64 = 0.02;
/// Share of the limit at which excess begins.
const THRESHOLD: f64 = 0.93;
/// A fit whose largest error is above this multiple of the limit after the least-squares steps is given up.
const HOPELESS: f64 = 3.5;

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
        let mut track = Track { points: self.points, parameters };
        let mut step = Step::new(self.ends, &slots, nodes.len());
        let mut now = nodes;
        if linear {
            step.gather(&now, &mut track, Goal::Squares(1.0), false);
            advance(&mut now, &mut step, 0.0);
        }
        let mut best: Option<(Vec<Point>, Vec<f64>, Errors)> = None;
        let keep = |best: &mut Option<(Vec<Point>, Vec<f64>, Errors)>, nodes: &[Point], track: &Track, errors: Errors| {
            if best.as_ref().is_none_or(|(.., old)| errors.largest < old.largest) {
                *best = Some((nodes.to_vec(), track.parameters.clone(), errors));
            }
        };
        for k in 0..effort.squares + effort.excess {
            let goal = match k {
                0 if linear => Goal::Squares(FIRST_SLIDE),
                _ if k < effort.squares => Goal::Squares(SLIDE),
                _ => Goal::Within(THRESHOLD * self.limit),
            };
            let errors = step.gather(&now, &mut track, goal, true);
            keep(&mut best, &now, &track, errors);
            let hopeless = k >= effort.squares && errors.largest > HOPELESS * self.limit;
            if errors.largest <= self.limit || hopeless || !advance(&mut now, &mut step, 0.0) {
                break;
            }
        }
        let last = step.gather(&now, &mut track, Goal::Squares(1.0), true);
        keep(&mut best, &now, &track, last);
        let (nodes, parameters, errors) = best.unwrap_or((now, track.parameters, last));
        Trial { nodes, slots, parameters, errors }
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

fn advance(nodes: &mut [Point], step: &mut Step, damping: f64) -> bool {
    let Some(moves) = step.solve(damping) else { return false };
    for (node, by) in nodes.iter_mut().zip(moves) {
        *node += by;
    }
    true
}
