"""In a Blender with a window: every button of the tab Rototoon is pressed with the mouse, in both themes and at two sizes of the texts.

Started by `cargo xtask press` as `blender --enable-event-simulate --python press.py -- ZIP OUT READY [VARIANT…]`. OUT gets a folder for each
variant: the picture of each panel, the window after each press, and `pressed.md`. READY is written at the end, with all faults.

The list of buttons comes from the panels themselves. For each operator the file of `studio.py` is made ready as its table says, and every button
of that operator is pressed, in every panel that has one. Properties are changed as an artist changes them, by typing or from their menu, and set
back. A fault is

- a button after which Blender prints an error, or which ends with an error report,
- a button of an operator after which nothing is said, or of a property after which nothing differs,
- a button that can't be seen, or that is grey where the table says that the operator works,
- an operator of the add-on that no panel has, unless `ELSEWHERE` says where it is.
"""

import importlib
import sys
import time
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import bpy
import layouts
import numpy as np
import press_paint
import press_scenes
import studio
import tab
import window
from tab import BODY, HEADER, Button
from window import MODULE, main_window, view

WORDS = sys.argv[sys.argv.index("--") + 1 :]
ZIP, OUT, READY = (Path(word).absolute() for word in WORDS[:3])
ONLY = set(",".join(WORDS[4:]).split(",")) - {""}
"""For work on one button: names of the functions below and of operators. All by default."""
LOG = Path("blender.log").absolute()
VARIANTS = {"dark-1x": ("Dark", 1.0), "light-1x": ("Light", 1.0), "dark-2x": ("Dark", 2.0), "light-2x": ("Light", 2.0)}
LONGEST = 180
"""Seconds until an operator must have ended."""
ELSEWHERE: dict[str, str] = {}
"""Operators without a button in the tab, and where they are."""
LEAVE = {"match_lines": "RET", "match_strokes": "RET", "paint_bucket": "RET"}
"""Keys that end operators which go on until the artist ends them."""
ENTRY = {"choose_body": 2}
"""Entries of menus that are chosen, counted from the last: after that of Choose Body a file is asked for."""
QUIET = {"show_confidence"}
"""Operators whose result is seen at once, so that they say nothing."""
DIALOGS = {"recolour", "save_clip", "save_clip_from_armature", "depth_mark", "reshape_drawing", "reshape_picture", "apply_motion", "drive_bones"}
"""Operators that ask first, in a dialog with an OK."""
NOTICES = ("press: ", "Info: Saved", "Read blend", "Saved as", "mounted file-systems", " × Draw ")
"""What Blender prints whatever is pressed."""
SEEN = 12
"""Number of pixels from which on two pictures differ: the text cursor alone has fewer."""

MENU = 1500
"""Number of pixels from which on a menu has opened."""


@dataclass
class Press:
    """One press and what came of it."""

    panel: str
    button: str
    said: str
    fault: str = ""


class Session:
    """One variant: its folder, and what was pressed."""

    def __init__(self, folder: Path):
        self.folder, self.presses, self.keys = folder, [], set()

    def note(self, panel, button: Button, said: str, fault: str = "") -> None:
        """Keeps a press, and a picture of the window after it."""
        found = Press(tab.title(panel), str(button), said, fault)
        self.presses.append(found)
        self.keys.add((found.panel, button.key))
        name = "".join(c if c.isalnum() else "_" for c in f"{found.panel}_{found.button}")[:60]
        window.save(self.folder / f"{len(self.presses):03d}_{name}.png", window.screen())
        print(f"press: {self.folder.name}: {found.panel}: {found.button}: {said}{' FAULT ' + fault if fault else ''}", flush=True)


def addon(name: str):
    """A module of the installed add-on, or of the Python package that comes with it."""
    if name.partition(".")[0] == "rototoon":
        return importlib.import_module(name)
    return importlib.import_module(f"{MODULE}.{name}")


def said_since(start: int) -> list[str]:
    """What Blender printed since its log had `start` bytes, without its own notices."""
    with LOG.open("rb") as file:
        file.seek(start)
        lines = file.read().decode(errors="replace").splitlines()
    return [line for line in lines if line.strip() and not any(notice in line for notice in NOTICES)]


def failed(lines: list[str]) -> str:
    """The first line that reports an error; empty if there is none."""
    return next((line for line in lines if "Traceback" in line or "Error" in line or "ERROR" in line), "")


def look() -> np.ndarray:
    """The window as it is, without the time of redraws in it."""
    window.redrawn(whole=True)
    return window.screen()


