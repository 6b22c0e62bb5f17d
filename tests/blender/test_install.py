"""The zip installs, can be switched off and on, and its manifest is right."""

import bpy
import tomllib

from conftest import ADDON, MODULE, blender_ext


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
    assert manifest["platforms"] == ["linux-x64"]
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
