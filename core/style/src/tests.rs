//! Translation of clips made by a rule, so that the truth is known.

mod sides;

use super::*;
use rototoon_base::geometry::Point;
use rototoon_base::scene::skeleton::{LEGS, PARENTS, limb_lengths};
use rototoon_base::scene::{Silent, Template};

/// A figure at a moment of a motion, with a given stoop and position of the arms.
fn figure(motion: usize, phase: f64, stoop: f64, arms: f64) -> Posture {
    let turn = std::f64::consts::TAU * phase;
    let swing = [0.5, 0.9, 0.3, 0.0][motion % 4];
    let lean = stoop + [0.0, 0.2, -0.05, 0.4][motion % 4] * (0.5 + 0.5 * turn.sin());
    let up = |angle: f64| Point::new(angle.sin(), -angle.cos());
    let down = |angle: f64| Point::new(angle.sin(), angle.cos());
    let mut p = [Point::ZERO; COUNT];
    p[1] = p[0] + up(lean) * 0.6;
    p[2] = p[1] + up(lean * 1.2) * 0.4;
    p[3] = p[2] + up(lean * 1.3) * 0.15;
    p[4] = p[3] + up(lean * 1.3) * 0.4;
    for (shoulder, side) in [(5, 1.0), (8, -1.0)] {
        let angle = arms + swing * side * turn.sin();
        p[shoulder] = p[2] + Point::new(0.02 * side, 0.1);
        p[shoulder + 1] = p[shoulder] + down(angle) * 0.56;
        p[shoulder + 2] = p[shoulder + 1] + down(angle + 0.3 + arms) * 0.5;
    }
    for (leg, side) in LEGS.iter().zip([-1.0, 1.0]) {
        let angle = swing * side * turn.sin();
        p[leg[0]] = Point::new(0.01 * side, 0.05);
        p[leg[1]] = p[leg[0]] + down(angle) * 0.95;
        p[leg[2]] = p[leg[1]] + down(angle - 0.2 - 0.2 * (turn + side).cos()) * 1.0;
    }
    p
}

const MOTIONS: [&str; 4] = ["walk", "run", "stroll", "bow"];
const PEOPLE: [(&str, f64, f64); 5] =
    [("plain", 0.0, 0.0), ("old", 0.5, 0.1), ("proud", -0.15, -0.2), ("shy", 0.2, 0.4), ("bold", -0.05, 0.6)];

pub(crate) fn clip(person: usize, motion: usize, frames: usize) -> Clip {
    let (name, stoop, arms) = PEOPLE[person];
    let at = |f: usize| figure(motion, f as f64 / frames as f64, stoop, arms);
    Clip::new(name, MOTIONS[motion], (0..frames).map(at).collect())
}

pub(crate) fn library() -> Vec<Clip> {
    (0..PEOPLE.len()).flat_map(|person| (0..4).map(move |motion| clip(person, motion, 24))).collect()
}

pub(crate) fn request<'a>(keys: &'a [KeyPose]) -> Request<'a> {
    Request { style: "old", motion: "run", content: "plain", keys }
}

fn human(clip: &Clip, frame: usize) -> Posture {
    clip.human().unwrap()[frame]
}

fn resample_to(clip: &mut Clip, frames: usize) {
    clip.postures = resample(&clip.human().unwrap(), frames).into_iter().map(Vec::from).collect();
}

pub(crate) fn apart(a: &[Vec<Point>], b: &[Vec<Point>]) -> f64 {
    assert_eq!(a.len(), b.len());
    let frame =
        |p: &Vec<Point>, q: &Vec<Point>| (1..COUNT).map(|k| (p[k] - p[0]).distance(q[k] - q[0])).sum::<f64>() / 16.0;
    a.iter().zip(b).map(|(p, q)| frame(p, q)).sum::<f64>() / a.len() as f64
}

