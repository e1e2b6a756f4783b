"""The regressor predicts and says how far to trust it; the picture is drawn where matplotlib is there."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import Columns

import palpate
from palpate import SurfaceRegressor


def places(n: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-1, 1, (n, 2))


def height(X: np.ndarray) -> np.ndarray:
    return 0.3 * X[:, 0] ** 2 - 0.2 * X[:, 0] * X[:, 1] + 0.1


def test_heights_are_those_of_the_fit() -> None:
    X = places(60, 1)
    model = SurfaceRegressor(degree=2).fit(X, height(X))
    assert np.allclose(model.predict(places(9, 2)), height(places(9, 2)), atol=1e-9)
    assert model.score(X, height(X)) > 1 - 1e-9
    assert np.allclose(model.predict(X), palpate.fit(X[:, 0], X[:, 1], height(X), degree=2).surface.ev(*X.T))


def test_the_standard_uncertainty_is_the_spread_over_repetitions() -> None:
    """600 repetitions know an sd to 2.9 %: five sigma; noise_sd_ has 51 degrees of freedom."""
    X, at, random = places(60, 1), places(5, 2), np.random.default_rng(3)
    found, said = [], []
    for _ in range(600):
        model = SurfaceRegressor(degree=2, domain=(-1, 1, -1, 1)).fit(X, height(X) + 0.05 * random.standard_normal(60))
        mean, std = model.predict(at, return_std=True)
        found.append(mean)
        said.append(std)
    assert np.allclose(np.std(found, axis=0) / np.mean(said, axis=0), 1.0, atol=0.15)
    # next to nothing is known outside what was touched
    far = SurfaceRegressor(degree=2).fit(X, height(X) + 0.05 * random.standard_normal(60))
    inside, outside = far.predict([[0, 0], [4, 4]], return_std=True)[1]
    assert outside > 10 * inside


def test_it_has_the_habits_of_an_estimator() -> None:
    model = SurfaceRegressor(degree=3, segments=2)
    assert model.get_params() == {"degree": 3, "segments": 2, "domain": None, "columns": None}
    assert model.set_params(degree=2).degree == 2
    with pytest.raises(ValueError, match="colour"):
        model.set_params(colour="red")
    with pytest.raises(ValueError, match="not fitted"):
        model.predict([[0, 0]])
    wide = np.column_stack([places(60, 1)[:, 1], np.ones(60), places(60, 1)[:, 0]])
    picked = SurfaceRegressor(columns=(2, 0)).fit(wide, height(places(60, 1)))
    assert np.allclose(picked.predict(wide), height(places(60, 1)))
    for X, y in ((wide, np.ones(60)), ([[0, np.nan], [1, 1]], [1, 1]), ([[0, 0], [1, 1]], [1, 2, 3])):
        with pytest.raises(ValueError, match="X|y|NaN|samples"):
            model.fit(X, y)
    base = pytest.importorskip("sklearn.base")
    again = base.clone(SurfaceRegressor(degree=3))
    assert again.degree == 3
    selection = pytest.importorskip("sklearn.model_selection")
    X = places(80, 4)
    assert selection.cross_val_score(SurfaceRegressor(), X, height(X)).min() > 0.99


def test_the_checks_of_scikit_learn_pass() -> None:
    """Of an estimator that takes two of whatever columns the checks make."""
    checks = pytest.importorskip("sklearn.utils.estimator_checks")
    found = checks.check_estimator(SurfaceRegressor(degree=1, columns=(0, 1)), on_fail=None, on_skip=None)
    failed = {check["check_name"]: str(check["exception"]) for check in found if check["status"] == "failed"}
    assert not failed and len(found) > 40


def test_a_fit_is_drawn(noisy: Columns) -> None:
    found = palpate.fit(noisy)
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    for fit in (found, palpate.fit(noisy, degree=2), palpate.fit(noisy, surface="parametric")):
        for quantity in ("R", "S", "k1", "z"):
            axes = fit.plot(grid=9, quantity=quantity)
            assert axes.get_title() == (fit.shape.class_name or "no one class") and len(axes.collections) == 1
            pyplot.close(axes.figure)
    with pytest.raises(ValueError, match="quantity"):
        found.plot(quantity="colour")
