//! The two-sided ribbon of Liang et al. (2012), which replaces the window of the image term:
//!
//! ```text
//! E_I = Σ_{t,i,j,α} ‖ I_t(c_t(s_i) + α n_t(s_ij)) − I_{t+1}(c_{t+1}(s_i) + α n_{t+1}(s_ij)) ‖²                    (1)
//! ```
//!
//! D. Liang et al.: "Style factorization and character reshaping for 2D cartoons", Journal of Zhejiang University –
//! Science C 13 (3), 2012, section 3. n(s_ij), j = 1, 2, are the unit normals on both sides of the curve. α runs over a
//! window that the user chooses ("extends the searching range to the whole ribbon, for full scale sampling"). The paper
//! calls this bidirectional sampling.
//!
//! With n(s_i1) = −n(s_i2) the sum over the sides is a sum over offsets of either sign. So the term is
//! [`Appearance`](super::appearance::Appearance) with the offsets of [`offsets`]. It differs from the window of
//! Agarwala et al. in its width. The paper does not give the width; [`WIDTH`] is twice that of Agarwala et al.

/// Width of one side, in pixels of the level.
pub const WIDTH: usize = 8;

/// All offsets: α from 1 to `width`, first on the negative side, then on the positive side.
pub fn offsets(width: usize) -> Vec<f64> {
    [-1.0, 1.0].into_iter().flat_map(|side| (1..=width).map(move |alpha| side * alpha as f64)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::appearance::Appearance;
    use super::super::tests::{curve_case, residuals, scenery, worst_of_pictures};
    use super::*;

    #[test]
    fn both_sides_are_sampled_alike() {
        assert_eq!(offsets(3), [-1.0, -2.0, -3.0, 1.0, 2.0, 3.0]);
    }

    #[test]
    fn the_jacobian_is_right() {
        let (scenery, offsets) = (scenery(), offsets(WIDTH));
        for (points, closed, level) in [(8, true, 0), (6, false, 1)] {
            let (curve, x) = curve_case(points, closed);
            let term = Appearance { curve: &curve, scenery: &scenery, level, offsets: &offsets };
            let worst = worst_of_pictures(&term, &curve, &x).unwrap();
            assert!(worst.error < 1e-2, "{worst:?}");
            assert_eq!(residuals(&term, &curve, &x).0, 3 * 3 * term.count());
        }
    }
}
