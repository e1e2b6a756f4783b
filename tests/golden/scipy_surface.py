"""A saved surface through SciPy: heights and slopes of `surface` in palpate's JSON, and `palpate show --at`.

    palpate run paper-cylinder --degree 3 --segments 2,3 --save s.json --quiet     (any surface)
    python tests/golden/scipy_surface.py s.json target/release/palpate

Prints the largest difference to SciPy's NdBSpline at 100 points, relative to the range of the heights (slopes: to the
largest slope).
"""
import json
import subprocess
import sys
import tempfile

import numpy as np
from scipy.interpolate import NdBSpline

path, palpate = sys.argv[1:3]
surface = json.load(open(path))["surface"]
knots = [np.array(t) for t in surface["knots"]]
spline = NdBSpline(tuple(knots), np.array(surface["coefficients"]), tuple(surface["degree"]))
rng = np.random.default_rng(1997)
points = np.stack([rng.uniform(t[0], t[-1], 100) for t in knots], axis=-1)
with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
    file.write("x,y\n" + "".join(f"{x!r},{y!r}\n" for x, y in points.tolist()))
    file.flush()
    shown = json.loads(subprocess.check_output([palpate, "show", path, "--at", file.name, "--json"]))["points"]
heights = spline(points)
scale = np.ptp(heights) or 1.0
slopes = {"zx": spline(points, nu=(1, 0)), "zy": spline(points, nu=(0, 1))}
largest = max(np.abs(v).max() for v in slopes.values()) or 1.0
print("z ", np.abs(heights - [p["z"] for p in shown]).max() / scale)
for key, value in slopes.items():
    print(key, np.abs(value - [p[key] for p in shown]).max() / largest)
