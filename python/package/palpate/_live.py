"""A loop that lives: every touch is answered when it comes, as `palpate live` does.

    touch -> the touches that count -> all are looked at, or the last look is moved, or it stands -> answer, and what to touch next

An answer is never one of touches that it has not seen: where the last look stands, it says of how many touches that look is.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._errors import LiveError, PalpateError, in_python
from ._fit import Fit, Pair
from ._line import flag
from ._shape import Measure, Shape
from ._touches import NoTouch, each, line_of, numbers_of

__all__ = ["LiveAnswer", "LiveLoop", "NextTouch", "live"]

Say = Callable[[str], object]
_Parts = tuple[str, str, bool]


@dataclass(frozen=True)
class NextTouch:
    """What to touch next: x and y; z and outward normal that are expected there, None where nothing is known of them.

    by: `shape` where it lowers the uncertainties of S and R most, `farthest` where it lies farthest from all touches.
    """

    at: tuple[float, float]
    z: float | None
    normal: tuple[float, float, float] | None
    by: str


class LiveAnswer:
    """What is known after one touch; the line of `palpate live --json` behind names.

    is_reached: the goal held at this answer and at the one before it. str() gives the line that `palpate live` prints.
    """

    __slots__ = ("_document", "_line", "_words", "is_reached")

    def __init__(self, line: str, words: str, is_reached: bool) -> None:
        self._line, self._words, self.is_reached = line, words, is_reached
        self._document: dict[str, Any] | None = None

    def to_dict(self) -> dict[str, Any]:
        """The line palpate.live/1."""
        if self._document is None:
            self._document = json.loads(self._line)
        return self._document

    @property
    def touch(self) -> int:
        """Number of the touch, counted from 1."""
        return int(self.to_dict()["touch"])

    @property
    def answer(self) -> str:
        """`fresh`: all touches that count were looked at; `moved`: the last look's answer was moved by those since; `stands`: it is of the
        touches before, and no simple shape; `none`: there is none."""
        return str(self.to_dict()["answer"])

    @property
    def contacts(self) -> int:
        """Number of touches that the answer is of."""
        return int(self.to_dict()["contacts"])

    @property
    def made_at(self) -> int:
        """Number of the touch at which it was made."""
        return int(self.to_dict()["made_at"])

    @property
    def kind(self) -> str | None:
        """Kind of surface, such as "cylinder"."""
        found: str | None = self.to_dict()["kind"]
        return found

    @property
    def kind_probability(self) -> float | None:
        """Probability of the kind."""
        found: float | None = self.to_dict()["kind_probability"]
        return found

    @property
    def shape(self) -> Shape | None:
        """S, R, class, radius and the rest as a fit has them; None where there is no answer."""
        part = self.to_dict()["shape"]
        return None if part is None else Shape._of(part)

    @property
    def class_name(self) -> str | None:
        """The class, such as "ridge"."""
        return None if self.shape is None else self.shape.class_name

    @property
    def radius(self) -> float | None:
        """Radius of a cap, cup, ridge or rut."""
        return None if self.shape is None else self.shape.radius

    @property
    def radius_interval(self) -> tuple[float, float] | None:
        """The ends between which the radius lies."""
        return None if self.shape is None else self.shape.radius_interval

    @property
    def S(self) -> Measure | None:
        """The shape index with its u and interval."""
        return None if self.shape is None else self.shape.S

    @property
    def R(self) -> Measure | None:
        """The curvedness with its u and interval."""
        return None if self.shape is None else self.shape.R

    @property
    def next(self) -> NextTouch | None:
        """What to touch next; None where no place is left or known."""
        part = self.to_dict()["next"]
        if part is None:
            return None
        normal = None if part["normal"] is None else tuple(part["normal"])
        return NextTouch((part["at"][0], part["at"][1]), part["z"], normal, part["by"])

    @property
    def why(self) -> str | None:
        """Why there is no answer."""
        why = self.to_dict()["why"]
        return None if why is None else in_python(why)

    @property
    def seconds(self) -> float:
        """Seconds from the touch to this answer."""
        return float(self.to_dict()["seconds"])

    def __str__(self) -> str:
        return self._words

    def __repr__(self) -> str:
        return f"LiveAnswer({self._words!r})"


def _listed(numbers: npt.ArrayLike | None) -> list[float] | None:
    return None if numbers is None else [float(number) for number in np.asarray(numbers, dtype=float).ravel()]


def _said(what: str) -> None:
    warnings.warn(what, stacklevel=4)


class LiveLoop:
    """The touches so far and what is known of them, by the words of `palpate live`.

    window: only the last so many touches count, and memory stays as it is. refresh: all touches are looked at again when they
    have grown by this share (0.25), and whenever one disagrees; 0: after every touch. Goals: until_radius, half of the radius's
    interval; u_s and u_r, both or neither, the standard uncertainties of S and of R as a share of R. reach (x0, x1, y0, y1):
    where touches may be made next; the rectangle of the touches without. viewpoint (x, y, z): where the sensor stood. columns:
    "x=NAME,..." where names do not tell. resume: a file that `save`, or `palpate live --save`, has written.

    say(words) is called with one line about what is no touch, comes late, or of a sensor that was started anew; without it they are
    warnings. Raises LiveError, and for a touch that can be none FitError, with kind and fields. May be asked from several
    threads: the interpreter's lock is released while a touch is answered.

    >>> import palpate
    >>> touches = palpate.simulate("paper-cylinder")
    >>> loop = LiveLoop(window=50)
    >>> for x, y, z, *normal in list(zip(*touches.values()))[:20]:
    ...     answer = loop.touch(x, y, z, normal[:3])
    >>> answer.class_name, len(loop), answer.next is not None
    ('ridge', 20, True)
    """

    __slots__ = ("_core", "_left_out", "_say", "last")

    def __init__(
        self,
        *,
        window: int | None = None,
        refresh: float | None = None,
        until_radius: float | None = None,
        u_s: float | None = None,
        u_r: float | None = None,
        reach: npt.ArrayLike | None = None,
        viewpoint: npt.ArrayLike | None = None,
        columns: str | None = None,
        resume: str | PathLike[str] | None = None,
        say: Say | None = None,
    ) -> None:
        options = {
            "window": window, "refresh": refresh, "until_radius": until_radius, "u_s": u_s, "u_r": u_r,
            "reach": _listed(reach), "viewpoint": _listed(viewpoint), "columns": columns,
            "resume": None if resume is None else fspath(resume),
        }  # fmt: skip
        words = [entry for name, value in options.items() for entry in flag(name, value)]
        self._core = _native.LiveCore([*words, "-"])
        self._say: Say = _said if say is None else say
        self._left_out = 0
        self.last: LiveAnswer | None = None

    def touch(
        self,
        x: float,
        y: float,
        z: float,
        normal: npt.ArrayLike | None = None,
        *,
        finger: int | None = None,
        station: int | None = None,
        time: float | None = None,
    ) -> LiveAnswer:
        """Answers one touch: its place, the outward normal of any length, and when it was made, in any unit.

        A normal of zeros is one that is not known. Nothing has changed where an error is raised.
        """
        said, parts = self._core.touch((x, y, z), normal, finger, station, time)
        answer = self._answer(said, parts, self._say)
        assert answer is not None
        return answer

    def hear(self, touch: Any) -> LiveAnswer | None:
        """Answers a touch as it comes: 3 or 6 numbers, a mapping by the usual names of columns, or a line of a table or of JSON.

        What is no touch is said in one line and left out; there is no answer to it, nor to a line of names: None.

        >>> loop = LiveLoop(say=print)
        >>> loop.hear({"pose": {"position": {"x": 0, "y": 1, "z": 2}}}).touch
        1
        >>> loop.hear((1, 2)) is None
        touches, after touch 1: a touch is 3 numbers, or 6 with a normal, not 2; no touch, left out
        True
        """
        answer, words = self._heard(touch)
        for said in words:
            self._say(said)
        return answer

    def _heard(self, touch: Any) -> tuple[LiveAnswer | None, list[str]]:
        """The answer, and what is to be said: for whoever says it in another thread."""
        words: list[str] = []
        line = line_of(touch)
        if line is not None:
            said, parts = self._core.hear(line)
            return self._answer(said, parts, words.append), words
        try:
            place, normal = numbers_of(touch)
            said, parts = self._core.touch(place, normal, None, None, None)
        except (NoTouch, PalpateError, ValueError) as error:
            self._left_out += 1
            return None, [f"touches, after touch {self.touches}: {error}; no touch, left out"]
        return self._answer(said, parts, words.append), words

    def _answer(self, said: str | None, parts: _Parts | None, say: Say) -> LiveAnswer | None:
        if said is not None:
            say(in_python(said))
        if parts is None:
            return None
        self.last = LiveAnswer(*parts)
        return self.last

    def finish(self) -> LiveAnswer | None:
        """Looks at all touches that count, where any came since the last look; the last answer, None without touches."""
        self._finished()
        return self.last

    def _finished(self) -> LiveAnswer | None:
        """The answer of the look at the end, where one was made."""
        return self._answer(None, self._core.finish(), self._say)

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the touches that count, whole or not at all; `resume=` and `palpate live --resume` take them up."""
        self._core.save(Path(path))

    @property
    def looks(self) -> int:
        """How often all touches were looked at."""
        return self._core.counts()[1]

    @property
    def left_out(self) -> int:
        """How many things were no touch."""
        return self._core.counts()[2] + self._left_out

    @property
    def touches(self) -> int:
        """How many touches ever came, those of an earlier run among them."""
        return self._core.counts()[0]

    @property
    def contacts(self) -> dict[str, npt.NDArray[Any]]:
        """The touches that count as columns, as `fit` takes them; a normal that is not known is zeros."""
        return self._core.contacts()

    @property
    def fit(self) -> Fit:
        """The last look as a fit, as `palpate fit` gives it of the same touches; LiveError where there is no answer."""
        document = self._core.document()
        if document is None:
            raise LiveError("there is no answer yet, and so no fit", "NoAnswer")
        return Fit.from_dict(json.loads(document), "touches")

    def maps(self, grid: Pair | None = None) -> dict[str, npt.NDArray[np.float64]]:
        """Maps of the last look, as `Fit.maps` has them, with u_position, u_S and u_R; LiveError where there is no answer."""
        found = self._core.maps(grid)
        if found is None:
            raise LiveError("there is no answer yet, and so no maps", "NoAnswer")
        return found

    def __len__(self) -> int:
        return self.touches

    def __bool__(self) -> bool:
        return True

    def __repr__(self) -> str:
        known = "no touch yet" if self.last is None else str(self.last)
        return f"LiveLoop({self.touches} touches, {self.looks} looks: {known})"


def live(touches: Iterable[Any], loop: LiveLoop | None = None, **options: Any) -> Iterator[LiveAnswer]:
    """Answers touches one by one; a last answer is of all of them. Ends early where the goal is reached.

    touches: an iterable of touches as `LiveLoop.hear` takes them, a table, or the path of a file of lines. loop: one to go on
    with, whose state can be saved; otherwise options make one, as `LiveLoop` has them. `live_answers` does the same in an
    event loop.

    >>> import palpate
    >>> answers = list(live(palpate.simulate("paper-cylinder"), until_radius=3))
    >>> answers[-1].is_reached, answers[-1].answer, answers[-1].class_name
    (True, 'fresh', 'ridge')
    """
    if loop is None:
        loop = LiveLoop(**options)
    elif options:
        raise TypeError(f"live: {', '.join(options)} belong to the loop that is given")
    for touch in each(touches):
        answer = loop.hear(touch)
        if answer is None:
            continue
        yield answer
        if answer.is_reached:
            return
    last = loop._finished()
    if last is not None:
        yield last
