"""Conversion of Python values for the native library."""

from __future__ import annotations

import array
import ctypes
import json
from collections.abc import Mapping
from typing import Any

from .errors import RototoonError


def text(value: str) -> tuple[bytes, int]:
    """UTF-8 and its length."""
    data = value.encode("utf-8", "surrogatepass")
    return data, len(data)


def as_json(value: Mapping[str, Any]) -> tuple[bytes, int]:
    """JSON in UTF-8 and its length."""
    try:
        return text(json.dumps(value, allow_nan=False))
    except (TypeError, ValueError) as error:
        raise RototoonError(f"not a JSON document: {error}") from error


def buffer(values: Any, kind: str) -> tuple[Any, int]:
    """A C array with a copy of the numbers of a buffer or flat sequence, and their count."""
    try:
        data = memoryview(values)
    except TypeError:
        flat = array.array(kind, values)
    else:
        if {"l": "i", "?": "B"}.get(data.format, data.format) != kind or data.itemsize != array.array(kind).itemsize:
            raise RototoonError(f"expected numbers of type {kind}, found {data.format}")
        flat = array.array(kind, data.tobytes())
    ctype: Any = {"i": ctypes.c_int32, "d": ctypes.c_double, "B": ctypes.c_uint8}[kind]
    return (ctype * len(flat)).from_buffer(flat) if len(flat) else (ctype * 0)(), len(flat)
