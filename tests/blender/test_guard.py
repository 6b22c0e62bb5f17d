"""Locked, hidden, linked, overridden and shared drawings: no operator, handler and not Live writes what is not theirs to write."""

import math
from pathlib import Path

import bpy
import pytest
import shots
import studio
from studio import OPERATORS

pytestmark = pytest.mark.every_version

WRITERS = [(name, layer) for name, call in OPERATORS.items() for layer in sorted(call.writes)]


@pytest.fixture(scope="session")
def file(tmp_path_factory):
    """Where the studio's file is kept for all tests; each makes it if it is not there yet."""
    return {"folder": tmp_path_factory.mktemp("studio"), "path": None}


@pytest.fixture
def opened(addon, library, fake, file):
    """The studio, opened afresh."""
    if file["path"] is None:
        file["path"] = studio.build(addon, file["folder"])
    return studio.open_file(file["path"])


@pytest.fixture
def said(addon):
    """What operators report, the last report last."""
    taken = addon("common.reports")
    taken.take()
    return taken._kept


def run(addon, name, file, said):
    """Calls an operator. Returns its report or its refusal."""
    said.clear()
    try:
        studio.call(name, file["folder"])
    except RuntimeError as error:
        return str(error)
    return " ".join(report.text for report in said)


def prepared(addon, ob, name):
    studio.activate(bpy.data.objects[OPERATORS[name].on])
    OPERATORS[name].prepare(addon, ob)


def test_every_operator_is_in_the_table():
    assert sorted(OPERATORS) == sorted(dir(bpy.ops.rototoon)), "add the new operator to OPERATORS in studio.py"


@pytest.mark.parametrize("name", OPERATORS)
def test_operators_write_the_layers_of_the_table(addon, opened, file, said, name):
    """Nothing is locked: what the other tests forbid does happen here, and nothing else."""
    prepared(addon, opened, name)
    before = studio.digests(addon, opened)
    told = run(addon, name, file, said)
    after = studio.digests(addon, opened)
    assert "Error" not in told
    assert {layer for layer in before if after.get(layer) != before[layer]} == OPERATORS[name].writes


def closed_by_itself(ob, layer):
    ob.data.layers[layer].lock = True


def closed_by_its_group(ob, layer):
    outer = ob.data.layer_groups.new("outer")
    inner = ob.data.layer_groups.new("inner", parent_group=outer)
    ob.data.layers.move_to_layer_group(ob.data.layers[layer], inner)
    outer.lock = True


def locked_and_hidden(ob, layer):
    ob.data.layers[layer].lock = ob.data.layers[layer].hide = True


@pytest.mark.parametrize("close", [closed_by_itself, closed_by_its_group, locked_and_hidden])
@pytest.mark.parametrize(("name", "layer"), WRITERS)
def test_a_locked_layer_is_never_written(addon, opened, file, said, name, layer, close):
    prepared(addon, opened, name)
    close(opened, layer)
    before = studio.digests(addon, opened)
    told = run(addon, name, file, said)
    assert studio.digests(addon, opened)[layer] == before[layer]
    assert f'the layer "{layer}" is locked' in told, told


def help_of(name):
    """All that the help of an operator says."""
    rna = getattr(bpy.ops.rototoon, name).get_rna_type()
    items = [item.description for prop in rna.properties if prop.type == "ENUM" for item in prop.enum_items]
    return " ".join([rna.description, *items]).lower()


@pytest.mark.parametrize("group", [False, True])
@pytest.mark.parametrize(("name", "layer"), WRITERS)
def test_a_hidden_layer_is_written_only_where_the_operator_says_so(addon, opened, file, said, name, layer, group):
    prepared(addon, opened, name)
    if group:
        holder = opened.data.layer_groups.new("holder")
        opened.data.layers.move_to_layer_group(opened.data.layers[layer], holder)
        holder.hide = True
    else:
        opened.data.layers[layer].hide = True
    before = studio.digests(addon, opened)
    told = run(addon, name, file, said)
    written = studio.digests(addon, opened)[layer] != before[layer]
    if layer in OPERATORS[name].hidden:
        assert written and "hidden layers" in help_of(name)
    else:
        assert not written and f'the layer "{layer}" is hidden' in told, told


SEVERAL = [name for name, call in OPERATORS.items() if len(call.writes) > 1 and call.hidden != call.writes and name not in ("hide_part", "hide_unseen")]


