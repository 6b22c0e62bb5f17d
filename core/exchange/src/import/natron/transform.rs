//! The transformation of a curve of Natron.
//!
//! A curve has parameters named `translate`, `rotate` (degrees from x to y, and y is up), `scale`, `uniform`, `skewx`, `skewy`,
//! `skewOrder` and `center`, and a matrix E of nine numbers that trackers set. With the centre c, the translation t, the
//! rotation R, the skew K, the scale S and the affine E, a point p goes to
//!
//! c + t + R K S (E p − c), with K = (1 + kx ky, kx; ky, 1), or (1, kx; ky, 1 + kx ky) for the order YX.
//!
//! Where `uniform` is on, the scale of x is that of y too. Layers have no transformation.
//!
//! Source: `RotoDrawableItem::getTransformAtTime` and `Transform::matTransformCanonical` in the public sources of Natron 2.

use super::super::channel::Channel;
use super::super::problem::{Fault, ImportError};
use super::number::{child, keys, named, number, text_of};
use glam::{DAffine2, DMat2};
use rototoon_base::geometry::Point;
use roxmltree::Node;

/// A transformation with its keys, in pixels with y up.
pub(super) struct Transform {
    /// x, y each: centre, translation, scale, skew.
    pairs: [[Channel; 2]; 4],
    rotation: Channel,
    uniform: bool,
    skewed_y_first: bool,
    /// The rows of the matrix.
    matrix: Vec<Channel>,
}

impl Transform {
    /// The transformation of a curve; `None` if it does not move anything.
    pub(super) fn read(item: Node) -> Result<Option<Self>, Fault> {
        let Some(own) = child(item, "RotoDrawableItemSerialization") else { return Ok(None) };
        let values = |name: &str, fallback: &[f64]| parameter(own, name, fallback);
        let pair = |name: &str, fallback: f64| {
            let found = values(name, &[fallback; 2])?;
            Ok::<_, Fault>([found[0].clone(), found[1].clone()])
        };
        let single = |name: &str, fallback: f64| Ok::<_, Fault>(values(name, &[fallback])?.swap_remove(0));
        const NOTHING: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let matrix = values("extraMatrix", &NOTHING)?;
        if !(matrix[6].is(0.0) && matrix[7].is(0.0) && matrix[8].is(1.0)) {
            return Err(Fault::Omitted("its matrix is a perspective".into()));
        }
        let skew = [single("skewx", 0.0)?, single("skewy", 0.0)?];
        let found = Self {
            pairs: [pair("center", 0.0)?, pair("translate", 0.0)?, pair("scale", 1.0)?, skew],
            rotation: single("rotate", 0.0)?,
            uniform: !single("uniform", 0.0)?.is(0.0),
            skewed_y_first: single("skewOrder", 0.0)?.is(1.0),
            matrix,
        };
        let [_, translation, scale, skew] = &found.pairs;
        let still = [&translation[0], &translation[1], &skew[0], &skew[1], &found.rotation].iter().all(|c| c.is(0.0))
            && scale[0].is(1.0)
            && (found.uniform || scale[1].is(1.0))
            && found.matrix.iter().zip(NOTHING).all(|(channel, value)| channel.is(value));
        Ok((!still).then_some(found))
    }

    /// Its numbers.
    pub(super) fn channels(&self) -> impl Iterator<Item = &Channel> {
        self.pairs.iter().flatten().chain([&self.rotation]).chain(&self.matrix)
    }

    /// Whether points may go on curves between its keys.
    pub(super) fn bends(&self) -> bool {
        let [_, _, scale, skew] = &self.pairs;
        let shape = scale.iter().chain(skew).chain([&self.rotation]).chain(&self.matrix);
        shape.into_iter().any(|channel| channel.turns().next().is_some())
    }

    /// The map of points on a frame.
    pub(super) fn at(&self, frame: f64) -> DAffine2 {
        let [center, translation, mut scale, skew] =
            [0, 1, 2, 3].map(|k: usize| Point::new(self.pairs[k][0].at(frame), self.pairs[k][1].at(frame)));
        if self.uniform {
            scale.y = scale.x;
        }
        let both = 1.0 + skew.x * skew.y;
        let (first, second) = if self.skewed_y_first { (1.0, both) } else { (both, 1.0) };
        let skewed = DMat2::from_cols(Point::new(first, skew.y), Point::new(skew.x, second));
        let turned = DMat2::from_angle(self.rotation.at(frame).to_radians());
        let row = |k: usize| [0, 1, 2].map(|column| self.matrix[3 * k + column].at(frame));
        let ([a, b, c], [d, e, f]) = (row(0), row(1));
        let extra = DAffine2::from_cols(Point::new(a, d), Point::new(b, e), Point::new(c, f));
        DAffine2::from_mat2_translation(turned * skewed * DMat2::from_diagonal(scale), center + translation)
            * DAffine2::from_translation(-center)
            * extra
    }
}

/// The values of a parameter of a curve; those of `fallback` where it is not saved.
pub(super) fn parameter(own: Node, name: &str, fallback: &[f64]) -> Result<Vec<Channel>, Fault> {
    let same = |node: &Node| {
        named(*node, "Item") && child(*node, "Name").is_some_and(|own| text_of(own).eq_ignore_ascii_case(name))
    };
    let saved = own.children().find(same);
    let mut items = saved.into_iter().flat_map(|node| node.children()).filter(|node| named(*node, "item"));
    fallback.iter().map(|fallback| items.next().map_or(Ok(Channel::constant(*fallback)), value)).collect()
}

/// One value of a parameter.
fn value(item: Node) -> Result<Channel, Fault> {
    let linked = child(item, "HasMaster").is_some_and(|node| text_of(node) == "1");
    let computed = child(item, "Expression").is_some_and(|node| !text_of(node).is_empty());
    if linked || computed {
        return Err(Fault::Omitted("its transformation is linked or an expression, known to Natron alone".into()));
    }
    if let Some(channel) = child(item, "Curve").map(keys).transpose()?.flatten() {
        return Ok(channel);
    }
    let own = child(item, "Value").ok_or_else(|| ImportError::at(item, "found no <Value>, expected one"))?;
    Ok(Channel::constant(number(own)?))
}
