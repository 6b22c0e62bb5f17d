//! Makes a track from the chosen poses of both arms. The contours are refined by their own colours, the track is cut
//! off where the part is no longer trusted, and the artist's corrections are enforced.

use super::arm::{Arm, Ground, Seen, rival};
use super::trust::{Sureness, last_trusted};
use super::{OutwardJob, OutwardTrack};
use crate::contract::error::TrackError;
use crate::contract::tracking::{Ending, TrackEnd};
use crate::rototoon::lattice::align::Aligner;
use crate::rototoon::lattice::mesh::Mesh;
use crate::rototoon::lattice::necks::Necks;
use crate::rototoon::lattice::texture::{Cover, Texture};
use crate::rototoon::propagate::Model;
use crate::rototoon::refine::{Frame, Key, Refiner};
use crate::rototoon::search::Templates;
use crate::rototoon::stage::Kit;
use crate::shared::features::working_scale;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::scene::FrameNumber;
use std::collections::BTreeMap;

/// Follows a part outward from its only key.
///
/// # Errors
///
/// The error of a picture that cannot be read, or the cancellation by the progress listener.
pub(super) fn track(kit: Kit, job: &OutwardJob) -> Result<OutwardTrack, TrackError> {
    if job.key.is_empty() || job.size.0 == 0 || job.size.1 == 0 {
        return Ok(key_alone(job));
    }
    let scale = working_scale(job.size.1);
    let width = job.size.0 as f64 / scale;
    let working = |points: &[Point]| points.iter().map(|&p| p / scale).collect::<Vec<_>>();
    let key = working(&job.key);
    let features = kit.store.features(kit.frames, job.frame)?;
    let contours = job.occluders.get(&job.frame).map_or(&[][..], Vec::as_slice);
    let cover = Cover::new(&contours.iter().map(|c| working(c)).collect::<Vec<_>>(), width);
    let mesh = Mesh::new(&key, job.closed);
    let (there, bent) = (mesh.rest.clone(), mesh.rest.clone());
    let texture = Texture::new(mesh, &features, &cover, width);
    let model = Model {
        aligner: Aligner::new(&texture.mesh),
        texture,
        cover,
        there,
        bent,
        limb: None,
        necks: Necks::default(),
    };
    let templates = Templates::new(&model, &features, &model.cover, &key, width);
    let rival = rival(&model, templates.as_ref(), &key, &features);
    let ground = Ground { kit, job, model: &model, key: &key, scale, width, templates: templates.as_ref(), rival };
    let (back, forth) = rayon::join(|| Arm::grow(&ground, -1), || Arm::grow(&ground, 1));
    let arms = [back?, forth?];
    let own = || Key { points: &key, picture: &features, cover: &model.cover };
    let refiner = Refiner::new([own(), own()], job.closed);
    let mut found = key_alone(job);
    let mut energies = Vec::new();
    for arm in &arms {
        let last = kept(arm);
        found.steps += arm.steps;
        energies.extend((0..=last).map(|d| arm.drawings[d].pool[arm.path[d]].pose.energy));
        write(&ground, arm, last, refiner.as_ref(), &mut found)?;
        found.ends.extend(end(arm, last));
    }
    found.tracks.insert(job.frame, job.key.clone());
    found.confidence.insert(job.frame, vec![1.0; job.key.len()]);
    found.cost = energies.iter().sum::<f64>() / energies.len().max(1) as f64;
    Ok(found)
}

fn key_alone(job: &OutwardJob) -> OutwardTrack {
    OutwardTrack {
        tracks: BTreeMap::from([(job.frame, job.key.clone())]),
        confidence: BTreeMap::from([(job.frame, vec![1.0; job.key.len()])]),
        ends: Vec::new(),
        steps: 0,
        cost: 0.0,
    }
}

/// Index of the last drawing of an arm that is kept.
fn kept(arm: &Arm) -> usize {
    let corrected = arm.drawings.iter().rposition(|seen| seen.correction.is_some()).unwrap_or(0);
    let trusted: Vec<bool> = arm.sure.iter().map(Sureness::trusted).collect();
    last_trusted(&trusted, corrected)
}

/// The first frame beyond the kept drawings, and the reason. None at the end of the footage.
fn end(arm: &Arm, last: usize) -> Option<TrackEnd> {
    let (beyond, reason) = arm.beyond.unwrap_or((0, Ending::Lost));
    match arm.drawings.get(last + 1) {
        // A part on its way out of the picture is not lost, though less and less of it can be trusted.
        Some(next) if reason == Ending::Left => Some(TrackEnd { frame: next.near, reason }),
        Some(next) => Some(TrackEnd { frame: next.near, reason: Ending::Lost }),
        None => arm.beyond.map(|_| TrackEnd { frame: beyond, reason }),
    }
}

/// Adds the drawings of an arm, up to the index `last`, to the track.
fn write(
    ground: &Ground,
    arm: &Arm,
    last: usize,
    refiner: Option<&Refiner>,
    found: &mut OutwardTrack,
) -> Result<(), TrackError> {
    let points: Vec<Vec<Point>> = (0..=last)
        .into_par_iter()
        .map(|d| {
            ground.kit.progress.report("Tracking", 0.0)?;
            let (seen, rough) = (&arm.drawings[d], &arm.drawings[d].pool[arm.path[d]].points);
            Ok(match refiner {
                Some(refiner) if d > 0 => refined(ground, refiner, seen, rough),
                _ => rough.clone(),
            })
        })
        .collect::<Result<_, TrackError>>()?;
    for (d, points) in points.into_iter().enumerate() {
        let seen = &arm.drawings[d];
        let frames = seen.near.min(seen.far)..=seen.near.max(seen.far);
        for frame in frames {
            let (points, sure) = on_frame(ground, (d, frame), &points, &arm.sure[d].points);
            found.tracks.insert(frame, points);
            found.confidence.insert(frame, sure);
        }
    }
    Ok(())
}

/// Control points in picture pixels and their confidence on a frame of drawing `d`, with the artist's corrections
/// enforced.
fn on_frame(
    ground: &Ground,
    (d, frame): (usize, FrameNumber),
    points: &[Point],
    sure: &[f64],
) -> (Vec<Point>, Vec<f64>) {
    // Frames held from the key get its exact points.
    let mut points: Vec<Point> =
        if d == 0 { ground.job.key.clone() } else { points.iter().map(|&p| p * ground.scale).collect() };
    let mut sure = sure.to_vec();
    if let Some(correction) = ground.job.corrections.get(&frame) {
        correction.enforce(&mut points);
        correction.pins.keys().for_each(|&j| sure[j] = 1.0);
    }
    (points, sure)
}

/// Refined control points, or the rough ones if refinement does not improve the fit of the templates.
fn refined(ground: &Ground, refiner: &Refiner, seen: &Seen, rough: &[Point]) -> Vec<Point> {
    let pins = seen.correction.as_ref().map(|c| c.pins.iter().map(|(&j, &p)| (j, p / ground.scale)).collect());
    let frame = Frame { picture: &seen.features, cover: &seen.cover, share: 0.0, pins: pins.unwrap_or_default() };
    refiner.improved(&frame, rough.to_vec())
}
