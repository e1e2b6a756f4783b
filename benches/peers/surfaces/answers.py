"""What palpate says of contacts or an image with no option but the points that are asked: its map, read back from its table."""
import csv
import json
import os
import subprocess
import tempfile

import numpy as np

COLUMNS = ("x", "y", "z", "k1", "k2", "S", "R", "u_position", "u_S", "u_R")


def table(path):
    with open(path) as lines:
        rows = list(csv.DictReader(lines))
    return {name: np.array([float(row.get(name) or "nan") for row in rows]) for name in rows[0]}


def fitted(program, source, *options, grid=20, inset=0.1):
    """The document of a fit and its map; raises RuntimeError with palpate's own words where there is no answer."""
    with tempfile.TemporaryDirectory() as out:
        line = [program, "fit", source, "--grid", f"{grid}x{grid}", "--inset", str(inset), *options, "--json", "--out", out]
        run = subprocess.run(line, capture_output=True, text=True)
        if run.returncode:
            raise RuntimeError((run.stderr or run.stdout).strip())
        return json.loads(run.stdout), table(os.path.join(out, "maps.csv"))


def of_contacts(program, x, y, z, normals=None, *options, **grid):
    columns, names = [x, y, z], "x,y,z"
    if normals is not None:
        columns, names = [*columns, *normals.T], "x,y,z,nx,ny,nz"
    with tempfile.TemporaryDirectory() as folder:
        source = os.path.join(folder, "contacts.csv")
        np.savetxt(source, np.column_stack(columns), fmt="%.10g", delimiter=",", header=names, comments="")
        return fitted(program, source, *options, **grid)


def of_image(program, at, image, *options, **grid):
    with tempfile.TemporaryDirectory() as folder:
        source = os.path.join(folder, "image.npz")
        np.savez(source, x=at, y=at, z=image)
        return fitted(program, source, *options, **grid)
