//! What is in front of what on each frame: marks "in front" and "behind" change the drawing's order ([`crate::reshape::depth`]).
//!
//! Who goes with whom is known from the limbs. A hand goes with its arm: a part of a leg or limb takes along what is carried farther out
//! on the same chain, and what a limb of its own carries without being drawn on it, such as a shoe. A part also takes along what follows
//! it, such as the eye of a head.
//!
//! Where marks let a part pass others that they do not name, that is said.

use super::bodies::Body;
use super::{Given, PipelineError, wrong};
use crate::pipeline::report::runs;
use crate::reshape::depth::{DepthError, Kin, Mark, changed, infer};
use crate::scene::limbs::{DepthMark, Follow, LimbSet};
use crate::scene::{FrameNumber, Part};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

/// Depths are written to a millionth.
const SCALE: f64 = 1e6;

/// The depths of a result.
pub(super) struct Depths {
    /// By part and frame.
    pub by_part: Vec<Vec<f64>>,
    /// In words, which parts that no mark names changed places.
    pub said: Vec<String>,
}

/// The depths of all parts on the frames.
pub(super) fn of(
    set: &LimbSet,
    parts: &[Part],
    bodies: &[Body],
    frames: RangeInclusive<FrameNumber>,
) -> Result<Depths, PipelineError> {
    let marks = marks(set, parts);
    let own: Vec<f64> = parts.iter().map(|part| part.depth).collect();
    let kin = kin(set, parts, bodies);
    let infer = |frame| infer(&own, &marks, &kin, frame).map_err(|error| wrong(failed(&error, set)));
    let by_frame = frames.clone().map(infer).collect::<Result<Vec<_>, _>>()?;
    let rounded = |d: f64| (d * SCALE).round() / SCALE;
    let written = |k: usize, depth: f64| if depth == own[k] { depth } else { rounded(depth) };
    let by_part = (0..parts.len()).map(|k| by_frame.iter().map(|all| written(k, all[k])).collect()).collect();
    let mut passed: BTreeMap<(usize, usize), Vec<FrameNumber>> = BTreeMap::new();
    for (frame, found) in frames.zip(&by_frame) {
        for pair in changed(&own, found, &marks, frame) {
            passed.entry(pair).or_default().push(frame);
        }
    }
    Ok(Depths { by_part, said: said(&passed, parts) })
}

/// Marks of the document that contradict each other on a frame of a footage, in words.
pub(in crate::pipeline) fn contradiction(
    set: &LimbSet,
    parts: &[Part],
    footage: RangeInclusive<FrameNumber>,
) -> Option<String> {
    let marks = marks(set, parts);
    let own: Vec<f64> = parts.iter().map(|part| part.depth).collect();
    let kin = Kin { with: vec![Vec::new(); parts.len()], body: vec![false; parts.len()] };
    // Marks come together on the first frame of the last one of them.
    let begins: BTreeSet<FrameNumber> = marks.iter().map(|mark| mark.first.max(*footage.start())).collect();
    let frames = begins.into_iter().filter(|frame| footage.contains(frame));
    frames.filter_map(|frame| infer(&own, &marks, &kin, frame).err()).next().map(|error| failed(&error, set))
}

/// The marks of a document, with indices of parts.
fn marks(set: &LimbSet, parts: &[Part]) -> Vec<Mark> {
    let index = |name: &str| parts.iter().position(|part| part.name == name).unwrap_or(usize::MAX);
    let mark = |m: &DepthMark| Mark { front: index(&m.front), behind: index(&m.behind), first: m.first, last: m.last };
    set.marks.iter().map(mark).collect()
}

/// The failure of an order. Marks are named as the document has them.
fn failed(error: &DepthError, set: &LimbSet) -> String {
    let named =
        |k: &usize| format!("depth_marks[{k}] ({:?} in front of {:?})", set.marks[*k].front, set.marks[*k].behind);
    match error {
        DepthError::Contradiction { frame, marks } => {
            let list: Vec<String> = marks.iter().map(named).collect();
            format!("frame {frame}: found marks that contradict each other: {}", list.join(", "))
        }
        other => format!("depth_marks: {other}"),
    }
}

/// What pairs in another order are called, one line for each part in front and its frames.
fn said(passed: &BTreeMap<(usize, usize), Vec<FrameNumber>>, parts: &[Part]) -> Vec<String> {
    let mut lines: BTreeMap<(usize, &[FrameNumber]), Vec<String>> = BTreeMap::new();
    for ((front, behind), frames) in passed {
        lines.entry((*front, frames)).or_default().push(format!("{:?}", parts[*behind].name));
    }
    let line = |((front, frames), behind): ((usize, &[FrameNumber]), Vec<String>)| {
        let (front, behind) = (&parts[front].name, behind.join(", "));
        format!("depth marks: {front:?} is in front of {behind} too on {}", runs(frames))
    };
    lines.into_iter().map(line).collect()
}

/// Which parts go with which, and which are of the body.
fn kin(set: &LimbSet, parts: &[Part], bodies: &[Body]) -> Kin {
    let chains = set.template.hanging();
    // By part its chain and how far out on it; none for the body. What is drawn on the limb is before what it only carries.
    let place = |part: &Part| -> Option<(usize, usize, bool)> {
        let carriers = set.limbs.iter().filter(|limb| limb.carries.iter().any(|carried| carried.part == part.name));
        let on = |limb: &crate::scene::limbs::Limb| {
            let chain = chains.iter().position(|chain| chain.contains(&limb.to))?;
            let drawn = [&limb.start, &limb.end].iter().any(|end| end.points.iter().any(|p| p.part == part.name));
            Some((chain, chains[chain].iter().position(|k| *k == limb.to)?, !drawn))
        };
        let places: Option<Vec<(usize, usize, bool)>> = carriers.map(on).collect();
        let places = places.filter(|all| all.iter().all(|(chain, ..)| *chain == all[0].0))?;
        let drawn = places.iter().any(|(_, _, carried)| !carried);
        places.into_iter().map(|(chain, out, _)| (chain, out, !drawn)).min()
    };
    let places: Vec<Option<(usize, usize, bool)>> = parts.iter().map(place).collect();
    let hosts: Vec<Option<&str>> = parts.iter().map(|part| host(set, bodies, &part.name)).collect();
    let goes_with = |k: usize, part: usize| {
        let outward = places[part].zip(places[k]).is_some_and(|(a, b)| a.0 == b.0 && (b.1, b.2) > (a.1, a.2));
        k != part && (outward || hosts[k] == Some(&parts[part].name))
    };
    let with = (0..parts.len()).map(|part| (0..parts.len()).filter(|&k| goes_with(k, part)).collect()).collect();
    Kin { with, body: places.iter().map(Option::is_none).collect() }
}

/// The part that a part follows, as the document says it or as it was found.
fn host<'a>(set: &'a LimbSet, bodies: &'a [Body], name: &str) -> Option<&'a str> {
    let told = set.follows.iter().find(|(part, _)| part == name);
    if let Some((_, follow)) = told {
        return match follow {
            Follow::Part(of) => Some(of),
            _ => None,
        };
    }
    match bodies.iter().find(|body| body.name == name)?.follows.as_ref()? {
        Given::Part(of) => Some(of),
        _ => None,
    }
}
