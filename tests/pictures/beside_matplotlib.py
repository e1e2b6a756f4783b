"""Puts palpate's pictures beside matplotlib's of the same numbers.

    palpate run paper-fig4-r10-45deg --grid 60x60 --out out --pictures png
    python tests/pictures/beside_matplotlib.py out beside.png

Left shape.png, right S and R of maps.npz with the contacts of contacts.csv. Needs numpy and matplotlib.
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LinearSegmentedColormap

# the stops of src/app/report/colour.rs
STOPS = [(24, 54, 130), (58, 110, 184), (140, 182, 222), (238, 236, 228), (240, 170, 116), (208, 92, 60), (142, 24, 36)]


def main(directory: Path, target: Path) -> None:
    maps = np.load(directory / "maps.npz")
    lines = [line for line in (directory / "contacts.csv").read_text().splitlines() if not line.startswith("#")]
    header = lines[0].split(",")
    contacts = np.array([[float(v) for v in line.split(",")[:3]] for line in lines[1:]])
    assert header[:3] == ["x", "y", "z"], header
    diverging = LinearSegmentedColormap.from_list("S", [tuple(c / 255 for c in stop) for stop in STOPS])
    figure = plt.figure(figsize=(14, 6))
    left = figure.add_axes([0.0, 0.0, 0.47, 1.0])
    left.imshow(plt.imread(directory / "shape.png"))
    left.axis("off")
    scales = [("S", diverging, -1.0, 1.0), ("R", "viridis", 0.0, float(np.nanmax(maps["R"])))]
    for k, (name, colours, lo, hi) in enumerate(scales):
        axes = figure.add_axes([0.5 + 0.26 * k, 0.3, 0.18, 0.5])
        mesh = axes.pcolormesh(maps["x"], maps["y"], maps[name].T, cmap=colours, vmin=lo, vmax=hi, shading="gouraud")
        axes.plot(contacts[:, 0], contacts[:, 1], "k.", markersize=4)
        axes.set(title=name, xlabel="x", ylabel="y", aspect="equal")
        figure.colorbar(mesh, ax=axes)
    figure.savefig(target, dpi=110)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
