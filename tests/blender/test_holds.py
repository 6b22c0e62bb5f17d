"""Frames that hold a drawing: in Blender one key, in a document what every frame shows."""

import json

import bpy
import line_shots as ls
import pytest
from line_stage import film, pictures  # noqa: F401 - fixtures
from line_stage import kinds, said
from test_drawings_in_documents import exported, imported, line, taken
from test_files import close

KEY, MADE = "KEYFRAME", "GENERATED"


def on_twos(**changed):
    """Six traced frames, each drawing on two of them. `changed` are fields of the stroke on frame 4."""
    strokes = {frame: [line(0, (frame - 1) // 2, track=0), line(4, (frame - 1) // 2, track=1)] for frame in range(1, 7)}
    strokes[4][1] |= changed
    return [{"frame": frame, "strokes": own} for frame, own in strokes.items()]


def regions(frame, **changed):
    """Two painted regions of a drawing on twos."""
    x = 10.0 * ((frame - 1) // 2)
    square = [[20.0 + x, 20.0], [60.0 + x, 20.0], [60.0 + x, 60.0], [20.0 + x, 60.0]]
    hole = [[30.0 + x, 30.0], [40.0 + x, 30.0], [40.0 + x, 40.0]]
    one = {"outline": square, "holes": [hole], "colour": [0.2, 0.4, 0.9], "track": 0, "confidence": 0.9}
    return {"frame": frame, "regions": [one | changed]}


def test_held_drawings_come_in_as_one_key(addon, film, fake, pictures, tmp_path):  # noqa: F811
    ob = taken(tmp_path / "twos.json", pictures, traced=on_twos(), filled=[regions(frame) for frame in range(1, 7)])
    assert kinds(addon, ob, "Lines") == kinds(addon, ob, "Paint") == dict.fromkeys((1, 3, 5), MADE)
    assert "2 traced strokes" in said(addon).text


@pytest.mark.parametrize("changed", [{"confidence": 0.1}, {"closed": True}, {"colour": [0.9, 0.1, 0.1]}, {"track": 5}, {"widths": []}])
def test_any_difference_is_a_drawing_of_its_own(addon, film, pictures, tmp_path, changed):  # noqa: F811
    ob = taken(tmp_path / "twos.json", pictures, traced=on_twos(**changed))
    assert list(kinds(addon, ob, "Lines")) == [1, 3, 4, 5]


@pytest.mark.parametrize("changed", [{"confidence": 0.2}, {"holes": []}, {"colour": [0.9, 0.1, 0.1]}, {"track": 5}])
def test_any_difference_of_paint_is_a_drawing_of_its_own(addon, film, pictures, tmp_path, changed):  # noqa: F811
    filled = [regions(frame, **(changed if frame == 4 else {})) for frame in range(1, 7)]
    ob = taken(tmp_path / "twos.json", pictures, filled=filled)
    assert list(kinds(addon, ob, "Paint")) == [1, 3, 4, 5]


def test_a_click_on_a_held_frame_is_a_drawing_of_its_own(addon, film, pictures, tmp_path):  # noqa: F811
    fills = [{"frame": 2, "regions": [{"at": [50.0, 50.0], "colour": [0.2, 0.4, 0.9]}]}]
    ob = taken(tmp_path / "twos.json", pictures, fills=fills, filled=[regions(frame) for frame in range(1, 7)])
    assert kinds(addon, ob, "Paint") == {1: MADE, 2: KEY, 3: MADE, 5: MADE}


def test_every_frame_goes_out_again(addon, film, pictures, tmp_path):  # noqa: F811
    fields = {"traced": on_twos(), "filled": [regions(frame) for frame in range(1, 7)]}
    taken(tmp_path / "twos.json", pictures, **fields)
    out = exported(tmp_path / "out.json")
    for name in ("traced", "filled"):
        assert [each["frame"] for each in out[name]] == list(range(1, 7))
    for asked, got in zip(fields["traced"], out["traced"], strict=True):
        close([stroke["points"] for stroke in asked["strokes"]], [stroke["points"] for stroke in got["strokes"]], 0.01)
    assert said(addon).text == "traced lines of 6 frames and paint of 6 frames in out.json"
    ob = imported(tmp_path / "out.json")
    assert list(kinds(addon, ob, "Lines")) == list(kinds(addon, ob, "Paint")) == [1, 3, 5]


def test_a_held_frame_that_a_key_covers_or_that_is_cleared_is_not_written(addon, film, fake, pictures, tmp_path):  # noqa: F811
    ob = taken(tmp_path / "twos.json", pictures, traced=on_twos())
    ls.put(addon, ob, "Lines", 2, [(ls.lines(0)[4][0], False)])
    assert [each["frame"] for each in exported(tmp_path / "key.json")["traced"]] == [1, 3, 4, 5, 6]
    bpy.ops.rototoon.clear_lines()
    assert "traced" not in exported(tmp_path / "cleared.json") and "rototoon_holds" not in ob.data


def test_paint_that_is_cleared_is_not_held(addon, film, pictures, tmp_path):  # noqa: F811
    fills = [{"frame": 1, "regions": [{"at": [50.0, 50.0], "colour": [0.2, 0.4, 0.9]}]}]
    ob = taken(tmp_path / "twos.json", pictures, fills=fills, filled=[regions(frame) for frame in range(1, 7)])
    assert [each["frame"] for each in exported(tmp_path / "painted.json")["filled"]] == list(range(1, 7))
    assert kinds(addon, ob, "Paint") == {1: KEY, 3: MADE, 5: MADE}
    bpy.ops.rototoon.clear_fills()
    assert list(kinds(addon, ob, "Paint")) == [1] and "rototoon_holds" not in ob.data
    assert [each["frame"] for each in exported(tmp_path / "cleared.json")["filled"]] == [1]


def test_drawings_that_blender_holds_go_out_on_every_frame(addon, film, fake, pictures, tmp_path):  # noqa: F811
    import shutil

    for number, source in enumerate((1, 1, 2, 3, 3, 3), 1):
        shutil.copy(pictures.with_name(f"line_{source:03}.png"), tmp_path / f"line_{number:03}.png")
    film.rototoon.pattern = str(tmp_path / "line_%03d.png")
    bpy.ops.rototoon.trace_drawing()
    assert list(kinds(addon, film, "Lines")) == [1, 3, 4]
    out = exported(tmp_path / "out.json")["traced"]
    assert [each["frame"] for each in out] == list(range(1, 7)) and out[3]["strokes"] == out[5]["strokes"] != out[0]["strokes"]
    bpy.ops.rototoon.trace_drawing(hold=False)
    assert json.loads(film.data.get("rototoon_holds", "{}")) == {}


def test_a_held_drawing_under_a_moving_camera_is_drawn_on_each_frame(addon, film, pictures, tmp_path):  # noqa: F811
    ob = taken(tmp_path / "twos.json", pictures, traced=on_twos())
    bpy.context.scene.camera.keyframe_insert("location", frame=1)
    imported(tmp_path / "twos.json", into="ACTIVE")
    assert list(kinds(addon, ob, "Lines")) == list(range(1, 7))
