"""Owned handles. Each is freed once, by `close` or by the garbage collector. Every failure becomes an exception."""

from __future__ import annotations

import contextlib
import ctypes
import json
import threading
from collections.abc import Callable, Iterator
from typing import Any, ClassVar, Self

from . import _bindings, ending, library
from .arrays import check_integers
from .errors import Cancelled, RototoonError


def call(name: str, *arguments: Any) -> None:
    """Calls a function whose last parameter is the error text. Raises the error that the function reports."""
    check_integers(name, arguments)
    error = ctypes.c_void_p()
    message = ""
    functions = library.hold(error).functions
    try:
        status = getattr(functions, name)(*arguments, ctypes.byref(error))
        if error:
            text = Text(error)
            message = text.read()
            text.close()
    finally:
        library.unhold(error)
    if status == _bindings.ROTOTOON_STATUS_CANCELLED:
        raise Cancelled(message)
    if status != _bindings.ROTOTOON_STATUS_OK:
        raise RototoonError(message or f"{name} failed with status {status}")


class Handle:
    """A pointer from the library. The function `_free` of its type frees it."""

    _free: ClassVar[str]

    def __init__(self, pointer: ctypes.c_void_p) -> None:
        self._library = library.hold(self)
        self._pointer: ctypes.c_void_p | None = pointer

    @classmethod
    def make(cls, name: str, *arguments: Any) -> Self:
        """Calls a function that returns a handle through its last parameter before the error."""
        pointer = ctypes.c_void_p()
        call(name, *arguments, ctypes.byref(pointer))
        return cls(pointer)

    @property
    def closed(self) -> bool:
        """Whether the handle was freed."""
        return self._pointer is None

    def pointer(self) -> ctypes.c_void_p:
        """The pointer. Raises `RototoonError` once the handle is closed."""
        if self._pointer is None:
            raise RototoonError(f"the {type(self).__name__.lower()} is closed")
        return self._pointer

    def read(self, *sizes: int) -> Any:
        """The content as Python objects that outlive the handle. `sizes` are array sizes that only the caller knows."""
        raise NotImplementedError

    def close(self) -> None:
        """Frees the handle. A second call does nothing."""
        pointer, self._pointer = self._pointer, None
        if pointer is not None:
            try:
                getattr(self._library.functions, self._free)(pointer)
            finally:
                library.unhold(self)

    def __del__(self) -> None:
        # `_pointer` is missing if `__init__` was never reached. Nothing may be raised here.
        if getattr(self, "_pointer", None) is not None:
            with contextlib.suppress(Exception):
                Handle.close(self)


class Text(Handle):
    """UTF-8 text from the library."""

    _free = "rototoon_text_free"

    def read(self, *_sizes: int) -> str:
        """The text."""
        # Not through `call`, since `call` reads error texts with this method.
        data, length = ctypes.c_void_p(), ctypes.c_size_t()
        read = library.load().functions.rototoon_text_read
        status = read(self.pointer(), ctypes.byref(data), ctypes.byref(length), None)
        if status != _bindings.ROTOTOON_STATUS_OK:
            raise RototoonError(f"rototoon_text_read failed with status {status}")
        return _copy(data, length.value).decode()


class TrackArrays(Handle):
    """Frames, points and confidence of a part."""

    _free = "rototoon_track_free"

    def read(self, *_sizes: int) -> tuple[memoryview, memoryview, memoryview]:
        """Frames (F,) int32, points (F, N, 2) float64, confidence (F, N) float64, as copies."""
        frame_count, point_count = ctypes.c_size_t(), ctypes.c_size_t()
        frames, points, confidence = ctypes.c_void_p(), ctypes.c_void_p(), ctypes.c_void_p()
        out = (frame_count, point_count, frames, points, confidence)
        call("rototoon_track_read", self.pointer(), *map(ctypes.byref, out))
        f, n = frame_count.value, point_count.value
        return view(frames, "i", f), view(points, "d", f, n, 2), view(confidence, "d", f, n)


