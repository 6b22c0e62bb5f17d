"""Picture files: sequences on disk, and the pictures that Blender's images and clips show on each frame.

Footage is a file name pattern with `%d` or `%0Nd` for the number, and the numbers of the first and last picture. The scene
shows picture `n` on frame `n + frame_offset`.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from .errors import Problem

_NUMBER = re.compile(r"(\d+)(?!.*\d)")
MOVIES = {".mp4", ".mov", ".m4v", ".avi", ".mkv", ".webm", ".mpg", ".mpeg", ".ogv", ".wmv", ".flv", ".mts", ".m2ts"}


@dataclass(frozen=True)
class Sequence:
    """A sequence of picture files."""

    pattern: str
    first: int
    last: int
    picked: int
    missing: int = 0
    """Number of pictures of the same name beyond a gap. They are left out."""
    held: int = 0
    """Number of frames without a file between the first and the last one. They show the picture before."""


@dataclass(frozen=True)
class Source:
    """The picture file or movie that a Blender image or clip shows, and its timing."""

    path: str
    movie: bool
    frame_of_first: int | None = None
    """Scene frame that shows the movie's first frame or the picked picture; `None` if there is no timing."""
    timed_number: int | None = None
    """Number of the picture on `frame_of_first`; `None` for the picked picture."""


def is_movie(path: str) -> bool:
    """Whether a file name has the ending of a movie."""
    return os.path.splitext(path)[1].lower() in MOVIES


def sequence_around(path: str, hold_gaps: bool = False) -> Sequence:
    """The pictures around a picked file, up to the first gap, or all with `hold_gaps`. Their names differ only in the last number."""
    folder, name = os.path.split(os.path.abspath(path))
    if not os.path.isfile(path):
        raise Problem(f"No file {path}: it was moved or renamed")
    found = _NUMBER.search(name)
    if found is None:
        raise Problem(f"{name} has no number in its name: name the pictures like frame_001.png, frame_002.png, …")
    head, digits, tail = name[: found.start()], found.group(1), name[found.end() :]
    numbers = _numbers(folder, head, tail)
    widths = {len(text) for text in numbers.values()}
    padded = any(text.startswith("0") and len(text) > 1 for text in numbers.values())
    if padded:
        # A number with another count of digits belongs to another sequence (frame_01 beside frame_001), unless it is too large
        # for the count.
        numbers = {n: text for n, text in numbers.items() if text == f"{n:0{len(digits)}d}"}
    elif len(widths) > 1:
        numbers = {n: text for n, text in numbers.items() if text == str(n)}
    token = f"%0{len(digits)}d" if padded else "%d"
    picked = int(digits)
    first, last = (min(numbers), max(numbers)) if hold_gaps else _without_gap(numbers, picked)
    if "%" in head + tail or "%" in folder:
        raise Problem(f"{folder}/{name}: a name with % in it cannot be used; rename it")
    pattern = os.path.join(folder, head + token + tail)
    apart = len(numbers) - (last - first + 1)
    return Sequence(pattern, first, last, picked, max(apart, 0), max(-apart, 0))


def _without_gap(numbers: dict[int, str], picked: int) -> tuple[int, int]:
    """The first and the last number around the picked one, up to a gap on either side."""
    first = last = picked
    while first - 1 in numbers:
        first -= 1
    while last + 1 in numbers:
        last += 1
    return first, last


def _numbers(folder: str, head: str, tail: str) -> dict[int, str]:
    """The numbers of all files `head` + number + `tail`, with their text."""
    found = {}
    for entry in os.listdir(folder):
        middle = entry[len(head) : len(entry) - len(tail)] if tail else entry[len(head) :]
        if entry.startswith(head) and entry.endswith(tail) and middle.isascii() and middle.isdigit():
            number = int(middle)
            if number not in found or len(middle) > len(found[number]):
                found[number] = middle
    return found


