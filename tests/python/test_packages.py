"""The packages of the add-on: which may import which, no cycles, and one package for Blender's Grease Pencil API.

Each package says in the docstring of its `__init__.py` what it may import. These tests read the source and start nothing of it.
"""

import ast
import re
import sys
from functools import cache
from pathlib import Path

import pytest
from conftest import ADDON

PACKAGES = sorted(path.parent.name for path in ADDON.glob("*/__init__.py"))
GREASE_PENCIL = {
    "add_strokes", "attributes", "curve_offsets", "frame_number", "grease_pencil", "grease_pencils", "grease_pencils_v3",
    "keyframe_type", "layer_groups", "matrix_parent_inverse", "parent_bone", "parent_group", "remove_strokes",
    "reorder_strokes", "resize_strokes", "set_types", "tag_positions_changed", "use_lights",
}  # fmt: skip
"""Names of Blender's Grease Pencil API that mean nothing else in the add-on."""
CHAINS = {("data", "layers"), ("frames", "new"), ("frames", "copy"), ("frames", "move"), ("frames", "remove")}
"""Names that belong to the API where one follows the other."""


@cache
def modules() -> dict[str, Path]:
    """Every module of the add-on by its dotted name; "" is the add-on itself."""
    found = {}
    for path in sorted(ADDON.rglob("*.py")):
        parts = path.relative_to(ADDON).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


@cache
def tree(name: str) -> ast.Module:
    """The syntax tree of a module."""
    return ast.parse(modules()[name].read_text(encoding="utf-8"))


@cache
def imports(name: str) -> set[str]:
    """The add-on's modules that a module imports, in functions too."""
    package = name if modules()[name].name == "__init__.py" else name.rpartition(".")[0]
    found = set()
    for node in ast.walk(tree(name)):
        if not isinstance(node, ast.ImportFrom):
            continue
        # The package `rototoon` is imported by its own name.
        own = not node.level and (node.module or "").split(".")[0] == "rototoon"
        if node.level or own:
            base = package.split(".")[: len(package.split(".")) - node.level + 1] if package and not own else []
            source = ".".join([*base, *([node.module] if node.module else [])])
            for alias in node.names:
                inner = f"{source}.{alias.name}".lstrip(".")
                found.add(inner if inner in modules() else source)
    return found


def package(name: str) -> str:
    """The package of a module; "" for the files beside the packages."""
    first = name.split(".")[0]
    return first if first in PACKAGES else ""


def allowed(name: str) -> set[str]:
    """The packages that a package may import, as its docstring says."""
    said = ast.get_docstring(tree(name)) or ""
    found = re.search(r"May import: ([^\n]*)", said)
    assert found, f'{name}/__init__.py: expected a docstring with a line "May import: …"'
    return set(PACKAGES) if found[1] == "every package." else set(re.findall(r"`(\w+)`", found[1]))


def test_all_files_lie_in_rooms():
    assert PACKAGES == ["blender", "bones", "capture", "common", "conform", "exchange", "farm", "lines", "paint", "rototoon", "sample", "scripting", "strokes", "style", "tween", "ui"]
    assert [name for name in modules() if not package(name)] == ["", "build", "handlers", "properties"]


@pytest.mark.parametrize("name", PACKAGES)
def test_packages_import_what_they_may(name):
    may = allowed(name) | {name}
    assert may <= set(PACKAGES)
    for module in (each for each in modules() if package(each) == name):
        for other in imports(module):
            assert package(other) in may, f"{module} imports {other}; {name} may import {sorted(may)}"


def cycles(arrows: dict[str, set[str]]) -> list[list[str]]:
    """The cycles of a graph, each once for the place where it was entered."""
    found, done = [], set()

    def visit(name: str, way: list[str]) -> None:
        if name in way:
            found.append([*way[way.index(name) :], name])
        elif name not in done:
            for other in sorted(arrows.get(name, ())):
                visit(other, [*way, name])
            done.add(name)

    for name in sorted(arrows):
        visit(name, [])
    return found


def test_rings_are_found():
    assert cycles({"a": {"b"}, "b": {"c"}, "c": {"a"}}) == [["a", "b", "c", "a"]]
    assert cycles({"a": {"b", "c"}, "b": {"c"}}) == []


