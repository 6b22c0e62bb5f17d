"""Every operator on files in odd states: it works, or says why not. No state may end in a Python error.

`studio` has the operators and what each needs. A state is what an artist or a script may leave behind: a squashed layer, a camera that moves or is
gone, drawings without strokes, points without a place, names that clash.
"""

import bpy
import numpy as np
import pytest
import shots
import studio
from studio import OPERATORS

pytestmark = pytest.mark.every_version

SLOW = {"open_sample"}


def drawings(addon, ob):
    """All drawings that have strokes, with the number of these."""
    gp = addon("blender.grease_pencil")
    found = ((handle, len(gp.offsets(handle)) - 1) for layer in ob.data.layers for handle in gp.handles(layer))
    return [(handle, count) for handle, count in found if count]


def squashed_object(_addon, ob):
    ob.scale = (0, 1, 1)


def squashed_layers(_addon, ob):
    for layer in ob.data.layers:
        layer.scale = (1, 0, 1)


def mirrored_and_turned(_addon, ob):
    ob.scale, ob.rotation_euler = (-1, 2, 0.5), (0.3, 0.2, 1)


def edge_on(_addon, ob):
    ob.rotation_euler.z = np.pi / 2


def without_camera(_addon, ob):
    if bpy.context.scene.camera is not None:
        bpy.data.objects.remove(bpy.context.scene.camera)
    ob.rototoon.camera = None


def panorama(_addon, _ob):
    bpy.context.scene.camera.data.type = "PANO"


def moving_camera(_addon, _ob):
    bpy.context.scene.camera.keyframe_insert("location", frame=1)


def moving_camera_and_one_drawing(addon, ob):
    moving_camera(addon, ob)
    for layer in ob.data.layers:
        for number in [frame.frame_number for frame in layer.frames][1:]:
            layer.frames.remove(number)


def moving_layers(_addon, ob):
    for layer in ob.data.layers:
        layer.keyframe_insert("translation", frame=1)


def without_layers(_addon, ob):
    for layer in list(ob.data.layers):
        ob.data.layers.remove(layer)


def group_active(_addon, ob):
    ob.data.layer_groups.active = ob.data.layer_groups.new("Group")


def empty_drawings(addon, ob):
    for handle, count in drawings(addon, ob):
        handle.remove_strokes(indices=list(range(count)))


def single_points(addon, ob):
    for handle, count in drawings(addon, ob):
        handle.resize_strokes(sizes=[1] * count, indices=list(range(count)))


def points_without_a_place(addon, ob):
    gp = addon("blender.grease_pencil")
    for handle, _ in drawings(addon, ob):
        points = gp.positions(handle, int(gp.offsets(handle)[-1]))
        points[0] = np.nan
        gp.put(handle, "position", points)


def bezier_curves(addon, ob):
    for handle, count in drawings(addon, ob):
        handle.set_types(type="BEZIER", indices=list(range(count)))


def shared_drawings(_addon, ob):
    for layer in ob.data.layers:
        layer.frames.copy(layer.frames[0].frame_number, 40, instance_drawing=True)


def empty_material_slot(_addon, ob):
    ob.data.materials.clear()
    ob.data.materials.append(None)


def one_layer_for_everything(_addon, ob):
    settings = ob.rototoon
    settings.snapped_layer = settings.lines_layer = settings.fills_layer = settings.contours_layer


def before_frame_zero(_addon, _ob):
    bpy.context.scene.frame_set(-3, subframe=0.5)


def damaged_texts(_addon, ob):
    ob.rototoon.extra = '{"limbs": 3, "footage": [1], "depth_marks": {}, "parts": 4, "skeleton": 7}'
    for name in ("rototoon_tween", "rototoon_lines", "rototoon_slots"):
        ob.data[name] = '{"Ink": 3}'


