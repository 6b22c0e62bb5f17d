"""Edit on All Frames, with frames on which the artist or Remove Hidden Lines has changed the same strokes. With the real library."""

import bpy
import numpy as np
import pytest
from line_stage import film, pictures, traced  # noqa: F401 - fixtures
from line_stage import attribute, away, handle_of, number_of
from test_lines_edited import cover, cut_elsewhere, edit, radii_of

RAISED = np.float32([0, 0, 0.1])
OTHER = 4


def strokes_of(addon, ob, number, frame=OTHER):
    """The strokes of a number on a frame: points and whether they are closed."""
    content, gp = addon("blender.strokes").read(handle_of(addon, ob, "Lines", frame)), addon("blender.grease_pencil")
    rows = zip(content.starts, content.starts[1:], content.strokes(gp.TRACK), content.strokes("cyclic"))
    return [(content.point["position"][a:b], bool(closed)) for a, b, own, closed in rows if own == number]


def change(addon, ob, number, rows_of, after=lambda content: None):
    """Gives a stroke on the other frame other points of its drawing: `rows_of(spans)` gets the points of each stroke by number. All strokes of which it
    takes points become this one."""
    gp, strokes = addon("blender.grease_pencil"), addon("blender.strokes")
    handle = handle_of(addon, ob, "Lines", OTHER)
    content = strokes.read(handle)
    tracks = content.strokes(gp.TRACK).tolist()
    rows = rows_of({own: np.arange(*content.starts[i : i + 2]) for i, own in enumerate(tracks)})
    taken = np.unique(np.searchsorted(content.starts, rows, "right") - 1)
    one = strokes.chosen(content, [tracks.index(number)])
    made = strokes.Content(np.array([len(rows)], np.int32), one.types, {k: v[rows] for k, v in content.point.items()}, one.curve, one.kinds)
    after(made)
    rest = strokes.chosen(content, [i for i in range(len(tracks)) if i not in taken])
    strokes.write(handle, strokes.joined(rest, made))


def raise_on_first(addon, ob, number):
    edit(addon, ob, 1, number, lambda points: points + RAISED)
    bpy.ops.rototoon.spread_edits()


@pytest.mark.parametrize("end", [0, -1])
def test_what_was_drawn_on_to_a_stroke_there_stays(addon, traced, end):
    gp, arm = addon("blender.grease_pencil"), number_of(addon, traced, 4)

    def longer(spans):
        own = spans[arm]
        return np.concatenate([own[:1].repeat(5), own] if end == 0 else [own, own[-1:].repeat(5)])

    def draw(made):
        new = slice(0, 5) if end == 0 else slice(-5, None)
        way = np.linspace(0.1, 0.5, 5)[:, None] * np.float32([1, 0, 0])
        made.point["position"][new] += -way[::-1] if end == 0 else way
        for name in (gp.LINE, gp.ALONG, gp.TRACKED):
            made.point[name][new] = 0

    change(addon, traced, arm, longer, draw)
    ((before, _),) = strokes_of(addon, traced, arm)
    raise_on_first(addon, traced, arm)
    ((now, _),) = strokes_of(addon, traced, arm)
    assert len(now) == len(before) and np.linalg.norm(now[end] - before[end]) == pytest.approx(0.1, abs=0.06)


def test_strokes_that_were_joined_there_stay_joined(addon, traced):
    arm, mouth = number_of(addon, traced, 4), number_of(addon, traced, 3)
    change(addon, traced, arm, lambda spans: np.concatenate([spans[arm], spans[mouth]]))
    ((before, _),) = strokes_of(addon, traced, arm)
    raise_on_first(addon, traced, arm)
    ((now, _),) = strokes_of(addon, traced, arm)
    assert len(now) == len(before)


