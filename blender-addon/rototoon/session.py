"""`Session`: a project document, its pictures, and the results of tracking.

A session belongs to one thread at a time. A second call during a running one does not wait: it raises `RototoonError`. Long
calls release the interpreter lock, so other Python threads keep running.
"""

from __future__ import annotations

import array
import ctypes
import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

from .native import handles
from .native.arrays import as_json, text
from .native.errors import RototoonError
from .results import End, Job, Summary, Track, WeakestFrame
from .types import Document, Points, Progress


class Session:
    """A document, its pictures, and what tracking already knows. Close it, or use it in a ``with`` statement."""

    def __init__(self, handle: handles.Session) -> None:
        """Use `Session.open` or `Session.from_document`."""
        self._handle = handle

    # -- document ------------------------------------------------------------------------------------------------

    @classmethod
    def open(cls, path: str | os.PathLike[str]) -> Session:
        """The session of a project file; footage is sought relative to the file's folder."""
        handle = handles.Session.make("rototoon_session_open", *text(os.fspath(path)))
        return cls(handle)

    @classmethod
    def from_document(cls, document: Mapping[str, Any], folder: str | os.PathLike[str]) -> Session:
        """The session of a document in memory; a relative footage pattern is relative to `folder`."""
        handle = handles.Session.make("rototoon_session_new", *as_json(document), *text(os.fspath(folder)))
        return cls(handle)

    def document(self) -> Document:
        """The document as it stands, tracks and snapped curves included; results are rounded to 0.0001 pixels."""
        return json.loads(self._handle.give(handles.Text, "rototoon_session_document"))

    def set_document(self, document: Mapping[str, Any]) -> None:
        """Puts another document in place of this one, keeping what is known of pictures and solved spans.

        The next `track` solves only what differs. Refused as a whole where the document is not valid.
        """
        self._handle.call("rototoon_session_set_document", *as_json(document))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the document; the file appears whole or not at all.

        In another folder than the session's, a relative footage pattern is rewritten so that it names the same files.
        """
        self._handle.call("rototoon_session_save", *text(os.fspath(path)))

    def set_footage(self, footage: Mapping[str, Any]) -> None:
        """Replaces the document's ``footage``; what is known of the pictures is forgotten if they are others."""
        self._handle.call("rototoon_session_set_footage", *as_json(footage))

    # -- the artist's input --------------------------------------------------------------------------------------

    def parts(self) -> list[str]:
        """Names of the parts in the document's order."""
        return json.loads(self._handle.give(handles.Text, "rototoon_session_parts"))

    def add_part(self, part: Mapping[str, Any]) -> None:
        """Adds a part, given as the document holds it (``name``, ``closed``, ``depth``, ``keys``, ...), at the end."""
        self._handle.call("rototoon_session_add_part", *as_json(part))

    def remove_part(self, part: str) -> None:
        """Removes a part and all that belongs to it."""
        self._handle.call("rototoon_session_remove_part", *text(part))

    def set_key(self, part: str, frame: int, points: Points) -> None:
        """Sets the artist's contour on a frame: as many points as the part's other keys have.

        Pins and a corrected centre on that frame give way to the key.
        """
        values = _flat(points)
        data = (ctypes.c_double * len(values)).from_buffer(values) if values else None
        self._handle.call("rototoon_session_set_key", *text(part), frame, data, len(values))

    def remove_key(self, part: str, frame: int) -> None:
        """Removes the key on a frame; an error where there is none."""
        self._handle.call("rototoon_session_remove_key", *text(part), frame)

    def pin(self, part: str, frame: int, point: int, xy: Sequence[float]) -> None:
        """Fixes one control point on a frame between keys, or beside a single one: tracking passes through it exactly."""
        x, y = xy
        self._handle.call("rototoon_session_pin", *text(part), frame, point, x, y)

    def unpin(self, part: str, frame: int, point: int | None = None) -> None:
        """Releases a pin, or with ``point=None`` all pins of the frame; nothing happens where there is none."""
        self._handle.call("rototoon_session_unpin", *text(part), frame, -1 if point is None else point)

    def set_center(self, part: str, frame: int, xy: Sequence[float]) -> None:
        """Fixes the mean of the part's control points on a frame between keys."""
        x, y = xy
        self._handle.call("rototoon_session_set_center", *text(part), frame, x, y)

    def clear_center(self, part: str, frame: int) -> None:
        """Releases a corrected centre; nothing happens where there is none."""
        self._handle.call("rototoon_session_clear_center", *text(part), frame)

    # -- work ----------------------------------------------------------------------------------------------------

    def track(self, preset: str = "rototoon", progress: Progress | None = None, *, threads: int = 0) -> Summary:
        """Tracks every part between its keys and stores ``tracks`` and ``confidence`` in the document.

        ``rototoon`` follows a part with one key outward from it, as far as it can be trusted; `Summary.ends` tells where
        that ends and why, and the document's ``wants_key`` where the part was lost.

        Spans that nothing touched since they were last solved in this session are not solved again. Snapped curves of
        frames whose track changed are dropped. `preset` is ``rototoon``, ``zhou2011``, ``agarwala2004`` or
        ``liang2012``; `threads` is the number of threads, 0 for one a core; it does not change the result. Raises
        `Cancelled`, the document unchanged.
        """
        options = {"preset": preset, "threads": threads}
        summary = self._long("rototoon_session_track", options, progress)
        return Summary([Job(**job) for job in summary["jobs"]], [End(**end) for end in summary["ends"]])

    def snap(self, progress: Progress | None = None, *, threads: int = 0, **options: Any) -> None:
        """Lays the tracked contours along the drawn ink and stores ``curves`` in the document.

        Keys are snapped too. `options` are parameters of the stage ``snap`` by id, such as ``follow="line"``; see
        `parameters`. Raises `Cancelled`, the document unchanged.
        """
        self._long("rototoon_session_snap", {"threads": threads, **options}, progress)

    # -- results -------------------------------------------------------------------------------------------------

    def tracks(self, part: str) -> Track:
        """The tracked control points of a part."""
        frames, points, _ = self._handle.give(handles.TrackArrays, "rototoon_session_track_of", *text(part))
        return Track(frames, points)

    def confidence(self, part: str) -> memoryview:
        """How sure each point of `tracks` is, 0 to 1: float64, shape (F, N); 1 on keys."""
        return self._handle.give(handles.TrackArrays, "rototoon_session_track_of", *text(part))[2]

    def curves(self, part: str, frame: int) -> list[memoryview]:
        """The snapped paths of a part on a frame: for each segment between control points float64 of shape (M, 2).

        Empty where the frame has not been snapped.
        """
        return self._handle.give(handles.CurveArrays, "rototoon_session_curves_of", *text(part), frame)

    def weakest_frame(self) -> WeakestFrame | None:
        """The frame, neither a part's key nor beside one, where the next key helps most; `None` if there is none."""
        return json.loads(
            self._handle.give(handles.Text, "rototoon_session_weakest_frame"),
            object_hook=lambda found: WeakestFrame(found["frame"], found["score"]),
        )

    # -- life ----------------------------------------------------------------------------------------------------

    @property
    def closed(self) -> bool:
        """Whether `close` was called."""
        return self._handle.closed

    def close(self) -> None:
        """Frees the pictures and all else; further calls raise `RototoonError`. Closing twice does nothing.

        A call that is running in another thread goes on to its end, and then all is freed.
        """
        self._handle.close()

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    def _long(self, name: str, options: Mapping[str, Any], progress: Progress | None) -> Any:
        """Makes a call that reports progress; an exception of `progress` cancels it and comes out here."""
        with handles.progress_callback(progress) as callback:
            return json.loads(self._handle.give(handles.Text, name, *as_json(options), callback, None))


def _flat(points: Points) -> array.array[float]:
    """x, y, x, y, ... of pairs or of a float64 buffer of shape (N, 2)."""
    try:
        view = memoryview(points)  # type: ignore[arg-type]
    except TypeError:
        flat = array.array("d")
        for point in points:
            x, y = point
            flat.extend((x, y))
        return flat
    if view.format != "d" or view.ndim != 2 or view.shape[1] != 2:
        raise RototoonError(f"points: expected float64 of shape (N, 2), found {view.format} of shape {view.shape}")
    return array.array("d", view.tobytes())
