"""Rototoon without Blender: a typed Python API over the native library.

Pipelines, tests and the Blender operators use this module; it imports nothing of Blender. Unpack the extension so that
its folder is called ``rototoon``, put the folder *above* it on ``sys.path``, and::

    from rototoon.session import Session

    with Session.open("shot_010/project.json") as session:
        summary = session.track()
        session.pin("near arm", frame=5, point=3, xy=(31.0, 44.5))
        session.track()                                  # solves only the span that the pin touches
        points = numpy.asarray(session.tracks("near arm").points)   # (frames, points, 2), no copy
        session.snap()
        session.save("shot_010/tracked.json")

Coordinates are pixels, x right, y down, with the origin at the picture's outer top-left corner: a pixel's centre lies
at +0.5. Frames are the integers of the document. Documents are plain ``dict``s of the form of the project file.

Errors are `RototoonError`, with a message that names the part, the frame or the field; a `Cancelled` run leaves the
session as it was. A session belongs to one thread at a time: a call that comes while another one runs is refused with
`RototoonError`, it never waits. Long calls release the interpreter lock, so other Python threads keep running.
"""

from __future__ import annotations

import array
import ctypes
import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from .native import handles, library
from .native.arrays import as_json, buffer, text
from .native.errors import Cancelled, LibraryError, RototoonError

__all__ = [
    "Cancelled",
    "End",
    "Guides",
    "Job",
    "LibraryError",
    "Pieces",
    "RototoonError",
    "Session",
    "Strokes",
    "Summary",
    "Track",
    "WeakestFrame",
    "fit_strokes",
    "hidden_lines",
    "match_contours",
    "parameters",
    "version",
]

Document: TypeAlias = dict[str, Any]
"""A project document as ``json.load`` gives it."""

Progress: TypeAlias = Callable[[float, str], bool | None]
"""``progress(fraction, step)``: told the finished share (0 to 1, never falling) and what is being done.

Returning ``False`` cancels; ``True`` or ``None`` goes on. Called on the thread that made the long call, about twenty
times a second at most, at least once before the work begins. An exception cancels the work and is raised from the call.
"""

Points: TypeAlias = Iterable[Sequence[float]]
"""Points as pairs, or any buffer of float64 of shape (N, 2) such as a NumPy array."""


@dataclass(frozen=True)
class Job:
    """How the tracking of one part between two neighbouring keys fared."""

    part: str
    first: int
    """Frame of the earlier key."""
    last: int
    """Frame of the later key."""
    solved: bool
    """Solved in this run; otherwise known from a run before, as nothing that bears on it had changed."""
    termination: str
    """Why the solver stopped: ``nothing_to_solve``, ``cost_converged``, ``step_converged``, ``no_descent``,
    ``iteration_limit`` or ``path_chosen``."""
    iterations: int
    initial_cost: float
    final_cost: float


@dataclass(frozen=True)
class End:
    """Where the track of a part with one key ends before the footage does."""

    part: str
    frame: int
    """The first frame beyond the track."""
    reason: str
    """``lost``: a key is wanted on that frame; ``cut``: another shot begins there; ``left``: the part left the picture."""


@dataclass(frozen=True)
class Summary:
    """What `Session.track` did: one job for each part and span, parts in the document's order, then by time."""

    jobs: list[Job]
    ends: list[End]
    """Of parts with one key, in the document's order, the end before the key first."""

    @property
    def solved(self) -> int:
        """How many jobs were solved in this run."""
        return sum(job.solved for job in self.jobs)

    @property
    def reused(self) -> int:
        """How many jobs were known from a run before."""
        return len(self.jobs) - self.solved


@dataclass(frozen=True)
class Track:
    """The control points of a part on every frame from its first to its last key; around a single key, where trusted.

    Both are read-only and stay valid whatever happens to the session; ``numpy.asarray`` takes them without copying.
    Both are empty and one-dimensional where the part has not been tracked.
    """

    frames: memoryview
    """Frame numbers, int32, shape (F,), rising."""
    points: memoryview
    """Points, float64, shape (F, N, 2)."""


@dataclass(frozen=True)
class WeakestFrame:
    """The frame where the next key helps most."""

    frame: int
    score: float
    """Doubt on that frame: the sum over parts of the mean of ``1 - confidence``, smoothed over time."""


@dataclass(frozen=True)
class Strokes:
    """Strokes of a drawing as flat buffers, such as NumPy arrays: stroke `i` has the points `offsets[i]` to
    `offsets[i + 1]`."""

    offsets: Any
    """int32, one more than there are strokes."""
    points: Any
    """float64 (N, 2), pixels."""
    closed: Any
    """uint8 or bool, one a stroke: whether the end joins the start."""


@dataclass(frozen=True)
class Guides:
    """Fitted strokes: quadratic B-splines by their guiding points."""

    offsets: memoryview
    """int32: stroke `i` has the guides `offsets[i]` to `offsets[i + 1]`."""
    points: memoryview
    """float64 (G, 2), pixels; those of corners twice."""
    values: memoryview
    """float64 (G, channels): what the points carried."""
    nearest: memoryview
    """int32 (G,): the given point that is nearest along the stroke."""
    errors: memoryview
    """float64, one a stroke: the largest distance in pixels."""


