//! Puts the result of reshaping into the document.
//!
//! Parts get keys on the first and the last frame of the clip, and tracks on all frames between. Strokes become
//! in-betweens. Depths that differ from the part's depth are stored by frame.

use super::bodies::{Body, Moved};
use super::lines::LooseLine;
use crate::geometry::Point;
use crate::project::Document;
use crate::project::drawings::{DrawnBetween, DrawnStroke};
use crate::scene::{Footage, FrameNumber, Part};
use std::collections::BTreeMap;

/// Points on every frame, by number of the stroke or open contour (contours after all strokes).
type Lines = BTreeMap<usize, Vec<Vec<Point>>>;

/// Puts the complete result into the document. `bodies` and `moved` have the same order. `loose` are the lines that go
/// with no body, with their points on every frame. `strokes` are those of the
/// drawing on its frame at rest. `depths` are by part and frame of `footage`, which becomes the document's footage.
pub(super) fn store(
    document: &mut Document,
    footage: Footage,
    (bodies, moved): (&[Body], &[Moved]),
    loose: &[(LooseLine, Vec<Vec<Point>>)],
    (strokes, rest): (&[DrawnStroke], FrameNumber),
    depths: &[Vec<f64>],
) {
    let frames: Vec<FrameNumber> = (footage.first..=footage.last).collect();
    let parts = &mut document.scene.parts;
    let open: Vec<usize> = (0..parts.len()).filter(|&k| !parts[k].closed).collect();
    let mut lines = Lines::new();
    for (body, moved) in bodies.iter().zip(moved) {
        put_body(&mut parts[body.part], body, moved, &frames, &mut lines);
    }
    lines.extend(loose.iter().map(|(line, of_frames)| (line.number, of_frames.clone())));
    for (number, of_frames) in lines.range(strokes.len()..) {
        put_line(&mut parts[open[number - strokes.len()]], rest, &frames, of_frames);
    }
    for (part, depths) in parts.iter_mut().zip(depths) {
        // The part's own depth stays the artist's, from which the drawing may be reshaped again.
        let other = frames.iter().zip(depths).filter(|(_, depth)| **depth != part.depth);
        part.depths = other.map(|(frame, depth)| (*frame, *depth)).collect();
    }
    if !strokes.is_empty() {
        document.set_in_betweens(Vec::new(), &drawn(strokes, &lines, &frames));
    }
    document.scene.footage = footage;
}

/// Sets a part's tracks and snapped paths. The strokes on it are added to `lines`.
fn put_body(part: &mut Part, body: &Body, moved: &Moved, frames: &[FrameNumber], lines: &mut Lines) {
    let mut tracks = BTreeMap::new();
    part.curves.clear();
    for (&frame, points) in frames.iter().zip(&moved.frames) {
        let mut rest = points.as_slice();
        let mut take = |count: usize| {
            let (taken, left) = rest.split_at(count);
            rest = left;
            taken.to_vec()
        };
        tracks.insert(frame, take(body.count));
        if !body.paths.is_empty() {
            part.curves.insert(frame, body.paths.iter().map(|&length| take(length)).collect());
        }
        for &(number, length) in &body.strokes {
            lines.entry(number).or_default().push(take(length));
        }
    }
    set_tracks(part, tracks);
}

/// Sets the tracks and the snapped paths of an open contour. Its points on a frame are followed by those of the paths that it has at
/// rest.
fn put_line(part: &mut Part, rest: FrameNumber, frames: &[FrameNumber], of_frames: &[Vec<Point>]) {
    let lengths: Vec<usize> = part.complete_curves(rest).into_iter().flatten().map(Vec::len).collect();
    part.curves.clear();
    let mut tracks = BTreeMap::new();
    for (&frame, points) in frames.iter().zip(of_frames) {
        let (own, mut left) = points.split_at(points.len() - lengths.iter().sum::<usize>());
        tracks.insert(frame, own.to_vec());
        let path = |&length: &usize| {
            let (path, after) = left.split_at(length);
            left = after;
            path.to_vec()
        };
        let paths: Vec<Vec<Point>> = lengths.iter().map(path).collect();
        if !paths.is_empty() {
            part.curves.insert(frame, paths);
        }
    }
    set_tracks(part, tracks);
}

/// The strokes on every frame.
fn drawn(strokes: &[DrawnStroke], lines: &Lines, frames: &[FrameNumber]) -> Vec<DrawnBetween> {
    let stroke = |k: usize, number: usize| {
        let points = lines.get(&number)?.get(k)?.clone();
        Some((number, 1.0, DrawnStroke { points, peg: None, ..strokes[number].clone() }))
    };
    let on = |(k, &frame): (usize, &FrameNumber)| DrawnBetween {
        frame,
        strokes: (0..strokes.len()).filter_map(|number| stroke(k, number)).collect(),
    };
    frames.iter().enumerate().map(on).collect()
}

/// Sets tracks with keys on both ends, and removes corrections to earlier tracks. Those that stay come back afterwards ([`super::kept`]).
fn set_tracks(part: &mut Part, tracks: BTreeMap<FrameNumber, Vec<Point>>) {
    let ends = [tracks.first_key_value(), tracks.last_key_value()];
    part.keys = ends.into_iter().flatten().map(|(frame, points)| (*frame, points.clone())).collect();
    part.tracks = tracks;
    part.pins.clear();
    part.centers.clear();
    part.confidence.clear();
    part.wants_key.clear();
    part.absent.clear();
}
