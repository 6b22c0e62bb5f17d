//! Several masks as one: each is added to, subtracted from, or intersected with those below it.
//!
//! The value of a layer is the coverage of its mask, or 1 minus it, times its opacity. Layers are applied from the first to
//! the last. With `m` the value so far and `c` that of the layer, the result is
//!
//! - add: `m + c − m c`, as for two independent coverages
//! - subtract: `m (1 − c)`
//! - intersect: `m c`
//!
//! Parts that are only added, with full opacity and equal borders, belong in one mask. Their union is exact, and parts that
//! touch have no seam.

use super::coverage::Window;
use super::mask::{Bounds, Mask};
use rototoon_base::scene::Raster;

/// How a layer changes the layers below it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Blend {
    /// The layer's area joins the others.
    #[default]
    Add,
    /// The layer's area is taken away.
    Subtract,
    /// Only what is in the layer too stays.
    Intersect,
}

impl Blend {
    /// All modes with their labels.
    pub const ALL: [(Self, &str); 3] =
        [(Self::Add, "Add"), (Self::Subtract, "Subtract"), (Self::Intersect, "Intersect")];
}

/// A mask with its way of being applied.
#[derive(Clone, Debug)]
pub struct Layer {
    /// The mask.
    pub mask: Mask,
    /// Opacity, 0 to 1.
    pub opacity: f32,
    /// Whether the layer is what lies outside of the mask.
    pub invert: bool,
    /// How the layer changes those below it.
    pub blend: Blend,
}

impl Layer {
    /// A mask that is added with full opacity.
    pub fn new(mask: Mask) -> Self {
        Self { mask, opacity: 1.0, invert: false, blend: Blend::Add }
    }

    fn value(&self, coverage: f32) -> f32 {
        self.opacity * if self.invert { 1.0 - coverage } else { coverage }
    }

    fn applied(&self, below: f32, coverage: f32) -> f32 {
        let own = self.value(coverage);
        match self.blend {
            Blend::Add => below + own - below * own,
            Blend::Subtract => below * (1.0 - own),
            Blend::Intersect => below * own,
        }
    }
}

/// Layers, the first at the bottom.
#[derive(Clone, Debug, Default)]
pub struct Layers(pub Vec<Layer>);

impl Layers {
    /// A rectangle that contains all values above 0, and whether there are values above 0 beyond any rectangle.
    pub fn bounds(&self) -> (Option<Bounds>, bool) {
        let (mut bounds, mut everywhere) = (None, false);
        for layer in &self.0 {
            match (layer.blend, layer.invert) {
                (Blend::Add, false) => {
                    bounds = [bounds, layer.mask.bounds()].into_iter().flatten().reduce(Bounds::united)
                }
                (Blend::Add, true) => everywhere |= layer.opacity > 0.0,
                (Blend::Intersect, false) => {
                    let own = layer.mask.bounds();
                    bounds = if everywhere { own } else { bounds.zip(own).and_then(|(a, b)| a.shared(b)) };
                    everywhere = false;
                }
                _ => {}
            }
        }
        (bounds, everywhere)
    }

    /// Whether all values in a window are 0.
    pub fn misses(&self, window: Window) -> bool {
        let (bounds, everywhere) = self.bounds();
        !everywhere && bounds.is_none_or(|bounds| bounds.misses(window))
    }

    /// The values, 0 to 1, of the pixels of a window. `None` if `go_on`, called for each row, returns false.
    pub fn draw(&self, window: Window, go_on: &mut dyn FnMut() -> bool) -> Option<Raster<f32>> {
        if let [Layer { mask, opacity: 1.0, invert: false, blend: Blend::Add }] = &self.0[..] {
            return mask.draw(window, go_on);
        }
        let mut result = Raster::new(window.width(), window.height(), 0.0f32);
        for layer in &self.0 {
            let own = if layer.invert || layer.blend == Blend::Intersect {
                Some(window)
            } else {
                // Where the coverage is 0, the layer changes nothing.
                layer.mask.bounds().and_then(|bounds| bounds.pixels(window))
            };
            let Some(own) = own else { continue };
            let coverage = layer.mask.draw(own, go_on)?;
            let (left, top) = ((own.left - window.left) as usize, (own.top - window.top) as usize);
            for y in 0..own.height() {
                let below = &mut result.row_mut(top + y)[left..left + own.width()];
                for (below, coverage) in below.iter_mut().zip(coverage.row(y)) {
                    *below = layer.applied(*below, *coverage);
                }
            }
        }
        Some(result)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::Point;

    const WINDOW: Window = Window { left: 0, top: 0, right: 12, bottom: 4 };

    fn strip(from: f64, to: f64) -> Layer {
        let corners = [(from, 0.0), (to, 0.0), (to, 4.0), (from, 4.0)].map(|(x, y)| Point::new(x, y));
        Layer::new(Mask::new(vec![vec![corners.into()]], 0.0, 0.0))
    }

    fn row(layers: Vec<Layer>) -> Vec<f32> {
        Layers(layers).draw(WINDOW, &mut || true).unwrap().row(1).to_vec()
    }

    #[test]
    fn layers_add_subtract_and_intersect() {
        let blend = |layer: Layer, blend: Blend| Layer { blend, ..layer };
        let both = row(vec![strip(0.0, 4.5), strip(4.0, 8.0)]);
        assert_eq!(both[3..9], [1.0, 1.0, 1.0, 1.0, 1.0, 0.0]);
        let less = row(vec![strip(0.0, 8.0), blend(strip(2.5, 4.0), Blend::Subtract)]);
        assert_eq!(less[1..6], [1.0, 0.5, 0.0, 1.0, 1.0]);
        let common = row(vec![strip(0.0, 8.0), blend(strip(6.5, 12.0), Blend::Intersect)]);
        assert_eq!(common[5..10], [0.0, 0.5, 1.0, 0.0, 0.0]);
        let half = row(vec![Layer { opacity: 0.5, ..strip(0.0, 2.0) }, Layer { opacity: 0.5, ..strip(1.0, 3.0) }]);
        assert_eq!(half[..4], [0.5, 0.75, 0.5, 0.0]);
        let outside = row(vec![Layer { invert: true, opacity: 0.25, ..strip(2.0, 12.0) }]);
        assert_eq!(outside[..4], [0.25, 0.25, 0.0, 0.0]);
    }

    #[test]
    fn beyond_the_bounds_all_is_zero() {
        let inverted = |layer: Layer| Layer { invert: true, ..layer };
        let cut = |layer: Layer| Layer { blend: Blend::Intersect, ..layer };
        for layers in [
            vec![],
            vec![strip(2.0, 4.0), strip(6.0, 7.0)],
            vec![inverted(strip(2.0, 4.0)), cut(strip(3.0, 9.0))],
            vec![strip(2.0, 8.0), cut(strip(9.0, 10.0))],
            vec![strip(2.0, 8.0), cut(inverted(strip(5.0, 10.0))), strip(10.0, 11.0)],
        ] {
            let layers = Layers(layers);
            let (bounds, everywhere) = layers.bounds();
            assert!(!everywhere);
            let drawn = layers.draw(WINDOW, &mut || true).unwrap();
            for x in 0..12 {
                let pixel = Window { left: x, top: 1, right: x + 1, bottom: 2 };
                let out = bounds.is_none_or(|bounds| bounds.misses(pixel));
                assert!(!out || drawn.get(x as usize, 1) == 0.0, "{x}");
                assert_eq!(layers.misses(pixel), out);
            }
        }
        assert!(Layers(vec![inverted(strip(2.0, 4.0))]).bounds().1);
    }
}
