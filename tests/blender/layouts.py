"""A layout that draws nothing but notes what it is asked for, and fails where Blender would complain."""

from types import SimpleNamespace

import bpy

ICONS = set(bpy.types.UILayout.bl_rna.functions["prop"].parameters["icon"].enum_items.keys())


class Layout:
    """In the place of `UILayout`. All parts of a layout write into one list of (what, details)."""

    def __init__(self, said=None):
        object.__setattr__(self, "said", [] if said is None else said)

    def __setattr__(self, name, value):
        assert name in bpy.types.UILayout.bl_rna.properties, name
        object.__setattr__(self, name, value)

    def _part(self, **options):
        return Layout(self.said)

    row = column = box = split = grid_flow = column_flow = menu_pie = _part

    def separator(self, **options):
        pass

    def menu(self, name, **options):
        assert hasattr(bpy.types, name), name
        self.said.append(("menu", name))

    def label(self, text="", icon="NONE", icon_value=0):
        assert icon in ICONS, icon
        self.said.append(("label", text))

    def prop(self, data, name, icon="NONE", **options):
        assert name in data.bl_rna.properties, (data, name)
        assert icon in ICONS, icon
        self.said.append(("prop", name))

    def prop_search(self, data, name, source, choices, **options):
        assert name in data.bl_rna.properties and choices in source.bl_rna.properties, (name, choices)
        self.said.append(("prop", name))

    def operator(self, idname, icon="NONE", **options):
        assert icon in ICONS, icon
        module, name = idname.split(".")
        known = getattr(getattr(bpy.ops, module), name).get_rna_type().properties
        made = self._settings(idname, known)
        if options.get("text"):
            vars(made)["shown"] = options["text"]
        return made

    def operator_menu_enum(self, idname, name, **options):
        known = getattr(bpy.ops.rototoon, idname.split(".")[1]).get_rna_type().properties
        assert name in known
        return self._settings(idname, known)

    def _settings(self, idname, known):
        class Settings(SimpleNamespace):
            def __setattr__(inner, name, value):
                assert name in known, (idname, name)
                super().__setattr__(name, value)

        made = Settings()
        self.said.append(("operator", idname, made))
        return made

    def template_list(self, kind, _id, data, name, active_data, active_name, **options):
        assert hasattr(bpy.types, kind), kind
        assert name in data.bl_rna.properties and active_name in active_data.bl_rna.properties
        self.said.append(("list", kind))
        row = getattr(bpy.types, kind)
        for item in getattr(data, name):
            row.draw_item(None, bpy.context, self, data, item, 0, active_data, active_name)

    def template_curve_mapping(self, data, name, **options):
        assert name in data.bl_rna.properties
        self.said.append(("curve", name))

    def template_icon(self, icon_value, scale=1.0):
        self.said.append(("icon", scale))


def draw(panel):
    """What a panel draws now."""
    assert panel.poll(bpy.context) if hasattr(panel, "poll") else True
    layout = Layout()
    panel.draw(SimpleNamespace(layout=layout), bpy.context)
    return layout.said


def labels(said):
    """Texts that were drawn."""
    return [entry[1] for entry in said if entry[0] == "label"]
