//! Tests of regions, identity, abort, keys and wrong documents.

use crate::common::{
    CUTOUT, FILTER, GENERAL, HEIGHT, IDS, MATTE, OK, OVERLAY, WHOLE, WIDTH, bundles, clean, document, effect, footage,
    host, p, part, pattern, rendered,
};
use rototoon::project::Document;
use rototoon::scene::Scene;
use rototoon_ofx_host::{Bounds, ClipSettings, Region, Settings};

/// A rectangle from (10, 12) to (20, 30), y down.
fn rectangle() -> String {
    let contour = |_| vec![p(10.0, 12.0), p(20.0, 12.0), p(20.0, 30.0), p(10.0, 30.0)];
    Document::new(Scene { footage: footage(), parts: vec![part("box", 0.0, true, contour)] }).to_json()
}

fn region(region: &Region) -> [f64; 4] {
    [region.x1, region.y1, region.x2, region.y2]
}

#[test]
fn regions_are_as_small_as_possible() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set_text("document", &rectangle());
    let (top, bottom) = (HEIGHT as f64 - 12.0, HEIGHT as f64 - 30.0);
    let whole = Region { status: String::new(), x1: 0.0, y1: 0.0, x2: WIDTH as f64, y2: HEIGHT as f64 };
    for (output, defined, needed) in [
        (CUTOUT, [10.0, bottom, 20.0, top], [10.0, bottom, 20.0, top]),
        (MATTE, [10.0, bottom, 20.0, top], [0.0; 4]),
        (IDS, [10.0, bottom, 20.0, top], [0.0; 4]),
        (OVERLAY, [0.0, 0.0, 64.0, 48.0], [0.0, 0.0, 64.0, 48.0]),
    ] {
        effect.set("output", &[output]);
        for scale in [1.0, 0.5] {
            assert_eq!(region(&effect.region_of_definition(1.0, scale)), defined, "{output}");
            assert_eq!(region(&effect.region_of_interest("Source", 1.0, scale, &whole)), needed, "{output}");
        }
        assert_eq!(effect.frames_needed("Source", 3.0), [3.0, 3.0]);
    }
    effect.set("output", &[MATTE]);
    effect.set("feather", &[3.0]);
    assert_eq!(region(&effect.region_of_definition(1.0, 1.0)), [6.5, bottom - 3.5, 23.5, top + 3.5]);
    effect.set("invert", &[1.0]);
    assert_eq!(region(&effect.region_of_definition(1.0, 1.0)), region(&whole));
    effect.set("invert", &[0.0]);
    // After the end of the track nothing is drawn.
    assert_eq!(region(&effect.region_of_definition(9.0, 1.0)), [0.0; 4]);
    host.configure(&Settings { multi_resolution: false, ..Settings::default() });
    assert_eq!(region(&effect.region_of_definition(1.0, 1.0)), region(&whole));
    clean(&host);
}

#[test]
fn a_matte_with_the_source_has_the_region_of_both() {
    let host = host();
    // The project's format is wider than the source, and the shape reaches beyond it.
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set_clip("Output", &ClipSettings { x2: 128, ..ClipSettings::default() });
    let contour = |_| vec![p(40.0, 12.0), p(90.0, 12.0), p(90.0, 30.0), p(40.0, 30.0)];
    let wide = Document::new(Scene { footage: footage(), parts: vec![part("box", 0.0, true, contour)] });
    effect.set_text("document", &wide.to_json());
    effect.set("output", &[MATTE]);
    assert_eq!(region(&effect.region_of_definition(1.0, 1.0)), [40.0, 18.0, 90.0, 36.0]);
    // With a channel, and with each use of the source's alpha.
    for (channel, alpha) in [(1.0, 0.0), (2.0, 0.0), (0.0, 1.0), (0.0, 2.0)] {
        effect.set("matteChannel", &[channel]);
        effect.set("sourceAlpha", &[alpha]);
        assert_eq!(region(&effect.region_of_definition(1.0, 1.0)), [0.0, 0.0, 90.0, 48.0], "{channel} {alpha}");
        // Nothing is drawn after the end of the track, and the source is there.
        assert_eq!(region(&effect.region_of_definition(9.0, 1.0)), [0.0, 0.0, 64.0, 48.0], "{channel} {alpha}");
    }
    let window = Bounds { x1: 0, y1: 0, x2: 90, y2: 48 };
    effect.preferences();
    let picture = rendered(&host, &mut effect, 1.0, window);
    assert_eq!(picture.values[4 * (20 * 90 + 85) + 3], 1.0, "beyond the source");
    clean(&host);
}

#[test]
fn frames_differ_although_no_parameter_is_animated() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    // A host that reads otherwise keeps the first frame's picture for the whole shot.
    for output in [CUTOUT, MATTE, IDS, OVERLAY] {
        effect.set("output", &[output]);
        effect.preferences();
        assert!(effect.varies(), "{output}");
    }
}

