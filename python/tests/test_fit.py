"""fit: the answers are those of the program, whatever holds the numbers."""

from __future__ import annotations

import json
import os
import pickle
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import Columns, normals

import palpate


def program() -> str | None:
    """The program palpate, where it is built."""
    built = Path(__file__).parents[2] / "target" / "release" / "palpate"
    return os.environ.get("PALPATE_PROGRAM") or (str(built) if built.exists() else shutil.which("palpate"))


def by_program(contacts: Columns, folder: Path, *flags: str) -> dict:
    name = program()
    if name is None:
        pytest.skip("the program palpate is not built")
    file = folder / "contacts.csv"
    head = ",".join(contacts)
    np.savetxt(file, np.column_stack(list(contacts.values())), delimiter=",", header=head, comments="", fmt="%.17g")
    done = subprocess.run([name, "fit", str(file), "--json", *flags], capture_output=True, check=True)
    return json.loads(done.stdout)


def without_clock(document: dict) -> dict:
    return {name: part for name, part in document.items() if name != "seconds"}


CASES = [
    ([], {}),
    (["--degree", "4,2"], {"degree": (4, 2)}),
    (["--weights", "tangent"], {"weights": "tangent"}),
    (["--weights", "1,10,5"], {"weights": (1, 10, 5)}),
    (["--sigma", "0.01,1"], {"sigma": (0.01, 1)}),
    (["--segments", "2", "--smooth", "auto"], {"segments": 2, "smooth": "auto"}),
    (["--domain", "-3,3,-3,3", "--method", "qr"], {"domain": [-3, 3, -3, 3], "method": "qr"}),
    (["--robust", "huber", "--inset", "0.1", "--grid", "5x6"], {"robust": "huber", "inset": 0.1, "grid": (5, 6)}),
    (["--surface", "parametric"], {"surface": "parametric"}),
    (["--grid", "4x4"], {"grid": 4}),
    (["--degree", "2", "--bare"], {"degree": 2, "bare": True}),
]


@pytest.mark.parametrize(("flags", "words"), CASES)
def test_the_answer_is_that_of_the_program(noisy: Columns, tmp_path: Path, flags: list[str], words: dict) -> None:
    there = by_program(noisy, tmp_path, *flags)
    here = palpate.fit(noisy, **words).to_dict()
    assert without_clock(here) == without_clock(there)


@pytest.mark.parametrize(("flags", "words"), [([], {}), (["--degree", "3"], {"degree": 3}), (["--grid", "5x7"], {"grid": (5, 7)})])
def test_the_maps_are_those_of_the_program(noisy: Columns, tmp_path: Path, flags: list[str], words: dict) -> None:
    by_program(noisy, tmp_path, "--out", str(tmp_path / "out"), *flags)
    here, there = palpate.fit(noisy, **words).maps(), np.load(tmp_path / "out" / "maps.npz")
    assert set(here) == set(there.files) and {"u_position", "u_normal_deg", "u_S", "u_R", "u_k1", "u_k2"} < set(here)
    for name, values in here.items():
        np.testing.assert_array_equal(values, there[name])
    known = np.isfinite(here["S"])
    assert known.any() and (here["u_S"][known] > 0).all() and np.isnan(here["u_S"][~known]).all()


def test_what_holds_the_numbers_does_not_matter(ridge: Columns) -> None:
    expected = palpate.fit(ridge, degree=(4, 2))
    x, y, z = (ridge[name] for name in "xyz")
    matrix = np.column_stack(normals(ridge))
    wide = np.zeros((36, 5))
    wide[:, 1], wide[:, 3] = x, z
    unaligned = np.frombuffer(b"-" + z.tobytes(), dtype=np.uint8)[1:].view("f8")
    frozen = y.copy()
    frozen.flags.writeable = False
    assert not wide[:, 1].flags.contiguous and not unaligned.flags.aligned
    others = [
        ((x, y, z), normals(ridge)),
        ((x.tolist(), tuple(y), z), matrix),
        ((wide[:, 1], frozen, wide[:, 3]), np.asfortranarray(matrix)),
        ((x.astype(">f8"), y[::-1][::-1], unaligned), matrix.tolist()),
        ((np.ma.array(x), y, z), matrix[:, ::-1][:, ::-1]),
    ]
    for (a, b, c), n in others:
        assert palpate.fit(a, b, c, normals=n, degree=(4, 2)) == expected


def test_tables_and_labelled_arrays_are_taken(ridge: Columns) -> None:
    pandas, xarray = pytest.importorskip("pandas"), pytest.importorskip("xarray")
    assert palpate.fit(pandas.DataFrame(ridge), degree=3) == palpate.fit(ridge, degree=3)
    x, y = np.linspace(0, 1, 9), np.linspace(0, 2, 7)
    z = x[:, None] ** 2 + 0 * y
    array = xarray.DataArray(z.T, coords={"y": y, "x": x}, dims=("y", "x"))
    assert palpate.fit(array, degree=2) == palpate.fit(x, y, z, degree=2)


def test_single_precision_and_whole_numbers_are_converted(ridge: Columns) -> None:
    single = {name: column.astype("f4") for name, column in ridge.items()}
    double = {name: column.astype("f4").astype("f8") for name, column in ridge.items()}
    assert palpate.fit(single, degree=2) == palpate.fit(double, degree=2)
    whole = np.array([0, 0, 0, 1, 1, 1, 2, 2, 2], dtype="i2"), np.array([0, 1, 2] * 3, dtype="u1")
    assert palpate.fit(*whole, np.zeros(9, dtype=bool), degree=1).shape.class_name == "plane"


