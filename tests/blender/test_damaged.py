"""Properties that a person typed wrongly, or that a script or another program damaged: a message or nothing, but no Python error."""

import pytest
import studio
from test_guard import file, opened, prepared, run, said  # noqa: F401 - fixtures of the studio

NAMES = ("track", "snap", "hidden_lines", "choose_body", "make_part", "hide_part", "weakest_frame", "export_document", "depth_mark")
PATTERNS = {
    "//frames/shot_001.png": "expected a name with %d or %04d for the number",
    "//frames/shot_%d%d.png": "expected a name with %d or %04d for the number",
    "/no/100% done/shot_%03d.png": "/no/100% done: a folder with % in its name cannot be used",
    "": "Choose the footage first",
}


def texts(ob, text):
    ob.rototoon.extra = text
    for part in ob.rototoon.parts:
        part.extra = part.ends = text


@pytest.mark.parametrize("pattern", PATTERNS)
def test_footage_that_was_typed(addon, opened, file, said, pattern):  # noqa: F811
    for name in NAMES:
        ob = studio.open_file(file["path"])
        prepared(addon, ob, name)
        ob.rototoon.pattern = pattern
        told = run(addon, name, file, said)
        assert "Traceback" not in told, f"{name}: {told}"
        if name in ("track", "snap", "export_document"):
            assert PATTERNS[pattern] in told


@pytest.mark.parametrize("text", ['{"a', "[1]", "7", '{"absent": [[1], ["x", 2]], "footage": 3}', '[["x", "lost"], [3]]'])
def test_texts_that_cannot_be_read(addon, opened, file, said, text):  # noqa: F811
    for name in NAMES:
        ob = studio.open_file(file["path"])
        prepared(addon, ob, name)
        texts(ob, text)
        told = run(addon, name, file, said)
        assert "Error" not in told, f"{name}: {told}"


def test_a_layer_has_a_name(addon, opened):  # noqa: F811
    for name in ("contours_layer", "snapped_layer"):
        setattr(opened.rototoon, name, "Bob")
        setattr(opened.rototoon, name, " ")
    assert (opened.rototoon.contours_layer, opened.rototoon.snapped_layer) == ("Contours", "Snapped")