@dataclass(frozen=True)
class Pieces:
    """Seen and hidden parts of strokes, in the order of the strokes and along each."""

    strokes: memoryview
    """int32 (P,): the stroke of each part."""
    hidden: memoryview
    """int32 (P,): not 0 where it is hidden."""
    intervals: memoryview
    """float64 (P, 2): from which parameter of the stroke to which; over the seam of a closed one beyond its end."""
    offsets: memoryview
    """int32 (P + 1): part `i` has the points `offsets[i]` to `offsets[i + 1]`, none where it is a whole stroke."""
    indices: memoryview
    """int32 (M, 3): the given points of which each point is the sum."""
    weights: memoryview
    """float64 (M, 3): their weights."""


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


def match_contours(request: Mapping[str, Any]) -> Any:
    """Finds which drawn contour is which known one, whatever their order, direction, start and number of points.

    The request is ``{"references": [contour, ...], "drawn": [contour, ...]}``, each contour being
    ``{"closed": bool, "points": [[x, y], ...]}``. The answer is ``{"matches": [{"reference": index, "drawn": index,
    "points": [[x, y], ...], "cost": number}, ...]}``, rising by reference: `points` are the reference's control points
    on the drawn line; the cost is 0 for equal contours. What has no counterpart is left out. Contours may have a
    ``"color": [r, g, b]``, sRGB from 0 to 1, which is compared where both have one.
    """
    return json.loads(handles.take(handles.Text, "rototoon_match_contours", *as_json(request)))


def fit_strokes(strokes: Strokes, tolerance: float, values: Any = None, channels: int = 0) -> Guides:
    """Fits quadratic B-splines with few guiding points; no point is farther than `tolerance` pixels from its curve.

    `values` (float64, N × `channels`) are numbers that the points carry and the guides carry on. A stroke with a point
    that is no place is an error that names it; a stroke without points gives no guides.
    """
    given = stroke_buffers(strokes)
    carried, numbers = buffer([] if values is None else values, "d")
    expected = channels * (len(given[2]) // 2)
    if channels < 0 or numbers != expected:
        raise RototoonError(f"values: {numbers} numbers, expected {expected}, {channels} a point")
    arguments = (*given, carried, channels, float(tolerance))
    sizes = (given[1], channels)
    return Guides(*handles.take(handles.GuideArrays, "rototoon_fit_strokes", *arguments, sizes=sizes))


def hidden_lines(
    strokes: Strokes, forms: Any, depths: Any, fills: Any, *, border: float = 0.01, sliver: float = 0.1
) -> Pieces:
    """Cuts strokes where filled strokes in front hide them.

    `forms` (uint8) says what the points of each stroke mean: 0 a polyline, 1 guiding points of a uniform quadratic
    B-spline, 2 a chain of quadratic Bézier curves. `depths` (int32, two a stroke) are layer and stroke, larger is nearer,
    equal ones do not hide each other. `fills` (int32) is 0 where a stroke is not filled; strokes of a layer with the same
    number fill one shape. What is nearer to an outline than `border` pixels lies on it; parts shorter than `sliver` pixels
    take after their surroundings. Parts of polylines are polylines, all others are of form 2; all are open.
    """
    given = stroke_buffers(strokes)
    count = given[1]
    placing = []
    for name, values, kind, length in (
        ("forms", forms, "B", count),
        ("depths", depths, "i", 2 * count),
        ("fills", fills, "i", count),
    ):
        pointer, found = buffer(values, kind)
        if found != length:
            raise RototoonError(f"{name}: {found} values, expected {length}")
        placing.append(pointer)
    arguments = (*given, *placing, float(border), float(sliver))
    return Pieces(*handles.take(handles.PieceArrays, "rototoon_hidden_lines", *arguments))


def parameters() -> Any:
    """Every parameter: id, label, kind, range, default, help. Hosts build their panels from it."""
    return json.loads(handles.take(handles.Text, "rototoon_parameters"))


def version() -> str:
    """Version of the native library."""
    return handles.take(handles.Text, "rototoon_version")


def library_path() -> Path:
    """The native library in use; loads it if need be."""
    return library.load().path


def stroke_buffers(strokes: Strokes) -> tuple[Any, int, Any, Any]:
    """Pointers to the arrays of strokes, and their number, as the library takes them; checked against each other."""
    offsets, count = buffer(strokes.offsets, "i")
    points, numbers = buffer(strokes.points, "d")
    closed, flags = buffer(strokes.closed, "B")
    if count < 1 or flags != count - 1:
        raise RototoonError(f"closed: {flags} values, expected {max(count - 1, 0)}, one less than offsets")
    if numbers != 2 * max(offsets[count - 1], 0):
        raise RototoonError(f"points: {numbers} numbers, expected x and y of {offsets[count - 1]} points")
    return offsets, count - 1, points, closed


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
