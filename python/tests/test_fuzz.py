"""Ten thousand calls and more with whatever may be handed over: an answer or a ValueError or TypeError, never a crash.

PALPATE_FUZZ sets the number of calls of each kind. How many were answered and how many refused is said at the end.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import palpate
from conftest import FUZZED

CALLS = int(os.environ.get("PALPATE_FUZZ", "3000"))
FUZZ = settings(max_examples=CALLS, deadline=None, suppress_health_check=list(HealthCheck), database=None)

ODD = [0.0, -0.0, 1.0, -1.0, np.nan, np.inf, -np.inf, 1e308, -1e308, 5e-324, 1e-160, 1e160]
numbers = st.one_of(st.floats(-10, 10), st.sampled_from(ODD))
dtypes = st.sampled_from(["f8", "f4", ">f8", "f2", "i1", "i8", "u2", "u8", "?", "c16", "O", "U3", "M8[s]", "V4"])


@st.composite
def arrays(draw: st.DrawFn, shape: tuple[int, ...] | None = None) -> object:
    """Arrays of any dtype, layout and shape, masked, frozen, unaligned; lists, scalars and what is no array at all."""
    if shape is None or draw(st.integers(0, 19)) == 0:
        shape = draw(hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=12))
    base = draw(hnp.arrays("f8", shape, elements=numbers, fill=st.nothing()))
    how = draw(st.integers(0, 29))
    if how == 0:
        return base.tolist()
    if how == 1:
        return np.ma.array(base, mask=draw(hnp.arrays("?", shape)))
    if how == 2:
        with np.errstate(all="ignore"):
            try:
                return base.astype(draw(dtypes))
            except (TypeError, ValueError):
                return base
    if how == 3:
        return np.asfortranarray(base)
    if how == 4 and base.ndim:
        return np.repeat(base, 2, axis=0)[::2]
    if how == 5 and base.ndim:
        return base[::-1]
    if how == 6:
        base.flags.writeable = False
    if how == 7:
        return np.frombuffer(b"-" + base.tobytes(), dtype="u1")[1:].view("f8").reshape(base.shape)
    if how == 8:
        return draw(st.one_of(st.none(), st.text(max_size=3), st.booleans(), st.integers(), st.just(object()), st.just({})))
    return base


def mostly(good: st.SearchStrategy, odd: st.SearchStrategy) -> st.SearchStrategy:
    """One in ten is odd: a call with several arguments is as often answered as refused."""
    return st.integers(0, 9).flatmap(lambda n: odd if n == 7 else good)


def sound(shape: tuple[int, ...]) -> st.SearchStrategy:
    """What a careful caller hands over, or, one time in ten, anything."""
    drawn = st.integers(0, 2**32).map(lambda seed: np.random.default_rng(seed).uniform(-3, 3, shape))
    return mostly(drawn, arrays(shape))


pairs = st.one_of(
    st.integers(-2, 12), st.tuples(st.integers(-1, 5), st.integers(-1, 5)), st.floats(), st.text(max_size=2), st.none()
)
words = st.fixed_dictionaries(
    {"degree": mostly(st.integers(1, 3), pairs)},
    optional={
        "segments": mostly(st.integers(1, 3), pairs),
        "grid": mostly(st.integers(2, 9), pairs),
        "surface": mostly(st.just("height"), st.sampled_from(["auto", "none", 1])),
        "weights": mostly(st.sampled_from(["auto", "tangent", "equal"]), st.one_of(st.just("x"), arrays((3,)))),
        "smooth": mostly(st.sampled_from(["none", "auto", 0.1]), st.one_of(st.just("x"), numbers)),
        "robust": mostly(st.sampled_from(["none", "huber", "tukey"]), st.sampled_from(["x", 1, None])),
        "method": mostly(st.sampled_from(["auto", "cholesky", "qr"]), st.sampled_from(["kronecker", "pcg", "x"])),
        "domain": mostly(st.just([-3.5, 3.5, -3.5, 3.5]), arrays((4,))),
        "inset": mostly(st.floats(0, 0.5), numbers),
        "level": mostly(st.floats(0.5, 0.99), numbers),
        "frame": mostly(st.just("keep"), st.sampled_from(["auto", "x"])),
        "flip_normals": st.booleans(),
        "bare": st.booleans(),
        "finger": mostly(st.just(None), arrays((9,))),
    },
)
REFUSALS = (ValueError, TypeError, OverflowError)
FIT = palpate.fit([0, 0, 0, 1, 1, 1, 2, 2, 2], [0, 1, 2] * 3, [0, 1, 0.1, 2, 0, 1, 1, 0, 2], normals=[[0, 0, 1]] * 9, degree=2, sigma=(0.1, 5))


@contextmanager
def call() -> Iterator[None]:
    """One call, counted as answered or refused; whatever else is raised fails the test."""
    try:
        yield
        FUZZED["answered"] += 1
    except REFUSALS:
        FUZZED["refused"] += 1


@FUZZ
@given(st.data())
def test_fit(data: st.DataObject) -> None:
    g = data.draw(st.integers(0, 40))
    x, y, z = (data.draw(sound((g,))) for _ in range(3))
    given_words = dict(data.draw(words))
    if data.draw(st.booleans()):
        given_words["normals"] = data.draw(sound((g, 3)))
    elif data.draw(st.booleans()):
        given_words["slopes"] = data.draw(sound((g, 2)))
    with call():
        found = palpate.fit(x, y, z, **given_words)
        found.to_dict()
        found.surface.ev(0.1, 0.2)


@FUZZ
@given(st.data())
def test_grid(data: st.DataObject) -> None:
    n, m = data.draw(st.integers(0, 7)), data.draw(st.integers(0, 7))
    x = data.draw(mostly(st.just(np.arange(float(n))), arrays((n,))))
    y = data.draw(mostly(st.just(np.arange(float(m))), arrays((m,))))
    with call():
        palpate.fit(x, y, data.draw(sound((n, m))), **data.draw(words)).to_dict()


@FUZZ
@given(st.data())
def test_many(data: st.DataObject) -> None:
    b, g = data.draw(st.integers(0, 3)), data.draw(st.integers(0, 20))
    ragged = data.draw(st.booleans())
    shape = (g,) if ragged else (b, g)
    given_words = dict(data.draw(words))
    for name in ("flip_normals", "finger"):
        given_words.pop(name, None)
    if ragged:
        given_words["offsets"] = data.draw(mostly(st.just([0, g]), arrays((b + 1,))))
    with call():
        palpate.fit_many(*(data.draw(sound(shape)) for _ in range(3)), threads=None, **given_words)


@FUZZ
@given(st.data())
def test_surface(data: st.DataObject) -> None:
    p, q = data.draw(mostly(st.integers(1, 5), st.integers(-1, 0))), data.draw(st.integers(1, 5))
    knots = tuple(np.r_[[0.0] * (k + 1), 0.5, [1.0] * (k + 1)] for k in (max(p, 0), q))
    c = np.arange(float((max(p, 0) + 2) * (q + 2)))
    with call():
        surface = palpate.Surface(data.draw(mostly(st.just(knots), arrays())), data.draw(mostly(st.just(c), arrays())), (p, q))
        n = data.draw(st.integers(0, 9))
        x, y = data.draw(sound((n,))), data.draw(sound((n,)))
        surface(x, y, data.draw(mostly(st.integers(0, 7), st.just(-1))), data.draw(st.integers(0, 7)), grid=data.draw(st.booleans()))
        surface.shape(x, y)


@FUZZ
@given(st.data())
def test_stream(data: st.DataObject) -> None:
    with call():
        live = palpate.TouchStream(
            data.draw(mostly(st.just([-10, 10, -10, 10]), arrays((4,)))),
            sigma=data.draw(mostly(st.just([1, 1, 1]), arrays((3,)))),
            degree=data.draw(mostly(st.integers(1, 4), pairs)),
            segments=data.draw(mostly(st.integers(1, 3), pairs)),
        )
        near = mostly(st.floats(-10, 10), numbers)
        for _ in range(data.draw(st.integers(0, 12))):
            live.touch(*(data.draw(near) for _ in range(3)), slopes=(data.draw(near), data.draw(near)))


@FUZZ
@given(st.data())
def test_next_touches(data: st.DataObject) -> None:
    k = data.draw(st.integers(0, 6))
    with call():
        planner = palpate.TouchPlanner(FIT, units=data.draw(mostly(st.none(), st.tuples(numbers, numbers))))
        candidates = data.draw(sound((k, 2)))
        chosen = planner.next_touches(candidates, data.draw(mostly(st.integers(0, 9), st.just(-1))))
        assert len(set(chosen.tolist())) == len(chosen) and (chosen < len(candidates)).all()
        palpate.fit([0.0, 1.0], [0.0, 1.0], [0.0, 1.0], unit=data.draw(st.text(max_size=4)))


# a call that is answered takes half a second, and so there are fewer
@settings(FUZZ, max_examples=max(1, CALLS // 50))
@given(st.data())
def test_frontier_of_contacts(data: st.DataObject) -> None:
    g = data.draw(st.sampled_from([0, 1, 29, 30, 31, 36]))
    good = np.random.default_rng(g).uniform(-1, 1, (6, g))
    x, y, z = (data.draw(st.one_of(st.just(column), arrays((g,)))) for column in good[:3])
    given_words = data.draw(st.sampled_from([{}, {"normals": good[3:].T}, {"slopes": good[3:5].T}, {"wz": good[3]}]))
    with call():
        palpate.frontier(x, y, z, budget=data.draw(st.one_of(st.just("50us"), numbers)), seconds=0.01, bare=True, **given_words)
