"""A picture of a fit, by matplotlib, which is asked for here alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._native import ParametricSurface

if TYPE_CHECKING:
    from ._fit import Fit

__all__ = ["plot"]

QUANTITIES = {"R": "R, curvedness", "S": "S, shape index", "k1": "k1", "k2": "k2", "z": "z"}


def plot(fit: Fit, ax: Any, grid: int | tuple[int, int], quantity: str) -> Any:
    """Draws the surface into axes of projection "3d"; gives them back."""
    if quantity not in QUANTITIES:
        raise ValueError(f"quantity is {quantity!r}: one of {', '.join(QUANTITIES)} is wanted")
    try:
        import matplotlib
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError("plot() draws with matplotlib, which is not installed: pip install matplotlib") from error
    points, values = _points_and_values(fit, grid, quantity)
    if ax is None:
        ax = pyplot.figure().add_subplot(projection="3d")
    known = values[np.isfinite(values)]
    lo, hi = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    if quantity == "S":
        lo, hi = -1.0, 1.0
    # what is constant is one colour, and not the noise of its last digits
    flat = hi - lo <= 1e-9 * max(abs(lo), abs(hi), 1e-300)
    norm = matplotlib.colors.Normalize(lo - flat, hi + flat)
    colours = matplotlib.colormaps["coolwarm" if quantity == "S" else "viridis"]
    shaded = np.where(np.isfinite(values), values, lo)
    ax.plot_surface(*points, facecolors=colours(norm(shaded)), rstride=1, cstride=1, linewidth=0, shade=False)
    scale = matplotlib.cm.ScalarMappable(norm, colours)
    ax.figure.colorbar(scale, ax=ax, label=QUANTITIES[quantity], shrink=0.7)
    unit = "" if fit.unit is None else f" ({fit.unit})"
    ax.set(xlabel=f"x{unit}", ylabel=f"y{unit}", zlabel=f"z{unit}", title=fit.shape.class_name or "no one class")
    ax.set_aspect("equal")
    return ax


def _points_and_values(fit: Fit, grid: int | tuple[int, int], quantity: str) -> tuple[Any, Any]:
    """x, y and z over two directions, and what colours them."""
    n, m = (grid, grid) if isinstance(grid, int) else grid
    surface = fit.surface
    if isinstance(surface, ParametricSurface):
        u0, u1, v0, v1 = surface.domain
        u, v = np.linspace(u0, u1, n), np.linspace(v0, v1, m)
        places = np.moveaxis(np.asarray(surface(u, v)), -1, 0)
        return places, places[2] if quantity == "z" else surface.shape(u, v)[quantity]
    maps = fit.maps((n, m))
    x, y = np.meshgrid(maps["x"], maps["y"], indexing="ij")
    # a patch that leans has axes of its own
    axes = np.asarray(fit.to_dict()["frame"]["axes"])
    places = np.tensordot(axes, np.stack([x, y, maps["z"]]), axes=(0, 0))
    return places, places[2] if quantity == "z" else maps[quantity]

