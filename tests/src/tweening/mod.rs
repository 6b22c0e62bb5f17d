//! Measures matching and in-betweens on sets with known truth.
//!
//! - [`between`]: compares in-betweens with the true frames
//! - [`breakdowns`]: what true drawings between the keys gain
//! - [`drawings`]: in-betweens of whole line drawings, each traced for itself
//! - [`fragments`]: in-betweens of contours that are cut into pieces in other places on each key
//! - [`ink`]: distances between drawn and true ink
//! - [`matching`]: matches strokes that are drawn in another way
//! - [`sheet`]: draws in-betweens over the truth

pub mod between;
pub mod breakdowns;
pub mod drawings;
pub mod fragments;
pub mod ink;
pub mod matching;
pub mod sheet;

use crate::truth::{TruePart, Truth};
use anyhow::{Context, Result};
use rototoon::geometry::{Point, polygon};
use rototoon::pipeline;
use rototoon::scene::{Footage, Silent};
use rototoon::track::TrackOptions;
use rototoon::tween::between::Captured;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Distances between two keys that are measured, in frames.
pub const GAPS: std::ops::RangeInclusive<i32> = 6..=14;

/// Distances inside a contour at which its paint is read, in pixels. The first one avoids the ink. The others are tried if
/// nothing is visible there.
const INSETS: [f64; 3] = [5.0, 3.0, 1.5];

/// The contours of a set as strokes on every frame.
#[derive(Clone, Debug)]
pub struct Set {
    /// Name of its folder.
    pub name: String,
    /// The contours in the truth's order.
    pub parts: Vec<Contours>,
    /// First and last frame.
    pub frames: (i32, i32),
    /// Its folder.
    pub folder: PathBuf,
    /// Its pictures.
    pub footage: Footage,
    /// Frames on which the project has keys.
    pub keys: Vec<i32>,
    /// The parts as tracked from the project's keys; empty before [`Set::capture`].
    pub captured: Arc<[Captured]>,
}

/// One contour by frame. It has the same number of points on all frames, and a point keeps its index.
#[derive(Clone, Debug)]
pub struct Contours {
    /// Name of the part.
    pub name: String,
    /// Whether it is closed.
    pub closed: bool,
    /// Larger is nearer to the viewer.
    pub depth: f64,
    /// Points by frame.
    pub points: BTreeMap<i32, Vec<Point>>,
}

impl Set {
    /// Reads the contours from `truth.json` of a folder. The folder's `project.json` gives depths and closed parts.
    pub fn load(folder: &Path) -> Result<Self> {
        let truth = Truth::load(&folder.join("truth.json"))?;
        let project = rototoon::project::Document::load(&folder.join("project.json"))?;
        let known: BTreeMap<_, _> =
            project.scene.parts.iter().map(|p| (p.name.as_str(), (p.closed, p.depth))).collect();
        let of = |part: &TruePart| known.get(part.name.as_str()).copied().unwrap_or((true, 0.0));
        let parts: Vec<Contours> = truth
            .parts
            .iter()
            .map(|part| Contours {
                name: part.name.clone(),
                closed: of(part).0,
                depth: of(part).1,
                points: even(part).clone(),
            })
            .collect();
        let frames = parts.iter().flat_map(|part| part.points.keys().copied());
        let frames = (frames.clone().min().context("found no frames")?, frames.max().context("found no frames")?);
        let name = folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let (folder, footage) = (folder.to_owned(), project.scene.footage.clone());
        let mut keys: Vec<i32> = project.scene.parts.iter().flat_map(|part| part.keys.keys().copied()).collect();
        keys.sort_unstable();
        keys.dedup();
        Ok(Self { name, parts, frames, folder, footage, keys, captured: Arc::default() })
    }

