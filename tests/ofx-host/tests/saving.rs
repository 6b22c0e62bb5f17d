//! Tests of *Save* beside other programs: what they wrote stays, whatever is undone, and in compositions that are opened again.

use crate::common::{FILTER, OK, clean, document, effect, host, kept, scene};
use rototoon::project::Document;
use rototoon_ofx_host::{ClipSettings, Effect, Host};
use std::path::{Path, PathBuf};

/// Another program's version of the document.
fn theirs() -> String {
    let theirs = document().replace("\"parts\"", "\"note\": \"theirs\", \"parts\"");
    assert_ne!(theirs, document());
    theirs
}

fn project(folder: &Path) -> PathBuf {
    let file = folder.join("project.json");
    std::fs::write(&file, document()).unwrap();
    file
}

/// A node that shows a file without having loaded it, as a script makes it.
fn shows<'a>(host: &'a Host, file: &Path) -> Effect<'a> {
    let mut effect = effect(host, FILTER, &ClipSettings::default());
    effect.set_text_silently("document", "");
    effect.set_text_silently("project", file.to_str().unwrap());
    effect
}

fn refuses_to_save(host: &Host, effect: &mut Effect, file: &Path) {
    assert_eq!(effect.press("save"), "kOfxStatFailed");
    let said = host.messages().pop().unwrap_or_default();
    assert!(said.contains("another program wrote the file meanwhile"), "{said}");
    assert_eq!(std::fs::read_to_string(file).unwrap(), theirs());
}

#[test]
fn shapes_that_redo_brings_back_do_not_take_a_newer_file_for_theirs() {
    let (host, folder) = (host(), tempfile::tempdir().unwrap());
    let file = project(folder.path());
    let mut effect = shows(&host, &file);
    // The first edit takes the file's shapes into the composition.
    assert_eq!((effect.press("nextPart"), effect.press("farther")), (OK.into(), OK.into()), "{:?}", host.messages());
    assert_ne!(effect.text("document"), "");
    while !effect.history().is_empty() {
        effect.undo_told(false);
    }
    assert_eq!(effect.text("document"), "");
    // Now the node shows the file again, which another program has written.
    std::fs::write(&file, theirs()).unwrap();
    assert_eq!(effect.region_of_definition(2.0, 1.0).status, OK);
    while effect.text("document").is_empty() {
        effect.redo_told();
    }
    refuses_to_save(&host, &mut effect, &file);
}

#[test]
fn the_first_edit_of_a_file_that_is_only_shown_takes_its_state_and_its_footage() {
    let (host, folder) = (host(), tempfile::tempdir().unwrap());
    let file = project(folder.path());
    let mut effect = shows(&host, &file);
    assert_eq!((effect.press("nextPart"), effect.press("farther")), (OK.into(), OK.into()), "{:?}", host.messages());
    assert_eq!(effect.overlay("OfxInteractActionDraw", true, 1.0, [0.0; 2], 0.1), OK);
    assert!(effect.texts().iter().any(|text| text.contains("track again")), "{:?}", effect.texts());
    let footage = folder.path().join("f_%d.png").to_str().unwrap().to_owned();
    assert_eq!(kept(&effect).scene.footage.pattern, footage);
    // A file in another folder finds the footage, and one beside it names it as before.
    let elsewhere = tempfile::tempdir().unwrap();
    for (path, wanted) in [(elsewhere.path().join("a.json"), footage.as_str()), (file, "f_%d.png")] {
        effect.set_text("project", path.to_str().unwrap());
        assert_eq!(effect.press("save"), OK, "{:?}", host.messages());
        assert_eq!(Document::load(&path).unwrap().scene.footage.pattern, wanted);
    }
    clean(&host);
}

