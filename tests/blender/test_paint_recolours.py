"""Materials of paint that become others on some frames, with the real library."""

import json

import bpy
import line_shots as ls
import pytest
from line_stage import attribute, film, kinds, pictures, said  # noqa: F401 - fixtures
from test_paint import LAYER, clicked, painted, places, read  # noqa: F401 - fixtures

BODY, WET = "Paint edc29e", (0.2, 0.25, 0.35)


def wet(name="Wet", colour=WET):
    """A material of a colour that no object has yet."""
    made = bpy.data.materials.new(name)
    bpy.data.materials.create_gpencil_data(made)
    style = made.grease_pencil
    if bpy.app.version < (5, 1, 0):
        style.show_fill, style.show_stroke = True, False
    style.fill_color = (*[value**2.2 for value in colour], 1.0)
    return made


def names(addon, ob, place=1):
    """The material of the body (or of another of `places`) on each frame, as it is seen."""
    found = []
    for frame in range(1, 7):
        taken = addon("paint.bucket").taken_at(ob, frame, places(frame)[place][0])
        found.append(taken and taken[1])
    return found


def numbers(addon, ob, name):
    """The numbers of the regions with a material, on all frames."""
    found = set()
    for frame in kinds(addon, ob, LAYER):
        pairs = zip(attribute(addon, ob, LAYER, frame, "material_index").tolist(), attribute(addon, ob, LAYER, frame, "rototoon_track").tolist())
        found |= {number for index, number in pairs if ob.data.materials[index].name == name}
    return found


def test_a_material_becomes_another_one_from_the_current_frame_on(addon, painted):  # noqa: F811
    wet()
    bpy.context.scene.frame_set(4)
    assert bpy.ops.rototoon.recolour(old=BODY, new="Wet") == {"FINISHED"}
    told = said(addon)
    assert (told.kind, told.text) == ("INFO", f"{BODY} → Wet, from 4 on: 3 regions on 3 frames")
    expected = [BODY] * 3 + ["Wet"] * 3
    assert names(addon, painted) == expected
    assert numbers(addon, painted, "Wet").isdisjoint(numbers(addon, painted, BODY)), "a number has one colour"
    assert kinds(addon, painted, LAYER) == {1: "KEYFRAME", **dict.fromkeys(range(2, 7), "GENERATED")}, "generated ones stay so"
    # It holds when the drawings are filled again, and every other colour is as it was.
    assert bpy.ops.rototoon.fill_drawings() == {"FINISHED"}
    assert said(addon).text == "24 regions on 6 frames" and names(addon, painted) == expected
    assert names(addon, painted, 2) == ["Paint 3366e6"] * 6
    assert bpy.ops.rototoon.remove_recolour(place=0) == {"FINISHED"}
    assert "press Fill Drawings" in said(addon).text and len(painted.rototoon.recolours) == 0
    bpy.ops.rototoon.fill_drawings()
    assert names(addon, painted) == [BODY] * 6


def test_shapes_of_the_artist_stay_and_are_told(addon, painted):  # noqa: F811
    wet()
    bpy.context.scene.frame_set(2)
    before = read(addon, painted, 1)
    assert bpy.ops.rototoon.recolour(old=BODY, new="Wet", frames="UP_TO") == {"FINISHED"}
    kept = "shapes of yours keep the old colour, on frame 1: give them the new material if they are to change"
    assert said(addon).warnings == (kept,)
    assert read(addon, painted, 1).equals(before)
    assert names(addon, painted) == [BODY, "Wet"] + [BODY] * 4
    bpy.ops.rototoon.fill_drawings()
    assert kept in said(addon).warnings and names(addon, painted) == [BODY, "Wet"] + [BODY] * 4
    # In the new material they mean the same region, so what follows is as it was.
    content = read(addon, painted, 1)
    body, new = (painted.data.materials.find(name) for name in (BODY, "Wet"))
    index = [new if i == body else i for i in content.strokes("material_index").tolist()]
    gp = addon("blender.grease_pencil")
    gp.put(gp.drawings(painted.data.layers[LAYER])[1][0], "material_index", index)
    bpy.ops.rototoon.fill_drawings()
    assert said(addon).warnings == () and names(addon, painted) == ["Wet", "Wet"] + [BODY] * 4


