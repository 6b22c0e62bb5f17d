//! The bridge to the C++ of `host/`.
#![allow(unsafe_code, reason = "cxx generates the calls of C++ functions and checks their signatures on both sides")]

/// Converts a float to the bits of a half.
fn to_half(value: f32) -> u16 {
    half::f16::from_f32(value).to_bits()
}

/// Converts the bits of a half to a float.
fn from_half(bits: u16) -> f32 {
    half::f16::from_bits(bits).to_f32()
}

impl Default for ffi::Settings {
    fn default() -> Self {
        Self {
            name: "RototoonTestHost".into(),
            missing_suites: Vec::new(),
            abort_after: -1,
            cancel_after: -1,
            no_images: false,
            multi_resolution: true,
            tiles: true,
            real_scale: 1.0,
            cpus: 1,
            temporal: true,
            menus: false,
            natron: false,
            choice_keys: true,
            null_messages: false,
            viewer_draws: false,
        }
    }
}

impl Default for ffi::ClipSettings {
    fn default() -> Self {
        Self {
            depth: "OfxBitDepthFloat".into(),
            components: "OfxImageComponentRGBA".into(),
            premultiplication: "OfxImageAlphaPremultiplied".into(),
            connected: true,
            x1: 0,
            y1: 0,
            x2: 64,
            y2: 48,
            aspect: 1.0,
            first: 0.0,
            last: 10.0,
            padding: 0,
            top_down: false,
            margin: 0,
        }
    }
}

