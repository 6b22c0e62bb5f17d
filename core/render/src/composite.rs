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
use super::rows::MaskRows;
use rototoon_base::scene::Raster;

/// Rows of more layers than one keep at most this many values of them. Layers that would keep more are drawn one by one.
const MOST_KEPT: usize = 1 << 24;

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

    /// Applies the latest row of the mask to the row below.
    fn apply(&self, rows: &MaskRows, below: &mut [f32]) {
        // Where the coverage is 0, other layers change nothing.
        let all = self.invert || self.blend == Blend::Intersect;
        let drawn = if all { 0..below.len() } else { rows.drawn() };
        for (below, coverage) in below[drawn.clone()].iter_mut().zip(&rows.latest()[drawn]) {
            *below = self.applied(*below, *coverage);
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
        let mut result = Raster::new(window.width(), window.height(), 0.0f32);
        let mut rows = self.rows(window, go_on)?;
        for y in 0..window.height() {
            result.row_mut(y).copy_from_slice(rows.next(go_on)?);
        }
        Some(result)
    }

    /// The rows of a window. Layers that are grown are drawn first, and so are many wide feathers: `None` if `go_on`, called
    /// for each row, returns false.
    pub fn rows<'a>(&'a self, window: Window, go_on: &mut dyn FnMut() -> bool) -> Option<LayerRows<'a>> {
        self.rows_keeping(MOST_KEPT, window, go_on)
    }

    fn rows_keeping<'a>(
        &'a self,
        most: usize,
        window: Window,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Option<LayerRows<'a>> {
        let kept = self.0.iter().fold(0usize, |sum, layer| sum.saturating_add(layer.mask.kept(window)));
        let row = vec![0.0; window.width()];
        if self.0.len() > 1 && kept > most {
            return Some(LayerRows { layers: Vec::new(), drawn: Some((self.drawn(window, go_on)?, 0)), row });
        }
        let rows = |layer: &'a Layer| Some((layer, layer.mask.rows(window, go_on)?));
        Some(LayerRows { layers: self.0.iter().map(rows).collect::<Option<_>>()?, drawn: None, row })
    }

    /// Draws one layer after the other.
    fn drawn(&self, window: Window, go_on: &mut dyn FnMut() -> bool) -> Option<Raster<f32>> {
        let mut result = Raster::new(window.width(), window.height(), 0.0f32);
        for layer in &self.0 {
            let mut rows = layer.mask.rows(window, go_on)?;
            for y in 0..window.height() {
                rows.next(go_on)?;
                layer.apply(&rows, result.row_mut(y));
            }
        }
        Some(result)
    }
}

/// The rows of layers in a window, from top to bottom.
pub struct LayerRows<'a> {
    layers: Vec<(&'a Layer, MaskRows<'a>)>,
    /// All rows if they were drawn before, and the number of the next.
    drawn: Option<(Raster<f32>, usize)>,
    row: Vec<f32>,
}

impl LayerRows<'_> {
    /// Whether the values are those of one mask.
    fn is_plain(&self) -> bool {
        matches!(self.layers[..], [(Layer { opacity: 1.0, invert: false, blend: Blend::Add, .. }, _)])
    }

    /// The values, 0 to 1, of the next row. `None` if `go_on` returns false.
    pub fn next(&mut self, go_on: &mut dyn FnMut() -> bool) -> Option<&[f32]> {
        if self.is_plain() {
            return self.layers[0].1.next(go_on);
        }
        if let Some((drawn, next)) = &mut self.drawn {
            *next += 1;
            return go_on().then(|| drawn.row(*next - 1));
        }
        self.row.fill(0.0);
        for (layer, rows) in &mut self.layers {
            rows.next(go_on)?;
            layer.apply(rows, &mut self.row);
        }
        Some(&self.row)
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
    fn layers_drawn_one_by_one_or_row_by_row_are_the_same() {
        let soft = |from, to| {
            let corners = [(from, 0.0), (to, 1.2), (to, 3.3), (from, 4.0)].map(|(x, y)| Point::new(x, y));
            Layer::new(Mask::new(vec![vec![corners.into()]], 0.0, 2.0))
        };
        let layers = Layers(vec![
            soft(0.0, 8.0),
            Layer { invert: true, opacity: 0.3, ..soft(1.0, 3.0) },
            Layer { blend: Blend::Subtract, ..soft(2.5, 4.0) },
            Layer { blend: Blend::Intersect, ..strip(1.5, 12.0) },
        ]);
        let mut by_rows = layers.rows_keeping(usize::MAX, WINDOW, &mut || true).unwrap();
        let mut one_by_one = layers.rows_keeping(0, WINDOW, &mut || true).unwrap();
        assert!(by_rows.drawn.is_none() && one_by_one.drawn.is_some());
        for _ in 0..WINDOW.height() {
            let row = by_rows.next(&mut || true).unwrap();
            assert_eq!(row, one_by_one.next(&mut || true).unwrap());
            assert!(row.iter().any(|value| *value > 0.0 && *value < 1.0), "{row:?}");
        }
        assert_eq!(by_rows.next(&mut || false), None);
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
