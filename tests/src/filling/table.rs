//! The tables of the benchmark's results.

use super::run::Outcome;
use super::score::{BANDS, Score};

const HEAD: &str = "\
| set | drawings | regions | regions right | area right | known | left where they are | doubted | s a drawing | peak MB |
| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
";

const NOTES: &str = "\
Regions: true regions of all drawings but the first. Right: most of a region's pixels have its colour. Area: the same by pixels, without the
largest region of each drawing. Known: the share of the regions whose colour occurs on the first drawing. Left where they are: regions and area right
if the colours of the first drawing are painted on all others. Doubted: the share of the wrong regions with a confidence below 0.5. Seconds: painting, with
reading the pictures. Peak: largest resident memory of the process up to the end of painting.

Share of right regions, and their number, by the confidence that the program gives:

";

/// The tables as Markdown: a row for each set, and with more than one set their mean.
pub fn markdown(outcomes: &[Outcome]) -> String {
    let scores: Vec<Score> = outcomes.iter().map(|outcome| outcome.score).collect();
    let mut text = HEAD.to_owned();
    for own in outcomes {
        let (score, peak) = (own.score, own.peak_mb.map_or("–".into(), |mb| format!("{mb:.0}")));
        let shares = shares(&[score]);
        text += &format!(
            "| {} | {} | {} | {shares} | {:.2} | {peak} |\n",
            own.set, own.drawings, score.regions, own.seconds
        );
    }
    if outcomes.len() > 1 {
        text += &format!("| mean | | | {} | | |\n", shares(&scores));
    }
    text + "\n" + NOTES + &calibration(outcomes, &scores)
}

/// The mean shares of some sets, as the middle cells of a row.
fn shares(scores: &[Score]) -> String {
    let of = |share: fn(&Score) -> (usize, usize)| mean(scores.iter().map(share));
    let held = format!("{}, {}", of(|s| (s.held, s.regions)), of(|s| (s.held_area, s.area)));
    let right = format!("{} | {}", of(|s| (s.right, s.regions)), of(|s| (s.right_area, s.area)));
    format!("{right} | {} | {held} | {}", of(|s| (s.known, s.regions)), of(|s| (s.doubted, s.wrong())))
}

/// The mean of shares, each a part of a number, in percent. Shares of nothing do not count.
fn mean(shares: impl Iterator<Item = (usize, usize)>) -> String {
    let shares: Vec<f64> = shares.filter(|share| share.1 > 0).map(|(part, all)| part as f64 / all as f64).collect();
    if shares.is_empty() {
        return "–".into();
    }
    format!("{:.1} %", 100.0 * shares.iter().sum::<f64>() / shares.len() as f64)
}

/// The shares of right regions by bands of confidence. The last row has all regions of all sets.
fn calibration(outcomes: &[Outcome], scores: &[Score]) -> String {
    let names = BANDS.iter().enumerate().map(|(k, low)| match k {
        0 => format!("{low} or more"),
        k if k + 1 == BANDS.len() => "below".into(),
        k => format!("{low} to {}", BANDS[k - 1]),
    });
    let mut text =
        format!("| set | {} |\n| --- |{}\n", names.collect::<Vec<_>>().join(" | "), " ---: |".repeat(BANDS.len()));
    let mut row = |name: &str, score: &Score| {
        let cell = |&(all, right): &(usize, usize)| format!("{} of {all}", mean([(right, all)].into_iter()));
        text += &format!("| {name} | {} |\n", score.bands.iter().map(cell).collect::<Vec<_>>().join(" | "));
    };
    outcomes.iter().for_each(|own| row(&own.set, &own.score));
    if outcomes.len() > 1 {
        let mut all = Score::default();
        scores.iter().for_each(|score| all.add(score));
        row("all", &all);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(set: &str, right: usize, doubted: usize) -> Outcome {
        let score = Score {
            regions: 40,
            right,
            known: 36,
            held: 10,
            area: 1000,
            right_area: 25 * right,
            held_area: 500,
            doubted,
            bands: [(20, 19), (10, 8), (0, 0), (10, 3)],
        };
        Outcome { set: set.into(), drawings: 5, clicks: 10, score, seconds: 0.25, peak_mb: Some(81.4) }
    }

    #[test]
    fn rows_have_shares_and_means() {
        let text = markdown(&[outcome("run", 30, 4), outcome("walk", 40, 0)]);
        let rows = [
            "| run | 5 | 40 | 75.0 % | 75.0 % | 90.0 % | 25.0 %, 50.0 % | 40.0 % | 0.25 | 81 |",
            "| walk | 5 | 40 | 100.0 % | 100.0 % | 90.0 % | 25.0 %, 50.0 % | – | 0.25 | 81 |",
            // The share of doubted regions is that of the film that has wrong ones.
            "| mean | | | 87.5 % | 87.5 % | 90.0 % | 25.0 %, 50.0 % | 40.0 % | | |",
            "| set | 0.9 or more | 0.7 to 0.9 | 0.5 to 0.7 | below |",
            "| run | 95.0 % of 20 | 80.0 % of 10 | – of 0 | 30.0 % of 10 |",
            "| all | 95.0 % of 40 | 80.0 % of 20 | – of 0 | 30.0 % of 20 |",
        ];
        rows.iter().for_each(|row| assert!(text.lines().any(|line| line == *row), "{row}\n{text}"));
        assert!(!markdown(&[outcome("run", 30, 4)]).contains("| mean |"));
    }
}