@pytest.mark.parametrize("name", SEVERAL)
def test_other_layers_are_written_beside_a_locked_one(addon, opened, file, said, name):
    """Of several layers, the open ones are written. Import replaces all of them, or none; a part whose contour stays is not hidden."""
    prepared(addon, opened, name)
    first, *others = sorted(OPERATORS[name].writes)
    opened.data.layers[first].lock = True
    before = studio.digests(addon, opened)
    run(addon, name, file, said)
    after = studio.digests(addon, opened)
    assert {layer for layer in before if after[layer] != before[layer]} == set(others)


def linked_file(file):
    """An empty file with the studio's objects linked into it."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(file["path"]).with_name("other.blend")))
    with bpy.data.libraries.load(file["path"], link=True) as (_, into):
        into.objects = [studio.OBJECT, "Rig", "Camera"]
    for ob in into.objects:
        bpy.context.scene.collection.objects.link(ob)
    bpy.context.scene.camera = bpy.data.objects["Camera"]
    bpy.context.view_layer.update()


def overridden(file):
    """The linked objects with their data as library overrides."""
    linked_file(file)
    for ob in list(bpy.context.scene.objects):
        made = ob.override_create(remap_local_usages=True)
        if made.data is not None:
            made.data = made.data.override_create()
    bpy.context.view_layer.update()


@pytest.mark.parametrize("name", OPERATORS)
@pytest.mark.parametrize("make", [linked_file, overridden])
def test_objects_of_another_file_are_not_changed(addon, opened, file, said, name, make):
    make(file)
    ob = bpy.context.scene.objects[studio.OBJECT]
    studio.activate(bpy.context.scene.objects[OPERATORS[name].on])
    if name in ("footage_from_reference",):
        OPERATORS[name].prepare(addon, ob)
    before = studio.digests(addon, ob), settings_of(ob)
    told = run(addon, name, file, said)
    ob = bpy.context.scene.objects[studio.OBJECT]
    assert (studio.digests(addon, ob), settings_of(ob)) == before
    if not OPERATORS[name].changes:
        assert "Error" not in told and "poll() failed" not in told, told
    elif name == "drive_bones" and make is overridden:
        # Animation is what an override is for.
        assert "bones on frames" in told, told
    else:
        assert ("linked from another file" if make is linked_file else "library override") in told, told
        assert f'"{OPERATORS[name].on}"' in told or '"Contours"' in told, told


def settings_of(ob) -> list:
    """The object's own settings."""
    own = ob.rototoon
    return [
        str(getattr(own, prop.identifier))
        for prop in own.bl_rna.properties
        if prop.type in {"STRING", "INT", "FLOAT", "BOOLEAN", "ENUM"}
    ] + [(part.number, part.name, part.count, part.ends) for part in own.parts]


@pytest.mark.parametrize("name", OPERATORS)
def test_shared_drawings_are_not_changed(addon, opened, file, said, name):
    prepared(addon, opened, name)
    twin = opened.copy()
    bpy.context.scene.collection.objects.link(twin)
    before = studio.digests(addon, opened)
    told = run(addon, name, file, said)
    assert studio.digests(addon, opened) == before
    if OPERATORS[name].writes:
        assert f'"{studio.OBJECT}" shares its drawings with "{twin.name}"' in told, told
    else:
        assert "Error" not in told and "poll() failed" not in told, told


def test_a_fake_user_is_no_other_object(addon, opened):
    opened.data.use_fake_user = True
    assert bpy.ops.rototoon.track() == {"FINISHED"}


# -- Live and the other handlers ---------------------------------------------------------------------------------------


@pytest.fixture
def live(addon):
    """The module, left without anything due."""
    found = addon("capture.live")
    yield found
    found.reset()


def settle(live):
    bpy.context.view_layer.update()
    for _ in range(50000):
        if live.step(math.inf) is None:
            return
    raise AssertionError("live never ends")


@pytest.mark.parametrize("close", [closed_by_itself, closed_by_its_group, locked_and_hidden])
def test_live_leaves_a_locked_layer_and_catches_up(addon, opened, live, close):
    opened.rototoon.live = True
    settle(live)
    close(opened, studio.CONTOURS)
    before = studio.digests(addon, opened)
    shots.move(addon, opened, 1, 3, (6.0, 0.0))
    edited = studio.digests(addon, opened)
    assert edited != before
    settle(live)
    assert studio.digests(addon, opened) == edited
    text, icon = live.status(opened)
    assert 'the layer "Contours" is locked' in text and icon == "ERROR"
    layer = opened.data.layers[studio.CONTOURS]
    layer.lock = layer.hide = False
    while layer.parent_group is not None:
        layer.parent_group.lock = False
        opened.data.layers.move_to_layer_group(layer, layer.parent_group.parent_group)
    opened.data.update_tag()
    settle(live)
    assert studio.digests(addon, opened) != edited
    assert live.status(opened) == ("Follows your edits", "CHECKMARK")


