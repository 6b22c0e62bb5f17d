//! The C ABI: a document's session over tiny pictures, called in any order with any arguments; and calls without a session.

use crate::abi::{self, Session, Strokes};
use crate::given::{self, clips::clips, document::document, frame, name, number, points};
use crate::pictures;
use arbitrary::{Result, Unstructured};
use image::{ImageBuffer, Rgb};
use rototoon_capi::functions::rototoon_match_contours;
use rototoon_capi::session_abi as call;
use rototoon_capi::session_edit_abi as edit;
use rototoon_capi::session_track_abi as results;
use rototoon_capi::style_abi::{rototoon_capture_clip, rototoon_import_motion};
use std::sync::OnceLock;

/// Most calls of an input, and most of them that track, snap or paint.
const MOST_CALLS: [usize; 2] = [10, 1];
/// Most frames of a footage. More are as slow as they are many.
const MOST_FRAMES: i64 = 32;

/// Makes a session and calls it.
pub fn session(data: &[u8]) {
    let (text, mut u) = given::text_and_rest(data, "{", document);
    let folder = footage();
    let mut slow = 0;
    let Some(session) = Session::new(&text, folder) else {
        let _ = without_session(&mut u, &text);
        return;
    };
    for _ in 0..MOST_CALLS[0] {
        if u.is_empty() || called(&session, &mut u, &mut slow).is_err() {
            break;
        }
    }
    if !data.is_empty() && data[0] != b'{' {
        let _ = without_session(&mut u, &text);
    }
}

/// The folder with the pictures of the decoder's documents: a dark square that moves over paper.
fn footage() -> &'static str {
    static FOLDER: OnceLock<String> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = pictures::folder().path().join("footage");
        std::fs::create_dir_all(&folder).expect("a temporary folder can be made");
        for on in 0..=9u32 {
            let square = |x: u32, y: u32| (8 + on..24 + on).contains(&x) && (10..30).contains(&y);
            let ink = |x: u32, y: u32| if square(x, y) { Rgb([40u8, 30, 60]) } else { Rgb([240, 235, 220]) };
            let picture = ImageBuffer::from_fn(given::SIZE[0], given::SIZE[1], ink);
            picture.save(folder.join(format!("f{on:03}.png"))).expect("a temporary file can be written");
        }
        folder.to_string_lossy().into_owned()
    })
}

/// One call. A call that fails leaves the document as it was.
fn called(session: &Session, u: &mut Unstructured, slow: &mut usize) -> Result<()> {
    let before = session.out(call::rototoon_session_document);
    if !one_call(session, u, slow)? {
        assert_eq!(session.out(call::rototoon_session_document), before, "a call that failed changed the document");
    }
    Ok(())
}

fn one_call(session: &Session, u: &mut Unstructured, slow: &mut usize) -> Result<bool> {
    let part = name(u)?;
    Ok(match u.int_in_range(0..=15u8)? {
        0 => {
            let values: Vec<f64> = points(u, 0, 8)?.iter().flat_map(|p| [p.x, p.y]).collect();
            let odd = usize::from(!values.is_empty() && u.ratio(1u8, 16)?);
            session.set_key(&part, frame(u)?, &values[odd..])
        }
        1 => session.frame(edit::rototoon_session_remove_key, &part, frame(u)?),
        2 => session.pin(&part, frame(u)?, index(u)?, [number(u)?, number(u)?]),
        3 => session.unpin(&part, frame(u)?, index(u)?),
        4 => session.set_center(&part, frame(u)?, [number(u)?, number(u)?]),
        5 => session.frame(edit::rototoon_session_clear_center, &part, frame(u)?),
        6 => session.text(edit::rototoon_session_remove_part, &part),
        7 => session.text(edit::rototoon_session_add_part, &given::document::part(u, 3)?),
        8 => session.text(call::rototoon_session_set_footage, &given::document::footage(u)?),
        9 => session.text(call::rototoon_session_set_document, &document(u)?),
        10 => session.track_of(&part),
        11 => session.curves_of(&part, frame(u)?),
        12 => {
            session.out(call::rototoon_session_parts).is_some()
                && session.out(results::rototoon_session_weakest_frame).is_some()
        }
        13 if *slow < MOST_CALLS[1] && u.ratio(1u8, 2)? && short(session) => {
            *slow += 1;
            worked(session, u)?
        }
        14 => clicked(session, u)?,
        15 if *slow < MOST_CALLS[1] && u.ratio(1u8, 2)? && short(session) => {
            *slow += 1;
            let cancel = if u.ratio(1u8, 8)? { u.int_in_range(1..=8)? } else { 0 };
            let odd = if u.ratio(1u8, 16)? {
                format!(", \"confidence\": {}", given::json_number(number(u)?))
            } else {
                String::new()
            };
            session.fill(&format!("{{\"threads\": 1{odd}}}"), cancel)
        }
        _ => true,
    })
}

/// Clicks of a painter.
fn clicked(session: &Session, u: &mut Unstructured) -> Result<bool> {
    let places = points(u, 0, 8)?;
    let mut frames = Vec::new();
    let mut colours = Vec::new();
    for _ in &places {
        frames.push(frame(u)?);
        for _ in 0..3 {
            colours.push(if u.ratio(1u8, 64)? { number(u)? } else { f64::from(u.int_in_range(0..=4u8)?) / 4.0 });
        }
    }
    let places: Vec<f64> = places.iter().flat_map(|p| [p.x, p.y]).collect();
    Ok(session.set_fills(&frames, &places, &colours))
}

