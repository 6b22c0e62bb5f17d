//! Synthetic footage of any size for measuring speed and memory: a crowd of limbs that swing and cross, with exact truth.
//!
//! The sample cartoon ([`crate::sample`]) shows how good tracking is. Here the numbers of frames, parts, points and pixels
//! can be set one by one. Each part is a bent limb with an outline, of one colour with a band of another colour. The parts
//! are in rows, overlap their neighbours, swing by up to 35° and drift. The footage is drawn on twos. The motion from
//! drawing to drawing does not depend on the length of the footage.

use crate::sample::ink::Canvas;
use crate::sample::outline::Outline;
use crate::sample::truth;
use anyhow::{Context, Result};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use rototoon::geometry::Point;
use rototoon::project::Document;
use rototoon::scene::{Colour, Footage, FrameError, FrameNumber, FrameSource, Part, Raster, Scene, palette};
use serde_json::{Map, Value, json};
use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;
use tiny_skia::{Color, Pixmap};

/// Number of frames that each drawing is held.
const HOLD: usize = 2;
/// Number of frames in which a limb swings out and back.
const SWING: f64 = 28.0;

/// The size of the footage and the numbers of its parts and points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Puppet {
    /// Width of a frame in pixels.
    pub width: usize,
    /// Height of a frame in pixels.
    pub height: usize,
    /// Number of frames; the first is frame 0.
    pub frames: usize,
    /// Frames from one key to the next; the last frame is a key too.
    pub step: usize,
    /// Number of parts.
    pub parts: usize,
    /// Control points of each part, at least 4.
    pub points: usize,
}

impl Puppet {
    /// The contour of a part on a frame.
    pub fn outline(&self, part: usize, frame: FrameNumber) -> Outline {
        let t = (frame.max(0) as usize / HOLD * HOLD) as f64;
        let columns = (self.parts as f64).sqrt().ceil();
        let (column, row) = ((part as f64 % columns), (part as f64 / columns).floor());
        let (w, h) = (self.width as f64, self.height as f64);
        let pitch = Point::new(0.8 * w / columns, 0.8 * h / (self.parts as f64 / columns).ceil());
        let phase = TAU * (t / SWING + part as f64 * 0.381_966);
        let drift = Point::new(0.22 * pitch.x * (0.7 * phase).sin(), 0.12 * pitch.y * phase.cos());
        let at = Point::new(0.1 * w, 0.1 * h) + pitch * Point::new(column + 0.5, row + 0.5) + drift;
        let turn = Point::from_angle(0.6 * phase.sin() + 0.5 * part as f64);
        let (long, thick) = (0.62 * pitch.max_element().min(1.6 * pitch.min_element()), 0.24 * pitch.min_element());
        let bend = 0.25 * (phase + 1.0).sin();
        let points = (0..self.points).map(|k| {
            let (y, x) = (TAU * k as f64 / self.points as f64).sin_cos();
            let limb = Point::new(long * x, thick * (1.0 - 0.3 * x) * y + bend * thick * x * x);
            at + turn.rotate(limb)
        });
        let mut outline = Outline::closed(points.collect());
        outline.ink.fill(self.ink());
        outline
    }

    fn ink(&self) -> f64 {
        (3.2 * self.height as f64 / 540.0).max(1.5)
    }

    fn outlines(&self, frame: FrameNumber) -> Vec<Outline> {
        (0..self.parts).map(|part| self.outline(part, frame)).collect()
    }

