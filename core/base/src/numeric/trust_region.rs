//! Gauss–Newton in a trust region, with steps by truncated conjugate gradients (Steihaug 1983).
//!
//! Minimises E(x) = ‖r(x)‖² over points in the plane. Each iteration minimises the model
//!
//! ```text
//! m(d) = E + 2 gᵀd + dᵀHd,   g = Jᵀr,  H = JᵀJ
//! ```
//!
//! by preconditioned conjugate gradients from d = 0. They stop when the residual is small, or when a point would leave the
//! region; the last direction is then cut at the border. The region bounds the distance that each single point moves, in the
//! unit of the points. The meaning of its radius does not depend on the number of points. (Steihaug's proof that the steps
//! grow is for the Euclidean norm of all variables. Here the first crossing of any point counts, which is a descent too.)
//!
//! ρ is the decrease of E divided by the predicted decrease. The radius becomes a quarter if ρ < 1/4, and doubles if ρ > 3/4
//! and the border was reached. A step that does not lower E is refused (Nocedal & Wright 2006, algorithm 4.1).
//!
//! Linear equality constraints are a projection. Every vector is projected, so the iteration never leaves the subspace. H may
//! be singular: x does not change along its null space.

use std::ops::ControlFlow;

/// A sum of squares over points. The variables are x and y of each point in turn.
pub trait Objective {
    /// E at `x`.
    fn cost(&self, x: &[f64]) -> f64;

    /// E at `x`. Also sets g and H to those of `x`.
    fn linearise(&mut self, x: &[f64]) -> f64;

    /// g = Jᵀr.
    fn gradient(&self) -> &[f64];

    /// `product` = H `v`.
    fn multiply(&self, v: &[f64], product: &mut [f64]);

    /// Replaces `v` by an approximation of H⁻¹ `v`. The approximation must be symmetric and positive definite.
    fn precondition(&self, v: &mut [f64]);

    /// Removes the part of `v` that the constraints forbid.
    fn project(&self, v: &mut [f64]);
}

/// When to stop, and how far a step may go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrustOptions {
    /// Radius at the start, and the greatest: how far a point may move in one step.
    pub radius: f64,
    /// Stop when the radius falls below this.
    pub smallest_radius: f64,
    /// Stop when no point moves farther than this.
    pub step_tolerance: f64,
    /// Stop when a step lowers the cost by less than this share of it.
    pub cost_tolerance: f64,
    /// Greatest number of steps, taken and refused.
    pub max_iterations: usize,
    /// Greatest number of conjugate directions for each step.
    pub max_directions: usize,
}

/// Why the iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrustTermination {
    /// The last step was shorter than the tolerance.
    StepConverged,
    /// The last step lowered the cost by less than the tolerance.
    CostConverged,
    /// The region shrank below its smallest radius, or the cost at the start is not finite.
    NoDescent,
    /// The limit of iterations was reached.
    IterationLimit,
    /// The caller asked to stop.
    Interrupted,
}

/// How the minimisation went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrustSummary {
    /// Why it ended.
    pub termination: TrustTermination,
    /// Steps taken and refused.
    pub iterations: usize,
    /// E at the start.
    pub initial_cost: f64,
    /// E at the end; never above the one at the start.
    pub final_cost: f64,
}

/// Conjugate gradients stop when the residual is below this share of the gradient's norm.
const RESIDUAL: f64 = 1e-2;

/// Minimises from `x`, and replaces `x` by the best point found. Before every step `each` gets the iteration and may stop it.
///
/// Panics unless the number of variables is even.
pub fn minimise(
    objective: &mut impl Objective,
    x: &mut [f64],
    options: &TrustOptions,
    mut each: impl FnMut(usize) -> ControlFlow<()>,
) -> TrustSummary {
    assert!(x.len().is_multiple_of(2), "points have two coordinates");
    let mut cost = objective.linearise(x);
    let initial_cost = cost;
    let summary =
        |termination, iterations, final_cost| TrustSummary { termination, iterations, initial_cost, final_cost };
    if !cost.is_finite() {
        return summary(TrustTermination::NoDescent, 0, cost);
    }
    let mut radius = options.radius;
    for iteration in 0..options.max_iterations {
        if each(iteration).is_break() {
            return summary(TrustTermination::Interrupted, iteration, cost);
        }
        let step = truncated_step(objective, radius, options.max_directions);
        let longest = largest_way(&step.way);
        if longest <= options.step_tolerance {
            return summary(TrustTermination::StepConverged, iteration, cost);
        }
        let trial: Vec<f64> = x.iter().zip(&step.way).map(|(x, d)| x + d).collect();
        let after = objective.cost(&trial);
        let gain = if after.is_finite() { (cost - after) / step.promised } else { -1.0 };
        if gain < 0.25 {
            radius = 0.25 * longest;
        } else if gain > 0.75 && step.cut {
            radius = (2.0 * radius).min(options.radius);
        }
        if gain > 0.0 {
            let saved = cost - after;
            x.copy_from_slice(&trial);
            if saved <= options.cost_tolerance * cost {
                return summary(TrustTermination::CostConverged, iteration + 1, after);
            }
            cost = objective.linearise(x);
        }
        if radius < options.smallest_radius {
            return summary(TrustTermination::NoDescent, iteration + 1, cost);
        }
    }
    summary(TrustTermination::IterationLimit, options.max_iterations, cost)
}

