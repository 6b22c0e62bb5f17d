//! Shapes of other programs become keys of a document.

use super::imported::Imported;
use super::{PipelineError, excerpt};
use crate::export;
use crate::import::svg::Still;
use crate::import::{self, ImportError, Shapes};
use crate::project::Document;
use crate::scene::{Footage, FrameNumber, Scene};
use std::collections::BTreeMap;

/// A format of a file with shapes. Shapes without animation get their key on the frame `still`, a frame of the footage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeFormat {
    /// SVG.
    Svg {
        /// A frame of the footage.
        still: FrameNumber,
        /// Whether an export of one frame lies on that frame too, though it says another one.
        asked: bool,
    },
    /// Silhouette shapes.
    Silhouette,
    /// A script of Nuke.
    Nuke {
        /// A frame of the footage.
        still: FrameNumber,
    },
    /// A project of Natron.
    Natron {
        /// A frame of the footage.
        still: FrameNumber,
    },
    /// A setting of Fusion.
    Fusion {
        /// A frame of the footage.
        still: FrameNumber,
    },
}

impl ShapeFormat {
    /// The format of files with this extension.
    pub fn of(extension: &str, still: FrameNumber) -> Option<Self> {
        Some(match extension {
            "svg" => Self::Svg { still, asked: false },
            "fxs" => Self::Silhouette,
            "nk" => Self::Nuke { still },
            "ntp" => Self::Natron { still },
            "setting" | "comp" => Self::Fusion { still },
            _ => return None,
        })
    }

    /// The extension of files that this program writes in the format.
    fn extension(self) -> &'static str {
        match self {
            Self::Svg { .. } => "svg",
            Self::Silhouette => "fxs",
            Self::Nuke { .. } => "nk",
            Self::Natron { .. } => "ntp",
            Self::Fusion { .. } => "setting",
        }
    }

    /// The format where all frames are `offset` later.
    fn shifted(self, offset: FrameNumber) -> Self {
        let moved = |still: FrameNumber| still.saturating_add(offset);
        match self {
            Self::Svg { still, asked } => Self::Svg { still: moved(still), asked },
            Self::Silhouette => Self::Silhouette,
            Self::Nuke { still } => Self::Nuke { still: moved(still) },
            Self::Natron { still } => Self::Natron { still: moved(still) },
            Self::Fusion { still } => Self::Fusion { still: moved(still) },
        }
    }
}

/// Puts the shapes in the text of a file into the document as keys of parts. The frames of the file are those of the document plus
/// `offset`; the frame in `format` is one of the document.
///
/// # Errors
///
/// [`PipelineError::Option`] for an offset that is too large, and [`PipelineError::Import`]; the document is then unchanged.
pub fn import_shifted(
    document: &mut Document,
    text: &str,
    format: ShapeFormat,
    offset: FrameNumber,
) -> Result<Imported, PipelineError> {
    let footage = excerpt::shifted(&document.scene.footage, offset)?;
    let names: Vec<&str> = document.scene.parts.iter().map(|part| part.name.as_str()).collect();
    let mut found = shapes(&footage, &names, text, format.shifted(offset))?;
    let own = own_names(&document.scene, format.extension());
    for shape in &mut found.shapes {
        shape.move_by(offset.saturating_neg());
        if let Some(name) = own.get(&shape.name) {
            shape.name.clone_from(name);
        }
    }
    Ok(Imported { merged: import::into_scene(&mut document.scene, found.shapes)?, warnings: found.warnings })
}

/// The parts whose name the format cannot write, by their names there.
fn own_names(scene: &Scene, extension: &str) -> BTreeMap<String, String> {
    let renamed = export::renamed(scene, extension).into_iter();
    renamed.map(|(own, there)| (there, own.to_owned())).collect()
}

