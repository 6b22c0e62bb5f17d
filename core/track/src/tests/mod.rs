//! The tracker as a whole: order and memory of jobs with a solver that only records, and the default solver on a small
//! drawn scene of known motion.

mod borders;
mod memory;
mod outward;
mod rotoscope;
mod scene;
