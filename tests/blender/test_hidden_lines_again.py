"""Remove Hidden Lines on what it has cut before: the pieces still say where they are on the complete stroke."""

import bpy
import numpy as np
import pytest
from test_hidden_lines import cover
from test_strokes import add, circle, content, drawing, drawing_object, wave

pytestmark = [pytest.mark.every_version, pytest.mark.usefixtures("library")]

COVERS = ((0.7, 0.3), (2.9, 0.25), (1.8, 0.2))
"""Centre and radius."""


def uneven(count=23):
    x = np.cumsum(1 + 0.8 * np.sin(np.arange(count)))
    return np.stack([4 * (x - x[0]) / (x[-1] - x[0]), 0 * x], 1)


def stroke(addon, kind):
    """An object with one stroke from 0 to 4 and an empty layer in front of it for each cover."""
    ob = drawing_object(addon, ("Lines", *(f"Front {k}" for k in range(len(COVERS)))))
    if kind == "round":
        add(addon, ob, "Lines", 1, [np.array([1.8, 0]) + circle((0, 0), 1.1, 50)], cyclic=True)
    else:
        add(addon, ob, "Lines", 1, [wave() if kind == "curve" else uneven()])
    if kind == "curve":
        bpy.ops.rototoon.fit_strokes(tolerance=1.0)
    return ob


def height(kind, x):
    return {"line": 0.0, "curve": 0.4 * np.sin(2 * x), "round": 0.0 if x != 1.8 else 1.1}[kind]


def pieces(addon, ob):
    """The intervals of the pieces of the stroke, by where they begin and end."""
    own = content(addon, ob, "Lines", 1)
    ends = [own.point["position"][[a, b - 1]][:, [0, 2]].round(2) for a, b in zip(own.starts, own.starts[1:])]
    return sorted((*end.ravel().tolist(), *interval) for end, interval in zip(ends, own.curve["rototoon_interval"].tolist()))


def cut(addon, kind, runs):
    """The pieces after some runs, each with its covers."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    ob = stroke(addon, kind)
    for run in runs:
        for k in run:
            x, radius = COVERS[k]
            cover(addon, ob, f"Front {k}", 1, (x, height(kind, x)), radius)
        assert bpy.ops.rototoon.hidden_lines() == {"FINISHED"}
    return np.array(pieces(addon, ob))


@pytest.mark.parametrize("kind", ["line", "curve", "round"])
@pytest.mark.parametrize("runs", [((0,), (1,), (2,)), ((2,), (0, 1)), ((1, 2), (0,))])
def test_pieces_of_pieces_have_the_intervals_of_the_complete_stroke(addon, kind, runs):
    once, again = cut(addon, kind, ((0, 1, 2),)), cut(addon, kind, runs)
    assert len(once) == (3 if kind == "round" else 4) and once.shape == again.shape
    assert np.allclose(once[:, :4], again[:, :4], atol=0.011)
    away = again[:, 4:] - once[:, 4:]
    # A piece of what runs over the seam is counted on from there.
    away -= 50 * np.round(away / 50) if kind == "round" else 0
    assert np.abs(away).max() < 2e-3


def test_a_piece_with_points_more_is_cut_within_its_interval(addon):
    ob = stroke(addon, "line")
    cover(addon, ob, "Front 1", 1, (2.9, 0), 0.25)
    bpy.ops.rototoon.hidden_lines()
    strokes, handle = addon("blender.strokes"), drawing(addon, ob, "Lines", 1)
    own = strokes.read(handle)
    first = own.curve["rototoon_interval"][0]
    # The artist takes a point away from the first piece.
    rows = np.delete(np.arange(int(own.starts[-1])), 3)
    sizes = own.sizes - np.array([1, 0], np.int32)
    strokes.write(handle, strokes.Content(sizes, own.types, {name: each[rows] for name, each in own.point.items()}, own.curve, own.kinds))
    cover(addon, ob, "Front 0", 1, (0.7, 0), 0.3)
    bpy.ops.rototoon.hidden_lines()
    found = content(addon, ob, "Lines", 1).curve["rototoon_interval"][:2]
    assert found[0, 0] == first[0] and found[1, 1] == pytest.approx(first[1], abs=1e-3)
    assert first[0] < found[0, 1] < found[1, 0] < first[1]
