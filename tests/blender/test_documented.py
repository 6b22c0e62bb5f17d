"""The documentation's page of operators is what Blender knows of them."""

import os

import bpy
import operator_table
from conftest import ROOT

KEPT = ROOT / "docs/src/generated/operators.md"


def test_the_page_of_operators_is_current():
    page = operator_table.page()
    written = ROOT / os.environ.get("CARGO_TARGET_DIR", "target") / "golden/operators.md"
    written.parent.mkdir(parents=True, exist_ok=True)
    written.write_text(page, encoding="utf-8")
    kept = KEPT.read_text(encoding="utf-8") if KEPT.exists() else ""
    assert page == kept, f"{KEPT} is stale: look at {written}; `cargo xtask bless` accepts it"


def test_every_property_has_a_row():
    sections = dict(part.partition("\n")[::2] for part in operator_table.page().split("\n## ")[1:])
    for name in dir(bpy.ops.rototoon):
        for prop in getattr(bpy.ops.rototoon, name).get_rna_type().properties:
            listed = f"| `{prop.identifier}` |" in sections[name]
            assert listed == (prop.identifier not in operator_table.WINDOW), f"{name}.{prop.identifier}"


def test_every_operator_says_what_it_does():
    for section in operator_table.page().split("\n## ")[1:]:
        name, _, rest = section.partition("\n")
        if name == "Settings of an object":
            continue
        assert not rest.strip().splitlines()[0].endswith("**: "), f"{name} has no description"
