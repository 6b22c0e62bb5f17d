//! The host and its suites.
//!
//! A host may load, unload and load each effect of a bundle again. Every load fetches the suites anew. The suites are static
//! tables of the host.

use super::failure::Failure;
use super::property::Properties;
use openfx::sys::generic::core::{OfxHost, kOfxPropName};
use openfx::sys::generic::property::{OfxPropertySuiteV1, kOfxPropertySuite};
use openfx::sys::image_effect_v1::draw_suite::{OfxDrawSuiteV1, kOfxDrawSuite};
use openfx::sys::image_effect_v1::image_effect::{
    OfxImageEffectSuiteV1, kOfxImageEffectPropSupportsTiles, kOfxImageEffectSuite,
};
use openfx::sys::image_effect_v1::interact::{OfxInteractSuiteV1, kOfxInteractSuite};
use openfx::sys::image_effect_v1::message::{OfxMessageSuiteV1, OfxMessageSuiteV2, kOfxMessageSuite};
use openfx::sys::image_effect_v1::multi_thread::{OfxMultiThreadSuiteV1, kOfxMultiThreadSuite};
use openfx::sys::image_effect_v1::param::{OfxParameterSuiteV1, kOfxParameterSuite};
use openfx::sys::image_effect_v1::progress::{OfxProgressSuiteV1, OfxProgressSuiteV2, kOfxProgressSuite};
use openfx::sys::image_effect_v1::time_line::{OfxTimeLineSuiteV1, kOfxTimeLineSuite};
use std::ffi::CStr;
use std::sync::atomic::{AtomicPtr, Ordering};
use std::sync::{PoisonError, RwLock};

/// Properties of Natron's.
const NATRON: &CStr = c"NatronOfxHostIsNatron";
const MENUS: &CStr = c"NatronOfxParamHostPropSupportsDynamicChoices";

static HOST: AtomicPtr<OfxHost> = AtomicPtr::new(std::ptr::null_mut());
static SUITES: RwLock<Option<Suites>> = RwLock::new(None);

/// The host's suites. All but the first three may be missing.
#[derive(Clone, Copy)]
pub struct Suites {
    pub(super) property: &'static OfxPropertySuiteV1,
    pub(super) effect: &'static OfxImageEffectSuiteV1,
    pub(super) parameter: &'static OfxParameterSuiteV1,
    pub(super) message: Option<&'static OfxMessageSuiteV1>,
    pub(super) persistent: Option<&'static OfxMessageSuiteV2>,
    pub(super) threads: Option<&'static OfxMultiThreadSuiteV1>,
    pub(super) progress: Option<ProgressSuite>,
    pub(super) interact: Option<&'static OfxInteractSuiteV1>,
    pub(super) draw: Option<&'static OfxDrawSuiteV1>,
    pub(super) timeline: Option<&'static OfxTimeLineSuiteV1>,
}

