"""Changes of look that an artist makes on a drawing, by name."""

import json

import bpy
import numpy as np


def _put(name, value):
    def change(addon, handle):
        gp = addon("blender.grease_pencil")
        starts = gp.offsets(handle)
        _, domain = gp.TYPES[name]
        values = gp.value(handle, name, int(starts[-1]) if domain == "POINT" else len(starts) - 1)
        values[-1] = value(values[-1]) if callable(value) else value
        gp.put(handle, name, values)

    return change


def _own(domain):
    def change(addon, handle):
        attribute = handle.attributes.new(f"mine_{domain.lower()}", "FLOAT", domain)
        values = np.zeros(len(attribute.data), np.float32)
        values[-1] = 0.5
        attribute.data.foreach_set("value", values)

    return change


def _curve(addon, handle):
    handle.set_types(type="NURBS", indices=[0])


CHANGES = {
    "radius": _put("radius", 0.1),
    "opacity": _put("opacity", 0.25),
    "vertex colour": _put("vertex_color", (0.2, 0.4, 0.6, 1.0)),
    "material": _put("material_index", lambda used: 0 if used else 1),
    "cyclic": _put("cyclic", lambda closed: not closed),
    "softness": _put("softness", 0.5),
    "fill colour": _put("fill_color", (0.2, 0.4, 0.6, 1.0)),
    "fill": _put("fill_id", 7),
    "hidden line": _put("hide_stroke", True),
    "start cap": _put("start_cap", 1),
    "own attribute of a stroke": _own("CURVE"),
    "own attribute of a point": _own("POINT"),
    "curve type": _curve,
}
"""Each changes the look of the last stroke or point (the first stroke's, for the curve type) of a drawing with two materials or more."""
if bpy.app.version < (5, 1, 0):
    # Fills are materials' there.
    del CHANGES["fill"], CHANGES["hidden line"]


def second_material(ob):
    """Gives an object one more material."""
    material = bpy.data.materials.new("Second")
    bpy.data.materials.create_gpencil_data(material)
    ob.data.materials.append(material)


def without_marks(addon, ob):
    """Makes an object's drawings those of a version that had no marks."""
    gp = addon("blender.grease_pencil")
    for layer in ob.data.layers:
        for handle, _ in gp.drawings(layer).values():
            if gp.has(handle, gp.MARK):
                handle.attributes.remove(handle.attributes[gp.MARK])
    for name in ("rototoon_tween", "rototoon_lines"):
        if name in ob.data:
            kept = json.loads(ob.data[name])
            for layer in kept.values():
                layer.pop("marked", None)
                for span in layer.get("spans", {}).values():
                    span.pop("marked", None)
            ob.data[name] = json.dumps(kept)
    if "rototoon_slots" in ob.data:
        del ob.data["rototoon_slots"]