class CurveArrays(Handle):
    """Snapped paths of a part on a frame."""

    _free = "rototoon_curves_free"

    def read(self, *_sizes: int) -> list[memoryview]:
        """The paths, each (M, 2) float64, as copies."""
        path_count, offsets, points = ctypes.c_size_t(), ctypes.c_void_p(), ctypes.c_void_p()
        call("rototoon_curves_read", self.pointer(), *map(ctypes.byref, (path_count, offsets, points)))
        bounds = view(offsets, "i", path_count.value + 1).tolist()
        size = 2 * ctypes.sizeof(ctypes.c_double)
        start = points.value or 0
        return [view(ctypes.c_void_p(start + a * size), "d", b - a, 2) for a, b in zip(bounds, bounds[1:])]


class GuideArrays(Handle):
    """Guiding points of fitted strokes."""

    _free = "rototoon_guides_free"

    def read(self, *sizes: int) -> tuple[memoryview, ...]:
        """Offsets (strokes + 1) int32, points (G, 2) float64, values (G, channels) float64, nearest (G,) int32 and errors
        (strokes,) float64, as copies. `sizes` are the numbers of strokes and channels."""
        strokes, channels = sizes
        count = ctypes.c_size_t()
        out = [ctypes.c_void_p() for _ in range(5)]
        call("rototoon_guides_read", self.pointer(), ctypes.byref(count), *map(ctypes.byref, out))
        offsets, points, values, nearest, errors = out
        guides = count.value
        return (
            view(offsets, "i", strokes + 1),
            view(points, "d", guides, 2),
            view(values, "d", guides, channels),
            view(nearest, "i", guides),
            view(errors, "d", strokes),
        )


class PieceArrays(Handle):
    """Visible and hidden parts of strokes."""

    _free = "rototoon_pieces_free"

    def read(self, *_sizes: int) -> tuple[memoryview, ...]:
        """Strokes (P,) int32, hidden (P,) int32, intervals (P, 2) float64, offsets (P + 1) int32, indices (M, 3) int32 and
        weights (M, 3) float64, as copies."""
        count = ctypes.c_size_t()
        out = [ctypes.c_void_p() for _ in range(6)]
        call("rototoon_pieces_read", self.pointer(), ctypes.byref(count), *map(ctypes.byref, out))
        strokes, hidden, intervals, offsets, indices, weights = out
        pieces = count.value
        bounds = view(offsets, "i", pieces + 1)
        points = bounds[pieces]
        return (
            view(strokes, "i", pieces),
            view(hidden, "i", pieces),
            view(intervals, "d", pieces, 2),
            bounds,
            view(indices, "i", points, 3),
            view(weights, "d", points, 3),
        )


class MatchArrays(Handle):
    """Matches of strokes."""

    _free = "rototoon_matches_free"

    def read(self, *_sizes: int) -> tuple[memoryview, ...]:
        """Offsets (spans + 1) int32, rows (R, 4) int32 and values (R, 2) float64, as copies."""
        count = ctypes.c_size_t()
        out = [ctypes.c_void_p() for _ in range(3)]
        call("rototoon_matches_read", self.pointer(), ctypes.byref(count), *map(ctypes.byref, out))
        offsets, rows, values = out
        bounds = view(offsets, "i", count.value + 1)
        return bounds, view(rows, "i", bounds[count.value], 4), view(values, "d", bounds[count.value], 2)


