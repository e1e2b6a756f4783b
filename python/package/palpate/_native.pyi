"""The compiled part; use the names of the package instead."""

from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any

import numpy as np
import numpy.typing as npt

__version__: str

Array = npt.NDArray[np.float64]
Progress = Callable[[int, int], object]

class FitCore:
    def document(self, name: str) -> tuple[bytes, str]: ...
    def surface(self) -> Surface | ParametricSurface: ...

class Surface:
    """A height field z = S(x, y): a tensor-product B-spline."""

    def __init__(
        self, t: Any, c: npt.ArrayLike, k: int | Sequence[int], axes: Sequence[Sequence[float]] | None = None
    ) -> None: ...
    def __call__(
        self, x: npt.ArrayLike, y: npt.ArrayLike, dx: int = 0, dy: int = 0, grid: bool = True
    ) -> Array: ...
    def ev(self, x: npt.ArrayLike, y: npt.ArrayLike, dx: int = 0, dy: int = 0) -> Array: ...
    def shape(self, x: npt.ArrayLike, y: npt.ArrayLike) -> dict[str, Array]: ...
    @property
    def tck(self) -> tuple[Array, Array, Array, int, int]: ...
    @property
    def t(self) -> tuple[Array, Array]: ...
    @property
    def c(self) -> Array: ...
    @property
    def k(self) -> tuple[int, int]: ...
    @property
    def domain(self) -> tuple[float, float, float, float]: ...
    @property
    def axes(self) -> list[list[float]]: ...

class ParametricSurface:
    """A surface in space (x, y, z) = Q(u, v): a tensor-product B-spline of points."""

    def __init__(
        self, t: Any, c: npt.ArrayLike, k: int | Sequence[int], closed: Sequence[bool] = (False, False)
    ) -> None: ...
    def __call__(
        self, u: npt.ArrayLike, v: npt.ArrayLike, du: int = 0, dv: int = 0, grid: bool = True
    ) -> Array: ...
    def ev(self, u: npt.ArrayLike, v: npt.ArrayLike, du: int = 0, dv: int = 0) -> Array: ...
    @property
    def t(self) -> tuple[Array, Array]: ...
    @property
    def c(self) -> Array: ...
    @property
    def k(self) -> tuple[int, int]: ...
    @property
    def closed(self) -> tuple[bool, bool]: ...
    @property
    def domain(self) -> tuple[float, float, float, float]: ...

class StreamShape:
    """The shape after the touches so far."""

    contacts: int
    shape_index: float | None
    u_shape_index: float
    curvedness: float
    u_curvedness: float
    class_name: str | None

class TouchStream:
    """A fit that grows touch by touch, for control loops."""

    def __init__(
        self,
        domain: npt.ArrayLike,
        *,
        sigma: npt.ArrayLike,
        degree: int | tuple[int, int] | None = None,
        segments: int | tuple[int, int] | None = None,
        grid: int | tuple[int, int] | None = None,
        inset: float = 0.0,
    ) -> None: ...
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
    def __len__(self) -> int: ...

class StudyRun:
    @property
    def document(self) -> bytes: ...
    @property
    def part(self) -> bytes: ...
    @property
    def values(self) -> dict[str, Array]: ...

class StudyPlan:
    def __init__(self, arguments: list[str], text: str | None) -> None: ...
    @property
    def replicates(self) -> int: ...
    def run(
        self,
        range: tuple[int, int] | None,
        threads: int | None,
        keep_values: bool,
        describe: bool,
        progress: Progress | None,
    ) -> StudyRun: ...

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
    progress: Progress | None,
    keywords: dict[str, Any] | None,
) -> dict[str, Any]: ...
def class_names() -> list[str]: ...
def merge_parts(parts: Sequence[str | PathLike[str]]) -> bytes: ...
def scene_texts() -> dict[str, tuple[str, str]]: ...
def scene_contacts(scene: str, text: str | None, seed: int | None, replicate: int) -> dict[str, npt.NDArray[Any]]: ...
