//! The space-time energy of Zhou & Xiao 2011 (eq. 1) for one part over one span:
//!
//! ```text
//! E = 8 E_L + 9 E_C + 3 E_A + 4 E_V + 4 E_E + 32 E_R
//! ```
//!
//! - [`length`]: change of the segments' lengths (2)
//! - [`curvature`]: change of the second differences (3, 4)
//! - [`area`]: change of the area (5)
//! - [`velocity`]: change of the points' velocity (6)
//! - [`edge`]: distance of the segments from drawn edges (7, 8)
//! - [`center`]: distance of the part's centre from where the region search found it (9)
//! - [`term`]: what a term reads and where its residuals go
//!
//! Every term is a sum of squares. So E is ‖r‖² of one long residual vector r, and [`Energy`] is a [`Problem`] for
//! Levenberg–Marquardt. Each term is written once, as a walk over its residuals with their derivatives. The sparsity
//! pattern, the values and the Jacobian come from the same walk into different [`Sink`]s.
//!
//! No term couples two parts, so each part is solved by itself.
//!
//! Keys and pins are not variables. Their derivatives are dropped, which eliminates them exactly. A corrected centre is
//! an equality constraint on the free points of its frame and replaces (9) there.

pub mod area;
pub mod center;
pub mod curvature;
pub mod edge;
pub mod length;
pub mod term;
pub mod velocity;

pub use term::{Curves, Layout, Sink, Term};

use edge::DistanceField;
use rototoon_base::geometry::Point;
use rototoon_base::numeric::sparse_least_squares::Problem;

/// The weights of eq. 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Of the length term.
    pub length: f64,
    /// Of the curvature term.
    pub curvature: f64,
    /// Of the area term.
    pub area: f64,
    /// Of the velocity term.
    pub velocity: f64,
    /// Of the edge term.
    pub edge: f64,
    /// Of the centre term.
    pub center: f64,
}

impl Default for Weights {
    /// As printed in the paper.
    fn default() -> Self {
        Self { length: 8.0, curvature: 9.0, area: 3.0, velocity: 4.0, edge: 4.0, center: 32.0 }
    }
}

/// What is given and what is fixed.
#[derive(Clone, Debug)]
pub struct Given {
    /// Order of the coordinates.
    pub layout: Layout,
    /// All points at the start. Keys and pins are in their places.
    pub start: Vec<Point>,
    /// Which points are fixed (keys and pins), in the order of `start`.
    pub fixed: Vec<bool>,
    /// Edge distances by frame. `None` at the keys and where there is no picture to compare with.
    pub distances: Vec<Option<DistanceField>>,
    /// Centre of the part by frame, where the region search found one.
    pub centers: Vec<Option<Point>>,
    /// Whether the artist set the centre, by frame. The start must have this centre already.
    pub corrected: Vec<bool>,
    /// Samples per segment in eq. 7.
    pub samples: usize,
    /// Weights of eq. 1.
    pub weights: Weights,
}

/// The energy as a least-squares problem in the free coordinates.
pub struct Energy {
    given: Given,
    length: length::Length,
    curvature: curvature::Curvature,
    area: area::Area,
    velocity: velocity::Velocity,
    edge: edge::Edge,
    center: center::Center,
    /// Variable of each coordinate, or `FIXED`.
    variable: Vec<u32>,
    /// Coordinate of each variable.
    coordinate: Vec<usize>,
    residuals: usize,
}

const FIXED: u32 = u32::MAX;

impl Energy {
    /// Builds the energy of a part.
    pub fn new(mut given: Given) -> Self {
        let layout = given.layout;
        let mut variable = vec![FIXED; layout.coordinates()];
        let mut coordinate = Vec::new();
        for (c, slot) in variable.iter_mut().enumerate() {
            if !given.fixed[c / 2] {
                *slot = coordinate.len() as u32;
                coordinate.push(c);
            }
        }
        let centers = given.centers.iter().zip(&given.corrected).map(|(&c, &corrected)| c.filter(|_| !corrected));
        let mut energy = Self {
            length: length::Length,
            curvature: curvature::Curvature,
            area: area::Area::new(Curves { layout, points: &given.start }),
            velocity: velocity::Velocity,
            edge: edge::Edge { distances: std::mem::take(&mut given.distances), samples: given.samples },
            center: center::Center { centers: centers.collect() },
            variable,
            coordinate,
            residuals: 0,
            given,
        };
        let mut counter = Counter(0);
        energy.walk(&energy.given.start, &mut counter);
        energy.residuals = counter.0;
        energy
    }