/// The shapes of a file for a document whose parts have these names.
fn shapes(footage: &Footage, names: &[&str], text: &str, format: ShapeFormat) -> Result<Shapes, ImportError> {
    match format {
        ShapeFormat::Svg { still, asked } => import::svg::svg_of(text, footage, Still { frame: still, asked }, names),
        ShapeFormat::Silhouette => import::silhouette::silhouette(text, footage),
        ShapeFormat::Nuke { still } => import::nuke::nuke(text, footage, still),
        ShapeFormat::Natron { still } => import::natron::natron(text, footage, still),
        ShapeFormat::Fusion { still } => import::fusion::fusion(text, footage, still),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::scene::Part;

    fn document() -> Document {
        let footage =
            Footage { pattern: "%d.png".into(), first: 1, last: 9, fps: 12.0, width: 64, height: 48, held: false };
        let at = |frame: FrameNumber, x: f64| (frame, vec![Point::new(x + f64::from(frame), 2.0), Point::X, Point::Y]);
        let part = |(k, name): (usize, &str)| Part {
            name: name.into(),
            closed: true,
            depth: k as f64,
            keys: [1, 9].map(|frame| at(frame, 3.0)).into(),
            tracks: (1..=9).map(|frame| at(frame, 3.0)).collect(),
            confidence: (1..=9).map(|frame| (frame, vec![0.4; 3])).collect(),
            ..Part::default()
        };
        let parts = ["große Hand", "a\"b [1]", "arm"].into_iter().enumerate().map(part).collect();
        Document::new(Scene { footage, parts })
    }

    /// A scene in each form that comes in again.
    fn written(scene: &Scene) -> [(&'static str, String); 5] {
        [
            ("nk", export::nuke(scene, 2.0)),
            ("ntp", export::natron_project(scene, 2.0)),
            ("fxs", export::silhouette(scene, 2.0)),
            ("setting", export::fusion(scene, 2.0)),
            ("svg", export::svg(scene, &export::SvgOptions::default())),
        ]
    }

    #[test]
    fn what_other_programs_give_back_unchanged_changes_nothing() {
        let own = document();
        for (extension, text) in written(&own.scene) {
            let mut found = document();
            let format = ShapeFormat::of(extension, 1).unwrap();
            let imported = import_shifted(&mut found, &text, format, 0).unwrap();
            assert_eq!(found.scene, own.scene, "{extension}");
            let told = imported.told().unwrap();
            assert!(told.starts_with("as before ") && !told.contains(';'), "{extension}: {told}");
        }
    }

    #[test]
    fn what_a_program_without_titles_gives_back_finds_its_parts() {
        let own = document();
        let text = export::svg(&own.scene, &export::SvgOptions::default());
        let bare = text.replace("<title>", "<desc>").replace("</title>", "</desc>");
        let mut found = document();
        let imported = import_shifted(&mut found, &bare, ShapeFormat::Svg { still: 1, asked: false }, 0).unwrap();
        assert_eq!(found.scene, own.scene);
        let [told] = &imported.warnings[..] else { panic!("{:?}", imported.warnings) };
        let pairs = r#"part-0 is "große Hand", part-1 is "a\"b [1]", part-2 is "arm""#;
        assert!(told.contains("taken by their numbers") && told.ends_with(pairs), "{told}");
        // Parts of an excerpt have the numbers of the whole document.
        let asked = excerpt::Excerpt { parts: Some(vec!["arm".into()]), ..excerpt::Excerpt::default() };
        let some = export::svg(&excerpt::excerpt(&own, &asked).unwrap().scene, &export::SvgOptions::default());
        let imported = import_shifted(
            &mut found,
            &some.replace("title>", "desc>"),
            ShapeFormat::Svg { still: 1, asked: false },
            0,
        )
        .unwrap();
        assert!(imported.warnings[0].ends_with(r#": part-2 is "arm""#), "{:?}", imported.warnings);
        assert_eq!(found.scene, own.scene);
    }

    #[test]
    fn names_that_differ_in_blanks_come_back_in_every_form() {
        let mut own = document();
        for (part, name) in own.scene.parts.iter_mut().zip(["arm", "arm ", " arm"]) {
            part.name = name.into();
            let move_by = name.len() as f64 * 10.0 + f64::from(u8::from(name.starts_with(' '))) * 5.0;
            part.keys.values_mut().chain(part.tracks.values_mut()).flatten().for_each(|p| p.x += move_by);
        }
        for (extension, text) in written(&own.scene) {
            let mut found = own.clone();
            import_shifted(&mut found, &text, ShapeFormat::of(extension, 1).unwrap(), 0).unwrap();
            assert_eq!(found.scene, own.scene, "{extension}");
        }
    }

    #[test]
    fn an_edit_is_told_with_its_frames() {
        let mut edited = document();
        edited.scene.parts[0].tracks.get_mut(&4).unwrap()[0].x += 5.0;
        let mut text = document();
        text.scene.parts[2].name = "leg".into();
        edited.scene.parts[2] = text.scene.parts[2].clone();
        let mut found = document();
        let text = export::nuke(&edited.scene, 2.0);
        let imported = import_shifted(&mut found, &text, ShapeFormat::Nuke { still: 1 }, 0).unwrap();
        let told = imported.told().unwrap();
        assert_eq!(told, r#"changed "große Hand" on 4; as before "a\"b [1]"; new "leg""#);
        assert_eq!(found.scene.parts[0].keys.keys().copied().collect::<Vec<_>>(), [1, 4, 9]);
        assert_eq!(found.scene.parts.len(), 4);
    }
}