#[test]
fn where_nothing_is_drawn_the_source_is_passed_on() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set_text("document", &rectangle());
    let beside = Bounds { x1: 30, y1: 0, x2: 64, y2: 48 };
    let mut same = |output: f64, invert: f64, window| {
        effect.set("output", &[output]);
        effect.set("invert", &[invert]);
        effect.identity(1.0, window, 1.0) == "Source"
    };
    assert!(!same(CUTOUT, 0.0, WHOLE) && !same(CUTOUT, 0.0, beside) && !same(CUTOUT, 1.0, WHOLE));
    assert!(same(CUTOUT, 1.0, beside));
    assert!(!same(MATTE, 0.0, beside) && !same(MATTE, 1.0, beside) && !same(IDS, 0.0, beside));
    assert!(!same(OVERLAY, 0.0, WHOLE) && same(OVERLAY, 0.0, beside));
    effect.set("output", &[OVERLAY]);
    effect.set("opacity", &[0.0]);
    assert_eq!(effect.identity(1.0, WHOLE, 1.0), "Source");
    assert!(rendered(&host, &mut effect, 1.0, WHOLE).values == pattern(1), "identity and render agree");
    effect.set_text("document", "");
    effect.set("output", &[CUTOUT]);
    assert_eq!(effect.identity(1.0, WHOLE, 1.0), "Source");
    assert!(rendered(&host, &mut effect, 1.0, WHOLE).values == pattern(1));
    clean(&host);
}

#[test]
fn an_aborted_render_ends_early_and_leaves_nothing_behind() {
    let host = host();
    for output in [CUTOUT, MATTE, OVERLAY, IDS] {
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        effect.set("output", &[output]);
        effect.set("grow", &[2.0]);
        for after in [0, 1, 20, 60] {
            host.configure(&Settings { abort_after: after, cpus: 2, ..Settings::default() });
            assert_eq!(effect.render(1.0, WHOLE, 1.0, 1, 0), "kOfxStatFailed", "{output} {after}");
            assert_eq!(host.live_images(), 0);
        }
        host.configure(&Settings::default());
        let _ = (host.log(), host.messages());
        rendered(&host, &mut effect, 1.0, WHOLE);
        assert_eq!(host.messages(), [""; 0]);
    }
}

#[test]
fn keys_of_parameters_count_at_their_time() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set("output", &[MATTE]);
    effect.set("motionBlur", &[0.0]);
    let area = |picture: rototoon_ofx_host::Picture| picture.values.iter().sum::<f32>();
    effect.set_at("grow", 0.0, &[0.0]);
    effect.set_at("grow", 4.0, &[4.0]);
    let keyed = area(rendered(&host, &mut effect, 2.0, WHOLE));
    let mut still = crate::common::effect(&host, FILTER, &ClipSettings::default());
    still.set("output", &[MATTE]);
    still.set("grow", &[2.0]);
    assert_eq!(keyed, area(rendered(&host, &mut still, 2.0, WHOLE)));
    still.set("grow", &[0.0]);
    assert!(keyed > area(rendered(&host, &mut still, 2.0, WHOLE)) + 50.0);
}

#[test]
fn bad_documents_are_reported_once_and_do_not_crash() {
    let host = host();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.json");
    std::fs::write(&file, document()).unwrap();
    for (text, said) in [
        ("nonsense", "line 1"),
        ("{\"rototoon\": 2}", "newer"),
        ("{}", "rototoon"),
        ("{\"rototoon\": 1, \"footage\": 3, \"parts\": []}", "footage"),
    ] {
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        effect.set_text("document", text);
        let _ = (host.log(), host.messages());
        for time in 0..5 {
            assert_eq!(effect.render(f64::from(time), WHOLE, 1.0, 1, 0), "kOfxStatFailed", "{text}");
            assert_eq!(effect.identity(f64::from(time), WHOLE, 1.0), "");
            effect.region_of_definition(f64::from(time), 1.0);
        }
        let messages = host.messages();
        assert!(messages.len() == 1 && messages[0].contains(said), "{text}: {messages:?}");
        // After any change the message is shown again.
        effect.set("grow", &[1.0]);
        effect.render(1.0, WHOLE, 1.0, 1, 0);
        assert_eq!(host.messages().len(), 1);
        assert_eq!(host.live_images(), 0);
    }
}

