//! Gives a part another name.

use super::Refused;
use super::change::has_limbs;
use crate::roto::parts::selected;
use rototoon::project::Document;
use rototoon::scene::Part;

/// Renames a part. The name must be free.
pub fn rename(document: &mut Document, part: usize, name: &str) -> Result<(), Refused> {
    let old = document.scene.parts.get(part).map(|part| part.name.clone());
    let old = old.ok_or_else(|| Refused::new("the part is gone"))?;
    if name.is_empty() {
        return Err(Refused::new("write the new name in New name first"));
    }
    check(name, "New name")?;
    if document.scene.parts.iter().any(|part| part.name == name) {
        return Err(Refused::new(format!("a part has the name {name:?} already")));
    }
    if has_limbs(document, &old)? {
        return Err(Refused::new(format!("limbs of the project are bound to {old:?}: rename it in Blender")));
    }
    document.scene.parts[part].name = name.to_owned();
    Ok(())
}

/// Refuses the name of a new part that lists of parts cannot have. `field` names the parameter with it.
pub fn check(name: &str, field: &str) -> Result<(), Refused> {
    if name.contains([',', '*']) {
        return Err(Refused::new(format!(
            "{field}: found {name:?}, expected a name without \",\" and \"*\", which lists of parts need"
        )));
    }
    Ok(())
}

/// A list of names with commas, with another name for a part. `parts` have their names before that. Patterns with `*` stay. An entry that
/// names several parts, which differ by blanks at their ends, names the renamed one beside them.
pub fn in_list(list: &str, parts: &[Part], old: &str, new: &str) -> String {
    let renamed = |entry: &str| {
        let name = entry.trim();
        let meant = selected(parts, name).0;
        if name.is_empty() || name != old && name.contains('*') || !meant.iter().any(|part| parts[*part].name == old) {
            return entry.to_owned();
        }
        if meant.len() == 1 { entry.replacen(name, new, 1) } else { format!("{entry}, {new}") }
    };
    list.split(',').map(renamed).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::scene::{Footage, Scene};

    #[test]
    fn a_name_is_free_and_not_empty() {
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 24.0, width: 8, height: 8, held: false };
        let parts = ["a", "b"].map(|name| Part { name: name.into(), ..Part::default() }).into();
        let mut document = Document::new(Scene { footage, parts });
        for (name, why) in
            [("", "New name"), ("b", "already"), ("a", "already"), ("a, left", "without"), ("a*", "without")]
        {
            assert!(rename(&mut document, 0, name).unwrap_err().0.contains(why), "{name:?}");
        }
        rename(&mut document, 0, "größe").unwrap();
        assert_eq!(document.scene.parts.iter().map(|part| part.name.as_str()).collect::<Vec<_>>(), ["größe", "b"]);
        assert!(rename(&mut document, 7, "c").is_err());
    }

    #[test]
    fn lists_name_the_part_by_its_new_name() {
        let parts = |names: &[&str]| {
            names.iter().map(|&name| Part { name: name.into(), ..Part::default() }).collect::<Vec<_>>()
        };
        let arms = parts(&["arm", "far arm", "arm *"]);
        assert_eq!(in_list("arm, far arm,arm *", &arms, "arm", "hand"), "hand, far arm,arm *");
        assert_eq!(in_list("", &arms, "arm", "hand"), "");
        // Lists name parts without the blanks at their ends.
        let blank = parts(&["arm ", "leg"]);
        assert_eq!(in_list(" arm ,leg, a*", &blank, "arm ", "hand"), " hand ,leg, a*");
        assert_eq!(in_list("arm", &parts(&["arm", "arm "]), "arm ", "hand"), "arm", "it names the other one");
        assert_eq!(in_list("arm,leg", &parts(&[" arm", "arm "]), "arm ", "hand"), "arm, hand,leg");
    }
}