/// Whether tracking is short: few frames of the size that the pictures have.
fn short(session: &Session) -> bool {
    let text = session.out(call::rototoon_session_document).unwrap_or_default();
    few_frames(&text) && footage_number(&text, "width").max(footage_number(&text, "height")) <= 128
}

/// Whether a document's footage has few frames.
fn few_frames(document: &str) -> bool {
    footage_number(document, "last").saturating_sub(footage_number(document, "first")) <= MOST_FRAMES
}

/// A whole number of a document's footage; 0 where there is none.
fn footage_number(document: &str, field: &str) -> i64 {
    let fields: serde_json::Value = serde_json::from_str(document).unwrap_or_default();
    fields["footage"][field].as_i64().unwrap_or_default()
}

/// Tracking or snapping.
fn worked(session: &Session, u: &mut Unstructured) -> Result<bool> {
    let presets = ["rototoon", "zhou2011", "agarwala2004", "liang2012"];
    let preset = *u.choose(&presets)?;
    let follow = *u.choose(&["auto", "edge", "line"])?;
    let cancel = if u.ratio(1u8, 8)? { u.int_in_range(1..=8)? } else { 0 };
    let share = given::json_number(number(u)?);
    let snap = u.ratio(1u8, 3)?;
    let odd = u.ratio(1u8, 16)?;
    let options = match (snap, odd) {
        (true, true) => format!("{{\"threads\": 1, \"corridor_share\": {share}}}"),
        (true, false) => format!("{{\"threads\": 1, \"follow\": \"{follow}\"}}"),
        (false, true) => format!("{{\"threads\": 1, \"preset\": {share}}}"),
        (false, false) => format!("{{\"threads\": 1, \"preset\": \"{preset}\"}}"),
    };
    let work = if snap { results::rototoon_session_snap } else { results::rototoon_session_track };
    Ok(session.work(work, &options, cancel).is_some())
}

fn index(u: &mut Unstructured) -> Result<i32> {
    if u.ratio(1u8, 16)? { u.arbitrary() } else { u.int_in_range(0..=8) }
}

/// The calls that need no session.
fn without_session(u: &mut Unstructured, document: &str) -> Result<()> {
    match u.int_in_range(0..=5u8)? {
        0 => {
            let contours = |u: &mut Unstructured| {
                given::list(u, 0, 3, |u| {
                    let points = given::json_points(&points(u, 0, 8)?);
                    Ok(format!("{{\"points\": {points}, \"closed\": {}}}", u.arbitrary::<bool>()?))
                })
            };
            let text = format!("{{\"references\": {}, \"drawn\": {}}}", contours(u)?, contours(u)?);
            abi::request(rototoon_match_contours, &text);
        }
        1 => {
            let options = format!(
                "{{\"character\": \"a\", \"motion\": \"b\", \"first\": {}, \"last\": {}}}",
                frame(u)?,
                frame(u)?
            );
            if few_frames(document) {
                abi::pair(rototoon_capture_clip, [document, &options]);
            }
        }
        2 => {
            let text = clips(u, 1, 2)?.text();
            abi::pair(rototoon_import_motion, [&text, "{\"character\": \"a\", \"motion\": \"b\"}"]);
        }
        3 => drop(strokes(u)?.fit(number(u)?)),
        4 => drop(strokes(u)?.hide(number(u)?, number(u)?)),
        _ => {
            let strokes = strokes(u)?;
            let key = u.int_in_range(0..=2u8)?;
            let options = format!("{{\"threads\": 1, \"spans\": [{{\"key\": {key}, \"frames\": [{}]}}]}}", frame(u)?);
            strokes.matched("{\"threads\": 1}");
            strokes.between(&options);
        }
    }
    Ok(())
}

/// Strokes of a few drawings. Offsets and bounds are now and then any numbers.
fn strokes(u: &mut Unstructured) -> Result<Strokes> {
    let mut found = Strokes { offsets: vec![0], drawings: vec![0], ..Strokes::default() };
    let odd = u.ratio(1u8, 8)?;
    let mut on = frame(u)?;
    for _ in 0..u.int_in_range(0..=3usize)? {
        for _ in 0..u.int_in_range(0..=3usize)? {
            found.points.extend(points(u, 0, 12)?.iter().flat_map(|p| [p.x, p.y]));
            found.offsets.push(found.points.len() as i32 / 2);
            found.closed.push(u.arbitrary()?);
            found.labels.extend([i32::from(u.arbitrary::<i8>()?), i32::from(u.arbitrary::<i8>()?)]);
            found.forms.push(u.int_in_range(0..=3)?);
        }
        found.drawings.push(found.closed.len() as i32);
        found.frames.push(on);
        on = on.wrapping_add(u.int_in_range(0..=4)?);
    }
    if odd {
        // The last offset stays: it tells the library how many points it may read.
        let last = found.offsets.len() - 1;
        for offset in &mut found.offsets[..last] {
            *offset = if u.arbitrary()? { u.arbitrary()? } else { *offset };
        }
        for bound in &mut found.drawings {
            *bound = if u.arbitrary()? { u.arbitrary()? } else { *bound };
        }
        for _ in 0..2 * u.int_in_range(0..=2usize)? {
            found.by_hand.push(u.int_in_range(-2..=8)?);
        }
    }
    Ok(found)
}
