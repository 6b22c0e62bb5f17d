//! Painted regions and strokes of a document, placed in the host's picture. They are those of the command line's `render`.
//!
//! A drawing is held until the next frame. So there is nothing between two frames, and motion blur does not change it.

use super::instance;
use super::parts::{matches, patterns};
use super::placement::Placement;
use super::settings::Settings;
use super::shared::Loaded;
use crate::ofx::{Effect, Failure};
use rototoon::pipeline::Cels;
use rototoon::render::paint::Region;
use rototoon::scene::FrameNumber;
use std::collections::BTreeSet;

const NO_REGIONS: &str = "the project has no painted regions: `rototoon fill` and Fill Drawings in Blender make them";
const NO_STROKES: &str =
    "the project has no strokes: `rototoon trace`, `rototoon tween` and Export in Blender write them";

/// What is shown at the settings' time, from back to front. Warns the user about what is missing.
pub fn shown(
    effect: &Effect,
    document: &Loaded,
    settings: &Settings,
    placement: &Placement,
) -> Result<Vec<Region>, Failure> {
    let cels = read(effect, document, settings)?;
    let names = patterns(&settings.drawn_names);
    if !names.is_empty() {
        let known: BTreeSet<String> =
            [document.regions(), document.strokes()].into_iter().flatten().flat_map(Cels::names).collect();
        for name in names.iter().filter(|name| !known.iter().any(|known| matches(name, known))) {
            let text =
                format!("Regions and strokes: found no {name:?}, expected names such as \"region 3\" or \"stroke *\"");
            instance(effect)?.note(effect, &text, false);
        }
    }
    let scale = placement.magnification();
    let Some(frame) = frame(settings).filter(|_| scale > 0.0) else { return Ok(Vec::new()) };
    let meant = |region: &Region| names.is_empty() || names.iter().any(|name| matches(name, &region.name));
    let regions = cels.into_iter().flat_map(|cels| cels.on(frame, scale)).filter(meant);
    Ok(regions.map(|region| region.moved(|p| placement.place_magnified(p))).collect())
}

/// What the output shows, from back to front.
fn read<'a>(effect: &Effect, document: &'a Loaded, settings: &Settings) -> Result<Vec<&'a Cels>, Failure> {
    let instance = instance(effect)?;
    let mut all = Vec::new();
    for (wanted, read, missing) in [
        (settings.output.shows_regions(), Loaded::regions as fn(&'a Loaded) -> _, NO_REGIONS),
        (settings.output.shows_strokes(), Loaded::strokes, NO_STROKES),
    ] {
        if !wanted {
            continue;
        }
        let cels: &Cels = read(document).map_err(|text: &String| {
            instance.note(effect, text, true);
            Failure::Told(text.clone())
        })?;
        if cels.is_empty() {
            instance.note(effect, missing, false);
        }
        all.push(cels);
    }
    Ok(all)
}

/// The frame that is shown. `None` if nothing is.
fn frame(settings: &Settings) -> Option<FrameNumber> {
    let frame = settings.document_time.floor();
    let whole = settings.shown && (f64::from(FrameNumber::MIN)..=f64::from(FrameNumber::MAX)).contains(&frame);
    whole.then_some(frame as FrameNumber)
}
