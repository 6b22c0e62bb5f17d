//! Paint and strokes where there are none, cannot be read, or only some are wanted.

use crate::cels::{STRAIGHT, node};
use crate::common::{
    CEL, FILTER, GENERAL, HEIGHT, LINES, MATTE, PAINT, PAINTED, WHOLE, WIDTH, clean, document, drawn_document, host,
    pattern, rendered,
};
use rototoon_ofx_host::{Bounds, ClipSettings, Region};

#[test]
fn a_frame_without_a_drawing_is_empty_and_a_drawing_is_held() {
    let host = host();
    let empty = |picture: rototoon_ofx_host::Picture| picture.values.iter().all(|value| *value == 0.0);
    for output in [PAINT, LINES, CEL] {
        let mut effect = node(&host, &drawn_document(), output, &ClipSettings::default(), false);
        for time in [0.0, 0.9, 9.0, -4.0, 1e12, f64::NAN] {
            assert!(empty(rendered(&host, &mut effect, time, WHOLE)), "{output} {time}");
            let Region { x1, y1, x2, y2, .. } = effect.region_of_definition(time, 1.0);
            assert_eq!([x1, y1, x2, y2], [0.0; 4], "{output} {time}");
        }
        let first = rendered(&host, &mut effect, 1.0, WHOLE);
        for time in [1.5, 1.99, 0.99999] {
            assert!(rendered(&host, &mut effect, time, WHOLE) == first, "{output} {time}");
        }
        effect.set("motionBlur", &[1.0]);
        assert!(rendered(&host, &mut effect, 1.0, WHOLE) == first, "{output}");
        effect.set("frameOffset", &[5.0]);
        assert!(rendered(&host, &mut effect, 6.0, WHOLE) == first && empty(rendered(&host, &mut effect, 1.0, WHOLE)));
        effect.set("shownFirst", &[7.0]);
        effect.set("limitFrames", &[1.0]);
        assert!(empty(rendered(&host, &mut effect, 6.0, WHOLE)), "{output}");
        assert!(!empty(rendered(&host, &mut effect, 7.0, WHOLE)), "{output}");
    }
    assert_eq!(host.messages(), [""; 0]);
    clean(&host);
}

#[test]
fn a_drawing_without_paint_is_passed_on() {
    let host = host();
    let mut effect = crate::common::effect(&host, FILTER, &ClipSettings::default());
    effect.set_text("document", &drawn_document());
    effect.set("output", &[PAINTED]);
    assert_eq!(effect.identity(0.0, WHOLE, 1.0), "Source");
    assert!(rendered(&host, &mut effect, 0.0, WHOLE).values == pattern(0), "identity and render agree");
    assert_eq!(effect.identity(1.0, WHOLE, 1.0), "");
    let beside = Bounds { x1: 0, y1: 0, x2: 4, y2: 48 };
    assert_eq!(effect.identity(1.0, beside, 1.0), "Source");
    // Where nothing is painted within the picture, no bit of the source changes.
    let picture = rendered(&host, &mut effect, 1.0, WHOLE);
    let source = pattern(1);
    assert!((0..HEIGHT).all(|y| (0..16).all(|k| picture.values[4 * y * WIDTH + k] == source[4 * y * WIDTH + k])));
    assert!(picture.values != source);
    let all = Region { status: String::new(), x1: 0.0, y1: 0.0, x2: WIDTH as f64, y2: HEIGHT as f64 };
    assert_eq!(effect.region_of_interest("Source", 1.0, 1.0, &all).x2, WIDTH as f64);
    for output in [PAINT, LINES, CEL] {
        effect.set("output", &[output]);
        assert_eq!(effect.identity(0.0, WHOLE, 1.0), "");
        assert_eq!(effect.region_of_interest("Source", 1.0, 1.0, &all).x2, 0.0, "{output}");
    }
    clean(&host);
}

#[test]
fn without_a_source_its_paint_shows_alone() {
    let host = host();
    let clip = ClipSettings { connected: false, premultiplication: STRAIGHT.into(), ..ClipSettings::default() };
    let mut effect = crate::common::effect(&host, GENERAL, &clip);
    effect.set_text("document", &drawn_document());
    effect.set("output", &[PAINTED]);
    assert!(effect.preferences().ends_with("OfxImageAlphaPremultiplied"), "{}", effect.preferences());
    let painted = rendered(&host, &mut effect, 1.0, WHOLE);
    effect.set("output", &[PAINT]);
    assert!(rendered(&host, &mut effect, 1.0, WHOLE) == painted);
    assert!(painted.values.contains(&1.0));
}

