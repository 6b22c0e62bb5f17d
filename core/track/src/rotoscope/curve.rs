//! The contour as a Catmull–Rom curve, with all readings as linear functions of the control points.
//!
//! Between the control points P₁ and P₂ with neighbours P₀ and P₃ the curve is
//!
//! ```text
//! c(u) = ½ [(−u³ + 2u² − u) P₀ + (3u³ − 5u² + 2) P₁ + (−3u³ + 4u² + u) P₂ + (u³ − u²) P₃],   0 ≤ u < 1
//! ```
//!
//! It passes through the control points and has a continuous direction. Agarwala et al. use cubic Béziers that an
//! artist fits. Our contours are given as points on the contour, and this is the cubic that needs nothing else. Open
//! curves are continued by reflection, P₋₁ = 2 P₀ − P₁.
//!
//! Samples are about [`SPACING`] apart along the mean of both keys, with at least one in every segment. Their
//! parameters are the same on every frame, so sample i of one frame corresponds to sample i of another.
//!
//! Everything that the energy's shape terms read of a frame (places, tangents, chords, second differences) is linear in
//! its control points. A [`Functional`] is such a reading: up to six control points with weights.
//!
//! Limits: the parametrisation is uniform, so the curve bulges between segments of very different lengths. Corners of
//! the drawing are rounded within a segment.

use rototoon_base::geometry::Point;

/// Distance of neighbouring samples in working pixels, as in the authors' system.
pub const SPACING: f64 = 2.0;
/// Largest number of samples per segment, for keys far outside any picture.
const MOST_SAMPLES: f64 = 256.0;
/// Largest number of control points in a functional: three neighbouring samples are in at most three segments.
pub const WIDEST: usize = 6;

/// A linear function of a frame's control points, Σ wⱼ Pⱼ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Functional {
    points: [u32; WIDEST],
    weights: [f64; WIDEST],
    count: usize,
}

impl Functional {
    /// Index and weight of each control point.
    pub fn entries(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.points[..self.count].iter().zip(&self.weights).map(|(&point, &weight)| (point as usize, weight))
    }

    /// The value for the control points of a frame.
    pub fn read(&self, points: &[Point]) -> Point {
        self.entries().map(|(j, weight)| points[j] * weight).sum()
    }

    fn add(&mut self, point: usize, weight: f64) {
        match self.points[..self.count].iter().position(|&known| known as usize == point) {
            Some(known) => self.weights[known] += weight,
            None => {
                self.points[self.count] = point as u32;
                self.weights[self.count] = weight;
                self.count += 1;
            }
        }
    }

    fn plus(mut self, factor: f64, other: &Self) -> Self {
        other.entries().for_each(|(point, weight)| self.add(point, factor * weight));
        self
    }
}

/// A curve's samples and their functionals.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Number of control points.
    pub points: usize,
    /// c at each sample.
    pub places: Vec<Functional>,
    /// dc/du at each sample: a vector along the curve, of any length.
    pub tangents: Vec<Functional>,
    /// Vectors between neighbouring samples, scaled as if the samples were [`SPACING`] apart on the keys.
    pub chords: Vec<Functional>,
    /// Second differences of three neighbouring samples, scaled as if the samples were [`SPACING`] apart on the keys.
    pub seconds: Vec<Functional>,
    /// For each sample the nearer of the two control points of its segment.
    pub nearest: Vec<usize>,
}

impl Curve {
    /// The closed or open curve through as many points as the keys have. The keys are in working pixels and have the
    /// same number of points. A contour of fewer than three points is never closed.
    pub fn new(keys: [&[Point]; 2], closed: bool) -> Self {
        let points = keys[0].len();
        let closed = closed && points > 2;
        let mut curve = Self {
            points,
            places: Vec::new(),
            tangents: Vec::new(),
            chords: Vec::new(),
            seconds: Vec::new(),
            nearest: Vec::new(),
        };
        for (segment, count) in counts(keys, closed).into_iter().enumerate() {
            for k in 0..count {
                curve.sample(segment, k as f64 / count as f64, closed);
            }
        }
        if !closed {
            curve.last_sample();
        }
        curve.differences(keys, closed);
        curve
    }

    fn sample(&mut self, segment: usize, u: f64, closed: bool) {
        let (u2, u3) = (u * u, u * u * u);
        let place = [-u3 + 2.0 * u2 - u, 3.0 * u3 - 5.0 * u2 + 2.0, -3.0 * u3 + 4.0 * u2 + u, u3 - u2];
        let tangent = [-3.0 * u2 + 4.0 * u - 1.0, 9.0 * u2 - 10.0 * u, -9.0 * u2 + 8.0 * u + 1.0, 3.0 * u2 - 2.0 * u];
        self.places.push(self.joined(segment, place, closed));
        self.tangents.push(self.joined(segment, tangent, closed));
        self.nearest.push(if u < 0.5 { segment } else { (segment + 1) % self.points });
    }

    /// The end of an open curve.
    fn last_sample(&mut self) {
        match self.points {
            0 => {}
            1 => {
                let mut place = Functional::default();
                place.add(0, 1.0);
                self.places.push(place);
                self.tangents.push(Functional::default());
                self.nearest.push(0);
            }
            n => {
                self.sample(n - 2, 1.0, false);
            }
        }
    }

    /// A functional with half of the `weights` on the control points of a segment and its neighbours.
    fn joined(&self, segment: usize, weights: [f64; 4], closed: bool) -> Functional {
        let n = self.points;
        let mut functional = Functional::default();
        for (k, weight) in weights.into_iter().enumerate() {
            let weight = 0.5 * weight;
            // `segment + k` is the index of the point plus one, so it is never negative.
            match segment + k {
                0 if !closed => {
                    functional.add(0, 2.0 * weight);
                    functional.add(1, -weight);
                }
                j if !closed && j > n => {
                    functional.add(n - 1, 2.0 * weight);
                    functional.add(n - 2, -weight);
                }
                j => functional.add((j + n - 1) % n, weight),
            }
        }
        functional
    }

