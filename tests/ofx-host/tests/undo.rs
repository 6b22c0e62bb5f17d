//! Tests of the host's undo where the host reports each parameter that comes back as a change by the user. OpenFX says so of
//! undo, redo and presets.

use crate::common::{FILTER, HEIGHT, OK, clean, document, effect, host, kept, scene};
use rototoon::geometry::Point;
use rototoon::project::Document;
use rototoon_ofx_host::{ClipSettings, Effect, Host};
use std::path::Path;

/// What must come back: the document, the settings, the selection, and the page.
fn all(effect: &Effect) -> (Vec<String>, Vec<Vec<f64>>) {
    let texts = ["document", "state", "part", "project", "partNames", "parts"].map(|id| effect.text(id));
    let numbers = [
        "partOn",
        "partInvert",
        "partOpacity",
        "partGrow",
        "partFeather",
        "partFalloff",
        "partFalloffCurve",
        "partColor",
        "partMode",
        "partLock",
        "frameOffset",
    ];
    (texts.into(), numbers.iter().flat_map(|id| [0.0, 2.0, 4.0].map(|time| effect.get(id, time))).collect())
}

/// Moves the second point of a part on a frame.
fn drag(effect: &mut Effect, part: usize, by: Point) {
    let text = effect.text("document");
    let shown = Document::parse(&rototoon_ofx::roto::stored::decode(&text).unwrap(), "shown").unwrap();
    let from = shown.scene.parts[part].tracks[&2][1];
    for (action, at) in [("PenDown", from), ("PenMotion", from + by), ("PenUp", from + by)] {
        let place = [at.x, HEIGHT as f64 - at.y];
        assert_eq!(effect.overlay(&format!("OfxInteractAction{action}"), true, 2.0, place, 0.1), OK);
    }
}

/// The number of undo steps, and what they must give back.
type State = (usize, (Vec<String>, Vec<Vec<f64>>));

/// Does what an artist does to a node. `file` is a document to load. Returns the state after each action.
fn work(host: &Host, effect: &mut Effect, file: &Path) -> Vec<State> {
    let mut states = Vec::new();
    let mut note = |effect: &Effect| states.push((effect.history().len(), all(effect)));
    note(effect);
    effect.set_text_in_history("part", "star");
    note(effect);
    effect.set_in_history("partOpacity", &[0.5]);
    note(effect);
    effect.set_in_history("partMode", &[1.0]);
    note(effect);
    effect.set_in_history("partColor", &[0.2, 0.4, 0.6]);
    effect.set_in_history("partFalloff", &[2.5]);
    effect.set_in_history("partFalloffCurve", &[2.0]);
    note(effect);
    drag(effect, 0, Point::new(2.0, 1.0));
    note(effect);
    effect.set_text_in_history("part", "drop");
    effect.set_in_history("partFeather", &[3.0]);
    effect.set_in_history("partOpacity", &[0.75]);
    note(effect);
    // A page that shows no part, and one with two settings again.
    assert_eq!((effect.press("newPart"), effect.press("previousPart")), (OK.into(), OK.into()));
    effect.set_text_in_history("part", "drop");
    note(effect);
    effect.set_text_in_history("part", "star");
    note(effect);
    effect.set_text_in_history("newName", "sun");
    assert_eq!((effect.press("rename"), effect.press("farther")), (OK.into(), OK.into()), "{:?}", host.messages());
    note(effect);
    effect.set_in_history("frameOffset", &[10.0]);
    effect.set_in_history("frameOffset", &[0.0]);
    note(effect);
    assert_eq!(effect.press("deletePart"), OK);
    note(effect);
    // Choosing a file loads it. What was made before, and what is made after, comes back.
    effect.set_text_in_history("project", file.to_str().unwrap());
    note(effect);
    assert_eq!(kept(effect).scene.parts.len(), scene().parts.len());
    drag(effect, 1, Point::new(1.0, -1.0));
    note(effect);
    states
}

#[test]
fn undo_that_is_reported_as_the_users_own_change_gives_back_everything() {
    for between in [false, true] {
        let host = host();
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("other.json");
        std::fs::write(&file, document()).unwrap();
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        let states = work(&host, &mut effect, &file);
        let _ = host.messages();
        for (steps, wanted) in states.iter().rev() {
            while effect.history().len() > *steps {
                let before = effect.history().len();
                effect.undo_told(between);
                assert_eq!(effect.history().len(), before - 1, "{between}: undo made a step: {:?}", effect.history());
            }
            assert!(all(&effect) == *wanted, "{between}: {steps} steps: {:?} {wanted:?}", all(&effect));
        }
        assert_eq!(host.messages(), [""; 0], "{between}: undo complained");
        clean(&host);
    }
}

#[test]
fn redo_makes_the_nodes_own_steps_again_and_no_others() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    let mut states = Vec::new();
    let mut note = |effect: &Effect| states.push((effect.history().len(), all(effect)));
    note(&effect);
    for button in ["nextPart", "farther", "nextPart", "newKey", "nextPart", "hideHere"] {
        assert_eq!(effect.press_at(button, 2.0), OK, "{button} {:?}", host.messages());
        note(&effect);
    }
    drag(&mut effect, 0, Point::new(2.0, 1.0));
    note(&effect);
    effect.set_text("newName", "sun");
    for button in ["rename", "deletePart", "previousPart"] {
        assert_eq!(effect.press_at(button, 2.0), OK, "{button} {:?}", host.messages());
        note(&effect);
    }
    let all_steps = effect.history();
    while !effect.history().is_empty() {
        effect.undo_told(false);
    }
    assert!(all(&effect) == states[0].1);
    for (steps, wanted) in &states {
        while effect.history().len() < *steps {
            effect.redo_told();
        }
        assert!(all(&effect) == *wanted && effect.history() == all_steps[..*steps], "{steps}: {:?}", effect.history());
    }
    assert_eq!(host.messages(), [""; 0]);
    clean(&host);
}

#[test]
fn a_file_that_is_loaded_is_not_loaded_again_over_what_was_made_since() {
    let host = host();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.json");
    std::fs::write(&file, document()).unwrap();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set_text("document", "");
    effect.set_text("project", file.to_str().unwrap());
    drag(&mut effect, 0, Point::new(2.0, 1.0));
    let made = effect.text("document");
    // A host that opens the composition reports its values, as OpenFX allows.
    for id in ["document", "state", "project", "part", "frameOffset", "partOpacity"] {
        effect.press(id);
    }
    assert!(effect.text("document") == made);
    // Load does load it again, and so does another file.
    assert_eq!(effect.press("load"), OK);
    assert!(effect.text("document") != made);
    drag(&mut effect, 0, Point::new(2.0, 1.0));
    let copy = folder.path().join("b.json");
    std::fs::copy(&file, &copy).unwrap();
    effect.set_text("project", copy.to_str().unwrap());
    assert_eq!(kept(&effect).scene.parts[0].pins.len(), 0);
}
