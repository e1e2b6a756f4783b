"""Ten thousand calls and more with whatever may be handed over: an answer or a ValueError or TypeError, never a crash.

PALPATE_FUZZ sets the number of calls of each kind.
"""

from __future__ import annotations

import os

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import palpate

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


pairs = st.one_of(
    st.integers(-2, 12), st.tuples(st.integers(-1, 5), st.integers(-1, 5)), st.floats(), st.text(max_size=2), st.none()
)
words = st.fixed_dictionaries(
    {"degree": st.one_of(st.integers(1, 4), pairs)},
    optional={
        "segments": pairs,
        "grid": pairs,
        "surface": st.sampled_from(["height", "auto", "none", 1]),
        "weights": st.one_of(st.sampled_from(["auto", "tangent", "equal", "x"]), arrays((3,))),
        "smooth": st.one_of(st.sampled_from(["none", "auto", "x"]), numbers),
        "robust": st.sampled_from(["none", "huber", "tukey", "x"]),
        "method": st.sampled_from(["auto", "cholesky", "qr", "kronecker", "pcg"]),
        "domain": arrays((4,)),
        "inset": numbers,
        "level": numbers,
        "frame": st.sampled_from(["auto", "keep"]),
        "flip_normals": st.booleans(),
        "bare": st.booleans(),
        "finger": arrays((9,)),
    },
)
REFUSALS = (ValueError, TypeError, OverflowError)
FIT = palpate.fit([0, 0, 0, 1, 1, 1, 2, 2, 2], [0, 1, 2] * 3, [0, 1, 0.1, 2, 0, 1, 1, 0, 2], normals=[[0, 0, 1]] * 9, degree=2, sigma=(0.1, 5))


@FUZZ
@given(st.data())
def test_fit(data: st.DataObject) -> None:
    g = data.draw(st.integers(0, 14))
    x, y, z = (data.draw(arrays((g,))) for _ in range(3))
    given_words = dict(data.draw(words))
    if data.draw(st.booleans()):
        given_words["normals"] = data.draw(arrays((g, 3)))
    elif data.draw(st.booleans()):
        given_words["slopes"] = data.draw(arrays((g, 2)))
    try:
        found = palpate.fit(x, y, z, **given_words)
        found.to_dict()
        found.surface.ev(0.1, 0.2)
    except REFUSALS:
        pass


@FUZZ
@given(st.data())
def test_grid(data: st.DataObject) -> None:
    n, m = data.draw(st.integers(0, 7)), data.draw(st.integers(0, 7))
    x = data.draw(st.one_of(st.just(np.arange(float(n))), arrays((n,))))
    y = data.draw(st.one_of(st.just(np.arange(float(m))), arrays((m,))))
    try:
        palpate.fit(x, y, data.draw(arrays((n, m))), **data.draw(words)).to_dict()
    except REFUSALS:
        pass


@FUZZ
@given(st.data())
def test_many(data: st.DataObject) -> None:
    b, g = data.draw(st.integers(0, 3)), data.draw(st.integers(0, 12))
    ragged = data.draw(st.booleans())
    shape = (g,) if ragged else (b, g)
    given_words = dict(data.draw(words))
    for name in ("flip_normals", "finger"):
        given_words.pop(name, None)
    if ragged:
        given_words["offsets"] = data.draw(st.one_of(arrays((b + 1,)), st.just([0, g])))
    try:
        palpate.fit_many(*(data.draw(arrays(shape)) for _ in range(3)), threads=None, **given_words)
    except REFUSALS:
        pass


@FUZZ
@given(st.data())
def test_surface(data: st.DataObject) -> None:
    p, q = data.draw(st.integers(-1, 5)), data.draw(st.integers(1, 5))
    knots = tuple(np.r_[[0.0] * (k + 1), 0.5, [1.0] * (k + 1)] for k in (max(p, 0), q))
    c = np.arange(float((max(p, 0) + 2) * (q + 2)))
    try:
        surface = palpate.Surface(data.draw(st.one_of(st.just(knots), arrays())), data.draw(st.one_of(st.just(c), arrays())), (p, q))
        x, y = data.draw(arrays()), data.draw(arrays())
        surface(x, y, data.draw(st.integers(-1, 7)), data.draw(st.integers(0, 7)), grid=data.draw(st.booleans()))
        surface.shape(x, y)
    except REFUSALS:
        pass


@FUZZ
@given(st.data())
def test_stream(data: st.DataObject) -> None:
    try:
        live = palpate.TouchStream(
            data.draw(st.one_of(st.just([-10, 10, -10, 10]), arrays((4,)))),
            sigma=data.draw(st.one_of(st.just([1, 1, 1]), arrays((3,)))),
            degree=data.draw(pairs),
            segments=data.draw(pairs),
        )
        for _ in range(data.draw(st.integers(0, 12))):
            live.touch(*(data.draw(numbers) for _ in range(3)), slopes=(data.draw(numbers), data.draw(numbers)))
    except REFUSALS:
        pass


@FUZZ
@given(st.data())
def test_next_touches(data: st.DataObject) -> None:
    k = data.draw(st.integers(0, 6))
    try:
        planner = palpate.TouchPlanner(FIT, units=data.draw(st.one_of(st.none(), st.tuples(numbers, numbers))))
        candidates = data.draw(arrays((k, 2)))
        chosen = planner.next_touches(candidates, data.draw(st.integers(-1, 9)))
        assert len(set(chosen.tolist())) == len(chosen) and (chosen < len(candidates)).all()
        palpate.fit([0.0, 1.0], [0.0, 1.0], [0.0, 1.0], unit=data.draw(st.text(max_size=4)))
    except REFUSALS:
        pass
