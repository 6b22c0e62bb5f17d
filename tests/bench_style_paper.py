#!/usr/bin/env python3
"""Repeats the experiments of Liang et al. 2012 (their section 6) with Rototoon's models and with those of other libraries.

    cargo xtask bench-style [DIR…]

builds the program and the environment, runs this script for the `clips.json` of each DIR (or for synthetic gaits if there is
none), and draws the plots. To run it by hand, with NumPy, SciPy and scikit-learn:

    python3 tests/bench_style_paper.py --own target/release/bench-style --out target/style [--clips FILE]

- **Class separability**: five nearest neighbours classify the character of a posture by its features, with ten-fold
  cross-validation. The features are the 34 numbers themselves, principal components, and the codes of Rototoon's and of
  scikit-learn's factorisation. Folds of postures, as in the paper, have nearly equal postures (of neighbouring frames) in
  training and test. Folds of motions do not.
- **Intrinsic dimension**: residual variance 1 - R² of ISOMAP embeddings (scikit-learn, from 8 neighbours on, at most 1000
  postures) for dimensions 1 to 40, of the postures and of the codes, and the same of principal components. The number of
  neighbours is the smallest one that connects all postures.
- **Precision against rank**: error of translation by preset and rank, and relative error of reconstruction by rank.
- **Limbs**: width, roughness and place of bent limbs with 0 to 8 sub-key points per bone, and with five sub-key points and
  the rule printed in the paper. 0 is plain manipulation by key points.
- **Overlap order**: share of crossing pairs in the right order, by the share of marked pairs.

The script prints tables to standard output and writes the numbers of the plots to OUT/*.plot.json. `bench-tracking` measures
the user-edit ratios of tracking.
"""
import argparse
import json
import pathlib
import subprocess
import warnings

import numpy as np
from scipy.sparse.csgraph import connected_components
from sklearn.decomposition import NMF
from sklearn.manifold import Isomap
from sklearn.model_selection import GroupKFold, StratifiedKFold, cross_val_score
from sklearn.neighbors import KNeighborsClassifier, kneighbors_graph

ROUNDS = 200
FOLDS = 10
RANKS = (1, 2, 4, 6, 8, 10, 15, 20, 25, 30, 34)
FEATURE_RANKS = (10, 24)
DIMENSIONS = 40
NEIGHBOURS = (8, 12, 16, 24, 32)
MOST_POSTURES = 1000
NAMES = ["pelvis", "chest", "neck", "head", "head_top", "l_shoulder", "l_elbow", "l_wrist", "r_shoulder", "r_elbow", "r_wrist",
         "l_hip", "l_knee", "l_ankle", "r_hip", "r_knee", "r_ankle"]
STANDING = [[0, 0], [0, -0.6], [0, -1], [0, -1.15], [0, -1.5], [0.05, -0.9], [0.1, -0.4], [0.1, 0.1], [-0.05, -0.9], [-0.1, -0.4],
            [-0.1, 0.1], [0.05, 0.05], [0.1, 0.95], [0.05, 1.8], [-0.05, 0.05], [-0.1, 0.95], [-0.05, 1.8]]


def own(program, **job):
    """Runs the program with a job and returns its result."""
    said = subprocess.run([program], input=json.dumps(job), capture_output=True, text=True, check=False)
    if said.returncode:
        raise SystemExit(f"{program}: {said.stderr.strip()}")
    return json.loads(said.stdout)


def made_up(path, characters=6, motions=8, frames=32):
    """Writes gaits of synthetic characters. Each motion swings in its own way. Each character has its own lean and swing."""
    random = np.random.default_rng(7)
    standing = np.asarray(STANDING)
    waves = random.normal(0, 0.12, (motions, 3, 17, 2)) * np.linspace(0.2, 1.5, 17)[None, None, :, None] ** 2
    lean, size = random.normal(0, 0.12, (characters, 17, 2)), random.uniform(0.6, 1.4, characters)
    phase = np.linspace(0, 2 * np.pi, frames, endpoint=False)
    clips = []
    for c in range(characters):
        for m in range(motions):
            swing = sum(np.sin(k * phase + random.normal(0, 0.2))[:, None, None] * waves[m, k - 1] / k for k in (1, 2, 3))
            points = standing + lean[c] + size[c] * swing + random.normal(0, 0.01, (frames, 17, 2))
            points -= points[:, :1]
            clips.append({"character": f"character {c}", "motion": f"motion {m}", "points": points.round(5).tolist()})
    path.write_text(json.dumps({"rototoon_clips": 1, "fps": 24, "keypoints": NAMES, "clips": clips}), encoding="utf-8")
    return path


