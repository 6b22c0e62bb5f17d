//! Time of one Levenberg–Marquardt iteration on the space-time energy of a part.
//!
//! An iteration is the work of the minimiser for an accepted step: residuals and Jacobian, normal equations, Cholesky
//! factor, solution, residuals at the new place. The symbolic analysis is done once and is not measured.
//!
//! With `ROTOTOON_DUMP=FOLDER` set, the damped normal equations of each size are written to that folder in MatrixMarket
//! form. `tests/bench_scipy.py` solves them.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use rototoon_base::geometry::Point;
use rototoon_base::numeric::damped_system::DampedSystem;
use rototoon_base::numeric::normal_equations::NormalEquations;
use rototoon_base::numeric::sparse_least_squares::Problem;
use rototoon_track::zhou2011::energy::edge::DistanceField;
use rototoon_track::zhou2011::energy::{Energy, Given, Layout, Weights};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

/// Damping of the matrices: the start value of the minimiser.
const DAMPING: f64 = 1e-3;

/// A blob of `points` points that moves and changes its shape over `frames` frames. Its true outline is the edge.
fn problem(frames: usize, points: usize) -> Energy {
    let layout = Layout::new(frames, points, true);
    let outline = |frame: f64, j: usize, wobble: f64| {
        let angle = j as f64 * std::f64::consts::TAU / points as f64;
        let radius = 80.0 + 12.0 * (3.0 * angle).sin() + wobble * (5.0 * angle + frame).cos();
        Point::from_angle(angle) * radius + Point::new(150.0 + 6.0 * frame, 160.0 + wobble * (0.4 * frame).sin())
    };
    let start = (0..frames).flat_map(|i| (0..points).map(move |j| outline(i as f64, j, 4.0))).collect();
    let field = |frame: usize| {
        let center = Point::new(150.0 + 6.0 * frame as f64, 160.0);
        DistanceField::from_fn((0, 0), 460, 320, move |x, y| {
            let p = Point::new(x as f64 + 0.5, y as f64 + 0.5) - center;
            (p.length() - 80.0 - 12.0 * (3.0 * p.to_angle()).sin()).abs() as u16
        })
    };
    let between = |frame: usize| frame > 0 && frame + 1 < frames;
    Energy::new(Given {
        layout,
        start,
        fixed: (0..frames * points).map(|k| !between(k / points)).collect(),
        distances: (0..frames).map(|frame| between(frame).then(|| field(frame))).collect(),
        centers: (0..frames)
            .map(|frame| between(frame).then(|| Point::new(150.0 + 6.0 * frame as f64, 160.0)))
            .collect(),
        corrected: vec![false; frames],
        samples: 10,
        weights: Weights::default(),
    })
}

/// The parts of the minimiser, prepared for an iteration.
struct Iteration {
    energy: Energy,
    x: Vec<f64>,
    residuals: Vec<f64>,
    jacobian: Vec<f64>,
    equations: NormalEquations,
    system: DampedSystem,
}

impl Iteration {
    fn new(energy: Energy) -> Self {
        let pattern = energy.pattern();
        let equations = NormalEquations::new(energy.residuals(), energy.variables(), &pattern);
        Self {
            x: energy.initial(),
            residuals: vec![0.0; energy.residuals()],
            jacobian: vec![0.0; pattern.len()],
            system: DampedSystem::new(&equations),
            equations,
            energy,
        }
    }

    fn assemble(&mut self) {
        self.energy.linearise(&self.x, &mut self.residuals, &mut self.jacobian);
        self.equations.assemble(&self.jacobian, &self.residuals);
    }

    fn solve(&mut self) -> Vec<f64> {
        self.system.factor(&self.equations, DAMPING).expect("damped normal equations are definite");
        let mut step: Vec<f64> = self.equations.gradient().iter().map(|g| -g).collect();
        self.system.solve(&self.equations, &mut step);
        step
    }

    fn run(&mut self) -> f64 {
        self.assemble();
        let step = self.solve();
        let there: Vec<f64> = self.x.iter().zip(&step).map(|(x, d)| x + d).collect();
        self.energy.evaluate(&there, &mut self.residuals);
        self.residuals.iter().map(|r| r * r).sum()
    }

    /// Writes the lower triangle of the complete matrix, long rows included, with the right-hand side as a comment line
    /// of numbers.
    fn dump(&mut self, path: &Path) -> std::io::Result<()> {
        self.assemble();
        let mut entries = BTreeMap::new();
        let (starts, rows) = (self.equations.column_starts(), self.equations.row_indices());
        for column in 0..self.x.len() {
            for k in starts[column]..starts[column + 1] {
                entries.insert((column, rows[k]), self.equations.values()[k]);
            }
            *entries.entry((column, column)).or_insert(0.0) += DAMPING * self.equations.diagonal()[column];
        }
        for (columns, values) in self.equations.long_rows() {
            for (k, (&row, a)) in columns.iter().zip(values).enumerate() {
                for (&column, b) in columns[..=k].iter().zip(values) {
                    *entries.entry((column as usize, row as usize)).or_insert(0.0) += a * b;
                }
            }
        }
        let mut out = std::io::BufWriter::new(std::fs::File::create(path)?);
        writeln!(out, "%%MatrixMarket matrix coordinate real symmetric")?;
        let rhs: Vec<String> = self.equations.gradient().iter().map(|g| (-g).to_string()).collect();
        writeln!(out, "%rhs {}", rhs.join(" "))?;
        writeln!(out, "{n} {n} {}", entries.len(), n = self.x.len())?;
        for ((column, row), value) in entries {
            writeln!(out, "{} {} {value:e}", row + 1, column + 1)?;
        }
        out.flush()
    }
}

fn iterations(criterion: &mut Criterion) {
    let dump = std::env::var_os("ROTOTOON_DUMP").map(std::path::PathBuf::from);
    let mut group = criterion.benchmark_group("solver");
    group.sample_size(20);
    for (frames, points) in [(12, 20), (25, 100)] {
        let name = format!("{frames}x{points}");
        let mut iteration = Iteration::new(problem(frames, points));
        if let Some(folder) = &dump {
            iteration.dump(&folder.join(format!("{name}.mtx"))).expect("the dump folder can be written to");
        }
        group.bench_function(BenchmarkId::new("iteration", &name), |b| b.iter(|| iteration.run()));
        iteration.assemble();
        group.bench_function(BenchmarkId::new("factor and solve", &name), |b| b.iter(|| iteration.solve()));
        group.bench_function(BenchmarkId::new("linearise and assemble", &name), |b| b.iter(|| iteration.assemble()));
    }
    group.finish();
}

criterion_group!(benches, iterations);
criterion_main!(benches);
