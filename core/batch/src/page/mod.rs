//! The morning page: one HTML file for a person with 200 shots and one hour.
//!
//! It begins with the list of keys that would help most, over all shots. Then come the shots: those that failed, those
//! that want keys, and, folded, those that are good. Each has its confidence over time and a contact sheet. The file
//! needs nothing else: pictures are inside, there is no script, and a reader's dark or light setting is kept. Every link
//! and every fold can be reached by the keyboard.

mod chart;
mod keys;
pub mod sheet;

use crate::findings::WantedKey;
use crate::names::PAGE;
use crate::summary::{Entry, Outcome, Summary, write_own};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use rototoon::file;
use rototoon::memory::Bytes;
use rototoon::project::WriteError;
use rototoon::scene::Verdict;
use std::fmt::Write;
use std::path::Path;

/// What tells a page of a batch from others.
const MARK: &str = "<meta name=\"generator\" content=\"rototoon batch\">";
/// Number of shots with pictures. The shots to work on come first.
const MOST_SHEETS: usize = 300;

const STYLE: &str = include_str!("style.css");

/// Writes the page into the folder of a batch.
///
/// # Errors
///
/// The file cannot be written, or is not one of a batch.
pub fn write(summary: &Summary, folder: &Path) -> Result<(), WriteError> {
    write_own(&folder.join(PAGE), html(summary, folder).as_bytes(), MARK)
}

/// The text of the page. Pictures are read from the folder of the batch.
pub fn html(summary: &Summary, folder: &Path) -> String {
    let mut out = String::new();
    let _ = write!(
        out,
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Rototoon batch</title>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n{MARK}\n<style>\n{STYLE}</style></head>\n<body>\n"
    );
    totals(&mut out, summary);
    keys::list(&mut out, summary, folder);
    let mut sheets = MOST_SHEETS;
    for (id, title, open) in [
        ("failed", "Failed", true),
        ("wants_keys", "Want keys", true),
        ("not_run", "Not run yet", false),
        ("good", "Good", false),
    ] {
        group(&mut out, summary, folder, (id, title, open), &mut sheets);
    }
    out.push_str("</body></html>\n");
    out
}

fn totals(out: &mut String, summary: &Summary) {
    let _ = write!(
        out,
        "<header><h1>{}</h1>\n<nav aria-label=\"Contents\"><ul class=\"totals\">",
        counted(summary.entries.len(), "shot")
    );
    for (id, text) in [("failed", "failed"), ("wants_keys", "want keys"), ("good", "good"), ("not_run", "not run yet")]
    {
        let count = summary.count(id);
        if count > 0 {
            let _ = write!(out, "<li class=\"{id}\"><a href=\"#{id}\"><b>{count}</b> {text}</a></li>");
        }
    }
    let seconds: f64 = summary.entries.iter().map(|entry| entry.record.seconds()).sum();
    let _ = writeln!(out, "</ul></nav><p class=\"quiet\">{} of work</p></header>", time(seconds));
}

/// The command that opens a shot, on the frame of a key.
fn opening(entry: &Entry, key: Option<&WantedKey>) -> String {
    match (&entry.shot.blend, key) {
        (Some(blend), Some(key)) => {
            let frame = format!("import bpy; bpy.context.scene.frame_set({})", key.frame);
            format!("blender {:?} --python-expr {frame:?}", blend.display().to_string())
        }
        (Some(blend), None) => format!("blender {:?}", blend.display().to_string()),
        (None, _) => entry.shot.project.display().to_string(),
    }
}

fn group(
    out: &mut String,
    summary: &Summary,
    folder: &Path,
    (id, title, open): (&str, &str, bool),
    sheets: &mut usize,
) {
    let entries: Vec<_> = summary.entries.iter().filter(|entry| entry.outcome.id() == id).collect();
    if entries.is_empty() {
        return;
    }
    let opened = if open { " open" } else { "" };
    let _ = writeln!(out, "<details id=\"{id}\"{opened}><summary><h2>{title}: {}</h2></summary>", entries.len());
    for entry in entries {
        shot(out, entry, (*sheets > 0).then_some(folder));
        *sheets = sheets.saturating_sub(1);
    }
    out.push_str("</details>\n");
}

