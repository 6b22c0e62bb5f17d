//! The list of keys that help most, over all shots.
//!
//! It answers three questions of a person who has an hour: which key is next, how it looks there, and when to stop. The last
//! column says what share of all that can be gained is gained with this key and those before it.

use super::sheet;
use super::{counted, escaped, opening};
use crate::findings::WantedKey;
use crate::summary::{Entry, Summary};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use rototoon::file;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Number of keys in the list.
const MOST_KEYS: usize = 200;

const HEAD: &str = "<div class=\"wide\"><table><thead><tr><th scope=\"col\"><span class=\"hidden\">Picture</span></th>\
     <th scope=\"col\">Shot</th><th scope=\"col\">Part</th><th scope=\"col\">Frame</th><th scope=\"col\">Worth</th>\
     <th scope=\"col\">So far</th><th scope=\"col\">Why</th><th scope=\"col\">Open</th></tr></thead>\n<tbody>\n";

/// Writes the list. Pictures are those of the shots' contact sheets below `folder`.
pub fn list(out: &mut String, summary: &Summary, folder: &Path) {
    let wanted = summary.wanted();
    if wanted.is_empty() {
        return;
    }
    let all: f64 = wanted.iter().map(|(_, key)| key.worth).sum();
    let half = share_reached(&wanted, 0.5 * all);
    let _ = write!(
        out,
        "<section><h2 id=\"keys\">Keys that help most</h2>\n<p>Draw these keys, and start the batch again. The worth is the number \
         of contours that become right. {} in all; the first {} half of what can be gained.</p>\n{HEAD}",
        counted(wanted.len(), "key"),
        if half == 1 { "brings".to_owned() } else { format!("{half} bring") }
    );
    let (mut sum, mut sheets) = (0.0, BTreeMap::new());
    for (entry, key) in wanted.iter().take(MOST_KEYS) {
        sum += key.worth;
        row(out, entry, key, 100.0 * sum / all, picture(entry, key, folder, &mut sheets));
    }
    out.push_str("</tbody></table></div>\n");
    if let Some(more @ 1..) = wanted.len().checked_sub(MOST_KEYS) {
        let _ = writeln!(out, "<p>And {} of less worth: see summary.json.</p>", counted(more, "key"));
    }
    out.push_str("</section>\n");
}

/// How many of the keys have `worth` together.
fn share_reached(wanted: &[(&Entry, &WantedKey)], worth: f64) -> usize {
    let mut sum = 0.0;
    let before = wanted.iter().take_while(|(_, key)| {
        sum += key.worth;
        sum < worth
    });
    before.count() + 1
}

fn row(out: &mut String, entry: &Entry, key: &WantedKey, so_far: f64, picture: Option<String>) {
    let name = escaped(&entry.shot.name);
    let why = if key.lost { "lost" } else { "probably wrong" };
    let image = picture.map_or_else(String::new, |data| {
        format!("<img class=\"small\" alt=\"\" loading=\"lazy\" src=\"data:image/jpeg;base64,{data}\">")
    });
    let more = match entry.record.findings.wanted.len() {
        0 | 1 => String::new(),
        keys => format!("<br><span class=\"quiet\">{keys} keys</span>"),
    };
    let _ = writeln!(
        out,
        "<tr><td>{image}</td><td><a href=\"#shot-{name}\">{name}</a>{more}</td><td>{}</td><td class=\"number\">{}</td>\
         <td class=\"number\">{:.1}</td><td class=\"number\">{so_far:.0} %</td><td>{why}</td><td><code>{}</code></td></tr>",
        escaped(&key.part),
        key.frame,
        key.worth,
        escaped(&opening(entry, Some(key)))
    );
}

/// The picture of a key's frame, if the shot's sheet has it.
fn picture(
    entry: &Entry,
    key: &WantedKey,
    folder: &Path,
    sheets: &mut BTreeMap<String, BTreeMap<i32, PathBuf>>,
) -> Option<String> {
    let name = &entry.shot.name;
    let sheet = sheets.entry(name.clone()).or_insert_with(|| sheet::read(&folder.join(name)).into_iter().collect());
    file::bytes(sheet.get(&key.frame)?).ok().map(|bytes| STANDARD.encode(bytes))
}
