"""Materials that Rototoon makes beside those of the artist."""

import bpy
import pytest
from test_strokes import drawing_object

pytestmark = pytest.mark.every_version


@pytest.fixture
def inked(addon):
    """An object whose material has a line and a fill."""
    ob = drawing_object(addon, filled=True)
    ob.data.materials[0].name = "Ink"
    return ob


def material(name, fill):
    """A material of the artist."""
    made = bpy.data.materials.new(name)
    bpy.data.materials.create_gpencil_data(made)
    made.grease_pencil.show_fill = fill
    return made


def test_the_line_of_a_filled_material_is_made_once(addon, inked):
    line_material = addon("blender.strokes").line_material
    place = line_material(inked, 0)
    made = inked.data.materials[place]
    assert (made.name, made.grease_pencil.show_fill) == ("Ink Line", False)
    assert line_material(inked, 0) == place
    assert inked.data.materials[0].grease_pencil.show_fill
    other = drawing_object(addon, filled=True)
    other.data.materials[0] = inked.data.materials[0]
    assert other.data.materials[line_material(other, 0)] == made


def test_the_line_is_that_of_the_material_that_the_object_shows(addon, inked):
    slot = inked.material_slots[0]
    slot.link, slot.material = "OBJECT", material("Red", fill=True)
    made = inked.data.materials[addon("blender.strokes").line_material(inked, 0)]
    assert made.name == "Red Line" and inked.data.materials[0].name == "Ink"


@pytest.mark.parametrize("in_slot", [False, True])
def test_an_artists_material_of_that_name_keeps_its_fill(addon, inked, in_slot):
    own = material("Ink Line", fill=True)
    if in_slot:
        inked.data.materials.append(own)
    place = addon("blender.strokes").line_material(inked, 0)
    made = inked.data.materials[place]
    assert own.grease_pencil.show_fill and made != own and not made.grease_pencil.show_fill
    assert addon("blender.strokes").line_material(inked, 0) == place, "it is found again under the name that Blender gave it"


def test_an_artists_mesh_material_of_that_name_stays(addon, inked):
    bpy.data.materials.new("Ink Line")
    made = inked.data.materials[addon("blender.strokes").line_material(inked, 0)]
    assert made.grease_pencil is not None and not made.grease_pencil.show_fill


def test_a_new_object_has_ink_though_a_mesh_material_has_its_name(addon):
    bpy.data.materials.new("Rototoon Ink")
    ob = addon("blender.grease_pencil").new_object("Drawing", bpy.context.collection)
    assert ob.data.materials[0].grease_pencil is not None


def test_a_colour_of_a_palette_is_the_material_that_the_object_shows(addon, inked):
    palette, night = addon("paint.palette"), {"Night": [0.0, 0.1, 0.2]}
    palette.take(inked, night)
    made = inked.data.materials.pop(index=1)
    slot = inked.material_slots[0]
    slot.link, slot.material = "OBJECT", made
    inked.rototoon.palette.clear()
    palette.take(inked, night)
    assert [own.material for own in inked.rototoon.palette] == [made]
