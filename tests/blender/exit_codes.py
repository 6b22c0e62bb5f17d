"""With an installed Blender: the documentation's background script ends with the status that the page promises.

Started by `cargo xtask press` as `blender --python exit_codes.py -- ZIP PAGE READY`. Each run is a Blender of its own, started as the page says, with
`--python-exit-code`. READY is written at the end, with each status that is not as expected.
"""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import bpy
import shots
import window

ZIP, PAGE, READY = (Path(word).absolute() for word in sys.argv[sys.argv.index("--") + 1 :][:3])
FOLDER = ZIP.parent / "pictures" / "exit"
LOST = 4
"""Frames after which the square is gone, so that its track from one key is lost."""


def blender(*words: str) -> subprocess.CompletedProcess:
    """Starts Blender in the folder, with a configuration of its own."""
    own = os.environ | {"BLENDER_USER_RESOURCES": str(FOLDER / "resources")}
    command = [bpy.app.binary_path, *words]
    return subprocess.run(command, cwd=FOLDER, env=own, capture_output=True, text=True, check=False, timeout=900)


def prepare() -> None:
    """The page's script, footage, keys and the extension, installed as the page says."""
    FOLDER.mkdir(parents=True)
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.S)
    script = next(block for block in blocks if block.startswith("# track_shot.py"))
    (FOLDER / "track_shot.py").write_text(script, encoding="utf-8")
    shots.draw_sequence(FOLDER / "frames")
    for name, keys in (("both", (1, 9)), ("one", (1,))):
        drawn = {str(f): {"square": shots.square(f - 1).tolist()} for f in keys}
        (FOLDER / f"{name}.json").write_text(json.dumps(drawn))
    vanishing = shots.draw_sequence(FOLDER / "vanishing").parent
    for frame in range(LOST, shots.COUNT + 1):
        shots.write_png(vanishing / f"shot_{frame:03d}.png", shots.np.full((90, 160, 3), (235, 228, 210), shots.np.uint8))
    installed = blender("--command", "extension", "install-file", "--repo", "user_default", "--enable", str(ZIP))
    if installed.returncode:
        raise RuntimeError(f"the zip was not installed: {installed.stdout}{installed.stderr}")


RUNS = (
    ("two keys", 0, ("frames/shot_001.png", "both.json", "shot.blend")),
    ("no such file", 1, ("frames/shot_999.png", "both.json", "none.blend")),
    ("an argument is missing", 2, ("frames/shot_001.png",)),
    ("a part is lost", 3, ("vanishing/shot_001.png", "one.json", "lost.blend")),
)
"""What is tried, the status that the page promises, and the arguments."""


def session():
    """All runs; yields the seconds until it goes on."""
    yield 0.1
    prepare()
    faults = []
    for what, status, words in RUNS:
        ended = blender("--background", "--python-exit-code", "1", "--python", "track_shot.py", "--", *words)
        print(f"exit code: {what}: {ended.returncode}", flush=True)
        if ended.returncode != status:
            faults.append(f"{what}: status {ended.returncode} instead of {status}: {(ended.stdout + ended.stderr)[-300:]!r}")
        yield 0.1
    return "\n".join(["ready", *faults])


window.run(session(), READY)
