"""Carry Strokes on several layers whose drawings are on different frames, and Trace Image. With the real library."""

import weakref

import bpy
import line_shots as ls
import numpy as np
import pytest
from line_stage import film, pictures, traced  # noqa: F401 - fixtures
from line_stage import away, number_of


def counts(addon, ob, layer):
    gp = addon("blender.grease_pencil")
    return {frame: len(gp.offsets(handle)) - 1 for frame, (handle, _) in gp.drawings(ob.data.layers[layer]).items()}


def messages(addon):
    return [each.text for each in addon("common.reports").take()]


def test_a_layer_beside_that_of_trace_drawing_gets_its_own_strokes_only(addon, traced):
    ls.put(addon, traced, "Red", 1, [(ls.lines(0)[0][0] + 2.0, True)])
    traced.data.layers.active = traced.data.layers["Red"]
    bpy.ops.rototoon.carry_strokes(layers="ALL")
    assert counts(addon, traced, "Red") == dict.fromkeys(range(1, 7), 1)
    assert counts(addon, traced, "Lines") == dict.fromkeys(range(1, 7), 6)


@pytest.mark.parametrize("frame", [1, 2])
def test_new_lines_are_on_one_layer_and_on_no_line_that_has_a_stroke(addon, film, frame):
    ls.put(addon, film, "A", 1, [(ls.lines(0)[0][0], True)])
    ls.put(addon, film, "B", frame, [(ls.lines(frame - 1)[1][0], True)])
    film.data.layers.active = film.data.layers["B"]
    messages(addon)
    bpy.ops.rototoon.carry_strokes(layers="ALL", new_lines=True)
    assert all("no line" not in each for each in messages(addon))
    assert counts(addon, film, "A") == dict.fromkeys(range(1, 7), 1)
    # The drawing of the artist has the one stroke that was drawn there.
    assert counts(addon, film, "B") == {**dict.fromkeys(range(1, 7), 5), frame: 1}
    (body,) = ls.strokes(addon, film, "A", 4).values()
    assert all(away(body, points) > 5 for points in ls.strokes(addon, film, "B", 4).values())


def test_the_places_of_a_single_frame_are_held_at_a_time(addon, film, monkeypatch):
    """Those of a long film in full resolution would be gigabytes."""
    off_ink, alive, most = addon("lines.off_ink"), weakref.WeakSet(), []

    class Ink(off_ink.Ink):
        def __init__(self, *given):
            super().__init__(*given)
            alive.add(self)
            most.append(len(alive))

    monkeypatch.setattr(off_ink, "Ink", Ink)
    for name, frame in (("A", 1), ("B", 2)):
        ls.put(addon, film, name, frame, [(ls.lines(frame - 1)[0][0], True)])
    bpy.ops.rototoon.carry_strokes(layers="ALL", new_lines=True)
    assert len(most) >= 6 and max(most) <= 2


def test_what_was_moved_to_another_layer_is_not_drawn_anew_on_its_first_one(addon, traced):
    gp = addon("blender.grease_pencil")
    body = number_of(addon, traced, 0)
    ls.put(addon, traced, "Red", 1, [(ls.lines(0)[0][0], True)])
    handle, _ = gp.drawings(traced.data.layers["Lines"])[3]
    gp.remove_strokes(handle, [gp.value(handle, gp.TRACK, len(gp.offsets(handle)) - 1).tolist().index(body)])
    bpy.ops.rototoon.carry_strokes(layers="ALL")
    assert counts(addon, traced, "Red") == dict.fromkeys(range(1, 7), 1)
    assert counts(addon, traced, "Lines") == dict.fromkeys(range(1, 7), 5)


def drawn_image(line):
    """The pixels of a white picture, 160 by 120, with a level or an upright line."""
    pixels = np.ones((120, 160, 4), np.float32)
    if line == "level":
        pixels[58:61, 20:140, :3] = 0
    else:
        pixels[20:100, 78:81, :3] = 0
    return pixels.ravel()


@pytest.mark.every_version
@pytest.mark.parametrize("kind", ["file", "packed", "generated", "float"])
def test_what_was_drawn_on_an_image_is_traced_though_it_is_not_saved(addon, library, tmp_path, kind):
    image = bpy.data.images.new("picture", 160, 120, float_buffer=kind == "float")
    if kind in ("file", "packed"):
        image.pixels.foreach_set(drawn_image("level"))
        image.filepath_raw, image.file_format = str(tmp_path / "picture.png"), "PNG"
        image.save()
        bpy.data.images.remove(image)
        image = bpy.data.images.load(str(tmp_path / "picture.png"))
        if kind == "packed":
            image.pack()
    image.pixels.foreach_set(drawn_image("upright"))
    image.update()
    empty = bpy.data.objects.new("reference", None)
    empty.empty_display_type, empty.data = "IMAGE", image
    empty.rotation_euler = (np.pi / 2, 0, 0)
    bpy.context.collection.objects.link(empty)
    ob = addon("blender.grease_pencil").new_object("Drawing", bpy.context.collection)
    for each in (empty, ob):
        each.select_set(True)
    bpy.context.view_layer.objects.active = ob
    images = len(bpy.data.images)
    assert bpy.ops.rototoon.trace_image() == {"FINISHED"}
    (content,) = (addon("blender.strokes").read(handle) for handle, _ in addon("blender.grease_pencil").drawings(ob.data.layers["Lines"]).values())
    size = np.ptp(content.point["position"], axis=0)
    assert len(content.sizes) >= 1 and size[2] > 5 * size[0]
    assert image.is_dirty and len(bpy.data.images) == images


def test_the_window_is_drawn_between_the_frames_on_which_lines_are_compared(addon, film, monkeypatch):
    off_ink, run, choosing, tracing = addon("lines.off_ink"), addon("lines.run"), addon("lines.choosing"), addon("lines.tracing")
    made = []

    class Ink(off_ink.Ink):
        def __init__(self, *given):
            super().__init__(*given)
            made[-1] += 1

    monkeypatch.setattr(off_ink, "Ink", Ink)
    for name, frame in (("A", 1), ("B", 2)):
        ls.put(addon, film, name, frame, [(ls.lines(frame - 1)[0][0], True)])
    begun = run.begin(film, choosing.to_carry(film, False, True), (1, 6), run.Choices())
    begun.worker.run_here()
    made.append(0)
    for _ in tracing.finishing(film, begun.plan, begun.worker.result, begun.home):
        made.append(0)
    assert sum(made) >= 6 and max(made) == 1
