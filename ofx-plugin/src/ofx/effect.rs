//! Effects, their clips, and their messages to the user.

use super::failure::Failure;
use super::host::Suites;
use super::image::Image;
use super::log::log;
use super::param::Parameters;
use super::property::{Properties, call, terminated};
use openfx::sys::generic::core::{OfxRectD, kOfxPropInstanceData};
use openfx::sys::image_effect_v1::image_effect::{
    OfxImageClipHandle, OfxImageEffectHandle, kOfxImageClipPropConnected, kOfxImageEffectPropFrameRange,
    kOfxImagePropPixelAspectRatio,
};
use openfx::sys::image_effect_v1::message::{kOfxMessageError, kOfxMessageWarning};
use std::ffi::{CStr, c_void};
use std::marker::PhantomData;

/// Natron's property of a clip: the sides of its format, in pixels.
const FORMAT: &CStr = c"OfxImageClipPropFormat";

/// An effect. The action decides whether it is a description or an instance.
#[derive(Clone, Copy)]
pub struct Effect<'a> {
    pub(super) handle: OfxImageEffectHandle,
    pub(super) suites: Suites,
    action: PhantomData<&'a ()>,
}

/// A rectangle in canonical coordinates: y up, square pixels, scale 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Region {
    /// Left.
    pub x1: f64,
    /// Bottom.
    pub y1: f64,
    /// Right.
    pub x2: f64,
    /// Top.
    pub y2: f64,
}

impl Region {
    /// The intersection of two rectangles; `None` if it has no area.
    pub fn shared(&self, other: &Self) -> Option<Self> {
        let both = Self {
            x1: self.x1.max(other.x1),
            y1: self.y1.max(other.y1),
            x2: self.x2.min(other.x2),
            y2: self.y2.min(other.y2),
        };
        (both.x1 < both.x2 && both.y1 < both.y2).then_some(both)
    }

    /// The smallest rectangle that contains two.
    pub fn united(&self, other: &Self) -> Self {
        Self {
            x1: self.x1.min(other.x1),
            y1: self.y1.min(other.y1),
            x2: self.x2.max(other.x2),
            y2: self.y2.max(other.y2),
        }
    }

    /// Whether it ends on all sides. Generators may have no ends, which OpenFX writes as the greatest whole numbers.
    pub fn is_bounded(&self) -> bool {
        self.to_array().iter().all(|side| side.abs() < f64::from(i32::MAX))
    }

    /// Left, bottom, right, top.
    pub fn to_array(&self) -> [f64; 4] {
        [self.x1, self.y1, self.x2, self.y2]
    }
}

// SAFETY: OpenFX runs render and the actions around it on several threads, which may call its suites. The effect's handle is
// an address that only the host reads.
unsafe impl Send for Effect<'_> {}
// SAFETY: as above.
unsafe impl Sync for Effect<'_> {}

impl<'a> Effect<'a> {
    /// # Safety
    /// The handle is the one that an action came with, and `'a` does not outlive the action.
    pub(super) unsafe fn new(handle: *const c_void, suites: Suites) -> Self {
        Self { handle: handle.cast_mut().cast(), suites, action: PhantomData }
    }

