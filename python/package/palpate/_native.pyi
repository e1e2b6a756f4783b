"""The compiled part; use the names of the package instead."""

from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, final

import numpy as np
import numpy.typing as npt
from typing_extensions import Self

__all__ = [
    "FitCore",
    "LiveCore",
    "ParametricSurface",
    "PlanCore",
    "StreamShape",
    "StudyPlan",
    "StudyRun",
    "Surface",
    "TiledFit",
    "TouchPlanner",
    "TouchStream",
    "adaptive_surface",
    "class_names",
    "column_names",
    "contact_tile",
    "diff_documents",
    "explore",
    "fit_batch",
    "fit_contacts",
    "fit_grid",
    "frontier",
    "frontier_of_contacts",
    "merge_parts",
    "merged_runs",
    "part_bounds",
    "part_run",
    "parts_of",
    "plan_adaptive",
    "read_contacts",
    "run_of_roots",
    "run_slice",
    "scene_contacts",
    "scene_texts",
    "tile_answer",
    "tile_sides",
    "time_fit",
    "unit_name",
    "__version__",
]

__version__: str

_Array = npt.NDArray[np.float64]
_Progress = Callable[[int, int], object]

@final
class FitCore:
    def document(self, name: str, unit: str | None) -> tuple[bytes, str]: ...
    def saved(self, unit: str | None) -> bytes: ...
    def residuals(self) -> _Array | None: ...
    def maps(self, grid: int | Sequence[int] | None = None) -> dict[str, _Array]: ...
    def surface(self) -> Surface | ParametricSurface: ...

@final
class Surface:
    """A height field z = S(x, y): a tensor-product B-spline."""

    def __new__(
        cls, t: Any, c: npt.ArrayLike, k: int | Sequence[int], axes: Sequence[Sequence[float]] | None = None
    ) -> Self: ...
    def __call__(
        self, x: npt.ArrayLike, y: npt.ArrayLike, dx: int = 0, dy: int = 0, grid: bool = True
    ) -> _Array: ...
    def ev(self, x: npt.ArrayLike, y: npt.ArrayLike, dx: int = 0, dy: int = 0) -> _Array: ...
    def shape(self, x: npt.ArrayLike, y: npt.ArrayLike) -> dict[str, _Array]: ...
    @property
    def tck(self) -> tuple[_Array, _Array, _Array, int, int]: ...
    @property
    def t(self) -> tuple[_Array, _Array]: ...
    @property
    def c(self) -> _Array: ...
    @property
    def k(self) -> tuple[int, int]: ...
    @property
    def domain(self) -> tuple[float, float, float, float]: ...
    @property
    def axes(self) -> list[list[float]]: ...

@final
class ParametricSurface:
    """A surface in space (x, y, z) = Q(u, v): a tensor-product B-spline of points."""

    def __new__(
        cls, t: Any, c: npt.ArrayLike, k: int | Sequence[int], closed: Sequence[bool] = ...
    ) -> Self: ...
    def __call__(
        self, u: npt.ArrayLike, v: npt.ArrayLike, du: int = 0, dv: int = 0, grid: bool = True
    ) -> _Array: ...
    def ev(self, u: npt.ArrayLike, v: npt.ArrayLike, du: int = 0, dv: int = 0) -> _Array: ...
    def shape(self, u: npt.ArrayLike, v: npt.ArrayLike) -> dict[str, _Array]: ...
    @property
    def t(self) -> tuple[_Array, _Array]: ...
    @property
    def c(self) -> _Array: ...
    @property
    def k(self) -> tuple[int, int]: ...
    @property
    def closed(self) -> tuple[bool, bool]: ...
    @property
    def domain(self) -> tuple[float, float, float, float]: ...

@final
class StreamShape:
    """The shape after the touches so far."""

    @property
    def contacts(self) -> int: ...
    @property
    def shape_index(self) -> float | None: ...
    @property
    def u_shape_index(self) -> float: ...
    @property
    def curvedness(self) -> float: ...
    @property
    def u_curvedness(self) -> float: ...
    @property
    def class_name(self) -> str | None: ...

@final
class TouchStream:
    """A fit that grows touch by touch, for control loops."""

    def __new__(
        cls,
        domain: npt.ArrayLike,
        *,
        sigma: npt.ArrayLike,
        degree: int | tuple[int, int] | None = None,
        segments: int | tuple[int, int] | None = None,
        grid: int | tuple[int, int] | None = None,
        inset: float = 0.0,
    ) -> Self: ...
    def push(
        self,
        x: float,
        y: float,
        z: float,
        normal: npt.ArrayLike | None = None,
        *,
        slopes: npt.ArrayLike | None = None,
    ) -> None: ...
    def shape(self) -> StreamShape: ...
    def touch(
        self,
        x: float,
        y: float,
        z: float,
        normal: npt.ArrayLike | None = None,
        *,
        slopes: npt.ArrayLike | None = None,
    ) -> StreamShape | None: ...
    def clear(self) -> None: ...
    def __len__(self) -> int: ...

@final
class StudyRun:
    @property
    def document(self) -> bytes: ...
    @property
    def part(self) -> bytes: ...
    @property
    def values(self) -> dict[str, _Array]: ...

@final
class StudyPlan:
    def __new__(cls, arguments: list[str], text: str | None) -> Self: ...
    @property
    def replicates(self) -> int: ...
    def run(
        self,
        range: tuple[int, int] | None,
        threads: int | None,
        keep_values: bool,
        describe: bool,
        progress: _Progress | None,
    ) -> StudyRun: ...

