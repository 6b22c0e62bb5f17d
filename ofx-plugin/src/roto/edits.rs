//! Stores edits and selections in the host's parameters, each as one step of the host's undo.

use super::edit::{Edit, Outcome, Refused, Selection, Work, absence, change, naming, order};
use super::job::Tracked;
use super::parts::{meant, selected};
use super::reach::{self, Reach};
use super::settings::Settings;
use super::shared::Loaded;
use super::state::{FileMark, State};
use super::{follow, footage, fresh, instance, listing, marks, page, stored};
use crate::ofx::{Effect, Failure, Parameters};
use rototoon::geometry::Point;
use rototoon::project::Document;
use rototoon::scene::{FrameNumber, NoSuchPart, Part};
use std::ffi::CStr;
use std::path::Path;
use std::sync::Arc;

/// The parameters that name parts in lists.
const LISTS: [&CStr; 5] = [c"parts", c"redParts", c"greenParts", c"blueParts", c"alphaParts"];

/// Whether the pen must not change a part.
pub fn is_locked(parameters: &Parameters, state: &State, name: &str) -> bool {
    if state.page == name {
        return parameters.int(c"partLock", 0.0).is_ok_and(|lock| lock != 0);
    }
    state.parts.get(name).is_some_and(|settings| settings.lock)
}

/// Stores an edited document. An edit at a time of the host is followed at once where *Live* can, in the same step of undo.
pub fn store(effect: &Effect, label: &str, document: Document, live: Option<f64>) -> Result<(), Failure> {
    let hidden = hidden_new(effect, &document)?;
    let list = effect.parameters()?.text(c"parts")?;
    let names = [list.trim().trim_end_matches([',', ' '])].into_iter().chain(hidden.iter().map(|name| &**name));
    let list = (!hidden.is_empty()).then(|| names.collect::<Vec<_>>().join(", "));
    store_from(effect, label, document, live, Kind::Drawn { list })
}

/// The new parts of a document that **Parts** does not name, so that they would not be shown.
pub fn hidden_new(effect: &Effect, document: &Document) -> Result<Vec<String>, Failure> {
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    // Project may name a file that is no document.
    let (before, list) = (instance.document(&parameters).ok().flatten(), parameters.text(c"parts")?);
    let shown = selected(&document.scene.parts, &list).0;
    let is_known = |name: &str| before.iter().any(|before| before.scene.parts.iter().any(|part| part.name == name));
    let parts = document.scene.parts.iter().enumerate();
    let hidden = parts.filter(|(index, part)| !shown.contains(index) && !is_known(&part.name));
    Ok(hidden.map(|(_, part)| part.name.clone()).collect())
}

/// Stores a document with the shapes of a file of another program.
pub fn store_imported(effect: &Effect, document: Document, path: &str) -> Result<(), Failure> {
    store_from(effect, "Import shapes", document, None, Kind::Imported { path })
}

/// How an edited document came about.
enum Kind<'a> {
    /// With the pen and the buttons. **Parts** becomes this list, if there is one.
    Drawn { list: Option<String> },
    /// From a file of another program.
    Imported { path: &'a str },
}

