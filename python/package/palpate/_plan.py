"""The same places measured again: cells, weights and factor of an adaptive fit stay."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy.typing as npt

from . import _native
from ._columns import Columns, columns
from ._fit import Fit
from ._native import Surface


class RepeatedHeights(NamedTuple):
    """A surface over the cells of a first measurement, and the standard deviation of one of its heights."""

    surface: Surface
    noise: float


class AdaptivePlan:
    """An adaptive fit that is made once, and then of other heights at the same places: each costs one pass and one solution.

    x, y, z or what `palpate.fit` takes alone; slopes (N, 2); weights (wz, wx, wy); options: degree, domain, sigma, grid, inset, level,
    bare, and adaptive={...}. Contacts with normals are refused, whose rows depend on the heights. Which cells there are, how strongly
    roughness counts and which contacts are left out is what the first measurement said: `first`, a Fit without residuals.

    Raises what `palpate.fit` raises.

    >>> import numpy as np
    >>> x, y = np.random.default_rng(3).uniform(-1, 1, (2, 4000))
    >>> plan = AdaptivePlan(x, y, 0.1 * (x * x + y * y))
    >>> again = plan.fit(0.2 * (x * x + y * y))
    >>> plan.first.shape.class_name, abs(float(again.surface(0.5, 0.5, grid=False)) - 0.1) < 1e-6
    ('cup', True)
    """

    def __init__(
        self,
        x: Any,
        y: Any = None,
        z: Any = None,
        *,
        slopes: npt.ArrayLike | None = None,
        weights: tuple[Any, Any, Any] = (None, None, None),
        unit: str | None = None,
        **options: Any,
    ) -> None:
        x, y, z, normals, slopes, weights, _ = columns("AdaptivePlan", Columns(x, y, z, None, slopes, weights))
        if normals is not None:
            raise ValueError("normals: rows of normals depend on the heights; give slopes, or positions alone")
        words = {"adaptive": True, **options}
        unit = None if unit is None else _native.unit_name(unit)
        core, self._plan = _native.plan_adaptive(x, y, z, slopes, list(weights), words)
        #: The fit of the first measurement.
        self.first = Fit(core, "contacts", unit)

    def fit(self, z: npt.ArrayLike, slopes: npt.ArrayLike | None = None) -> RepeatedHeights:
        """The surface of other heights, in the order of the first ones; slopes (N, 2) where the first contacts had some.

        Raises FitError for columns of another length, numbers that are not finite, and slopes that are missing or have no place.
        """
        if slopes is None:
            return RepeatedHeights(*self._plan.fit(z, None, None))
        import numpy as np

        both = np.asarray(slopes, dtype=float)
        if both.ndim != 2 or both.shape[1] != 2:
            raise ValueError(f"slopes: an array (N, 2) wanted, found {both.shape}")
        return RepeatedHeights(*self._plan.fit(z, both[:, 0], both[:, 1]))
