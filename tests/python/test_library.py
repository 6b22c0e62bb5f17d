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
    (tmp_path / "empty.so").write_bytes(b"")
    with pytest.raises(LibraryError, match="cannot load .*empty.so"):
        library._open(tmp_path / "empty.so")
    text = tmp_path / "text.so"
    text.write_text("not a library")
    with pytest.raises(LibraryError, match="cannot load .*text.so"):
        library._open(text)
    here, other = library._file_name(), "rototoon_capi.dll" if sys.platform != "win32" else "librototoon_capi.so"
    (tmp_path / other).write_text("")
    with pytest.raises(LibraryError, match="this package is for .*: install the one for"):
        library._open(tmp_path / here)
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


def test_errors_of_the_loader_say_what_to_do():
    old = "/lib/x86_64-linux-gnu/libc.so.6: version `GLIBC_2.34' not found (required by librototoon_capi.so)"
    assert "expected glibc 2.28 or newer" in library._advice(old)
    assert "for another system" in library._advice("librototoon_capi.so: invalid ELF header")
    assert "the file is damaged" in library._advice("librototoon_capi.so: file too short")
    assert "for another system" in library._advice("[WinError 193] %1 is not a valid Win32 application")
    for found in ("not a mach-o file", "slice is not valid mach-o file", "mach-o file, but is an incompatible architecture"):
        assert "for another system" in library._advice(f"dlopen(a.dylib, 0x0006): tried: 'a.dylib' ({found})")
    assert library._advice("out of memory") == ""


def test_the_library_is_let_go_and_loaded_again():
    # In a process of its own: other tests keep sessions and functions of the library.
    code = """
import sys
from rototoon import Session, RototoonError, version
from rototoon.native import library
assert library.release()                     # nothing is loaded yet
first = version()
document = {"rototoon": 1, "footage": {"pattern": "f_%d.png", "first": 0, "last": 1, "fps": 12, "width": 8, "height": 8}, "parts": []}
session = Session.from_document(document, ".")
assert not library.release()                 # a session is open
assert session.parts() == []
session.close()
loaded = library.load()
assert library.release() and library._loaded is None
assert version() == first and library.load() is not loaded
for _ in range(20):
    try:
        Session.open("gone.json")
    except RototoonError as error:
        assert "gone.json" in str(error)
    with Session.from_document(document, ".") as session:
        session.track()
    assert library.release()
"""
    environment = os.environ | {"PYTHONPATH": str(ADDON), "PYTHONDONTWRITEBYTECODE": "1"}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
