//! What files of shapes for other programs leave out, as messages for the user.

use super::strokes;
use crate::export;
use crate::project::Document;
use crate::scene::Part;

/// What shapes for other programs leave out; `None` if they have everything. Other programs let a border fade outward from the contour, or alike all
/// around. Neither is the feather of control points. Some have a falloff for such a feather, and some lack characters of names. None has an order of
/// parts that changes. In SVG a stroke has one width along it. `extension`, in small letters, names the form.
pub fn left_out_of_shapes(document: &Document, extension: &str) -> Option<String> {
    let listed = |lacks: &dyn Fn(&Part) -> bool| {
        let names = document.scene.parts.iter().filter(|part| lacks(part)).map(|part| format!("{:?}", part.name));
        Some(names.collect::<Vec<_>>().join(", ")).filter(|names| !names.is_empty())
    };
    let feather = listed(&|part| part.soft_widths().is_some());
    let feather =
        feather.map(|names| format!("the shapes are sharp: the file has no feather of the points of {names}"));
    let falloff = listed(&|part| !export::has_falloff(extension, part.falloff));
    let falloff = falloff.map(|names| format!("the file has no such falloff, or only its rate, as that of {names}"));
    let footage = &document.scene.footage;
    let order = listed(&|part| part.depth_in(footage.first..=footage.last).is_none());
    let order =
        order.map(|names| format!("the file has one order of parts for all frames, and the depth changes of {names}"));
    let varying = (extension == "svg").then(|| strokes::varying(document)).flatten();
    let told: Vec<String> =
        [feather, falloff, renamed(document, extension), order, varying].into_iter().flatten().collect();
    (!told.is_empty()).then(|| told.join("; "))
}

/// The parts that have another name in the file. Only what is written can have one.
fn renamed(document: &Document, extension: &str) -> Option<String> {
    let bare = |name: &str| document.scene.part_index(name).is_ok_and(|k| document.scene.parts[k].is_bare());
    let renamed = export::renamed(&document.scene, extension).into_iter().filter(|(own, _)| !bare(own));
    let renamed: Vec<String> = renamed.map(|(own, there)| format!("{own:?} is {there:?} there")).collect();
    (!renamed.is_empty()).then(|| format!("the file cannot have some names: {}", renamed.join(", ")))
}

/// What is told if a form does not say that the pixels of the footage are not square.
pub fn squeezed(pixel_aspect: f64, extension: &str) -> Option<String> {
    let lost = pixel_aspect != 1.0 && !export::has_pixel_aspect(extension);
    lost.then(|| {
        format!("a pixel of the footage is {pixel_aspect} times as wide as high, and the file does not say so")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Footage, Scene};

    #[test]
    fn what_a_form_cannot_have_is_named() {
        let footage =
            Footage { pattern: "%d.png".into(), first: 1, last: 9, fps: 12.0, width: 64, height: 48, held: false };
        let part = |name: &str, depths: &[(i32, f64)]| Part {
            name: name.into(),
            depths: depths.iter().copied().collect(),
            ..Part::default()
        };
        let always: Vec<(i32, f64)> = (1..=9).map(|frame| (frame, 4.0)).collect();
        let parts = vec![part("arm", &[(3, 2.0)]), part("leg", &[(3, 0.0)]), part("hat", &always), part("head", &[])];
        let document = Document::new(Scene { footage, parts });
        for form in ["nk", "svg", "fxs", "setting", "jsx", "ntp", "py"] {
            let told = left_out_of_shapes(&document, form).unwrap();
            assert!(told.ends_with("the depth changes of \"arm\""), "{form}: {told}");
        }
        assert_eq!(squeezed(1.0, "svg"), None);
        assert_eq!(squeezed(2.0, "nk"), None);
        assert!(squeezed(2.0, "svg").unwrap().starts_with("a pixel of the footage is 2 times as wide as high"));
    }
}
