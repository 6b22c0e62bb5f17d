"""The settings of the extension, and the folders that it makes."""

import os
from pathlib import Path

import bpy
import pytest
import shots

from conftest import MODULE
from test_footage import make_movie


@pytest.fixture
def chosen(addon):
    """The settings; the Cache Folder is empty again afterwards."""
    preferences = addon("blender.preferences").preferences()
    yield preferences
    preferences.cache_folder = ""


@pytest.fixture
def movie(tmp_path):
    """A short movie."""
    make_movie(tmp_path / "shot.mp4", sorted(shots.draw_sequence(tmp_path / "frames").parent.iterdir())[:2])
    return str(tmp_path / "shot.mp4")


def test_without_an_entry_in_the_preferences_the_defaults_hold(addon, fake, tmp_path):
    """`blender --addons` and `addon_utils.enable` switch an extension on without an entry."""
    import addon_utils

    addon_utils.disable(MODULE, default_set=True)
    try:
        assert addon_utils.enable(MODULE)
        assert MODULE not in bpy.context.preferences.addons
        settings = addon("blender.preferences").preferences()
        assert (settings.threads, settings.cache_folder, settings.cache_limit, settings.clips_folder) == (0, "", 4096, "")
        addon("capture.sessions").make = fake.Session.from_document
        shots.two_keys(addon, tmp_path)
        assert bpy.ops.rototoon.track() == {"FINISHED"}
        addon_utils.disable(MODULE)
    finally:
        addon_utils.enable(MODULE, default_set=True)
    assert MODULE in bpy.context.preferences.addons


def test_a_user_folder_that_cannot_be_made_is_named(addon, movie, tmp_path, monkeypatch):
    """Nothing is written to the current folder in its place."""
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(bpy.utils, "extension_path_user", lambda _package, path="", create=False: f"{tmp_path}/file/{path}")
    with pytest.raises(RuntimeError, match=r"Cannot make the folder .*file/sample for the extension's own files: Not a directory"):
        bpy.ops.rototoon.open_sample()
    with pytest.raises(RuntimeError, match=r"Cannot make the Cache Folder .*file/movies: Not a directory; choose another one in the pref"):
        bpy.ops.rototoon.setup(filepath=movie)
    assert not list(here.iterdir())


def test_a_cache_folder_that_says_not_where_it_is_is_refused(addon, chosen, movie, tmp_path, monkeypatch):
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    chosen.cache_folder = "//movies"
    with pytest.raises(RuntimeError, match="The Cache Folder //movies is relative to a file that is not saved"):
        bpy.ops.rototoon.setup(filepath=movie)
    chosen.cache_folder = "movies"
    # Blender may make it a whole path itself.
    if chosen.cache_folder == "movies":
        with pytest.raises(RuntimeError, match="Found 'movies' as Cache Folder, expected a whole path"):
            bpy.ops.rototoon.setup(filepath=movie)
    assert not list(here.iterdir())
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("USERPROFILE", str(tmp_path / "home"))
    chosen.cache_folder = "~/m"
    assert bpy.ops.rototoon.setup(filepath=movie) == {"FINISHED"}
    pattern = Path(addon("blender.footage").pattern_of(bpy.context.object))
    assert pattern.parent.parent == tmp_path / "home/m" and not list(here.iterdir())
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    chosen.cache_folder = "//movies"
    assert bpy.ops.rototoon.setup(filepath=movie) == {"FINISHED"}
    assert (tmp_path / "movies").is_dir()


def test_a_cache_folder_that_cannot_be_made_is_named(addon, fake, chosen, movie, tmp_path):
    (tmp_path / "file").write_text("")
    for folder, reason in ((tmp_path / "file/cache", "Not a directory"), (tmp_path / "file", "File exists")):
        chosen.cache_folder = str(folder)
        with pytest.raises(RuntimeError, match=rf"Cannot make the Cache Folder {folder}: {reason}; choose another one"):
            bpy.ops.rototoon.setup(filepath=movie)
    # What needs no cache works.
    shots.two_keys(addon, tmp_path / "other")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    os.makedirs(tmp_path / "farm")
    assert bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm")) == {"FINISHED"}


def test_a_clip_library_in_the_home_folder(addon, monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    assert Path(addon("style.clip_library").folder_of(None, "~/clips")) == tmp_path / "clips"
