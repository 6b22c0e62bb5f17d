"""The panels of the tab Rototoon in a window: one of them alone and open, and where each of its buttons is.

Blender tells no script where it draws a button. So the panel is drawn with a layout that passes everything on, notes each button, and
greys some of them out on demand: where two pictures differ, these buttons are. Each digit of a button's number in binary
has two pictures: in one the buttons are grey that have a 1 there, in the other those that have a 0. So n buttons take 2 + 2 log2(n) pictures.
"""

import importlib
import time
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import window
from window import MODULE, TAB, view

PATIENCE = 120
"""Seconds until the tab must be there."""
PARTS = ("row", "column", "box", "split", "grid_flow", "column_flow")
ITEMS = ("operator", "operator_menu_enum", "prop", "prop_search", "prop_menu_enum", "menu", "popover", "template_curve_mapping")


@dataclass
class Button:
    """A button as the panel asked for it."""

    kind: str
    name: str
    """The operator, the property, or the menu."""
    data: Any = None
    """What a property belongs to."""
    more: str = ""
    """What tells it from buttons of the same name: the text, or the enumeration of its menu."""
    properties: dict = field(default_factory=dict)
    """What the panel sets of the operator."""
    row: str = ""
    """The list in whose row it is."""

    @property
    def key(self) -> tuple:
        """What is equal for the same button at another time."""
        fixed = tuple(sorted((name, str(value)) for name, value in self.properties.items() if name not in OF_THE_CHOSEN))
        return self.kind, self.name, self.more, fixed, self.row

    def __str__(self) -> str:
        words = [self.name.removeprefix("rototoon."), self.more, *(f"{k}={v}" for k, v in self.properties.items()), self.row]
        return " ".join(filter(None, words))


OF_THE_CHOSEN = {"character", "motion", "content", "page"}
"""Properties of operators that follow what the artist has chosen."""


@dataclass
class Notes:
    """What a panel drew last, and which of its buttons are greyed out."""

    buttons: list[Button] = field(default_factory=list)
    grey: range | frozenset[int] = frozenset()
    row: str = ""


HEADER, BODY = Notes(), Notes()


class Set:
    """The properties of an operator's button: passes on what the panel sets, and notes it."""

    def __init__(self, real, noted: dict):
        self.__dict__.update(real=real, noted=noted)

    def __setattr__(self, name, value):
        setattr(self.real, name, value)
        self.noted[name] = value


class Layout:
    """In the place of a `UILayout`: passes everything on."""

    def __init__(self, real, notes: Notes):
        self.__dict__.update(real=real, notes=notes)

    def __setattr__(self, name, value):
        setattr(self.real, name, value)

    def __getattr__(self, name):
        found = getattr(self.real, name)
        if name in PARTS:
            return lambda *words, **options: Layout(found(*words, **options), self.notes)
        if name in ITEMS:
            return lambda *words, **options: self._item(name, *words, **options)
        if name == "template_list":
            return lambda kind, *words, **options: self._list(kind, *words, **options)
        return found

    def _item(self, kind, *words, **options):
        notes = self.notes
        # Without a holder of its own a button can't be greyed out.
        holder = self.real.column(align=True) if self.real.use_property_split else self.real.row(align=True)
        holder.enabled = len(notes.buttons) not in notes.grey
        data, name = (words[0], words[1]) if isinstance(words[0], bpy.types.bpy_struct) else (None, words[0])
        more = options.get("text", "") if kind != "operator_menu_enum" else words[1]
        button = Button(kind, name, data, more, row=notes.row)
        notes.buttons.append(button)
        found = getattr(holder, kind)(*words, **options)
        return Set(found, button.properties) if kind in ("operator", "operator_menu_enum") else found

    def _list(self, kind, *words, **options):
        before, self.notes.row = self.notes.row, kind
        try:
            return self.real.template_list(kind, *words, **options)
        finally:
            self.notes.row = before


def _drawn(draw, notes: Notes):
    """A panel's method that draws through `Layout`."""

    def method(self, context):
        notes.buttons.clear()
        draw(SimpleNamespace(layout=Layout(self.layout, notes), page=self.page), context)

    return method


