"""Clicks that leak, clicks without paint, and colours that are their materials, with the real library."""

import json

import bpy
import line_shots as ls
import pytest
from line_stage import attribute, film, kinds, pictures, said  # noqa: F401 - fixtures
from shots import write_png
from test_paint import EYE, LAYER, PAPER, SKIN, click, clicked, colour_at, painted, places, read  # noqa: F401 - fixtures


def gapped(folder, rows):
    """The film with a gap of some rows in the left side of the body. Returns its active object."""
    first = ls.draw_sequence(folder)
    for number, path in enumerate(sorted(folder.glob(f"*{first.suffix}"))):
        picture = ls.picture(number).copy()
        left = int((90 + 4 * number) * ls.SCALE)
        picture[91 - rows // 2 : 91 + (rows + 1) // 2, left - 6 : left + 7] = ls.PAPER
        write_png(path, picture)
    return ls.set_up(first)


def test_a_click_that_leaks_is_told_at_once(addon, library, tmp_path):
    (_, (body, _), *_) = places(1)
    for name, rows in (("narrow", 2), ("wide", 14)):
        (tmp_path / name).mkdir()
        ob = gapped(tmp_path / name, rows)
        click(ob, body, SKIN)
        told = said(addon)
        assert told.kind == "WARNING" and "gap of about" in told.text, told.text
        flooded = colour_at(addon, ob, 1, (8, 8)) is not None
        assert flooded == (name == "wide")
        assert ("up to the picture's edge" in told.text) == flooded, told.text
        if flooded:
            ob.rototoon.fill_nothing = True
            assert bpy.ops.rototoon.paint_bucket(place=(8, 8)) == {"FINISHED"}
            assert said(addon).text == "1 region stays without paint"
            assert colour_at(addon, ob, 1, (8, 8)) == (), "a shape without paint parts it"
            assert colour_at(addon, ob, 1, body) == pytest.approx(SKIN, abs=1e-3)


def test_no_paint_is_said_carried_and_kept_in_documents(addon, clicked, tmp_path):  # noqa: F811
    eye = places(1)[2][0]
    clicked.rototoon.fill_nothing = True
    assert bpy.ops.rototoon.paint_bucket(place=eye) == {"FINISHED"}
    assert said(addon).text == "1 region stays without paint"
    assert colour_at(addon, clicked, 1, eye) == ()
    used = {clicked.data.materials[int(i)].name for i in read(addon, clicked, 1).strokes("material_index")}
    assert "No Paint" in used and len(read(addon, clicked, 1).sizes) == 4
    bpy.ops.rototoon.fill_drawings()
    scripting = addon("scripting")

    def bare(ob):
        shown = {frame: len(regions) for frame, regions in scripting.regions(ob).items()}
        return shown == dict.fromkeys(range(1, 7), 3) and all(not colour_at(addon, ob, f, places(f)[2][0]) for f in range(1, 7))

    assert bare(clicked)
    path = tmp_path / "paint.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    document = json.loads(path.read_text())
    assert [each["colour"] for each in document["fills"][0]["regions"]].count(None) == 1
    assert all(len(each["regions"]) == 3 for each in document["filled"])
    bpy.ops.rototoon.import_document(filepath=str(path))
    other = bpy.context.object
    assert other != clicked and bare(other)
    bpy.ops.rototoon.fill_drawings()
    assert bare(other), "the click came with the document"
    again = tmp_path / "again.json"
    bpy.ops.rototoon.export_document(filepath=str(again))
    assert [each["colour"] for each in json.loads(again.read_text())["fills"][0]["regions"]].count(None) == 1
    scripting.fill_region(other, 1, eye, EYE)
    assert colour_at(addon, other, 1, eye) == pytest.approx(EYE, abs=1e-3), "it can be painted again"


def by_material(addon, ob):
    """The number of filled regions by the name of their material, on all frames."""
    index = [i for frame in kinds(addon, ob, LAYER) for i in attribute(addon, ob, LAYER, frame, "material_index").tolist()]
    return {ob.data.materials[i].name: index.count(i) for i in sorted(set(index))}


def test_a_colour_is_its_material_and_not_its_look(addon, painted):  # noqa: F811
    body, eye = (painted.data.materials[name] for name in ("Paint edc29e", "Paint 3366e6"))
    body.name, eye.name = "Mantel", "Auge"
    assert by_material(addon, painted) == {"Paint ffffff": 6, "Mantel": 6, "Auge": 12}
    # A night palette: both look the same.
    body.grease_pencil.fill_color = eye.grease_pencil.fill_color
    assert bpy.ops.rototoon.fill_drawings() == {"FINISHED"}
    assert by_material(addon, painted) == {"Paint ffffff": 6, "Mantel": 6, "Auge": 12}, "they stay two colours"
    # The bucket takes a material, and not the first one that looks like it.
    scripting, bucket = addon("scripting"), addon("paint.bucket")
    place = places(1)[1][0]
    taken, painted.rototoon.fill_name = bucket.taken_at(painted, 1, place)
    assert painted.rototoon.fill_name == "Mantel"
    scripting.fill_region(painted, 1, place, taken)
    assert by_material(addon, painted) == {"Paint ffffff": 6, "Mantel": 6, "Auge": 12}


def test_colours_keep_their_materials_in_documents(addon, painted, tmp_path):  # noqa: F811
    painted.data.materials["Paint edc29e"].name = "Mantel"
    path = tmp_path / "paint.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    document = json.loads(path.read_text())
    assert sorted(document["palette"]) == ["Mantel", "Paint 3366e6", "Paint ffffff"]
    assert {each["name"] for each in document["filled"][3]["regions"]} == set(document["palette"])
    count = len(bpy.data.materials)
    bpy.ops.rototoon.import_document(filepath=str(path))
    other = bpy.context.object
    assert by_material(addon, other) == by_material(addon, painted)
    added = set(bpy.data.materials[count:]) if len(bpy.data.materials) > count else set()
    assert not any(own.name.startswith(("Mantel.", "Paint")) for own in added), "one change of colour reaches both objects"
    # A material of somebody else that looks otherwise is no colour of this paint.
    stranger = bpy.data.materials.new("Fremd")
    bpy.data.materials.create_gpencil_data(stranger)
    stranger.grease_pencil.fill_color = (0, 0, 0, 1)
    for own in [each for entry in document["fills"] + document["filled"] for each in entry["regions"]]:
        own["name"] = own["name"].replace("Mantel", "Fremd")
    document["palette"]["Fremd"] = document["palette"].pop("Mantel")
    path.write_text(json.dumps(document))
    bpy.ops.rototoon.import_document(filepath=str(path))
    third = bpy.context.object
    assert set(by_material(addon, third)) == {"Fremd.001", "Paint 3366e6", "Paint ffffff"}
    assert sorted(own.material.name for own in third.rototoon.palette) == ["Fremd.001", "Paint 3366e6", "Paint ffffff"]
    assert colour_at(addon, third, 3, places(3)[1][0]) == pytest.approx(SKIN, abs=1e-3)


def test_colours_of_a_palette_stay_without_paint_of_them(addon, painted, tmp_path):  # noqa: F811
    path = tmp_path / "paint.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    document = json.loads(path.read_text())
    document["palette"] = {"Nacht": [0.0, 0.1, 0.2], **document["palette"], "Haar": [0.35, 0.2, 0.1]}
    path.write_text(json.dumps(document))
    bpy.ops.rototoon.import_document(filepath=str(path))
    other = bpy.context.object
    bpy.ops.rototoon.export_document(filepath=str(path))
    assert list(json.loads(path.read_text())["palette"].items()) == list(document["palette"].items())
    # It is a colour to choose, and its name and its look are those of its material.
    scripting = addon("scripting")
    scripting.recolour(other, "Paint edc29e", "Nacht", first=4)
    other.data.materials["Haar"].name = "Bart"
    bpy.ops.rototoon.export_document(filepath=str(path))
    written = json.loads(path.read_text())
    assert set(written["palette"]) == {*document["palette"], "Bart"} - {"Haar"}
    assert written["recolours"][0]["to"]["name"] == "Nacht"
    # An object that gets another document keeps what it has, and each colour once.
    bpy.ops.rototoon.import_document(filepath=str(path), into="ACTIVE")
    assert sorted(own.material.name for own in other.rototoon.palette) == sorted(written["palette"])
    bpy.data.materials.remove(bpy.data.materials["Bart"])
    bpy.ops.rototoon.export_document(filepath=str(path))
    assert set(json.loads(path.read_text())["palette"]) == set(document["palette"]) - {"Haar"}


def test_a_palette_is_checked_before_anything_changes(addon, painted, tmp_path):  # noqa: F811
    path = tmp_path / "paint.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    document, count = json.loads(path.read_text()), len(bpy.data.objects)
    for palette, field in (({"Nacht": [0, 0]}, "palette.Nacht"), ({"Nacht": [0, 0, 2]}, "palette.Nacht"), ([], "palette")):
        path.write_text(json.dumps(document | {"palette": palette}))
        with pytest.raises(RuntimeError, match=f"{field}: found"):
            bpy.ops.rototoon.import_document(filepath=str(path))
    assert len(bpy.data.objects) == count


def test_strokes_of_an_object_without_materials_keep_their_look(addon, painted, tmp_path):  # noqa: F811
    path = tmp_path / "paint.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    document = json.loads(path.read_text())
    document["parts"] = [{"name": "arm", "closed": True, "keys": {str(document["footage"]["first"]): [[10, 10], [50, 10], [50, 50]]}}]
    path.write_text(json.dumps(document))
    bare = painted.copy()
    bare.data = painted.data.copy()
    bare.data.materials.clear()
    bpy.context.collection.objects.link(bare)
    bpy.context.view_layer.objects.active = bare
    for layer in list(bare.data.layers):
        bare.data.layers.remove(layer)
    bpy.ops.rototoon.import_document(filepath=str(path), into="ACTIVE")
    contours = attribute(addon, bare, "Contours", 1, "material_index")
    assert [bare.data.materials[i] for i in contours.tolist()] == [None]
    assert set(by_material(addon, bare)) == set(document["palette"])


@pytest.mark.every_version
def test_materials_that_are_linked_to_the_object_are_its_colours(addon, painted, tmp_path):  # noqa: F811
    """As for another dress of a character: the slot has a material of the object, and the data has the old one still."""
    coat = bpy.data.materials.new("Coat")
    bpy.data.materials.create_gpencil_data(coat)
    coat.grease_pencil.fill_color, coat.grease_pencil.show_fill = (1.0, 0.0, 0.0, 1.0), True
    index = painted.data.materials.find("Paint edc29e")
    slot = painted.material_slots[index]
    slot.link, slot.material = "OBJECT", coat

    def bodies():
        return [addon("paint.bucket").taken_at(painted, frame, places(frame)[1][0]) for frame in (1, 6)]

    assert bodies() == [(pytest.approx((1, 0, 0)), "Coat")] * 2
    path, count = tmp_path / "coat.json", len(painted.data.materials)
    bpy.ops.rototoon.export_document(filepath=str(path))
    assert json.loads(path.read_text())["palette"]["Coat"] == [1, 0, 0]
    assert bpy.ops.rototoon.fill_drawings() == {"FINISHED"}
    assert bodies() == [(pytest.approx((1, 0, 0)), "Coat")] * 2
    assert len(painted.data.materials) == count and painted.data.materials[index].name == "Paint edc29e"
    done = addon("scripting").recolour(painted, "Coat", "Paint edc29e", first=4)
    assert done.frames == (4, 5, 6)
    assert [name for _, name in bodies()] == ["Coat", "Paint edc29e"]
    assert painted.material_slots[index].material == coat


def test_a_palette_is_taken_where_a_slot_is_linked_to_the_object(addon, painted, tmp_path):  # noqa: F811
    coat = bpy.data.materials.new("Coat")
    bpy.data.materials.create_gpencil_data(coat)
    coat.grease_pencil.fill_color = (1.0, 0.0, 0.0, 1.0)
    slot = painted.material_slots[painted.data.materials.find("Paint edc29e")]
    slot.link, slot.material = "OBJECT", coat
    path = tmp_path / "coat.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    document = json.loads(path.read_text())
    bpy.ops.rototoon.import_document(filepath=str(path), into="ACTIVE")
    assert sorted(own.material.name for own in painted.rototoon.palette) == sorted(document["palette"])
    bpy.ops.rototoon.export_document(filepath=str(path))
    assert json.loads(path.read_text())["palette"] == document["palette"]