class InBetweenArrays(Handle):
    """In-betweens."""

    _free = "rototoon_in_betweens_free"

    def read(self, *_sizes: int) -> tuple[memoryview, ...]:
        """The arrays of `tween.InBetweens` in their order, as copies."""
        spans, points = ctypes.c_size_t(), ctypes.c_size_t()
        out = [ctypes.c_void_p() for _ in range(9)]
        call("rototoon_in_betweens_read", self.pointer(), *map(ctypes.byref, (spans, points, *out)))
        frame_offsets, shares, stroke_offsets, strokes, point_offsets, indices, weights, places, opacities = out
        frames, drawn = view(frame_offsets, "i", spans.value + 1), view(stroke_offsets, "i", spans.value + 1)
        count = drawn[spans.value]
        bounds = view(point_offsets, "i", count + 1)
        opaque = sum((frames[s + 1] - frames[s]) * (drawn[s + 1] - drawn[s]) for s in range(spans.value))
        return (
            frames,
            view(shares, "d", frames[spans.value]),
            drawn,
            view(strokes, "i", count, 3),
            bounds,
            view(indices, "i", bounds[count], 4),
            view(weights, "d", bounds[count], 2),
            view(places, "d", points.value, 2),
            view(opacities, "d", opaque),
            self._held(),
        )

    def _held(self) -> memoryview:
        count, held = ctypes.c_size_t(), ctypes.c_void_p()
        call("rototoon_in_betweens_held", self.pointer(), ctypes.byref(count), ctypes.byref(held))
        return view(held, "B", count.value)


class TracedArrays(Handle):
    """Traced strokes."""

    _free = "rototoon_traced_free"

    def read(self, *_sizes: int) -> tuple[memoryview, ...]:
        """The arrays of `lines.Traced` in their order, as copies."""
        count = ctypes.c_size_t()
        out = [ctypes.c_void_p() for _ in range(10)]
        call("rototoon_traced_read", self.pointer(), ctypes.byref(count), *map(ctypes.byref, out))
        frames, stroke_offsets, tracks, closed, colours, point_offsets, points, widths, confidence, fills = out
        bounds = view(stroke_offsets, "i", count.value + 1)
        strokes = bounds[count.value]
        ends = view(point_offsets, "i", strokes + 1)
        return (
            view(frames, "i", count.value),
            bounds,
            view(tracks, "i", strokes),
            view(closed, "i", strokes),
            view(colours, "d", strokes, 3),
            ends,
            view(points, "d", ends[strokes], 2),
            view(widths, "d", ends[strokes]),
            view(confidence, "d", strokes),
            view(fills, "i", strokes),
            self._fill_colours(),
        )

    def _fill_colours(self) -> memoryview:
        count, colours = ctypes.c_size_t(), ctypes.c_void_p()
        call("rototoon_traced_fill_colours", self.pointer(), ctypes.byref(count), ctypes.byref(colours))
        return view(colours, "d", count.value, 3)


class FilledArrays(Handle):
    """Painted regions."""

    _free = "rototoon_filled_free"

    def read(self, *_sizes: int) -> tuple[Any, ...]:
        """The arrays of `fills.Filled` in their order, as copies, and the names of colours."""
        count = ctypes.c_size_t()
        out = [ctypes.c_void_p() for _ in range(9)]
        call("rototoon_filled_read", self.pointer(), ctypes.byref(count), *map(ctypes.byref, out))
        frames, region_offsets, tracks, colours, confidence, doubtful, outline_offsets, point_offsets, points = out
        bounds = view(region_offsets, "i", count.value + 1)
        regions = bounds[count.value]
        outlines = view(outline_offsets, "i", regions + 1)
        ends = view(point_offsets, "i", outlines[regions] + 1)
        return (
            view(frames, "i", count.value),
            bounds,
            view(tracks, "i", regions),
            view(colours, "d", regions, 3),
            view(confidence, "d", regions),
            view(doubtful, "i", regions),
            outlines,
            ends,
            view(points, "d", ends[outlines[regions]], 2),
            json.loads(take(Text, "rototoon_filled_names", self.pointer())),
        )