/// A step within the region.
struct Step {
    way: Vec<f64>,
    /// E − m(d), positive.
    promised: f64,
    /// Whether the border of the region cut the step.
    cut: bool,
}

/// Steihaug's truncated conjugate gradients.
fn truncated_step(objective: &impl Objective, radius: f64, max_directions: usize) -> Step {
    let n = objective.gradient().len();
    let mut way = vec![0.0; n];
    let mut image = vec![0.0; n];
    let mut residual: Vec<f64> = objective.gradient().iter().map(|g| -g).collect();
    objective.project(&mut residual);
    let gradient = residual.clone();
    let conditioned = |residual: &[f64]| {
        let mut v = residual.to_vec();
        objective.precondition(&mut v);
        objective.project(&mut v);
        v
    };
    let mut direction = conditioned(&residual);
    let mut energy = dot(&residual, &direction);
    let goal = RESIDUAL * RESIDUAL * energy;
    let mut product = vec![0.0; n];
    let mut cut = false;
    for _ in 0..max_directions {
        if energy <= goal || energy <= 0.0 {
            break;
        }
        objective.multiply(&direction, &mut product);
        objective.project(&mut product);
        let curvature = dot(&direction, &product);
        let border = way_to_border(&way, &direction, radius);
        let length = if curvature > 0.0 { energy / curvature } else { f64::INFINITY };
        cut = length >= border;
        let length = length.min(border);
        if !length.is_finite() {
            break;
        }
        add(&mut way, length, &direction);
        add(&mut image, length, &product);
        if cut {
            break;
        }
        add(&mut residual, -length, &product);
        let next = conditioned(&residual);
        let after = dot(&residual, &next);
        let share = after / energy;
        energy = after;
        direction.iter_mut().zip(&next).for_each(|(d, z)| *d = z + share * *d);
    }
    let promised = 2.0 * dot(&gradient, &way) - dot(&way, &image);
    Step { way, promised: promised.max(f64::MIN_POSITIVE), cut }
}

/// The distance along `direction` at which the first point reaches `radius`.
fn way_to_border(way: &[f64], direction: &[f64], radius: f64) -> f64 {
    let points = way.chunks_exact(2).zip(direction.chunks_exact(2));
    let of_point = |(w, d): (&[f64], &[f64])| {
        let (a, b) = (dot(d, d), dot(w, d));
        let c = radius * radius - dot(w, w);
        // The larger root of a s² + 2 b s = c, c ≥ 0 up to rounding.
        if a > 0.0 { (((b * b + a * c.max(0.0)).sqrt() - b) / a).max(0.0) } else { f64::INFINITY }
    };
    points.map(of_point).fold(f64::INFINITY, f64::min)
}

