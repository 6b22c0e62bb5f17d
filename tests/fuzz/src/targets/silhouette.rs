//! Silhouette's shape files (fxs).

use crate::given;
use rototoon::import::{into_scene, silhouette::silhouette as import};
use rototoon::project::Document;
use rototoon::scene::Scene;

/// Reads the bytes as Silhouette shapes and puts them into a scene.
pub fn silhouette(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let footage = given::footage();
    if let Ok(found) = import(&text, &footage) {
        let mut scene = Scene { footage, parts: Vec::new() };
        // A file may show its shapes on more frames than a document can have.
        if into_scene(&mut scene, found.shapes).is_err() {
            return;
        }
        // Coordinates may be too large for a document; then it is not saved, with a message.
        let _ = Document::new(scene.clone()).problems();
        for part in &scene.parts {
            let count = part.point_count();
            assert!(part.keys.values().all(|points| points.len() == count), "keys with different numbers of points");
        }
    }
}
