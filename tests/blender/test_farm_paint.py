"""Send to Farm and Collect Results with paint, on the small line film, by the command line program."""

import json
import subprocess

import bpy
import line_shots as ls
import numpy as np
import pytest
import shots
import test_farm
from line_stage import film, pictures  # noqa: F401 - fixtures
from line_stage import handle_of, kinds, said
from test_paint import EYE, GREEN, LAYER, click, clicked, colour_at, places  # noqa: F401 - a fixture


def send_all(tmp_path, **options):
    """Saves the file and sends it."""
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "film.blend"))
    assert bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm"), **options) == {"FINISHED"}


def send(tmp_path, **options):
    send_all(tmp_path, **options)
    (shot,) = json.loads((tmp_path / "farm/manifest.json").read_text())["shots"]
    return shot, json.loads((tmp_path / "farm" / shot["project"]).read_text())


def work(tmp_path):
    words = [test_farm.program(), "batch", "manifest.json", "-o", "results", "--jobs", "1"]
    done = subprocess.run([str(word) for word in words], cwd=tmp_path / "farm", capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def collect(tmp_path):
    return bpy.ops.rototoon.collect_results(directory=str(tmp_path / "farm"))


def painted(addon, ob):
    """By frame the kind of the drawing, and of each stroke the number, the points and whether it is generated."""
    gp, found = addon("blender.grease_pencil"), {}
    for frame, kind in kinds(addon, ob, LAYER).items():
        content = addon("blender.strokes").read(handle_of(addon, ob, LAYER, frame))
        rows = zip(content.strokes(gp.TRACK).tolist(), np.split(content.point["position"], content.starts[1:-1]), content.strokes(gp.MADE))
        found[frame] = kind, {number: (points, bool(made)) for number, points, made in rows}
    return found


def equal(one, other):
    assert one.keys() == other.keys()
    for frame, (kind, strokes) in one.items():
        assert kind == other[frame][0] and strokes.keys() == other[frame][1].keys()
        for number, (points, made) in strokes.items():
            assert made == other[frame][1][number][1] and np.allclose(points, other[frame][1][number][0], atol=1e-4)


def test_paint_goes_there_and_back(addon, clicked, tmp_path):  # noqa: F811
    clicked.rototoon.fill_confidence = 0.25
    before = shots.snapshot(clicked)
    shot, document = send(tmp_path)
    assert shot["steps"] == [{"do": "check"}, {"do": "fill", "sensitivity": 1.0, "confidence": 0.25}]
    assert document["parts"] == [] and "filled" not in document
    assert [len(each["regions"]) for each in document["fills"]] == [4]
    assert shots.snapshot(clicked) == before, "sending changes nothing"
    work(tmp_path)
    collect(tmp_path)
    assert said(addon).text == "24 painted regions taken into 1 object"
    for frame in range(1, 7):
        for place, colour in places(frame):
            assert colour_at(addon, clicked, frame, place) == pytest.approx(colour, abs=1e-3), frame
    taken = painted(addon, clicked)
    collect(tmp_path)
    equal(painted(addon, clicked), taken)
    bpy.ops.rototoon.clear_fills()
    bpy.ops.rototoon.fill_drawings()
    equal(painted(addon, clicked), taken)


def test_paint_that_was_changed_meanwhile_stays(addon, clicked, tmp_path):  # noqa: F811
    send(tmp_path)
    work(tmp_path)
    bpy.context.scene.frame_set(4)
    click(clicked, places(4)[2][0], GREEN)
    before = shots.snapshot(clicked)
    with pytest.raises(RuntimeError, match="Nothing was taken.*its shapes were changed since they were sent.*press Fill Drawings"):
        collect(tmp_path)
    bpy.ops.rototoon.clear_fills()
    assert shots.snapshot(clicked) == before
    gp = addon("blender.grease_pencil")
    gp.remove_frames(gp.find_layer(clicked, LAYER), [4])
    gp.find_layer(clicked, LAYER).lock = True
    with pytest.raises(RuntimeError, match=f'the layer "{LAYER}" is locked'):
        collect(tmp_path)
    gp.find_layer(clicked, LAYER).lock = False
    collect(tmp_path)
    assert colour_at(addon, clicked, 4, places(4)[2][0]) == pytest.approx(EYE, abs=1e-3)


def test_colours_that_become_others_go_there_and_back(addon, clicked, tmp_path):  # noqa: F811
    bpy.context.scene.frame_set(4)
    bpy.ops.rototoon.recolour(old="Paint edc29e", colour=GREEN)
    _, document = send(tmp_path)
    assert [own["first"] for own in document["recolours"]] == [document["footage"]["first"] + 3]
    work(tmp_path)
    collect(tmp_path)
    for frame in range(1, 7):
        expected = GREEN if frame >= 4 else places(frame)[1][1]
        assert colour_at(addon, clicked, frame, places(frame)[1][0]) == pytest.approx(expected, abs=3e-3), frame
    bpy.ops.rototoon.remove_recolour(place=0)
    with pytest.raises(RuntimeError, match="recolours were changed since they were sent"):
        collect(tmp_path)


def test_contours_and_paint_go_together(addon, clicked, tmp_path):  # noqa: F811
    for frame in (1, 6):
        shots.draw(addon, clicked, frame, [ls.lines(frame - 1)[0][0][:-1:8]])
    clicked.data.update_tag()
    bpy.context.scene.frame_set(6)
    bpy.ops.rototoon.match_contours()
    shot, document = send(tmp_path, engine="NONE")
    assert [step["do"] for step in shot["steps"]] == ["check", "track", "fill"]
    assert len(document["parts"]) == 1 and len(document["fills"]) == 1
    work(tmp_path)
    click(clicked, places(6)[2][0], GREEN)
    collect(tmp_path)
    report = said(addon).text
    assert report.startswith("4 contours taken into 1 object") and "its shapes were changed" in report
    addon("blender.grease_pencil").remove_frames(clicked.data.layers[LAYER], [6])
    collect(tmp_path)
    assert said(addon).text == "4 contours and 24 painted regions taken into 1 object"


def test_shapes_that_cannot_be_sent_are_named(addon, film, tmp_path):  # noqa: F811
    ls.put(addon, film, LAYER, 1, [(np.array([(10.0, 10.0), (30.0, 10.0), (30.0, 30.0)]), False)])
    with pytest.raises(RuntimeError, match='Nothing to send; .*Draw contours.*; .*its paint: The strokes on the layer "Paint" have no fill'):
        send(tmp_path)
