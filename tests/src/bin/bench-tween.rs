//! Measures matching and in-betweens on sets with known truth, for `cargo xtask bench-tween`.
//!
//! `bench-tween OUT DIR…` prints tables and writes a sheet of in-betweens for each set to the folder OUT.

use anyhow::{Context, Result};
use clap::Parser;
use rototoon::tween::between::Options;
use rototoon_tests::tweening::between::{
    Errors, PlaceErrors, measure as measure_between, measure_captured, measure_one_way, measure_places, rows_of_keys,
};
use rototoon_tests::tweening::breakdowns::{BreakdownErrors, measure_breakdowns};
use rototoon_tests::tweening::drawings::{Film, measure as measure_drawings};
use rototoon_tests::tweening::fragments::measure as measure_fragments;
use rototoon_tests::tweening::ink::InkErrors;
use rototoon_tests::tweening::matching::{Chance, Score, measure};
use rototoon_tests::tweening::{GAPS, Set, sheet};
use std::path::{Path, PathBuf};

#[derive(Parser)]
#[command(about = "Measures matching and in-betweens on sets with known truth")]
struct Arguments {
    /// The folder to write to.
    out: PathBuf,
    /// Folders with project.json and truth.json.
    folders: Vec<PathBuf>,
    /// Only breakdowns and fragmented drawings.
    #[arg(long)]
    keys_only: bool,
    /// Folders with line drawings in `frames`, for in-betweens of whole drawings.
    #[arg(long, num_args = 1..)]
    drawings: Vec<PathBuf>,
    /// Prints every span of the tables of ink.
    #[arg(long)]
    each: bool,
}

fn main() -> Result<()> {
    let Arguments { out, folders, keys_only, drawings, each } = Arguments::parse();
    let mut sets = folders.iter().map(|folder| Set::load(folder)).collect::<Result<Vec<_>>>()?;
    if keys_only {
        breakdowns(&sets)?;
        fragments(&sets, each)?;
        return whole_drawings(&drawings, each);
    }
    matching(&sets, false)?;
    matching(&sets, true)?;
    places(&sets)?;
    between(&sets, "all strokes, one chart for all of them", measure_between)?;
    between(&sets, "strokes that move in one direction, a chart for each", measure_one_way)?;
    println!("charted: with the best shares of the way; in brackets the ratio to linear without a chart");
    for (set, folder) in sets.iter_mut().zip(&folders) {
        set.capture(folder)?;
    }
    between(&sets, "strokes that follow the tracked parts of the project", measure_captured)?;
    breakdowns(&sets)?;
    fragments(&sets, each)?;
    whole_drawings(&drawings, each)?;
    for set in &sets {
        sheets(set, &out)?;
    }
    Ok(())
}

/// Two keys 12 frames apart, every six frames.
fn spans_of_twelve(set: &Set) -> Vec<(i32, i32)> {
    let (first, last) = set.frames;
    (first..=last - 12).step_by(6).map(|f| (f, f + 12)).collect()
}

fn breakdowns(sets: &[Set]) -> Result<()> {
    println!(
        "breakdowns: two keys 12 frames apart and true drawings between; error divided by that of linear without them"
    );
    println!(
        "{:22}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}",
        "", "none", "one", "two", "sugg 1", "sugg 2", "best 1", "best 2", "hold", "spans"
    );
    for set in sets {
        let mut all = BreakdownErrors::default();
        let spans = spans_of_twelve(set);
        for &span in &spans {
            all.add(measure_breakdowns(set, span, &Options::default())?);
        }
        let of = |sum: f64| sum / all.linear.max(f64::MIN_POSITIVE);
        let ([none, one, two], [best_one, best_two]) = (all.even.map(of), all.best.map(of));
        let ([first, second], held) = (all.suggested.map(of), of(all.held));
        println!(
            "{:22}{none:8.2}{one:8.2}{two:8.2}{first:8.2}{second:8.2}{best_one:8.2}{best_two:8.2}{held:8.2}{:8}",
            set.name,
            spans.len()
        );
    }
    println!();
    Ok(())
}

fn fragments(sets: &[Set], each: bool) -> Result<()> {
    println!(
        "fragmented drawings: keys 12 frames apart, contours in pieces; mean distance between drawn and true ink in px"
    );
    ink_head("pieces");
    for set in sets {
        for most in [1, 3, 6] {
            let (mut all, mut chance) = (InkErrors::default(), Chance(29));
            for span in spans_of_twelve(set) {
                let found = measure_fragments(set, span, most, &mut chance)?;
                if each {
                    ink_row(&format!("  {} to {}", span.0, span.1), most, &found);
                }
                all.add(found);
            }
            ink_row(&set.name, most, &all);
        }
    }
    println!();
    Ok(())
}

fn whole_drawings(folders: &[PathBuf], each: bool) -> Result<()> {
    println!("whole line drawings, each traced for itself: mean distance between drawn and true ink in px");
    ink_head("strokes");
    for folder in folders {
        let film = Film::trace(folder)?;
        let mut all = InkErrors::default();
        for span in film.spans() {
            let found = measure_drawings(&film, span)?;
            if each {
                ink_row(&format!("  {} to {}", span.0, span.1), film.drawings[span.0].len(), &found);
            }
            all.add(found);
        }
        let strokes = film.drawings.iter().map(Vec::len).max().unwrap_or(0);
        ink_row(&film.name, strokes, &all);
    }
    println!();
    Ok(())
}