def settled():
    """The window once two pictures of it are equal: after a file was opened, the view is drawn several times."""
    before = look()
    for _ in range(8):
        yield 0.2
        now = look()
        if not differing(before, now):
            break
        before = now
    return now


def differing(before: np.ndarray, after: np.ndarray) -> int:
    """Number of pixels that differ clearly."""
    return int((np.abs(before.astype(np.int16) - after) > 24).any(2).sum())


# -- operators -------------------------------------------------------------------------------------------------------


def buttons_of(panel, name: str) -> bool:
    """Whether a panel has a button of an operator now."""
    with window.in_view():
        if hasattr(panel, "poll") and not panel.poll(bpy.context):
            return False
        return any(entry[0] == "operator" and entry[1] == f"rototoon.{name}" for entry in layouts.draw(panel))


def every_operator(session: Session, every: list):
    """Presses all buttons of every operator."""
    named = [name for name in studio.OPERATORS if name in ONLY]
    for name in named or [name for name in studio.OPERATORS if name != "help"]:
        press_scenes.ready(addon, name)
        yield 0.3
        panels, fresh = [panel for panel in every if buttons_of(panel, name)], True
        for panel in panels:
            fresh = yield from buttons_in(session, every, panel, name, fresh)


def buttons_in(session: Session, every: list, panel, name: str, fresh: bool):
    """Presses all buttons of an operator in a panel, each in the file as it should be. It is so already if `fresh`; returns whether it still
    is."""
    done = set()
    while True:
        if not fresh:
            press_scenes.ready(addon, name)
        yield from alone(every, panel)
        found = [(i, b) for i, b in enumerate(BODY.buttons) if b.name == f"rototoon.{name}" and b.key not in done]
        if found:
            index, button = found[0]
            done.add(button.key)
            yield from press_operator(session, panel, BODY, index, name)
            fresh = False
        if len(found) < 2:
            return fresh


def every_step(session: Session, every: list):
    """Presses the buttons of the panel Steps, which has another one at each step of the work."""
    panel = next(panel for panel in every if tab.title(panel) == "start")
    for name in press_scenes.STEPS:
        press_scenes.step(addon, name)
        yield from alone(every, panel)
        found = [i for i, button in enumerate(BODY.buttons) if button.name == f"rototoon.{name}"]
        if found:
            yield from press_operator(session, panel, BODY, found[0], name)
        else:
            there = ", ".join(map(str, BODY.buttons))
            session.presses.append(Press("start", name, "", f"the panel has no such button at its step, but {there}"))


def alone(every: list, panel):
    """Shows a panel alone, its buttons noted."""
    # Where the mouse is, a button is bright, and its tooltip covers others.
    yield from window.moved(*press_scenes.aside())
    tab.only(every, panel, noted=True)
    yield from tab.shown()
    for _ in range(20):
        yield 0.1
        window.redrawn()
        if HEADER.buttons or BODY.buttons:
            break
    # Headers and shelves come and go with the mode, and move the panel.
    yield from settled()


def press_operator(session: Session, panel, notes, index: int, name: str):
    """Presses a button of an operator and waits for its end."""
    button = notes.buttons[index]
    box = tab.places(notes)[index]
    if box is None:
        session.note(panel, button, "", "it can't be seen or is grey where the operator should work")
        return
    yield from window.moved(*press_scenes.aside())
    before = look()
    start = LOG.stat().st_size
    addon("common.reports").take()
    yield from window.clicked((box[0] + box[1]) / 2, (box[2] + box[3]) / 2)
    yield 0.3
    yield from answered(name, button, before)
    yield from ended(name)
    yield from window.moved(*press_scenes.aside())
    yield 0.3
    after = look()
    lines = said_since(start)
    reports = addon("common.reports").take()
    errors = [report.text for report in reports if report.kind == "ERROR"]
    fault = failed(lines) or "; ".join(errors)
    said = "; ".join(report.text for report in reports) or "; ".join(lines)
    if not fault and not said and (name not in QUIET or differing(before, after) < SEEN):
        fault = "it said nothing" if name in QUIET else "it said nothing: does it ask something?"
    session.note(panel, button, said, fault)
    yield from window.typed("ESC")


def answered(name: str, button: Button, before: np.ndarray):
    """Answers what a button asks: which entry of its menu (the last, if `ENTRY` has no other), which file, whether to go on."""
    if button.kind == "operator_menu_enum":
        yield from window.typed(*["UP_ARROW"] * ENTRY.get(name, 1), "RET")
        yield 0.3
    if name in DIALOGS:
        yield from confirmed(before)
    browser = file_browser()
    if browser is not None:
        yield 0.5
        choose(browser, name)
        yield 0.3
        with bpy.context.temp_override(window=browser, area=browser.screen.areas[0]):
            bpy.ops.file.execute()
        yield 0.5


