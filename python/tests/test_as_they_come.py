"""What holds contacts, as people hand it over: arrays, tables of four libraries, files, clouds; what is refused says what is wanted."""

from __future__ import annotations

import sys
import types
from pathlib import Path

import numpy as np
import pytest
from conftest import Columns, normals

import palpate


def answer(*given: object, **words: object) -> dict:
    document = palpate.fit(*given, **words).to_dict()
    return {name: part for name, part in document.items() if name != "seconds"}


@pytest.fixture
def expected(noisy: Columns) -> dict:
    return answer(noisy["x"], noisy["y"], noisy["z"], normals=normals(noisy))


def test_an_array_holds_places_and_perhaps_normals(noisy: Columns, expected: dict) -> None:
    rows = np.column_stack(list(noisy.values()))
    assert answer(rows) == expected
    assert answer(rows.tolist()) == expected
    assert answer(rows[:, :3]) == answer(noisy["x"], noisy["y"], noisy["z"])
    # what stands beside the array goes before its columns
    assert answer(rows[:, :3], normals=rows[:, 3:]) == expected
    for wrong in (rows[:, :4], rows[:, 0], np.zeros((2, 3, 3)), None, [["a", "b", "c"]]):
        with pytest.raises(TypeError, match=r"\(N, 3\) or \(N, 6\)"):
            palpate.fit(wrong)


def test_tables_of_any_library_are_read_by_names(noisy: Columns, expected: dict) -> None:
    pandas = pytest.importorskip("pandas")
    assert answer(pandas.DataFrame(noisy)) == expected
    theirs = dict(zip(("px", "py", "pz", "normal_x", "normal_y", "normal_z"), noisy.values()))
    assert answer(pandas.DataFrame(theirs)) == expected
    assert answer({f"pose.position.{name}": noisy[name] for name in "xyz"}) == answer(*(noisy[name] for name in "xyz"))
    with pytest.raises(ValueError, match="columns x, y and z; z is missing"):
        palpate.fit({"x": [1.0], "y": [2.0], "height_above": [3.0]})


def test_polars_and_pyarrow_need_nothing_of_pandas(noisy: Columns, expected: dict) -> None:
    """The interfaces of both, and the libraries themselves where they are installed."""

    class Series:
        def __init__(self, values: np.ndarray) -> None:
            self.values = values

        def to_numpy(self) -> np.ndarray:
            return self.values

        def __array__(self, dtype: object = None, copy: object = None) -> np.ndarray:
            return self.values

    class Polars:
        columns = list(noisy)

        def get_column(self, name: str) -> Series:
            return Series(noisy[name])

    class Arrow:
        column_names = list(noisy)

        def column(self, name: str) -> Series:
            return Series(noisy[name])

    assert answer(Polars()) == expected
    assert answer(Arrow()) == expected
    for name, made in (("polars", "DataFrame"), ("pyarrow", "table")):
        if name in sys.modules or _there(name):
            assert answer(getattr(__import__(name), made)(noisy)) == expected


def _there(name: str) -> bool:
    import importlib.util

    return importlib.util.find_spec(name) is not None


def test_clouds_have_points_and_normals(noisy: Columns, expected: dict) -> None:
    rows = np.column_stack(list(noisy.values()))
    points, normal = rows[:, :3], rows[:, 3:]
    places = answer(*points.T)
    assert answer(types.SimpleNamespace(points=points, normals=normal)) == expected
    # Open3D has an empty list where there are none
    assert answer(types.SimpleNamespace(points=points, normals=np.empty((0, 3)))) == places
    assert answer(types.SimpleNamespace(vertices=points, vertex_normals=normal)) == expected
    assert answer(types.SimpleNamespace(vertices=points)) == places
    with pytest.raises(ValueError, match=r"\(N, 3\) is needed"):
        palpate.fit(types.SimpleNamespace(points=points[:, :2], normals=[]))