def picture(pattern: str, number: int) -> str:
    """The file of a picture. Raises a `Problem` if the pattern does not say where the number stands."""
    try:
        return pattern % number
    except (TypeError, ValueError):
        if "%" in os.path.dirname(pattern):
            raise Problem(f"{os.path.dirname(pattern)}: a folder with % in its name cannot be used; rename it") from None
        raise Problem(
            f"Found {pattern!r} as footage, expected a name with %d or %04d for the number: choose it again in the panel Footage"
        ) from None


def pattern_of(ob) -> str:
    """The absolute pattern of an object's footage. Raises a `Problem` if the pictures are missing.

    The frames of a movie may have left the cache, or the file may be opened on another machine. Then they are those that this machine's
    cache has. Without a window they are made again; in a window that would block it.
    """
    import bpy

    from . import movie

    settings = ob.rototoon
    if not settings.pattern:
        raise Problem("No footage chosen: choose it in the panel Footage")
    if settings.pattern.startswith("//") and not bpy.data.filepath and _file_of(ob) is None:
        raise Problem(f"The footage {settings.pattern} is relative to a file that is not saved: choose it again")
    pattern = absolute(ob, settings.pattern)
    # Where gaps are held, the last frame may show an earlier picture.
    for number in (settings.first,) if settings.hold_gaps else (settings.first, settings.last):
        path = picture(pattern, number)
        if not os.path.isfile(path):
            if settings.movie:
                return _of_movie(absolute(ob, settings.movie))
            raise Problem(f"No picture {path}: the footage was moved or renamed; choose it again in the panel Footage")
    if settings.movie:
        movie.mark_used([os.path.dirname(pattern)])
    return pattern


def _of_movie(path: str) -> str:
    """The pattern of a movie's frames in the cache of this machine."""
    import bpy

    from . import movie, preferences

    if not os.path.isfile(path):
        raise Problem(f"No movie {path}, and its frames are not in the cache: choose the footage again in the panel Footage")
    cache = preferences.cache_folder()
    if movie.cached(path, cache) is None and bpy.app.background:
        for _ in movie.extract(path, cache):
            pass
    frames = movie.cached(path, cache)
    if frames is None:
        raise Problem(f"The frames of {path} are not in the cache of this machine: choose the movie again in the panel Footage")
    return frames.pattern


HELD = "held"
"""What the field `gaps` of a document's footage says if a frame without a file shows the picture before it."""


def fields(ob, pattern: str) -> dict[str, Any]:
    """An object's footage in the form of a document."""
    settings = ob.rototoon
    found = {
        "pattern": pattern,
        "first": settings.first,
        "last": settings.last,
        "fps": rate(ob),
        "width": settings.width,
        "height": settings.height,
    }
    return {**found, "gaps": HELD} if settings.hold_gaps else found


def rate(ob) -> float:
    """The frames a second of an object's footage, as its artist gave them: Blender keeps seven digits, 23.976 as 23.975999832…"""
    return float(f"{ob.rototoon.fps:.7g}")


def absolute(ob, path: str) -> str:
    """The absolute form of a path that an object keeps. Of a linked or overridden object it is relative to the object's file."""
    import bpy

    return os.path.normpath(bpy.path.abspath(path, library=_file_of(ob)))


def _file_of(ob):
    """The library that an object comes from; `None` for the open file."""
    return (ob.override_library.reference if ob.override_library is not None else ob).library


def number_of(path: str) -> int | None:
    """The last number in a file's name."""
    found = _NUMBER.search(os.path.basename(path))
    return int(found.group(1)) if found else None


def size_of(path: str) -> tuple[int, int]:
    """Width and height of a picture file, in pixels."""
    import bpy

    try:
        image = bpy.data.images.load(path, check_existing=False)
    except RuntimeError as error:
        raise Problem(f"Cannot read {path}: {error}") from error
    width, height = image.size
    bpy.data.images.remove(image)
    if width == 0 or height == 0:
        raise Problem(f"Cannot read {path} as a picture")
    return width, height