#[test]
fn the_order_of_the_clips_changes_nothing() {
    let (clips, mut turned) = (library(), library());
    turned.reverse();
    turned.rotate_left(7);
    for (id, _, preset) in Preset::ALL {
        let options = Options { preset, ..Options::default() };
        let made = |clips: &[Clip]| translate(clips, &request(&[]), &options, &Silent).unwrap();
        assert_eq!(made(&clips), made(&turned), "{id}");
    }
}

#[test]
fn every_preset_is_nearer_to_the_truth_than_a_copy_and_says_how_sure_it_is() {
    let (clips, truth) = (library(), clip(1, 1, 24));
    let copied = apart(&clip(0, 1, 24).postures, &truth.postures);
    for (id, _, preset) in Preset::ALL {
        let made = translate(&clips, &request(&[]), &Options { preset, ..Options::default() }, &Silent).unwrap();
        assert_eq!((made.character.as_str(), made.motion.as_str()), ("old", "run"));
        let error = apart(&made.postures, &truth.postures);
        assert!(error < 0.75 * copied, "{id}: {error} beside {copied}");
        assert_eq!(made.deviation.len(), 24);
        assert!(made.deviation.iter().flatten().all(|s| (0.0..0.5).contains(s)), "{id}");
        if preset == Preset::Rototoon {
            assert!(made.deviation[3][7] > made.deviation[3][1], "hands are less sure than the chest");
        }
        assert_eq!(Preset::from_id(id), Some(preset));
    }
}

#[test]
fn the_true_clip_is_never_looked_at() {
    let clips = library();
    let without: Vec<Clip> =
        clips.iter().filter(|c| (c.character.as_str(), c.motion.as_str()) != ("old", "run")).cloned().collect();
    let make = |clips: &[Clip]| translate(clips, &request(&[]), &Options::default(), &Silent).unwrap();
    assert_eq!(make(&clips), make(&without));
}

#[test]
fn a_pair_of_characters_is_enough() {
    let pair: Vec<Clip> = library().into_iter().filter(|c| c.character == "plain" || c.character == "old").collect();
    let truth = clip(1, 1, 24);
    let copied = apart(&clip(0, 1, 24).postures, &truth.postures);
    // The symmetric model has as many style components as there are other characters. A single number cannot carry a
    // style.
    for (id, _, preset) in Preset::ALL.into_iter().filter(|p| p.2 != Preset::BilinearSymmetric) {
        let made = translate(&pair, &request(&[]), &Options { preset, ..Options::default() }, &Silent).unwrap();
        let error = apart(&made.postures, &truth.postures);
        assert!(error < copied, "{id}: {error} beside {copied}");
    }
}

#[test]
fn drawn_poses_are_met_and_make_the_rest_better() {
    let (clips, truth) = (library(), clip(1, 1, 24));
    let pose = |frame: usize| KeyPose { frame, posture: human(&truth, frame).map(|p| p + Point::new(7.0, -3.0)) };
    for (id, _, preset) in Preset::ALL {
        let options = Options { preset, ..Options::default() };
        let error = |keys: &[KeyPose]| {
            let made = translate(&clips, &request(keys), &options, &Silent).unwrap();
            for key in keys {
                let at = |p: &[Point]| p.iter().map(|q| *q - p[0]).collect::<Vec<_>>();
                let (a, b) = (at(&made.postures[key.frame]), at(&key.posture));
                assert!(a.iter().zip(&b).all(|(a, b)| a.distance(*b) < 1e-6), "{id}");
            }
            apart(&made.postures, &truth.postures)
        };
        let (none, one, two) = (error(&[]), error(&[pose(0)]), error(&[pose(3), pose(15)]));
        assert!(two < none, "{id}: {none} {two}");
        assert!(one < none || preset != Preset::Rototoon, "{none} {one}");
    }
}

