//! Overlays: drawing over the host's viewer, and the pen in it.
//!
//! An overlay draws with the DrawSuite of OpenFX 1.5, or with OpenGL in older hosts. The plugin does not link OpenGL: it
//! looks its functions up in the host's process. If there is neither, nothing is drawn.

use super::effect::Effect;
use super::failure::Failure;
use super::host;
use super::letters;
use super::log::log;
use super::property::{Properties, call, terminated};
use openfx::sys::generic::core::{
    OfxPointD, OfxPropertySetHandle, OfxStatus, kOfxActionCreateInstance, kOfxActionDescribe,
    kOfxActionDestroyInstance, kOfxPropEffectInstance, kOfxPropTime, kOfxStatFailed, kOfxStatOK, kOfxStatReplyDefault,
};
use openfx::sys::image_effect_v1::draw_suite::{
    OfxDrawContextHandle, OfxDrawSuiteV1, kOfxDrawPrimitiveLineLoop, kOfxDrawPrimitiveLineStrip,
    kOfxDrawTextAlignmentBottom, kOfxDrawTextAlignmentLeft, kOfxInteractPropDrawContext,
};
use openfx::sys::image_effect_v1::interact::{
    kOfxInteractActionDraw, kOfxInteractActionKeyDown, kOfxInteractActionKeyUp, kOfxInteractActionLoseFocus,
    kOfxInteractActionPenDown, kOfxInteractActionPenMotion, kOfxInteractActionPenUp, kOfxInteractPropPenPosition,
    kOfxInteractPropPixelScale,
};
use openfx::sys::image_effect_v1::key_syms::kOfxPropKeySym;
use openfx::sys::image_effect_v1::pixels::OfxRGBAColourF;
use std::ffi::{CStr, c_char, c_double, c_float, c_int, c_uint, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The kind of an event of the viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The overlay must be drawn.
    Draw,
    /// The pen goes down.
    Down,
    /// The pen moves.
    Move,
    /// The pen goes up.
    Up,
    /// A key of the keyboard goes down.
    KeyDown,
    /// A key of the keyboard goes up.
    KeyUp,
    /// The viewer's keys and pen go elsewhere.
    Left,
}

/// An event of the viewer with its arguments.
pub struct View<'a> {
    /// The kind of the event.
    pub event: Event,
    /// The effect that the overlay belongs to.
    pub effect: Effect<'a>,
    /// Time of the viewer, in frames.
    pub time: f64,
    /// Width and height of a screen pixel in canonical coordinates.
    pub pixel: [f64; 2],
    /// The symbol of the key that goes down or up ([`openfx::sys::image_effect_v1::key_syms`]).
    pub key: u32,
    /// Position of the pen in canonical coordinates.
    pub pen: [f64; 2],
    canvas: Option<Canvas>,
    interact: *mut c_void,
}

/// Handles an event of the viewer. Every call of the host to an overlay goes through this function.
///
/// # Safety
/// The arguments are those of a call by the host: a terminated name, and handles that are null or live for the call.
pub unsafe fn entry(
    action: *const c_char,
    handle: *const c_void,
    input: OfxPropertySetHandle,
    draw_suite: bool,
    perform: fn(&View) -> Result<(), Failure>,
) -> OfxStatus {
    if action.is_null() {
        return kOfxStatFailed;
    }
    // SAFETY: a terminated name, as promised.
    let name = unsafe { CStr::from_ptr(action) };
    if [kOfxActionDescribe, kOfxActionCreateInstance, kOfxActionDestroyInstance].contains(&name) {
        return kOfxStatOK;
    }
    let events = [
        (kOfxInteractActionDraw, Event::Draw),
        (kOfxInteractActionPenDown, Event::Down),
        (kOfxInteractActionPenMotion, Event::Move),
        (kOfxInteractActionPenUp, Event::Up),
        (kOfxInteractActionKeyDown, Event::KeyDown),
        (kOfxInteractActionKeyUp, Event::KeyUp),
        (kOfxInteractActionLoseFocus, Event::Left),
    ];
    let Some((_, event)) = events.into_iter().find(|(known, _)| *known == name) else { return kOfxStatReplyDefault };
    let act = || {
        // SAFETY: the handles live for the call, and the view made of them is dropped before it ends.
        let view = unsafe { View::new(event, handle.cast_mut(), input, draw_suite) }?;
        perform(&view)
    };
    match catch_unwind(AssertUnwindSafe(act)) {
        Ok(Ok(())) => kOfxStatOK,
        Ok(Err(failure)) => failure.status(),
        Err(panic) => {
            let _ = catch_unwind(AssertUnwindSafe(|| {
                log("internal error in the overlay");
                drop(panic);
            }));
            kOfxStatFailed
        }
    }
}

