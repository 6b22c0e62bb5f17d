//! Lines of many kinds, for tests that sweep the tolerance.

use rototoon_base::geometry::Point;
use std::f64::consts::{PI, TAU};

/// A named line.
pub struct Line {
    pub name: String,
    pub points: Vec<Point>,
    pub closed: bool,
}

/// Numbers that look random: the same on every machine (splitmix64).
pub struct Random(pub u64);

impl Random {
    /// A number within −1 .. 1.
    pub fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64 * 2.0 - 1.0
    }
}

/// Points at even steps of about `step` px along a polyline.
pub fn resampled(line: &[Point], closed: bool, step: f64) -> Vec<Point> {
    let mut line = line.to_vec();
    if closed {
        line.push(line[0]);
    }
    let mut walked = vec![0.0];
    for pair in line.windows(2) {
        walked.push(walked[walked.len() - 1] + pair[0].distance(pair[1]));
    }
    let total = walked[walked.len() - 1];
    let parts = (total / step).round().max(2.0) as usize;
    let count = if closed { parts } else { parts + 1 };
    (0..count)
        .map(|i| {
            let s = total * i as f64 / parts as f64;
            let k = walked.partition_point(|&w| w <= s).clamp(1, line.len() - 1);
            let width = walked[k] - walked[k - 1];
            line[k - 1].lerp(line[k], if width > 0.0 { (s - walked[k - 1]) / width } else { 0.0 })
        })
        .collect()
}

/// The pixel centres along a line, one for each pixel.
pub fn pixels(line: &[Point], closed: bool) -> Vec<Point> {
    let mut all: Vec<Point> = resampled(line, closed, 0.25).into_iter().map(|p| p.floor() + 0.5).collect();
    all.dedup();
    all
}

/// Points at even steps of the parameter.
pub fn along(count: usize, at: impl Fn(f64) -> Point) -> Vec<Point> {
    (0..count).map(|i| at(i as f64 / (count - 1) as f64)).collect()
}

/// A zigzag with `tips` tips between its ends, each `height` px above the line of its neighbours.
pub fn zigzag(tips: usize, width: f64, height: f64) -> Vec<Point> {
    (0..tips + 2).map(|k| Point::new(20.3 + k as f64 * width, 50.4 + if k % 2 == 1 { height } else { 0.0 })).collect()
}

pub fn gear(teeth: usize, radius: f64, depth: f64) -> Vec<Point> {
    let mut all = Vec::new();
    for k in 0..teeth {
        for (share, r) in [(0.0, radius), (0.32, radius), (0.42, radius - depth), (0.9, radius - depth)] {
            all.push(Point::from_angle((k as f64 + share) * TAU / teeth as f64) * r + radius + 20.0);
        }
    }
    all
}

pub fn eight(size: f64) -> Vec<Point> {
    along(4000, |t| Point::new(size * (t * TAU).sin(), 0.6 * size * (2.0 * t * TAU).sin()) + size + 20.0)
}

fn s_curve(length: f64, height: f64, waves: f64) -> Vec<Point> {
    along(8000, |t| Point::new(20.0 + length * t, 150.0 + height * (waves * t * TAU).sin()))
}

/// A contour of straight lines and cubics, like a glyph's. Each entry is the next end after its two handles.
fn outline(start: (f64, f64), parts: &[[(f64, f64); 3]], scale: f64) -> Vec<Point> {
    let mut from = Point::from(start);
    let mut all = Vec::new();
    for part in parts {
        let [a, b, end] = part.map(Point::from);
        for i in 0..200 {
            let t = i as f64 / 200.0;
            let u = 1.0 - t;
            all.push((from * u * u * u + a * 3.0 * u * u * t + b * 3.0 * u * t * t + end * t * t * t) * scale + 20.0);
        }
        from = end;
    }
    all
}

fn straight(a: (f64, f64), b: (f64, f64)) -> [(f64, f64); 3] {
    let lerp = |t: f64| (a.0 + (b.0 - a.0) * t, a.1 + (b.1 - a.1) * t);
    [lerp(1.0 / 3.0), lerp(2.0 / 3.0), b]
}