#[test]
fn hosts_with_one_message_for_each_node_show_all_warnings() {
    let host = host();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("shapes.svg");
    let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="64" height="48"><text>a</text><image width="9" height="9"/>
        <path id="leaf" d="M 10 10 L 40 10 L 40 30 Z"/><path id="odd" transform="none of these" d="M 10 10 L 40 10 L 40 30 Z"/></svg>"#;
    std::fs::write(&file, svg).unwrap();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set_text("document", "");
    effect.set("output", &[MATTE]);
    effect.set_text("parts", "l*, none");
    let _ = host.messages();
    effect.set_text("project", file.to_str().unwrap());
    let imported = host.messages().pop().unwrap();
    assert!(imported.contains("text") && imported.contains("image") && imported.contains("odd"), "{imported}");
    rendered(&host, &mut effect, 1.0, WHOLE);
    let all = host.messages().pop().unwrap();
    assert!(
        all.starts_with(&imported) && all.contains("; Parts: ") && all.contains("; the project is not tracked"),
        "{all}"
    );
    // An error is first, and what the user changes takes all of them away.
    effect.set_text_silently("state", "nonsense");
    effect.render(1.0, WHOLE, 1.0, 1, 0);
    let (_, with_error) = (host.log(), host.messages().pop().unwrap());
    assert!(
        with_error.starts_with("OfxMessageError: the composition's settings") && with_error.contains("not tracked")
    );
    effect.set_text_silently("state", "");
    effect.set("grow", &[0.0]);
    rendered(&host, &mut effect, 1.0, WHOLE);
    let rest = host.messages().pop().unwrap();
    assert!(
        rest.starts_with("OfxMessageWarning: Parts") && !rest.contains("image") && !rest.contains("settings"),
        "{rest}"
    );
}

#[test]
fn warnings_are_shown_once_and_the_picture_is_drawn() {
    let host = host();
    let untracked = {
        let mut scene = crate::common::scene();
        scene.parts.iter_mut().for_each(|part| part.tracks.clear());
        Document::new(scene).to_json()
    };
    let larger = ClipSettings { x2: 100, y2: 80, ..ClipSettings::default() };
    for (source, document, parts, said) in [
        (ClipSettings::default(), document(), "star, leg, arm*", "no part \"leg\"; the document has \"star\""),
        (ClipSettings::default(), untracked, "", "not tracked"),
        (larger, document(), "", "64x48"),
    ] {
        let mut effect = effect(&host, FILTER, &source);
        effect.set_text("document", &document);
        effect.set_text("parts", parts);
        effect.set("output", &[MATTE]);
        let _ = (host.log(), host.messages());
        for _ in 0..3 {
            rendered(&host, &mut effect, 0.0, WHOLE);
        }
        let messages = host.messages();
        assert!(messages.iter().any(|text| text.contains(said)), "{messages:?}");
        let unique: std::collections::BTreeSet<_> = messages.iter().collect();
        assert_eq!(unique.len(), messages.len(), "{messages:?}");
    }
}

#[test]
fn nothing_is_drawn_beyond_the_tracks_and_without_a_source() {
    let host = host();
    let mut effect = effect(&host, GENERAL, &ClipSettings { connected: false, ..ClipSettings::default() });
    for output in [CUTOUT, MATTE, OVERLAY, IDS] {
        effect.set("output", &[output]);
        let picture = rendered(&host, &mut effect, 2.0, WHOLE);
        assert_eq!(picture.values.iter().all(|v| *v == 0.0), output == CUTOUT, "{output}");
        for time in [-1.0, 77.0, 1e12, f64::NAN] {
            let picture = rendered(&host, &mut effect, time, WHOLE);
            assert!(picture.values.iter().all(|v| *v == 0.0), "{output} {time}");
        }
    }
}

#[test]
fn a_host_with_few_suites_and_no_images() {
    let mut host = host();
    let missing =
        ["OfxMessageSuite", "OfxProgressSuite", "OfxMultiThreadSuite", "OfxTimeLineSuite", "OfxInteractSuite"];
    let missing_suites = missing.map(String::from).to_vec();
    host.configure(&Settings { missing_suites: missing_suites.clone(), ..Settings::default() });
    // Suites are fetched when the plugin is loaded.
    host.reload(bundles());
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    rendered(&host, &mut effect, 1.0, WHOLE);
    effect.set_text("document", "nonsense");
    assert_eq!(effect.render(1.0, WHOLE, 1.0, 1, 0), "kOfxStatFailed");
    host.configure(&Settings { no_images: true, missing_suites, ..Settings::default() });
    effect.set_text("document", &document());
    assert_eq!(effect.render(1.0, WHOLE, 1.0, 1, 0), "kOfxStatFailed");
    assert_eq!(effect.press("track"), "kOfxStatFailed");
    assert_eq!((host.live_images(), effect.destroy().as_str()), (0, OK));
}

#[test]
fn a_file_that_changes_is_read_again() {
    let host = host();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.json");
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set("output", &[MATTE]);
    effect.set_text("document", "");
    // A script sets the project file, and no host reports that. The effect reads the file itself.
    std::fs::write(&file, rectangle()).unwrap();
    effect.set_text_silently("project", file.to_str().unwrap());
    let area = |picture: rototoon_ofx_host::Picture| picture.values.iter().sum::<f32>() / 4.0;
    assert!((area(rendered(&host, &mut effect, 1.0, WHOLE)) - 180.0).abs() < 1e-2);
    std::fs::write(&file, rectangle().replace("30", "29")).unwrap();
    assert!((area(rendered(&host, &mut effect, 1.0, WHOLE)) - 170.0).abs() < 1e-2);
    std::fs::remove_file(&file).unwrap();
    assert_eq!(effect.render(1.0, WHOLE, 1.0, 1, 0), "kOfxStatFailed");
    assert!(host.messages().iter().any(|text| text.contains("a.json")));
}
