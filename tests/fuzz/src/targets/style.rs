//! Style: decoded clips, translated by every method.

use crate::given::clips::{CHARACTERS, MOTIONS, clips, posture};
use crate::given::number;
use arbitrary::{Result, Unstructured};
use rototoon::pipeline;
use rototoon::scene::Silent;
use rototoon::style::{KeyPose, Options, Pace, Preset, Request};

/// Translates a clip.
pub fn style(data: &[u8]) {
    let _ = decoded(&mut Unstructured::new(data));
}

fn decoded(u: &mut Unstructured) -> Result<()> {
    let options = options(u)?;
    let (style, content, motion) = (*u.choose(&CHARACTERS)?, *u.choose(&CHARACTERS)?, *u.choose(&MOTIONS)?);
    let mut keys = Vec::new();
    if u.ratio(1u8, 4)? {
        for _ in 0..u.int_in_range(1..=2u8)? {
            let frame = if u.ratio(1u8, 8)? { u.arbitrary()? } else { u.int_in_range(0..=3usize)? };
            keys.push(KeyPose { frame, posture: posture(u)? });
        }
    }
    let known = clips(u, 7, 4)?;
    let request = Request { style, motion, content, keys: &keys };
    if let Ok(made) = pipeline::translate(&known, &request, &options, &Silent) {
        assert_eq!(made.clips.len(), 1);
        let _ = made.text();
    }
    Ok(())
}

fn options(u: &mut Unstructured) -> Result<Options> {
    let mut options = Options { preset: u.choose(&Preset::ALL)?.2, ..Options::default() };
    if u.arbitrary()? {
        options.pace = Pace::Style;
    }
    if u.ratio(1u8, 4)? {
        options.strength = number(u)?;
    }
    if u.ratio(1u8, 4)? {
        options.rank = Some(if u.ratio(1u8, 8)? { u.int_in_range(0..=64)? } else { u.int_in_range(0..=6)? });
    }
    (options.keep_lengths, options.keep_contacts) = (u.arbitrary()?, u.arbitrary()?);
    Ok(options)
}
