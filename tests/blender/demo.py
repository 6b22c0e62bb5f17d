"""The main job in one Blender: install the zip, import a project, track, snap, save, render.

Started by `cargo xtask demo`, either by the Python of a `bpy` wheel or by Blender itself with `--background --python`.
Writes into --out: demo.blend (first as soon as contours are tracked), tracked.json, renders/*.png (strokes on nothing), report.json,
and blender.log with what Blender says meanwhile.
"""

import argparse
import json
import os
import sys
import time
import traceback
from pathlib import Path

import bpy

MODULE = "bl_ext.user_default.rototoon"


def arguments() -> argparse.Namespace:
    """What follows `--` inside Blender, everything under plain Python."""
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--zip", type=Path, required=True)
    parser.add_argument("--project", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--pictures", type=int, default=12)
    return parser.parse_args(words)


def quiet(log: Path):
    """Sends what Blender prints to a file; returns where our own words go."""
    sys.stdout.flush()
    own = os.fdopen(os.dup(1), "w", buffering=1)
    file = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
    os.dup2(file, 1)
    os.dup2(file, 2)
    return own


def install(path: Path) -> None:
    """Installs and enables the extension; Blender says FINISHED even if that failed, so the module is looked at."""
    import addon_utils

    addon_utils.enable("bl_pkg")
    bpy.ops.extensions.package_install_files(filepath=str(path), repo="user_default", enable_on_install=True)
    if MODULE not in bpy.context.preferences.addons:
        raise RuntimeError(f"{path} was not installed and enabled")


def timed(own, seconds: dict[str, float], step: str, operator, **parameters) -> None:
    """Calls an operator; anything but FINISHED ends the demo."""
    start = time.perf_counter()
    result = operator(**parameters)
    seconds[step] = time.perf_counter() - start
    if result != {"FINISHED"}:
        raise RuntimeError(f"{step}: {result}")
    print(f"{step}: {seconds[step]:.2f} s", file=own)


def prepare_rendering(scene: bpy.types.Scene) -> None:
    """Strokes alone, on a transparent ground, in their own colours."""
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.render.film_transparent = True
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.view_settings.view_transform = "Standard"
    scene.display.shading.light = "FLAT"
    scene.display.shading.color_type = "MATERIAL"
    scene.display.render_aa = "8"


def first_result(own, out: Path) -> None:
    """Saves the tracked file as soon as there is something to see."""
    path = out / "demo.blend"
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)
    print(f"first result: the tracked contours are in {path}; snapped lines and pictures follow", file=own)


def render(scene: bpy.types.Scene, out: Path, count: int, seconds: dict[str, float]) -> dict[str, str]:
    """Renders `count` frames spread over the scene; returns file names by frame number."""
    first, last = scene.frame_start, scene.frame_end
    count = min(count, last - first + 1)
    frames = [first + round(i * (last - first) / max(count - 1, 1)) for i in range(count)]
    files = {}
    start = time.perf_counter()
    for frame in frames:
        scene.frame_set(frame)
        files[str(frame)] = f"renders/strokes_{frame:04d}.png"
        scene.render.filepath = str(out / files[str(frame)])
        bpy.ops.render.render(write_still=True)
    seconds[f"render {len(frames)} pictures"] = time.perf_counter() - start
    return files


def main(options: argparse.Namespace, out: Path, own) -> None:
    """The whole job."""
    seconds: dict[str, float] = {}
    timed(own, seconds, "install", lambda: install(options.zip.resolve()) or {"FINISHED"})
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    project, tracked = str(options.project.resolve()), str(out / "tracked.json")
    timed(own, seconds, "import", bpy.ops.rototoon.import_document, filepath=project, keep_numbers=True)
    timed(own, seconds, "track", bpy.ops.rototoon.track)
    first_result(own, out)
    timed(own, seconds, "snap", bpy.ops.rototoon.snap)
    timed(own, seconds, "export", bpy.ops.rototoon.export_document, filepath=tracked, check_existing=False)
    timed(own, seconds, "save", bpy.ops.wm.save_as_mainfile, filepath=str(out / "demo.blend"), compress=True)
    scene = bpy.context.scene
    prepare_rendering(scene)
    renders = render(scene, out, options.pictures, seconds)
    report = {"blender": bpy.app.version_string, "seconds": seconds, "renders": renders}
    (out / "report.json").write_text(json.dumps(report, indent=1), encoding="utf-8")


def run() -> int:
    """Runs the job; returns the exit status."""
    options = arguments()
    out = options.out.resolve()
    own = quiet(out / "blender.log")
    try:
        main(options, out, own)
    except Exception:  # told on the real output, which Blender no longer has
        traceback.print_exc(file=own)
        print(f"what Blender said is in {out / 'blender.log'}", file=own)
        return 1
    finally:
        own.flush()
    return 0


if __name__ == "__main__":
    # Blender 4.5 may never return from its exit once something was undone.
    os._exit(run())