    /// The picture of a frame. Later parts are nearer. It is an error if no picture can have this size.
    pub fn picture(&self, frame: FrameNumber) -> Result<Pixmap> {
        let (w, h) = (self.width as f64, self.height as f64);
        let pixels = Pixmap::new(self.width as u32, self.height as u32);
        let mut pixels = pixels.with_context(|| format!("no picture of {w}x{h} pixels"))?;
        pixels.fill(Color::from_rgba8(214, 230, 240, 255));
        let mut canvas = Canvas { pixels };
        let ground = [(0.0, 0.7), (0.4, 0.62), (1.0, 0.72), (1.0, 1.1), (0.0, 1.1)];
        let ground =
            Outline::closed(ground.map(|(x, y)| Point::new(x * w, y * h)).to_vec()).with_corners(&[0, 2, 3, 4]);
        canvas.fill(&ground, Color::from_rgba8(196, 214, 170, 255));
        for (part, outline) in self.outlines(frame).iter().enumerate() {
            canvas.fill(outline, tone(part, 1.0));
            let n = self.points;
            let band = vec![
                outline.points[n / 4].lerp(outline.points[0], 0.2),
                outline.points[n - n / 4].lerp(outline.points[0], 0.2),
            ];
            canvas.line(&Outline::open(band), 2.5 * self.ink(), tone(part, 0.6), Some(outline));
            canvas.ink(outline, Color::from_rgba8(38, 26, 34, 255));
        }
        Ok(canvas.pixels)
    }

    /// The scene with the artist's keys only. Its frames are in `frames/`.
    pub fn scene(&self) -> Scene {
        let last = self.frames.saturating_sub(1) as FrameNumber;
        let keys: Vec<FrameNumber> = (0..last).step_by(self.step.max(1)).chain([last]).collect();
        let part = |k: usize| Part {
            name: format!("limb {k}"),
            closed: true,
            depth: k as f64,
            keys: keys.iter().map(|&frame| (frame, self.outline(k, frame).points)).collect(),
            ..Part::default()
        };
        let footage = Footage {
            pattern: "frames/frame_%04d.png".into(),
            first: 0,
            last,
            fps: 24.0,
            width: self.width,
            height: self.height,
            held: false,
        };
        Scene { footage, parts: (0..self.parts).map(part).collect() }
    }

    /// Writes `frames/frame_0000.png` and so on, `project.json` (key frames only) and `truth.json` into `folder`, and makes
    /// the folder if needed.
    pub fn write(&self, folder: &Path) -> Result<()> {
        std::fs::create_dir_all(folder.join("frames")).with_context(|| format!("cannot make the folder {folder:?}"))?;
        let drawings = self.frames.div_ceil(HOLD);
        let scored = (0..drawings).into_par_iter().map(|drawing| {
            let first = HOLD * drawing;
            let picture = self.picture(first as FrameNumber)?;
            let png = picture.encode_png()?;
            for frame in first..(first + HOLD).min(self.frames) {
                write_file(&folder.join(format!("frames/frame_{frame:04}.png")), &png)?;
            }
            Ok(truth::scored(&self.outlines(first as FrameNumber), &picture))
        });
        let scored = scored.collect::<Result<Vec<_>>>()?;
        write_file(&folder.join("project.json"), Document::new(self.scene()).to_json().as_bytes())?;
        write_file(&folder.join("truth.json"), self.truth(&scored).to_string().as_bytes())
    }

    /// The truth document. `scored` is indexed by drawing, part and point.
    fn truth(&self, scored: &[Vec<Vec<bool>>]) -> Value {
        let parts = (0..self.parts).map(|part| {
            let every = |value: &dyn Fn(&Outline, usize) -> Value| -> Value {
                let of = |frame: usize| value(&self.outline(part, frame as FrameNumber), frame / HOLD);
                (0..self.frames).map(|frame| (frame.to_string(), of(frame))).collect::<Map<_, _>>().into()
            };
            let marks = |list: &[bool]| list.iter().map(|&s| if s { '1' } else { '0' }).collect::<String>();
            json!({
                "name": format!("limb {part}"),
                "points": every(&|outline, _| json!(outline.points)),
                "contour": every(&|outline, _| json!(outline.line())),
                "scored": every(&|_, drawing| marks(&scored[drawing][part]).into()),
            })
        });
        json!({"parts": parts.collect::<Vec<_>>()})
    }