class Postures:
    """The postures of a file of clips as rows, with the character and the motion of each."""

    def __init__(self, path):
        document = json.loads(path.read_text(encoding="utf-8"))
        clips = document["clips"]
        self.rows = np.vstack([np.asarray(clip["points"], float).reshape(len(clip["points"]), -1) for clip in clips])
        repeat = lambda key: np.concatenate([[clip[key]] * len(clip["points"]) for clip in clips])
        self.characters, self.motions = repeat("character"), repeat("motion")
        self.positive = self.rows - self.rows.min()

    def components(self, rank):
        """Principal components, and the relative error of a reconstruction from them and the mean (of the positive rows)."""
        mean = self.positive.mean(0)
        u, s, vt = np.linalg.svd(self.positive - mean, full_matrices=False)
        rest = np.sqrt((s[rank:] ** 2).sum()) / np.linalg.norm(self.positive)
        return u[:, :rank] * s[:rank], float(rest)

    def factored(self, program, rank):
        """Codes of Rototoon's factorisation, and its relative error."""
        job = {"rows": self.positive.tolist(), "rank": rank, "rounds": ROUNDS, "codes": True}
        made = own(program, factor=job)
        return np.asarray(made["codes"]), made["error"]

    def peer(self, rank):
        """Codes of scikit-learn's factorisation, and its relative error."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            model = NMF(rank, init="random", solver="mu", max_iter=ROUNDS, tol=0, random_state=0)
            codes = model.fit_transform(self.positive)
        return codes, float(np.linalg.norm(self.positive - codes @ model.components_) / np.linalg.norm(self.positive))


def plot(out, name, title, x, panels, note=""):
    """Writes the numbers of a plot.

    x is (label, low, high, logarithmic). A panel is (label, low, high, {name: (points, dashed)}).
    """
    panels = [{"label": label, "low": low, "high": high,
               "series": [{"name": key, "points": [[float(a), float(b)] for a, b in points], "dashed": dashed}
                          for key, (points, dashed) in series.items()]} for label, low, high, series in panels]
    label, low, high, logarithmic = x
    chart = {"title": title, "note": note, "x": {"label": label, "low": low, "high": high, "logarithmic": logarithmic}, "panels": panels}
    (out / f"{name}.plot.json").write_text(json.dumps(chart), encoding="utf-8")


def weighed(codes, rows):
    """Codes, with each component scaled by its contribution to the rows, because the scale of a code alone has no meaning."""
    basis = np.linalg.lstsq(codes, rows, rcond=None)[0]
    return codes * np.linalg.norm(basis, axis=1)


def together(rows):
    """The smallest number of neighbours with which all rows are connected."""
    pieces = lambda count: connected_components(kneighbors_graph(rows, count), directed=False)[0]
    return next((count for count in NEIGHBOURS if pieces(count) == 1), NEIGHBOURS[-1])


def separability(data, program):
    """Prints how well the features separate the characters."""
    print(f"\nClass separability: {len(set(data.characters))} characters classified by 5 nearest neighbours, {FOLDS}-fold\n")
    print("| features | folds of postures | folds of motions |\n| --- | ---: | ---: |")
    features = {"raw, 34": data.rows}
    for rank in FEATURE_RANKS:
        features[f"principal components, {rank}"] = data.components(rank)[0]
        features[f"non-negative factorisation, {rank}"] = weighed(data.factored(program, rank)[0], data.positive)
        features[f"scikit-learn's, {rank}"] = weighed(data.peer(rank)[0], data.positive)
    neighbours = KNeighborsClassifier(5)
    motions = len(set(data.motions))
    for name, rows in features.items():
        mixed = cross_val_score(neighbours, rows, data.characters, cv=StratifiedKFold(FOLDS, shuffle=True, random_state=0))
        apart = cross_val_score(neighbours, rows, data.characters, groups=data.motions, cv=GroupKFold(min(FOLDS, motions))) if motions > 1 else [np.nan]
        print(f"| {name} | {mixed.mean():.3f} ± {mixed.std():.3f} | {np.mean(apart):.3f} ± {np.std(apart):.3f} |")


def residuals(geodesic, embedding, dimensions):
    """1 - R² between distances along the manifold and distances in the first dimensions of an embedding."""
    upper = np.triu_indices(len(geodesic), 1)
    wanted, squares, found = geodesic[upper], np.zeros(len(upper[0])), []
    for d in range(dimensions):
        if d < embedding.shape[1]:
            squares += (embedding[upper[0], d] - embedding[upper[1], d]) ** 2
        found.append(1 - np.corrcoef(wanted, np.sqrt(squares))[0, 1] ** 2)
    return found


def dimension(data, program, out):
    """Prints and plots residual variances."""
    chosen = np.unique(np.linspace(0, len(data.rows) - 1, min(MOST_POSTURES, len(data.rows))).astype(int))
    codes = data.factored(program, 24)[0]
    series, table = {}, {}
    for name, rows in (("postures", data.rows), ("codes, 24", weighed(codes, data.positive))):
        rows = rows[chosen]
        model = Isomap(n_neighbors=together(rows), n_components=DIMENSIONS)
        embedding = model.fit_transform(rows)
        table[f"ISOMAP, {name}"] = residuals(model.dist_matrix_, embedding, DIMENSIONS)
        centred = rows - rows.mean(0)
        u, s, _ = np.linalg.svd(centred, full_matrices=False)
        table[f"PCA, {name}"] = residuals(model.dist_matrix_, u * s, DIMENSIONS)
    for name, values in table.items():
        series[name] = ([(d + 1, value) for d, value in enumerate(values)], name.startswith("PCA"))
    shown = (1, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30, 40)
    print(f"\nIntrinsic dimension: residual variance 1 - R² of the distances along the manifold ({len(chosen)} postures)\n")
    print("| dimension | " + " | ".join(map(str, shown)) + " |\n| --- |" + " ---: |" * len(shown))
    for name, values in table.items():
        print(f"| {name} | " + " | ".join(f"{values[d - 1]:.3f}" for d in shown) + " |")
    low = min(min(values) for values in table.values())
    for name, values in table.items():
        if name.startswith("ISOMAP"):
            enough = next(d + 1 for d, value in enumerate(values) if value <= min(values) + 0.01)
            print(f"\n{name}: within 0.01 of its smallest value from {enough} dimensions on")
    plot(out, "dimension", "Residual variance of ISOMAP embeddings", ("dimension", 0, DIMENSIONS, False),
         [("residual variance", 0, max(0.1, np.ceil(10 * max(max(v) for v in table.values())) / 10), series)], f"least {low:.3f}")


def reconstruction(data, program, out):
    """Prints and plots the precision of factorisations by rank."""
    ways = {"non-negative factorisation": lambda rank: data.factored(program, rank)[1], "scikit-learn's": lambda rank: data.peer(rank)[1],
            "principal components": lambda rank: data.components(rank)[1]}
    table = {name: [way(rank) for rank in RANKS] for name, way in ways.items()}
    print("\nReconstruction: relative error by rank\n\n| rank | " + " | ".join(map(str, RANKS)) + " |\n| --- |" + " ---: |" * len(RANKS))
    for name, values in table.items():
        print(f"| {name} | " + " | ".join(f"{value:.4f}" for value in values) + " |")
    series = {name: (list(zip(RANKS, np.maximum(values, 1e-4))), name == "principal components") for name, values in table.items()}
    plot(out, "reconstruction", "Reconstruction of postures by rank", ("rank", 0, 35, False),
         [("relative error", 0, 1.05 * max(v[0] for v in table.values()), series)])


def translation(path, program, out):
    """Prints and plots the precision of translation by rank."""
    found = own(program, translate={"clips": str(path)})
    ranks = sorted({row["rank"] for row in found if row["rank"]})
    error = {(row["preset"], row["rank"]): row["error"] for row in found}
    copied = error["copy", None]
    print("\nTranslation: mean error in torso lengths by preset and rank, sixteen clips left out in turn\n")
    print("| preset | " + " | ".join(map(str, ranks)) + " |\n| --- |" + " ---: |" * len(ranks))
    series = {}
    for preset in dict.fromkeys(row["preset"] for row in found):
        values = [error.get((preset, rank), error.get((preset, None))) for rank in ranks]
        flat = (preset, None) in error
        name = "content unchanged" if preset == "copy" else preset
        if flat:
            print(f"| {name} (has no rank) | {values[0]:.4f} |" + " |" * (len(ranks) - 1))
        else:
            print(f"| {name} | " + " | ".join(f"{value:.4f}" for value in values) + " |")
        series[name] = (list(zip(ranks, values)), flat)
    high = 1.1 * max(copied, *(min(2 * copied, value) for value in error.values()))
    plot(out, "translation", "Error of translation by rank", ("rank", 1, max(ranks), True), [("error, torso lengths", 0, high, series)])


def limbs(program, out):
    """Prints and plots limbs with and without sub-key points."""
    found = own(program, limbs={})
    for row in found:
        row["way"] = f"{row['sub_keys']}, as printed" if row["printed"] else f"{row['sub_keys']}"
    named = {row["way"]: row["sub_keys"] for row in found}
    value = {(row["way"], row["pose"], row["amount"]): row for row in found}
    for pose, unit in (("curve", "control points across, in bones"), ("elbow", "degrees")):
        amounts = sorted({row["amount"] for row in found if row["pose"] == pose})
        fields = ("width", "roughness", "off") if pose == "curve" else ("width",)
        print(f"\nLimbs, {pose} ({unit}): " + ", ".join({"width": "error of width in %", "roughness": "roughness beside the truth",
              "off": "distance from the truth in px"}[field] for field in fields) + "\n")
        print("| sub-key points | " + " | ".join(f"{amount:g}" for amount in amounts) + " |\n| ---: |" + " ---: |" * len(amounts))
        for count in named:
            rows = [value[count, pose, amount] for amount in amounts]
            cells = [", ".join(f"{100 * row[f]:.1f}" if f == "width" else f"{row[f]:.2f}" for f in fields) for row in rows]
            print(f"| {count} | " + " | ".join(cells) + " |")
    amounts = sorted({row["amount"] for row in found if row["pose"] == "curve"})
    panels = []
    for field, label in (("width", "error of width"), ("roughness", "roughness"), ("off", "off the truth, px")):
        series = {name: ([(a, value[name, "curve", a][field]) for a in amounts], count == 0) for name, count in named.items()}
        top = max(b for points, _ in series.values() for _, b in points)
        panels.append((label, 0, 1.05 * top, series))
    plot(out, "limbs", "Curved limbs by sub-key points a bone (0: plain manipulation by key points)", ("control points across, in bones", 0, max(amounts), False), panels)


def order(program, out):
    """Prints and plots overlap order from marks."""
    found = own(program, order={})
    sizes = sorted({row["limbs"] for row in found})
    shares = sorted({row["share"] for row in found if row["share"] is not None})
    value = {(row["limbs"], row["share"]): row for row in found}
    print("\nOverlap order: crossing pairs in the right order, in % (marks a frame)\n")
    print("| marked | " + " | ".join(f"{size} limbs" for size in sizes) + " |\n| --- |" + " ---: |" * len(sizes))
    for share in shares + [None]:
        name = "neighbours in the order" if share is None else f"{100 * share:.0f} % of the crossing pairs"
        cells = [value[size, share] for size in sizes]
        print(f"| {name} | " + " | ".join(f"{100 * cell['right']:.1f} ({cell['marks']:.1f})" for cell in cells) + " |")
    series = {f"{size} limbs": ([(100 * share, 100 * value[size, share]["right"]) for share in shares], False) for size in sizes}
    plot(out, "order", "Overlap order from marks", ("crossing pairs that are marked, %", 0, 100, False), [("right, %", 0, 100, series)])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--own", required=True, help="the program bench-style")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="the folder for the numbers of the plots")
    parser.add_argument("--clips", type=pathlib.Path, help="a file of clips; synthetic gaits by default")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    path = arguments.clips or made_up(arguments.out / "made_up.json")
    data = Postures(path)
    print(f"\n## {path.name if arguments.clips else 'synthetic gaits'}: {len(data.rows)} postures of {len(set(data.characters))} characters, "
          f"{len(set(data.motions))} motions")
    separability(data, arguments.own)
    dimension(data, arguments.own, arguments.out)
    reconstruction(data, arguments.own, arguments.out)
    translation(path, arguments.own, arguments.out)
    limbs(arguments.own, arguments.out)
    order(arguments.own, arguments.out)


if __name__ == "__main__":
    main()
