"""The native library: its version, its place and its parameters."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from .native import handles, library


def parameters() -> Any:
    """Every parameter: id, label, kind, range, default, help. Hosts build their panels from this list."""
    return json.loads(handles.take(handles.Text, "rototoon_parameters"))


def version() -> str:
    """Version of the native library."""
    return str(handles.take(handles.Text, "rototoon_version"))


def library_path() -> Path:
    """Path of the native library in use. Loads the library if it is not loaded yet."""
    return library.load().path