STATES = (
    squashed_object, squashed_layers, mirrored_and_turned, edge_on, without_camera, panorama, moving_camera, moving_camera_and_one_drawing, moving_layers,
    without_layers, group_active, empty_drawings, single_points, points_without_a_place, bezier_curves, shared_drawings, empty_material_slot,
    one_layer_for_everything, before_frame_zero, damaged_texts,
)  # fmt: skip


LAST = ("conform", "drive_bones", "footage_from_camera", "footage_from_file", "footage_from_reference", "import_document", "setup")
"""Operators that change more than the object: the armature, the scene, its camera. They are called after all others."""


FRAMES = 4
"""Few frames and points: which calls fail does not depend on how many there are."""


class Stage:
    """One small file for all operators. To open it before each call would take longer than all calls.

    Each preparation is done once, on an object of its own that is in no scene. A call gets a copy of it, which goes afterwards.
    """

    def __init__(self, addon, folder):
        self._addon, self.folder = addon, folder
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(shots, "COUNT", FRAMES)
            self.path = studio.build(addon, folder, FRAMES, (16, 12))
        self._bases: dict = {}
        ob = bpy.data.objects[studio.OBJECT]
        ob.name, ob.use_fake_user = "base", True
        prepares = {call.prepare: None for call in OPERATORS.values() if call.on == studio.OBJECT}
        for prepare in prepares:
            self._prepare(ob, prepare)
        bpy.context.scene.collection.objects.unlink(ob)
        bpy.ops.wm.save_as_mainfile(filepath=self.path)

    def _prepare(self, ob, prepare):
        made = self._placed(ob)
        prepare(self._addon, made)
        bpy.context.view_layer.update()
        chosen = [other.name for other in bpy.context.selected_objects if other != made]
        made.name, made.use_fake_user = f"base {len(self._bases)}", True
        self._bases[prepare] = made.name, bpy.context.scene.frame_current, chosen
        for collection in made.users_collection:
            collection.objects.unlink(made)

    def _placed(self, base):
        """A copy of an object, in the scene and active."""
        ob = base.copy()
        ob.data, ob.name = base.data.copy(), studio.OBJECT
        bpy.context.scene.collection.objects.link(ob)
        return studio.activate(ob)

    def open(self):
        bpy.ops.wm.open_mainfile(filepath=self.path)

    def taken(self, name):
        """The object on which an operator is called, prepared for it."""
        call = OPERATORS[name]
        base, frame, chosen = self._bases.get(call.prepare, ("base", 1, []))
        ob = self._placed(bpy.data.objects[base])
        if frame != bpy.context.scene.frame_current:
            bpy.context.scene.frame_set(frame)
        for other in chosen:
            bpy.data.objects[other].select_set(True)
        if call.on != studio.OBJECT:
            studio.activate(bpy.data.objects[call.on])
            call.prepare(self._addon, ob)
        return ob


@pytest.fixture(scope="session")
def kept():
    """The stage of all tests, once the first one has made it."""
    return {}


@pytest.fixture
def stage(addon, library, fake, kept, tmp_path_factory):
    if "stage" not in kept:
        kept["stage"] = Stage(addon, tmp_path_factory.mktemp("odd"))
    kept["stage"].open()
    edit = bpy.context.preferences.edit
    # An undo step of the whole file after each call takes a tenth of the time, and nothing is undone.
    edit.use_global_undo = False
    yield kept["stage"]
    edit.use_global_undo = True


@pytest.mark.parametrize("state", STATES, ids=lambda state: state.__name__)
def test_no_operator_ends_in_a_python_error(addon, stage, state):
    for name in (*sorted(OPERATORS.keys() - SLOW - set(LAST)), *LAST):
        ob = stage.taken(name)
        state(addon, ob)
        bpy.context.view_layer.update()
        try:
            studio.call(name, stage.folder)
        except RuntimeError as error:
            assert "Traceback" not in str(error), name
        addon("capture.stand").read(ob)
        addon("ui.overlay").gather(ob, 2)
        addon("ui.overlay").doubtful(ob, 2)
        bpy.data.batch_remove([ob, ob.data])
