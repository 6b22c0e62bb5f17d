"""Parts that look alike and may have changed places: what Track, the panel and scripts say of them, and the way to them."""

import bpy
import layouts
import pytest
import shots
import stand_in

TOLD = 'parts "Part 1" and "Part 2" look alike and may have changed places on {}: a key or a pin there says which is which'
FRAMES = [3, 4, 5, 8]


def find(monkeypatch, *frames):
    """From now on every Track finds it on these pictures; without pictures it finds nothing."""
    track = stand_in.Session.track

    def tracked(self, *given, **named):
        summary = track(self, *given, **named)
        summary.exchanges = [stand_in.Exchange(("Part 1", "Part 2"), list(frames))] if frames else []
        return summary

    monkeypatch.setattr(stand_in.Session, "track", tracked)


@pytest.fixture
def shot(addon, fake, library, tmp_path, monkeypatch):
    """An object whose Track finds that its parts may have changed places."""
    find(monkeypatch, *FRAMES)
    return shots.two_keys(addon, tmp_path)


def lines(addon):
    """What the panel Track says, by the number of the pair to which a click goes."""
    said: dict[int, list[str]] = {}
    for entry in layouts.draw(addon("ui.panels").ROTOTOON_PT_track):
        if entry[:2] == ("operator", "rototoon.exchanged_parts"):
            said.setdefault(entry[2].pair, []).append(entry[2].shown)
    return {pair: " ".join(texts) for pair, texts in said.items()}


def test_track_and_the_panel_say_it_and_a_click_goes_there(addon, shot):
    assert lines(addon) == {} and not bpy.ops.rototoon.exchanged_parts.poll()
    bpy.ops.rototoon.track()
    report = addon("scripting").take_reports()[-1]
    assert report.kind == "WARNING" and TOLD.format("3-5, 8") in report.text
    assert lines(addon) == {0: TOLD.format("3-5, 8")}
    bpy.context.scene.frame_set(1)
    assert bpy.ops.rototoon.exchanged_parts(pair=0) == {"FINISHED"}
    assert bpy.context.scene.frame_current == 3
    assert TOLD.format("3-5, 8") in addon("scripting").take_reports()[-1].text


def test_frames_and_names_are_those_of_the_scene(addon, shot):
    bpy.ops.rototoon.track()
    shot.rototoon.frame_offset, shot.rototoon.parts[1].name = 100, "far leg"
    assert lines(addon) == {0: TOLD.format("103-105, 108").replace("Part 2", "far leg")}
    shot.rototoon.parts.remove(0)
    assert lines(addon) == {}


def test_the_file_keeps_it_until_the_next_track(addon, shot, tmp_path, monkeypatch):
    bpy.ops.rototoon.track()
    name = shot.name
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.context.view_layer.objects.active = bpy.data.objects[name]
    assert lines(addon) == {0: TOLD.format("3-5, 8")}
    find(monkeypatch)
    bpy.ops.rototoon.track()
    assert lines(addon) == {}


def test_what_is_cleared_or_comes_from_a_document_has_changed_no_places(addon, shot, tmp_path):
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.export_document(filepath=str(tmp_path / "shot.json"))
    bpy.ops.rototoon.clear_generated()
    assert not shot.rototoon.exchanges
    bpy.ops.rototoon.track()
    assert shot.rototoon.exchanges
    bpy.ops.rototoon.import_document(filepath=str(tmp_path / "shot.json"), into="ACTIVE", keep_numbers=True)
    assert not shot.rototoon.exchanges


def test_scripts_get_it_too(addon, shot):
    scripting = addon("scripting")
    found = scripting.track(shot)
    assert TOLD.format("3-5, 8") in found.warnings
    assert scripting.exchanges(shot) == [scripting.Exchange(("Part 1", "Part 2"), (3, 4, 5, 8))]


@pytest.mark.parametrize("kept", ["{", "[1]", "[[1, 2]]", '[[1, 2, "x"]]', '[[1, 2, [3, "x"]]]', "[[1, 2, []]]", '"x"', "null", "[[1, 9, [3]]]"])
def test_what_cannot_be_read_counts_as_missing(addon, shot, kept):
    bpy.ops.rototoon.track()
    shot.rototoon.exchanges = kept
    assert addon("capture.exchanged").of(shot) == [] and lines(addon) == {}


def test_many_pairs_are_counted_in_the_message(addon, shot):
    bpy.ops.rototoon.track()
    exchanged = addon("capture.exchanged")
    exchanged.put(shot, [(1, 2, [frame]) for frame in range(2, 8)])
    assert exchanged.told(shot)[2:] == [TOLD.format(4), "3 more pairs that may have changed places, in the panel Track"]
    assert len(lines(addon)) == 6