fn store_from(
    effect: &Effect,
    label: &str,
    mut document: Document,
    live: Option<f64>,
    kind: Kind,
) -> Result<(), Failure> {
    let problems = document.problems();
    if problems.error_count() > 0 {
        return Err(Failure::Told(problems.to_string()));
    }
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    let shown = adopted(effect, &mut document)?;
    let before =
        if shown.is_some() { instance.document(&parameters)? } else { instance.document_of_text(&parameters)? };
    let edited = |state: &mut State, document: &Document| {
        shown.iter().for_each(|file| state.note_file(file));
        if let Kind::Imported { path } = kind {
            path.clone_into(&mut state.loaded);
        }
        if let Some(before) = &before {
            state.note_known(&before.scene.parts);
            state.note_changed(&before.scene.parts, &document.scene.parts, &document.scene.footage);
            state.note_order(&before.scene.parts, &document.scene.parts);
            let stale = instance.stale();
            state.note_stale(before.scene.parts.iter().filter(|part| stale.has(part)));
        }
        state.keep_only(&document.scene.parts);
    };
    let mut state = State::clone(&*instance.state(&parameters)?);
    edited(&mut state, &document);
    let old = document.scene.parts.iter().any(|part| state.is_old(part));
    let followed = live.filter(|_| old).and_then(|time| follow::follow(effect, &document, time));
    // The settings are read again, because the host may have changed them while the progress was shown.
    let mut state = State::clone(&*instance.state(&parameters)?);
    let page = state.page.clone();
    edited(&mut state, &document);
    if let Some(followed) = followed {
        state.note_tracked_spans(&document.scene.parts, &followed);
        document = followed.document;
    }
    let list = if let Kind::Drawn { list } = &kind { list.as_deref() } else { None };
    write(effect, label, &document, (state, &page), list)?;
    let longer = before.and_then(|before| reach::told(&before.scene.footage, &document.scene.footage));
    if let Some(text) = longer {
        instance.note(effect, &text, false);
    }
    Ok(())
}

/// The file that is only shown so far, if this document of it is to be the composition's own. The composition has no folder,
/// so the footage gets an absolute path.
fn adopted(effect: &Effect, document: &mut Document) -> Result<Option<FileMark>, Failure> {
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    if instance.document_of_text(&parameters)?.is_some() {
        return Ok(None);
    }
    let file = instance.shown_file(&parameters)?;
    file.iter().for_each(|file| footage::make_absolute(document, Path::new(&file.path)));
    Ok(file)
}

/// Stores a tracked document. `before` are its parts before that.
pub fn store_tracked(effect: &Effect, before: &[Part], mut tracked: Tracked) -> Result<(), Failure> {
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    let mut state = State::clone(&*instance.state(&parameters)?);
    adopted(effect, &mut tracked.document)?.iter().for_each(|file| state.note_file(file));
    state.note_tracked_spans(before, &tracked);
    let page = state.page.clone();
    write(effect, "Track", &tracked.document, (state, &page), None)
}

/// Stores a document that replaces the composition's, with its parts' settings where the names are the same.
pub fn store_loaded(effect: &Effect, document: &Document, file: &FileMark) -> Result<(), Failure> {
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    let mut state = State::clone(&*instance.state(&parameters)?);
    let page = state.page.clone();
    state.tracked.clear();
    state.changed.clear();
    state.note_file(file);
    state.keep_only(&document.scene.parts);
    write(effect, "Load project", document, (state, &page), None)
}

/// Puts a document and a state into the parameters as one step, and a list into **Parts** if there is one.
fn write(
    effect: &Effect,
    label: &str,
    document: &Document,
    (state, page): (State, &str),
    list: Option<&str>,
) -> Result<(), Failure> {
    let parameters = effect.parameters()?;
    parameters.edit(label, || {
        if let Some(list) = list {
            parameters.set_text(c"parts", list)?;
        }
        put(&parameters, document, state, page)
    })?;
    listing::refresh(effect);
    Ok(())
}

/// Puts a document and a state into the parameters, within an edit. `page` is the part that the page shows.
///
/// Undo goes the other way, and a host may report each value that comes back as the user's change. So the document is last
/// here: it is back first, then the state, and a selection that comes back finds its part.
fn put(parameters: &Parameters, document: &Document, state: State, page: &str) -> Result<(), Failure> {
    if state.page != page {
        // The part of the page is gone, or has another name.
        page::show(parameters, &state.parts.get(&state.page).cloned().unwrap_or_default())?;
        parameters.set_text(c"part", &state.page)?;
    }
    parameters.set_text(c"state", &if state == State::default() { String::new() } else { state.to_text() })?;
    parameters.set_text(c"partNames", &listing::text(document))?;
    marks::set(parameters, document);
    parameters.set_text(c"document", &stored::encode(&document.to_json()))
}

