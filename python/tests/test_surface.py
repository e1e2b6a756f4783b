"""Surface has SciPy's habits, and SciPy's digits."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import Columns

import palpate

interpolate = pytest.importorskip("scipy.interpolate")


@pytest.fixture
def surface(ridge: Columns) -> palpate.Surface:
    found = palpate.fit(ridge, degree=(4, 3), segments=(3, 2), smooth=1e-6, weights="equal").surface
    assert isinstance(found, palpate.Surface)
    return found


@pytest.mark.parametrize(("dx", "dy"), [(0, 0), (1, 0), (0, 1), (2, 1), (3, 2)])
def test_bisplev_and_ndbspline_agree(surface: palpate.Surface, dx: int, dy: int) -> None:
    x, y = np.linspace(-2.5, 2.5, 31), np.linspace(-2.5, 2.5, 17)
    there = interpolate.bisplev(x, y, surface.tck, dx, dy)
    np.testing.assert_allclose(surface(x, y, dx, dy), there, rtol=1e-11, atol=1e-11)
    places = np.random.default_rng(2).uniform(-2.5, 2.5, (500, 2))
    spline = interpolate.NdBSpline(surface.t, surface.c, surface.k)
    there = spline(places, nu=(dx, dy))
    np.testing.assert_allclose(surface.ev(*places.T, dx, dy), there, rtol=1e-11, atol=1e-11)


def test_back_from_scipy() -> None:
    x, y = np.linspace(0, 1, 12), np.linspace(0, 2, 15)
    there = interpolate.RectBivariateSpline(x, y, np.sin(3 * x[:, None]) * np.cos(y), kx=3, ky=4)
    here = palpate.Surface(there.tck[:2], there.tck[2], there.degrees)
    np.testing.assert_allclose(here(x, y), there(x, y), atol=1e-13)
    np.testing.assert_allclose(here(x, y, grid=True, dx=1), there(x, y, dx=1), atol=1e-11)
    np.testing.assert_allclose(here(x, x, grid=False), there(x, x, grid=False), atol=1e-13)


def test_shapes_broadcast_and_layouts_do_not_matter(surface: palpate.Surface) -> None:
    x, y = np.linspace(-1, 1, 5)[:, None], np.linspace(-1, 1, 4)
    assert surface.ev(x, y).shape == (5, 4) and surface.ev(0.0, 0.0).shape == ()
    np.testing.assert_allclose(surface.ev(x, y), surface(x.ravel(), y), atol=1e-14)
    many = np.linspace(-2, 2, 10_001)
    np.testing.assert_array_equal(surface.ev(many[::2], many[::2]), surface.ev(many[::2].copy(), many[::2].copy()))
    assert np.isnan(surface.ev([np.nan, np.inf], [0.0, 0.0])).all()
    assert surface(0.0, 0.0).shape == (1, 1) and surface([], []).shape == (0, 0)


def test_maps_are_those_of_the_fit(ridge: Columns) -> None:
    found = palpate.fit(ridge, degree=(4, 2))
    maps = found.maps()
    assert maps["S"].shape == (8, 8)
    np.testing.assert_allclose(np.mean(maps["S"]), found.shape.S.mean, rtol=1e-9)
    np.testing.assert_allclose(np.mean(maps["k1"]), found.shape.k1.mean, atol=1e-12)


@pytest.mark.parametrize(
    ("call", "kind", "words"),
    [
        (lambda s: s([0.0], ["a"]), TypeError, "y: "),
        (lambda s: s(np.zeros((2, 2)), 0.0), ValueError, "x has shape"),
        (lambda s: s(0.0, 0.0, dx=-1), ValueError, "dx is -1"),
        (lambda s: s.ev(np.zeros(3), np.zeros(4)), ValueError, "do not broadcast"),
        (lambda s: s(np.zeros(10**5), np.zeros(10**5)), ValueError, "more than"),
        (lambda s: palpate.Surface(s.t, s.c[:3], s.k), ValueError, "c has shape"),
        (lambda s: palpate.Surface((s.t[0][::-1], s.t[1]), s.c, s.k), palpate.SurfaceError, "knots in x"),
        (lambda s: palpate.Surface(s.t, s.c * np.nan, s.k), palpate.SurfaceError, "finite"),
        (lambda s: palpate.Surface(3, s.c, s.k), ValueError, "t: "),
        (lambda s: s.shape([np.nan], [0.0]), ValueError, "x: finite"),
    ],
)
def test_what_is_wrong_is_named(surface: palpate.Surface, call: object, kind: type[Exception], words: str) -> None:
    with pytest.raises(kind, match=words):
        call(surface)  # type: ignore[operator]


def test_beyond_the_degree_derivatives_vanish(surface: palpate.Surface) -> None:
    assert not surface(0.1, 0.1, dx=9).any() and not surface(0.1, 0.1, dy=10**6).any()


def test_the_shape_of_a_surface_in_space_is_that_of_the_height_field_it_is() -> None:
    x, y = np.meshgrid(np.linspace(-1.0, 1.0, 8), np.linspace(-1.0, 1.0, 8), indexing="ij")
    field = palpate.fit(x.ravel(), y.ravel(), (0.3 * x**2 - 0.2 * y**2).ravel(), degree=2, segments=1).surface
    x0, x1, y0, y1 = field.domain
    # x and y as splines of degree 2 over the same knots: their Greville abscissae
    u, v = np.array([x0, (x0 + x1) / 2, x1]), np.array([y0, (y0 + y1) / 2, y1])
    points = np.stack([*np.meshgrid(u, v, indexing="ij"), np.asarray(field.c)], axis=-1)
    inside = np.linspace(x0, x1, 5)[1:-1], np.linspace(y0, y1, 6)[1:-1]
    ours = palpate.ParametricSurface(field.t, points, field.k).shape(*inside)
    theirs = field.shape(*inside)
    for name in ("k1", "k2", "S", "R"):
        assert ours[name].shape == (3, 4)
        np.testing.assert_allclose(ours[name], theirs[name], rtol=1e-12, atol=1e-13)
    with pytest.raises(ValueError, match="u: finite"):
        palpate.ParametricSurface(field.t, points, field.k).shape([np.nan], [0.0])
