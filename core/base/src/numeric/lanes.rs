//! Arithmetic on eight values at once, written as if they were one value.
//!
//! Within [`super::vector::vectorised`] the compiler turns each operation into vector instructions. It often fails to do so
//! for loops over arrays in closures, or adds shuffles. Hot code therefore uses this type.

use glam::Vec4;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// [`Lanes`] from an expression of the index. The loop is plain: with little optimisation, as in tests, each step of a range
/// is a function call.
macro_rules! each {
    ($v:ident => $value:expr) => {{
        let mut all = [0.0; LANES];
        let mut $v = 0;
        while $v < LANES {
            all[$v] = $value;
            $v += 1;
        }
        Lanes(all)
    }};
}

/// Number of values in [`Lanes`].
pub const LANES: usize = 8;

/// [`LANES`] values.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct Lanes([f32; LANES]);

impl Lanes {
    /// The first [`LANES`] values of a slice.
    #[inline(always)]
    pub fn read(values: &[f32]) -> Self {
        Self(*values.first_chunk().expect("rows are padded to whole lanes"))
    }

    /// The same value in every lane.
    #[inline(always)]
    pub fn splat(value: f32) -> Self {
        Self([value; LANES])
    }

    /// One value for the first four and one for the others.
    #[inline(always)]
    pub fn of_fours(first: f32, second: f32) -> Self {
        Self([first, first, first, first, second, second, second, second])
    }

    /// Whole numbers as floating-point values.
    #[inline(always)]
    pub fn of_integers(values: &[i16; LANES]) -> Self {
        each!(v => f32::from(values[v]))
    }

    /// The first four and the last four values.
    #[inline(always)]
    pub fn fours(self) -> [Vec4; 2] {
        let [a, b, c, d, e, f, g, h] = self.0;
        [Vec4::new(a, b, c, d), Vec4::new(e, f, g, h)]
    }

    /// `self * factor + add`, rounded once. Fast only within [`super::vector::vectorised`].
    #[inline(always)]
    pub fn mul_add(self, factor: Self, add: Self) -> Self {
        each!(v => self.0[v].mul_add(factor.0[v], add.0[v]))
    }

    /// The lesser value in each lane.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        each!(v => if self.0[v] < other.0[v] { self.0[v] } else { other.0[v] })
    }

    /// The greater value in each lane.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        each!(v => if self.0[v] > other.0[v] { self.0[v] } else { other.0[v] })
    }

    /// 0, 1, 2 and so on.
    #[inline(always)]
    pub fn count() -> Self {
        Self([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0])
    }

    /// The values.
    #[inline(always)]
    pub fn to_array(self) -> [f32; LANES] {
        self.0
    }

    /// `value(v)` for each lane.
    pub fn from_fn(value: impl FnMut(usize) -> f32) -> Self {
        Self(std::array::from_fn(value))
    }

    /// The value of index `v`.
    #[inline(always)]
    pub fn get(&self, v: usize) -> f32 {
        self.0[v]
    }

    /// Sum in the order of the values.
    #[inline(always)]
    pub fn sum(&self) -> f32 {
        self.0.iter().sum()
    }

    /// Writes the values to the start of a slice.
    #[inline(always)]
    pub fn write(self, values: &mut [f32]) {
        *values.first_chunk_mut().expect("rows are padded to whole lanes") = self.0;
    }

    /// The square root of each value.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        each!(v => self.0[v].sqrt())
    }

    /// The first `count` values, and zero in the other lanes.
    #[inline(always)]
    pub fn first(self, count: usize) -> Self {
        each!(v => if v < count { self.0[v] } else { 0.0 })
    }

    /// The values of even and of odd index.
    #[inline(always)]
    pub fn halves(self) -> ([f32; LANES / 2], [f32; LANES / 2]) {
        let all = self.0;
        ([all[0], all[2], all[4], all[6]], [all[1], all[3], all[5], all[7]])
    }

    /// The value in each lane whose `mask` is not zero, and zero in the other lanes.
    #[inline(always)]
    pub fn kept(self, mask: Self) -> Self {
        each!(v => if mask.0[v] != 0.0 { self.0[v] } else { 0.0 })
    }
}

impl Add for Lanes {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        each!(v => self.0[v] + other.0[v])
    }
}

impl Sub for Lanes {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        each!(v => self.0[v] - other.0[v])
    }
}

impl Mul for Lanes {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        each!(v => self.0[v] * other.0[v])
    }
}

impl Mul<Lanes> for f32 {
    type Output = Lanes;

    #[inline(always)]
    fn mul(self, other: Lanes) -> Lanes {
        Lanes::splat(self) * other
    }
}

impl Div for Lanes {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        each!(v => self.0[v] / other.0[v])
    }
}

impl Neg for Lanes {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        each!(v => -self.0[v])
    }
}
