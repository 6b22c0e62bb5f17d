//! An OpenFX host for tests.
//!
//! The official HostSupport library provides plugin cache, properties, parameters, clips and actions. The folder `host`
//! adds the parts that every host writes itself: images, values and keys of parameters, threads, progress, messages. The
//! library logs every call with its status. The host keeps these lines, so that a test can refuse any unexpected error
//! status.
//!
//! The library has one plugin cache per process, so [`Host::open`] waits until no other test has a host.

mod bridge;

pub use bridge::ffi::{Bounds, ClipSettings, Picture, Region, Settings};

use bridge::ffi::Pen;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

static ONE: Mutex<()> = Mutex::new(());

/// A host with its plugins loaded.
pub struct Host {
    _only: MutexGuard<'static, ()>,
}

impl Host {
    /// Loads all plugins in the bundles of a folder. Waits until any other host is dropped.
    pub fn open(folder: &Path) -> Self {
        let only = ONE.lock().unwrap_or_else(PoisonError::into_inner);
        bridge::ffi::configure(&Settings::default());
        let _ = (bridge::ffi::take_log(), bridge::ffi::take_messages());
        bridge::ffi::open(folder.to_str().expect("the folder's name is UTF-8"));
        Self { _only: only }
    }

    /// Unloads all plugins, and loads those of a folder.
    pub fn reload(&mut self, folder: &Path) {
        bridge::ffi::close();
        bridge::ffi::open(folder.to_str().expect("the folder's name is UTF-8"));
    }

    /// The ids of the plugins found.
    pub fn plugins(&self) -> Vec<String> {
        bridge::ffi::plugins()
    }

    /// The contexts that a plugin supports.
    pub fn contexts(&self, id: &str) -> Vec<String> {
        bridge::ffi::contexts(id)
    }

    /// Sets the behaviour of the host.
    pub fn configure(&self, settings: &Settings) {
        bridge::ffi::configure(settings);
    }

    /// Describes an effect in a context and makes its clips and parameters. [`Effect::create`] then creates the instance.
    pub fn effect(&self, id: &str, context: &str) -> Effect<'_> {
        let effect = bridge::ffi::new_effect(id, context);
        assert!(effect.is_some_and_valid(), "{id} could not be described in {context}: {:?}", self.log());
        Effect { inner: effect, _host: self }
    }

    /// Takes the lines of the library's log since the last call.
    pub fn log(&self) -> Vec<String> {
        bridge::ffi::take_log()
    }

    /// Takes the log, and returns its lines with an error status.
    pub fn errors(&self) -> Vec<String> {
        let told = |line: &String| line.contains("kOfxStatErr") || line.contains("kOfxStatFailed");
        self.log().into_iter().filter(told).collect()
    }

    /// Takes the messages of plugins to the user since the last call, as `type: text`.
    pub fn messages(&self) -> Vec<String> {
        bridge::ffi::take_messages()
    }

    /// The number of images that are fetched and not released.
    pub fn live_images(&self) -> i32 {
        bridge::ffi::live_images()
    }

    /// The largest progress that was reported since the last [`Host::configure`].
    pub fn furthest_progress(&self) -> f64 {
        bridge::ffi::furthest_progress()
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        bridge::ffi::close();
    }
}

trait Valid {
    fn is_some_and_valid(&self) -> bool;
}

impl Valid for cxx::UniquePtr<bridge::ffi::Effect> {
    fn is_some_and_valid(&self) -> bool {
        self.as_ref().is_some_and(bridge::ffi::Effect::valid)
    }
}