    /// The effect's properties.
    pub fn properties(&self) -> Result<Properties<'a>, Failure> {
        let mut properties = std::ptr::null_mut();
        call!(self.suites.effect, getPropertySet, self.handle, &mut properties)?;
        // SAFETY: the set of the effect, which lives for the action.
        Ok(unsafe { Properties::new(properties, self.suites.property) })
    }

    /// The effect's parameters.
    pub fn parameters(&self) -> Result<Parameters<'a>, Failure> {
        let mut set = std::ptr::null_mut();
        call!(self.suites.effect, getParamSet, self.handle, &mut set)?;
        // SAFETY: the set of the effect, which lives for the action.
        Ok(unsafe { Parameters::new(set, self.suites) })
    }

    /// Describes a clip.
    pub fn define_clip(&self, name: &CStr) -> Result<Properties<'a>, Failure> {
        let mut properties = std::ptr::null_mut();
        call!(self.suites.effect, clipDefine, self.handle, name.as_ptr(), &mut properties)?;
        // SAFETY: the set of the clip described, which lives for the action.
        Ok(unsafe { Properties::new(properties, self.suites.property) })
    }

    /// A clip.
    pub fn clip(&self, name: &CStr) -> Result<Clip<'a>, Failure> {
        let (mut handle, mut properties) = (std::ptr::null_mut(), std::ptr::null_mut());
        call!(self.suites.effect, clipGetHandle, self.handle, name.as_ptr(), &mut handle, &mut properties)?;
        // SAFETY: the set of the clip, which lives as long as the effect.
        let properties = unsafe { Properties::new(properties, self.suites.property) };
        Ok(Clip { handle, properties, suites: self.suites })
    }

    /// Whether the host has aborted the render.
    pub fn aborted(&self) -> bool {
        // SAFETY: the effect's own handle.
        self.suites.effect.abort.is_some_and(|abort| unsafe { abort(self.handle) } != 0)
    }

    /// Shows the user an error that a button press caused, or logs it if the host cannot show messages.
    pub fn complain(&self, text: &str) {
        if !self.message(text) {
            log(text);
        }
    }

    /// Shows the user all errors and warnings about the picture, without interrupting. Hosts keep one such message for each effect. If
    /// the host cannot show it, what is `new` in it is logged.
    pub fn note(&self, all: &str, new: &str, error: bool) {
        let kind = if error { kOfxMessageError } else { kOfxMessageWarning };
        let text = terminated(all);
        let persistent = self.suites.persistent.and_then(|suite| suite.setPersistentMessage);
        // SAFETY: the effect's own handle and terminated texts; `%s` takes the one that follows.
        let told = persistent.is_some_and(|function| unsafe {
            function(self.handle.cast(), kind.as_ptr(), c"rototoon".as_ptr(), c"%s".as_ptr(), text.as_ptr()) == 0
        });
        if !told {
            log(new);
        }
    }

    /// Removes the messages of [`Self::note`].
    pub fn clear_note(&self) {
        if let Some(clear) = self.suites.persistent.and_then(|suite| suite.clearPersistentMessage) {
            // SAFETY: the effect's own handle.
            unsafe { clear(self.handle.cast()) };
        }
    }

    fn message(&self, text: &str) -> bool {
        let text = terminated(text);
        let Some(function) = self.suites.message.and_then(|suite| suite.message) else { return false };
        // SAFETY: the effect's own handle and terminated texts; `%s` takes the one that follows.
        let status = unsafe {
            function(self.handle.cast(), kOfxMessageError.as_ptr(), c"rototoon".as_ptr(), c"%s".as_ptr(), text.as_ptr())
        };
        status == 0
    }

    /// Moves the host's timeline to a time. Returns whether it did: hosts need not have a timeline that effects move. The
    /// host may draw and render before this returns, so no lock may be held.
    pub fn go_to(&self, time: f64) -> bool {
        let suite = self.suites.timeline;
        suite.is_some_and(|suite| call!(suite, gotoTime, self.handle.cast(), time).is_ok())
    }

    /// First and last frame of the host's timeline.
    pub fn timeline(&self) -> Option<[f64; 2]> {
        let (mut first, mut last) = (0.0, 0.0);
        call!(self.suites.timeline?, getTimeBounds, self.handle.cast(), &mut first, &mut last).ok()?;
        (first <= last).then_some([first, last])
    }

    /// Attaches data to an instance. [`Self::take_data`] must release it.
    pub fn set_data<T: Sync + Send>(&self, data: Box<T>) -> Result<(), Failure> {
        let properties = self.properties()?;
        let pointer = Box::into_raw(data);
        properties.set_pointer(kOfxPropInstanceData, 0, pointer.cast()).inspect_err(|_| {
            // SAFETY: the pointer was made above, and the host did not store it.
            drop(unsafe { Box::from_raw(pointer) });
        })
    }

    /// The data of an instance.
    ///
    /// # Safety
    /// `T` is the type that this effect's [`Self::set_data`] was given.
    pub unsafe fn data<T: Sync + Send>(&self) -> Result<&'a T, Failure> {
        let pointer = self.properties()?.pointer(kOfxPropInstanceData, 0)?;
        // SAFETY: the pointer came from `set_data`, with the caller's `T`. A host runs no other action of an instance while
        // it is destroyed, so the data outlives the action.
        unsafe { pointer.cast::<T>().as_ref() }.ok_or(Failure::Missing("instance data"))
    }

    /// Takes the data of an instance that is destroyed.
    ///
    /// # Safety
    /// The same as of [`Self::data`], and no reference to the data is left.
    pub unsafe fn take_data<T: Sync + Send>(&self) -> Result<Option<Box<T>>, Failure> {
        let properties = self.properties()?;
        let pointer = properties.pointer(kOfxPropInstanceData, 0)?.cast::<T>();
        properties.set_pointer(kOfxPropInstanceData, 0, std::ptr::null_mut())?;
        // SAFETY: promised by the caller.
        Ok((!pointer.is_null()).then(|| unsafe { Box::from_raw(pointer) }))
    }
}

