"""One fit: contacts or a grid in, surface and shape out.

    contacts  ->  surface z = S(x, y) or Q(u, v)  ->  k1 >= k2, shape index S, curvedness R, class, how far to trust them

Lengths are in the input's unit, curvatures in its inverse, angles in degrees; what is undefined is None.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

import numpy as np
import numpy.typing as npt

from . import _native
from ._columns import Columns, columns, is_grid
from ._errors import FitError, in_python
from ._native import ParametricSurface, Surface
from ._shape import Certificate, Shape
from ._tables import html_table, number

if TYPE_CHECKING:
    import pandas
    import xarray

    from ._diff import FitDiff

__all__ = ["Fit", "fit"]

Pair = Union[int, tuple[int, int]]
Numbers = npt.ArrayLike


class Fit:
    """A fitted patch.

    What is asked for is computed at the first access and kept. Fits pickle, and are saved as the same JSON that
    `palpate fit --save` writes.
    """

    __slots__ = ("_core", "_document", "_name", "_surface", "_table", "_unit")

    def __init__(self, core: _native.FitCore | None, name: str = "contacts", unit: str | None = None) -> None:
        self._core = core
        self._unit = unit
        self._name = name
        self._document: dict[str, Any] | None = None
        self._table = ""
        self._surface: Surface | ParametricSurface | None = None

    @classmethod
    def from_dict(cls, document: dict[str, Any], name: str = "contacts") -> Fit:
        """A fit from its document, as `to_dict` gives it."""
        if not isinstance(document, dict) or document.get("schema") != "palpate.fit/1":
            raise FitError("this is no document of a fit: its schema is not palpate.fit/1", "Schema")
        found = cls(None, name)
        found._document = document
        found._unit = document.get("unit")
        return found

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Fit:
        """A fit saved by `save`, or by `palpate fit --save`."""
        return cls.from_dict(json.loads(Path(path).read_text(encoding="utf-8")), Path(path).name)

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the document as JSON, with support and uncertainty at every point; `palpate show`, `diff` and `load` read it."""
        Path(path).write_bytes(self._saved())

    def _saved(self) -> bytes:
        """The bytes of the file that `palpate fit --save` writes."""
        return json.dumps(self.to_dict()).encode() if self._core is None else self._core.saved(self._unit)

    def to_dict(self) -> dict[str, Any]:
        """The document palpate.fit/1: what `palpate fit --json` prints."""
        if self._document is None:
            assert self._core is not None
            text, self._table = self._core.document(self._name, self._unit)
            self._document = json.loads(text)
        return self._document

    @property
    def shape(self) -> Shape:
        """S, R, class, radius and their uncertainties."""
        return Shape._of(self.to_dict()["shape"])

    @property
    def certificate(self) -> Certificate:
        """How far to trust the arithmetic."""
        return Certificate._of(self.to_dict()["fit"])

    @property
    def notes(self) -> list[str]:
        """What the user should know, in whole sentences."""
        return [in_python(note) for note in self.to_dict()["fit"]["notes"]]

    @property
    def unit(self) -> str | None:
        """The unit of the lengths, where it was named."""
        return self._unit

    @property
    def contacts(self) -> int:
        """Number of contacts."""
        return int(self.to_dict()["contacts"])

    @property
    def chosen(self) -> dict[str, Any] | None:
        """What was chosen and why, where no model was named: surface, why, hypothesis, tried."""
        found: dict[str, Any] | None = self.to_dict()["fit"].get("chosen")
        return found

    @property
    def rms(self) -> dict[str, float]:
        """Root mean square residuals: z in input units, zx, zy, normal_deg."""
        return {name: rms for name, rms in self.to_dict()["fit"]["rms"].items() if rms is not None}

    @property
    def residuals(self) -> npt.NDArray[np.float64]:
        """How far each contact lies off the surface, input units: along its normal where the contacts were recognised, positive on
        the free side; along z of a height field.

        >>> import palpate
        >>> palpate.fit([0, 0, 0, 1, 1, 1, 2, 2, 2], [0, 1, 2] * 3, [0, 1, 2] * 3, degree=1).residuals.round(12).any()
        np.False_
        """
        if self._core is None:
            raise FitError("a fit from a document knows no contacts any longer, so that it has no residuals", "Residuals")
        found = self._core.residuals()
        if found is None:
            raise FitError("residuals are those of contacts on a height field or of what was recognised", "Residuals")
        return found

    def plot(self, ax: Any = None, *, grid: Pair = 40, quantity: str = "R") -> Any:
        """Draws the surface in space, coloured by "R", "S", "k1", "k2" or "z", with matplotlib; gives the axes back.

        ax: axes of projection "3d" to draw into; new ones without. Raises ImportError where there is no matplotlib.
        """
        from ._plot import plot

        return plot(self, ax, grid, quantity)

    @property
    def surface(self) -> Surface | ParametricSurface:
        """The surface: fit.surface(x, y, dx=1) evaluates it.

        >>> import palpate
        >>> fit = palpate.fit([0, 0, 0, 1, 1, 1, 2, 2, 2], [0, 1, 2] * 3, [0, 1, 2] * 3, degree=1)
        >>> fit.surface(1.5, [0.5, 1.5]).round(12)
        array([[0.5, 1.5]])
        """
        if self._surface is None:
            if self._core is not None:
                self._surface = self._core.surface()
            else:
                self._surface = _saved_surface(self.to_dict())
        return self._surface

    def maps(self, grid: Pair | None = None) -> dict[str, npt.NDArray[np.float64]]:
        """z, k1, k2, S, R over the surface: axes x (n,), y (m,) and maps (n, m), as `palpate fit --out` writes them in maps.npz.

        NaN: undefined, or not supported by contacts. u_position, u_normal_deg, u_S, u_R, u_k1, u_k2: standard uncertainties
        at each point, along the normal, degrees, of S, R, k1 and k2. Where x and y are directions of the surface's own, X, Y, Z are the points.
        Points of the grid: those of the fit, unless others are given. A fit from a document has the surface's maps alone,
        those of a height field.

        >>> import numpy as np, palpate
        >>> x, y = (a.ravel() for a in np.meshgrid(np.linspace(-2, 2, 6), np.linspace(-2, 2, 6)))
        >>> z = np.sqrt(36 - x**2) - 6
        >>> maps = palpate.fit(x, y, z, normals=(x, 0 * x, z + 6)).maps((3, 4))
        >>> maps["S"].shape, bool((maps["u_R"] < 0.01).all())
        ((3, 4), True)
        """
        if self._core is not None:
            return self._core.maps(grid)
        surface = self.surface
        if not isinstance(surface, Surface):
            raise FitError("maps of a document are those of a height field; evaluate fit.surface(u, v) instead", "Parametric")
        wanted = self.to_dict()["shape"]["grid"] if grid is None else grid
        n, m = (wanted, wanted) if isinstance(wanted, int) else wanted
        x0, x1, y0, y1 = surface.domain
        x, y = np.linspace(x0, x1, n), np.linspace(y0, y1, m)
        return {"x": x, "y": y, **surface.shape(x, y)}

    def diff(self, other: Fit | dict[str, Any] | str | PathLike[str], *, grid: Pair | None = None) -> FitDiff:
        """Compares this surface with another, each difference against its uncertainty, as `palpate diff` does.

        other: a fit, its document, or the path of a saved surface (.json, .step, .igs). grid: points each way at which the two
        are compared, 25 without. Raises SurfaceError where they have no part in common, lie with their free sides on opposite
        sides, or are in two units. There is no verdict on documents of `to_dict` and fits that were pickled: they have left the
        uncertainty at every point behind, which `save` keeps.

        >>> import numpy as np, palpate
        >>> x, y = (a.ravel() for a in np.meshgrid(np.linspace(-2, 2, 6), np.linspace(-2, 2, 6)))
        >>> z = np.sqrt(36 - x**2) - 6
        >>> fit, higher = (palpate.fit(x, y, z + h, normals=(x, 0 * x, z + 6)) for h in (0, 0.5))
        >>> found = fit.diff(higher)
        >>> found.same, round(found.differences["height"]["mean"], 3)
        (False, 0.5)
        """
        from ._diff import diff

        return diff(self, other, grid)

    def to_xarray(self, grid: Pair | None = None) -> xarray.Dataset:
        """The maps as a Dataset over x and y, with the document in its attributes; `from_xarray` goes back."""
        import xarray

        maps = self.maps(grid)
        x, y = maps.pop("x"), maps.pop("y")
        variables = {name: (("x", "y"), values) for name, values in maps.items()}
        return xarray.Dataset(variables, coords={"x": x, "y": y}, attrs={"palpate": json.dumps(self.to_dict())})

    @classmethod
    def from_xarray(cls, dataset: xarray.Dataset) -> Fit:
        """The fit whose maps a Dataset holds."""
        return cls.from_dict(json.loads(dataset.attrs["palpate"]))

    def to_pandas(self) -> pandas.DataFrame:
        """One row a quantity: mean, sd over the patch, u, lo, hi."""
        import pandas

        rows = [
            (name, part.mean, part.sd, part.u, *(part.interval or (None, None)))
            for name, part in (("S", self.shape.S), ("R", self.shape.R))
        ]
        frame = pandas.DataFrame(rows, columns=["quantity", "mean", "sd", "u", "lo", "hi"]).set_index("quantity")
        frame.attrs["palpate"] = json.dumps(self.to_dict())
        return frame

    @classmethod
    def from_pandas(cls, frame: pandas.DataFrame) -> Fit:
        """The fit whose quantities a DataFrame of `to_pandas` holds."""
        return cls.from_dict(json.loads(frame.attrs["palpate"]))

    def __reduce__(self) -> tuple[Any, ...]:
        return (_restored, (self.to_dict(), self._name, self._table))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Fit):
            return NotImplemented
        return _comparable(self.to_dict()) == _comparable(other.to_dict())

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        shape = self.shape
        return (
            f"Fit({shape.class_name or 'no one class'}, S = {number(shape.S.mean)} (u {number(shape.S.u, 2)}), "
            f"R = {number(shape.R.mean)} (u {number(shape.R.u, 2)}), {self.contacts} contacts)"
        )

    def __str__(self) -> str:
        self.to_dict()
        return self._table or repr(self)

    def _repr_html_(self) -> str:
        shape = self.shape
        rows = [
            [name, number(part.mean), number(part.sd), number(part.u, 2), _ends(part.interval)]
            for name, part in (("S", shape.S), ("R", shape.R))
        ]
        rows.append(["radius", number(shape.radius), "", "", _ends(shape.radius_interval)])
        caption = f"{shape.class_name or 'no one class'}, {self.contacts} contacts"
        return html_table(caption, ["", "mean", "sd over the patch", "u", "interval"], rows)