    /// Tracks the parts of the project in `folder`, for in-betweens that follow them.
    pub fn capture(&mut self, folder: &Path) -> Result<()> {
        let mut document = rototoon::project::Document::load(&folder.join("project.json"))?;
        pipeline::track(&mut document, folder, &TrackOptions::default(), &Silent)?;
        self.captured = pipeline::captured(&document.scene);
        Ok(())
    }

    /// The paint of each part, as it appears on most frames. It is read just inside the contour, where no nearer part covers
    /// it. Of these colours it is the one that is nearest to all others.
    pub fn paints(&self) -> Result<Vec<Option<[f32; 3]>>> {
        let mut seen = vec![Vec::new(); self.parts.len()];
        for frame in self.frames.0..=self.frames.1 {
            let path = self.folder.join(crate::sheet::frame_path(&self.footage.pattern, frame));
            let picture = image::open(&path).with_context(|| format!("cannot read {path:?}"))?.into_rgb8();
            for (part, seen) in self.parts.iter().zip(&mut seen) {
                seen.extend(self.paint(part, frame, &picture));
            }
        }
        Ok(seen.iter().map(|colours| commonest(colours)).collect())
    }

    fn paint(&self, part: &Contours, frame: i32, picture: &image::RgbImage) -> Option<[f32; 3]> {
        let points = part.points.get(&frame)?;
        let covers = |other: &&Contours| other.depth > part.depth && other.closed;
        let nearer: Vec<_> = self.parts.iter().filter(covers).filter_map(|other| other.points.get(&frame)).collect();
        let bare = |p: &Point| nearer.iter().all(|other| !polygon::contains(other, *p));
        let at = |depth: f64| inset(points, depth).filter(bare).filter_map(|p| pixel(picture, p)).collect::<Vec<_>>();
        INSETS.into_iter().map(at).find_map(|colours| commonest(&colours))
    }

    /// Pairs of frames at the distances of [`GAPS`]. A shorter set gives its first and last frame.
    pub fn spans(&self) -> Vec<(i32, i32)> {
        let (first, last) = self.frames;
        if last - first < *GAPS.start() {
            return vec![(first, last)];
        }
        let from = |a: i32| GAPS.map(move |gap| (a, a + gap)).filter(|&(_, b)| b <= last);
        (first..=last).flat_map(from).collect()
    }
}

/// The colour that is nearest to all the others.
fn commonest(colours: &[[f32; 3]]) -> Option<[f32; 3]> {
    let apart = |a: &[f32; 3], b: &[f32; 3]| (0..3).map(|c| (a[c] - b[c]).abs()).sum::<f32>();
    let among = |a: &[f32; 3]| colours.iter().map(|b| apart(a, b)).sum::<f32>();
    colours.iter().min_by(|a, b| among(a).total_cmp(&among(b))).copied()
}

/// Points inside a polygon, near its vertices.
fn inset(points: &[Point], depth: f64) -> impl Iterator<Item = Point> {
    let side = polygon::signed_area(points).signum() * depth;
    let n = points.len();
    let at =
        move |i: usize| points[i] + (points[(i + 1) % n] - points[(i + n - 1) % n]).perp().normalize_or_zero() * side;
    (0..n).map(at).filter(|p| polygon::contains(points, *p))
}

fn pixel(picture: &image::RgbImage, p: Point) -> Option<[f32; 3]> {
    let (x, y) = (p.x.floor(), p.y.floor());
    let inside = x >= 0.0 && y >= 0.0 && x < f64::from(picture.width()) && y < f64::from(picture.height());
    inside.then(|| picture.get_pixel(x as u32, y as u32).0.map(|c| f32::from(c) / 255.0))
}

/// The dense contour if it has the same number of points on every frame, or else the control points.
fn even(part: &TruePart) -> &BTreeMap<i32, Vec<Point>> {
    let mut counts = part.contour.values().map(Vec::len);
    let first = counts.next();
    if counts.all(|count| Some(count) == first) { &part.contour } else { &part.points }
}
