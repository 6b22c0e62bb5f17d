//! Key points of clips that nobody captured: capture fills them in, and every later stage works with them as with the others.
//!
//! A clip says which they are ([`Clip::guessed`]). Here is what is made of that:
//!
//! - a translated clip has a guess where most frames of the style's clips have one, and where the content's clip has one
//! - its deviation is raised there. A bone whose direction nobody saw may point anywhere, which is a variance of half its squared length
//!   in either coordinate; bones that hang on it add theirs
//! - people are told
//!
//! Limits: a joint between two that were captured is not as free as that. It is treated as if it were.

use super::untracked::named;
use crate::scene::clip::times;
use crate::scene::limbs::LimbSet;
use crate::scene::{Clip, Part};
use crate::style::{Options, Request};

/// The guesses of a clip in words: "l_elbow, l_wrist on 24 of 24 frames". `None` if it has none.
pub fn guesses(clip: &Clip) -> Option<String> {
    let mut by_count: Vec<(usize, Vec<&str>)> = Vec::new();
    for (point, count) in clip.guesses() {
        let name = clip.template.point_name(point);
        match by_count.iter_mut().find(|(known, _)| *known == count) {
            Some((_, names)) => names.push(name),
            None => by_count.push((count, vec![name])),
        }
    }
    let frames = clip.postures.len();
    let said: Vec<String> =
        by_count.iter().map(|(count, names)| format!("{} on {count} of {frames} frames", names.join(", "))).collect();
    (!said.is_empty()).then(|| said.join("; "))
}

/// What is said of a translated clip with guesses.
pub fn guessed_translation(made: &Clip) -> Option<String> {
    let said = guesses(made)?;
    Some(format!(
        "guessed, because the clips were filled in there and nothing was captured: {said}; their deviation is as large as the limbs are long"
    ))
}

/// Marks the guesses of a translated clip, and raises their deviation.
pub(super) fn mark(clips: &[Clip], request: &Request, options: &Options, made: &mut Clip) {
    let frames = made.postures.len();
    let own: Vec<&Clip> = clips
        .iter()
        .filter(|clip| clip.character == request.style && clip.motion != request.motion && options.strength > 0.0)
        .filter(|clip| clip.template.same_points(&made.template))
        .collect();
    let content = clips.iter().find(|clip| clip.character == request.content && clip.motion == request.motion);
    let all: usize = own.iter().map(|clip| clip.postures.len()).sum();
    for point in 0..made.template.len() {
        let counts = own.iter().flat_map(|clip| clip.guesses()).filter(|(known, _)| *known == point);
        let mostly = 2 * counts.map(|(_, count)| count).sum::<usize>() > all;
        let copied = |frame: usize| {
            content.is_some_and(|clip| clip.is_guessed(point, frame * clip.postures.len() / frames.max(1)))
        };
        let on: Vec<bool> = (0..frames).map(|frame| mostly || copied(frame)).collect();
        if on.contains(&true) {
            made.guessed.insert(point, times(&on));
        }
    }
    raise(made);
}

/// Raises the deviation of guesses.
fn raise(made: &mut Clip) {
    for frame in 0..made.deviation.len().min(made.postures.len()) {
        // Parents come before their children.
        let mut free = vec![0.0; made.template.len()];
        for point in 0..made.template.len() {
            if !made.is_guessed(point, frame) {
                continue;
            }
            let parent = made.template.parent(point);
            let bone = made.postures[frame][point].distance(made.postures[frame][parent]);
            free[point] = free[parent] + bone * bone / 2.0;
            let deviation = &mut made.deviation[frame][point];
            *deviation = deviation.max(free[point].sqrt());
        }
    }
}

/// What is said of a drawing whose limbs follow guesses of a clip. `None` if none do. A clip of another body has other points: then all its
/// guesses are told, and no part.
pub(super) fn followed(clip: &Clip, (set, parts): (&LimbSet, &[Part]), mirrored: bool, same: bool) -> Option<String> {
    let told = "guessed in the clip, since nothing was captured there";
    if !same {
        return guesses(clip).map(|said| format!("{told}: {said}"));
    }
    let own = |point: usize| if mirrored { set.template.mirror(point) } else { point };
    let used = |point: usize| set.limbs.iter().any(|limb| own(limb.from) == point || own(limb.to) == point);
    let mut guessed = clip.clone();
    guessed.guessed.retain(|point, _| used(*point));
    let said = guesses(&guessed)?;
    let limbs =
        set.limbs.iter().filter(|limb| [limb.from, limb.to].iter().any(|k| guessed.guessed.contains_key(&own(*k))));
    let carried: Vec<&str> = limbs.flat_map(|limb| limb.carries.iter().map(|carried| carried.part.as_str())).collect();
    let follow = named(parts.iter().filter(|part| carried.contains(&part.name.as_str())));
    let follow = follow.map(|parts| format!("; what follows is {parts}")).unwrap_or_default();
    Some(format!("{told}: {said}{follow}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::scene::Template;
    use crate::scene::clip::Guessed;

    fn clip(character: &str, motion: &str, frames: usize, guessed: Guessed) -> Clip {
        let human = Template::human();
        let postures = vec![human.typical(); frames];
        Clip { guessed, ..Clip::of(human, character, motion, postures) }
    }

    #[test]
    fn a_translated_clip_is_no_surer_of_guesses_than_of_limbs_that_may_point_anywhere() {
        let guess = |frames: usize| Guessed::from([(6, vec![[0, frames - 1]]), (7, vec![[0, frames - 1]])]);
        let clips = [
            clip("old", "wave", 6, guess(6)),
            clip("old", "walk", 4, Guessed::new()),
            clip("boy", "walk", 4, Guessed::from([(16, vec![[2, 3]])])),
        ];
        let request = Request { style: "old", motion: "walk", content: "boy", keys: &[] };
        let translated = || {
            let mut made = clip("old", "walk", 4, Guessed::new());
            made.deviation = vec![vec![0.01; made.template.len()]; 4];
            made
        };
        let mut made = translated();
        mark(&clips, &request, &Options::default(), &mut made);
        assert_eq!(made.guessed, Guessed::from([(6, vec![[0, 3]]), (7, vec![[0, 3]]), (16, vec![[2, 3]])]));
        let bone = |k: usize| made.postures[0][k].distance(made.postures[0][made.template.parent(k)]);
        let [elbow, wrist] = [6, 7].map(|k| made.deviation[0][k]);
        assert!(
            (elbow - bone(6) / 2f64.sqrt()).abs() < 1e-9
                && (wrist * wrist - elbow * elbow - bone(7) * bone(7) / 2.0).abs() < 1e-9
        );
        assert_eq!((made.deviation[1][16], made.deviation[0][10]), (0.01, 0.01));
        let said = guessed_translation(&made).unwrap();
        assert!(
            said.contains(
                "there and nothing was captured: l_elbow, l_wrist on 4 of 4 frames; r_ankle on 2 of 4 frames;"
            ),
            "{said}"
        );
        // The content's own motion has nothing of the style.
        let mut copy = translated();
        mark(&clips, &request, &Options { strength: 0.0, ..Options::default() }, &mut copy);
        assert_eq!(copy.guessed, Guessed::from([(16, vec![[2, 3]])]));
        assert_eq!(copy.postures[0][0], Point::ZERO);
    }
}