def source_of_image(image, user) -> Source:
    """The source of an image data-block with its image user."""
    import bpy

    if image is None:
        raise Problem("There is no image in it: choose one first")
    if image.packed_file is not None:
        raise Problem(f'"{image.name}" is packed into the .blend: unpack it (File > External Data) so that it has files')
    path = bpy.path.abspath(image.filepath, library=image.library)
    if image.source == "GENERATED" or not path:
        raise Problem(f'"{image.name}" has no file: take an image sequence or a movie')
    if image.source == "MOVIE":
        return Source(path, True, user.frame_start - user.frame_offset)
    if image.source == "SEQUENCE":
        # Blender shows picture 1 + frame_offset on frame_start.
        return Source(path, False, user.frame_start, 1 + user.frame_offset)
    return Source(path, False)


def source_of_clip(clip) -> Source:
    """The source of a movie clip. On `frame_start` it shows its file's picture, or its first frame, shifted by `frame_offset`."""
    import bpy

    if clip is None:
        raise Problem("There is no movie clip in it: choose one first")
    path = bpy.path.abspath(clip.filepath, library=clip.library)
    if clip.source == "MOVIE":
        return Source(path, True, clip.frame_start - clip.frame_offset)
    number = number_of(path)
    return Source(path, False, clip.frame_start, None if number is None else number + clip.frame_offset)


def background_source(camera) -> tuple[Source, object]:
    """The source of a camera's background, and its background image."""
    for entry in camera.data.background_images:
        source = _source_of_entry(entry) if entry.show_background_image else None
        if source is not None:
            return source, entry
    raise Problem(f'Camera "{camera.name}" has no background image: add one in its properties, Background Images')


def backgrounds(camera) -> Iterator[tuple[Source, object]]:
    """The sources of all of a camera's background images, and these images. Those that are shown come first; the others have their place all the same."""
    for entry in sorted(camera.data.background_images, key=lambda entry: not entry.show_background_image):
        with suppress(Problem):
            source = _source_of_entry(entry)
            if source is not None:
                yield source, entry


def _source_of_entry(entry) -> Source | None:
    """The source of a background image; `None` if nothing was chosen for it."""
    if entry.source == "IMAGE" and entry.image is not None:
        return source_of_image(entry.image, entry.image_user)
    if entry.source == "MOVIE_CLIP":
        clip = bpy_scene_clip() if entry.use_camera_clip else entry.clip
        return None if clip is None else source_of_clip(clip)
    return None


def pixel_aspect(entry) -> float:
    """Width by height of a pixel of what a background image shows. Blender leaves the pixel aspect of a clip's lens out of it."""
    clip = bpy_scene_clip() if entry.use_camera_clip else entry.clip
    x, y = entry.image.display_aspect if entry.source == "IMAGE" else clip.display_aspect
    return x / y


def bpy_scene_clip():
    """The active clip of the scene."""
    import bpy

    return bpy.context.scene.active_clip


def first_frame(source: Source, sequence: Sequence, scene_start: int) -> int:
    """The scene frame that shows the sequence's first picture."""
    if source.frame_of_first is None:
        return scene_start
    if source.movie:
        return source.frame_of_first
    number = sequence.picked if source.timed_number is None else source.timed_number
    return source.frame_of_first + sequence.first - number


def wants_relative() -> bool:
    """Whether Blender's preferences want paths to be relative to the file."""
    import bpy

    return bpy.context.preferences.filepaths.use_relative_paths


def relative(path: str, blend: str) -> str:
    """A path relative to a .blend file if it is at most three folders up, otherwise absolute."""
    if not blend or path.startswith("//"):
        return path
    try:
        found = os.path.relpath(path, os.path.dirname(os.path.abspath(blend)))
    except ValueError:
        return path
    return path if found.count("..") > 3 else "//" + found.replace(os.sep, "/")
