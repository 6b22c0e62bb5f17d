//! stub
use super::whole::Whole;
use crate::geometry::Point;
pub(super) fn fit(_points: &[Point], _closed: bool, _tolerance: f64) -> Whole { todo!() }
