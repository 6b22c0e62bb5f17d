"""The zip installs, can be switched off and on, and its manifest is right."""

import contextlib
import importlib
import os
import sys
import zipfile
from pathlib import Path

import bpy
import pytest
import tomllib

from conftest import ADDON, MODULE, blender_ext, install

pytestmark = pytest.mark.every_version


def test_operators_are_there_and_described():
    names = dir(bpy.ops.rototoon)
    assert {"setup", "track", "snap", "new_key", "import_document", "export_document"} <= set(names)
    for name in names:
        kind = getattr(bpy.ops.rototoon, name).get_rna_type()
        assert len(kind.description) > 20, name
        for prop in kind.properties:
            assert prop.identifier == "rna_type" or prop.is_hidden or prop.description, f"{name}.{prop.identifier}"


def test_disable_and_enable_again():
    import addon_utils

    addon_utils.disable(MODULE)
    assert not hasattr(bpy.types.Object, "rototoon")
    addon_utils.enable(MODULE, default_set=True)
    assert hasattr(bpy.types.Object, "rototoon")
    assert MODULE in bpy.context.preferences.addons


def test_operators_say_why_they_cannot_run(addon):
    assert not bpy.ops.rototoon.track.poll()
    try:
        bpy.ops.rototoon.track()
    except RuntimeError as error:
        assert "Grease Pencil object" in str(error)
    else:
        raise AssertionError("ran without an object")


def test_manifest():
    import subprocess
    import sys

    manifest = tomllib.loads((ADDON / "blender_manifest.toml").read_text())
    assert manifest["platforms"] == ["linux-x64", "windows-x64", "macos-arm64"]
    assert manifest["blender_version_min"] == "4.5.0"
    run = subprocess.run(
        [sys.executable, str(blender_ext()), "validate", str(ADDON)], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr


def test_session_imports_without_blender(tmp_path):
    import subprocess
    import sys

    code = "import sys; from rototoon import Session; assert 'bpy' not in sys.modules"
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env={"PYTHONPATH": str(ADDON)}, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr


def handlers_of_rototoon() -> list[str]:
    lists = {name: getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers) if not name.startswith("_")}
    found = [(name, function) for name, functions in lists.items() if isinstance(functions, list) for function in functions]
    return [name for name, function in found if "rototoon" in getattr(function, "__module__", "")]


def test_switched_off_it_leaves_no_trace():
    import addon_utils

    package = sys.modules["rototoon"]
    assert handlers_of_rototoon()
    addon_utils.disable(MODULE)
    try:
        assert not handlers_of_rototoon() and not dir(bpy.ops.rototoon)
        assert sys.modules["rototoon.native.library"]._loaded is None
    finally:
        addon_utils.enable(MODULE, default_set=True)
    assert handlers_of_rototoon() and dir(bpy.ops.rototoon)
    assert sys.modules["rototoon"] is package, "the extension's modules and scripts share one package"


def test_an_update_takes_effect_while_blender_runs(library):
    before = importlib.import_module("rototoon")
    assert before.version()
    install()
    after = importlib.import_module("rototoon")
    assert after is not before and after.version() == before.version()
    assert after.library_path().is_file()


def test_nothing_is_written_into_the_installed_folder():
    assert not bpy.app.online_access  # the whole suite works without a network
    packed = zipfile.ZipFile(os.environ["ROTOTOON_ZIP"]).namelist() if "ROTOTOON_ZIP" in os.environ else None
    if packed is None:
        pytest.skip("ROTOTOON_ZIP names no zip")
    folder = Path(sys.modules[MODULE].__file__).parent
    files = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts}
    assert files <= set(packed)


def test_the_zip_of_another_system_is_refused_with_a_reason(tmp_path, capfd):
    named = os.environ.get("ROTOTOON_ZIP")
    if not named:
        pytest.skip("ROTOTOON_ZIP names no zip")
    other = tmp_path / "rototoon-other.zip"
    with zipfile.ZipFile(named) as source, zipfile.ZipFile(other, "w") as target:
        for name in source.namelist():
            data = source.read(name)
            if name == "blender_manifest.toml":
                data = data.replace(b'"linux-x64"', b'"windows-arm64"')
            target.writestr(name, data)
    # Newer versions of Blender may raise what older ones only print.
    with contextlib.suppress(RuntimeError):
        bpy.ops.extensions.package_install_files(filepath=str(other), repo="user_default", enable_on_install=True)
    assert "isn't one of (windows-arm64)" in "".join(capfd.readouterr())
    assert dir(bpy.ops.rototoon), "what was installed stays"
