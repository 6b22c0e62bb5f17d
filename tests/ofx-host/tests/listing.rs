//! Tests of the list of the parts: the menu, the buttons that go from part to part, and the names.

use crate::common::{FILTER, MATTE, OK, ROTO, WHOLE, bundles, clean, document, effect, host, kept, rendered, scene};
use rototoon_ofx_host::{ClipSettings, Effect, Host, Picture, Settings};

const OPTION: &str = "OfxParamPropChoiceOption";

/// A host that lets effects change menus, or one that does not.
fn host_with(menus: bool) -> Host {
    let mut host = host();
    host.configure(&Settings { menus, ..Settings::default() });
    host.reload(bundles());
    host
}

/// The options of the menu.
fn menu(effect: &Effect) -> Vec<String> {
    let option = |k| effect.parameter_property("partList", OPTION, k);
    (0..).map(option).take_while(|option| !option.is_empty()).collect()
}

/// Restores what other tests expect.
fn leave(mut host: Host) {
    clean(&host);
    host.configure(&Settings::default());
    host.reload(bundles());
}

#[test]
fn a_menu_has_the_parts_and_selects_them() {
    let host = host_with(true);
    {
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        assert_eq!(effect.parameter_property("partList", "OfxParamPropSecret", 0), "0");
        assert_eq!(menu(&effect), ["No part", "star", "drop", "ground line"]);
        // A choice selects the part with its page.
        effect.set_text("part", "drop");
        assert_eq!(effect.get("partList", 0.0), [2.0]);
        effect.set("partOpacity", &[0.25]);
        effect.set("partList", &[1.0]);
        assert_eq!((effect.text("part").as_str(), effect.get("partOpacity", 0.0)), ("star", vec![1.0]));
        effect.set("partList", &[2.0]);
        assert_eq!((effect.text("part").as_str(), effect.get("partOpacity", 0.0)), ("drop", vec![0.25]));
        effect.set("partList", &[0.0]);
        assert_eq!(effect.text("part"), "");
        // The order of the menu is that of the picture.
        effect.set("partList", &[3.0]);
        assert_eq!((effect.press("nearer").as_str(), effect.press("nearer").as_str()), (OK, OK));
        assert_eq!(menu(&effect), ["No part", "ground line", "star", "drop"]);
        assert_eq!(
            (effect.get("partList", 0.0), effect.text("partNames").as_str()),
            (vec![1.0], "ground line, star, drop")
        );
        // A part that is gone is gone from the menu, and back after undo.
        let steps = effect.history().len();
        assert_eq!(effect.press("deletePart"), OK);
        assert_eq!((menu(&effect).len(), effect.get("partList", 0.0)), (3, vec![0.0]));
        assert_eq!(effect.history().len(), steps + 1, "the menu is no step of its own: {:?}", effect.history());
        effect.undo();
        effect.changed_by_plugin("document");
        assert_eq!((menu(&effect).len(), effect.get("partList", 0.0)), (4, vec![1.0]));
        assert_eq!(effect.text("partNames"), "ground line, star, drop");
    }
    leave(host);
}

#[test]
fn a_composition_that_is_opened_has_its_menu() {
    let host = host_with(true);
    {
        // A host gives the stored values before it makes the instance, also when it clones one.
        let mut effect = host.effect(ROTO, FILTER);
        effect.set_text_silently("document", &document());
        effect.set_text_silently("part", "drop");
        assert_eq!(effect.create(), OK);
        assert_eq!((menu(&effect).len(), effect.get("partList", 0.0)), (4, vec![2.0]));
        // A document that cannot be read is no reason to refuse an instance.
        let mut broken = host.effect(ROTO, FILTER);
        broken.set_text_silently("document", "nonsense");
        assert_eq!((broken.create().as_str(), menu(&broken).len()), (OK, 1));
    }
    leave(host);
}

#[test]
fn a_menu_that_a_silent_undo_left_behind_is_made_anew() {
    let host = host_with(true);
    {
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        effect.set_text("part", "star");
        assert_eq!(effect.press("deletePart"), OK);
        assert_eq!(menu(&effect), ["No part", "drop", "ground line"]);
        // The host takes the step back and says nothing; the user chooses from the old menu.
        effect.undo();
        effect.set("partList", &[1.0]);
        assert_eq!((effect.text("part").as_str(), menu(&effect).len()), ("drop", 4));
        assert_eq!(effect.get("partList", 0.0), [2.0]);
        // A name of the old menu that is gone is told, and changes nothing.
        let old = menu(&effect);
        effect.set_text_silently("document", "");
        effect.set("partList", &[1.0]);
        assert!(host.messages().join("").contains("\"star\" is gone"), "{old:?}");
        assert_eq!((effect.text("part").as_str(), menu(&effect)), ("drop", vec!["No part".to_owned()]));
        let _ = host.errors();
    }
    leave(host);
}

