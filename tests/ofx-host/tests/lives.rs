//! Instances on several threads, bundles at odd places, and compositions that another version stored.

use crate::common::{
    CUTOUT, FILTER, HEIGHT, MATTE, OK, OUTPUTS, ROTO, WHOLE, WIDTH, bundles, document, drawn_document, effect, host,
    kept, pattern, rendered,
};
use rototoon_ofx_host::{ClipSettings, Effect, Host, Picture, Settings};
use serde_json::{Value, json};
use std::path::Path;

fn chosen(host: &Host, output: f64) -> Effect<'_> {
    let mut effect = effect(host, FILTER, &ClipSettings::default());
    effect.set("output", &[output]);
    effect.set_text("redParts", "star");
    effect.set_text("document", &drawn_document());
    effect
}

fn picture(effect: &mut Effect, time: f64) -> Picture {
    assert_eq!(effect.render(time, WHOLE, 1.0, 2, 7), OK);
    effect.output()
}

#[test]
fn instances_are_made_and_deleted_while_others_render() {
    let host = host();
    let wanted = OUTPUTS.map(|output| picture(&mut chosen(&host, output), 2.0));
    std::thread::scope(|scope| {
        for (output, wanted) in OUTPUTS.iter().zip(&wanted) {
            let mut steady = chosen(&host, *output);
            scope.spawn(move || {
                for _ in 0..30 {
                    assert!(picture(&mut steady, 2.0) == *wanted, "{output}");
                }
                assert_eq!(steady.destroy(), OK);
            });
        }
        // Meanwhile others come, render another frame, and go.
        for round in 0..20 {
            let mut other = chosen(&host, OUTPUTS[round % OUTPUTS.len()]);
            picture(&mut other, 1.0);
            assert_eq!(other.destroy(), OK);
        }
    });
    assert_eq!(host.live_images(), 0);
}

#[test]
fn the_viewer_draws_an_instance_while_it_renders() {
    let host = host();
    for output in OUTPUTS {
        host.configure(&Settings::default());
        let wanted = picture(&mut chosen(&host, output), 2.0);
        let mut effect = chosen(&host, output);
        host.configure(&Settings { viewer_draws: true, cpus: 3, ..Settings::default() });
        for _ in 0..10 {
            assert!(picture(&mut effect, 2.0) == wanted, "{output}");
        }
        assert!(!effect.drawn().is_empty(), "{output}");
    }
    host.configure(&Settings::default());
    assert_eq!(host.live_images(), 0);
}

/// Does something on a thread of its own.
fn elsewhere(work: impl FnOnce() + Send) {
    std::thread::scope(|scope| scope.spawn(work).join().unwrap());
}

#[test]
fn an_instance_goes_from_thread_to_thread() {
    let host = host();
    let wanted = picture(&mut chosen(&host, MATTE), 2.0);
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    // One thread sets parameters, another one renders, and a third deletes.
    elsewhere(|| effect.set("output", &[MATTE]));
    elsewhere(|| assert!(picture(&mut effect, 2.0) == wanted));
    elsewhere(|| effect.set("frameOffset", &[1.0]));
    elsewhere(|| assert!(picture(&mut effect, 3.0) == wanted));
    elsewhere(move || assert_eq!(effect.destroy(), OK));
    assert_eq!(host.live_images(), 0);
}

#[test]
fn one_image_is_enough() {
    let host = host();
    for output in OUTPUTS {
        let wanted = rendered(&host, &mut chosen(&host, output), 2.0, WHOLE);
        let mut effect = host.effect(ROTO, FILTER);
        effect.set_clip("Source", &ClipSettings::default());
        effect.set_clip("Output", &ClipSettings::default());
        effect.set_frame("Source", 2.0, WIDTH, &pattern(2));
        assert_eq!(effect.create(), OK);
        effect.set_text("document", &drawn_document());
        effect.set("output", &[output]);
        effect.set_text("redParts", "star");
        assert_eq!(effect.frames_needed("Source", 2.0), [2.0, 2.0]);
        assert!(rendered(&host, &mut effect, 2.0, WHOLE) == wanted, "{output}");
    }
}

#[test]
fn a_source_without_pixels() {
    let host = host();
    let source = ClipSettings { x1: 5, x2: 5, y1: 7, y2: 7, ..ClipSettings::default() };
    for output in OUTPUTS {
        let mut effect = chosen(&host, output);
        effect.set_clip("Source", &source);
        effect.set_clip("Output", &source);
        effect.preferences();
        let region = effect.region_of_definition(2.0, 1.0);
        assert!(region.x1 <= region.x2 && region.y1 <= region.y2, "{output} {region:?}");
        effect.identity(2.0, WHOLE, 1.0);
        effect.render(2.0, WHOLE, 1.0, 1, 0);
        assert_eq!(host.live_images(), 0, "{output}");
    }
}

/// Copies the files of a folder.
fn copied(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().map(Result::unwrap) {
        let to = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copied(&entry.path(), &to)
        } else {
            std::fs::copy(entry.path(), to).map(drop).unwrap()
        }
    }
}

#[test]
fn a_bundle_lies_at_a_path_with_spaces_and_letters() {
    let mut host = host();
    let wanted = rendered(&host, &mut chosen(&host, CUTOUT), 2.0, WHOLE);
    let folder = tempfile::tempdir().unwrap();
    let odd = folder.path().join("Plug ins, größe 顔 100%");
    copied(bundles(), &odd);
    host.reload(&odd);
    assert!(host.plugins().iter().any(|id| id == ROTO), "{:?}", host.plugins());
    assert!(rendered(&host, &mut chosen(&host, CUTOUT), 2.0, WHOLE) == wanted);
    host.reload(bundles());
}

#[test]
fn compositions_of_other_versions_are_drawn_or_told() {
    let host = host();
    let wanted = rendered(&host, &mut chosen(&host, MATTE), 2.0, WHOLE);
    // Another version stored fields that this one does not know. They are kept in an edit.
    let mut stored: Value = serde_json::from_str(&document()).unwrap();
    stored["later"] = json!({"größe": [1, 2, 3]});
    stored["parts"][0]["later"] = json!(7);
    let mut effect = chosen(&host, MATTE);
    effect.set_text_silently("document", &stored.to_string());
    assert!(rendered(&host, &mut effect, 2.0, WHOLE) == wanted);
    effect.set_text("part", "star");
    assert_eq!(effect.press_at("newKey", 2.0), OK, "{:?}", host.messages());
    let text: Value = serde_json::from_str(&kept(&effect).to_json()).unwrap();
    assert_eq!((&text["later"], &text["parts"][0]["later"]), (&stored["later"], &json!(7)));
    // A document of a later format, and settings that can't be read, are told and stay.
    let _ = (host.log(), host.messages());
    stored["rototoon"] = json!(99);
    for (name, text) in [("document", stored.to_string()), ("state", "zzzz".to_owned())] {
        let mut effect = chosen(&host, MATTE);
        effect.set_text_silently(name, &text);
        effect.render(2.0, WHOLE, 1.0, 1, 0);
        assert_eq!(host.messages().len(), 1, "{name}");
        assert_eq!((effect.text(name), host.live_images()), (text, 0), "{name}");
    }
    let _ = host.log();
    assert_eq!((WIDTH, HEIGHT), (64, 48), "the size of the test footage");
}
