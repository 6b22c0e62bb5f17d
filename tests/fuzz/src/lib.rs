//! Fuzz targets: functions that take any bytes, and must neither panic nor take long.
//!
//! - [`targets`]: one file a target, and the list of all
//! - [`given`]: documents, clips and numbers that are decoded from bytes
//! - [`pictures`]: tiny pictures of every format
//! - [`seeds`](mod@seeds): the inputs that a run starts with
//! - [`mutate`]: changes of inputs, and the loop that needs no nightly compiler
//! - [`abi`]: the C ABI as safe functions
//!
//! `cargo xtask fuzz` runs them. The page `docs/src/contributing/fuzzing.md` says how a finding becomes a seed.

pub mod abi;
pub mod given;
pub mod mutate;
pub mod pictures;
pub mod seeds;
pub mod targets;

pub use targets::{ALL, Target};

/// Lets panics that the product catches pass.
///
/// libFuzzer's own hook ends the process at every panic. But the product catches panics of picture decoders and at its C
/// ABI on purpose. A panic that nobody catches still ends the process.
pub fn start() {
    std::panic::set_hook(Box::new(|panic| eprintln!("{panic}")));
}
