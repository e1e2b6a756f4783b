"""What to touch next: explorations of simulated worlds, and next touches for a robot that has its own.

    sweep -> fit -> touches that let u(S) and u(R) fall most -> fit -> ... until a goal or the budget ends it
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._errors import ExploreError, in_python
from ._fit import Fit
from ._line import flags, source
from ._shape import Shape
from ._tables import html_table, number

if TYPE_CHECKING:
    import pandas

__all__ = ["Exploration", "ExploreStep", "Known", "TouchPlanner", "explore", "next_touches"]

Progress = Callable[[int, int], object]


@dataclass(frozen=True)
class Known:
    """S or R after some contacts: mean over the patch, u in all, its parts, interval (lo, hi), and the scene's truth."""

    mean: float | None
    u: float | None
    u_noise: float | None
    u_model: float | None
    interval: tuple[float, float] | None
    truth: float | None

    @classmethod
    def _of(cls, part: dict[str, Any]) -> Known:
        ends = part["interval"]
        return cls(
            part["mean"], part["u"], part["u_noise"], part["u_model"],
            None if ends is None else (ends[0], ends[1]), part["truth"],
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class ExploreStep:
    """What was known after so many contacts.

    kind: the kind of surface, or the class under a named model. refused: why there is no answer. touched (k, 2): x and y
    touched since the step before, in the scene's unit. attainable: u(S) and u(R)/R that noise would leave after the whole
    budget, where there is a goal.
    """

    contacts: int
    S: Known
    R: Known
    kind: str | None
    refused: str | None
    touched: npt.NDArray[np.float64]
    attainable: tuple[float, float] | None

    @classmethod
    def _of(cls, part: dict[str, Any]) -> ExploreStep:
        left = part["attainable"]
        return cls(
            contacts=part["contacts"],
            S=Known._of(part["S"]),
            R=Known._of(part["R"]),
            kind=part["kind"],
            refused=part["refused"],
            touched=np.array(part["touched"], dtype=float).reshape(-1, 2),
            attainable=None if left is None else (left["u_S"], left["u_R"]),
        )


class Exploration:
    """All that came of an exploration; the document palpate.explore/1 behind names.

    `contacts` holds all contacts as columns x, y, z, nx, ny, nz (g,), as `fit` takes them.
    """

    def __init__(self, document: dict[str, Any], contacts: dict[str, npt.NDArray[Any]]) -> None:
        self.document = document
        self.contacts = contacts

    @property
    def steps(self) -> list[ExploreStep]:
        """Every look at S and R, the first after the scene's own sweep."""
        return [ExploreStep._of(part) for part in self.document["steps"]]

    @property
    def shape(self) -> Shape | None:
        """S, R and class from all contacts, as `fit` answers; None where it refuses, which the notes then explain."""
        part = self.document["shape"]
        return None if part is None else Shape._of(part)

    @property
    def stopped(self) -> str:
        """Why it ended: goal, budget, noise, model, places or asked; `reason` says it in a sentence."""
        return str(self.document["stopped"])

    @property
    def reason(self) -> str:
        """Why it ended, in a sentence."""
        return in_python(self.document["reason"])

    @property
    def notes(self) -> list[str]:
        """What the user should know, in whole sentences."""
        return [in_python(note) for note in self.document["notes"]]

    def to_dict(self) -> dict[str, Any]:
        """The document palpate.explore/1: what `palpate explore --json` prints."""
        return self.document

    def to_pandas(self) -> pandas.DataFrame:
        """One row a step: contacts, S, u_S, truth_S, R, u_R, truth_R, kind."""
        import pandas

        rows = [
            (s.contacts, s.S.mean, s.S.u, s.S.truth, s.R.mean, s.R.u, s.R.truth, s.kind) for s in self.steps
        ]  # fmt: skip
        names = ["contacts", "S", "u_S", "truth_S", "R", "u_R", "truth_R", "kind"]
        return pandas.DataFrame(rows, columns=names)

    def __eq__(self, other: object) -> bool:
        return self.document == other.document if isinstance(other, Exploration) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        last = self.steps[-1]
        return (
            f"Exploration({self.document['scene']}, {self.document['strategy']}, {last.contacts} contacts, "
            f"S = {number(last.S.mean)} (u {number(last.S.u, 2)}), R = {number(last.R.mean)} (u {number(last.R.u, 2)}), "
            f"stopped: {self.stopped})"
        )

    def _repr_html_(self) -> str:
        rows = [
            [str(s.contacts), number(s.S.mean), number(s.S.u, 2), number(s.R.mean), number(s.R.u, 2), s.kind or s.refused or ""]
            for s in self.steps
        ]  # fmt: skip
        caption = f"{self.document['scene']}, {self.document['strategy']}: {self.reason}"
        return html_table(caption, ["contacts", "S", "u", "R", "u", ""], rows)


def explore(
    scene: str | PathLike[str],
    *,
    strategy: str = "shape",
    contacts: int = 60,
    u_s: float | None = None,
    u_r: float | None = None,
    per_round: int = 3,
    lines: bool = False,
    reach: npt.ArrayLike | None = None,
    seed: int | None = None,
    level: float | None = None,
    progress: Progress | None = None,
    **fit: Any,
) -> Exploration:
    """Plays the loop sweep, fit, plan, touch in a scene's world.

    scene: a built-in name, a file, or TOML text; its own sweep comes first. The words are those of `palpate explore`:
    strategy is one of shape, variance, lattice, random, second-sweep and probe-model; contacts is the most there may be,
    those of the first sweep among them. u_s and u_r, both or neither, are the goal: the standard uncertainty of S in all,
    and that of R as a share of R. per_round: touches between two looks. lines: whole lines of a finger. reach
    (x0, x1, y0, y1) in the scene's unit: where touches may be made. fit: degree, sigma and the like name a model;
    otherwise the contacts are recognised at every look.

    progress(done, of) is called with the contacts so far and the most. The interpreter's lock is released; Ctrl-C ends it
    with KeyboardInterrupt after the look that is being made. Raises ExploreError.

    >>> found = explore("paper-table2", contacts=42, seed=3)
    >>> len(found.contacts["x"]), [step.contacts for step in found.steps], found.stopped
    (42, [36, 39, 42], 'budget')
    """
    name, text = source(scene)
    bounds = None if reach is None else [float(end) for end in np.asarray(reach, dtype=float).ravel()]
    options = {
        "strategy": strategy, "contacts": contacts, "u_s": u_s, "u_r": u_r, "per_round": per_round, "lines": bool(lines),
        "reach": bounds, "seed": seed, "level": level, "quiet": True,
    }  # fmt: skip
    document, columns = _native.explore([*flags("explore", options, fit), "--", name], text, progress)
    return Exploration(json.loads(document), columns)


class TouchPlanner:
    """A fit prepared for choosing next touches again and again: no refit is made, one call takes microseconds.

    fit: contacts fitted by a height field that keeps the input's axes, with known or estimated noise. Where the contacts
    were recognised, a spline of one segment with the noise that was found plans. units=(of S, of R) count the falls of u(S) and u(R), such as the goals (of R in
    1/length); the fit's own u where nothing is said. A planner does not pickle; fits do, without their equations.

    Raises ExploreError: a fit with preset weights, without noise, with free coefficients, with axes of its own, a
    surface in space or a grid that was recognised, or a fit that was read from a file.

    >>> import numpy as np, palpate
    >>> x, y = (a.ravel() for a in np.meshgrid([-4.0, 0.0, 4.0], [-4.0, 0.0, 4.0]))
    >>> up = np.sqrt(100 - x**2)
    >>> fit = palpate.fit(x, y, up - 10, normals=(x, 0 * x, up), sigma=(0.02, 1))
    >>> planner = TouchPlanner(fit)
    >>> planner.next_touches([[0, 0], [4, 4], [1, 0]], 1)
    array([0])
    >>> planner.expected_u[0] < fit.shape.S.u
    True
    """

    __slots__ = ("_planner",)

    def __init__(self, fit: Fit, *, units: tuple[float, float] | None = None) -> None:
        if not isinstance(fit, Fit):
            raise TypeError("fit: a Fit wanted, as palpate.fit gives it")
        if fit._core is None:
            what = "a fit that was saved or pickled has left its equations behind: fit the contacts again"
            raise ExploreError(what, "Saved")
        of = None if units is None else (float(units[0]), float(units[1]))
        self._planner = _native.TouchPlanner(fit._core, of)

    def next_touches(self, candidates: npt.ArrayLike, n: int = 1) -> npt.NDArray[np.int64]:
        """The rows of candidates (k, 2), x and y in the input's unit, to touch next: (min(n, k),), the best first.

        Every one is chosen with those before it counted as made. Raises ExploreError where there is no candidate, or one
        that is no place; ValueError that names the argument.
        """
        if n < 1:
            raise ValueError(f"n is {n}: a whole number from 1 wanted")
        return self._planner.next_touches(candidates, n)

    @property
    def expected_u(self) -> tuple[float, float]:
        """u of S, and of R in 1/length, once the touches chosen last are made; of independent noise alone."""
        return self._planner.expected_u


def next_touches(
    fit: Fit | TouchPlanner, candidates: npt.ArrayLike, n: int = 1
) -> npt.NDArray[np.int64]:
    """The rows of candidates (k, 2), x and y in the input's unit, whose touches let u(S) and u(R) fall most.

    fit: a Fit, or a TouchPlanner where it is asked again and again. Gives (min(n, k),) whole numbers, the best first.
    Raises ExploreError, and what `TouchPlanner` raises.
    """
    planner = fit if isinstance(fit, TouchPlanner) else TouchPlanner(fit)
    return planner.next_touches(candidates, n)
