"""The same places measured again."""

import numpy as np
import pytest

import palpate


def measured(noise: float = 0.002) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    draw = np.random.default_rng(5)
    x, y = draw.uniform(-1, 1, (2, 6000))
    return x, y, 0.1 * np.exp(-((x - 0.3) ** 2 + y**2) / 0.05) + noise * draw.standard_normal(6000)


def test_the_first_heights_again_are_the_first_fit() -> None:
    x, y, z = measured()
    plan = palpate.AdaptivePlan(x, y, z)
    own = palpate.fit(x, y, z, adaptive=True)
    assert plan.first.shape == own.shape
    again = plan.fit(z)
    places = np.linspace(-0.9, 0.9, 7)
    assert np.allclose(again.surface(places, places), own.surface(places, places), atol=1e-10)
    assert abs(again.noise / 0.002 - 1) < 0.1


def test_other_heights_are_fitted_over_the_same_cells_and_faults_are_named() -> None:
    x, y, z = measured()
    plan = palpate.AdaptivePlan(x, y, z)
    twice = plan.fit(2 * z)
    places = np.linspace(-0.9, 0.9, 7)
    assert np.allclose(twice.surface(places, places), 2 * plan.fit(z).surface(places, places), atol=1e-10)
    with pytest.raises(palpate.FitError):
        plan.fit(z[1:])
    with pytest.raises(palpate.FitError):
        plan.fit(z, np.zeros((6000, 2)))
    with pytest.raises(ValueError, match="slopes"):
        plan.fit(z, z)
    with pytest.raises(ValueError, match="normals"):
        palpate.AdaptivePlan(np.column_stack([x, y, z, 0 * x, 0 * y, 1 + 0 * x]))
