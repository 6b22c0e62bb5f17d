"""The documentation's page of operators, from what Blender knows of them.

`python tests/blender/operator_table.py`, in an environment with a `bpy` wheel, prints the page of the add-on's folder as it is.
The test beside it compares the page with the one in `docs/`.
"""

import bpy

HEAD = """<!-- Generated from the registered operators. Change those, run the tests, then `cargo xtask bless`. -->

# All operators

Each operator is `bpy.ops.rototoon.NAME`. [Background Blender](../scripts/blender.md) shows how to call them from a script.
"""
WINDOW = {"filter_folder", "rna_type", "filter_glob", "check_existing"}
"""Properties that only the file browser uses."""
BLENDERS_NAME = "Unique name used in the code and scripting"
"""Blender's own description of the name that it gives every group of settings. It says more in some versions."""
KINDS = {"COLLECTION": "list", "POINTER": "data-block"}
RANGE = 1e6
"""Limits beyond this are none: Blender's own are the largest numbers of the type."""


def page() -> str:
    """The page of all operators of the enabled add-on."""
    return HEAD + "".join(map(section, sorted(dir(bpy.ops.rototoon)))) + settings()


def settings() -> str:
    """The settings of an object: the properties of `object.rototoon`."""
    rna = bpy.types.Object.bl_rna.properties["rototoon"].fixed_type
    own = [prop for prop in rna.properties if is_own(prop)]
    text = "\n## Settings of an object\n\nThey are the properties of `object.rototoon`.\n" + table(own)
    for prop in own:
        if prop.type == "COLLECTION":
            items = [each for each in prop.fixed_type.properties if is_own(each)]
            text += f"\nAn item of `object.rototoon.{prop.identifier}` has these:\n" + table(items)
    return text


def is_own(prop) -> bool:
    """Whether a described property is not Blender's own."""
    return prop.identifier != "rna_type" and bool(prop.description) and not prop.description.startswith(BLENDERS_NAME)


def table(props) -> str:
    """Properties of data as a table."""
    return "\n| property | values | default | what it is |\n| --- | --- | --- | --- |\n" + "".join(map(row, props))


def section(name: str) -> str:
    """An operator: its label, what it does, and its properties."""
    rna = getattr(bpy.ops.rototoon, name).get_rna_type()
    text = f"\n## {name}\n\n**{rna.name}**: {sentence(rna.description)}\n"
    own = [prop for prop in rna.properties if prop.identifier not in WINDOW]
    if not own:
        return text + "\nIt has no properties.\n"
    text += "\n| property | values | default | what it does |\n| --- | --- | --- | --- |\n"
    return text + "".join(row(prop) for prop in own)


def row(prop) -> str:
    """A property as a row of the table."""
    values, default = described(prop)
    return f"| `{prop.identifier}` | {values} | {default} | {prop.name}. {sentence(prop.description)} |\n"


def described(prop) -> tuple[str, str]:
    """Which values a property takes, and its default."""
    if prop.type == "ENUM":
        items = [f"`{item.identifier}`{detail(item)}" for item in prop.enum_items]
        return "<br>".join(items), f"`{prop.default}`" if prop.default else ""
    if prop.type == "BOOLEAN":
        return "`True` or `False`", f"`{prop.default}`"
    if prop.type in {"INT", "FLOAT"}:
        whole = prop.type == "INT"
        low, high = (value if abs(value) < RANGE else None for value in (prop.hard_min, prop.hard_max))
        kind = "whole number" if whole else "number"
        if prop.is_array:
            defaults = ", ".join(f"{value:.6g}" for value in prop.default_array)
            limits = f", {low:.6g} to {high:.6g}" if low is not None and high is not None else ""
            return f"{prop.array_length} {kind}s{limits}", f"`({defaults})`"
        if low is not None and high is not None:
            kind += f", {low:.6g} to {high:.6g}"
        elif low is not None:
            kind += f" from {low:.6g}"
        return kind, f"`{prop.default:.6g}`"
    if prop.type in KINDS:
        return KINDS[prop.type], ""
    return {"FILE_PATH": "file", "DIR_PATH": "folder"}.get(prop.subtype, "text"), f'`"{prop.default}"`'


def detail(item) -> str:
    """What an item of a list is called and means."""
    text = ": ".join(part for part in (item.name, item.description) if part)
    return f" ({escaped(text)})" if text else ""


def sentence(text: str) -> str:
    """With a full stop, fit for a table."""
    text = escaped(" ".join(text.split()))
    return text if not text or text.endswith(".") else f"{text}."


def escaped(text: str) -> str:
    """Without what Markdown would read as its own."""
    return text.replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*")


if __name__ == "__main__":
    import conftest

    conftest.install()
    print(page(), end="")