#[test]
fn of_a_character_without_clips_a_drawn_pose_is_enough() {
    let clips: Vec<Clip> = library().into_iter().filter(|c| c.character != "old").collect();
    let truth = clip(1, 1, 24);
    let key = KeyPose { frame: 0, posture: human(&truth, 0) };
    let made = translate(&clips, &request(&[key]), &Options::default(), &Silent).unwrap();
    assert!(apart(&made.postures, &truth.postures) < apart(&clip(0, 1, 24).postures, &truth.postures));
}

#[test]
fn holes_unequal_lengths_and_units_do_no_harm() {
    let mut clips = library();
    clips.retain(|c| (c.character.as_str(), c.motion.as_str()) != ("shy", "bow"));
    for c in &mut clips {
        if c.character == "bold" {
            resample_to(c, 31);
        }
        if c.character == "old" {
            c.postures.iter_mut().flatten().for_each(|q| *q = *q * 80.0 + Point::new(300.0, 200.0));
        }
    }
    let made = translate(&clips, &request(&[]), &Options::default(), &Silent).unwrap();
    let larger = |clip: &Clip| -> Vec<Vec<Point>> {
        clip.postures.iter().map(|p| p.iter().map(|q| *q * 80.0).collect()).collect()
    };
    let (truth, copied) = (larger(&clip(1, 1, 24)), larger(&clip(0, 1, 24)));
    assert!(apart(&made.postures, &truth) < 0.7 * apart(&copied, &truth));
}

#[test]
fn one_frame_and_one_motion_are_no_reason_to_fail() {
    let still: Vec<Clip> = (0..3).flat_map(|p| (0..2).map(move |m| clip(p, m, 1))).collect();
    for (_, _, preset) in Preset::ALL {
        let made = translate(&still, &request(&[]), &Options { preset, ..Options::default() }, &Silent).unwrap();
        assert_eq!(made.postures.len(), 1);
        assert!(made.postures[0].iter().all(|p| p.is_finite()));
    }
}

#[test]
fn limbs_keep_the_lengths_of_the_style() {
    let made = translate(&library(), &request(&[]), &Options { strength: 1.5, ..Options::default() }, &Silent).unwrap();
    let own = limb_lengths(&human(&clip(1, 0, 24), 0));
    for posture in &made.human().unwrap() {
        for limb in [0, 1, 11, 12, 14, 15] {
            assert!((limb_lengths(posture)[limb] - own[limb]).abs() < 1e-3, "{limb}");
        }
    }
}

/// The library with limbs of other lengths: each of the people has its own factors of arms, thighs and shins.
fn of_builds() -> Vec<Clip> {
    let factors = [[1.0, 1.0, 1.0], [0.7, 1.5, 1.4], [1.3, 0.8, 0.7], [1.2, 1.2, 0.9], [0.9, 0.6, 0.8]];
    let mut clips = library();
    for clip in &mut clips {
        let [arm, thigh, shin] = factors[PEOPLE.iter().position(|(name, ..)| *name == clip.character).unwrap()];
        for posture in &mut clip.postures {
            let before = posture.clone();
            for k in 1..COUNT {
                let parent = PARENTS[k];
                let factor = match k {
                    6 | 7 | 9 | 10 => arm,
                    12 | 15 => thigh,
                    13 | 16 => shin,
                    _ => 1.0,
                };
                posture[k] = posture[parent] + (before[k] - before[parent]) * factor;
            }
        }
    }
    clips
}

#[test]
fn a_build_is_no_manner() {
    for (id, _, preset) in Preset::ALL {
        let options = Options { preset, keep_lengths: false, ..Options::default() };
        let make = |clips: &[Clip]| translate(clips, &request(&[]), &options, &Silent).unwrap().human().unwrap();
        let (alike, mixed) = (make(&library()), make(&of_builds()));
        let own = limb_lengths(&human(of_builds().iter().find(|c| c.character == "old").unwrap(), 0));
        for (a, b) in alike.iter().zip(&mixed) {
            for k in 1..COUNT {
                let (a, b) = (a[k] - a[PARENTS[k]], b[k] - b[PARENTS[k]]);
                assert!(a.angle_to(b).abs() < 0.01, "{id}: limb {k} turns by {} with the build", a.angle_to(b));
                let off = (b.length() / own[k - 1] - 1.0).abs();
                assert!(
                    off < 0.1 || own[k - 1] < 0.2 || preset != Preset::Rototoon,
                    "{id}: limb {k} is {off} off the style's length"
                );
            }
        }
    }
}

