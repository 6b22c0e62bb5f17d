//! The overlay over the viewer: hands the events of the pen and the keyboard to the editor, stores its edits, and draws.
//!
//! An edit is stored in the hidden document when the pen goes up, as one step of the host's own undo. While the pen drags,
//! only the overlay changes. Everything the editor works on is read anew for each event, because the host may have undone a
//! step or set a parameter in between.

use super::edit::{Edit, Editor, Key, Lens, Outcome, Tool, Work, order};
use super::parts::{meant, selected};
use super::placement::Placement;
use super::reach::Reach;
use super::settings::{self, Settings};
use super::shared::Loaded;
use super::stale::Stale;
use super::state::State;
use super::{canvas, edits, fresh, instance};
use crate::ofx::Failure;
use crate::ofx::interact::{Event, View};
use openfx::sys::image_effect_v1::key_syms;
use rototoon::geometry::Point;
use rototoon::scene::{Colour, FrameNumber, Part};
use std::collections::BTreeMap;
use std::sync::Arc;

/// What the viewer shows.
pub struct Shown {
    /// The document; one without parts if the composition has none.
    pub document: Arc<Loaded>,
    /// The shown parts, the farthest first.
    pub parts: Vec<usize>,
    /// Those of them that the pen may change.
    unlocked: Vec<usize>,
    /// The parameters' values.
    pub settings: Settings,
    /// The settings of parts, and what their tracks were made from.
    state: Arc<State>,
    stale: Stale,
    /// The colours that the user has chosen.
    colours: BTreeMap<String, [f64; 3]>,
    /// The placement of the footage.
    pub placement: Placement,
    /// Distances on the screen.
    pub lens: Lens,
    tool: Tool,
    closed: bool,
    /// Name of the selected part.
    pub name: String,
    reach: Reach,
}

impl Shown {
    fn of(view: &View) -> Result<Self, Failure> {
        let (instance, parameters) = (instance(&view.effect)?, view.effect.parameters()?);
        // Rendering reports the errors of a document and of settings.
        let quiet = |_| Failure::Default;
        let document = match instance.document(&parameters).map_err(quiet)? {
            Some(document) => document,
            None => Arc::new(Loaded::new(fresh::document(&view.effect, view.time)?)),
        };
        let state = instance.state(&parameters).map_err(quiet)?;
        let settings = Settings::read(&parameters, view.time, &state)?;
        let mut parts = selected(&document.scene.parts, &settings.parts).0;
        order::sort_on(&document.scene, settings.frame(), &mut parts);
        let locked = |part: &usize| edits::is_locked(&parameters, &state, &document.scene.parts[*part].name);
        let unlocked = parts.iter().copied().filter(|part| !locked(part)).collect();
        let placement = Placement::of(&view.effect, &document.scene.footage, view.time, [1.0; 2])?;
        let size = |p: Point| Point::from(placement.shown(p)) / Point::from(view.pixel);
        let lens =
            Lens::new(Point::new((size(Point::X) - size(Point::ZERO)).x, (size(Point::Y) - size(Point::ZERO)).y));
        let tool = tool(parameters.int(c"tool", view.time)?);
        let (closed, name) = (parameters.int(c"drawClosed", view.time)? != 0, parameters.text(c"part")?);
        let (name, stale) = (meant(&document.scene.parts, &name).into(), instance.stale());
        let (colours, reach) = (settings::colours(&parameters, &state)?, Reach::of(&view.effect)?);
        Ok(Self {
            document,
            parts,
            unlocked,
            settings,
            state,
            stale,
            colours,
            placement,
            lens,
            tool,
            closed,
            name,
            reach,
        })
    }

    /// The colour of a part.
    pub fn colour(&self, index: usize) -> Colour {
        let part = &self.document.scene.parts[index];
        let chosen = self.colours.get(&part.name).map(|colour| colour.map(|value| value as f32));
        chosen.unwrap_or_else(|| part.shown_colour(index))
    }

    /// Whether the tracks of a part are older than its keys and corrections, or than the source.
    pub fn is_old(&self, part: &Part) -> bool {
        self.state.is_old(part) || self.stale.has(part)
    }

    /// The document's frame at the viewer's time; `None` between frames.
    pub fn frame(&self) -> Option<FrameNumber> {
        let time = self.settings.document_time;
        (time.fract() == 0.0 && time.abs() < 1e9).then_some(time as FrameNumber)
    }

    /// What an event works on.
    pub fn work(&self, frame: FrameNumber) -> Work<'_> {
        Work {
            document: &self.document,
            frame,
            parts: &self.unlocked,
            lens: self.lens,
            tool: self.tool,
            closed: self.closed,
            name: &self.name,
            reach: self.reach,
        }
    }
}

