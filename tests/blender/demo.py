"""The main job in one Blender: install the zip, import a project, track, snap, save, render.

Started by `cargo xtask demo`, either by the Python of a `bpy` wheel or by Blender itself with `--background --python`.
Writes into --out: demo.blend, tracked.json, renders/*.png (strokes on nothing) and report.json.
"""

import argparse
import json
import os
import sys
import time
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


def install(path: Path) -> None:
    """Installs and enables the extension; Blender says FINISHED even if that failed, so the module is looked at."""
    import addon_utils

    addon_utils.enable("bl_pkg")
    bpy.ops.extensions.package_install_files(filepath=str(path), repo="user_default", enable_on_install=True)
    if MODULE not in bpy.context.preferences.addons:
        raise SystemExit(f"{path} was not installed and enabled")


def timed(seconds: dict[str, float], step: str, operator, **parameters) -> None:
    """Calls an operator; anything but FINISHED ends the demo."""
    start = time.perf_counter()
    result = operator(**parameters)
    seconds[step] = time.perf_counter() - start
    if result != {"FINISHED"}:
        raise SystemExit(f"{step}: {result}")
    print(f"{step}: {seconds[step]:.2f} s", flush=True)


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


def main() -> None:
    """The whole job."""
    options, seconds = arguments(), {}
    out = options.out.resolve()
    timed(seconds, "install", lambda: install(options.zip.resolve()) or {"FINISHED"})
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    timed(seconds, "import", bpy.ops.rototoon.import_document, filepath=str(options.project.resolve()), keep_numbers=True)
    timed(seconds, "track", bpy.ops.rototoon.track)
    timed(seconds, "snap", bpy.ops.rototoon.snap)
    timed(seconds, "export", bpy.ops.rototoon.export_document, filepath=str(out / "tracked.json"), check_existing=False)
    timed(seconds, "save", bpy.ops.wm.save_as_mainfile, filepath=str(out / "demo.blend"), compress=True)
    scene = bpy.context.scene
    prepare_rendering(scene)
    renders = render(scene, out, options.pictures, seconds)
    report = {"blender": bpy.app.version_string, "seconds": seconds, "renders": renders}
    (out / "report.json").write_text(json.dumps(report, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    # Blender 4.5 may never return from its exit once something was undone.
    os._exit(0)
