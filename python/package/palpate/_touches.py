"""Touches as they come: one thing that may hold many, and each of them as the engine hears it.

    (x, y, z) | (x, y, z, nx, ny, nz) | ((x, y, z), (nx, ny, nz))     numbers
    {"x": ..., "normal": [...], "finger": ..., "time": ...}           names, as the program reads JSON lines
    "x,y,z" | "1,2,3" | b"..."                                        lines of a table
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import isfinite, isnan
from os import PathLike
from typing import Any

import numpy as np

from ._columns import is_table

__all__ = ["NoTouch", "each", "line_of", "numbers_of"]


class NoTouch(ValueError):
    """Something that is no touch."""


def each(touches: Any) -> Iterable[Any]:
    """The touches of a table or an array one by one, the lines of a file, or whatever is iterated over.

    >>> list(each({"x": [1.0, 2.0], "y": [3.0, 4.0], "z": [5.0, 6.0]}))
    [{'x': 1.0, 'y': 3.0, 'z': 5.0}, {'x': 2.0, 'y': 4.0, 'z': 6.0}]
    """
    if isinstance(touches, (str, PathLike)):
        return _lines(touches)
    if is_table(touches):
        return _rows(touches)
    return touches  # type: ignore[no-any-return]


def _lines(path: str | PathLike[str]) -> Iterator[bytes]:
    with open(path, "rb") as lines:
        yield from lines


def _rows(table: Any) -> Iterator[dict[str, Any]]:
    names = getattr(table, "column_names", None) or list(table.keys() if isinstance(table, Mapping) else table.columns)
    columns = [np.asarray(table[name]) for name in names]
    for row in zip(*columns):
        yield {str(name): _plain(value) for name, value in zip(names, row)}


def line_of(touch: Any) -> bytes | None:
    """The line that the engine hears; None for numbers, which need none.

    >>> line_of({"x": np.float64(1), "normal": np.array([0, 0, 1])}), line_of("1,2,3"), line_of((1, 2, 3))
    (b'{"x": 1.0, "normal": [0, 0, 1]}', b'1,2,3', None)
    """
    if isinstance(touch, str):
        return touch.encode().rstrip(b"\r\n")
    if isinstance(touch, (bytes, bytearray)):
        return bytes(touch).rstrip(b"\r\n")
    if isinstance(touch, Mapping):
        return json.dumps(_plain(touch)).encode()
    return None


def _plain(value: Any) -> Any:
    """What JSON can say: a number that is not known is null, one without an end is its name, and what is none of these its words."""
    if isinstance(value, Mapping):
        return {str(name): _plain(part) for name, part in value.items()}
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    if isinstance(value, float) and not isfinite(value):
        return None if isnan(value) else str(value)
    return value if value is None or isinstance(value, (str, int, float)) else str(value)


def numbers_of(touch: Any) -> tuple[tuple[float, float, float], tuple[float, float, float] | None]:
    """Place and normal of a sequence of numbers.

    >>> numbers_of([1, 2, 3]), numbers_of(((1, 2, 3), (0, 0, 1)))
    (((1.0, 2.0, 3.0), None), ((1.0, 2.0, 3.0), (0.0, 0.0, 1.0)))
    """
    try:
        if isinstance(touch, Sequence) and len(touch) == 2 and hasattr(touch[0], "__len__"):
            touch = [*touch[0], *(touch[1] if touch[1] is not None else ())]
        numbers = [float(number) for number in touch]
    except (TypeError, ValueError):
        raise NoTouch(f"a touch is 3 or 6 numbers, names with numbers, or a line, not {_short(touch)}") from None
    if len(numbers) not in (3, 6):
        raise NoTouch(f"a touch is 3 numbers, or 6 with a normal, not {len(numbers)}")
    x, y, z, *normal = numbers
    return (x, y, z), (normal[0], normal[1], normal[2]) if normal else None


def _short(thing: Any) -> str:
    words = repr(thing)
    return words if len(words) <= 60 else f"{words[:57]}..."
