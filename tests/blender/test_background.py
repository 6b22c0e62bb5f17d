"""The scripts of the page on background Blender, run as they are printed there, each in a process of its own."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import bpy
import conftest
import numpy as np
import pytest
import shots

PAGE = conftest.ROOT / "docs/src/scripts/blender.md"
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.S)

pytestmark = pytest.mark.usefixtures("library")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the page's scripts, the pictures and the zip."""
    made = tmp_path_factory.mktemp("background")
    for block in BLOCKS:
        name = re.match(r"# (\w+\.py)\n", block)
        if name:
            (made / name[1]).write_text(block, encoding="utf-8")
    shots.draw_sequence(made / "frames")
    named = os.environ.get("ROTOTOON_ZIP")
    if named:
        (made / "rototoon.zip").symlink_to(Path(named).resolve())
    else:
        conftest.build_zip(made)
    return made


def run(folder, *arguments):
    """`headless.py` with `track_shot.py` and arguments."""
    command = [sys.executable, "headless.py", "rototoon.zip", "track_shot.py", "--", *arguments]
    own = {key: value for key, value in os.environ.items() if key != "BLENDER_USER_RESOURCES"}
    return subprocess.run(command, cwd=folder, env=own, capture_output=True, text=True, check=False, timeout=600)


def contours(folder, keys):
    path = folder / f"contours{len(list(folder.iterdir()))}.json"
    path.write_text(json.dumps({str(f): {n: p.tolist() for n, p in polygons.items()} for f, polygons in keys.items()}))
    return path.name


def test_the_whole_script_tracks_a_shot(addon, folder):
    both = {f: {"diamond": shots.diamond(f - 1), "square": shots.square(f - 1)} for f in (1, 9)}
    ended = run(folder, "frames/shot_001.png", contours(folder, both), "shot.blend")
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert "14 contours, 2 spans" in ended.stdout and "needs a key" not in ended.stderr
    bpy.ops.wm.open_mainfile(filepath=str(folder / "shot.blend"))
    ob = bpy.context.scene.objects["shot"]
    track = addon("scripting").tracks(ob)["square"]
    truth = np.stack([shots.square(k) for k in range(9)])
    assert np.linalg.norm(track.pixels - truth, axis=2).max() < 1.5
    assert ob.data.layers["Snapped"].frames
    exported = json.loads((folder / "shot.json").read_text())
    assert sorted(exported["parts"][0]["tracks"], key=int) == [str(f) for f in range(1, 10)]


def test_the_status_tells_what_went_wrong(folder):
    assert run(folder, "frames/shot_001.png").returncode == 2
    one = contours(folder, {1: {"square": shots.square(0)}})
    ended = run(folder, "frames/shot_999.png", one, "none.blend")
    assert ended.returncode == 1 and "No file" in ended.stderr
    assert not (folder / "none.blend").exists()
    vanishing(folder / "vanishing")
    ended = run(folder, "vanishing/shot_001.png", one, "lost.blend")
    assert ended.returncode == 3, ended.stdout + ended.stderr
    assert 'track: "square" needs a key on' in ended.stderr


def test_contours_that_are_most_likely_off_are_named(folder):
    vanishing(folder / "gone")
    both = contours(folder, {f: {"square": shots.square(f - 1)} for f in (1, 9)})
    ended = run(folder, "gone/shot_001.png", both, "off.blend")
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert 'track: "square" is most likely off on' in ended.stderr


def test_without_arguments_the_use_is_shown(folder):
    command = [sys.executable, "headless.py", "rototoon.zip", "track_shot.py"]
    own = {key: value for key, value in os.environ.items() if key != "BLENDER_USER_RESOURCES"}
    ended = subprocess.run(command, cwd=folder, env=own, capture_output=True, text=True, check=False, timeout=600)
    assert ended.returncode == 2 and "Tracks a shot" in ended.stderr


def vanishing(folder):
    """The sequence, in which the square is gone from picture 5 on."""
    shots.draw_sequence(folder)
    xs, ys = np.meshgrid(np.arange(shots.SIZE[0]) + 0.5, np.arange(shots.SIZE[1]) + 0.5)
    for number in range(4, shots.COUNT):
        picture = np.full((*xs.shape, 3), (235, 228, 210), np.uint8)
        shape = shots.diamond(number)
        picture[shots.inside(shape, xs, ys)] = (25, 20, 30)
        picture[shots.inside(shape.mean(0) + (shape - shape.mean(0)) * 0.88, xs, ys)] = (50, 90, 200)
        shots.write_png(folder / f"shot_{number + 1:03d}.png", picture)


@pytest.mark.parametrize("block", [block for block in BLOCKS if not block.startswith("# ")])
def test_the_short_examples_run(addon, fake, tmp_path, monkeypatch, block):
    monkeypatch.chdir(tmp_path)
    ob = shots.two_keys(addon, tmp_path)
    layer = ob.data.layers.new("Ink")
    gp = addon("blender.grease_pencil")
    for frame in (1, 9):
        drawing = layer.frames.new(frame).drawing
        drawing.add_strokes([12])
        gp.put(drawing, "position", shots.mapping(addon, ob).to_layer(np.linspace((10, 10), (60, 20 + frame), 12)))
    exec(compile(block, str(PAGE), "exec"), {"bpy": bpy})  # noqa: S102 - what the page prints is what is tested
