"""Finds and loads the native library, checks that it fits this Python package, and lets it go again.

A loaded library holds its file: on Windows the file can't be replaced. So the extension lets the library go when it is
unregistered, and an update works while Blender runs. A library that is in use stays: code that is taken out of memory while it
runs would crash the program.
"""

from __future__ import annotations

import _ctypes
import ctypes
import gc
import os
import platform
import sys
import threading
from dataclasses import dataclass
from pathlib import Path

from . import _bindings
from .errors import LibraryError

ENVIRONMENT = "ROTOTOON_LIBRARY"
"""Environment variable: path of a library to use instead of the one beside this file."""

_SYSTEMS = {"rototoon_capi.dll": "Windows", "librototoon_capi.dylib": "macOS", "librototoon_capi.so": "Linux"}
"""File names of the library by the system that it is for."""

_DAMAGED = (
    "invalid ELF header",
    "wrong ELF class",
    "file too short",
    "not a valid Win32 application",
    "WinError 193",
    "mach-o file",
)
"""What the loaders of the systems say of a file that is damaged or for another system."""

_lock = threading.Lock()
_loaded: Library | None = None
_users: set[int] = set()
"""Ids of the open handles and the running calls. Sets change in one step, also where a finaliser interrupts the caller."""


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


def hold(user: object) -> Library:
    """The library, which is not let go until `unhold` is called for the same user. Raises `LibraryError`."""
    _users.add(id(user))
    try:
        return load()
    except BaseException:
        unhold(user)
        raise


def unhold(user: object) -> None:
    """The user needs the library no more."""
    _users.discard(id(user))


def release() -> bool:
    """Lets the library go, so that its file may be replaced or removed. The next use loads it again.

    False, and nothing has changed, while a session is open or a call runs.
    """
    global _loaded
    gc.collect()  # sessions that nobody refers to any more
    with _lock:
        if _loaded is None:
            return True
        if _users or _loaded.functions.rototoon_release(None) != _bindings.ROTOTOON_STATUS_OK:
            return False
        handle = _loaded.functions._handle
        _loaded = None
        # The names depend on the system, and type checkers know only one of them.
        getattr(_ctypes, "FreeLibrary" if sys.platform == "win32" else "dlclose")(handle)
        return True


def _file_name() -> str:
    if sys.platform == "win32":
        return "rototoon_capi.dll"
    return "librototoon_capi.dylib" if sys.platform == "darwin" else "librototoon_capi.so"


def _open(path: Path) -> Library:
    if not path.is_file():
        raise LibraryError(f"no native library at {path}; {_missing(path.parent)}")
    try:
        functions = ctypes.CDLL(str(path))
    except OSError as error:
        raise LibraryError(f"cannot load {path}: {error}{_advice(str(error))}") from error
    _check(path, functions)
    try:
        _bindings.declare(functions)
    except AttributeError as error:
        raise LibraryError(f"{path} is not complete: {error}") from error
    return Library(path, functions)


def _missing(folder: Path) -> str:
    """What to do where this system's library is not there."""
    others = [system for name, system in _SYSTEMS.items() if (folder / name).is_file()]
    if others:
        return f"this package is for {others[0]}: install the one for {_SYSTEMS[_file_name()]}"
    return f"build it, or set the environment variable {ENVIRONMENT} to its path"


def _advice(error: str) -> str:
    """What to do about an error of the system's loader."""
    if "GLIBC_" in error:
        found = "".join(os.confstr("CS_GNU_LIBC_VERSION") or "") if hasattr(os, "confstr") else ""
        return f"; found {found or 'an older C library'}, expected glibc 2.28 or newer: a newer Linux is needed"
    if any(words in error for words in _DAMAGED):
        machine = f"{platform.system()} {platform.machine()}"
        return f"; the file is damaged or for another system: install the package for {machine} again"
    return ""


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