def test_a_grid_is_no_pile_of_contacts() -> None:
    x, y = np.linspace(-1, 1, 20), np.linspace(-1, 1, 15)
    z = 0.3 * x[:, None] ** 2 + 0.3 * y**2
    found = palpate.fit(x, y, z, weights="equal", segments=(2, 3), method="kronecker")
    assert found.certificate.method == "kronecker" and found.shape.class_name == "cup"
    z[3, 4] = np.nan
    assert palpate.fit(x, y, z, weights="equal").contacts == 299


def test_results_survive_pickling_saving_and_tables(ridge: Columns, tmp_path: Path) -> None:
    found = palpate.fit(ridge, degree=(4, 2))
    loaded = pickle.loads(pickle.dumps(found))
    assert loaded == found and str(loaded) == str(found) and loaded.surface == found.surface
    found.save(tmp_path / "surface.json")
    assert palpate.Fit.load(tmp_path / "surface.json") == found
    assert pickle.loads(pickle.dumps(found.surface)) == found.surface
    assert "ridge" in found._repr_html_() and "ridge" in repr(found) and "ridge" in str(found)
    pytest.importorskip("pandas"), pytest.importorskip("xarray")
    assert palpate.Fit.from_pandas(found.to_pandas()) == found
    dataset = found.to_xarray((5, 6))
    assert palpate.Fit.from_xarray(dataset) == found
    assert dataset["S"].shape == (5, 6) and abs(float(dataset["S"][2, 3]) - 0.5) < 0.01


def test_a_parametric_surface_is_evaluated_in_space() -> None:
    contacts = palpate.simulate("around-torus")
    found = palpate.fit(contacts, surface="parametric", closed="u,v", segments=6)
    u0, u1, v0, v1 = found.surface.domain
    assert found.surface([u0, u1], [v0, v1]).shape == (2, 2, 3)
    assert found.surface.ev(u0, v0).shape == (3,)
    again = pickle.loads(pickle.dumps(found))
    assert again.surface == found.surface and again.surface.closed == (True, True)


def test_no_second_copy_of_a_large_input() -> None:
    import resource

    g = 2_000_000
    random = np.random.default_rng(1)
    table = random.uniform(-1, 1, (g, 4))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(palpate.FitError):
        # refused by the last number, after all columns were taken: three columns of 16 MB, and no more
        table[-1, 2] = np.nan
        palpate.fit(table[:, 0], table[:, 1], table[:, 2], degree=2)
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    assert grown < 3 * 16 + 8, f"{grown:.0f} MB"


def test_recognition_names_what_it_chose(noisy: Columns) -> None:
    found = palpate.fit(noisy)
    assert found.chosen is not None and found.chosen["hypothesis"] == "cylinder"
    assert found.shape.class_name == "ridge" and abs(found.shape.radius - 6) < 0.3
    assert found.shape.class_by_area == {}
    z = found.surface(0.0, 0.0)[0, 0]
    assert abs(z) < 0.05




def test_the_axis_of_a_ridge_runs_along_it(noisy: Columns) -> None:
    found = palpate.fit(noisy["x"], noisy["y"], noisy["z"], normals=normals(noisy)).shape
    assert found.axis_deg is not None and abs(found.axis_deg - 90) < 5


def test_a_unit_is_said_and_nothing_is_converted(noisy: Columns) -> None:
    columns = (noisy["x"], noisy["y"], noisy["z"])
    bare, named = (palpate.fit(*columns, normals=normals(noisy), unit=unit) for unit in (None, "mm"))
    assert (bare.unit, named.unit) == (None, "mm") and named.to_dict()["unit"] == "mm"
    assert bare.shape == named.shape and "mm" in str(named) and "mm" not in str(bare)
    assert pickle.loads(pickle.dumps(named)).unit == "mm"
    for wrong in ("", "a b", "<b>"):
        with pytest.raises(ValueError, match="unit"):
            palpate.fit(*columns, normals=normals(noisy), unit=wrong)
    with pytest.raises(TypeError):
        palpate.fit(*columns, unit=3)


def test_shapes_side_by_side_have_their_shares() -> None:
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-6, 6, 12), np.linspace(-6, 6, 12)))
    bump = 3 * np.exp(-(x**2 + y**2) / 50)
    normal = np.column_stack([x * bump / 25, y * bump / 25, np.ones_like(x)])
    shape = palpate.fit(x, y, bump, normals=normal).shape
    assert shape.class_name is None and len(shape.class_by_area) > 1
    assert all(0.1 <= share <= 1 for share in shape.class_by_area.values())


def test_numbers_that_decide_about_an_adaptive_surface() -> None:
    random = np.random.default_rng(11)
    x, y = random.uniform(-1, 1, (2, 20_000))
    z = 0.05 * np.exp(-((x - 0.1) ** 2 + y**2) / 0.003) + 0.002 * random.standard_normal(20_000)
    halvings = [
        palpate.fit(x, y, z, adaptive=adaptive).to_dict()["fit"]["adaptive"]["halvings"]
        for adaptive in (True, {"deepest_level": 2}, {"last_halving": True, "false_discovery_rate": 0.001})
    ]
    assert halvings[1] == 2 and halvings[2] == halvings[0] + 1 > 3
    with pytest.raises(palpate.FitError, match="no such option"):
        palpate.fit(x, y, z, adaptive={"no_such_thing": 1})
    with pytest.raises(TypeError, match="names and numbers"):
        palpate.fit(x, y, z, adaptive={"deepest_level": "two"})
