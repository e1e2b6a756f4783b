"""Contacts and grids as arguments: columns, or one thing in their place that holds them.

    x, y, z, ...                                       columns
    array (N, 3) or (N, 6)                             places, and normals
    DataFrame (pandas, polars), Table (PyArrow), dict  columns by name, as any of the program's tables may name them
    DataArray over x and y, Dataset                    a grid, or columns
    path                                               a file in any format that `palpate fit` reads
    points and normals (Open3D), vertices (trimesh)    places, and normals where there are any
"""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from . import _native

__all__ = ["Columns", "columns", "is_grid", "is_table"]


class Columns(NamedTuple):
    """What a fit is made of, each as it was given or None. weights: wz, wx, wy. labels: finger, station."""

    x: Any
    y: Any
    z: Any
    normals: Any = None
    slopes: Any = None
    weights: tuple[Any, Any, Any] = (None, None, None)
    labels: tuple[Any, Any] = (None, None)


def columns(verb: str, given: Columns) -> Columns:
    """What was given; with the columns of whatever x is where it stands alone.

    What stands beside it goes before its columns. Raises TypeError where y or z is missing, and ValueError where there is no
    column x, y or z.

    >>> columns("fit", Columns({"x": [0.0], "y": [1.0], "z": [2.0], "finger": [7]}, None, None)).labels
    ([7], None)
    >>> columns("fit", Columns(np.arange(6.0).reshape(2, 3), None, None)).z
    array([2., 5.])
    """
    x, y, z = given.x, given.y, given.z
    if y is not None and z is not None:
        return given
    if y is None and z is None:
        alone = _alone(x, given)
        if alone is not None:
            return alone
    raise TypeError(
        f"{'y' if y is None else 'z'} is missing: {verb}(x, y, z), or alone an array (N, 3) or (N, 6), a table, a path, a cloud or a DataArray"
    )


def _alone(x: Any, given: Columns) -> Columns | None:
    """The columns of one thing that holds all of them; None where it is no such thing."""
    if isinstance(x, (str, PathLike)):
        return _of_file(x, given)
    if hasattr(x, "dims") and hasattr(x, "coords"):
        return _of_xarray(x, given)
    table = _by_name(x)
    if table is not None:
        return _of_table(table, given)
    for points, normals in (("points", "normals"), ("vertices", "vertex_normals"), ("vertices", None)):
        if hasattr(x, points) and (normals is None or hasattr(x, normals)):
            return _of_cloud(np.asarray(getattr(x, points)), normals and np.asarray(getattr(x, normals)), given)
    return _of_array(x, given)


def is_grid(z: Any) -> bool:
    """Whether z has two dimensions."""
    dimensions = getattr(z, "ndim", None)
    return bool((np.ndim(z) if dimensions is None else dimensions) == 2)


def is_table(thing: Any) -> bool:
    """Whether it has columns by name: a DataFrame, a Table or a mapping."""
    return _by_name(thing) is not None


def _by_name(thing: Any) -> Mapping[str, Any] | None:
    """Columns by their names: of pandas and mappings, of polars, of PyArrow."""
    if hasattr(thing, "keys") and hasattr(thing, "__getitem__"):
        return {name: thing[name] for name in thing.keys()}
    if hasattr(thing, "column_names") and hasattr(thing, "column"):
        return {name: np.asarray(thing.column(name)) for name in thing.column_names}
    if hasattr(thing, "columns") and hasattr(thing, "get_column"):
        return {name: thing.get_column(name).to_numpy() for name in thing.columns}
    return None


def _of_table(table: Mapping[str, Any], given: Columns) -> Columns:
    named = [name for name in table if isinstance(name, str)]
    if not {"x", "y", "z"} <= set(named):
        table = {ours: table[theirs] for ours, theirs in zip(_native.column_names(named), named)}
    missing = [name for name in "xyz" if name not in table]
    if missing:
        raise ValueError(f"x: a table of contacts has columns x, y and z; {', '.join(missing)} is missing")
    normals, slopes = given.normals, given.slopes
    if normals is None and slopes is None:
        if all(name in table for name in ("nx", "ny", "nz")):
            normals = tuple(table[name] for name in ("nx", "ny", "nz"))
        elif all(name in table for name in ("zx", "zy")):
            slopes = tuple(table[name] for name in ("zx", "zy"))

    def beside(own: Any, name: str) -> Any:
        return table[name] if own is None and name in table else own

    wz, wx, wy = given.weights
    finger, station = given.labels
    return Columns(
        table["x"], table["y"], table["z"], normals, slopes,
        (beside(wz, "wz"), beside(wx, "wx"), beside(wy, "wy")), (beside(finger, "finger"), beside(station, "station")),
    )  # fmt: skip


def _of_file(path: str | PathLike[str], given: Columns) -> Columns:
    name = fspath(path)
    return _of_table(_native.read_contacts(name, Path(name).read_bytes()), given)


def _of_xarray(data: Any, given: Columns) -> Columns:
    """A DataArray over x and y, or a Dataset: with z over x and y a grid, else columns."""
    if not hasattr(data, "data_vars"):
        array = data.transpose("x", "y")
        return given._replace(x=array.coords["x"].values, y=array.coords["y"].values, z=array.values)
    if {"x", "y"} <= set(data.dims) and "z" in data.data_vars:
        grid = data.transpose("x", "y")
        slopes = given.slopes
        if slopes is None and {"zx", "zy"} <= set(data.data_vars):
            slopes = (grid["zx"].values, grid["zy"].values)
        return given._replace(x=grid["x"].values, y=grid["y"].values, z=grid["z"].values, slopes=slopes)
    return _of_table({str(name): data[name].values for name in data.variables}, given)


def _of_cloud(points: Any, normals: Any, given: Columns) -> Columns:
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"x: its points have shape {points.shape}; (N, 3) is needed")
    # a cloud without normals has a list of none
    beside = given.normals is not None or given.slopes is not None
    own = normals is not None and len(normals) == len(points) > 0 and not beside
    return given._replace(
        x=points[:, 0], y=points[:, 1], z=points[:, 2], normals=normals if own else given.normals
    )


def _of_array(x: Any, given: Columns) -> Columns | None:
    try:
        array = np.asarray(x)
    except ValueError:
        return None
    if array.ndim != 2 or array.shape[1] not in (3, 6) or array.dtype.kind not in "fiu":
        return None
    return _of_cloud(array[:, :3], array[:, 3:] if array.shape[1] == 6 else None, given)
