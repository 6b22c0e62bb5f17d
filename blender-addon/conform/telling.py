"""What the artist is told. All frames are scene frames."""

from __future__ import annotations

import bpy
from rototoon import Conformed

from ..blender import footage, stage
from ..common.wording import are, listed
from . import layers
from .plan import Plan
from .times import Times


def of_footage(found: Conformed, times: Times) -> str:
    """Where the old picture lies in the new one, and what the frames show."""
    x, y = found.shift
    place = f"the old picture is scaled by {found.scale:.6g} and moved by {x:.2f}, {y:.2f} px"
    if (found.scale, x, y) == (1.0, 0.0, 0.0):
        place = "the pictures lie on each other"
    every = len(found.same) + len(found.redrawn) + len(found.new)
    shown = f"{len(found.same)} of {every} frames show a drawing of the old footage"
    lists = [("drawn again", sorted(times.redrawn)), ("new", times.new), ("gone", times.gone)]
    return "; ".join([place, shown, *(f"{what}: {listed(frames)}" for what, frames in lists if frames)])


def warnings(plan: Plan, times: Times) -> list[str]:
    """What did not simply go with its picture."""
    found = []
    for layer in plan.layers:
        again = {new: _what(plan, layer.name, drawing.frame) for drawing in layer.drawings if drawing.artists and not drawing.blank for new in drawing.targets}
        found += [f"{what} on {new}: the drawing was drawn again, look whether it still fits" for new, what in sorted(again.items()) if new in times.redrawn]
    found += [
        f'part "{part}": the picture of its key on {frame} is gone, and the contour tracked on {by} is its key now' for part, frame, by in plan.replaced
    ]
    for layer in plan.layers:
        aside = [drawing for drawing in layer.drawings if drawing.aside is not None]
        found += [
            f'{_what(plan, layer.name, drawing.frame)} on {drawing.frame}: left over, kept on {drawing.aside} of the hidden layer "{layers.left_over(layer.name)}"'
            for drawing in sorted(aside, key=lambda each: each.frame)
        ]
        if layer.again:
            found.append(f'layer "{layer.name}": what was generated is left out on {listed(layer.again)}, since the drawing was drawn again')
        if layer.broken:
            spans = " and ".join(f"{first} to {last}" for first, last in sorted(layer.broken))
            found.append(f'layer "{layer.name}": the in-betweens from {spans} of the old footage are left out, since a key is gone')
    return found


def _what(plan: Plan, layer: str, frame: int) -> str:
    parts = plan.parts.get((layer, frame))
    if not parts:
        return f'layer "{layer}": the drawing'
    names = ", ".join(f'"{part}"' for part in parts)
    return f"part {names}: the key" if len(parts) == 1 else f"parts {names}: the keys"


def of_surroundings(ob, times: Times, moved: bool, still: bool) -> list[str]:
    """What stays as it is although drawings have moved. To be called before the object gets its footage."""
    found, own = [], [f'"{layer.name}"' for layer in layers.others(ob)]
    if own and (times.moves or moved):
        word = "layer" if len(own) == 1 else "layers"
        found.append(f"the {word} {', '.join(own)} {are(own)} yours alone and left as before, though the drawings beside {'it' if len(own) == 1 else 'them'} have moved")
    if not still and times.moves:
        found.append("what is animated keeps its frames")
    pattern = footage.absolute(ob, ob.rototoon.pattern)
    same = [other.name for other in bpy.context.scene.objects if other != ob and other.rototoon.pattern and footage.absolute(other, other.rototoon.pattern) == pattern]
    if same:
        names = ", ".join(f'"{name}"' for name in sorted(same))
        found.append(f"{names} {'has' if len(same) == 1 else 'have'} the old footage still: conform {'it' if len(same) == 1 else 'them'} too")
    return found


def of_scene(shot: stage.Shot) -> str:
    """That the scene does not show all of the footage; empty if it does."""
    scene, last = bpy.context.scene, shot.frame_of_first + shot.last - shot.first
    if scene.frame_start <= shot.frame_of_first and last <= scene.frame_end:
        return ""
    return f"the footage is on frames {shot.frame_of_first} to {last}, and the scene shows {scene.frame_start} to {scene.frame_end}"


