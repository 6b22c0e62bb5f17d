"""Objects with footage that are copied and pasted, within a file and into another one."""

from pathlib import Path

import bpy
import pytest
import shots


def select(*objects):
    for ob in bpy.context.view_layer.objects:
        ob.select_set(ob in objects)


@pytest.fixture
def copied(tmp_path, request):
    """Footage with a relative path, copied to the clipboard. The camera or the reference image comes along, since the object has it."""
    ob = shots.set_up(tmp_path, plane=request.param)
    (tmp_path / "home").mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "home/shot.blend"))
    assert ob.rototoon.pattern == "//../frames/shot_%03d.png"
    select(ob)
    bpy.ops.view3d.copybuffer()
    return ob.name


def pasted(name):
    """The object that is pasted into the open file."""
    before = set(bpy.data.objects)
    bpy.ops.view3d.pastebuffer()
    return next(ob for ob in bpy.data.objects if ob not in before and ob.type == "GREASEPENCIL" and ob.name.startswith(name))


@pytest.mark.parametrize("copied", ["CAMERA", "REFERENCE"], indirect=True)
def test_in_the_same_file(copied):
    assert pasted(copied).rototoon.pattern == "//../frames/shot_%03d.png"


@pytest.mark.parametrize("copied", ["CAMERA", "REFERENCE"], indirect=True)
@pytest.mark.parametrize("place", ["other/deep", ""])
def test_in_another_file(addon, tmp_path, copied, place):
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    if place:
        (tmp_path / place).mkdir(parents=True)
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / place / "other.blend"))
    ob = pasted(copied)
    assert ob.rototoon.pattern == ("//../../frames/shot_%03d.png" if place else str(tmp_path / "frames/shot_%03d.png"))
    assert Path(addon("blender.footage").pattern_of(ob) % 1).is_file()


@pytest.mark.parametrize("copied", ["CAMERA"], indirect=True)
def test_without_pictures_in_the_background_the_file_itself_is_looked_beside(copied):
    bpy.data.objects[copied].rototoon.camera = None
    select(bpy.data.objects[copied])
    bpy.ops.view3d.copybuffer()
    assert pasted(copied).rototoon.pattern == "//../frames/shot_%03d.png"


@pytest.mark.parametrize("copied", ["CAMERA"], indirect=True)
def test_pictures_of_another_name_tell_nothing(tmp_path, copied):
    ob = bpy.data.objects[copied]
    other = shots.draw_sequence(tmp_path / "elsewhere", "take_%03d.png")
    ob.rototoon.camera.data.background_images[0].image.filepath = str(other)
    select(ob)
    bpy.ops.view3d.copybuffer()
    assert pasted(copied).rototoon.pattern == "//../frames/shot_%03d.png"


@pytest.fixture
def absolute():
    """Blender's preferences want no relative paths."""
    bpy.context.preferences.filepaths.use_relative_paths = False
    yield
    bpy.context.preferences.filepaths.use_relative_paths = True


def saved(path, **options):
    path.parent.mkdir(exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(path), **options)


def test_who_wants_no_relative_paths_gets_none(absolute, tmp_path):
    saved(tmp_path / "home/shot.blend")
    ob = shots.set_up(tmp_path)
    pattern = str(tmp_path / "frames/shot_%03d.png")
    assert ob.rototoon.pattern == pattern
    saved(tmp_path / "other/shot.blend")
    assert ob.rototoon.pattern == pattern


@pytest.mark.parametrize("remap", [False, True])
def test_a_relative_path_goes_along_to_another_folder(absolute, tmp_path, remap):
    ob = shots.set_up(tmp_path)
    saved(tmp_path / "home/shot.blend")
    ob.rototoon.pattern = "//../frames/shot_%03d.png"
    (tmp_path / "other").mkdir()
    saved(tmp_path / "other/deep/shot.blend", relative_remap=remap)
    assert ob.rototoon.pattern == "//../../frames/shot_%03d.png"
