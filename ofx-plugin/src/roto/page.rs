//! The page of the selected part: its settings as parameters of the host, with the host's own keys.
//!
//! When another part is selected, the values and keys of the page are stored for the old part, and those of the new part are
//! set. Both happen within the edit that selects, so that undo takes both back. Where the host interpolates the keys that come back
//! otherwise than before, it gets more of them ([`interpolation`]).

use super::interpolation;
use super::state::{Curve, MOST_FRAMES, PartSettings, State};
use crate::ofx::{Failure, Parameters};
use std::ffi::CStr;

/// The parameters of the page.
pub const IDS: [&CStr; 10] = [
    c"partOn",
    c"partInvert",
    c"partOpacity",
    c"partGrow",
    c"partFeather",
    c"partFalloff",
    c"partFalloffCurve",
    c"partMode",
    c"partLock",
    COLOUR,
];
/// The colour of the part. Black stands for none.
const COLOUR: &CStr = c"partColor";

/// The settings that the page shows.
pub fn read(parameters: &Parameters) -> Result<PartSettings, Failure> {
    let flag = |id| curve(parameters, id, &|time| parameters.int(id, time).map(f64::from));
    let number = |id| curve(parameters, id, &|time| parameters.double(id, time));
    let modes = flag(c"partMode")?;
    Ok(PartSettings {
        on: flag(c"partOn")?,
        invert: flag(c"partInvert")?,
        opacity: number(c"partOpacity")?,
        grow: number(c"partGrow")?,
        feather: number(c"partFeather")?,
        mode: modes.at(f64::NEG_INFINITY).max(0.0) as usize,
        modes: (!modes.keys.is_empty()).then_some(modes),
        lock: parameters.int(c"partLock", 0.0)? != 0,
        falloff: number(c"partFalloff")?,
        falloff_curve: flag(c"partFalloffCurve")?,
        colour: colour(parameters)?,
    })
}

/// The colour that the user has chosen.
pub fn colour(parameters: &Parameters) -> Result<Option<[f64; 3]>, Failure> {
    let found = parameters.shade(COLOUR)?.map(|value| if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 });
    Ok((found != [0.0; 3]).then_some(found))
}

/// Whether a parameter of the page has its default.
pub fn is_default(parameters: &Parameters, id: &str) -> Result<bool, Failure> {
    let (found, default) = (read(parameters)?, PartSettings::default());
    Ok(match id {
        "partOn" => found.on == default.on,
        "partInvert" => found.invert == default.invert,
        "partOpacity" => found.opacity == default.opacity,
        "partGrow" => found.grow == default.grow,
        "partFeather" => found.feather == default.feather,
        "partFalloff" => found.falloff == default.falloff,
        "partFalloffCurve" => found.falloff_curve == default.falloff_curve,
        "partColor" => found.colour == default.colour,
        "partMode" => (found.mode, found.modes) == (default.mode, default.modes),
        _ => found.lock == default.lock,
    })
}

fn curve(parameters: &Parameters, id: &CStr, at: &dyn Fn(f64) -> Result<f64, Failure>) -> Result<Curve, Failure> {
    let times = parameters.keys(id)?;
    let mut curve = Curve::still(at(times.first().copied().unwrap_or(0.0))?);
    let (Some(&first), Some(&last)) = (times.first(), times.last()) else { return Ok(curve) };
    for time in times {
        curve.keys.push([time, at(time)?]);
    }
    curve.first = first.floor() as i32;
    let end = (last.ceil() as i32).min(curve.first.saturating_add(MOST_FRAMES));
    for frame in curve.first..=end {
        curve.frames.push(at(f64::from(frame))?);
    }
    Ok(curve)
}

/// Shows settings.
pub fn show(parameters: &Parameters, settings: &PartSettings) -> Result<(), Failure> {
    for (id, curve) in [(c"partOn", &settings.on), (c"partInvert", &settings.invert)] {
        whole(parameters, id, curve, &|value| (value > 0.5).into())?;
    }
    for (id, curve) in [
        (c"partOpacity", &settings.opacity),
        (c"partGrow", &settings.grow),
        (c"partFeather", &settings.feather),
        (c"partFalloff", &settings.falloff),
    ] {
        set(parameters, id, curve, &|time| parameters.double(id, time), &|time, value| match time {
            Some(time) => parameters.set_double_at(id, time, value),
            None => parameters.set_double(id, value),
        })?;
    }
    let modes = settings.modes.clone().unwrap_or_else(|| Curve::still(settings.mode as f64));
    for (id, curve) in [(c"partMode", &modes), (c"partFalloffCurve", &settings.falloff_curve)] {
        whole(parameters, id, curve, &|value| value.max(0.0) as i32)?;
    }
    // Hosts may keep colours as floats. One that is there already is left, so that undo does not report it.
    if colour(parameters)?.map(|c| c.map(|v| v as f32)) != settings.colour.map(|c| c.map(|v| v as f32)) {
        parameters.set_shade(COLOUR, settings.colour.unwrap_or_default())?;
    }
    whole(parameters, c"partLock", &Curve::still(settings.lock.into()), &|value| (value > 0.5).into())
}

/// Sets a whole number or a flag.
fn whole(parameters: &Parameters, id: &CStr, curve: &Curve, of: &dyn Fn(f64) -> i32) -> Result<(), Failure> {
    let mut curve = curve.clone();
    let values = curve.keys.iter_mut().map(|key| &mut key[1]).chain(&mut curve.frames).chain([&mut curve.value]);
    values.for_each(|value| *value = of(*value).into());
    set(parameters, id, &curve, &|time| parameters.int(id, time).map(f64::from), &|time, value| match time {
        Some(time) => parameters.set_int_at(id, time, value as i32),
        None => parameters.set_int(id, value as i32),
    })
}

/// Sets a parameter to a curve. A value that is there already is left, so that undo does not report it. `read` gives the value at
/// a time, `put` sets a value at a time, or for all times.
fn set(
    parameters: &Parameters,
    id: &CStr,
    curve: &Curve,
    read: &dyn Fn(f64) -> Result<f64, Failure>,
    put: &dyn Fn(Option<f64>, f64) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let keyed = !parameters.keys(id)?.is_empty();
    if keyed {
        parameters.delete_keys(id)?;
    }
    if curve.keys.is_empty() {
        return if !keyed && read(0.0)? == curve.value { Ok(()) } else { put(None, curve.value) };
    }
    curve.keys.iter().try_for_each(|&[time, value]| put(Some(time), value))?;
    if parameters.keys(id)?.is_empty() {
        // The host has no keys for this parameter.
        return Ok(());
    }
    interpolation::keep(curve, read, &|time, value| put(Some(time), value))
}

/// Stores the page's settings for the part that it shows.
pub fn stored(parameters: &Parameters, state: &mut State) -> Result<(), Failure> {
    if !state.page.is_empty() {
        let settings = read(parameters)?;
        if settings == PartSettings::default() {
            state.parts.remove(&state.page);
        } else {
            state.parts.insert(state.page.clone(), settings);
        }
    }
    Ok(())
}

/// Shows another part on the page; an empty name shows none.
pub fn turn(parameters: &Parameters, state: &mut State, name: &str) -> Result<(), Failure> {
    if state.page == name {
        return Ok(());
    }
    stored(parameters, state)?;
    name.clone_into(&mut state.page);
    show(parameters, &state.parts.get(name).cloned().unwrap_or_default())
}
