//! `report`: what the demo shows of a tracked document: a contact sheet and a table of times and accuracy.

use anyhow::{Context, Result};
use rototoon_tests::measure::{Figures, Row, figures, measure};
use rototoon_tests::sheet;
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;

/// Writes `contact.png` and `table.md` into the demo's folder `out`, and prints the table.
///
/// `out` has `tracked.json`, the tracked document, and `report.json`, what the script in Blender measured and rendered.
/// Accuracy is measured where a `truth.json` lies beside `project`.
pub fn report(project: &Path, out: &Path) -> Result<()> {
    let (tracked, report) = (document(&out.join("tracked.json"))?, document(&out.join("report.json"))?);
    contact_sheet(&report, &tracked, out)?;
    let table = table(project, &tracked, &report)?;
    std::fs::write(out.join("table.md"), &table)?;
    println!("\n{table}");
    Ok(())
}

fn document(path: &Path) -> Result<Value> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {path:?}"))?;
    serde_json::from_str(&text).with_context(|| format!("cannot read {path:?}"))
}

/// Lays the rendered strokes over their frames.
fn contact_sheet(report: &Value, tracked: &Value, out: &Path) -> Result<()> {
    let pattern = tracked["footage"]["pattern"].as_str().context("footage.pattern is not a text")?;
    let renders = report["renders"].as_object().context("report.json: no renders")?;
    let mut pictures = renders
        .iter()
        .map(|(frame, path)| {
            let number: i32 = frame.parse()?;
            let footage = out.join(sheet::frame_path(pattern, number));
            Ok(sheet::Picture { frame: number, footage, strokes: out.join(path.as_str().context("a path is a text")?) })
        })
        .collect::<Result<Vec<_>>>()?;
    pictures.sort_by_key(|picture| picture.frame);
    sheet::write(&pictures, &out.join("contact.png"))
}

/// Times, and accuracy where a truth document lies beside the project.
fn table(project: &Path, tracked: &Value, report: &Value) -> Result<String> {
    let mut text =
        format!("Blender {}\n\n| step | seconds |\n| --- | ---: |\n", report["blender"].as_str().unwrap_or("?"));
    for (step, seconds) in report["seconds"].as_object().context("report.json: no seconds")? {
        writeln!(text, "| {step} | {:.2} |", seconds.as_f64().unwrap_or(f64::NAN))?;
    }
    let truth = project.with_file_name("truth.json");
    if !truth.exists() {
        writeln!(text, "\nNo truth.json lies beside the project: accuracy is not known.")?;
        return Ok(text);
    }
    let rows = measure(tracked, &document(&truth)?)?;
    let height = tracked["footage"]["height"].as_f64().context("footage.height is not a number")?;
    writeln!(text, "\n| part | points | good | contour px, mean / 95 % | point px, mean / 95 % |")?;
    writeln!(text, "| --- | ---: | ---: | ---: | ---: |")?;
    for (k, part) in tracked["parts"].as_array().into_iter().flatten().enumerate() {
        let own: Vec<&Row> = rows.iter().filter(|row| row.part == k).collect();
        writeln!(text, "{}", line(part["name"].as_str().unwrap_or("?"), &figures(own, height)))?;
    }
    writeln!(text, "{}", line("**all**", &figures(&rows, height)))?;
    Ok(text)
}

fn line(name: &str, f: &Figures) -> String {
    if f.points == 0 {
        return format!("| {name} | 0 | | | |");
    }
    format!(
        "| {name} | {} | {:.1} % | {:.2} / {:.1} | {:.2} / {:.1} |",
        f.points,
        100.0 * f.good,
        f.contour_mean,
        f.contour_p95,
        f.point_mean,
        f.point_p95
    )
}
