"""One build installed over another takes its place; a package of another build is told of."""

import contextlib
import importlib
import io
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import bpy
import pytest

from conftest import MODULE, install

ZIP = os.environ.get("ROTOTOON_ZIP")
pytestmark = pytest.mark.skipif(not ZIP, reason="ROTOTOON_ZIP names no zip")
MARK = re.compile(rb'^BUILD = ".*"$', re.MULTILINE)


def copied(source, target, change) -> None:
    """Copies a zip. `change` gets the name and the content of each file, and returns those of the copy."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            new.writestr(*change(name, old.read(name)))


def marked(version: str):
    """A change that tells the Python file of a build another version."""
    line = f'BUILD = "{version}"'.encode()
    return lambda name, data: (name, MARK.sub(line, data) if name.rpartition("/")[2] == "build.py" else data)


def other_build(target: Path, version: str) -> Path:
    """The zip that `xtask bundle` would make of other sources."""
    wheel_version = version.replace("-dev", ".dev")

    def wheel(name: str, data: bytes) -> tuple[str, bytes]:
        old = re.search(r"rototoon-(.+?)-py3", next(name for name in zipfile.ZipFile(ZIP).namelist() if name.endswith(".whl")))[1]
        if ".dist-info/" in name:
            data = data.replace(f"rototoon-{old}.dist-info".encode(), f"rototoon-{wheel_version}.dist-info".encode())
            data = data.replace(f"Version: {old}".encode(), f"Version: {wheel_version}".encode())
        return marked(version)(name.replace(f"rototoon-{old}.dist-info", f"rototoon-{wheel_version}.dist-info"), data)

    def extension(name: str, data: bytes) -> tuple[str, bytes]:
        if name.endswith(".whl"):
            inner = io.BytesIO()
            copied(io.BytesIO(data), inner, wheel)
            return re.sub("rototoon-.+?-py3", f"rototoon-{wheel_version}-py3", name), inner.getvalue()
        if name == "blender_manifest.toml":
            data = re.sub(rb'^version = ".*"', f'version = "{version}"'.encode(), data, flags=re.MULTILINE)
            data = re.sub(rb"rototoon-[^/]+?-py3", f"rototoon-{wheel_version}-py3".encode(), data)
        return marked(version)(name, data)

    copied(ZIP, target, extension)
    return target


def put(path: Path) -> tuple[str, str]:
    """Installs a zip over what is there. Returns the builds of the extension and of the package."""
    bpy.ops.extensions.package_install_files(filepath=str(path), repo="user_default", enable_on_install=True)
    return importlib.import_module(f"{MODULE}.build").BUILD, importlib.import_module("rototoon").__version__


def test_a_build_installed_over_another_takes_its_place(tmp_path, library):
    """Blender leaves the files of a wheel whose version is there already, so each build has a version of its own."""
    before = importlib.import_module("rototoon")
    try:
        for version in ("99.0.0-dev20300101000000+h00000001", "99.0.0-dev20300101000000+h00000002", "98.0.0"):
            assert put(other_build(tmp_path / "other.zip", version)) == (version, version)
            assert importlib.import_module("rototoon").version() == before.version(), "with its library"
    finally:
        install()
    assert importlib.import_module("rototoon").__version__ == before.__version__


def test_a_package_of_another_build_is_told_of(tmp_path):
    """As where Blender could not replace the package, or a script imported its own."""
    copied(ZIP, tmp_path / "other.zip", marked("99.0.0"))
    try:
        with contextlib.suppress(RuntimeError), contextlib.redirect_stderr(io.StringIO()) as said, contextlib.redirect_stdout(said):
            try:
                put(tmp_path / "other.zip")
            except Exception as error:
                said.write(str(error))
                raise
    finally:
        install()
    found = importlib.import_module("rototoon")
    told = said.getvalue()
    assert "The extension is Rototoon 99.0.0, but the Python package in " in told and str(Path(found.__file__).parent) in told, told
    assert f"is of another build, {found.__version__}: restart Blender" in told and "ImportError" not in told, told
    assert dir(bpy.ops.rototoon)


OWN_PACKAGE = """
import sys
import bpy
import addon_utils
addon_utils.enable("bl_pkg")
import rototoon
try:
    bpy.ops.extensions.package_install_files(filepath=sys.argv[1], repo="user_default", enable_on_install=True)
except RuntimeError as error:
    print(error)
print("operators:", len(dir(bpy.ops.rototoon)))
"""


def test_a_script_with_a_package_of_another_build_is_told_its_place(tmp_path):
    package = tmp_path / "own/rototoon"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("def version(): return '0.1.0'\n")
    own = os.environ | {"BLENDER_USER_RESOURCES": str(tmp_path / "user"), "PYTHONPATH": str(tmp_path / "own")}
    words = [sys.executable, "-c", OWN_PACKAGE, ZIP]
    run = subprocess.run(words, cwd=tmp_path, env=own, capture_output=True, text=True, check=False, timeout=300)
    told = run.stdout + run.stderr
    assert f"the Python package in {package} is of another build, an earlier one: restart Blender" in told, told
    assert "operators: 0" in told and "ImportError" not in told, told
