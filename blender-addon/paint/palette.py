"""The palette of a document: colours of paint with names, also those that nothing is painted with yet.

Each is a material of the object. The object keeps which materials they are, so a colour goes out under the name that its material has now, also when
its slot was removed. A material that was removed from the file is no colour any more.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..blender import fill_materials, materials


def take(ob, looks: Mapping[str, Sequence[float]]) -> None:
    """Gives an object the colours of a document's palette: names and looks, sRGB. The colours that it has stay."""
    known = {own.material for own in ob.rototoon.palette}
    for name, colour in looks.items():
        place = fill_materials.named(ob, name, np.asarray(colour, np.float64))
        material = materials.of(ob)[place]
        if material not in known:
            known.add(material)
            ob.rototoon.palette.add().material = material


def fields(ob) -> dict[str, list[float]]:
    """The colours in the form of a document."""
    colours = [own.material for own in ob.rototoon.palette if fill_materials.is_colour(own.material)]
    return {material.name: fill_materials.look(material).clip(0, 1).round(6).tolist() for material in colours}