def test_files_are_read_as_the_program_reads_them(noisy: Columns, expected: dict, tmp_path: Path) -> None:
    table = np.column_stack(list(noisy.values()))
    np.savetxt(tmp_path / "a.csv", table, delimiter=";", header="x_mm;y_mm;z_mm;nx;ny;nz", comments="", fmt="%.17g")
    np.savez(tmp_path / "a.npz", **noisy)
    np.save(tmp_path / "a.npy", table)
    for name in ("a.csv", "a.npz", "a.npy"):
        assert answer(tmp_path / name) == expected, name
        assert answer(str(tmp_path / name)) == expected, name
    axis = np.linspace(-1, 1, 5)
    z = 0.1 * axis[:, None] ** 2 + 0 * axis
    np.savez(tmp_path / "grid.npz", x=axis, y=axis, z=z)
    assert answer(tmp_path / "grid.npz", degree=2) == answer(axis, axis, z, degree=2)
    with pytest.raises(FileNotFoundError):
        palpate.fit(tmp_path / "none.csv")
    (tmp_path / "b.csv").write_text("x,y,z\n1,2,a\n")
    with pytest.raises(ValueError, match="line 2"):
        palpate.fit(tmp_path / "b.csv")


def test_a_dataset_is_a_grid_or_columns(noisy: Columns) -> None:
    xarray = pytest.importorskip("xarray")
    axis = np.linspace(-1, 1, 5)
    z = 0.1 * axis[:, None] ** 2 + 0 * axis
    grid = xarray.Dataset({"z": (("x", "y"), z)}, coords={"x": axis, "y": axis})
    assert answer(grid, degree=2) == answer(axis, axis, z, degree=2) == answer(grid.transpose("y", "x"), degree=2)
    touches = xarray.Dataset({name: ("touch", values) for name, values in noisy.items()})
    assert answer(touches) == answer(noisy)


def test_the_place_of_a_shape_and_what_is_left_over() -> None:
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-4, 4, 7), np.linspace(-4, 4, 7)))
    off = 0.01 * np.sin(np.arange(49) * 2.3)
    up = np.sqrt(100 - x**2 - y**2)
    ball = palpate.fit(np.column_stack([x + 3, y, up + off, x, y, up]))
    assert ball.shape.class_name == "cap" and ball.shape.axis_point is None
    assert np.allclose(ball.shape.centre, [3, 0, 0], atol=0.1)
    assert np.abs(ball.residuals).max() < 0.03 and np.corrcoef(ball.residuals, off)[0, 1] > 0.8
    up = np.sqrt(100 - x**2)
    bar = palpate.fit(np.column_stack([x + 3, y, up + off, x, 0 * y, up]))
    assert bar.shape.class_name == "ridge" and bar.shape.centre is None
    assert np.allclose(np.array(bar.shape.axis_point)[[0, 2]], [3, 0], atol=0.1)
    field = palpate.fit(x, y, up, degree=3)
    assert np.allclose(field.residuals, up - field.surface.ev(x, y), atol=1e-12)
    with pytest.raises(palpate.FitError, match="no residuals"):
        palpate.Fit.from_dict(field.to_dict()).residuals


def test_parts_are_those_of_the_program() -> None:
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(-5, 5, 9), np.linspace(-5, 5, 9)))
    off = 0.005 * np.sin(np.arange(81) * 2.3)
    top = np.column_stack([u, v, 6 + off, 0 * u, 0 * u, 0 * u + 1])
    side = np.column_stack([6 + off, v, u, 0 * u + 1, 0 * u, 0 * u])
    found = palpate.parts(np.vstack([top, side]))
    assert len(found) == 2 and found.labels.shape == (162,)
    assert set(found.labels[:81]) != set(found.labels[81:]) and "plane" in repr(found)
    with pytest.raises(palpate.PalpateError):
        palpate.parts(np.zeros((1, 3)))


def test_a_stream_starts_anew() -> None:
    stream = palpate.TouchStream([-1, 1, -1, 1], sigma=(0.1, 0.1, 0.1))
    touches = [(a, b, 0.1 * a * a) for a in (-1.0, 0.0, 1.0) for b in (-1.0, 0.0, 1.0)]
    for a, b, z in touches:
        stream.push(a, b, z, (-0.2 * a, 0.0, 1.0))
    first = stream.shape().curvedness
    stream.clear()
    assert len(stream) == 0
    for a, b, z in touches:
        stream.push(a, b, z, (-0.2 * a, 0.0, 1.0))
    assert stream.shape().curvedness == first
