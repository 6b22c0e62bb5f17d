//! C ABI of Rototoon, for ctypes and other foreign callers.
//!
//! The header `include/rototoon.h` is generated from this crate and the Python bindings from the header
//! (`cargo xtask generate`). Layers, from the outside: the exported functions ([`session_abi`], [`strokes_abi`],
//! [`tween_abi`], [`style_abi`], [`functions`], [`handles`]) read their arguments through [`entry`] and report through
//! [`callback`]; below them all is safe Rust ([`session`], [`edit`], [`options`], [`matching`], [`strokes`], [`sheet`],
//! [`style`], [`work`]).
//!
//! # Contract
//!
//! What every caller promises and may rely on:
//!
//! - Coordinates are pixels, x right, y down, with the origin at the picture's outer top-left corner: a pixel's centre
//!   lies at +0.5. Frames are the numbers of the document.
//! - Text comes in as UTF-8 bytes with their length, without a terminating zero. A null pointer is an empty array where
//!   the length is 0. Arrays are read during the call only.
//! - Functions return a status. Other than `ROTOTOON_STATUS_OK`, the text in `*error` says what was wrong; it is null
//!   after success. `error` itself may be null. Free the text with `rototoon_text_free`.
//! - Handles come out through the last parameter before `error` (null unless the call succeeded). Each is freed once,
//!   with the `_free` of its type, while no call uses it.
//! - Null, misaligned and oversize arguments are refused. A dangling pointer cannot be noticed.
//! - A panic never leaves the library: it becomes `ROTOTOON_STATUS_PANIC`.
//! - A session may be used from any thread, but from one at a time: a call during another one on the same session
//!   returns `ROTOTOON_STATUS_BUSY` at once. Different sessions are independent. Texts, tracks and curves never change
//!   and may be read from several threads.
//! - Progress callbacks are called on the thread that made the call, and must not use its session.
//! - A call that does not succeed leaves the session's document as it was.
//!
//! # Limits
//!
//! The contract holds for all functions, so that none repeats it in a section on safety of its own.

// The workspace denies unsafe code; a C ABI is made of it. Each use names its reason.
#![allow(unsafe_code)]
// Stated once, above.
#![allow(clippy::missing_safety_doc)]

mod asked;
pub mod callback;
pub mod edit;
pub mod entry;
pub mod functions;
pub mod handles;
pub mod matching;
pub mod options;
pub mod session;
pub mod session_abi;
pub mod sheet;
pub mod status;
pub mod strokes;
pub mod strokes_abi;
pub mod style;
pub mod style_abi;
pub mod text;
pub mod tween_abi;
pub mod work;

#[cfg(test)]
mod tests;