/// A shot; with its pictures if the folder is given.
fn shot(out: &mut String, entry: &Entry, folder: Option<&Path>) {
    let (name, record) = (escaped(&entry.shot.name), &entry.record);
    let _ = write!(out, "<article id=\"shot-{name}\"><h3>{name}</h3>\n<p class=\"quiet\">");
    if record.steps.is_empty() {
        out.push_str("no step was done");
    } else {
        let steps: Vec<_> = record.steps.iter().map(|done| format!("{} {}", done.step, time(done.seconds))).collect();
        let _ = write!(out, "{}", escaped(&steps.join(" · ")));
        if record.peak_bytes() > 0 {
            let _ = write!(out, " · {} at most", Bytes(record.peak_bytes()));
        }
        let _ = write!(out, " · confidence {:.2}", record.findings.confidence);
    }
    let _ = writeln!(out, " · <code>{}</code></p>", escaped(&opening(entry, None)));
    if let Outcome::Failed(reason) = &entry.outcome {
        let _ = writeln!(out, "<p class=\"failure\">{}</p>", escaped(reason));
    }
    parts(out, entry);
    out.push_str(&chart::confidence(&record.findings));
    if let Some(folder) = folder {
        pictures(out, entry, folder);
    }
    messages(out, entry);
    out.push_str("</article>\n");
}

/// Each part that is doubtful or lost, in words.
fn parts(out: &mut String, entry: &Entry) {
    let bad: Vec<_> =
        entry.record.findings.parts.iter().filter(|part| !part.doubtful.is_empty() || !part.lost.is_empty()).collect();
    if bad.is_empty() {
        return;
    }
    out.push_str("<ul>");
    for part in bad {
        let _ = write!(out, "<li>{}: ", escaped(&part.name));
        let mut said = Vec::new();
        if !part.lost.is_empty() {
            said.push(format!("lost on {}", ranges(&part.lost)));
        }
        if !part.doubtful.is_empty() {
            said.push(format!("doubtful on {}", ranges(&part.doubtful)));
        }
        let _ = write!(out, "{}</li>", said.join(", "));
    }
    out.push_str("</ul>\n");
}

fn pictures(out: &mut String, entry: &Entry, folder: &Path) {
    let found = sheet::read(&folder.join(&entry.shot.name));
    if found.is_empty() {
        return;
    }
    out.push_str("<div class=\"sheet\">");
    for (frame, path) in found {
        let Ok(bytes) = file::bytes(&path) else { continue };
        let least = entry.record.findings.least.get(&frame);
        let weak = entry.record.findings.wanted.iter().any(|key| key.frame == frame)
            || least.is_some_and(|value| Verdict::of(*value) == Verdict::Lost);
        let (class, note) = if weak { (" class=\"weak\"", " · weak") } else { ("", "") };
        let _ = write!(
            out,
            "<figure{class}><img alt=\"Frame {frame}\" loading=\"lazy\" src=\"data:image/jpeg;base64,{}\">\
             <figcaption>{frame}{note}</figcaption></figure>",
            STANDARD.encode(bytes)
        );
    }
    out.push_str("</div>\n");
}

fn messages(out: &mut String, entry: &Entry) {
    let said: Vec<_> =
        entry.record.steps.iter().flat_map(|done| done.messages.iter().map(move |text| (done, text))).collect();
    if said.is_empty() {
        return;
    }
    let _ = write!(out, "<details><summary>{}</summary><ul>", counted(said.len(), "message"));
    for (done, text) in said {
        let _ = write!(out, "<li>{}: {}</li>", escaped(&done.step), escaped(text));
    }
    out.push_str("</ul></details>\n");
}

