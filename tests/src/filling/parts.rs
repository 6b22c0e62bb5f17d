//! Films of tracked characters: their parts in lines, and in colours by chance.
//!
//! A character with truth for tracking ([`crate::truth`]) has the contour of each part on every frame. Drawn from the farthest to the nearest, they
//! are a film for fills. Colours by chance make neighbours differ that are alike in the real film.

use super::figures::COLOURS;
use super::shapes::{Picture, Shape};
use crate::sample::outline::Outline;
use crate::truth::Truth;
use crate::tweening::matching::Chance;
use anyhow::Result;
use rototoon::geometry::Point;
use rototoon::project::Document;
use std::path::Path;

/// The drawings of the character in a folder with project.json and truth.json. Drawings that are held come once.
///
/// # Errors
///
/// A document that is missing or cannot be read.
pub fn drawings(folder: &Path) -> Result<Vec<Picture>> {
    let scene = Document::load(&folder.join("project.json"))?.scene;
    let truth = Truth::load(&folder.join("truth.json"))?;
    let order = Chance(truth.parts.len() as u64).order(COLOURS.len());
    let tone = |k: usize| COLOURS[order[k % COLOURS.len()]];
    let mut parts: Vec<usize> = (0..truth.parts.len().min(scene.parts.len())).collect();
    // Of equal depths the later part is nearer.
    parts.sort_by(|&a, &b| scene.parts[a].depth.total_cmp(&scene.parts[b].depth));
    let contours = |frame: i32| -> Vec<(usize, &Vec<Point>)> {
        parts.iter().filter_map(|&k| Some((k, truth.parts[k].contour.get(&frame)?))).collect()
    };
    let mut drawn = Vec::new();
    for frame in scene.footage.first..=scene.footage.last {
        let own = contours(frame);
        if !own.is_empty() && drawn.last() != Some(&own) {
            drawn.push(own);
        }
    }
    let size = [scene.footage.width as u32, scene.footage.height as u32];
    let paper = tone(truth.parts.len());
    let shape = |(k, contour): (usize, &Vec<Point>)| {
        let mut outline = Outline::closed(contour.clone());
        // A contour is dense, so it needs no curve.
        outline.corners.fill(true);
        Shape::new(outline, tone(k))
    };
    Ok(drawn.into_iter().map(|own| Picture { shapes: own.into_iter().map(shape).collect(), paper, size }).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;
    use crate::sample::character::PARTS;

    #[test]
    fn a_character_has_a_drawing_for_each_of_its_drawings_and_a_colour_for_each_part() {
        let folder = tempfile::tempdir().unwrap();
        sample::write(folder.path()).unwrap();
        let drawn = drawings(folder.path()).unwrap();
        assert_eq!(drawn.len(), sample::FRAMES / sample::HOLD, "held drawings come once");
        for drawing in &drawn {
            assert_eq!((drawing.size, drawing.shapes.len()), ([sample::WIDTH, sample::HEIGHT], PARTS.len()));
        }
        let mut colours: Vec<u32> = drawn[0].shapes.iter().map(|shape| shape.colour).collect();
        assert_eq!(colours, drawn[5].shapes.iter().map(|shape| shape.colour).collect::<Vec<_>>());
        colours.sort_unstable();
        colours.dedup();
        assert_eq!(colours.len(), PARTS.len());
    }

    #[test]
    fn a_folder_without_a_character_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = format!("{:#}", drawings(folder.path()).unwrap_err());
        assert!(error.contains("project.json"), "{error}");
    }
}
