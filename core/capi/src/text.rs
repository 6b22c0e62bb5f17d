//! Text that calls hand out.

/// UTF-8 text: an error message or a JSON document.
pub struct RototoonText(pub(crate) String);

impl RototoonText {
    /// A text.
    pub fn new(text: impl Into<String>) -> Self {
        Self(text.into())
    }
}
