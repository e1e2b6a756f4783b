"""What a fit says: the shape of the patch, and how far to trust the arithmetic.

    k1 >= k2   ->   S = -(2/pi) atan2(k1 + k2, k1 - k2),   R = sqrt((k1^2 + k2^2)/2)

Curvatures are in the inverse of the input's unit, angles in degrees; what is undefined is None.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

__all__ = ["Certificate", "Measure", "Shape", "Spread"]


@dataclass(frozen=True)
class Spread:
    """Mean over the patch, and sd over the patch (variation, not uncertainty)."""

    mean: float | None
    sd: float | None


@dataclass(frozen=True)
class Measure(Spread):
    """A mean over the patch with its standard uncertainty u and its interval (lo, hi) at the fit's level."""

    u: float | None = None
    interval: tuple[float, float] | None = None
    u_noise: float | None = None
    u_model: float | None = None

    @classmethod
    def _of(cls, part: dict[str, Any]) -> Measure:
        ends = part.get("interval")
        return cls(
            part["mean"],
            part["sd"],
            part.get("u"),
            None if ends is None else (ends[0], ends[1]),
            part.get("u_noise"),
            part.get("u_model"),
        )


@dataclass(frozen=True)
class Shape:
    """What the patch looks like, over the points of the shape grid that the data support.

    shape_index: S from -1 (cup) over 0 (saddle) to 1 (cap). curvedness: R, 1/length. class_name: one of cup, trough,
    rut, saddle rut, saddle, saddle ridge, ridge, dome, cap, plane; None where several stand side by side, and class_by_area says
    which, each with its share of the patch (empty where there is one class). radius: of a cap, cup, ridge or rut. direction_deg: of
    k1 at the patch's centre, from +x towards +y, in [0, 180); direction: the same as a unit vector, where the surface stands
    in space. axis_deg and axis: the same of the direction along a ridge or rut, or of the longer way of a dome or
    trough; of a ring, a cone or a thing turned on a lathe what it is turned about, of an egg its longest half axis. centre: of a recognised ball, from outside or inside. axis_point: of a recognised pipe or bar the point of its axis
    next to the middle of the patch. other_class: the class from the other side, where nothing tells which side is free.
    """

    shape_index: Measure
    curvedness: Measure
    class_name: str | None
    class_probability: dict[str, float]
    class_by_area: dict[str, float]
    k1: Spread
    k2: Spread
    radius: float | None
    radius_interval: tuple[float, float] | None
    direction_deg: float | None
    direction: tuple[float, float, float] | None
    axis_deg: float | None
    axis: tuple[float, float, float] | None
    support: float
    plane_p: float | None
    grid: tuple[int, int]
    other_class: str | None = None
    centre: tuple[float, float, float] | None = None
    axis_point: tuple[float, float, float] | None = None

    @property
    def S(self) -> Measure:
        """The shape index."""
        return self.shape_index

    @property
    def R(self) -> Measure:
        """The curvedness."""
        return self.curvedness

    @classmethod
    def _of(cls, part: dict[str, Any]) -> Shape:
        ends, middle = part.get("radius_interval"), part.get("centre")
        middle = None if middle is None else (middle[0], middle[1], middle[2])
        is_round = part["class"] in ("cap", "cup")
        return cls(
            shape_index=Measure._of(part["S"]),
            curvedness=Measure._of(part["R"]),
            class_name=part["class"],
            class_probability=dict(part["class_probability"] or {}),
            class_by_area=dict(part.get("class_by_area") or {}),
            k1=Spread(part["k1"]["mean"], part["k1"]["sd"]),
            k2=Spread(part["k2"]["mean"], part["k2"]["sd"]),
            radius=part["radius"],
            radius_interval=None if ends is None else (ends[0], ends[1]),
            direction_deg=part["direction_deg"],
            direction=None if part.get("direction") is None else tuple(part["direction"]),
            axis_deg=part.get("axis_deg"),
            axis=None if part.get("axis") is None else tuple(part["axis"]),
            support=part["support"],
            plane_p=part["plane_p"],
            grid=(part["grid"][0], part["grid"][1]),
            other_class=part.get("other_class"),
            centre=middle if is_round else None,
            axis_point=None if is_round else middle,
        )


@dataclass(frozen=True)
class Certificate:
    """How far to trust the arithmetic: method and why, rank, condition, backward error, digits that are guaranteed."""

    method: str
    reason: str
    equations: int
    unknowns: int
    rank: int
    condition: float | None
    backward_error: float | None
    digits: dict[str, float] = field(default_factory=dict)

    @classmethod
    def _of(cls, part: dict[str, Any]) -> Certificate:
        return cls(
            method=part["method"],
            reason=part["reason"],
            equations=part["equations"],
            unknowns=part["unknowns"],
            rank=part["rank"],
            condition=part["condition"],
            backward_error=part["backward_error"],
            digits=dict(part.get("promise") or {}),
        )
