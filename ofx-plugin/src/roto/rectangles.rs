//! The rectangle of the whole picture, on which the footage lies.
//!
//! A source has pixels in its region. That may be the whole picture, or only what is drawn in it: where the source is cropped to its
//! drawing, by a node or by the data window of a file, the region is another one on each frame. Shapes must not move with it. The
//! format stays: that of the source where the host says one, else that of the project.

use crate::description::SOURCE;
use crate::ofx::effect::Region;
use crate::ofx::{Clip, Effect, Failure, host};
use openfx::sys::image_effect_v1::image_effect::{
    kOfxImageEffectPropProjectOffset, kOfxImageEffectPropProjectSize, kOfxImageEffectPropSupportsMultiResolution,
};
use rototoon::scene::Footage;

/// Sizes and places that differ by less are the same.
const ROUNDING: f64 = 0.5;
/// Most by which the factors of width and height differ where a picture is stretched evenly, as a share.
const UNEVEN: f64 = 0.01;
/// Number of frames on which a region is looked at, to see whether it changes.
const SAMPLES: u32 = 9;

/// What the host knows of a source's picture at a time.
pub struct Rectangles {
    /// The region at the time.
    region: Option<Region>,
    /// The format of the source.
    format: Option<Region>,
    /// The format of the project.
    project: Option<Region>,
    /// Whether the host has pictures of one size only.
    one_size: bool,
}

impl Rectangles {
    /// What the host says at a time.
    pub fn of(effect: &Effect, time: f64) -> Result<Self, Failure> {
        let source = Some(effect.clip(SOURCE)?).filter(Clip::connected);
        Ok(Self {
            region: source.and_then(|source| region(&source, time)),
            format: source.and_then(|source| source.format()),
            project: format(effect),
            one_size: one_size(),
        })
    }

    /// The rectangle on which footage of this size lies, in canonical units, and whether it has that size; `None` if nothing is known.
    /// `first` gives the region on the first frame of the footage.
    ///
    /// A region that has the size is taken if a format has it too, or if it stays where it is. Then a format that has the size is
    /// taken. Where nothing has it, the footage is stretched over what has its proportions.
    pub fn chosen(&self, size: [f64; 2], first: impl FnOnce() -> Option<Region>) -> Option<(Region, bool)> {
        let fits = |region: &Region| {
            let [width, height] = extent(region);
            (width - size[0]).abs() < ROUNDING && (height - size[1]).abs() < ROUNDING
        };
        if let Some(region) = self.region.filter(|_| self.one_size) {
            // The source fills the picture, whatever the formats say.
            return Some((region, fits(&region)));
        }
        let fitting = [self.format, self.project].into_iter().flatten().find(fits);
        let region = self.region.filter(fits);
        if let Some(found) = fitting.and(region).or(fitting) {
            return Some((found, true));
        }
        let first = first();
        if let Some(found) = first.filter(fits).or(region) {
            return Some((found, true));
        }
        let known = || [self.format, first, self.project, self.region].into_iter().flatten();
        let is_even = |region: &Region| {
            let [width, height] = extent(region);
            (width * size[1] / (height * size[0]) - 1.0).abs() < UNEVEN
        };
        known().find(is_even).or_else(|| known().next()).map(|region| (region, false))
    }
}

/// The region on the first frame of the footage, or on the nearest one that the source has.
pub fn first_region(effect: &Effect, footage: &Footage, time: f64) -> Option<Region> {
    let source = effect.clip(SOURCE).ok().filter(Clip::connected)?;
    let offset = effect.parameters().ok()?.int(c"frameOffset", time).ok()?;
    let [least, most] = source.frame_range()?;
    region(&source, (f64::from(footage.first) + f64::from(offset)).min(most).max(least))
}

/// The rectangle of the whole picture for new footage with these frames of the composition: the source's format, or else its
/// region. One that changes is only what is drawn; then it is the project's format, if that contains it.
pub fn whole(effect: &Effect, [first, last]: [f64; 2]) -> Result<Option<Region>, Failure> {
    let source = Some(effect.clip(SOURCE)?).filter(Clip::connected);
    let Some(source) = source else { return Ok(None) };
    let many = !one_size();
    if let Some(format) = source.format().filter(|_| many) {
        return Ok(Some(format));
    }
    let at = |k| (first + (last - first) * f64::from(k) / f64::from(SAMPLES - 1)).round();
    let mut regions: Vec<Region> = Vec::new();
    for k in 0..SAMPLES {
        regions.extend(region(&source, at(k)).filter(|region| !regions.iter().any(|known| is_same(known, region))));
    }
    let project = format(effect).filter(|project| many && regions.iter().any(|region| contains(project, region)));
    let own = regions.first().copied();
    Ok(match regions.len() {
        0 => format(effect),
        1 => own,
        _ => project.or(own),
    })
}