/// A clip of an instance.
#[derive(Clone, Copy)]
pub struct Clip<'a> {
    pub(super) handle: OfxImageClipHandle,
    /// The clip's properties.
    pub properties: Properties<'a>,
    pub(super) suites: Suites,
}

// SAFETY: as for `Effect`.
unsafe impl Send for Clip<'_> {}
// SAFETY: as for `Effect`.
unsafe impl Sync for Clip<'_> {}

impl<'a> Clip<'a> {
    /// Whether anything is connected to the clip. Some hosts report this wrongly.
    pub fn connected(&self) -> bool {
        self.properties.int(kOfxImageClipPropConnected, 0).is_ok_and(|connected| connected != 0)
    }

    /// First and last frame.
    pub fn frame_range(&self) -> Option<[f64; 2]> {
        self.properties.doubles(kOfxImageEffectPropFrameRange).ok().filter(|[first, last]| first <= last)
    }

    /// Width of a pixel over its height.
    pub fn pixel_aspect(&self) -> f64 {
        let aspect = self.properties.double(kOfxImagePropPixelAspectRatio, 0);
        aspect.ok().filter(|aspect| aspect.is_finite() && *aspect > 0.0).unwrap_or(1.0)
    }

    /// The rectangle in which the clip has pixels at a time; `None` if it is empty or unknown.
    pub fn region(&self, time: f64) -> Option<Region> {
        let mut rect = OfxRectD { x1: 0.0, y1: 0.0, x2: 0.0, y2: 0.0 };
        call!(self.suites.effect, clipGetRegionOfDefinition, self.handle, time, &mut rect).ok()?;
        let region = Region { x1: rect.x1, y1: rect.y1, x2: rect.x2, y2: rect.y2 };
        (region.x1 < region.x2 && region.y1 < region.y2).then_some(region)
    }

    /// The clip's format in canonical coordinates: the rectangle of the whole picture, whatever of it has pixels. `None` where the host
    /// has no such property; Natron has it.
    pub fn format(&self) -> Option<Region> {
        self.properties.dimension(FORMAT).ok().filter(|count| *count == 4)?;
        let [x1, y1, x2, y2] = self.properties.ints(FORMAT).ok()?.map(f64::from);
        let aspect = self.pixel_aspect();
        (x1 < x2 && y1 < y2).then_some(Region { x1: x1 * aspect, y1, x2: x2 * aspect, y2 })
    }

    /// The image at a time. `None` if the host has none; callers then use transparent black.
    pub fn image(&self, time: f64) -> Result<Option<Image<'a>>, Failure> {
        Image::fetch(self, time)
    }
}
