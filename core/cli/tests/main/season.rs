//! A folder with small shots, for the tests of `rototoon batch`.

use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// Frames of a shot.
pub const FRAMES: i32 = 5;

/// A folder with shots of a square that moves, and a manifest.
pub struct Season {
    /// The folder.
    pub folder: tempfile::TempDir,
}

pub fn draw(path: &Path, left: i32) {
    let picture = image::RgbImage::from_fn(64, 48, |x, y| {
        let inside = (left..left + 20).contains(&(x as i32)) && (12..36).contains(&y);
        let grain = ((x * 7 + y * 13) % 11) as u8;
        image::Rgb(if inside { [200, 60 + 3 * grain, 40] } else { [180, 200, 220 + grain] })
    });
    picture.save(path).unwrap();
}

pub fn square(left: i32) -> Value {
    json!([[left, 12], [left + 20, 12], [left + 20, 36], [left, 36]])
}

pub fn steps() -> Value {
    json!([{"do": "check"}, {"do": "track"}, {"do": "snap"}, {"do": "render", "what": "matte", "to": "matte_%03d.png"},
        {"do": "export", "to": "shapes.svg"}])
}

impl Season {
    /// So many shots; each has a speed of its own.
    pub fn new(shots: usize) -> Self {
        let season = Self { folder: tempfile::tempdir().unwrap() };
        for k in 0..shots {
            season.shot(k);
        }
        season.manifest(&steps(), shots);
        season
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn shot(&self, k: usize) {
        let (folder, speed) = (self.path(&format!("in/sh{k}")), 1 + k as i32 % 3);
        fs::create_dir_all(&folder).unwrap();
        (0..FRAMES).for_each(|frame| draw(&folder.join(format!("f_{frame:03}.png")), 8 + speed * frame));
        let footage =
            json!({"pattern": "f_%03d.png", "first": 0, "last": FRAMES - 1, "fps": 12, "width": 64, "height": 48});
        let keys = json!({"0": square(8), (FRAMES - 1).to_string(): square(8 + speed * (FRAMES - 1))});
        let document =
            json!({"rototoon": 1, "footage": footage, "parts": [{"name": "square", "closed": true, "keys": keys}]});
        fs::write(folder.join("project.json"), document.to_string()).unwrap();
    }

    pub fn manifest(&self, steps: &Value, shots: usize) {
        let shot = |k: usize| json!({"name": format!("sh{k}"), "project": format!("in/sh{k}/project.json")});
        let shots: Vec<_> = (0..shots).map(shot).collect();
        fs::write(self.path("m.json"), json!({"rototoon_batch": 1, "steps": steps, "shots": shots}).to_string())
            .unwrap();
    }

    pub fn command(&self, more: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rototoon"));
        command.current_dir(self.folder.path()).args(["batch", "m.json", "-o", "out"]).args(more);
        command
    }

    pub fn run(&self, more: &[&str]) -> Output {
        self.command(more).output().unwrap()
    }

    /// Runs the batch; its status must be 0.
    pub fn good(&self, more: &[&str]) -> String {
        let output = self.run(more);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{said}");
        said
    }

    /// The result files of all shots with their bytes.
    pub fn results(&self) -> BTreeMap<String, Vec<u8>> {
        let mut found = BTreeMap::new();
        for shot in
            fs::read_dir(self.path("out")).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir())
        {
            for file in fs::read_dir(&shot).unwrap().map(|entry| entry.unwrap().path()) {
                let name = file.file_name().unwrap().to_str().unwrap().to_owned();
                if !name.starts_with('.') && name != "batch.json" {
                    let place = format!("{}/{name}", shot.file_name().unwrap().to_str().unwrap());
                    found.insert(place, fs::read(&file).unwrap());
                }
            }
        }
        found
    }

    /// Lines of the report of a kind.
    pub fn events(&self, kind: &str) -> Vec<Value> {
        let text = fs::read_to_string(self.path("out/report.jsonl")).unwrap();
        let lines = text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
        lines.filter(|line| line["event"] == kind).collect()
    }

    /// Whether the report is there and has a line of a kind.
    pub fn has_event(&self, kind: &str) -> bool {
        self.path("out/report.jsonl").exists() && !self.events(kind).is_empty()
    }

    pub fn clear_report(&self) {
        fs::remove_file(self.path("out/report.jsonl")).unwrap();
    }

    pub fn record(&self, shot: &str) -> Value {
        serde_json::from_slice(&fs::read(self.path(&format!("out/{shot}/batch.json"))).unwrap()).unwrap()
    }
}

pub fn outcomes(events: &[Value]) -> Vec<&str> {
    events.iter().map(|event| event["outcome"].as_str().unwrap()).collect()
}

/// Waits until something is found, for a minute at most.
pub fn wait_for(what: &str, mut found: impl FnMut() -> bool) {
    let end = Instant::now() + Duration::from_secs(60);
    while !found() {
        assert!(Instant::now() < end, "{what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}