@final
class LiveCore:
    def __new__(cls, arguments: list[str]) -> Self: ...
    def touch(
        self,
        place: tuple[float, float, float],
        normal: npt.ArrayLike | None,
        finger: int | None,
        station: int | None,
        time: float | None,
    ) -> tuple[str | None, tuple[str, str, bool] | None]: ...
    def hear(self, line: bytes) -> tuple[str | None, tuple[str, str, bool] | None]: ...
    def finish(self) -> tuple[str, str, bool] | None: ...
    def save(self, path: str | PathLike[str]) -> None: ...
    def counts(self) -> tuple[int, int, int]: ...
    def contacts(self) -> dict[str, npt.NDArray[Any]]: ...
    def document(self) -> bytes | None: ...
    def maps(self, grid: int | Sequence[int] | None = None) -> dict[str, _Array] | None: ...

@final
class TouchPlanner:
    def __new__(cls, core: FitCore, units: tuple[float, float] | None) -> Self: ...
    def next_touches(self, candidates: npt.ArrayLike, n: int) -> npt.NDArray[np.int64]: ...
    @property
    def expected_u(self) -> tuple[float, float]: ...

def diff_documents(
    a: tuple[str, bytes], b: tuple[str, bytes], grid: int | Sequence[int] | None
) -> tuple[bytes, str]: ...
def explore(
    arguments: list[str], text: str | None, progress: _Progress | None
) -> tuple[bytes, dict[str, npt.NDArray[Any]]]: ...
def frontier(arguments: list[str], text: str | None, progress: _Progress | None) -> bytes: ...
def frontier_of_contacts(
    x: Any,
    y: Any,
    z: Any,
    normals: Any,
    slopes: Any,
    weights: Sequence[Any],
    flip_normals: bool,
    arguments: list[str],
    progress: _Progress | None,
) -> bytes: ...
def unit_name(text: str) -> str: ...
def read_contacts(name: str, bytes: bytes) -> dict[str, npt.NDArray[Any]]: ...
def column_names(names: Sequence[str]) -> list[str]: ...
def parts_of(
    x: Any,
    y: Any,
    z: Any,
    normals: Any,
    tolerance: float | None,
    viewpoint: Sequence[float] | None,
) -> tuple[bytes, npt.NDArray[np.uint32]]: ...
def fit_contacts(
    x: Any,
    y: Any,
    z: Any,
    normals: Any,
    slopes: Any,
    weights: Sequence[Any],
    labels: Sequence[Any],
    flip_normals: bool,
    keywords: dict[str, Any] | None,
) -> FitCore: ...
def fit_grid(
    x: Any, y: Any, z: Any, slopes: Any, weights: Sequence[Any], keywords: dict[str, Any] | None
) -> FitCore: ...
def adaptive_surface(document: bytes) -> Surface: ...
def time_fit(
    x: Any, y: Any, z: Any, normals: Any, keywords: dict[str, Any] | None, times: int
) -> list[float]: ...
def fit_batch(
    x: Any,
    y: Any,
    z: Any,
    normals: Any,
    slopes: Any,
    offsets: Any,
    threads: int | None,
    progress: _Progress | None,
    keywords: dict[str, Any] | None,
) -> dict[str, Any]: ...
def class_names() -> list[str]: ...
def merge_parts(parts: Sequence[str | PathLike[str]]) -> bytes: ...
def scene_texts() -> dict[str, tuple[str, str]]: ...
def scene_contacts(scene: str, text: str | None, seed: int | None, replicate: int) -> dict[str, npt.NDArray[Any]]: ...

_Part = tuple[Any, Any, Any, Any, Any, tuple[Any, Any, Any]]
_Bounds = tuple[int, list[tuple[float, float]]]

def part_bounds(part: _Part) -> _Bounds: ...
def part_run(
    part: _Part, ground: bytes, first: int, total: int
) -> tuple[bytes, list[int], list[tuple[float, float]]]: ...
def run_of_roots(run: bytes, roots: tuple[int, int]) -> bytes: ...
def run_slice(run: bytes, range: tuple[int, int]) -> bytes: ...
def merged_runs(runs: list[bytes]) -> bytes: ...
def tile_sides(counts: list[int], tile: int) -> tuple[list[list[tuple[int, tuple[int, int]]]], int]: ...
def contact_tile(
    ground: bytes,
    roots: tuple[int, int],
    own: bytes,
    sides: tuple[list[bytes], list[bytes]],
    before_and_total: tuple[int, int],
) -> tuple[bytes, bytes]: ...
def tile_answer(tile: bytes, question: bytes) -> _Array: ...

@final
class PlanCore:
    def fit(self, z: npt.ArrayLike, zx: npt.ArrayLike | None, zy: npt.ArrayLike | None) -> tuple[Surface, float]: ...

def plan_adaptive(
    x: Any, y: Any, z: Any, slopes: Any, weights: list[Any], keywords: dict[str, Any] | None
) -> tuple[FitCore, PlanCore]: ...

@final
class TiledFit:
    def __new__(cls, parts: list[_Bounds], keywords: dict[str, Any] | None) -> Self: ...
    @property
    def ground(self) -> bytes: ...
    @property
    def roots(self) -> int: ...
    def fit(
        self,
        extents: list[bytes],
        shown: list[tuple[float, float]],
        ask: Callable[[list[bytes]], list[_Array]],
    ) -> FitCore: ...
