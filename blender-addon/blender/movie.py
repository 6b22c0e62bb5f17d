"""Movies as picture sequences: every frame as a PNG file, in a cache of limited size.

Blender decodes the movie: it renders a strip in a temporary scene, without any change of colour. So every movie that Blender
plays can be tracked. A movie's folder is named after the movie's path, size and date. While the frames are being made, the folder
has another name, so an incomplete one is never used.

Several Blenders may share a cache, also on several machines. Each makes frames in a folder of its own; the first that is ready gives
it the movie's name. A movie that was used within a day is not removed, because another Blender may show it.

The folder of the cache is chosen by the artist, who may have other things in it. So a folder belongs to the cache only if its name and all that
it holds are as they are made here, and only such files are removed.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import time
import uuid
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import bpy

from .errors import Problem

PICTURE = "frame_%06d.png"
_FACTS = "movie.txt"
_UNFINISHED = ".unfinished"
_NAME = re.compile(rf"[0-9a-f]{{24}}(\.[0-9a-f]{{12}}{re.escape(_UNFINISHED)})?")
_FILE = re.compile(rf"frame_[0-9]{{6,}}\.png|{re.escape(_FACTS)}")
_RECENT = 24 * 3600
"""Seconds for which a movie counts as in use after its last use."""
_NOTED = 3600
"""Seconds between two notes of a movie's use: a disk of a network need not be asked more often."""


@dataclass(frozen=True)
class Movie:
    """A movie's frames as files."""

    pattern: str
    first: int
    last: int
    fps: float


def key(path: str) -> str:
    """Name of a movie's folder in the cache. It changes when the file changes."""
    stat = os.stat(path)
    text = f"{os.path.realpath(path)}\0{stat.st_size}\0{stat.st_mtime_ns}"
    return hashlib.sha256(text.encode("utf-8", "surrogateescape")).hexdigest()[:24]


def cached(path: str, cache: str) -> Movie | None:
    """The movie's frames if they are in the cache. Marks them as used."""
    folder = os.path.join(cache, key(path))
    try:
        with open(os.path.join(folder, _FACTS), encoding="utf-8") as file:
            last, fps = file.read().split()
    except (OSError, ValueError):
        return None
    mark_used([folder])
    return Movie(os.path.join(folder, PICTURE), 1, int(last), float(fps))


def mark_used(folders: Iterable[str]) -> None:
    """Notes that movies are in use, at most once an hour. A folder that is gone, or belongs to somebody else, stays as it is."""
    for folder in folders:
        with contextlib.suppress(OSError):
            if abs(time.time() - os.stat(folder).st_mtime) > _NOTED:
                os.utime(folder)


def extract(path: str, cache: str) -> Iterator[float]:
    """Makes the movie's frames, one per step, and yields the finished share. Closing it early leaves no files."""
    if not os.path.isfile(path):
        raise Problem(f"No file {path}: it was moved or renamed")
    folder = os.path.join(cache, key(path))
    # Processes of two machines may have the same number.
    unfinished = f"{folder}.{uuid.uuid4().hex[:12]}{_UNFINISHED}"
    scene = bpy.data.scenes.new("Rototoon movie")
    done = False
    try:
        os.makedirs(unfinished, exist_ok=True)
        count, fps = _prepare(scene, path)
        for number in range(1, count + 1):
            _render(scene, number, os.path.join(unfinished, "frame_######.png"))
            if not os.path.isfile(os.path.join(unfinished, PICTURE % number)):
                raise Problem(f"Cannot write frame {number} of {path} to {unfinished}: is the disk full?")
            yield number / count
        with open(os.path.join(unfinished, _FACTS), "w", encoding="utf-8") as file:
            file.write(f"{count} {fps!r}\n")
        done = _finish(unfinished, folder)
    except OSError as error:
        raise Problem(f"Cannot keep the frames of {path}: {error}") from error
    finally:
        bpy.data.scenes.remove(scene)
        if not done:
            _delete(unfinished)


