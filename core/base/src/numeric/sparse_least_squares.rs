//! Levenberg–Marquardt for sparse non-linear least squares, with linear equality constraints.
//!
//! Minimises E(x) = ‖r(x)‖² over x. A problem may add constraints Cx = b. Each iteration solves
//!
//! ```text
//! (JᵀJ + λ diag(JᵀJ)) d = −Jᵀr − Cᵀμ,   Cd = 0
//! ```
//!
//! and takes the step if it lowers E. Otherwise λ grows, and the same equations are solved again (Marquardt 1963; Nocedal &
//! Wright, *Numerical Optimization*, 2006, §10.3). Sparse Cholesky factors the left matrix M; its pattern is analysed once
//! for all iterations ([`DampedSystem`]). μ solves the small dense system (C M⁻¹ Cᵀ) μ = −C M⁻¹ Jᵀr. Each constraint costs one
//! more back substitution, so there should be few. If the start satisfies the constraints, all points do, up to rounding.
//!
//! The gain ratio ρ compares the decrease of E with the decrease that the linear model predicted, and sets λ (Nielsen 1999).
//! After a good step λ shrinks by the factor max(1/3, 1 − (2ρ − 1)³). After each refusal in a row it grows by 2, 4, 8, ….

use super::damped_system::DampedSystem;
use super::normal_equations::NormalEquations;
use nalgebra::{DMatrix, DVector};
use std::ops::ControlFlow;

/// A sum of squares to minimise.
pub trait Problem {
    /// Number of variables.
    fn variables(&self) -> usize;

    /// Number of residuals.
    fn residuals(&self) -> usize;

    /// (residual, variable) of each entry of the Jacobian, the same for every x. Values of repeated pairs add up.
    fn pattern(&self) -> Vec<(usize, usize)>;

    /// Writes r(x).
    fn evaluate(&self, x: &[f64], residuals: &mut [f64]);

    /// Writes r(x) and the values of the Jacobian in the order of the pattern.
    fn linearise(&self, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]);

    /// Rows of C as (variable, coefficient). No step changes these sums. The rows must be linearly independent.
    fn constraints(&self) -> Vec<Vec<(usize, f64)>> {
        Vec::new()
    }
}

/// When to stop, and the damping at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LmOptions {
    /// Greatest number of steps, taken and refused.
    pub max_iterations: usize,
    /// Stop when a step lowers the cost by less than this share of it.
    pub cost_tolerance: f64,
    /// Stop when no variable moves farther than this, in the unit of the variables.
    pub step_tolerance: f64,
    /// λ at the start.
    pub initial_damping: f64,
}

impl Default for LmOptions {
    fn default() -> Self {
        Self { max_iterations: 100, cost_tolerance: 1e-6, step_tolerance: 1e-6, initial_damping: 1e-3 }
    }
}

/// Why the iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LmTermination {
    /// There are no variables.
    NoVariables,
    /// The last step lowered the cost by less than the tolerance.
    CostConverged,
    /// The last step was shorter than the tolerance.
    StepConverged,
    /// No damping up to [`MAX_DAMPING`] gives a step that lowers the cost, or the cost at the start is not finite.
    NoDescent,
    /// The limit of iterations was reached.
    IterationLimit,
    /// The caller asked to stop.
    Interrupted,
}

/// How the minimisation went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LmSummary {
    /// Why it ended.
    pub termination: LmTermination,
    /// Linear systems solved: steps taken and refused.
    pub iterations: usize,
    /// ‖r‖² at the start.
    pub initial_cost: f64,
    /// ‖r‖² at the end; never above the one at the start.
    pub final_cost: f64,
}

/// Greatest damping. A step with more would be too short to matter, so the search for a descent ends.
pub const MAX_DAMPING: f64 = 1e12;

