//! What is said about a result: what parts and lines were given, and what a person should know beside.

use super::bodies::{Body, Moved};
use super::lines::LooseLine;
use super::motion::Motion;
use super::{Given, Reshaped, hover, sunk};
use crate::geometry::Point;
use crate::pipeline::report::runs;
use crate::scene::{FrameNumber, Part};

/// The report about bodies that moved and lines that go with none. `first` is the frame of the clip's first posture.
pub(super) fn report(
    parts: &[Part],
    (bodies, moved): (&[Body], &[Moved]),
    loose: &[LooseLine],
    motion: &Motion,
    first: FrameNumber,
) -> Reshaped {
    let all = || bodies.iter().zip(moved);
    let rigid = all().filter(|(_, moved)| moved.rigid).map(|(body, _)| parts[body.part].name.clone());
    let given = bodies.iter().filter_map(|body| Some((body.name.clone(), body.given.clone()?)));
    let lines = loose.iter().filter_map(|line| Some((line.name.clone()?, line.given.clone()?)));
    let free = loose.iter().filter(|line| line.name.is_none());
    let strokes: Vec<(usize, Given)> = free.filter_map(|line| Some((line.number, line.given.clone()?))).collect();
    let points = all().filter(|(body, _)| body.more > 0).map(|(body, moved)| {
        let tail = |points: &Vec<Point>| points[points.len() - body.more..].to_vec();
        (body.name.clone(), moved.frames.iter().map(tail).collect())
    });
    let mut notes = sunk::notes((bodies, moved), parts, motion, first);
    notes.extend(hover::notes((bodies, moved), motion));
    notes.extend(of_strokes(&strokes));
    Reshaped {
        given: given.chain(lines).collect(),
        strokes,
        rigid: rigid.collect(),
        still: motion.still.clone(),
        mirrored: motion.mirrored,
        sides: motion.sides,
        notes,
        remarks: Vec::new(),
        points: points.collect(),
    }
}

/// Says which strokes lie on no part.
fn of_strokes(free: &[(usize, Given)]) -> Vec<String> {
    let mut by_given: Vec<(&Given, Vec<FrameNumber>)> = Vec::new();
    for (number, given) in free {
        let number = FrameNumber::try_from(*number).unwrap_or(FrameNumber::MAX);
        match by_given.iter_mut().find(|(known, _)| *known == given) {
            Some((_, numbers)) => numbers.push(number),
            None => by_given.push((given, vec![number])),
        }
    }
    let said = |(given, numbers): &(&Given, Vec<FrameNumber>)| match numbers[..] {
        [one] => format!("stroke {one} of the drawing: it lies on no part, so {given}"),
        _ => format!("strokes {} of the drawing: they lie on no part; of each of them: {given}", runs(numbers)),
    };
    by_given.iter().map(said).collect()
}
