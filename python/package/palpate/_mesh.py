"""Maps as triangles: what draws a surface in space wants points, corners and colours.

    maps over n x m points  ->  points (k, 3) that are known, triangles (t, 3) of cells whose corners all are
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

__all__ = ["SurfaceMesh", "surface_mesh"]

Array = npt.NDArray[np.float64]

# standard uncertainty, as a share of the size, at which nothing is known for a drawing
_DOUBTFUL = 0.02


class SurfaceMesh(NamedTuple):
    """Points (k, 3), triangles (t, 3) as numbers of points, and each map's values (k,) at the points."""

    points: Array
    triangles: npt.NDArray[np.int64]
    values: dict[str, Array]

    @property
    def size(self) -> float:
        """Longest edge of the box around it."""
        return float(np.ptp(self.points, axis=0).max()) if len(self.points) else 0.0

    @property
    def doubt(self) -> Array:
        """How little is known of every point: 0 nothing to doubt, 1 a standard uncertainty of 2 % of the size or more; NaN: nothing says."""
        unknown = np.full(len(self.points), np.nan)
        share = self.values.get("u_position", unknown) / (_DOUBTFUL * (self.size or 1.0))
        found: Array = np.clip(share, 0.0, 1.0)
        return found


def surface_mesh(maps: dict[str, Array]) -> SurfaceMesh:
    """The triangles of maps, as `Fit.maps` and `LiveLoop.maps` give them; what is not known is left out.

    >>> z = np.array([[0.0, 0.0, np.nan], [1.0, 1.0, 1.0]])
    >>> mesh = surface_mesh({"x": np.arange(2.0), "y": np.arange(3.0), "z": z, "S": z})
    >>> len(mesh.points), mesh.triangles.tolist(), mesh.values["S"].tolist()
    (5, [[0, 2, 3], [0, 3, 1]], [0.0, 0.0, 1.0, 1.0, 1.0])
    """
    flat = {name: values for name, values in maps.items() if values.ndim == 2}
    if "X" in maps:
        places = np.stack([maps["X"], maps["Y"], maps["Z"]], axis=-1)
    else:
        x, y = np.meshgrid(maps["x"], maps["y"], indexing="ij")
        places = np.stack([x, y, maps["z"]], axis=-1)
    known = np.isfinite(places).all(axis=-1)
    number = np.where(known, np.cumsum(known.ravel()).reshape(known.shape) - 1, -1)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    whole = (np.stack([a, b, c, d]) >= 0).all(axis=0)
    halves = [np.stack([corner[whole] for corner in half], axis=-1) for half in ((a, b, c), (a, c, d))]
    triangles = np.stack(halves, axis=1).reshape(-1, 3)
    return SurfaceMesh(places[known], triangles, {name: values[known] for name, values in flat.items()})
