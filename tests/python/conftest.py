"""The Python package without Blender, the built library, and a tiny cartoon."""

import os
import struct
import sys
import zlib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ADDON = ROOT / "blender-addon"
PACKAGE = ADDON / "rototoon"
WIDTH, HEIGHT, LAST = 80, 60, 12


def _find_library() -> None:
    if os.environ.get("ROTOTOON_LIBRARY"):
        return
    built = [ROOT / "target" / profile / "librototoon_capi.so" for profile in ("release", "debug")]
    built = [path for path in built if path.is_file()]
    if not built:
        pytest.exit("no native library: run `cargo build --release -p rototoon-capi`, or set ROTOTOON_LIBRARY", 2)
    # The newer one, so that a library of last week does not shadow today's.
    os.environ["ROTOTOON_LIBRARY"] = str(max(built, key=lambda path: path.stat().st_mtime))


sys.path.insert(0, str(ADDON))
_find_library()


def program() -> Path:
    """The command line program, beside the library."""
    found = Path(os.environ.get("ROTOTOON_CLI", Path(os.environ["ROTOTOON_LIBRARY"]).parent / "rototoon"))
    assert found.is_file(), f"no program {found}: build it, or set ROTOTOON_CLI"
    return found


def corner(frame: int, part: int) -> tuple[float, float]:
    """Top-left corner of a square: one runs to the right and stops half-way to turn down, the other stays behind."""
    x = 8 + 3 * min(frame, 8)
    y = 6 + 2 * max(frame - 8, 0)
    return (float(x), float(y)) if part == 0 else (float(8 + 2 * frame), 38.0)


def square(frame: int, part: int) -> list[list[float]]:
    """The four corners of a square, clockwise on the screen."""
    x, y = corner(frame, part)
    return [[x, y], [x + 16, y], [x + 16, y + 16], [x, y + 16]]


def write_png(path: Path, pixels: list[list[tuple[int, int, int]]]) -> None:
    """A truecolour PNG of 8 bits: header, one block of unfiltered rows, end."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + bytes(value for pixel in row for value in pixel) for row in pixels)
    header = struct.pack(">IIBBBBB", len(pixels[0]), len(pixels), 8, 2, 0, 0, 0)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + body)


def draw(frame: int) -> list[list[tuple[int, int, int]]]:
    """Two outlined squares on a plain ground."""

    def pixel(x: int, y: int) -> tuple[int, int, int]:
        for part, fill in enumerate([(200, 60, 40), (40, 90, 200)]):
            left, top = corner(frame, part)
            inside = min(x - left, left + 15 - x, y - top, top + 15 - y)
            if inside >= 0:
                return (20, 20, 20) if inside < 2 else fill
        return (235, 230, 210)

    return [[pixel(x, y) for x in range(WIDTH)] for y in range(HEIGHT)]


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the cartoon's frames; its name is not plain ASCII, as artists' are not."""
    folder = tmp_path_factory.mktemp("Größe 縦")
    for frame in range(LAST + 1):
        write_png(folder / f"frame_{frame:03}.png", draw(frame))
    return folder


@pytest.fixture
def document() -> dict:
    """Two parts of equal depth, keyed on frames 0, 6 and 12: four spans, none hides another."""
    footage = {"pattern": "frame_%03d.png", "first": 0, "last": LAST, "fps": 25, "width": WIDTH, "height": HEIGHT}
    parts = [
        {
            "name": name,
            "closed": True,
            "depth": 1,
            "keys": {str(frame): square(frame, part) for frame in (0, 6, 12)},
        }
        for part, name in enumerate(["red", "blau ü"])
    ]
    return {"rototoon": 1, "footage": footage, "parts": parts}


@pytest.fixture
def session(document, folder):
    from rototoon import Session

    with Session.from_document(document, folder) as session:
        yield session