def confirmed(before: np.ndarray):
    """Clicks OK, in the lower right corner of a dialog: that is the large rectangle in which the window differs."""
    now = look()
    differs = (np.abs(before.astype(np.int16) - now) > 8).any(2)
    across = _most(differs.sum(0))
    down = _most(differs[:, across[0] : across[-1] + 1].sum(1))
    left, right, bottom = across[0], across[-1], now.shape[0] - down[-1]
    yield from window.clicked(right - 0.25 * (right - left), bottom + 17 * bpy.context.preferences.view.ui_scale)
    yield 0.3


def _most(sums: np.ndarray) -> np.ndarray:
    """The indices of the rows or columns that a large rectangle fills."""
    return np.flatnonzero(sums > 0.7 * sums.max())


def file_browser():
    """The window of the file browser, if it is open."""
    windows = bpy.context.window_manager.windows
    return next((w for w in windows if any(area.type == "FILE_BROWSER" for area in w.screen.areas)), None)


def choose(browser, name: str) -> None:
    """Sets the file browser to the file or the folder that the table names."""
    found = press_scenes.options(name)
    folder, file = (Path(found["filepath"]).parent, Path(found["filepath"]).name) if "filepath" in found else (found["directory"], "")
    Path(folder).mkdir(parents=True, exist_ok=True)
    params = next(area for area in browser.screen.areas if area.type == "FILE_BROWSER").spaces.active.params
    params.directory = str(folder).encode()
    if file:
        params.filename = file


def ended(name: str):
    """Waits until the operator has ended, and ends it if it waits for the artist."""
    started = time.monotonic()
    while any("ROTOTOON" in op.bl_idname for op in main_window().modal_operators):
        if time.monotonic() - started > LONGEST:
            raise RuntimeError(f"{name} did not end in {LONGEST} s")
        yield 0.3
        if name in LEAVE and time.monotonic() - started > 1.5:
            yield from window.typed(LEAVE[name])


def every_help(session: Session, every: list):
    """Presses the help button of each panel."""
    for panel in every:
        press_scenes.ready(addon, "guess_bones" if tab.title(panel) == "bones" else "track")
        yield from alone(every, panel)
        yield from press_operator(session, panel, HEADER, 0, "help")


def every_click(session: Session, every: list):
    """Paints with the mouse."""
    tab.only(every, None)
    panel = next(panel for panel in every if tab.title(panel) == "paint")
    start = LOG.stat().st_size

    def note(step: str, said: str, fault: str) -> None:
        nonlocal start
        session.note(panel, Button("mouse", step), said, failed(said_since(start)) or fault)
        start = LOG.stat().st_size

    yield from press_paint.painted(addon, OUT.parent / "film", note)


# -- properties ------------------------------------------------------------------------------------------------------


def every_property(session: Session, every: list):
    """Changes each property of each panel as an artist does, and sets it back."""
    for panel in every:
        for state in ("guess_bones",) if tab.title(panel) == "bones" else ("update_in_betweens",):
            press_scenes.ready(addon, state)
            yield from alone(every, panel)
            buttons, boxes = list(BODY.buttons), tab.places(BODY)
            for index, button in enumerate(buttons):
                if button.kind.startswith("operator") or (tab.title(panel), button.key) in session.keys:
                    continue
                if [each.key for each in BODY.buttons] != [each.key for each in buttons]:
                    # The last property changed what the panel shows.
                    press_scenes.ready(addon, state)
                    yield from alone(every, panel)
                    boxes = tab.places(BODY)
                yield from press_property(session, panel, index, boxes[index])


def press_property(session: Session, panel, index: int, box):
    """Changes a property with mouse and keys. It must have another value then, or a menu must be open."""
    button = BODY.buttons[index]
    if box is None:
        session.note(panel, button, "", "it can't be seen or is grey")
        return
    yield from window.moved(*press_scenes.aside())
    before, start, old = look(), LOG.stat().st_size, value_of(button)
    kind = kind_of(button)
    menu = kind in ("ENUM", "POINTER", "COLOR") or button.kind in ("prop_search", "menu")
    x = box[0] + (10 if kind == "BOOLEAN" else round(0.75 * (box[1] - box[0])))
    yield from window.clicked(x, (box[2] + box[3]) / 2, **({"ctrl": True} if button.row and kind == "STRING" else {}))
    keys = {"STRING": "x", "INT": "7", "FLOAT": "7"}
    if not menu and kind in keys:
        yield from window.typed(keys[kind], "RET")
    yield 0.2
    if menu:
        yield from opened(before)
    after, new = look(), value_of(BODY.buttons[index] if index < len(BODY.buttons) else button)
    fault = failed(said_since(start))
    if not fault and new == old and (not menu or differing(before, after) < MENU):
        fault = "its value is as before, and no menu opened"
    session.note(panel, button, f"{old!r} to {new!r}" if new != old else "a menu opened", fault)
    yield from window.typed("ESC")
    if new != old:
        setattr(button.data, button.name, old)
        yield 0.2
        window.redrawn()


