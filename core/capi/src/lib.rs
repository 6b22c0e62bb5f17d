//! C ABI of Rototoon, for ctypes and other foreign callers.
//!
//! `cargo xtask generate` generates the header `include/rototoon.h` from this crate, and the Python bindings from the
//! header.
//!
//! The crate has two layers. The outer one is the exported functions: [`session_abi`],
//! [`session_edit_abi`], [`session_track_abi`], [`session_conform_abi`], [`traced_abi`], [`filled_abi`], [`strokes_abi`], [`tween_abi`],
//! [`breakdown_abi`], [`style_abi`], [`functions`], [`files_abi`], [`handles`]. They read their arguments through [`entry`] and report progress through
//! [`callback`]. The inner one is safe Rust: [`session`], [`traced`], [`filled`], [`conformed`], [`edit`], [`options`], [`matching`], [`strokes`],
//! [`sheet`], [`style`], [`choosing`], [`work`].
//!
//! # Contract
//!
//! Every caller keeps these rules, and may rely on them:
//!
//! - Coordinates are in pixels, x to the right, y down. The origin is the outer top-left corner of the picture, so the
//!   centre of the first pixel is at (0.5, 0.5). Frames have the numbers of the document.
//! - A text argument is UTF-8 bytes and their count, without a terminating zero. A null pointer is allowed where the
//!   length is 0. The library reads arrays during the call only.
//! - Functions return a status. If it is not `ROTOTOON_STATUS_OK`, `*error` is a text that says what was wrong.
//!   After success `*error` is null. `error` itself may be null. Free the text with `rototoon_text_free`.
//! - New handles come out through the last parameters before `error`. They are null unless the call succeeded. The
//!   caller frees each handle once, with the `_free` function of its type, while no call uses it.
//! - Null, misaligned and oversize arguments are refused. A dangling pointer cannot be detected.
//! - A panic never leaves the library. It becomes `ROTOTOON_STATUS_PANIC`.
//! - A session may be used from any thread, but only from one at a time. A call during another call on the same session
//!   returns `ROTOTOON_STATUS_BUSY` at once. Different sessions are independent. All other handles never change, so
//!   several threads may read them.
//! - Progress callbacks run on the thread that made the call. They must not use the session of that call.
//! - A call that does not succeed leaves the session's document as it was.
//! - A process may be forked while no call runs. Each call of the child makes threads of its own, and the handles that
//!   it inherits work.
//!
//! # Limits
//!
//! The functions do not repeat the contract in safety sections of their own.

// The workspace denies unsafe code, but a C ABI needs it. Each use names its reason.
#![allow(unsafe_code)]
// The contract above is the safety section of all functions.
#![allow(clippy::missing_safety_doc)]

mod asked;
pub mod breakdown;
pub mod breakdown_abi;
pub mod callback;
mod choosing;
pub mod conformed;
pub mod edit;
pub mod entry;
pub mod files_abi;
pub mod filled;
pub mod filled_abi;
pub mod functions;
pub mod handles;
pub mod matching;
mod naming;
pub mod options;
pub mod outcomes;
mod pool;
pub mod session;
pub mod session_abi;
pub mod session_conform_abi;
pub mod session_edit_abi;
pub mod session_track_abi;
pub mod sheet;
pub mod status;
pub mod strokes;
pub mod strokes_abi;
pub mod style;
pub mod style_abi;
pub mod text;
pub mod traced;
pub mod traced_abi;
pub mod tween_abi;
pub mod work;

#[cfg(test)]
mod tests;
