//! Animals that are drawn by a rule: captured, kept in a library, and re-posed by clips of their own and of other bodies.

use super::*;
use crate::pipeline::{ClipJob, clip};
use crate::project::clips::Clips;
use crate::project::library::{Addition, Existing, Library};
use crate::scene::limbs::{Binding, Calibration, Carried, Limb, LimbEnd, LimbSet};
use crate::scene::template::Template;
use crate::scene::{Part, Silent};
use std::sync::Arc;

const FRAMES: usize = 12;

/// What each part of a drawn animal is made of: its name, half its width, its key points.
pub(super) type Drawn = (&'static str, f64, &'static [&'static str]);

const DOG: [Drawn; 7] = [
    ("body", 12.0, &["pelvis", "back", "withers"]),
    ("neck", 7.0, &["withers", "neck", "head", "muzzle"]),
    ("tail", 3.0, &["tail_base", "tail_middle", "tail_tip"]),
    ("near fore", 5.0, &["l_shoulder", "l_elbow", "l_wrist", "l_forepaw"]),
    ("far fore", 5.0, &["r_shoulder", "r_elbow", "r_wrist", "r_forepaw"]),
    ("near hind", 5.0, &["l_hip", "l_knee", "l_hock", "l_hindpaw"]),
    ("far hind", 5.0, &["r_hip", "r_knee", "r_hock", "r_hindpaw"]),
];
const BIRD: [Drawn; 6] = [
    ("body", 14.0, &["pelvis", "breast"]),
    ("neck", 6.0, &["breast", "neck", "head", "beak"]),
    ("near wing", 6.0, &["l_shoulder", "l_elbow", "l_wrist", "l_wing_tip"]),
    ("far wing", 6.0, &["r_shoulder", "r_elbow", "r_wrist", "r_wing_tip"]),
    ("near leg", 3.0, &["l_hip", "l_knee", "l_heel", "l_toes"]),
    ("far leg", 3.0, &["r_hip", "r_knee", "r_heel", "r_toes"]),
];

/// Moves a key point, and with it all that hangs on it, by a turn about another.
fn turn(template: &Template, posture: &mut [Point], joint: &str, angle: f64) {
    let joint = template.index(joint).unwrap();
    let about = posture[joint];
    for k in (0..posture.len()).filter(|&k| k != joint && template.hangs_on(k, joint)) {
        posture[k] = about + Point::from_angle(angle).rotate(posture[k] - about);
    }
}

/// A walk on the spot's way: legs of one side swing against those of the other, the head nods, what else hangs swings.
fn walk(template: &Template, size: f64, side: f64) -> Vec<Vec<Point>> {
    let at = |frame: usize| {
        let phase = std::f64::consts::TAU * frame as f64 / FRAMES as f64;
        let mut p: Vec<Point> = template.typical();
        for chain in template.chains() {
            let root = template.point_name(chain.points[0]);
            let sign = if chain.name.starts_with("l_") { 1.0 } else { -1.0 };
            let second = chain.points.get(1).map(|&k| template.point_name(k));
            match chain.role {
                crate::scene::template::Role::Torso => {}
                crate::scene::template::Role::Head => turn(template, &mut p, root, 0.1 * phase.sin()),
                _ => {
                    turn(template, &mut p, root, 0.25 * sign * phase.sin());
                    second.into_iter().for_each(|k| turn(template, &mut p, k, 0.2 * sign * phase.cos()));
                }
            }
        }
        let way = Point::new(200.0 + 4.0 * frame as f64 * side, 160.0);
        p.iter().map(|q| Point::new(q.x * side, q.y) * size + way).collect()
    };
    (0..FRAMES).map(at).collect()
}

/// A strip about a run of key points: at each of them a point on either side.
fn strip(template: &Template, posture: &[Point], (_, half, points): Drawn) -> Vec<Point> {
    let places: Vec<Point> = points.iter().map(|name| posture[template.index(name).unwrap()]).collect();
    let across = (places[places.len() - 1] - places[0]).normalize_or(Point::Y).perp() * half;
    places.iter().map(|p| *p + across).chain(places.iter().rev().map(|p| *p - across)).collect()
}

/// An animal's film: every part has a contour on every frame.
pub(super) fn film(template: &Arc<Template>, drawn: &[Drawn], postures: &[Vec<Point>]) -> Document {
    let text = format!(
        r#"{{"rototoon": 1, "footage": {{"pattern": "f_%d.png", "first": 0, "last": {}, "fps": 24, "width": 480, "height": 320}}, "parts": []}}"#,
        postures.len() - 1
    );
    let mut document = Document::parse(&text, "animal").unwrap();
    let mut set = LimbSet { template: template.clone(), ..LimbSet::default() };
    for part in drawn {
        let keys = postures.iter().enumerate().map(|(f, p)| (f as FrameNumber, strip(template, p, *part))).collect();
        document.scene.parts.push(Part { name: part.0.into(), closed: true, keys, ..Part::default() });
        let count = part.2.len();
        let end = |k: usize| {
            let place = |at: usize| Calibration { part: part.0.into(), binding: Binding::Place(at as f64) };
            LimbEnd { points: [place(k), place(2 * count - 1 - k)], share: 0.5 }
        };
        for k in 1..count {
            let [from, to] = [k - 1, k].map(|k| template.index(part.2[k]).unwrap());
            let (start, end) = (end(k - 1), end(k));
            let carries = vec![Carried { part: part.0.into(), turn: 1.0 }];
            set.limbs.push(Limb { from, to, start, end, carries, bends: BTreeMap::new(), rigidity: 1.0 });
        }
    }
    document.set_limbs(&set);
    // What is written and read again is what the commands get.
    Document::parse(&document.to_json(), "animal").unwrap()
}

pub(super) fn own_clip(document: &Document) -> Clip {
    let job = ClipJob { character: "rex".into(), motion: "walk".into(), frames: None };
    clip(document, &job).unwrap().clips.clips.remove(0)
}

fn on(drawing: &Document, clip: &Clip, chains: &[(&str, &str)]) -> (Document, Reshaped) {
    let mut document = drawing.clone();
    let chains = chains.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
    let (options, points) = (Options::default(), BTreeMap::new());
    let job = ReshapeJob { clip, fps: 24.0, rest: Some(0), over: None, chains, mirror: Mirror::Auto, options, points };
    let made = reshape(&mut document, &job, &Silent).unwrap();
    (document, made)
}

/// A drawing of the first posture alone.
fn still(template: &Arc<Template>, drawn: &[Drawn], postures: &[Vec<Point>]) -> Document {
    film(template, drawn, &postures[..1])
}

fn animals() -> [(Arc<Template>, &'static [Drawn]); 2] {
    [(Template::quadruped(), &DOG[..]), (Template::bird(), &BIRD[..])]
}

#[test]
fn the_captured_clip_is_the_true_one_and_goes_through_a_library() {
    for (template, drawn) in animals() {
        let postures = walk(&template, 60.0, 1.0);
        let document = film(&template, drawn, &postures);
        assert!(document.to_json().contains(&format!("\"skeleton\": \"{}\"", template.name())));
        let clip = own_clip(&document);
        assert_eq!(clip.template, template);
        let shown = |k: &usize| drawn.iter().any(|part| part.2.contains(&template.point_name(*k)));
        for (found, truth) in clip.postures.iter().zip(&postures) {
            for k in (0..template.len()).filter(shown) {
                assert!(found[k].distance(truth[k]) < 1e-6, "{} {}", template.name(), template.point_name(k));
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let mut library = Library::open(folder.path());
        let clips = Clips { clips: vec![clip.clone()], fps: 24.0 };
        library.add(&[Addition { clips: &clips, source: "" }], Existing::Refuse).unwrap();
        let library = Library::open(folder.path());
        let read = library.checked(|_| true);
        assert!(read.unusable.is_empty(), "{:?}", read.unusable);
        let text = |clip: &Clip| Clips { clips: vec![clip.clone()], fps: 24.0 }.text();
        assert_eq!(read.clips.iter().map(|(_, clip)| text(clip)).collect::<Vec<_>>(), [text(&clip)]);
    }
}

#[test]
fn an_animal_s_own_clip_on_its_own_drawing_is_the_identity() {
    for (template, drawn) in animals() {
        let postures = walk(&template, 60.0, 1.0);
        let document = film(&template, drawn, &postures);
        let (made, report) = on(&document, &own_clip(&document), &[]);
        assert_eq!(report.still, Vec::<String>::new());
        let mut worst = 0.0f64;
        for (part, truth) in made.scene.parts.iter().zip(&document.scene.parts) {
            for (frame, points) in &part.tracks {
                let apart = points.iter().zip(&truth.keys[frame]).map(|(a, b)| a.distance(*b));
                worst = apart.fold(worst, f64::max);
            }
        }
        assert!(worst < 0.5, "{}: {worst} px", template.name());
    }
}

#[test]
fn another_animal_that_looks_the_other_way_walks_on_its_own_ground() {
    for (template, drawn) in animals() {
        let clip = own_clip(&film(&template, drawn, &walk(&template, 60.0, 1.0)));
        let postures = walk(&template, 35.0, -1.0);
        let drawing = still(&template, drawn, &postures);
        let (made, _) = on(&drawing, &clip, &[]);
        let captured = own_clip(&made);
        let lengths = |p: &[Point]| -> Vec<f64> {
            let bones = template.hanging().into_iter().flat_map(|chain| chain.windows(2));
            bones.map(|bone| p[bone[0]].distance(p[bone[1]])).collect()
        };
        let own = lengths(&postures[0]);
        let feet: Vec<usize> = template.legs().iter().map(|leg| leg[leg.len() - 1]).collect();
        let lowest = |p: &[Point]| feet.iter().map(|&k| p[k].y).fold(f64::MIN, f64::max);
        let ground = lowest(&postures[0]);
        for (frame, posture) in captured.postures.iter().enumerate() {
            let bones = lengths(posture);
            let off = bones.iter().zip(&own).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
            assert!(off < 0.15, "{}, frame {frame}: a bone is {off} off its length", template.name());
            assert!((lowest(posture) - ground).abs() < 4.0, "frame {frame}: {} on {ground}", lowest(posture));
            let torso = template.torso();
            assert!(posture[torso[torso.len() - 1]].x < posture[0].x, "it looks left");
        }
        assert!(captured.postures[FRAMES - 1][0].x < captured.postures[0][0].x - 10.0, "and goes left");
    }
}

#[test]
fn a_human_walk_makes_an_animal_walk_by_named_chains() {
    let human = Template::human();
    let clip = Clip::of(human.clone(), "ann", "walk", walk(&human, 50.0, 1.0));
    // The dog is drawn with its tail up.
    let quadruped = Template::quadruped();
    let mut drawn = walk(&quadruped, 60.0, 1.0);
    turn(&quadruped, &mut drawn[0], "tail_base", 1.2);
    let dog = still(&quadruped, &DOG, &drawn);
    let (made, report) = on(&dog, &clip, &[("l_arm", "l_foreleg"), ("r_arm", "r_foreleg")]);
    assert_eq!(report.still, ["neck", "tail"]);
    let captured = own_clip(&made);
    let angle = |p: &[Point], chain: &str| {
        let of = |t: &Template| t.chains().iter().find(|c| c.name == chain).unwrap().points.clone();
        let chain = of(&captured.template);
        (p[chain[chain.len() - 1]] - p[chain[0]]).to_angle()
    };
    for chain in ["l_foreleg", "r_foreleg", "l_leg", "r_leg"] {
        let angles: Vec<f64> = captured.postures.iter().map(|p| angle(p, chain)).collect();
        let (low, high) =
            (angles.iter().copied().fold(f64::MAX, f64::min), angles.iter().copied().fold(f64::MIN, f64::max));
        assert!((0.3..0.9).contains(&(high - low)), "{chain} swings by {}", high - low);
    }
    let tail = |p: &[Point]| angle(p, "tail") - (p[2] - p[0]).to_angle();
    for (frame, posture) in captured.postures.iter().enumerate() {
        let off = Point::from_angle(tail(posture) - tail(&drawn[0])).to_angle();
        assert!(off.abs() < 0.06, "frame {frame}: the tail is {off} off its drawn angle to the body");
    }
}

/// A dog with short hind legs, which stands on all paws with its back aslant.
fn low_behind(template: &Template) -> Vec<Point> {
    let mut dog = walk(template, 60.0, 1.0).remove(0);
    let at = |name: &str| template.index(name).unwrap();
    for side in ["l", "r"] {
        let hip = dog[at(&format!("{side}_hip"))];
        for name in ["knee", "hock", "hindpaw"] {
            let k = at(&format!("{side}_{name}"));
            dog[k] = hip + (dog[k] - hip) * 0.7;
        }
    }
    let low = |dog: &[Point], paw: &str| dog[at(&format!("l_{paw}"))].y.max(dog[at(&format!("r_{paw}"))].y);
    for _ in 0..60 {
        let gap = low(&dog, "forepaw") - low(&dog, "hindpaw");
        let angle = -gap / 200.0;
        let pelvis = dog[0];
        dog.iter_mut().for_each(|p| *p = pelvis + Point::from_angle(angle).rotate(*p - pelvis));
        let legs = ["l_shoulder", "r_shoulder", "l_hip", "r_hip"];
        legs.into_iter().for_each(|leg| turn(template, &mut dog, leg, -angle));
    }
    dog
}

#[test]
fn paws_that_hang_in_the_air_under_a_walk_are_named() {
    let quadruped = Template::quadruped();
    let clip = super::walkers::others_walk();
    let dog = still(&quadruped, &DOG, &[low_behind(&quadruped)]);
    let low = |points: &[Point]| points.iter().map(|p| p.y).fold(f64::MIN, f64::max);
    let ground = dog.scene.parts.iter().map(|part| low(&part.keys[&0])).fold(f64::MIN, f64::max);
    let (made, report) = on(&dog, &clip, &[]);
    let above = |name: &str| {
        let part = made.scene.parts.iter().find(|part| part.name == name).unwrap();
        ground - part.tracks.values().map(|points| low(points)).fold(f64::MIN, f64::max)
    };
    assert!(above("far hind") > 10.0 && above("near fore") < 1.0);
    // The drawing does not stand on the near hind paw.
    let notes: Vec<&String> = report.notes.iter().filter(|note| note.contains("above the ground")).collect();
    let said = format!("part \"far hind\": at least {:.0} px above the ground on every frame", above("far hind"));
    assert_eq!(notes, [&said]);
    let level = still(&quadruped, &DOG, &walk(&quadruped, 60.0, 1.0));
    let (_, report) = on(&level, &clip, &[("l_arm", "l_foreleg"), ("r_arm", "r_foreleg")]);
    assert!(!report.notes.iter().any(|note| note.contains("above the ground")), "{:?}", report.notes);
}

#[test]
fn a_human_walk_to_the_left_moves_an_animal_to_where_it_looks() {
    let human = Template::human();
    // Knees in front, elbows behind: the clip looks to where it goes.
    let bent = |mut p: Vec<Point>, side: f64| {
        for (joint, angle) in [("l_knee", 0.4), ("r_knee", 0.4), ("l_elbow", -0.4), ("r_elbow", -0.4)] {
            turn(&human, &mut p, joint, side * angle);
        }
        p
    };
    for (goes, looks) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let postures = walk(&human, 50.0, goes).into_iter().map(|p| bent(p, goes)).collect();
        let clip = Clip::of(human.clone(), "ann", "walk", postures);
        let dog = still(&Template::quadruped(), &DOG, &walk(&Template::quadruped(), 60.0, looks));
        let (made, report) = on(&dog, &clip, &[("l_arm", "l_foreleg"), ("r_arm", "r_foreleg")]);
        assert_eq!(report.mirrored, goes != looks);
        let captured = own_clip(&made).postures;
        let way = |from: Point, to: Point| (to.x - from.x) * looks;
        assert!(way(captured[0][0], captured[FRAMES - 1][0]) > 10.0, "{goes} {looks}: it goes to where it looks");
        assert!(captured.iter().all(|p| way(p[0], p[2]) > 0.0), "{goes} {looks}: it looks as drawn");
    }
}

#[test]
fn bodies_without_a_common_chain_are_refused() {
    let human = Template::human();
    let mut drawing = still(&human, &[("body", 9.0, &["pelvis", "chest", "neck"])], &walk(&human, 50.0, 1.0));
    let text = r#"{"name": "worm", "points": [{"name": "a", "at": [0, 0]}, {"name": "b", "parent": "a", "at": [1, 0]}],
        "chains": [{"name": "spine", "points": ["a", "b"], "role": "torso"}]}"#;
    let worm = crate::project::skeleton::read(Some(&serde_json::from_str(text).unwrap())).unwrap();
    let clip = Clip::of(worm.clone(), "w", "crawl", vec![worm.typical()]);
    let (options, points) = (Options::default(), BTreeMap::new());
    let (mirror, chains) = (Mirror::Auto, Vec::new());
    let job = ReshapeJob { clip: &clip, fps: 24.0, rest: None, over: None, chains, mirror, options, points };
    let said = reshape(&mut drawing, &job, &Silent).unwrap_err().to_string();
    assert!(said.contains("found no chain of \"worm\" (spine) that belongs to one of \"human\""), "{said}");
}