    /// The free coordinates at the start, from which the solver begins.
    pub fn initial(&self) -> Vec<f64> {
        self.coordinate.iter().map(|&c| self.given.start[c / 2][c % 2]).collect()
    }

    /// All points, frame by frame, for the values `x` of the free coordinates.
    pub fn points(&self, x: &[f64]) -> Vec<Point> {
        let mut points = self.given.start.clone();
        for (&c, &value) in self.coordinate.iter().zip(x) {
            points[c / 2][c % 2] = value;
        }
        points
    }

    /// f_Segdist (7) of the segment `a`–`b` on a frame, in pixels. `None` where the frame has no distances.
    pub fn edge_distance(&self, frame: usize, a: Point, b: Point) -> Option<f64> {
        let field = self.edge.distances[frame].as_ref()?;
        Some(self.edge.segment(field, a, b).0)
    }

    fn walk(&self, points: &[Point], sink: &mut impl Sink) {
        let curves = Curves { layout: self.given.layout, points };
        let w = self.given.weights;
        weighted(&self.length, w.length, curves, sink);
        weighted(&self.curvature, w.curvature, curves, sink);
        weighted(&self.area, w.area, curves, sink);
        weighted(&self.velocity, w.velocity, curves, sink);
        weighted(&self.edge, w.edge, curves, sink);
        weighted(&self.center, w.center, curves, sink);
    }
}

impl Problem for Energy {
    fn variables(&self) -> usize {
        self.coordinate.len()
    }

    fn residuals(&self) -> usize {
        self.residuals
    }

    fn pattern(&self) -> Vec<(usize, usize)> {
        let mut sink = Pattern { energy: self, row: 0, entries: Vec::new() };
        self.walk(&self.given.start, &mut sink);
        sink.entries
    }

    fn evaluate(&self, x: &[f64], residuals: &mut [f64]) {
        self.walk(&self.points(x), &mut Values { residuals, row: 0 });
    }

    fn linearise(&self, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let values = Values { residuals, row: 0 };
        self.walk(&self.points(x), &mut Linear { energy: self, values, jacobian, entry: 0 });
    }

    fn constraints(&self) -> Vec<Vec<(usize, f64)>> {
        let layout = self.given.layout;
        let mut rows = Vec::new();
        for frame in (0..layout.frames).filter(|&frame| self.given.corrected[frame]) {
            for axis in 0..2 {
                let coordinates = (0..layout.points).map(|j| layout.coordinate(frame, j) + axis);
                let row: Vec<_> = coordinates
                    .map(|c| self.variable[c])
                    .filter(|&variable| variable != FIXED)
                    .map(|variable| (variable as usize, 1.0))
                    .collect();
                if !row.is_empty() {
                    rows.push(row);
                }
            }
        }
        rows
    }
}

/// Walks a term with residuals and derivatives scaled by the square root of its weight.
fn weighted(term: &impl Term, weight: f64, curves: Curves<'_>, sink: &mut impl Sink) {
    term.walk(curves, &mut Scaled { scale: weight.sqrt(), sink });
}

struct Scaled<'a, S> {
    scale: f64,
    sink: &'a mut S,
}

impl<S: Sink> Sink for Scaled<'_, S> {
    fn residual(&mut self, value: f64, derivatives: impl IntoIterator<Item = (usize, f64)>) {
        let scale = self.scale;
        self.sink.residual(scale * value, derivatives.into_iter().map(move |(c, d)| (c, scale * d)));
    }
}

struct Counter(usize);

impl Sink for Counter {
    fn residual(&mut self, _value: f64, _derivatives: impl IntoIterator<Item = (usize, f64)>) {
        self.0 += 1;
    }
}

struct Pattern<'a> {
    energy: &'a Energy,
    row: usize,
    entries: Vec<(usize, usize)>,
}

impl Sink for Pattern<'_> {
    fn residual(&mut self, _value: f64, derivatives: impl IntoIterator<Item = (usize, f64)>) {
        for (coordinate, _) in derivatives {
            let variable = self.energy.variable[coordinate];
            if variable != FIXED {
                self.entries.push((self.row, variable as usize));
            }
        }
        self.row += 1;
    }
}

struct Values<'a> {
    residuals: &'a mut [f64],
    row: usize,
}

impl Sink for Values<'_> {
    fn residual(&mut self, value: f64, _derivatives: impl IntoIterator<Item = (usize, f64)>) {
        self.residuals[self.row] = value;
        self.row += 1;
    }
}

