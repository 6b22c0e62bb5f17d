//! Every exported function runs its body through [`entry`] and reads its arguments with the checked readers below.

use crate::status::{Failure, RototoonStatus};
use crate::text::RototoonText;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Most bytes of an argument: the largest size of a Rust object.
pub const MAX_BYTES: usize = isize::MAX as usize;

/// Runs `body`, turns failures and panics into a status, and writes the error text to `error`.
///
/// A panic that crosses into the caller is undefined behaviour, so it is caught here.
///
/// # Safety
/// `error` is null or points to a writable pointer.
pub unsafe fn entry(error: *mut *mut RototoonText, body: impl FnOnce() -> Result<(), Failure>) -> RototoonStatus {
    if !error.is_null() && !error.is_aligned() {
        return RototoonStatus::BadArgument;
    }
    // State that a panic leaves half-changed is dropped here, or it is behind a poisoned mutex, which the session repairs.
    let (status, message) = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => (RototoonStatus::Ok, None),
        Ok(Err(failure)) => (failure.status(), Some(failure.to_string())),
        Err(panic) => (RototoonStatus::Panic, Some(format!("defect in Rototoon: {}", panic_message(panic.as_ref())))),
    };
    if !error.is_null() {
        let text = message.map_or(std::ptr::null_mut(), |message| Box::into_raw(Box::new(RototoonText::new(message))));
        // SAFETY: not null and aligned (above), writable by this function's contract.
        unsafe { error.write(text) };
    }
    status
}

/// Frees a handle. Null is allowed, and ignored.
///
/// # Safety
/// `handle` is null or came from [`give`] and was not freed.
pub unsafe fn free<T>(handle: *mut T) {
    if handle.is_null() || !handle.is_aligned() {
        return;
    }
    // SAFETY: not null, so it came from `Box::into_raw` in `give`, and it is released only here.
    let handle = unsafe { Box::from_raw(handle) };
    // A panic of a destructor is caught here. Leaking the memory that it did not free is better than an abort.
    let _ = catch_unwind(AssertUnwindSafe(move || drop(handle)));
}

fn panic_message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("a panic without a message")
}

/// The array of `length` values at `data`. Null is allowed if the length is 0. `name` names the argument in messages.
///
/// # Safety
/// If `data` is not null, `length` values can be read there during `'a`, and nobody writes to them.
pub unsafe fn slice<'a, T>(data: *const T, length: usize, name: &str) -> Result<&'a [T], Failure> {
    if length == 0 {
        return Ok(&[]);
    }
    if data.is_null() {
        return Err(Failure::BadArgument(format!("{name}: null pointer with length {length}")));
    }
    if !data.is_aligned() {
        let alignment = align_of::<T>();
        return Err(Failure::BadArgument(format!("{name}: pointer is not aligned to {alignment} bytes")));
    }
    if length > MAX_BYTES / size_of::<T>() {
        return Err(Failure::BadArgument(format!("{name}: length {length} is more than memory can hold")));
    }
    // SAFETY: not null, aligned, not longer than the largest object, readable by this function's contract.
    Ok(unsafe { std::slice::from_raw_parts(data, length) })
}

/// The UTF-8 text of `length` bytes at `data`.
///
/// # Safety
/// The same as [`slice()`].
pub unsafe fn text<'a>(data: *const u8, length: usize, name: &str) -> Result<&'a str, Failure> {
    // SAFETY: the same contract.
    let bytes = unsafe { slice(data, length, name) }?;
    std::str::from_utf8(bytes).map_err(|error| Failure::BadArgument(format!("{name}: not UTF-8: {error}")))
}

/// The handle at `handle`.
///
/// # Safety
/// `handle` is null or came from [`give`] and is not freed during `'a`.
pub unsafe fn handle<'a, T>(handle: *const T, name: &str) -> Result<&'a T, Failure> {
    if handle.is_null() || !handle.is_aligned() {
        return Err(Failure::BadArgument(format!(
            "{name}: {} handle",
            if handle.is_null() { "null" } else { "misaligned" }
        )));
    }
    // SAFETY: not null and aligned, alive by this function's contract; handles are only ever shared, never `&mut`.
    Ok(unsafe { &*handle })
}

/// Checks an out parameter and sets it to `empty`, so that its value is defined even if the call fails.
///
/// # Safety
/// `out` is null or writable.
pub unsafe fn clear<T>(out: *mut T, empty: T, name: &str) -> Result<(), Failure> {
    if out.is_null() || !out.is_aligned() {
        let what = if out.is_null() { "null" } else { "misaligned" };
        return Err(Failure::BadArgument(format!("{name}: {what} out parameter")));
    }
    // SAFETY: not null, aligned, writable by this function's contract.
    unsafe { out.write(empty) };
    Ok(())
}

/// Gives a new handle to the caller, who frees it with the `_free` function of its type.
///
/// # Safety
/// [`clear`] has accepted `out` in the same call.
pub unsafe fn give<T>(out: *mut *mut T, value: T) {
    // SAFETY: accepted by `clear`.
    unsafe { out.write(Box::into_raw(Box::new(value))) };
}
