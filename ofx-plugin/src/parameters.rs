//! Describes the core's lists of effect parameters ([`rototoon::scene::effects`]) to a host.

use crate::ofx::{Failure, Parameters, Properties, host};
use openfx::sys::generic::core::{kOfxPropLabel, kOfxPropLongLabel, kOfxPropShortLabel};
use openfx::sys::image_effect_v1::param::{
    kOfxParamHostPropSupportsChoiceAnimation, kOfxParamPropAnimates, kOfxParamPropCanUndo, kOfxParamPropChoiceOption,
    kOfxParamPropDefault, kOfxParamPropDigits, kOfxParamPropDisplayMax, kOfxParamPropDisplayMin, kOfxParamPropEnabled,
    kOfxParamPropEvaluateOnChange, kOfxParamPropHint, kOfxParamPropIncrement, kOfxParamPropMax, kOfxParamPropMin,
    kOfxParamPropParent, kOfxParamPropPersistant, kOfxParamPropSecret, kOfxParamPropStringFilePathExists,
    kOfxParamPropStringMode, kOfxParamStringIsFilePath, kOfxParamStringIsSingleLine, kOfxParamTypeBoolean,
    kOfxParamTypeChoice, kOfxParamTypeDouble, kOfxParamTypeDouble2D, kOfxParamTypeGroup, kOfxParamTypeInteger,
    kOfxParamTypePushButton, kOfxParamTypeRGB, kOfxParamTypeRGBA, kOfxParamTypeString,
};
use rototoon::scene::effects::{EffectKind, EffectParameter};
use rototoon::scene::parameters::{self, Kind};
use std::ffi::{CStr, CString};

const ENDS: [&CStr; 4] = [kOfxParamPropMin, kOfxParamPropMax, kOfxParamPropDisplayMin, kOfxParamPropDisplayMax];

/// Greatest value of a mark: more parts than a document has.
const MOST_MARKED: i32 = 1_000_000;
/// Greatest coordinate of a pair of numbers.
const PLANE: f64 = 1e6;

/// Beginnings of the names of hosts that use the display range for sliders only. Others may refuse values outside of it, so
/// they get the complete range as display range.
const SLIDER_HOSTS: [&str; 8] = [
    "uk.co.thefoundry.nuke",
    "fr.inria.Natron",
    "com.eyeonline.Fusion",
    "com.blackmagicdesign.Fusion",
    "DaVinciResolve",
    "com.apple.shake",
    "com.assimilate",
    "com.borisfx.silhouette",
];

/// The ends of a range and of its slider.
fn ends<T: Copy>(range: [T; 2], slider: [T; 2]) -> [T; 4] {
    let name = host::name().unwrap_or_default();
    let [low, high] = if SLIDER_HOSTS.iter().any(|known| name.starts_with(known)) { slider } else { range };
    [range[0], range[1], low, high]
}

/// Describes every parameter of a list.
pub fn define(list: &[EffectParameter], parameters: &Parameters) -> Result<(), Failure> {
    for parameter in list {
        let properties = parameters.define(type_of(&parameter.kind), &terminated(parameter.id)?)?;
        for name in [kOfxPropLabel, kOfxPropShortLabel, kOfxPropLongLabel] {
            properties.set_text(name, 0, parameter.label)?;
        }
        properties.set_text(kOfxParamPropHint, 0, parameter.help)?;
        if let Some(group) = parameter.group {
            properties.set_text(kOfxParamPropParent, 0, group)?;
        }
        values(&parameter.kind, &properties)?;
    }
    Ok(())
}

fn terminated(id: &str) -> Result<CString, Failure> {
    CString::new(id).map_err(|_| Failure::Told(format!("the parameter id {id:?} contains a zero byte")))
}

fn type_of(kind: &EffectKind) -> &'static CStr {
    match kind {
        EffectKind::File | EffectKind::Text | EffectKind::Hidden | EffectKind::Note | EffectKind::Shown => {
            kOfxParamTypeString
        }
        EffectKind::Button => kOfxParamTypePushButton,
        EffectKind::Flag(_) => kOfxParamTypeBoolean,
        EffectKind::Integer(..) | EffectKind::Mark => kOfxParamTypeInteger,
        EffectKind::Number(..) => kOfxParamTypeDouble,
        EffectKind::Choice(_) | EffectKind::KeyedChoice(_) | EffectKind::Shared(_) | EffectKind::Menu(_) => {
            kOfxParamTypeChoice
        }
        EffectKind::Colour(_) => kOfxParamTypeRGBA,
        EffectKind::Shade(_) => kOfxParamTypeRGB,
        EffectKind::Pair(_) => kOfxParamTypeDouble2D,
        EffectKind::Group(_) => kOfxParamTypeGroup,
    }
}

