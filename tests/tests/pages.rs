//! The documentation's tables of the OpenFX parameters are the lists that the plugin is made from.

use rototoon::scene::effects::{EffectKind, EffectParameter, LINES, ROTO};
use rototoon::scene::parameters::{self, Kind};
use rototoon_tests::golden;

const HEAD: &str = "<!-- Generated from core's lists of parameters. Change those, run the tests, then `cargo xtask bless`. -->

# All parameters of the OpenFX nodes

[The OpenFX plugin](../compositor/openfx.md) explains how the nodes are used. The id names a parameter in scripts; it never
changes.
";

/// What a parameter takes, and its default.
fn values(kind: &EffectKind) -> (String, String) {
    let range = |low: f64, high: f64| format!("{low} to {high}");
    match *kind {
        EffectKind::File => ("file".into(), String::new()),
        EffectKind::Text => ("text".into(), "empty".into()),
        EffectKind::Hidden | EffectKind::Note => ("text, hidden".into(), "empty".into()),
        EffectKind::Shown => ("text, set by the node".into(), "empty".into()),
        EffectKind::Menu(first) => (format!("{first}, or a part"), first.into()),
        EffectKind::Button => ("button".into(), String::new()),
        EffectKind::Flag(default) => ("on or off".into(), if default { "on" } else { "off" }.into()),
        EffectKind::Integer(default, [low, high], _) => {
            (format!("whole number, {}", range(low.into(), high.into())), default.to_string())
        }
        EffectKind::Mark => ("whole number, set by the node".into(), "0".into()),
        EffectKind::Number(default, [low, high], _) => (format!("number, {}", range(low, high)), default.to_string()),
        EffectKind::Choice(labels) | EffectKind::KeyedChoice(labels) => {
            (labels.join(", "), labels.first().unwrap_or(&"").to_string())
        }
        EffectKind::Shared(id) => match parameters::find(id).map(|parameter| parameter.kind) {
            Some(Kind::Choice { default, choices }) => {
                let labels: Vec<&str> = choices.iter().map(|choice| choice.label).collect();
                let default = choices.iter().find(|choice| choice.id == default).map_or("", |choice| choice.label);
                (labels.join(", "), default.into())
            }
            other => panic!("{id}: {other:?}, expected a choice"),
        },
        EffectKind::Shade([r, g, b]) => ("colour, without keys".into(), format!("{r}, {g}, {b}")),
        EffectKind::Colour([r, g, b, a]) => ("colour".into(), format!("{r}, {g}, {b}, {a}")),
        EffectKind::Pair([x, y]) => ("two numbers".into(), format!("{x}, {y}")),
        EffectKind::Group(_) => (String::new(), String::new()),
    }
}

/// A heading for the effect and for each of its groups, each with a table.
fn section(page: &mut String, title: &str, list: &[EffectParameter]) {
    *page += &format!("\n## {title}\n");
    let mut table = false;
    for parameter in list {
        if matches!(parameter.kind, EffectKind::Group(_)) {
            *page += &format!("\n### {}\n\n{}\n", parameter.label, parameter.help);
            table = false;
            continue;
        }
        if !table {
            *page += "\n| parameter | id | values | default | help |\n| --- | --- | --- | --- | --- |\n";
            table = true;
        }
        let (values, default) = values(&parameter.kind);
        let EffectParameter { label, id, help, .. } = parameter;
        *page += &format!("| {label} | `{id}` | {values} | {default} | {help} |\n");
    }
}

#[test]
fn the_page_of_openfx_parameters_is_current() {
    let mut page = HEAD.to_owned();
    section(&mut page, "Rototoon Roto", &ROTO);
    section(&mut page, "Rototoon Lines", &LINES);
    golden::compare_page("openfx", &page.replace('*', "\\*")).unwrap();
}
