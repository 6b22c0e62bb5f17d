//! Writes the XML archives of Boost.Serialization, as `xml_oarchive` does.
//!
//! An archive has no names for its types. The first element of a C++ class carries three attributes: a number, which counts
//! the classes in the order in which they come, whether objects are tracked (never here), and the version of the class.
//! Later elements of the same class have none. A reader takes elements strictly in the order in which its program reads them,
//! and compares the names of their ends. Containers are classes too: their number of items comes first, then the version of
//! the items, then each item.
//!
//! Source: Boost.Serialization, `boost/archive/impl/basic_xml_oarchive.ipp`, `boost/archive/basic_xml_archive.hpp`,
//! `boost/serialization/collections_save_imp.hpp` and `libs/serialization/src/basic_oarchive.cpp`.

use super::xml::escaped;
use std::fmt::{Display, Write};

/// A C++ class: a name that tells it from others here, and its version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Class(pub &'static str, pub u32);

/// An archive that is being written.
#[derive(Clone, Debug)]
pub struct Archive {
    text: String,
    /// The classes that have had their attributes; the index is the number.
    classes: Vec<Class>,
}

impl Archive {
    /// An empty archive. `version` is that of the library that wrote it: a reader refuses one above its own.
    pub fn new(version: u32) -> Self {
        let text = format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\" ?>\n<!DOCTYPE boost_serialization>\n\
             <boost_serialization signature=\"serialization::archive\" version=\"{version}\">\n"
        );
        Self { text, classes: Vec::new() }
    }

    /// The archive's text.
    pub fn finish(mut self) -> String {
        self.text += "</boost_serialization>\n\n";
        self.text
    }

    /// An element of a class, with what `body` writes into it.
    pub fn object(&mut self, tag: &str, class: Class, body: impl FnOnce(&mut Self)) {
        if self.classes.contains(&class) {
            let _ = writeln!(self.text, "<{tag}>");
        } else {
            let (number, version) = (self.classes.len(), class.1);
            let _ = writeln!(self.text, "<{tag} class_id=\"{number}\" tracking_level=\"0\" version=\"{version}\">");
            self.classes.push(class);
        }
        body(self);
        let _ = writeln!(self.text, "</{tag}>");
    }

    /// A container with `count` items, whose class has version `version`. `body` writes them.
    pub fn container(&mut self, tag: &str, class: Class, count: usize, version: u32, body: impl FnOnce(&mut Self)) {
        self.object(tag, class, |archive| {
            archive.value("count", count);
            archive.value("item_version", version);
            body(archive);
        });
    }

    /// A number.
    pub fn value(&mut self, tag: &str, value: impl Display) {
        let _ = writeln!(self.text, "<{tag}>{value}</{tag}>");
    }

    /// Whether something is so.
    pub fn flag(&mut self, tag: &str, value: bool) {
        self.value(tag, i32::from(value));
    }

    /// A text.
    pub fn text(&mut self, tag: &str, text: &str) {
        self.value(tag, escaped(text));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_first_element_of_a_class_has_attributes() {
        let (outer, inner) = (Class("outer", 3), Class("inner", 0));
        let mut archive = Archive::new(16);
        archive.object("A", outer, |archive| {
            archive.container("B", inner, 1, 2, |archive| archive.text("item", "a < b"));
            archive.container("C", inner, 0, 2, |_| ());
        });
        archive.object("A", outer, |archive| archive.flag("On", true));
        let text = archive.finish();
        let body: Vec<&str> = text.lines().skip(3).collect();
        let wanted = "<A class_id=\"0\" tracking_level=\"0\" version=\"3\">|<B class_id=\"1\" tracking_level=\"0\" \
                      version=\"0\">|<count>1</count>|<item_version>2</item_version>|<item>a &lt; b</item>|</B>|<C>|\
                      <count>0</count>|<item_version>2</item_version>|</C>|</A>|<A>|<On>1</On>|</A>|\
                      </boost_serialization>|";
        assert_eq!(body.join("|"), wanted);
    }
}
