//! Watches whether the source is still the one that the last Track saw.
//!
//! Some hosts do not tell a node that something further up has changed. With *Live*, edits would then be tracked on frames that
//! are no longer shown. So wherever a render reads the source, its pixels are compared with the sums of the film's frame. If
//! they differ, the film is dropped, and the tracks are old until the next Track.

use super::film::Film;
use super::instance;
use super::sums::Sums;
use crate::ofx::entry::Action;
use crate::ofx::{Bounds, Effect, Image, host};
use openfx::sys::image_effect_v1::image_effect::{
    kOfxImageEffectPropFieldToRender, kOfxImageEffectPropRenderQualityDraft, kOfxImageFieldBoth, kOfxImageFieldNone,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The view of a stereo picture in Nuke and Natron. Track sees the first one.
const VIEW: &std::ffi::CStr = c"uk.co.thefoundry.OfxImageEffectPropView";

/// Compares a rendered source with a frame of the film.
pub struct Watch {
    film: Arc<Film>,
    sums: Arc<Sums>,
    differs: AtomicBool,
}

impl Watch {
    /// A watch over an image of the source; `None` if there is nothing to compare it with: no film, another scale, size or
    /// format, one of two fields, another view, or a draft.
    pub fn of(action: &Action, image: Option<&Image>, time: f64, scale: [f64; 2]) -> Option<Self> {
        let film = instance(&action.effect).ok()?.film()?;
        let field = action.input.text(kOfxImageEffectPropFieldToRender, 0).unwrap_or_default();
        let whole = ["".as_bytes(), kOfxImageFieldNone.to_bytes(), kOfxImageFieldBoth.to_bytes()];
        let set = |property| action.input.int(property, 0).is_ok_and(|value| value != 0);
        let other_view = host::views() && set(VIEW);
        if scale != [1.0; 2]
            || !whole.contains(&field.as_bytes())
            || other_view
            || set(kOfxImageEffectPropRenderQualityDraft)
        {
            return None;
        }
        let (image, sums) = (image?, film.sums(time)?);
        sums.compares(image).then(|| Self { film, sums, differs: AtomicBool::new(false) })
    }

    /// Looks at row `y` of a window in the source's image.
    pub fn look(&self, image: &Image, window: &Bounds, y: i32) {
        if !self.differs.load(Ordering::Relaxed) && self.sums.differs(image, y, window.x1, window.x2) {
            self.differs.store(true, Ordering::Relaxed);
        }
    }

    /// Drops the film and says so, if a pixel differed.
    pub fn end(self, effect: &Effect, time: f64) {
        if !self.differs.into_inner() {
            return;
        }
        let Ok((instance, parameters)) = instance(effect).and_then(|own| Ok((own, effect.parameters()?))) else {
            return;
        };
        let document = instance.document(&parameters).ok().flatten();
        if instance.drop_film(&self.film, document.as_ref().map_or(&[], |document| &document.scene.parts)) {
            let text =
                format!("frame {time} of Source has changed since the last Track, so the tracks are old: track again");
            instance.note(effect, &text, false);
        }
    }
}
