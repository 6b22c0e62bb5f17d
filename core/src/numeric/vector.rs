//! Lets a hot loop use the vector instructions of the machine it runs on.
//!
//! The program is compiled for every machine of its kind, so a loop is vectorised with the few instructions that all of
//! them have. Here it is compiled once more for those that have more (AVX2), and the right one is chosen when it
//! runs. Results do not change: no instruction rounds otherwise, and no sum is reordered.

/// Runs `work`, compiled for this machine. It gains only if `work` and what it calls are marked `#[inline(always)]`.
#[inline(always)]
pub(crate) fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}