fn largest_way(way: &[f64]) -> f64 {
    way.chunks_exact(2).map(|d| dot(d, d)).fold(0.0, f64::max).sqrt()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(to: &mut [f64], factor: f64, what: &[f64]) {
    to.iter_mut().zip(what).for_each(|(a, b)| *a += factor * b);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// r = (10 (y − x²), 1 − x) for each point, least at (1, 1).
    struct Valleys {
        held: bool,
        gradient: Vec<f64>,
        blocks: Vec<[f64; 3]>,
    }

    impl Valleys {
        fn new(points: usize, held: bool) -> Self {
            Self { held, gradient: vec![0.0; 2 * points], blocks: vec![[0.0; 3]; points] }
        }
    }

    impl Objective for Valleys {
        fn cost(&self, x: &[f64]) -> f64 {
            x.chunks(2).map(|p| (10.0 * (p[1] - p[0] * p[0])).powi(2) + (1.0 - p[0]).powi(2)).sum()
        }
        fn linearise(&mut self, x: &[f64]) -> f64 {
            for (k, p) in x.chunks(2).enumerate() {
                let (r, s) = (10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]);
                let slope = -20.0 * p[0];
                self.gradient[2 * k] = slope * r - s;
                self.gradient[2 * k + 1] = 10.0 * r;
                self.blocks[k] = [slope * slope + 1.0, 10.0 * slope, 100.0];
            }
            self.cost(x)
        }
        fn gradient(&self) -> &[f64] {
            &self.gradient
        }
        fn multiply(&self, v: &[f64], product: &mut [f64]) {
            for (k, [a, b, c]) in self.blocks.iter().enumerate() {
                product[2 * k] = a * v[2 * k] + b * v[2 * k + 1];
                product[2 * k + 1] = b * v[2 * k] + c * v[2 * k + 1];
            }
        }
        fn precondition(&self, v: &mut [f64]) {
            for (k, [a, _, c]) in self.blocks.iter().enumerate() {
                v[2 * k] /= a;
                v[2 * k + 1] /= c;
            }
        }
        fn project(&self, v: &mut [f64]) {
            if self.held {
                v[..2].fill(0.0);
            }
        }
    }

    const OPTIONS: TrustOptions = TrustOptions {
        radius: 0.5,
        smallest_radius: 1e-9,
        step_tolerance: 1e-9,
        cost_tolerance: 0.0,
        max_iterations: 200,
        max_directions: 50,
    };

    #[test]
    fn the_bottoms_of_the_valleys_are_found() {
        let mut x = [-1.2, 1.0, 3.0, -1.0, 0.0, 0.0];
        let summary = minimise(&mut Valleys::new(3, false), &mut x, &OPTIONS, |_| ControlFlow::Continue(()));
        assert!(x.iter().all(|v| (v - 1.0).abs() < 1e-4), "{x:?} {summary:?}");
        assert!(summary.final_cost < 1e-8 && summary.initial_cost > 100.0);
    }

    #[test]
    fn what_the_projection_forbids_never_moves() {
        let mut x = [-1.2, 1.0, 3.0, -1.0];
        minimise(&mut Valleys::new(2, true), &mut x, &OPTIONS, |_| ControlFlow::Continue(()));
        assert_eq!(x[..2], [-1.2, 1.0]);
        assert!((x[2] - 1.0).abs() < 1e-4);
    }

    #[test]
    fn no_point_leaves_the_region() {
        let mut objective = Valleys::new(2, false);
        objective.linearise(&[8.0, -3.0, 1.0, 1.5]);
        for radius in [0.01, 0.3, 2.0] {
            let step = truncated_step(&objective, radius, 50);
            assert!(largest_way(&step.way) <= radius * (1.0 + 1e-9) && step.promised > 0.0);
        }
        let free = truncated_step(&objective, 1e9, 50);
        assert!(!free.cut);
        let mut product = vec![0.0; 4];
        objective.multiply(&free.way, &mut product);
        let rest: f64 = product.iter().zip(objective.gradient()).map(|(p, g)| (p + g).powi(2)).sum();
        assert!(rest.sqrt() < 0.1 * dot(objective.gradient(), objective.gradient()).sqrt());
    }

    #[test]
    fn every_end_has_its_name() {
        let run = |options: &TrustOptions, stop: bool| {
            let mut x = [-1.2, 1.0];
            let each = |_| if stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
            minimise(&mut Valleys::new(1, false), &mut x, options, each).termination
        };
        assert_eq!(run(&TrustOptions { max_iterations: 2, ..OPTIONS }, false), TrustTermination::IterationLimit);
        assert_eq!(run(&TrustOptions { cost_tolerance: 1.0, ..OPTIONS }, false), TrustTermination::CostConverged);
        assert_eq!(run(&TrustOptions { step_tolerance: 9.0, ..OPTIONS }, false), TrustTermination::StepConverged);
        assert_eq!(run(&OPTIONS, true), TrustTermination::Interrupted);
        let mut x = [f64::NAN, 0.0];
        let summary = minimise(&mut Valleys::new(1, false), &mut x, &OPTIONS, |_| ControlFlow::Continue(()));
        assert_eq!(summary.termination, TrustTermination::NoDescent);
    }
}
