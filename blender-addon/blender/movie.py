"""Movies as picture sequences: every frame as a PNG file, in a cache of limited size.

Blender decodes the movie: it renders a strip in a temporary scene, without any change of colour. So every movie that Blender
plays can be tracked. A movie's folder is named after the movie's path, size and date. While the frames are being made, the folder
has another name, so an incomplete one is never used.
"""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Iterator
from dataclasses import dataclass

import bpy

from .errors import Problem

PICTURE = "frame_%06d.png"
_UNFINISHED = ".unfinished"


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
        with open(os.path.join(folder, "movie.txt"), encoding="utf-8") as file:
            last, fps = file.read().split()
    except (OSError, ValueError):
        return None
    os.utime(folder)
    return Movie(os.path.join(folder, PICTURE), 1, int(last), float(fps))


def extract(path: str, cache: str) -> Iterator[float]:
    """Makes the movie's frames, one per step, and yields the finished share. Closing it early leaves no files."""
    if not os.path.isfile(path):
        raise Problem(f"No file {path}: it was moved or renamed")
    folder = os.path.join(cache, key(path))
    unfinished = f"{folder}.{os.getpid()}{_UNFINISHED}"
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
        with open(os.path.join(unfinished, "movie.txt"), "w", encoding="utf-8") as file:
            file.write(f"{count} {fps!r}\n")
        shutil.rmtree(folder, ignore_errors=True)
        os.rename(unfinished, folder)
        done = True
    except OSError as error:
        raise Problem(f"Cannot keep the frames of {path}: {error}") from error
    finally:
        bpy.data.scenes.remove(scene)
        if not done:
            shutil.rmtree(unfinished, ignore_errors=True)


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

    Returns the number of removed movies.
    """
    entries = []
    for entry in _folders(cache):
        if entry.name.endswith(_UNFINISHED):
            continue
        entries.append((entry.stat().st_mtime_ns, entry.path, _size(entry.path)))
    total, removed = sum(size for _, _, size in entries), 0
    for _, path, size in sorted(entries):
        if total <= limit:
            break
        if os.path.basename(path) not in keep:
            shutil.rmtree(path, ignore_errors=True)
            total, removed = total - size, removed + 1
    return removed


def _folders(cache: str) -> list[os.DirEntry]:
    try:
        return [entry for entry in os.scandir(cache) if entry.is_dir()]
    except OSError:
        return []


def _size(folder: str) -> int:
    return sum(entry.stat().st_size for entry in os.scandir(folder) if entry.is_file())