def kind_of(button: Button) -> str:
    """The type of a property; `COLOR` for a colour, whose button opens a picker. Empty for buttons without one."""
    if not button.kind.startswith("prop"):
        return ""
    found = button.data.bl_rna.properties[button.name]
    return "COLOR" if found.subtype.startswith("COLOR") else found.type


def opened(before: np.ndarray):
    """Waits for a menu. On a machine with other work it may take a while."""
    for _ in range(20):
        if differing(before, look()) >= MENU:
            return
        yield 0.2


def value_of(button: Button):
    """A property's value; `None` for buttons without one."""
    if not button.kind.startswith("prop") or button.data is None:
        return None
    value = getattr(button.data, button.name)
    return value if isinstance(value, (str, int, float, bool, type(None), bpy.types.ID)) else str(value)


# -- the whole -------------------------------------------------------------------------------------------------------


def wear(theme: str, scale: float) -> None:
    """Sets theme and size."""
    if theme == "Dark":
        bpy.ops.preferences.reset_default_theme()
    else:
        found = [Path(folder) / "Blender_Light.xml" for folder in bpy.utils.preset_paths("interface_theme")]
        path = next(path for path in found if path.is_file())
        bpy.ops.script.execute_preset(filepath=str(path), menu_idname="USERPREF_MT_interface_theme_presets")
    bpy.context.preferences.view.ui_scale = scale
    # Otherwise the view shines through the panels.
    bpy.context.preferences.system.use_region_overlap = False


def every_panel(session: Session, every: list):
    """Photographs each panel as an artist sees it."""
    for panel in every:
        press_scenes.ready(addon, "guess_bones" if tab.title(panel) == "bones" else "update_in_betweens")
        tab.only(every, panel)
        yield from tab.shown()
        yield 0.3
        window.save(session.folder / f"panel_{tab.title(panel)}.png", cropped(window.of_region(look(), view()[2])))


def cropped(pixels: np.ndarray) -> np.ndarray:
    """A sidebar without the empty space below its panel."""
    rows = np.flatnonzero((np.abs(pixels[:, :-60].astype(np.int16) - pixels[-12, 4]) > 8).any(2).mean(1) > 0.2)
    return pixels[: rows[-1] + 8] if len(rows) else pixels


def session():
    """Everything, in order; yields the seconds until it goes on."""
    yield 1.0
    window.install(ZIP)
    press_scenes.build(addon, OUT.parent / "studio")
    yield 0.5
    window.filled()
    yield 0.5
    tab.watch_lists()
    every, faults = tab.panels(), []
    for variant in WORDS[3].split(",") if len(WORDS) > 3 else VARIANTS:
        wear(*VARIANTS[variant])
        found = Session(OUT / variant)
        found.folder.mkdir(parents=True, exist_ok=True)
        for work in (every_panel, every_property, every_operator, every_step, every_click, every_help):
            if not ONLY or work.__name__ in ONLY:
                started = time.monotonic()
                yield from work(found, every)
                print(f"press: {variant}: {work.__name__}: {time.monotonic() - started:.0f} s", flush=True)
        if not ONLY:
            missing(found)
        write(found)
        faults += [f"{variant}: {p.panel}: {p.button}: {p.fault}" for p in found.presses if p.fault]
    tab.only(every, None)
    return "\n".join(["ready", *faults])


def missing(session: Session) -> None:
    """Notes the operators that were not pressed."""
    pressed = {key[1][1].removeprefix("rototoon.") for key in session.keys}
    for name in sorted(set(studio.OPERATORS) - pressed - set(ELSEWHERE)):
        session.presses.append(Press("", name, "", "no panel has a button of this operator"))


def write(session: Session) -> None:
    """The table of all presses."""
    text = "| | panel | button | what came of it | fault |\n| ---: | --- | --- | --- | --- |\n"
    for number, press in enumerate(session.presses, 1):
        cells = [str(number), press.panel, press.button, press.said, press.fault]
        text += "| " + " | ".join(cell.replace("|", "/").replace("\n", " ") for cell in cells) + " |\n"
    (session.folder / "pressed.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    window.run(session(), READY)
