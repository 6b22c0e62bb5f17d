"""Parts that can probably not be seen on some frames: what Track, the panel and scripts say of them, and the answer that it is so."""

import json

import bpy
import layouts
import numpy as np
import pytest
import shots
import stand_in

TOLD = '"Part 1" can probably not be seen on {}'
FRAMES = [3, 4, 5, 8]


def find(monkeypatch, *frames):
    """From now on every Track finds it on these pictures; without pictures it finds nothing."""
    track = stand_in.Session.track

    def tracked(self, *given, **named):
        summary = track(self, *given, **named)
        summary.unseen = [stand_in.Unseen("Part 1", list(frames))] if frames else []
        return summary

    monkeypatch.setattr(stand_in.Session, "track", tracked)


@pytest.fixture
def shot(addon, fake, library, tmp_path, monkeypatch):
    """An object whose Track finds that its first part can probably not be seen."""
    find(monkeypatch, *FRAMES)
    return shots.two_keys(addon, tmp_path)


def lines(addon):
    """What the panel Track asks, by the number of the question; each has a button for its answer."""
    said: dict[int, list[str]] = {}
    answers = []
    for entry in layouts.draw(addon("ui.panels").ROTOTOON_PT_track):
        if entry[:2] == ("operator", "rototoon.unseen_part"):
            said.setdefault(entry[2].question, []).append(entry[2].shown)
        if entry[:2] == ("operator", "rototoon.hide_unseen"):
            answers.append(entry[2].question)
    assert answers == list(said)
    return {question: " ".join(texts) for question, texts in said.items()}


def made(addon, ob, number):
    """Frames with a generated contour of a part."""
    return sorted(addon("capture.contours").read(ob).part(number).made)


def test_track_and_the_panel_ask_and_a_click_goes_there(addon, shot):
    assert lines(addon) == {} and not bpy.ops.rototoon.unseen_part.poll() and not bpy.ops.rototoon.hide_unseen.poll()
    bpy.ops.rototoon.track()
    report = addon("scripting").take_reports()[-1]
    assert report.kind == "WARNING" and TOLD.format("3 to 5 and 8") in report.text
    assert lines(addon) == {0: TOLD.format("3 to 5 and 8")}
    bpy.context.scene.frame_set(1)
    shot.rototoon.active_part = 1
    assert bpy.ops.rototoon.unseen_part(question=0) == {"FINISHED"}
    assert (bpy.context.scene.frame_current, shot.rototoon.active_part) == (3, 0)


def test_the_answer_hides_the_part_there_and_nothing_else(addon, shot):
    bpy.ops.rototoon.track()
    before = {number: made(addon, shot, number) for number in (1, 2)}
    shot.rototoon.active_part = 1
    assert bpy.ops.rototoon.hide_unseen(question=0) == {"FINISHED"}
    assert made(addon, shot, 1) == [frame for frame in before[1] if frame not in FRAMES]
    assert made(addon, shot, 2) == before[2]
    assert addon("capture.absence").of(shot.rototoon.parts[0]) == [[3, 5], [8, 8]]
    assert lines(addon) == {} and not bpy.ops.rototoon.hide_unseen.poll(), "it is answered"
    # Somebody sees the part on one of them after all.
    bpy.context.scene.frame_set(4)
    shot.rototoon.active_part = 0
    bpy.ops.rototoon.hide_part()
    assert lines(addon) == {0: TOLD.format("4")}


def test_a_locked_layer_stays_and_keys_stay(addon, shot):
    bpy.ops.rototoon.track()
    before = made(addon, shot, 1)
    shots.layer_of(shot).lock = True
    with pytest.raises(RuntimeError, match="is locked"):
        bpy.ops.rototoon.hide_unseen()
    assert made(addon, shot, 1) == before and shot.rototoon.parts[0].extra == ""
    shots.layer_of(shot).lock = False
    key = min(addon("capture.contours").read(shot).part(1).keys)
    addon("capture.unseen").put(shot.rototoon.parts[0], [key])
    with pytest.raises(RuntimeError, match="has keys on these frames"):
        bpy.ops.rototoon.hide_unseen()