/// A number with its noun.
fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Seconds in the unit that fits.
fn time(seconds: f64) -> String {
    match seconds {
        s if s < 60.0 => format!("{s:.1} s"),
        s if s < 3600.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// Frame numbers with neighbours joined: 3–7, 9.
fn ranges(frames: &[i32]) -> String {
    let mut found: Vec<(i32, i32)> = Vec::new();
    for &frame in frames {
        match found.last_mut() {
            Some((_, last)) if last.checked_add(1) == Some(frame) => *last = frame,
            _ => found.push((frame, frame)),
        }
    }
    let text =
        |&(first, last): &(i32, i32)| if first == last { first.to_string() } else { format!("{first} to {last}") };
    let noun = if frames.len() == 1 { "frame" } else { "frames" };
    format!("{noun} {}", found.iter().map(text).collect::<Vec<_>>().join(", "))
}

/// A text in which no sign has a meaning in HTML.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            other => out.push(other),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::{Findings, PartFindings};
    use crate::manifest::Shot;
    use crate::record::{Done, Record};
    use std::fs;

    fn shot(name: &str) -> Shot {
        Shot { name: name.into(), project: "in/p.json".into(), blend: None, steps: vec![] }
    }

    fn record() -> Record {
        let part = PartFindings {
            name: "<arm>".into(),
            doubtful: vec![3, 4, 5, 9],
            lost: vec![12],
            ..PartFindings::default()
        };
        let key = WantedKey { part: "<arm>".into(), frame: 4, worth: 2.5, lost: false };
        let findings = Findings { parts: vec![part], wanted: vec![key], least: [(3, 0.2)].into(), confidence: 0.8 };
        let done = Done {
            step: "track".into(),
            seconds: 90.0,
            peak_bytes: 5_000_000,
            messages: vec!["note: a & b".into()],
            ..Done::default()
        };
        Record { steps: vec![done], findings, ..Record::default() }
    }

    #[test]
    fn the_page_says_what_to_do_first() {
        let folder = tempfile::tempdir().unwrap();
        let mut shots = [shot("a"), shot("b'>"), shot("c")];
        shots[1].blend = Some("shots/b.blend".into());
        let of = |shot, outcome, record| Entry { shot, outcome, record };
        let summary = Summary {
            entries: vec![
                of(&shots[0], Outcome::Good, Record::default()),
                of(&shots[1], Outcome::WantsKeys, record()),
                of(&shots[2], Outcome::Failed("track: no frames".into()), Record::default()),
            ],
        };
        let page = html(&summary, folder.path());
        for text in [
            "<h1>3 shots</h1>",
            "<a href=\"#failed\"><b>1</b> failed</a>",
            "<td class=\"number\">4</td><td class=\"number\">2.5</td><td class=\"number\">100 %</td><td>probably wrong</td>",
            "1 key in all; the first brings half of what can be gained",
            "blender &quot;shots/b.blend&quot; --python-expr &quot;import bpy; bpy.context.scene.frame_set(4)&quot;",
            "&lt;arm&gt;: lost on frame 12, doubtful on frames 3 to 5, 9",
            "track 2 min · 5 MB at most",
            "track: note: a &amp; b",
            "<p class=\"failure\">track: no frames</p>",
        ] {
            assert!(page.contains(text), "{text}\n{page}");
        }
        let at = |text: &str| page.find(text).unwrap();
        assert!(at("id=\"keys\"") < at("id=\"failed\"") && at("id=\"failed\"") < at("id=\"wants_keys\""));
        assert!(!page.contains("<arm>") && !page.contains("<script"));
    }

    #[test]
    fn pictures_are_inside() {
        let folder = tempfile::tempdir().unwrap();
        let sheet = folder.path().join("a").join(sheet::SHEET);
        fs::create_dir_all(&sheet).unwrap();
        fs::write(sheet.join("3.jpg"), "abc").unwrap();
        let shots = [shot("a")];
        let summary =
            Summary { entries: vec![Entry { shot: &shots[0], outcome: Outcome::WantsKeys, record: record() }] };
        let page = html(&summary, folder.path());
        assert!(page.contains(
            "<figure class=\"weak\"><img alt=\"Frame 3\" loading=\"lazy\" src=\"data:image/jpeg;base64,YWJj\">"
        ));
    }
}
