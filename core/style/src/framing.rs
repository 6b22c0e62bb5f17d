//! Framings: clips of one character from shots in which it is drawn at different sizes.
//!
//! A clip that is captured from a shot is in that shot's pixels, so a near shot gives larger clips than a wide one, and motion
//! capture gives clips in torso lengths. The size of a clip is the sum of what its limbs are long, and clips between whose sizes there is no gap
//! are of one framing. Each framing is divided by its own torso length. A torso that is foreshortened in one clip alone does not
//! make a framing, so clips of one framing all have the torso length of the character.

use super::StyleError;
use super::build::long;
use rototoon_base::scene::Clip;
use rototoon_base::scene::skeleton::{LIMBS, torso};

/// Two sizes are of one framing if they, or sizes between them, differ by this factor at most.
const ALIKE: f64 = 1.5;

/// The framings of a character.
pub(super) struct Framings {
    /// Torso length in most of its clips.
    pub torso: f64,
    /// The motions of other framings, with their torso length.
    others: Vec<(Vec<String>, f64)>,
}

impl Framings {
    /// Those of a character. A character without clips has the torso length 1.
    pub fn of(clips: &[Clip], character: &str) -> Result<Self, StyleError> {
        let own: Vec<&Clip> = clips.iter().filter(|clip| clip.character == character).collect();
        let mut sized: Vec<(f64, usize)> = own.iter().enumerate().map(|(k, clip)| (size(clip), k)).collect();
        sized.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut framings: Vec<Vec<usize>> = sized
            .chunk_by(|a, b| b.0 <= ALIKE * a.0)
            .map(|framing| framing.iter().map(|(_, clip)| *clip).collect())
            .collect();
        // That of most clips comes first, and of several that of the first clip.
        framings.iter_mut().for_each(|framing| framing.sort_unstable());
        framings.sort_by_key(|framing| (usize::MAX - framing.len(), framing.first().copied()));
        let median = |framing: &[usize]| median_torso(framing.iter().map(|k| own[*k]));
        let found = framings.first().and_then(|framing| median(framing)).unwrap_or(1.0);
        if !usable(found) {
            return Err(StyleError::Torso { character: character.to_owned(), found });
        }
        let other = |framing: &Vec<usize>| {
            let motions = framing.iter().map(|k| own[*k].motion.clone()).collect();
            median(framing).filter(|torso| usable(*torso)).map(|torso| (motions, torso))
        };
        Ok(Self { torso: found, others: framings.iter().skip(1).filter_map(other).collect() })
    }

    /// The torso length of the clip of a motion.
    pub fn torso_of(&self, motion: &str) -> f64 {
        let other = self.others.iter().find(|(motions, _)| motions.iter().any(|known| known == motion));
        other.map_or(self.torso, |(_, torso)| *torso)
    }

    /// What is said of clips of other framings.
    pub fn notes(&self, character: &str) -> Vec<String> {
        let note = |(motions, torso): &(Vec<String>, f64)| {
            let names: Vec<String> = motions.iter().map(|motion| format!("{motion:?}")).collect();
            let (times, how) =
                if *torso > self.torso { (torso / self.torso, "larger") } else { (self.torso / torso, "smaller") };
            format!(
                "{} by {character:?}: {times:.1} times {how} than most clips of this character, as from another shot; brought to their size",
                names.join(", ")
            )
        };
        self.others.iter().map(note).collect()
    }
}

fn usable(torso: f64) -> bool {
    torso > 0.0 && torso.is_finite()
}

fn size(clip: &Clip) -> f64 {
    let postures = clip.human().unwrap_or_default();
    (0..LIMBS).map(|limb| long(&postures, limb)).sum()
}

/// The median torso length over all frames; none without frames.
fn median_torso<'a>(clips: impl Iterator<Item = &'a Clip>) -> Option<f64> {
    let mut lengths: Vec<f64> = clips.filter_map(Clip::human).flatten().map(|posture| torso(&posture)).collect();
    lengths.sort_by(f64::total_cmp);
    lengths.get(lengths.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{apart, clip, library, request};
    use crate::{Options, translate, translate_and_judge};
    use rototoon_base::geometry::Point;
    use rototoon_base::scene::Silent;

    fn enlarge(clip: &mut Clip, by: f64) {
        clip.postures.iter_mut().flatten().for_each(|point| *point = *point * by + Point::new(7.0, 3.0));
    }

    #[test]
    fn clips_of_another_framing_are_brought_to_the_size_of_most() {
        let clips = library();
        let options = Options::default();
        let one = translate(&clips, &request(&[]), &options, &Silent).unwrap();
        for (character, motion, by) in [("old", "walk", 2.5), ("old", "bow", 0.01), ("plain", "stroll", 100.0)] {
            let mut two = clips.clone();
            two.iter_mut().filter(|c| c.character == character && c.motion == motion).for_each(|c| enlarge(c, by));
            let (made, grounds) = translate_and_judge(&two, &request(&[]), &options, &Silent).unwrap();
            // The torso of a clip by itself is a little other than that of all clips.
            let error = apart(&made.postures, &one.postures);
            assert!(error < 0.01, "{character} {motion}: {error}");
            let times = if by > 1.0 { format!("{by:.1} times larger") } else { "100.0 times smaller".to_owned() };
            let note = format!("{motion:?} by {character:?}: {times} than most clips");
            assert!(grounds.notes().iter().any(|said| said.starts_with(&note)), "{:?}", grounds.notes());
        }
    }

    #[test]
    fn a_foreshortened_torso_and_other_sizes_that_are_near_make_no_framing() {
        let mut clips: Vec<Clip> = (0..4).map(|motion| clip(1, motion, 12)).collect();
        clips.iter_mut().zip([1.0, 1.4, 0.8, 1.2]).for_each(|(clip, by)| enlarge(clip, by));
        for posture in &mut clips[3].postures {
            let lost = (posture[2] - posture[0]) * 0.6;
            (1..11).for_each(|k| posture[k] -= lost);
            posture[1] = posture[0].midpoint(posture[2]);
        }
        let found = Framings::of(&clips, "old").unwrap();
        assert_eq!(found.notes("old"), Vec::<String>::new());
        assert_eq!(found.torso, median_torso(clips.iter()).unwrap());
        assert!(clips.iter().all(|clip| found.torso_of(&clip.motion) == found.torso));
        assert_eq!(Framings::of(&clips, "nobody").unwrap().torso, 1.0);
    }

    #[test]
    fn of_two_framings_with_as_many_clips_that_of_the_first_clip_counts() {
        let mut clips: Vec<Clip> = (0..4).map(|motion| clip(1, motion, 12)).collect();
        let torso = median_torso(clips[..2].iter()).unwrap();
        clips[2..].iter_mut().for_each(|clip| enlarge(clip, 3.0));
        let found = Framings::of(&clips, "old").unwrap();
        assert_eq!((found.torso, found.torso_of("walk")), (torso, torso));
        assert!(found.torso_of("bow") > 2.5 * torso);
        assert!(
            found.notes("old")[0].starts_with("\"stroll\", \"bow\" by \"old\": 3.0 times larger"),
            "{:?}",
            found.notes("old")
        );
        // A clip that is one point has no size of its own.
        enlarge(&mut clips[3], 0.0);
        assert_eq!(Framings::of(&clips, "old").unwrap().torso_of("bow"), torso);
    }
}
