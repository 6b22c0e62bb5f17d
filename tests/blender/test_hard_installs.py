"""Installs that go wrong, and places that are hard: each ends with a sentence that says what to do, and the extension can be removed."""

import contextlib
import hashlib
import importlib
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import bpy
import pytest
import shots

from conftest import MODULE, install

ZIP = os.environ.get("ROTOTOON_ZIP")
needs_zip = pytest.mark.skipif(not ZIP, reason="ROTOTOON_ZIP names no zip")

FROM_SYSTEM = """
import sys
import bpy
import addon_utils
addon_utils.enable("bl_pkg")
module = "bl_ext.system.rototoon"
assert addon_utils.enable(module, default_set=True), "not enabled"
import rototoon
assert rototoon.version() and not str(rototoon.library_path()).startswith(sys.argv[1])
assert bpy.ops.rototoon.setup(filepath=sys.argv[2]) == {"FINISHED"}
addon_utils.disable(module)
assert not dir(bpy.ops.rototoon)
print("done")
"""

FROM_BOTH = """
import os
import sys
import bpy
import addon_utils
addon_utils.enable("bl_pkg")
studio, own = "bl_ext.system.rototoon", "bl_ext.user_default.rototoon"
assert addon_utils.enable(studio, default_set=True), "not enabled"
import rototoon

def install():
    try:
        bpy.ops.extensions.package_install_files(filepath=sys.argv[1], repo="user_default", enable_on_install=True)
    except RuntimeError as error:
        print(error)
    hooks = [getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)]
    return sorted({hook.__module__.rpartition(".rototoon")[0] for found in hooks if isinstance(found, list) for hook in found
                   if "rototoon" in getattr(hook, "__module__", "")})

assert install() == ["bl_ext.system"], install()
assert sys.modules["rototoon"] is rototoon, "the studio's copy keeps its package"
folder = sys.argv[3]
bpy.ops.wm.save_as_mainfile(filepath=folder + "/a.blend")
assert bpy.ops.rototoon.setup(filepath=sys.argv[2]) == {"FINISHED"}
os.makedirs(folder + "/sub/deep")
bpy.ops.wm.save_as_mainfile(filepath=folder + "/sub/deep/b.blend")
assert os.path.samefile(bpy.path.abspath(bpy.context.object.rototoon.pattern) % 1, sys.argv[2])
addon_utils.disable(studio, default_set=True)
assert not dir(bpy.ops.rototoon)
assert addon_utils.enable(own, default_set=True) and dir(bpy.ops.rototoon)
assert not addon_utils.enable(studio), "the other way round"
addon_utils.disable(own, default_set=True)
assert not dir(bpy.ops.rototoon)
print("done")
"""


def altered(source: Path, target: Path, name: str, change) -> Path:
    """A copy of a zip with one file changed."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        assert name in old.namelist()
        for entry in old.namelist():
            data = old.read(entry)
            new.writestr(entry, change(data) if entry == name else data)
    return target


def try_to_install(path: Path) -> None:
    # Newer versions of Blender may raise what older ones only print.
    with contextlib.suppress(RuntimeError):
        bpy.ops.extensions.package_install_files(filepath=str(path), repo="user_default", enable_on_install=True)


@needs_zip
def test_a_blender_that_is_too_old_is_told_so(tmp_path, capfd):
    def newer(manifest: bytes) -> bytes:
        assert b'blender_version_min = "4.5.0"' in manifest
        return manifest.replace(b'blender_version_min = "4.5.0"', b'blender_version_min = "99.0.0"')

    try_to_install(altered(Path(ZIP), tmp_path / "newer.zip", "blender_manifest.toml", newer))
    said = "".join(capfd.readouterr())
    assert "doesn't meet the minimum supported version (99.0.0)" in said, said
    assert dir(bpy.ops.rototoon), "what was installed stays"


def test_with_a_library_that_does_not_load_it_registers_says_why_and_goes(addon, tmp_path, monkeypatch, library):
    import addon_utils

    damaged = tmp_path / "damaged.so"
    damaged.write_bytes(b"not a library " * 1000)
    addon_utils.disable(MODULE)
    monkeypatch.setenv("ROTOTOON_LIBRARY", str(damaged))
    try:
        assert addon_utils.enable(MODULE, default_set=True)
        shots.two_keys(addon, tmp_path)
        with pytest.raises(RuntimeError, match=r"cannot load .*damaged.so: .*install the package for"):
            bpy.ops.rototoon.track()
        addon_utils.disable(MODULE)
        assert not dir(bpy.ops.rototoon)
    finally:
        monkeypatch.undo()
        addon_utils.enable(MODULE, default_set=True)
    assert importlib.import_module("rototoon").version()


def test_an_update_leaves_a_running_job_its_library(library):
    before = importlib.import_module("rototoon")
    footage = {"pattern": "f_%d.png", "first": 0, "last": 1, "fps": 12, "width": 8, "height": 8}
    with before.Session.from_document({"rototoon": 1, "footage": footage, "parts": []}, ".") as session:
        install()
        after = importlib.import_module("rototoon")
        assert after is not before and after.version()
        assert session.parts() == [], "the old library still answers"
    assert after.version()


@needs_zip
def test_a_read_only_system_repository_serves(tmp_path):
    installed = tmp_path / "extensions/system/rototoon"
    installed.mkdir(parents=True)
    with zipfile.ZipFile(ZIP) as file:
        file.extractall(installed)
    for path in [installed, *installed.rglob("*")]:
        path.chmod(0o555 if path.is_dir() else 0o444)

    def files() -> dict[str, str]:
        found = [path for path in installed.rglob("*") if path.is_file()]
        return {str(path): hashlib.sha256(path.read_bytes()).hexdigest() for path in found}

    before = files()
    own = os.environ | {
        "BLENDER_USER_RESOURCES": str(tmp_path / "user"),
        "BLENDER_SYSTEM_EXTENSIONS": str(tmp_path / "extensions"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    footage = shots.draw_sequence(tmp_path / "frames")
    words = [sys.executable, "-c", FROM_SYSTEM, str(installed), str(footage)]
    run = subprocess.run(words, cwd=tmp_path, env=own, capture_output=True, text=True, check=False, timeout=300)
    assert run.returncode == 0 and run.stdout.strip().endswith("done"), run.stdout + run.stderr
    assert files() == before


@needs_zip
def test_a_second_copy_from_another_repository_is_refused(tmp_path):
    """The studio's copy is switched on; the artist's own one would change the footage's paths a second time at each save."""
    with zipfile.ZipFile(ZIP) as file:
        file.extractall(tmp_path / "extensions/system/rototoon")
    own = os.environ | {"BLENDER_USER_RESOURCES": str(tmp_path / "user"), "BLENDER_SYSTEM_EXTENSIONS": str(tmp_path / "extensions")}
    footage = shots.draw_sequence(tmp_path / "frames")
    words = [sys.executable, "-c", FROM_BOTH, ZIP, str(footage), str(tmp_path)]
    run = subprocess.run(words, cwd=tmp_path, env=own, capture_output=True, text=True, check=False, timeout=300)
    assert run.returncode == 0 and run.stdout.strip().endswith("done"), run.stdout + run.stderr
    told = 'Rototoon is switched on already, from the repository "{}": switch that copy off first'
    assert all(told.format(name) in run.stdout + run.stderr for name in ("system", "user_default")), run.stdout + run.stderr
