//! Writes ids as OpenEXR files with Cryptomatte layers, one for each frame of the footage.
//!
//! A keyer needs the names of the parts beside the pixels: they are metadata of the file. OpenFX has no metadata of images.
//! The standard's headers do not know the word, and the proposal for it is open (AcademySoftwareFoundation/openfx, issue
//! 142). So an effect's output cannot be a Cryptomatte, and the node writes the files itself, as `rototoon render` does.
//!
//! Files have the numbers of the composition's frames. They are as large as the project's footage. Borders are sharp.
//!
//! Shapes beyond the footage have no file; a message names their frames.
//!
//! The name is a pattern as everywhere: `%%` stands for a percent sign.

use crate::ofx::progress::Bar;
use crate::ofx::{Effect, Failure};
use rototoon::pipeline::{self, Picture, RenderJob};
use rototoon::project::Document;
use rototoon::render::form::Form;
use rototoon::scene::pattern::FramePattern;
use rototoon::scene::{FrameNumber, Scene, Silent};
use std::collections::BTreeSet;
use std::path::Path;

/// Writes a file for each frame. `name` is a pattern with one `%d` or `%0Nd`; `offset` is the composition's frame that shows
/// frame 0 of the document. Files that were finished before the user cancels stay.
pub fn write(effect: &Effect, document: &Document, name: &str, offset: i32) -> Result<(), Failure> {
    let told = |error: &dyn std::fmt::Display| Failure::Told(format!("export file: {error}"));
    // Without a number each frame would replace the one before it.
    FramePattern::parse(name).map_err(|error| told(&error))?;
    let (first, last) = (document.scene.footage.first, document.scene.footage.last);
    // Threads of its own end with it. Those that all work of a process shares would outlive the plugin.
    let pool = rayon::ThreadPoolBuilder::new().thread_name(|index| format!("rototoon-{index}")).build();
    let pool = pool.map_err(|error| told(&format!("cannot start threads: {error}")))?;
    let bar = Bar::new(*effect, "Rototoon: writing ids");
    for frame in first..=last {
        if !bar.update(f64::from(frame - first) / f64::from(last - first + 1)) {
            return Err(Failure::Aborted);
        }
        let job = RenderJob {
            picture: Picture::Ids,
            frames: Some(frame..=frame),
            offset,
            parts: None,
            scale: 1.0,
            form: Form::default(),
            output: name.to_owned(),
        };
        let folder = Path::new("");
        pool.install(|| pipeline::render(document, folder, &job, &Silent)).map_err(|error| told(&error))?;
    }
    Ok(())
}

/// Names the frames with shapes that have no file, by their numbers in the composition.
pub fn left_out(scene: &Scene, offset: i32) -> Option<String> {
    let inside = scene.footage.first..=scene.footage.last;
    let shapes = scene.parts.iter().flat_map(|part| part.keys.keys().chain(part.tracks.keys()));
    let outside: BTreeSet<FrameNumber> = shapes.copied().filter(|frame| !inside.contains(frame)).collect();
    let [first, last] = [outside.first()?, outside.last()?].map(|frame| frame.saturating_add(offset));
    let frames = if first == last { format!("frame {first}") } else { format!("frames {first} to {last}") };
    Some(format!("there are shapes on {frames} beyond the project's footage: no ids of them are written"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::scene::{Footage, Part};

    #[test]
    fn frames_without_a_file_are_named() {
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 24.0, width: 8, height: 8, held: false };
        let keys = |frames: &[FrameNumber]| frames.iter().map(|&frame| (frame, Vec::new())).collect();
        let scene = |frames| Scene {
            footage: footage.clone(),
            parts: vec![
                Part { keys: keys(frames), ..Part::default() },
                Part { tracks: keys(frames), ..Part::default() },
            ],
        };
        assert_eq!(left_out(&scene(&[0, 9]), 5), None);
        assert!(left_out(&scene(&[3, 10]), 5).unwrap().contains("on frame 15 beyond"));
        assert!(left_out(&scene(&[-2, 3, 12]), 0).unwrap().contains("on frames -2 to 12 beyond"));
    }
}
