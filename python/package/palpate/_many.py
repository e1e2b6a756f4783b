"""Many patches at once: one fit each, on all threads, into columns.

    patch k  ->  S[k], R[k], their u, class[k], radius[k] ...
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._errors import in_python
from ._tables import html_table, number

if TYPE_CHECKING:
    import pandas

__all__ = ["FitMany", "fit_many", "tiles"]

Array = npt.NDArray[np.float64]

_COLUMNS = (
    "shape_index", "shape_index_sd", "shape_index_u", "curvedness", "curvedness_sd", "curvedness_u", "k1", "k2", "radius",
    "direction_deg",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class FitMany:
    """Columns with one entry a patch; NaN where a patch has no such number.

    shape_index, curvedness (1/length) and their _sd (variation over the patch) and _u (uncertainty; of a named model
    that of noise alone, the u_noise of `fit`); k1, k2 (1/length);
    radius; direction_deg. class_number counts the words of class_names, -1: none. failed: why a patch has no fit.
    """

    columns: dict[str, Array]
    class_number: npt.NDArray[np.int8]
    failed: dict[int, str]

    def __getattr__(self, name: str) -> Array:
        columns: dict[str, Array] = self.__dict__.get("columns", {})
        try:
            return columns[name]
        except KeyError:
            raise AttributeError(f"FitMany has no {name}; its columns are {', '.join(_COLUMNS)}") from None

    @property
    def class_name(self) -> list[str | None]:
        """The class of the mean S of every patch."""
        names = _native.class_names()
        return [None if number < 0 else names[number] for number in self.class_number]

    def __len__(self) -> int:
        return len(self.class_number)

    def to_pandas(self) -> pandas.DataFrame:
        """One row a patch."""
        import pandas

        return pandas.DataFrame({**self.columns, "class": self.class_name})

    @classmethod
    def join(cls, parts: list[FitMany]) -> FitMany:
        """The patches of all parts, one part after the other."""
        columns = {name: np.concatenate([part.columns[name] for part in parts] or [np.empty(0)]) for name in _COLUMNS}
        failed, before = {}, 0
        for part in parts:
            failed.update({before + k: why for k, why in part.failed.items()})
            before += len(part)
        return cls(columns, np.concatenate([part.class_number for part in parts] or [np.empty(0, np.int8)]), failed)

    def __repr__(self) -> str:
        return f"FitMany({len(self)} patches, {len(self.failed)} without a fit)"

    def _repr_html_(self) -> str:
        names = self.class_name
        rows = [
            [str(k), names[k] or "-", *(number(float(self.columns[c][k])) for c in ("shape_index", "curvedness", "radius"))]
            for k in range(min(len(self), 10))
        ]
        return html_table(repr(self), ["patch", "class", "S", "R", "radius"], rows)


def fit_many(
    x: Any,
    y: Any,
    z: Any,
    *,
    normals: Any = None,
    slopes: Any = None,
    offsets: Any = None,
    threads: int | None = None,
    progress: Callable[[int, int], object] | None = None,
    **options: Any,
) -> FitMany:
    """Fits every patch of a batch.

    Equal size: z (b, g); x, y (b, g), or (g,) where all patches are touched at the same places; normals (b, g, 3) or
    slopes (b, g, 2). Images: x (n,), y (m,), or (b, n) and (b, m), z (b, n, m), NaN where a height is missing. Ragged:
    x, y, z (all contacts,), normals (all contacts, 3), offsets (b + 1,): patch k is offsets[k] to offsets[k + 1].

    options: those of `fit`; without any that names a model every patch is recognised, which takes a thousand times as
    long. bare=True leaves out the uncertainties. threads: all that the process has, unless it is given. progress(done, of)
    is called now and then; Ctrl-C ends the work. A patch that has no fit stands in `failed` and has NaN in its columns.

    >>> import numpy as np, palpate
    >>> x, y = (a.ravel() for a in np.meshgrid(np.linspace(-1, 1, 6), np.linspace(-1, 1, 6)))
    >>> z = np.array([0.1 * x * x, 0.1 * (x * x + y * y), 0 * x])
    >>> palpate.fit_many(x, y, z, degree=2, weights="equal").class_name
    ['rut', 'cup', 'plane']
    """
    words = {**options, "bare": options.get("bare") or None}
    found = _native.fit_batch(x, y, z, normals, slopes, offsets, threads, progress, words)
    failed = {int(k): in_python(why) for k, why in found.pop("failed")}
    return FitMany({name: found[name] for name in _COLUMNS}, found["class"], failed)


def tiles(image: Any, size: int | tuple[int, int]) -> npt.NDArray[Any]:
    """Cuts an image (n, m) into tiles of `size` pixels: (tiles, size, size), row by row; what is over at the far edges
    is left out. Where the image lies in order, the only copy is the one that puts a tile's pixels together. Tiles of a Dask
    array are one, and are made by whoever computes them.

    >>> import numpy as np
    >>> tiles(np.arange(16.0).reshape(4, 4), 2)[1]
    array([[2., 3.],
           [6., 7.]])
    """
    # a Dask array stays where it is
    array: npt.NDArray[Any] = image if hasattr(image, "__dask_graph__") else np.asanyarray(image)
    a, b = (size, size) if isinstance(size, int) else size
    if array.ndim != 2 or a < 1 or b < 1:
        raise ValueError(f"image, size: an image (n, m) and tiles of 1 pixel or more wanted, not {array.shape}, {size}")
    rows, columns = array.shape[0] // a, array.shape[1] // b
    cut: npt.NDArray[Any] = array[: rows * a, : columns * b].reshape(rows, a, columns, b)
    found: npt.NDArray[Any] = cut.swapaxes(1, 2).reshape(rows * columns, a, b)
    return found
