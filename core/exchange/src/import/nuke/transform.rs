//! The transformation of a shape or a layer.
//!
//! A list `t` has up to 13 numbers, each still or animated: the pivot, the translation, the rotation in degrees and the
//! scale, three each (x, y, z), then the skew. A shorter list has the defaults after its end; most have a pivot only. A list
//! `tx` has a frame before them. With the pivot c, the translation d, the rotation R about z (from x to y, and y is up) and
//! the scale S, a point p goes to
//!
//! c + d + R S (p − c).
//!
//! A shape's own transformation comes first, then those of its layers from the inside out. Skew, rotations out of the
//! picture and a matrix after the skew are used by few; the order in which they are applied is not public. A shape with one of
//! them is left out.
//!
//! Source: Foundry, Nuke Developer Kit, "Roto serialisation format"; Nuke Python reference, `CTransform` and
//! `AnimCTransform`; Nuke reference guide, Transform (scale, then rotation, then translation is the default order); scripts
//! of Nuke 7 to 13 in public repositories.

use super::super::channel::Channel;
use super::super::problem::Fault;
use super::number::channel;
use super::words::Item;
use glam::DAffine2;
use rototoon_base::geometry::Point;

/// A transformation with its keys, in pixels with y up.
pub(super) struct Transform {
    pivot: [Channel; 2],
    translation: [Channel; 2],
    rotation: Channel,
    scale: [Channel; 2],
}

impl Transform {
    /// The transformation of a shape or a layer; `None` if it does not move anything.
    pub(super) fn read(text: &str, owner: &Item) -> Result<Option<Self>, Fault> {
        let own = |list: &&Item| matches!(list.name(), Some("t" | "tx"));
        let Some(list) = owner.items().iter().find(own) else { return Ok(None) };
        let skipped = if list.name() == Some("tx") { 2 } else { 1 };
        let numbers = list.items().get(skipped..).unwrap_or_default();
        let number = |k: usize| match numbers.get(k) {
            Some(item) => channel(text, item, "t"),
            None => Ok(Channel::constant(if (9..12).contains(&k) { 1.0 } else { 0.0 })),
        };
        // An expression in a pivot changes nothing where there is nothing else.
        let moved = (3..13).map(number).collect::<Result<Vec<_>, _>>()?;
        let [x, y, z, tilt, roll, rotation, width, height, _, skew] = &moved[..] else { return Ok(None) };
        if numbers.len() > 13 {
            return Err(Fault::Omitted("it or its layer has a matrix".into()));
        }
        if !skew.is(0.0) {
            return Err(Fault::Omitted("it or its layer is skewed".into()));
        }
        if ![z, tilt, roll].iter().all(|channel| channel.is(0.0)) {
            return Err(Fault::Omitted("it or its layer is moved or turned in depth".into()));
        }
        if [x, y, rotation].iter().all(|channel| channel.is(0.0)) && width.is(1.0) && height.is(1.0) {
            return Ok(None);
        }
        Ok(Some(Self {
            pivot: [number(0)?, number(1)?],
            translation: [x.clone(), y.clone()],
            rotation: rotation.clone(),
            scale: [width.clone(), height.clone()],
        }))
    }

    /// The frames on which it has keys.
    pub(super) fn frames(&self) -> impl Iterator<Item = f64> + '_ {
        let all = self.pivot.iter().chain(&self.translation).chain(&self.scale).chain([&self.rotation]);
        all.flat_map(Channel::turns)
    }

    /// Whether points may go on curves between its keys.
    pub(super) fn bends(&self) -> bool {
        self.scale.iter().chain([&self.rotation]).any(|channel| channel.turns().next().is_some())
    }

    /// The map of points on a frame.
    pub(super) fn at(&self, frame: f64) -> DAffine2 {
        let pair = |[x, y]: &[Channel; 2]| Point::new(x.at(frame), y.at(frame));
        let (pivot, scale) = (pair(&self.pivot), pair(&self.scale));
        let angle = self.rotation.at(frame).to_radians();
        let place = pivot + pair(&self.translation);
        DAffine2::from_scale_angle_translation(scale, angle, place) * DAffine2::from_translation(-pivot)
    }
}
