//! Lets a hot loop use the vector instructions of the machine it runs on.
//!
//! The program is compiled for every machine of its kind, so a loop is vectorised with the few instructions that all of
//! them have. Here it is compiled once more for those that have more (AVX2, FMA), and the right one is chosen when it
//! runs. Results do not change: no instruction rounds otherwise, and no sum is reordered. Hot loops say `mul_add` where one
//! rounding of a product and a sum is meant; it is one instruction here, and a call on machines without FMA, which makes the
//! same of it slowly. Outside of [`vectorised`] it should not be used.

/// Runs `work`, compiled for this machine. It gains only if `work` and what it calls are marked `#[inline(always)]`.
#[inline(always)]
pub fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}

/// Inner product in four interleaved sums: a fixed order, and the compiler can keep them in one register.
#[inline(always)]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a4.zip(b4) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}
