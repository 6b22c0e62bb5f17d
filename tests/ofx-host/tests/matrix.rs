//! The matrix of what hosts do: each behaviour with each output. None may crash, leave an image, or change the picture.

use crate::common::{
    CELS, FILTER, GENERAL, HEIGHT, IDS, MATTE, OK, OUTPUTS, ROTO, WHOLE, WIDTH, bundles, document, drawn_document,
    effect, footage, host, kept, p, part, pattern, rendered, scene,
};
use rototoon::project::Document;
use rototoon::scene::Scene;
use rototoon_ofx_host::{Bounds, ClipSettings, Effect, Host, Picture, Settings};

fn chosen<'a>(host: &'a Host, context: &str, source: &ClipSettings, output: f64) -> Effect<'a> {
    let mut effect = effect(host, context, source);
    effect.set("output", &[output]);
    effect.set_text("redParts", "star");
    effect.set_text("document", &drawn_document());
    effect
}

fn plain(host: &Host, output: f64) -> Picture {
    host.configure(&Settings::default());
    let mut effect = chosen(host, FILTER, &ClipSettings::default(), output);
    rendered(host, &mut effect, 2.0, WHOLE)
}

/// Most difference of two pictures of the same size.
fn apart(a: &Picture, b: &Picture) -> f32 {
    assert_eq!((a.width, a.height, a.channels), (b.width, b.height, b.channels));
    a.values.iter().zip(&b.values).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn hosts_of_every_kind_show_the_same_picture() {
    let mut host = host();
    let suites = [
        "OfxMessageSuite",
        "OfxProgressSuite",
        "OfxMultiThreadSuite",
        "OfxTimeLineSuite",
        "OfxInteractSuite",
        "OfxDrawSuite",
    ];
    let names = ["MLT", "uk.co.thefoundry.hiero", "DaVinciResolve", "fr.inria.Magic", "com.eyeonline.Fusion"];
    let mut kinds: Vec<Settings> =
        suites.iter().map(|suite| Settings { missing_suites: vec![(*suite).into()], ..Settings::default() }).collect();
    // A host of OpenFX 1.0 has the first message suite only.
    kinds.push(Settings { missing_suites: vec!["OfxMessageSuite/2".into()], ..Settings::default() });
    kinds.push(Settings { missing_suites: suites.map(String::from).to_vec(), ..Settings::default() });
    kinds.extend(names.iter().map(|name| Settings { name: (*name).into(), ..Settings::default() }));
    kinds.push(Settings { multi_resolution: false, tiles: false, ..Settings::default() });
    kinds.push(Settings { cpus: 7, ..Settings::default() });
    kinds.push(Settings { cpus: 0, ..Settings::default() });
    kinds.push(Settings { temporal: false, ..Settings::default() });
    let mut cases = 0;
    for output in OUTPUTS {
        let wanted = plain(&host, output);
        for kind in &kinds {
            host.configure(kind);
            host.reload(bundles());
            // Ids and paint of hosts with linear light are light.
            if kind.name.contains("Fusion") && (output == IDS || CELS.contains(&output)) {
                continue;
            }
            for context in [FILTER, GENERAL] {
                let mut effect = chosen(&host, context, &ClipSettings::default(), output);
                assert!(apart(&rendered(&host, &mut effect, 2.0, WHOLE), &wanted) < 1e-6, "{output} {kind:?}");
                assert_eq!(effect.destroy(), OK);
                cases += 1;
            }
            host.configure(&Settings::default());
            host.reload(bundles());
        }
    }
    println!("{cases} cases");
    assert!(cases > 250, "{cases}");
}

#[test]
fn origins_rows_and_margins_show_the_same_picture() {
    let host = host();
    let mut cases = 0;
    for output in OUTPUTS {
        let wanted = plain(&host, output);
        for top_down in [false, true] {
            for (padding, margin) in [(0, 0), (12, 3)] {
                for (threads, rows) in [(1, 0), (3, 7)] {
                    let source = ClipSettings { top_down, padding, margin, ..ClipSettings::default() };
                    let mut effect = chosen(&host, FILTER, &source, output);
                    assert_eq!(effect.render(2.0, WHOLE, 1.0, threads, rows), OK);
                    let found = effect.output();
                    assert_eq!((found.damage, found.untouched), (0, 0));
                    assert!(apart(&found, &wanted) < 1e-6, "{output} {top_down} {padding} {threads}");
                    cases += 1;
                }
            }
        }
        // A picture that does not begin at the origin: the shapes go with the source.
        let (x, y) = (-17, 9);
        let source = ClipSettings { x1: x, y1: y, x2: x + 64, y2: y + 48, ..ClipSettings::default() };
        let mut effect = chosen(&host, FILTER, &source, output);
        let window = Bounds { x1: x, y1: y, x2: x + 64, y2: y + 48 };
        assert!(apart(&rendered(&host, &mut effect, 2.0, window), &wanted) < 1e-5, "{output}");
        cases += 1;
    }
    println!("{cases} cases");
    assert_eq!(cases, 81);
}

#[test]
fn instances_come_and_go_and_share_one_document() {
    let host = host();
    let wanted = plain(&host, MATTE);
    let mut kept: Vec<Effect> = Vec::new();
    for round in 0..40 {
        let mut effect = chosen(&host, FILTER, &ClipSettings::default(), MATTE);
        assert!(apart(&rendered(&host, &mut effect, 2.0, WHOLE), &wanted) < 1e-6);
        kept.push(effect);
        if round % 3 == 2 {
            assert_eq!(kept.remove(round % kept.len()).destroy(), OK);
        }
        // Those that stay are not disturbed.
        let other = round % kept.len();
        assert!(apart(&rendered(&host, &mut kept[other], 2.0, WHOLE), &wanted) < 1e-6);
    }
}

#[test]
fn instances_of_one_document_parse_it_once() {
    let host = host();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.json");
    std::fs::write(&file, document()).unwrap();
    let written = std::fs::metadata(&file).unwrap().modified().unwrap();
    let node = || {
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        effect.set_text_silently("document", "");
        effect.set_text_silently("project", file.to_str().unwrap());
        effect.set("output", &[MATTE]);
        effect
    };
    let mut first = node();
    let wanted = rendered(&host, &mut first, 2.0, WHOLE);
    // What no one can see: another text of the same length and time. Only who parses it again has other shapes.
    let text = document();
    let mut other = Document::parse(&text, "a").unwrap();
    other.scene.parts.retain(|part| part.name == "star");
    let short = other.to_json();
    std::fs::write(&file, short.clone() + &" ".repeat(text.len() - short.len())).unwrap();
    std::fs::File::options().write(true).open(&file).unwrap().set_modified(written).unwrap();
    let mut second = node();
    assert!(rendered(&host, &mut second, 2.0, WHOLE) == wanted, "it was parsed again");
    // The document goes with the last instance that has it.
    assert_eq!([first.destroy(), second.destroy()], [OK, OK]);
    assert!(rendered(&host, &mut node(), 2.0, WHOLE) != wanted);
}

#[test]
fn actions_in_odd_orders() {
    let host = host();
    let mut effect = chosen(&host, GENERAL, &ClipSettings::default(), MATTE);
    let wanted = rendered(&host, &mut effect, 2.0, WHOLE);
    for action in
        ["OfxActionPurgeCaches", "OfxActionSyncPrivateData", "OfxActionBeginInstanceEdit", "OfxActionEndInstanceEdit"]
    {
        let status = effect.action(action);
        assert!(status == OK || status == "kOfxStatReplyDefault", "{action} {status}");
        assert!(apart(&rendered(&host, &mut effect, 2.0, WHOLE), &wanted) < 1e-6, "{action}");
    }
    // Pen up before down, keys before a document, a draw after the effect has lost its document.
    effect.set_text("document", "");
    for action in
        ["OfxInteractActionPenUp", "OfxInteractActionPenMotion", "OfxInteractActionDraw", "OfxInteractActionLoseFocus"]
    {
        let status = effect.overlay(action, true, 2.0, [1e9, -1e9], 1e-9);
        assert!(status == OK || status == "kOfxStatReplyDefault", "{action} {status}");
    }
    for key in [0, 0xff0d, 0xff08, 0xffff, 0xff1b, 0xffe1, i32::MAX, -1] {
        effect.overlay_key("OfxInteractActionKeyDown", 2.0, key);
        effect.overlay_key("OfxInteractActionKeyUp", 2.0, key);
    }
    for time in [f64::NAN, f64::INFINITY, -1e300, 0.5] {
        effect.overlay("OfxInteractActionPenDown", true, time, [f64::NAN, 1.0], f64::NAN);
        effect.overlay("OfxInteractActionPenUp", true, time, [5.0, 5.0], 0.0);
        effect.overlay("OfxInteractActionDraw", false, time, [0.0; 2], -1.0);
        for button in [
            "newKey",
            "deleteKey",
            "insertPoints",
            "deletePoints",
            "smoothPoints",
            "deletePart",
            "newPart",
            "writeMotion",
            "export",
            "save",
        ] {
            effect.press_at(button, time);
        }
    }
    assert_eq!(effect.text("document"), "");
    assert_eq!(host.live_images(), 0);
}

#[test]
fn a_sequence_with_holes_and_frames_beyond_the_source() {
    let host = host();
    let mut effect = host.effect(ROTO, FILTER);
    let source = ClipSettings { first: -3.0, last: 4.0, ..ClipSettings::default() };
    effect.set_clip("Source", &source);
    effect.set_clip("Output", &source);
    // Frames 1 and 3 are missing: the host gives transparent pictures.
    for frame in [0, 2, 4] {
        effect.set_frame("Source", f64::from(frame), WIDTH, &pattern(frame));
    }
    assert_eq!(effect.create(), OK);
    effect.set_text("document", &document());
    for time in -5..8 {
        let picture = rendered(&host, &mut effect, f64::from(time), WHOLE);
        let seen = picture.values.iter().any(|value| *value != 0.0);
        assert_eq!(seen, [0, 2, 4].contains(&time), "{time}");
    }
    effect.set("output", &[MATTE]);
    for time in -5..8 {
        let picture = rendered(&host, &mut effect, f64::from(time), WHOLE);
        assert_eq!(picture.values.iter().any(|value| *value != 0.0), (0..=4).contains(&time), "{time}");
    }
}

#[test]
fn documents_cut_short_or_huge_are_told() {
    let host = host();
    let text = {
        let mut effect = chosen(&host, FILTER, &ClipSettings::default(), MATTE);
        // An edit stores it encoded.
        assert_eq!(effect.press_at("newKey", 2.0), OK);
        assert_eq!(kept(&effect).scene.parts.len(), scene().parts.len());
        effect.text("document")
    };
    for length in [1, 9, 10, 11, 40, text.len() / 2, text.len() - 5] {
        let mut effect = chosen(&host, FILTER, &ClipSettings::default(), MATTE);
        effect.set_text("document", &text[..length]);
        let _ = (host.log(), host.messages());
        let status = effect.render(2.0, WHOLE, 1.0, 1, 0);
        assert!(status == "kOfxStatFailed", "{length} {status}");
        assert_eq!(host.messages().len(), 1, "{length}");
        // Nothing is drawn over it, and saving refuses.
        assert_eq!(effect.press_at("newKey", 2.0), "kOfxStatFailed");
        assert_eq!(effect.text("document"), text[..length]);
    }
    let _ = host.log();
    let many = 1900;
    let dense = |k: usize| {
        move |f: f64| {
            (0..400)
                .map(|i| {
                    p(
                        20.0 + 18.0 * (0.0157 * i as f64 + f).cos(),
                        20.0 + (k % 20) as f64 + 10.0 * (0.0157 * i as f64).sin(),
                    )
                })
                .collect()
        }
    };
    let parts = (0..many).map(|k| part(&format!("größe {k} 顔"), k as f64, true, dense(k))).collect();
    let large = Document::new(Scene { footage: footage(), parts }).to_json();
    assert!(large.len() > 50_000_000, "{}", large.len());
    let mut effect = chosen(&host, FILTER, &ClipSettings::default(), MATTE);
    effect.set_text("document", &large);
    let window = Bounds { x1: 0, y1: 0, x2: WIDTH as i32, y2: HEIGHT as i32 };
    assert!(rendered(&host, &mut effect, 2.0, window).values.contains(&1.0));
}

#[test]
fn one_file_for_two_nodes_that_goes_away() {
    let host = host();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a größe with space.json");
    std::fs::write(&file, document()).unwrap();
    let mut nodes: Vec<Effect> = (0..2).map(|_| chosen(&host, FILTER, &ClipSettings::default(), MATTE)).collect();
    for node in &mut nodes {
        node.set_text("project", file.to_str().unwrap());
    }
    // One node changes its shapes and saves; the other keeps its own until it loads.
    nodes[0].set_text("part", "star");
    assert_eq!(nodes[0].press("deletePart"), OK);
    assert_eq!(nodes[0].press("save"), OK);
    assert_eq!([kept(&nodes[0]).scene.parts.len(), kept(&nodes[1]).scene.parts.len()], [2, 3]);
    assert_eq!(nodes[1].press("load"), OK);
    assert_eq!(kept(&nodes[1]).scene.parts.len(), 2);
    std::fs::remove_file(&file).unwrap();
    assert_eq!(nodes[1].press("load"), "kOfxStatFailed");
    assert!(host.messages().iter().any(|text| text.contains("größe with space")));
    assert_eq!(kept(&nodes[1]).scene.parts.len(), 2, "the shapes are in the composition");
}

#[test]
fn tiny_and_changing_sources() {
    let host = host();
    for (width, height) in [(1, 1), (1, 48), (64, 1), (640, 480)] {
        let source = ClipSettings { x2: width, y2: height, ..ClipSettings::default() };
        for output in OUTPUTS {
            let mut effect = chosen(&host, FILTER, &ClipSettings::default(), output);
            // The source changes its size after the node was made.
            effect.set_clip("Source", &source);
            effect.set_clip("Output", &source);
            effect.preferences();
            let window = Bounds { x1: 0, y1: 0, x2: width, y2: height };
            assert_eq!(effect.render(2.0, window, 1.0, 1, 0), OK, "{width} {height} {output}");
            assert_eq!(effect.output().untouched, 0);
            effect.region_of_definition(2.0, 1.0);
        }
    }
}