class Session(Handle):
    """A session of the library. It refuses a call during another call, so nothing is freed while in use."""

    _free = "rototoon_session_free"

    def __init__(self, pointer: ctypes.c_void_p) -> None:
        super().__init__(pointer)
        self._guard = threading.Lock()
        self._unwanted = False

    @property
    def closed(self) -> bool:
        """Whether `close` was called."""
        return self._unwanted

    @contextlib.contextmanager
    def _alone(self) -> Iterator[ctypes.c_void_p]:
        if self._unwanted:
            raise RototoonError("the session is closed")
        if not self._guard.acquire(blocking=False):
            raise RototoonError("the session is in use by another call; it may be used from one thread at a time")
        try:
            yield self.pointer()
        finally:
            self._guard.release()
            if self._unwanted:
                self.close()

    def call(self, name: str, *arguments: Any) -> None:
        """Calls a function of the session."""
        with self._alone() as pointer:
            call(name, pointer, *arguments)

    def give(self, kind: type[Handle], name: str, *arguments: Any) -> Any:
        """Calls a function of the session that returns a handle, and returns the content of the handle."""
        with self._alone() as pointer:
            return take(kind, name, pointer, *arguments)

    def give_both(self, first: type[Handle], second: type[Handle], name: str, *arguments: Any) -> tuple[Any, Any]:
        """The same for a function that returns two handles."""
        with self._alone() as pointer:
            return take_both(first, second, name, pointer, *arguments)

    def close(self) -> None:
        """Frees the session now, or at the end of the call that is running. No new call can begin."""
        # `_unwanted` is set first. The call that has the guard checks it after the release, so one of the two frees the session.
        self._unwanted = True
        if self._guard.acquire(blocking=False):
            try:
                super().close()
            finally:
                self._guard.release()


def take(kind: type[Handle], name: str, *arguments: Any, sizes: tuple[int, ...] = ()) -> Any:
    """Calls a function that returns a handle, returns the content of the handle, and frees it. `sizes` go to `read`."""
    handle = kind.make(name, *arguments)
    try:
        return handle.read(*sizes)
    finally:
        handle.close()


def take_both(first: type[Handle], second: type[Handle], name: str, *arguments: Any) -> tuple[Any, Any]:
    """Calls a function that returns two handles, returns their contents, and frees them."""
    pointers = ctypes.c_void_p(), ctypes.c_void_p()
    call(name, *arguments, *map(ctypes.byref, pointers))
    one, other = first(pointers[0]), second(pointers[1])
    try:
        return one.read(), other.read()
    finally:
        one.close()
        other.close()


def view(data: ctypes.c_void_p, kind: str, *shape: int) -> memoryview:
    """A read-only copy of an array as a memoryview. An empty one is one-dimensional: Python allows no other shape."""
    count = 1
    for length in shape:
        count *= length
    size = {"B": 1, "i": ctypes.sizeof(ctypes.c_int32), "d": ctypes.sizeof(ctypes.c_double)}[kind]
    flat: Any = memoryview(_copy(data, count * size))
    made: memoryview = flat.cast(kind, shape) if count else flat.cast(kind)
    return made


def _copy(data: ctypes.c_void_p, size: int) -> bytes:
    return ctypes.string_at(data, size) if size else b""


@contextlib.contextmanager
def progress_callback(progress: Callable[[float, str], bool | None] | None) -> Iterator[Any]:
    """The C callback for a Python callback. An exception in the Python callback cancels the work and is raised at the end."""
    if progress is None:
        yield _bindings.RototoonProgress()
        return
    raised: list[BaseException] = []

    def report(_user: int | None, fraction: float, step: int | None, length: int) -> int:
        if must_end():
            return 1
        try:
            # 0 and numpy's False cancel too. None is what a function without a result returns, so it does not.
            answer = progress(fraction, _copy(ctypes.c_void_p(step), length).decode())
            return int(answer is not None and not answer)
        except BaseException as error:  # noqa: BLE001 - KeyboardInterrupt must not be lost in the library either
            raised.append(error)
            return 1

    with ending.call() as must_end:
        try:
            yield _bindings.RototoonProgress(report)
        except Cancelled:
            if not raised:
                raise
    if raised:
        raise raised[0]
