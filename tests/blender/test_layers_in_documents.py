"""All layers of lines as one document: traced strokes stay traced, and the strokes of every layer come back."""

import json

import bpy
import line_shots as ls
import numpy as np
import pytest
from line_stage import film, pictures, traced  # noqa: F401 - fixtures
from line_stage import handle_of, kinds, said
from test_drawings_in_documents import KEY, MADE, exported, imported, moved, tweened

FRAMES = range(1, ls.COUNT + 1)


def all_layers(path):
    """The document of all layers of the active object."""
    assert bpy.ops.rototoon.export_document(filepath=str(path), layers="ALL") == {"FINISHED"}
    return json.loads(path.read_text())


def frames_of(document):
    return {name: [each["frame"] for each in document[name]] for name in ("drawings", "traced", "in_betweens") if name in document}


def traced_too(ob, name="Other"):
    """Traces the film on another layer as well, so that both have strokes of the same numbers."""
    ob.rototoon.lines_layer = name
    assert bpy.ops.rototoon.trace_drawing() == {"FINISHED"}
    ob.rototoon.lines_layer = "Lines"


def shown(addon, ob, layers, frame):
    """The strokes of layers on a frame, from back to front."""
    return [points for layer in layers for points in ls.strokes(addon, ob, layer, frame).values()]


def same_places(one, other):
    return len(one) == len(other) and all(np.allclose(a, b, atol=1e-3) for a, b in zip(one, other))


def is_numbered_well(document):
    """Whether a frame has each number once, and a number is the same line on all frames: it moves little."""
    places = {}
    for drawing in document["traced"]:
        tracks = [stroke["track"] for stroke in drawing["strokes"]]
        if len(set(tracks)) < len(tracks):
            return False
        for stroke in drawing["strokes"]:
            places.setdefault(stroke["track"], []).append(np.mean(stroke["points"], axis=0))
    return all(np.linalg.norm(b - a) < 15 for each in places.values() for a, b in zip(each, each[1:]))


@pytest.mark.parametrize("changed", [(), (3,)])
def test_a_single_layer_is_written_as_it_is_by_itself(addon, traced, tmp_path, changed):
    for frame in changed:
        moved(addon, traced, frame)
    assert all_layers(tmp_path / "all.json") == exported(tmp_path / "one.json")


def test_two_traced_layers_stay_traced_and_come_back(addon, traced, tmp_path):
    traced_too(traced)
    order = [layer.name for layer in traced.data.layers if layer.name in ("Lines", "Other")]
    document = all_layers(tmp_path / "two.json")
    assert said(addon).text == "traced lines of 6 frames in two.json"
    assert is_numbered_well(document)
    assert frames_of(document) == {"traced": list(FRAMES)}
    ob = imported(tmp_path / "two.json")
    assert said(addon).text == '12 traced strokes from two.json, in the new object "two"'
    assert kinds(addon, ob, "Lines") == dict.fromkeys(FRAMES, MADE)
    for frame in FRAMES:
        assert same_places(shown(addon, ob, ["Lines"], frame), shown(addon, traced, order, frame))


def test_a_drawing_of_the_artist_between_traced_ones_of_two_layers_stays_one(addon, traced, tmp_path):
    traced_too(traced)
    moved(addon, traced, 3)
    document = all_layers(tmp_path / "mine.json")
    assert frames_of(document) == {"drawings": [3], "traced": list(FRAMES)}
    assert is_numbered_well(document)
    ob = imported(tmp_path / "mine.json")
    assert kinds(addon, ob, "Lines") == {**dict.fromkeys(FRAMES, MADE), 3: KEY}
    numbers = [sorted(ls.strokes(addon, ob, "Lines", frame)) for frame in FRAMES]
    assert all(each == numbers[0] for each in numbers) and len(numbers[0]) == 12


def test_a_held_drawing_of_the_artist_goes_with_the_traced_ones(addon, traced, tmp_path):
    ls.put(addon, traced, "Ground", 1, [(np.array([[10.0, 150.0], [200.0, 150.0]]), False)])
    document = all_layers(tmp_path / "ground.json")
    assert frames_of(document) == {"drawings": [1], "traced": list(FRAMES)}
    assert {len(each["strokes"]) for each in document["traced"]} == {7} and is_numbered_well(document)
    ob = imported(tmp_path / "ground.json")
    assert kinds(addon, ob, "Lines") == {**dict.fromkeys(FRAMES, MADE), 1: KEY}
    assert sorted(ls.strokes(addon, ob, "Lines", 1)) == sorted(ls.strokes(addon, ob, "Lines", 6))


def test_traced_strokes_beside_in_betweens_come_back_and_are_named(addon, film, tmp_path):
    addon("lines.tracing").make = addon("rototoon").Session.from_document
    traced_too(film)
    frames = film.data.layers["Other"].frames
    ob = tweened(addon)
    for frame in (2, 6):
        frames.remove(frame)
    document = all_layers(tmp_path / "mixed.json")
    assert said(addon).warnings == ('traced strokes of "Other" go out as in-betweens on 3 to 5, where another layer has in-betweens',)
    assert frames_of(document) == {"drawings": [1, 6], "traced": [1, 6], "in_betweens": [2, 3, 4, 5]}
    order = [layer.name for layer in ob.data.layers if layer.name in ("Lines", "Other")]
    before = {frame: shown(addon, ob, order, frame) for frame in (3, 4, 5)}
    faded = [stroke["opacity"] for stroke in document["in_betweens"][1]["strokes"] if stroke["opacity"] < 1]
    assert faded, "a stroke that is on one drawing only fades on"
    back = imported(tmp_path / "mixed.json")
    assert kinds(addon, back, "Lines") == {1: KEY, 6: KEY, **dict.fromkeys(range(2, 6), MADE)}
    for frame, places in before.items():
        assert same_places(shown(addon, back, ["Lines"], frame), places)


def test_in_betweens_without_their_drawings_are_traced_beside_traced_ones(addon, film, tmp_path):
    addon("lines.tracing").make = addon("rototoon").Session.from_document
    traced_too(film)
    ob = tweened(addon)
    ob.data.layers["Lines"].frames.remove(6)
    ob.data.layers["Lines"].frames.remove(3)
    document = all_layers(tmp_path / "rest.json")
    assert said(addon).warnings == (
        'in-betweens of "Lines" go out as traced strokes on 2 and 4 and 5, where another layer has traced ones; none of them fades',
    )
    assert frames_of(document) == {"drawings": [1], "traced": list(FRAMES)}
    back = imported(tmp_path / "rest.json")
    assert kinds(addon, back, "Lines") == {**dict.fromkeys(FRAMES, MADE), 1: KEY}


def test_a_hidden_layer_stays_out(addon, traced, tmp_path):
    traced_too(traced)
    traced.data.layers["Other"].hide = True
    assert all_layers(tmp_path / "seen.json") == exported(tmp_path / "one.json")
    assert handle_of(addon, traced, "Other", 1) is not None
