"""Names of parts in the list: each part has its own."""

import bpy
import shots


def test_a_name_that_another_part_has_gets_a_number(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    first, second = ob.rototoon.parts[0], ob.rototoon.parts[1]
    first.name = "foot"
    second.name = "foot"
    assert (first.name, second.name) == ("foot", "foot.001")
    second.name = "foot.001"
    assert second.name == "foot.001", "a part may have its own name again"
    second.name = "  "
    assert second.name == "Part", "a part without a name could not be told from others"
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    assert [part.name for part in ob.rototoon.parts] == ["foot", "Part"]
