"""Conversion of Python values for the native library."""

from __future__ import annotations

import array
import ctypes
import json
import operator
import os
import reprlib
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from . import _bindings
from .errors import RototoonError


def text(value: str) -> tuple[bytes, int]:
    """UTF-8 and its length."""
    if not isinstance(value, str):
        raise RototoonError(f"found {reprlib.repr(value)}, expected text")
    data = value.encode("utf-8", "surrogatepass")
    return data, len(data)


def path_text(value: str | bytes | os.PathLike[Any]) -> tuple[bytes, int]:
    """A path as the library takes it, in UTF-8, and its length.

    Python's own encoding of file names may be another one, such as ASCII in an old locale. Bytes of a name that are no text stay what they are.
    """
    given = os.fspath(value)
    if isinstance(given, bytes):
        return given, len(given)
    try:
        # On Windows such signs are halves of UTF-16, elsewhere bytes.
        data = given.encode("utf-8", "surrogatepass" if sys.platform == "win32" else "surrogateescape")
    except UnicodeEncodeError:
        data = given.encode("utf-8", "surrogatepass")  # the library says what is wrong
    return data, len(data)


def pair(name: str, value: Sequence[float]) -> tuple[float, float]:
    """The two numbers of a place."""
    try:
        x, y = map(float, value)
    except (TypeError, ValueError) as error:
        raise RototoonError(f"{name}: found {reprlib.repr(value)}, expected two numbers, x and y") from error
    return x, y


def as_json(value: Mapping[str, Any] | Sequence[Any]) -> tuple[bytes, int]:
    """JSON in UTF-8 and its length."""
    try:
        return text(json.dumps(value, allow_nan=False))
    except (TypeError, ValueError) as error:
        raise RototoonError(f"not a JSON document: {error}") from error


def check_integers(function: str, arguments: Sequence[Any]) -> None:
    """Raises `RototoonError` if a whole number does not fit its C type. ctypes would take its lowest bits, and the call
    would change another frame or point."""
    for index, name, kind in _bindings.INTEGERS.get(function, ()):
        if index >= len(arguments):
            return
        try:
            number = operator.index(arguments[index])
        except TypeError as error:
            raise RototoonError(f"{name}: found {arguments[index]!r}, expected a whole number") from error
        if kind(number).value != number:
            low, high = limits(kind)
            raise RototoonError(f"{name}: found {number}, expected a whole number from {low} to {high}")


def limits(kind: Any) -> tuple[int, int]:
    """The smallest and the largest value of a C integer type."""
    values = 1 << 8 * ctypes.sizeof(kind)
    return (-values // 2, values // 2 - 1) if kind(-1).value < 0 else (0, values - 1)


def buffer(values: Any, kind: str) -> tuple[Any, int]:
    """A C array with a copy of the numbers of a buffer or flat sequence, and their count."""
    try:
        data = memoryview(values)
    except TypeError:
        try:
            flat = array.array(kind, values)
        except OverflowError as error:
            raise RototoonError(f"found a number that does not fit type {kind}: {error}") from error
    else:
        if {"l": "i", "?": "B"}.get(data.format, data.format) != kind or data.itemsize != array.array(kind).itemsize:
            raise RototoonError(f"expected numbers of type {kind}, found {data.format}")
        flat = array.array(kind, data.tobytes())
    ctype: Any = {"i": ctypes.c_int32, "d": ctypes.c_double, "B": ctypes.c_uint8}[kind]
    return (ctype * len(flat)).from_buffer(flat) if len(flat) else (ctype * 0)(), len(flat)