/// The types and functions that both sides share.
#[allow(missing_docs, reason = "cxx's own items")]
#[cxx::bridge(namespace = "rototoon_host")]
pub mod ffi {
    /// A rectangle of pixels.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    struct Bounds {
        x1: i32,
        y1: i32,
        x2: i32,
        y2: i32,
    }

    /// A rectangle in canonical coordinates, and the status of the action that gave it.
    #[derive(Clone, Debug, PartialEq)]
    struct Region {
        status: String,
        x1: f64,
        y1: f64,
        x2: f64,
        y2: f64,
    }

    /// The behaviour of the host.
    #[derive(Clone, Debug)]
    struct Settings {
        /// The host's name.
        name: String,
        /// Suites that the host does not have: by name, or by name and version, `OfxMessageSuite/2`.
        missing_suites: Vec<String>,
        /// Rendering is aborted after that many checks by the plugin; never if negative.
        abort_after: i32,
        /// Progress is cancelled after that many updates; never if negative.
        cancel_after: i32,
        /// Whether clips give no images.
        no_images: bool,
        /// Whether clips may differ in size.
        multi_resolution: bool,
        /// Whether images may be parts of a picture.
        tiles: bool,
        /// The scale of images as a factor of the render scale that the host says.
        real_scale: f64,
        /// Number of processors that the multi-thread suite reports.
        cpus: u32,
        /// Whether plugins may ask for images at other times.
        temporal: bool,
        /// Whether plugins may change the options of a choice, as in Natron.
        menus: bool,
        /// Whether the host says that it is Natron, whatever its name.
        natron: bool,
        /// Whether choices may have keys.
        choice_keys: bool,
        /// Whether the persistent messages are a null and an address of nothing, as in Resolve.
        null_messages: bool,
        /// Whether the viewer draws the overlay of an instance all the time while it renders.
        viewer_draws: bool,
    }

    /// The images that a clip is connected to.
    #[derive(Clone, Debug)]
    struct ClipSettings {
        depth: String,
        components: String,
        premultiplication: String,
        connected: bool,
        /// Region of definition, in pixels at scale 1, y up.
        x1: i32,
        y1: i32,
        x2: i32,
        y2: i32,
        /// Width of a pixel over its height.
        aspect: f64,
        first: f64,
        last: f64,
        /// Unused bytes after each row.
        padding: i32,
        /// Whether the top row is first in memory, so that the number of bytes per row is negative.
        top_down: bool,
        /// Pixels by which images exceed the requested region, on each side.
        margin: i32,
    }

    /// The pen and the keyboard of an event.
    #[derive(Clone, Copy, Debug)]
    struct Pen {
        /// Position in canonical coordinates.
        x: f64,
        y: f64,
        /// Size of a screen pixel in canonical coordinates.
        pixel: f64,
        /// Symbol of the key that goes down or up.
        key: i32,
        /// Render scale of the viewer's picture, as for proxies.
        scale: f64,
    }

    /// A rendered picture.
    #[derive(Clone, Debug, PartialEq)]
    struct Picture {
        width: usize,
        height: usize,
        channels: usize,
        /// Values of the pixels, with rows from the bottom.
        values: Vec<f32>,
        /// Bytes outside the window that were written.
        damage: usize,
        /// Pixels of the window that were not written.
        untouched: usize,
    }

    extern "Rust" {
        fn to_half(value: f32) -> u16;
        fn from_half(bits: u16) -> f32;
    }

    unsafe extern "C++" {
        include!("rototoon-ofx-host/src/host.h");

        type Effect;

        fn open(folder: &str);
        fn close();
        fn plugins() -> Vec<String>;
        fn contexts(id: &str) -> Vec<String>;
        fn configure(settings: &Settings);
        fn take_log() -> Vec<String>;
        fn take_messages() -> Vec<String>;
        fn live_images() -> i32;
        fn furthest_progress() -> f64;
        fn new_effect(id: &str, context: &str) -> UniquePtr<Effect>;

        fn valid(self: &Effect) -> bool;
        fn set_clip(self: Pin<&mut Effect>, name: &str, settings: &ClipSettings);
        fn set_frame(self: Pin<&mut Effect>, clip: &str, time: f64, width: i32, height: i32, rgba: &[f32]);
        fn set_region(self: Pin<&mut Effect>, clip: &str, time: f64, region: &Bounds);
        fn set_format(self: Pin<&mut Effect>, clip: &str, format: &Bounds);
        fn create(self: Pin<&mut Effect>) -> String;
        fn destroy(self: Pin<&mut Effect>) -> String;
        fn render(
            self: Pin<&mut Effect>,
            time: f64,
            window: &Bounds,
            scale: f64,
            threads: i32,
            tile_rows: i32,
        ) -> String;
        fn output(self: &Effect) -> Picture;
        fn region_of_definition(self: Pin<&mut Effect>, time: f64, scale: f64) -> Region;
        fn region_of_interest(self: Pin<&mut Effect>, clip: &str, time: f64, scale: f64, wanted: &Region) -> Region;
        fn identity(self: Pin<&mut Effect>, time: f64, window: &Bounds, scale: f64) -> String;
        fn varies(self: &Effect) -> bool;
        fn frames_needed(self: Pin<&mut Effect>, clip: &str, time: f64) -> Vec<f64>;
        fn preferences(self: Pin<&mut Effect>) -> String;
        fn parameters(self: &Effect) -> Vec<String>;
        fn parameter_property(self: &Effect, name: &str, property: &str, index: i32) -> String;
        fn set_numbers(self: Pin<&mut Effect>, name: &str, values: &[f64]);
        fn set_numbers_at(self: Pin<&mut Effect>, name: &str, time: f64, values: &[f64]);
        fn hold_keys(self: Pin<&mut Effect>, name: &str);
        fn key_times(self: &Effect, name: &str) -> Vec<f64>;
        fn gone_to(self: &Effect) -> f64;
        fn numbers(self: &Effect, name: &str, time: f64) -> Vec<f64>;
        fn set_text(self: Pin<&mut Effect>, name: &str, value: &str);
        fn set_numbers_in_history(self: Pin<&mut Effect>, name: &str, values: &[f64]);
        fn set_text_in_history(self: Pin<&mut Effect>, name: &str, value: &str);
        fn text(self: &Effect, name: &str) -> String;
        fn changed(self: Pin<&mut Effect>, name: &str, reason: &str, time: f64) -> String;
        fn clip_changed(self: Pin<&mut Effect>, name: &str) -> String;
        fn meanwhile(self: Pin<&mut Effect>, kind: &str, name: &str, text: &str, numbers: &[f64]);
        fn meanwhile_statuses(self: Pin<&mut Effect>) -> Vec<String>;
        fn action(self: Pin<&mut Effect>, name: &str) -> String;
        fn overlay(self: Pin<&mut Effect>, action: &str, draw_suite: bool, time: f64, pen: &Pen) -> String;
        fn history(self: &Effect) -> Vec<String>;
        fn undo(self: Pin<&mut Effect>, told: bool, between: bool);
        fn redo(self: Pin<&mut Effect>);
        fn drawn_colours(self: &Effect) -> Vec<f32>;
        fn texts(self: &Effect) -> Vec<String>;
        fn drawn(self: &Effect) -> Vec<f64>;
    }
}
