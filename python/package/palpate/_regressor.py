"""A surface as scikit-learn's regressors are: fit(X, y), predict(X, return_std=True).

    y = S(x0, x1) + e       S a tensor-product B-spline, by least squares
    var S(x) = s^2 b(x)' (B'B)^-1 b(x),   s^2 = |y - B c|^2 / (n - rank)

scikit-learn is not needed; where it is installed, the regressor is one of its estimators.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ._fit import fit
from ._native import Surface

try:
    from sklearn.base import BaseEstimator, RegressorMixin
    from sklearn.exceptions import NotFittedError
    from sklearn.utils.validation import validate_data
except ImportError:
    NotFittedError = ValueError

    def validate_data(estimator: Any, X: Any, y: Any = None, **words: Any) -> Any:
        """X as numbers of two dimensions, and y as one for each of its rows."""
        numbers = np.asarray(X, dtype=float)
        if numbers.ndim != 2:
            raise ValueError(f"X has shape {numbers.shape}; two dimensions are wanted, (samples, features)")
        if not np.isfinite(numbers).all():
            raise ValueError("X holds NaN or infinity")
        if y is None:
            return numbers
        heights = np.asarray(y, dtype=float).squeeze()
        if heights.shape != (len(numbers),):
            raise ValueError(f"y has shape {heights.shape}; one number for each of the {len(numbers)} rows of X is wanted")
        if not np.isfinite(heights).all():
            raise ValueError("y holds NaN or infinity")
        return numbers, heights

    class BaseEstimator:  # type: ignore[no-redef]
        """What scikit-learn's tools ask of an estimator."""

        def get_params(self, deep: bool = True) -> dict[str, Any]:
            """The arguments that it was made with."""
            return {name: getattr(self, name) for name in ("degree", "segments", "domain", "columns")}

        def set_params(self, **params: Any) -> Any:
            """Changes arguments by name; gives the estimator back."""
            for name, value in params.items():
                if name not in self.get_params():
                    raise ValueError(f"{name}: there is no such parameter; there are {', '.join(self.get_params())}")
                setattr(self, name, value)
            return self

    class RegressorMixin:  # type: ignore[no-redef]
        """The score of a regressor."""

        def score(self, X: npt.ArrayLike, y: npt.ArrayLike, sample_weight: npt.ArrayLike | None = None) -> float:
            """R^2 of the prediction."""
            y = np.asarray(y, dtype=float)
            weights = np.ones_like(y) if sample_weight is None else np.asarray(sample_weight, dtype=float)
            off = y - self.predict(X)  # type: ignore[attr-defined]
            spread = float(weights @ (y - np.average(y, weights=weights)) ** 2)
            return 1.0 - float(weights @ off**2) / spread if spread > 0 else 0.0


__all__ = ["SurfaceRegressor"]


class SurfaceRegressor(RegressorMixin, BaseEstimator):  # type: ignore[misc]
    """A height over two features: degree, segments and domain are those of `fit`. X has two columns, or more of which `columns`
    says the two.

    >>> import numpy as np
    >>> from palpate import SurfaceRegressor
    >>> X = np.array([[i, j] for i in range(5) for j in range(5)], dtype=float)
    >>> y = X[:, 0] ** 2 - X[:, 1]
    >>> model = SurfaceRegressor(degree=2).fit(X, y)
    >>> bool(np.allclose(model.predict([[1.5, 2.0]]), [0.25]))
    True
    """

    def __init__(
        self,
        degree: int | tuple[int, int] = 2,
        segments: int | tuple[int, int] = 1,
        domain: tuple[float, float, float, float] | None = None,
        columns: tuple[int, int] | None = None,
    ) -> None:
        self.degree = degree
        self.segments = segments
        self.domain = domain
        self.columns = columns

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        # what depends on other features than the two it does not follow
        tags.regressor_tags.poor_score = True
        return tags

    def fit(self, X: npt.ArrayLike, y: npt.ArrayLike) -> SurfaceRegressor:
        """Fits heights y (n,) over X (n, 2)."""
        if y is None:
            raise ValueError("this SurfaceRegressor requires y to be passed, but the target y is None")
        checked, heights = validate_data(self, X, y, dtype=np.float64, y_numeric=True, ensure_min_samples=2)
        places = self._places(checked)
        words: dict[str, Any] = {"degree": self.degree, "segments": self.segments, "frame": "keep", "bare": True}
        if self.domain is not None:
            words["domain"] = self.domain
        self.fit_ = fit(places[:, 0], places[:, 1], heights, **words)
        surface = self.fit_.surface
        assert isinstance(surface, Surface)
        self.surface_ = surface
        self.n_features_in_ = checked.shape[1]
        basis = self._basis(places)
        # as the pseudo-inverse has it, so that what the data leave open adds nothing
        values, self._directions = _spectrum(basis)
        self._inverse_roots = values
        rank, left = len(values), heights - surface.ev(places[:, 0], places[:, 1])
        free = len(heights) - rank
        self.noise_sd_ = float(np.sqrt(left @ left / free)) if free > 0 else float("nan")
        return self

    def predict(self, X: npt.ArrayLike, return_std: bool = False) -> Any:
        """Heights at X (m, 2); with return_std also their standard uncertainties, without the noise of one more measurement.

        The uncertainties are NaN where as many numbers were fitted as there were heights.
        """
        if not hasattr(self, "surface_"):
            raise NotFittedError("this SurfaceRegressor is not fitted yet: call fit(X, y) first")
        places = self._places(validate_data(self, X, reset=False, dtype=np.float64))
        heights = self.surface_.ev(places[:, 0], places[:, 1])
        if not return_std:
            return heights
        reach = self._basis(places) @ self._directions * self._inverse_roots
        return heights, self.noise_sd_ * np.sqrt(np.sum(reach**2, axis=1))

    def _places(self, X: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """The two columns that heights are over."""
        wanted = (0, 1) if self.columns is None else tuple(self.columns)
        enough = len(wanted) == 2 and max(wanted) < X.shape[1] and (self.columns is not None or X.shape[1] == 2)
        if not enough:
            raise ValueError(
                f"X has {X.shape[1]} feature(s), n_features = {X.shape[1]}: heights are over two; columns=(i, j) says which of more"
            )
        return np.ascontiguousarray(X[:, list(wanted)])

    def _basis(self, places: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Every basis function at every place: a surface with one coefficient that is not zero is one."""
        (tx, ty), (kx, ky) = self.surface_.t, self.surface_.k
        n, m = len(tx) - kx - 1, len(ty) - ky - 1
        columns = np.empty((len(places), n * m))
        for k in range(n * m):
            unit = np.zeros((n, m))
            unit.flat[k] = 1.0
            columns[:, k] = Surface((tx, ty), unit, (kx, ky)).ev(places[:, 0], places[:, 1])
        return columns


def _spectrum(basis: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """1/s and the right singular vectors of the basis, of those s that are not rounding."""
    _, values, rows = np.linalg.svd(basis, full_matrices=False)
    kept = values > max(basis.shape) * np.finfo(float).eps * values[0]
    return 1.0 / values[kept], rows[kept].T
