//! The clip that is asked for by its names.
//!
//! Names are compared letter by letter. Where no clip has them, the error names what was asked for and the clips whose names are
//! nearest in writing, so that a slip of the pen shows.

use crate::status::Failure;
use rototoon::scene::Clip;
use rototoon::scene::spelling::letters_apart;

/// Number of clips that an error names.
const NAMED: usize = 5;

/// The only clip of a character and a motion. A name that is not given fits every clip.
///
/// # Errors
///
/// [`Failure::Error`] if there is none, or several.
pub fn chosen<'a>(clips: &'a [Clip], character: Option<&str>, motion: Option<&str>) -> Result<&'a Clip, Failure> {
    let fits = |wanted: Option<&str>, value: &str| wanted.is_none_or(|wanted| wanted == value);
    let is_asked = |clip: &&Clip| fits(character, &clip.character) && fits(motion, &clip.motion);
    let mut found: Vec<&Clip> = clips.iter().filter(is_asked).collect();
    if let [only] = found[..] {
        return Ok(only);
    }
    let asked = |what: &str, name: Option<&str>| name.map_or(format!("any {what}"), |name| format!("{what} {name:?}"));
    let asked = format!("options: {}, {}", asked("character", character), asked("motion", motion));
    Err(Failure::Error(if clips.is_empty() {
        format!("{asked}: found no clips at all, expected one of these names")
    } else if found.is_empty() {
        // The order of the file stays among names that are equally near.
        found = clips.iter().collect();
        found.sort_by_key(|clip| apart(character, &clip.character) + apart(motion, &clip.motion));
        let most = if found.len() > NAMED { "the nearest are " } else { "there are " };
        let count = clips.len();
        format!("{asked}: found no such clip among {count}, expected one; {most}{}", listed(&found[..count.min(NAMED)]))
    } else {
        let more = found.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let (count, named) = (found.len(), listed(&found[..found.len().min(NAMED)]));
        format!("{asked}: found {count} such clips, expected the names of one: {named}{more}")
    }))
}

/// Letters between a name that was asked for and another one; upper and lower case are the same.
fn apart(asked: Option<&str>, name: &str) -> usize {
    asked.map_or(0, |asked| letters_apart(&asked.to_lowercase(), &name.to_lowercase()))
}

fn listed(clips: &[&Clip]) -> String {
    let names: Vec<String> = clips.iter().map(|clip| format!("{:?} by {:?}", clip.motion, clip.character)).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clips(names: &[(&str, &str)]) -> Vec<Clip> {
        names.iter().map(|(character, motion)| Clip::new(*character, *motion, Vec::new())).collect()
    }

    fn said(clips: &[Clip], character: Option<&str>, motion: Option<&str>) -> String {
        chosen(clips, character, motion).unwrap_err().to_string()
    }

    #[test]
    fn the_only_clip_of_the_given_names_is_chosen() {
        let clips = clips(&[("Ann", "walk"), ("Ann", "run"), ("Bo", "walk")]);
        let found = |character, motion| chosen(&clips, character, motion).unwrap();
        assert_eq!(found(Some("Ann"), Some("run")), &clips[1]);
        assert_eq!(found(Some("Bo"), None), &clips[2]);
        assert_eq!(chosen(&clips[..1], None, None).unwrap(), &clips[0]);
    }

    #[test]
    fn what_was_asked_for_and_the_nearest_clips_are_named() {
        let few = clips(&[("Ann", "walk"), ("Bo", "walk")]);
        assert_eq!(
            said(&few, Some("Bo"), Some("wlak")),
            "options: character \"Bo\", motion \"wlak\": found no such clip among 2, expected one; there are \"walk\" by \"Bo\", \
             \"walk\" by \"Ann\""
        );
        let mut many =
            clips(&[("Cy", "hop"), ("Cy", "bow"), ("Cy", "fly"), ("Cy", "run"), ("Cy", "sit"), ("Cy", "lie")]);
        many.extend(few);
        let text = said(&many, Some("bo"), Some("walk"));
        let nearest = "among 8, expected one; the nearest are \"walk\" by \"Bo\", \"walk\" by \"Ann\", ";
        assert!(text.contains(nearest), "{text}");
        assert_eq!(text.matches(" by ").count(), NAMED);
        assert!(said(&[], None, None).starts_with("options: any character, any motion: found no clips at all"));
    }

    #[test]
    fn several_clips_are_counted_and_named() {
        let clips = clips(&[("Cy", "hop"), ("Cy", "bow"), ("Cy", "fly"), ("Cy", "run"), ("Cy", "sit"), ("Cy", "lie")]);
        let text = said(&clips, Some("Cy"), None);
        assert!(
            text.starts_with("options: character \"Cy\", any motion: found 6 such clips, expected the names of one: "),
            "{text}"
        );
        assert!(text.ends_with(
            "\"hop\" by \"Cy\", \"bow\" by \"Cy\", \"fly\" by \"Cy\", \"run\" by \"Cy\", \"sit\" by \"Cy\" and 1 more"
        ));
    }
}
