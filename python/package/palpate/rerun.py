"""A live loop as a recording for Rerun (https://rerun.io): contacts, surface, its uncertainty and the next touch, step by step.

    LiveLoop -> after every answer -> touches/  surface/  doubt/  next/  values/  words   over the timeline "touch"

`pip install rerun-sdk` brings what is needed; it is asked for when a log is made.
"""

from __future__ import annotations

from os import PathLike, fspath
from typing import Any

import numpy as np
import numpy.typing as npt

from ._live import LiveAnswer, LiveLoop
from ._mesh import Array, SurfaceMesh, surface_mesh

__all__ = ["RerunLog"]

_LOW, _MIDDLE, _HIGH = np.array([59, 76, 192]), np.array([221, 221, 221]), np.array([180, 4, 38])


def _rerun() -> Any:
    try:
        import rerun
    except ImportError as error:
        raise ImportError("palpate.rerun records with rerun-sdk, which is not installed: pip install rerun-sdk") from error
    return rerun


class RerunLog:
    """Records a live loop, an answer at a time.

    path: a file .rrd that is written; recording: a rerun.RecordingStream that is there already, for a viewer or a sink of your
    own. colour: "S" or "R", what colours the surface. grid: points each way of the surface. entity: what stands before
    every name. Raises ImportError where there is no rerun.

        with palpate.rerun.RerunLog(loop, path="touches.rrd") as log:
            for touch in touches:
                log.log(loop.hear(touch))
    """

    def __init__(
        self,
        loop: LiveLoop,
        *,
        path: str | PathLike[str] | None = None,
        recording: Any = None,
        colour: str = "S",
        grid: int = 30,
        entity: str = "palpate",
    ) -> None:
        if colour not in ("S", "R"):
            raise ValueError(f"colour is {colour!r}: S or R wanted")
        if (path is None) == (recording is None):
            raise ValueError("path, recording: give one of them")
        self._rerun = _rerun()
        self._loop, self._colour, self._grid, self._entity = loop, colour, grid, entity
        self._own = recording is None
        self.recording = self._rerun.RecordingStream("palpate") if recording is None else recording
        if path is not None:
            self.recording.save(fspath(path))

    def log(self, answer: LiveAnswer | None) -> None:
        """Records what is known after a touch; None, where there was no answer, is passed over."""
        if answer is None:
            return
        self.recording.set_time("touch", sequence=answer.touch)
        rerun, contacts = self._rerun, self._loop.contacts
        places = np.column_stack([contacts["x"], contacts["y"], contacts["z"]])
        size = float(np.ptp(places, axis=0).max()) or 1.0
        self._put("touches", rerun.Points3D(places, radii=0.01 * size))
        self._put("words", rerun.TextLog(str(answer)))
        if answer.answer == "fresh":
            self._log_surface()
        elif answer.answer == "none":
            self._put("surface", rerun.Clear(recursive=True))
            self._put("doubt", rerun.Clear(recursive=True))
        self._log_next(answer, size)
        self._log_values(answer)

    def _put(self, name: str, what: Any) -> None:
        self.recording.log(f"{self._entity}/{name}", what)

    def _log_surface(self) -> None:
        mesh = surface_mesh(self._loop.maps(self._grid))
        values = mesh.values[self._colour]
        ends = (-1.0, 1.0) if self._colour == "S" else _ends(values)
        self._put("surface", self._mesh(mesh, colours(values, *ends)))
        self._put("doubt", self._mesh(mesh, colours(mesh.doubt, 0.0, 1.0)))

    def _mesh(self, mesh: SurfaceMesh, shades: npt.NDArray[np.uint8]) -> Any:
        return self._rerun.Mesh3D(
            vertex_positions=mesh.points.astype(np.float32),
            triangle_indices=mesh.triangles.astype(np.uint32),
            vertex_colors=shades,
        )

    def _log_next(self, answer: LiveAnswer, size: float) -> None:
        proposed = answer.next
        if proposed is None or proposed.z is None:
            self._put("next", self._rerun.Clear(recursive=False))
            return
        normal = np.array(proposed.normal or (0.0, 0.0, 1.0))
        place = np.array([*proposed.at, proposed.z])
        # the finger comes from the free side
        arrow = self._rerun.Arrows3D(origins=[place + 0.3 * size * normal], vectors=[-0.3 * size * normal])
        self._put("next", arrow)

    def _log_values(self, answer: LiveAnswer) -> None:
        known = {"radius": answer.radius}
        for name, part in (("S", answer.S), ("R", answer.R)):
            if part is not None:
                known |= {name: part.mean, f"u_{name}": part.u}
        for name, value in known.items():
            if value is not None:
                self._put(f"values/{name}", self._rerun.Scalars(value))

    def close(self) -> None:
        """Writes what is not written yet; a recording that was given stays open."""
        self.recording.flush()
        if self._own:
            self.recording.disconnect()

    def __enter__(self) -> RerunLog:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _ends(values: Array) -> tuple[float, float]:
    known = values[np.isfinite(values)]
    return (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)


def colours(values: Array, lo: float, hi: float) -> npt.NDArray[np.uint8]:
    """Blue over grey to red, as RGB; what is not known is dark grey.

    >>> colours(np.array([-1.0, 0.0, 1.0, np.nan]), -1.0, 1.0).tolist()
    [[59, 76, 192], [221, 221, 221], [180, 4, 38], [90, 90, 90]]
    """
    at = np.clip((values - lo) / (hi - lo if hi > lo else 1.0), 0.0, 1.0)[:, None]
    below, above = _LOW + 2 * at * (_MIDDLE - _LOW), _MIDDLE + (2 * at - 1) * (_HIGH - _MIDDLE)
    shades = np.where(at < 0.5, below, above)
    return np.where(np.isfinite(at), shades, 90.0).round().astype(np.uint8)
