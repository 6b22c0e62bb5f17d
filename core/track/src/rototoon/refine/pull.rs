//! The pull of a map of costs on its sample: a target and a weight along two axes, by a step of regularised mean shift.
//!
//! The probability of a displacement d in the window is p(d) ∝ exp(−C(d)/τ − |d − u|²/2ρ²), where u is the present
//! displacement, C the cost and ρ the reach. Its mean is μ and its covariance Σ. The Gaussian around u is a part of
//! this probability and is removed again: P = (Σ + s² I)⁻¹, π = 1/(ρ² + s²), Λ = P − π I, target = Λ⁻¹ (P μ − π u).
//! This is done on the eigenvector axes of Λ, and the target is at most 2ρ from u. Along an edge Λ is zero, so there is
//! no pull. The weight is 1 / (1/Λ + σ²), where σ² is the noise of the sample's pulls ([`super::noise`]).
//!
//! Source: regularised mean shift, Saragih, Lucey & Cohn 2011.

use super::noise::Variance;
use super::response::Map;
use nalgebra::{Matrix2, Vector2};
use rototoon_base::geometry::Point;

/// τ: temperature of the costs.
const TAU: f64 = 0.007;
/// s: least spread of a place, in working pixels.
const SPREAD: f64 = 0.7;
/// A place is skipped if its probability is smaller than the largest one by more than a factor exp of this.
const NEGLIGIBLE: f64 = 25.0;
/// Least cost of a map up to which a sample has its full weight, and from which on it has none.
const GOOD: f64 = 0.15;
const BAD: f64 = 0.55;

/// A pull along two perpendicular axes.
pub struct Pull {
    /// Unit axes in the picture.
    pub axes: [Point; 2],
    /// Weight along each axis.
    pub weights: [f64; 2],
    /// Target along each axis: the scalar product of the axis with the target place, in working pixels.
    pub targets: [f64; 2],
}

/// The pull on a sample that is now at `now`. The map is around `place`, with the unit vector `tangent` as its first
/// axis. `reach` is ρ in working pixels, `trust` scales the weights, and `noise` is the variance along both axes of the map.
pub fn pull(
    map: &Map,
    (place, tangent): (Point, Point),
    now: Point,
    (reach, trust): (f64, f64),
    noise: Variance,
) -> Pull {
    let back = Point::new(tangent.x, -tangent.y);
    let (step, reach) = (map.step, reach / map.step);
    let u = back.rotate(now - place) / step;
    let (mean, [xx, xy, yy], least) = moments(map, u, reach);
    let s = SPREAD * SPREAD;
    let spread = Matrix2::new(xx + s, xy, xy, yy + s);
    let precision = spread.try_inverse().unwrap_or_else(Matrix2::zeros);
    let prior = 1.0 / (reach * reach + s);
    let (values, axes) = eigen(precision - Matrix2::from_diagonal_element(prior));
    let pulled = precision * Vector2::new(mean.x, mean.y);
    let eta = Point::new(pulled.x, pulled.y) - u * prior;
    let sure = ((BAD - least) / (BAD - GOOD)).clamp(0.0, 1.0) * map.shown * trust;
    let along = |k: usize| {
        let value = values[k].max(1e-9);
        let from = axes[k].dot(u);
        let to = from + (axes[k].dot(eta) / value - from).clamp(-2.0 * reach, 2.0 * reach);
        let axis = tangent.rotate(axes[k]);
        let noise = noise[0] * axes[k].x * axes[k].x + noise[1] * axes[k].y * axes[k].y;
        (axis, sure / (step * step / value + noise), to * step + axis.dot(place))
    };
    let (a, b) = (along(0), along(1));
    Pull { axes: [a.0, b.0], weights: [a.1, b.1], targets: [a.2, b.2] }
}

