"""Finds and loads the native library, and checks that it fits this Python package."""

from __future__ import annotations

import ctypes
import os
import sys
import threading
from dataclasses import dataclass
from pathlib import Path

from . import _bindings
from .errors import LibraryError

ENVIRONMENT = "ROTOTOON_LIBRARY"
"""Environment variable: path of a library to use instead of the one beside this file."""

_lock = threading.Lock()
_loaded: Library | None = None


@dataclass(frozen=True)
class Library:
    """The loaded library with its prototypes."""

    path: Path
    functions: ctypes.CDLL


def find() -> Path:
    """Where the library should be: at the path in the environment variable, otherwise beside this file."""
    named = os.environ.get(ENVIRONMENT)
    return Path(named) if named else Path(__file__).resolve().parent / _file_name()


def load() -> Library:
    """The library. The first call loads it. Raises `LibraryError`."""
    global _loaded
    with _lock:
        if _loaded is None:
            _loaded = _open(find())
        return _loaded


def _file_name() -> str:
    if sys.platform == "win32":
        return "rototoon_capi.dll"
    return "librototoon_capi.dylib" if sys.platform == "darwin" else "librototoon_capi.so"


def _open(path: Path) -> Library:
    if not path.is_file():
        raise LibraryError(f"no native library at {path}; build it, or set the environment variable {ENVIRONMENT} to its path")
    try:
        functions = ctypes.CDLL(str(path))
    except OSError as error:
        raise LibraryError(f"cannot load {path}: {error}") from error
    _check(path, functions)
    try:
        _bindings.declare(functions)
    except AttributeError as error:
        raise LibraryError(f"{path} is not complete: {error}") from error
    return Library(path, functions)


def _check(path: Path, functions: ctypes.CDLL) -> None:
    """Compares versions before any other call: a call with a wrong prototype would corrupt memory."""
    try:
        abi_version, header_hash = functions.rototoon_abi_version, functions.rototoon_header_hash
    except AttributeError as error:
        raise LibraryError(f"{path} is not a Rototoon library: {error}") from error
    abi_version.restype, abi_version.argtypes = ctypes.c_uint32, []
    header_hash.restype, header_hash.argtypes = ctypes.c_uint64, []
    if abi_version() != _bindings.ROTOTOON_ABI_VERSION:
        expected = _bindings.ROTOTOON_ABI_VERSION
        found = abi_version()
        raise LibraryError(f"{path} has ABI version {found}, this package expects {expected}; install both again")
    if header_hash() != _bindings.HEADER_HASH:
        built, ours = f"{header_hash():016x}", f"{_bindings.HEADER_HASH:016x}"
        raise LibraryError(f"{path} was built with header {built}, this package expects {ours}; install both again")
