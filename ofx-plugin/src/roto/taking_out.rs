//! Takes motions and shapes out: keys of parameters to which other nodes can be linked, and files for other programs.

use super::instance::NO_SHAPES;
use super::motion::Motion;
use super::parts::meant;
use super::placement::Placement;
use super::reach::Reach;
use super::settings::{self, Settings};
use super::shared::Loaded;
use super::{id_files, instance, motion, numbering};
use crate::description::OUTPUT;
use crate::ofx::{Effect, Failure};
use rototoon::export::{Detail, ShapeOptions, SvgOptions};
use rototoon::geometry::Point;
use rototoon::pipeline;
use rototoon::project::{Document, write_whole};
use rototoon::scene::FrameNumber;
use std::ffi::CStr;
use std::path::Path;
use std::sync::Arc;

/// The parameters with two numbers, and their values in a motion.
type Pairs = [(&'static CStr, fn(&Motion) -> Point); 6];

const PAIRS: Pairs = [
    (c"center", |motion| motion.centre),
    (c"translate", |motion| motion.translate),
    (c"corner1", |motion| motion.corners[0]),
    (c"corner2", |motion| motion.corners[1]),
    (c"corner3", |motion| motion.corners[2]),
    (c"corner4", |motion| motion.corners[3]),
];
/// Distance of the points of snapped paths in files, in pixels.
const SPACING: f64 = 2.0;

fn document(effect: &Effect) -> Result<Arc<Loaded>, Failure> {
    let document = instance(effect)?.document(&effect.parameters()?)?;
    document.ok_or_else(|| Failure::Told(NO_SHAPES.into()))
}

/// Sets keys for the motion of the selected part on all of its frames.
pub fn write_motion(effect: &Effect, time: f64) -> Result<(), Failure> {
    let (document, parameters) = (document(effect)?, effect.parameters()?);
    let text = parameters.text(c"part")?;
    let name = meant(&document.scene.parts, &text);
    let part = document.scene.parts.iter().find(|part| part.name == name);
    let part = part.ok_or_else(|| Failure::Told("select a part first: its name is in Part".into()))?;
    let shapes = if part.tracks.is_empty() { &part.keys } else { &part.tracks };
    if shapes.is_empty() {
        return Err(Failure::Told(format!("{name:?} has no shape: draw or track it first")));
    }
    let offset = f64::from(parameters.int(c"frameOffset", time)?);
    let placement = Placement::of(effect, &document.scene.footage, time, [1.0; 2])?;
    let frames: Vec<FrameNumber> = shapes.keys().copied().collect();
    let placed = |points: &Vec<Point>| points.iter().map(|&p| Point::from(placement.shown(p))).collect();
    let found = motion::motions(&shapes.values().map(placed).collect::<Vec<Vec<Point>>>());
    parameters.edit("Write motion", || {
        for (id, _) in PAIRS {
            parameters.delete_keys(id)?;
        }
        parameters.delete_keys(c"rotate")?;
        parameters.delete_keys(c"scale")?;
        for (frame, motion) in frames.iter().zip(&found).filter_map(|(frame, motion)| Some((frame, motion.as_ref()?))) {
            let at = f64::from(*frame) + offset;
            for (id, value) in PAIRS {
                parameters.set_pair_at(id, at, value(motion).into())?;
            }
            parameters.set_double_at(c"rotate", at, motion.rotate)?;
            parameters.set_double_at(c"scale", at, motion.scale)?;
        }
        Ok(())
    })
}

/// The document with the falloffs and colours that the node's parameters give its parts at a time.
fn dressed(effect: &Effect, document: &Document, time: f64) -> Result<Document, Failure> {
    let (parameters, mut document) = (effect.parameters()?, document.clone());
    let state = instance(effect)?.state(&parameters)?;
    Reach::of(effect)?.widen_own(&mut document.scene.footage);
    let (settings, colours) = (Settings::read(&parameters, time, &state)?, settings::colours(&parameters, &state)?);
    for part in &mut document.scene.parts {
        part.falloff = settings.look(&part.name).falloff.within(part.falloff).within(settings.falloff);
        part.colour = colours.get(&part.name).copied().or(part.colour);
    }
    Ok(document)
}

/// Writes the shapes to the export file, on the frames of the composition. Its extension names the format.
pub fn export(effect: &Effect, time: f64) -> Result<(), Failure> {
    let mut document = dressed(effect, &*document(effect)?, time)?;
    let offset = effect.parameters()?.int(c"frameOffset", 0.0)?;
    let path = effect.parameters()?.text(c"exportFile")?;
    let path = Path::new(path.trim());
    if path.as_os_str().is_empty() {
        return Err(Failure::Told("choose an export file first".into()));
    }
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_ascii_lowercase();
    if extension == "exr" {
        id_files::write(effect, &document, &path.to_string_lossy(), offset)?;
        if let Some(left_out) = id_files::left_out(&document.scene, offset) {
            instance(effect)?.note(effect, &left_out, false);
        }
        return Ok(());
    }
    numbering::shift(&mut document.scene, offset);
    let options = ShapeOptions { detail: Detail::Spacing(SPACING), pixel_aspect: effect.clip(OUTPUT)?.pixel_aspect() };
    let text = match extension.as_str() {
        "nk" => pipeline::export_nuke(&document, options),
        "ntp" => pipeline::export_natron_project(&document, SPACING),
        "py" => pipeline::export_natron(&document, SPACING),
        "jsx" => pipeline::export_after_effects(&document, options),
        "fxs" => pipeline::export_silhouette(&document, options),
        "setting" => pipeline::export_fusion(&document, options),
        "svg" => pipeline::export_svg(&document, &SvgOptions { spacing: SPACING, ..SvgOptions::default() })
            .map_err(|error| Failure::Told(error.to_string()))?,
        _ => {
            let shown = path.display();
            return Err(Failure::Told(format!(
                "export file: found {shown}, expected a name that ends in .nk, .ntp, .py, .jsx, .fxs, .setting, .svg or .exr"
            )));
        }
    };
    if let Some(nothing) = pipeline::nothing_for(&document, &extension) {
        return Err(Failure::Told(format!("export file: {nothing}")));
    }
    write_whole(path, text.as_bytes()).map_err(|error| Failure::Told(error.to_string()))?;
    let left_out = pipeline::left_out_of_shapes(&document, &extension);
    let told: Vec<String> = left_out.into_iter().chain(pipeline::squeezed(options.pixel_aspect, &extension)).collect();
    if !told.is_empty() {
        instance(effect)?.note(effect, &told.join("; "), false);
    }
    Ok(())
}