def test_frames_and_names_are_those_of_the_scene(addon, shot):
    bpy.ops.rototoon.track()
    shot.rototoon.frame_offset, shot.rototoon.parts[0].name = 100, "far arm"
    assert lines(addon) == {0: TOLD.format("103 to 105 and 108").replace("Part 1", "far arm")}
    assert addon("scripting").unseen(shot) == {"far arm": [103, 104, 105, 108]}


def test_the_file_keeps_it_until_the_next_track(addon, shot, tmp_path, monkeypatch):
    bpy.ops.rototoon.track()
    name = shot.name
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.context.view_layer.objects.active = bpy.data.objects[name]
    assert lines(addon) == {0: TOLD.format("3 to 5 and 8")}
    find(monkeypatch)
    bpy.ops.rototoon.track()
    assert lines(addon) == {}


def test_what_is_cleared_or_comes_from_a_document_asks_nothing(addon, shot, tmp_path):
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.export_document(filepath=str(tmp_path / "shot.json"))
    bpy.ops.rototoon.clear_generated()
    assert lines(addon) == {}
    bpy.ops.rototoon.track()
    assert lines(addon) != {}
    bpy.ops.rototoon.import_document(filepath=str(tmp_path / "shot.json"), into="ACTIVE", keep_numbers=True)
    assert lines(addon) == {}


def square(left, side):
    return [[left, 10.0], [left + side, 10.0], [left + side, 10.0 + side], [left, 10.0 + side]]


def behind():
    """A document in which a small part goes behind a large one on picture 2 and comes back, tracked elsewhere."""
    lefts, sure = [0.0, 22.0, 24.0, 56.0], [1.0, 0.1, 0.1, 1.0]
    small = {
        "name": "small",
        "closed": True,
        "keys": {"0": square(0.0, 6.0), "3": square(56.0, 6.0)},
        "tracks": {str(k): square(left, 6.0) for k, left in enumerate(lefts)},
        "confidence": {str(k): [one] * 4 for k, one in enumerate(sure)},
    }
    large = {"name": "large", "closed": True, "depth": 1.0, "keys": {"0": square(16.0, 34.0), "3": square(16.0, 34.0)}}
    large |= {"tracks": {str(k): square(16.0, 34.0) for k in range(4)}, "confidence": {str(k): [1.0] * 4 for k in range(4)}}
    footage = {"pattern": "f_%d.png", "first": 0, "last": 3, "fps": 12, "width": 64, "height": 48}
    return {"rototoon": 1, "footage": footage, "parts": [small, large]}


def test_a_document_that_was_tracked_elsewhere_is_asked_too(addon, library, tmp_path):
    for picture in range(4):
        shots.write_png(tmp_path / f"f_{picture}.png", np.full((48, 64, 3), 255, np.uint8))
    (tmp_path / "shot.json").write_text(json.dumps(behind()), encoding="utf-8")
    bpy.ops.rototoon.import_document(filepath=str(tmp_path / "shot.json"), keep_numbers=True)
    ob = bpy.context.object
    pictures = addon("capture.unseen").stored(ob.rototoon.parts[0])
    assert pictures == [1, 2] and addon("capture.unseen").stored(ob.rototoon.parts[1]) == []
    offset = ob.rototoon.frame_offset
    assert addon("scripting").unseen(ob) == {"small": [1 + offset, 2 + offset]}


@pytest.mark.parametrize("kept", ["{", "3", '["x"]', "[3.5]", "[true]", "null", '{"a": 1}'])
def test_what_cannot_be_read_counts_as_missing(addon, shot, kept):
    bpy.ops.rototoon.track()
    shot.rototoon.parts[0].unseen = kept
    assert addon("capture.unseen").questions(shot) == [] and lines(addon) == {}


def test_scripts_get_it_and_many_parts_are_counted(addon, shot):
    found = addon("scripting").track(shot)
    assert TOLD.format("3 to 5 and 8") + ": if so, hide it there" in found.warnings
    unseen, parts = addon("capture.unseen"), shot.rototoon.parts
    while len(parts) < 6:
        parts.add().name = f"Part {len(parts)}"
    for part in parts:
        unseen.put(part, [4])
    assert len(unseen.told(shot)) == 4 and unseen.told(shot)[3] == "3 more parts that can probably not be seen, in the panel Track"
