"""Import Document into the object from which the document came: contours keep the looks that the artist gave them."""

import json

import bpy
import numpy as np
import pytest
import shots

FRONT = "Contours.front"


@pytest.fixture
def film(addon, fake, tmp_path):
    """Two tracked parts on the layer "Contours", and one on another layer with a look of its own, on the frames 1 and 9."""
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.match_contours()
    line = bpy.data.materials.new("Blue line")
    bpy.data.materials.create_gpencil_data(line)
    ob.data.materials.append(line)
    last = len(ob.data.materials) - 1
    for frame, radius in ((1, 0.05), (9, 0.09)):
        addon("scripting").set_key(ob, frame, {"cap": shots.square(frame - 1) + (60, 20)}, layer=FRONT, radius=radius, material=last)
        handle, gp = drawing(addon, ob, frame), addon("blender.grease_pencil")
        gp.put(handle, "fill_color", np.array([[0.2, 0.3, 0.4, 1.0]], np.float32))
        handle.attributes.new("studio_mask", "FLOAT", "POINT")
        gp.put(handle, "studio_mask", np.array([0.0, 0.25, 0.5, 0.75], np.float32))
    bpy.ops.rototoon.track()
    return ob


def drawing(addon, ob, frame, layer=FRONT):
    return addon("blender.grease_pencil").drawings(ob.data.layers[layer])[frame][0]


def round_trip(tmp_path, change=lambda document: None):
    path = tmp_path / "out.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    document = json.loads(path.read_text())
    change(document)
    (tmp_path / "in.json").write_text(json.dumps(document))
    return bpy.ops.rototoon.import_document(filepath=str(tmp_path / "in.json"), into="ACTIVE", keep_numbers=True)


def look(addon, ob, frame, layer=FRONT):
    gp = addon("blender.grease_pencil")
    handle = drawing(addon, ob, frame, layer)
    points, strokes = int(gp.offsets(handle)[-1]), len(gp.offsets(handle)) - 1
    names = {"radius": points, "material_index": strokes, "fill_color": strokes} | ({"studio_mask": points} if layer == FRONT else {})
    return {name: gp.get(handle, name, count) if name == "studio_mask" else gp.value(handle, name, count) for name, count in names.items()}


def same(one, other):
    return one.keys() == other.keys() and all(np.allclose(one[name], other[name]) for name in one)


def test_contours_come_back_as_they_looked(addon, film, tmp_path):
    places = [(1, FRONT), (4, FRONT), (9, FRONT), (1, "Contours"), (4, "Contours")]
    before = [look(addon, film, *place) for place in places]
    assert round_trip(tmp_path) == {"FINISHED"}
    assert [len(layer.frames) for layer in film.data.layers if layer.name in (FRONT, "Contours")] == [9, 9]
    for place, expected in zip(places, before, strict=True):
        assert same(look(addon, film, *place), expected), place
    assert bpy.ops.rototoon.track() == {"FINISHED"}


def test_a_key_on_another_frame_and_with_other_points_looks_like_the_nearest(addon, film, tmp_path):
    def change(document):
        part = document["parts"][-1]
        for name in ("tracks", "confidence"):
            part.pop(name, None)
        points = part["keys"].pop("9")
        part["keys"]["8"] = [*points, [points[0][0], points[0][1] + 1]]
        part["keys"]["1"] = [*part["keys"]["1"], [points[0][0] - 8, points[0][1] + 1]]

    assert round_trip(tmp_path, change) == {"FINISHED"}
    found = look(addon, film, 8)
    assert found["radius"].tolist() == pytest.approx([0.09] * 5) and found["material_index"].tolist() == [len(film.data.materials) - 1]
    assert found["studio_mask"][[0, -1]].tolist() == [0.0, 0.75]


def test_parts_that_the_object_has_not_get_the_usual_look(addon, film, tmp_path):
    def change(document):
        document["parts"][-1]["name"] = "new"

    assert round_trip(tmp_path, change) == {"FINISHED"}
    assert not film.data.layers[FRONT].frames and len(shots.pixels(addon, film, 1)) == 3
    assert look(addon, film, 1, "Contours")["radius"] == pytest.approx(0.01)


def test_contours_are_read_once_before_and_once_after(addon, film, tmp_path, monkeypatch):
    contours, read = addon("capture.contours"), []
    reading = contours.reading
    path = tmp_path / "out.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    monkeypatch.setattr(contours, "reading", lambda *given: read.append(given) or reading(*given))
    assert bpy.ops.rototoon.import_document(filepath=str(path), into="ACTIVE", keep_numbers=True) == {"FINISHED"}
    assert len(read) == 2
