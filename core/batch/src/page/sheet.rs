//! The contact sheet of a shot: small pictures of its worst frames, of its first and of its last, with the contours over
//! them.
//!
//! The pictures are JPEG files in the folder `.sheet` of the shot. The page takes them in, so the page of 200 shots has
//! some 10 MB.

use crate::findings::Findings;
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder};
use rototoon::image::resize::resize;
use rototoon::project::{Document, WriteError, write_whole};
use rototoon::render::{OverlayOptions, overlay};
use rototoon::scene::{Colour, FrameNumber, FrameSource, Raster};
use rototoon::{memory, pictures, pipeline};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Folder of the pictures.
pub const SHEET: &str = ".sheet";
/// Number of pictures.
const PICTURES: usize = 8;
/// Greatest width and height of a picture in pixels.
const SIZE: usize = 320;
/// Quality of the JPEG files, of 100.
const QUALITY: u8 = 82;
/// Bytes for each pixel of a frame while its picture is drawn.
const BYTES: u64 = 70;
/// Width of the contours in pixels of the small picture.
const LINE: f64 = 1.6;

/// Writes the pictures of a document in `folder` to the folder of a shot. Those of frames that cannot be read are hatched.
///
/// # Errors
///
/// A picture cannot be written.
pub fn write(
    document: &Document,
    folder: &Path,
    findings: &Findings,
    shot: &Path,
    threads: usize,
) -> Result<(), WriteError> {
    let sheet = shot.join(SHEET);
    let failed = |source| WriteError { path: sheet.clone(), source };
    // Files with other names are somebody else's.
    for (_, path) in read(shot) {
        fs::remove_file(&path).map_err(|source| WriteError { path: path.clone(), source })?;
    }
    fs::create_dir_all(&sheet).map_err(failed)?;
    let footage = &document.scene.footage;
    let pixels = (footage.width as u64).saturating_mul(footage.height as u64);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let (Ok(pool), true) = (pool, memory::ask(pixels.saturating_mul(BYTES)).is_ok()) else { return Ok(()) };
    let Ok(frames) = pictures::Sequence::keeping(footage, folder, 0) else { return Ok(()) };
    for frame in chosen(footage.first, footage.last, findings) {
        if let Some(bytes) = pool.install(|| picture(document, &frames, frame)) {
            write_whole(&sheet.join(format!("{frame}.jpg")), &bytes)?;
        }
    }
    Ok(())
}

/// The frames of a shot's pictures in the order of time, with their files.
pub fn read(shot: &Path) -> Vec<(FrameNumber, PathBuf)> {
    let Ok(entries) = fs::read_dir(shot.join(SHEET)) else { return Vec::new() };
    let frame = |path: &Path| path.file_name()?.to_str()?.strip_suffix(".jpg")?.parse::<FrameNumber>().ok();
    let mut found: Vec<_> = entries.flatten().filter_map(|entry| Some((frame(&entry.path())?, entry.path()))).collect();
    found.sort();
    found
}

/// The first and the last frame, those where a key is wanted, the weakest ones, and some between to fill the sheet.
fn chosen(first: FrameNumber, last: FrameNumber, findings: &Findings) -> Vec<FrameNumber> {
    let mut weak: Vec<_> = findings.least.iter().collect();
    weak.sort_by(|a, b| a.1.total_cmp(b.1));
    let wanted = findings.wanted.iter().map(|key| key.frame);
    // Half of the sheet is for the weak frames, and the rest shows the shot.
    let bad = wanted.chain(weak.into_iter().map(|(&frame, _)| frame)).filter(|frame| (first..=last).contains(frame));
    let mut chosen: BTreeSet<FrameNumber> = [first, last].into();
    for frame in bad {
        if chosen.len() >= PICTURES / 2 + 2 {
            break;
        }
        chosen.insert(frame);
    }
    let steps = PICTURES as i64;
    let (start, length) = (i64::from(first), i64::from(last) - i64::from(first));
    for step in 1..steps {
        if chosen.len() < PICTURES {
            chosen.insert((start + length * step / steps) as FrameNumber);
        }
    }
    chosen.into_iter().collect()
}