def test_no_import_ring_among_modules():
    assert cycles({name: imports(name) for name in modules()}) == []


def test_no_ring_among_rooms():
    assert cycles({name: allowed(name) - {name} for name in PACKAGES}) == []


def test_the_package_needs_nothing_but_python():
    for name in modules():
        if package(name) != "rototoon":
            continue
        for node in ast.walk(tree(name)):
            if isinstance(node, ast.Import):
                outside = {alias.name.split(".")[0] for alias in node.names}
            else:
                outside = {node.module.split(".")[0]} if isinstance(node, ast.ImportFrom) and not node.level else set()
            assert outside <= sys.stdlib_module_names, f"{name} imports {outside}"


def grease_pencil_uses(source: ast.Module, ours: set[str]) -> list[str]:
    """What a syntax tree uses of the API; functions of the modules called `ours` do not count."""
    found = []
    for node in ast.walk(source):
        if not isinstance(node, ast.Attribute) or (isinstance(node.value, ast.Name) and node.value.id in ours):
            continue
        before = node.value.attr if isinstance(node.value, ast.Attribute) else ""
        if node.attr in GREASE_PENCIL or (before, node.attr) in CHAINS:
            found.append(f"{node.lineno}: {ast.unparse(node)}")
    return found


def test_uses_of_the_grease_pencil_api_are_found():
    source = ast.parse("ob.data.layers['a'].frames.new(1)\ngp.remove_strokes(d, [0])\nd.remove_strokes(indices=[0])")
    found = ["1: ob.data.layers", "1: ob.data.layers['a'].frames.new", "3: d.remove_strokes"]
    assert sorted(grease_pencil_uses(source, {"gp"})) == found


def test_only_the_room_blender_knows_the_grease_pencil_api():
    for name in modules():
        if package(name) == "blender":
            continue
        aliases = (alias for node in ast.walk(tree(name)) if isinstance(node, ast.ImportFrom) for alias in node.names)
        ours = {alias.asname or alias.name for alias in aliases}
        assert grease_pencil_uses(tree(name), ours) == [], name


def test_the_package_without_blender_is_imported_by_its_own_name():
    # It is installed from a wheel, and is no folder of the installed extension.
    wrong = []
    for name in modules():
        for node in ast.walk(tree(name)):
            if isinstance(node, ast.ImportFrom) and node.level and package(name) != "rototoon":
                names = [node.module] if node.module else [alias.name for alias in node.names]
                wrong += [f"{name}: line {node.lineno}" for found in names if found.split(".")[0] == "rototoon"]
    assert not wrong


def test_the_rules_of_the_extensions_platform_are_kept():
    # No network, no other programs, no code from texts, no search path of one's own: all of that is asked about in a review.
    modules_refused = {"ftplib", "http", "imaplib", "pip", "requests", "smtplib", "socket", "ssl", "subprocess", "urllib", "xmlrpc"}
    names_refused = {"__import__", "compile", "eval", "exec"}
    # It reads another file's shots in a Blender of its own.
    allowed = {("farm.files", "subprocess")}
    wrong = []
    for name in modules():
        for node in ast.walk(tree(name)):
            found = set()
            if isinstance(node, ast.Import):
                found = {alias.name.split(".")[0] for alias in node.names} & modules_refused
            elif isinstance(node, ast.ImportFrom) and not node.level:
                found = {(node.module or "").split(".")[0]} & modules_refused
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                found = {node.func.id} & names_refused
            elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "sys":
                found = {node.attr} & {"path", "meta_path"}
            wrong += [f"{name}: line {node.lineno}: {word}" for word in found if (name, word) not in allowed]
    assert not wrong


def test_the_manifest_keeps_the_rules_of_the_extensions_platform():
    import tomllib

    manifest = tomllib.loads((ADDON / "blender_manifest.toml").read_text(encoding="utf-8"))
    assert len(manifest["tagline"]) <= 64 and manifest["tagline"][-1] not in ".,;:!?"
    assert manifest["license"] == ["SPDX:GPL-3.0-or-later"] and (ADDON / "LICENSE").is_file()
    assert set(manifest["permissions"]) == {"files"}
    assert all(len(reason) <= 64 and reason[-1] not in ".,;:!?" for reason in manifest["permissions"].values())
    assert "wheels" not in manifest, "they are entered when the zip is packed"
