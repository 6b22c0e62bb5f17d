"""Shots of all Blender files of a folder. Each file is opened in a Blender of its own, in background, so the open file stays as it is."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import bpy

from ..blender.errors import Problem
from .tracing import Wanted

MODULE = __package__.rpartition(".")[0]
"""The add-on's name."""
_SCRIPT = Path(__file__).with_name("read_file.py")


def blend_files(folder: str) -> list[str]:
    """The Blender files of a folder, by name, without Blender's own backups."""
    try:
        found = sorted(entry.path for entry in os.scandir(folder) if entry.is_file() and entry.name.lower().endswith(".blend"))
    except OSError as error:
        raise Problem(f"Cannot read the folder {folder}: {error.strerror}") from error
    if not found:
        raise Problem(f"No .blend file in {folder}")
    return found


def shots_of(paths: list[str], lines: Wanted, progress: Callable[[float, str], bool]) -> tuple[list[dict[str, Any]], list[str]]:
    """Shots of all files, and what was left out. May run in a thread. A file that cannot be read does not stop the others."""
    shots: list[dict[str, Any]] = []
    left: list[str] = []
    for index, path in enumerate(paths):
        name = os.path.basename(path)
        going = progress(index / len(paths), name)
        found = _read(path, lines, lambda: progress(index / len(paths), name)) if going else None
        if found is None:
            return [], []
        shots += found["shots"]
        left += [f"{name}: {why}" for why in found["left"]]
    return shots, left


def _read(path: str, lines: Wanted, going: Callable[[], bool]) -> dict[str, Any] | None:
    """What `read_file` writes about a file; `None` if it was stopped."""
    with tempfile.TemporaryDirectory() as folder:
        out, log = os.path.join(folder, "shots.json"), os.path.join(folder, "log.txt")
        words = ["--", MODULE, path, out, json.dumps(asdict(lines))]
        if bpy.app.binary_path:
            start = [bpy.app.binary_path, "--background", path, "--python-exit-code", "1", "--python", str(_SCRIPT)]
        else:
            start = [sys.executable, str(_SCRIPT)]
        with open(log, "wb") as said:
            child = subprocess.Popen([*start, *words], stdin=subprocess.DEVNULL, stdout=said, stderr=said)
        while True:
            try:
                child.wait(0.1)
                break
            except subprocess.TimeoutExpired:
                if not going():
                    child.kill()
                    child.wait()
                    return None
        try:
            with open(out, encoding="utf-8") as file:
                return json.load(file)
        except (OSError, ValueError):
            with open(log, encoding="utf-8", errors="replace") as file:
                lines = [line.strip() for line in file if line.strip()]
            return {"shots": [], "left": [lines[-1] if lines else f"Blender ended with status {child.returncode}"]}
