"""Loading the native library, and what is said when it does not fit."""

import ctypes
import os
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ADDON, PACKAGE
from rototoon import LibraryError
from rototoon.native import _bindings, library


def test_package_is_imported_by_name_without_blender(tmp_path):
    code = "import sys; from rototoon import version; print(version(), 'bpy' in sys.modules)"
    environment = os.environ | {"PYTHONPATH": str(ADDON), "PYTHONDONTWRITEBYTECODE": "1"}
    run = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert run.stdout.split()[1] == "False"


def test_library_is_beside_the_package_unless_named(monkeypatch):
    monkeypatch.setenv(library.ENVIRONMENT, "/elsewhere/lib.so")
    assert library.find() == Path("/elsewhere/lib.so")
    monkeypatch.delenv(library.ENVIRONMENT)
    assert library.find().parent == PACKAGE / "native"
    assert "rototoon_capi" in library.find().name


def test_every_function_of_the_header_is_declared():
    functions = library.load().functions
    assert functions.rototoon_session_track.argtypes[3] is _bindings.RototoonProgress
    assert functions.rototoon_header_hash.restype is ctypes.c_uint64


def test_missing_and_foreign_libraries_are_named(tmp_path):
    with pytest.raises(LibraryError, match="no native library at .*gone.so"):
        library._open(tmp_path / "gone.so")
    text = tmp_path / "text.so"
    text.write_text("not a library")
    with pytest.raises(LibraryError, match="cannot load .*text.so"):
        library._open(text)
    foreign = pytest.importorskip("_ctypes").__file__
    with pytest.raises(LibraryError, match="is not a Rototoon library"):
        library._open(Path(foreign))


@pytest.mark.parametrize(
    ("constant", "message"),
    [("ROTOTOON_ABI_VERSION", "has ABI version"), ("HEADER_HASH", "was built with header")],
)
def test_library_of_another_build_is_refused(monkeypatch, constant, message):
    monkeypatch.setattr(_bindings, constant, getattr(_bindings, constant) + 1)
    with pytest.raises(LibraryError, match=message):
        library._open(library.load().path)