#[test]
fn buttons_go_from_part_to_part_in_any_host() {
    let host = host_with(false);
    {
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        // A menu that cannot change is not shown, and is left alone.
        assert_eq!(effect.parameter_property("partList", "OfxParamPropSecret", 0), "1");
        assert_eq!(menu(&effect), ["No part"]);
        // A composition of an earlier version gets the names with the first selection.
        assert_eq!(effect.text("partNames"), "");
        let mut names = Vec::new();
        for button in ["nextPart", "nextPart", "nextPart", "nextPart", "previousPart", "previousPart"] {
            assert_eq!(effect.press(button), OK);
            names.push(effect.text("part"));
        }
        assert_eq!(effect.text("partNames"), "star, drop, ground line");
        assert_eq!(names, ["star", "drop", "ground line", "star", "ground line", "drop"]);
        assert_eq!(menu(&effect), ["No part"]);
        // Its points are selected, as after a click: the box around them has a corner that scales.
        assert_eq!(effect.press("deletePoints"), OK, "{:?}", host.messages());
        assert_eq!(kept(&effect).scene.parts.len(), 2);
        assert_eq!(effect.text("partNames"), "star, ground line");
        effect.set_text_silently("document", "");
        assert_eq!(effect.press("nextPart"), "kOfxStatFailed");
        assert!(host.messages().join("").contains("found no shapes"));
        let _ = host.errors();
    }
    leave(host);
}

#[test]
fn a_part_gets_another_name_with_all_that_belongs_to_it() {
    let host = host_with(true);
    {
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        effect.set("output", &[MATTE]);
        effect.set_text("parts", "star, gr*");
        effect.set_text("redParts", "drop");
        assert_eq!(effect.press("rename"), "kOfxStatFailed", "no part is selected");
        effect.set_text("part", "star");
        effect.set_at("partOpacity", 0.0, &[0.0]);
        effect.set_at("partOpacity", 4.0, &[1.0]);
        let wanted = rendered_with_errors(&host, &mut effect);
        for (name, why) in [(" ", "New name"), ("drop", "already"), ("star", "already")] {
            effect.set_text("newName", name);
            assert_eq!(effect.press("rename"), "kOfxStatFailed", "{name}");
            assert!(host.messages().last().unwrap().contains(why), "{name}");
        }
        let _ = host.errors();
        let texts = |effect: &Effect| ["document", "state", "part", "parts", "redParts"].map(|id| effect.text(id));
        let before = (texts(&effect), effect.history().len());
        effect.set_text("newName", " größe ");
        assert_eq!(effect.press("rename"), OK, "{:?}", host.messages());
        assert_eq!(texts(&effect)[2..], ["größe", "größe, gr*", "drop"]);
        assert_eq!(menu(&effect), ["No part", "größe", "drop", "ground line"]);
        // The picture is the same, with the part's own keys.
        assert!(rendered_with_errors(&host, &mut effect) == wanted);
        assert_eq!(effect.get("partOpacity", 2.0), [0.5]);
        assert_eq!(kept(&effect).scene.parts[0].tracks, scene().parts[0].tracks);
        // Other parts are selected and come back: the settings went with the name.
        effect.set_text("part", "drop");
        assert_eq!(effect.get("partOpacity", 2.0), [1.0]);
        effect.set_text("part", "größe");
        assert_eq!(effect.get("partOpacity", 2.0), [0.5]);
        let _ = (effect.undo(), effect.undo());
        assert_eq!(effect.history().len(), before.1 + 1, "one step: {:?}", effect.history());
        effect.undo();
        assert!(texts(&effect) == before.0);
        // A locked part keeps its name.
        effect.set("partLock", &[1.0]);
        assert_eq!(effect.press("rename"), "kOfxStatFailed");
        let _ = host.errors();
    }
    leave(host);
}

/// A picture, after errors that were expected.
fn rendered_with_errors(host: &Host, effect: &mut Effect) -> Picture {
    let _ = host.errors();
    rendered(host, effect, 2.0, WHOLE)
}

#[test]
fn a_part_moves_to_a_place_in_the_order() {
    let host = host_with(false);
    {
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        effect.set_text("part", "ground line");
        effect.set("place", &[1.0]);
        assert_eq!(effect.press("moveToPlace"), OK, "{:?}", host.messages());
        assert_eq!(effect.text("partNames"), "ground line, star, drop");
        effect.set_text("part", "star");
        effect.set("place", &[3.0]);
        let steps = effect.history().len();
        assert_eq!(effect.press("moveToPlace"), OK);
        assert_eq!((effect.text("partNames").as_str(), effect.history().len()), ("ground line, drop, star", steps + 1));
        assert_eq!(effect.press("moveToPlace"), "kOfxStatFailed");
        assert!(host.messages().join("").contains("at this place already"));
        let _ = host.errors();
    }
    leave(host);
}