@pytest.mark.parametrize("rows_of", [lambda own: own[1:], lambda own: np.roll(own, len(own) // 2)], ids=["without its first point", "begun elsewhere"])
def test_a_closed_stroke_stays_closed(addon, traced, rows_of):
    body = number_of(addon, traced, 0)
    change(addon, traced, body, lambda spans: rows_of(spans[body]))
    raise_on_first(addon, traced, body)
    ((_, closed),) = strokes_of(addon, traced, body)
    assert closed


def bulges(addon, ob, number):
    """Raises a stroke near its begin, and then near its end. Returns what it is on the other frame."""
    for centre in (0.2, 0.8):
        edit(addon, ob, 1, number, lambda points, at=centre: points + np.exp(-(((np.linspace(0, 1, len(points)) - at) / 0.1) ** 2))[:, None] * 5 * RAISED)
        bpy.ops.rototoon.spread_edits()
    return [points for points, _ in strokes_of(addon, ob, number)]


def test_pieces_there_are_reshaped_over_their_own_stretch_again(addon, traced):
    arm = number_of(addon, traced, 4)
    (whole,) = bulges(addon, traced, arm)
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    ob = bpy.context.object
    cut_elsewhere(addon, ob, OTHER, arm, [(0, 0.45), (0.55, 1)])
    pieces = bulges(addon, ob, arm)
    assert len(pieces) == 2 and max(away(points, whole) for points in pieces) < 0.05


def test_an_edit_of_a_shortened_stroke_is_as_large_on_a_piece_there(addon, traced):
    arm = number_of(addon, traced, 4)
    edit(addon, traced, 1, arm, lambda points: points + RAISED)
    cut_elsewhere(addon, traced, 1, arm, [(0.5, 0.8)])
    cut_elsewhere(addon, traced, OTHER, arm, [(0.7, 1)])
    ((before, _),) = strokes_of(addon, traced, arm)
    bpy.ops.rototoon.spread_edits()
    ((now, _),) = strokes_of(addon, traced, arm)
    assert np.linalg.norm(now[0] - before[0]) == pytest.approx(0.1, abs=0.01)


def test_a_look_leaves_what_remove_hidden_lines_left_where_it_was_on_its_stroke(addon, traced):
    gp = addon("blender.grease_pencil")
    cover(addon, traced, 2)
    bpy.context.scene.frame_set(2)
    bpy.ops.rototoon.hidden_lines()
    before = attribute(addon, traced, "Lines", 2, gp.ALONG)
    handle = handle_of(addon, traced, "Lines", 2)
    gp.put(handle, "radius", np.full(len(before), 0.3))
    bpy.ops.rototoon.spread_edits()
    assert np.allclose(attribute(addon, traced, "Lines", 2, gp.ALONG), before, atol=1e-3)


@pytest.fixture
def filled(addon, traced):
    """The film, with a fill of the body, whose line is cut on the other frame. Returns the object and the number of the body."""
    gp, strokes, body = addon("blender.grease_pencil"), addon("blender.strokes"), number_of(addon, traced, 0)
    fill, name = 1, "fill_id"
    if not gp.FILL_BY_ID:
        material = traced.data.materials[0].copy()
        material.grease_pencil.show_fill = True
        traced.data.materials.append(material)
        fill, name = len(traced.data.materials) - 1, "material_index"
    for frame in range(1, 7):
        handle = handle_of(addon, traced, "Lines", frame)
        content = strokes.read(handle)
        content.set_strokes(name, np.where(content.strokes(gp.TRACK) == body, fill, content.strokes(name)).astype(np.int32))
        strokes.write(handle, content)
    cover(addon, traced, OTHER)
    bpy.context.scene.frame_set(OTHER)
    bpy.ops.rototoon.hidden_lines()
    bpy.context.scene.frame_set(1)
    return traced, body


@pytest.mark.every_version
@pytest.mark.parametrize("shape, look", [(True, False), (False, True), (True, True)])
def test_hidden_lines_stay_hidden_there(addon, filled, shape, look):
    gp, strokes = addon("blender.grease_pencil"), addon("blender.strokes")
    ob, body = filled

    def state():
        content = strokes.read(handle_of(addon, ob, "Lines", OTHER))
        mine = np.flatnonzero(content.strokes(gp.TRACK) == body)
        opacity = content.point["opacity"][content.starts[:-1][mine]]
        return list(zip(strokes.filled(ob, content)[mine] != 0, opacity, content.strokes("cyclic")[mine]))

    before = state()
    assert [tuple(map(bool, each)) for each in before] == [(True, False, True), (False, True, False), (False, True, False)]
    if look:
        handle = handle_of(addon, ob, "Lines", 1)
        gp.put(handle, "radius", np.full(int(gp.offsets(handle)[-1]), 0.3))
    if shape:
        edit(addon, ob, 1, body, lambda points: points + RAISED)
    bpy.ops.rototoon.spread_edits()
    assert state() == before
    assert not look or all(np.allclose(each, 0.3) for each in radii_of(addon, ob, OTHER).values())
