"""The scripts of the page of examples, run as they are printed there, each in a process of its own."""

import csv
import json
import os
import re
import subprocess
import sys

import pytest
from conftest import ADDON, HEIGHT, LAST, ROOT, WIDTH, draw, program, square, write_png
from test_style import FRAMES, figure
from test_style import shelf as shelf

PAGE = ROOT / "docs/src/scripts/examples.md"
BLOCKS = re.findall(r"```python\n(# (\w+\.py)\n.*?)```", PAGE.read_text(encoding="utf-8"), re.S)


@pytest.fixture(scope="module")
def scripts(tmp_path_factory):
    """A folder with the page's scripts."""
    folder = tmp_path_factory.mktemp("scripts")
    for text, name in BLOCKS:
        (folder / name).write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def run(scripts):
    """Runs a script with arguments."""

    def start(name, *words):
        own = {**os.environ, "PYTHONPATH": str(ADDON), "ROTOTOON": str(program()), "PYTHONIOENCODING": "utf-8"}
        command = [sys.executable, str(scripts / name), *map(str, words)]
        return subprocess.run(command, env=own, capture_output=True, text=True, encoding="utf-8", check=False, timeout=300)

    return start


@pytest.fixture(scope="module")
def season(tmp_path_factory):
    """Two shots below a folder. In the second a part has one key, and is gone from the pictures after a while."""
    folder = tmp_path_factory.mktemp("season")
    for shot in ("sh1", "=sh2"):
        place = folder / shot
        place.mkdir()
        gone = shot != "sh1"
        for frame in range(LAST + 1):
            picture = draw(frame)
            if gone and frame > 5:
                picture = [[(235, 230, 210)] * WIDTH for _ in range(HEIGHT)]
            write_png(place / f"f_{frame:03}.png", picture)
        keys = [0] if gone else [0, 6, LAST]
        footage = {"pattern": "f_%03d.png", "first": 0, "last": LAST, "fps": 24, "width": WIDTH, "height": HEIGHT}
        parts = [
            {"name": name, "closed": True, "depth": k, "keys": {str(f): square(f, k) for f in keys}}
            for k, name in enumerate(["=red", "blau ü"])
        ]
        (place / "project.json").write_text(json.dumps({"rototoon": 1, "footage": footage, "parts": parts}), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def done(season, scripts, tmp_path_factory):
    """The results of the first example, and what it said."""
    out = tmp_path_factory.mktemp("results")
    own = {**os.environ, "ROTOTOON": str(program())}
    command = [sys.executable, str(scripts / "night.py"), str(season), str(out)]
    return out, subprocess.run(command, env=own, capture_output=True, text=True, check=False, timeout=300)


def test_there_are_five():
    assert [name for _, name in BLOCKS] == ["night.py", "pins.py", "mattes.py", "restyle.py", "wanted.py"]


def test_a_night_of_shots(run, season, done, tmp_path):
    _, ended = done
    assert ended.returncode == 3, ended.stdout + ended.stderr
    lines = ended.stdout.splitlines()
    assert len(lines) == 2 and "wants_keys" in lines[0] and "lost: =red, blau ü" in lines[0] and " good " in lines[1]
    assert run("night.py", tmp_path, tmp_path / "out").returncode == 2


def test_pins_from_notes(run, done, tmp_path):
    out, _ = done
    x, y = square(3, 0)[0]
    notes = {"notes": [{"frame": 3, "x": x - 2, "y": y, "text": "wider"}, {"frame": 99, "x": 0, "y": 0}, {"frame": 3, "x": 0, "y": 0, "part": "no"}]}
    (tmp_path / "notes.json").write_text(json.dumps(notes))
    ended = run("pins.py", out / "sh1/tracked.json", tmp_path / "notes.json", tmp_path / "out.json")
    assert ended.returncode == 1 and "1 spans tracked again" in ended.stdout, ended.stdout + ended.stderr
    assert "pinned '=red' point 0 on frame 3: wider" in ended.stdout
    assert ended.stderr.count("was left out") == 2 and "no contour on frame 99" in ended.stderr
    part = json.loads((tmp_path / "out.json").read_text())["parts"][0]
    assert part["pins"] == {"3": {"0": [x - 2, y]}}
    assert part["tracks"]["3"][0] == pytest.approx([x - 2, y], abs=0.5)


def test_mattes(run, done, tmp_path):
    out, _ = done
    ended = run("mattes.py", out / "sh1/tracked.json", tmp_path / "mattes", "blau ü")
    assert ended.returncode == 0, ended.stderr
    names = {path.name for path in (tmp_path / "mattes").iterdir()}
    assert len(names) == 2 * (LAST + 1) + 1 and "layers_0012.exr" in names and "group_0000.png" in names
    assert json.loads((tmp_path / "mattes/layers.json").read_text()) == {"layers": {"=red": "=red", "blau ü": "blau ü"}, "group": ["blau ü"]}
    assert run("mattes.py", out / "sh1/tracked.json", tmp_path / "other", "nobody").returncode != 0


def test_the_list_of_mattes_has_the_names_in_the_files(run, season, tmp_path):
    document = json.loads((season / "sh1/project.json").read_text())
    document["parts"] = [dict(document["parts"][0], name=name) for name in ("arm.L", "arm_L", "arm:L", "leg.", "leg_ 2", "leg..")]
    shot = tmp_path / "shot.json"
    shot.write_text(json.dumps(document))
    ended = run("mattes.py", shot, tmp_path / "mattes")
    assert ended.returncode == 0, ended.stderr
    layers = json.loads((tmp_path / "mattes/layers.json").read_text())["layers"]
    assert layers == {"arm_L": "arm_L", "arm:L": "arm:L", "leg_ 2": "leg_ 2", "arm_L 2": "arm.L", "leg_": "leg.", "leg__": "leg.."}
    written = (tmp_path / "mattes/layers_0000.exr").read_bytes()
    assert all(f"{layer}.A\0".encode() in written for layer in layers)


def test_a_folder_of_drawings(run, shelf, tmp_path):
    drawings = tmp_path / "drawings"
    drawings.mkdir()
    for name in ("plain", "stranger"):
        (drawings / f"{name}.json").write_text(json.dumps(figure()))
    ended = run("restyle.py", drawings, shelf, "walk", "old", tmp_path / "out")
    assert ended.returncode == 1 and "stranger.json: " in ended.stderr, ended.stdout + ended.stderr
    moved = json.loads((tmp_path / "out/plain.json").read_text())
    assert len(moved["parts"][2]["keys"]) == FRAMES or len(moved["parts"][2].get("tracks", {})) == FRAMES
    assert not (tmp_path / "out/stranger.json").exists()


def test_the_keys_of_a_season(run, done, tmp_path):
    out, _ = done
    ended = run("wanted.py", tmp_path / "season.csv", out, tmp_path / "none")
    assert ended.returncode == 1 and "--summary" in ended.stderr
    with open(tmp_path / "season.csv", newline="", encoding="utf-8-sig") as file:
        head, *rows = csv.reader(file)
    assert head == ["worth", "batch", "shot", "part", "frame", "why"]
    assert {row[2] for row in rows} == {"'=sh2"} and {row[3] for row in rows} == {"'=red", "blau ü"}
    worth = [float(row[0]) for row in rows]
    assert worth == sorted(worth, reverse=True) and worth[0] > 0
