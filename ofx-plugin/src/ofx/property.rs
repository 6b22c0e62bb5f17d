//! Typed access to properties.

use super::failure::Failure;
use openfx::sys::generic::core::{OfxPropertySetHandle, OfxStatus, kOfxStatErrUnsupported, kOfxStatOK};
use openfx::sys::generic::property::OfxPropertySuiteV1;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::marker::PhantomData;

/// A property set of an object that lives for `'a`.
#[derive(Clone, Copy)]
pub struct Properties<'a> {
    handle: OfxPropertySetHandle,
    suite: &'static OfxPropertySuiteV1,
    owner: PhantomData<&'a ()>,
}

/// Calls a function of a suite. It is an error if the suite lacks the function.
macro_rules! call {
    ($suite:expr, $function:ident, $($argument:expr),* $(,)?) => {
        match $suite.$function {
            // SAFETY: the types of this layer guarantee that the handles are valid. The names are terminated. The pointers
            // are to places of the type that the function writes.
            Some(function) => $crate::ofx::property::check(stringify!($function), unsafe { function($($argument),*) }),
            None => Err($crate::ofx::failure::Failure::Missing(stringify!($function))),
        }
    };
}
pub(super) use call;

/// A status as a result.
pub(super) fn check(function: &'static str, status: OfxStatus) -> Result<(), Failure> {
    if status == kOfxStatOK { Ok(()) } else { Err(Failure::Host { function, status }) }
}

/// A terminated text for the host. It ends before the first zero byte.
pub(super) fn terminated(text: &str) -> CString {
    let end = text.find('\0').unwrap_or(text.len());
    CString::new(&text[..end]).unwrap_or_default()
}

/// A copy of a text of the host; empty for null.
///
/// # Safety
/// The pointer is null or to a terminated string.
pub(super) unsafe fn copied(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: promised by the caller.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

impl<'a> Properties<'a> {
    /// # Safety
    /// The handle is null or that of a property set that lives for `'a`.
    pub(super) unsafe fn new(handle: OfxPropertySetHandle, suite: &'static OfxPropertySuiteV1) -> Self {
        Self { handle, suite, owner: PhantomData }
    }

    fn handle(&self) -> Result<OfxPropertySetHandle, Failure> {
        if self.handle.is_null() {
            return Err(Failure::Host { function: "property set", status: kOfxStatErrUnsupported });
        }
        Ok(self.handle)
    }

    /// Reads a whole number.
    pub fn int(&self, name: &CStr, index: i32) -> Result<i32, Failure> {
        let mut value: c_int = 0;
        call!(self.suite, propGetInt, self.handle()?, name.as_ptr(), index, &mut value)?;
        Ok(value)
    }

    /// Reads a number.
    pub fn double(&self, name: &CStr, index: i32) -> Result<f64, Failure> {
        let mut value = 0.0;
        call!(self.suite, propGetDouble, self.handle()?, name.as_ptr(), index, &mut value)?;
        Ok(value)
    }

    /// Reads a text.
    pub fn text(&self, name: &CStr, index: i32) -> Result<String, Failure> {
        let mut value: *mut c_char = std::ptr::null_mut();
        call!(self.suite, propGetString, self.handle()?, name.as_ptr(), index, &mut value)?;
        // SAFETY: the host gave a terminated string that lives until the property changes.
        Ok(unsafe { copied(value) })
    }

    /// Reads a pointer.
    pub fn pointer(&self, name: &CStr, index: i32) -> Result<*mut c_void, Failure> {
        let mut value = std::ptr::null_mut();
        call!(self.suite, propGetPointer, self.handle()?, name.as_ptr(), index, &mut value)?;
        Ok(value)
    }

    /// Reads `N` whole numbers.
    pub fn ints<const N: usize>(&self, name: &CStr) -> Result<[i32; N], Failure> {
        let mut values = [0; N];
        for (index, value) in values.iter_mut().enumerate() {
            *value = self.int(name, index as i32)?;
        }
        Ok(values)
    }

    /// Reads `N` numbers.
    pub fn doubles<const N: usize>(&self, name: &CStr) -> Result<[f64; N], Failure> {
        let mut values = [0.0; N];
        for (index, value) in values.iter_mut().enumerate() {
            *value = self.double(name, index as i32)?;
        }
        Ok(values)
    }

    /// The number of values of a property.
    pub fn dimension(&self, name: &CStr) -> Result<i32, Failure> {
        let mut count: c_int = 0;
        call!(self.suite, propGetDimension, self.handle()?, name.as_ptr(), &mut count)?;
        Ok(count)
    }

    /// Gives a property its default: those with any number of values become empty.
    pub fn reset(&self, name: &CStr) -> Result<(), Failure> {
        call!(self.suite, propReset, self.handle()?, name.as_ptr())
    }

    /// Sets a whole number.
    pub fn set_int(&self, name: &CStr, index: i32, value: i32) -> Result<(), Failure> {
        call!(self.suite, propSetInt, self.handle()?, name.as_ptr(), index, value)
    }

    /// Sets a number.
    pub fn set_double(&self, name: &CStr, index: i32, value: f64) -> Result<(), Failure> {
        call!(self.suite, propSetDouble, self.handle()?, name.as_ptr(), index, value)
    }

    /// Sets several numbers.
    pub fn set_doubles(&self, name: &CStr, values: &[f64]) -> Result<(), Failure> {
        values.iter().enumerate().try_for_each(|(index, value)| self.set_double(name, index as i32, *value))
    }

    /// Sets a text.
    pub fn set_text(&self, name: &CStr, index: i32, value: &str) -> Result<(), Failure> {
        let value = terminated(value);
        call!(self.suite, propSetString, self.handle()?, name.as_ptr(), index, value.as_ptr())
    }

    /// Sets a text that is already terminated, such as a constant of OpenFX.
    pub fn set_name(&self, name: &CStr, index: i32, value: &CStr) -> Result<(), Failure> {
        call!(self.suite, propSetString, self.handle()?, name.as_ptr(), index, value.as_ptr())
    }

    /// Sets a pointer.
    #[allow(clippy::not_unsafe_ptr_arg_deref, reason = "the host keeps the address; nothing is read through it here")]
    pub fn set_pointer(&self, name: &CStr, index: i32, value: *mut c_void) -> Result<(), Failure> {
        call!(self.suite, propSetPointer, self.handle()?, name.as_ptr(), index, value)
    }
}
