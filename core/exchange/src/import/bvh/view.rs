//! Projection from space to the picture: the vertical axis, the facing of the character, and the direction of the view.
//!
//! The projection is orthographic along a horizontal direction. Let u point up, f be the facing of the character and l =
//! u × f its left. A view of yaw θ about the vertical shows cos θ l + sin θ f to the right. At 0 the character faces
//! the viewer (its left is at the right of the picture); at 90° it faces right.
//!
//! **Facing** is the horizontal normal to the lines from the right to the left hip and shoulder, summed over all
//! frames, so the twist of a step cancels out. If a character turns around completely, or its sides coincide, the first
//! frame with a clear facing counts.
//!
//! **Up** is the axis, y or z, along which neck and ankles are farther apart in the median frame. Some programs write
//! z.
//!
//! **The automatic view** shows as much of the motion as a picture can. It contains the horizontal direction in which
//! the key points move most about their own means, relative to the pelvis (the larger eigenvector of their covariance).
//! A walk is seen from the side, a jumping jack from the front. Two opposite views show the same motion; the chosen one
//! shows the character from the front or, nearer to profile, facing right.

use glam::DVec3;
use rototoon_base::geometry::Point;
use rototoon_base::scene::skeleton::COUNT;

/// A posture in space: a position for each key point.
type InSpace = [DVec3; COUNT];

/// Yaw of the view between front and side, in degrees.
const THREE_QUARTER: f64 = 45.0;

/// The direction of the view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum View {
    /// The direction from which most of the motion is visible.
    #[default]
    Auto,
    /// From the front.
    Front,
    /// From its right side; it faces right.
    Side,
    /// Between front and side.
    ThreeQuarter,
    /// From an angle about the vertical in degrees: 0 front, 90 side.
    Yaw(f64),
}

/// The vertical axis of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// The axis along which the character is tallest.
    #[default]
    Auto,
    /// y.
    Y,
    /// z.
    Z,
}

/// An orthographic camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    up: DVec3,
    right: DVec3,
    /// Yaw in degrees, −180 to 180.
    pub yaw: f64,
}

impl Camera {
    /// The projection of a position, in the unit of space, x right and y down.
    pub fn picture(&self, place: DVec3) -> Point {
        Point::new(self.right.dot(place), -self.up.dot(place))
    }
}

/// The camera for a motion of at least one frame.
pub fn camera(postures: &[InSpace], up: Up, view: View) -> Camera {
    let up = match up {
        Up::Y => DVec3::Y,
        Up::Z => DVec3::Z,
        Up::Auto => tall(postures),
    };
    let front = facing(postures, up);
    let left = up.cross(front);
    let degrees = match view {
        View::Front => 0.0,
        View::Side => 90.0,
        View::ThreeQuarter => THREE_QUARTER,
        View::Yaw(degrees) => degrees,
        View::Auto => busiest(postures, left, front).to_degrees(),
    };
    let (sine, cosine) = exact_sine_cosine(degrees);
    Camera { up, right: left * cosine + front * sine, yaw: 180.0 - (180.0 - degrees).rem_euclid(360.0) }
}

/// Sine and cosine that are exact at multiples of 90°.
fn exact_sine_cosine(degrees: f64) -> (f64, f64) {
    match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    }
}

fn tall(postures: &[InSpace]) -> DVec3 {
    let height = |axis: DVec3| {
        let mut all: Vec<f64> = postures.iter().map(|p| (p[2] - p[13].midpoint(p[16])).dot(axis).abs()).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    if height(DVec3::Z) > height(DVec3::Y) { DVec3::Z } else { DVec3::Y }
}

/// The facing of the character, a horizontal unit vector.
fn facing(postures: &[InSpace], up: DVec3) -> DVec3 {
    let of = |p: &InSpace| {
        let across = (p[11] - p[14]) + (p[5] - p[8]);
        (across - up * up.dot(across)).cross(up).normalize_or_zero()
    };
    let sum: DVec3 = postures.iter().map(of).sum();
    let clear = sum.length() > 0.1 * postures.len() as f64;
    let first = || postures.iter().map(of).find(|f| *f != DVec3::ZERO);
    // The usual facing in files: towards z, or towards −y if z points up.
    let usual = if up == DVec3::Z { DVec3::NEG_Y } else { DVec3::Z };
    if clear { sum.normalize() } else { first().unwrap_or(usual) }
}

/// The yaw that shows most of the motion, in radians.
fn busiest(postures: &[InSpace], left: DVec3, front: DVec3) -> f64 {
    let level = |p: &InSpace, k: usize| Point::new(left.dot(p[k] - p[0]), front.dot(p[k] - p[0]));
    let (mut ll, mut lf, mut ff) = (0.0, 0.0, 0.0);
    for k in 1..COUNT {
        let mean = postures.iter().map(|p| level(p, k)).sum::<Point>() / postures.len() as f64;
        for posture in postures {
            let d = level(posture, k) - mean;
            ll += d.x * d.x;
            lf += d.x * d.y;
            ff += d.y * d.y;
        }
    }
    if ll + ff <= 0.0 {
        return std::f64::consts::FRAC_PI_2; // no motion: profile
    }
    let angle = 0.5 * (2.0 * lf).atan2(ll - ff); // of the larger eigenvector, from left towards front
    if angle < -std::f64::consts::FRAC_PI_4 { angle + std::f64::consts::PI } else { angle }
}