/// Selects a part by name: the page shows its settings, and what is drawn becomes its key. An empty name selects none.
pub fn select(effect: &Effect, name: &str) -> Result<(), Failure> {
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    let document = instance.document(&parameters)?;
    let name = document.as_ref().map_or(name.trim(), |all| meant(&all.scene.parts, name));
    let known = document.as_ref().is_some_and(|all| all.scene.parts.iter().any(|part| part.name == name));
    let mut state = State::clone(&*instance.state(&parameters)?);
    parameters.edit("Select part", || {
        if let Some(document) = document.as_ref().filter(|_| known && state.page != name) {
            // Compositions of earlier versions, and projects that are not loaded, have no names yet. A selection that
            // changes nothing changes nothing here either: the host's undo comes here too.
            parameters.set_text(c"partNames", &listing::text(document))?;
        }
        page::turn(&parameters, &mut state, if known { name } else { "" })?;
        parameters.set_text(c"part", name)?;
        parameters.set_text(c"state", &if state == State::default() { String::new() } else { state.to_text() })
    })?;
    listing::refresh(effect);
    Ok(())
}

/// A parameter of the page has been changed by the user, or by the host's undo. The part that the page shows has its values
/// from the parameters; they are stored when the page turns. So nothing is written here, and an undo stays one.
pub fn page_changed(effect: &Effect, id: &str) -> Result<(), Failure> {
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    if instance.state(&parameters)?.page.is_empty() && !page::is_default(&parameters, id)? {
        return Err(Failure::Told("select a part first: its name is in Part".into()));
    }
    Ok(())
}

/// What the edit buttons work on.
struct Bench {
    document: Arc<Loaded>,
    frame: FrameNumber,
    /// The parts that may be changed, the farthest first.
    parts: Vec<usize>,
    /// Index of the part that is named in Part.
    chosen: Option<usize>,
    /// The number in Place.
    place: usize,
    /// The frames of the source.
    reach: Reach,
}

impl Bench {
    fn of(effect: &Effect, time: f64) -> Result<Self, Failure> {
        let (instance, parameters) = (instance(effect)?, effect.parameters()?);
        let document = match instance.document(&parameters)? {
            Some(document) => document,
            None => Arc::new(Loaded::new(fresh::document(effect, time)?)),
        };
        let state = instance.state(&parameters)?;
        let settings = Settings::read(&parameters, time, &state)?;
        let frame = settings.frame();
        let mut parts = selected(&document.scene.parts, &settings.parts).0;
        parts.retain(|&part| !is_locked(&parameters, &state, &document.scene.parts[part].name));
        order::sort_on(&document.scene, frame, &mut parts);
        let text = parameters.text(c"part")?;
        let name = meant(&document.scene.parts, &text);
        let chosen = document.scene.parts.iter().position(|part| part.name == name);
        if !name.is_empty() && chosen.is_none() {
            return Err(Failure::Told(format!("Part: {}", NoSuchPart::of(&document.scene.parts, name))));
        }
        if let Some(part) = chosen.filter(|part| !parts.contains(part)) {
            return Err(Failure::Told(Refused::protected(&document.scene.parts[part].name).0));
        }
        let place = usize::try_from(parameters.int(c"place", time)?).unwrap_or(1);
        Ok(Self { document, frame, parts, chosen, place, reach: Reach::of(effect)? })
    }

    fn work(&self) -> Work<'_> {
        Work {
            document: &self.document,
            frame: self.frame,
            parts: &self.parts,
            lens: super::edit::Lens::new(Point::ONE),
            tool: super::edit::Tool::Select,
            closed: true,
            name: "",
            reach: self.reach,
        }
    }

    /// The part that is named in Part, or else all parts.
    fn chosen_or_all(&self) -> Vec<usize> {
        self.chosen.map_or_else(|| self.parts.clone(), |part| vec![part])
    }

    fn chosen(&self) -> Result<usize, Refused> {
        self.chosen.ok_or_else(|| Refused("select a part first: its name is in Part".into()))
    }
}

