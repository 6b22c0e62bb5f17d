//! The parameters of an effect: describes them, reads their values at a time, and sets them.

use super::failure::Failure;
use super::host::Suites;
use super::property::{Properties, call, copied, terminated};
use openfx::sys::image_effect_v1::param::{OfxParamHandle, OfxParamSetHandle};
use std::ffi::{CStr, c_char, c_int, c_uint};
use std::marker::PhantomData;

/// The parameters of an effect.
#[derive(Clone, Copy)]
pub struct Parameters<'a> {
    set: OfxParamSetHandle,
    suites: Suites,
    effect: PhantomData<&'a ()>,
}

impl<'a> Parameters<'a> {
    /// # Safety
    /// The handle is that of a parameter set that lives for `'a`.
    pub(super) unsafe fn new(set: OfxParamSetHandle, suites: Suites) -> Self {
        Self { set, suites, effect: PhantomData }
    }

    /// Describes a parameter.
    pub fn define(&self, kind: &CStr, id: &CStr) -> Result<Properties<'a>, Failure> {
        let mut properties = std::ptr::null_mut();
        call!(self.suites.parameter, paramDefine, self.set, kind.as_ptr(), id.as_ptr(), &mut properties)?;
        // SAFETY: the property set of the new parameter, which lives for the action.
        Ok(unsafe { Properties::new(properties, self.suites.property) })
    }

    fn handle(&self, id: &CStr) -> Result<OfxParamHandle, Failure> {
        let mut handle = std::ptr::null_mut();
        call!(self.suites.parameter, paramGetHandle, self.set, id.as_ptr(), &mut handle, std::ptr::null_mut())?;
        Ok(handle)
    }

    /// The properties of a parameter of an instance.
    pub fn properties(&self, id: &CStr) -> Result<Properties<'a>, Failure> {
        let mut properties = std::ptr::null_mut();
        call!(self.suites.parameter, paramGetPropertySet, self.handle(id)?, &mut properties)?;
        // SAFETY: the property set of a parameter, which lives as long as the instance.
        Ok(unsafe { Properties::new(properties, self.suites.property) })
    }

    /// The value of a number at a time.
    pub fn double(&self, id: &CStr, time: f64) -> Result<f64, Failure> {
        let mut value = 0.0f64;
        let place: *mut f64 = &mut value;
        call!(self.suites.parameter, paramGetValueAtTime, self.handle(id)?, time, place)?;
        Ok(value)
    }

    /// The value of a whole number, a flag (0 or 1) or a choice (its index) at a time.
    pub fn int(&self, id: &CStr, time: f64) -> Result<i32, Failure> {
        let mut value: c_int = 0;
        let place: *mut c_int = &mut value;
        call!(self.suites.parameter, paramGetValueAtTime, self.handle(id)?, time, place)?;
        Ok(value)
    }

    /// The value of a colour with opacity at a time.
    pub fn colour(&self, id: &CStr, time: f64) -> Result<[f64; 4], Failure> {
        let mut value = [0.0f64; 4];
        let [r, g, b, a] = &mut value;
        let (r, g, b, a): (*mut f64, *mut f64, *mut f64, *mut f64) = (r, g, b, a);
        call!(self.suites.parameter, paramGetValueAtTime, self.handle(id)?, time, r, g, b, a)?;
        Ok(value)
    }

    /// The value of a colour without opacity and without keys.
    pub fn shade(&self, id: &CStr) -> Result<[f64; 3], Failure> {
        let mut value = [0.0f64; 3];
        let [r, g, b] = &mut value;
        let (r, g, b): (*mut f64, *mut f64, *mut f64) = (r, g, b);
        call!(self.suites.parameter, paramGetValue, self.handle(id)?, r, g, b)?;
        Ok(value)
    }

    /// Sets a colour without opacity.
    pub fn set_shade(&self, id: &CStr, [r, g, b]: [f64; 3]) -> Result<(), Failure> {
        call!(self.suites.parameter, paramSetValue, self.handle(id)?, r, g, b)
    }

    /// The value of a text.
    pub fn text(&self, id: &CStr) -> Result<String, Failure> {
        let mut value: *const c_char = std::ptr::null();
        let place: *mut *const c_char = &mut value;
        call!(self.suites.parameter, paramGetValue, self.handle(id)?, place)?;
        // SAFETY: the host gave a terminated string that lives until the parameter changes.
        Ok(unsafe { copied(value) })
    }

    /// Whether a text is the same as a known one. Long texts are compared without a copy.
    pub fn is_text(&self, id: &CStr, known: &str) -> Result<bool, Failure> {
        self.look(id, |text| text == known.as_bytes())
    }

    /// Whether a text has nothing but blanks.
    pub fn is_blank(&self, id: &CStr) -> Result<bool, Failure> {
        self.look(id, |text| text.iter().all(u8::is_ascii_whitespace))
    }

    /// Looks at the bytes of a text, which may be long.
    fn look<T>(&self, id: &CStr, look: impl FnOnce(&[u8]) -> T) -> Result<T, Failure> {
        let mut value: *const c_char = std::ptr::null();
        let place: *mut *const c_char = &mut value;
        call!(self.suites.parameter, paramGetValue, self.handle(id)?, place)?;
        // SAFETY: the host gave null or a terminated string that lives until the parameter changes, and `look` calls no host.
        Ok(look(if value.is_null() { &[] } else { unsafe { CStr::from_ptr(value) }.to_bytes() }))
    }

    /// Runs changes of parameters as one undo step named `label`. A host without edit blocks makes one step per parameter.
    pub fn edit(&self, label: &str, change: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
        let label = terminated(label);
        let begun = call!(self.suites.parameter, paramEditBegin, self.set, label.as_ptr()).is_ok();
        let result = change();
        if begun {
            let _ = call!(self.suites.parameter, paramEditEnd, self.set);
        }
        result
    }

    /// Sets a text. One that is the same already is left, so that no undo step is made.
    pub fn set_text(&self, id: &CStr, value: &str) -> Result<(), Failure> {
        if self.is_text(id, value).unwrap_or(false) {
            return Ok(());
        }
        let value = terminated(value);
        call!(self.suites.parameter, paramSetValue, self.handle(id)?, value.as_ptr())
    }

    /// Sets texts, given by parameter id, as one undo step named `label`.
    pub fn set(&self, label: &str, texts: &[(&CStr, &str)]) -> Result<(), Failure> {
        self.edit(label, || texts.iter().try_for_each(|(id, value)| self.set_text(id, value)))
    }

    /// Sets a whole number, flag or choice for all times.
    pub fn set_int(&self, id: &CStr, value: i32) -> Result<(), Failure> {
        call!(self.suites.parameter, paramSetValue, self.handle(id)?, value)
    }

    /// Sets a number for all times.
    pub fn set_double(&self, id: &CStr, value: f64) -> Result<(), Failure> {
        call!(self.suites.parameter, paramSetValue, self.handle(id)?, value)
    }

    /// Sets a key of a flag or a whole number.
    pub fn set_int_at(&self, id: &CStr, time: f64, value: i32) -> Result<(), Failure> {
        call!(self.suites.parameter, paramSetValueAtTime, self.handle(id)?, time, value)
    }

    /// Sets a key of a number.
    pub fn set_double_at(&self, id: &CStr, time: f64, value: f64) -> Result<(), Failure> {
        call!(self.suites.parameter, paramSetValueAtTime, self.handle(id)?, time, value)
    }

    /// Sets a key of two numbers.
    pub fn set_pair_at(&self, id: &CStr, time: f64, [x, y]: [f64; 2]) -> Result<(), Failure> {
        call!(self.suites.parameter, paramSetValueAtTime, self.handle(id)?, time, x, y)
    }

    /// The times of a parameter's keys. A host without keys has none.
    pub fn keys(&self, id: &CStr) -> Result<Vec<f64>, Failure> {
        let handle = self.handle(id)?;
        let mut count: c_uint = 0;
        let place: *mut c_uint = &mut count;
        if call!(self.suites.parameter, paramGetNumKeys, handle, place).is_err() {
            return Ok(Vec::new());
        }
        let key = |index| {
            let mut time = 0.0f64;
            let place: *mut f64 = &mut time;
            call!(self.suites.parameter, paramGetKeyTime, handle, index, place).map(|()| time)
        };
        (0..count).map(key).collect()
    }

    /// Deletes the key of a parameter at a time.
    pub fn delete_key(&self, id: &CStr, time: f64) -> Result<(), Failure> {
        call!(self.suites.parameter, paramDeleteKey, self.handle(id)?, time)
    }

    /// Deletes all keys of a parameter.
    pub fn delete_keys(&self, id: &CStr) -> Result<(), Failure> {
        call!(self.suites.parameter, paramDeleteAllKeys, self.handle(id)?)
    }
}
