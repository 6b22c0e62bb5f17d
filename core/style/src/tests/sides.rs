//! Clips that look to the other side are mirrored, and named.

use super::*;
use rototoon_base::scene::facing::{Side, in_a_mirror, of_clip};

/// A clip as a mirror shows it.
fn mirrored(clip: &Clip) -> Clip {
    Clip { postures: in_a_mirror(&clip.template, &clip.postures), ..clip.clone() }
}

/// A library that walks to the right, with the clips mirrored that are chosen by character and motion, and its translation.
fn of_both_sides(chosen: &dyn Fn(&str, &str) -> bool) -> (Clip, Grounds) {
    let walking = |mut clip: Clip| {
        let goes = |(frame, p): (usize, &mut Vec<Point>)| p.iter_mut().for_each(|q| q.x += 0.1 * frame as f64);
        clip.postures.iter_mut().enumerate().for_each(goes);
        if chosen(&clip.character, &clip.motion) { mirrored(&clip) } else { clip }
    };
    let clips: Vec<Clip> = library().into_iter().map(walking).collect();
    translate_and_judge(&clips, &request(&[]), &Options::default(), &Silent).unwrap()
}

#[test]
fn a_library_of_both_sides_gives_what_one_of_the_content_s_side_gives() {
    let (plain, grounds) = of_both_sides(&|_, _| false);
    assert_eq!((grounds.sides.content, grounds.sides.mirrored.len()), (Some(Side::Right), 0));
    let goes = |clip: &Clip| clip.postures[23][0].x - clip.postures[0][0].x;
    assert!(goes(&plain) > 1.0);
    type Chosen<'a> = &'a dyn Fn(&str, &str) -> bool;
    let libraries: [(Chosen, usize, bool); 4] = [
        (&|character, _| character == "old", 3, false),
        (&|character, motion| (character, motion) == ("plain", "run"), 18, true),
        (&|character, _| ["proud", "shy"].contains(&character), 8, false),
        (&|_, _| true, 0, true),
    ];
    for (k, (chosen, count, left)) in libraries.into_iter().enumerate() {
        let (made, grounds) = of_both_sides(chosen);
        assert_eq!(grounds.sides.mirrored.len(), count, "library {k}: {:?}", grounds.sides);
        let looks = of_clip(&made.template, &made.postures);
        assert_eq!(looks, Some(if left { Side::Left } else { Side::Right }), "library {k}");
        assert_eq!(goes(&made) < 0.0, left, "library {k}: it goes to where it looks");
        let seen = if left { mirrored(&made) } else { made };
        let off = apart(&seen.postures, &plain.postures);
        assert!(off < 1e-9, "library {k}: off by {off}");
    }
}

#[test]
fn clips_that_were_mirrored_or_have_no_side_are_named() {
    let (_, grounds) = of_both_sides(&|character, motion| (character, motion) == ("shy", "walk"));
    assert_eq!(grounds.notes()[0], "mirrored, to look right as the content's clip does: \"shy\" \"walk\"");
    // From the front a knee bends to either side.
    let front = |clip: &mut Clip| {
        let other = in_a_mirror(&clip.template, &clip.postures);
        clip.postures.extend(other);
    };
    let mut clips = library();
    front(clips.iter_mut().find(|c| (c.character.as_str(), c.motion.as_str()) == ("bold", "bow")).unwrap());
    let notes = |clips: &[Clip], keys: &[KeyPose]| {
        translate_and_judge(clips, &request(keys), &Options::default(), &Silent).unwrap().1.notes()
    };
    let untold =
        "not mirrored, since it cannot be told whether they look right as the content's clip does: \"bold\" \"bow\"";
    assert_eq!(notes(&clips, &[])[0], untold);
    front(clips.iter_mut().find(|c| (c.character.as_str(), c.motion.as_str()) == ("plain", "run")).unwrap());
    assert!(notes(&clips, &[])[0].starts_with("it cannot be told to which side the content's clip looks, so no clip"));
    clips.iter_mut().for_each(|c| c.postures.truncate(24));
    clips.iter_mut().for_each(front);
    assert!(notes(&clips, &[]).iter().all(|note| !note.contains("side")), "a library from the front has no side");
    let posture = human(&mirrored(&clip(1, 1, 24)), 0);
    let posed = notes(&library(), &[KeyPose { frame: 7, posture }]);
    assert!(posed[0].starts_with("the drawn pose of frame 7 looks to the other side"), "{posed:?}");
}