/// Sets the default, the range and the choices of a parameter.
fn values(kind: &EffectKind, properties: &Properties) -> Result<(), Failure> {
    match *kind {
        EffectKind::File | EffectKind::Text | EffectKind::Hidden | EffectKind::Note | EffectKind::Shown => {
            text(kind, properties)
        }
        EffectKind::Button | EffectKind::Group(_) => Ok(()),
        EffectKind::Flag(default) => properties.set_int(kOfxParamPropDefault, 0, default.into()),
        EffectKind::Mark => mark(properties),
        EffectKind::Integer(default, range, slider) => {
            properties.set_int(kOfxParamPropDefault, 0, default)?;
            let ends = ENDS.into_iter().zip(ends(range, slider));
            ends.into_iter().try_for_each(|(name, value)| properties.set_int(name, 0, value))
        }
        EffectKind::Number(default, range, slider) => {
            properties.set_double(kOfxParamPropDefault, 0, default)?;
            for (name, value) in ENDS.into_iter().zip(ends(range, slider)) {
                properties.set_double(name, 0, value)?;
            }
            properties.set_double(kOfxParamPropIncrement, 0, 0.1)?;
            properties.set_int(kOfxParamPropDigits, 0, 2)
        }
        EffectKind::Choice(labels) => choice(labels.iter().copied(), 0, properties),
        EffectKind::KeyedChoice(labels) => {
            choice(labels.iter().copied(), 0, properties)?;
            let keys = host::properties()?.int(kOfxParamHostPropSupportsChoiceAnimation, 0);
            properties.set_int(kOfxParamPropAnimates, 0, keys.is_ok_and(|keys| keys != 0).into())
        }
        EffectKind::Shared(id) => {
            let (choices, default) = shared(id);
            choice(choices.iter().map(|(_, label)| *label), default, properties)
        }
        EffectKind::Menu(first) => menu(first, properties),
        EffectKind::Pair(default) => {
            properties.set_doubles(kOfxParamPropDefault, &default)?;
            // Some hosts need a range of every number.
            for (name, value) in ENDS.into_iter().zip([-PLANE, PLANE, -PLANE, PLANE]) {
                properties.set_doubles(name, &[value; 2])?;
            }
            properties.set_int(kOfxParamPropDigits, 0, 2)
        }
        EffectKind::Colour(default) => properties.set_doubles(kOfxParamPropDefault, &default),
        EffectKind::Shade(default) => {
            properties.set_int(kOfxParamPropAnimates, 0, 0)?;
            properties.set_doubles(kOfxParamPropDefault, &default)
        }
    }
}

/// A number whose keys are marks in the host's timeline. The picture does not depend on it.
fn mark(properties: &Properties) -> Result<(), Failure> {
    properties.set_int(kOfxParamPropDefault, 0, 0)?;
    for (name, value) in ENDS.into_iter().zip([0, MOST_MARKED, 0, MOST_MARKED]) {
        properties.set_int(name, 0, value)?;
    }
    // Some hosts do not have this property. They then render once more than needed.
    let _ = properties.set_int(kOfxParamPropEvaluateOnChange, 0, 0);
    Ok(())
}

fn text(kind: &EffectKind, properties: &Properties) -> Result<(), Failure> {
    properties.set_int(kOfxParamPropAnimates, 0, 0)?;
    if *kind == EffectKind::File {
        properties.set_name(kOfxParamPropStringMode, 0, kOfxParamStringIsFilePath)?;
        // The user may choose a file that does not exist yet, to save to it.
        return properties.set_int(kOfxParamPropStringFilePathExists, 0, 0);
    }
    properties.set_name(kOfxParamPropStringMode, 0, kOfxParamStringIsSingleLine)?;
    match kind {
        EffectKind::Hidden => properties.set_int(kOfxParamPropSecret, 0, 1),
        EffectKind::Note => {
            for name in [kOfxParamPropEvaluateOnChange, kOfxParamPropCanUndo] {
                let _ = properties.set_int(name, 0, 0);
            }
            properties.set_int(kOfxParamPropSecret, 0, 1)
        }
        EffectKind::Shown => {
            // Nothing is read from it, so a host in which the user can change it is no worse.
            for name in [kOfxParamPropEvaluateOnChange, kOfxParamPropEnabled] {
                let _ = properties.set_int(name, 0, 0);
            }
            Ok(())
        }
        _ => Ok(()),
    }
}

/// A choice whose options the effect sets. Hosts in which the options stay as they are described do not show it. It repeats
/// what a text says, so it is neither stored nor a step of undo. Some hosts do not have these two properties.
fn menu(first: &str, properties: &Properties) -> Result<(), Failure> {
    choice([first].into_iter(), 0, properties)?;
    for name in [kOfxParamPropPersistant, kOfxParamPropCanUndo, kOfxParamPropEvaluateOnChange] {
        let _ = properties.set_int(name, 0, 0);
    }
    properties.set_int(kOfxParamPropSecret, 0, (!host::changes_menus()).into())
}

fn choice<'a>(labels: impl Iterator<Item = &'a str>, default: i32, properties: &Properties) -> Result<(), Failure> {
    properties.set_int(kOfxParamPropAnimates, 0, 0)?;
    for (index, label) in labels.enumerate() {
        properties.set_text(kOfxParamPropChoiceOption, index as i32, label)?;
    }
    properties.set_int(kOfxParamPropDefault, 0, default)
}

/// The ids and labels of the core's choice parameter `id`, and the index of its default.
pub fn shared(id: &str) -> (Vec<(&'static str, &'static str)>, i32) {
    match parameters::find(id).map(|parameter| parameter.kind) {
        Some(Kind::Choice { default, choices }) => {
            let known = choices.iter().map(|choice| (choice.id, choice.label)).collect();
            let index = choices.iter().position(|choice| choice.id == default).unwrap_or(0);
            (known, index as i32)
        }
        _ => (Vec::new(), 0),
    }
}
