"""Touches in an event loop: it goes on while the engine looks, and nothing stays open behind whoever leaves."""

from __future__ import annotations

import asyncio
import gc
import threading
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import aclosing

import pytest
from test_live import Row, told, touches

import palpate


def names_of_threads() -> set[str]:
    return {thread.name for thread in threading.enumerate() if thread.name.startswith("palpate")}


async def no_thread_is_left() -> bool:
    for _ in range(200):
        if not names_of_threads():
            return True
        await asyncio.sleep(0.02)
    return False


class Source:
    """Touches of a generator that remembers how it ended; `wait` seconds before each."""

    def __init__(self, rows: list[Row], wait: float = 0.0) -> None:
        self.rows, self.wait, self.closed, self.made = rows, wait, False, 0

    def plain(self) -> Iterator[Row]:
        try:
            for row in self.rows:
                time.sleep(self.wait)
                self.made += 1
                yield row
        finally:
            self.closed = True

    async def awaited(self) -> AsyncIterator[Row]:
        try:
            for row in self.rows:
                await asyncio.sleep(self.wait)
                self.made += 1
                yield row
        finally:
            self.closed = True


@pytest.mark.parametrize("form", ["list", "plain", "awaited"])
def test_answers_are_those_without_an_event_loop(form: str) -> None:
    rows = touches(25)
    source = Source(rows)

    async def follow() -> list[dict]:
        given = rows if form == "list" else getattr(source, form)()
        found = told([answer async for answer in palpate.live_answers(given)])
        assert await no_thread_is_left()
        return found

    assert asyncio.run(follow()) == told(palpate.live(rows))
    assert form == "list" or source.closed


def test_the_goal_ends_it_and_closes_the_source() -> None:
    source = Source(touches(200))

    async def follow() -> palpate.LiveAnswer:
        last = None
        async for answer in palpate.live_answers(source.awaited(), until_radius=1.0):
            last = answer
        assert last is not None
        return last

    assert asyncio.run(follow()).is_reached and source.closed and source.made < 200


def test_the_event_loop_goes_on_while_the_engine_looks_and_the_source_waits() -> None:
    async def follow() -> int:
        ticks = 0

        async def tick() -> None:
            nonlocal ticks
            while True:
                await asyncio.sleep(0.001)
                ticks += 1

        ticking = asyncio.create_task(tick())
        async for _ in palpate.live_answers(Source(touches(30), wait=0.02).plain(), refresh=0):
            pass
        ticking.cancel()
        return ticks

    # a source that waited in the event loop, or a look in it, would let it tick no more than once a touch
    assert asyncio.run(follow()) > 60


@pytest.mark.parametrize("form", ["plain", "awaited"])
def test_a_consumer_that_breaks_off_leaves_nothing_open(form: str) -> None:
    source, loop = Source(touches(50)), palpate.LiveLoop()

    async def follow() -> None:
        async with aclosing(palpate.live_answers(getattr(source, form)(), loop)) as answers:
            async for answer in answers:
                if answer.touch == 12:
                    break
        assert await no_thread_is_left()
        assert source.closed and len(loop) == 12

    asyncio.run(follow())
    again = Source(touches(50)[12:])

    async def left_alone() -> None:
        async for _ in palpate.live_answers(getattr(again, form)(), loop):
            break
        gc.collect()
        assert await no_thread_is_left()
        assert again.closed

    asyncio.run(left_alone())
    # the loop goes on where it was left
    assert len(loop) == 13 and loop.finish() is not None


@pytest.mark.parametrize("form", ["plain", "awaited"])
def test_cancellation_closes_the_source_and_keeps_the_touches(form: str) -> None:
    source, loop = Source(touches(60), wait=0.01), palpate.LiveLoop()

    async def follow() -> None:
        async for _ in palpate.live_answers(getattr(source, form)(), loop):
            pass

    async def cancelled() -> None:
        task = asyncio.create_task(follow())
        while len(loop) < 8:
            await asyncio.sleep(0.01)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        assert await no_thread_is_left()
        assert source.closed

    asyncio.run(cancelled())
    assert 8 <= len(loop) <= source.made < 60
    last = loop.finish()
    assert last is not None and last.contacts == len(loop)


def test_a_fault_of_the_source_comes_through() -> None:
    def broken() -> Iterator[Row]:
        yield touches(1)[0]
        raise OSError("the cable")

    async def follow() -> list[palpate.LiveAnswer]:
        found: list[palpate.LiveAnswer] = []
        with pytest.raises(OSError, match="the cable"):
            async for answer in palpate.live_answers(broken()):
                found.append(answer)
        assert await no_thread_is_left()
        return found

    assert len(asyncio.run(follow())) == 1


def test_what_is_no_touch_is_said_in_the_event_loop() -> None:
    said: list[tuple[str, bool]] = []

    def say(words: str) -> None:
        said.append((words, threading.current_thread() is threading.main_thread()))

    async def follow() -> int:
        rows = [*touches(3), (1, 2), "nothing"]
        return len([answer async for answer in palpate.live_answers(rows, say=say)])

    assert asyncio.run(follow()) == 3 and len(said) == 2 and all(here for _, here in said)


def test_two_loops_live_side_by_side() -> None:
    async def last(radius: float) -> palpate.LiveAnswer:
        answers = [answer async for answer in palpate.live_answers(Source(touches(25, radius)).awaited())]
        return answers[-1]

    async def both() -> list[palpate.LiveAnswer]:
        return await asyncio.gather(last(9.0), last(6.0))

    wide, narrow = asyncio.run(both())
    assert wide.radius is not None and narrow.radius is not None
    assert abs(wide.radius - 9) < 0.5 and abs(narrow.radius - 6) < 0.5
