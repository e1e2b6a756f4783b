"""Exceptions: every one is a ValueError with the kind of fault and its fields.

>>> import palpate
>>> try:
...     palpate.fit([0.0, 1.0, float("nan")], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0], degree=2)
... except palpate.FitError as error:
...     error.kind, error.fields["column"], error.fields["index"]
('NotFinite', 'x', 2)
"""

from __future__ import annotations

import re
from typing import Any

__all__ = [
    "ExploreError",
    "FitError",
    "FrontierError",
    "LiveError",
    "PalpateError",
    "PlanError",
    "RecognitionError",
    "StudyError",
    "SurfaceError",
]

# what the command line proposes, in this package's words
_IN_PYTHON = [
    ("with --near X,Y,Z,R or --box X0,X1,Y0,Y1,Z0,Z1", "with a mask over the arrays"),
    ("--flip-normals", "flip_normals=True"),
    ("--surface parametric", 'surface="parametric"'),
    ("--closed u", 'closed="u"'),
    ("the maps of --out", "Fit.maps()"),
    ("(--bare)", "(bare=True)"),
]


def in_python(message: str) -> str:
    """A message of the command line in the words of this package.

    >>> in_python("raise --replicates, or --surface parametric")
    'raise replicates, or surface="parametric"'
    >>> in_python("--error-s is -1")
    'error_s is -1'
    """
    for flag, keyword in _IN_PYTHON:
        message = message.replace(flag, keyword)
    return re.sub(r"--([a-z]+(?:-[a-z]+)*)\b", lambda found: found[1].replace("-", "_"), message)


class PalpateError(ValueError):
    """Something that the caller can put right.

    Attributes:
        message: what is wrong and what would be right.
        kind: name of the fault, that of the variant in Rust, such as "Outside".
        fields: what the fault is about, such as {"index": 3, "x": 1.5, ...}; index counts from 0.
    """

    def __init__(self, message: str, kind: str = "", fields: dict[str, Any] | None = None) -> None:
        self.message = in_python(message)
        self.kind = kind
        self.fields: dict[str, Any] = dict(fields or {})
        super().__init__(self.message, kind, self.fields)

    def __str__(self) -> str:
        return self.message


class FitError(PalpateError):
    """Contacts or options that give no fit."""


class RecognitionError(PalpateError):
    """Contacts that show no shape; the message says how to take one part of them."""


class StudyError(PalpateError):
    """A scene or a study that cannot be, or parts that do not belong together."""


class FrontierError(PalpateError):
    """A scene, or a request, of which no frontier can be measured."""


class ExploreError(PalpateError):
    """A scene that cannot be explored, or a fit by which no touches can be planned."""


class LiveError(PalpateError):
    """Options or a state of which no live loop can be made, or an answer that is not there yet."""


class PlanError(PalpateError):
    """A stream of touches that cannot be made, or a touch that it refuses."""


class SurfaceError(PalpateError):
    """Knots and coefficients that make no surface, or surfaces that cannot be compared."""