#[test]
fn a_composition_that_is_opened_again_knows_what_its_file_held() {
    let (host, folder) = (host(), tempfile::tempdir().unwrap());
    let file = project(folder.path());
    let mut first = shows(&host, &file);
    assert_eq!(
        (first.press("load"), first.press("nextPart"), first.press("farther")),
        (OK.into(), OK.into(), OK.into())
    );
    let steps = first.history().len();
    assert_eq!((first.press("save"), first.history().len()), (OK.into(), steps), "saving is no step of undo");
    let texts = ["project", "document", "state", "saved"].map(|id| (id, first.text(id)));
    let reopened = || {
        let mut again = effect(&host, FILTER, &ClipSettings::default());
        for (id, text) in &texts {
            again.set_text_silently(id, text);
        }
        again
    };
    assert_eq!(reopened().press("save"), OK);
    assert_ne!(Document::load(&file).unwrap().scene, scene());
    std::fs::write(&file, theirs()).unwrap();
    let mut again = reopened();
    refuses_to_save(&host, &mut again, &file);
    // A damaged note is none: the file is rather kept than replaced.
    std::fs::write(&file, document()).unwrap();
    again.set_text_silently("saved", "{");
    assert_eq!(again.press("save"), OK, "the file holds what the shapes were taken from");
    std::fs::write(&file, theirs()).unwrap();
    again.set_text_silently("saved", "{");
    refuses_to_save(&host, &mut again, &file);
}

#[test]
fn what_the_node_saved_is_its_own_whatever_is_undone() {
    let (host, folder) = (host(), tempfile::tempdir().unwrap());
    let file = project(folder.path());
    let mut effect = shows(&host, &file);
    assert_eq!(
        (effect.press("load"), effect.press("nextPart"), effect.press("farther")),
        (OK.into(), OK.into(), OK.into())
    );
    assert_eq!(effect.press("save"), OK);
    effect.undo_told(false);
    assert_eq!(effect.press("save"), OK, "{:?}", host.messages());
    // A file from which no shapes were taken is the user's choice.
    let other = folder.path().join("other.json");
    std::fs::write(&other, theirs()).unwrap();
    effect.set_text_silently("project", other.to_str().unwrap());
    assert_eq!(effect.press("save"), OK);
    assert_eq!(Document::load(&other).unwrap().scene, Document::load(&file).unwrap().scene);
    clean(&host);
}

fn names(effect: &Effect) -> Vec<String> {
    kept(effect).scene.parts.into_iter().map(|part| part.name).collect()
}

#[test]
fn a_saved_file_is_not_read_over_what_was_made_since() {
    let (host, folder) = (host(), tempfile::tempdir().unwrap());
    let file = folder.path().join("mine.json");
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set_text("project", file.to_str().unwrap());
    assert_eq!(effect.press("save"), OK, "{:?}", host.messages());
    effect.set_text("part", "drop");
    assert_eq!(effect.press("deletePart"), OK, "{:?}", host.messages());
    // The same file is chosen again, by another way too, and a host reports its values as it opens the composition.
    for same in [file.clone(), folder.path().join(".").join("mine.json")] {
        effect.set_text("project", same.to_str().unwrap());
        assert_eq!(names(&effect), ["star", "ground line"]);
    }
    assert_eq!(effect.press("load"), OK);
    assert_eq!(names(&effect), ["star", "drop", "ground line"], "Load reads it");
    // Shapes of another file are no later state of those that were saved.
    let other = folder.path().join("other.json");
    std::fs::write(&other, theirs().replace("star", "sun")).unwrap();
    effect.set_text("project", other.to_str().unwrap());
    assert_eq!(names(&effect)[0], "sun");
    effect.set_text("project", file.to_str().unwrap());
    assert_eq!(names(&effect)[0], "star");
    clean(&host);
}

#[test]
fn after_an_import_the_loaded_file_is_chosen_again_to_save_there() {
    let (host, folder) = (host(), tempfile::tempdir().unwrap());
    let file = project(folder.path());
    let svg = folder.path().join("other.svg");
    std::fs::write(
        &svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\"><path id=\"box\" d=\"M 1 1 L 9 1 L 9 9 Z\"/></svg>",
    )
    .unwrap();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set_text_silently("document", "");
    for chosen in [&file, &svg, &file] {
        effect.set_text("project", chosen.to_str().unwrap());
    }
    assert_eq!(names(&effect), ["star", "drop", "ground line", "box"], "{:?}", host.messages());
    assert_eq!(effect.press("save"), OK, "{:?}", host.messages());
    assert_eq!(Document::load(&file).unwrap().scene.parts.len(), 4);
    clean(&host);
}