    fn differences(&mut self, keys: [&[Point]; 2], closed: bool) {
        let n = self.places.len();
        let chord = |i: usize| Functional::default().plus(1.0, &self.places[(i + 1) % n]).plus(-1.0, &self.places[i]);
        let chords: Vec<Functional> = (0..if closed { n } else { n.saturating_sub(1) }).map(chord).collect();
        // Samples that coincide on the keys do not define a distance, so the scale is limited.
        let length = |chord: &Functional| 0.5 * keys.map(|key| chord.read(key).length()).iter().sum::<f64>();
        let scales: Vec<f64> = chords.iter().map(|chord| SPACING / length(chord).max(0.1 * SPACING)).collect();
        let second = |i: usize| {
            let before = if i == 0 { n - 1 } else { i - 1 };
            // Divided difference on uneven spacing h₁, h₂: 2 (Δ₂/h₂ − Δ₁/h₁)/(h₁ + h₂), times SPACING².
            let mean = 2.0 / (1.0 / scales[before] + 1.0 / scales[i]);
            Functional::default().plus(mean * scales[i], &chords[i]).plus(-mean * scales[before], &chords[before])
        };
        self.seconds =
            if closed { (0..n).map(second).collect() } else { (1..chords.len().max(1)).map(second).collect() };
        self.chords =
            chords.iter().zip(&scales).map(|(chord, &scale)| Functional::default().plus(scale, chord)).collect();
    }
}

/// Number of samples per segment, from its mean length on the keys.
fn counts(keys: [&[Point]; 2], closed: bool) -> Vec<usize> {
    let n = keys[0].len();
    let segments = if closed { n } else { n.saturating_sub(1) };
    let length = |j: usize| 0.5 * keys.map(|key| key[j].distance(key[(j + 1) % n])).iter().sum::<f64>();
    (0..segments).map(|j| (length(j) / SPACING).round().clamp(1.0, MOST_SAMPLES) as usize).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(n: usize) -> Vec<Point> {
        let turn = std::f64::consts::TAU / n as f64;
        (0..n).map(|j| Point::from_angle(turn * j as f64) * 30.0 + Point::new(50.0, 40.0)).collect()
    }

    #[test]
    fn the_curve_passes_through_its_points() {
        for closed in [true, false] {
            let points = ring(9);
            let curve = Curve::new([&points, &points], closed);
            for p in &points {
                assert!(curve.places.iter().any(|place| place.read(&points).distance(*p) < 1e-12));
            }
        }
    }

    #[test]
    fn samples_are_about_their_spacing_apart_and_on_the_circle() {
        let points = ring(12);
        let curve = Curve::new([&points, &points], true);
        for (i, (place, tangent)) in curve.places.iter().zip(&curve.tangents).enumerate() {
            let (p, d) = (place.read(&points) - Point::new(50.0, 40.0), tangent.read(&points));
            assert!((p.length() - 30.0).abs() < 0.3 && p.normalize().dot(d.normalize()).abs() < 0.03);
            assert!((curve.chords[i].read(&points).length() - SPACING).abs() < 1e-9);
            // SPACING² times the curvature, towards the centre.
            let second = curve.seconds[i].read(&points);
            assert!((second.length() - SPACING * SPACING / 30.0).abs() < 0.1 && second.dot(p) < 0.0);
        }
    }

    #[test]
    fn tangents_are_derivatives() {
        let points: Vec<Point> = ring(7).iter().enumerate().map(|(j, p)| *p * (1.0 + 0.1 * j as f64)).collect();
        for (closed, segment) in [(true, 0), (true, 6), (false, 0), (false, 3), (false, 5)] {
            let mut curve = Curve::new([&points, &points], closed);
            let first = curve.places.len();
            let h = 1e-5;
            [0.4, 0.4 - h, 0.4 + h].into_iter().for_each(|u| curve.sample(segment, u, closed));
            let at = |k: usize| curve.places[first + k].read(&points);
            assert!((curve.tangents[first].read(&points) - (at(2) - at(1)) / (2.0 * h)).length() < 1e-6);
        }
    }

    #[test]
    fn shifts_change_places_alone() {
        let points = ring(5);
        let moved: Vec<Point> = points.iter().map(|p| *p + Point::new(7.0, -3.0)).collect();
        for closed in [true, false] {
            let curve = Curve::new([&points, &points], closed);
            let same = |f: &Functional| assert!(f.read(&points).distance(f.read(&moved)) < 1e-12);
            curve.tangents.iter().chain(&curve.chords).chain(&curve.seconds).for_each(same);
            assert!(
                curve.places[3].read(&moved).distance(curve.places[3].read(&points) + Point::new(7.0, -3.0)) < 1e-12
            );
        }
    }

    #[test]
    fn few_points_and_coincident_points_give_finite_values() {
        for closed in [true, false] {
            for n in 0..6 {
                for points in [ring(n.max(1))[..n].to_vec(), vec![Point::ONE; n]] {
                    let curve = Curve::new([&points, &points], closed);
                    assert_eq!(curve.places.is_empty(), n == 0);
                    let all = [&curve.places, &curve.tangents, &curve.chords, &curve.seconds];
                    assert!(all.into_iter().flatten().all(|f| f.read(&points).is_finite()));
                    assert_eq!((curve.nearest.len(), curve.tangents.len()), (curve.places.len(), curve.places.len()));
                }
            }
        }
    }
}
