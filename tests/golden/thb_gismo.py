"""Truncated hierarchical B-splines of G+Smo at random places, as a reference for ours: thb_gismo.txt.

    pip install pygismo numpy; thb_gismo.py

Hierarchies are refined at random by the rule of src/hierarchical/mesh: before a cell is split, every cell of its level that a function of
the level on it reaches exists. Only values that are not zero are written.
"""

import random
from pathlib import Path

import numpy as np
import pygismo

SEGMENTS = 4
PLACES = 40


def splits(degree: int, seed: int) -> list[tuple[int, int, int]]:
    """Cells that are split, in an order in which each exists when it is."""
    draw, done = random.Random(seed), []

    def split(level: int, i: int, j: int) -> None:
        if (level, i, j) in done:
            return
        if level > 0:
            last = (SEGMENTS << level) - 1
            reach = [range(max(0, k - degree) // 2, min(last, k + degree) // 2 + 1) for k in (i, j)]
            for a in reach[0]:
                for b in reach[1]:
                    split(level - 1, a, b)
        done.append((level, i, j))

    for _ in range(3):
        level = draw.choice([0, 1, 2])
        split(level, draw.randrange(SEGMENTS << level), draw.randrange(SEGMENTS << level))
    return done


def main() -> None:
    lines = []
    for degree, seed in ((2, 1), (3, 2), (3, 5), (4, 3)):
        cells = splits(degree, seed)
        inner = [k / SEGMENTS for k in range(1, SEGMENTS)]
        knots = pygismo.nurbs.gsKnotVector([0.0] * (degree + 1) + inner + [1.0] * (degree + 1), degree)
        tensor = pygismo.nurbs.gsTensorBSplineBasis2(knots, knots)
        basis = pygismo.hsplines.gsTHBSplineBasis2(tensor)
        for level in range(3):
            boxes = [
                number
                for cell in cells
                if cell[0] == level
                for number in (level + 1, 2 * cell[1], 2 * cell[2], 2 * cell[1] + 2, 2 * cell[2] + 2)
            ]
            if boxes:
                basis.refineElements(boxes)
        places = np.random.default_rng(seed).uniform(0, 1, (2, PLACES))
        lines.append(f"hierarchy {degree} {SEGMENTS} {basis.size()}")
        lines.append("splits " + " ".join(f"{level},{i},{j}" for level, i, j in cells))
        for k in range(PLACES):
            place = places[:, k : k + 1].copy(order="F")
            active = np.asarray(basis.active(place)).ravel()
            values = np.asarray(basis.eval(place)).ravel()
            there = " ".join(f"{n}:{v!r}" for n, v in zip(active.tolist(), values.tolist()) if v != 0.0)
            lines.append(f"at {place[0, 0]!r} {place[1, 0]!r} {there}".replace("np.float64(", "").replace(")", ""))
    Path(__file__).with_suffix(".txt").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
