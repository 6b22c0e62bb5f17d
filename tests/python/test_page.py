"""The samples of the page on Python: those that need no files run as they are printed, and each one imports what it uses."""

import ast
import builtins
import re

import pytest
from conftest import ROOT

PAGE = ROOT / "docs/src/scripts/python.md"
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.S)
GIVEN = {"document", "drawing"}
"""Names that the page describes in words."""


@pytest.mark.parametrize("block", [block for block in BLOCKS if "shot/" not in block and "clips" not in block])
def test_samples_without_files_run(block):
    exec(compile(block, str(PAGE), "exec"), {})  # noqa: S102 - what the page prints is what is tested


@pytest.mark.parametrize("block", BLOCKS)
def test_each_sample_has_all_of_its_names(block):
    names = [node for node in ast.walk(ast.parse(block)) if isinstance(node, ast.Name)]
    known = {node.id for node in names if isinstance(node.ctx, ast.Store)} | set(dir(builtins))
    for node in ast.walk(ast.parse(block)):
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            known |= {(each.asname or each.name).split(".")[0] for each in node.names}
    assert {node.id for node in names} <= known | GIVEN