fn picture(document: &Document, frames: &pictures::Sequence, frame: FrameNumber) -> Option<Vec<u8>> {
    let (width, height) = (document.scene.footage.width, document.scene.footage.height);
    let scale = (SIZE as f64 / width.max(height) as f64).min(1.0);
    let small = |length: usize| ((length as f64 * scale).round() as usize).max(1);
    let Ok(below) = frames.picture(frame) else {
        return jpeg(&pipeline::no_picture(small(width), small(height)));
    };
    let options = OverlayOptions { line_width: LINE / scale, points: false, confidence: true };
    let drawn = overlay(&document.scene, frame, &below, None, &options);
    jpeg(&resize(&drawn, small(width), small(height)))
}

fn jpeg(picture: &Raster<Colour>) -> Option<Vec<u8>> {
    let bytes: Vec<u8> =
        picture.data().iter().flatten().map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8).collect();
    let (width, height) = (u32::try_from(picture.width()).ok()?, u32::try_from(picture.height()).ok()?);
    let mut out = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut out, QUALITY);
    encoder.write_image(&bytes, width, height, ExtendedColorType::Rgb8).ok().map(|()| out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::WantedKey;

    #[test]
    fn the_sheet_shows_the_worst_frames_and_the_course_of_the_shot() {
        let key = |frame| WantedKey { frame, ..WantedKey::default() };
        let least = (0..100).map(|frame| (frame, if frame == 33 { 0.1 } else { 0.9 })).collect();
        let findings = Findings { wanted: vec![key(71), key(999)], least, ..Findings::default() };
        let frames = chosen(0, 99, &findings);
        assert_eq!(frames.len(), PICTURES);
        assert!([0, 33, 71, 99].iter().all(|frame| frames.contains(frame)) && !frames.contains(&999), "{frames:?}");
        assert_eq!(chosen(5, 5, &Findings::default()), [5]);
        assert_eq!(chosen(i32::MIN, i32::MAX, &Findings::default()).len(), PICTURES);
    }

    #[test]
    fn a_frame_that_cannot_be_read_is_hatched() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        image::RgbImage::from_pixel(160, 90, image::Rgb([255; 3])).save(at("f_0.png")).unwrap();
        fs::create_dir(at("shot")).unwrap();
        let text = r#"{"rototoon": 1, "footage": {"pattern": "f_%d.png", "first": 0, "last": 1, "fps": 25, "width": 160, "height": 90}, "parts": []}"#;
        let document = Document::parse(text, "p").unwrap();
        write(&document, folder.path(), &Findings::default(), &at("shot"), 1).unwrap();
        let pictures = read(&at("shot"));
        let greys = pictures.iter().map(|(_, path)| image::open(path).unwrap().to_luma8());
        let [whole, hatched] = &greys.collect::<Vec<_>>()[..] else { panic!("{pictures:?}") };
        assert_eq!((whole.dimensions(), hatched.dimensions()), ((160, 90), (160, 90)));
        let light = |picture: &image::GrayImage| picture.pixels().filter(|pixel| pixel.0[0] > 200).count();
        assert_eq!(light(whole), 160 * 90);
        assert!((200..160 * 9).contains(&light(hatched)), "words on stripes: {}", light(hatched));
    }

    #[test]
    fn pictures_are_found_in_the_order_of_time() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join(SHEET)).unwrap();
        for name in ["10.jpg", "9.jpg", "-3.jpg", "x.jpg"] {
            fs::write(folder.path().join(SHEET).join(name), "").unwrap();
        }
        let frames: Vec<_> = read(folder.path()).into_iter().map(|(frame, _)| frame).collect();
        assert_eq!(frames, [-3, 9, 10]);
    }
}