/// Presses an edit button.
pub fn press(effect: &Effect, name: &str, time: f64) -> Result<(), Failure> {
    if name == "newPart" {
        instance(effect)?.editor().selection = Selection::default();
        return select(effect, "");
    }
    let bench = Bench::of(effect, time)?;
    let work = bench.work();
    let width = effect.parameters()?.double(c"pointFeather", time)?;
    let outcome = {
        let mut editor = instance(effect)?.editor();
        editor.follow(&bench.document.scene);
        match name {
            "insertPoints" => editor.insert_between(&work),
            "deletePoints" if editor.selection.is_empty() => refused("select points first"),
            "deletePoints" => editor.delete_selected(&work),
            "smoothPoints" => editor.smooth_selected(&work),
            "featherPoints" => editor.feather_selected(&work, width),
            _ => on_parts(&bench, name),
        }
    };
    match outcome {
        Outcome::Edited(Edit { label, document }) => store(effect, label, document, Some(time)),
        Outcome::Refused(refused) => Err(Failure::Told(refused.0)),
        _ => Ok(()),
    }
}

/// Gives the selected part the name in New name: in the document, in its settings, and in the lists of parts.
pub fn rename(effect: &Effect, time: f64) -> Result<(), Failure> {
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    let new = parameters.text(c"newName")?;
    let new = new.trim();
    let bench = Bench::of(effect, time)?;
    let mut document = Document::clone(&bench.document);
    let old = bench.chosen().and_then(|part| {
        let old = document.scene.parts[part].name.clone();
        naming::rename(&mut document, part, new).map(|()| old)
    });
    let old = old.map_err(|refused| Failure::Told(refused.0))?;
    let mut state = State::clone(&*instance.state(&parameters)?);
    // Keys that the user has moved in the host's own editor are on the page only.
    page::stored(&parameters, &mut state)?;
    adopted(effect, &mut document)?.iter().for_each(|file| state.note_file(file));
    let page = state.page.clone();
    state.rename(&old, new);
    parameters.edit("Rename part", || {
        for list in LISTS {
            parameters
                .set_text(list, &naming::in_list(&parameters.text(list)?, &bench.document.scene.parts, &old, new))?;
        }
        parameters.set_text(c"part", new)?;
        put(&parameters, &document, state, &page)
    })?;
    instance.editor().rename(&old, new);
    listing::refresh(effect);
    Ok(())
}

fn refused(text: &str) -> Outcome {
    Outcome::Refused(Refused(text.into()))
}

/// The buttons that change whole parts.
fn on_parts(bench: &Bench, name: &str) -> Outcome {
    let mut document = bench.work().draft();
    let frame = bench.frame;
    let part = bench.chosen.map_or_else(String::new, |part| format!("{:?}", document.scene.parts[part].name));
    let (label, nothing, done) = match name {
        "newKey" => (
            "New key",
            format!("frame {frame}: every part has a key here already, or none anywhere"),
            change::new_key(&mut document, bench.frame, &bench.chosen_or_all()),
        ),
        "deleteKey" => (
            "Delete key",
            format!("{part} has no key on frame {frame}"),
            bench.chosen().and_then(|part| change::delete_key(&mut document, bench.frame, &[part])),
        ),
        "hideHere" | "hideStretch" => (
            "Hide part",
            String::new(),
            bench
                .chosen()
                .and_then(|part| absence::toggle(&mut document, part, bench.frame, name == "hideStretch"))
                .map(|()| true),
        ),
        "moveToPlace" => (
            "Order of parts",
            format!("{part} is at this place already"),
            bench.chosen().and_then(|part| order::move_to(&mut document, part, bench.place)),
        ),
        "nearer" | "farther" => (
            "Order of parts",
            String::new(),
            bench.chosen().and_then(|part| order::shift(&mut document, part, name == "nearer")).map(|()| true),
        ),
        _ => {
            let done = bench.chosen().and_then(|part| change::delete_part(&mut document, part));
            ("Delete part", String::new(), done.map(|()| true))
        }
    };
    match done {
        Ok(true) => Outcome::Edited(Edit { label, document }),
        Ok(false) => refused(&nothing),
        Err(refused) => Outcome::Refused(refused),
    }
}
