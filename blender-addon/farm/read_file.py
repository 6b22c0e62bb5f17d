"""Reads the contours, the lines and the paint of a Blender file, in a Blender of its own. `files` starts it:

    blender --background FILE.blend --python read_file.py -- MODULE FILE.blend OUT.json LINES
    python read_file.py -- MODULE FILE.blend OUT.json LINES          (with the wheel `bpy`)

MODULE is the add-on's name. LINES says which lines are sent: a `tracing.Wanted` as JSON. OUT gets the shots of all scenes as JSON, and why objects were
left out. The file is not changed.
"""

import importlib
import json
import os
import sys

import bpy


def main(module: str, path: str, out: str, lines: str) -> None:
    """Writes the shots of a file."""
    if module not in bpy.context.preferences.addons:
        import addon_utils  # part of Blender: there once bpy is imported

        addon_utils.enable("bl_pkg")
        addon_utils.enable(module)
    if not os.path.exists(bpy.data.filepath) or not os.path.samefile(bpy.data.filepath, path):
        bpy.ops.wm.open_mainfile(filepath=path)
    sending = importlib.import_module(f"{module}.farm.sending")
    wanted = importlib.import_module(f"{module}.farm.tracing").Wanted(**json.loads(lines))
    shots, left = sending.shots_of(bpy.context.scene.objects, path, wanted)
    with open(out, "w", encoding="utf-8") as file:
        json.dump({"shots": shots, "left": left}, file)


if __name__ == "__main__":
    try:
        main(*sys.argv[sys.argv.index("--") + 1 :])
        status = 0
    except Exception as error:  # noqa: BLE001 - whoever started it tells the artist
        print(f"rototoon: {error}", file=sys.stderr)
        status = 1
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # Blender 4.5 may hang at exit
