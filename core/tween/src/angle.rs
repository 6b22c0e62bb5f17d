//! Angles in radians.

/// The equivalent angle from −π to π.
pub(crate) fn wrap(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}
