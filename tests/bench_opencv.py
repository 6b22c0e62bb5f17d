"""Compares the times of Rototoon's image operations with OpenCV's, on the same picture with the same parameters.

    pip install opencv-python-headless
    python tests/bench_opencv.py              # runs the criterion benchmark, then OpenCV, and prints one table
    python tests/bench_opencv.py --measured   # uses the figures of the benchmark's last run

The table gives medians in milliseconds per megapixel, each on one thread and on all. Canny includes the conversion to grey
and the blur.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

import cv2
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
PICTURE = ROOT / "target/bench/image.png"
CRITERION = ROOT / "target/criterion/image"

# Least total time and least number of calls of a measurement.
SECONDS = 1.0
CALLS = 10


def operations(picture):
    """For each operation its name in the benchmark, its title, and the equivalent call of OpenCV."""
    light = picture.astype(np.float32) / 255
    # The kernel for σ = 1 with a reach of 3 σ.
    blurred = lambda source: cv2.GaussianBlur(source, (7, 7), 1.0)
    canny = lambda: cv2.Canny(blurred(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)), 50, 100)
    no_edge = 255 - canny()
    return [
        ("canny", "Canny, σ 1", canny),
        ("distance_transform", "Manhattan distance", lambda: cv2.distanceTransform(no_edge, cv2.DIST_L1, 3)),
        ("mean_shift", "mean shift 5, 20", lambda: cv2.pyrMeanShiftFiltering(picture, 5, 20)),
        ("gaussian", "blur σ 1, float colour", lambda: blurred(light)),
        ("reduce", "area reduction by 2, float colour",
         lambda: cv2.resize(light, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)),
        ("lab", "CIE Lab, float colour", lambda: cv2.cvtColor(light, cv2.COLOR_BGR2LAB)),
    ]


def milliseconds(call):
    """The median time of a call in milliseconds."""
    call()
    times = []
    while len(times) < CALLS or sum(times) < SECONDS:
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return 1e3 * statistics.median(times)


def benchmarked(name, threads):
    """The median of the criterion benchmark in milliseconds."""
    file = CRITERION / f"{name}_{threads}" / "new/estimates.json"
    return json.loads(file.read_text())["median"]["point_estimate"] / 1e6


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--measured", action="store_true", help="use the figures of the benchmark's last run")
    if not parser.parse_args().measured:
        subprocess.run(["cargo", "bench", "-p", "rototoon-image", "--bench", "image"], cwd=ROOT, check=True)
    picture = cv2.imread(str(PICTURE))
    if picture is None:
        sys.exit(f"{PICTURE}: found no picture; run without --measured first")
    megapixels = picture.shape[0] * picture.shape[1] / 1e6
    processors = os.cpu_count()
    print(f"\nms per megapixel, OpenCV {cv2.__version__}, {processors} processors\n")
    print(f"| | Rototoon, 1 thread | OpenCV, 1 thread | Rototoon, {processors} threads | OpenCV, {processors} threads |")
    print("| --- | --- | --- | --- | --- |")
    for name, title, call in operations(picture):
        figures = []
        for ours, theirs in (("one", 1), ("all", processors)):
            cv2.setNumThreads(theirs)
            figures += [benchmarked(name, ours), milliseconds(call)]
        print(f"| {title} | " + " | ".join(f"{figure / megapixels:.1f}" for figure in figures) + " |")


if __name__ == "__main__":
    main()
