"""Ids and mattes of each part as OpenEXR, read by OpenImageIO, which shares no code with the writer.

What the Cryptomatte specification says is written down here once more, from the specification: the hash of a name, the key of the
metadata, and how the matte of a name is summed from the ranks.
"""

import json
import os
import struct
import subprocess
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from conftest import program

WIDTH, HEIGHT = 64, 48
RULES = {"hash": "MurmurHash3_32", "conversion": "uint32_to_float32"}
# The nearest parts of the sample whose sums are compared. Each costs a run of the program.
PREFIXES = (1, 3, 6)


def rotated(value: int, bits: int) -> int:
    return (value << bits | value >> 32 - bits) & 0xFFFFFFFF


def murmur(text: str) -> int:
    """MurmurHash3_x86_32 with seed 0."""
    data = text.encode("utf-8")
    whole = len(data) // 4 * 4
    value = 0

    def mixed(block: int) -> int:
        return rotated(block * 0xCC9E2D51 & 0xFFFFFFFF, 15) * 0x1B873593 & 0xFFFFFFFF

    for (block,) in struct.iter_unpack("<I", data[:whole]):
        value = (rotated(value ^ mixed(block), 13) * 5 + 0xE6546B64) & 0xFFFFFFFF
    value ^= mixed(int.from_bytes(data[whole:], "little")) ^ len(data)
    for shift, factor in ((16, 0x85EBCA6B), (13, 0xC2B2AE35)):
        value = (value ^ value >> shift) * factor & 0xFFFFFFFF
    return value ^ value >> 16


def exponent(value: int) -> int:
    return value >> 23 & 255


def identity(name: str) -> int:
    """The id of a name: the bits of a float that is neither denormal, infinite, nor no number."""
    value = murmur(name)
    return value ^ 1 << 23 if exponent(value) in (0, 255) else value


def special_names() -> list[str]:
    """A name whose hash has an exponent of zeros, and one whose hash has an exponent of ones."""
    return [next(name for name in map("part {}".format, range(100_000)) if exponent(murmur(name)) == e) for e in (0, 255)]


def square(left: float, top: float, size: float) -> list[list[float]]:
    return [[left, top], [left + size, top], [left + size, top + size], [left, top + size]]


def made() -> dict:
    """Parts over each other with borders within pixels: odd names, parts of one depth, a line, and a name with a full stop."""
    names = ['near "arm"', "Größe 🦊", "arm.L", "rgba", *special_names()]
    parts = [
        {"name": name, "closed": True, "depth": depth, "keys": {"0": square(4.3 + 6.1 * k, 5.7 + 3.3 * k, 17.45)}}
        for k, (name, depth) in enumerate(zip(names, [2, 5, 2, 0, 1, 3]))
    ]
    # Five parts share a pixel.
    parts += [{"name": f"slice {k}", "closed": True, "depth": 9, "keys": {"0": square(50 + k / 5, 40, 0.2)}} for k in range(5)]
    parts.append({"name": "line", "closed": False, "depth": 7, "keys": {"0": [[0, 0], [30, 30], [60, 0]]}})
    footage = {"pattern": "f_%d.png", "first": 0, "last": 0, "fps": 24, "width": WIDTH, "height": HEIGHT}
    return {"rototoon": 1, "footage": footage, "parts": parts}