/// Mean and covariance (xx, xy, yy) of the displacement, and the least cost within twice the reach of `u`.
fn moments(map: &Map, u: Point, reach: f64) -> (Point, [f64; 3], f64) {
    let inverse = 0.5 / (reach * reach);
    let columns = 2 * map.reach[1] as usize + 1;
    let mut exponents = Vec::with_capacity(map.costs.len());
    let (mut lowest, mut least) = (f64::INFINITY, 1.0f64);
    for (row, costs) in map.costs.chunks_exact(columns).enumerate() {
        let x = f64::from(row as i32 - map.reach[0]) - u.x;
        for (column, &cost) in costs.iter().enumerate() {
            let y = f64::from(column as i32 - map.reach[1]) - u.y;
            let (cost, far) = (f64::from(cost), x * x + y * y);
            let exponent = cost / TAU + far * inverse;
            lowest = lowest.min(exponent);
            if far < 4.0 * reach * reach {
                least = least.min(cost);
            }
            exponents.push(exponent);
        }
    }
    let (mut sum, mut first, mut second) = (0.0, Point::ZERO, [0.0; 3]);
    for (row, exponents) in exponents.chunks_exact(columns).enumerate() {
        let x = f64::from(row as i32 - map.reach[0]);
        for (column, exponent) in exponents.iter().enumerate() {
            if exponent - lowest > NEGLIGIBLE {
                continue;
            }
            let d = Point::new(x, f64::from(column as i32 - map.reach[1]));
            let w = (lowest - exponent).exp();
            sum += w;
            first += d * w;
            second = [second[0] + w * d.x * d.x, second[1] + w * d.x * d.y, second[2] + w * d.y * d.y];
        }
    }
    let mean = first / sum;
    let covariance =
        [second[0] / sum - mean.x * mean.x, second[1] / sum - mean.x * mean.y, second[2] / sum - mean.y * mean.y];
    (mean, covariance, least)
}

/// Eigenvalues and unit eigenvectors of a symmetric matrix.
fn eigen(matrix: Matrix2<f64>) -> ([f64; 2], [Point; 2]) {
    let found = matrix.symmetric_eigen();
    let axis = |k: usize| Point::new(found.eigenvectors[(0, k)], found.eigenvectors[(1, k)]);
    ([found.eigenvalues[0], found.eigenvalues[1]], [axis(0), axis(1)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(cost: impl Fn(f64, f64) -> f64) -> Map {
        let costs = (-5..=5)
            .flat_map(|u| (-6..=6).map(move |v| (f64::from(u), f64::from(v))))
            .map(|(u, v)| cost(u, v) as f32)
            .collect();
        Map { reach: [5, 6], step: 1.0, costs, shown: 1.0 }
    }

    #[test]
    fn an_edge_pulls_along_its_normal_only() {
        let edge = map(|_, v| 0.004 * (v - 2.0) * (v - 2.0));
        let found = pull(&edge, (Point::new(50.0, 60.0), Point::X), Point::new(50.0, 60.0), (4.0, 1.0), [0.0; 2]);
        let (strong, weak) = if found.weights[0] > found.weights[1] { (0, 1) } else { (1, 0) };
        assert!(found.axes[strong].y.abs() > 0.999);
        assert!((found.targets[strong] * found.axes[strong].y - 62.0).abs() < 0.2, "{}", found.targets[strong]);
        assert!(found.weights[weak] < 0.1 * found.weights[strong], "{:?}", found.weights);
    }

    #[test]
    fn a_corner_pulls_both_ways_and_a_flat_area_not_at_all() {
        let corner = map(|u, v| 0.004 * ((u - 1.0).powi(2) + (v + 2.0).powi(2)));
        let tangent = Point::from_angle(0.7);
        let place = Point::new(20.0, 30.0);
        let found = pull(&corner, (place, tangent), place, (4.0, 1.0), [0.0; 2]);
        let want = place + tangent.rotate(Point::new(1.0, -2.0));
        for k in 0..2 {
            assert!((found.targets[k] - found.axes[k].dot(want)).abs() < 0.2);
            assert!(found.weights[k] > 0.1, "{:?}", found.weights);
        }
        let flat = pull(&map(|_, _| 0.05), (place, tangent), place, (4.0, 1.0), [0.0; 2]);
        assert!((0..2).all(|k| flat.weights[k] < 0.5 * found.weights[k]), "{:?}", flat.weights);
    }
}