#[test]
fn longer_legs_go_farther() {
    let mut clips = of_builds();
    let walked = clips.iter_mut().find(|c| c.character == "plain" && c.motion == "run").unwrap();
    for (frame, posture) in walked.postures.iter_mut().enumerate() {
        posture.iter_mut().for_each(|p| p.x += 0.1 * frame as f64);
    }
    let options = Options { keep_contacts: false, ..Options::default() };
    let made = translate(&clips, &request(&[]), &options, &Silent).unwrap();
    // Thighs of 0.95 and shins of 1, longer by half and by two fifths.
    let (went, legs) = (made.postures[23][0].x - made.postures[0][0].x, (1.5 * 0.95 + 1.4) / 1.95);
    assert!((went - 2.3 * legs).abs() < 0.1, "{went} in place of {}", 2.3 * legs);
}

#[test]
fn drawn_poses_are_met_on_any_build() {
    let clips = of_builds();
    let truth = human(clips.iter().find(|c| c.character == "old" && c.motion == "run").unwrap(), 5);
    let key = KeyPose { frame: 5, posture: truth };
    let made = translate(&clips, &request(&[key]), &Options::default(), &Silent).unwrap();
    assert!((0..COUNT).all(|k| (made.postures[5][k] - made.postures[5][0]).distance(truth[k] - truth[0]) < 1e-6));
}

#[test]
fn a_strength_of_0_is_the_content_s_own_motion() {
    // The old one has longer legs and shorter arms.
    let mut clips = library();
    for posture in clips.iter_mut().filter(|c| c.character == "old").flat_map(|c| &mut c.postures) {
        let before = posture.clone();
        for k in 1..COUNT {
            let parent = PARENTS[k];
            let factor = if k > 11 {
                1.3
            } else if k > 4 {
                0.8
            } else {
                1.0
            };
            posture[k] = posture[parent] + (before[k] - before[parent]) * factor;
        }
    }
    let content = clip(0, 1, 24).human().unwrap();
    let make = |strength: f64, keep_lengths: bool| {
        let options = Options { strength, keep_lengths, ..Options::default() };
        translate_and_judge(&clips, &request(&[]), &options, &Silent).unwrap()
    };
    let (made, grounds) = make(0.0, false);
    for (a, b) in made.human().unwrap().iter().zip(&content) {
        assert!((0..COUNT).all(|k| (a[k] - a[0]).distance(b[k] - b[0]) < 1e-9));
    }
    assert_eq!(grounds.notes(), ["with a strength of 0 the result is the content's own motion"]);
    let (made, grounds) = make(0.0, true);
    assert!(grounds.notes()[0].ends_with("own motion, with limbs as long as the style's"));
    let own = limb_lengths(&human(clips.iter().find(|c| c.character == "old").unwrap(), 0));
    for (a, b) in made.human().unwrap().iter().zip(&content) {
        for k in 1..COUNT {
            let parent = PARENTS[k];
            let (a, b) = (a[k] - a[parent], b[k] - b[parent]);
            assert!(a.angle_to(b).abs() < 1e-6, "limb {k} turns by {}", a.angle_to(b));
            assert!((a.length() - own[k - 1]).abs() < 1e-2, "limb {k}: {} {}", a.length(), own[k - 1]);
        }
    }
    // Half of it is between none and the most probable.
    let apart = |a: f64, b: f64| apart(&make(a, true).0.postures, &make(b, true).0.postures);
    let whole = apart(0.0, 1.0);
    assert!(apart(0.0, 0.5) < 0.65 * whole && apart(0.5, 1.0) < 0.65 * whole);
}

