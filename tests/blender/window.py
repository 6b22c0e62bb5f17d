"""Helpers for scripts that run in a Blender window: areas, pictures of the screen, mouse and keys, and a session in steps.

Such a script is started with a virtual screen by `cargo xtask photograph`, `press` or `bench-window`. Its work is a generator that yields the
seconds until it goes on, so that Blender draws and handles events in between.
"""

import subprocess
import time
import traceback
from pathlib import Path

import bpy
import numpy as np

MODULE = "bl_ext.user_default.rototoon"
TAB = "Rototoon"
PAUSE = 0.1
"""Seconds between two events of the mouse or the keyboard."""
FRAMEBUFFER = Path("Xvfb_screen0").absolute()
"""The file in which Xvfb keeps the screen, in the format of xwd."""
ARRIVAL = 0.04
"""Seconds until what Blender has drawn is on the screen."""
SMALL = ("-resize", "1200x>", "-strip", "+dither", "-colors", "256", "-define", "png:compression-level=9")
"""Options of `save` for pictures of the documentation."""


def main_window() -> bpy.types.Window:
    """The window that Blender opened first."""
    return bpy.context.window_manager.windows[0]


def view() -> tuple[bpy.types.Area, bpy.types.Region, bpy.types.Region]:
    """The 3D view, its drawing region and its sidebar."""
    area = next(area for area in main_window().screen.areas if area.type == "VIEW_3D")
    regions = {region.type: region for region in area.regions}
    return area, regions["WINDOW"], regions["UI"]


def in_view():
    """The context of the 3D view."""
    area, region, _ = view()
    return bpy.context.temp_override(window=main_window(), area=area, region=region)


def install(zip_path: Path) -> None:
    """Installs and enables the extension."""
    import addon_utils

    addon_utils.enable("bl_pkg")
    bpy.ops.extensions.package_install_files(filepath=str(zip_path), repo="user_default", enable_on_install=True)
    if MODULE not in bpy.context.preferences.addons:
        raise RuntimeError(f"{zip_path} was not installed and enabled")


def redrawn(whole: bool = False) -> None:
    """Draws the sidebar now, and all else that Blender knows to have changed. The whole window takes twice as long."""
    area, _, sidebar = view()
    with bpy.context.temp_override(window=main_window(), area=area, region=sidebar):
        bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP" if whole else "DRAW_SWAP", iterations=1)


def filled() -> None:
    """Closes all editors but the 3D view, so that little is drawn: without a graphics card each costs time."""
    for area in [area for area in main_window().screen.areas if area.type != "VIEW_3D"]:
        with bpy.context.temp_override(window=main_window(), area=area, region=area.regions[0]):
            bpy.ops.screen.area_close()


# -- pictures ------------------------------------------------------------------------------------------------------


def screen() -> np.ndarray:
    """The screen's pixels (height, width, 3), the top row first. Blender's own screenshots are black without a graphics card."""
    time.sleep(ARRIVAL)
    values = np.memmap(FRAMEBUFFER, np.uint8, "r")
    words = values[:100].view(">u4")
    header, width, height, row, colours = (int(words[place]) for place in (0, 4, 5, 12, 19))
    start = header + 12 * colours
    pixels = values[start : start + height * row].reshape(height, row)[:, : 4 * width].reshape(height, width, 4)
    return pixels[:, :, 2::-1].copy()


_saving: list[subprocess.Popen] = []


def save(path: Path, pixels: np.ndarray, *options: str) -> None:
    """Writes pixels (height, width, 3) as a PNG, beside the session's work. `run` waits for the last ones."""
    path.parent.mkdir(parents=True, exist_ok=True)
    height, width = pixels.shape[:2]
    raw = path.with_suffix(".ppm")
    raw.write_bytes(b"P6\n%d %d\n255\n" % (width, height) + np.ascontiguousarray(pixels).tobytes())
    while len(_saving) > 1:
        _saved()
    words = options or ("-define", "png:compression-level=2")
    _saving.append(subprocess.Popen(["convert", str(raw), *words, str(path)]))


def _saved() -> None:
    """Waits for the oldest picture."""
    running = _saving.pop(0)
    if running.wait():
        raise RuntimeError(f"{' '.join(running.args)} failed with status {running.returncode}")
    Path(running.args[1]).unlink()


def rows_of(pixels: np.ndarray, region) -> tuple[slice, slice]:
    """The rows and columns of the screen that a region takes."""
    bottom = pixels.shape[0] - region.y
    return slice(bottom - region.height, bottom), slice(region.x, region.x + region.width)


def of_region(pixels: np.ndarray, region) -> np.ndarray:
    """The part of the screen that a region takes."""
    return pixels[rows_of(pixels, region)]


# -- mouse and keys --------------------------------------------------------------------------------------------------


_mouse = [0, 0]


def moved(x: float, y: float, window=None):
    """Moves the mouse to a place in the window; y counts from below. Blender must run with `--enable-event-simulate`."""
    _mouse[:] = round(x), round(y)
    for nudge in (1, 0):
        (window or main_window()).event_simulate(type="MOUSEMOVE", value="NOTHING", x=round(x) + nudge, y=round(y))
        yield PAUSE


def clicked(x: float, y: float, **keys):
    """Clicks with the left button."""
    yield from moved(x, y)
    for value in ("PRESS", "RELEASE"):
        main_window().event_simulate(type="LEFTMOUSE", value=value, x=round(x), y=round(y), **keys)
        yield PAUSE


def typed(*names: str, window=None):
    """Presses keys one after the other: Blender's names, or a single character."""
    for name in names:
        digits = dict(zip("0123456789", "ZERO ONE TWO THREE FOUR FIVE SIX SEVEN EIGHT NINE".split()))
        kind = digits.get(name, name.upper() if len(name) == 1 else name)
        text = {"unicode": name} if len(name) == 1 else {}
        for value, more in (("PRESS", text), ("RELEASE", {})):
            (window or main_window()).event_simulate(type=kind, value=value, x=_mouse[0], y=_mouse[1], **more)
            yield PAUSE


# -- the session -----------------------------------------------------------------------------------------------------


def run(steps, ready: Path) -> None:
    """Runs a session. Writes `ready`, or what went wrong, into the file that the waiting program looks for."""

    def step() -> float | None:
        try:
            return next(steps)
        except StopIteration as end:
            while _saving:
                _saved()
            ready.write_text(end.value or "ready", encoding="utf-8")
        except BaseException as error:
            traceback.print_exc()
            ready.write_text(f"failed: {error}", encoding="utf-8")
            raise
        return None

    bpy.app.timers.register(step, first_interval=1.0, persistent=True)