fn region(source: &Clip, time: f64) -> Option<Region> {
    source.region(time).filter(Region::is_bounded)
}

fn extent(region: &Region) -> [f64; 2] {
    [region.x2 - region.x1, region.y2 - region.y1]
}

fn is_same(a: &Region, b: &Region) -> bool {
    a.to_array().iter().zip(b.to_array()).all(|(a, b)| (a - b).abs() < ROUNDING)
}

fn contains(whole: &Region, region: &Region) -> bool {
    whole.x1 <= region.x1 + ROUNDING
        && whole.y1 <= region.y1 + ROUNDING
        && region.x2 <= whole.x2 + ROUNDING
        && region.y2 <= whole.y2 + ROUNDING
}

/// Whether the host has pictures of one size only.
fn one_size() -> bool {
    let multi = host::properties().and_then(|host| host.int(kOfxImageEffectPropSupportsMultiResolution, 0));
    multi.is_ok_and(|multi| multi == 0)
}

/// The rectangle of the project's format.
pub fn format(effect: &Effect) -> Option<Region> {
    let properties = effect.properties().ok()?;
    let [width, height] = properties.doubles(kOfxImageEffectPropProjectSize).ok()?;
    let [x, y] = properties.doubles(kOfxImageEffectPropProjectOffset).unwrap_or_default();
    let whole = Region { x1: x, y1: y, x2: x + width, y2: y + height };
    (whole.x1 < whole.x2 && whole.y1 < whole.y2 && whole.is_bounded()).then_some(whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x1: f64, y1: f64, width: f64, height: f64) -> Region {
        Region { x1, y1, x2: x1 + width, y2: y1 + height }
    }

    fn known(region: Region, format: Option<Region>, project: Region) -> Rectangles {
        Rectangles { region: Some(region), format, project: Some(project), one_size: false }
    }

    #[test]
    fn what_has_the_size_of_the_footage_carries_it() {
        let (hd, crop, moved) =
            (at(0.0, 0.0, 1920.0, 1080.0), at(50.0, 60.0, 600.0, 400.0), at(9.0, 9.0, 600.0, 400.0));
        let hd_size = [1920.0, 1080.0];
        let unused = || -> Option<Region> { panic!("the formats say enough") };
        assert_eq!(known(crop, None, hd).chosen(hd_size, unused), Some((hd, true)));
        assert_eq!(known(crop, Some(hd), crop).chosen(hd_size, unused), Some((hd, true)));
        // A whole picture that was moved takes its shapes with it.
        let whole = at(100.0, 0.0, 1920.0, 1080.0);
        assert_eq!(known(whole, None, hd).chosen(hd_size, unused), Some((whole, true)));
        // A smaller source that stays, and one that moves: there the first frame counts.
        assert_eq!(known(crop, None, hd).chosen([600.0, 400.0], || Some(crop)), Some((crop, true)));
        assert_eq!(known(moved, None, hd).chosen([600.0, 400.0], || Some(crop)), Some((crop, true)));
        assert_eq!(known(at(0.0, 0.0, 9.0, 9.0), None, hd).chosen([600.0, 400.0], || Some(crop)), Some((crop, true)));
    }

    #[test]
    fn footage_is_stretched_over_what_has_its_proportions() {
        let (hd, crop) = (at(0.0, 0.0, 1920.0, 1080.0), at(50.0, 60.0, 600.0, 450.0));
        assert_eq!(known(crop, None, hd).chosen([960.0, 540.0], || Some(crop)), Some((hd, false)));
        assert_eq!(known(crop, Some(hd), crop).chosen([960.0, 540.0], || Some(crop)), Some((hd, false)));
        assert_eq!(known(crop, None, hd).chosen([400.0, 300.0], || Some(crop)), Some((crop, false)));
        assert_eq!(known(crop, None, hd).chosen([500.0, 100.0], || Some(crop)), Some((crop, false)));
        let one = Rectangles { one_size: true, ..known(crop, Some(hd), hd) };
        assert_eq!(one.chosen([1920.0, 1080.0], || None), Some((crop, false)));
        let nothing = Rectangles { region: None, format: None, project: None, one_size: false };
        assert_eq!(nothing.chosen([9.0, 9.0], || None), None);
    }
}