/// What a host does while a plugin shows its progress.
pub enum Meanwhile<'a> {
    /// The user sets a number, flag, choice or colour.
    Set(&'a str, &'a [f64]),
    /// The user sets a text.
    Text(&'a str, &'a str),
    /// The user presses a button.
    Press(&'a str),
    /// An event of the pen in the viewer: action, time, position and size of a screen pixel.
    Pen(&'a str, f64, [f64; 2], f64),
    /// A key goes down or up: action, time and symbol.
    Key(&'a str, f64, i32),
    /// An action without arguments.
    Action(&'a str),
    /// A clip is reported to have changed.
    Clip(&'a str),
    /// A clip's picture at a time becomes another one, and nobody tells the plugin: clip, time, width, RGBA.
    Frame(&'a str, f64, usize, &'a [f32]),
    /// The host renders a window at a time.
    Render(f64, Bounds),
    /// The user undoes the latest step.
    Undo,
}

/// An instance of an effect.
pub struct Effect<'a> {
    inner: cxx::UniquePtr<bridge::ffi::Effect>,
    _host: &'a Host,
}

// SAFETY: the instance is an object of C++ that is bound to no thread: hosts make an instance on one thread, render it on
// others and delete it on a third. The library's own state that instances share is guarded in `host/`. `Effect` is not
// `Sync`, so no two threads use one instance at once but through the host's own render threads.
#[allow(unsafe_code, reason = "hosts move instances between threads, so the tests do")]
unsafe impl Send for Effect<'_> {}

impl Effect<'_> {
    fn pin(&mut self) -> std::pin::Pin<&mut bridge::ffi::Effect> {
        self.inner.pin_mut()
    }

    /// Connects a clip.
    pub fn set_clip(&mut self, name: &str, settings: &ClipSettings) {
        self.pin().set_clip(name, settings);
    }

    /// Sets the picture of an input clip at a time: RGBA, rows from the bottom, at the lower left of the clip's region.
    pub fn set_frame(&mut self, clip: &str, time: f64, width: usize, rgba: &[f32]) {
        let height = rgba.len() / 4 / width.max(1);
        self.pin().set_frame(clip, time, width as i32, height as i32, rgba);
    }

    /// Gives an input clip a region of definition of its own at a time, in pixels.
    pub fn set_region(&mut self, clip: &str, time: f64, region: Bounds) {
        self.pin().set_region(clip, time, &region);
    }

    /// Gives a clip a format, in pixels, as Natron does.
    pub fn set_format(&mut self, clip: &str, format: Bounds) {
        self.pin().set_format(clip, &format);
    }

    /// Runs the action CreateInstance and reads the clip preferences. Returns the status.
    pub fn create(&mut self) -> String {
        self.pin().create()
    }

    /// Runs the action DestroyInstance. Returns the status.
    pub fn destroy(mut self) -> String {
        self.pin().destroy()
    }

    /// Renders a window, in pixels at the scale, and returns the status. The window is divided into tiles of `tile_rows` rows
    /// (0 for one tile), which `threads` threads render at the same time.
    pub fn render(&mut self, time: f64, window: Bounds, scale: f64, threads: i32, tile_rows: i32) -> String {
        self.pin().render(time, &window, scale, threads, tile_rows)
    }

    /// The last rendered picture.
    pub fn output(&self) -> Picture {
        self.inner.output()
    }

    /// The region of definition in canonical coordinates.
    pub fn region_of_definition(&mut self, time: f64, scale: f64) -> Region {
        self.pin().region_of_definition(time, scale)
    }

    /// The region of an input clip that a region of the output needs, in canonical coordinates.
    pub fn region_of_interest(&mut self, clip: &str, time: f64, scale: f64, wanted: &Region) -> Region {
        self.pin().region_of_interest(clip, time, scale, wanted)
    }

    /// The clip that the output is identical to; empty if there is none.
    pub fn identity(&mut self, time: f64, window: Bounds, scale: f64) -> String {
        self.pin().identity(time, &window, scale)
    }

    /// The frame ranges that are needed of an input clip: first, last, first, last, ...
    pub fn frames_needed(&mut self, clip: &str, time: f64) -> Vec<f64> {
        self.pin().frames_needed(clip, time)
    }

    /// Depth, components and premultiplication of the output.
    pub fn preferences(&mut self) -> String {
        self.pin().preferences()
    }

    /// Whether the output says that frames differ although no parameter is animated.
    pub fn varies(&self) -> bool {
        self.inner.varies()
    }

    /// Names of the parameters, in order.
    pub fn parameters(&self) -> Vec<String> {
        self.inner.parameters()
    }

    /// A property of a parameter as text; empty if it has no such property.
    pub fn parameter_property(&self, name: &str, property: &str, index: i32) -> String {
        self.inner.parameter_property(name, property, index)
    }

    /// Sets a number, flag, choice or colour for all times, as a user does.
    pub fn set(&mut self, name: &str, values: &[f64]) {
        self.pin().set_numbers(name, values);
        self.changed(name);
    }

    /// Sets a key at a time, as a user does.
    pub fn set_at(&mut self, name: &str, time: f64, values: &[f64]) {
        self.pin().set_numbers_at(name, time, values);
        self.changed(name);
    }

    /// Sets a key as in the host's curve editor, without telling the plugin.
    pub fn set_at_silently(&mut self, name: &str, time: f64, values: &[f64]) {
        self.pin().set_numbers_at(name, time, values);
    }

    /// Holds the value of each key of a parameter until the next one, as a user sets in the host's curve editor. The plugin is not told.
    pub fn hold_keys(&mut self, name: &str) {
        self.pin().hold_keys(name);
    }

    /// The values of a number, flag, choice or colour at a time.
    pub fn get(&self, name: &str, time: f64) -> Vec<f64> {
        self.inner.numbers(name, time)
    }

    /// The times and values of a parameter's keys.
    pub fn keys(&self, name: &str) -> Vec<(f64, Vec<f64>)> {
        self.inner.key_times(name).into_iter().map(|time| (time, self.get(name, time))).collect()
    }

    /// The time that the plugin moved the timeline to. `None` if it has not.
    pub fn gone_to(&self) -> Option<f64> {
        Some(self.inner.gone_to()).filter(|time| !time.is_nan())
    }

    /// Sets a number, flag, choice or colour for all times as a step of undo, as a user does.
    pub fn set_in_history(&mut self, name: &str, values: &[f64]) {
        self.pin().set_numbers_in_history(name, values);
        self.changed(name);
    }

    /// Sets a text as a step of undo, as a user does.
    pub fn set_text_in_history(&mut self, name: &str, value: &str) {
        self.pin().set_text_in_history(name, value);
        self.changed(name);
    }

    /// Sets a text, as a user does.
    pub fn set_text(&mut self, name: &str, value: &str) {
        self.pin().set_text(name, value);
        self.changed(name);
    }

    /// Sets a text as a script does, without telling the plugin.
    pub fn set_text_silently(&mut self, name: &str, value: &str) {
        self.pin().set_text(name, value);
    }

    /// The value of a text.
    pub fn text(&self, name: &str) -> String {
        self.inner.text(name)
    }

    /// Presses a button. Returns the status.
    pub fn press(&mut self, name: &str) -> String {
        self.changed(name)
    }

    /// Presses a button while the viewer shows a time. Returns the status.
    pub fn press_at(&mut self, name: &str, time: f64) -> String {
        self.pin().changed(name, "OfxChangeUserEdited", time)
    }

    fn changed(&mut self, name: &str) -> String {
        self.pin().changed(name, "OfxChangeUserEdited", 0.0)
    }

    /// Reports a change that the plugin made itself. Returns the status.
    pub fn changed_by_plugin(&mut self, name: &str) -> String {
        self.pin().changed(name, "OfxChangePluginEdited", 0.0)
    }

    /// Reports that the user has changed a clip. Returns the status.
    pub fn clip_changed(&mut self, name: &str) -> String {
        self.pin().clip_changed(name)
    }

    /// Lets something happen at the next update of a progress display, after what else happens there.
    pub fn meanwhile(&mut self, event: Meanwhile) {
        let mut tell =
            |kind: &str, name: &str, text: &str, numbers: &[f64]| self.pin().meanwhile(kind, name, text, numbers);
        match event {
            Meanwhile::Set(name, values) => tell("set", name, "", values),
            Meanwhile::Text(name, text) => tell("text", name, text, &[]),
            Meanwhile::Press(name) => tell("press", name, "", &[]),
            Meanwhile::Pen(action, time, [x, y], pixel) => tell("pen", action, "", &[time, x, y, pixel, 0.0]),
            Meanwhile::Key(action, time, key) => tell("pen", action, "", &[time, 0.0, 0.0, 1.0, f64::from(key)]),
            Meanwhile::Action(name) => tell("action", name, "", &[]),
            Meanwhile::Clip(name) => tell("clip", name, "", &[]),
            Meanwhile::Frame(clip, time, width, rgba) => {
                let pixels = rgba.iter().map(|value| f64::from(*value));
                tell("frame", clip, "", &[time, width as f64].into_iter().chain(pixels).collect::<Vec<_>>());
            }
            Meanwhile::Render(time, b) => tell(
                "render",
                "",
                "",
                &[time].into_iter().chain([b.x1, b.y1, b.x2, b.y2].map(f64::from)).collect::<Vec<_>>(),
            ),
            Meanwhile::Undo => tell("undo", "", "", &[]),
        }
    }

    /// Takes the statuses of what has happened meanwhile since the last call.
    pub fn meanwhile_statuses(&mut self) -> Vec<String> {
        self.pin().meanwhile_statuses()
    }

    /// Runs any action without arguments. Returns the status.
    pub fn action(&mut self, name: &str) -> String {
        self.pin().action(name)
    }

    /// Sends an event to the overlay and returns the status. It goes to the entry point for the DrawSuite or to that for
    /// OpenGL. `pen` is the pen's position and `pixel` the size of a screen pixel, both in canonical coordinates.
    pub fn overlay(&mut self, action: &str, draw_suite: bool, time: f64, pen: [f64; 2], pixel: f64) -> String {
        self.overlay_at_scale(action, (draw_suite, time), pen, pixel, 1.0)
    }

    /// The same in a viewer whose picture has a render scale, as for proxies.
    pub fn overlay_at_scale(
        &mut self,
        action: &str,
        (draw_suite, time): (bool, f64),
        pen: [f64; 2],
        pixel: f64,
        scale: f64,
    ) -> String {
        self.pin().overlay(action, draw_suite, time, &Pen { x: pen[0], y: pen[1], pixel, key: 0, scale })
    }

    /// Sends a key of the keyboard to the overlay, and returns the status. `action` is a key going down or up.
    pub fn overlay_key(&mut self, action: &str, time: f64, key: i32) -> String {
        self.pin().overlay(action, true, time, &Pen { x: 0.0, y: 0.0, pixel: 1.0, key, scale: 1.0 })
    }

    /// The labels of the steps that the host can undo, the latest last.
    pub fn history(&self) -> Vec<String> {
        self.inner.history()
    }

    /// Undoes the latest step of the host's history, as a user does: values and keys are as before, and the plugin is not
    /// told which.
    pub fn undo(&mut self) {
        self.pin().undo(false, false);
    }

    /// Makes the latest step again that was undone, and reports each parameter after all of them, as a change by the user.
    pub fn redo_told(&mut self) {
        self.pin().redo();
    }

    /// Undo in a host that reports each parameter that comes back, as a change by the user, as OpenFX says: after all of
    /// them, or `between` them.
    pub fn undo_told(&mut self, between: bool) {
        self.pin().undo(true, between);
    }

    /// Red, green, blue, opacity and width of each line drawn by the last event.
    pub fn drawn_colours(&self) -> Vec<[f32; 5]> {
        let flat = self.inner.drawn_colours();
        flat.chunks_exact(5).map(|line| [line[0], line[1], line[2], line[3], line[4]]).collect()
    }

    /// The texts drawn by the last event.
    pub fn texts(&self) -> Vec<String> {
        self.inner.texts()
    }

    /// The lines drawn by the last event: whether each is closed, and its points.
    pub fn drawn(&self) -> Vec<(bool, Vec<[f64; 2]>)> {
        let (flat, mut at, mut lines) = (self.inner.drawn(), 0, Vec::new());
        while at + 1 < flat.len() {
            let (closed, count) = (flat[at] != 0.0, flat[at + 1] as usize);
            let points = flat[at + 2..].chunks(2).take(count).map(|p| [p[0], p[1]]).collect();
            lines.push((closed, points));
            at += 2 + 2 * count;
        }
        lines
    }
}