/// The progress suite, in one of its versions.
#[derive(Clone, Copy)]
pub(super) enum ProgressSuite {
    /// Version 1, which takes a label.
    V1(&'static OfxProgressSuiteV1),
    /// Version 2, which takes a label and its id.
    V2(&'static OfxProgressSuiteV2),
}

/// Stores the host.
pub fn set(host: *mut OfxHost) {
    HOST.store(host, Ordering::Release);
}

/// Fetches the suites.
pub fn load() -> Result<(), Failure> {
    let host = HOST.load(Ordering::Acquire);
    // SAFETY: the host calls `setHost` before any action, with a host that lives as long as the plugin is loaded.
    let host = unsafe { host.as_ref() }.ok_or(Failure::Missing("host"))?;
    // Where one function is null, as in Resolve, the other one may be anything.
    let message = suite::<OfxMessageSuiteV2>(host, kOfxMessageSuite, 2);
    let message = message.filter(|suite| suite.setPersistentMessage.is_some());
    let v2 = suite(host, kOfxProgressSuite, 2).map(ProgressSuite::V2);
    let suites = Suites {
        property: suite(host, kOfxPropertySuite, 1).ok_or(Failure::Missing("property suite"))?,
        effect: suite(host, kOfxImageEffectSuite, 1).ok_or(Failure::Missing("image effect suite"))?,
        parameter: suite(host, kOfxParameterSuite, 1).ok_or(Failure::Missing("parameter suite"))?,
        message: suite(host, kOfxMessageSuite, 1),
        persistent: message,
        threads: suite(host, kOfxMultiThreadSuite, 1),
        interact: suite(host, kOfxInteractSuite, 1),
        draw: suite(host, kOfxDrawSuite, 1),
        timeline: suite(host, kOfxTimeLineSuite, 1),
        progress: v2.or_else(|| suite(host, kOfxProgressSuite, 1).map(ProgressSuite::V1)),
    };
    *SUITES.write().unwrap_or_else(PoisonError::into_inner) = Some(suites);
    let name = name().unwrap_or_default();
    let is = |known: &[&str]| known.iter().any(|known| name.starts_with(known));
    if let Some(suites) = SUITES.write().unwrap_or_else(PoisonError::into_inner).as_mut() {
        // The persistent messages of these hosts fail or show nothing.
        if is(&["DaVinciResolve", "com.blackmagicdesign", "com.eyeonline", "MLT"]) {
            suites.persistent = None;
        }
        // MLT takes messages and drops them. Without the suite they go to the log.
        if is(&["MLT"]) {
            suites.message = None;
        }
    }
    Ok(())
}

/// The suites of the last load.
pub fn suites() -> Result<Suites, Failure> {
    (*SUITES.read().unwrap_or_else(PoisonError::into_inner)).ok_or(Failure::Missing("property suite"))
}

/// Whether the host has the DrawSuite, with which overlays draw ([`super::interact`]).
pub fn draws() -> bool {
    suites().is_ok_and(|suites| suites.draw.is_some())
}

/// The host's own properties.
pub fn properties() -> Result<Properties<'static>, Failure> {
    // SAFETY: as in `load`.
    let host = unsafe { HOST.load(Ordering::Acquire).as_ref() }.ok_or(Failure::Missing("host"))?;
    // SAFETY: the host's handle lives as long as the host.
    Ok(unsafe { Properties::new(host.host, suites()?.property) })
}

/// Whether the host gives and asks for parts of pictures. A host that does not say so does.
pub fn tiles() -> bool {
    let tiles = properties().and_then(|host| host.int(kOfxImageEffectPropSupportsTiles, 0));
    !tiles.is_ok_and(|tiles| tiles == 0)
}

/// Whether an effect may change the options of a choice after it is described. Natron says so. Of Nuke and Resolve it is
/// known that a menu stays as it is described.
pub fn changes_menus() -> bool {
    properties().is_ok_and(|host| says(&host, MENUS))
}

/// Whether the host has one of Natron's properties, and it is set. Other hosts do not have them.
fn says(host: &Properties, name: &CStr) -> bool {
    host.dimension(name).is_ok_and(|count| count > 0) && host.int(name, 0).is_ok_and(|value| value != 0)
}

/// The host's name, such as `uk.co.thefoundry.nuke`. A user of Natron may let it appear under the name of another host; what
/// it does with pictures and messages stays the same.
pub fn name() -> Option<String> {
    let host = properties().ok()?;
    if says(&host, NATRON) { Some("fr.inria.Natron".into()) } else { host.text(kOfxPropName, 0).ok() }
}

/// Whether the host may have several views of a picture, such as those of two eyes.
pub fn views() -> bool {
    name().is_some_and(|name| ["uk.co.thefoundry", "fr.inria.Natron"].iter().any(|known| name.starts_with(known)))
}

fn suite<T>(host: &OfxHost, name: &CStr, version: i32) -> Option<&'static T> {
    let fetch = host.fetchSuite?;
    // SAFETY: the host's own handle and a terminated name. The result is null or the suite of this name and version. `T` is
    // the type of that suite's table, and the host keeps the table.
    unsafe { fetch(host.host, name.as_ptr(), version).cast::<T>().as_ref() }
}
