//! Pictures.
pub mod colour;
pub mod flow;
pub mod gaussian;
pub mod pixel;
pub mod resize;
pub mod sample;
