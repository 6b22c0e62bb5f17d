"""Strokes that may be another stroke: kept in the file, listed, marked, and gone to one after the other."""

import json

import bpy
import line_shots as ls
import numpy as np
import pytest
from line_stage import film, pictures  # noqa: F401 - fixtures
from line_stage import attribute, handle_of, kinds, said


@pytest.fixture
def doubted(addon, film, fake, monkeypatch):
    """The film, traced: on the third picture stroke 2 is doubtful, on the fifth stroke 1 is lost and stroke 2 doubtful."""
    tracer_trace = fake.Tracer.trace

    def unsure(self, *args, **options):
        found = tracer_trace(self, *args, **options)
        for place, stroke, value in ((2, 1, 0.7), (4, 0, 0.2), (4, 1, 0.6)) if len(found.frames) > 1 else ():
            found.confidence[found.stroke_offsets[place] + stroke] = value
        return found

    monkeypatch.setattr(fake.Tracer, "trace", unsure)
    assert bpy.ops.rototoon.trace_drawing() == {"FINISHED"}
    return bpy.context.object


DOUBTS = ["Stroke 1: lost on 5", "Stroke 2: doubtful on 3 and 5"]


def listed(addon, ob=None):
    return [str(doubt) for doubt in addon("scripting").doubtful_lines(ob or bpy.context.object)]


def test_doubtful_strokes_are_said_and_listed(addon, doubted):
    assert said(addon).warnings == ("2 strokes are in doubt, 1 of them probably wrong: press Next Doubtful Stroke",)
    assert listed(addon) == DOUBTS
    found = addon("scripting").lines(doubted)
    assert [line.confidence for line in found[5]] == pytest.approx([0.2, 0.6]) and [line.confidence for line in found[4]] == [1, 1]


