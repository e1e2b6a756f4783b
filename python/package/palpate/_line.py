"""Keywords as the command line has them: one meaning of every word, and one reader of it.

    degree=(2, 3), error_s=0.01   ->   --degree=2,3 --error-s=0.01
"""

from __future__ import annotations

from os import PathLike, fspath
from typing import Any

__all__ = ["FIT_WORDS", "flag", "flags", "source"]

# what may be said of a fit
FIT_WORDS = (
    "surface", "closed", "degree", "segments", "domain", "weights", "sigma", "method", "smooth", "robust", "grid",
    "inset", "frame",
)  # fmt: skip


def flag(name: str, value: Any) -> list[str]:
    """A keyword as the command line has it; None and False say nothing.

    >>> flag("segments", (4, 5)), flag("error_s", 0.5), flag("seed", None), flag("bare", True)
    (['--segments=4,5'], ['--error-s=0.5'], [], ['--bare'])
    """
    word = name.replace("_", "-")
    if value is None or value is False:
        return []
    if value is True:
        return [f"--{word}"]
    if not isinstance(value, (str, int, float)):
        value = ",".join(str(entry) for entry in value)
    return [f"--{word}={value}"]


def flags(verb: str, options: dict[str, Any], fit: dict[str, Any]) -> list[str]:
    """All of them; `fit` holds what was said of the fit."""
    strange = [name for name in fit if name not in FIT_WORDS]
    if strange:
        raise TypeError(f"{verb}() got an unexpected keyword argument {strange[0]!r}")
    return [entry for name, value in {**options, **fit}.items() for entry in flag(name, value)]


def source(scene: str | PathLike[str]) -> tuple[str, str | None]:
    """A scene's name, and its text where the text itself was given."""
    name = fspath(scene)
    if not isinstance(name, str):
        raise TypeError("scene: a name, a path or TOML text wanted")
    return ("-", name) if "\n" in name else (name, None)