/// Minimises from `x`, and replaces `x` by the best point found. Before every linear system `each` gets the iteration and its
/// cost, and may stop the iteration.
pub fn minimise(
    problem: &impl Problem,
    x: &mut [f64],
    options: &LmOptions,
    mut each: impl FnMut(usize, f64) -> ControlFlow<()>,
) -> LmSummary {
    let mut state = State::new(problem, x);
    let initial_cost = state.cost;
    let summary = |termination, iterations, final_cost| LmSummary { termination, iterations, initial_cost, final_cost };
    if x.is_empty() {
        return summary(LmTermination::NoVariables, 0, initial_cost);
    }
    if !initial_cost.is_finite() {
        return summary(LmTermination::NoDescent, 0, initial_cost);
    }
    let mut damping = options.initial_damping;
    let mut growth = 2.0;
    for iteration in 0..options.max_iterations {
        if each(iteration, state.cost).is_break() {
            return summary(LmTermination::Interrupted, iteration, state.cost);
        }
        let before = state.cost;
        match state.try_step(problem, x, damping) {
            Some(step) => {
                let gain = (before - state.cost) / step.promised.max(f64::MIN_POSITIVE);
                damping = (damping * (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0)).max(1e-12);
                growth = 2.0;
                if step.longest <= options.step_tolerance {
                    return summary(LmTermination::StepConverged, iteration + 1, state.cost);
                }
                if before - state.cost <= options.cost_tolerance * before {
                    return summary(LmTermination::CostConverged, iteration + 1, state.cost);
                }
                state.linearise(problem, x);
            }
            None => {
                damping *= growth;
                growth *= 2.0;
                if damping > MAX_DAMPING {
                    return summary(LmTermination::NoDescent, iteration + 1, state.cost);
                }
            }
        }
    }
    summary(LmTermination::IterationLimit, options.max_iterations, state.cost)
}

/// A step that was taken.
struct Step {
    /// Largest change of a variable.
    longest: f64,
    /// Decrease of the cost that the linear model predicted.
    promised: f64,
}

/// The problem linearised at the current point, and the memory that iterations share.
struct State {
    equations: NormalEquations,
    system: DampedSystem,
    constraints: Vec<Vec<(usize, f64)>>,
    jacobian: Vec<f64>,
    residuals: Vec<f64>,
    trial_residuals: Vec<f64>,
    trial: Vec<f64>,
    cost: f64,
}

impl State {
    fn new(problem: &impl Problem, x: &[f64]) -> Self {
        let (n, m) = (problem.variables(), problem.residuals());
        assert_eq!(x.len(), n, "the start must have a value for each variable");
        let pattern = problem.pattern();
        let equations = NormalEquations::new(m, n, &pattern);
        let mut state = Self {
            constraints: problem.constraints(),
            jacobian: vec![0.0; pattern.len()],
            residuals: vec![0.0; m],
            trial_residuals: vec![0.0; m],
            trial: vec![0.0; n],
            cost: 0.0,
            system: DampedSystem::new(&equations),
            equations,
        };
        state.linearise(problem, x);
        state.cost = squared_norm(&state.residuals);
        state
    }

    fn linearise(&mut self, problem: &impl Problem, x: &[f64]) {
        problem.linearise(x, &mut self.residuals, &mut self.jacobian);
        self.equations.assemble(&self.jacobian, &self.residuals);
    }

    /// Solves for a step and takes it if it lowers the cost.
    fn try_step(&mut self, problem: &impl Problem, x: &mut [f64], damping: f64) -> Option<Step> {
        let step = self.solve(damping)?;
        for ((trial, &x), &d) in self.trial.iter_mut().zip(&*x).zip(&step) {
            *trial = x + d;
        }
        problem.evaluate(&self.trial, &mut self.trial_residuals);
        let cost = squared_norm(&self.trial_residuals);
        if cost >= self.cost || cost.is_nan() {
            return None;
        }
        x.copy_from_slice(&self.trial);
        self.cost = cost;
        let longest = step.iter().fold(0.0, |longest: f64, d| longest.max(d.abs()));
        Some(Step { longest, promised: self.promised(&step, damping) })
    }

    /// −2 dᵀJᵀr − dᵀJᵀJd, where dᵀJᵀJd = −dᵀJᵀr − λ dᵀDd along the step.
    fn promised(&self, step: &[f64], damping: f64) -> f64 {
        let coefficients = self.equations.diagonal().iter().zip(self.equations.gradient());
        step.iter()
            .zip(coefficients)
            .map(|(&d, (&diagonal, &gradient))| damping * diagonal * d * d - d * gradient)
            .sum()
    }

    /// The damped step; `None` if the matrix cannot be factored.
    fn solve(&mut self, damping: f64) -> Option<Vec<f64>> {
        self.system.factor(&self.equations, damping).ok()?;
        let mut step: Vec<f64> = self.equations.gradient().iter().map(|g| -g).collect();
        self.system.solve(&self.equations, &mut step);
        self.restrict(&mut step)?;
        step.iter().all(|d| d.is_finite()).then_some(step)
    }