#[test]
fn a_library_that_tells_little_says_so() {
    let notes = |keep: &dyn Fn(&Clip) -> bool, preset: Preset| {
        let clips: Vec<Clip> = library().into_iter().filter(keep).collect();
        let made = translate_and_judge(&clips, &request(&[]), &Options { preset, ..Options::default() }, &Silent);
        let (made, grounds) = made.unwrap();
        (made, grounds.notes())
    };
    // All that is known of the old one is a motion that nobody else shows.
    let alone = |c: &Clip| if c.character == "old" { c.motion == "bow" } else { c.motion == "run" };
    let (made, said) = notes(&alone, Preset::Rototoon);
    let nothing = "no other character shows a motion that \"old\" shows, so nothing is known of the style";
    assert_eq!(said, [format!("{nothing}: the result is the content's own motion, with limbs as long as the style's")]);
    assert!(apart(&made.postures, &clip(0, 1, 24).postures) < 0.02, "not the mean of the others");
    assert_eq!(notes(&alone, Preset::Bilinear).1, [nothing]);
    // Three characters cannot be rehearsed on.
    let few = |c: &Clip| ["plain", "old", "shy"].contains(&c.character.as_str());
    assert!(notes(&few, Preset::Rototoon).1[0].starts_with("the library is too small to rehearse on (3 motions and 3"));
    let all = notes(&|_| true, Preset::Rototoon).1;
    assert!(all.len() == 1 && all[0].starts_with("expect "), "{all:?}");
}

#[test]
fn the_styles_pace_may_be_taken() {
    let mut clips = library();
    for c in &mut clips {
        if c.character == "old" {
            resample_to(c, 36);
        }
    }
    let options = Options { pace: Pace::Style, ..Options::default() };
    let made = translate(&clips, &request(&[]), &options, &Silent).unwrap();
    assert_eq!((made.postures.len(), made.deviation.len()), (36, 36));
}

#[test]
fn the_result_does_not_depend_on_threads() {
    let clips = library();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| translate(&clips, &request(&[]), &Options::default(), &Silent).unwrap())
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn what_is_wrong_with_a_request_is_named() {
    let clips = library();
    let error = |style: &str, motion: &str, content: &str, keys: &[KeyPose]| {
        translate(&clips, &Request { style, motion, content, keys }, &Options::default(), &Silent)
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        error("nobody", "run", "plain", &[]),
        "style: found \"nobody\", expected one of bold, old, plain, proud, shy"
    );
    assert_eq!(error("old", "fly", "plain", &[]), "motion: found \"fly\", expected one of bow, run, stroll, walk");
    assert!(error("old", "run", "old", &[]).contains("expected two characters"));
    let late = KeyPose { frame: 24, posture: human(&clips[0], 0) };
    assert_eq!(error("old", "run", "plain", &[late]), "key pose: found frame 24, expected 0 to 23");
    let flat = KeyPose { frame: 2, posture: [Point::ONE; COUNT] };
    assert!(error("old", "run", "plain", &[flat]).contains("key pose of frame 2: found a torso of length 0"));
}

