//! Measures how well as-rigid-as-possible manipulation keeps the width, the smoothness and the place of a limb, with and
//! without sub-key points.
//!
//! The limb is drawn straight: two bones of 50 px along x, 20 px wide. It has two kinds of poses. In the first one the bones
//! become curved: the control points of their splines move across, by half a bone's length at most. In the second one a
//! straight arm bends at the elbow. The true limb of a curved pose is the strip of 20 px around the splines. A bent elbow has
//! no true shape, so only the width is measured there.
//!
//! Sub-key points keep their place along the limb. For one number of sub-key points the rule printed in the paper is
//! measured too.
//!
//! - **width**: root mean square of the relative error of the distance between the two sides, at 41 places along the limb
//! - **roughness**: mean length of the second differences of both sides, divided by that of the true sides; 1 is as smooth
//!   as the truth
//! - **off**: mean distance of the sides from the true sides, in px

use anyhow::Result;
use rototoon::geometry::Point;
use rototoon::reshape::limb::Bend;
use rototoon::reshape::puppet::{Carrier, LimbPose, Options, Puppet};
use serde::Serialize;

/// Length of a bone, in px.
const BONE: f64 = 50.0;
/// Width of the limb, in px.
const WIDTH: f64 = 20.0;
/// Number of places along the limb.
const PLACES: usize = 41;
/// Numbers of sub-key points per bone.
const SUB_KEYS: [usize; 6] = [0, 1, 2, 3, 5, 8];
/// The number of sub-key points for which the printed rule is measured too.
const PRINTED: usize = 5;
/// Distances that control points move across, in bone lengths.
const ACROSS: [f64; 5] = [0.1, 0.2, 0.3, 0.4, 0.5];
/// Angles of the elbow, in degrees.
const ELBOWS: [f64; 4] = [30.0, 60.0, 90.0, 120.0];

/// The measurement of one pose with one number of sub-key points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bent {
    /// Number of sub-key points per bone.
    pub sub_keys: usize,
    /// Whether sub-key points move to the nearest point of their spline, as the paper prints it.
    pub printed: bool,
    /// "curve" or "elbow".
    pub pose: &'static str,
    /// Distance of the control point across in bone lengths, or angle of the elbow in degrees.
    pub amount: f64,
    /// Relative error of the width.
    pub width: f64,
    /// Roughness relative to the truth; `None` for elbows.
    pub roughness: Option<f64>,
    /// Distance from the true sides, in px; `None` for elbows.
    pub off: Option<f64>,
}

/// Measures all poses with all numbers of sub-key points.
pub fn measure() -> Result<Vec<Bent>> {
    let mut found = Vec::new();
    let ways = SUB_KEYS.map(|sub_keys| (sub_keys, false)).into_iter().chain([(PRINTED, true)]);
    for (sub_keys, printed) in ways {
        let options = Options { sub_keys, printed };
        for across in ACROSS {
            found.push(bent(options, "curve", across, &curved(across))?);
        }
        for degrees in ELBOWS {
            found.push(bent(options, "elbow", degrees, &folded(degrees))?);
        }
    }
    Ok(found)
}

fn straight() -> [LimbPose; 2] {
    let at = |x: f64| Point::new(x, 0.0);
    [0.0, BONE].map(|x| LimbPose { ends: (at(x), at(x + BONE)), bend: Bend::STRAIGHT })
}

fn curved(across: f64) -> [LimbPose; 2] {
    let [upper, fore] = straight();
    let bend = |across: f64| Bend { along: 0.5, across };
    [LimbPose { bend: bend(across), ..upper }, LimbPose { bend: bend(-across), ..fore }]
}

fn folded(degrees: f64) -> [LimbPose; 2] {
    let [upper, fore] = straight();
    let hand = fore.ends.0 + Point::from_angle(degrees.to_radians()) * BONE;
    [upper, LimbPose { ends: (fore.ends.0, hand), ..fore }]
}

/// The points of both sides of a limb, at its places.
fn sides(limbs: &[LimbPose; 2]) -> [Vec<Point>; 2] {
    let place = |k: usize, side: f64| {
        let along = 2.0 * k as f64 / (PLACES - 1) as f64;
        let (bone, u) = if along < 1.0 { (0, along) } else { (1, along - 1.0) };
        let spline = limbs[bone].spline();
        let tangent = (spline.p1 - spline.p0).lerp(spline.p2 - spline.p1, u).normalize();
        spline.point(u) + tangent.perp() * (side * 0.5 * WIDTH)
    };
    [1.0, -1.0].map(|side| (0..PLACES).map(|k| place(k, side)).collect())
}

fn bent(options: Options, pose: &'static str, amount: f64, limbs: &[LimbPose; 2]) -> Result<Bent> {
    let rest = straight();
    let [left, right] = sides(&rest);
    let outline: Vec<Point> = left.iter().copied().chain(right.iter().rev().copied()).collect();
    let carriers = [0, 1].map(|limb| Carrier { limb, turn: 1.0, rigidity: 1.0, whole: false });
    let points: Vec<Point> = left.iter().chain(&right).copied().collect();
    let mut puppet = Puppet::new(&outline, &points, &rest, &carriers, &options)?;
    let found = puppet.pose(limbs)?;
    let (a, b) = found.split_at(PLACES);
    let squares = a.iter().zip(b).map(|(a, b)| (a.distance(*b) / WIDTH - 1.0).powi(2)).sum::<f64>();
    let truth = sides(limbs);
    let rough = |side: &[Point]| side.windows(3).map(|w| (w[0] - w[1] * 2.0 + w[2]).length()).sum::<f64>();
    let curve = pose == "curve";
    let off = a.iter().zip(&truth[0]).chain(b.iter().zip(&truth[1])).map(|(a, b)| a.distance(*b)).sum::<f64>();
    Ok(Bent {
        sub_keys: options.sub_keys,
        printed: options.printed,
        pose,
        amount,
        width: (squares / PLACES as f64).sqrt(),
        roughness: curve.then(|| (rough(a) + rough(b)) / (rough(&truth[0]) + rough(&truth[1]))),
        off: curve.then_some(off / (2 * PLACES) as f64),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limb_at_rest_has_no_error() {
        let found = bent(Options::default(), "curve", 0.0, &straight()).unwrap();
        assert!(found.width < 1e-9 && found.off.unwrap() < 1e-8, "{found:?}");
    }

    #[test]
    fn sub_key_points_bring_a_curved_limb_nearer_to_the_truth() {
        let off = |options| bent(options, "curve", 0.5, &curved(0.5)).unwrap().off.unwrap();
        let own = off(Options::default());
        let none = off(Options { sub_keys: 0, ..Options::default() });
        assert!(own < 0.2 * none, "{own} {none}");
        let printed = off(Options { printed: true, ..Options::default() });
        assert!(own < 0.6 * printed, "the printed rule lets sub-key points slide together: {own} {printed}");
    }
}