def test_a_range_in_the_middle_of_a_held_drawing(addon, library, tmp_path):
    scripting, first = addon("scripting"), ls.draw_sequence(tmp_path)
    pictures_of = sorted(tmp_path.glob(f"*{first.suffix}"))
    for path in pictures_of[3:]:
        path.write_bytes(pictures_of[2].read_bytes())
    clicked = ls.set_up(first)
    for place, colour in places(1):
        scripting.fill_region(clicked, 1, place, colour)
    bpy.ops.rototoon.fill_drawings()
    assert sorted(kinds(addon, clicked, LAYER)) == [1, 2, 3], "frames 3 to 6 show one drawing"
    wet()
    done = scripting.recolour(clicked, BODY, "Wet", 4, 5)
    assert (done.frames, done.regions, done.kept, done.waiting) == ((4,), 1, (), ())

    def shown():
        layer = clicked.data.layers[LAYER]
        body = []
        for frame in range(3, 7):
            drawing = layer.get_frame_at(frame).drawing
            body.append("Wet" in {clicked.data.materials[each.value].name for each in drawing.attributes["material_index"].data})
        return sorted(kinds(addon, clicked, LAYER)), body

    expected = [1, 2, 3, 4, 6], [False, True, True, False]
    assert shown() == expected
    bpy.ops.rototoon.fill_drawings()
    assert shown() == expected, "and the frames that hold a drawing still do"
    assert scripting.recolours(clicked) == [(BODY, "Wet", 4, 5)]
    with pytest.raises(RuntimeError, match="expected one of the 1 entries"):
        scripting.remove_recolour(clicked, 1)
    scripting.remove_recolour(clicked, 0)
    bpy.ops.rototoon.fill_drawings()
    assert shown() == ([1, 2, 3], [False] * 4)


def test_what_makes_no_sense_is_refused_and_changes_nothing(addon, painted):  # noqa: F811
    wet()
    before, count = names(addon, painted), len(bpy.data.materials)
    for options, told in (
        ({"old": "Nose", "new": "Wet"}, 'has no material "Nose"'),
        ({"old": BODY, "new": "Nose"}, 'There is no material "Nose"'),
        ({"old": BODY, "new": BODY}, "becomes itself"),
        ({"old": BODY, "new": "Wet", "frames": "RANGE", "first": 5, "last": 4}, "is before the first one"),
        ({"old": BODY, "new": "Wet", "frames": "RANGE", "first": 50, "last": 60}, "There are no pictures on these frames"),
    ):
        with pytest.raises(RuntimeError, match=told):
            bpy.ops.rototoon.recolour(**options)
    painted.data.layers[LAYER].lock = True
    with pytest.raises(RuntimeError, match="locked"):
        bpy.ops.rototoon.recolour(old=BODY, colour=(0.1, 0.2, 0.3))
    painted.data.layers[LAYER].lock = False
    assert (names(addon, painted), len(painted.rototoon.recolours), len(bpy.data.materials)) == (before, 0, count)
    # Without a material, one is made of the colour.
    assert bpy.ops.rototoon.recolour(old=BODY, colour=WET) == {"FINISHED"}
    assert names(addon, painted)[1:] == ["Paint 334059"] * 5
    # From the menu it is the last one that goes.
    assert bpy.ops.rototoon.recolour(old="Paint 334059", new="Wet") == {"FINISHED"}
    assert bpy.ops.rototoon.remove_recolour() == {"FINISHED"}
    assert [entry[:2] for entry in addon("scripting").recolours(painted)] == [(BODY, "Paint 334059")]


def test_documents_keep_them(addon, painted, tmp_path):  # noqa: F811
    painted.data.materials[BODY].name = "Coat"
    wet()
    bpy.context.scene.frame_set(4)
    bpy.ops.rototoon.recolour(old="Coat", new="Wet")
    expected = ["Coat"] * 3 + ["Wet"] * 3
    path = tmp_path / "paint.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    document = json.loads(path.read_text())
    first = document["footage"]["first"]
    (entry,) = document["recolours"]
    assert (entry["from"]["name"], entry["to"]["name"], entry["first"], "last" in entry) == ("Coat", "Wet", first + 3, False)
    assert bpy.ops.rototoon.import_document(filepath=str(path)) == {"FINISHED"}
    other = bpy.context.object
    assert other != painted and names(addon, other) == expected
    assert addon("scripting").recolours(other) == [("Coat", "Wet", 4, None)]
    bpy.ops.rototoon.fill_drawings()
    assert names(addon, other) == expected
    document["recolours"][0]["to"] = 7
    path.write_text(json.dumps(document))
    with pytest.raises(RuntimeError, match=r"recolours\[0\].to: found 7, expected an object"):
        bpy.ops.rototoon.import_document(filepath=str(path))
