"""The documentation's page of operators is what Blender knows of them."""

import os
from pathlib import Path

import operator_table
from conftest import MODULE, ROOT

KEPT = ROOT / "docs/src/generated/operators.md"


def test_the_page_of_operators_is_current():
    page = operator_table.page(MODULE)
    written = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "golden/operators.md"
    written = ROOT / written
    written.parent.mkdir(parents=True, exist_ok=True)
    written.write_text(page, encoding="utf-8")
    kept = KEPT.read_text(encoding="utf-8") if KEPT.exists() else ""
    assert page == kept, f"{KEPT} is stale: look at {written}; `cargo xtask bless` accepts it"


def test_every_operator_says_what_it_does():
    page = operator_table.page(MODULE)
    for section in page.split("\n## ")[1:]:
        name, _, rest = section.partition("\n")
        assert "**. " not in rest and ".** \n" not in rest, f"{name} has no description"