struct Linear<'a> {
    energy: &'a Energy,
    values: Values<'a>,
    jacobian: &'a mut [f64],
    entry: usize,
}

impl Sink for Linear<'_> {
    fn residual(&mut self, value: f64, derivatives: impl IntoIterator<Item = (usize, f64)>) {
        for (coordinate, derivative) in derivatives {
            if self.energy.variable[coordinate] != FIXED {
                self.jacobian[self.entry] = derivative;
                self.entry += 1;
            }
        }
        self.values.residual(value, []);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use rototoon_base::numeric::gradient_check::{WorstEntry, worst_entry};

    /// Irregular curves without symmetry or coincident points: 4 frames of `points` points.
    pub(crate) fn wobbly(points: usize, closed: bool) -> (Layout, Vec<Point>) {
        let layout = Layout::new(4, points, closed);
        let all = (0..4 * points).map(|k| {
            let (frame, j) = (k / points, k % points);
            let angle = j as f64 * std::f64::consts::TAU / points as f64;
            let radius = 9.0 + (1.7 * k as f64).sin() * 2.0;
            Point::from_angle(angle + 0.1 * frame as f64) * radius + Point::new(20.3 + frame as f64, 18.4)
        });
        (layout, all.collect())
    }

    /// An energy with the weights given. Point 1 of frame 1 is pinned, and the first and last frame are keys.
    pub(crate) fn only(weights: Weights, points: usize, closed: bool) -> Energy {
        let (layout, start) = wobbly(points, closed);
        let fixed = (0..start.len()).map(|k| k < points || k >= 3 * points || k == points + 1).collect();
        // A field without creases within a step of the difference quotient: a tilted plane is bilinear everywhere.
        let plane = |slope: usize| DistanceField::from_fn((0, 0), 48, 48, move |x, y| (2 * x + slope * y) as u16);
        Energy::new(Given {
            layout,
            start,
            fixed,
            distances: vec![None, Some(plane(1)), Some(plane(3)), None],
            centers: vec![None, Some(Point::new(20.0, 17.0)), Some(Point::new(24.0, 19.0)), None],
            corrected: vec![false; 4],
            samples: 5,
            weights,
        })
    }

    /// All weights zero.
    pub(crate) const NONE: Weights =
        Weights { length: 0.0, curvature: 0.0, area: 0.0, velocity: 0.0, edge: 0.0, center: 0.0 };

    /// The entry of the Jacobian that differs most from the difference quotient, over closed and open curves of several
    /// sizes.
    pub(crate) fn worst(weights: Weights) -> WorstEntry {
        [(7, true), (6, false), (3, true), (2, true)]
            .into_iter()
            .filter_map(|(points, closed)| {
                let energy = only(weights, points, closed);
                worst_entry(&energy, &energy.initial(), 1e-5)
            })
            .max_by(|a, b| a.error.total_cmp(&b.error))
            .unwrap()
    }

    #[test]
    fn the_joined_energy_has_the_right_jacobian() {
        let worst = worst(Weights::default());
        assert!(worst.error < 1e-6, "{worst:?}");
    }

    #[test]
    fn still_curves_on_their_edges_cost_nothing() {
        let (layout, mut start) = wobbly(5, true);
        for k in 5..start.len() {
            start[k] = start[k - 5];
        }
        let center = rototoon_base::geometry::polygon::center(&start[..5]);
        let energy = Energy::new(Given {
            layout,
            fixed: vec![false; start.len()],
            start,
            distances: vec![Some(DistanceField::from_fn((0, 0), 40, 40, |_, _| 0)); 4],
            centers: vec![Some(center); 4],
            corrected: vec![false; 4],
            samples: 3,
            weights: Weights::default(),
        });
        let mut residuals = vec![1.0; energy.residuals()];
        energy.evaluate(&energy.initial(), &mut residuals);
        assert!(residuals.iter().all(|r| r.abs() < 1e-12));
    }

    #[test]
    fn fewer_than_three_points_are_never_closed() {
        assert_eq!(Layout::new(2, 2, true).segments().collect::<Vec<_>>(), [(0, 1)]);
        assert_eq!(Layout::new(2, 1, true).segment_count(), 0);
        assert_eq!(Layout::new(2, 1, true).neighbours().count(), 0);
        assert_eq!(Layout::new(2, 0, true).neighbours().count(), 0);
        assert_eq!(Layout::new(2, 3, false).neighbours().collect::<Vec<_>>(), [(0, 1, 2)]);
        assert_eq!(Layout::new(2, 3, true).neighbours().next(), Some((2, 0, 1)));
    }
}