impl View<'_> {
    /// # Safety
    /// As for [`entry`].
    unsafe fn new(
        event: Event,
        interact: *mut c_void,
        input: OfxPropertySetHandle,
        draw_suite: bool,
    ) -> Result<Self, Failure> {
        let suites = host::suites()?;
        // SAFETY: promised by the caller.
        let input = unsafe { Properties::new(input, suites.property) };
        let effect = input.pointer(kOfxPropEffectInstance, 0)?;
        if effect.is_null() {
            return Err(Failure::Default);
        }
        let canvas = match (event, draw_suite) {
            (Event::Draw, true) => {
                let context: OfxDrawContextHandle = input.pointer(kOfxInteractPropDrawContext, 0)?.cast();
                suites.draw.map(|suite| Canvas::Suite(suite, context))
            }
            (Event::Draw, false) => OpenGl::find().map(Canvas::OpenGl),
            _ => None,
        };
        let scale: [f64; 2] = input.doubles(kOfxInteractPropPixelScale).unwrap_or([1.0; 2]);
        let with_pen = matches!(event, Event::Down | Event::Move | Event::Up);
        let pen = if with_pen { input.doubles(kOfxInteractPropPenPosition)? } else { [0.0; 2] };
        let with_key = matches!(event, Event::KeyDown | Event::KeyUp);
        let key = if with_key { input.int(kOfxPropKeySym, 0)? } else { 0 };
        Ok(Self {
            event,
            // SAFETY: the handle of the effect, which lives at least as long as its overlay.
            effect: unsafe { Effect::new(effect, suites) },
            time: input.double(kOfxPropTime, 0)?,
            pixel: scale.map(|scale| if scale.is_finite() && scale > 0.0 { scale } else { 1.0 }),
            key: key.cast_unsigned(),
            pen,
            canvas,
            interact,
        })
    }

    /// Asks the host to draw again.
    pub fn redraw(&self) {
        if let Some(redraw) = self.effect.suites.interact.and_then(|suite| suite.interactRedraw) {
            // SAFETY: the host's own handle.
            unsafe { redraw(self.interact.cast()) };
        }
    }

    /// Draws a line through points in canonical coordinates. If `closed`, the last point joins the first. `colour` is RGBA,
    /// `width` is in screen pixels.
    pub fn line(&self, points: &[[f64; 2]], closed: bool, colour: [f32; 4], width: f32) {
        match &self.canvas {
            Some(Canvas::Suite(suite, context)) => draw_by_suite(suite, *context, points, closed, colour, width),
            Some(Canvas::OpenGl(gl)) => gl.line(points, closed, colour, width),
            None => {}
        }
    }

    /// Writes a text whose lower left corner is at a place in canonical coordinates. OpenGL has no text: there the letters
    /// are drawn as pixels ([`letters`]).
    pub fn text(&self, text: &str, at: [f64; 2], colour: [f32; 4]) {
        match &self.canvas {
            Some(Canvas::Suite(suite, context)) => text_by_suite(suite, *context, text, at, colour),
            Some(Canvas::OpenGl(gl)) => {
                let [w, h] = self.pixel;
                let place = |x: i32, y: i32| [at[0] + f64::from(x) * w, at[1] + (f64::from(y) + 0.5) * h];
                let rows = letters::rows(text);
                let ends = rows.iter().flat_map(|row| [place(row.from, row.y), place(row.to, row.y)]);
                gl.segments(&ends.collect::<Vec<_>>(), colour);
            }
            None => {}
        }
    }
}