fn ink_head(count: &str) {
    println!(
        "{:22}{count:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>9}{:>8}{:>10}",
        "", "hold", "ours", "ratio", "spans", "worse", "repeats", "held", "wrong %"
    );
}

fn ink_row(name: &str, count: usize, all: &InkErrors) {
    let n = all.frames.max(1) as f64;
    let pairs = all.pairs.0 + all.pairs.1;
    let wrong = if pairs == 0 { String::new() } else { format!("{:.1}", 100.0 * all.pairs.1 as f64 / pairs as f64) };
    let (held, ours, ratio) = (all.held / n, all.ours / n, all.ratio());
    let ((spans, worse), repeats, holding) = (all.spans, all.repeated, all.holding);
    println!("{name:22}{count:8}{held:8.2}{ours:8.2}{ratio:8.3}{spans:8}{worse:8}{repeats:9}{holding:8}{wrong:>10}");
}

fn matching(sets: &[Set], painted: bool) -> Result<()> {
    println!("matching, {}", if painted { "strokes with their paint" } else { "only shape and place" });
    println!(
        "{:22}{:>6}{:>8}{:>9}{:>8}{:>11}{:>10}",
        "", "spans", "pairs", "right %", "wrong", "by index %", "starts %"
    );
    let mut all = (0, Score::default());
    for set in sets {
        let paints = if painted { set.paints()? } else { Vec::new() };
        let (mut score, mut chance) = (Score::default(), Chance(1));
        let spans = set.spans();
        for &span in &spans {
            score.add(measure(set, span, &paints, &mut chance)?);
        }
        matching_row(&set.name, spans.len(), &score);
        all = (all.0 + spans.len(), all.1);
        all.1.add(score);
    }
    matching_row("all", all.0, &all.1);
    println!();
    Ok(())
}

fn matching_row(name: &str, spans: usize, s: &Score) {
    let percent = |n: usize, of: usize| if of == 0 { 100.0 } else { 100.0 * n as f64 / of as f64 };
    let (right, index) = (percent(s.right, s.there), percent(s.by_index, s.there));
    let starts = percent(s.starts, s.closed);
    println!("{name:22}{spans:6}{:8}{right:9.1}{:8}{index:11.1}{starts:10.1}", s.there, s.wrong);
}

fn places(sets: &[Set]) -> Result<()> {
    println!(
        "points on the next key, 6 to 14 frames later, drawn with other points: mean distance from the truth in px"
    );
    println!("{:22}{:>8}{:>8}{:>8}{:>10}{:>8}", "", "length", "ours", "ratio", "better %", "worse %");
    for set in sets {
        let mut all = PlaceErrors::default();
        let mut contours = 0;
        for span in set.spans() {
            let found = measure_places(set, span)?;
            all.count += found.count;
            all.plain += found.plain;
            all.ours += found.ours;
            all.better += found.better;
            all.worse += found.worse;
            contours += set.parts.len();
        }
        let percent = |n: usize| 100.0 * n as f64 / contours.max(1) as f64;
        let (n, ratio) = (all.count.max(1) as f64, all.ours / all.plain.max(f64::MIN_POSITIVE));
        let (plain, ours, better, worse) = (all.plain / n, all.ours / n, percent(all.better), percent(all.worse));
        println!("{:22}{plain:8.2}{ours:8.2}{ratio:8.2}{better:10.1}{worse:8.1}", set.name);
    }
    println!();
    Ok(())
}

/// Measures the errors between some keys of a set.
type Measure = fn(&Set, &[i32], &Options) -> Result<Errors>;

fn between(sets: &[Set], title: &str, measure: Measure) -> Result<()> {
    println!("in-betweens, {title}: mean distance of the points from the truth in px");
    println!(
        "{:22}{:>8}{:>8}{:>8}{:>8}{:>17}{:>17}",
        "", "keys", "linear", "ours", "ratio", "linear, charted", "ours, charted"
    );
    for set in sets {
        let mut all = Errors::default();
        let fits = |gap: &i32| set.frames.1 - set.frames.0 >= *gap;
        for gap in GAPS.filter(fits) {
            for row in rows_of_keys(set, gap) {
                all.add(measure(set, &row, &Options::default())?);
            }
        }
        between_row(&set.name, "6-14", &all);
        between_row(&set.name, "project", &measure(set, &set.keys, &Options::default())?);
    }
    println!();
    Ok(())
}

fn between_row(name: &str, keys: &str, e: &Errors) {
    if e.count == 0 {
        return;
    }
    let n = e.count as f64;
    let charted = |sum: f64| if sum > 0.0 { format!("{:.2} ({:.2})", sum / n, sum / e.linear) } else { String::new() };
    let (linear, ours) = (charted(e.linear_charted), charted(e.ours_charted));
    let ratio = e.ours / e.linear;
    println!("{name:22}{keys:>8}{:8.2}{:8.2}{ratio:8.2}{linear:>17}{ours:>17}", e.linear / n, e.ours / n);
}

fn sheets(set: &Set, out: &Path) -> Result<()> {
    let path = out.join(format!("{}.png", set.name));
    sheet::draw(set, &set.keys, &Options::default())?.save(&path).with_context(|| format!("cannot write {path:?}"))
}
