"""The hard cases' inputs, bit for bit those of `tests/laboratory/hard_cases/`: IEEE + - * / sqrt in the same order, and one integer generator.

`fingerprint` (FNV-1a, 64 bits, over the little-endian doubles) is stored in every golden file and checked on both sides.
"""
import math
import struct
from dataclasses import dataclass, field

FULL = [-4.0, 4.0, -4.0, 4.0]


class Lcg:
    """state <- state * 6364136223846793005 + 1442695040888963407 mod 2^64; uniform = top 53 bits / 2^53."""

    def __init__(self, seed):
        self.state = seed

    def uniform(self):
        self.state = (self.state * 6364136223846793005 + 1442695040888963407) % 2**64
        return float(self.state >> 11) / 9007199254740992.0

    def normal(self):
        """Sum of twelve uniforms less six: variance 1."""
        total = 0.0
        for _ in range(12):
            total = total + self.uniform()
        return total - 6.0


@dataclass
class Case:
    """What `HardCase` of the crate holds."""

    name: str
    degree: tuple
    objective: tuple  # ("slopes", wz, wx, wy) | ("tangent",) | ("normals", z, degrees) | ("rows",)
    x: list = field(default_factory=list)
    y: list = field(default_factory=list)
    z: list = field(default_factory=list)
    slopes: tuple = None
    normals: tuple = None
    weights: tuple = (None, None, None)
    segments: tuple = (1, 1)
    knots: tuple = None
    domain: list = None
    grid: tuple = (8, 8)
    inset: float = 0.0
    is_grid: bool = False
    rows: list = None  # dense rows
    rhs: list = None

    def stream(self):
        """Every double the answer depends on, in a fixed order; lists are preceded by their length."""
        if self.rows is not None:
            return [float(len(self.rows)), float(len(self.rows[0]))] + [v for row in self.rows for v in row] + self.rhs
        out = [float(v) for v in (*self.degree, *self.segments)]
        for knots in self.knots or ():
            out += [float(len(knots))] + knots
        out += self.domain or []
        tag = {"slopes": 0.0, "tangent": 1.0, "normals": 2.0}[self.objective[0]]
        out += [tag] + list(self.objective[1:]) + [float(v) for v in self.grid] + [self.inset]
        for column in (self.x, self.y, self.z, *(self.slopes or ()), *(self.normals or ()), *self.weights):
            out += [float(len(column or []))] + (column or [])
        return out


def fingerprint(case):
    """FNV-1a over the bytes of the stream."""
    value = 0xCBF29CE484222325
    for byte in struct.pack("<%dd" % len(case.stream()), *case.stream()):
        value = ((value ^ byte) * 0x100000001B3) % 2**64
    return "%016x" % value


def linspace(low, high, count):
    step = (high - low) / float(count - 1)
    return [low + float(i) * step for i in range(count - 1)] + [high]


def sites(fingers, stations):
    """Finger-major: all stations of the first finger, then of the next."""
    return [f for f in fingers for _ in stations], [s for _ in fingers for s in stations]


def sweep(fingers, stations=9):
    """`fingers` lanes at equal distances over -4..4 and `stations` stops along each."""
    return sites(linspace(-4.0, 4.0, fingers), linspace(-4.0, 4.0, stations))


def sphere(radius):
    def touch(x, y):
        d2 = x * x + y * y
        root = math.sqrt(radius * radius - d2)
        return -d2 / (radius + root), -x / root, -y / root

    return touch


def cylinder45(radius):
    """Generators along (1, 1), apex line at z = 0."""

    def touch(x, y):
        d = x - y
        d2 = d * d / 2.0
        root = math.sqrt(radius * radius - d2)
        return -d2 / (radius + root), -d / (2.0 * root), d / (2.0 * root)

    return touch


def paraboloid(x, y):
    return -(x * x + y * y) / 16.0, -x / 8.0, -y / 8.0


def touched(surface, x, y, how="slopes"):
    """Keyword arguments of `Case` for a surface touched at the sites."""
    touches = [surface(a, b) for a, b in zip(x, y)]
    out = {"x": list(x), "y": list(y), "z": [t[0] for t in touches]}
    zx, zy = [t[1] for t in touches], [t[2] for t in touches]
    if how == "slopes":
        out["slopes"] = (zx, zy)
    if how == "normals":
        out["normals"] = ([-v for v in zx], [-v for v in zy], [1.0] * len(zx))
    return out