/// The tool of an index.
pub fn tool(index: i32) -> Tool {
    match index {
        1 => Tool::Contour,
        2 => Tool::Freehand,
        3 => Tool::Off,
        _ => Tool::Select,
    }
}

/// Handles an event of the viewer.
pub fn perform(view: &View) -> Result<(), Failure> {
    let instance = instance(&view.effect)?;
    if view.event == Event::Left {
        instance.editor().release_keys();
        return Err(Failure::Default);
    }
    if view.event == Event::Move && !instance.is_tracking() && instance.editor().is_idle() {
        // The commonest event by far.
        return Err(Failure::Default);
    }
    let shown = match Shown::of(view) {
        Err(Failure::Told(text)) => return cannot_draw(view, &text),
        shown => shown?,
    };
    if view.event == Event::Draw {
        // A copy, so that the host may call back while it draws.
        let mut editor = instance.editor().clone();
        editor.follow(&shown.document.scene);
        canvas::draw(view, &shown, &editor);
        return Ok(());
    }
    let frame = shown.frame().ok_or(Failure::Default)?;
    if instance.is_tracking() {
        // The shapes stay as they are, but keys that are held down or released count afterwards.
        if let Some(key @ (Key::Shift(_) | Key::Control(_))) = key(view.key, view.event == Event::KeyDown)
            && matches!(view.event, Event::KeyDown | Event::KeyUp)
        {
            instance.editor().key(&shown.work(frame), key);
        }
        return Ok(());
    }
    // The editor is free again before the host is called.
    let (unfinished, outcome) = {
        let mut editor = instance.editor();
        let unfinished = if view.event == Event::Move { None } else { editor.unfinished() };
        (unfinished, happen(view, &shown, frame, &mut editor))
    };
    let edits = matches!(outcome, Outcome::Edited(_));
    let result = keep(view, &shown, outcome);
    if edits && let Err(Failure::Told(text)) = &result {
        // The edit is not made, so the contour is as unfinished as before.
        instance.editor().restore(unfinished);
        view.effect.complain(text);
    }
    if result != Err(Failure::Default) {
        view.redraw();
    }
    result
}

/// Nothing can be drawn, and the user is told so where the pen begins a contour.
fn cannot_draw(view: &View, text: &str) -> Result<(), Failure> {
    let draws = matches!(tool(view.effect.parameters()?.int(c"tool", view.time)?), Tool::Contour | Tool::Freehand);
    if view.event != Event::Down || !draws {
        return Err(Failure::Default);
    }
    view.effect.complain(text);
    Ok(())
}

/// What an event makes of the editor.
fn happen(view: &View, shown: &Shown, frame: FrameNumber, editor: &mut Editor) -> Outcome {
    let (work, pen) = (shown.work(frame), shown.placement.footage(view.pen));
    match view.event {
        Event::Down => editor.down(&work, pen),
        Event::Move => editor.move_to(&work, pen),
        Event::Up => editor.up(&work, pen),
        Event::KeyDown | Event::KeyUp => match key(view.key, view.event == Event::KeyDown) {
            Some(key) => editor.key(&work, key),
            None => Outcome::Ignored,
        },
        Event::Draw | Event::Left => Outcome::Ignored,
    }
}

fn key(symbol: u32, down: bool) -> Option<Key> {
    match symbol {
        key_syms::kOfxKey_Shift_L | key_syms::kOfxKey_Shift_R => Some(Key::Shift(down)),
        key_syms::kOfxKey_Control_L | key_syms::kOfxKey_Control_R => Some(Key::Control(down)),
        _ if !down => None,
        key_syms::kOfxKey_Delete => Some(Key::Delete),
        key_syms::kOfxKey_BackSpace => Some(Key::Back),
        key_syms::kOfxKey_Escape => Some(Key::Escape),
        key_syms::kOfxKey_Return | key_syms::kOfxKey_KP_Enter => Some(Key::Enter),
        _ => None,
    }
}

/// Stores what an event led to.
fn keep(view: &View, shown: &Shown, outcome: Outcome) -> Result<(), Failure> {
    match outcome {
        Outcome::Ignored => Err(Failure::Default),
        Outcome::Shown => Ok(()),
        Outcome::Selected(name) => match name {
            Some(name) if name != shown.name => edits::select(&view.effect, &name),
            _ => Ok(()),
        },
        Outcome::Edited(Edit { label, document }) => edits::store(&view.effect, label, document, Some(view.time)),
        Outcome::Refused(refused) => {
            view.effect.complain(&refused.0);
            Ok(())
        }
    }
}