def two_layers(addon, ob):
    """The third part on a contour layer of its own."""
    layer, other = ob.data.layers[studio.CONTOURS], ob.data.layers.new("Contours.arm")
    gp, st = addon("blender.grease_pencil"), addon("blender.strokes")
    bpy.ops.rototoon.clear_generated(corrected=True, snapped=False)
    other.frames.new(1)
    source, target = gp.drawings(layer)[1][0], gp.drawings(other)[1][0]
    st.add(target, st.chosen(st.read(source), [2]))
    gp.remove_strokes(source, [2])
    bpy.ops.rototoon.track()
    assert len(other.frames) > 1
    return layer, other


@pytest.mark.parametrize("by", ["track", "live", "undo"])
def test_of_two_contour_layers_the_locked_one_stays(addon, opened, live, said, by):
    _, other = two_layers(addon, opened)
    other.lock = True
    opened.rototoon.live = by != "track"
    settle(live)
    bpy.ops.ed.undo_push(message="before")
    before = studio.digests(addon, opened)
    shots.move(addon, opened, 1, 1, (5.0, 2.0))
    bpy.ops.ed.undo_push(message="moved")
    if by == "track":
        bpy.ops.rototoon.track()
        assert 'the layer "Contours.arm" is locked' in said[-1].text and said[-1].kind == "WARNING"
    elif by == "undo":
        bpy.ops.ed.undo()
    settle(live)
    ob = bpy.context.object
    after = studio.digests(addon, ob)
    assert after["Contours.arm"] == before["Contours.arm"]
    assert (after["Contours"] != before["Contours"]) == (by != "undo")
    if by == "live":
        assert live.status(ob)[0] == 'Follows your edits; left as it was: the layer "Contours.arm" is locked'


def test_new_strokes_on_a_locked_layer_are_left_alone(addon, opened):
    two_layers(addon, opened)
    gp = addon("blender.grease_pencil")
    spare = opened.data.layers.new("Contours.spare")
    spare.frames.new(1)
    handle = gp.drawings(spare)[1][0]
    handle.add_strokes([4])
    gp.put(handle, "position", shots.mapping(addon, opened).to_layer(shots.square(4)))
    spare.lock = True
    before, parts = studio.digests(addon, opened)["Contours.spare"], len(opened.rototoon.parts)
    bpy.ops.rototoon.track()
    assert studio.digests(addon, opened)["Contours.spare"] == before and len(opened.rototoon.parts) == parts
    spare.lock = False
    bpy.ops.rototoon.track()
    assert len(opened.rototoon.parts) == parts + 1


def test_opening_and_saving_changes_no_drawing(addon, opened, live, file):
    opened.rototoon.live = True
    settle(live)
    opened.data.layers[studio.CONTOURS].lock = True
    before = studio.digests(addon, opened)
    path = str(file["folder"] / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    assert studio.digests(addon, opened) == before
    bpy.ops.wm.open_mainfile(filepath=path)
    ob = bpy.data.objects[studio.OBJECT]
    settle(live)
    assert studio.digests(addon, ob) == before


@pytest.mark.parametrize("make", [linked_file, overridden])
def test_live_leaves_objects_of_another_file(addon, opened, live, file, make):
    opened.rototoon.live = True
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(file["path"]).with_name("live.blend")))
    make({"path": str(Path(file["path"]).with_name("live.blend"))})
    ob = bpy.context.scene.objects[studio.OBJECT]
    assert ob.rototoon.live
    before = studio.digests(addon, ob)
    live.note(ob)
    settle(live)
    assert studio.digests(addon, ob) == before
    assert live.status(ob)[1] == "ERROR"


def test_live_leaves_shared_drawings(addon, opened, live):
    opened.rototoon.live = True
    settle(live)
    bpy.context.scene.collection.objects.link(opened.copy())
    shots.move(addon, opened, 1, 3, (6.0, 0.0))
    before = studio.digests(addon, opened)
    settle(live)
    assert studio.digests(addon, opened) == before and "shares its drawings" in live.status(opened)[0]
