"""What the tests of traced lines share: the small line film, the film traced once, and what its strokes are."""

import bpy
import line_shots as ls
import numpy as np
import pytest


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    """The first picture of the film."""
    return ls.draw_sequence(tmp_path_factory.mktemp("film"))


@pytest.fixture
def film(addon, library, pictures):
    """The scene with the film."""
    return ls.set_up(pictures)


def opened(pictures, name, make):
    """Opens the file of a scene beside its pictures; the first test that needs it makes it. Returns the active object.

    To open a file takes a hundredth of the time that tracing or painting the film takes.
    """
    path = pictures.with_name(f"{name}.blend")
    if not path.exists():
        make()
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return bpy.context.object


@pytest.fixture
def traced(addon, film, pictures):
    """The film, traced."""

    def trace():
        addon("lines.tracing").make = addon("rototoon").Session.from_document
        assert bpy.ops.rototoon.trace_drawing() == {"FINISHED"}
        assert said(addon).text == "6 strokes on 6 frames"

    return opened(pictures, "traced", trace)


def kinds(addon, ob, layer):
    gp = addon("blender.grease_pencil")
    return {frame: kind for frame, (_, kind) in gp.drawings(gp.find_layer(ob, layer)).items()}


def attribute(addon, ob, layer, frame, name):
    gp = addon("blender.grease_pencil")
    handle, _ = gp.drawings(gp.find_layer(ob, layer))[frame]
    starts = gp.offsets(handle)
    return gp.value(handle, name, int(starts[-1]) if gp.TYPES[name][1] == "POINT" else len(starts) - 1)


def away(points, line):
    """Greatest distance of points from a line given by dense points."""
    return max(np.linalg.norm(line - point, axis=1).min() for point in points)


def said(addon):
    return addon("common.reports").take()[-1]


def handle_of(addon, ob, layer, frame):
    gp = addon("blender.grease_pencil")
    return gp.drawings(gp.find_layer(ob, layer))[frame][0]


def number_of(addon, ob, line):
    """The number of a line of the film."""
    first = ls.strokes(addon, ob, "Lines", 1)
    return min(first, key=lambda number: away(first[number], ls.lines(0)[line][0]))


def rendered(ob, frame, folder):
    """The picture of a frame, RGBA with rows from the top."""
    scene = bpy.context.scene
    scene.render.engine, scene.render.film_transparent, scene.display.render_aa = "BLENDER_WORKBENCH", True, "FXAA"
    scene.render.filepath = str(folder / "line.png")
    scene.frame_set(frame)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    width, height = image.size
    return np.array(image.pixels[:]).reshape(height, width, 4)[::-1]