/// A "D" with serifs, an "S" and an "R"-like leg: stems, bowls, serifs and joins under shallow angles.
pub fn glyphs(scale: f64) -> Vec<(&'static str, Vec<Point>)> {
    let d = outline(
        (0.0, 0.0),
        &[
            straight((0.0, 0.0), (40.0, 0.0)),
            [(85.0, 0.0), (100.0, 25.0), (100.0, 50.0)],
            [(100.0, 75.0), (85.0, 100.0), (40.0, 100.0)],
            straight((40.0, 100.0), (0.0, 100.0)),
            straight((0.0, 100.0), (0.0, 94.0)),
            [(7.0, 94.0), (11.0, 93.0), (11.0, 86.0)],
            straight((11.0, 86.0), (11.0, 14.0)),
            [(11.0, 7.0), (7.0, 6.0), (0.0, 6.0)],
            straight((0.0, 6.0), (0.0, 0.0)),
        ],
        scale,
    );
    let s = outline(
        (70.0, 25.0),
        &[
            [(70.0, 12.0), (55.0, 8.0), (42.0, 8.0)],
            [(28.0, 8.0), (16.0, 14.0), (16.0, 26.0)],
            [(16.0, 48.0), (82.0, 38.0), (82.0, 72.0)],
            [(82.0, 90.0), (62.0, 100.0), (40.0, 100.0)],
            [(18.0, 100.0), (2.0, 90.0), (2.0, 70.0)],
            straight((2.0, 70.0), (14.0, 70.0)),
            [(14.0, 84.0), (26.0, 91.0), (42.0, 91.0)],
            [(58.0, 91.0), (69.0, 84.0), (69.0, 74.0)],
            [(69.0, 52.0), (4.0, 62.0), (4.0, 28.0)],
            [(4.0, 10.0), (22.0, 0.0), (42.0, 0.0)],
            [(66.0, 0.0), (82.0, 10.0), (82.0, 25.0)],
            straight((82.0, 25.0), (70.0, 25.0)),
        ],
        scale,
    );
    vec![("D", d), ("S", s)]
}

fn smooth(seed: u64) -> Vec<Point> {
    let mut random = Random(seed);
    let terms: Vec<(f64, f64)> =
        (2..9).map(|k| (60.0 / f64::from(k * k) * 2.0 * random.signed(), random.signed() * PI)).collect();
    along(6000, |t| {
        let bumps: f64 =
            terms.iter().enumerate().map(|(k, (size, phase))| size * ((k + 2) as f64 * t * TAU + phase).cos()).sum();
        Point::from_angle(t * TAU) * (130.0 + bumps) + 220.0
    })
}

fn rough(seed: u64) -> Vec<Point> {
    let mut random = Random(seed);
    let mut place = Point::new(60.0, 200.0);
    let mut all = vec![place];
    for _ in 0..24 {
        place += Point::new(18.0 + 10.0 * random.signed(), 45.0 * random.signed());
        all.push(place);
    }
    all
}

fn jittered(mut line: Vec<Point>, size: f64, seed: u64) -> Vec<Point> {
    let mut random = Random(seed);
    for p in &mut line {
        *p += Point::new(random.signed(), random.signed()) * size;
    }
    line
}

/// The lines: each kind as it is, in pixels, and some with the jitter of a hand.
pub fn lines() -> Vec<Line> {
    let mut shapes: Vec<(String, Vec<Point>, bool)> = vec![
        ("S-curve".into(), s_curve(400.0, 60.0, 1.0), false),
        ("long S-curve".into(), s_curve(900.0, 90.0, 2.5), false),
        ("gear".into(), gear(18, 150.0, 24.0), true),
        ("small gear".into(), gear(12, 60.0, 9.0), true),
        ("zigzag".into(), zigzag(12, 14.0, 24.0), false),
        ("low zigzag".into(), zigzag(12, 20.0, 9.0), false),
        ("figure eight".into(), eight(120.0), true),
    ];
    for (name, points) in glyphs(2.0) {
        shapes.push((format!("glyph {name}"), points, true));
    }
    for seed in 0..4 {
        shapes.push((format!("smooth {seed}"), smooth(seed), true));
        shapes.push((format!("rough {seed}"), rough(seed), false));
    }
    let mut all = Vec::new();
    for (name, shape, closed) in shapes {
        let even = resampled(&shape, closed, 1.0);
        all.push(Line { name: format!("{name}, pixels"), points: pixels(&shape, closed), closed });
        all.push(Line { name: format!("{name}, jitter"), points: jittered(even.clone(), 0.3, 7), closed });
        all.push(Line { name, points: even, closed });
    }
    all
}

/// The tolerances of a sweep, in px.
pub fn ladder() -> Vec<f64> {
    vec![0.25, 0.35, 0.5, 0.7, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0]
}
