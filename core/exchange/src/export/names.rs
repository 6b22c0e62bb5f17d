//! Names of parts as a format can write them, each once.
//!
//! Some formats lack characters. A name that a format can write stays as it is. A name that it cannot write gets underscores or loses
//! characters, and then a number if a part has that name already. So an import never takes one part for another.

use rototoon_base::scene::Scene;
use std::collections::BTreeSet;

/// What a name without any character that can be written becomes.
const NAMELESS: &str = "part";

/// The names of the scene's parts in a file. `form` gives a name in the characters of the format.
pub(super) fn written(scene: &Scene, form: impl Fn(&str) -> String) -> Vec<String> {
    joined(scene, " ", form)
}

/// The same with what stands before a number, for formats whose names have no blanks.
pub(super) fn joined(scene: &Scene, before: &str, form: impl Fn(&str) -> String) -> Vec<String> {
    let own = || scene.parts.iter().map(|part| (part.name.as_str(), form(&part.name)));
    let mut taken: BTreeSet<String> = own().filter(|(name, form)| name == form).map(|(_, form)| form).collect();
    let mut one = |(name, form): (&str, String)| {
        if name == form {
            return form;
        }
        let form = if form.trim().is_empty() { NAMELESS.to_owned() } else { form };
        let numbered = (2..).map(|number| format!("{form}{before}{number}"));
        let free = std::iter::once(form.clone()).chain(numbered).find(|name| !taken.contains(name)).unwrap_or(form);
        taken.insert(free.clone());
        free
    };
    own().map(&mut one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::{Footage, Part};

    #[test]
    fn names_that_can_be_written_stay_and_others_get_out_of_their_way() {
        let footage =
            Footage { pattern: "%d".into(), first: 0, last: 3, fps: 12.5, width: 40, height: 30, held: false };
        let names = ["a\"b", "a_b", "a{b", "a_b 2", "größe", "\u{1}", "c\""];
        let parts = names.map(|name| Part { name: name.into(), ..Part::default() }).into();
        let form = |name: &str| name.replace(['"', '{'], "_").replace('\u{1}', "");
        let found = written(&Scene { footage, parts }, form);
        assert_eq!(found, ["a_b 3", "a_b", "a_b 4", "a_b 2", "größe", "part", "c_"]);
    }
}