#[test]
fn clips_of_other_bodies_are_left_out_of_account() {
    let bird = Template::bird();
    let fly = Clip::of(bird.clone(), "old", "fly", vec![bird.typical(); 24]);
    let make = |clips: &[Clip]| translate(clips, &request(&[]), &Options::default(), &Silent);
    let mixed: Vec<Clip> = library().into_iter().chain([fly]).collect();
    assert_eq!(make(&mixed).unwrap(), make(&library()).unwrap());
    let mut content = library();
    content.retain(|c| (c.character.as_str(), c.motion.as_str()) != ("plain", "run"));
    content.push(Clip::of(bird.clone(), "plain", "run", vec![bird.typical(); 24]));
    assert!(make(&content).unwrap_err().to_string().contains(r#"found the skeleton "bird", expected "human""#));
}

#[test]
fn broken_clips_are_named() {
    let error = |clips: &[Clip]| translate(clips, &request(&[]), &Options::default(), &Silent).unwrap_err().to_string();
    let mut nan = library();
    nan[2].postures[5][3].x = f64::NAN;
    assert_eq!(
        error(&nan),
        "clip (\"plain\", \"stroll\"), frame 5: found a coordinate that is not finite, expected finite coordinates"
    );
    let mut flat = library();
    flat.iter_mut().filter(|c| c.character == "shy").for_each(|c| c.postures.fill(vec![Point::ZERO; COUNT]));
    assert!(error(&flat).contains("character \"shy\": found a torso of length 0"));
    let alone: Vec<Clip> = library().into_iter().filter(|c| c.motion == "run" || c.character == "plain").collect();
    assert!(error(&alone).contains("found neither another motion of \"old\" beside \"run\" nor a key pose"));
    let other: Vec<Clip> = library().into_iter().filter(|c| c.character != "plain" || c.motion != "run").collect();
    assert!(error(&other).contains("found no clip of \"run\" by \"plain\""));
}

#[test]
fn translation_stops_when_it_is_told_to() {
    struct Until(f64);
    impl Progress for Until {
        fn report(&self, _: &str, done: f64) -> Result<(), Cancelled> {
            if done < self.0 { Ok(()) } else { Err(Cancelled) }
        }
    }
    for moment in [0.0, 0.5, 1.0] {
        let made = translate(&library(), &request(&[]), &Options::default(), &Until(moment));
        assert_eq!(made, Err(StyleError::Cancelled(Cancelled)));
    }
}

/// The library with the content's clip on twos or threes, each drawing farther to the right.
fn on_twos(count: usize) -> Vec<Clip> {
    let mut clips = library();
    let content = clips.iter_mut().find(|c| (c.character.as_str(), c.motion.as_str()) == ("plain", "run")).unwrap();
    let drawing = |(k, p): (usize, &Vec<Point>)| p.iter().map(|q| *q + Point::new(k as f64, 0.0)).collect::<Vec<_>>();
    let drawings: Vec<Vec<Point>> = content.postures.iter().enumerate().map(drawing).collect();
    content.postures = drawings.into_iter().flat_map(|p| vec![p; count]).collect();
    clips
}

#[test]
fn a_content_on_twos_gives_a_result_on_twos_and_a_hold_is_no_contact() {
    for count in [2, 3] {
        let make = |keys: &[KeyPose], keep_contacts: bool| {
            let options = Options { keep_contacts, ..Options::default() };
            translate(&on_twos(count), &request(keys), &options, &Silent).unwrap()
        };
        let made = make(&[], true);
        for t in 0..24 * count {
            let begin = t - t % count;
            assert_eq!(
                (&made.postures[t], &made.deviation[t]),
                (&made.postures[begin], &made.deviation[begin]),
                "frame {t}"
            );
        }
        assert_eq!(made, make(&[], false), "every drawing is far from the one before: no foot stands");
        let truth = clip(1, 1, 24);
        let seen: Vec<Vec<Point>> = made.postures.iter().step_by(count).cloned().collect();
        assert!(apart(&seen, &truth.postures) < 0.75 * apart(&clip(0, 1, 24).postures, &truth.postures));
        let posture = human(&truth, 5);
        let posed = make(&[KeyPose { frame: 5 * count + 1, posture }], true).postures;
        for t in 5 * count..6 * count {
            let off = (0..COUNT).map(|k| (posed[t][k] - posed[t][0]).distance(posture[k] - posture[0]));
            assert!(off.fold(0.0, f64::max) < 1e-6, "a pose that is drawn for one frame of a hold is that of all");
        }
    }
}
