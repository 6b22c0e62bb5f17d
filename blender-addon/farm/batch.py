"""The files of a batch: a document for each shot, the manifest, jobs for render farms, and a list of what was sent.

    manifest.json        what `rototoon batch` reads
    template.json        the job for OpenJD (AWS Deadline Cloud and others)
    rototoon-batch.js    the job type for Flamenco
    send_to_opencue.py   sends the job to OpenCue
    shots/NAME.json      a project document for each shot
    sent.json            which object of which file each shot is, its parts, and the layers of its lines; the hash of each file
    results/             where the results will be

A file is only replaced if it is as it was written here. So nothing that somebody made or changed is lost.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..blender.errors import Problem
from ..capture.properties import PRESETS
from ..exchange import files

MANIFEST, SENT, RESULTS, SHOTS = "manifest.json", "sent.json", "results", "shots"
OPENJD, FLAMENCO, OPENCUE = "template.json", "rototoon-batch.js", "send_to_opencue.py"
VERSION = 1
MOST_BYTES = 120
"""Greatest number of bytes of a shot's name."""
_ENGINES = Path(__file__).with_name("engines")
_SCRIPT = _ENGINES / "send_to_opencue.txt"
_UNSAFE = re.compile(r'[\x00-\x1f\x7f/\\:*?"<>|]')
_DEFAULT = PRESETS[0][0]


@dataclass(frozen=True)
class Choices:
    """What is done with each shot."""

    snap: bool = False
    mattes: bool = False
    jobs: str = "ALL"
    """``OPENJD``, ``FLAMENCO``, ``OPENCUE``, ``ALL`` or ``NONE``."""
    chunk: int = 4
    """Shots that a worker gets at a time."""


def write(folder: str, shots: Sequence[Mapping[str, Any]], choices: Choices) -> list[str]:
    """Writes a batch. Returns the names of the shots, in the order of `shots`. Raises a `Problem` before anything is written if a
    file of somebody else is in the way, or the folder has shots of files that are not among these."""
    place = Path(folder)
    names = shot_names(shots)
    before = _sent(place)
    _need_no_others(before, {_relative(place, shot["blend"]) for shot in shots})
    wanted = {SHOTS + f"/{name}.json": _document(place, shot["document"]) for name, shot in zip(names, shots, strict=True)}
    wanted[MANIFEST] = _json(_manifest(place, names, shots, choices))
    if choices.jobs in {"OPENJD", "ALL"}:
        wanted[OPENJD] = openjd(place.name, len(shots), choices.chunk)
    if choices.jobs in {"FLAMENCO", "ALL"}:
        wanted[FLAMENCO] = (_ENGINES / FLAMENCO).read_text(encoding="utf-8")
    if choices.jobs in {"OPENCUE", "ALL"}:
        wanted[OPENCUE] = opencue(place.name, len(shots), choices.chunk)
    known = {name: list(hashes) for name, hashes in before.get("files", {}).items()}
    for name in wanted:
        _need_own(place / name, known.get(name))
    entries = [_listed(place, name, shot) for name, shot in zip(names, shots, strict=True)]
    new = {name: [_hash(content.encode())] for name, content in wanted.items()}
    # First with the old files too, so that a second try knows all files of one that was ended.
    for hashes in ({name: known.get(name, []) + new.get(name, []) for name in known | new}, known | new):
        _put(place / SENT, _json({"rototoon_sent": VERSION, "shots": entries, "files": hashes}))
        for name, content in wanted.items():
            _put(place / name, content)
        wanted = {}
    return names


def _need_no_others(before: Mapping[str, Any], blends: set[str]) -> None:
    """Shots of other files would leave the manifest, and jobs that wait for them would do these ones."""
    had = [shot.get("blend") for shot in before.get("shots", []) if isinstance(shot, dict)]
    others = sorted({blend for blend in had if blend} - blends)
    if others:
        named = ", ".join(others)
        raise Problem(f"This folder has the batch of {named}: choose another folder, or send all files of a folder together")


def _listed(place: Path, name: str, shot: Mapping[str, Any]) -> dict[str, Any]:
    """What Collect Results needs to know of a shot."""
    entry = {"shot": name, "object": shot["object"], "blend": _relative(place, shot["blend"])}
    return entry | {name: shot[name] for name in ("parts", "lines") if name in shot}


