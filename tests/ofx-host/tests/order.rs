//! Tests of the order of the parts: the buttons Nearer and Farther.

use crate::common::{FILTER, HEIGHT, IDS, OK, WHOLE, WIDTH, clean, effect, footage, host, kept, p, part, rendered};
use rototoon::project::Document;
use rototoon::scene::{Scene, palette};
use rototoon_ofx_host::{ClipSettings, Effect, Host};

const FAILED: &str = "kOfxStatFailed";
/// A column that all squares cover.
const COMMON: usize = 20;

/// Three squares of equal depth that overlap: a later one in the document is in front.
fn document() -> String {
    let square = |x0: f64| move |_| vec![p(x0, 8.0), p(x0 + 20.0, 8.0), p(x0 + 20.0, 40.0), p(x0, 40.0)];
    let parts = [("left", 4.0), ("middle", 12.0), ("right", 18.0)];
    let parts = parts.map(|(name, x)| part(name, 0.0, true, square(x))).into();
    Document::new(Scene { footage: footage(), parts }).to_json()
}

/// Index of the part that is seen in the middle row.
fn front(host: &Host, effect: &mut Effect) -> Option<usize> {
    let picture = rendered(host, effect, 1.0, WHOLE);
    let pixel = &picture.values[4 * (HEIGHT / 2 * WIDTH + COMMON)..][..3];
    (0..3).find(|&part| palette::distinct(part).iter().zip(pixel).all(|(a, b)| (a - b).abs() < 1e-6))
}

#[test]
fn parts_come_nearer_and_go_farther_in_steps_of_undo() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set_text("document", &document());
    effect.set("output", &[IDS]);
    assert_eq!(effect.press("nearer"), FAILED, "no part is selected");
    let _ = host.errors();
    effect.set_text("part", "left");
    let before = (effect.text("document"), effect.text("state"), effect.history().len());
    assert_eq!(front(&host, &mut effect), Some(2));
    assert_eq!(effect.press("farther"), FAILED);
    let told = host.messages().join("\n");
    assert!(told.contains("select a part first") && told.contains("\"left\" is the farthest part already"), "{told}");
    assert!((effect.text("document"), effect.text("state"), effect.history().len()) == before);
    let _ = host.errors();
    // Past the middle one it is still behind the right one; past that one it is in front.
    assert_eq!((effect.press("nearer"), front(&host, &mut effect)), (OK.into(), Some(2)));
    assert_eq!((effect.press("nearer"), front(&host, &mut effect)), (OK.into(), Some(0)));
    assert_eq!(effect.history()[before.2..], ["Order of parts", "Order of parts"]);
    assert_eq!((effect.press("farther"), front(&host, &mut effect)), (OK.into(), Some(2)));
    let names: Vec<String> = kept(&effect).scene.parts.iter().map(|part| part.name.clone()).collect();
    assert_eq!(names, ["left", "middle", "right"], "only depths change");
    for _ in 0..3 {
        effect.undo();
    }
    assert!((effect.text("document"), effect.text("state"), effect.history().len()) == before);
    clean(&host);
}

#[test]
fn tracks_are_old_after_the_order_has_changed_and_a_locked_part_stays() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set_text("document", &document());
    let outlines = |effect: &mut Effect| {
        assert_eq!(effect.overlay("OfxInteractActionDraw", true, 1.0, [0.0; 2], 0.1), OK);
        effect.texts().join(", ")
    };
    assert!(!outlines(&mut effect).contains("track again"));
    effect.set_text("part", "left");
    assert_eq!(effect.press("nearer"), OK, "{:?}", host.messages());
    assert!(outlines(&mut effect).contains("track again"), "{:?}", effect.texts());
    effect.undo();
    assert!(!outlines(&mut effect).contains("track again"));
    effect.set("partLock", &[1.0]);
    let before = effect.text("document");
    assert_eq!(effect.press("nearer"), FAILED);
    assert!(host.messages().join("\n").contains("locked"));
    assert!(effect.text("document") == before);
}
