//! Tests of the complete tracker: order and memory of jobs with a solver that only records, and the default solver on
//! small drawn scenes of known motion.

mod absence;
mod borders;
mod branches;
mod cached;
mod depths;
mod holds;
mod limbs;
mod memory;
mod order;
mod outward;
mod progress;
mod remembered;
mod rotoscope;
mod round;
mod scene;
mod slivers;
mod spinning;
mod wobble;
