"""Solid shapes of a line film: filled outlines behind the lines, in Blender, in documents and carried."""

import json

import bpy
import line_shots as ls
import numpy as np
import pytest
from line_stage import attribute, rendered, said
from shots import write_png

pytestmark = pytest.mark.every_version

RADIUS = 13.0


def centre(frame):
    """Of the black disc on picture `frame`: it runs ahead of the body."""
    return np.array([24.0 + 4 * frame, 34.0])


def disc(frame, count=48):
    turn = 2 * np.pi * np.arange(count) / count
    return centre(frame) + RADIUS * np.stack([np.cos(turn), np.sin(turn)], 1)


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    """The line film with a black disc that moves. Returns the first picture."""
    folder = tmp_path_factory.mktemp("solids")
    xs, ys = np.meshgrid(np.arange(ls.SIZE[0]) + 0.5, np.arange(ls.SIZE[1]) + 0.5)
    for frame in range(ls.COUNT):
        x, y = centre(frame)
        cover = (RADIUS + 0.5 - np.hypot(xs - x, ys - y)).clip(0, 1)[..., None]
        seen = ls.picture(frame).astype(float)
        write_png(folder / f"line_{frame + 1:03}.png", (seen + cover * (np.array(ls.INK, float) - seen)).round().astype(np.uint8))
    return folder / "line_001.png"


@pytest.fixture
def film(addon, library, pictures):
    addon("lines.tracing").make = addon("rototoon").Session.from_document
    return ls.set_up(pictures)


def fills(addon, ob, layer="Lines"):
    """By frame, the filled strokes."""
    found = addon("scripting").lines(ob, layer)
    return {frame: [line for line in strokes if line.fill] for frame, strokes in found.items()}


def test_a_solid_shape_is_one_filled_stroke_behind_the_lines(addon, film, tmp_path):
    assert bpy.ops.rototoon.trace_drawing() == {"FINISHED"}
    assert said(addon).text == "7 strokes on 6 frames"
    found = fills(addon, film)
    assert sorted(found) == [1, 2, 3, 4, 5, 6]
    for frame, (line,) in found.items():
        assert line.closed and line.number == found[1][0].number
        assert np.linalg.norm(line.pixels - centre(frame - 1), axis=1) == pytest.approx(RADIUS, abs=0.8)
        first, *others = attribute(addon, film, "Lines", frame, "material_index")
        assert film.data.materials[int(first)].name.startswith("Line Fill ") and first not in others
    inside, outside = coverage(rendered(film, 4, tmp_path), centre(3))
    assert inside.min() > 0.9 and outside.max() < 0.1, "the shape is filled and has no line around it"


def test_the_shape_goes_into_a_document_and_comes_back(addon, film, tmp_path):
    bpy.ops.rototoon.trace_drawing()
    path = tmp_path / "solid.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    assert said(addon).text == "traced lines of 6 frames in solid.json", "no contours are needed"
    document = json.loads(path.read_text())
    assert document["parts"] == []
    for each in document["traced"]:
        assert [stroke.get("fill", False) for stroke in each["strokes"]] == [True] + 6 * [False]
        assert "widths" not in each["strokes"][0] and each["strokes"][0]["colour"] == pytest.approx(np.array(ls.INK) / 255, abs=0.02)
    bpy.ops.rototoon.import_document(filepath=str(path))
    assert bpy.context.object != film
    before, after = fills(addon, film), fills(addon, bpy.context.object)
    for frame, (line,) in after.items():
        assert line.number == before[frame][0].number and np.allclose(line.pixels, before[frame][0].pixels, atol=1e-3)
    document["traced"][1]["strokes"][0]["closed"] = False
    path.write_text(json.dumps(document))
    with pytest.raises(RuntimeError, match=r"traced\[1\].strokes\[0\].fill: found true, expected true or false, and true only for a closed stroke"):
        bpy.ops.rototoon.import_document(filepath=str(path))


def test_a_shape_of_the_artist_is_carried_with_its_material(addon, film):
    ls.put(addon, film, "Ink", 1, [(disc(0), True)])
    gp, materials = addon("blender.grease_pencil"), addon("blender.line_materials")
    handle = gp.drawings(gp.find_layer(film, "Ink"))[1][0]
    gp.put(handle, "material_index", np.array([materials.make(film, np.array([0.1, 0.1, 0.15]), fill=True)], np.int32))
    if gp.FILL_BY_ID:
        for name, value in (("fill_id", 3), ("hide_stroke", True)):
            gp.make(handle, name, *gp.TYPES[name])
            gp.put(handle, name, np.array([value]))
    assert bpy.ops.rototoon.carry_strokes() == {"FINISHED"}
    found = fills(addon, film, "Ink")
    assert sorted(found) == [1, 2, 3, 4, 5, 6]
    for frame, (line,) in found.items():
        assert line.number == 1 and line.closed
        assert line.pixels.mean(0) == pytest.approx(centre(frame - 1), abs=1)


def coverage(pixels, middle):
    """How much dark ink there is well inside of the disc, and close around it."""
    ys, xs = np.mgrid[: pixels.shape[0], : pixels.shape[1]] + 0.5
    away = np.hypot(xs - middle[0], ys - middle[1])
    ink = pixels[..., 3] * (pixels[..., :3].max(-1) < 0.4)
    return ink[away < RADIUS - 2], ink[(away > RADIUS + 1.5) & (away < RADIUS + 4)]
