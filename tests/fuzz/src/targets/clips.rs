//! Files of skeleton clips, and of drawn key poses.

use crate::given;
use rototoon::project::clips::{Clips, parse_key_poses};

/// Reads clips and key poses. Clips that were read must be written so that they can be read again.
pub fn clips(data: &[u8]) {
    let text = given::text(data, "{", |u| Ok(given::clips::clips(u, 4, 3)?.text()));
    let _ = parse_key_poses(&text, "fuzz");
    let Ok(read) = Clips::parse(&text, "fuzz") else { return };
    let written = read.text();
    let again = Clips::parse(&written, "again").unwrap_or_else(|error| panic!("written, but not readable: {error}"));
    assert_eq!(again.clips.len(), read.clips.len());
    for (before, after) in read.clips.iter().zip(&again.clips) {
        assert_eq!((&before.character, &before.motion), (&after.character, &after.motion));
        let pairs = before.postures.iter().flatten().zip(after.postures.iter().flatten());
        // Numbers are written with six decimals, and large ones with all of their digits.
        let off = |a: f64, b: f64| (a - b).abs() <= 1e-6 + 1e-15 * a.abs();
        assert!(pairs.clone().all(|(a, b)| off(a.x, b.x) && off(a.y, b.y)), "a point moved");
        assert_eq!(before.postures.len(), after.postures.len());
    }
}
