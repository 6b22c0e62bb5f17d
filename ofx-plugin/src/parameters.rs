//! What parameters are made of, and how a host is told.
//!
//! Choices and ranges that the command line and the add-on have too are core's ([`rototoon::scene::parameters`]).

use crate::ofx::{Failure, Parameters};
use openfx::sys::generic::core::{kOfxPropLabel, kOfxPropLongLabel, kOfxPropShortLabel};
use openfx::sys::image_effect_v1::param::{
    kOfxParamPropAnimates, kOfxParamPropChoiceOption, kOfxParamPropDefault, kOfxParamPropDigits,
    kOfxParamPropDisplayMax, kOfxParamPropDisplayMin, kOfxParamPropHint, kOfxParamPropIncrement, kOfxParamPropMax,
    kOfxParamPropMin, kOfxParamPropParent, kOfxParamPropSecret, kOfxParamPropStringFilePathExists,
    kOfxParamPropStringMode, kOfxParamStringIsFilePath, kOfxParamStringIsSingleLine, kOfxParamTypeBoolean,
    kOfxParamTypeChoice, kOfxParamTypeDouble, kOfxParamTypeGroup, kOfxParamTypeInteger, kOfxParamTypePushButton,
    kOfxParamTypeRGBA, kOfxParamTypeString,
};
use rototoon::scene::parameters::{self, Kind as CoreKind};
use std::ffi::CStr;

/// Which values a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// The path of a file.
    File,
    /// A line of text.
    Text,
    /// Text that the user does not see.
    Hidden,
    /// A button.
    Button,
    /// On or off.
    Flag(bool),
    /// A whole number: default, least, greatest, and the ends of the slider.
    Integer(i32, [i32; 2], [i32; 2]),
    /// A number: default, least, greatest, and the ends of the slider.
    Number(f64, [f64; 2], [f64; 2]),
    /// One of several, by index: labels.
    Choice(&'static [&'static str]),
    /// One of core's choices, by the id of core's parameter.
    Shared(&'static str),
    /// A colour with opacity.
    Colour([f64; 4]),
    /// A group, open or not.
    Group(bool),
}

/// A parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its id, fixed for ever.
    pub id: &'static CStr,
    /// A few words, for people.
    pub label: &'static str,
    /// A sentence, for people.
    pub help: &'static str,
    /// Which values it takes.
    pub kind: Kind,
    /// The group that shows it.
    pub group: Option<&'static CStr>,
}

impl Parameter {
    /// Describes it.
    pub fn define(&self, parameters: &Parameters) -> Result<(), Failure> {
        let (kind, animates) = match self.kind {
            Kind::File | Kind::Text | Kind::Hidden => (kOfxParamTypeString, Some(false)),
            Kind::Button => (kOfxParamTypePushButton, None),
            Kind::Flag(_) => (kOfxParamTypeBoolean, None),
            Kind::Integer(..) => (kOfxParamTypeInteger, None),
            Kind::Number(..) => (kOfxParamTypeDouble, None),
            Kind::Choice(_) | Kind::Shared(_) => (kOfxParamTypeChoice, Some(false)),
            Kind::Colour(_) => (kOfxParamTypeRGBA, None),
            Kind::Group(_) => (kOfxParamTypeGroup, None),
        };
        let properties = parameters.define(kind, self.id)?;
        for name in [kOfxPropLabel, kOfxPropShortLabel, kOfxPropLongLabel] {
            properties.set_text(name, 0, self.label)?;
        }
        properties.set_text(kOfxParamPropHint, 0, self.help)?;
        if let Some(group) = self.group {
            properties.set_name(kOfxParamPropParent, 0, group)?;
        }
        if let Some(animates) = animates {
            properties.set_int(kOfxParamPropAnimates, 0, animates.into())?;
        }
        match self.kind {
            Kind::File => {
                properties.set_name(kOfxParamPropStringMode, 0, kOfxParamStringIsFilePath)?;
                // A file may be chosen that is yet to be saved.
                properties.set_int(kOfxParamPropStringFilePathExists, 0, 0)?;
            }
            Kind::Text => properties.set_name(kOfxParamPropStringMode, 0, kOfxParamStringIsSingleLine)?,
            Kind::Hidden => {
                properties.set_name(kOfxParamPropStringMode, 0, kOfxParamStringIsSingleLine)?;
                properties.set_int(kOfxParamPropSecret, 0, 1)?;
            }
            Kind::Button | Kind::Group(_) => {}
            Kind::Flag(default) => properties.set_int(kOfxParamPropDefault, 0, default.into())?,
            Kind::Integer(default, range, slider) => {
                properties.set_int(kOfxParamPropDefault, 0, default)?;
                let ends = [kOfxParamPropMin, kOfxParamPropMax, kOfxParamPropDisplayMin, kOfxParamPropDisplayMax];
                for (name, value) in ends.into_iter().zip(range.into_iter().chain(slider)) {
                    properties.set_int(name, 0, value)?;
                }
            }
            Kind::Number(default, range, slider) => {
                properties.set_double(kOfxParamPropDefault, 0, default)?;
                let ends = [kOfxParamPropMin, kOfxParamPropMax, kOfxParamPropDisplayMin, kOfxParamPropDisplayMax];
                for (name, value) in ends.into_iter().zip(range.into_iter().chain(slider)) {
                    properties.set_double(name, 0, value)?;
                }
                properties.set_double(kOfxParamPropIncrement, 0, 0.1)?;
                properties.set_int(kOfxParamPropDigits, 0, 2)?;
            }
            Kind::Choice(labels) => {
                for (index, label) in labels.iter().enumerate() {
                    properties.set_text(kOfxParamPropChoiceOption, index as i32, label)?;
                }
                properties.set_int(kOfxParamPropDefault, 0, 0)?;
            }
            Kind::Shared(id) => {
                let (choices, default) = shared(id);
                for (index, (_, label)) in choices.iter().enumerate() {
                    properties.set_text(kOfxParamPropChoiceOption, index as i32, label)?;
                }
                properties.set_int(kOfxParamPropDefault, 0, default)?;
            }
            Kind::Colour(default) => properties.set_doubles(kOfxParamPropDefault, &default)?,
        }
        Ok(())
    }
}

/// Ids and labels of one of core's choices, and the index of the default.
pub fn shared(id: &str) -> (Vec<(&'static str, &'static str)>, i32) {
    match parameters::find(id).map(|parameter| parameter.kind) {
        Some(CoreKind::Choice { default, choices }) => {
            let known = choices.iter().map(|choice| (choice.id, choice.label)).collect();
            let index = choices.iter().position(|choice| choice.id == default).unwrap_or(0);
            (known, index as i32)
        }
        _ => (Vec::new(), 0),
    }
}