def _row(draw):
    """A list's method that draws a row through `Layout`. Blender counts the method's arguments."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index=0, flag=0):
        inside = Layout(layout, BODY) if isinstance(layout, bpy.types.UILayout) else layout
        draw(self, context, inside, data, item, icon, active_data, active_property, index, flag)

    return draw_item


def watch_lists() -> None:
    """Has the rows of lists drawn through `Layout` too."""
    for cls in bpy.types.UIList.__subclasses__():
        if cls.__module__.startswith(MODULE):
            cls.draw_item = _row(cls.draw_item)


def panels() -> list[type]:
    """The classes of the tab's panels, in the tab's order."""
    classes = importlib.import_module(f"{MODULE}.ui").CLASSES
    return [cls for cls in classes if getattr(cls, "bl_category", "") == TAB]


def title(cls) -> str:
    """The panel's name without Blender's prefix."""
    return cls.bl_idname.removeprefix("ROTOTOON_PT_")


_alone: list[type] = []


def only(every: list[type], wanted: type | None, noted: bool = False) -> None:
    """Leaves the panel `wanted` alone in the tab, open, or all panels in their order. With `noted`, its buttons are noted."""
    HEADER.buttons.clear()
    BODY.buttons.clear()
    while _alone:
        bpy.utils.unregister_class(_alone.pop())
    for cls in every:
        if getattr(bpy.types, cls.bl_idname, None) is not None:
            bpy.utils.unregister_class(cls)
    for cls in every:
        if wanted is None:
            bpy.utils.register_class(cls)
        elif cls is wanted:
            # Blender remembers by its name that a panel is closed.
            inside = {"bl_idname": f"{cls.bl_idname}_open", "bl_options": set()}
            if noted:
                inside |= {"draw": _drawn(cls.draw, BODY), "draw_header_preset": _drawn(cls.draw_header_preset, HEADER)}
            _alone.append(type(f"{cls.__name__}_open", (cls,), inside))
            bpy.utils.register_class(_alone[-1])


def shown():
    """Opens the sidebar at the tab, which exists only once the region has been drawn."""
    started = time.monotonic()
    while True:
        area, _, sidebar = view()
        # After a file was opened, Blender crashes here without a window in the context.
        with window.in_view():
            area.spaces.active.show_region_ui = True
        area.tag_redraw()
        yield 0.2
        tab = sidebar.active_panel_category
        if tab == TAB:
            return
        if tab not in ("", "UNSUPPORTED"):
            sidebar.active_panel_category = TAB
        if time.monotonic() - started > PATIENCE:
            raise RuntimeError(f"the sidebar shows the tab {tab!r} after {PATIENCE} s")


def places(notes: Notes) -> list[tuple[int, int, int, int] | None]:
    """Where each button is: left, right, bottom, top in the window. `None` for one that can't be seen, or is grey in any case."""
    count = len(notes.buttons)
    plain, grey = _pictured(notes, frozenset()), _pictured(notes, range(count))
    numbers, one = np.zeros(plain.shape[:2], int), (np.abs(plain - grey) > 2).any(2)
    for digit in range(max(count - 1, 0).bit_length()):
        ones = frozenset(k for k in range(count) if k >> digit & 1)
        greyed, other = ((_pictured(notes, chosen) == grey).all(2) for chosen in (ones, frozenset(range(count)) - ones))
        # The edge between two buttons is of both: it is grey only where both are.
        one &= greyed != other
        numbers += greyed.astype(int) << digit
    notes.grey = frozenset()
    window.redrawn()
    return [_box(one & (numbers == number)) for number in range(count)]


def _pictured(notes: Notes, grey) -> np.ndarray:
    """The sidebar with some buttons greyed out."""
    notes.grey = grey
    window.redrawn()
    return window.of_region(window.screen(), view()[2]).astype(np.int16)


def _box(where: np.ndarray) -> tuple[int, int, int, int] | None:
    """The rectangle around the true pixels of the sidebar's picture, in the window."""
    if not where.any():
        return None
    sidebar = view()[2]
    down, across = np.flatnonzero(where.any(1)), np.flatnonzero(where.any(0))
    top = sidebar.y + sidebar.height
    return sidebar.x + int(across[0]), sidebar.x + int(across[-1]) + 1, top - int(down[-1]) - 1, top - int(down[0])
