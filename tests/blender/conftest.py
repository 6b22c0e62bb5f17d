"""Installs the built extension into a fresh Blender (the `bpy` wheel) and gives each test an empty file.

`ROTOTOON_ZIP` names the zip to test; without it the add-on's folder is packed as it is, for work on the add-on itself.
"""

import importlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ADDON = ROOT / "blender-addon"
MODULE = "bl_ext.user_default.rototoon"
_RESOURCES = tempfile.mkdtemp(prefix="rototoon-blender-")
os.environ["BLENDER_USER_RESOURCES"] = _RESOURCES
sys.path.insert(0, str(Path(__file__).resolve().parent))

import bpy  # noqa: E402 - after its folders are set


def blender_ext() -> Path:
    """Blender's own tool that builds and validates extensions."""
    found = Path(bpy.utils.resource_path("LOCAL")) / "scripts/addons_core/bl_pkg/cli/blender_ext.py"
    assert found.is_file(), found
    return found


def build_zip(folder: Path) -> Path:
    """Packs the add-on's folder as it is."""
    target = folder / "rototoon.zip"
    command = [sys.executable, blender_ext(), "build", "--source-dir", ADDON, "--output-filepath", target]
    run = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return target


def install() -> None:
    """Installs and enables the zip; Blender says FINISHED even if that failed, so the module is looked at."""
    import addon_utils

    named = os.environ.get("ROTOTOON_ZIP")
    if not named:
        # The folder holds no wheel of the Python package.
        sys.path.insert(0, str(ADDON))
    path = Path(named) if named else build_zip(Path(_RESOURCES))
    addon_utils.enable("bl_pkg")
    bpy.ops.extensions.package_install_files(filepath=str(path), repo="user_default", enable_on_install=True)
    assert MODULE in bpy.context.preferences.addons, f"{path} was not installed and enabled"


def pytest_configure(config):
    config.addinivalue_line("markers", "every_version: runs in each Blender, also in those before the newest one")
    install()


def pytest_collection_modifyitems(config, items):
    """Of a Blender before the newest one: what calls every operator or depends on the version, and the first test of each other file."""
    if os.environ.get("ROTOTOON_TESTS") != "sample":
        return
    seen, kept, left = set(), [], []
    for item in items:
        is_first = item.path not in seen
        seen.add(item.path)
        (kept if is_first or item.get_closest_marker("every_version") else left).append(item)
    config.hook.pytest_deselected(items=left)
    items[:] = kept


def pytest_unconfigure(config):
    # Blender 4.5 never returns from its exit once something was undone.
    shutil.rmtree(_RESOURCES, ignore_errors=True)
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(getattr(config, "rototoon_status", 0))


def pytest_sessionfinish(session, exitstatus):
    session.config.rototoon_status = int(exitstatus)


def module(name: str):
    """A module of the installed add-on, or of the Python package that comes with it."""
    if name.partition(".")[0] == "rototoon":
        return importlib.import_module(name)
    return importlib.import_module(f"{MODULE}.{name}")


@pytest.fixture
def addon():
    """Loads modules of the installed add-on by name."""
    return module


@pytest.fixture(autouse=True)
def empty_file():
    """An empty file before each test; `read_factory_settings` would disable the add-on."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    sessions, tracing, filling = module("capture.sessions"), module("lines.tracing"), module("paint.filling")
    make, matcher, tracer, painter = sessions.make, sessions.matcher, tracing.make, filling.make
    yield
    sessions.clear()
    sessions.make, sessions.matcher, tracing.make, filling.make = make, matcher, tracer, painter


@pytest.fixture
def fake(addon):
    """Puts a session into the add-on that blends the keys, and counts what it solves."""
    import stand_in

    sessions = addon("capture.sessions")
    sessions.make = stand_in.Session.from_document
    sessions.matcher = stand_in.match_contours
    addon("lines.tracing").make = stand_in.Tracer.from_document
    addon("paint.filling").make = stand_in.Painter.from_document
    return stand_in


@pytest.fixture
def live(addon):
    """The module of the live mode, left without anything due. What a step can do, it does in one, however slow the machine is."""
    found = addon("capture.live")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(found, "SLICE", 60.0)
        yield found
    found.reset()


@pytest.fixture
def library(addon):
    """Skips where the installed extension has no native library."""
    try:
        addon("rototoon").version()
    except Exception as error:  # noqa: BLE001 - the reason is told
        pytest.skip(f"no native library in the extension: {error}")