def _comparable(document: dict[str, Any]) -> dict[str, Any]:
    """A document without its clock, and without what is written only into a file."""
    surface = {name: part for name, part in document["surface"].items() if name != "support_map"}
    rest = {name: part for name, part in document.items() if name not in ("seconds", "uncertainty")}
    return {**rest, "surface": surface}


def _ends(interval: tuple[float, float] | None) -> str:
    return "" if interval is None else f"{number(interval[0])} to {number(interval[1])}"


def _restored(document: dict[str, Any], name: str, table: str) -> Fit:
    found = Fit.from_dict(document, name)
    found._table = table
    return found


def _saved_surface(document: dict[str, Any]) -> Surface | ParametricSurface:
    saved = document["surface"]
    knots, degree = tuple(np.array(axis) for axis in saved["knots"]), tuple(saved["degree"])
    if saved["kind"] == "adaptive":
        return _native.adaptive_surface(json.dumps(document).encode())
    if saved["kind"] == "parametric":
        closed = saved.get("closed") or (False, False)
        return ParametricSurface(knots, np.array(saved["coefficients"]), degree, tuple(closed))
    return Surface(knots, np.array(saved["coefficients"]), degree, document["frame"]["axes"])


def fit(
    x: Any,
    y: Numbers | None = None,
    z: Numbers | None = None,
    *,
    normals: Any = None,
    slopes: Any = None,
    wz: Numbers | None = None,
    wx: Numbers | None = None,
    wy: Numbers | None = None,
    finger: Numbers | None = None,
    station: Numbers | None = None,
    flip_normals: bool = False,
    surface: str | None = None,
    adaptive: bool | Mapping[str, float] = False,
    closed: str | tuple[bool, bool] | None = None,
    degree: Pair | None = None,
    segments: Pair | None = None,
    knots: tuple[Numbers, Numbers] | None = None,
    domain: Numbers | None = None,
    weights: str | Numbers | None = None,
    sigma: str | Numbers | None = None,
    method: str | None = None,
    smooth: str | float | None = None,
    robust: str | None = None,
    grid: Pair | None = None,
    sigma_xy: float | None = None,
    inset: float | None = None,
    frame: str | None = None,
    level: float | None = None,
    viewpoint: Numbers | None = None,
    bare: bool = False,
    unit: str | None = None,
) -> Fit:
    """Fits contacts, or a grid of heights, and tells the shape.

    Scattered contacts: x, y, z (g,), lengths in one unit; normals (g, 3) of any length but zero, towards the free side,
    or slopes (g, 2) = dz/dx, dz/dy; wz, wx, wy (g,) multiply the residuals; finger, station (g,) whole numbers.
    Alone in place of x, y and z:
    an array (N, 3) of places or (N, 6) with normals behind them;
    a table of pandas, polars, PyArrow or a mapping with columns x, y, z [nx, ny, nz | zx, zy] [wz, wx, wy] [finger, station],
    or as other programs name them: px, x_mm, pose.position.x, normal_x;
    a path of a file in any format that `palpate fit` reads;
    a cloud with .points and .normals (Open3D) or .vertices and .vertex_normals (trimesh).
    A grid: x (n,), y (m,) increasing, z (n, m) indexed [x, y], NaN where a height is missing; slopes=(zx, zy), each (n, m).
    An xarray.DataArray with coordinates x and y alone: the grid that it holds; a Dataset: the grid z, or its columns.

    Where nothing names a model, the contacts are recognised, as `palpate fit FILE` does. Any of surface, adaptive, closed, degree,
    segments, knots, domain, weights, sigma, method and smooth names a model and gives exactly that fit; robust, frame, grid and
    inset name none. sigma_xy declares the sd of errors in x and in y, and names nothing. adaptive=True splits cells until nothing but noise is left: many contacts over x and y, with
    features far smaller than the whole; degree, domain, sigma, grid, inset and level go with it, and a dict in place of True names numbers that
    decide, such as {"false_discovery_rate": 0.05, "last_halving": True}. bare=True leaves out certificate and uncertainties of a named model. unit, such as "mm", is said beside
    every length of the printed table and of the document; nothing is converted.

    Arrays of float64 are read where they lie, whatever their strides, into the columns that the fit owns: one copy of the
    contacts, and no other. Other real dtypes are converted by NumPy first. The interpreter's lock is released; do not
    write to the arrays from another thread meanwhile.

    Raises FitError and RecognitionError, with kind and fields; TypeError and ValueError that name the argument.

    >>> import numpy as np, palpate
    >>> x, y = (a.ravel() for a in np.meshgrid(np.linspace(-2, 2, 6), np.linspace(-2, 2, 6)))
    >>> z = np.sqrt(36 - x**2) - 6
    >>> found = palpate.fit(x, y, z, normals=(x, 0 * x, z + 6), degree=(4, 2))
    >>> found.shape.class_name, round(found.shape.S.mean, 3), round(found.shape.radius, 2)
    ('ridge', 0.5, 6.01)
    """
    given = columns("fit", Columns(x, y, z, normals, slopes, (wz, wx, wy), (finger, station)))
    words = {
        "surface": surface, "adaptive": adaptive or None, "closed": closed, "degree": degree, "segments": segments, "knots": knots, "domain": domain,
        "weights": weights, "sigma": sigma, "method": method, "smooth": smooth, "robust": robust, "grid": grid,
        "sigma_xy": sigma_xy,
        "inset": inset, "frame": frame, "level": level, "viewpoint": viewpoint, "bare": bare or None,
    }  # fmt: skip
    unit = None if unit is None else _native.unit_name(unit)
    x, y, z, normals, slopes, factors, labels = given
    if is_grid(z):
        if normals is not None or flip_normals:
            raise ValueError("normals: a grid takes slopes=(zx, zy), each as large as z")
        if any(label is not None for label in labels):
            raise ValueError("finger, station: a grid has none")
        return Fit(_native.fit_grid(x, y, z, slopes, factors, words), "grid", unit)
    core = _native.fit_contacts(x, y, z, normals, slopes, factors, labels, flip_normals, words)
    return Fit(core, "contacts", unit)