def shot_names(shots: Sequence[Mapping[str, Any]]) -> list[str]:
    """A name for each shot that can be that of a folder: of the file and the object, with a number if it is taken."""
    names: list[str] = []
    taken: set[str] = set()
    for shot in shots:
        stem = os.path.splitext(os.path.basename(shot["blend"]))[0]
        plain = _UNSAFE.sub("_", "_".join(filter(None, (stem, shot["object"])))).lstrip(".").rstrip(". ") or "shot"
        name, number = _cut(plain, ""), 2
        while name.lower() in taken:
            name, number = _cut(plain, f"-{number}"), number + 1
        taken.add(name.lower())
        names.append(name)
    return names


def _cut(text: str, end: str) -> str:
    return text.encode()[: MOST_BYTES - len(end)].decode(errors="ignore").rstrip(". ") + end


def _manifest(place: Path, names: Sequence[str], shots: Sequence[Mapping[str, Any]], choices: Choices) -> dict[str, Any]:
    entries = []
    for name, shot in zip(names, shots, strict=True):
        entry: dict[str, Any] = {"name": name, "project": f"{SHOTS}/{name}.json"}
        if shot["blend"]:
            entry["blend"] = _relative(place, shot["blend"])
        steps = _steps(choices, shot["preset"], bool(shot["document"]["parts"]))
        for do, name in (("trace", "trace"), ("fill", "paint")):
            if name in shot:
                steps.append({"do": do, **shot[name]})
        if steps != _steps(choices, _DEFAULT):
            entry["steps"] = steps
        entries.append(entry)
    return {"rototoon_batch": VERSION, "steps": _steps(choices, _DEFAULT), "shots": entries}


def _steps(choices: Choices, preset: str, contours: bool = True) -> list[dict[str, Any]]:
    if not contours:
        return [{"do": "check"}]
    track = {"do": "track"} if preset == _DEFAULT else {"do": "track", "preset": preset}
    steps: list[dict[str, Any]] = [{"do": "check"}, track]
    if choices.snap:
        steps.append({"do": "snap"})
    if choices.mattes:
        steps.append({"do": "render", "what": "matte", "to": "matte_%04d.png"})
    return steps


def openjd(name: str, shots: int, chunk: int) -> str:
    """The job template of a number of shots."""
    template = json.loads((_ENGINES / OPENJD).read_text(encoding="utf-8"))
    template["name"] = f"Rototoon {re.sub('[{}]', '', name)[:119].strip()}".strip()
    work = template["steps"][0]["parameterSpace"]["taskParameterDefinitions"][0]
    work["range"], work["chunks"]["defaultTaskCount"] = f"1-{shots}", chunk
    return json.dumps(template, indent=2, ensure_ascii=False) + "\n"


def opencue(name: str, shots: int, chunk: int) -> str:
    """The script that sends a number of shots."""
    script = _SCRIPT.read_text(encoding="utf-8")
    plain = re.sub("[^A-Za-z0-9_-]", "_", name)[:100]
    script = re.sub(r"^NAME = .*$", f'NAME = "rototoon_{plain}"', script, count=1, flags=re.M)
    return re.sub(r"^SHOTS, CHUNK = .*$", f"SHOTS, CHUNK = {shots}, {chunk}", script, count=1, flags=re.M)


def _document(place: Path, document: Mapping[str, Any]) -> str:
    return files.text(str(place / SHOTS), document)


def _relative(place: Path, path: str) -> str:
    """A path relative to the batch where they are near each other, else absolute; with forward slashes."""
    if not path:
        return ""
    try:
        near = os.path.relpath(path, place)
    except ValueError:
        # Another drive.
        near = path
    return (path if near.count("..") > files.MOST_UP else near).replace(os.sep, "/")


def _sent(place: Path) -> dict[str, Any]:
    """What was sent from this folder before; empty if nothing was."""
    path = place / SENT
    if not path.exists():
        return {}
    return read_sent(path)


def read_sent(path: Path) -> dict[str, Any]:
    """The list of what was sent."""
    try:
        sent = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise Problem(f"Cannot read {path}: {error.strerror}") from error
    except ValueError:
        sent = None
    if not isinstance(sent, dict) or sent.get("rototoon_sent") != VERSION or not isinstance(sent.get("shots"), list):
        raise Problem(f"{path} is not a list that Send to Farm wrote: choose the folder that it wrote to")
    return sent


def _need_own(path: Path, known: list[str] | None) -> None:
    if path.exists() and (known is None or _hash(path.read_bytes()) not in known):
        what = "was not written by Send to Farm" if known is None else "was changed since it was sent"
        raise Problem(f"{path} {what}: move it away, or choose another folder")


def _hash(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=16).hexdigest()


def _json(value: Any) -> str:
    return json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _put(path: Path, text: str) -> None:
    """Writes a file, whole or not at all."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Problem(f"Cannot make the folder {path.parent}: {error.strerror}") from error
    files.put(str(path), text)