def sample() -> dict:
    """The sample cartoon: sixteen parts, keyed on its first frame."""
    folder = os.environ.get("ROTOTOON_SAMPLE")
    if not folder:
        pytest.skip("no sample: ROTOTOON_SAMPLE is not set")
    return json.loads((Path(folder) / "sample/project.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module", params=[made, sample])
def scene(request, tmp_path_factory) -> tuple[dict, Path]:
    """A document, and a folder in which it is `a.json`."""
    document = request.param()
    folder = tmp_path_factory.mktemp("ids")
    (folder / "a.json").write_text(json.dumps(document), encoding="utf-8")
    return document, folder


@pytest.fixture(scope="module")
def ids(scene):
    """The file of ids, as OpenImageIO reads it."""
    return read(render(scene, "ids", "--what", "ids"))[0]


def closed(document: dict) -> list[str]:
    """The names of the closed parts, the nearest first."""
    numbered = [(part["depth"], k, part["name"]) for k, part in enumerate(document["parts"]) if part["closed"]]
    return [name for _, _, name in sorted(numbered, reverse=True)]


def render(scene, name: str, *words: str) -> Path:
    _, folder = scene
    command = [program(), "render", folder / "a.json", "-o", folder / f"{name}_%d.exr", "--frames", "0-0", *words]
    subprocess.run(command, check=True, timeout=120, capture_output=True)
    return folder / f"{name}_0.exr"


def read(path: Path) -> list[tuple[oiio.ImageSpec, dict[str, np.ndarray]]]:
    """Each part of a file: what it says of itself, and its channels as 32-bit floats."""
    file = oiio.ImageInput.open(str(path))
    assert file, oiio.geterror()
    found = []
    while file.seek_subimage(len(found), 0):
        spec = file.spec()
        pixels = file.read_image(len(found), 0, 0, spec.nchannels, "float")
        assert pixels is not None and pixels.dtype == np.float32, file.geterror()
        found.append((spec, {name: pixels[:, :, k] for k, name in enumerate(spec.channelnames)}))
    file.close()
    return found


def metadata(spec: oiio.ImageSpec) -> tuple[str, dict[str, str]]:
    """The key of the Cryptomatte in a file that has one, and its fields."""
    fields = {}
    for attribute in spec.extra_attribs:
        if attribute.name.startswith("cryptomatte/"):
            _, key, field = attribute.name.split("/")
            fields.setdefault(key, {})[field] = attribute.value
    ((key, found),) = fields.items()
    return key, found


def ranks(ids) -> list[tuple[np.ndarray, np.ndarray]]:
    """Ids, as bits, and coverage of each rank."""
    _, channels = ids
    layers = [name[:-2] for name in channels if name.startswith("CryptoObject") and name.endswith(".R")]
    assert sorted(layers) == [f"CryptoObject{k:02}" for k in range(len(layers))]
    pairs = [(f"{layer}.{a}", f"{layer}.{b}") for layer in sorted(layers) for a, b in ("RG", "BA")]
    return [(np.ascontiguousarray(channels[a]).view(np.uint32), channels[b]) for a, b in pairs]


def keyed(ids, name: str) -> np.ndarray:
    """The matte of a name: its coverage in all ranks."""
    return sum(np.where(bits == identity(name), coverage, 0) for bits, coverage in ranks(ids))


def test_the_hash_is_the_published_one():
    assert [murmur(text) for text in ("", "hello", "hello, world")] == [0, 0x248BFA47, 0x149BBB7F]
    assert murmur("The quick brown fox jumps over the lazy dog") == 0x2E4FF723


def test_the_metadata_names_the_rules_and_all_closed_parts(scene, ids):
    spec, _ = ids
    key, fields = metadata(spec)
    assert key == f"{murmur('CryptoObject'):08x}"[:7]
    manifest = json.loads(fields.pop("manifest"))
    assert fields == {"name": "CryptoObject", **RULES}
    assert manifest == {name: f"{identity(name):08x}" for name in closed(scene[0])}


def test_ids_and_coverage_are_whole_floats(ids):
    spec, channels = ids
    formats = spec.channelformats or [spec.format] * spec.nchannels
    assert {str(kind) for kind in formats} == {"float"}
    assert {"R", "G", "B", "A"} < set(channels) and len(channels) % 4 == 0


def test_ranks_fall_and_have_known_ids_or_nothing(scene, ids):
    known = np.array([0, *map(identity, closed(scene[0]))], np.uint32)
    found = ranks(ids)
    assert len(found) >= 6
    before = np.ones_like(found[0][1])
    for bits, coverage in found:
        assert np.isin(bits, known).all()
        assert ((bits == 0) == (coverage == 0)).all()
        assert (coverage <= before).all()
        before = coverage
    shared = sum(coverage > 0 for _, coverage in found)
    assert shared.max() >= 3, "no pixel has three parts, so ranks are not tried"


def test_coverage_of_the_nearest_parts_sums_to_their_matte(scene, ids):
    names = closed(scene[0])
    for count in sorted({*PREFIXES, len(names)}):
        chosen = [word for name in names[:count] for word in ("--parts", name)]
        _, channels = read(render(scene, "union", "--what", "matte", *chosen))[0]
        found = sum(keyed(ids, name) for name in names[:count])
        np.testing.assert_allclose(found, channels["A"], rtol=0, atol=2e-5)
    assert np.count_nonzero((0.05 < found) & (found < 0.95)) > 100, "no soft border is compared"


def test_the_sum_of_all_ids_is_the_alpha_of_the_picture(ids):
    total = sum(coverage for _, coverage in ranks(ids))
    np.testing.assert_allclose(total, ids[1]["A"], rtol=0, atol=1e-5)


def test_each_part_alone_has_the_coverage_of_its_own_matte(scene, ids):
    document, _ = scene
    own = [part["name"] for part in document["parts"] if part["closed"]]
    files = read(render(scene, "parts", "--what", "matte", "--multipart", "on"))
    # A full stop would begin the name of a channel; the whole matte gives way to a part of its name.
    wanted = ["rgba 2" if "rgba" in own else "rgba", *(name.replace(".", "_") for name in own)]
    assert [spec["oiio:subimagename"] for spec, _ in files] == wanted
    mattes = {name: channels["A"] for name, (_, channels) in zip(own, files[1:])}
    for name in own[:: len(own) // 3]:
        alone = read(render(scene, "alone", "--what", "ids", "--parts", name))[0]
        assert json.loads(metadata(alone[0])[1]["manifest"]) == {name: f"{identity(name):08x}"}
        np.testing.assert_allclose(keyed(alone, name), mattes[name], rtol=0, atol=1e-5)
    for name in own:
        # Nearer parts hide some of it, and it shows nowhere else.
        assert (keyed(ids, name) <= mattes[name] + 1e-5).all()
