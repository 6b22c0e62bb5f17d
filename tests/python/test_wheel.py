"""The wheel: what is in it, and that it works where nothing else is installed. `ROTOTOON_WHEEL` names it."""

import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

WHEEL = os.environ.get("ROTOTOON_WHEEL")
pytestmark = pytest.mark.skipif(not WHEEL, reason="ROTOTOON_WHEEL names no wheel")
VERSIONS = ["3.11", "3.12", "3.13"]
WORKSPACE = tomllib.loads((Path(__file__).parents[2] / "Cargo.toml").read_text())["workspace"]["package"]["version"]

USE = """
from array import array
from pathlib import Path
import rototoon
from rototoon import RototoonError, Session, Strokes, fit_strokes
assert rototoon.library_path().parent == Path(rototoon.__file__).parent / "native", rototoon.library_path()
assert (Path(rototoon.__file__).parent / "py.typed").exists()
points = memoryview(array("d", [10, 10, 30, 12, 50, 10, 70, 14])).cast("B").cast("d", (4, 2))
guides = fit_strokes(Strokes(array("i", [0, 4]), points, array("B", [0])), tolerance=1.0)
assert len(guides.points) >= 2
footage = {"pattern": "f_%d.png", "first": 0, "last": 1, "fps": 12, "width": 8, "height": 8}
with Session.from_document({"rototoon": 1, "footage": footage, "parts": []}, ".") as session:
    assert session.parts() == []
try:
    Session.open("gone.json")
except RototoonError as error:
    assert "gone.json" in str(error)
else:
    raise AssertionError("opened a file that is not there")
print(rototoon.__version__, rototoon.version())
"""


def interpreter(version: str) -> Path | None:
    """A Python of this version: the running one, one on the search path, or one of pyenv's."""
    if "%d.%d" % sys.version_info[:2] == version:
        return Path(sys.executable)
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    found = [Path(name) for name in [shutil.which(f"python{version}")] if name]
    for path in [*found, *sorted(pyenv.glob(f"{version}.*/bin/python"))]:
        asked = [str(path), "-c", "import ensurepip, sys; print('%d.%d' % sys.version_info[:2])"]
        run = subprocess.run(asked, capture_output=True, text=True, check=False)
        if run.stdout.strip() == version:
            return path
    return None


@pytest.mark.parametrize("version", VERSIONS)
def test_the_wheel_installs_and_works_alone(tmp_path, version):
    python = interpreter(version)
    if python is None:
        pytest.skip(f"no Python {version} was found")
    subprocess.run([str(python), "-m", "venv", str(tmp_path / "venv")], check=True)
    inside = tmp_path / "venv" / ("Scripts" if sys.platform == "win32" else "bin") / "python"
    pip = [str(inside), "-m", "pip", "install", "--quiet", "--no-index", "--disable-pip-version-check", str(WHEEL)]
    installed = subprocess.run(pip, capture_output=True, text=True, check=False)
    assert installed.returncode == 0, installed.stderr
    clean = {name: value for name, value in os.environ.items() if not name.startswith(("ROTOTOON", "PYTHON"))}
    run = subprocess.run([str(inside), "-c", USE], cwd=tmp_path, env=clean, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    package, native = run.stdout.split()
    assert package.replace("-dev", ".dev") == Path(str(WHEEL)).name.split("-")[1]
    # The library that the Rust tests use is linked once for many builds of the package, so it has the version of the workspace.
    assert native in (package, WORKSPACE)


def test_the_wheel_has_library_licences_and_types():
    with zipfile.ZipFile(str(WHEEL)) as file:
        names = file.namelist()
        notices = file.read("rototoon/native/licences/THIRD-PARTY.txt").decode()
    assert sum(name.endswith((".so", ".dll", ".dylib")) for name in names) == 1
    assert {"rototoon/py.typed", "rototoon/native/licences/LICENSE"} <= set(names)
    assert "\nrayon " in notices and "Permission is hereby granted" in notices
    assert not any(name.endswith(".pyc") or name.startswith(("tests", "blender")) for name in names)