#[test]
fn a_document_that_has_none_is_told() {
    let host = host();
    for (output, wanted) in [
        (PAINT, &["no painted regions"][..]),
        (PAINTED, &["no painted regions"]),
        (LINES, &["no strokes"]),
        (CEL, &["no painted regions", "no strokes"]),
    ] {
        let mut effect = node(&host, &document(), output, &ClipSettings::default(), false);
        for _ in 0..2 {
            let picture = rendered(&host, &mut effect, 1.0, WHOLE);
            assert!(output == PAINTED || picture.values.iter().all(|value| *value == 0.0), "{output}");
        }
        let told = host.messages();
        assert_eq!(told.len(), wanted.len(), "{told:?}");
        assert!(told.iter().zip(wanted).all(|(told, wanted)| told.contains(wanted)), "{told:?}");
    }
    // Of regions without strokes the cel has the regions.
    let strokeless = drawn_document().replace("\"traced\"", "\"a\"").replace("\"drawings\"", "\"b\"");
    let strokeless = strokeless.replace("\"in_betweens\"", "\"c\"");
    let mut effect = node(&host, &strokeless, CEL, &ClipSettings::default(), false);
    let cel = rendered(&host, &mut effect, 1.0, WHOLE);
    assert!(host.messages().iter().all(|told| told.contains("no strokes")));
    effect.set("output", &[PAINT]);
    assert!(rendered(&host, &mut effect, 1.0, WHOLE) == cel);
    assert_eq!(host.messages(), [""; 0]);
}

#[test]
fn what_cannot_be_read_is_told_and_the_rest_is_drawn() {
    let host = host();
    let damaged = drawn_document().replace("\"track\":3", "\"track\":\"door\"");
    assert_ne!(damaged, drawn_document());
    for output in [PAINT, PAINTED, CEL] {
        let mut effect = node(&host, &damaged, output, &ClipSettings::default(), false);
        let _ = (host.log(), host.messages());
        for time in 0..3 {
            assert_eq!(effect.render(f64::from(time), WHOLE, 1.0, 1, 0), "kOfxStatFailed", "{output}");
            assert_eq!(effect.identity(f64::from(time), WHOLE, 1.0), "");
            effect.region_of_definition(f64::from(time), 1.0);
        }
        let told = host.messages();
        assert!(told.len() == 1 && told[0].contains("filled[0] (frame 1).regions[1].track"), "{told:?}");
        assert_eq!(host.live_images(), 0);
        let _ = host.errors();
        for other in [LINES, MATTE] {
            effect.set("output", &[other]);
            assert!(rendered(&host, &mut effect, 1.0, WHOLE).values.contains(&1.0), "{other}");
        }
    }
}

#[test]
fn regions_and_strokes_are_chosen_by_name() {
    let host = host();
    let mut effect = node(&host, &drawn_document(), CEL, &ClipSettings::default(), false);
    let all = rendered(&host, &mut effect, 1.0, WHOLE);
    let mut chosen = |names: &str, time: f64| {
        effect.set_text("drawnNames", names);
        let picture = rendered(&host, &mut effect, time, WHOLE);
        (picture.values.chunks(4).filter(|pixel| pixel[3] > 0.02).count(), picture)
    };
    assert!(chosen("region *, stroke *", 1.0).1 == all && chosen(" ,", 1.0).1 == all);
    let [door, line, both] = ["region 3", "stroke 0", "region 3, stroke 0"].map(|names| chosen(names, 1.0).0);
    assert!(door > 100 && line > 50 && both > door.max(line) && both <= door + line, "{door} {line} {both}");
    // One name is one thing on all frames, and a drawing that nothing connects has a name of its frame.
    assert!(chosen("region 3", 2.0).0 > 100 && chosen("frame 3 stroke 0", 3.0).0 > 30);
    assert_eq!(chosen("region 3", 3.0).0, 0);
    assert_eq!(host.messages(), [""; 0]);
    assert_eq!(chosen("region 4", 1.0).0, 0);
    let told = host.messages();
    assert!(told.len() == 1 && told[0].contains("no \"region 4\""), "{told:?}");
    clean(&host);
}

#[test]
fn parts_are_not_asked_for_paint() {
    let host = host();
    let mut effect = node(&host, &drawn_document(), PAINT, &ClipSettings::default(), false);
    let all = rendered(&host, &mut effect, 1.0, WHOLE);
    effect.set_text("parts", "nobody");
    let untracked = drawn_document().replace("\"tracks\"", "\"nothing\"");
    effect.set_text("document", &untracked);
    assert!(rendered(&host, &mut effect, 1.0, WHOLE) == all);
    assert_eq!(host.messages(), [""; 0]);
    clean(&host);
}
