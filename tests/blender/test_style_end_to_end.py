"""The sample cartoon's walk, captured, re-made in an old man's manner and given to a drawn doll, all by operators; then rendered.

The doll's arms and legs cross its body and each other on every frame. What lies over what is told by nine marks, and is looked at
twice: in the order of the strokes, and in the pixels of rendered frames.
"""

import json
import math
import os
import shutil
import subprocess
from pathlib import Path

import bpy
import numpy as np
import pytest
import shots

ROOT = Path(__file__).resolve().parents[2]
BACK_TO_FRONT = (
    "far arm", "far mitten", "far leg", "far boot", "near leg", "near boot", "body", "head", "near arm", "near mitten",
)  # fmt: skip
"""How the sample character's limbs lie over each other, and so the doll's."""
COLOURS = {name: ((k % 3) / 2, (k // 3 % 3) / 2, 1.0 if k < 5 else 0.0) for k, name in enumerate(BACK_TO_FRONT)}
"""A colour for each part that no other one is near."""
WALK = range(12)
LEAN = 0.45
SMALLER = 2
"""How many pixels of the footage a pixel of a rendered frame is wide. To render takes the most time, and a part is far larger."""


@pytest.fixture(scope="module")
def sample(tmp_path_factory):
    """The sample cartoon and the doll as files: those that a variable names, else newly written."""
    if written := os.environ.get("ROTOTOON_SAMPLE"):
        return Path(written)
    cargo = shutil.which("cargo")
    if cargo is None:
        pytest.skip("no cargo to write the sample cartoon with")
    folder = tmp_path_factory.mktemp("sample")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    command = [cargo, "run", "--quiet", "-p", "xtask-measure", "--", "sample", str(folder)]
    subprocess.run(command, cwd=ROOT, env=environment, check=True)
    return folder


def aged(addon, clip):
    """An old man's version of a clip: bent forward from the hips."""
    upper = [k for k, name in enumerate(addon("rototoon.style").KEY_POINTS) if k < 11]
    points = np.array(clip["points"])
    points[:, upper] = turned(points[:, upper], points[:, :1], LEAN)
    return {"character": "old", "motion": clip["motion"], "points": points.tolist()}


def turned(points, centre, angle):
    c, s = math.cos(angle), math.sin(angle)
    return (points - centre) @ np.array([[c, s], [-s, c]]) + centre


def capture(addon, sample, shelf):
    """Tracks the sample and keeps its walk and jump, and an old man's jump."""
    assert bpy.ops.rototoon.import_document(filepath=str(sample / "sample/project.json"), keep_numbers=True) == {"FINISHED"}
    ob = bpy.context.object
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    for motion, first, last in (("walk", 0, WALK[-1]), ("jump", WALK[-1] + 1, ob.rototoon.last)):
        clip = {"character": "boy", "motion": motion, "first": first, "last": last, "folder": shelf}
        assert bpy.ops.rototoon.save_clip(**clip) == {"FINISHED"}
    style = addon("rototoon.style")
    found = style.read_library(shelf).clips
    jump = next(clip for clip in found["clips"] if clip["motion"] == "jump")
    style.add_to_library(shelf, {**found, "clips": [aged(addon, jump)]})
    ob.hide_render = True


def coloured_doll(addon, sample):
    """The doll, each part filled with a colour of its own."""
    assert bpy.ops.rototoon.import_document(filepath=str(sample / "doll/doll.json"), keep_numbers=True) == {"FINISHED"}
    ob, gp = bpy.context.object, addon("blender.grease_pencil")
    handle = gp.drawings(shots.layer_of(ob))[0][0]
    strokes = len(gp.offsets(handle)) - 1
    numbers = gp.value(handle, gp.PART, strokes)
    names = {part.number: part.name for part in ob.rototoon.parts}
    ob.data.materials.clear()
    for name in BACK_TO_FRONT:
        material = bpy.data.materials.new(name)
        bpy.data.materials.create_gpencil_data(material)
        style = material.grease_pencil
        style.show_fill, style.show_stroke = True, False
        style.fill_color = (*COLOURS[name], 1.0)
        ob.data.materials.append(material)
    gp.put(handle, "material_index", np.array([BACK_TO_FRONT.index(names[n]) for n in numbers], np.int32))
    if bpy.app.version >= (5, 1):
        gp.make(handle, "fill_id", "INT", "CURVE")
        gp.put(handle, "fill_id", np.arange(1, strokes + 1, dtype=np.int32))
    return ob


def topmost(contours, order, size):
    """The place in `order` of the part seen at every pixel, -1 for none; and which pixels are near no outline."""
    seen = np.full(size[::-1], -1)
    sure = np.ones(size[::-1], bool)
    for place, name in enumerate(order):
        ring = contours[name]
        low = np.clip(np.floor(ring.min(0)) - 4, 0, size).astype(int)
        high = np.clip(np.ceil(ring.max(0)) + 4, 0, size).astype(int)
        box = np.s_[low[1] : high[1], low[0] : high[0]]
        x, y = np.meshgrid(np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1]) + 0.5)
        inside, apart = np.zeros(x.shape, bool), np.ones(x.shape, bool)
        for a, b in zip(ring, np.roll(ring, -1, 0)):
            along = b - a
            if along[1]:
                crossing = a[0] + (y - a[1]) / along[1] * along[0]
                inside ^= ((a[1] > y) != (b[1] > y)) & (x < crossing)
            share = np.clip(((x - a[0]) * along[0] + (y - a[1]) * along[1]) / (along @ along), 0, 1)
            apart &= np.hypot(x - a[0] - share * along[0], y - a[1] - share * along[1]) > 1.0 + SMALLER
        seen[box][inside] = place
        sure[box] &= apart
    return seen, sure


def rendered(frame, path):
    """Pixels (H, W, 4) of a frame, the top row first."""
    scene = bpy.context.scene
    scene.frame_set(frame)
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    values = values.reshape(image.size[1], image.size[0], 4)[::-1]
    bpy.data.images.remove(image)
    return values


def prepare_rendering():
    """Fills alone, in their own colours, on nothing."""
    scene = bpy.context.scene
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.render.film_transparent = True
    scene.render.resolution_percentage = 100 // SMALLER
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.view_settings.view_transform = "Raw"
    scene.display.shading.light = "FLAT"
    scene.display.shading.color_type = "MATERIAL"
    scene.display.render_aa = "OFF"


def test_the_walk_is_given_to_the_doll(addon, library, sample, tmp_path):
    shelf = str(tmp_path / "clips")
    capture(addon, sample, shelf)
    ob = coloured_doll(addon, sample)
    ob.rototoon.clips_folder = shelf
    listed = [(item.character, item.motion) for item in addon("style.clip_browser").browser().clips]
    assert listed == [("boy", "jump"), ("boy", "walk"), ("old", "jump")]
    bpy.context.scene.frame_set(0)
    motion = {"motion": "walk", "content": "boy", "style": "old", "strength": 2.5}
    assert bpy.ops.rototoon.apply_motion(**motion) == {"FINISHED"}

    names = {part.number: part.name for part in ob.rototoon.parts}
    size = (ob.rototoon.width, ob.rototoon.height)
    drawn = {frame: [(names[n], p) for n, p in shots.pixels(addon, ob, frame)] for frame in range(1, len(WALK) + 1)}
    prepare_rendering()
    leans = []
    for frame, strokes in drawn.items():
        contours = dict(strokes)
        wanted, sure = topmost(contours, BACK_TO_FRONT, size)
        own = np.array([BACK_TO_FRONT.index(name) for name, _ in strokes])
        found, _ = topmost(contours, [name for name, _ in strokes], size)
        backwards, _ = topmost(contours, BACK_TO_FRONT[::-1], size)
        crossing = np.where(backwards < 0, backwards, len(own) - 1 - backwards) != wanted
        assert crossing.sum() > 300, f"frame {frame}: limbs cross, else this shows nothing"
        assert np.array_equal(np.where(found < 0, found, own[found]), wanted), f"frame {frame}: {own}"
        body = contours["body"]
        leans.append(math.atan2(*((body[12] - body[4]) * (1, -1))))
        if frame % 4 == 1:
            compare(rendered(frame, tmp_path / f"doll_{frame}.png"), wanted, sure, frame)
    assert np.mean(leans) > 0.15, "an old man leans forward"
    report = os.environ.get("ROTOTOON_PICTURES")
    if report:
        for path in tmp_path.glob("doll_*.png"):
            shutil.copy(path, report)


def compare(picture, wanted, sure, frame):
    """The parts' colours in a rendered frame against which part should be seen."""
    # The middle of a rendered pixel is nearer to this pixel of the footage than to an outline.
    wanted, sure = wanted[SMALLER // 2 :: SMALLER, SMALLER // 2 :: SMALLER], sure[SMALLER // 2 :: SMALLER, SMALLER // 2 :: SMALLER]
    assert picture.shape[:2] == wanted.shape
    palette = np.array([COLOURS[name] for name in BACK_TO_FRONT])
    near = np.abs(picture[:, :, None, :3] - palette).sum(-1).argmin(-1)
    seen = np.where(picture[..., 3] < 0.5, -1, near)
    assert (wanted[sure] >= 0).sum() > 5000 / SMALLER**2
    assert (seen[sure] == wanted[sure]).mean() > 0.999, f"frame {frame}"
    assert (seen[sure & (wanted >= 0)] == wanted[sure & (wanted >= 0)]).mean() > 0.99, f"frame {frame}"


def test_without_the_artist_s_marks_the_order_is_not_known(addon, library, sample):
    """The marks come into Blender with the document, and leave it with it."""
    bpy.ops.rototoon.import_document(filepath=str(sample / "doll/doll.json"), keep_numbers=True)
    marks = addon("style.limbs").marks(bpy.context.object)
    assert marks == json.loads((sample / "doll/doll.json").read_text())["depth_marks"] and len(marks) == 9