    /// All pictures in memory, for the tracker.
    pub fn pictures(&self) -> Result<Pictures> {
        let drawings = (0..self.frames.div_ceil(HOLD)).into_par_iter();
        let drawn = drawings.map(|drawing| Ok(Arc::new(raster(&self.picture((HOLD * drawing) as FrameNumber)?))));
        Ok(Pictures { drawings: drawn.collect::<Result<_>>()?, last: self.frames as FrameNumber - 1 })
    }
}

fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    std::fs::write(path, bytes).with_context(|| format!("cannot write {path:?}"))
}

/// The colour of a part, times a factor.
fn tone(part: usize, light: f32) -> Color {
    let [r, g, b] = palette::distinct(part).map(|c| (0.15 + 0.85 * c) * light);
    Color::from_rgba(r, g, b, 1.0).unwrap_or(Color::BLACK)
}

/// Converts an opaque picture to the form in which the core reads pictures from files.
fn raster(picture: &Pixmap) -> Raster<Colour> {
    let width = picture.width() as usize;
    Raster::from_fn(width, picture.height() as usize, |x, y| {
        let c = picture.pixels()[y * width + x];
        [c.red(), c.green(), c.blue()].map(|v| f32::from(v) / 255.0)
    })
}

/// Footage in memory.
#[derive(Clone, Debug)]
pub struct Pictures {
    drawings: Vec<Arc<Raster<Colour>>>,
    last: FrameNumber,
}

impl FrameSource for Pictures {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        let found = usize::try_from(frame).ok().and_then(|f| self.drawings.get(f / HOLD));
        found.cloned().ok_or(FrameError::Outside { frame, first: 0, last: self.last })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::Truth;
    use rototoon::pictures::Sequence;

    const SMALL: Puppet = Puppet { width: 120, height: 90, frames: 5, step: 2, parts: 3, points: 8 };

    #[test]
    fn files_and_memory_have_the_same_pictures() {
        let folder = tempfile::tempdir().unwrap();
        SMALL.write(folder.path()).unwrap();
        let document = Document::load(&folder.path().join("project.json")).unwrap();
        assert_eq!(document.scene.parts.len(), 3);
        assert_eq!(document.scene.parts[0].keys.keys().collect::<Vec<_>>(), [&0, &2, &4]);
        let truth = Truth::load(&folder.path().join("truth.json")).unwrap();
        for (part, truth) in document.scene.parts.iter().zip(&truth.parts) {
            assert_eq!(part.name, truth.name);
            assert!(part.keys.iter().all(|(frame, key)| key == &truth.points[frame]), "keys are the truth");
            assert_eq!(truth.scored.len(), 5);
        }
        let files = Sequence::new(&document.scene.footage, folder.path()).unwrap();
        let memory = SMALL.pictures().unwrap();
        for frame in 0..5 {
            let (file, own) = (files.picture(frame).unwrap(), memory.picture(frame).unwrap());
            let near = |a: &Colour, b: &Colour| (0..3).all(|c| (a[c] - b[c]).abs() < 1e-6);
            assert!(file.data().iter().zip(own.data()).all(|(a, b)| near(a, b)), "frame {frame}");
        }
        let picture = |frame| memory.picture(frame).unwrap();
        assert!(picture(0) == picture(1) && picture(1) != picture(2));
        assert!(memory.picture(-1).is_err() && memory.picture(6).is_err());
    }

    #[test]
    fn most_points_are_visible() {
        let folder = tempfile::tempdir().unwrap();
        let puppet = Puppet { width: 320, height: 240, frames: 6, step: 5, parts: 12, points: 16 };
        puppet.write(folder.path()).unwrap();
        let truth = Truth::load(&folder.path().join("truth.json")).unwrap();
        let all = truth.parts.iter().flat_map(|part| part.scored.values().flat_map(|marks| marks.bytes()));
        let seen = all.clone().filter(|&mark| mark == b'1').count() as f64 / all.count() as f64;
        assert!((0.6..0.99).contains(&seen), "{seen}");
    }
}
