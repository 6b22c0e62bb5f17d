"""Draws the pictures of good and bad keys for the documentation, from the sample cartoon.

    python docs/tools/key_pictures.py ROTOTOON SAMPLE OUT

ROTOTOON is the command line program, SAMPLE the folder of the sample cartoon (`cargo xtask demo` writes it to
`target/demo/sample`), OUT the folder of the pictures. Needs Pillow.
"""

import copy
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

FRAME = "0"
WHOLE = (120, 60, 480, 510)
"""The figure on the frame: left, top, right, bottom."""
ARM = (320, 270, 450, 365)


def named(document: dict, *names: str) -> dict:
    """The document with these parts alone; all of them without names."""
    made = copy.deepcopy(document)
    if names:
        made["parts"] = [part for part in made["parts"] if part["name"] in names]
    return made


def changed(document: dict, change) -> dict:
    """The document with each part's key replaced by `change(points)`."""
    made = copy.deepcopy(document)
    for part in made["parts"]:
        part["keys"] = {FRAME: change(part["keys"][FRAME])}
    return made


def hull(document: dict) -> dict:
    """One contour around all parts: the farthest point in each direction from the middle."""
    points = [point for part in document["parts"] for point in part["keys"][FRAME]]
    middle = [sum(axis) / len(points) for axis in zip(*points)]
    found = {}
    for x, y in points:
        dx, dy = x - middle[0], y - middle[1]
        sector = int((math.atan2(dy, dx) + math.pi) / math.tau * 36)
        if math.hypot(dx, dy) > math.hypot(*found.get(sector, ((0, 0), None))[0]):
            found[sector] = ((dx, dy), [x, y])
    part = copy.deepcopy(document["parts"][0])
    part |= {"name": "figure", "closed": True, "keys": {FRAME: [found[sector][1] for sector in sorted(found)]}}
    return document | {"parts": [part]}


def main() -> None:
    """Renders each document and cuts its picture out."""
    program, sample, out = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    document = json.loads((sample / "project.json").read_text(encoding="utf-8"))
    document["footage"]["pattern"] = str((sample / document["footage"]["pattern"]).resolve())
    document = changed({**document, "limbs": []}, lambda points: points)
    arm = named(document, "far arm")
    pictures = {
        "keys_parts": (document, WHOLE, 1),
        "keys_one_outline": (hull(document), WHOLE, 1),
        "keys_points": (arm, ARM, 3),
        "keys_few_points": (changed(arm, lambda points: points[::3]), ARM, 3),
        "keys_off_line": (changed(arm, lambda points: [[x + 6, y + 4] for x, y in points]), ARM, 3),
    }
    with tempfile.TemporaryDirectory() as folder:
        for name, (made, box, scale) in pictures.items():
            project, picture = Path(folder) / "project.json", Path(folder) / "picture.png"
            project.write_text(json.dumps(made), encoding="utf-8")
            command = [program, "render", project, "-o", picture, "--frames", FRAME, "--confidence", "off"]
            subprocess.run([str(word) for word in command], check=True)
            cut = Image.open(picture).convert("RGB").crop(box)
            cut = cut.resize((cut.width * scale, cut.height * scale), Image.LANCZOS)
            cut.quantize(200).save(out / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