def _finish(unfinished: str, folder: str) -> bool:
    """Gives finished frames the movie's name. False if another Blender was faster: its frames are as good."""
    try:
        os.rename(unfinished, folder)
    except OSError:
        if os.path.isfile(os.path.join(folder, _FACTS)):
            return False
        _remove(folder)
        os.rename(unfinished, folder)
    return True


def _remove(folder: str) -> bool:
    """Removes a folder of the cache. It loses its name first: another Blender must not find half of it."""
    condemned = f"{folder}.{uuid.uuid4().hex[:12]}{_UNFINISHED}"
    try:
        os.rename(folder, condemned)
    except OSError:
        return False  # another program reads in it, or has removed it
    _delete(condemned)
    return True


def _delete(folder: str) -> None:
    """Deletes a folder with the files that are made here. What else is in it stays, and so does the folder then."""
    with contextlib.suppress(OSError):
        for name in filter(_FILE.fullmatch, os.listdir(folder)):
            os.remove(os.path.join(folder, name))
        os.rmdir(folder)


def _prepare(scene, path: str) -> tuple[int, float]:
    strips = scene.sequence_editor_create().strips
    try:
        strip = strips.new_movie("movie", path, 1, 1)
    except RuntimeError as error:
        raise Problem(f"Cannot read the movie {path}: {error}") from error
    count = getattr(strip, "duration", 0) if bpy.app.version >= (5, 2, 0) else strip.frame_final_duration
    element = strip.elements[0] if len(strip.elements) else None
    if not count or element is None or element.orig_width == 0:
        raise Problem(f"Cannot read the movie {path}: it has no frames")
    render = scene.render
    render.resolution_x, render.resolution_y = element.orig_width, element.orig_height
    render.resolution_percentage = 100
    render.use_sequencer = True
    render.image_settings.file_format = "PNG"
    render.image_settings.color_mode = "RGB"
    render.image_settings.compression = 15
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.look = "None"
    return count, float(strip.fps or 24.0)


def _render(scene, number: int, path: str) -> None:
    # Rendered as an animation of one frame: a still render of a strip always shows the strip's first frame.
    scene.frame_start = scene.frame_end = number
    scene.render.filepath = path
    bpy.ops.render.render(animation=True, scene=scene.name)


def shrink(cache: str, limit: int, keep: set[str]) -> int:
    """Removes the least recently used movies until the cache is within `limit` bytes. `keep` names folders in use.

    Movies that were used within a day stay, also above the limit. Returns the number of removed movies.
    """
    entries, still_used = [], time.time_ns() - _RECENT * 10**9
    for entry in _folders(cache):
        # Another Blender may remove a folder meanwhile.
        with contextlib.suppress(OSError):
            used = entry.stat().st_mtime_ns
            if not entry.name.endswith(_UNFINISHED):
                entries.append((used, entry.path, _size(entry.path)))
            elif used < still_used:
                _delete(entry.path)  # its Blender was ended
    total, removed = sum(size for _, _, size in entries), 0
    for used, path, size in sorted(entries):
        if total <= limit or used >= still_used:
            break
        if os.path.basename(path) not in keep and _remove(path):
            total, removed = total - size, removed + 1
    return removed


def _folders(cache: str) -> list[os.DirEntry]:
    """The folders that belong to the cache, finished and unfinished ones."""
    try:
        return [entry for entry in os.scandir(cache) if _NAME.fullmatch(entry.name) and _is_own(entry)]
    except OSError:
        return []


def _is_own(entry: os.DirEntry) -> bool:
    """Whether a folder with the name of a movie holds only files that are made here, and the facts if it is finished."""
    try:
        names = os.listdir(entry.path) if entry.is_dir(follow_symlinks=False) else [""]
    except OSError:
        return False
    return all(map(_FILE.fullmatch, names)) and (entry.name.endswith(_UNFINISHED) or _FACTS in names)


def _size(folder: str) -> int:
    return sum(entry.stat().st_size for entry in os.scandir(folder) if entry.is_file())
