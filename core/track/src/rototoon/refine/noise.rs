//! The noise of the pulls, measured between the keys.
//!
//! **Why.** A pull's weight says how sharply the template fits at its best place. It does not say whether that place is
//! the right one. A line that is drawn anew for every drawing wobbles, and its wobble fits sharply at places that mean
//! nothing: points slide to and fro along the line. Clean drawings do not do this, and their pulls are right.
//!
//! **How.** At the keys the right place is known. So each key's template is compared with the other key's picture around
//! its sample there, and the pull's distance from the sample is its error. Along the contour and across it, a part's noise
//! σ is 1.4826 times the median |error| of its samples. A sample has up to two errors of its own, one from each key. Its
//! variance is (2 σ² + Σ error²) / (2 + number of errors), so a corner that both keys show alike keeps its pull. The
//! variance is added to that of the pull ([`super::pull`]).
//!
//! **Limits.** A part whose look differs between the keys by more than its drawing, for example by shade, seems noisy.
//! Its contour then follows the lattice more than its own colours.

use super::pull::{Pull, pull};
use super::response::{Window, map};
use super::samples::Samples;
use super::template::Templates;
use super::view::{Frame, Key};
use nalgebra::{Matrix2, Vector2};
use rototoon_base::geometry::Point;
use std::collections::BTreeMap;

/// The displacements over which a sample is looked for, and the reach of its pull, in working pixels.
const WINDOW: Window = Window { reach: [5, 6] };
const REACH: f64 = 6.0;
/// Pulls with less weight along an axis than this (1/px²) say nothing there.
const LEAST: f64 = 0.03;
/// Number of a sample's own errors that the part's noise counts as.
const PRIOR: f64 = 2.0;
/// Added to the weights (1/px²), so that they can be inverted.
const TINY: f64 = 1e-6;
/// From a median of absolute values to a standard deviation.
const DEVIATION: f64 = 1.4826;

/// Variances of a sample's pull along the contour and across it, in square working pixels.
pub type Variance = [f64; 2];

/// The variances of all samples.
pub fn measured(keys: &[Key; 2], samples: &Samples, templates: &Templates) -> Vec<Variance> {
    let errors: Vec<[[Option<f64>; 2]; 2]> = {
        let of_key = [0, 1].map(|key: usize| errors(key, &keys[1 - key], samples, templates));
        (0..samples.count()).map(|s| [of_key[0][s], of_key[1][s]]).collect()
    };
    let part = [0, 1].map(|axis: usize| {
        let mut found: Vec<f64> = errors.iter().flatten().filter_map(|error| error[axis]).map(f64::abs).collect();
        found.sort_by(f64::total_cmp);
        found.get(found.len() / 2).map_or(0.0, |median| DEVIATION * median)
    });
    let of_sample = |own: &[[Option<f64>; 2]; 2]| {
        std::array::from_fn(|axis| {
            let own: Vec<f64> = own.iter().filter_map(|error| error[axis]).collect();
            let sum: f64 = own.iter().map(|error| error * error).sum();
            (PRIOR * part[axis] * part[axis] + sum) / (PRIOR + own.len() as f64)
        })
    };
    errors.iter().map(of_sample).collect()
}

/// For each sample how far from it its template of a key is pulled at the other key: along the contour and across it.
fn errors(key: usize, other: &Key, samples: &Samples, templates: &Templates) -> Vec<[Option<f64>; 2]> {
    let frame = Frame { picture: other.picture, cover: other.cover, share: 0.0, pins: BTreeMap::new() };
    let (places, tangents) = samples.frames(other.points);
    let of_sample = |s: usize| {
        let (place, tangent) = (places[s], tangents[s]);
        let own = templates.of(s)[key];
        let map = map(&frame, &WINDOW, (place, tangent), ([own, own], templates.grain));
        error(&pull(&map, (place, tangent), place, (REACH, 1.0), [0.0; 2]), (place, tangent))
    };
    (0..samples.count()).map(of_sample).collect()
}

/// How far a pull draws a sample from its place: along the unit tangent and across it. `None` on an axis without weight.
fn error(pull: &Pull, (place, tangent): (Point, Point)) -> [Option<f64>; 2] {
    let back = Point::new(tangent.x, -tangent.y);
    let (mut weights, mut drawn) = (Matrix2::identity() * TINY, Vector2::zeros());
    for k in 0..2 {
        let axis = back.rotate(pull.axes[k]);
        let axis = Vector2::new(axis.x, axis.y);
        weights += axis * axis.transpose() * pull.weights[k];
        drawn += axis * (pull.weights[k] * (pull.targets[k] - pull.axes[k].dot(place)));
    }
    let to = weights.try_inverse().map(|inverse| inverse * drawn);
    [0, 1].map(|axis: usize| to.filter(|_| weights[(axis, axis)] > LEAST).map(|to| to[axis]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_pull_is_its_distance_along_and_across() {
        let (place, tangent) = (Point::new(40.0, 30.0), Point::from_angle(0.6));
        let axes = [Point::from_angle(1.0), Point::from_angle(1.0).perp()];
        let to = place + tangent * 3.0 - tangent.perp();
        let pull = Pull { axes, weights: [0.7, 0.2], targets: axes.map(|axis| axis.dot(to)) };
        let [along, across] = error(&pull, (place, tangent)).map(Option::unwrap);
        assert!((along - 3.0).abs() < 1e-3 && (across + 1.0).abs() < 1e-3, "{along} {across}");
        // An edge says nothing along itself.
        let edge =
            Pull { axes: [tangent, tangent.perp()], weights: [0.0, 0.5], targets: [0.0, tangent.perp().dot(to)] };
        let [along, across] = error(&edge, (place, tangent));
        assert!(along.is_none() && (across.unwrap() + 1.0).abs() < 1e-3);
    }
}
