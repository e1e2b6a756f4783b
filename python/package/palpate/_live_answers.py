"""The same in an event loop: touches in, answers out, and nothing waits for the engine but whoever asked it.

    source, async                     ->  event loop  ->  a thread looks  ->  answer
    source, in a thread of its own    ->
"""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterable, AsyncIterator, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from inspect import isasyncgen, isgenerator
from queue import SimpleQueue
from threading import Thread
from typing import Any

from ._columns import is_table
from ._live import LiveAnswer, LiveLoop
from ._touches import each

__all__ = ["live_answers"]

_END = object()
_Asked = tuple[asyncio.AbstractEventLoop, "asyncio.Future[Any]"]


async def live_answers(
    touches: Iterable[Any] | AsyncIterable[Any], loop: LiveLoop | None = None, **options: Any
) -> AsyncIterator[LiveAnswer]:
    """Answers touches after each of them, in an event loop that goes on meanwhile: an async iterator.

    touches: an iterable or an async iterable of touches as `LiveLoop.hear` takes them. What is iterated over without await
    may wait for its touches: it does so in a thread of its own. loop: one to go on with, whose state can be saved afterwards;
    otherwise options make one, as `LiveLoop` has them.

    Ends after a last answer of all touches, where the goal is reached, where the consumer breaks off, and on cancellation: then a
    generator that touches come from is closed, a look that is being made is finished in its thread, and its touch counts.
    To be sure that a loop that is left by `break` closes at once, hold it by `contextlib.aclosing`.

    >>> import asyncio, palpate
    >>> async def follow():
    ...     touches = palpate.simulate("paper-cylinder")
    ...     return [answer async for answer in live_answers(touches, window=60)]
    >>> answers = asyncio.run(follow())
    >>> answers[-1].answer, answers[-1].class_name
    ('fresh', 'ridge')
    """
    if loop is None:
        loop = LiveLoop(**options)
    elif options:
        raise TypeError(f"live_answers: {', '.join(options)} belong to the loop that is given")
    source = _source(touches)
    engine = ThreadPoolExecutor(1, thread_name_prefix="palpate-live")
    asked = asyncio.get_running_loop().run_in_executor
    try:
        async for touch in source:
            answer, words = await asked(engine, loop._heard, touch)
            for said in words:
                loop._say(said)
            if answer is None:
                continue
            yield answer
            if answer.is_reached:
                return
        last = await asked(engine, loop._finished)
        if last is not None:
            yield last
    finally:
        engine.shutdown(wait=False)
        if isasyncgen(source):
            await source.aclose()


def _source(touches: Any) -> AsyncIterator[Any]:
    if hasattr(touches, "__aiter__"):
        found: AsyncIterator[Any] = touches.__aiter__()
        return found
    # what is in memory never waits
    is_held = is_table(touches) or isinstance(touches, (list, tuple)) or hasattr(touches, "__array__")
    return _at_hand(touches) if is_held else _awaited(touches)


async def _at_hand(touches: Any) -> AsyncIterator[Any]:
    for touch in each(touches):
        yield touch


async def _awaited(touches: Any) -> AsyncIterator[Any]:
    """Touches for which somebody has to wait."""
    waiting = _Waiting(iter(each(touches)))
    try:
        while (touch := await waiting.next()) is not _END:
            yield touch
    finally:
        waiting.close()


class _Waiting:
    """A thread that asks an iterator whenever it is asked; it ends nobody's program by waiting on."""

    def __init__(self, iterator: Iterator[Any]) -> None:
        self._iterator = iterator
        self._asked: SimpleQueue[_Asked | None] = SimpleQueue()
        Thread(target=self._wait, name="palpate-touches", daemon=True).start()

    async def next(self) -> Any:
        here = asyncio.get_running_loop()
        future: asyncio.Future[Any] = here.create_future()
        self._asked.put((here, future))
        return await future

    def close(self) -> None:
        """The iterator is closed once it is done with what it was asked last."""
        self._asked.put(None)

    def _wait(self) -> None:
        while (asked := self._asked.get()) is not None:
            here, future = asked
            found, error = self._next()
            try:
                here.call_soon_threadsafe(_settle, future, found, error)
            except RuntimeError:
                # the event loop has gone meanwhile
                break
        if isgenerator(self._iterator):
            self._iterator.close()

    def _next(self) -> tuple[Any, BaseException | None]:
        try:
            return next(self._iterator, _END), None
        except BaseException as error:
            # whatever it is, it belongs to whoever awaits the touch
            return None, error


def _settle(future: asyncio.Future[Any], found: Any, error: BaseException | None) -> None:
    if future.done():
        return
    if error is None:
        future.set_result(found)
    else:
        future.set_exception(error)
