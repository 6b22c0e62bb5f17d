//! Lets a hot loop use the vector instructions of the processor that runs it.
//!
//! The program is compiled for all processors of one kind. The compiler may then use only the instructions that all of
//! them have. [`vectorised`] compiles a loop a second time for processors with AVX2 and FMA, and chooses between the two
//! when the program runs. Both give the same result: every operation rounds in the same way, and no sum is reordered.
//!
//! Hot loops call `mul_add` for a product and a sum that are rounded once. With FMA this is one instruction. Without FMA it
//! is a slow function call with the same result. Use `mul_add` only within [`vectorised`].

/// Runs `work`, compiled for this processor. `work` and all functions that it calls must be `#[inline(always)]`; otherwise
/// they stay compiled for all processors.
#[inline(always)]
pub fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}

/// Inner product in four interleaved sums. The order is fixed, and the compiler can keep the sums in one register.
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
