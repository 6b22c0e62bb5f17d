"""`Session`: a project document, its pictures, and the results of tracking.

A session belongs to one thread at a time. A second call during a running one does not wait: it raises `RototoonError`. Long
calls release the interpreter lock, so other Python threads keep running.
"""

from __future__ import annotations

import array
import ctypes
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from . import fills
from .fills import Click, Filled, Leak, Recolour, flat
from .lines import Traced
from .native import handles
from .native.arrays import as_json, buffer, pair, path_text, text
from .native.errors import RototoonError
from .results import Conformed, End, Exchange, Job, Summary, Track, Unseen, WeakestFrame
from .types import Document, Points, Progress


class Session:
    """A document, its pictures, and the results that tracking already has. Close it, or use it in a ``with`` statement."""

    def __init__(self, handle: handles.Session) -> None:
        """Use `Session.open` or `Session.from_document`."""
        self._handle = handle

    # -- document ------------------------------------------------------------------------------------------------

    @classmethod
    def open(cls, path: str | os.PathLike[str]) -> Session:
        """Opens a project file. A relative footage pattern is relative to the file's folder."""
        handle = handles.Session.make("rototoon_session_open", *path_text(path))
        return cls(handle)

    @classmethod
    def from_document(cls, document: Mapping[str, Any], folder: str | os.PathLike[str]) -> Session:
        """Opens a document in memory. A relative footage pattern is relative to `folder`."""
        handle = handles.Session.make("rototoon_session_new", *as_json(document), *path_text(folder))
        return cls(handle)

    def document(self) -> Document:
        """The current document, with tracks and snapped curves. Results are rounded to 0.0001 pixels."""
        document: Document = json.loads(self._handle.give(handles.Text, "rototoon_session_document"))
        return document

    def set_document(self, document: Mapping[str, Any]) -> None:
        """Replaces the document, and keeps what is known of pictures and solved spans.

        The next `track` solves only the differences. A document that is not valid is refused, and nothing changes.
        """
        self._handle.call("rototoon_session_set_document", *as_json(document))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the document. The file is complete, or it does not appear.

        If the file is in another folder than the session, a relative footage pattern is rewritten to name the same files.
        A frame of the footage is refused as a name.

        What another program wrote to the file after this session opened or saved it is not written over: the document goes into a new
        file beside it, and the error names both. A file that this session neither opened nor saved is replaced.
        """
        self._handle.call("rototoon_session_save", *path_text(path))

    def set_footage(self, footage: Mapping[str, Any]) -> None:
        """Replaces the document's ``footage``. If the pictures differ, the session forgets what it knows of them."""
        self._handle.call("rototoon_session_set_footage", *as_json(footage))

    # -- the artist's input --------------------------------------------------------------------------------------

    def parts(self) -> list[str]:
        """Names of the parts in the document's order."""
        names: list[str] = json.loads(self._handle.give(handles.Text, "rototoon_session_parts"))
        return names

    def add_part(self, part: Mapping[str, Any]) -> None:
        """Adds a part at the end. Its form is that of the document: ``name``, ``closed``, ``depth``, ``keys``, ..."""
        self._handle.call("rototoon_session_add_part", *as_json(part))

    def remove_part(self, part: str) -> None:
        """Removes a part with its keys, corrections and results."""
        self._handle.call("rototoon_session_remove_part", *text(part))

    def set_key(self, part: str, frame: int, points: Points) -> None:
        """Sets the artist's contour on a frame. It has as many points as the part's other keys.

        The key replaces pins and a corrected centre on that frame.
        """
        values = _flat(points)
        data = (ctypes.c_double * len(values)).from_buffer(values) if values else None
        self._handle.call("rototoon_session_set_key", *text(part), frame, data, len(values))

    def remove_key(self, part: str, frame: int) -> None:
        """Removes the key on a frame. It is an error if there is none."""
        self._handle.call("rototoon_session_remove_key", *text(part), frame)

    def pin(self, part: str, frame: int, point: int, xy: Sequence[float]) -> None:
        """Fixes one control point on a frame between two keys, or beside the only key. The track passes through it exactly."""
        self._handle.call("rototoon_session_pin", *text(part), frame, point, *pair("xy", xy))

    def unpin(self, part: str, frame: int, point: int | None = None) -> None:
        """Releases a pin, or with ``point=None`` all pins of the frame. Does nothing if there is no pin."""
        if point is not None and point < 0:
            raise RototoonError(f"point: found {point}, expected 0 or more, or None for all pins")
        self._handle.call("rototoon_session_unpin", *text(part), frame, -1 if point is None else point)

    def set_center(self, part: str, frame: int, xy: Sequence[float]) -> None:
        """Fixes the mean of the part's control points on a frame between keys."""
        self._handle.call("rototoon_session_set_center", *text(part), frame, *pair("xy", xy))

    def clear_center(self, part: str, frame: int) -> None:
        """Releases a corrected centre. Does nothing if there is none."""
        self._handle.call("rototoon_session_clear_center", *text(part), frame)

    def set_absent(self, part: str, first: int, last: int | None = None) -> None:
        """Marks the part as not there from frame `first` to `last`, by default on one frame.

        It has no track there. Its keys stay, and it is always there on them.
        """
        self._handle.call("rototoon_session_set_absent", *text(part), first, first if last is None else last, 1)

    def clear_absent(self, part: str, first: int, last: int | None = None) -> None:
        """Marks the part as there again from frame `first` to `last`. Does nothing where it is there already."""
        self._handle.call("rototoon_session_set_absent", *text(part), first, first if last is None else last, 0)

    def fills(self) -> list[Click]:
        """The clicks of the painter, by frame."""
        fills = json.loads(self._handle.give(handles.Text, "rototoon_session_fills"))
        clicks = [(own["frame"], each) for own in fills for each in own["regions"]]
        return [Click(frame, (*own["at"],), own["colour"] and (*own["colour"],), own.get("name")) for frame, own in clicks]

    def set_fills(self, clicks: Iterable[Click]) -> None:
        """Replaces the clicks of the painter. Those of a frame keep their order. Painted regions stay until the next `fill`."""
        clicks = list(clicks)
        frames, places, colours = flat(clicks)
        clicks = fills.read(clicks)
        if any(click.name is not None for click in clicks):
            self._handle.call("rototoon_session_set_fills_json", *text(fills.as_json(clicks)))
            return
        arrays = buffer(frames, "i")[0], buffer(places, "d")[0], buffer(colours, "d")[0]
        self._handle.call("rototoon_session_set_fills", *arrays, len(frames))

    def recolours(self) -> list[Recolour]:
        """The colours of paint that become others on some frames, in their order."""
        return fills.recolours_of_json(self._handle.give(handles.Text, "rototoon_session_recolours"))

    def set_recolours(self, recolours: Iterable[Recolour]) -> None:
        """Replaces the colours that become others. Painted regions stay until the next `fill`, which follows them."""
        self._handle.call("rototoon_session_set_recolours_json", *text(fills.recolours_as_json(recolours)))

    # -- work ----------------------------------------------------------------------------------------------------

    def track(self, preset: str = "rototoon", progress: Progress | None = None, *, threads: int = 0) -> Summary:
        """Tracks every part between its keys and stores ``tracks`` and ``confidence`` in the document.

        The preset ``rototoon`` also follows a part that has one key, before and after that key, as far as the track can be
        trusted. `Summary.ends` says where the track ends and why. The document's ``wants_key`` lists where the part was lost.
        `Summary.exchanges` are parts that look alike and may have changed places, `Summary.unseen` parts that something hides: ``absent`` of the document says
        that they have no contour there.

        Spans that have not changed since this session last solved them are not solved again. If files of the footage have changed since the session read them,
        it reads them anew, and `Summary.footage_changed` says so. Snapped curves of frames whose
        track changed are removed. `preset` is ``rototoon``, ``zhou2011``, ``agarwala2004`` or ``liang2012``. `threads` is the
        number of threads, 0 for one per core; it does not change the result. Raises `Cancelled`; the document is unchanged then.
        """
        options = {"preset": preset, "threads": threads}
        summary = self._long("rototoon_session_track", options, progress)
        exchanges = [Exchange((*found["parts"],), found["frames"]) for found in summary["exchanges"]]
        unseen = [Unseen(**found) for found in summary["unseen"]]
        jobs, ends = [Job(**job) for job in summary["jobs"]], [End(**end) for end in summary["ends"]]
        return Summary(jobs, ends, exchanges, unseen, summary["footage_changed"])

    def snap(self, progress: Progress | None = None, *, threads: int = 0, **options: Any) -> None:
        """Lays the tracked contours along the drawn ink and stores ``curves`` in the document.

        Keys are snapped too. `options` are parameters of the stage ``snap`` by id, such as ``follow="line"``; see
        `rototoon.parameters`. Raises `Cancelled`; the document is unchanged then.
        """
        self._long("rototoon_session_snap", {"threads": threads, **options}, progress)

    def trace(
        self,
        style: str = "auto",
        sensitivity: float = 1.0,
        frames: tuple[int, int] | None = None,
        progress: Progress | None = None,
        *,
        leave_out: Iterable[Sequence[float]] = (),
        keep_first: bool = False,
        threads: int = 0,
    ) -> Traced:
        """Traces the lines of the footage as strokes, the same strokes on every frame, and stores ``traced`` in the document.

        Work begins on the first of the document's ``drawings``, whose strokes are carried to the other frames. Frames with a drawing
        keep its strokes, in their order. Without drawings the first frame is traced; so it is with `keep_first` and a first drawing on
        a later frame, and the frames between are bound to both. Strokes of an earlier run in ``traced`` that are all sure on the first frame say the same.

        `style` is ``auto``, ``clean`` or ``rough``: lines that were sketched with several strokes become one. With `sensitivity` 2, ink
        may be half as dark as usual. `frames` are the first and the last frame, by default those of the footage; strokes of other
        frames stay. `leave_out` are colours of pencils whose lines are left out, sRGB from 0 to 1 as they look on white paper.
        Returns the strokes of all frames. Raises `Cancelled`; the document is unchanged then.
        """
        options: dict[str, Any] = {"style": style, "sensitivity": sensitivity, "threads": threads, "keep_first": keep_first}
        options["leave_out"] = _colours(leave_out)
        if frames is not None:
            options["frames"] = [int(frame) for frame in frames]
        with handles.progress_callback(progress) as callback:
            arguments = (*as_json(options), callback, None)
            return Traced(*self._handle.give(handles.TracedArrays, "rototoon_session_trace", *arguments))

    def fill(
        self,
        clicks: Iterable[Click] | None = None,
        sensitivity: float = 1.0,
        frames: tuple[int, int] | None = None,
        progress: Progress | None = None,
        *,
        confidence: float = 0.0,
        leave_out: Iterable[Sequence[float]] = (),
        threads: int = 0,
    ) -> Filled:
        """Paints the regions of line drawings by the clicks of a painter, and stores ``fills`` and ``filled`` in the document.

        `clicks` are (frame, (x, y), (r, g, b)), in pixels and sRGB from 0 to 1; `None` takes those of the document. Work begins on the first
        frame on which at least half of the regions were clicked. Colours are carried from there to the other frames. A few clicks on another
        frame overrule what was carried there.

        With `sensitivity` 2, ink may be half as dark as usual. `frames` are the first and the last frame, by default those of the
        footage; regions of other frames stay. Regions whose colour has less than `confidence` stay unpainted. `leave_out` is that of
        `trace`. Returns the regions of all frames. Raises `Cancelled`; the document is unchanged then.
        """
        options: dict[str, Any] = {"sensitivity": sensitivity, "confidence": confidence, "threads": threads}
        options["leave_out"] = _colours(leave_out)
        if frames is not None:
            options["frames"] = [int(frame) for frame in frames]
        # The text, as clicks of other programs have fields that `fills` does not tell.
        before = None if clicks is None else self._handle.give(handles.Text, "rototoon_session_document")
        if clicks is not None:
            self.set_fills(clicks)
        try:
            with handles.progress_callback(progress) as callback:
                kinds = handles.FilledArrays, handles.Text
                regions, told = self._handle.give_both(*kinds, "rototoon_session_fill", *as_json(options), callback, None)
        except BaseException:
            # A session that was closed meanwhile has no document to mend.
            if before is not None and not self.closed:
                self._handle.call("rototoon_session_set_document", *text(before))
            raise
        report = json.loads(told)
        missed, overruled = ([(own["frame"], own["click"]) for own in report[name]] for name in ("missed", "overruled"))
        unrelated = [own["frame"] for own in report["frames"] if not own["related"]]
        bare = [own["frame"] for own in report["frames"] if own["bare"]]
        leaking = [
            Leak(own["frame"], own["click"], own["parted"], tuple(own["gap"]), own["width"], tuple(own["size"]))
            for own in report["leaking"]
        ]
        return Filled(*regions, missed, unrelated, overruled, bare, leaking)

    def conform(
        self,
        pattern: str,
        frames: tuple[int, int] | None = None,
        progress: Progress | None = None,
        *,
        fps: float | None = None,
        scale: float | None = None,
        shift: Sequence[float] | None = None,
        frame_offset: int | None = None,
        hold_gaps: bool | None = None,
        threads: int = 0,
    ) -> Conformed:
        """Moves the document to footage that was delivered again: of another size, with other frame numbers, with drawings added, left
        out, held longer or drawn again. The pictures of both footages are compared.

        `pattern` names the files, with one ``%d`` or ``%0Nd``, relative to the session's folder. `frames` are the first and the last frame, by
        default those of all files. `fps` and `hold_gaps` are by default as before. `scale` is the number of pixels of the new picture for each
        pixel of the old one, and `shift` the place (x, y) of the old picture's corner in the new one; by default they are found. With
        `frame_offset`, this number is added to each frame and no pictures are compared, so the old footage may be gone.

        Keys and other work go with their drawing, results to all frames that show it. `document` then gives the moved document. Raises
        `Cancelled`; the document is unchanged then.
        """
        asked = {"fps": fps, "scale": scale, "frame_offset": frame_offset, "hold_gaps": hold_gaps}
        options: dict[str, Any] = {name: value for name, value in asked.items() if value is not None}
        options |= {"pattern": os.fsdecode(pattern), "threads": threads}
        if frames is not None:
            options["frames"] = [int(frame) for frame in frames]
        if shift is not None:
            options["shift"] = list(pair("shift", shift))
        return Conformed.of(self._long("rototoon_session_conform", options, progress))

    # -- results -------------------------------------------------------------------------------------------------

    def tracks(self, part: str) -> Track:
        """The tracked control points of a part."""
        frames, points, _ = self._handle.give(handles.TrackArrays, "rototoon_session_track_of", *text(part))
        return Track(frames, points)

    def confidence(self, part: str) -> memoryview:
        """Confidence of each point of `tracks`, 0 to 1: float64, shape (F, N). It is 1 on keys."""
        confidence: memoryview = self._handle.give(handles.TrackArrays, "rototoon_session_track_of", *text(part))[2]
        return confidence

    def curves(self, part: str, frame: int) -> list[memoryview]:
        """The snapped paths of a part on a frame: for each segment between two control points float64 of shape (M, 2).

        The list is empty if the frame has not been snapped.
        """
        paths: list[memoryview] = self._handle.give(handles.CurveArrays, "rototoon_session_curves_of", *text(part), frame)
        return paths

    def traced(self) -> Traced:
        """The strokes that `trace` has found on all frames. There are none if nothing was traced."""
        return Traced(*self._handle.give(handles.TracedArrays, "rototoon_session_traced"))

    def filled(self) -> Filled:
        """The regions that `fill` has painted on all frames. There are none if nothing was painted."""
        return Filled(*self._handle.give(handles.FilledArrays, "rototoon_session_filled"))

    def weakest_frame(self) -> WeakestFrame | None:
        """The frame where the next key helps most. It is no key of any part and not beside one. `None` if there is no such
        frame."""
        found = json.loads(self._handle.give(handles.Text, "rototoon_session_weakest_frame"))
        return None if found is None else WeakestFrame(found["frame"], found["score"])

    def unseen(self) -> list[Unseen]:
        """The parts that can probably not be seen on some frames, by the tracks that the document has. They are those of `Summary.unseen`, also where
        the document was tracked elsewhere."""
        return [Unseen(**found) for found in json.loads(self._handle.give(handles.Text, "rototoon_session_unseen"))]

    # -- life ----------------------------------------------------------------------------------------------------

    @property
    def closed(self) -> bool:
        """Whether `close` was called."""
        return self._handle.closed

    def close(self) -> None:
        """Frees the pictures and everything else. Later calls raise `RototoonError`; closing twice does nothing.

        If a call is running in another thread, it goes on to its end, and the session is freed then.
        """
        self._handle.close()

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    def _long(self, name: str, options: Mapping[str, Any], progress: Progress | None) -> Any:
        """Makes a call that reports progress. An exception in `progress` cancels the call and is raised here."""
        with handles.progress_callback(progress) as callback:
            return json.loads(self._handle.give(handles.Text, name, *as_json(options), callback, None))


def _flat(points: Points) -> array.array[float]:
    """The numbers x, y, x, y, ... of pairs or of a float64 buffer of shape (N, 2)."""
    try:
        view = memoryview(points)  # type: ignore[arg-type]
    except TypeError:
        flat = array.array("d")
        for index, point in enumerate(points):
            flat.extend(pair(f"points[{index}]", point))
        return flat
    if view.format != "d" or view.ndim != 2 or view.shape is None or view.shape[1] != 2:
        raise RototoonError(f"points: expected float64 of shape (N, 2), found {view.format} of shape {view.shape}")
    return array.array("d", view.tobytes())


def _colours(given: Iterable[Sequence[float]]) -> list[list[float]]:
    return [[float(value) for value in colour] for colour in given]
