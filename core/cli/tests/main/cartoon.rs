//! A folder with a short cartoon, and calls of the program, for the tests of the command line.

use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder with a short cartoon of 64x48 pixels: a square that moves 3 px per frame on frames 0 to 6.
pub struct Cartoon {
    /// The folder.
    pub folder: tempfile::TempDir,
}

/// Frames of the cartoon, counted from 0.
pub const FRAMES: i32 = 7;

pub fn draw(path: &Path, frame: i32, width: u32, height: u32) {
    let left = 8 + 3 * frame;
    let picture = image::RgbImage::from_fn(width, height, |x, y| {
        let inside = (left..left + 20).contains(&(x as i32)) && (12..36).contains(&y);
        let grain = ((x * 7 + y * 13) % 11) as u8;
        image::Rgb(if inside { [200, 60 + 3 * grain, 40] } else { [180, 200, 220 + grain] })
    });
    picture.save(path).unwrap();
}

pub fn square(left: f64) -> Value {
    json!([[left, 12.0], [left + 20.0, 12.0], [left + 20.0, 36.0], [left, 36.0]])
}

impl Cartoon {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("frames")).unwrap();
        let cartoon = Self { folder };
        for frame in 0..FRAMES {
            draw(&cartoon.frame(frame), frame, 64, 48);
        }
        cartoon
    }

    pub fn frame(&self, frame: i32) -> PathBuf {
        self.path(&format!("frames/f_{frame:03}.png"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes the document `name` with these parts.
    pub fn document(&self, name: &str, parts: Value) -> PathBuf {
        let footage =
            json!({"pattern": "frames/f_%03d.png", "first": 0, "last": 6, "fps": 12, "width": 64, "height": 48});
        let path = self.path(name);
        fs::write(&path, json!({"rototoon": 1, "footage": footage, "parts": parts, "note": "kept"}).to_string())
            .unwrap();
        path
    }

    /// The document of the square with keys on the first and the last frame.
    pub fn keyed(&self) -> PathBuf {
        let part = json!({"name": "square", "keys": {"0": square(8.0), "6": square(26.0)}, "label": [1.0]});
        self.document("project.json", json!([part]))
    }

    /// Names of the files in the folder.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(self.folder.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

pub fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rototoon"));
    command.args(arguments);
    command
}

pub fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

pub fn said(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Runs a command that must succeed. Returns its standard error.
pub fn good(arguments: &[&str]) -> String {
    let output = command(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", said(&output));
    assert!(output.stdout.is_empty());
    said(&output)
}

/// Runs a command that must fail with this exit status. Returns its standard error.
pub fn bad(arguments: &[&str], status: i32) -> String {
    let output = command(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {}", said(&output));
    said(&output)
}

pub fn read(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}
