//! Tests of contexts, parameters and loading again.

use crate::common::{FILTER, GENERAL, OK, ROTO, WHOLE, bundles, clean, effect, host, rendered};
use rototoon::scene::effects::EffectKind;
use rototoon_ofx_host::{ClipSettings, Host, Settings};

/// The parameters of the first version.
const OLD: [&str; 24] = [
    "shapes",
    "project",
    "load",
    "save",
    "document",
    "frameOffset",
    "parts",
    "useCurves",
    "picture",
    "output",
    "invert",
    "grow",
    "feather",
    "motionBlur",
    "motionBlurSamples",
    "lines",
    "lineWidth",
    "lineColor",
    "opacity",
    "tracking",
    "preset",
    "firstFrame",
    "lastFrame",
    "track",
];

#[test]
fn the_effect_is_described_in_each_of_its_contexts() {
    let host = host();
    assert!(host.plugins().iter().any(|id| id == ROTO), "{:?}", host.plugins());
    assert_eq!(host.contexts(ROTO), [FILTER, GENERAL]);
    for context in [FILTER, GENERAL] {
        let mut effect = host.effect(ROTO, context);
        let ids: Vec<&str> = rototoon::scene::effects::ROTO.iter().map(|parameter| parameter.id).collect();
        assert_eq!(effect.parameters(), ids);
        // Compositions name these. They stay for ever.
        for old in OLD {
            assert!(ids.contains(&old), "{old}");
        }
        assert_eq!(effect.create(), OK);
        assert_eq!(effect.destroy(), OK);
    }
    clean(&host);
}

#[test]
fn numbers_have_ranges_and_choices_their_order() {
    let host = host();
    let effect = host.effect(ROTO, FILTER);
    // A number without a range is limited to -1 to 1 in Resolve, and one without the ends of a slider too.
    let mut numbers = 0;
    for parameter in &rototoon::scene::effects::ROTO {
        let dimensions = match parameter.kind {
            EffectKind::Integer(..) | EffectKind::Number(..) | EffectKind::Mark => 1,
            EffectKind::Pair(_) => 2,
            _ => continue,
        };
        for property in ["OfxParamPropMin", "OfxParamPropMax", "OfxParamPropDisplayMin", "OfxParamPropDisplayMax"] {
            for index in 0..dimensions {
                let id = parameter.id;
                let value: f64 = effect.parameter_property(id, property, index).parse().unwrap();
                assert!(value.abs() <= 1e6, "{id} {property}");
                numbers += 1;
            }
        }
    }
    assert!(numbers > 100, "{numbers}");
    let options = |id| (0..9).map(|k| effect.parameter_property(id, "OfxParamPropChoiceOption", k)).collect::<Vec<_>>();
    // Compositions store the index. New outputs come last.
    let outputs = ["Cutout", "Matte", "Overlay", "Ids", "Mattes", "Paint", "Painted", "Lines", "Cel"];
    assert_eq!(options("output"), outputs);
    assert_eq!(options("preset")[..2], ["Rototoon", "Zhou & Xiao 2011"]);
    assert_eq!(effect.parameter_property("document", "OfxParamPropSecret", 0), "1");
    assert_eq!(effect.parameter_property("project", "OfxParamPropStringMode", 0), "OfxParamStringIsFilePath");
}

#[test]
fn slider_ranges_are_no_limits_in_hosts_that_read_them_so() {
    let mut host = host();
    for (name, grow, feather) in [("MLT", 1000.0, 500.0), ("uk.co.thefoundry.nuke", 20.0, 50.0)] {
        host.configure(&Settings { name: name.into(), ..Settings::default() });
        host.reload(bundles());
        let effect = host.effect(ROTO, FILTER);
        let most = |id: &str| effect.parameter_property(id, "OfxParamPropDisplayMax", 0).parse::<f64>().unwrap();
        assert_eq!((most("grow"), most("feather")), (grow, feather), "{name}");
        for id in ["frameOffset", "firstFrame", "lastFrame", "shownFirst", "shownLast"] {
            assert_eq!(most(id), 1e6, "{name} {id}");
        }
    }
}

#[test]
fn it_works_after_it_was_unloaded() {
    let mut host = host();
    let draw = |host: &Host| {
        let mut effect = effect(host, FILTER, &ClipSettings::default());
        rendered(host, &mut effect, 1.0, WHOLE)
    };
    let first = draw(&host);
    for _ in 0..2 {
        host.reload(bundles());
        assert!(draw(&host) == first);
    }
    let log = host.log();
    assert!(!log.iter().any(|line| line.contains("kOfxStatErr")));
}

#[test]
fn unknown_actions_are_left_to_the_host() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    assert_eq!(effect.action("OfxActionOfTheFuture"), "kOfxStatReplyDefault");
    assert_eq!(effect.action("OfxActionPurgeCaches"), OK);
    clean(&host);
}