    /// Removes the part of a step that would change the constrained sums, in the metric of M.
    fn restrict(&mut self, step: &mut [f64]) -> Option<()> {
        if self.constraints.is_empty() {
            return Some(());
        }
        let columns: Vec<Vec<f64>> = (0..self.constraints.len())
            .map(|k| {
                let mut column = vec![0.0; step.len()];
                self.constraints[k].iter().for_each(|&(j, c)| column[j] = c);
                self.system.solve(&self.equations, &mut column);
                column
            })
            .collect();
        let along = |row: &[(usize, f64)], v: &[f64]| row.iter().map(|&(j, c)| c * v[j]).sum::<f64>();
        let count = self.constraints.len();
        let matrix = DMatrix::from_fn(count, count, |i, j| along(&self.constraints[i], &columns[j]));
        let sums = DVector::from_fn(count, |i, _| along(&self.constraints[i], step));
        let multipliers = matrix.cholesky()?.solve(&sums);
        for (column, multiplier) in columns.iter().zip(&multipliers) {
            step.iter_mut().zip(column).for_each(|(d, c)| *d -= multiplier * c);
        }
        Some(())
    }
}

fn squared_norm(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley: r = (10 (y − x²), 1 − x), least at (1, 1).
    struct Rosenbrock {
        constrained: bool,
    }

    impl Problem for Rosenbrock {
        fn variables(&self) -> usize {
            2
        }
        fn residuals(&self) -> usize {
            2
        }
        fn pattern(&self) -> Vec<(usize, usize)> {
            vec![(0, 0), (0, 1), (1, 0)]
        }
        fn evaluate(&self, x: &[f64], residuals: &mut [f64]) {
            residuals.copy_from_slice(&[10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]);
        }
        fn linearise(&self, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
            self.evaluate(x, residuals);
            jacobian.copy_from_slice(&[-20.0 * x[0], 10.0, -1.0]);
        }
        fn constraints(&self) -> Vec<Vec<(usize, f64)>> {
            if self.constrained { vec![vec![(0, 1.0), (1, 1.0)]] } else { Vec::new() }
        }
    }

    fn run(problem: &Rosenbrock, options: &LmOptions) -> ([f64; 2], LmSummary) {
        let mut x = [-1.2, 1.0];
        let summary = minimise(problem, &mut x, options, |_, _| ControlFlow::Continue(()));
        (x, summary)
    }

    #[test]
    fn the_bottom_of_the_valley_is_found() {
        let (x, summary) = run(&Rosenbrock { constrained: false }, &LmOptions::default());
        assert!((x[0] - 1.0).abs() < 1e-5 && (x[1] - 1.0).abs() < 1e-5, "{x:?} {summary:?}");
        assert!((summary.initial_cost - 24.2).abs() < 1e-9 && summary.final_cost < 1e-9);
        assert!(matches!(summary.termination, LmTermination::StepConverged | LmTermination::CostConverged));
    }

    #[test]
    fn a_constrained_sum_never_changes() {
        let (x, summary) = run(&Rosenbrock { constrained: true }, &LmOptions::default());
        assert!((x[0] + x[1] + 0.2).abs() < 1e-12, "{x:?}");
        // The least cost on the line x + y = −0.2, by a fine search along it.
        let cost = |x: f64| (10.0 * (-0.2 - x - x * x)).powi(2) + (1.0 - x).powi(2);
        let least = (-200_000..200_000).map(|k| cost(k as f64 * 1e-5)).fold(f64::INFINITY, f64::min);
        assert!(summary.final_cost < least * 1.0001 + 1e-9, "{summary:?}, {least}");
    }

    #[test]
    fn every_end_has_its_name() {
        let few = LmOptions { max_iterations: 2, ..LmOptions::default() };
        assert_eq!(run(&Rosenbrock { constrained: false }, &few).1.termination, LmTermination::IterationLimit);
        let loose = LmOptions { cost_tolerance: 1.0, ..LmOptions::default() };
        assert_eq!(run(&Rosenbrock { constrained: false }, &loose).1.termination, LmTermination::CostConverged);
        let mut x = [f64::NAN, 0.0];
        let summary = minimise(&Rosenbrock { constrained: false }, &mut x, &LmOptions::default(), |_, _| {
            ControlFlow::Continue(())
        });
        assert_eq!(summary.termination, LmTermination::NoDescent);
        let mut x = [0.0, 0.0];
        let stop = |k: usize, _: f64| if k == 1 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let summary = minimise(&Rosenbrock { constrained: false }, &mut x, &LmOptions::default(), stop);
        assert_eq!(summary.termination, LmTermination::Interrupted);
    }
}
