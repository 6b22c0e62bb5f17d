"""What the artist draws in a second window while long work runs in the first one. With the real library."""

import bpy
import pytest
import shots
from test_strokes import add, circle, content, drawing_object, wave
from test_tween import figure, frames, keyed, move

pytestmark = pytest.mark.usefixtures("library")


@pytest.fixture
def meanwhile(addon, monkeypatch):
    """Does something between the work of an operator and its writing."""

    def do(module, operator, what):
        cls = getattr(addon(module), operator)
        finish = cls.finish
        monkeypatch.setattr(cls, "finish", lambda self, context, work: (what(), finish(self, context, work))[1])

    return do


def sizes(addon, ob, frame, layer="Lines"):
    return content(addon, ob, layer, frame).sizes.tolist()


def test_fit_strokes_leaves_what_was_drawn_meanwhile(addon, meanwhile):
    ob = drawing_object(addon)
    add(addon, ob, "Lines", 1, [wave(200)])
    meanwhile("strokes.operators.fit_strokes", "ROTOTOON_OT_fit_strokes", lambda: add(addon, ob, "Lines", 1, [circle((3, 3), 1.0)]))
    with pytest.raises(RuntimeError, match='frame 1 of the layer "Lines" was changed during the work'):
        bpy.ops.rototoon.fit_strokes(unit="WORLD", tolerance=0.01, frames="ALL")
    assert sizes(addon, ob, 1) == [200, 64]


@pytest.mark.every_version
def test_an_object_that_is_deleted_meanwhile_is_told_of(addon, meanwhile):
    ob = drawing_object(addon)
    add(addon, ob, "Lines", 1, [wave(200)])
    meanwhile("strokes.operators.fit_strokes", "ROTOTOON_OT_fit_strokes", lambda: bpy.data.objects.remove(ob))
    with pytest.raises(RuntimeError, match="What this works on was deleted meanwhile"):
        bpy.ops.rototoon.fit_strokes(unit="WORLD", tolerance=0.01, frames="ALL")


@pytest.mark.parametrize("drawn", ["on it", "on a new frame"])
def test_hidden_lines_leave_what_was_drawn_meanwhile(addon, meanwhile, drawn):
    ob = drawing_object(addon, ("Lines", "Cover"))
    add(addon, ob, "Lines", 1, [[(-2, 0), (2, 0)]])
    add(addon, ob, "Cover", 1, [circle((9, 9), 0.5)], cyclic=True)
    add(addon, ob, "Cover", 3, [circle((0, 0), 0.5)], cyclic=True)
    bpy.context.scene.frame_end = 4
    frame = 1 if drawn == "on it" else 3
    meanwhile("strokes.operators.hidden_lines", "ROTOTOON_OT_hidden_lines", lambda: add(addon, ob, "Lines", frame, [circle((3, 3), 1.0)]))
    with pytest.raises(RuntimeError, match=f'frame {frame} of the layer "Lines" was changed during the work'):
        bpy.ops.rototoon.hidden_lines(covers="CLOSED", frames="RANGE")
    assert sizes(addon, ob, 1) == ([2, 64] if frame == 1 else [2]) and 64 in sizes(addon, ob, frame)


def new_key(addon, ob):
    addon("blender.grease_pencil").remove_frames(ob.data.layers["Lines"], [5])
    add(addon, ob, "Lines", 5, figure(0.1, 0.1))


def key_gone(addon, ob):
    addon("blender.grease_pencil").remove_frames(ob.data.layers["Lines"], [9])


def redrawn(addon, ob):
    add(addon, ob, "Lines", 9, [circle((3, 3), 1.0)])


def layer_gone(_addon, ob):
    ob.data.layers["Lines"].name = "Other"


@pytest.mark.parametrize(("change", "named"), [(new_key, "frame 5"), (key_gone, "frame 9"), (redrawn, "frame 9"), (layer_gone, 'The layer "Lines"')])
def test_in_between_leaves_what_was_drawn_meanwhile(addon, meanwhile, change, named):
    ob = keyed(addon, (1, 9))
    bpy.ops.rototoon.in_between(spacing="LINEAR")
    move(addon, ob, 9, by=0.3)
    seen = {}

    def what():
        change(addon, ob)
        seen.update(frames(addon, ob, ob.data.layers[0].name))

    meanwhile("tween.operators.in_between", "ROTOTOON_OT_in_between", what)
    with pytest.raises(RuntimeError, match=f"{named}.* was changed during the work"):
        bpy.ops.rototoon.in_between(spacing="LINEAR", frames="ALL")
    assert frames(addon, ob, ob.data.layers[0].name) == seen and len(seen) >= 8


def test_a_key_far_from_the_work_is_no_matter(addon, meanwhile):
    ob = keyed(addon, (1, 9, 17))
    meanwhile("tween.operators.in_between", "ROTOTOON_OT_in_between", lambda: add(addon, ob, "Lines", 13, figure(0.1, 0.1)))
    bpy.context.scene.frame_set(3)
    bpy.ops.rototoon.in_between(spacing="LINEAR", frames="CURRENT")
    assert list(frames(addon, ob)) == [*range(1, 10), 13, 17]


@pytest.mark.parametrize("source", ["file", "camera", "reference"])
def test_footage_goes_to_the_object_that_was_active_at_the_beginning(addon, meanwhile, tmp_path, source):
    ob = shots.set_up(tmp_path, plane="REFERENCE" if source == "reference" else "CAMERA")
    other = drawing_object(addon)
    other.rototoon.pattern = "/other/%04d.png"
    if source == "reference":
        ob.rototoon.reference.select_set(True)
    ob.rototoon.pattern, bpy.context.view_layer.objects.active = "", ob
    name = f"footage_from_{source}"
    meanwhile(f"capture.operators.{name}", f"ROTOTOON_OT_{name}", lambda: setattr(bpy.context.view_layer.objects, "active", other))
    given = {"filepath": str(tmp_path / "frames/shot_003.png")} if source == "file" else {}
    assert getattr(bpy.ops.rototoon, name)(**given) == {"FINISHED"}
    assert ob.rototoon.pattern.endswith("shot_%03d.png") and other.rototoon.pattern == "/other/%04d.png"