/// The means of drawing.
enum Canvas {
    Suite(&'static OfxDrawSuiteV1, OfxDrawContextHandle),
    OpenGl(OpenGl),
}

fn draw_by_suite(
    suite: &OfxDrawSuiteV1,
    context: OfxDrawContextHandle,
    points: &[[f64; 2]],
    closed: bool,
    [r, g, b, a]: [f32; 4],
    width: f32,
) {
    let points: Vec<OfxPointD> = points.iter().map(|&[x, y]| OfxPointD { x, y }).collect();
    let colour = OfxRGBAColourF { r, g, b, a };
    let primitive = if closed { kOfxDrawPrimitiveLineLoop } else { kOfxDrawPrimitiveLineStrip };
    // Errors of the host are ignored: the line is then missing.
    let _ = call!(suite, setColour, context, &colour);
    let _ = call!(suite, setLineWidth, context, width);
    let _ = call!(suite, draw, context, primitive, points.as_ptr(), points.len() as c_int);
}

fn text_by_suite(
    suite: &OfxDrawSuiteV1,
    context: OfxDrawContextHandle,
    text: &str,
    [x, y]: [f64; 2],
    [r, g, b, a]: [f32; 4],
) {
    let (text, at, colour) = (terminated(text), OfxPointD { x, y }, OfxRGBAColourF { r, g, b, a });
    let alignment = kOfxDrawTextAlignmentLeft | kOfxDrawTextAlignmentBottom;
    let _ = call!(suite, setColour, context, &colour);
    let _ = call!(suite, drawText, context, text.as_ptr(), &at, alignment as c_int);
}

/// The functions of OpenGL 1.1 that are needed to draw lines.
struct OpenGl {
    begin: unsafe extern "C" fn(c_uint),
    end: unsafe extern "C" fn(),
    vertex: unsafe extern "C" fn(c_double, c_double),
    colour: unsafe extern "C" fn(c_float, c_float, c_float, c_float),
    width: unsafe extern "C" fn(c_float),
    push: unsafe extern "C" fn(c_uint),
    pop: unsafe extern "C" fn(),
}

#[cfg(unix)]
unsafe extern "C" {
    fn dlsym(handle: *mut c_void, name: *const c_char) -> *mut c_void;
}

impl OpenGl {
    const LINES: c_uint = 1;
    const LINE_LOOP: c_uint = 2;
    const LINE_STRIP: c_uint = 3;
    /// The attribute groups to save: the current colour and the line state.
    const BITS: c_uint = 0x1 | 0x4;

    /// The functions, if the host's process has all of them.
    #[cfg(unix)]
    fn find() -> Option<Self> {
        fn function<T: Copy>(name: &CStr) -> Option<T> {
            const { assert!(size_of::<T>() == size_of::<*mut c_void>()) };
            // SAFETY: a terminated name; null as the handle means the process itself.
            let found = unsafe { dlsym(std::ptr::null_mut(), name.as_ptr()) };
            // SAFETY: a function pointer of the size of the address, of the type that OpenGL 1.1 gives this name.
            (!found.is_null()).then(|| unsafe { std::mem::transmute_copy(&found) })
        }
        Some(Self {
            begin: function(c"glBegin")?,
            end: function(c"glEnd")?,
            vertex: function(c"glVertex2d")?,
            colour: function(c"glColor4f")?,
            width: function(c"glLineWidth")?,
            push: function(c"glPushAttrib")?,
            pop: function(c"glPopAttrib")?,
        })
    }

    #[cfg(not(unix))]
    fn find() -> Option<Self> {
        None
    }

    fn line(&self, points: &[[f64; 2]], closed: bool, colour: [f32; 4], width: f32) {
        self.draw(if closed { Self::LINE_LOOP } else { Self::LINE_STRIP }, points, colour, width);
    }

    /// Draws lines, one pixel wide, each between a point and the next one.
    fn segments(&self, points: &[[f64; 2]], colour: [f32; 4]) {
        self.draw(Self::LINES, points, colour, 1.0);
    }

    fn draw(&self, kind: c_uint, points: &[[f64; 2]], [r, g, b, a]: [f32; 4], width: f32) {
        // SAFETY: during the drawing of an overlay the host's OpenGL context is current, in canonical coordinates.
        unsafe {
            (self.push)(Self::BITS);
            (self.colour)(r, g, b, a);
            (self.width)(width);
            (self.begin)(kind);
            for &[x, y] in points {
                (self.vertex)(x, y);
            }
            (self.end)();
            (self.pop)();
        }
    }
}
