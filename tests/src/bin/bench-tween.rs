//! Matching and in-betweens on sets with known truth, given as folders.

use anyhow::Result;
use rototoon_tests::tweening::Set;
use rototoon_tests::tweening::matching::{Chance, Score, measure};
use std::path::PathBuf;

fn main() -> Result<()> {
    let folders: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let percent = |n: usize, of: usize| if of == 0 { 100.0 } else { 100.0 * n as f64 / of as f64 };
    for coloured in [false, true] {
    println!("matching              spans  pairs   right %  wrong   by index %   starts %");
    let mut all = Score::default();
    for folder in &folders {
        let set = Set::load(folder)?;
        let paints = if coloured { set.paints()? } else { Vec::new() };
        let mut score = Score::default();
        let mut chance = Chance(1);
        let spans = set.spans();
        for &span in &spans {
            score.add(measure(&set, span, &paints, &mut chance)?);
        }
        row(&set.name, spans.len(), &score, percent);
        all.add(score);
    }
    row("all", 0, &all, percent);
    }
    Ok(())
}

fn row(name: &str, spans: usize, s: &Score, percent: impl Fn(usize, usize) -> f64) {
    println!(
        "{name:22}{spans:5} {:6} {:9.1} {:6} {:12.1} {:10.1}",
        s.there,
        percent(s.right, s.there),
        s.wrong,
        percent(s.by_index, s.there),
        percent(s.starts, s.closed)
    );
}
