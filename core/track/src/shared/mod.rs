//! What belongs to no single preset.
//!
//! Computed from pictures:
//! - [`features`]: a pyramid of colours with their gradients
//! - [`look`]: what is compared, by the kind of drawing
//! - [`sought`]: a picture made ready to be searched
//! - [`store`]: features, flows and the like, kept for the next job
//! - [`budget`]: how many bytes of them
//! - [`drawings`]: frames that show one drawing are worked on once
//! - [`held`]: whether two pictures show the same drawing, or only noise tells them apart
//! - [`cuts`]: where the footage goes over to another shot
//! - [`edge_maps`]: edges of frames and distances to them, kept
//!
//! Before and after a preset's own work:
//! - [`part_by_part`]: order and memory of jobs that are solved one by one
//! - [`weakest`]: where the next key helps most

pub mod budget;
pub mod compared;
pub mod cuts;
pub mod drawings;
pub mod edge_maps;
pub mod features;
pub mod held;
pub mod hidden;
pub mod look;
pub mod part_by_part;
pub mod sought;
pub mod store;
pub mod twins;
pub mod weakest;
pub mod within;