def test_they_survive_saving_and_loading(addon, doubted, tmp_path):
    path = str(tmp_path / "doubts.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert listed(addon) == DOUBTS


def test_one_goes_from_one_to_the_next(addon, doubted):
    scene, settings, gp = bpy.context.scene, doubted.rototoon, addon("blender.grease_pencil")
    scene.frame_set(1)
    went = []
    for _ in range(4):
        assert bpy.ops.rototoon.next_doubt() == {"FINISHED"}
        went.append((scene.frame_current, settings.doubt_number))
        handle = handle_of(addon, doubted, "Lines", scene.frame_current)
        tracks = attribute(addon, doubted, "Lines", scene.frame_current, gp.TRACK)
        assert tracks[addon("blender.selection").selected_strokes(handle)].tolist() == [settings.doubt_number]
    assert went == [(3, 2), (5, 1), (5, 2), (3, 2)], "after the last one comes the first"
    assert said(addon).text.startswith("Stroke 2 may be another stroke on frame 3")
    bpy.ops.rototoon.next_doubt(layer="Lines", number=1)
    assert scene.frame_current == 5 and said(addon).text.startswith("Stroke 1 is probably another stroke on frame 5")
    scene.frame_set(4)
    bpy.ops.rototoon.next_doubt()
    assert (scene.frame_current, settings.doubt_number) == (5, 1), "it goes on from the frame that is shown"


def test_they_are_marked_until_the_artist_changes_the_drawing(addon, doubted):
    gp, doubts, overlay = addon("blender.grease_pencil"), addon("ui.doubts"), addon("ui.overlay")
    assert doubts.marked(doubted, 4) == [] and overlay.doubtful(doubted, 4) == []
    marked = doubts.marked(doubted, 5)
    assert [mark.lost for mark in marked] == [True, False] and all(mark.points.shape[1] == 3 for mark in marked)
    bpy.context.scene.frame_set(4)
    bpy.ops.rototoon.next_doubt()
    groups = overlay.doubtful(doubted, 5)
    assert [(len(lines), colour == overlay.LOST_COLOUR, width) for lines, colour, width in groups] == [
        (1, False, overlay.LOST_WIDTH),
        (1, True, 2 * overlay.LOST_WIDTH),
    ], "the lost one is on top, and the one that was gone to is wider"
    handle = handle_of(addon, doubted, "Lines", 5)
    starts = gp.offsets(handle)
    points = gp.positions(handle, int(starts[-1]))
    points[: starts[1], 2] += 0.01
    gp.put(handle, "position", points)
    assert [mark.lost for mark in doubts.marked(doubted, 5)] == [False]
    assert listed(addon) == ["Stroke 2: doubtful on 3"], "the changed drawing is the artist's"


def test_a_drawing_that_becomes_a_key_is_beyond_doubt(addon, doubted):
    gp = addon("blender.grease_pencil")
    handle = handle_of(addon, doubted, "Lines", 5)
    points = gp.positions(handle, int(gp.offsets(handle)[-1]))
    gp.put(handle, "position", points + np.float32([0, 0, 0.01]))
    assert bpy.ops.rototoon.carry_strokes() == {"FINISHED"}
    assert (attribute(addon, doubted, "Lines", 5, gp.CONFIDENCE) == 1).all()


def test_documents_keep_them(addon, doubted, tmp_path):
    path = tmp_path / "doubts.json"
    # A document needs a contour.
    bpy.ops.rototoon.make_part(numbers="2")
    bpy.ops.rototoon.export_document(filepath=str(path))
    document = json.loads(path.read_text())
    sure = [[stroke.get("confidence") for stroke in each["strokes"]] for each in document["traced"]]
    assert sure == [[None, None], [None, None], [None, 0.7], [None, None], [0.2, 0.6], [None, None]]
    bpy.ops.rototoon.import_document(filepath=str(path))
    assert bpy.context.object != doubted and listed(addon) == DOUBTS
    document["traced"][2]["strokes"][1]["confidence"] = 2
    path.write_text(json.dumps(document))
    with pytest.raises(RuntimeError, match=r"traced\[2\].strokes\[1\].confidence: found [^,]+, expected a number from 0 to 1"):
        bpy.ops.rototoon.import_document(filepath=str(path))


def test_without_doubt_nothing_is_marked(addon, film, fake):
    assert not bpy.ops.rototoon.next_doubt.poll(), "nothing is traced yet"
    bpy.ops.rototoon.trace_drawing()
    gp = addon("blender.grease_pencil")
    assert said(addon).warnings == () and listed(addon) == []
    assert not gp.has(handle_of(addon, film, "Lines", 5), gp.CONFIDENCE), "no values are kept for strokes beyond doubt"
    assert bpy.ops.rototoon.next_doubt() == {"FINISHED"} and said(addon).text == "No stroke is in doubt"


def test_a_stroke_that_is_right_is_accepted(addon, doubted):
    gp = addon("blender.grease_pencil")
    for _ in range(2):
        bpy.ops.rototoon.next_doubt()
    assert bpy.context.scene.frame_current == 5
    assert bpy.ops.rototoon.accept_doubt() == {"FINISHED"}
    assert said(addon).text == "Stroke 1 is accepted on frame 5. 1 stroke still in doubt"
    assert listed(addon) == ["Stroke 2: doubtful on 3 and 5"] and kinds(addon, doubted, "Lines")[5] == gp.GENERATED
    assert [mark.lost for mark in addon("ui.doubts").marked(doubted, 5)] == [False]
    bpy.ops.rototoon.next_doubt()
    assert bpy.ops.rototoon.accept_doubt() == {"FINISHED"}
    assert said(addon).text == "Stroke 2 is accepted on frame 5, and the drawing is yours now. 1 stroke still in doubt"
    assert kinds(addon, doubted, "Lines")[5] == gp.KEYFRAME and listed(addon) == ["Stroke 2: doubtful on 3"]
    before = ls.strokes(addon, doubted, "Lines", 5)
    assert bpy.ops.rototoon.trace_drawing() == {"FINISHED"}
    after = ls.strokes(addon, doubted, "Lines", 5)
    assert list(after) == list(before) and all(np.array_equal(after[number], before[number]) for number in before)
    assert not any(" 5" in each for each in listed(addon)), "it stays accepted"


def test_all_strokes_of_a_frame_are_accepted_at_once_and_undone(addon, doubted):
    bpy.ops.ed.undo_push(message="before")
    bpy.context.scene.frame_set(5)
    with pytest.raises(RuntimeError, match="2 strokes are in doubt on this frame: press Next Doubtful Stroke"):
        bpy.ops.rototoon.accept_doubt()
    assert bpy.ops.rototoon.accept_doubt("EXEC_DEFAULT", True, every=True) == {"FINISHED"}
    assert said(addon).text == "2 strokes are accepted on frame 5, and the drawing is yours now. 1 stroke still in doubt"
    assert listed(addon) == ["Stroke 2: doubtful on 3"]
    bpy.ops.ed.undo()
    assert listed(addon) == DOUBTS


def test_the_only_doubtful_stroke_of_a_frame_is_meant(addon, doubted):
    bpy.context.scene.frame_set(3)
    assert bpy.ops.rototoon.accept_doubt() == {"FINISHED"}
    assert listed(addon) == ["Stroke 1: lost on 5", "Stroke 2: doubtful on 5"]
    bpy.context.scene.frame_set(2)
    with pytest.raises(RuntimeError, match="No stroke is in doubt on this frame"):
        bpy.ops.rototoon.accept_doubt()


@pytest.mark.parametrize("how", ["lock", "hide"])
def test_strokes_on_closed_layers_are_not_accepted(addon, doubted, how):
    setattr(doubted.data.layers["Lines"], how, True)
    bpy.context.scene.frame_set(3)
    for every in (False, True):
        with pytest.raises(RuntimeError, match='the layer "Lines" is'):
            bpy.ops.rototoon.accept_doubt(every=every)
    assert listed(addon) == DOUBTS


def test_scripts_accept_strokes(addon, doubted):
    scripting = addon("scripting")
    assert scripting.accept_lines(doubted, 5, [1]) == (1,)
    assert listed(addon) == ["Stroke 2: doubtful on 3 and 5"]
    assert scripting.accept_lines(doubted, 3) == (2,) and scripting.accept_lines(doubted, 3) == ()
    with pytest.raises(RuntimeError, match='numbers: stroke 1 is not in doubt on frame 5 of the layer "Lines"'):
        scripting.accept_lines(doubted, 5, [1, 2])
    assert listed(addon) == ["Stroke 2: doubtful on 5"]
